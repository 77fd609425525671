//! What a case with residual stress needs: cracks and a law that know it.

use super::{Case, Engine, LawSource};
use perilife_base::error::{Result, input};
use perilife_plate::loading::LoadControl;
use perilife_plate::loading::residual::ResidualStress;
use perilife_plate::specimen::SpecimenKind;

/// Places on half a centre crack's line at which a field is looked at for symmetry.
const LOOKED_AT: usize = 200;
/// Laws that take the stress ratio as it is.
const KNOWING: [&str; 3] = ["walker", "forman", "nasgro"];
/// Difference of both sides over the largest stress that is none.
const SYMMETRIC: f64 = 1e-6;

/// Refuses residual stress where something in the case does not know it, or knows it at a stress ratio of its own alone.
pub(super) fn check(case: &Case) -> Result<()> {
    let Some(residual) = case.loading.residual.as_deref() else { return Ok(()) };
    let refuse = |problem: &str, remedy: &str| Err(input(residual.key(), residual.words(), problem, remedy));
    if case.loading.control != LoadControl::Load {
        let problem = "cannot be combined with a load that depends on the crack length";
        return refuse(problem, "give one load, such as loading.stress_max_mpa");
    }
    match case.engine() {
        Engine::Nodes | Engine::Points => {}
        Engine::Handbook if case.specimen.kind != SpecimenKind::MiddleTension => {
            let problem = "needs K of crack-face forces, which the handbook has for middle_tension only";
            return refuse(problem, "use model.method = \"element_free_galerkin\" or \"peridynamics\"");
        }
        Engine::Handbook => check_symmetry(case, residual)?,
        Engine::PartThrough => {
            return refuse("is supported for through cracks only", "use a through crack");
        }
        Engine::Bonds | Engine::BondsThenPoints => {
            let problem = "changes K, which driver = \"bond_strain\" does not use";
            return refuse(
                problem,
                "use fatigue.driver = \"tip_field\" with sharp cracks, or model.method = \"element_free_galerkin\"",
            );
        }
    }
    residual.check_cracks(&case.specimen.crack_lines())?;
    check_law(case, residual)
}

/// The law is asked at the stress ratios that the residual stress makes.
fn check_law(case: &Case, residual: &ResidualStress) -> Result<()> {
    let has_gamma = case.choices.walker_gamma.is_some();
    let (of_one_ratio, name) = match &case.law {
        LawSource::Missing(_) => (false, String::new()),
        LawSource::Factor(law) if law.table.is_some() => (true, law.kind.to_string()),
        LawSource::Factor(law) => (!has_gamma && !KNOWING.contains(&law.kind.0.name), law.kind.to_string()),
        LawSource::Paris(_) => (!has_gamma, "paris".to_owned()),
        LawSource::Inline(_) | LawSource::Fitted(_) => (!has_gamma, "a, p".to_owned()),
    };
    if !of_one_ratio {
        return Ok(());
    }
    let problem = format!("changes R along the crack; law ({name}) is for one R");
    let remedy = "give fatigue.walker_gamma (1 = no mean-stress effect), or growth_law = \"walker\", \"forman\" or \"nasgro\"";
    Err(input(residual.key(), residual.words(), problem, remedy))
}

/// A handbook has one K for both tips.
fn check_symmetry(case: &Case, residual: &ResidualStress) -> Result<()> {
    let half = 0.5 * case.specimen.width;
    let sides = |i: usize| {
        let x = half * i as f64 / LOOKED_AT as f64;
        (x, [x, -x].map(|x| residual.at([x, 0.0])))
    };
    let largest = (0..=LOOKED_AT).flat_map(|i| sides(i).1).map(|stress| stress[1].abs()).fold(0.0, f64::max);
    let is_apart = |(_, [right, left]): &(f64, [[f64; 3]; 2])| {
        (right[1] - left[1]).abs().max(right[2].abs()).max(left[2].abs()) > SYMMETRIC * largest
    };
    match (0..=LOOKED_AT).map(sides).find(is_apart) {
        None => Ok(()),
        Some((x, _)) => {
            let problem = format!("is not symmetric at x = {:.3} mm: K differs between the tips", x * 1e3);
            Err(input(residual.key(), residual.words(), problem, "use model.method = \"element_free_galerkin\""))
        }
    }
}
