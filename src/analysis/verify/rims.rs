//! Stress concentration of holes, an elliptical opening and a notch on plates without cracks.

use super::cases::{overrides, plate_alone, pulled_plate};
use super::scene::concentration_of;
use super::table::Table;
use crate::element_free::rim_stress::{Rim, RimStress};
use crate::error::{Error, Result};
use crate::stress_concentration::stressed;

/// Bound of every row, percent.
const BOUND: f64 = 1.0;

/// Why a peak misses its bound.
const LEFT: &str =
    "what rings of nodes around a hole of a twentieth of the width, and the sides of a drawn arc, leave: peaks err by up to 2 %";

/// All rows.
pub fn rows(table: &mut Table) -> Result<()> {
    wide_plates(table)?;
    strips(table)?;
    outlines(table)
}

/// Largest and least stress of a rim over the stress on the loaded edges.
fn over_gross(text: &str, keys: &str, rim: Rim) -> Result<[f64; 2]> {
    let case = plate_alone(text, &overrides(keys))?;
    let stressed = stressed(&case)?;
    let found = stressed.rims.iter().find(|found: &&RimStress| found.rim == rim);
    let found = found.ok_or_else(|| Error::Mechanics(format!("{}: no such rim", case.name)))?;
    Ok([found.largest.stress, found.least.stress].map(|stress| stressed.concentration(stress).unwrap_or(f64::NAN)))
}

/// A hole of a twentieth of the width: 3σ - σ of the two stresses far away.
fn wide_plates(table: &mut Table) -> Result<()> {
    const SOURCE: &str = "Kirsch 1898, infinite plate (0.3 % at d/W 0.05)";
    let text = pulled_plate("width_mm = 400\nlength_mm = 400\nholes = [{ x_mm = 0, y_mm = 0, diameter_mm = 20 }]");
    for (name, keys, wanted) in [
        ("tension", "", [3.0, -1.0]),
        ("tension, plane strain, nu 0.45", "material.plane=\"strain\" material.poisson_ratio=0.45", [3.0, -1.0]),
        ("equal stresses", "loading.edges=[\"top\",\"bottom\",\"left\",\"right\"]", [2.0, 2.0]),
        ("shear", "loading.stress_parallel_ratio=-1", [4.0, -4.0]),
    ] {
        let found = over_gross(&text, keys, Rim::Hole(0))?;
        for (which, at) in [("largest", 0), ("least", 1)] {
            let quantity = format!("hole in a wide plate, {name}, nodes: {which} stress over σ");
            table.compare(quantity, found[at], wanted[at], BOUND, SOURCE);
            table.known_miss(LEFT, 1.8);
        }
    }
    Ok(())
}

/// A hole in a strip of finite width.
fn strips(table: &mut Table) -> Result<()> {
    for share in [0.1_f64, 0.2, 0.3, 0.4, 0.5] {
        let diameter = 100.0 * share;
        let hole = format!("holes = [{{ x_mm = 0, y_mm = 0, diameter_mm = {diameter} }}]");
        let found = over_gross(&pulled_plate(&format!("width_mm = 100\nlength_mm = 300\n{hole}")), "", Rim::Hole(0))?[0];
        let quantity = format!("hole in a strip, d/W {share}, nodes: K_tg");
        table.compare(quantity, found, concentration_of(share), BOUND, "Howland 1930 by the fit of Peterson (0.5 %)");
    }
    Ok(())
}

/// Openings drawn into the outline, a half of the plate by symmetry.
fn outlines(table: &mut Table) -> Result<()> {
    const ENDS: &str = "loading.edges=[\"top\",\"bottom\"]";
    let held = format!("supports.left.fix=[\"x\"] {ENDS}");
    for (quantity, axes, keys, wanted, source, known) in [
        (
            "elliptical opening 2:1 drawn as outline, nodes: K_tg",
            [20.0, 10.0],
            held.as_str(),
            5.0,
            "Inglis 1913, 1 + 2a/b, infinite plate (0.5 % at a/W 0.05)",
            1.9,
        ),
        (
            "semicircular edge notch drawn as outline, nodes: K_tg",
            [10.0, 10.0],
            ENDS,
            3.065,
            "Maunsell 1936, half plane (3.065), with bending of the remaining width (+0.3 % at a/W 0.025)",
            1.9,
        ),
    ] {
        table.compare(quantity, over_gross(&half_plate(axes), keys, Rim::Outline)?[0], wanted, BOUND, source);
        table.known_miss(LEFT, known);
    }
    Ok(())
}

/// A plate of 400 mm whose left side has half an ellipse of these half axes cut out, mm.
fn half_plate([a, b]: [f64; 2]) -> String {
    const SIDES: usize = 120;
    let corner = |k: usize| {
        // From the upper to the lower end of the opening.
        let (sin, cos) = (std::f64::consts::PI * k as f64 / SIDES as f64).sin_cos();
        format!("[{}, {}]", a * sin, b * cos)
    };
    let opening: Vec<String> = (0..=SIDES).map(corner).collect();
    pulled_plate(&format!("outline_mm = [[0, -200], [400, -200], [400, 200], [0, 200], {}]", opening.join(", ")))
}
