//! Rigid motions of a plate: the least supports of one that floats, components which, held, take its rigid motions and no load; and
//! what a turn of it costs, which should be nothing.

use super::{Net, NetBond};
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::distance;

/// A component that holds a rigid motion: its row `[u_x, u_y, ω]`, lengths over the size of the plate.
type RigidConstraint = [f64; 3];

/// Unknowns to be held besides those that are, at two distant points. A law whose tangential springs resist rotation does
/// not turn freely.
pub fn minimal_constraints(net: &Net, held: &[bool]) -> Vec<usize> {
    let carrying: Vec<usize> = (0..net.len()).filter(|&i| net.bonds_of(i).next().is_some()).collect();
    let Some(&first) = carrying.first() else { return Vec::new() };
    let away = |i: usize| distance(net.positions[i], net.positions[first]);
    let far = carrying.iter().copied().max_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(first);
    let row = |unknown: usize| -> RigidConstraint {
        let (point, component) = (unknown / net.unknowns, unknown % net.unknowns);
        let arm = [0, 1].map(|c| (net.positions[point][c] - net.positions[first][c]) / away(far).max(f64::MIN_POSITIVE));
        [[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]]][component]
    };
    let mut basis: Vec<RigidConstraint> = Vec::new();
    if net.unknowns == 2 && net.bonds.iter().any(|bond| bond.k_t != 0.0) {
        basis.push([0.0, 0.0, 1.0]);
    }
    for i in (0..held.len()).filter(|&i| held[i] && i % net.unknowns < 2) {
        add(&mut basis, row(i));
        if basis.len() == 3 {
            return Vec::new();
        }
    }
    let candidates = [first, far].into_iter().flat_map(|point| [0, 1].map(|c| point * net.unknowns + c));
    candidates.filter(|&unknown| add(&mut basis, row(unknown))).collect()
}

/// Adds what is new in a row to an orthonormal basis; whether there was something.
fn add(basis: &mut Vec<RigidConstraint>, mut row: RigidConstraint) -> bool {
    for known in basis.iter() {
        let along: f64 = row.iter().zip(known).map(|(a, b)| a * b).sum();
        row.iter_mut().zip(known).for_each(|(a, b)| *a -= along * b);
    }
    let size = row.iter().map(|a| a * a).sum::<f64>().sqrt();
    let is_new = size > 1e-6;
    if is_new {
        basis.push(row.map(|a| a / size));
    }
    is_new
}

/// Turn of the body, rad, and strain that it is compared with.
const TURN: f64 = 1e-3;
/// Energy of the turn over that of the strain that is more than round-off.
const COSTS: f64 = 1e-6;
/// The choice of springs that resist a turn, and the remedy.
pub const RESISTED: [&str; 2] = ["model.rotation = \"resisted\"", "use \"free\", the default"];

/// What it costs a body to turn as a whole: the strain energy of a rigid turn by 1 mrad over that of an extension by 1e-3 along y
/// (`u_y = ε y`), both from the `energy` of its bonds, J. The turn is the true one, `u = (R - 1) x`, where strain is `finite`, else the
/// linear one, `u = ω (-y, x)`. It must be zero; tangential springs between points that do not turn have
/// `8 c_t/(3 c_n + c_t) = 2 (C₁₁ - 3 C₁₂)/C₁₁` away from the rim. `None` where the extension costs nothing.
pub fn turning_cost(net: &Net, finite: bool, mut energy: impl FnMut(&[f64]) -> f64) -> Option<f64> {
    let mut of_field = |field: &dyn Fn(Point) -> [f64; 3]| {
        let points = net.positions.iter().flat_map(|&x| field(x).into_iter().take(net.unknowns));
        energy(&points.collect::<Vec<f64>>())
    };
    let (sin, versed) = if finite { (TURN.sin(), 2.0 * (0.5 * TURN).sin().powi(2)) } else { (TURN, 0.0) };
    let turn = of_field(&|[x, y]| [-versed * x - sin * y, sin * x - versed * y, TURN * net.rotation_length]);
    let strain = of_field(&|[_, y]| [0.0, TURN * y, 0.0]);
    (strain > 0.0).then(|| turn / strain)
}

/// [`turning_cost`] of the springs of a net that nothing has broken.
pub fn turning_cost_of_springs(net: &Net) -> Option<f64> {
    let energy = |u: &[f64]| -> f64 {
        let of = |bond: &NetBond| {
            let [e_n, e_t] = if net.unknowns == 3 { bond.deformation::<3>(u) } else { bond.deformation::<2>(u) };
            0.5 * (bond.k_n * e_n * e_n + bond.k_t * e_t * e_t)
        };
        net.bonds.iter().map(of).sum()
    };
    turning_cost(net, false, energy)
}

/// What is to be said of a body that a turn costs energy: which choice brings it, and which is free of it; `None` where it is
/// round-off.
pub fn turning_warning(cost: Option<f64>, [choice, remedy]: [&str; 2]) -> Option<String> {
    let percent = 100.0 * cost.filter(|cost| *cost > COSTS)?;
    Some(format!(
        "rotation: {choice}: rigid rotation by 1 mrad costs {percent:.3} % of the energy of 1e-3 strain, and should cost none: too \
         stiff in shear, in bending and near cracks; {remedy}"
    ))
}
