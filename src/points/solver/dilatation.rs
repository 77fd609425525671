//! Dilatation of the points of a state-based body.
//!
//! Beside its springs a state-based body stores `½ κ V (Q/Q₀) θ²` at every point. The dilatation of a point is the mean of its
//! intact bonds, weighted by their springs (Silling, Epton, Weckner, Xu and Askari 2007, J. Elasticity 88:151, section 15, in
//! the plane), lengths in spacings Δ, m the multipliers of the springs:
//!
//! ```text
//! θ = 2 D / (Q Δ),   D = Σ m k_n r n·(u' - u),   Q = Σ m k_n r²
//! ```
//!
//! With the multipliers of the balanced correction (`crate::body::balanced`), whose equations say `Σ m k_n r n = -4 S₂₂ A` of the
//! rim A that a point stands for, a uniform dilatation is in equilibrium with its traction at every point, as the springs are.
//! Without them layers along edges and flanks are too soft or too stiff by κ, and K of a central crack depends on it (0.2 to
//! 0.6 % at ν = 0.3 to 0.4 in plane strain).
//!
//! Q₀ is Q of the uncracked plate: θ is right up to a straight edge, where half of the bonds are missing, and on the face of a
//! crack the point keeps of this energy the share that it keeps of its bonds. For κ < 0 that also keeps the body stable:
//! `|κ| ≤ 2 G` is then enough, whatever has broken. The energy is `½ P D` with the stress `P = c D`, `c = 4 κ V / (Δ² Q₀ Q)`, and
//! a bond carries `m k_n r (P + P')` beside its spring force.
//!
//! With P as an unknown of its own the stiffness couples no points farther apart than a horizon:
//!
//! ```text
//! | K_springs  Dᵀ   | | u |   | f |
//! | D          -1/c | | P | = | 0 |
//! ```
//!
//! For κ > 0 it is quasi-definite: every symmetric permutation has a factorisation L D Lᵀ (Vanderbei 1995, SIAM J. Optim. 5:100).

use nalgebra::Matrix2;

use super::field::{Ghosts, Layout};
use super::kernel::{Into, load};
use super::spring::{End, Term};
use crate::body::Body;
use crate::body::lattice::LANES;
use crate::bond_law::stencil::StencilBond;
use crate::state::Bonds;

/// A value for each of [`LANES`] neighbouring places.
type Lanes = [f64; LANES];

/// One stencil bond as the dilatation uses it.
#[derive(Debug, Clone, Copy)]
struct Arm {
    step: isize,
    place_step: isize,
    /// k_n, N/m.
    k_n: f64,
    /// Unit vector n and length r in spacings.
    normal: [f64; 2],
    length: f64,
    /// k_n r n: force per stress.
    force: [f64; 2],
    /// k_n r²: share of Q.
    weight: f64,
}

/// Dilatation of a body with two unknowns a point.
#[derive(Debug, Clone)]
pub struct Dilatation {
    layout: Layout,
    arms: Vec<Arm>,
    /// c Q = 4 κ V / (Δ² Q₀) of every place, dimensionless; 0 where there is no bond.
    gain: Vec<f64>,
    /// Q of an interior point, N/m.
    whole: f64,
    ghosts: Ghosts,
}

impl Dilatation {
    /// Dilatation of a body; `None` where its law has springs alone.
    pub fn of(body: &Body, layout: Layout) -> Option<Self> {
        if body.stencil.dilatation == 0.0 {
            return None;
        }
        let spacing = body.stencil.spacing;
        let arm = |(bond, &place_step): (&StencilBond, &isize)| {
            let length = bond.length / spacing;
            let (step, force) = (layout.step(bond.dx, bond.dy), bond.normal.map(|n| bond.k_n * length * n));
            Arm { step, place_step, k_n: bond.k_n, normal: bond.normal, length, force, weight: bond.k_n * length * length }
        };
        let arms: Vec<Arm> = body.stencil.bonds.iter().zip(&body.steps).map(arm).collect();
        let modulus = 4.0 * body.stencil.dilatation / (spacing * spacing);
        let mut gain = vec![0.0; body.places()];
        for place in body.points.iter().map(|&place| place as usize) {
            let family: f64 = body.around(place).map(|(k, _, bond, _)| arms[k].weight * f64::from(body.multiplier[bond])).sum();
            gain[place] = if family > 0.0 { modulus / family } else { 0.0 };
        }
        let whole = 2.0 * arms.iter().map(|arm| arm.weight).sum::<f64>();
        Some(Dilatation { layout, arms, gain, whole, ghosts: Ghosts::of_scalar(body, layout) })
    }

