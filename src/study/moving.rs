//! Scenes: steps of time and of load, density of relaxation, loads at which cracks grow or branch; without time, examples 1 and 2 of Huang,
//! Li, Jin, He and Wang, Guangxi University, with the stiffness of Zhu and Ni 2017, Int. J. Eng. Sci. 121:118.

use std::path::Path;
use std::sync::Mutex;

use super::dual_horizon::BALANCED;
use super::subject::Watcher;
use super::uniform_tension::{rest_within_rim, steel, strip, without_rigid_motion};
use super::values::Figures;
use perilife_base::error::{Error, Result, fail_if};
use perilife_base::units::MM;
use perilife_growth::predict::Silent;
use perilife_plate::specimen::Point;
use perilife_points::body::Body;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::net::Net;
use perilife_scenes::bonds::BondState;
use perilife_scenes::failure::Failure;
use perilife_scenes::fronts::CRACKED;
use perilife_scenes::interaction::{Damaging, Interaction, Memory, Reaction};
use perilife_scenes::outcome::HistoryRow;
use perilife_scenes::quasi_static::relaxation::{Breaking, Loads, Relaxation, RestEnd};
use perilife_scenes::scene::{Procedure, SceneLaw};
use perilife_scenes::springs::Springs;
use perilife_scenes::{Fracture, Scene, SceneEnd, SceneObserver, SceneProgress, dynamics};

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
    fail_if!(done.end != SceneEnd::Done, Error::Mechanics(format!("the motion ended early: {}", done.end)));
    let largest = done.history.iter().map(|row| row.work.abs()).fold(0.0, f64::max);
    let lost = done.history.iter().map(|row| (row.kinetic + row.strain + row.fracture - row.work).abs());
    Ok(vec![("lost", 100.0 * lost.fold(0.0, f64::max) / largest)])
}

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
    let law = BondLaw { surface_correction: SurfaceCorrection::None, ..BALANCED };
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

const STRESS: f64 = 200e6;

/// What a scene of a plate in tension shows beside what the steel of [`steel`] does that has this Poisson's ratio: largest error of
/// displacement along the load over all points, percent of its own; ε along the load, by least squares over the middle quarter of the plate;
/// -ε across / ε along, likewise.
pub fn tension(text: &str, poisson_ratio: f64) -> Result<Figures> {
    let strain = STRESS / steel(poisson_ratio).youngs_modulus;
    let scene = Scene::from_toml(text, "tension", Path::new("."), &[])?;
    let found = perilife_scenes::run(&scene, &Silent)?;
    let grid = &found.grid;
    let mut seats = vec![[0.0; 2]; found.figures.points];
    for (place, point) in grid.point_at.iter().enumerate() {
        let Some(point) = point else { continue };
        let (column, row) = ((place % grid.columns) as f64, (place / grid.columns) as f64);
        seats[*point as usize] = [grid.origin[0] + column * grid.spacing, grid.origin[1] + row * grid.spacing];
    }
    let u = found.snapshots.last().map(|last| last.displacement.clone()).unwrap_or_default();
    let exact = |[x, y]: Point| [-poisson_ratio * strain * x, strain * y];
    let differences = seats.iter().zip(&u).map(|(&seat, u)| [u[0] - exact(seat)[0], u[1] - exact(seat)[1]]).collect();
    let differences = without_rigid_motion(&seats, differences);
    let relative = |(seat, d): (&Point, &Point)| 100.0 * (d[1] / exact(*seat)[1]).abs();
    let inside = |p: &Point| p[0].abs() < 0.125 && p[1].abs() < 0.25;
    let slope = |axis: usize| {
        let points = || seats.iter().zip(&differences).filter(|(seat, _)| inside(seat));
        let along: f64 = points().map(|(s, d)| s[axis] * (d[axis] + exact(*s)[axis])).sum();
        along / points().map(|(s, _)| s[axis] * s[axis]).sum::<f64>()
    };
    let error = seats.iter().zip(&differences).map(relative).fold(0.0, f64::max);
    Ok(vec![("error", error), ("strain", slope(1)), ("poisson_ratio", -slope(0) / slope(1))])
}

/// Strain g of the sheared square.
const SHEAR: f64 = 1e-3;

