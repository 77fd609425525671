//! Bodies of points: what loads, holds and cuts them, and where micro cracks lie.

use std::path::Path;

use perilife_growth::case::Case;
use perilife_plate::specimen::geometry::{distance, distance_to_polygon, distance_to_segment};
use perilife_plate::specimen::{Crack, Specimen};
use perilife_points::body::Body;
use perilife_points::body::obstacles::Obstacles;
use perilife_scenes::Scene;
use perilife_scenes::read::micro_cracks::SplitMix64;

// Loads and supports on the points of a body.

/// A plate held at the bottom, with a horizontal crack at a height (mm) that decides where the rows of points lie.
fn body(height: f64, correction: &str) -> Body {
    let text = format!(
        "[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 120\nthickness_mm = 2\n\
         cracks = [{{ from_mm = [-15, {height}], to_mm = [5, {height}] }}]\n[material]\nname = \"al2024-t3\"\n\
         [loading]\nstress_max_mpa = 10\nstress_ratio = 0\n[supports]\nbottom = {{ fix = [\"x\", \"y\"] }}\n\
         [model]\nspacing_mm = 2\nsurface_correction = \"{correction}\"\n[fatigue]\na = 1\np = 2\nhorizon_mm = 1"
    );
    built(&text)
}

fn built(text: &str) -> Body {
    let case = Case::from_toml(text, "plate", Path::new(""), &[]).unwrap();
    let model = case.points();
    Body::build(&case.specimen, &case.material, &model.bond_law, model.spacing, model.horizon_ratio, 0.0).unwrap()
}

/// With rows anywhere against the edge a support holds exactly the nearest one, and the whole load comes in.
#[test]
fn a_support_holds_one_row_wherever_the_rows_lie() {
    for i in 0..16 {
        let height = -57.0 + 0.25 * f64::from(i);
        let body = body(height, "volume_and_surface");
        let mut rows: Vec<usize> =
            body.boundary.fixed.iter().map(|(place, _)| body.lattice.column_row(*place as usize).1).collect();
        let held = rows.len();
        rows.dedup();
        assert_eq!((held, rows.len()), (30, 1), "crack at y = {height} mm");
        let force: f64 = body.boundary.forces.iter().map(|(_, force)| force[1]).sum();
        assert!((force - 0.06 * 0.002).abs() < 1e-12, "crack at y = {height} mm: {force}");
    }
}

/// Resultant, moment and work on uniform strain are those of the traction on the edge itself, wherever the rows lie against it.
#[test]
fn the_balanced_correction_loads_the_true_edge() {
    for i in 0..16 {
        let height = -57.0 + 0.25 * f64::from(i);
        let body = body(height, "balanced");
        let sum = |of: &dyn Fn([f64; 2], [f64; 2]) -> f64| -> f64 {
            body.boundary.forces.iter().map(|&(place, force)| of(body.lattice.position(place as usize), force)).sum()
        };
        let force = 0.06 * 0.002;
        for (what, computed, exact) in [
            ("force", sum(&|_, f| f[1]), force),
            ("side force", sum(&|_, f| f[0]), 0.0),
            ("work along y", sum(&|x, f| x[1] * f[1]), force * 0.06),
            ("moment", sum(&|x, f| x[0] * f[1] - x[1] * f[0]), 0.0),
        ] {
            assert!((computed - exact).abs() < 1e-12 * force, "crack at y = {height} mm, {what}: {computed:e} against {exact:e}");
        }
    }
}

/// Bonds stay positive and bounded, and those with all neighbours about them keep the multiplier of the infinite lattice.
#[test]
fn the_balanced_correction_changes_bonds_near_the_rim_only() {
    let body = body(0.0, "balanced");
    let depth = body.stencil.reach + 1;
    for (bond, &multiplier) in body.multiplier.iter().enumerate().filter(|(_, m)| **m > 0.0) {
        assert!((0.2..=5.0).contains(&multiplier), "{multiplier}");
        let (_, from, to) = body.ends(bond as u32);
        let inside = [from, to].iter().all(|&place| {
            let (column, row) = body.lattice.column_row(place);
            let within = |i: usize, count: usize| i >= depth && i + depth < count;
            within(column, body.lattice.columns) && within(row, body.lattice.rows)
        });
        assert!(!inside || multiplier == 1.0, "{multiplier}");
    }
}

