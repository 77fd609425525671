//! How long an increment is: growth of all tips over the same cycles, and the cycles.
//!
//! It is as long as the fastest tip takes for a step. With its length as independent variable the other tips follow `da_i/da = r_i/r`, by
//! the rates of this increment and the last one extrapolated to the middle of the step (Adams and Bashforth 1883), and the cycles are
//! `∫ da/r` with ln r a parabola through the rates at the ends of this step and at the start of the last one. What the parabola adds to
//! the straight line tells how long the next step may be. K of a kink and of a short crack is smooth in the root x of its length:
//! on nodes all of these are extrapolated in x, and the cycles are `∫ 2x dx/r`. The first step of a kink has cycles of its own
//! ([`super::kink::cycles`]).

use super::ahead;
use super::scales::StepScales;
use super::{CrackedPlate, Cracks, Tip};
use perilife_base::quadrature::integrate;

/// Share of an increment's cycles that a parabola may add that turns between its ends: beyond it the rates lie on none.
const CURVATURE_SHARE_MOST: f64 = 0.02;
/// Growth of a tip over that of the fastest, at the most, where rates are extrapolated.
const SHARE_MOST: f64 = 1.5;

/// Difference of the rates of two tips, over the rate, and of what they are short of, over the step, within which they are twins.
const TWIN: f64 = 1e-9;

impl StepScales {
    /// By how much longer the step of a slow tip may be than its surroundings allow, the fastest growing at `fastest`, m/cycle: a tip in the
    /// shadow of another crack hardly counts, and would halve the steps of all again and again.
    fn slack(&self, fastest: f64, tip: &Tip) -> f64 {
        (fastest / tip.rate).sqrt().min(self.slack_most)
    }
}

