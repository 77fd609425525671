//! Does a crack whose bonds age grow at the rate of its K, wherever its bonds are strained otherwise than on the plate on which β is
//! computed?

use crate::error::Result;
use crate::predict::{Silent, predict};
use crate::verify::Table;
use crate::verify::scene::{MATERIAL_AND_LAW, PULL, case};

const SINGLE_EDGE: &str = "[specimen]\nkind = \"single_edge_tension\"\nends = \"uniform_stress\"\nwidth_mm = 100\nlength_mm = 190\n\
                           thickness_mm = 2\ncrack_length_mm = 20\n";
const COMPACT: &str = "[specimen]\nkind = \"compact_tension\"\nwidth_mm = 80\nthickness_mm = 5\ncrack_length_mm = 24\n\
                       [loading]\nforce_max_n = 5000\nstress_ratio = 0.2\n";

/// Specimen, exponent, Poisson's ratio, angle of the lattice, horizon over spacing.
const SCENES: [(&str, f64, f64, f64, f64); 12] = [
    ("SE(T)", 2.0, 0.33, 15.0, 3.015),
    ("SE(T)", 6.0, 0.2, 30.0, 3.015),
    ("SE(T)", 6.0, 0.33, 0.0, 3.015),
    ("SE(T)", 4.5, 0.3, 20.0, 4.015),
    ("SE(T)", 6.0, 0.3, 0.0, 5.015),
    ("C(T)", 2.0, 0.1, 45.0, 3.015),
    ("C(T)", 2.87, 0.1, 0.0, 3.015),
    ("C(T)", 6.0, 0.33, 15.0, 3.015),
    ("C(T)", 6.0, 0.33, 45.0, 3.015),
    ("C(T)", 4.5, 0.3, 20.0, 4.015),
    ("C(T)", 6.0, 0.3, 0.0, 4.015),
    ("C(T)", 2.87, 0.4, 0.0, 3.015),
];

/// Rows of the topic.
pub fn rows(table: &mut Table) -> Result<()> {
    for (name, p, nu, angle, ratio) in SCENES {
        let (specimen, stop) = match name {
            "C(T)" => (COMPACT.to_owned(), 42),
            _ => (format!("{SINGLE_EDGE}{PULL}"), 36),
        };
        let text = format!("{specimen}{MATERIAL_AND_LAW}");
        let set = [
            "model.spacing_mm=1".to_owned(),
            format!("stop.crack_length_mm={stop}"),
            format!("fatigue.paris_m={p}"),
            format!("material.poisson_ratio={nu}"),
            format!("model.lattice_angle_deg={angle}"),
            format!("model.horizon_ratio={ratio}"),
        ];
        let life = |how: &str| -> Result<f64> {
            let set = set.each_ref().map(String::as_str);
            Ok(predict(&case(&text, &[&set[..], &[how]].concat())?, &Silent)?.life_cycles())
        };
        let reference = life("model.method=handbook")?;
        let computed = life("fatigue.driver=bond_strain")?;
        let quantity = format!("{name}, p {p}, nu {nu}, lattice at {angle}°, ratio {ratio}: life over quadrature, C and m");
        table.compare(quantity, computed / reference, 1.0, 5.0, "hand calculation with the same C and m");
    }
    Ok(())
}
