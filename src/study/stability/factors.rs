//! K of the initial tips: the lattice, the horizon against what it has to resolve (crack, ligament, hole, another crack), modes, a
//! ligament that goes, nodes.

use std::f64::consts::PI;

use super::{Run, SWEEP, Sweep};
use crate::cases::{NODES, STRESS, case, cracked_plate, cracks, middle_tension, pulled_plate};
use crate::collinear::Collinear;
use crate::scene::{Scene, factors, percent, tips};
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;
use perilife_growth::case::{Case, Model};
use perilife_growth::cracks::steering::kink_angle;
use perilife_points::spacing::HORIZON_RATIO;

/// Key of points of 1 mm.
const POINTS: &str = "model.spacing_mm=1";

/// Angle of the rows against the crack.
pub const LATTICE_ANGLE: Sweep = Sweep {
    name: "lattice_angle",
    about: "K_I of a middle tension panel, 2a/W 0.4, against the handbook (Tada, 0.1 %)",
    parameter: "angle of the crack to the rows",
    unit: "degrees",
    values: &[0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 90.0],
    bound_percent: 1.0,
    methods: &[("tip_field", |angle, run| panel(run, &format!("{POINTS} model.lattice_angle_deg={angle}")))],
    ..SWEEP
};

/// A middle tension panel of 100 mm, 2a/W 0.4.
fn panel(run: &Run, keys: &str) -> Result<f64> {
    Scene::Handbook(middle_tension(100.0, 20.0, "")).error(keys, run)
}

/// Where a hole with a crack lies between the points.
pub const HOLE_OFFSET: Sweep = Sweep {
    name: "hole_offset",
    about: "K_I of a crack of 6 mm that starts at a hole of 12 mm, at 20 places of the hole within a spacing, against the plate on nodes",
    parameter: "number of the place",
    values: &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0, 20.0],
    usual: 1.0,
    is_continuous: false,
    methods: &[("tip_field", offset_hole)],
    ..SWEEP
};

fn offset_hole(number: f64, run: &Run) -> Result<f64> {
    // Places that fill a square evenly, whatever their number: the generalised golden ratio (Roberts 2018).
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let [x, y] = [PLASTIC, PLASTIC * PLASTIC].map(|root| (number / root).fract());
    let text = plate_with_hole([60.0, 90.0], ([x, y], 12.0), [[x + 6.0, y], [x + 12.0, y]]);
    Scene::AgainstNodes(text, 0).error(POINTS, run)
}

/// A pulled plate of some width and length with a hole (centre, diameter) and a crack, mm.
fn plate_with_hole([width, length]: [f64; 2], ([x, y], diameter): ([f64; 2], f64), crack: [[f64; 2]; 2]) -> String {
    let hole = format!("holes = [{{ x_mm = {x}, y_mm = {y}, diameter_mm = {diameter} }}]");
    pulled_plate(&format!("width_mm = {width}\nlength_mm = {length}\n{hole}\n{}", cracks(&[crack])))
}

/// Width of the plate: no method may know a unit of length.
pub const PLATE_SIZE: Sweep = Sweep {
    name: "plate_size",
    about: "K_I of a middle tension panel of 50 spacings, 2a/W 0.4, against the handbook (Tada, 0.1 %)",
    parameter: "width of the plate",
    unit: "mm",
    values: &[0.1, 1.0, 10.0, 100.0, 1e3, 1e4],
    usual: 100.0,
    methods: &[
        ("tip_field", |width, run| sized(width, run, &format!("model.spacing_mm={}", 0.02 * width))),
        ("element_free_galerkin", |width, run| sized(width, run, &format!("model.spacing_mm={} {NODES}", width / 14.0))),
    ],
    ..SWEEP
};

fn sized(width: f64, run: &Run, keys: &str) -> Result<f64> {
    Scene::Handbook(middle_tension(width, 0.2 * width, "")).error(keys, run)
}

