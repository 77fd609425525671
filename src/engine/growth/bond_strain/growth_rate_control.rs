//! How fast a tip grows whose bonds age: by its K.
//!
//! A tip that grows by da severs bonds of weight ρ(n) da ([`crate::body::severed`]), so bonds of weight g_k that spend dλ_k/dN of their
//! lives make it grow by `η Σ g_k |dλ_k/dN| / ρ(n)` a cycle, η being the share of the life spent around a tip that severs bonds of the
//! crack. What strains are at equal K depends on the direction of the crack against the lattice, on the horizon over the spacing and
//! over the length of the crack, on Poisson's ratio, on the stress along the crack and on the bond law. So the strains around a tip
//! are taken for what they say of each other, and bonds age by `dλ/dN = -F ε^q`, q = 2, with one F for all of a tip,
//!
//! `F η Σ_k g_k ε_k^q = ρ(n) da/dN(K_eq)`,
//!
//! so that the crack goes where bonds break, and all that cancels. K_eq is read off a ring around the tip
//! ([`crate::stress_intensity::ring`]) every half horizon of growth and continued as a power of the length; η is the growth over the
//! life spent in the last 1.5 horizons, so that what a tip really does closes the loop, and what it is behind the growth by its K is
//! made up for within a horizon.
//!
//! Before a tip from a notch has a past that shows η, its bonds age by their law, dλ/dN = -A ε^p; where nothing can be read around
//! a tip, F is what it was.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::precrack::Precrack;
use crate::body::pre_crack::{bonds_across, places_near};
use crate::body::severed::{severed_per_length, severed_weight};
use crate::body::{Body, Bond};
use crate::case::Case;
use crate::fatigue::FatigueLaw;
use crate::fatigue::ageing::FatigueBond;
use crate::fatigue::crack_tip::CrackTip;
use crate::fatigue::growth_law::GrowthLaw;
use crate::growth::cracks::ahead::is_near_rim;
use crate::growth::cracks::steering::equivalent_factor;
use crate::growth::cracks::tip::pair_twins;
use crate::growth::points::ring::{CORE_HORIZONS, RING_HORIZONS, TipRings};
use crate::growth::record::TipRecord;
use crate::line::line;
use crate::specimen::geometry::{distance, distance_to_segment};
use crate::specimen::{CrackLine, LineEnd, Point, Specimen};
use crate::state::Bonds;
use crate::stress_intensity::ring::RingGeometry;

/// Exponent by which strains share out the life spent around a tip. Where the rate is that of K it sets the order of breaks alone: high
/// ones lock a crack to rows of points (lives on turned lattices were wrong by up to 40 % at p = 6 and ordered by it), 2 spends life
/// as strain energy is stored.
const ORDER: f64 = 2.0;
/// Growth, in horizons, after which K is read again.
const READ_HORIZONS: f64 = 0.5;
/// Readings whose slope of ln K over ln a carries K on, and its bounds: a crack far from everything has 1/2.
const READINGS: usize = 3;
const SLOPE: (f64, f64) = (-12.0, 12.0);
/// Growth, in horizons, that shows η.
const PAST_HORIZONS: f64 = 1.5;
/// η of tips before N = 0 that have no past yet.
const USUAL_EFFICIENCY: f64 = 0.75;
/// Growth since the cut, in horizons, that does not: bonds ahead of a cut have whole lives.
const FRESH_HORIZONS: f64 = 0.5;
/// Growth, in horizons, over which a tip makes up for what it is behind, and bounds of its rate over that of its K meanwhile.
const CATCH_UP_HORIZONS: f64 = 1.0;
const CATCH_UP: (f64, f64) = (0.5, 2.0);
/// Least growth after that which shows it.
const PAST_LEAST_HORIZONS: f64 = 0.25;
/// Length of the pieces, in horizons, in which the way of a tip is taken down.
const PIECE_HORIZONS: f64 = 0.5;
/// Least length of the last of them, which shows where the tip heads: on shorter ones the bonds that broke last turn it by degrees.
const LAST_PIECE_HORIZONS: f64 = 1.0;
/// Distance of a tip from its cut, in horizons, below which it has no direction of its own.
const SHORT_HORIZONS: f64 = 0.25;
/// How far from the place of a tip its field may stand, in horizons: farther off it is that of something else.
const AHEAD_HORIZONS: f64 = 0.5;
/// Growth, in horizons, that is none: round-off must not tell mirror twins apart.
const STILL_HORIZONS: f64 = 1e-6;

