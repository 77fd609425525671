//! Steps of time and of load of scenes, density of relaxation.

use std::path::Path;

use super::figures::Figures;
use super::subject::Watcher;
use super::uniform_tension::{steel, strip};
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_scenes::bonds::BondState;
use perilife_scenes::failure::Failure;
use perilife_scenes::interaction::{Damaging, Interaction, Memory, Reaction};
use perilife_scenes::quasi_static::relaxation::{Breaking, Loads, Relaxation, RestEnd};
use perilife_scenes::scene::{Procedure, SceneLaw};
use perilife_scenes::springs::Springs;
use perilife_scenes::{Scene, SceneEnd, dynamics};

fn scene(text: &str) -> Result<Scene> {
    Scene::from_toml(text, "stability", Path::new("."), &[])
}

/// A scene in motion at a share of the largest stable time step (Gershgorin): largest energy from nowhere over the largest work, percent.
pub fn energy_lost(text: &str, share: f64, observer: &dyn Watcher) -> Result<Figures> {
    let mut scene = scene(text)?;
    let net = perilife_scenes::build(&scene)?.0;
    let bound = Springs::new(&net, Failure::Never, false).stiffness_bound(&BondState::new(&net, &vec![false; net.len()]));
    let stable = dynamics::stable_step(&net, scene.material.density.unwrap_or(f64::NAN), &bound);
    if let Procedure::Dynamic { time_step, .. } = &mut scene.procedure {
        *time_step = Some(share * stable);
    }
    let done = perilife_scenes::run(&scene, observer)?;
    if done.end != SceneEnd::Done {
        return Err(Error::Mechanics(format!("the motion ended early: {}", done.end)));
    }
    let largest = done.history.iter().map(|row| row.work.abs()).fold(0.0, f64::max);
    let lost = done.history.iter().map(|row| (row.kinetic + row.strain + row.fracture - row.work).abs());
    Ok(vec![("lost", 100.0 * lost.fold(0.0, f64::max) / largest)])
}

/// Largest load of a scene, N.
pub fn largest_load(text: &str, observer: &dyn Watcher) -> Result<Figures> {
    Ok(vec![("load", perilife_scenes::run(&scene(text)?, observer)?.peak_load())])
}

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

/// A plate of 30 x 40 points in uniform strain, held at its rim, by adaptive dynamic relaxation with so many times the least stable density:
/// largest error of a displacement over strain times length, percent.
pub fn relaxed(factor: f64) -> Result<Figures> {
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
            Ok(vec![("error", 100.0 * off / (STRAIN * 40.0 * MM))])
        }
        RestEnd::BlownUp => Err(Error::Mechanics(format!("unstable after {} evaluations", rested.evaluations))),
        RestEnd::NoConvergence | RestEnd::Breaking => {
            Err(Error::Mechanics(format!("not at rest after {} evaluations", rested.evaluations)))
        }
    }
}
