//! Bond lives at N = 0 of a specimen that was pre-cracked.
//!
//! Steady growth at rate v spends a bond that the tip passes by `A/v ∫ ε^p dx` over its way through the ageing zone. With the
//! field of the initial crack standing for the field of the shorter ones before it, the way of a bond that is now at x
//! ahead of the tip is the stretch from x to the rim of the zone, and the rate follows from the bond that has been spent
//! most: `λ = 1 - C/C_max`, `C = ∫_x^rim ε^p dx'`, where C_max adds the little way to the next break, so that N = 0 lies
//! between two breaks as any moment of steady growth does.

use super::FatigueSettings;
use super::crack_tip::CrackTip;
use crate::body::{Body, Bond};
use crate::solver::field::Layout;
use crate::specimen::Point;
use crate::specimen::geometry::distance;

/// Samples per spacing of the way through the zone.
const SAMPLES_PER_SPACING: f64 = 4.0;

/// Way that the tip still has to go to the next break, in spacings: a pair of the about 18 bonds that a spacing of crack
/// severs at a horizon of three spacings.
const WAY_TO_BREAK: f64 = 1.0 / 9.0;

/// The way of one bond through the ageing zone: strains (up to a common factor) at equal steps ahead of its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Passage {
    /// Which bond.
    pub bond: Bond,
    /// Stretches along the way, tension only.
    pub stretches: Vec<f64>,
}

/// Passages of the candidate bonds through the zone of their tip. Tips at slots have none: a slot was not grown.
#[must_use]
pub fn passages(
    body: &Body,
    candidates: &[Bond],
    tips: &[(CrackTip, bool)],
    settings: &FatigueSettings,
    displacement: &[f64],
) -> Vec<Vec<Passage>> {
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let radius = settings.zone_radius_horizons * body.horizon();
    let step = body.lattice.spacing / SAMPLES_PER_SPACING;
    let mut all = vec![Vec::new(); tips.len()];
    for &bond in candidates {
        let middle = body.middle(bond);
        let Some(nearest) = (0..tips.len())
            .min_by(|&a, &b| distance(tips[a].0.position, middle).total_cmp(&distance(tips[b].0.position, middle)))
        else {
            continue;
        };
        let (tip, from_slot) = &tips[nearest];
        if *from_slot {
            continue;
        }
        let relative = [middle[0] - tip.position[0], middle[1] - tip.position[1]];
        let ahead = relative[0] * tip.direction[0] + relative[1] * tip.direction[1];
        let across = relative[1] * tip.direction[0] - relative[0] * tip.direction[1];
        let rim = (radius * radius - across * across).max(0.0).sqrt();
        // Behind the tip the field of this crack says nothing about the field that passed.
        let start = (-ahead).max(0.0);
        let samples = ((rim - ahead - start).max(0.0) / step).ceil() as usize;
        let stretches = (0..samples)
            .map(|i| stretch_ahead(body, &layout, displacement, bond, tip.direction, start + (i as f64 + 0.5) * step).max(0.0));
        all[nearest].push(Passage { bond, stretches: stretches.collect() });
    }
    all
}

/// Remaining lives for an exponent p, tip by tip.
#[must_use]
pub fn steady_lives(passages: &[Vec<Passage>], p: f64) -> Vec<(Bond, f64)> {
    let mut lives = Vec::new();
    for of_tip in passages {
        let spent: Vec<f64> = of_tip.iter().map(|passage| passage.stretches.iter().map(|s| s.powf(p)).sum()).collect();
        let next = |passage: &Passage| passage.stretches.first().map_or(0.0, |s| WAY_TO_BREAK * SAMPLES_PER_SPACING * s.powf(p));
        let most = of_tip.iter().zip(&spent).map(|(passage, c)| c + next(passage)).fold(0.0, f64::max);
        if most > 0.0 {
            lives.extend(of_tip.iter().zip(&spent).map(|(passage, c)| (passage.bond, 1.0 - c / most)));
        }
    }
    lives
}

/// Stretch that a bond would have if it stood `ahead` farther along `direction`, from the displacement interpolated there.
fn stretch_ahead(body: &Body, layout: &Layout, displacement: &[f64], bond: Bond, direction: Point, ahead: f64) -> f64 {
    let (k, from, to) = body.ends(bond);
    let shift = body.lattice.to_axes([direction[0] * ahead / body.lattice.spacing, direction[1] * ahead / body.lattice.spacing]);
    let (Some(a), Some(b)) = (moved(body, layout, displacement, from, shift), moved(body, layout, displacement, to, shift))
    else {
        return 0.0;
    };
    let spring = &body.stencil.bonds[k];
    (spring.normal[0] * (b[0] - a[0]) + spring.normal[1] * (b[1] - a[1])) / spring.length
}

/// Displacement (lattice axes) at a place moved by a fraction of lattice steps, bilinear; `None` outside the material.
fn moved(body: &Body, layout: &Layout, displacement: &[f64], place: usize, shift: Point) -> Option<Point> {
    let (column, row) = body.lattice.column_row(place);
    let at = [column as f64 + shift[0], row as f64 + shift[1]];
    if at[0] < 0.0 || at[1] < 0.0 || at[0] > (body.lattice.columns - 1) as f64 || at[1] > (body.lattice.rows - 1) as f64 {
        return None;
    }
    let (low, fraction) = ([at[0].floor(), at[1].floor()], [at[0].fract(), at[1].fract()]);
    let mut value = [0.0; 2];
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let share =
            (if dx == 1 { fraction[0] } else { 1.0 - fraction[0] }) * (if dy == 1 { fraction[1] } else { 1.0 - fraction[1] });
        if share > 0.0 {
            let corner = body.lattice.place(low[0] as usize + dx, low[1] as usize + dy);
            if !body.is_point[corner] {
                return None;
            }
            let index = layout.index(corner);
            value = [value[0] + share * displacement[index], value[1] + share * displacement[index + layout.stride]];
        }
    }
    Some(value)
}
