//! Lives on recorded K(a): what another law, load, toughness or initial length makes of a run, as long as the path of its cracks stays.
//!
//! `N = Σ_i w_i ∫ ds / r(f K(s))` over the intervals between the rows of the run, s being the way of the fastest tip, f the load over that
//! of the run and ln K linear in s between rows. `w_i` are the cycles of the run in an interval over this integral with its own law, so
//! that the law of the run gives the life of the run whatever its rows lie between; they differ from 1 by what a straight ln K misses
//! ([`Recorded::misfit`]) and by retardation. Intervals before the run have the mean weight of its beginning. Three Gauss points an interval; a
//! life takes no memory.
//!
//! The path, and which tip leads, are those of the run: true of a single tip and of twins. Tips of unlike K share growth by the exponent
//! of the law of the run. Kinks do not depend on the load.

use super::laws::growth_law;
use super::{CurvePoint, Prediction, StopReason};
use crate::case::Case;
use crate::end_of_life::{demands, strength_reason};
use perilife_base::error::{Error, Result, fail_if, input, input_missing};
use perilife_laws::growth_law::GrowthLaw;
use perilife_laws::response::Response;
use perilife_plate::specimen::LengthConvention;
use perilife_plate::specimen::handbook::{HandbookFormula, handbook};

/// Share of a way by which two of it may differ.
const SAME: f64 = 1e-9;
/// Places of the Gauss points in an interval and their weights.
const GAUSS: [(f64, f64); 3] = [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
/// Initial length, over that of the run, down to which K of a handbook goes on before the curve, and intervals there.
const BY_HANDBOOK: (f64, usize) = (0.1, 64);
/// The same of other plates, whose K goes on as the power of the length by which it begins.
const BY_POWER: (f64, usize) = (0.8, 8);
/// Difference of the cycles of an interval from those by the law, over these, that retardation makes.
const RETARDED: f64 = 0.02;
/// Growth over the initial length in which that power is read.
const BEGINNING: f64 = 0.05;
/// Powers of the length that K may begin with.
const POWERS: [f64; 2] = [-1.0, 2.0];

/// K over the way of the fastest tip of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// In order; those before the first row of the run first.
    intervals: Vec<Interval>,
    /// Place of the first interval of the run itself.
    first: usize,
    /// Stress ratio R.
    ratio: f64,
    stop: StopReason,
    /// Why it would end by toughness and by net section.
    breaks: [StopReason; 2],
    cycles_max: f64,
    misfit: f64,
}

/// A row of the run, or a place before its first.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    /// Way of the fastest tip, the crack length at N = 0 counted, m.
    way: f64,
    /// Crack length that initial lengths are given in, m.
    length: f64,
    log_k: f64,
    cycles: f64,
    /// Required load over what toughness and net section bear.
    demands: [f64; 2],
}

/// What lies between two places.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Interval {
    from: Place,
    to: Place,
    weight: f64,
    nodes: [Node; 3],
}

/// A Gauss point.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    way: f64,
    /// Pa√m.
    k_max: f64,
    /// Metres that it stands for, times w.
    weight: f64,
}

/// In what a plate differs from the one that was run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Load over that of the run, above 0.
    pub load: f64,
    /// Initial crack length, m: of a standard specimen in its convention, of a plate that of the crack whose tip leads.
    pub crack_length: f64,
    /// Toughness over that of the run.
    pub toughness: f64,
}

/// A life on recorded K(a).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedLife {
    /// Cycles; infinite where the crack stands still.
    pub cycles: f64,
    pub stop: StopReason,
    /// Whether the plate lives on there: the record or `stop.cycles_max` ends, or the crack was shorter than K is known for.
    pub is_bound: bool,
    /// Whether the crack was that short, so that it was taken as long as the shortest.
    pub is_clipped: bool,
}

