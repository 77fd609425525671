//! Control by damage: at which share of the full load bonds are damaged, and by how much.
//!
//! With frozen damage all displacements are in proportion to the load, and so are the measures damage depends on. The load at
//! which damage of some bond grows next is therefore `λ = min m*(D)/m̂` with m̂ its measure at full load and m*(D) the measure
//! where its damage grows from D on; and a step in which the largest damage grows by τ has `λ = min m*(D + τ)/m̂`. Either exists
//! whether the load has to rise or to fall for it, so a step is never lost where the curve snaps back. No measure grows by
//! more than the same share τ of itself in a step: energies by the trapezoidal rule are then good to τ²/3.

use rayon::prelude::*;

use super::super::bonds::BondState;
use super::super::failure::{Failure, Measures};
use super::super::springs::Springs;
use perilife_points::net::Net;

/// Loads, relative, within which bonds count as reaching their limit together: mirror twins, and those whose order the size of a
/// step decides.
const TOGETHER: f64 = 1e-3;

/// Share of its limit in linear measures below which a bond that is too long in truth is torn by sliding.
const SLIDING: f64 = 0.9;

/// Bonds of a net with their law.
pub struct Control<'n> {
    net: &'n Net,
    failure: &'n Failure,
    last_share: f64,
    /// m̂ of every bond; 0 where it cannot be damaged.
    measure: Vec<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Next {
    /// Share of the full load.
    pub level: f64,
    /// Whether a bond breaks there, rather than being damaged gradually.
    pub breaks: bool,
}

impl<'n> Control<'n> {
    /// Control of a law.
    pub fn new(net: &'n Net, failure: &'n Failure) -> Self {
        Control { net, failure, last_share: failure.last_share(), measure: vec![0.0; net.bonds.len()] }
    }

    /// Takes the measures at full load.
    pub fn look(&mut self, u: &[f64], bonds: &BondState) {
        let Control { net, failure, measure, .. } = self;
        measure.par_iter_mut().enumerate().with_min_len(4096).for_each(|(b, measure)| {
            let can = bonds.may_fail[b] && bonds.share[b] > 0.0;
            *measure = if can { failure.measure(measures(net, b, u)) } else { 0.0 };
        });
    }

    fn is_gradual(&self, share: f64) -> bool {
        // Round-off of a share that was set to the last one.
        share > self.last_share * (1.0 + 1e-9)
    }

    /// The level at which a bond is damaged next.
    pub fn next(&self, bonds: &BondState) -> Next {
        let level = |b: usize| self.failure.onset(self.net.bonds[b].from, bonds.share[b]) / self.measure[b];
        let least = |breaks: bool| {
            let of = |b: usize| self.measure[b] > 0.0 && self.is_gradual(bonds.share[b]) != breaks;
            self.least(|b| if of(b) { level(b) } else { f64::INFINITY })
        };
        let (gradual, breaking) = (least(false), least(true));
        // Gradual damage just below a break would come to it in ever smaller steps.
        let breaks = breaking <= (1.0 + TOGETHER) * gradual;
        Next { level: if breaks { breaking } else { gradual }, breaks }
    }

    /// The level at which the largest damage has grown by `growth` from these shares, none has broken, and none is past its
    /// limit.
    pub fn level_of_growth(&self, start: &[f64], growth: f64) -> f64 {
        self.least(|b| {
            if self.measure[b] == 0.0 {
                return f64::INFINITY;
            }
            let owner = self.net.bonds[b].from;
            let share = (start[b] - growth).max(self.last_share).min(start[b]);
            let most = self.failure.onset(owner, start[b]) * (1.0 + growth);
            self.failure.onset(owner, share).min(most) / self.measure[b]
        })
    }

    fn least(&self, level: impl Fn(usize) -> f64 + Sync + Send) -> f64 {
        (0..self.measure.len()).into_par_iter().with_min_len(4096).map(level).reduce(|| f64::INFINITY, f64::min)
    }

    /// Gives all bonds the damage of this level, from these shares on; returns the largest change.
    pub fn damage(&self, start: &[f64], level: f64, bonds: &mut BondState) -> f64 {
        let Failure::Softening(law) = self.failure else { return 0.0 };
        let states = bonds.share.par_iter_mut().zip(&mut bonds.peak).zip(&self.measure).zip(start).with_min_len(4096);
        let change = |(((share, peak), &measure), &start): (((&mut f64, &mut f64), &f64), &f64)| {
            if measure == 0.0 {
                return 0.0;
            }
            // The step ends where the first bond reaches the end of its curve, hence within round-off of s_t at the most.
            let stretch = (level * measure).min(law.last);
            let after = law.share(stretch).min(start);
            let change = (*share - after).abs();
            *share = after;
            *peak = law.stretch_at(after);
            change
        };
        states.map(change).reduce(|| 0.0, f64::max)
    }

