//! Surface corrections: bonds near a free boundary carry more, since the bonds that the boundary cut off are missing.

use super::Body;
use crate::bond_law::stencil::{StencilBond, plane_stiffness};
use perilife_plate::material::Material;

/// Energy that each end of a bond stores under unit strain along rows and columns: half of the bond's.
fn shares(bond: &StencilBond) -> [f64; 2] {
    let [nx, ny] = bond.normal;
    let square = bond.length * bond.length;
    [nx, ny].map(|n| 0.25 * square * (bond.k_n * n.powi(4) + bond.k_t * nx * nx * ny * ny))
}

/// Rounds a multiplier: round-off in sums must not make interior bonds look irregular.
pub fn settled(multiplier: f64) -> f32 {
    if (multiplier - 1.0).abs() < 1e-9 { 1.0 } else { multiplier as f32 }
}

/// Classical correction (Madenci and Oterkus 2014, Peridynamic Theory and Its Applications, ch. 4 and 7).
///
/// Under uniaxial strain e along direction d (the lattice axes) a point stores W_PD(x) instead of `W = C₁₁ e²/2`;
/// `g_d(x) = W / W_PD(x)`. A bond with unit vector n gets the factor `[(n_x/G_x)² + (n_y/G_y)²]^(-1/2)`,
/// `G_d = (g_d(x) + g_d(x'))/2`. Computed once, on the uncracked plate. C₁₁ is that of the material that the springs stand
/// for; the dilatation of a state-based law is right up to a straight edge without a correction.
///
/// The factor of the interior, which only rescales the micromoduli to the lattice, is moved into the springs of the
/// stencil, so that interior bonds keep the multiplier 1.
pub fn volume_and_surface(body: &mut Body, material: &Material) {
    let places = body.places();
    let c11 = plane_stiffness(material)[0];
    let volume = body.lattice.spacing * body.lattice.spacing * body.thickness;
    let mut energy = [vec![0.0_f64; places], vec![0.0_f64; places]];
    for (k, bond) in body.stencil.bonds.iter().enumerate() {
        let share = shares(bond);
        for place in 0..places {
            if body.multiplier[k * places + place] > 0.0 {
                let other = place.wrapping_add_signed(body.steps[k]);
                for (axis, part) in energy.iter_mut().zip(share) {
                    axis[place] += part;
                    axis[other] += part;
                }
            }
        }
    }
    let exact = 0.5 * c11 * volume;
    // What the sum over the lattice differs from the integral by.
    let interior: f64 = body.stencil.bonds.iter().map(|bond| 2.0 * shares(bond)[0]).sum();
    let inside = exact / interior;
    let gain = energy.map(|axis| axis.into_iter().map(|w| if w > 0.0 { exact / w } else { inside }).collect::<Vec<f64>>());
    for (k, bond) in body.stencil.bonds.iter_mut().enumerate() {
        let [nx, ny] = bond.normal;
        for place in 0..places {
            let multiplier = &mut body.multiplier[k * places + place];
            if *multiplier > 0.0 {
                let other = place.wrapping_add_signed(body.steps[k]);
                let mean = |axis: &[f64]| 0.5 * (axis[place] + axis[other]);
                let factor = ((nx / mean(&gain[0])).powi(2) + (ny / mean(&gain[1])).powi(2)).powf(-0.5) / inside;
                *multiplier = settled(factor);
            }
        }
        bond.k_n *= inside;
        bond.k_t *= inside;
    }
}
