//! Fleets: lives of plates that differ in initial crack length, load and law, on the K(a) of one run ([`perilife_growth::predict::recorded`]).
//!
//! Initial lengths and loads are two columns of a [`hypercube`]. Laws are drawn as the band of the life has them, cell by cell of the path
//! ([`Forecast::draw`](crate::population::forecast::Forecast::draw)): rate of the lot, scatter between specimens, noise along
//! the crack, uncertainty of the lot itself. So a fleet of one initial length under one load has the quantiles of the band.
//!
//! Every plate has its own cycles from the detectable length to the length at which it breaks, by its own law and under its own load. All plates
//! are inspected after the same cycles, since nobody knows which is the fast one: first at the 5 % quantile of their cycles to the detectable
//! length, or where the user says, then by the 5 % quantile of the cycles from there to the end over the factor.

use super::detection::{Detection, Schedule};
use super::distribution::{hypercube, normal_quantile, quantile};
use crate::population::forecast::Forecast;
use crate::population::plate::{NoBand, Plate};
use crate::population::student::normal_cdf;
use perilife_base::error::{Result, input_missing};
use perilife_growth::case::{Case, Fleet, InitialLength};
use perilife_growth::predict::laws::growth_law;
use perilife_growth::predict::recorded::{Change, Recorded, RecordedLife};
use perilife_growth::predict::{Prediction, StopReason};
use perilife_laws::growth_law::GrowthLaw;

