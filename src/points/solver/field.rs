//! Vectors over the unknowns of a body.
//!
//! Memory: row by row of the padded lattice, and within a row one component after the other, so that a row with all
//! its components is one slice (rows are what threads share out) and a component along a row is contiguous (what
//! vector units read).

use nalgebra::{RealField, convert};

use crate::body::Body;
use crate::body::lattice::{LANES, Lattice};
use crate::body::mirror::{Line, signs};

/// Places of a task, about: from some thousands on a second thread gains more than it costs.
const PLACES_PER_TASK: usize = 1 << 12;

/// Layout of a vector with `unknowns` components a place over a padded lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Components of a place.
    pub unknowns: usize,
    /// Places of a padded row.
    pub stride: usize,
    pub rows: usize,
    pub padding: usize,
    /// Columns that hold points.
    pub columns: usize,
}

impl Layout {
    /// Layout over the lattice of a body.
    #[inline]
    pub fn of(lattice: &Lattice, unknowns: usize) -> Self {
        Layout {
            unknowns,
            stride: lattice.stride,
            rows: lattice.rows + 2 * lattice.padding,
            padding: lattice.padding,
            columns: lattice.columns,
        }
    }

    #[inline]
    pub fn len(&self) -> usize {
        self.rows * self.row_len() + LANES
    }

    /// Whether there is nothing in it.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// Length of a padded row with all components.
    #[inline]
    pub fn row_len(&self) -> usize {
        self.unknowns * self.stride
    }

    /// Index of the first component of a memory place of the lattice.
    #[inline]
    pub fn index(&self, place: usize) -> usize {
        place / self.stride * self.row_len() + place % self.stride
    }

    /// Distance in the vector to the neighbour `dx`, `dy` away.
    #[inline]
    pub fn step(&self, dx: i32, dy: i32) -> isize {
        dy as isize * self.row_len() as isize + dx as isize
    }

    #[inline]
    pub fn zeros(&self) -> Vec<f64> {
        vec![0.0; self.len()]
    }

    /// Rows that one task takes: enough work that handing it out does not count, tasks alike, the same for any number of threads.
    #[inline]
    pub fn rows_per_task(&self) -> usize {
        self.rows.div_ceil((self.rows * self.stride).div_ceil(PLACES_PER_TASK).max(1)).max(1)
    }

    /// Columns and rows that hold points.
    #[inline]
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows - 2 * self.padding]
    }

    /// A row with its padding.
    #[inline(always)]
    pub fn padded_row<'a, T>(&self, row: usize, field: &'a [T]) -> &'a [T] {
        &field[(row + self.padding) * self.row_len()..][..self.row_len()]
    }

    /// Does work on every row of some fields that holds points, in tasks of so many rows, compiled for every vector width and run with the
    /// widest the processor has: `work` is inlined.
    #[inline]
    pub fn for_rows<T: Send, const K: usize>(
        &self,
        rows_per_task: usize,
        fields: [&mut [T]; K],
        work: impl Fn(usize, [&mut [T]; K]) + Sync,
    ) {
        use rayon::prelude::*;
        let (row_len, [_, rows]) = (self.row_len(), self.size());
        let body = self.padding * row_len..(self.padding + rows) * row_len;
        let mut tasks = fields.map(|field| field[body.clone()].chunks_mut(rows_per_task * row_len));
        let tasks: Vec<[&mut [T]; K]> =
            (0..rows.div_ceil(rows_per_task)).map(|_| tasks.each_mut().map(|task| task.next().unwrap_or_default())).collect();
        let (arch, work) = (pulp::Arch::new(), &work);
        tasks.into_par_iter().enumerate().for_each(|(task, fields)| {
            let first = task * rows_per_task;
            let last = (first + rows_per_task).min(rows);
            arch.dispatch(
                #[inline(always)]
                move || {
                    let mut parts = fields.map(|field| field.chunks_exact_mut(row_len));
                    for row in first..last {
                        (*work)(row, parts.each_mut().map(|part| part.next().unwrap_or_default()));
                    }
                },
            );
        });
    }

    /// Values of a vector that one task takes.
    #[inline]
    pub fn part(&self) -> usize {
        self.row_len() * self.rows_per_task()
    }
}

