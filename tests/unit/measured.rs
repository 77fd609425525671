//! The importer: units, layouts, windows and medians, on text and on real files.

use std::path::Path;

use perilife_base::table::units::{CycleUnit, LengthUnit};
use perilife_base::units::MM;
use perilife_calibration::median::{common_lengths, cycles_at, median, pointwise_median_at};
use perilife_measured::{Import, LeaveOut, Measured, MeasuredCurve, PROBLEMS_MAX, parse, read, survey};
use proptest::prelude::*;

use crate::support::median::pointwise_median;
use crate::support::rows::{assert_refusal, assert_says};
use crate::support::shared::shared;

fn parsed(text: &str) -> Measured {
    parse(text.as_bytes(), Path::new("curve.csv"), &Import::default()).unwrap()
}

fn refused(text: &str, import: &Import) -> String {
    parse(text.as_bytes(), Path::new("curve.csv"), import).unwrap_err().to_string()
}

const PLAIN: &str = "cycles,crack_length_mm\n0,10.0\n1000,10.5\n2500,11.25\n4000,12.5\n5000,14.0\n";

#[test]
fn units_may_stand_in_the_calibration_file() {
    let text = PLAIN.replace("crack_length_mm", "crack_length");
    assert!(refused(&text, &Import::default()).contains("crack_length: has no unit"), "{}", refused(&text, &Import::default()));
    let units = Import { length: Some(LengthUnit::Inch), cycles: Some(CycleUnit::Kilocycles), ..Import::default() };
    let curve = parse(text.as_bytes(), Path::new("x.csv"), &units).unwrap().curves.remove(0);
    assert!((curve.crack_length[0] - 0.254).abs() < 1e-12);
    assert!((curve.cycles[4] - 5e6).abs() < 1e-6);
    let contradiction = refused(PLAIN, &units);
    assert!(contradiction.contains("is in mm, but measured.length_unit says inch"), "{contradiction}");
}

#[test]
fn wide_tables_hold_one_specimen_a_column() {
    let by_length = "crack_length_mm,V01,V02\n10,0,0\n11,100,110\n12,200,\n13,300,310\n14,400,410\n15,500,510\n";
    let curves = parsed(by_length).curves;
    assert_eq!([curves[0].specimen.as_str(), curves[1].specimen.as_str()], ["V01", "V02"]);
    assert_eq!([curves[0].cycles.len(), curves[1].cycles.len()], [6, 5], "an empty cell is a reading that was not taken");
    let by_cycles = "cycles;V01;V02\n0;10;10,5\n100;11;11\n200;12;12\n300;13;13\n400;14;14\n";
    let units = Import { length: Some(LengthUnit::Millimetre), ..Import::default() };
    let curves = parse(by_cycles.as_bytes(), Path::new("wide.csv"), &units).unwrap().curves;
    assert!((curves[1].crack_length[0] - 10.5 * MM).abs() < 1e-12);
    assert!(refused(by_cycles, &Import::default()).contains("set measured.length_unit"));
    // Two columns are no wide table: the second could be anything.
    assert!(refused("crack_length_mm,time_s\n1,2\n", &Import::default()).contains("no column of cycles"));
}

#[test]
fn falling_readings_are_noise_and_counted() {
    let measured = parsed("cycles,crack_length_mm\n0,10\n10,10.5\n20,10.4\n30,11\n40,10.9\n50,12\n");
    assert_eq!(measured.warnings.len(), 1);
    assert!(measured.warnings[0].contains("drops at 2 of 6 readings"), "{:?}", measured.warnings);
    // Between 10.5 and 11 mm the reading of 10.4 does not count: 10.5 at 10 cycles, 11 at 30.
    assert_eq!(cycles_at(&measured.curves[0], 10.75 * MM).map(f64::round), Some(20.0));
}

#[test]
fn lengths_are_checked_before_a_window_is_cut() {
    let measured = parsed("cycles,crack_length_mm\n0,10\n10,11\n20,12\n30,13\n40,14\n50,80\n");
    let error = measured.check_lengths(76.2 * MM, "half width").unwrap_err().to_string();
    assert_says(&error, &["curve.csv:7", "crack_length_mm = 80", "half width is 76.2 mm"]);
    assert!(measured.check_lengths(100.0 * MM, "half width").is_ok());
}

