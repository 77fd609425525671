//! Tips that come to an edge or a hole.

use crate::body::pre_crack::bonds_across;
use crate::body::{Body, Bond};
use crate::fatigue::crack_tip::CrackTip;
use crate::specimen::Specimen;
use crate::specimen::geometry::distance;
use crate::state::Bonds;

/// Bonds between tips and an edge or hole less than one spacing ahead; those tips end.
pub(super) fn break_through(tips: &mut [CrackTip], body: &Body, bonds: &Bonds, specimen: &Specimen) -> Vec<Bond> {
    let mut through = Vec::new();
    for tip in tips.iter_mut().filter(|tip| tip.is_active()) {
        if tip.retire(specimen, body.lattice.spacing) {
            let along = |way: f64| [0, 1].map(|i| tip.position[i] + way * tip.direction[i]);
            let across = bonds_across(body, along(-body.horizon()), along(body.horizon()));
            through.extend(across.into_iter().filter(|&bond| bonds.is_intact(bond) && body.can_fail(bond)));
        }
    }
    through.sort_unstable();
    through.dedup();
    through
}

/// Ends the tips at an edge or hole around which no bond is left.
pub(super) fn retire_tips(
    tips: &mut [CrackTip],
    body: &Body,
    specimen: &Specimen,
    candidates: &[Bond],
    zone_radius_horizons: f64,
) {
    let radius = zone_radius_horizons * body.horizon();
    for tip in tips.iter_mut().filter(|tip| tip.is_active()) {
        if !candidates.iter().any(|&bond| distance(body.middle(bond), tip.position) <= radius) {
            tip.retire(specimen, body.horizon());
        }
    }
}
