//! Non-ordinary state-based (correspondence) peridynamics: a point's stress from the deformation of its whole neighbourhood
//! (Silling, Epton, Weckner, Xu and Askari 2007, J. Elasticity 88:151, section 18).
//!
//! With bonds ξ = x' - x, relative displacements η = u' - u, influence w = 1 and sums over the intact bonds of a point:
//!
//! ```text
//! K = Σ w ξ ⊗ ξ V'                  shape tensor, m⁵ (equation 3 of the source)
//! H = (Σ w η ⊗ ξ V') K⁻¹            displacement gradient, F = I + H
//! e = (H + Hᵀ + Hᵀ H)/2             Green strain (4)
//! S = C : e,   P = F S              second and first Piola-Kirchhoff stress, Pa
//! T⟨ξ⟩ = w P K⁻¹ ξ                  force state, N/m⁶ (5); force on x: Σ (T[x]⟨ξ⟩ - T[x']⟨-ξ⟩) V V'
//! ```
//!
//! The energy is `Σ V S:e/2`, to which the control of zero-energy modes adds its own ([`elasticity::Control`]). Linear fields are exact
//! at every point, those at the rim among them, so there is no surface correction.
//!
//! Where broken bonds enter ([`super::scene::DamageEntry`]) decides what a crack does to the stress beside it. In the influence function
//! (w → μ w, equation 18) K and F forget the broken bonds and the stress is released; force and energy belong together.
//! In the force alone (T → μ T, equation 16) F goes on to see the crack open, and the stress grows where it should vanish; such
//! forces have no energy, and that which is reported counts the stress as it stands. Initial cracks are geometry and enter
//! both.
//!
//! Points without intact bonds, or with bonds along one line only, have no K⁻¹: they bear no stress. Once bonds break, the last
//! ones of such a point break too. Else pairs of long bonds would bridge a crack by a point in its middle for good: half of
//! their mean stress is that point's, which is zero.

pub mod criterion;
pub mod elasticity;
mod shape;

use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;

use super::bonds::BondState;
use super::interaction::{Damaging, Interaction, Memory, Reaction};
use super::scene::{Procedure, Scene, ZeroEnergyControl};
use criterion::Criterion;
use elasticity::{Control, Elasticity};
use perilife_base::error::Result;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::net::Net;
use shape::{Neighbour, Neighbours, Shape};

/// Points that one task works through.
const TASK: usize = 256;

/// Allowance for finite strain in the bound of the stiffness: `|F|²` up to a strain of 5 %.
const FINITE_STRAIN: f64 = 1.1;

/// Law whose body has the points and bonds of correspondence. Its springs are not used, and any Poisson's ratio suits it.
pub const NET_LAW: BondLaw = BondLaw {
    kind: BondLawKind::StateBased,
    kernel: Kernel::Constant,
    rotation: Rotation::Free,
    surface_correction: SurfaceCorrection::None,
};

/// Correspondence forces on a net of pairs.
pub struct Correspondence<'n> {
    net: &'n Net,
    elasticity: Elasticity,
    control: Control,
    criterion: Criterion,
    neighbours: Neighbours,
    shape: Shape,
    points: Vec<Deformation>,
}

/// What a point's neighbourhood does.
#[derive(Debug, Clone, Copy)]
struct Deformation {
    /// Displacement gradient H.
    gradient: Matrix2<f64>,
    /// `P K⁻¹`, less `c/2 H` where the control takes uniform strain out: times ξ it is the point's part in the force of a bond.
    pull: Matrix2<f64>,
    /// Strain energy without that of the control, J.
    energy: f64,
    whole: bool,
}

impl Deformation {
    const NONE: Deformation = Deformation {
        gradient: Matrix2::new(0.0, 0.0, 0.0, 0.0),
        pull: Matrix2::new(0.0, 0.0, 0.0, 0.0),
        energy: 0.0,
        whole: false,
    };
}

impl<'n> Correspondence<'n> {
    /// The law of a scene on its net.
    /// Errors: a damage law that correspondence does not have, a missing strength or fracture energy, a factor of the control below 0.
    pub fn new(scene: &Scene, net: &'n Net, control: ZeroEnergyControl, factor: f64) -> Result<Self> {
        let neighbours = Neighbours::of(net);
        let all_at_once = matches!(scene.procedure, Procedure::Dynamic { .. });
        Ok(Correspondence {
            elasticity: Elasticity::of(&scene.material),
            control: Control::new(control, factor, &scene.material, scene.specimen.thickness, net)?,
            criterion: Criterion::of(scene, net, all_at_once)?,
            shape: Shape::new(net, &neighbours, scene.damage.enters),
            points: vec![Deformation::NONE; net.len()],
            neighbours,
            net,
        })
    }

