//! Stress along the rims of a plate of nodes: of holes, slots and the outline.
//!
//! Strain along a rim is the slope of the displacement there, `ε_t = t·∂u/∂s`, and with the stress across it `σ_t = E' ε_t + ν' σ_n`
//! (plane strain: ν' = ν/(1-ν)); on a rim that nothing presses σ_n is 0. Displacements of nodes without elements are far better than their
//! gradients, which are least exact on a rim, where nodes lie on one side alone: a polynomial of the fourth degree in the way along the rim,
//! through the displacements of eight spacings by least squares, is differentiated. σ_n under a load is read from gradients.

use nalgebra::{DMatrix, DVector};

use super::field::{Discretisation, Local};
use super::rims::ARC_TURN;
use perilife_base::error::{Error, Result};
use perilife_plate::specimen::geometry::{along, direction, distance, distance_to_segment, edges, segments_touch, turn_at};
use perilife_plate::specimen::{Hole, Load, Point, Specimen, Support};

/// Places on the rim of a hole: the stress of `cos 2θ` is read within 1e-5 of its peak.
const PLACES_ON_HOLE: usize = 720;
/// Places on a straight side in the local spacing.
const PLACES_IN_SPACING: f64 = 4.0;
/// Places on a straight side at the most.
const PLACES_ON_SIDE: f64 = 2000.0;
/// Half of the way along the rim over which displacements are fitted: in local spacings at the least, and over the radius of the rim, where the
/// fourth degree errs by 5e-4 of a stress of `cos 2θ`.
const HALF_WINDOW: [f64; 2] = [4.0, 0.35];
/// Degree of the polynomial, also where the window is cut short to less than half on one side, and places that it needs at the least.
const DEGREE: [usize; 2] = [4, 2];
const PLACES_LEAST: usize = 8;
/// Share of the size of a plate by which a place may lie off a rim that it belongs to.
const OFF: f64 = 1e-9;
/// Step from a rim into the material, in local spacings, where the plate is read on the rim itself.
const INWARD: f64 = 1e-6;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rim {
    /// A hole, by its place in `Specimen::holes`.
    Hole(usize),
    /// A slot, by its place in `Specimen::slots`.
    Slot(usize),
    /// The outline, without what supports hold.
    Outline,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressAt {
    /// Place, m.
    pub at: Point,
    /// Stress along the rim, Pa, positive in tension.
    pub stress: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimStress {
    pub rim: Rim,
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
            found.extend(reader.stresses(&on_side(plate, b, a, 0.0, f64::INFINITY), None));
        }
        rims.push(extremes(Rim::Slot(index), found, [true, false])?);
    }
    let found = outline(specimen, plate).iter().flat_map(|stretch| reader.stresses(stretch, None)).collect();
    let (corners, count) = (&specimen.outline, specimen.outline.len());
    let turn = |k: usize| turn_at(corners[(k + count - 1) % count], corners[k], corners[(k + 1) % count]);
    let [is_sharp, has_arcs] =
        [(0..count).any(|k| turn(k) < -ARC_TURN), (0..count).any(|k| (-ARC_TURN..-1e-6).contains(&turn(k)))];
    rims.push(extremes(Rim::Outline, found, [is_sharp, has_arcs])?);
    Ok(rims)
}

/// A place on a rim.
#[derive(Clone, Copy)]
struct BoundaryPoint {
    at: Point,
    /// Direction of the rim; the material is on its left.
    tangent: Point,
    /// Way along the rim, m.
    way: f64,
    /// Spacing of nodes there, m.
    spacing: f64,
    /// Half of the way along the rim over which displacements are fitted, m.
    half_window: f64,
}

/// Half a window on a rim of this radius, m.
fn half_window(spacing: f64, radius: f64) -> f64 {
    (HALF_WINDOW[0] * spacing).max(if radius.is_finite() { HALF_WINDOW[1] * radius } else { 0.0 })
}

