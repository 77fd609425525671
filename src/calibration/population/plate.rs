//! Lives of a lot on a plate that was run: the closed form of [`super::forecast`] over the ΔK that the run took down.
//!
//! A specimen of the lot takes the path of the run. Where its crack stands is told by the way of the fastest tip since N = 0, the length of
//! a standard specimen, so that the cycles of a piece are `∫ ds / (da/dN)` with the ΔK of the rows, between them as
//! [`TipFactors`] has it. The run goes by the law of the lot, so that its cycles are the median; readings of the plate itself move it.
//!
//! Quantiles are computed at [`PLACES`] rows and read between them over the cycles of the run, both in logarithms.

use super::Population;
use super::forecast::{BEYOND_MAX, CELLS, Forecast, Life, Lot};
use super::intervals::{INTERVALS_MAX, Interval, IntervalReading, Specimen, Zones};
use super::student::t_quantile;
use perilife_base::error::{Error, Result, fail_if, input};
use perilife_base::monotone::Monotone;
use perilife_base::table::Fault;
use perilife_base::units::{MM, MPA_SQRT_M, round_off};
use perilife_growth::case::record::FittedRecord;
use perilife_growth::case::{Case, LawSource};
use perilife_growth::predict::factor_curve::TipFactors;
use perilife_growth::predict::recorded::way;
use perilife_growth::predict::{GoverningCrack, Prediction};
use perilife_measured::{MeasuredCurve, Source};
use perilife_plate::specimen::LengthConvention;

/// Share of specimens below the ends of a band and its middle.
pub const SHARES: [f64; 3] = [0.05, 0.5, 0.95];
/// Rows at which quantiles are computed.
pub const PLACES: usize = 24;
/// Cells from one such row to an end of the path.
const CELLS_OF_PIECE: usize = CELLS / 2;
/// Share of the life, at its ends, over which ΔK may be unknown or too far outside the calibrated range.
const REST_MAX: f64 = 0.02;
/// Share of a length by which two of it may differ.
const SAME_LENGTH: f64 = 1e-9;
/// Cycles that 5, 50 and 95 % of specimens do not reach.
pub type Quantiles = [f64; 3];
/// Why a plate has no band, in words.
pub type NoBand = String;

/// A plate that was run, seen by the lot that its law was fitted to.
#[derive(Debug, Clone)]
pub struct Plate {
    pub lot: Population,
    pub of: Lot,
    cycles: Vec<f64>,
    /// Way of the fastest tip at every row, the crack length at N = 0 counted, m.
    way: Vec<f64>,
    /// Crack length in the specimen's convention at every row, m.
    lengths: Vec<f64>,
    factors: TipFactors,
    zones: Zones,
    t: [f64; 3],
    /// First and last row between which ΔK is known and in range.
    known: [usize; 2],
}

#[derive(Debug, Clone, PartialEq)]
pub struct PlateBand {
    /// Cycles at which the crack is as long as in every row.
    pub reached: Vec<Quantiles>,
    /// Cycles from there to the end of the run; NaN where ΔK is not known.
    pub left: Vec<Quantiles>,
}

/// What is left at a crack length, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Left {
    pub crack_length: f64,
    /// Cycles to the end of the run by its own constants.
    pub cycles: f64,
    pub quantiles: Quantiles,
}

impl Population {
    /// That of a record; `None` where it has none.
    /// Errors: a table `[population]` that is none of a calibration.
    pub fn of_record(record: &FittedRecord) -> Result<Option<Population>> {
        let Some(table) = &record.population else { return Ok(None) };
        let wrong = |value: String, problem: &str| {
            input("fatigue.fitted", value, format!("has a [population] {problem}"), "calibrate again")
        };
        let lot: Population = match table.clone().try_into() {
            Ok(lot) => lot,
            Err(error) => return Err(wrong(record.material.clone(), &format!("that cannot be read: {}", error.message()))),
        };
        let positive = [
            ("law.pivot", lot.law.pivot),
            ("law.range", lot.law.range[0]),
            ("law.range", lot.law.range[1] - lot.law.range[0]),
            ("noise.length", lot.noise.length),
            ("noise.scatter", lot.noise.scatter),
            ("freedom", lot.freedom),
            ("specimens", lot.specimens.len() as f64),
        ];
        let finite = [lot.law.level, lot.law.slope, lot.level_of_lives, lot.between.level, lot.between.slope, lot.noise.white];
        let mut problem =
            positive.iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)).map(|(key, value)| (*key, *value));
        problem = problem.or(finite
            .into_iter()
            .chain(lot.covariance.as_flattened().iter().copied())
            .find(|v| !v.is_finite())
            .map(|v| ("numbers", v)));
        problem.map_or(Ok(Some(lot)), |(key, value)| Err(wrong(format!("{key} = {value}"), "without a lot")))
    }
}

