//! The law of `[fatigue]`: inline constants, or a record that `perilife calibrate` wrote.
//!
//! A case has one law: a second one, however it is given, is refused. Of a record of a law over K the constants take the place of
//! `fatigue.fitted`, as if they stood in the case. A driver that needs a law of the other kind, of bonds (A, p) or over
//! K (C, m), takes what the given one stands for.

use toml::Value;

use super::fatigue_keys::{FatigueKeys, LAWS, law_keys};
use super::growth_law::Setting;
use super::{LawSource, law};
use crate::case::record::{FittedRecord, LawRecord};
use crate::error::{Error, Result, input, input_missing};
use crate::fatigue::growth_law::GrowthLawKind;
use crate::fatigue::paris::ParisLaw;
use crate::fatigue::{FatigueLaw, STEADY_EXPONENTS, unsteady};
use crate::input::{Document, Folder, LENGTH, number, slice, value_at};
use crate::units::MM_PER_CYCLE;

/// Slack of a stress ratio against those of the rates.
const RATIO_SLACK: f64 = 0.02;

/// A law that the file gives.
pub(super) struct GivenLaw {
    /// Kinds of `fatigue.growth_law` that it can be.
    kinds: &'static [GrowthLawKind],
    /// The first of its keys that is given, with its value.
    key: &'static str,
    value: String,
}

impl GivenLaw {
    fn refused(&self, problem: String, remedy: &str) -> Error {
        input(&format!("fatigue.{}", self.key), &self.value, problem, remedy)
    }
}

/// The law of the case, of the kind that is asked for or else whose constants are given; `None` where the file gives none at all,
/// as in a calibration.
/// Errors: two laws, constants of another kind than `growth_law` or than the driver can have.
pub(super) fn read(
    (keys, fatigue): (&FatigueKeys, &Value),
    by_bonds: Option<bool>,
    setting: Setting<'_>,
) -> Result<Option<LawSource>> {
    const KEY: &str = "fatigue.growth_law";
    let given = only_law(keys.growth_law, fatigue)?;
    let kind = keys.growth_law.or(given.as_ref().and_then(|law| if let [only] = law.kinds { Some(*only) } else { None }));
    if let Some(kind @ (GrowthLawKind::Forman | GrowthLawKind::Nasgro | GrowthLawKind::Table)) = kind {
        if by_bonds.is_some() {
            let problem = "is no law of bonds, whose rate is a power of their strain";
            let remedy = "use fatigue.driver = \"tip_field\", or model.method = \"handbook\"";
            return Err(input(KEY, format!("\"{kind}\""), problem, remedy));
        }
        return keys.factor_law(kind, &setting).map(|law| Some(LawSource::Factor(law)));
    }
    if keys.k_c_mpa_sqrt_m.is_some() {
        let remedy = "leave it out, or choose its law by fatigue.growth_law";
        return Err(input_missing("fatigue.k_c_mpa_sqrt_m", "is no constant of this growth law", remedy));
    }
    let lacks = match kind {
        Some(GrowthLawKind::Paris | GrowthLawKind::Walker) if given.is_none() => Some("paris_c_mm_per_cycle"),
        Some(GrowthLawKind::Walker) if keys.walker_gamma.is_none() => Some("walker_gamma"),
        Some(GrowthLawKind::BondLaw) if given.is_none() => Some("a"),
        _ => None,
    };
    if let (Some(key), Some(kind)) = (lacks, kind) {
        let problem = format!("is missing, and growth_law is \"{kind}\"");
        return Err(input_missing(&format!("fatigue.{key}"), problem, "give all constants of the law"));
    }
    if let Some(fitted) = &keys.fitted {
        return read_record(fitted, setting.folder).map(Some);
    }
    let law = keys.bond_law()?.map(LawSource::Inline).or(keys.paris_law()?.map(LawSource::Paris));
    // What a driver cannot use as it is has to be translated.
    match &law {
        Some(LawSource::Inline(law)) if by_bonds != Some(false) && !STEADY_EXPONENTS.contains(&law.p) => {
            Err(unsteady("fatigue.p", law.p))
        }
        Some(LawSource::Paris(law)) if by_bonds.is_some() && !STEADY_EXPONENTS.contains(&law.m) => {
            Err(unsteady("fatigue.paris_m", law.m))
        }
        _ => Ok(law),
    }
}

