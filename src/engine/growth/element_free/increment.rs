//! One increment of all cracks, call by call ([`crate::predict::increment`]).

use super::ElementFree;
use super::front::{Front, kinked};
use super::step::Move;
use crate::element_free::crack::Tip;
use crate::element_free::factors::{self, overlap};
use crate::element_free::field::Discretisation;
use crate::element_free::resolution::{Resolution, room};
use crate::element_free::solve::solve;
use crate::error::Error;
use crate::fatigue::crack_tip::TipState;
use crate::growth::cross_check::{ReleasedEnergy, largest_difference};
use crate::growth::end_of_life::gone;
use crate::growth::record::StopReason;
use crate::growth::tip_field::step::cycles;
use crate::growth::{TipGrowth, end_of_life};
use crate::specimen::geometry::distance;
use crate::units::place_mm;

/// Overlap of flanks over the largest displacement between them up to which it is what the nodes err by.
const OVERLAP: f64 = 0.005;
/// Factor by which nodes get finer where K asks for it.
const FINER: f64 = 1.5;
/// Times that they do at the most.
const REFINEMENTS_MOST: usize = 2;
/// Nodes beyond which they do not.
const NODES_MOST: f64 = 2e4;

/// Compliance over that at the start from which a plate is as good as severed.
const MECHANISM: f64 = 20.0;

/// An increment in the making.
pub struct Increment {
    lead: usize,
    pub(super) moves: Vec<Move>,
    /// Rate of every tip at the start, m/cycle.
    rates: Vec<f64>,
    /// Rate of the lead before the last increment, and its growth in that, where no corner lies between.
    past: Option<[f64; 2]>,
    /// K_eq²/E' of every tip, J/m², and work of the loads, J.
    pub(super) before: (Vec<[f64; 2]>, f64),
    /// Whether the lead begins a kink.
    is_kink: bool,
    /// Tips that have met something, with what they have become.
    ended: Vec<TipState>,
    is_settled: bool,
    end: Option<StopReason>,
}

impl ElementFree<'_> {
    /// Nodes for the cracks as they are, and their equilibrium.
    pub(super) fn settle(&mut self) -> crate::error::Result<()> {
        let specimen = &self.case.specimen;
        let active = || self.state.fronts.iter().filter(|front| front.state == TipState::Active);
        let tips: Vec<Tip> = active().map(|front| Tip { end: front.end, length: front.own_length() }).collect();
        let resolution = self.resolution();
        let plate = Discretisation::new(specimen, self.elasticity, &self.state.lines, &tips, &resolution)?;
        let load = self.case.loading.maximum;
        let solution = solve(specimen, &plate, resolution.far, load)?;
        self.solves += 1;
        self.nodes = self.nodes.max(plate.nodes.at.len());
        self.work = solution.work;
        let overlap = overlap(specimen, &plate, self.state.lines.len(), &solution.u)?;
        self.plate = Some((plate, solution));
        match overlap.filter(|(_, share)| *share > OVERLAP) {
            None => Ok(()),
            Some((at, share)) => Err(Error::Mechanics(format!(
                "{}: the load presses flanks of a crack together at {}, by {:.1} % of the largest opening or sliding, and nodes know no contact: \
                 use model.method = \"peridynamics\"",
                self.case.name,
                place_mm(at),
                100.0 * share
            ))),
        }
    }

    /// How fine the nodes are.
    pub(super) fn resolution(&self) -> Resolution {
        self.settings.resolution.finer(self.state.fineness)
    }

    /// Makes the nodes as fine as K of the initial tips asks for: until it changes by no more than the tolerance when they get finer by
    /// [`FINER`]. What is then still open is said in a warning.
    pub(super) fn choose_fineness(&mut self) -> crate::error::Result<()> {
        let tolerance = self.settings.tolerance;
        self.state.fineness = 1.0 / FINER;
        // Where they are too coarse to tell anything, the next ones say so.
        let mut before = self.read_factors_of_plate().unwrap_or_else(|_| vec![[f64::NAN; 2]; self.state.fronts.len()]);
        for refinement in 0..=REFINEMENTS_MOST {
            self.state.fineness *= FINER;
            let now = self.read_factors_of_plate()?;
            let (tip, change) = largest_difference(&before, &now);
            let is_last =
                refinement == REFINEMENTS_MOST || self.settings.is_given || self.nodes as f64 * FINER * FINER > NODES_MOST;
            if change <= tolerance || is_last && change.is_nan() {
                break;
            }
            if is_last {
                self.warnings.push(format!(
                    "K of tip {tip} changes by {:.1} % when nodes get {FINER} times finer, to {} nodes: it may err by as much; \
                     model.method = \"peridynamics\" is another look at it",
                    100.0 * change,
                    self.nodes
                ));
                break;
            }
            before = now;
        }
        Ok(())
    }

    fn read_factors_of_plate(&mut self) -> crate::error::Result<Vec<[f64; 2]>> {
        self.settle()?;
        self.read()?;
        Ok(self.state.fronts.iter().map(|front| front.factors).collect())
    }

    /// Reads every active tip.
    pub(super) fn read(&mut self) -> crate::error::Result<()> {
        let Some((plate, solution)) = &self.plate else { return Ok(()) };
        let share = self.case.loading.share(self.work);
        let pressure = self.case.specimen.crack_pressure * self.case.loading.maximum;
        let lines = &self.state.lines;
        let active = self.state.fronts.iter_mut().filter(|front| front.state == TipState::Active);
        for (index, front) in active.enumerate() {
            let room = room(&self.case.specimen, lines, &Tip { end: front.end, length: front.own_length() });
            let read = factors::read(plate, &solution.u, index, room, pressure)?;
            front.factors = read.factors.map(|factor| share * factor);
            front.t_stress = share * read.t_stress;
            front.spacing = plate.axes[index].spacing;
        }
        Ok(())
    }

    /// Lets every active tip aim.
    pub(super) fn aim(&mut self) {
        let axes = self.plate.iter().flat_map(|(plate, _)| &plate.axes);
        let active = self.state.fronts.iter_mut().filter(|front| front.state == TipState::Active);
        for (front, axes) in active.zip(axes) {
            front.age += 1;
            // K_II is that of the axes in which it was read: the crack without corners that nodes do not see.
            let [x, y] = axes.ahead;
            front.aim_at(y.atan2(x));
        }
    }

    /// Takes the rate of every active tip; where it begins a kink, that of the kink (Amestoy and Leblond 1992).
    pub(super) fn rate(&mut self) {
        let before: Vec<f64> = self.state.fronts.iter().map(|front| front.rate).collect();
        for front in &mut self.state.fronts {
            let factor = if front.begins_kink() { kinked(front) } else { front.equivalent() };
            front.rate = if front.state == TipState::Active { self.law.rate(factor, self.case.loading.ratio) } else { 0.0 };
        }
        let fastest = self.state.fronts.iter().map(|front| front.rate).fold(0.0, f64::max);
        self.state.fronts.iter_mut().zip(before).for_each(|(front, before)| front.grow_at(before, fastest));
    }
}

