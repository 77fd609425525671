//! Loads and supports of a specimen as forces on points, points held, and grips.

use super::lattice::Lattice;
use super::sharing::Sharing;
use crate::bond_law::stencil::Stencil;
use perilife_base::error::{Error, Result};
use perilife_plate::loading::pieces::{load_pieces, outward};
use perilife_plate::specimen::facets::{Facet, PER_SPACING, straight};
use perilife_plate::specimen::geometry::{bounding_box, distance_to_segment};
use perilife_plate::specimen::{Point, Specimen, Support};

/// Stiffness of rigid grips over that of the plate.
const GRIP_STIFFNESS: f32 = 1000.0;

/// A sum of displacements `Σ w·u`, such as that of a piece of an edge, that is held.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// Places with their weights on both displacements (lattice axes).
    pub weights: Vec<(u32, Point)>,
    /// Where it is held, over the displacement of the load.
    pub way: f64,
}

/// Forces on points at unit nominal load, held components and grips.
#[derive(Debug, Clone, Default)]
pub struct Boundary {
    /// Loaded places with their force (lattice axes) at unit nominal load, N.
    pub forces: Vec<(u32, [f64; 2])>,
    /// Places with a couple on their rotation (force per rotation times spacing) at unit nominal load, N.
    pub couples: Vec<(u32, f64)>,
    /// Places nearest to where the loads act.
    loaded: Vec<u32>,
    /// Places at the corners of a plate on whose cracks alone a load acts, and at tied supports, ascending: cracks that part two of
    /// them part the plate.
    pub corners: Vec<u32>,
    /// Force of the grips at unit nominal load, N.
    pub through: f64,
    /// Pieces of edges that are moved straight, or held beside such an edge.
    pub ties: Vec<Tie>,
    /// Held places with what is held: the components in lattice axes, and the rotation.
    pub fixed: Vec<(u32, [bool; 3])>,
    /// Clamped grips: places of the end blocks with the displacement along y, in units of half the relative displacement.
    pub clamped: Vec<(u32, f64)>,
    /// Rigid grips that may turn: places of the end blocks.
    pub rigid: Vec<u32>,
    /// Whether nothing holds the plate, so that its loads must balance.
    pub floating: bool,
}

impl Boundary {
    /// Loads and supports of a specimen on its lattice.
    pub(super) fn of(
        specimen: &Specimen,
        lattice: &Lattice,
        stencil: &Stencil,
        sharing: &Sharing,
        points: &[u32],
    ) -> Result<Boundary> {
        let mut boundary = Boundary { floating: true, ..Boundary::default() };
        let moved = specimen.moved_section();
        for support in &specimen.supports {
            match *support {
                Support::Moved { from, to, direction: [x, y], way, held } => {
                    boundary.floating = false;
                    boundary.tie(specimen, lattice, sharing, [from, to], ([x, y], way));
                    if held {
                        boundary.tie(specimen, lattice, sharing, [from, to], ([-y, x], 0.0));
                    }
                }
                // The way from it to an edge that is moved counts: it is held where it is, not half a spacing inside.
                Support::Fixed { from, to, depth: 0.0, x, y } if moved.is_some() => {
                    for (axis, _) in [([1.0, 0.0], x), ([0.0, 1.0], y)].iter().filter(|(_, is_held)| *is_held) {
                        boundary.tie(specimen, lattice, sharing, [from, to], (*axis, 0.0));
                    }
                }
                Support::Fixed { from, to, depth, x, y } => {
                    boundary.floating = false;
                    let away = |p: u32| distance_to_segment(lattice.position(p as usize), from, to);
                    // At least the nearest row: it lies up to a whole spacing inside where a crack fixes the rows.
                    let nearest = points.iter().map(|&p| away(p)).fold(f64::INFINITY, f64::min);
                    let depth = depth.max(0.75 * lattice.spacing).max(nearest + 0.25 * lattice.spacing);
                    let near = points.iter().filter(|&&p| away(p) < depth);
                    boundary.fixed.extend(near.map(|&p| (p, held(lattice, x, y))));
                }
                Support::ClampedEnds => {
                    boundary.floating = false;
                    boundary.clamped = end_blocks(specimen, lattice, points, stencil.horizon).collect();
                }
                Support::Elsewhere => boundary.floating = false,
                Support::RigidEnds => {
                    boundary.rigid = end_blocks(specimen, lattice, points, stencil.horizon).map(|(p, _)| p).collect()
                }
            }
        }
        boundary.fixed.extend(points.first().zip(sliding(specimen)).map(|(&p, axis)| {
            let [x, y] = lattice.to_axes(axis).map(f64::abs);
            (p, [x >= y, y > x, false])
        }));
        let mut force = std::collections::BTreeMap::<u32, Point>::new();
        for load in load_pieces(specimen, lattice.spacing) {
            let at = load.facet.at;
            let nearest = sharing.nearest_point(at).ok_or_else(|| {
                Error::Mechanics(format!(
                    "no point of the plate near the load at x = {:.3} mm, y = {:.3} mm; reduce the spacing",
                    at[0] * 1e3,
                    at[1] * 1e3
                ))
            })?;
            boundary.loaded.push(nearest);
            boundary.through += 0.5 * load.force[1].abs();
            let whole = lattice.to_axes(load.force);
            for (place, share) in sharing.of(&load.facet) {
                let sum = force.entry(place).or_default();
                *sum = [sum[0] + share * whole[0], sum[1] + share * whole[1]];
            }
        }
        boundary.through = moved.unwrap_or(boundary.through);
        if specimen.loads.is_empty() && specimen.crack_pressure > 0.0 {
            boundary.corners = specimen.outline.iter().filter_map(|&corner| sharing.nearest_point(corner)).collect();
        }
        boundary.corners.sort_unstable();
        boundary.corners.dedup();
        boundary.loaded.sort_unstable();
        boundary.loaded.dedup();
        boundary.forces = force.into_iter().collect();
        Ok(boundary)
    }

