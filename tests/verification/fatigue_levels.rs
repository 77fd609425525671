//! Fatigue on points of several levels against points that are fine everywhere.

use nalgebra::{DMatrix, DVector};
use perilife::case::Case;
use perilife::fatigue::ageing::stretch;
use perilife::growth::plate::Plate;
use perilife::levels::PointGrid;
use perilife::predict::{Prediction, Silent, Snapshot, StopReason, predict};
use perilife::solver::field::Layout;
use perilife::specimen::Point;
use perilife::specimen::geometry::{distance, distance_to_segment};
use perilife::state::Bonds;
use perilife::stress_intensity::CrackedPlate;

use crate::support::plates::try_case;

const PANEL: &str = "kind=\"middle_tension\"\nwidth_mm=96\nlength_mm=160\nthickness_mm=2\ncrack_length_mm=12\n";
const SLANT: &str = "kind=\"plate\"\nwidth_mm=64\nlength_mm=128\nthickness_mm=2\ncracks=[{from_mm=[-7,-5],to_mm=[7,5]}]\n";
const DUAL: &str = "model.discretisation=dual_horizon";

/// A case whose bonds age by their strain as computed, so that it shows what levels do to that; with the surface correction that both
/// kinds of plates know, unless it has another.
fn case(specimen: &str, set: &[&str]) -> Case {
    let given = |key: &&&str| set.iter().any(|other| other.split('=').next() == key.split('=').next());
    let usual = ["model.surface_correction=volume_and_surface", "fatigue.growth_rate=bond_strain"];
    let more: Vec<&str> = usual.iter().filter(|key| !given(key)).copied().collect();
    crate::support::plates::case(specimen, &[set, &more].concat())
}

/// Keys of a coarsest spacing, a region with levels, and more.
fn levels<'a>(spacing: &'a str, region: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&[DUAL, spacing, region], more].concat()
}

fn run(case: &Case) -> Prediction {
    predict(case, &Silent).unwrap()
}

/// Coarsest spacing and region of two levels, and of three, both with 1 mm around the way of the crack of [`PANEL`].
const TWO: [&str; 2] = ["model.spacing_mm=2", "refinement.regions=[{band_mm=[[-44,0],[44,0]],width_mm=24,levels=1}]"];
const THREE: [&str; 2] = ["model.spacing_mm=4", "refinement.regions=[{band_mm=[[-44,0],[44,0]],width_mm=24,levels=2}]"];

#[test]
fn refined_panels_live_as_long_as_the_fine_one() {
    let stop = "stop.crack_length_mm=28";
    let fine = run(&case(PANEL, &["model.spacing_mm=1", stop]));
    for (name, [spacing, region]) in [("two levels", TWO), ("three levels", THREE)] {
        for correction in ["model.surface_correction=volume_and_surface", "model.surface_correction=balanced"] {
            let fine = if correction.ends_with("balanced") {
                &run(&case(PANEL, &["model.spacing_mm=1", stop, correction]))
            } else {
                &fine
            };
            let refined = run(&case(PANEL, &levels(spacing, region, &[stop, correction])));
            let ratio = refined.life_cycles() / fine.life_cycles();
            let points = [&refined, fine].map(|run| run.figures.points);
            println!("{name}, {correction}: life {ratio:.5} of the fine panel's, {points:?} points");
            assert!((ratio - 1.0).abs() < 0.01, "{name}, {correction}: {ratio}");
            assert!(2 * points[0] < points[1], "{name}: {points:?}");
            assert_eq!((refined.stop, refined.figures.spacing), (StopReason::CrackLengthReached, fine.figures.spacing));
        }
    }
}