/// Scalar product, summed part by part in a fixed order: the same digits whatever the number of threads. The second vector may
/// be in single precision.
pub fn dot<T: Copy + Sync + Into<f64>>(layout: &Layout, a: &[f64], b: &[T]) -> f64 {
    use rayon::prelude::*;
    let part = layout.part();
    let parts: Vec<f64> = a.par_chunks(part).zip(b.par_chunks(part)).map(|(a, b)| lane_sum(a, b)).collect();
    parts.iter().sum()
}

/// Scalar products of two vectors with a third in one pass, summed like [`dot`].
#[inline]
pub fn dots(layout: &Layout, [a, b]: [&[f64]; 2], z: &[f32]) -> [f64; 2] {
    use rayon::prelude::*;
    let part = layout.part();
    let both = |((a, b), z): ((&[f64], &[f64]), &[f32])| [lane_sum(a, z), lane_sum(b, z)];
    let parts: Vec<[f64; 2]> = a.par_chunks(part).zip(b.par_chunks(part)).zip(z.par_chunks(part)).map(both).collect();
    parts.iter().fold([0.0; 2], |[a, b], part| [a + part[0], b + part[1]])
}

/// Euclidean norm of a vector in single precision, summed like [`dot`].
#[inline]
pub fn norm(layout: &Layout, a: &[f32]) -> f64 {
    use rayon::prelude::*;
    let square = |part: &[f32]| part.iter().map(|&v| f64::from(v) * f64::from(v)).sum::<f64>();
    let parts: Vec<f64> = a.par_chunks(layout.part()).map(square).collect();
    parts.iter().sum::<f64>().sqrt()
}

/// Sum of products with running sums side by side, which the compiler turns into vector instructions.
pub(super) fn lane_sum<T: Copy + Into<f64>>(a: &[f64], b: &[T]) -> f64 {
    let mut sums = [0.0; LANES];
    let (a_lanes, a_rest) = a.as_chunks::<LANES>();
    let (b_lanes, b_rest) = b.as_chunks::<LANES>();
    for (a, b) in a_lanes.iter().zip(b_lanes) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane].into();
        }
    }
    sums.iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(a, &b)| a * b.into()).sum::<f64>()
}

/// Precision of the values of a vector: double for a solution, single for what preconditions.
pub trait Real: RealField + Copy {}
impl<T: RealField + Copy> Real for T {}

/// Where images stand in vectors of a layout, and what they are images of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ghosts {
    layout: Layout,
    lines: [Option<Line>; 2],
    /// Signs of the components mirrored along the rows, and along the columns.
    signs: [[f64; 3]; 2],
}

impl Ghosts {
    /// Images of displacements and rotations.
    pub(super) fn of_motion(body: &Body, layout: Layout) -> Self {
        Ghosts { layout, lines: body.mirror.lines, signs: [signs([true, false]), signs([false, true])] }
    }

    /// Images of one scalar a place.
    pub(super) fn of_scalar(body: &Body, layout: Layout) -> Self {
        Ghosts { layout: Layout { unknowns: 1, ..layout }, lines: body.mirror.lines, signs: [[1.0; 3]; 2] }
    }

    /// Puts the images into the padding.
    pub(super) fn fill<T: Real>(&self, x: &mut [T]) {
        let Layout { unknowns, stride, rows, padding, .. } = self.layout;
        let row_len = self.layout.row_len();
        if let Some(line) = self.lines[0] {
            for (component, values) in x[..rows * row_len].chunks_exact_mut(stride).enumerate() {
                let sign = convert::<f64, T>(self.signs[0][component % unknowns]);
                for steps in 1..=padding {
                    values[padding - steps] = sign * values[padding + line.source(steps)];
                }
            }
        }
        if let Some(line) = self.lines[1] {
            for steps in 1..=padding {
                let (before, after) = x.split_at_mut(padding * row_len);
                let target = &mut before[(padding - steps) * row_len..][..row_len];
                let source = &after[line.source(steps) * row_len..][..row_len];
                for (component, (target, source)) in target.chunks_mut(stride).zip(source.chunks(stride)).enumerate() {
                    let sign = convert::<f64, T>(self.signs[1][component]);
                    target.iter_mut().zip(source).for_each(|(target, source)| *target = sign * *source);
                }
            }
        }
    }
}