impl Recorded {
    /// Of a finished run of a case.
    /// Errors: a run in which no crack grew, or of which no K is known; a case without law.
    pub fn of(case: &Case, prediction: &Prediction) -> Result<Self> {
        let none = |why: &str| Error::Mechanics(format!("{}: {why}, so there is no K(a) to compute other lives on", case.name));
        let is_bent = |row: &CurvePoint| !row.response.is_near(&Response::PROPORTIONAL);
        if case.loading.residual.is_none() && prediction.curve.iter().any(is_bent) {
            let problem = "make K non-proportional to the load: no other life follows from K(a) of this run";
            return Err(input_missing("loading.pins", problem, "compute each case by itself"));
        }
        if let Some(residual) = &case.loading.residual {
            let problem = "shifts K whatever the load: no other life follows from the K(a) of this run";
            return Err(input(residual.key(), residual.words(), problem, "run each case by itself"));
        }
        fail_if!(prediction.phase_one.is_some(), none("phase I is of no K"));
        let places = places(case, prediction).ok_or_else(|| none("no K is known"))?;
        fail_if!(places.len() < 2, none("no crack grew"));
        let law = growth_law(case)?;
        let earlier = before(case, &places);
        let first = earlier.len() - 1;
        let (mut intervals, mut missed, mut life) = (Vec::with_capacity(first + places.len()), 0.0, 0.0);
        // Cycles of the run and by its law, interval by interval.
        let mut cycles: Vec<[f64; 2]> = Vec::with_capacity(places.len());
        for pair in places.windows(2) {
            let straight = Interval::new(pair[0], pair[1], 1.0);
            let (by_law, by_run) = (straight.cycles(&law_at(&*law, case.loading.ratio)), pair[1].cycles - pair[0].cycles);
            // A law without a rate there, or one without limit, has nothing to be set against.
            let weight = if by_law.is_finite() && by_law > 0.0 { by_run / by_law } else { 1.0 };
            cycles.push(if by_law.is_finite() && by_law > 0.0 { [by_run, by_law] } else { [0.0; 2] });
            (missed, life) = (missed + (by_run - by_law.min(2.0 * by_run)).abs(), life + by_run);
            intervals.push(Interval::new(pair[0], pair[1], weight));
        }
        // What retardation does at the start of the run it does to shorter cracks, from the first overload on.
        let is_retarded = |[by_run, by_law]: &[f64; 2]| (by_run - by_law).abs() > RETARDED * by_law;
        let start = cycles
            .iter()
            .position(is_retarded)
            .filter(|_| case.retardation.is_some())
            .map_or(0, |first| (first + 1).min(cycles.len() - 1));
        let end = places[start].length * (1.0 + BEGINNING);
        let beginning = cycles.iter().zip(&places).skip(start).take_while(|(_, place)| place.length < end);
        let sums = beginning.fold([0.0; 2], |sums, (own, _)| [sums[0] + own[0], sums[1] + own[1]]);
        let weight = if sums[1] > 0.0 { sums[0] / sums[1] } else { 1.0 };
        let earlier = earlier.windows(2).map(|pair| Interval::new(pair[0], pair[1], weight));
        Ok(Recorded {
            intervals: earlier.chain(intervals).collect(),
            first,
            ratio: case.loading.ratio,
            stop: prediction.stop,
            breaks: [StopReason::Toughness, StopReason::NetSectionYield].map(|breaks| strength_reason(case, breaks)),
            cycles_max: case.stop.cycles_max,
            misfit: missed / life,
        })
    }

    /// The plate of the run.
    pub fn unchanged(&self) -> Change {
        Change { load: 1.0, crack_length: self.intervals[self.first].from.length, toughness: 1.0 }
    }

    /// Shortest and longest initial crack length that K is known for, m.
    pub fn lengths(&self) -> [f64; 2] {
        [self.intervals[0].from.length, self.intervals[self.intervals.len() - 1].to.length]
    }

    /// Share of the life of the run by which cycles between its rows differ from those of a straight ln K.
    pub fn misfit(&self) -> f64 {
        self.misfit
    }

    pub fn life(&self, law: &dyn GrowthLaw, change: Change) -> RecordedLife {
        let rate = law_at(law, self.ratio);
        self.life_by(change, rate, |_, _| ())
    }

