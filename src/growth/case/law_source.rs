//! The law of `[fatigue]`: inline constants, or a record that `perilife calibrate` wrote.
//!
//! A case has one law: a second one, however it is given, is refused. Of a record of a law over K the constants take the place of
//! `fatigue.fitted`, as if they stood in the case. A driver that needs a law of the other kind, of bonds (A, p) or over
//! K (C, m), takes what the given one stands for.

use toml::{Table, Value};

use super::{LawSource, law};
use crate::case::record::{FittedRecord, LawRecord};
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::input::{Document, Folder, slice, value_at};
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_laws::growth_law::description::{Constant, GAMMA, Given, K_C, LIBRARY, RatedRow, Rates, keys_of_laws, law_keys};
use perilife_laws::growth_law::nasgro::keys_of;
use perilife_laws::growth_law::{FactorLaw, GrowthLaw, GrowthLawKind, Walker, bonds, paris};
use perilife_laws::paris::ParisLaw;
use perilife_laws::{FatigueLaw, STEADY_EXPONENTS, unsteady};
use perilife_measured::RateFile;
use perilife_plate::loading::SAME_RATIO;
use perilife_plate::material::{Material, Plane, growth_data, library};

/// The law of the case, of the kind that is asked for or else whose constants are given; `None` where the file gives none at all,
/// as in a calibration. `hands_over` says of bonds whether they hand their crack over to its K.
/// Errors: two laws, constants of another kind than `growth_law` or than the driver can have.
pub(super) fn read(threshold: f64, hands_over: Option<bool>, given: &Given<'_>) -> Result<Option<LawSource>> {
    let asked = given.get("growth_law")?;
    let own = only_law(asked, given.section)?;
    let kind = asked.or(own.as_ref().and_then(|kinds| if let [only] = kinds[..] { Some(only) } else { None }));
    let is_given = |key: &str| value_at(given.section, key).is_some();
    if let Some((kind, read)) = kind.and_then(|kind| Some((kind, kind.0.read?))) {
        if hands_over.is_some() {
            let problem = "cannot drive bonds (only a power law can)";
            let remedy = "use fatigue.driver = \"tip_field\", or model.method = \"handbook\"";
            return Err(input(GrowthLawKind::KEY, format!("\"{kind}\""), problem, remedy));
        }
        kind.0.refuse_foreign(&is_given)?;
        if let Some((what, least)) = kind.0.compression.filter(|(_, least)| given.ratios[1] < *least) {
            let problem = format!("is below {least}, the lowest R for the {what} of growth_law \"{kind}\"");
            return Err(input("loading.stress_ratio", given.ratios[0], problem, "use another growth_law"));
        }
        return read(given, kind.0).map(|law| Some(LawSource::Factor(FactorLaw { threshold, ..law })));
    }
    if is_given(K_C.key) {
        let remedy = "remove it, or set its law by fatigue.growth_law";
        return Err(input_missing("fatigue.k_c_mpa_sqrt_m", "is not a constant of this growth law", remedy));
    }
    let is_there = |key: &Constant| if key.is_shared() { is_given(key.key) } else { own.is_some() };
    if let Some((kind, lacks)) = kind.and_then(|kind| Some((kind, kind.0.constants.iter().find(|key| !is_there(key))?))) {
        let problem = format!("is missing (required by growth_law = \"{kind}\")");
        return Err(input_missing(&format!("fatigue.{}", lacks.key), problem, "give all constants of the law"));
    }
    if let Some(fitted) = given.get::<String>("fitted")? {
        return read_record(&fitted, given.folder).map(Some);
    }
    let bonds = given.all_or_none(&bonds::LAW)?.map(|law| FatigueLaw { a: law[0], p: law[1], horizon: law[2] });
    let paris = given.all_or_none(&paris::LAW)?.map(|law| ParisLaw { c: law[0], m: law[1] });
    let law = bonds.map(LawSource::Inline).or(paris.map(LawSource::Paris));
    // What a driver cannot use as it is has to be translated.
    match &law {
        Some(LawSource::Inline(law)) if hands_over != Some(false) && !STEADY_EXPONENTS.contains(&law.p) => {
            Err(unsteady("fatigue.p", law.p))
        }
        Some(LawSource::Paris(law)) if hands_over.is_some() && !STEADY_EXPONENTS.contains(&law.m) => {
            Err(unsteady("fatigue.paris_m", law.m))
        }
        _ => Ok(law),
    }
}

