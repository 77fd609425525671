//! Smooth interpolation of a table of any course: parabolas through three points each, blended.
//!
//! Between two points the parabola through them and the one before, and that through them and the one behind, the nearer point's taken the
//! more (Overhauser 1968): value and slope are continuous, and the integral errs by the fourth power of the distance of the points. Between
//! the first two and the last two points of the table the cubic through the four at that end, which errs no more.

/// Points of a table, at least two, x rising.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parabolas {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Parabolas {
    /// Through these points.
    pub fn new(points: impl Iterator<Item = (f64, f64)>) -> Self {
        let (x, y) = points.unzip();
        Parabolas { x, y }
    }

    /// The x of its points.
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// y at an x; beyond the table that of the cubic at its end.
    pub fn at(&self, x: f64) -> f64 {
        let last = self.x.len() - 1;
        let before = self.x.partition_point(|&of| of < x).clamp(1, last) - 1;
        if before == 0 {
            return self.through(0..=last.min(3), x);
        }
        if before + 1 == last {
            return self.through(last.saturating_sub(3)..=last, x);
        }
        let share = (x - self.x[before]) / (self.x[before + 1] - self.x[before]);
        let left = self.through(before - 1..=(before + 1), x);
        let right = self.through(before..=(before + 2), x);
        left + share * (right - left)
    }

    /// The polynomial through some points.
    fn through(&self, points: std::ops::RangeInclusive<usize>, x: f64) -> f64 {
        let weight = |i: usize| {
            let others = points.clone().filter(|&j| j != i);
            others.map(|j| (x - self.x[j]) / (self.x[i] - self.x[j])).product::<f64>()
        };
        points.clone().map(|i| weight(i) * self.y[i]).sum()
    }
}
