//! The element-free Galerkin method: stress concentration; K of standard specimens, slanted and edge cracks; first kinks, lives and
//! paths.

mod factors;
pub mod rims;

use super::references::{REFERENCES, SHARES};
use super::scene::{case, pulled_plate};
use super::standard::{ELEMENTS, standard_specimens};
use super::table::Table;
use crate::error::Result;
use crate::growth::element_free::initial_tips;
use crate::growth::tip_field::steering::kink_angle;
use crate::predict::{Silent, StopReason, predict};
use crate::units::MM;

/// The method.
const METHOD: &str = "model.method=element_free_galerkin";
/// Nominal stress of the pulled plates, Pa.
const STRESS: f64 = 60e6;

/// All rows of the topic.
pub fn all(table: &mut Table) -> Result<()> {
    rims::rows(table)?;
    factors::rows(table)?;
    edge_cracks(table)?;
    slanted_cracks(table)?;
    kinks(table)?;
    lives(table)?;
    plates(table)
}

/// `F = K_I / (σ √(π a))` of edge cracks in a square and in a long plate.
fn edge_cracks(table: &mut Table) -> Result<()> {
    const SOURCE: &str = "finite elements (tests/reference/edge_cracks.py), 0.005 %";
    for (share, height, wanted) in [(0.2, 50.0, 1.4869), (0.2, 200.0, 1.3673), (0.5, 50.0, 3.0087), (0.5, 200.0, 2.8246)] {
        let a = 50.0 * share;
        let crack = format!("cracks = [{{ from_mm = [-25, 0], to_mm = [{}, 0] }}]", a - 25.0);
        let text = pulled_plate(&format!("width_mm = 50\nlength_mm = {height}\n{crack}"));
        let tips = initial_tips(&case(&text, &[METHOD])?)?;
        let factor = tips[0].factors.unwrap_or([f64::NAN; 2])[0] / (STRESS * (std::f64::consts::PI * a * MM).sqrt());
        table.compare(format!("edge crack a/W {share}, height {height} mm, nodes: F"), factor, wanted, 0.3, SOURCE);
    }
    Ok(())
}

/// K_I and K_II of a crack of half length 1 mm in a plate 80 mm wide, over those of an infinite plate.
fn slanted_cracks(table: &mut Table) -> Result<()> {
    let unit = STRESS * (std::f64::consts::PI * MM).sqrt();
    for beta in [15.0_f64, 30.0, 45.0, 60.0, 75.0] {
        let (sin, cos) = beta.to_radians().sin_cos();
        let crack = format!("cracks = [{{ from_mm = [{}, {}], to_mm = [{sin}, {cos}] }}]", -sin, -cos);
        let text = pulled_plate(&format!("width_mm = 80\nlength_mm = 80\n{crack}"));
        let tips = initial_tips(&case(&text, &[METHOD])?)?;
        let [k_i, k_ii] = tips[1].factors.unwrap_or([f64::NAN; 2]).map(|factor| factor / unit);
        let (opening, sliding) = (sin * sin, sin * cos);
        let size = opening.hypot(sliding);
        for (mode, found, wanted) in [("K_I", k_i, opening), ("K_II", k_ii.abs(), sliding)] {
            table.error(
                format!("crack at {beta}° to the load, nodes: error of {mode} over |K|, percent"),
                100.0 * (found - wanted) / size,
                0.4,
                "infinite plate (0.05 %)",
            );
        }
    }
    Ok(())
}

/// First kinks of the same cracks, and of the Ti-6Al-4V plates of Pustejovsky 1979 (Eng. Fract. Mech. 11:9).
fn kinks(table: &mut Table) -> Result<()> {
    for beta in [15.0_f64, 30.0, 43.0, 60.0, 75.0] {
        let (sin, cos) = beta.to_radians().sin_cos();
        let crack = format!("cracks = [{{ from_mm = [{}, {}], to_mm = [{sin}, {cos}] }}]", -sin, -cos);
        let text = pulled_plate(&format!("width_mm = 40\nlength_mm = 40\n{crack}"));
        let case = case(&text, &[METHOD, "stop.crack_length_mm=2.02"])?;
        let run = predict(&case, &Silent)?;
        let [a, b] = case.specimen.tips[1].direction;
        let [from, to] = [0, 1].map(|row: usize| run.curve[row].tips[1].position);
        let [u, v] = [0, 1].map(|i| to[i] - from[i]);
        let kink = (a * v - b * u).atan2(a * u + b * v).to_degrees();
        let theory = kink_angle([sin * sin, sin * cos]).to_degrees();
        let bound = 100.0 / theory.abs();
        let quantity = format!("crack at {beta}° to the load, nodes: first kink, degrees");
        table.compare(quantity, kink, theory, bound, "maximum circumferential stress (Erdogan and Sih 1963)");
    }
    Ok(())
}

/// Lives of the standard specimens.
fn lives(table: &mut Table) -> Result<()> {
    for specimen in standard_specimens() {
        let ratio = specimen.over_quadrature(&[METHOD])?;
        table.compare(format!("{}, nodes: life over quadrature", specimen.name), ratio, 1.0, 0.5, ELEMENTS);
    }
    Ok(())
}

/// Path within 0.07 mm, life within 0.8 % (joints: 1 %), the same end.
fn plates(table: &mut Table) -> Result<()> {
    const PATH_MM: f64 = 0.07;
    for reference in &REFERENCES {
        let (run, tips) = reference.run(&[METHOD])?;
        let joins = reference.name == "three_cracks";
        let bound = if joins { 1.0 } else { 0.8 };
        for tip in tips.iter().filter(|tip| tip.way > 0.05) {
            let name = format!("{}, tip {}, nodes", reference.about, tip.tip);
            table.error(format!("{name}: path, mm rms"), tip.rms / MM, PATH_MM, "finite elements (tests/reference)");
            for (share, error) in SHARES.into_iter().zip(tip.cycles) {
                let quantity = format!("{name}: error of cycles at {share} of the way, percent");
                table.error(quantity, error, bound, "finite elements (tests/reference), 0.1 %");
            }
        }
        let ended = (run.stop == StopReason::EnteredHole) == reference.ends_in_hole;
        table.error(
            format!("{}, nodes: another end, 0 or 1", reference.about),
            f64::from(u8::from(!ended)),
            0.5,
            "finite elements (tests/reference)",
        );
    }
    Ok(())
}