/// Rates of the tips of a run.
pub(super) struct GrowthRateControl {
    law: Box<dyn GrowthLaw>,
    surroundings: RingGeometry,
    specimen: Specimen,
    /// Cracks as they are cut.
    lines: Vec<CrackLine>,
    /// Which end of them every tip is; none where it starts in a slot.
    ends: Vec<Option<LineEnd>>,
    /// Maximum load, Pa or N, and stress ratio.
    load: f64,
    ratio: f64,
    tips: Vec<TipRateControl>,
    /// Whether cycles count.
    is_counting: bool,
}

/// What a tip's pace depends on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct TipRateControl {
    /// Where the tip has been, in pieces.
    path: Vec<Point>,
    /// Growth at the last piece.
    taken_at: f64,
    /// The last readings, the newest at the end; empty where that said nothing.
    readings: VecDeque<Reading>,
    /// Growth at which a reading was last tried.
    tried_at: Option<f64>,
    /// Length of crack, m, that the life spent since the cut would have made at η = 1.
    nominal_growth: f64,
    /// Growth and that length over the last [`PAST_HORIZONS`].
    past: VecDeque<[f64; 2]>,
    /// da/dN of its K, m/cycle, where it is known.
    rate: Option<f64>,
    /// Growth by that rate since it was known, less that of the tip, m.
    growth_deficit: f64,
    /// F, 1/cycle; none while bonds age by their law.
    scale: Option<f64>,
    /// Whether the cycles of its first growth do not count.
    is_grown_before: bool,
}

/// K_eq of a tip, Pa√m, and the length of crack that it belongs to, m: that at which the field stands, a little ahead of the tip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Reading {
    factor: f64,
    length: f64,
}

impl TipRateControl {
    /// A tip at its cut, grown before N = 0 or not.
    fn of(is_grown_before: bool) -> Self {
        TipRateControl {
            path: Vec::new(),
            taken_at: 0.0,
            readings: VecDeque::new(),
            tried_at: None,
            nominal_growth: 0.0,
            past: VecDeque::from([[0.0; 2]]),
            rate: None,
            growth_deficit: 0.0,
            scale: None,
            is_grown_before,
        }
    }

    /// Share of the spent life that is growth; `None` before a tip has a past.
    fn efficiency(&self, horizon: f64) -> Option<f64> {
        let (first, last) = (self.past.front()?, self.past.back()?);
        let (grown, spent) = (last[0] - first[0], last[1] - first[1]);
        let is_known = first[0] >= (FRESH_HORIZONS - STILL_HORIZONS) * horizon
            && grown >= (PAST_LEAST_HORIZONS - STILL_HORIZONS) * horizon
            && spent > 0.0;
        if is_known { Some(grown / spent) } else { self.is_grown_before.then_some(USUAL_EFFICIENCY) }
    }

    /// Half of the usual growth by a break, m: until the next one the crack is that much longer in the mean than after the last.
    fn half_step(&self) -> f64 {
        let steps = || self.past.iter().zip(self.past.iter().skip(1)).map(|(before, after)| after[0] - before[0]);
        let grown: f64 = steps().sum();
        if grown > 0.0 { 0.5 * steps().map(|step| step * step).sum::<f64>() / grown } else { 0.0 }
    }

    /// K_eq of a crack of some length, m, by the power of it that the last readings show.
    fn factor(&self, length: f64) -> Option<f64> {
        let last = self.readings.back()?;
        let points = || self.readings.iter().filter(|reading| reading.factor > 0.0).map(|r| (r.length.ln(), r.factor.ln()));
        let (x, y): (Vec<f64>, Vec<f64>) = points().unzip();
        let slope = line(&x, &y).map_or(0.5, |line| line.slope.clamp(SLOPE.0, SLOPE.1));
        Some(last.factor * (length / last.length).powf(slope))
    }
}

