//! Forces of springs in every bond of a net: the list kernel, for any arrangement of points.
//!
//! A bond ξ with relative displacement η has `e_n = η·n`, `e_t = η·t - r (θ + θ')`, stretch `s = e_n/|ξ|`, shear angle
//! `γ = e_t/|ξ|`, energy `½ (1-D) (k_n e_n² + k_t e_t²)`. With true stretch `e_n = |ξ + η| - |ξ|` along the deformed bond.
//! Forces are worked out bond by bond, then gathered point by point, both in parallel and always in the same order.

use rayon::prelude::*;

use super::bonds::BondState;
use super::failure::{Failure, Measures};
use super::interaction::{Damaging, Interaction, Memory, Reaction};
use perilife_points::net::{Net, NetBond};

/// Bonds or points that one task works through.
const TASK: usize = 4096;

pub struct Springs<'n> {
    net: &'n Net,
    failure: Failure,
    finite: bool,
    /// Force on the owner of every bond, and the couple on both ends (zero with two unknowns).
    pulls: Vec<[f64; 3]>,
    /// Displacement at the last evaluation.
    last: Vec<f64>,
}

impl<'n> Springs<'n> {
    /// Springs with their law of damage; `finite` for true stretch, which needs two unknowns and no tangential springs.
    pub fn new(net: &'n Net, failure: Failure, finite: bool) -> Self {
        Springs { net, failure, finite, pulls: vec![[0.0; 3]; net.bonds.len()], last: vec![0.0; net.unknowns * net.len()] }
    }

    /// Displacement differences of a bond: normal part, tangential part, unit vector of the pull.
    #[inline(always)]
    pub(super) fn strain<const FINITE: bool, const N: usize>(bond: &NetBond, u: &[f64]) -> (f64, f64, [f64; 2]) {
        let n = bond.normal;
        if FINITE {
            let (a, b) = (bond.from as usize * N, bond.to as usize * N);
            let y = [0, 1].map(|i| bond.length * n[i] + (u[b + i] - u[a + i]));
            let length = (y[0] * y[0] + y[1] * y[1]).sqrt();
            return (length - bond.length, 0.0, [y[0] / length, y[1] / length]);
        }
        let [e_n, e_t] = bond.deformation::<N>(u);
        (e_n, e_t, n)
    }

    /// `|ξ + η|²/|ξ|² - 1`.
    #[inline(always)]
    pub(super) fn elongation<const N: usize>(bond: &NetBond, u: &[f64]) -> f64 {
        let (a, b) = (bond.from as usize * N, bond.to as usize * N);
        let eta = [u[b] - u[a], u[b + 1] - u[a + 1]];
        let along = eta[0] * bond.normal[0] + eta[1] * bond.normal[1];
        (2.0 * along * bond.length + eta[0] * eta[0] + eta[1] * eta[1]) / (bond.length * bond.length)
    }

    /// Forces of the bonds `first..` of one task.
    fn forces<const FINITE: bool, const N: usize>(&self, u: &[f64], damaging: Damaging, task: Task<'_>) -> Reaction {
        let mut reaction = Reaction::default();
        let bonds = &self.net.bonds[task.first..task.first + task.pulls.len()];
        for (i, bond) in bonds.iter().enumerate() {
            let before = task.share[i];
            if before == 0.0 {
                task.pulls[i] = [0.0; 3];
                continue;
            }
            let (e_n, e_t, n) = Self::strain::<FINITE, N>(bond, u);
            let energy = 0.5 * (bond.k_n * e_n * e_n + bond.k_t * e_t * e_t);
            if damaging == Damaging::Allowed && task.may_fail[i] {
                let at = Measures {
                    stretch: e_n / bond.length,
                    elongation: Self::elongation::<N>(bond, u),
                    shear: e_t / bond.length,
                    ratio: bond.k_t / bond.k_n,
                };
                let peak = task.peak[i];
                let after = self.failure.share(bond.from, at, before, &mut task.peak[i]);
                if after != before {
                    task.share[i] = after;
                    reaction.released += match self.failure.taken_along_curve(at, after, peak) {
                        Some(share) => share * energy,
                        None => {
                            let (l_n, l_t, _) = Self::strain::<FINITE, N>(bond, &self.last);
                            0.5 * (before - after) * (bond.k_n * e_n * l_n + bond.k_t * e_t * l_t)
                        }
                    };
                    reaction.damaged = reaction.damaged.max(before - after);
                    reaction.broken += usize::from(after == 0.0);
                }
            }
            let share = task.share[i];
            reaction.strain += share * energy;
            let (normal, tangential) = (share * bond.k_n * e_n, share * bond.k_t * e_t);
            task.pulls[i] = bond.force::<N>(n, normal, tangential);
        }
        reaction
    }

