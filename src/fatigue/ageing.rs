//! Which bonds age, and by how much strain a cycle.

use super::crack_tip::CrackTip;
use super::{Ageing, FatigueSettings};
use crate::body::pre_crack::places_near;
use crate::body::{Body, Bond};
use crate::loading::Loading;
use crate::material::Material;
use crate::solver::field::Layout;
use crate::specimen::Point;
use crate::specimen::geometry::distance;
use crate::state::Bonds;

/// Core bond strain over the strain measure K/(E √δ) of a crack tip: mean over bonds of a straight crack, conical kernel.
const CORE_STRAIN: f64 = 0.93;

/// A bond that ages and its cyclic strain ε.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AgeingBond {
    /// Which bond.
    pub bond: Bond,
    /// Cyclic strain ε = s_max (1-R)^γ, above zero.
    pub strain: f64,
}

/// Linearised bond stretch `s = n·(u' - u)/|ξ|` at maximum load.
#[must_use]
pub fn stretch(body: &Body, layout: &Layout, displacement: &[f64], bond: Bond) -> f64 {
    let (k, from, to) = body.ends(bond);
    let (a, b) = (layout.index(from), layout.index(to));
    let spring = &body.stencil.bonds[k];
    let opening = spring.normal[0] * (displacement[b] - displacement[a])
        + spring.normal[1] * (displacement[b + layout.stride] - displacement[a + layout.stride]);
    opening / spring.length
}

/// Share of the maximum stretch that counts as cyclic strain: (1-R)^γ with Walker's γ; a negative R counts as 0 (a closed
/// crack takes no part of the compression).
#[must_use]
pub fn strain_share(loading: &Loading, settings: &FatigueSettings) -> f64 {
    loading.range_share().powf(settings.walker_gamma)
}

/// Cyclic strain below which no bond of a crack tip ages for a threshold ΔK: `ε_th = f₀ ΔK_th / (E' √δ)`.
#[must_use]
pub fn threshold_strain(settings: &FatigueSettings, material: &Material, horizon: f64) -> f64 {
    CORE_STRAIN * settings.threshold / (material.plane_modulus() * horizon.sqrt())
}

/// Intact bonds that may age at all, in ascending order: those whose middle lies within the zone of an active tip, or all.
#[must_use]
pub fn candidates(body: &Body, bonds: &Bonds, tips: &[CrackTip], settings: &FatigueSettings) -> Vec<Bond> {
    let places = body.places();
    let mut found: Vec<Bond> = match settings.ageing {
        Ageing::Everywhere => {
            (0..body.multiplier.len()).map(|bond| bond as Bond).filter(|&b| bonds.is_intact(b) && body.can_fail(b)).collect()
        }
        Ageing::CrackTip => {
            let radius = settings.zone_radius_horizons * body.horizon();
            let reach = radius + 0.5 * body.horizon();
            let active = tips.iter().filter(|tip| tip.is_active());
            active
                .flat_map(|tip| places_near(body, tip.position, tip.position, reach).map(move |place| (tip.position, place)))
                .flat_map(|(tip, place)| (0..body.steps.len()).map(move |k| (tip, (k * places + place) as Bond)))
                .filter(|&(tip, bond)| bonds.is_intact(bond) && within(body, bond, tip, radius) && body.can_fail(bond))
                .map(|(_, bond)| bond)
                .collect()
        }
    };
    found.sort_unstable();
    found.dedup();
    found
}

fn within(body: &Body, bond: Bond, tip: Point, radius: f64) -> bool {
    distance(body.middle(bond), tip) <= radius
}

/// Of the candidates those in tension, with their cyclic strain. Bonds in compression are not spent.
#[must_use]
pub fn ageing_bonds(body: &Body, candidates: &[Bond], displacement: &[f64], share: f64, threshold: f64) -> Vec<AgeingBond> {
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    candidates
        .iter()
        .map(|&bond| AgeingBond { bond, strain: share * stretch(body, &layout, displacement, bond) })
        .filter(|ageing| ageing.strain > threshold.max(0.0))
        .collect()
}
