//! A crack that begins at a slot by the lives of its bonds, and goes on by the K of its tip.
//!
//! No K tells when a crack begins at the end of a slot, but bonds do: dλ/dN = -A ε^p ([`super::bond_strain`]). Of a crack that has begun the
//! same law leaves 15 to 16 % too little life (slot of 10 mm, horizons of 1.1 to 3 mm), since strains around a tip depend on lattice
//! and horizon. Its rate over K is known, da/dN = β A δ^(1-p/2) (K_eq/E')^p ([`crate::rate_constant`]), as soon as K can be read around
//! its tip. So once all cracks from slots are [`HAND_OVER_HORIZONS`] long, the plate is built anew with straight cracks of these lengths from the
//! slots to the tips, and [`TipField`] takes it on: cycles, growth and broken bonds are counted on in one curve. What is left of the life then
//! agrees within 0.6 % with that of the same cracks on nodes without elements.

use std::cell::OnceCell;
use std::sync::Arc;

use super::bond_strain::BondStrain;
use super::cross_check::CrossCheck;
use super::later::{HandedOver, Later};
use super::points::TipField;
use super::record::{CurvePoint, StopReason, TipRecord};
use super::{CrackGrowth, Fields, GrowthStatus, SolverStatistics, State};
use crate::case::Case;
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_laws::FatigueLaw;
use perilife_laws::growth_law::GrowthLaw;
use perilife_plate::specimen::geometry::direction;
use perilife_plate::specimen::{CrackLine, Specimen, TipSeed};
use perilife_points::body::Body;
use perilife_points::crack_tip::TipState;

/// Length of a crack from a slot, in horizons, at which K takes over. One horizon and two change the life by 1 to 2.5 %.
pub const HAND_OVER_HORIZONS: f64 = 1.5;
/// Growth, in horizons, that shows no direction of its own.
const SHORT_HORIZONS: f64 = 0.25;
/// Turn of a crack that is round-off: mirror images stay what they are.
const STRAIGHT: f64 = 1e-9;

/// [`CrackGrowth`] by fatigue bonds, then by K.
pub struct HandOver<'a> {
    case: &'a Case,
    /// The case from the hand-over on.
    later: &'a OnceCell<Case>,
    law: Option<Box<dyn GrowthLaw>>,
    bonds: BondStrain<'a>,
    /// The run from the hand-over on.
    tips: Option<Later<TipField<'a>>>,
}

impl<'a> HandOver<'a> {
    /// The plate as it is cut. `law` is that of bonds at the body's horizon, m, `over_k` that of the tips, and `later` gets the case from the
    /// hand-over on.
    /// Errors: as [`BondStrain::start`].
    pub fn start(
        case: &'a Case,
        later: &'a OnceCell<Case>,
        law: impl FnOnce(f64) -> Result<FatigueLaw>,
        over_k: Box<dyn GrowthLaw>,
    ) -> Result<Self> {
        Ok(HandOver { case, later, law: Some(over_k), bonds: BondStrain::start(case, law)?, tips: None })
    }

