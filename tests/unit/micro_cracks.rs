//! Micro cracks of a scene: the same for the same seed, and where they may lie.

use std::path::Path;

use perilife_plate::specimen::Crack;
use perilife_plate::specimen::geometry::{distance, distance_to_polygon, distance_to_segment};
use perilife_scenes::Scene;
use perilife_scenes::read::micro_cracks::SplitMix64;

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
