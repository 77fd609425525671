//! What a run carries of its cracks and their tips from increment to increment.

use serde::{Deserialize, Serialize};

use super::kink::Kink;
use super::steering::{Steering, equivalent_factor, factor_across, kink_angle};
use crate::cross_check::EnergyBalance;
use perilife_laws::response::Response;
use perilife_plate::specimen::{CrackLine, LineEnd, Point, Specimen};
use perilife_points::crack_tip::TipState;

/// |K_II| over the |K_I| that the load presses a tip with, below which it is noise of the reading.
const STANDING: f64 = 0.01;
/// Rate over that of the fastest tip below which how a tip's own rate and direction change says nothing.
const REST: f64 = 0.0025;

/// What an engine reads at a tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// K_I and K_II at maximum load, Pa√m.
    pub factors: [f64; 2],
    /// Stress along the crack T at maximum load, Pa.
    pub t_stress: f64,
    /// Unit vector x₁ of the axes in which they were read.
    pub ahead: Point,
    /// Spacing of points or nodes at the tip, m.
    pub spacing: f64,
    /// How far ahead of the end of its line the crack is that has these factors, m.
    pub length_offset: f64,
    /// Whether flanks are in contact up to the tip.
    pub is_closed: bool,
    /// What the pressure between flanks adds to K_I, Pa√m.
    pub of_pressure: f64,
    /// How K_eq follows the load.
    pub response: Response,
}

/// What is read at a tip under one load.
#[derive(Debug, Clone, Copy)]
pub struct AtLoad {
    /// The load over the largest.
    pub load: f64,
    /// K_I and K_II, Pa√m.
    pub factors: [f64; 2],
    /// Stress along the crack T, Pa.
    pub t_stress: f64,
    /// Whether flanks are in contact up to the tip.
    pub is_closed: bool,
    /// K_I and K_II of free flanks, Pa√m; `None` where K of a closed tip counts as in proportion to the load.
    pub free: Option<[f64; 2]>,
}

impl Reading {
    /// With what was read under other loads; `own` is that of the reading itself. The load that drives the tip most gives its factors, by K_II alone where flanks slide. A tip that
    /// is closed has the K below zero that superposition gives it, as laws take it for compression.
    /// `by_load` says whether K follows every load of one sign in proportion.
    pub fn beside(self, own: AtLoad, others: &[AtLoad], by_load: bool) -> Reading {
        if others.is_empty() {
            return self;
        }
        let mut all: Vec<&AtLoad> = others.iter().chain([&own]).collect();
        let size = |at: &AtLoad| equivalent_factor(at.factors);
        let top = *all.iter().copied().max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(&own);
        let (angle, whole) = (kink_angle(top.factors), size(&top));
        all.sort_by(|a, b| a.load.total_cmp(&b.load));
        let pair = |at: &&AtLoad| {
            let across = factor_across(at.factors, angle);
            let formal = || at.free.map_or(at.load / top.load * whole, |free| factor_across(free, angle));
            [at.load, if at.is_closed && across <= STANDING * whole { formal().min(0.0) } else { across } / whole]
        };
        let mut pairs: Vec<[f64; 2]> = all.iter().map(pair).collect();
        if let Some(place) = pairs.windows(2).position(|pair| pair[0][1] < 0.0 && pair[1][1] > 0.0) {
            // On the branch of the open tip down to the load that opens it.
            let [from, to] = [pairs[place + 1], *pairs.get(place + 2).unwrap_or(&pairs[place + 1])];
            let opens = from[0] - from[1] * (to[0] - from[0]) / (to[1] - from[1]);
            let opens = if by_load { 0.0 } else { opens };
            if opens > pairs[place][0] && opens < from[0] {
                pairs.insert(place + 1, [opens, 0.0]);
            }
        } else if let Some(place) = pairs.windows(2).position(|pair| by_load && pair[0][0] < 0.0 && pair[1][0] > 0.0) {
            pairs.insert(place + 1, [0.0, 0.0]);
        }
        let response = Response::new(&pairs);
        Reading { factors: top.factors, t_stress: top.t_stress, is_closed: top.is_closed, response, ..self }
    }

