//! Fleets beside the band of their lot, detection, sensitivities.

use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_calibration::sweep::detection::{Detection, Schedule};
use perilife_calibration::sweep::distribution::quantile;
use perilife_calibration::sweep::fleet::{FleetLives, FleetPlate, Looks, lives};
use perilife_growth::case::{Case, Fleet, InitialLength};
use perilife_growth::predict::{Silent, StopReason, predict};
use perilife_results::answers::{Sensitivities, SensitivityRecord};
use perilife_results::band::Lives;

use super::plate_band::panel;
use crate::support::hand_cases::{PANEL, hand_case};

const ALIKE: Fleet = Fleet { plates: 4000, seed: 3, initial_length: None, load_scatter: 0.0 };

fn fleet(case: &Case, fleet: &Fleet, looks: Option<Looks>) -> (FleetLives, Lives) {
    let run = predict(case, &Silent).unwrap();
    let band = Lives::of(case, &run, false).unwrap();
    let plate = band.band.as_ref().map(|(plate, _)| plate);
    (lives(case, &run, fleet, plate, looks).unwrap(), band)
}

fn quantiles(fleet: &FleetLives) -> [f64; 3] {
    let mut cycles: Vec<f64> = fleet.plates.iter().map(|plate| plate.life.cycles).collect();
    cycles.sort_by(f64::total_cmp);
    [0.05, 0.5, 0.95].map(|q| quantile(&cycles, q))
}

/// The closed form of the band is within 0.5 % of draws; 4000 plates tell a 5 % quantile of this scatter within about 1 %.
#[test]
fn a_fleet_that_differs_in_its_law_alone_has_the_quantiles_of_the_band() {
    let (drawn, band) = fleet(&panel(5, &[]), &ALIKE, None);
    let (found, wanted) = (quantiles(&drawn), band.life().unwrap());
    assert!(drawn.one_law.is_none() && (0..3).all(|k| (found[k] / wanted[k] - 1.0).abs() < 0.02), "{found:?} beside {wanted:?}");
    // A faster law has the shorter life.
    let product = |plate: &perilife_calibration::sweep::fleet::FleetPlate| plate.rate_factor * plate.life.cycles;
    assert!(drawn.plates.iter().all(|plate| (product(plate) / product(&drawn.plates[0]) - 1.0).abs() < 0.02));
}

/// Of one Paris law ln N is normal with m times the deviation of the load, and falls with the initial length.
#[test]
fn loads_and_initial_lengths_scatter_lives_as_k_says() {
    let case = hand_case(PANEL, &["stop.crack_length_mm=45"]);
    let (by_load, band) = fleet(&case, &Fleet { load_scatter: 0.03, ..ALIKE }, None);
    assert!(by_load.one_law.is_some());
    let run = predict(&case, &Silent).unwrap().life_cycles();
    let [low, middle, high] = quantiles(&by_load);
    let by_normal = |z: f64| run * (1.0 + 0.03 * z).powf(-2.874);
    for (found, z) in [(low, 1.645), (middle, 0.0), (high, -1.645)] {
        assert!((found / by_normal(z) - 1.0).abs() < 5e-3, "{found} {}", by_normal(z));
    }
    assert!(band.life().is_none());
    for lengths in [
        InitialLength::LogNormal { median: 9.0 * MM, deviation_ln: 0.2 },
        InitialLength::Normal { mean: 9.0 * MM, deviation: 1.8 * MM },
    ] {
        let (by_length, _) = fleet(&case, &Fleet { initial_length: Some(lengths), ..ALIKE }, None);
        assert!((quantiles(&by_length)[1] / run - 1.0).abs() < 2e-3, "the median plate is that of the run");
        let mut plates = by_length.plates.clone();
        plates.sort_by(|a, b| a.initial_length.total_cmp(&b.initial_length));
        assert!(plates.windows(2).all(|pair| pair[1].life.cycles < pair[0].life.cycles));
        assert!(plates[0].initial_length > 0.0 && plates.iter().all(|plate| !plate.life.is_clipped || plate.life.is_bound));
    }
    let mut still = case;
    still.fatigue.threshold = 8.0 * MPA_SQRT_M;
    let (some, _) = fleet(&still, &Fleet { load_scatter: 0.1, ..ALIKE }, None);
    let unlimited = some.plates.iter().filter(|plate| plate.life.stop == StopReason::NothingAges).count();
    assert!((100..3900).contains(&unlimited) && some.plates.iter().all(|plate| plate.missed.is_none()), "{unlimited}");
}

