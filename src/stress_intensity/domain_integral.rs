//! Interaction integral over a ring around the tip.
//!
//! With an auxiliary near-tip field of one pure mode (Yau, Wang and Corten 1980, J. Appl. Mech. 47:335; domain form Shih,
//! Moran and Nakamura 1986, Int. J. Fract. 30:79)
//!
//! `M = ∫ (σ_ij u^aux_i,1 + σ^aux_ij u_i,1 - σ_ik ε^aux_ik δ_1j) q_,j dA`, `K = M E'/2` for K^aux = 1,
//!
//! q being 1 inside the ring and 0 outside it. The bonds near the tip, where the displacement of a nonlocal body is not that
//! of a sharp crack, lie inside the ring and take no part.

use super::gradient::gradient_at;
use super::williams::{Eigenfunction, Elasticity, Symmetry, coefficient_of_unit_factor};
use super::{CrackedPlate, Field, TipFrame, too_close};
use crate::error::Result;

/// Outer radius of the ring in horizons, where the plate leaves that room.
const OUTER_HORIZONS: f64 = 6.0;
/// Least outer radius in horizons: below it most of the ring lies in the disturbed core.
const OUTER_HORIZONS_MIN: f64 = 1.5;
/// Inner radius over outer radius.
const INNER_SHARE: f64 = 0.4;

/// K_I and K_II of a tip, Pa√m.
///
/// # Errors
/// No room for a ring between the core of the tip and whatever is next to it.
pub fn factors(plate: &CrackedPlate, field: &Field, tip: usize, frame: &TipFrame) -> Result<[f64; 2]> {
    let horizon = plate.body.horizon();
    let outer = plate.clear_radius(&field.specimen, tip).min(OUTER_HORIZONS * horizon);
    if outer < OUTER_HORIZONS_MIN * horizon {
        return Err(too_close("there is no room for the ring of the domain integral", field.specimen.tips[tip].position));
    }
    let inner = INNER_SHARE * outer;
    let elasticity = Elasticity::of(&plate.case.material);
    let layout = plate.layout();
    let mut sums = [0.0; 2];
    for place in plate.points_around(frame, outer) {
        let (r, theta) = frame.polar(plate.body.lattice.position(place));
        let Some(gradient) = (r > inner).then(|| gradient_at(plate, &layout, field, frame, place)).flatten() else { continue };
        // q falls as 1 - 3t² + 2t³ over the ring; its gradient points to the tip.
        let t = (r - inner) / (outer - inner);
        let slope = -6.0 * t * (1.0 - t) / (outer - inner);
        let q = [slope * theta.cos(), slope * theta.sin()];
        for (sum, symmetry) in sums.iter_mut().zip([Symmetry::Opening, Symmetry::Sliding]) {
            let scale = coefficient_of_unit_factor(symmetry) / (2.0 * elasticity.shear_modulus);
            let auxiliary =
                Eigenfunction { order: 1, symmetry }.gradient(elasticity.kappa, r, theta).map(|row| row.map(|g| scale * g));
            *sum += interaction(&elasticity, &gradient, &auxiliary, q);
        }
    }
    let area = plate.body.lattice.spacing.powi(2);
    Ok(sums.map(|sum| 0.5 * elasticity.plane_modulus * area * sum))
}

/// `(σ_ij u^aux_i,1 + σ^aux_ij u_i,1 - σ_ik ε^aux_ik δ_1j) q_,j`.
fn interaction(elasticity: &Elasticity, field: &[[f64; 2]; 2], auxiliary: &[[f64; 2]; 2], q: [f64; 2]) -> f64 {
    let (stress, stress_aux) = (elasticity.stress(field), elasticity.stress(auxiliary));
    let mutual_energy =
        stress[0] * auxiliary[0][0] + stress[1] * auxiliary[1][1] + stress[2] * (auxiliary[0][1] + auxiliary[1][0]);
    let flow = |s: [f64; 3], h: &[[f64; 2]; 2]| [s[0] * h[0][0] + s[2] * h[1][0], s[2] * h[0][0] + s[1] * h[1][0]];
    let (a, b) = (flow(stress, auxiliary), flow(stress_aux, field));
    (a[0] + b[0] - mutual_energy) * q[0] + (a[1] + b[1]) * q[1]
}
