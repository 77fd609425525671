//! The model of a lot on the 34 panels of Virkler et al. (1979), and lives of panels kept back against a lognormal of lives.
//!
//! Bounds are those of an independent trial of the same model in numpy, which also drew 200 halves: means of 20 halves lay within the
//! bounds of the default test in ten groups of ten.

use std::collections::HashMap;
use std::sync::Mutex;

use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_calibration::population::forecast::{CELLS, Lot};
use perilife_calibration::population::intervals::{Interval, IntervalReading, Specimen, cells};
use perilife_calibration::population::student::t_quantile;
use perilife_calibration::population::{Population, fit};
use perilife_measured::{Import, MeasuredCurve, read};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::virkler::delta_k;
use crate::support::shared::shared;

/// Starts of the lives that are judged, mm.
const STARTS: [f64; 3] = [9.0, 20.0, 30.0];
/// Last growth whose cycles the regression of the rival knows, m.
const LAST_GROWTH: f64 = 5.0 * MM;
/// Quantiles of a score.
const LEVELS: usize = 100;

pub fn panels() -> Option<Vec<MeasuredCurve>> {
    Some(read(&[shared("virkler/virkler.csv")?], &Import::default()).unwrap().curves)
}

fn readings(panel: &MeasuredCurve, to: f64) -> Vec<IntervalReading> {
    let both = panel.crack_length.iter().zip(&panel.cycles);
    let before = both.take_while(|(length, _)| **length <= to + 1e-9);
    before.map(|(&length, &cycles)| IntervalReading { length, cycles, counts: true }).collect()
}

pub fn specimens(panels: &[MeasuredCurve], intervals_max: usize) -> Vec<Specimen> {
    panels.iter().map(|panel| Specimen::new(&panel.specimen, &readings(panel, 1.0), &delta_k, intervals_max).unwrap()).collect()
}

/// Standard deviation of the level, and the correlation with the slope at the pivot of the trial, 11.4 MPa√m.
fn at_pivot_of_trial(lot: &Population) -> [f64; 2] {
    let x = (11.4 * MPA_SQRT_M / lot.law.pivot).ln();
    let t = lot.between;
    let both = t.correlation * t.level * t.slope + x * t.slope * t.slope;
    let deviation = (t.level * t.level + 2.0 * x * t.correlation * t.level * t.slope + (x * t.slope).powi(2)).sqrt();
    [deviation, both / (deviation * t.slope)]
}

fn check(name: &str, value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{name}: {value} against {expected} ± {tolerance}");
}

#[test]
fn all_panels_give_the_numbers_of_the_trial() {
    let Some(panels) = panels() else { return };
    let root_mm = MM.sqrt();
    // Every reading, and those that a calibration keeps.
    for (intervals_max, is_whole) in [(usize::MAX, true), (50, false)] {
        let lot = fit(&specimens(&panels, intervals_max), None).unwrap();
        let [deviation, correlation] = at_pivot_of_trial(&lot);
        println!("{} intervals, correlation {correlation:.2} (trial 0.40 ± 0.5)", lot.specimens[0].intervals);
        check("m of the chord", lot.law.slope, 3.36, 0.012);
        if !is_whole {
            let slopes = lot.law.knots().map(|k| lot.law.local_slope(k));
            for (slope, expected) in slopes.into_iter().zip([4.55, 3.69, 2.41, 2.38, 3.72, 4.66]) {
                check("local slope", slope, expected, 0.01);
            }
            check("gain of the shape", lot.gain.unwrap(), 78.0, 0.1);
        }
        check("sd of the level", deviation, 0.045, 0.25 * 0.045);
        check("sd of the slope", lot.between.slope, 0.097, 0.25 * 0.097);
        check("s", lot.noise.scatter, if is_whole { 0.1635 } else { 0.165 }, 0.016);
        check("length of the noise, mm", lot.noise.length / MM, 0.67, 0.067);
        if is_whole {
            // Growths of 0.8 mm cannot tell white noise from errors of reading.
            check("w, √mm", lot.noise.white / root_mm, 0.065, 0.0065);
            check("error of a reading, mm", lot.noise.reading / MM, 0.0099, 0.001);
        }
        check("slope outside the range", lot.slope_deviation_outside(), 0.9, 0.05);
        let life = lot.forecast(&path(9.0), None, Lot::Same).unwrap().life();
        // The median of the panels themselves; the band is as wide as that of the trial with hats, 230 100 to 286 100 about 256 600.
        check("median life", life.median, 253_726.0, 0.006 * 253_726.0);
        for (sign, expected) in [(-1.0, 0.8967), (1.0, 1.1150)] {
            check("end of the normal 90 % band", (sign * 1.644_854 * life.deviation).exp(), expected, 0.006);
        }
    }
}