#[test]
fn a_window_counts_cycles_from_its_first_reading() {
    let measured = parsed("cycles,crack_length_mm\n100,9\n200,10\n300,11\n400,12\n500,13\n600,14\n700,15\n");
    let kept = measured.window(Some(10.0 * MM), Some(14.0 * MM)).unwrap();
    assert_eq!(kept.curves[0].cycles, [0.0, 100.0, 200.0, 300.0, 400.0]);
    assert_eq!(kept.curves[0].source.lines, [3, 4, 5, 6, 7]);
    assert_refusal(measured.window(Some(12.0 * MM), None), &["leaves 4 of 7 readings of specimen curve"]);
}

fn curve(name: &str, cycles: &[f64], lengths_mm: &[f64]) -> MeasuredCurve {
    let crack_length = lengths_mm.iter().map(|a| a * MM).collect();
    MeasuredCurve::new(name, cycles.to_vec(), crack_length)
}

#[test]
fn the_median_is_taken_at_equal_length_and_from_a_common_start() {
    assert_eq!([median(&[3.0, 1.0, 2.0]), median(&[4.0, 1.0, 2.0, 3.0])], [2.0, 2.5]);
    // Straight lines of 100, 200 and 400 cycles per mm whose counters start at different lengths and numbers.
    let curves = [
        curve("a", &[0.0, 100.0, 200.0, 300.0, 400.0], &[9.0, 10.0, 11.0, 12.0, 13.0]),
        curve("b", &[50.0, 250.0, 450.0, 650.0, 850.0], &[9.5, 10.5, 11.5, 12.5, 13.5]),
        curve("c", &[1000.0, 1400.0, 1800.0, 2200.0, 2600.0], &[8.5, 9.5, 10.5, 11.5, 12.5]),
    ];
    let grid = common_lengths(&curves).unwrap();
    assert!((grid[0] - 9.5 * MM).abs() < 1e-12 && (grid[grid.len() - 1] - 12.5 * MM).abs() < 1e-12, "{grid:?}");
    let middle = pointwise_median(&curves).unwrap();
    for (length, cycles) in middle.crack_length.iter().zip(&middle.cycles) {
        assert!((cycles - 200.0 * (length / MM - 9.5)).abs() < 1e-6, "{cycles} at {length}");
    }
    assert!(pointwise_median_at(&curves, &[8.6 * MM, 9.0 * MM]).is_err());
    let apart = [curves[0].clone(), curve("d", &[0.0, 1.0, 2.0, 3.0, 4.0], &[20.0, 21.0, 22.0, 23.0, 24.0])];
    assert!(pointwise_median(&apart).unwrap_err().to_string().contains("do not overlap"));
}

/// The table as printed (inch, million cycles) and its conversion are the same 21 curves; specimens stop at 1.6 in or at
/// 120 000 cycles.
#[test]
fn inch_and_megacycles_give_the_curves_of_mm_and_cycles() {
    let (Some(metric), Some(printed)) = (shared("alloy_a/alloy_a.csv"), shared("alloy_a/alloy_a_inch_megacycles.csv")) else {
        return;
    };
    let metric = read(&[metric], &Import::default()).unwrap().curves;
    let printed = read(&[printed], &Import::default()).unwrap().curves;
    assert_eq!([metric.len(), printed.len()], [21, 21]);
    assert_eq!(metric.iter().map(|curve| curve.cycles.len()).sum::<usize>(), 262);
    for (metric, printed) in metric.iter().zip(&printed) {
        assert_eq!(metric.specimen, printed.specimen);
        assert_eq!(metric.cycles.len(), printed.cycles.len());
        for i in 0..metric.cycles.len() {
            assert!((metric.cycles[i] - printed.cycles[i]).abs() < 1e-6, "{}", metric.specimen);
            assert!((metric.crack_length[i] - printed.crack_length[i]).abs() < 1e-9, "{}", metric.specimen);
        }
    }
    // Different lengths and ends: the median goes as far as all specimens do.
    let middle = pointwise_median(&metric).unwrap();
    assert!((middle.crack_length[0] - 22.86 * MM).abs() < 1e-9);
    assert!(middle.cycles.windows(2).all(|pair| pair[1] > pair[0]), "{:?}", middle.cycles);
}

