//! Cracks driven by the stress intensity of their own tips.
//!
//! Per cycle block one equilibrium; K_I and K_II of every tip by the interaction integral on a ring around it
//! ([`crate::stress_intensity::ring`]); direction by the largest circumferential stress ([`steering`]); growth of every tip by
//! its own rate `da/dN` over the same cycles; every bond that a new piece of crack crosses is cut. A tip is a point of a
//! continuous line, so that neither path nor rate know the rows of points.
//!
//! The block is as long as the fastest tip takes for a step. With its length as independent variable the other tips follow
//! `da_i/da = r_i/r`, by the rates of this block and the last one extrapolated to the middle of the step (Adams and Bashforth),
//! and the cycles are `∫ da/r` with ln r linear over the step between the rates at both of its ends.

mod ahead;
mod readings;
pub mod run;
mod state;
pub mod steering;

pub use state::{Step, Tip, TipFieldState};

use std::sync::Arc;

use super::plate::Plate;
use super::record::{StopReason, TipRecord};
use crate::body::pre_crack::bonds_across;
use crate::body::severed::represented_excess;
use crate::body::{Body, Bond};
use crate::case::Case;
use crate::error::{Error, Result, input};
use crate::fatigue::Driver;
use crate::fatigue::crack_tip::TipState;
use crate::fatigue::growth_law::GrowthLaw;
use crate::fatigue::pieces::{Cut, set_aside};
use crate::solver::Equilibrium;
use crate::specimen::geometry::{along, distance};
use crate::specimen::{CrackLine, LineEnd, Point, Specimen};
use crate::state::Bonds;
use crate::stress_intensity::ring::{Balanced, Surroundings};
use crate::units::MM;
use readings::Readings;
use steering::{Steering, equivalent_factor};

/// Outer radius of the ring, in horizons.
const RING_HORIZONS: f64 = 3.0;
/// Outer radius below which a ring says nothing, in horizons.
const RING_HORIZONS_MIN: f64 = 1.2;
/// How far ahead of its line a tip may stand, in horizons. Along rows of points it is 0.05 to 0.09 at ν = 0.3, 0.04 at ν = 0.1,
/// whatever the spacing.
const AHEAD_HORIZONS: f64 = 0.15;
/// Distance from coarser points, in horizons, at which a run ends: the ring, which must not reach them, would be too narrow.
const RING_HORIZONS_IN_LEVELS: f64 = 1.5;
/// Growth of a tip in the first block, in horizons: nothing is known yet of how its rate changes.
const STEP_FIRST_HORIZONS: f64 = 0.2;
/// Growth in a block at the most after a corner, in horizons, until the aims since then show how the crack curves.
const STEP_TURNING_HORIZONS: f64 = 0.4;
/// Growth in any block at the most, in horizons. Lives and paths against steps of a tenth: `tests/verification/tip_field.rs`.
const STEP_HORIZONS: f64 = 1.0;
/// Next step over the last one, at the most.
const STEP_RISE: f64 = 1.6;
/// Share of a block's cycles that the parabola may add: beyond it the rates lie on none.
const BEND_MOST: f64 = 0.02;
/// Growth in a block at the most, in horizons, where a rim or another crack lies within the ring, and K changes fast.
const STEP_NEAR_HORIZONS: f64 = 0.2;
/// Turn of a tip in a block at the most, rad, unless that makes the block shorter than the step near rims.
const TURN: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// Distance from a rim ahead, in horizons, within which the core of the tip is not that of a crack in a plate: K is held where it
/// is read to fall.
const CORE_HORIZONS: f64 = 0.6;
/// Growth after a corner, in horizons, below which points do not resolve the kink: K would be read up to 5 % low.
const KINK_HORIZONS: f64 = 0.5;
/// Distance from an edge, in spacings, from which points cannot resolve what is left.
const THROUGH_SPACINGS: f64 = 0.75;
/// Growth of a tip over that of the fastest, at the most, where rates are extrapolated.
const SHARE_MOST: f64 = 1.5;
/// Distance of a rim beside a tip, in spacings, from which nothing is left between them that carries.
const BESIDE_SPACINGS: f64 = 0.5;
/// Residual over load of an equilibrium: factors are right to some 1e-8. Round-off allows no less where what is left of a plate is
/// nearly a mechanism.
const TOLERANCE: f64 = 1e-8;
/// Way to a rim straight ahead, in horizons, that is gone in one block where it takes less than [`SHARE_LEFT`] of the cycles so far:
/// what is left of the plate there is nearly a mechanism, and says nothing about its life.
const LEFT_HORIZONS: f64 = 4.0;
const SHARE_LEFT: f64 = 5e-4;
/// Relative difference within which factors are those of mirror twins: far above what solver and tie breaks make of equal ones, far
/// below what shows in a life.
const ROUND_OFF: f64 = 1e-4;

