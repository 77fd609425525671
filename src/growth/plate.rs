//! The discretised plate of a run: a body on a lattice, or the finest points of a plate of several levels with all that is beside
//! them.

use std::collections::HashMap;
use std::sync::Arc;

use super::Fields;
use crate::body::lattice::LANES;
use crate::body::{Body, Bond};
use crate::case::Model;
use crate::error::Result;
use crate::levels::multi_level_body::{MultiLevelBody, clear_way, words};
use crate::levels::rigid::{RESISTED, turning_cost_of_springs, turning_warning};
use crate::levels::{Discretisation, MultiLevelSpec, Net, PointGrid};
use crate::material::Material;
use crate::solver::Equilibrium;
use crate::solver::field::Layout;
use crate::specimen::{Point, Specimen, Support};
use crate::state::Bonds;
use crate::watch::{self, Stage};

/// A discretised plate.
#[derive(Debug, Clone)]
pub struct Plate {
    /// The points whose bonds can break.
    pub body: Body,
    /// All levels, where there are several.
    levels: Option<Arc<MultiLevelBody>>,
}

impl Plate {
    /// Discretises `specimen`, with its cracks as they are cut; regions around flaws are those of `flaws`.
    pub fn build(specimen: &Specimen, flaws: &Specimen, material: &Material, model: &Model) -> Result<Plate> {
        let (law, ratio, angle) = (&model.bond_law, model.horizon_ratio, model.lattice_angle);
        if model.arrangement == Discretisation::Lattice {
            let body = Body::build(specimen, material, law, model.spacing, ratio, angle)?;
            return Ok(Plate { body, levels: None });
        }
        watch::at(Stage::Points, 0.0)?;
        let holds = |support: &Support| !matches!(support, Support::RigidEnds);
        let ask = MultiLevelSpec {
            specimen,
            flaws,
            material,
            law,
            spacing: model.coarsest_spacing(),
            horizon_ratio: ratio,
            lattice_angle: angle,
            arrangement: model.arrangement,
            refinement: model.refinement.as_ref(),
            floating: !specimen.supports.iter().any(holds),
        };
        let (body, levelled) = MultiLevelBody::build(&ask)?;
        Ok(Plate { body, levels: Some(Arc::new(levelled)) })
    }

    /// Equilibrium with these bonds under `load` times the unit load (Pa or N).
    pub fn equilibrium(&self, model: &Model, bonds: &Bonds, load: f64) -> Equilibrium {
        match &self.levels {
            None => Equilibrium::new(model.solver, model.symmetry, &self.body, bonds, load),
            Some(levels) => Equilibrium::of_levels(model.solver, levels.clone(), &self.body, bonds, load),
        }
    }

    /// Whether it has points of several levels.
    pub fn is_of_levels(&self) -> bool {
        self.levels.is_some()
    }

    /// Number of points, of all levels.
    pub fn points(&self) -> usize {
        self.levels.as_ref().map_or(self.body.points.len(), |levels| levels.net.len())
    }

    /// Number of bonds of the uncracked plate, of all levels.
    pub fn bonds(&self) -> usize {
        self.levels.as_ref().map_or(self.body.bond_count, |levels| levels.net.bonds.len())
    }

    /// Number of bonds that the initial cracks cut, of all levels.
    pub fn cut(&self) -> usize {
        self.levels.as_ref().map_or(self.body.pre_cut.len(), |levels| levels.net.pre_cut.len())
    }

    /// Lattice of the pictures.
    pub fn grid(&self) -> PointGrid {
        self.levels.as_ref().map_or_else(|| PointGrid::of_body(&self.body), |levels| levels.net.grid.clone())
    }

    /// What the user should know about its points.
    pub fn warnings(&self) -> Vec<String> {
        let turning = self.body.stencil.resists_rotation().then(|| turning_warning(self.turning_cost(), RESISTED)).flatten();
        let of_levels = self.levels.iter().flat_map(|levels| levels.net.warnings.iter().cloned());
        of_levels.chain(turning).collect()
    }

    /// Energy of a rigid turn over that of an extension, of the springs of the plate.
    pub fn turning_cost(&self) -> Option<f64> {
        match &self.levels {
            None => turning_cost_of_springs(&Net::of_body(&self.body)),
            Some(levels) => turning_cost_of_springs(&levels.net),
        }
    }

