//! Stress along the rims of a plate of nodes: of holes, slots and the outline.
//!
//! On a rim that nothing presses the only stress is that along it, `σ_t = tᵀ σ t`. Gradients of the shape functions are least exact on a rim,
//! where nodes lie on one side alone. The stress is therefore recovered from the material (as Zienkiewicz and Zhu 1992, IJNME 33:1331, do
//! for elements): at every place of a rim σ_t is read at some depths, and a quadratic through them by least squares gives that at depth 0; a
//! second one along the rim, over eight spacings, evens out what is left from place to place.

use super::field::{Discretisation, Local};
use super::resolution::{ARC_TURN, turn_at};
use crate::error::{Error, Result};
use crate::specimen::geometry::{along, direction, distance, distance_to_segment, edges};
use crate::specimen::{Hole, Point, Specimen, Support};

/// Places on the rim of a hole: the stress of `cos 2θ` is read within 1e-5 of its peak.
const PLACES_ON_HOLE: usize = 720;
/// Places on a straight side in the local spacing.
const PLACES_IN_SPACING: f64 = 4.0;
/// Places on a straight side at the most.
const PLACES_ON_SIDE: f64 = 2000.0;
/// Depths at which the stress is read, in local spacings.
const DEPTHS: [f64; 6] = [0.5, 0.9, 1.3, 1.7, 2.1, 2.5];
/// Depths of them that a quadratic needs at the least.
const DEPTHS_LEAST: usize = 4;
/// Half of the way along the rim over which the stress is evened out, in local spacings: single readings err by 2 to 3 % rms, and by less with
/// finer nodes only slowly, since strains of Gauss points err from node to node.
const HALF_WINDOW: f64 = 4.0;
/// Step from a rim into the material, in local spacings, where the stress is read on the rim itself.
const INWARD: f64 = 1e-6;

/// Which rim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rim {
    /// A hole, by its place in `Specimen::holes`.
    Hole(usize),
    /// A slot, by its place in `Specimen::slots`.
    Slot(usize),
    /// The outline, without what supports hold.
    Outline,
}

/// A stress and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressAt {
    /// Place, m.
    pub at: Point,
    /// Stress along the rim, Pa, positive in tension.
    pub stress: f64,
}

/// Stress along a rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimStress {
    /// Which rim.
    pub rim: Rim,
    /// The largest.
    pub largest: StressAt,
    /// The least, in compression where it is negative.
    pub least: StressAt,
    /// Whether the rim has a sharp re-entrant corner, where the stress of elasticity has no bound: its peak grows as nodes get finer.
    pub is_sharp: bool,
    /// Whether it is a hole or has concave arcs, whose peaks are to settle as nodes get finer.
    pub is_round: bool,
}

impl RimStress {
    /// The larger in size of both.
    pub fn peak(&self) -> StressAt {
        if self.least.stress.abs() > self.largest.stress.abs() { self.least } else { self.largest }
    }
}

/// Stress along every rim, the unknowns `u` being those of the nominal load, of which the plate has the `share`.
/// Errors: [`Error::Mechanics`] where nodes in reach span the basis nowhere on a rim.
pub fn rim_stresses(specimen: &Specimen, plate: &Discretisation, u: &[f64], share: f64) -> Result<Vec<RimStress>> {
    let reader = Reader { specimen, plate, u, share };
    let mut rims = Vec::new();
    for (index, hole) in specimen.holes.iter().enumerate() {
        let places = on_hole(plate, hole);
        let around = std::f64::consts::TAU * hole.radius;
        rims.push(extremes(Rim::Hole(index), reader.stresses(&places, Some(around)), [false, true])?);
    }
    for (index, slot) in specimen.slots.iter().enumerate() {
        let corners = slot.corners();
        let mut found = Vec::new();
        for (a, b) in edges(&corners) {
            // Counter-clockwise around the slot: the material is on the right.
            found.extend(reader.stresses(&on_side(plate, b, a, 0.0), None));
        }
        rims.push(extremes(Rim::Slot(index), found, [true, false])?);
    }
    let found = outline(specimen, plate).iter().flat_map(|stretch| reader.stresses(stretch, None)).collect();
    rims.push(extremes(Rim::Outline, found, corners_of(&specimen.outline))?);
    Ok(rims)
}

