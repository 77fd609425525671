//! Probability of detection of a crack, and of missing it in several inspections.
//!
//! `POD(a) = Φ((ln a - ln a50)/σ)`, `σ = ln(a90/a50)/z90`, z90 = 1.2816: the log-normal form of MIL-HDBK-1823A (2009, appendix G), told by
//! the crack lengths that are found with a probability of 50 and of 90 %. Inspections are taken as independent of each other.

use std::str::FromStr;

use crate::population::student::normal_cdf;
use crate::sweep::distribution::normal_quantile;
use perilife_base::error::{Error, Result, input};
use perilife_base::units::shown::length_given;

/// Share of cycles that is nothing.
const ROUND_OFF: f64 = 1e-9;
/// Inspections of a plate that are counted at most: what is not found by then never is.
const INSPECTIONS_MAX: usize = 10_000;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detection {
    /// Crack length that is found with a probability of 50 %, m.
    pub a50: f64,
    /// With 90 %, m.
    pub a90: f64,
}

impl Detection {
    /// Probability that a crack of a length, m, is found.
    pub fn at(&self, length: f64) -> f64 {
        let deviation = (self.a90 / self.a50).ln() / normal_quantile(0.9);
        normal_cdf((length / self.a50).ln() / deviation)
    }
}

impl FromStr for Detection {
    type Err = Error;

    /// `A50,A90`, each as [`length_given`] reads it.
    fn from_str(text: &str) -> Result<Self> {
        let wrong = |problem: &str| {
            let remedy = "give two crack lengths, found with 50 % and with 90 %, for example --pod 2mm,5mm or --pod 0.1in,0.2in";
            input("--pod", text, problem, remedy)
        };
        let lengths: Option<Vec<f64>> = text.split(',').map(length_given).collect();
        match lengths.as_deref() {
            Some(&[a50, a90]) if a50 > 0.0 && a90 > a50 && a90.is_finite() => Ok(Detection { a50, a90 }),
            Some([_, _]) => Err(wrong("must be two increasing crack lengths above zero")),
            _ => Err(wrong("is not two numbers")),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    pub detection: Detection,
    /// Cycles of the first, and from each to the next.
    pub cycles: [f64; 2],
}

/// Inspections that a growing crack has come through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inspected {
    schedule: Schedule,
    pub count: usize,
    /// Probability that none of them has found the crack.
    pub missed: f64,
}

impl Schedule {
    /// Before the first inspection.
    pub fn begin(self) -> Inspected {
        Inspected { schedule: self, count: 0, missed: 1.0 }
    }
}

impl Inspected {
    /// The crack grows from one length to another over cycles, evenly; an inspection at their end is that of the next growth.
    pub fn grow(&mut self, cycles: [f64; 2], lengths: [f64; 2], mut told: impl FnMut(f64, f64, f64, f64)) {
        let [first, every] = self.schedule.cycles;
        while self.count < INSPECTIONS_MAX {
            let at = first + every * self.count as f64;
            // At their end but for round-off is at their end.
            if at >= cycles[1] * (1.0 - ROUND_OFF) {
                return;
            }
            let share = ((at - cycles[0]) / (cycles[1] - cycles[0])).max(0.0);
            let length = lengths[0] + share * (lengths[1] - lengths[0]);
            let found = self.schedule.detection.at(length);
            (self.count, self.missed) = (self.count + 1, self.missed * (1.0 - found));
            told(at, length, found, self.missed);
        }
    }
}