    /// The next break of a bond, or the next `increment` of the tips; the reason why there is no next one.
    /// Errors: no equilibrium, or no K at a tip where K takes over.
    pub fn advance(&mut self, increment: impl FnOnce(&mut TipField<'a>) -> Option<StopReason>) -> Result<Option<StopReason>> {
        if let Some(tips) = &mut self.tips {
            let reason = increment(&mut tips.growth);
            tips.look();
            return Ok(reason);
        }
        let reason = self.bonds.next_break()?;
        // K takes over once all tips are active, and those from slots have grown far enough.
        let least = HAND_OVER_HORIZONS * self.case.points().horizon_ratio * self.case.points().spacing;
        let is_ready =
            |(tip, seed): (&TipRecord, &TipSeed)| tip.state == TipState::Active && (!seed.from_slot || tip.growth >= least);
        if reason.is_none() && self.bonds.now().tips.iter().zip(&self.case.specimen.tips).all(is_ready) {
            let (before, took) = (self.bonds.curve(), self.bonds.statistics());
            if let Some(mut tips) = self.tips_after(before, took)? {
                tips.open()?;
                self.tips = Some(tips);
            }
        }
        Ok(reason)
    }

    /// The run from the last of some rows on, before its first equilibrium; `None` where it was begun before, or there are no rows.
    fn tips_after(&mut self, before: Vec<CurvePoint>, took: SolverStatistics) -> Result<Option<Later<TipField<'a>>>> {
        let (Some(last), Some(law)) = (before.last(), self.law.take()) else { return Ok(None) };
        let later = self.later.get_or_init(|| {
            let mut later = self.case.driven_by_tips(cracked(self.case, &last.tips));
            later.stop.cycles_max -= last.cycles;
            later
        });
        Ok(Later::new(TipField::start(later, law)?, before, took))
    }

    fn now_growing(&self) -> &dyn CrackGrowth {
        match &self.tips {
            Some(tips) => &tips.growth,
            None => &self.bonds,
        }
    }

    fn growing(&mut self) -> &mut dyn CrackGrowth {
        match &mut self.tips {
            Some(tips) => &mut tips.growth,
            None => &mut self.bonds,
        }
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

impl CrackGrowth for HandOver<'_> {
    fn open(&mut self) -> Result<()> {
        self.bonds.open()
    }

    fn now(&self) -> GrowthStatus<'_> {
        self.tips.as_ref().map_or_else(|| self.bonds.now(), Later::now)
    }

    fn curve(&mut self) -> Vec<CurvePoint> {
        match &mut self.tips {
            Some(tips) => tips.curve(),
            None => self.bonds.curve(),
        }
    }

    fn state(&self) -> State {
        self.tips.as_ref().map_or_else(|| self.bonds.state(), Later::state)
    }

    fn restore(&mut self, state: State) -> Result<bool> {
        let HandedOver { before, took, tips } = match state {
            State::HandedOver(handed_over) => handed_over,
            state => return self.bonds.restore(state),
        };
        if before.last().is_none_or(|last| last.tips.len() != self.case.specimen.tips.len()) {
            return Ok(false);
        }
        let Some(mut after) = self.tips_after(before, took)? else { return Ok(false) };
        let fits = after.restore(*tips)?;
        if fits {
            self.tips = Some(after);
        }
        Ok(fits)
    }

    fn body(&self) -> Option<Arc<Body>> {
        self.now_growing().body()
    }

    fn fields(&mut self) -> Result<Option<Fields>> {
        self.growing().fields()
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        self.now_growing().law()
    }

    fn should_rebuild_solver(&self) -> bool {
        self.now_growing().should_rebuild_solver()
    }

    fn rebuild_solver(&mut self) -> Result<()> {
        self.growing().rebuild_solver()
    }

    fn close(&mut self, stop: StopReason) -> Result<StopReason> {
        self.growing().close(stop)
    }

    fn statistics(&self) -> SolverStatistics {
        self.tips.as_ref().map_or_else(|| self.bonds.statistics(), Later::statistics)
    }

    fn cross_check(&self, cycles: f64) -> Option<CrossCheck> {
        self.now_growing().cross_check(cycles)
    }

    fn warnings(&self) -> Vec<String> {
        let note = match self.tips.as_ref().map(Later::start) {
            Some(row) => format!(
                "the cracks began at slots by the lives of their bonds; from {:.0} cycles on, at a crack length of {:.3} mm, they grew by the K \
                 of their tips",
                row.cycles,
                row.crack_length / MM
            ),
            None => format!(
                "not all cracks from slots became {HAND_OVER_HORIZONS} horizons long, from where K of the tips sets the rate: all of the life is \
                 that of bonds by their own strains, which depend on lattice and horizon"
            ),
        };
        let mut warnings = self.now_growing().warnings();
        warnings.push(note);
        warnings
    }
}