    /// Holds a stretch of an edge in its component along a direction, at a way over the displacement of the load: spacing by spacing the
    /// mean of the rim there, by the shares that tractions have.
    fn tie(&mut self, specimen: &Specimen, lattice: &Lattice, sharing: &Sharing, [from, to]: [Point; 2], held: (Point, f64)) {
        let axis = lattice.to_axes(held.0);
        let facets: Vec<Facet> =
            straight(from, to, lattice.spacing).map(|facet| outward(specimen, facet, lattice.spacing)).collect();
        for piece in facets.chunks(PER_SPACING as usize) {
            let mut shares = std::collections::BTreeMap::<u32, f64>::new();
            for (place, share) in piece.iter().flat_map(|facet| sharing.of(facet)) {
                *shares.entry(place).or_default() += share / piece.len() as f64;
            }
            let nearest: Vec<u32> = piece.iter().filter_map(|facet| sharing.nearest_point(facet.at)).collect();
            self.loaded.extend(&nearest);
            self.corners.extend(&nearest);
            let weights = shares.into_iter().map(|(place, share)| (place, axis.map(|a| share * a))).collect();
            self.ties.push(Tie { weights, way: held.1 });
        }
    }

    /// Removes the small resultant that sharing out the loads to points has left on a floating plate: the loaded points
    /// take the smallest change of forces (least squares) after which force and moment vanish.
    /// Errors: loads far out of balance on a plate that nothing holds.
    pub(super) fn balance(&mut self, lattice: &Lattice) -> Result<()> {
        if !self.floating {
            return Ok(());
        }
        let seat = |&(place, force): &(u32, Point)| {
            let (column, row) = lattice.column_row(place as usize);
            ([column as f64, row as f64], force)
        };
        let mut seated: Vec<(Point, Point)> = self.forces.iter().map(seat).collect();
        balance(&mut seated, self.couples.iter().map(|c| c.1).sum())?;
        self.forces.iter_mut().zip(seated).for_each(|(force, (_, balanced))| force.1 = balanced);
        Ok(())
    }

    /// Loads and supports of a part of a symmetric plate, `place` giving the part's place of one of the plate's. Points on a line
    /// of symmetry (with its axis) take half of their loads, and neither cross it nor turn.
    pub(super) fn of_part(&self, on_line: &[(u32, usize)], place: impl Fn(usize) -> Option<usize>) -> Boundary {
        let here = |p: &u32| place(*p as usize).map(|p| p as u32);
        let share = |p: u32| 0.5_f64.powi(on_line.iter().filter(|(other, _)| *other == p).count() as i32);
        let mut fixed: Vec<(u32, [bool; 3])> = self.fixed.iter().filter_map(|(p, held)| Some((here(p)?, *held))).collect();
        fixed.extend(on_line.iter().map(|&(p, axis)| (p, [axis == 0, axis == 1, true])));
        let forces = self.forces.iter().filter_map(|(p, f)| here(p).map(|p| (p, f.map(|f| share(p) * f))));
        Boundary {
            forces: forces.collect(),
            couples: self.couples.iter().filter_map(|(p, c)| here(p).map(|p| (p, share(p) * c))).collect(),
            loaded: self.loaded.iter().filter_map(here).collect(),
            corners: self.corners.iter().filter_map(here).collect(),
            through: self.through,
            ties: Vec::new(),
            fixed,
            clamped: self.clamped.iter().filter_map(|(p, side)| Some((here(p)?, *side))).collect(),
            rigid: self.rigid.iter().filter_map(here).collect(),
            floating: self.floating,
        }
    }

