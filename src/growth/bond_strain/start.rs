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
use crate::fatigue::Precrack;
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
const LEAD_SPACINGS: f64 = 0.2;

/// The plate from which a run starts, and the way of its tips to N = 0.
pub(super) struct Start {
    /// The specimen with its cracks as they are cut.
    pub specimen: Specimen,
    /// Length of the crack of every tip as it is cut, m.
    cracks: Vec<f64>,
    /// Growth of every tip at which it has its initial length, m.
    lags: Vec<f64>,
    along_the_line: bool,
    /// Lead of a steady front, m.
    lead: f64,
    horizon: f64,
}

impl Start {
    /// # Errors
    /// A crack too short to be `grown`.
    pub(super) fn of(case: &Case) -> Result<Start> {
        let horizon = case.model.horizon_ratio * case.model.spacing;
        let lead = LEAD_SPACINGS * case.model.spacing;
        let mut specimen = case.specimen.clone();
        if case.fatigue.precrack == Precrack::Grown {
            check_grown(&specimen, GROWN_HORIZONS * horizon)?;
        }
        let wanted = match case.fatigue.precrack {
            Precrack::None => 0.0,
            Precrack::Grown => GROWN_HORIZONS * horizon,
            Precrack::SteadyProfile => PROFILE_HORIZONS * horizon,
        };
        let mut lags = vec![0.0; specimen.tips.len()];
        let mut cracks = vec![specimen.smallest_flaw(); specimen.tips.len()];
        for ((tip, lag), length) in case.specimen.tips.iter().zip(&mut lags).zip(&mut cracks) {
            let crack = case.specimen.cracks.iter().find(|crack| crack.from == tip.position || crack.to == tip.position);
            let Some(crack) = crack.filter(|_| !tip.from_slot) else { continue };
            let ends = case.specimen.tips.iter().filter(|t| t.position == crack.from || t.position == crack.to).count();
            *length = distance(crack.from, crack.to) / ends.max(1) as f64;
            if wanted > 0.0 {
                let back = wanted.min(SHARE_MAX * *length);
                (*lag, *length) = (back + lead, *length - back);
            }
        }
        let moves: Vec<f64> = lags.iter().map(|&lag| if lag > 0.0 { lead - lag } else { 0.0 }).collect();
        specimen.move_tips(&moves);
        let along_the_line = case.fatigue.precrack == Precrack::SteadyProfile;
        Ok(Start { specimen, cracks, lags, along_the_line, lead, horizon })
    }

    /// The tips of the cracks as they are cut.
    pub(super) fn tips(&self, body: &Body) -> Vec<CrackTip> {
        let tip = |((seed, &lag), &crack): ((&TipSeed, &f64), &f64)| {
            let tip = CrackTip::at(seed, body).of_crack(crack);
            if self.along_the_line && lag > 0.0 { tip.on_rails() } else { tip }
        };
        self.specimen.tips.iter().zip(&self.lags).zip(&self.cracks).map(tip).collect()
    }

    /// Every tip with its growth since it had its initial length, negative before, at the end of the sharp crack of the same
    /// compliance. From a clean cut the lead of the front builds up over the first horizon.
    pub(super) fn records(&self, tips: &[CrackTip]) -> Vec<TipRecord> {
        let record = |(tip, &lag): (&CrackTip, &f64)| {
            let lead = if lag > 0.0 { self.lead } else { self.lead * (tip.growth / self.horizon).min(1.0) };
            let before = if lag > 0.0 { lag - self.lead } else { 0.0 };
            let position = [0, 1].map(|i| tip.position[i] - lead * tip.direction[i]);
            TipRecord { position, growth: tip.growth - before - lead, factors: None, t_stress: None }
        };
        tips.iter().zip(&self.lags).map(record).collect()
    }

    /// Whether all tips have their initial length: cycles count.
    pub(super) fn is_over(&self, tips: &[CrackTip]) -> bool {
        tips.iter().zip(&self.lags).all(|(tip, &lag)| tip.growth >= lag || !tip.is_active())
    }

    /// Growth of every tip at which it has its initial length, m.
    pub(super) fn lags(&self) -> &[f64] {
        &self.lags
    }

    /// Tips that are not there yet.
    pub(super) fn on_the_way(&self, tips: &[CrackTip]) -> Vec<CrackTip> {
        tips.iter().zip(&self.lags).filter(|(tip, lag)| tip.growth < **lag).map(|(tip, _)| tip.clone()).collect()
    }
}

/// Whether the cracks at their initial length leave two loaded pieces.
pub(super) fn cuts_in_two(body: &Body, bonds: &Bonds, case: &Case) -> bool {
    let mut bonds = bonds.clone();
    let cut = bonds_cut_by(body, &case.specimen.cracks);
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