/// Share of plates whose cycles from detectable to critical are shorter than those that the interval is taken from.
const SHORTEST: f64 = 0.05;
/// Inspections up to which it is told with what probability a crack has been missed.
const TOLD: usize = 30;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FleetPlate {
    /// Initial crack length, m.
    pub initial_length: f64,
    /// Load over that of the case.
    pub load: f64,
    /// Its growth rate over that of the median law, mean over the cycles of the plate of the run.
    pub rate_factor: f64,
    pub life: RecordedLife,
    /// Crack length at which it breaks or its record ends, m; `None` of an unlimited life, and of one cut off by `stop.cycles_max`.
    pub critical_length: Option<f64>,
    /// Cycles at which its crack is as long as can be found, and from there to the end: infinite where it has none, or is cut off before; none at
    /// all of a plate that breaks before. `None`: not asked.
    pub window: Option<[f64; 2]>,
    /// Probability that inspections miss its crack to the end, 1 if it breaks before the first; `None` without them, or of an unlimited life.
    pub missed: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Looks {
    /// Length from which on cracks can be found, m, as [`FleetPlate::initial_length`].
    pub detectable: f64,
    /// What the cycles from there to the end are divided by.
    pub factor: f64,
    /// How cracks are found; `None`: not asked.
    pub detection: Option<Detection>,
    /// Cycles of the first inspection; `None`: the 5 % quantile of those to the detectable length.
    pub first: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Looked {
    /// Cycles of the first inspection of all plates.
    pub first: f64,
    pub every: f64,
    pub before_first: usize,
    /// Probability that a crack is missed by the first inspection, by the first two, and so on; mean over the plates that end.
    pub missed_after: Vec<f64>,
    /// The same by all inspections to the end.
    pub missed: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct FleetLives {
    /// Every plate, in the order in which they are drawn.
    pub plates: Vec<FleetPlate>,
    /// What inspections find; `None` where nobody asked, and where 5 % of plates break before their crack can be found.
    pub looked: Option<Looked>,
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
            format!("has no scatter: {why}"),
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
    looks: Option<Looks>,
) -> Result<FleetLives> {
    check(fleet, plate.err())?;
    let drawing = Drawing::new(case, Recorded::of(case, prediction)?, fleet, plate)?;
    let mut plates = drawing.each(|change, rate_factor, rate| {
        let mut seen = Seen::default();
        let life = drawing.recorded.life_by(change, rate, |cycles, lengths| seen.grow(cycles, lengths, looks));
        FleetPlate {
            initial_length: change.crack_length,
            load: change.load,
            rate_factor,
            life,
            critical_length: seen.last.filter(|_| life.cycles.is_finite() && life.stop != StopReason::RunOut),
            window: looks.map(|_| seen.window(life)),
            missed: None,
        }
    })?;
    let looked = looks.map_or(Ok(None), |looks| drawing.look(&mut plates, looks))?;
    Ok(FleetLives { plates, looked, one_law: plate.err().cloned() })
}

#[derive(Default)]
struct Seen {
    detectable_at: Option<f64>,
    /// Its last length, m.
    last: Option<f64>,
}

impl Seen {
    fn grow(&mut self, cycles: [f64; 2], lengths: [f64; 2], looks: Option<Looks>) {
        self.last = Some(lengths[1]);
        let reaches = looks.filter(|looks| self.detectable_at.is_none() && lengths[1] >= looks.detectable);
        self.detectable_at = self.detectable_at.or(reaches.map(|looks| {
            let grown = lengths[1] - lengths[0];
            let share = if grown > 0.0 { ((looks.detectable - lengths[0]) / grown).max(0.0) } else { 0.0 };
            cycles[0] + share * (cycles[1] - cycles[0])
        }));
    }

    fn window(&self, life: RecordedLife) -> [f64; 2] {
        match self.detectable_at {
            Some(at) => [at, life.cycles - at],
            None if life.stop == StopReason::RunOut => [f64::INFINITY; 2],
            None => [life.cycles, if life.cycles.is_finite() { 0.0 } else { f64::INFINITY }],
        }
    }
}

/// The plates of a fleet as they are drawn, as often as they are asked for.
struct Drawing<'f> {
    fleet: &'f Fleet,
    recorded: Recorded,
    laws: Laws,
}

enum Laws {
    /// That of the case, at its stress ratio.
    One(Box<dyn GrowthLaw>, f64),
    Lot(Box<LotRates>, Box<Forecast>),
}

impl<'f> Drawing<'f> {
    fn new(case: &Case, recorded: Recorded, fleet: &'f Fleet, plate: std::result::Result<&Plate, &NoBand>) -> Result<Self> {
        let laws = match plate {
            Err(_) => Laws::One(growth_law(case)?, case.loading.ratio),
            Ok(plate) => {
                let (ends, forecast) = plate.whole()?;
                let share = forecast.cells().iter().sum::<f64>() / forecast.life().median;
                let lot = LotRates { law: growth_law(case)?, ratio: case.loading.ratio, share, ends };
                Laws::Lot(Box::new(lot), Box::new(forecast))
            }
        };
        Ok(Drawing { fleet, recorded, laws })
    }

    /// Asks of every plate, by what it differs in, its growth rate over that of the median law, and its rates as [`Recorded::life_by`] takes them.
    fn each<T>(&self, mut ask: impl FnMut(Change, f64, &dyn Fn(f64, f64) -> f64) -> T) -> Result<Vec<T>> {
        let Fleet { plates, seed, initial_length, load_scatter } = *self.fleet;
        let mut drawn = hypercube(plates, 2, seed).into_iter();
        let mut next = || {
            let row = drawn.next().unwrap_or_default();
            let [of_length, of_load] = [0, 1].map(|column| row.get(column).copied().unwrap_or(0.5));
            let own = self.recorded.unchanged();
            let crack_length = initial_length.map_or(own.crack_length, |lengths| length(lengths, of_length));
            let load = if load_scatter > 0.0 { normal_above_zero(1.0, load_scatter, of_load) } else { 1.0 };
            Change { load, crack_length, ..own }
        };
        match &self.laws {
            Laws::One(law, ratio) => Ok((0..plates).map(|_| ask(next(), 1.0, &|k, _| law.rate(k, *ratio))).collect()),
            Laws::Lot(lot, forecast) => forecast.draw(plates, seed, |factors| {
                let all: f64 = forecast.cells().iter().sum();
                let own: f64 = forecast.cells().iter().zip(factors).map(|(cycles, factor)| cycles * factor).sum();
                ask(next(), all / own, &|k, way| lot.rate(k, way, factors))
            }),
        }
    }

    /// Inspects all plates after the same cycles. They are known once all plates are, so that they grow again.
    fn look(&self, plates: &mut [FleetPlate], looks: Looks) -> Result<Option<Looked>> {
        let [to_detectable, to_end] = [0, 1].map(|part| {
            let mut cycles: Vec<f64> = plates.iter().filter_map(|plate| plate.window).map(|window| window[part]).collect();
            cycles.sort_by(f64::total_cmp);
            quantile(&cycles, SHORTEST)
        });
        let (first, every) = (looks.first.unwrap_or(to_detectable), to_end / looks.factor);
        let is_known = every > 0.0 && every.is_finite() && first.is_finite();
        let Some(detection) = looks.detection.filter(|_| is_known) else { return Ok(None) };
        let before_first = plates.iter().filter(|plate| plate.life.cycles <= first && !plate.life.is_bound).count();
        // Shares of cracks that the first inspection finds, the second, and so on.
        let mut found_by: Vec<f64> = Vec::new();
        let mut own = plates.iter_mut();
        self.each(|change, _, rate| {
            let Some(plate) = own.next().filter(|plate| plate.life.cycles.is_finite()) else { return };
            let (mut inspected, mut place, mut before) = (Schedule { detection, cycles: [first, every] }.begin(), 0, 1.0);
            self.recorded.life_by(change, rate, |cycles, lengths| {
                inspected.grow(cycles, lengths, |_, _, _, missed| {
                    if place == found_by.len() && place < TOLD {
                        found_by.push(0.0);
                    }
                    found_by.get_mut(place).into_iter().for_each(|found| *found += before - missed);
                    (place, before) = (place + 1, missed);
                });
            });
            // Nothing is known of one that is cut off before.
            plate.missed = (!plate.life.is_bound || plate.life.cycles > first).then_some(inspected.missed);
        })?;
        let missed: Vec<f64> = plates.iter().filter_map(|plate| plate.missed).collect();
        let count = missed.len() as f64;
        let mut left = 1.0;
        let missed_after = found_by.into_iter().map(|found| {
            left -= found / count;
            left
        });
        Ok((!missed.is_empty()).then(|| Looked {
            first,
            every,
            before_first,
            missed_after: missed_after.collect(),
            missed: missed.iter().sum::<f64>() / count,
        }))
    }
}

/// Rates of the specimens of a lot along a path in cells.
struct LotRates {
    law: Box<dyn GrowthLaw>,
    ratio: f64,
    /// Sum of the median cycles of the cells over the median life.
    share: f64,
    /// Ends of the cells along the way, m.
    ends: Vec<f64>,
}

impl LotRates {
    /// da/dN, m/cycle, of a specimen with these cycles in every cell over the median.
    fn rate(&self, k_max: f64, way: f64, factors: &[f64]) -> f64 {
        let cell = self.ends.partition_point(|end| *end < way).min(self.ends.len() - 1);
        self.law.rate(k_max, self.ratio) / (self.share * factors[cell])
    }
}

fn length(of: InitialLength, probability: f64) -> f64 {
    match of {
        InitialLength::LogNormal { median, deviation_ln } => median * (deviation_ln * normal_quantile(probability)).exp(),
        InitialLength::Normal { mean, deviation } => normal_above_zero(mean, deviation, probability),
    }
}

/// A normal quantity as far as it is above zero, at a probability.
fn normal_above_zero(mean: f64, deviation: f64, probability: f64) -> f64 {
    let below = normal_cdf(-mean / deviation);
    mean + deviation * normal_quantile((below + probability * (1.0 - below)).clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON))
}
