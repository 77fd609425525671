//! Units of the columns of tables, and how tables spell them.

use std::collections::HashMap;
use std::sync::LazyLock;

use super::words::{COLUMNS, words};
use crate::units::{INCH, KGF, KN, KSI, LBF, MM, MPA, MPA_SQRT_M, SQRT_INCH};

/// Declares the units of every quantity: names in input files with their size in SI, or in cycles, and their meaning.
macro_rules! units {
    ($($(#[$doc:meta])* $Quantity:ident($Kind:ident) for $key:literal { $($Unit:ident = $name:literal, $si:expr, $meaning:literal;)+ })+) => {
        crate::kinds! { $( pub enum $Kind for $key { $($Unit = $name: $meaning),+ } )+ }

        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Unit { $($(#[$doc])* $Quantity($Kind)),+ }

        const UNITS: &[(Unit, f64)] = &[$($((Unit::$Quantity($Kind::$Unit), $si)),+),+];

        impl Unit {
            pub fn name(self) -> &'static str { match self { $(Unit::$Quantity(unit) => unit.name()),+ } }
        }
    };
}

units! {
    Length(LengthUnit) for "measured.length_unit" {
        Millimetre = "mm", MM, "millimetres";
        Inch = "inch", INCH, "inches of 25.4 mm";
        Metre = "m", 1.0, "metres";
    }
    Cycles(CycleUnit) for "measured.cycle_unit" {
        Cycles = "cycles", 1.0, "single cycles";
        Kilocycles = "kilocycles", 1e3, "thousands of cycles";
        Megacycles = "megacycles", 1e6, "millions of cycles";
    }
    /// Of a force or a gross stress.
    Load(LoadUnit) for "measured.load_unit" {
        Newton = "N", 1.0, "newtons";
        Kilonewton = "kN", KN, "kilonewtons";
        PoundForce = "lbf", LBF, "pounds-force of 4.448 N";
        Kip = "kip", 1e3 * LBF, "thousands of pounds-force";
        KilogramForce = "kgf", KGF, "kilograms-force of 9.807 N";
        Megapascal = "MPa", MPA, "gross stress in megapascals";
        Ksi = "ksi", KSI, "gross stress in thousands of pounds-force per square inch";
    }
    Intensity(IntensityUnit) for "measured.intensity_unit" {
        MpaSqrtM = "MPa sqrt(m)", MPA_SQRT_M, "MPa√m";
        KsiSqrtInch = "ksi sqrt(in)", KSI * SQRT_INCH, "ksi√in, 1.0988 MPa√m";
        NewtonMm = "N/mm^1.5", N_PER_MM_1_5, "N/mm^(3/2), 0.03162 MPa√m";
        KilogramForceMm = "kgf/mm^1.5", KGF * N_PER_MM_1_5, "kgf/mm^(3/2), 0.3101 MPa√m";
    }
    /// Of da/dN.
    Rate(RateUnit) for "measured.rate_unit" {
        Millimetre = "mm/cycle", MM, "millimeters per cycle";
        Metre = "m/cycle", 1.0, "meters per cycle";
        Inch = "in/cycle", INCH, "inches per cycle";
        Micrometre = "um/cycle", 1e-6, "micrometers per cycle";
        Nanometre = "nm/cycle", 1e-9, "nanometers per cycle";
    }
}

impl Unit {
    /// Metres, cycles, newtons, pascals, Pa√m or m/cycle in the unit.
    pub fn si(self) -> f64 {
        UNITS.iter().find(|(unit, _)| *unit == self).map_or(f64::NAN, |(_, si)| *si)
    }

    /// The unit of a quantity, that of `like`, that some lower-case words spell.
    pub fn spelled(words: &[String], like: Unit) -> Option<Unit> {
        let is_like = |unit: &&Unit| std::mem::discriminant(*unit) == std::mem::discriminant(&like);
        SPELLINGS.get(&words.join(" "))?.iter().find(is_like).copied()
    }

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
