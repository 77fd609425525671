//! Growth rates da/dN of measured curves, by the two methods of ASTM E647, with its validity flags.
//!
//! - **secant**: `da/dN = Δa / ΔN` between neighbouring readings, at their mean length;
//! - **seven-point incremental polynomial** (appendix X1): a parabola in N through seven neighbouring readings by least
//!   squares; rate and crack length are those of the parabola at the middle reading. The first and last three readings get
//!   no rate.

use nalgebra::{Matrix3, Vector3};

use crate::calibration::measured::MeasuredCurve;
use crate::case::Case;
use crate::line::{Line, line};
use crate::specimen::{LoadMeasure, SpecimenKind, net_section};
use crate::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};

/// Smallest increment of crack length between readings that E647 (8.6.2) asks for, m.
pub const STEP_MIN: f64 = 0.25 * MM;

/// Readings on each side of the middle one of a parabola.
const HALF_SPAN: usize = 3;

crate::kinds! {
    /// How rates are taken from readings.
    pub enum RateMethod for "rates --method" {
        Secant = "secant": "slope between neighbouring readings",
        Polynomial7 = "polynomial7": "seven-point incremental polynomial of ASTM E647, appendix X1",
    }
}

/// Growth rate at one crack length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RatePoint {
    /// Cycles.
    pub cycles: f64,
    /// Crack length (secant: mean of the readings; polynomial: of the parabola), m.
    pub crack_length: f64,
    /// da/dN, m/cycle; not above 0 where readings fall.
    pub rate: f64,
    /// ΔK, Pa√m; NaN where the specimen is not known.
    pub delta_k: f64,
    /// What speaks against the point.
    pub flags: Flags,
}

/// What speaks against a rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Flags {
    /// A step of crack length at this point is under 0.25 mm.
    pub short_step: bool,
    /// The rate is not above 0.
    pub not_growing: bool,
    /// The ligament is too small for its plastic zone.
    pub yielding: bool,
}

impl Flags {
    /// Words of the result files, separated by blanks; empty where nothing speaks against the point.
    #[must_use]
    pub fn words(self) -> String {
        let words =
            [(self.short_step, "step_under_0.25_mm"), (self.not_growing, "not_growing"), (self.yielding, "ligament_yields")];
        words.into_iter().filter(|(set, _)| *set).map(|(_, word)| word).collect::<Vec<_>>().join(" ")
    }
}

/// Rates of a curve by one method; ΔK is NaN until [`add_delta_k`].
#[must_use]
pub fn rates(curve: &MeasuredCurve, method: RateMethod) -> Vec<RatePoint> {
    match method {
        RateMethod::Secant => secant(&curve.cycles, &curve.crack_length),
        RateMethod::Polynomial7 => polynomial7(&curve.cycles, &curve.crack_length),
    }
}

/// Slope between neighbouring readings.
fn secant(n: &[f64], a: &[f64]) -> Vec<RatePoint> {
    (1..n.len())
        .map(|i| point(0.5 * (n[i] + n[i - 1]), 0.5 * (a[i] + a[i - 1]), (a[i] - a[i - 1]) / (n[i] - n[i - 1]), &a[i - 1..=i]))
        .collect()
}

/// Seven-point incremental polynomial: `â = b0 + b1 x + b2 x²`, `x = (N - C1) / C2` scaled to -1..1 over the seven readings.
fn polynomial7(n: &[f64], a: &[f64]) -> Vec<RatePoint> {
    let mut points = Vec::new();
    for middle in HALF_SPAN..n.len().saturating_sub(HALF_SPAN) {
        let seven = middle - HALF_SPAN..=middle + HALF_SPAN;
        let (first, last) = (n[middle - HALF_SPAN], n[middle + HALF_SPAN]);
        let (centre, half) = (0.5 * (first + last), 0.5 * (last - first));
        let basis = |n: f64| {
            let x = (n - centre) / half;
            Vector3::new(1.0, x, x * x)
        };
        let normal: Matrix3<f64> = n[seven.clone()].iter().map(|&n| basis(n) * basis(n).transpose()).sum();
        let right: Vector3<f64> = seven.clone().map(|i| basis(n[i]) * a[i]).sum();
        // Cycles rise strictly, so the seven x differ; only readings crowded at one end could still be singular.
        let Some(b) = normal.try_inverse().map(|inverse| inverse * right) else { continue };
        let x = (n[middle] - centre) / half;
        points.push(point(
            n[middle],
            b[0] + b[1] * x + b[2] * x * x,
            (b[1] + 2.0 * b[2] * x) / half,
            &a[middle - 1..=middle + 1],
        ));
    }
    points
}

