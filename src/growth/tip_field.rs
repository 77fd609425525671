//! Cracks driven by the stress intensity of their own tips.
//!
//! Per cycle block one equilibrium; K_I and K_II of every tip by the interaction integral on a ring around it
//! ([`crate::stress_intensity::ring`]); direction by the largest circumferential stress ([`steering`]); growth of every
//! tip by its own rate `da/dN` over the same cycles; every bond that a new piece of crack crosses is cut. A tip is a
//! point of a continuous line, so that neither path nor rate know the rows of points.
//!
//! A tip that meets another crack joins both: it is no tip any more, nor is the tip that it meets head-on, and the tips that are left
//! begin anew with the K that the joined crack gives them.

mod ahead;
mod approach;
mod factors;
mod readings;
mod run;
mod state;
pub mod steering;
pub(super) mod step;

pub use state::{Tip, TipFieldState, TipsState};

use std::collections::HashSet;
use std::sync::Arc;

use super::CrackGrowth;
use super::cross_check::{EnergyBalance, GivenOff};
use super::end_of_life::{End, first_end};
use super::plate::Plate;
use super::record::{CurvePoint, StopReason};
use crate::body::balanced::flanks::{self, Stretch};
use crate::body::pre_crack::bonds_across;
use crate::body::{Body, Bond};
use crate::bond_law::SurfaceCorrection;
use crate::case::Case;
use crate::error::{Error, Result, input};
use crate::fatigue::crack_tip::TipState;
use crate::fatigue::growth_law::{GrowthLaw, Walker};
use crate::fatigue::paris::ParisLaw;
use crate::fatigue::pieces::{Cut, set_aside};
use crate::solver::Equilibrium;
use crate::specimen::geometry::{along, distance};
use crate::specimen::{CrackLine, Point};
use crate::state::Bonds;
use crate::stress_intensity::ring::Surroundings;
use step::StepControl;

/// Outer radius of the ring, in horizons, where there is room. On three horizons K is read 0.1 % lower, and first kinks of one crack on
/// lattices of all directions spread over 0.7° instead of 0.4°.
const RING_HORIZONS: f64 = 4.0;
/// Distance from coarser points, in horizons, at which a run ends: the ring, which must not reach them, would be too narrow.
const RING_HORIZONS_IN_LEVELS: f64 = 1.5;
/// Distance from an edge, in spacings, from which points cannot resolve what is left.
const THROUGH_SPACINGS: f64 = 0.75;
/// Distance of a rim beside a tip, in spacings, from which nothing is left between them that carries.
const BESIDE_SPACINGS: f64 = 0.5;
/// Distance between a tip and the place where another meets its crack, in horizons, within which both are joined if they face each
/// other.
const JOINED_HORIZONS: f64 = 1.0;
/// Length, in horizons, by which cracks are shorter at first, to see how K changes with it; a quarter of a crack at the most.
const PROBE_HORIZONS: f64 = 0.5;
/// Residual over load of an equilibrium: factors are right to some 1e-8. Round-off allows no less where what is left of a plate is
/// nearly a mechanism.
const TOLERANCE: f64 = 1e-8;
/// A new straight piece of crack, and what becomes of the tip at its end.
struct Piece {
    from: Point,
    to: Point,
    state: TipState,
    /// The crack that it meets.
    meets: Option<usize>,
}

impl Piece {
    fn length(&self) -> f64 {
        distance(self.from, self.to)
    }
}

/// What a block did.
struct Block {
    /// Cycles it took.
    cycles: f64,
    /// Work of the loads at its end, J; NaN where there is no equilibrium.
    work: f64,
    /// Bonds cut.
    cut: usize,
    /// Why there is no next one.
    end: Option<StopReason>,
}

