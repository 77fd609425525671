//! Tables of pairs of columns, headers of two lines, and text behind the readings.

use std::path::Path;

use perilife_base::table::units::LengthUnit;
use perilife_base::units::MM;
use perilife_measured::{Import, Measured, parse};

/// Cycles and lengths in mm of two specimens of unlike tests.
const ONE: [(f64, f64); 6] =
    [(0.0, 9.0), (20_000.0, 10.2), (35_000.0, 11.9), (47_000.0, 13.8), (56_000.0, 16.1), (62_000.0, 18.4)];
const TWO: [(f64, f64); 5] = [(0.0, 9.5), (15_000.0, 10.4), (31_000.0, 12.5), (40_000.0, 14.2), (52_000.0, 17.9)];

/// Two pairs of columns below a header, the shorter test with empty cells at its end.
fn paired(header: &str, separator: &str, decimal: &str) -> String {
    let number = |value: f64, digits: usize| format!("{value:.digits$}").replace('.', decimal);
    let cells = |row: Option<&(f64, f64)>| row.map_or([String::new(), String::new()], |(n, a)| [number(*n, 0), number(*a, 2)]);
    let row = |i: usize| [cells(ONE.get(i)), cells(TWO.get(i))].concat().join(separator) + "\n";
    format!("{header}\n{}", (0..ONE.len()).map(row).collect::<String>())
}

fn read(text: &str, import: &Import) -> perilife_base::error::Result<Measured> {
    parse(text.as_bytes(), Path::new("lab.txt"), import)
}

fn is_curve(measured: &Measured, place: usize, name: &str, truth: &[(f64, f64)]) {
    let curve = &measured.curves[place];
    assert_eq!((curve.specimen.as_str(), curve.cycles.len()), (name, truth.len()), "{curve:?}");
    for (i, (n, a)) in truth.iter().enumerate() {
        assert_eq!(curve.cycles[i], *n, "{curve:?}");
        assert!((curve.crack_length[i] / (a * MM) - 1.0).abs() < 1e-9, "{curve:?}");
    }
}

#[test]
fn every_specimen_may_have_two_columns() {
    let mm = Import { length: Some(LengthUnit::Millimetre), ..Import::default() };
    let dresses = [
        (paired("N1,a1,N2,a2", ",", "."), &mm, ["1", "2"]),
        (paired("N1,a1 (mm),N2,a2 (mm)", ",", "."), &Import::default(), ["1", "2"]),
        (paired("Cycles 7;Crack length 7 [mm];Cycles 9;Crack length 9 [mm]", ";", ","), &Import::default(), ["7", "9"]),
        (paired("N\ta (mm)\tN\ta (mm)", "\t", "."), &Import::default(), ["1", "2"]),
        (paired("cycles_1,crack_length_mm_1,cycles_2,crack_length_mm_2", ",", "."), &Import::default(), ["1", "2"]),
    ];
    for (text, import, names) in dresses {
        let measured = read(&text, import).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!(measured.curves.len(), 2, "{text}");
        is_curve(&measured, 0, names[0], &ONE);
        is_curve(&measured, 1, names[1], &TWO);
    }
}

#[test]
fn pairs_that_are_none_are_refused() {
    let header = |header: &str| paired(header, ",", ".");
    let cases = [
        // Another number within a pair, or one number twice: nobody can say what belongs together.
        (header("N1,a2,N2,a1"), "lab.txt:1"),
        (header("N1,a1,N1,a1"), "lab.txt:1"),
        (header("N1,a1,N2,a2"), "has no unit"),
        // Half a reading.
        (header("N1,a1 (mm),N2,a2 (mm)").replace("47000,13.80", "47000,"), "lab.txt:5: a1 (mm) = \"\": is empty"),
        (header("N1,a1 (mm),N2,a2 (mm)").replace("40000,14.20", "4000,14.20"), "is below the previous reading (31000)"),
    ];
    for (text, words) in cases {
        let error = read(&text, &Import::default()).unwrap_err();
        assert!(error.to_string().contains(words), "{words} in {error}");
    }
}

#[test]
fn a_header_may_stand_in_two_lines() {
    let rows: String = ONE.iter().map(|(n, a)| format!("{n};{a:.2}\n")).collect();
    for header in ["Number of;Crack\ncycles;length (mm)", "Test 12, 5 Hz\nNumber of;Crack\ncycles;length (mm)"] {
        let measured = read(&format!("{header}\n{rows}"), &Import::default()).unwrap_or_else(|error| panic!("{header}: {error}"));
        is_curve(&measured, 0, "lab", &ONE);
    }
}

#[test]
fn text_behind_the_readings_is_told_and_not_read() {
    let rows: String = ONE.iter().map(|(n, a)| format!("{n},{a:.2}\n")).collect();
    for (footer, words) in [
        ("Test stopped, specimen broken\n", "line 8: text after the readings ignored"),
        ("\nEnd of data\nOperator: K., checked: M.\n", "lines 9 to 10: text after the readings ignored"),
    ] {
        let measured = read(&format!("cycles,crack_length_mm\n{rows}{footer}"), &Import::default());
        let measured = measured.unwrap_or_else(|error| panic!("{footer}: {error}"));
        is_curve(&measured, 0, "lab", &ONE);
        assert!(measured.warnings.iter().any(|line| line.contains(words)), "{:?}", measured.warnings);
    }
    // A bad number among the readings stays an error, and so does one beside a good one in the last row.
    for bad in [rows.replace("35000,", "many,"), format!("{rows}70000,long\n")] {
        let error = read(&format!("cycles,crack_length_mm\n{bad}"), &Import::default()).unwrap_err();
        assert!(error.to_string().contains("is not a number"), "{error}");
    }
}
