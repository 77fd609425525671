//! Data frames by polars: wide and long form, pointwise quantiles of many specimens, joins, Parquet and CSV.
//!
//! Knows: polars, and nothing else does.
//! Must not know: what stands in a frame.
//!
//! Imports `base`.
//!
//! The only module that names polars (feature `tables`, on by default), below all rooms that have something to put in
//! a frame. Nothing a fit or a prediction needs goes through here; it serves many specimens at once and whoever goes on with
//! the results elsewhere. Columns carry their units, as in all result files.

mod pages;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use polars::prelude::*;

use perilife_base::cells::{CELLS_MAX, SMALLER, TEXT_MAX, UNPACKED_MAX, defused, too_many};
use perilife_base::error::{Error, InputError, Result};
use perilife_base::units::unmistakable;

pub use polars;
pub use polars::prelude::{Column, DataFrame};

/// Name of the column of crack length, mm.
pub const LENGTH: &str = "crack_length_mm";
/// Name of the column of specimens.
pub const SPECIMEN: &str = "specimen";
/// Name of the column of cycles.
pub const CYCLES: &str = "cycles";

/// Most rows of a table of readings.
const ROWS_MAX: usize = 1_000_000;

/// Cells of a stored table as text, which is what a checking reader wants to see.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    /// Column names.
    pub header: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
}

/// Wide to long: the first column stays, every other becomes rows of `specimen` (its name), `cycles` and the first column;
/// empty cells are left out.
pub fn wide_to_long(wide: &DataFrame) -> Result<DataFrame> {
    let Some((length, specimens)) = wide.columns().split_first() else { return frame(Vec::new()) };
    let mut long: Option<DataFrame> = None;
    for specimen in specimens {
        let mut cycles = specimen.clone();
        cycles.rename(CYCLES.into());
        let name = Column::new_scalar(SPECIMEN.into(), Scalar::from(specimen.name().clone()), wide.height());
        let present = cycles.as_materialized_series().is_not_null();
        let part = frame(vec![name, cycles, length.clone()])?.filter(&present).map_err(trouble)?;
        long = Some(match long {
            None => part,
            // In place: a copy for every specimen would copy all the ones before.
            Some(mut all) => {
                all.vstack_mut(&part).map_err(trouble)?;
                all
            }
        });
    }
    long.map_or_else(|| frame(Vec::new()), Ok)
}

/// Quantiles of `cycles` at equal `crack_length_mm` of a long table: `crack_length_mm,cycles_p05,cycles_p50,...` for shares
/// such as 0.05 and 0.5, linear between specimens (definition 7 of Hyndman and Fan 1996, The American Statistician 50:361).
pub fn quantiles(long: &DataFrame, shares: &[f64]) -> Result<DataFrame> {
    let groups = long.partition_by_stable([LENGTH], true).map_err(trouble)?;
    let mut lengths = Vec::with_capacity(groups.len());
    let mut columns: Vec<Vec<Option<f64>>> = vec![Vec::with_capacity(groups.len()); shares.len()];
    for group in &groups {
        let length = group.column(LENGTH).and_then(|column| column.get(0)).map_err(trouble)?;
        lengths.push(length.try_extract::<f64>().map_err(trouble)?);
        let cycles = group.column(CYCLES).map_err(trouble)?;
        for (&share, column) in shares.iter().zip(&mut columns) {
            let quantile = cycles.quantile_reduce(share, QuantileMethod::Linear).map_err(trouble)?;
            column.push(quantile.value().try_extract::<f64>().ok());
        }
    }
    let mut all = vec![Column::new(LENGTH.into(), lengths)];
    for (share, column) in shares.iter().zip(columns) {
        all.push(Column::new(format!("cycles_p{:02.0}", 100.0 * share).into(), column));
    }
    frame(all)
}

/// Rows of `left` with the columns of `right` for the same `specimen` (left join).
pub fn join_by_specimen(left: &DataFrame, right: &DataFrame) -> Result<DataFrame> {
    left.left_join(right, [SPECIMEN], [SPECIMEN]).map_err(trouble)
}

/// The table as the bytes of a Parquet file.
pub fn parquet(table: &DataFrame) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // Uncompressed: the tables are small, and every reader understands it without a compression library.
    let writer = ParquetWriter::new(&mut bytes).with_compression(ParquetCompression::Uncompressed);
    writer.finish(&mut table.clone()).map_err(trouble)?;
    Ok(bytes)
}

