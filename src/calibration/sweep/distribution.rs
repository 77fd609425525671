//! Distributions of the quantities that vary, by their quantile functions; Latin hypercubes of probabilities; quantiles of a sample.
//!
//! McKay, Beckman and Conover (1979), Technometrics 21:239.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use statrs::distribution::{ContinuousCDF, Normal};

/// A distribution with its parameters, in the unit of its key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    Uniform {
        from: f64,
        to: f64,
    },
    LogUniform {
        from: f64,
        to: f64,
    },
    Normal {
        mean: f64,
        deviation: f64,
    },
    LogNormal {
        median: f64,
        /// Standard deviation of the natural logarithm.
        deviation_ln: f64,
    },
}

impl Distribution {
    /// The value that the quantity stays below with this probability in (0, 1).
    pub fn quantile(&self, probability: f64) -> f64 {
        match *self {
            Distribution::Uniform { from, to } => from + probability * (to - from),
            Distribution::LogUniform { from, to } => from * (to / from).powf(probability),
            Distribution::Normal { mean, deviation } => mean + deviation * normal_quantile(probability),
            Distribution::LogNormal { median, deviation_ln } => median * (deviation_ln * normal_quantile(probability)).exp(),
        }
    }
}

/// Quantile of the standard normal distribution at a probability in (0, 1), to round-off.
pub fn normal_quantile(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability)
}

/// Probabilities in (0, 1), one row for each sample and one column for each quantity: in every column one from each of the
/// strata `[i/n, (i+1)/n)`, permuted.
///
/// Column `c` draws from stream `c` of ChaCha with 8 rounds (Bernstein 2008), whose key is the seed in its first 8 bytes, the
/// lowest first: the same seed gives the same numbers on every machine, and one column more leaves the others as they are.
pub fn hypercube(samples: usize, columns: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut rows = vec![Vec::with_capacity(columns); samples];
    for column in 0..columns {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut stream = ChaCha8Rng::from_seed(key);
        stream.set_stream(column as u64);
        let mut strata: Vec<usize> = (0..samples).collect();
        shuffle(&mut strata, &mut stream);
        for (row, stratum) in rows.iter_mut().zip(strata) {
            // In (0, 1): the middle of one of 2⁵² equal parts.
            let open_unit = ((stream.next_u64() >> 12) as f64 + 0.5) / (1u64 << 52) as f64;
            let probability = (stratum as f64 + open_unit) / samples as f64;
            // The last stratum may round up to 1, of which no quantile is finite.
            row.push(probability.min(1.0 - 0.5 * f64::EPSILON));
        }
    }
    rows
}

/// Every order is equally likely (Fisher and Yates; Durstenfeld 1964, Commun. ACM 7:420).
pub fn shuffle<T>(items: &mut [T], stream: &mut ChaCha8Rng) {
    for i in (1..items.len()).rev() {
        items.swap(i, below(i as u64 + 1, stream) as usize);
    }
}

/// A whole number below `bound`, every one equally likely: numbers of the incomplete last round are drawn again.
fn below(bound: u64, stream: &mut ChaCha8Rng) -> u64 {
    let whole = u64::MAX - u64::MAX % bound;
    loop {
        let number = stream.next_u64();
        if number < whole {
            return number % bound;
        }
    }
}

/// Quantile of a sample sorted upwards, by definition 7 of Hyndman and Fan (1996, Am. Stat. 50:361): with `h = (n-1) q` the value
/// between the two at `⌊h⌋` and `⌊h⌋ + 1`, counted from 0, by the fraction of h. NaN for an empty sample.
///
/// ```
/// # use perilife_calibration::sweep::distribution::quantile;
/// assert_eq!(quantile(&[1.0, 2.0, 4.0, 8.0], 0.5), 3.0);
/// ```
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let h = last as f64 * q.clamp(0.0, 1.0);
    let low = h.floor() as usize;
    let high = (low + 1).min(last);
    sorted[low] + (h - low as f64) * (sorted[high] - sorted[low])
}
