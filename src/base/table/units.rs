//! Units of the columns of tables, and how tables spell them.

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
        Millimetre = "mm/cycle": "millimetres in a cycle",
        Metre = "m/cycle": "metres in a cycle",
        Inch = "in/cycle": "inches in a cycle",
        Micrometre = "um/cycle": "micrometres in a cycle",
        Nanometre = "nm/cycle": "nanometres in a cycle",
    }
}

/// A unit of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Of crack length.
    Length(LengthUnit),
    /// Of cycles.
    Cycles(CycleUnit),
    /// Of a force or a gross stress.
    Load(LoadUnit),
    /// Of a stress intensity.
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
        UNITS.iter().find(|(unit, ..)| *unit == self).map_or(f64::NAN, |(_, si, _)| *si)
    }

    /// The unit of a quantity, that of `like`, that some lower-case words spell.
    pub fn spelled(words: &[&str], like: Unit) -> Option<Unit> {
        let words = words.join(" ");
        let is_like = |unit: &Unit| std::mem::discriminant(unit) == std::mem::discriminant(&like);
        let found = UNITS.iter().find(|(unit, _, spellings)| is_like(unit) && spellings.split(", ").any(|own| own == words));
        found.map(|(unit, ..)| *unit)
    }

    /// Whether it is one of stress.
    pub fn is_stress(self) -> bool {
        matches!(self, Unit::Load(LoadUnit::Megapascal | LoadUnit::Ksi))
    }
}

/// Pa√m in N/mm^(3/2), 1e6 √1e-3.
const N_PER_MM_1_5: f64 = 31_622.776_601_683_79;

/// Units with their size in SI, or in cycles, and how tables spell them.
const UNITS: [(Unit, f64, &str); 22] = [
    (Unit::Length(LengthUnit::Millimetre), MM, "mm, millimetre, millimeter, millimetres, millimeters"),
    (Unit::Length(LengthUnit::Inch), INCH, "in, inch, inches"),
    (Unit::Length(LengthUnit::Metre), 1.0, "m, metre, meter, metres, meters"),
    (Unit::Cycles(CycleUnit::Cycles), 1.0, "cycles, cycle, cyc, 1, zyklen, count, counts, lw, n"),
    (
        Unit::Cycles(CycleUnit::Kilocycles),
        1e3,
        "kilocycles, kilocycle, kcycles, kcycle, kcyc, kc, k, thousand, thousands, 1000, 1e3, e3, tausend, 10 3",
    ),
    (
        Unit::Cycles(CycleUnit::Megacycles),
        1e6,
        "megacycles, megacycle, mcycles, mcycle, mcyc, million, millions, millionen, 1000000, 1e6, e6, 10 6",
    ),
    (Unit::Load(LoadUnit::Newton), 1.0, "n, newton, newtons"),
    (Unit::Load(LoadUnit::Kilonewton), KN, "kn, kilonewton, kilonewtons"),
    (Unit::Load(LoadUnit::PoundForce), LBF, "lbf, lb, lbs, pounds, pound"),
    (Unit::Load(LoadUnit::Kip), 1e3 * LBF, "kip, kips, klbf, klb, klbs"),
    (Unit::Load(LoadUnit::KilogramForce), KGF, "kgf, kg, kp"),
    (Unit::Load(LoadUnit::Megapascal), MPA, "mpa, n mm2, n mm 2"),
    (Unit::Load(LoadUnit::Ksi), KSI, "ksi"),
    (
        Unit::Intensity(IntensityUnit::MpaSqrtM),
        MPA_SQRT_M,
        "mpa m, mpa sqrt m, mpa sqrtm, mpa root m, mpa m 0 5, mpa m05, mpa m 1 2, mpa m1 2, mpa m½, mpam, mpasqrtm, mpam 0 5, mpam 1 2, \
         mpam1 2, mpam½, mpa sqr m, mn m 3 2, mn m 1 5, mn m3 2",
    ),
    (
        Unit::Intensity(IntensityUnit::KsiSqrtInch),
        KSI * SQRT_INCH,
        "ksi in, ksi inch, ksi sqrt in, ksi sqrtin, ksi sqrt inch, ksi root in, ksi in 0 5, ksi in 1 2, ksi in1 2, ksi in½, ksi inch 0 5, \
         ksi inch 1 2, ksiin, ksisqrtin, ksiin 0 5, ksiin 1 2",
    ),
    (
        Unit::Intensity(IntensityUnit::NewtonMm),
        N_PER_MM_1_5,
        "n mm 3 2, n mm 1 5, n mm3 2, n mm1 5, n mm15, mpa mm, mpa sqrt mm, mpa sqrtmm, mpa mm 0 5, mpa mm 1 2, n mm2 mm, n mm 2 mm",
    ),
    (
        Unit::Intensity(IntensityUnit::KilogramForceMm),
        KGF * N_PER_MM_1_5,
        "kgf mm 3 2, kgf mm 1 5, kgf mm3 2, kgf mm1 5, kgf mm15, kg mm 3 2, kg mm 1 5, kg mm3 2, kg mm1 5, kp mm 3 2",
    ),
    (
        Unit::Rate(RateUnit::Millimetre),
        MM,
        "mm cycle, mm cycles, mm per cycle, mm cyc, mm c, mm lw, mm zyklus, mm lastwechsel, millimetre per cycle, mm cycle 1",
    ),
    (Unit::Rate(RateUnit::Metre), 1.0, "m cycle, m cycles, m per cycle, m cyc, m c, metre per cycle, meter per cycle, m cycle 1"),
    (
        Unit::Rate(RateUnit::Inch),
        INCH,
        "in cycle, in cycles, in per cycle, in cyc, in c, inch cycle, inch cycles, inch per cycle, inches cycle, inches per cycle",
    ),
    (
        Unit::Rate(RateUnit::Micrometre),
        1e-6,
        "um cycle, um cycles, um per cycle, um cyc, micrometre per cycle, micron cycle, microns cycle",
    ),
    (Unit::Rate(RateUnit::Nanometre), 1e-9, "nm cycle, nm cycles, nm per cycle, nm cyc"),
];
