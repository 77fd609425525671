//! Calibration on plates that no handbook has: K along the crack's own path, and the constants that curves were made with found again.

use crate::support::fits::report;
use perilife_base::input::Folder;
use perilife_base::units::{GPA, MM, MPA_SQRT_M};
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::fit::Fit;
use perilife_calibration::results::record;
use perilife_calibration::search::Constants;
use perilife_growth::case::Case;
use perilife_growth::predict::{GoverningCrack, Silent, predict};
use perilife_laws::FatigueLaw;
use perilife_laws::paris::ParisLaw;

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
    println!("standard {of_standard:?}, drawn {of_drawing:?}");
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
