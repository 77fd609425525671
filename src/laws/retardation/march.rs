//! The growth of one tip through a spectrum in its order, with the plastic zone of the last overload as its state.
//!
//! Equal cycles that follow each other are counted in one go as long as their rate changes by less than a hundredth, by the rate in their middle
//! (second order: 1e-4 of their growth). Passes are jumped over where one is like the last but for the slow growth of K.
//!
//! A cycle that comes in a fraction of the passes, count f, comes in whole numbers: so many that f times the passes so far, rounded down, is kept. A
//! gust of 0.02 comes in every fiftieth pass, at its place. Passes are then compared, and jumped over, by periods of so many as make all counts whole.

use std::f64::consts::PI;

use super::{Now, Retardation, Zone};
use crate::growth_law::GrowthLaw;
use crate::response::Response;
use perilife_plate::loading::spectrum::{Cycle, Spectrum, WHOLE};

/// Change of the rate over the cycles counted in one go.
const CHANGE: f64 = 0.01;
/// Change of K over the passes jumped over.
const JUMP: f64 = 3e-3;
/// Passes that are worth a jump.
const WORTH: f64 = 3.0;
/// Change of what is left of a zone in a pass, over its size, up to which passes are alike.
const ALIKE: f64 = 1e-3;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marched {
    Reached,
    RunOut,
    /// A whole pass changes nothing.
    Arrested,
}

/// The laws of a march: da/dN of a cycle, of a pass as a mean, and what retards them; ratios below the least that the law knows count as that.
#[derive(Clone, Copy)]
pub struct Laws<'a> {
    /// Of a cycle at K_max and R.
    pub law: &'a dyn GrowthLaw,
    /// Of all cycles of a pass in the mean, at the K of the largest load.
    pub mean: &'a dyn GrowthLaw,
    /// The model of retardation; `None`: every cycle as if alone.
    pub retardation: Option<&'a Retardation>,
}

/// Where a tip stands on its way through a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Underway {
    /// Passes before this one, the cycle that comes next in it, and how often it is still to come.
    passes: f64,
    place: usize,
    left: f64,
    /// Cycles that were last counted in one go.
    chunk: f64,
    /// Way, m, and zone at the start of this period of passes, and whether all of it was marched.
    period: (f64, Option<Zone>, bool),
    /// Way of the tip, m.
    pub a: f64,
    pub cycles: f64,
    pub zone: Option<Zone>,
}

impl Underway {
    pub fn start(spectrum: &Spectrum) -> Self {
        let left = spectrum.cycles.first().map_or(0.0, |cycle| times(cycle, 0.0));
        Underway { passes: 0.0, place: 0, left, chunk: 1.0, period: (0.0, None, false), a: 0.0, cycles: 0.0, zone: None }
    }

    /// Puts another tip in its place, at its own way and with its own zone; the loads go on.
    pub fn take_over(&mut self, a: f64, zone: Option<Zone>) {
        (self.a, self.zone, self.period.2) = (a, zone, false);
    }

    /// The tip stands still while the loads go on to where another tip has them.
    pub fn wait_for(&mut self, other: &Underway) {
        (self.passes, self.place, self.left, self.cycles) = (other.passes, other.place, other.left, other.cycles);
    }
}

/// How often a cycle comes in the pass after so many.
fn times(cycle: &Cycle, passes: f64) -> f64 {
    let so_far = |passes: f64| (cycle.count * passes + WHOLE).floor();
    if cycle.count.fract() == 0.0 { cycle.count } else { so_far(passes + 1.0) - so_far(passes) }
}

pub struct March<'a> {
    laws: Laws<'a>,
    spectrum: &'a Spectrum,
    /// Cycles of the passes that are compared with those before them.
    per_period: f64,
    /// Least stress ratio that the law knows.
    least: f64,
    pub response: Response,
    /// Crack length where its way is 0, m.
    pub start: f64,
    pub at: Underway,
}

/// K at a way between the ends `way`, m, where it is `ks`, Pa√m: a power of e over the way, as K itself nearly is; beyond them that of the end.
pub fn between(ks: [f64; 2], way: [f64; 2]) -> impl Fn(f64) -> f64 {
    let gain = (ks[1] / ks[0]).ln();
    move |a| ks[0] * (gain * ((a - way[0]) / (way[1] - way[0])).clamp(0.0, 1.0)).exp()
}

