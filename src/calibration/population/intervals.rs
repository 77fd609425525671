//! Reading intervals of specimens, and cells of a crack path whose life is asked for: growth between two crack lengths with ΔK along it;
//! and both as the law of a lot sees them, means over their cycles.

use crate::median::{NORMAL_MEDIAN, median};
use perilife_base::error::{Result, fail_if, input};
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_laws::curve::{CurveLaw, EFFECTS};
use perilife_measured::MeasuredCurve;

/// Most intervals of a specimen: more change neither constants nor bands, and time goes with their cube.
pub const INTERVALS_MAX: usize = 50;
/// Growth of an interval in resolutions of the reading: rounding then moves the logarithm of its rate by less than 0.2.
const RESOLUTIONS_MIN: f64 = 2.0;
/// Growth of an interval in standard deviations of a single reading.
const DEVIATIONS_MIN: f64 = 4.0;
/// Fewest readings whose third differences tell the error of one from the bend of the curve.
const READINGS_FOR_ERROR: usize = 12;
/// Share of a length by which two readings of it may differ.
const SAME_LENGTH: f64 = 1e-9;
/// Largest change of ln ΔK over the four points of a quadrature.
const STEP_OF_LOG_K: f64 = 0.1;
/// Gauss-Legendre abscissas on -1..1 and weights that add up to 1.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
    (-0.339_981_043_584_856_3, 0.326_072_577_431_273_07),
    (0.339_981_043_584_856_3, 0.326_072_577_431_273_07),
    (0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
];
/// Pieces in which a path is divided into equal parts of the zone coordinate.
const PATH_PIECES: usize = 400;
/// ΔK (Pa√m) at a crack length (m), of one specimen or plate under its own loads.
pub type RangeOfK<'a> = &'a dyn Fn(f64) -> f64;
/// The same of all tips whose growth adds up to the length.
pub type RangesOfTips<'a> = &'a dyn Fn(f64) -> Vec<f64>;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntervalReading {
    /// Crack length, m.
    pub length: f64,
    pub cycles: f64,
    /// Whether the growth since the reading before it counts.
    pub counts: bool,
}

/// Growth from one crack length, m, to a longer one.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    pub from: f64,
    pub to: f64,
    /// Measured cycles; NaN of a cell.
    pub cycles: f64,
    /// ln ΔK (Pa√m) of the tips at the points of quadrature over the crack length, the fastest first; -∞ of one that does not grow.
    pub(super) log_k: Vec<f64>,
    /// Weights of the points, m.
    weights: Vec<f64>,
    /// ln ΔK (Pa√m) of the tips at both ends.
    pub(super) ends: [Vec<f64>; 2],
    /// Zone coordinate `u = ∫ (ΔK / 10 MPa√m)⁻² da` at both ends, m.
    pub(super) zone: [f64; 2],
}

