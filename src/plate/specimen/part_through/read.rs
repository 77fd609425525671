//! `[specimen]` of a crack that does not go through: its keys, and the plate seen from the front.

use serde::Deserialize;
use toml::Value;

use super::{Description, PartThrough};
use crate::specimen::placement::check_holes;
use crate::specimen::plate::read_holes;
use crate::specimen::{Hole, Specimen, SpecimenKind};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{LENGTH, slice};
use perilife_base::units::MM;

/// Length of the plate over its width where the case does not say: ends so far away that they do not matter.
const LENGTH_OVER_WIDTH: f64 = 3.0;

/// Keys of `[specimen]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    #[serde(rename = "kind")]
    _kind: SpecimenKind,
    width_mm: f64,
    length_mm: Option<f64>,
    thickness_mm: f64,
    crack_depth_mm: f64,
    crack_half_length_mm: f64,
    hole_diameter_mm: Option<f64>,
    cracks: Option<usize>,
    #[serde(default)]
    holes: Vec<Value>,
}

/// The plate with its crack. That the length is the program's own goes into `notes`.
pub(in crate::specimen) fn from_value(
    description: &'static Description,
    value: &Value,
    notes: &mut Vec<String>,
) -> Result<Specimen> {
    let input: Input = slice(value, "specimen")?;
    let width = LENGTH.read("specimen.width_mm", input.width_mm)?;
    let length = LENGTH.read_optional("specimen.length_mm", input.length_mm)?;
    let thickness = LENGTH.read("specimen.thickness_mm", input.thickness_mm)?;
    let depth = LENGTH.read("specimen.crack_depth_mm", input.crack_depth_mm)?;
    let half_length = LENGTH.read("specimen.crack_half_length_mm", input.crack_half_length_mm)?;
    let (radius, cracks) = hole(description, &input, width)?;
    let mut flaw = PartThrough {
        description,
        depth,
        half_length,
        thickness,
        width,
        radius,
        cracks,
        to_hole: f64::INFINITY,
        other_holes: 0.0,
        bending_ratio: 0.0,
    };
    check_sizes(&flaw, &input)?;
    let plate = Specimen::strip(description.kind, width, length.unwrap_or(LENGTH_OVER_WIDTH * width), thickness);
    let mut holes = read_holes(&input.holes)?;
    holes.extend((radius > 0.0).then_some(Hole { centre: [0.0, 0.0], radius }));
    let mut specimen = Specimen { holes, ..plate };
    check_holes(&specimen)?;
    place_beside(&mut flaw, &specimen.holes)?;
    specimen.part_through = Some(flaw);
    (specimen.cracks, specimen.tips) = flaw.seen_from_front(half_length);
    specimen.crack_length = half_length;
    if length.is_none() {
        notes.push(format!(
            "specimen.length_mm is not given: once the crack is through, the plate is taken to be {LENGTH_OVER_WIDTH} widths long"
        ));
    }
    Ok(specimen)
}

/// What further holes take of the section of the crack, and how near its ends they are.
/// Errors: a hole that the crack reaches.
fn place_beside(flaw: &mut PartThrough, holes: &[Hole]) -> Result<()> {
    let further = &holes[..holes.len() - flaw.own_holes()];
    let lines: Vec<_> = flaw.seen_from_front(flaw.half_length).1;
    for (i, Hole { centre, radius }) in further.iter().enumerate() {
        let half_chord = (radius * radius - centre[1] * centre[1]).max(0.0).sqrt();
        flaw.other_holes += 2.0 * half_chord;
        for tip in lines.iter().filter(|_| half_chord > 0.0) {
            let way = (centre[0] - tip.position[0]) * tip.direction[0] - half_chord;
            if way > 0.0 {
                flaw.to_hole = flaw.to_hole.min(flaw.half_length + way);
            } else if way + 2.0 * half_chord > -flaw.half_length {
                let (key, problem) = (format!("specimen.holes[{i}]"), "lies on the crack");
                return Err(input_missing(&key, problem, "describe a crack that starts at a hole as corner_crack_at_hole"));
            }
        }
    }
    Ok(())
}

/// Radius of the hole, m, and number of cracks.
fn hole(description: &Description, input: &Input, width: f64) -> Result<(f64, usize)> {
    const DIAMETER: &str = "specimen.hole_diameter_mm";
    const CRACKS: &str = "specimen.cracks";
    let kind = description.kind;
    if !description.has_hole {
        let problem = format!("does not go with {kind}, which lies in a plate without a hole");
        let remedy = format!("leave it out, or use kind = \"{}\"", SpecimenKind::CornerCrackAtHole);
        return match (input.hole_diameter_mm, input.cracks) {
            (Some(diameter), _) => Err(perilife_base::error::input(DIAMETER, diameter, problem, remedy)),
            (None, Some(cracks)) => Err(perilife_base::error::input(CRACKS, cracks, problem, remedy)),
            (None, None) => Ok((0.0, 1)),
        };
    }
    let diameter =
        input.hole_diameter_mm.ok_or_else(|| input_missing(DIAMETER, "is missing", "give the diameter of the hole"))?;
    let radius = LENGTH.read(DIAMETER, diameter)? / 2.0;
    if 2.0 * radius >= width {
        let problem = format!("is not below the width {} mm of the plate", input.width_mm);
        return Err(perilife_base::error::input(DIAMETER, diameter, problem, "give a smaller hole or a wider plate"));
    }
    const REMEDY: &str = "give 1, a crack on one side of the hole, or 2, one on both";
    match input.cracks {
        Some(cracks @ (1 | 2)) => Ok((radius, cracks)),
        Some(cracks) => Err(perilife_base::error::input(CRACKS, cracks, "is not 1 or 2", REMEDY)),
        None => Err(input_missing(CRACKS, "is missing", REMEDY)),
    }
}

/// The crack lies in the section.
fn check_sizes(flaw: &PartThrough, given: &Input) -> Result<()> {
    let mm = |length: f64| (length / MM * 1e6).round() / 1e6;
    if flaw.depth >= flaw.through_depth() {
        let (t, half) = (mm(flaw.through_depth()), if flaw.through_depth() < flaw.thickness { "half " } else { "" });
        let problem =
            format!("is not below {half}the thickness, {t} mm: a/t = {:.3}, the crack is through", given.crack_depth_mm / t);
        let remedy = "give a smaller depth, or a through crack in kind = \"plate\"";
        return Err(input("specimen.crack_depth_mm", given.crack_depth_mm, problem, remedy));
    }
    if flaw.half_length >= flaw.room() {
        let problem =
            format!("is not below the {} mm that the plate has for it: the crack is wider than the plate", mm(flaw.room()));
        return Err(input(
            "specimen.crack_half_length_mm",
            given.crack_half_length_mm,
            problem,
            "give a shorter crack or a wider plate",
        ));
    }
    Ok(())
}
