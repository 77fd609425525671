//! The speed-accuracy chart around its measurements: order of runs, tables, picture, page, summary. Speed itself is never asserted.

use std::cell::RefCell;

use perilife_base::error::Error;
use perilife_study::chart::schedule::{BenchmarkRecord, Effort, Model, Request, measure};
use perilife_study::chart::{BenchmarkRun, Chart, Family, Machine, SCENES, Status, choices, front, scenes};
use perilife_study::speed::{COLUMNS, Origin, beaten, csv, fastest_within, markdown, never_on_front, seconds, svg};
use perilife_study::tasks::Outcome;
use perilife_study::values::concentration_of;

use crate::support::rows::assert_says;

/// A run that took and found so much.
fn run(wall_s: f64, error_percent: f64) -> BenchmarkRun {
    let model = Model {
        driver: "tip_field".to_owned(),
        bond_law: "two_parameter".to_owned(),
        solver: "window".to_owned(),
        discretisation: "lattice".to_owned(),
        spacing_mm: Some(1.0),
        horizon_ratio: Some(3.015),
        step: Some(0.5),
    };
    BenchmarkRun { wall_s, memory_mb: 50.0, error_percent, path_rms_mm: None, points: 1000, solves: 20, model }
}

/// A process that answers by the keys it is given: the time of a choice, and its error.
fn answer(request: &Request) -> Outcome<BenchmarkRun> {
    let has = |word: &str| request.set.iter().any(|key| key.contains(word));
    match () {
        () if has("kernel=constant") => Outcome::Failed("no \"factor\", <none>".to_owned()),
        () if has("one_bond") => Outcome::Refused("not with this material".to_owned()),
        () if has("multigrid") => Outcome::Stopped("not done after 120 s".to_owned()),
        () if has("element_free") && request.set.iter().any(|key| key == "model.tolerance_percent=1") => {
            Outcome::Done(run(1.5, 0.3))
        }
        () if has("element_free") => Outcome::Done(run(0.3, 0.8)),
        () if has("bond_strain") => Outcome::Done(run(40.0, 9.0)),
        () if has("spacing_mm") => Outcome::Done(run(0.2, 5.0)),
        () => Outcome::Done(run(1.0, 1.0)),
    }
}

/// A chart of these scenes by [`answer`], and the requests in the order in which they were made.
fn measured(names: &[&str], effort: Effort, known: Vec<BenchmarkRecord>) -> (Chart, Vec<Request>, Vec<BenchmarkRecord>) {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let asked = RefCell::new(Vec::new());
    let isolated = |request: &Request, _: f64| {
        asked.borrow_mut().push(request.clone());
        Ok(answer(request))
    };
    let mut kept = Vec::new();
    let mut keep = |record: &BenchmarkRecord| {
        kept.push(record.clone());
        Ok::<(), Error>(())
    };
    let chart = measure(&scenes(&names).unwrap(), effort, known, &isolated, &mut keep).unwrap();
    (chart, asked.into_inner(), kept)
}

#[test]
fn runs_are_repeated_by_their_time_and_in_random_order() {
    let (chart, asked, kept) = measured(&["middle_tension"], Effort::FULL, Vec::new());
    let count = |name: &str| chart.points.iter().find(|point| point.choice.name() == name).unwrap().walls.len();
    assert_eq!([count("tip_field"), count("element_free_galerkin"), count("bond_strain")], [5, 5, 1]);
    let planned = choices(&SCENES[0]).unwrap();
    let order: Vec<usize> = kept[..planned.len()]
        .iter()
        .map(|record| planned.iter().position(|choice| choice.set == record.request.set).unwrap())
        .collect();
    assert!(order.windows(2).any(|pair| pair[1] < pair[0]), "in the order of the list: {order:?}");
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, (0..planned.len()).collect::<Vec<_>>(), "each choice once before any is repeated");
    // A reference run in the beginning at least.
    assert!(asked.len() > kept.len() && asked[0].set.is_empty());
    // What is known is not run again, and gives the same chart.
    let (again, asked, more) = measured(&["middle_tension"], Effort::FULL, kept);
    assert!(asked.is_empty() && more.is_empty(), "{asked:?}");
    assert_eq!(csv(&again), csv(&chart));
    let (quick, ..) = measured(&["middle_tension"], Effort::QUICK, Vec::new());
    assert!(quick.points.len() < chart.points.len() && quick.points.iter().all(|point| point.walls.len() <= 1));
}

#[test]
fn what_has_no_result_is_a_point_with_its_reason() {
    let (chart, ..) = measured(&["middle_tension", "slant_severance"], Effort::FULL, Vec::new());
    for status in [Status::Failed, Status::Refused, Status::Stopped] {
        let point = chart.points.iter().find(|point| point.status() == status).unwrap();
        let reason = point.outcome.reason().unwrap();
        assert!(point.place().is_none() && !reason.is_empty() && !point.is_on_front, "{status}: {reason}");
    }
    let table = csv(&chart);
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    assert_eq!(reader.headers().unwrap().iter().collect::<Vec<_>>().join(","), COLUMNS);
    // The reader refuses rows of another length.
    let records: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().unwrap();
    assert_eq!(records.len(), chart.points.len());
    let origin = Origin { command: "perilife chart".to_owned(), date: "2026-01-01".to_owned() };
    let picture = svg(&chart, &origin);
    let crosses = chart.points.iter().filter(|point| point.place().is_none()).count();
    assert_eq!(picture.matches("stroke=\"#8893a1\" stroke-width=\"1.6\"").count(), 2 * crosses, "two strokes for each");
    // Two panels, a star in each for the choice of the program at four tolerances.
    assert_eq!(picture.matches("fill=\"#f2c14e\"").count(), 8);
    let summary = markdown(&chart, &origin);
    assert_says(&summary, &["refused: not with this material", "stopped: not done after 120 s"]);
}

