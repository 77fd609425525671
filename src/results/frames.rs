//! Curves and fits as data frames (feature `tables`): what is in them, [`perilife_tables`] knows how.

use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_calibration::median::{Rising, cycles_at};
use perilife_calibration::search::FittedCurve;
use perilife_measured::MeasuredCurve;
use perilife_tables::{Column, DataFrame, LENGTH, SPECIMEN, frame, quantiles, wide_to_long};

/// Shares of specimens whose cycles are written beside a fit to many of them.
pub const SHARES: [f64; 3] = [0.05, 0.5, 0.95];

/// One column a specimen: cycles at each of `lengths` (m), linear between readings, empty where a specimen was not read.
pub fn wide(curves: &[MeasuredCurve], lengths: &[f64]) -> Result<DataFrame> {
    let of_specimen = |curve: &MeasuredCurve| {
        let rising = Rising::of(curve);
        let cycles: Vec<Option<f64>> = lengths.iter().map(|&length| rising.cycles_at(length)).collect();
        Column::new(curve.specimen.as_str().into(), cycles)
    };
    let first = Column::new(LENGTH.into(), lengths_mm(lengths));
    frame(std::iter::once(first).chain(curves.iter().map(of_specimen)).collect())
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
    let cycles = |of: fn(&FittedCurve) -> &Vec<f64>| fits.iter().flat_map(of).copied().collect::<Vec<f64>>();
    frame(vec![
        Column::new(SPECIMEN.into(), names.collect::<Vec<String>>()),
        Column::new(LENGTH.into(), lengths_mm(fits.iter().flat_map(|fit| &fit.crack_length))),
        Column::new("cycles_measured".into(), cycles(|fit| &fit.cycles_measured)),
        Column::new("cycles_fitted".into(), cycles(|fit| &fit.cycles_fitted)),
    ])
}

/// One row a specimen: `specimen,a,p,life_measured,life_fitted,rms_life_error`.
pub fn specimens(fits: &[FittedCurve]) -> Result<DataFrame> {
    let column =
        |name: &str, value: fn(&FittedCurve) -> f64| Column::new(name.into(), fits.iter().map(value).collect::<Vec<f64>>());
    frame(vec![
        Column::new(SPECIMEN.into(), fits.iter().map(|fit| fit.name.clone()).collect::<Vec<String>>()),
        column("a", |fit| fit.constants.a),
        column("p", |fit| fit.constants.p),
        column("life_measured", FittedCurve::life_measured),
        column("life_fitted", FittedCurve::life_fitted),
        column("rms_life_error", FittedCurve::rms_life_error),
    ])
}

/// Lengths in mm without the last bits that the conversion leaves: equal lengths of two specimens must stay equal keys.
fn lengths_mm<'a>(lengths: impl IntoIterator<Item = &'a f64>) -> Vec<f64> {
    lengths.into_iter().map(|length| (length / MM * 1e9).round() / 1e9).collect()
}
