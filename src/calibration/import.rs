//! What a user says about measured files: units, columns by name, the decimal sign, the sheet. Keys of `[measured]`, options of `rates`
//! and fields of the service's form are all read into this.

use serde::{Deserialize, Deserializer};

use crate::calibration::decimal::Decimal;
use crate::error::{Result, input};
use crate::units::{INCH, KGF, KN, KSI, LBF, MM, MPA};

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

impl LengthUnit {
    /// Metres in the unit.
    pub fn metres(self) -> f64 {
        match self {
            LengthUnit::Millimetre => MM,
            LengthUnit::Inch => INCH,
            LengthUnit::Metre => 1.0,
        }
    }
}

impl CycleUnit {
    /// Cycles in the unit.
    pub fn cycles(self) -> f64 {
        match self {
            CycleUnit::Cycles => 1.0,
            CycleUnit::Kilocycles => 1e3,
            CycleUnit::Megacycles => 1e6,
        }
    }
}

impl LoadUnit {
    /// Newtons, or pascals, in the unit.
    pub fn si(self) -> f64 {
        match self {
            LoadUnit::Newton => 1.0,
            LoadUnit::Kilonewton => KN,
            LoadUnit::PoundForce => LBF,
            LoadUnit::Kip => 1e3 * LBF,
            LoadUnit::KilogramForce => KGF,
            LoadUnit::Megapascal => MPA,
            LoadUnit::Ksi => KSI,
        }
    }

    /// Whether it is one of stress.
    pub fn is_stress(self) -> bool {
        matches!(self, LoadUnit::Megapascal | LoadUnit::Ksi)
    }
}

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
}

/// A sheet by name, or by number from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sheet(pub String);

/// A column by its name in the header, or by number from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnName(pub String);

/// Which column is which; what is left out is found by the names that laboratories use.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnNames {
    /// Cycles.
    pub cycles: Option<ColumnName>,
    /// Crack length; several columns are readings of one crack on several sides.
    #[serde(default, deserialize_with = "one_or_many")]
    pub length: Vec<ColumnName>,
    /// Name of the specimen.
    pub specimen: Option<ColumnName>,
    /// Largest force, or stress, of a cycle.
    pub force_max: Option<ColumnName>,
    /// Smallest force, or stress, of a cycle.
    pub force_min: Option<ColumnName>,
    /// Largest less smallest force, or stress, of a cycle.
    pub force_range: Option<ColumnName>,
    /// Largest gross stress of a cycle.
    pub stress_max: Option<ColumnName>,
    /// Smallest gross stress of a cycle.
    pub stress_min: Option<ColumnName>,
    /// Stress ratio.
    pub stress_ratio: Option<ColumnName>,
}

impl ColumnNames {
    /// Keys, in the order of the fields.
    pub const KEYS: [&'static str; 9] =
        ["cycles", "length", "specimen", "force_max", "force_min", "force_range", "stress_max", "stress_min", "stress_ratio"];

    /// Names a column as `key=name` of the option `--column` does.
    ///
    /// # Errors
    /// A text without `=`, an unknown key, or a key given twice (crack length may be).
    pub fn put(&mut self, text: &str) -> Result<()> {
        let refuse = |problem: &str| {
            let remedy =
                format!("write --column key=name with one of {}, e.g. --column length=\"a [in]\"", Self::KEYS.join(", "));
            input("--column", format!("\"{text}\""), problem, remedy)
        };
        let (key, name) = text.split_once('=').ok_or_else(|| refuse("has no ="))?;
        let name = ColumnName(name.trim().trim_matches('"').to_owned());
        if name.0.is_empty() {
            return Err(refuse("names no column"));
        }
        let place = match key.trim() {
            "length" => {
                self.length.push(name);
                return Ok(());
            }
            "cycles" => &mut self.cycles,
            "specimen" => &mut self.specimen,
            "force_max" => &mut self.force_max,
            "force_min" => &mut self.force_min,
            "force_range" => &mut self.force_range,
            "stress_max" => &mut self.stress_max,
            "stress_min" => &mut self.stress_min,
            "stress_ratio" => &mut self.stress_ratio,
            _ => return Err(refuse("has a key that is not known")),
        };
        match place.replace(name) {
            None => Ok(()),
            Some(_) => Err(refuse("names a column twice")),
        }
    }
}

/// Text, or the number that a name may be.
#[derive(Deserialize)]
#[serde(untagged)]
enum TextOrNumber {
    Text(String),
    Number(u32),
}

impl From<TextOrNumber> for String {
    fn from(value: TextOrNumber) -> Self {
        match value {
            TextOrNumber::Text(text) => text,
            TextOrNumber::Number(number) => number.to_string(),
        }
    }
}

impl<'de> Deserialize<'de> for Sheet {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let told = |_| serde::de::Error::custom("a sheet, expected the name of a sheet or its number");
        TextOrNumber::deserialize(deserializer).map(|value| Sheet(value.into())).map_err(told)
    }
}

impl<'de> Deserialize<'de> for ColumnName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let told = |_| serde::de::Error::custom("a column, expected the name of a column or its number");
        TextOrNumber::deserialize(deserializer).map(|value| ColumnName(value.into())).map_err(told)
    }
}

fn one_or_many<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Vec<ColumnName>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum OneOrMany {
        One(ColumnName),
        Many(Vec<ColumnName>),
    }
    let told = |_| serde::de::Error::custom("columns, expected the name of a column or a list of them");
    Ok(match OneOrMany::deserialize(deserializer).map_err(told)? {
        OneOrMany::One(name) => vec![name],
        OneOrMany::Many(names) => names,
    })
}
