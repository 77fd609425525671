//! The calibration finds the constants of curves that the engine or a known law made, on standard and on drawn plates.

use perilife_base::input::Folder;
use perilife_base::units::{GPA, MM, MPA_SQRT_M};
use perilife_calibration::calibrate::{calibrate, in_terms_of_bonds};
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::criterion::Criterion;
use perilife_calibration::fit::{Fit, FitTask, fit};
use perilife_calibration::power_law::PowerLaw;
use perilife_calibration::results::record;
use perilife_calibration::search::Constants;
use perilife_growth::case::Case;
use perilife_growth::predict::factor_curve::FactorCurve;
use perilife_growth::predict::{GoverningCrack, RunFigures, Silent, predict};
use perilife_growth::rate_constant::rate_constant;
use perilife_laws::FatigueLaw;
use perilife_laws::paris::ParisLaw;
use perilife_measured::MeasuredCurve;
use perilife_plate::specimen::handbook::handbook;

use crate::support::fatigue_test::distance_squared;
use crate::support::fits::report;
use crate::support::noise::Noise;
use crate::support::plates::case;

// The calibration finds the constants of curves that the engine itself computed.

/// The panel of Virkler et al. (1979) on a coarse lattice.
const PANEL: &str = "kind=\"middle_tension\"\nwidth_mm=152.4\nlength_mm=240\nthickness_mm=2.54\ncrack_length_mm=12\n";
const A: f64 = 5200.0;
const P: f64 = 2.87;
/// 95 % quantile of χ² with two degrees of freedom.
const ELLIPSE_95: f64 = 5.991;

/// A curve of the engine with known constants, read at its rows at least 1 mm apart, with relative noise on the cycles between
/// readings.
fn curve(spacing: f64, exact: &[(f64, f64)], scatter: f64, seed: u64) -> MeasuredCurve {
    let mut noise = Noise::new(seed);
    let (mut crack_length, mut cycles, mut before) = (vec![exact[0].1], vec![0.0], exact[0]);
    for &row in exact {
        if row.1 >= before.1 + 1.0 * MM {
            cycles.push(cycles[cycles.len() - 1] + (row.0 - before.0) * (1.0 + scatter * noise.normal()));
            crack_length.push(row.1);
            before = row;
        }
    }
    MeasuredCurve::new(format!("seed {seed} at {spacing} mm"), cycles, crack_length)
}

/// The panel, figures of its run, and fits of C and m to curves of several seeds, all from one run with the known constants.
fn fits(spacing: f64, scatter: f64, seeds: u64) -> (Case, RunFigures, Vec<Fit>) {
    let set = [format!("model.spacing_mm={spacing}"), format!("fatigue.a={A}"), format!("fatigue.p={P}")];
    let set: Vec<&str> = set.iter().map(String::as_str).chain(["fatigue.driver=tip_field", "stop.crack_length_mm=44"]).collect();
    let panel = case(PANEL, &set);
    let exact: Vec<(f64, f64)> = predict(&panel, &Silent).unwrap().curve.iter().map(|p| (p.cycles, p.crack_length)).collect();
    let formula = handbook(&panel.specimen).unwrap();
    let delta_k = |length: f64| formula.delta_k(length, panel.loading.maximum, panel.loading.range_share());
    let factors = FactorCurve::of(&panel, &Silent).unwrap();
    let of_field = |length: f64| panel.loading.range_share() * factors.at(length);
    let law = PowerLaw::new(panel.specimen.crack_length, panel.stop.crack_length, &of_field).unwrap();
    let fit_to = |seed: u64| {
        let curves = [curve(spacing, &exact, scatter, seed)];
        fit(&FitTask { curves: &curves, fixed_p: None, criterion: Criterion::BothEnds, delta_k: &delta_k }, &law).unwrap()
    };
    let found = (1..=seeds).map(fit_to).collect();
    (panel, factors.figures, found)
}

/// The law at the horizon that the fit belongs to.
fn known(horizon: f64) -> (f64, f64) {
    (A * (horizon / (3.015 * MM)).powf((P - 2.0) / 2.0), P)
}

#[test]
fn the_engine_recovers_its_own_constants() {
    let (panel, figures, mut found) = fits(4.0, 0.0, 1);
    let found = in_terms_of_bonds(found.remove(0), &panel, [figures.horizon, figures.spacing]).unwrap();
    let (_, p) = known(figures.horizon);
    let constants = found.record.constants;
    let (rms, life) = (found.record.rms_life_error(), found.record.life_fitted() / found.record.life_measured());
    // Blocks of a run are good to 0.2 % in cycles.
    assert!((constants.p - p).abs() < 0.02, "p = {}", constants.p);
    assert!(rms < 1e-3, "{rms}");
    assert!((life - 1.0).abs() < 1e-3, "{life}");
}

