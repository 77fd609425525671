//! One load of a scene: what it does, and where.

use toml::Value;

use super::region::{self, BoxKeys};
use crate::scene::{Action, LoadRamp, Region, SceneLoad};
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::Quantity;
use perilife_base::keys::{Given, coordinate, key, section};
use perilife_base::units::{MM, MPA};

use perilife_plate::loading::{DEPTH, Transverse};
use perilife_plate::specimen::geometry::unit;
use perilife_plate::specimen::{Edge, Point, Specimen};

perilife_base::kinds! {
    /// Loads of fracture scenes.
    pub enum LoadKind for "loading.kind" {
        Traction = "traction": "stress_mpa on edges; fracture scenes",
        Displacement = "displacement": "displacement_mm of edges or regions, reached in the last of the steps or at the end of ramp_s; fracture scenes",
        Velocity = "velocity": "velocity_mm_s of edges or regions; fracture scenes with duration_s",
        Platens = "platens": "rigid frictionless platens that press on edges by displacement_mm; fracture scenes",
    }
}

/// More than this is a slip.
const REGIONS_MAX: usize = 50;

const TRACTION: Quantity = Quantity { what: "a stress", unit: "MPa", low: -1e5, high: 1e5, si: MPA };
const SHIFT: Quantity = Quantity { what: "a displacement", unit: "mm", low: -1e4, high: 1e4, si: MM };
const SPEED: Quantity = Quantity { what: "a velocity", unit: "mm/s", low: -1e8, high: 1e8, si: MM };
pub const TIME: Quantity = Quantity { what: "a time", unit: "s", low: 0.0, high: 1e6, si: 1.0 };

perilife_base::keys! {
    pub struct LoadKeys {
        kind: LoadKind = key("kind", "Kind of load");
        edges: Option<Vec<Edge>> = key("edges", "Loaded sides");
        regions: Option<Vec<BoxKeys>> = key("regions", "Loaded boxes: instead of sides");
        grip: f64 = key("grip_mm", "Depth of the grip: from the side into the plate").of(DEPTH), or "one row" 0.0;
        range: Option<Point> = coordinate("range_mm", "Part of the side: [from, to]");
        stress: Option<f64> = key("stress_mpa", "Stress: along the outward normal, or direction").of(TRACTION).only("kind", &["traction"]);
        displacement: Option<f64> = key("displacement_mm", "Displacement").of(SHIFT).only("kind", &["displacement", "platens"]);
        velocity: Option<f64> = key("velocity_mm_s", "Velocity").of(SPEED).only("kind", &["velocity"]);
        direction: Option<[f64; 2]> = key("direction", "Direction: [x, y]");
        transverse: Transverse = key("transverse", "Motion across the displacement or velocity"), or "free" Transverse::Free;
        ramp: Option<f64> = key("ramp_s", "Ramp: duration of the linear rise").of(TIME);
        from: Option<f64> = key("from_s", "Start time of the load").of(TIME);
    }
}

/// Time of a scene of motion, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    pub duration: f64,
    /// `ramp_s` of all loads that have none of their own.
    pub ramp: f64,
}

/// One load: a drive for each of its edges or regions.
pub fn drives(value: &Value, path: &str, clock: Option<Clock>, specimen: &mut Specimen) -> Result<Vec<SceneLoad>> {
    let (given, load) = (Given::of(value, path)?, section::<LoadKeys>(value, path)?);
    let size = size(&given, &load)?;
    let direction = direction(&load, path)?;
    check_keys(&given, &load)?;
    let rise = rise(&load, path, clock)?;
    let (regions, kind) = (regions(&given, &load, path, specimen)?, load.kind);
    let mut drives = Vec::new();
    for (region, key) in regions {
        let outward = match region {
            Region::Edge { edge, .. } => Some(edge.normal()),
            Region::Box { .. } => None,
        };
        let unit = direction.or(outward).ok_or_else(|| {
            let problem = "is missing (a region has no outward normal)";
            input_missing(&format!("{path}.direction"), problem, "give direction = [x, y]")
        })?;
        let vector = unit.map(|component: f64| size * component);
        let held = load.transverse == Transverse::Held;
        let components = [0, 1].map(|i| (unit[i] != 0.0 || held).then_some(vector[i]));
        let action = match kind {
            LoadKind::Traction => Action::Traction(vector),
            LoadKind::Displacement => Action::Displacement(components),
            LoadKind::Velocity => Action::Velocity(components),
            // A platen presses: it moves against the outward normal.
            LoadKind::Platens => Action::Platen(vector.map(|component| -component)),
        };
        let drive = SceneLoad { region, action, rise, key };
        if kind == LoadKind::Traction {
            push_traction(&drive, path, specimen)?;
        }
        drives.push(drive);
    }
    Ok(drives)
}

/// How a load rises: in a scene of motion by its own `ramp_s`, or that of all loads, from `from_s` on.
fn rise(load: &LoadKeys, path: &str, clock: Option<Clock>) -> Result<LoadRamp> {
    let (ramp_key, from_key) = (format!("{path}.ramp_s"), format!("{path}.from_s"));
    let Some(clock) = clock else {
        let given = [(&ramp_key, load.ramp), (&from_key, load.from)];
        return match given.into_iter().find_map(|(key, value)| Some((key, value?))) {
            None => Ok(LoadRamp::AT_ONCE),
            Some((key, value)) => Err(input(key, value, "requires duration_s", "give loading.duration_s, or remove it")),
        };
    };
    let (ramp, from) = (load.ramp.unwrap_or(clock.ramp), load.from.unwrap_or(0.0));
    if from >= clock.duration {
        let problem = format!("must be before the end of the scene, {} s", clock.duration);
        return Err(input(&from_key, from, problem, "use a smaller one, or a longer loading.duration_s"));
    }
    if ramp == 0.0 && matches!(load.kind, LoadKind::Displacement | LoadKind::Platens) {
        let problem = "is missing (a step of displacement has infinite velocity)";
        return Err(input_missing(&ramp_key, problem, "give the time to full displacement"));
    }
    Ok(LoadRamp { from, ramp })
}