#[test]
fn one_specimen_that_does_not_start_at_zero_is_read() {
    let Some(path) = shared("ct_porous/ct_porous.csv") else { return };
    let measured = read(&[path], &Import::default()).unwrap();
    let curve = &measured.curves[0];
    assert_eq!((curve.specimen.as_str(), curve.cycles.len(), curve.cycles[0]), ("CT1", 61, 36_000.0));
    measured.check_lengths(50.0 * MM, "width from the load line").unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    /// Text made of what such files are made of, after a good header: gets further than bytes do.
    #[test]
    fn random_tables_never_panic(
        header in prop::sample::select(vec!["cycles,crack_length_mm", "crack_length_mm;a;b", "specimen\tkilocycles\tcrack_length_in", "cycles,V1,V2"]),
        body in "[0-9eE.,;\t\"# \r\n+-]{0,200}|([0-9]{1,3},[0-9]{1,3}\n){0,12}|([0-9]{1,3};[0-9],[0-9];[0-9]{0,2}\n){0,12}",
    ) {
        let units = Import { length: Some(LengthUnit::Millimetre), ..Import::default() };
        for units in [units, Import::default()] {
            if let Ok(measured) = parse(format!("{header}\n{body}").as_bytes(), Path::new("noise.csv"), &units) {
                for curve in &measured.curves {
                    // A run-out has fewer.
                    prop_assert!(curve.cycles.len() >= 5 || curve.crack_length.iter().all(|a| *a <= curve.crack_length[0]));
                    prop_assert!(curve.cycles.windows(2).all(|pair| pair[1] > pair[0]));
                    prop_assert!(curve.crack_length.iter().all(|a| *a > 0.0 && a.is_finite()));
                }
                let _ = measured.check_lengths(50.0 * MM, "half width");
                let _ = measured.window(Some(1.0 * MM), Some(20.0 * MM));
                let _ = pointwise_median(&measured.curves);
            }
        }
    }
}

/// Names are looked up, not searched: 200 000 of them twice, interleaved, in two files.
#[test]
fn many_specimens_take_no_longer_each_than_few() {
    const COUNT: usize = 200_000;
    // In rounds, so that no row belongs to the curve of the row before; lengths fall once in every curve.
    let file = |prefix: char| {
        let row =
            |round: usize, i: usize| format!("{prefix}{i},{},{}\n", 1000 * round, 10.0 - 0.1 * (round as f64 - 1.0).powi(2));
        let rows = (0..5).flat_map(|round| (0..COUNT).map(move |i| row(round, i)));
        std::iter::once("specimen,cycles,crack_length_mm\n".to_owned()).chain(rows).collect::<String>()
    };
    let started = std::time::Instant::now();
    let [mut first, second] = ['a', 'b'].map(|prefix| parsed(&file(prefix)));
    first.add(second).unwrap();
    let seconds = started.elapsed().as_secs_f64();
    assert_eq!(first.curves.len(), 2 * COUNT);
    assert_eq!([&first.curves[7].specimen, &first.curves[COUNT].specimen], ["a7", "b0"], "in the order of the files");
    // A search for each took minutes.
    assert!(seconds < 30.0, "{seconds:.1} s");
    // What is to be said of each of them is said of the first hundred.
    assert_eq!(first.warnings.len(), 2 * 101, "{:?}", &first.warnings[..3]);
    assert_eq!(first.warnings[100], format!("readings: and {} more warnings of this kind", COUNT - 100));
    let window = |name: &str| {
        let reason = "why".to_owned();
        let (specimen, [from_cycles, to_cycles]) = (Some(name.to_owned()), [Some(0.0), Some(500.0)]);
        vec![LeaveOut { specimen, from_cycles, to_cycles, reason, ..LeaveOut::default() }]
    };
    let unknown = first.leave_out(&window("c")).unwrap_err().to_string();
    assert!(unknown.len() < 1000 && unknown.contains("399980 more"), "{unknown}");
    let problems = survey(file('a').replace(",1000,", ",x,").as_bytes(), Path::new("bad.csv"), &Import::default()).problems;
    assert_eq!(problems.len(), PROBLEMS_MAX + 1);
}