/// The law that is given, if any: one, and of the kind asked for.
fn only_law(kind: Option<GrowthLawKind>, fatigue: &Value) -> Result<Option<GivenLaw>> {
    let mut laws = LAWS.iter().filter_map(|&(kinds, keys)| {
        let (key, value) = keys.iter().find_map(|&key| Some((key, value_at(fatigue, key)?)))?;
        Some(GivenLaw { kinds, key, value: shown(value) })
    });
    let Some(law) = laws.next() else { return Ok(None) };
    if let Some(second) = laws.next() {
        let problem = format!("stands beside fatigue.{}: the law is given twice", law.key);
        return Err(second.refused(problem, "give one law: fitted, or the constants of one kind"));
    }
    if let Some(kind) = kind.filter(|kind| !law.kinds.contains(kind)) {
        let problem = format!("is no constant of fatigue.growth_law = \"{kind}\"");
        return Err(law.refused(problem, "give the constants of that law, or leave growth_law out"));
    }
    Ok(Some(law))
}

/// A value as the messages show it.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Float(number) => number.to_string(),
        other => other.to_string(),
    }
}

impl FatigueKeys {
    fn bond_law(&self) -> Result<Option<FatigueLaw>> {
        let keys = [("a", self.a), ("p", self.p), ("horizon_mm", self.horizon_mm)];
        let Some([a, p, horizon]) = together(keys, "give a, p and horizon_mm together, or fitted")? else {
            return Ok(None);
        };
        Ok(Some(FatigueLaw {
            a: number("a constant in 1/cycle", 1e-60, 1e100).read("fatigue.a", a)?,
            p: number("an exponent", 0.5, 20.0).read("fatigue.p", p)?,
            horizon: LENGTH.read("fatigue.horizon_mm", horizon)?,
        }))
    }

    fn paris_law(&self) -> Result<Option<ParisLaw>> {
        let keys = [("paris_c_mm_per_cycle", self.paris_c_mm_per_cycle), ("paris_m", self.paris_m)];
        let Some([c, m]) = together(keys, "give paris_c_mm_per_cycle and paris_m together, or fitted")? else {
            return Ok(None);
        };
        let c = number("a rate in mm/cycle at ΔK = 1 MPa√m", 1e-60, 1e3).read("fatigue.paris_c_mm_per_cycle", c)?;
        Ok(Some(ParisLaw { c: c * MM_PER_CYCLE, m: number("an exponent", 0.5, 20.0).read("fatigue.paris_m", m)? }))
    }
}

/// All of the keys or none of them.
fn together<const N: usize>(keys: [(&str, Option<f64>); N], remedy: &str) -> Result<Option<[f64; N]>> {
    if keys.iter().all(|(_, value)| value.is_none()) {
        return Ok(None);
    }
    let mut values = [f64::NAN; N];
    for (slot, (key, value)) in values.iter_mut().zip(&keys) {
        let why = if *key == "horizon_mm" { ": A is meaningless without the horizon it belongs to" } else { "" };
        *slot = value.ok_or_else(|| input_missing(&format!("fatigue.{key}"), format!("is missing{why}"), remedy))?;
    }
    Ok(Some(values))
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
        let problem = "holds a law over K that was fitted to rates, not A and p";
        return Err(input("fitted", format!("\"{name}\""), problem, "give a record of a fit to a-N readings"));
    }
    let record = slice::<FittedRecord>(&Value::Table(document.table.clone()), "record").and_then(|record| {
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
        let problem = format!("is not the law that {name} holds, {}", record.kind());
        return Err(input("fatigue.growth_law", format!("\"{asked}\""), problem, "leave it out, or give a record of that law"));
    }
    table.remove("fitted");
    table.remove("growth_law");
    let beside = law_keys().chain(["walker_gamma"]).find(|key| table.contains_key(*key));
    if let Some(key) = beside {
        let problem = "stands beside fatigue.fitted, which holds a law: it is given twice";
        return Err(input_missing(&format!("fatigue.{key}"), problem, "give the record, or all constants in the case"));
    }
    table.extend(record.fatigue.clone());
    Ok(Some((Value::Table(table), Box::new(record))))
}

/// Refuses a power of ΔK at another stress ratio than that of its rates; what is to be said of other laws there.
pub(super) fn ratio_line(record: &LawRecord, ratio: f64) -> Result<Option<String>> {
    let (low, high) = (record.stress_ratio_min, record.stress_ratio_max);
    if (low - RATIO_SLACK..=high + RATIO_SLACK).contains(&ratio) {
        return Ok(None);
    }
    if record.kind() == GrowthLawKind::Paris.name() {
        let problem = format!(
            "is outside the stress ratios that the law was fitted to, {low} to {high}, and ΔK alone says nothing about R"
        );
        return Err(input("loading.stress_ratio", ratio, problem, "fit walker, forman or nasgro to rates at several ratios"));
    }
    Ok(Some(format!("the law {} was fitted to stress ratios from {low} to {high} and is used at {ratio}", record.kind())))
}
