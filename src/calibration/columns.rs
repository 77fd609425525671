//! What the columns of a measured file mean: long or wide layout, and in which units.

use crate::calibration::text_table::{Fault, TextTable};
use crate::units::{INCH, MM};

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

impl LengthUnit {
    /// Metres in the unit.
    #[must_use]
    pub fn metres(self) -> f64 {
        match self {
            LengthUnit::Millimetre => MM,
            LengthUnit::Inch => INCH,
            LengthUnit::Metre => 1.0,
        }
    }

    /// Ending of column names in this unit, with aliases.
    fn endings(self) -> &'static [&'static str] {
        match self {
            LengthUnit::Millimetre => &["mm", "millimetre", "millimeter"],
            LengthUnit::Inch => &["inch", "in", "inches"],
            LengthUnit::Metre => &["m", "metre", "meter"],
        }
    }
}

impl CycleUnit {
    /// Cycles in the unit.
    #[must_use]
    pub fn cycles(self) -> f64 {
        match self {
            CycleUnit::Cycles => 1.0,
            CycleUnit::Kilocycles => 1e3,
            CycleUnit::Megacycles => 1e6,
        }
    }
}

/// Units that the calibration file names (`[measured] length_unit`, `cycle_unit`); a header that names its own must agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Units {
    /// Unit of crack length.
    pub length: Option<LengthUnit>,
    /// Unit of cycles.
    pub cycles: Option<CycleUnit>,
}

/// What the columns of one file are.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// How specimens are laid out.
    pub shape: Shape,
    /// Metres per unit of a length cell.
    pub length_unit: f64,
    /// Cycles per unit of a cycles cell.
    pub cycle_unit: f64,
    /// Whether `7,5` is a number.
    pub decimal_comma: bool,
}

/// How specimens are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// One row a reading.
    Long {
        /// Column of the specimen's name.
        specimen: Option<usize>,
        /// Column of cycles.
        cycles: usize,
        /// Column of crack length.
        length: usize,
    },
    /// First column crack length, then one column of cycles per specimen.
    WideCycles,
    /// First column cycles, then one column of crack length per specimen.
    WideLengths,
}

const KNOWN: &str = "known are specimen, cycles (kilocycles, megacycles) and crack_length_mm (crack_length_inch, crack_length_m); \
                     a wide table starts with one of the two and has at least two columns of specimens";

/// Meaning of one column name; a unit is `None` where the name does not say it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Meaning {
    Specimen,
    Cycles(Option<CycleUnit>),
    Length(Option<LengthUnit>),
    Unknown,
}

/// Recognises the layout of a table by its header.
pub(crate) fn recognise(table: &TextTable, units: Units) -> crate::Result<Layout> {
    let meanings: Vec<Meaning> = table.header.iter().map(|name| meaning(name)).collect();
    let place = |wanted: fn(&Meaning) -> bool| meanings.iter().position(wanted);
    let cycles = place(|meaning| matches!(meaning, Meaning::Cycles(_)));
    let length = place(|meaning| matches!(meaning, Meaning::Length(_)));
    let specimen = place(|meaning| matches!(meaning, Meaning::Specimen));
    let unknown = place(|meaning| matches!(meaning, Meaning::Unknown));
    let decimal_comma = table.decimal_comma;
    refuse_repeated(table)?;
    match (cycles, length) {
        (Some(cycles), Some(length)) => {
            if let Some(column) = unknown {
                return Err(unknown_column(table, column));
            }
            let twice = (0..meanings.len()).find(|&column| column != cycles && column != length && Some(column) != specimen);
            if let Some(column) = twice {
                return Err(header_fault(table, column)
                    .error("says the same as an earlier column", "keep one column of cycles and one of crack length"));
            }
            let length_unit = length_unit(table, length, meanings[length], units)?;
            let cycle_unit = cycle_unit(table, cycles, meanings[cycles], units)?;
            Ok(Layout { shape: Shape::Long { specimen, cycles, length }, length_unit, cycle_unit, decimal_comma })
        }
        (None, Some(0)) if meanings.len() >= 3 && specimen.is_none() => {
            let length_unit = length_unit(table, 0, meanings[0], units)?;
            let cycle_unit = units.cycles.unwrap_or(CycleUnit::Cycles).cycles();
            Ok(Layout { shape: Shape::WideCycles, length_unit, cycle_unit, decimal_comma })
        }
        (Some(0), None) if meanings.len() >= 3 && specimen.is_none() => {
            let cycle_unit = cycle_unit(table, 0, meanings[0], units)?;
            let Some(unit) = units.length else {
                return Err(header_fault(table, 1).error(
                    "does not say the unit of its crack lengths",
                    "set measured.length_unit = \"mm\", \"inch\" or \"m\"",
                ));
            };
            Ok(Layout { shape: Shape::WideLengths, length_unit: unit.metres(), cycle_unit, decimal_comma })
        }
        _ => Err(match unknown {
            Some(column) => unknown_column(table, column),
            None => header_fault(table, 0).error(
                if cycles.is_none() {
                    "stands in a header without a column of cycles"
                } else {
                    "stands in a header without a column of crack length"
                },
                KNOWN,
            ),
        }),
    }
}

