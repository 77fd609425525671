//! Integrals with known values.

use std::cell::Cell;

use perilife_base::quadrature::integrate;

#[test]
fn polynomials_up_to_degree_22_are_exact_on_one_panel() {
    for degree in 0..=22 {
        // Loose enough that no panel is halved: the rule itself is tested.
        let found = integrate(|x| x.powi(degree), -0.5, 1.5, 1.0).value;
        let n = f64::from(degree + 1);
        let exact = (1.5_f64.powf(n) - (-0.5_f64).powi(degree + 1)) / n;
        assert!((found / exact - 1.0).abs() < 1e-13, "x^{degree}: {found} against {exact}");
    }
}

#[test]
fn hard_integrands_are_halved_until_they_are_right() {
    let oscillation = |x: f64| (50.0 * x).cos() * (-x).exp();
    // (1 - e^-3 (cos 150 - 50 sin 150)) / 2501
    let exact = (1.0 - (-3.0_f64).exp() * (150.0_f64.cos() - 50.0 * 150.0_f64.sin())) / 2501.0;
    let found = integrate(oscillation, 0.0, 3.0, 1e-10);
    assert!((found.value - exact).abs() < 1e-9 * exact.abs() + found.error, "{found:?} against {exact}");
    // Infinite at its end, where it is never asked.
    let root = integrate(|x: f64| 1.0 / x.sqrt(), 0.0, 4.0, 1e-10);
    assert!((root.value - 4.0).abs() < 1e-5, "{root:?}");
    // A narrow peak between the points of a single panel's rule.
    let peak = |x: f64| 1e-3 / (1e-6 + (x - 0.3).powi(2));
    let exact = (700.0_f64).atan() + (300.0_f64).atan();
    assert!((integrate(peak, 0.0, 1.0, 1e-10).value / exact - 1.0).abs() < 1e-9);
}

#[test]
fn easy_integrands_cost_one_panel_and_nan_ends() {
    let asked = Cell::new(0);
    let counted = |x: f64| {
        asked.set(asked.get() + 1);
        x * x
    };
    assert!((integrate(counted, 0.0, 3.0, 1e-12).value - 9.0).abs() < 1e-13);
    assert_eq!(asked.get(), 15);
    assert!(integrate(|_| f64::NAN, 0.0, 1.0, 1e-10).value.is_nan());
    assert_eq!(integrate(|x| x, 2.0, 2.0, 1e-10).value, 0.0);
}
