//! What is fitted: growth at `da/dN = A (ΔK / ΔK₀)^p` (Paris and Erdogan 1963) with a known ΔK(a), so that
//! `A N(a) = ∫ (ΔK₀ / ΔK)^p da`. Cycles are proportional to 1/A, so that only p takes a search.
//!
//! Where the crack length is the sum of the paths of several tips, as on a drawn plate, all of them make it longer at once:
//! `A N(a) = ∫ da / Σ (ΔK_i / ΔK₀)^p`.

use crate::median::cycles_since_first;
use perilife_base::error::{Result, input};
use perilife_base::units::MPA_SQRT_M;
use perilife_measured::MeasuredCurve;

/// Lengths at which ΔK is tabulated; Simpson's rule on them integrates the Virkler panel to 1e-9.
const INTERVALS: usize = 400;
/// Pieces of Simpson's rule between two readings of different loads.
const PIECES_OF_STEP: usize = 2;

/// Paris growth between two crack lengths. A is in m/cycle at ΔK₀ = 1 MPa√m.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerLaw {
    pieces: Vec<Piece>,
}

/// Two equal intervals of crack length with ΔK at their ends.
#[derive(Debug, Clone, PartialEq)]
struct Piece {
    lengths: [f64; 3],
    /// ΔK in MPa√m at `lengths`, of every tip that grows there.
    delta_k: [Vec<f64>; 3],
    /// Whether its growth counts; where it does not, it takes no cycles.
    counts: bool,
}

impl PowerLaw {
    /// Tabulates `delta_k` (Pa√m) between two lengths (m).
    /// Errors: a ΔK that is not above 0.
    pub fn new(from: f64, to: f64, delta_k: &dyn Fn(f64) -> f64) -> Result<Self> {
        Self::of_tips(from, to, &|length| vec![delta_k(length)])
    }

    /// The same for several tips whose growths add up, each with its own `delta_k` (Pa√m).
    /// Errors: a length at which no tip has a ΔK, or a ΔK that is not above 0.
    pub fn of_tips(from: f64, to: f64, delta_k: &dyn Fn(f64) -> Vec<f64>) -> Result<Self> {
        let lengths: Vec<f64> = (0..=INTERVALS).map(|i| from + (to - from) * i as f64 / INTERVALS as f64).collect();
        let in_mpa = |k: f64| k / MPA_SQRT_M;
        let delta_k: Vec<Vec<f64>> = lengths.iter().map(|&a| delta_k(a).into_iter().map(in_mpa).collect()).collect();
        let grows = |tips: &Vec<f64>| !tips.is_empty() && tips.iter().all(|k| k.is_finite() && *k > 0.0);
        if let Some(i) = delta_k.iter().position(|tips| !grows(tips)) {
            let problem = "has no stress intensity range above 0 in the handbook formula of the specimen";
            let remedy = "narrow the window to lengths the formula covers";
            return Err(input("measured.crack_length_mm", lengths[i] / perilife_base::units::MM, problem, remedy));
        }
        let piece = |i: usize| Piece {
            lengths: [lengths[i], lengths[i + 1], lengths[i + 2]],
            delta_k: [i, i + 1, i + 2].map(|place| delta_k[place].clone()),
            counts: true,
        };
        Ok(PowerLaw { pieces: (0..INTERVALS).step_by(2).map(piece).collect() })
    }

    /// ΔK (MPa√m) at a length (m) of the one tip that would grow as fast as all together, `(Σ ΔK_i^p)^(1/p)`: that of the only tip,
    /// whatever p.
    pub fn delta_k(&self, length: f64, p: f64) -> f64 {
        match self.tips(length).as_slice() {
            [only] => *only,
            tips => tips.iter().map(|k| k.powf(p)).sum::<f64>().powf(1.0 / p),
        }
    }

    /// Largest ΔK (MPa√m) of the tips at a length (m).
    pub fn largest_delta_k(&self, length: f64) -> f64 {
        self.tips(length).into_iter().fold(0.0, f64::max)
    }

