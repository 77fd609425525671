//! What the columns of a measured file are: one row a reading, or columns of every specimen; and in which units.

use super::exclusion_flags::{is_of_thousands, rejected};
use super::header::{columns_of, cut, is_wide, pairs_of, place_of};
use super::import::{ColumnNames, Import};
use perilife_base::error::{Error, Result, fail_if};
use perilife_base::table::decimal::decide;
use perilife_base::table::names::{Column, Kind, Named, Role, says_tip_to_tip, unit_of_specimen};
use perilife_base::table::numerals::number;
use perilife_base::table::units::{CycleUnit, LengthUnit, LoadUnit, Unit};
use perilife_base::table::{Decimal, Fault, Table, whole_file};

/// How the specimens of a table are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Long,
    /// First column crack length, then one column of cycles per specimen.
    WideCycles,
    /// First column cycles, then one column of crack length per specimen.
    WideLengths,
    Paired,
}

/// Columns of the readings of one specimen, or of those that a column names.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    pub name: String,
    pub specimen: Option<Column>,
    pub cycles: Column,
    /// Crack length; of several the mean counts.
    pub lengths: Vec<Column>,
    /// Readings of the same crack on several sides.
    pub sides: Vec<Column>,
    /// A few optical readings, by which the crack lengths are corrected.
    pub optical: Option<Column>,
    /// Loads, of every role one at the most.
    pub loads: Vec<Column>,
    /// Columns of quantities that the case says too: ΔK, sizes, the smallest load where no other says how large a cycle is.
    pub compared: Vec<Column>,
    /// Columns that no other specimen has: a row in which all of them are empty is none of its readings. Empty where rows belong to all.
    pub own: Vec<usize>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    pub shape: Shape,
    /// Columns of the specimens: one series where all rows have the same columns.
    pub series: Vec<Series>,
    pub decimal: Decimal,
    /// What separates columns; empty where cells are stored, not written.
    pub separator: &'static str,
    pub warnings: Vec<String>,
}

const KNOWN: &str = "known columns: specimen, cycles (N, kilocycles, megacycles), crack_length_mm (a [mm], crack_length_inch, \
                     crack_length_m), front and back, force_max_kn and force_min_kn; a wide table starts with cycles or crack \
                     length and has at least two more columns, all of them specimens (S1, S2, ...; a1, a2, ... are ambiguous)";

/// Recognises the layout of a table by its header and by what the user says.
/// Errors: columns that are not there, that say the same, or that do not make up a test; cells that leave the decimal sign open.
pub(super) fn recognise(table: &Table, import: &Import) -> Result<Layout> {
    check_given(table, import)?;
    let mut warnings = table.warnings();
    let given = import.columns != ColumnNames::default();
    let (shape, series) = match if given { None } else { pairs_of(&table.names) } {
        Some(pairs) => (Shape::Paired, pairs.into_iter().map(|pair| paired(table, pair, import)).collect::<Result<_>>()?),
        None => by_roles(table, import, &mut warnings)?,
    };
    let separator = table.separator.map_or("", |separator| separator.name());
    let read = numbers(shape, &series);
    let decimal = decide(table, &read.iter().map(Column::numbers).collect::<Vec<_>>(), import.decimal)?;
    let of_specimens = series.iter().filter_map(|series| series.specimen);
    let known: Vec<usize> = read.iter().copied().chain(of_specimens).map(|column| column.index).collect();
    warnings.extend(rejected(table, &known));
    Ok(Layout { shape, series, decimal, separator, warnings })
}

fn check_given(table: &Table, import: &Import) -> Result<()> {
    for (key, _, name) in import.columns.given() {
        if place_of(name, &table.header, &table.names).is_none() {
            let key = format!("measured.columns.{key}");
            let fault = Fault { file: &table.file, line: None, key: Some(&key), value: Some(name) };
            return Err(fault.error("is not a column of this file", format!("its columns are {}", table.header.join(" | "))));
        }
    }
    Ok(())
}

fn paired(table: &Table, (name, [cycles, length]): (String, [Column; 2]), import: &Import) -> Result<Series> {
    let (cycles, length) = (cycle_column(table, cycles, import)?, length_column(table, length, import)?);
    Ok(Series::of_one(name, cycles, length, vec![cycles.index, length.index]))
}

