//! How K of a tip follows the load of its cycles.
//!
//! K is in proportion to the load, `K = f K_max` at f times the largest load, while what touches stays in touch. Residual stress makes it a
//! straight line off the origin (superposition: Bueckner 1958). Flanks and pins whose contact changes with the load bend it: K is then solved
//! for at a few loads, and taken linear between them.

use perilife_plate::loading::LOWER_LOADS_MOST;
use serde::{Deserialize, Serialize};

/// Loads of a cycle for which K is known, at the most: lower ones, the largest, and the one that opens the tip.
const LOADS_MOST: usize = LOWER_LOADS_MOST + 2;
/// Difference from the largest K that is round-off.
const ROUND_OFF: f64 = 1e-9;
/// Difference of K over K_max between mirror twins at the most.
const NEAR: f64 = 0.01;

/// K over the K_max of a tip by the load over the largest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Response {
    /// How many loads are known; 0: K is in proportion to the load.
    count: usize,
    /// Load over the largest, ascending.
    loads: [f64; LOADS_MOST],
    /// K over K_max.
    factors: [f64; LOADS_MOST],
}

impl Response {
    pub const PROPORTIONAL: Response = Response { count: 0, loads: [0.0; LOADS_MOST], factors: [0.0; LOADS_MOST] };

    /// By pairs of load over the largest, ascending, and K over K_max; fewer than two, or K that is not known, are a proportion.
    pub fn new(pairs: &[[f64; 2]]) -> Response {
        let mut response = Response::PROPORTIONAL;
        if pairs.len() < 2 || pairs.iter().flatten().any(|value| !value.is_finite()) {
            return response;
        }
        for (place, [load, factor]) in pairs.iter().take(LOADS_MOST).enumerate() {
            (response.loads[place], response.factors[place], response.count) = (*load, *factor, place + 1);
        }
        response
    }

    /// The straight line of a residual stress that makes this share of K_max.
    pub fn of_residual(share: f64) -> Response {
        Response::new(&[[0.0, share], [1.0, 1.0]])
    }

    pub fn is_proportional(&self) -> bool {
        self.count == 0
    }

    /// K over K_max at a load over the largest; beyond the loads that are known, on in a straight line.
    pub fn at(&self, load: f64) -> f64 {
        if self.is_proportional() {
            return load;
        }
        let above = self.loads[..self.count].partition_point(|known| *known < load).clamp(1, self.count - 1);
        let [[from, low], [to, high]] = [above - 1, above].map(|place| [self.loads[place], self.factors[place]]);
        low + (load - from) / (to - from) * (high - low)
    }

    /// Largest and smallest K over K_max of a cycle between two loads over the largest.
    pub fn cycle(&self, loads: [f64; 2]) -> [f64; 2] {
        let [a, b] = loads.map(|load| self.at(load));
        [a.max(b), a.min(b)]
    }

    /// The least load of the cycle that counts of those with this ratio at the largest load: where that cycle does not reach K_max, which the least
    /// load of all makes, it is the one.
    fn least_load(&self, ratio: f64) -> f64 {
        let reaches = self.cycle([ratio, 1.0])[0] >= 1.0 - ROUND_OFF;
        if reaches || self.is_proportional() { ratio } else { self.loads[0] }
    }

    /// K_min/K_max of cycles from R times the largest load to that; of a tip that the least load of a spectrum opens most, from that.
    pub fn ratio(&self, ratio: f64) -> f64 {
        if self.is_proportional() {
            return ratio;
        }
        let [largest, least] = self.cycle([self.least_load(ratio), 1.0]);
        least / largest
    }

    /// Share of K_max that counts as range at this ratio of the load (ASTM E647).
    pub fn range_share(&self, ratio: f64) -> f64 {
        (1.0 - self.ratio(ratio).max(0.0)).max(0.0)
    }

    /// Largest K over K_max of cycles whose loads are larger by a factor.
    pub fn largest_at(&self, load: f64, ratio: f64) -> f64 {
        self.cycle([load * self.least_load(ratio), load])[0]
    }

    /// Without every second load between the ends: what that changes is three times the error of straight lines between all of them.
    pub fn coarser(&self) -> Response {
        let is_kept = |place: &usize| place.is_multiple_of(2) || place + 1 == self.count;
        Response::new(&(0..self.count).filter(is_kept).map(|place| [self.loads[place], self.factors[place]]).collect::<Vec<_>>())
    }

    /// Whether it is the other one but for what is read.
    pub fn is_near(&self, other: &Response) -> bool {
        let knots = |of: &Response| of.loads[..of.count].to_vec();
        let apart = |load: &f64| (self.at(*load) - other.at(*load)).abs();
        knots(self).iter().chain(&knots(other)).all(|load| apart(load) <= NEAR)
    }

    /// The one at a share of the way to another.
    pub fn between(&self, to: &Response, share: f64) -> Response {
        if self.count == to.count && self.loads == to.loads {
            let mix = |place: usize| self.factors[place] + share * (to.factors[place] - self.factors[place]);
            return Response { factors: std::array::from_fn(mix), ..*self };
        }
        let known = if self.count > to.count { self } else { to };
        let mix = |&load: &f64| [load, (1.0 - share) * self.at(load) + share * to.at(load)];
        Response::new(&known.loads[..known.count].iter().map(mix).collect::<Vec<_>>())
    }
}
