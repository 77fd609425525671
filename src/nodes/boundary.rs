//! Loads and supports as vectors and matrices of unknowns.
//!
//! Shape functions are not 1 at their node: a held displacement is a penalty `β E'/h_s ∫ u² ds`, β = 1000, whose error of K is 0.04 %
//! on a pulled plate. A plate that floats under loads in equilibrium is held at three unknowns, which is exact, since the shape functions
//! reproduce rigid motions and the springs take up no force.

use super::field::{Discretisation, Local, singular};
use super::rims::Stretch;
use perilife_base::error::Result;
use perilife_plate::loading::pieces::pieces_of;
use perilife_plate::loading::residual::{Components, across};
use perilife_plate::specimen::geometry::{along, bounding_box, direction, distance};
use perilife_plate::specimen::{Point, Specimen, Support};

/// Penalty over E' and the local spacing.
const PENALTY: f64 = 1e3;
/// Pieces of a load in a far spacing.
const PIECES_IN_SPACING: f64 = 6.0;
/// Distance from the plate within which a point counts as one of it, m.
const TOUCH: f64 = 1e-9;
/// Points of a held stretch in a local spacing.
const HELD_IN_SPACING: f64 = 3.0;

/// Directions of the components.
const AXES: [Point; 2] = [[1.0, 0.0], [0.0, 1.0]];

/// Unknowns of a grip: two displacements and a turn.
pub const UNKNOWNS_OF_GRIP: usize = 3;

/// `factor v vᵀ` of some unknowns: a support, which holds `v·u` at `way` times the displacement of the load.
#[derive(Debug, Clone, Default)]
pub struct Square {
    pub unknowns: Vec<u32>,
    pub v: Vec<f64>,
    pub factor: f64,
    /// Where it is held, over the displacement of the load.
    pub way: f64,
}

impl Square {
    /// A spring on the component along a direction of what unknowns move together.
    fn of(motions: &[(u32, Point)], [x, y]: Point, factor: f64) -> Self {
        let (unknowns, v) = motions.iter().map(|(unknown, motion)| (*unknown, motion[0] * x + motion[1] * y)).unzip();
        Square { unknowns, v, factor, way: 0.0 }
    }

    /// A spring on one unknown.
    pub fn spring(unknown: u32, factor: f64) -> Self {
        Square { unknowns: vec![unknown], v: vec![1.0], factor, way: 0.0 }
    }

    /// `Σ P way` of the force P of the spring, N per m of the displacement of the load, where the unknowns are those of 1 m.
    pub fn reaction(&self, u: &[f64]) -> f64 {
        self.factor * self.way * (self.way - self.moved(u))
    }

    /// What it holds of a displacement.
    pub fn moved(&self, u: &[f64]) -> f64 {
        self.unknowns.iter().zip(&self.v).map(|(&unknown, v)| v * u[unknown as usize]).sum()
    }
}

#[derive(Debug, Clone, Default)]
pub struct Boundary {
    /// Forces on the unknowns at unit nominal load, N, those of grips last; where sides are moved, what moves them by 1 m.
    pub forces: Vec<f64>,
    /// Springs of supports and grips.
    pub held: Vec<Square>,
    /// Unknowns that hold the plate where nothing else does: one along x, one along y, one against its turn.
    pub pins: [Option<u32>; 3],
    /// Their springs.
    pub spring: f64,
    /// Middles of grips, m, whose unknowns are displacement and turn of each.
    pub grips: Vec<Point>,
}

/// A rigid grip: three unknowns after those of the nodes.
struct Grip {
    first: usize,
    middle: Point,
    turns: bool,
}

