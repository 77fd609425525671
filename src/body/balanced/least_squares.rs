//! Bounded damped least squares on sparse equations, by Newton's method on the dual.
//!
//! `min ½ |x|² + Σ_i (G x - r)_i² / (2 ε_i)` with `lo ≤ x ≤ hi`. Its dual in one multiplier λ per equation is concave and
//! piecewise quadratic; `x = clip(Gᵀλ)`. A Newton step solves `(G_f G_fᵀ + ε) d = r - G x - ε λ` over the columns f that are
//! not at a bound (semi-smooth Newton: Hintermüller, Ito and Kunisch 2002, SIAM J. Optim. 13:865); an exact
//! line search makes it converge from anywhere. Without active bounds it ends after one step. The matrix couples the two ends
//! of bonds near the rim only, so cost grows with the length of the rim.

use faer::sparse::{SparseColMat, SymbolicSparseColMat};

use crate::block_cholesky::Structure;

/// Equations of a point: four of force, two of rotation.
pub(super) const EQUATIONS: usize = 6;
/// ε of the equations of force: the least at which the factor is sound, and larger ones for rims that no multipliers
/// within the bounds can serve.
const SOFTNESS: [f64; 3] = [1e-7, 1e-5, 1e-3];
/// ε of the equations of rotation: as dear as a multiplier's distance from 1.
const SOFTNESS_TURN: f64 = 1.0;
/// Newton steps at one softness.
const STEPS: usize = 25;
/// Gradient over the largest residual at which a step is the last.
const TOLERANCE: f64 = 1e-8;

/// One value per equation of a point.
pub type Gain = [f64; EQUATIONS];

/// What a bond of multiplier 1 adds to the equations of its ends.
#[derive(Debug, Clone, Copy)]
pub struct BondGain {
    /// At the point that owns it.
    pub at_owner: Gain,
    /// At the other end.
    pub at_other: Gain,
}

/// An unknown: a bond between two points.
#[derive(Debug, Clone, Copy)]
pub struct Link {
    /// Number of the owner.
    pub from: u32,
    /// Number of the other end, larger than the owner's.
    pub to: u32,
    /// Entry of the stencil.
    pub k: usize,
}

/// Equations over the changes of multipliers.
pub struct Problem<'a> {
    gains: &'a [BondGain],
    /// Sorted by owner, then by other end.
    links: Vec<Link>,
    missing: Vec<Gain>,
    /// First link of every point.
    first: Vec<usize>,
    symbolic: SymbolicSparseColMat<usize>,
}

impl<'a> Problem<'a> {
    /// Equations `Σ gain x = missing` of all points.
    #[must_use]
    pub fn new(gains: &'a [BondGain], links: Vec<Link>, missing: Vec<Gain>) -> Self {
        let points = missing.len();
        let mut first = vec![0; points + 1];
        links.iter().for_each(|link| first[link.from as usize + 1] += 1);
        (0..points).for_each(|p| first[p + 1] += first[p]);
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for point in 0..points {
            for c in 0..EQUATIONS {
                rows.extend((c..EQUATIONS).map(|d| point * EQUATIONS + d));
                for link in &links[first[point]..first[point + 1]] {
                    rows.extend((0..EQUATIONS).map(|d| link.to as usize * EQUATIONS + d));
                }
                starts.push(rows.len());
            }
        }
        let n = points * EQUATIONS;
        let symbolic = SymbolicSparseColMat::new_checked(n, n, starts, None, rows);
        Problem { gains, links, missing, first, symbolic }
    }

    /// The changes within their bounds, with the smallest softness that Newton's method manages; `None` if it manages none.
    #[must_use]
    pub fn solve(&self, bounds: [f64; 2]) -> Option<Vec<f64>> {
        self.solve_to(&SOFTNESS, bounds)
    }

    /// The same with other values of ε of the equations of force, the first of them that Newton's method manages.
    #[must_use]
    pub fn solve_to(&self, softness: &[f64], bounds: [f64; 2]) -> Option<Vec<f64>> {
        if self.links.is_empty() {
            return Some(Vec::new());
        }
        let structure = Structure::of(self.symbolic.as_ref(), EQUATIONS)?;
        softness.iter().find_map(|&softness| self.newton(&structure, softness, bounds))
    }

