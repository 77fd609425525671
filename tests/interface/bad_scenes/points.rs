//! Can there be points and micro cracks where they are asked for?

use super::files::{Bad, PULLED, REFINED};

/// Refinement and micro cracks.
pub const POINTS: &[Bad] = &[
    (REFINED, "discretisation = \"dual_horizon\"\n", "", &["model.discretisation", "[refinement]", "dual_horizon"]),
    (REFINED, "[[-5, -5], [5, 5]]", "[[25, -5], [30, 5]]", &["refinement.regions[0].box_mm", "outside the plate", "(-20, -10)"]),
    (REFINED, "[[-5, -5], [5, 5]]", "[[5, -5], [5, 5]]", &["refinement.regions[0].box_mm", "no area"]),
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
        &["refinement.regions[0].around_flaws_mm", "no crack or notch"],
    ),
    (REFINED, "regions = [{ box_mm = [[-5, -5], [5, 5]], levels = 1 }]", "regions = []", &["refinement.regions", "1 to 50"]),
    (REFINED, "edges = [\"top\", \"bottom\"]", "edges = [\"top\"]", &["supports", "not in equilibrium", "along y"]),
    (
        REFINED,
        "edges = [\"top\", \"bottom\"]",
        "edges = [\"top\", \"bottom\"]\ndirection = [1, 0]",
        &["supports", "not in equilibrium", "along x"],
    ),
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