impl<P: CrackedPlate> Cracks<'_, P> {
    /// Growth of every tip in the next increment, m, and until the crack has the length `until` at the latest.
    pub(super) fn next_lengths(&self, fastest: usize, until: f64) -> Vec<f64> {
        let lead = &self.state.tips[fastest];
        let of_lead = |(tip, length): (&Tip, f64)| length * lead.rate / tip.rate;
        let growing = || self.state.tips.iter().enumerate().filter(|(_, tip)| tip.is_growing());
        let last = |index: usize| self.last_way(index).map(|way| way.length);
        let most = |index: usize| {
            last(index).unwrap_or_else(|| self.limit(index) * self.scales.step.slack(lead.rate, &self.state.tips[index]))
        };
        let limits: Vec<(f64, bool)> =
            growing().map(|(index, tip)| (of_lead((tip, most(index))), last(index).is_some())).collect();
        let limit = limits.iter().map(|limit| limit.0).fold(f64::INFINITY, f64::min);
        // What is left of the way of a tip that is at its end is gone at once; else steps are no longer than they have proved to be.
        let is_last = limits.iter().any(|(most, is_last)| *is_last && *most <= limit * (1.0 + 1e-9));
        let least = self.scales.step.bounds[0].min(self.scales.step.first);
        let step = if is_last { limit } else { limit.min(self.state.step.max(least)) };
        // Cycles are those of the lead's growth: it makes up for nothing, and neither does its twin.
        let leads = |tip: &Tip| {
            let is_near = |a: f64, b: f64, of: f64| (a - b).abs() <= TWIN * of;
            is_near(tip.rate, lead.rate, lead.rate) && is_near(tip.arrears, lead.arrears, step)
        };
        let of_tip = |(index, tip): (usize, &Tip)| {
            let share = tip.share(lead, step, self.scales.by_root).min(SHARE_MOST);
            let arrears = if index == fastest || leads(tip) { 0.0 } else { tip.arrears };
            if tip.is_growing() { (step * share + arrears).max(0.0) } else { 0.0 }
        };
        let mut lengths: Vec<f64> = self.state.tips.iter().enumerate().map(of_tip).collect();
        let length_after = |lengths: &[f64]| {
            let growth: Vec<f64> = self.state.tips.iter().zip(lengths).map(|(tip, length)| tip.growth + length).collect();
            let (specimen, length) = (&self.case.specimen, self.case.specimen.crack_length_after(&growth));
            self.end.map_or(length, |end| end.length(specimen, length, growth.into_iter()))
        };
        let (now, then) = (length_after(&vec![0.0; lengths.len()]), length_after(&lengths));
        if then > until {
            let share = ((until - now) / (then - now)).clamp(0.0, 1.0);
            lengths.iter_mut().for_each(|length| *length *= share);
        }
        lengths
    }

    /// Growth of a tip at the most in its surroundings, m, in an increment that does not take it to the end of its way.
    fn limit(&self, index: usize) -> f64 {
        let (tip, scales, steering) = (&self.state.tips[index], &self.scales.step, &self.scales.steering);
        let mut most = f64::INFINITY;
        if scales.share.is_finite() {
            let (gap, faces) = self.gap(index);
            let share_of_gap = if faces.is_some() { scales.share_to_joint } else { scales.share };
            most = (scales.share * (tip.length + tip.growth)).min(scales.share * self.room(index)).min(share_of_gap * gap);
        }
        let [reach, near] = scales.near;
        if ahead::is_near_rim(&self.case.specimen, &self.state.lines, tip.end, reach) {
            most = most.min(near);
        } else if tip.steering.is_turning(tip.growth, steering) {
            most = most.min(scales.turning);
        }
        if tip.begins_kink() {
            most = most.min(scales.first_of_kink * tip.spacing);
        }
        let by_root = self.scales.by_root;
        // Growth in which its aim turns by as much as it may in an increment.
        let way = scales.turn / tip.steering.slope(steering, tip.smooth_in(by_root)).abs();
        let in_turn = if by_root { way * (way + 2.0 * tip.root(tip.growth)) } else { way };
        most.min(in_turn.max(scales.turn_unless))
    }

    /// Step of the lead in the first increment after a start, a joint or a kink, m, after so many cycles: where it takes few of them,
    /// it errs by little.
    pub(super) fn first_step(&self, all: f64) -> f64 {
        let scales = &self.scales.step;
        let Some(fastest) = self.fastest().map(|lead| self.state.tips[lead].rate) else { return 0.0 };
        let of_tip = |(index, tip): (usize, &Tip)| {
            let most = self.limit(index) * scales.slack(fastest, tip) * fastest / tip.rate;
            let share = scales.first_share * (scales.error_counts_from * all * fastest / most).max(1.0);
            if tip.begins_kink() { most } else { share.min(1.0) * most }
        };
        let growing = self.state.tips.iter().enumerate().filter(|(_, tip)| tip.is_growing());
        growing.map(of_tip).fold(scales.first, f64::min)
    }

    /// Step of the lead after one of length `grown`, m, that took the share `of_all` of all cycles so far and in which the parabola added the
    /// share `curvature_share` to its own.
    pub(super) fn next_step(&self, grown: f64, curvature_share: f64, of_all: f64) -> f64 {
        let scales = &self.scales.step;
        let [least, most] = scales.change;
        let error = scales.error * (scales.error_counts_from / of_all).max(1.0);
        let by_error = (error / curvature_share.abs().max(f64::MIN_POSITIVE)).sqrt();
        (grown * by_error.min(most).max(least)).clamp(scales.bounds[0], scales.bounds[1])
    }
}

/// Cycles of a step.
pub(super) struct Counted {
    pub cycles: f64,
    /// Share that the parabola adds to those of the straight line, whether they are counted or not.
    pub curvature_share: f64,
    /// c of `ln r = ln r₀ + gain t + c t (t - 1)`, t from 0 to 1 over the step; 0 where the parabola is not counted.
    pub bend: f64,
}

/// Cycles of a step of the fastest tip: its rates at the start of the step before, where known, with that step's length, at the
/// start and at the end of this one, m/cycle, whose length is `grown`, m.
pub(super) fn cycles(past: Option<[f64; 2]>, rate: f64, rate_then: f64, grown: f64) -> Counted {
    let curvature_share = past.map_or(0.0, |[before, way]| curvature_share([before, rate, rate_then], [way, grown]));
    let counted = if curvature_share.abs() < CURVATURE_SHARE_MOST { curvature_share } else { 0.0 };
    Counted { cycles: grown * mean_inverse(rate, rate_then) * (1.0 + counted), curvature_share, bend: 6.0 * counted }
}

