//! Loads of every reading, readings that do not belong, and what a fit says of both: made tests whose law is known.

use std::collections::BTreeMap;

use crate::support::fits::report;
use perilife_base::input::Folder;
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::fit::Fit;
use perilife_calibration::lack_of_fit::Misfit;
use perilife_calibration::results::record;
use perilife_growth::predict::Silent;

use crate::support::fatigue_test::{calibration, lengths, readings};
use crate::support::rows::{assert_says, rows};

const C: f64 = 1e-8;
const M: f64 = 3.0;

/// A test that grows by C and m under 5.4 kN.
fn plain(step: f64) -> Vec<(f64, f64)> {
    readings(C, M, &lengths(12.0, 30.0, step), |_| 5.4, |_| 1.0)
}

fn lines_of(readings: &[(f64, f64)], more: impl Fn(usize) -> String) -> String {
    readings.iter().enumerate().map(|(i, (n, a))| format!("{n},{a:.4}{}\n", more(i))).collect()
}

fn csv_of(readings: &[(f64, f64)]) -> String {
    format!("cycles,crack_length_mm\n{}", lines_of(readings, |_| String::new()))
}

fn case(csv: &str, keys: &str) -> perilife_base::error::Result<CalibrationCase> {
    let files = BTreeMap::from([("test.csv".to_owned(), csv.as_bytes().to_vec())]);
    CalibrationCase::from_text(&calibration("test.csv", keys), "case", Folder::at_hand(files))
}

fn fitted(csv: &str, keys: &str) -> Fit {
    calibrate(&case(csv, keys).unwrap(), &Silent).unwrap()
}

fn is_the_law(name: &str, fit: &Fit, m: f64) {
    assert!((fit.paris.m - m).abs() < 0.003, "{name}: m {}", fit.paris.m);
    assert!((fit.paris.c / C - 1.0).abs() < 0.005, "{name}: C {:e}", fit.paris.c);
}

#[test]
fn k_of_every_reading_is_that_of_its_own_load() {
    let lengths = lengths(12.0, 30.0, 0.5);
    let step = |a: f64| if a > 21.0 { 6.48 } else { 5.4 };
    let two_steps = |a: f64| [5.4, 6.3, 4.5][usize::from(a > 17.0) + usize::from(a > 24.0)];
    let shed = |a: f64| 5.4 * (-0.06 * (a - 12.0)).exp();
    let force: [(&str, &dyn Fn(f64) -> f64); 4] =
        [("constant", &|_| 6.0), ("a step", &step), ("two steps", &two_steps), ("shed", &shed)];
    for (name, force) in force {
        let made = readings(C, M, &lengths, force, |_| 1.0);
        let with = |unit: &str, per_kn: f64| {
            let load =
                |i: usize| format!(",{:.9},{:.9}", force(lengths[i]) / 0.9 * per_kn, force(lengths[i]) / 0.9 * 0.1 * per_kn);
            format!("cycles,crack_length_mm,force max ({unit}),force min ({unit})\n{}", lines_of(&made, load))
        };
        let ranges =
            format!("cycles,crack_length_mm,force_range_kn\n{}", lines_of(&made, |i| format!(",{:.9}", force(lengths[i]))));
        is_the_law(&format!("{name}, ranges"), &fitted(&ranges, ""), M);
        // Units do not know how the load changes.
        let units = [("kN", 1.0), ("N", 1e3), ("lbf", 1e3 / 4.448_221_615_260_5), ("kgf", 1e3 / 9.806_65)];
        for (unit, per_kn) in units.into_iter().take(if name == "two steps" { 4 } else { 1 }) {
            let fit = fitted(&with(unit, per_kn), "");
            is_the_law(&format!("{name}, {unit}"), &fit, M);
            assert!(!fit.warnings.iter().any(|line| line.contains("rate changes")), "{name}: {:?}", fit.warnings);
        }
    }
}

#[test]
fn specimens_of_different_loads_have_one_law() {
    let lengths = lengths(12.0, 30.0, 0.5);
    let of = |name: &str, force: f64| {
        let made = readings(C, M, &lengths, |_| force, |_| 1.0);
        made.iter().map(|(n, a)| format!("{name},{n},{a:.4},{:.9}\n", force / 0.9)).collect::<String>()
    };
    let csv = format!("specimen,cycles,crack_length_mm,force_max_kn\n{}{}{}", of("A", 5.4), of("B", 4.2), of("C", 6.6));
    is_the_law("three loads", &fitted(&csv, ""), M);
    // Without loads the median mixes them.
    let bare: String = csv.lines().map(|line| line.rsplit_once(',').unwrap().0.to_owned() + "\n").collect();
    assert!((fitted(&bare, "").specimens[1].constants.a / C * 1e3 - 1.0).abs() > 0.3);
}

