//! A growth law with the shape of measured rates: `ln da/dN = b₀ + m x + Σ c_k φ_k(x)`, `x = ln(ΔK / pivot)`.
//!
//! The chord b₀ + m x goes through both ends of the calibrated range and on beyond them; φ_k are natural cubic splines over knots even in
//! ln ΔK, 1 at one inner knot and 0 at the others and both ends, so that c_k is the departure from the chord at a knot (de Boor 1978).

use serde::{Deserialize, Serialize};

use crate::growth_law::{GrowthLaw, Walker};
use crate::paris::ParisLaw;

pub const KNOTS: usize = 4;
/// Fixed effects: b₀, m, c_k.
pub const EFFECTS: usize = 2 + KNOTS;
/// Knots with both ends of the range.
pub const ROWS: usize = KNOTS + 2;

/// `A⁻¹ D` times 209 at the inner knots, A and D being the matrices of `1 4 1` and `1 -2 1`.
const SECOND: [[f64; KNOTS]; KNOTS] =
    [[-127.0, 90.0, -24.0, 6.0], [90.0, -151.0, 96.0, -24.0], [-24.0, 96.0, -151.0, 90.0], [6.0, -24.0, 90.0, -127.0]];
/// `∫ φ_j'' φ_k'' dt` over the range of t = 0..1, in units in which the rms of the values at all knots is 1 on the mean over shapes.
pub const ROUGHNESS: [[f64; KNOTS]; KNOTS] = {
    const UNIT: f64 = 872.0 / 65835.0;
    [
        [344.0 * UNIT, -331.0 * UNIT, 144.0 * UNIT, -36.0 * UNIT],
        [-331.0 * UNIT, 488.0 * UNIT, -367.0 * UNIT, 144.0 * UNIT],
        [144.0 * UNIT, -367.0 * UNIT, 488.0 * UNIT, -331.0 * UNIT],
        [-36.0 * UNIT, 144.0 * UNIT, -331.0 * UNIT, 344.0 * UNIT],
    ]
};

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CurveLaw {
    /// ΔK at which x = 0, Pa√m.
    pub pivot: f64,
    /// b₀: ln of the rate (m/cycle) of the chord at the pivot.
    pub level: f64,
    /// m of the chord, from one end of the range to the other.
    pub slope: f64,
    /// Calibrated ΔK, Pa√m.
    pub range: [f64; 2],
    /// c_k; `None` where the data cannot carry a shape.
    pub shape: Option<[f64; KNOTS]>,
}

impl CurveLaw {
    /// The law through ΔK (Pa√m) of which the first and last are the ends of the range, and rates (m/cycle) there.
    pub fn through(range: [f64; 2], rates: [f64; ROWS]) -> Self {
        let slope = (rates[ROWS - 1] / rates[0]).ln() / (range[1] / range[0]).ln();
        let law = CurveLaw { pivot: range[0], level: rates[0].ln(), slope, range, shape: None };
        let knots = law.knots();
        CurveLaw { shape: Some(std::array::from_fn(|k| rates[k + 1].ln() - law.log_rate(knots[k + 1]))), ..law }
    }

    /// Largest over smallest calibrated ΔK.
    pub fn range_ratio(&self) -> f64 {
        self.range[1] / self.range[0]
    }

    fn knot_spacing(&self) -> f64 {
        self.range_ratio().ln() / (KNOTS + 1) as f64
    }

    /// ΔK of the ends of the range and of the knots between them, Pa√m.
    pub fn knots(&self) -> [f64; ROWS] {
        std::array::from_fn(
            |k| if k == ROWS - 1 { self.range[1] } else { self.range[0] * (self.knot_spacing() * k as f64).exp() },
        )
    }

    /// ln of the rate (m/cycle) at a ΔK (Pa√m).
    pub fn log_rate(&self, delta_k: f64) -> f64 {
        self.at(delta_k.ln())
    }

    /// ln of the rate at ln ΔK.
    pub fn at(&self, log_k: f64) -> f64 {
        self.sum(&self.design(log_k))
    }

    /// Local exponent d ln(da/dN)/d ln ΔK.
    pub fn local_slope(&self, delta_k: f64) -> f64 {
        self.sum(&self.design_slope(delta_k.ln()))
    }

    /// Root mean square over the range of the local slope less m.
    pub fn slope_deviation(&self) -> f64 {
        let squares: f64 = self.places().map(|k| (self.local_slope(k) - self.slope).powi(2)).sum();
        (squares / self.places().count() as f64).sqrt()
    }

