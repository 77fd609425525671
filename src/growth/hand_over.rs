//! A crack that begins at a slot by the lives of its bonds, and goes on by the K of its tip.
//!
//! No K tells when a crack begins at the end of a slot, but bonds do: dλ/dN = -A ε^p ([`super::bond_strain`]). Of a crack that has begun the
//! same law leaves 15 to 16 % too little life (slot of 10 mm, horizons of 1.1 to 3 mm), since strains around a tip depend on lattice
//! and horizon. Its rate over K is known, da/dN = β A δ^(1-p/2) (K_eq/E')^p ([`crate::rate_constant`]), as soon as K can be read around
//! its tip. So once all cracks from slots are [`HAND_OVER_HORIZONS`] long, the plate is built anew with straight cracks of these lengths from the
//! slots to the tips, and [`TipField`] takes it on: cycles, growth and broken bonds are counted on in one curve. What is left of the life then
//! agrees within 0.6 % with that of the same cracks on nodes without elements.

use std::cell::OnceCell;

use super::CrackGrowth as _;
use super::bond_strain::BondStrain;
use super::points::TipField;
use super::record::{CurvePoint, TipRecord};
use super::relay::{HandOver, Relay, Turn};
use crate::case::Case;
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_laws::FatigueLaw;
use perilife_laws::growth_law::GrowthLaw;
use perilife_plate::specimen::geometry::direction;
use perilife_plate::specimen::{CrackLine, Specimen, TipSeed};
use perilife_points::crack_tip::TipState;

/// Length of a crack from a slot, in horizons, at which K takes over. One horizon and two change the life by 1 to 2.5 %.
pub const HAND_OVER_HORIZONS: f64 = 1.5;
/// Growth, in horizons, that shows no direction of its own.
const SHORT_HORIZONS: f64 = 0.25;
/// Turn of a crack that is round-off: mirror images stay what they are.
const STRAIGHT: f64 = 1e-9;

/// Bonds that hand over to the K of tips.
pub struct ToTips<'a> {
    case: &'a Case,
    /// The case from the hand-over on.
    later: &'a OnceCell<Case>,
    law: Option<Box<dyn GrowthLaw>>,
}

/// The plate as it is cut. `law` is that of bonds at the body's horizon, m, `over_k` that of the tips, and `later` gets the case from the
/// hand-over on.
/// Errors: as [`BondStrain::start`].
pub fn start<'a>(
    case: &'a Case,
    later: &'a OnceCell<Case>,
    law: impl FnOnce(f64) -> Result<FatigueLaw>,
    over_k: Box<dyn GrowthLaw>,
) -> Result<Relay<ToTips<'a>>> {
    Ok(Relay::new(BondStrain::start(case, law)?, ToTips { case, later, law: Some(over_k) }))
}

impl<'a> HandOver for ToTips<'a> {
    type First = BondStrain<'a>;
    type Second = TipField<'a>;

    /// K takes over once all tips are active, and those from slots have grown far enough.
    fn step(&self, bonds: &mut BondStrain<'a>) -> Result<Option<Turn>> {
        if let Some(reason) = bonds.next_break()? {
            return Ok(Some(Turn::Stop(reason)));
        }
        let least = HAND_OVER_HORIZONS * self.case.points().horizon_ratio * self.case.points().spacing;
        let is_ready =
            |(tip, seed): (&TipRecord, &TipSeed)| tip.state == TipState::Active && (!seed.from_slot || tip.growth >= least);
        Ok(bonds.now().tips.iter().zip(&self.case.specimen.tips).all(is_ready).then_some(Turn::HandOver))
    }

    fn second(&mut self, _bonds: &BondStrain<'a>, last: &CurvePoint) -> Result<Option<TipField<'a>>> {
        let Some(law) = self.law.take() else { return Ok(None) };
        let later = self.later.get_or_init(|| {
            let mut later = self.case.driven_by_tips(cracked(self.case, &last.tips));
            later.stop.cycles_max -= last.cycles;
            later
        });
        TipField::start(later, law).map(Some)
    }

    fn take(&self, _bonds: &mut BondStrain<'a>, rows: &[CurvePoint]) -> Result<bool> {
        Ok(rows.last().is_some_and(|last| last.tips.len() == self.case.specimen.tips.len()))
    }

    fn note(&self, _bonds: &BondStrain<'a>, start: Option<&CurvePoint>) -> Option<String> {
        Some(match start {
            Some(row) => format!(
                "cracks initiated at slots by bond failure; from {:.0} cycles (a = {:.3} mm) growth is driven by K",
                row.cycles,
                row.crack_length / MM
            ),
            None => format!(
                "some cracks from slots stayed shorter than {HAND_OVER_HORIZONS} horizons, so K never set their rate: the whole life is by bond \
                 strains, which depend on lattice and horizon"
            ),
        })
    }
}

/// The specimen with the cracks as their tips have left them: of each the growth as a straight piece towards its place.
fn cracked(case: &Case, tips: &[TipRecord]) -> Specimen {
    let mut specimen = case.specimen.clone();
    let mut lines = specimen.crack_lines();
    let short = SHORT_HORIZONS * case.points().horizon_ratio * case.points().spacing;
    for (index, tip) in tips.iter().enumerate() {
        let seed = case.specimen.tips[index];
        let [x, y] = seed.direction;
        let towards = if tip.growth > short { direction(seed.position, tip.position) } else { seed.direction };
        let towards = if (x * towards[1] - y * towards[0]).abs() < STRAIGHT { seed.direction } else { towards };
        let end = [0, 1].map(|i| seed.position[i] + tip.growth * towards[i]);
        match case.specimen.line_end(index) {
            None => lines.push(CrackLine::straight(seed.position, end)),
            Some(of) if tip.growth > short => lines[of.line].grow(of.at_last, end),
            Some(of) => lines[of.line].stretch(of.at_last, tip.growth),
        }
        let position = case.specimen.line_end(index).map_or(end, |of| lines[of.line].end(of.at_last));
        specimen.tips[index] = TipSeed { position, direction: towards, from_slot: false };
    }
    specimen.crack_length = specimen.crack_length_after(&tips.iter().map(|tip| tip.growth).collect::<Vec<_>>());
    specimen.set_crack_lines(&lines);
    specimen
}
