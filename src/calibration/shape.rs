//! How the specimens of a table are laid out, column by column.

use crate::calibration::decimal::Holds;
use crate::calibration::pairs::Pair;

/// A column with what its numbers are multiplied by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Place in the header, from 0.
    pub index: usize,
    /// SI units, or cycles, in the unit of the column.
    pub factor: f64,
}

/// Loads of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoadColumns {
    /// Largest load of a cycle.
    pub maximum: Option<Column>,
    /// Smallest load of a cycle.
    pub minimum: Option<Column>,
    /// Largest less smallest load of a cycle.
    pub range: Option<Column>,
    /// Smallest over largest.
    pub ratio: Option<Column>,
    /// Whether they are gross stresses, else forces.
    pub is_stress: bool,
}

/// How specimens are laid out.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// One row a reading.
    Long {
        /// Column of the specimen's name.
        specimen: Option<usize>,
        /// Cycles.
        cycles: Column,
        /// Crack length; of several the mean counts.
        lengths: Vec<Column>,
        /// Readings of the same crack on several sides.
        sides: Vec<Column>,
        /// Loads.
        loads: LoadColumns,
    },
    /// First column crack length, then one column of cycles per specimen.
    WideCycles(Column, Vec<Column>),
    /// First column cycles, then one column of crack length per specimen.
    WideLengths(Column, Vec<Column>),
    /// Two columns per specimen.
    Paired(Vec<Pair>),
}

impl Shape {
    /// The key of `measured.columns` that each of some columns has; empty for one that is not read or is a specimen of a wide table.
    pub fn keys(&self, columns: usize) -> Vec<&'static str> {
        let mut keys = vec![""; columns];
        let mut give = |column: usize, key| keys[column] = key;
        match self {
            Shape::Long { specimen, cycles, lengths, loads, .. } => {
                give(cycles.index, "cycles");
                lengths.iter().for_each(|length| give(length.index, "length"));
                specimen.iter().for_each(|column| give(*column, "specimen"));
                let loads = [
                    (loads.maximum, "force_max"),
                    (loads.minimum, "force_min"),
                    (loads.range, "force_range"),
                    (loads.ratio, "stress_ratio"),
                ];
                loads.into_iter().for_each(|(column, key)| column.iter().for_each(|column| give(column.index, key)));
            }
            Shape::WideCycles(length, _) => give(length.index, "length"),
            Shape::WideLengths(cycles, _) => give(cycles.index, "cycles"),
            Shape::Paired(pairs) => pairs.iter().for_each(|pair| {
                give(pair.cycles.index, "cycles");
                give(pair.length.index, "length");
            }),
        }
        keys
    }

    /// Columns of numbers and what they hold.
    pub(crate) fn numbers(&self) -> Vec<(usize, Holds)> {
        let cycles = |column: &Column| (column.index, if column.factor == 1.0 { Holds::Counts } else { Holds::Measures });
        let measure = |column: &Column| (column.index, Holds::Measures);
        match self {
            Shape::Long { cycles: counted, lengths, sides, loads, .. } => {
                // Forces in N and lbf have thousands, those in kN and stresses in MPa hardly.
                let load = |column: &Column| {
                    let small = loads.is_stress || column.factor >= 1e3;
                    (column.index, if small { Holds::Measures } else { Holds::Counts })
                };
                let loads_of = [loads.maximum, loads.minimum, loads.range];
                let all = lengths.iter().chain(sides).map(measure).chain(loads_of.iter().flatten().map(load));
                std::iter::once(cycles(counted)).chain(all).chain(loads.ratio.iter().map(measure)).collect()
            }
            Shape::WideCycles(length, specimens) => {
                std::iter::once(measure(length)).chain(specimens.iter().map(cycles)).collect()
            }
            Shape::WideLengths(counted, specimens) => {
                std::iter::once(cycles(counted)).chain(specimens.iter().map(measure)).collect()
            }
            Shape::Paired(pairs) => pairs.iter().flat_map(|pair| [cycles(&pair.cycles), measure(&pair.length)]).collect(),
        }
    }

    /// Metres and cycles in the units of their columns, the first of each.
    pub(crate) fn units(&self) -> (f64, f64) {
        let first = |columns: &[Column]| columns.first().map_or(f64::NAN, |column| column.factor);
        match self {
            Shape::Long { cycles, lengths, .. } => (first(lengths), cycles.factor),
            Shape::WideCycles(length, specimens) => (length.factor, first(specimens)),
            Shape::WideLengths(cycles, specimens) => (first(specimens), cycles.factor),
            Shape::Paired(pairs) => (pairs[0].length.factor, pairs[0].cycles.factor),
        }
    }
}
