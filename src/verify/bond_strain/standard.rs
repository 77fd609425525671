//! Does a crack whose bonds age grow at the rate of its K, wherever its bonds are strained otherwise than on the plate on which β is
//! computed?

use crate::error::Result;
use crate::predict::{Silent, predict};
use crate::verify::Table;
use crate::verify::scene::case;

const SINGLE_EDGE: &str = r#"
[specimen]
kind = "single_edge_tension"
ends = "uniform_stress"
width_mm = 100.0
length_mm = 190.0
thickness_mm = 2.0
crack_length_mm = 20.0
[loading]
stress_range_mpa = 48.28
stress_ratio = 0.2
[stop]
crack_length_mm = 36.0
"#;

const COMPACT: &str = r#"
[specimen]
kind = "compact_tension"
width_mm = 80.0
thickness_mm = 5.0
crack_length_mm = 24.0
[loading]
force_range_n = 4000.0
stress_ratio = 0.2
[stop]
crack_length_mm = 42.0
"#;

/// What both have.
const COMMON: &str = r#"
[material]
youngs_modulus_gpa = 73.1
poisson_ratio = 0.33
plane = "stress"
[model]
spacing_mm = 1.0
[fatigue]
paris_c_mm_per_cycle = 1e-10
paris_m = 3
"#;

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
///
/// # Errors
/// As [`predict`].
pub fn rows(table: &mut Table) -> Result<()> {
    for (name, p, nu, angle, ratio) in SCENES {
        let text = format!("{}{COMMON}", if name == "C(T)" { COMPACT } else { SINGLE_EDGE });
        let set = [
            format!("fatigue.paris_m={p}"),
            format!("material.poisson_ratio={nu}"),
            format!("model.lattice_angle_deg={angle}"),
            format!("model.horizon_ratio={ratio}"),
        ];
        let life = |how: &str| -> Result<f64> {
            let set = set.each_ref().map(String::as_str);
            Ok(predict(&case(&text, &[&set[..], &["stop.cycles_max=1e15", how]].concat())?, &Silent)?.life_cycles())
        };
        let reference = life("model.method=handbook")?;
        let computed = life("fatigue.driver=bond_strain")?;
        let quantity = format!("{name}, p {p}, nu {nu}, lattice at {angle}°, ratio {ratio}: life over quadrature, C and m");
        table.compare(quantity, computed / reference, 1.0, 5.0, "hand calculation with the same C and m");
    }
    Ok(())
}
