//! Where the load acts on a `plate` and what holds it: `edges`, `pins`, `rollers` ([`super::forces`]), `stress_parallel_ratio` and
//! `[supports]`.
//!
//! Without supports the plate floats, so its loads must balance; with a support only the sides that are not held are
//! loaded. The standard specimens bring their loads and grips along and take none of these keys but the parallel stress.

use toml::Value;

use super::{Input, LoadingKind, PLACES, forces, grips};
use crate::specimen::geometry::{bounding_box, distance, unit};
use crate::specimen::pin::SNUG_PIN;
use crate::specimen::{Bearing, Component, Edge, Load, LoadMeasure, Point, Specimen, Support};
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::{Quantity, number, number_of, shorten, table_of};
use perilife_base::keys::{Given, key, section};
use perilife_base::units::{MM, place_mm, round_mm};

const BENT: &str = "edge_bending_ratio";
/// Resultant of pins that pull against each other, over the sum of their forces.
const BALANCED: f64 = 1e-6;
/// Resultant of loads over the largest of them, and its moment over that times the plate, up to which they are in balance.
const LEVEL: f64 = 1e-4;

perilife_base::keys! {
    #[derive(Debug)]
    pub struct SupportEntry {
        depth: f64 = key("rows_mm", "Depth of the support: from the side into the plate").of(DEPTH), or "one row" 0.0;
        fix: Vec<Component> = key("fix", "Fixed components");
    }
}
/// Range of a depth from a side.
pub const DEPTH: Quantity = Quantity { what: "a depth", unit: "mm", low: 0.0, high: 1e5, si: MM };

/// Puts loads and supports on the specimen; returns the section that turns a force into the nominal stress, m².
pub(super) fn apply(given: &Given<'_>, input: &Input, supports: Option<&Value>, specimen: &mut Specimen) -> Result<f64> {
    let area = apply_loads(given, input, supports, specimen)?;
    fit_unknown_pins(specimen);
    Ok(area)
}

/// Pins of which nothing is known fill their holes where they do not pull against each other.
fn fit_unknown_pins(specimen: &mut Specimen) {
    let forces: Vec<Point> = specimen.loads.iter().filter_map(pin_force).map(|(_, force)| force).collect();
    let [x, y] = [0, 1].map(|i| forces.iter().map(|force| force[i]).sum::<f64>());
    let all: f64 = forces.iter().map(|[x, y]| x.hypot(*y)).sum();
    if x.hypot(y) <= BALANCED * all {
        return;
    }
    for load in &mut specimen.loads {
        if let Load::Pin { contact: Bearing::Unknown(half_angle), .. } = load {
            *half_angle = SNUG_PIN;
        }
    }
}

fn apply_loads(given: &Given<'_>, input: &Input, supports: Option<&Value>, specimen: &mut Specimen) -> Result<f64> {
    if specimen.kind.is_plate() {
        return apply_to_plate(given, input, supports, specimen);
    }
    let kind = specimen.kind;
    let problem = format!("cannot be combined with {kind}, which has its own loads and grips");
    if input.pins.is_some() && specimen.part_through.is_some() {
        let problem = "are not supported for a part-through crack (no K under a pin)";
        let remedy = "use a through crack as long as its larger axis, with the pins, in kind = \"plate\" (conservative)";
        return Err(input_missing("loading.pins", problem, remedy));
    }
    let remedy = "remove it, or use kind = \"plate\"";
    given.refuse_any(&[&PLACES[..], &[BENT]].concat(), &problem, remedy)?;
    fail_if!(supports.is_some(), input_missing("supports", problem, remedy));
    let parallel_ratio = input.parallel_ratio;
    if parallel_ratio != 0.0 {
        if specimen.load_measure == LoadMeasure::Force {
            let problem = format!("cannot be combined with {kind}");
            let remedy = "set 0 if the sides are not loaded";
            return Err(perilife_base::error::input("loading.stress_parallel_ratio", parallel_ratio, problem, remedy));
        }
        push_edge_loads(specimen, &[Edge::Left, Edge::Right], parallel_ratio);
    }
    Ok(specimen.width * specimen.thickness)
}

