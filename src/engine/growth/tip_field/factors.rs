//! K_I and K_II of every tip off its ring, what they say of its rate, and where it aims.

use rayon::prelude::*;

use super::kink::Kink;
use super::readings::{GAP_HORIZONS, Reading, Sliding};
use super::steering::equivalent_factor;
use super::{PROBE_HORIZONS, Tip, TipField, ahead, heading};
use crate::body::severed::represented_excess;
use crate::fatigue::crack_tip::TipState;
use crate::growth::tip_ring::{CORE_HORIZONS, RING_HORIZONS, RING_HORIZONS_MIN, TipRings, pair_twins};
use crate::specimen::geometry::{direction, distance};
use crate::specimen::{CrackLine, LineEnd, Point};
use crate::units::MM;

/// How far ahead of its line a tip may stand, in horizons. Along rows of points it is 0.05 to 0.09 at ν = 0.3, 0.04 at ν = 0.1,
/// whatever the spacing.
const AHEAD_HORIZONS: f64 = 0.15;
/// How far ahead of its line a tip may stand in mode II, in horizons: 0.21 to 0.22 on lattices of 0.25 to 1.4 mm, where the crack is
/// straight in all of its ring. Where it is not, or where the ring is smaller, K_II is better as it is read.
const SLIDING_AHEAD_HORIZONS: f64 = 0.4;
/// One of K_I and K_II over the other from which it is read where the field has its tip in that mode. A smaller K_II is made by what is
/// near, other cracks for one, and the opening of these says more of it than the tip's own place.
const MIXED: f64 = 0.1;
/// Growth after a corner, in horizons, below which points do not resolve the kink: K would be read up to 5 % low.
const KINK_HORIZONS: f64 = 0.5;
/// Relative difference within which factors are those of mirror twins: far above what solver and tie breaks make of equal ones, far
/// below what shows in a life.
const ROUND_OFF: f64 = 1e-4;

/// Distance of a rim from a tip at the start, in horizons, below which the user is told.
const RIM_HORIZONS: f64 = 1.5;
/// K over that before beyond which a reading beside a rim is none: the ring overlaps what it cannot take in.
const RISE_MOST: f64 = 3.0;
/// Distance of a rim that a tip passes, in spacings, from which points cannot resolve what is between them.
const PASSING_SPACINGS: f64 = 1.0;
/// Cosine of the angle between a tip and the way to a rim below which it passes that.
const PASSING: f64 = 0.5;

/// Cosine of the angle between a tip and the way to another one within which they face each other.
const FACING: f64 = 0.94;

