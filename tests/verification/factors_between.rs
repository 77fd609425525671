//! K of rows between two equilibria against nodes on the path as it is drawn up to there.

use perilife_base::input::{Document, Folder};
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::cracks::scales::Scales;
use perilife_growth::cracks::steering::{Steering, equivalent_factor, factors_across, kink_angle};
use perilife_growth::nodes::NodePlate;
use perilife_growth::predict::{Silent, predict};

/// A centre crack at 45°, half of it 6 mm long, along a path in mm.
fn case(path: &[[f64; 2]]) -> Case {
    let text = format!(
        "[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 120\nthickness_mm = 2\ncracks = [{{ path_mm = {path:?} }}]\n[material]\n\
         youngs_modulus_gpa = 70\npoisson_ratio = 0.3\nplane = \"stress\"\n[loading]\nstress_max_mpa = 60\nstress_ratio = 0.1\n[fatigue]\n\
         paris_c_mm_per_cycle = 1e-8\nparis_m = 3\n[model]\nmethod = \"element_free_galerkin\"\ntolerance_percent = 0.5\n[stop]\n\
         crack_length_mm = 16\n"
    );
    Document::parse(&text, "slant", Folder::none(), &[]).and_then(|document| Case::from_document(&document)).unwrap()
}

/// Before the crack turns into its next piece K_II is +0.29 MPa√m, after it -0.08: straight between its ends it would be +0.14.
#[test]
fn k_ii_between_equilibria_is_that_of_the_piece_it_is_on() {
    let ends = [[-6.0 / 2.0_f64.sqrt(); 2], [6.0 / 2.0_f64.sqrt(); 2]];
    let curve = predict(&case(&ends), &Silent).unwrap().curve;
    let place = |row: usize, tip: usize| curve[row].tips[tip].position.map(|x| x / MM);
    let after_kink = curve.iter().position(|row| row.is_solved && row.tips[0].growth > 0.0).unwrap();
    let between = (after_kink + 1..curve.len()).filter(|row| !curve[*row].is_solved).take(5);
    let mut compared = 0;
    for row in between {
        let corners: Vec<usize> = (1..row).filter(|row| curve[*row].is_solved).chain([row]).collect();
        let mut path: Vec<[f64; 2]> = corners.iter().rev().map(|row| place(*row, 0)).collect();
        path.extend(ends);
        path.extend(corners.iter().map(|row| place(*row, 1)));
        let drawn = initial_tips::<NodePlate>(&case(&path)).unwrap().tips[0].factors.unwrap();
        let told = curve[row].tips[0].factors.unwrap();
        let apart = [0, 1].map(|mode| (told[mode] - drawn[mode]) / MPA_SQRT_M);
        println!("{:.4} mm: {told:?} and {drawn:?}", curve[row].tips[0].growth / MM);
        assert!(apart.iter().all(|k| k.abs() < 0.01 * equivalent_factor(drawn) / MPA_SQRT_M), "{row}: {told:?} for {drawn:?}");
        compared += 1;
    }
    assert_eq!(compared, 5);
}

/// In the direction of the largest circumferential stress nothing slides, straight on nothing changes, and small turns are those of Amestoy and Leblond.
#[test]
fn factors_turn_with_the_crack() {
    let factors = [5.0, 1.5];
    let turned = factors_across(factors, kink_angle(factors));
    assert!((turned[0] / equivalent_factor(factors) - 1.0).abs() < 1e-12 && turned[1].abs() < 1e-12, "{turned:?}");
    assert_eq!(factors_across(factors, 0.0), factors);
    // Their series to m³: F11 and F21 at 15°.
    let (m, pi) = (1.0_f64 / 12.0, std::f64::consts::PI);
    let (f11, f21) = (1.0 - 0.375 * pi * pi * m * m, 0.5 * pi * m - (4.0 * pi / 3.0 + pi.powi(3) / 48.0) * m.powi(3));
    let [k_i, k_ii] = factors_across([1.0, 0.0], pi * m);
    assert!((k_i - f11).abs() < 0.006 && (k_ii - f21).abs() < 0.006, "{k_i} {f11}, {k_ii} {f21}");
}

/// Readings that lie to one side and the other in turn count together, those of a crack that curves two by two.
#[test]
fn aims_that_zigzag_make_one_line() {
    let scales = Scales::of_nodes(&case(&[[-4.0, -4.0], [4.0, 4.0]]), 1e-3).steering;
    let slope = |aims: &[f64]| {
        let mut steering = Steering::default();
        for (k, aim) in aims.iter().enumerate() {
            steering.read([1.0, -0.5 * aim], k as f64, [1.0, 0.0], &scales);
        }
        steering.slope(&scales, |growth| growth)
    };
    // A fifth of what the last two say: Σ (x - x̄) y / Σ (x - x̄)² of four aims ±y.
    let zigzag = slope(&[0.0, -0.01, 0.01, -0.01, 0.01]);
    assert!((zigzag - 0.2 * 0.02).abs() < 1e-5, "{zigzag}");
    let curve = slope(&[0.0, 0.001, 0.004, 0.009, 0.016]);
    assert!((curve - 0.007).abs() < 1e-5, "{curve}");
}
