//! Fleets: lives of plates that differ in initial crack length, load and law, on the K(a) of one run ([`crate::predict::recorded`]).
//!
//! Initial lengths and loads are two columns of a [`hypercube`]. Laws are drawn as the band of the life has them, cell by cell of the path
//! ([`Forecast::draw`](crate::calibration::population::forecast::Forecast::draw)): rate of the lot, scatter between specimens, noise along
//! the crack, uncertainty of the lot itself. So a fleet of one initial length under one load has the quantiles of the band.

use super::detection::Schedule;
use super::distribution::{hypercube, normal_quantile};
use crate::calibration::population::forecast::Forecast;
use crate::calibration::population::law::MeanLaw;
use crate::calibration::population::plate::{NoBand, Plate};
use crate::calibration::population::student::normal_cdf;
use crate::case::{Case, Fleet, InitialLength};
use crate::error::{Result, input_missing};
use crate::predict::Prediction;
use crate::predict::laws::growth_law;
use crate::predict::recorded::{Change, Recorded, RecordedLife};

/// Standard deviations by which a load differs at most.
const LOAD_DEVIATIONS: f64 = 3.0;

/// A plate of a fleet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FleetPlate {
    /// Initial crack length, m.
    pub initial_length: f64,
    /// Load over that of the case.
    pub load: f64,
    /// Its growth rate over that of the median law, mean over the cycles of the plate of the run.
    pub rate_factor: f64,
    /// Its life.
    pub life: RecordedLife,
    /// Probability that inspections miss its crack to the end; `None` without inspections, or of an unlimited life.
    pub missed: Option<f64>,
}

/// Lives of a fleet.
#[derive(Debug, Clone, PartialEq)]
pub struct FleetLives {
    /// Every plate, in the order in which they are drawn.
    pub plates: Vec<FleetPlate>,
    /// Why all plates have the law of the case; `None` where laws are drawn.
    pub one_law: Option<NoBand>,
}

/// Refuses a fleet in which all plates are alike.
/// Errors: neither a lot whose law scatters nor a scatter of initial length or load.
pub fn check(fleet: &Fleet, one_law: Option<&NoBand>) -> Result<()> {
    match one_law.filter(|_| !fleet.scatters()) {
        None => Ok(()),
        Some(why) => Err(input_missing(
            "fleet",
            format!("has nothing that scatters: {why}"),
            "give fleet.initial_length_mm = { median, standard_deviation_ln }, fleet.load_scatter, or a fitted record of several specimens",
        )),
    }
}

/// Lives of a fleet on the K(a) of a run, with the plate as its lot sees it, or why it does not.
/// Errors: as [`check`] and [`Recorded::of`].
pub fn lives(
    case: &Case,
    prediction: &Prediction,
    fleet: &Fleet,
    plate: std::result::Result<&Plate, &NoBand>,
    inspections: Option<Schedule>,
) -> Result<FleetLives> {
    check(fleet, plate.err())?;
    let recorded = Recorded::of(case, prediction)?;
    let mut drawn = hypercube(fleet.plates, 2, fleet.seed).into_iter();
    let mut next = || {
        let row = drawn.next().unwrap_or_default();
        let [of_length, of_load] = [0, 1].map(|column| row.get(column).copied().unwrap_or(0.5));
        let own = recorded.unchanged();
        let crack_length = fleet.initial_length.map_or(own.crack_length, |lengths| length(lengths, of_length));
        Change { load: load(fleet.load_scatter, of_load), crack_length, ..own }
    };
    let live = |change: Change, rate_factor: f64, rate: &dyn Fn(f64, f64) -> f64| {
        let mut inspected = inspections.map(Schedule::begin);
        let life = recorded.life_by(change, rate, |cycles, lengths| {
            if let Some(inspected) = &mut inspected {
                inspected.grow(cycles, lengths, |_, _, _, _| ());
            }
        });
        let missed = inspected.filter(|_| life.cycles.is_finite()).map(|inspected| inspected.missed);
        FleetPlate { initial_length: change.crack_length, load: change.load, rate_factor, life, missed }
    };
    let plate = match plate {
        Ok(plate) => plate,
        Err(why) => {
            let (law, ratio) = (growth_law(case)?, case.loading.ratio);
            let plates = (0..fleet.plates).map(|_| live(next(), 1.0, &|k, _| law.rate(k, ratio))).collect();
            return Ok(FleetLives { plates, one_law: Some(why.clone()) });
        }
    };
    let (ends, forecast) = plate.whole()?;
    let lot = LotRates::new(case, &recorded, plate.lot.law, ends, &forecast);
    let plates = forecast.draw(fleet.plates, fleet.seed, |factors| {
        let all: f64 = forecast.cells().iter().sum();
        let own: f64 = forecast.cells().iter().zip(factors).map(|(cycles, factor)| cycles * factor).sum();
        live(next(), all / own, &|k, way| lot.rate(k, way, factors))
    })?;
    Ok(FleetLives { plates, one_law: None })
}