/// Stretches of the outline between its corners, those of arcs within them; without what supports hold.
fn outline(specimen: &Specimen, plate: &Discretisation) -> Vec<Vec<BoundaryPoint>> {
    let (corners, count) = (&specimen.outline, specimen.outline.len());
    let corner = |k: usize| corners[k % count];
    let is_corner = |k: usize| turn_at(corner(k + count - 1), corner(k), corner(k + 1)).abs() > ARC_TURN;
    let first = (0..count).find(|k| is_corner(*k)).unwrap_or(0);
    let mut stretches: Vec<Vec<BoundaryPoint>> = vec![Vec::new()];
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
            // A side of an arc turns by half of the turns at its ends.
            let turns = [k, k + 1].map(|k| turn_at(corner(k + count - 1), corner(k), corner(k + 1)).abs());
            let of_arc = turns.into_iter().filter(|turn| *turn <= ARC_TURN).sum::<f64>();
            stretch.extend(on_side(plate, a, b, way, 2.0 * distance(a, b) / of_arc));
        }
        way += distance(a, b);
    }
    stretches
}

/// Places on a hole, clockwise, so that the material is on the left.
fn on_hole(plate: &Discretisation, hole: &Hole) -> Vec<BoundaryPoint> {
    let place = |k: usize| {
        let angle = -std::f64::consts::TAU * k as f64 / PLACES_ON_HOLE as f64;
        let (sin, cos) = angle.sin_cos();
        let at = [hole.centre[0] + hole.radius * cos, hole.centre[1] + hole.radius * sin];
        let spacing = plate.grid.finest(at);
        let half_window = half_window(spacing, hole.radius);
        BoundaryPoint { at, tangent: [sin, -cos], way: -angle * hole.radius, spacing, half_window }
    };
    (0..PLACES_ON_HOLE).map(place).collect()
}

