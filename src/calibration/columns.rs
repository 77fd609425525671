//! What the columns of a measured file are: one row a reading, or one column a specimen; and in which units.

use crate::calibration::column_units::{cycle_unit, length_column, load_unit, wide_length_unit};
use crate::calibration::decimal::{Decimal, decide};
use crate::calibration::import::{ColumnNames, CycleUnit, Import};
use crate::calibration::names::{LoadRole, Meaning};
use crate::calibration::pairs::pairs;
pub(crate) use crate::calibration::roles::names_a_test;
use crate::calibration::roles::{self, Roles};
pub use crate::calibration::shape::{Column, LoadColumns, Shape};
use crate::calibration::table::Table;
use crate::error::{Error, Result};

/// What the columns of one file are.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// How specimens are laid out.
    pub shape: Shape,
    /// The decimal sign.
    pub decimal: Decimal,
    /// Metres per unit of a length cell.
    pub length_unit: f64,
    /// Cycles per unit of a cycles cell.
    pub cycle_unit: f64,
    /// What separates columns; empty where cells are stored, not written.
    pub separator: &'static str,
    /// What the user should know.
    pub warnings: Vec<String>,
}

const KNOWN: &str = "known are specimen, cycles (N, kilocycles, megacycles), crack_length_mm (a [mm], crack_length_inch, crack_length_m), \
                     front and back, force_max_kn and force_min_kn; a wide table starts with cycles or crack length and has at least two \
                     more columns, all of them specimens";

/// Recognises the layout of a table by its header and by what the user says.
///
/// # Errors
/// Columns that are not there, that say the same, or that do not make up a test; cells that leave the decimal sign open.
pub(crate) fn recognise(table: &Table, import: &Import) -> Result<Layout> {
    roles::check_given(table, import)?;
    let given = import.columns != ColumnNames::default();
    if let Some(pairs) = if given { None } else { pairs(table, import)? } {
        return layout(table, import, Shape::Paired(pairs), table.warnings());
    }
    let roles = Roles::of(&table.header, &table.names, import);
    let (cycles, lengths) = (roles.cycles(), roles.lengths());
    let specimen = roles.places(|meaning| *meaning == Meaning::Specimen);
    let mut warnings = table.warnings();
    let wide = table.header.len() >= 3 && specimen.is_empty() && roles.rest_unknown();
    let rest = 1..table.header.len();
    let shape = match (cycles.as_slice(), lengths.as_slice()) {
        ([cycles], [_, ..]) => {
            let (lengths, sides) = lengths_and_sides(table, &roles, import)?;
            let cycles = Column { index: *cycles, factor: cycle_unit(table, *cycles, &roles, import)? };
            let loads = loads(table, &roles, import, &mut warnings)?;
            refuse_second(table, &specimen)?;
            warnings.extend(not_read(table, &roles));
            Shape::Long { specimen: specimen.first().copied(), cycles, lengths, sides, loads }
        }
        ([_, second, ..], _) => return Err(says_the_same(table, *second, "cycles")),
        ([], [0]) if wide => {
            let factor = import.cycles.unwrap_or(CycleUnit::Cycles).cycles();
            let length = length_column(table, 0, &roles, import)?;
            Shape::WideCycles(length, rest.map(|index| Column { index, factor }).collect())
        }
        ([0], []) if wide => {
            let cycles = Column { index: 0, factor: cycle_unit(table, 0, &roles, import)? };
            let columns = rest.map(|index| Ok(Column { index, factor: wide_length_unit(table, index, import)? }));
            Shape::WideLengths(cycles, columns.collect::<Result<_>>()?)
        }
        _ => return Err(unknown_shape(table, &roles)),
    };
    layout(table, import, shape, warnings)
}

/// What the shape of a table leaves open.
fn layout(table: &Table, import: &Import, shape: Shape, warnings: Vec<String>) -> Result<Layout> {
    let decimal = decide(table, &shape.numbers(), import.decimal)?;
    let (length_unit, cycle_unit) = shape.units();
    let separator = table.separator.map_or("", |separator| separator.name());
    Ok(Layout { shape, decimal, length_unit, cycle_unit, separator, warnings })
}

/// Columns of crack length, and those of single sides beside them: where no column has the mean, the sides have it.
fn lengths_and_sides(table: &Table, roles: &Roles, import: &Import) -> Result<(Vec<Column>, Vec<Column>)> {
    let of = |wanted: fn(&Meaning) -> bool| -> Result<Vec<Column>> {
        roles.places(wanted).into_iter().map(|column| length_column(table, column, roles, import)).collect()
    };
    let whole = roles.places(|meaning| matches!(meaning, Meaning::Length(_) | Meaning::Double(_)));
    if let [_, second, ..] = whole.as_slice() {
        return Err(says_the_same(table, *second, "length"));
    }
    let sides = of(|meaning| matches!(meaning, Meaning::Side(_)))?;
    let lengths = of(|meaning| matches!(meaning, Meaning::Length(_) | Meaning::Double(_)))?;
    Ok(if lengths.is_empty() { (sides.clone(), sides) } else { (lengths, sides) })
}

