//! Which bonds age, by how much strain a cycle, and what that spends of their life.
//!
//! Over a cycle block `λ ← λ - ΔN A ε^p`; a bond with λ ≤ 0 breaks (Silling and Askari 2014, SAND2014-18590; block until the next break
//! after Zhang et al. 2016, Eng. Fract. Mech. 162:76).

use serde::{Deserialize, Serialize};

use perilife_laws::{Ageing, FatigueLaw, FatigueSettings};
use perilife_plate::loading::Loading;
use perilife_plate::material::Material;
use perilife_plate::specimen::Point;
use perilife_points::body::pre_crack::places_near;
use perilife_points::body::{Body, Bond};
use perilife_points::crack_tip::{CrackTip, ROUND_OFF};
use perilife_points::solver::field::Layout;
use perilife_points::state::Bonds;

/// Core bond strain over the strain measure K/(E √δ) of a crack tip: mean over bonds of a straight crack, conical kernel.
const CORE_STRAIN: f64 = 0.93;

/// A fatigue bond and its cyclic strain ε.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FatigueBond {
    pub bond: Bond,
    /// Cyclic strain ε = s_max (1-R)^γ, above zero.
    pub strain: f64,
}

/// Linearised bond stretch `s = n·(u' - u)/|ξ|` at maximum load.
pub fn stretch(body: &Body, layout: &Layout, displacement: &[f64], bond: Bond) -> f64 {
    let (k, from, to) = body.ends(bond);
    let (a, b) = (layout.index(from), layout.index(to));
    let spring = &body.stencil.bonds[k];
    let opening = spring.normal[0] * (displacement[b] - displacement[a])
        + spring.normal[1] * (displacement[b + layout.stride] - displacement[a + layout.stride]);
    opening / spring.length
}

/// Cyclic strain over the maximum stretch: (1-R)^γ with Walker's γ; compression is ignored (R ≥ 0).
pub fn strain_share(loading: &Loading, settings: &FatigueSettings) -> f64 {
    loading.range_share().powf(settings.walker_gamma)
}

/// Cyclic strain below which no bond of a crack tip ages for a threshold ΔK: `ε_th = f₀ ΔK_th / (E' √δ)`.
pub fn threshold_strain(settings: &FatigueSettings, material: &Material, horizon: f64) -> f64 {
    CORE_STRAIN * settings.threshold / (material.plane_modulus() * horizon.sqrt())
}

/// Intact bonds that may age at all, in ascending order: those in the zone of an active tip, or all.
///
/// The zone of a tip holds the bonds whose middle lies within its radius, and those that still bridge the crack behind
/// it. Without the bridges a crack that runs along a row of points, where the middles of the longest bonds across it lie at
/// the rim of a zone of half a horizon, would leave some unspent and stay pinned by them.
pub fn candidates(body: &Body, bonds: &Bonds, tips: &[CrackTip], settings: &FatigueSettings) -> Vec<Bond> {
    let may_fail = |bond: Bond| bonds.is_intact(bond) && body.can_fail(bond);
    let mut found: Vec<Bond> = match settings.ageing {
        Ageing::Everywhere => (0..body.multiplier.len()).map(|bond| bond as Bond).filter(|&bond| may_fail(bond)).collect(),
        Ageing::CrackTip => {
            let radius = settings.zone_radius_horizons * body.horizon();
            let active = tips.iter().filter(|tip| tip.is_active());
            active
                .flat_map(|tip| in_zone(body, bonds, tip, radius).into_iter().chain(tip.bridges.iter().copied()))
                .filter(|&bond| may_fail(bond))
                .collect()
        }
    };
    found.sort_unstable();
    found.dedup();
    found
}

/// Bonds of the zone of a tip; of those that bridge its wake the intact ones.
fn in_zone(body: &Body, bonds: &Bonds, tip: &CrackTip, radius: f64) -> Vec<Bond> {
    let (lattice, places) = (&body.lattice, body.places());
    let radius = radius * (1.0 + ROUND_OFF);
    let reach = radius + 0.5 * body.horizon();
    let behind = tip.wake.first().copied().unwrap_or(tip.position);
    // Half of every bond, and what its ends may be beyond the box of the wake without touching it.
    let halves: Vec<Point> = body.stencil.bonds.iter().map(|b| lattice.from_axes(b.normal.map(|n| 0.5 * b.length * n))).collect();
    let margin = ROUND_OFF * body.horizon();
    let box_end = |pick: fn(f64, f64) -> f64| [0, 1].map(|i| tip.wake.iter().map(|at| at[i]).fold(tip.position[i], pick));
    let (low, high) = (box_end(f64::min), box_end(f64::max));
    let may_bridge = |middle: Point, half: Point| {
        (0..2).all(|i| middle[i] + half[i].abs() + margin >= low[i] && middle[i] - half[i].abs() - margin <= high[i])
    };
    let mut found = Vec::new();
    for place in places_near(body, behind, tip.position, reach) {
        let from = lattice.position(place);
        for (k, half) in halves.iter().enumerate() {
            let bond = (k * places + place) as Bond;
            let middle = [from[0] + half[0], from[1] + half[1]];
            let [x, y] = [0, 1].map(|i| middle[i] - tip.position[i]);
            let is_bridge = || tip.is_bridge(from, lattice.position(place.wrapping_add_signed(body.steps[k])));
            if x * x + y * y <= radius * radius || may_bridge(middle, *half) && bonds.is_intact(bond) && is_bridge() {
                found.push(bond);
            }
        }
    }
    found
}

