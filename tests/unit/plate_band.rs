//! The band of lives on a plate that was run: rows, what has none and why, inspections, digits.

use perilife_base::monotone::Monotone;
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_calibration::inspection::{InspectFrom, Inspection};
use perilife_calibration::population::fit;
use perilife_calibration::population::intervals::{INTERVALS_MAX, IntervalReading, Specimen};
use perilife_calibration::population::plate::Plate;
use perilife_growth::case::{Case, LawSource, Lot};
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_results::answers::{Asked, InspectionsRecord};
use perilife_results::band::{Lives, Quality, band_words, known_within};
use perilife_results::checks::Judgement;
use perilife_results::curve::{self, BAND_COLUMNS, Row, left_of_table};
use perilife_results::format::{PLAIN, within};
use perilife_results::record::RunRecord;
use toml::Table;

use crate::support::hand_cases::{PANEL, hand_case};
use crate::support::made_up_case::fitted;
use crate::support::rows::assert_refusal;

/// Rates of a few specimens that differ by a tenth, with a ripple along each.
const FACTORS: [f64; 5] = [1.0, 1.12, 0.9, 1.05, 0.95];

/// The panel with a record of specimens of its own kind.
pub fn panel(specimens: usize, set: &[&str]) -> Case {
    let mut case = hand_case(PANEL, &[&["stop.crack_length_mm=49.8"][..], set].concat());
    let delta_k = |a: f64| 48.28e6 * (std::f64::consts::PI * a / (std::f64::consts::PI * a / 0.1524).cos()).sqrt();
    let one = |(i, factor): (usize, &f64)| {
        let mut cycles = 0.0;
        let reading = |step: usize| {
            let length = (9.0 + step as f64) * MM;
            let rate = 8.95e-11 * factor * (delta_k(length) / MPA_SQRT_M).powf(2.874);
            let now = IntervalReading { length, cycles, counts: true };
            cycles += MM / (rate * (1.0 + 0.15 * (1.7 * (step + 5 * i) as f64).sin()));
            now
        };
        let readings: Vec<IntervalReading> = (0..41).map(reading).collect();
        Specimen::new(&format!("S{i}"), &readings, &delta_k, INTERVALS_MAX).unwrap()
    };
    let lot: Vec<Specimen> = FACTORS[..specimens].iter().enumerate().map(one).collect();
    let LawSource::Fitted(mut record) = fitted(8.18, 26.5) else { unreachable!() };
    record.stress_ratio = 0.2;
    record.paris_c_mm_per_cycle = 8.95422e-8;
    record.paris_m = 2.874;
    record.population = Some(Table::try_from(fit(&lot, None).unwrap()).unwrap());
    case.law = LawSource::Fitted(record);
    case
}

fn lives(case: &Case) -> (Prediction, Lives) {
    let run = predict(case, &Silent).unwrap();
    let lives = Lives::of(case, &run, false).unwrap();
    (run, lives)
}

fn no_band(case: &Case) -> String {
    lives(case).1.band.unwrap_err()
}

fn record(case: &mut Case) -> &mut perilife_growth::case::record::FittedRecord {
    match &mut case.law {
        LawSource::Fitted(record) => record,
        _ => unreachable!(),
    }
}

#[test]
fn quantiles_of_rows_rise_and_end_at_those_of_the_life() {
    for specimens in [1, 2, 5] {
        let case = panel(specimens, &[]);
        let (run, lives) = lives(&case);
        let (plate, band) = lives.band.as_ref().unwrap();
        assert_eq!((plate.lot.assumed_scatter, plate.lot.specimens.len()), (true, specimens));
        assert_eq!((band.reached.len(), band.left.len()), (run.curve.len(), run.curve.len()));
        assert_eq!((band.reached[0], *band.left.last().unwrap()), ([0.0; 3], [0.0; 3]));
        for (row, next) in band.reached.iter().zip(&band.reached[1..]) {
            assert!((0..3).all(|k| next[k] > row[k]) && next[0] < next[1] && next[1] < next[2], "{row:?} {next:?}");
        }
        for (row, next) in band.left.iter().zip(&band.left[1..]) {
            assert!((0..3).all(|k| next[k] < row[k]), "{row:?} {next:?}");
        }
        let (life, left) = (lives.life().unwrap(), band.left[0]);
        assert!(
            life.iter().zip(left).all(|(a, b)| (a / b - 1.0).abs() < 1e-9),
            "the whole is left at the start: {life:?} {left:?}"
        );
        // Between the rows at which they are computed they are those of the closed form.
        for row in [3, 40, 77, 150] {
            let exact = plate.left(run.curve[row].crack_length, None).unwrap().quantiles;
            assert!(
                exact.iter().zip(band.left[row]).all(|(a, b)| (a / b - 1.0).abs() < 2e-3),
                "{row}: {exact:?} {:?}",
                band.left[row]
            );
        }
        assert!((life[1] / run.life_cycles() - 1.0).abs() < 0.15, "{life:?} {}", run.life_cycles());
        assert!(lives.words(None, None)[0].contains("scatter assumed"), "{:?}", lives.words(None, None));
    }
}

