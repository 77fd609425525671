//! Stress concentration of holes, an elliptical opening and a notch on plates without cracks.

use super::cases::{overrides, plate_alone, pulled_plate};
use super::table::Table;
use perilife_base::error::{Error, Result};
use perilife_growth::stress_concentration::stressed;
use perilife_nodes::rim_stress::{Rim, RimStress};

/// Bound of holes, and of openings that are drawn by sides, percent.
const BOUND: [f64; 2] = [0.3, 1.0];

/// Where stresses of these very plates come from: infinite plates have 3, -1, 2, 4 and 5, the notch in a half plane 3.065.
const ELEMENTS: &str = "finite elements (tests/reference/openings.py)";

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

/// A hole of a twentieth of the width.
fn wide_plates(table: &mut Table) -> Result<()> {
    let text = pulled_plate("width_mm = 400\nlength_mm = 400\nholes = [{ x_mm = 0, y_mm = 0, diameter_mm = 20 }]");
    for (name, keys, wanted) in [
        ("tension", "", [3.0213, -1.0168]),
        ("tension, plane strain, nu 0.45", "material.plane=\"strain\" material.poisson_ratio=0.45", [3.0213, -1.0168]),
        ("equal stresses", "loading.edges=[\"top\",\"bottom\",\"left\",\"right\"]", [2.0045, 2.0045]),
        ("shear", "loading.stress_parallel_ratio=-1", [4.0381, -4.0381]),
    ] {
        let found = over_gross(&text, keys, Rim::Hole(0))?;
        for (which, at) in [("largest", 0), ("least", 1)] {
            let quantity = format!("hole in a wide plate, {name}, nodes: {which} stress over σ");
            table.compare(quantity, found[at], wanted[at], BOUND[0], ELEMENTS);
        }
    }
    Ok(())
}

/// A hole in a strip of finite width; Howland (1930) by the fit of Peterson is 0.4 to 0.9 % below the elements.
fn strips(table: &mut Table) -> Result<()> {
    for (diameter, wanted) in [(10, 3.0361), (20, 3.1526), (30, 3.3744), (40, 3.7472), (50, 4.3477)] {
        let hole = format!("holes = [{{ x_mm = 0, y_mm = 0, diameter_mm = {diameter} }}]");
        let found = over_gross(&pulled_plate(&format!("width_mm = 100\nlength_mm = 300\n{hole}")), "", Rim::Hole(0))?[0];
        let quantity = format!("hole of {diameter} mm in a strip of 100 mm, nodes: K_tg");
        table.compare(quantity, found, wanted, BOUND[0], ELEMENTS);
    }
    Ok(())
}

/// Openings drawn into the outline, a half of the plate by symmetry.
fn outlines(table: &mut Table) -> Result<()> {
    const ENDS: &str = "loading.edges=[\"top\",\"bottom\"]";
    let held = format!("supports.left.fix=[\"x\"] {ENDS}");
    for (quantity, axes, keys, wanted) in [
        ("elliptical opening 2:1 drawn as outline, nodes: K_tg", [20.0, 10.0], held.as_str(), 5.0766),
        ("semicircular edge notch drawn as outline, nodes: K_tg", [10.0, 10.0], ENDS, 3.0922),
    ] {
        table.compare(quantity, over_gross(&half_plate(axes), keys, Rim::Outline)?[0], wanted, BOUND[1], ELEMENTS);
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
