//! The body's own operator as multigrid sees it: its springs, and which points may use which coarse ones.

use super::super::field::Layout;
use super::super::product::Product;
use super::transfer::Link;
use super::{Block, Stiffness};
use crate::body::Body;
use crate::body::lattice::LANES;
use crate::body::mirror::{Flips, signs};
use crate::bond_law::stencil::StencilBond;
use crate::state::Bonds;

/// Common neighbours that join two points whose own bond is broken: around a tip fewer reach across the crack.
const SHARED_NEIGHBOURS: usize = 3;

/// The stiffness of a body in one state of its bonds.
#[derive(Clone, Copy)]
pub struct Fine<'a, const N: usize> {
    pub body: &'a Body,
    pub bonds: &'a Bonds,
    pub product: &'a Product<N>,
}

impl<const N: usize> Fine<'_, N> {
    /// Whether the bond from a place to its neighbour `dx`, `dy` away carries.
    fn carries(&self, place: usize, dx: i32, dy: i32) -> bool {
        let forward = dy > 0 || (dy == 0 && dx > 0);
        let (dx, dy, owner) =
            if forward { (dx, dy, place) } else { (-dx, -dy, place.wrapping_add_signed(self.body.lattice.step(dx, dy))) };
        let k = self.body.stencil.bonds.iter().position(|bond| (bond.dx, bond.dy) == (dx, dy));
        k.is_some_and(|k| self.bonds.multiplier[k * self.body.places() + owner] > 0.0)
    }

    /// Clears rows of components that are held at one place and columns of those that are held at another.
    fn clear(&self, block: &mut Block<N>, here: usize, there: usize) {
        if self.product.fixed().is_empty() {
            return;
        }
        for (c, d) in (0..N).flat_map(|c| (0..N).map(move |d| (c, d))) {
            if self.product.is_held(here, c) || self.product.is_held(there, d) {
                block[c][d] = 0.0;
            }
        }
    }
}

impl<const N: usize> Stiffness<N> for Fine<'_, N> {
    fn layout(&self) -> &Layout {
        self.product.layout()
    }

    fn reach(&self) -> usize {
        self.body.stencil.reach
    }

    /// All places are interior points with all their bonds, none of them held or near a line of symmetry.
    fn is_common(&self, row: usize, chunk: usize) -> bool {
        let (reach, lines) = (self.body.stencil.reach, self.body.mirror.lines);
        let mirrored = (lines[0].is_some() && chunk * LANES < reach) || (lines[1].is_some() && row < reach);
        let first = self.body.lattice.place(chunk * LANES, row);
        let is_held = |place: usize| !self.product.fixed().is_empty() && (0..N).any(|c| self.product.is_held(place, c));
        !mirrored && self.bonds.chunk_is_regular(row, chunk) && !(first..first + LANES).any(is_held)
    }

    fn inside(&self) -> Option<Block<N>> {
        let mut diagonal = [[0.0; N]; N];
        for (k, sign) in (0..self.body.steps.len()).flat_map(|k| [(k, 1.0), (k, -1.0)]) {
            add(&mut diagonal, &self.product.bond_blocks(k, sign, 1.0).0);
        }
        Some(diagonal)
    }

    fn diagonal(&self, place: [usize; 2]) -> Block<N> {
        let place = self.body.lattice.place(place[0], place[1]);
        let mut sum = [[0.0; N]; N];
        for (k, sign, bond, other) in self.bonds.at(self.body, place) {
            let (own, off) = self.product.bond_blocks(k, sign, f64::from(self.bonds.multiplier[bond]));
            add(&mut sum, &own);
            let (behind, flips) = self.body.behind(other);
            if behind == place {
                add(&mut sum, &mirrored(off, flips));
            }
        }
        self.clear(&mut sum, place, place);
        sum
    }

    fn is_point(&self, [column, row]: [usize; 2]) -> bool {
        self.body.is_point[self.body.lattice.place(column, row)]
    }

    /// The intact bonds of a point, then itself; bonds to mirror images belong to the points behind them.
    fn visit_row(&self, [column, row]: [usize; 2], mut visit: impl FnMut([isize; 2], &Block<N>)) {
        let body = self.body;
        let place = body.lattice.place(column, row);
        let mut diagonal = [[0.0; N]; N];
        for (k, sign, bond, other) in self.bonds.at(body, place) {
            let (own, mut off) = self.product.bond_blocks(k, sign, f64::from(self.bonds.multiplier[bond]));
            let StencilBond { dx, dy, .. } = body.stencil.bonds[k];
            let mut step = [dx, dy].map(|way| sign as isize * way as isize);
            let (other, flips) = body.behind(other);
            if flips != [false; 2] {
                let seat = body.lattice.column_row(other);
                step = [seat.0 as isize - column as isize, seat.1 as isize - row as isize];
                off = mirrored(off, flips);
            }
            self.clear(&mut off, place, other);
            add(&mut diagonal, &own);
            visit(step, &off);
        }
        self.clear(&mut diagonal, place, place);
        visit([0, 0], &diagonal);
    }

    /// Within bond reach: their bond carries, or, since a single bond beside a crack may be spent too, several points are bonded to both.
    fn link(&self, a: [usize; 2], b: [usize; 2]) -> Link {
        let (dx, dy) = (b[0] as i32 - a[0] as i32, b[1] as i32 - a[1] as i32);
        let place = self.body.lattice.place(a[0], a[1]);
        if (dx, dy) == (0, 0) || self.carries(place, dx, dy) {
            return Link::Joined;
        }
        let both = |&(sign, k): &(i32, usize)| {
            let bond = &self.body.stencil.bonds[k];
            let (x, y) = (sign * bond.dx, sign * bond.dy);
            self.carries(place, x, y) && self.carries(place.wrapping_add_signed(self.body.lattice.step(x, y)), dx - x, dy - y)
        };
        let shared = [1, -1].into_iter().flat_map(|sign| (0..self.body.steps.len()).map(move |k| (sign, k))).filter(both);
        if shared.take(SHARED_NEIGHBOURS).count() == SHARED_NEIGHBOURS { Link::Joined } else { Link::Severed }
    }

    fn prepare(&self, x: &mut [f32]) {
        self.product.mirror(x);
    }

    #[inline(always)]
    fn subtract_row(&self, row: usize, x: &[f32], r: &mut [f32]) {
        self.product.subtract_row(self.bonds, row, x, r);
    }
}

/// The block of a bond to an image as one of the point behind that.
fn mirrored<const N: usize>(block: Block<N>, flips: Flips) -> Block<N> {
    let signs = signs(flips);
    block.map(|row| std::array::from_fn(|d| signs[d] * row[d]))
}

fn add<const N: usize>(sum: &mut Block<N>, block: &Block<N>) {
    sum.as_flattened_mut().iter_mut().zip(block.as_flattened()).for_each(|(sum, value)| *sum += value);
}
