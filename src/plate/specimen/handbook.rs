//! Stress intensity factors K(a) of the standard specimens from handbooks, with name, source and range.
//!
//! `K = F σ √(π a)` with gross stress σ, or `K = P / (B √W) f(a/W)` for pins. Sources: Tada, Paris and Irwin, The Stress
//! Analysis of Cracks Handbook, 3rd ed. 2000; Feddersen 1966 (ASTM STP 410); ASTM E647. A table of β that the case names
//! ([`super::beta`]) goes before them.

use std::f64::consts::PI;

use super::{BetaTable, Specimen, SpecimenKind};

/// Plates shorter than this many widths are stiffer or softer than the long strip of the formulas by more than their
/// error (a square plate with a/W = 0.5: 3.00 against 2.83 for a single edge crack).
pub const SHORTEST_LENGTH_OVER_WIDTH: f64 = 1.5;
/// Slack of the range of a formula: 20 mm of 100 mm is 0.2 less a rounding.
const RANGE_SLACK: f64 = 1e-9;
/// A figure over relative crack length.
pub(super) type Curve = fn(f64) -> f64;
/// The factor of K over relative crack length and [`HandbookFormula::shape`].
pub(super) type Factor = fn(f64, f64) -> f64;
/// Error of K, above which a formula is looked at beside others and gives no life.
const ERROR_OF_LIVES: f64 = 0.01;

#[derive(Debug, Clone)]
pub struct HandbookFormula {
    pub name: &'static str,
    pub source: &'static str,
    pub range: &'static str,
    /// Smallest and largest relative crack length it holds for: 2a/W with two tips or two cracks, a/W with one.
    pub bounds: [f64; 2],
    pub(super) of: Factor,
    /// Error over that relative crack length, as its source states it.
    pub(super) error: Curve,
    pub(super) cracks: f64,
    /// Whether it is of a force: `K = P / (B √W) f(a/W)`.
    pub(super) is_of_pins: bool,
    pub(super) width: f64,
    pub(super) thickness: f64,
    /// What else it depends on, over the width: radius of a hole, span of a beam; 0 where that is nothing.
    pub(super) shape: f64,
    /// Relative crack length at which no ligament is left.
    pub(super) limit: f64,
    pub(super) table: Option<BetaTable>,
}

impl PartialEq for HandbookFormula {
    fn eq(&self, other: &Self) -> bool {
        (self.name, self.width, self.thickness, self.shape, &self.table)
            == (other.name, other.width, other.thickness, other.shape, &other.table)
    }
}

/// The formula used for this specimen, `None` where no handbook covers it: `plate`, clamped ends, plates shorter than
/// 1.5 widths, named plates whose formula is good to more than 1 %, and pressure in cracks; a table of β that the case gives covers any plate.
pub fn handbook(specimen: &Specimen) -> Option<HandbookFormula> {
    if specimen.crack_pressure != 0.0 {
        return None;
    }
    if let Some(table) = &specimen.beta {
        return Some(of_table(specimen, table));
    }
    if specimen.kind.is_plate() {
        return specimen.own_formula.clone().filter(|formula| (formula.error)(0.0) <= ERROR_OF_LIVES);
    }
    let long = specimen.length() >= SHORTEST_LENGTH_OVER_WIDTH * specimen.width;
    let cracks = specimen.kind.sharing()?.0;
    let base = HandbookFormula { cracks, ..HandbookFormula::unstated(specimen.width, specimen.thickness) };
    Some(match specimen.kind {
        SpecimenKind::MiddleTension if long => HandbookFormula {
            name: "Feddersen secant",
            source: "Feddersen 1966, ASTM STP 410; ASTM E647 annex A2",
            range: "0.3 % for 2a/W ≤ 0.7, 2 % low at 0.9; length/width ≥ 1.5",
            bounds: [0.0, 0.95],
            of: |x, _| (1.0 / half(x).cos()).sqrt(),
            error: |x| if x <= 0.7 { 0.003 } else { 0.003 + 0.085 * (x - 0.7) },
            ..base
        },
        SpecimenKind::SingleEdgeTension if long && !specimen.has_straight_grips() => HandbookFormula {
            name: "Tada single edge",
            source: "Tada, Paris and Irwin 2000, part II",
            range: "0.5 % for any a/W; ends free to rotate, length/width ≥ 2",
            of: |x, _| tangent(x) * (0.752 + 2.02 * x + 0.37 * (1.0 - half(x).sin()).powi(3)) / half(x).cos(),
            error: |_| 0.005,
            ..base
        },
        SpecimenKind::DoubleEdgeTension if long => HandbookFormula {
            name: "Tada double edge",
            source: "Tada, Paris and Irwin 2000, part II",
            range: "1 % for any 2a/W; length/width ≥ 1.5",
            of: |x, _| (1.0 + 0.122 * half(x).cos().powi(4)) * tangent(x),
            error: |_| 0.01,
            ..base
        },
        SpecimenKind::CompactTension => HandbookFormula {
            name: "ASTM E647 compact",
            source: "ASTM E647 annex A1",
            range: "0.5 % for a/W ≥ 0.2",
            bounds: [0.2, 1.0],
            of: |x, _| {
                let polynomial = 0.886 + x * (4.64 + x * (-13.32 + x * (14.72 - 5.6 * x)));
                (2.0 + x) / (1.0 - x).powf(1.5) * polynomial
            },
            error: |_| 0.005,
            is_of_pins: true,
            ..base
        },
        _ => return None,
    })
}