    /// Life of a plate by a rate, m/cycle, of K_max, Pa√m, and the path length, m; `seen` gets the ends of every interval.
    pub fn life_by(
        &self,
        change: Change,
        rate: impl Fn(f64, f64) -> f64,
        mut seen: impl FnMut([f64; 2], [f64; 2]),
    ) -> RecordedLife {
        let (begin, share, is_clipped) = self.start(change.crack_length);
        let rate = |k: f64, way: f64| rate(change.load * k, way);
        let mut cycles = 0.0;
        let end = |cycles: f64, stop, is_bound| RecordedLife { cycles, stop, is_bound: is_bound || is_clipped, is_clipped };
        for (place, interval) in self.intervals.iter().enumerate().skip(begin) {
            let from = if place == begin { share } else { 0.0 };
            let broken = interval.breaks(from, change);
            let to = broken.map_or(1.0, |(to, _)| to);
            let more = if (from, to) == (0.0, 1.0) { interval.cycles(&rate) } else { interval.part(from, to).cycles(&rate) };
            if more == f64::INFINITY {
                return RecordedLife { cycles: more, stop: StopReason::NothingAges, is_bound: false, is_clipped };
            }
            if cycles + more > self.cycles_max {
                return end(self.cycles_max, StopReason::RunOut, true);
            }
            seen([cycles, cycles + more], [interval.at(from).length, interval.at(to).length]);
            cycles += more;
            if let Some((_, criterion)) = broken {
                return end(cycles, self.breaks[criterion], false);
            }
        }
        if self.stop == StopReason::NothingAges {
            return RecordedLife { cycles: f64::INFINITY, stop: self.stop, is_bound: false, is_clipped };
        }
        end(cycles, self.stop, self.stop.is_lower_bound())
    }

    /// Cycles of the way that the run itself has gone, by a rate as in [`Recorded::life_by`].
    pub fn whole(&self, rate: impl Fn(f64, f64) -> f64) -> f64 {
        self.intervals[self.first..].iter().map(|interval| interval.cycles(&rate)).sum()
    }

    /// Interval and share of it at which a crack of this length stands; the shortest for one that is shorter, with a remark.
    fn start(&self, length: f64) -> (usize, f64, bool) {
        let own = self.intervals[self.first].from.length;
        if (length - own).abs() <= SAME * own {
            return (self.first, 0.0, false);
        }
        let [shortest, _] = self.lengths();
        let place = self.intervals.partition_point(|interval| interval.to.length <= length);
        let Some(Interval { from, to, .. }) = self.intervals.get(place) else { return (place, 0.0, false) };
        let share = ((length - from.length) / (to.length - from.length)).clamp(0.0, 1.0);
        (place, share, length < shortest * (1.0 - SAME))
    }
}

/// Rate of a law by K_max and way.
fn law_at(law: &dyn GrowthLaw, ratio: f64) -> impl Fn(f64, f64) -> f64 {
    move |k, _| law.rate(k, ratio)
}

impl Interval {
    fn new(from: Place, to: Place, weight: f64) -> Self {
        let mut interval = Interval { from, to, weight, nodes: [Node { way: 0.0, k_max: 0.0, weight: 0.0 }; 3] };
        interval.nodes = GAUSS.map(|(share, gauss)| {
            let Place { way, log_k, .. } = interval.at(share);
            Node { way, k_max: log_k.exp(), weight: gauss * weight * (to.way - from.way) }
        });
        interval
    }

    /// What lies between two shares of it.
    fn part(&self, from: f64, to: f64) -> Self {
        Interval::new(self.at(from), self.at(to.max(from)), self.weight)
    }

    fn at(&self, share: f64) -> Place {
        let mix = |from: f64, to: f64| if share >= 1.0 { to } else { from + share * (to - from) };
        Place {
            way: mix(self.from.way, self.to.way),
            length: mix(self.from.length, self.to.length),
            log_k: mix(self.from.log_k, self.to.log_k),
            cycles: mix(self.from.cycles, self.to.cycles),
            demands: [0, 1].map(|i| mix(self.from.demands[i], self.to.demands[i])),
        }
    }

    /// Cycles by a rate; infinite where there is none at a Gauss point.
    fn cycles(&self, rate: &impl Fn(f64, f64) -> f64) -> f64 {
        let of_node = |node: &Node| if node.weight > 0.0 { node.weight / rate(node.k_max, node.way) } else { 0.0 };
        self.nodes.iter().map(of_node).sum()
    }

