//! Cycle blocks as large as a bound on the error allows.
//!
//! Strains are constant from one break to the next, so a block until the next break is exact. Several breaks a block with
//! frozen strains are not: most of the life of a bond near the tip goes by after the breaks around it. So the strains within a
//! block are foreseen, break after break, by the plate around the tips with the rim of that part held
//! ([`Equilibrium::foresee`]); a solve of the whole plate ends the block and shows how wrong they were.
//!
//! What the rim would add opens the crack as a whole, so it is the same share for all bonds of a tip, `ln(ε/ε_foreseen)`; it
//! follows from the work that the breaks bring, and past blocks teach how (`foresight`): the next block is corrected by it.
//! What is left at the end of a block, r, grew from nothing, so the bonds of the tip were spent at a rate wrong by `p r / 2`
//! over the block, which is the share of its cycles that is wrong. Blocks are chosen so that this share, the mean of |r| over
//! bonds by their spending, stays at the bound: the whole life then keeps it. The growth allowed follows the error as a step
//! size does (Gustafsson 1991, ACM Trans. Math. Softw. 17:533, PI control).
//!
//! A solver whose solves are as fast as foreseeing ([`crate::solver::SolverKind::Window`]) solves after every break: exact.

pub mod foresight;

use serde::{Deserialize, Serialize};

use super::ageing::{AgeingBond, stretch};
use super::crack_tip::{CrackTip, nearest_tip, severed_length, share_out};
use super::{Block, BlockKind};
use crate::body::{Body, Bond};
use crate::error::Result;
use crate::solver::Equilibrium;
use crate::solver::field::Layout;
use crate::state::Bonds;
use foresight::Foresight;

/// Gains of the growth allowed: of the error against the bound, and of the change of the error.
const GAIN: f64 = 0.3;
const GAIN_OF_CHANGE: f64 = 0.4;
/// Share of the bound that is aimed at.
const AIM: f64 = 0.8;
/// Least and largest growth of a block over that of the block before.
const CHANGE: (f64, f64) = (0.2, 2.0);
/// Largest growth of a tip within a block, in horizons: the rim must not come near.
const GROWTH_HORIZONS: f64 = 1.0;
/// Bound, percent, below which every break is solved for: two breaks that change places change life by about as much.
const BOUND_LEAST_PERCENT: f64 = 0.5;
/// Error, over the bound, below which blocks cannot be told apart.
const ERROR_LEAST: f64 = 1e-3;

/// The plate as a block finds it.
#[derive(Clone, Copy)]
pub struct Around<'a> {
    /// Fixed.
    pub body: &'a Body,
    /// Bonds after the breaks.
    pub bonds: &'a Bonds,
    /// Tips before the breaks.
    pub tips: &'a [CrackTip],
    /// Bonds that may age.
    pub watched: &'a [Bond],
}

/// Decides when the whole plate is solved; its state is what past blocks taught, and what has happened since the last solve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BlockControl {
    /// Bound on the share of wrong cycles; `None` where every break is solved for.
    bound: Option<f64>,
    exponent: f64,
    tips: Vec<Foresight>,
    /// Growth of a tip with which a block ends, m.
    limit: f64,
    /// Error of the block before.
    last_error: Option<f64>,
}

impl BlockControl {
    /// Control of the blocks of a run with `tips` tips, its law having exponent `p`.
    #[must_use]
    pub fn new(block: &Block, exponent: f64, tips: usize) -> Self {
        let foresees = block.kind == BlockKind::Controlled && block.error_percent >= BOUND_LEAST_PERCENT;
        let bound = foresees.then_some(block.error_percent / 100.0);
        BlockControl { bound, exponent, tips: vec![Foresight::default(); tips], limit: 0.0, last_error: None }
    }

    /// Whether blocks may hold several breaks.
    #[must_use]
    pub fn foresees(&self) -> bool {
        self.bound.is_some()
    }

    /// Corrects the strains of ageing bonds, where they are foreseen, by what is known of their error.
    pub fn correct(&self, equilibrium: &Equilibrium, body: &Body, tips: &[CrackTip], ageing: &mut [AgeingBond]) {
        if !equilibrium.is_foreseen() {
            return;
        }
        let factors: Vec<f64> = self.tips.iter().map(|tip| tip.correction().exp()).collect();
        for bond in ageing {
            bond.strain *= nearest_tip(body, tips, bond.bond).map_or(1.0, |tip| factors[tip]);
        }
    }