/// Why lives of a case can have no band, whatever its run gives; the lot where they can.
/// Errors: as [`Population::of_record`].
pub fn lot_of(case: &Case) -> Result<std::result::Result<Population, NoBand>> {
    let record = match &case.law {
        _ if case.fatigue.initiation.is_some() => return Ok(Err("scatter of the S-N curve unknown".to_owned())),
        LawSource::Fitted(record) => record,
        _ => return Ok(Err("growth law entered as constants; use a fitted law".to_owned())),
    };
    let (given, recorded) = (case.loading.ratio, record.stress_ratio);
    let is_sum = case.specimen.convention == LengthConvention::SumOfTips;
    let why = match Population::of_record(record)? {
        None => "fitted law without [population]; calibrate again",
        Some(_) if case.loading.residual.is_some() => "not available with residual stress",
        Some(_) if case.loading.spectrum.is_some() => "not available for spectrum loading",
        Some(_) if (given - recorded).abs() > 1e-9 => &format!("law fitted at R = {recorded}, case R = {given}"),
        Some(_) if !case.specimen.is_through() => "not available for part-through cracks",
        Some(_) if is_sum && case.spends_bond_life() => "not available with driver = \"bond_strain\"",
        Some(lot) => return Ok(Ok(lot)),
    };
    Ok(Err(why.to_owned()))
}

impl Plate {
    /// Of a run of a case.
    /// Errors: as [`lot_of`].
    pub fn of(case: &Case, prediction: &Prediction) -> Result<std::result::Result<Self, NoBand>> {
        let lot = lot_of(case)?;
        Ok(lot.and_then(|lot| Plate::new(lot, case, prediction)))
    }

    fn new(lot: Population, case: &Case, prediction: &Prediction) -> std::result::Result<Self, NoBand> {
        let (Some(life), rows) = (prediction.life(), &prediction.curve) else { return Err("the life is unlimited".to_owned()) };
        fail_if!(life <= 0.0, "no crack grew".to_owned());
        let (way, governing) = (way(case, prediction), GoverningCrack::of(&case.specimen, rows));
        let known: Vec<usize> = (0..rows.len()).filter(|&i| rows[i].delta_k.is_finite() && rows[i].delta_k > 0.0).collect();
        let [low, high] = [lot.law.range[0] / BEYOND_MAX, lot.law.range[1] * BEYOND_MAX];
        let is_inside = |i: &usize| (low..=high).contains(&rows[*i].delta_k);
        let (Some(&first), Some(&last)) = (known.first(), known.iter().rev().find(|i| is_inside(i))) else {
            return Err(if known.is_empty() { "ΔK unknown".to_owned() } else { out_of_range(&lot, rows[known[0]].delta_k) });
        };
        if let Some(&row) = known.iter().take_while(|i| **i < last).find(|i| !is_inside(i)) {
            return Err(out_of_range(&lot, rows[row].delta_k));
        }
        let rest = (rows[first].cycles + life - rows[last].cycles) / life;
        let too_high = known.iter().find(|i| **i > last);
        if rest > REST_MAX {
            let why = too_high.map_or_else(|| "ΔK unknown".to_owned(), |&row| out_of_range(&lot, rows[row].delta_k));
            return Err(format!("{why}, over {:.1} % of the life", 100.0 * rest));
        }
        let mut reached = f64::NEG_INFINITY;
        let rising = known.iter().filter(|i| **i <= last).filter_map(|&i| {
            let is_longer = way[i] > reached * (1.0 + SAME_LENGTH);
            reached = reached.max(way[i]);
            is_longer.then(|| (way[i], rows[i].delta_k))
        });
        let rising: Vec<(f64, f64)> = rising.collect();
        fail_if!(rising.len() < 2 || rows[last].cycles <= rows[first].cycles, "no crack grew".to_owned());
        let factors = TipFactors::new(rising.iter().copied());
        let zones = Zones::new(way[first], way[last], &|way| factors.at(way)).map_err(words)?;
        let t = t_quantile(SHARES[2], lot.freedom);
        Ok(Plate {
            of: case.lot,
            cycles: rows.iter().map(|row| row.cycles).collect(),
            lengths: rows.iter().map(|row| governing.length(row)).collect(),
            way,
            factors,
            zones,
            t: [-t, 0.0, t],
            known: [first, last],
            lot,
        })
    }

