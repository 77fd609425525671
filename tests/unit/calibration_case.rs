//! Calibration files: what they give, and what is wrong with broken ones.

use crate::support::desk::desk;
use crate::support::fits::report;
use crate::support::rows::{assert_refusal, rows};
use perilife_base::input::Folder;
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::criterion::Criterion;
use perilife_calibration::fit::{Bonds, Fit, FitTask, fit};
use perilife_calibration::power_law::PowerLaw;
use perilife_calibration::results::{fit_curves, record};
use perilife_growth::case::record::FittedRecord;

const GOOD: &str = include_str!("../reference/cases/calibration_case.toml");

const CURVES: &str = "specimen,cycles,crack_length_mm\nA,100,8\nA,1000,9\nA,2000,10\nA,2900,11\nA,3700,12\nA,4400,13\nA,5000,14\n\
                      B,0,8.5\nB,500,9\nB,1600,10\nB,2600,11\nB,3450,12\nB,4200,13\n";

fn read(text: &str, overrides: &[&str]) -> perilife_base::error::Result<CalibrationCase> {
    let folder = desk(&[("curves.csv", &CURVES), ("alloy.toml", &text)]);
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    CalibrationCase::from_file(&folder.path().join("alloy.toml"), &overrides)
}

fn fitted(calibration: &CalibrationCase) -> Fit {
    let delta_k = |length: f64| calibration.delta_k(length).unwrap();
    let model = PowerLaw::new(9.0 * MM, calibration.case.stop.crack_length, &delta_k).unwrap();
    let task = FitTask {
        curves: &calibration.curves,
        fixed_p: calibration.exponent.fixed,
        criterion: calibration.criterion,
        delta_k: &delta_k,
    };
    let bonds = Some(Bonds { rate_constant: 1.0, horizon: 3.015 * MM, spacing: 1.0 * MM });
    Fit { bonds, ..fit(&task, &model).unwrap() }
}

#[test]
fn a_calibration_is_a_case_that_runs_through_the_window() {
    let calibration = read(GOOD, &[]).unwrap();
    assert_eq!(calibration.case.name, "alloy");
    assert_eq!(calibration.curves.len(), 2);
    assert!(calibration.curves.iter().all(|curve| curve.cycles[0] == 0.0 && curve.cycles.len() == 5));
    assert!((calibration.case.stop.crack_length - 13.0 * MM).abs() < 1e-12);
    assert_eq!((calibration.case.material.toughness, calibration.case.material.yield_strength), (None, None));
    // Secant formula: 48.28 √(π 0.009 / cos(π 9 / 152.4)) = 8.1888 MPa√m.
    assert!((calibration.delta_k(9.0 * MM).unwrap() / MPA_SQRT_M - 8.1888).abs() < 1e-4);
    assert_eq!(read(GOOD, &["fit.parameters=[\"a\"]", "fit.p=2.9"]).unwrap().exponent.fixed, Some(2.9));
}

#[test]
fn hash_of_a_source_is_that_of_its_bytes() {
    // printf '%s' "$CURVES" | sha256sum, of the text above.
    let calibration = read(GOOD, &[]).unwrap();
    assert_eq!(calibration.sources[0].file, "curves.csv");
    assert_eq!(calibration.sources[0].sha256, "fe841a4743045b27329f850db2b06e08d6bf228b843027c4de43c2025c37c75f");
}