impl Interval {
    /// Points of quadrature: ln ΔK of the tips, and weight.
    pub(super) fn places(&self) -> impl Iterator<Item = (&[f64], f64)> {
        self.log_k.chunks_exact(self.log_k.len() / self.weights.len()).zip(self.weights.iter().copied())
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Specimen {
    pub name: String,
    pub intervals: Vec<Interval>,
}

impl Specimen {
    /// Readings of a curve under its own loads; `delta_k` is that of the load of the case.
    /// Errors: as [`Specimen::new`].
    pub fn of_curve(curve: &MeasuredCurve, delta_k: RangesOfTips<'_>) -> Result<Self> {
        let reading =
            |i: usize| IntervalReading { length: curve.crack_length[i], cycles: curve.cycles[i], counts: curve.counts(i) };
        let readings: Vec<IntervalReading> = (0..curve.cycles.len()).map(reading).collect();
        let loads = curve.load_history();
        let under_load = |length: f64| delta_k(length).into_iter().map(|k| k * loads.at(length)).collect();
        Specimen::of_tips(&curve.specimen, &readings, &under_load, INTERVALS_MAX)
    }

    /// Joins readings to at most `intervals_max` intervals that grow by more than the error of a reading in more than no cycles.
    ///
    /// Readings at one length or one cycle count, and readings that fall back, are passed over: an interval goes on until both have risen.
    /// Errors: a ΔK that is not above 0; no interval.
    pub fn new(name: &str, readings: &[IntervalReading], delta_k: RangeOfK<'_>, intervals_max: usize) -> Result<Self> {
        Self::of_tips(name, readings, &|length| vec![delta_k(length)], intervals_max)
    }

    /// The same for several tips.
    fn of_tips(name: &str, readings: &[IntervalReading], delta_k: RangesOfTips<'_>, intervals_max: usize) -> Result<Self> {
        let least = least_growth(readings);
        // Runs of readings between growths that do not count.
        let runs: Vec<Vec<IntervalReading>> =
            readings.chunk_by(|_, next| next.counts).map(|run| rising(run, least)).filter(|run| run.len() > 1).collect();
        let all: usize = runs.iter().map(|run| run.len() - 1).sum();
        let joined = all.div_ceil(intervals_max.max(1)).max(1);
        let mut intervals: Vec<Interval> = Vec::with_capacity(all.div_ceil(joined));
        for run in &runs {
            for start in (0..run.len() - 1).step_by(joined) {
                let steps = &run[start..=(start + joined).min(run.len() - 1)];
                let lengths: Vec<f64> = steps.iter().map(|reading| reading.length).collect();
                let cycles = steps[steps.len() - 1].cycles - steps[0].cycles;
                let zone = match intervals.last() {
                    None => 0.0,
                    Some(last) if lengths[0] <= last.to => last.zone[1],
                    Some(last) => integrate(&[last.to, lengths[0]], last.zone[1], delta_k)?.zone[1],
                };
                intervals.push(Interval { cycles, ..integrate(&lengths, zone, delta_k)? });
            }
        }
        let remedy = "give readings over more growth";
        fail_if!(intervals.is_empty(), input("measured.files", name, "has no growth beyond the scatter of its readings", remedy));
        Ok(Specimen { name: name.to_owned(), intervals })
    }
}

/// Cells of a path from one crack length to another (m), equal in the zone coordinate.
/// Errors: a ΔK that is not above 0; an end that is not longer.
pub fn cells(from: f64, to: f64, count: usize, delta_k: RangeOfK<'_>) -> Result<Vec<Interval>> {
    Zones::new(from, to, delta_k)?.cells(from, to, count, delta_k)
}

/// Zone coordinate along a path, by which it and its parts are divided into cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Zones {
    from: f64,
    to: f64,
    /// At the ends of equal pieces, from 0.
    zone: Vec<f64>,
}

impl Zones {
    /// From one crack length to another (m).
    /// Errors: as [`cells`].
    pub fn new(from: f64, to: f64, delta_k: RangeOfK<'_>) -> Result<Self> {
        check_longer(from, to)?;
        let delta_k = |length: f64| vec![delta_k(length)];
        let mut zones = Zones { from, to, zone: vec![0.0] };
        for i in 0..PATH_PIECES {
            let piece = integrate(&[zones.length(i), zones.length(i + 1)], zones.zone[i], &delta_k)?;
            zones.zone.push(piece.zone[1]);
        }
        Ok(zones)
    }

    /// Cells of a part of the path.
    /// Errors: as [`cells`].
    pub fn cells(&self, from: f64, to: f64, count: usize, delta_k: RangeOfK<'_>) -> Result<Vec<Interval>> {
        check_longer(from, to)?;
        let [start, end] = [from, to].map(|length| self.zone_at(length));
        let inner = |i: usize| self.length_at(start + (end - start) * i as f64 / count as f64).clamp(from, to);
        let ends: Vec<f64> = (0..=count)
            .map(|i| match i {
                0 => from,
                i if i == count => to,
                i => inner(i),
            })
            .collect();
        let mut cells: Vec<Interval> = Vec::with_capacity(count);
        for pair in ends.windows(2) {
            let start = cells.last().map_or(0.0, |cell| cell.zone[1]);
            cells.push(integrate(pair, start, &|length| vec![delta_k(length)])?);
        }
        Ok(cells)
    }

    fn length(&self, pieces: usize) -> f64 {
        self.from + (self.to - self.from) * pieces as f64 / PATH_PIECES as f64
    }

    fn zone_at(&self, length: f64) -> f64 {
        let place = (length - self.from) / (self.to - self.from) * PATH_PIECES as f64;
        let piece = (place.max(0.0) as usize).min(PATH_PIECES - 1);
        self.zone[piece] + (place - piece as f64) * (self.zone[piece + 1] - self.zone[piece])
    }