fn apply_to_plate(given: &Given<'_>, input_: &Input, supports: Option<&Value>, specimen: &mut Specimen) -> Result<f64> {
    let (has_places, parallel_ratio) = (given.first(&PLACES).is_some(), input_.parallel_ratio);
    if has_places || supports.is_some() || parallel_ratio != 0.0 || input_.edge_bending_ratio.is_some() {
        // K of a named plate is that of its own loads.
        specimen.own_formula = None;
    }
    if supports.is_some() {
        specimen.supports.clear();
    }
    if has_places {
        specimen.loads.clear();
        specimen.load_measure = LoadMeasure::Stress;
    } else if !specimen.loads.is_empty() {
        return keep_own_loads(given, supports, specimen, parallel_ratio);
    }
    let held = read_supports(supports, specimen)?;
    let beside_edges = input_.edges.is_some() && input_.pins.is_some();
    if beside_edges {
        return load_edges_and_pins(given, input_, &held, specimen);
    }
    let by_forces = forces::KEYS.into_iter().zip([input_.pins.is_some(), input_.rollers.is_some()]).find(|(_, given)| *given);
    let area = match by_forces {
        Some((key, _)) if input_.edges.is_some() => {
            let remedy = "give edges, alone or with pins, or rollers";
            return Err(input_missing(key, "conflicts with edges", remedy));
        }
        Some((key, _)) if input_.edge_bending_ratio.is_some() => {
            let problem = format!("applies only to loaded edges, and the load is that of {key}");
            return Err(input_missing("loading.edge_bending_ratio", problem, "remove it"));
        }
        Some((key, _)) if input_.direction.is_some() => {
            let problem = format!("conflicts with {key}");
            return Err(input_missing("loading.direction", problem, "give edges, or the direction of each pin or roller"));
        }
        Some((key, _)) if parallel_ratio != 0.0 => {
            let problem = format!("cannot be combined with {key}");
            return Err(input("loading.stress_parallel_ratio", parallel_ratio, problem, "set 0 if the sides are not loaded"));
        }
        Some((key, _)) => {
            specimen.load_measure = LoadMeasure::Force;
            forces::read_pins(given, input_.pins.as_deref().unwrap_or_default(), false, specimen)?;
            forces::read_rollers(input_.rollers.as_deref().unwrap_or_default(), specimen)?;
            let remedy = "give pins { hole = 0, direction = [0, 1] } or rollers { at_mm = [0, 40], contact_width_mm = 6 }";
            fail_if!(specimen.loads.is_empty(), input(key, "[]", "applies no load", remedy));
            1.0
        }
        None => load_edges(given, input_, &held, specimen)?,
    };
    if by_forces.is_none() && grips::are_balanced(input_, specimen) {
        return Ok(area);
    }
    check_balance(specimen, by_forces.map_or("loading.edges", |(key, _)| key))?;
    Ok(area)
}

/// Bearing and bypass: the first edge bears the nominal stress, pins their bearing stress, and the edge that faces the first one what is
/// left, `σ_bypass = σ - Σ P·n / (L h)`.
fn load_edges_and_pins(given: &Given<'_>, input_: &Input, held: &[Edge], specimen: &mut Specimen) -> Result<f64> {
    let kind = if input_.kind == LoadingKind::Displacement { &["kind"][..] } else { &[] };
    let problem = "cannot be combined with pins and loaded edges together (uniform stress and cycles of a load only)";
    given.refuse_any(
        &[&["rollers", "direction", BENT][..], kind].concat(),
        problem,
        "use another program; either alone is a different problem",
    )?;
    let area = load_edges(given, input_, held, specimen)?;
    let edges = specimen.loads.len();
    forces::read_pins(given, input_.pins.as_deref().unwrap_or_default(), true, specimen)?;
    let first = input_.edges.as_deref().and_then(<[Edge]>::first).map_or([0.0, 1.0], |edge| edge.normal());
    let faces =
        |load: &Load| matches!(load, Load::Edge { traction, .. } if traction[0] * first[0] + traction[1] * first[1] < -0.5);
    let (loads, pins) = specimen.loads.split_at_mut(edges);
    let along_first = |force: Point| force[0] * first[0] + force[1] * first[1];
    let pushed: f64 =
        pins.iter().map(|pin| pin_force(pin).map_or(0.0, |(_, force)| along_first(force))).sum::<f64>() / specimen.thickness;
    let facing: f64 = loads.iter().filter(|load| faces(load)).filter_map(Load::on_edge).map(|(a, b, _)| distance(a, b)).sum();
    for load in loads.iter_mut().filter(|load| faces(load)) {
        if let Load::Edge { traction, .. } = load {
            // Σ P along the normal of the first edge is negative where the pin pulls against it.
            let bypass = (area / specimen.thickness + pushed) / facing;
            *traction = first.map(|n| -bypass * n);
        }
    }
    check_balance(specimen, "loading.pins")?;
    Ok(area)
}

