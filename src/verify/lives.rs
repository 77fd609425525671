//! Lives of standard specimens with given C and m against quadrature; nothing is fitted.

use super::scene::{MATERIAL_AND_LAW, case};
use super::standard::{ELEMENTS, standard_specimens};
use super::table::Table;
use crate::error::Result;
use crate::predict::{Silent, predict};

/// Bound of a life, percent.
const BOUND: f64 = 1.0;

/// All rows of the topic.
pub fn all(table: &mut Table) -> Result<()> {
    standard(table)?;
    laws(table)?;
    bending(table)
}

/// Every specimen by m of 2 to 6, at default resolution.
fn standard(table: &mut Table) -> Result<()> {
    for specimen in standard_specimens() {
        for m in [2.0, 3.0, 4.5, 6.0] {
            let ratio = specimen.over_quadrature(&[&format!("fatigue.paris_m={m}")])?;
            table.compare(format!("{}, m {m}: life over quadrature", specimen.name), ratio, 1.0, BOUND, ELEMENTS);
        }
    }
    Ok(())
}

/// The same panel by every bond law and kernel.
fn laws(table: &mut Table) -> Result<()> {
    let [panel, ..] = standard_specimens();
    let panel = panel.from_to([20.0, 32.0]);
    let all: [(&str, &[&str]); 3] = [
        ("constant kernel", &["model.kernel=constant"]),
        ("bond_based", &["model.bond_law=bond_based", "material.poisson_ratio=0.3333333333"]),
        ("state_based", &["model.bond_law=state_based"]),
    ];
    for (name, set) in all {
        let ratio = panel.over_quadrature(&[&["model.spacing_mm=1"], set].concat())?;
        table.compare(format!("M(T), m 3, {name}: life over quadrature"), ratio, 1.0, BOUND, ELEMENTS);
    }
    Ok(())
}

/// K of single-edge bend specimens between rollers, span 4 W, at default resolution.
fn bending(table: &mut Table) -> Result<()> {
    // W 50 mm, B 10 mm, 8 kN: f(x) of ASTM E399, good to 0.5 %.
    let k = |x: f64| {
        let f = 3.0 * x.sqrt() * (1.99 - x * (1.0 - x) * (2.15 - 3.93 * x + 2.7 * x * x))
            / (2.0 * (1.0 + 2.0 * x) * (1.0 - x).powf(1.5));
        8e3 * 0.2 / (0.01 * 0.05_f64.powf(1.5)) * f / 1e6
    };
    for a in [15.0, 25.0] {
        let text = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 220\nlength_mm = 50\nthickness_mm = 10\n\
             cracks = [{{ from_mm = [0, -25], to_mm = [0, {}] }}]\n\
             [loading]\nforce_max_n = 8000\nstress_ratio = 0\n\
             rollers = [{{ at_mm = [0, 25], contact_width_mm = 0.5 }}, {{ at_mm = [-100, -25], contact_width_mm = 2, share = 0.5 }}, \
             {{ at_mm = [100, -25], contact_width_mm = 2, share = 0.5 }}]\n[model]\nspacing_mm = 0.5\n{MATERIAL_AND_LAW}",
            a - 25.0
        );
        let case = case(&text, &[&format!("stop.crack_length_mm={}", a + 0.01)])?;
        let computed = predict(&case, &Silent)?.curve[0].delta_k / 1e6;
        let what = format!("bend specimen between rollers, a/W = {}: K, MPa√m", a / 50.0);
        table.compare(what, computed, k(a / 50.0), BOUND, "ASTM E399, 0.5 %");
    }
    Ok(())
}
