//! The panel whose bonds age.

/// The panel of Virkler, Hillberry and Goel (1979): middle tension, W 152.4 mm, stress range 48.28 MPa at R = 0.2, aluminium
/// 2024-T3 with the Paris-like exponent of its growth rates.
pub const PANEL: &str = r#"
[specimen]
kind = "middle_tension"
width_mm = 152.4
length_mm = 300.0
thickness_mm = 2.54
crack_length_mm = 9.0
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
p = 2.87
horizon_mm = 3.015
driver = "bond_strain"
"#;

/// Turns [`PANEL`] into one small enough for fine lattices, its crack long enough for wide horizons.
pub const SMALL: [&str; 5] = [
    "specimen.width_mm=110",
    "specimen.length_mm=140",
    "specimen.crack_length_mm=20",
    "stop.crack_length_mm=27",
    "stop.cycles_max=1e12",
];