fn of_table(specimen: &Specimen, table: &BetaTable) -> HandbookFormula {
    let Specimen { width, thickness, .. } = *specimen;
    HandbookFormula {
        name: "table of β",
        source: "specimen.beta_file of the case",
        range: "first to last row",
        bounds: table.bounds().map(|length| length / width),
        table: Some(table.clone()),
        ..HandbookFormula::unstated(width, thickness)
    }
}

/// The formula to set beside other results: also one that is too rough for a life.
pub fn handbook_beside(specimen: &Specimen) -> Option<HandbookFormula> {
    specimen.own_formula.clone().filter(|_| specimen.crack_pressure == 0.0).or_else(|| handbook(specimen))
}

pub(super) fn half(x: f64) -> f64 {
    PI * x / 2.0
}

/// `√(tan(half)/half)`, which tends to 1 for short cracks.
fn tangent(x: f64) -> f64 {
    if half(x) > 0.0 { (half(x).tan() / half(x)).sqrt() } else { 1.0 }
}

/// The other formula for a central crack, 0.1 % for any 2a/W (Tada): for judging the first one.
pub fn handbook_tada(specimen: &Specimen) -> Option<HandbookFormula> {
    let first = handbook(&Specimen { beta: None, ..specimen.clone() })?;
    (specimen.kind == SpecimenKind::MiddleTension).then_some(HandbookFormula {
        name: "Tada central crack",
        source: "Tada, Paris and Irwin 2000, part II",
        range: "0.1 % for any 2a/W; length/width ≥ 1.5",
        bounds: [0.0, 1.0],
        error: |_| 0.001,
        of: |x, _| (1.0 - 0.025 * x.powi(2) + 0.06 * x.powi(4)) * (1.0 / half(x).cos()).sqrt(),
        ..first
    })
}

impl HandbookFormula {
    /// One of a single crack that states nothing yet, for a plate of a width and thickness, m.
    pub(super) fn unstated(width: f64, thickness: f64) -> Self {
        HandbookFormula {
            name: "",
            source: "",
            range: "",
            bounds: [0.0, 1.0],
            of: |_, _| f64::NAN,
            error: |_| f64::NAN,
            cracks: 1.0,
            is_of_pins: false,
            width,
            thickness,
            shape: 0.0,
            limit: 1.0,
            table: None,
        }
    }

    /// K_I at crack length `crack_length` (m, the specimen's convention) under `load_max`: gross stress in Pa, or pin force
    /// in N for C(T). Pa√m; NaN for a length at or beyond the plate's end.
    pub fn k_i(&self, crack_length: f64, load_max: f64) -> f64 {
        if let Some(table) = &self.table {
            return table.k_i(crack_length, load_max);
        }
        let x = self.relative_length(crack_length);
        if !(0.0..1.0).contains(&x) {
            return f64::NAN;
        }
        if self.is_of_pins {
            return load_max / (self.thickness * self.width.sqrt()) * self.factor(crack_length);
        }
        self.factor(crack_length) * load_max * (PI * crack_length).sqrt()
    }

    /// Relative error of K at a crack length, m, as the source of the formula states it; NaN of a table of β.
    pub fn error_at(&self, crack_length: f64) -> f64 {
        (self.error)(self.relative_length(crack_length))
    }

    /// ΔK of a cycle whose largest load is `load_max` and whose counting range is `range_share` times that, Pa√m.
    pub fn delta_k(&self, crack_length: f64, load_max: f64, range_share: f64) -> f64 {
        self.k_i(crack_length, load_max) * range_share
    }

    /// F (tension) or f (C(T)) of the formula, β of a table, dimensionless.
    pub fn factor(&self, crack_length: f64) -> f64 {
        let of_formula = || (self.of)(self.relative_length(crack_length), self.shape);
        self.table.as_ref().map_or_else(of_formula, |table| table.at(crack_length))
    }

    pub fn holds_at(&self, crack_length: f64) -> bool {
        (self.bounds[0] - RANGE_SLACK..=self.bounds[1] + RANGE_SLACK).contains(&self.relative_length(crack_length))
    }

    /// Crack length at which it has no ligament left, m.
    pub fn length_limit(&self) -> f64 {
        self.limit * self.width / self.cracks
    }

    fn relative_length(&self, crack_length: f64) -> f64 {
        self.cracks * crack_length / self.width
    }
}

/// ΔK by the handbook, Pa√m; `None` where there is no formula for the specimen.
pub fn delta_k(specimen: &Specimen, crack_length: f64, load_max: f64, range_share: f64) -> Option<f64> {
    Some(handbook(specimen)?.delta_k(crack_length, load_max, range_share))
}