/// POD(a50) = 1/2 and POD(a90) = 0.9 by definition; independent inspections multiply.
#[test]
fn inspections_that_all_miss_multiply() {
    let detection: Detection = "2,5".parse().unwrap();
    for (length, found) in [(2.0, 0.5), (5.0, 0.9), (0.8, 0.1)] {
        assert!((detection.at(length * MM) - found).abs() < 1e-12, "{length}");
    }
    for wrong in ["2", "5,2", "0,1", "a,b", "1,2,3"] {
        assert!(wrong.parse::<Detection>().unwrap_err().to_string().contains("--pod"), "{wrong}");
    }
    let mut inspected = Schedule { detection, cycles: [0.0, 10.0] }.begin();
    inspected.grow([0.0, 20.0], [2.0 * MM, 2.0 * MM], |_, _, _, _| ());
    assert_eq!((inspected.count, inspected.missed), (2, 0.25));
    inspected.grow([20.0, 30.0], [5.0 * MM, 8.0 * MM], |at, length, _, _| assert_eq!((at, length), (20.0, 5.0 * MM)));
    assert!((inspected.missed - 0.025).abs() < 1e-12, "{inspected:?}");
}

/// Cycles from detectable to critical of every plate: under a Paris law load^-m times those of the run where both ends are lengths; with a toughness the
/// critical length is that at which K of the panel under its own load is the toughness (Feddersen's secant).
#[test]
fn every_plate_of_a_fleet_has_its_own_interval() {
    let looks = Looks { detectable: 12.0 * MM, factor: 3.0, detection: Some("12,25".parse().unwrap()), first: None };
    let case = hand_case(PANEL, &["stop.crack_length_mm=45"]);
    let by_load = Fleet { load_scatter: 0.03, plates: 2000, ..ALIKE };
    let (drawn, _) = fleet(&case, &by_load, Some(looks));
    let run = predict(&case, &Silent).unwrap();
    let whole = run.life_cycles() - run.cycles_at(looks.detectable).unwrap();
    let left = |plate: &FleetPlate| plate.window.unwrap()[1];
    for plate in &drawn.plates {
        assert!((left(plate) / (whole * plate.load.powf(-2.874)) - 1.0).abs() < 1e-3, "{plate:?}");
        assert!((plate.critical_length.unwrap() / (45.0 * MM) - 1.0).abs() < 1e-9);
    }
    // The interval is that of the 5 % of plates with the highest loads, and all are first inspected when these have the detectable length.
    let looked = drawn.looked.as_ref().unwrap();
    let at = run.cycles_at(looks.detectable).unwrap() * (1.0 + 0.03 * 1.645_f64).powf(-2.874);
    assert!((looked.first / at - 1.0).abs() < 5e-3 && looked.before_first == 0, "{} {at}", looked.first);
    let highest = whole * (1.0 + 0.03 * 1.645_f64).powf(-2.874) / 3.0;
    assert!((looked.every / highest - 1.0).abs() < 5e-3, "{} {highest}", looked.every);
    assert!(looked.missed_after[0] > 0.5 && looked.missed_after.windows(2).all(|pair| pair[1] <= pair[0]));
    assert!((looked.missed_after.last().unwrap() - looked.missed).abs() < 1e-9 && looked.missed_after.len() == 7, "{looked:?}");
    let missed = drawn.plates.iter().filter_map(|plate| plate.missed).sum::<f64>() / 2000.0;
    assert!((missed - looked.missed).abs() < 1e-12);
    // Plates that break before a late first inspection are missed.
    let (late, _) = fleet(&case, &by_load, Some(Looks { first: Some(run.life_cycles()), ..looks }));
    let late = late.looked.unwrap();
    assert!((990..=1010).contains(&late.before_first) && late.missed > 0.49 && late.missed < 0.6, "{late:?}");
    // With a toughness the plate under the higher load breaks at the shorter length.
    let tough = hand_case(PANEL, &["material.toughness_mpa_sqrt_m=40", "stop.crack_length_mm=70"]);
    let formula = perilife_plate::specimen::handbook::handbook(&tough.specimen).unwrap();
    let (drawn, _) = fleet(&tough, &by_load, Some(looks));
    // Under a lower load than that of the run the record ends before the plate does.
    for plate in &drawn.plates {
        let k = formula.k_i(plate.critical_length.unwrap(), plate.load * tough.loading.maximum) / (40.0 * MPA_SQRT_M);
        assert!(plate.life.stop == StopReason::Toughness, "{plate:?}");
        assert!(if plate.load > 1.0 { (k - 1.0).abs() < 5e-3 } else { k < 1.0 + 5e-3 }, "{k} {plate:?}");
    }
    // Where cracks break before they can be found there is no interval.
    let (blind, _) = fleet(&tough, &by_load, Some(Looks { detectable: 60.0 * MM, ..looks }));
    assert!(blind.looked.is_none() && blind.plates.iter().all(|plate| left(plate) == 0.0 && plate.missed.is_none()));
    // Of laws that differ, what grows faster has the shorter interval and is found less often.
    let (drawn, _) = fleet(&panel(5, &[]), &Fleet { plates: 200, ..ALIKE }, Some(Looks { detectable: 20.0 * MM, ..looks }));
    let fastest = drawn.plates.iter().max_by(|a, b| a.rate_factor.total_cmp(&b.rate_factor)).unwrap();
    let slowest = drawn.plates.iter().min_by(|a, b| a.rate_factor.total_cmp(&b.rate_factor)).unwrap();
    assert!(left(fastest) < left(slowest) && fastest.missed >= slowest.missed, "{fastest:?} {slowest:?}");
}