fn by_roles(table: &Table, import: &Import, warnings: &mut Vec<String>) -> Result<(Shape, Vec<Series>)> {
    let columns = columns_of(&table.header, &table.names, import);
    let of = |wanted: fn(&Column) -> bool| columns.iter().copied().filter(wanted).collect::<Vec<Column>>();
    let (cycles, lengths) = (of(|column| column.role == Role::Cycles), of(Column::is_length));
    let wide = is_wide(&columns) && !are_places_of_one_crack(&table.header[1..]);
    let specimens = || of(|column| column.index > 0 && column.role == Role::Unknown).into_iter().map(|column| column.index);
    let one = |i: usize, cycles, length| Series::of_one(table.header[i].clone(), cycles, length, vec![i]);
    if wide {
        warnings.extend(not_specimens(table, &columns));
    }
    match (cycles.as_slice(), lengths.as_slice()) {
        ([cycles], [_, ..]) => {
            let specimen = of(|column| column.role == Role::Specimen);
            let optical = optical(table, &columns).map(|column| length_column(table, column, import)).transpose()?;
            // A length without a method goes before those of methods.
            let is_other = |column: &Column| optical.is_none_or(|optical| optical.index != column.index);
            let has_plain = columns.iter().any(|column| column.role == Role::Length && is_other(column));
            let is_read = |column: &&Column| is_other(column) && !(has_plain && column.role == Role::Method);
            let columns: Vec<Column> = columns.iter().filter(is_read).copied().collect();
            let (lengths, sides) = lengths_and_sides(table, &columns, import)?;
            let cycles = cycle_column(table, *cycles, import)?;
            let (loads, mut compared) = loads(table, &columns, import, warnings)?;
            compared.extend(of(|column| matches!(column.role, Role::DeltaK | Role::Width | Role::Thickness)));
            compared.retain(|column| matches!(column.unit, Named::Is(_)));
            fail_if!(let Some(second) = specimen.get(1), says_the_same(table, second.index, "specimen"));
            warnings.extend(not_read(table, &columns));
            let stem = table.file.file_stem().map_or_else(|| "specimen".to_owned(), |stem| stem.to_string_lossy().into_owned());
            let specimen = specimen.first().copied();
            let own = Vec::new();
            Ok((Shape::Long, vec![Series { name: stem, specimen, cycles, lengths, sides, optical, loads, compared, own }]))
        }
        ([_, second, ..], _) => Err(says_the_same(table, second.index, "cycles")),
        ([], [length]) if wide && length.index == 0 => {
            let length = length_column(table, *length, import)?;
            let series = specimens().map(|i| {
                let cycles = Column::new(i, Role::Cycles, unit_of_specimen(&table.names[i], Role::Cycles));
                Ok(one(i, cycle_column(table, cycles, import)?, length))
            });
            Ok((Shape::WideCycles, series.collect::<Result<_>>()?))
        }
        ([cycles], []) if wide && cycles.index == 0 => {
            let cycles = cycle_column(table, *cycles, import)?;
            // Where `2a` stands in names of some specimens alone it is part of their names.
            let are_whole: Option<Vec<bool>> = specimens().map(|i| says_tip_to_tip(&table.names[i])).collect();
            let series = specimens().enumerate().map(|(place, i)| {
                let length = Column::new(i, Role::Length, unit_of_specimen(&table.names[i], Role::Length));
                let length = length_column(table, length, import)?;
                let is_whole = are_whole.as_ref().is_some_and(|are_whole| are_whole[place]);
                Ok(one(i, cycles, if is_whole { length.tip_to_tip() } else { length }))
            });
            Ok((Shape::WideLengths, series.collect::<Result<_>>()?))
        }
        _ => Err(unknown_shape(table, &columns)),
    }
}

impl Series {
    fn of_one(name: String, cycles: Column, length: Column, own: Vec<usize>) -> Series {
        Series {
            name,
            specimen: None,
            cycles,
            lengths: vec![length],
            sides: Vec::new(),
            optical: None,
            loads: Vec::new(),
            compared: Vec::new(),
            own,
        }
    }

    pub fn load(&self, role: Role) -> Option<Column> {
        self.loads.iter().copied().find(|column| column.role == role)
    }
}