/// Growth by the field of every tip.
pub struct TipField<'a> {
    case: &'a Case,
    plate: Arc<Plate>,
    law: Box<dyn GrowthLaw>,
    surroundings: Surroundings,
    steps: StepControl,
    /// A known end of the run.
    end: Option<End>,
    /// Bonds that the initial cracks cut over their last [`PROBE_HORIZONS`].
    at_tips: Vec<Bond>,
    /// Which bonds carry.
    pub bonds: Bonds,
    /// Cracks and tips.
    pub state: TipFieldState,
    equilibrium: Equilibrium,
    /// In the layout of the equilibrium, m.
    displacement: Vec<f64>,
    solves: usize,
    iterations: usize,
    curve: Vec<CurvePoint>,
    /// Rows at the last time that the solver was built.
    anew: usize,
    /// About the rings of the initial tips.
    warnings: Vec<String>,
}

impl<'a> TipField<'a> {
    /// The plate with its initial cracks, before its first equilibrium ([`CrackGrowth::open`]).
    ///
    /// # Errors
    /// As [`Plate::build`]; a specimen without sharp crack, cracks that cut the plate in two.
    pub fn start(case: &'a Case, law: Box<dyn GrowthLaw>) -> Result<Self> {
        TipField::start_on(case, TipField::plate(case)?, law)
    }

    /// The discretised plate of a case.
    ///
    /// # Errors
    /// As [`Plate::build`].
    pub fn plate(case: &Case) -> Result<Arc<Plate>> {
        Plate::build(&case.specimen, &case.specimen, &case.material, &case.model).map(Arc::new)
    }

    /// The same on a plate that stands.
    ///
    /// # Errors
    /// A specimen without sharp crack, cracks that cut the plate in two.
    pub fn start_on(case: &'a Case, plate: Arc<Plate>, law: Box<dyn GrowthLaw>) -> Result<Self> {
        let specimen = &case.specimen;
        let tip = |tip: usize| {
            let end = specimen.line_end(tip).ok_or_else(|| {
                let problem = "needs sharp cracks: the end of a slot has no stress intensity factor";
                input("fatigue.driver", "\"tip_field\"", problem, "start a crack in the slot, or use driver = \"bond_strain\"")
            })?;
            Ok(Tip::new(specimen, end))
        };
        let tips = (0..specimen.tips.len()).map(tip).collect::<Result<Vec<_>>>()?;
        let body = &plate.body;
        let steps = StepControl::new(case, body.horizon());
        let state = TipFieldState { lines: specimen.crack_lines(), tips, step: steps.first(), balance: EnergyBalance::default() };
        if set_aside(body, &mut Bonds::new(body), &body.pre_cut) == Cut::Severed {
            return Err(Error::Mechanics(format!("{}: the initial cracks cut the plate in two", case.name)));
        }
        let at_tips = bonds_at_tips(body, &state);
        let mut bonds = Bonds::with_multipliers(body, body.multiplier.clone());
        let cut: Vec<Bond> = body.pre_cut.iter().copied().filter(|bond| at_tips.binary_search(bond).is_err()).collect();
        cut.iter().for_each(|&bond| bonds.cut(body, bond));
        set_aside(body, &mut bonds, &cut);
        let surroundings = Surroundings::new(body, specimen, &case.material);
        let equilibrium = balance(case, &plate, &bonds);
        let mut growth = TipField {
            case,
            law,
            surroundings,
            steps,
            end: first_end(case),
            at_tips,
            bonds,
            state,
            equilibrium,
            displacement: Vec::new(),
            solves: 0,
            iterations: 0,
            curve: Vec::new(),
            anew: 0,
            warnings: Vec::new(),
            plate,
        };
        growth.warnings = growth.ring_warnings();
        Ok(growth)
    }

    /// The fastest of the tips that grow.
    fn fastest(&self) -> Option<usize> {
        let growing = self.state.tips.iter().enumerate().filter(|(_, tip)| tip.is_growing());
        growing.max_by(|a, b| a.1.rate.total_cmp(&b.1.rate).then(b.0.cmp(&a.0))).map(|(index, _)| index)
    }

    fn position(&self, tip: &Tip) -> Point {
        self.state.lines[tip.end.line].end(tip.end.at_last)
    }