/// A place on a rim.
#[derive(Clone, Copy)]
struct Place {
    at: Point,
    /// Direction of the rim; the material is on its left.
    tangent: Point,
    /// Way along the rim, m.
    way: f64,
    /// Spacing of nodes there, m.
    spacing: f64,
}

/// Stretches of the outline between its corners, those of arcs within them; without what supports hold.
fn outline(specimen: &Specimen, plate: &Discretisation) -> Vec<Vec<Place>> {
    let (corners, count) = (&specimen.outline, specimen.outline.len());
    let corner = |k: usize| corners[k % count];
    let is_corner = |k: usize| turn_at(corner(k + count - 1), corner(k), corner(k + 1)).abs() > ARC_TURN;
    let first = (0..count).find(|k| is_corner(*k)).unwrap_or(0);
    let mut stretches: Vec<Vec<Place>> = vec![Vec::new()];
    let mut way = 0.0;
    for k in first..first + count {
        let (a, b) = (corner(k), corner(k + 1));
        if is_corner(k) {
            stretches.push(Vec::new());
        }
        let held = |support: &Support| match *support {
            Support::Fixed { from, to, .. } | Support::Moved { from, to, .. } => {
                [a, b].iter().all(|at| distance_to_segment(*at, from, to) < 1e-9)
            }
            _ => false,
        };
        if specimen.supports.iter().any(held) {
            stretches.push(Vec::new());
        } else if let Some(stretch) = stretches.last_mut() {
            stretch.extend(on_side(plate, a, b, way));
        }
        way += distance(a, b);
    }
    stretches
}

/// Places on a hole, clockwise, so that the material is on the left.
fn on_hole(plate: &Discretisation, hole: &Hole) -> Vec<Place> {
    let place = |k: usize| {
        let angle = -std::f64::consts::TAU * k as f64 / PLACES_ON_HOLE as f64;
        let (sin, cos) = angle.sin_cos();
        let at = [hole.centre[0] + hole.radius * cos, hole.centre[1] + hole.radius * sin];
        Place { at, tangent: [sin, -cos], way: -angle * hole.radius, spacing: plate.grid.spacing(plate.grid.leaf(at)) }
    };
    (0..PLACES_ON_HOLE).map(place).collect()
}

/// Places on a straight side; the material is on its left. `way` is that of its first end.
fn on_side(plate: &Discretisation, a: Point, b: Point, way: f64) -> Vec<Place> {
    let grid = &plate.grid;
    let spacing_at = |at: Point| grid.spacing(grid.leaf(at));
    let least = [0.0, 0.5, 1.0].map(|share| spacing_at(along(a, b, share))).into_iter().fold(f64::INFINITY, f64::min);
    let count = (PLACES_IN_SPACING * distance(a, b) / least).ceil().clamp(1.0, PLACES_ON_SIDE) as usize;
    let place = |k: usize| {
        let share = (k as f64 + 0.5) / count as f64;
        let at = along(a, b, share);
        Place { at, tangent: direction(a, b), way: way + share * distance(a, b), spacing: spacing_at(at) }
    };
    (0..count).map(place).collect()
}

/// Reads a plate at the `share` of its solution.
struct Reader<'a> {
    specimen: &'a Specimen,
    plate: &'a Discretisation,
    u: &'a [f64],
    share: f64,
}

