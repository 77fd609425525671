//! Scenes without time: one equilibrium, or a load that grows step by step.
//!
//! `adaptive_dynamic_relaxation` brings any interaction to rest, step after step, with the displacement of the loads rising
//! ([`steps`]), or, with `iterations_per_step`, follows the load in damped motion without coming to rest ([`steps::march`]). `secant` follows the path of springs through falling load and displacement ([`path`]).

pub mod account;
pub mod control;
pub mod equilibrium;
pub mod path;
pub mod relaxation;
pub mod steps;
pub mod stiffness;

use super::bonds::BondState;
use super::checkpoint::Course;
use super::failure::Failure;
use super::interaction::Interaction;
use super::outcome::{Fracture, SceneFigures};
use super::scene::{DamageLaw, Procedure, Scene, SceneLaw, SceneSolver};
use account::Walked;
use equilibrium::FullLoad;
use perilife_base::error::{Result, input};
use relaxation::Relaxation;

/// Rows between two pictures of a run, times those of a run with `SNAPSHOTS` of them.
const ROWS_EXPECTED: usize = 1000;
/// Excess over the largest work that is told of.
const EXCESS_TOLD: f64 = 0.005;

/// Rows to expect of a scene without time; relaxation to rest and the path have some between the nominal steps.
pub fn rows(procedure: Procedure) -> usize {
    match procedure {
        Procedure::QuasiStatic { steps, iterations: None } if steps > 1 => steps.max(ROWS_EXPECTED),
        Procedure::QuasiStatic { steps, .. } => steps.max(1),
        _ => 1,
    }
}

/// Runs a scene without time.
/// Errors: choices that do not go together, loads that do not balance, a run that was cancelled.
pub fn run(
    scene: &Scene,
    failure: &Failure,
    interaction: &mut dyn Interaction,
    bonds: &mut BondState,
    mut course: Course<'_>,
) -> Result<Fracture> {
    let mut full = FullLoad::of(course.log.net, course.log.boundary)?;
    if interaction.driven().is_some() {
        full.release();
    }
    let (steps, iterations) = match scene.procedure {
        Procedure::QuasiStatic { steps, iterations } => (steps.max(1), iterations),
        _ => (1, None),
    };
    let walked = match (scene.model.solver, iterations) {
        (SceneSolver::AdaptiveDynamicRelaxation, Some(iterations)) => {
            steps::march(&full, [steps, iterations], interaction, bonds, &mut course)?
        }
        (SceneSolver::AdaptiveDynamicRelaxation, None) => {
            steps::follow(&full, steps, &relaxation(scene), interaction, bonds, &mut course)?
        }
        (SceneSolver::Secant, _) => {
            check_secant(scene)?;
            path::follow(&scene.specimen.cracks, &full, failure, steps, bonds, &mut course)?
        }
        (SceneSolver::VelocityVerlet, _) => {
            let remedy = "give loading.duration_s, or solver = \"secant\" or \"adaptive_dynamic_relaxation\"";
            return Err(input("model.solver", "\"velocity_verlet\"", "requires time", remedy));
        }
    };
    let Walked { end, u, account, evaluations, touching } = walked;
    let mut fracture = course.log.close(end, &u, bonds, SceneFigures { evaluations, touching, ..SceneFigures::default() });
    let excess = account.excess();
    if iterations.is_some() {
        fracture.warnings.push(format!(
            "energy: the plate was not at rest in its load steps: {:.2} % of the work is kinetic or damped",
            100.0 * excess
        ));
    } else if excess.abs() > EXCESS_TOLD {
        fracture.warnings.push(format!(
            "energy: {:.2} % of the work is neither strain nor fracture energy: unstable jump, whose energy a scene without time does \
             not track",
            100.0 * excess
        ));
    }
    Ok(fracture)
}

/// Relaxation as the law of a scene asks for: correspondence breaks bonds by stresses that agree to some 1e-4, and its forces
/// cost more.
fn relaxation(scene: &Scene) -> Relaxation {
    match scene.model.law {
        SceneLaw::Bonds(_) => Relaxation::default(),
        SceneLaw::Correspondence { .. } => Relaxation { tolerance: 1e-5, ..Relaxation::default() },
    }
}

/// Whether the path of a scene's springs can be followed.
fn check_secant(scene: &Scene) -> Result<()> {
    let problem = if !matches!(scene.model.law, SceneLaw::Bonds(_)) {
        "requires a bond law with springs"
    } else if scene.model.finite {
        "does not support kinematics = \"finite\""
    } else if scene.damage.law == DamageLaw::NonlinearTwoParameter && scene.damage.nonlinear.is_some_and(|law| law.printed) {
        "requires stiffness that never recovers; that of the published law does"
    } else {
        return Ok(());
    };
    Err(input("model.solver", "\"secant\"", problem, "use solver = \"adaptive_dynamic_relaxation\""))
}
