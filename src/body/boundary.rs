//! Loads and supports of a specimen as forces on points, points held, and grips.

use super::lattice::Lattice;
use crate::bond_law::stencil::Stencil;
use crate::error::{Error, Result};
use crate::specimen::geometry::{along, bounding_box, distance, distance_to_segment};
use crate::specimen::{Load, Point, Specimen, Support};

/// Stiffness of rigid grips over that of the plate.
const GRIP_STIFFNESS: f32 = 1000.0;
/// Samples per spacing when a boundary load is shared out to points; even, so that a sample never falls between two points.
const SAMPLES: f64 = 8.0;

/// Forces on points at unit nominal load, held components and grips.
#[derive(Debug, Clone, Default)]
pub struct Boundary {
    /// Loaded places with their force (lattice axes) at unit nominal load, N.
    pub forces: Vec<(u32, [f64; 2])>,
    /// Held places with the components held, in lattice axes.
    pub fixed: Vec<(u32, [bool; 2])>,
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
        is_point: &[bool],
        points: &[u32],
    ) -> Result<Boundary> {
        let mut boundary = Boundary { floating: true, ..Boundary::default() };
        for support in &specimen.supports {
            match *support {
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
                Support::RigidEnds => {
                    boundary.rigid = end_blocks(specimen, lattice, points, stencil.horizon).map(|(p, _)| p).collect()
                }
            }
        }
        let mut force = std::collections::BTreeMap::<u32, Point>::new();
        let mut add = |position: Point, share: Point| -> Result<()> {
            let place = nearest_point(lattice, is_point, position).ok_or_else(|| {
                Error::Mechanics(format!(
                    "no point of the plate lies near the load at x = {:.3} mm, y = {:.3} mm; give a smaller spacing",
                    position[0] * 1e3,
                    position[1] * 1e3
                ))
            })?;
            let share = lattice.to_axes(share);
            let sum = force.entry(place).or_default();
            *sum = [sum[0] + share[0], sum[1] + share[1]];
            Ok(())
        };
        for load in &specimen.loads {
            match *load {
                Load::Edge { from, to, traction } => {
                    let length = distance(from, to);
                    let samples = (length / lattice.spacing).round().max(1.0) * SAMPLES;
                    let area = length / samples * specimen.thickness;
                    for i in 0..samples as usize {
                        let t = (i as f64 + 0.5) / samples;
                        add(along(from, to, t), [traction[0] * area, traction[1] * area])?;
                    }
                }
                Load::Pin { hole, direction, force } => {
                    let hole = specimen.holes[hole];
                    // Bearing pressure p cos θ on the half circle around `direction`; ∫ cos² θ = π/2 makes the resultant `force`.
                    let samples = (hole.radius * std::f64::consts::PI / lattice.spacing).round().max(4.0) * SAMPLES;
                    let step = std::f64::consts::PI / samples;
                    for i in 0..samples as usize {
                        let theta = -0.5 * std::f64::consts::PI + (i as f64 + 0.5) * step;
                        let (sin, cos) = theta.sin_cos();
                        let out = [cos * direction[0] - sin * direction[1], cos * direction[1] + sin * direction[0]];
                        let pressure = force * cos * step / (0.5 * std::f64::consts::PI);
                        add(
                            [hole.centre[0] + hole.radius * out[0], hole.centre[1] + hole.radius * out[1]],
                            [pressure * out[0], pressure * out[1]],
                        )?;
                    }
                }
            }
        }
        boundary.forces = force.into_iter().collect();
        if boundary.floating {
            boundary.balance(lattice)?;
        }
        Ok(boundary)
    }

    /// Removes the small resultant that sharing out the loads to points has left on a floating plate: the loaded points
    /// take the smallest change of forces (least squares) after which force and moment vanish.
    fn balance(&mut self, lattice: &Lattice) -> Result<()> {
        let scale: f64 = self.forces.iter().map(|(_, f)| f[0].abs() + f[1].abs()).sum();
        if scale == 0.0 {
            return Ok(());
        }
        let seat = |place: u32| {
            let (column, row) = lattice.column_row(place as usize);
            [column as f64, row as f64]
        };
        let count = self.forces.len() as f64;
        let mean = self.forces.iter().fold([0.0; 2], |m, &(p, _)| [m[0] + seat(p)[0] / count, m[1] + seat(p)[1] / count]);
        let arm = |p: u32| [seat(p)[0] - mean[0], seat(p)[1] - mean[1]];
        let (mut resultant, mut moment, mut inertia) = ([0.0; 2], 0.0, 0.0);
        for &(p, f) in &self.forces {
            let r = arm(p);
            resultant = [resultant[0] + f[0], resultant[1] + f[1]];
            moment += r[0] * f[1] - r[1] * f[0];
            inertia += r[0] * r[0] + r[1] * r[1];
        }
        let lever = (inertia / count).sqrt();
        if resultant[0].hypot(resultant[1]) > 0.02 * scale || moment.abs() > 0.02 * scale * lever {
            return Err(Error::Mechanics(
                "the loads are not in equilibrium and nothing holds the plate; give [supports] or loads that balance".to_owned(),
            ));
        }
        for (p, f) in &mut self.forces {
            let r = arm(*p);
            f[0] -= resultant[0] / count - moment / inertia * r[1];
            f[1] -= resultant[1] / count + moment / inertia * r[0];
        }
        Ok(())
    }

    /// Force that the plate carries from end to end along y at unit nominal load, N.
    #[must_use]
    pub fn force_through(&self) -> f64 {
        0.5 * self.forces.iter().map(|(_, f)| f[1].abs()).sum::<f64>()
    }

    /// Places within one horizon of a loaded or held place.
    pub(super) fn no_fail(&self, lattice: &Lattice, horizon: f64) -> Vec<bool> {
        let mut no_fail = vec![false; lattice.places()];
        let reach = (horizon / lattice.spacing).floor() as i32;
        let held = self.fixed.iter().map(|f| f.0).chain(self.clamped.iter().map(|c| c.0)).chain(self.rigid.iter().copied());
        for place in self.forces.iter().map(|f| f.0).chain(held) {
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

/// Components of the lattice axes that are held when plate components are; a turned lattice holds both.
fn held(lattice: &Lattice, x: bool, y: bool) -> [bool; 2] {
    if lattice.axis[1] == 0.0 { [x, y] } else { [x || y; 2] }
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

/// Point nearest to a position, searched within three spacings.
fn nearest_point(lattice: &Lattice, is_point: &[bool], position: Point) -> Option<u32> {
    let [column, row] = lattice.locate(position);
    let mut best: Option<(f64, u32)> = None;
    for r in (row - 3.0).ceil().max(0.0) as usize..=(row + 3.0).floor().clamp(0.0, lattice.rows as f64 - 1.0) as usize {
        for c in
            (column - 3.0).ceil().max(0.0) as usize..=(column + 3.0).floor().clamp(0.0, lattice.columns as f64 - 1.0) as usize
        {
            let place = lattice.place(c, r);
            let away = (c as f64 - column).hypot(r as f64 - row);
            if is_point[place] && best.is_none_or(|(least, _)| away < least - 1e-9) {
                best = Some((away, place as u32));
            }
        }
    }
    best.map(|(_, place)| place)
}
