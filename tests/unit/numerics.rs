//! Single functions: interpolation, integrals, closed forms, rates.

use std::cell::Cell;
use std::f64::consts::PI;

use perilife_base::blended::Blended;
use perilife_base::monotone::Monotone;
use perilife_base::quadrature::integrate;
use perilife_base::units::MPA_SQRT_M;
use perilife_laws::curve::{CurveLaw, KNOTS, ROUGHNESS, ROWS, Shape, Shaped};
use perilife_laws::growth_law::{GrowthLaw, Walker};
use perilife_laws::growth_rate::{LengthAverage, Sample, release_rate_at_end};
use perilife_laws::paris::ParisLaw;
use perilife_study::values::{Collinear, growth_integral};

// Blended polynomials through a table: order on even points, no swing on uneven ones.

/// Largest error of the table of a function at `count` even points of 0 to 2.
fn error(count: usize, of: fn(f64) -> f64) -> f64 {
    let table = Blended::new((0..=count).map(|i| 2.0 * i as f64 / count as f64).map(|x| (x, of(x))));
    (0..=1000).map(|i| 2.0 * f64::from(i) / 1000.0).map(|x| (table.at(x) - of(x)).abs()).fold(0.0, f64::max)
}

#[test]
fn errors_fall_by_the_fifth_power_and_quartics_are_exact() {
    assert!(error(7, |x| 1.0 - 2.0 * x + 0.5 * x.powi(3) - 0.25 * x.powi(4)) < 1e-13);
    let errors = [20, 40, 80].map(|count| error(count, |x| (3.0 * x).sin()));
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

// Cycles over crack length between rows.

/// N(a) of da/dN = C ΔK³, ΔK ~ √a: rows a quarter of the first crack apart are read to 0.15 % of life, on straight lines to 0.8 %.
#[test]
fn lives_between_rows_of_a_power_law() {
    let cycles = |a: f64| 1.0 / 10.0_f64.sqrt() - 1.0 / a.sqrt();
    let rows: Vec<[f64; 2]> = (0..17).map(|i| 10.0 + 2.5 * f64::from(i)).map(|a| [a, cycles(a)]).collect();
    let (table, life) = (Monotone::new(rows.iter().copied()), cycles(50.0));
    let mut worst = [0.0_f64; 2];
    for a in (0..=400).map(|i| 10.0 + 0.1 * f64::from(i)) {
        let pair = rows.windows(2).find(|pair| a <= pair[1][0] + 1e-9).unwrap();
        let line = pair[0][1] + (a - pair[0][0]) / (pair[1][0] - pair[0][0]) * (pair[1][1] - pair[0][1]);
        worst = [worst[0].max((table.at(a) - cycles(a)).abs() / life), worst[1].max((line - cycles(a)).abs() / life)];
    }
    assert!(worst[0] < 2e-3 && worst[1] > 5.0 * worst[0], "{worst:?}");
    // The inverse is one.
    for (before, y) in [(0, cycles(10.7)), (5, cycles(24.0)), (15, cycles(49.9))] {
        let a = rows[before][0] + table.fraction(before, y) * 2.5;
        assert!((table.at(a) - y).abs() < 1e-12, "{a}");
    }
}

#[test]
fn a_table_never_falls_and_keeps_its_points() {
    let rows = [[0.0, 0.0], [1.0, 5.0], [1.0, 6.0], [2.0, 6.0], [3.0, 6.1], [10.0, 90.0]];
    let table = Monotone::new(rows.into_iter());
    let values: Vec<f64> = (0..=1000).map(|i| table.at(0.01 * f64::from(i))).collect();
    assert!(values.windows(2).all(|pair| pair[0] <= pair[1]));
    assert_eq!([table.at(0.0), table.at(1.0), table.at(2.0), table.at(3.0), table.at(10.0)], [0.0, 6.0, 6.0, 6.1, 90.0]);
    assert!(Monotone::new(std::iter::empty()).at(1.0).is_nan());
}

// The law with the shape of the data: a natural spline about a chord.

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

// The mean length over one spacing of growth: no stairs, no shift, fixed ends.

/// A crack that grows steadily by 0.01 a cycle, recorded as breaks of uneven size in a pattern that repeats every 0.9.
fn staircase(breaks: usize) -> (Vec<f64>, Vec<f64>) {
    let mut cycles = vec![0.0];
    let mut lengths = vec![5.0];
    for i in 0..breaks {
        let period = (i / 3 + 1) as f64;
        cycles.push(90.0 * (i / 3) as f64 + [20.0, 35.0, 90.0][i % 3]);
        lengths.push(5.0 + 0.9 * (period - 1.0) + [0.5, 0.7, 0.9][i % 3]);
    }
    (cycles, lengths)
}

#[test]
fn stairs_vanish_and_steady_growth_stays() {
    let (cycles, lengths) = staircase(90);
    let averaged = LengthAverage::new(&cycles, &lengths, 0.9).of_rising(&lengths);
    let steady = |n: f64| 5.0 + 0.01 * n;
    let roughness = |values: &[f64], from: usize, to: usize| {
        let off: Vec<f64> = (from..to).map(|i| values[i] - steady(cycles[i])).collect();
        off.iter().copied().fold(f64::NEG_INFINITY, f64::max) - off.iter().copied().fold(f64::INFINITY, f64::min)
    };
    // Away from the ends, where the whole window fits.
    assert!(roughness(&lengths, 5, 85) > 0.3);
    assert!(roughness(&averaged, 5, 85) < 1e-9, "{}", roughness(&averaged, 5, 85));
    assert!(averaged.windows(2).all(|pair| pair[1] >= pair[0]));
    assert_eq!((averaged[0], averaged[90]), (lengths[0], lengths[90]));
}

#[test]
fn a_straight_curve_stays_itself_and_a_sudden_jump_is_not_smeared() {
    let cycles: Vec<f64> = (0..50).map(f64::from).collect();
    let straight: Vec<f64> = cycles.iter().map(|n| 3.0 + 0.2 * n).collect();
    for (mean, length) in LengthAverage::new(&cycles, &straight, 1.0).of(&straight).iter().zip(&straight) {
        assert!((mean - length).abs() < 1e-12, "{mean} and {length}");
    }
    // The last ligament breaks in no time: what stood before the jump stays below it.
    let jump_cycles = [0.0, 10.0, 20.0, 30.0, 30.0, 30.0];
    let jump = [1.0, 1.1, 1.2, 1.3, 4.0, 9.0];
    let mean = LengthAverage::new(&jump_cycles, &jump, 1.0).of_rising(&jump);
    assert!(mean[3] < 1.31 && mean[5] == 9.0, "{mean:?}");
}

#[test]
fn runs_of_one_or_two_rows_stay() {
    assert_eq!(LengthAverage::new(&[0.0], &[2.0], 1.0).of(&[2.0]), [2.0]);
    assert_eq!(LengthAverage::new(&[0.0, 7.0], &[2.0, 2.5], 1.0).of(&[2.0, 2.5]), [2.0, 2.5]);
}

// Energy release rates from work over growth.

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

// Integrals with known values.

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

// The closed form of two collinear cracks against its table and its limits.

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