    /// ΔK of the knots and in the middle between them.
    fn places(&self) -> impl Iterator<Item = f64> {
        (0..=2 * (KNOTS + 1)).map(|half| self.range[0] * (0.5 * self.knot_spacing() * half as f64).exp())
    }

    /// Whether the rate rises with ΔK over the whole range, at knots and between them.
    pub fn rises(&self) -> bool {
        self.places().all(|k| self.local_slope(k) > 0.0)
    }

    /// b₀, m, c_k.
    pub fn effects(&self) -> [f64; EFFECTS] {
        let c = self.shape.unwrap_or_default();
        std::array::from_fn(|i| [self.level, self.slope].get(i).copied().unwrap_or_else(|| c[i - 2]))
    }

    pub fn with(&self, effects: [f64; EFFECTS]) -> CurveLaw {
        let shape = self.shape.map(|_| std::array::from_fn(|k| effects[2 + k]));
        CurveLaw { level: effects[0], slope: effects[1], shape, ..*self }
    }

    fn sum(&self, design: &[f64; EFFECTS]) -> f64 {
        design.iter().zip(self.effects()).map(|(x, effect)| x * effect).sum()
    }

    /// The piece between knots that ln ΔK lies in and the share of the way through it; `None` without a shape, or outside the range.
    fn piece(&self, log_k: f64) -> Option<(usize, f64)> {
        let place = (log_k - self.range[0].ln()) / self.knot_spacing();
        let is_inside = self.shape.is_some() && (0.0..=(KNOTS + 1) as f64).contains(&place);
        is_inside.then(|| ((place as usize).min(KNOTS), place - ((place as usize).min(KNOTS)) as f64))
    }

    /// 1, x, φ_k at ln ΔK.
    pub fn design(&self, log_k: f64) -> [f64; EFFECTS] {
        self.row([1.0, log_k - self.pivot.ln()], log_k, |u, v| [v, u, v.powi(3) - v, u.powi(3) - u])
    }

    /// Derivative of [`CurveLaw::design`] over ln ΔK.
    pub fn design_slope(&self, log_k: f64) -> [f64; EFFECTS] {
        let per = 1.0 / self.knot_spacing();
        self.row([0.0, 1.0], log_k, |u, v| [-per, per, per * (1.0 - 3.0 * v * v), per * (3.0 * u * u - 1.0)])
    }

    /// The chord's part, and that of φ_k: its values at both ends of a piece and its second derivatives there (times the square of the piece,
    /// over six) times their weights at the share u of the way through it, v = 1 - u.
    fn row(&self, chord: [f64; 2], log_k: f64, weights: impl Fn(f64, f64) -> [f64; 4]) -> [f64; EFFECTS] {
        let mut row = [0.0; EFFECTS];
        (row[0], row[1]) = (chord[0], chord[1]);
        let Some((piece, u)) = self.piece(log_k) else { return row };
        let weights = weights(u, 1.0 - u);
        for (k, phi) in row[2..].iter_mut().enumerate() {
            let value = |knot: usize| if knot == k + 1 { 1.0 } else { 0.0 };
            let second = |knot: usize| if (1..=KNOTS).contains(&knot) { SECOND[knot - 1][k] / 209.0 } else { 0.0 };
            let ends = [value(piece), value(piece + 1), second(piece), second(piece + 1)];
            *phi = ends.iter().zip(weights).map(|(end, weight)| end * weight).sum();
        }
        row
    }
}

/// Departure of a curve from the power law beside it, both over the ΔK of the tests at their stress ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    pub curve: CurveLaw,
    /// C and m of the same ΔK.
    pub paris: ParisLaw,
    pub ratio: f64,
}

impl Shape {
    /// Rate of the curve over that of the power law at K_max, Pa√m, and a stress ratio, which Walker's exponent γ takes to that of the tests.
    pub fn factor(&self, k_max: f64, ratio: f64, gamma: f64) -> f64 {
        let [own, tested] = [ratio, self.ratio].map(|ratio| 1.0 - ratio.max(0.0));
        let delta_k = k_max * own.powf(gamma) * tested.powf(1.0 - gamma);
        if delta_k > 0.0 { self.curve.log_rate(delta_k).exp() / self.paris.rate(delta_k) } else { 1.0 }
    }
}

/// Walker's law with the shape of the tests that its constants were fitted to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shaped {
    pub walker: Walker,
    pub shape: Shape,
}

impl GrowthLaw for Shaped {
    fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        self.walker.rate(k_max, ratio) * self.shape.factor(k_max, ratio, self.walker.gamma)
    }
}
