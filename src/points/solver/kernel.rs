//! Rows of the stiffness product of springs, the innermost loops of every solve, in double or single precision.
//!
//! A row is worked through in blocks of neighbouring places. Where all bonds of a block are whole, opposite neighbours are
//! added first; elsewhere both directions of every bond are weighed with their own multipliers. A bond ξ between a point
//! (u, θ) and another (u', θ') brings the point, with `A = k_n n nᵀ + k_t t tᵀ`, `c = k_t r t`, lever r:
//!
//! ```text
//! force   -A (u' - u) + c (θ + θ')        couple   -c·(u' - u) + k_t r² (θ + θ')
//! ```

use nalgebra::{convert, zero};

use super::field::{Layout, Real};
use crate::body::Body;
use crate::body::lattice::LANES;
use crate::state::Bonds;

/// What is done with K x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Into {
    /// y = K x.
    Set,
    /// y -= K x.
    Subtract,
}

/// One stencil bond.
#[derive(Debug, Clone, Copy)]
struct Spring<T> {
    step: isize,
    place_step: isize,
    /// A: xx, xy, yy.
    a: [T; 3],
    /// c and k_t r².
    c: [T; 3],
}

/// The springs of a body with N unknowns a point. Long regular stretches of a row are worked through in B blocks of L
/// places side by side: L fills the widest vector register, B hides its latency.
#[derive(Debug, Clone)]
pub struct Kernel<T, const N: usize, const B: usize, const L: usize> {
    layout: Layout,
    springs: Vec<Spring<T>>,
    /// Diagonal of an interior point: xx = yy of the displacement, and of the rotation.
    diagonal: [T; 2],
}

/// Sums of N components over B blocks of L places.
type Sums<T, const N: usize, const B: usize, const L: usize> = [[[T; L]; B]; N];

