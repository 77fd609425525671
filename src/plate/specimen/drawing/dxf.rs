//! DXF in ASCII: lines of model space with their layers.
//!
//! A file is pairs of lines, a group code and its value (Autodesk, DXF Reference). Every entity of model space is looked at: one that is
//! no line, arc, circle or polyline is refused and never left out, since it might be a hole.

use super::curve::{Arc, Curve, Piece, bulged};
use super::{Drawing, Drawn, Fault, known_layer, place};
use crate::specimen::Point;
use perilife_base::error::fail_if;

const DRAW_IT: &str = "draw it as one of them; delete it only if it is not part of the plate (text, dimensions)";
const SILENT: [&str; 2] = ["SEQEND", "VIEWPORT"];
/// Flags of a polyline: closed; one fitted by curves or splines; one in space or a mesh.
const CLOSED: i64 = 1;
const FITTED: i64 = 2 | 4;
const IN_SPACE: i64 = 8 | 16 | 64;
const FROZEN: i64 = 1;
/// Size of a coordinate that is round-off, in units of the drawing.
const ROUND_OFF: f64 = 1e-6;
type Group<'t> = (i64, &'t str, usize);

struct Entity<'t> {
    kind: &'t str,
    line: usize,
    groups: Vec<Group<'t>>,
}

/// Reads a file; millimetres of a unit by `$INSUNITS`.
/// Errors: text that is no DXF; entities that are no plain lines.
pub fn read(text: &str) -> Result<Drawing, Fault> {
    fail_if!(text.starts_with("AutoCAD Binary DXF"), Fault::of("is a binary DXF", "save it as ASCII DXF"));
    let groups = groups(text)?;
    let unit = groups.windows(2).find(|pair| pair[0].1 == "$INSUNITS").map(|pair| pair[1].1);
    let millimetres = match unit.unwrap_or("0") {
        "1" => Some(25.4),
        "2" => Some(304.8),
        "4" => Some(1.0),
        "5" => Some(10.0),
        "6" => Some(1000.0),
        "0" => None,
        other => return Err(Fault::of(format!("has the unit {other} ($INSUNITS)"), "save it in mm or inches")),
    };
    let hidden = hidden_layers(&groups);
    let entities = entities(&groups);
    let mut lines = Vec::new();
    let mut at = 0;
    while at < entities.len() {
        let entity = &entities[at];
        let vertices = entities[at + 1..].iter().take_while(|next| entity.kind == "POLYLINE" && next.kind == "VERTEX").count();
        if !SILENT.contains(&entity.kind) && entity.number(67)? != Some(1.0) {
            let vertices = &entities[at + 1..=at + vertices];
            entity.check_shown(&hidden)?;
            entity.check_plane(vertices)?;
            let curve = entity.curve(vertices)?;
            lines.push(Drawn { layer: entity.layer(), what: format!("{} at {}", entity.kind, place(curve.from)), curve });
        }
        at += 1 + vertices;
    }
    Ok(Drawing { lines, millimetres })
}

fn groups(text: &str) -> Result<Vec<Group<'_>>, Fault> {
    let lines: Vec<&str> = text.trim_start_matches('\u{feff}').lines().map(str::trim).collect();
    let mut groups = Vec::with_capacity(lines.len() / 2);
    for (pair, lines) in lines.chunks(2).enumerate() {
        let [code, value] = lines else { break };
        let number = code.parse().map_err(|_| {
            Fault::of(
                format!("is not a DXF: line {} has \"{code}\" instead of a group code", 2 * pair + 1),
                "save it as ASCII DXF",
            )
        })?;
        groups.push((number, *value, 2 * pair + 2));
        // What follows the end is no part of it.
        if (number, *value) == (0, "EOF") {
            break;
        }
    }
    let remedy = "save it again as ASCII DXF (the file is truncated)";
    fail_if!(!groups.iter().any(|group| (group.0, group.1) == (0, "EOF")), Fault::of("ends before its end mark EOF", remedy));
    Ok(groups)
}

