//! Spending bond life over a cycle block: `λ ← λ - ΔN A ε^p`; a bond with λ ≤ 0 breaks
//! (Silling and Askari 2014, SAND2014-18590; block until the next break after Zhang et al. 2016, Eng. Fract. Mech. 162:76).

use super::FatigueLaw;
use super::ageing::FatigueBond;
use crate::body::Bond;

/// Share of a bond's whole life within which bonds break together: mirror twins differ by round-off only.
pub const TOGETHER: f64 = 1e-9;

/// Remaining life λ of every bond.
#[derive(Debug, Clone, PartialEq)]
pub struct BondLife {
    life: Vec<f64>,
}

impl BondLife {
    /// Whole lives for `bonds` bond numbers.
    pub fn whole(bonds: usize) -> Self {
        BondLife { life: vec![1.0; bonds] }
    }

    /// Remaining life λ of a bond, 1 at first.
    pub fn of(&self, bond: Bond) -> f64 {
        self.life[bond as usize]
    }

    /// Sets the life a bond starts with.
    pub fn set(&mut self, bond: Bond, life: f64) {
        self.life[bond as usize] = life;
    }

    /// The bonds that have spent some of their life, ascending, and what remains of it.
    pub fn begun(&self) -> Vec<(Bond, f64)> {
        self.life.iter().enumerate().filter(|(_, life)| **life != 1.0).map(|(bond, life)| (bond as Bond, *life)).collect()
    }

    /// The block until the next break: its cycles, and the bonds that break together at its end. Strains are constant until then, so
    /// the block is exact.
    pub fn until_next_break(&self, law: &FatigueLaw, ageing: &[FatigueBond]) -> (f64, Vec<Bond>) {
        let rates: Vec<f64> = ageing.iter().map(|b| law.a * b.strain.powf(law.p)).collect();
        let left = ageing.iter().zip(&rates).map(|(b, &rate)| self.of(b.bond).max(0.0) / rate);
        let cycles = left.fold(f64::INFINITY, f64::min);
        let spent =
            ageing.iter().zip(&rates).filter(|(b, rate)| self.of(b.bond) - cycles * *rate <= TOGETHER).map(|(b, _)| b.bond);
        (cycles, spent.collect())
    }

    /// Largest share of a whole life that a bond spends until the next break; none where nothing ages.
    pub fn share_to_next_break(&self, law: &FatigueLaw, ageing: &[FatigueBond]) -> f64 {
        let rates = || ageing.iter().map(|b| law.a * b.strain.powf(law.p));
        let cycles = ageing.iter().zip(rates()).map(|(b, rate)| self.of(b.bond).max(0.0) / rate).fold(f64::INFINITY, f64::min);
        // Before a first reading of K nothing may age yet.
        if ageing.is_empty() { f64::INFINITY } else { cycles * rates().fold(0.0, f64::max) }
    }

    /// Takes the block's spending off every fatigue bond.
    pub fn spend(&mut self, law: &FatigueLaw, cycles: f64, ageing: &[FatigueBond]) {
        for bond in ageing {
            self.life[bond.bond as usize] -= cycles * law.a * bond.strain.powf(law.p);
        }
    }
}
