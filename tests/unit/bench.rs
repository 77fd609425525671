//! The benchmark around its measurements: replayed runs, tables, chart. Speed itself is never asserted.

use std::fs;
use std::path::Path;

use perilife::bench::clock::Timing;
use perilife::bench::extrapolation::History;
use perilife::bench::row::Deviation;
use perilife::bench::variant::{VARIED, variants};
use perilife::bench::{Asked, Figure, GROUPS, Machine, Outcome, Row, groups, scene};
use perilife::case::Case;
use perilife::predict::{Silent, predict};
use perilife::report::{bench as tables, speed_chart};
use perilife::solver::SolverKind;
use tempfile::tempdir;

fn timing(ratio: f64, blocks: Option<usize>) -> Timing {
    let estimated_s = blocks.map(|_| 0.5 * ratio);
    Timing { wall_s: 0.5 * ratio, cpu_s: 0.9 * ratio, ratio, repeats: 5, estimated_s, extrapolated_from: blocks }
}

fn row(group: &'static str, varied: usize, choice: &str, ratio: f64, percent: f64, on_front: bool) -> Row {
    let error = Deviation { of: "cycles", percent, against: "quadrature", at_end_percent: Some(-percent) };
    let blocks = (varied == 2).then_some(20);
    let row = Row::new(group, format!("scene of {group}, 1 mm"), VARIED[varied], choice, timing(ratio, blocks));
    Row { error: Some(error), broken_bonds: Some(400), on_front, note: "a \"note\", with | bars".to_owned(), ..row }
}

fn outcome() -> Outcome {
    let mut rows = Vec::new();
    for group in &GROUPS[..3] {
        rows.push(row(group.name, 0, "default", 1.0, 2.0, true));
        rows.push(row(group.name, 1, "bond_based", 0.7, 5.0, true));
        rows.push(row(group.name, 2, "multigrid", 40.0, 2.0, false));
        rows.push(row(group.name, 3, "0.5 mm", 9.0, 0.4, true));
        rows.push(row(group.name, 5, "symmetry off", 3.0, 60.0, false));
    }
    rows.push(Row::new("hand_calculation", "panel", "fit", "no error here", timing(0.001, None)));
    rows.push(Row {
        error: None,
        note: "did not converge".to_owned(),
        ..row(GROUPS[0].name, 4, "horizon 1.5", f64::NAN, 1.0, false)
    });
    let figure =
        |quantity: &str, value, asked| Figure { group: "virkler_panel", quantity: quantity.to_owned(), value, unit: "ms", asked };
    let figures = vec![
        figure("met", 2.5, Some(Asked::AtMost(3.0))),
        figure("missed", 2.5, Some(Asked::AtLeast(3.0))),
        figure("free", 1.0, None),
    ];
    Outcome { rows, figures, machine: Machine::here(), reference: "a run".to_owned(), reference_s: 0.5 }
}

#[test]
fn tables_are_whole() {
    let outcome = outcome();
    let csv = tables::csv(&outcome.rows);
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    assert_eq!(reader.headers().unwrap().iter().collect::<Vec<_>>().join(","), tables::COLUMNS);
    // The reader refuses rows of another length.
    let records: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().unwrap();
    assert_eq!(records.len(), outcome.rows.len());
    assert_eq!((&records[2][3], &records[2][9], &records[2][12]), ("multigrid", "20", "2.000000000"));
    let figures = tables::figures_csv(&outcome.figures);
    assert!(figures.contains(",≤ 3,true\n") && figures.contains(",≥ 3,false\n") && figures.ends_with(",,\n"), "{figures}");
    let object = tables::object(&outcome);
    assert_eq!(object["rows"].as_array().unwrap().len(), outcome.rows.len());
    assert_eq!(
        (object["figures"][1]["met"].as_bool(), object["rows"][0]["ms_per_broken_bond"].as_f64()),
        (Some(false), Some(1.25))
    );
    let text = tables::markdown(&outcome);
    for words in
        ["| solver | multigrid | 0 | 20.0 s | 40.0 | extrapolated |", "0.5 mm (front)", "with \\| bars", "asked ≥ 3: missed"]
    {
        assert!(text.contains(words), "{words} in {text}");
    }
}

#[test]
fn the_chart_names_the_front_and_says_what_it_shows() {
    let dir = tempdir().unwrap();
    let path = dir.path().join("bench.svg");
    assert!(speed_chart::speed_accuracy(&path, &outcome()).unwrap());
    let svg = fs::read_to_string(&path).unwrap();
    for group in &GROUPS[..3] {
        assert!(svg.contains(&format!("scene of {}, 1 mm", group.name)), "a panel of {}", group.name);
    }
    let times = |word: &str| svg.matches(word).count();
    // Each name once a panel; what is not on the front has none.
    assert_eq!([times("bond_based"), times("0.5 mm"), times("multigrid"), times("symmetry off")], [3, 3, 0, 0]);
    for words in [
        "Time over that of the reference run",
        "Error of cycles, %",
        "Pareto front",
        "surface correction or symmetry",
        "hollow: extrapolated",
        "a run",
    ] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(!svg.contains("horizon ratio"), "nothing drawn of it, nothing in the legend");
    // Without errors there is nothing to draw, and no file.
    let mut bare = outcome();
    bare.rows.retain(|row| row.error.is_none());
    let none = dir.path().join("none.svg");
    assert!(!speed_chart::speed_accuracy(&none, &bare).unwrap() && !none.exists());
}