    /// y += or -= the forces of the dilatation of a displacement x.
    pub fn apply(&self, bonds: &Bonds, x: &[f64], y: &mut [f64], into: Into) {
        let (stress, Layout { padding, stride, .. }) = (self.stress(bonds, x), self.layout);
        let sign = if into == Into::Set { 1.0 } else { -1.0 };
        self.layout.for_rows(
            self.layout.rows_per_task(),
            [y],
            #[inline(always)]
            |row, [out]: [&mut [f64]; 1]| {
                for chunk in 0..bonds.chunks {
                    let first = padding + chunk * LANES;
                    let place = (row + padding) * stride + first;
                    let force = if bonds.chunk_is_regular(row, chunk) {
                        self.regular_force(&stress, place)
                    } else {
                        self.masked_force(&bonds.multiplier, &stress, place)
                    };
                    for (c, force) in force.iter().enumerate() {
                        let target = &mut out[c * stride + first..][..LANES];
                        for (target, value) in target.iter_mut().zip(force) {
                            *target += sign * value;
                        }
                    }
                }
            },
        );
    }

    /// Stress P of every place under a displacement, m, mirror images included.
    pub fn stress(&self, bonds: &Bonds, x: &[f64]) -> Vec<f64> {
        let Layout { padding, stride, .. } = self.layout;
        let mut stress = vec![0.0; self.gain.len() + LANES];
        let of_place = Layout { unknowns: 1, ..self.layout };
        of_place.for_rows(
            self.layout.rows_per_task(),
            [&mut stress[..]],
            #[inline(always)]
            |row, [out]: [&mut [f64]; 1]| {
                for chunk in 0..bonds.chunks {
                    let first = padding + chunk * LANES;
                    let (at, place) = ((row + padding) * self.layout.row_len() + first, (row + padding) * stride + first);
                    let (extension, family) = if bonds.chunk_is_regular(row, chunk) {
                        (self.regular_extension(x, at), [self.whole; LANES])
                    } else {
                        self.masked_extension(&bonds.multiplier, x, at, place)
                    };
                    let gain = load::<f64, LANES>(&self.gain, place);
                    for lane in 0..LANES {
                        out[first + lane] = if family[lane] > 0.0 { gain[lane] * extension[lane] / family[lane] } else { 0.0 };
                    }
                }
            },
        );
        self.ghosts.fill(&mut stress[..self.gain.len()]);
        stress
    }

    #[inline(always)]
    fn regular_extension(&self, x: &[f64], at: usize) -> Lanes {
        let stride = self.layout.stride;
        let mut extension = [0.0; LANES];
        for arm in &self.arms {
            let (plus, minus) = (at.wrapping_add_signed(arm.step), at.wrapping_add_signed(-arm.step));
            let (u_p, u_m, v_p, v_m) = (
                load::<f64, LANES>(x, plus),
                load::<f64, LANES>(x, minus),
                load::<f64, LANES>(x, plus + stride),
                load::<f64, LANES>(x, minus + stride),
            );
            for lane in 0..LANES {
                extension[lane] += arm.force[0].mul_add(u_p[lane] - u_m[lane], arm.force[1] * (v_p[lane] - v_m[lane]));
            }
        }
        extension
    }

    /// D and Q where bonds may be missing.
    #[inline(always)]
    fn masked_extension(&self, multiplier: &[f32], x: &[f64], at: usize, place: usize) -> (Lanes, Lanes) {
        let stride = self.layout.stride;
        let (mut extension, mut family) = ([0.0; LANES], [0.0; LANES]);
        let (u, v) = (load::<f64, LANES>(x, at), load::<f64, LANES>(x, at + stride));
        self.for_directions(multiplier, place, |arm, sign, step, share| {
            let other = at.wrapping_add_signed(step);
            let (u_o, v_o) = (load::<f64, LANES>(x, other), load::<f64, LANES>(x, other + stride));
            for lane in 0..LANES {
                let along = sign * (arm.force[0] * (u_o[lane] - u[lane]) + arm.force[1] * (v_o[lane] - v[lane]));
                extension[lane] += share[lane] * along;
                family[lane] += share[lane] * arm.weight;
            }
        });
        (extension, family)
    }

