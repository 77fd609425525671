//! Handbook K against printed and independently checked numbers, and cases by hand calculation.

use std::f64::consts::PI;
use std::path::Path;

use perilife_growth::case::{Case, LawSource, Method};
use perilife_plate::specimen::handbook::{delta_k, handbook, handbook_tada};
use perilife_plate::specimen::{Specimen, SpecimenKind};

use crate::support::hand_cases::{ALL, PANEL, hand_case, try_hand_case};
use crate::support::made_up_case::fitted;
use crate::support::rows::{assert_refusal, assert_says};

// Handbook K against printed and independently checked numbers.

/// A specimen of this kind, width 100 mm, thickness 2 mm, relative length set by `crack_mm`.
fn specimen(kind: &str, crack_mm: f64, extra: &str) -> Specimen {
    let length = if kind == "compact_tension" { "" } else { "length_mm = 300.0" };
    let load = if kind == "compact_tension" { "force_max_kn = 2" } else { "stress_max_mpa = 10" };
    let text = format!(
        "[specimen]\nkind = \"{kind}\"\nwidth_mm = 100.0\n{length}\nthickness_mm = 2.0\ncrack_length_mm = {crack_mm}\n{extra}\n\
         [material]\nname = \"al2024-t3\"\n[loading]\n{load}\nstress_ratio = 0\n[fatigue]\na = 1\np = 2\nhorizon_mm = 1"
    );
    Case::from_toml(&text, "test", Path::new(""), &[]).unwrap().specimen
}

const UNIFORM: &str = "ends = \"uniform_stress\"";

#[test]
fn factors_agree_with_references() {
    // (kind, crack mm at W 100 mm, factor, relative tolerance, origin of the number)
    let rows = [
        ("middle_tension", 25.0, 1.186, 0.005, "Tada 1.186, FEM 1.184 at 2a/W 0.5"),
        ("single_edge_tension", 20.0, 1.367, 0.005, "polynomial of Brown and Srawley 1.367, FEM 1.360 at a/W 0.2"),
        ("single_edge_tension", 50.0, 2.827, 0.005, "Tada 2.827, FEM 2.811 at a/W 0.5"),
        ("double_edge_tension", 20.0, 1.130, 0.005, "FEM 1.130 at 2a/W 0.4"),
        ("double_edge_tension", 30.0, 1.234, 0.008, "FEM 1.234 at 2a/W 0.6"),
        ("compact_tension", 50.0, 9.659, 2e-4, "ASTM E647 at a/W 0.5"),
        ("compact_tension", 60.0, 13.654, 2e-4, "ASTM E647 at a/W 0.6"),
    ];
    for (kind, crack, expected, tolerance, origin) in rows {
        let plate = specimen(kind, crack, if kind.starts_with("single") { UNIFORM } else { "" });
        let factor = handbook(&plate).unwrap().factor(crack * 1e-3);
        assert!((factor / expected - 1.0).abs() < tolerance, "{kind} at {crack} mm: {factor}, expected {expected} ({origin})");
    }
    // Feddersen and Tada are 2 % apart at 2a/W = 0.9, Feddersen low.
    let plate = specimen("middle_tension", 45.0, "");
    let ratio = handbook(&plate).unwrap().factor(0.045) / handbook_tada(&plate).unwrap().factor(0.045);
    assert!((ratio - 0.98).abs() < 0.005, "{ratio}");
}

#[test]
fn k_has_the_right_scale() {
    // Short central crack in a wide plate: K = sigma sqrt(pi a) to 0.1 %.
    let plate = specimen("middle_tension", 1.5, "");
    let formula = handbook(&plate).unwrap();
    let k = formula.k_i(1.5e-3, 100e6);
    assert!((k / (100e6 * (PI * 1.5e-3).sqrt()) - 1.0).abs() < 1e-3);
    // Compact: K = P f / (B sqrt W).
    let compact = specimen("compact_tension", 50.0, "");
    let k = handbook(&compact).unwrap().k_i(0.05, 2000.0);
    let expected = 2000.0 / (0.002 * 0.1_f64.sqrt()) * 9.659;
    assert!((k / expected - 1.0).abs() < 2e-4, "{k} {expected}");
    assert!((delta_k(&compact, 0.05, 2000.0, 0.8).unwrap() / (0.8 * k) - 1.0).abs() < 1e-12);
    assert!(formula.k_i(0.06, 1.0).is_nan(), "a crack beyond the half width has no K");
}

#[test]
fn grows_with_crack_length() {
    for kind in ["middle_tension", "single_edge_tension", "double_edge_tension", "compact_tension"] {
        let plate = specimen(kind, 20.0, if kind.starts_with("single") { UNIFORM } else { "" });
        let formula = handbook(&plate).unwrap();
        let values: Vec<f64> = (4..9).map(|i| formula.k_i(f64::from(i) * 5e-3, 1e6)).collect();
        assert!(values.windows(2).all(|pair| pair[1] > pair[0]), "{kind}: {values:?}");
    }
}