/// A thousand lives a second with intervals and inspections, on one core.
#[test]
fn a_thousand_plates_take_less_than_a_second() {
    let looks = Looks { detectable: 12.0 * MM, factor: 3.0, detection: Some("12,25".parse().unwrap()), first: None };
    let (case, many) = (hand_case(PANEL, &["stop.crack_length_mm=45"]), Fleet { load_scatter: 0.03, plates: 4000, ..ALIKE });
    let run = predict(&case, &Silent).unwrap();
    let (begun, why) = (std::time::Instant::now(), "one law".to_owned());
    lives(&case, &run, &many, Err(&why), Some(looks)).unwrap();
    let rate = 4000.0 / begun.elapsed().as_secs_f64();
    assert!(rate > 1000.0, "{rate}");
}

#[test]
fn sensitivities_are_those_of_the_law() {
    let case = panel(5, &[]);
    let run = predict(&case, &Silent).unwrap();
    let Sensitivities(all) = Sensitivities::of(&case, &run).unwrap();
    let of = |input: &str, sign: char| all.iter().find(|entry| entry.input == input && entry.change.starts_with(sign)).unwrap();
    let share = |entry: &SensitivityRecord| entry.change_of_life_percent.unwrap() / 100.0;
    for (sign, factor) in [('-', 0.95_f64), ('+', 1.05)] {
        let wanted = factor.powf(-2.874) - 1.0;
        assert!((share(of("load", sign)) - wanted).abs() < 1e-9, "{:?}", of("load", sign));
    }
    let lengths = ['-', '+'].map(|sign| share(of("initial crack length", sign)));
    assert!(lengths[0] > 0.0 && lengths[1] < 0.0, "{lengths:?}");
    let rate = ['-', '+'].map(|sign| share(of("growth rate", sign)) + 1.0);
    assert!((rate[0] * rate[1] - 1.0).abs() < 1e-9 && rate[0] > 1.0, "{rate:?}");
    assert_eq!(all.len(), 8);
}
