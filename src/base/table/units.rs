//! Units of the columns of tables, and how tables spell them.

use std::collections::HashMap;
use std::sync::LazyLock;

use super::words::{COLUMNS, words};
use crate::units::{INCH, KGF, KN, KSI, LBF, MM, MPA, MPA_SQRT_M, SQRT_INCH};

crate::kinds! {
    /// Units of crack length in measured files.
    pub enum LengthUnit for "measured.length_unit" {
        Millimetre = "mm": "millimetres",
        Inch = "inch": "inches of 25.4 mm",
        Metre = "m": "metres",
    }
}

crate::kinds! {
    /// Units of cycles in measured files.
    pub enum CycleUnit for "measured.cycle_unit" {
        Cycles = "cycles": "single cycles",
        Kilocycles = "kilocycles": "thousands of cycles",
        Megacycles = "megacycles": "millions of cycles",
    }
}

crate::kinds! {
    /// Units of loads in measured files.
    pub enum LoadUnit for "measured.load_unit" {
        Newton = "N": "newtons",
        Kilonewton = "kN": "kilonewtons",
        PoundForce = "lbf": "pounds-force of 4.448 N",
        Kip = "kip": "thousands of pounds-force",
        KilogramForce = "kgf": "kilograms-force of 9.807 N",
        Megapascal = "MPa": "gross stress in megapascals",
        Ksi = "ksi": "gross stress in thousands of pounds-force per square inch",
    }
}

crate::kinds! {
    /// Units of stress intensity in tables of rates.
    pub enum IntensityUnit for "measured.intensity_unit" {
        MpaSqrtM = "MPa sqrt(m)": "MPa√m",
        KsiSqrtInch = "ksi sqrt(in)": "ksi√in, 1.0988 MPa√m",
        NewtonMm = "N/mm^1.5": "N/mm^(3/2), 0.03162 MPa√m",
        KilogramForceMm = "kgf/mm^1.5": "kgf/mm^(3/2), 0.3101 MPa√m",
    }
}

crate::kinds! {
    /// Units of da/dN in tables of rates.
    pub enum RateUnit for "measured.rate_unit" {
        Millimetre = "mm/cycle": "millimeters per cycle",
        Metre = "m/cycle": "meters per cycle",
        Inch = "in/cycle": "inches per cycle",
        Micrometre = "um/cycle": "micrometers per cycle",
        Nanometre = "nm/cycle": "nanometers per cycle",
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    Length(LengthUnit),
    Cycles(CycleUnit),
    /// Of a force or a gross stress.
    Load(LoadUnit),
    Intensity(IntensityUnit),
    /// Of da/dN.
    Rate(RateUnit),
}

impl Unit {
    /// Name in input files.
    pub fn name(self) -> &'static str {
        match self {
            Unit::Length(unit) => unit.name(),
            Unit::Cycles(unit) => unit.name(),
            Unit::Load(unit) => unit.name(),
            Unit::Intensity(unit) => unit.name(),
            Unit::Rate(unit) => unit.name(),
        }
    }

    /// Metres, cycles, newtons, pascals, Pa√m or m/cycle in the unit.
    pub fn si(self) -> f64 {
        UNITS.iter().find(|(unit, _)| *unit == self).map_or(f64::NAN, |(_, si)| *si)
    }

    /// The unit of a quantity, that of `like`, that some lower-case words spell.
    pub fn spelled(words: &[String], like: Unit) -> Option<Unit> {
        let is_like = |unit: &&Unit| std::mem::discriminant(*unit) == std::mem::discriminant(&like);
        SPELLINGS.get(&words.join(" "))?.iter().find(is_like).copied()
    }

    /// Names of the units of its quantity.
    pub fn alternatives(self) -> Vec<&'static str> {
        let is_like = |unit: &Unit| std::mem::discriminant(unit) == std::mem::discriminant(&self);
        UNITS.iter().map(|(unit, _)| *unit).filter(is_like).map(Unit::name).collect()
    }

    /// Whether lower-case words spell a unit of any quantity.
    pub(super) fn is_known(words: &str) -> bool {
        SPELLINGS.contains_key(words)
    }

    pub fn is_stress(self) -> bool {
        matches!(self, Unit::Load(LoadUnit::Megapascal | LoadUnit::Ksi))
    }
}

/// Pa√m in N/mm^(3/2), 1e6 √1e-3.
const N_PER_MM_1_5: f64 = 31_622.776_601_683_79;

/// Units by how tables spell them; no unit for those of quantities that are not read.
static SPELLINGS: LazyLock<HashMap<String, Vec<Unit>>> = LazyLock::new(|| {
    let mut spellings: HashMap<String, Vec<Unit>> = HashMap::new();
    for (name, forms) in COLUMNS.get("units").and_then(|units| units.as_table()).into_iter().flatten() {
        let unit = UNITS.iter().map(|(unit, _)| *unit).find(|unit| unit.name() == name);
        for form in forms.as_str().unwrap_or_default().split(',') {
            spellings.entry(words(form).0.join(" ")).or_default().extend(unit);
        }
    }
    spellings
});

/// Units with their size in SI, or in cycles.
const UNITS: [(Unit, f64); 22] = [
    (Unit::Length(LengthUnit::Millimetre), MM),
    (Unit::Length(LengthUnit::Inch), INCH),
    (Unit::Length(LengthUnit::Metre), 1.0),
    (Unit::Cycles(CycleUnit::Cycles), 1.0),
    (Unit::Cycles(CycleUnit::Kilocycles), 1e3),
    (Unit::Cycles(CycleUnit::Megacycles), 1e6),
    (Unit::Load(LoadUnit::Newton), 1.0),
    (Unit::Load(LoadUnit::Kilonewton), KN),
    (Unit::Load(LoadUnit::PoundForce), LBF),
    (Unit::Load(LoadUnit::Kip), 1e3 * LBF),
    (Unit::Load(LoadUnit::KilogramForce), KGF),
    (Unit::Load(LoadUnit::Megapascal), MPA),
    (Unit::Load(LoadUnit::Ksi), KSI),
    (Unit::Intensity(IntensityUnit::MpaSqrtM), MPA_SQRT_M),
    (Unit::Intensity(IntensityUnit::KsiSqrtInch), KSI * SQRT_INCH),
    (Unit::Intensity(IntensityUnit::NewtonMm), N_PER_MM_1_5),
    (Unit::Intensity(IntensityUnit::KilogramForceMm), KGF * N_PER_MM_1_5),
    (Unit::Rate(RateUnit::Millimetre), MM),
    (Unit::Rate(RateUnit::Metre), 1.0),
    (Unit::Rate(RateUnit::Inch), INCH),
    (Unit::Rate(RateUnit::Micrometre), 1e-6),
    (Unit::Rate(RateUnit::Nanometre), 1e-9),
];
