//! The nodes of a plate without elements: cells of integration, radii of influence, path of the cracks.

use super::drawing;
use super::sketch::{CRACK, Sketch};
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_growth::case::{Case, initial_plate};
use perilife_nodes::field::Discretisation;
use perilife_plate::specimen::Point;

/// Colours of cells, nodes, nodes that carry near-tip fields, radii of influence, paths.
const CELL: &str = "#b8bec6";
const NODE: &str = "#2f3b48";
const ENRICHED: &str = "#d0021b";
const INFLUENCE: &str = "#1257a8";
const PATH: &str = "#0a8f3c";
/// Nodes whose radius of influence is drawn.
const RADII: usize = 3;

/// SVG text of the nodes of a case for its initial cracks, and the path of every tip, m.
pub fn nodes_svg(case: &Case, paths: &[Vec<Point>]) -> Result<String> {
    let plate = initial_plate(case)?;
    let spacing = case.nodes().resolution.far / MM;
    let title =
        format!("{} nodes, {} unknowns; node spacing {spacing:.2} mm far from cracks", plate.nodes.at.len(), plate.unknowns());
    let lines = [
        "gray: integration cells; dots: nodes (red: enriched); blue: support of three nodes".to_owned(),
        "green: crack paths".to_owned(),
    ];
    Ok(drawing(&case.name, &title, &case.specimen, &lines, |sketch| draw(sketch, case, &plate, paths)))
}

/// Side of the picture of a tip, pixels, and in spacings of the tip.
const TIP_PIXELS: f64 = 640.0;
const TIP_SPACINGS: f64 = 14.0;

/// SVG text of the nodes around the first tip; `None` of a case without one.
pub fn tip_svg(case: &Case, paths: &[Vec<Point>]) -> Result<Option<String>> {
    let plate = initial_plate(case)?;
    let Some(axes) = plate.axes.first() else { return Ok(None) };
    let scale = TIP_PIXELS / (TIP_SPACINGS * axes.spacing);
    let origin = [0.5 * TIP_PIXELS - axes.at[0] * scale, 0.5 * TIP_PIXELS + axes.at[1] * scale];
    let mut sketch = Sketch::new(scale, origin);
    draw(&mut sketch, case, &plate, paths);
    for cut in &plate.obstacles.cuts {
        for pair in cut.points.windows(2) {
            sketch.line(sketch.place(pair[0]), sketch.place(pair[1]), CRACK, 2.4);
        }
    }
    let words = format!("{}: tip 0, node spacing {:.3} mm; red: enriched nodes", case.name, axes.spacing / MM);
    sketch.name([0.5 * TIP_PIXELS, 22.0], &words, "middle", 14.0, NODE);
    Ok(Some(sketch.picture([TIP_PIXELS; 2], &words)))
}

fn draw(sketch: &mut Sketch, case: &Case, plate: &Discretisation, paths: &[Vec<Point>]) {
    for leaf in plate.grid.leaves().filter(|leaf| case.specimen.contains(plate.grid.middle(*leaf))) {
        let [low, high] = plate.grid.bounds(leaf);
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]].map(|corner| sketch.place(corner));
        for k in 0..4 {
            sketch.line(corners[k], corners[(k + 1) % 4], CELL, 0.5);
        }
    }
    // Around the first tip, one node near and two farther off.
    if let Some(axes) = plate.axes.first() {
        let away = |node: &usize| {
            let [x, y] = [0, 1].map(|i| plate.nodes.at[*node][i] - axes.at[i]);
            x.hypot(y)
        };
        let mut near: Vec<usize> = (0..plate.nodes.at.len()).collect();
        near.sort_by(|a, b| away(a).total_cmp(&away(b)));
        for &node in near.iter().step_by(12).take(RADII) {
            sketch.circle(plate.nodes.at[node], plate.supports[node], "none", INFLUENCE);
        }
    }
    for (node, &at) in plate.nodes.at.iter().enumerate() {
        let size = (0.08 * plate.nodes.spacing[node] * sketch.scale).clamp(0.5, 3.0);
        let colour = if plate.enriched[node].is_empty() { NODE } else { ENRICHED };
        sketch.dot(sketch.place(at), size, colour);
    }
    for pair in paths.iter().flat_map(|path| path.windows(2)) {
        sketch.line(sketch.place(pair[0]), sketch.place(pair[1]), PATH, 1.6);
    }
}
