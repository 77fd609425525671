//! Steps of time and of load of fracture scenes.

use std::path::Path;

use super::super::exact::percent;
use super::super::{Method, Run, Sweep};
use crate::error::{Error, Result};
use crate::fracture::bonds::BondState;
use crate::fracture::failure::Failure;
use crate::fracture::interaction::Interaction;
use crate::fracture::scene::Procedure;
use crate::fracture::springs::Springs;
use crate::fracture::{self, Scene, SceneEnd, dynamics};

/// A plate with a central crack of 8 mm, without load.
const PLATE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 20\nlength_mm = 40\nthickness_mm = 1\n\
    cracks = [{ from_mm = [-4, 0], to_mm = [4, 0] }]\n[material]\nyoungs_modulus_gpa = 192\npoisson_ratio = 0.3\n\
    density_kg_m3 = 8000\nfracture_energy_j_m2 = 2000\n";

/// Explicit time step.
pub const TIME_STEP: Sweep = Sweep {
    name: "time_step",
    about: "plate whose ends are pulled apart at 8 m/s: largest energy from nowhere over the largest work",
    parameter: "time step over the largest stable one (Gershgorin)",
    unit: "",
    values: &[0.5, 0.6, 0.7, 0.8, 0.9, 0.99, 1.01, 1.1, 1.2],
    usual: 0.7,
    is_continuous: true,
    bound_percent: 1.0,
    methods: &[Method { name: "velocity_verlet", measure: by_time_step }],
};

fn by_time_step(share: f64, run: &Run) -> Result<f64> {
    let text = format!(
        "{PLATE}[model]\nspacing_mm = 1\n[loading]\nkind = \"velocity\"\nedges = [\"top\", \"bottom\"]\nvelocity_mm_s = 8e3\n\
         duration_s = 30e-6\n[damage]\nlaw = \"none\"\n"
    );
    let mut scene = Scene::from_toml(&text, "time_step", Path::new("."), &[])?;
    let net = fracture::build(&scene)?.0;
    let springs = Springs::new(&net, Failure::Never, false);
    let bonds = BondState::new(&net, &vec![false; net.len()]);
    let density = scene.material.density.unwrap_or(f64::NAN);
    let stable = dynamics::stable_step(&net, density, &springs.stiffness_bound(&bonds));
    if let Procedure::Dynamic { time_step, .. } = &mut scene.procedure {
        *time_step = Some(share * stable);
    }
    let done = fracture::run(&scene, run)?;
    if done.end != SceneEnd::Done {
        return Err(Error::Mechanics(format!("the motion ended early: {}", done.end)));
    }
    let largest = done.history.iter().map(|row| row.work.abs()).fold(0.0, f64::max);
    let lost = done.history.iter().map(|row| (row.kinetic + row.strain + row.fracture - row.work).abs());
    Ok(100.0 * lost.fold(0.0, f64::max) / largest)
}

/// Steps of a load that is driven past snap-back.
pub const LOAD_STEPS: Sweep = Sweep {
    name: "load_steps",
    about: "plate whose ends are pulled apart past snap-back until all but some bonds are broken: largest force over that of the path of equilibrium",
    parameter: "load steps (loading.steps)",
    unit: "",
    values: &[2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0],
    usual: 64.0,
    is_continuous: false,
    bound_percent: 1.0,
    methods: &[
        Method { name: "secant", measure: |steps, run| by_load_steps(steps, "secant", run) },
        Method {
            name: "adaptive_dynamic_relaxation",
            measure: |steps, run| by_load_steps(steps, "adaptive_dynamic_relaxation", run),
        },
    ],
};

/// Steps of the run by the path of equilibrium that others are compared with: 2 to 256 give the same force within 1e-9.
const STEPS: f64 = 64.0;

fn by_load_steps(steps: f64, solver: &str, run: &Run) -> Result<f64> {
    let peak = |steps: f64, solver: &str| -> Result<f64> {
        let text = format!(
            "{PLATE}[model]\nspacing_mm = 1\nsolver = \"{solver}\"\n[loading]\nkind = \"displacement\"\nedges = [\"top\", \"bottom\"]\n\
             displacement_mm = 0.1\nsteps = {steps}\n[damage]\nlaw = \"critical_stretch\"\n"
        );
        Ok(fracture::run(&Scene::from_toml(&text, "load_steps", Path::new("."), &[])?, run)?.peak_load())
    };
    Ok(percent(peak(steps, solver)?, peak(STEPS, "secant")?))
}
