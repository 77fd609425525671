//! C and m of a fit to K of the tip's own field as A and p of bonds, which are what they stand for ([`ParisLaw::to_bonds`]).

use super::fit::Fit;
use super::search::Constants;
use crate::case::Case;
use crate::error::Result;
use crate::fatigue::paris::ParisLaw;
use crate::fatigue::rate_constant::{rate_constant, rate_constant_slope};
use crate::units::MPA_SQRT_M;

/// A fit of C and m on a plate of this horizon, m, as one of A and p, with the rate constant that ties them.
pub fn in_terms_of_bonds(fit: &mut Fit, case: &Case, horizon: f64) -> Result<()> {
    let (kernel, modulus) = (case.model.bond_law.kernel, case.material.plane_modulus());
    let p = fit.record.constants.p;
    let bonds = |Constants { a, p }: Constants| -> Result<Constants> {
        let law = ParisLaw { c: a, m: p }.to_bonds(rate_constant(kernel, p)?, modulus, horizon);
        Ok(Constants { a: law.a, p: law.p })
    };
    // ln A = ln C + g(m): its slope over m turns the covariance of (ln C, m) into that of (ln A, p).
    let slope = -rate_constant_slope(kernel, p)? - (MPA_SQRT_M / (modulus * horizon.sqrt())).ln();
    let [[c_c, c_m], [_, m_m]] = fit.confidence.covariance;
    let a_p = c_m + slope * m_m;
    fit.confidence.covariance = [[c_c + 2.0 * slope * c_m + slope * slope * m_m, a_p], [a_p, m_m]];
    for curve in fit.specimens.iter_mut().chain([&mut fit.record]) {
        curve.constants = bonds(curve.constants)?;
    }
    (fit.rate_constant, fit.horizon) = (Some(rate_constant(kernel, p)?), horizon);
    Ok(())
}
