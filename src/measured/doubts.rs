//! What a table says of itself beside the columns that are read, and what speaks against how they were read.

use super::header::columns_of;
use super::import::{ColumnNames, Import};
use super::marks::rejects;
use perilife_base::error::Result;
use perilife_base::table::Decimal;
use perilife_base::table::names::vocabulary::{CYCLES, LENGTH, LENGTH_MORE, METHODS, SIDES, is_in, words};
use perilife_base::table::names::{Column, Named, Role, all_in, any_in, of_words, quantity};
use perilife_base::table::numerals::number;
use perilife_base::table::units::{LengthUnit, Unit};
use perilife_base::table::{Fault, Row, Table, whole_file};

/// Share by which two lengths of one reading differ that are not the same.
const UNLIKE: f64 = 0.02;
/// Factor between two lengths that may be of one crack.
const FACTOR: f64 = 2.0;
/// Rows that have to have both.
const ROWS_LEAST: usize = 3;

/// Refuses cycles without unit where a line above the header speaks of thousands of them.
pub(super) fn check_cycles(table: &Table) -> Result<()> {
    let Some((line, text)) = table.preamble.iter().find(|(_, text)| speaks_of_thousands(text)) else { return Ok(()) };
    Err(Fault { line: Some(*line), value: Some(text), ..whole_file(&table.file) }.error(
        "may say the unit of the cycles, which the header does not",
        "set measured.cycle_unit = \"kilocycles\", or \"cycles\" where they are single ones (--cycle-unit), or name the unit in the header",
    ))
}

/// Refuses lengths from the notch, which are no crack lengths of a specimen, and `Crack A` beside `Crack B`, which is not the crack length a.
pub(super) fn check_names(table: &Table, import: &Import) -> Result<()> {
    let columns = columns_of(&table.header, &table.names, import);
    let has_length = columns.iter().any(|column| matches!(column.role, Role::Length | Role::Side));
    if let Some(column) = (0..columns.len()).find(|&column| !has_length && says_from_notch(&table.names[column])) {
        let remedy = "give crack lengths from the load line, the edge or the middle: add the notch to them";
        return Err(table
            .header_fault(column)
            .error("is measured from the notch, not as the crack length of a specimen", remedy));
    }
    let other = |name: &str| {
        let words = name.split(['(', '[']).next()?.trim_end();
        words.strip_suffix(" A").map(|stem| format!("{stem} B"))
    };
    let begins = |name: &String, start: &str| name.split(['(', '[']).next().is_some_and(|words| words.trim_end() == start);
    let lettered = columns.iter().filter(|column| column.role == Role::Length).find_map(|column| {
        let start = other(&table.header[column.index])?;
        table.header.iter().find(|name| begins(name, &start)).map(|name| (column.index, name))
    });
    match lettered.filter(|_| import.columns == ColumnNames::default()) {
        None => Ok(()),
        Some((column, name)) => Err(table.header_fault(column).error(
            format!("stands beside {name}: two cracks, or two specimens"),
            format!(
                "for one crack give both as measured.columns.length (--column length=... for each), whose mean counts; for two specimens name \
                 the columns S1 and S2; else say which one counts by measured.columns = {{ length = \"{}\" }}",
                table.header[column]
            ),
        )),
    }
}

/// Columns of a wide table that are no specimens: statistics and curves of several.
pub(super) fn statistics(table: &Table) -> Vec<usize> {
    (1..table.names.len()).filter(|&column| is_of_statistics(&table.names[column])).collect()
}

/// The line that says which columns are no specimens.
pub(super) fn not_specimens(table: &Table, columns: &[usize]) -> Option<String> {
    let names: Vec<&str> = columns.iter().map(|&column| table.header[column].as_str()).collect();
    let file = table.file.display();
    (!names.is_empty()).then(|| format!("{file}: not read, since it is of several specimens or of a model: {}", names.join(", ")))
}

/// Columns that are not read and hold other lengths of the same readings as those that are; `known`: places of all that are read.
pub(super) fn other_lengths(table: &Table, read: &[Column], known: &[usize], decimal: Decimal) -> Vec<String> {
    let mean = |row: &Row| {
        let values = read.iter().map(|column| number(row.cell(column.index), decimal).map(|value| value * column.factor));
        let values = values.collect::<Option<Vec<f64>>>()?;
        Some(values.iter().sum::<f64>() / values.len() as f64)
    };
    let mut lines = Vec::new();
    for (index, name) in table.names.iter().enumerate().filter(|(index, _)| !known.contains(index)) {
        let Some(factor) = speaks_of_length(name) else { continue };
        let ratio = |row: &Row| Some(number(row.cell(index), decimal)? * factor / mean(row)?);
        let ratios: Vec<f64> = table.rows.iter().filter_map(ratio).filter(|ratio| ratio.is_finite()).collect();
        let most = ratios.iter().map(|ratio| (ratio - 1.0).abs()).fold(0.0, f64::max);
        let is_of_crack = ratios.len() >= ROWS_LEAST && ratios.iter().all(|ratio| (1.0 / FACTOR..=FACTOR).contains(ratio));
        if is_of_crack && most > UNLIKE {
            lines.push(format!(
                "{}: {} is not read; its lengths differ by up to {:.1} % from those of {}, which are taken: choose by measured.columns = {{ \
                 length = \"...\" }} (--column length=...)",
                table.file.display(),
                table.header[index],
                100.0 * most,
                read.iter().map(|column| table.header[column.index].as_str()).collect::<Vec<_>>().join(", ")
            ));
        }
    }
    lines
}

