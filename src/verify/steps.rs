//! Are the cycle blocks of a run by K short enough?

use super::references::Curve;
use super::scene::{MATERIAL_AND_LAW, PULL, case, pulled_plate};
use super::table::Table;
use crate::error::Result;
use crate::predict::{Prediction, Silent, predict};
use crate::units::MM;

/// Share of life over which paths are compared: in the last percent tips pass each other closer than points resolve.
const COMPARED: f64 = 0.99;

/// Blocks of default length against blocks of a tenth of it: life, and path.
pub fn rows(table: &mut Table) -> Result<()> {
    let panel = format!(
        "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 80\nlength_mm = 160\nthickness_mm = 2\ncrack_length_mm = 10\n{PULL}{MATERIAL_AND_LAW}"
    );
    let plate = |keys: &str| pulled_plate(&format!("width_mm = 60\nlength_mm = 80\n{keys}"));
    let scenes = [
        ("M(T)", 0.3, panel),
        ("slant crack", 0.5, plate("cracks = [{ from_mm = [-5.2, -5.1], to_mm = [5.2, 5.1] }]")),
        (
            "two offset cracks",
            0.5,
            plate("cracks = [{ from_mm = [-21, 0.2], to_mm = [-9, 0.2] }, { from_mm = [4, -3.8], to_mm = [13, -3.8] }]"),
        ),
        (
            "edge crack beside a hole",
            0.5,
            plate("holes = [{ x_mm = 2, y_mm = 7, diameter_mm = 10 }]\ncracks = [{ from_mm = [-30, 0.2], to_mm = [-21, 0.2] }]"),
        ),
    ];
    for (name, bound, text) in scenes {
        let run = |error: f64| -> Result<Prediction> {
            predict(&case(&text, &["model.spacing_mm=1", &format!("fatigue.step_error_percent={error}")])?, &Silent)
        };
        let (coarse, fine) = (run(0.2)?, run(0.002)?);
        let [of_coarse, of_fine] = [&coarse, &fine].map(|run| run.figures.blocks);
        // Runs that end otherwise, or in as few blocks, are no comparison.
        let compares = coarse.stop == fine.stop && of_fine > 4 * of_coarse;
        let ratio = if compares { coarse.life_cycles() / fine.life_cycles() } else { f64::NAN };
        let what = format!("{name}: life in {of_coarse} blocks over that in {of_fine}");
        table.compare(what, ratio, 1.0, bound, "steps of a tenth");
        let off = |tip: usize| {
            let until = COMPARED * coarse.life_cycles();
            // The whole of the fine path: where a tip stands at one share of life may differ by a step along it.
            Curve::of_tip(&coarse, tip).until(until).largest_off(&Curve::of_tip(&fine, tip))
        };
        let off = (0..fine.curve[0].tips.len()).map(off).fold(0.0, f64::max) / MM;
        table.error(
            format!("{name}: largest distance of the path in {of_coarse} blocks from that in {of_fine}, % of a spacing"),
            100.0 * off,
            10.0,
            "steps of a tenth",
        );
    }
    Ok(())
}
