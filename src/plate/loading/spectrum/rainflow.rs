//! Cycles of a history of loads by rainflow counting, ASTM E1049-85 (2017), 5.4.4.

/// A cycle or half cycle that was counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Counted {
    /// Its two turning points, in their order in time.
    pub ends: [f64; 2],
    /// Their places in the history.
    pub places: [usize; 2],
    /// 1 of a cycle, ½ of a half cycle.
    pub count: f64,
}

impl Counted {
    /// Its range.
    pub fn range(&self) -> f64 {
        (self.ends[1] - self.ends[0]).abs()
    }

    /// Place of its maximum in the history, and of its minimum.
    pub fn place_of_maximum(&self) -> [usize; 2] {
        let [first, second] = self.places;
        if self.ends[0] > self.ends[1] { [first, second] } else { [second, first] }
    }
}

/// The values at which a history turns, its first and last among them, each with its place.
pub fn turning_points(history: &[f64]) -> Vec<(usize, f64)> {
    let mut turns: Vec<(usize, f64)> = Vec::with_capacity(history.len());
    for (place, &value) in history.iter().enumerate() {
        match turns[..] {
            [.., (_, last)] if last == value => continue,
            // Goes on in the direction of the last range, which is then a longer one.
            [.., (_, before), (_, last)] if (last > before) == (value > last) => drop(turns.pop()),
            _ => {}
        }
        turns.push((place, value));
    }
    turns
}

/// The cycles of a history, as they close; those that are left open at its end are half cycles, in their order.
///
/// With X the range under consideration and Y the one before it: while X ≥ Y, Y is a cycle and its two points are taken out, or, where it
/// holds the starting point, a half cycle and only that point is taken out.
pub fn rainflow(history: &[f64]) -> Vec<Counted> {
    let counted = |[from, to]: [(usize, f64); 2], count| Counted { ends: [from.1, to.1], places: [from.0, to.0], count };
    let (mut open, mut found): (Vec<(usize, f64)>, Vec<Counted>) = (Vec::new(), Vec::new());
    for turn in turning_points(history) {
        open.push(turn);
        while let [.., a, b, c] = open[..] {
            if (c.1 - b.1).abs() < (b.1 - a.1).abs() {
                break;
            }
            if open.len() == 3 {
                found.push(counted([a, b], 0.5));
                open.remove(0);
            } else {
                found.push(counted([a, b], 1.0));
                open.drain(open.len() - 3..open.len() - 1);
            }
        }
    }
    found.extend(open.windows(2).map(|pair| counted([pair[0], pair[1]], 0.5)));
    found
}
