//! Calibration finds what it was given, and says where p comes from.

use std::fs;
use std::path::Path;

use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::criterion::Criterion;
use perilife_calibration::results::record;
use perilife_growth::case::record::FittedRecord;
use perilife_growth::case::{Case, fitted_record};
use perilife_growth::predict::{Silent, predict};
use perilife_measured::MeasuredCurve;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use super::misfit::{exact_curve, fit_by, fit_to, paris_model};
use crate::support::fatigue_test::distance_squared;
use crate::support::fits::report;
use crate::support::hand_cases::{PANEL, hand_run};
use crate::support::noise::Noise;

// Calibration finds what it was given: noisy curves of a known law, and whether the stated confidence is honest.

/// Truth: m/cycle and MPa√m.
const A: f64 = 8.95e-11;
const P: f64 = 2.87;
/// 95 % quantile of χ² with two degrees of freedom.
const ELLIPSE_95: f64 = 5.991;

/// The exact curve with relative noise of 5 % on the cycles between readings.
fn noisy(seed: u64) -> MeasuredCurve {
    let (mut curve, mut noise) = (exact_curve("noisy", A, P), Noise::new(seed));
    let exact = curve.cycles.clone();
    for i in 1..exact.len() {
        curve.cycles[i] = curve.cycles[i - 1] + (exact[i] - exact[i - 1]) * (1.0 + 0.05 * noise.normal());
    }
    curve
}

/// Fits to `seeds` noisy curves: (p, squared distance of the truth) of each.
fn noisy_fits(criterion: Criterion, seeds: u64) -> Vec<(f64, f64)> {
    let one = |seed: u64| {
        let fit = fit_by(criterion, &[noisy(seed)], None, &paris_model()).unwrap();
        let found = fit.record.constants;
        (found.p, distance_squared(fit.confidence.covariance, [(A / found.a).ln(), P - found.p]))
    };
    (1..=seeds).map(one).collect()
}

/// An ellipse so wide that it always holds the truth would be no better: over many seeds about one in twenty lies outside.
#[test]
fn the_ellipse_is_not_too_wide_and_p_not_biased() {
    let scatters: Vec<f64> = Criterion::ALL
        .iter()
        .map(|&criterion| {
            let fits = noisy_fits(criterion, 400);
            let count = fits.len() as f64;
            let inside = fits.iter().filter(|(_, distance)| *distance < ELLIPSE_95).count() as f64 / count;
            let mean_p = fits.iter().map(|(p, _)| p).sum::<f64>() / count;
            let scatter = (fits.iter().map(|(p, _)| (p - mean_p).powi(2)).sum::<f64>() / count).sqrt();
            assert!((0.90..=0.99).contains(&inside), "{criterion}: {inside}");
            assert!((mean_p / P - 1.0).abs() < 0.01, "{criterion}: mean p = {mean_p}");
            scatter
        })
        .collect();
    // Why the default is what it is: lives from both ends tell p a fifth better.
    assert!(scatters[0] < 0.85 * scatters[1], "{scatters:?}");
}

#[test]
fn the_pivot_is_where_the_rate_is_known_best() {
    let curve = noisy(7);
    let fit = fit_to(&[curve], None, &paris_model()).unwrap();
    let rate = 1e3 * A * fit.paris.pivot.powf(P);
    assert!((fit.paris.delta_k_min..fit.paris.delta_k_max).contains(&fit.paris.pivot), "pivot {}", fit.paris.pivot);
    assert!(fit.paris.rate_at_pivot_error < 0.02, "{}", fit.paris.rate_at_pivot_error);
    assert!((fit.paris.rate_at_pivot / rate - 1.0).abs() < 4.0 * fit.paris.rate_at_pivot_error);
    // Away from the pivot the same law is known less well: the error of A itself (ΔK = 1) is many times larger.
    assert!(fit.confidence.covariance[0][0].sqrt() > 5.0 * fit.paris.rate_at_pivot_error);
}