    /// Band of every row.
    /// Errors: ΔK between rows that is too far outside the calibrated range.
    pub fn band(&self) -> std::result::Result<PlateBand, NoBand> {
        let ([first, last], count) = (self.known, self.cycles.len());
        let (start, end, life) = (self.cycles[first], self.cycles[last], self.cycles[count - 1]);
        let whole = self.forecast(self.way[first], self.way[last], None).map_err(words)?;
        let to_row: Vec<f64> = self.cycles.iter().map(|n| n - start).collect();
        let from_row: Vec<f64> = self.cycles.iter().map(|n| end - n).collect();
        let centre = self.centre(&whole);
        let reached = self.along(&to_row, centre, &|i| self.forecast(self.way[first], self.way[i], None))?;
        let left = self.along(&from_row, centre, &|i| self.forecast(self.way[i], self.way[last], None))?;
        // Where ΔK is not known, the cycles of the run are taken with the scatter of the rest.
        let mut so_far = [0.0; 3];
        let reached_at = |i: usize| {
            let (inside, own) = (i.clamp(first, last), self.cycles[i]);
            let here = if to_row[inside] > 0.0 { scaled(reached[inside], own, to_row[inside]) } else { [own; 3] };
            so_far = [0, 1, 2].map(|k| here[k].max(so_far[k]));
            so_far
        };
        let left_at = |i: usize| {
            let (inside, own) = (i.max(first), life - self.cycles[i]);
            match inside {
                _ if own <= 0.0 => [0.0; 3],
                _ if from_row[inside] > 0.0 => scaled(left[inside], own, from_row[inside]),
                _ => [f64::NAN; 3],
            }
        };
        Ok(PlateBand { reached: (0..count).map(reached_at).collect(), left: (0..count).map(left_at).collect() })
    }

    /// Quantiles of a piece of the path for every row, `run` being its cycles in the run, which goes by the law of the lot and is the median: at
    /// some rows by the closed form of `piece` times the `centre` of the whole, at the others between them. The closed form keeps the mean of a
    /// piece that is short beside the noise, not its median.
    fn along(
        &self,
        run: &[f64],
        centre: f64,
        piece: &dyn Fn(usize) -> Result<Forecast>,
    ) -> std::result::Result<Vec<Quantiles>, NoBand> {
        let mut places = self.places(run);
        places.sort_by(|a, b| run[*a].total_cmp(&run[*b]));
        let mut logarithms: Vec<[f64; 4]> = Vec::with_capacity(places.len());
        for place in places {
            let (Life { median, deviation, .. }, middle) = (piece(place).map_err(words)?.life(), run[place].ln());
            let [low, _, high] = self.t.map(|t| (centre * median).ln() + t * deviation);
            let mut y = [low.min(middle), middle, high.max(middle)];
            if let Some(before) = logarithms.last() {
                y = [0, 1, 2].map(|k| y[k].max(before[k + 1]));
            }
            logarithms.push([run[place].ln(), y[0], y[1], y[2]]);
        }
        let [Some(least), Some(most)] = [logarithms.first(), logarithms.last()].map(|row| row.map(|row| row[0])) else {
            return Err("no crack grew".to_owned());
        };
        let curves = [0, 1, 2].map(|k| Monotone::new(logarithms.iter().map(move |row| [row[0], row[k + 1]])));
        let of_row = |run: &f64| {
            let x = run.max(0.0).ln();
            let inside = x.clamp(least, most);
            [0, 1, 2].map(|k| (curves[k].at(inside) + x - inside).exp())
        };
        Ok(run.iter().map(of_row).collect())
    }