/// Lengths of a curve are found by halving: equal to a search from the start, and a long curve costs no more for each.
#[test]
fn lengths_are_found_in_long_curves() {
    let count = 100_000;
    let wave = |i: usize| 10.0 + 1e-3 * i as f64 + 0.01 * (i as f64).sin();
    let curve = |name: &str| {
        let (cycles, lengths) = ((0..count).map(|i| 10.0 * i as f64).collect(), (0..count).map(|i| MM * wave(i)).collect());
        MeasuredCurve::new(name, cycles, lengths)
    };
    let curves = [curve("a"), curve("b"), curve("c")];
    let started = std::time::Instant::now();
    let median = pointwise_median(&curves).unwrap();
    assert!(started.elapsed().as_secs_f64() < 30.0);
    for (length, cycles) in median.crack_length.iter().zip(&median.cycles).step_by(9973) {
        // The first reading that is as long, and the longest before.
        let reached = (0..count).find(|&i| curves[0].crack_length[i] >= *length).unwrap();
        assert!((cycles - 10.0 * reached as f64).abs() < 100.0, "{length}: {cycles} against reading {reached}");
    }
}

/// A number typed wrong, from which the crack falls back, is named by its line and taken out; noise is not.
#[test]
fn typing_errors_are_named() {
    let case = crate::support::hand_cases::hand_case(crate::support::hand_cases::PANEL, &[]);
    let read_with = |wrong: &[(usize, f64)]| {
        // Growth that doubles every ten readings, with noise of 0.01 mm.
        let mut noise = crate::support::noise::Noise::new(5);
        let mut lengths: Vec<f64> = (0..31).map(|i| 9.0 + 2.0_f64.powf(f64::from(i) / 10.0) + 0.01 * noise.normal()).collect();
        for (reading, by) in wrong {
            lengths[*reading] += by;
        }
        let rows: String = lengths.iter().enumerate().map(|(i, a)| format!("{},{a:.4}\n", 1000 * i)).collect();
        let text = format!("cycles,crack_length_mm\n{rows}");
        let mut measured = parse(text.as_bytes(), Path::new("typed.csv"), &Import::default()).unwrap();
        measured.compare_with(&case.specimen, &case.material, &case.loading).unwrap();
        measured
    };
    let errors = |measured: &Measured| measured.warnings.iter().filter(|line| line.contains("a typing error")).count();
    assert_eq!(errors(&read_with(&[])), 0);
    for (reading, by) in [(12, 10.0), (12, -1.0), (25, 3.0), (29, -2.0)] {
        let measured = read_with(&[(reading, by)]);
        let line = format!("readings: typed.csv: line {}: ", reading + 2);
        assert!(measured.warnings.iter().any(|words| words.starts_with(&line)), "{reading} {by}: {:?}", measured.warnings);
        assert_eq!((errors(&measured), measured.curves[0].cycles.len()), (1, 30), "{reading} {by}");
    }
}

/// A specimen whose crack never grew is named and left out; a lot of such is refused.
#[test]
fn specimens_that_stood_are_left_out() {
    let curve = |name: &str, growth: f64, noise: f64| {
        let lengths = (0..8).map(|i| 1e-2 + 1e-3 * (growth * f64::from(i) + noise * f64::from(i * 5 % 3 - 1))).collect();
        MeasuredCurve::new(name, (0..8).map(|i| 1e5 * f64::from(i)).collect(), lengths)
    };
    for (growth, noise) in [(0.0, 0.0), (0.0, 0.02)] {
        let lot = |more| Measured { curves: [vec![curve("s1", growth, noise)], more].concat(), warnings: Vec::new() };
        let mut measured = lot(vec![curve("s2", 0.5, 0.02), curve("s3", 0.5, 0.0)]);
        measured.leave_standing_out().unwrap();
        assert_eq!(measured.curves.iter().map(|curve| &*curve.specimen).collect::<Vec<_>>(), ["s2", "s3"]);
        assert!(measured.warnings[0].contains("specimen s1: no crack growth in 700000 cycles"), "{:?}", measured.warnings);
        assert_refusal(lot(Vec::new()).leave_standing_out(), &["specimen = s1: has no growth beyond the scatter"]);
    }
}
