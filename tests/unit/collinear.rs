//! The closed form of two collinear cracks against its table and its limits.

use std::f64::consts::PI;

use perilife_study::values::{Collinear, growth_integral};

#[test]
fn two_collinear_cracks_have_the_tabulated_factors() {
    // c = 0.5, d = 1.5: inner 1.0480, outer 1.0280 (Tada, Paris and Irwin 2000), unit σ √(π a) of a crack of half length 0.5.
    let unit = (PI * 0.5).sqrt();
    let [inner, outer] = Collinear { inner: 0.5, outer: 1.5 }.intensity().map(|k| k / unit);
    assert!((inner - 1.0480).abs() < 5e-5 && (outer - 1.0280).abs() < 5e-5, "{inner} {outer}");
    // Far apart each is alone; almost joined the outer tips are those of one crack.
    let far = Collinear { inner: 500.0, outer: 501.0 };
    assert!(far.intensity().iter().all(|k| (k / unit - 1.0).abs() < 1e-5), "{:?}", far.intensity());
    let joined = Collinear { inner: 1e-9, outer: 1.0 };
    // Approached with 1/ln(d/c) only.
    assert!(joined.intensity()[1] < PI.sqrt() && joined.intensity()[1] > 0.95 * PI.sqrt(), "{:?}", joined.intensity());
    assert!(joined.equivalent_crack() < 1.0 && joined.equivalent_crack() > 0.9);
    // Far away two cracks of half length 0.5 disturb as much as one of 0.5 √2.
    assert!((far.equivalent_crack() / 0.5_f64.sqrt() - 1.0).abs() < 1e-3, "{}", far.equivalent_crack());
}

#[test]
fn far_apart_they_live_as_long_as_one_crack() {
    // Growth by a quarter at both tips: ∫ da (σ √(π a))^-p with a = 0.5 + way, p = 3.
    let life = growth_integral(Collinear { inner: 2000.0, outer: 2001.0 }, 1999.75, 1e7, 2.0, 3.0);
    let exact = 2.0 * (0.5_f64.powf(-0.5) - 0.75_f64.powf(-0.5)) / (8.0 * PI.powf(1.5));
    assert!((life / exact - 1.0).abs() < 1e-5, "{life} and {exact}");
}
