//! The stiffness product y = K x of a lattice body, without a matrix.
//!
//! Energy of a bond between points i and j = i + ξ: `½ m [k_n (n·(u_j - u_i))² + k_t (t·(u_j - u_i) - r (θ_i + θ_j))²]`
//! with multiplier m and lever r = |ξ|/(2Δ); θ = φ Δ is the point's rotation in units of length. Its gradient, summed
//! over the bonds of a point, is one row of K x. Without free rotation the θ terms are absent.

use rayon::prelude::*;

use super::dilatation::Dilatation;
use super::field::Layout;
use super::ghosts::Ghosts;
use super::window::update::Term;
use crate::body::Body;
use crate::body::lattice::LANES;
use crate::state::Bonds;

/// End of a bond in a window's vector.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    /// Its place, or that of which it is the image.
    pub place: usize,
    /// Index of that place's first unknown.
    pub first: usize,
    /// Signs of its unknowns there.
    pub signs: [f64; 3],
}

impl End {
    /// An entry of a vector for component c of this end.
    pub fn entry(&self, c: usize, value: f64) -> (usize, f64) {
        (self.first + c, self.signs[c] * value)
    }
}

/// A value for each of [`LANES`] neighbouring places.
pub(super) type Lanes = [f64; LANES];

/// Rows that one task takes.
pub(super) const ROWS_PER_TASK: usize = 8;

/// One stencil bond as the product uses it.
#[derive(Debug, Clone, Copy)]
struct Spring {
    step: isize,
    place_step: isize,
    n: [f64; 2],
    t: [f64; 2],
    k_n: f64,
    k_t: f64,
    lever: f64,
    /// k_n n nᵀ + k_t t tᵀ: xx, xy, yy.
    a: [f64; 3],
}

/// Some rows of a product, compiled for every vector width and run with the widest the processor has.
struct Rows<'a, const N: usize> {
    product: &'a Product<N>,
    bonds: &'a Bonds,
    x: &'a [f64],
    first: usize,
    out: &'a mut [f64],
    into: Into,
}

impl<const N: usize> pulp::WithSimd for Rows<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.product.rows(self.bonds, self.x, self.first, self.out, self.into);
    }
}

/// What a combined product does with K x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Into {
    /// y = K x.
    Set,
    /// y -= K x.
    Subtract,
}

/// Stiffness product of a body for N unknowns a point.
#[derive(Debug, Clone)]
pub struct Product<const N: usize> {
    layout: Layout,
    springs: Vec<Spring>,
    lattice_rows: usize,
    /// Diagonal of an interior point: xx = yy of the displacement, and of the rotation.
    diagonal: [f64; 2],
    /// Vector indices of held components.
    fixed: Vec<usize>,
    /// What a state-based law stores beside its springs.
    dilatation: Option<Dilatation>,
    ghosts: Ghosts,
}