    /// Whether the load presses the tip shut, and its flanks do not slide but for the noise of the reading.
    fn stands(&self) -> bool {
        let pressed = if self.is_closed { self.of_pressure } else { self.factors[0] };
        self.factors[0] <= 0.0 && self.factors[1].abs() < STANDING * pressed.abs()
    }
}

/// A tip that grows by its own K.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tip {
    pub end: LineEnd,
    pub state: TipState,
    /// Growth since the start, m.
    pub growth: f64,
    /// K_I and K_II at maximum load at the present length, Pa√m.
    pub factors: [f64; 2],
    /// How K_eq follows the load.
    pub response: Response,
    /// Stress along the crack T at maximum load, Pa.
    pub t_stress: f64,
    /// da/dN at the present length, m/cycle; of a kink that begins that of none of its length.
    pub rate: f64,
    /// Length of crack that belonged to it at the start, m.
    pub length: f64,
    /// How far ahead of the end of its line the crack is whose K was read last, m.
    pub length_offset: f64,
    /// Spacing of points or nodes at it, m.
    pub spacing: f64,
    pub steering: Steering,
    /// The kink at its last corner, while K is that of a short kink.
    pub kink: Option<Kink>,
    /// Whether its flanks are in contact and do not slide: it does not grow.
    pub is_closed: bool,
    pub was_closed: bool,
    /// Rate before the last increment, and the growth of the fastest tip in that, where ln of the rate is smooth over it.
    before: Option<[f64; 2]>,
    /// Rate before the last increment and its own growth in it, where no corner lies between.
    past: Option<[f64; 2]>,
    /// By how much it is short of the growth that the rates at both ends of all increments ask for, m: made up for in the next one.
    pub(super) arrears: f64,
}

impl Tip {
    /// A tip of the initial cracks.
    pub fn new(specimen: &Specimen, end: LineEnd) -> Self {
        // All of its crack belongs to it, or half where both ends are tips.
        let line = &specimen.crack_lines()[end.line];
        Tip {
            end,
            state: TipState::Active,
            growth: 0.0,
            factors: [0.0; 2],
            response: Response::PROPORTIONAL,
            t_stress: 0.0,
            rate: 0.0,
            length: line.length() / specimen.tips_of(line).max(1) as f64,
            length_offset: 0.0,
            spacing: 0.0,
            steering: Steering::default(),
            kink: None,
            is_closed: false,
            was_closed: false,
            before: None,
            past: None,
            arrears: 0.0,
        }
    }

    pub fn is_active(&self) -> bool {
        self.state == TipState::Active
    }

    /// Whether it grows under this load.
    pub fn is_growing(&self) -> bool {
        self.is_active() && self.rate > 0.0
    }

    /// K_eq at maximum load, Pa√m.
    pub fn equivalent(&self) -> f64 {
        equivalent_factor(self.factors)
    }

    /// Whether its next step begins a kink.
    pub fn begins_kink(&self) -> bool {
        self.steering.corner() == Some(self.growth)
    }

    /// K at maximum load that drives it, Pa√m: of a kink that begins that of none of its length.
    pub fn driving_factor(&self) -> f64 {
        if self.is_closed {
            0.0
        } else if self.begins_kink() {
            self.kink.map_or(0.0, |kink| kink.opening(0.0))
        } else {
            self.equivalent()
        }
    }

    /// Length of crack that its field knows of, m: since the last corner, if there is one and growth since it is more than `least`, m.
    pub fn own_length(&self, least: f64) -> f64 {
        match self.steering.last_corner() {
            Some(corner) if self.growth > corner + least => self.growth - corner,
            _ => self.length + self.growth,
        }
    }

    /// Root of the length of crack that its field knows of after a growth, m^½: 0 where a kink begins.
    pub(super) fn root(&self, growth: f64) -> f64 {
        let since = self.steering.last_corner().map_or(self.length + growth, |corner| growth - corner);
        since.max(0.0).sqrt()
    }

    /// What aim and ln of the rate are smooth in at a growth, m: that, or the root of the length of crack.
    pub(super) fn smooth_in(&self, by_root: bool) -> impl Fn(f64) -> f64 {
        move |growth| if by_root { self.root(growth) } else { growth }
    }

