//! Columns of tables: pairs of them, their vocabulary, and readings as users brought them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use perilife_base::input::{Document, Folder};
use perilife_base::table::Decimal;
use perilife_base::table::names::{Column, Kind, Named, Role};
use perilife_base::table::units::LengthUnit;
use perilife_base::units::MM;
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::fit::Fit;
use perilife_growth::predict::Silent;
use perilife_measured::{Import, Measured, parse, read};

use crate::support::rows::{assert_refusal, rows};
use crate::support::shared::shared;

// Tables of pairs of columns, headers of two lines, and text behind the readings.

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

fn read_of_pairs(text: &str, import: &Import) -> perilife_base::error::Result<Measured> {
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
        let measured = read_of_pairs(&text, import).unwrap_or_else(|error| panic!("{text}: {error}"));
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
        assert_refusal(read_of_pairs(&text, &Import::default()), &[words]);
    }
}

#[test]
fn a_header_may_stand_in_two_lines() {
    let rows: String = ONE.iter().map(|(n, a)| format!("{n};{a:.2}\n")).collect();
    for header in ["Number of;Crack\ncycles;length (mm)", "Test 12, 5 Hz\nNumber of;Crack\ncycles;length (mm)"] {
        let measured =
            read_of_pairs(&format!("{header}\n{rows}"), &Import::default()).unwrap_or_else(|error| panic!("{header}: {error}"));
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
        let measured = read_of_pairs(&format!("cycles,crack_length_mm\n{rows}{footer}"), &Import::default());
        let measured = measured.unwrap_or_else(|error| panic!("{footer}: {error}"));
        is_curve(&measured, 0, "lab", &ONE);
        assert!(measured.warnings.iter().any(|line| line.contains(words)), "{:?}", measured.warnings);
    }
    // A bad number among the readings stays an error, and so does one beside a good one in the last row.
    for bad in [rows.replace("35000,", "many,"), format!("{rows}70000,long\n")] {
        assert_refusal(read_of_pairs(&format!("cycles,crack_length_mm\n{bad}"), &Import::default()), &["is not a number"]);
    }
}

// The vocabulary of column names: every form of the data file means its role, and nothing but a whole form does.

/// Forms by kind of table, role and measure.
type Forms = BTreeMap<String, BTreeMap<String, toml::Value>>;

const KINDS: [(&str, Kind); 5] = [
    ("readings", Kind::Readings),
    ("rates", Kind::Rates),
    ("spectrum", Kind::Spectrum),
    ("residual_stress", Kind::ResidualStress),
    ("beta", Kind::Beta),
];

/// `StressY` as `stress_y`.
fn name(role: Role) -> String {
    format!("{role:?}").chars().fold(String::new(), |name, c| match c.is_uppercase() {
        true if !name.is_empty() => name + "_" + &c.to_lowercase().to_string(),
        _ => name + &c.to_lowercase().to_string(),
    })
}

/// What may stand behind a form, its unit, and what is another unit.
fn unit(measure: &str) -> [&'static str; 3] {
    match measure {
        "text" => [" (id)", "", ""],
        "number" => ["", "", ""],
        "length" | "length_said" => [" [mm]", "mm", " (kN)"],
        "cycles" => [" (x1000)", "kilocycles", " (mm)"],
        "kilocycles" => ["", "kilocycles", " (millions)"],
        "megacycles" => ["", "megacycles", " (thousands)"],
        "force" | "force_said" => ["/kN", "kN", " (MPa)"],
        "stress" | "stress_said" => [", ksi", "ksi", " (lbf)"],
        "load" => [" in MPa", "MPa", " (mm)"],
        "intensity" => [" (MPa√m)", "MPa sqrt(m)", " (MPa)"],
        "rate" => [" (in/cycle)", "in/cycle", " (mm)"],
        other => panic!("{other}"),
    }
}

#[test]
fn every_form_means_its_role_and_no_part_of_one_does() {
    let data: Forms = toml::from_str(include_str!("../../data/columns.toml")).unwrap();
    let mut count = 0;
    for (part, kind) in KINDS {
        let mut seen: Vec<String> = Vec::new();
        for (role, measures) in &data[part] {
            for (measure, forms) in measures.as_table().unwrap().iter().filter(|(measure, _)| !measure.ends_with("words")) {
                let [behind, in_unit, other] = unit(measure);
                for form in forms.as_str().unwrap().split(',').map(str::trim) {
                    let said = Column::named(kind, 3, &format!("{form}{behind}"));
                    assert_eq!((name(said.role), said.index), (role.clone(), 3), "{part}: {form}{behind}");
                    let own = if let Named::Is(unit) = said.unit { unit.name() } else { "" };
                    assert_eq!(own, in_unit, "{part}: {form}{behind}");
                    // In capitals, too; without a unit where none is wanted.
                    let bare = Column::named(kind, 0, &form.to_uppercase()).role;
                    let is_bare = !measure.ends_with("said") && form != "a";
                    assert_eq!(name(bare) == *role, is_bare, "{part}: {form}: {bare:?}");
                    let strange = Column::named(kind, 0, &format!("{form}{other}"));
                    let is_strange = strange.unit == Named::Strange && name(strange.role) == *role;
                    assert!(other.is_empty() || is_strange || measure.ends_with("said"), "{part}: {form}{other}: {strange:?}");
                    for longer in [format!("{form} xyz"), format!("xyz {form}")] {
                        let role = Column::named(kind, 0, &longer).role;
                        assert!(matches!(role, Role::Unknown | Role::Unclear | Role::Other), "{part}: {longer}: {role:?}");
                    }
                    assert!(
                        !seen.contains(&form.to_owned()) || measure.ends_with("said") || role == "unclear",
                        "{part}: {form} twice"
                    );
                    seen.push(form.to_owned());
                    count += 1;
                }
            }
        }
    }
    assert!(count > 800, "{count}");
}

