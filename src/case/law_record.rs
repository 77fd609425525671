//! `fatigue.fitted` of a law over K: its constants take the place of the key, as if they stood in the case.

use toml::Value;

use super::law_source::LAW_KEYS;
use crate::case::record::LawRecord;
use crate::error::{Result, input, input_missing};
use crate::fatigue::growth_law::GrowthLawKind;
use crate::input::{Folder, slice, value_at};

/// Slack of a stress ratio against those of the rates.
const RATIO_SLACK: f64 = 0.02;

/// `[fatigue]` with the constants of the record it names, and the record; `None` where it names none, one that does not exist, or one of
/// A and p.
///
/// # Errors
/// A record that cannot be read, beside constants of a law.
pub(super) fn expanded(fatigue: &Value, folder: &Folder) -> Result<Option<(Value, Box<LawRecord>)>> {
    let Some(name) = value_at(fatigue, "fitted").and_then(Value::as_str) else { return Ok(None) };
    // One that cannot be read is refused, or not missed, where records of A and p are.
    let Ok(document) = folder.document(name) else { return Ok(None) };
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
    let beside = LAW_KEYS.iter().copied().chain(["walker_gamma"]).find(|key| table.contains_key(*key));
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