/// The largest of the errors at shares of a spacing by which plates are wider or cracks shifted: where a tip lies between points is luck.
fn worst(error: impl Fn(f64) -> Result<f64>) -> Result<f64> {
    [0.0, 0.35, 0.7].into_iter().try_fold(0.0_f64, |worst, place| {
        let error = error(place)?;
        // No number stays none.
        Ok(if error.abs() <= worst.abs() { worst } else { error })
    })
}

/// Horizon over half the length of a crack with two tips. Here and below the spacing is 1 mm, and the plate grows with what is resolved, so
/// that its share of the error stays the same.
pub const CRACK_LENGTH: Sweep = Sweep {
    name: "crack_length",
    about: "K_I of a crack with two tips in a panel of 2a/W 0.25 against the handbook (Tada, 0.1 %)",
    parameter: "horizon over half the crack length",
    values: &[0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.25, 1.6, 2.0],
    usual: 0.3,
    methods: &[("tip_field", half_crack)],
    ..SWEEP
};

fn half_crack(ratio: f64, run: &Run) -> Result<f64> {
    let half = HORIZON_RATIO / ratio;
    worst(|place| Scene::Handbook(middle_tension(8.0 * half + place, half, "")).error(POINTS, run))
}

/// Horizon over the length of an edge crack.
pub const EDGE_CRACK_LENGTH: Sweep = Sweep {
    name: "edge_crack_length",
    about: "K_I of an edge crack of a/W 0.17 against the plate on nodes",
    parameter: "horizon over the crack length",
    methods: &[("tip_field", edge_crack)],
    ..CRACK_LENGTH
};

fn edge_crack(ratio: f64, run: &Run) -> Result<f64> {
    let length = HORIZON_RATIO / ratio;
    worst(|place| {
        let width = 6.0 * length + place;
        let text = cracked_plate(width, 1.5 * width, &[[[-0.5 * width, 0.0], [length - 0.5 * width, 0.0]]]);
        Scene::AgainstNodes(text, 0).error(POINTS, run)
    })
}

/// Horizon over the ligament between a tip and the edge.
pub const LIGAMENT: Sweep = Sweep {
    name: "ligament",
    about: "K_I of a panel of 2a/W 0.75 against the handbook (Tada, 0.1 %)",
    parameter: "horizon over the ligament",
    methods: &[("tip_field", ligament)],
    ..CRACK_LENGTH
};

fn ligament(ratio: f64, run: &Run) -> Result<f64> {
    let left = HORIZON_RATIO / ratio;
    worst(|place| {
        let width = 8.0 * left + place;
        Scene::Handbook(middle_tension(width, 0.5 * width - left, "")).error(POINTS, run)
    })
}

/// Horizon over the distance of a tip from the rim of a hole ahead of it.
pub const HOLE_DISTANCE: Sweep = Sweep {
    name: "hole_distance",
    about: "K_I of an edge crack of 20 mm before a hole of 16 mm, against the plate on nodes",
    parameter: "horizon over the distance to a hole",
    methods: &[("tip_field", before_hole)],
    ..CRACK_LENGTH
};

fn before_hole(ratio: f64, run: &Run) -> Result<f64> {
    worst(|place| {
        let tip = place - 20.0;
        let centre = [tip + HORIZON_RATIO / ratio + 8.0, 0.0];
        Scene::AgainstNodes(plate_with_hole([80.0, 120.0], (centre, 16.0), [[-40.0, 0.0], [tip, 0.0]]), 0).error(POINTS, run)
    })
}

/// Horizon over the diameter of a hole.
pub const HOLE_DIAMETER: Sweep = Sweep {
    name: "hole_diameter",
    about: "K_I of a crack whose tip lies half a diameter above the rim of a hole, against the plate on nodes",
    parameter: "horizon over the diameter of a hole",
    methods: &[("tip_field", beside_hole)],
    ..CRACK_LENGTH
};

