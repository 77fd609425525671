//! Fracture scenes against what their sources report: one asserted outcome each.

use std::path::Path;

use perilife_growth::predict::Silent;
use perilife_scenes::fronts::CRACKED;
use perilife_scenes::outcome::PathPoint;
use perilife_scenes::{Fracture, Scene};

/// Runs a scene of `data/cases/fracture`.
pub fn run(name: &str, overrides: &[&str]) -> Fracture {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cases/fracture").join(format!("{name}.toml"));
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    let scene = Scene::from_file(&file, &overrides).unwrap_or_else(|error| panic!("{name}: {error}"));
    perilife_scenes::run(&scene, &Silent).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Places of an initial tip's front, in mm.
pub fn way(run: &Fracture, tip: usize) -> Vec<[f64; 2]> {
    let of_tip = |point: &&PathPoint| point.tip == tip;
    run.path.iter().filter(of_tip).map(|point| point.position.map(|x| 1e3 * x)).collect()
}

/// Mean distance from the middle line of the four tips of two parallel cracks where they are a length from the middle, mm.
fn spread(run: &Fracture, x: f64) -> f64 {
    let at = |tip: usize| {
        let way = way(run, tip);
        way.iter().find(|place| place[0].abs() >= x).unwrap_or_else(|| panic!("tip {tip} stops short of {x} mm: {way:?}"))[1]
    };
    let initial = |tip: usize| way(run, tip)[0][1].signum();
    (0..4).map(|tip| at(tip) * initial(tip)).sum::<f64>() / 4.0
}

/// Heights of the points in the column x that are cracked at the end, mm, from below.
fn cracked_rows(run: &Fracture, x: f64) -> Vec<f64> {
    perilife_study::moving::cracked_rows(run, 1e-3 * x).into_iter().map(|y| 1e3 * y).collect()
}

/// Two cracks at a distance in mm, which end farther apart than they began.
fn parallel_cracks(d: f64) -> Fracture {
    let run = run(&format!("parallel_cracks_{d}mm"), &[]);
    let end = spread(&run, 18.0);
    assert!(end > d / 2.0 + 1.0, "d = {d}: {end} mm from the middle line at the end");
    assert!(run.separated_step.is_some(), "d = {d}: the plate is not in two");
    run
}

#[test]
fn parallel_cracks_turn_away_from_each_other() {
    parallel_cracks(5.0);
}

/// Two parallel cracks, one-bond two-parameter law: the upper turns up and the lower down; with growing distance the onset is
/// earlier and the cracks are farther apart in the end (Huang et al., table 5 and figure 12). With the bond-based law, cracks 3 mm
/// apart run straight and meet on the middle line (their figure 13).
///
/// The source also reports a shorter straight run and a later break-through with growing distance. Here the straight run is longer
/// (at a spacing of 0.25 mm the cracks have left their lines by 0.6 mm at x = 7, 6 and 10 mm for 3, 5 and 7 mm) and the break-through 3 %
/// earlier. Both are what stacked cracks do in linear
/// fracture mechanics, K_I growing and K_II falling with their distance. The source prints no fracture energy for this plate, and the
/// order of onsets depends on it: at 83 kJ/m² (critical stretch 0.020) they fall within 1 % of each other.
#[test]
#[ignore = "long: ten seconds"]
fn parallel_cracks_of_all_distances_turn_away_from_each_other() {
    let runs = [3.0, 5.0, 7.0].map(|d| (d, parallel_cracks(d)));
    let [onset_3, onset_5, onset_7] = runs.each_ref().map(|(_, run)| run.onset_step.unwrap());
    assert!(onset_7 < onset_5 && onset_5 <= onset_3, "onset in steps {onset_3}, {onset_5}, {onset_7}");
    let [end_3, _, end_7] = runs.each_ref().map(|(_, run)| spread(run, 18.0));
    assert!(end_7 > end_3, "7 mm: {end_7} mm from the middle line at the end, 3 mm: {end_3}");
    let bond_based = run("parallel_cracks_3mm_bond_based", &[]);
    assert!(spread(&bond_based, 10.0) < 1.5 + 0.5, "bond-based: straight at first");
    let rows = cracked_rows(&bond_based, 22.0);
    assert!(!rows.is_empty() && rows.iter().all(|y| y.abs() < 1.5), "bond-based: one crack on the middle line, not {rows:?} mm");
}

/// Brittle cracks leave the notch roots of an impacted plate at 65 to 70° (Kalthoff and Winkler 1987: about 70°; Silling
/// 2003: 68°), mirror images of each other.
#[test]
fn impacted_plate_cracks_at_seventy_degrees() {
    let run = run("kalthoff_winkler", &[]);
    let (upper, lower) = (way(&run, 0), way(&run, 1));
    let (from, to) = (upper[0], *upper.last().unwrap());
    let angle = ((to[1] - from[1]).abs()).atan2(to[0] - from[0]).to_degrees();
    assert!((65.0..70.0).contains(&angle), "{angle:.1}°, from {from:?} to {to:?}");
    let mirrored = *lower.last().unwrap();
    assert!((to[0] - mirrored[0]).abs() < 3.1 && (to[1] + mirrored[1]).abs() < 3.1, "{to:?} and {mirrored:?}");
}

/// A crack in glass under sudden tension branches once, symmetrically, and runs slower than Rayleigh waves (Ha and Bobaru 2010).
#[test]
fn crack_in_glass_branches() {
    let run = run("branching", &["model.spacing_mm=0.5"]);
    let cracked = cracked_rows(&run, 40.0);
    let (above, below): (Vec<f64>, Vec<f64>) = cracked.iter().partition(|y| **y > 0.0);
    assert!(!above.is_empty() && above.len() == below.len(), "cracked rows {cracked:?}");
    assert!(cracked.iter().all(|y| y.abs() > 2.0), "two branches, nothing between them: {cracked:?}");
    for (up, down) in above.iter().zip(below.iter().rev()) {
        assert!((up + down).abs() < 1e-6, "rows {up} and {down} mm");
    }
    // Rayleigh speed ≈ (0.862 + 1.14 ν)/(1 + ν) times that of shear waves (Viktorov 1967).
    let (e, nu, rho): (f64, f64, f64) = (65e9, 0.2, 2235.0);
    let rayleigh = (0.862 + 1.14 * nu) / (1.0 + nu) * (e / (2.0 * (1.0 + nu) * rho)).sqrt();
    let tip: Vec<&PathPoint> = run.path.iter().filter(|point| point.tip == 0).collect();
    // Over 10 mm, a quarter of the plate's height: fronts are looked at a few hundred times a run, and jump.
    for (i, from) in tip.iter().enumerate().skip(1) {
        let way = |to: &PathPoint| (to.position[0] - from.position[0]).hypot(to.position[1] - from.position[1]);
        let Some(to) = tip[i..].iter().find(|to| way(to) >= 10e-3) else { break };
        let speed = way(to) / (to.time - from.time);
        assert!(speed < rayleigh, "{speed:.0} m/s at {:.2e} s; Rayleigh {rayleigh:.0}", from.time);
    }
}

/// Micro cracks around one of two main cracks keep the other from growing (Huang et al., figure 14).
#[test]
#[ignore = "long: three dynamic runs"]
fn micro_cracks_suppress_the_other_crack() {
    for (name, quiet) in [("micro_cracks_upper", [2, 3]), ("micro_cracks_lower", [0, 1])] {
        let run = run(name, &[]);
        for tip in quiet {
            let way = way(&run, tip);
            let grown = (way.last().unwrap()[0] - way[0][0]).abs();
            assert!(grown < 2.0, "{name}: tip {tip} of the other crack grew {grown} mm");
        }
        assert!(run.separated_step.is_some(), "{name}");
    }
    // At one end alone: there the other crack stops, at the far end the main crack wins too.
    let run = run("micro_cracks_one_end", &[]);
    let grown = |tip: usize| (way(&run, tip).last().unwrap()[0] - way(&run, tip)[0][0]).abs();
    assert!(grown(3) < 4.0, "right end of the other crack grew {} mm", grown(3));
}

/// A central crack tears a plate by about 24 µs, with one law as with the other at a Poisson's ratio of 1/3 (Huang et al.,
/// example 3, table 4 and figure 8).
#[test]
#[ignore = "long: two dynamic runs of 41 200 points"]
fn central_crack_is_through_by_24_microseconds() {
    for name in ["central_crack_bond_based", "central_crack_two_parameter"] {
        let run = run(name, &[]);
        let separated = run.separated_step.unwrap_or(usize::MAX) as f64 * run.figures.time_step;
        assert!(separated < 26e-6, "{name}: separated at {separated:.2e} s");
        for tip in 0..2 {
            assert!(way(&run, tip).iter().all(|place| place[1].abs() < 1.0), "{name}: tip {tip} leaves its line");
        }
    }
}

/// Points of 4 mm (Huang et al., example 4): the plate parts in one straight band from notch to notch. The tests bend two cracks away from
/// the ligament (Nooru-Mohamed 1992); here they stay within a horizon of it, too near to be seen as bent.
#[test]
fn mixed_mode_on_coarse_points_is_one_straight_band() {
    let run = run("mixed_mode_one_bond", &[]);
    let separated = run.separated_step.expect("the plate is in two");
    let (grid, last, horizon) = (&run.grid, run.snapshots.last().unwrap(), 3.015 * 4.0);
    let cracked: Vec<[f64; 2]> = (0..grid.point_at.len())
        .filter(|&place| grid.point_at[place].is_some_and(|p| last.damage[p as usize] >= CRACKED))
        .map(|place| [place % grid.columns, place / grid.columns])
        .map(|[column, row]| [(column, 0), (row, 1)].map(|(i, axis)| 1e3 * (grid.origin[axis] + i as f64 * grid.spacing)))
        .collect();
    let highest = cracked.iter().fold(0.0, |m: f64, p| m.max(p[1].abs()));
    println!("{} points, {highest} mm high, peak {:.2} kN, in two at step {separated}", cracked.len(), run.peak_load() / 1e3);
    assert!(highest < horizon, "{highest} mm");
    // Every column of the ligament is cracked, and as high to the left as it is deep to the right.
    for x in [-70.0, -50.0, -30.0, -10.0, 10.0, 30.0, 50.0, 70.0] {
        let (rows, turned) = (cracked_rows(&run, x), cracked_rows(&run, -x));
        assert!(!rows.is_empty(), "nothing is cracked at x = {x} mm");
        assert!(rows.iter().zip(turned.iter().rev()).all(|(a, b)| (a + b).abs() < 1e-6), "{rows:?} at {x} mm, {turned:?}");
    }
}
