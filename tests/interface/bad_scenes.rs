//! Broken scene files: each is refused with file, key and what would be right; nothing panics.

use std::path::Path;

use perilife::Error;
use perilife::case::Case;
use perilife::fracture::Scene;
use proptest::prelude::*;

use crate::bad_toml::any_value;
use crate::cli::{self, perilife, texts};

/// Motion in time.
const THROWN: &str = r#"[specimen]
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
const PULLED: &str = r#"[specimen]
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
const PRESSED: &str = r#"[specimen]
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
const REFINED: &str = r#"[specimen]
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
type Bad = (&'static str, &'static str, &'static str, &'static [&'static str]);

const BAD: &[Bad] = &[
    // Keys, sections, types
    (THROWN, "width_mm = 40", "widht_mm = 40", &[":3:", "specimen.widht_mm", "not a known key", "width_mm", "diameter_mm"]),
    (
        THROWN,
        "velocity_mm_s = 100",
        "velocity = 100",
        &[":16:", "loading.velocity", "not a known key", "velocity_mm_s", "duration_s"],
    ),
    (THROWN, "velocity_mm_s = 100", "stress_max_mpa = 100", &["loading.stress_max_mpa", "cycles", "perilife predict"]),
    (THROWN, "velocity_mm_s = 100\n", "", &["loading.velocity_mm_s", "missing"]),
    (THROWN, "velocity_mm_s = 100", "velocity_mm_s = \"fast\"", &[":16:", "loading.velocity_mm_s", "fast", "a number"]),
    (THROWN, "velocity_mm_s = 100", "velocity_mm_s = 0", &["loading.velocity_mm_s", "loads nothing", "[supports]"]),
    (THROWN, "velocity_mm_s = 100", "velocity_mm_s = nan", &["loading.velocity_mm_s", "finite"]),
    (THROWN, "velocity_mm_s = 100", "velocity_mm_s = 1\nstress_mpa = 1", &["loading.stress_mpa", "does not go with", "velocity"]),
    (THROWN, "kind = \"velocity\"\n", "", &[":14:", "loading.kind", "missing"]),
    (THROWN, "kind = \"velocity\"", "kind = \"explosion\"", &[":15:", "loading.kind", "explosion", "traction, displacement"]),
    (
        THROWN,
        "kind = \"velocity\"",
        "kind = \"constant_amplitude\"",
        &["loading.kind", "constant_amplitude", "velocity, platens"],
    ),
    (THROWN, "[damage]", "[fatigue]\na = 1\n[damage]", &["fatigue", "no cycles", "perilife predict"]),
    (THROWN, "[damage]", "[stop]\ncycles_max = 1\n[damage]", &["stop", "perilife predict"]),
    (THROWN, "[damage]", "[fit]\nparameters = []\n[damage]", &["fit", "perilife calibrate"]),
    (THROWN, "[damage]", "[demage]", &[":19:", "demage", "not a known section", "micro_cracks"]),
    (THROWN, "[specimen]", "colour = 3\n[specimen]", &[":1:", "colour", "no section"]),
    (THROWN, "[damage]\nlaw = \"critical_energy\"", "damage = 3", &["loading.damage", "not a known key"]),
    (THROWN, "law = \"critical_energy\"", "law = \"brittle\"", &[":20:", "damage.law", "brittle", "critical_stretch"]),
    (THROWN, "law = \"critical_energy\"", "strength = 3", &["damage.strength", "not a known key", "critical_stretch"]),
    (THROWN, "spacing_mm = 1", "method = \"peridynamics\"", &["model.method", "not a known key", "bond_law"]),
    // Where loads and supports act
    (THROWN, "edges = [\"top\", \"bottom\"]\n", "", &["loading.edges", "missing", "regions"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = []", &["loading.edges", "empty"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\", \"top\"]", &["loading.edges[1]", "twice"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"up\"]", &[":17:", "loading.edges", "up", "top, bottom"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\ngrip_mm = 11", &["loading.grip_mm", "11", "half the plate"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\nrange_mm = [5, -5]", &["loading.range_mm", "does not rise"]),
    (
        THROWN,
        "edges = [\"top\", \"bottom\"]",
        "edges = [\"top\"]\nrange_mm = [25, 30]",
        &["loading.range_mm", "beside the plate", "-20 and 20"],
    ),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\ndirection = [0, 0]", &["loading.direction", "no direction"]),
    (
        THROWN,
        "edges = [\"top\", \"bottom\"]",
        "regions = [{ from_mm = [0, 0], to_mm = [5, 5] }]",
        &["loading.direction", "outward"],
    ),
    (
        THROWN,
        "edges = [\"top\", \"bottom\"]",
        "regions = [{ from_mm = [50, 0], to_mm = [55, 5] }]\ndirection = [0, 1]",
        &["loading.regions[0]", "outside the plate", "(20, 10) mm"],
    ),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\nregions = []", &["loading.regions", "beside edges"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\nparts = []", &["stands beside parts", "move it into a part"]),
    (
        THROWN,
        "kind = \"velocity\"\nvelocity_mm_s = 100\nedges = [\"top\", \"bottom\"]",
        "parts = []",
        &["loading.parts", "1 to 50"],
    ),
    (
        THROWN,
        "kind = \"velocity\"\nvelocity_mm_s = 100\nedges = [\"top\", \"bottom\"]",
        "parts = [{ kind = \"velocity\", edges = [\"top\"] }]",
        &["loading.parts[0].velocity_mm_s", "missing"],
    ),
    (PULLED, "bottom = { fix = [\"x\", \"y\"] }", "bottom = { fix = [] }", &["supports.bottom.fix", "holds nothing"]),
    (
        PULLED,
        "bottom = { fix = [\"x\", \"y\"] }",
        "below = { fix = [\"y\"] }",
        &["supports.below", "neither a side", "top, bottom"],
    ),
    (PULLED, "bottom = { fix = [\"x\", \"y\"] }", "top = { fix = [\"x\", \"y\"] }", &["two motions along y", "range_mm"]),
    (PULLED, "bottom = { fix = [\"x\", \"y\"] }", "left = { fix = [\"x\", \"y\"] }", &["two motions along y", "left", "top"]),
    (
        PULLED,
        "bottom = { fix = [\"x\", \"y\"] }",
        "pin = { from_mm = [30, 0], to_mm = [31, 1], fix = [\"y\"] }",
        &["supports.pin", "outside the plate"],
    ),
    (PRESSED, "displacement_mm = 0.1", "displacement_mm = -0.1", &["loading.displacement_mm", "does not press"]),
    (PRESSED, "steps = 10", "steps = 10\ndirection = [0, 1]", &["loading.direction", "platens"]),
    (PRESSED, "steps = 10", "steps = 10\ntransverse = \"held\"", &["loading.transverse", "platens"]),
    (PRESSED, "diameter_mm = 25.4", "diameter_mm = 25.4\nwidth_mm = 3", &["specimen.diameter_mm", "stands beside"]),
    (PRESSED, "diameter_mm = 25.4", "diameter_mm = -1", &["specimen.diameter_mm", "above zero"]),
    (REFINED, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\ngrip_mm = 1", &["loading.grip_mm", "traction"]),
    // Time
    (THROWN, "duration_s = 1e-5\n", "", &["loading.kind", "velocity", "without time", "duration_s"]),
    (THROWN, "duration_s = 1e-5", "steps = 5", &["loading.kind", "velocity", "without time"]),
    (THROWN, "duration_s = 1e-5", "duration_s = 1e-5\nsteps = 5", &["loading.steps", "beside duration_s"]),
    (THROWN, "duration_s = 1e-5", "duration_s = 0", &["loading.duration_s", "above zero"]),
    (THROWN, "duration_s = 1e-5", "duration_s = 1e-5\ntime_step_s = 2e-5", &["loading.time_step_s", "longer than duration_s"]),
    (THROWN, "duration_s = 1e-5", "duration_s = 1e-5\ntime_step_s = -1", &["loading.time_step_s", "above zero"]),
    (THROWN, "density_kg_m3 = 2235\n", "", &["material.density_kg_m3", "missing", "mass"]),
    (
        THROWN,
        "kind = \"velocity\"\nvelocity_mm_s = 100",
        "kind = \"displacement\"\ndisplacement_mm = 1",
        &["loading.ramp_s", "missing", "infinite velocity"],
    ),
    (PULLED, "steps = 10", "steps = 0", &["loading.steps", "1 to"]),
    (PULLED, "steps = 10", "steps = -3", &["loading.steps", "whole number"]),
    (PULLED, "steps = 10", "steps = 10\nramp_s = 1", &["loading.ramp_s", "without duration_s"]),
    (PULLED, "steps = 10", "time_step_s = 1", &["loading.time_step_s", "without duration_s"]),
    // Solvers and laws
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
    (
        REFINED,
        "\"dual_horizon\"",
        "\"variable_horizon\"\nsolver = \"secant\"",
        &[":11:", "model.solver", "secant", "variable_horizon", "energy", "adaptive_dynamic_relaxation"],
    ),
    (REFINED, "\"dual_horizon\"", "\"variable_horizon\"", &[]),
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
    (PULLED, "spacing_mm = 1", "spacing_mm = 1\nbond_law = 3", &["model.bond_law", "text"]),
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
    (PRESSED, "spacing_mm = 1", "spacing_mm = 1\nkernel = \"conical\"", &["model.kernel", "laws of bonds"]),
    (
        PRESSED,
        "spacing_mm = 1",
        "spacing_mm = 1\ndiscretisation = \"dual_horizon\"",
        &["model.discretisation", "dual_horizon", "laws of bonds"],
    ),
    // Damage
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
        "law = \"critical_stretch\"\ncritical_stretch = -0.1",
        &["damage.critical_stretch", "above zero"],
    ),
    (PRESSED, "tensile_strength_mpa = 3\n", "", &["material.tensile_strength_mpa", "missing", "principal_stress"]),
    (PRESSED, "bond_law = \"correspondence\"", "bond_law = \"two_parameter\"", &["material.poisson_ratio", "correspondence"]),
    (
        PRESSED,
        "law = \"principal_stress\"",
        "law = \"critical_energy\"\ncritical_stretch = 0.1",
        &["damage.law", "springs", "principal_stress"],
    ),
    (
        PRESSED,
        "law = \"principal_stress\"",
        "law = \"principal_stress\"\nenters = \"both\"",
        &["damage.enters", "both", "force, influence"],
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
        &["damage.final_stretch", "not beyond"],
    ),
    (
        PULLED,
        "law = \"nonlinear_two_parameter\"",
        "law = \"nonlinear_two_parameter\"\nfinal_stretch = 0.02\nfinal_ratio = 3",
        &["damage.final_ratio", "given twice"],
    ),
    (
        PULLED,
        "law = \"nonlinear_two_parameter\"",
        "law = \"nonlinear_two_parameter\"\nprinted_law = 1",
        &["damage.printed_law", "true or false"],
    ),
    // Refinement and micro cracks
    (REFINED, "discretisation = \"dual_horizon\"\n", "", &["model.discretisation", "[refinement]", "dual_horizon"]),
    (REFINED, "[[-5, -5], [5, 5]]", "[[25, -5], [30, 5]]", &["refinement.regions[0].box_mm", "outside the plate", "(-20, -10)"]),
    (REFINED, "[[-5, -5], [5, 5]]", "[[5, -5], [5, 5]]", &["refinement.regions[0].box_mm", "no area"]),
    (REFINED, "levels = 1", "levels = 0", &["refinement.regions[0].levels", "1 to 4"]),
    (REFINED, "levels = 1", "levels = 9", &["refinement.regions[0].levels", "1 to 4"]),
    (REFINED, "levels = 1", "levels = 1, width_mm = 3", &["refinement.regions[0].width_mm", "band"]),
    (REFINED, "box_mm = [[-5, -5], [5, 5]]", "band_mm = [[-5, -5], [5, 5]]", &["refinement.regions[0].width_mm", "missing"]),
    (
        REFINED,
        "box_mm = [[-5, -5], [5, 5]]",
        "band_mm = [[-5, 25], [5, 25]], width_mm = 2",
        &["refinement.regions[0].band_mm", "outside the plate"],
    ),
    (
        REFINED,
        "box_mm = [[-5, -5], [5, 5]]",
        "around_flaws_mm = 2",
        &["refinement.regions[0].around_flaws_mm", "nothing to lie around"],
    ),
    (REFINED, "regions = [{ box_mm = [[-5, -5], [5, 5]], levels = 1 }]", "regions = []", &["refinement.regions", "1 to 50"]),
    (REFINED, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]", &["supports", "floats", "along y"]),
    (
        REFINED,
        "edges = [\"top\", \"bottom\"]",
        "edges = [\"top\", \"bottom\"]\ndirection = [1, 0]",
        &["supports", "floats", "along x"],
    ),
    (PULLED, "seed = 1\n", "", &["micro_cracks.seed", "missing"]),
    (PULLED, "seed = 1", "seed = -1", &["micro_cracks.seed", "whole number"]),
    (PULLED, "count = 5", "count = 0", &["micro_cracks.count", "above zero"]),
    (PULLED, "count = 5", "count = 5000000", &["micro_cracks.count", "beyond reason"]),
    (PULLED, "count = 5", "count = 5\nlength_min_mm = 3", &["micro_cracks.length_min_mm", "length_max_mm"]),
    (PULLED, "count = 5", "count = 5\nlength_min_mm = 100\nlength_max_mm = 101", &["micro_cracks.count", "does not fit"]),
    (PULLED, "count = 5", "count = 5\nregions = []", &["micro_cracks.regions", "empty"]),
    (
        PULLED,
        "count = 5",
        "count = 5\nregions = [{ from_mm = [50, 0], to_mm = [60, 1] }]",
        &["micro_cracks.regions[0]", "outside the plate"],
    ),
];

#[test]
fn the_good_files_are_good() {
    for text in [THROWN, PULLED, PRESSED, REFINED] {
        Scene::from_toml(text, "good", Path::new(""), &[]).unwrap();
    }
}

#[test]
fn every_broken_scene_is_refused_with_words() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.toml");
    // All of them are looked at before the verdict.
    let mut wrong = Vec::new();
    for (good, old, new, words) in BAD {
        let text = good.replacen(old, new, 1);
        assert_ne!(text, *good, "nothing was broken: {old}");
        std::fs::write(&file, &text).unwrap();
        let result = Scene::from_file(&file, &[]);
        let message = result.as_ref().err().map(Error::to_string).unwrap_or_default();
        let refused = matches!(&result, Err(Error::Input(_))) && message.starts_with(&file.display().to_string());
        let told = message.contains("; ") && words.iter().all(|word| message.contains(word));
        if words.is_empty() != result.is_ok() || !(words.is_empty() || refused && told) {
            wrong.push(format!("{new}: wants {words:?}, says {message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // The program says the same in one line, and leaves nothing.
    for (good, old, new, words) in BAD.iter().step_by(10).filter(|bad| !bad.3.is_empty()) {
        std::fs::write(&file, good.replacen(old, new, 1)).unwrap();
        for command in [&["fracture", "scene.toml", "--out", "run"][..], &["check", "scene.toml"]] {
            let output = perilife(folder.path(), command);
            if command[0] == "check" && texts(&output).1.contains("calibrat") {
                // A section of a calibration makes `check` read it as one.
                continue;
            }
            assert_eq!(output.status.code(), Some(2), "{new}");
            assert_eq!(texts(&output).1.trim_end().lines().count(), 1, "{new}: one message");
            assert!(texts(&output).1.starts_with("error: scene.toml"), "{new}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{new}: nothing but the scene stands there {words:?}");
    }
}

/// A fatigue case is no scene, and a scene no case; each is sent to the other command.
#[test]
fn cases_and_scenes_are_sent_to_their_command() {
    for text in [THROWN, PULLED, PRESSED, REFINED] {
        let error = Case::from_toml(text, "scene", Path::new(""), &[]).unwrap_err().to_string();
        assert!(error.contains("perilife fracture"), "{error}");
    }
    let bare = THROWN.replace("[damage]\nlaw = \"critical_energy\"\n", "");
    let error = Case::from_toml(&bare, "scene", Path::new(""), &[]).unwrap_err().to_string();
    assert!(error.contains("loading.kind") && error.contains("perilife fracture"), "{error}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("case.toml"), cli::SMALL_CASE).unwrap();
    let output = perilife(folder.path(), &["fracture", "case.toml", "--out", "run"]);
    cli::assert_refused(&output, 2, &["case.toml", "perilife predict"]);
}

/// Keys of all sections of a scene.
const KEYS: &[&str] = &[
    "kind",
    "width_mm",
    "diameter_mm",
    "outline_mm",
    "cracks",
    "notches",
    "poisson_ratio",
    "density_kg_m3",
    "fracture_energy_j_m2",
    "bond_law",
    "kernel",
    "spacing_mm",
    "horizon_ratio",
    "lattice_angle_deg",
    "discretisation",
    "solver",
    "zero_energy_control",
    "zero_energy_factor",
    "kinematics",
    "parts",
    "edges",
    "regions",
    "grip_mm",
    "range_mm",
    "direction",
    "transverse",
    "stress_mpa",
    "displacement_mm",
    "velocity_mm_s",
    "steps",
    "duration_s",
    "time_step_s",
    "ramp_s",
    "top",
    "pin",
    "law",
    "enters",
    "critical_stretch",
    "elastic_stretch",
    "final_ratio",
    "seed",
    "count",
    "length_min_mm",
    "length_max_mm",
    "angle_min_deg",
    "from_mm",
    "to_mm",
    "fix",
    "levels",
    "box_mm",
    "band_mm",
];

proptest! {
    /// One key of a good scene set to anything: a scene or words, never a panic.
    #[test]
    fn any_value_gives_a_scene_or_words(section in prop::sample::select(&["specimen", "material", "loading", "supports", "model", "damage", "refinement", "micro_cracks"][..]),
                                        key in prop::sample::select(KEYS), value in any_value(), which in 0..4_usize) {
        let text = [THROWN, PULLED, PRESSED, REFINED][which];
        let overrides = [format!("{section}.{key}={value}")];
        if let Err(error) = Scene::from_toml(text, "any", Path::new("/nowhere"), &overrides) {
            prop_assert!(!error.to_string().is_empty());
        }
    }

    /// Any box of a load, any micro cracks and any refinement.
    #[test]
    fn any_numbers_give_a_scene_or_words(x in prop::collection::vec(-30.0..30.0f64, 12), count in 0..40_u64, levels in 0..6_u64) {
        let loading = format!("parts = [{{ kind = \"displacement\", displacement_mm = {}, direction = [{}, {}], regions = [{{ from_mm = [{}, {}], to_mm = [{}, {}] }}] }}]\nsteps = {levels}", x[0], x[1], x[2], x[3], x[4], x[5], x[6]);
        let text = REFINED.replace("kind = \"traction\"\nstress_mpa = 5\nedges = [\"top\", \"bottom\"]", &loading)
            .replace("levels = 1", &format!("levels = {levels}"))
            .replace("[[-5, -5], [5, 5]]", &format!("[[{}, {}], [{}, {}]]", x[7], x[8], x[9], x[10]));
        let text = format!("{text}[micro_cracks]\nseed = {count}\ncount = {count}\nlength_max_mm = {}\n", x[11]);
        if let Ok(scene) = Scene::from_toml(&text, "any", Path::new(""), &[]) {
            prop_assert!(scene.specimen.cracks.len() as u64 == count && scene.drives.len() == 1);
        }
    }

    /// Any text at all.
    #[test]
    fn any_text_gives_a_scene_or_words(text in "\\PC{0,200}") {
        let _ = Scene::from_toml(&text, "any", Path::new(""), &[]);
    }
}
