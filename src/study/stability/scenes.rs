//! Scenes without cycles: control of zero-energy modes, steps of time and of load, density of relaxation.

use std::path::Path;

use super::{Run, SWEEP, Sweep};
use crate::disc::{DIAMETER, ElasticDisc, TRAVEL, elastic, hondros_displacement};
use crate::scene::percent;
use crate::uniform_tension::{steel, strip};
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_scenes::bonds::BondState;
use perilife_scenes::failure::Failure;
use perilife_scenes::interaction::{Damaging, Interaction, Memory, Reaction};
use perilife_scenes::quasi_static::relaxation::{Breaking, Loads, Relaxation, RestEnd};
use perilife_scenes::scene::{Procedure, SceneLaw, ZeroEnergyControl};
use perilife_scenes::springs::Springs;
use perilife_scenes::{Scene, SceneEnd, dynamics};

/// Springs on the whole relative displacement of a correspondence law (Breitenfeld et al. 2014). Too weak a control leaves strain that is not
/// uniform from point to point (nodal), too strong a one stiffens the whole body (global).
pub const SPRING: Sweep = Sweep {
    name: "zero_energy_spring",
    about: "Brazilian disc between platens, 51 points across, against Hondros 1959: global, displacement of the end of the \
            horizontal diameter; nodal, largest departure of its second difference, over that displacement",
    parameter: "spring constant c_I (model.zero_energy_factor)",
    unit: "N/m^7",
    values: &[1e18, 1e19, 1e20, 3e20, 1e21, 3e21, 1e22, 3e22, 1e23],
    usual: 3e20,
    bound_percent: 5.0,
    methods: &[
        ("correspondence, spring: global", |c, _| global((ZeroEnergyControl::Spring, c))),
        ("correspondence, spring: nodal", |c, _| nodal((ZeroEnergyControl::Spring, c))),
    ],
    ..SWEEP
};

/// Springs on the part that is not uniform (Silling 2017).
pub const SILLING: Sweep = Sweep {
    name: "zero_energy_silling",
    parameter: "factor H (model.zero_energy_factor)",
    unit: "",
    values: &[0.0, 0.001, 0.01, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0],
    usual: 0.3,
    methods: &[
        ("correspondence, silling: global", |h, _| global((ZeroEnergyControl::Silling, h))),
        ("correspondence, silling: nodal", |h, _| nodal((ZeroEnergyControl::Silling, h))),
    ],
    ..SPRING
};

/// The disc with 51 points across, one on each axis.
fn disc(control: (ZeroEnergyControl, f64)) -> Result<ElasticDisc> {
    elastic(control, DIAMETER / 51.0, TRAVEL)
}

fn global(control: (ZeroEnergyControl, f64)) -> Result<f64> {
    let disc = disc(control)?;
    let (x, u) = disc.row.last().copied().unwrap_or((f64::NAN, f64::NAN));
    Ok(percent(u, hondros_displacement(x, disc.load, disc.half_angle)))
}

fn nodal(control: (ZeroEnergyControl, f64)) -> Result<f64> {
    let disc = disc(control)?;
    let exact = |x: f64| hondros_displacement(x, disc.load, disc.half_angle);
    let departs = |three: &[(f64, f64)]| {
        let second = |u: [f64; 3]| u[0] - 2.0 * u[1] + u[2];
        let [a, b, c] = [three[0], three[1], three[2]];
        (second([a.1, b.1, c.1]) - second([exact(a.0), exact(b.0), exact(c.0)])).abs()
    };
    let largest = disc.row.windows(3).map(departs).fold(0.0, f64::max);
    Ok(100.0 * largest / exact(disc.row.last().map_or(f64::NAN, |last| last.0)).abs())
}

/// A plate with a central crack of 8 mm, and these sections.
fn cracked_scene(sections: &str) -> Result<Scene> {
    let text = format!(
        "[specimen]\nkind = \"plate\"\nwidth_mm = 20\nlength_mm = 40\nthickness_mm = 1\n\
         cracks = [{{ from_mm = [-4, 0], to_mm = [4, 0] }}]\n[material]\nyoungs_modulus_gpa = 192\npoisson_ratio = 0.3\n\
         density_kg_m3 = 8000\nfracture_energy_j_m2 = 2000\n[model]\nspacing_mm = 1\n{sections}"
    );
    Scene::from_toml(&text, "stability", Path::new("."), &[])
}

/// Explicit time step.
pub const TIME_STEP: Sweep = Sweep {
    name: "time_step",
    about: "plate whose ends are pulled apart at 8 m/s: largest energy from nowhere over the largest work",
    parameter: "time step over the largest stable one (Gershgorin)",
    values: &[0.5, 0.6, 0.7, 0.8, 0.9, 0.99, 1.01, 1.1, 1.2],
    usual: 0.7,
    bound_percent: 1.0,
    methods: &[("velocity_verlet", by_time_step)],
    ..SWEEP
};

