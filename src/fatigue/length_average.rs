//! Crack length between the breaks of single bonds.
//!
//! Bonds break one by one, in a pattern that repeats with every spacing of growth: the recorded length is a staircase
//! around the steady growth. Its mean over the cycles in which the crack grows by one spacing, as much before as after,
//! has no stairs left and keeps any straight a-N curve as it is. Towards both ends of a run the window narrows with the
//! cycles that are left, so that the first and last length stay.

/// Windows of one run, from its cycles and lengths (both never fall).
#[derive(Debug)]
pub struct LengthAverage<'a> {
    cycles: &'a [f64],
    /// Half width of the window at every row, cycles.
    half: Vec<f64>,
}

impl<'a> LengthAverage<'a> {
    /// Windows in which the crack grows by `spacing` metres.
    pub fn new(cycles: &'a [f64], lengths: &[f64], spacing: f64) -> Self {
        let first_at = |length: f64| {
            let next = lengths.partition_point(|a| *a < length).min(lengths.len() - 1);
            let before = next.saturating_sub(1);
            between((lengths[before], cycles[before]), (lengths[next], cycles[next]), length)
        };
        let half = |row: usize| {
            let (now, length) = (cycles[row], lengths[row]);
            let grows = 0.5 * (first_at(length + 0.5 * spacing) - first_at(length - 0.5 * spacing));
            grows.min(now - cycles[0]).min(cycles[cycles.len() - 1] - now).max(0.0)
        };
        LengthAverage { cycles, half: (0..cycles.len()).map(half).collect() }
    }

    /// Means of a recorded quantity over the windows, linear in N between rows.
    pub fn of(&self, values: &[f64]) -> Vec<f64> {
        let mut integral = vec![0.0];
        for (cycles, values) in self.cycles.windows(2).zip(values.windows(2)) {
            integral.push(integral[integral.len() - 1] + 0.5 * (cycles[1] - cycles[0]) * (values[0] + values[1]));
        }
        let up_to = |at: f64| {
            let next = self.cycles.partition_point(|n| *n < at).clamp(1, self.cycles.len() - 1);
            let (from, to) = (self.cycles[next - 1], self.cycles[next]);
            let value = between((from, values[next - 1]), (to, values[next]), at);
            integral[next - 1] + 0.5 * (at - from) * (values[next - 1] + value)
        };
        let mean = |row: usize| {
            let (now, half) = (self.cycles[row], self.half[row]);
            // A window that is nothing beside the cycles themselves would only add round-off.
            if half <= 1e-9 * now.abs() { values[row] } else { (up_to(now + half) - up_to(now - half)) / (2.0 * half) }
        };
        if self.cycles.len() < 2 { values.to_vec() } else { (0..values.len()).map(mean).collect() }
    }

    /// [`LengthAverage::of`] for a quantity that never falls: round-off and changing windows do not make it fall either.
    pub fn of_rising(&self, values: &[f64]) -> Vec<f64> {
        let mut largest = f64::NEG_INFINITY;
        let mut means = self.of(values);
        for mean in &mut means {
            largest = largest.max(*mean);
            *mean = largest;
        }
        means
    }
}

/// Value at `at` on the line through two points; the later one where they stand at the same place.
fn between(from: (f64, f64), to: (f64, f64), at: f64) -> f64 {
    if to.0 <= from.0 {
        return to.1;
    }
    from.1 + ((at - from.0) / (to.0 - from.0)).clamp(0.0, 1.0) * (to.1 - from.1)
}
