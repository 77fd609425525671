//! Checks of a life: status, effect, direction, verdict.

use std::path::Path;

use perilife_base::input::Folder;
use perilife_growth::case::Case;
use perilife_growth::predict::judgement::{judge, refusal, refuse_beforehand};
use perilife_growth::predict::plastic_zone::{plane_warning, plastic_zone};
use perilife_growth::predict::{Prediction, Silent, StopReason, fit_use, predict};
use perilife_results::checks::{Check, Side, Validity, Verdict, is_bound_below, messages, of_case, of_run, validity, verdict};

use crate::support::hand_cases::{PANEL, hand_case, hand_run, try_hand_case_in};
use crate::support::rows::assert_says;
use crate::support::{made_up_case, made_up_run};

const STRENGTHS: [&str; 2] = ["material.toughness_mpa_sqrt_m=60", "material.yield_strength_mpa=345"];

fn find<'c>(checks: &'c [Check], name: &str) -> &'c Check {
    checks.iter().find(|check| check.name == name).unwrap_or_else(|| panic!("{name} in {checks:?}"))
}

fn named(case: &Case, run: &Prediction, name: &str) -> Check {
    find(&of_run(case, run), name).clone()
}

#[test]
fn strengths_that_are_not_given_are_not_checked() {
    let (case, run) = (hand_case(PANEL, &[]), hand_run(PANEL, &[]));
    let checks = of_run(&case, &run);
    for (name, words) in [("toughness", "no toughness given"), ("ligament", "no yield strength given")] {
        let check = find(&checks, name);
        assert_eq!((check.verdict, check.side), (Verdict::NotChecked, Some(Side::NonConservative)));
        assert!(check.words.contains(words) && check.remedy.as_deref().is_some_and(|remedy| remedy.starts_with("set material")));
    }
    assert_eq!(validity(&checks), Validity::Reservations);
    assert!(verdict(&checks).starts_with("valid with reservations: of "), "{}", verdict(&checks));
    let open = messages(&checks, &["a warning".to_owned()]);
    let subjects: Vec<Option<&str>> = open.iter().map(|message| message.subject.as_deref()).collect();
    // A warning may be of a unit that slipped: it stands before what was not checked.
    let first = |kind: &str| open.iter().position(|message| message.kind == kind).unwrap();
    assert!(subjects.contains(&Some("toughness")) && first("warning") < first("unchecked"), "{subjects:?}");
    assert_eq!(open.len(), 1 + checks.iter().filter(|check| check.verdict != Verdict::Passed).count(), "none is dropped");
    // Given, they hold: the life ends where one is reached.
    let (case, run) = (hand_case(PANEL, &STRENGTHS), hand_run(PANEL, &STRENGTHS));
    let found = named(&case, &run, "ligament").words;
    assert_eq!(found, "Net-section yield: load up to 100 % of the plastic collapse load (100 % ends the life)");
    assert_eq!(named(&case, &run, "toughness").verdict, Verdict::Passed);
    // With a required strength the life ends before.
    let required = [STRENGTHS[0], STRENGTHS[1], "stop.limit_load_factor=1.5"];
    let (case, run) = (hand_case(PANEL, &required), hand_run(PANEL, &required));
    for name in ["ligament", "toughness"] {
        let words = named(&case, &run, name).words;
        assert!(words.ends_with("(67 % ends the life)"), "{words}");
    }
    // Turned off, they are not checked either.
    let off = [STRENGTHS[0], STRENGTHS[1], "stop.toughness=false", "stop.net_section=false"];
    let (case, run) = (hand_case(PANEL, &off), hand_run(PANEL, &off));
    assert_eq!(run.stop, StopReason::Severed);
    for name in ["toughness", "ligament"] {
        let check = named(&case, &run, name);
        assert!(check.verdict == Verdict::NotChecked && check.words.contains("not checked (stop."), "{check:?}");
    }
}

