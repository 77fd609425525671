//! K of a run against an independent K of the same plate: what drives the cracks could be wrong without a sign of it otherwise.
//!
//! K of tips, read on rings near them, is compared with what the whole plate gives off: while cracks grow under constant load,
//! `½ ΔW = B Σ ∫ K_eq²/E' da` with W the work of the loads (Irwin 1957), over intervals of some horizons. Fatigue bonds, whose K is that
//! energy, are compared with the ring on the plate with cleanly cut initial cracks.

use serde::{Deserialize, Serialize};

use crate::case::Case;

/// Share of the life that a comparison has to be of.
const SHARE_LEAST: f64 = 0.03;
/// Relative difference of K above which the check is a caution.
const WARNED: f64 = 0.03;

/// How far two independent K lie apart.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CrossCheck {
    pub compared: usize,
    /// Largest difference, the K of the run over the other one less 1.
    pub difference: f64,
    /// Crack length where that is, m.
    pub crack_length: f64,
}

impl CrossCheck {
    /// Whether the difference is a caution.
    pub fn is_large(&self) -> bool {
        self.difference.abs() > WARNED
    }
}

/// Growth over which energies were compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Interval {
    /// K of the tips over that of the energy, less 1.
    difference: f64,
    /// Crack length in its middle, m.
    crack_length: f64,
    cycles: f64,
}

/// Growth of all tips in a block and what it gave off.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ReleasedEnergy {
    /// `B Σ ∫ K_eq²/E' da`, J.
    pub of_tips: f64,
    /// ½ ΔW, J.
    pub of_plate: f64,
    /// Growth of all tips, m.
    pub growth: f64,
    /// Growth in the convention of crack length, m.
    pub lengthening: f64,
    pub cycles: f64,
}

impl ReleasedEnergy {
    /// That of a block: of every tip before and after it `K_eq²/E'`, J/m², and the length that its crack stands for beyond that of its
    /// line, m; their growth in it and until its end, m, the work of the loads before and after it, J, and its cycles. Gives the crack length
    /// at its end, m, too.
    pub fn of_block(
        case: &Case,
        [tips_before, tips_after]: [&[[f64; 2]]; 2],
        growths: &[f64],
        grown: &[f64],
        [before, after]: [f64; 2],
        cycles: f64,
    ) -> (Self, f64) {
        let specimen = &case.specimen;
        let at_start: Vec<f64> = grown.iter().zip(growths).map(|(grown, growth)| grown - growth).collect();
        let length = specimen.crack_length_after(grown);
        let of_tip = |((growth, [then, offset_then]), [now, offset]): ((&f64, &[f64; 2]), &[f64; 2])| {
            0.5 * (then + now) * (growth + offset - offset_then)
        };
        let of_tips: f64 = growths.iter().zip(tips_before).zip(tips_after).map(of_tip).sum();
        // What is released under a load is half of the work that this does more, and under a displacement the strain energy lost.
        let sign = if case.loading.displacement().is_some() { -1.0 } else { 1.0 };
        let block = ReleasedEnergy {
            of_tips: specimen.thickness * of_tips,
            of_plate: sign * 0.5 * (after - before),
            growth: growths.iter().sum(),
            lengthening: length - specimen.crack_length_after(&at_start),
            cycles,
        };
        (block, length)
    }
}

/// Energies of the growth since the last comparison, and the comparisons so far.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct EnergyBalance {
    open: ReleasedEnergy,
    intervals: Vec<Interval>,
}

impl EnergyBalance {
    /// Takes in a block at whose end the crack has the length `crack_length`, m; energies are compared over growth of `interval`, m.
    pub fn take(&mut self, block: ReleasedEnergy, crack_length: f64, interval: f64) {
        let open = &mut self.open;
        open.of_tips += block.of_tips;
        open.of_plate += block.of_plate;
        open.growth += block.growth;
        open.lengthening += block.lengthening;
        open.cycles += block.cycles;
        if open.growth >= interval {
            let ReleasedEnergy { of_tips, of_plate, lengthening, cycles, .. } = std::mem::take(open);
            let difference = (of_tips / of_plate).sqrt() - 1.0;
            // NaN where the energy falls: no K belongs to that.
            let difference = if difference.is_finite() { difference } else { 1.0 };
            self.intervals.push(Interval { difference, crack_length: crack_length - 0.5 * lengthening, cycles });
        }
    }

    /// Begins a new interval.
    pub fn forget(&mut self) {
        self.open = ReleasedEnergy::default();
    }

    /// The comparisons that matter in a life of so many `cycles`.
    pub fn check(&self, cycles: f64) -> Option<CrossCheck> {
        let matters = self.intervals.iter().filter(|interval| interval.cycles >= SHARE_LEAST * cycles);
        let largest = matters.clone().max_by(|a, b| a.difference.abs().total_cmp(&b.difference.abs()))?;
        let Interval { difference, crack_length, .. } = *largest;
        Some(CrossCheck { compared: matters.count(), difference, crack_length })
    }
}

/// K of a tip, over the largest, below which it counts as that.
const SMALL: f64 = 0.2;

/// The tip whose K_I or K_II differs most between two readings, and by what share of its K; none without tips.
pub fn largest_difference(before: &[[f64; 2]], now: &[[f64; 2]]) -> (usize, f64) {
    let size = |[a, b]: [f64; 2]| a.hypot(b);
    let least = SMALL * now.iter().map(|factors| size(*factors)).fold(0.0, f64::max);
    let difference = |(a, b): (&[f64; 2], &[f64; 2])| {
        (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) / size(*b).max(least).max(f64::MIN_POSITIVE)
    };
    before.iter().zip(now).map(difference).enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
}