#[test]
fn truth_lies_inside_the_95_percent_ellipse_of_engine_fits() {
    let (panel, figures, found) = fits(3.0, 0.05, 200);
    let horizon = figures.horizon;
    let beta = rate_constant(panel.points().bond_law.kernel, P).unwrap();
    let truth = ParisLaw::of_bonds(&FatigueLaw { a: known(horizon).0, p: P, horizon }, beta, panel.material.plane_modulus());
    let is_inside = |fit: &&Fit| {
        let Constants { a: c, p: m } = fit.record.constants;
        distance_squared(fit.confidence.covariance, [(truth.c / c).ln(), truth.m - m]) < ELLIPSE_95
    };
    let inside = found.iter().filter(is_inside).count();
    let mean_p = found.iter().map(|fit| fit.record.constants.p).sum::<f64>() / found.len() as f64;
    println!("{} readings: inside {inside} of 200, mean p {mean_p:.4} (given {P})", found[0].record.crack_length.len());
    assert!(inside >= 170, "{inside} of 200 inside");
    assert!((mean_p / P - 1.0).abs() < 0.03, "mean p = {mean_p}");
}

// Calibration on plates that no handbook has: K along the crack's own path, and the constants that curves were made with found again.

const C: f64 = 4e-9;
const M: f64 = 3.4;

const REST: &str =
    "[material]\nyoungs_modulus_gpa = 72.0\npoisson_ratio = 0.3\n[loading]\nstress_max_mpa = 70.0\nstress_ratio = 0.1\n";
const PLATE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 100.0\nlength_mm = 200.0\nthickness_mm = 2.0\n";

/// Name, cracks and holes, spacing and last length in mm.
const PLATES: [(&str, &str, f64, f64); 3] = [
    ("middle crack", "cracks = [{ from_mm = [-10, 0], to_mm = [10, 0] }]\n", 2.0, 70.0),
    (
        "edge crack beside a hole",
        "cracks = [{ from_mm = [-50, 0], to_mm = [-32, 0] }]\nholes = [{ x_mm = -15, y_mm = 14, diameter_mm = 12 }]\n",
        2.0,
        38.0,
    ),
    (
        "unlike cracks",
        "cracks = [{ from_mm = [-50, 40], to_mm = [-32, 40] }, { from_mm = [50, -40], to_mm = [37, -40] }]\n",
        2.0,
        34.0,
    ),
];

fn model(spacing: f64) -> String {
    format!("[model]\nspacing_mm = {spacing}\n[fatigue]\nstep_error_percent = 0.05\n")
}

/// A curve of the engine with known constants as a file of readings at least 0.5 mm apart.
fn readings(specimen: &str, spacing: f64, to: f64) -> String {
    let law = format!("paris_c_mm_per_cycle = {C:e}\nparis_m = {M}\n[stop]\ncrack_length_mm = {to}\n");
    let case = Case::from_toml(&format!("{specimen}{REST}{}{law}", model(spacing)), "made", Folder::none(), &[]).unwrap();
    let run = predict(&case, &Silent).unwrap();
    let mut text = "cycles,crack_length_mm\n".to_owned();
    let mut last = f64::NEG_INFINITY;
    let governing = GoverningCrack::of(&case.specimen, &run.curve);
    for row in run.curve.iter().filter(|row| row.tips.iter().all(|tip| tip.growth >= 0.0)) {
        let length = governing.length(row) / MM;
        if length >= last + 0.5 {
            text += &format!("{:.6},{length:.9}\n", row.cycles);
            last = length;
        }
    }
    text
}

fn calibration(specimen: &str, rest: &str, spacing: f64, readings: String) -> CalibrationCase {
    let text = format!("[measured]\nfiles = [\"readings.csv\"]\n{specimen}{rest}{}", model(spacing));
    let folder = Folder::at_hand([("readings.csv".to_owned(), readings.into_bytes())]);
    CalibrationCase::from_text(&text, "plate", folder).unwrap()
}

fn fitted(calibration: &CalibrationCase) -> Fit {
    calibrate(calibration, &Silent).unwrap()
}

