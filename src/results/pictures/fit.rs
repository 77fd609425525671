//! Pictures of a fit to readings: `fit.svg`, crack length over cycles of every specimen, and `da_dn.svg`.

use serde::Deserialize;

use super::curves::{parts, smooth};
use crate::axis::Axis;
use crate::chart::{COMPUTED, Frame, INK, OF_RATES, Size};
use crate::format::short;
use perilife_base::columns::Table;
use perilife_base::error::Result;
use perilife_base::units::{MM_PER_CYCLE, MPA_SQRT_M};
use perilife_calibration::readings::Reading;
use perilife_calibration::record::LivesRecord;
use perilife_growth::case::record::CurveRecord;
use perilife_laws::curve::ROWS;
use perilife_plate::specimen::Point;

pub const FIT_FILE: &str = "fit.json";
/// Measured and fitted cycles of every specimen.
pub const CURVES_FILE: &str = "fit_curves.csv";
/// The fitted curve with the band of its constants.
pub const BAND_FILE: &str = "fit_band.csv";
pub const READINGS_FILE: &str = "readings.csv";
/// Rates that a law over K was fitted to.
pub const RATES_FITTED_FILE: &str = "fit_rates.csv";
const RATIO_ALIKE: f64 = 0.0051;
/// Most stress ratios that a picture tells apart.
const RATIOS_DRAWN: usize = 6;
/// Most circles of a picture; of more readings every second, third and so on is drawn.
const CIRCLES_MAX: usize = 160;
/// Rates from which circles would hide the law and each other: dots then.
const CIRCLES_OF_RATES_MAX: usize = 400;
const CURVE_POINTS: usize = 40;
/// Share of an area that the band of the fit covers with its colour.
const BAND: f64 = 0.3;

/// Readings and fitted curve of one specimen: cycles and crack length, mm.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lives {
    pub name: String,
    /// `[cycles, length]` as measured.
    pub measured: Vec<Point>,
    pub fitted: Vec<Point>,
}

/// Crack length against cycles: readings (circles), other specimens (thin lines), law (line) with its band `[length, low, high]`.
pub fn lives_svg(curves: &[Lives], fitted_to: &str, band: &[[f64; 3]], size: Size) -> String {
    let all = || curves.iter().flat_map(|curve| curve.measured.iter().chain(&curve.fitted));
    let cycles = all().map(|point| point[0]).chain(band.iter().map(|row| row[2]));
    let axes = [
        Axis::linear_in(cycles, parts(size.width, 95.0)),
        Axis::linear_in(all().map(|point| point[1]), parts(size.height, 45.0)),
    ];
    let mut frame = Frame::with_names(size, axes, ["Cycles N", "Crack length a, mm"], 0);
    let of_end = |end: usize| band.iter().map(|row| [row[end], row[0]]).collect::<Vec<Point>>();
    frame.band(&of_end(1), &of_end(2), BAND);
    for other in curves.iter().filter(|curve| curve.name != fitted_to) {
        frame.line(&other.measured, &format!("{INK}38"), 1.0, "");
    }
    if let Some(curve) = curves.iter().find(|curve| curve.name == fitted_to).or(curves.last()) {
        let [cycles, lengths]: [Vec<f64>; 2] = [0, 1].map(|axis| curve.fitted.iter().map(|point| point[axis]).collect());
        frame.line(&smooth(&cycles, &lengths), COMPUTED, 2.0, "");
        let every = curve.measured.len().div_ceil(CIRCLES_MAX).max(1);
        frame.circles(&curve.measured.iter().copied().step_by(every).collect::<Vec<_>>());
    }
    frame.finish(&format!("Crack length against cycles of {} curves with the fitted law", curves.len()))
}

/// A law over the range of ΔK that was measured: its curve, `[ΔK, da/dN]`, and the pivot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LawCurve {
    /// Name at its end; may be empty.
    pub name: String,
    pub points: Vec<Point>,
    /// Where the errors of rate and exponent have no correlation.
    pub pivot: Option<Point>,
}

/// `da_dn.svg`: readings as open circles, laws over their measured range only. ΔK in MPa√m, rates in mm/cycle.
pub fn rates_svg(readings: &[Point], laws: &[LawCurve], size: Size) -> String {
    let is_positive = |point: &&Point| point.iter().all(|value| value.is_finite() && *value > 0.0);
    let readings: Vec<Point> = readings.iter().filter(is_positive).copied().collect();
    let all: Vec<Point> = readings.iter().chain(laws.iter().flat_map(|law| &law.points)).filter(is_positive).copied().collect();
    let axes = [0, 1].map(|axis| Axis::logarithmic(all.iter().map(|point| point[axis])));
    let names = if size.width < 500.0 { ["ΔK, MPa√m", "da/dN, mm/cycle"] } else { OF_RATES };
    let letters = laws.iter().map(|law| law.name.chars().count()).max().unwrap_or(0);
    let mut frame = Frame::with_names(size, axes, names, letters);
    match readings.len() {
        0..=CIRCLES_OF_RATES_MAX => frame.circles(&readings),
        _ => frame.dots(&readings, INK),
    }
    for law in laws {
        frame.line(&law.points, COMPUTED, 2.0, "");
        law.pivot.into_iter().for_each(|pivot| frame.ring(pivot, COMPUTED));
    }
    let of_law = |law: &LawCurve| Some((law.name.clone(), *law.points.last()?, COMPUTED)).filter(|(name, ..)| !name.is_empty());
    let lines: Vec<Vec<Point>> = laws.iter().map(|law| law.points.clone()).collect();
    frame.names(&laws.iter().filter_map(of_law).collect::<Vec<_>>(), &lines);
    frame.finish(&format!("da/dN against ΔK: {} readings and fitted law", readings.len()))
}