#[test]
fn loads_without_columns_are_told_by_the_rates() {
    let made = readings(C, M, &lengths(12.0, 30.0, 0.5), |a| if a > 21.0 { 6.48 } else { 5.4 }, |_| 1.0);
    let fit = fitted(&csv_of(&made), "");
    let warning = fit.warnings.iter().find(|line| line.contains("rate changes in specimen")).unwrap();
    // 21 mm is the 19th reading, on line 20; a fifth more force is 1.728 times the rate.
    assert_says(warning, &["test.csv: lines 20 to 21: ", "above 21 mm it is 1.73 times", "force_max_kn"]);
    let clean = fitted(&csv_of(&plain(0.5)), "");
    assert!(clean.warnings.is_empty(), "{:?}", clean.warnings);
}

/// Name, slowing of growth, lines named.
type Stall = (&'static str, fn(f64) -> f64, &'static str);

const STALLS: [Stall; 3] = [
    ("a stalled start", |a| if a < 12.5 { 4.0 } else { 1.0 }, "lines 2 to 3: "),
    ("an overload", |a| if (20.0..21.0).contains(&a) { 12.0 } else { 1.0 }, "lines 18 to 20: "),
    ("a counter that jumped", |a| if (15.0..15.5).contains(&a) { 0.1 } else { 1.0 }, "lines 8 to 9: "),
];

#[test]
fn readings_that_do_not_belong_are_named_and_left_out() {
    for (name, slow, lines) in STALLS {
        let made = readings(C, M, &lengths(12.0, 30.0, 0.5), |_| 5.4, slow);
        let csv = csv_of(&made);
        let fit = fitted(&csv, "");
        let warning = fit.warnings.iter().find(|line| line.contains("outliers")).unwrap_or_else(|| panic!("{name}"));
        assert!(warning.contains(lines), "{name}: {lines} in {warning}");
        is_the_law(name, &fit, M);
        assert_eq!(fit.specimens, std::slice::from_ref(&fit.record), "{name}: one specimen, one law");
        // What is left out stands in the record and beside the readings.
        let case = case(&csv, "").unwrap();
        let record = record(&case, &fit);
        let table = perilife_calibration::readings::readings(&case, &record.left_out, &|_| f64::NAN).csv();
        assert!(record.left_out.len() == 1 && record.left_out[0].reason.starts_with("by the program: "), "{:?}", record.left_out);
        let marked = |line: &str| line.ends_with("times the rate of the other readings");
        let first = table.lines().position(marked).unwrap_or_else(|| panic!("{name}: {table}"));
        let [from, to] = [fit.left_out[0].from_cycles, fit.left_out[0].to_cycles].map(Option::unwrap);
        let inside = made.windows(2).filter(|pair| pair[0].0 < to - 0.1 && pair[1].0 > from + 0.1).count();
        let with_first = usize::from(first == 1);
        assert_eq!(table.lines().filter(|line| marked(line)).count(), inside + with_first, "{name}: {table}");
        // The window of the message, as it stands there, leaves them out.
        let window = warning.split_once("leave_out = ").unwrap().1.replace("\"...\"", "\"seen\"");
        let out = fitted(&csv, &format!("leave_out = {window}"));
        is_the_law(name, &out, M);
        assert!(out.warnings.is_empty(), "{name}: {:?}", out.warnings);
    }
}

#[test]
fn what_is_left_out_stands_in_every_result() {
    let made = readings(C, M, &lengths(12.0, 30.0, 0.5), |_| 5.4, STALLS[1].1);
    let csv = csv_of(&made);
    let (from, to) = (made[16].0, made[18].0);
    let keys = format!("leave_out = [{{ specimen = \"test\", from_cycles = {from}, to_cycles = {to}, reason = \"overload\" }}]");
    let case = case(&csv, &keys).unwrap();
    let fit = calibrate(&case, &Silent).unwrap();
    let report = report(&case, &fit, 0.0);
    assert_eq!(report["left_out"][0]["reason"], "overload", "{report}");
    let text = toml::to_string(&record(&case, &fit)).unwrap();
    assert!(text.contains("[[left_out]]") && text.contains("reason = \"overload\""), "{text}");
    // The cycles of the window are no life.
    let lost = made[18].0 - made[16].0;
    assert!((fit.record.life_measured() - (made[36].0 - lost)).abs() < 1e-6, "{}", fit.record.life_measured());
}

