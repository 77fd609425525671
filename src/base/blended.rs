//! Smooth interpolation of a table of any course: polynomials through five points each, blended.
//!
//! Between two points the quartic through the five about the one, and that about the other, the nearer point's taken the more, as Overhauser
//! (1968) blends parabolas: value and slope are continuous, and the value errs by the fifth power of the distance of the points. Where
//! points lie unevenly a quartic may swing far between them: there parabolas through three are blended.

use std::ops::RangeInclusive;

/// Ratio of the widest to the narrowest distance within five points up to which a quartic goes through them.
const UNEVEN: f64 = 3.0;

/// Points of a table, at least two, x rising.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Blended {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Blended {
    pub fn new(points: impl Iterator<Item = (f64, f64)>) -> Self {
        let (x, y) = points.unzip();
        Blended { x, y }
    }

    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// y at an x; beyond the table that of the polynomial at its end.
    pub fn at(&self, x: f64) -> f64 {
        let before = self.x.partition_point(|&of| of < x).clamp(1, self.x.len() - 1) - 1;
        let share = ((x - self.x[before]) / (self.x[before + 1] - self.x[before])).clamp(0.0, 1.0);
        let [left, right] = [before, before + 1].map(|i| self.through(self.about(i), x));
        left + share * (right - left)
    }

    /// The points about one that a polynomial goes through: five, or four at the end of an uneven table and three elsewhere in it.
    fn about(&self, i: usize) -> RangeInclusive<usize> {
        let last = self.x.len() - 1;
        let some = |count: usize| {
            let first = i.saturating_sub(count / 2).min((last + 1).saturating_sub(count));
            first..=(first + count - 1).min(last)
        };
        let gaps = |points: RangeInclusive<usize>| self.x[points].windows(2).map(|pair| pair[1] - pair[0]);
        let [narrow, wide] = [f64::min as fn(f64, f64) -> f64, f64::max].map(|of| gaps(some(5)).reduce(of).unwrap_or_default());
        if wide <= UNEVEN * narrow {
            some(5)
        } else if i == 0 || i == last {
            some(4)
        } else {
            some(3)
        }
    }

    fn through(&self, points: RangeInclusive<usize>, x: f64) -> f64 {
        let weight = |i: usize| {
            let others = points.clone().filter(|&j| j != i);
            others.map(|j| (x - self.x[j]) / (self.x[i] - self.x[j])).product::<f64>()
        };
        points.clone().map(|i| weight(i) * self.y[i]).sum()
    }
}