/// A crack on the side that bending presses grows half a cycle later as one on the other side; of a load of one sign it does not.
#[test]
fn a_tip_that_minimum_load_opens_grows() {
    let of = |method: &str, ratio: f64, side: f64| {
        let plate = format!(
            "kind = \"plate\"\nwidth_mm = 60\nlength_mm = 120\nthickness_mm = 2\n\
             cracks = [{{ from_mm = [{}, 0], to_mm = [{}, 0] }}]\n",
            30.0 * side,
            20.0 * side
        );
        let set = [
            &format!("loading.stress_ratio={ratio}"),
            "loading.edge_bending_ratio=pure",
            "stop.crack_length_mm=13",
            &format!("model.method={method}"),
        ];
        let case = try_hand_case_in(&plate, &set, Folder::none()).unwrap();
        predict(&case, &Silent).unwrap()
    };
    for method in ["element_free_galerkin", "peridynamics"] {
        let [pressed, pulled] = [-1.0, 1.0].map(|side| of(method, -1.0, side));
        let off = pressed.life_cycles() / pulled.life_cycles() - 1.0;
        println!("{method}: {:.1}, {:.1}: {off:+.2e}", pressed.life_cycles(), pulled.life_cycles());
        assert!(pulled.life_cycles() > 0.0 && off.abs() < 2e-3, "{method}: {off}");
        assert_eq!(of(method, 0.1, -1.0).stop, StopReason::NothingAges, "{method}");
    }
}

/// A centre crack in pure bending: each tip opens under the load that shuts the other, and has a K of its own though both are of one size.
#[test]
fn tips_that_open_in_turn_are_no_twins() {
    let plate = "kind = \"plate\"\nwidth_mm = 60\nlength_mm = 120\nthickness_mm = 2\n\
                 cracks = [{ from_mm = [-10, 0], to_mm = [10, 0] }]\n";
    let set = ["loading.stress_ratio=-1", "loading.edge_bending_ratio=pure", "model.method=element_free_galerkin"];
    let case = try_hand_case_in(plate, &[&set[..], &["stop.crack_length_mm=24"]].concat(), Folder::none()).unwrap();
    let run = predict(&case, &Silent).unwrap();
    let [left, right] = [0, 1].map(|tip| &run.curve[0].tips[tip]);
    let k = |tip: &perilife_growth::record::TipRecord| tip.factors.unwrap()[0];
    assert!((k(left) / k(right) - 1.0).abs() < 1e-3, "{left:?}, {right:?}");
    let [at_left, at_right] = [left, right].map(|tip| tip.response.at(1.0));
    assert!(at_left < 0.0 && at_right == 1.0, "the largest load opens the right tip: {at_left}, {at_right}");
    assert!(run.warnings.iter().any(|warning| warning.contains("tip 0: K_eq is largest at a lower load")), "{:?}", run.warnings);
}

#[test]
fn extrapolation_has_two_sides() {
    let (mut case, mut run) = (made_up_case::case(), made_up_run::prediction(0.0));
    run.curve.truncate(2);
    for (point, (cycles, delta_k)) in run.curve.iter_mut().zip([(0.0, 10e6), (100.0, 20e6)]) {
        (point.cycles, point.delta_k) = (cycles, delta_k);
    }
    // ΔK rises from 10 to 20 MPa√m: 20 % of the life below, 30 % above.
    case.law = made_up_case::fitted(12.0, 17.0);
    let [below, above] = ["extrapolation_below", "extrapolation_above"].map(|name| named(&case, &run, name));
    assert_eq!((below.verdict, below.side), (Verdict::Caution, Some(Side::Conservative)));
    assert_eq!((above.verdict, above.side), (Verdict::Failed, Some(Side::NonConservative)));
    assert!((below.effect_percent.unwrap() - 20.0).abs() < 0.1 && (above.effect_percent.unwrap() - 30.0).abs() < 0.1);
    assert_eq!(below.words, "Extrapolation: 20.0 % of life at ΔK below 12.00 MPa√m, the lowest tested (usually conservative)");
    assert!(below.remedy.unwrap().contains("threshold_mpa"));
    assert!(above.words.contains("30.0 % of life at ΔK above 17.00 MPa√m"));
    assert_eq!(validity(&of_run(&case, &run)), Validity::NotValid);
    assert_eq!(of_run(&case, &run)[0].name, "extrapolation_above", "what fails comes first");
    // What lies inside has no side.
    let inside = Case { law: made_up_case::fitted(1.0, 90.0), ..case.clone() };
    let words = named(&inside, &run, "extrapolation_above").words;
    assert_eq!(words, "Extrapolation: none above 90.00 MPa√m, the highest tested");
    assert_eq!(refusal(&case, &run).unwrap().exit_code(), 2);
    let words = made_up_run::judged(&case, &run).words(&case, &run);
    assert!(words[0].contains(": no valid life (100 cycles computed; see the failed check)"), "{}", words[0]);
    // All of it on the safe side counts, with a word.
    case.law = made_up_case::fitted(21.0, 30.0);
    assert_eq!(named(&case, &run, "extrapolation_below").verdict, Verdict::Caution);
    assert!(refusal(&case, &run).is_none());
    // A threshold is remedy enough, and the tested specimen itself is within the range.
    case.law = made_up_case::fitted(12.0, 17.0);
    case.fatigue.threshold = 3e6;
    assert!(!named(&case, &run, "extrapolation_below").remedy.unwrap().contains("threshold_mpa"));
    case.law = made_up_case::fitted(10.0, 20.0);
    assert_eq!(named(&case, &run, "extrapolation_below").verdict, Verdict::Passed);
}

