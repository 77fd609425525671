//! Growth rates da/dN of measured curves, by the two methods of ASTM E647, with its validity flags.
//!
//! - **secant**: `da/dN = Δa / ΔN` between neighbouring readings, at their mean length;
//! - **seven-point incremental polynomial** (appendix X1): a parabola in N through seven neighbouring readings by least
//!   squares; rate and crack length are those of the parabola at the middle reading. The first and last three readings get
//!   no rate. Seven readings have to have one load: where it changes, the rates are secants.
//!
//! ΔK of every rate, and the validity that depends on the specimen, follow from the case ([`add_delta_k`]).
//!
//! Below 1e-5 mm/cycle, in K-decreasing tests, steps count down to ten times the precision of a reading, as the user says it or as readings scatter.

use std::ops::RangeInclusive;

use nalgebra::{Matrix3, Vector3};

use perilife_base::columns::Table;
use perilife_base::linear_fit::{Line, line};
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_measured::{MeasuredCurve, side_difference_max};

/// Smallest increment of crack length between readings that E647 (8.6.2) asks for, m.
pub const STEP_MIN: f64 = 0.25 * MM;
/// Rates below which a test is one to the threshold, m/cycle.
const SLOW: f64 = 1e-5 * MM_PER_CYCLE;
/// Steepest fall of ln K over the crack length in a K-decreasing test, 1/m, with room for its steps.
const GRADIENT_MIN: f64 = -0.08 * 1.05 / MM;
/// Readings on each side of the middle one of a parabola.
const HALF_SPAN: usize = 3;
pub const HEADER: &str = "specimen,cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,flags,stress_ratio\n";

