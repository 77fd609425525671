//! The growth law of the state-based law, whose springs share the load with the dilatation of their points.

use super::growth::panel_follows;
use super::resolution::turned_lattices;
use super::scene::PANEL;
use crate::error::Result;
use crate::predict::{Silent, predict};
use crate::verify::Table;
use crate::verify::scene::case;

const STATE_BASED: &str = "model.bond_law=state_based";
/// Titanium.
const TITANIUM: [&str; 2] = [STATE_BASED, "material.poisson_ratio=0.34"];

/// Rows of the topic.
///
/// # Errors
/// As [`predict`].
pub fn rows(table: &mut Table) -> Result<()> {
    // Without dilatation it is the two-parameter law without tangential springs.
    let limit = [
        "model.surface_correction=volume_and_surface",
        "material.poisson_ratio=0.3333333333333333",
        "specimen.width_mm=80",
        "specimen.length_mm=120",
        "stop.crack_length_mm=12",
    ];
    let life = |law: &str| -> Result<f64> { Ok(predict(&case(PANEL, &[&limit[..], &[law]].concat())?, &Silent)?.life_cycles()) };
    let ratio = life(STATE_BASED)? / life("model.bond_law=two_parameter")?;
    table.compare("state_based, nu 1/3: life over that of two_parameter", ratio, 1.0, 0.01, "both are the same springs");
    panel_follows(table, "state_based, nu 0.34: ", &TITANIUM, 2.87)?;
    panel_follows(table, "state_based, nu 0.34: ", &TITANIUM, 4.0)?;
    turned_lattices(table, "state_based, nu 0.34: ", &TITANIUM)
}
