//! Energy release rates from work over growth.

use perilife_laws::growth_rate::{Sample, release_rate_at_end};

fn samples(work: impl Fn(f64) -> f64, growths: &[f64]) -> Vec<Sample> {
    growths.iter().map(|&growth| Sample { cycles: 0.0, crack_length: growth, growth, work: work(growth) }).collect()
}

#[test]
fn the_release_rate_at_the_end_is_the_slope_there() {
    let (work, slope) = (|g: f64| 5.0 + 300.0 * g + 4e4 * g * g, |g: f64| 300.0 + 8e4 * g);
    let growths: Vec<f64> = (0..12).map(|i| 1e-3 + 5e-4 * f64::from(i) * (1.0 + 0.1 * f64::from(i % 3))).collect();
    let found = release_rate_at_end(&samples(work, &growths), 2e-3).unwrap();
    let last = growths[growths.len() - 1];
    assert!((found / (slope(last) / 4e-3) - 1.0).abs() < 1e-9, "{found}");
    // Two or three lengths give the slope of the straight line between first and last.
    let found = release_rate_at_end(&samples(work, &growths[..3]), 2e-3).unwrap();
    let secant = (work(growths[2]) - work(growths[0])) / (growths[2] - growths[0]);
    assert!((found / (secant / 4e-3) - 1.0).abs() < 1e-9, "{found}");
    for still in [&growths[..0], &growths[..1], &[1e-3, 1e-3]] {
        assert_eq!(release_rate_at_end(&samples(work, still), 2e-3), None);
    }
}