impl<'a> March<'a> {
    /// A tip that goes on from where it stands.
    pub fn new(laws: Laws<'a>, spectrum: &'a Spectrum, at: Underway) -> Self {
        let (per_period, least) = (spectrum.period * spectrum.per_pass, laws.law.least_ratio());
        March { laws, spectrum, per_period, least, response: Response::PROPORTIONAL, start: 0.0, at }
    }

    /// Grows the tip to a way, m, `k` being the K of the largest load at a way, Pa√m; no more than so many cycles in all.
    pub fn advance(&mut self, k: &dyn Fn(f64) -> f64, to: f64, cycles_max: f64) -> Marched {
        while self.at.a < to {
            if self.at.cycles >= cycles_max {
                return Marched::RunOut;
            }
            if self.at.left > 0.0 {
                let cycle = self.spectrum.cycles[self.at.place];
                self.at.left -= self.count(&cycle, self.at.left.min(cycles_max - self.at.cycles), k, to);
            }
            if self.at.left > 0.0 {
                continue;
            }
            self.at.place = (self.at.place + 1) % self.spectrum.cycles.len();
            if self.at.place == 0 {
                self.at.passes += 1.0;
                if self.at.passes % self.spectrum.period == 0.0 && self.end_of_period(k, to, cycles_max) {
                    return Marched::Arrested;
                }
            }
            self.at.left = times(&self.spectrum.cycles[self.at.place], self.at.passes);
        }
        Marched::Reached
    }

    fn now(&self, cycle: &Cycle, a: f64, k: f64) -> Now {
        let [largest, smallest] = self.response.cycle([cycle.max, cycle.min]);
        let k_max = largest * k;
        let [size, stress_over_yield] = self
            .laws
            .retardation
            .map_or([0.0; 2], |model| [model.zone_size(k_max), k_max / (model.strength * (PI * (self.start + a)).sqrt())]);
        let least = self.least;
        Now { a, k_max, ratio: (smallest / largest).max(least), least, size, stress_over_yield }
    }

    /// da/dN of a cycle, m, in the zone of an overload or out of it.
    fn rate(&self, now: &Now) -> f64 {
        let model = self.laws.retardation.and_then(|model| Some((model, model.kind.0.rate?)));
        match (self.at.zone.filter(|zone| now.a + now.size < zone.end()), model) {
            (Some(zone), Some((model, rate))) => rate(&model.constants, self.laws.law, now, &zone),
            _ => self.laws.law.rate(now.k_max, now.ratio),
        }
    }

    /// Counts up to `most` equal cycles; how many they were.
    fn count(&mut self, cycle: &Cycle, most: f64, k: &dyn Fn(f64) -> f64, to: f64) -> f64 {
        let (k_now, [largest, smallest]) = (k(self.at.a), self.response.cycle([cycle.max, cycle.min]));
        if let Some(zone) = &mut self.at.zone {
            zone.k_min = zone.k_min.min(smallest * k_now);
        }
        if largest <= 0.0 || largest <= smallest {
            self.at.cycles += most;
            return most;
        }
        let now = self.now(cycle, self.at.a, k_now);
        let room = self.at.zone.map(|zone| zone.end() - now.a - now.size).filter(|room| *room > 0.0);
        let rate = self.rate(&now);
        let (done, growth) = self.several(cycle, (most, rate), room, k);
        let share = if growth > to - self.at.a { (to - self.at.a) / growth } else { 1.0 };
        self.at.a = if share < 1.0 { to } else { self.at.a + growth };
        self.at.cycles += share * done;
        if room.is_none() {
            let (k_max, size) = if done > 1.0 {
                let last = self.now(cycle, self.at.a, k(self.at.a));
                (last.k_max, last.size)
            } else {
                (now.k_max, now.size)
            };
            self.at.zone = Some(Zone { from: self.at.a, size, k_max, k_min: now.ratio * k_max });
        }
        share * done
    }