/// The same with ln r a parabola in the root x of the length of crack, `∫ da/r = ∫ 2x dx/r`, x between two roots, m^½, and through the root
/// and rate `beside` them, where known.
pub(super) fn cycles_by_root(beside: Option<[f64; 2]>, [rate, rate_then]: [f64; 2], [root, then]: [f64; 2]) -> Counted {
    let rise = then - root;
    let slope = (rate_then / rate).ln() / rise;
    let curvature = beside.map_or(0.0, |[at, of_it]| ((of_it / rate).ln() / (at - root) - slope) / (at - then));
    let integral = |curvature: f64| {
        let inverse = |x: f64| 2.0 * (root + x) * (-(slope * x + curvature * x * (x - rise))).exp();
        integrate(inverse, 0.0, rise, 1e-10).value / rate
    };
    let straight = integral(0.0);
    let share = integral(curvature) / straight - 1.0;
    let curvature_share = if share.is_finite() { share } else { 0.0 };
    let bend = curvature * rise * rise;
    // However much a parabola adds that rises or falls with the rates all the way.
    let is_counted = curvature.is_finite() && (curvature_share.abs() < CURVATURE_SHARE_MOST || bend.abs() < (slope * rise).abs());
    let (counted, bend) = if is_counted { (curvature_share, bend) } else { (0.0, 0.0) };
    Counted { cycles: straight * (1.0 + counted), curvature_share, bend }
}

/// How growth and cycles of an increment go along in what its rate is continued in, t from 0 to 1: `da/dt ∝ a + b t` and
/// `ln r = ln r₀ + gain t + bend t (t - 1)`.
pub(super) struct Course {
    /// a and b: the root of the length of crack and its rise, or 1 and 0 in the growth itself.
    pub weight: [f64; 2],
    /// Rise of ln r.
    pub gain: f64,
    /// That of a parabola through its ends, [`Counted::bend`].
    pub bend: f64,
}

/// What a chord of a-N between two rows may be off by over all cycles so far.
const CHORD: f64 = 1e-3;
/// Parts of an increment at the most.
const PARTS_MOST: f64 = 8.0;

impl Course {
    /// Parts in which an increment with the share `of_all` of the cycles is written: chords are off by `g ΔN/8`, g = slope of ln r.
    pub(super) fn parts(&self, of_all: f64) -> usize {
        ((self.gain.abs() + self.bend.abs()) * of_all / (8.0 * CHORD)).sqrt().ceil().clamp(1.0, PARTS_MOST) as usize
    }

    /// Share of the growth of the increment at t.
    pub(super) fn growth(&self, t: f64) -> f64 {
        let [from, rise] = self.weight;
        t * (from + 0.5 * rise * t) / (from + 0.5 * rise)
    }

    /// Rise of ln r until t.
    pub(super) fn rise(&self, t: f64) -> f64 {
        self.gain * t + self.bend * t * (t - 1.0)
    }

    /// Share of its cycles at t.
    pub(super) fn cycles(&self, t: f64) -> f64 {
        let [from, rise] = self.weight;
        let until = |end: f64| integrate(|t| (from + rise * t) * (-self.rise(t)).exp(), 0.0, end, 1e-10).value;
        until(t) / until(1.0)
    }
}

/// K of the lead over an increment: `ln K = ln K₀ + rise t + bend t (t - 1)`, its bend to that of ln r as their rises are.
pub(super) struct FactorCourse {
    pub course: Course,
    from: f64,
    rise: f64,
    bend: f64,
}

impl FactorCourse {
    /// From one K to another, Pa√m, while the rate goes along `course`.
    pub(super) fn new(course: Course, [from, to]: [f64; 2]) -> Self {
        let rise = (to / from).ln();
        let bend = if course.gain == 0.0 { 0.0 } else { course.bend * rise / course.gain };
        FactorCourse { course, from, rise, bend }
    }

    /// K at t, Pa√m.
    pub(super) fn at(&self, t: f64) -> f64 {
        self.from * (self.rise * t + self.bend * t * (t - 1.0)).exp()
    }

    /// That over the chord between both ends.
    pub(super) fn beside_chord(&self, t: f64) -> f64 {
        self.at(t) / (self.from + t * (self.at(1.0) - self.from))
    }

    /// `∫ K² da` over that of the chord of K² over a.
    pub(super) fn square_beside_chord(&self) -> f64 {
        let [from, rise] = self.course.weight;
        let square = |t: f64| (from + rise * t) / (from + 0.5 * rise) * self.at(t).powi(2);
        2.0 * integrate(square, 0.0, 1.0, 1e-8).value / (self.from.powi(2) + self.at(1.0).powi(2))
    }
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
fn curvature_share([before, from, to]: [f64; 3], [first, second]: [f64; 2]) -> f64 {
    let slope = |a: f64, b: f64, way: f64| (b / a).ln() / way;
    let curvature = (slope(from, to, second) - slope(before, from, first)) / (first + second);
    let share = curvature * second * second / 6.0;
    if share.is_finite() { share } else { 0.0 }
}
