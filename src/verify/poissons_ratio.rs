//! Does the life at equal K depend on Poisson's ratio, plane state or bond law?

use super::standard::{ELEMENTS, standard_specimens};
use super::table::Table;
use crate::error::Result;

/// Poisson's ratio in plane strain at which the material hardly changes its volume, and the error known there, percent.
const INCOMPRESSIBLE: (f64, f64) = (0.49, 2.54);

/// Lives of a panel against quadrature, which knows none of them: m 3, a 20 to 32 mm.
pub fn rows(table: &mut Table) -> Result<()> {
    let [panel, ..] = standard_specimens();
    let panel = panel.from_to([20.0, 32.0]);
    let planes: [(&str, &[f64]); 2] =
        [("stress", &[0.05, 0.1, 0.2, 0.33, 0.4, 0.45, 0.49]), ("strain", &[0.05, 0.1, 0.2, 0.3, 0.4, 0.45, 0.49])];
    for (plane, ratios) in planes {
        for nu in ratios {
            row(table, &panel, plane, *nu, None)?;
        }
    }
    for (plane, nu) in [("stress", 0.1), ("stress", 0.2), ("strain", 0.2)] {
        row(table, &panel, plane, nu, Some("state_based"))?;
    }
    Ok(())
}

/// With the law that a case gets by itself, or this one.
fn row(table: &mut Table, panel: &super::standard::Standard, plane: &str, nu: f64, law: Option<&str>) -> Result<()> {
    let keys = [format!("material.plane={plane}"), format!("material.poisson_ratio={nu}")];
    let law_key = law.map(|law| format!("model.bond_law={law}"));
    let set: Vec<&str> = keys.iter().chain(&law_key).map(String::as_str).chain(["model.spacing_mm=1"]).collect();
    let name = law.map_or_else(String::new, |law| format!("{law}, "));
    let quantity = format!("M(T), m 3, {name}plane {plane}, nu {nu}: life over quadrature");
    table.compare(quantity, panel.over_quadrature(&set)?, 1.0, 1.0, ELEMENTS);
    let (incompressible, known) = INCOMPRESSIBLE;
    if plane == "strain" && nu == incompressible {
        table.known_miss(
            "towards nu = 0.5 in plane strain the pressure is a small volume change times a large modulus; the ring takes it from \
             displacements, and reads K 0.8 % too low",
            known,
        );
    }
    Ok(())
}
