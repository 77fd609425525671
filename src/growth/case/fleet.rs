//! Section `[fleet]`: plates that differ from the one of the case in their initial crack length, load and law.

use serde::Deserialize;
use toml::Value;

use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{LENGTH, number, slice};

/// Plates of a fleet where the section does not say how many.
pub const PLATES: usize = 1000;
/// Most plates of a fleet.
pub const PLATES_MAX: usize = 100_000;
/// Largest scatter of the load, over the load: few draws fall to zero, which are left out.
const LOAD_SCATTER_MAX: f64 = 0.3;
const LENGTH_KEY: &str = "fleet.initial_length_mm";

/// Keys of `[fleet]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    plates: Option<usize>,
    seed: Option<u64>,
    initial_length_mm: Option<LengthInput>,
    load_scatter: Option<f64>,
}

/// Keys of the initial length, as a sweep calls them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LengthInput {
    median: Option<f64>,
    standard_deviation_ln: Option<f64>,
    mean: Option<f64>,
    standard_deviation: Option<f64>,
}

/// How initial crack lengths scatter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InitialLength {
    /// The logarithm is normal.
    LogNormal {
        /// Median, m.
        median: f64,
        /// Standard deviation of ln.
        deviation_ln: f64,
    },
    /// Normal, as far as it is above zero.
    Normal {
        /// Mean of the whole distribution, m.
        mean: f64,
        /// Standard deviation of it, m.
        deviation: f64,
    },
}

/// Plates of which lives are asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fleet {
    /// How many.
    pub plates: usize,
    /// Seed of all draws.
    pub seed: u64,
    /// Initial crack length; `None`: that of the case. Of a standard specimen in its convention, of a plate that of the crack whose tip
    /// ends the life.
    pub initial_length: Option<InitialLength>,
    /// Standard deviation of the load over the load of the case.
    pub load_scatter: f64,
}

impl Fleet {
    /// Reads the section.
    /// Errors: unknown keys, numbers beyond reason, an initial length that is given in part or twice.
    pub fn from_value(value: &Value) -> Result<Self> {
        let given: Input = slice(value, "fleet")?;
        let plates = given.plates.unwrap_or(PLATES);
        if !(1..=PLATES_MAX).contains(&plates) {
            return Err(input("fleet.plates", plates, "is beyond reason", format!("give a number from 1 to {PLATES_MAX}")));
        }
        let scatter = number("a standard deviation over the load", 0.0, LOAD_SCATTER_MAX);
        Ok(Fleet {
            plates,
            seed: given.seed.unwrap_or(0),
            initial_length: given.initial_length_mm.as_ref().map(length).transpose()?,
            load_scatter: scatter.read_optional("fleet.load_scatter", given.load_scatter)?.unwrap_or(0.0),
        })
    }

    /// Whether its plates differ in more than their law.
    pub fn scatters(&self) -> bool {
        self.initial_length.is_some() || self.load_scatter > 0.0
    }
}

fn length(given: &LengthInput) -> Result<InitialLength> {
    let key = |name: &str| format!("{LENGTH_KEY}.{name}");
    let LengthInput { median, standard_deviation_ln, mean, standard_deviation } = *given;
    match (median, standard_deviation_ln, mean, standard_deviation) {
        (Some(median), Some(deviation), None, None) => Ok(InitialLength::LogNormal {
            median: LENGTH.read(&key("median"), median)?,
            deviation_ln: number("a standard deviation of ln", 1e-6, 3.0).read(&key("standard_deviation_ln"), deviation)?,
        }),
        (None, None, Some(mean), Some(deviation)) => Ok(InitialLength::Normal {
            mean: LENGTH.read(&key("mean"), mean)?,
            deviation: LENGTH.read(&key("standard_deviation"), deviation)?,
        }),
        _ => {
            let remedy = "give { median, standard_deviation_ln } (the logarithm is normal) or { mean, standard_deviation } (normal, above zero)";
            Err(input_missing(LENGTH_KEY, "is no distribution of two numbers", remedy))
        }
    }
}
