//! Fracture scenes: static, quasi-static and dynamic loading of cracked plates, without cycles.
//!
//! A scene is points and bonds ([`crate::levels`]), forces between them with damage ([`interaction`]), loads ([`boundary`]) and a
//! procedure. What changes is the state of the bonds ([`bonds`], written by the interaction) and the motion (written by the
//! procedure).

pub mod bonds;
pub mod boundary;
mod budget;
pub mod checkpoint;
pub mod contact;
pub mod correspondence;
mod course;
pub mod dynamics;
pub mod failure;
pub mod fronts;
pub mod interaction;
pub mod lattice_springs;
mod log;
pub mod outcome;
pub mod pieces;
pub mod platens;
pub mod preview;
pub mod quasi_static;
pub mod read;
mod region;
pub mod rotation;
pub mod scene;
pub mod springs;

use std::sync::Arc;

pub use outcome::{Fracture, SceneEnd};
pub use scene::Scene;

use crate::body::Body;
use crate::bond_law::stencil::{Stencil, plane_stiffness, spring_material};
use crate::case::budget::machine;
use crate::error::{Result, input};
use crate::levels::{MultiLevelSpec, Net, dual_horizon};
use crate::parallel::in_pool;
use crate::watch::{self, Stage, Watch};
use bonds::BondState;
use boundary::Boundary;
use checkpoint::SceneCheckpoint;
use correspondence::Correspondence;
use course::{Clock, Course};
use failure::{Failure, critical_stretch};
use interaction::Interaction;
use lattice_springs::LatticeSprings;
use log::Log;
use outcome::SceneFigures;
use platens::{Platen, Pressed};
use scene::{Action, Discretisation, Procedure, SceneLaw};
use springs::Springs;

/// What a scene reports while it goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneProgress {
    /// Share of the steps done, 0 to 1.
    pub share: f64,
}

/// Receives progress of a scene; returning `false` asks it to stop.
pub trait SceneObserver: Sync {
    /// Called after every recorded step.
    fn step_done(&self, progress: &SceneProgress) -> bool;

    /// Where the run marks what it does before it has a first step to show, and where it looks whether it may go on; by default nowhere.
    fn watch(&self) -> Option<Arc<Watch>> {
        None
    }

    /// Called after steps from which the run can be taken up later; what is not asked for costs nothing.
    fn may_keep(&self, _checkpoint: &dyn Fn() -> SceneCheckpoint) {}
}

impl SceneObserver for crate::predict::Silent {
    fn step_done(&self, _progress: &SceneProgress) -> bool {
        true
    }
}

/// Runs a scene.
///
/// # Errors
/// Wrong input that shows only now, choices that do not go together, a run that was cancelled.
pub fn run(scene: &Scene, observer: &dyn SceneObserver) -> Result<Fracture> {
    watched(scene, observer, None)
}

/// A run under the eyes of its observer from building the points on.
fn watched(scene: &Scene, observer: &dyn SceneObserver, from: Option<SceneCheckpoint>) -> Result<Fracture> {
    scene.budget().within_machine()?;
    let run = || watch::unless_cancelled(&scene.name, follow(scene, observer, from));
    in_pool(|| watch::with(observer.watch(), run))
}

/// Goes on with a run of a scene from a checkpoint of it; gives what [`run`] gives, bit for bit, its wall time counted from the start
/// of the first run.
///
/// # Errors
/// As [`run`]; [`crate::Error::Input`] if the checkpoint is not one of this scene.
pub fn resume(scene: &Scene, checkpoint: SceneCheckpoint, observer: &dyn SceneObserver) -> Result<Fracture> {
    checkpoint.check(scene)?;
    watched(scene, observer, Some(checkpoint))
}

fn follow(scene: &Scene, observer: &dyn SceneObserver, from: Option<SceneCheckpoint>) -> Result<Fracture> {
    let clock = Clock::start(from.as_ref());
    let course = Course::new(scene, observer, clock, from);
    watch::at(Stage::Points, 0.0)?;
    let (net, body) = build(scene)?;
    let boundary = Boundary::of(scene, &net)?;
    let mut bonds = BondState::new(&net, &boundary.no_fail);
    let failure = failure(scene, &net)?;
    let body = of_motion(scene, body);
    let turning = rotation::warning(scene, &net, body.as_ref(), &bonds, failure.as_ref())?;
    let mut interaction = interact(scene, &net, body.as_ref(), &bonds, failure.as_ref())?;
    let mut fracture = match scene.procedure {
        Procedure::Dynamic { duration, time_step } => {
            let density = scene.material.density.ok_or_else(|| {
                crate::error::input_missing("material.density_kg_m3", "is missing: motion needs mass", "give it")
            })?;
            // With all that will ever press: the time step is chosen once.
            interaction.load_to(1.0);
            let bound = interaction.stiffness_bound(&bonds);
            let step = dynamics::time_step(time_step, dynamics::stable_step(&net, density, &bound))?;
            let masses = dynamics::masses(&net, density, &bound);
            let steps = (duration / step).round().max(1.0) as usize;
            let run = dynamics::Run { boundary: &boundary, masses: &masses, step, steps };
            let mut log = Log::new(scene, &net, &boundary, steps);
            let (end, motion, evaluations) = run.follow(interaction.as_mut(), &mut bonds, &mut log, course)?;
            let figures = SceneFigures { evaluations, time_step: step, ..SceneFigures::default() };
            log.close(end, &motion.u, &bonds, figures)
        }
        Procedure::Static | Procedure::QuasiStatic { .. } => {
            quasi_static::run(scene, &net, &boundary, interaction.as_mut(), failure.as_ref(), &mut bonds, course)?
        }
    };
    let overlap = contact::warning(scene, &net, &bonds, &fracture);
    fracture.warnings.extend(net.warnings.iter().cloned().chain(turning).chain(overlap));
    fracture.figures.wall_s = clock.seconds();
    fracture.figures.memory_mb = machine::peak_mb();
    Ok(fracture)
}