    fn newton(&self, structure: &Structure, softness: f64, [lo, hi]: [f64; 2]) -> Option<Vec<f64>> {
        let n = self.missing.len() * EQUATIONS;
        let epsilon = |i: usize| if i % EQUATIONS < 4 { softness } else { SOFTNESS_TURN };
        let missing = self.missing.as_flattened();
        let scale = missing.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        let clip = |y: f64| y.clamp(lo, hi);
        let (mut lambda, mut y) = (vec![0.0; n], vec![0.0; self.links.len()]);
        for _ in 0..STEPS {
            let x: Vec<f64> = y.iter().map(|&y| clip(y)).collect();
            let carried = self.apply(&x);
            let gradient: Vec<f64> = (0..n).map(|i| missing[i] - carried[i] - epsilon(i) * lambda[i]).collect();
            if gradient.iter().all(|g| g.abs() <= TOLERANCE * scale) {
                return Some(x);
            }
            let free: Vec<bool> = y.iter().map(|&y| y > lo && y < hi).collect();
            let matrix = SparseColMat::new(self.symbolic.clone(), self.normal_matrix(&free, epsilon));
            let mut step = gradient;
            structure.solve(matrix.as_ref(), &mut step)?;
            let z = self.apply_transposed(&step);
            // Slope of the dual along the step: falls as the way grows.
            let fixed = (0..n).map(|i| step[i] * (missing[i] - epsilon(i) * lambda[i])).sum::<f64>();
            let curved = (0..n).map(|i| step[i] * step[i] * epsilon(i)).sum::<f64>();
            let slope = |way: f64| {
                let carried: f64 = y.iter().zip(&z).map(|(y, z)| z * clip(y + way * z)).sum();
                fixed - way * curved - carried
            };
            let way = if slope(1.0) >= -1e-9 * slope(0.0) { 1.0 } else { root(slope) };
            lambda.iter_mut().zip(&step).for_each(|(l, d)| *l += way * d);
            y.iter_mut().zip(&z).for_each(|(y, z)| *y += way * z);
        }
        None
    }

    /// G x.
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut sums = vec![[0.0; EQUATIONS]; self.missing.len()];
        for (link, &x) in self.links.iter().zip(x) {
            let gain = &self.gains[link.k];
            for (end, gain) in [(link.from, &gain.at_owner), (link.to, &gain.at_other)] {
                sums[end as usize].iter_mut().zip(gain).for_each(|(sum, g)| *sum += g * x);
            }
        }
        sums.into_flattened()
    }

    /// Gᵀ λ.
    fn apply_transposed(&self, lambda: &[f64]) -> Vec<f64> {
        let dot = |end: u32, gain: &Gain| -> f64 {
            let at = end as usize * EQUATIONS;
            lambda[at..at + EQUATIONS].iter().zip(gain).map(|(l, g)| l * g).sum()
        };
        self.links
            .iter()
            .map(|link| {
                let gain = &self.gains[link.k];
                dot(link.from, &gain.at_owner) + dot(link.to, &gain.at_other)
            })
            .collect()
    }

    /// Values of the lower triangle of `G_f G_fᵀ + ε` in the order of the symbolic matrix.
    fn normal_matrix(&self, free: &[bool], epsilon: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut own = vec![[[0.0; EQUATIONS]; EQUATIONS]; self.missing.len()];
        for (link, _) in self.links.iter().zip(free).filter(|(_, free)| **free) {
            let gain = &self.gains[link.k];
            for (end, gain) in [(link.from, &gain.at_owner), (link.to, &gain.at_other)] {
                for (column, g) in own[end as usize].iter_mut().zip(gain) {
                    column.iter_mut().zip(gain).for_each(|(sum, h)| *sum += g * h);
                }
            }
        }
        let mut values = Vec::with_capacity(self.symbolic.row_idx().len());
        for (point, own) in own.iter().enumerate() {
            let range = self.first[point]..self.first[point + 1];
            for (c, column) in own.iter().enumerate() {
                values.extend((c..EQUATIONS).map(|d| column[d] + if c == d { epsilon(point * EQUATIONS + c) } else { 0.0 }));
                for (link, &free) in self.links[range.clone()].iter().zip(&free[range.clone()]) {
                    let gain = &self.gains[link.k];
                    let g = if free { gain.at_owner[c] } else { 0.0 };
                    values.extend(gain.at_other.iter().map(|h| g * h));
                }
            }
        }
        values
    }
}

/// Zero of a falling function between 0 and 1, where it is positive and negative.
fn root(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
