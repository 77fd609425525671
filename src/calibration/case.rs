//! A calibration file: `[measured]` and `[fit]` beside the sections of a case.

use std::path::Path;

use toml::{Table, Value};

use crate::criterion::Criterion;
use crate::exponent::{Exponent, FitKeys, delta_k_ratio, exponent};
use perilife_base::error::{Error, InputError, Result, fail_if, input, input_missing};
use perilife_base::input::{Document, Folder, sha256};
use perilife_base::keys::{Need, Plain, all, key, length, section};
use perilife_base::kinds::Named as _;
use perilife_base::table::units::{CycleUnit, LengthUnit, LoadUnit};
use perilife_base::table::{Decimal, Sheet};
use perilife_base::units::{MM, round_off};
use perilife_growth::case::record::SourceFile;
use perilife_growth::case::{Case, LawSource};
use perilife_measured::rates::{COLUMNS, DECIMAL, SHEET};
use perilife_measured::{ColumnNames, Import, LeaveOut, Measured, MeasuredCurve, check_left_out, parse};
use perilife_plate::specimen::handbook::{HandbookFormula, handbook};
use perilife_plate::specimen::{Specimen, SpecimenKind};

/// Slack of crack lengths against each other, m: binary fractions of a mm need not agree to the last bit.
const LENGTH_SLACK: f64 = 1e-9;
/// What the specimen's crack may be longer than the first reading besides, m: its rounding in a report.
const START_SLACK: f64 = 5e-5;
/// Share by which the specimen's crack may be longer than the first reading: 12 mm are 0.4724 in of four decimals, or 11.999 mm.
const ROUNDING: f64 = 1e-4;

/// A checked calibration, SI inside.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationCase {
    /// The test as a case without fatigue law. It runs to the longest reading and stops for nothing else on the way:
    /// toughness and yield strength are taken out, since the measured specimens are known to have got there.
    pub case: Case,
    /// Measured curves inside the fit window, cycles counted from its first reading.
    pub curves: Vec<MeasuredCurve>,
    pub read: Vec<MeasuredCurve>,
    /// Ends of the fit window, m.
    pub window: [f64; 2],
    /// Yield strength of the material, Pa, by which readings are judged.
    pub yield_strength: Option<f64>,
    pub exponent: Exponent,
    pub criterion: Criterion,
    pub sources: Vec<SourceFile>,
    /// Readings that do not count, with the reasons.
    pub left_out: Vec<LeaveOut>,
    pub warnings: Vec<String>,
    pub input: Table,
    formula: Option<HandbookFormula>,
}

perilife_base::keys! {
    pub struct MeasuredKeys {
        files: Vec<String> = key("files", "Files of readings: CSV or workbooks, one or more specimens each");
        from: Option<f64> = length("from_crack_length_mm", "From crack length: start of the fit window");
        to: Option<f64> = length("to_crack_length_mm", "To crack length: end of the fit window");
        length_unit: Option<LengthUnit> = key("length_unit", "Unit of crack length: where the header has none");
        cycle_unit: Option<CycleUnit> = key("cycle_unit", "Unit of cycles: where the header has none");
        precision: Option<Plain> = length("precision_mm", "Precision of the crack lengths");
        load_unit: Option<LoadUnit> = key("load_unit", "Unit of loads: where the header has none");
        columns: ColumnNames = COLUMNS, or "found by their names" ColumnNames::default();
        decimal: Option<Decimal> = DECIMAL;
        sheet: Option<Sheet> = SHEET;
        leave_out: Vec<LeaveOut> = key("leave_out", "Excluded readings: with the reason"), or "none" Vec::new();
    }
}

impl MeasuredKeys {
    fn import(&self) -> Import {
        Import {
            length: self.length_unit,
            cycles: self.cycle_unit,
            load: self.load_unit,
            columns: self.columns.clone(),
            decimal: self.decimal,
            sheet: self.sheet.clone(),
            left_out: self.leave_out.clone(),
            ..Import::default()
        }
    }
}

impl CalibrationCase {
    /// Reads a calibration file and the measured files it names; `overrides` are `section.key=value`.
    pub fn from_file(path: &Path, overrides: &[String]) -> Result<Self> {
        Self::from_document(Document::read(path, overrides)?)
    }