impl TipField<'_> {
    /// What the user should know about the rings of the initial tips.
    pub(super) fn ring_warnings(&self) -> Vec<String> {
        let horizon = self.body.horizon();
        let ends: Vec<LineEnd> = self.state.tips.iter().map(|tip| tip.end).collect();
        let short = ends.iter().filter(|&&end| {
            let wanted = RING_HORIZONS * horizon;
            self.surroundings.radius(&self.body, &self.state.lines, end, &ends, wanted) < RING_HORIZONS_MIN * horizon
        });
        let words = |count: usize| {
            format!(
                "{count} of {} crack tips lie within {:.3} mm of another tip or a support: the ring that reads K is too narrow there, \
                 and K may err by some percent; give a smaller model.spacing_mm",
                ends.len(),
                (RING_HORIZONS_MIN + 0.2) * horizon / MM
            )
        };
        let narrow = Some(short.count()).filter(|&count| count > 0).map(words);
        let gap = |end: &LineEnd| self.case.specimen.rim_distance(self.state.lines[end.line].end(end.at_last));
        let nearest = ends.iter().map(gap).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let near_rim = nearest.filter(|(_, gap)| *gap < RIM_HORIZONS * horizon).map(|(tip, gap)| {
            format!(
                "tip {tip} starts {:.3} mm from a rim, {:.2} horizons: K is read up to some percent off there; give model.spacing_mm = {:.4}",
                gap / MM,
                gap / horizon,
                gap / (RIM_HORIZONS * self.case.model.horizon_ratio) / MM
            )
        });
        narrow.into_iter().chain(near_rim).collect()
    }

    /// What the user should know of tips that the load presses shut.
    pub(super) fn contact_warning(&self) -> Option<String> {
        let closed = self.state.tips.iter().enumerate().filter(|(_, tip)| tip.was_closed);
        let tips = closed.map(|(index, _)| index.to_string()).collect::<Vec<_>>().join(", ");
        (!tips.is_empty()).then(|| {
            format!(
                "the load presses the crack shut at tip {tips}, which does not grow while it does: flanks carry pressure, and slide without \
                 friction"
            )
        })
    }

    /// What the rings of the active tips of `lines` say, in order.
    fn read_rings(&self, lines: &[CrackLine]) -> Vec<Reading> {
        let body = &self.body;
        let horizon = body.horizon();
        let tips: Vec<&Tip> = self.state.tips.iter().filter(|tip| tip.state == TipState::Active).collect();
        let active: Vec<LineEnd> = tips.iter().map(|tip| tip.end).collect();
        let pressures = self.contact.pressures(&self.layout(), &self.displacement, body.thickness, self.crack_pressure());
        let share = self.load_share();
        let rings = TipRings {
            body,
            bonds: &self.bonds,
            displacement: &self.displacement,
            load: self.case.loading.maximum,
            geometry: &self.surroundings,
            lines,
            active: &active,
            is_new: self.state.tips.iter().all(|tip| tip.growth == 0.0),
            pressures: &pressures,
        };
        let contact = &self.contact;
        let read = |tip: &&Tip| {
            let end = tip.end;
            let excess = represented_excess(body, &lines[end.line], end.at_last, tip.length + tip.growth);
            let first = rings.read(end, excess);
            let is_closed = contact.is_closed(lines, end, body.lattice.spacing);
            let [k_i, k_ii] = first.factors.map(f64::abs);
            let is_mixed = k_ii > MIXED * k_i && !is_closed && tip.growth == 0.0;
            let slides = is_mixed
                && first.radius >= (1.0 - ROUND_OFF) * RING_HORIZONS * horizon
                && lines[end.line].last_piece(end.at_last) > first.radius;
            let offset = if is_mixed && k_i > MIXED * k_ii {
                first.tip_offsets[0]
            } else if slides {
                0.0
            } else {
                first.tip_offset
            };
            // Beside a rim what is read as a shift may be something else.
            let ahead = if offset.abs() < AHEAD_HORIZONS * horizon { offset } else { 0.0 };
            let ring = if ahead == 0.0 { first } else { rings.read(end, excess + ahead) };
            let mut factors = if is_closed { [0.0, ring.factors[1]] } else { ring.factors }.map(|factor| share * factor);
            let beyond = ring.tip_offsets[1];
            let is_beyond = slides && (0.0..SLIDING_AHEAD_HORIZONS * horizon).contains(&beyond);
            let sliding = is_beyond.then(|| {
                let offset = excess + ahead + beyond;
                let factor = share * rings.read(end, offset).factors[1];
                let less = |by: f64| factor * tip.sliding_ratio(factor, offset, by, horizon);
                factors[1] = less(beyond);
                Sliding { offset, factor, at_line: less(offset) }
            });
            let [t_stress, of_pressure] = [ring.t_stress, ring.of_pressure].map(|of_load| share * of_load);
            Reading { factors, t_stress, length_offset: excess + ahead, is_closed, of_pressure, sliding }
        };
        let mut readings: Vec<Reading> = tips.par_iter().map(read).collect();
        let mut factors: Vec<Option<[f64; 2]>> = readings.iter().map(|reading| Some(reading.factors)).collect();
        pair_twins(&mut factors, ROUND_OFF);
        readings.iter_mut().zip(factors).for_each(|(reading, factors)| reading.factors = factors.unwrap_or(reading.factors));
        let mut at_line: Vec<Option<[f64; 2]>> = readings.iter().map(|reading| reading.sliding.map(|s| [s.at_line; 2])).collect();
        pair_twins(&mut at_line, ROUND_OFF);
        for (reading, at_line) in readings.iter_mut().zip(at_line) {
            reading.sliding.iter_mut().zip(at_line).for_each(|(sliding, at_line)| sliding.at_line = at_line[0]);
        }
        readings
    }

    /// K of the initial cracks drawn back ([`TipFieldState::drawn_back`]): with that of the cracks it tells how K changes.
    pub(super) fn read_slopes(&mut self) {
        let horizon = self.body.horizon();
        let lines = self.state.drawn_back(PROBE_HORIZONS * horizon);
        let readings = self.read_rings(&lines);
        for (tip, Reading { factors: read, length_offset, sliding, .. }) in self.state.tips.iter_mut().zip(readings) {
            let end = tip.end;
            let back = distance(self.state.lines[end.line].end(end.at_last), lines[end.line].end(end.at_last));
            tip.readings.take(equivalent_factor(read), -back, length_offset, None, horizon);
            if let Some(Sliding { offset, factor, .. }) = sliding {
                tip.sliding_readings.take(factor.abs(), -back, offset, None, horizon);
            }
        }
    }

    /// Distance of a tip from the nearest one that it faces, m.
    fn gap(&self, tip: &Tip) -> Option<f64> {
        let end = |tip: &Tip| (self.position(tip), self.heading(tip.end));
        let (here, ahead) = end(tip);
        let others = self.state.tips.iter().filter(|other| other.state == TipState::Active && other.end != tip.end);
        let gap = |other: &Tip| {
            let (there, towards) = end(other);
            let (way, gap) = (direction(here, there), distance(here, there));
            let cosine = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1];
            (cosine(ahead, way) > FACING && cosine(towards, way) < -FACING).then_some(gap)
        };
        others.filter_map(gap).min_by(f64::total_cmp)
    }

    /// Whether a tip has come so near to another that its K is not read any more.
    pub(super) fn is_closing(&self, tip: &Tip) -> bool {
        self.gap(tip).is_some_and(|gap| gap < GAP_HORIZONS * self.body.horizon())
    }

    /// What the rings of all active tips say of the displacement at hand.
    pub(super) fn read_fields(&mut self) {
        let mut readings = self.read_rings(&self.state.lines).into_iter();
        for tip in &mut self.state.tips {
            tip.reading = if tip.state == TipState::Active { readings.next() } else { None };
        }
    }

    /// The first of the tips that pass a rim so near that points do not resolve what is between them, and that distance, m.
    pub(super) fn unresolved_ligament(&self) -> Option<(usize, f64)> {
        let reach = PASSING_SPACINGS * self.body.lattice.spacing;
        let passes = |tip: &Tip| {
            let (at, ahead) = (self.position(tip), self.heading(tip.end));
            let (nearest, _) = ahead::beside(&self.case.specimen, &[], 0, at, reach)?;
            let way = direction(at, nearest);
            (ahead[0] * way[0] + ahead[1] * way[1] < PASSING).then(|| distance(at, nearest))
        };
        let grown = self.state.tips.iter().enumerate().filter(|(_, tip)| tip.is_growing() && tip.growth > 0.0);
        grown.filter_map(|(index, tip)| Some((index, passes(tip)?))).next()
    }

    /// Lets every active tip choose its direction.
    pub(super) fn choose_directions(&mut self) {
        let horizon = self.body.horizon();
        for tip in &mut self.state.tips {
            let Some(reading @ Reading { factors, .. }) = tip.reading else { continue };
            tip.is_closed = reading.stands();
            tip.was_closed |= tip.is_closed;
            if tip.is_closed {
                continue;
            }
            let ahead = heading(&self.body, &self.state.lines, tip.end);
            tip.steering.read(factors, tip.growth, ahead, horizon);
        }
    }

    /// K at the length of every line, and da/dN of it.
    pub(super) fn choose_rates(&mut self) {
        let horizon = self.body.horizon();
        let gaps: Vec<Option<f64>> = self.state.tips.iter().map(|tip| self.gap(tip)).collect();
        for (tip, gap) in self.state.tips.iter_mut().zip(gaps) {
            tip.rate = 0.0;
            let Some(Reading { factors: read, t_stress, length_offset, is_closed: pressed_shut, sliding, .. }) = tip.reading
            else {
                continue;
            };
            (tip.length_offset, tip.t_stress) = (length_offset, t_stress);
            if tip.is_closed {
                tip.factors = read;
                continue;
            }
            tip.readings.take(equivalent_factor(read), tip.growth, length_offset, tip.steering.corner(), horizon);
            // Both modes alike: what the tip's field lacks or has too much is length.
            let mut ratio = tip.readings.ratio(length_offset, tip.length + tip.growth, horizon);
            // Until the bonds show a kink, less is read.
            let begins_kink = tip.steering.corner() == Some(tip.growth);
            if begins_kink || tip.steering.corner().is_none() {
                tip.kink = None;
            }
            if let Some(factor) = tip.kink.and_then(|kink| kink.factor(tip.growth, tip.length, horizon)) {
                ratio = factor / equivalent_factor(read);
            } else if tip
                .steering
                .corner()
                .is_some_and(|corner| tip.growth < corner + KINK_HORIZONS * horizon && tip.growth > corner)
            {
                ratio = ratio.max(tip.equivalent() / equivalent_factor(read));
            }
            let mut factors = read.map(|factor| ratio * factor);
            if let Some(sliding) = sliding {
                factors[1] = sliding.at_line;
            }
            if let Some(gap) = gap {
                factors = tip.coalescence.factors(factors, gap, horizon);
            }
            // Beside a rim a ring that overlaps it may say anything.
            let is_read = tip.growth == 0.0
                || tip.equivalent() == 0.0
                || equivalent_factor(factors) < RISE_MOST * tip.equivalent()
                || self.case.specimen.rim_distance(self.state.lines[tip.end.line].end(tip.end.at_last)) > CORE_HORIZONS * horizon;
            let is_near = !pressed_shut
                && tip.growth > 0.0
                && ahead::is_near_rim(&self.case.specimen, &self.state.lines, tip.end, CORE_HORIZONS * horizon);
            let has_risen = equivalent_factor(factors) >= tip.equivalent();
            if is_read && (has_risen || !is_near) {
                tip.factors = factors;
            }
            if begins_kink {
                tip.kink = Kink::new(tip.factors, t_stress, tip.growth);
            }
            let first_step = tip.kink.filter(|_| begins_kink).map(|kink| kink.first_factor(self.steps.first()));
            tip.rate = self.law.rate(first_step.unwrap_or_else(|| tip.equivalent()), self.case.loading.ratio);
        }
    }
}
