//! Classical surface correction on points of any arrangement.

use rayon::prelude::*;

use crate::body::lattice::Lattice;
use crate::levels::Net;

/// Energy factors of Madenci and Oterkus (2014, Peridynamic Theory and Its Applications, ch. 4 and 7) on a net.
///
/// Under uniaxial strain e along the rows or columns of the lattice a point stores `W_d(x)` in the bonds of its own horizon (half of a bond of both ends,
/// all of the half micromodulus of a bond of its own) instead of `W = C₁₁ e² V/2`; `g_d = W / W_d`. A bond with unit vector n
/// gets the factor `[(n_x/G_x)² + (n_y/G_y)²]^(-1/2)`; G is the mean of both ends for a bond of both, as on a lattice, and the
/// owner's own g for a bond in the owner's horizon alone: that bond is part of the owner's integral and of no other. The
/// factors so serve two ends at once: cut-off horizons at a rim, and sums over cells of two sizes where levels meet.
/// Computed once, on the uncracked plate. `c11` is that of the material that the springs stand for, Pa.
pub fn volume_and_surface(net: &mut Net, lattice: &Lattice, c11: f64) {
    let one_sided = if net.owner_only { 0.5 } else { 1.0 };
    let gains: Vec<[f64; 2]> = (0..net.len())
        .into_par_iter()
        .map(|i| {
            let mut energy = [0.0; 2];
            for (b, _) in net.family_of(i) {
                let bond = &net.bonds[b];
                let [nx, ny] = lattice.to_axes(bond.normal);
                let share = if b < net.mutual { 0.5 } else { one_sided };
                let square = 0.5 * share * bond.length * bond.length;
                for (axis, n) in energy.iter_mut().zip([nx, ny]) {
                    *axis += square * (bond.k_n * n.powi(4) + bond.k_t * nx * nx * ny * ny);
                }
            }
            let exact = 0.5 * c11 * net.volumes[i];
            energy.map(|w| if w > 0.0 { exact / w } else { 1.0 })
        })
        .collect();
    for (b, bond) in net.bonds.iter_mut().enumerate() {
        let (own, other) = (gains[bond.from as usize], gains[bond.to as usize]);
        let gain = |axis: usize| if b < net.mutual { 0.5 * (own[axis] + other[axis]) } else { own[axis] };
        let [nx, ny] = lattice.to_axes(bond.normal);
        let factor = ((nx / gain(0)).powi(2) + (ny / gain(1)).powi(2)).powf(-0.5);
        bond.k_n *= factor;
        bond.k_t *= factor;
    }
}
