//! K_I and K_II of every tip off its ring, and what they say of K at the end of its line.

use rayon::prelude::*;

use super::contact::Contact;
use super::readings::Sliding;
use super::ring::{CORE_HORIZONS, RING_HORIZONS, RING_HORIZONS_MIN, TipRings};
use super::settle::{LowerLoad, released};
use super::{PointPlate, heading};
use crate::case::Case;
use crate::cracks::CrackedPlate;
use crate::cracks::ahead;
use crate::cracks::steering::equivalent_factor;
use crate::cracks::tip::{AtLoad, CracksState, Reading, Tip, pair_twins};
use perilife_base::units::MM;
use perilife_laws::response::Response;
use perilife_plate::specimen::geometry::distance;
use perilife_plate::specimen::{CrackLine, LineEnd};
use perilife_points::body::severed::represented_excess;
use perilife_points::stress_intensity::ring::FlankPressure;

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
/// Relative difference of lengths that are equal but for round-off.
const ROUND_OFF: f64 = 1e-4;
/// Distance of a rim from a tip at the start, in horizons, below which the user is told.
const RIM_HORIZONS: f64 = 1.5;
/// K over that before beyond which a reading beside a rim is none: the ring overlaps what it cannot take in.
const RISE_MOST: f64 = 3.0;

impl PointPlate {
    /// What the user should know about the rings of the initial tips.
    pub(super) fn ring_warnings(&self, case: &Case, cracks: &CracksState) -> Vec<String> {
        let horizon = self.body.horizon();
        let ends: Vec<LineEnd> = cracks.tips.iter().map(|tip| tip.end).collect();
        let short = ends.iter().filter(|&&end| {
            let wanted = RING_HORIZONS * horizon;
            self.surroundings.radius(&self.body, &cracks.lines, end, &ends, wanted) < RING_HORIZONS_MIN * horizon
        });
        let words = |count: usize| {
            format!(
                "points: {count} of {} crack tips are within {:.3} mm of another tip or a support: the integration ring is too small there; K may be \
                 off by a few percent; reduce model.spacing_mm",
                ends.len(),
                (RING_HORIZONS_MIN + 0.2) * horizon / MM
            )
        };
        let narrow = Some(short.count()).filter(|&count| count > 0).map(words);
        let gap = |end: &LineEnd| case.specimen.rim_distance(cracks.lines[end.line].end(end.at_last));
        let nearest = ends.iter().map(gap).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let near_rim = nearest.filter(|(_, gap)| *gap < RIM_HORIZONS * horizon).map(|(tip, gap)| {
            format!(
                "points: tip {tip} starts {:.3} mm ({:.2} horizons) from an edge; K may be off by a few percent there; use model.spacing_mm = {:.4}",
                gap / MM,
                gap / horizon,
                gap / (RIM_HORIZONS * case.points().horizon_ratio) / MM
            )
        });
        narrow.into_iter().chain(near_rim).collect()
    }