impl Boundary {
    /// Of a plate with cracks under its loads.
    /// Errors: nodes in reach of a load or support do not span the basis.
    pub fn new(specimen: &Specimen, plate: &Discretisation, far: f64) -> Result<Self> {
        let spring = PIN * plate.elasticity().plane_modulus;
        let mut boundary = Boundary { forces: vec![0.0; plate.unknowns()], spring, ..Boundary::default() };
        let grips = boundary.grips(specimen, plate)?;
        // What sides that are moved bear is found with their displacement.
        let is_moved = specimen.moved_section().is_some();
        // Where elastic pins touch depends on the plate: `pins`.
        let known = specimen.loads.iter().filter(|load| !is_moved && !load.is_elastic_pin());
        for piece in known.flat_map(|load| pieces_of(load, specimen, far / PIECES_IN_SPACING)) {
            match grips.iter().find(|grip| (piece.facet.at[1] - grip.middle[1]).abs() < 1e-9 * specimen.length()) {
                // A rigid end takes up all that is on it.
                Some(grip) => {
                    let arm = piece.facet.at[0] - grip.middle[0];
                    boundary.forces[grip.first] += piece.force[0];
                    boundary.forces[grip.first + 1] += piece.force[1];
                    boundary.forces[grip.first + 2] += arm * piece.force[1];
                }
                None => push_force(&mut boundary.forces, plate, piece.facet.at, piece.force)?,
            }
        }
        let pressure = specimen.crack_pressure;
        if pressure != 0.0 {
            press_cracks(&mut boundary.forces, specimen, plate, &|_| [pressure, pressure, 0.0])?;
        }
        for support in &specimen.supports {
            match *support {
                Support::Fixed { from, to, depth, x, y } => {
                    let held: Vec<(Point, f64)> =
                        AXES.into_iter().zip([x, y]).filter(|(_, held)| *held).map(|(axis, _)| (axis, 0.0)).collect();
                    for ends in layers(plate, [from, to], depth) {
                        boundary.hold(specimen, plate, ends, &held)?;
                    }
                }
                Support::Moved { from, to, direction: [x, y], way, held } => {
                    let held = if held { &[([x, y], way), ([-y, x], 0.0)][..] } else { &[([x, y], way)] };
                    boundary.hold(specimen, plate, [from, to], held)?;
                }
                _ => {}
            }
        }
        let holds = |axis: usize| {
            specimen.supports.iter().any(|support| match *support {
                Support::Fixed { x, y, .. } => [x, y][axis],
                Support::Moved { direction, held, .. } => held || direction[axis].abs() > direction[1 - axis].abs(),
                _ => false,
            })
        };
        boundary.pin(plate, [holds(0), holds(1)], &specimen.supports);
        Ok(boundary)
    }

    /// Holds components of the displacement on a stretch of the outline: those along directions, at their ways.
    fn hold(&mut self, specimen: &Specimen, plate: &Discretisation, ends: [Point; 2], held: &[(Point, f64)]) -> Result<()> {
        for (at, length) in pieces(plate, ends).into_iter().filter(|(at, _)| specimen.has_point_at(*at, TOUCH)) {
            let (motions, factor) = (motions(plate, at)?, penalty(specimen, plate, at) * length);
            for &(direction, way) in held {
                let square = Square { way, ..Square::of(&motions, direction, factor) };
                let pull = square.unknowns.iter().zip(&square.v).filter(|_| way != 0.0);
                pull.for_each(|(&unknown, v)| self.forces[unknown as usize] += factor * way * v);
                self.held.push(square);
            }
        }
        Ok(())
    }

    /// Rigid ends of a plate that is gripped, whose unknowns are two displacements and a turn.
    fn grips(&mut self, specimen: &Specimen, plate: &Discretisation) -> Result<Vec<Grip>> {
        let clamped = specimen.supports.contains(&Support::ClampedEnds);
        if !clamped && !specimen.supports.contains(&Support::RigidEnds) {
            return Ok(Vec::new());
        }
        let [low, high] = bounding_box(&specimen.outline);
        let ends = [[low, [high[0], low[1]]], [[low[0], high[1]], high]];
        let mut grips = Vec::new();
        for stretch in ends {
            let (first, middle) = (self.forces.len(), along(stretch[0], stretch[1], 0.5));
            self.forces.extend([0.0; UNKNOWNS_OF_GRIP]);
            self.grips.push(middle);
            for (at, length) in pieces(plate, stretch) {
                let arm = at[0] - middle[0];
                let (mut motions, factor) = (motions(plate, at)?, penalty(specimen, plate, at) * length);
                motions.extend([(first as u32, [-1.0, 0.0]), (first as u32 + 1, [0.0, -1.0]), (first as u32 + 2, [0.0, -arm])]);
                self.held.extend(AXES.map(|axis| Square::of(&motions, axis, factor)));
            }
            grips.push(Grip { first, middle, turns: !clamped });
        }
        for grip in grips.iter().filter(|grip| !grip.turns) {
            let [width, size] = [high[0] - low[0], penalty(specimen, plate, grip.middle)];
            self.held.push(Square::of(&[(grip.first as u32 + 2, [1.0; 2])], AXES[0], size * width.powi(3)));
        }
        Ok(grips)
    }

    /// Holds the rigid motions that no support does.
    fn pin(&mut self, plate: &Discretisation, held: [bool; 2], supports: &[Support]) {
        let clamped = supports.contains(&Support::ClampedEnds);
        let at = &plate.nodes.at;
        let Some(a) = (0..at.len()).min_by(|a, b| (at[*a][0] + at[*a][1]).total_cmp(&(at[*b][0] + at[*b][1]))) else { return };
        let Some(b) = (0..at.len()).max_by(|i, j| distance(at[a], at[*i]).total_cmp(&distance(at[a], at[*j]))) else { return };
        let first = |node: usize| plate.first[node];
        let way = [(at[b][0] - at[a][0]).abs(), (at[b][1] - at[a][1]).abs()];
        let across = u32::from(way[0] >= way[1]);
        self.pins = [0, 1, 2].map(|axis| held.get(axis).is_some_and(|held| !held).then(|| first(a) + axis as u32));
        // A straight side that is held along its normal cannot turn.
        let turns = |support: &Support| match *support {
            Support::Fixed { from, to, x, y, .. } => [x, y][usize::from((to[1] - from[1]).abs() < (to[0] - from[0]).abs())],
            // Of itself, or by what holds or moves the other side.
            Support::Moved { .. } => true,
            _ => false,
        };
        if !clamped && !supports.iter().any(turns) {
            self.pins[2] = Some(first(b) + across);
        }
    }
}

