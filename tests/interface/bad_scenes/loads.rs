//! Can what loads and holds the plate be done?

use super::files::{Bad, PRESSED, PULLED, REFINED, THROWN};

/// Where loads and supports act.
pub const PLACES: &[Bad] = &[
    (THROWN, "edges = [\"top\", \"bottom\"]\n", "", &["loading.edges", "missing", "regions"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = []", &["loading.edges", "empty"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\", \"top\"]", &["loading.edges[1]", "repeated"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\ngrip_mm = 11", &["loading.grip_mm", "11", "half of the plate"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\nrange_mm = [5, -5]", &["loading.range_mm", "must increase"]),
    (
        THROWN,
        "edges = [\"top\", \"bottom\"]",
        "edges = [\"top\"]\nrange_mm = [25, 30]",
        &["loading.range_mm", "outside the plate", "-20 and 20"],
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
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\nregions = []", &["loading.regions", "conflicts with edges"]),
    (THROWN, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\nparts = []", &["conflicts with parts", "move it to a part"]),
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
        &["loading.parts[0].velocity_mm_s", "no load given"],
    ),
    (PULLED, "bottom = { fix = [\"x\", \"y\"] }", "bottom = { fix = [] }", &["supports.bottom.fix", "supports nothing"]),
    (
        PULLED,
        "bottom = { fix = [\"x\", \"y\"] }",
        "below = { fix = [\"y\"] }",
        &["supports.below", "neither a side", "top, bottom"],
    ),
    (
        PULLED,
        "bottom = { fix = [\"x\", \"y\"] }",
        "top = { fix = [\"x\", \"y\"] }",
        &["two prescribed motions along y", "range_mm"],
    ),
    (
        PULLED,
        "bottom = { fix = [\"x\", \"y\"] }",
        "left = { fix = [\"x\", \"y\"] }",
        &["two prescribed motions along y", "left", "top"],
    ),
    (
        PULLED,
        "bottom = { fix = [\"x\", \"y\"] }",
        "pin = { from_mm = [30, 0], to_mm = [31, 1], fix = [\"y\"] }",
        &["supports.pin", "outside the plate"],
    ),
    (PRESSED, "displacement_mm = 0.1", "displacement_mm = -0.1", &["loading.displacement_mm", "must be above zero"]),
    (PRESSED, "steps = 10", "steps = 10\ndirection = [0, 1]", &["loading.direction", "platens"]),
    (PRESSED, "steps = 10", "steps = 10\ntransverse = \"held\"", &["loading.transverse", "platens"]),
    (PRESSED, "diameter_mm = 25.4", "diameter_mm = 25.4\nwidth_mm = 3", &["specimen.diameter_mm", "conflicts with"]),
    (REFINED, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]\ngrip_mm = 1", &["loading.grip_mm", "traction"]),
];

/// When they act.
pub const TIMES: &[Bad] = &[
    (THROWN, "duration_s = 1e-5\n", "", &["loading.kind", "velocity", "requires time", "duration_s"]),
    (THROWN, "duration_s = 1e-5", "steps = 5", &["loading.kind", "velocity", "requires time"]),
    (THROWN, "duration_s = 1e-5", "duration_s = 1e-5\nsteps = 5", &["loading.steps", "conflicts with duration_s"]),
    (THROWN, "duration_s = 1e-5", "duration_s = 1e-5\ntime_step_s = 2e-5", &["loading.time_step_s", "longer than duration_s"]),
    (THROWN, "density_kg_m3 = 2235\n", "", &["material.density_kg_m3", "missing", "required for motion"]),
    (
        THROWN,
        "kind = \"velocity\"\nvelocity_mm_s = 100",
        "kind = \"displacement\"\ndisplacement_mm = 1",
        &["loading.ramp_s", "missing", "infinite velocity"],
    ),
    (PULLED, "steps = 10", "steps = 10\nramp_s = 1", &["loading.ramp_s", "requires duration_s"]),
    (PULLED, "steps = 10", "time_step_s = 1", &["loading.time_step_s", "requires duration_s"]),
    (PULLED, "steps = 10", "steps = 10\nfrom_s = 1", &[":19:", "loading.from_s", "requires duration_s"]),
    (
        PULLED,
        "kind = \"displacement\"\ndisplacement_mm = 0.1\nedges = [\"top\"]",
        "parts = [{ kind = \"displacement\", displacement_mm = 0.1, edges = [\"top\"], ramp_s = 1 }]",
        &["loading.parts[0].ramp_s", "requires duration_s"],
    ),
    (
        THROWN,
        "duration_s = 1e-5",
        "duration_s = 1e-5\nfrom_s = 1e-5",
        &["loading.from_s", "0.00001", "before the end of the scene", "duration_s"],
    ),
    (
        THROWN,
        "kind = \"velocity\"\nvelocity_mm_s = 100\nedges = [\"top\", \"bottom\"]",
        "ramp_s = 1e-6\nparts = [{ kind = \"displacement\", displacement_mm = 1, edges = [\"top\"], ramp_s = 0 }]",
        &["loading.parts[0].ramp_s", "missing", "infinite velocity"],
    ),
    (
        THROWN,
        "kind = \"velocity\"\nvelocity_mm_s = 100\nedges = [\"top\", \"bottom\"]",
        "parts = [{ kind = \"velocity\", velocity_mm_s = 1, edges = [\"top\"], ramp_s = 1e-6 }, { kind = \"velocity\", velocity_mm_s = 1, edges = [\"top\"] }]",
        &["two prescribed motions along y", "top"],
    ),
];
