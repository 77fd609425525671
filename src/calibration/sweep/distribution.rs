//! Distributions of the quantities that vary, by their quantile functions; Latin hypercubes of probabilities; quantiles of a sample.
//!
//! McKay, Beckman and Conover (1979), Technometrics 21:239.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// A distribution with its parameters, in the unit of its key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// Every value between two is equally likely.
    Uniform {
        /// Lowest value.
        from: f64,
        /// Highest value.
        to: f64,
    },
    /// The logarithm is uniform.
    LogUniform {
        /// Lowest value, above zero.
        from: f64,
        /// Highest value.
        to: f64,
    },
    /// Gauss.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
    /// The logarithm is normal.
    LogNormal {
        /// Median.
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

/// Quantile of the standard normal distribution at a probability in (0, 1), with a relative error of about 1e-16.
///
/// Algorithm AS 241, function PPND16 (Wichura 1988, Appl. Stat. 37:477): a quotient of polynomials of degree 7 in
/// `0.180625 - q²` for `|q| = |p - 1/2| <= 0.425`, else in `r - 1.6` or, from r = 5 on, `r - 5` with `r = sqrt(-ln min(p, 1-p))`.
pub fn normal_quantile(probability: f64) -> f64 {
    let q = probability - 0.5;
    if q.abs() <= 0.425 {
        return q * quotient(&MIDDLE, 0.180_625 - q * q);
    }
    let r = (-probability.min(1.0 - probability).ln()).sqrt();
    let size = if r <= 5.0 { quotient(&SIDES, r - 1.6) } else { quotient(&TAILS, r - 5.0) };
    size.copysign(q)
}

/// Coefficients of numerator and denominator, the constant first.
type Quotient = [[f64; 8]; 2];

fn quotient([above, below]: &Quotient, x: f64) -> f64 {
    let polynomial = |coefficients: &[f64; 8]| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
    polynomial(above) / polynomial(below)
}

#[expect(clippy::excessive_precision, reason = "as printed in the source")]
const MIDDLE: Quotient = [
    [
        3.3871328727963666080e0,
        1.3314166789178437745e2,
        1.9715909503065514427e3,
        1.3731693765509461125e4,
        4.5921953931549871457e4,
        6.7265770927008700853e4,
        3.3430575583588128105e4,
        2.5090809287301226727e3,
    ],
    [
        1.0,
        4.2313330701600911252e1,
        6.8718700749205790830e2,
        5.3941960214247511077e3,
        2.1213794301586595867e4,
        3.9307895800092710610e4,
        2.8729085735721942674e4,
        5.2264952788528545610e3,
    ],
];
#[expect(clippy::excessive_precision, reason = "as printed in the source")]
const SIDES: Quotient = [
    [
        1.42343711074968357734e0,
        4.63033784615654529590e0,
        5.76949722146069140550e0,
        3.64784832476320460504e0,
        1.27045825245236838258e0,
        2.41780725177450611770e-1,
        2.27238449892691845833e-2,
        7.74545014278341407640e-4,
    ],
    [
        1.0,
        2.05319162663775882187e0,
        1.67638483018380384940e0,
        6.89767334985100004550e-1,
        1.48103976427480074590e-1,
        1.51986665636164571966e-2,
        5.47593808499534494600e-4,
        1.05075007164441684324e-9,
    ],
];
#[expect(clippy::excessive_precision, reason = "as printed in the source")]
const TAILS: Quotient = [
    [
        6.65790464350110377720e0,
        5.46378491116411436990e0,
        1.78482653991729133580e0,
        2.96560571828504891230e-1,
        2.65321895265761230930e-2,
        1.24266094738807843860e-3,
        2.71155556874348757815e-5,
        2.01033439929228813265e-7,
    ],
    [
        1.0,
        5.99832206555887937690e-1,
        1.36929880922735805310e-1,
        1.48753612908506148525e-2,
        7.86869131145613259100e-4,
        1.84631831751005468180e-5,
        1.42151175831644588870e-7,
        2.04426310338993978564e-15,
    ],
];

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