/// Whatever the arc over which a pin touches its hole, its whole force arrives, along its direction, and the narrower the arc
/// the farther from the plate's middle it pushes.
#[test]
fn a_pin_brings_its_force_over_any_arc() {
    let mut reach = Vec::new();
    for half_angle in [15.0, 45.0, 90.0] {
        let text = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 120\nthickness_mm = 2\n\
             holes = [{{ x_mm = 0, y_mm = 30, diameter_mm = 20 }}, {{ x_mm = 0, y_mm = -30, diameter_mm = 20 }}]\n\
             cracks = [{{ from_mm = [-30, 0], to_mm = [-15, 0] }}]\n[material]\nname = \"al2024-t3\"\n[loading]\nforce_max_n = 100\n\
             stress_ratio = 0\npins = [{{ hole = 0, direction = [0, 1], contact_half_angle_deg = {half_angle} }}, \
             {{ hole = 1, direction = [0, -1], contact_half_angle_deg = {half_angle} }}]\n\
             [model]\nspacing_mm = 1\n[fatigue]\na = 1\np = 2\nhorizon_mm = 1"
        );
        let body = built(&text);
        let upper = |of: &dyn Fn([f64; 2], [f64; 2]) -> f64| -> f64 {
            let forces = body.boundary.forces.iter().map(|&(place, force)| (body.lattice.position(place as usize), force));
            forces.filter(|(at, _)| at[1] > 0.0).map(|(at, force)| of(at, force)).sum()
        };
        let (across, along, moment) = (upper(&|_, f| f[0]), upper(&|_, f| f[1]), upper(&|x, f| x[0] * f[1] - x[1] * f[0]));
        assert!(across.abs() < 1e-9 && (along - 1.0).abs() < 1e-3 && moment.abs() < 1e-9, "{half_angle}°: {across} {along}");
        reach.push(upper(&|x, f| x[1] * f[1]));
    }
    assert!(reach[0] > reach[1] && reach[1] > reach[2], "{reach:?}");
    // The middle of a narrow arc lies at the rim, 40 mm up; of a cosine over half the circle at 30 + 10 · 8/3π mm.
    assert!((reach[0] - 0.04).abs() < 1e-3 && (reach[2] - 0.0385).abs() < 1e-3, "{reach:?}");
}

// Which bonds slots, holes and notches of the outline cut, and which only graze.

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

// Micro cracks of a scene: the same for the same seed, and where they may lie.

const TEXT: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 40\nlength_mm = 40\nthickness_mm = 2\nholes = [{ x_mm = 10, y_mm = 10, diameter_mm = 6 }]\n\
    cracks = [{ from_mm = [-20, 0], to_mm = [0, 0] }]\n[material]\nyoungs_modulus_gpa = 65\npoisson_ratio = 0.2\n\
    [model]\nspacing_mm = 0.5\n[loading]\nkind = \"displacement\"\ndisplacement_mm = 0.1\nedges = [\"top\", \"bottom\"]\ngrip_mm = 2\nsteps = 5\n\
    [micro_cracks]\nseed = 7\ncount = 200\n";

fn cracks(overrides: &[&str]) -> Vec<Crack> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let scene = Scene::from_toml(TEXT, "scene", Path::new(""), &overrides).unwrap();
    assert_eq!(scene.specimen.tips.len(), 1, "micro cracks have no tips");
    scene.specimen.cracks[1..].to_vec()
}

#[test]
fn the_same_seed_gives_the_same_cracks() {
    let first = cracks(&[]);
    assert_eq!(first.len(), 200);
    assert_eq!(first, cracks(&[]));
    assert_ne!(first, cracks(&["micro_cracks.seed=8"]));
}

#[test]
fn they_keep_off_edges_holes_cracks_and_grips() {
    let specimen = Scene::from_toml(TEXT, "scene", Path::new(""), &[]).unwrap().specimen;
    let (spacing, horizon) = (0.5e-3, 3.015 * 0.5e-3);
    for Crack { from, to, .. } in cracks(&[]) {
        for end in [from, to] {
            assert!(specimen.contains(end) && distance_to_polygon(end, &specimen.outline) > spacing);
            assert!(end[1].abs() < 20e-3 - 2e-3 - horizon, "{end:?}");
            assert!(distance_to_segment(end, specimen.cracks[0].from, specimen.cracks[0].to) > spacing);
        }
        assert!(distance_to_segment(specimen.holes[0].centre, from, to) > 3e-3 + spacing);
    }
}

#[test]
fn length_angle_and_place_are_those_asked_for() {
    let length = |crack: &Crack| distance(crack.from, crack.to);
    let all = cracks(&[]);
    assert!(all.iter().all(|crack| length(crack) <= 2e-3));
    // Uniform from 0 to 2 mm: mean 1 mm with a standard error of 0.04 mm, a little less where long ones fit less often.
    let mean = all.iter().map(length).sum::<f64>() / all.len() as f64;
    assert!((0.8e-3..1.15e-3).contains(&mean), "{mean}");
    let set = [
        "micro_cracks.length_min_mm=1",
        "micro_cracks.length_max_mm=1.5",
        "micro_cracks.angle_min_deg=30",
        "micro_cracks.angle_max_deg=40",
        "micro_cracks.regions=[{ from_mm = [-15, 5], to_mm = [0, 12] }]",
    ];
    for crack in cracks(&set) {
        let Crack { from, to, .. } = crack;
        assert!((1e-3..1.5e-3).contains(&length(&crack)));
        let angle = (to[1] - from[1]).atan2(to[0] - from[0]).to_degrees();
        assert!((30.0 - 1e-9..40.0 + 1e-9).contains(&angle), "{angle}");
        let middle = [0, 1].map(|i| 0.5 * (from[i] + to[i]));
        assert!((-15e-3..0.0).contains(&middle[0]) && (5e-3..12e-3).contains(&middle[1]));
    }
}

/// First outputs for seed 1234567 as in the Rosetta Code task "Pseudo-random numbers/Splitmix64".
#[test]
fn generator_gives_the_published_numbers() {
    let mut random = SplitMix64(1_234_567);
    let published = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
    assert_eq!([random.next(), random.next(), random.next()], published);
}
