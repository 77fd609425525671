//! From measured curves to the constants of the fatigue law.
//!
//! In the order data flows: what a user says of files ([`import`]), cells of a table, its [`columns`] and the [`decimal`] sign;
//! [`measured`] readings with their [`loads`], those that are [left out](leave_out), their [`median`] and [`rates`]; [`outliers`] and
//! [shifts of level](level_shift) among them; the [`power_law`] over K(a) that is fitted;
//! [`criterion`], [`misfit`], [`search`] and [`confidence`]; [`fit`], the page that calls them in turn; what it means as C and m
//! ([`paris`]) and as A and p of bonds ([`bond_constants`]); [`results`] as they are written and the [`crate::case::record`] that predictions
//! read. [`case`] reads the input file, and [`mod@calibrate`] goes the whole way.

pub mod bond_constants;
pub mod calibrate;
pub mod case;
mod case_load;
mod cells;
mod column_units;
pub mod columns;
pub mod confidence;
pub mod criterion;
mod curve;
pub mod decimal;
pub mod estimate;
pub mod exponent;
pub mod fit;
mod fit_keys;
mod fitted_curve;
#[cfg(feature = "tables")]
pub mod frames;
pub mod import;
pub mod lack_of_fit;
pub mod laws;
pub mod leave_out;
pub mod level_shift;
pub mod loads;
pub mod measured;
pub mod median;
pub mod misfit;
pub mod model;
mod names;
mod numerals;
pub mod outliers;
pub mod pairs;
pub mod paris;
pub mod power_law;
pub mod rates;
mod readings;
pub mod results;
mod roles;
pub mod search;
mod shape;
pub(crate) mod table;
pub mod test_piece;
mod told;
