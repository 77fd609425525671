//! The calibration on real readings: does the fit to a measured panel keep its life and its rates, and do its C and m mean
//! the same in other specimens?
//!
//! Fitted is the median of 34 panels of 2024-T3 (Virkler, Hillberry and Goel 1979), as `calibration/al2024-t3` has it. The
//! equivalents C and m of that fit are then used as anybody would, by hand calculation with handbook K, in specimens that
//! were not tested, and compared with peridynamic runs of them with the fitted law.

use super::golden::ended_by;
use super::table::Table;
use perilife_base::error::Result;
use perilife_base::input::Folder;
use perilife_base::units::MM;
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::median::cycles_at;
use perilife_calibration::paris::Paris;
use perilife_calibration::results::record;
use perilife_calibration::search::FittedCurve;
use perilife_growth::case::Case;
use perilife_growth::case::record::FittedRecord;
use perilife_growth::predict::{Silent, StopReason, predict};
use perilife_measured::MeasuredCurve;

/// Calibration of 2024-T3, and its readings.
const CALIBRATION: &str = include_str!("../../calibration/al2024-t3/case.toml");
/// Median of 34 panels.
const READINGS: &[u8] = include_bytes!("../../calibration/al2024-t3/measured/virkler_median.csv");

/// ΔK at which the rate is compared, MPa√m: there fits of rates and fits of lives meet.
const DELTA_K: f64 = 11.4;
/// Rate there by fits to the readings, mm/cycle: lowest and highest, and percent that a rate may lie beyond them.
const RATES: [f64; 2] = [9.40e-5, 9.63e-5];
const BEYOND_RATES: f64 = 2.0;
/// Lengths from which life remains, mm, with the bounds of that life in percent: the less remains, the less the panels agree.
const REMAINING: [(f64, f64); 3] = [(20.0, 3.0), (30.0, 5.0), (35.0, 10.0)];

const VIRKLER: &str = "median of 34 panels, Virkler, Hillberry and Goel 1979";

/// Specimens that nobody tested, of the same sheet at the same stress ratio, their ΔK inside the fitted range: from 9.0 to 24.8 and 24.7 MPa√m.
const OTHERS: [(&str, &str); 2] = [
    (
        "C(T) W 100 mm, 25 to 60 mm",
        "specimen = { kind = 'compact_tension', width_mm = 100.0, thickness_mm = 2.54, crack_length_mm = 25.0 }
        loading = { force_range_n = 1460.0, stress_ratio = 0.2 }
        stop = { crack_length_mm = 60.0 }",
    ),
    (
        "single edge W 100 mm, 15 to 40 mm",
        "loading = { stress_range_mpa = 33.0, stress_ratio = 0.2 }
        stop = { crack_length_mm = 40.0 }
        [specimen]
        kind = 'single_edge_tension'
        ends = 'uniform_stress'
        width_mm = 100.0
        length_mm = 240.0
        thickness_mm = 2.54
        crack_length_mm = 15.0",
    ),
];

/// All rows of the topic.
pub fn all(table: &mut Table) -> Result<()> {
    let readings = Folder::at_hand([("measured/virkler_median.csv".to_owned(), READINGS.to_vec())]);
    let calibration = CalibrationCase::from_text(CALIBRATION, "al2024-t3", readings)?;
    let fit = calibrate(&calibration, &Silent)?;
    let what = "M(T) fitted from 9 to 49.8 mm, 1 mm spacing: cycles";
    table.compare(what, fit.record.life_fitted(), fit.record.life_measured(), 1.5, VIRKLER);
    remaining_lives(table, &fit.record);
    rate(table, &fit.paris);
    let record = record(&calibration, &fit);
    for (what, text) in OTHERS {
        let [by_hand, by_bonds] = ["handbook", "peridynamics"].map(|method| life(text, method, &record));
        let source = "quadrature with C and m of the fitted record and handbook K";
        table.compare(format!("{what}, 1 mm spacing: cycles with the fitted law"), by_bonds?, by_hand?, 5.0, source);
    }
    Ok(())
}

/// Cycles that remain to the end of the fit.
fn remaining_lives(table: &mut Table, record: &FittedCurve) {
    let curve = |cycles: &[f64]| MeasuredCurve::new(record.name.clone(), cycles.to_vec(), record.crack_length.clone());
    let (fitted, measured) = (curve(&record.cycles_fitted), curve(&record.cycles_measured));
    for (from, bound) in REMAINING {
        let remaining = |curve: &MeasuredCurve| cycles_at(curve, from * MM).map_or(f64::NAN, |n| curve.life() - n);
        let what = format!("M(T) fitted: cycles that remain from {from} to 49.8 mm");
        table.compare(what, remaining(&fitted), remaining(&measured), bound, VIRKLER);
    }
}

/// Rate at one ΔK. The readings give it as a band; with the middle as reference, the bound reaches as far beyond the nearer
/// end of the band as a rate may.
fn rate(table: &mut Table, paris: &Paris) {
    let [low, high] = RATES;
    let middle = 0.5 * (low + high);
    let share = BEYOND_RATES / 100.0;
    let bound = 100.0 * (1.0 - low * (1.0 - share) / middle).min(high * (1.0 + share) / middle - 1.0);
    let what = format!("M(T) fitted: da/dN at ΔK = {DELTA_K} MPa√m, mm/cycle");
    let source = "fits of rates and of lives to the same readings: 9.40e-5 to 9.63e-5, and 2 % beyond";
    table.compare(what, paris.c * DELTA_K.powf(paris.m), middle, bound, source);
}

/// Life of a specimen with the fitted law.
fn life(text: &str, method: &str, record: &FittedRecord) -> Result<f64> {
    let common = format!("model = {{ method = '{method}', spacing_mm = 1.0 }}\nmaterial = {{ name = 'al2024-t3' }}");
    let case = Case::from_toml_with_law(&format!("{common}\n{text}"), "verification", Folder::none(), record.clone())?;
    let run = predict(&case, &Silent)?;
    ended_by(&run, StopReason::CrackLengthReached, &case.name)?;
    Ok(run.life_cycles())
}
