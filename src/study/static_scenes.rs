//! Scenes without time: uniform tension by traction, Poisson's ratio read back from it, uniform shear by displacement of the rim. After
//! examples 1 and 2 of Huang, Li, Jin, He and Wang, Guangxi University, on a one-bond two-parameter law with the stiffness of Zhu and Ni
//! 2017, Int. J. Eng. Sci. 121:118.

use std::path::Path;

use super::figures::Figures;
use super::uniform_tension::{rest_within_rim, steel, strip, without_rigid_motion};
use perilife_base::error::Result;
use perilife_growth::predict::Silent;
use perilife_plate::specimen::Point;
use perilife_points::body::Body;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::net::Net;
use perilife_scenes::Scene;

/// Stress of the plate, Pa.
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
