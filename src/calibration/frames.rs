//! Curves and fits as data frames (feature `tables`): what is in them, [`crate::tables`] knows how.

use crate::calibration::fit::FittedCurve;
use crate::calibration::measured::MeasuredCurve;
use crate::calibration::median::{Rising, cycles_at};
use crate::error::Result;
use crate::tables::{CYCLES, DataFrame, LENGTH, SPECIMEN, Values, frame, quantiles, wide_to_long};
use crate::units::MM;

/// Shares of specimens whose cycles are written beside a fit to many of them.
pub const SHARES: [f64; 3] = [0.05, 0.5, 0.95];

/// One row a reading: `specimen,cycles,crack_length_mm`.
pub fn long(curves: &[MeasuredCurve]) -> Result<DataFrame> {
    let names = curves.iter().flat_map(|curve| std::iter::repeat_n(curve.specimen.clone(), curve.cycles.len()));
    let cycles = curves.iter().flat_map(|curve| curve.cycles.iter().copied());
    let lengths = lengths_mm(curves.iter().flat_map(|curve| &curve.crack_length));
    frame(vec![
        (SPECIMEN, Values::Text(names.collect())),
        (CYCLES, Values::Numbers(cycles.collect())),
        (LENGTH, Values::Numbers(lengths)),
    ])
}

/// One column a specimen: cycles at each of `lengths` (m), linear between readings, empty where a specimen was not read.
pub fn wide(curves: &[MeasuredCurve], lengths: &[f64]) -> Result<DataFrame> {
    let mut columns = vec![(LENGTH, Values::Numbers(lengths_mm(lengths)))];
    for curve in curves {
        let rising = Rising::of(curve);
        let cycles = lengths.iter().map(|&length| rising.cycles_at(length));
        columns.push((&curve.specimen, Values::Gaps(cycles.collect())));
    }
    frame(columns)
}

/// Quantiles over specimens of the cycles since the first of `lengths` (m): `crack_length_mm,cycles_p05,...`.
pub fn cycle_quantiles(curves: &[MeasuredCurve], lengths: &[f64], shares: &[f64]) -> Result<DataFrame> {
    let counted_from_start = |curve: &MeasuredCurve| {
        let start = cycles_at(curve, *lengths.first()?)?;
        Some(MeasuredCurve { cycles: curve.cycles.iter().map(|n| n - start).collect(), ..curve.clone() })
    };
    let curves: Vec<MeasuredCurve> = curves.iter().filter_map(counted_from_start).collect();
    quantiles(&wide_to_long(&wide(&curves, lengths)?)?, shares)
}

/// Fitted beside measured cycles: `specimen,crack_length_mm,cycles_measured,cycles_fitted`.
pub fn fit_curves(fits: &[FittedCurve]) -> Result<DataFrame> {
    let names = fits.iter().flat_map(|fit| std::iter::repeat_n(fit.name.clone(), fit.crack_length.len()));
    frame(vec![
        (SPECIMEN, Values::Text(names.collect())),
        (LENGTH, Values::Numbers(lengths_mm(fits.iter().flat_map(|fit| &fit.crack_length)))),
        ("cycles_measured", Values::Numbers(fits.iter().flat_map(|fit| fit.cycles_measured.iter().copied()).collect())),
        ("cycles_fitted", Values::Numbers(fits.iter().flat_map(|fit| fit.cycles_fitted.iter().copied()).collect())),
    ])
}

/// One row a specimen: `specimen,a,p,life_measured,life_fitted,rms_life_error`.
pub fn specimens(fits: &[FittedCurve]) -> Result<DataFrame> {
    let numbers = |value: fn(&FittedCurve) -> f64| Values::Numbers(fits.iter().map(value).collect());
    frame(vec![
        (SPECIMEN, Values::Text(fits.iter().map(|fit| fit.name.clone()).collect())),
        ("a", numbers(|fit| fit.constants.a)),
        ("p", numbers(|fit| fit.constants.p)),
        ("life_measured", numbers(FittedCurve::life_measured)),
        ("life_fitted", numbers(FittedCurve::life_fitted)),
        ("rms_life_error", numbers(FittedCurve::rms_life_error)),
    ])
}

/// Lengths in mm without the last bits that the conversion leaves: equal lengths of two specimens must stay equal keys.
fn lengths_mm<'a>(lengths: impl IntoIterator<Item = &'a f64>) -> Vec<f64> {
    lengths.into_iter().map(|length| (length / MM * 1e9).round() / 1e9).collect()
}
