//! Every iteration against sparse Cholesky, and what all do with pieces that hang loose.

use nalgebra::{DMatrix, DVector};
use perilife_base::error::Error;
use perilife_growth::case::Case;
use perilife_growth::predict::{Silent, predict};
use perilife_points::body::pre_crack::bonds_across;
use perilife_points::bond_law::Rotation;
use perilife_points::pieces::{Connectivity, remove_fragments};
use perilife_points::solver::field::Layout;
use perilife_points::solver::{Equilibrium, SolverKind, Symmetry};
use perilife_points::state::Bonds;

use crate::support::plates::case;
use crate::support::statics::{Loaded, body, loaded, loaded_with};

/// More than the digits printed anywhere, less than what decides which bond breaks first.
const AGREEMENT: f64 = 1e-6;

/// Iterations of a first solve by multigrid. Horizon ratio 2.015 coarsens by two with a thinner stencil; bonds of rigid grips are a
/// thousand times stiffer than the plate beside them, which the coarse places smear (35 and 22 at the worst).
fn iterations_max(name: &str, ratio: f64) -> usize {
    match (name.contains("pinned"), ratio < 3.0) {
        // The end of the slot is drawn badly on the first coarse level.
        (false, false) if name == "slot" => 17,
        (false, false) => 15,
        (false, true) => 22,
        (true, false) => 24,
        (true, true) => 38,
    }
}

/// More iterations of a state-based law, whose dilatation the preconditioner does not know, at a residual of 1e-11.
const MORE: usize = 8;

const PLATE: &str = "kind=\"plate\"\nwidth_mm=100\nlength_mm=160\nthickness_mm=2\n";

/// Name, `[specimen]`, settings.
fn scenes() -> Vec<(&'static str, String, &'static [&'static str])> {
    let plate = |rest: &str| format!("{PLATE}{rest}\n");
    let edge = |ends: &str| {
        format!("kind=\"single_edge_tension\"\nwidth_mm=60\nlength_mm=160\nthickness_mm=2\ncrack_length_mm=20\nends=\"{ends}\"\n")
    };
    let slant = "cracks=[{from_mm=[-17,-9],to_mm=[17,9]}]";
    let held: &[&str] = &["supports.bottom={ rows_mm = 3.0, fix = [\"x\", \"y\"] }"];
    vec![
        (
            "centre crack",
            "kind=\"middle_tension\"\nwidth_mm=100\nlength_mm=160\nthickness_mm=2\ncrack_length_mm=20\n".into(),
            &[],
        ),
        ("slant crack", plate(slant), &[]),
        ("slant crack, bottom held", plate(slant), held),
        ("edge crack, uniform stress", edge("uniform_stress"), &[]),
        ("edge crack, pinned", edge("pinned"), &[]),
        ("edge crack, clamped", edge("clamped"), &[]),
        (
            "two edge cracks",
            "kind=\"double_edge_tension\"\nwidth_mm=80\nlength_mm=160\nthickness_mm=2\ncrack_length_mm=20\n".into(),
            &[],
        ),
        ("compact", "kind=\"compact_tension\"\nwidth_mm=80\nthickness_mm=5\ncrack_length_mm=36\n".into(), &[]),
        ("hole and crack", plate("holes=[{x_mm=0,y_mm=0,diameter_mm=24}]\ncracks=[{from_mm=[12,0],to_mm=[26,0]}]"), &[]),
        ("slot", plate("notches=[{from_mm=[-50,0],to_mm=[-20,0],width_mm=4}]"), &[]),
        ("two cracks", plate("cracks=[{from_mm=[-30,-6],to_mm=[-4,-6]},{from_mm=[4,6],to_mm=[30,6]}]"), &[]),
        ("slant crack, nu 1/3", plate(slant), &["material.poisson_ratio=0.3333333333333333"]),
        ("slant crack, turned lattice", plate(slant), &["model.lattice_angle_deg=30"]),
    ]
}

/// Name, settings and horizon ratios of the laws that differ for a solver: with three unknowns a point, with two, with the
/// dilatation beside them.
fn laws() -> [(&'static str, Vec<&'static str>, Vec<f64>); 3] {
    [
        ("free", vec!["model.rotation=free"], vec![2.015, 3.015, 4.015]),
        ("resisted", vec!["model.rotation=resisted"], vec![2.015, 3.015, 4.015]),
        ("state-based", vec!["model.bond_law=state_based", "material.poisson_ratio=0.4"], vec![3.015]),
    ]
}

/// Largest distance of two displacement fields after the rigid motion between them that a floating plate leaves open.
fn distance(a: &Loaded, b: &Loaded) -> f64 {
    let body = &a.body;
    // Without tangential springs even the resisted law does not know how the plate is turned.
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let columns = if body.stencil.resists_rotation() { 2 } else { 3 };
    let mut rows = Vec::new();
    // The size is that of the spread, which no shift of a floating plate changes.
    let mut spread = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for &point in body.points.iter().filter(|&&point| a.bonds.intact_at(body, point as usize) > 0) {
        let at = layout.index(point as usize);
        let (column, row) = body.lattice.column_row(point as usize);
        let seat = [column as f64 / body.lattice.columns as f64, row as f64 / body.lattice.columns as f64];
        for (c, motion) in [[1.0, 0.0, -seat[1]], [0.0, 1.0, seat[0]]].into_iter().enumerate() {
            let index = at + c * layout.stride;
            let [low, high] = spread[c];
            spread[c] = [low.min(a.displacement[index]), high.max(a.displacement[index])];
            rows.push((motion, a.displacement[index] - b.displacement[index]));
        }
    }
    let size = spread.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
    let difference = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.1));
    if !body.boundary.floating {
        return difference.amax() / size;
    }
    let motions = DMatrix::from_fn(rows.len(), columns, |i, j| rows[i].0[j]);
    let rigid = motions.clone().svd(true, true).solve(&difference, 1e-12).unwrap();
    (difference - motions * rigid).amax() / size
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let size = a.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
    a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / size
}