    fn pull_all<const FINITE: bool, const N: usize>(&mut self, u: &[f64], bonds: &mut BondState, damaging: Damaging) -> Reaction {
        let mut pulls = std::mem::take(&mut self.pulls);
        let tasks = pulls
            .par_chunks_mut(TASK)
            .zip(bonds.share.par_chunks_mut(TASK))
            .zip(bonds.peak.par_chunks_mut(TASK))
            .zip(bonds.may_fail.par_chunks(TASK))
            .enumerate()
            .map(|(i, (((pulls, share), peak), may_fail))| Task { first: i * TASK, pulls, share, peak, may_fail });
        let parts: Vec<Reaction> = tasks.map(|task| self.forces::<FINITE, N>(u, damaging, task)).collect();
        self.pulls = pulls;
        parts.into_iter().fold(Reaction::default(), Reaction::and)
    }
}

/// A stretch of bonds with their state.
struct Task<'t> {
    first: usize,
    pulls: &'t mut [[f64; 3]],
    share: &'t mut [f64],
    peak: &'t mut [f64],
    may_fail: &'t [bool],
}

impl Interaction for Springs<'_> {
    fn unknowns(&self) -> usize {
        self.net.unknowns
    }

    fn internal_force(&mut self, u: &[f64], bonds: &mut BondState, damaging: Damaging, force: &mut [f64]) -> Reaction {
        let reaction = match (self.finite, self.net.unknowns) {
            (true, _) => self.pull_all::<true, 2>(u, bonds, damaging),
            (false, 2) => self.pull_all::<false, 2>(u, bonds, damaging),
            (false, _) => self.pull_all::<false, 3>(u, bonds, damaging),
        };
        if self.net.unknowns == 3 {
            self.net.gather::<3>(&self.pulls, force)
        } else {
            self.net.gather::<2>(&self.pulls, force)
        }
        self.last.copy_from_slice(u);
        reaction
    }

    fn stiffness_bound(&self, bonds: &BondState) -> Vec<[f64; 2]> {
        stiffness_bound(self.net, bonds)
    }

    fn memory(&self) -> Memory {
        Memory { displacement: self.last.clone(), ..Memory::default() }
    }

    fn restore(&mut self, memory: &Memory, _: &BondState) -> bool {
        let fits = memory.displacement.len() == self.last.len();
        if fits {
            self.last.copy_from_slice(&memory.displacement);
        }
        fits
    }
}

/// Blocks of displacement and rotation apart: `λ(K_ii) + Σ |K_ij|`, both at the most `Σ max(k_n, k_t)`; for the rotation
/// `Σ 2 k_t r²`, and the coupling `Σ 2 k_t r` shared out half by half.
pub fn stiffness_bound(net: &Net, bonds: &BondState) -> Vec<[f64; 2]> {
    let of_point = |point: usize| {
        let (mut xx, mut xy, mut yy, mut beside, mut turn, mut couple) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for (b, ..) in net.bonds_of(point) {
            let (bond, share) = (&net.bonds[b], bonds.share[b]);
            let (n, t) = (bond.normal, bond.tangent());
            let (k_n, k_t) = (share * bond.k_n, share * bond.k_t);
            xx += k_n * n[0] * n[0] + k_t * t[0] * t[0];
            xy += k_n * n[0] * n[1] + k_t * t[0] * t[1];
            yy += k_n * n[1] * n[1] + k_t * t[1] * t[1];
            beside += k_n.max(k_t);
            turn += 2.0 * k_t * bond.lever * bond.lever;
            couple += 2.0 * k_t * bond.lever;
        }
        let largest = 0.5 * (xx + yy) + (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
        if net.unknowns == 3 { [largest + beside + couple, turn + couple] } else { [largest + beside, 0.0] }
    };
    (0..net.len()).into_par_iter().map(of_point).collect()
}
