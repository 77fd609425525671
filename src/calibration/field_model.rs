//! The model that a calibration fits where cracks grow by the K of their tips: Paris growth on the K(a) of one peridynamic run.
//!
//! C and m are fitted as by hand calculation, but to the K of the tip's own field, so that a case with the fitted law repeats the
//! measured life. A and p of bonds are what C and m stand for ([`ParisLaw::to_bonds`]).

use rayon::prelude::*;

use super::fit::Fit;
use super::model::{ForwardModel, RecordedRun};
use super::power_law::PowerLaw;
use super::search::{Constants, P_MAX, P_MIN};
use crate::case::Case;
use crate::error::Result;
use crate::fatigue::paris::ParisLaw;
use crate::predict::Observer;
use crate::predict::bond_rate::ReferenceModel;
use crate::predict::factor_curve::FactorCurve;

/// Distance of the exponents between which the rate constant is taken for others, in p.
const P_STEP: f64 = 0.5;

/// Paris growth with the K(a) of a peridynamic run. Its constants are C, m/cycle at ΔK = 1 MPa√m, and m.
#[derive(Debug)]
pub struct FieldModel {
    law: PowerLaw,
    factors: FactorCurve,
}

impl FieldModel {
    /// Makes the run of a calibration case.
    ///
    /// # Errors
    /// As [`FactorCurve::of`].
    pub fn new(case: &Case, observer: &dyn Observer) -> Result<Self> {
        let factors = FactorCurve::of(case, observer)?;
        let delta_k = |length: f64| case.loading.range_share() * factors.at(length);
        let law = PowerLaw::new(case.specimen.crack_length, case.stop.crack_length, &delta_k)?;
        Ok(FieldModel { law, factors })
    }
}

impl ForwardModel for FieldModel {
    fn run(&self, p: f64) -> Result<RecordedRun> {
        let law = self.law.clone();
        let (horizon, spacing) = (self.factors.figures.horizon, self.factors.figures.spacing);
        let mut run = RecordedRun::new(self.law.curve(p), horizon, spacing, move |p| law.curve(p));
        run.warnings.clone_from(&self.factors.warnings);
        Ok(run)
    }
}

/// A fit of C and m as one of A and p, with the rate constant that ties them.
///
/// # Errors
/// As [`ReferenceModel::rate_constant`].
pub fn in_terms_of_bonds(fit: &mut Fit, case: &Case) -> Result<()> {
    let modulus = case.material.plane_modulus();
    let p = fit.record.constants.p;
    let constant = RateConstant::around(ReferenceModel::of(&case.model), p)?;
    let horizon = fit.horizon;
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
    fit.rate_constant = Some(constant.at(p).exp());
    // However often C and m were tried, one run gave K.
    fit.evaluations = 1;
    Ok(())
}

/// ln β near an exponent: a parabola through three.
struct RateConstant {
    p: [f64; 3],
    logarithm: [f64; 3],
}

impl RateConstant {
    fn around(family: ReferenceModel, p: f64) -> Result<Self> {
        let middle = p.clamp(P_MIN + P_STEP, P_MAX - P_STEP);
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
