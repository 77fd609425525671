//! Tables of da/dN over ΔK and R, as laboratories, handbooks and `perilife rates` write them.
//!
//! ΔK is that of ASTM E647 in this program: the tensile part of the range, ΔK = (1 - max(R, 0)) K_max. Many tables have the full range
//! (1 - R) K_max, which at R < 0 is another number: which of them is meant has to be said there.

use std::path::Path;

use super::columns::column_in_unit;
use super::exclusion_flags::{counts, rejected};
use super::header::columns_of;
use super::import::{ColumnNames, Import};
use super::leave_out::table_of;
use super::readings::value;
use super::wide_rates;
use perilife_base::error::{Result, input_missing};
use perilife_base::input::{Folder, number};
use perilife_base::keys::{Field, Key, Shape, Value, key, refuse, section};
use perilife_base::table::decimal::decide;
use perilife_base::table::names::{Column, Named, Role};
use perilife_base::table::units::{IntensityUnit, RateUnit, Unit};
use perilife_base::table::{Decimal, Fault, Row, Sheet, Table, whole_file};
use perilife_base::units::MM_PER_CYCLE;
use perilife_plate::loading::SAME_RATIO;

perilife_base::kinds! {
    /// What of a cycle from R K_max to K_max is ΔK in a table of rates where R is negative; at R >= 0 both are (1-R) K_max. Laws take its
    /// tensile part.
    pub enum RangeKind for "measured.delta_k" {
        Tensile = "tensile": "ΔK = K_max for R < 0 (ASTM E647)",
        Full = "full": "ΔK = (1-R) K_max (NASGRO, many laboratories)",
    }
}

const HARMLESS: &str = "load_changes";

#[derive(Debug, Clone, PartialEq)]
pub struct RateRow {
    /// Test it belongs to: its file, and the specimen where the file names one. Rows of a test follow each other.
    pub series: String,
    pub place: String,
    pub line: usize,
    /// Tensile ΔK, Pa√m.
    pub delta_k: f64,
    /// da/dN, m/cycle.
    pub rate: f64,
    pub ratio: f64,
}

impl RateRow {
    /// K_max, Pa√m.
    pub fn k_max(&self) -> f64 {
        self.delta_k / (1.0 - self.ratio.max(0.0))
    }

    /// ln of the rate in mm/cycle.
    pub fn log_rate(&self) -> f64 {
        (self.rate / MM_PER_CYCLE).ln()
    }
}

/// Rates of a table, names and units of its columns of ΔK and da/dN, and how many of its rows are left out by a flag of `perilife rates`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RateTable {
    pub rows: Vec<RateRow>,
    pub flagged: usize,
    pub warnings: Vec<String>,
    pub columns: [String; 2],
    pub says_ratio: bool,
    pub units: [&'static str; 2],
    /// Which ΔK the rows at negative R were said to have; `None` where there are none.
    pub range: Option<RangeKind>,
}

/// A table of rates in an input file: its name, or with what it does not say itself.
#[derive(Debug, Clone)]
pub enum RateFile {
    Name(String),
    Keys(Box<RateFileKeys>),
}

impl Field for RateFile {
    const SHAPE: Shape = Shape::Other("the name of a file or { file = \"...\", stress_ratio = ..., ... }");
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        match value {
            Value::String(name) => Ok(RateFile::Name(name.clone())),
            Value::Table(_) => section(value, path).map(|keys| RateFile::Keys(Box::new(keys))),
            _ => refuse(key, path, value, Self::SHAPE),
        }
    }
}

perilife_base::keys! {
    /// What a user says of a table of rates.
    #[derive(Debug, Clone, Default)]
    pub struct RateFileKeys {
        file: String = key("file", "File of rates");
        stress_ratio: Option<f64> = key("stress_ratio", "Stress ratio R: of all rows");
        intensity_unit: Option<IntensityUnit> = key("intensity_unit", "Unit of ΔK");
        rate_unit: Option<RateUnit> = key("rate_unit", "Unit of da/dN");
        delta_k: Option<RangeKind> = key("delta_k", "ΔK at negative R");
        columns: ColumnNames = COLUMNS, or "found by their names" ColumnNames::default();
        decimal: Option<Decimal> = DECIMAL;
        sheet: Option<Sheet> = SHEET;
    }
}

