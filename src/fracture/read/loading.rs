//! `[loading]` of a scene: what is pulled, pushed or thrown, where, and in what time.

use serde::Deserialize;
use toml::{Table, Value};

use super::region;
use crate::error::{Result, input, input_missing};
use crate::fracture::scene::{Action, Drive, Procedure, Region};
use crate::input::{Quantity, TIME, number, shorten, slice, table_of};
use crate::specimen::{Edge, Load, Point, Specimen};
use crate::units::{MM, MPA};

crate::kinds! {
    /// Loads of fracture scenes.
    pub enum LoadKind for "loading.kind" {
        Traction = "traction": "stress_mpa on edges; fracture scenes",
        Displacement = "displacement": "displacement_mm of edges or regions, reached in the last of the steps or at the end of ramp_s; fracture scenes",
        Velocity = "velocity": "velocity_mm_s of edges or regions; fracture scenes with duration_s",
        Platens = "platens": "rigid plates without friction that press on edges by displacement_mm; fracture scenes",
    }
}

crate::kinds! {
    /// What driven points do across the direction in which they are driven.
    pub enum Transverse for "loading.transverse" {
        Free = "free": "driven points move freely across the direction of a displacement or velocity",
        Held = "held": "driven points do not move across the direction of a displacement or velocity",
    }
}

/// Keys of `[loading]` that concern all loads.
const COMMON: &[&str] = &["parts", "steps", "duration_s", "time_step_s", "ramp_s"];
/// Keys of one load.
const OF_A_LOAD: &[&str] = &[
    "kind",
    "edges",
    "regions",
    "grip_mm",
    "range_mm",
    "stress_mpa",
    "displacement_mm",
    "velocity_mm_s",
    "direction",
    "transverse",
];
/// More than this is a slip.
const PARTS_MAX: usize = 50;
/// More load steps than this are a slip.
const STEPS_MAX: u64 = 1_000_000;

#[derive(Deserialize)]
struct CommonInput {
    parts: Option<Vec<Value>>,
    steps: Option<u64>,
    duration_s: Option<f64>,
    time_step_s: Option<f64>,
    ramp_s: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LoadInput {
    kind: LoadKind,
    edges: Option<Vec<Edge>>,
    regions: Option<Vec<Value>>,
    grip_mm: Option<f64>,
    range_mm: Option<[f64; 2]>,
    stress_mpa: Option<f64>,
    displacement_mm: Option<f64>,
    velocity_mm_s: Option<f64>,
    direction: Option<[f64; 2]>,
    transverse: Option<Transverse>,
}

/// What `[loading]` asks for.
pub struct Loading {
    /// Loads.
    pub drives: Vec<Drive>,
    /// How they are worked through.
    pub procedure: Procedure,
}

/// Reads `[loading]` and puts the tractions on `specimen`, in Pa.
pub fn from_value(value: &Value, specimen: &mut Specimen) -> Result<Loading> {
    let table = table_of(value, "loading")?;
    for (key, value) in table {
        let key = key.as_str();
        if !COMMON.contains(&key) && !OF_A_LOAD.contains(&key) {
            return Err(unknown(key, value));
        }
    }
    let (common, own): (Table, Table) =
        table.iter().map(|(key, value)| (key.clone(), value.clone())).partition(|(key, _)| COMMON.contains(&key.as_str()));
    let common: CommonInput = slice(&Value::Table(common), "loading")?;
    let ramp = TIME.read_optional("loading.ramp_s", common.ramp_s)?.unwrap_or(0.0);
    let mut drives = Vec::new();
    match &common.parts {
        None if own.is_empty() => {
            let remedy = "give kind = \"traction\", \"displacement\", \"velocity\" or \"platens\", or parts = [{ kind = ... }]";
            return Err(input_missing("loading.kind", "is missing", remedy));
        }
        None => drives.extend(load(&Value::Table(own), "loading", ramp, specimen)?),
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
                drives.extend(load(part, &format!("loading.parts[{i}]"), ramp, specimen)?);
            }
        }
    }
    Ok(Loading { drives, procedure: procedure(&common)? })
}

fn unknown(key: &str, value: &Value) -> crate::Error {
    let path = format!("loading.{key}");
    if ["stress_max_mpa", "stress_range_mpa", "stress_ratio", "force_max_n", "force_range_n", "pins"].contains(&key) {
        let remedy = "give kind and stress_mpa, displacement_mm or velocity_mm_s; cycles are what `perilife predict` runs";
        return input(&path, shorten(value), "belongs to the cycles of a fatigue case, not to a fracture scene", remedy);
    }
    let known = OF_A_LOAD.iter().chain(COMMON).copied().collect::<Vec<_>>().join(", ");
    input(&path, shorten(value), "is not a known key", format!("known here: {known}"))
}

