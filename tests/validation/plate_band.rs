//! The lot of Virkler et al. (1979) on other plates, against draws and against the numbers of an independent trial of the method.

use perilife_base::units::MM;
use perilife_calibration::population::forecast::{CELLS, Lot};
use perilife_calibration::population::intervals::{Specimen, cells};
use perilife_calibration::population::plate::{Plate, PlateBand};
use perilife_calibration::population::student::t_quantile;
use perilife_calibration::population::{Population, fit};
use perilife_growth::case::record::{CurveRecord, FittedLaw};
use perilife_growth::case::{Case, LawSource};
use perilife_growth::predict::fit_use::life_share_extrapolated;
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_measured::MeasuredCurve;
use perilife_plate::specimen::handbook::handbook;
use toml::Table;

use super::population::{panels, specimens};
use crate::support::hand_cases::{PANEL, hand_case};
use crate::support::made_up_case::fitted;

const EDGE: &str = "kind = \"single_edge_tension\"\nends = \"uniform_stress\"\nwidth_mm = 60\nlength_mm = 180\nthickness_mm = 2.54\n\
                    crack_length_mm = 5\n";

fn lot_of(specimens: &[Specimen]) -> Population {
    fit(specimens, None).unwrap()
}

fn with(lot: &Population, mut case: Case) -> Case {
    let LawSource::Fitted(mut record) = fitted(8.18, 26.5) else { unreachable!() };
    (record.stress_ratio, record.rate_constant, record.method) = (0.2, None, "handbook".to_owned());
    (record.law, record.curve) = (FittedLaw::Curve, Some(CurveRecord::of(&lot.life_law(), 0.0, &|_| [0.0; 2])));
    record.population = Some(Table::try_from(lot).unwrap());
    case.law = LawSource::Fitted(record);
    case
}

fn band(case: &Case) -> (Prediction, Plate, PlateBand) {
    let run = predict(case, &Silent).unwrap();
    let plate = Plate::of(case, &run).unwrap().unwrap();
    let band = plate.band().unwrap();
    (run, plate, band)
}

fn deviation(band: &PlateBand, row: usize, freedom: f64) -> f64 {
    let [_, middle, high] = band.reached[row];
    (high / middle).ln() / t_quantile(0.95, freedom)
}

#[test]
fn the_band_of_another_plate_is_that_of_draws() {
    let Some(panels) = panels() else { return };
    let lot = lot_of(&specimens(&panels, 50));
    let case = with(&lot, hand_case(EDGE, &["loading.stress_range_mpa=60", "stop.crack_length_mm=20"]));
    let (run, plate, band) = band(&case);
    let formula = handbook(&case.specimen).unwrap();
    let delta_k = |a: f64| formula.delta_k(a, case.loading.maximum, case.loading.range_share());
    for row in [run.curve.len() / 2, run.curve.len() - 1] {
        let path = cells(5.0 * MM, run.curve[row].crack_length, CELLS, &delta_k).unwrap();
        let mut draws = lot.forecast(&path, None, Lot::Same).unwrap().draws(40_000, 11).unwrap();
        draws.sort_by(f64::total_cmp);
        for (k, share) in [(0, 0.05), (1, 0.5), (2, 0.95)] {
            let (closed, drawn) = (band.reached[row][k], draws[(share * 40_000.0) as usize]);
            println!("row {row}, {share}: {closed:.0} over {drawn:.0} = {:.4}", closed / drawn);
            assert!((closed / drawn - 1.0).abs() < 0.005, "{closed} {drawn}");
        }
    }
    // The trial had 0.089 over 5 to 20 mm, and 0.115 over the first 3 mm.
    let first = run.curve.iter().position(|row| row.crack_length >= 8.0 * MM).unwrap();
    for (row, trial) in [(run.curve.len() - 1, 0.089), (first, 0.115)] {
        let found = deviation(&band, row, lot.freedom);
        println!("to {:.2} mm: deviation {found:.4}, trial {trial}", run.curve[row].crack_length / MM);
        assert!((found / trial - 1.0).abs() < 0.1, "{found}");
    }
    let outside = life_share_extrapolated(&case, &run).unwrap();
    assert!(outside < 0.005, "ΔK ends at 26.8 MPa√m: {outside}");
    assert!(plate.lot.specimens.len() == 34 && !plate.lot.assumed_scatter);
}