/// A reading 0.025 mm after another near the end of the life, half a step of cycles later, as a laboratory that reads too often has:
/// counted as an increment of its own it multiplied the error of m of a measured curve by 4.6 (hand calculation).
#[test]
fn one_odd_reading_does_not_make_the_error() {
    let curve = noisy(3);
    let mut odd = curve.clone();
    let at = curve.cycles.len() - 6;
    odd.crack_length.insert(at + 1, curve.crack_length[at] + 0.025e-3);
    odd.cycles.insert(at + 1, 0.5 * (curve.cycles[at] + curve.cycles[at + 1]));
    for criterion in Criterion::ALL.iter().copied() {
        let [plain, with_odd] =
            [curve.clone(), odd.clone()].map(|curve| fit_by(criterion, &[curve], None, &paris_model()).unwrap());
        let ratio = with_odd.p_error() / plain.p_error();
        assert!((0.7..1.4).contains(&ratio), "{criterion}: {ratio}");
        for (fit, is_told) in [(&with_odd, true), (&plain, false)] {
            let told = fit.warnings.iter().any(|text| text.starts_with("readings: 1 of ") && text.contains("0.25 mm"));
            assert_eq!(told, is_told, "{:?}", fit.warnings);
        }
    }
}

// Where p of a calibration comes from, and calibrations by hand calculation.

/// A calibration on exact readings of the panel with C = 8.95422e-8 and m = 2.874, every 2 mm between two lengths.
fn calibration(folder: &TempDir, window_mm: [usize; 2], fit: &str) -> perilife_base::error::Result<CalibrationCase> {
    let mut readings = "cycles,crack_length_mm\n0,9\n".to_owned();
    for length in (11..=49).step_by(2) {
        let run = hand_run(PANEL, &[&format!("stop.crack_length_mm={length}")]);
        readings += &format!("{},{length}\n", run.life_cycles());
    }
    fs::write(folder.path().join("readings.csv"), readings).unwrap();
    let text = format!(
        "[measured]\nfiles = [\"readings.csv\"]\nfrom_crack_length_mm = {}\nto_crack_length_mm = {}\n[specimen]\n{PANEL}\
         [material]\nname = \"al2024-t3\"\n[loading]\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n\
         [model]\nmethod = \"handbook\"\n[fit]\n{fit}\n",
        window_mm[0], window_mm[1]
    );
    let path = folder.path().join("panel.toml");
    fs::write(&path, text).unwrap();
    CalibrationCase::from_file(&path, &[])
}

const WIDE: [usize; 2] = [9, 49];
/// ΔK from 12.8 to 17.2 MPa√m.
const NARROW: [usize; 2] = [21, 33];

#[test]
fn hand_calculation_finds_its_own_constants_and_predicts_with_them() {
    let folder = tempdir().unwrap();
    let wide = calibration(&folder, WIDE, "").unwrap();
    let fit = calibrate(&wide, &Silent).unwrap();
    assert!((fit.paris.m / 2.874 - 1.0).abs() < 1e-3, "{:?}", fit.paris);
    assert!((fit.paris.c / 8.95422e-8 - 1.0).abs() < 5e-3, "{:?}", fit.paris);
    let report = report(&wide, &fit, 0.0);
    assert_eq!(report["p_source"], "fitted");
    let (m_error, rms) = (fit.paris.m_error, fit.record.rms_life_error());
    assert!(m_error < 0.02 && rms < 1e-4, "{m_error} {rms}");
    assert_eq!((&report["paris_m_error"], &report["rms_life_error"]), (&json!(m_error), &json!(rms)));
    assert!(report["a"].is_null(), "hand calculation has no A of bonds");
    // Its record reads back and gives the life of the readings.
    let law = record(&wide, &fit);
    fs::write(folder.path().join("fitted.toml"), toml::to_string(&law).unwrap()).unwrap();
    let back: FittedRecord = fitted_record("fitted.toml", &folder.path().into()).unwrap();
    assert_eq!((back.method.as_str(), back.paris_m, back.paris_m_error), ("handbook", law.paris_m, law.paris_m_error));
    let text = format!(
        "[specimen]\n{PANEL}[material]\nname = \"al2024-t3\"\n[loading]\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n\
         [model]\nmethod = \"handbook\"\n[fatigue]\nfitted = \"fitted.toml\"\n[stop]\ncrack_length_mm = 49.8\n"
    );
    let case = Case::from_toml(&text, "again", folder.path(), &[]).unwrap();
    assert!((predict(&case, &Silent).unwrap().life_cycles() / 247_247.0 - 1.0).abs() < 1e-3);
}

