//! Adaptive dynamic relaxation of any [`Interaction`]: damped motion to rest (Underwood 1983; Kilic and Madenci 2010, Theor.
//! Appl. Fract. Mech. 53:194).
//!
//! ```text
//! Λ ü + c Λ u̇ = F,  F = f - ∂W/∂u,  time step 1
//! u̇(n+½) = [(2 - c) u̇(n-½) + 2 F(n) / Λ] / (2 + c),  u̇(½) = F(0) / 2 Λ
//! u(n+1) = u(n) + u̇(n+½)
//! ```
//!
//! Central differences are stable for `K ≤ 4 Λ`; the density is a quarter of [`Interaction::stiffness_bound`], point by point,
//! rotations by their own. The damping is critical for the motion there is, `c = 2 ω`, `ω² = u̇ᵀ K u̇ / u̇ᵀ Λ u̇` with K u̇ from the
//! change of F over a step, and lowered by a fixed factor, since such a quotient lies above the lowest frequency
//! ([`perilife_points::solver`] measures both choices on lattices).
//!
//! Bonds are damaged at rest, never on the way: the swing overshoots equilibrium (up to twofold without damping) and
//! would break bonds that no load breaks. What is damaged at rest disturbs the rest, so relaxation and damage alternate until
//! nothing is damaged any more.

use serde::{Deserialize, Serialize};

use super::super::bonds::BondState;
use super::super::interaction::{Damaging, Interaction, Reaction};

/// Damping over what is critical for the estimated frequency.
const DAMPING_SHARE: f64 = 0.85;
/// Largest damping: above 2 velocities would change sign at every step.
const DAMPING_MAX: f64 = 1.9;
/// Growth of the residual at which the motion counts as blown up. From rest, every mode of a stable motion keeps its residual
/// below that of the start; an unstable one grows at the least twofold a step once the bound fails by a tenth, so that ten
/// steps suffice to see it.
const BLOWN_UP: f64 = 10.0;

/// Growth of damage in a bond that disturbs the rest.
const QUIET: f64 = 1e-4;
/// Alternations of rest and damage after which there is no rest.
const PASSES: usize = 20_000;

/// When bonds may be damaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Breaking {
    Never,
    /// At rest, over and over until nothing more is damaged.
    #[default]
    AtRest,
}

/// What holds and pushes the points; layout of [`Interaction`].
#[derive(Debug, Clone, Copy)]
pub struct Loads<'a> {
    /// Unknowns that keep the value they have.
    pub held: &'a [bool],
    /// Forces on the unknowns, N.
    pub external: &'a [f64],
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// Residual over load at rest, both as root of the sum of squares; load = external forces and forces on held unknowns.
    pub tolerance: f64,
    /// Iterations between two damages after which there is no rest.
    pub iterations: usize,
    /// When bonds may be damaged.
    pub breaking: Breaking,
    /// Bonds after whose break the state is handed back although it is not at rest.
    pub broken: usize,
    /// Load, N, that the residual is compared with at the least.
    pub least_load: f64,
}

impl Default for Relaxation {
    fn default() -> Self {
        Relaxation { tolerance: 1e-6, iterations: 40_000, breaking: Breaking::AtRest, broken: usize::MAX, least_load: 0.0 }
    }
}

/// How a relaxation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RestEnd {
    AtRest,
    /// So many bonds have broken that the caller wanted to hear of it; the displacement is that before the last of them.
    Breaking,
    /// Not at rest within the iterations or passes.
    NoConvergence,
    /// The motion grew instead of coming to rest: the stiffness exceeds its bound.
    BlownUp,
}

/// What a relaxation found.
#[derive(Debug, Clone, PartialEq)]
pub struct Rested {
    pub end: RestEnd,
    pub evaluations: usize,
    /// Residual over load.
    pub residual: f64,
    /// Energies and breaks, summed over the relaxation; the strain energy is the last.
    pub reaction: Reaction,
    /// Forces of the interaction at the end, N.
    pub force: Vec<f64>,
}

impl Relaxation {
    /// Moves `u` from where it is to rest. Held unknowns stay: the caller puts them where they belong first.
    pub fn relax(&self, interaction: &mut dyn Interaction, bonds: &mut BondState, loads: Loads<'_>, u: &mut [f64]) -> Rested {
        let mut rested = Rested {
            end: RestEnd::AtRest,
            evaluations: 0,
            residual: 0.0,
            reaction: Reaction::default(),
            force: vec![0.0; u.len()],
        };
        let mut passes = 0;
        loop {
            let mobility = mobility(interaction, bonds, loads.held);
            self.settle(interaction, bonds, loads, &mobility, u, &mut rested);
            passes += 1;
            if self.breaking != Breaking::AtRest || rested.end != RestEnd::AtRest {
                return rested;
            }
            let damage = interaction.internal_force(u, bonds, Damaging::Allowed, &mut rested.force);
            rested.evaluations += 1;
            rested.add(damage);
            if damage.broken == 0 && damage.damaged <= QUIET {
                return rested;
            }
            if rested.reaction.broken > self.broken {
                rested.end = RestEnd::Breaking;
                return rested;
            }
            if passes >= PASSES {
                rested.end = RestEnd::NoConvergence;
                return rested;
            }
        }
    }

