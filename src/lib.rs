//! Fatigue-life prediction of cracked plates by peridynamics.
//!
//! A plate is a lattice of points joined by bonds, and a crack is a line that cuts them. At the maximum load of a cycle the points are in
//! equilibrium, `Σ μ f + b = 0` ([`perilife_points::solver`]). A ring around each crack tip gives K_I, K_II and T by the interaction integral
//! ([`perilife_points::stress_intensity`]); the tip turns to the largest circumferential stress and grows by `da/dN` of its K, all tips over the same
//! cycles, and the bonds that the longer lines cross are cut: that is [`perilife_growth::predict::increment`], the main page.
//!
//! Fatigue of a bond is `dλ/dN = -A ε^p`: its remaining life λ decreases from 1, and at 0 it breaks. Integrated through the zone of a
//! steady tip this is `da/dN = β A δ^(1-p/2) (K/E')^p`, a Paris law with m = p ([`perilife_growth::rate_constant`]). So A and p drive a tip by its K
//! ([`perilife_growth::cracks`], the default), or every bond by its own strain ([`perilife_growth::bond_strain`]). Limits: linear elasticity, small-scale
//! yielding, through cracks in plane stress or plane strain. [`guide`] has the user's guide and, from [`guide::theory`] on, theory
//! with symbols, limits and sources.
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
//! The names below are those that examples use. Computation is in members, one folder of `src` each with its scope at its head;
//! [`guide::theory`] says which imports which.
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