impl Layout {
    /// The key of `measured.columns` that each of some columns has; empty for one that is not read or is a specimen of a wide table.
    pub fn keys(&self, columns: usize) -> Vec<&'static str> {
        let mut keys = vec![""; columns];
        for series in &self.series {
            let read = series.loads.iter().chain(&series.specimen).chain(&series.lengths).chain([&series.cycles]);
            for column in read.filter(|column| self.shape == Shape::Paired || !series.own.contains(&column.index)) {
                let own = ColumnNames::KEYS.into_iter().find(|(_, role)| *role == column.role);
                keys[column.index] = own.map_or("length", |(key, _)| key);
            }
        }
        keys
    }

    /// What the cells of a row are taken for: cycles, and crack lengths in metres; `None` for all that is neither, or no number.
    pub fn taken(&self, cells: &[String]) -> Vec<Option<f64>> {
        let mut taken = vec![None; cells.len()];
        for column in self.series.iter().flat_map(|series| series.lengths.iter().chain([&series.cycles])) {
            let Some(cell) = cells.get(column.index) else { continue };
            let value = number(cell, self.decimal).map(|value| if column.is_log { 10f64.powf(value) } else { value });
            taken[column.index] = value.map(|value| value * column.factor);
        }
        taken
    }
}

fn numbers(shape: Shape, series: &[Series]) -> Vec<Column> {
    let of = |series: &Series| -> Vec<Column> {
        let read = std::iter::once(&series.cycles).chain(&series.lengths).chain(&series.sides).chain(&series.optical);
        let all = read.chain(&series.loads).chain(&series.compared);
        all.copied().collect()
    };
    let mut numbers: Vec<Column> = series.iter().flat_map(of).collect();
    if shape != Shape::Long {
        // The column that all specimens share stands first.
        numbers.sort_by_key(|column| column.index);
        numbers.dedup_by_key(|column| column.index);
    }
    numbers
}

/// Of two columns of crack length the one that at most every second row has: optical readings beside those of potential drop.
fn optical(table: &Table, columns: &[Column]) -> Option<Column> {
    let count = |column: &Column| table.rows.iter().filter(|row| !row.cell(column.index).is_empty()).count();
    let is_whole = |column: &&Column| column.is_length() && column.role != Role::Side;
    let mut lengths: Vec<Column> = columns.iter().filter(is_whole).copied().collect();
    lengths.sort_by_key(count);
    let [few, many] = *lengths.as_slice() else { return None };
    (count(&few) > 0 && 2 * count(&few) <= count(&many) + 1).then_some(few)
}

/// Columns of crack length, and those of single sides beside them: where no column has the mean, the sides have it.
fn lengths_and_sides(table: &Table, columns: &[Column], import: &Import) -> Result<(Vec<Column>, Vec<Column>)> {
    let of = |is_side: bool| columns.iter().filter(move |column| column.is_length() && (column.role == Role::Side) == is_side);
    fail_if!(let Some(second) = of(false).nth(1), says_the_same(table, second.index, "length"));
    let read = |is_side: bool| of(is_side).map(|column| length_column(table, *column, import)).collect::<Result<Vec<Column>>>();
    let (sides, lengths) = (read(true)?, read(false)?);
    Ok(if lengths.is_empty() { (sides.clone(), sides) } else { (lengths, sides) })
}

/// The unit of a column: as its name says, or as the user does by a key, and never two of them.
fn stated_unit(table: &Table, column: Column, key: &str, given: Option<Unit>) -> Result<Option<Unit>> {
    match (column.unit, given) {
        (Named::Is(named), Some(given)) if named != given => Err(table.header_fault(column.index).error(
            format!("is in {}, but {} says {}", named.name(), key.split(' ').next().unwrap_or(key), given.name()),
            "name the unit in one place, or the same in both",
        )),
        (Named::Is(unit), _) => Ok(Some(unit)),
        // What stands in brackets may be part of a name.
        (Named::No | Named::Strange, given) => Ok(given),
    }
}

