//! Contact that does not follow the load in proportion, against finite elements with contact of others (`../shared/data/field/mechanics5`): residual
//! stress that presses flanks, pins with clearance; and spectra beside constant amplitude.

use std::fs;

use perilife_base::units::MPA_SQRT_M;
use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::cracks::steering::{equivalent_factor, factor_across, kink_angle};
use perilife_growth::nodes::NodePlate;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::{Prediction, Silent, error_estimate::error_estimate, predict};

use crate::support::shared::shared;

fn run(name: &str, set: &[String]) -> Option<(Case, Prediction)> {
    let case = Case::from_file(&shared(&format!("field/mechanics5/{name}.toml"))?, set).unwrap();
    let run = predict(&case, &Silent).unwrap();
    Some((case, run))
}

/// File, K_I at the largest and at the least load, MPa√m, and life with its bound. K by elements halved 0.3 %, lives 1 to 2 %.
const ENDS: [(&str, [f64; 2], f64, f64); 3] = [
    ("residual_with_contact/peened_edge", [5.740, 1.405], 2_203_000.0, 0.01),
    ("residual_with_contact/pressed_middle", [7.99, 0.70], 1_632_000.0, 0.015),
    ("residual_with_contact/pressed_middle_r5", [7.99, 3.80], 4_466_500.0, 0.01),
];

#[test]
fn both_ends_of_a_cycle_have_their_own_contact() {
    for (name, [largest, least], life, bound) in ENDS {
        let Some((case, run)) = run(name, &[]) else { return };
        let first = &run.curve[0];
        let (k_i, ratio) = (first.tips[0].factors.unwrap()[0] / MPA_SQRT_M, first.response.ratio(case.loading.ratio));
        let stated = error_estimate(&case, &run).unwrap().life_percent;
        println!("{name}: {k_i:.3}, R_eff {ratio:.4}, life {:.0}, at most {stated:.1} %", run.life_cycles());
        assert!((k_i / largest - 1.0).abs() < 0.006 && (ratio - least / largest).abs() < 0.003, "{name}: {k_i}, {ratio}");
        assert!((run.life_cycles() / life - 1.0).abs() < bound && stated < 3.0, "{name}: {}, {stated}", run.life_cycles());
    }
}

/// A pin with clearance: K_I at both ends, and R_eff of K_eq from them, in the direction that the largest load gives the crack.
#[test]
fn a_pin_with_clearance_has_its_own_contact_at_both_ends() {
    let name = "pin_load_ratio/lug_r5";
    let Some((case, run)) = run(name, &[]) else { return };
    let of = |force: f64| {
        let set = [format!("loading.force_max_n={force}"), "model.method=element_free_galerkin".to_owned()];
        let case = Case::from_file(&shared(&format!("field/mechanics5/{name}.toml")).unwrap(), &set).unwrap();
        initial_tips::<NodePlate>(&case).unwrap().tips[0].factors.unwrap().map(|k| k / MPA_SQRT_M)
    };
    let [largest, least] = [1e4, 5e3].map(of);
    println!("{largest:?}, {least:?}, {}", run.curve[0].response.ratio(case.loading.ratio));
    assert!((largest[0] / 16.336 - 1.0).abs() < 0.002 && (least[0] / 8.588 - 1.0).abs() < 0.002, "{largest:?}, {least:?}");
    let right = factor_across(least, kink_angle(largest)) / equivalent_factor(largest);
    assert!((run.curve[0].response.ratio(case.loading.ratio) - right).abs() < 0.001, "{right}");
}

/// Cold-worked hole, whose mouths close at the least load: K at 12 MPa is that of points, which take contact another way, and not that of flanks
/// that overlap, 0.35 and 1.2 MPa√m.
#[test]
fn mouths_that_close_hold_a_crack_open() {
    let Some(path) = shared("field/mechanics5/residual_with_contact/guard_cold_hole.toml") else { return };
    for end in [7.3, 10.0] {
        let cracks = format!(
            "specimen.cracks=[{{ from_mm = [4.0, 0.0], to_mm = [{end}, 0.0] }}, {{ from_mm = [-4.0, 0.0], to_mm = [-{end}, 0.0] }}]"
        );
        let of = |method: &str| {
            let set = [cracks.clone(), "loading.stress_max_mpa=12".to_owned(), format!("model.method={method}")];
            Case::from_file(&path, &set).unwrap()
        };
        let [nodes, points] = [
            initial_tips::<NodePlate>(&of("element_free_galerkin")).unwrap(),
            initial_tips::<PointPlate>(&of("peridynamics")).unwrap(),
        ]
        .map(|found| (found.tips[0].factors.unwrap()[0] / MPA_SQRT_M, found.in_contact));
        println!("{end} mm: {nodes:?}, {points:?}");
        assert!(nodes.1 && points.1 && (nodes.0 / points.0 - 1.0).abs() < 0.015, "{end} mm: {nodes:?}, {points:?}");
    }
}

/// A spectrum of cycles of one kind is constant amplitude, with contact that changes from one end to the other as well.
#[test]
fn a_spectrum_of_equal_cycles_is_constant_amplitude() {
    let folder = tempfile::tempdir().unwrap();
    for (name, method, load, ratio) in [
        ("residual_with_contact/pressed_middle_r5", "element_free_galerkin", "stress_max_mpa = 40.0", 0.5),
        ("residual_with_contact/pressed_middle_r5", "peridynamics", "stress_max_mpa = 40.0", 0.5),
        ("pin_load_ratio/lug_r5", "element_free_galerkin", "force_max_n = 10000.0", 0.5),
    ] {
        let set = [format!("model.method={method}")];
        let Some((_, of_cycles)) = run(name, &set) else { return };
        let text = fs::read_to_string(shared(&format!("field/mechanics5/{name}.toml")).unwrap()).unwrap();
        let scale = load.replace("stress_max_mpa", "spectrum_scale_mpa").replace("force_max_n", "spectrum_scale_n");
        let of_spectrum = text
            .replace(load, &format!("kind = \"spectrum\"\nspectrum_file = \"one.csv\"\n{scale}"))
            .lines()
            .filter(|line| !line.starts_with("stress_ratio"))
            .collect::<Vec<_>>()
            .join("\n");
        fs::write(folder.path().join("one.csv"), format!("max,min,count\n1,{ratio},10\n")).unwrap();
        let path = folder.path().join("case.toml");
        fs::write(&path, of_spectrum).unwrap();
        let spectrum = predict(&Case::from_file(&path, &set).unwrap(), &Silent).unwrap();
        let off = spectrum.life_cycles() / of_cycles.life_cycles() - 1.0;
        println!("{name}, {method}: {:.1}, {:.1}: {off:+.2e}", spectrum.life_cycles(), of_cycles.life_cycles());
        assert!(off.abs() < 1e-3, "{name}, {method}: {off}");
    }
}