perilife_base::kinds! {
    /// How rates are taken from readings.
    pub enum RateMethod for "rates --method" {
        Secant = "secant": "secant (point-to-point), ASTM E647",
        Polynomial7 = "polynomial7": "seven-point incremental polynomial of ASTM E647, appendix X1",
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RatePoint {
    pub cycles: f64,
    /// Crack length (secant: mean of the readings; polynomial: of the parabola), m.
    pub crack_length: f64,
    /// da/dN, m/cycle; not above 0 where readings fall.
    pub rate: f64,
    /// ΔK, Pa√m; NaN where the specimen is not known.
    pub delta_k: f64,
    pub load_factor: f64,
    /// Stress ratio R; NaN where the readings do not say it ([`add_delta_k`]).
    pub ratio: f64,
    /// Largest difference of crack length between sides at the readings of the point, m.
    pub side_difference: f64,
    pub flags: Flags,
}

impl RatePoint {
    /// A rate of which nothing else is known: ΔK, Pa√m, da/dN, m/cycle, and R.
    pub fn of_rate(delta_k: f64, rate: f64, ratio: f64) -> Self {
        let (cycles, crack_length) = (f64::NAN, f64::NAN);
        RatePoint { cycles, crack_length, rate, delta_k, load_factor: 1.0, ratio, side_difference: 0.0, flags: Flags::default() }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Flags {
    /// A step of crack length at this point is under 0.25 mm, or near the threshold under ten times the precision of a reading.
    pub short_step: bool,
    pub not_growing: bool,
    pub yielding: bool,
    /// The crack front is too uneven: the lengths on the sides differ by more than E647 accepts.
    pub uneven_front: bool,
    /// K falls faster over the crack length than in a valid K-decreasing test.
    pub k_gradient: bool,
    /// The rate is a secant, since the load changes within seven readings; nothing speaks against it.
    pub load_changes: bool,
}

impl Flags {
    /// Whether anything speaks against the point.
    pub fn any(self) -> bool {
        Flags { load_changes: false, ..self } != Flags::default()
    }

    /// Words of the result files, separated by blanks; empty where there is nothing to say about the point.
    pub fn words(self) -> String {
        let words = [
            (self.short_step, "step_under_0.25_mm"),
            (self.not_growing, "not_growing"),
            (self.yielding, "ligament_yields"),
            (self.uneven_front, "uneven_front"),
            (self.k_gradient, "k_gradient"),
            (self.load_changes, "load_changes"),
        ];
        words.into_iter().filter(|(set, _)| *set).map(|(_, word)| word).collect::<Vec<_>>().join(" ")
    }
}

/// Rates of a curve by one method, without steps that are left out; ΔK is NaN until
/// [`add_delta_k`].
pub fn rates(curve: &MeasuredCurve, method: RateMethod) -> Vec<RatePoint> {
    let factors = curve.step_factors();
    let curve = &MeasuredCurve { precision: curve.precision.or_else(|| Some(curve.scatter())), ..curve.clone() };
    match method {
        RateMethod::Secant => (1..curve.cycles.len()).filter_map(|i| secant(curve, &factors, i)).collect(),
        RateMethod::Polynomial7 => {
            // A step gets a secant of its own where a change of load spoils every parabola around it.
            let by_polynomial = (0..curve.cycles.len()).filter_map(|i| polynomial7(curve, i));
            let mut points: Vec<RatePoint> = by_polynomial.collect();
            let by_secant = (1..curve.cycles.len()).filter(|&i| in_changing_load(curve, i));
            points.extend(by_secant.filter_map(|i| secant(curve, &factors, i)).map(|mut point| {
                point.flags.load_changes = true;
                point
            }));
            points.sort_by(|a, b| a.cycles.total_cmp(&b.cycles));
            points
        }
    }
}

fn secant(curve: &MeasuredCurve, factors: &[(f64, f64)], i: usize) -> Option<RatePoint> {
    let (n, a) = (&curve.cycles, &curve.crack_length);
    curve.counts(i).then(|| RatePoint {
        load_factor: 0.5 * (factors[i].0 + factors[i].1),
        ..point(curve, 0.5 * (n[i] + n[i - 1]), 0.5 * (a[i] + a[i - 1]), (a[i] - a[i - 1]) / (n[i] - n[i - 1]), i - 1..=i)
    })
}

/// Whether the load changes near the growth up to a reading, so that neither it nor the reading before is the middle of seven readings of
/// one load.
fn in_changing_load(curve: &MeasuredCurve, i: usize) -> bool {
    let last = curve.cycles.len() - 1;
    let around = i.saturating_sub(HALF_SPAN + 1)..=(i + HALF_SPAN).min(last);
    let has_window = |middle: usize| middle >= HALF_SPAN && middle + HALF_SPAN <= last && holds(curve, middle);
    !curve.holds_load(around) && !has_window(i) && !has_window(i - 1)
}

/// Whether seven readings have one load and none of their steps is left out.
fn holds(curve: &MeasuredCurve, middle: usize) -> bool {
    let seven = middle - HALF_SPAN..=middle + HALF_SPAN;
    curve.holds_load(seven.clone()) && seven.skip(1).all(|step| curve.counts(step))
}

/// Seven-point incremental polynomial: `â = b0 + b1 x + b2 x²`, `x = (N - C1) / C2` scaled to -1..1 over the seven readings.
pub(super) fn polynomial7(curve: &MeasuredCurve, middle: usize) -> Option<RatePoint> {
    let (n, a) = (&curve.cycles, &curve.crack_length);
    if middle < HALF_SPAN || middle + HALF_SPAN >= n.len() || !holds(curve, middle) {
        return None;
    }
    let seven = middle - HALF_SPAN..=middle + HALF_SPAN;
    let (first, last) = (n[middle - HALF_SPAN], n[middle + HALF_SPAN]);
    // Cycles of a computed curve stand still where noise lets a length fall.
    if n[seven.clone()].windows(2).any(|pair| pair[1] <= pair[0]) {
        return None;
    }
    let (centre, half) = (0.5 * (first + last), 0.5 * (last - first));
    let basis = |n: f64| {
        let x = (n - centre) / half;
        Vector3::new(1.0, x, x * x)
    };
    let normal: Matrix3<f64> = n[seven.clone()].iter().map(|&n| basis(n) * basis(n).transpose()).sum();
    let right: Vector3<f64> = seven.clone().map(|i| basis(n[i]) * a[i]).sum();
    // Cycles rise strictly, so the seven x differ; only readings crowded at one end could still be singular.
    let b = normal.try_inverse().map(|inverse| inverse * right)?;
    let x = (n[middle] - centre) / half;
    let (length, rate) = (b[0] + b[1] * x + b[2] * x * x, (b[1] + 2.0 * b[2] * x) / half);
    let mean_factor = curve.load_factor.get(seven).map_or(1.0, |factors| factors.iter().sum::<f64>() / factors.len() as f64);
    Some(RatePoint { load_factor: mean_factor, ..point(curve, n[middle], length, rate, middle - 1..=middle + 1) })
}

/// A point with the flags that need no specimen; `readings` are those whose distances count.
fn point(curve: &MeasuredCurve, cycles: f64, crack_length: f64, rate: f64, readings: RangeInclusive<usize>) -> RatePoint {
    // A step of exactly 0.25 mm is long enough, also after its conversion to metres.
    let slow = curve.precision.filter(|_| rate < SLOW).map_or(STEP_MIN, |precision| STEP_MIN.min(10.0 * precision));
    let steps = curve.crack_length[readings.clone()].windows(2);
    let short_step = steps.into_iter().any(|pair| (pair[1] - pair[0]).abs() < slow * (1.0 - 1e-6));
    RatePoint {
        cycles,
        crack_length,
        rate,
        delta_k: f64::NAN,
        load_factor: 1.0,
        ratio: mean_ratio(curve, readings.clone()),
        side_difference: curve.side_difference.get(readings).map_or(0.0, |of| of.iter().copied().fold(0.0, f64::max)),
        flags: Flags { short_step, not_growing: rate <= 0.0, ..Flags::default() },
    }
}

fn mean_ratio(curve: &MeasuredCurve, readings: RangeInclusive<usize>) -> f64 {
    let of = curve.loads.as_ref().and_then(|loads| loads.ratio.get(readings));
    of.map_or(f64::NAN, |ratios| ratios.iter().sum::<f64>() / ratios.len() as f64)
}

/// Share of rates, a tenth, that a line needs to stand for all.
const SHARE_OF_LINE: usize = 10;

/// Line through log10 da/dN (mm/cycle) over log10 ΔK (MPa√m): `intercept` is log10 C, `slope` m. Rates that carry a flag are left out; short
/// steps alone are no reason as long as every rate grows, since then noise is small beside them. `None` where fewer than a tenth are left:
/// of those that grow by chance a line would be flat.
pub fn paris_line(points: &[RatePoint]) -> Option<Line> {
    let is_noisy = points.iter().any(|point| point.flags.not_growing);
    let belongs = |point: &&RatePoint| !Flags { short_step: point.flags.short_step && is_noisy, ..point.flags }.any();
    let usable = || points.iter().filter(belongs).filter(|point| point.rate > 0.0 && point.delta_k > 0.0);
    if usable().count() * SHARE_OF_LINE < points.len() {
        return None;
    }
    let log_k: Vec<f64> = usable().map(|point| (point.delta_k / MPA_SQRT_M).log10()).collect();
    let log_rate: Vec<f64> = usable().map(|point| (point.rate / MM_PER_CYCLE).log10()).collect();
    line(&log_k, &log_rate)
}

/// Fills in ΔK, by that of the load of the case (Pa√m) at a length (m), and the flags that depend on its specimen.
pub fn add_delta_k(points: &mut [RatePoint], case: &Case, delta_k: &dyn Fn(f64) -> f64) {
    let (specimen, loading) = (&case.specimen, &case.loading);
    let uneven = side_difference_max(specimen.kind, specimen.width, specimen.thickness);
    for point in points.iter_mut() {
        point.delta_k = delta_k(point.crack_length) * point.load_factor;
        point.ratio = if point.ratio.is_nan() { loading.ratio } else { point.ratio };
        let (load, k_max) = (loading.maximum * point.load_factor, point.delta_k / loading.range_share());
        let holds = |strength| specimen.small_scale_yielding(point.crack_length, load, k_max, strength);
        point.flags.yielding = !case.material.yield_strength.is_none_or(holds);
        point.flags.uneven_front = point.side_difference > uneven;
    }
    // K that falls from rate to rate, by its line over seven of them; one lower load among others is none of a K-decreasing test.
    for middle in 0..points.len() {
        let around = &points[middle.saturating_sub(HALF_SPAN)..points.len().min(middle + HALF_SPAN + 1)];
        let falls = around.len() > 2 && around.windows(2).all(|pair| pair[1].delta_k < pair[0].delta_k);
        let (lengths, log_k): (Vec<f64>, Vec<f64>) = around.iter().map(|point| (point.crack_length, point.delta_k.ln())).unzip();
        points[middle].flags.k_gradient = falls && line(&lengths, &log_k).is_some_and(|line| line.slope < GRADIENT_MIN);
    }
}

/// ΔK_th, MPa√m, and what is to be said of it: ΔK at 1e-7 mm/cycle by the line of log ΔK over log da/dN that E647 takes through at least five rates
/// from there to 1e-6 mm/cycle. `rates` are ΔK, MPa√m, and da/dN, mm/cycle.
pub fn threshold(rates: impl Iterator<Item = (f64, f64)>) -> Option<(f64, String)> {
    let slow = rates.filter(|(k, rate)| *k > 0.0 && (1e-7..1e-6).contains(rate));
    let (log_rate, log_k): (Vec<f64>, Vec<f64>) = slow.map(|(k, rate)| (rate.log10(), k.log10())).unzip();
    let line = line(&log_rate, &log_k).filter(|_| log_k.len() >= 5)?;
    let (k, count) = (10_f64.powf(line.intercept - 7.0 * line.slope), log_k.len());
    let words = format!(
        "ΔK_th = {k:.3} MPa√m at 1e-7 mm/cycle (ASTM E647 line through {count} rates); for a law without a threshold set \
         fatigue.delta_k_threshold_mpa_sqrt_m"
    );
    Some((k, words))
}

/// A table of rates, each with its specimen, that [`perilife_measured::RateFile`] reads back:
/// `specimen,cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,flags,stress_ratio`; cells are empty where nothing is known.
pub fn table<'a>(rows: impl Iterator<Item = (&'a str, &'a RatePoint)>) -> Table {
    let rows: Vec<(&str, &RatePoint)> = rows.collect();
    let column = |of: fn(&RatePoint) -> f64| rows.iter().map(move |(_, point)| Some(of(point)).filter(|value| value.is_finite()));
    Table::new("rates.csv")
        .foreign("specimen", rows.iter().map(|(specimen, _)| specimen))
        .measured("cycles", column(|point| point.cycles))
        .measured("crack_length_mm", column(|point| point.crack_length / MM))
        .measured("delta_k_mpa_sqrt_m", column(|point| point.delta_k / MPA_SQRT_M))
        .measured("da_dn_mm_per_cycle", column(|point| point.rate / MM_PER_CYCLE))
        .words("flags", rows.iter().map(|(_, point)| point.flags.words()))
        .measured("stress_ratio", column(|point| point.ratio))
}