/// On points of so many mm, which count the steps of a factor to the power of 1.5, and these scenes.
fn iterations_and_cholesky(spacing: &str, is_chosen: impl Fn(&str) -> bool) {
    let mut faults = Vec::new();
    println!(
        "{:>28} {:>11} {:>6} {:>6} {:>10} {:>9} {:>9} {:>9}",
        "plate", "law", "ratio", "points", "iterations", "u", "s", "work"
    );
    for (name, specimen, set) in scenes().into_iter().filter(|scene| is_chosen(scene.0)) {
        for cracked in [true, false] {
            if !cracked && name != "centre crack" {
                continue;
            }
            for (law, choices, ratios) in laws() {
                // Other horizons on the first plates only.
                let has = |ratio: &f64| *ratio == 3.015 || name.contains("centre") || name == "slant crack" || name == "slot";
                for ratio in ratios.into_iter().filter(has) {
                    let ratio_set = format!("model.horizon_ratio={ratio}");
                    // Symmetric plates have tests of their own.
                    let all: Vec<&str> = [&*ratio_set, spacing, "model.symmetry=off"]
                        .into_iter()
                        .chain(choices.iter().copied())
                        .chain(set.iter().copied())
                        .collect();
                    let mut case = case(&specimen, &all);
                    if !cracked {
                        case.specimen.cracks.clear();
                    }
                    let name = if cracked { name } else { "no crack" };
                    let most = iterations_max(name, ratio) + if law == "state-based" { MORE } else { 0 };
                    faults.extend(faults_of(&format!("{name:>28} {law:>11} {ratio:>6}"), &case, most));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{} of the scenes:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn iterations_and_cholesky_agree() {
    /// A free plate, one held at an end, rigid grips, pins, a slot and a turned lattice.
    const QUICK: [&str; 6] =
        ["centre crack", "slant crack, bottom held", "edge crack, pinned", "compact", "slot", "slant crack, turned lattice"];
    iterations_and_cholesky("model.spacing_mm=3", |name| QUICK.contains(&name));
}

#[test]
#[ignore = "long: a minute"]
fn iterations_and_cholesky_agree_on_larger_plates() {
    iterations_and_cholesky("model.spacing_mm=2", |_| true);
}

/// Where a solver is off the direct one, or multigrid takes more than so many iterations.
fn faults_of(scene: &str, case: &Case, multigrid_iterations_max: usize) -> Vec<String> {
    let direct = match loaded(case, None) {
        Ok(direct) => direct,
        Err(error) => return vec![format!("{scene}: {error}")],
    };
    // The window's first solve is multigrid's.
    let other = match loaded(case, SolverKind::Multigrid) {
        Ok(other) => other,
        Err(error) => return vec![format!("{scene}: {error}")],
    };
    let far = distance(&direct, &other);
    let strained = largest_difference(&direct.stretches(), &other.stretches());
    let work = (other.work / direct.work - 1.0).abs();
    let line =
        format!("{scene} {:>6} {:>10} {far:>9.1e} {strained:>9.1e} {work:>9.1e}", other.body.points.len(), other.iterations);
    println!("{line}");
    let agrees = far < AGREEMENT && strained < AGREEMENT && work < AGREEMENT;
    if agrees && other.iterations <= multigrid_iterations_max { Vec::new() } else { vec![line] }
}

/// The largest eigenvalue that smoothing is made for may be that of a few points at a rim. Found too small, as by a short power
/// iteration on many points, a solve of the first plate to 1e-8 took 45 iterations, one of the third 13.
#[test]
fn a_large_plate_takes_as_few_iterations_as_a_small_one() {
    let iterations = [(577, 599), (577, 600), (100, 149), (100, 150)].map(|(width, length)| {
        let specimen =
            format!("kind=\"middle_tension\"\nwidth_mm={width}\nlength_mm={length}\nthickness_mm=1\ncrack_length_mm=20\n");
        let set = ["model.symmetry=off", "model.bond_law=bond_based", "material.poisson_ratio=0.3333333333333333"];
        loaded(&case(&specimen, &set), SolverKind::Multigrid).unwrap().iterations
    });
    assert!(iterations.iter().all(|&count| count <= iterations_max("centre crack", 3.015)), "{iterations:?}");
}

/// A square island cut out of the plate, and a corner point left on a single bond: neither carries, the rest does.
#[test]
fn loose_pieces_are_set_aside() {
    for rotation in Rotation::ALL {
        let case = case(&format!("{PLATE}cracks=[{{from_mm=[-10,0],to_mm=[10,0]}}]\n"), &[&format!("model.rotation={rotation}")]);
        let body = body(&case);
        let mut bonds = Bonds::new(&body);
        let (low, high) = ([18e-3, 18e-3], [34e-3, 30e-3]);
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        let mut cut: Vec<_> = (0..4).flat_map(|i| bonds_across(&body, corners[i], corners[(i + 1) % 4])).collect();
        // The lower left corner of the plate, which nothing loads once it has lost its neighbours but one.
        let corner = body.points.iter().map(|&p| p as usize).find(|&p| {
            let [x, y] = body.lattice.position(p);
            x < -48e-3 && y.abs() < 2e-3
        });
        let corner = corner.unwrap();
        let mut at_corner: Vec<u32> = (0..body.multiplier.len() as u32)
            .filter(|&bond| body.multiplier[bond as usize] > 0.0)
            .filter(|&bond| body.ends(bond).1 == corner || body.ends(bond).2 == corner)
            .collect();
        let kept = at_corner.pop().unwrap();
        cut.extend(at_corner);
        cut.iter().for_each(|&bond| bonds.cut(&body, bond));
        let Connectivity::Connected(aside) = remove_fragments(&body, &mut bonds, &cut) else { panic!("{rotation}: severed") };
        assert!(aside.contains(&kept), "{rotation}: the bond that a point hangs on carries nothing");
        let inside = |bond: u32| {
            let [x, y] = body.middle(bond);
            x > low[0] && x < high[0] && y > low[1] && y < high[1]
        };
        assert!((0..body.multiplier.len() as u32).all(|bond| !(bonds.is_intact(bond) && inside(bond))), "{rotation}: the island");
        let solved = |solver: Option<SolverKind>| loaded_with(body.clone(), bonds.clone(), case.loading.maximum, solver).unwrap();
        let direct = solved(None);
        assert!(direct.displacement.iter().all(|u| u.is_finite()));
        let other = solved(Some(SolverKind::Multigrid));
        println!("{rotation}: {} iterations, {} bonds set aside", other.iterations, aside.len());
        assert!(other.displacement.iter().all(|u| u.is_finite()));
        assert!(distance(&direct, &other) < AGREEMENT, "{rotation}");
        assert!(largest_difference(&direct.stretches(), &other.stretches()) < AGREEMENT, "{rotation}");
        assert!(other.iterations <= 15, "{rotation}: {} iterations", other.iterations);
    }
}

#[test]
fn a_plate_cut_in_two_is_severed() {
    for rotation in Rotation::ALL {
        // Two cracks that overlap: nothing is left between the loaded ends.
        let specimen = format!("{PLATE}cracks=[{{from_mm=[-50,0],to_mm=[2,0]}},{{from_mm=[-2,1],to_mm=[50,1]}}]\n");
        let case = case(&specimen, &[&format!("model.rotation={rotation}"), "model.spacing_mm=4"]);
        let body = body(&case);
        let mut bonds = Bonds::new(&body);
        assert_eq!(remove_fragments(&body, &mut bonds, &body.pre_cut), Connectivity::Severed);
        // Before the first cycle there is no life to report: an error in words.
        match predict(&case, &Silent) {
            Err(Error::Mechanics(words)) => assert!(words.contains("in two"), "{words}"),
            other => panic!("{rotation}: {other:?}"),
        }
    }
}

/// An edge crack that leaves a hinge: what is left carries no load that does not pass through it, and no solver need find out how far
/// it would swing.
#[test]
fn a_plate_that_gives_way_says_so() {
    for rotation in Rotation::ALL {
        let correction = "model.surface_correction=volume_and_surface";
        let set = [&*format!("model.rotation={rotation}"), "model.solver=multigrid", correction];
        let case = case(
            "kind=\"single_edge_tension\"\nwidth_mm=40\nlength_mm=80\nthickness_mm=2\ncrack_length_mm=5\nends=\"uniform_stress\"\n",
            &set,
        );
        let body = body(&case);
        let mut bonds = Bonds::new(&body);
        let left = body.points.iter().map(|&point| body.lattice.position(point as usize)[0]).fold(f64::INFINITY, f64::min);
        let mut equilibrium = Equilibrium::new(SolverKind::Multigrid, Symmetry::Off, &body, &bonds, case.loading.maximum);
        let mut displacement = Vec::new();
        let mut cut_by = |length: f64, equilibrium: &mut Equilibrium, displacement: &mut Vec<f64>| {
            let cut = bonds_across(&body, [left - 1e-3, 0.1e-3], [left + length, 0.1e-3]);
            cut.iter().for_each(|&bond| bonds.cut(&body, bond));
            equilibrium.bonds_changed(&body, &bonds, &cut);
            equilibrium.solve(&body, &bonds, displacement)
        };
        assert!(cut_by(6e-3, &mut equilibrium, &mut displacement).is_ok(), "{rotation}: a short crack");
        assert!(cut_by(30e-3, &mut equilibrium, &mut displacement).is_ok(), "{rotation}: a deep crack");
        let hinge = cut_by(38.6e-3, &mut equilibrium, &mut displacement);
        assert!(matches!(hinge, Err(Error::LossOfStiffness)), "{rotation}: {hinge:?}");
    }
}
