//! Where a load or a support takes hold: a side of the plate, or an upright box. `[supports]`: sides or boxes whose points stay where they
//! are.

use toml::Value;

use crate::scene::{Region, SceneSupport};
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::{shorten, table_of};
use perilife_base::keys::{coordinate, key, part, section};
use perilife_base::units::{MM, round_mm};
use perilife_plate::loading::SupportEntry;
use perilife_plate::specimen::geometry::bounding_box;
use perilife_plate::specimen::{Component, Edge, Point, Specimen};
pub use perilife_points::refinement::{corners, overlap};

perilife_base::keys! {
    pub struct BoxKeys {
        from: Point = coordinate("from_mm", "One corner: [x, y]");
        to: Point = coordinate("to_mm", "Opposite corner: [x, y]");
    }
}

/// Lower left and upper right corner of a box that meets the plate.
pub fn box_in(given: &BoxKeys, path: &str, specimen: &Specimen) -> Result<(Point, Point)> {
    corners(path, [given.from, given.to], specimen)
}

/// A side with the depth of the hold and, where it is not the whole side, the part of it.
pub fn edge(edge: Edge, key: &str, depth: (&str, f64), range: (&str, Option<[f64; 2]>), specimen: &Specimen) -> Result<Region> {
    if edge.stretches(specimen).is_empty() {
        let remedy = "only sides on the bounding box are edges; use a region";
        return Err(input(key, edge, "is not a straight side of this outline", remedy));
    }
    let [low, high] = bounding_box(&specimen.outline);
    let across = usize::from(edge.normal()[0] == 0.0);
    if depth.1 >= (high[across] - low[across]) / 2.0 {
        return Err(input(depth.0, round_mm(depth.1), "covers half of the plate or more", "reduce the depth"));
    }
    let part = match range.1 {
        None => [f64::NEG_INFINITY, f64::INFINITY],
        Some([from, to]) => {
            let shown = format!("[{}, {}]", round_mm(from), round_mm(to));
            fail_if!(from >= to, input(range.0, shown, "must increase", "give [from, to] along the side"));
            if to <= low[1 - across] || from >= high[1 - across] {
                let name = if across == 1 { "x" } else { "y" };
                let remedy = format!("give coordinates {name} between {} and {} mm", low[1 - across] / MM, high[1 - across] / MM);
                return Err(input(range.0, shown, "is outside the plate", remedy));
            }
            [from, to]
        }
    };
    Ok(Region::Edge { edge, depth: depth.1, range: part })
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

perilife_base::keys! {
    pub struct SideKeys {
        hold: SupportEntry = part();
        range: Option<Point> = coordinate("range_mm", "Part of the side: [from, to]");
    }
}
perilife_base::keys! {
    pub struct HeldBoxKeys {
        place: BoxKeys = part();
        fix: Vec<Component> = key("fix", "Fixed components");
    }
}

/// Reads `[supports]`: `bottom = { rows_mm, range_mm, fix }`, or under any other name `{ from_mm, to_mm, fix }`.
pub fn supports(value: &Value, specimen: &Specimen) -> Result<Vec<SceneSupport>> {
    let mut holds = Vec::new();
    for (name, value) in table_of(value, "supports")? {
        let path = format!("supports.{name}");
        let (region, fix, key) = match name.parse::<Edge>() {
            Ok(side) => {
                let entry: SideKeys = section(value, &path)?;
                let (depth, range) = (format!("{path}.rows_mm"), format!("{path}.range_mm"));
                let region = edge(side, &path, (&depth, entry.hold.depth), (&range, entry.range), specimen)?;
                (region, entry.hold.fix, range)
            }
            Err(_) if value.as_table().is_some_and(|table| table.contains_key("rows_mm") || !table.contains_key("from_mm")) => {
                let remedy = "known sides: top, bottom, left, right; a box has from_mm, to_mm and fix";
                return Err(input(&path, shorten(value), "is neither a side of the plate nor a box", remedy));
            }
            Err(_) => {
                let entry: HeldBoxKeys = section(value, &path)?;
                let (low, high) = box_in(&entry.place, &path, specimen)?;
                (Region::Box { low, high }, entry.fix, path.clone())
            }
        };
        if fix.is_empty() {
            let remedy = "give fix = [\"x\", \"y\"], [\"x\"] or [\"y\"]";
            return Err(input_missing(&format!("{path}.fix"), "supports nothing", remedy));
        }
        let components = [Component::X, Component::Y].map(|component| fix.contains(&component));
        holds.push(SceneSupport { region, components, key });
    }
    Ok(holds)
}
