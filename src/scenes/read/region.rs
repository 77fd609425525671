//! Where a load or a support takes hold: a side of the plate, or an upright box. `[supports]`: sides or boxes whose points stay where they
//! are.

use serde::Deserialize;
use toml::Value;

use crate::scene::{Region, SceneSupport};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{number, point, shorten, slice, table_of};
use perilife_base::units::MM;
use perilife_plate::specimen::geometry::bounding_box;
use perilife_plate::specimen::{Component, Edge, Point, Specimen};
pub use perilife_points::refinement::{corners, overlap};

/// Keys of an upright box.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxInput {
    from_mm: [f64; 2],
    to_mm: [f64; 2],
}

/// Reads `{ from_mm = [x, y], to_mm = [x, y] }`, two opposite corners of a box that meets the plate.
pub fn box_from_value(value: &Value, path: &str, specimen: &Specimen) -> Result<(Point, Point)> {
    let input: BoxInput = slice(value, path)?;
    corners(path, [input.from_mm, input.to_mm], specimen)
}

/// A side with the depth of the hold and, where it is not the whole side, the part of it.
pub fn edge(edge: Edge, key: &str, depth: (&str, f64), range: (&str, Option<[f64; 2]>), specimen: &Specimen) -> Result<Region> {
    if edge.stretches(specimen).is_empty() {
        let remedy = "an edge is what lies on the bounding box of the outline; take a region";
        return Err(input(key, edge, "is no straight side of this outline", remedy));
    }
    let [low, high] = bounding_box(&specimen.outline);
    let across = usize::from(edge.normal()[0] == 0.0);
    let metres = number("a depth in mm", 0.0, 1e5).read(depth.0, depth.1)? * MM;
    if metres >= (high[across] - low[across]) / 2.0 {
        return Err(input(depth.0, depth.1, "takes hold of half the plate or more", "give a smaller depth"));
    }
    let part = match range.1 {
        None => [f64::NEG_INFINITY, f64::INFINITY],
        Some(given) => {
            let [from, to] = point(range.0, given)?;
            let shown = format!("[{}, {}]", given[0], given[1]);
            if from >= to {
                return Err(input(range.0, shown, "does not rise", "give [from, to] along the side"));
            }
            if to <= low[1 - across] || from >= high[1 - across] {
                let name = if across == 1 { "x" } else { "y" };
                let remedy = format!("give coordinates {name} between {} and {} mm", low[1 - across] / MM, high[1 - across] / MM);
                return Err(input(range.0, shown, "lies beside the plate", remedy));
            }
            [from, to]
        }
    };
    Ok(Region::Edge { edge, depth: metres, range: part })
}

/// The box around a region, m: for a side, so deep as it holds and one `row` at the least.
pub fn around(region: &Region, row: f64, specimen: &Specimen) -> (Point, Point) {
    match *region {
        Region::Box { low, high } => (low, high),
        Region::Edge { edge, depth, range } => {
            let [mut low, mut high] = bounding_box(&specimen.outline);
            let across = usize::from(edge.normal()[0] == 0.0);
            let depth = depth.max(row);
            match edge {
                Edge::Top | Edge::Right => low[across] = high[across] - depth,
                Edge::Bottom | Edge::Left => high[across] = low[across] + depth,
            }
            low[1 - across] = low[1 - across].max(range[0]);
            high[1 - across] = high[1 - across].min(range[1]);
            (low, high)
        }
    }
}

/// A held side.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SideInput {
    #[serde(default)]
    rows_mm: f64,
    range_mm: Option<[f64; 2]>,
    fix: Vec<Component>,
}

/// A held box.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HeldBoxInput {
    from_mm: [f64; 2],
    to_mm: [f64; 2],
    fix: Vec<Component>,
}

/// Reads `[supports]`: `bottom = { rows_mm, range_mm, fix }`, or under any other name `{ from_mm, to_mm, fix }`.
pub fn supports(value: &Value, specimen: &Specimen) -> Result<Vec<SceneSupport>> {
    let mut holds = Vec::new();
    for (name, value) in table_of(value, "supports")? {
        let path = format!("supports.{name}");
        let (region, fix, key) = match name.parse::<Edge>() {
            Ok(side) => {
                let entry: SideInput = slice(value, &path)?;
                let (depth, range) = (format!("{path}.rows_mm"), format!("{path}.range_mm"));
                let region = edge(side, &path, (&depth, entry.rows_mm), (&range, entry.range_mm), specimen)?;
                (region, entry.fix, range)
            }
            Err(_) if value.as_table().is_some_and(|table| table.contains_key("rows_mm") || !table.contains_key("from_mm")) => {
                let remedy = "known sides: top, bottom, left, right; a box has from_mm, to_mm and fix";
                return Err(input(&path, shorten(value), "is neither a side of the plate nor a box", remedy));
            }
            Err(_) => {
                let entry: HeldBoxInput = slice(value, &path)?;
                let (low, high) = corners(&path, [entry.from_mm, entry.to_mm], specimen)?;
                (Region::Box { low, high }, entry.fix, path.clone())
            }
        };
        if fix.is_empty() {
            let remedy = "give fix = [\"x\", \"y\"], [\"x\"] or [\"y\"]";
            return Err(input_missing(&format!("{path}.fix"), "holds nothing", remedy));
        }
        let components = [Component::X, Component::Y].map(|component| fix.contains(&component));
        holds.push(SceneSupport { region, components, key });
    }
    Ok(holds)
}