/// Rows whose remarks reject them, which are read all the same.
pub(super) fn rejected(table: &Table, read: &[usize]) -> Option<String> {
    let others: Vec<usize> = (0..table.header.len()).filter(|column| !read.contains(column)).collect();
    let of_row = |row: &Row| others.iter().find(|column| rejects(row.cell(**column))).map(|column| (row.line, *column));
    let found: Vec<(usize, usize)> = table.rows.iter().filter_map(of_row).collect();
    let (line, column) = *found.first()?;
    let cell = table.rows.iter().find(|row| row.line == line).map_or("", |row| row.cell(column));
    Some(format!(
        "{}:{line}: {} = \"{cell}\" may reject the reading, and {} in all: they are read like the others; leave them out by \
         measured.leave_out, or by a column valid of yes and no",
        table.file.display(),
        table.header[column],
        if found.len() == 1 { "it is the only one".to_owned() } else { format!("{} rows do so", found.len()) }
    ))
}

/// Whether a line says that cycles are counted in thousands or millions: `N x 1000`, `Zyklen in Tausend`; not `precracked for 50 thousand cycles`.
fn speaks_of_thousands(line: &str) -> bool {
    const MANY: &str = "kilocycles kilocycle kcycles kcycle thousand thousands tausend tsd milliers migliaia miles megacycles mcycles million millions mio";
    let (mut words, bracket) = words(line);
    words.extend(bracket);
    let is_count = |word: &String| word.parse::<f64>().is_ok();
    let is_many = |i: usize| {
        let after_count = i > 0 && is_count(&words[i - 1]);
        let power = words[i] == "10" && words.get(i + 1).is_some_and(|next| ["3", "6"].contains(&next.as_str()));
        let thousand = ["1000", "x1000", "1000000"].contains(&words[i].as_str()) || power;
        let times = i > 0 && ["x", "in", "of", "mal", "times"].contains(&words[i - 1].as_str());
        is_in(MANY, &words[i]) && !after_count || thousand && (times || words[i].starts_with('x') || line.contains('×'))
    };
    let is_of_cycles = words.iter().any(|word| is_in(CYCLES, word));
    is_of_cycles && (0..words.len()).any(is_many)
}

/// Whether a name says that its lengths are measured from the notch.
fn says_from_notch(name: &str) -> bool {
    const NOTCH: &str = "notch kerb kerbe kerbgrund entaille muesca entalla intaglio";
    of_words(name, |words, _| any_in(words, NOTCH) && (any_in(words, LENGTH) || any_in(words, SIDES) || words.contains(&"from")))
}

/// Metres per unit of a column whose name speaks of a crack length by whatever method, half of it where that is tip to tip.
fn speaks_of_length(name: &str) -> Option<f64> {
    const OTHERS: &str = "total edc compliance cod cmod bfs visual optical optisch visuell";
    let is_plain = |rest: &[&str]| {
        (any_in(rest, LENGTH) || rest == ["visual"]) && all_in(rest, &[LENGTH, LENGTH_MORE, METHODS, OTHERS, SIDES])
    };
    let Named::Is(unit) = quantity(name, Unit::Length(LengthUnit::Millimetre), is_plain)? else { return None };
    let is_whole = of_words(name, |words, _| words.contains(&"2a"));
    Some(if is_whole { 0.5 * unit.si() } else { unit.si() })
}

/// Whether a name in a row of specimens is that of a statistic or of a model; `Design A` and `-40 C` are specimens.
fn is_of_statistics(name: &str) -> bool {
    const STATISTICS: &str = "mean average avg mittel mittelwert moyenne media std sd stdev stddev dev deviation standardabweichung streuung ecart \
        scatter variance cov cv";
    const MODELS: &str = "predicted prediction model design fitted regression confidence";
    const MORE: &str = "cycles cycle of the curve value line lower upper bound band zyklen lastspiele";
    const SPREAD: &str = "s sd sigma 1s 2s 3s 1sd 2sd 3sd 2sigma 3sigma";
    of_words(name, |words, _| {
        let is_statistic = any_in(words, STATISTICS) && all_in(words, &[STATISTICS, MORE, "n a 2a standard type"]);
        let is_model = any_in(words, MODELS) && all_in(words, &[MODELS, MORE]);
        let is_signed =
            name.trim_start().starts_with(['+', '-', '\u{b1}']) && words.last().is_some_and(|word| is_in(SPREAD, word));
        is_statistic || is_model || is_signed || words == ["s", "d"]
    })
}
