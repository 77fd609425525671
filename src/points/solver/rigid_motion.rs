//! Rigid motion of a floating plate: it costs no energy, so an iteration must not go along it.
//!
//! A preconditioner that is not exact for rigid motion (lattices turned against the edges, round-off of single precision) lets
//! it grow until it drowns the curvature of the search direction. A factorisation holds the plate at two points instead, and its
//! solution is turned back: K off a ring, a sum over points, feels a rigid turn by some 1e-5.

use nalgebra::convert;
use rayon::prelude::*;

use super::field::{Layout, Real, lane_sum};
use crate::body::Body;
use crate::body::lattice::LANES;
use crate::state::Bonds;

/// The rigid motions of the points that carry.
pub struct RigidMotion {
    layout: Layout,
    /// 1 where a place holds a point that carries, else 0, and that times its way from the centre in columns.
    carries: Vec<f64>,
    arms: Vec<f64>,
    count: f64,
    /// Mean column and row.
    centre: [f64; 2],
    /// Square of the rotation about the centre, in spacings; infinite where it costs energy.
    inertia: f64,
    /// Which shifts are free, 1 or 0.
    shifts: [f64; 2],
}

impl RigidMotion {
    /// Rigid motions of a body along which nothing holds it, with its present bonds; `None` where it is held altogether.
    pub fn of(body: &Body, bonds: &Bonds, layout: Layout) -> Option<Self> {
        let free = body.free_motion();
        if free == [false; 3] {
            return None;
        }
        let mut carries = vec![0.0; layout.rows * layout.stride];
        let rows = layout.rows_per_task();
        carries.par_iter_mut().with_min_len(rows * layout.stride).enumerate().for_each(|(place, carries)| {
            // Away from cracks and the rim there is no need to count bonds.
            let is_inside = |place: usize| {
                let (column, row) = body.lattice.column_row(place);
                bonds.chunk_is_regular(row, column / LANES)
            };
            if body.is_point[place] && (is_inside(place) || bonds.intact_at(body, place) > 0) {
                *carries = 1.0;
            }
        });
        let shifts = [0, 1].map(|axis| if free[axis] { 1.0 } else { 0.0 });
        let arms = Vec::new();
        let mut motion = RigidMotion { layout, carries, arms, count: 0.0, centre: [0.0; 2], inertia: f64::INFINITY, shifts };
        let [count, x, y] = motion.sum(|seat| [1.0, seat[0], seat[1]]);
        (motion.count, motion.centre) = (count, [x / count, y / count]);
        let away = |(place, carries): (usize, &f64)| carries * ((place % layout.stride) as f64 - motion.centre[0]);
        motion.arms = motion.carries.iter().enumerate().map(away).collect();
        if free[2] {
            let own = if layout.unknowns == 3 { 1.0 } else { 0.0 };
            [motion.inertia, ..] = motion.sum(|[x, y]| [x * x + y * y + own, 0.0, 0.0]);
        }
        Some(motion)
    }

    /// Takes its rigid motion off a field.
    pub fn take_off<T: Real + Into<f64>>(&self, field: &mut [T]) {
        let (stride, has_turns) = (self.layout.stride, self.layout.unknowns == 3);
        let (row_len, least) = (self.layout.row_len(), self.layout.rows_per_task());
        let rows = field.par_chunks_exact(row_len).zip(self.carries.par_chunks_exact(stride)).with_min_len(least).enumerate();
        let of_row = |(row, (values, carries)): (usize, (&[T], &[f64]))| {
            let [u, v] = [0, 1].map(|c| lane_sum(carries, &values[c * stride..(c + 1) * stride]));
            let own = if has_turns { lane_sum(carries, &values[2 * stride..]) } else { 0.0 };
            let arm = lane_sum(&self.arms[row * stride..(row + 1) * stride], &values[stride..2 * stride]);
            [u, v, arm - (row as f64 - self.centre[1]) * u + own]
        };
        let [u, v, turn] = total(rows.map(of_row).collect());
        let shift = [self.shifts[0] * u / self.count, self.shifts[1] * v / self.count];
        let turn = turn / self.inertia;
        field.par_chunks_exact_mut(row_len).zip(self.carries.par_chunks(stride)).with_min_len(least).enumerate().for_each(
            |(row, (values, carries))| {
                let y = row as f64 - self.centre[1];
                for (column, &carries) in carries.iter().enumerate() {
                    let x = column as f64 - self.centre[0];
                    values[column] -= convert::<f64, T>(carries * (shift[0] - turn * y));
                    values[column + stride] -= convert::<f64, T>(carries * (shift[1] + turn * x));
                    if has_turns {
                        values[column + 2 * stride] -= convert::<f64, T>(carries * turn);
                    }
                }
            },
        );
    }

    /// Sum over the points that carry, row by row in a fixed order, of a function of the way from the centre in columns and rows.
    fn sum(&self, of: impl Fn([f64; 2]) -> [f64; 3] + Sync) -> [f64; 3] {
        let row_sum = |(row, carries): (usize, &[f64])| {
            let y = row as f64 - self.centre[1];
            let carrying = carries.iter().enumerate().filter(|(_, carries)| **carries > 0.0);
            total(carrying.map(|(column, _)| of([column as f64 - self.centre[0], y])).collect())
        };
        let rows = self.carries.par_chunks(self.layout.stride).with_min_len(self.layout.rows_per_task());
        total(rows.enumerate().map(row_sum).collect())
    }
}

fn total(all: Vec<[f64; 3]>) -> [f64; 3] {
    all.iter().fold([0.0; 3], |sum, add| [0, 1, 2].map(|i| sum[i] + add[i]))
}