    /// Whether its last increment began a kink, or was the first after a joint.
    pub(super) fn has_begun_kink(&self) -> bool {
        self.before.is_none()
    }

    /// Takes in an increment in which it grew by `growth` and the fastest tip by `fastest`, m, and what has become of it; `by_root` as in
    /// [`super::scales::Scales`].
    pub(super) fn has_grown(&mut self, [growth, fastest]: [f64; 2], state: TipState, by_root: bool) {
        self.before = (!self.begins_kink()).then_some([self.rate, fastest]);
        // In the root of its length the rate of a kink is smooth from its start on.
        let is_smooth = by_root || self.steering.corner().is_none();
        self.past = (growth > 0.0 && is_smooth).then_some([self.rate, growth]);
        self.growth += growth;
        self.state = state;
        if !self.is_active() {
            self.rate = 0.0;
        }
    }

    /// Rate before the last increment and its own growth in it, m, where ln of the rate is smooth over it.
    pub(super) fn past(&self) -> Option<[f64; 2]> {
        self.past
    }

    /// Whether it grows so slowly beside the fastest tip, of this rate, that how its own rate and direction change says nothing.
    pub(super) fn is_at_rest(&self, fastest: f64) -> bool {
        self.rate <= REST * fastest
    }

    /// Rate over that of the tip `lead`, in the middle of a step of that by `step`, m: ln of it is linear in the growth of the lead; or, `by_root`,
    /// ln of the rate of either in the root of its own length.
    pub(super) fn share(&self, lead: &Tip, step: f64, by_root: bool) -> f64 {
        let now = self.rate / lead.rate;
        if by_root {
            return now * (self.gain(0.5 * step * now, lead.rate) - lead.gain(0.5 * step, lead.rate)).exp();
        }
        let Some(([before, since], [lead_before, _])) = self.before.zip(lead.before) else { return now };
        let is_known = before > 0.0 && lead_before > 0.0 && since > 0.0 && !self.is_at_rest(lead.rate);
        if is_known { now * (now * lead_before / before).powf(0.5 * step / since) } else { now }
    }

    /// Counts what it is short of after an increment in which it grew by `growth` and the tip `lead` by `step`, m: `∫ r/r_lead da`, ln of the
    /// ratio of rates linear between both ends, less what it grew, beside what it was short of before.
    pub(super) fn count_arrears(&mut self, growth: f64, (lead_before, lead_rate): (f64, f64), step: f64) {
        let Some([before, _]) = self.before.filter(|_| !self.begins_kink()) else {
            self.arrears = 0.0;
            return;
        };
        let [from, to] = [before / lead_before, self.rate / lead_rate];
        let gain = (to / from).ln();
        let mean = if gain.abs() < 1e-6 { from } else { (to - from) / gain };
        let short = step * mean - growth + self.arrears;
        // Rates that jump, as at a joint, lie on no line.
        self.arrears = if short.is_finite() { short.clamp(-0.5 * growth, 0.5 * growth) } else { 0.0 };
    }

    /// Share of its growth in the last increment when the fastest tip had made the share `of_lead`, as in [`Self::count_arrears`].
    pub(super) fn share_at(&self, of_lead: f64, (lead_before, lead_rate): (f64, f64)) -> f64 {
        let Some([before, _]) = self.before.filter(|_| !self.begins_kink()) else { return of_lead };
        let gain = (self.rate / before * lead_before / lead_rate).ln();
        let share = (gain * of_lead).exp_m1() / gain.exp_m1();
        if share.is_finite() { share } else { of_lead }
    }

    /// By how much ln of its rate rises in its next `growth`, m, linear in the root of its length as in the last one.
    fn gain(&self, growth: f64, fastest: f64) -> f64 {
        let Some([before, last]) = self.past.filter(|[before, _]| *before > 0.0 && !self.is_at_rest(fastest)) else { return 0.0 };
        let [from, now, then] = [-last, 0.0, growth].map(|way| self.root(self.growth + way));
        let gain = (self.rate / before).ln() * (then - now) / (now - from);
        if gain.is_finite() { gain } else { 0.0 }
    }

