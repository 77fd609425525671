//! Crack tips that no-fail zones hold fast.
//!
//! Bonds near loads and supports never break (point loads on a lattice would tear out otherwise), so a crack that starts or
//! arrives there stands still for a reason that lies in the model and not in the plate.

use super::ageing::candidates;
use super::crack_tip::CrackTip;
use super::{Ageing, FatigueSettings};
use crate::body::Body;
use crate::state::Bonds;

/// Indices of the active tips that cannot grow because every intact bond of their ageing zone touches a no-fail zone.
pub fn stuck(body: &Body, bonds: &Bonds, tips: &[CrackTip], settings: &FatigueSettings) -> Vec<usize> {
    // Where all bonds age, growth of one tip is still told by the bonds around it.
    let near = FatigueSettings { ageing: Ageing::CrackTip, ..*settings };
    let is_stuck = |tip: &CrackTip| {
        let zone = std::slice::from_ref(tip);
        tip.is_active() && candidates(body, bonds, zone, &near).is_empty() && touches_no_fail(body, tip, &near)
    };
    (0..tips.len()).filter(|&tip| is_stuck(&tips[tip])).collect()
}

/// Whether a no-fail place lies so near a tip that it takes bonds of its ageing zone.
fn touches_no_fail(body: &Body, tip: &CrackTip, settings: &FatigueSettings) -> bool {
    let reach = (0.5 + settings.zone_radius_horizons) * body.horizon();
    crate::body::pre_crack::places_near(body, tip.position, tip.position, reach).any(|place| body.no_fail[place])
}
