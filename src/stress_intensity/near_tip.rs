//! Williams series fitted to the displacements around the tip.
//!
//! Opening and sliding of the crack faces go with K_I and K_II as `Δu = 8 K/E' √(r/2π) (1 + ...)`; extrapolating them to the
//! tip uses few points and needs the tip's place. The whole field around the tip holds the same factors in the r^½ terms of
//! its series; least squares over all points of a ring take them from there. The term r^-½ of each mode stands for what the
//! nonlocal core shifts the tip, so that a shift does not pass for a factor.

use nalgebra::{DMatrix, DVector};

use super::gradient::displacement_at;
use super::williams::{Eigenfunction, Elasticity, Symmetry, coefficient_of_unit_factor};
use super::{CrackedPlate, Field, TipFrame, too_close};
use crate::error::Result;

/// Inner and largest outer radius of the ring, in horizons.
const RING_HORIZONS: [f64; 2] = [1.5, 5.0];
/// Largest outer radius as share of the way to what is next: the series converges up to there only.
const NEXT_SHARE: f64 = 0.7;
/// Least outer radius in horizons: a narrower ring cannot tell the terms of the series apart.
const OUTER_HORIZONS_MIN: f64 = 2.5;
/// Orders of the series. With fewer terms a neighbouring crack at twice the ring's radius already passes for K_II.
const ORDERS: std::ops::RangeInclusive<i32> = -1..=8;

/// K_I and K_II of a tip, Pa√m.
///
/// # Errors
/// No room for a ring between the core of the tip and whatever is next to it.
pub fn factors(plate: &CrackedPlate, field: &Field, tip: usize, frame: &TipFrame) -> Result<[f64; 2]> {
    let horizon = plate.body.horizon();
    let clear = plate.clear_radius(&field.specimen, tip);
    let next = clear + horizon;
    let outer = clear.min(RING_HORIZONS[1] * horizon).min((NEXT_SHARE * next).max(OUTER_HORIZONS_MIN * horizon));
    if outer < OUTER_HORIZONS_MIN * horizon {
        return Err(too_close("there is no room for the ring of displacements", field.specimen.tips[tip].position));
    }
    let inner = RING_HORIZONS[0] * horizon;
    let elasticity = Elasticity::of(&plate.case.material);
    let layout = plate.layout();
    let functions: Vec<Eigenfunction> = [Symmetry::Opening, Symmetry::Sliding]
        .into_iter()
        .flat_map(|symmetry| ORDERS.map(move |order| Eigenfunction { order, symmetry }))
        .collect();
    let (mut rows, mut values) = (Vec::new(), Vec::new());
    for place in plate.points_around(frame, outer) {
        let (r, theta) = frame.polar(plate.body.lattice.position(place));
        if r < inner {
            continue;
        }
        let measured = displacement_at(&plate.body, &layout, &field.displacement, frame, place);
        let terms: Vec<[f64; 2]> =
            functions.iter().map(|function| function.displacement(elasticity.kappa, r / outer, theta)).collect();
        for i in 0..2 {
            rows.extend(terms.iter().map(|term| term[i]));
            values.push(measured[i]);
        }
    }
    let matrix = DMatrix::from_row_slice(values.len(), functions.len(), &rows);
    let decomposed = matrix.qr();
    let right = decomposed.q().transpose() * DVector::from_vec(values);
    let Some(coefficients) = decomposed.r().solve_upper_triangular(&right) else {
        return Err(too_close("too few points are left for the displacements", field.specimen.tips[tip].position));
    };
    // r was taken in units of the outer radius: a_n r^½ = a_n √R (r/R)^½.
    let scale = 2.0 * elasticity.shear_modulus / outer.sqrt();
    Ok([Symmetry::Opening, Symmetry::Sliding].map(|symmetry| {
        let at = functions.iter().position(|f| f.order == 1 && f.symmetry == symmetry).unwrap_or(0);
        scale * coefficients[at] / coefficient_of_unit_factor(symmetry)
    }))
}
