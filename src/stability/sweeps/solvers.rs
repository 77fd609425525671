//! Solvers: density of relaxation, and a ligament that goes.

use super::super::exact::{factors, middle_tension, percent};
use super::super::{Method, Run, Sweep};
use crate::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use crate::error::{Error, Result};
use crate::fracture::bonds::BondState;
use crate::fracture::failure::Failure;
use crate::fracture::interaction::{Damaging, Interaction, Memory, Reaction};
use crate::fracture::quasi_static::relaxation::{Breaking, Loads, Relaxation, RestEnd};
use crate::fracture::scene::{Scene, SceneLaw};
use crate::fracture::{self, springs::Springs};
use crate::material::{Material, Plane};
use crate::units::MM;
use crate::verify::uniform_tension::strip;

/// Density of adaptive dynamic relaxation.
pub const DENSITY_FACTOR: Sweep = Sweep {
    name: "density_factor",
    about: "plate of 30 x 40 points in uniform strain, held at its rim: largest error of a displacement over strain times length",
    parameter: "fictitious density over the least stable one (Gershgorin)",
    unit: "",
    values: &[0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.5, 2.0, 5.0, 10.0, 100.0, 1000.0],
    usual: 1.0,
    is_continuous: true,
    bound_percent: 0.1,
    methods: &[Method { name: "adaptive_dynamic_relaxation", measure: by_density }],
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

fn by_density(factor: f64, _: &Run) -> Result<f64> {
    const STRAIN: f64 = 1e-3;
    const NU: f64 = 0.25;
    let law = BondLaw {
        kind: BondLawKind::TwoParameter,
        kernel: Kernel::Conical,
        rotation: Rotation::Resisted,
        surface_correction: SurfaceCorrection::None,
    };
    let material = Material::elastic(200e9, NU, Plane::Stress);
    let scene = Scene::bare("density", strip(30.0 * MM, 40.0 * MM), material, SceneLaw::Bonds(law), MM);
    let net = fracture::build(&scene)?.0;
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

/// What is left between a tip and the edge, in spacings: the plate becomes a mechanism.
pub const LAST_LIGAMENT: Sweep = Sweep {
    name: "last_ligament",
    about: "panel of 80 spacings: K_I of an iterative solver against that of the factorised equilibrium, the same equations",
    parameter: "ligament over spacing",
    unit: "",
    values: &[0.6, 0.8, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 20.0],
    usual: 20.0,
    is_continuous: true,
    bound_percent: 0.1,
    methods: &[
        Method { name: "window", measure: |left, run| by_solver(left, run, "window") },
        Method { name: "multigrid", measure: |left, run| by_solver(left, run, "multigrid") },
        Method { name: "adaptive_dynamic_relaxation", measure: |left, run| by_solver(left, run, "adaptive_dynamic_relaxation") },
    ],
};

fn by_solver(left: f64, run: &Run, solver: &str) -> Result<f64> {
    let text = middle_tension(80.0, 40.0 - left, 1.0);
    let factor = |solver: &str| -> Result<f64> { Ok(factors(&run.case(&text, &[&format!("model.solver={solver}")])?, 0)?[0]) };
    Ok(percent(factor(solver)?, factor("direct")?))
}
