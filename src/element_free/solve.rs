//! Equilibrium of a plate of nodes.

use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use rayon::prelude::*;

use super::assembly::{Scratch, of_cell, quadrature};
use super::boundary::Boundary;
use super::field::Discretisation;
use super::matrix::{Element, Lower, gathered};
use crate::block_cholesky::Structure;
use crate::error::{Error, Result};
use crate::specimen::Specimen;

/// Displacement of a plate under its loads.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Unknowns, m.
    pub u: Vec<f64>,
    /// Work of the loads `Σ f u`, J.
    pub work: f64,
    /// Points of integration.
    pub points: usize,
    /// Area of them, m².
    pub area: f64,
}

/// Memory of the matrices of cells, which is reused from one equilibrium to the next.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    elements: Vec<Element>,
}

/// Solves `K u = f` at the nominal load `load`, Pa or N, by a sparse Cholesky factor.
///
/// # Errors
/// [`Error::LossOfStiffness`] where some part moves freely; nodes in reach of a point that do not span the basis.
pub fn solve(specimen: &Specimen, plate: &Discretisation, far: f64, load: f64, workspace: &mut Workspace) -> Result<Solution> {
    let cells = quadrature(specimen, plate);
    workspace.elements.resize_with(cells.len().max(workspace.elements.len()), Element::default);
    let elements = &mut workspace.elements[..cells.len()];
    elements.par_iter_mut().zip(&cells).try_for_each_init(
        || Scratch::of(plate.nodes.at.len()),
        |scratch, (element, (leaf, points))| of_cell(plate, specimen.thickness, (*leaf, points), scratch, element),
    )?;
    let Boundary { mut forces, held, of_grips } = Boundary::new(specimen, plate, far)?;
    let all: Vec<&Element> = elements.iter().chain(&held).collect();
    let lower = gathered(&all, plate.unknowns() + of_grips);
    forces.iter_mut().for_each(|force| *force *= load);
    let u = cholesky(lower, &forces)?;
    let work = forces.iter().zip(&u).map(|(f, u)| f * u).sum();
    let points = cells.iter().map(|(_, points)| points.len()).sum();
    let area = cells.iter().flat_map(|(_, points)| points).map(|point| point.area).sum();
    Ok(Solution { u, work, points, area })
}

fn cholesky(lower: Lower, forces: &[f64]) -> Result<Vec<f64>> {
    let n = forces.len();
    let scale: Vec<f64> = (0..n)
        .map(|column| {
            let start = lower.starts[column];
            let diagonal =
                if start < lower.starts[column + 1] && lower.rows[start] == column { lower.values[start] } else { 0.0 };
            if diagonal > 0.0 { 1.0 / diagonal.sqrt() } else { 0.0 }
        })
        .collect();
    if scale.contains(&0.0) {
        return Err(Error::LossOfStiffness);
    }
    let Lower { starts, rows, mut values } = lower;
    for column in 0..n {
        for k in starts[column]..starts[column + 1] {
            values[k] *= scale[column] * scale[rows[k]];
        }
    }
    let matrix = SparseColMat::new(SymbolicSparseColMat::new_checked(n, n, starts, None, rows), values);
    // One thread: sums that depend on the number of threads would make a run another one on another machine.
    let structure = Structure::of(matrix.symbolic(), 1).ok_or_else(|| {
        Error::Mechanics("the stiffness matrix is too large to be factorised; give fewer model.nodes".to_owned())
    })?;
    let factor = structure.factor(matrix.as_ref()).ok_or(Error::LossOfStiffness)?;
    let mut solution: Vec<f64> = forces.iter().zip(&scale).map(|(force, scale)| scale * force).collect();
    factor.solve(&mut solution).ok_or_else(|| Error::Mechanics("memory is short for the solution".to_owned()))?;
    solution.iter_mut().zip(&scale).for_each(|(u, scale)| *u *= scale);
    Ok(solution)
}