#[test]
fn results_have_every_promised_key_and_read_back() {
    let calibration = read(GOOD, &[]).unwrap();
    let fit = fitted(&calibration);
    let report = report(&calibration, &fit, 1.5);
    let keys = "a p horizon_mm paris_c_mm_per_cycle paris_m pivot_delta_k_mpa_sqrt_m rate_at_pivot_mm_per_cycle covariance \
                rms_life_error specimens evaluations wall_s";
    keys.split_whitespace().for_each(|key| assert!(report.get(key).is_some(), "{key} in {report:#}"));
    for key in "name a p life_measured life_fitted rms_life_error".split(' ') {
        assert!(report["specimens"][1].get(key).is_some(), "{key} in {report:#}");
    }
    let toml = toml::to_string(&record(&calibration, &fit)).unwrap();
    let back: FittedRecord = toml::from_str(&toml).unwrap();
    assert_eq!((back.a, back.p, back.stress_ratio), (fit.record.constants.a, fit.record.constants.p, 0.2));
    assert!((back.delta_k_min_mpa_sqrt_m - 8.1888).abs() < 1e-4);

    let csv = fit_curves(&fit).csv();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], "specimen,crack_length_mm,cycles_measured,cycles_fitted");
    assert_eq!(lines.len(), 1 + 3 * 5, "two specimens and their median:\n{csv}");
    for (line, name) in [(1, "A"), (6, "B"), (11, "median")] {
        assert!(lines[line].starts_with(&format!("{name},9.000000000,0,0")), "{csv}");
    }
}

#[test]
fn broken_calibration_files_say_what_would_be_right() {
    for (name, swaps, words) in rows::<Vec<(String, Vec<String>, String)>>("calibration_case", "broken") {
        let text = swaps.chunks(2).fold(GOOD.to_owned(), |text, swap| {
            assert!(text.contains(&swap[0]), "{name}: {}", swap[0]);
            if swap[0].is_empty() { text + &swap[1] } else { text.replace(&swap[0], &swap[1]) }
        });
        let error = read(&text, &[]).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{name}: {error}");
        assert!(error.to_string().contains(&words), "{name}: {words} in {error}");
        assert!(error.to_string().contains("alloy.toml") || error.to_string().contains("curves.csv"), "{name}: {error}");
    }
    // A threshold is allowed, and said to belong to the cases as well; gamma = 1 is what a record means anyway.
    let warned = read(&format!("{GOOD}[fatigue]\nwalker_gamma = 1.0\ndelta_k_threshold_mpa_sqrt_m = 2.0\n"), &[]).unwrap();
    assert!(warned.warnings.iter().any(|line| line.contains("has no effect on the fit")), "{:?}", warned.warnings);
    let error = read(&GOOD.replace("curves.csv", "elsewhere.csv"), &[]).unwrap_err();
    assert_eq!(error.exit_code(), 4);
    assert!(error.to_string().contains("elsewhere.csv: cannot read"), "{error}");
}

#[test]
fn the_criterion_is_a_choice() {
    assert_eq!(read(GOOD, &[]).unwrap().criterion, Criterion::BothEnds);
    for &criterion in Criterion::ALL {
        let calibration = read(GOOD, &[&format!("fit.criterion={criterion}")]).unwrap();
        assert_eq!(calibration.criterion, criterion);
        assert_eq!(report(&calibration, &fitted(&calibration), 0.0)["criterion"], criterion.name());
    }
    assert_refusal(read(GOOD, &["fit.criterion=least_effort"]), &["least_effort", "both_ends, first_reading"]);
}

#[test]
fn readings_at_hand_are_those_of_the_file() {
    let curves = || Folder::at_hand([("curves.csv".to_owned(), CURVES.as_bytes().to_vec())]);
    let (from_file, at_hand) = (read(GOOD, &[]).unwrap(), CalibrationCase::from_text(GOOD, "alloy", curves()).unwrap());
    assert_eq!((&at_hand.case, &at_hand.sources), (&from_file.case, &from_file.sources));
    let readings = |calibration: &CalibrationCase| -> Vec<(String, Vec<f64>, Vec<f64>)> {
        calibration.curves.iter().map(|c| (c.specimen.clone(), c.cycles.clone(), c.crack_length.clone())).collect()
    };
    assert_eq!(readings(&at_hand), readings(&from_file));
    let two = GOOD.replace("[\"curves.csv\"]", "[\"curves.csv\", \"more.csv\"]");
    assert_refusal(CalibrationCase::from_text(&two, "alloy", curves()), &["\"more.csv\"", "came with curves.csv"]);
}