    /// To rest, with bonds that keep their state.
    fn settle(
        &self,
        interaction: &mut dyn Interaction,
        bonds: &mut BondState,
        loads: Loads<'_>,
        mobility: &[f64],
        u: &mut [f64],
        rested: &mut Rested,
    ) {
        let mut swing = Swing::at_rest(u.len());
        let mut start = 0.0_f64;
        for iteration in 0..self.iterations {
            let reaction = interaction.internal_force(u, bonds, Damaging::Frozen, &mut rested.force);
            rested.evaluations += 1;
            rested.add(reaction);
            let sums = swing.take(loads, mobility, &rested.force);
            if iteration == 0 {
                start = sums.acceleration;
            }
            if sums.acceleration.is_nan() || sums.acceleration > BLOWN_UP * BLOWN_UP * start {
                rested.end = RestEnd::BlownUp;
                return;
            }
            let brought = interaction.driven().map_or(0.0, |driven| driven.load);
            let load = sums.load.sqrt().max(brought).max(self.least_load);
            rested.residual = if sums.square == 0.0 { 0.0 } else { sums.square.sqrt() / load };
            if rested.residual <= self.tolerance {
                return;
            }
            swing.step(mobility, (iteration > 0).then(|| sums.damping()), u);
        }
        rested.end = RestEnd::NoConvergence;
    }
}

impl Rested {
    fn add(&mut self, reaction: Reaction) {
        let strain = reaction.strain;
        self.reaction = Reaction { strain, ..self.reaction.and(reaction) };
    }
}

/// 1/Λ of every unknown, m/N; 0 where nothing moves.
pub(super) fn mobility(interaction: &dyn Interaction, bonds: &BondState, held: &[bool]) -> Vec<f64> {
    let unknowns = interaction.unknowns();
    let inverse = |bound: f64| if bound > 0.0 { 4.0 / bound } else { 0.0 };
    let bounds = interaction.stiffness_bound(bonds);
    let of_point = |bound: &[f64; 2]| [inverse(bound[0]), inverse(bound[0]), inverse(bound[1])].into_iter().take(unknowns);
    bounds.iter().flat_map(of_point).zip(held).map(|(mobility, &held)| if held { 0.0 } else { mobility }).collect()
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Swing {
    /// u̇(n-½), m.
    velocity: Vec<f64>,
    /// F, N; 0 where nothing moves.
    residual: Vec<f64>,
}

/// Sums over all unknowns.
#[derive(Default)]
pub(super) struct Sums {
    square: f64,
    /// F·Λ⁻¹F, N m.
    acceleration: f64,
    /// Square of the load, N².
    load: f64,
    /// u̇ᵀ K u̇, N m.
    stiffness: f64,
    /// u̇ᵀ Λ u̇, N m.
    mass: f64,
}

impl Sums {
    /// c, at the most [`DAMPING_MAX`].
    pub(super) fn damping(&self) -> f64 {
        let square = if self.mass > 0.0 { self.stiffness / self.mass } else { 0.0 };
        (DAMPING_SHARE * 2.0 * square.max(0.0).sqrt()).min(DAMPING_MAX)
    }
}

impl Swing {
    /// No motion yet, of so many unknowns.
    pub(super) fn at_rest(unknowns: usize) -> Self {
        Swing { velocity: vec![0.0; unknowns], residual: vec![0.0; unknowns] }
    }

    /// Whether it is that of so many unknowns.
    pub(super) fn has(&self, unknowns: usize) -> bool {
        self.velocity.len() == unknowns && self.residual.len() == unknowns
    }

    /// Takes the new residual, and what the step towards it shows.
    pub(super) fn take(&mut self, loads: Loads<'_>, mobility: &[f64], force: &[f64]) -> Sums {
        let mut sums = Sums::default();
        for (i, (&force, &external)) in force.iter().zip(loads.external).enumerate() {
            sums.load += if loads.held[i] { force * force } else { external * external };
            if mobility[i] == 0.0 {
                continue;
            }
            let (new, v) = (force + external, self.velocity[i]);
            sums.square += new * new;
            sums.acceleration += new * new * mobility[i];
            sums.stiffness += v * (self.residual[i] - new);
            sums.mass += v * v / mobility[i];
            self.residual[i] = new;
        }
        sums
    }

    /// Moves on with this damping; from rest without one.
    pub(super) fn step(&mut self, mobility: &[f64], damping: Option<f64>, u: &mut [f64]) {
        let (keep, push) = damping.map_or((0.0, 0.5), |c| ((2.0 - c) / (2.0 + c), 2.0 / (2.0 + c)));
        for (i, u) in u.iter_mut().enumerate() {
            self.velocity[i] = keep * self.velocity[i] + push * self.residual[i] * mobility[i];
            *u += self.velocity[i];
        }
    }
}
