//! From measured curves to the constants of the fatigue law.
//!
//! In the order data flows: [`measured`] readings, their [`median`] and [`rates`]; the forward [`model`] that is fitted, what a
//! run [`recording`] holds and what is kept of [`finished`] ones; [`criterion`], [`misfit`], [`search`] and [`confidence`];
//! [`fit`], the page that calls them in turn; what it means as C and m ([`paris`]); [`results`] as they are written and the
//! [`record`] that predictions read. [`case`] reads the input file.

pub mod calibrate;
pub mod case;
pub mod columns;
pub mod confidence;
pub mod criterion;
pub mod exponent;
pub mod field_model;
pub mod finished;
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
pub mod pd_model;
pub mod record;
pub mod recording;
pub mod results;
pub mod search;
pub mod surrogate;
pub(crate) mod text_table;