/// The body whose springs the fast kernel works through: only explicit motion leaves the state of the bonds to it alone.
fn of_motion(scene: &Scene, body: Option<Body>) -> Option<Body> {
    body.filter(|_| matches!(scene.procedure, Procedure::Dynamic { .. }))
}

/// Points and bonds of a scene, and the lattice body behind them if there is one.
///
/// # Errors
/// Wrong input that shows only now, choices that do not go together.
pub fn build(scene: &Scene) -> Result<(Net, Option<Body>)> {
    let model = &scene.model;
    match (model.law, model.arrangement) {
        (law, Discretisation::Lattice) => {
            let law = match law {
                SceneLaw::Bonds(law) => law,
                SceneLaw::Correspondence { .. } => correspondence::NET_LAW,
            };
            let body =
                Body::build(&scene.specimen, &scene.material, &law, model.spacing, model.horizon_ratio, model.lattice_angle)?;
            Ok((Net::of_body(&body), Some(body)))
        }
        (SceneLaw::Bonds(law), Discretisation::DualHorizon) => {
            let ask = MultiLevelSpec {
                specimen: &scene.specimen,
                material: &scene.material,
                law: &law,
                spacing: model.spacing,
                horizon_ratio: model.horizon_ratio,
                lattice_angle: model.lattice_angle,
                refinement: scene.refinement.as_ref(),
                floating: is_floating(scene),
            };
            Ok((dual_horizon::build(&ask)?, None))
        }
        (SceneLaw::Correspondence { .. }, arrangement) => {
            let problem = "is built for laws of bonds, not for bond_law = \"correspondence\"";
            Err(input("model.discretisation", format!("\"{arrangement}\""), problem, "use \"lattice\""))
        }
    }
}

/// Whether nothing holds the plate, so that its loads must balance.
fn is_floating(scene: &Scene) -> bool {
    scene.specimen.supports.is_empty()
        && scene.holds.is_empty()
        && scene.drives.iter().all(|drive| matches!(drive.action, Action::Traction(_)))
}

/// Law of damage of the springs; `None` where there are none.
fn failure(scene: &Scene, net: &Net) -> Result<Option<Failure>> {
    let SceneLaw::Bonds(law) = scene.model.law else { return Ok(None) };
    let critical = scene.material.fracture_energy.map(|energy| {
        let at = |spacing: f64| -> Result<f64> {
            let thickness = scene.specimen.thickness;
            let material = spring_material(&law, &scene.material);
            let stencil = Stencil::new(&law, &material, spacing, scene.model.horizon_ratio, thickness)?;
            Ok(critical_stretch(&stencil, plane_stiffness(&material)[0], energy, thickness))
        };
        // Few levels, many points.
        let mut known: Vec<(f64, f64)> = Vec::new();
        let of_point = |&spacing: &f64| match known.iter().find(|(of, _)| *of == spacing) {
            Some((_, stretch)) => Ok(*stretch),
            None => {
                let stretch = at(spacing)?;
                known.push((spacing, stretch));
                Ok(stretch)
            }
        };
        net.spacings.iter().map(of_point).collect::<Result<Vec<f64>>>()
    });
    Failure::of(scene, net.len(), critical.transpose()?).map(Some)
}

/// Forces on the points of a scene, those of platens among them.
fn interact<'n>(
    scene: &Scene,
    net: &'n Net,
    body: Option<&Body>,
    bonds: &BondState,
    failure: Option<&Failure>,
) -> Result<Box<dyn Interaction + 'n>> {
    let law = interact_by_law(scene, net, body, bonds, failure)?;
    let platens = Platen::all(scene, net);
    Ok(if platens.is_empty() { law } else { Box::new(Pressed::new(law, net, platens)) })
}

/// Forces between the points of a scene.
fn interact_by_law<'n>(
    scene: &Scene,
    net: &'n Net,
    body: Option<&Body>,
    bonds: &BondState,
    failure: Option<&Failure>,
) -> Result<Box<dyn Interaction + 'n>> {
    match (scene.model.law, failure) {
        (SceneLaw::Bonds(_), Some(failure)) => {
            let finite = scene.model.finite;
            let fast = body.and_then(|body| LatticeSprings::new(net, body, bonds, failure, finite));
            Ok(match fast {
                Some(fast) => Box::new(fast),
                None => Box::new(Springs::new(net, failure.clone(), finite)),
            })
        }
        (SceneLaw::Correspondence { control, factor }, _) => Ok(Box::new(Correspondence::new(scene, net, control, factor)?)),
        (SceneLaw::Bonds(_), None) => Ok(Box::new(Springs::new(net, Failure::Never, scene.model.finite))),
    }
}
