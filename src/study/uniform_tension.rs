//! Errors of a plate in uniform tension, and plates with holes, slots and slanted edges that can be in it.

use super::values::{Figures, Keys};
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;
use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::geometry::{direction, edges};
use perilife_plate::specimen::{Hole, Load, Point, Slot, Specimen, SpecimenKind};
use perilife_points::body::Body;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::net::Net;
use perilife_points::solver::field::Layout;
use perilife_points::solver::{Equilibrium, SolverKind, Symmetry};
use perilife_points::state::Bonds;
use perilife_scenes::bonds::BondState;
use perilife_scenes::quasi_static::equilibrium;
use perilife_scenes::quasi_static::equilibrium::FullLoad;

/// Largest errors of displacement in percent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Along the load, over all points.
    pub along: f64,
    /// Along the load, over points with all their neighbours.
    pub along_inside: f64,
    /// Across the load, over all points.
    pub across: f64,
    /// Largest difference of displacement from the exact one over the largest exact displacement.
    pub overall: f64,
}

/// Errors of a plate whose rim carries the traction of unit tension along y; E = 200 GPa, plane stress. The error of a point is
/// relative to its own exact displacement, rigid motion taken off.
pub fn uniform_tension(
    specimen: &Specimen,
    law: &BondLaw,
    poisson_ratio: f64,
    spacing: f64,
    horizon_ratio: f64,
    angle: f64,
) -> Result<Errors> {
    uniform_tension_with((None, Symmetry::Auto), specimen, law, poisson_ratio, (spacing, horizon_ratio, angle))
}

/// [`uniform_tension`] by any solver, by factorisation without one, with or without symmetry; a lattice of `(spacing, horizon_ratio, angle)`.
pub fn uniform_tension_with(
    (solver, symmetry): (Option<SolverKind>, Symmetry),
    specimen: &Specimen,
    law: &BondLaw,
    poisson_ratio: f64,
    (spacing, horizon_ratio, angle): (f64, f64, f64),
) -> Result<Errors> {
    let material = steel(poisson_ratio);
    let body = Body::build(specimen, &material, law, spacing, horizon_ratio, angle)?;
    let bonds = Bonds::new(&body);
    // Unit strain.
    let stress = material.youngs_modulus;
    let mut displacement = Vec::new();
    Equilibrium::new(solver, symmetry, &body, &bonds, stress).solve(&body, &bonds, &mut displacement)?;
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let seats: Vec<Point> = body.points.iter().map(|&place| body.lattice.position(place as usize)).collect();
    let exact: Vec<Point> = seats.iter().map(|[x, y]| [-poisson_ratio * x, *y]).collect();
    let differences: Vec<Point> = body
        .points
        .iter()
        .zip(&exact)
        .map(|(&place, exact)| {
            let at = layout.index(place as usize);
            let u = body.lattice.from_axes([displacement[at], displacement[at + layout.stride]]);
            [u[0] - exact[0], u[1] - exact[1]]
        })
        .collect();
    let differences = without_rigid_motion(&seats, differences);
    let full = 2 * body.stencil.bonds.len();
    let mut errors = Errors { along: 0.0, along_inside: 0.0, across: 0.0, overall: 0.0 };
    let longest = exact.iter().fold(0.0_f64, |l, u| l.max(u[1].abs()));
    for ((&place, exact), difference) in body.points.iter().zip(&exact).zip(&differences) {
        let relative = |i: usize| {
            // A point on the axis of symmetry has no displacement to compare with.
            if exact[i].abs() < 1e-6 * longest { 0.0 } else { 100.0 * (difference[i] / exact[i]).abs() }
        };
        errors.along = errors.along.max(relative(1));
        errors.across = errors.across.max(relative(0));
        errors.overall = errors.overall.max(100.0 * difference[0].hypot(difference[1]) / longest);
        if bonds.intact_at(&body, place as usize) == full {
            errors.along_inside = errors.along_inside.max(relative(1));
        }
    }
    Ok(errors)
}