#[test]
fn what_the_first_range_of_k_shows_is_refused_before_a_run() {
    // ΔK of the panel is 8.19 MPa√m at the start.
    let mut case = hand_case(PANEL, &[]);
    case.law = made_up_case::fitted(3.0, 8.0);
    let error = refuse_beforehand(&case).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("the first ΔK, 8.19 MPa√m") && error.to_string().contains("3.00 to 8.00"), "{error}");
    assert_eq!(find(&of_case(&case), "extrapolation_above").verdict, Verdict::Failed);
    case.allow_extrapolation = true;
    refuse_beforehand(&case).unwrap();
    case.law = made_up_case::fitted(9.0, 20.0);
    let before = of_case(&case);
    let check = find(&before, "extrapolation_below");
    assert!(check.verdict == Verdict::Caution && check.words.contains("(usually conservative)"), "{check:?}");
}

#[test]
fn a_bound_is_one_where_all_that_could_end_the_life_holds() {
    let mut run =
        hand_run(PANEL, &["material.yield_strength_mpa=345", "material.toughness_mpa_sqrt_m=60", "stop.crack_length_mm=20"]);
    run.stop = StopReason::EnteredHole;
    assert!(is_bound_below(&hand_case(PANEL, &STRENGTHS), &run));
    for one in STRENGTHS {
        assert!(!is_bound_below(&hand_case(PANEL, &[one]), &run), "{one}");
    }
    // At a quarter of the strength small-scale yielding does not hold.
    let weak = hand_case(PANEL, &[STRENGTHS[0], "material.yield_strength_mpa=85"]);
    assert!(!is_bound_below(&weak, &run));
    // A run that was cut off has lived so long.
    run.stop = StopReason::RunOut;
    assert!(is_bound_below(&hand_case(PANEL, &[]), &run));
}

#[test]
fn thickness_and_ratio_are_held_against_those_of_the_law() {
    let mut case = hand_case(PANEL, &[]);
    case.law = made_up_case::fitted(3.0, 80.0);
    let perilife_growth::case::LawSource::Fitted(record) = &mut case.law else { unreachable!() };
    (record.thickness_mm, record.stress_ratio, record.lack_of_fit_percent) = (1.0, 0.2, Some(12.0));
    let checks = of_case(&case);
    assert!(find(&checks, "thickness").words.contains("2.54 mm; law tested on 1.00 mm"));
    assert_eq!((find(&checks, "thickness").verdict, find(&checks, "stress_ratio").verdict), (Verdict::Caution, Verdict::Passed));
    let fit = find(&checks, "lack_of_fit");
    assert_eq!((fit.verdict, fit.side, fit.effect_percent), (Verdict::Caution, Some(Side::NonConservative), Some(12.0)));
}

/// Gross stress above (1 - 2a/W)/1.25 of the yield strength: ASTM E647 has too little ligament from the start (M(T): W - 2a ≥ 1.25 P/(B σ_Y)).
#[test]
fn small_scale_yielding_fails_where_it_does_not_hold_at_the_start() {
    for (range, life) in [("loading.stress_range_mpa=200", true), ("loading.stress_range_mpa=320", false)] {
        let set = ["material.yield_strength_mpa=345", range];
        let (case, run) = (hand_case(PANEL, &set), hand_run(PANEL, &set));
        let check = named(&case, &run, "small_scale_yielding");
        let found = (check.verdict, check.effect_percent, run.life_cycles() > 0.0);
        assert_eq!(found, (Verdict::Failed, Some(100.0), life), "{check:?}");
        assert!(check.words.contains("from the start (a = 9.0 mm)"), "{check:?}");
        assert!(validity(&of_run(&case, &run)) == Validity::NotValid, "{check:?}");
        let why = perilife_growth::predict::error_estimate::error_estimate(&case, &run);
        assert!(why.is_ok() == life && (life || why == Err("no life".to_owned())), "{why:?}");
    }
}