#[test]
fn another_lot_scatters_more() {
    let case = panel(5, &[]);
    let other = Case { lot: Lot::Other, ..case.clone() };
    let [[low, _, high], [lower, _, higher]] = [&case, &other].map(|case| lives(case).1.life().unwrap());
    assert!(lower < 0.8 * low && higher > 1.2 * high);
    assert!(lives(&other).1.words(None, None)[0].contains("other lot"));
    assert_eq!(hand_case(PANEL, &["fatigue.lot=\"other\""]).lot, Lot::Other);
}

#[test]
fn a_plate_without_band_says_why() {
    let case = panel(5, &[]);
    assert!(no_band(&hand_case(PANEL, &["stop.crack_length_mm=40"])).contains("use a fitted law"));
    let mut without = case.clone();
    record(&mut without).population = None;
    assert!(no_band(&without).contains("without [population]; calibrate again"));
    let mut other_ratio = case.clone();
    record(&mut other_ratio).stress_ratio = 0.1;
    assert!(no_band(&other_ratio).contains("law fitted at R = 0.1, case R = 0.2"));
    let overloaded = panel(5, &["loading.stress_range_mpa=120"]);
    let why = no_band(&overloaded);
    assert!(why.contains("more than a factor 2 outside the tested 8.19 to 25.98") && why.contains("of the life"), "{why}");
    let mut unlimited = case.clone();
    unlimited.fatigue.threshold = 12.0 * MPA_SQRT_M;
    assert!(no_band(&unlimited).contains("unlimited"));
    let mut damaged = case.clone();
    record(&mut damaged).population.as_mut().unwrap().remove("law");
    let run = predict(&case, &Silent).unwrap();
    assert_refusal(Lives::of(&damaged, &run, false), &["fatigue.fitted", "missing field `law`", "calibrate again"]);
}

#[test]
fn an_end_without_k_takes_the_scatter_of_the_rest() {
    let case = panel(5, &[]);
    let (mut run, whole) = lives(&case);
    let last = run.curve.len() - 1;
    run.curve[last].delta_k = f64::NAN;
    let cut = Lives::of(&case, &run, false).unwrap();
    let [a, b] = [whole.life().unwrap(), cut.life().unwrap()];
    assert!(a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < 2e-3), "{a:?} {b:?}");
    run.curve.iter_mut().skip(last / 2).for_each(|row| row.delta_k = f64::NAN);
    let why = Lives::of(&case, &run, false).unwrap().band.unwrap_err();
    assert!(why.starts_with("ΔK unknown, over ") && why.ends_with("% of the life"), "{why}");
}

