//! Do cycle blocks keep their bound on the error of life, and are strains foreseen near a tip those of the plate?

use perilife::body::Bond;
use perilife::body::pre_crack::places_near;
use perilife::bond_law::BondLawKind;
use perilife::fatigue::ageing::stretch;
use perilife::fatigue::crack_tip::CrackTip;
use perilife::predict::{CurvePoint, Prediction, Silent, TipRecord, predict};
use perilife::solver::field::Layout;
use perilife::solver::{Equilibrium, Focus, SolverKind, Symmetry};
use perilife::specimen::geometry::distance;
use perilife::state::Bonds;

use crate::plates::case;
use crate::statics::body;

/// Name, `[specimen]`, settings.
fn scenes() -> [(&'static str, &'static str, &'static [&'static str]); 4] {
    let edge =
        "kind=\"single_edge_tension\"\nends=\"uniform_stress\"\nwidth_mm=40\nlength_mm=100\nthickness_mm=2\ncrack_length_mm=10\n";
    let clamped =
        "kind=\"single_edge_tension\"\nends=\"clamped\"\nwidth_mm=40\nlength_mm=100\nthickness_mm=2\ncrack_length_mm=10\n";
    [
        (
            "middle tension",
            "kind=\"middle_tension\"\nwidth_mm=60\nlength_mm=100\nthickness_mm=2\ncrack_length_mm=12\n",
            &["stop.crack_length_mm=20"],
        ),
        (
            "slant",
            "kind=\"plate\"\nwidth_mm=60\nlength_mm=100\nthickness_mm=2\ncracks=[{from_mm=[-8,-5],to_mm=[8,5]}]\n",
            &["stop.crack_length_mm=34", "supports.bottom={rows_mm=3,fix=[\"x\",\"y\"]}"],
        ),
        ("edge", edge, &["stop.crack_length_mm=18"]),
        ("edge, clamped", clamped, &["stop.crack_length_mm=18"]),
    ]
}

fn grow(specimen: &str, set: &[&str], more: &[&str]) -> Prediction {
    let own = ["model.spacing_mm=1", "stop.cycles_max=1e12"];
    predict(&case(specimen, &[&own[..], set, more].concat()), &Silent).unwrap()
}

/// Life within the bound of one break a block, and fewer solves; a solver without need for blocks is exact.
#[test]
fn controlled_blocks_keep_their_bound() {
    for (name, specimen, set) in scenes().into_iter().take(3) {
        for p in ["fatigue.p=2.5", "fatigue.p=4"] {
            let single = grow(specimen, set, &[p, "fatigue.block=until_next_break"]);
            assert_eq!(grow(specimen, set, &[p]).curve, single.curve, "{name}, {p}: the window solves after every break");
            for percent in [1.0, 5.0] {
                let error = format!("fatigue.block_error_percent={percent}");
                let run = grow(specimen, set, &[p, "model.solver=multigrid", &error]);
                let ratio = run.life_cycles() / single.life_cycles();
                let blocks = [run.figures.blocks, single.figures.blocks];
                println!("{name}, {p}, {percent} %: life over single breaks {ratio:.5}, {blocks:?} blocks");
                assert!((ratio - 1.0).abs() < 0.01 * percent, "{name}, {p}, {percent} %: {ratio}");
                assert!(2 * blocks[0] < blocks[1], "{name}, {p}, {percent} %: {blocks:?}");
                assert_eq!(run.stop, single.stop, "{name}, {p}, {percent} %");
                if name == "middle tension" {
                    let twins = |tips: &[TipRecord]| (tips[0].growth - tips[1].growth).abs() < 1e-12;
                    assert!(run.curve.iter().all(|point| twins(&point.tips)), "{p}, {percent} %: twins part");
                }
            }
        }
    }
}

/// Every law, with a Poisson's ratio that it has.
fn laws() -> impl Iterator<Item = [String; 2]> {
    let ratio = |kind: BondLawKind| if kind == BondLawKind::BondBased { 1.0 / 3.0 } else { 0.3 };
    BondLawKind::ALL
        .iter()
        .map(move |&kind| [format!("model.bond_law={kind}"), format!("material.poisson_ratio={}", ratio(kind))])
}

