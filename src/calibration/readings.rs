//! `readings.csv` of a fit to lives: every reading of every specimen, with ΔK, rate, what speaks against it, and why it was left out.

use std::fmt::Write as _;

use super::case::CalibrationCase;
use super::rates::{RateMethod, RatePoint, add_delta_k, rates};
use perilife_base::cells::field;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_measured::{LeaveOut, MeasuredCurve};

/// First line of the table.
pub const HEADER: &str = "specimen,cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,method,marks,left_out\n";
/// Readings from which a curve has rates by parabolas through seven of them.
const SEVEN: usize = 7;
/// Why a reading outside the fit window does not count.
const OUTSIDE: &str = "outside the fit window";

/// The table: ΔK, MPa√m, by that of the load of the case, Pa√m, at a length, m; a rate stands beside the reading in its middle, a secant
/// beside the later of its two readings.
pub fn readings_csv(calibration: &CalibrationCase, left_out: &[LeaveOut], delta_k: &dyn Fn(f64) -> f64) -> String {
    let mut case = calibration.case.clone();
    case.material.yield_strength = calibration.yield_strength;
    let mut text = HEADER.to_owned();
    for curve in &calibration.read {
        of_curve(&mut text, curve, (calibration, left_out), &case, delta_k);
    }
    // Rows that are left out by their lines stand at the end.
    for one in left_out.iter().filter(|one| one.line.is_some()) {
        let _ = writeln!(text, ",NaN,NaN,,,,{},{}", field(&one.place()), field(&one.reason));
    }
    text
}

fn of_curve(
    text: &mut String,
    read: &MeasuredCurve,
    (calibration, left_out): (&CalibrationCase, &[LeaveOut]),
    case: &Case,
    delta_k: &dyn Fn(f64) -> f64,
) {
    let reasons = reasons(read, left_out, calibration.read.len() == 1);
    let mut curve = read.clone();
    if reasons.iter().any(Option::is_some) {
        curve.left_out = reasons.iter().map(Option::is_some).collect();
    }
    let method = if curve.cycles.len() >= SEVEN { RateMethod::Polynomial7 } else { RateMethod::Secant };
    let mut points = rates(&curve, method);
    add_delta_k(&mut points, case, delta_k);
    let [from, to] = calibration.window;
    for (place, (&cycles, &length)) in curve.cycles.iter().zip(&curve.crack_length).enumerate() {
        let before = place.checked_sub(1).map_or(f64::NEG_INFINITY, |before| curve.cycles[before]);
        let belongs = |point: &&RatePoint| point.cycles == cycles || point.cycles > before && point.cycles < cycles;
        let point = points.iter().rfind(belongs);
        let factor = curve.load_factor.get(place).copied().unwrap_or(1.0);
        let delta_k = point.map_or_else(|| delta_k(length) * factor, |point| point.delta_k);
        let rate = point.map_or(f64::NAN, |point| point.rate);
        let by = point.map_or("", |point| if point.cycles == cycles { method.name() } else { RateMethod::Secant.name() });
        let marks = point.map_or_else(String::new, |point| point.flags.words());
        let left_out = match reasons[place].as_deref() {
            Some(reason) => reason,
            None if length < from || length > to => OUTSIDE,
            None => "",
        };
        let known = |value: f64, words: String| if value.is_finite() { words } else { String::new() };
        let [delta_k, rate] =
            [known(delta_k, format!("{:.10}", delta_k / MPA_SQRT_M)), known(rate, format!("{:.10e}", rate / MM_PER_CYCLE))];
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{cycles},{:.10},{delta_k},{rate},{by},{marks},{}",
            field(&curve.specimen),
            length / MM,
            field(left_out)
        );
    }
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