    /// Finds the displacement after `broken` bonds broke: foreseen while the block goes on, solved for at its end. Returns the
    /// iterations of a solve, `None` where there was none.
    ///
    /// # Errors
    /// As [`Equilibrium::solve`].
    pub fn settle(
        &mut self,
        equilibrium: &mut Equilibrium,
        around: Around<'_>,
        broken: &[Bond],
        may_foresee: bool,
        displacement: &mut Vec<f64>,
    ) -> Result<Option<usize>> {
        let Around { body, bonds, .. } = around;
        // The block before may have been ended by others, who needed the displacement of the whole plate.
        if !equilibrium.is_foreseen() {
            self.tips.iter_mut().for_each(Foresight::open);
        }
        let work = equilibrium.work();
        let Some(bound) = self.bound.filter(|_| may_foresee && equilibrium.foresee(body, bonds, displacement)) else {
            return equilibrium.solve(body, bonds, displacement).map(Some);
        };
        self.grow(around, broken, equilibrium.work() - work);
        if self.goes_on() {
            return Ok(None);
        }
        let foreseen = stretches(around, displacement);
        let iterations = equilibrium.solve(body, bonds, displacement)?;
        let error = self.learn(around, &foreseen, &stretches(around, displacement));
        self.choose_limit(around, error, bound);
        Ok(Some(iterations))
    }

    /// Takes in the growth by some breaks and the work that they brought, in equal parts for all bonds.
    fn grow(&mut self, around: Around<'_>, broken: &[Bond], work: f64) {
        let shares = share_out(around.body, around.tips, broken);
        for ((known, tip), share) in self.tips.iter_mut().zip(around.tips).zip(&shares) {
            known.grow(severed_length(around.body, tip, share), work * share.len() as f64 / broken.len() as f64);
        }
    }

    /// Whether the block goes on to the next break: where something broke, the error is known and the growth below its limit.
    fn goes_on(&self) -> bool {
        self.tips.iter().all(|tip| tip.is_at_rest() || tip.is_known() && tip.grown < self.limit)
    }

    /// Compares strains foreseen with those solved for; returns the share of the block's cycles that is wrong.
    fn learn(&mut self, around: Around<'_>, foreseen: &[(Bond, f64)], solved: &[(Bond, f64)]) -> f64 {
        let mut of_tip = vec![Mismatch::default(); self.tips.len()];
        for (&(bond, foreseen), &(_, solved)) in foreseen.iter().zip(solved) {
            let tip = nearest_tip(around.body, around.tips, bond).filter(|_| foreseen > 0.0 && solved > 0.0);
            if let Some(tip) = tip {
                of_tip[tip].add(solved.powf(self.exponent), (solved / foreseen).ln(), self.tips[tip].correction());
            }
        }
        let mut error = 0.0_f64;
        for (tip, mismatch) in self.tips.iter_mut().zip(of_tip).filter(|(tip, mismatch)| !tip.is_at_rest() && mismatch.all > 0.0)
        {
            tip.learn(mismatch.mean / mismatch.all);
            error = error.max(0.5 * self.exponent * mismatch.rest / mismatch.all);
        }
        error
    }

    /// Chooses the growth of the next block.
    fn choose_limit(&mut self, around: Around<'_>, error: f64, bound: f64) {
        let grown = self.tips.iter().map(|tip| tip.grown).fold(0.0, f64::max);
        let error = error.max(ERROR_LEAST * bound);
        let before = self.last_error.replace(error).unwrap_or(error);
        let change = (AIM * bound / error).powf(GAIN) * (before / error).powf(GAIN_OF_CHANGE);
        let largest = self.straight(around.tips, bound).min(GROWTH_HORIZONS * around.body.horizon());
        self.limit = (grown * change.clamp(CHANGE.0, CHANGE.1)).min(largest);
    }

    /// Growth within a block, m, over which a curve that is straight between blocks stays within half the bound of the cycles
    /// so far: with `da/dN ~ a^(p/2)` it bends away by `p Δa² / (16 a)` in length.
    fn straight(&self, tips: &[CrackTip], bound: f64) -> f64 {
        let of_tip = |(known, tip): (&Foresight, &CrackTip)| {
            let crack = if tip.crack.is_finite() { tip.crack + tip.growth } else { known.grown_in_all };
            (8.0 * bound * crack * known.grown_in_all / self.exponent).sqrt()
        };
        let growing = self.tips.iter().zip(tips).filter(|(known, _)| known.grown > 0.0);
        growing.map(of_tip).fold(f64::INFINITY, f64::min)
    }
}

/// Strains of a tip foreseen against those solved for: sums over its bonds by their spending.
#[derive(Debug, Clone, Copy, Default)]
struct Mismatch {
    all: f64,
    /// Of ln(ε/ε_foreseen).
    mean: f64,
    /// Of what the correction leaves of it, in size.
    rest: f64,
}

impl Mismatch {
    fn add(&mut self, spending: f64, mismatch: f64, correction: f64) {
        self.all += spending;
        self.mean += spending * mismatch;
        self.rest += spending * (mismatch - correction).abs();
    }
}

/// Stretch of the watched bonds that are left.
fn stretches(around: Around<'_>, displacement: &[f64]) -> Vec<(Bond, f64)> {
    let layout = Layout::of(&around.body.lattice, around.body.stencil.unknowns);
    let intact = around.watched.iter().filter(|&&bond| around.bonds.is_intact(bond));
    intact.map(|&bond| (bond, stretch(around.body, &layout, displacement, bond))).collect()
}
