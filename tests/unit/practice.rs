//! Readings as users brought them, with the laws that are right for them (shared data).

use std::path::PathBuf;

use perilife_base::input::{Document, Folder};
use perilife_base::table::{Decimal, units::LengthUnit};
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::fit::Fit;
use perilife_growth::predict::Silent;
use perilife_measured::{Import, read};

use crate::support::shared::shared;

fn practice(file: &str) -> Option<PathBuf> {
    shared(&format!("field/practice/{file}"))
}

/// The readings of a file fitted by hand calculation on the specimen of another.
fn fitted(readings: &str, specimen: &str) -> Option<perilife_base::error::Result<Fit>> {
    let (readings, specimen) = (practice(readings)?, practice(specimen)?);
    let text = std::fs::read_to_string(specimen).unwrap();
    let name = readings.file_name().unwrap().to_str().unwrap();
    let text = format!("[measured]\nfiles = [\"{name}\"]\n{text}[model]\nmethod = \"handbook\"\n");
    let folder = Folder::from(readings.parent().unwrap());
    let document = Document::parse(&text, "case", folder, &[]).unwrap();
    Some(CalibrationCase::from_document(document).and_then(|case| calibrate(&case, &Silent)))
}

/// Readings, specimen, m, C (0: not known), words of a warning.
const LAWS: [(&str, &str, f64, f64, &str); 6] = [
    ("thousands/plain.csv", "thousands/ct.toml", 3.0, 1e-8, ""),
    ("thousands/german.csv", "thousands/ct.toml", 3.0, 1e-8, ""),
    ("load-steps/step20_force.csv", "load-steps/ct12.toml", 3.0, 1e-8, ""),
    ("load-steps/mts.csv", "load-steps/ct6.toml", 3.2, 0.0, ""),
    ("load-steps/overload.csv", "load-steps/ct10.toml", 3.0, 1e-8, "lines 34 to 40: outliers"),
    ("stalled-start/silent.csv", "load-steps/ct12.toml", 3.0, 1e-8, "lines 2 to 3: outliers"),
];

#[test]
fn laws_of_practice_are_found() {
    for (readings, specimen, m, c, words) in LAWS {
        let Some(fit) = fitted(readings, specimen) else { return };
        let fit = fit.unwrap_or_else(|error| panic!("{readings}: {error}"));
        assert!((fit.paris.m - m).abs() < 0.011, "{readings}: m {}", fit.paris.m);
        assert!(c == 0.0 || (fit.paris.c / c - 1.0).abs() < 0.005, "{readings}: C {:e}", fit.paris.c);
        // The rate in the middle of the test, where C and m do not trade against each other.
        let (pivot, truth) = (fit.paris.pivot, 1e-8 * fit.paris.pivot.powf(m));
        assert!((fit.paris.rate_at_pivot / truth - 1.0).abs() < 0.005, "{readings}: {} at {pivot}", fit.paris.rate_at_pivot);
        assert!(words.is_empty() || fit.warnings.iter().any(|line| line.contains(words)), "{readings}: {:?}", fit.warnings);
    }
}

/// Readings, specimen, words of the warning or the refusal.
const DOUBTS: [(&str, &str, &str); 3] = [
    ("load-steps/shed_plain.csv", "load-steps/ct6.toml", "rate changes"),
    ("load-steps/step20.csv", "load-steps/ct12.toml", "lines 20 to 21: rate changes"),
    ("stalled-start/stalled.csv", "stalled-start/case.toml", "lines 2 to 10: outliers"),
];

#[test]
fn tests_that_no_law_can_hold_say_so() {
    for (readings, specimen, words) in DOUBTS {
        let outcome = match specimen.ends_with("case.toml") {
            true => {
                practice(specimen).map(|case| CalibrationCase::from_file(&case, &[]).and_then(|case| calibrate(&case, &Silent)))
            }
            false => fitted(readings, specimen),
        };
        let said = match outcome {
            None => return,
            Some(Ok(fit)) => fit.warnings.join("\n"),
            Some(Err(error)) => {
                assert_eq!(error.exit_code(), 3, "{readings}");
                error.to_string()
            }
        };
        assert!(said.contains(words), "{readings}: {words} in {said}");
    }
}

#[test]
fn columns_of_practice_are_understood() {
    let mm = Import { length: Some(LengthUnit::Millimetre), ..Import::default() };
    let plain = Import::default();
    // File, what the user says, readings, first cycles, first length in mm.
    let files = [
        ("wide-columns/fb.csv", &mm, 37, 0.0, 12.0),
        ("wide-columns/fbmm.csv", &mm, 37, 0.0, 12.0),
        ("wide-columns/fbw.csv", &mm, 37, 0.0, 12.0),
        ("wide-columns/aP.csv", &mm, 37, 0.0, 12.0),
        ("comma-in-name/tab.txt", &plain, 8, 200.0, 13.7415),
        ("comma-in-name/semi.csv", &plain, 7, 200.0, 13.7415),
        ("comma-in-name/quoted.csv", &plain, 7, 200.0, 13.7415),
        ("own-export/exported.csv", &plain, 40, 0.0, 4.0),
        ("thousands/german.csv", &plain, 37, 5000.0, 12.0),
        ("load-steps/mts.csv", &plain, 72, 0.0, 12.0),
    ];
    for (file, import, count, cycles, length) in files {
        let Some(path) = practice(file) else { return };
        let measured = read(&[path], import).unwrap_or_else(|error| panic!("{file}: {error}"));
        let [curve] = measured.curves.as_slice() else { panic!("{file}: {} specimens", measured.curves.len()) };
        assert_eq!((curve.cycles.len(), curve.cycles[0]), (count, cycles), "{file}");
        assert!((curve.crack_length[0] - length * 1e-3).abs() < 1e-12, "{file}: {}", curve.crack_length[0]);
    }
    let Some(german) = practice("thousands/german.csv") else { return };
    let given = Import { decimal: Some(Decimal::Comma), ..Import::default() };
    assert_eq!(read(&[german], &given).unwrap().curves[0].cycles[1], 58_528.0);
}
