//! Results of a sweep: plan, outcome of every case, `sweep.csv`, `sweep.json`, `life.svg`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::chart::{self, Mark, Series};
use super::output::{write_json, write_table};
use perilife_base::columns::{Table, exact_text};
use perilife_base::error::{Error, Result, input_missing};
use perilife_calibration::sweep::distribution::quantile;
use perilife_calibration::sweep::draw::label;
use perilife_calibration::sweep::{DrawnCase, Sweep, design};
use perilife_growth::predict::StopReason;

pub const PLAN_FILE: &str = "plan.json";
pub const OUTCOME_FILE: &str = "outcome.toml";
pub const TABLE_FILE: &str = "sweep.csv";
pub const FIGURES_FILE: &str = "sweep.json";
pub const CHART_FILE: &str = "life.svg";
/// Failures that the figures list at most; the table has all.
const FAILURES_MAX: usize = 100;

/// What a sweep consists of: all that is needed to collect its results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    pub version: String,
    pub name: String,
    pub design: Value,
    pub columns: Vec<String>,
    pub cases: Vec<PlannedCase>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlannedCase {
    pub input: String,
    /// Its values, as the table writes them.
    pub values: Vec<String>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outcome {
    pub input: String,
    pub life_cycles: Option<f64>,
    pub stop_reason: Option<String>,
    /// Whether that is less than what the plate lives, all that could end it sooner being checked.
    pub life_is_lower_bound: Option<bool>,
    pub crack_length_final_mm: Option<f64>,
    pub wall_s: f64,
    pub problem: Option<String>,
    /// Whether a machine was to blame and not the input, so that the next call tries again.
    #[serde(default)]
    pub try_again: bool,
    #[serde(default)]
    pub warnings: Vec<Told>,
    pub has_files: bool,
}

/// A message of a case, with its effect on the life or the share of the life where that is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Told {
    pub words: String,
    pub percent: Option<f64>,
}

impl Outcome {
    /// Whether its run ended before the plate did ([`StopReason::is_lower_bound`]).
    fn is_cut_off(&self) -> bool {
        self.stop_reason.as_deref().and_then(|reason| reason.parse::<StopReason>().ok()).is_some_and(StopReason::is_lower_bound)
    }

    /// A case by the figures of its run; one that was refused has no result.
    pub fn of(case: &DrawnCase, figures: &Value, has_files: bool) -> Self {
        let wall_s = figures["wall_s"].as_f64().unwrap_or(0.0);
        if let Some(refused) = figures["refused"].as_str() {
            return Self::failed(case, refused, wall_s);
        }
        let text = |value: &Value| value.as_str().map(str::to_owned);
        let all = |key: &str| figures[key].as_array().into_iter().flatten();
        let rounded = |percent: f64| (100.0 * percent).round() / 100.0;
        let told = |words, percent: &Value| Some(Told { words: text(words)?, percent: percent.as_f64().map(rounded) });
        let warned = all("warnings").filter_map(|line| told(line, &Value::Null));
        let cautions = all("checks").filter(|check| check["verdict"] == "caution");
        let cautions = cautions.filter_map(|check| told(&check["words"], &check["effect_percent"]));
        Outcome {
            life_cycles: figures["life_cycles"].as_f64(),
            stop_reason: text(&figures["stop_reason"]),
            life_is_lower_bound: figures["life_is_lower_bound"].as_bool(),
            crack_length_final_mm: figures["crack_length_final_mm"].as_f64(),
            problem: None,
            warnings: warned.chain(cautions).collect(),
            has_files,
            ..Self::failed(case, "", wall_s)
        }
    }

    pub fn failed(case: &DrawnCase, problem: &str, wall_s: f64) -> Self {
        Outcome { input: case.hash.clone(), wall_s, problem: Some(problem.to_owned()), ..Outcome::default() }
    }
}

impl Plan {
    pub fn new(sweep: &Sweep, cases: &[DrawnCase]) -> Self {
        let planned =
            |case: &DrawnCase| PlannedCase { input: case.hash.clone(), values: case.values.iter().map(written).collect() };
        Plan {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            name: sweep.name.clone(),
            design: design::echo(&sweep.document.table),
            columns: sweep.columns(),
            cases: cases.iter().map(planned).collect(),
        }
    }

