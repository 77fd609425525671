//! Growth rate and energy release rate along an a-N curve.

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
#[must_use]
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
