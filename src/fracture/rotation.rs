//! What it costs the body of a scene to turn as a whole.
//!
//! The energy of a deformed body does not depend on how it is turned. Two choices of the literature break that: tangential springs
//! between points that do not turn (`rotation = "resisted"`), and springs on the whole relative displacement against zero-energy modes
//! (`zero_energy_control = "spring"`). Bodies with them are too stiff wherever material turns, and no smaller spacing helps.

use super::bonds::BondState;
use super::boundary::Boundary;
use super::failure::Failure;
use super::interaction::Damaging;
use super::scene::{Scene, SceneLaw, ZeroEnergyControl};
use super::{build, failure, interact_by_law, of_motion};
use crate::body::Body;
use crate::bond_law::Rotation;
use crate::error::Result;
use crate::levels::Net;
use crate::levels::rigid::{RESISTED, turning_cost, turning_warning};

/// Energy of a rigid turn over that of an extension ([`turning_cost`]) of the body of a scene as it is worked through, its cracks
/// cut; `None` where an extension costs nothing.
pub fn cost(scene: &Scene) -> Result<Option<f64>> {
    let (net, body) = build(scene)?;
    let bonds = BondState::new(&net, &Boundary::of(scene, &net)?.no_fail);
    cost_of(scene, &net, of_motion(scene, body).as_ref(), &bonds, failure(scene, &net)?.as_ref())
}

fn cost_of(scene: &Scene, net: &Net, body: Option<&Body>, bonds: &BondState, failure: Option<&Failure>) -> Result<Option<f64>> {
    let mut interaction = interact_by_law(scene, net, body, bonds, failure)?;
    let (mut bonds, mut force) = (bonds.clone(), vec![0.0; net.len() * net.unknowns]);
    let finite = scene.model.finite || matches!(scene.model.law, SceneLaw::Correspondence { .. });
    Ok(turning_cost(net, finite, |u| interaction.internal_force(u, &mut bonds, Damaging::Frozen, &mut force).strain))
}

/// What is to be said of a scene whose body resists a turn by its choice of law.
pub(super) fn warning(
    scene: &Scene,
    net: &Net,
    body: Option<&Body>,
    bonds: &BondState,
    failure: Option<&Failure>,
) -> Result<Option<String>> {
    let words = match scene.model.law {
        SceneLaw::Bonds(law) if law.kind.is_two_parameter() && law.rotation == Rotation::Resisted => RESISTED,
        SceneLaw::Correspondence { control: ZeroEnergyControl::Spring, .. } => {
            ["model.zero_energy_control = \"spring\"", "use \"silling\""]
        }
        _ => return Ok(None),
    };
    Ok(turning_warning(cost_of(scene, net, body, bonds, failure)?, words))
}
