//! `[specimen]` of a crack that does not go through: its keys, and the plate seen from the front.

use toml::Value;

use super::{PartThrough, PartThroughSpec};
use crate::specimen::keys::{HOLE_DIAMETER, LENGTH, THICKNESS, WIDTH};
use crate::specimen::placement::check_holes;
use crate::specimen::plate::{HoleKeys, read_holes};
use crate::specimen::{Hole, Specimen};
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::keys::{Given, Key, Section, key, length, number, part};
use perilife_base::units::round_mm;

/// Length of the plate over its width where the case does not say: ends so far away that they do not matter.
const LENGTH_OVER_WIDTH: f64 = 3.0;

perilife_base::keys! {
    pub(super) struct Keys {
        width: f64 = WIDTH;
        length: Option<f64> = LENGTH.said("Length L: along the load; default 3 W");
        thickness: f64 = THICKNESS;
        depth: f64 = length("crack_depth_mm", "Crack depth a: into the thickness");
        half_length: f64 = length("crack_half_length_mm", "Surface length c: half length where both ends are on the surface");
        holes: Vec<HoleKeys> = key("holes", "Further holes of the plate"), or "none" Vec::new();
    }
    pub(super) struct KeysAtHole {
        own: Keys = part();
        diameter: f64 = HOLE_DIAMETER;
        cracks: usize = number("cracks", "Cracks at the hole: 1 or 2 sides", "a number of cracks", 1.0, 2.0)
            .missing("give 1, a crack on one side of the hole, or 2, one on both");
    }
}

pub(in crate::specimen) fn keys(description: &PartThroughSpec) -> &'static [Key] {
    if description.has_hole { KeysAtHole::KEYS } else { Keys::KEYS }
}

/// The plate with its crack. That the length is the program's own goes into `notes`.
pub(in crate::specimen) fn from_value(
    description: &'static PartThroughSpec,
    value: &Value,
    notes: &mut Vec<String>,
) -> Result<Specimen> {
    let given = Given::of(value, "specimen")?;
    let (own, radius, cracks) = if description.has_hole {
        let KeysAtHole { own, diameter, cracks } = KeysAtHole::read(&given)?;
        let problem = || format!("must be below the width {} mm", round_mm(own.width));
        fail_if!(diameter >= own.width, given.refuse(HOLE_DIAMETER.name, problem(), "use a smaller hole or a wider plate"));
        (own, diameter / 2.0, cracks)
    } else {
        (Keys::read(&given)?, 0.0, 1)
    };
    let Keys { width, length, thickness, depth, half_length, holes } = own;
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
    check_sizes(&flaw)?;
    let plate = Specimen::strip(description.kind, width, length.unwrap_or(LENGTH_OVER_WIDTH * width), thickness);
    let mut holes = read_holes(&holes)?;
    holes.extend((radius > 0.0).then_some(Hole { centre: [0.0, 0.0], radius }));
    let mut specimen = Specimen { holes, ..plate };
    check_holes(&specimen)?;
    place_beside(&mut flaw, &specimen.holes)?;
    specimen.part_through = Some(flaw);
    (specimen.cracks, specimen.tips) = flaw.seen_from_front(half_length);
    specimen.crack_length = half_length;
    if length.is_none() {
        notes.push(format!("plate: specimen.length_mm not given: {LENGTH_OVER_WIDTH} W assumed after breakthrough"));
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
                let (key, problem) = (format!("specimen.holes[{i}]"), "is on the crack");
                return Err(input_missing(&key, problem, "use corner_crack_at_hole for a crack that starts at a hole"));
            }
        }
    }
    Ok(())
}

fn check_sizes(flaw: &PartThrough) -> Result<()> {
    let (depth, half_length) = (round_mm(flaw.depth), round_mm(flaw.half_length));
    if flaw.depth >= flaw.through_depth() {
        let (t, half) = (round_mm(flaw.through_depth()), if flaw.through_depth() < flaw.thickness { "half " } else { "" });
        let problem = format!("must be below {half}the thickness, {t} mm (a/t = {:.3})", depth / t);
        let remedy = "reduce the depth, or use a through crack in kind = \"plate\"";
        return Err(input("specimen.crack_depth_mm", depth, problem, remedy));
    }
    if flaw.half_length >= flaw.room() {
        let room = round_mm(flaw.room());
        let problem = format!("must be below {room} mm: the crack is wider than the plate");
        return Err(input("specimen.crack_half_length_mm", half_length, problem, "give a shorter crack or a wider plate"));
    }
    Ok(())
}
