//! From measured curves, or rates, to the constants of a law.
//!
//! Knows: fits to lives and to rates, outliers, scatter of specimens, sweeps and fleets of cases.
//! Must not know: files of results, terminals, networks.
//!
//! Imports `growth` and what it imports.
//!
//! In the order data flows: [`median`] and [`rates`] of readings ([`perilife_measured`]); [`outliers`] among them; the [`power_law`] over K(a)
//! that is fitted; [`criterion`], [`search`] and [`confidence`]; [`fit`], the page that calls them in turn; what it means as C and m
//! ([`paris`]). [`laws`] over K are fitted to rates. [`case`] and [`exponent`] read the input file, [`mod@calibrate`] goes from it to the fit,
//! also as A and p of bonds, [`mod@record`] is what they tell, in `fit.json` and in words, and [`results`] are the other files: among them
//! the law that predictions read.

pub mod calibrate;
pub mod case;
pub mod confidence;
pub mod criterion;
pub mod exponent;
pub mod fit;
pub mod lack_of_fit;
pub mod inspection;
pub mod laws;
pub mod median;
pub mod outliers;
pub mod paris;
pub mod population;
pub mod power_law;
pub mod preamble;
pub mod rates;
pub mod record;
pub mod readings;
pub mod results;
pub mod search;
pub mod sweep;
pub mod template;