    /// How many of at most so many equal cycles are counted in one go, and their growth, m; `room` is what is left of a zone.
    fn several(&mut self, cycle: &Cycle, (most, rate): (f64, f64), room: Option<f64>, k: &dyn Fn(f64) -> f64) -> (f64, f64) {
        if most <= 1.0 || rate == 0.0 || !rate.is_finite() {
            return (most, if rate == 0.0 { 0.0 } else { most * rate });
        }
        let within = room.map_or(f64::INFINITY, |room| (room / rate).floor().max(1.0));
        let mut chunk = (2.0 * self.at.chunk).min(most).min(within).max(1.0);
        loop {
            let middle = self.at.a + 0.5 * chunk * rate;
            let then = self.rate(&self.now(cycle, middle, k(middle)));
            let change = (then / rate - 1.0).abs();
            if change < CHANGE || chunk <= 1.0 {
                self.at.chunk = chunk;
                return (chunk, if chunk <= 1.0 { chunk * rate } else { chunk * then });
            }
            chunk = (0.8 * chunk * CHANGE / change).floor().clamp(1.0, 0.5 * chunk.max(2.0));
        }
    }

    /// At the end of a period: jumps over periods like it. Whether none will change anything.
    fn end_of_period(&mut self, k: &dyn Fn(f64) -> f64, to: f64, cycles_max: f64) -> bool {
        let (start, before, is_whole) = std::mem::replace(&mut self.at.period, (self.at.a, self.at.zone, true));
        if !is_whole {
            return false;
        }
        let growth = self.at.a - start;
        if growth == 0.0 && before == self.at.zone {
            // A rare cycle that did not come in this period may end the standstill.
            let (passes, period) = (self.at.passes, self.spectrum.period);
            let so_far = |cycle: &Cycle, passes: f64| (cycle.count * passes + WHOLE).floor();
            if self.spectrum.rare().all(|cycle| so_far(cycle, passes) > so_far(cycle, passes - period)) {
                return true;
            }
            let most = (cycles_max - self.at.cycles) / self.per_period;
            let skipped = self.without_rare().min(most).floor().max(0.0);
            (self.at.passes, self.at.cycles) = (passes + skipped * period, self.at.cycles + skipped * self.per_period);
        }
        if growth == 0.0 {
            return false;
        }
        self.jump(growth, before, k, to, cycles_max);
        self.at.period = (self.at.a, self.at.zone, true);
        false
    }

    /// Periods before the next cycle that is rare; infinite where there is none.
    fn without_rare(&self) -> f64 {
        let next = |cycle: &Cycle| ((cycle.count * self.at.passes + WHOLE).floor() + 1.0) / cycle.count - self.at.passes;
        self.spectrum.rare().map(next).fold(f64::INFINITY, f64::min) / self.spectrum.period - 1.0
    }

    /// Jumps over periods in which the tip grows at the share of the mean rate that it had in the last one, K changing by no more than [`JUMP`].
    fn jump(&mut self, growth: f64, before: Option<Zone>, k: &dyn Fn(f64) -> f64, to: f64, cycles_max: f64) {
        let start = self.at.a - growth;
        let (Some(was), Some(is)) = (before, self.at.zone) else { return };
        let left = (is.end() - self.at.a) - (was.end() - start);
        if is.from <= was.from || left.abs() > ALIKE * is.size {
            return;
        }
        let mean = |a: f64| self.laws.mean.mean_rate(k(a), 0.0, &self.response);
        let share = growth / (mean(start + 0.5 * growth) * self.per_period);
        let (here, slope) = (k(self.at.a), (k(self.at.a) / k(start)).ln().abs() / growth);
        let way = (JUMP / slope.max(f64::MIN_POSITIVE)).min(0.5 * (to - self.at.a)).min(is.size.max(growth * WORTH) * 50.0);
        let most = ((cycles_max - self.at.cycles) / self.per_period).min(self.without_rare());
        let way = way.min(most * share * mean(self.at.a) * self.per_period);
        let middle = self.at.a + 0.5 * way;
        let per_period = share * mean(middle) * self.per_period;
        let periods = (way / per_period).min(most).floor();
        if !(periods >= WORTH && per_period.is_finite()) {
            return;
        }
        let way = periods * per_period;
        self.at.a += way;
        self.at.cycles += periods * self.per_period;
        self.at.passes += periods * self.spectrum.period;
        let ratio = k(self.at.a) / here;
        let moved = |zone: Zone| Zone {
            from: zone.from + way,
            size: zone.size * ratio * ratio,
            k_max: zone.k_max * ratio,
            k_min: zone.k_min * ratio,
        };
        self.at.zone = Some(moved(is));
    }
}
