//! Data frames by polars: wide and long form, pointwise quantiles of many specimens, joins, Parquet and CSV.
//!
//! Knows: polars, and nothing else does.
//! Must not know: what stands in a frame.
//!
//! Imports `base`; only `results` imports it (feature `tables`, on by default). Nothing a fit or a prediction needs goes through here: it serves
//! many specimens at once and whoever goes on with the results elsewhere. Columns carry their units, as in all result files.

use std::path::Path;

use polars::prelude::*;

use perilife_base::cells::defused;
use perilife_base::error::{Error, Result};

pub use polars;
pub use polars::prelude::{Column, DataFrame};

/// Name of the column of crack length, mm.
pub const LENGTH: &str = "crack_length_mm";
/// Name of the column of specimens.
pub const SPECIMEN: &str = "specimen";
/// Name of the column of cycles.
pub const CYCLES: &str = "cycles";

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

/// A frame of columns of equal length.
pub fn frame(columns: Vec<Column>) -> Result<DataFrame> {
    DataFrame::new_infer_height(columns).map_err(trouble)
}

/// What polars refuses here is a table that does not fit together, never a user's file (that is read elsewhere).
fn trouble(error: PolarsError) -> Error {
    Error::file(Path::new("table of specimens"), "cannot be written", std::io::Error::other(error.to_string()))
}