#[test]
fn a_record_keeps_the_lot_and_one_specimen_gives_the_assumed_band() {
    let Some(panels) = panels() else { return };
    let all = specimens(&panels, 50);
    let panel = || hand_case(PANEL, &["stop.crack_length_mm=49.8"]);
    let lot = lot_of(&all);
    let life = *band(&with(&lot, panel())).2.reached.last().unwrap();
    let expected =
        lot.forecast(&cells(9.0 * MM, 49.8 * MM, CELLS, &super::virkler::delta_k).unwrap(), None, Lot::Same).unwrap().life();
    for (found, share) in life.into_iter().zip([0.05, 0.5, 0.95]) {
        assert!((found / expected.quantile(share) - 1.0).abs() < 0.003, "{life:?} {}", expected.quantile(share));
    }
    // Half widths of the trial with its prior: 49 % of one specimen, 32 of two, 26 of three, 21 of five; 14 to 16 of many.
    for (count, trial) in [(1, 0.49), (2, 0.32), (3, 0.26), (5, 0.21)] {
        let mut covered = 0;
        let mut half = 0.0;
        let tries = 12;
        for i in 0..tries {
            let chosen: Vec<Specimen> = (0..count).map(|k| all[(5 * i + 7 * k) % 34].clone()).collect();
            let lot = lot_of(&chosen);
            assert!(lot.assumed_scatter);
            let [low, middle, high] = *band(&with(&lot, panel())).2.reached.last().unwrap();
            half += 0.5 * (high - low) / middle / f64::from(tries as u32);
            covered += panels.iter().filter(|panel| (low..=high).contains(&panel.life())).count();
        }
        let share = covered as f64 / (34 * tries) as f64;
        println!("{count} specimens: half width {:.0} %, covers {share:.3}", 100.0 * half);
        assert!((half / trial - 1.0).abs() < 0.3 && share > 0.93, "{half} {share}");
    }
}

#[test]
fn readings_of_a_panel_narrow_what_it_has_left() {
    let Some(panels) = panels() else { return };
    let all = specimens(&panels, 50);
    let (mut covered, mut narrower) = (0, 0.0);
    let own_of = |panel: &MeasuredCurve, to: f64| {
        let readings: Vec<usize> = (0..panel.cycles.len()).filter(|&k| panel.crack_length[k] <= to + 1e-9).collect();
        panel.of_readings(&readings)
    };
    for (i, panel) in panels.iter().enumerate() {
        let others: Vec<Specimen> = all.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, one)| one.clone()).collect();
        let case = with(&lot_of(&others), hand_case(PANEL, &["stop.crack_length_mm=49.8"]));
        let plate = band(&case).1;
        let own = plate.own(&own_of(panel, 30.0 * MM)).unwrap();
        let [with_own, without] = [Some(&own), None].map(|own| plate.left(30.0 * MM, own).unwrap().quantiles);
        narrower += (with_own[2] / with_own[0]).ln() / (without[2] / without[0]).ln() / 34.0;
        let left = panel.cycles.last().unwrap() - own_of(panel, 30.0 * MM).cycles.last().unwrap();
        covered += usize::from((with_own[0]..=with_own[2]).contains(&left));
    }
    assert!(narrower < 0.92 && covered >= 27, "{narrower} {covered}");
}

/// Noise that a short growth cannot average says little of its life, and must not widen that of the whole.
#[test]
fn white_noise_of_the_first_rows_does_not_widen_the_life() {
    let Some(panels) = panels() else { return };
    let mut lot = lot_of(&specimens(&panels, 50));
    lot.noise.white = 0.0108;
    let case = with(&lot, hand_case(PANEL, &["stop.crack_length_mm=49.8"]));
    let (run, _, band) = band(&case);
    let whole =
        lot.forecast(&cells(9.0 * MM, 49.8 * MM, CELLS, &super::virkler::delta_k).unwrap(), None, Lot::Same).unwrap().life();
    let [low, middle, high] = *band.reached.last().unwrap();
    assert!((middle / run.life_cycles() - 1.0).abs() < 1e-12);
    for (found, share) in [(low / middle, 0.05), (high / middle, 0.95)] {
        let expected = whole.quantile(share) / whole.median;
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    }
    assert!(band.reached.iter().all(|row| row[0] <= row[1] && row[1] <= row[2]));
}
