//! Cases of method `handbook`: which law they take, and what is refused.

use std::path::Path;

use perilife_growth::case::{Case, LawSource, Method};
use perilife_plate::specimen::SpecimenKind;

use crate::support::hand_cases::{ALL, PANEL, hand_case, try_hand_case};
use crate::support::made_up_case::fitted;

#[test]
fn the_method_is_a_kind_and_peridynamics_the_default() {
    let case = hand_case(PANEL, &[]);
    assert_eq!(case.model.method(), Method::Handbook);
    assert!(matches!(case.law, LawSource::Paris(law) if (law.c - 8.95422e-11).abs() < 1e-24 && law.m == 2.874));
    assert!(case.warnings.is_empty(), "{:?}", case.warnings);
    // C and m serve bonds as well.
    for driver in ["fatigue.driver=bond_strain", "fatigue.driver=tip_field"] {
        assert!(matches!(hand_case(PANEL, &["model.method=peridynamics", driver]).law, LawSource::Paris(_)), "{driver}");
    }
}

#[test]
fn a_wrong_law_is_refused_with_the_right_one() {
    let bonds = ["fatigue.a=6450", "fatigue.p=2.86", "fatigue.horizon_mm=3"];
    let only_bonds = |text: &str| text.replace("paris_c_mm_per_cycle = 1e-7\nparis_m = 3\n", "");
    let text = format!(
        "[specimen]\n{PANEL}[loading]\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n[material]\nname = \"al2024-t3\"\n\
         [model]\nmethod = \"handbook\"\n[fatigue]\nparis_c_mm_per_cycle = 1e-7\nparis_m = 3\n"
    );
    let read = |text: &str, set: &[&str]| {
        let set: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
        Case::from_toml(text, "hand", Path::new("."), &set)
    };
    let rows: [(String, Vec<&str>, &[&str]); 6] = [
        // What one kind of law means for the other is known for usual exponents.
        (
            only_bonds(&text),
            [&bonds[..], &["fatigue.p=9"]].concat(),
            &["fatigue.p = 9", "1 to 8", "paris_c_mm_per_cycle and paris_m"],
        ),
        (
            text.clone(),
            vec!["model.method=peridynamics", "fatigue.driver=bond_strain", "fatigue.paris_m=8.5"],
            &["fatigue.paris_m = 8.5", "1 to 8"],
        ),
        (text.replace("paris_m = 3\n", ""), vec![], &["fatigue.paris_m", "missing", "together"]),
        (text.clone(), vec!["fatigue.fitted=fitted.toml"], &["fatigue.paris_c_mm_per_cycle", "conflicts with fatigue.fitted"]),
        (only_bonds(&text), vec![], &["fatigue.fitted", "no fatigue law", "paris_c_mm_per_cycle and paris_m"]),
        (text.clone(), vec!["fatigue.paris_c_mm_per_cycle=-1"], &["fatigue.paris_c_mm_per_cycle", "above zero"]),
    ];
    for (text, set, words) in rows {
        let error = read(&text, &set).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        words.iter().for_each(|word| assert!(error.to_string().contains(word), "{word} in {error}"));
    }
}

/// Kinds and shapes without a formula are refused, each with what helps.
#[test]
fn only_specimens_of_the_handbook_are_taken() {
    let covered: Vec<SpecimenKind> = ALL.iter().map(|specimen| hand_case(specimen, &[]).specimen.kind).collect();
    for kind in SpecimenKind::ALL {
        assert!(covered.contains(kind) || kind.is_plate() || kind.part_through().is_some(), "{kind} is new: has it a formula?");
    }
    let plate =
        "kind = \"plate\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\ncracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]\n";
    let clamped = ALL[1].replace("uniform_stress", "clamped");
    for (specimen, set) in [(plate, ""), (clamped.as_str(), ""), (PANEL, "specimen.length_mm=160")] {
        let set: Vec<&str> = [set].into_iter().filter(|set| !set.is_empty()).collect();
        let error = try_hand_case(specimen, &set).unwrap_err();
        for words in ["model.method = \"handbook\"", "no K(a)", "remove it (nodes find K)", "compact_tension"] {
            assert!(error.to_string().contains(words), "{words} in {error}");
        }
        assert_eq!(error.exit_code(), 2);
    }
    // What stops bonds does not stop hand calculation: steep Poisson's ratio, a crack shorter than any spacing would resolve.
    hand_case(PANEL, &["material.poisson_ratio=0.45", "specimen.crack_length_mm=0.01"]);
}

#[test]
fn a_record_gives_c_and_m_whatever_bonds_it_was_fitted_with() {
    let LawSource::Fitted(record) = fitted(8.0, 25.0) else { unreachable!("it is a record") };
    let set = ["loading.stress_ratio=0.1", "material.youngs_modulus_gpa=100"];
    let law = |set: &[&str]| hand_case(PANEL, set).with_law((*record).clone()).map(|case| case.paris_law().unwrap());
    let at_its_ratio = law(&set).unwrap();
    assert!((at_its_ratio.c / 1e-11 - 1.0).abs() < 1e-12 && at_its_ratio.m == 3.0, "C does not depend on E");
    let error = law(&["loading.stress_ratio=0.3"]).unwrap_err().to_string();
    assert!(error.contains("loading.stress_ratio = 0.3") && error.contains("walker_gamma"), "{error}");
    // At the ratio of the record the rate is that of the record, whatever γ: C_γ (1-R)^(γ m) = C (1-R)^m.
    let walker = law(&["loading.stress_ratio=0.1", "fatigue.walker_gamma=0.5"]).unwrap();
    assert!((walker.c * 0.9_f64.powf(1.5) / (1e-11 * 0.9_f64.powi(3)) - 1.0).abs() < 1e-12);
    // A record of hand calculation has no A for bonds.
    let mut by_hand = (*record).clone();
    (by_hand.method, by_hand.a, by_hand.horizon_mm, by_hand.rate_constant) = ("handbook".to_owned(), f64::NAN, f64::NAN, None);
    hand_case(PANEL, &set).with_law(by_hand.clone()).unwrap();
    let bonds = ["model.method=peridynamics", "fatigue.driver=bond_strain"];
    let error = hand_case(PANEL, &[&bonds[..], &set].concat()).with_law(by_hand).unwrap_err().to_string();
    assert!(error.contains("no bond constant A") && error.contains("driver = \"tip_field\""), "{error}");
}
