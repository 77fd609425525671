//! Does the life depend on how the plate is divided into points?

use super::scene::{PANEL, SMALL};
use crate::error::Result;
use crate::predict::{Silent, predict};
use crate::verify::Table;
use crate::verify::scene::case;

/// One A for all spacings at the default horizon ratio, and for wider horizons.
pub fn spacing(table: &mut Table) -> Result<()> {
    let reference = life(&["model.spacing_mm=1"])?;
    for (spacing, ratio) in [(2.0, 3.015), (0.5, 3.015), (1.0, 4.015), (1.0, 5.015), (0.5, 4.015), (0.5, 5.015)] {
        let set = [format!("model.spacing_mm={spacing}"), format!("model.horizon_ratio={ratio}")];
        let quantity = format!("M(T) W 110, a 20-27 mm: life at spacing {spacing} mm, ratio {ratio} over 1 mm, 3.015");
        table.compare(quantity, life(&[&set[0], &set[1]])? / reference, 1.0, 3.0, "one A for every resolution");
    }
    Ok(())
}

/// Broken bonds over those that a cut along the path severs.
pub fn clean_cracks(table: &mut Table) -> Result<()> {
    for p in ["2", "2.87", "4"] {
        let exponent = format!("fatigue.p={p}");
        let set = [&SMALL[..], &["model.spacing_mm=1", &exponent]].concat();
        let run = predict(&case(PANEL, &set)?, &Silent)?;
        // A spacing of straight crack between rows severs, of the bonds with vector ξ, |ξ_y| / Δ each.
        let severed: f64 = bonds_per_spacing(run.figures.horizon / run.figures.spacing) * 2.0 * 7.0 / (1e3 * run.figures.spacing);
        let broken = run.curve[run.curve.len() - 1].broken_bonds as f64;
        table.compare(
            format!("M(T) a 20-27 mm, p {p}: broken bonds over a clean cut's"),
            broken / severed,
            1.0,
            15.0,
            "a straight cut",
        );
    }
    Ok(())
}

/// Bonds that a horizontal cut severs per spacing of its length: Σ |ξ_y| / Δ over the upper half of the stencil.
fn bonds_per_spacing(ratio: f64) -> f64 {
    let reach = ratio.floor() as i32;
    let inside = |x: i32, y: i32| f64::from(x * x + y * y) <= ratio * ratio;
    (1..=reach)
        .flat_map(|y| (-reach..=reach).map(move |x| (x, y)))
        .filter(|&(x, y)| inside(x, y))
        .map(|(_, y)| f64::from(y))
        .sum()
}

fn life(set: &[&str]) -> Result<f64> {
    Ok(predict(&case(PANEL, &[&SMALL[..], set].concat())?, &Silent)?.life_cycles())
}