    /// Share, from one on, at which a plate breaks, and whether by toughness (0) or net section (1).
    fn breaks(&self, from: f64, change: Change) -> Option<(f64, usize)> {
        let factors = [change.load / change.toughness, change.load];
        let of = |criterion: usize| {
            let demand = |place: Place| factors[criterion] * place.demands[criterion];
            let (now, then) = (demand(self.at(from)), demand(self.to));
            match () {
                () if now > 1.0 + SAME => Some(from),
                () if then > 1.0 + SAME => Some((from + (1.0 - from) * (1.0 - now) / (then - now)).clamp(from, 1.0)),
                () => None,
            }
        };
        let by = |criterion: usize| of(criterion).map(|share| (share, criterion));
        [by(0), by(1)].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// Way of the fastest tip at every row, the crack length at N = 0 counted, m: of a standard specimen its crack length.
pub fn way(case: &Case, prediction: &Prediction) -> Vec<f64> {
    if case.specimen.convention == LengthConvention::MeanOfTips {
        return prediction.curve.iter().map(|row| row.crack_length).collect();
    }
    let mut way = case.specimen.crack_length;
    let steps = prediction.curve.windows(2).map(|pair| {
        let of_tips = pair[0].tips.iter().zip(&pair[1].tips).map(|(from, to)| to.growth - from.growth);
        way += of_tips.fold(0.0, f64::max);
        way
    });
    std::iter::once(case.specimen.crack_length).chain(steps).collect()
}

/// Rows at which the fastest tip has gone on; where K is not known, that of the row before or behind. `None` where it never is.
fn places(case: &Case, prediction: &Prediction) -> Option<Vec<Place>> {
    let rows = &prediction.curve;
    let lead = prediction.leading_tip(&case.specimen).map(|(tip, _)| tip);
    let of_row = |row: &CurvePoint| lead.and_then(|tip| row.crack_length_of(&case.specimen, tip)).unwrap_or(row.crack_length);
    let log_k = |row: &CurvePoint| Some((row.delta_k / case.loading.range_share()).ln()).filter(|log_k| log_k.is_finite());
    let mut known = rows.iter().find_map(log_k)?;
    let mut places: Vec<Place> = Vec::with_capacity(rows.len());
    for (row, way) in rows.iter().zip(way(case, prediction)) {
        known = log_k(row).unwrap_or(known);
        let place = Place { way, length: of_row(row), log_k: known, cycles: row.cycles, demands: demands(case, row) };
        match places.last_mut() {
            // A row without growth adds its cycles to what follows.
            Some(last) if way <= last.way * (1.0 + SAME) => last.demands = place.demands,
            _ => places.push(place),
        }
    }
    // Behind the last growth nothing follows.
    if let ([_, .., last], Some(row)) = (places.as_mut_slice(), rows.last()) {
        last.cycles = row.cycles;
    }
    Some(places)
}

/// Lengths before the first row, with K by the handbook scaled to the run, else by the power law of its start.
fn before(case: &Case, places: &[Place]) -> Vec<Place> {
    let start = places[0];
    let is_standard = case.specimen.convention == LengthConvention::MeanOfTips && case.loading.displacement().is_none();
    let formula = handbook(&case.specimen).filter(|_| is_standard);
    let next = places.iter().find(|place| place.length > start.length * (1.0 + BEGINNING)).unwrap_or(&places[places.len() - 1]);
    let grown = (next.length / start.length).ln();
    if grown <= 0.0 {
        return vec![start];
    }
    let power = ((next.log_k - start.log_k) / grown).clamp(POWERS[0], POWERS[1]);
    // Metres that the fastest tip goes in one of the length.
    let way_per_length = (next.way - start.way) / (next.length - start.length);
    let (shortest, count) = if formula.is_some() { BY_HANDBOOK } else { BY_POWER };
    let of_cycle = |formula: &HandbookFormula, length: f64| formula.k_i(length, case.loading.at(length));
    let log_k = |length: f64| match &formula {
        Some(formula) => start.log_k + (of_cycle(formula, length) / of_cycle(formula, start.length)).ln(),
        None => start.log_k + power * (length / start.length).ln(),
    };
    let place = |i: usize| {
        let length = start.length * shortest.powf(1.0 - i as f64 / count as f64);
        Place { way: start.way + way_per_length * (length - start.length), length, log_k: log_k(length), ..start }
    };
    (0..count).map(place).chain([start]).collect()
}
