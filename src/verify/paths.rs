//! Where cracks go: first kinks, cracks that join, curved paths beside finite elements.

use super::collinear::{Collinear, growth_integral};
use super::references;
use super::scene::{case, pulled_plate};
use super::table::Table;
use crate::calibration::median::cycles_of_run;
use crate::error::Result;
use crate::growth::tip_field::steering::kink_angle;
use crate::predict::{Silent, StopReason, predict};
use crate::units::{MM, MPA};

/// All rows of the topic.
pub fn all(table: &mut Table) -> Result<()> {
    kinks(table)?;
    collinear_cracks(table)?;
    references::rows(table)
}

/// First kinks of a crack of half length 36 mm, six horizons, at β to the load in a plate 240 mm wide, whatever the lattice.
fn kinks(table: &mut Table) -> Result<()> {
    const BOUND_DEGREES: f64 = 1.0;
    const SPREAD_DEGREES: f64 = 0.5;
    for beta in [15.0_f64, 30.0, 45.0, 60.0, 75.0] {
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for lattice in [0.0, 10.0, 22.5, 37.0, 45.0] {
            let (sin, cos) = beta.to_radians().sin_cos();
            let [x, y] = [36.0 * sin, 36.0 * cos];
            let crack = format!("cracks = [{{ from_mm = [{}, {}], to_mm = [{x}, {y}] }}]", -x, -y);
            let text = pulled_plate(&format!("width_mm = 240\nlength_mm = 240\n{crack}"));
            let lattice_key = format!("model.lattice_angle_deg={lattice}");
            let case = case(&text, &["model.spacing_mm=2", &lattice_key, "stop.crack_length_mm=73"])?;
            let run = predict(&case, &Silent)?;
            let [a, b] = case.specimen.tips[1].direction;
            let [from, to] = [0, 1].map(|row: usize| run.curve[row].tips[1].position);
            let [u, v] = [0, 1].map(|i| to[i] - from[i]);
            let kink = (a * v - b * u).atan2(a * u + b * v).to_degrees();
            (least, most) = (least.min(kink), most.max(kink));
            let theory = kink_angle([sin * sin, sin * cos]).to_degrees();
            table.compare(
                format!("crack at {beta}° to the load, lattice turned by {lattice}°: first kink, degrees"),
                kink,
                theory,
                100.0 * BOUND_DEGREES / theory.abs(),
                "maximum circumferential stress (Erdogan and Sih 1963)",
            );
        }
        table.error(
            format!("crack at {beta}° to the load: spread of its first kink over five lattices, degrees"),
            most - least,
            SPREAD_DEGREES,
            "mechanics knows no lattice",
        );
    }
    Ok(())
}

/// Two collinear cracks that grow towards each other: life against quadrature, and that they become one.
fn collinear_cracks(table: &mut Table) -> Result<()> {
    const WIDTH_MM: f64 = 240.0;
    const M: f64 = 3.0;
    let (inner, outer) = (12.0, 36.0);
    let text = pulled_plate(&format!(
        "width_mm = {WIDTH_MM}\nlength_mm = 600\ncracks = [{{ from_mm = [-{outer}, 0], to_mm = [-{inner}, 0] }}, \
         {{ from_mm = [{inner}, 0], to_mm = [{outer}, 0] }}]"
    ));
    let case = case(&text, &["model.spacing_mm=1"])?;
    let run = predict(&case, &Silent)?;
    let start = Collinear { inner: inner * MM, outer: outer * MM };
    let stress = case.loading.maximum * case.loading.range_share();
    for ligament in [18.0, 12.0, 6.0] {
        let left = 0.5 * ligament * MM;
        let paris = case.paris_law()?;
        // C belongs to MPa√m.
        let by_hand = growth_integral(start, left, WIDTH_MM * MM, stress / MPA, M) / paris.c;
        let growth: Vec<(f64, f64)> =
            run.curve.iter().map(|point| (point.cycles, 0.5 * (point.tips[1].growth + point.tips[2].growth))).collect();
        let cycles = cycles_of_run(&growth, &[0.0, start.inner - left])?[1];
        let quantity = format!("two collinear cracks 24 mm apart: life to a ligament of {ligament} mm over quadrature");
        table.compare(
            quantity,
            cycles / by_hand,
            1.0,
            2.0,
            "closed form with elliptic integrals (Tada, Paris and Irwin 2000), width to leading order",
        );
    }
    // Joined, the outer tips go on to both edges.
    let joined = run.curve.last().map_or(f64::NAN, |row| 0.5 * (row.tips[0].growth + row.tips[3].growth));
    let to_edge = 0.5 * WIDTH_MM * MM - start.outer;
    let ended = matches!(run.stop, StopReason::LeftPlate | StopReason::Severed);
    let missing = if ended { 100.0 * (1.0 - joined / to_edge) } else { 100.0 };
    table.error(
        "two collinear cracks: way of the outer tips that is missing to the edges",
        missing,
        5.0,
        "one crack to both edges",
    );
    Ok(())
}
