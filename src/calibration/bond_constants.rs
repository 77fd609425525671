//! C and m of a fit to K of the tip's own field as A and p of bonds, which are what they stand for ([`ParisLaw::to_bonds`]).

use rayon::prelude::*;

use super::fit::Fit;
use super::search::Constants;
use crate::case::Case;
use crate::error::Result;
use crate::fatigue::STEADY_EXPONENTS;
use crate::fatigue::paris::ParisLaw;
use crate::predict::bond_rate::ReferenceModel;

/// Distance of the exponents between which the rate constant is taken for others, in p.
const P_STEP: f64 = 0.5;

/// A fit of C and m on a plate of this horizon, m, as one of A and p, with the rate constant that ties them.
///
/// # Errors
/// As [`ReferenceModel::rate_constant`].
pub fn in_terms_of_bonds(fit: &mut Fit, case: &Case, horizon: f64) -> Result<()> {
    let modulus = case.material.plane_modulus();
    let p = fit.record.constants.p;
    let constant = RateConstant::around(ReferenceModel::of(&case.model), p)?;
    let bonds = |Constants { a, p }: Constants| {
        let law = ParisLaw { c: a, m: p }.to_bonds(constant.at(p).exp(), modulus, horizon);
        Constants { a: law.a, p: law.p }
    };
    // ln A = ln C + g(m): its slope over m turns the covariance of (ln C, m) into that of (ln A, p).
    let step = 1e-3;
    let log_of_unit = |p: f64| bonds(Constants { a: 1.0, p }).a.ln();
    let slope = (log_of_unit(p + step) - log_of_unit(p - step)) / (2.0 * step);
    let [[c_c, c_m], [_, m_m]] = fit.confidence.covariance;
    let a_p = c_m + slope * m_m;
    fit.confidence.covariance = [[c_c + 2.0 * slope * c_m + slope * slope * m_m, a_p], [a_p, m_m]];
    let curves = fit.specimens.iter_mut().chain([&mut fit.record]);
    curves.for_each(|curve| curve.constants = bonds(curve.constants));
    (fit.rate_constant, fit.horizon) = (Some(constant.at(p).exp()), horizon);
    Ok(())
}

/// ln β near an exponent: a parabola through three.
struct RateConstant {
    p: [f64; 3],
    logarithm: [f64; 3],
}

impl RateConstant {
    fn around(family: ReferenceModel, p: f64) -> Result<Self> {
        let middle = p.clamp(STEADY_EXPONENTS.start() + P_STEP, STEADY_EXPONENTS.end() - P_STEP);
        let p = [middle - P_STEP, middle, middle + P_STEP];
        // The first computes what the others share.
        let first = family.rate_constant(p[1])?.ln();
        let others = [p[0], p[2]].par_iter().map(|&p| family.rate_constant(p)).collect::<Result<Vec<_>>>()?;
        Ok(RateConstant { p, logarithm: [others[0].ln(), first, others[1].ln()] })
    }

    fn at(&self, p: f64) -> f64 {
        let weight = |i: usize| {
            let others = (0..3).filter(|&j| j != i);
            others.map(|j| (p - self.p[j]) / (self.p[i] - self.p[j])).product::<f64>()
        };
        (0..3).map(|i| weight(i) * self.logarithm[i]).sum()
    }
}