fn beside_hole(ratio: f64, run: &Run) -> Result<f64> {
    // Hole, crack and plate in one proportion.
    let diameter = HORIZON_RATIO / ratio;
    worst(|place| {
        let x = diameter + place;
        let crack = [[-diameter, 0.0], [x, 0.0]];
        let text = plate_with_hole([8.0 * diameter, 10.0 * diameter], ([x, -diameter], diameter), crack);
        Scene::AgainstNodes(text, 1).error(POINTS, run)
    })
}

/// Horizon over the distance between the tips of two cracks on one line.
pub const CRACK_DISTANCE: Sweep = Sweep {
    name: "crack_distance",
    about: "K_I of the inner tips of two collinear cracks of 24 mm against the closed form (Tada, 0.3 % with the width)",
    parameter: "horizon over the distance to another crack",
    methods: &[("tip_field", collinear)],
    ..CRACK_LENGTH
};

fn collinear(ratio: f64, run: &Run) -> Result<f64> {
    let inner = 0.5 * HORIZON_RATIO / ratio;
    let outer = inner + 24.0;
    let width = 8.0 * outer;
    let known = STRESS * Collinear { inner: inner * MM, outer: outer * MM }.intensity_in(width * MM)[0];
    worst(|place| {
        let [a, b, c, d] = [-outer, -inner, inner, outer].map(|x| [x + place, 0.0]);
        let text = cracked_plate(width, 1.5 * width, &[[a, b], [c, d]]);
        Scene::Tip { text, tip: 1, known, unit: 1.0, truth: "closed form (Tada, 0.3 % with the width)" }.error(POINTS, run)
    })
}

/// Mode mixity of a first kink.
pub const KINK_MIXITY: Sweep = Sweep {
    name: "kink_mixity",
    about: "first kink of a slant crack of 48 mm in a wide plate against the largest circumferential stress (Erdogan and Sih 1963), \
            in percent of the kink in pure mode II, 70.5 degrees",
    parameter: "mixity atan(K_II / K_I)",
    unit: "degrees",
    values: &[0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 75.0, 80.0, 85.0, 88.0, 90.0],
    methods: &[
        ("tip_field", |mixity, _| kink(mixity, "model.spacing_mm=2")),
        ("element_free_galerkin", |mixity, _| kink(mixity, NODES)),
    ],
    ..SWEEP
};

/// The kink of a crack whose normal makes this angle with the load: K_II / K_I is its tangent.
fn kink(mixity: f64, keys: &str) -> Result<f64> {
    let (sin, cos) = mixity.to_radians().sin_cos();
    let half = [24.0 * cos, 24.0 * sin];
    let found = factors(&case(&cracked_plate(400.0, 400.0, &[[half.map(|x| -x), half]]), keys)?, 1)?;
    if found[0].hypot(found[1]) < 1e-3 * STRESS * (PI * 24.0 * MM).sqrt() {
        return Err(Error::Mechanics("the load does not open or shear the crack".to_owned()));
    }
    // The upper face of a crack that rises to the right is pulled to the right: K_II > 0 at the right tip.
    let theory = kink_angle([cos * cos, sin * cos]);
    Ok(100.0 * (kink_angle(found) - theory) / kink_angle([0.0, 1.0]).abs())
}

/// Stress along the crack.
pub const BIAXIALITY: Sweep = Sweep {
    name: "biaxiality",
    about: "K_I against that without stress along the crack, and T against T at 0 plus that stress; square plate, 2a/W 0.2",
    parameter: "stress along the crack over stress across it",
    values: &[-4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0],
    bound_percent: 1.0,
    methods: &[("tip_field: K_I", |ratio, _| biaxial(ratio, false)), ("tip_field: T", |ratio, _| biaxial(ratio, true))],
    ..SWEEP
};