/// Largest error along x or y, percent of the point's own displacement, of a square of 50 x 50 points whose outermost rows have
/// the displacement of pure shear, `u = g y/2, v = g x/2`.
pub fn shear(poisson_ratio: f64, rows: usize) -> Result<Figures> {
    let law = BondLaw {
        kind: BondLawKind::OneBondTwoParameter,
        kernel: Kernel::Constant,
        rotation: Rotation::Resisted,
        surface_correction: SurfaceCorrection::VolumeAndSurface,
    };
    let body = Body::build(&strip(0.5, 0.5), &steel(poisson_ratio), &law, 0.01, 3.015, 0.0)?;
    let net = Net::of_body(&body);
    let exact: Vec<f64> = net.positions.iter().flat_map(|p| [0.5 * SHEAR * p[1], 0.5 * SHEAR * p[0]]).collect();
    let on_rim = |p: &Point| p[0].abs().max(p[1].abs()) > 0.25 - 0.01 * rows as f64;
    let held: Vec<bool> = net.positions.iter().flat_map(|p| [on_rim(p); 2]).collect();
    let u = rest_within_rim(&net, &exact, held)?;
    let error = |axis: usize| {
        let points = u.iter().zip(&exact).skip(axis).step_by(2);
        points.map(|(u, exact)| 100.0 * (u / exact - 1.0).abs()).fold(0.0, f64::max)
    };
    Ok(vec![("error", error(0).max(error(1)))])
}

/// Growth over which the largest load is looked for, spacings of G_c: the load of a longer crack is less by 4 % a spacing at 25
/// spacings a crack, by 2 % at 50.
const GROWTH: f64 = 5.0;

/// Branches at x, mm, of a plate in motion, by gaps of 3 mm.
pub fn branches(text: &str, x: f64) -> Result<Figures> {
    let found = perilife_scenes::run(&Scene::from_toml(text, "branching", Path::new("."), &[])?, &Silent)?;
    let heights = cracked_rows(&found, x * MM);
    let branches = usize::from(!heights.is_empty()) + heights.windows(2).filter(|pair| pair[1] - pair[0] > 3.0 * MM).count();
    Ok(vec![("branches", branches as f64)])
}

/// Largest load of a scene with these keys while its crack begins to grow, N.
/// Errors: those of the scene and its run.
pub fn growth_load(text: &str, set: &[String]) -> Result<f64> {
    let scene = Scene::from_toml(text, "square", Path::new("."), set)?;
    let energy = scene.material.fracture_energy.unwrap_or(f64::INFINITY) * scene.specimen.thickness * scene.model.spacing;
    let growing = Growing { energy: GROWTH * energy, so_far: Mutex::default() };
    let run = perilife_scenes::run(&scene, &growing);
    let HistoryRow { load, fracture, .. } = growing.look();
    // Stopped by its observer it has ended well.
    if fracture < growing.energy {
        run?;
    }
    Ok(load)
}

/// Stops a run where damage has taken an energy, J.
struct Growing {
    energy: f64,
    /// The last row with the largest load so far.
    so_far: Mutex<HistoryRow>,
}

impl Growing {
    fn look(&self) -> HistoryRow {
        *self.so_far.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl SceneObserver for Growing {
    fn step_done(&self, _: &SceneProgress) -> bool {
        self.look().fracture < self.energy
    }

    fn row(&self, row: &HistoryRow) {
        let load = row.load.max(self.look().load);
        *self.so_far.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = HistoryRow { load, ..*row };
    }
}

/// Heights of the points in the column at x that are cracked at the end, m, from below.
pub fn cracked_rows(run: &Fracture, x: f64) -> Vec<f64> {
    let (grid, last) = (&run.grid, run.snapshots.last());
    let column = ((x - grid.origin[0]) / grid.spacing).round() as usize;
    let damage = |row: usize| grid.point_at[row * grid.columns + column].zip(last).map(|(p, last)| last.damage[p as usize]);
    let is_cracked = |row: &usize| damage(*row).is_some_and(|damage| damage >= CRACKED);
    (0..grid.rows).filter(is_cracked).map(|row| grid.origin[1] + row as f64 * grid.spacing).collect()
}
