//! `readings.csv` of a fit to lives: every reading of every specimen, with ΔK, rate, what speaks against it, and why it was left out.

use serde::Deserialize;

use super::case::CalibrationCase;
use super::rates::{RateMethod, RatePoint, add_delta_k, rates};
use perilife_base::columns::Table;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_measured::{LeaveOut, MeasuredCurve};

/// Readings from which a curve has rates by parabolas through seven of them.
const SEVEN: usize = 7;
pub const OUTSIDE: &str = "outside the fit window";

/// The table: ΔK, MPa√m, by that of the load of the case, Pa√m, at a length, m; a rate stands beside the reading in its middle, a secant
/// beside the later of its two readings.
pub fn readings(calibration: &CalibrationCase, left_out: &[LeaveOut], delta_k: &dyn Fn(f64) -> f64) -> Table {
    let mut case = calibration.case.clone();
    case.material.yield_strength = calibration.yield_strength;
    let of_curve = |curve| of_curve(curve, (calibration, left_out), &case, delta_k);
    // Rows that are left out by their lines stand at the end.
    let by_line = left_out.iter().filter(|one| one.line.is_some()).map(|one| Reading {
        marks: one.place(),
        left_out: one.reason.clone(),
        ..Reading::default()
    });
    let rows: Vec<Reading> = calibration.read.iter().flat_map(of_curve).chain(by_line).collect();
    Table::new("readings.csv")
        .foreign("specimen", rows.iter().map(|row| &row.specimen))
        .measured("cycles", rows.iter().map(|row| row.cycles))
        .measured("crack_length_mm", rows.iter().map(|row| row.crack_length_mm))
        .measured("delta_k_mpa_sqrt_m", rows.iter().map(|row| row.delta_k_mpa_sqrt_m))
        .measured("da_dn_mm_per_cycle", rows.iter().map(|row| row.da_dn_mm_per_cycle))
        .words("method", rows.iter().map(|row| &row.method))
        .foreign("marks", rows.iter().map(|row| &row.marks))
        .foreign("left_out", rows.iter().map(|row| &row.left_out))
}

/// A row of `readings.csv`.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct Reading {
    pub specimen: String,
    pub cycles: Option<f64>,
    pub crack_length_mm: Option<f64>,
    /// In the middle of the readings that the rate was taken from; `None` where no formula gives it.
    pub delta_k_mpa_sqrt_m: Option<f64>,
    /// `None` at the ends of a record.
    pub da_dn_mm_per_cycle: Option<f64>,
    pub method: String,
    pub marks: String,
    /// Why it does not count; empty where it does.
    pub left_out: String,
}

fn of_curve(
    read: &MeasuredCurve,
    (calibration, left_out): (&CalibrationCase, &[LeaveOut]),
    case: &Case,
    delta_k: &dyn Fn(f64) -> f64,
) -> Vec<Reading> {
    let reasons = reasons(read, left_out, calibration.read.len() == 1);
    let mut curve = read.clone();
    if reasons.iter().any(Option::is_some) {
        curve.left_out = reasons.iter().map(Option::is_some).collect();
    }
    let method = if curve.cycles.len() >= SEVEN { RateMethod::Polynomial7 } else { RateMethod::Secant };
    let mut points = rates(&curve, method);
    add_delta_k(&mut points, case, delta_k);
    let [from, to] = calibration.window;
    let row = |(place, (&cycles, &length)): (usize, (&f64, &f64))| {
        let before = place.checked_sub(1).map_or(f64::NEG_INFINITY, |before| curve.cycles[before]);
        let belongs = |point: &&RatePoint| point.cycles == cycles || point.cycles > before && point.cycles < cycles;
        let point = points.iter().rfind(belongs);
        let factor = curve.load_factor.get(place).copied().unwrap_or(1.0);
        let known = |value: f64| Some(value).filter(|value| value.is_finite());
        let by = point.map_or("", |point| if point.cycles == cycles { method.name() } else { RateMethod::Secant.name() });
        let left_out = match reasons[place].as_deref() {
            Some(reason) => reason,
            None if length < from || length > to => OUTSIDE,
            None => "",
        };
        Reading {
            specimen: curve.specimen.clone(),
            cycles: Some(cycles),
            crack_length_mm: Some(length / MM),
            delta_k_mpa_sqrt_m: known(point.map_or_else(|| delta_k(length) * factor, |point| point.delta_k) / MPA_SQRT_M),
            da_dn_mm_per_cycle: point.and_then(|point| known(point.rate / MM_PER_CYCLE)),
            method: by.to_owned(),
            marks: point.map_or_else(String::new, |point| point.flags.words()),
            left_out: left_out.to_owned(),
        }
    };
    curve.cycles.iter().zip(&curve.crack_length).enumerate().map(row).collect()
}

/// Why the growth up to each reading does not count; the first reading goes with the second.
fn reasons(curve: &MeasuredCurve, windows: &[LeaveOut], is_alone: bool) -> Vec<Option<String>> {
    let names = |window: &&LeaveOut| window.specimen.as_ref().map_or(is_alone, |name| *name == curve.specimen);
    let mut reasons = vec![None; curve.cycles.len()];
    for window in windows.iter().filter(names) {
        for (pair, reason) in curve.cycles.windows(2).zip(reasons.iter_mut().skip(1)) {
            if window.covers(pair[0], pair[1]) {
                *reason = Some(window.reason.clone());
            }
        }
    }
    if reasons.len() > 1 {
        reasons[0] = reasons[1].clone();
    }
    reasons
}