/// A new straight piece of crack, and what becomes of the tip at its end.
struct Piece {
    from: Point,
    to: Point,
    state: TipState,
}

/// Growth by the field of every tip.
pub struct TipField<'a> {
    case: &'a Case,
    plate: Arc<Plate>,
    law: Box<dyn GrowthLaw>,
    surroundings: Surroundings,
    /// Measure of steps, m: the horizon, less where a smaller error is asked for than by default.
    measure: f64,
    /// Which bonds carry.
    pub bonds: Bonds,
    /// Cracks and tips.
    pub state: TipFieldState,
    equilibrium: Equilibrium,
    /// In the layout of the equilibrium, m.
    pub displacement: Vec<f64>,
    /// Equilibrium solves.
    pub solves: usize,
    /// Solver iterations.
    pub iterations: usize,
}

impl<'a> TipField<'a> {
    /// The plate with its initial cracks, before its first equilibrium ([`TipField::open`]).
    ///
    /// # Errors
    /// A specimen without sharp crack, cracks that cut the plate in two.
    pub fn start(case: &'a Case, plate: Arc<Plate>, law: Box<dyn GrowthLaw>) -> Result<Self> {
        let specimen = &case.specimen;
        let tip = |tip: usize| {
            let end = specimen.line_end(tip).ok_or_else(|| {
                let problem = "needs sharp cracks: the end of a slot has no stress intensity factor";
                input("fatigue.driver", "\"tip_field\"", problem, "start a crack in the slot, or use driver = \"bond_strain\"")
            })?;
            Ok(Tip {
                end,
                state: TipState::Active,
                growth: 0.0,
                factors: [0.0; 2],
                rate: 0.0,
                before: None,
                past: None,
                length: length_of(specimen, end),
                readings: Readings::default(),
                steering: Steering::default(),
            })
        };
        let tips = (0..specimen.tips.len()).map(tip).collect::<Result<Vec<_>>>()?;
        let body = &plate.body;
        let measure =
            (case.fatigue.block.error_percent / Driver::TipField.block_error_percent()).sqrt().min(1.0) * body.horizon();
        let state = TipFieldState { lines: specimen.crack_lines(), tips, step: STEP_FIRST_HORIZONS * measure };
        let mut bonds = Bonds::new(body);
        if set_aside(body, &mut bonds, &body.pre_cut) == Cut::Severed {
            return Err(Error::Mechanics(format!("{}: the initial cracks cut the plate in two", case.name)));
        }
        let surroundings = Surroundings::new(body, specimen, &case.material);
        let equilibrium = balance(case, &plate, &bonds);
        Ok(TipField {
            case,
            law,
            surroundings,
            measure,
            bonds,
            state,
            equilibrium,
            displacement: Vec::new(),
            solves: 0,
            iterations: 0,
            plate,
        })
    }

    /// The first equilibrium and its factors.
    ///
    /// # Errors
    /// No equilibrium, or no factor where a tip is too near to something else.
    pub fn open(&mut self) -> Result<()> {
        self.settle(&[])?;
        self.read_factors();
        if let Some(tip) = self.state.tips.iter().find(|tip| !tip.equivalent().is_finite()) {
            let [x, y] = self.position(tip).map(|metres| metres / MM);
            let problem = format!("{}: no stress intensity can be read at the crack tip at ({x:.4}, {y:.4}) mm", self.case.name);
            return Err(Error::Mechanics(format!("{problem}; give a smaller model.spacing_mm")));
        }
        Ok(())
    }

