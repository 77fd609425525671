//! Damped motion to rest, of any interaction.

use perilife_points::body::Body;
use perilife_points::bond_law::{BondLaw, BondLawKind, Rotation};
use perilife_points::net::Net;
use perilife_scenes::bonds::BondState;
use perilife_scenes::boundary::{Boundary, Motion};
use perilife_scenes::failure::Failure;
use perilife_scenes::interaction::{Damaging, Interaction, Memory, Reaction};
use perilife_scenes::quasi_static::relaxation::{Breaking, Loads, Relaxation, RestEnd, Rested};
use perilife_scenes::scene::{Scene, SceneLaw};
use perilife_scenes::springs::Springs;

use crate::support::scenes::{MM, law, pulled};

/// As the sources have it, and with free rotation.
const SOURCE_LAW: BondLaw = law(BondLawKind::TwoParameter, Rotation::Resisted);
const FREE: BondLaw = law(BondLawKind::TwoParameter, Rotation::Free);

/// Net, loads and displacement at full load of a scene.
fn setting(scene: &Scene) -> (Net, Vec<bool>, Vec<f64>) {
    let SceneLaw::Bonds(law) = scene.model.law else { panic!("a bond law") };
    let model = &scene.model;
    let body = Body::build(&scene.specimen, &scene.material, &law, model.spacing, model.horizon_ratio, 0.0).unwrap();
    let net = Net::of_body(&body);
    let boundary = Boundary::of(scene, &net).unwrap();
    let (mut held, mut u) = (vec![false; net.len() * net.unknowns], vec![0.0; net.len() * net.unknowns]);
    for at in &boundary.held {
        let i = at.point as usize * net.unknowns + at.component;
        let Motion::Displacement(value) = at.motion else { panic!("a displacement") };
        (held[i], u[i]) = (true, value);
    }
    (net, held, u)
}

fn relax(settings: Relaxation, failure: Failure, law: BondLaw) -> (Rested, BondState, Vec<f64>) {
    let scene = pulled(20.0 * MM, 40.0 * MM, 1.0 * MM, 0.02 * MM, law);
    let (net, held, mut u) = setting(&scene);
    let mut bonds = BondState::new(&net, &vec![false; net.len()]);
    let mut springs = Springs::new(&net, failure, false);
    let external = vec![0.0; u.len()];
    let rested = settings.relax(&mut springs, &mut bonds, Loads { held: &held, external: &external }, &mut u);
    (rested, bonds, u)
}

#[test]
fn a_pulled_plate_comes_to_rest_and_stays_there() {
    for law in [SOURCE_LAW, FREE] {
        let (rested, _, u) = relax(Relaxation::default(), Failure::Never, law);
        assert_eq!(rested.end, RestEnd::AtRest);
        assert!(rested.residual <= 1e-6 && rested.evaluations < 3000, "{} evaluations", rested.evaluations);
        // More tightly, the same place: residual 1e-6 is displacement within 1e-4 of the largest.
        let tight = Relaxation { tolerance: 1e-11, ..Relaxation::default() };
        let (_, _, exact) = relax(tight, Failure::Never, law);
        let apart = u.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-4 * 0.02 * MM, "{apart:e}");
    }
}

#[test]
fn a_swing_breaks_no_bond_that_equilibrium_spares() {
    let (_, _, u) = relax(Relaxation::default(), Failure::Never, SOURCE_LAW);
    let scene = pulled(20.0 * MM, 40.0 * MM, 1.0 * MM, 0.02 * MM, SOURCE_LAW);
    let (net, ..) = setting(&scene);
    let stretch = |b: &perilife_points::net::NetBond| {
        let (i, j) = (2 * b.from as usize, 2 * b.to as usize);
        ((u[j] - u[i]) * b.normal[0] + (u[j + 1] - u[i + 1]) * b.normal[1]) / b.length
    };
    let largest = net.bonds.iter().map(stretch).fold(0.0, f64::max);
    let limits = |share: f64| Failure::Stretch(vec![share * largest; net.len()]);
    let broken = |breaking, share| {
        let (rested, bonds, _) = relax(Relaxation { breaking, ..Relaxation::default() }, limits(share), SOURCE_LAW);
        assert_eq!(rested.end, RestEnd::AtRest);
        assert_eq!(rested.reaction.broken, bonds.broken(&net));
        rested.reaction.broken
    };
    assert_eq!(broken(Breaking::AtRest, 1.01), 0);
    assert!(broken(Breaking::AtRest, 0.99) > 0);
    assert_eq!(broken(Breaking::Never, 0.5), 0);
}

/// Springs that are stiffer than they say.
struct Understated<'n>(Springs<'n>, f64);

impl Interaction for Understated<'_> {
    fn unknowns(&self) -> usize {
        self.0.unknowns()
    }

    fn internal_force(&mut self, u: &[f64], bonds: &mut BondState, damaging: Damaging, force: &mut [f64]) -> Reaction {
        self.0.internal_force(u, bonds, damaging, force)
    }

    fn stiffness_bound(&self, bonds: &BondState) -> Vec<[f64; 2]> {
        self.0.stiffness_bound(bonds).into_iter().map(|bound| bound.map(|b| self.1 * b)).collect()
    }

    fn memory(&self) -> Memory {
        self.0.memory()
    }

    fn restore(&mut self, memory: &Memory, bonds: &BondState) -> bool {
        self.0.restore(memory, bonds)
    }
}

#[test]
fn a_blow_up_is_found_within_ten_steps_and_a_short_run_is_named() {
    let scene = pulled(20.0 * MM, 40.0 * MM, 1.0 * MM, 0.02 * MM, FREE);
    let (net, held, start) = setting(&scene);
    let external = vec![0.0; start.len()];
    let loads = Loads { held: &held, external: &external };
    let mut bonds = BondState::new(&net, &vec![false; net.len()]);
    let mut u = start.clone();
    let mut stiff = Understated(Springs::new(&net, Failure::Never, false), 0.25);
    let rested = Relaxation::default().relax(&mut stiff, &mut bonds, loads, &mut u);
    assert_eq!(rested.end, RestEnd::BlownUp);
    assert!(rested.evaluations <= 10, "{}", rested.evaluations);
    assert!(u.iter().all(|u| u.is_finite()));

    let mut u = start;
    let mut springs = Springs::new(&net, Failure::Never, false);
    let rested = Relaxation { iterations: 5, ..Relaxation::default() }.relax(&mut springs, &mut bonds, loads, &mut u);
    assert_eq!(rested.end, RestEnd::NoConvergence);
    assert!(rested.residual > 1e-6);
}
