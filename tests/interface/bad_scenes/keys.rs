//! Are keys, sections and types those that a scene has?

use super::files::{Bad, THROWN};

/// Unknown, missing and misplaced keys.
pub const KEYS: &[Bad] = &[
    (THROWN, "width_mm = 40", "widht_mm = 40", &[":3:", "specimen.widht_mm", "not a known key", "did you mean width_mm?"]),
    (
        THROWN,
        "velocity_mm_s = 100",
        "velocity = 100",
        &[":16:", "loading.velocity", "not a known key", "did you mean velocity_mm_s or velocity_in_s?"],
    ),
    (THROWN, "velocity_mm_s = 100", "stress_max_mpa = 100", &["loading.stress_max_mpa", "cycles", "perilife predict"]),
    (THROWN, "velocity_mm_s = 100\n", "", &["loading.velocity_mm_s", "missing"]),
    (THROWN, "velocity_mm_s = 100", "velocity_mm_s = 0", &["loading.velocity_mm_s", "loads nothing", "[supports]"]),
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
    (THROWN, "[damage]", "[demage]", &[":19:", "demage", "not a known section", "did you mean [damage]?"]),
    (THROWN, "[specimen]", "colour = 3\n[specimen]", &[":1:", "colour", "no section"]),
    (THROWN, "[damage]\nlaw = \"critical_energy\"", "damage = 3", &["loading.damage", "not a known key"]),
    (THROWN, "law = \"critical_energy\"", "law = \"brittle\"", &[":20:", "damage.law", "brittle", "critical_stretch"]),
    (THROWN, "law = \"critical_energy\"", "strength = 3", &["damage.strength", "not a known key", "critical_stretch"]),
    (THROWN, "spacing_mm = 1", "method = \"peridynamics\"", &["model.method", "not a known key", "bond_law"]),
];