/// Displacements at rest of a net whose held unknowns have those given.
pub(super) fn rest_within_rim(net: &Net, given: &[f64], held: Vec<bool>) -> Result<Vec<f64>> {
    let size = given.len();
    let motion = given.iter().zip(&held).map(|(u, held)| if *held { *u } else { 0.0 }).collect();
    let full = FullLoad { motion, external: vec![0.0; size], held, pins: Vec::new() };
    let mut bonds = BondState::new(net, &vec![true; net.len()]);
    let mut shape = equilibrium::Shape { u: vec![0.0; size], force: vec![0.0; size], strain: 0.0 };
    equilibrium::Equilibrium::new(net, &[], &full)?.solve(&mut bonds, &mut shape)?;
    Ok(shape.u)
}

/// E = 200 GPa, plane stress.
pub fn steel(poisson_ratio: f64) -> Material {
    Material::elastic(200e9, poisson_ratio, Plane::Stress)
}

/// Takes mean displacement and mean rotation off a field (least squares).
pub(super) fn without_rigid_motion(seats: &[Point], field: Vec<Point>) -> Vec<Point> {
    let count = seats.len() as f64;
    let mean = |points: &[Point]| points.iter().fold([0.0; 2], |m, p| [m[0] + p[0] / count, m[1] + p[1] / count]);
    let (centre, drift) = (mean(seats), mean(&field));
    let arm = |seat: &Point| [seat[0] - centre[0], seat[1] - centre[1]];
    let inertia: f64 = seats.iter().map(arm).map(|[x, y]| x * x + y * y).sum();
    let turn: f64 = seats.iter().map(arm).zip(&field).map(|([x, y], u)| x * u[1] - y * u[0]).sum::<f64>() / inertia;
    let rest = |(seat, u): (&Point, &Point)| {
        let [x, y] = arm(seat);
        [u[0] - drift[0] + turn * y, u[1] - drift[1] - turn * x]
    };
    seats.iter().zip(&field).map(rest).collect()
}

/// A plate that stays in uniform tension whatever is cut out of it, since what is cut out is replaced by its traction.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// What it has beside straight edges along the rows.
    pub name: &'static str,
    pub specimen: Specimen,
    /// Angle of the rows to the edges, rad.
    pub angle: f64,
}

pub fn shapes() -> Vec<Shape> {
    let plain = || strip(60.0 * MM, 80.0 * MM);
    let shape = |name, specimen| Shape { name, specimen, angle: 0.0 };
    let hole = |radius: f64| {
        let mut specimen = plain();
        specimen.holes.push(Hole { centre: [3.3 * MM, 1.7 * MM], radius: radius * MM });
        loaded_inside(specimen)
    };
    let slot = |from: Point, to: Point, width: f64| {
        let mut specimen = plain();
        specimen.slots.push(Slot { from: from.map(|x| x * MM), to: to.map(|x| x * MM), width: width * MM });
        loaded_inside(specimen)
    };
    vec![
        shape("straight edges", plain()),
        shape("hole of 6 mm", hole(3.0)),
        shape("hole of 20 mm", hole(10.0)),
        shape("slanted edge", chamfered(plain())),
        shape("slanted slot of 2 mm", slot([-8.0, -5.0], [9.0, 4.0], 2.0)),
        shape("edge slot of 4 mm", slot([-30.0, 0.3], [-12.0, 0.3], 4.0)),
        shape("edge slot of 2 mm", slot([-30.0, 0.0], [-12.0, 0.0], 2.0)),
        Shape { name: "rows at 45 degrees", specimen: plain(), angle: 45.0_f64.to_radians() },
        Shape { name: "rows at 15 degrees", specimen: plain(), angle: 15.0_f64.to_radians() },
    ]
}

/// A rectangle of thickness 1 m under unit tension on its ends y = ±length/2.
pub fn strip(width: f64, length: f64) -> Specimen {
    Specimen::strip(SpecimenKind::Plate, width, length, 1.0)
}

/// The rectangle with its upper left corner cut off.
fn chamfered(mut specimen: Specimen) -> Specimen {
    let [x, y] = specimen.outline[2];
    let (a, b) = ([-x / 3.0, y], [-x, y / 4.0]);
    specimen.outline.splice(3.., [a, b]);
    specimen.loads[0] = Load::Edge { from: specimen.outline[2], to: a, traction: [0.0, 1.0] };
    specimen.loads.push(Load::Edge { from: a, to: b, traction: [0.0, -direction(a, b)[0]] });
    specimen
}