impl<const N: usize> Product<N> {
    /// Product for a body; N must be the number of unknowns of its law.
    #[must_use]
    pub fn new(body: &Body, fixed: Vec<usize>) -> Self {
        let layout = Layout::of(&body.lattice, N);
        let springs: Vec<Spring> = body
            .stencil
            .bonds
            .iter()
            .zip(&body.steps)
            .map(|(bond, &place_step)| {
                let (n, t) = (bond.normal, bond.tangent());
                let a = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| bond.k_n * n[i] * n[j] + bond.k_t * t[i] * t[j]);
                Spring {
                    step: layout.step(bond.dx, bond.dy),
                    place_step,
                    n,
                    t,
                    k_n: bond.k_n,
                    k_t: bond.k_t,
                    lever: bond.lever,
                    a,
                }
            })
            .collect();
        let stretch = springs.iter().map(|s| s.a[0] + s.a[2]).sum::<f64>();
        let turn = springs.iter().map(|s| 2.0 * s.k_t * s.lever * s.lever).sum::<f64>();
        // xx and yy of an interior point are equal by the symmetry of the square; each is half the trace, twice for both bond directions.
        let dilatation = Dilatation::of(body, layout);
        Product {
            layout,
            springs,
            lattice_rows: body.lattice.rows,
            diagonal: [stretch, turn],
            fixed,
            dilatation,
            ghosts: Ghosts::of_motion(body, layout),
        }
    }

    /// Layout of its vectors.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Held components.
    #[must_use]
    pub fn fixed(&self) -> &[usize] {
        &self.fixed
    }

    /// What a state-based law stores beside its springs.
    #[must_use]
    pub fn dilatation(&self) -> Option<&Dilatation> {
        self.dilatation.as_ref()
    }

    /// Puts the mirror images of a field into its padding.
    pub(super) fn mirror(&self, x: &mut [f64]) {
        self.ghosts.fill(x);
    }

    /// y = K x or y -= K x; held components of y become zero. x must be zero outside the points, but for its mirror images, which
    /// are put there.
    pub fn apply(&self, bonds: &Bonds, x: &mut [f64], y: &mut [f64], into: Into) {
        self.apply_springs(bonds, x, y, into);
        if let Some(dilatation) = &self.dilatation {
            dilatation.apply(bonds, x, y, into);
            self.fixed.iter().for_each(|&index| y[index] = 0.0);
        }
    }

    /// [`Product::apply`] of the springs alone.
    pub fn apply_springs(&self, bonds: &Bonds, x: &mut [f64], y: &mut [f64], into: Into) {
        self.mirror(x);
        let x = &*x;
        let (row_len, padding) = (self.layout.row_len(), self.layout.padding);
        let body_rows = &mut y[padding * row_len..(padding + self.lattice_rows) * row_len];
        let arch = pulp::Arch::new();
        body_rows.par_chunks_mut(row_len * ROWS_PER_TASK).enumerate().for_each(|(task, rows)| {
            arch.dispatch(Rows { product: self, bonds, x, first: task * ROWS_PER_TASK, out: rows, into });
        });
        for &index in &self.fixed {
            y[index] = 0.0;
        }
    }

    /// Rows of the product into `out`, which holds whole padded rows.
    #[inline(always)]
    fn rows(&self, bonds: &Bonds, x: &[f64], first: usize, out: &mut [f64], into: Into) {
        for (i, out) in out.chunks_exact_mut(self.layout.row_len()).enumerate() {
            self.row(bonds, first + i, x, out, into);
        }
    }

    #[inline(always)]
    fn row(&self, bonds: &Bonds, row: usize, x: &[f64], out: &mut [f64], into: Into) {
        let stride = self.layout.stride;
        let first = (row + self.layout.padding) * self.layout.row_len() + self.layout.padding;
        let place_first = (row + self.layout.padding) * stride + self.layout.padding;
        for chunk in 0..bonds.chunks() {
            let at = first + chunk * LANES;
            let sums = if bonds.chunk_is_regular(row, chunk) {
                self.regular_chunk(x, at)
            } else {
                self.masked_chunk(&bonds.multiplier, x, at, place_first + chunk * LANES)
            };
            for (c, sum) in sums.iter().enumerate() {
                let start = c * stride + self.layout.padding + chunk * LANES;
                let target = &mut out[start..start + LANES];
                for lane in 0..LANES {
                    target[lane] = if into == Into::Set { sum[lane] } else { target[lane] - sum[lane] };
                }
            }
        }
    }

    /// All bonds present with multiplier 1: opposite neighbours are added first.
    #[inline(always)]
    fn regular_chunk(&self, x: &[f64], at: usize) -> [Lanes; N] {
        let stride = self.layout.stride;
        let mut y = [[0.0; LANES]; N];
        let (u, v) = (load(x, at), load(x, at + stride));
        for lane in 0..LANES {
            y[0][lane] = self.diagonal[0] * u[lane];
            y[1][lane] = self.diagonal[0] * v[lane];
        }
        if N == 3 {
            let turn = load(x, at + 2 * stride);
            for lane in 0..LANES {
                y[2][lane] = self.diagonal[1] * turn[lane];
            }
        }
        for spring in &self.springs {
            let (plus, minus) = (at.wrapping_add_signed(spring.step), at.wrapping_add_signed(-spring.step));
            let (u_p, u_m) = (load(x, plus), load(x, minus));
            let (v_p, v_m) = (load(x, plus + stride), load(x, minus + stride));
            let [a_xx, a_xy, a_yy] = spring.a;
            for lane in 0..LANES {
                let (u_sum, v_sum) = (u_p[lane] + u_m[lane], v_p[lane] + v_m[lane]);
                y[0][lane] = a_xx.mul_add(-u_sum, a_xy.mul_add(-v_sum, y[0][lane]));
                y[1][lane] = a_xy.mul_add(-u_sum, a_yy.mul_add(-v_sum, y[1][lane]));
            }
            if N == 3 {
                let (w_p, w_m) = (load(x, plus + 2 * stride), load(x, minus + 2 * stride));
                let couple = spring.k_t * spring.lever;
                let (c_x, c_y, c_w) = (couple * spring.t[0], couple * spring.t[1], couple * spring.lever);
                for lane in 0..LANES {
                    let w_difference = w_p[lane] - w_m[lane];
                    y[0][lane] = c_x.mul_add(w_difference, y[0][lane]);
                    y[1][lane] = c_y.mul_add(w_difference, y[1][lane]);
                    let (u_difference, v_difference, w_sum) =
                        (u_p[lane] - u_m[lane], v_p[lane] - v_m[lane], w_p[lane] + w_m[lane]);
                    y[2][lane] = c_x.mul_add(-u_difference, c_y.mul_add(-v_difference, c_w.mul_add(w_sum, y[2][lane])));
                }
            }
        }
        y
    }

    /// Any multipliers: both directions of every bond by themselves.
    #[inline(always)]
    fn masked_chunk(&self, multiplier: &[f32], x: &[f64], at: usize, place: usize) -> [Lanes; N] {
        let (stride, places) = (self.layout.stride, multiplier.len() / self.springs.len());
        let mut y = [[0.0; LANES]; N];
        let mut here = [[0.0; LANES]; N];
        for (c, value) in here.iter_mut().enumerate() {
            *value = load(x, at + c * stride);
        }
        for (k, spring) in self.springs.iter().enumerate() {
            for (sign, step, owner) in
                [(1.0, spring.step, place), (-1.0, -spring.step, place.wrapping_add_signed(-spring.place_step))]
            {
                let share = load_f32(multiplier, k * places + owner);
                let other = at.wrapping_add_signed(step);
                let (u_o, v_o) = (load(x, other), load(x, other + stride));
                let w_o = if N == 3 { load(x, other + 2 * stride) } else { [0.0; LANES] };
                for lane in 0..LANES {
                    // From i to j along ξ whichever end this point is: sign turns the difference.
                    let (du, dv) = (sign * (u_o[lane] - here[0][lane]), sign * (v_o[lane] - here[1][lane]));
                    let f_n = share[lane] * spring.k_n * (spring.n[0] * du + spring.n[1] * dv);
                    let mut shear = spring.t[0] * du + spring.t[1] * dv;
                    if N == 3 {
                        shear -= spring.lever * (here[2][lane] + w_o[lane]);
                    }
                    let f_t = share[lane] * spring.k_t * shear;
                    y[0][lane] -= sign * (spring.n[0] * f_n + spring.t[0] * f_t);
                    y[1][lane] -= sign * (spring.n[1] * f_n + spring.t[1] * f_t);
                    if N == 3 {
                        y[2][lane] -= spring.lever * f_t;
                    }
                }
            }
        }
        y
    }

    /// The springs that a broken bond of stencil entry k takes out between its owner and the other end: normal and tangential,
    /// each empty where its stiffness is zero.
    pub(super) fn springs_of(&self, k: usize, share: f64, [a, b]: [End; 2]) -> [Term; 2] {
        let spring = &self.springs[k];
        let across = |stiffness: f64, along: [f64; 2], lever: f64| {
            let mut vector = Vec::new();
            if share * stiffness > 0.0 {
                let root = (share * stiffness).sqrt();
                vector.extend((0..2).flat_map(|c| [a.entry(c, -root * along[c]), b.entry(c, root * along[c])]));
                if lever != 0.0 {
                    vector.extend([a.entry(2, -root * lever), b.entry(2, -root * lever)]);
                }
            }
            Term { sign: -1.0, vector }
        };
        [across(spring.k_n, spring.n, 0.0), across(spring.k_t, spring.t, if N == 3 { spring.lever } else { 0.0 })]
    }

    /// Block K_ij of a point with itself (`None`) or with the other end of its stencil bond k in direction ±1, zero rows and
    /// columns for held components not applied.
    pub(super) fn bond_blocks(&self, k: usize, sign: f64, share: f64) -> ([[f64; N]; N], [[f64; N]; N]) {
        let spring = &self.springs[k];
        let (mut own, mut off) = ([[0.0; N]; N], [[0.0; N]; N]);
        for i in 0..2 {
            for j in 0..2 {
                let a = share * (spring.k_n * spring.n[i] * spring.n[j] + spring.k_t * spring.t[i] * spring.t[j]);
                own[i][j] = a;
                off[i][j] = -a;
            }
        }
        if N == 3 {
            let couple = share * spring.k_t * spring.lever;
            for i in 0..2 {
                let c = sign * couple * spring.t[i];
                // ∂²/∂u_i∂θ_i = ∂²/∂u_i∂θ_j = +c at the owner, -c at the other end.
                own[i][2] = c;
                own[2][i] = c;
                off[i][2] = c;
                off[2][i] = -c;
            }
            own[2][2] = couple * spring.lever;
            off[2][2] = couple * spring.lever;
        }
        (own, off)
    }
}

#[inline(always)]
pub(super) fn load(x: &[f64], at: usize) -> Lanes {
    let mut lanes = [0.0; LANES];
    lanes.copy_from_slice(&x[at..at + LANES]);
    lanes
}

#[inline(always)]
pub(super) fn load_f32(x: &[f32], at: usize) -> Lanes {
    let mut lanes = [0.0; LANES];
    for (lane, &value) in lanes.iter_mut().zip(&x[at..at + LANES]) {
        *lane = f64::from(value);
    }
    lanes
}