pub const COLUMNS: Key = key("columns", "Columns: by their names or numbers");
pub const DECIMAL: Key = key("decimal", "Decimal sign");
pub const SHEET: Key = key("sheet", "Sheet of a workbook: its name or number");

impl RateFile {
    pub fn keys(&self) -> RateFileKeys {
        match self {
            RateFile::Name(file) => RateFileKeys { file: file.clone(), ..RateFileKeys::default() },
            RateFile::Keys(keys) => (**keys).clone(),
        }
    }
}

impl RateFileKeys {
    /// Reads the table of a folder; `key` names it in messages.
    pub fn read(&self, folder: &Folder, key: &str) -> Result<(RateTable, Vec<u8>)> {
        if let Some(ratio) = self.stress_ratio {
            number("a stress ratio below 1", -100.0, 0.999).read(key, ratio)?;
        }
        let bytes = folder.read(&self.file)?;
        let table = read(&bytes, &folder.path(&self.file), self)?;
        Ok((table, bytes))
    }
}

/// Reads a table.
/// Errors: a table without the columns or their units, cells that are no numbers or none of growth, a stress ratio given twice, rows at
/// R < 0 of which the range is not said.
pub fn read(bytes: &[u8], file: &Path, keys: &RateFileKeys) -> Result<RateTable> {
    let import = Import {
        columns: keys.columns.clone(),
        decimal: keys.decimal,
        sheet: keys.sheet.clone(),
        intensity: keys.intensity_unit,
        rate: keys.rate_unit,
        of_rates: true,
        ..Import::default()
    };
    let wide = wide_rates::as_table(bytes, file).transpose()?;
    let mut cells = table_of(wide.as_ref().map_or(bytes, |text| text.as_bytes()), file, &import)?;
    wide_rates::below_each_other(&mut cells, &import);
    let columns = columns_of(&cells.header, &cells.names, &import);
    let of = |role: Role| {
        let mut own = columns.iter().copied().filter(move |column| column.role == role);
        let first = own.next();
        match own.next() {
            Some(second) => {
                let remedy = "select one by { file = \"...\", columns = { delta_k = \"...\", rate = \"...\" } }";
                Err(cells.header_fault(second.index).error("duplicates an earlier column", remedy))
            }
            None => Ok(first),
        }
    };
    let (delta_k, k_max, k_min) = (of(Role::DeltaK)?, of(Role::KMax)?, of(Role::KMin)?);
    let (ratio, specimen) = (of(Role::Ratio)?, of(Role::Specimen)?);
    let says_range = k_min.is_some() || ratio.is_some() || keys.stress_ratio.is_some();
    let (Some(k), Some(rate)) = (delta_k.or(k_max.filter(|_| says_range)), of(Role::Rate)?) else {
        return Err(without_columns(&cells));
    };
    let like = Unit::Intensity(IntensityUnit::MpaSqrtM);
    let of_k = |column: Column| column_in_unit(&cells, column, "intensity_unit", like, keys.intensity_unit.map(Unit::Intensity));
    let in_unit = |column: Option<Column>| column.map(of_k).transpose();
    let (k, delta_k, k_max, k_min) = (of_k(k)?, in_unit(delta_k)?, in_unit(k_max)?, in_unit(k_min)?);
    let like = Unit::Rate(RateUnit::Millimetre);
    let rate = column_in_unit(&cells, rate, "rate_unit", like, keys.rate_unit.map(Unit::Rate))?;
    if let (Some(column), Some(given)) = (ratio, keys.stress_ratio) {
        let problem = format!("is a column, and stress_ratio = {given} is set for the file");
        return Err(cells.header_fault(column.index).error(problem, "remove one of them"));
    }
    let flags = cells.header.iter().position(|name| name == "flags");
    let read: Vec<Column> = [rate].into_iter().chain(delta_k).chain(k_max).chain(k_min).chain(ratio).collect();
    let decimal = decide(&cells, &read.iter().map(Column::numbers).collect::<Vec<_>>(), keys.decimal)?;

    leave_censored_out(&mut cells, k, rate)?;
    let known = read.iter().chain(&specimen).map(|column| column.index).chain(flags);
    let remarks = rejected(&cells, &known.collect::<Vec<_>>());
    let unit = |column: Column| if let Named::Is(unit) = column.unit { unit.name() } else { "" };
    let mut table = RateTable {
        columns: [k, rate].map(|column| cells.header[column.index].clone()),
        warnings: cells.warnings().into_iter().chain(remarks).collect(),
        says_ratio: says_range || k_max.is_some(),
        units: [unit(k), unit(rate)],
        ..RateTable::default()
    };
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    for row in &cells.rows {
        let speaks_against = |word: &str| word != HARMLESS && counts(word, true) != Some(true);
        if flags.is_some_and(|flags| row.cell(flags).split_whitespace().any(speaks_against)) {
            table.flagged += 1;
            continue;
        }
        let above_zero = |column: Column| {
            if column.role == Role::DeltaK && row.cell(column.index).is_empty() {
                let remedy = "give ΔK in every row: `perilife rates --specimen CASE.toml` computes it";
                return Err(cells.cell_fault(row, column.index).error("is empty", remedy));
            }
            let size = value(&cells, row, column, decimal)?;
            let remedy = "remove rows without growth; name logarithms as such, for example log10 da/dN (mm/cycle)";
            if size > 0.0 { Ok(size) } else { Err(cells.cell_fault(row, column.index).error("is not above zero", remedy)) }
        };
        let of = |column: Option<Column>| column.map(|column| value(&cells, row, column, decimal)).transpose();
        let [delta_k, k_max] = [delta_k.map(above_zero).transpose()?, k_max.map(above_zero).transpose()?];
        let said = of(ratio)?.or(keys.stress_ratio);
        let (of_row, tensile) = cycle([delta_k, k_max, of(k_min)?], said, keys.delta_k);
        if let (Some(said), (ratio, _)) = (said, cycle([delta_k, k_max, of(k_min)?], None, keys.delta_k))
            && k_max.is_some()
            && (delta_k.is_some() || k_min.is_some())
            && (said - ratio).abs() > SAME_RATIO
            && (said >= 0.0 || ratio.abs() > SAME_RATIO)
        {
            let problem = format!("gives a stress ratio of {ratio:.3}; the row has {said}");
            return Err(cells.cell_fault(row, k.index).error(problem, "correct the row, or remove one of the columns"));
        }
        if of_row >= 1.0 {
            let fault = cells.cell_fault(row, ratio.or(k_min).unwrap_or(k).index);
            return Err(fault.error("is not a stress ratio below 1", "give K_min over K_max"));
        }
        table.rows.push(RateRow {
            // R that follows from K scatters.
            series: match (specimen, said) {
                (Some(column), _) => format!("{name}, {}", row.cell(column.index)),
                (None, Some(_)) => format!("{name}, R {of_row}"),
                (None, None) => format!("{name}, R {:.2}", 0.02 * (of_row / 0.02).round()),
            },
            place: format!("{}: line {}", file.display(), row.line),
            line: row.line,
            delta_k: tensile,
            rate: above_zero(rate)?,
            ratio: of_row,
        });
    }
    if table.flagged > 0 {
        let (of, file) = (table.flagged + table.rows.len(), file.display());
        table.warnings.push(format!("rates: {file}: {} of {of} flagged rates excluded", table.flagged));
    }
    if k_max.is_some() {
        return Ok(table);
    }
    if let Some(row) = table.rows.iter().find(|row| row.ratio < 0.0) {
        let Some(range) = keys.delta_k else {
            let fault = Fault { line: Some(row.line), key: Some("delta_k"), ..whole_file(file) };
            let problem = format!("R = {}: is ΔK the full range (1 − R) K_max or K_max (ASTM E647)?", row.ratio);
            let remedy = "set delta_k = \"full\" (NASGRO and many laboratories) or \"tensile\" (ASTM E647, `perilife rates`)";
            return Err(fault.error(problem, remedy));
        };
        table.range = Some(range);
    }
    Ok(table)
}