/// Hole and force of a pin, N per unit of nominal load.
fn pin_force(load: &Load) -> Option<(usize, Point)> {
    match load {
        Load::Pin { hole, direction, force, .. } => Some((*hole, direction.map(|d| d * force))),
        _ => None,
    }
}

/// The forces that a named plate brings along, on what the case says of supports.
fn keep_own_loads(given: &Given<'_>, supports: Option<&Value>, specimen: &mut Specimen, parallel_ratio: f64) -> Result<f64> {
    read_supports(supports, specimen)?;
    let problem = format!("applies only to loaded edges, and the load is that of the forces of {}", specimen.kind);
    given.refuse_any(&[BENT], &problem, "remove it, or give edges")?;
    let problem = || format!("cannot be combined with the forces of {}", specimen.kind);
    let remedy = "remove it, or give edges";
    fail_if!(parallel_ratio != 0.0, input("loading.stress_parallel_ratio", parallel_ratio, problem(), remedy));
    check_balance(specimen, "supports")?;
    Ok(1.0)
}

/// Reads `[supports]` into the specimen; returns the sides held along their normal.
pub(super) fn read_supports(supports: Option<&Value>, specimen: &mut Specimen) -> Result<Vec<Edge>> {
    let mut held = Vec::new();
    let Some(supports) = supports else { return Ok(held) };
    for (name, value) in table_of(supports, "supports")? {
        let path = format!("supports.{name}");
        let known = "known sides: top, bottom, left, right";
        let edge: Edge = name.parse().map_err(|_| input(&path, shorten(value), "is not a side of the plate", known))?;
        let SupportEntry { depth, fix } = section(value, &path)?;
        let remedy = "give fix = [\"x\", \"y\"], [\"x\"] or [\"y\"]";
        fail_if!(fix.is_empty(), input(&format!("{path}.fix"), "[]", "supports nothing", remedy));
        let [low, high] = bounding_box(&specimen.outline);
        let (x, y) = (fix.contains(&Component::X), fix.contains(&Component::Y));
        let along_normal = if edge.normal()[0] == 0.0 { (y, high[1] - low[1]) } else { (x, high[0] - low[0]) };
        let remedy = "reduce the depth";
        let problem = "supports half of the plate or more";
        fail_if!(depth >= along_normal.1 / 2.0, input(&format!("{path}.rows_mm"), round_mm(depth), problem, remedy));
        let stretches = stretches(edge, specimen, &path)?;
        specimen.supports.extend(stretches.into_iter().map(|(from, to)| Support::Fixed { from, to, depth, x, y }));
        if along_normal.0 {
            held.push(edge);
        }
    }
    Ok(held)
}

fn stretches(edge: Edge, specimen: &Specimen, key: &str) -> Result<Vec<(Point, Point)>> {
    let found = edge.stretches(specimen);
    let remedy = "only sides on the bounding box are edges";
    fail_if!(found.is_empty(), input(key, edge, "is not a straight side of this outline", remedy));
    if let Some((from, to)) = edge.step(specimen) {
        let problem = format!("has a step smaller than 1e-4 of the plate from {} to {}", place_mm(from), place_mm(to));
        return Err(input(key, edge, problem, "draw the side as one line, or make the step deeper"));
    }
    Ok(found)
}

