//! K_I from the energy released between slightly different crack lengths.
//!
//! At constant load a crack that grows by da releases half the work the loads do, `G = d(f·u)/2 / (h da)` a tip, and
//! `E' G = K_I² + K_II²` for growth straight ahead (Irwin 1957, J. Appl. Mech. 24:361). The work is taken at three crack lengths; a
//! parabola through them, over the lengths that the cut bonds represent, has its slope at the length asked for. Straight growth cannot
//! tell the modes apart: K_I is given where plate and loads are symmetric about the crack, so that K_II vanishes.

use std::time::Instant;

use super::{Intensity, MethodResult, StressIntensityMethod};
use crate::case::Case;
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;
use perilife_plate::specimen::geometry::distance;
use perilife_plate::specimen::{Crack, CrackLine, Point, Specimen};
use perilife_points::body::Body;
use perilife_points::body::balanced::flanks::{self, FlankRange};
use perilife_points::body::mirror::Mirror;
use perilife_points::body::pre_crack::bonds_cut_by;
use perilife_points::body::severed::represented_excess;
use perilife_points::bond_law::SurfaceCorrection;
use perilife_points::pieces::{Connectivity, remove_fragments};
use perilife_points::solver::{Equilibrium, SolverKind};
use perilife_points::state::Bonds;

/// Growth between the crack lengths, in spacings, of a crack along the rows or columns of points: the pattern of cut bonds repeats
/// with every spacing.
const STEP_ALIGNED: f64 = 1.0;
/// The same of any other crack: enough bonds for the length they represent to be smooth (a whole number of patterns at 45°).
const STEP_SLANTED: f64 = 3.0 * std::f64::consts::SQRT_2;
/// Largest step as share of the crack.
const STEP_SHARE: f64 = 0.25;
/// Sine of the angle between crack and rows, and distance in spacings from their middle, that are none.
const ALIGNED: f64 = 1e-6;

/// K_I of the tips with these numbers.
/// Errors: mechanics without equilibrium at one of the crack lengths.
pub(super) fn all_tips(case: &Case, tips: &[usize]) -> Result<Vec<MethodResult>> {
    let started = Instant::now();
    let plate = &mut CrackedPlate::new(case)?;
    let unmoved = plate.solve(&plate.growth_of_all(0.0))?;
    let shared = started.elapsed().as_secs_f64();
    let is_plate = plate.case.specimen.kind.is_plate();
    let axes = Mirror::of(&plate.body, &unmoved.bonds.multiplier).lines.map(|line| line.is_some());
    let mut results = Vec::with_capacity(tips.len());
    // The standard specimens are symmetric about the crack plane, and their tips are each other's mirror images.
    for group in tips.chunks(if is_plate { 1 } else { tips.len() }) {
        let started = Instant::now();
        let (k_i, note) = if !is_plate || is_symmetric_about(plate, group[0], axes) {
            (Some(opening_factor(plate, group, &unmoved)?), None)
        } else {
            let note = "straight growth gives K_I² + K_II² only, and the plate is not symmetric about this crack: \
                        use ring";
            (None, Some(note.to_owned()))
        };
        let result = MethodResult {
            method: StressIntensityMethod::EnergyRelease,
            intensity: Intensity { k_i, k_ii: None },
            t_stress: None,
            is_closed: false,
            note,
            wall_s: shared + started.elapsed().as_secs_f64(),
        };
        results.extend(std::iter::repeat_n(result, group.len()));
    }
    Ok(results)
}

/// `K_I = √(E' G)` of tips that grow together, Pa√m.
fn opening_factor(plate: &mut CrackedPlate, tips: &[usize], unmoved: &Field) -> Result<f64> {
    let count = tips.len() as f64;
    let excess = |plate: &CrackedPlate, field: &Field| {
        tips.iter().map(|&tip| plate.represented(&field.specimen, tip)).sum::<f64>() / count
    };
    let step = step(plate, tips[0]);
    let mut works = [(excess(plate, unmoved), unmoved.work); 3];
    for (growth, at) in [(-step, 0), (step, 2)] {
        let mut growths = plate.growth_of_all(0.0);
        tips.iter().for_each(|&tip| growths[tip] = growth);
        let field = plate.solve(&growths)?;
        works[at] = (growth + excess(plate, &field), field.work);
    }
    let released = 0.5 * slope_at_zero(works) / (plate.case.specimen.thickness * count);
    Ok((plate.case.material.plane_modulus() * released).max(0.0).sqrt())
}

