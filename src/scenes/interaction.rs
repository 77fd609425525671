//! What a method has to supply: forces of the points for a displacement, and which bonds that damages.

use serde::{Deserialize, Serialize};

use super::bonds::BondState;

/// What one evaluation of the forces found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reaction {
    /// Strain energy, J.
    pub strain: f64,
    /// Energy that damage has taken in this evaluation, J: `½ (d' - d) (k_n e_n e_n' + k_t e_t e_t')` of every bond, with its share
    /// d and its strains at the evaluation before and at this one. That is what is missing from its work, by the trapezoidal
    /// rule, over the way between them; the energy at this displacement alone would count the way after the break, a fifth
    /// too much where a crack runs through a bond in a few time steps.
    pub released: f64,
    /// Bonds that broke in this evaluation.
    pub broken: usize,
    /// Largest growth of a bond's damage in this evaluation, 0 to 1.
    pub damaged: f64,
}

impl Reaction {
    /// Both together.
    pub fn and(self, other: Reaction) -> Reaction {
        Reaction {
            strain: self.strain + other.strain,
            released: self.released + other.released,
            broken: self.broken + other.broken,
            damaged: self.damaged.max(other.damaged),
        }
    }
}

/// Rigid bodies that an interaction moves by itself (platens), as its last evaluation found them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Driven {
    /// Way they have gone, summed over them, m.
    pub displacement: f64,
    /// Mean force on them against their motion, N.
    pub load: f64,
    /// Work that they do per share of their whole way, J.
    pub rate: f64,
    /// Work that they have done so far, J: force times way from evaluation to evaluation, by the trapezoidal rule.
    pub work: f64,
    /// Largest depth by which a point has passed one, m.
    pub penetration: f64,
}

/// What an interaction keeps from evaluation to evaluation beside the state of the bonds.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Memory {
    /// Displacement at the last evaluation, two or three values a point along the interaction's own axes; empty where none is looked back at.
    pub displacement: Vec<f64>,
    /// Way and force of every platen at the last evaluation, m and N.
    pub platens: Vec<(f64, f64)>,
    /// What the platens did.
    pub driven: Driven,
}

/// Whether an evaluation of the forces may damage bonds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Damaging {
    /// Bonds keep their state.
    Frozen,
    /// Bonds beyond their limits are damaged first.
    Allowed,
}

/// Forces between points. Displacements and forces are `[x, y]` or `[x, y, θ]` a point, point by point, m and N.
pub trait Interaction: Send {
    /// Unknowns of a point, 2 or 3.
    fn unknowns(&self) -> usize;

    /// Told of the share of the full load before forces at it are asked for, for interactions that bring loads themselves.
    fn load_to(&mut self, _level: f64) {}

    /// The same for motion in time, where every load rises by itself: told of the time, s.
    fn load_at(&mut self, _time: f64) {}

    /// Writes the internal forces -dW/du at displacement `u` into `force`, after damage by `u` where that is allowed.
    fn internal_force(&mut self, u: &[f64], bonds: &mut BondState, damaging: Damaging, force: &mut [f64]) -> Reaction;

    /// Upper bound of the largest eigenvalue of every point's rows of the stiffness (Gershgorin), N/m, for displacements and, with
    /// three unknowns, for the rotation: what density and time step of explicit motion follow from.
    fn stiffness_bound(&self, bonds: &BondState) -> Vec<[f64; 2]>;

    /// All that later evaluations depend on beside displacement, load and the state of the bonds.
    fn memory(&self) -> Memory;

    /// Goes on from the [`Interaction::memory`] of an earlier run, at whose end the bonds stood like this; whether it is one of this
    /// interaction.
    fn restore(&mut self, memory: &Memory, bonds: &BondState) -> bool;

    /// What the interaction moves by itself; `None` where there is nothing.
    fn driven(&self) -> Option<Driven> {
        None
    }
}