/// The one size of a load, SI.
fn size(all: &Given<'_>, load: &LoadKeys) -> Result<f64> {
    let choices = [
        ("stress_mpa", load.stress, TRACTION, &[LoadKind::Traction][..]),
        ("displacement_mm", load.displacement, SHIFT, &[LoadKind::Displacement, LoadKind::Platens]),
        ("velocity_mm_s", load.velocity, SPEED, &[LoadKind::Velocity]),
    ];
    for (key, ..) in choices.iter().filter(|choice| !choice.3.contains(&load.kind)) {
        let problem = format!("cannot be combined with kind = \"{}\"", load.kind);
        all.refuse_any(&[key], &problem, "remove it, or use another kind")?;
    }
    // Every kind has its key above.
    let own = choices.iter().find(|choice| choice.3.contains(&load.kind));
    let Some((key, size, quantity, _)) = own else { return Ok(0.0) };
    let size = size.ok_or_else(|| all.refuse(key, "no load given", format!("give {}", quantity.what)))?;
    if size == 0.0 || (load.kind == LoadKind::Platens && size < 0.0) {
        let (problem, remedy) = match load.kind {
            LoadKind::Platens => {
                ("must be above zero: platens press on the plate", "give the displacement of the platen, above zero")
            }
            _ => ("applies no load", "give another value, or add supports in [supports]"),
        };
        return Err(all.refuse(key, problem, remedy));
    }
    Ok(size)
}

/// Unit vector of `direction`.
fn direction(load: &LoadKeys, path: &str) -> Result<Option<Point>> {
    let Some([x, y]) = load.direction else { return Ok(None) };
    let (key, given) = (format!("{path}.direction"), format!("[{x}, {y}]"));
    let Some(direction) = unit([x, y]) else {
        return Err(input(&key, given, "has no direction", "give [x, y], for example [0, 1]"));
    };
    if load.kind == LoadKind::Platens {
        let problem = "cannot be combined with platens, which move normal to their side";
        return Err(input(&key, given, problem, "remove it"));
    }
    Ok(Some(direction))
}

/// Keys that the kind of load has no use for.
fn check_keys(all: &Given<'_>, load: &LoadKeys) -> Result<()> {
    if matches!(load.kind, LoadKind::Displacement | LoadKind::Velocity) {
        return Ok(());
    }
    let problem = format!("cannot be combined with kind = \"{}\"", load.kind);
    all.refuse_any(&["transverse"], &problem, "remove it")?;
    all.refuse_any(&["grip_mm"], &format!("{problem}, which acts on the side itself"), "remove it")?;
    all.refuse_any(&["regions"], &format!("{problem}, which acts on sides"), "give edges")
}

/// Edges or regions of a load, each with the key that says which points it takes hold of.
fn regions(all: &Given<'_>, load: &LoadKeys, path: &str, specimen: &Specimen) -> Result<Vec<(Region, String)>> {
    let (edges_key, regions_key) = (format!("{path}.edges"), format!("{path}.regions"));
    match (&load.edges, &load.regions) {
        (None, None) => {
            let remedy = "give edges = [\"top\", \"bottom\", \"left\", \"right\"] or some of them, or regions";
            Err(input_missing(&edges_key, "is missing: no side is loaded", remedy))
        }
        (Some(_), Some(_)) => Err(input_missing(&regions_key, "conflicts with edges", "give each as a separate part")),
        (Some(edges), None) => {
            fail_if!(edges.is_empty(), input(&edges_key, "[]", "is empty: no side is loaded", "name the loaded sides"));
            if let Some((i, edge)) = edges.iter().enumerate().find(|(i, edge)| edges[..*i].contains(edge)) {
                return Err(input(&format!("{edges_key}[{i}]"), edge, "is repeated", "name each side once"));
            }
            let (depth, range) = (format!("{path}.grip_mm"), format!("{path}.range_mm"));
            let place = if load.range.is_some() { &range } else { &edges_key };
            let of_edge = |edge: &Edge| {
                let depth = (depth.as_str(), load.grip);
                Ok((region::edge(*edge, &edges_key, depth, (&range, load.range), specimen)?, place.clone()))
            };
            edges.iter().map(of_edge).collect()
        }
        (None, Some(regions)) => {
            all.refuse_any(&["grip_mm", "range_mm"], "applies only to edges, not to regions", "remove it")?;
            if regions.is_empty() || regions.len() > REGIONS_MAX {
                let remedy = format!("give 1 to {REGIONS_MAX} boxes {{ from_mm = [x, y], to_mm = [x, y] }}");
                return Err(input(&regions_key, format!("{} regions", regions.len()), "is not a region of a load", remedy));
            }
            let of_box = |(i, given): (usize, &BoxKeys)| {
                let key = format!("{regions_key}[{i}]");
                let (low, high) = region::box_in(given, &key, specimen)?;
                Ok((Region::Box { low, high }, key))
            };
            regions.iter().enumerate().map(of_box).collect()
        }
    }
}

/// Puts a traction on the part of a side that it acts on.
fn push_traction(drive: &SceneLoad, path: &str, specimen: &mut Specimen) -> Result<()> {
    let loads = drive.loads(specimen);
    if loads.is_empty() {
        let key = format!("{path}.range_mm");
        return Err(input_missing(&key, "is not on this side of the outline", "move it onto the side"));
    }
    specimen.loads.extend(loads);
    Ok(())
}
