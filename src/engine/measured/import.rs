//! What a user says about measured files: units, columns by name, the decimal sign, the sheet. Keys of `[measured]`, options of `rates`
//! and fields of the service's form are all read into this.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::error::{Result, input};
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
    /// Decimal signs.
    pub enum Decimal for "measured.decimal" {
        Point = ".": "1234.5",
        Comma = ",": "1234,5",
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

impl Decimal {
    /// The character.
    pub fn sign(self) -> char {
        match self {
            Decimal::Point => '.',
            Decimal::Comma => ',',
        }
    }

    /// Its name in messages.
    pub fn words(self) -> &'static str {
        match self {
            Decimal::Point => "point",
            Decimal::Comma => "comma",
        }
    }

    /// The sign that separates thousands beside it.
    pub fn other(self) -> Decimal {
        match self {
            Decimal::Point => Decimal::Comma,
            Decimal::Comma => Decimal::Point,
        }
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
    pub(super) fn spelled(words: &[&str], like: Unit) -> Option<Unit> {
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

/// What the user says about files of readings; a header that names its own unit must agree.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Import {
    /// Unit of crack length.
    pub length: Option<LengthUnit>,
    /// Unit of cycles.
    pub cycles: Option<CycleUnit>,
    /// Unit of loads.
    pub load: Option<LoadUnit>,
    /// Which column is which.
    pub columns: ColumnNames,
    /// The decimal sign.
    pub decimal: Option<Decimal>,
    /// Sheet of a workbook.
    pub sheet: Option<Sheet>,
    /// Unit of stress intensity, in tables of rates.
    pub intensity: Option<IntensityUnit>,
    /// Unit of da/dN.
    pub rate: Option<RateUnit>,
    /// Whether the file is a table of rates over ΔK.
    pub of_rates: bool,
}

/// A sheet by name, or by number from 1.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(from = "TextOrNumber")]
pub struct Sheet(pub String);

/// Which column is which, by a key and the name in the header, or the number from 1; what is left out is found by the names that
/// laboratories use. Several columns of crack length are readings of one crack on several sides.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(try_from = "BTreeMap<String, OneOrMany>")]
pub struct ColumnNames(Vec<(&'static str, String)>);

impl ColumnNames {
    /// Known keys.
    pub const KEYS: [&'static str; 11] = [
        "cycles",
        "length",
        "specimen",
        "force_max",
        "force_min",
        "force_range",
        "stress_max",
        "stress_min",
        "stress_ratio",
        "delta_k",
        "rate",
    ];

    /// Names a column as `key=name` of the option `--column` does.
    /// Errors: a text without `=`, an unknown key, or a key given twice (crack length may be).
    pub fn put(&mut self, text: &str) -> Result<()> {
        let refuse = |problem: &str| {
            let remedy =
                format!("write --column key=name with one of {}, e.g. --column length=\"a [in]\"", Self::KEYS.join(", "));
            input("--column", format!("\"{text}\""), problem, remedy)
        };
        let (key, name) = text.split_once('=').ok_or_else(|| refuse("has no ="))?;
        let name = name.trim().trim_matches('"');
        if name.is_empty() {
            return Err(refuse("names no column"));
        }
        let key = Self::KEYS.into_iter().find(|known| *known == key.trim());
        let key = key.ok_or_else(|| refuse("has a key that is not known"))?;
        if key != "length" && self.0.iter().any(|(given, _)| *given == key) {
            return Err(refuse("names a column twice"));
        }
        self.0.push((key, name.to_owned()));
        Ok(())
    }

    /// Columns that are named, with their keys; crack lengths last.
    pub(super) fn given(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let keys = Self::KEYS.into_iter().filter(|key| *key != "length").chain(["length"]);
        keys.flat_map(|key| self.0.iter().filter(move |(own, _)| *own == key).map(|(own, name)| (*own, name.as_str())))
    }

    /// Those that are named, without those given by number: a number is there in every table.
    pub(super) fn by_name(&self) -> ColumnNames {
        ColumnNames(self.0.iter().filter(|(_, name)| name.parse::<usize>().is_err()).cloned().collect())
    }

    /// Whether several columns are crack lengths.
    pub(super) fn has_sides(&self) -> bool {
        self.given().filter(|(key, _)| *key == "length").count() > 1
    }
}

impl TryFrom<BTreeMap<String, OneOrMany>> for ColumnNames {
    type Error = String;

    fn try_from(table: BTreeMap<String, OneOrMany>) -> std::result::Result<Self, String> {
        let mut names = Vec::new();
        for (key, columns) in table {
            let known = Self::KEYS.into_iter().find(|known| *known == key);
            let known = known.ok_or_else(|| format!("unknown field `{key}`, expected one of `{}`", Self::KEYS.join("`, `")))?;
            match columns {
                OneOrMany::One(name) => names.push((known, name.into())),
                OneOrMany::Many(several) if key == "length" => names.extend(several.into_iter().map(|name| (known, name.into()))),
                OneOrMany::Many(_) => return Err("a column, expected the name of a column or its number".to_owned()),
            }
        }
        Ok(ColumnNames(names))
    }
}

/// Text, or the number that a name may be.
#[derive(Deserialize)]
#[serde(untagged, expecting = "a name, expected the name of a sheet or its number")]
enum TextOrNumber {
    Text(String),
    Number(u32),
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "columns, expected the name of a column or its number, or a list of them")]
enum OneOrMany {
    One(TextOrNumber),
    Many(Vec<TextOrNumber>),
}

impl From<TextOrNumber> for String {
    fn from(value: TextOrNumber) -> Self {
        match value {
            TextOrNumber::Text(text) => text,
            TextOrNumber::Number(number) => number.to_string(),
        }
    }
}

impl From<TextOrNumber> for Sheet {
    fn from(value: TextOrNumber) -> Self {
        Sheet(value.into())
    }
}