impl GrowthRateControl {
    pub(super) fn new(case: &Case, start: &Precrack, body: &Body, law: Box<dyn GrowthLaw>) -> Self {
        let (specimen, pre_growths) = (&start.specimen, start.pre_growths());
        let count = specimen.tips.len();
        let tip = |tip: usize| {
            let start_of_way = specimen.line_end(tip).is_none().then_some(specimen.tips[tip].position);
            TipRateControl { path: start_of_way.into_iter().collect(), ..TipRateControl::of(pre_growths[tip] > 0.0) }
        };
        GrowthRateControl {
            law,
            surroundings: RingGeometry::new(body, specimen, &case.material),
            specimen: specimen.clone(),
            lines: specimen.crack_lines(),
            ends: (0..count).map(|tip| specimen.line_end(tip)).collect(),
            load: case.loading.maximum,
            ratio: case.loading.ratio,
            tips: (0..count).map(tip).collect(),
            is_counting: false,
        }
    }

    /// Whether a tip has grown so far that its K is to be read.
    pub(super) fn is_due(&self, body: &Body, tips: &[CrackTip]) -> bool {
        let step = (READ_HORIZONS - STILL_HORIZONS) * body.horizon();
        let is_due = |(tip, pace): (&CrackTip, &TipRateControl)| pace.tried_at.is_none_or(|then| tip.growth >= then + step);
        tips.iter().zip(&self.tips).filter(|(tip, _)| tip.is_active()).any(is_due)
    }

    /// Reads K of all active tips off a displacement that is right everywhere.
    pub(super) fn read(&mut self, body: &Body, bonds: &Bonds, displacement: &[f64], tips: &[CrackTip], records: &[TipRecord]) {
        let horizon = body.horizon();
        let (lines, ends) = self.cracks(body, records);
        let bonds = &sound_bonds(body, bonds, &lines, records, RING_HORIZONS * horizon);
        let active: Vec<LineEnd> = ends.iter().zip(tips).filter(|(_, tip)| tip.is_active()).filter_map(|(end, _)| *end).collect();
        let rings = TipRings {
            body,
            bonds,
            displacement,
            load: self.load,
            geometry: &self.surroundings,
            lines: &lines,
            active: &active,
            is_new: false,
            pressures: &[],
        };
        let read = |end: LineEnd| {
            if is_near_rim(&self.specimen, &lines, end, CORE_HORIZONS * horizon) {
                return None;
            }
            let read = |offset: f64| rings.have_room(end, offset).then(|| rings.read(end, offset));
            let first = read(0.0)?;
            if first.tip_offset.is_nan() || first.tip_offset.abs() > AHEAD_HORIZONS * horizon {
                return None;
            }
            let second = read(first.tip_offset)?;
            let is_known = equivalent_factor(second.factors).is_finite();
            is_known.then_some((second.factors, first.tip_offset + second.tip_offset))
        };
        let mut found: Vec<Option<([f64; 2], f64)>> =
            ends.iter().zip(tips).map(|(end, tip)| end.filter(|_| tip.is_active()).and_then(read)).collect();
        let mut factors: Vec<Option<[f64; 2]>> = found.iter().map(|found| found.map(|(factors, _)| factors)).collect();
        pair_twins(&mut factors);
        found.iter_mut().zip(factors).for_each(|(found, factors)| *found = factors.zip(found.map(|(_, offset)| offset)));
        for ((pace, tip), found) in self.tips.iter_mut().zip(tips).zip(found) {
            if !tip.is_active() {
                continue;
            }
            pace.tried_at = Some(tip.growth);
            match found {
                Some((factors, ahead)) => {
                    let length = tip.crack + tip.growth + ahead;
                    pace.readings.push_back(Reading { factor: equivalent_factor(factors), length });
                    if pace.readings.len() > READINGS {
                        pace.readings.pop_front();
                    }
                }
                None => pace.readings.clear(),
            }
        }
    }

