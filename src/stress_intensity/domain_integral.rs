//! Interaction integral over a ring around the tip, on the plate of [`super::stress_intensity`].

use super::ring::{Balanced, RingGeometry};
use super::{CrackedPlate, Field, too_close};
use crate::error::Result;

/// Outer radius of the ring in horizons, where the plate leaves that room.
const OUTER_HORIZONS: f64 = 6.0;
/// Least outer radius in horizons: below it most of the ring lies in the disturbed core.
const OUTER_HORIZONS_MIN: f64 = 1.5;

/// K_I and K_II of a tip, Pa√m.
///
/// # Errors
/// No room for a ring between the core of the tip and whatever is next to it.
pub fn factors(plate: &CrackedPlate, field: &Field, tip: usize) -> Result<[f64; 2]> {
    let (body, specimen, horizon) = (&plate.body, &field.specimen, plate.body.horizon());
    let mut lines = specimen.crack_lines();
    let ends: Vec<_> = (0..specimen.tips.len()).filter_map(|tip| specimen.line_end(tip)).collect();
    let position = specimen.tips[tip].position;
    let Some(end) = specimen.line_end(tip) else { return Err(too_close("no crack ends", position)) };
    // The ring stands around the place to which the cut bonds reach.
    lines[end.line].stretch(end.at_last, plate.represented(specimen, tip).excess);
    let surroundings = RingGeometry::new(body, specimen, &plate.case.material);
    let clear = plate.clear_radius(specimen, tip).min(OUTER_HORIZONS * horizon);
    let outer = surroundings.radius(body, &lines, end, &ends, clear);
    if outer < OUTER_HORIZONS_MIN * horizon {
        return Err(too_close("there is no room for the ring of the domain integral", position));
    }
    let load = plate.case.loading.maximum;
    let balanced = Balanced { body, bonds: &field.bonds, displacement: &field.displacement, load, lines: &lines };
    Ok(surroundings.factors(balanced, end, outer).factors)
}