    /// Where an earlier run stood when it began anew ([`TipField::begin_anew`]), in place of the start; whether that fits.
    pub fn go_on_from(
        &mut self,
        state: TipFieldState,
        broken: &[Bond],
        displacement: Vec<f64>,
        (solves, iterations): (usize, usize),
    ) -> bool {
        let plate = self.plate.clone();
        broken.iter().for_each(|&bond| self.bonds.cut(&plate.body, bond));
        self.state = state;
        (self.solves, self.iterations) = (solves, iterations);
        self.displacement = displacement;
        self.begin_anew().is_ok()
    }

    /// Builds the solver anew from the bonds, so that what follows depends on them, on the state and on the displacement alone.
    ///
    /// # Errors
    /// No equilibrium.
    pub fn begin_anew(&mut self) -> Result<()> {
        self.equilibrium = balance(self.case, &self.plate, &self.bonds);
        self.settle(&[])
    }

    /// Points and bonds.
    #[must_use]
    pub fn body(&self) -> &Body {
        &self.plate.body
    }

    /// The plate.
    #[must_use]
    pub fn plate(&self) -> &Arc<Plate> {
        &self.plate
    }

    /// Law of growth.
    #[must_use]
    pub fn law(&self) -> &dyn GrowthLaw {
        &*self.law
    }

    /// Work of the loads, J.
    #[must_use]
    pub fn work(&self) -> f64 {
        self.equilibrium.work()
    }

    /// Tips in the order of `Specimen::tips`.
    #[must_use]
    pub fn tips(&self) -> Vec<TipRecord> {
        let now = |tip: &Tip| TipRecord { position: self.position(tip), growth: tip.growth, factors: Some(tip.factors) };
        self.state.tips.iter().map(now).collect()
    }

    /// K_eq at maximum load, Pa√m, and da/dN, m/cycle, of the fastest tip; `None` where none grows.
    #[must_use]
    pub fn leading(&self) -> Option<(f64, f64)> {
        self.fastest().map(|tip| (self.state.tips[tip].equivalent(), self.state.tips[tip].rate))
    }

    /// Why growth ends where no tip is left.
    fn gone(&self) -> StopReason {
        let entered = self.state.tips.iter().any(|tip| matches!(tip.state, TipState::EnteredHole | TipState::LinkedUp));
        if entered { StopReason::EnteredHole } else { StopReason::LeftPlate }
    }

    fn position(&self, tip: &Tip) -> Point {
        self.state.lines[tip.end.line].end(tip.end.at_last)
    }

    /// Whether a tip is left that grows.
    #[must_use]
    pub fn is_growing(&self) -> bool {
        self.fastest().is_some()
    }

