//! Growth rate and energy release rate along an a-N curve.

use nalgebra::{Matrix3, Vector3};

/// What a run records of every block, before rates are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Cycles.
    pub cycles: f64,
    /// Crack length in the specimen's convention, m.
    pub crack_length: f64,
    /// Growth of all tips together, m.
    pub growth: f64,
    /// Work of the loads at maximum load, f·u, J.
    pub work: f64,
}

/// Rates at a sample.
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