    /// What is to be said of a tip that has come to the rim of the finest level.
    pub fn left_refinement(&self, tip: Point, zone_radius_horizons: f64) -> String {
        // Points of the rim reach two horizons beyond themselves to bonds of coarser ones.
        let needed = clear_way(self.body.horizon(), zone_radius_horizons) + 2.0 * self.body.horizon();
        format!(
            "the crack tip at {} has come too near to the rim of the finest level, where bonds do not break: the run ends there; give \
             refinement.regions that hold the whole way of the crack and {:.4} mm on, or up to the edge it shall reach",
            words(tip),
            1e3 * needed
        )
    }

    /// Displacement (x, y) in plate axes, m, and damage of every point, from a displacement in the layout of its [`Equilibrium`].
    pub fn fields(&self, bonds: &Bonds, displacement: &[f64], lives: &[(Bond, f64)]) -> Fields {
        match &self.levels {
            None => of_body(&self.body, bonds, displacement, lives),
            Some(levels) => of_levels(levels, &self.body, bonds, displacement, lives),
        }
    }
}

/// Displacement in plate axes, damage and remaining life of the points of a body.
fn of_body(body: &Body, bonds: &Bonds, displacement: &[f64], lives: &[(Bond, f64)]) -> Fields {
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let places = body.places();
    let damage = |place: usize| {
        let (column, row) = body.lattice.column_row(place);
        if bonds.chunk_is_regular(row, column / LANES) {
            return 0.0;
        }
        let [mut whole, mut intact] = [0_u32; 2];
        for (k, &step) in body.steps.iter().enumerate() {
            for owner in [place, place.wrapping_add_signed(-step)] {
                let bond = k * places + owner;
                whole += u32::from(body.multiplier[bond] > 0.0);
                intact += u32::from(bonds.multiplier[bond] > 0.0);
            }
        }
        if whole == 0 { 1.0 } else { 1.0 - f64::from(intact) / f64::from(whole) }
    };
    let motion = |place: usize| {
        let at = layout.index(place);
        body.lattice.from_axes([displacement[at], displacement[at + layout.stride]])
    };
    let points = || body.points.iter().map(|&place| place as usize);
    let least = least_lives(body, bonds, lives);
    let life = |place: usize| least.get(&place).copied().unwrap_or(1.0);
    Fields {
        displacement: points().map(motion).collect(),
        damage: points().map(damage).collect(),
        remaining_life: points().map(life).collect(),
        stress: Vec::new(),
    }
}

/// The same for all points of a net.
fn of_levels(levels: &MultiLevelBody, body: &Body, bonds: &Bonds, displacement: &[f64], lives: &[(Bond, f64)]) -> Fields {
    let net = &levels.net;
    let layout = Layout::of(&body.lattice, net.unknowns);
    let mut share = vec![1.0; net.bonds.len()];
    net.pre_cut.iter().for_each(|&bond| share[bond as usize] = 0.0);
    let is_broken = |bond: Bond| !bonds.is_intact(bond);
    levels.bonds().iter().filter(|(bond, _)| is_broken(*bond)).for_each(|(_, b)| share[*b as usize] = 0.0);
    let motion = |&id: &u32| {
        let id = id as usize;
        let (first, stride) = match id.checked_sub(body.places()) {
            None => (layout.index(id), layout.stride),
            Some(beyond) => (layout.len() + net.unknowns * beyond, 1),
        };
        body.lattice.from_axes([displacement[first], displacement[first + stride]])
    };
    // Fatigue bonds are those of the finest points, whose numbers are the places of the body.
    let least = least_lives(body, bonds, lives);
    let life = |id: &u32| least.get(&(*id as usize)).copied().unwrap_or(1.0);
    Fields {
        displacement: levels.ids.iter().map(motion).collect(),
        damage: net.damage(&share),
        remaining_life: levels.ids.iter().map(life).collect(),
        stress: Vec::new(),
    }
}

/// Least remaining life of the intact bonds of every place that has one below 1.
fn least_lives(body: &Body, bonds: &Bonds, lives: &[(Bond, f64)]) -> HashMap<usize, f64> {
    let mut least: HashMap<usize, f64> = HashMap::new();
    for &(bond, life) in lives.iter().filter(|(bond, _)| bonds.is_intact(*bond)) {
        let (_, a, b) = body.ends(bond);
        for place in [a, b] {
            let of_place = least.entry(place).or_insert(1.0);
            *of_place = of_place.min(life.clamp(0.0, 1.0));
        }
    }
    least
}
