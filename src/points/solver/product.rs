//! The stiffness product y = K x of a lattice body, without a matrix.
//!
//! Energy of a bond between points i and j = i + ξ: `½ m [k_n (n·(u_j - u_i))² + k_t (t·(u_j - u_i) - r (θ_i + θ_j))²]`
//! with multiplier m and lever r = |ξ|/(2Δ); θ = φ Δ is the point's rotation in units of length. Its gradient, summed
//! over the bonds of a point, is one row of K x. Without free rotation the θ terms are absent.

use super::dilatation::Dilatation;
use super::field::{Ghosts, Layout, Real};
pub use super::kernel::Into;
use super::kernel::Kernel;
use super::spring::{Blocks, End, GapSpring, Term};
use super::ties::Ties;
use crate::body::Body;
use crate::bond_law::stencil::StencilBond;
use crate::state::Bonds;

/// Springs in double precision, for solutions. Two blocks side by side would overflow the registers.
type Double<const N: usize> = Kernel<f64, N, 1, 8>;
/// The same in single precision, for preconditioners.
type Single<const N: usize> = Kernel<f32, N, 2, 16>;

/// Stiffness product of a body for N unknowns a point.
#[derive(Debug, Clone)]
pub struct Product<const N: usize> {
    layout: Layout,
    springs: Vec<StencilBond>,
    /// Blocks of a bond of multiplier 1, of the owner and of the other end.
    blocks: Vec<[Blocks<N>; 2]>,
    double: Double<N>,
    single: Single<N>,
    /// Vector indices of held components, ascending, and for every index whether it is one of them.
    fixed: Vec<usize>,
    held: Vec<bool>,
    /// What a state-based law stores beside its springs.
    pub(super) dilatation: Option<Dilatation>,
    ghosts: Ghosts,
    /// Springs between flanks in contact.
    pub(super) contact: Vec<GapSpring>,
    /// Held sums of displacements, whose slaves are among the held components.
    pub(super) ties: Ties,
}

impl<const N: usize> Product<N> {
    /// Product for a body; N must be the number of unknowns of its law.
    pub fn new(body: &Body, fixed: Vec<usize>) -> Self {
        let layout = Layout::of(&body.lattice, N);
        let (double, single) = (Kernel::new(body, layout), Kernel::new(body, layout));
        let dilatation = Dilatation::of(body, layout);
        let (ghosts, contact, ties) = (Ghosts::of_motion(body, layout), Vec::new(), Ties::default());
        let mut held = vec![false; layout.len()];
        fixed.iter().for_each(|&index| held[index] = true);
        let springs = body.stencil.bonds.clone();
        let blocks = springs.iter().map(|spring| [1.0, -1.0].map(|sign| spring.blocks(sign))).collect();
        Product { layout, springs, blocks, double, single, fixed, held, dilatation, ghosts, contact, ties }
    }

    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Held components.
    pub fn fixed(&self) -> &[usize] {
        &self.fixed
    }

    /// Whether a component of a place is held.
    pub fn is_held(&self, place: usize, component: usize) -> bool {
        self.held[self.layout.index(place) + component * self.layout.stride]
    }

    /// Puts the mirror images of a field into its padding.
    pub(super) fn mirror<T: Real>(&self, x: &mut [T]) {
        self.ghosts.fill(x);
    }

    /// y = K x or y -= K x; held components of y become zero. x must be zero outside the points, but for its mirror images, which
    /// are put there. Slaves of held sums follow their masters, and give them their forces.
    pub fn apply(&self, bonds: &Bonds, x: &mut [f64], y: &mut [f64], into: Into) {
        self.ties.spread(x);
        self.apply_to_field(bonds, x, y, into);
    }

    /// [`Product::apply`] to a field whose slaves are where they are.
    pub(super) fn apply_to_field(&self, bonds: &Bonds, x: &mut [f64], y: &mut [f64], into: Into) {
        self.mirror(x);
        let x = &*x;
        let rows_per_task = self.layout.rows_per_task();
        self.layout.for_rows(
            rows_per_task,
            [&mut *y],
            #[inline(always)]
            |row, [out]: [&mut [f64]; 1]| {
                self.double.row(bonds, row, x, out, into);
            },
        );
        if let Some(dilatation) = &self.dilatation {
            dilatation.apply(bonds, x, y, into);
        }
        let sign = if into == Into::Set { 1.0 } else { -1.0 };
        self.contact.iter().for_each(|spring| spring.add(&self.layout, sign * spring.stiffness * spring.gap(&self.layout, x), y));
        self.ties.fold(y);
        self.fixed.iter().for_each(|&index| y[index] = 0.0);
    }

    /// r -= K x of the springs in single precision on one body row of a field that has its mirror images; held
    /// components of r become zero. `r` is that padded row.
    #[inline(always)]
    pub(super) fn subtract_row(&self, bonds: &Bonds, row: usize, x: &[f32], r: &mut [f32]) {
        self.single.row(bonds, row, x, r, Into::Subtract);
        let start = (row + self.layout.padding) * self.layout.row_len();
        let held = &self.fixed[self.fixed.partition_point(|&index| index < start)..];
        let end = start + r.len();
        held.iter().take_while(|&&index| index < end).for_each(|&index| r[index - start] = 0.0);
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
        [across(spring.k_n, spring.normal, 0.0), across(spring.k_t, spring.tangent(), if N == 3 { spring.lever } else { 0.0 })]
    }

    /// Block K_ij of a point with itself (`None`) or with the other end of its stencil bond k in direction ±1, zero rows and
    /// columns for held components not applied.
    pub(super) fn bond_blocks(&self, k: usize, sign: f64, share: f64) -> Blocks<N> {
        let (own, off) = &self.blocks[k][usize::from(sign < 0.0)];
        [own, off].map(|block| block.map(|row| row.map(|value| share * value))).into()
    }
}