/// Loads holes and slots by the traction of the material that is not there.
fn loaded_inside(mut specimen: Specimen) -> Specimen {
    // Holes as polygons of many sides.
    const SIDES: usize = 360;
    let round = specimen.holes.iter().map(|hole| {
        let corner = |i: usize| {
            let (sin, cos) = (2.0 * std::f64::consts::PI * i as f64 / SIDES as f64).sin_cos();
            [hole.centre[0] + hole.radius * cos, hole.centre[1] + hole.radius * sin]
        };
        (0..SIDES).map(corner).collect::<Vec<Point>>()
    });
    let voids: Vec<Vec<Point>> = round.chain(specimen.slots.iter().map(|slot| slot.corners().to_vec())).collect();
    for (a, b) in voids.iter().flat_map(|polygon| edges(polygon)) {
        // Out of the material is into the void, to the left of its counter-clockwise rim.
        specimen.loads.push(Load::Edge { from: a, to: b, traction: [0.0, direction(a, b)[0]] });
    }
    specimen
}

/// Size along the load and across it, and spacing, m. Exact: `u = p x / E` along and `-ν p y / E` across; the published figures put the load
/// on the last column of points, the balanced correction brings its own, consistent loads.
const SIZE: [f64; 2] = [1.0, 0.5];
const SPACING: f64 = 0.01;
const HORIZON_RATIO: f64 = 3.015;

/// The default law with the balanced correction.
pub const BALANCED: BondLaw = BondLaw {
    kind: BondLawKind::TwoParameter,
    kernel: Kernel::Conical,
    rotation: Rotation::Free,
    surface_correction: SurfaceCorrection::Balanced,
};

/// Bond laws that springs can carry, with all kernels, rotations and corrections; without tangential springs rotation has no say.
pub fn laws() -> impl Iterator<Item = BondLaw> {
    let springs = BondLawKind::ALL.iter().filter(|kind| **kind != BondLawKind::StateBased);
    let with_kernels = springs.flat_map(|&kind| Kernel::ALL.iter().map(move |&kernel| (kind, kernel)));
    let with_rotations =
        with_kernels.flat_map(|(kind, kernel)| Rotation::ALL.iter().map(move |&rotation| (kind, kernel, rotation)));
    let told_apart = with_rotations.filter(|(kind, _, rotation)| kind.is_two_parameter() || *rotation == Rotation::Resisted);
    told_apart.flat_map(|(kind, kernel, rotation)| {
        SurfaceCorrection::ALL.iter().map(move |&surface_correction| BondLaw { kind, kernel, rotation, surface_correction })
    })
}

fn errors(law: &BondLaw, poisson_ratio: f64) -> Result<Errors> {
    uniform_tension(&strip(SIZE[1], SIZE[0]), law, poisson_ratio, SPACING, HORIZON_RATIO, 0.0)
}

pub fn plate(keys: &Keys<'_>) -> Result<Figures> {
    let law = BondLaw {
        kind: keys.get("law")?,
        kernel: keys.get("kernel")?,
        rotation: keys.get("rotation")?,
        surface_correction: keys.get("correction")?,
    };
    let found = errors(&law, keys.get("nu")?)?;
    Ok(vec![("along", found.along), ("along_inside", found.along_inside), ("across", found.across)])
}

/// The worst of all laws of springs with the balanced correction.
pub fn worst() -> Result<Figures> {
    let (mut along, mut across, mut count) = (0.0_f64, 0.0_f64, 0.0);
    for law in laws().filter(|law| law.surface_correction == SurfaceCorrection::Balanced) {
        let found = errors(&law, if law.kind == BondLawKind::BondBased { 1.0 / 3.0 } else { 0.1 })?;
        (along, across, count) = (along.max(found.along), across.max(found.across), count + 1.0);
    }
    Ok(vec![("along", along), ("across", across), ("laws", count)])
}

/// A plate with holes, slots or slanted edges, by its place among [`shapes`].
pub fn shape(keys: &Keys<'_>) -> Result<Figures> {
    let place: usize = keys.get("shape")?;
    let shape = shapes().into_iter().nth(place).ok_or_else(|| Error::Mechanics(format!("no shape {place}")))?;
    let found = uniform_tension(&shape.specimen, &BALANCED, 0.3, MM, HORIZON_RATIO, shape.angle)?;
    Ok(vec![("overall", found.overall)])
}