    /// What the user should know about the rings of the initial tips.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let horizon = self.plate.body.horizon();
        let ends: Vec<LineEnd> = self.state.tips.iter().map(|tip| tip.end).collect();
        let short = ends.iter().filter(|&&end| {
            let wanted = RING_HORIZONS * horizon;
            self.surroundings.radius(&self.plate.body, &self.state.lines, end, &ends, wanted) < RING_HORIZONS_MIN * horizon
        });
        let words = |count: usize| {
            format!(
                "{count} of {} crack tips lie within {:.3} mm of another tip or a support: the ring that reads K is too narrow there, \
                 and K may err by some percent; give a smaller model.spacing_mm",
                ends.len(),
                (RING_HORIZONS_MIN + 0.2) * horizon / MM
            )
        };
        Some(short.count()).filter(|&count| count > 0).map(words).into_iter().collect()
    }

    /// Points that are solved for.
    #[must_use]
    pub fn points(&self) -> usize {
        self.equilibrium.points(&self.plate.body)
    }

    /// One block after so many `cycles`: all tips grow, over the same cycles, until the crack has the length `until` at the latest.
    pub fn advance(&mut self, cycles: f64, until: f64) -> Step {
        let none = |end: StopReason, work: f64| Step { cycles: 0.0, work, cut: 0, end: Some(end) };
        if self.state.tips.iter().all(|tip| tip.state != TipState::Active) {
            return none(self.gone(), self.work());
        }
        let plate = self.plate.clone();
        let body = &plate.body;
        let horizon = body.horizon();
        let Some(fastest) = self.fastest() else { return none(StopReason::NothingAges, self.work()) };
        let at_rim =
            |tip: &Tip| tip.state == TipState::Active && body.is_near_rim(self.position(tip), RING_HORIZONS_IN_LEVELS * horizon);
        if self.state.tips.iter().any(at_rim) {
            return none(StopReason::LeftRefinement, self.work());
        }
        let rate = self.state.tips[fastest].rate;

        let step = self.last_way(fastest).filter(|way| *way / rate < SHARE_LEFT * cycles).unwrap_or_else(|| self.step(rate));
        let ways = self.ways(fastest, step, until);

        // New pieces of crack.
        let mut cut: Vec<Bond> = Vec::new();
        let piece = |(tip, way): (&Tip, &f64)| (*way > 0.0).then(|| self.piece(tip, *way));
        let pieces: Vec<Option<Piece>> = self.state.tips.iter().zip(&ways).map(piece).collect();
        let grown = pieces[fastest].as_ref().map_or(0.0, |piece| distance(piece.from, piece.to));
        // Rate at the start of the last step, and its length, of the tip whose cycles count.
        let past = self.state.tips[fastest].past;
        for (tip, piece) in self.state.tips.iter_mut().zip(pieces) {
            tip.before = Some([tip.rate, grown]);
            let way = piece.as_ref().map_or(0.0, |piece| distance(piece.from, piece.to));
            tip.past = (way > 0.0 && tip.steering.corner().is_none()).then_some([tip.rate, way]);
            let Some(Piece { from, to, state }) = piece else { continue };
            cut.extend(across(body, from, to, tip.end.at_last, state));
            self.state.lines[tip.end.line].grow(tip.end.at_last, to);
            tip.growth += distance(from, to);
            tip.state = state;
        }
        cut.retain(|&bond| self.bonds.is_intact(bond));
        cut.sort_unstable();
        cut.dedup();

        // Equilibrium and factors at the end of the step.
        cut.iter().for_each(|&bond| self.bonds.cut(body, bond));
        let aside = set_aside(body, &mut self.bonds, &cut);
        let severed = matches!(aside, Cut::Severed);
        if let Cut::Whole(aside) = aside {
            cut.extend(aside);
        }
        let end = if severed {
            Some(StopReason::Severed)
        } else {
            match self.settle(&cut) {
                Ok(()) => None,
                Err(_) => Some(StopReason::NoConvergence),
            }
        };
        if end.is_none() {
            self.read_factors();
            if self.state.tips.iter().any(|tip| !tip.equivalent().is_finite()) {
                return none(StopReason::NoConvergence, f64::NAN);
            }
        }
        let lead = &self.state.tips[fastest];
        let rate_then = if lead.state == TipState::Active && end.is_none() && lead.rate > 0.0 { lead.rate } else { rate };
        let left = self.state.tips.iter().any(|tip| tip.state == TipState::Active);
        let bend = past.map_or(0.0, |[before, way]| bend([before, rate, rate_then], [way, grown]));
        let error = bend.abs().max(f64::MIN_POSITIVE);
        if grown > 0.0 && end.is_none() {
            let most = (0.01 * self.case.fatigue.block.error_percent / error).sqrt().min(STEP_RISE) * grown;
            self.state.step = most.clamp(STEP_NEAR_HORIZONS * self.measure, STEP_HORIZONS * self.measure);
        }
        let bend = if error < BEND_MOST { bend } else { 0.0 };
        Step {
            cycles: grown * mean_inverse(rate, rate_then) * (1.0 + bend),
            work: if end.is_none() { self.work() } else { f64::NAN },
            cut: cut.len(),
            end: end.or_else(|| (!left).then(|| self.gone())),
        }
    }

    /// How far every tip goes while the fastest goes a step, m, all less where the crack would become longer than `until`.
    fn ways(&self, fastest: usize, step: f64, until: f64) -> Vec<f64> {
        let lead = &self.state.tips[fastest];
        let share = |tip: &Tip| {
            let now = tip.rate / lead.rate;
            let Some(([before, since], [lead_before, _])) = tip.before.zip(lead.before) else { return now };
            // ln of the ratio is linear in the growth of the fastest.
            let known = before > 0.0 && lead_before > 0.0 && since > 0.0;
            if known { now * (now * lead_before / before).powf(0.5 * step / since) } else { now }
        };
        let grows = |tip: &Tip| tip.state == TipState::Active && tip.rate > 0.0;
        let way = |tip: &Tip| if grows(tip) { step * share(tip).min(SHARE_MOST) } else { 0.0 };
        let mut ways: Vec<f64> = self.state.tips.iter().map(way).collect();
        let length_after = |ways: &[f64]| {
            let growth: Vec<f64> = self.state.tips.iter().zip(ways).map(|(tip, way)| tip.growth + way).collect();
            self.case.specimen.crack_length_after(&growth)
        };
        let (now, then) = (length_after(&vec![0.0; ways.len()]), length_after(&ways));
        if then > until {
            let share = ((until - now) / (then - now)).clamp(0.0, 1.0);
            ways.iter_mut().for_each(|way| *way *= share);
        }
        ways
    }

    /// The next piece of crack at a tip: straight on, up to a rim or another crack if one lies on the way or right beside its end.
    fn piece(&self, tip: &Tip, way: f64) -> Piece {
        let (specimen, lines, body) = (&self.case.specimen, &self.state.lines, &self.plate.body);
        let spacing = body.lattice.spacing;
        let (from, ahead) = (self.position(tip), lines[tip.end.line].direction(tip.end.at_last));
        let direction = tip.steering.direction(tip.growth, way, ahead, body.horizon());
        let at = |way: f64| [0, 1].map(|i| from[i] + way * direction[i]);
        let (reach, next) = (at(way + THROUGH_SPACINGS * spacing), at(way));
        let (to, state) = match ahead::first_rim(specimen, lines, tip.end.line, from, reach) {
            Some((share, state)) => (along(from, reach, share), state),
            None => {
                ahead::beside(specimen, lines, tip.end.line, next, BESIDE_SPACINGS * spacing).unwrap_or((next, TipState::Active))
            }
        };
        Piece { from, to, state }
    }

    /// Growth of the fastest tip, of this rate, in the next block, m: no tip takes a longer step than its surroundings allow.
    fn step(&self, rate: f64) -> f64 {
        let horizon = self.plate.body.horizon();
        let of_tip = |tip: &Tip| {
            let near = is_near_rim(&self.case.specimen, &self.state.lines, tip.end, RING_HORIZONS * horizon);
            let most = if near {
                STEP_NEAR_HORIZONS * self.measure
            } else if tip.steering.is_turning(tip.growth, horizon) {
                self.state.step.min(STEP_TURNING_HORIZONS * self.measure)
            } else {
                self.state.step
            };
            let turn = TURN * self.measure / horizon;
            let turning = (turn / tip.steering.curvature(horizon).abs()).max(STEP_NEAR_HORIZONS * self.measure);
            most.min(turning) * rate / tip.rate
        };
        self.state
            .tips
            .iter()
            .filter(|tip| tip.state == TipState::Active && tip.rate > 0.0)
            .map(of_tip)
            .fold(f64::INFINITY, f64::min)
    }

    /// Way of a tip straight ahead to a rim or another crack, m, if it is short.
    fn last_way(&self, tip: usize) -> Option<f64> {
        let tip = &self.state.tips[tip];
        let (from, [x, y]) = (self.position(tip), self.state.lines[tip.end.line].direction(tip.end.at_last));
        let reach = LEFT_HORIZONS * self.plate.body.horizon();
        let to = [from[0] + reach * x, from[1] + reach * y];
        ahead::first_rim(&self.case.specimen, &self.state.lines, tip.end.line, from, to).map(|(share, _)| share * reach)
    }

    /// The fastest of the tips that grow.
    fn fastest(&self) -> Option<usize> {
        let tips = self.state.tips.iter().enumerate();
        let growing = tips.filter(|(_, tip)| tip.state == TipState::Active && tip.rate > 0.0);
        growing.max_by(|a, b| a.1.rate.total_cmp(&b.1.rate).then(b.0.cmp(&a.0))).map(|(index, _)| index)
    }

    /// Equilibrium after bonds were cut.
    fn settle(&mut self, cut: &[Bond]) -> Result<()> {
        let plate = self.plate.clone();
        let body = &plate.body;
        self.equilibrium.broke(body, &self.bonds, cut);
        self.iterations += self.equilibrium.solve(body, &self.bonds, &mut self.displacement)?;
        self.solves += 1;
        Ok(())
    }

    /// Factors, rates and aims of all tips that are left.
    fn read_factors(&mut self) {
        let plate = self.plate.clone();
        let body = &plate.body;
        let horizon = body.horizon();
        let active: Vec<LineEnd> =
            self.state.tips.iter().filter(|tip| tip.state == TipState::Active).map(|tip| tip.end).collect();
        let (maximum, ratio) = (self.case.loading.maximum, self.case.loading.ratio);
        let excesses: Vec<f64> = self
            .state
            .tips
            .iter()
            .filter(|tip| tip.state == TipState::Active)
            .map(|tip| represented_excess(body, &self.state.lines[tip.end.line], tip.end.at_last, tip.length + tip.growth))
            .collect();
        let read = |(&end, &excess): (&LineEnd, &f64)| {
            // The ring stands around the place to which the cut bonds reach.
            let mut lines = self.state.lines.clone();
            lines[end.line].stretch(end.at_last, excess);
            let (bonds, displacement) = (&self.bonds, &*self.displacement);
            let plate = Balanced { body, bonds, displacement, load: maximum, lines: &lines };
            let radius = self.surroundings.radius(body, &lines, end, &active, RING_HORIZONS * horizon);
            let clear = body.rim_distance(self.state.lines[end.line].end(end.at_last), radius).unwrap_or(radius);
            let ring = self.surroundings.factors(plate, end, clear.max(RING_HORIZONS_MIN * horizon));
            // Beside a rim what is read as a shift may be something else.
            let ahead = if ring.ahead.abs() < AHEAD_HORIZONS * horizon { ring.ahead } else { 0.0 };
            (ring.factors, excess + ahead)
        };
        let (mut factors, excesses): (Vec<[f64; 2]>, Vec<f64>) = active.iter().zip(&excesses).map(read).unzip();
        pair_twins(&mut factors);
        let mut factors = factors.into_iter().zip(excesses);
        for tip in self.state.tips.iter_mut() {
            tip.rate = 0.0;
            if tip.state != TipState::Active {
                continue;
            }
            let Some((read, excess)) = factors.next() else { continue };
            let specimen = &self.case.specimen;
            let ahead = self.state.lines[tip.end.line].direction(tip.end.at_last);
            tip.steering.read(read, tip.growth, ahead, horizon);
            tip.readings.take(equivalent_factor(read), tip.growth, excess, tip.steering.corner(), horizon);
            // Both modes alike: what the tip's field lacks or has too much is length.
            let mut share = tip.readings.share(excess, tip.length + tip.growth, horizon);
            // K that opens a kink starts at that of its direction; until the bonds show the kink, less is read.
            if tip.steering.corner().is_some_and(|corner| tip.growth < corner + KINK_HORIZONS * horizon && tip.growth > corner) {
                share = share.max(tip.equivalent() / equivalent_factor(read));
            }
            let factors = read.map(|factor| share * factor);
            let near = tip.growth > 0.0 && is_near_rim(specimen, &self.state.lines, tip.end, CORE_HORIZONS * horizon);
            let has_risen = equivalent_factor(factors) >= tip.equivalent();
            if has_risen || !near {
                tip.factors = factors;
            }
            tip.rate = self.law.rate(tip.equivalent(), ratio);
        }
    }
}

