//! Monotone cubic interpolation of rising tables.
//!
//! Between two points a cubic with slopes that are weighted harmonic means of the chords to either side, so that it rises wherever the
//! table does (Fritsch and Butland 1984, SIAM J. Sci. Stat. Comput. 5:300). Steps of a table, where one of both stays the same, are
//! straight.

const HALVINGS: usize = 60;

/// A table of points `[x, y]`, both not falling.
#[derive(Debug, Clone, PartialEq)]
pub struct Monotone(Vec<[f64; 2]>);

impl Monotone {
    pub fn new(points: impl Iterator<Item = [f64; 2]>) -> Self {
        Monotone(points.collect())
    }

    /// y at x within the table; where several points share it, the last one counts. NaN for an empty table.
    pub fn at(&self, x: f64) -> f64 {
        let after = self.0.partition_point(|point| point[0] <= x);
        let Some(to) = self.0.get(after) else { return self.0.last().map_or(f64::NAN, |last| last[1]) };
        let Some(before) = after.checked_sub(1) else { return to[1] };
        self.between(before, (x - self.0[before][0]) / (to[0] - self.0[before][0]))
    }

    /// Fraction of the way in x from point `before` to the next at which y is reached.
    pub fn fraction(&self, before: usize, y: f64) -> f64 {
        let [low, high] = bisected([0.0, 1.0], HALVINGS, |share| self.between(before, share) < y);
        0.5 * (low + high)
    }

    /// y at a fraction of the way in x from point `before` to the next, which there is.
    pub fn between(&self, before: usize, t: f64) -> f64 {
        let ([_, from], [_, to]) = (self.0[before], self.0[before + 1]);
        let [width, _] = self.chord(Some(before)).unwrap_or([0.0; 2]);
        let [left, right] = [before, before + 1].map(|point| width * self.slope(point));
        let s = 1.0 - t;
        let y = s * s * ((1.0 + 2.0 * t) * from + t * left) + t * t * ((3.0 - 2.0 * t) * to - s * right);
        if width > 0.0 { y.clamp(from, to) } else { from + t * (to - from) }
    }

    /// Width and slope of the chord after a point, where it rises in both.
    fn chord(&self, point: Option<usize>) -> Option<[f64; 2]> {
        let pair = self.0.get(point?..=point? + 1)?;
        let (width, rise) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        (width > 0.0 && rise > 0.0).then(|| [width, rise / width])
    }

    /// Slope at a point; at the ends of the table that of the parabola through the three points there.
    fn slope(&self, point: usize) -> f64 {
        let end = |own: [f64; 2], next: Option<[f64; 2]>| match next {
            Some([width, slope]) => {
                (((2.0 * own[0] + width) * own[1] - own[0] * slope) / (own[0] + width)).clamp(0.0, 3.0 * own[1])
            }
            None => own[1],
        };
        match (self.chord(point.checked_sub(1)), self.chord(Some(point))) {
            (Some([width_before, before]), Some([width_after, after])) => {
                let (a, b) = (2.0 * width_after + width_before, width_after + 2.0 * width_before);
                (a + b) / (a / before + b / after)
            }
            (None, Some(own)) => end(own, self.chord(Some(1)).filter(|_| point == 0)),
            (Some(own), None) => end(own, self.chord(point.checked_sub(2)).filter(|_| point + 1 == self.0.len())),
            (None, None) => 0.0,
        }
    }
}

/// The ends of an interval that was halved so often towards the place up to which `is_below` holds.
pub fn bisected([mut low, mut high]: [f64; 2], halvings: usize, is_below: impl Fn(f64) -> bool) -> [f64; 2] {
    for _ in 0..halvings {
        let middle = 0.5 * (low + high);
        if is_below(middle) { low = middle } else { high = middle }
    }
    [low, high]
}
