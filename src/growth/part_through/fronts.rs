//! The two semi-axes of a crack front, each growing by the K of its own end.
//!
//! `da/dN = r(K(φ = 90°))`, `dc/dN = r(K(φ = 0))`, over a variable s in which both are smooth: `ds = d ln a + d ln c`. Steps by the third-order
//! formula of Bogacki and Shampine (1989, Appl. Math. Lett. 2:321), as long as its second-order companion allows.

use super::neighbours::Neighbours;
use crate::case::Case;
use perilife_laws::growth_law::GrowthLaw;
use perilife_plate::specimen::{FrontTip, PartThrough};

/// Longest step: a straight line between two rows is then off by some 1e-5 of the life.
pub(super) const STEP_MOST: f64 = 0.02;
/// Steps are not made shorter than that, whatever the law does.
const STEP_LEAST: f64 = 1e-6;
/// Error of a step, of ln a, ln c, and of the cycles over those up to its end.
const TOLERANCE: f64 = 1e-7;

/// Where a front stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grown {
    /// Semi-axes a and c, m.
    pub axes: [f64; 2],
    /// Cycles since N = 0.
    pub cycles: f64,
}

/// d ln a/ds, d ln c/ds and dN/ds.
type Slope = [f64; 3];

/// K and rates of a front.
pub(super) struct Fronts<'a> {
    pub case: &'a Case,
    pub flaw: PartThrough,
    /// What further holes do to K.
    pub neighbours: Option<Neighbours>,
    pub law: Box<dyn GrowthLaw>,
}

impl Fronts<'_> {
    /// K_I at maximum load, Pa√m, at the ends of a and c.
    pub fn factors(&self, axes: [f64; 2]) -> [f64; 2] {
        let compounded = self.neighbours.as_ref().map_or(1.0, |neighbours| neighbours.factor(axes[1]));
        FrontTip::ALL.map(|tip| compounded * self.flaw.k_i(axes, self.case.loading.maximum, tip))
    }

    /// da/dN and dc/dN, m/cycle.
    pub fn rates(&self, axes: [f64; 2]) -> [f64; 2] {
        self.factors(axes).map(|factor| self.law.rate(factor, self.case.loading.ratio))
    }

    /// Whether K is infinite a shortest step ahead.
    pub fn is_at_end(&self, axes: [f64; 2]) -> bool {
        self.factors(axes.map(|length| length * (1.0 + 2.0 * STEP_LEAST))).iter().any(|factor| !factor.is_finite())
    }

    fn slope(&self, axes: [f64; 2]) -> Slope {
        let rates = self.rates(axes);
        let [of_a, of_c] = [rates[0] / axes[0], rates[1] / axes[1]];
        let whole = of_a + of_c;
        [of_a / whole, of_c / whole, 1.0 / whole]
    }

    /// A step of length `step` from a place, and its error over [`TOLERANCE`].
    pub fn after(&self, from: Grown, step: f64) -> (Grown, f64) {
        let moved = |weights: &[(f64, Slope)]| {
            let by = |i: usize| step * weights.iter().map(|(weight, slope)| weight * slope[i]).sum::<f64>();
            Grown { axes: [0, 1].map(|i| from.axes[i] * by(i).exp()), cycles: from.cycles + by(2) }
        };
        let first = self.slope(from.axes);
        let second = self.slope(moved(&[(0.5, first)]).axes);
        let third = self.slope(moved(&[(0.75, second)]).axes);
        let to = moved(&[(2.0 / 9.0, first), (1.0 / 3.0, second), (4.0 / 9.0, third)]);
        let last = self.slope(to.axes);
        let error = |i: usize| step * (-5.0 / 72.0 * first[i] + second[i] / 12.0 + third[i] / 9.0 - 0.125 * last[i]);
        let worst = error(0).abs().max(error(1).abs()).max(error(2).abs() / to.cycles);
        (to, worst / TOLERANCE)
    }

    /// The next place within the tolerance, and the step that was taken; `step` is the one to try, and is left as the next one to try. `None`
    /// where nothing grows or no rate is known.
    pub fn next(&self, from: Grown, step: &mut f64) -> Option<(Grown, f64)> {
        loop {
            let taken = *step;
            let (to, error) = self.after(from, taken);
            let is_known = error.is_finite();
            let factor = if is_known { 0.9 * error.max(1e-9).powf(-1.0 / 3.0) } else { 0.1 };
            *step = (taken * factor.clamp(0.1, 3.0)).clamp(STEP_LEAST, STEP_MOST);
            if is_known && error <= 1.0 || taken <= STEP_LEAST {
                return is_known.then_some((to, taken));
            }
        }
    }
}
