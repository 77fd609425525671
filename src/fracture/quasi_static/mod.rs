//! Scenes without time: one equilibrium, or a load that grows step by step.
//!
//! `adaptive_dynamic_relaxation` brings any interaction to rest, step after step, with the displacement of the loads rising
//! ([`steps`]), or, with `iterations_per_step`, follows the load in damped motion without coming to rest ([`marching`]). `secant` follows the path of springs through falling load and displacement ([`path`]).

pub mod account;
pub mod control;
pub mod equilibrium;
pub mod full_load;
pub mod marching;
pub mod path;
pub mod relaxation;
pub mod steps;
pub mod walk;

use super::bonds::BondState;
use super::boundary::Boundary;
use super::course::Course;
use super::failure::Failure;
use super::interaction::Interaction;
use super::log::Log;
use super::outcome::{Fracture, SceneFigures};
use super::scene::{DamageLaw, Discretisation, Procedure, Scene, SceneLaw, SceneSolver};
use crate::error::{Result, input};
use crate::levels::Net;
use account::Recorder;
use full_load::FullLoad;
use marching::March;
use path::{Path, Settings};
use relaxation::Relaxation;
use walk::Walked;

/// Rows between two pictures of a run, times those of a run with `SNAPSHOTS` of them.
const ROWS_EXPECTED: usize = 1000;
/// Excess over the largest work that is told of.
const EXCESS_TOLD: f64 = 0.005;

/// Runs a scene without time on a net with its loads.
///
/// # Errors
/// Choices that do not go together, loads that do not balance, a run that was cancelled.
pub fn run(
    scene: &Scene,
    net: &Net,
    boundary: &Boundary,
    interaction: &mut dyn Interaction,
    failure: Option<&Failure>,
    bonds: &mut BondState,
    course: Course<'_>,
) -> Result<Fracture> {
    let mut full = FullLoad::of(net, boundary)?;
    if interaction.driven().is_some() {
        full.release();
    }
    let (steps, iterations) = match scene.procedure {
        Procedure::QuasiStatic { steps, iterations } => (steps.max(1), iterations),
        _ => (1, None),
    };
    // Relaxation to rest and the path have rows between the nominal steps.
    let rows = if iterations.is_some() || steps == 1 { steps } else { steps.max(ROWS_EXPECTED) };
    let mut log = Log::new(scene, net, boundary, rows);
    let recorder = Recorder { log: &mut log, course, boundary, unknowns: net.unknowns };
    let walked = match scene.model.solver {
        SceneSolver::AdaptiveDynamicRelaxation => match iterations {
            Some(iterations) => March { full: &full, steps, iterations }.follow(interaction, bonds, recorder)?,
            None => steps::follow(&full, steps, &relaxation(scene), interaction, bonds, recorder)?,
        },
        SceneSolver::Secant => {
            let failure = secant_law(scene, failure)?;
            let path = Path { net, cracks: &scene.specimen.cracks, full: &full, failure, steps, settings: Settings::default() };
            path.follow(bonds, recorder)?
        }
        SceneSolver::VelocityVerlet => {
            let remedy = "give loading.duration_s, or solver = \"secant\" or \"adaptive_dynamic_relaxation\"";
            return Err(input("model.solver", "\"velocity_verlet\"", "needs time, and the scene has none", remedy));
        }
    };
    let Walked { end, u, account, evaluations, touching } = walked;
    let mut fracture = log.close(end, &u, bonds, SceneFigures { evaluations, touching, ..SceneFigures::default() });
    let excess = account.excess();
    if iterations.is_some() {
        fracture.warnings.push(format!(
            "the plate was not at rest in its load steps: {:.2} % of the work are motion or damped away",
            100.0 * excess
        ));
    } else if excess.abs() > EXCESS_TOLD {
        fracture.warnings.push(format!(
            "{:.2} % of the work is neither strain nor fracture energy: the plate jumped, and a scene without time does not follow \
             where that energy goes",
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

/// The law of damage, if the path of its springs can be followed.
fn secant_law<'f>(scene: &Scene, failure: Option<&'f Failure>) -> Result<&'f Failure> {
    let refuse =
        |problem: &str| input("model.solver", "\"secant\"", problem.to_owned(), "use solver = \"adaptive_dynamic_relaxation\"");
    let failure = failure.filter(|_| matches!(scene.model.law, SceneLaw::Bonds(_)));
    let Some(failure) = failure else {
        return Err(refuse("needs springs in bonds, and the law has none"));
    };
    if scene.model.arrangement == Discretisation::VariableHorizon {
        return Err(refuse("needs forces with an energy, and those of discretisation = \"variable_horizon\" have none"));
    }
    if scene.model.finite {
        return Err(refuse("is linear in the displacement, and kinematics is \"finite\""));
    }
    if scene.damage.law == DamageLaw::NonlinearTwoParameter && scene.damage.nonlinear.is_some_and(|law| law.printed) {
        return Err(refuse("needs stiffness that never comes back, and that of the printed law does"));
    }
    Ok(failure)
}