impl Reader<'_> {
    /// Stress along a stretch of rim, evened out; `around` is the way round a closed one, m.
    fn stresses(&self, places: &[Place], around: Option<f64>) -> Vec<StressAt> {
        let mut local = Local::default();
        let read: Vec<(Place, f64)> = places.iter().filter_map(|place| Some((*place, self.at_rim(place, &mut local)?))).collect();
        let even = |index: usize| {
            let (place, own) = read[index];
            let mut window = Vec::new();
            let mut gather = |indices: &mut dyn Iterator<Item = usize>| {
                for other in indices.take(read.len() - 1) {
                    let mut way = read[other].0.way - place.way;
                    if let Some(around) = around {
                        way -= around * (way / around).round();
                    }
                    if way.abs() > HALF_WINDOW * place.spacing {
                        break;
                    }
                    window.push((way / place.spacing, read[other].1));
                }
            };
            let is_closed = around.is_some();
            gather(&mut (index + 1..read.len()).chain((0..index).filter(|_| is_closed)));
            gather(&mut (0..index).rev().chain((index + 1..read.len()).rev().filter(|_| is_closed)));
            window.push((0.0, own));
            StressAt { at: place.at, stress: at_origin(&window).unwrap_or(own) }
        };
        (0..read.len()).map(even).collect()
    }

    /// Stress along the rim at depth 0, from the depths that lie in the material.
    fn at_rim(&self, place: &Place, local: &mut Local) -> Option<f64> {
        let depths = DEPTHS.map(|depth| Some((depth, self.at_depth(place, depth, local)?)));
        let known: Vec<(f64, f64)> = depths.into_iter().map_while(|read| read).collect();
        let fitted = if known.len() < DEPTHS_LEAST { None } else { at_origin(&known) };
        fitted.or_else(|| self.at_depth(place, INWARD, local))
    }

    /// Stress along the rim, Pa, at a depth in local spacings.
    fn at_depth(&self, place: &Place, depth: f64, local: &mut Local) -> Option<f64> {
        let ([x, y], step) = (place.tangent, depth * place.spacing);
        let at = [place.at[0] - step * y, place.at[1] + step * x];
        if !self.specimen.contains(at) {
            return None;
        }
        let (_, gradient) = self.plate.displacement(self.u, at, local)?;
        let [xx, yy, xy] = self.plate.elasticity().stress(&gradient);
        Some(self.share * (xx * x * x + yy * y * y + 2.0 * xy * x * y))
    }
}

/// Value at x = 0 of the parabola through points (x, y) by least squares; `None` where they do not tell one.
fn at_origin(points: &[(f64, f64)]) -> Option<f64> {
    let (mut s, mut t) = ([0.0; 5], [0.0; 3]);
    for &(x, y) in points {
        let powers = [1.0, x, x * x, x * x * x, x * x * x * x];
        s.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power);
        t.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power * y);
    }
    let first = [s[2] * s[4] - s[3] * s[3], s[2] * s[3] - s[1] * s[4], s[1] * s[3] - s[2] * s[2]];
    let determinant = s[0] * first[0] + s[1] * first[1] + s[2] * first[2];
    let value = first.iter().zip(t).map(|(factor, t)| factor * t).sum::<f64>() / determinant;
    (determinant > 1e-9 * s[0] * first[0]).then_some(value)
}

fn extremes(rim: Rim, places: Vec<StressAt>, [is_sharp, is_round]: [bool; 2]) -> Result<RimStress> {
    let by_stress = |a: &StressAt, b: &StressAt| a.stress.total_cmp(&b.stress);
    match (places.iter().copied().max_by(by_stress), places.iter().copied().min_by(by_stress)) {
        (Some(largest), Some(least)) => Ok(RimStress { rim, largest, least, is_sharp, is_round: is_round && !is_sharp }),
        _ => Err(Error::Mechanics(
            "too few nodes are in reach of a rim to span the basis; give a larger model.influence_radius, or more model.nodes"
                .to_owned(),
        )),
    }
}

/// Whether an outline has sharp re-entrant corners, and concave arcs.
fn corners_of(outline: &[Point]) -> [bool; 2] {
    let count = outline.len();
    let turn = |k: usize| turn_at(outline[(k + count - 1) % count], outline[k], outline[(k + 1) % count]);
    [(0..count).any(|k| turn(k) < -ARC_TURN), (0..count).any(|k| (-ARC_TURN..-1e-6).contains(&turn(k)))]
}