    /// Displacement gradient H of every point at the last evaluation.
    pub fn gradients(&self) -> impl Iterator<Item = Matrix2<f64>> + '_ {
        self.points.iter().map(|point| point.gradient)
    }

    /// Cauchy stress `F S Fᵀ / det F` of every point at the last evaluation, Pa.
    pub fn stresses(&self) -> impl Iterator<Item = Matrix2<f64>> + '_ {
        self.points.iter().map(|point| self.stress(point))
    }

    fn stress(&self, point: &Deformation) -> Matrix2<f64> {
        if point.whole { self.elasticity.cauchy(&point.gradient) } else { Matrix2::zeros() }
    }

    /// First Piola-Kirchhoff stress as the forces of a point's own bonds carry it, `Σ T⟨ξ⟩ ⊗ ξ V'`, Pa.
    pub fn carried(&self, u: &[f64], point: usize) -> Matrix2<f64> {
        let at = &self.points[point];
        let state = |n: &Neighbour| {
            let kept = if at.whole { self.control.on_uneven() } else { 0.0 };
            let eta = relative(u, point, n.other as usize);
            let own = at.pull * n.xi + 0.5 * (kept + self.control.on_relative()) * eta;
            own * n.xi.transpose() * self.net.volumes[n.other as usize]
        };
        self.neighbours.of_point(point).iter().filter(|n| self.shape.bears(n.bond)).map(state).sum()
    }

    /// H, stress and pull of all points.
    fn deform(&mut self, u: &[f64]) {
        let (net, shape, neighbours) = (self.net, &self.shape, &self.neighbours);
        let (elasticity, uniform) = (self.elasticity, self.control.on_uneven());
        self.points.par_chunks_mut(TASK).enumerate().for_each(|(task, points)| {
            for (i, point) in points.iter_mut().enumerate() {
                let at = task * TASK + i;
                let Some(inverse) = shape.inverse(at) else {
                    *point = Deformation::NONE;
                    continue;
                };
                let mut sum = Matrix2::zeros();
                for n in neighbours.of_point(at).iter().filter(|n| shape.counts(n.bond)) {
                    let other = n.other as usize;
                    sum += net.volumes[other] * relative(u, at, other) * n.xi.transpose();
                }
                let gradient = sum * inverse;
                let (first, density) = elasticity.first_piola_kirchhoff(&gradient);
                let pull = first * inverse - 0.5 * uniform * gradient;
                *point = Deformation { gradient, pull, energy: net.volumes[at] * density, whole: true };
            }
        });
    }

    /// Forces of all points, and the strain energy, J.
    ///
    /// With the share q = 1 of an end that has K⁻¹ (else 0) the force of a bond is
    /// `V V' [(A + A') ξ + (c_I + c_z (q + q')/2) η]`, A the pull of an end.
    fn push(&self, u: &[f64], force: &mut [f64]) -> f64 {
        let (net, shape) = (self.net, &self.shape);
        let (relative_c, uniform_c) = (self.control.on_relative(), self.control.on_uneven());
        let parts: Vec<f64> = force
            .par_chunks_mut(2 * TASK)
            .enumerate()
            .map(|(task, force)| {
                let mut energy = 0.0;
                for (i, force) in force.chunks_exact_mut(2).enumerate() {
                    let at = task * TASK + i;
                    let here = &self.points[at];
                    let own = if here.whole { uniform_c } else { 0.0 };
                    let (mut sum, mut control) = (Vector2::zeros(), 0.0);
                    for n in self.neighbours.of_point(at).iter().filter(|n| shape.bears(n.bond)) {
                        let other = n.other as usize;
                        let (volume, there) = (net.volumes[other], &self.points[other]);
                        let eta = relative(u, at, other);
                        let uneven = eta - here.gradient * n.xi;
                        control += volume * (own * uneven.norm_squared() + relative_c * eta.norm_squared());
                        let stiffness = relative_c + 0.5 * (own + if there.whole { uniform_c } else { 0.0 });
                        sum += volume * ((here.pull + there.pull) * n.xi + stiffness * eta);
                    }
                    let volume = net.volumes[at];
                    force.copy_from_slice((volume * sum).as_slice());
                    energy += here.energy + 0.25 * volume * control;
                }
                energy
            })
            .collect();
        parts.into_iter().sum()
    }
}