/// Kinds of `growth_law` that the law can be that is given, if any: one, and of the kind asked for.
fn only_law(asked: Option<GrowthLawKind>, fatigue: &Value) -> Result<Option<Vec<GrowthLawKind>>> {
    let mut laws = keys_of_laws().into_iter().filter_map(|(keys, kinds)| {
        let (key, value) = keys.iter().find_map(|&key| Some((key, value_at(fatigue, key)?)))?;
        Some((kinds, format!("fatigue.{key}"), shown(value)))
    });
    let Some((kinds, key, value)) = laws.next() else { return Ok(None) };
    if let Some((_, second, value)) = laws.next() {
        let problem = format!("conflicts with {key}: a second growth law");
        return Err(input(&second, value, problem, "give one law: fitted, or the constants of one kind"));
    }
    if let Some(kind) = asked.filter(|kind| !kinds.contains(kind)) {
        let problem = format!("is not a constant of fatigue.growth_law = \"{kind}\"");
        return Err(input(&key, value, problem, "give the constants of that law, or remove growth_law"));
    }
    Ok(Some(kinds))
}

/// A value as the messages show it.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Float(number) => number.to_string(),
        other => other.to_string(),
    }
}

/// Reads a `fitted.toml`; one that does not exist (yet) is [`LawSource::Missing`].
fn read_record(name: &str, folder: &Folder) -> Result<LawSource> {
    match fitted_record(name, folder) {
        Ok(record) => Ok(LawSource::Fitted(Box::new(record))),
        Err(Error::File { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
            Ok(LawSource::Missing(folder.path(name)))
        }
        Err(other) => Err(other),
    }
}

/// Reads and checks a `fitted.toml`.
/// Errors: a file that cannot be read, or is no such record.
pub fn fitted_record(name: &str, folder: &Folder) -> Result<FittedRecord> {
    let document = Document::in_folder(folder, name, &[])?;
    if LawRecord::is_of(&document.table) {
        let problem = "contains a da/dN-ΔK law, not A and p";
        return Err(input("fitted", format!("\"{name}\""), problem, "give a record of a fit to a-N readings"));
    }
    let mut table = document.table.clone();
    // Records of before say by which estimate C and m are.
    table.remove("estimate");
    let record = slice::<FittedRecord>(&Value::Table(table), "record").and_then(|record| {
        law::check_record(&record)?;
        Ok(record)
    });
    let at_top = |error| match error {
        Error::Input(mut trouble) => {
            trouble.key = trouble.key.map(|key| key.trim_start_matches("record.").to_owned());
            trouble.remedy.push_str("; this file is written by `perilife calibrate`");
            Error::Input(trouble)
        }
        other => other,
    };
    record.map_err(|error| document.locate(at_top(error)))
}

/// `[fatigue]` with the constants of the record it names, and the record; `None` where it names none, one that does not exist, or one of
/// A and p.
/// Errors: a record that cannot be read, beside constants of a law.
pub(super) fn expanded(fatigue: &Value, folder: &Folder) -> Result<Option<(Value, Box<LawRecord>)>> {
    let Some(name) = value_at(fatigue, "fitted").and_then(Value::as_str) else { return Ok(None) };
    // One that cannot be read is refused, or not missed, where records of A and p are.
    let Ok(document) = Document::in_folder(folder, name, &[]) else { return Ok(None) };
    if !LawRecord::is_of(&document.table) {
        return Ok(None);
    }
    let record = slice::<LawRecord>(&Value::Table(document.table.clone()), "record").map_err(|error| document.locate(error))?;
    let mut table = fatigue.as_table().cloned().unwrap_or_default();
    if let Some(asked) = table.get("growth_law").and_then(Value::as_str).filter(|asked| *asked != record.kind()) {
        let problem = format!("is not the law of {name}, {}", record.kind());
        return Err(input("fatigue.growth_law", format!("\"{asked}\""), problem, "remove it, or give a record of that law"));
    }
    table.remove("fitted");
    table.remove("growth_law");
    let beside = law_keys().chain([GAMMA.key]).find(|key| table.contains_key(*key));
    if let Some(key) = beside {
        let problem = "conflicts with fatigue.fitted, which contains a growth law";
        return Err(input_missing(&format!("fatigue.{key}"), problem, "give the record, or all constants in the case"));
    }
    table.extend(record.fatigue.clone());
    Ok(Some((Value::Table(table), Box::new(record))))
}

/// `[fatigue]` with the growth law of the material it asks for by `growth_law = "library"`, and what that is; `None` where it does not.
/// Errors: a material that has none, or a second law.
pub(super) fn of_library(fatigue: &Value, material: &Value, thickness: f64, folder: &Folder) -> Result<Option<(Value, String)>> {
    if value_at(fatigue, "growth_law").and_then(Value::as_str) != Some(LIBRARY.name) {
        return Ok(None);
    }
    const REMEDY: &str = "set material.name to an entry of `perilife list materials`, or to your own file with [growth]";
    let Some(name) = value_at(material, "name").and_then(Value::as_str) else {
        let problem = "is missing (required by fatigue.growth_law = \"library\")";
        return Err(input_missing("material.name", problem, REMEDY));
    };
    let Some((keys, words)) = growth_keys(name, thickness, folder)? else {
        return Err(input("material.name", format!("\"{name}\""), "has no growth law in the library", REMEDY));
    };
    let mut table = fatigue.as_table().cloned().unwrap_or_default();
    table.remove("growth_law");
    if let Some(key) = law_keys().chain([GAMMA.key]).find(|key| table.contains_key(*key)) {
        let problem = "conflicts with growth_law = \"library\"";
        return Err(input_missing(&format!("fatigue.{key}"), problem, "remove it, or give all constants in the case"));
    }
    table.extend(keys);
    Ok(Some((Value::Table(table), words)))
}

/// The growth law of a material, as keys of `[fatigue]`, for a plate of this thickness, m, and what it is; `None` of one without.
/// Errors: as [`library::find`].
fn growth_keys(name: &str, thickness: f64, folder: &Folder) -> Result<Option<(Table, String)>> {
    if let Some(record) = growth_data::record(name) {
        let words = format!("{}: {}; {}", record.title(), growth_data::SOURCE, record.checked());
        return Ok(Some((keys_of(&record, thickness / MM), words)));
    }
    let file = library::find(name, folder)?;
    Ok(file.growth.map(|keys| (keys, file.title)))
}

/// The table of rates that a key of `[fatigue]` names.
pub(super) fn rates(given: &Given<'_>, key: &str) -> Result<Option<Rates>> {
    let Some(file) = given.get::<RateFile>(key.trim_start_matches("fatigue."))?.map(|file| file.keys()) else { return Ok(None) };
    let (table, _) = file.read(given.folder, key)?;
    let rows = table.rows.iter().map(|row| RatedRow { line: row.line, ratio: row.ratio, pair: [row.delta_k, row.rate] });
    let (rows, notes) = (rows.collect(), table.warnings);
    Ok(Some(Rates { rows, notes, columns: table.columns, says_ratio: table.says_ratio, file: file.file }))
}

/// The growth law of a material of the library, or of a `fitted.toml`, for a plate of this thickness, m, at a stress ratio; and the ΔK, Pa√m, between
/// which a fit knows it.
/// Errors: a material that has none, or no law over K; a fit of A and p at another stress ratio; files that cannot be read.
pub fn library_law(name: &str, thickness: f64, ratio: f64, folder: &Folder) -> Result<(Box<dyn GrowthLaw>, [f64; 2])> {
    let no_law = || input("materials", format!("\"{name}\""), "has no growth law over K", "see `perilife list materials`");
    let (keys, range) = match Document::in_folder(folder, name, &[]) {
        Ok(document) if LawRecord::is_of(&document.table) => {
            let record: LawRecord =
                slice(&Value::Table(document.table.clone()), "record").map_err(|error| document.locate(error))?;
            (record.fatigue, [record.delta_k_min_mpa_sqrt_m, record.delta_k_max_mpa_sqrt_m])
        }
        Ok(document) if document.table.contains_key("paris_m") => return law::of_record(&fitted_record(name, folder)?, ratio),
        _ => (growth_keys(name, thickness, folder)?.ok_or_else(no_law)?.0, [0.0, f64::INFINITY]),
    };
    // Strengths and elastic constants do not act on rates; a law that needs K_c has to have it.
    let material = Material::elastic(f64::NAN, f64::NAN, Plane::Stress);
    let (section, threshold) = (Value::Table(keys), 0.0);
    let law: Box<dyn GrowthLaw> =
        match read(threshold, None, &Given { section: &section, material: &material, ratios: [ratio; 2], folder, rates })? {
            Some(LawSource::Factor(law)) => Box::new(law),
            Some(LawSource::Paris(paris)) => Box::new(Walker { paris, gamma: 1.0, threshold }),
            _ => return Err(no_law()),
        };
    Ok((law, range.map(|k| k * MPA_SQRT_M)))
}

/// Refuses a power of ΔK at another stress ratio than that of its rates; what is to be said of other laws there.
pub(crate) fn ratio_line(record: &LawRecord, ratio: f64, key: &str) -> Result<Option<String>> {
    let (low, high) = (record.stress_ratio_min, record.stress_ratio_max);
    if (low - SAME_RATIO..=high + SAME_RATIO).contains(&ratio) {
        return Ok(None);
    }
    let fits = || GrowthLawKind::all().map(|kind| kind.0).filter(|law| law.fit.is_some());
    if fits().any(|law| law.name == record.kind() && !law.takes_ratio) {
        let problem = format!("is outside the fitted stress ratios, {low} to {high}; this law does not include R");
        let others: Vec<&str> = fits().filter(|law| law.takes_ratio).map(|law| law.name).collect();
        let (last, before) = others.split_last().map_or(("", String::new()), |(last, before)| (last, before.join(", ")));
        let remedy = format!("fit {before} or {last} to rates at several ratios");
        return Err(input(key, ratio, problem, remedy));
    }
    Ok(Some(format!("law: {} fitted for R = {low} to {high}, used at R = {ratio}", record.kind())))
}
