//! The calibration of the engine on the median panel of Virkler et al. (1979).

use std::path::Path;

use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::fit::Fit;
use perilife_growth::predict::Silent;
use perilife_measured::MeasuredCurve;

pub fn calibration(set: &[String]) -> CalibrationCase {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/al2024-t3/case.toml");
    CalibrationCase::from_file(&file, set).unwrap()
}

pub fn fit_to(calibration: &CalibrationCase, curves: &[MeasuredCurve]) -> Fit {
    let mut calibration = calibration.clone();
    calibration.curves = curves.to_vec();
    calibrate(&calibration, &Silent).unwrap()
}

#[test]
fn the_median_panel_is_fitted_within_two_percent_of_life() {
    let calibration = calibration(&[]);
    let found = fit_to(&calibration, &calibration.curves);
    let life = found.record.life_fitted() / found.record.life_measured();
    println!(
        "p {:.4} ± {:.4}, rms {:.4}, life {life:.4}, m {:.4}",
        found.record.constants.p,
        found.p_error(),
        found.record.rms_life_error(),
        found.paris.m
    );
    assert!(found.record.rms_life_error() <= 0.02);
    assert!((life - 1.0).abs() <= 0.025);
    assert!((2.7..=3.3).contains(&found.paris.m));
    // The error of p by hand calculation on the same curve is about 0.1.
    assert!(found.p_error() < 0.2, "p ± {}", found.p_error());
}

/// Without a method, and without a key of points, the panel is fitted to the K of its handbook; A and p are those of bonds by β.
#[test]
fn what_the_program_chooses_gives_the_constants_of_bonds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/al2024-t3");
    let text = std::fs::read_to_string(folder.join("case.toml")).unwrap();
    let left_open = text.replace("spacing_mm = 1.0", "");
    assert_ne!(left_open, text);
    let chosen = CalibrationCase::from_text(&left_open, "median", folder.as_path()).unwrap();
    assert!(chosen.case.chosen.as_ref().is_some_and(|why| why.contains("Feddersen")), "{:?}", chosen.case.chosen);
    let on_points = calibration(&[]);
    let [chosen, on_points] = [&chosen, &on_points].map(|case| fit_to(case, &case.curves));
    let [a, b] = [&chosen, &on_points].map(|fit| fit.record.constants);
    println!("A {:.4e} for {:.4e}, p {:.4} for {:.4}", a.a, b.a, a.p, b.p);
    // The spacing that the program takes is the one of the file, so that both A belong to one horizon. K of the two differs by up to 0.5 %.
    assert!((chosen.bonds.unwrap().horizon / on_points.bonds.unwrap().horizon - 1.0).abs() < 1e-9);
    assert!((a.a / b.a - 1.0).abs() < 0.02 && (a.p - b.p).abs() < 0.01, "{a:?} {b:?}");
}
