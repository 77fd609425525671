//! Latin hypercube: of every quantity one value from each of n strata of equal probability, paired at random.
//!
//! McKay, Beckman and Conover (1979), Technometrics 21:239.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

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
            let probability = (stratum as f64 + open_unit(&mut stream)) / samples as f64;
            // The last stratum may round up to 1, of which no quantile is finite.
            row.push(probability.min(1.0 - 0.5 * f64::EPSILON));
        }
    }
    rows
}

/// A number in (0, 1): the middle of one of 2⁵² equal parts.
fn open_unit(stream: &mut ChaCha8Rng) -> f64 {
    ((stream.next_u64() >> 12) as f64 + 0.5) / (1u64 << 52) as f64
}

/// Every order is equally likely (Fisher and Yates; Durstenfeld 1964, Commun. ACM 7:420).
fn shuffle(items: &mut [usize], stream: &mut ChaCha8Rng) {
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
