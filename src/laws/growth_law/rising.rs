//! A rising curve through rates that scatter.

use nalgebra::{DMatrix, DVector};

/// Rates for each point of a curve, and most points.
const RATES_PER_POINT: usize = 3;
const POINTS_MAX: usize = 12;
/// Distance of ln da/dN up to which squares count, and beyond it sizes, so that outliers pull no more than others.
const SQUARES: f64 = 0.05;
/// Rounds of weights.
const ROUNDS: usize = 40;

/// ΔK and rates of a rising curve through rates by rising ΔK, and the root mean square of ln of what they lie from it: straight lines in logarithms
/// between a few points, evenly among the rates, by least sizes of ln da/dN. Of the numbers of points with a rising curve the one with the least
/// criterion of Akaike (1974, IEEE Trans. Autom. Control 19:716; Hurvich and Tsai 1989) counts. `None`: too few rates, or none that rises.
pub(super) fn rising(pairs: &[[f64; 2]]) -> Option<(Vec<[f64; 2]>, f64)> {
    let logs: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.map(f64::ln)).collect();
    let n = logs.len();
    let of = |points: usize| -> Option<(f64, Vec<[f64; 2]>, f64)> {
        let mut at: Vec<f64> = (0..points).map(|k| logs[(k * (n - 1) + (points - 1) / 2) / (points - 1)][0]).collect();
        at.dedup();
        let (heights, residuals) = fit(&logs, &at)?;
        let curve: Vec<[f64; 2]> = at.iter().zip(&heights).map(|(x, y)| [x.exp(), y.exp()]).collect();
        let (n, k) = (n as f64, at.len() as f64 + 1.0);
        let size = residuals.iter().map(|r| r.abs()).sum::<f64>() / n;
        let rms = (residuals.iter().map(|r| r * r).sum::<f64>() / n).sqrt();
        let criterion = 2.0 * n * size.max(1e-9).ln() + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0).max(1.0);
        curve.windows(2).all(|pair| pair[0][1] < pair[1][1]).then_some((criterion, curve, rms))
    };
    let numbers = 2..=(n / RATES_PER_POINT).min(POINTS_MAX);
    numbers.filter_map(of).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, curve, rms)| (curve, rms))
}

/// Heights of the points at `at`, and what the rates lie above the lines between them.
fn fit(logs: &[[f64; 2]], at: &[f64]) -> Option<(DVector<f64>, DVector<f64>)> {
    let last = at.len().checked_sub(1).filter(|last| *last > 0)?;
    let mut hats = DMatrix::zeros(logs.len(), at.len());
    for (row, [x, _]) in logs.iter().enumerate() {
        let next = at.partition_point(|point| point < x).clamp(1, last);
        let share = (x - at[next - 1]) / (at[next] - at[next - 1]);
        (hats[(row, next - 1)], hats[(row, next)]) = (1.0 - share, share);
    }
    let rates = DVector::from_iterator(logs.len(), logs.iter().map(|pair| pair[1]));
    let mut residuals = DVector::<f64>::zeros(logs.len());
    let mut heights = DVector::zeros(at.len());
    for _ in 0..ROUNDS {
        let weighted = DMatrix::from_fn(logs.len(), at.len(), |i, k| hats[(i, k)] / f64::abs(residuals[i]).max(SQUARES));
        heights = (hats.transpose() * &weighted).cholesky()?.solve(&(weighted.transpose() * &rates));
        residuals = &rates - &hats * &heights;
    }
    Some((heights, residuals))
}
