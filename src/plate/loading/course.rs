//! A load that follows the crack: its size over crack length, as in tests with a K gradient (ASTM E647, 8.3: K = K₀ exp(C (a - a₀))).

use std::fmt;

use toml::Value;

use perilife_base::error::{Result, input};
use perilife_base::input::{Quantity, number_of};
use perilife_base::keys::{Field, Key, Shape, refuse};
use perilife_base::units::{MM, round_mm};

const CRACK_LENGTH: Quantity = Quantity { what: "a crack length", unit: "mm", low: 0.0, high: 1e5, si: MM };
/// Relative difference between lengths that are equal but for round-off.
const SAME: f64 = 1e-9;
/// Share of the load by which a straight line may miss the next row of the table: beyond it the row is a corner.
const CORNER: f64 = 0.01;

/// How large a load is, in the unit of its key.
#[derive(Debug, Clone, PartialEq)]
pub enum Size {
    One(f64),
    /// Crack length, mm, and load.
    Rows(Vec<[f64; 2]>),
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = |[length, load]: &[f64; 2]| format!("[{length}, {load}]");
        match self {
            Size::One(load) => load.fmt(f),
            Size::Rows(rows) => match &rows[..] {
                [first, _, .., last] => write!(f, "[{}, ..., {}]", row(first), row(last)),
                few => write!(f, "[{}]", few.iter().map(row).collect::<String>()),
            },
        }
    }
}

impl Field for Size {
    const SHAPE: Shape = Shape::Other("a number, or rows [crack length, load] such as [[20, 3000], [30, 4000]]");
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        let row = |row: &Value| match row.as_array().map(Vec::as_slice) {
            Some([length, load]) => Some([number_of(length)?, number_of(load)?]),
            _ => None,
        };
        let rows = || value.as_array()?.iter().map(row).collect::<Option<Vec<_>>>().map(Size::Rows);
        number_of(value).map(Size::One).or_else(rows).map_or_else(|| refuse(key, path, value, Self::SHAPE), Ok)
    }
}

impl Size {
    /// The load in SI units, that at the initial crack length, m, where it follows the crack.
    pub(super) fn read(&self, key: &str, quantity: Quantity, crack_length: f64) -> Result<(f64, Option<LoadCourse>)> {
        let rows = match self {
            Size::One(load) => return Ok((quantity.read(key, *load)?, None)),
            Size::Rows(rows) => rows,
        };
        let read = |(i, [length, load]): (usize, &[f64; 2])| {
            let at = |column: usize| format!("{key}[{i}][{column}]");
            Ok([CRACK_LENGTH.read(&at(0), *length)?, quantity.read(&at(1), *load)?])
        };
        let all = rows.iter().enumerate().map(read).collect::<Result<Vec<_>>>()?;
        if let Some(i) = (1..all.len()).find(|i| all[*i][0] <= all[i - 1][0]) {
            let problem = format!("is not above the crack length {} mm of the row before", rows[i - 1][0]);
            return Err(input(&format!("{key}[{i}][0]"), rows[i][0], problem, "sort the rows by crack length, each length once"));
        }
        let start = round_mm(crack_length);
        let (first, last) = (all.first().map_or(f64::NAN, |row| row[0]), all.last().map_or(f64::NAN, |row| row[0]));
        if !(first <= crack_length * (1.0 + SAME) && last > crack_length * (1.0 + SAME)) {
            let problem = format!("does not include the initial crack length {start} mm");
            let remedy = format!("give a row at or below {start} mm and one above it, up to the end of growth");
            return Err(input(key, self, problem, remedy));
        }
        let course = LoadCourse { key: key.to_owned(), rows: all };
        let load = course.at(crack_length);
        let of_start = |[length, size]: &[f64; 2]| [*length, size / load];
        Ok((load, Some(LoadCourse { rows: course.rows.iter().map(of_start).collect(), ..course })))
    }
}

/// Load of a cycle over that at the initial crack length, by crack length: linear between rows, beyond them that of the nearest row.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadCourse {
    /// Key of the table, `loading.force_max_n`.
    pub key: String,
    /// Crack length in the convention of the specimen, m, and load.
    rows: Vec<[f64; 2]>,
}

impl LoadCourse {
    /// Load at a crack length, m.
    pub fn at(&self, crack_length: f64) -> f64 {
        let above = self.rows.partition_point(|row| row[0] < crack_length).clamp(1, self.rows.len() - 1);
        line(self.rows[above - 1], self.rows[above], crack_length.clamp(self.rows[0][0], self.end()))
    }

    /// Last crack length of the table, m.
    pub fn end(&self) -> f64 {
        self.rows[self.rows.len() - 1][0]
    }

    /// The next crack length, m, at which the load turns a corner.
    pub fn corner_after(&self, crack_length: f64) -> Option<f64> {
        let beyond = |row: [f64; 2]| [2.0 * row[0], row[1]];
        let is_corner = |place: &usize| {
            let (before, row) = (self.rows[place - 1], self.rows[*place]);
            let next = self.rows.get(place + 1).copied().unwrap_or(beyond(row));
            (line(before, row, next[0]) / next[1] - 1.0).abs() > CORNER
        };
        let ahead = (1..self.rows.len()).filter(|place| self.rows[*place][0] > crack_length * (1.0 + SAME));
        ahead.filter(is_corner).map(|place| self.rows[place][0]).next()
    }
}

/// Load at a crack length on the straight line through two rows.
fn line([a, low]: [f64; 2], [b, high]: [f64; 2], at: f64) -> f64 {
    low + (at - a) / (b - a) * (high - low)
}