/// The column in its unit.
/// Errors: none, and none that the user says; one of them each.
pub(super) fn column_in_unit(table: &Table, column: Column, key: &str, like: Unit, given: Option<Unit>) -> Result<Column> {
    if let Some(unit) = stated_unit(table, column, key, given)? {
        return Ok(column.in_unit(unit));
    }
    let problem = if column.unit == Named::Strange { "has an unknown unit" } else { "has no unit" };
    Err(table.header_fault(column.index).error(problem, unit_remedy(key, like)))
}

fn unit_remedy(key: &str, like: Unit) -> String {
    format!("name one of {} in the header, or set {key}", like.alternatives().join(", "))
}

fn length_column(table: &Table, column: Column, import: &Import) -> Result<Column> {
    let like = Unit::Length(LengthUnit::Millimetre);
    column_in_unit(table, column, "measured.length_unit (--length-unit)", like, import.length.map(Unit::Length))
}

/// Whether the names of columns are `a1`, `a2`, ...: one letter or word of crack length, numbered.
fn are_places_of_one_crack(names: &[String]) -> bool {
    let is_numbered = |(place, name): (usize, &String)| {
        let (base, number) = cut(name);
        number == Some((place + 1).to_string().as_str()) && Column::named(Kind::Readings, 0, &base).is_length()
    };
    names.len() > 1 && names.iter().enumerate().all(is_numbered)
}

fn cycle_column(table: &Table, column: Column, import: &Import) -> Result<Column> {
    let (like, mut given) = (Unit::Cycles(CycleUnit::Cycles), import.cycles.map(Unit::Cycles));
    if (column.unit, given) == (Named::No, None) {
        if let Some((line, text)) = table.preamble.iter().find(|(_, text)| is_of_thousands(text)) {
            let remedy = "set measured.cycle_unit = \"kilocycles\", or \"cycles\" (--cycle-unit), or name the unit in the header";
            let fault = Fault { line: Some(*line), value: Some(text), ..whole_file(&table.file) };
            return Err(fault.error("may give the unit of cycles; the header does not", remedy));
        }
        given = Some(like);
    }
    column_in_unit(table, column, "measured.cycle_unit (--cycle-unit)", like, given)
}

/// The column of a load; `None` where its unit is not said and the loads do not change, so that those of the case hold for all.
fn load_column(table: &Table, column: Column, import: &Import, warnings: &mut Vec<String>) -> Result<Option<Column>> {
    const KEY: &str = "measured.load_unit (--load-unit)";
    if let Some(unit) = stated_unit(table, column, KEY, import.load.map(Unit::Load))? {
        return Ok(Some(column.in_unit(unit)));
    }
    let remedy = unit_remedy(KEY, Unit::Load(LoadUnit::Newton));
    let first = table.rows.first().map_or("", |row| row.cell(column.index));
    if let Some(row) = table.rows.iter().find(|row| row.cell(column.index) != first) {
        let problem = format!("is a varying load (from {first}) in an unknown unit");
        return Err(table.cell_fault(row, column.index).error(problem, remedy));
    }
    let (file, name) = (table.file.display(), &table.header[column.index]);
    warnings.push(format!("columns: {file}: {name} ignored (unknown load unit); the load of the case is used; {remedy}"));
    Ok(None)
}

/// Columns of loads whose unit is known; for the others a warning, or an error where the loads change. Second, a smallest load alone, which
/// says no cycle, and is held against that of the case.
fn loads(table: &Table, columns: &[Column], import: &Import, warnings: &mut Vec<String>) -> Result<(Vec<Column>, Vec<Column>)> {
    let mut found: Vec<Column> = Vec::new();
    for (role, key) in
        [(Role::Max, "force_max"), (Role::Min, "force_min"), (Role::Range, "force_range"), (Role::Ratio, "stress_ratio")]
    {
        let mut own = columns.iter().copied().filter(|column| column.role == role);
        let Some(column) = own.next() else { continue };
        fail_if!(let Some(second) = own.next(), says_the_same(table, second.index, key));
        if role == Role::Ratio {
            found.push(column);
            continue;
        }
        let Some(column) = load_column(table, column, import, warnings)? else { continue };
        if let Some(earlier) = found.last().filter(|earlier| is_stress(earlier) != is_stress(&column)) {
            let problem = format!("is not the same quantity as {}", table.header[earlier.index]);
            return Err(table.header_fault(column.index).error(problem, "give both as forces or both as stresses"));
        }
        found.push(column);
    }
    // R alone with numbers from 1 on is no stress ratio, but the right side of a specimen, perhaps; without any it says nothing.
    if let [column] = found.as_slice()
        && column.role == Role::Ratio
    {
        let numbers = table.rows.iter().filter_map(|row| row.cell(column.index).replace(',', ".").parse::<f64>().ok());
        let largest = numbers.reduce(f64::max);
        warnings.extend(largest.filter(|largest| *largest >= 1.0).map(|_| {
            let name = &table.header[column.index];
            format!("columns: {}: {name} ignored (not a stress ratio); R of the case is used", table.file.display())
        }));
        if largest.is_none_or(|largest| largest >= 1.0) {
            found.clear();
        }
    }
    // A minimum alone does not say how large a cycle is; a ratio goes with the largest load of the case.
    let says_cycle = found.iter().any(|column| matches!(column.role, Role::Max | Role::Range | Role::Ratio));
    Ok(if says_cycle { (found, Vec::new()) } else { (Vec::new(), found) })
}