fn by_time_step(share: f64, run: &Run) -> Result<f64> {
    let mut scene = cracked_scene(
        "[loading]\nkind = \"velocity\"\nedges = [\"top\", \"bottom\"]\nvelocity_mm_s = 8e3\nduration_s = 30e-6\n[damage]\nlaw = \"none\"\n",
    )?;
    let net = perilife_scenes::build(&scene)?.0;
    let bound = Springs::new(&net, Failure::Never, false).stiffness_bound(&BondState::new(&net, &vec![false; net.len()]));
    let stable = dynamics::stable_step(&net, scene.material.density.unwrap_or(f64::NAN), &bound);
    if let Procedure::Dynamic { time_step, .. } = &mut scene.procedure {
        *time_step = Some(share * stable);
    }
    let done = perilife_scenes::run(&scene, run)?;
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
    values: &[2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0],
    usual: 64.0,
    is_continuous: false,
    bound_percent: 1.0,
    methods: &[
        ("secant", |steps, run| by_load_steps(steps, "secant", run)),
        ("adaptive_dynamic_relaxation", |steps, run| by_load_steps(steps, "adaptive_dynamic_relaxation", run)),
    ],
    ..SWEEP
};

fn by_load_steps(steps: f64, solver: &str, run: &Run) -> Result<f64> {
    let peak = |steps: f64, solver: &str| -> Result<f64> {
        let scene = cracked_scene(&format!(
            "solver = \"{solver}\"\n[loading]\nkind = \"displacement\"\nedges = [\"top\", \"bottom\"]\n\
             displacement_mm = 0.1\nsteps = {steps}\n[damage]\nlaw = \"critical_stretch\"\n"
        ))?;
        Ok(perilife_scenes::run(&scene, run)?.peak_load())
    };
    // The path of equilibrium gives the same force within 1e-9 by 2 to 256 steps.
    Ok(percent(peak(steps, solver)?, peak(64.0, "secant")?))
}

/// Density of adaptive dynamic relaxation.
pub const DENSITY_FACTOR: Sweep = Sweep {
    name: "density_factor",
    about: "plate of 30 x 40 points in uniform strain, held at its rim: largest error of a displacement over strain times length",
    parameter: "fictitious density over the least stable one (Gershgorin)",
    values: &[0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.5, 2.0, 5.0, 10.0, 100.0, 1000.0],
    usual: 1.0,
    bound_percent: 0.1,
    methods: &[("adaptive_dynamic_relaxation", |factor, _| by_density(factor))],
    ..SWEEP
};

/// Springs whose stiffness is said to be another than it is: the density goes with it.
struct Scaled<'n> {
    springs: Springs<'n>,
    factor: f64,
}

impl Interaction for Scaled<'_> {
    fn unknowns(&self) -> usize {
        self.springs.unknowns()
    }

    fn internal_force(&mut self, u: &[f64], bonds: &mut BondState, damaging: Damaging, force: &mut [f64]) -> Reaction {
        self.springs.internal_force(u, bonds, damaging, force)
    }

    fn stiffness_bound(&self, bonds: &BondState) -> Vec<[f64; 2]> {
        self.springs.stiffness_bound(bonds).into_iter().map(|bound| bound.map(|bound| self.factor * bound)).collect()
    }

    fn memory(&self) -> Memory {
        self.springs.memory()
    }

    fn restore(&mut self, memory: &Memory, bonds: &BondState) -> bool {
        self.springs.restore(memory, bonds)
    }
}

fn by_density(factor: f64) -> Result<f64> {
    const STRAIN: f64 = 1e-3;
    const NU: f64 = 0.25;
    let law = BondLaw {
        kind: BondLawKind::TwoParameter,
        kernel: Kernel::Conical,
        rotation: Rotation::Resisted,
        surface_correction: SurfaceCorrection::None,
    };
    let scene = Scene::bare("density", strip(30.0 * MM, 40.0 * MM), steel(NU), SceneLaw::Bonds(law), MM);
    let net = perilife_scenes::build(&scene)?.0;
    // The rim, three rows deep, has the exact displacement; points within have whole neighbourhoods.
    let is_rim = |[x, y]: [f64; 2]| x.abs() > 11.6 * MM || y.abs() > 16.6 * MM;
    let exact: Vec<f64> = net.positions.iter().flat_map(|x| [-NU * STRAIN * x[0], STRAIN * x[1]]).collect();
    let held: Vec<bool> = net.positions.iter().flat_map(|&x| [is_rim(x); 2]).collect();
    let mut u: Vec<f64> = exact.iter().zip(&held).map(|(u, held)| if *held { *u } else { 0.0 }).collect();
    let mut bonds = BondState::new(&net, &vec![true; net.len()]);
    let mut springs = Scaled { springs: Springs::new(&net, Failure::Never, false), factor };
    let external = vec![0.0; u.len()];
    let relaxation = Relaxation { breaking: Breaking::Never, ..Relaxation::default() };
    let rested = relaxation.relax(&mut springs, &mut bonds, Loads { held: &held, external: &external }, &mut u);
    match rested.end {
        RestEnd::AtRest => {
            let off = u.iter().zip(&exact).map(|(u, exact)| (u - exact).abs()).fold(0.0, f64::max);
            Ok(100.0 * off / (STRAIN * 40.0 * MM))
        }
        RestEnd::BlownUp => Err(Error::Mechanics(format!("the motion blew up after {} evaluations", rested.evaluations))),
        RestEnd::NoConvergence | RestEnd::Breaking => {
            Err(Error::Mechanics(format!("not at rest after {} evaluations", rested.evaluations)))
        }
    }
}