    /// The same for text; the files it names lie in `folder`.
    pub fn from_text(text: &str, name: &str, folder: impl Into<Folder>) -> Result<Self> {
        Self::from_document(Document::parse(text, name, folder, &[])?)
    }

    /// The same for a parsed document, which gives errors their line.
    pub fn from_document(mut document: Document) -> Result<Self> {
        let input = document.table.clone();
        // Taken out of the table, but not of the text: errors still find their line.
        let measured = document.table.remove("measured");
        let fit = document.table.remove("fit").unwrap_or_else(|| Value::Table(Table::new()));
        let build = || {
            let measured = measured
                .as_ref()
                .ok_or_else(|| input_missing("measured", "is missing", "write a section [measured] with files = [\"...csv\"]"))?;
            let of_table = |table: &Table| Case::from_table(table.clone(), &document.name, &document.folder);
            let (mut table, keys) = (document.table.clone(), || section::<MeasuredKeys>(measured, "measured"));
            let counted = |read: &Measured| {
                let mut counted = read.clone();
                counted.leave_standing_out()?;
                counted.leave_out(&keys()?.leave_out)?;
                window(&counted, &keys()?)
            };
            let read = || Ok(readings(&keys()?, &document.folder)?.0);
            let (mut case, notes) = completed(&mut table, &of_table, &read, &counted)?;
            case.warnings.extend(notes);
            let input = input.into_iter().chain(table).collect();
            Self::build(case, keys()?, section(&fit, "fit")?, &document.folder, input)
        };
        build().map_err(|error| document.locate(error))
    }

    fn build(mut case: Case, keys: MeasuredKeys, fit: FitKeys, folder: &Folder, input: Table) -> Result<Self> {
        if !matches!(&case.law, LawSource::Missing(path) if path.as_os_str().is_empty()) {
            let remedy = "remove a, p, horizon_mm and fitted from [fatigue]; to fix p set it in [fit]";
            return Err(input_missing("fatigue", "gives the law that the calibration fits", remedy));
        }
        check_walker(&case)?;
        refuse_spectrum(&case)?;
        check_growth_rate(&case)?;
        check_through(&case.specimen)?;
        let formula = handbook(&case.specimen);
        let (mut measured, sources) = readings(&keys, folder)?;
        if let Some(ratio) = measured.other_ratio(case.loading.ratio) {
            let given = std::mem::replace(&mut case.loading.ratio, ratio);
            case.warnings.push(format!(
                "loading: law recorded at R = {ratio}, the R of the readings; loading.stress_ratio = {given} is not used"
            ));
        }
        measured.compare_with(&case.specimen, &case.material, &case.loading)?;
        measured.leave_standing_out()?;
        let read = measured.curves.clone();
        measured.leave_out(&keys.leave_out)?;
        let window_ends = window_ends(&keys);
        let Measured { mut curves, mut warnings } = window(&measured, &keys)?;
        check_start(&case.specimen, &mut curves)?;
        let longest = curves.iter().flat_map(|curve| &curve.crack_length).copied().fold(0.0, f64::max);
        if let Some(formula) =
            formula.as_ref().filter(|formula| ![case.specimen.crack_length, longest].iter().all(|a| formula.holds_at(*a)))
        {
            warnings.push(format!("formula range: exceeded by the fit window ({}: {})", formula.name, formula.range));
        }
        let delta_k_ratio =
            formula.as_ref().map(|formula| delta_k_ratio(&curves, &|length| formula.k_i(length, case.loading.maximum)));
        let exponent = exponent(&fit, folder, case.model.method(), delta_k_ratio)?;
        warnings.extend(exponent.warning.clone());
        let criterion = fit.criterion;
        case.stop.crack_length = longest;
        case.stop.required = None;
        case.material.toughness = None;
        let yield_strength = case.material.yield_strength.take();
        warnings.extend(unrecorded(&case));
        warnings.extend(case.warnings.iter().cloned());
        case.provenance = folder.opened().so_far();
        let left_out = keys.leave_out;
        Ok(CalibrationCase {
            case,
            curves,
            read,
            window: window_ends,
            yield_strength,
            exponent,
            criterion,
            sources,
            left_out,
            warnings,
            input,
            formula,
        })
    }

    /// ΔK of the handbook (Pa√m) at a crack length (m); `None` where no handbook has the specimen, as a drawn plate.
    pub fn delta_k(&self, crack_length: f64) -> Option<f64> {
        let loading = &self.case.loading;
        self.formula.as_ref().map(|formula| formula.delta_k(crack_length, loading.maximum, loading.range_share()))
    }
}

