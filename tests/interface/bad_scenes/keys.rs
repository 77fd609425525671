//! Are keys, sections and types those that a scene has?

use super::files::{Bad, THROWN};

/// Unknown, missing and misplaced keys.
pub const KEYS: &[Bad] = &[
    (
        THROWN,
        "velocity_mm_s = 100",
        "velocity = 100",
        &[":16:", "loading.velocity", "unknown key", "did you mean velocity_mm_s or velocity_in_s?"],
    ),
    (THROWN, "velocity_mm_s = 100", "stress_max_mpa = 100", &["loading.stress_max_mpa", "cycles", "perilife predict"]),
    (THROWN, "velocity_mm_s = 100", "velocity_mm_s = 0", &["loading.velocity_mm_s", "applies no load", "[supports]"]),
    (
        THROWN,
        "velocity_mm_s = 100",
        "velocity_mm_s = 1\nstress_mpa = 1",
        &["loading.stress_mpa", "cannot be combined with", "velocity"],
    ),
    (THROWN, "[damage]", "[fatigue]\na = 1\n[damage]", &["fatigue", "applies only to fatigue cases", "perilife predict"]),
    (THROWN, "[damage]", "[stop]\ncycles_max = 1\n[damage]", &["stop", "perilife predict"]),
    (THROWN, "[damage]", "[fit]\nparameters = []\n[damage]", &["fit", "perilife calibrate"]),
    (THROWN, "[specimen]", "colour = 3\n[specimen]", &[":1:", "colour", "outside any section"]),
    (THROWN, "[damage]\nlaw = \"critical_energy\"", "damage = 3", &["loading.damage", "unknown key"]),
];