/// Rates of the specimens of a lot along a path in cells.
struct LotRates {
    law: MeanLaw,
    /// ΔK over K_max.
    range_share: f64,
    /// ΔK up to which nothing grows, Pa√m.
    threshold: f64,
    /// Ends of the cells along the way, m.
    ends: Vec<f64>,
    /// Median cycles of every cell over those by the law.
    shares: Vec<f64>,
}

impl LotRates {
    fn new(case: &Case, recorded: &Recorded, law: MeanLaw, ends: Vec<f64>, forecast: &Forecast) -> Self {
        let shares = vec![1.0; ends.len()];
        let (range_share, threshold) = (case.loading.range_share(), case.fatigue.threshold);
        let mut lot = LotRates { law, range_share, threshold, ends, shares };
        // The plate of the run by the law alone, cell by cell: one cell grows at its rate, the others without taking cycles.
        // Beyond the last, where the lot says nothing, its factors are taken.
        let end = lot.ends[lot.ends.len() - 1];
        let by_law = |cell: usize| {
            let is_in = |way: f64| way <= end && lot.cell(way) == cell;
            recorded.whole(|k, way| if is_in(way) { lot.law_rate(k) } else { f64::INFINITY })
        };
        let shares = (0..lot.ends.len()).map(|cell| forecast.cells()[cell] / by_law(cell));
        lot.shares = shares.map(|share| if share.is_finite() && share > 0.0 { share } else { 1.0 }).collect();
        lot
    }

    fn cell(&self, way: f64) -> usize {
        self.ends.partition_point(|end| *end < way).min(self.ends.len() - 1)
    }

    fn law_rate(&self, k_max: f64) -> f64 {
        let delta_k = k_max * self.range_share;
        if delta_k <= self.threshold { 0.0 } else { self.law.log_rate(delta_k).exp() }
    }

    /// da/dN, m/cycle, of a specimen with these cycles in every cell over the median.
    fn rate(&self, k_max: f64, way: f64, factors: &[f64]) -> f64 {
        let cell = self.cell(way);
        self.law_rate(k_max) / (self.shares[cell] * factors[cell])
    }
}

/// Initial crack length, m, at a probability.
fn length(of: InitialLength, probability: f64) -> f64 {
    match of {
        InitialLength::LogNormal { median, deviation_ln } => median * (deviation_ln * normal_quantile(probability)).exp(),
        InitialLength::Normal { mean, deviation } => {
            let below = normal_cdf(-mean / deviation);
            mean + deviation * normal_quantile((below + probability * (1.0 - below)).clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON))
        }
    }
}

/// Load over that of the case at a probability: normal within three deviations.
fn load(scatter: f64, probability: f64) -> f64 {
    let below = normal_cdf(-LOAD_DEVIATIONS);
    1.0 + scatter * normal_quantile(below + probability * (1.0 - 2.0 * below))
}
