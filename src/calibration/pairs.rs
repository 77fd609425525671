//! Tables of pairs: cycles and crack length of every specimen beside each other, `N1, a1, N2, a2`, or `N, a, N, a`.

use crate::calibration::column_units::{cycle_unit, length_column};
use crate::calibration::columns::Column;
use crate::calibration::import::Import;
use crate::calibration::names::{Meaning, meaning};
use crate::calibration::roles::Roles;
use crate::calibration::table::Table;
use crate::error::Result;

/// Columns of one specimen.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// Its number in the header, or its place where the header has none.
    pub specimen: String,
    /// Cycles.
    pub cycles: Column,
    /// Crack length.
    pub length: Column,
}

/// A name without its number, and the number: `a1 (mm)` is `a (mm)` and 1.
fn cut(name: &str) -> (String, Option<&str>) {
    let end = name.find(['(', '[', '{']).unwrap_or(name.len());
    let (words, unit) = (name[..end].trim_end(), &name[end..]);
    let base = words.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = &words[base.len()..];
    match base.trim_end_matches([' ', '_', '-', '#', '.']) {
        base if !base.is_empty() && !number.is_empty() => (format!("{base} {unit}"), Some(number)),
        _ => (name.to_owned(), None),
    }
}

/// Meanings of columns that are cycles and length in turn, and the number of each pair: all have one and no other the same, or none has.
pub(super) fn meanings_of_pairs(names: &[String]) -> Option<(Vec<Meaning>, Vec<Option<&str>>)> {
    let names: Vec<(String, Option<&str>)> = names.iter().map(|name| cut(name)).collect();
    let meanings: Vec<Meaning> = names.iter().map(|(base, _)| meaning(base)).collect();
    let is_pair = |pair: usize| {
        let [cycles, length] = [2 * pair, 2 * pair + 1];
        matches!(meanings[cycles], Meaning::Cycles(_))
            && matches!(meanings[length], Meaning::Length(_) | Meaning::Double(_))
            && names[cycles].1 == names[length].1
    };
    let count = names.len() / 2;
    let numbers: Vec<Option<&str>> = (0..count).map(|pair| names[2 * pair].1).collect();
    let is_own = |i: usize| numbers[i].is_some() && !numbers[..i].contains(&numbers[i]);
    let are_told = numbers.iter().all(Option::is_none) || (0..count).all(is_own);
    let are_pairs = count > 1 && names.len().is_multiple_of(2) && (0..count).all(is_pair) && are_told;
    are_pairs.then_some((meanings, numbers))
}

/// The pairs of a table; `None` where its columns are none.
///
/// # Errors
/// A unit that is not said.
pub(super) fn pairs(table: &Table, import: &Import) -> Result<Option<Vec<Pair>>> {
    let Some((meanings, numbers)) = meanings_of_pairs(&table.names) else { return Ok(None) };
    let roles = Roles { meanings };
    let pair = |pair: usize| {
        Ok(Pair {
            specimen: numbers[pair].map_or_else(|| (pair + 1).to_string(), str::to_owned),
            cycles: Column { index: 2 * pair, factor: cycle_unit(table, 2 * pair, &roles, import)? },
            length: length_column(table, 2 * pair + 1, &roles, import)?,
        })
    };
    (0..numbers.len()).map(pair).collect::<Result<Vec<Pair>>>().map(Some)
}