fn biaxial(ratio: f64, is_t: bool) -> Result<f64> {
    let text = cracked_plate(150.0, 150.0, &[[[-15.0, 0.0], [15.0, 0.0]]]);
    let at = |ratio: f64| -> Result<[f64; 2]> {
        let case = case(&text, &format!("{POINTS} loading.stress_parallel_ratio={ratio}"))?;
        let tip = tips(&case)?[0];
        let k = tip.factors.map_or(f64::NAN, |factors| factors[0]);
        Ok([k, tip.t_stress.unwrap_or(f64::NAN) / case.loading.maximum])
    };
    let [[k, t], [k_alone, t_alone]] = [at(ratio)?, at(0.0)?];
    // T is of the size of the stress across the crack.
    Ok(if is_t { 100.0 * (t - t_alone - ratio) } else { percent(k, k_alone) })
}

/// What is left between a tip and the edge, in spacings: the plate becomes a mechanism.
pub const LAST_LIGAMENT: Sweep = Sweep {
    name: "last_ligament",
    about: "panel of 80 spacings: K_I of an iterative solver against that of the factorised equilibrium, the same equations",
    parameter: "ligament over spacing",
    values: &[0.6, 0.8, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 20.0],
    usual: 20.0,
    bound_percent: 0.1,
    methods: &[("window", |left, _| by_solver(left, "window")), ("multigrid", |left, _| by_solver(left, "multigrid"))],
    ..SWEEP
};

fn by_solver(left: f64, solver: &str) -> Result<f64> {
    let text = middle_tension(80.0, 40.0 - left, "spacing_mm = 1");
    let k = |solver: &str| -> Result<f64> { Ok(factors(&case(&text, &format!("model.solver={solver}"))?, 0)?[0]) };
    Ok(percent(k(solver)?, k("direct")?))
}

/// Radius of influence of nodes.
pub const INFLUENCE_RADIUS: Sweep = Sweep {
    name: "influence_radius",
    about: "K_I of a middle tension panel, 2a/W 0.4, against the handbook (Tada, 0.1 %)",
    parameter: "radius of influence over the spacing of nodes",
    values: &[1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0],
    usual: 2.5,
    bound_percent: 1.0,
    methods: &[
        ("element_free_galerkin, linear basis", |radius, run| by_radius(radius, run, "linear")),
        ("element_free_galerkin, quadratic basis", |radius, run| by_radius(radius, run, "quadratic")),
    ],
    ..SWEEP
};

fn by_radius(radius: f64, run: &Run, basis: &str) -> Result<f64> {
    // The key begins at 1.5.
    on_nodes(run, &format!("model.basis={basis}"), |case| {
        let mut nodes = case.nodes();
        nodes.resolution.support = radius;
        case.model = Model::Nodes(nodes);
    })
}

/// The panel of [`panel`] on nodes, changed as no key can.
fn on_nodes(run: &Run, keys: &str, change: impl FnOnce(&mut Case)) -> Result<f64> {
    let text = middle_tension(100.0, 20.0, "");
    let mut case = case(&text, &format!("{NODES} {keys}"))?;
    change(&mut case);
    Ok(Scene::Handbook(text).found(&case, &[], run)?.error_percent())
}

/// Where the crack lies between nodes.
pub const NODE_OFFSET: Sweep = Sweep {
    name: "node_offset",
    about: "K_I of a crack in the middle of a panel, 2a/W 0.4, moved along the load between rows of nodes, against the handbook (Tada, 0.1 %)",
    parameter: "distance of the crack from the middle over the spacing of nodes",
    values: &[0.0, 1e-9, 1e-6, 1e-3, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99],
    usual: 0.0,
    methods: &[("element_free_galerkin", |share, run| on_nodes(run, "", |case| move_crack(case, share)))],
    ..INFLUENCE_RADIUS
};

fn move_crack(case: &mut Case, share: f64) {
    let by = share * case.nodes().resolution.far;
    for crack in &mut case.specimen.cracks {
        crack.from[1] += by;
        crack.to[1] += by;
    }
    case.specimen.tips.iter_mut().for_each(|tip| tip.position[1] += by);
    case.specimen.crack_plane_y = None;
}