#[test]
fn an_inspection_interval_comes_from_the_five_percent_life() {
    let case = panel(5, &[]);
    let (run, mut lives) = lives(&case);
    let rows: Vec<Row> = Row::of_run(&case, &run);
    let from = InspectFrom { crack_length_mm: 20.0, tip: None, factor: 4.0, names: ["--inspect-from", "--factor", "--tip"] };
    let point = Inspection::of(&curve::curve(&rows), None, None, from, false).unwrap();
    assert!(!point.has_band && (4.0 * point.inspection_interval_cycles - point.remaining_cycles).abs() < 1e-6);
    // What a service reads from the table is what the run itself says.
    let table = curve::a_n(&case, &run, lives.columns());
    assert!(table.csv().lines().next().unwrap().ends_with(&BAND_COLUMNS.join(",")));
    let with_band = Inspection::of(&curve::curve(&rows), None, left_of_table(&table).unwrap().as_deref(), from, false).unwrap();
    let plate = &lives.band.as_ref().unwrap().0;
    let exact = plate.left(20.0 * MM, None).unwrap();
    assert!((with_band.remaining_cycles_p05.unwrap() / exact.quantiles[0] - 1.0).abs() < 2e-3, "{with_band:?} {exact:?}");
    assert!((4.0 * with_band.inspection_interval_cycles - with_band.remaining_cycles_p05.unwrap()).abs() < 1e-6);
    assert_eq!(left_of_table(&curve::a_n(&case, &run, None)).unwrap(), None);
    for (crack_length_mm, factor, words) in [(8.0, 3.0, "--inspect-from"), (50.0, 3.0, "9 to 49.8"), (20.0, 0.5, "--factor")] {
        assert_refusal(lives.inspect(InspectFrom { crack_length_mm, factor, ..from }), &[words]);
    }
    lives.inspect(from).unwrap();
    // Inspections follow the crack of the interval, a quarter of its 5 % life each; on that of the run there would be more of them.
    let asked = Asked { detection: Some("20,40".parse().unwrap()), ..Asked::default() };
    let inspections = InspectionsRecord::of(&case, &run, &lives, asked).unwrap();
    let rows = &inspections.rows;
    let share = with_band.remaining_cycles_p05.unwrap() / with_band.remaining_cycles;
    assert!(rows.len() == 4 && share < 0.9, "{inspections:?}");
    let third = run.cycles_at(rows[2].crack_length_mm * MM).unwrap() - with_band.cycles_at;
    assert!((third / (0.5 * with_band.remaining_cycles) - 1.0).abs() < 5e-3, "half of either life: {inspections:?}");
    // By the clock of the 5 % plate, which has failed before the median one is as long.
    let by_row = |column: usize| {
        Monotone::new(
            curve::curve(&Row::of_run(&case, &run))
                .into_iter()
                .zip(&lives.columns().unwrap().reached)
                .map(|([a, _], n)| [a, n[column]]),
        )
    };
    let first = by_row(0).at(20.0);
    assert!((rows[0].cycles / first - 1.0).abs() < 1e-3 && first < 0.9 * with_band.cycles_at, "{inspections:?}, {first}");
    assert!((inspections.end_cycles / lives.life().unwrap()[0] - 1.0).abs() < 0.02, "{inspections:?} {:?}", lives.life());
    let late = InspectionsRecord::of(&case, &run, &lives, Asked { first_inspection: Some(0.99 * run.life_cycles()), ..asked });
    let late = late.unwrap();
    assert!(late.rows.is_empty() && late.missed == 1.0 && late.warning().unwrap().contains("never inspected"), "{late:?}");
    assert_eq!(inspections.warning(), None);
    let words = lives.words(None, None).join("\n");
    let known = known_within(lives.inspection().unwrap(), None);
    let [every, at] = [
        PLAIN.promised(inspections.interval_cycles, inspections.interval_cycles, &known),
        PLAIN.promised(rows[0].cycles, inspections.interval_cycles, &known),
    ];
    assert!(
        words.contains(&format!("Inspect every  {every} cycles"))
            && inspections.words(&known).contains(&format!("first at {at} cycles"))
    );
    // Rows are as far apart as the interval says, but for a step of its last digit.
    assert_eq!(["19 410", "58 240"], [19_413.4, 58_241.3].map(|n| PLAIN.promised(n, 19_413.4, &within(Some(0.5)))));
    assert!(words.contains("Inspect every  ") && words.contains("(5 % remaining life / 4)"), "{words}");
    let record = RunRecord::of(&case, &run, &Judgement::default(), &lives, &Quality::default());
    assert!(record.inspection.unwrap().has_band && record.band.unwrap().lot == Lot::Same);
}

#[test]
fn digits_are_those_that_the_band_deserves() {
    for (quantiles, words) in [
        ([228_123.0, 254_321.0, 283_456.0], "250 000 cycles (median; 90 % band 230 000 to 280 000)"),
        ([240_123.0, 254_321.0, 268_456.0], "254 000 cycles (median; 90 % band 240 000 to 268 000)"),
        ([254_123.0, 254_321.0, 254_456.0], "254 300 cycles (median; 90 % band 254 100 to 254 500)"),
        ([0.081, 0.1234, 0.19], "0.12 cycles (median; 90 % band 0.081 to 0.19)"),
        ([1234.0, 1300.0, 1380.0], "1300 cycles (median; 90 % band 1230 to 1380)"),
    ] {
        assert_eq!(band_words(&quantiles), words);
    }
}

#[test]
fn readings_of_the_plate_must_lie_on_its_curve() {
    let case = panel(5, &[]);
    let run = predict(&case, &Silent).unwrap();
    let plate = Plate::of(&case, &run).unwrap().unwrap();
    let curve = |lengths: &[f64]| {
        let cycles = (0..lengths.len()).map(|i| 2e4 * i as f64).collect();
        perilife_measured::MeasuredCurve::new("own", cycles, lengths.iter().map(|a| a * MM).collect())
    };
    let readings = curve(&[9.0, 10.1, 11.3, 12.9, 14.8]);
    let own = plate.own(&readings).unwrap();
    assert!((plate.read_to(&own, &readings) / (14.8 * MM) - 1.0).abs() < 1e-9);
    // A single one says where the crack is, and nothing of its rate.
    let single = plate.own(&curve(&[12.9])).unwrap();
    assert_eq!(plate.read_to(&single, &curve(&[12.9])), 12.9 * MM);
    assert_eq!(plate.left(12.9 * MM, Some(&single)).unwrap(), plate.left(12.9 * MM, None).unwrap());
    let left = plate.left(20.0 * MM, Some(&own)).unwrap();
    assert!(left.quantiles[0] < left.quantiles[1] && left.quantiles[1] < left.quantiles[2]);
    assert_refusal(plate.left(12.0 * MM, Some(&own)), &["shorter than the last reading, 14.8 mm"]);
    assert!(plate.own(&curve(&[9.0, 10.1, 11.3, 12.9, 50.8])).unwrap_err().to_string().contains("9 to 49.8 mm"));
}
