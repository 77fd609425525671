//! A plate and its mirror image have the same life, and a plate that is its own has no K_II, wherever its rims lie between points.

use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::{Silent, predict};

use crate::support::plates::case;
use crate::support::shared::shared;

/// Heights around odd and even numbers of spacings of 1 mm, and the same but for round-off.
fn heights() -> impl Iterator<Item = f64> {
    (78..=82).flat_map(|rows| [-1e-12, 0.0, 1e-12].map(|by| f64::from(rows) + by))
}

fn plate(height: f64, rest: &str) -> Case {
    let text = format!("kind=\"plate\"\nwidth_mm=40\nlength_mm={height:.12}\nthickness_mm=2\n{rest}\n");
    let mut case = case(&text, &["fatigue.driver=tip_field", "model.spacing_mm=1"]);
    case.model.points_mut().unwrap().residual = 1e-11;
    case
}

#[test]
fn a_level_crack_has_no_sliding_mode() {
    let mut last = None;
    for height in heights() {
        for crack in ["[-20,0],to_mm=[-8,0]", "[20,0],to_mm=[8,0]", "[-9,0],to_mm=[9,0]"] {
            let tips = initial_tips::<PointPlate>(&plate(height, &format!("cracks=[{{from_mm={crack}}}]"))).unwrap().tips;
            for tip in tips {
                let [k_i, k_ii] = tip.factors.unwrap();
                assert!((k_ii / k_i).abs() < 1e-6, "{height}, {crack}: K_II {:e} of K_I", k_ii / k_i);
                last = Some((height, k_i));
            }
        }
    }
    println!("{last:?}");
}

/// A crack along a column, on the middle line and beside it.
#[test]
fn an_upright_crack_in_bending_has_no_sliding_mode() {
    for (width, x) in [(60.0, 0.0), (61.0, 0.0), (60.0, 7.3)] {
        let holes = format!("holes=[{{x_mm={},y_mm=0,diameter_mm=6}},{{x_mm={},y_mm=0,diameter_mm=6}}]", x - 12.0, x + 12.0);
        let pins = "[loading]\nforce_max_n=1000\nstress_ratio=0.1\npins=[{hole=0,direction=[-1,0]},{hole=1,direction=[1,0]}]";
        let text = format!(
            "kind=\"plate\"\noutline_mm=[[{a},-20],[{b},-20],[{b},20],[{a},20]]\nthickness_mm=2\n{holes}\n\
             cracks=[{{from_mm=[{x},-20],to_mm=[{x},-8]}}]\n{pins}\n",
            a = x - 0.5 * width,
            b = x + 0.5 * width
        );
        let case = case(&text, &["fatigue.driver=tip_field", "model.spacing_mm=1"]);
        let tips = initial_tips::<PointPlate>(&case).unwrap().tips;
        let [k_i, k_ii] = tips[0].factors.unwrap();
        assert!((k_ii / k_i).abs() < 1e-6, "width {width}, x {x}: K_II {:e} of K_I", k_ii / k_i);
    }
}

fn live_as_long(heights: impl Iterator<Item = f64>) {
    for height in heights {
        let life = |sign: f64| {
            let hole = format!("holes=[{{x_mm=4,y_mm={},diameter_mm=10}}]", sign * 14.0);
            let run = predict(&plate(height, &format!("{hole}\ncracks=[{{from_mm=[-20,0],to_mm=[-10,0]}}]")), &Silent).unwrap();
            (run.curve.last().unwrap().cycles, run.stop)
        };
        let (above, below) = (life(1.0), life(-1.0));
        assert!((above.0 / below.0 - 1.0).abs() < 1e-9 && above.1 == below.1, "{height}: {above:?}, {below:?}");
    }
}

/// An odd number of spacings, and an even one but for round-off.
#[test]
fn the_mirror_image_of_a_plate_lives_as_long() {
    live_as_long(heights().skip(4).step_by(4).take(2));
}

#[test]
#[ignore = "long: ten seconds"]
fn the_mirror_image_of_a_plate_of_any_height_lives_as_long() {
    live_as_long(heights().step_by(2));
}

/// Double cantilevers of 79 and 80 rows against finite elements (`../shared/data/field/mechanics/odd_rows`): K and life; the arms of the
/// former were of 39 and 40 rows, and the crack left by its side after 0.57 of the life.
fn keeps_its_middle_line(name: &str) {
    let (k_i, life) = (2.295, 16.00e6);
    let Some(path) = shared(&format!("field/mechanics/odd_rows/{name}.toml")) else { return };
    let run = predict(&Case::from_file(&path, &["model.spacing_mm=1".to_owned()]).unwrap(), &Silent).unwrap();
    let at = |length: f64| run.curve.iter().find(|point| point.crack_length >= length).unwrap().cycles;
    let first = run.curve[0].tips[0].factors.unwrap()[0] / 1e6;
    println!("{name}: K_I {first:.4}, {:.4e} cycles to 100 mm", at(0.1));
    assert!((first / k_i - 1.0).abs() < 0.006 && (at(0.1) / life - 1.0).abs() < 0.015, "{name}: {first}, {}", at(0.1));
    assert!(run.curve.iter().all(|point| point.tips[0].position[1].abs() < 0.05e-3), "{name}: off the middle line");
}

#[test]
fn a_double_cantilever_keeps_its_middle_line() {
    keeps_its_middle_line("dcb_39.5");
}

#[test]
#[ignore = "long: ten seconds"]
fn a_double_cantilever_in_plane_strain_keeps_its_middle_line() {
    keeps_its_middle_line("dcb_39.5_plane_strain_1mm");
}
