//! Lives on recorded K(a) beside runs of their own: no figure here comes from anywhere but the program's quadrature over K of a handbook.

use perilife_base::input::Folder;
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_growth::case::{Case, LawSource};
use perilife_growth::predict::laws::growth_law;
use perilife_growth::predict::recorded::{Change, Recorded};
use perilife_growth::predict::{Prediction, Silent, StopReason, predict};
use perilife_laws::paris::ParisLaw;

use crate::support::hand_cases::{ALL, PANEL, hand_case};

fn run(case: &Case) -> (Prediction, Recorded) {
    let done = predict(case, &Silent).unwrap();
    let recorded = Recorded::of(case, &done).unwrap();
    (done, recorded)
}

fn is_near(found: f64, wanted: f64, share: f64, what: &str) {
    assert!((found / wanted - 1.0).abs() < share, "{what}: {found} beside {wanted}");
}

/// Loads of Paris: `N(f) = N f^-m`; another exponent and initial length, shorter ones too, beside a run by them.
#[test]
fn another_law_load_and_length_give_the_life_of_a_run_by_them() {
    for specimen in ALL {
        let case = hand_case(specimen, &[]);
        let (done, recorded) = run(&case);
        let (law, own, life) = (growth_law(&case).unwrap(), recorded.unchanged(), done.life_cycles());
        is_near(recorded.life(&*law, own).cycles, life, 1e-10, specimen);
        assert!(recorded.misfit() < 1e-4, "{specimen}: {}", recorded.misfit());
        let doubled = recorded.life(&*law, Change { load: 2.0, ..own });
        is_near(doubled.cycles, life * 2.0_f64.powf(-2.874), 1e-10, specimen);
        assert_eq!((doubled.stop, doubled.is_bound), (done.stop, false));

        let mut steeper = case.clone();
        steeper.law = LawSource::Paris(ParisLaw { c: 1e-11, m: 3.6 });
        let wanted = run(&steeper).0.life_cycles();
        is_near(recorded.life(&*growth_law(&steeper).unwrap(), own).cycles, wanted, 1e-4, specimen);
        for factor in [0.9, 0.95, 1.1, 1.3] {
            let length = own.crack_length * factor;
            let mut other = case.clone();
            other.specimen.crack_length = length;
            let wanted = run(&other).0.life_cycles();
            let found = recorded.life(&*law, Change { crack_length: length, ..own });
            is_near(found.cycles, wanted, 1e-4, &format!("{specimen} x {factor}"));
            assert!(!found.is_clipped);
        }
    }
}

/// Shorter cracks are retarded as the run is once its first overload has come, whether that is early or late in a pass, or rare.
#[test]
fn shorter_cracks_are_retarded_whenever_the_first_overload_comes() {
    for cycles in ["110,6,1\n60,6,4000\n", "60,6,4000\n110,6,1\n", "60,6,400\n110,6,0.1\n"] {
        let case = |length: f64| {
            let text = format!(
                "[specimen]\n{}[material]\nyoungs_modulus_gpa = 72\npoisson_ratio = 0.33\nyield_strength_mpa = 345\n\
                 [loading]\nkind = \"spectrum\"\nspectrum_file = \"s.csv\"\nspectrum_scale_mpa = 1\nretardation = \"wheeler\"\n\
                 wheeler_exponent = 1.2\n[model]\nmethod = \"handbook\"\n[fatigue]\ngrowth_law = \"walker\"\n\
                 paris_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874\nwalker_gamma = 0.6\n\
                 [stop]\ncrack_length_mm = 30\ntoughness = false\nnet_section = false\n",
                PANEL.replace("crack_length_mm = 9", &format!("crack_length_mm = {length}"))
            );
            let folder = Folder::at_hand([("s.csv".to_owned(), format!("max,min,cycles\n{cycles}").into_bytes())]);
            Case::from_toml(&text, "retarded", folder, &[]).unwrap()
        };
        let (done, recorded) = run(&case(9.0));
        let (law, own) = (growth_law(&case(9.0)).unwrap(), recorded.unchanged());
        is_near(recorded.life(&*law, own).cycles, done.life_cycles(), 1e-6, cycles);
        for length in [8.1, 6.0] {
            let found = recorded.life(&*law, Change { crack_length: length * MM, ..own });
            is_near(found.cycles, run(&case(length)).0.life_cycles(), 0.02, &format!("{cycles}{length} mm"));
        }
    }
}

