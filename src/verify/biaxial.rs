//! A stress along a crack has no K.

use super::scene::{life, pulled_plate};
use super::table::Table;
use crate::error::Result;

/// Life of a square plate under stress across and along its crack, over that without the latter.
///
/// # Errors
/// As [`crate::predict::predict`].
pub fn rows(table: &mut Table) -> Result<()> {
    let text = pulled_plate("width_mm = 200\nlength_mm = 200\ncracks = [{ from_mm = [-10, 0], to_mm = [10, 0] }]");
    for lattice in [0.0, 22.5, 45.0] {
        let life = |ratio: f64| {
            let keys = [format!("model.lattice_angle_deg={lattice}"), format!("loading.stress_parallel_ratio={ratio}")];
            life(&text, &["model.spacing_mm=1", "stop.crack_length_mm=60", &keys[0], &keys[1]])
        };
        let alone = life(0.0)?;
        for ratio in [-1.0, 1.0] {
            let quantity =
                format!("square plate, crack 20-60 mm, lattice turned by {lattice}°: life at biaxiality {ratio} over that at 0");
            table.compare(quantity, life(ratio)? / alone, 1.0, 1.0, "K does not depend on the stress along the crack");
        }
    }
    Ok(())
}