pub(super) fn is_stress(column: &Column) -> bool {
    matches!(column.unit, Named::Is(unit) if unit.is_stress())
}

fn not_specimens(table: &Table, columns: &[Column]) -> Option<String> {
    let statistics = columns.iter().filter(|column| column.role == Role::Statistic);
    let names: Vec<&str> = statistics.map(|column| table.header[column.index].as_str()).collect();
    let file = table.file.display();
    (!names.is_empty()).then(|| format!("columns: {file}: ignored (several specimens, or a model): {}", names.join(", ")))
}

/// A line about columns that nobody asked for and whose names say nothing, or a load that is not read.
fn not_read(table: &Table, columns: &[Column]) -> Option<String> {
    let strange = columns.iter().filter(|column| {
        matches!(column.role, Role::Unknown | Role::Unclear | Role::Statistic)
            || matches!((column.role, column.unit), (Role::Other, Named::Is(Unit::Load(_))))
    });
    let names: Vec<&str> = strange.map(|column| table.header[column.index].as_str()).filter(|name| !name.is_empty()).collect();
    let (file, ignored) = (table.file.display(), names.join(", "));
    let is_load = |column: &Column| matches!(column.role, Role::Max | Role::Range);
    let remedy = match columns.iter().any(is_load) {
        true => "",
        false => "; if one is the load of every reading, set measured.columns = { force_max = \"...\" } (--column force_max=...)",
    };
    (!names.is_empty()).then(|| format!("columns: {file}: ignored columns: {ignored}{remedy}"))
}

fn says_the_same(table: &Table, column: usize, key: &str) -> Error {
    let name = &table.header[column];
    let fault = table.header_fault(column);
    if table.header[..column].iter().any(|earlier| earlier.eq_ignore_ascii_case(name)) {
        return fault.error("occurs twice", "give every column its own name");
    }
    let remedy = format!("select one by measured.columns = {{ {key} = \"{name}\" }} (--column {key}=\"{name}\")");
    fault.error("duplicates an earlier column", remedy)
}

/// A header that does not make up a test: what is missing, the first rows, and the key that settles it.
fn unknown_shape(table: &Table, columns: &[Column]) -> Error {
    let first = |wanted: fn(&Column) -> bool| columns.iter().position(wanted);
    let unclear = || first(|column| column.role == Role::Unclear).filter(|_| first(Column::is_length).is_none());
    let unknown = first(|column| column.role == Role::Unknown).or_else(unclear);
    let (column, problem) = match (first(|column| column.role == Role::Cycles), first(Column::is_length), unknown) {
        (None, None, Some(column)) => (column, "unknown column"),
        (Some(column), None, None) => (column, "header has no column of crack length"),
        (None, Some(column), None) => (column, "header has no column of cycles"),
        (Some(_), None, Some(column)) => (column, "unknown column; no column of crack length"),
        (None, Some(_), Some(column)) => (column, "unknown column; no column of cycles"),
        _ => (0, "header has no columns of cycles and crack length"),
    };
    let remedy = format!(
        "{KNOWN}; or assign them by measured.columns = {{ cycles = \"...\", length = \"...\" }} (--column cycles=... --column \
         length=...); {}",
        table.first_rows()
    );
    table.header_fault(column).error(problem, remedy)
}