#[test]
fn lives_in_closed_form_are_those_of_draws_whatever_the_cells() {
    let Some(panels) = panels() else { return };
    let lot = fit(&specimens(&panels, 50), None).unwrap();
    let of = |count: usize| lot.forecast(&cells(9.0 * MM, 49.8 * MM, count, &delta_k).unwrap(), None, Lot::Same).unwrap();
    let forecast = of(CELLS);
    let mut draws = forecast.draws(40_000, 7).unwrap();
    draws.sort_by(f64::total_cmp);
    for probability in [0.05, 0.5, 0.95] {
        let [closed, drawn] = [forecast.life().quantile(probability), draws[(probability * 40_000.0) as usize]];
        check("closed form over draws", closed / drawn, 1.0, 0.005);
    }
    let [coarse, fine] = [of(12).life(), of(163).life()];
    for probability in [0.05, 0.5, 0.95] {
        check("12 cells over 163", coarse.quantile(probability) / fine.quantile(probability), 1.0, 0.003);
    }
    assert_eq!(forecast.draws(10, 7).unwrap(), forecast.draws(10, 7).unwrap());
}

/// From a length (mm) to the last reading.
fn path(from_mm: f64) -> Vec<Interval> {
    cells(from_mm * MM, 49.8 * MM, CELLS, &delta_k).unwrap()
}

/// Cycles between two lengths of the readings (m).
fn cycles(panel: &MeasuredCurve, from: f64, to: f64) -> f64 {
    let at = |length: f64| panel.cycles[panel.crack_length.iter().position(|a| (a - length).abs() < 1e-9).unwrap()];
    at(to) - at(from)
}

/// Coverage of the 90 % band and continuous ranked probability score over the true value, summed over predictions.
#[derive(Debug, Clone, Copy, Default)]
struct Score {
    inside: f64,
    crps: f64,
    count: f64,
}

impl Score {
    fn coverage(&self) -> f64 {
        self.inside / self.count
    }

    fn percent(&self) -> f64 {
        100.0 * self.crps / self.count
    }

    /// A prediction `median · exp(t_ν s)` beside what was measured.
    fn add(&mut self, median: f64, deviation: f64, t: &[f64], measured: f64) {
        // First and last are the ends of the band.
        let at = |t: f64| median * (t * deviation).exp();
        self.inside += f64::from(u8::from((at(t[LEVELS])..=at(t[LEVELS + 1])).contains(&measured)));
        let loss = |(i, t): (usize, &f64)| {
            let (level, quantile) = ((i as f64 + 0.5) / LEVELS as f64, at(*t));
            (f64::from(u8::from(measured < quantile)) - level) * (quantile - measured)
        };
        self.crps += 2.0 * t[..LEVELS].iter().enumerate().map(loss).sum::<f64>() / (LEVELS as f64 * measured);
        self.count += 1.0;
    }
}

/// Quantiles of t at the levels of a score, and of the 90 % band.
fn t_levels(freedom: usize) -> Vec<f64> {
    static KNOWN: Mutex<Option<HashMap<usize, Vec<f64>>>> = Mutex::new(None);
    let mut known = KNOWN.lock().unwrap();
    let levels = (0..LEVELS).map(|i| (i as f64 + 0.5) / LEVELS as f64).chain([0.05, 0.95]);
    known
        .get_or_insert_default()
        .entry(freedom)
        .or_insert_with(|| levels.map(|p| t_quantile(p, freedom as f64)).collect())
        .clone()
}

/// Mean and variance (n - 1) of numbers.
fn moments(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (mean, values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0))
}

/// Scores of panels kept back: life; life left from 20 and 30 mm without own readings; the same with them. Of the model and the rival.
#[derive(Default)]
struct Scores {
    model: [Score; 5],
    rival: [Score; 5],
}

fn judge(seen: &[MeasuredCurve], kept_back: &[MeasuredCurve], scores: &mut Scores) {
    let lot = fit(&specimens(seen, 50), None).unwrap();
    let t = t_levels(lot.freedom as usize);
    let ends = |from: f64| (from * MM, 49.8 * MM);
    for (place, start) in STARTS.into_iter().enumerate() {
        let path = path(start);
        let alike = lot.forecast(&path, None, Lot::Same).unwrap().life();
        let (from, to) = ends(start);
        let lives: Vec<f64> = seen.iter().map(|panel| cycles(panel, from, to).ln()).collect();
        let count = lives.len() as f64;
        let (mean, variance) = moments(&lives);
        for panel in kept_back {
            let measured = cycles(panel, from, to);
            scores.model[place].add(alike.median, alike.deviation, &t, measured);
            let deviation = (variance * (1.0 + 1.0 / count)).sqrt();
            scores.rival[place].add(mean.exp(), deviation, &t_levels(seen.len() - 1), measured);
            if place == 0 {
                continue;
            }
            let own = Specimen::new("own", &readings(panel, from), &delta_k, 50).unwrap();
            let life = lot.forecast(&path, Some(&own), Lot::Same).unwrap().life();
            scores.model[place + 2].add(life.median, life.deviation, &t, measured);
            // Regression of ln life left on ln cycles of the last growth.
            let last = |panel: &MeasuredCurve| cycles(panel, from - LAST_GROWTH, from).ln();
            let x: Vec<f64> = seen.iter().map(last).collect();
            let (mean_x, variance_x) = moments(&x);
            let both: f64 = x.iter().zip(&lives).map(|(x, y)| (x - mean_x) * (y - mean)).sum::<f64>() / (count - 1.0);
            let slope = both / variance_x;
            let rest = (variance - slope * both) * (count - 1.0) / (count - 2.0);
            let off = last(panel) - mean_x;
            let deviation = (rest * (1.0 + 1.0 / count + off * off / (variance_x * (count - 1.0)))).sqrt();
            scores.rival[place + 2].add((mean + slope * off).exp(), deviation, &t_levels(seen.len() - 2), measured);
        }
    }
}