fn procedure(common: &CommonInput) -> Result<Procedure> {
    let duration = TIME.read_optional("loading.duration_s", common.duration_s)?;
    let time_step = TIME.read_optional("loading.time_step_s", common.time_step_s)?;
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
            Ok(steps.map_or(Procedure::Static, |steps| Procedure::QuasiStatic { steps: steps as usize }))
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

/// One load: a drive for each of its edges or regions.
fn load(value: &Value, path: &str, ramp: f64, specimen: &mut Specimen) -> Result<Vec<Drive>> {
    let load: LoadInput = slice(value, path)?;
    let size = size(&load, path)?;
    let direction = direction(&load, path)?;
    check_keys(&load, path)?;
    let (regions, kind) = (regions(&load, path, specimen)?, load.kind);
    let mut drives = Vec::new();
    for region in regions {
        let outward = match region {
            Region::Edge { edge, .. } => Some(edge.normal()),
            Region::Box { .. } => None,
        };
        let unit = direction.or(outward).ok_or_else(|| {
            let problem = "is missing: a region has no outward side";
            input_missing(&format!("{path}.direction"), problem, "give direction = [x, y]")
        })?;
        let vector = unit.map(|component: f64| size * component);
        let held = load.transverse == Some(Transverse::Held);
        let components = [0, 1].map(|i| (unit[i] != 0.0 || held).then_some(vector[i]));
        let action = match kind {
            LoadKind::Traction => {
                push_traction(&region, vector, path, specimen)?;
                Action::Traction(vector)
            }
            LoadKind::Displacement => Action::Displacement(components),
            LoadKind::Velocity => Action::Velocity(components),
            // A platen presses: it moves against the outward normal.
            LoadKind::Platens => Action::Platen(vector.map(|component| -component)),
        };
        drives.push(Drive { region, action, ramp });
    }
    Ok(drives)
}

/// The one size of a load, SI.
fn size(load: &LoadInput, path: &str) -> Result<f64> {
    const STRESS: Quantity = Quantity { what: "a stress", unit: "MPa", low: -1e5, high: 1e5, si: MPA };
    const SHIFT: Quantity = Quantity { what: "a displacement", unit: "mm", low: -1e4, high: 1e4, si: MM };
    const SPEED: Quantity = Quantity { what: "a velocity", unit: "mm/s", low: -1e8, high: 1e8, si: MM };
    let choices = [
        ("stress_mpa", load.stress_mpa, STRESS, &[LoadKind::Traction][..]),
        ("displacement_mm", load.displacement_mm, SHIFT, &[LoadKind::Displacement, LoadKind::Platens]),
        ("velocity_mm_s", load.velocity_mm_s, SPEED, &[LoadKind::Velocity]),
    ];
    for (key, given, ..) in choices.iter().filter(|choice| !choice.3.contains(&load.kind)) {
        if let Some(given) = given {
            let problem = format!("does not go with kind = \"{}\"", load.kind);
            return Err(input(&format!("{path}.{key}"), given, problem, "leave it out, or give another kind"));
        }
    }
    // Every kind has its key above.
    let own = choices.iter().find(|choice| choice.3.contains(&load.kind));
    let Some((key, given, quantity, _)) = own else { return Ok(0.0) };
    let key = format!("{path}.{key}");
    let given = given.ok_or_else(|| input_missing(&key, "is missing: there is no load", format!("give {}", quantity.what)))?;
    let size = quantity.read(&key, given)?;
    if size == 0.0 || (load.kind == LoadKind::Platens && size < 0.0) {
        let (problem, remedy) = match load.kind {
            LoadKind::Platens => ("does not press: platens move against the plate", "give the way of the platen, above zero"),
            _ => ("loads nothing", "give another value, or hold points in [supports]"),
        };
        return Err(input(&key, given, problem, remedy));
    }
    Ok(size)
}

/// Unit vector of `direction`.
fn direction(load: &LoadInput, path: &str) -> Result<Option<Point>> {
    let Some([x, y]) = load.direction else { return Ok(None) };
    let (key, size) = (format!("{path}.direction"), x.hypot(y));
    if !(1e-9..1e9).contains(&size) {
        return Err(input(&key, format!("[{x}, {y}]"), "has no direction", "give [x, y], for example [0, 1]"));
    }
    if load.kind == LoadKind::Platens {
        let problem = "does not go with platens, which move against the side that they press on";
        return Err(input(&key, format!("[{x}, {y}]"), problem, "leave it out"));
    }
    Ok(Some([x / size, y / size]))
}

/// Keys that the kind of load has no use for.
fn check_keys(load: &LoadInput, path: &str) -> Result<()> {
    let moved = matches!(load.kind, LoadKind::Displacement | LoadKind::Velocity);
    if let Some(transverse) = load.transverse.filter(|_| !moved) {
        let problem = format!("does not go with kind = \"{}\"", load.kind);
        return Err(input(&format!("{path}.transverse"), transverse, problem, "leave it out"));
    }
    if let Some(depth) = load.grip_mm.filter(|_| !moved) {
        let problem = format!("does not go with kind = \"{}\", which acts on the side itself", load.kind);
        return Err(input(&format!("{path}.grip_mm"), depth, problem, "leave it out"));
    }
    if load.regions.is_some() && !moved {
        let problem = format!("does not go with kind = \"{}\", which acts on sides", load.kind);
        return Err(input_missing(&format!("{path}.regions"), problem, "give edges"));
    }
    Ok(())
}

/// Edges or regions of a load.
fn regions(load: &LoadInput, path: &str, specimen: &Specimen) -> Result<Vec<Region>> {
    let (edges_key, regions_key) = (format!("{path}.edges"), format!("{path}.regions"));
    match (&load.edges, &load.regions) {
        (None, None) => {
            let remedy = "give edges = [\"top\", \"bottom\", \"left\", \"right\"] or some of them, or regions";
            Err(input_missing(&edges_key, "is missing: nothing is loaded", remedy))
        }
        (Some(_), Some(_)) => Err(input_missing(&regions_key, "stands beside edges", "give them as parts of their own")),
        (Some(edges), None) => {
            if edges.is_empty() {
                return Err(input(&edges_key, "[]", "is empty: nothing is loaded", "name the loaded sides"));
            }
            if let Some((i, edge)) = edges.iter().enumerate().find(|(i, edge)| edges[..*i].contains(edge)) {
                return Err(input(&format!("{edges_key}[{i}]"), edge, "stands twice", "name each side once"));
            }
            let (depth, range) = (format!("{path}.grip_mm"), format!("{path}.range_mm"));
            let of_edge = |edge: &Edge| {
                region::edge(*edge, &edges_key, (&depth, load.grip_mm.unwrap_or(0.0)), (&range, load.range_mm), specimen)
            };
            edges.iter().map(of_edge).collect()
        }
        (None, Some(regions)) => {
            let given = [("grip_mm", load.grip_mm.is_some()), ("range_mm", load.range_mm.is_some())];
            if let Some((key, _)) = given.iter().find(|(_, given)| *given) {
                let problem = "goes with edges, not with regions";
                return Err(input_missing(&format!("{path}.{key}"), problem, "leave it out"));
            }
            if regions.is_empty() || regions.len() > PARTS_MAX {
                let remedy = format!("give 1 to {PARTS_MAX} boxes {{ from_mm = [x, y], to_mm = [x, y] }}");
                return Err(input(&regions_key, format!("{} regions", regions.len()), "is no place of a load", remedy));
            }
            let of_box = |(i, value): (usize, &Value)| region::box_from_value(value, &format!("{regions_key}[{i}]"), specimen);
            regions.iter().enumerate().map(of_box).collect()
        }
    }
}

/// Puts a traction on the part of a side that it acts on.
fn push_traction(region: &Region, traction: Point, path: &str, specimen: &mut Specimen) -> Result<()> {
    let Region::Edge { edge, range, .. } = *region else { return Ok(()) };
    let stretches = region::stretches_within(edge, range, specimen);
    if stretches.is_empty() {
        let key = format!("{path}.range_mm");
        return Err(input_missing(&key, "lies where the outline does not reach this side", "move it onto the side"));
    }
    specimen.loads.extend(stretches.into_iter().map(|(from, to)| Load::Edge { from, to, traction }));
    Ok(())
}

/// A number of steps or a count in an input file, for messages of other sections.
pub fn whole(key: &str, value: u64, high: u64) -> Result<usize> {
    number("a whole number", 1.0, high as f64).read(key, value as f64).map(|value| value as usize)
}
