//! Sparse factorisation by faer, the reference of tests and what an iteration falls back on: Cholesky, and LU for a state-based law,
//! whose matrix with the stresses as unknowns is not positive definite.

use std::collections::HashSet;

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::LltError;
use faer::sparse::{SparseColMat, Triplet};

use super::assembly::{Assembly, MIXED, Mixed, Springs, for_joints};
use super::field::dot;
use super::rigid_motion::RigidMotion;
use super::spring::GapSpring;
use super::system::{Solved, System};
use crate::body::Body;
use crate::state::Bonds;
use perilife_base::error::{Error, Result};
use perilife_base::watch::{self, Stage};

/// Factorises the system and solves it.
pub(super) fn factorised<const N: usize>(system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
    // Nothing looks while it factorises, which takes seconds; iterations that were asked to end must not lead here.
    watch::at(Stage::Equilibrium, 0.0)?;
    let System { body, bonds, product, f, .. } = system;
    match product.dilatation.as_ref() {
        None => factorise_and_solve::<N, N>(system, &Springs(product), u)?,
        Some(dilatation) => factorise_and_solve::<N, MIXED>(system, &Mixed { product, dilatation, body, bonds }, u)?,
    }
    Ok(Solved { iterations: 0, work: dot(product.layout(), f, u) })
}

/// Solves with M unknowns a point, of which the first N go into `u`.
fn factorise_and_solve<const N: usize, const M: usize>(
    system: System<'_, N>,
    assembly: &impl Assembly<M>,
    u: &mut [f64],
) -> Result<()> {
    let System { body, bonds, product, f, .. } = system;
    let layout = product.layout();
    let pinned: HashSet<(usize, usize)> = pins(body, bonds).into_iter().collect();
    let mut number = vec![[usize::MAX; M]; body.places()];
    let mut unknowns = Vec::new();
    for place in body.points.iter().map(|&place| place as usize) {
        for c in (0..M).filter(|&c| !assembly.is_held(place, c) && !pinned.contains(&(place, c))) {
            number[place][c] = unknowns.len();
            unknowns.push((place, c));
        }
    }
    let definite = (0..M).all(|c| assembly.pivot_sign(c) > 0.0);
    let mut entries = entries(body, bonds, assembly, &number);
    add_contact(&product.contact, &number, &mut entries);
    if definite {
        entries.retain(|entry| entry.col <= entry.row);
    }
    // Points without bonds have empty rows: a unit diagonal keeps them at rest.
    let mut filled = vec![false; unknowns.len()];
    entries.iter().filter(|t| t.row == t.col && t.val != 0.0).for_each(|t| filled[t.row] = true);
    entries.extend(filled.iter().enumerate().filter(|(_, filled)| !**filled).map(|(i, _)| Triplet::new(i, i, 1.0)));

    let n = unknowns.len();
    let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &entries)
        .map_err(|e| Error::Mechanics(format!("the stiffness matrix could not be built: {e:?}")))?;
    drop(entries);
    let rhs = faer::Mat::from_fn(n, 1, |i, _| {
        let (place, c) = unknowns[i];
        if c < N { f[layout.index(place) + c * layout.stride] } else { 0.0 }
    });
    let solution = if definite {
        let factor = matrix.sp_cholesky(faer::Side::Lower).map_err(|error| match error {
            // A pivot that is none: some part moves freely.
            LltError::Numeric(_) => Error::LossOfStiffness,
            LltError::Generic(_) => Error::Mechanics(format!("the stiffness matrix could not be factorised: {error:?}")),
        })?;
        factor.solve(&rhs)
    } else {
        let factor =
            matrix.sp_lu().map_err(|e| Error::Mechanics(format!("the stiffness matrix could not be factorised: {e:?}")))?;
        factor.solve(&rhs)
    };
    u.fill(0.0);
    for (i, &(place, c)) in unknowns.iter().enumerate().filter(|(_, (_, c))| *c < N) {
        u[layout.index(place) + c * layout.stride] = solution[(i, 0)];
    }
    if let Some(rigid) = RigidMotion::of(body, bonds, *layout) {
        rigid.take_off(u);
    }
    product.mirror(u);
    Ok(())
}

/// Entries of the matrix whose unknowns have these numbers.
fn entries<const M: usize>(
    body: &Body,
    bonds: &Bonds,
    assembly: &impl Assembly<M>,
    number: &[[usize; M]],
) -> Vec<Triplet<usize, usize, f64>> {
    let mut entries = Vec::with_capacity(body.points.len() * M * 40);
    let mut add = |row: usize, column: usize, value: f64| {
        if row != usize::MAX && column != usize::MAX && value != 0.0 {
            entries.push(Triplet::new(row, column, value));
        }
    };
    for place in body.points.iter().map(|&place| place as usize) {
        add(number[place][M - 1], number[place][M - 1], assembly.point(place));
        for_joints(assembly, body, bonds, place, |joint, _| {
            let (own, off) = joint.here;
            for c in 0..M {
                for d in 0..M {
                    add(number[place][c], number[place][d], own[c][d]);
                    add(number[place][c], number[joint.other][d], off[c][d]);
                }
            }
        });
    }
    entries
}

/// Entries of springs between flanks in contact.
fn add_contact<const M: usize>(contact: &[GapSpring], number: &[[usize; M]], entries: &mut Vec<Triplet<usize, usize, f64>>) {
    for spring in contact {
        let unknowns =
            spring.weights.iter().flat_map(|&(place, weights)| [0, 1].map(|c| (number[place as usize][c], weights[c])));
        let unknowns: Vec<(usize, f64)> = unknowns.filter(|(number, weight)| *number != usize::MAX && *weight != 0.0).collect();
        for &(row, a) in &unknowns {
            entries.extend(unknowns.iter().map(|&(column, b)| Triplet::new(row, column, spring.stiffness * a * b)));
        }
    }
}

/// Components that hold a floating plate without carrying load, as place and component.
fn pins(body: &Body, bonds: &Bonds) -> Vec<(usize, usize)> {
    let carrying = || body.points.iter().map(|&p| p as usize).filter(|&p| bonds.intact_at(body, p) > 3);
    let (Some(first), Some(last)) = (carrying().next(), carrying().next_back()) else { return Vec::new() };
    pinned_components(body, first, last)
}

/// Of two distant points the components that hold what is free to move: of one those along which the plate floats and, where it
/// turns freely, the one across of the other. A law that resists rotation has an equilibrium position to turn to.
pub(super) fn pinned_components(body: &Body, first: usize, last: usize) -> Vec<(usize, usize)> {
    let (a, b) = (body.lattice.column_row(first), body.lattice.column_row(last));
    let across = usize::from(b.1.abs_diff(a.1) <= b.0.abs_diff(a.0));
    let free = body.free_motion();
    let mut held: Vec<(usize, usize)> = (0..2).filter(|&c| free[c]).map(|c| (first, c)).collect();
    held.extend(free[2].then_some((last, across)));
    held
}
