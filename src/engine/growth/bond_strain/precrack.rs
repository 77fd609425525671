//! The crack before N = 0.
//!
//! A test specimen is pre-cracked: at N = 0 the bonds around the tip have the lives that steady growth leaves them, some
//! ahead are broken already, some behind are not yet. A clean cut with whole lives, or with lives estimated from its own
//! field, grows 10 to 70 % too fast over its first horizon. So the crack is cut shorter and grown to its length before
//! cycles count: along its own line (`steady_profile`), whatever its bonds do, or freely (`grown`). Tips that are there wait
//! for the others.

use crate::body::Body;
use crate::body::pre_crack::bonds_cut_by;
use crate::case::Case;
use crate::error::{Result, input};
use crate::fatigue::Precrack as PrecrackKind;
use crate::fatigue::crack_tip::CrackTip;
use crate::fatigue::pieces::{Connectivity, remove_fragments};
use crate::growth::record::TipRecord;
use crate::specimen::geometry::distance;
use crate::specimen::{Specimen, TipSeed};
use crate::state::Bonds;
use crate::units::MM;

/// Growth before N = 0 of a `grown` crack, in horizons.
const GROWN_HORIZONS: f64 = 2.0;
/// Growth before N = 0 of a `steady_profile`, in horizons: the front has its steady shape after one.
const PROFILE_HORIZONS: f64 = 1.5;
/// Largest share of a crack that is taken back.
const SHARE_MAX: f64 = 0.5;
/// Lead of the broken bonds of a steady front over the sharp cut of the same compliance, in spacings: bonds still bridging
/// behind the tip hold the crack closed more than broken ones ahead open it. The length of a crack is the one its compliance
/// shows (`tests/verification/crack_length.rs`: 0.18 to 0.23 for p from 2 to 4).
const FRONT_OFFSET_SPACINGS: f64 = 0.2;

/// The plate from which a run starts, and the way of its tips to N = 0.
pub(super) struct Precrack {
    /// The specimen with its cracks as they are cut.
    pub specimen: Specimen,
    /// Length of the crack of every tip as it is cut, m.
    cracks: Vec<f64>,
    /// Growth of every tip at which it has its initial length, m.
    pre_growths: Vec<f64>,
    along_the_line: bool,
    /// Lead of a steady front, m.
    front_offset: f64,
    horizon: f64,
}

impl Precrack {
    /// Errors: a crack too short to be `grown`.
    pub(super) fn of(case: &Case) -> Result<Precrack> {
        let horizon = case.model.horizon_ratio * case.model.spacing;
        let front_offset = FRONT_OFFSET_SPACINGS * case.model.spacing;
        let mut specimen = case.specimen.clone();
        if case.fatigue.precrack == PrecrackKind::Grown {
            check_grown(&specimen, GROWN_HORIZONS * horizon)?;
        }
        let wanted = match case.fatigue.precrack {
            PrecrackKind::None => 0.0,
            PrecrackKind::Grown => GROWN_HORIZONS * horizon,
            PrecrackKind::SteadyProfile => PROFILE_HORIZONS * horizon,
        };
        let mut pre_growths = vec![0.0; specimen.tips.len()];
        let mut cracks = vec![specimen.smallest_flaw(); specimen.tips.len()];
        for ((tip, pre_growth), length) in case.specimen.tips.iter().zip(&mut pre_growths).zip(&mut cracks) {
            let crack = case.specimen.cracks.iter().find(|crack| crack.from == tip.position || crack.to == tip.position);
            let Some(crack) = crack.filter(|_| !tip.from_slot) else { continue };
            let ends = case.specimen.tips.iter().filter(|t| t.position == crack.from || t.position == crack.to).count();
            *length = distance(crack.from, crack.to) / ends.max(1) as f64;
            if wanted > 0.0 {
                let back = wanted.min(SHARE_MAX * *length);
                (*pre_growth, *length) = (back + front_offset, *length - back);
            }
        }
        let moves: Vec<f64> =
            pre_growths.iter().map(|&pre_growth| if pre_growth > 0.0 { front_offset - pre_growth } else { 0.0 }).collect();
        specimen.move_tips(&moves);
        let along_the_line = case.fatigue.precrack == PrecrackKind::SteadyProfile;
        Ok(Precrack { specimen, cracks, pre_growths, along_the_line, front_offset, horizon })
    }

    /// The tips of the cracks as they are cut.
    pub(super) fn tips(&self, body: &Body) -> Vec<CrackTip> {
        let tip = |((seed, &pre_growth), &crack): ((&TipSeed, &f64), &f64)| {
            let tip = CrackTip::at(seed, body).of_crack(crack);
            if self.along_the_line && pre_growth > 0.0 { tip.on_fixed_line() } else { tip }
        };
        self.specimen.tips.iter().zip(&self.pre_growths).zip(&self.cracks).map(tip).collect()
    }

    /// Every tip with its growth since it had its initial length, negative before, at the end of the sharp crack of the same
    /// compliance. From a clean cut the offset of the front builds up over the first horizon.
    pub(super) fn records(&self, tips: &[CrackTip]) -> Vec<TipRecord> {
        let record = |(tip, &pre_growth): (&CrackTip, &f64)| {
            let front_offset =
                if pre_growth > 0.0 { self.front_offset } else { self.front_offset * (tip.growth / self.horizon).min(1.0) };
            let before = if pre_growth > 0.0 { pre_growth - self.front_offset } else { 0.0 };
            let position = [0, 1].map(|i| tip.position[i] - front_offset * tip.direction[i]);
            TipRecord { state: tip.state, position, growth: tip.growth - before - front_offset, factors: None, t_stress: None }
        };
        tips.iter().zip(&self.pre_growths).map(record).collect()
    }

    /// Whether all tips have their initial length: cycles count.
    pub(super) fn is_over(&self, tips: &[CrackTip]) -> bool {
        tips.iter().zip(&self.pre_growths).all(|(tip, &pre_growth)| tip.growth >= pre_growth || !tip.is_active())
    }

    /// Growth of every tip at which it has its initial length, m.
    pub(super) fn pre_growths(&self) -> &[f64] {
        &self.pre_growths
    }

    /// Tips that are not there yet.
    pub(super) fn on_the_way(&self, tips: &[CrackTip]) -> Vec<CrackTip> {
        tips.iter()
            .zip(&self.pre_growths)
            .filter(|(tip, pre_growth)| tip.growth < **pre_growth)
            .map(|(tip, _)| tip.clone())
            .collect()
    }
}

/// Whether the cracks at their initial length leave two loaded pieces.
pub(super) fn cuts_in_two(body: &Body, bonds: &Bonds, case: &Case) -> bool {
    let mut bonds = bonds.clone();
    let cut = bonds_cut_by(body, &case.specimen);
    cut.iter().for_each(|&bond| bonds.cut(body, bond));
    remove_fragments(body, &mut bonds, &cut) == Connectivity::Severed
}

fn check_grown(specimen: &Specimen, back: f64) -> Result<()> {
    let least = 2.5 * back;
    if specimen.smallest_flaw() > least {
        return Ok(());
    }
    Err(input(
        "fatigue.precrack",
        "\"grown\"",
        format!("needs cracks longer than {:.2} mm, five horizons, to grow them from two horizons shorter", least / MM),
        "use \"steady_profile\", or a smaller model.spacing_mm",
    ))
}
