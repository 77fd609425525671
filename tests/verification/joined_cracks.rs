//! Kinked, branched and crossing initial cracks against finite elements (`../shared/data/field/mechanics/kinked_start`).

use std::path::Path;

use perilife_base::units::MM;
use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::nodes::NodePlate;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::{Prediction, Silent, predict};

use super::drawings::{DXF, RECTANGLE, dxf, line, plate};
use crate::support::shared::shared;

fn case(path: &Path, set: &[&str]) -> Case {
    let set = [&["model.method=peridynamics"], set].concat();
    Case::from_file(path, &set.into_iter().map(str::to_owned).collect::<Vec<_>>()).unwrap()
}

fn is_near(name: &str, found: [f64; 2], right: [f64; 2]) {
    let found = found.map(|k| k / 1e6);
    let off = (found[0] - right[0]).hypot(found[1] - right[1]);
    assert!(off < 0.01 * right[0].hypot(right[1]), "{name}: {found:?}, {right:?}");
}

#[test]
fn cracks_that_share_an_end_are_one() {
    let Some(path) = shared("field/mechanics/kinked_start/kinked_45.toml") else { return };
    let one = "specimen.cracks=[{path_mm=[[-10,0],[10,0],[13.535533905932738,3.5355339059327373]]}]";
    let [two, one] = [&[][..], &[one]].map(|set| initial_tips::<PointPlate>(&case(&path, set)).unwrap().tips);
    assert_eq!(two, one);
}

/// Two cracks from one place on a rim, or one with its corner there, part the wedge between them from the plate: nodes say what points say, whose bonds
/// are cut. As one crack with a corner that is no mouth K was 12 to 24 % too low on nodes.
#[test]
fn cracks_from_one_place_on_a_rim_are_two() {
    const REST: &str = "[material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.33\n[loading]\nstress_max_mpa = 60\nstress_ratio = 0\n\
                        [fatigue]\nparis_c_mm_per_cycle = 1e-9\nparis_m = 3\n";
    let k_i = |keys: &str| {
        let text = format!("[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 90\nthickness_mm = 2\n{keys}\n{REST}");
        let of = |set: &str| Case::from_toml(&text, "rim", Path::new(""), &[set.to_owned()]).unwrap();
        let on_points = initial_tips::<PointPlate>(&of("model.spacing_mm=0.25")).unwrap().tips;
        let on_nodes = initial_tips::<NodePlate>(&of("model.method=element_free_galerkin")).unwrap().tips;
        [on_points, on_nodes].map(|tips| tips.iter().map(|tip| tip.factors.unwrap()[0] / 1e6).collect::<Vec<_>>())
    };
    for keys in [
        "cracks = [{ from_mm = [30, 0], to_mm = [22, 3] }, { from_mm = [30, 0], to_mm = [22, -3] }]",
        "cracks = [{ path_mm = [[22, 3], [30, 0], [22, -3]] }]",
        "holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 9 }]\ncracks = [{ from_mm = [4.5, 0], to_mm = [8.5, 2] }, { from_mm = [4.5, 0], to_mm = [8.5, -2] }]",
    ] {
        let [points, nodes] = k_i(keys);
        assert!(nodes.len() == 2 && (nodes[0] / nodes[1] - 1.0).abs() < 1e-4, "{keys}: {nodes:?}");
        assert!((nodes[0] / points[0] - 1.0).abs() < 0.01, "{keys}: {nodes:?} {points:?}");
    }
}

