//! Mirror images in the padding of vectors over the part of a symmetric plate.

use super::field::Layout;
use super::kernel::Real;
use crate::body::Body;
use crate::body::mirror::{Line, signs};

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
                let sign = T::of(self.signs[0][component % unknowns]);
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
                    let sign = T::of(self.signs[1][component]);
                    target.iter_mut().zip(source).for_each(|(target, source)| *target = sign * *source);
                }
            }
        }
    }
}