#[test]
fn no_formula_where_none_holds() {
    assert!(handbook(&specimen("single_edge_tension", 20.0, "ends = \"clamped\"")).is_none());
    assert!(handbook(&specimen("single_edge_tension", 20.0, "ends = \"pinned\"")).is_some());
    let mut short = specimen("middle_tension", 20.0, "");
    short.outline = vec![[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]];
    assert!(handbook(&short).is_none(), "a square plate is not a long strip");
    let compact = specimen("compact_tension", 20.0, "");
    let formula = handbook(&compact).unwrap();
    assert!(!formula.holds_at(0.01), "E647 starts at a/W 0.2");
    assert!(formula.holds_at(compact.crack_length), "20 mm of 100 mm, though 0.02 / 0.1 is a rounding less than 0.2");
}

#[test]
fn net_section_carries_the_load() {
    let stress = |kind: &str, extra| specimen(kind, 20.0, extra).net_section_stress(0.02, 60e6).unwrap() / 60e6;
    assert!((stress("middle_tension", "") - 100.0 / 60.0).abs() < 1e-9);
    assert!((stress("double_edge_tension", "") - 100.0 / 60.0).abs() < 1e-9);
    assert!((stress("single_edge_tension", "ends = \"clamped\"") - 100.0 / 80.0).abs() < 1e-9);
    assert_eq!(specimen("middle_tension", 20.0, "").net_section_stress(0.05, 1.0), Some(f64::INFINITY));
    // Clamped ends take the bending, free ones do not: less load is borne.
    assert!(stress("single_edge_tension", UNIFORM) > 100.0 / 80.0);
}

/// A section that yields throughout: +σ_Y from the crack to some depth, -σ_Y beyond it. The forces add up to the load and have no
/// moment about its line; the depth is found by halving.
#[test]
fn a_section_bent_by_its_load_is_in_equilibrium_when_it_yields() {
    // (specimen, W mm, place of the load line from the crack's mouth mm, load per Pa or N in N per mm thickness and MPa)
    for (kind, extra, line) in [("single_edge_tension", UNIFORM, 50.0), ("compact_tension", "", 0.0)] {
        for a in [20.0, 40.0, 60.0, 80.0] {
            let plate = specimen(kind, a, extra);
            let moment = |turn: f64| {
                let about = |from: f64, to: f64| 0.5 * ((to - line).powi(2) - (from - line).powi(2));
                about(a, turn) - about(turn, 100.0)
            };
            let (mut low, mut high) = (a, 100.0);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                if moment(middle) < 0.0 { low = middle } else { high = middle }
            }
            // Force per mm of thickness at 1 MPa: N/mm. As a gross stress over 100 mm, or a force on 2 mm.
            let force = (low - a) - (100.0 - low);
            let load = if kind == "compact_tension" { 2.0 * force } else { force / 100.0 * 1e6 };
            let stress = plate.net_section_stress(a * 1e-3, load).unwrap();
            assert!((stress / 1e6 - 1.0).abs() < 1e-9, "{kind} at {a} mm: {stress}");
        }
    }
}

// Cases of method `handbook`: which law they take, and what is refused.

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
    let steep = [&bonds[..], &["fatigue.p=9"]].concat();
    let of_bonds = vec!["model.method=peridynamics", "fatigue.driver=bond_strain", "fatigue.paris_m=8.5"];
    let rows: [(String, Vec<&str>, &[&str]); 6] = [
        // What one kind of law means for the other is known for usual exponents.
        (only_bonds(&text), steep, &["fatigue.p = 9", "1 to 8", "paris_c_mm_per_cycle and paris_m"]),
        (text.clone(), of_bonds, &["fatigue.paris_m = 8.5", "1 to 8"]),
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
        let said = error.to_string();
        assert_says(&said, &["model.method = \"handbook\"", "no K(a)", "remove it (nodes find K)", "compact_tension"]);
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
    assert_refusal(law(&["loading.stress_ratio=0.3"]), &["loading.stress_ratio = 0.3", "walker_gamma"]);
    // At the ratio of the record the rate is that of the record, whatever γ: C_γ (1-R)^(γ m) = C (1-R)^m.
    let walker = law(&["loading.stress_ratio=0.1", "fatigue.walker_gamma=0.5"]).unwrap();
    assert!((walker.c * 0.9_f64.powf(1.5) / (1e-11 * 0.9_f64.powi(3)) - 1.0).abs() < 1e-12);
    // A record of hand calculation has no A for bonds.
    let mut by_hand = (*record).clone();
    (by_hand.method, by_hand.a, by_hand.horizon_mm, by_hand.rate_constant) = ("handbook".to_owned(), f64::NAN, f64::NAN, None);
    hand_case(PANEL, &set).with_law(by_hand.clone()).unwrap();
    let bonds = ["model.method=peridynamics", "fatigue.driver=bond_strain"];
    let refused = hand_case(PANEL, &[&bonds[..], &set].concat()).with_law(by_hand);
    assert_refusal(refused, &["no bond constant A", "driver = \"tip_field\""]);
}
