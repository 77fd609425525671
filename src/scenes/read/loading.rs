//! `[loading]` of a scene: what is pulled, pushed or thrown, where, and in what time.

use toml::{Table, Value};

use super::load::{self, Clock, LoadKeys};
use crate::scene::{Procedure, SceneLoad};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{TIME, shorten, table_of};
use perilife_base::keys::{Section, key, number, section_beside};
use perilife_plate::specimen::Specimen;

/// More than this is a slip.
const PARTS_MAX: usize = 50;
/// Key of the iterations in a load step.
const ITERATIONS: &str = "loading.iterations_per_step";

perilife_base::keys! {
    /// Keys of `[loading]` that concern all loads; one of several loads may have a `ramp_s` of its own.
    pub struct CommonKeys {
        parts: Option<Vec<Value>> = key("parts", "Loads: each with keys of its own");
        steps: Option<usize> = number("steps", "Load steps", "a number of load steps", 1.0, 1e6);
        iterations: Option<usize> = number("iterations_per_step", "Iterations in a load step: default to rest", "a whole number", 1.0, 10_000.0);
        duration: Option<f64> = key("duration_s", "Duration: of motion").of(TIME);
        time_step: Option<f64> = key("time_step_s", "Time step: of motion").of(TIME);
        ramp: Option<f64> = key("ramp_s", "Ramp: duration of the linear rise of all loads").of(TIME);
    }
}
/// Key of a load and of all of them.
const RAMP: &str = "ramp_s";

pub struct Loading {
    pub drives: Vec<SceneLoad>,
    /// How they are worked through.
    pub procedure: Procedure,
}

/// Reads `[loading]` and puts the tractions on `specimen`, in Pa.
pub fn from_value(value: &Value, specimen: &mut Specimen) -> Result<Loading> {
    let table = table_of(value, "loading")?;
    if let Some((key, value)) = table.iter().find(|(key, _)| OF_CYCLES.contains(&key.as_str())) {
        let remedy = "give kind and stress_mpa, displacement_mm or velocity_mm_s; use `perilife predict` for cycles";
        let problem = "applies only to fatigue cases";
        return Err(input(&format!("loading.{key}"), shorten(value), problem, remedy));
    }
    let is_common = |key: &str| CommonKeys::KEYS.iter().any(|own| own.name == key);
    let of_loads: Vec<&str> = LoadKeys::KEYS.iter().map(|key| key.name).filter(|key| *key != RAMP).collect();
    let common: CommonKeys = section_beside(value, "loading", &of_loads)?;
    let own: Table = table.iter().filter(|(key, _)| !is_common(key)).map(|(key, value)| (key.clone(), value.clone())).collect();
    let ramp = common.ramp.unwrap_or(0.0);
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
                let problem = "conflicts with parts";
                return Err(input(&format!("loading.{key}"), shorten(value), problem, "move it to a part"));
            }
            if parts.is_empty() || parts.len() > PARTS_MAX {
                let remedy = format!("give 1 to {PARTS_MAX} loads {{ kind = ..., edges = [...], ... }}");
                return Err(input("loading.parts", format!("{} parts", parts.len()), "is not a loading", remedy));
            }
            for (i, part) in parts.iter().enumerate() {
                drives.extend(load::drives(part, &format!("loading.parts[{i}]"), clock, specimen)?);
            }
        }
    }
    Ok(Loading { drives, procedure })
}

/// Keys of cases.
const OF_CYCLES: [&str; 6] = ["stress_max_mpa", "stress_range_mpa", "stress_ratio", "force_max_n", "force_range_n", "pins"];

fn procedure(common: &CommonKeys) -> Result<Procedure> {
    let CommonKeys { duration, time_step, iterations: each, .. } = *common;
    if let (Some(each), None) = (each, common.steps) {
        return Err(input(ITERATIONS, each, "requires load steps", "give steps, or remove it"));
    }
    match (common.steps, duration) {
        (Some(steps), Some(_)) => {
            let problem = "conflicts with duration_s: load steps have no time";
            Err(input("loading.steps", steps, problem, "give steps (no inertia) or duration_s with time_step_s (motion)"))
        }
        (steps, None) => {
            let timed = [("loading.time_step_s", time_step), ("loading.ramp_s", common.ramp)];
            if let Some((key, value)) = timed.into_iter().find_map(|(key, value)| Some((key, value?))) {
                return Err(input(key, value, "requires duration_s", "give duration_s, or remove it"));
            }
            Ok(steps.map_or(Procedure::Static, |steps| Procedure::QuasiStatic { steps, iterations: each }))
        }
        (None, Some(duration)) => {
            if let Some(step) = time_step.filter(|step| *step > duration) {
                let problem = format!("is longer than duration_s, {duration}");
                return Err(input("loading.time_step_s", step, problem, "use a smaller one, or remove it"));
            }
            Ok(Procedure::Dynamic { duration, time_step })
        }
    }
}