/// A crack that branches in the plane of symmetry: its stem lies in that plane. Ends of branches are one within the round-off of a drawing.
#[test]
fn a_crack_may_branch() {
    let half = format!("{DXF}\noutline_symmetry = \"y=0\"");
    let upper = "LWPOLYLINE outline 70 0 10 -50 20 0 10 -50 20 100 10 50 20 100 10 50 20 0";
    let apart = [[[-50.0, 0.0], [-40.0, 0.0]], [[-34.0, 5.0], [-40.0002, 0.0001]], [[-40.0, 0.0001], [-34.0, -5.0]]];
    let [stem, up, down] = apart.map(|ends| line("cracks", ends));
    let drawn = [
        plate(&half, &[("part.dxf", &dxf(4, &[upper, "LWPOLYLINE cracks 70 0 10 -50 20 0 10 -40 20 0 10 -34 20 5"]))]),
        plate(&half, &[("part.dxf", &dxf(4, &[upper, &stem, &up]))]),
        plate(DXF, &[("part.dxf", &dxf(4, &[RECTANGLE, &stem, &up, &down]))]),
    ];
    // By keys, from the corner of a path or as three.
    let by_keys =
        ["[[-50, 0], [-40, 0], [-34, 5]] }", "[[-50, 0], [-40, 0]] }, { path_mm = [[-40, 0], [-34, 5]] }"].map(|stem| {
            let cracks = format!("cracks = [{{ path_mm = {stem}, {{ path_mm = [[-40, 0], [-34, -5]] }}]");
            plate(&format!("width_mm = 100\nlength_mm = 200\n{cracks}"), &[])
        });
    for specimen in drawn.into_iter().chain(by_keys) {
        let mut tips: Vec<[f64; 2]> =
            specimen.tips.iter().map(|tip| tip.position.map(|x| (x / MM * 1e6).round() / 1e6)).collect();
        tips.sort_by(|a, b| a[1].total_cmp(&b[1]));
        assert_eq!((tips, specimen.cracks.len()), (vec![[-34.0, -5.0], [-34.0, 5.0]], 3));
        assert!((specimen.crack_length - (10.0 + 2.0 * 61.0_f64.sqrt()) * MM).abs() < 1e-6, "{}", specimen.crack_length);
    }
}

fn at_height(run: &Prediction, y: f64) -> [f64; 2] {
    let rows: Vec<[f64; 3]> =
        run.curve.iter().map(|row| [1e3 * row.tips[0].position[1], 1e3 * row.tips[0].position[0], row.cycles]).collect();
    let pair = rows.windows(2).find(|pair| pair[0][0] <= y && y <= pair[1][0]).unwrap();
    let share = (y - pair[0][0]) / (pair[1][0] - pair[0][0]);
    [1, 2].map(|i| pair[0][i] + share * (pair[1][i] - pair[0][i]))
}

/// K, path and cycles of a double cantilever whose crack has a kink, at heights of 2 to 15 mm. (At 1 mm cycles are 2.4 % short.)
#[test]
#[ignore = "long: twelve seconds, most of them the first equilibrium"]
fn a_kinked_double_cantilever_grows_as_by_finite_elements() {
    let Some(path) = shared("field/mechanics/kinked_start/dcb_kinked.toml") else { return };
    let run = predict(&case(&path, &[]), &Silent).unwrap();
    is_near("dcb_kinked", run.curve[0].tips[0].factors.unwrap(), [2.4446, -0.0037]);
    let reference = [
        (2.0, -10.34, 3.598e6),
        (4.0, -8.14, 4.507e6),
        (6.0, -6.96, 4.873e6),
        (9.0, -5.89, 5.081e6),
        (12.0, -5.25, 5.136e6),
        (15.0, -4.87, 5.146e6),
    ];
    for (y, x, cycles) in reference {
        let found = at_height(&run, y);
        println!("y {y}: x {:.3}, {x}, {:.4e} cycles, {cycles:.4e}", found[0], found[1]);
        assert!((found[0] - x).abs() < 0.15 && (found[1] / cycles - 1.0).abs() < 0.02, "y {y}: {found:?}, {x}, {cycles}");
    }
}

/// Two cracks that meet on a line of symmetry go on as one in a nearly incompressible plate, too: what has no area there was a side of the crack
/// with a mean of its own, 0/0, and ended the run at 1.55 million cycles as severed. Other tolerances and ν = 0.3 give 1.61 to 1.62 million.
#[test]
fn cracks_that_meet_on_a_line_of_symmetry_go_on() {
    let text = "[specimen]\nkind = \"plate\"\nwidth_mm = 100\nlength_mm = 100\nthickness_mm = 2\n\
        cracks = [{ from_mm = [10, 7], to_mm = [31.7, 17.5] }, { from_mm = [-10, 7], to_mm = [-31.7, 17.5] }]\n\
        [material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.45\nplane = \"strain\"\n[loading]\nstress_max_mpa = 60\nstress_ratio = 0\n\
        [fatigue]\nparis_c_mm_per_cycle = 1e-9\nparis_m = 3\n";
    let case = Case::from_toml(text, "meet", Path::new(""), &["model.tolerance_percent=1".to_owned()]).unwrap();
    let run = predict(&case, &Silent).unwrap();
    assert!((run.life_cycles() / 1.616e6 - 1.0).abs() < 0.01, "{} {:?}", run.life_cycles(), run.stop);
}