    /// Places within one horizon of a loaded or held place.
    pub fn no_fail(&self, lattice: &Lattice, horizon: f64) -> Vec<bool> {
        let mut no_fail = vec![false; lattice.places()];
        let reach = (horizon / lattice.spacing).floor() as i32;
        let held = self.fixed.iter().map(|f| f.0).chain(self.clamped.iter().map(|c| c.0)).chain(self.rigid.iter().copied());
        for place in self.loaded.iter().copied().chain(held) {
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    if f64::from(dx * dx + dy * dy).sqrt() * lattice.spacing <= horizon {
                        no_fail[(place as usize).wrapping_add_signed(lattice.step(dx, dy))] = true;
                    }
                }
            }
        }
        no_fail
    }

    /// Makes the bonds inside rigid grips much stiffer than the plate.
    pub(super) fn stiffen_grips(&self, lattice: &Lattice, steps: &[isize], multiplier: &mut [f32]) {
        let places = lattice.places();
        let mut grip = vec![0_i8; places];
        for &place in &self.rigid {
            // The two blocks are told apart so that a very short plate does not weld them together.
            grip[place as usize] = if lattice.column_row(place as usize).1 * 2 < lattice.rows { -1 } else { 1 };
        }
        for &place in &self.rigid {
            for (k, &step) in steps.iter().enumerate() {
                if grip[(place as usize).wrapping_add_signed(step)] == grip[place as usize] {
                    multiplier[k * places + place as usize] *= GRIP_STIFFNESS;
                }
            }
        }
    }
}

/// Changes forces on seats by the smallest amounts (least squares) after which their resultant and their moment, that of couples
/// included, vanish.
/// Errors: forces far out of balance.
pub fn balance(seated: &mut [(Point, Point)], couples: f64) -> Result<()> {
    let scale: f64 = seated.iter().map(|(_, f)| f[0].abs() + f[1].abs()).sum();
    if scale == 0.0 {
        return Ok(());
    }
    let count = seated.len() as f64;
    let mean = seated.iter().fold([0.0; 2], |m, (seat, _)| [m[0] + seat[0] / count, m[1] + seat[1] / count]);
    let arm = |seat: Point| [seat[0] - mean[0], seat[1] - mean[1]];
    let (mut resultant, mut moment, mut inertia) = ([0.0; 2], couples, 0.0);
    for &(seat, f) in seated.iter() {
        let r = arm(seat);
        resultant = [resultant[0] + f[0], resultant[1] + f[1]];
        moment += r[0] * f[1] - r[1] * f[0];
        inertia += r[0] * r[0] + r[1] * r[1];
    }
    let lever = (inertia / count).sqrt();
    if resultant[0].hypot(resultant[1]) > 0.02 * scale || moment.abs() > 0.02 * scale * lever {
        return Err(Error::Mechanics(
            "the loads are not in equilibrium and there are no supports; add [supports] or balance the loads".to_owned(),
        ));
    }
    for (seat, f) in seated.iter_mut() {
        let r = arm(*seat);
        f[0] -= resultant[0] / count - moment / inertia * r[1];
        f[1] -= resultant[1] / count + moment / inertia * r[0];
    }
    Ok(())
}

/// Components of the lattice axes that are held when plate components are; a turned lattice holds both.
fn held(lattice: &Lattice, x: bool, y: bool) -> [bool; 3] {
    if lattice.axis[1] == 0.0 { [x, y, false] } else { [x || y, x || y, false] }
}

/// Direction in which nothing holds a plate whose sides are moved straight: across their motion where they slide in their grips.
fn sliding(specimen: &Specimen) -> Option<Point> {
    let mut moved = specimen.supports.iter().filter_map(|support| match *support {
        Support::Moved { direction: [x, y], held: false, .. } => Some([-y, x]),
        _ => None,
    });
    let [x, y] = moved.next()?;
    let holds = |support: &Support| match *support {
        Support::Fixed { x: holds_x, y: holds_y, .. } => (holds_x && x.abs() > 1e-9) || (holds_y && y.abs() > 1e-9),
        Support::Moved { direction, .. } => (direction[0] * x + direction[1] * y).abs() > 1e-9,
        _ => false,
    };
    (!specimen.supports.iter().any(holds)).then_some([x, y])
}

/// Points within one horizon of the lower (-1) and upper (+1) end of the specimen.
fn end_blocks<'a>(
    specimen: &Specimen,
    lattice: &'a Lattice,
    points: &'a [u32],
    horizon: f64,
) -> impl Iterator<Item = (u32, f64)> + 'a {
    let [low, high] = bounding_box(&specimen.outline);
    points.iter().filter_map(move |&p| {
        let y = lattice.position(p as usize)[1];
        if y < low[1] + horizon {
            Some((p, -1.0))
        } else if y > high[1] - horizon {
            Some((p, 1.0))
        } else {
            None
        }
    })
}