#[test]
fn lengths_tip_to_tip_logarithms_and_long_names_are_told_apart() {
    let named = |name: &str| Column::named(Kind::Readings, 0, name);
    for (whole, role) in [("2a (mm)", Role::Length), ("Crack length 2a [mm]", Role::Length), ("2a left (mm)", Role::Side)] {
        assert!(named(whole).role == role && named(whole).is_tip_to_tip() && !named(&whole.replace("2a", "a")).is_tip_to_tip());
    }
    assert!(named("log10 da/dN (mm/cycle)").is_log && !named("da/dN (mm/cycle)").is_log);
    assert_eq!(named("log a (mm)").role, Role::Unknown);
    // A bare capital letter is a specimen, a cell of a remark is no name.
    assert_eq!([named("A").role, named("A (mm)").role], [Role::Unknown, Role::Length]);
    assert_eq!(named(&format!("cycles{}", " ".repeat(200))).role, Role::Unknown);
}

// Readings as users brought them, with the laws that are right for them (shared data).

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

#[test]
fn laws_of_practice_are_found() {
    for (readings, specimen, m, c, words) in rows::<Vec<(String, String, f64, f64, String)>>("pairs", "laws") {
        let Some(fit) = fitted(&readings, &specimen) else { return };
        let fit = fit.unwrap_or_else(|error| panic!("{readings}: {error}"));
        assert!((fit.paris.m - m).abs() < 0.011, "{readings}: m {}", fit.paris.m);
        assert!(c == 0.0 || (fit.paris.c / c - 1.0).abs() < 0.005, "{readings}: C {:e}", fit.paris.c);
        // The rate in the middle of the test, where C and m do not trade against each other.
        let (pivot, truth) = (fit.paris.pivot, 1e-8 * fit.paris.pivot.powf(m));
        assert!((fit.paris.rate_at_pivot / truth - 1.0).abs() < 0.005, "{readings}: {} at {pivot}", fit.paris.rate_at_pivot);
        assert!(words.is_empty() || fit.warnings.iter().any(|line| line.contains(&words)), "{readings}: {:?}", fit.warnings);
    }
}

#[test]
fn tests_that_no_law_can_hold_say_so() {
    for [readings, specimen, words] in rows::<Vec<[String; 3]>>("pairs", "doubts") {
        let outcome = match specimen.ends_with("case.toml") {
            true => {
                practice(&specimen).map(|case| CalibrationCase::from_file(&case, &[]).and_then(|case| calibrate(&case, &Silent)))
            }
            false => fitted(&readings, &specimen),
        };
        let said = match outcome {
            None => return,
            Some(Ok(fit)) => fit.warnings.join("\n"),
            Some(Err(error)) => {
                assert_eq!(error.exit_code(), 3, "{readings}");
                error.to_string()
            }
        };
        assert!(said.contains(&words), "{readings}: {words} in {said}");
    }
}

#[test]
fn columns_of_practice_are_understood() {
    let mm = Import { length: Some(LengthUnit::Millimetre), ..Import::default() };
    let plain = Import::default();
    for (file, is_in_mm, count, cycles, length) in rows::<Vec<(String, bool, usize, f64, f64)>>("pairs", "files") {
        let Some(path) = practice(&file) else { return };
        let measured = read(&[path], if is_in_mm { &mm } else { &plain }).unwrap_or_else(|error| panic!("{file}: {error}"));
        let [curve] = measured.curves.as_slice() else { panic!("{file}: {} specimens", measured.curves.len()) };
        assert_eq!((curve.cycles.len(), curve.cycles[0]), (count, cycles), "{file}");
        assert!((curve.crack_length[0] - length * 1e-3).abs() < 1e-12, "{file}: {}", curve.crack_length[0]);
    }
    let Some(german) = practice("thousands/german.csv") else { return };
    let given = Import { decimal: Some(Decimal::Comma), ..Import::default() };
    assert_eq!(read(&[german], &given).unwrap().curves[0].cycles[1], 58_528.0);
}
