//! Growth rate and energy release rate along an a-N curve, and crack length between the breaks of single bonds.
//!
//! Bonds break one by one, in a pattern that repeats with every spacing of growth: the recorded length is a staircase
//! around the steady growth. Its mean over the cycles in which the crack grows by one spacing, as much before as after,
//! has no stairs left and keeps any straight a-N curve as it is. Towards both ends of a run the window narrows with the
//! cycles that are left, so that the first and last length stay.

use nalgebra::{Matrix3, Vector3};

/// What a run records of every block, before rates are taken; lengths in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    pub cycles: f64,
    /// Crack length in the specimen's convention, m.
    pub crack_length: f64,
    pub growth: f64,
    /// Work of the loads at maximum load, f·u, J.
    pub work: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// da/dN, m/cycle.
    pub growth_rate: f64,
    /// Energy release rate at maximum load, J/m², mean over the growing tips.
    pub energy_release_rate: f64,
}

/// Central differences over `span` metres of growth around every sample: bonds break one by one, and only a stretch of crack
/// that severs many of them has a rate. `G = d(f·u)/2 / (h da)`: at constant load half of the loads' work is released.
pub fn rates(samples: &[Sample], span: f64, thickness: f64) -> Vec<Rate> {
    let mut rates = Vec::with_capacity(samples.len());
    let (mut low, mut high) = (0, 0);
    for sample in samples {
        while low + 1 < samples.len() && samples[low + 1].growth < sample.growth - 0.5 * span {
            low += 1;
        }
        while high + 1 < samples.len() && samples[high].growth < sample.growth + 0.5 * span {
            high += 1;
        }
        let (a, b) = (&samples[low], &samples[high]);
        rates.push(Rate {
            growth_rate: (b.crack_length - a.crack_length) / (b.cycles - a.cycles),
            energy_release_rate: (b.work - a.work) / (2.0 * thickness * (b.growth - a.growth)),
        });
    }
    rates
}

/// Energy release rate at the last of `samples`, J/m², mean over the growing tips; `None` before there is growth.
///
/// `G = W'(g) / (2 h)` from the parabola through work W over growth g by least squares: a difference quotient over the same
/// stretch would be that of its middle, half the stretch too late for a crack that is about to run away.
pub fn release_rate_at_end(samples: &[Sample], thickness: f64) -> Option<f64> {
    let (first, last) = (samples.first()?, samples.last()?);
    let span = last.growth - first.growth;
    if span <= 0.0 {
        return None;
    }
    let secant = (last.work - first.work) / span;
    // Work over its straight line, so that no digits are lost; growth from -1 to 0.
    let place = |sample: &Sample| (sample.growth - last.growth) / span;
    let beyond = |sample: &Sample| sample.work - last.work - secant * (sample.growth - last.growth);
    let basis = |x: f64| Vector3::new(1.0, x, x * x);
    let normal: Matrix3<f64> = samples.iter().map(|s| basis(place(s)) * basis(place(s)).transpose()).sum();
    let right: Vector3<f64> = samples.iter().map(|s| basis(place(s)) * beyond(s)).sum();
    // Two lengths give no parabola; their straight line has to do.
    let bend = normal.try_inverse().filter(|_| samples.len() > 3).map_or(0.0, |inverse| (inverse * right)[1] / span);
    Some((secant + bend) / (2.0 * thickness))
}

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
