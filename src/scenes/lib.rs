//! Fracture scenes: static, quasi-static and dynamic loading of cracked plates, without cycles.
//!
//! Knows: static, quasi-static and dynamic procedures, damage laws, points of several levels, platens and contact.
//! Must not know: cycles, laws of growth, cases, files of results.
//!
//! Imports `base`, `plate` and `points`; only `runner` and `study` import it.
//!
//! A scene is points and bonds ([`build`], [`dual_horizon`]), forces between them with damage ([`interaction`]), loads ([`boundary`]) and a
//! procedure. What changes is the state of the bonds ([`bonds`], written by the interaction) and the motion (written by the
//! procedure).

pub mod assembly;
pub mod bonds;
pub mod boundary;
pub mod checkpoint;
pub mod contact;
pub mod correspondence;
pub mod dual_horizon;
pub mod dynamics;
pub mod failure;
pub mod fronts;
pub mod interaction;
pub mod lattice_springs;
mod log;
pub mod outcome;
pub mod platens;
mod points;
pub mod quasi_static;
pub mod read;
pub mod scene;
pub mod springs;
pub mod trapping;

use std::sync::Arc;

pub use outcome::{Fracture, SceneEnd};
pub use points::build;
pub use scene::Scene;

use assembly::Assembly;
use checkpoint::{Clock, Course, SceneCheckpoint};
use log::Log;
use outcome::{HistoryRow, SceneFigures};
use perilife_base::error::{Result, input_missing};
use perilife_base::machine;
use perilife_base::parallel::in_pool;
use perilife_base::watch::{self, Stage, Watch};
use scene::Procedure;

/// What a scene reports while it goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneProgress {
    /// Share of the steps done, 0 to 1.
    pub share: f64,
}

/// Receives progress of a scene; returning `false` asks it to stop.
pub trait SceneObserver: Sync {
    /// Called after every recorded step; by default the scene goes on.
    fn step_done(&self, _progress: &SceneProgress) -> bool {
        true
    }

    /// Called with every row of the history as it is taken down, before [`SceneObserver::step_done`]; by default not looked at.
    fn row(&self, _row: &HistoryRow) {}

    /// Where the run marks what it does before it has a first step to show, and where it looks whether it may go on; by default nowhere.
    fn watch(&self) -> Option<Arc<Watch>> {
        None
    }

    /// Called after steps from which the run can be taken up later; what is not asked for costs nothing.
    fn may_keep(&self, _checkpoint: &dyn Fn() -> SceneCheckpoint) {}
}

impl SceneObserver for perilife_base::watch::Silent {}

/// Runs a scene.
/// Errors: wrong input that shows only now, choices that do not go together, a run that was cancelled.
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
/// Errors: as [`run`]; [`perilife_base::error::Error::Input`] if the checkpoint is not one of this scene.
pub fn resume(scene: &Scene, checkpoint: SceneCheckpoint, observer: &dyn SceneObserver) -> Result<Fracture> {
    checkpoint.check(scene)?;
    watched(scene, observer, Some(checkpoint))
}

fn follow(scene: &Scene, observer: &dyn SceneObserver, from: Option<SceneCheckpoint>) -> Result<Fracture> {
    let clock = Clock::start(from.as_ref());
    watch::at(Stage::Points, 0.0)?;
    let assembly = Assembly::of(scene)?;
    let (net, boundary) = (&assembly.net, &assembly.boundary);
    let warnings = assembly.warnings()?;
    let (mut bonds, mut interaction) = (assembly.bonds(), assembly.interaction()?);
    let course = |steps: usize| Course::new(scene, Log::new(scene, net, boundary, steps), observer, clock, from);
    let mut fracture = match scene.procedure {
        Procedure::Dynamic { duration, time_step } => {
            let density = scene
                .material
                .density
                .ok_or_else(|| input_missing("material.density_kg_m3", "is missing (required for motion)", "give it"))?;
            // With all that will ever press: the time step is chosen once.
            interaction.load_to(1.0);
            let bound = interaction.stiffness_bound(&bonds);
            let step = dynamics::time_step(time_step, dynamics::stable_step(net, density, &bound))?;
            let masses = dynamics::masses(net, density, &bound);
            let steps = (duration / step).round().max(1.0) as usize;
            let mut course = course(steps);
            let run = dynamics::Simulation { masses: &masses, step, steps };
            let (end, motion, evaluations) = run.follow(interaction.as_mut(), &mut bonds, &mut course)?;
            let figures = SceneFigures { evaluations, time_step: step, ..SceneFigures::default() };
            course.log.close(end, &motion.u, &bonds, figures)
        }
        Procedure::Static | Procedure::QuasiStatic { .. } => {
            let course = course(quasi_static::rows(scene.procedure));
            quasi_static::run(scene, &assembly.failure, interaction.as_mut(), &mut bonds, course)?
        }
    };
    let overlap = match fracture.figures.touching {
        Some(_) => None,
        None => contact::warning(scene, net, &bonds, &fracture.snapshots),
    };
    fracture.warnings.extend(warnings.into_iter().chain(overlap));
    fracture.figures.wall_s = clock.seconds();
    fracture.figures.memory_mb = machine::peak_mb();
    Ok(fracture)
}