/// Whether a rim or another crack lies within `reach` straight ahead of a tip or 45° to either side.
fn is_near_rim(specimen: &Specimen, lines: &[CrackLine], end: LineEnd, reach: f64) -> bool {
    let (from, [x, y]) = (lines[end.line].end(end.at_last), lines[end.line].direction(end.at_last));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    [[x, y], [half * (x - y), half * (x + y)], [half * (x + y), half * (y - x)]]
        .into_iter()
        .map(|[x, y]| [from[0] + reach * x, from[1] + reach * y])
        .any(|to| ahead::first_rim(specimen, lines, end.line, from, to).is_some())
}

/// Length of crack that belongs to one of its ends, m: all, or half where both are tips.
fn length_of(specimen: &Specimen, end: LineEnd) -> f64 {
    let crack = specimen.cracks[end.line];
    let tips = specimen.tips.iter().filter(|tip| tip.position == crack.from || tip.position == crack.to).count();
    distance(crack.from, crack.to) / tips.max(1) as f64
}

/// Mean of 1/r between two rates with ln r linear between them, cycles/m.
fn mean_inverse(from: f64, to: f64) -> f64 {
    if to.is_infinite() {
        return 0.5 / from;
    }
    let fall = (from / to).ln();
    // (1/to - 1/from) / ln(from/to), whose difference loses digits where the rates are nearly equal.
    if fall.abs() < 1e-4 { (1.0 + 0.5 * fall) / from } else { (fall.exp_m1() / fall) / from }
}