/// 60 N for 60 kN: no metal has a threshold that low.
#[test]
fn a_load_that_moves_no_crack_is_told() {
    for (range, is_told) in [("loading.stress_range_mpa=0.5", true), ("loading.stress_range_mpa=50", false)] {
        let set = [range, "material.yield_strength_mpa=345"];
        let told = judge(&hand_case(PANEL, &set), &hand_run(PANEL, &set)).unwrap();
        assert_eq!(told.iter().any(|line| line.contains("check the units of load, thickness")), is_told, "{range}: {told:?}");
    }
}

/// Limits of a plate with several cracks are lengths of the crack that ends the life, not of all together.
#[test]
fn limits_name_the_governing_crack() {
    let case = Case::from_toml(
        &std::fs::read_to_string("data/cases/two_cracks_plate.toml").unwrap(),
        "two",
        std::path::Path::new("data/cases"),
        &[],
    )
    .unwrap();
    let run = predict(&case, &Silent).unwrap();
    let (_, [first, last]) = run.leading_tip(&case.specimen).unwrap();
    let zone = perilife_growth::predict::plastic_zone::plastic_zone(&case, &run.curve).unwrap();
    let (from, check) = (zone.too_large_from.unwrap(), run.cross_check.unwrap().crack_length);
    assert!([from, check].iter().all(|length| (first..last).contains(length)) && (from - 42.7e-3).abs() < 1e-3, "{from} {check}");
    assert!(named(&case, &run, "small_scale_yielding").words.contains("not valid from a = 42.7 mm ("));
    // Twins share their sum evenly.
    assert!((check - 24.5e-3).abs() < 1e-3, "{check}");
}

#[test]
fn a_fitted_law_is_told_with_its_errors() {
    let mut case = made_up_case::case();
    assert_eq!(fit_use::law_line(&case), None);
    case.law = made_up_case::fitted(8.0, 25.0);
    let line = fit_use::law_line(&case).unwrap();
    assert_says(&line, &["3.4000e-5 mm/cycle ± 1.0 %", "15.00 MPa√m", "p = 3.0000 ± 0.0200", "m = 3.0000 ± 0.0200"]);
}

/// Irwin: `(K_max/σ_Y)²/π`. The panel's ligament is too small from W - 2a = 1.25 P_max / (B σ_Y) on, a = 59.538 mm.
#[test]
fn the_plastic_zone_is_told_and_warned_about() {
    let strong = "material.yield_strength_mpa=345";
    let (case, run) = (hand_case(PANEL, &[strong]), hand_run(PANEL, &[strong]));
    let zone = plastic_zone(&case, &run.curve).unwrap();
    // K_max = 60.35 √(π 0.009 / cos(π 9/152.4)) = 10.2360 MPa√m.
    assert!((zone.first.size / ((10.2360_f64 / 345.0).powi(2) / std::f64::consts::PI) - 1.0).abs() < 1e-4);
    assert!((zone.first.ligament - 0.1344).abs() < 1e-12);
    let from = zone.too_large_from.unwrap();
    assert!((0.059538..0.0600).contains(&from), "{from}");
    // Lives to 59.54 and to 62.87 mm differ by half a percent.
    assert!((0.003..0.007).contains(&zone.life_share_too_large), "{}", zone.life_share_too_large);
    let told = &made_up_run::result(&case, &run)["plastic_zone"];
    assert!((told["first"]["over_thickness"].as_f64().unwrap() - zone.first.size / 2.54e-3).abs() < 1e-9);
    assert_eq!(told["small_scale_yielding"], false);
    // In the range of the tests it holds.
    let stop = "stop.crack_length_mm=49.8";
    assert!(hand_run(PANEL, &[strong, stop]).warnings.is_empty());
    // Plane strain in 2.54 mm of this alloy: 2.5 (K/σ_Y)² = 2.2 mm at the start, but not at half the strength.
    let strain = ["material.plane=strain", "material.yield_strength_mpa=200", stop];
    let line = plane_warning(&hand_case(PANEL, &strain), &hand_run(PANEL, &strain).curve).unwrap();
    assert!(line.contains("plane strain at the tip needs a thickness of 6.5"), "{line}");
    // Without a yield strength nothing is known.
    assert!(plastic_zone(&hand_case(PANEL, &[]), &run.curve).is_none());
    assert!(made_up_run::result(&hand_case(PANEL, &[]), &run)["plastic_zone"].is_null());
}