    /// What the rings of the active tips of `lines` say, the second of tips of both modes.
    pub(super) fn read_rings(
        &self,
        case: &Case,
        cracks: &CracksState,
        lines: &[CrackLine],
    ) -> (Vec<Option<Reading>>, Vec<Option<Sliding>>) {
        let body = &self.body;
        let horizon = body.horizon();
        let active: Vec<LineEnd> = cracks.active().map(|(_, tip)| tip.end).collect();
        let tractions = |contact: &Contact, displacement: &[f64], share: f64| {
            contact.pressures(&self.layout(), displacement, body.thickness, &|at| released(case, share, at))
        };
        let whole = (1.0, &self.contact, &self.displacement[..]);
        let of_lower = self.lower.iter().map(|LowerLoad { load, contact, displacement }| (*load, contact, &displacement[..]));
        let loads: Vec<(f64, &Contact, &[f64])> = std::iter::once(whole).chain(of_lower).collect();
        let pressures: Vec<Vec<FlankPressure>> = loads.iter().map(|(load, contact, u)| tractions(contact, u, *load)).collect();
        let residual = case.loading.residual.as_deref();
        let share = case.loading.share(self.work, cracks.crack_length(&case.specimen));
        let (bonds, geometry) = (&self.bonds, &self.surroundings);
        let under = |place: usize| TipRings {
            body,
            bonds,
            displacement: loads[place].2,
            load: loads[place].0 * case.loading.maximum,
            geometry,
            lines,
            active: &active,
            is_new: cracks.tips.iter().all(|tip| tip.growth == 0.0),
            pressures: &pressures[place],
        };
        let is_closed = |place: usize, end: LineEnd| loads[place].1.is_closed(lines, end, body.lattice.spacing);
        let memory = &self.memory;
        let read = |(index, tip): (usize, &Tip)| {
            let (end, of_tip) = (tip.end, &memory[index]);
            let excess = represented_excess(body, &lines[end.line], end.at_last, tip.length + tip.growth);
            // A tip that the largest load presses shut shows where it is under one that opens it.
            let own = (0..loads.len()).find(|place| !is_closed(*place, end)).unwrap_or(0);
            let (rings, is_shut) = (under(own), is_closed(own, end));
            let first = rings.read(end, excess);
            let [k_i, k_ii] = first.factors.map(f64::abs);
            let is_mixed = k_ii > MIXED * k_i && !is_shut && tip.growth == 0.0;
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
            let mut factors = if is_shut { [0.0, ring.factors[1]] } else { ring.factors }.map(|factor| share * factor);
            let beyond = ring.tip_offsets[1];
            let is_beyond = slides && (0.0..SLIDING_AHEAD_HORIZONS * horizon).contains(&beyond);
            let sliding = is_beyond.then(|| {
                let offset = excess + ahead + beyond;
                let factor = share * rings.read(end, offset).factors[1];
                let less = |by: f64| factor * of_tip.sliding_ratio(factor, offset, [by, tip.length], horizon);
                factors[1] = less(beyond);
                Sliding { offset, factor, at_line: less(offset) }
            });
            let [mut t_stress, of_pressure] = [ring.t_stress, ring.of_pressure].map(|of_load| share * of_load);
            let ahead_of_tip = heading(body, lines, end);
            // The stress along the crack that the plate had before it.
            let along = residual.map_or(0.0, |residual| residual.along(lines[end.line].end(end.at_last), ahead_of_tip));
            t_stress += along;
            // Superposition with free flanks is not at hand: of a tip that is closed no K counts.
            let at_load = |place: usize, factors: [f64; 2], t_stress: f64| {
                let is_closed = is_closed(place, end);
                let free = (is_closed && residual.is_some()).then_some([0.0; 2]);
                AtLoad {
                    load: loads[place].0,
                    factors: [if is_closed { 0.0 } else { factors[0] }, factors[1]],
                    t_stress,
                    is_closed,
                    free,
                }
            };
            let at_other = |place: usize| {
                let ring = under(place).read(end, excess + ahead);
                at_load(place, ring.factors, ring.t_stress + along)
            };
            let others: Vec<AtLoad> = (0..loads.len()).filter(|place| *place != own).map(at_other).collect();
            let (length_offset, spacing, response) = (excess + ahead, body.lattice.spacing, Response::PROPORTIONAL);
            let reading = Reading {
                factors,
                t_stress,
                ahead: ahead_of_tip,
                spacing,
                length_offset,
                is_closed: is_shut,
                of_pressure,
                response,
            };
            (reading.beside(at_load(own, factors, t_stress), &others, residual.is_none()), sliding)
        };
        let of_tip = |(index, tip): (usize, &Tip)| tip.is_active().then(|| read((index, tip)));
        let read: Vec<_> = cracks.tips.par_iter().enumerate().map(of_tip).collect();
        let mut sliding: Vec<Option<Sliding>> = read.iter().map(|read| read.and_then(|(_, sliding)| sliding)).collect();
        let mut at_line: Vec<Option<[f64; 2]>> = sliding.iter().map(|sliding| sliding.map(|s| [s.at_line; 2])).collect();
        pair_twins(&mut at_line);
        let pairs = sliding.iter_mut().zip(at_line).filter_map(|(sliding, at_line)| sliding.as_mut().zip(at_line));
        pairs.for_each(|(sliding, at_line)| sliding.at_line = at_line[0]);
        (read.into_iter().map(|read| read.map(|(reading, _)| reading)).collect(), sliding)
    }