/// Scores over halves of the panels drawn at random.
fn halves(panels: &[MeasuredCurve], count: usize) -> Scores {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut scores = Scores::default();
    for _ in 0..count {
        let mut order: Vec<usize> = (0..panels.len()).collect();
        for last in (1..order.len()).rev() {
            order.swap(last, (random.next_u64() % (last as u64 + 1)) as usize);
        }
        let of = |places: &[usize]| places.iter().map(|&place| panels[place].clone()).collect::<Vec<_>>();
        let (seen, kept_back) = order.split_at(panels.len() / 2);
        judge(&of(seen), &of(kept_back), &mut scores);
    }
    let names = ["life", "20 mm, no own", "30 mm, no own", "20 mm, own", "30 mm, own"];
    for (name, (model, rival)) in names.iter().zip(scores.model.iter().zip(&scores.rival)) {
        println!(
            "{name}: {:.3} {:.2} %; lognormal {:.3} {:.2} %; ratio {:.3}",
            model.coverage(),
            model.percent(),
            rival.coverage(),
            rival.percent(),
            model.crps / rival.crps
        );
    }
    scores
}

/// Bounds of coverage, score in percent and score over that of the rival: life, 20 mm with own readings, 30 mm with own readings.
fn check_halves(scores: &Scores, bounds: [([f64; 2], [f64; 2], f64); 3]) {
    for (place, (coverage, percent, ratio)) in [0, 3, 4].into_iter().zip(bounds) {
        let (model, rival) = (scores.model[place], scores.rival[place]);
        assert!((coverage[0]..=coverage[1]).contains(&model.coverage()), "{place}: coverage {}", model.coverage());
        assert!((percent[0]..=percent[1]).contains(&model.percent()), "{place}: score {}", model.percent());
        assert!(model.crps / rival.crps <= ratio, "{place}: score over that of a lognormal {}", model.crps / rival.crps);
    }
}

#[test]
fn lives_of_twenty_halves_kept_back_lie_in_their_bands() {
    let Some(panels) = panels() else { return };
    let scores = halves(&panels, 20);
    check_halves(
        &scores,
        [([0.874, 0.944], [3.85, 4.28], 1.02), ([0.874, 0.921], [4.39, 5.06], 0.95), ([0.844, 0.903], [5.72, 6.35], 0.99)],
    );
}

#[test]
#[ignore = "long: 200 fits to halves of the panels, half a minute"]
fn lives_of_two_hundred_halves_kept_back_lie_in_their_bands() {
    let Some(panels) = panels() else { return };
    let scores = halves(&panels, 200);
    check_halves(&scores, [([0.88, 0.94], [0.0, 4.2], 1.02), ([0.87, 0.94], [0.0, 4.9], 0.95), ([0.86, 0.93], [0.0, 6.3], 0.98)]);
    assert!(scores.model[2].coverage() >= 0.84, "from 30 mm without own readings: {}", scores.model[2].coverage());
}

/// Bands of few panels rest on scatter that is assumed: wide on purpose, by the half widths of the trial.
#[test]
fn bands_of_few_panels_are_wide_enough() {
    let Some(panels) = panels() else { return };
    let all = specimens(&panels, 50);
    let lives: Vec<f64> = panels.iter().map(|panel| cycles(panel, 9.0 * MM, 49.8 * MM)).collect();
    for (count, width) in [(1, 0.49), (2, 0.32), (3, 0.26), (5, 0.21)] {
        let (mut inside, mut judged, mut half) = (0, 0, 0.0);
        let groups = all.chunks_exact(count).take(8);
        for (place, few) in groups.clone().enumerate() {
            let band = fit(few, None).unwrap().forecast(&path(9.0), None, Lot::Same).unwrap().life().band(0.9);
            half += (band[1] / band[0]).sqrt() - 1.0;
            let others = (0..lives.len()).filter(|i| i / count != place);
            inside += others.clone().filter(|&i| (band[0]..=band[1]).contains(&lives[i])).count();
            judged += others.count();
        }
        let (coverage, half) = (inside as f64 / judged as f64, half / groups.len() as f64);
        assert!(coverage > 0.93, "{count} panels: {coverage}");
        assert!((half / width - 1.0).abs() < 0.25, "{count} panels: {half} for {width}");
    }
}