/// A whole run, to the end of the plate, between rigid grips, with every law and solver.
#[test]
fn controlled_blocks_end_as_single_breaks_do() {
    let (_, specimen, _) = scenes()[3];
    for [law, ratio] in laws() {
        let set = [&*law, &ratio, "model.spacing_mm=2", "fatigue.growth_rate=bond_strain"];
        let single = grow(specimen, &set, &["fatigue.block=until_next_break"]);
        let strict = grow(specimen, &set, &["model.solver=multigrid", "fatigue.block_error_percent=0.1"]);
        assert!((strict.life_cycles() / single.life_cycles() - 1.0).abs() < 1e-6, "{law}: every break is solved for");
        for solver in SolverKind::ALL {
            let run = grow(specimen, &set, &[&format!("model.solver={solver}")]);
            println!("{law}, {solver}: {} after {:.5} of the cycles", run.stop, run.life_cycles() / single.life_cycles());
            assert_eq!(run.stop, single.stop, "{law}, {solver}");
            assert!((run.life_cycles() / single.life_cycles() - 1.0).abs() < 0.01, "{law}, {solver}");
            let ordered = |pair: &[CurvePoint]| pair[1].cycles >= pair[0].cycles && pair[1].crack_length >= pair[0].crack_length;
            assert!(run.curve.windows(2).all(ordered), "{law}, {solver}");
        }
    }
}

/// Bonds that break at a tip strain the others there: with the rim held nearly as much as in the whole plate.
#[test]
fn foreseen_strains_are_those_of_the_plate_nearly() {
    for ((name, specimen, _), [law, ratio]) in scenes().into_iter().flat_map(|scene| laws().map(move |law| (scene, law))) {
        let name = format!("{name}, {law}");
        let case = case(specimen, &["model.spacing_mm=1", &law, &ratio]);
        let body = body(&case);
        let mut bonds = Bonds::new(&body);
        let tips: Vec<CrackTip> = case.specimen.tips.iter().map(|seed| CrackTip::at(seed, &body)).collect();
        let focus: Vec<Focus> = tips
            .iter()
            .map(|tip| Focus {
                position: tip.position,
                direction: tip.direction,
                wake: tip.wake.clone(),
                reach: body.horizon() + body.lattice.spacing,
            })
            .collect();
        let layout = Layout::of(&body.lattice, body.stencil.unknowns);
        let near: Vec<Bond> = places_near(&body, tips[0].position, tips[0].position, 0.5 * body.horizon())
            .flat_map(|place| (0..body.steps.len()).map(move |k| (k, place)))
            .map(|(k, place)| (k * body.places() + place) as Bond)
            .filter(|&bond| bonds.is_intact(bond) && distance(body.middle(bond), tips[0].position) < 0.5 * body.horizon())
            .collect();

        let mut u = Vec::new();
        let mut equilibrium =
            Equilibrium::new(SolverKind::Multigrid, Symmetry::Off, &body, &bonds, case.loading.maximum).foreseeing();
        equilibrium.solve(&body, &bonds, &mut u).unwrap();
        equilibrium.reach(&body, &bonds, &near, &focus, &mut u).unwrap();
        assert!(!equilibrium.is_foreseen() && equilibrium.is_whole());

        // The most stretched ones break.
        let stretches =
            |u: &[f64], of: &[Bond]| -> Vec<f64> { of.iter().map(|&bond| stretch(&body, &layout, u, bond)).collect() };
        let mut order: Vec<(Bond, f64)> = near.iter().copied().zip(stretches(&u, &near)).collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        let broken: Vec<Bond> = order[..4].iter().map(|pair| pair.0).collect();
        let left: Vec<Bond> = order[4..].iter().filter(|pair| pair.1 > 0.2 * order[0].1).map(|pair| pair.0).collect();
        let frozen = stretches(&u, &left);
        broken.iter().for_each(|&bond| bonds.cut(&body, bond));
        equilibrium.broke(&body, &bonds, &broken);
        assert!(equilibrium.foresee(&body, &bonds, &mut u), "{name}");
        assert!(equilibrium.is_foreseen() && !equilibrium.is_whole());
        let (foreseen, work) = (stretches(&u, &left), equilibrium.work());
        equilibrium.solve(&body, &bonds, &mut u).unwrap();
        assert!(!equilibrium.is_foreseen() && equilibrium.is_whole());
        let solved = stretches(&u, &left);

        let size = solved.iter().copied().fold(0.0, f64::max);
        let off = |other: &[f64]| other.iter().zip(&solved).map(|(a, b)| (a - b).abs() / size).fold(0.0, f64::max);
        // What the rim would add opens the crack as a whole: once that share is known, a hundredth of the change is left.
        let share = solved.iter().sum::<f64>() / foreseen.iter().sum::<f64>();
        let corrected: Vec<f64> = foreseen.iter().map(|s| s * share).collect();
        let [frozen, foreseen, corrected] = [frozen, foreseen, corrected].map(|strains| off(&strains));
        println!(
            "{name}: {} bonds, largest error frozen {frozen:.4}, foreseen {foreseen:.4}, corrected {corrected:.5}",
            left.len()
        );
        assert!(frozen > 0.1, "{name}: {frozen}");
        assert!(foreseen < frozen / 8.0, "{name}: {foreseen}");
        assert!(corrected < 0.01 * frozen, "{name}: {corrected}");
        // Held farther away, the plate is stiffer: the work of the load stays below.
        assert!(work <= equilibrium.work() * (1.0 + 1e-9), "{name}");
    }
}
