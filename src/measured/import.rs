//! What a user says about measured files: units, columns by name, the decimal sign, the sheet. Keys of `[measured]`, options of `rates`
//! and fields of the service's form are all read into this.

use serde::{Deserialize, Serialize};

use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::shorten;
use perilife_base::keys::{Field, Key, Shape, Value, key, meant, nearest, refuse};
use perilife_base::table::names::Role;
use perilife_base::table::units::{CycleUnit, IntensityUnit, LengthUnit, LoadUnit, RateUnit};
use perilife_base::table::{Decimal, Sheet, text_or_number};

/// What the user says about files of readings; a header that names its own unit must agree.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Import {
    pub length: Option<LengthUnit>,
    pub cycles: Option<CycleUnit>,
    pub load: Option<LoadUnit>,
    pub columns: ColumnNames,
    pub decimal: Option<Decimal>,
    pub sheet: Option<Sheet>,
    /// Unit of stress intensity, in tables of rates.
    pub intensity: Option<IntensityUnit>,
    pub rate: Option<RateUnit>,
    /// Whether the file is a table of rates over ΔK.
    pub of_rates: bool,
    /// Rows that are left out by their lines.
    pub left_out: Vec<LeaveOut>,
    /// Whether the readings are of a plate in service: one says where its crack is.
    pub of_plate: bool,
}

perilife_base::keys! {
    /// Cycles of a specimen that do not count, or a row of a file.
    #[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct LeaveOut {
        specimen: Option<String> = key("specimen", "Specimen: optional with a single specimen");
        from_cycles: Option<f64> = key("from_cycles", "First cycles: as the file counts them");
        to_cycles: Option<f64> = key("to_cycles", "Last cycles");
        file: Option<String> = key("file", "File of the row: optional with a single file");
        line: Option<usize> = key("line", "Line of the row");
        value: Option<String> = key("value", "A cell of the row: confirms the line");
        reason: String = key("reason", "Reason");
    }
}

impl LeaveOut {
    /// Whether it covers or cuts the growth between two readings, by their cycles.
    pub fn covers(&self, before: f64, after: f64) -> bool {
        let Some((from, to)) = self.from_cycles.zip(self.to_cycles) else { return false };
        let slack = 1e-9 * to.abs();
        before < to - slack && after > from + slack
    }

    pub fn place(&self) -> String {
        let named = |name: &Option<String>, what| name.as_ref().map_or_else(String::new, |name| format!("{what}{name} "));
        let [from, to] = [self.from_cycles, self.to_cycles].map(Option::unwrap_or_default);
        let value = self.value.as_deref().unwrap_or_default();
        let of_cycles = || format!("{}{from} to {to} cycles", named(&self.specimen, "specimen "));
        self.line.map_or_else(of_cycles, |line| format!("{}line {line}: {value}", named(&self.file, "")))
    }
}

/// Refuses entries that name no readings of these files, or have no reason.
pub fn check_left_out(all: &[LeaveOut], files: &[String]) -> Result<()> {
    let remedy = "give { file, line, value, reason } or { specimen, from_cycles, to_cycles, reason }";
    all.iter().enumerate().try_for_each(|(index, one)| {
        let is_row = one.line.is_some();
        let is_mixed = [one.from_cycles, one.to_cycles].iter().any(|cycles| cycles.is_some() == is_row);
        let problem = match &one.file {
            _ if is_mixed => "is neither a row nor cycles",
            _ if one.reason.trim().is_empty() => "has an empty reason",
            Some(file) if !files.contains(file) => "has a file that is not one of measured.files",
            None if is_row && files.len() > 1 => "has no file, and there are several",
            _ => return Ok(()),
        };
        Err(input_missing(&format!("measured.leave_out[{index}]"), problem, remedy))
    })
}

/// Which column is which, by a key and the name in the header, or the number from 1; what is left out is found by the names that
/// laboratories use. Several columns of crack length are readings of one crack on several sides.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ColumnNames(Vec<((&'static str, Role), String)>);

