//! `SWEEP.toml`: the base case and the design of a sweep.

use toml::{Table, Value};

use super::vary::{DesignKind, Spread, Vary};
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::Document;
use perilife_base::keys::{self, key};

perilife_base::kinds! {
    /// Where the scatter of a fatigue law comes from.
    pub enum Scatter for "design.scatter" {
        Specimens = "specimens": "scatter between specimens (fit.json)",
        Constants = "constants": "standard errors of the common fit (rate at the reference ΔK, exponent)",
    }
}

/// Cases that a sweep may have unless more are asked for.
pub const CASES_MAX: usize = 10_000;
const SEED: u64 = 1;

#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    pub kind: DesignKind,
    pub cases: usize,
    pub seed: u64,
    pub scatter: Scatter,
    pub vary: Vec<Vary>,
}

#[derive(Debug, Clone)]
pub struct Sweep {
    pub name: String,
    pub document: Document,
    pub base: Document,
    pub design: Design,
}

pub fn is_sweep(table: &Table) -> bool {
    table.contains_key("design")
}

perilife_base::keys! {
    pub struct SweepKeys {
        case: String = key("case", "Base case: its file");
        design: DesignKeys = key("design", "Design: grid or random");
        vary: Vec<Value> = key("vary", "Keys that vary"), or "none" Vec::new();
    }
    pub struct DesignKeys {
        kind: DesignKind = key("kind", "Design");
        samples: Option<usize> = key("samples", "Number of cases: of a random design");
        seed: Option<u64> = key("seed", "Seed: of a random design; default 1");
        scatter: Option<Scatter> = key("scatter", "Scatter of the law: default specimens");
    }
}

impl Sweep {
    /// Reads a sweep from its file, which was read without overrides. Those of `design` and `vary` are of the file, all others of the base
    /// case; there may be at most `most` cases.
    pub fn with_overrides(mut document: Document, overrides: &[String], most: usize) -> Result<Self> {
        let section = |text: &str| text.split(['.', '[', '=']).next().unwrap_or_default().trim().to_owned();
        let of_sweep = |text: &String| ["design", "vary"].contains(&section(text).as_str());
        let (own, of_case): (Vec<String>, Vec<String>) = overrides.iter().cloned().partition(of_sweep);
        document.set_all(&own)?;
        let read = || -> Result<(String, Design)> {
            let input: SweepKeys = keys::section(&Value::Table(document.table.clone()), "")?;
            Ok((input.case, read_design(&input.design, &input.vary, most)?))
        };
        let (case, design) = read().map_err(|error| document.locate(error))?;
        let base = Document::in_folder(&document.folder, &case, &of_case)?;
        Ok(Sweep { name: document.name.clone(), document, base, design })
    }
}

fn read_design(keys: &DesignKeys, vary: &[Value], most: usize) -> Result<Design> {
    let kind = keys.kind;
    let vary: Vec<Vary> =
        vary.iter().enumerate().map(|(i, value)| Vary::read(value, &format!("vary[{i}]"), kind, most)).collect::<Result<_>>()?;
    for (i, one) in vary.iter().enumerate() {
        if vary[..i].iter().any(|earlier| earlier.key == one.key) {
            let place = format!("vary[{i}].key");
            return Err(input(&place, format!("\"{}\"", one.key), "is given twice", "give each key once"));
        }
    }
    let remedy = "write a section [[vary]] with a key and its values";
    fail_if!(vary.is_empty() && kind != DesignKind::FittedScatter, input_missing("vary", "is missing: no key varies", remedy));
    if let Some(scatter) = keys.scatter.filter(|_| kind != DesignKind::FittedScatter) {
        let remedy = format!("remove it, or use kind = \"{}\"", DesignKind::FittedScatter);
        let problem = format!("cannot be combined with kind = \"{kind}\"");
        return Err(input("design.scatter", format!("\"{scatter}\""), problem, remedy));
    }
    let cases = match kind {
        DesignKind::Grid => grid_size(keys, &vary, most)?,
        DesignKind::LatinHypercube | DesignKind::FittedScatter => {
            let samples = keys.samples.ok_or_else(|| {
                input_missing("design.samples", format!("is missing (required by kind = \"{kind}\")"), "give the number of cases")
            })?;
            check_size("design.samples", samples, most)?
        }
    };
    Ok(Design { kind, cases, seed: keys.seed.unwrap_or(SEED), scatter: keys.scatter.unwrap_or(Scatter::Specimens), vary })
}

fn grid_size(keys: &DesignKeys, vary: &[Vary], most: usize) -> Result<usize> {
    let stranger = keys.samples.map(|n| ("design.samples", n as u64)).or(keys.seed.map(|seed| ("design.seed", seed)));
    if let Some((key, value)) = stranger {
        let remedy = "remove it: the values of the keys define a grid";
        return Err(input(key, value, format!("cannot be combined with kind = \"{}\"", DesignKind::Grid), remedy));
    }
    let sizes = vary.iter().map(|one| if let Spread::Values(values) = &one.spread { values.len() } else { 1 });
    check_size("vary", sizes.fold(1, usize::saturating_mul), most)
}

fn check_size(key: &str, cases: usize, most: usize) -> Result<usize> {
    fail_if!(cases == 0, input(key, cases, "must be at least 1", "give at least 1"));
    let problem = || format!("makes {cases} cases; limit {most}");
    fail_if!(cases > most, input(key, format!("{cases} cases"), problem(), "make it smaller, or allow more by --most"));
    Ok(cases)
}

/// The design as results repeat it: the sweep file as it was read.
pub fn echo(table: &Table) -> serde_json::Value {
    // A table that was read from TOML has a JSON form; dates, of which a sweep has none, become text.
    serde_json::to_value(table).unwrap_or_default()
}