/// A case, with what its table does not say from readings, which goes into the table; what was taken, in words.
/// Errors: as `of_table`; why readings do not give what is missing.
pub fn completed(
    table: &mut Table,
    of_table: &dyn Fn(&Table) -> Result<Case>,
    read: &dyn Fn() -> Result<Measured>,
    counted: &dyn Fn(&Measured) -> Result<Measured>,
) -> Result<(Case, Vec<String>)> {
    let error = match of_table(table) {
        Ok(case) => return Ok((case, Vec::new())),
        Err(error) => error,
    };
    let of_readings = |key: &Option<String>| matches!(key.as_deref(), Some("loading" | "specimen.crack_length_mm"));
    let lacks = |wrong: &InputError| wrong.value.is_none() && of_readings(&wrong.key);
    let is_theirs = matches!(&error, Error::Input(wrong) if lacks(wrong) || wrong.more.iter().any(lacks));
    match read().and_then(|read| complete(table, &read, counted)) {
        Err(unread) if is_theirs => Err(unread),
        Ok(notes) if !notes.is_empty() => Ok((of_table(table)?, notes)),
        _ => Err(error),
    }
}

/// The load, where all readings have the same, and the crack at the first one that counts. That of a central crack is asked for where no
/// header says that lengths are tip to tip.
fn complete(table: &mut Table, measured: &Measured, counted: &dyn Fn(&Measured) -> Result<Measured>) -> Result<Vec<String>> {
    const LENGTH: &str = "crack_length_mm";
    let mut notes = Vec::new();
    let load = measured.load();
    if !table.contains_key("loading") && load.len() < 2 {
        let remedy = [&["add a section [loading]".to_owned()][..], &measured.warnings[..]].concat().join("; ");
        return Err(input_missing("loading", "is missing", remedy));
    }
    if !table.contains_key("loading") {
        notes.push(format!("loading: {}, from the readings", measured.load_words()));
        let load = load.into_iter().map(|(key, value)| (key.to_owned(), Value::Float(value))).collect();
        table.insert("loading".to_owned(), Value::Table(load));
    }
    let Some(given) = table.get_mut("specimen").and_then(Value::as_table_mut).filter(|given| !given.contains_key(LENGTH)) else {
        return Ok(notes);
    };
    let Some(kind) = given.get("kind").and_then(|kind| SpecimenKind::find(kind.as_str()?)) else { return Ok(notes) };
    let is_one_length =
        all(kind.keys()).iter().any(|key| key.name == LENGTH && key.group.is_none() && key.need == Need::Required);
    let is_half = kind.has_half_length();
    if is_one_length && (!is_half || measured.curves.iter().all(|curve| curve.source.is_tip_to_tip)) {
        let first = counted(measured)?.curves.iter().map(|curve| curve.crack_length[0]).fold(f64::INFINITY, f64::min);
        let words = if is_half { " (half of the tip-to-tip length)" } else { "" };
        notes.push(format!("initial crack length: {} mm, from the first reading{words}", round_off(first / MM)));
        given.insert(LENGTH.to_owned(), Value::Float(round_off(first / MM)));
    }
    Ok(notes)
}

/// Readings under a spectrum have no one ΔK.
fn refuse_spectrum(case: &Case) -> Result<()> {
    let problem = "cannot be combined with a calibration (ΔK and rate at one R)";
    let remedy = "calibrate on readings of plates without residual stress";
    fail_if!(let Some(residual) = &case.loading.residual, input(residual.key(), residual.words(), problem, remedy));
    if case.loading.spectrum.is_none() {
        return Ok(());
    }
    let problem = "cannot be combined with a calibration (constant amplitude only)";
    let remedy = "fit a law to curves of constant amplitude, and give the spectrum in the case that uses it";
    Err(input("loading.kind", "\"spectrum\"", problem, remedy))
}

/// Curves of one stress ratio say nothing about its influence, and a record means ε = s_max (1-R): another Walker exponent
/// belongs to the case that uses the record at another ratio.
fn check_walker(case: &Case) -> Result<()> {
    let gamma = case.fatigue.walker_gamma;
    if gamma == 1.0 {
        return Ok(());
    }
    let problem = "does not apply to a fit at one R";
    let remedy = "remove it here and give it in the case that uses the fit at another stress ratio";
    Err(input("fatigue.walker_gamma", gamma, problem, remedy))
}

