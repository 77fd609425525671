//! Do law, solver and damage go together?

use super::files::{Bad, PRESSED, PULLED, THROWN};

/// Solvers and laws.
pub const SOLVERS: &[Bad] = &[
    (
        THROWN,
        "spacing_mm = 1",
        "spacing_mm = 1\nsolver = \"secant\"",
        &["model.solver", "secant", "duration_s", "velocity_verlet"],
    ),
    (
        THROWN,
        "spacing_mm = 1",
        "spacing_mm = 1\nsolver = \"adaptive_dynamic_relaxation\"",
        &["model.solver", "equilibrium", "velocity_verlet"],
    ),
    (THROWN, "spacing_mm = 1", "spacing_mm = 1\nsolver = \"multigrid\"", &["model.solver", "multigrid", "velocity_verlet"]),
    (PULLED, "spacing_mm = 1", "spacing_mm = 1\nsolver = \"velocity_verlet\"", &["model.solver", "duration_s"]),
    (
        PRESSED,
        "spacing_mm = 1",
        "spacing_mm = 1\nsolver = \"secant\"",
        &["model.solver", "correspondence", "adaptive_dynamic_relaxation"],
    ),
    (THROWN, "spacing_mm = 1", "spacing_mm = 1\nkinematics = \"finite\"", &["model.kinematics", "bond_based"]),
    (
        PULLED,
        "poisson_ratio = 0.3",
        "poisson_ratio = 0.35",
        &["material.poisson_ratio", "0.35", "two_parameter", "correspondence"],
    ),
    (PULLED, "spacing_mm = 1", "spacing_mm = 1\nbond_law = \"bond_based\"", &["material.poisson_ratio", "bond_based", "1/3"]),
    (PULLED, "poisson_ratio = 0.3", "poisson_ratio = 0.25\nplane = \"strain\"", &[]),
    (
        PULLED,
        "spacing_mm = 1",
        "spacing_mm = 1\nbond_law = \"state_based\"",
        &["model.bond_law", "state_based", "no damage", "correspondence"],
    ),
    (
        PULLED,
        "spacing_mm = 1",
        "spacing_mm = 1\nbond_law = \"springs\"",
        &[":14:", "model.bond_law", "springs", "bond_based, two_parameter, one_bond_two_parameter, correspondence"],
    ),
    (
        PULLED,
        "spacing_mm = 1",
        "spacing_mm = 1\nzero_energy_control = \"silling\"",
        &["model.zero_energy_control", "no zero-energy modes"],
    ),
    (PULLED, "spacing_mm = 1", "spacing_mm = 12", &["model.spacing_mm", "larger than the crack"]),
    (PRESSED, "spacing_mm = 1", "spacing_mm = 5", &["model.spacing_mm", "fewer than 8 points"]),
    (PRESSED, "spacing_mm = 1", "spacing_mm = 1e-3", &["model.spacing_mm", "points", "or more"]),
    (PRESSED, "spacing_mm = 1", "spacing_mm = 1\nzero_energy_factor = -1", &["model.zero_energy_factor", "-1", "negative"]),
    (
        PRESSED,
        "spacing_mm = 1",
        "spacing_mm = 1\nzero_energy_control = \"spring\"",
        &["model.zero_energy_factor", "missing", "N/m⁷"],
    ),
    (PRESSED, "spacing_mm = 1", "spacing_mm = 1\nzero_energy_control = \"spring\"\nzero_energy_factor = -1e22", &["negative"]),
    (
        PRESSED,
        "spacing_mm = 1",
        "spacing_mm = 1\nzero_energy_control = \"none\"\nzero_energy_factor = 1",
        &["model.zero_energy_factor", "none"],
    ),
    (PRESSED, "spacing_mm = 1", "spacing_mm = 1\nkernel = \"conical\"", &["model.kernel", "applies only to bond laws"]),
    (
        PRESSED,
        "spacing_mm = 1",
        "spacing_mm = 1\ndiscretisation = \"dual_horizon\"",
        &["model.discretisation", "dual_horizon", "does not support bond_law"],
    ),
];

/// Damage.
pub const DAMAGE: &[Bad] = &[
    (THROWN, "fracture_energy_j_m2 = 204\n", "", &["material.fracture_energy_j_m2", "missing", "damage.critical_stretch"]),
    (THROWN, "law = \"critical_energy\"", "law = \"critical_energy\"\nenters = \"force\"", &["damage.enters", "correspondence"]),
    (
        THROWN,
        "law = \"critical_energy\"",
        "law = \"critical_energy\"\nfinal_ratio = 2",
        &["damage.final_ratio", "nonlinear_two_parameter"],
    ),
    (THROWN, "law = \"critical_energy\"", "critical_stretch = 0.1", &["damage.critical_stretch", "critical_energy"]),
    (
        THROWN,
        "law = \"critical_energy\"",
        "law = \"critical_stretch\"\ncritical_stretch = 0.1\ncalibration = \"growth\"",
        &["damage.calibration", "growth", "damage.critical_stretch", "remove one of them"],
    ),
    (
        PULLED,
        "law = \"nonlinear_two_parameter\"",
        "law = \"nonlinear_two_parameter\"\ncalibration = \"growth\"",
        &["damage.calibration", "critical_energy", "remove it"],
    ),
    (PRESSED, "tensile_strength_mpa = 3\n", "", &["material.tensile_strength_mpa", "missing", "principal_stress"]),
    (PRESSED, "bond_law = \"correspondence\"", "bond_law = \"two_parameter\"", &["material.poisson_ratio", "correspondence"]),
    (
        PRESSED,
        "law = \"principal_stress\"",
        "law = \"critical_energy\"\ncritical_stretch = 0.1",
        &["damage.law", "springs", "principal_stress"],
    ),
    (PULLED, "law = \"nonlinear_two_parameter\"", "law = \"principal_stress\"", &["damage.law", "correspondence"]),
    (PULLED, "yield_strength_mpa = 345\n", "", &["damage.elastic_stretch", "yield_strength_mpa"]),
    (PULLED, "tensile_strength_mpa = 572\n", "", &["damage.peak_stretch", "tensile_strength_mpa"]),
    (PULLED, "yield_strength_mpa = 345", "yield_strength_mpa = 600", &["damage.elastic_stretch", "largest force"]),
    (
        PULLED,
        "law = \"nonlinear_two_parameter\"",
        "law = \"nonlinear_two_parameter\"\nfinal_ratio = 1",
        &["damage.final_ratio", "no softening"],
    ),
    (
        PULLED,
        "law = \"nonlinear_two_parameter\"",
        "law = \"nonlinear_two_parameter\"\nfinal_stretch = 0.002",
        &["damage.final_stretch", "must be above"],
    ),
    (
        PULLED,
        "law = \"nonlinear_two_parameter\"",
        "law = \"nonlinear_two_parameter\"\nfinal_stretch = 0.02\nfinal_ratio = 3",
        &["damage.final_ratio", "conflicts with final_stretch"],
    ),
];