    #[inline(always)]
    fn regular_force(&self, stress: &[f64], place: usize) -> [Lanes; 2] {
        let mut force = [[0.0; LANES]; 2];
        for arm in &self.arms {
            let plus = load::<f64, LANES>(stress, place.wrapping_add_signed(arm.place_step));
            let minus = load::<f64, LANES>(stress, place.wrapping_add_signed(-arm.place_step));
            for (force, along) in force.iter_mut().zip(arm.force) {
                for lane in 0..LANES {
                    force[lane] += along * (minus[lane] - plus[lane]);
                }
            }
        }
        force
    }

    #[inline(always)]
    fn masked_force(&self, multiplier: &[f32], stress: &[f64], place: usize) -> [Lanes; 2] {
        let mut force = [[0.0; LANES]; 2];
        let here = load::<f64, LANES>(stress, place);
        self.for_directions(multiplier, place, |arm, sign, _, share| {
            let step = if sign > 0.0 { arm.place_step } else { -arm.place_step };
            let other = load::<f64, LANES>(stress, place.wrapping_add_signed(step));
            for (force, along) in force.iter_mut().zip(arm.force) {
                for lane in 0..LANES {
                    force[lane] -= sign * share[lane] * along * (here[lane] + other[lane]);
                }
            }
        });
        force
    }

    /// Calls `take(arm, sign, vector step, multiplier)` for both directions of every bond, a multiplier for every lane.
    #[inline(always)]
    fn for_directions(&self, multiplier: &[f32], place: usize, mut take: impl FnMut(&Arm, f64, isize, Lanes)) {
        let places = self.gain.len();
        for (k, arm) in self.arms.iter().enumerate() {
            for (sign, step, owner) in [(1.0, arm.step, place), (-1.0, -arm.step, place.wrapping_add_signed(-arm.place_step))] {
                take(arm, sign, step, load::<f32, LANES>(multiplier, k * places + owner).map(f64::from));
            }
        }
    }

    /// 1/c of a place, N/m.
    pub(super) fn compliance(&self, body: &Body, bonds: &Bonds, place: usize) -> f64 {
        let share = |(k, _, bond, _): (usize, f64, usize, usize)| self.arms[k].weight * f64::from(bonds.multiplier[bond]);
        body.around(place).map(share).sum::<f64>() / self.gain[place]
    }

    pub(super) fn sign(&self) -> f64 {
        self.gain.iter().copied().find(|gain| *gain != 0.0).map_or(1.0, f64::signum)
    }

    /// k_n r n of a stencil bond.
    pub(super) fn force(&self, k: usize) -> [f64; 2] {
        self.arms[k].force
    }

    /// What a broken bond of stencil entry k takes out of the matrix with P as unknown, between its owner and the other
    /// end.
    ///
    /// The bond is `½ k e² + k r (P + P') e - ½ β P² - ½ β' P'²` with its opening e, `k = share k_n` and its share β of 1/c:
    /// `½ k (e + r (P + P'))²` and a quadratic form in P and P', which is brought to its principal axes.
    pub(super) fn terms_of(&self, k: usize, share: f64, [a, b]: [End; 2]) -> Vec<Term> {
        let Arm { k_n, normal, length, weight, .. } = self.arms[k];
        let (root, lever) = ((share * k_n).sqrt(), length);
        let mut vector: Vec<(usize, f64)> =
            (0..2).flat_map(|c| [a.entry(c, -root * normal[c]), b.entry(c, root * normal[c])]).collect();
        vector.extend([a.entry(2, root * lever), b.entry(2, root * lever)]);
        let mut terms = vec![Term { sign: -1.0, vector }];
        let both = share * weight;
        let form = Matrix2::new(both + both / self.gain[a.place], both, both, both + both / self.gain[b.place]);
        let axes = form.symmetric_eigen();
        for (value, axis) in axes.eigenvalues.iter().zip(axes.eigenvectors.column_iter()).filter(|(value, _)| **value != 0.0) {
            let root = value.abs().sqrt();
            terms.push(Term { sign: value.signum(), vector: vec![a.entry(2, root * axis[0]), b.entry(2, root * axis[1])] });
        }
        terms
    }
}
