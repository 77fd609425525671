//! Blended polynomials through a table: order on even points, no swing on uneven ones.

use perilife_base::blended::Blended;

/// Largest error of the table of a function at `count` even points of 0 to 2.
fn error(count: usize, of: fn(f64) -> f64) -> f64 {
    let table = Blended::new((0..=count).map(|i| 2.0 * i as f64 / count as f64).map(|x| (x, of(x))));
    (0..=1000).map(|i| 2.0 * f64::from(i) / 1000.0).map(|x| (table.at(x) - of(x)).abs()).fold(0.0, f64::max)
}

#[test]
fn errors_fall_by_the_fifth_power_and_quartics_are_exact() {
    assert!(error(7, |x| 1.0 - 2.0 * x + 0.5 * x.powi(3) - 0.25 * x.powi(4)) < 1e-13);
    let errors = [20, 40, 80].map(|count| error(count, |x| (3.0 * x).sin()));
    println!("{errors:?}");
    // The ends of the table decide, where the five points lie on one side.
    assert!(errors.windows(2).all(|pair| pair[0] / pair[1] > 24.0), "{errors:?}");
}

#[test]
fn value_and_slope_are_continuous_at_the_points() {
    let even: Vec<(f64, f64)> = (0..9).map(|i| (f64::from(i), (0.7 * f64::from(i)).cos())).collect();
    let uneven = [(0.0, 1.0), (1.0, 1.2), (2.0, 1.1), (5.0, 2.0), (30.0, 2.5), (31.0, 2.4), (33.0, 3.0)].to_vec();
    for points in [even, uneven] {
        let table = Blended::new(points.iter().copied());
        for &(x, y) in &points[1..points.len() - 1] {
            let step = 1e-6;
            let [before, at, after] = [x - step, x, x + step].map(|x| table.at(x));
            assert!((at - y).abs() < 1e-12, "{x}");
            assert!(((after - at) - (at - before)).abs() / step < 1e-4, "slope at {x}: {} and {}", at - before, after - at);
        }
    }
}

/// Readings that lie together in two groups: between them a quartic would leave their range by more than that range.
#[test]
fn uneven_points_do_not_swing() {
    let points = [(10.0, 1.00), (11.0, 1.02), (12.0, 1.01), (40.0, 1.50), (41.0, 1.52), (42.0, 1.60)];
    let table = Blended::new(points.into_iter());
    for x in (10..=42).map(f64::from) {
        assert!((0.9..1.7).contains(&table.at(x)), "{x}: {}", table.at(x));
    }
}