    /// As [`read_plan`] gives it back: numbers may be of another type, of the same value.
    pub fn as_read(&self) -> Plan {
        let read = serde_json::to_string(self).ok().and_then(|text| serde_json::from_str(&text).ok());
        read.unwrap_or_else(|| self.clone())
    }
}

fn written(value: &toml::Value) -> String {
    match value {
        toml::Value::Float(number) => exact_text(*number),
        toml::Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// `sweep.csv`: a row for each case in order; one that is not there yet says so.
pub fn table(plan: &Plan, outcomes: &[Option<Outcome>]) -> Table {
    let of = |value: &dyn Fn(&Outcome) -> Option<f64>| {
        outcomes.iter().map(|outcome| outcome.as_ref().and_then(value).unwrap_or(f64::NAN)).collect::<Vec<_>>()
    };
    let words = |value: &dyn Fn(&Outcome) -> Option<String>, missing: &str| {
        let of_case = |outcome: &Option<Outcome>| outcome.as_ref().map_or(Some(missing.to_owned()), value).unwrap_or_default();
        outcomes.iter().map(of_case).collect::<Vec<_>>()
    };
    let table = Table::new(TABLE_FILE).words("case", (1..=plan.cases.len()).map(label));
    let with_key = |table: Table, (place, key): (usize, &String)| {
        table.foreign(key.clone(), plan.cases.iter().map(|case| case.values[place].clone()))
    };
    let table = plan.columns.iter().enumerate().fold(table, with_key);
    table
        .exact("life_cycles", of(&|outcome| outcome.life_cycles))
        .words("stop_reason", words(&|outcome| outcome.stop_reason.clone(), ""))
        .numbers("crack_length_final_mm", of(&|outcome| outcome.crack_length_final_mm))
        .exact("wall_s", of(&|outcome| Some(outcome.wall_s)))
        .foreign("problem", words(&|outcome| outcome.problem.as_ref().map(|problem| problem.replace('\n', " ")), "not run yet"))
        .words("life_is_lower_bound", words(&|outcome| outcome.life_is_lower_bound.map(|is_lower| is_lower.to_string()), ""))
}

/// `sweep.json`: the design, counts, quantiles of life, failures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepRecord {
    pub name: String,
    pub cases: usize,
    pub succeeded: usize,
    pub failed: usize,
    pub missing: usize,
    pub run_outs: usize,
    pub unlimited: usize,
    pub lower_bounds: usize,
    pub life_cycles: LifeQuantiles,
    pub failures: Vec<Failure>,
    pub missing_cases: Vec<String>,
    pub warnings: Vec<SharedWarning>,
    pub columns: Vec<String>,
    pub design: Value,
    pub version: String,
    pub wall_s: f64,
    pub computing_s: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    pub case: String,
    pub problem: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SharedWarning {
    pub cases: usize,
    /// The first case that has it, and its words.
    pub first: String,
    pub warning: String,
    /// The largest effect or share of those that have one, and its case.
    pub largest_percent: Option<f64>,
    pub largest_in: Option<String>,
}

impl SweepRecord {
    pub fn of(plan: &Plan, outcomes: &[Option<Outcome>], wall_s: f64) -> Self {
        let there = || outcomes.iter().flatten();
        let problem = |(i, outcome): (usize, &Option<Outcome>)| {
            Some(Failure { case: label(i + 1), problem: outcome.as_ref()?.problem.clone()? })
        };
        let failures = || outcomes.iter().enumerate().filter_map(problem);
        let missing = outcomes.iter().enumerate().filter(|(_, outcome)| outcome.is_none());
        let missing_cases: Vec<String> = missing.map(|(i, _)| label(i + 1)).collect();
        let run_out = |outcome: &&Outcome| outcome.stop_reason.as_deref() == Some(StopReason::RunOut.name());
        let lives = Lives::of(outcomes);
        SweepRecord {
            name: plan.name.clone(),
            cases: plan.cases.len(),
            succeeded: there().filter(|outcome| outcome.problem.is_none()).count(),
            failed: failures().count(),
            missing: missing_cases.len(),
            run_outs: there().filter(run_out).count(),
            unlimited: lives.unlimited,
            lower_bounds: lives.bounds,
            life_cycles: lives.figures(),
            failures: failures().take(FAILURES_MAX).collect(),
            missing_cases,
            warnings: warnings(outcomes),
            columns: plan.columns.clone(),
            design: plan.design.clone(),
            version: plan.version.clone(),
            wall_s,
            computing_s: there().map(|outcome| outcome.wall_s).sum(),
        }
    }
}

/// Before a quantile that is at least its figure.
pub const ABOVE: &str = "above ";

/// Quantiles of lives: null where the lives do not say them, and in words.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LifeQuantiles {
    pub p05: Option<f64>,
    pub p50: Option<f64>,
    pub p95: Option<f64>,
    pub words: QuantileWords,
    pub least: Option<f64>,
    pub most: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuantileWords {
    pub p05: Option<String>,
    pub p50: Option<String>,
    pub p95: Option<String>,
}

#[derive(Debug, Clone)]
pub(super) struct Lives {
    /// Upwards, each with whether it is a lower bound; unlimited ones at the end, infinite.
    pub sorted: Vec<(f64, bool)>,
    pub unlimited: usize,
    pub bounds: usize,
}

impl Lives {
    fn of(outcomes: &[Option<Outcome>]) -> Self {
        let there = || outcomes.iter().flatten().filter(|outcome| outcome.problem.is_none());
        Lives::ranked(there().map(|outcome| (outcome.life_cycles.unwrap_or(f64::INFINITY), outcome.is_cut_off())))
    }

    /// Of lives, infinite where they are unlimited, and whether each is a lower bound.
    pub fn ranked(lives: impl Iterator<Item = (f64, bool)>) -> Self {
        let mut sorted: Vec<(f64, bool)> = lives.collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let unlimited = sorted.iter().filter(|(life, _)| life.is_infinite()).count();
        let bounds = sorted.iter().filter(|(_, is_bound)| *is_bound).count();
        Lives { sorted, unlimited, bounds }
    }

    /// A quantile: its figure where no bound lies below it, and in words. A bound is at least its figure, so that the quantile of the
    /// figures is a bound as well.
    fn quantile(&self, q: f64) -> (Option<f64>, Option<String>) {
        let figures: Vec<f64> = self.sorted.iter().map(|(life, _)| *life).collect();
        let value = quantile(&figures, q);
        if figures.is_empty() {
            return (None, None);
        }
        if !value.is_finite() {
            return (None, Some("unlimited".to_owned()));
        }
        let is_bound = self.sorted.iter().any(|(life, is_bound)| *is_bound && *life <= value);
        if is_bound { (None, Some(format!("{ABOVE}{value:.0}"))) } else { (Some(value), Some(format!("{value:.0}"))) }
    }

    pub fn figures(&self) -> LifeQuantiles {
        let [p05, p50, p95] = [0.05, 0.5, 0.95].map(|q| self.quantile(q));
        let ends = || self.sorted.iter().filter(|(life, _)| life.is_finite()).map(|(life, _)| *life);
        LifeQuantiles {
            p05: p05.0,
            p50: p50.0,
            p95: p95.0,
            words: QuantileWords { p05: p05.1, p50: p50.1, p95: p95.1 },
            least: ends().next(),
            most: ends().next_back(),
        }
    }
}

pub fn write(folder: &Path, plan: &Plan, outcomes: &[Option<Outcome>], wall_s: f64) -> Result<SweepRecord> {
    let record = SweepRecord::of(plan, outcomes, wall_s);
    write_table(folder, &table(plan, outcomes))?;
    draw(&folder.join(CHART_FILE), plan, outcomes)?;
    // Last, so that whoever waits for it finds the others.
    write_json(folder, FIGURES_FILE, &record)?;
    Ok(record)
}

/// `life.svg`: life over the first key that varies if that is a number, else the share of cases that have ended by then.
fn draw(path: &Path, plan: &Plan, outcomes: &[Option<Outcome>]) -> Result<()> {
    let mut over: Vec<(f64, f64)> = plan
        .cases
        .iter()
        .zip(outcomes)
        .filter_map(|(case, outcome)| Some((case.values.first()?.parse().ok()?, outcome.as_ref()?.life_cycles?)))
        .collect();
    let title = |what: &str| format!("{}: {what}", plan.name);
    let first = plan.columns.first().filter(|key| !key.starts_with("fitted.") && !over.is_empty());
    if let Some(key) = first {
        over.sort_by(|a, b| a.0.total_cmp(&b.0));
        // One key of a grid gives a curve, several keys or chance a cloud.
        let is_curve = plan.columns.len() == 1 && over.windows(2).all(|pair| pair[0].0 < pair[1].0) && over.len() < 100;
        let mark = if is_curve { Mark::Line } else { Mark::Dots };
        let series = Series { name: format!("{} cases", over.len()), points: over, mark };
        return chart::linear(path, &title("life"), [key, "Life N, cycles"], &[series]);
    }
    let lives = Lives::of(outcomes).sorted;
    let share = |i: usize| 100.0 * (i as f64 + 0.5) / lives.len() as f64;
    // One that goes on has not ended.
    let ended = lives.iter().enumerate().filter(|(_, (life, is_bound))| life.is_finite() && !is_bound);
    let points: Vec<(f64, f64)> = ended.map(|(i, (life, _))| (*life, share(i))).collect();
    let series = Series { name: format!("{} of {} cases", points.len(), lives.len()), points, mark: Mark::Dots };
    chart::linear(path, &title("distribution of life"), ["Life N, cycles", "Share of cases that have ended, %"], &[series])
}

pub fn read_plan(folder: &Path) -> Result<Option<Plan>> {
    let path = folder.join(PLAN_FILE);
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(Error::file(&path, "cannot read", error)),
    };
    serde_json::from_str(&text).map(Some).map_err(|error| {
        let remedy = "remove the folder, and run `perilife sweep` again";
        input_missing("file", format!("is no plan of a sweep: {error}"), remedy).in_file(&path)
    })
}

/// Outcome in the folder of a case, if it is that of this input. One that cannot be read counts as none: it is made again.
pub fn read_outcome(folder: &Path, input: &str) -> Option<Outcome> {
    // TOML and not JSON: its reader gives back every bit of a number.
    let text = std::fs::read_to_string(folder.join(OUTCOME_FILE)).ok()?;
    toml::from_str::<Outcome>(&text).ok().filter(|outcome| outcome.input == input)
}

const WARNINGS_MAX: usize = 20;

/// Warnings by number of cases; those that differ in their numbers only are one, told by the first case that has it, with the largest effect.
fn warnings(outcomes: &[Option<Outcome>]) -> Vec<SharedWarning> {
    let mut found: BTreeMap<String, Vec<(usize, &Told)>> = BTreeMap::new();
    for (i, outcome) in outcomes.iter().enumerate() {
        for warning in outcome.iter().flat_map(|outcome| &outcome.warnings) {
            let words = warning.words.chars().filter(|c| !c.is_ascii_digit()).collect();
            found.entry(words).or_default().push((i + 1, warning));
        }
    }
    let mut found: Vec<Vec<(usize, &Told)>> = found.into_values().collect();
    found.sort_by_key(|all| (std::cmp::Reverse(all.len()), all[0].0));
    let told = |all: Vec<(usize, &Told)>| {
        let (first, one) = all[0];
        let shares = all.iter().filter_map(|(case, told)| Some((told.percent?, *case)));
        let largest = shares.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        SharedWarning {
            cases: all.len(),
            first: label(first),
            warning: one.words.clone(),
            largest_percent: largest.map(|(share, _)| share),
            largest_in: largest.map(|(_, case)| label(case)),
        }
    };
    found.into_iter().take(WARNINGS_MAX).map(told).collect()
}