impl<T: Real, const N: usize, const B: usize, const L: usize> Kernel<T, N, B, L> {
    /// Springs of a body in the layout of its vectors.
    pub fn new(body: &Body, layout: Layout) -> Self {
        let bonds = || body.stencil.bonds.iter();
        let spring = |(bond, &place_step): (&crate::bond_law::stencil::StencilBond, &isize)| {
            let (n, t, lever) = (bond.normal, bond.tangent(), bond.lever);
            let a = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| convert(bond.k_n * n[i] * n[j] + bond.k_t * t[i] * t[j]));
            let c = [t[0], t[1], lever].map(|along| convert(bond.k_t * lever * along));
            Spring { step: layout.step(bond.dx, bond.dy), place_step, a, c }
        };
        let springs = bonds().zip(&body.steps).map(spring).collect();
        // xx and yy of an interior point are equal by the symmetry of the square; each is half the trace, twice for both bond directions.
        let stretch: f64 = bonds().map(|bond| bond.k_n + bond.k_t).sum();
        let turn: f64 = bonds().map(|bond| 2.0 * bond.k_t * bond.lever * bond.lever).sum();
        Kernel { layout, springs, diagonal: [convert(stretch), convert(turn)] }
    }

    /// Body row `row` of K x into the padded row `out`.
    #[inline(always)]
    pub fn row(&self, bonds: &Bonds, row: usize, x: &[T], out: &mut [T], into: Into) {
        let (stride, padding) = (self.layout.stride, self.layout.padding);
        let first = (row + padding) * self.layout.row_len() + padding;
        let place = (row + padding) * stride + padding;
        let regular = &bonds.regular[row * bonds.chunks..(row + 1) * bonds.chunks];
        let shares = Shares { multiplier: &bonds.multiplier, places: bonds.multiplier.len() / self.springs.len() };
        let inhabited = bonds.inhabited(row);
        if into == Into::Set {
            for c in 0..N {
                let out = &mut out[c * stride..(c + 1) * stride];
                out[..padding + inhabited.start * LANES].fill(zero());
                out[(padding + inhabited.end * LANES).min(stride)..].fill(zero());
            }
        }
        let mut chunk = inhabited.start;
        while chunk < inhabited.end {
            let (at, place, start) = (first + chunk * LANES, place + chunk * LANES, padding + chunk * LANES);
            let block = &regular[chunk..inhabited.end.min(chunk + B * L / LANES)];
            let wide = block.len() * LANES == B * L && !block.contains(&false);
            let pair = L == 2 * LANES && chunk + 1 < inhabited.end && !(regular[chunk] && regular[chunk + 1]);
            if pair {
                give::<T, N, 1, L>(&self.masked::<L>(&shares, x, at, place), out, start, stride, into);
                chunk += 2;
                continue;
            }
            if wide {
                give::<T, N, B, L>(&self.regular(x, at), out, start, stride, into);
            } else if regular[chunk] {
                give::<T, N, 1, LANES>(&self.regular(x, at), out, start, stride, into);
            } else {
                give::<T, N, 1, LANES>(&self.masked::<LANES>(&shares, x, at, place), out, start, stride, into);
            }
            chunk += if wide { B * L / LANES } else { 1 };
        }
    }

    /// All bonds present with multiplier 1: opposite neighbours are added first.
    #[inline(always)]
    fn regular<const P: usize, const W: usize>(&self, x: &[T], at: usize) -> Sums<T, N, P, W> {
        let stride = self.layout.stride;
        let mut y = [[[zero(); W]; P]; N];
        for (c, y) in y.iter_mut().enumerate() {
            for (block, y) in y.iter_mut().enumerate() {
                let here = load::<T, W>(x, at + block * W + c * stride);
                for lane in 0..W {
                    y[lane] = self.diagonal[c / 2] * here[lane];
                }
            }
        }
        for spring in &self.springs {
            let ([a_xx, a_xy, a_yy], [c_x, c_y, c_w]) = (spring.a, spring.c);
            // Indices, not iterators, keep the sums in registers.
            #[allow(clippy::needless_range_loop)]
            for block in 0..P {
                let at = at + block * W;
                let (plus, minus) = (at.wrapping_add_signed(spring.step), at.wrapping_add_signed(-spring.step));
                let (u_p, u_m) = (load::<T, W>(x, plus), load::<T, W>(x, minus));
                let (v_p, v_m) = (load::<T, W>(x, plus + stride), load::<T, W>(x, minus + stride));
                for lane in 0..W {
                    let (u_sum, v_sum) = (u_p[lane] + u_m[lane], v_p[lane] + v_m[lane]);
                    y[0][block][lane] = a_xx.mul_add(-u_sum, a_xy.mul_add(-v_sum, y[0][block][lane]));
                    y[1][block][lane] = a_xy.mul_add(-u_sum, a_yy.mul_add(-v_sum, y[1][block][lane]));
                }
                if N == 3 {
                    let (w_p, w_m) = (load::<T, W>(x, plus + 2 * stride), load::<T, W>(x, minus + 2 * stride));
                    for lane in 0..W {
                        let w = w_p[lane] - w_m[lane];
                        y[0][block][lane] = c_x.mul_add(w, y[0][block][lane]);
                        y[1][block][lane] = c_y.mul_add(w, y[1][block][lane]);
                        let (u, v, w_sum) = (u_p[lane] - u_m[lane], v_p[lane] - v_m[lane], w_p[lane] + w_m[lane]);
                        y[2][block][lane] = c_x.mul_add(-u, c_y.mul_add(-v, c_w.mul_add(w_sum, y[2][block][lane])));
                    }
                }
            }
        }
        y
    }

    /// Any multipliers: both directions of every bond by themselves.
    #[inline(always)]
    fn masked<const W: usize>(&self, shares: &Shares, x: &[T], at: usize, place: usize) -> Sums<T, N, 1, W> {
        let stride = self.layout.stride;
        let mut y = [[[zero(); W]; 1]; N];
        let mut here = [[zero(); W]; N];
        for (c, here) in here.iter_mut().enumerate() {
            *here = load::<T, W>(x, at + c * stride);
        }
        for (k, spring) in self.springs.iter().enumerate() {
            let ([a_xx, a_xy, a_yy], [c_x, c_y, c_w]) = (spring.a, spring.c);
            let behind = place.wrapping_add_signed(-spring.place_step);
            let (s_p, s_m) = (
                load::<f32, W>(shares.multiplier, k * shares.places + place),
                load::<f32, W>(shares.multiplier, k * shares.places + behind),
            );
            let (plus, minus) = (at.wrapping_add_signed(spring.step), at.wrapping_add_signed(-spring.step));
            let (u_p, u_m) = (load::<T, W>(x, plus), load::<T, W>(x, minus));
            let (v_p, v_m) = (load::<T, W>(x, plus + stride), load::<T, W>(x, minus + stride));
            let (w_p, w_m) = if N == 3 {
                (load::<T, W>(x, plus + 2 * stride), load::<T, W>(x, minus + 2 * stride))
            } else {
                ([zero(); W], [zero(); W])
            };
            for lane in 0..W {
                let (s_p, s_m) = (convert::<f32, T>(s_p[lane]), convert::<f32, T>(s_m[lane]));
                let (du_p, du_m) = (s_p * (here[0][lane] - u_p[lane]), here[0][lane] - u_m[lane]);
                let (dv_p, dv_m) = (s_p * (here[1][lane] - v_p[lane]), here[1][lane] - v_m[lane]);
                let (u, v) = (s_m.mul_add(du_m, du_p), s_m.mul_add(dv_m, dv_p));
                y[0][0][lane] = a_xx.mul_add(u, a_xy.mul_add(v, y[0][0][lane]));
                y[1][0][lane] = a_xy.mul_add(u, a_yy.mul_add(v, y[1][0][lane]));
                if N == 3 {
                    let (t_p, t_m) = (s_p * (here[2][lane] + w_p[lane]), here[2][lane] + w_m[lane]);
                    let (turn, both) = ((-s_m).mul_add(t_m, t_p), s_m.mul_add(t_m, t_p));
                    let (u, v) = ((-s_m).mul_add(du_m, du_p), (-s_m).mul_add(dv_m, dv_p));
                    y[0][0][lane] = c_x.mul_add(turn, y[0][0][lane]);
                    y[1][0][lane] = c_y.mul_add(turn, y[1][0][lane]);
                    y[2][0][lane] = c_x.mul_add(u, c_y.mul_add(v, c_w.mul_add(both, y[2][0][lane])));
                }
            }
        }
        y
    }
}

/// Multipliers of all bonds, stencil bond by stencil bond.
struct Shares<'a> {
    multiplier: &'a [f32],
    places: usize,
}

/// Puts sums into the padded row `out` from place `start` on.
#[inline(always)]
fn give<T: Real, const N: usize, const B: usize, const L: usize>(
    sums: &Sums<T, N, B, L>,
    out: &mut [T],
    start: usize,
    stride: usize,
    into: Into,
) {
    for (c, blocks) in sums.iter().enumerate() {
        for (block, sum) in blocks.iter().enumerate() {
            let start = start + c * stride + block * L;
            let target = &mut out[start..start + L];
            for lane in 0..L {
                target[lane] = if into == Into::Set { sum[lane] } else { target[lane] - sum[lane] };
            }
        }
    }
}

/// Values of L places in a row.
#[inline(always)]
pub fn load<T: Real, const L: usize>(x: &[T], at: usize) -> [T; L] {
    let mut lanes = [zero(); L];
    lanes.copy_from_slice(&x[at..at + L]);
    lanes
}