    /// Rows at which quantiles are computed, half of them even in the logarithm of the cycles of their pieces, half along the way.
    fn places(&self, run: &[f64]) -> Vec<usize> {
        let [first, last] = self.known;
        let is_rest = run[first] > run[last];
        // Pieces without growth have no cells.
        let grows = |i: &usize| {
            let (from, to) = if is_rest { (self.way[*i], self.way[last]) } else { (self.way[first], self.way[*i]) };
            run[*i] > 0.0 && to > from * (1.0 + SAME_LENGTH)
        };
        let rows: Vec<usize> = (first..=last).filter(grows).collect();
        if rows.len() <= PLACES {
            return rows;
        }
        let spread = |of: &dyn Fn(usize) -> f64| -> Vec<usize> {
            let [from, to] = [of(rows[0]), of(rows[rows.len() - 1])];
            let distance = |i: usize, wanted: f64| (of(i) - wanted).abs();
            let nearest = |wanted: f64| {
                rows.iter().copied().min_by(|a, b| distance(*a, wanted).total_cmp(&distance(*b, wanted))).unwrap_or(rows[0])
            };
            let half = PLACES / 2;
            (0..half).map(|i| nearest(from + (to - from) * i as f64 / (half - 1) as f64)).collect()
        };
        let mut places = spread(&|i| run[i].ln());
        places.extend(spread(&|i| self.way[i]));
        places.sort_unstable();
        places.dedup();
        places
    }

    /// Readings of this very plate as a specimen; `curve` has been set against the case. A single one says where the crack is, and no rate.
    /// Errors: a reading that is not on the curve of the run; no growth.
    pub fn own(&self, curve: &MeasuredCurve) -> Result<Specimen> {
        let (shortest, longest) = (self.lengths[self.known[0]], self.lengths[self.known[1]]);
        for (i, &length) in curve.crack_length.iter().enumerate() {
            if length < shortest * (1.0 - SAME_LENGTH) || length > longest * (1.0 + SAME_LENGTH) {
                let Source { file, length_column, length_unit, .. } = &curve.source;
                let value = round_off(length / length_unit).to_string();
                let fault = Fault { file, line: Some(curve.line(i)), key: Some(length_column), value: Some(&value) };
                let [from, to] = [shortest, longest].map(|length| round_off(length / MM));
                let remedy =
                    "give readings of this plate within it, or the crack length of the first one as specimen.crack_length_mm";
                return Err(fault.error(format!("is not on the predicted curve, {from} to {to} mm"), remedy));
            }
        }
        let loads = curve.load_history();
        let [over_length, over_way] = [self.way_over_length(), Monotone::new(self.pairs().map(|[length, way]| [way, length]))];
        let reading = |i: usize| IntervalReading {
            length: over_length.at(curve.crack_length[i]),
            cycles: curve.cycles[i],
            counts: curve.counts(i),
        };
        let readings: Vec<IntervalReading> = (0..curve.cycles.len()).map(reading).collect();
        if readings.len() == 1 {
            return Ok(Specimen { name: curve.specimen.clone(), intervals: Vec::new() });
        }
        Specimen::new(&curve.specimen, &readings, &|way| self.factors.at(way) * loads.at(over_way.at(way)), INTERVALS_MAX)
    }

