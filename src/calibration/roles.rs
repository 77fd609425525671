//! Which column is which: as the user says, else by the meaning of its name.

use crate::calibration::import::{ColumnName, Import};
use crate::calibration::names::{LoadRole, Meaning, Named, meaning, units_of};
use crate::calibration::pairs::meanings_of_pairs;
use crate::calibration::table::{Fault, Table};
use crate::error::Result;

/// Meanings of all columns, the user's word first.
pub(crate) struct Roles {
    pub meanings: Vec<Meaning>,
}

/// Whether a row of names, with what the user says, names cycles and crack length, starts a wide table or is one of pairs.
pub(crate) fn names_a_test(names: &[String], import: &Import) -> bool {
    if meanings_of_pairs(names).is_some() {
        return true;
    }
    let roles = Roles::of(names, names, import);
    let wide = || names.len() >= 3 && roles.rest_unknown() && names.iter().all(|name| !name.is_empty());
    match (roles.cycles().first(), roles.lengths().first()) {
        (Some(_), Some(_)) => true,
        (Some(0), None) | (None, Some(0)) => wide(),
        _ => false,
    }
}

/// Columns that the user names: key, name.
fn given(import: &Import) -> Vec<(&'static str, &ColumnName)> {
    let columns = &import.columns;
    let single = [
        ("cycles", &columns.cycles),
        ("specimen", &columns.specimen),
        ("force_max", &columns.force_max),
        ("force_min", &columns.force_min),
        ("force_range", &columns.force_range),
        ("stress_max", &columns.stress_max),
        ("stress_min", &columns.stress_min),
        ("stress_ratio", &columns.stress_ratio),
    ];
    let single = single.into_iter().filter_map(|(key, name)| Some((key, name.as_ref()?)));
    single.chain(columns.length.iter().map(|name| ("length", name))).collect()
}

/// Whether a meaning is that of a key.
fn is_of(key: &str, meaning: &Meaning) -> bool {
    match key {
        "cycles" => matches!(meaning, Meaning::Cycles(_)),
        "length" => matches!(meaning, Meaning::Length(_) | Meaning::Side(_) | Meaning::Double(_)),
        "specimen" => *meaning == Meaning::Specimen,
        "force_max" | "stress_max" => matches!(meaning, Meaning::Load(LoadRole::Max, _)),
        "force_min" | "stress_min" => matches!(meaning, Meaning::Load(LoadRole::Min, _)),
        "force_range" => matches!(meaning, Meaning::Load(LoadRole::Range, _)),
        _ => matches!(meaning, Meaning::Load(LoadRole::Ratio, _)),
    }
}

/// What a column of this name is that the user gives this key; several lengths are sides of one crack.
fn as_given(key: &str, name: &str, several: bool) -> Meaning {
    let (cycles, length, load) = units_of(name);
    match key {
        "cycles" => Meaning::Cycles(cycles),
        "length" if several => Meaning::Side(length),
        "length" => match meaning(name) {
            Meaning::Double(unit) => Meaning::Double(unit),
            _ => Meaning::Length(length),
        },
        "specimen" => Meaning::Specimen,
        "force_max" | "stress_max" => Meaning::Load(LoadRole::Max, load),
        "force_min" | "stress_min" => Meaning::Load(LoadRole::Min, load),
        "force_range" => Meaning::Load(LoadRole::Range, load),
        _ => Meaning::Load(LoadRole::Ratio, Named::No),
    }
}

impl Roles {
    /// Meanings of columns as the header has them, and with the units of the row below.
    pub(crate) fn of(header: &[String], names: &[String], import: &Import) -> Self {
        let mut meanings: Vec<Meaning> = names.iter().map(|name| meaning(name)).collect();
        let given = given(import);
        for (key, _) in &given {
            meanings.iter_mut().filter(|meaning| is_of(key, meaning)).for_each(|meaning| *meaning = Meaning::Other);
        }
        for (key, name) in given {
            if let Some(column) = place_of(name, header, names) {
                meanings[column] = as_given(key, &names[column], import.columns.length.len() > 1);
            }
        }
        Roles { meanings }
    }

    pub(crate) fn places(&self, wanted: impl Fn(&Meaning) -> bool) -> Vec<usize> {
        (0..self.meanings.len()).filter(|&column| wanted(&self.meanings[column])).collect()
    }

    pub(crate) fn cycles(&self) -> Vec<usize> {
        self.places(|meaning| is_of("cycles", meaning))
    }

    pub(crate) fn lengths(&self) -> Vec<usize> {
        self.places(|meaning| is_of("length", meaning))
    }

    /// Whether all columns behind the first are of no known quantity: names of specimens.
    pub(crate) fn rest_unknown(&self) -> bool {
        self.meanings[1..].iter().all(|meaning| *meaning == Meaning::Unknown)
    }
}

/// Place of a column that the user names: as written, else whatever its case and blanks, else by number.
fn place_of(wanted: &ColumnName, header: &[String], names: &[String]) -> Option<usize> {
    let plain = |name: &str| name.to_lowercase().split_whitespace().collect::<Vec<_>>().join(" ");
    let exact = header.iter().position(|name| *name == wanted.0);
    let alike = || [header, names].iter().find_map(|list| list.iter().position(|name| plain(name) == plain(&wanted.0)));
    exact.or_else(alike).or_else(|| {
        let number = wanted.0.parse::<usize>().ok()?;
        (1..=names.len()).contains(&number).then(|| number - 1)
    })
}

/// Refuses columns that the user names and the file does not have.
pub(crate) fn check_given(table: &Table, import: &Import) -> Result<()> {
    for (key, name) in given(import) {
        if place_of(name, &table.header, &table.names).is_none() {
            let key = format!("measured.columns.{key}");
            let fault = Fault { file: &table.file, line: None, key: Some(&key), value: Some(&name.0) };
            return Err(fault.error("names no column of this file", format!("its columns are {}", table.header.join(" | "))));
        }
    }
    Ok(())
}
