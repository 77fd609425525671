//! Pareto front of time and error: runs that no other one beats in both.

/// Relative gain of error that earns a slower run its place: less is round-off between solvers that are equally exact.
pub const GAIN: f64 = 1e-3;

/// Indices of the front, fastest first: points (time, error) that are nearer to the reference than every faster one by more
/// than [`GAIN`]. Points that are not finite have no place on it.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).filter(|&i| points[i].0.is_finite() && points[i].1.is_finite()).collect();
    order.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0).then(points[a].1.total_cmp(&points[b].1)));
    let mut best = f64::INFINITY;
    order.retain(|&i| {
        let nearer = points[i].1 < best * (1.0 - GAIN);
        if nearer {
            best = points[i].1;
        }
        nearer
    });
    order
}
