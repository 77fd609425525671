//! Good scene files, one of each procedure, which others break.

/// Motion in time.
pub const THROWN: &str = r#"[specimen]
kind = "plate"
width_mm = 40
length_mm = 20
thickness_mm = 2
cracks = [{ from_mm = [-20, 0], to_mm = [0, 0] }]
[material]
youngs_modulus_gpa = 65
poisson_ratio = 0.2
density_kg_m3 = 2235
fracture_energy_j_m2 = 204
[model]
spacing_mm = 1
[loading]
kind = "velocity"
velocity_mm_s = 100
edges = ["top", "bottom"]
duration_s = 1e-5
[damage]
law = "critical_energy"
"#;

/// Load steps, with a support.
pub const PULLED: &str = r#"[specimen]
kind = "plate"
width_mm = 40
length_mm = 20
thickness_mm = 2
notches = [{ from_mm = [-20, 0], to_mm = [-10, 0], width_mm = 2 }]
[material]
youngs_modulus_gpa = 203
poisson_ratio = 0.3
yield_strength_mpa = 345
tensile_strength_mpa = 572
[model]
spacing_mm = 1
[loading]
kind = "displacement"
displacement_mm = 0.1
edges = ["top"]
steps = 10
[supports]
bottom = { fix = ["x", "y"] }
[damage]
law = "nonlinear_two_parameter"
[micro_cracks]
seed = 1
count = 5
"#;

/// Correspondence under tractions, one static solve, with several levels asked for elsewhere.
pub const PRESSED: &str = r#"[specimen]
kind = "plate"
diameter_mm = 25.4
thickness_mm = 6.35
[material]
youngs_modulus_gpa = 1
poisson_ratio = 0.4
tensile_strength_mpa = 3
[model]
bond_law = "correspondence"
spacing_mm = 1
[loading]
kind = "platens"
displacement_mm = 0.1
edges = ["top", "bottom"]
steps = 10
[damage]
law = "principal_stress"
"#;

/// Points of two levels.
pub const REFINED: &str = r#"[specimen]
kind = "plate"
width_mm = 40
length_mm = 20
thickness_mm = 2
[material]
youngs_modulus_gpa = 30
poisson_ratio = 0.2
[model]
discretisation = "dual_horizon"
spacing_mm = 1
[loading]
kind = "traction"
stress_mpa = 5
edges = ["top", "bottom"]
[refinement]
regions = [{ box_mm = [[-5, -5], [5, 5]], levels = 1 }]
"#;

/// A good file, what is replaced in it, and what the message must contain.
pub type Bad = (&'static str, &'static str, &'static str, &'static [&'static str]);