/// Places on a straight side; the material is on its left. `way` is that of its first end, `radius` that of the arc that it is a side of, m.
fn on_side(plate: &Discretisation, a: Point, b: Point, way: f64, radius: f64) -> Vec<BoundaryPoint> {
    let grid = &plate.grid;
    let spacing_at = |at: Point| grid.finest(at);
    let least = [0.0, 0.5, 1.0].map(|share| spacing_at(along(a, b, share))).into_iter().fold(f64::INFINITY, f64::min);
    let count = (PLACES_IN_SPACING * distance(a, b) / least).ceil().clamp(1.0, PLACES_ON_SIDE) as usize;
    let place = |k: usize| {
        let share = (k as f64 + 0.5) / count as f64;
        let at = along(a, b, share);
        let spacing = spacing_at(at);
        let half_window = half_window(spacing, radius);
        BoundaryPoint { at, tangent: direction(a, b), way: way + share * distance(a, b), spacing, half_window }
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

/// What is read at a place.
struct StressSample {
    place: BoundaryPoint,
    /// Displacement, m.
    u: Point,
    /// Stress across the rim, Pa.
    across: f64,
}

impl Reader<'_> {
    /// Stress along a stretch of rim; `around` is the way round a closed one, m.
    fn stresses(&self, places: &[BoundaryPoint], around: Option<f64>) -> Vec<StressAt> {
        let mut local = Local::default();
        let read: Vec<StressSample> = places.iter().filter_map(|place| self.read(place, &mut local)).collect();
        let count = read.len();
        let is_cut: Vec<bool> = (0..count).map(|index| self.is_cut(&read[index], &read[(index + 1) % count])).collect();
        let elasticity = self.plate.elasticity();
        let lateral = (3.0 - elasticity.kappa) / (1.0 + elasticity.kappa);
        let stress = |index: usize| {
            let place = read[index].place;
            let mut window = vec![index];
            // Forth and back along the rim, up to its ends and the cracks that begin at it.
            for forth in [true, false] {
                let mut last = index;
                while window.len() < count {
                    let next = if forth { (last + 1) % count } else { (last + count - 1) % count };
                    let (is_end, gap) = if forth { (next < last, last) } else { (next > last, next) };
                    if is_end && around.is_none() || is_cut[gap] || way(&place, &read[next].place, around).abs() > 1.0 {
                        break;
                    }
                    window.push(next);
                    last = next;
                }
            }
            let ways: Vec<f64> = window.iter().map(|&other| way(&place, &read[other].place, around)).collect();
            let [x, y] = [0, 1].map(|part| slope_at_origin(&ways, window.iter().map(|&other| read[other].u[part])));
            let strain = (x? * place.tangent[0] + y? * place.tangent[1]) / place.half_window;
            let across = window.iter().map(|&other| read[other].across).sum::<f64>() / window.len() as f64;
            let stress = self.share * (elasticity.plane_modulus * strain + lateral * across);
            Some(StressAt { at: place.at, stress })
        };
        (0..count).filter_map(stress).collect()
    }

    fn read(&self, place: &BoundaryPoint, local: &mut Local) -> Option<StressSample> {
        let ([x, y], step) = (place.tangent, INWARD * place.spacing);
        let at = [place.at[0] - step * y, place.at[1] + step * x];
        let (u, gradient) = self.plate.displacement(self.u, at, local)?;
        let across = if self.is_loaded(place.at) {
            let [xx, yy, xy] = self.plate.elasticity().stress(&gradient);
            xx * y * y + yy * x * x - 2.0 * xy * x * y
        } else {
            0.0
        };
        Some(StressSample { place: *place, u, across })
    }

    /// Whether a load acts on a place of a rim.
    fn is_loaded(&self, at: Point) -> bool {
        let off = OFF * self.specimen.width;
        self.specimen.loads.iter().any(|load| match (load, load.on_edge()) {
            (_, Some((from, to, _))) => distance_to_segment(at, from, to) < off,
            (Load::Pin { hole, .. }, None) => {
                let Hole { centre, radius } = self.specimen.holes[*hole];
                (distance(at, centre) - radius).abs() < off
            }
            _ => false,
        })
    }

    /// Whether a crack begins between two places.
    fn is_cut(&self, a: &StressSample, b: &StressSample) -> bool {
        let cuts = &self.plate.obstacles.cuts[..self.plate.cracks];
        cuts.iter().flat_map(|cut| cut.points.windows(2)).any(|piece| segments_touch(a.place.at, b.place.at, piece[0], piece[1]))
    }
}

/// Way along the rim from one place to another, in half windows of the first.
fn way(from: &BoundaryPoint, to: &BoundaryPoint, around: Option<f64>) -> f64 {
    let way = to.way - from.way;
    around.map_or(way, |around| way - around * (way / around).round()) / from.half_window
}

/// Slope at x = 0 of the polynomial through points (x, y) by least squares; `None` where they do not tell one.
fn slope_at_origin(x: &[f64], y: impl Iterator<Item = f64>) -> Option<f64> {
    if x.len() < PLACES_LEAST {
        return None;
    }
    let sides = [-1.0, 1.0].map(|side| x.iter().map(|x| side * x).fold(0.0, f64::max));
    let degree = DEGREE[usize::from(sides[0].min(sides[1]) < 0.5)];
    let powers = DMatrix::from_fn(x.len(), degree + 1, |row, power| x[row].powi(power as i32));
    let right = powers.tr_mul(&DVector::from_iterator(x.len(), y));
    Some(powers.tr_mul(&powers).cholesky()?.solve(&right)[1])
}

fn extremes(rim: Rim, places: Vec<StressAt>, [is_sharp, is_round]: [bool; 2]) -> Result<RimStress> {
    let by_stress = |a: &StressAt, b: &StressAt| a.stress.total_cmp(&b.stress);
    match (places.iter().copied().max_by(by_stress), places.iter().copied().min_by(by_stress)) {
        (Some(largest), Some(least)) => Ok(RimStress { rim, largest, least, is_sharp, is_round: is_round && !is_sharp }),
        _ => Err(Error::Mechanics(
            "too few nodes near a boundary for the basis; increase model.influence_radius or model.nodes".to_owned(),
        )),
    }
}