/// Of the candidates those in tension, with their cyclic strain. Bonds in compression are not spent.
///
/// The strain is `share` times the stretch.
pub fn fatigue_bonds(body: &Body, candidates: &[Bond], displacement: &[f64], (share, threshold): (f64, f64)) -> Vec<FatigueBond> {
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    candidates
        .iter()
        .map(|&bond| FatigueBond { bond, strain: share * stretch(body, &layout, displacement, bond) })
        .filter(|ageing| ageing.strain > threshold.max(0.0))
        .collect()
}

/// Indices of the active tips that cannot grow because every intact bond of their ageing zone touches a no-fail zone. Bonds near loads and
/// supports never break (point loads on a lattice would tear out otherwise), so a crack that starts or arrives there stands still for a
/// reason that lies in the model and not in the plate.
pub fn stuck(body: &Body, bonds: &Bonds, tips: &[CrackTip], settings: &FatigueSettings) -> Vec<usize> {
    // Where all bonds age, growth of one tip is still told by the bonds around it.
    let near = FatigueSettings { ageing: Ageing::CrackTip, ..*settings };
    let reach = (0.5 + settings.zone_radius_horizons) * body.horizon();
    let is_stuck = |tip: &CrackTip| {
        tip.is_active()
            && candidates(body, bonds, std::slice::from_ref(tip), &near).is_empty()
            && places_near(body, tip.position, tip.position, reach).any(|place| body.no_fail[place])
    };
    (0..tips.len()).filter(|&tip| is_stuck(&tips[tip])).collect()
}

/// Share of a bond's whole life within which bonds break together: mirror twins differ by round-off only.
pub const TOGETHER: f64 = 1e-9;

/// Remaining life λ of every bond.
#[derive(Debug, Clone, PartialEq)]
pub struct BondLife {
    life: Vec<f64>,
}

impl BondLife {
    /// Whole lives for `bonds` bond numbers.
    pub fn whole(bonds: usize) -> Self {
        BondLife { life: vec![1.0; bonds] }
    }

    /// Remaining life λ of a bond, 1 at first.
    pub fn of(&self, bond: Bond) -> f64 {
        self.life[bond as usize]
    }

    /// Sets the life a bond starts with.
    pub fn set(&mut self, bond: Bond, life: f64) {
        self.life[bond as usize] = life;
    }

    /// The bonds that have spent some of their life, ascending, and what remains of it.
    pub fn begun(&self) -> Vec<(Bond, f64)> {
        self.life.iter().enumerate().filter(|(_, life)| **life != 1.0).map(|(bond, life)| (bond as Bond, *life)).collect()
    }

    /// Cycles to the next break, and the bonds that break at its end; exact, since strains are constant until then.
    pub fn until_next_break(&self, law: &FatigueLaw, ageing: &[FatigueBond]) -> (f64, Vec<Bond>) {
        let rates: Vec<f64> = ageing.iter().map(|b| law.a * b.strain.powf(law.p)).collect();
        let left = ageing.iter().zip(&rates).map(|(b, &rate)| self.of(b.bond).max(0.0) / rate);
        let cycles = left.fold(f64::INFINITY, f64::min);
        let spent =
            ageing.iter().zip(&rates).filter(|(b, rate)| self.of(b.bond) - cycles * *rate <= TOGETHER).map(|(b, _)| b.bond);
        (cycles, spent.collect())
    }

    /// Takes the block's spending off every fatigue bond.
    pub fn spend(&mut self, law: &FatigueLaw, cycles: f64, ageing: &[FatigueBond]) {
        for bond in ageing {
            self.life[bond.bond as usize] -= cycles * law.a * bond.strain.powf(law.p);
        }
    }
}