    /// Why growth ends where no tip is left.
    fn gone(&self) -> StopReason {
        let entered = self.state.tips.iter().any(|tip| matches!(tip.state, TipState::EnteredHole | TipState::LinkedUp));
        if entered { StopReason::EnteredHole } else { StopReason::LeftPlate }
    }

    /// One block: all tips grow, over the same cycles, until the crack has the length `until` at the latest.
    fn block(&mut self, cycles: f64, until: f64) -> Block {
        let none = |end: StopReason, work: f64| Block { cycles: 0.0, work, cut: 0, end: Some(end) };
        if self.state.tips.iter().all(|tip| tip.state != TipState::Active) {
            return none(self.gone(), self.equilibrium.work());
        }
        let plate = self.plate.clone();
        let body = &plate.body;
        let Some(fastest) = self.fastest() else { return none(StopReason::NothingAges, self.equilibrium.work()) };
        let reach = RING_HORIZONS_IN_LEVELS * body.horizon();
        if self.state.tips.iter().any(|tip| tip.state == TipState::Active && body.is_near_rim(self.position(tip), reach)) {
            return none(StopReason::LeftRefinement, self.equilibrium.work());
        }
        let rate = self.state.tips[fastest].rate;
        let ways = self.next_ways(fastest, cycles, until);

        let before = self.energies();

        // New pieces of crack.
        let mut cut: Vec<Bond> = Vec::new();
        let piece = |(tip, way): (&Tip, &f64)| (*way > 0.0).then(|| self.piece(tip, *way));
        let pieces: Vec<Option<Piece>> = self.state.tips.iter().zip(&ways).map(piece).collect();
        let grown = pieces[fastest].as_ref().map_or(0.0, Piece::length);
        // Rate at the start of the last step, and its length, of the tip whose cycles count.
        let past = self.state.tips[fastest].past;
        for (tip, piece) in self.state.tips.iter_mut().zip(&pieces) {
            let Some(Piece { from, to, state, .. }) = piece else {
                tip.stood_still(grown);
                continue;
            };
            cut.extend(across(body, *from, *to, tip.end.at_last, *state));
            self.state.lines[tip.end.line].grow(tip.end.at_last, *to);
            tip.has_grown(distance(*from, *to), grown, *state);
        }
        let has_ended = pieces.iter().flatten().any(|piece| piece.state != TipState::Active);
        if has_ended {
            self.join(&pieces);
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
        let broken = cut.len();
        let mut end = severed.then_some(StopReason::Severed);
        if end.is_none() {
            let lines = std::mem::take(&mut self.state.lines);
            let stretch = if has_ended { Stretch::All } else { Stretch::Tips };
            cut.extend(self.correct_flanks(&lines, stretch));
            self.state.lines = lines;
            end = self.settle(&cut).err().map(|error| match error {
                Error::GaveWay => StopReason::Severed,
                _ => StopReason::NoConvergence,
            });
        }
        if end.is_none() {
            self.read_factors();
            if self.state.tips.iter().any(|tip| !tip.equivalent().is_finite()) {
                return none(StopReason::NoConvergence, f64::NAN);
            }
        }
        // Where a tip is gone, K of the others is that of another crack at the end of the step, not of this one grown longer.
        let lead = &self.state.tips[fastest];
        let rate_then = if lead.is_growing() && end.is_none() && !has_ended { lead.rate } else { rate };
        let (cycles, bend) = step::cycles(past, rate, rate_then, grown);
        if has_ended {
            self.state.step = self.steps.first();
        } else if grown > 0.0 && end.is_none() {
            self.state.step = self.steps.next(grown, bend);
        }
        let closing = self.state.tips.iter().any(|tip| tip.state == TipState::Active && self.is_closing(tip));
        if has_ended || closing || end.is_some() {
            self.state.balance.forget();
        } else {
            let ways: Vec<f64> = pieces.iter().map(|piece| piece.as_ref().map_or(0.0, Piece::length)).collect();
            self.compare_energies(&before, &ways, cycles);
        }
        let work = if end.is_none() { self.equilibrium.work() } else { f64::NAN };
        let left = self.state.tips.iter().any(|tip| tip.state == TipState::Active);
        // What the last tip has met is known, whatever is left of the plate.
        if !left && !severed {
            end = Some(self.gone());
        }
        Block { cycles, work, cut: broken, end }
    }

    /// Of every tip `K_eq²/E'`, J/m², and the length that its cut bonds stand for beyond that of its line, m; work of the loads, J.
    fn energies(&self) -> (Vec<[f64; 2]>, f64) {
        let modulus = self.case.material.plane_modulus();
        let of_tip = |tip: &Tip| [tip.equivalent().powi(2) / modulus, tip.excess];
        (self.state.tips.iter().map(of_tip).collect(), self.equilibrium.work())
    }

    /// Compares what the block's new pieces gave off by their K with what the plate did.
    fn compare_energies(&mut self, (before, work): &(Vec<[f64; 2]>, f64), ways: &[f64], cycles: f64) {
        let (now, work_now) = self.energies();
        let of_tip = |((way, [then, excess_then]), [now, excess]): ((&f64, &[f64; 2]), [f64; 2])| {
            0.5 * (then + now) * (way + excess - excess_then)
        };
        let given_off: f64 = ways.iter().zip(before).zip(now).map(of_tip).sum();
        let length_less = |ways: &[f64]| {
            let growths: Vec<f64> = self.state.tips.iter().zip(ways).map(|(tip, way)| tip.growth - way).collect();
            self.case.specimen.crack_length_after(&growths)
        };
        let length = length_less(&vec![0.0; ways.len()]);
        let block = GivenOff {
            of_tips: self.case.specimen.thickness * given_off,
            of_plate: 0.5 * (work_now - work),
            growth: ways.iter().sum(),
            lengthening: length - length_less(ways),
            cycles,
        };
        self.state.balance.take(block, length, self.plate.body.horizon());
    }

    /// Joins cracks that have met, and lets the tips that are left forget what they were: the crack that they end is another one.
    fn join(&mut self, pieces: &[Option<Piece>]) {
        let reach = JOINED_HORIZONS * self.plate.body.horizon();
        for (tip, piece) in pieces.iter().enumerate() {
            let Some(Piece { from, to, meets: Some(met), .. }) = piece else { continue };
            let heading = [to[0] - from[0], to[1] - from[1]];
            let (own, lines) = (self.state.tips[tip].end.line, &self.state.lines);
            for other in self.state.tips.iter_mut().filter(|other| other.end.line == *met && other.end.line != own) {
                let line = &lines[other.end.line];
                let [x, y] = line.direction(other.end.at_last);
                let faces = heading[0] * x + heading[1] * y < 0.0;
                if other.state == TipState::Active && faces && distance(line.end(other.end.at_last), *to) < reach {
                    other.state = TipState::LinkedUp;
                }
            }
        }
        self.state.tips.iter_mut().for_each(Tip::begin_anew);
    }

    /// The next piece of crack at a tip: straight on, up to a rim or another crack if one lies on the way or right beside its end.
    fn piece(&self, tip: &Tip, way: f64) -> Piece {
        let (specimen, lines, body) = (&self.case.specimen, &self.state.lines, &self.plate.body);
        let spacing = body.lattice.spacing;
        let (from, ahead) = (self.position(tip), lines[tip.end.line].direction(tip.end.at_last));
        let direction = tip.steering.direction(tip.growth, way, ahead, body.horizon());
        let at = |way: f64| [0, 1].map(|i| from[i] + way * direction[i]);
        let (reach, next) = (at(way + THROUGH_SPACINGS * spacing), at(way));
        let near = ahead::first_rim(specimen, lines, tip.end.line, from, reach)
            .map(|(share, what)| (along(from, reach, share), what))
            .or_else(|| ahead::beside(specimen, lines, tip.end.line, next, BESIDE_SPACINGS * spacing));
        near.map_or(Piece { from, to: next, state: TipState::Active, meets: None }, |(to, what)| Piece {
            from,
            to,
            state: what.state,
            meets: what.crack,
        })
    }

    /// Bonds beside the flanks of the cracks that are cut; gives those that changed.
    fn correct_flanks(&mut self, lines: &[CrackLine], stretch: Stretch) -> Vec<Bond> {
        let is_balanced = self.case.model.bond_law.surface_correction == SurfaceCorrection::Balanced;
        if !is_balanced || self.plate.is_of_levels() {
            return Vec::new();
        }
        let end = |tip: &Tip| lines[tip.end.line].end(tip.end.at_last);
        let ends: Vec<Point> = self.state.tips.iter().map(end).collect();
        let tips: Vec<Point> = self.state.tips.iter().filter(|tip| tip.state == TipState::Active).map(end).collect();
        let body = &self.plate.body;
        let changed = flanks::multipliers(body, &self.bonds.multiplier, lines, &tips, &ends, stretch);
        changed.iter().for_each(|&(bond, multiplier)| self.bonds.set(body, bond, multiplier));
        changed.into_iter().map(|(bond, _)| bond).collect()
    }

    /// Equilibrium after bonds were cut or corrected; the displacement stays as it was where there is none.
    fn settle(&mut self, changed: &[Bond]) -> Result<()> {
        let plate = self.plate.clone();
        let body = &plate.body;
        self.equilibrium.broke(body, &self.bonds, changed);
        let before = self.displacement.clone();
        match self.equilibrium.solve(body, &self.bonds, &mut self.displacement) {
            Ok(iterations) => self.iterations += iterations,
            Err(error) => {
                self.displacement = before;
                return Err(error);
            }
        }
        self.solves += 1;
        Ok(())
    }
}

/// Largest K_eq of the tips at maximum load, Pa√m, of the plate with its initial cracks cleanly cut; `None` where it cannot be read.
pub fn initial_factor(case: &Case) -> Option<f64> {
    let law = Walker { paris: ParisLaw { c: 1.0, m: 1.0 }, gamma: 1.0, threshold: 0.0 };
    let mut growth = TipField::start(case, Box::new(law)).ok()?;
    growth.open().ok()?;
    growth.state.tips.iter().map(Tip::equivalent).max_by(f64::total_cmp)
}

/// Bonds that a new piece of crack crosses, in the sense of its line, so that points on it stay on one side; beyond a rim, all
/// that is left of it.
fn across(body: &Body, from: Point, to: Point, at_last: bool, state: TipState) -> Vec<Bond> {
    let beyond = if state == TipState::Active { 0.0 } else { body.lattice.spacing };
    let length = distance(from, to).max(f64::MIN_POSITIVE);
    let end = along(from, to, 1.0 + beyond / length);
    if at_last { bonds_across(body, from, end) } else { bonds_across(body, end, from) }
}

/// Bonds that the last [`PROBE_HORIZONS`] of the initial cracks cut, and nothing else of them, in ascending order.
fn bonds_at_tips(body: &Body, state: &TipFieldState) -> Vec<Bond> {
    let drawn_back = state.drawn_back(PROBE_HORIZONS * body.horizon());
    let across = |[a, b]: [Point; 2]| bonds_across(body, a, b);
    let kept: HashSet<Bond> = drawn_back.iter().flat_map(|line| line.pieces()).flat_map(across).collect();
    let last = state.tips.iter().map(|tip| {
        let [from, to] = [&drawn_back[tip.end.line], &state.lines[tip.end.line]].map(|line| line.end(tip.end.at_last));
        if tip.end.at_last { [from, to] } else { [to, from] }
    });
    let mut bonds: Vec<Bond> = last.flat_map(across).filter(|bond| !kept.contains(bond)).collect();
    bonds.sort_unstable();
    bonds.dedup();
    bonds
}

/// Solver of a run.
fn balance(case: &Case, plate: &Plate, bonds: &Bonds) -> Equilibrium {
    plate.equilibrium(&case.model, bonds, case.loading.maximum).to_tolerance(TOLERANCE)
}
