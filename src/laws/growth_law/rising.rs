//! A rising curve through rates that scatter.

/// Fewest points of a curve.
const POINTS_MIN: usize = 3;

/// ΔK and rates of a rising curve through rates by rising ΔK: medians, which outliers do not move, of as few neighbours as make it rise, and straight
/// on from them to the ends. `None`: too few rates, or none that rises.
pub(super) fn rising(pairs: &[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
    let logs: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.map(f64::ln)).collect();
    let of = |size: usize| {
        let mut curve: Vec<[f64; 2]> = logs.chunks_exact(size).map(|some| [0, 1].map(|k| median(some, k))).collect();
        for (end, next, place) in [(0, 1, 0), (curve.len() - 1, curve.len() - 2, logs.len() - 1)] {
            let ([x, y], [x_next, y_next]) = (curve[end], curve[next]);
            curve[end] = [logs[place][0], y + (logs[place][0] - x) * (y_next - y) / (x_next - x)];
        }
        let rises = curve.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] < pair[1][1]);
        rises.then_some(curve)
    };
    let curve = (3..=logs.len() / POINTS_MIN).step_by(2).find_map(of)?;
    Some(curve.iter().map(|pair| pair.map(f64::exp)).collect())
}

fn median(some: &[[f64; 2]], k: usize) -> f64 {
    let mut values: Vec<f64> = some.iter().map(|pair| pair[k]).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
