//! The body's own operator as multigrid sees it: block rows of points, and which points may use which coarse ones.

use super::super::product::Product;
use super::coarse::BlockRows;
use super::transfer::Link;
use crate::body::Body;
use crate::body::lattice::LANES;
use crate::body::mirror::signs;
use crate::state::Bonds;

/// Common neighbours that join two points whose own bond is broken: around a tip fewer reach across the crack.
const SHARED_NEIGHBOURS: usize = 3;

/// The stiffness of a body in one state of its bonds, block by block.
pub(super) struct Fine<'a, const N: usize> {
    body: &'a Body,
    bonds: &'a Bonds,
    product: &'a Product<N>,
    /// Held components of each place, bit c.
    held: std::collections::HashMap<(usize, usize), u8>,
}

impl<'a, const N: usize> Fine<'a, N> {
    pub(super) fn new(body: &'a Body, bonds: &'a Bonds, product: &'a Product<N>) -> Self {
        let layout = product.layout();
        let mut held = std::collections::HashMap::new();
        for &index in product.fixed() {
            let (row, rest) = (index / layout.row_len(), index % layout.row_len());
            let (component, column) = (rest / layout.stride, rest % layout.stride);
            *held.entry((column - layout.padding, row - layout.padding)).or_insert(0) |= 1 << component;
        }
        Fine { body, bonds, product, held }
    }

    pub(super) fn is_point(&self, column: usize, row: usize) -> bool {
        self.body.is_point[self.body.lattice.place(column, row)]
    }

    /// Whether a fine point may use a coarse one within bond reach: their bond carries, or, since a single bond beside a
    /// crack may be spent too, several points are bonded to both.
    pub(super) fn link(&self, a: [usize; 2], b: [usize; 2]) -> Link {
        let (dx, dy) = (b[0] as i32 - a[0] as i32, b[1] as i32 - a[1] as i32);
        let place = self.body.lattice.place(a[0], a[1]);
        if (dx, dy) == (0, 0) || self.carries(place, dx, dy) {
            return Link::Joined;
        }
        let both = |sign: i32, k: usize| {
            let bond = &self.body.stencil.bonds[k];
            let (x, y) = (sign * bond.dx, sign * bond.dy);
            self.carries(place, x, y) && self.carries(place.wrapping_add_signed(self.body.lattice.step(x, y)), dx - x, dy - y)
        };
        let shared = [1, -1]
            .into_iter()
            .flat_map(|sign| (0..self.body.steps.len()).map(move |k| (sign, k)))
            .filter(|&(sign, k)| both(sign, k));
        if shared.take(SHARED_NEIGHBOURS).count() == SHARED_NEIGHBOURS { Link::Joined } else { Link::Severed }
    }

    /// Whether the bond from a place to its neighbour `dx`, `dy` away carries.
    pub(super) fn carries(&self, place: usize, dx: i32, dy: i32) -> bool {
        let forward = dy > 0 || (dy == 0 && dx > 0);
        let (dx, dy, owner) =
            if forward { (dx, dy, place) } else { (-dx, -dy, place.wrapping_add_signed(self.body.lattice.step(dx, dy))) };
        let k = self.body.stencil.bonds.iter().position(|bond| (bond.dx, bond.dy) == (dx, dy));
        k.is_some_and(|k| self.bonds.multiplier[k * self.body.places() + owner] > 0.0)
    }

    pub(super) fn held_at(&self, column: usize, row: usize) -> u8 {
        if self.held.is_empty() { 0 } else { self.held.get(&(column, row)).copied().unwrap_or(0) }
    }

    /// Whether all places of a chunk are interior points with all their bonds, none of them held or near a line of symmetry.
    pub(super) fn is_whole(&self, row: usize, chunk: usize) -> bool {
        let (reach, lines) = (self.body.stencil.reach, self.body.mirror.lines);
        let mirrored = (lines[0].is_some() && chunk * LANES < reach) || (lines[1].is_some() && row < reach);
        let is_held = |column: usize| self.held_at(column, row) != 0;
        let is_free = || self.held.is_empty() || !(chunk * LANES..(chunk + 1) * LANES).any(is_held);
        !mirrored && self.bonds.chunk_is_regular(row, chunk) && is_free()
    }

    /// Diagonal block of an interior point that keeps all its bonds.
    pub(super) fn interior_diagonal(&self) -> Option<[[f64; N]; N]> {
        let mut diagonal = [[0.0; N]; N];
        for (k, sign) in (0..self.body.steps.len()).flat_map(|k| [(k, 1.0), (k, -1.0)]) {
            let own = self.product.bond_blocks(k, sign, 1.0).0;
            diagonal.as_flattened_mut().iter_mut().zip(own.as_flattened()).for_each(|(sum, own)| *sum += own);
        }
        Some(diagonal)
    }

    /// Diagonal block of a point, held components cleared, bonds to its own images included.
    pub(super) fn diagonal(&self, column: usize, row: usize) -> [[f64; N]; N] {
        let mut sum = [[0.0; N]; N];
        self.visit_row(column, row, |step, block| {
            if step == [0, 0] {
                sum.as_flattened_mut().iter_mut().zip(block.as_flattened()).for_each(|(sum, value)| *sum += value);
            }
        });
        sum
    }
}

impl<const N: usize> BlockRows<N> for Fine<'_, N> {
    /// The intact bonds of a point, then itself; bonds to mirror images belong to the points behind them.
    fn visit_row(&self, column: usize, row: usize, mut visit: impl FnMut([isize; 2], &[[f64; N]; N])) {
        let (body, places) = (self.body, self.body.places());
        let place = body.lattice.place(column, row);
        let own_held = self.held_at(column, row);
        let mut diagonal = [[0.0; N]; N];
        for (k, bond) in body.stencil.bonds.iter().enumerate() {
            for sign in [1_isize, -1] {
                let owner = if sign > 0 { place } else { place.wrapping_add_signed(-body.steps[k]) };
                let share = self.bonds.multiplier[k * places + owner];
                if share > 0.0 {
                    let (own, mut off) = self.product.bond_blocks(k, sign as f64, f64::from(share));
                    let (other, flips) = body.behind(place.wrapping_add_signed(sign * body.steps[k]));
                    let (mut dx, mut dy) = (sign * bond.dx as isize, sign * bond.dy as isize);
                    if flips != [false; 2] {
                        let seat = body.lattice.column_row(other);
                        (dx, dy) = (seat.0 as isize - column as isize, seat.1 as isize - row as isize);
                        let signs = signs(flips);
                        off.iter_mut().flatten().enumerate().for_each(|(i, value)| *value *= signs[i % N]);
                    }
                    clear(&mut off, own_held, self.held_at(column.wrapping_add_signed(dx), row.wrapping_add_signed(dy)));
                    for c in 0..N {
                        for d in 0..N {
                            diagonal[c][d] += own[c][d];
                        }
                    }
                    visit([dx, dy], &off);
                }
            }
        }
        clear(&mut diagonal, own_held, own_held);
        visit([0, 0], &diagonal);
    }
}

fn clear<const N: usize>(block: &mut [[f64; N]; N], rows: u8, columns: u8) {
    for (c, row) in block.iter_mut().enumerate() {
        for (d, value) in row.iter_mut().enumerate() {
            if rows >> c & 1 == 1 || columns >> d & 1 == 1 {
                *value = 0.0;
            }
        }
    }
}
