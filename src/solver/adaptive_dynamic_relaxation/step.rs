//! One step of dynamic relaxation in one sweep over the rows.

use rayon::prelude::*;

use super::super::System;
use super::super::field::Layout;
use super::super::product::sweep::RowPass;
use super::super::product::{Into, ROWS_PER_TASK};
use crate::body::lattice::LANES;

/// What moves.
pub(super) struct Motion {
    /// u̇(n-½), m.
    velocity: Vec<f64>,
    /// F(n-1), N.
    residual: Vec<f64>,
    /// K u where it cannot be had row by row: a state-based law.
    product: Option<Vec<f64>>,
    /// Sums of every task of rows, added up in their order: the same digits whatever the number of threads.
    sums: Vec<Sums>,
}

/// How a step uses velocity and residual: u̇(n+½) = keep u̇(n-½) + push F(n)/Λ.
#[derive(Debug, Clone, Copy)]
pub(super) struct Factors {
    keep: f64,
    push: f64,
}

impl Factors {
    /// From rest.
    pub(super) const FIRST: Factors = Factors { keep: 0.0, push: 0.5 };

    /// With damping c.
    pub(super) fn of_damping(c: f64) -> Self {
        Factors { keep: (2.0 - c) / (2.0 + c), push: 2.0 / (2.0 + c) }
    }
}

/// Sums over all unknowns.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sums {
    /// F(n)·F(n), N².
    pub(super) square: f64,
    /// u̇(n-½)·Λ⁻¹(F(n-1) - F(n)) = u̇ᵀ Λ⁻¹ K u̇, m².
    pub(super) stiffness: f64,
    /// u̇(n-½)·u̇(n-½), m².
    pub(super) mass: f64,
}

impl Motion {
    /// No velocity; `tasks` of rows, with room for a whole product or none.
    pub(super) fn at_rest(layout: &Layout, tasks: usize, whole_product: bool) -> Self {
        let (velocity, residual) = (layout.zeros(), layout.zeros());
        let product = whole_product.then(|| layout.zeros());
        Motion { velocity, residual, product, sums: vec![Sums::default(); tasks] }
    }

    /// Moves from `here` to `there`, vectors of displacement with 1/Λ = `mobility`; the sums belong to `here`.
    pub(super) fn step<const N: usize>(
        &mut self,
        system: System<'_, N>,
        mobility: &[f64],
        factors: Factors,
        here: &mut [f64],
        there: &mut [f64],
    ) -> Sums {
        let System { body, bonds, product, f } = system;
        match &mut self.product {
            Some(whole) => product.apply(bonds, here, whole, Into::Set),
            None => product.mirror(here),
        }
        let here = &*here;
        let (row_len, padding) = (product.layout().row_len(), product.layout().padding);
        let rows = padding * row_len..(padding + body.lattice.rows) * row_len;
        let task_len = row_len * ROWS_PER_TASK;
        let moving = there[rows.clone()]
            .par_chunks_mut(task_len)
            .zip(self.velocity[rows.clone()].par_chunks_mut(task_len))
            .zip(self.residual[rows.clone()].par_chunks_mut(task_len))
            .zip(&mut self.sums);
        let whole = self.product.as_deref();
        moving.enumerate().for_each(|(task, (((next, velocity), residual), sums))| {
            let first = task * ROWS_PER_TASK;
            let span = rows.start + task * task_len..rows.start + task * task_len + next.len();
            let given = (&f[span.clone()], &mobility[span.clone()], &here[span.clone()]);
            let range = first..first + next.len() / row_len;
            let mut step = Step { first, factors, given, next, velocity, residual, lanes: [[0.0; LANES]; 3] };
            match whole {
                None => product.sweep(bonds, here, range, &mut step),
                Some(whole) => range.zip(whole[span].chunks_exact(row_len)).for_each(|(row, kx)| step.take(row, kx)),
            }
            let [square, stiffness, mass] = step.lanes.map(|lanes| lanes.iter().sum());
            *sums = Sums { square, stiffness, mass };
        });
        self.sums.iter().fold(Sums::default(), |all, sums| Sums {
            square: all.square + sums.square,
            stiffness: all.stiffness + sums.stiffness,
            mass: all.mass + sums.mass,
        })
    }
}

/// The step on some rows.
struct Step<'a> {
    /// First of the rows.
    first: usize,
    factors: Factors,
    /// Load, 1/Λ and displacement.
    given: (&'a [f64], &'a [f64], &'a [f64]),
    next: &'a mut [f64],
    velocity: &'a mut [f64],
    residual: &'a mut [f64],
    /// Running sums: square, stiffness, mass.
    lanes: [[f64; LANES]; 3],
}

impl RowPass for Step<'_> {
    #[inline(always)]
    fn take(&mut self, row: usize, kx: &[f64]) {
        let len = kx.len();
        let first = (row - self.first) * len;
        let whole = len / LANES * LANES;
        for at in (0..whole).step_by(LANES) {
            self.advance::<LANES>(first + at, &kx[at..]);
        }
        for (at, kx) in kx.chunks_exact(1).enumerate().skip(whole) {
            self.advance::<1>(first + at, kx);
        }
    }
}

impl Step<'_> {
    /// Moves `WIDTH` components.
    #[inline(always)]
    fn advance<const WIDTH: usize>(&mut self, at: usize, kx: &[f64]) {
        let Factors { keep, push } = self.factors;
        let span = at..at + WIDTH;
        let (f, mobility, here) = (&self.given.0[span.clone()], &self.given.1[span.clone()], &self.given.2[span.clone()]);
        let next = &mut self.next[span.clone()];
        let velocity = &mut self.velocity[span.clone()];
        let residual = &mut self.residual[span];
        let kx = &kx[..WIDTH];
        for lane in 0..WIDTH {
            // What is held, and padding, has no residual.
            let force = if mobility[lane] > 0.0 { f[lane] - kx[lane] } else { 0.0 };
            let (last, before) = (velocity[lane], residual[lane]);
            self.lanes[0][lane] += force * force;
            self.lanes[1][lane] += last * mobility[lane] * (before - force);
            self.lanes[2][lane] += last * last;
            let speed = keep * last + push * mobility[lane] * force;
            next[lane] = here[lane] + speed;
            velocity[lane] = speed;
            residual[lane] = force;
        }
    }
}