    fn length_at(&self, zone: f64) -> f64 {
        let next = self.zone.partition_point(|&u| u < zone).clamp(1, PATH_PIECES);
        let [before, after] = [self.zone[next - 1], self.zone[next]];
        self.length(next - 1) + (zone - before) / (after - before) * (self.length(next) - self.length(next - 1))
    }
}

fn check_longer(from: f64, to: f64) -> Result<()> {
    if from > 0.0 && to > from {
        return Ok(());
    }
    Err(input("stop.crack_length_mm", to / MM, format!("is not beyond {} mm", from / MM), "give a longer crack"))
}

/// Quadrature over a chain of lengths, loads being steady or linear between two of them.
fn integrate(lengths: &[f64], zone: f64, delta_k: RangesOfTips<'_>) -> Result<Interval> {
    let log_k = |length: f64| {
        let mut tips = delta_k(length);
        tips.sort_by(|a, b| b.total_cmp(a));
        if tips.first().is_some_and(|k| k.is_finite() && *k > 0.0) && tips.iter().all(|k| *k >= 0.0) {
            return Ok(tips.into_iter().map(f64::ln).collect::<Vec<f64>>());
        }
        let remedy = "narrow the window to lengths that the formula of the specimen covers";
        Err(input("measured.crack_length_mm", length / MM, "has no stress intensity range above 0", remedy))
    };
    let (from, to) = (lengths[0], lengths[lengths.len() - 1]);
    // Loads may change at a reading: each end has that of its own side.
    let inside = 1e-9 * (to - from);
    let ends = [log_k(from + inside)?, log_k(to - inside)?];
    let (mut points, mut weights) = (Vec::new(), Vec::with_capacity(GAUSS.len() * (lengths.len() - 1)));
    for pair in lengths.windows(2) {
        let step = pair[1] - pair[0];
        let change = log_k(pair[1] - 1e-9 * step)?[0] - log_k(pair[0] + 1e-9 * step)?[0];
        let pieces = (change.abs() / STEP_OF_LOG_K).ceil().clamp(1.0, 1000.0) as usize;
        let piece = step / pieces as f64;
        for i in 0..pieces {
            for (abscissa, weight) in GAUSS {
                let length = pair[0] + piece * (i as f64 + 0.5 + 0.5 * abscissa);
                points.push(log_k(length)?);
                weights.push(piece * weight);
            }
        }
    }
    let of_zone = |(tips, weight): (&Vec<f64>, &f64)| weight * (-2.0 * (tips[0] - (10.0 * MPA_SQRT_M).ln())).exp();
    let grown: f64 = points.iter().zip(&weights).map(of_zone).sum();
    // A tip that has stopped grows no more.
    let most = points.iter().map(Vec::len).max().unwrap_or(1);
    points.iter_mut().for_each(|tips| tips.resize(most, f64::NEG_INFINITY));
    Ok(Interval { from, to, cycles: f64::NAN, log_k: points.concat(), weights, ends, zone: [zone, zone + grown] })
}

/// Growth below which two readings do not tell a rate, m.
fn least_growth(readings: &[IntervalReading]) -> f64 {
    // Readings repeated at one length would make a smooth curve look rough.
    let mut lengths: Vec<f64> = readings.iter().map(|reading| reading.length).collect();
    lengths.dedup_by(|a, b| (*a - *b).abs() <= SAME_LENGTH * b.abs());
    let third: Vec<f64> = lengths.windows(4).map(|a| (a[3] - 3.0 * a[2] + 3.0 * a[1] - a[0]).abs()).collect();
    // Of readings with equal errors s, a third difference has the deviation √20 s.
    let error = if lengths.len() < READINGS_FOR_ERROR { 0.0 } else { median(&third) / (NORMAL_MEDIAN * 20.0_f64.sqrt()) };
    let steps: Vec<f64> = lengths.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let typical = if steps.is_empty() { 0.0 } else { median(&steps) };
    lengths.sort_by(f64::total_cmp);
    let apart = lengths.windows(2).map(|pair| (pair[1] - pair[0], SAME_LENGTH * pair[1]));
    let resolution = apart.filter(|(step, same)| step > same).map(|(step, _)| step).fold(f64::INFINITY, f64::min);
    // Readings at set lengths have their spacing, not their resolution, as the smallest step.
    let rounding = if resolution < 0.5 * typical { RESOLUTIONS_MIN * resolution } else { 0.0 };
    rounding.min(typical).max(DEVIATIONS_MIN * error)
}

/// Readings of which each is longer than the one before it by more than `least` (m), after more cycles.
fn rising(run: &[IntervalReading], least: f64) -> Vec<IntervalReading> {
    let mut kept: Vec<IntervalReading> = run.first().copied().into_iter().collect();
    for reading in run {
        let last = kept[kept.len() - 1];
        let growth = reading.length - last.length;
        if growth > 0.0 && growth >= least * (1.0 - 1e-9) && reading.cycles > last.cycles {
            kept.push(*reading);
        }
    }
    // What is left behind the last one belongs to its interval.
    if let (Some(&end), true) = (run.last(), kept.len() > 2) {
        let before = kept[kept.len() - 2];
        if end.length - before.length >= least && end.cycles > kept[kept.len() - 1].cycles {
            let last = kept.len() - 1;
            kept[last] = end;
        }
    }
    kept
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct IntervalRow {
    /// Means of 1, x, φ_k over the interval, weighted with its cycles.
    pub design: [f64; EFFECTS],
    /// ln of the cycles by the law.
    pub log_cycles: f64,
    /// Share of the interval's cycles in a metre at its start and its end, 1/m.
    pub density: [f64; 2],
    /// Integral of the squared density, 1/m: one over the length where it is even.
    pub inverse_length: f64,
    /// Zone coordinate at both ends, m.
    pub zone: [f64; 2],
    /// Mean distance of ln ΔK below and above the calibrated range.
    pub beyond: [f64; 2],
    /// Share of the interval's cycles outside the calibrated range.
    pub outside: f64,
    /// Whether the interval starts with the reading that ended the one before it.
    pub follows: bool,
}

/// Rates of the tips of a crack at a place, m/cycle together, and their design, weighted with the rates.
fn of_tips(law: &CurveLaw, log_k: &[f64]) -> ([f64; EFFECTS], f64) {
    let (mut design, mut rate) = ([0.0; EFFECTS], 0.0);
    for &log_k in log_k.iter().filter(|log_k| log_k.is_finite()) {
        let here = law.design(log_k);
        let own = here.iter().zip(law.effects()).map(|(x, effect)| x * effect).sum::<f64>().exp();
        rate += own;
        design.iter_mut().zip(here).for_each(|(sum, x)| *sum += own * x);
    }
    (design.map(|sum| sum / rate), rate)
}

pub(super) fn rows(law: &CurveLaw, intervals: &[Interval]) -> Vec<IntervalRow> {
    let [low, high] = law.range.map(f64::ln);
    let mut end = f64::NAN;
    let row = |interval: &Interval| {
        let (mut design, mut cycles, mut squares) = ([0.0; EFFECTS], 0.0, 0.0);
        let (mut beyond, mut outside) = ([0.0; 2], 0.0);
        for (log_k, weight) in interval.places() {
            let (here, rate) = of_tips(law, log_k);
            let inverse = 1.0 / rate;
            cycles += weight * inverse;
            squares += weight * inverse * inverse;
            let distance = [low - log_k[0], log_k[0] - high].map(|distance| distance.max(0.0));
            beyond = [0, 1].map(|side| beyond[side] + weight * inverse * distance[side]);
            outside += if distance == [0.0; 2] { 0.0 } else { weight * inverse };
            for (sum, x) in design.iter_mut().zip(here) {
                *sum += weight * inverse * x;
            }
        }
        let follows = interval.from == end;
        end = interval.to;
        IntervalRow {
            design: design.map(|sum| sum / cycles),
            log_cycles: cycles.ln(),
            density: [0, 1].map(|side| 1.0 / (of_tips(law, &interval.ends[side]).1 * cycles)),
            inverse_length: squares / (cycles * cycles),
            zone: interval.zone,
            beyond: beyond.map(|sum| sum / cycles),
            outside: outside / cycles,
            follows,
        }
    };
    intervals.iter().map(row).collect()
}
