//! The points and bonds that a run would compute, looked at before anything moves.

use super::bonds::BondState;
use super::boundary::Boundary;
use super::scene::Scene;
use super::{of_motion, rotation};
use crate::error::Result;

/// What the discretisation makes of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Preview {
    /// Points.
    pub points: usize,
    /// Bonds.
    pub bonds: usize,
    /// Bonds that the initial cracks cut.
    pub cut: usize,
    /// Smallest and largest horizon, m.
    pub horizons: [f64; 2],
    /// Smallest and largest spacing, m.
    pub spacings: [f64; 2],
    /// Points of every load, in the order of the scene.
    pub loaded: Vec<usize>,
    /// What the user should know about them.
    pub warnings: Vec<String>,
}

/// Builds points, bonds, loads and supports of a scene.
pub fn preview(scene: &Scene) -> Result<Preview> {
    let (net, body) = super::build(scene)?;
    let boundary = Boundary::of(scene, &net)?;
    let (bonds, failure) = (BondState::new(&net, &boundary.no_fail), super::failure(scene, &net)?);
    let turning = rotation::warning(scene, &net, of_motion(scene, body).as_ref(), &bonds, failure.as_ref())?;
    let range = |values: &[f64]| {
        values.iter().fold([f64::INFINITY, 0.0], |[low, high], &value| [f64::min(low, value), f64::max(high, value)])
    };
    Ok(Preview {
        points: net.len(),
        bonds: net.bonds.len(),
        cut: net.pre_cut.len(),
        horizons: range(&net.horizons),
        spacings: range(&net.spacings),
        loaded: boundary.groups.iter().map(|group| group.points.len()).collect(),
        warnings: net.warnings.into_iter().chain(turning).collect(),
    })
}