#[test]
fn demands_are_kept_by_numbers_only() {
    assert!(Asked::AtMost(3.0).is_met(3.0) && !Asked::AtMost(3.0).is_met(3.1) && !Asked::AtMost(3.0).is_met(f64::NAN));
    assert!(Asked::AtLeast(3.0).is_met(3.0) && !Asked::AtLeast(3.0).is_met(2.9) && !Asked::AtLeast(3.0).is_met(f64::NAN));
}

#[test]
fn every_variant_is_a_case_of_its_own() {
    for quick in [false, true] {
        for scene in
            [scene::middle_tension(quick), scene::single_edge(quick), scene::cracked_plate(quick), scene::tension_plate(quick)]
        {
            let default = scene.case(&[]).unwrap();
            let all = variants(&scene, &default, quick);
            for varied in &VARIED[1..] {
                assert!(all.iter().any(|variant| variant.varied == *varied), "{}: {varied}", scene.name);
            }
            for (i, variant) in all.iter().enumerate() {
                let case = scene.case(&variant.set).unwrap();
                let differs = case.model != default.model || case.fatigue != default.fatigue;
                assert!(differs, "{}: {}", scene.name, variant.choice);
                assert!(all[..i].iter().all(|other| other.choice != variant.choice), "{} stands twice", variant.choice);
            }
            let solvers = all.iter().filter_map(|variant| variant.solver).count();
            assert_eq!(solvers, SolverKind::ALL.len() - 1, "every solver but the default");
        }
    }
}

const SMALL: &str = r#"
[specimen]
kind = "middle_tension"
width_mm = 30.0
length_mm = 40.0
thickness_mm = 2.0
crack_length_mm = 6.0
[material]
youngs_modulus_gpa = 72.0
poisson_ratio = 0.3
[loading]
stress_max_mpa = 50.0
stress_ratio = 0.1
[model]
spacing_mm = 1.0
symmetry = "off"
[fatigue]
a = 1e5
p = 3.0
horizon_mm = 3.015
# The curve then counts all bonds that break.
precrack = "none"
[stop]
crack_length_mm = 9.0
"#;

#[test]
fn a_replayed_run_is_the_run() {
    let case = Case::from_toml(SMALL, "small", Path::new("."), &[]).unwrap();
    let (history, _) = History::of(&case).unwrap();
    assert!(history.blocks() >= 20, "{}", history.blocks());
    // The curve is averaged over a spacing of growth and ends that much earlier than the run: a longer one has the state looked for.
    let longer = Case::from_toml(SMALL, "small", Path::new("."), &["stop.crack_length_mm=12".to_owned()]).unwrap();
    let longer = predict(&longer, &Silent).unwrap().curve;
    // No time to spend: the fewest blocks.
    let samples: Vec<_> =
        SolverKind::ALL.iter().map(|&kind| (kind, history.sample(kind, case.loading.maximum, 0.0).unwrap())).collect();
    let exact = samples.iter().find(|(kind, _)| *kind == SolverKind::Direct).unwrap().1.work;
    for (kind, sampled) in &samples {
        assert_eq!(sampled.blocks.len(), 5, "{kind}");
        assert!(sampled.blocks.windows(2).all(|pair| pair[0].0 < pair[1].0) && sampled.blocks[4].0 < history.blocks());
        assert!(sampled.whole(history.blocks()) > sampled.start_s && sampled.start_s > 0.0, "{kind}");
        // The run went through the same state, whatever solver finds it again. Its curve is averaged over a spacing of growth,
        // 1 mm, and work rises with growth: that of the state lies between rows a spacing before and after.
        let of_run = longer.iter().find(|row| row.broken_bonds >= sampled.broken_bonds).unwrap();
        assert_eq!(of_run.broken_bonds, sampled.broken_bonds, "{kind}");
        let before = longer.iter().rfind(|row| row.crack_length <= of_run.crack_length - 1e-3).unwrap().work;
        let after = longer.iter().find(|row| row.crack_length >= of_run.crack_length + 1e-3).unwrap().work;
        assert!((before..after).contains(&sampled.work), "{kind}: {} J not within {before} and {after} J", sampled.work);
        assert!((sampled.work / exact - 1.0).abs() < 1e-5, "{kind}: {} J against {exact} J", sampled.work);
    }
}

#[test]
fn unknown_groups_are_answered_with_the_known_ones() {
    let error = groups(&["tension_plate".to_owned(), "nothing".to_owned()]).map(|_| ()).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("nothing") && error.to_string().contains("virkler_panel"), "{error}");
    assert_eq!(groups(&[]).unwrap().len(), GROUPS.len());
}
