//! Cycles of a history of loads that repeats, by rainflow counting, ASTM E1049-85 (2017), 5.4.5 (ISO 12110-2:2013, A.3.3.3).

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RainflowCycle {
    pub max: f64,
    pub min: f64,
    /// Places of its maximum and its minimum in the history.
    pub places: [usize; 2],
}

/// The values at which a history turns, its first and last among them, each with its place.
fn turning_points(history: impl Iterator<Item = (usize, f64)>) -> Vec<(usize, f64)> {
    let mut turns: Vec<(usize, f64)> = Vec::new();
    for (place, value) in history {
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

/// The cycles of a history that comes again and again: turned so that it begins and ends with its largest peak, which leaves no half cycles.
///
/// With X the range under consideration and Y the one before it: while X ≥ Y, Y is a cycle and its two points are taken out.
pub fn rainflow(history: &[f64]) -> Vec<RainflowCycle> {
    let peak = (0..history.len()).max_by(|a, b| history[*a].total_cmp(&history[*b]).then(b.cmp(a))).unwrap_or(0);
    let turned = (peak..history.len()).chain(0..(peak + 1).min(history.len())).map(|place| (place, history[place]));
    let (mut open, mut found): (Vec<(usize, f64)>, Vec<RainflowCycle>) = (Vec::new(), Vec::new());
    for turn in turning_points(turned) {
        open.push(turn);
        while let [.., a, b, c] = open[..] {
            if (c.1 - b.1).abs() < (b.1 - a.1).abs() {
                break;
            }
            let [high, low] = if a.1 > b.1 { [a, b] } else { [b, a] };
            found.push(RainflowCycle { max: high.1, min: low.1, places: [high.0, low.0] });
            open.drain(open.len() - 3..open.len() - 1);
        }
    }
    found
}