/// A lab file with a word for a number, a counter that fell and a remark between its rows, as it was dropped: its hash, and all three by line.
#[test]
fn rows_are_left_out_by_line_value_and_reason() {
    let good = plain(0.5);
    let text = lines_of(&good, |_| String::new());
    let mut lines: Vec<&str> = std::iter::once("cycles,crack_length_mm").chain(text.lines()).collect();
    for (line, bad) in
        [(5, "abc,13.1"), (9, "12,15.1"), (12, "load cell was changed here; then the test went on, as agreed with the customer")]
    {
        lines.insert(line - 1, bad);
    }
    let csv = lines.join("\n");
    assert!(case(&csv, "").is_err());
    let out = "leave_out = [{ line = 5, value = \"abc\", reason = \"typing error\" }, { line = 9, value = \"12\", reason = \"counter\" }, \
               { line = 12, value = \"load cell was changed...\", reason = \"remark\" }]";
    let bad = case(&csv, out).unwrap();
    let (fit, plain) = (calibrate(&bad, &Silent).unwrap(), calibrate(&case(&csv_of(&good), "").unwrap(), &Silent).unwrap());
    assert_eq!((fit.paris.m, fit.record.life_measured()), (plain.paris.m, plain.record.life_measured()));
    assert_eq!(report(&bad, &fit, 0.0)["left_out"][0]["value"], "abc");
    assert_eq!(bad.sources[0].sha256, perilife_base::input::sha256(csv.as_bytes()));
    let table = perilife_calibration::readings::readings(&bad, &bad.left_out, &|_| f64::NAN).csv();
    assert!(table.contains(",line 5: abc,typing error\n"), "{table}");
    let record = toml::to_string(&record(&bad, &fit)).unwrap();
    assert!(record.contains("line = 5\nvalue = \"abc\"\nreason = \"typing error\""), "{record}");
    assert!(!record.contains("from_cycles"), "{record}");
}

#[test]
fn broken_windows_are_refused() {
    let csv = csv_of(&plain(0.5));
    for [keys, words] in rows::<Vec<[String; 2]>>("belonging", "windows") {
        let error = case(&csv, &format!("leave_out = [{{ {keys} }}]")).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{keys}");
        assert_says(&format!("{keys}: {error}"), &["measured.leave_out", &words]);
    }
}

/// With m = 3 given for a metal of 3.5, the rates lie below the law where ΔK is small and above it where it is large.
#[test]
fn misfit_is_told_at_both_ends() {
    let fit = |m: f64| {
        let made = readings(C * 10_f64.powf(M - m), m, &lengths(12.0, 30.0, 0.5), |_| 5.4, |_| 1.0);
        let csv = csv_of(&made);
        let files = BTreeMap::from([("test.csv".to_owned(), csv.into_bytes())]);
        let text = calibration("test.csv", "") + "[fit]\nparameters = [\"a\"]\np = 3.0\n";
        let case = CalibrationCase::from_text(&text, "case", Folder::at_hand(files)).unwrap();
        calibrate(&case, &Silent).unwrap().misfit_at_ends
    };
    for (m, least, [slower, faster]) in [(3.5, 3.0, ["slower", "faster"]), (3.0, 0.0, ["", ""])] {
        let misfit = fit(m);
        let [low, high] = [misfit.low.unwrap(), misfit.high.unwrap()];
        assert!(low.rate_over_law_percent <= -least && high.rate_over_law_percent >= -0.5 + least, "{misfit:?}");
        assert!(least > 0.0 || low.rate_over_law_percent > -0.5 && high.rate_over_law_percent < 0.5, "{misfit:?}");
        // Rates go as ΔK^(m - 3) against the law: what lies between the ends is known.
        let middle = |end: Misfit| (end.delta_k_from_mpa_sqrt_m * end.delta_k_to_mpa_sqrt_m).sqrt();
        let between = (1.0 + high.rate_over_law_percent / 100.0) / (1.0 + low.rate_over_law_percent / 100.0);
        assert!((between / (middle(high) / middle(low)).powf(m - 3.0) - 1.0).abs() < 0.02, "{between}");
        let words = misfit.words();
        assert!(words.contains(slower) && words.contains(faster) && 17 + words.chars().count() <= 80, "{words}");
        assert!(low.intervals >= 2 && high.intervals >= 2 && low.delta_k_to_mpa_sqrt_m < high.delta_k_from_mpa_sqrt_m);
    }
}

#[test]
fn a_law_that_no_metal_has_is_refused_by_name() {
    let csv = csv_of(&plain(0.5));
    let slips =
        [("as it was", csv.clone(), true), ("single cycles called millions", csv.replace("cycles,", "megacycles,"), false)];
    for (name, csv, is_metal) in slips {
        let outcome = calibrate(&case(&csv, "").unwrap(), &Silent);
        match (outcome, is_metal) {
            (Ok(_), true) => {}
            (Err(error), false) => {
                assert_eq!(error.exit_code(), 2, "{name}");
                assert!(error.to_string().contains("the rate at ΔK = 10 MPa√m is"), "{name}: {error}");
            }
            (outcome, _) => panic!("{name}: {outcome:?}"),
        }
    }
}