impl ColumnNames {
    /// Known keys with their roles; of several the first is shown.
    pub const KEYS: [(&'static str, Role); 11] = [
        ("cycles", Role::Cycles),
        ("length", Role::Length),
        ("specimen", Role::Specimen),
        ("force_max", Role::Max),
        ("force_min", Role::Min),
        ("force_range", Role::Range),
        ("stress_max", Role::Max),
        ("stress_min", Role::Min),
        ("stress_ratio", Role::Ratio),
        ("delta_k", Role::DeltaK),
        ("rate", Role::Rate),
    ];

    fn key(name: &str) -> Option<(&'static str, Role)> {
        Self::KEYS.into_iter().find(|(known, _)| *known == name)
    }

    pub fn names(between: &str) -> String {
        Self::KEYS.map(|(key, _)| key).join(between)
    }

    /// Names a column as `key=name` of the option `--column` does.
    /// Errors: a text without `=`, an unknown key, or a key given twice (crack length may be).
    pub fn put(&mut self, text: &str) -> Result<()> {
        let refuse = |problem: &str| {
            let remedy = format!("write --column key=name with one of {}, e.g. --column length=\"a [in]\"", Self::names(", "));
            input("--column", format!("\"{text}\""), problem, remedy)
        };
        let (key, name) = text.split_once('=').ok_or_else(|| refuse("has no ="))?;
        let name = name.trim().trim_matches('"');
        fail_if!(name.is_empty(), refuse("has no column"));
        let key = Self::key(key.trim()).ok_or_else(|| refuse("has an unknown key"))?;
        fail_if!(key.1 != Role::Length && self.0.iter().any(|(given, _)| *given == key), refuse("repeats a column"));
        self.0.push((key, name.to_owned()));
        Ok(())
    }

    /// Columns that are named, with their keys and roles; crack lengths last.
    pub(super) fn given(&self) -> impl Iterator<Item = (&'static str, Role, &str)> {
        let keys = Self::KEYS.into_iter().filter(|(_, role)| *role != Role::Length).chain([("length", Role::Length)]);
        keys.flat_map(|key| {
            self.0.iter().filter(move |(own, _)| *own == key).map(|((key, role), name)| (*key, *role, name.as_str()))
        })
    }

    /// Those that are named, without those given by number: a number is there in every table.
    pub(super) fn by_name(&self) -> ColumnNames {
        ColumnNames(self.0.iter().filter(|(_, name)| name.parse::<usize>().is_err()).cloned().collect())
    }

    /// Whether several columns are crack lengths.
    pub(super) fn has_sides(&self) -> bool {
        self.given().filter(|(_, role, _)| *role == Role::Length).count() > 1
    }
}

impl Field for ColumnNames {
    const SHAPE: Shape = Shape::Other("a table of columns, such as { cycles = \"N\", length = [\"a left\", \"a right\"] }");
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        let Some(table) = value.as_table() else { return refuse(key, path, value, Self::SHAPE) };
        let mut names = Vec::new();
        for (name, columns) in table {
            let at = format!("{path}.{name}");
            let known = Self::key(name).ok_or_else(|| {
                let known = || Self::KEYS.iter().map(|(key, _)| *key);
                input(&at, shorten(columns), "unknown key", meant(nearest(name, known()).as_deref(), known()))
            })?;
            let several = columns.as_array().filter(|_| known.1 == Role::Length).map(|list| list.iter().collect());
            let all: Option<Vec<String>> = several.unwrap_or_else(|| vec![columns]).into_iter().map(text_or_number).collect();
            let problem = "is not the name of a column or its number";
            let all = all.ok_or_else(|| input(&at, shorten(columns), problem, "give the name of a column or its number"))?;
            names.extend(all.into_iter().map(|name| (known, name)));
        }
        Ok(ColumnNames(names))
    }
}
