//! What a residual is measured against.

use super::super::System;
use super::super::product::Product;
use crate::body::Body;

/// Springs between free points and grips, by which a plate is pulled whose grips move.
pub(super) struct GripSprings<const N: usize> {
    /// Index of the first unknown of a free point, and the block of its springs to held points.
    blocks: Vec<(usize, [[f64; N]; N])>,
}

impl<const N: usize> GripSprings<N> {
    /// Of the uncracked plate: bonds at grips do not break.
    pub(super) fn of(body: &Body, product: &Product<N>) -> Self {
        let layout = product.layout();
        let mut blocks = Vec::new();
        if body.boundary.clamped.is_empty() {
            return GripSprings { blocks };
        }
        let mut is_held = vec![false; body.places()];
        body.boundary.clamped.iter().for_each(|&(place, _)| is_held[place as usize] = true);
        for place in body.points.iter().map(|&place| place as usize).filter(|&place| !is_held[place]) {
            let mut block = None;
            for (k, &step) in body.steps.iter().enumerate() {
                for sign in [1_isize, -1] {
                    let other = place.wrapping_add_signed(sign * step);
                    let share = body.multiplier[k * body.places() + if sign > 0 { place } else { other }];
                    if share > 0.0 && is_held[body.behind(other).0] {
                        let (own, _) = product.bond_blocks(k, sign as f64, f64::from(share));
                        let block = block.get_or_insert([[0.0; N]; N]);
                        block.iter_mut().flatten().zip(own.iter().flatten()).for_each(|(sum, value)| *sum += value);
                    }
                }
            }
            blocks.extend(block.map(|block| (layout.index(place), block)));
        }
        GripSprings { blocks }
    }

    /// Norm of the forces that load the free points, N: f without grips, else f less what their springs take back as their free ends
    /// follow. Moving grips alone would make f of the size of stiffness times their way, of which the
    /// plate feels as little as one spacing in its length.
    pub(super) fn load(&self, system: System<'_, N>, u: &[f64]) -> f64 {
        let (stride, f) = (system.product.layout().stride, system.f);
        let mut square = super::dot(system.product.layout(), f, f);
        for &(first, block) in &self.blocks {
            for (c, row) in block.iter().enumerate() {
                let pull = f[first + c * stride];
                let back: f64 = row.iter().enumerate().map(|(d, value)| value * u[first + d * stride]).sum();
                square += (pull - back).powi(2) - pull * pull;
            }
        }
        square.max(0.0).sqrt()
    }
}
