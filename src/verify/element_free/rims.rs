//! Stress concentration of holes, an elliptical opening and a notch on plates without cracks.

use crate::case::Case;
use crate::element_free::rim_stress::{Rim, RimStress};
use crate::error::{Error, Result};
use crate::stress_concentration::stressed;
use crate::verify::scene::{plate_alone, pulled_plate};
use crate::verify::table::Table;

/// Bound of every row, percent.
const BOUND: f64 = 1.0;

/// Why a peak misses its bound.
const SCATTER: &str = "strains of Gauss points err from node to node by 2 to 3 % of the largest stress, and what is evened out along the rim \
     leaves up to 0.07 σ at a hole";

/// All rows.
pub fn rows(table: &mut Table) -> Result<()> {
    wide_plates(table)?;
    strips(table)?;
    outlines(table)
}

fn over_gross(case: &Case, rim: Rim) -> Result<[f64; 2]> {
    let stressed = stressed(case)?;
    let of = |found: &&RimStress| found.rim == rim;
    let found = stressed.rims.iter().find(of).ok_or_else(|| Error::Mechanics(format!("{}: no such rim", case.name)))?;
    let over = |stress: f64| stressed.concentration(stress).unwrap_or(f64::NAN);
    Ok([over(found.largest.stress), over(found.least.stress)])
}

/// A hole of a twentieth of the width: 3σ - σ of the two stresses far away.
fn wide_plates(table: &mut Table) -> Result<()> {
    const SOURCE: &str = "Kirsch 1898, infinite plate (0.3 % at d/W 0.05)";
    let text = pulled_plate("width_mm = 400\nlength_mm = 400\nholes = [{ x_mm = 0, y_mm = 0, diameter_mm = 20 }]");
    let all = "loading.edges=[\"top\", \"bottom\", \"left\", \"right\"]";
    for (name, set, wanted) in [
        ("tension", &[][..], [3.0, -1.0]),
        ("tension, plane strain, nu 0.45", &["material.plane=\"strain\"", "material.poisson_ratio=0.45"], [3.0, -1.0]),
        ("equal stresses", &[all], [2.0, 2.0]),
        ("shear", &["loading.stress_parallel_ratio=-1"], [4.0, -4.0]),
    ] {
        let found = over_gross(&plate_alone(&text, set)?, Rim::Hole(0))?;
        for (which, found, wanted) in [("largest", found[0], wanted[0]), ("least", found[1], wanted[1])] {
            table.compare(format!("hole in a wide plate, {name}, nodes: {which} stress over σ"), found, wanted, BOUND, SOURCE);
            table.known_miss(SCATTER, 7.1);
        }
    }
    Ok(())
}

/// A hole in a strip of finite width.
fn strips(table: &mut Table) -> Result<()> {
    for share in [0.1_f64, 0.2, 0.3, 0.4, 0.5] {
        let hole = format!("holes = [{{ x_mm = 0, y_mm = 0, diameter_mm = {} }}]", 100.0 * share);
        let text = pulled_plate(&format!("width_mm = 100\nlength_mm = 300\n{hole}"));
        let found = over_gross(&plate_alone(&text, &[])?, Rim::Hole(0))?[0];
        let quantity = format!("hole in a strip, d/W {share}, nodes: K_tg");
        table.compare(quantity, found, concentration_of(share), BOUND, "Howland 1930 by the fit of Peterson (0.5 %)");
    }
    Ok(())
}

/// Largest stress over that far away of a hole of d/W = x in a strip in tension: (3 - 3.14 x + 3.667 x² - 1.527 x³)/(1 - x), a fit to
/// Howland 1930 within 0.5 % (Pilkey and Pilkey 2008).
#[allow(clippy::approx_constant, reason = "a coefficient of the fit, not π")]
pub fn concentration_of(x: f64) -> f64 {
    (3.0 - x * (3.14 - x * (3.667 - 1.527 * x))) / (1.0 - x)
}

/// Openings drawn into the outline, a half of the plate by symmetry.
fn outlines(table: &mut Table) -> Result<()> {
    let ellipse = half_plate([20.0, 10.0], 400.0, 400.0);
    let held = ["supports.left.fix=[\"x\"]", "loading.edges=[\"top\", \"bottom\"]"];
    let found = over_gross(&plate_alone(&ellipse, &held)?, Rim::Outline)?[0];
    let source = "Inglis 1913, 1 + 2a/b, infinite plate (0.5 % at a/W 0.05)";
    table.compare("elliptical opening 2:1 drawn as outline, nodes: K_tg", found, 5.0, BOUND, source);
    table.known_miss(SCATTER, 1.216);
    let notch = half_plate([10.0, 10.0], 400.0, 400.0);
    let found = over_gross(&plate_alone(&notch, &["loading.edges=[\"top\", \"bottom\"]"])?, Rim::Outline)?[0];
    let source = "Maunsell 1936, half plane (3.065), with bending of the remaining width (+0.3 % at a/W 0.025)";
    table.compare("semicircular edge notch drawn as outline, nodes: K_tg", found, 3.065, BOUND, source);
    table.known_miss(SCATTER, 2.15);
    Ok(())
}

/// A plate whose left side has half an ellipse of these half axes cut out, mm.
fn half_plate([a, b]: [f64; 2], width: f64, length: f64) -> String {
    const SIDES: usize = 120;
    let half = 0.5 * length;
    let corner = |k: usize| {
        // From the upper to the lower end of the opening.
        let (sin, cos) = (std::f64::consts::PI * k as f64 / SIDES as f64).sin_cos();
        format!("[{}, {}]", a * sin, b * cos)
    };
    let opening: Vec<String> = (0..=SIDES).map(corner).collect();
    let outline =
        format!("outline_mm = [[0, {}], [{width}, {}], [{width}, {half}], [0, {half}], {}]", -half, -half, opening.join(", "));
    pulled_plate(&outline)
}
