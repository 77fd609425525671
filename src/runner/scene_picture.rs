//! The plate of a fracture scene with its loads and supports.

use perilife_plate::specimen::{Edge, Point, Specimen};
use perilife_results::specimen_picture::drawing;
use perilife_results::specimen_picture::sketch::{HELD, LOAD, Sketch};
use perilife_scenes::read::around;
use perilife_scenes::scene::{Action, Region, Scene};

/// Length of the arrow of a motion, pixels.
const ARROW: f64 = 38.0;
/// Fill of driven and of held points.
const DRIVEN_FILL: &str = "#b9cfe8";
const HELD_FILL: &str = "#c9d19a";

/// SVG text of the plate of a scene; `procedure` says in words how it is worked through, `lines` what loads and holds it.
///
/// Red: cracks. Blue: loads, with the points that are driven in a tinted box. Green: points that are held.
pub fn scene_svg(scene: &Scene, procedure: &str, lines: &[String]) -> String {
    drawing(&scene.name, procedure, &scene.specimen, lines, |sketch| {
        for hold in &scene.holds {
            region(sketch, &hold.region, scene, HELD_FILL, HELD);
        }
        for drive in &scene.drives {
            let motion = match drive.action {
                // Drawn with the loads of the plate.
                Action::Traction(_) => continue,
                Action::Displacement(values) | Action::Velocity(values) => values.map(|value| value.unwrap_or(0.0)),
                Action::Platen(motion) => motion,
            };
            let middle = region(sketch, &drive.region, scene, DRIVEN_FILL, LOAD);
            arrow(sketch, middle, &drive.region, motion, &scene.specimen);
        }
    })
}

/// A box around a region; returns its middle.
fn region(sketch: &mut Sketch, region: &Region, scene: &Scene, fill: &str, stroke: &str) -> Point {
    let (low, high) = around(region, scene.model.spacing, &scene.specimen);
    sketch.polygon(&[low, [high[0], low[1]], high, [low[0], high[1]]], fill, stroke);
    [0, 1].map(|i| 0.5 * (low[i] + high[i]))
}

/// The arrow of a motion: out of the plate where it pulls, up to the plate where it presses on a side.
fn arrow(sketch: &mut Sketch, middle: Point, region: &Region, motion: Point, specimen: &Specimen) {
    let size = motion[0].hypot(motion[1]);
    if size == 0.0 {
        return;
    }
    let way = [ARROW * motion[0] / size, -ARROW * motion[1] / size];
    let mut start = sketch.place(middle);
    if let Region::Edge { edge, .. } = region {
        let normal = edge.normal();
        let [low, high] = perilife_plate::specimen::geometry::bounding_box(&specimen.outline);
        let mut foot = middle;
        match edge {
            Edge::Top | Edge::Bottom => foot[1] = if *edge == Edge::Top { high[1] } else { low[1] },
            Edge::Left | Edge::Right => foot[0] = if *edge == Edge::Right { high[0] } else { low[0] },
        }
        let presses = motion[0] * normal[0] + motion[1] * normal[1] < 0.0;
        let out = if presses { ARROW + 8.0 } else { 8.0 };
        let foot = sketch.place(foot);
        start = [foot[0] + out * normal[0], foot[1] - out * normal[1]];
    }
    sketch.arrow(start, [start[0] + way[0], start[1] + way[1]], LOAD, 2.4);
}