/// Uniform stress on the asked sides (default: top and bottom, less what is held), along their normals or `direction`; returns the
/// section of the first.
fn load_edges(given: &Given<'_>, input_: &Input, held: &[Edge], specimen: &mut Specimen) -> Result<f64> {
    const KEY: &str = "loading.edges";
    let parallel_ratio = input_.parallel_ratio;
    let asked = input_.edges.as_deref();
    let loaded: Vec<Edge> = match asked {
        None => [Edge::Top, Edge::Bottom].into_iter().filter(|edge| !held.contains(edge)).collect(),
        Some(asked) => {
            let problem = "is supported by [supports] and cannot be loaded";
            let remedy = "load another side, or remove this support";
            fail_if!(let Some(edge) = asked.iter().find(|edge| held.contains(edge)), input(KEY, edge, problem, remedy));
            if let Some((i, edge)) = asked.iter().enumerate().find(|(i, edge)| asked[..*i].contains(edge)) {
                return Err(input(&format!("{KEY}[{i}]"), edge, "is repeated", "name each side once"));
            }
            asked.to_vec()
        }
    };
    let remedy = "name the loaded sides, for example [\"top\", \"bottom\"]";
    let first = loaded.first().copied().ok_or_else(|| input_missing(KEY, "is empty: nothing is loaded", remedy))?;
    let mut areas = Vec::new();
    for edge in &loaded {
        let length: f64 = stretches(*edge, specimen, KEY)?.iter().map(|(from, to)| distance(*from, *to)).sum();
        areas.push(length * specimen.thickness);
    }
    match &input_.direction {
        None => match read_edge_bending(given, input_, &loaded)? {
            Some(stresses) => loaded.iter().for_each(|edge| push_bent_edge(specimen, *edge, stresses)),
            None => push_edge_loads(specimen, &loaded, 1.0),
        },
        Some(asked) => {
            given.refuse_any(
                &[BENT],
                "cannot be combined with loading.direction: bending acts along the normal",
                "remove one of them",
            )?;
            let problem = "cannot be combined with loading.direction";
            let remedy = "name all loaded sides in edges";
            fail_if!(parallel_ratio != 0.0, input("loading.stress_parallel_ratio", parallel_ratio, problem, remedy));
            for (edge, traction) in loaded.iter().zip(directions(asked, &loaded)?) {
                let loads = edge.stretches(specimen).into_iter().map(|(from, to)| Load::Edge { from, to, traction });
                specimen.loads.extend(loads.collect::<Vec<_>>());
            }
        }
    }
    if parallel_ratio != 0.0 {
        let vertical = first.normal()[0] == 0.0;
        let across = if vertical { [Edge::Left, Edge::Right] } else { [Edge::Bottom, Edge::Top] };
        if loaded.iter().any(|edge| across.contains(edge)) {
            let remedy = "remove one of them";
            return Err(input("loading.stress_parallel_ratio", parallel_ratio, "loads sides that edges already loads", remedy));
        }
        let free: Vec<Edge> = across.into_iter().filter(|edge| !held.contains(edge)).collect();
        for edge in &free {
            stretches(*edge, specimen, "loading.stress_parallel_ratio")?;
        }
        push_edge_loads(specimen, &free, parallel_ratio);
    }
    Ok(areas[0])
}

/// Unit vectors of `direction`: one for all sides, or a list with one for each of them.
fn directions(given: &Value, loaded: &[Edge]) -> Result<Vec<Point>> {
    const KEY: &str = "loading.direction";
    let wrong = |problem: String| input(KEY, shorten(given), problem, "give [x, y], or one [x, y] for each side of edges");
    let pair = |value: &Value| match value.as_array().map(Vec::as_slice) {
        Some([x, y]) => number_of(x).zip(number_of(y)).map(|(x, y)| [x, y]),
        _ => None,
    };
    let vectors: Vec<Point> = match (pair(given), given.as_array()) {
        (Some(one), _) => vec![one; loaded.len()],
        (None, Some(list)) => list.iter().map(pair).collect::<Option<_>>().ok_or_else(|| wrong("is not a direction".into()))?,
        (None, None) => return Err(wrong("is not a direction".into())),
    };
    fail_if!(vectors.len() != loaded.len(), wrong(format!("has {} directions for {} sides", vectors.len(), loaded.len())));
    vectors.into_iter().map(unit).collect::<Option<_>>().ok_or_else(|| wrong("has no direction".into()))
}

/// Stress over the nominal one at the beginning and the end of the loaded edges: with the bending ratio ρ, `1 - ρ` and `1 + ρ`; where the
/// edges bear nothing but bending, -1 and 1. `None` where they are not bent.
fn read_edge_bending(all: &Given<'_>, input_: &Input, loaded: &[Edge]) -> Result<Option<[f64; 2]>> {
    const KEY: &str = "loading.edge_bending_ratio";
    let Some(given) = &input_.edge_bending_ratio else { return Ok(None) };
    if loaded.iter().any(|edge| (edge.normal()[0] == 0.0) != (loaded[0].normal()[0] == 0.0)) {
        let problem = "needs one side or two opposite sides";
        return Err(input(KEY, shorten(given), problem, "name one side or two opposite ones in loading.edges"));
    }
    let problem = "applies only to a stress on edges, and these are moved by a displacement";
    let remedy = "remove it, or give cycles of a load";
    fail_if!(input_.kind == LoadingKind::Displacement, input(KEY, shorten(given), problem, remedy));
    if given.as_str() == Some("pure") {
        const FORCES: [&str; 4] = ["force_max_n", "force_range_n", "force_max_kn", "force_range_kn"];
        all.refuse_any(&FORCES, "is zero in pure bending", "give loading.stress_max_mpa, that at the end of the edge")?;
        return Ok(Some([-1.0, 1.0]));
    }
    let ratio = number_of(given).ok_or_else(|| {
        let remedy = "give bending stress at the end of the edge over its mean stress, or \"pure\"";
        input(KEY, shorten(given), "is not a ratio of stresses", remedy)
    })?;
    let ratio = number("bending stress over mean stress", -1000.0, 1000.0).read(KEY, ratio)?;
    Ok((ratio != 0.0).then_some([1.0 - ratio, 1.0 + ratio]))
}

