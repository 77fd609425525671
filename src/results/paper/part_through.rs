//! What a report says of a crack that did not go through at the start: its section, both lengths over cycles, break-through, and what the error of its
//! K does to the life.

use serde_json::Value;

use super::numbers::{fixed, short, whole};
use super::{CHART, Sheets, quoted, terms};
use crate::axis::Axis;
use crate::chart::{COMPUTED, Frame, SECOND, Size};
use crate::pictures::tables::RunTables;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::part_through::{BREAK_THROUGH, SOURCE};

/// Size of both lengths over cycles, px.
const LENGTHS: Size = Size { width: 2.0 * CHART.width, ..CHART };

/// The section; nothing of a crack that went through from the start.
pub fn section(result: &Value, tables: &RunTables, sheets: &mut Sheets<'_>) -> String {
    let found = &result["part_through"];
    if !found.is_object() {
        return String::new();
    }
    let mut page = sheets.title("Crack that is not through");
    page += &sheets.picture("section.svg", "Section through the crack, its front at quarters of the cycles; grey: at the start");
    if let Some(svg) = lengths_svg(tables) {
        page += &sheets.figure(&svg, "Length c on the face and depth a over cycles; a ends where the crack is through");
    }
    page + "<h2>Break-through, and the error of K</h2>" + &terms(&rows(result, found))
}

fn rows(result: &Value, found: &Value) -> Vec<(&'static str, String)> {
    let number = |key: &str| found[key].as_f64();
    let mm = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{} mm", fixed(value, 3)));
    let cycles = |value: f64| format!("{} cycles", whole(value));
    let kind = found["kind"].as_str().unwrap_or("").replace('_', " ");
    let start = format!("a {}, c {}", mm(number("crack_depth_initial_mm")), mm(result["crack_length_initial_mm"].as_f64()));
    let last = format!("a {}", mm(number("crack_depth_final_mm")));
    let depth = number("depth_over_thickness").map_or_else(String::new, |share| format!(", a/t = {}", fixed(share, 3)));
    let mut rows = vec![("Kind", quoted(&kind)), ("At the start", start)];
    match number("cycles_at_break_through") {
        Some(through) => {
            let left = result["life_cycles"]
                .as_f64()
                .map_or_else(String::new, |life| format!("{} as a through crack", cycles(life - through)));
            let length = mm(number("crack_length_at_break_through_mm"));
            rows.push(("Break-through", format!("after {}: {last}{depth}, c {length}", cycles(through))));
            rows.push(("Then", left));
        }
        None => rows.push(("Break-through", format!("not reached; at the end {last}{depth}"))),
    }
    rows.push(("Rule", quoted(BREAK_THROUGH)));
    rows.push(("K", quoted(SOURCE)));
    let (percent, shorter) = (number("k_error_percent").map(short), number("life_cycles_if_k_is_larger").map(cycles));
    if let (Some(percent), Some(shorter)) = (percent, shorter) {
        let longer = number("life_cycles_if_k_is_smaller").map_or_else(|| "no end".to_owned(), cycles);
        rows.push(("Its error", format!("K +{percent} %: life {shorter}; K −{percent} %: {longer}")));
    }
    let outside: Vec<String> = found["outside_range"].as_array().into_iter().flatten().filter_map(outside).collect();
    let outside = if outside.is_empty() { "all of the life".to_owned() } else { format!("but for {}", outside.join(", ")) };
    rows.push(("Within its range", outside));
    rows
}

/// How much of a life lies outside of a range of the formulas.
fn outside(limit: &Value) -> Option<String> {
    let [low, high] = [0, 1].map(|end| limit["range"][end].as_f64().map_or_else(|| "–".to_owned(), short));
    let share = fixed(100.0 * limit["life_share"].as_f64()?, 1);
    Some(format!("{share} % of it ({} not within {low} to {high})", quoted(limit["of"].as_str()?)))
}

/// Both lengths of the front over cycles, named at their ends; `None` of tables without depth.
fn lengths_svg(tables: &RunTables) -> Option<String> {
    let depths = tables.depths_mm.as_ref()?;
    let cycles = || tables.rows.iter().map(|row| row.cycles);
    let along: Vec<Point> = tables.rows.iter().map(|row| [row.cycles, row.crack_length_mm]).collect();
    let deep: Vec<Point> =
        cycles().zip(depths).filter(|(_, depth)| depth.is_finite()).map(|(cycles, depth)| [cycles, *depth]).collect();
    let all = along.iter().chain(&deep).map(|point| point[1]).chain([0.0]);
    let axes = [Axis::linear_in(cycles().chain([0.0]), 6.0), Axis::linear_in(all, 5.0)];
    let mut frame = Frame::with_names(LENGTHS, axes, ["Cycles N", "Length c and depth a, mm"], 3);
    for (points, colour, dash, name) in [(&along, COMPUTED, "", "c"), (&deep, SECOND, "6 3", "a")] {
        frame.line(points, colour, 2.0, dash);
        points.last().into_iter().for_each(|end| frame.name(*end, name, colour));
    }
    Some(frame.finish("Length c on the face and depth a of the crack in mm over cycles"))
}
