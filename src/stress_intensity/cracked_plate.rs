//! A plate in equilibrium at several lengths of its cracks; points and uncut bonds are built once.

use crate::body::Body;
use crate::body::balanced::flanks::{self, FlankRange};
use crate::body::pre_crack::bonds_cut_by;
use crate::body::severed::represented_excess;
use crate::bond_law::SurfaceCorrection;
use crate::case::Case;
use crate::error::{Error, Result, input};
use crate::fatigue::pieces::{Connectivity, remove_fragments};
use crate::levels::Discretisation;
use crate::solver::{Equilibrium, SolverKind};
use crate::specimen::geometry::distance;
use crate::specimen::{Crack, CrackLine, Point, Specimen};
use crate::state::Bonds;
use crate::units::MM;

/// A case as points and bonds whose cracks can be moved.
pub struct CrackedPlate<'a> {
    /// The case.
    pub case: &'a Case,
    /// Its body; the cut bonds are those of the last solution.
    pub body: Body,
}

/// The plate in equilibrium at one length of its cracks.
pub struct Field {
    /// The specimen with these cracks.
    pub specimen: Specimen,
    /// Bonds, cracks cut.
    pub bonds: Bonds,
    /// Displacement in the layout of [`crate::solver::field::Layout::of`], m.
    pub displacement: Vec<f64>,
    /// Work of the loads, f·u, J.
    pub work: f64,
}

impl<'a> CrackedPlate<'a> {
    /// Discretises a case.
    pub fn new(case: &'a Case) -> Result<Self> {
        let model = &case.model;
        if model.arrangement != Discretisation::Lattice {
            let problem = "has points of several levels, and K is read off a lattice of one spacing";
            return Err(input("model.discretisation", format!("\"{}\"", model.arrangement), problem, "use \"lattice\""));
        }
        let (spacing, ratio, angle) = (model.spacing, model.horizon_ratio, model.lattice_angle);
        let body = Body::build(&case.specimen, &case.material, &model.bond_law, spacing, ratio, angle)?;
        Ok(CrackedPlate { case, body })
    }

    /// Growths for [`CrackedPlate::solve`]: every crack tip by the same, m.
    pub fn growth_of_all(&self, growth: f64) -> Vec<f64> {
        self.case.specimen.tips.iter().map(|tip| if tip.from_slot { 0.0 } else { growth }).collect()
    }

    /// Cuts the cracks with every tip moved by its growth, m; nothing is solved.
    fn cut(&mut self, growth_of_tips: &[f64]) -> Result<(Specimen, Bonds)> {
        let mut specimen = self.case.specimen.clone();
        specimen.move_tips(growth_of_tips);
        if let Some(tip) = specimen.tips.iter().find(|tip| !tip.from_slot && !specimen.contains(tip.position)) {
            let [x, y] = tip.position.map(|metres| metres / MM);
            return Err(Error::Mechanics(format!(
                "{}: a crack tip at ({x:.6}, {y:.6}) mm, within a horizon of the one asked for, lies outside the material; \
                 give a smaller model.spacing_mm",
                self.case.name
            )));
        }
        self.body.pre_cut = bonds_cut_by(&self.body, &specimen);
        let mut bonds = Bonds::new(&self.body);
        if remove_fragments(&self.body, &mut bonds, &self.body.pre_cut) == Connectivity::Severed {
            return Err(Error::Mechanics(format!("{}: the cracks cut the plate in two", self.case.name)));
        }
        if self.case.model.bond_law.surface_correction == SurfaceCorrection::Balanced {
            let lines = specimen.crack_lines();
            let tips: Vec<Point> = (0..specimen.tips.len())
                .filter_map(|tip| specimen.line_end(tip))
                .map(|end| lines[end.line].end(end.at_last))
                .collect();
            let beside = flanks::multipliers(&self.body, &bonds.multiplier, &lines, &tips, &tips, FlankRange::All);
            beside.into_iter().for_each(|(bond, multiplier)| bonds.set(&self.body, bond, multiplier));
        }
        Ok((specimen, bonds))
    }

    /// Equilibrium at maximum load with every tip moved by its growth, m.
    /// Errors: a tip that leaves the material, cracks that cut the plate in two, a solver that does not converge.
    pub fn solve(&mut self, growth_of_tips: &[f64]) -> Result<Field> {
        let (specimen, bonds) = self.cut(growth_of_tips)?;
        let mut displacement = Vec::new();
        // A window pays only where bonds break one after the other.
        let solver = match self.case.model.solver {
            SolverKind::Window => SolverKind::Multigrid,
            whole => whole,
        };
        let (symmetry, load) = (self.case.model.symmetry, self.case.loading.maximum);
        let mut equilibrium = Equilibrium::new(solver, symmetry, &self.body, &bonds, load);
        equilibrium.solve(&self.body, &bonds, &mut displacement)?;
        let work = equilibrium.work();
        Ok(Field { specimen, bonds, displacement, work })
    }

    /// How much farther the crack of `specimen` that a tip ends reaches once cut into bonds, m.
    pub fn represented(&self, specimen: &Specimen, tip: usize) -> f64 {
        let Own { crack, at_to, length } = own_crack(specimen, tip);
        represented_excess(&self.body, &CrackLine::straight(crack.from, crack.to), at_to, length)
    }

    /// Length of straight crack behind a tip up to its middle, where both its ends are tips, or its mouth, m.
    pub fn crack_behind(&self, specimen: &Specimen, tip: usize) -> f64 {
        own_crack(specimen, tip).length
    }
}

/// The crack that a tip ends.
struct Own {
    crack: Crack,
    /// Whether the tip is its end `to`.
    at_to: bool,
    /// Length of it that belongs to the tip, m: all, or half where both ends are tips.
    length: f64,
}

fn own_crack(specimen: &Specimen, tip: usize) -> Own {
    let here = specimen.tips[tip].position;
    let is_own = |crack: &&Crack| crack.from == here || crack.to == here;
    // Every sharp tip was placed at an end of its crack and moves with it; a lone tip stands for itself.
    let crack = specimen.cracks.iter().find(is_own).copied().unwrap_or(Crack::straight(here, here));
    let at_to = crack.to == here;
    let other = if at_to { crack.from } else { crack.to };
    let shared = specimen.tips.iter().any(|seed| seed.position == other);
    Own { crack, at_to, length: distance(crack.from, crack.to) * if shared { 0.5 } else { 1.0 } }
}
