//! A crack that begins at a slot by the lives of its bonds, and goes on by the K of its tip.
//!
//! No K tells when a crack begins at the end of a slot, but bonds do: dλ/dN = -A ε^p ([`super`]). Of a crack that has begun the
//! same law leaves 15 to 16 % too little life (slot of 10 mm, horizons of 1.1 to 3 mm), since strains around a tip depend on lattice
//! and horizon. Its rate over K is known, da/dN = β A δ^(1-p/2) (K_eq/E')^p ([`crate::rate_constant`]), as soon as K can be read around
//! its tip. So once all cracks from slots are [`HAND_OVER_HORIZONS`] long, the plate is built anew with straight cracks of these lengths from the
//! slots to the tips, and their K drives them: cycles, growth and broken bonds are counted on in one curve. What is left of the life then
//! agrees within 0.6 % with that of the same cracks on nodes without elements.

use super::BondStrain;
use crate::CrackGrowth as _;
use crate::case::{Case, Engine};
use crate::record::{CurvePoint, TipRecord, Turn};
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_plate::specimen::geometry::direction;
use perilife_plate::specimen::{CrackLine, TipSeed};
use perilife_points::crack_tip::TipState;

/// Length of a crack from a slot, in horizons, at which K takes over. One horizon and two change the life by 1 to 2.5 %.
pub const HAND_OVER_HORIZONS: f64 = 1.5;
/// Growth, in horizons, that shows no direction of its own.
const SHORT_HORIZONS: f64 = 0.25;
/// Turn of a crack that is round-off: mirror images stay what they are.
const STRAIGHT: f64 = 1e-9;

impl BondStrain<'_> {
    /// One cycle block; K takes over once all tips are active, and those from slots have grown far enough.
    /// Errors: as [`BondStrain::next_break`].
    pub fn next_step(&mut self) -> Result<Option<Turn>> {
        if let Some(reason) = self.next_break()? {
            return Ok(Some(Turn::Stop(reason)));
        }
        let case = self.case;
        let least = HAND_OVER_HORIZONS * case.points().horizon_ratio * case.points().spacing;
        let is_ready =
            |(tip, seed): (&TipRecord, &TipSeed)| tip.state == TipState::Active && (!seed.from_slot || tip.growth >= least);
        let is_due = case.engine() == Engine::BondsThenPoints && self.now().tips.iter().zip(&case.specimen.tips).all(is_ready);
        Ok(is_due.then_some(Turn::HandOver))
    }

    /// What the user should know of a life without K.
    pub(super) fn why_no_tips(&self) -> Option<String> {
        (self.case.engine() == Engine::BondsThenPoints).then(|| {
            format!(
                "bonds: some cracks from slots stayed shorter than {HAND_OVER_HORIZONS} horizons, so K never set their rate: the whole life is by bond \
                 strains, which depend on lattice and horizon"
            )
        })
    }
}

/// What the user should know of the row at which K takes over.
pub fn note(row: &CurvePoint) -> String {
    format!(
        "hand-over: cracks initiated at slots by bond failure; from {:.0} cycles (a = {:.3} mm) growth is driven by K",
        row.cycles,
        row.crack_length / MM
    )
}

/// The case driven by the tips of cracks as bonds have left them: of each the growth as a straight piece towards its place.
pub fn cracked(case: &Case, tips: &[TipRecord]) -> Case {
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
    case.driven_by_tips(specimen)
}