/// Stress along the outward normal of a side, linear over it from its left or lower end to the other.
fn push_bent_edge(specimen: &mut Specimen, edge: Edge, [first, last]: [f64; 2]) {
    let (normal, axis) = (edge.normal(), usize::from(edge.normal()[0] != 0.0));
    let stretches = edge.stretches(specimen);
    let ends = || stretches.iter().flat_map(|(from, to)| [from[axis], to[axis]]);
    let (low, high) = (ends().fold(f64::INFINITY, f64::min), ends().fold(f64::NEG_INFINITY, f64::max));
    let stress = |at: Point| first + (at[axis] - low) / (high - low) * (last - first);
    let bent = stretches.iter().map(|&(from, to)| Load::Bent {
        from,
        to,
        tractions: [from, to].map(|at| normal.map(|n| stress(at) * n)),
    });
    specimen.loads.extend(bent);
}

/// Traction `share` along the outward normal on all stretches of these sides.
fn push_edge_loads(specimen: &mut Specimen, edges: &[Edge], share: f64) {
    for edge in edges {
        let [nx, ny] = edge.normal();
        let loads =
            edge.stretches(specimen).into_iter().map(|(from, to)| Load::Edge { from, to, traction: [share * nx, share * ny] });
        specimen.loads.extend(loads.collect::<Vec<_>>());
    }
}

/// Force and moment of the loads must be zero as far as no support can take them up.
fn check_balance(specimen: &Specimen, key: &str) -> Result<()> {
    let (mut held, mut turned) = ([false; 2], false);
    for support in &specimen.supports {
        if let Support::Fixed { from, to, x, y, .. } = support {
            held = [held[0] || *x, held[1] || *y];
            // A side held along its normal cannot turn.
            turned |= if (to[1] - from[1]).abs() < (to[0] - from[0]).abs() { *y } else { *x };
        }
    }
    turned |= specimen.supports.len() > 1;
    let Imbalance { force, moment } = imbalance(specimen);
    for (i, axis) in ["x", "y"].iter().enumerate() {
        let problem = || format!("not in equilibrium: unbalanced force along {axis}");
        let remedy = "load opposite sides equally, or add a support in [supports]";
        fail_if!(!held[i] && force[i], input_missing(key, problem(), remedy));
    }
    // A force held along one axis only is taken up on a line somewhere: its moment is then not asked for.
    let problem = "not in equilibrium: unbalanced moment";
    let remedy = "align opposite forces, or add a support in [supports]";
    fail_if!(!turned && !held[0] && !held[1] && moment, input_missing(key, problem, remedy));
    Ok(())
}

/// What the loads of a specimen leave over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Imbalance {
    /// Whether a force along x or y is left.
    pub force: [bool; 2],
    /// Whether they turn the plate about the origin.
    pub moment: bool,
}

/// What the loads of a specimen leave over, beyond what a drawing leaves.
pub fn imbalance(specimen: &Specimen) -> Imbalance {
    let (mut force, mut moment, mut scale) = ([0.0; 2], 0.0_f64, 0.0_f64);
    for (place, f) in specimen.loads.iter().flat_map(|load| resultants(load, specimen)) {
        force = [force[0] + f[0], force[1] + f[1]];
        moment += place[0] * f[1] - place[1] * f[0];
        scale = scale.max(f[0].hypot(f[1]));
    }
    let reach = specimen.gross_width.max(specimen.length());
    Imbalance { force: force.map(|f: f64| f.abs() > LEVEL * scale), moment: moment.abs() > LEVEL * scale * reach }
}

/// Places and forces of a load per unit of nominal load (per metre of thickness, which all share).
fn resultants(load: &Load, specimen: &Specimen) -> Vec<(Point, Point)> {
    let of_pin = pin_force(load).map(|(hole, force)| (specimen.holes[hole].centre, force.map(|f| f / specimen.thickness)));
    load.forces_between([0.0, 1.0]).into_iter().chain(of_pin).collect()
}
