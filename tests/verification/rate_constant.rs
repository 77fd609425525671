//! Growth data of the library and rate constants against what they were computed from.

use std::f64::consts::PI;
use std::path::Path;

use perilife_base::input::Folder;
use perilife_base::quadrature::integrate;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::{Case, library_law};
use perilife_growth::predict::factor_curve::FactorCurve;
use perilife_growth::predict::{Silent, StopReason, predict};
use perilife_growth::rate_constant::{OFF_THE_ROWS, rate_constant};
use perilife_laws::STEADY_EXPONENTS;
use perilife_laws::growth_law::nasgro::keys_of;
use perilife_plate::material::growth_data::{record, records};
use perilife_points::bond_law::Kernel;
use perilife_points::spacing::HORIZON_RATIO;

use crate::support::rows::assert_refusal;

// Growth data of the library against values computed from the published constants by themselves.

/// Thickness of the check values, 0.1 in.
const THICKNESS: f64 = 2.54 * MM;

/// da/dN, mm/cycle, at ΔK = 10 MPa√m and R = 0 and 0.5, by the constants in ksi and inch as NASGRO 4 lists them.
#[test]
fn rates_of_the_library_are_those_of_its_source() {
    for (name, rates) in [
        ("al2024-t3-clad-lt", [6.985e-5, 2.159e-4]),
        ("al7075-t6-sheet-lt", [1.207e-4, 3.428e-4]),
        ("al7050-t7451-plate-lt", [7.513e-5, 2.269e-4]),
    ] {
        for (ratio, expected) in [0.0, 0.5].into_iter().zip(rates) {
            let law = library_law(name, THICKNESS, ratio, &Folder::none()).unwrap().0;
            let rate = law.rate(10.0 * MPA_SQRT_M / (1.0 - ratio), ratio) / MM_PER_CYCLE;
            assert!((rate / expected - 1.0).abs() < 5e-4, "{name}, R = {ratio}: {rate}");
        }
    }
    // Thresholds of 2024-T3: 3.20 and 2.00 MPa√m.
    for (ratio, threshold) in [(0.0, 3.20), (0.5, 2.00)] {
        let law = library_law("al2024-t3-clad-lt", THICKNESS, ratio, &Folder::none()).unwrap().0;
        let grows = |delta_k: f64| law.rate(delta_k * MPA_SQRT_M / (1.0 - ratio), ratio) > 0.0;
        assert!(!grows(threshold - 0.005) && grows(threshold + 0.005), "R = {ratio}");
    }
}

#[test]
fn every_record_gives_a_law_of_metals() {
    let records = records();
    assert!(records.len() >= 20);
    for record in &records {
        for ratio in [-1.0, 0.0, 0.1, 0.7] {
            let law = library_law(&record.name, THICKNESS, ratio, &Folder::none()).unwrap().0;
            let rate = |k_max: f64| law.rate(k_max * MPA_SQRT_M, ratio) / MM_PER_CYCLE;
            let (name, [low, high]) = (&record.name, [15.0, 18.0].map(rate));
            assert!(low > 1e-8 && high < 1e-2, "{name}, R {ratio}: {low} and {high}");
            assert!(high > low, "{name}, R {ratio}: rates rise");
        }
    }
}

const PANEL: &str = include_str!("../reference/cases/rate_constant_panel.toml");

fn case(fatigue: &str) -> perilife_base::error::Result<Case> {
    Case::from_toml(&format!("{PANEL}{fatigue}"), "panel", Folder::none(), &[])
}

#[test]
fn a_case_takes_the_law_of_its_material() {
    let of_library = case("growth_law = \"library\"").unwrap();
    assert!(of_library.growth_data.as_ref().unwrap().contains("2024-T3"));
    let run = predict(&of_library, &Silent).unwrap();
    // The same constants given in the case.
    let keys = keys_of(&record("al2024-t3-clad-lt").unwrap(), 2.54);
    let given = case(&toml::to_string(&keys).unwrap()).unwrap();
    let same = predict(&given, &Silent).unwrap();
    assert_eq!(run.life_cycles(), same.life_cycles());
    assert!(given.growth_data.is_none());
    for (fatigue, problem) in [
        ("growth_law = \"library\"\nparis_m = 3.0", "conflicts with growth_law"),
        ("growth_law = \"library\"\nfitted = \"fitted.toml\"", "conflicts with"),
    ] {
        assert_refusal(case(fatigue), &[problem]);
    }
    let of = |name: &str| {
        let text = format!("{PANEL}growth_law = \"library\"").replace("\"al2024-t3-clad-lt\"", name);
        Case::from_toml(&text, "panel", Folder::none(), &[]).unwrap_err().to_string()
    };
    assert!(of("\"al2024-t3\"").contains("has no growth law"), "elastic constants alone");
    assert!(of("\"al2024-t4-lt\"").contains("perilife list materials"));
}

// ln β(p) of `data/rate_constants.toml` against the crack that it was computed on.

/// Size of the reference plate, crack length (half) before and after, in horizons.
const WIDTH: f64 = 60.0;
const CRACK: [f64; 2] = [14.0, 16.0];
/// Growth of the crack before that, from a clean cut, in horizons: its front has the steady shape after one.
const LEAD: f64 = 1.5;
/// Exponents at which the crack is computed, and terms of the series that are kept of so many.
const NODES: usize = 96;
const TERMS: usize = 10;
/// Largest difference of ln β between the series and one crack up to p = 2 and above: bonds break one after another, so that the life of
/// one crack is no smooth function of p.
const SCATTER: [f64; 2] = [8e-3, 4e-3];
/// Largest difference of a coefficient from that in the file.
const ROUNDING: f64 = 5e-4;