/// Columns of loads whose unit is known; for the others a warning, or an error where the loads change.
fn loads(table: &Table, roles: &Roles, import: &Import, warnings: &mut Vec<String>) -> Result<LoadColumns> {
    let mut found = LoadColumns::default();
    let mut stress: Option<(bool, usize)> = None;
    for role in [LoadRole::Max, LoadRole::Min, LoadRole::Range, LoadRole::Ratio] {
        let places = roles.places(|meaning| matches!(meaning, Meaning::Load(own, _) if *own == role));
        let Some(&index) = places.first() else { continue };
        if let Some(&second) = places.get(1) {
            let key = match role {
                LoadRole::Max => "force_max",
                LoadRole::Min => "force_min",
                LoadRole::Range => "force_range",
                _ => "stress_ratio",
            };
            return Err(says_the_same(table, second, key));
        }
        if role == LoadRole::Ratio {
            found.ratio = Some(Column { index, factor: 1.0 });
            continue;
        }
        let Meaning::Load(_, named) = roles.meanings[index] else { continue };
        let Some(unit) = load_unit(table, index, named, import, warnings)? else { continue };
        if let Some((_, earlier)) = stress.filter(|(is_stress, _)| *is_stress != unit.is_stress()) {
            let problem = format!("is not of the quantity of {}", table.header[earlier]);
            return Err(table.header_fault(index).error(problem, "give both as forces or both as stresses"));
        }
        stress = Some((unit.is_stress(), index));
        let column = Some(Column { index, factor: unit.si() });
        match role {
            LoadRole::Max => found.maximum = column,
            LoadRole::Min => found.minimum = column,
            _ => found.range = column,
        }
    }
    found.is_stress = stress.is_some_and(|(is_stress, _)| is_stress);
    if found.maximum.is_none() && found.range.is_none() {
        // Neither a minimum nor a ratio alone says how large a cycle is.
        return Ok(LoadColumns::default());
    }
    Ok(found)
}

/// A line about columns that nobody asked for and whose names say nothing.
fn not_read(table: &Table, roles: &Roles) -> Option<String> {
    let strange = |meaning: &Meaning| matches!(meaning, Meaning::Unknown | Meaning::Load(LoadRole::Bare, _));
    let names: Vec<&str> = roles.places(strange).into_iter().map(|column| table.header[column].as_str()).collect();
    let names: Vec<&str> = names.into_iter().filter(|name| !name.is_empty()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{}: not read, since the name does not say what it is: {}; where one is the load of every reading, say so by \
             measured.columns = {{ force_max = \"...\" }} (--column force_max=...)",
            table.file.display(),
            names.join(", ")
        )
    })
}

fn refuse_second(table: &Table, columns: &[usize]) -> Result<()> {
    columns.get(1).map_or(Ok(()), |&second| Err(says_the_same(table, second, "specimen")))
}

fn says_the_same(table: &Table, column: usize, key: &str) -> Error {
    let name = &table.header[column];
    let fault = table.header_fault(column);
    if table.header[..column].iter().any(|earlier| earlier.eq_ignore_ascii_case(name)) {
        return fault.error("names two columns", "give every column its own name");
    }
    let remedy = format!("say which one counts by measured.columns = {{ {key} = \"{name}\" }} (--column {key}=\"{name}\")");
    fault.error("says the same as an earlier column", remedy)
}

/// A header that does not make up a test: what is missing, the first rows, and the key that settles it.
pub(super) fn unknown_shape(table: &Table, roles: &Roles) -> Error {
    let (cycles, lengths) = (roles.cycles(), roles.lengths());
    let unknown = roles.places(|meaning| matches!(meaning, Meaning::Unknown)).first().copied();
    let (column, problem) = match (cycles.first(), lengths.first(), unknown) {
        (None, None, Some(column)) => (column, "is not a known column"),
        (Some(&column), None, None) => (column, "stands in a header without a column of crack length"),
        (None, Some(&column), None) => (column, "stands in a header without a column of cycles"),
        (Some(_), None, Some(column)) => (column, "is not a known column, and none is crack length"),
        (None, Some(_), Some(column)) => (column, "is not a known column, and none is cycles"),
        _ => (0, "stands in a header without cycles and crack length"),
    };
    let remedy = format!(
        "{KNOWN}; or say which is which by measured.columns = {{ cycles = \"...\", length = \"...\" }} (--column cycles=... --column \
         length=...); {}",
        table.first_rows()
    );
    table.header_fault(column).error(problem, remedy)
}
