//! Springs between the flanks of a crack that are in contact, and pressure between flanks.
//!
//! A spring acts on one sum of displacements, the gap `g = Σ w_i·u_i` between the flanks at a place of the crack, with energy
//! `½ k g² - F g`: a penalty without friction, since w is normal to the crack, and a force that opens.

use super::field::Layout;

/// A spring on a gap.
#[derive(Debug, Clone, PartialEq)]
pub struct GapSpring {
    /// Places with their weights on both displacements (lattice axes).
    pub weights: Vec<(u32, [f64; 2])>,
    /// k, N/m.
    pub stiffness: f64,
    /// F, N.
    pub force: f64,
}

impl GapSpring {
    /// The gap in a displacement, m.
    pub fn gap(&self, layout: &Layout, displacement: &[f64]) -> f64 {
        let of_place = |&(place, [x, y]): &(u32, [f64; 2])| {
            let at = layout.index(place as usize);
            x * displacement[at] + y * displacement[at + layout.stride]
        };
        self.weights.iter().map(of_place).sum()
    }

    /// y += sign × k w g.
    pub(super) fn add_force(&self, layout: &Layout, sign: f64, displacement: &[f64], y: &mut [f64]) {
        self.add(layout, sign * self.stiffness * self.gap(layout, displacement), y);
    }

    /// f += F w.
    pub(super) fn add_load(&self, layout: &Layout, f: &mut [f64]) {
        self.add(layout, self.force, f);
    }

    fn add(&self, layout: &Layout, force: f64, y: &mut [f64]) {
        for &(place, weights) in &self.weights {
            let at = layout.index(place as usize);
            y[at] += force * weights[0];
            y[at + layout.stride] += force * weights[1];
        }
    }
}
