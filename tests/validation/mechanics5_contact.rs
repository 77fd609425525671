//! Contact that does not follow the load in proportion, against finite elements with contact of others (`../shared/data/field/mechanics5`): residual
//! stress that presses flanks, pins with clearance; and spectra beside constant amplitude.

use std::fs;

use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, Silent, error_estimate::error_estimate, predict};

use crate::support::shared::shared;

fn run(name: &str, set: &[String]) -> Option<(Case, Prediction)> {
    let case = Case::from_file(&shared(&format!("field/mechanics5/{name}.toml"))?, set).unwrap();
    let run = predict(&case, &Silent).unwrap();
    Some((case, run))
}

/// File, K_I at the largest and at the least load, MPa√m, and life; NaN where none is known. R_eff is that of K_eq: K_II of the lug, which the
/// table has not at the least load, raises it by 0.006. K by elements halved 0.3 %, lives 1 to 2 %. That of
/// the cold-worked hole has flanks at its mouth that overlap at the least load, which makes it 2.6 % shorter; points agree with nodes on that K_min.
const ENDS: [(&str, [f64; 2], f64, f64); 5] = [
    ("residual_with_contact/peened_edge", [5.740, 1.405], 2_203_000.0, 0.015),
    ("residual_with_contact/pressed_middle", [7.99, 0.70], 1_632_000.0, 0.02),
    ("residual_with_contact/pressed_middle_r5", [7.99, 3.80], 4_466_500.0, 0.015),
    ("residual_with_contact/guard_cold_hole", [f64::NAN; 2], 202_624.0, 0.03),
    ("pin_load_ratio/lug_r5", [16.336, 8.588], f64::NAN, 0.0),
];

#[test]
fn both_ends_of_a_cycle_have_their_own_contact() {
    for (name, ends, life, bound) in ENDS {
        let Some((case, run)) = run(name, &[]) else { return };
        let first = &run.curve[0];
        let [k_i, k_ii] = first.tips[0].factors.unwrap().map(|k| k / 1e6);
        let ratio = first.response.ratio(case.loading.ratio);
        let stated = error_estimate(&case, &run).unwrap().life_percent;
        println!("{name}: {k_i:.3}, {k_ii:.3}, R_eff {ratio:.4}, life {:.0}, at most {stated:.1} %", run.life_cycles());
        if ends[0].is_finite() {
            assert!((k_i / ends[0] - 1.0).abs() < 0.008 && (ratio - ends[1] / ends[0]).abs() < 0.008, "{name}: {k_i}, {ratio}");
        }
        if life.is_finite() {
            assert!((run.life_cycles() / life - 1.0).abs() < bound, "{name}: {}", run.life_cycles());
        }
        assert!(stated < 4.0, "{name}: {stated}");
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
