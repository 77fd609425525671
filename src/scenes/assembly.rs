//! A scene before anything moves: points, bonds, loads, law of damage, and the forces between the points.
//!
//! The energy of a deformed body does not depend on how it is turned. Two choices of the literature break that: tangential springs
//! between points that do not turn (`rotation = "resisted"`), and springs on the whole relative displacement against zero-energy modes
//! (`zero_energy_control = "spring"`). Bodies with them are too stiff wherever material turns, and no smaller spacing helps.

use super::bonds::BondState;
use super::boundary::Boundary;
use super::correspondence::Correspondence;
use super::failure::Failure;
use super::interaction::{Damaging, Interaction};
use super::lattice_springs::LatticeSprings;
use super::platens::{Platen, Pressed};
use super::points::build;
use super::scene::{Procedure, Scene, SceneLaw, ZeroEnergyControl};
use super::springs::Springs;
use perilife_base::error::Result;
use perilife_points::body::Body;
use perilife_points::bond_law::Rotation;
use perilife_points::net::Net;
use perilife_points::net::rigid::{RESISTED, turning_cost, turning_warning};

/// The parts of a scene.
pub struct Assembly<'s> {
    scene: &'s Scene,
    pub net: Net,
    pub boundary: Boundary,
    /// Law of damage of the springs.
    pub failure: Failure,
    /// The body whose springs the fast kernel works through: only explicit motion leaves the state of the bonds to it alone.
    body: Option<Body>,
}

impl<'s> Assembly<'s> {
    /// The parts of a scene.
    /// Errors: wrong input that shows only now, choices that do not go together.
    pub fn of(scene: &'s Scene) -> Result<Self> {
        let (net, body) = build(scene)?;
        let boundary = Boundary::of(scene, &net)?;
        let failure = Failure::of(scene, &net)?;
        let body = body.filter(|_| matches!(scene.procedure, Procedure::Dynamic { .. }));
        Ok(Assembly { scene, net, boundary, failure, body })
    }

    /// Bonds of the plate with its cracks cut.
    pub fn bonds(&self) -> BondState {
        BondState::new(&self.net, &self.boundary.no_fail)
    }

    /// Forces on the points, those of platens among them.
    pub fn interaction(&self) -> Result<Box<dyn Interaction + '_>> {
        let (law, platens) = (self.law()?, Platen::all(self.scene, &self.net));
        Ok(if platens.is_empty() { law } else { Box::new(Pressed::new(law, &self.net, platens)) })
    }

    /// Forces between the points.
    fn law(&self) -> Result<Box<dyn Interaction + '_>> {
        let Assembly { scene, net, failure, body, .. } = self;
        if let SceneLaw::Correspondence { control, factor } = scene.model.law {
            return Ok(Box::new(Correspondence::new(scene, net, control, factor)?));
        }
        let finite = scene.model.finite;
        let fast = body.as_ref().and_then(|body| LatticeSprings::new(net, body, &self.bonds(), failure, finite));
        Ok(match fast {
            Some(fast) => Box::new(fast),
            None => Box::new(Springs::new(net, failure.clone(), finite)),
        })
    }

    /// Energy of a rigid turn over that of an extension ([`turning_cost`]) of the body as it is worked through, its cracks cut; `None`
    /// where an extension costs nothing.
    pub fn turning_cost(&self) -> Result<Option<f64>> {
        let (mut law, mut bonds) = (self.law()?, self.bonds());
        let mut force = vec![0.0; self.net.len() * self.net.unknowns];
        let finite = self.scene.model.finite || matches!(self.scene.model.law, SceneLaw::Correspondence { .. });
        let energy = |u: &[f64]| law.internal_force(u, &mut bonds, Damaging::Frozen, &mut force).strain;
        Ok(turning_cost(&self.net, finite, energy))
    }

    /// What the user should know of the points, of a body that resists a turn by its choice of law, and of the load at which cracks grow.
    pub fn warnings(&self) -> Result<Vec<String>> {
        let resists = match self.scene.model.law {
            SceneLaw::Bonds(law) if law.kind.is_two_parameter() && law.rotation == Rotation::Resisted => Some(RESISTED),
            SceneLaw::Correspondence { control: ZeroEnergyControl::Spring, .. } => {
                Some(["model.zero_energy_control = \"spring\"", "use \"silling\""])
            }
            _ => None,
        };
        let turning = match resists {
            Some(words) => turning_warning(self.turning_cost()?, words),
            None => None,
        };
        Ok(self.net.warnings.iter().cloned().chain(turning).chain(self.scene.trapping_lines()).collect())
    }
}

/// What the discretisation makes of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Preview {
    pub points: usize,
    pub bonds: usize,
    /// Bonds that the initial cracks cut.
    pub cut: usize,
    /// Smallest and largest horizon, m.
    pub horizons: [f64; 2],
    /// Smallest and largest spacing, m.
    pub spacings: [f64; 2],
    /// Points of every load, in the order of the scene.
    pub loaded: Vec<usize>,
    /// What the user should know about them.
    pub warnings: Vec<String>,
}

/// Builds points, bonds, loads and supports of a scene.
pub fn preview(scene: &Scene) -> Result<Preview> {
    let assembly = Assembly::of(scene)?;
    let Assembly { net, boundary, .. } = &assembly;
    let range = |values: &[f64]| {
        values.iter().fold([f64::INFINITY, 0.0], |[low, high], &value| [f64::min(low, value), f64::max(high, value)])
    };
    Ok(Preview {
        points: net.len(),
        bonds: net.bonds.len(),
        cut: net.pre_cut.len(),
        horizons: range(&net.horizons),
        spacings: range(&net.spacings),
        loaded: boundary.groups.iter().map(|group| group.points.len()).collect(),
        warnings: assembly.warnings()?,
    })
}