    /// Takes in what was read, as far as it says where the tip turns to.
    pub(super) fn turn(&mut self, reading: &Reading, scales: &super::scales::SteeringScales) {
        (self.t_stress, self.length_offset, self.spacing) = (reading.t_stress, reading.length_offset, reading.spacing);
        self.is_closed = reading.stands();
        self.was_closed |= self.is_closed;
        if !self.is_closed {
            self.steering.read(reading.factors, self.growth, reading.ahead, scales);
        }
        if self.begins_kink() || self.steering.corner().is_none() {
            self.kink = None;
        }
    }

    /// Takes the factors at the end of its line, Pa√m, how they follow the load, and the rate of such a K_eq. The rate of a tip that has ended or
    /// stands is none.
    pub(super) fn take(&mut self, factors: [f64; 2], response: Response, rate: impl Fn(f64, &Response) -> f64) {
        self.response = response;
        // Flanks do not overlap: what is read below zero is where places of contact are too few at a tip.
        self.factors = [factors[0].max(0.0), factors[1]];
        if !self.is_closed && self.begins_kink() {
            self.kink = Kink::new(self.factors, self.t_stress, self.growth);
        }
        self.rate = rate(self.driving_factor(), &self.response);
    }

    /// Forgets how K has changed and where it aimed: the crack that it ends is another one.
    pub(super) fn forget_history(&mut self) {
        (self.before, self.past, self.kink) = (None, None, None);
        self.steering.forget();
    }
}

/// Relative difference within which factors are those of mirror twins: far above what solver and tie breaks make of equal ones, far
/// below what shows in a life.
const TWINS: f64 = 1e-4;

/// Gives tips whose factors agree but for their signs the same ones; of each its own number or that of its twin.
pub fn pair_twins(factors: &mut [Option<[f64; 2]>]) -> Vec<usize> {
    let mut twins: Vec<usize> = (0..factors.len()).collect();
    for i in 1..factors.len() {
        let Some(here) = factors[i] else { continue };
        let is_twin = |there: &[f64; 2]| {
            let size = there[0].abs().max(there[1].abs());
            [0, 1].iter().all(|&mode| (here[mode].abs() - there[mode].abs()).abs() <= TWINS * size)
        };
        if let Some((twin, there)) = (0..i).filter_map(|j| Some((j, factors[j]?))).find(|(_, there)| is_twin(there)) {
            twins[i] = twin;
            factors[i] = Some([0, 1].map(|mode| there[mode].abs().copysign(here[mode])));
        }
    }
    twins
}

/// The cracks of a plate and what drives them, as far as it is the same for all engines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CracksState {
    pub lines: Vec<CrackLine>,
    /// Their tips, in the order of `Specimen::tips`.
    pub tips: Vec<Tip>,
    /// Growth of a tip in the next increment at the most, m.
    pub step: f64,
    /// K against the energy that the plate releases.
    pub balance: EnergyBalance,
    /// Half of the cycles by which parabolas through the rate after a step count more than those through the rate before it, of all steps.
    pub step_error: f64,
}

impl CracksState {
    /// Crack length in the convention of the specimen, m.
    pub fn crack_length(&self, specimen: &Specimen) -> f64 {
        specimen.crack_length_after(&self.tips.iter().map(|tip| tip.growth).collect::<Vec<_>>())
    }

    /// Place of a tip, m.
    pub fn position(&self, tip: &Tip) -> Point {
        self.lines[tip.end.line].end(tip.end.at_last)
    }

    /// Distance of a tip from rims and from cracks that it does not end, m.
    pub fn room(&self, specimen: &Specimen, tip: &Tip) -> f64 {
        let at = self.position(tip);
        let others = self.lines.iter().enumerate().filter(|(other, _)| *other != tip.end.line);
        others.map(|(_, line)| line.distance(at)).fold(specimen.rim_distance(at), f64::min)
    }

    /// Tips that have not ended, with their index.
    pub fn active(&self) -> impl Iterator<Item = (usize, &Tip)> {
        self.tips.iter().enumerate().filter(|(_, tip)| tip.is_active())
    }

    /// Whether it may be a later state of the same cracks.
    pub fn fits(&self, start: &CracksState) -> bool {
        let ends = |state: &CracksState| state.tips.iter().map(|tip| tip.end).collect::<Vec<_>>();
        self.lines.len() == start.lines.len() && ends(self) == ends(start)
    }
}