    /// ΔK (MPa√m) of the tips at a length (m): parabolas through ln ΔK of the piece that the length lies in.
    pub fn tips(&self, length: f64) -> Vec<f64> {
        let place = self.pieces.partition_point(|piece| piece.lengths[2] < length).min(self.pieces.len() - 1);
        let Piece { lengths: [a, b, c], delta_k, .. } = &self.pieces[place];
        // A tip stops within the piece: its K has no parabola there.
        if delta_k.iter().any(|tips| tips.len() != delta_k[1].len()) {
            return delta_k[usize::from(length > *a) + usize::from(length >= *c)].clone();
        }
        let shares = [
            (length - b) * (length - c) / ((a - b) * (a - c)),
            (length - a) * (length - c) / ((b - a) * (b - c)),
            (length - a) * (length - b) / ((c - a) * (c - b)),
        ];
        let tip = |tip: usize| (0..3).map(|i| shares[i] * delta_k[i][tip].ln()).sum::<f64>().exp();
        (0..delta_k[1].len()).map(tip).collect()
    }

    /// The law under the loads of a curve, steps that are left out taking no cycles.
    pub fn under(&self, curve: &MeasuredCurve) -> PowerLaw {
        let mut pieces = Vec::with_capacity(PIECES_OF_STEP * curve.cycles.len());
        let mut reached = curve.crack_length.first().copied().unwrap_or(f64::NAN);
        for (i, (start, end)) in curve.step_factors().into_iter().enumerate().skip(1) {
            let (from, to) = (reached, curve.crack_length[i]);
            // Noise in a reading does not heal a crack.
            if to <= from {
                continue;
            }
            for piece in 0..PIECES_OF_STEP {
                let share = |point: usize| (2 * piece + point) as f64 / (2 * PIECES_OF_STEP) as f64;
                let lengths = [0, 1, 2].map(|point| from + (to - from) * share(point));
                let load = |point: usize| start + (end - start) * share(point);
                let delta_k = [0, 1, 2].map(|point| self.tips(lengths[point]).iter().map(|k| k * load(point)).collect());
                pieces.push(Piece { lengths, delta_k, counts: curve.counts(i) });
            }
            reached = to;
        }
        PowerLaw { pieces }
    }

    /// A x cycles from the first of `lengths` (m) to each of them.
    /// Errors: a length outside the table.
    pub fn cycles(&self, p: f64, lengths: &[f64]) -> Result<Vec<f64>> {
        cycles_since_first(&self.integral(|tips| 1.0 / tips.iter().map(|k| k.powf(p)).sum::<f64>()), lengths)
    }

    /// Cycles from the first of `lengths` (m) to each of them by a rate, m/cycle, over ΔK, MPa√m, of every tip.
    /// Errors: a length outside the table.
    pub fn cycles_by(&self, rate: &dyn Fn(f64) -> f64, lengths: &[f64]) -> Result<Vec<f64>> {
        cycles_since_first(&self.integral(|tips| 1.0 / tips.iter().map(|k| rate(*k)).sum::<f64>()), lengths)
    }

    /// Derivative of [`PowerLaw::cycles`] over p, of one tip `-∫ ln(ΔK / ΔK₀) (ΔK₀ / ΔK)^p da`.
    pub fn cycles_per_p(&self, p: f64, lengths: &[f64]) -> Result<Vec<f64>> {
        let slope = |tips: &[f64]| {
            let (sum, slope) = tips.iter().fold((0.0, 0.0), |(sum, slope), k| {
                let rate = k.powf(p);
                (sum + rate, slope + rate * k.ln())
            });
            -slope / (sum * sum)
        };
        cycles_since_first(&self.integral(slope), lengths)
    }

    /// Integral over the crack length of a function of ΔK in MPa√m, with the lengths to which it goes: Simpson's rule over pairs of
    /// intervals.
    fn integral(&self, of: impl Fn(&[f64]) -> f64) -> Vec<(f64, f64)> {
        let mut sum = 0.0;
        let mut curve = vec![(0.0, self.pieces.first().map_or(f64::NAN, |piece| piece.lengths[0]))];
        for piece in &self.pieces {
            let (mut half, mut whole) = (0.0, 0.0);
            if piece.counts {
                let values = [0, 1, 2].map(|i| of(&piece.delta_k[i]));
                let step = piece.lengths[2] - piece.lengths[0];
                whole = step / 6.0 * (values[0] + 4.0 * values[1] + values[2]);
                // Parabola through the three values, integrated over its first half.
                half = step / 24.0 * (5.0 * values[0] + 8.0 * values[1] - values[2]);
            }
            curve.push((sum + half, piece.lengths[1]));
            sum += whole;
            curve.push((sum, piece.lengths[2]));
        }
        curve
    }
}