impl TipGrowth for ElementFree<'_> {
    type Increment = Increment;

    fn reason_to_stop(&self) -> Option<StopReason> {
        let states: Vec<TipState> = self.state.fronts.iter().map(|front| front.state).collect();
        let last = &self.curve[self.curve.len() - 1];
        end_of_life::reason_to_stop(self.case, self.end, last, &states, self.fastest().is_some())
    }

    fn increments(&self) -> Increment {
        let lead = self.fastest().unwrap_or(0);
        let until = self.end.map_or(f64::INFINITY, |end| end.crack_length);
        let front = &self.state.fronts[lead];
        Increment {
            lead,
            moves: self.moves(lead, until),
            rates: self.state.fronts.iter().map(|front| front.rate).collect(),
            past: self.past,
            before: self.energies(),
            is_kink: front.begins_kink(),
            ended: Vec::new(),
            is_settled: false,
            end: None,
        }
    }

    fn extend_lines(&mut self, step: &mut Increment) {
        for (index, (to, state)) in self.targets(&step.moves).into_iter().enumerate() {
            let front = &self.state.fronts[index];
            let is_moved = step.moves[index].0 > 0.0 || state == TipState::LinkedUp;
            let length = if is_moved { distance(self.position(front), to) } else { 0.0 };
            let front = &mut self.state.fronts[index];
            (front.advance, step.moves[index].0) = (length, length);
            if length <= 0.0 {
                continue;
            }
            self.state.lines[front.end.line].grow(front.end.at_last, to);
            front.growth += length;
            front.state = state;
            if state != TipState::Active {
                front.rate = 0.0;
                step.ended.push(state);
            }
        }
        if !step.ended.is_empty() {
            self.state.fronts.iter_mut().for_each(Front::forget);
        }
    }

    fn part_plate(&mut self, _step: &mut Increment) {
        // Nodes are placed by `settle`, which needs the cracks alone.
        self.plate = None;
    }

    fn solve_equilibrium(&mut self, step: &mut Increment) {
        if !self.state.fronts.iter().any(|front| front.state == TipState::Active) {
            step.end = Some(gone(&step.ended));
            return;
        }
        match self.settle() {
            Ok(())
                if self.load_work().abs() > MECHANISM * self.curve[0].work.abs()
                    && self.case.loading.displacement().is_none() =>
            {
                step.end = Some(StopReason::Severed);
            }
            Ok(()) => step.is_settled = true,
            Err(Error::LossOfStiffness) => step.end = Some(StopReason::Severed),
            Err(error) => {
                self.warnings.push(format!("the run ends here: {error}"));
                step.end = Some(StopReason::NoConvergence);
            }
        }
    }

    fn read_factors(&mut self, step: &Increment) {
        if step.is_settled
            && let Err(error) = self.read()
        {
            self.warnings.push(format!("the run ends here: {error}"));
            self.state.fronts.iter_mut().for_each(|front| front.factors = [f64::NAN; 2]);
        }
    }

    fn turn(&mut self, step: &Increment) {
        if step.is_settled {
            self.aim();
        }
    }

    fn set_rates(&mut self, step: &Increment) {
        if step.is_settled {
            self.rate();
        }
    }

    fn add_row(&mut self, step: Increment) -> Option<StopReason> {
        let is_active = |front: &&Front| front.state == TipState::Active;
        if step.is_settled && self.state.fronts.iter().filter(is_active).any(|front| front.factors[0].is_nan()) {
            return Some(StopReason::NoConvergence);
        }
        let (grown, has_ended) = (step.moves[step.lead].0, !step.ended.is_empty());
        let (rate, is_over) = (step.rates[step.lead], step.end.is_some());
        let lead = &self.state.fronts[step.lead];
        // Of a tip that turns a corner the rate is that of its new kink.
        let rate_then = if lead.is_growing() && !is_over && !has_ended { self.rate_behind(lead) } else { rate };
        let (cycles, curvature) =
            if step.is_kink { (cycles_of_kink(grown, rate, rate_then), 0.0) } else { cycles(step.past, rate, rate_then, grown) };
        self.past = (!step.is_kink && !has_ended && !lead.begins_kink() && grown > 0.0).then_some([rate, grown]);
        if has_ended || self.state.fronts.iter().any(Front::begins_kink) {
            self.state.step = if self.fastest().is_some() { self.first_step() } else { 0.0 };
        } else if grown > 0.0 && !is_over {
            self.state.step = self.next_step(grown, curvature);
        }
        if has_ended || is_over {
            self.state.balance.forget();
        } else {
            self.compare_energies(&step, cycles);
        }
        let work = if is_over { f64::NAN } else { self.load_work() };
        let (row, reason) =
            end_of_life::row_after(self.case, &self.curve[self.curve.len() - 1], self.row(cycles, work), step.end);
        if cycles > 0.0 {
            self.curve.push(row);
        }
        reason
    }
}