/// Whether the crack of a tip lies in a line about which the plate with its loads is symmetric; `axes` says whether turning columns
/// (0) or rows (1) over leaves it as it is.
fn is_symmetric_about(plate: &CrackedPlate, tip: usize, axes: [bool; 2]) -> bool {
    let (lattice, seed) = (&plate.body.lattice, &plate.case.specimen.tips[tip]);
    let middle = [lattice.columns, lattice.rows].map(|count| 0.5 * (count as f64 - 1.0));
    let (seat, ahead) = (lattice.locate(seed.position), lattice.to_axes(seed.direction));
    (0..2).any(|axis| axes[axis] && ahead[axis].abs() < ALIGNED && (seat[axis] - middle[axis]).abs() < ALIGNED)
}

/// Growth between the crack lengths at a tip, m.
fn step(plate: &CrackedPlate, tip: usize) -> f64 {
    let (specimen, lattice) = (&plate.case.specimen, &plate.body.lattice);
    let [x, y] = lattice.to_axes(specimen.tips[tip].direction);
    let spacings = if x.abs().min(y.abs()) < ALIGNED { STEP_ALIGNED } else { STEP_SLANTED };
    (spacings * lattice.spacing).min(STEP_SHARE * plate.crack_behind(specimen, tip))
}

/// Slope at 0 of the parabola through three points.
fn slope_at_zero([(x0, y0), (x1, y1), (x2, y2)]: [(f64, f64); 3]) -> f64 {
    let (first, second) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    first - (second - first) / (x2 - x0) * (x0 + x1)
}

/// A case as points and bonds, built once, whose cracks can be moved.
struct CrackedPlate<'a> {
    case: &'a Case,
    /// The cut bonds are those of the last solution.
    body: Body,
}

/// The plate in equilibrium at one length of its cracks.
struct Field {
    /// The specimen with these cracks.
    specimen: Specimen,
    /// Bonds, cracks cut.
    bonds: Bonds,
    /// Work of the loads, f·u, J.
    work: f64,
}

impl<'a> CrackedPlate<'a> {
    fn new(case: &'a Case) -> Result<Self> {
        Ok(CrackedPlate { case, body: case.points().body(&case.specimen, &case.material)? })
    }

    /// Growths for [`CrackedPlate::solve`]: every crack tip by the same, m.
    fn growth_of_all(&self, growth: f64) -> Vec<f64> {
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
        if self.case.points().bond_law.surface_correction == SurfaceCorrection::Balanced {
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
    fn solve(&mut self, growth_of_tips: &[f64]) -> Result<Field> {
        let (specimen, bonds) = self.cut(growth_of_tips)?;
        let mut displacement = Vec::new();
        // A window pays only where bonds break one after the other.
        let solver = match self.case.points().solver {
            SolverKind::Window => SolverKind::Multigrid,
            whole => whole,
        };
        let (symmetry, load) = (self.case.points().symmetry, self.case.loading.maximum);
        let mut equilibrium = Equilibrium::new(solver, symmetry, &self.body, &bonds, load);
        equilibrium.solve(&self.body, &bonds, &mut displacement)?;
        let work = equilibrium.work();
        Ok(Field { specimen, bonds, work })
    }

    /// How much farther the crack of `specimen` that a tip ends reaches once cut into bonds, m.
    fn represented(&self, specimen: &Specimen, tip: usize) -> f64 {
        let Own { crack, at_to, length } = own_crack(specimen, tip);
        represented_excess(&self.body, &CrackLine::straight(crack.from, crack.to), at_to, length)
    }

    /// Length of straight crack behind a tip up to its middle, where both its ends are tips, or its mouth, m.
    fn crack_behind(&self, specimen: &Specimen, tip: usize) -> f64 {
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
