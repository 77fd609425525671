//! The shape of a specimen as JSON, lengths in mm, for whoever draws it: page and report.

use serde_json::{Value, json};

use super::model_words::{clean, loading};
use crate::case::Case;
use crate::specimen::{Load, Point, Specimen, Support};
use crate::units::MM;

fn mm(at: Point) -> [f64; 2] {
    at.map(|x| clean(x / MM))
}

/// Outline, holes (with the direction in which a pin presses), slots as polygons, cracks by their lines, tips, loaded and held edges, and the
/// loads in words.
pub fn shape(case: &Case) -> Value {
    let specimen = &case.specimen;
    let pin = |hole: usize| {
        specimen.loads.iter().find_map(|load| match load {
            Load::Pin { hole: of, direction, force, .. } if *of == hole => Some(direction.map(|x| x * force.signum())),
            _ => None,
        })
    };
    let holes: Vec<Value> = (specimen.holes.iter().enumerate())
        .map(|(number, hole)| {
            let [x, y] = mm(hole.centre);
            json!({ "x_mm": x, "y_mm": y, "diameter_mm": clean(2.0 * hole.radius / MM), "pin": pin(number) })
        })
        .collect();
    let loads = specimen.loads.iter().filter_map(|load| match load {
        Load::Edge { from, to, traction } if *traction != [0.0; 2] => {
            Some(json!({ "from_mm": mm(*from), "to_mm": mm(*to), "traction": traction }))
        }
        _ => None,
    });
    let lines = specimen.crack_lines().into_iter().map(|line| line.points.iter().map(|at| mm(*at)).collect::<Vec<_>>());
    json!({
        "outline_mm": specimen.outline.iter().map(|at| mm(*at)).collect::<Vec<_>>(),
        "holes": holes,
        "slots": specimen.slots.iter().map(|slot| slot.corners().map(mm).to_vec()).collect::<Vec<_>>(),
        "cracks": lines.collect::<Vec<_>>(),
        "tips": specimen.tips.iter().map(|tip| mm(tip.position)).collect::<Vec<_>>(),
        "loads": loads.collect::<Vec<_>>(),
        "held": held(specimen),
        "load": loading(case),
    })
}

/// Stretches of the outline that are held or moved.
fn held(specimen: &Specimen) -> Vec<Value> {
    let stretches = specimen.supports.iter().filter_map(|support| match support {
        Support::Fixed { from, to, .. } | Support::Moved { from, to, .. } => {
            Some(json!({ "from_mm": mm(*from), "to_mm": mm(*to) }))
        }
        Support::ClampedEnds | Support::RigidEnds | Support::Elsewhere => None,
    });
    stretches.collect()
}