    /// K of the initial cracks drawn back by so much ([`super::PROBE_HORIZONS`]): with that of the cracks it tells how K changes.
    pub(super) fn read_slopes(&mut self, case: &Case, cracks: &CracksState, drawn_back: &[CrackLine]) {
        let horizon = self.body.horizon();
        let (readings, sliding) = self.read_rings(case, cracks, drawn_back);
        let mut factors: Vec<Option<[f64; 2]>> = readings.iter().map(|reading| reading.map(|reading| reading.factors)).collect();
        pair_twins(&mut factors);
        for (index, tip) in cracks.tips.iter().enumerate() {
            let (Some(reading), Some(factors)) = (readings[index], factors[index]) else { continue };
            let back = distance(cracks.position(tip), drawn_back[tip.end.line].end(tip.end.at_last));
            let memory = &mut self.memory[index];
            memory.readings.take(equivalent_factor(factors), -back, reading.length_offset, None, horizon);
            if let Some(Sliding { offset, factor, .. }) = sliding[index] {
                memory.sliding_readings.take(factor.abs(), -back, offset, None, horizon);
            }
        }
    }

    /// K_I and K_II, Pa√m, at the end of the line of a tip from what its ring says, `gap` being that to a tip which it faces, m.
    pub(super) fn at_line(
        &mut self,
        case: &Case,
        cracks: &CracksState,
        index: usize,
        reading: &Reading,
        gap: Option<f64>,
    ) -> [f64; 2] {
        let (horizon, scales) = (self.body.horizon(), self.scales(case));
        let (tip, memory) = (&cracks.tips[index], &mut self.memory[index]);
        let (read, of_read) = (reading.factors, equivalent_factor(reading.factors));
        let corner = tip.steering.corner();
        memory.readings.take(of_read, tip.growth, reading.length_offset, corner, horizon);
        // Both modes alike: what the tip's field lacks or has too much is length.
        let mut ratio = memory.readings.ratio(reading.length_offset, tip.length + tip.growth, horizon);
        // Until the bonds show a kink, less is read.
        if let Some(factor) = tip.kink.and_then(|kink| kink.factor(tip.growth, tip.length, scales.kink_unresolved)) {
            ratio = factor / of_read;
        } else if corner.is_some_and(|corner| tip.growth < corner + KINK_HORIZONS * horizon && tip.growth > corner) {
            ratio = ratio.max(tip.equivalent() / of_read);
        }
        let mut factors = read.map(|factor| ratio * factor);
        if let Some(sliding) = memory.sliding {
            factors[1] = sliding.at_line;
        }
        if let Some(gap) = gap {
            factors = memory.coalescence.factors(factors, gap, [scales.meeting.unread, horizon]);
        }
        // Beside a rim a ring that overlaps it may say anything.
        let is_read = tip.growth == 0.0
            || tip.equivalent() == 0.0
            || equivalent_factor(factors) < RISE_MOST * tip.equivalent()
            || case.specimen.rim_distance(cracks.position(tip)) > CORE_HORIZONS * horizon;
        let is_near = !reading.is_closed
            && tip.growth > 0.0
            && ahead::is_near_rim(&case.specimen, &cracks.lines, tip.end, CORE_HORIZONS * horizon);
        let has_risen = equivalent_factor(factors) >= tip.equivalent();
        if is_read && (has_risen || !is_near) { factors } else { tip.factors }
    }
}