#[test]
fn the_summary_tells_the_fastest_and_the_beaten() {
    let (chart, ..) = measured(&["slant_severance", "hole_entered"], Effort::FULL, Vec::new());
    let name = |percent: f64| fastest_within(&chart, percent).map(|choice| choice.name);
    assert_eq!(name(10.0).as_deref(), Some("tip_field, spacing × 2"));
    assert_eq!(name(2.0).as_deref(), Some("element_free_galerkin"));
    assert_eq!(name(0.5).as_deref(), Some("element_free_galerkin, to 1 %"));
    assert_eq!(name(0.1), None);
    let lost = beaten(&chart);
    assert_eq!(lost.len(), 2, "0.3 s and 0.8 % beat 1 s and 1 %");
    assert_eq!(lost[0].1.map(|by| by.choice.family), Some(Family::ElementFree));
    assert!(never_on_front(&chart).contains(&Family::BondStrain) && !never_on_front(&chart).contains(&Family::ElementFree));
}

#[test]
fn every_choice_is_a_case_of_its_own() {
    for panel in SCENES.iter() {
        let all = choices(panel).unwrap();
        assert!(all[0].is_default() && all.iter().filter(|choice| choice.is_default()).count() == 1, "{}", panel.name);
        // What the program chooses is a model that stands there by its own name, too.
        let all: Vec<_> = all.into_iter().filter(|choice| choice.family != Family::Auto).collect();
        let points = panel.case(&[]).unwrap();
        for (i, choice) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|other| other.name() != choice.name()), "{}: {} twice", panel.name, choice.name());
            // One that the program refuses is a point as well; the others differ from the default in what they set.
            let Ok(case) = panel.case(&choice.set) else { continue };
            let differs = case.model != points.model || case.fatigue != points.fatigue || case.material != points.material;
            assert!(differs || choice.family == Family::TipField && choice.words.is_empty(), "{}: {}", panel.name, choice.name());
        }
        let has = |family: Family| all.iter().any(|choice| choice.family == family);
        assert!(has(Family::TipField) && (has(Family::ElementFree) || !panel.is("crack")), "{}", panel.name);
        assert!(panel.grows() || has(Family::BondLaw) && has(Family::Solver), "{}", panel.name);
    }
    assert!(SCENES.len() >= 10 && SCENES.iter().all(|panel| panel.uncertainty_percent < 1.0));
}

#[test]
#[allow(clippy::approx_constant, reason = "a value of the table, not π")]
fn the_hole_has_the_concentration_of_the_handbook() {
    // Kirsch 1898; Howland 1930, Phil. Trans. 229:49, table at 0.2 and 0.5 of the width: 3.14 and 4.32.
    for (share, wanted) in [(0.0, 3.0), (0.2, 3.14), (0.5, 4.32)] {
        assert!((concentration_of(share) / wanted - 1.0).abs() < 0.005, "{share}: {}", concentration_of(share));
    }
}

#[test]
fn unknown_scenes_are_answered_with_the_known_ones() {
    let error = scenes(&["tension_plate".to_owned(), "nothing".to_owned()]).map(|_| ()).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("nothing") && error.to_string().contains("slant_severance"), "{error}");
    assert_eq!(scenes(&[]).unwrap().len(), SCENES.len());
}

#[test]
fn the_machine_has_threads_and_an_instruction_set() {
    let machine = Machine::here();
    assert!(machine.threads > 0 && machine.instruction_set.starts_with(std::env::consts::ARCH), "{machine}");
    assert!(!machine.instruction_set.contains('('), "{machine}");
}

#[test]
fn beaten_points_are_left_out_and_round_off_earns_no_place() {
    type Row = (&'static [(f64, f64)], &'static [usize]);
    const NAN: f64 = f64::NAN;
    const INF: f64 = f64::INFINITY;
    let rows: [Row; 6] = [
        (&[(1.0, 3.0), (2.0, 4.0), (0.5, 8.0), (4.0, 1.0), (3.0, 1.0), (5.0, NAN), (9.0, 2.0)], &[2, 0, 4]),
        (&[(1.0, 2.0), (3.0, 2.0 * (1.0 - 1e-6))], &[0]),
        (&[(1.0, 2.0), (3.0, 2.0 * (1.0 - 1e-2))], &[0, 1]),
        // No error at all earns one, but once.
        (&[(1.0, 2.0), (2.0, 0.0), (3.0, 0.0)], &[0, 1]),
        (&[], &[]),
        (&[(INF, 1.0), (1.0, NAN)], &[]),
    ];
    rows.iter().for_each(|(points, wanted)| assert_eq!(front(points), *wanted, "{points:?}"));
}

#[test]
fn times_have_two_digits_and_a_unit_that_suits() {
    let looks =
        [(12.345, "12 s"), (1.2345, "1.2 s"), (0.01234, "12 ms"), (2.5e-4, "250 µs"), (f64::NAN, "-"), (1234.0, "1234 s")];
    looks.iter().for_each(|(value, text)| assert_eq!(seconds(*value), *text));
}
