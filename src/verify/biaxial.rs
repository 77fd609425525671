//! A stress along a crack has no K.

use super::scene::{case, pulled_plate};
use super::table::Table;
use crate::error::Result;
use crate::predict::{Prediction, Silent, predict};
use crate::units::MPA;

/// Load of [`pulled_plate`], MPa.
const PULL_MPA: f64 = 60.0;

/// Life of a square plate under stress across and along its crack, over that without the latter, and the stress along the crack
/// that its first tip reads.
pub fn rows(table: &mut Table) -> Result<()> {
    let text = pulled_plate("width_mm = 200\nlength_mm = 200\ncracks = [{ from_mm = [-10, 0], to_mm = [10, 0] }]");
    for lattice in [0.0, 22.5, 45.0] {
        let run = |ratio: f64| -> Result<Prediction> {
            let keys = [format!("model.lattice_angle_deg={lattice}"), format!("loading.stress_parallel_ratio={ratio}")];
            predict(&case(&text, &["model.spacing_mm=1", "stop.crack_length_mm=60", &keys[0], &keys[1]])?, &Silent)
        };
        let name = format!("square plate, crack 20-60 mm, lattice turned by {lattice}°");
        let alone = run(0.0)?;
        let [pressed, pulled] = [run(-1.0)?, run(1.0)?];
        for (ratio, run) in [(-1.0, &pressed), (1.0, &pulled)] {
            let quantity = format!("{name}: life at biaxiality {ratio} over that at 0");
            let source = "K does not depend on the stress along the crack";
            table.compare(quantity, run.life_cycles() / alone.life_cycles(), 1.0, 1.0, source);
        }
        let [low, high] = [&pressed, &pulled].map(|run| run.curve[0].tips[0].t_stress.unwrap_or(f64::NAN));
        let quantity = format!("{name}: rise of the stress along the crack at the tip from biaxiality -1 to 1, MPa");
        table.compare(quantity, (high - low) / MPA, 2.0 * PULL_MPA, 1.0, "twice the load");
    }
    Ok(())
}
