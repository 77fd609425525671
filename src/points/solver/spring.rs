//! Springs: those of bonds as blocks and terms of the stiffness, those between the flanks of a crack that are in contact, and pressure
//! between flanks.
//!
//! A spring between flanks acts on one sum of displacements, the gap `g = Σ w_i·u_i` at a place of the crack, with energy
//! `½ k g² - F g`: a penalty without friction, since w is normal to the crack, and a force that opens.

use super::field::Layout;
use crate::bond_law::stencil::StencilBond;

/// Block of a point with itself and with the other end of a bond.
pub type Blocks<const M: usize> = ([[f64; M]; M], [[f64; M]; M]);

impl StencilBond {
    /// Blocks of its stiffness with N unknowns a point: of the owner (`sign` +1) or the other end (-1) with itself and with the opposite
    /// end.
    pub(super) fn blocks<const N: usize>(&self, sign: f64) -> Blocks<N> {
        let (n, t) = (self.normal, self.tangent());
        let (mut own, mut off) = ([[0.0; N]; N], [[0.0; N]; N]);
        for i in 0..2 {
            for j in 0..2 {
                let a = self.k_n * n[i] * n[j] + self.k_t * t[i] * t[j];
                own[i][j] = a;
                off[i][j] = -a;
            }
        }
        if N == 3 {
            let couple = self.k_t * self.lever;
            for i in 0..2 {
                let c = sign * couple * t[i];
                // ∂²/∂u_i∂θ_i = ∂²/∂u_i∂θ_j = +c at the owner, -c at the other end.
                own[i][2] = c;
                own[2][i] = c;
                off[i][2] = c;
                off[2][i] = -c;
            }
            own[2][2] = couple * self.lever;
            off[2][2] = couple * self.lever;
        }
        (own, off)
    }
}

/// End of a bond in a window's vector.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub place: usize,
    /// Index of that place's first unknown.
    pub first: usize,
    pub signs: [f64; 3],
}

impl End {
    /// An entry of a vector for component c of this end.
    pub fn entry(&self, c: usize, value: f64) -> (usize, f64) {
        (self.first + c, self.signs[c] * value)
    }
}

/// One term s w wᵀ of the stiffness that a broken bond takes out.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// s, 1 or -1.
    pub sign: f64,
    /// w: index in the window's vector and value.
    pub vector: Vec<(usize, f64)>,
}

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

    pub(super) fn add(&self, layout: &Layout, force: f64, y: &mut [f64]) {
        for &(place, weights) in &self.weights {
            let at = layout.index(place as usize);
            y[at] += force * weights[0];
            y[at + layout.stride] += force * weights[1];
        }
    }
}