/// Layers that are not shown, by the table LAYER, and why.
fn hidden_layers<'t>(groups: &[Group<'t>]) -> Vec<(&'t str, &'static str)> {
    let is_table = |pair: &[Group<'_>]| (pair[0].0, pair[0].1) == (0, "TABLE") && (pair[1].0, pair[1].1) == (2, "LAYER");
    let Some(first) = groups.windows(2).position(is_table) else { return Vec::new() };
    let table: Vec<Group<'t>> =
        groups[first + 2..].iter().copied().take_while(|group| (group.0, group.1) != (0, "ENDTAB")).collect();
    let records = table.split(|group| group.0 == 0).skip(1);
    let hidden = |record: &[Group<'t>]| {
        let first = |code: i64| record.iter().find(|group| group.0 == code).map(|group| group.1);
        let number = |code: i64| first(code).and_then(|value| value.parse::<i64>().ok()).unwrap_or(0);
        match (number(62) < 0, number(70) & FROZEN != 0) {
            (_, true) => Some((first(2)?, "is on a layer that is frozen")),
            (true, _) => Some((first(2)?, "is on a layer that is switched off")),
            _ => None,
        }
    };
    records.filter_map(hidden).collect()
}

fn entities<'t>(groups: &[Group<'t>]) -> Vec<Entity<'t>> {
    let begins = |pair: &[Group<'_>]| pair[0].1 == "SECTION" && (pair[1].0, pair[1].1) == (2, "ENTITIES");
    let first = groups.windows(2).position(begins).map_or(groups.len(), |at| at + 2);
    let mut entities: Vec<Entity<'t>> = Vec::new();
    for &(code, value, line) in groups[first..].iter().take_while(|group| (group.0, group.1) != (0, "ENDSEC")) {
        match (code, entities.last_mut()) {
            (0, _) => entities.push(Entity { kind: value, line, groups: Vec::new() }),
            (_, Some(entity)) => entity.groups.push((code, value, line)),
            _ => {}
        }
    }
    entities
}