/// R and tensile ΔK of what a row says of ΔK, K_max and K_min, Pa√m, and R: two say all. R that follows from K has four digits; where K_max is known
/// it is clear what ΔK is at R < 0.
fn cycle([delta_k, k_max, k_min]: [Option<f64>; 3], ratio: Option<f64>, range: Option<RangeKind>) -> (f64, f64) {
    let of_range = |(delta_k, k_min): (f64, f64)| {
        let is_full = k_min >= 0.0 || range == Some(RangeKind::Full);
        if is_full { delta_k + k_min } else { delta_k }
    };
    let k_max = k_max.or(delta_k.zip(k_min).map(of_range));
    let least = k_min.or(k_max.zip(delta_k).map(|(k_max, range)| k_max - range));
    let of_k = k_max.zip(least).map(|(k_max, k_min)| (k_min / k_max * 1e4).round() / 1e4);
    let ratio = ratio.or(of_k).unwrap_or(0.0);
    let tensile = match (k_max, delta_k) {
        (Some(k_max), Some(_)) if ratio < 0.0 => k_max,
        (Some(k_max), None) => k_max - k_min.unwrap_or(ratio * k_max).max(0.0),
        (_, Some(full)) if ratio < 0.0 && range == Some(RangeKind::Full) => full / (1.0 - ratio),
        (_, delta_k) => delta_k.unwrap_or(f64::NAN),
    };
    (ratio, tensile)
}

