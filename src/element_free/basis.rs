//! The choices of basis and enrichment.

use super::crack::TipAxes;
use super::cuts::Near;
use super::shape::{Basis, Linear, Quadratic, Value, shape_functions};
use crate::specimen::Point;
use crate::specimen::geometry::distance;

crate::kinds! {
    /// Polynomials that the shape functions reproduce.
    pub enum BasisKind for "model.basis" {
        Linear = "linear": "1, x, y",
        Quadratic = "quadratic": "1, x, y, x², xy, y²",
    }
}

crate::kinds! {
    /// How near-tip fields come into the displacement.
    pub enum Enrichment for "model.enrichment" {
        Tip = "tip": "both near-tip fields as unknowns of the nodes around a tip",
        Intrinsic = "intrinsic": "√r cos θ/2, √r sin θ/2, and both times sin θ in the basis around a tip",
        None = "none": "polynomials alone: K errs by 4 to 8 %",
    }
}

/// Distances from a tip, in its spacings, between which the enriched basis gives way to the polynomials.
const RAMP_SPACINGS: [f64; 2] = [2.0, 4.0];

/// The basis of a plate.
#[derive(Debug, Clone)]
pub struct AnyBasis {
    kind: BasisKind,
    /// Tips whose functions the basis has around them.
    tips: Vec<TipAxes>,
}

/// Polynomials and the four functions of a tip.
struct Intrinsic<'a>(&'a TipAxes);

impl Intrinsic<'_> {
    /// √r cos θ/2, √r sin θ/2, √r sin θ/2 sin θ, √r cos θ/2 sin θ, r in spacings.
    fn functions(&self, at: Point) -> [f64; 4] {
        let (r, theta) = self.0.polar(at);
        let (sin, cos) = (0.5 * theta).sin_cos();
        let root = (r / self.0.spacing).sqrt();
        [root * cos, root * sin, root * sin * theta.sin(), root * cos * theta.sin()]
    }

    /// Their derivatives over the axes of the plate.
    fn slopes(&self, at: Point) -> [Point; 4] {
        let (r, theta) = self.0.polar(at);
        let ((sin, cos), (sin_t, cos_t)) = ((0.5 * theta).sin_cos(), theta.sin_cos());
        let root = (r / self.0.spacing).max(1e-18).sqrt();
        let values = [cos, sin, sin * sin_t, cos * sin_t];
        let turns = [-0.5 * sin, 0.5 * cos, 0.5 * cos * sin_t + sin * cos_t, -0.5 * sin * sin_t + cos * cos_t];
        let over_r = 1.0 / (root * self.0.spacing);
        [0, 1, 2, 3].map(|k| {
            let (of_r, of_theta) = (0.5 * values[k] * over_r, turns[k] * over_r);
            self.0.from_axes([of_r * cos_t - of_theta * sin_t, of_r * sin_t + of_theta * cos_t])
        })
    }
}

impl Basis<7> for Intrinsic<'_> {
    fn at(&self, of: Point, origin: Point, scale: f64) -> [f64; 7] {
        let [a, b, c] = Linear.at(of, origin, scale);
        let [d, e, f, g] = self.functions(of);
        [a, b, c, d, e, f, g]
    }

    fn at_origin(&self, origin: Point, scale: f64) -> [[f64; 7]; 3] {
        let linear = Linear.at_origin(origin, scale);
        let (values, slopes) = (self.functions(origin), self.slopes(origin));
        [0, 1, 2].map(|row| {
            let mut p = [0.0; 7];
            p[..3].copy_from_slice(&linear[row]);
            for k in 0..4 {
                p[3 + k] = if row == 0 { values[k] } else { slopes[k][row - 1] };
            }
            p
        })
    }
}

impl AnyBasis {
    /// Of a plate with these tips.
    pub fn new(kind: BasisKind, enrichment: Enrichment, axes: &[TipAxes]) -> Self {
        AnyBasis { kind, tips: if enrichment == Enrichment::Intrinsic { axes.to_vec() } else { Vec::new() } }
    }

    /// Shape functions at a point ([`shape_functions`]). Around a tip with an enriched basis they are `R Φ^e + (1 - R) Φ`, R falling
    /// from 1 to 0 between two and four spacings (Fleming, Chu, Moran and Belytschko 1997, IJNME 40:1483).
    pub fn shape_functions(
        &self,
        at: Point,
        known: (&[u32], &[Point], &[f64]),
        near: &Near,
        scale: f64,
        values: &mut Vec<Value>,
    ) -> bool {
        let [inner, outer] = RAMP_SPACINGS;
        let away = |tip: &&TipAxes| distance(at, tip.at) / tip.spacing;
        let nearest = self.tips.iter().min_by(|a, b| away(a).total_cmp(&away(b))).filter(|tip| away(tip) < outer);
        let Some(tip) = nearest else { return self.polynomials(at, known, near, scale, values) };
        let share = ((outer - away(&tip)) / (outer - inner)).min(1.0);
        let mut of_basis = Vec::new();
        if !shape_functions(&Intrinsic(tip), at, known, near, scale, &mut of_basis) {
            return self.polynomials(at, known, near, scale, values);
        }
        if share == 1.0 {
            *values = of_basis;
            return true;
        }
        if !self.polynomials(at, known, near, scale, values) {
            return false;
        }
        let length = distance(at, tip.at);
        let slope = [0, 1].map(|i| -(at[i] - tip.at[i]) / length / ((outer - inner) * tip.spacing));
        // Both see the same nodes in the same order.
        for (value, enriched) in values.iter_mut().zip(&of_basis) {
            let more = enriched.value - value.value;
            for ((gradient, enriched), slope) in value.gradient.iter_mut().zip(enriched.gradient).zip(slope) {
                *gradient += share * (enriched - *gradient) + slope * more;
            }
            value.value += share * more;
        }
        true
    }

    fn polynomials(
        &self,
        at: Point,
        known: (&[u32], &[Point], &[f64]),
        near: &Near,
        scale: f64,
        values: &mut Vec<Value>,
    ) -> bool {
        match self.kind {
            BasisKind::Linear => shape_functions(&Linear, at, known, near, scale, values),
            BasisKind::Quadratic => shape_functions(&Quadratic, at, known, near, scale, values),
        }
    }
}