/// Share by which a parabola of ln r through three rates raises `∫ da/r` over the second of the `ways` between them, m, above that
/// of the straight line: `c h²/6` with c the second divided difference.
fn bend([before, from, to]: [f64; 3], [first, second]: [f64; 2]) -> f64 {
    let slope = |a: f64, b: f64, way: f64| (b / a).ln() / way;
    let curvature = (slope(from, to, second) - slope(before, from, first)) / (first + second);
    let share = curvature * second * second / 6.0;
    if share.is_finite() { share } else { 0.0 }
}

/// Gives tips whose factors agree but for round-off and sign the same factors: mirror twins stay twins.
fn pair_twins(factors: &mut [[f64; 2]]) {
    for i in 1..factors.len() {
        for j in 0..i {
            let size = factors[j][0].abs().max(factors[j][1].abs());
            let equal = |a: f64, b: f64| (a.abs() - b.abs()).abs() <= ROUND_OFF * size;
            if equal(factors[i][0], factors[j][0]) && equal(factors[i][1], factors[j][1]) {
                factors[i] = [0, 1].map(|mode| factors[j][mode].abs().copysign(factors[i][mode]));
                break;
            }
        }
    }
}

/// Bonds that a new piece of crack crosses, in the sense of its line, so that points on it stay on one side; beyond a rim, all
/// that is left of it.
fn across(body: &Body, from: Point, to: Point, at_last: bool, state: TipState) -> Vec<Bond> {
    let beyond = if state == TipState::Active { 0.0 } else { body.lattice.spacing };
    let length = distance(from, to).max(f64::MIN_POSITIVE);
    let end = along(from, to, 1.0 + beyond / length);
    if at_last { bonds_across(body, from, end) } else { bonds_across(body, end, from) }
}

/// Solver of a run.
fn balance(case: &Case, plate: &Plate, bonds: &Bonds) -> Equilibrium {
    plate.equilibrium(&case.model, bonds, case.loading.maximum).to_tolerance(TOLERANCE)
}