/// A point with the flags that need no specimen; `steps` are the readings whose distances count.
fn point(cycles: f64, crack_length: f64, rate: f64, steps: &[f64]) -> RatePoint {
    // A step of exactly 0.25 mm is long enough, also after its conversion to metres.
    let short_step = steps.windows(2).any(|pair| (pair[1] - pair[0]).abs() < STEP_MIN * (1.0 - 1e-6));
    RatePoint {
        cycles,
        crack_length,
        rate,
        delta_k: f64::NAN,
        flags: Flags { short_step, not_growing: rate <= 0.0, yielding: false },
    }
}

/// What ΔK and the validity of a rate depend on; SI.
pub struct TestPiece<'a> {
    /// Shape.
    pub kind: SpecimenKind,
    /// Width W of its test standard.
    pub width: f64,
    /// Thickness B.
    pub thickness: f64,
    /// Largest force of a cycle.
    pub force_max: f64,
    /// K_max over ΔK.
    pub k_max_over_range: f64,
    /// Yield strength, where known.
    pub yield_strength: Option<f64>,
    /// ΔK at a crack length.
    pub delta_k: &'a dyn Fn(f64) -> f64,
}

impl<'a> TestPiece<'a> {
    /// The specimen of a case, with ΔK from `delta_k`.
    #[must_use]
    pub fn of(case: &Case, delta_k: &'a dyn Fn(f64) -> f64) -> Self {
        let specimen = &case.specimen;
        let force_per_load = match specimen.load_measure {
            LoadMeasure::Stress => specimen.width * specimen.thickness,
            LoadMeasure::Force => 1.0,
        };
        TestPiece {
            kind: specimen.kind,
            width: specimen.width,
            thickness: specimen.thickness,
            force_max: case.loading.maximum * force_per_load,
            k_max_over_range: 1.0 / case.loading.range_share(),
            yield_strength: case.material.yield_strength,
            delta_k,
        }
    }
}

/// Fills in ΔK and the flag of small-scale yielding.
pub fn add_delta_k(points: &mut [RatePoint], piece: &TestPiece<'_>) {
    for point in points {
        point.delta_k = (piece.delta_k)(point.crack_length);
        point.flags.yielding = !piece.small_scale_yielding(point.crack_length, point.delta_k * piece.k_max_over_range);
    }
}

impl TestPiece<'_> {
    /// Whether the ligament is large enough, see [`net_section::small_scale_yielding`]. True where the yield strength is not
    /// known.
    #[must_use]
    pub fn small_scale_yielding(&self, crack_length: f64, k_max: f64) -> bool {
        let Some(yield_strength) = self.yield_strength else { return true };
        let force = self.force_max / self.thickness;
        net_section::small_scale_yielding(self.kind, self.width, crack_length, force, k_max, yield_strength)
    }
}

/// Line through log10 da/dN (mm/cycle) over log10 ΔK (MPa√m), points that do not grow left out: `intercept` is log10 C, `slope` m.
#[must_use]
pub fn paris_line(points: &[RatePoint]) -> Option<Line> {
    let usable = || points.iter().filter(|point| point.rate > 0.0 && point.delta_k > 0.0);
    let log_k: Vec<f64> = usable().map(|point| (point.delta_k / MPA_SQRT_M).log10()).collect();
    let log_rate: Vec<f64> = usable().map(|point| (point.rate / MM_PER_CYCLE).log10()).collect();
    line(&log_k, &log_rate)
}
