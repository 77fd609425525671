//! The error that is stated with a life is above the one it has; `perilife verify estimates` has more plates and tolerances.

use crate::support::plates::pulled_plate;
use perilife_growth::predict::error_estimate::error_estimate;
use perilife_growth::predict::{Silent, predict};
use perilife_study::cases::{AUTO, POINTS, Reference, case, compare, largest};

#[test]
fn a_life_is_within_the_error_that_is_stated() {
    for (name, model) in [("slant_severance", AUTO), ("hole_attracts", AUTO), ("slant_severance", POINTS)] {
        let reference = Reference::named(name).unwrap();
        let case = reference.case(&[model.to_owned()]).unwrap();
        let run = predict(&case, &Silent).unwrap();
        let stated = error_estimate(&case, &run).unwrap();
        let tips = compare(&run, reference.tips().unwrap(), f64::INFINITY);
        let off = largest(tips.iter().flat_map(|tip| tip.cycles)).abs();
        let path = tips.iter().map(|tip| tip.rms).fold(0.0, f64::max);
        println!(
            "{name} by {}: {off:.2} of {:.2} %, path {:.3} of {:.3} mm",
            case.model.method(),
            stated.life_percent,
            1e3 * path,
            1e3 * stated.path
        );
        assert!(off < stated.life_percent && path < stated.path, "{name}");
        // A bound that is far above says nothing.
        assert!(stated.life_percent < 3.0, "{name}: {stated:?}");
    }
}

/// A ligament between holes is what coarse nodes are worst at: the life errs by 1.6 %, and more is stated than of other plates.
#[test]
fn a_coarse_run_states_a_large_error() {
    let reference = Reference::named("double_edge_notched").unwrap();
    let coarse = reference.case(&[AUTO.to_owned(), "model.tolerance_percent=5".to_owned()]).unwrap();
    let run = predict(&coarse, &Silent).unwrap();
    let stated = error_estimate(&coarse, &run).unwrap().life_percent;
    let tips = compare(&run, reference.tips().unwrap(), f64::INFINITY);
    let off = largest(tips.iter().flat_map(|tip| tip.cycles)).abs();
    println!("{off:.2} of {stated:.2} %");
    assert!(off > 1.0 && off < stated && stated < 4.0, "{off} of {stated}");
}

/// Bonds that fail by their own strain have no error that a finer lattice would tell.
#[test]
fn nothing_is_stated_of_bonds() {
    let case = Reference::named("slant_severance")
        .unwrap()
        .case(&["fatigue.driver=bond_strain".to_owned(), "stop.cycles_max=1".to_owned()]);
    let case = case.unwrap();
    let run = predict(&case, &Silent).unwrap();
    assert!(error_estimate(&case, &run).unwrap_err().contains("own strain"));
}

/// A crack that passes a hole at 0.03 mm hardly grows behind its rim: finite elements with steps of 0.004 mm give 1.04 million cycles, nodes 0.81 to 0.96
/// by how fine they are. The gap is less than what the path is known to.
#[test]
#[ignore = "long: ten seconds"]
fn nothing_is_stated_of_a_crack_that_grazes_a_hole() {
    let text = pulled_plate(
        "width_mm = 80\nlength_mm = 160\n\
         holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 14 }, { x_mm = -24, y_mm = 2, diameter_mm = 10 }, { x_mm = 24, y_mm = 5, diameter_mm = 8 }]\n\
         cracks = [{ from_mm = [7, 0], to_mm = [10, 0] }]",
    );
    let case = case(&text, &format!("loading.stress_max_mpa=60 stop.crack_length_mm=22 {AUTO}")).unwrap();
    let run = predict(&case, &Silent).unwrap();
    let why = error_estimate(&case, &run).unwrap_err();
    println!("{why}");
    assert!(why.contains("passes an edge"), "{why}");
}
