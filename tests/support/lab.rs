//! Tables of one made-up test, in the writing of laboratories.

use std::path::Path;

use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_measured::{ColumnNames, Import, Measured, parse};

/// Cycles, and crack length in mm.
pub const CURVE: [(f64, f64); 6] =
    [(1000.0, 5.0), (11_000.0, 6.0), (20_000.0, 7.0), (27_000.0, 8.25), (33_000.0, 9.5), (38_000.0, 11.0)];

/// The curve under a header, a line a reading, each length `scale` times as long. A row has `{n}` and `{a}`, with `*`, `/`, `+` or `-` and a number
/// behind them; `:2` are decimals, `:_8` a width, `:,` is a decimal comma and `:'.` a sign between thousands.
pub fn table_of(header: &str, row: &str, scale: f64) -> String {
    let lines = CURVE.iter().map(|&(n, a)| filled(row, n, scale * a) + "\n");
    format!("{header}\n{}", if row.is_empty() { String::new() } else { lines.collect() })
}

/// The curve as it is.
pub fn table(header: &str, row: &str) -> String {
    table_of(header, row, 1.0)
}

fn filled(row: &str, n: f64, a: f64) -> String {
    let mut parts = row.split('{');
    let first = parts.next().unwrap().to_owned();
    parts.fold(first, |text, part| {
        let (spec, rest) = part.split_once('}').unwrap();
        let (value, form) = spec.split_once(':').unwrap_or((spec, ""));
        let (own, sign) = (if value.starts_with('n') { n } else { a }, value.chars().nth(1));
        let by: f64 = value.get(2..).filter(|by| !by.is_empty()).map_or(0.0, |by| by.parse().unwrap());
        let number = match sign {
            Some('*') => own * by,
            Some('/') => own / by,
            Some('+') => own + by,
            Some(_) => own - by,
            None => own,
        };
        let decimals: Option<usize> = form.get(..1).and_then(|digit| digit.parse().ok());
        let plain = decimals.map_or_else(|| number.to_string(), |decimals| format!("{number:.decimals$}"));
        let told = match form.split_once('\'') {
            Some((_, sign)) => format!("{}{sign}{}", &plain[..plain.len() - 3], &plain[plain.len() - 3..]),
            None if form.ends_with(',') => plain.replace('.', ","),
            None => format!("{plain:>0$}", form.strip_prefix('_').map_or(0, |width| width.parse().unwrap())),
        };
        text + &told + rest
    })
}

/// Reads the text of `lab.csv`.
pub fn read(text: &str, import: &Import) -> Result<Measured> {
    parse(text.as_bytes(), Path::new("lab.csv"), import)
}

/// So many specimens were read, each with the curve.
#[track_caller]
pub fn all_are_the_curve(name: &str, measured: Result<Measured>, count: usize) -> Measured {
    let measured = measured.unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(measured.curves.len(), count, "{name}: {:?}", measured.curves);
    for curve in &measured.curves {
        assert_eq!(curve.cycles.len(), CURVE.len(), "{name}: {curve:?}");
        for (i, (n, a)) in CURVE.iter().enumerate() {
            assert!((curve.cycles[i] / n - 1.0).abs() < 1e-9, "{name}: {:?}", curve.cycles);
            assert!((curve.crack_length[i] / (a * MM) - 1.0).abs() < 1e-9, "{name}: {:?}", curve.crack_length);
        }
    }
    measured
}

/// Columns as a user names them.
pub fn columns(names: &[&str]) -> Import {
    let mut columns = ColumnNames::default();
    names.iter().for_each(|name| columns.put(name).unwrap());
    Import { columns, ..Import::default() }
}