    /// The cracks as the tips have left them, and which end of them every tip is.
    fn cracks(&self, body: &Body, records: &[TipRecord]) -> (Vec<CrackLine>, Vec<Option<LineEnd>>) {
        let mut lines = self.lines.clone();
        let least = LAST_PIECE_HORIZONS * body.horizon();
        let mut end_of = |((pace, record), end): ((&TipRateControl, &TipRecord), &Option<LineEnd>)| {
            let here = record.position;
            let way = pace.path.iter().filter(|at| distance(**at, here) > least).copied();
            let Some(end) = *end else {
                // From a slot.
                let points: Vec<Point> = way.chain([here]).collect();
                return (points.len() > 1).then(|| {
                    lines.push(CrackLine { points });
                    LineEnd { line: lines.len() - 1, at_last: true }
                });
            };
            let line = &mut lines[end.line];
            way.for_each(|at| line.grow(end.at_last, at));
            let (last, [x, y]) = (line.end(end.at_last), line.direction(end.at_last));
            if distance(last, here) > SHORT_HORIZONS * body.horizon() {
                line.grow(end.at_last, here);
            } else {
                // So near the cut no direction of its own shows; the sharp crack may even end short of it.
                line.stretch(end.at_last, x * (here[0] - last[0]) + y * (here[1] - last[1]));
            }
            Some(end)
        };
        let ends = self.tips.iter().zip(records).zip(&self.ends).map(&mut end_of).collect();
        (lines, ends)
    }

    /// Multiplies the strains of fatigue bonds so that every tip grows at the rate of its K. Bonds of a tip that does not grow are left
    /// out.
    pub(super) fn set(&mut self, body: &Body, tips: &[CrackTip], law: &FatigueLaw, ageing: &mut Vec<FatigueBond>) {
        let horizon = body.horizon();
        let lengths = lengths(body, tips, ageing, |strain| strain.powf(ORDER));
        for ((pace, tip), per_scale) in self.tips.iter_mut().zip(tips).zip(lengths) {
            let known = pace.factor(tip.crack + tip.growth + pace.half_step()).zip(pace.efficiency(horizon));
            pace.rate = known.map(|(factor, _)| self.law.rate(factor, self.ratio));
            // A crack below its threshold still gets to its initial length: by the strains of its bonds, in cycles that do not count.
            if !self.is_counting && pace.rate == Some(0.0) {
                (pace.rate, pace.scale) = (None, None);
                continue;
            }
            if let Some(((_, efficiency), rate)) = known.zip(pace.rate).filter(|_| per_scale > 0.0) {
                let catch_up = (1.0 + pace.growth_deficit / (CATCH_UP_HORIZONS * horizon)).clamp(CATCH_UP.0, CATCH_UP.1);
                pace.scale = Some(catch_up * rate / (efficiency * per_scale));
            }
        }
        for bond in ageing.iter_mut() {
            if let Some(scale) = owner(body, tips, bond.bond).and_then(|tip| self.tips[tip].scale) {
                bond.strain = (scale / law.a * bond.strain.powf(ORDER)).powf(1.0 / law.p);
            }
        }
        ageing.retain(|bond| bond.strain > 0.0);
    }

    /// Takes in the life that bonds spent.
    pub(super) fn spend(&mut self, body: &Body, tips: &[CrackTip], law: &FatigueLaw, cycles: f64, ageing: &[FatigueBond]) {
        let lengths = lengths(body, tips, ageing, |strain| law.a * strain.powf(law.p));
        for (pace, per_cycle) in self.tips.iter_mut().zip(lengths) {
            pace.nominal_growth += cycles * per_cycle;
            // Others wait for those that are not at their initial lengths yet.
            pace.growth_deficit += pace.rate.filter(|_| per_cycle > 0.0).map_or(0.0, |rate| cycles * rate);
        }
    }

    /// Lets the growth of tips count from here on: what they were behind before is no matter.
    pub(super) fn begin(&mut self) {
        self.is_counting = true;
        self.tips.iter_mut().for_each(|tip| tip.growth_deficit = 0.0);
    }

