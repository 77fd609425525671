//! The law with the shape of the data: a natural spline about a chord.

use perilife_base::units::MPA_SQRT_M;
use perilife_laws::curve::{CurveLaw, KNOTS, ROUGHNESS, ROWS, Shape, Shaped};
use perilife_laws::growth_law::{GrowthLaw, Walker};
use perilife_laws::paris::ParisLaw;

const RANGE: [f64; 2] = [8.0 * MPA_SQRT_M, 26.0 * MPA_SQRT_M];
const RATES: [f64; ROWS] = [3e-8, 8e-8, 1.6e-7, 2.7e-7, 5.3e-7, 1.5e-6];

#[test]
fn it_goes_through_its_knots_smoothly_and_on_by_the_chord() {
    let law = CurveLaw::through(RANGE, RATES);
    for (k, rate) in law.knots().into_iter().zip(RATES) {
        assert!((law.log_rate(k) - rate.ln()).abs() < 1e-12, "{k}: {}", law.log_rate(k));
    }
    let step = 1e-6;
    let difference = |log_k: f64| (law.at(log_k + step) - law.at(log_k - step)) / (2.0 * step);
    for k in law.knots().into_iter().skip(1).take(KNOTS) {
        let [before, after] = [-1e-5, 1e-5].map(|side| difference(k.ln() + side));
        assert!((before - after).abs() < 1e-3 && (law.local_slope(k) - difference(k.ln())).abs() < 1e-5, "{before} {after}");
    }
    // A natural spline is straight at its ends.
    let second = |log_k: f64| (difference(log_k + 1e-3) - difference(log_k - 1e-3)) / 2e-3;
    assert!(second(RANGE[0].ln() + 2e-3).abs() < 0.2 && second(RANGE[1].ln() - 2e-3).abs() < 0.2);
    let chord = (RATES[ROWS - 1] / RATES[0]).ln() / (RANGE[1] / RANGE[0]).ln();
    for k in [0.5 * RANGE[0], 2.0 * RANGE[1]] {
        assert!((law.local_slope(k) - chord).abs() < 1e-12);
    }
}

/// Values of an independent trial (natural cubic splines by solving for their second derivatives).
#[test]
fn roughness_is_the_integral_of_the_squared_second_derivative() {
    let law = |k: usize| {
        let shape = std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
        CurveLaw { pivot: 1.0, level: 0.0, slope: 0.0, range: [1.0, std::f64::consts::E], shape: Some(shape) }
    };
    let pieces = 2000;
    let second = |law: &CurveLaw, t: f64| {
        let h = 1e-4;
        (law.at(t + h) - 2.0 * law.at(t) + law.at(t - h)) / (h * h)
    };
    for (j, row) in ROUGHNESS.iter().enumerate() {
        for (k, wanted) in row.iter().enumerate() {
            let sum: f64 = (0..pieces)
                .map(|i| (f64::from(i) + 0.5) / f64::from(pieces))
                .map(|t| second(&law(j), t) * second(&law(k), t) / f64::from(pieces))
                .sum();
            assert!((0.003_691_005_3 * sum - wanted).abs() < 1e-4, "{j} {k}: {sum} {wanted}");
        }
    }
    let determinant = nalgebra::Matrix4::from_fn(|i, j| ROUGHNESS[i][j]).determinant();
    assert!((determinant.ln() - 1.949).abs() < 5e-4, "{determinant}");
}

#[test]
fn rows_of_a_power_law_make_no_shape_and_another_ratio_goes_by_gamma() {
    let paris = ParisLaw { c: 1e-11, m: 3.0 };
    let straight = CurveLaw::through(RANGE, CurveLaw::through(RANGE, RATES).knots().map(|k| paris.rate(k)));
    assert!((straight.slope - 3.0).abs() < 1e-12 && straight.slope_deviation() < 1e-9 && straight.rises());
    let (curve, ratio) = (CurveLaw::through(RANGE, RATES), 0.2);
    // C at R = 0 of a law fitted at R = 0.2.
    let gamma = 0.6;
    let walker = Walker { paris: ParisLaw { c: paris.c * 0.8_f64.powf(3.0 * (1.0 - gamma)), m: 3.0 }, gamma, threshold: 0.0 };
    let law = Shaped { walker, shape: Shape { curve, paris, ratio } };
    let k = 15.0 * MPA_SQRT_M;
    assert!((law.rate(k / 0.8, ratio) / curve.log_rate(k).exp() - 1.0).abs() < 1e-12);
    let equivalent = k / 0.5 * 0.5_f64.powf(gamma) * 0.8_f64.powf(1.0 - gamma);
    assert!((law.rate(k / 0.5, 0.5) / curve.log_rate(equivalent).exp() - 1.0).abs() < 1e-12);
    let still = Shaped { walker: Walker { threshold: 16.0 * MPA_SQRT_M, ..walker }, ..law };
    assert_eq!(still.rate(k / 0.8, ratio), 0.0);
}
