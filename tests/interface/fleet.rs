//! Fleets, detection and sensitivities as a user asks for them.

use std::fs;

use crate::interface::cli::{assert_refused, perilife};
use crate::support::desk::{desk, done, json};
use crate::support::rows::assert_holds;

const PANEL: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 300.0\nthickness_mm = 2.54\ncrack_length_mm = 4.0\n\
    [material]\nname = \"al2024-t3\"\ntoughness_mpa_sqrt_m = 60.0\n[loading]\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n\
    [model]\nmethod = \"handbook\"\n[fatigue]\nparis_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874\n";
const FLEET: &str = "[fleet]\ninitial_length_mm = { median = 9.0, standard_deviation_ln = 0.25 }\nload_scatter = 0.02\n";

#[test]
fn a_fleet_with_inspections_and_sensitivities_leaves_its_files() {
    let dir = desk(&[("case.toml", &format!("{PANEL}{FLEET}"))]);
    let arguments = "predict case.toml --out run --fleet 500 --seed 7 --inspect-from 10 --pod 12,25 --sensitivities --residual-strength \
                     --set stop.required_strength_mpa=100";
    let (stdout, _) = done(dir.path(), &arguments.split_whitespace().collect::<Vec<_>>());
    assert_holds(
        &stdout,
        "case: life 5 %  |   Nominal run    life  |  cycles (500 plates)\n | \
        Fleet          from a = 10.000 mm to the end: 5 %  | ; inspected after  | \
        POD            3 inspections, first at  |  cycles; all miss the crack: 3.07e-2 (independence assumed; a50 12 mm, a90 25 mm) | \
        Sensitivities  load -5 % +1",
    );
    let run = dir.path().join("run");
    let (result, table) = (json(run.join("result.json")), fs::read_to_string(run.join("fleet.csv")).unwrap());
    assert_eq!((table.lines().count(), &result["fleet"]["plates"]), (501, &500.into()));
    let quantile = |name: &str| result["fleet"]["life_cycles"][name].as_f64().unwrap();
    assert!(quantile("p05") < quantile("p50") && quantile("p50") < quantile("p95"), "{}", result["fleet"]);
    assert!(result["fleet"]["ended_by"]["required_strength"].as_u64().unwrap() > 400, "{}", result["fleet"]);
    let looks = &result["fleet"]["inspections"];
    let left = |name: &str| looks["detectable_to_critical_cycles"][name].as_f64().unwrap();
    assert!(left("p05") < left("p50") && left("p50") < left("p95") && left("p95") < quantile("p95"), "{looks}");
    assert!((looks["interval_cycles"].as_f64().unwrap() / (left("p05") / 3.0) - 1.0).abs() < 1e-12, "{looks}");
    let found = looks["missed_after"].as_array().unwrap().last().unwrap().as_f64().map(|missed| (1e9 * missed).round());
    assert_eq!(found, result["fleet"]["missed"].as_f64().map(|missed| (1e9 * missed).round()));
    let rows = result["inspections"]["rows"].as_array().unwrap();
    assert_eq!((rows.len(), &rows[2]["missed"]), (3, &result["inspections"]["missed"]), "three looks before the end");
    assert!((rows[0]["crack_length_mm"].as_f64().unwrap() - 10.0).abs() < 0.02, "{rows:?}");
    assert_eq!(result["sensitivities"].as_array().unwrap().len(), 4);
    let critical = &result["critical"];
    assert_eq!(critical["crack_length_mm"], critical["by_toughness_mm"], "{critical}");
    assert!(critical["by_net_section_mm"].as_f64().unwrap() > critical["by_toughness_mm"].as_f64().unwrap(), "{critical}");
    for (file, words) in [
        ("fleet.svg", "lives of a fleet"),
        ("sensitivities.svg", "change in life"),
        ("residual_strength.svg", "required strength"),
        ("sensitivities.csv", "initial crack length,-10 %,"),
    ] {
        assert!(fs::read_to_string(run.join(file)).unwrap().contains(words), "{words} in {file}");
    }
    // The same seed gives the same plates.
    perilife(dir.path(), "predict case.toml --out again --fleet 500 --seed 7 --set stop.required_strength_mpa=100");
    let again = fs::read_to_string(dir.path().join("again/fleet.csv")).unwrap();
    // Without a POD the fleet has an interval all the same: that of its plate at 5 %.
    let (stdout, _) = done(dir.path(), "predict case.toml --out plain --fleet 500 --seed 7 --inspect-from 10");
    let plain = json(dir.path().join("plain/result.json"))["fleet"]["inspections"].clone();
    let every = plain["detectable_to_critical_cycles"]["p05"].as_f64().unwrap() / 3.0;
    let line = stdout.lines().find_map(|line| line.strip_prefix("  Inspect every  ")).unwrap();
    let (cycles, basis) = line.split_once(" cycles ").unwrap();
    let found: f64 = cycles.replace(|c: char| !c.is_ascii_digit(), "").parse().unwrap();
    assert!(basis == "(5 % remaining life of the fleet / 3)" && found <= every && found > 0.999 * every, "{line}: {every}");
    // One figure has one rounding: in the report as on the console.
    done(dir.path(), "report plain --out plain.html");
    let report = fs::read_to_string(dir.path().join("plain.html")).unwrap();
    assert!(report.contains(&format!("{cycles} cycles")), "{cycles}");
    let headline = stdout.lines().next().unwrap().split(['%', ',']).nth(1).unwrap().trim().replace(' ', "\u{202f}");
    assert!(report.contains(&format!("<p class=\"big\">{headline} <small>cycles")), "{headline}");

    let lives = |table: &str| table.lines().map(|line| line.rsplitn(3, ',').nth(2).unwrap().to_owned()).collect::<Vec<_>>();
    assert_eq!(lives(&again), lives(&table));
}

#[test]
fn a_fleet_without_scatter_and_wrong_keys_are_refused() {
    let dir = desk(&[("case.toml", &PANEL)]);
    let cases: [(&[&str], &[&str]); 8] = [
        (&["--fleet", "100"], &["fleet", "has no scatter", "initial_length_mm"]),
        (&["--fleet", "0"], &["fleet.plates = 0", "100000"]),
        (&["--set", "fleet.initial_length_mm={ median = 3.0 }"], &["fleet.initial_length_mm", "standard_deviation_ln"]),
        (&["--set", "fleet.plate=3"], &["fleet.plate", "did you mean plates?"]),
        (&["--pod", "2,5"], &["--inspect-from"]),
        (&["--inspect-from", "400"], &["--inspect-from = 400 mm", "4 to "]),
        (&["--inspect-from", "6 bananas"], &["--inspect-from = 6 bananas", "0.25in"]),
        (&["--inspect-from", "10", "--pod", "5,2"], &["--pod", "two increasing crack lengths"]),
    ];
    for (arguments, words) in cases {
        let output = perilife(dir.path(), &[&["predict", "case.toml", "--out", "run"][..], arguments].concat());
        assert_refused(&output, 2, words);
        assert!(!dir.path().join("run").exists(), "{arguments:?}");
    }
}
