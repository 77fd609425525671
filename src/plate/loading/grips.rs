//! Edges that cycles of a displacement move: held straight ([`Support::Moved`]), or by the mean of their displacement.

use super::{Grip, Input, LoadingKind, Transverse};
use crate::specimen::geometry::{self, unit};
use crate::specimen::{Edge, Load, Point, Specimen, SpecimenKind, Support};
use perilife_base::error::{Result, input as error, input_missing};
use perilife_base::keys::Given;

/// Refuses the keys of grips where nothing is gripped.
pub(super) fn refuse(given: &Given<'_>, input: &Input) -> Result<()> {
    if input.kind != LoadingKind::Displacement {
        let problem = "applies only to a moved edge, and the cycles are of a load";
        return given.refuse_any(&KEYS, problem, "remove it, or give kind = \"displacement\"");
    }
    if input.pins.is_some() || input.rollers.is_some() {
        let problem = "applies only to moved edges, not to pins or rollers";
        return given.refuse_any(&KEYS, problem, "remove it");
    }
    let by_mean = if input.grip == Grip::Mean { &KEYS[1..] } else { &[] };
    given.refuse_any(by_mean, "cannot be combined with grip = \"mean\", which fixes no edge", "remove it")
}

const KEYS: [&str; 2] = ["grip", "transverse"];

/// Holds the moved edges straight, unless the mean is asked for.
pub(super) fn apply(given: &Given<'_>, input: &Input, specimen: &mut Specimen) -> Result<()> {
    let mut across = input.transverse == Transverse::Held;
    match (specimen.kind, input.grip) {
        (SpecimenKind::SingleEdgeTension, _) => {
            given.refuse_any(&KEYS, "set by specimen.ends for single_edge_tension", "remove it")?;
            if !specimen.supports.contains(&Support::ClampedEnds) {
                return Ok(());
            }
            // Clamped ends, whose place counts here: exactly the ends of the plate.
            specimen.supports.clear();
            across = true;
        }
        (_, Grip::Mean) => return Ok(()),
        _ => {}
    }
    let stretches: Vec<(Point, Point, Point)> = specimen.loads.iter().filter_map(stretch).collect();
    let is_moved = |a: &Point, b: &Point| stretches.iter().any(|(from, to, _)| [[a, b], [b, a]].contains(&[from, to]));
    let is_side = |edge: &&Edge| edge.stretches(specimen).iter().any(|(a, b)| is_moved(a, b));
    let sides: Vec<Edge> = Edge::ALL.iter().filter(is_side).copied().collect();
    let are_opposite = |[a, b]: [Edge; 2]| a.normal() == b.normal().map(|n| -n);
    let way = match sides[..] {
        [_] => 1.0,
        [a, b] if are_opposite([a, b]) => 0.5,
        _ => {
            let problem = "one displacement cannot move sides that do not face each other";
            let remedy = "move one side or two opposite ones, or give grip = \"mean\"";
            return Err(input_missing("loading.edges", problem, remedy));
        }
    };
    for (from, to, direction) in stretches {
        for support in &specimen.supports {
            let Support::Fixed { from: a, to: b, x, y, .. } = *support else { continue };
            if (a, b) == (from, to) && ((x && direction[0].abs() > ALONG) || (y && direction[1].abs() > ALONG)) {
                let shown = format!("[{}, {}]", direction[0], direction[1]);
                let remedy = "remove that component from [supports]; transverse = \"held\" fixes the one across";
                return Err(error(
                    "loading.direction",
                    shown,
                    "moves an edge that [supports] fixes in the same direction",
                    remedy,
                ));
            }
        }
        specimen.supports.push(Support::Moved { from, to, direction, way, held: across });
    }
    Ok(())
}

/// Whether the grips of sides that are moved straight against each other are in equilibrium, whatever those bear: they do not turn where
/// something holds them in their normal.
pub(super) fn are_balanced(given: &Input, specimen: &Specimen) -> bool {
    let is_straight = given.kind == LoadingKind::Displacement && given.grip != Grip::Mean;
    let stretches: Vec<(Point, Point, Point)> = specimen.loads.iter().filter_map(stretch).collect();
    let Some(&(from, to, [x, y])) = stretches.first().filter(|_| is_straight) else { return false };
    let along = |d: Point, sign: f64| (sign * d[0] - x).hypot(sign * d[1] - y) < ALONG;
    let oppose = stretches.iter().any(|s| along(s.2, -1.0)) && stretches.iter().all(|s| along(s.2, 1.0) || along(s.2, -1.0));
    let [tx, ty] = geometry::direction(from, to);
    oppose && (given.transverse == Transverse::Held || (x * ty - y * tx).abs() > ALONG)
}

/// Component of a direction above which a side is moved along it.
const ALONG: f64 = 1e-9;

/// A loaded stretch of an edge with the direction in which it is moved.
fn stretch(load: &Load) -> Option<(Point, Point, Point)> {
    match *load {
        Load::Edge { from, to, traction } => unit(traction).map(|direction| (from, to, direction)),
        Load::Bent { .. } | Load::Pin { .. } => None,
    }
}