#[test]
fn a_narrow_window_takes_p_from_a_record_or_says_that_it_is_not_identified() {
    let folder = tempdir().unwrap();
    let wide = calibration(&folder, WIDE, "").unwrap();
    let law = FittedRecord { paris_m_error: 0.04, ..record(&wide, &calibrate(&wide, &Silent).unwrap()) };
    fs::write(folder.path().join("fitted.toml"), toml::to_string(&law).unwrap()).unwrap();
    let report = |window, keys: &str| {
        let calibration = calibration(&folder, window, keys).unwrap();
        report(&calibration, &calibrate(&calibration, &Silent).unwrap(), 0.0)
    };
    let warns = |report: &Value, words: &[&str]| {
        let lines = report["warnings"].as_array().unwrap();
        let has_all = |line: &Value| words.iter().all(|word| line.as_str().unwrap().contains(word));
        assert!(lines.iter().any(has_all), "{words:?} in {lines:?}");
    };

    let free = report(NARROW, "");
    assert_eq!(free["p_source"], "not_identified");
    warns(&free, &["m cannot be determined", "record"]);

    let taken = report(NARROW, "record = \"fitted.toml\"");
    assert_eq!([&taken["p"], &taken["p_error"], &taken["paris_m_error"]], [&json!(law.paris_m), &json!(0.04), &json!(0.04)]);
    assert_eq!(taken["p_source"], "fitted.toml");
    warns(&taken, &["taken from fitted.toml"]);
    // C follows from the narrow window and the p of the wide one.
    assert!((taken["paris_c_mm_per_cycle"].as_f64().unwrap() / 8.95422e-8 - 1.0).abs() < 5e-3);

    // A window that tells p needs no record; [\"a\"] alone takes it all the same.
    let wide = report(WIDE, "record = \"fitted.toml\"");
    assert_eq!(wide["p_source"], "fitted");
    warns(&wide, &["fitted.toml not used"]);
    assert_eq!(report(WIDE, "parameters = [\"a\"]\nrecord = \"fitted.toml\"")["p_source"], "fitted.toml");
    assert_eq!(report(NARROW, "parameters = [\"a\"]\np = 3")["p_source"], "given");
    let twice = calibration(&folder, NARROW, "parameters = [\"a\"]\np = 3\nrecord = \"fitted.toml\"").unwrap_err().to_string();
    assert!(twice.contains("fit.p = 3") && twice.contains("conflicts with record"), "{twice}");
    let nowhere = calibration(&folder, NARROW, "record = \"nowhere.toml\"").unwrap_err();
    assert_eq!(nowhere.exit_code(), 4);
}

#[test]
fn bonds_take_p_and_hand_calculation_m_of_a_record() {
    use perilife_calibration::exponent::Exponent;
    use perilife_growth::case::Method;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/al2024-t3");
    let law = fitted_record("fitted.toml", &path.as_path().into()).unwrap();
    let of = |method| Exponent::of_record("fitted.toml", &path.as_path().into(), method).unwrap().fixed;
    assert_eq!((of(Method::Peridynamics), of(Method::Handbook)), (Some(law.p), Some(law.paris_m)));
    assert_ne!(law.p, law.paris_m);
}