/// A crack of 1.5 mm at the hole of a lug whose ligament is 13.5 mm, less what the chords of its head take: the crack is what is too short, until it has grown.
#[test]
fn a_short_crack_at_a_rim_is_not_called_a_ligament() {
    let case = |force: f64| {
        let text = format!(
            "[specimen]\nkind = \"lug\"\nhead = \"round\"\nwidth_mm = 50\nlength_mm = 100\nthickness_mm = 5\nhole_diameter_mm = 20\n\
             crack_length_mm = 1.5\ncracks = 2\n[material]\nname = \"al2024-t3\"\n[loading]\nforce_max_kn = {force}\nstress_ratio = 0.1\n\
             [fatigue]\nparis_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874\n"
        );
        Case::from_toml(&text, "lug", Path::new("."), &[]).unwrap()
    };
    // K of a row is set by hand: 4/π (K/345)² = 1.75 mm at 12.79 MPa√m, and 1.0 mm later.
    let mut run = predict(&case(10.0), &Silent).unwrap();
    run.curve.truncate(2);
    let (first, last) = (run.curve[0].crack_length, run.curve[1].crack_length);
    for (row, needed) in run.curve.iter_mut().zip([1.75e-3_f64, 1.0e-3]) {
        row.delta_k = 0.9 * 345e6 * (needed * std::f64::consts::FRAC_PI_4).sqrt();
    }
    let zone = plastic_zone(&case(10.0), &run.curve).unwrap();
    assert!((zone.first.ligament - 13.5e-3).abs() < 5e-6 && (zone.first.crack - 1.5e-3).abs() < 1e-9, "{:?}", zone.first);
    assert_eq!((zone.first.room().1, zone.too_small), ("crack length", "crack length"));
    assert!(zone.too_large_from.is_some_and(|from| (from - first).abs() < 1e-12), "{zone:?}");
    assert!(zone.too_large_to.is_some_and(|to| to > first && to < last) && zone.life_share_too_large < 1.0, "{zone:?}");
    let check = of_run(&case(10.0), &run).into_iter().find(|check| check.name == "small_scale_yielding").unwrap();
    assert!(check.words.contains("not valid from a = 1.5 mm to 1.5 mm (") && !check.words.contains("100.0 %"), "{check:?}");
    let told = &made_up_run::result(&case(10.0), &run)["plastic_zone"];
    // With too little ligament at the end as well it still holds in between.
    let mut long = predict(&case(10.0), &Silent).unwrap();
    long.curve.truncate(3);
    for (row, needed) in long.curve.iter_mut().zip([1.75e-3_f64, 1.0e-3, 30.0e-3]) {
        row.delta_k = 0.9 * 345e6 * (needed * std::f64::consts::FRAC_PI_4).sqrt();
    }
    let check = of_run(&case(10.0), &long).into_iter().find(|check| check.name == "small_scale_yielding").unwrap();
    let is_valid_between =
        check.verdict != Verdict::Failed && check.words.contains("not valid from a = 1.5 mm and again at the end (");
    assert!(is_valid_between && !check.words.contains("100.0 %"), "{check:?}");
    assert!((told["first"]["ligament_mm"].as_f64().unwrap() - 13.5).abs() < 5e-3, "{told}");
    assert!(told["first"]["over_crack"].as_f64().unwrap() > told["first"]["over_ligament"].as_f64().unwrap());
}

/// C and m of 2024-T3 in mm/cycle and MPa√m, and the same law in in/cycle and ksi√in under the keys in mm.
#[test]
fn constants_in_inches_under_keys_in_mm_are_told() {
    let of = |name: &str, c: f64| {
        let set = [format!("material.name=\"{name}\""), format!("fatigue.paris_c_mm_per_cycle={c}")];
        of_case(&hand_case(PANEL, &[&set[0], &set[1]])).into_iter().find(|check| check.name == "units_of_c")
    };
    let metric: f64 = 8.95422e-8;
    let inch = metric / 25.4 * 1.098_843_4_f64.powf(2.874);
    let told = of("al2024-t3", inch).unwrap();
    assert_eq!((told.verdict, told.side), (Verdict::Caution, Some(Side::NonConservative)));
    assert!(told.words.contains("as entered") && told.words.contains("if C is of in/cycle and ksi√in"), "{told:?}");
    // The life is by this factor too long.
    assert!((told.effect_percent.unwrap() / 100.0 + 1.0 - metric / inch).abs() < 1e-6, "{told:?}");
    for (name, c) in [("al2024-t3", metric), ("al2024-t3", metric / 2.0), ("al2024-t3", metric / 1000.0), ("q345", inch)] {
        assert_eq!(of(name, c), None, "{name} {c}");
    }
}