/// The table as the bytes of a CSV file, numbers with all their digits, text that no spreadsheet runs ([`defused`]).
pub fn csv(table: &DataFrame) -> Result<Vec<u8>> {
    let columns = table.columns().iter().map(|column| {
        let text = column.str().map(|text| text.apply_values(defused).into_column());
        let mut column = text.unwrap_or_else(|_| column.clone());
        column.rename(defused(column.name()).into_owned().into());
        column
    });
    let mut bytes = Vec::new();
    CsvWriter::new(&mut bytes).finish(&mut frame(columns.collect())?).map_err(trouble)?;
    Ok(bytes)
}

/// Reads the bytes of a Parquet file; `path` is only named in messages.
/// Errors: bytes that are none; a table that would become larger than [`perilife_base::cells`] allows, before it does.
pub fn read_parquet(bytes: &[u8], path: &Path) -> Result<Cells> {
    let refused = |problem: String, remedy: &str| {
        let (file, remedy) = (Some(path.to_path_buf()), remedy.to_owned());
        Error::Input(Box::new(InputError { file, problem, remedy, ..InputError::default() }))
    };
    let broken = |error: PolarsError| refused(format!("is not a Parquet table ({error})"), "give a Parquet or a CSV file");
    let too_large = |what: &str, count: usize, most: usize| Err(refused(too_many(what, count, most), SMALLER));
    let unreadable = |what: &'static str| broken(PolarsError::ComputeError(what.into()));
    if !pages::has_whole_footer(bytes) {
        return Err(unreadable("its footer is cut off"));
    }
    let mut reader = ParquetReader::new(std::io::Cursor::new(bytes));
    // A file of a few bytes can stand for any number of equal rows.
    let rows = reader.num_rows().map_err(broken)?;
    if rows > ROWS_MAX {
        return Err(broken(PolarsError::ComputeError(format!("{rows} rows are more than {ROWS_MAX}").into())));
    }
    let groups = &reader.get_metadata().map_err(broken)?.row_groups;
    let columns = groups.iter().map(|group| group.parquet_columns().len()).max().unwrap_or(0);
    if rows.saturating_mul(columns) > CELLS_MAX {
        return too_large("cells", rows.saturating_mul(columns), CELLS_MAX);
    }
    // The footer need not say what the pages hold.
    let chunks = groups.iter().flat_map(|group| group.parquet_columns());
    let chunks =
        chunks.map(|chunk| [chunk.dictionary_page_offset().unwrap_or(chunk.data_page_offset()), chunk.compressed_size()]);
    let pages = pages::sums(bytes, chunks).ok_or_else(|| unreadable("its pages cannot be told apart"))?;
    if pages.values > CELLS_MAX {
        return too_large("values in its pages", pages.values, CELLS_MAX);
    }
    if pages.unpacked > UNPACKED_MAX {
        return too_large("bytes in its unpacked pages", pages.unpacked as usize, UNPACKED_MAX as usize);
    }
    // Its decoder panics over some damaged pages.
    let table = catch_unwind(AssertUnwindSafe(|| reader.finish())).map_err(|_| unreadable("its pages are damaged"))?;
    let table = table.map_err(broken)?;
    let mut rows = vec![Vec::with_capacity(table.width()); table.height()];
    let mut length = 0;
    for column in table.columns() {
        for (index, row) in rows.iter_mut().enumerate() {
            let text = cell(&column.get(index).map_err(broken)?);
            // Values of a dictionary share their text up to here.
            length += text.len();
            if length > TEXT_MAX {
                return too_large("bytes of text up to here", length, TEXT_MAX);
            }
            row.push(text);
        }
    }
    Ok(Cells { header: table.get_column_names().iter().map(|name| name.to_string()).collect(), rows })
}

/// A value as it would stand in a CSV file: all digits of a number, text without quotes.
fn cell(value: &AnyValue<'_>) -> String {
    match value {
        AnyValue::Null => String::new(),
        AnyValue::String(text) => (*text).to_owned(),
        AnyValue::StringOwned(text) => text.to_string(),
        AnyValue::Float64(number) => unmistakable(&number.to_string()),
        AnyValue::Float32(number) => unmistakable(&number.to_string()),
        other => other.to_string(),
    }
}

/// A frame of columns of equal length.
pub fn frame(columns: Vec<Column>) -> Result<DataFrame> {
    DataFrame::new_infer_height(columns).map_err(trouble)
}

/// What polars refuses here is a table that does not fit together, never a user's file (that is read elsewhere).
fn trouble(error: PolarsError) -> Error {
    Error::file(Path::new("table of specimens"), "cannot be made", std::io::Error::other(error.to_string()))
}
