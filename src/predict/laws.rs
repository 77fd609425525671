//! The law of a case in the form that its driver needs: of bonds, or over K.

use super::bond_rate::Family;
use crate::case::{Case, LawSource};
use crate::error::Result;
use crate::fatigue::FatigueLaw;
use crate::fatigue::growth_law::Walker;
use crate::fatigue::paris::ParisLaw;

/// The law over K of a case, for driver `tip_field` and method `handbook`.
///
/// # Errors
/// A case without law; as [`Family::rate_constant`] where it is one of bonds.
pub fn growth_law(case: &Case) -> Result<Walker> {
    Ok(Walker { paris: paris_law(case)?, gamma: case.fatigue.walker_gamma, threshold: case.fatigue.threshold })
}

/// C and m of a case; a law of bonds stands for those that [`ParisLaw::of_bonds`] gives.
///
/// # Errors
/// As [`growth_law`].
pub fn paris_law(case: &Case) -> Result<ParisLaw> {
    match &case.law {
        LawSource::Inline(law) => {
            let beta = Family::of(&case.model).rate_constant(law.p)?;
            Ok(ParisLaw::of_bonds(law, beta, case.material.plane_modulus()))
        }
        _ => case.paris_law(),
    }
}

/// A and p of a case at the body's actual horizon, m, for driver `bond_strain`; C and m stand for those that [`ParisLaw::to_bonds`]
/// gives.
///
/// # Errors
/// A case without law; as [`Family::rate_constant`] where it is one over K.
pub fn bond_law(case: &Case, horizon: f64) -> Result<FatigueLaw> {
    match &case.law {
        LawSource::Paris(law) => {
            let beta = Family::of(&case.model).rate_constant(law.m)?;
            Ok(law.to_bonds(beta, case.material.plane_modulus(), horizon))
        }
        _ => case.fatigue_law(horizon),
    }
}
