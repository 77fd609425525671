//! `[loading]` of a scene: what is pulled, pushed or thrown, where, and in what time.

use serde::Deserialize;
use toml::{Table, Value};

use super::load::{self, Clock};
use crate::scene::{Procedure, SceneLoad};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{TIME, number, shorten, slice, table_of};
use perilife_plate::specimen::Specimen;

/// Keys of `[loading]` that concern all loads; one of several loads may have a `ramp_s` of its own.
const COMMON: &[&str] = &["parts", "steps", "iterations_per_step", "duration_s", "time_step_s", "ramp_s"];
/// More than this is a slip.
const PARTS_MAX: usize = 50;
/// Key of the iterations in a load step.
const ITERATIONS: &str = "loading.iterations_per_step";
/// More than these come to rest.
const ITERATIONS_MAX: u64 = 10_000;
/// More load steps than this are a slip.
const STEPS_MAX: u64 = 1_000_000;

#[derive(Deserialize)]
struct CommonInput {
    parts: Option<Vec<Value>>,
    steps: Option<u64>,
    iterations_per_step: Option<u64>,
    duration_s: Option<f64>,
    time_step_s: Option<f64>,
    ramp_s: Option<f64>,
}

/// What `[loading]` asks for.
pub struct Loading {
    /// Loads.
    pub drives: Vec<SceneLoad>,
    /// How they are worked through.
    pub procedure: Procedure,
}

/// Reads `[loading]` and puts the tractions on `specimen`, in Pa.
pub fn from_value(value: &Value, specimen: &mut Specimen) -> Result<Loading> {
    let table = table_of(value, "loading")?;
    for (key, value) in table {
        let key = key.as_str();
        if !COMMON.contains(&key) && !load::KEYS.contains(&key) {
            return Err(unknown(key, value));
        }
    }
    let (common, own): (Table, Table) =
        table.iter().map(|(key, value)| (key.clone(), value.clone())).partition(|(key, _)| COMMON.contains(&key.as_str()));
    let common: CommonInput = slice(&Value::Table(common), "loading")?;
    let ramp = TIME.read_optional("loading.ramp_s", common.ramp_s)?.unwrap_or(0.0);
    let procedure = procedure(&common)?;
    let clock = match procedure {
        Procedure::Dynamic { duration, .. } => Some(Clock { duration, ramp }),
        Procedure::Static | Procedure::QuasiStatic { .. } => None,
    };
    let mut drives = Vec::new();
    match &common.parts {
        None if own.is_empty() => {
            let remedy = "give kind = \"traction\", \"displacement\", \"velocity\" or \"platens\", or parts = [{ kind = ... }]";
            return Err(input_missing("loading.kind", "is missing", remedy));
        }
        None => drives.extend(load::drives(&Value::Table(own), "loading", clock, specimen)?),
        Some(parts) => {
            if let Some((key, value)) = own.iter().next() {
                let problem = "stands beside parts, each of which has keys of its own";
                return Err(input(&format!("loading.{key}"), shorten(value), problem, "move it into a part"));
            }
            if parts.is_empty() || parts.len() > PARTS_MAX {
                let remedy = format!("give 1 to {PARTS_MAX} loads {{ kind = ..., edges = [...], ... }}");
                return Err(input("loading.parts", format!("{} parts", parts.len()), "is no loading", remedy));
            }
            for (i, part) in parts.iter().enumerate() {
                drives.extend(load::drives(part, &format!("loading.parts[{i}]"), clock, specimen)?);
            }
        }
    }
    Ok(Loading { drives, procedure })
}

fn unknown(key: &str, value: &Value) -> perilife_base::error::Error {
    let path = format!("loading.{key}");
    if ["stress_max_mpa", "stress_range_mpa", "stress_ratio", "force_max_n", "force_range_n", "pins"].contains(&key) {
        let remedy = "give kind and stress_mpa, displacement_mm or velocity_mm_s; cycles are what `perilife predict` runs";
        return input(&path, shorten(value), "belongs to the cycles of a fatigue case, not to a fracture scene", remedy);
    }
    let known = load::KEYS.iter().chain(COMMON).copied().collect::<Vec<_>>().join(", ");
    input(&path, shorten(value), "is not a known key", format!("known here: {known}"))
}

fn procedure(common: &CommonInput) -> Result<Procedure> {
    let duration = TIME.read_optional("loading.duration_s", common.duration_s)?;
    let time_step = TIME.read_optional("loading.time_step_s", common.time_step_s)?;
    let each = common.iterations_per_step.map(|each| whole(ITERATIONS, each, ITERATIONS_MAX)).transpose()?;
    if let (Some(each), None) = (each, common.steps) {
        return Err(input(ITERATIONS, each, "has no meaning without load steps", "give steps, or leave it out"));
    }
    match (common.steps, duration) {
        (Some(steps), Some(_)) => {
            let problem = "stands beside duration_s: load steps have no time, and time has steps of its own";
            Err(input("loading.steps", steps, problem, "give steps (no inertia) or duration_s with time_step_s (motion)"))
        }
        (Some(steps), None) if steps == 0 || steps > STEPS_MAX => {
            Err(input("loading.steps", steps, "is no number of load steps", format!("give 1 to {STEPS_MAX}")))
        }
        (steps, None) => {
            let timed = [("loading.time_step_s", common.time_step_s), ("loading.ramp_s", common.ramp_s)];
            if let Some((key, value)) = timed.into_iter().find_map(|(key, value)| Some((key, value?))) {
                return Err(input(key, value, "has no meaning without duration_s", "give duration_s, or leave it out"));
            }
            Ok(steps.map_or(Procedure::Static, |steps| Procedure::QuasiStatic { steps: steps as usize, iterations: each }))
        }
        (None, Some(duration)) => {
            if let Some(step) = time_step.filter(|step| *step > duration) {
                let problem = format!("is longer than duration_s, {duration}");
                return Err(input("loading.time_step_s", step, problem, "give a smaller one, or leave it out"));
            }
            Ok(Procedure::Dynamic { duration, time_step })
        }
    }
}

/// A number of steps or a count in an input file, for messages of other sections.
pub fn whole(key: &str, value: u64, high: u64) -> Result<usize> {
    number("a whole number", 1.0, high as f64).read(key, value as f64).map(|value| value as usize)
}
