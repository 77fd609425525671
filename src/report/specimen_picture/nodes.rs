//! The nodes of a plate without elements: cells of integration, radii of influence, path of the cracks.

use super::drawing;
use super::sketch::Sketch;
use crate::case::Case;
use crate::element_free::field::Discretisation;
use crate::error::Result;
use crate::growth::element_free::initial_plate;
use crate::report::model_words::of_case;
use crate::specimen::Point;

/// Colours of cells, nodes, nodes that carry near-tip fields, radii of influence, paths.
const CELL: &str = "#b8bec6";
const NODE: &str = "#2f3b48";
const ENRICHED: &str = "#d0021b";
const INFLUENCE: &str = "#1257a8";
const PATH: &str = "#0a8f3c";
/// Nodes whose radius of influence is drawn.
const RADII: usize = 3;

/// SVG text of the nodes of a case for its initial cracks, and the path of every tip, m.
///
/// # Errors
/// As [`initial_plate`].
pub fn nodes_svg(case: &Case, paths: &[Vec<Point>]) -> Result<String> {
    let plate = initial_plate(case)?;
    let chosen: Vec<String> = of_case(case, None)
        .iter()
        .filter(|choice| matches!(choice.key, "spacing_mm" | "enrichment" | "influence_radius"))
        .map(|choice| format!("{} {}", choice.key, choice.value))
        .collect();
    let title = format!(
        "{} nodes, {} unknowns, for the cracks of the start; {}",
        plate.nodes.at.len(),
        plate.unknowns(),
        chosen.join(", ")
    );
    let lines = [
        "grey: cells of integration; dots: nodes, red with near-tip fields; blue: radius of influence of three nodes".to_owned(),
        "green: path of the tips".to_owned(),
    ];
    Ok(drawing(&case.name, &title, &case.specimen, &lines, |sketch| draw(sketch, case, &plate, paths)))
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
        let (size, colour) = if plate.enriched[node].is_empty() { (1.1, NODE) } else { (1.3, ENRICHED) };
        sketch.dot(sketch.place(at), size, colour);
    }
    for pair in paths.iter().flat_map(|path| path.windows(2)) {
        sketch.line(sketch.place(pair[0]), sketch.place(pair[1]), PATH, 1.6);
    }
}
