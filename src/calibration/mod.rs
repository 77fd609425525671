//! From measured curves to the constants of the fatigue law.
//!
//! In the order data flows: [`measured`] readings, their [`median`] and [`rates`]; the [`power_law`] over K(a) that is fitted;
//! [`criterion`], [`misfit`], [`search`] and [`confidence`]; [`fit`], the page that calls them in turn; what it means as C and m
//! ([`paris`]) and as A and p of bonds ([`bond_constants`]); [`results`] as they are written and the [`record`] that predictions
//! read. [`case`] reads the input file, and [`mod@calibrate`] goes the whole way.

pub mod bond_constants;
pub mod calibrate;
pub mod case;
pub mod columns;
pub mod confidence;
pub mod criterion;
pub mod exponent;
pub mod fit;
#[cfg(feature = "tables")]
pub mod frames;
pub mod measured;
pub mod median;
pub mod misfit;
pub mod model;
pub mod paris;
pub mod power_law;
pub mod rates;
pub mod record;
pub mod results;
pub mod search;
pub(crate) mod text_table;