#[test]
fn a_larger_load_and_a_lower_toughness_end_the_life_sooner_on_the_curve() {
    let keys = ["material.toughness_mpa_sqrt_m=40", "material.yield_strength_mpa=345"];
    let case = hand_case(PANEL, &keys);
    let (done, recorded) = run(&case);
    assert_eq!(done.stop, StopReason::Toughness);
    let (law, own) = (growth_law(&case).unwrap(), recorded.unchanged());
    let loaded = run(&hand_case(PANEL, &[&keys[..], &["loading.stress_range_mpa=57.936"]].concat())).0;
    let found = recorded.life(&*law, Change { load: 1.2, ..own });
    is_near(found.cycles, loaded.life_cycles(), 1e-4, "load x 1.2");
    assert_eq!((found.stop, loaded.stop), (StopReason::Toughness, StopReason::Toughness));
    let brittle = run(&hand_case(PANEL, &["material.toughness_mpa_sqrt_m=20", keys[1]])).0;
    is_near(recorded.life(&*law, Change { toughness: 0.5, ..own }).cycles, brittle.life_cycles(), 1e-4, "half the toughness");
    // Three times the load reaches yield of the section on the curve; toughness is taken out of the way.
    let yields = recorded.life(&*law, Change { load: 3.0, toughness: 100.0, ..own });
    assert_eq!(yields.stop, StopReason::NetSectionYield);
}

#[test]
fn what_stands_still_is_cut_off_or_is_too_short_is_told() {
    let case = hand_case(PANEL, &["stop.crack_length_mm=40", "stop.cycles_max=1e6"]);
    let (_, recorded) = run(&case);
    let (law, own) = (growth_law(&case).unwrap(), recorded.unchanged());
    let mut still = case.clone();
    still.fatigue.threshold = 9.0 * MPA_SQRT_M;
    let life = recorded.life(&*growth_law(&still).unwrap(), own);
    assert_eq!((life.cycles, life.stop, life.is_bound), (f64::INFINITY, StopReason::NothingAges, false));
    let slow = recorded.life(&*law, Change { load: 0.4, ..own });
    assert_eq!((slow.cycles, slow.stop, slow.is_bound), (1e6, StopReason::RunOut, true));
    let [shortest, longest] = recorded.lengths();
    let short = recorded.life(&*law, Change { crack_length: 0.5 * shortest, load: 2.0, ..own });
    let least = recorded.life(&*law, Change { crack_length: shortest, load: 2.0, ..own });
    assert!(short.is_clipped && short.is_bound && !least.is_clipped && short.cycles == least.cycles, "{short:?} {least:?}");
    assert_eq!(recorded.life(&*law, Change { crack_length: longest + MM, ..own }).cycles, 0.0);
}

/// One tip on nodes: its path is the same whatever the exponent, and so is its K(a).
#[test]
fn the_k_of_a_run_on_nodes_serves_other_laws() {
    let keys = ["model.method=element_free_galerkin", "stop.crack_length_mm=20"];
    let case = hand_case(ALL[1], &keys);
    let (done, recorded) = run(&case);
    let own = recorded.unchanged();
    is_near(recorded.life(&*growth_law(&case).unwrap(), own).cycles, done.life_cycles(), 1e-10, "nodes");
    assert!(recorded.misfit() < 5e-3, "{}", recorded.misfit());
    let mut steeper = case.clone();
    steeper.law = LawSource::Paris(ParisLaw { c: 1e-11, m: 3.6 });
    let wanted = run(&steeper).0.life_cycles();
    // Steps of the runs differ, each within the bound of its error.
    is_near(recorded.life(&*growth_law(&steeper).unwrap(), own).cycles, wanted, 5e-3, "nodes, steeper");
}