#[test]
fn readings_say_load_and_first_crack_length_where_the_file_does_not() {
    let loading = "[loading]\nkind = \"constant_amplitude\"\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n";
    let open = GOOD.replace(loading, "").replace("crack_length_mm = 9.0\n[material]", "[material]");
    let read = |text: &str, head: &str, of_b: &str| {
        let rows = CURVES.lines().enumerate().map(|(i, line)| match i {
            0 => format!("{},stress_max_mpa,stress_ratio\n", line.replace("crack_length_mm", head)),
            _ => format!("{line},{},0.2\n", if line.starts_with('B') { of_b } else { "60.35" }),
        });
        let folder = desk(&[("curves.csv", &rows.collect::<String>()), ("alloy.toml", &text)]);
        CalibrationCase::from_file(&folder.path().join("alloy.toml"), &[])
    };
    let load = "loading: stress_max_mpa = 60.35, stress_ratio = 0.2, from the readings";
    let edge = open.replace("\"middle_tension\"", "\"double_edge_tension\"");
    let whole = open.replace("from_crack_length_mm = 9.0\n", "").replace("to_crack_length_mm = 13.0\n", "");
    for (text, head, first, words) in [
        (&edge, "crack_length_mm", 9.0, "9 mm, from the first reading"),
        (&whole, "2a (mm)", 4.0, "4 mm, from the first reading (half of the tip-to-tip length)"),
    ] {
        let read = read(text, head, "60.35").unwrap();
        let specimen = &read.case.specimen;
        assert_eq!((read.case.loading.maximum, read.case.loading.ratio, specimen.crack_length), (60.35e6, 0.2, first * MM));
        for words in [load, words] {
            assert!(read.warnings.iter().any(|line| line.contains(words)), "{words}: {:?}", read.warnings);
        }
        let is_whole = read.input.contains_key("loading") && read.input["specimen"].get("crack_length_mm").is_some();
        assert!(is_whole, "{:?}", read.input);
    }
    // Half of the length or all of it: nothing says.
    for kind in ["middle_tension", "cruciform"] {
        let read = read(&open.replace("middle_tension", kind), "crack_length_mm", "60.35");
        assert_refusal(read, &["specimen.crack_length_mm: is missing"]);
    }
    assert_refusal(read(&edge, "crack_length_mm", "50"), &["loading: is missing"]);
    // What the readings could give is missing because they are not understood: that is said.
    assert_refusal(read(&edge, "crack length", "60.35"), &["crack length", "measured.length_unit"]);
}

#[test]
fn a_load_of_the_case_that_is_not_that_of_its_readings_is_told() {
    let read = |head: &str, load: &str, text: &str| {
        let line = |(i, line): (usize, &str)| if i == 0 { format!("{line},{head}\n") } else { format!("{line},{load}\n") };
        let curves: String = CURVES.lines().enumerate().map(line).collect();
        let folder = desk(&[("curves.csv", &curves), ("alloy.toml", &text)]);
        CalibrationCase::from_file(&folder.path().join("alloy.toml"), &[])
    };
    for (load, words) in
        [("60.35", ""), ("120.7", "stress_ratio = 0.2) is used, 2.000 times that of the case"), ("30.175", "0.500 times")]
    {
        let told = read("stress_max_mpa,stress_ratio", &format!("{load},0.2"), GOOD).unwrap().warnings;
        let line = told.iter().find(|line| line.contains("times that of the case"));
        assert!(line.map_or(words.is_empty(), |line| !words.is_empty() && line.contains(words)), "{load}: {told:?}");
    }
    // A column that may be the load is named where a load is missing.
    let open = GOOD.replace("[loading]\nkind = \"constant_amplitude\"\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n", "");
    assert_ne!(open, GOOD);
    assert_refusal(read("P (kN)", "20", &open), &["loading: is missing", "ignored columns: P (kN)"]);
}