/// A middle-tension plate of spacing 1 mm in plane stress, ν = 0.3, whose bonds have A = 1 at its horizon.
fn reference(kernel: Kernel, p: f64) -> Case {
    let horizon = HORIZON_RATIO;
    let [width, from, to] = [WIDTH, CRACK[0] - LEAD, CRACK[1]].map(|horizons| horizons * horizon);
    let text = format!(
        "[specimen]\nkind = \"middle_tension\"\nwidth_mm = {width}\nlength_mm = {width}\nthickness_mm = 1\ncrack_length_mm = {from}\n\
         [material]\nyoungs_modulus_gpa = 100\npoisson_ratio = 0.3\nplane = \"stress\"\n\
         [loading]\nkind = \"constant_amplitude\"\nstress_max_mpa = 100\nstress_ratio = 0\n\
         [model]\nspacing_mm = 1\nhorizon_ratio = {horizon}\nkernel = \"{kernel}\"\n\
         [fatigue]\ndriver = \"bond_strain\"\na = 1\np = {p}\nhorizon_mm = {horizon}\n[stop]\ncrack_length_mm = {to}\n"
    );
    let mut case = Case::from_toml(&text, "reference plate", Path::new(""), &[]).unwrap();
    case.stop.cycles_max = f64::INFINITY;
    case
}

/// K(a) of the reference plate, and its horizon, m.
fn factors(kernel: Kernel) -> FactorCurve {
    FactorCurve::of(&reference(kernel, 3.0), &Silent).unwrap()
}

/// ln β by the crack.
fn computed(kernel: Kernel, factors: &FactorCurve, p: f64) -> f64 {
    let case = reference(kernel, p);
    let grown = predict(&case, &Silent).unwrap();
    assert_eq!(grown.stop, StopReason::CrackLengthReached, "{kernel}, p = {p}");
    let (modulus, horizon) = (case.material.plane_modulus(), factors.figures.horizon);
    let [from, to] = [CRACK[0] * HORIZON_RATIO * MM, case.stop.crack_length];
    let slowness = integrate(|a| (factors.at(a) / modulus).powf(-p), from, to, 1e-6).value;
    let rows = grown.curve.windows(2).find(|rows| rows[1].crack_length >= from).unwrap();
    let start = rows[1].clone().between(&rows[0], (from - rows[0].crack_length) / (rows[1].crack_length - rows[0].crack_length));
    let cycles = grown.life_cycles() - start.cycles;
    // A = 1 belongs to the horizon 3.015 mm of the case.
    let a = (horizon / (HORIZON_RATIO * 1e-3)).powf((p - 2.0) / 2.0);
    (OFF_THE_ROWS.powf(p) * slowness / (a * cycles * horizon.powf(1.0 - 0.5 * p))).ln()
}

fn compare(kernels: &[Kernel], exponents: &[f64]) {
    for &kernel in kernels {
        let factors = factors(kernel);
        for &p in exponents {
            let difference = rate_constant(kernel, p).unwrap().ln() - computed(kernel, &factors, p);
            let bound = if p <= 2.0 { SCATTER[0] } else { SCATTER[1] };
            assert!(difference.abs() < bound, "{kernel}, p = {p}: ln β differs by {difference}");
        }
    }
}

#[test]
fn a_stored_rate_constant_is_that_of_the_reference_crack() {
    compare(&Kernel::ALL[..1], &[2.87]);
}

#[test]
#[ignore = "long: a minute; when bonds, kernels or the file change"]
fn stored_rate_constants_are_those_of_the_reference_crack() {
    compare(Kernel::ALL, &[1.5, 2.0, 2.87, 3.3, 4.45, 6.1, 8.0]);
}

/// Prints the rows of the file: the first terms of the interpolation at the roots of a Chebyshev polynomial.
#[test]
#[ignore = "long: cargo test coefficients_of_rate_constants -- --ignored --nocapture"]
fn coefficients_of_rate_constants() {
    let (low, high) = (STEADY_EXPONENTS.start(), STEADY_EXPONENTS.end());
    let angle = |j: usize| PI * (j as f64 + 0.5) / NODES as f64;
    let exponent = |j: usize| 0.5 * (low + high + (high - low) * angle(j).cos());
    let coefficients = |values: &[f64]| -> Vec<f64> {
        let coefficient = |k: usize| {
            let weight = if k == 0 { 1.0 } else { 2.0 } / NODES as f64;
            weight * values.iter().enumerate().map(|(j, value)| value * (k as f64 * angle(j)).cos()).sum::<f64>()
        };
        (0..TERMS).map(coefficient).collect()
    };
    for kernel in Kernel::ALL {
        let factors = factors(*kernel);
        let along_rows = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            (0..NODES).map(|j| of(exponent(j)) - exponent(j) * OFF_THE_ROWS.ln()).collect()
        };
        let found = coefficients(&along_rows(&|p| computed(*kernel, &factors, p)));
        let stored = coefficients(&along_rows(&|p| rate_constant(*kernel, p).unwrap().ln()));
        println!("{kernel} = {found:.6?}");
        let difference = found.iter().zip(&stored).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(difference < ROUNDING, "{kernel}: a coefficient of data/rate_constants.toml is off by {difference}");
    }
}