impl Entity<'_> {
    fn layer(&self) -> String {
        let name = self.layer_name();
        known_layer(name).unwrap_or(name).to_owned()
    }

    fn layer_name(&self) -> &str {
        self.groups.iter().find(|group| group.0 == 8).map_or("0", |group| group.1)
    }

    /// Refuses what a viewer does not show: it might be meant or not.
    fn check_shown(&self, hidden: &[(&str, &str)]) -> Result<(), Fault> {
        const REMEDY: &str = "show it if it is part of the plate, else delete it";
        fail_if!(self.number(60)? == Some(1.0), self.refused("is hidden (group code 60)", REMEDY));
        match hidden.iter().find(|(layer, _)| layer.eq_ignore_ascii_case(self.layer_name())) {
            Some((_, why)) => Err(self.refused(why, REMEDY)),
            None => Ok(()),
        }
    }

    /// Refuses what does not lie in the plane z = 0; `vertices` follow a POLYLINE.
    fn check_plane(&self, vertices: &[Entity<'_>]) -> Result<(), Fault> {
        const REMEDY: &str = "draw it in the plane z = 0, seen from the front";
        let first_not = |codes: &[i64]| {
            let groups =
                [self].into_iter().chain(vertices).flat_map(|entity| &entity.groups).filter(|group| codes.contains(&group.0));
            let values = groups.map(|group| self.value(group)).collect::<Result<Vec<_>, Fault>>()?;
            Ok::<_, Fault>(values.into_iter().find(|value| value.abs() > ROUND_OFF))
        };
        fail_if!(self.number(230)?.is_some_and(|z| z < 0.0), self.refused("has extrusion -z", REMEDY));
        fail_if!(first_not(&[210, 220])?.is_some(), self.refused("is drawn in a tilted plane (extrusion not along z)", REMEDY));
        match first_not(&[30, 31, 38])? {
            Some(z) => Err(self.refused(&format!("is at z = {z}"), REMEDY)),
            None => Ok(()),
        }
    }

    fn number(&self, code: i64) -> Result<Option<f64>, Fault> {
        self.groups.iter().find(|group| group.0 == code).map(|group| self.value(group)).transpose()
    }

    fn value(&self, &(code, value, line): &Group<'_>) -> Result<f64, Fault> {
        let number = value.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| {
            let problem = format!("line {line}: \"{value}\" is not a number (group code {code})");
            Fault::at(&self.layer(), self.kind, problem, "save the drawing again")
        })
    }

    fn needed(&self, code: i64) -> Result<f64, Fault> {
        let missing = || {
            Fault::at(&self.layer(), self.kind, format!("line {}: has no group code {code}", self.line), "save the drawing again")
        };
        self.number(code)?.ok_or_else(missing)
    }

    fn point(&self, code: i64) -> Result<Point, Fault> {
        Ok([self.needed(code)?, self.needed(code + 10)?])
    }

    /// Where it is, in words; its line where it has no place.
    fn words(&self) -> String {
        match self.point(10) {
            Ok(at) => format!("{} at {}", self.kind, place(at)),
            Err(_) => format!("{} on line {}", self.kind, self.line),
        }
    }

    fn refused(&self, problem: &str, remedy: &str) -> Fault {
        Fault::at(&self.layer(), &self.words(), problem, remedy)
    }

    fn curve(&self, vertices: &[Entity<'_>]) -> Result<Curve, Fault> {
        let circle = |entity: &Self| Ok::<_, Fault>((entity.point(10)?, entity.needed(40)?));
        match self.kind {
            "LINE" => Ok(Curve { from: self.point(10)?, pieces: vec![Piece::straight(self.point(11)?)] }),
            "CIRCLE" => circle(self).map(|(centre, radius)| Curve::circle(centre, radius)),
            "ARC" => {
                let (centre, radius) = circle(self)?;
                let [start, end] = [self.needed(50)?.to_radians(), self.needed(51)?.to_radians()];
                let at = |angle: f64| [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()];
                let turn = (end - start).rem_euclid(std::f64::consts::TAU);
                let sweep = if turn > 0.0 { turn } else { std::f64::consts::TAU };
                Ok(Curve { from: at(start), pieces: vec![Piece { to: at(end), arc: Some(Arc { centre, sweep }) }] })
            }
            "LWPOLYLINE" => {
                let mut corners: Vec<(Point, f64)> = Vec::new();
                for group in &self.groups {
                    match (group.0, corners.last_mut()) {
                        (10, _) => corners.push(([self.value(group)?, 0.0], 0.0)),
                        (20, Some(corner)) => corner.0[1] = self.value(group)?,
                        (42, Some(corner)) => corner.1 = self.value(group)?,
                        _ => {}
                    }
                }
                self.polyline(&corners)
            }
            "POLYLINE" => {
                let corner = |vertex: &Entity<'_>| Ok((vertex.point(10)?, vertex.number(42)?.unwrap_or(0.0)));
                self.polyline(&vertices.iter().map(corner).collect::<Result<Vec<_>, Fault>>()?)
            }
            "SPLINE" | "ELLIPSE" | "HELIX" => {
                Err(self.refused("is a curve but not a circular arc", "draw it as arcs or as a polyline"))
            }
            "INSERT" => Err(self.refused("is a block", "explode blocks before saving")),
            _ => Err(self.refused("is not a line, arc, circle or polyline", DRAW_IT)),
        }
    }

    fn polyline(&self, corners: &[(Point, f64)]) -> Result<Curve, Fault> {
        let flags = self.number(70)?.unwrap_or(0.0) as i64;
        if self.kind == "POLYLINE" && flags & (FITTED | IN_SPACE) != 0 {
            return Err(self.refused("is curve-fitted or three-dimensional", "draw it as lines and arcs in the plane"));
        }
        let mut pieces: Vec<Piece> = corners.windows(2).map(|pair| bulged(pair[0].0, pair[1].0, pair[0].1)).collect();
        if let (&[(first, _), .., (last, bulge)], true) = (corners, flags & CLOSED != 0)
            && first != last
        {
            pieces.push(bulged(last, first, bulge));
        }
        match corners {
            [(from, _), _, ..] => Ok(Curve { from: *from, pieces }),
            _ => Err(self.refused("has fewer than two corners", DRAW_IT)),
        }
    }
}