    /// Takes in where the tips are.
    pub(super) fn follow(&mut self, body: &Body, tips: &[CrackTip], records: &[TipRecord]) {
        let horizon = body.horizon();
        for ((pace, tip), record) in self.tips.iter_mut().zip(tips).zip(records) {
            if pace.past.back().is_some_and(|last| tip.growth > last[0] + STILL_HORIZONS * horizon) {
                if pace.rate.is_some() {
                    pace.growth_deficit -= tip.growth - pace.past.back().map_or(0.0, |last| last[0]);
                }
                pace.past.push_back([tip.growth, pace.nominal_growth]);
                let oldest = (tip.growth - PAST_HORIZONS * horizon).max(FRESH_HORIZONS * horizon) - STILL_HORIZONS * horizon;
                while pace.past.len() > 1 && pace.past[0][0] < oldest {
                    pace.past.pop_front();
                }
            }
            if tip.growth >= pace.taken_at + (PIECE_HORIZONS - STILL_HORIZONS) * horizon {
                pace.taken_at = tip.growth;
                pace.path.push(record.position);
            }
        }
    }

    pub(super) fn state(&self) -> Vec<TipRateControl> {
        self.tips.clone()
    }

    /// Goes on from a state of an earlier run; whether it is one of so many tips.
    pub(super) fn restore(&mut self, state: Vec<TipRateControl>, is_counting: bool) -> bool {
        let fits = state.len() == self.tips.len() && state.iter().all(|tip| !tip.past.is_empty());
        if fits {
            (self.tips, self.is_counting) = (state, is_counting);
        }
        fits
    }
}

/// Length of crack, m, that the bonds of every tip would sever if each counted by the life it spends: `Σ g_k s(ε_k) / ρ(n)`.
fn lengths(body: &Body, tips: &[CrackTip], ageing: &[FatigueBond], spending: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut weights = vec![0.0; tips.len()];
    for bond in ageing {
        if let Some(tip) = owner(body, tips, bond.bond) {
            weights[tip] += severed_weight(body, body.ends(bond.bond).0) * spending(bond.strain);
        }
    }
    let per_length = |tip: &CrackTip| {
        let along = body.lattice.to_axes(tip.direction);
        severed_per_length(body, [-along[1], along[0]])
    };
    weights.iter().zip(tips).map(|(weight, tip)| weight / per_length(tip)).collect()
}

/// The active tip that a bond belongs to, the nearest.
fn owner(body: &Body, tips: &[CrackTip], bond: Bond) -> Option<usize> {
    let middle = body.middle(bond);
    let far = |tip: usize| distance(tips[tip].position, middle);
    (0..tips.len()).filter(|&tip| tips[tip].is_active()).min_by(|&a, &b| far(a).total_cmp(&far(b)))
}

/// The bonds without those that still bridge cracks, and without the points in them that have lost half of theirs: the displacement
/// of these is not that of a face.
fn sound_bonds(body: &Body, bonds: &Bonds, lines: &[CrackLine], records: &[TipRecord], reach: f64) -> Bonds {
    let mut sound = bonds.clone();
    let is_near = |[a, b]: &[Point; 2]| records.iter().any(|tip| distance_to_segment(tip.position, *a, *b) < reach);
    let mut near: Vec<usize> = Vec::new();
    for [a, b] in lines.iter().flat_map(CrackLine::pieces).filter(is_near) {
        bonds_across(body, a, b).into_iter().for_each(|bond| sound.cut(body, bond));
        near.extend(places_near(body, a, b, body.horizon()));
    }
    near.sort_unstable();
    near.dedup();
    let places = body.places();
    let all_at = |place: usize| {
        let owners = body.steps.iter().enumerate().flat_map(|(k, &step)| [(k, place), (k, place.wrapping_add_signed(-step))]);
        owners
            .map(|(k, owner)| k * places + owner)
            .filter(|&bond| body.multiplier[bond] > 0.0)
            .map(|bond| bond as Bond)
            .collect::<Vec<_>>()
    };
    let loose: Vec<Vec<Bond>> = near
        .into_iter()
        .map(all_at)
        .filter(|all| 2 * all.iter().filter(|&&bond| sound.is_intact(bond)).count() < all.len())
        .collect();
    loose.into_iter().flatten().for_each(|bond| sound.cut(body, bond));
    sound
}