/// Leaves rows out whose rate was too small to be measured, `<1e-8`, `ND`, `run-out`: bounds of the threshold.
fn leave_censored_out(cells: &mut Table, k: Column, rate: Column) -> Result<()> {
    const WORDS: &str = "nd nm bdl bld lod blod loq runout notdetected nondetect nogrowth arrest arrested belowdetection \
                         belowdetectionlimit belowlimit";
    let is_censored = |row: &Row| {
        let cell = row.cell(rate.index);
        let word: String = cell.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
        cell.starts_with(['<', '≤']) || WORDS.split_whitespace().any(|known| known == word)
    };
    let Some(first) = cells.rows.iter().find(|row| is_censored(row)) else { return Ok(()) };
    let [name, of_k, rate] = [&cells.header[k.index], first.cell(k.index), first.cell(rate.index)];
    let why = format!("below the measurable rate, first at {name} = {of_k}: {rate}");
    cells.leave_out(&why, "their ΔK is a lower bound of the threshold", is_censored)
}

fn without_columns(table: &Table) -> perilife_base::error::Error {
    let names = table.header.join(",");
    let fault = Fault { file: &table.file, line: Some(table.header_line.max(1)), key: Some("header"), value: Some(&names) };
    fault.error(
        "has no columns delta_k_mpa_sqrt_m and da_dn_mm_per_cycle",
        "name them so, or as ΔK (MPa√m) and da/dN (mm/cycle), and stress_ratio; or assign them by { file = \"...\", columns = \
         { delta_k = \"...\", rate = \"...\" } }; `perilife rates` writes such a table from a-N readings",
    )
}

pub fn lacks_ratio(file: &str, key: &str) -> perilife_base::error::Error {
    let remedy = format!("add a column stress_ratio, or write {{ file = \"{file}\", stress_ratio = ... }}");
    input_missing(key, "is not a column, and no stress_ratio is set for the file", remedy)
}
