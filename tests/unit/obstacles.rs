//! Which bonds slots, holes and notches of the outline cut, and which only graze.

use std::path::Path;

use perilife_growth::case::Case;
use perilife_plate::specimen::Specimen;
use perilife_points::body::obstacles::Obstacles;

/// Spacing and horizon of the lattice that asks, mm.
const SPACING: f64 = 1.0;
const HORIZON: f64 = 3.015;

fn plate(keys: &str) -> Specimen {
    let text = format!(
        "[specimen]\nkind = \"plate\"\nthickness_mm = 2\n{keys}\n[material]\nname = \"al2024-t3\"\n\
         [loading]\nstress_max_mpa = 10\nstress_ratio = 0\n[supports]\nbottom = {{ fix = [\"x\", \"y\"] }}\n[model]\nspacing_mm = 1\n[fatigue]\na = 1\np = 2\nhorizon_mm = 1"
    );
    Case::from_toml(&text, "test", Path::new(""), &[]).unwrap().specimen
}

/// Asserts for every bond (x, y, x, y in mm) whether it is cut, from both of its ends.
fn assert_cuts(specimen: &Specimen, rows: &[([f64; 4], bool, &str)]) {
    let obstacles = Obstacles::of(specimen, SPACING * 1e-3, HORIZON * 1e-3);
    for (bond, cut, why) in rows {
        let [a, b] = [[bond[0] * 1e-3, bond[1] * 1e-3], [bond[2] * 1e-3, bond[3] * 1e-3]];
        assert!(specimen.contains(a) && specimen.contains(b), "{why}: both ends are material");
        assert_eq!(obstacles.block(a, b), *cut, "{why}: {bond:?}");
        assert_eq!(obstacles.block(b, a), *cut, "{why}, from the other end: {bond:?}");
        // Bonds far from everything are never tested, so a bond that is cut must be near.
        assert!(!cut || (obstacles.near(a) && obstacles.near(b)), "{why}");
    }
    assert!(!obstacles.near([-0.02, -0.08]), "far from everything");
}

#[test]
fn holes_and_slots() {
    let keys = "width_mm = 100\nlength_mm = 200\nholes = [{ x_mm = 20, y_mm = 30, diameter_mm = 10 }]\n\
                cracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]\n\
                notches = [{ from_mm = [-50, 50], to_mm = [-30, 50], width_mm = 1.6 },\n\
                           { from_mm = [0, -50], to_mm = [10, -50], width_mm = 0.1 }]";
    assert_cuts(
        &plate(keys),
        &[
            ([0.0, -0.5, 0.0, 0.5], false, "the crack is cut apart from obstacles"),
            ([20.0, 24.5, 22.0, 24.5], false, "below the hole"),
            ([19.0, 25.0 - 0.2, 21.0, 25.0 - 0.2], false, "outside the rim"),
            ([18.9, 25.1 - 0.25, 21.1, 25.1 - 0.25], false, "grazes the rim by 0.15 spacings"),
            ([18.0, 25.4, 22.0, 25.4], true, "through the rim at 0.4 spacings"),
            ([-40.0, 49.0, -40.0, 51.0], true, "over the slot"),
            ([-30.5, 49.0, -29.5, 51.0], true, "around the end of the slot, near its face"),
            ([-29.5, 49.5, -29.5, 50.5], false, "ahead of the slot"),
            ([-30.1, 49.1, -29.5, 50.0], false, "over a corner of the slot, less than a quarter spacing deep"),
            ([5.0, -50.5, 5.0, -49.5], true, "over a slot thinner than the spacing"),
            ([10.5, -50.5, 10.5, -49.5], false, "ahead of it"),
        ],
    );
}

#[test]
fn notches_of_the_outline() {
    // A step (inner corner at 0, 0) and a V-notch of 0.1 mm that opens to the right, tip at (30, -40).
    let keys = "outline_mm = [[-50, -100], [50, -100], [50, -40.05], [30, -40], [50, -39.95], [50, 0], [0, 0], [0, 100], [-50, 100]]\n\
                cracks = [{ from_mm = [-50, -20], to_mm = [-40, -20] }]";
    assert_cuts(
        &plate(keys),
        &[
            ([-0.5, 1.5, 1.5, -0.5], true, "over the inner corner"),
            ([-0.5, 0.5, -0.5, -0.5], false, "inside, past the corner"),
            ([-1.5, 0.5, 0.5, -0.5], false, "inside, below the corner"),
            ([40.0, -41.0, 40.0, -39.0], true, "over the thin notch"),
            ([29.5, -41.0, 29.5, -39.0], false, "ahead of its tip"),
        ],
    );
    // Rows exactly on the outline keep their bonds along it and into the material.
    let specimen = plate(keys);
    let obstacles = Obstacles::of(&specimen, SPACING * 1e-3, HORIZON * 1e-3);
    for x in 5..40 {
        let at = |x: i32, y: f64| [f64::from(x) * 1e-3, y];
        assert!(!obstacles.block(at(x, 0.0), at(x + 1, 0.0)), "along the step at {x} mm");
        assert!(!obstacles.block(at(x, 0.0), at(x + 1, -2e-3)), "into the material at {x} mm");
    }
    assert!(obstacles.block([2e-3, 0.0], [0.0, 2e-3]), "from one side of the step to the other");
}