    /// What is left from a crack length on (m), of a plate of the lot or of the one that `own` was read of, which had no longer one then.
    /// Errors: a length beyond the rows with ΔK; one that is shorter than the last of the readings.
    pub fn left(&self, length: f64, own: Option<&Specimen>) -> Result<Left> {
        let [first, last] = self.known;
        let way = self.way_over_length().at(length);
        let refuse =
            |problem: String| Err(input("crack length, mm", round_off(length / MM), problem, "give a length between them"));
        if length < self.lengths[first] * (1.0 - SAME_LENGTH) || way >= self.way[last] {
            let [from, to] = [first, last].map(|i| round_off(self.lengths[i] / MM));
            return refuse(format!("is not on the part of the curve with a known ΔK, {from} to {to} mm"));
        }
        let read = own.and_then(|own| own.intervals.last()).map_or(f64::NEG_INFINITY, |interval| interval.to);
        if way < read * (1.0 - SAME_LENGTH) {
            let read = self.length_over_way().at(read);
            return refuse(format!("is shorter than the last reading, {} mm", round_off(read / MM)));
        }
        let of_lot = self.forecast(way, self.way[last], None)?.life();
        let life = own.map_or(Ok(of_lot), |own| self.forecast(way, self.way[last], Some(own)).map(|own| own.life()))?;
        let centre = self.centre(&self.forecast(self.way[first], self.way[last], None)?);
        let at = Monotone::new(self.lengths.iter().zip(&self.cycles).map(|(a, n)| [*a, *n])).at(length);
        let whole = self.cycles[self.cycles.len() - 1] - at;
        // Of the piece whose ΔK is known, and of what lies beyond it.
        let scale = centre * whole / (self.cycles[last] - at);
        let [low, _, high] = self.t.map(|t| scale * life.median * (t * life.deviation).exp());
        let middle = life.median / of_lot.median * whole;
        Ok(Left { crack_length: length, cycles: whole, quantiles: [low.min(middle), middle, high.max(middle)] })
    }

    /// Cycles of the run over the median of the closed form, of the piece whose ΔK is known.
    fn centre(&self, whole: &Forecast) -> f64 {
        let [start, end] = self.known.map(|row| self.cycles[row]);
        (end - start) / whole.life().median
    }

    /// Crack length up to which readings of the plate say its rate, m; of a single one that itself.
    pub fn read_to(&self, own: &Specimen, curve: &MeasuredCurve) -> f64 {
        own.intervals.last().map_or(curve.crack_length[0], |interval| self.length_over_way().at(interval.to))
    }

    /// The whole life in cells: where they end along the way of the fastest tip, m, and what the lot says of their cycles.
    /// Errors: as [`Plate::band`].
    pub fn whole(&self) -> Result<(Vec<f64>, Forecast)> {
        let [from, to] = self.known.map(|row| self.way[row]);
        let cells = self.zones.cells(from, to, CELLS_OF_PIECE, &|way| self.factors.at(way))?;
        Ok((cells.iter().map(|cell| cell.to).collect(), self.forecast(from, to, None)?))
    }

    /// Life over a piece of the way of the fastest tip, m.
    fn forecast(&self, from: f64, to: f64, own: Option<&Specimen>) -> Result<Forecast> {
        let delta_k = |way: f64| self.factors.at(way);
        let mut path = self.zones.cells(from, to, CELLS_OF_PIECE, &delta_k)?;
        // The noise goes on where the readings end, and a piece without readings lies between.
        if let Some(read) = own.and_then(|own| own.intervals.last()).filter(|read| from > read.to * (1.0 + SAME_LENGTH)) {
            let gap = self.zones.cells(read.to, from, 1, &delta_k)?[0].zone[1];
            path.iter_mut().for_each(|Interval { zone, .. }| *zone = zone.map(|zone| zone + gap));
        }
        self.lot.forecast(&path, own, self.of)
    }

    fn pairs(&self) -> impl Iterator<Item = [f64; 2]> {
        self.lengths.iter().zip(&self.way).map(|(length, way)| [*length, *way])
    }

    fn way_over_length(&self) -> Monotone {
        Monotone::new(self.pairs())
    }

    fn length_over_way(&self) -> Monotone {
        Monotone::new(self.pairs().map(|[length, way]| [way, length]))
    }
}

/// Quantiles of a piece of so many cycles of the run as those of a somewhat larger one.
fn scaled(quantiles: Quantiles, run: f64, of: f64) -> Quantiles {
    quantiles.map(|cycles| cycles * run / of)
}

fn out_of_range(lot: &Population, delta_k: f64) -> NoBand {
    let [low, high] = lot.law.range.map(|k| k / MPA_SQRT_M);
    let k = delta_k / MPA_SQRT_M;
    format!("ΔK = {k:.2} MPa√m is more than a factor {BEYOND_MAX} outside the tested {low:.2} to {high:.2} MPa√m")
}

fn words(error: Error) -> NoBand {
    match error {
        Error::Input(error) => format!("{} {}", error.value.unwrap_or_default(), error.problem),
        other => other.to_string(),
    }
}