    /// Breaks the bonds whose limit is this level; returns them.
    pub fn break_at(&self, level: f64, bonds: &mut BondState) -> Vec<usize> {
        let at = |&b: &usize| {
            let reached =
                self.failure.onset(self.net.bonds[b].from, bonds.share[b]) <= (1.0 + TOGETHER) * level * self.measure[b];
            self.measure[b] > 0.0 && !self.is_gradual(bonds.share[b]) && reached
        };
        let broken: Vec<usize> = (0..self.measure.len()).filter(at).collect();
        broken.iter().for_each(|&b| bonds.share[b] = 0.0);
        broken
    }

    /// Breaks the bonds that are torn at this level by their true length though not in linear measures; returns their number and
    /// the energy they held, J. What is close to its limit in linear measures is left to [`Control::break_at`].
    pub fn break_overlong(&self, u: &[f64], level: f64, bonds: &mut BondState) -> (usize, f64) {
        let now: Vec<f64> = u.iter().map(|u| level * u).collect();
        let is_torn = |&b: &usize| {
            let bond = &self.net.bonds[b];
            let elongation =
                if self.net.unknowns == 3 { Springs::elongation::<3>(bond, &now) } else { Springs::elongation::<2>(bond, &now) };
            let clear = level * self.measure[b] < SLIDING * self.failure.onset(bond.from, self.last_share);
            bonds.may_fail[b] && bonds.share[b] > 0.0 && clear && self.failure.is_overlong(bond.from, elongation)
        };
        let torn: Vec<usize> = (0..self.measure.len()).into_par_iter().with_min_len(4096).filter(is_torn).collect();
        let held = |&b: &usize| {
            let (bond, at) = (&self.net.bonds[b], measures(self.net, b, &now));
            0.5 * bonds.share[b] * bond.k_n * bond.length * bond.length * at.square()
        };
        let energy = torn.iter().map(held).sum();
        torn.iter().for_each(|&b| bonds.share[b] = 0.0);
        (torn.len(), energy)
    }

    /// Level at which these bonds are at their limit with this displacement, on the average: where they have just lost their last
    /// force.
    pub fn level_of(&self, broken: &[usize], u: &[f64]) -> f64 {
        let limit = |&b: &usize| {
            let measure = self.failure.measure(measures(self.net, b, u));
            self.failure.onset(self.net.bonds[b].from, self.last_share) / measure
        };
        broken.iter().map(limit).sum::<f64>() / broken.len() as f64
    }

    /// Energy that the change from these shares to the present ones has taken along the curves of the law, J, with the shear
    /// that the displacement `u` of a level has.
    pub fn taken(&self, start: &[f64], bonds: &BondState, u: &[f64], level: f64) -> f64 {
        let of = |b: usize| -> f64 {
            let (before, after) = (start[b], bonds.share[b]);
            if before == after {
                return 0.0;
            }
            let bond = &self.net.bonds[b];
            let at = measures(self.net, b, u);
            let shear = level * level * at.ratio * at.shear * at.shear * (before - after);
            let normal = match self.failure {
                Failure::Softening(law) => law.square_sum([before, after]),
                Failure::Energy(limits) => limits[bond.from as usize].powi(2) * (before - after) - shear,
                Failure::Stretch(limits) => limits[bond.from as usize].powi(2) * (before - after),
                Failure::Never => 0.0,
            };
            0.5 * bond.k_n * bond.length * bond.length * (normal + shear)
        };
        const PART: usize = 4096;
        let count = start.len();
        let part = |first: usize| (first..(first + PART).min(count)).map(of).sum::<f64>();
        (0..count).into_par_iter().step_by(PART).map(part).collect::<Vec<_>>().iter().sum()
    }
}

/// Measures of a bond at a displacement.
fn measures(net: &Net, b: usize, u: &[f64]) -> Measures {
    let bond = &net.bonds[b];
    let (e_n, e_t, _) =
        if net.unknowns == 3 { Springs::strain::<false, 3>(bond, u) } else { Springs::strain::<false, 2>(bond, u) };
    let stretch = e_n / bond.length;
    Measures { stretch, elongation: 2.0 * stretch, shear: e_t / bond.length, ratio: bond.k_t / bond.k_n }
}