#[test]
fn known_constants_are_found_on_drawn_plates() {
    for (name, cracks, spacing, to) in PLATES {
        let specimen = format!("{PLATE}{cracks}");
        let calibration = calibration(&specimen, REST, spacing, readings(&specimen, spacing, to));
        let fit = fitted(&calibration);
        let (runs, rms) = (fit.own_path.as_ref().unwrap().runs, fit.record.rms_life_error());
        println!("{name}: C {:e}, m {}, {runs} runs, rms {rms:e}", fit.paris.c, fit.paris.m);
        assert!((fit.paris.m / M - 1.0).abs() < 0.005, "{name}: m {}", fit.paris.m);
        assert!((fit.paris.rate_at_pivot / (C * fit.paris.pivot.powf(M)) - 1.0).abs() < 0.01, "{name}");
        assert!(rms < 2e-3, "{name}: {rms}");
        let is_wide = fit.paris.delta_k_max > 2.0 * fit.paris.delta_k_min;
        assert_eq!(report(&calibration, &fit, 0.0)["p_source"], if is_wide { "fitted" } else { "not_identified" }, "{name}");
        // Tips of unlike K share the growth by m, and one tip, or twins, do not.
        assert_eq!(runs > 1, name == "unlike cracks", "{name}: {runs} runs");
        // The record makes the same life on the same plate.
        let law = record(&calibration, &fit);
        let stop = format!("[stop]\ncrack_length_mm = {to}\n");
        let case = Case::from_toml(
            &format!("{specimen}{REST}{stop}{}paris_c_mm_per_cycle = 1e-9\nparis_m = 3\n", model(spacing)),
            "life",
            Folder::none(),
            &[],
        );
        let run = predict(&case.unwrap().with_law(law).unwrap(), &Silent).unwrap();
        let measured = fit.record.life_measured();
        assert!((run.life_cycles() / measured - 1.0).abs() < 0.02, "{name}: {} for {measured}", run.life_cycles());
    }
}

/// The same panel as a standard specimen and as a drawing, whose length is that of both halves.
#[test]
fn a_drawn_panel_is_fitted_as_the_standard_one() {
    let standard = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 100.0\nlength_mm = 200.0\nthickness_mm = 2.0\ncrack_length_mm = 10.0\n";
    let half = readings(standard, 2.0, 25.0);
    let whole: String = half
        .lines()
        .enumerate()
        .map(|(i, line)| match line.split_once(',') {
            Some((n, a)) if i > 0 => format!("{n},{}\n", 2.0 * a.parse::<f64>().unwrap()),
            _ => format!("{line}\n"),
        })
        .collect();
    let by_standard = fitted(&calibration(standard, REST, 2.0, half));
    let drawn = format!("{PLATE}{}", PLATES[0].1);
    let by_drawing = fitted(&calibration(&drawn, REST, 2.0, whole));
    let [of_standard, of_drawing] = [&by_standard, &by_drawing].map(|fit| (fit.record.constants.a, fit.record.constants.p));
    // Both read K of the same lattice at other lengths, each to some tenths of a percent.
    assert!((of_drawing.1 / of_standard.1 - 1.0).abs() < 0.003, "{of_standard:?} {of_drawing:?}");
    // The rate at the pivot, where A and p do not trade against each other: by the field, whose K both fits have.
    let pivot = by_standard.paris.pivot * MPA_SQRT_M;
    let rate = |fit: &Fit| {
        let (Constants { a, p }, bonds) = (fit.record.constants, fit.bonds.unwrap());
        let law = FatigueLaw { a, p, horizon: bonds.horizon };
        ParisLaw::of_bonds(&law, bonds.rate_constant, 72.0 * GPA).rate(pivot)
    };
    assert!((rate(&by_drawing) / rate(&by_standard) - 1.0).abs() < 0.005, "{} {}", rate(&by_drawing), rate(&by_standard));
    // C of the standard specimen is that over K of the handbook, which is 1 % off K of the field on this lattice.
    let c = |fit: &Fit| fit.paris.c * by_standard.paris.pivot.powf(fit.paris.m);
    assert!((c(&by_drawing) / c(&by_standard) - 1.0).abs() < 0.05, "{} {}", c(&by_drawing), c(&by_standard));
}

#[test]
fn a_plate_that_ends_before_its_readings_is_no_fit() {
    let specimen = format!(
        "{PLATE}cracks = [{{ from_mm = [-50, 0], to_mm = [-30, 0] }}]\nholes = [{{ x_mm = -15, y_mm = 0, diameter_mm = 10 }}]\n"
    );
    let lengths = [20.0, 24.0, 28.0, 32.0, 40.0];
    let text: String = lengths.iter().enumerate().map(|(i, a)| format!("{},{a}\n", 1000 * i)).collect();
    let calibration = calibration(&specimen, REST, 2.0, format!("cycles,crack_length_mm\n{text}"));
    let error = calibrate(&calibration, &Silent).unwrap_err();
    assert_eq!(error.exit_code(), 3);
    assert!(error.to_string().contains("before 40.000 mm, to which its K is needed"), "{error}");
}
