//! Rigid motion of a floating plate: it costs no energy, so an iteration must not go along it.
//!
//! A preconditioner that is not exact for rigid motion (lattices turned against the edges) lets it grow from round-off until
//! it drowns the curvature of the search direction.

use super::field::Layout;
use crate::body::Body;
use crate::state::Bonds;

/// The rigid motions of the points that carry.
pub struct RigidMotion {
    layout: Layout,
    places: Vec<u32>,
    /// Mean column and row.
    centre: [f64; 2],
    /// Square of the rotation about the centre, in spacings; infinite where it costs energy.
    inertia: f64,
    /// Which shifts are free, 1 or 0.
    shifts: [f64; 2],
}

impl RigidMotion {
    /// Rigid motions of a body along which nothing holds it, with its present bonds; `None` where it is held altogether.
    #[must_use]
    pub fn of(body: &Body, bonds: &Bonds, layout: Layout) -> Option<Self> {
        let free = body.free_motion();
        if free == [false; 3] {
            return None;
        }
        let places: Vec<u32> = body.points.iter().copied().filter(|&p| bonds.intact_at(body, p as usize) > 0).collect();
        let seats = || places.iter().map(|&place| seat(&layout, place));
        let mean = |axis: usize| seats().map(|seat| seat[axis]).sum::<f64>() / places.len() as f64;
        let centre = [mean(0), mean(1)];
        let own = if layout.unknowns == 3 { 1.0 } else { 0.0 };
        let square = |seat: [f64; 2]| (seat[0] - centre[0]).powi(2) + (seat[1] - centre[1]).powi(2) + own;
        let inertia = if free[2] { seats().map(square).sum() } else { f64::INFINITY };
        let shifts = [0, 1].map(|axis| if free[axis] { 1.0 } else { 0.0 });
        Some(RigidMotion { layout, places, centre, inertia, shifts })
    }

    /// Takes its rigid motion off a field.
    pub fn take_off(&self, field: &mut [f64]) {
        let stride = self.layout.stride;
        let (mut shift, mut turn) = ([0.0; 2], 0.0);
        for &place in &self.places {
            let at = self.layout.index(place as usize);
            let [x, y] = self.arm(place);
            let (u, v) = (field[at], field[at + stride]);
            shift = [shift[0] + u, shift[1] + v];
            turn += x * v - y * u;
            if self.layout.unknowns == 3 {
                turn += field[at + 2 * stride];
            }
        }
        let shift = [0, 1].map(|axis| self.shifts[axis] * shift[axis] / self.places.len() as f64);
        let turn = turn / self.inertia;
        for &place in &self.places {
            let at = self.layout.index(place as usize);
            let [x, y] = self.arm(place);
            field[at] -= shift[0] - turn * y;
            field[at + stride] -= shift[1] + turn * x;
            if self.layout.unknowns == 3 {
                field[at + 2 * stride] -= turn;
            }
        }
    }

    /// Column and row of a place from the centre.
    fn arm(&self, place: u32) -> [f64; 2] {
        let seat = seat(&self.layout, place);
        [seat[0] - self.centre[0], seat[1] - self.centre[1]]
    }
}

/// Column and row of a place in memory.
fn seat(layout: &Layout, place: u32) -> [f64; 2] {
    let place = place as usize;
    [(place % layout.stride) as f64, (place / layout.stride) as f64]
}
