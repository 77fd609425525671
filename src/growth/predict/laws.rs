//! The law of a case in the form that its driver needs: of bonds, or over K.

use super::CurvePoint;
use crate::case::{Case, LawSource};
use crate::part_through::Order;
use crate::rate_constant::rate_constant;
use perilife_base::error::{Result, input_missing};
use perilife_base::units::MM;
use perilife_laws::FatigueLaw;
use perilife_laws::curve::Shaped;
use perilife_laws::growth_law::{GrowthLaw, Walker};
use perilife_laws::paris::ParisLaw;
use perilife_laws::spectrum_law::SpectrumLaw;

/// The law over K of a case, for driver `tip_field` and method `handbook`: of a spectrum the mean of its cycles.
/// Errors: a case without law; as [`rate_constant`] where it is one of bonds.
pub fn growth_law(case: &Case) -> Result<Box<dyn GrowthLaw>> {
    Ok(match &case.loading.spectrum {
        Some(spectrum) => Box::new(SpectrumLaw::new(law_of_cycle(case)?, spectrum)),
        None => law_of_cycle(case)?,
    })
}

/// The law over K of a case for one cycle.
/// Errors: as [`growth_law`].
pub fn law_of_cycle(case: &Case) -> Result<Box<dyn GrowthLaw>> {
    Ok(match &case.law {
        LawSource::Factor(law) => Box::new(law.clone()),
        _ => {
            let walker = Walker { paris: paris_law(case)?, gamma: case.fatigue.walker_gamma, threshold: case.fatigue.threshold };
            case.shape()?.map_or_else::<Box<dyn GrowthLaw>, _, _>(|| Box::new(walker), |shape| Box::new(Shaped { walker, shape }))
        }
    })
}

/// What the order of the cycles of a case needs, where that counts.
/// Errors: as [`growth_law`].
pub fn order(case: &Case) -> Result<Option<Order>> {
    let model = case.retardation.clone();
    model.map(|model| Ok(Order { law: law_of_cycle(case)?, model })).transpose()
}

/// Refuses growth from a K that lies beyond what the law says, where the law wants that.
/// So is growth to where a residual stress is not known.
pub fn check_within(case: &Case, now: &CurvePoint, law: Option<&dyn GrowthLaw>) -> Result<()> {
    if let Some(residual) = &case.loading.residual {
        now.tips.iter().try_for_each(|tip| residual.check(tip.position))?;
    }
    let Some(law) = law.filter(|law| law.is_refused_beyond()) else { return Ok(()) };
    let ratio = now.response.ratio(case.loading.ratio);
    let Some(problem) = law.beyond(now.k_max(&case.loading), ratio) else { return Ok(()) };
    let at = format!("{problem}, at a crack length of {:.3} mm", now.crack_length / MM);
    Err(input_missing(
        "fatigue.growth_table",
        at,
        "give a longer table, or growth_table_ends = \"held\" to hold the rate of its end",
    ))
}

/// Warning of the share of life beyond a table, by the rate at its end.
pub fn beyond_warning(case: &Case, law: &dyn GrowthLaw, curve: &[CurvePoint]) -> Option<String> {
    let life = curve.last()?.cycles;
    let share = |row: &CurvePoint| law.share_beyond(row.k_max(&case.loading), case.loading.ratio, &row.response);
    let shares: Vec<f64> = curve.iter().map(|row| if row.delta_k.is_nan() { 0.0 } else { share(row) }).collect();
    // Of a single kind of cycle an interval counts that is beyond at one of its ends.
    let of = |ends: &[f64]| if case.loading.spectrum.is_some() { 0.5 * (ends[0] + ends[1]) } else { ends[0].max(ends[1]) };
    let cycles: f64 =
        curve.windows(2).zip(shares.windows(2)).map(|(pair, ends)| of(ends) * (pair[1].cycles - pair[0].cycles)).sum();
    (cycles > 0.0).then(|| {
        let share = 100.0 * cycles / life;
        format!("rates: {share:.2} % of the life is at ΔK beyond the table of rates, by the rate at its end")
    })
}

/// C and m of a case; a law of bonds stands for those that [`ParisLaw::of_bonds`] gives.
pub fn paris_law(case: &Case) -> Result<ParisLaw> {
    match &case.law {
        LawSource::Inline(law) => {
            let beta = rate_constant(case.points().bond_law.kernel, law.p)?;
            Ok(ParisLaw::of_bonds(law, beta, case.material.plane_modulus()))
        }
        _ => case.paris_law(),
    }
}

/// A and p of a case at the body's actual horizon, m, for driver `bond_strain`; C and m stand for those that [`ParisLaw::to_bonds`]
/// gives.
/// Errors: a case without law; as [`rate_constant`] where it is one over K.
pub fn bond_law(case: &Case, horizon: f64) -> Result<FatigueLaw> {
    match &case.law {
        LawSource::Paris(law) => {
            let beta = rate_constant(case.points().bond_law.kernel, law.m)?;
            Ok(law.to_bonds(beta, case.material.plane_modulus(), horizon))
        }
        _ => case.fatigue_law(horizon),
    }
}