/// A and p stand for C and m of the rate over K; bonds left to their own strains grow a crack at another one, which depends on lattice
/// and horizon.
fn check_growth_rate(case: &Case) -> Result<()> {
    if !case.spends_bond_life() {
        return Ok(());
    }
    let problem = "does not apply to a calibration, which fits the growth rate over K";
    Err(input("fatigue.driver", "\"bond_strain\"", problem, "use driver = \"tip_field\", and remove keys of fatigue bonds"))
}

/// A threshold shapes no fit, since cracks grew in all of it, and stands in no record.
fn unrecorded(case: &Case) -> Option<String> {
    let line = "threshold: fatigue.delta_k_threshold_mpa_sqrt_m has no effect on the fit; set it in the cases that use the law";
    (case.fatigue.threshold > 0.0).then(|| line.to_owned())
}

fn readings(keys: &MeasuredKeys, folder: &Folder) -> Result<(Measured, Vec<SourceFile>)> {
    fail_if!(keys.files.is_empty(), input("measured.files", "[]", "has no file", "name at least one measured a-N curve"));
    check_left_out(&keys.leave_out, &keys.files)?;
    let mut measured = Measured::default();
    let mut sources = Vec::with_capacity(keys.files.len());
    for file in &keys.files {
        let bytes = folder.read(file)?;
        let mut import = keys.import();
        // Places in the list stay, for messages.
        let of_others = |one: &&mut LeaveOut| one.file.as_ref().is_some_and(|own| own != file);
        import.left_out.iter_mut().filter(of_others).for_each(|one| one.line = None);
        measured.add(parse(&bytes, &folder.path(file), &import)?)?;
        sources.push(source(file, &bytes));
    }
    Ok((measured.of_precision("measured.precision_mm", keys.precision.map(|precision| precision.0))?, sources))
}

/// What the record says about a measured file.
pub fn source(file: &str, bytes: &[u8]) -> SourceFile {
    SourceFile { file: file.to_owned(), sha256: sha256(bytes) }
}

fn window_ends(keys: &MeasuredKeys) -> [f64; 2] {
    [keys.from.unwrap_or(0.0) - LENGTH_SLACK, keys.to.unwrap_or(f64::INFINITY) + LENGTH_SLACK]
}

fn window(measured: &Measured, keys: &MeasuredKeys) -> Result<Measured> {
    let MeasuredKeys { from, to, .. } = *keys;
    if let (Some(from), Some(to)) = (from, to)
        && from >= to
    {
        let problem = format!("is not above from_crack_length_mm = {}", from / MM);
        return Err(input("measured.to_crack_length_mm", to / MM, problem, "give a window with at least 5 readings"));
    }
    measured.window(from, to)
}

/// Refuses a crack that does not go through: its K depends on its shape, and that on the law which is asked for.
fn check_through(specimen: &Specimen) -> Result<()> {
    let Some(flaw) = &specimen.part_through else { return Ok(()) };
    let problem = "part-through cracks cannot be used: their K depends on the law being fitted";
    Err(input("specimen.kind", format!("\"{}\"", flaw.kind()), problem, "fit the law to through cracks"))
}

/// The model starts at the specimen's crack length, so no reading may come before it; one that its rounding puts there is at the start.
fn check_start(specimen: &Specimen, curves: &mut [MeasuredCurve]) -> Result<()> {
    let start = specimen.shortest_crack();
    for curve in curves {
        let first = curve.crack_length[0]; // a window keeps at least five readings
        // One reading may be put at the start, not several.
        let second = curve.crack_length[1];
        if start > first * (1.0 + ROUNDING) + START_SLACK || start > second * (1.0 + ROUNDING) {
            let mm = |length: f64| round_off(length / MM).to_string();
            let problem = format!("exceeds the first reading of specimen {}, {} mm", curve.specimen, mm(first));
            let remedy = "start the model at the first reading, or the window (measured.from_crack_length_mm) at the model";
            return Err(input("specimen.crack_length_mm", mm(start), problem, remedy));
        }
        curve.crack_length.iter_mut().for_each(|length| *length = length.max(start));
    }
    Ok(())
}
