//! Spectra: cycles of unlike size in their order, one pass after the other.
//!
//! A file says cycles (maximum, minimum, how often) or turning points, which are counted as cycles here ([`rainflow`]). Values are
//! fractions of the stress or force of `loading.spectrum_scale_mpa` or `spectrum_scale_n`; inside they are fractions of the largest load.

mod classes;
mod columns;
mod content;
mod formats;
pub mod rainflow;
mod read;

pub use classes::Class;
pub use content::SpectrumFormat;

use std::fmt;

/// Longest period of a spectrum, passes.
pub const PERIOD_MOST: usize = 1000;
/// How near to whole a count is that is whole but for round-off.
pub const WHOLE: f64 = 1e-6;
/// Times that a cycle comes in a period, in the mean, from which periods are alike although it comes once more or less.
const OFTEN: f64 = 10.0;

/// Loads that come again and again: from a minimum to a maximum, both over the largest of the spectrum, so many times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    pub max: f64,
    pub min: f64,
    /// How often it comes in a pass, one after the other; below 1 of one that is not in every pass.
    pub count: f64,
}

impl Cycle {
    /// Stress ratio of a cycle whose maximum opens the crack; others grow none.
    pub fn ratio(&self) -> Option<f64> {
        (self.max > 0.0).then(|| self.min / self.max)
    }

    /// Maximum less minimum, over the largest load.
    pub fn range(&self) -> f64 {
        self.max - self.min
    }
}

/// The cycles of a pass, in their order, with what is asked of them.
#[derive(Clone, PartialEq)]
pub struct Spectrum {
    pub file: String,
    pub format: SpectrumFormat,
    /// Cycles in their order; turning points give a cycle the place of its maximum.
    pub cycles: Vec<Cycle>,
    /// Cycles of a pass, `Σ count`.
    pub per_pass: f64,
    /// Fewest passes in which every cycle comes a whole number of times; [`PERIOD_MOST`] where there are none.
    pub period: f64,
    /// Cycles of a pass that were left out as too small.
    pub omitted: f64,
    /// Largest value of the file, and the one that is left of it where peaks are cut off.
    pub largest: [f64; 2],
    /// Passes after which the loads end; `None`: never.
    pub repeats: Option<f64>,
    /// Smallest and largest stress ratio of the cycles whose maximum opens the crack.
    pub ratios: [f64; 2],
    /// Cycles that are alike, those that open no crack left out.
    pub classes: Vec<Class>,
    /// How many kinds of cycles there are: pairs of maximum and minimum that differ.
    pub kinds: usize,
    pub notes: Vec<String>,
    sha256: String,
}

/// Says what it depends on, not every cycle: it goes into the hash of a case.
impl fmt::Debug for Spectrum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Spectrum { sha256, format, per_pass, omitted, largest, repeats, .. } = self;
        write!(f, "Spectrum {:?}", (sha256, format, per_pass, omitted, largest, repeats))
    }
}

/// Whether a cycle of this count comes a whole number of times in so many passes, but for the digits of the count.
fn is_whole(count: f64, passes: f64) -> bool {
    (count * passes - (count * passes).round()).abs() <= WHOLE * passes
}

impl Spectrum {
    /// Cycles that come in few periods, or in few of them as often as in others.
    pub fn rare(&self) -> impl Iterator<Item = &Cycle> {
        self.cycles.iter().filter(|cycle| cycle.count * self.period < OFTEN && !is_whole(cycle.count, self.period))
    }

    pub fn smallest(&self) -> f64 {
        self.cycles.iter().map(|cycle| cycle.min).fold(f64::INFINITY, f64::min)
    }

    /// Maxima by falling size, with how often a pass has one as large or larger.
    pub fn exceedances(&self) -> Vec<(f64, f64)> {
        let mut maxima: Vec<(f64, f64)> = self.cycles.iter().map(|cycle| (cycle.max, cycle.count)).collect();
        maxima.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut levels: Vec<(f64, f64)> = Vec::new();
        let mut sum = 0.0;
        for (max, count) in maxima {
            sum += count;
            match levels.last_mut() {
                Some(last) if last.0 == max => last.1 = sum,
                _ => levels.push((max, sum)),
            }
        }
        levels
    }

    /// How many cycles of a pass have a range in each of so many equal parts of the largest range, the smallest part first; with that range.
    pub fn ranges(&self, parts: usize) -> (Vec<f64>, f64) {
        let largest = self.cycles.iter().map(Cycle::range).fold(0.0, f64::max);
        let mut counts = vec![0.0; parts];
        for cycle in &self.cycles {
            let part = (cycle.range() / largest * parts as f64).ceil() as usize;
            counts[part.clamp(1, parts) - 1] += cycle.count;
        }
        (counts, largest)
    }
}