/// Meaning of a column name, whatever its case, blanks and brackets.
fn meaning(name: &str) -> Meaning {
    let lower = name.to_lowercase();
    let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    match words.as_slice() {
        ["specimen"] | ["specimen", "id" | "name"] => Meaning::Specimen,
        ["cycles"] | ["n", "cycles"] => Meaning::Cycles(None),
        ["kilocycles" | "kcycles"] | ["n" | "cycles", "kilocycles" | "kcycles"] => Meaning::Cycles(Some(CycleUnit::Kilocycles)),
        ["megacycles" | "mcycles"] | ["n" | "cycles", "megacycles" | "mcycles"] => Meaning::Cycles(Some(CycleUnit::Megacycles)),
        ["crack", "length"] => Meaning::Length(None),
        ["crack", "length", unit] | ["a", unit] => {
            match LengthUnit::ALL.iter().copied().find(|known| known.endings().contains(unit)) {
                Some(unit) => Meaning::Length(Some(unit)),
                None => Meaning::Unknown,
            }
        }
        _ => Meaning::Unknown,
    }
}

/// Two columns of the same name cannot be told apart.
fn refuse_repeated(table: &TextTable) -> crate::Result<()> {
    for (column, name) in table.header.iter().enumerate() {
        if table.header[..column].iter().any(|earlier| earlier.eq_ignore_ascii_case(name)) {
            return Err(header_fault(table, column).error("names two columns", "give every column its own name"));
        }
    }
    Ok(())
}

fn length_unit(table: &TextTable, column: usize, meaning: Meaning, units: Units) -> crate::Result<f64> {
    let Meaning::Length(named) = meaning else { return Err(unknown_column(table, column)) };
    match (named, units.length) {
        (Some(named), Some(given)) if named != given => Err(header_fault(table, column).error(
            format!("is in {named}, but measured.length_unit says {given}"),
            "name the unit in one place, or the same in both",
        )),
        (Some(unit), _) | (None, Some(unit)) => Ok(unit.metres()),
        (None, None) => Err(header_fault(table, column).error(
            "does not say its unit",
            "name it crack_length_mm, crack_length_inch or crack_length_m, or set measured.length_unit",
        )),
    }
}

fn cycle_unit(table: &TextTable, column: usize, meaning: Meaning, units: Units) -> crate::Result<f64> {
    let Meaning::Cycles(named) = meaning else { return Err(unknown_column(table, column)) };
    match (named, units.cycles) {
        (Some(named), Some(given)) if named != given => Err(header_fault(table, column).error(
            format!("is in {named}, but measured.cycle_unit says {given}"),
            "name the unit in one place, or the same in both",
        )),
        (Some(unit), _) | (None, Some(unit)) => Ok(unit.cycles()),
        (None, None) => Ok(CycleUnit::Cycles.cycles()),
    }
}

fn unknown_column(table: &TextTable, column: usize) -> crate::Error {
    header_fault(table, column).error("is not a known column", KNOWN)
}

fn header_fault(table: &TextTable, column: usize) -> Fault<'_> {
    let name = table.header[column].as_str();
    Fault {
        file: &table.file,
        line: Some(table.header_line),
        key: Some("header"),
        value: Some(if name.is_empty() { "\"\"" } else { name }),
    }
}
