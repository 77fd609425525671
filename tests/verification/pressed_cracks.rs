//! Cracks that the load presses together: they do not grow, and carry as if they were not there.
//!
//! Plates of `../shared/data/field/mechanics/closed_crack`, exact by symmetry or finite elements as said there.

use std::path::Path;

use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::tip_factors::{StressIntensityMethod, stress_intensity};
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_growth::record::CurvePoint;
use perilife_points::crack_tip::TipState;
use perilife_points::solver::{SolverKind, Symmetry};

use perilife_study::cases::POINTS;

use crate::support::shared::shared;

fn pressed(name: &str) -> Option<Case> {
    shared(&format!("field/mechanics/closed_crack/{name}.toml")).map(|path| Case::from_file(&path, &[POINTS.to_owned()]).unwrap())
}

fn last(run: &Prediction) -> &CurvePoint {
    run.curve.last().unwrap()
}

/// On the middle line of a plate with a level crack there is no shear and only pressure across: a crack there changes nothing.
#[test]
fn a_closed_crack_above_an_open_one_changes_nothing() {
    let (Some(one), Some(both)) = (pressed("one"), pressed("closed_above")) else { return };
    let (one, both) = (predict(&one, &Silent).unwrap(), predict(&both, &Silent).unwrap());
    println!("{} cycles, {} with the closed crack", last(&one).cycles, last(&both).cycles);
    assert!((last(&both).cycles / last(&one).cycles - 1.0).abs() < 0.005);
    for (tip, alone) in both.curve[0].tips.iter().zip(&one.curve[0].tips) {
        let [k_i, k_ii] = tip.factors.unwrap();
        assert!((k_i / alone.factors.unwrap()[0] - 1.0).abs() < 0.002 && (k_ii / k_i).abs() < 0.002, "{tip:?}");
    }
    let tips = &last(&both).tips;
    assert!(tips[..2].iter().all(|tip| tip.position[1].abs() < 0.05e-3 && tip.growth > 39e-3), "{tips:?}");
    // When next to nothing is left of the plate, a lower tip may open.
    for point in &both.curve {
        assert!(point.tips[2..].iter().all(|tip| tip.growth < 1e-6), "{point:?}");
        assert!(point.crack_length > 0.1 || point.tips[2..].iter().all(|tip| tip.state == TipState::Closed), "{point:?}");
    }
    assert!(both.warnings.iter().any(|warning| warning.contains("tip 2, 3 is closed by the load")), "{:?}", both.warnings);
}

/// By the part of the plate that stands for it and by the whole.
#[test]
fn contact_is_the_same_by_every_solver() {
    let Some(path) = shared("field/mechanics/closed_crack/closed_above.toml") else { return };
    let case = Case::from_file(&path, &["model.spacing_mm=2".to_owned()]).unwrap();
    let factors = |solver: SolverKind, symmetry: Symmetry| {
        let mut case = case.clone();
        let points = case.model.points_mut().unwrap();
        (points.solver, points.symmetry, points.residual) = (solver, symmetry, 1e-9);
        let tips = stress_intensity(&case, &[StressIntensityMethod::Ring]).unwrap();
        tips.iter().map(|tip| [tip.methods[0].intensity.k_i.unwrap(), tip.methods[0].intensity.k_ii.unwrap()]).collect::<Vec<_>>()
    };
    let reference = factors(SolverKind::Multigrid, Symmetry::Off);
    for (solver, symmetry) in [(SolverKind::Window, Symmetry::Auto), (SolverKind::Window, Symmetry::Off)] {
        for (tip, reference) in factors(solver, symmetry).iter().zip(&reference) {
            let differs = (0..2).map(|mode| (tip[mode] - reference[mode]).abs()).fold(0.0, f64::max);
            assert!(differs < 1e-5 * reference[0].max(1e6), "{solver}, {symmetry}: {tip:?}, {reference:?}");
        }
    }
}

/// An open crack towards a closed one: it lives as long as right, and the closed one stands until it has come to the edge.
#[test]
fn a_closed_crack_ahead_stands_still() {
    let Some(case) = pressed("closed_ahead") else { return };
    let run = predict(&case, &Silent).unwrap();
    // Until a tip of the open crack has left the plate.
    let through = run.curve.iter().find(|point| point.tips.iter().any(|tip| tip.state == TipState::LeftPlate)).unwrap();
    println!(
        "{} cycles, closed tips grew {:?}",
        through.cycles,
        through.tips[2..].iter().map(|tip| tip.growth).collect::<Vec<_>>()
    );
    assert!(through.tips[2..].iter().all(|tip| tip.growth < 0.01e-3), "{:?}", through.tips);
    assert!((through.cycles / 86e3 - 1.0).abs() < 0.01, "{}", through.cycles);
}

/// K of `sif` is that of the first row of `predict`, with closed tips too.
#[test]
fn sif_reads_what_predict_reads() {
    let folder = Path::new("data/cases");
    let names = ["slant_crack_plate", "compact_tension", "two_cracks_plate"];
    let cases = names.map(|name| Case::from_file(&folder.join(format!("{name}.toml")), &[]).unwrap());
    for mut case in cases.into_iter().chain(pressed("closed_above")) {
        let tips = stress_intensity(&case, &[StressIntensityMethod::Ring]).unwrap();
        case.stop.cycles_max = 1.0;
        let run = predict(&case, &Silent).unwrap();
        for (tip, row) in tips.iter().zip(&run.curve[0].tips) {
            let result = &tip.methods[0];
            let [k_i, k_ii] = row.factors.unwrap();
            assert_eq!(
                [result.intensity.k_i, result.intensity.k_ii, result.t_stress],
                [Some(k_i), Some(k_ii), row.t_stress],
                "{}",
                case.name
            );
            assert_eq!(result.is_closed, row.state == TipState::Closed, "{}", case.name);
        }
    }
}

/// A crack along a pull of 50 MPa that a pressure of 50 MPa holds shut: faces in contact carry that pressure, K_I is zero, and T is the pull.
#[test]
fn t_along_a_pressed_crack() {
    let Some(case) = pressed("closed_tilted") else { return };
    for tip in initial_tips::<PointPlate>(&case).unwrap().tips {
        let (factors, t_stress) = (tip.factors.unwrap(), tip.t_stress.unwrap());
        println!("K {factors:?}, T {t_stress:.4e}");
        assert!(factors[0] == 0.0 && (t_stress / 50e6 - 1.0).abs() < 0.01, "{factors:?}, {t_stress}");
    }
}
