//! Fatigue bonds, driven by their own strain (`driver = "bond_strain"`) at the rate of the K of their tip: how well the controller holds
//! where bonds are strained otherwise than on the plate on which β is computed, and how clean a crack they leave. Lives and paths of a run
//! are those of K ([`super::lives`], [`super::paths`]) unless a case asks otherwise.

use super::cases::{self, MATERIAL_AND_LAW, PULL};
use super::table::Table;
use crate::error::Result;

const SINGLE_EDGE: &str = "[specimen]\nkind = \"single_edge_tension\"\nends = \"uniform_stress\"\nwidth_mm = 100\nlength_mm = 190\n\
                           thickness_mm = 2\ncrack_length_mm = 20\n";
const COMPACT: &str = "[specimen]\nkind = \"compact_tension\"\nwidth_mm = 80\nthickness_mm = 5\ncrack_length_mm = 24\n\
                       [loading]\nforce_max_n = 5000\nstress_ratio = 0.2\n";

/// Whether it is the single edge specimen, exponent, Poisson's ratio, angle of the lattice, horizon over spacing.
const SCENES: [(bool, f64, f64, f64, f64); 4] = [
    (true, 6.0, 0.2, 30.0, 3.015),
    (true, 4.5, 0.3, 20.0, 4.015),
    (false, 2.0, 0.1, 45.0, 3.015),
    (false, 2.87, 0.4, 0.0, 3.015),
];

/// Rows of the topic.
pub fn rows(table: &mut Table) -> Result<()> {
    for (is_edge, p, nu, angle, ratio) in SCENES {
        let (name, specimen, stop) =
            if is_edge { ("SE(T)", format!("{SINGLE_EDGE}{PULL}"), 36) } else { ("C(T)", COMPACT.to_owned(), 42) };
        let keys = format!(
            "model.spacing_mm=1 stop.crack_length_mm={stop} fatigue.paris_m={p} material.poisson_ratio={nu} \
             model.lattice_angle_deg={angle} model.horizon_ratio={ratio}"
        );
        let life = |how: &str| -> Result<f64> {
            Ok(cases::run(&format!("{specimen}{MATERIAL_AND_LAW}"), &format!("{keys} {how}"))?.life_cycles())
        };
        let (by_hand, computed) = (life("model.method=handbook")?, life("fatigue.driver=bond_strain")?);
        let quantity = format!("{name}, p {p}, nu {nu}, lattice at {angle}°, ratio {ratio}: life over quadrature, C and m");
        table.compare(quantity, computed / by_hand, 1.0, 5.0, "hand calculation with the same C and m");
    }
    clean_cracks(table)
}

/// A panel small enough for fine lattices.
const PANEL: &str = r#"
[specimen]
kind = "middle_tension"
width_mm = 110
length_mm = 140
thickness_mm = 2.54
crack_length_mm = 20
[material]
youngs_modulus_gpa = 73.1
poisson_ratio = 0.33
plane = "stress"
[loading]
stress_range_mpa = 48.28
stress_ratio = 0.2
[model]
spacing_mm = 1.0
[fatigue]
a = 1.6e4
horizon_mm = 3.015
driver = "bond_strain"
[stop]
crack_length_mm = 27
cycles_max = 1e12
"#;

/// Broken bonds over those that a cut along the path severs.
fn clean_cracks(table: &mut Table) -> Result<()> {
    for p in ["2", "2.87", "4"] {
        let run = cases::run(PANEL, &format!("fatigue.p={p}"))?;
        let spacing = run.figures.spacing;
        // A spacing of straight crack between rows severs, of the bonds with vector ξ, |ξ_y| / Δ each.
        let severed = bonds_per_spacing(run.figures.horizon / spacing) * 2.0 * 7.0 / (1e3 * spacing);
        let broken = run.curve[run.curve.len() - 1].broken_bonds as f64;
        let quantity = format!("M(T) a 20-27 mm, p {p}: broken bonds over a clean cut's");
        table.compare(quantity, broken / severed, 1.0, 15.0, "a straight cut");
    }
    Ok(())
}

/// Bonds that a horizontal cut severs per spacing of its length: Σ |ξ_y| / Δ over the upper half of the stencil.
fn bonds_per_spacing(ratio: f64) -> f64 {
    let reach = ratio.floor() as i32;
    let inside = |x: i32, y: i32| f64::from(x * x + y * y) <= ratio * ratio;
    let columns = |y: i32| (-reach..=reach).filter(|&x| inside(x, y)).count() as f64;
    (1..=reach).map(|y| f64::from(y) * columns(y)).sum()
}
