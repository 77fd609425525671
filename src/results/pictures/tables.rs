//! Tables of a run read back for its pictures: rows with K and growth of every tip, band, and the ways of the tips.

use std::path::Path;

use crate::csv::{Row, bad_table, parse_a_n};
use crate::units::of_table;
use perilife_base::error::Result;
use perilife_base::units::us::System;

/// Growth and K of a tip over the rows of a curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TipRows {
    /// Growth, mm.
    pub growth_mm: Vec<f64>,
    /// K_I and K_II at maximum load, MPa√m; NaN where nobody read them.
    pub factors: Vec<[f64; 2]>,
}

/// What `a_n.csv` and `crack_path.csv` say.
#[derive(Debug, Clone, PartialEq)]
pub struct RunTables {
    /// The curve.
    pub rows: Vec<Row>,
    /// By tip.
    pub tips: Vec<TipRows>,
    /// Cycles at which 5 and 95 % of specimens have reached the length of a row; `None` without a band.
    pub band: Option<Vec<[f64; 2]>>,
    /// Depth of a crack that did not go through at the start, mm, NaN once it is through; `None` of others.
    pub depths_mm: Option<Vec<f64>>,
    /// Of every tip: cycles, x and y, mm; the far end of its initial crack first.
    pub paths: Vec<Vec<[f64; 3]>>,
}

impl RunTables {
    /// Of the texts of both tables, whose names stand in messages.
    /// Errors: a cell that is not as the run wrote it, by file, line, column and value.
    pub fn read([curve, curve_name]: [&str; 2], [path, path_name]: [&str; 2]) -> Result<Self> {
        let (curve, path) = (of_table(curve, System::Si), of_table(path, System::Si));
        let (curve, path) = (&*curve, &*path);
        let rows = parse_a_n(curve, Path::new(curve_name))?;
        let cells = Cells::of(curve, curve_name);
        let count = (0..).take_while(|tip| cells.has(&format!("tip{tip}_growth_mm"))).count();
        let of_tip = |tip: usize| {
            let column = |what: &str| cells.column(&format!("tip{tip}_{what}"));
            let (first, second) = (column("k_i_mpa_sqrt_m")?, column("k_ii_mpa_sqrt_m")?);
            let factors = first.into_iter().zip(second).map(|(k_i, k_ii)| [k_i, k_ii]).collect();
            Ok(TipRows { growth_mm: column("growth_mm")?, factors })
        };
        let tips = (0..count).map(of_tip).collect::<Result<_>>()?;
        let band = if cells.has("cycles_p05") && cells.has("cycles_p95") {
            let (low, high) = (cells.column("cycles_p05")?, cells.column("cycles_p95")?);
            Some(low.into_iter().zip(high).map(|(low, high)| [low, high]).collect())
        } else {
            None
        };
        let depths_mm = cells.has("crack_depth_mm").then(|| cells.column("crack_depth_mm")).transpose()?;
        Ok(RunTables { rows, tips, band, depths_mm, paths: paths(&Cells::of(path, path_name))? })
    }

    /// Cycles at the end of the curve.
    pub fn life(&self) -> f64 {
        self.rows.last().map_or(0.0, |row| row.cycles)
    }
}

/// A table of numbers.
pub struct Cells<'t> {
    name: &'t str,
    head: Vec<&'t str>,
    lines: Vec<Vec<&'t str>>,
}

impl<'t> Cells<'t> {
    /// Of a text without quoted cells.
    pub fn of(text: &'t str, name: &'t str) -> Self {
        let mut lines = text.lines().map(|line| line.split(',').map(str::trim).collect::<Vec<_>>());
        let head = lines.next().unwrap_or_default();
        Cells { name, head, lines: lines.collect() }
    }

    /// Whether there is a column of that name.
    pub fn has(&self, column: &str) -> bool {
        self.head.contains(&column)
    }

    /// Numbers of a column; NaN in empty cells, and everywhere in a column that is missing.
    /// Errors: a cell that holds something else.
    pub fn column(&self, column: &str) -> Result<Vec<f64>> {
        let Some(place) = self.head.iter().position(|name| *name == column) else { return Ok(vec![f64::NAN; self.lines.len()]) };
        let number = |(line, cells): (usize, &Vec<&str>)| match cells.get(place).copied().unwrap_or("") {
            "" => Ok(f64::NAN),
            cell => cell
                .parse::<f64>()
                .ok()
                .filter(|value| value.is_finite())
                .ok_or_else(|| bad_table(Path::new(self.name), line, Some(column), Some(cell), "is not a number")),
        };
        (2..).zip(&self.lines).map(number).collect()
    }

    /// The same of a column that has to be there, with a number in every row.
    /// Errors: also a column that is missing, and an empty cell.
    pub fn full(&self, column: &str) -> Result<Vec<f64>> {
        let numbers = self.column(column)?;
        if !self.has(column) {
            return Err(bad_table(Path::new(self.name), 1, Some(column), None, "is missing"));
        }
        match numbers.iter().position(|value| value.is_nan()) {
            Some(row) => Err(bad_table(Path::new(self.name), row + 2, Some(column), Some(""), "is not a number")),
            None => Ok(numbers),
        }
    }
}

fn paths(cells: &Cells<'_>) -> Result<Vec<Vec<[f64; 3]>>> {
    let [tips, cycles, x, y] = [cells.full("tip")?, cells.full("cycles")?, cells.full("x_mm")?, cells.full("y_mm")?];
    let mut paths: Vec<Vec<[f64; 3]>> = Vec::new();
    for (row, tip) in tips.iter().enumerate() {
        // Tips are written one after the other.
        let known = paths.len() as f64;
        if *tip == known {
            paths.push(Vec::new());
        } else if *tip != known - 1.0 {
            let cell = tip.to_string();
            return Err(bad_table(Path::new(cells.name), row + 2, Some("tip"), Some(&cell), "does not follow the tip above it"));
        }
        if let Some(path) = paths.last_mut() {
            path.push([cycles[row], x[row], y[row]]);
        }
    }
    Ok(paths)
}