/// The same at the rate of K, where the fine points leave room for the ring on which it is read.
#[test]
fn refined_panels_live_as_long_by_their_factors() {
    let set = ["stop.crack_length_mm=28", "fatigue.growth_rate=stress_intensity"];
    let fine = run(&case(PANEL, &[&["model.spacing_mm=1"], &set[..]].concat()));
    let wide = "refinement.regions=[{band_mm=[[-44,0],[44,0]],width_mm=36,levels=1}]";
    let refined = run(&case(PANEL, &levels("model.spacing_mm=2", wide, &set)));
    let ratio = refined.life_cycles() / fine.life_cycles();
    println!("life {ratio:.5}, {} and {} points", refined.figures.points, fine.figures.points);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

/// Stretches of the bonds around the right tip of [`PANEL`] by the places of their ends.
fn tip_stretches(case: &Case) -> Vec<([i64; 4], f64)> {
    let plate = Plate::build(&case.specimen, &case.specimen, &case.material, &case.model).unwrap();
    let body = &plate.body;
    let bonds = Bonds::new(body);
    let mut displacement = Vec::new();
    let mut equilibrium = plate.equilibrium(&case.model, &bonds, case.loading.maximum);
    equilibrium.solve(body, &bonds, &mut displacement).unwrap();
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let tip = case.specimen.tips.iter().map(|tip| tip.position).max_by(|a, b| a[0].total_cmp(&b[0])).unwrap();
    let key = |place: usize| body.lattice.position(place).map(|x| (x * 1e6).round() as i64);
    let mut found: Vec<_> = (0..body.multiplier.len() as u32)
        .filter(|&bond| bonds.is_intact(bond) && distance(body.middle(bond), tip) < 0.5 * body.horizon())
        .map(|bond| {
            let (_, from, to) = body.ends(bond);
            let ([a, b], [c, d]) = (key(from), key(to));
            ([a, b, c, d], stretch(body, &layout, &displacement, bond))
        })
        .collect();
    found.sort_by_key(|bond| bond.0);
    found
}

/// Strains around the tip are within half a percent of the largest there. The work of the loads is not: it is done on the way of
/// the outermost points, which lie half of a coarse spacing inside the plate.
#[test]
fn strain_at_the_tip_is_that_of_the_fine_panel() {
    let fine = tip_stretches(&case(PANEL, &["model.spacing_mm=1"]));
    let largest = fine.iter().fold(0.0_f64, |m, (_, s)| m.max(s.abs()));
    for (name, [spacing, region]) in [("two levels", TWO), ("three levels", THREE)] {
        let refined = tip_stretches(&case(PANEL, &levels(spacing, region, &[])));
        assert_eq!(fine.len(), refined.len());
        let off = fine.iter().zip(&refined).fold(0.0_f64, |m, (a, b)| {
            assert!(a.0 == b.0 && b.1.is_finite());
            m.max((a.1 - b.1).abs())
        });
        println!("{name}: {} bonds, {:.3} % of the largest stretch", fine.len(), 100.0 * off / largest);
        assert!(fine.len() > 50 && off < 5e-3 * largest, "{name}: {off:.2e} of {largest:.2e}");
    }
}

/// On turned rows of points, where plate and lattice have different axes.
#[test]
fn turned_rows_do_no_harm() {
    let turned = ["model.lattice_angle_deg=20", "stop.crack_length_mm=16"];
    let fine = run(&case(PANEL, &[&["model.spacing_mm=1"], &turned[..]].concat()));
    let refined = run(&case(PANEL, &levels(TWO[0], TWO[1], &turned)));
    let ratio = refined.life_cycles() / fine.life_cycles();
    println!("life {ratio:.4}, {} and {} points", refined.figures.points, fine.figures.points);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    let last = |run: &Prediction| run.curve.last().unwrap().tips.iter().map(|tip| tip.position).collect::<Vec<Point>>();
    for (a, b) in last(&fine).into_iter().zip(last(&refined)) {
        assert!(distance(a, b) < fine.figures.horizon, "{a:?} and {b:?}");
    }
}

/// Every point is of the finest level: the same curve as on the lattice, whatever holds or pulls, and whatever the law.
#[test]
fn a_plate_refined_everywhere_is_the_lattice() {
    let panel = |ends: &str| {
        format!("kind=\"single_edge_tension\"\nends=\"{ends}\"\nwidth_mm=32\nlength_mm=64\nthickness_mm=2\ncrack_length_mm=9\n")
    };
    let plate = "kind=\"plate\"\nwidth_mm=32\nlength_mm=64\nthickness_mm=2\ncracks=[{from_mm=[-5,-1],to_mm=[5,2]}]\n";
    let bottom = "supports.bottom={ rows_mm = 3.0, fix = [\"x\", \"y\"] }";
    let stop = "stop.crack_length_mm=11.5";
    let scenes: [(&str, String, Vec<&str>); 4] = [
        ("uniform stress", panel("uniform_stress"), vec![stop]),
        (
            "clamped, bond-based",
            panel("clamped"),
            vec![stop, "model.bond_law=bond_based", "material.poisson_ratio=0.333333333333333333"],
        ),
        ("pinned, uncorrected", panel("pinned"), vec![stop, "model.surface_correction=none"]),
        ("slant, held, rotation resisted", plate.to_owned(), vec!["stop.crack_length_mm=12", bottom, "model.rotation=resisted"]),
    ];
    for (name, specimen, set) in scenes {
        let direct = ["model.solver=direct", "model.symmetry=off", "model.spacing_mm=1"];
        let lattice = run(&case(&specimen, &[&set[..], &direct].concat()));
        let everywhere = "refinement.regions=[{box_mm=[[-100,-100],[100,100]],levels=1}]";
        let dual = run(&case(&specimen, &levels("model.spacing_mm=2", everywhere, &set)));
        assert_eq!(lattice.figures.points, dual.figures.points, "{name}");
        assert_eq!(lattice.figures.bonds, dual.figures.bonds, "{name}");
        assert_eq!((lattice.curve.len(), lattice.stop), (dual.curve.len(), dual.stop), "{name}");
        let mut off = 0.0_f64;
        for (a, b) in lattice.curve.iter().zip(&dual.curve) {
            let pairs = [(a.cycles, b.cycles), (a.crack_length, b.crack_length), (a.work, b.work)];
            for (a, b) in pairs.into_iter().filter(|(a, _)| a.is_finite() && *a > 0.0) {
                assert!(b.is_finite(), "{name}: {b}");
                off = off.max((a - b).abs() / a);
            }
            assert_eq!(a.broken_bonds, b.broken_bonds, "{name}");
        }
        println!("{name}: {} rows, {off:.1e}", lattice.curve.len());
        assert!(lattice.curve.len() > 10 && off < 1e-9, "{name}: {off:.1e} off");
        assert_eq!(lattice.grid.point_at.len(), dual.grid.point_at.len());
        let far = differ(&lattice, &dual);
        assert!(far < 1e-7, "{name}: pictures {far:.1e} off");
    }
}

/// Largest difference of displacement over the largest one, in the last pictures of two runs on the same lattice, but for the rigid motion
/// that a floating plate leaves open; damage is the same.
fn differ(a: &Prediction, b: &Prediction) -> f64 {
    let (last_a, last_b) = (a.snapshots.last().unwrap(), b.snapshots.last().unwrap());
    let of = |grid: &PointGrid, snapshot: &Snapshot, place: usize| {
        grid.point_at[place].map(|point| (snapshot.displacement[point as usize], snapshot.damage[point as usize]))
    };
    let (mut size, mut rows, mut differences) = (0.0_f64, Vec::new(), Vec::new());
    for place in 0..a.grid.point_at.len() {
        match (of(&a.grid, last_a, place), of(&b.grid, last_b, place)) {
            (Some((u, damage)), Some((v, other))) => {
                size = size.max(u[0].hypot(u[1]));
                assert!(v.iter().all(|v| v.is_finite()), "{v:?}");
                let seat =
                    [(place % a.grid.columns) as f64, (place / a.grid.columns) as f64].map(|at| at / a.grid.columns as f64);
                rows.extend([[1.0, 0.0, -seat[1]], [0.0, 1.0, seat[0]]]);
                differences.extend([u[0] - v[0], u[1] - v[1]]);
                assert!((damage - other).abs() < 1e-6, "damage {damage} and {other}");
            }
            (None, None) => {}
            other => panic!("{other:?}"),
        }
    }
    let motions = DMatrix::from_fn(rows.len(), 3, |i, j| rows[i][j]);
    let differences = DVector::from_vec(differences);
    let rigid = motions.clone().svd(true, true).solve(&differences, 1e-12).unwrap();
    (differences - motions * rigid).amax() / size
}

/// A slant crack turns and runs to both edges on the same way, and severs the plate.
#[test]
fn a_slant_crack_goes_the_same_way() {
    let fine = run(&case(SLANT, &["model.spacing_mm=1"]));
    let region = "refinement.regions=[{box_mm=[[-32,-20],[32,20]],levels=1}]";
    let refined = run(&case(SLANT, &levels("model.spacing_mm=2", region, &[])));
    assert_eq!((fine.stop, refined.stop), (StopReason::Severed, StopReason::Severed));
    let way = |run: &Prediction, tip: usize| run.curve.iter().map(|row| row.tips[tip].position).collect::<Vec<Point>>();
    let horizon = fine.figures.horizon;
    for tip in 0..2 {
        let (fine, refined) = (way(&fine, tip), way(&refined, tip));
        let away = |at: &Point| fine.windows(2).map(|w| distance_to_segment(*at, w[0], w[1])).fold(f64::INFINITY, f64::min);
        assert!(refined.iter().flatten().all(|x| x.is_finite()));
        let off = refined.iter().map(away).fold(0.0, f64::max);
        println!("tip {tip}: {:.3} horizons off, {} rows", off / horizon, refined.len());
        assert!(off < horizon, "tip {tip}: {:.2} horizons", off / horizon);
    }
    let ratio = refined.life_cycles() / fine.life_cycles();
    println!("life {ratio:.4}, {} and {} points", refined.figures.points, fine.figures.points);
    assert!((ratio - 1.0).abs() < 0.015, "{ratio}");
}

/// Condensed windows and whole solves after every break give the same run.
#[test]
fn windows_are_exact() {
    let of = |solver: &str| {
        let solver = format!("model.solver={solver}");
        run(&case(PANEL, &levels(THREE[0], THREE[1], &["stop.crack_length_mm=15", &solver])))
    };
    let (window, direct) = (of("window"), of("direct"));
    assert!(direct.figures.iterations > 5 * window.figures.iterations, "{:?}", direct.figures);
    assert_eq!(window.curve.len(), direct.curve.len());
    for (a, b) in window.curve.iter().zip(&direct.curve) {
        assert!((a.cycles - b.cycles).abs() <= 1e-8 * b.cycles, "{} and {}", a.cycles, b.cycles);
        assert!((a.work / b.work - 1.0).abs() < 1e-9, "{} and {}", a.work, b.work);
    }
}

/// A crack that runs out of the finest level ends its run by name, before anything is wrong; one that starts outside is refused.
#[test]
fn cracks_stay_on_the_finest_level() {
    let near = "refinement.regions=[{around_flaws_mm=15,levels=1}]";
    let short = run(&case(PANEL, &levels(TWO[0], near, &[])));
    assert_eq!(short.stop, StopReason::LeftRefinement);
    let line = short.warnings.iter().find(|line| line.contains("rim of the finest level")).unwrap();
    assert!(line.contains("refinement.regions") && line.contains("12.0600 mm on"), "{line}");
    let fine = run(&case(PANEL, &["model.spacing_mm=1", "stop.crack_length_mm=28"]));
    let reached = short.crack_length_final();
    assert!(reached > 13e-3 && reached < 20e-3, "{reached}");
    // Lengths are averaged over a spacing of growth, so the last spacing before an end that nobody foresaw is not known as well.
    let known = reached - 1.5e-3;
    let cycles = |run: &Prediction| {
        let at = run.curve.windows(2).find(|w| w[1].crack_length >= known).unwrap();
        let share = (known - at[0].crack_length) / (at[1].crack_length - at[0].crack_length);
        at[0].cycles + share * (at[1].cycles - at[0].cycles)
    };
    let ratio = cycles(&short) / cycles(&fine);
    println!("rim reached at {:.2} mm, life {ratio:.4} of the fine panel's to {:.2} mm", 1e3 * reached, 1e3 * known);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");

    let beside = "refinement.regions=[{box_mm=[[20,-9],[40,9]],levels=1}]";
    let error = predict(&case(PANEL, &levels(TWO[0], beside, &[])), &Silent).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("refinement.regions") && error.to_string().contains("crack tip"), "{error}");
    assert!(try_case(PANEL, &levels(TWO[0], TWO[1], &["model.bond_law=state_based"])).is_err());
    // K is read off a lattice; so that nobody gets that of the coarsest spacing.
    let levelled = case(PANEL, &levels(TWO[0], TWO[1], &[]));
    assert_eq!(CrackedPlate::new(&levelled).err().map(|error| error.exit_code()), Some(2));
}