#[derive(Deserialize)]
struct CurveRow {
    specimen: String,
    crack_length_mm: f64,
    cycles_measured: f64,
    cycles_fitted: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct FitTables {
    pub readings: Vec<Reading>,
    curves: Vec<Lives>,
    band: Vec<[f64; 3]>,
    law: LawCurve,
    fitted_to: String,
}

impl FitTables {
    /// Of `fit.json` and the tables `fit_curves.csv`, `fit_band.csv` and `readings.csv`.
    /// Errors: a line that is not as the fit wrote it, by file, line and what is wrong with it.
    pub fn of(fit: &LivesRecord, [curves, band, readings]: [&Table; 3]) -> Result<Self> {
        let mut all: Vec<Lives> = Vec::new();
        for row in curves.records::<CurveRow>()? {
            if all.last().is_none_or(|curve| curve.name != row.specimen) {
                all.push(Lives { name: row.specimen, ..Lives::default() });
            }
            if let Some(curve) = all.last_mut() {
                curve.measured.push([row.cycles_measured, row.crack_length_mm]);
                curve.fitted.push([row.cycles_fitted, row.crack_length_mm]);
            }
        }
        let band = band.records::<[f64; 4]>()?.into_iter().map(|[length, _, low, high]| [length, low, high]).collect();
        let of_power = |delta_k: f64| [delta_k, fit.paris_c_mm_per_cycle * delta_k.powf(fit.paris_m)];
        let ends = || [fit.delta_k_min_mpa_sqrt_m, fit.delta_k_max_mpa_sqrt_m].map(of_power).to_vec();
        let pivot = [fit.pivot_delta_k_mpa_sqrt_m, fit.rate_at_pivot_mm_per_cycle];
        let (points, pivot) = fit.curve.as_ref().map_or_else(|| (ends(), Some(pivot)), |curve| (along(curve), None));
        let law = LawCurve { name: String::new(), points, pivot };
        Ok(FitTables { readings: readings.records()?, curves: all, band, law, fitted_to: fit.fitted_to.clone() })
    }

    pub fn lives_svg(&self, size: Size) -> String {
        lives_svg(&self.curves, &self.fitted_to, &self.band, size)
    }

    /// Rates of the readings that count, and the law.
    pub fn rates_svg(&self, size: Size) -> String {
        let counted = self.readings.iter().filter(|reading| reading.left_out.is_empty());
        let points: Vec<Point> = counted.filter_map(|r| Some([r.delta_k_mpa_sqrt_m?, r.da_dn_mm_per_cycle?])).collect();
        rates_svg(&points, std::slice::from_ref(&self.law), size)
    }
}

/// A row of `fit_rates.csv`: a rate that a law was fitted to, and that of the law.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct RateFitted {
    pub series: String,
    pub stress_ratio: f64,
    pub delta_k_mpa_sqrt_m: f64,
    pub da_dn_mm_per_cycle: f64,
    pub da_dn_fitted_mm_per_cycle: f64,
}

/// `da_dn.svg` of a fit of laws over K: rates as circles, the law over the rates of every stress ratio.
pub fn law_svg(rates: &[RateFitted], size: Size) -> String {
    let mut ratios: Vec<f64> = rates.iter().map(|rate| rate.stress_ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup_by(|a, b| (*a - *b).abs() < RATIO_ALIKE);
    let of_ratio = |ratio: &f64| {
        let own = rates.iter().filter(|rate| (rate.stress_ratio - ratio).abs() < RATIO_ALIKE);
        let mut points: Vec<Point> = own.map(|rate| [rate.delta_k_mpa_sqrt_m, rate.da_dn_fitted_mm_per_cycle]).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        LawCurve { name: format!("R = {}", short(*ratio)), points, pivot: None }
    };
    // More of them than a picture can tell apart have no lines.
    let laws: Vec<LawCurve> = if ratios.len() > RATIOS_DRAWN { Vec::new() } else { ratios.iter().map(of_ratio).collect() };
    let measured: Vec<Point> = rates.iter().map(|rate| [rate.delta_k_mpa_sqrt_m, rate.da_dn_mm_per_cycle]).collect();
    rates_svg(&measured, &laws, size)
}

/// ΔK, MPa√m, and da/dN, mm/cycle, along a curve of rates.
fn along(curve: &CurveRecord) -> Vec<Point> {
    let (law, [low, high]) = (curve.law(), [0, ROWS - 1].map(|end| curve.delta_k_mpa_sqrt_m[end]));
    let place = |i: usize| low * (high / low).powf(i as f64 / CURVE_POINTS as f64);
    (0..=CURVE_POINTS).map(place).map(|k| [k, law.log_rate(k * MPA_SQRT_M).exp() / MM_PER_CYCLE]).collect()
}