/// η of a bond from one point to another.
#[inline(always)]
fn relative(u: &[f64], from: usize, to: usize) -> Vector2<f64> {
    Vector2::new(u[2 * to] - u[2 * from], u[2 * to + 1] - u[2 * from + 1])
}

impl Interaction for Correspondence<'_> {
    fn unknowns(&self) -> usize {
        2
    }

    fn internal_force(&mut self, u: &[f64], bonds: &mut BondState, damaging: Damaging, force: &mut [f64]) -> Reaction {
        self.shape.follow(self.net, &self.neighbours, bonds);
        self.deform(u);
        let mut reaction = Reaction { strain: self.push(u, force), ..Reaction::default() };
        if damaging == Damaging::Allowed {
            let strengths = |i: usize| elasticity::first_principal(&self.stress(&self.points[i]));
            reaction.broken = self.criterion.break_bonds(self.net, u, strengths, bonds);
            if reaction.broken > 0 {
                reaction.damaged = 1.0;
                self.shape.follow(self.net, &self.neighbours, bonds);
                reaction.broken += self.shape.drop_idle(self.net, bonds);
                self.shape.follow(self.net, &self.neighbours, bonds);
                self.deform(u);
                let before = reaction.strain;
                reaction.strain = self.push(u, force);
                reaction.released = before - reaction.strain;
            }
        }
        reaction
    }

    /// A bound of every point, N/m.
    ///
    /// `H = Σ u' ⊗ g` with `g = V' K⁻¹ ξ`, and `-Σ g` at the point itself, so the block of two points in the energy `V H:C:H/2` of
    /// a third is at the most `V λ |g| |g'|`, λ the largest eigenvalue of C. The rows sum to `λ Σ V |g| Σ |g'|` over the
    /// neighbourhoods to which a point belongs. Springs of stiffness `c V V'` add twice their sum; those on the uneven part, a
    /// projection, at the most as much.
    fn stiffness_bound(&self, bonds: &BondState) -> Vec<[f64; 2]> {
        let (net, neighbours) = (self.net, &self.neighbours);
        let mut shape = self.shape.clone();
        shape.follow(net, neighbours, bonds);
        // |g| at the point itself, and Σ |g| over its neighbourhood with itself.
        let sums = |i: usize| {
            let Some(inverse) = shape.inverse(i) else { return [0.0; 2] };
            let (mut whole, mut lengths) = (nalgebra::Vector2::zeros(), 0.0);
            for n in neighbours.of_point(i).iter().filter(|n| shape.counts(n.bond)) {
                let g = net.volumes[n.other as usize] * inverse * n.xi;
                whole += g;
                lengths += g.norm();
            }
            [whole.norm(), lengths + whole.norm()]
        };
        let sums: Vec<[f64; 2]> = (0..net.len()).into_par_iter().with_min_len(256).map(sums).collect();
        let spring = self.control.on_relative() + self.control.on_uneven();
        let of_point = |i: usize| {
            let volume = net.volumes[i];
            let (mut rows, mut springs) = (volume * sums[i][0] * sums[i][1], 0.0);
            for n in neighbours.of_point(i) {
                let other = n.other as usize;
                if let Some(inverse) = shape.inverse(other).filter(|_| shape.counts(n.bond)) {
                    rows += net.volumes[other] * volume * (inverse * n.xi).norm() * sums[other][1];
                }
                if shape.bears(n.bond) {
                    springs += 2.0 * spring * volume * net.volumes[other];
                }
            }
            [FINITE_STRAIN * self.elasticity.largest() * rows + springs, 0.0]
        };
        (0..net.len()).into_par_iter().with_min_len(256).map(of_point).collect()
    }

    /// Nothing: shape tensors follow the bonds before every evaluation, and those of a point are always summed up whole.
    fn memory(&self) -> Memory {
        Memory::default()
    }

    fn restore(&mut self, memory: &Memory, _: &BondState) -> bool {
        *memory == Memory::default()
    }
}