/// Cycles of the first step of a kink, with ln of the rate linear in the root of its length: `∫ da/r = (2 s/r₀) [1 - e^-g (1 + g)]/g²`,
/// g = ln(r/r₀).
fn cycles_of_kink(grown: f64, rate: f64, rate_then: f64) -> f64 {
    let gain = (rate_then / rate).ln();
    let mean =
        if gain.abs() < 1e-4 { 1.0 - 2.0 / 3.0 * gain } else { 2.0 * (1.0 - (-gain).exp() * (1.0 + gain)) / (gain * gain) };
    grown / rate * mean
}

impl ElementFree<'_> {
    /// Of every tip `K_eq²/E'`, J/m², its crack being as long as its line; work of the loads, J.
    pub(super) fn energies(&self) -> (Vec<[f64; 2]>, f64) {
        let modulus = self.case.material.plane_modulus();
        let of_front = |front: &Front| {
            let factor = if front.begins_kink() { kinked(front) } else { front.equivalent() };
            [factor.powi(2) / modulus, 0.0]
        };
        (self.state.fronts.iter().map(of_front).collect(), self.load_work())
    }

    /// Compares the energy that the new segments released by their K with what the plate did.
    pub(super) fn compare_energies(&mut self, step: &Increment, cycles: f64) {
        let ((now, work_now), (before, work)) = (self.energies(), &step.before);
        let growths: Vec<f64> = step.moves.iter().map(|step| step.0).collect();
        let grown: Vec<f64> = self.state.fronts.iter().map(|front| front.growth).collect();
        let (block, length) = ReleasedEnergy::of_block(self.case, [before, &now], &growths, &grown, [*work, work_now], cycles);
        self.state.balance.take(block, length, 0.2 * self.resolution().far);
    }
}
