//! Section of a report on a part-through crack: crack front, both lengths against cycles, breakthrough, effect of the error of K on the life.

use super::{CHART, Drawings, PRINT, figure, known, picture, quoted, terms, title};
use crate::axis::Axis;
use crate::chart::{COMPUTED, Frame, SECOND, Size};
use crate::curve::RunTables;
use crate::record::{OutsideRange, PartThroughEnds, RunRecord};
use perilife_plate::specimen::Point;
use perilife_plate::specimen::part_through::SOURCE;

/// Size of the chart of both lengths, px.
const LENGTHS: Size = Size { width: 2.0 * CHART.width, ..CHART };

/// The section; empty for a through crack.
pub fn section(run: &RunRecord, tables: &RunTables, drawings: &Drawings) -> String {
    let Some(found) = &run.part_through else { return String::new() };
    let mut page = title("Part-through crack");
    page += &picture(drawings, "section.svg", "Crack front at 0, 25, 50, 75 and 100 % of the cycles (initial front gray).");
    if let Some(svg) = lengths_svg(tables, found.cycles_at_break_through) {
        page += &figure(&svg, "Surface length c and depth a against cycles; a ends at breakthrough.", "wide");
    }
    page + "<h2>Breakthrough and accuracy of K</h2>" + &terms(&rows(run, found))
}

fn rows(run: &RunRecord, found: &PartThroughEnds) -> Vec<(&'static str, String)> {
    let mm = |length: Option<f64>| known(length, |length| format!("{} mm", PRINT.fixed(length, 3)));
    let cycles = |value: f64| format!("{} cycles", PRINT.whole(value));
    let start = format!("a {}, c {}", mm(Some(found.crack_depth_initial_mm)), mm(run.crack_length_initial_mm));
    let (last, share) = (mm(Some(found.crack_depth_final_mm)), PRINT.fixed(found.depth_over_thickness, 3));
    let last = format!("a {last}, a/t = {share}");
    let mut rows = vec![("Kind", quoted(&found.kind.replace('_', " "))), ("Initial crack", start)];
    match found.cycles_at_break_through {
        Some(through) => {
            let length = mm(found.crack_length_at_break_through_mm);
            let left = |life: f64| format!("{} as a through crack", cycles(life - through));
            rows.push(("Breakthrough", format!("after {}: {last}, c {length}", cycles(through))));
            rows.push(("Then", run.life_cycles.map_or_else(String::new, left)));
        }
        None => rows.push(("Breakthrough", format!("not reached; at the end {last}"))),
    }
    rows.push(("Growth rule", quoted(&found.rule)));
    rows.push(("Source of K", quoted(SOURCE)));
    if let Some(shorter) = found.life_cycles_if_k_is_larger.map(cycles) {
        let percent = PRINT.short(found.k_error_percent);
        let longer = found.life_cycles_if_k_is_smaller.map_or_else(|| "unlimited".to_owned(), cycles);
        rows.push(("Stated error of K", format!("K +{percent} %: life {shorter}; K −{percent} %: {longer}")));
    }
    let outside: Vec<String> = found.outside_range.iter().filter_map(outside).collect();
    let outside = if outside.is_empty() { "all".to_owned() } else { format!("all except {}", outside.join(", ")) };
    rows.push(("Life within its range", outside));
    rows
}

fn outside(limit: &OutsideRange) -> Option<String> {
    let [low, high] = limit.range.map(|end| known(end, |end| PRINT.short(end)));
    let share = PRINT.fixed(100.0 * limit.life_share?, 1);
    Some(format!("{share} % ({} outside {low} to {high})", quoted(&limit.of)))
}

/// Both lengths against cycles, labeled at their ends; `None` for tables without depth.
fn lengths_svg(tables: &RunTables, through: Option<f64>) -> Option<String> {
    let depths = tables.depths_mm.as_ref()?;
    let cycles = || tables.rows.iter().map(|row| row.cycles);
    let along: Vec<Point> = tables.rows.iter().map(|row| [row.cycles, row.crack_length_mm]).collect();
    let deep: Vec<Point> = cycles()
        .zip(depths)
        .filter(|(cycles, depth)| depth.is_finite() && through.is_none_or(|end| *cycles <= end))
        .map(|(cycles, depth)| [cycles, *depth])
        .collect();
    let all = along.iter().chain(&deep).map(|point| point[1]).chain([0.0]);
    let axes = [Axis::linear_in(cycles().chain([0.0]), 6.0), Axis::linear_in(all, 5.0)];
    let mut frame = Frame::with_names(LENGTHS, axes, ["Cycles N", "Surface length c and depth a, mm"], 3);
    let lines = [(along, COMPUTED, "", "c"), (deep, SECOND, "6 3", "a")];
    lines.iter().for_each(|(points, colour, dash, _)| frame.line(points, colour, 2.0, dash));
    let end =
        |(points, colour, _, name): &(Vec<Point>, &'static str, _, &str)| Some(((*name).to_owned(), *points.last()?, *colour));
    let names: Vec<(String, Point, &str)> = lines.iter().filter_map(end).collect();
    frame.names(&names, &lines.map(|(points, ..)| points));
    Some(frame.finish("Surface length c and depth a of the crack in mm against cycles"))
}
