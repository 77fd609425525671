//! Section `[fleet]`: plates that differ from the one of the case in their initial crack length, load and law.

use toml::Value;

use perilife_base::error::{Result, input_missing};
use perilife_base::input::LENGTH;
use perilife_base::keys::{key, number, section};

/// Plates of a fleet where the section does not say how many.
pub const PLATES: usize = 1000;
/// Largest scatter of the load, over the load: few draws fall to zero, which are left out.
const LOAD_SCATTER_MAX: f64 = 0.3;
const LENGTH_KEY: &str = "fleet.initial_length_mm";

perilife_base::keys! {
    pub struct FleetKeys {
        plates: usize = number("plates", "Plates: how many", "a number", 1.0, 1e5), or "1000" PLATES;
        seed: u64 = key("seed", "Seed of all draws"), or "0" 0;
        initial_length: Option<LengthKeys> = key("initial_length_mm", "Initial crack length: distribution; default that of the case");
        load_scatter: f64 = number("load_scatter", "Scatter of the load: standard deviation over the load", "a standard deviation over the load", 0.0, LOAD_SCATTER_MAX), or "0" 0.0;
    }
}
perilife_base::keys! {
    /// Keys of the initial length, as a sweep calls them.
    pub struct LengthKeys {
        median: Option<f64> = key("median", "Median: of a normal logarithm").of(LENGTH);
        deviation_ln: Option<f64> = number("standard_deviation_ln", "Standard deviation of ln", "a standard deviation of ln", 1e-6, 3.0);
        mean: Option<f64> = key("mean", "Mean: of a normal distribution above zero").of(LENGTH);
        deviation: Option<f64> = key("standard_deviation", "Standard deviation").of(LENGTH);
    }
}

/// How initial crack lengths scatter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InitialLength {
    /// The logarithm is normal.
    LogNormal {
        /// Median, m.
        median: f64,
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
    pub seed: u64,
    /// Initial crack length in the convention of the specimen, of a plate the governing crack; `None`: that of the case.
    pub initial_length: Option<InitialLength>,
    /// Standard deviation of the load over the load of the case.
    pub load_scatter: f64,
}

impl Fleet {
    /// Reads the section.
    /// Errors: unknown keys, numbers beyond reason, an initial length that is given in part or twice.
    pub fn from_value(value: &Value) -> Result<Self> {
        let FleetKeys { plates, seed, initial_length, load_scatter } = section(value, "fleet")?;
        Ok(Fleet { plates, seed, initial_length: initial_length.as_ref().map(length).transpose()?, load_scatter })
    }

    /// Whether its plates differ in more than their law.
    pub fn scatters(&self) -> bool {
        self.initial_length.is_some() || self.load_scatter > 0.0
    }
}

fn length(given: &LengthKeys) -> Result<InitialLength> {
    match (given.median, given.deviation_ln, given.mean, given.deviation) {
        (Some(median), Some(deviation_ln), None, None) => Ok(InitialLength::LogNormal { median, deviation_ln }),
        (None, None, Some(mean), Some(deviation)) => Ok(InitialLength::Normal { mean, deviation }),
        _ => {
            let remedy = "give { median, standard_deviation_ln } (the logarithm is normal) or { mean, standard_deviation } (normal, above zero)";
            Err(input_missing(LENGTH_KEY, "is not a distribution of two numbers", remedy))
        }
    }
}
