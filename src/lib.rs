//! Fatigue life of cracked plates: growth laws from test data, and the life of plates that nobody tested.
//!
//! [`guide`] is the user's guide, from [`guide::theory`] on the theory with symbols, limits and sources. Start with
//! [`perilife_growth::predict::increment`], one step of growth.
//!
//! As a library, from readings of a test to the life of another plate; lengths are metres inside, and names of what is not SI say so:
//!
//! ```
//! use perilife::{Draft, Silent, predict};
//! use toml::toml;
//!
//! let csv = "cycles,crack_length_mm\n0,9\n20000,9.6\n40000,10.3\n60000,11.2\n80000,12.3\n100000,13.6\n120000,15.3\n140000,17.6\n";
//! let panel = Draft::new("panel")
//!     .section("specimen", toml! {
//!         kind = "middle_tension"
//!         width_mm = 152.4
//!         length_mm = 300.0
//!         thickness_mm = 2.54
//!         crack_length_mm = 9.0
//!     })
//!     .section("material", toml! { name = "al2024-t3" })
//!     .section("loading", toml! {
//!         stress_range_mpa = 48.28
//!         stress_ratio = 0.2
//!     })
//!     .section("model", toml! { method = "handbook" });
//! let test = panel.clone().readings("panel.csv", csv).calibration()?;
//! let law = test.fit(&Silent)?.record_text()?;
//! let narrower = panel.section("specimen", toml! { width_mm = 120.0 }).section("stop", toml! { crack_length_mm = 20.0 });
//! let life = predict(&narrower.law(&law).case()?, &Silent)?;
//! println!("{:.0} cycles to {:.1} mm", life.life_cycles(), life.crack_length_final_mm());
//! # assert!(life.life_cycles() > 1e5 && (life.crack_length_final_mm() - 20.0).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The names below are those that examples use; members, one folder of `src` each, do the rest.
#![warn(missing_docs)]

pub use perilife_base::error::{Error, InputError, Result};
pub use perilife_calibration::calibrate::{Calibration, Fitted};
pub use perilife_growth::case::Case;
pub use perilife_growth::predict::{CurvePoint, Observer, Prediction, Progress, Silent, StopReason, predict, resume};
pub use perilife_runner::Draft;
#[doc(inline)]
pub use perilife_runner::guide;

#[doc(hidden)]
pub mod commands;