/// Terms by their unknown, those of one added up.
pub fn summed(mut terms: Vec<(u32, f64)>) -> Vec<(u32, f64)> {
    terms.sort_by_key(|term| term.0);
    terms.chunk_by(|a, b| a.0 == b.0).map(|same| (same[0].0, same.iter().map(|term| term.1).sum())).collect()
}

fn push_force(forces: &mut [f64], plate: &Discretisation, at: Point, force: Point) -> Result<()> {
    for (unknown, [x, y]) in motions(plate, at)? {
        forces[unknown as usize] += force[0] * x + force[1] * y;
    }
    Ok(())
}

/// Adds the tractions `-σ m` that the faces of cracks release, m their outward normal and σ a stress, Pa.
/// Errors: nodes in reach of a face do not span the basis.
pub fn press_cracks(
    forces: &mut [f64],
    specimen: &Specimen,
    plate: &Discretisation,
    stress: &dyn Fn(Point) -> Components,
) -> Result<()> {
    for cut in &plate.obstacles.cuts {
        for piece in cut.points.windows(2) {
            let spacing = plate.grid.finest(piece[0]).min(plate.grid.finest(piece[1]));
            let count = (distance(piece[0], piece[1]) * PIECES_IN_SPACING / spacing).ceil();
            let [x, y] = direction(piece[0], piece[1]);
            let area = distance(piece[0], piece[1]) / count * specimen.thickness;
            for k in 0..count as usize {
                let at = along(piece[0], piece[1], (k as f64 + 0.5) / count);
                let stress = stress(at);
                // Into the material.
                for inward in [[-y, x], [y, -x]] {
                    let step = 1e-6 * plate.grid.finest(at);
                    let beside = [at[0] + step * inward[0], at[1] + step * inward[1]];
                    if specimen.contains(beside) {
                        push_force(forces, plate, beside, across(stress, inward).map(|t| t * area))?;
                    }
                }
            }
        }
    }
    Ok(())
}

/// Spring of a pinned unknown over E', m; what it is does not matter.
const PIN: f64 = 1e-3;

fn penalty(specimen: &Specimen, plate: &Discretisation, at: Point) -> f64 {
    PENALTY * plate.elasticity().plane_modulus * specimen.thickness / plate.grid.finest(at)
}

/// A stretch of the outline that is held down to a depth, as parallel stretches as close as the points of one.
fn layers(plate: &Discretisation, [from, to]: [Point; 2], depth: f64) -> Vec<[Point; 2]> {
    let spacing = plate.grid.finest(along(from, to, 0.5));
    let count = (HELD_IN_SPACING * depth / spacing).ceil();
    // The outline runs counter-clockwise: the plate lies on its left.
    let [x, y] = direction(from, to);
    let layer = |k: usize| {
        let inward = if k == 0 { 0.0 } else { depth * k as f64 / count };
        [from, to].map(|[a, b]| [a - inward * y, b + inward * x])
    };
    (0..=count as usize).map(layer).collect()
}

/// Middles and lengths of the pieces of a held stretch.
fn pieces(plate: &Discretisation, [from, to]: [Point; 2]) -> Vec<(Point, f64)> {
    let stretch = Stretch::Straight([from, to]);
    let shares = stretch.divided(&plate.grid, 1, 1.0 / HELD_IN_SPACING);
    let length = stretch.length();
    shares.windows(2).map(|pair| (stretch.at(0.5 * (pair[0] + pair[1])), (pair[1] - pair[0]) * length)).collect()
}

/// Unknowns that move a point, ascending, with the displacement that a unit of each gives it.
pub(super) fn motions(plate: &Discretisation, at: Point) -> Result<Vec<(u32, Point)>> {
    let (leaf, mut local) = (plate.grid.leaf(at), Local::default());
    if !plate.at(leaf, at, &mut local) {
        return Err(singular(at, plate.reach(leaf)));
    }
    let mut motions = Vec::with_capacity(2 * local.values.len());
    for value in &local.values {
        let first = plate.first[value.node as usize];
        motions.extend([(first, [value.value, 0.0]), (first + 1, [0.0, value.value])]);
        for (k, &tip) in plate.enriched[value.node as usize].iter().enumerate() {
            let Some(fields) = &local.fields[tip as usize] else { continue };
            for (mode, (field, _)) in fields.iter().enumerate() {
                motions.push((first + 2 + 2 * k as u32 + mode as u32, field.map(|u| value.value * u)));
            }
        }
    }
    motions.sort_unstable_by_key(|motion| motion.0);
    Ok(motions)
}
