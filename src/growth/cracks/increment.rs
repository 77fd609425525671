//! One increment of all cracks, call by call ([`crate::predict::increment`]).

use super::meeting::Segment;
use super::steering::factors_across;
use super::step::{Counted, Course, FactorCourse};
use super::tip::{Reading, Tip, pair_twins};
use super::{CrackedPlate, Cracks, Parted, kink, step};
use crate::cross_check::ReleasedEnergy;
use crate::end_of_life::{self, gone};
use crate::record::{CurvePoint, StopReason};
use perilife_base::error::Error;
use perilife_base::units::MM;
use perilife_laws::response::Response;
use perilife_points::crack_tip::TipState;

/// Rise of the compliance above which a plate without equilibrium counts as severed.
const MECHANISM: f64 = 20.0;
/// The same where an equilibrium was found: what K such a ligament has is round-off.
const SEVERED: f64 = 1e6;
/// Spacings on a ligament that resolve it.
const LIGAMENT_SPACINGS: f64 = 4.0;
/// Relative difference of a crack length from a corner of the load at which it is there.
const ON_CORNER: f64 = 1e-6;

pub struct Increment {
    /// The tip whose cycles count: the fastest.
    lead: usize,
    /// Growth that every tip is to make, m.
    lengths: Vec<f64>,
    segments: Vec<Option<Segment>>,
    /// Rate of the lead at the start, m/cycle, and K that drives it, Pa√m.
    rate: f64,
    factor: f64,
    /// Whether the lead begins a kink, else its rate at the start of the increment before and its growth in that, where they are known.
    is_kink: bool,
    past: Option<[f64; 2]>,
    /// Root of the length of crack of the lead at the start, m^½.
    root: f64,
    /// Of every tip `K_eq²/E'`, J/m², and the length that its crack stands for beyond that of its line, m; work of the loads, J.
    before: (Vec<[f64; 2]>, f64),
    parted: Parted,
    readings: Vec<Option<Reading>>,
}

impl Increment {
    /// Whether a tip has met a rim or another crack.
    fn has_ended_tips(&self) -> bool {
        self.segments.iter().flatten().any(|segment| segment.state != TipState::Active)
    }

    /// Growth of every tip, m.
    fn growths(&self) -> Vec<f64> {
        self.segments.iter().map(|segment| segment.as_ref().map_or(0.0, Segment::length)).collect()
    }
}

impl<P: CrackedPlate> Cracks<'_, P> {
    /// Why there is no increment from the last row: a known end is reached, K_max of a tip is the toughness, no tip is left or grows.
    pub(crate) fn reason_to_stop(&self) -> Option<StopReason> {
        let states: Vec<TipState> = self.state.tips.iter().map(|tip| tip.state).collect();
        end_of_life::reason_to_stop(self.case, self.end, self.last(), &states, self.fastest().is_some())
    }

    /// Growth of every tip over the same cycles, the fastest by one step. To be asked while a tip grows ([`Self::reason_to_stop`]).
    pub(crate) fn increments(&self) -> Increment {
        let lead = self.fastest().unwrap_or(0);
        let end = self.end.map_or(f64::INFINITY, |end| end.crack_length);
        let until = self.corner_of_load(self.crack_length()).map_or(end, |corner| corner.min(end));
        let tip = &self.state.tips[lead];
        Increment {
            lead,
            lengths: self.next_lengths(lead, until),
            segments: Vec::new(),
            rate: tip.rate,
            factor: tip.driving_factor(),
            is_kink: tip.begins_kink(),
            // The rates before a corner of the load and behind it lie on no parabola.
            past: tip.past().filter(|_| !self.is_at_corner()),
            root: tip.root(tip.growth),
            before: self.energies(),
            parted: Parted::default(),
            readings: Vec::new(),
        }
    }

    /// Extends the lines of the cracks by a straight segment each, up to a rim or another crack; cracks that meet are joined.
    pub(crate) fn extend_lines(&mut self, step: &mut Increment) {
        step.segments = self.segments(&step.lengths);
        let growths = step.growths();
        for ((tip, segment), growth) in self.state.tips.iter_mut().zip(&step.segments).zip(&growths) {
            if let Some(segment) = segment.filter(|_| *growth > 0.0) {
                self.state.lines[tip.end.line].grow(tip.end.at_last, segment.to);
            }
            let state = segment.map_or(tip.state, |segment| segment.state);
            tip.has_grown([*growth, growths[step.lead]], state, self.scales.by_root);
        }
        if step.has_ended_tips() {
            self.join(&step.segments);
        }
    }

    /// Parts the plate along the new segments: bonds that cross them are cut, or nodes placed anew.
    pub(crate) fn part_plate(&mut self, step: &mut Increment) {
        step.parted = self.plate.part(self.case, &self.state, &step.segments, step.has_ended_tips());
    }

    /// Finds the displacement in equilibrium with the maximum load; else why the run ends.
    pub(crate) fn solve_equilibrium(&mut self, step: &Increment) -> Result<(), StopReason> {
        if step.parted.is_severed {
            return Err(StopReason::Severed);
        }
        let Err(error) = self.plate.solve(self.case, &self.state) else {
            return if self.compliance_rise(self.work(), self.crack_length()) < SEVERED {
                Ok(())
            } else {
                Err(StopReason::Severed)
            };
        };
        // What the last tip has met ends the run, whatever can be solved of the pieces that are left.
        if matches!(error, Error::LossOfStiffness) || self.state.active().next().is_none() {
            return Err(StopReason::Severed);
        }
        let rise = self.compliance_rise(self.last().work, self.last().crack_length);
        if rise > MECHANISM {
            self.warnings.push(format!(
                "stopped: compliance rose {rise:.0} times; the remaining ligament has almost no stiffness ({error})"
            ));
            return Err(StopReason::Severed);
        }
        self.warnings.push(format!("stopped: {error}"));
        Err(StopReason::NoConvergence)
    }

    /// Reads K_I, K_II and T of every active tip at the place where its field stands.
    pub(crate) fn read_factors(&mut self, step: &mut Increment) -> Result<(), StopReason> {
        step.readings = self.read().map_err(|error| {
            self.warnings.push(format!("stopped: {error}"));
            StopReason::NoConvergence
        })?;
        let is_unread = |reading: &Reading| !reading.factors.iter().all(|factor| factor.is_finite());
        if step.readings.iter().flatten().any(is_unread) { Err(StopReason::NoConvergence) } else { Ok(()) }
    }

    /// What is read at every active tip, the same of mirror twins, so that they stay twins.
    pub(super) fn read(&mut self) -> Result<Vec<Option<Reading>>, Error> {
        let mut readings = self.plate.read(self.case, &self.state)?;
        let mut factors: Vec<Option<[f64; 2]>> = readings.iter().map(|reading| reading.map(|reading| reading.factors)).collect();
        let twins = pair_twins(&mut factors);
        let pairs = readings.iter_mut().zip(factors).filter_map(|(reading, factors)| reading.as_mut().zip(factors));
        pairs.for_each(|(reading, factors)| reading.factors = factors);
        // Tips that open under unlike loads, as on both sides of a bent plate, are no twins in that.
        let responses: Vec<Option<Response>> = readings.iter().map(|reading| reading.map(|reading| reading.response)).collect();
        let of_twins = readings.iter_mut().zip(twins).filter_map(|(reading, twin)| reading.as_mut().zip(responses[twin]));
        of_twins
            .filter(|(reading, response)| reading.response.is_near(response))
            .for_each(|(reading, response)| reading.response = response);
        Ok(readings)
    }

    /// Turns every active tip by what was read.
    pub(crate) fn turn(&mut self, step: &Increment) {
        self.turn_by(&step.readings);
    }

    pub(super) fn turn_by(&mut self, readings: &[Option<Reading>]) {
        let tips = self.state.tips.iter_mut().zip(readings);
        tips.filter_map(|(tip, reading)| Some((tip, reading.as_ref()?))).for_each(|(tip, reading)| {
            tip.turn(reading, &self.scales.steering);
        });
    }

    /// Takes da/dN of the K of every active tip.
    pub(crate) fn set_rates(&mut self, step: &Increment) {
        self.set_rates_by(&step.readings);
    }

    pub(super) fn set_rates_by(&mut self, readings: &[Option<Reading>]) {
        let gaps: Vec<Option<f64>> = (0..readings.len()).map(|tip| self.faced(tip).map(|(_, gap)| gap)).collect();
        for (index, reading) in readings.iter().enumerate() {
            let Some(reading) = reading else { continue };
            let mut factors = reading.factors;
            if !self.state.tips[index].is_closed {
                factors = self.plate.factors_at_line(self.case, &self.state, index, reading, gaps[index]);
            }
            let (law, ratio) = (&self.law, self.case.loading.ratio);
            self.state.tips[index].take(factors, reading.response, |factor, response| law.mean_rate(factor, ratio, response));
        }
    }

    /// Adds the row after an increment, and says why there is no next one: `end`, or what the row itself says.
    pub(crate) fn add_row(&mut self, step: &Increment, mut end: Option<StopReason>) -> Option<StopReason> {
        let (growths, has_ended, is_over) = (step.growths(), step.has_ended_tips(), end.is_some());
        let (growth, lead) = (growths[step.lead], &self.state.tips[step.lead]);
        // Where a tip is gone, K of the others is that of another crack at the end of the step, not of this one grown longer. Of a tip that
        // turns a corner the rate is that of its new kink, not that with which it has ended its step.
        let is_smooth = lead.is_growing() && !is_over && !has_ended;
        let (factor, rate) = if is_smooth { (lead.equivalent(), self.rate(lead)) } else { (step.factor, step.rate) };
        let Counted { cycles, curvature_share, bend } = if step.is_kink {
            let cycles = kink::cycles(growth, [step.rate, rate], [step.factor, factor]);
            Counted { cycles, curvature_share: 0.0, bend: 0.0 }
        } else if self.scales.by_root && growth > 0.0 && rate.is_finite() {
            let root_after = |way: f64| (step.root.powi(2) + way).max(0.0).sqrt();
            let (before, then) = (step.past.map(|[rate, way]| [root_after(-way), rate]), root_after(growth));
            if let Some([root, of_it]) = before.filter(|_| is_smooth) {
                // The step before by the parabola through the rate at the end of this one.
                let late = step::cycles_by_root(Some([then, rate]), [of_it, step.rate], [root, step.root]).cycles;
                let from = self.curve[..self.curve.len() - 1].iter().rfind(|row| row.is_solved).map_or(0.0, |row| row.cycles);
                let short = 0.5 * (late + from - self.last().cycles);
                self.state.step_error += if short.is_finite() { short } else { 0.0 };
            }
            step::cycles_by_root(before, [step.rate, rate], [step.root, then])
        } else {
            step::cycles(step.past, step.rate, rate, growth)
        };
        // A rate without bound at K_c continues no rate before it.
        let way = (is_smooth && growth > 0.0 && rate.is_finite()).then(|| {
            let is_by_root = self.scales.by_root || step.is_kink;
            let rise = (step.root * step.root + growth).sqrt() - step.root;
            let weight = if is_by_root { [step.root, rise] } else { [1.0, 0.0] };
            FactorCourse::new(Course { weight, gain: (rate / step.rate).ln(), bend }, [step.factor, factor])
        });
        for (index, tip) in self.state.tips.iter_mut().enumerate().filter(|_| self.scales.by_root) {
            if is_smooth {
                tip.count_arrears(growths[index], (step.rate, rate), growths[step.lead]);
            } else {
                tip.arrears = 0.0;
            }
        }
        let fastest = self.fastest().map_or(0.0, |tip| self.state.tips[tip].rate);
        let kinks = |tip: &Tip| tip.begins_kink() && !tip.is_at_rest(fastest);
        let is_kinking = self.scales.step.first_of_kink.is_finite() && self.state.tips.iter().any(kinks);
        if has_ended || is_kinking || self.is_at_corner() {
            self.state.step = self.first_step(self.last().cycles + cycles);
        } else if growth > 0.0 && !is_over {
            let all = self.last().cycles + cycles;
            self.state.step = self.next_step(growth, curvature_share, cycles / all);
        }
        let is_closing = |(index, _): (usize, &Tip)| self.is_closing(index);
        // What flanks under residual stress do in contact is known worse than the energy that a step releases.
        let is_wedged = self.case.loading.residual.is_some() && self.plate.is_in_contact();
        if has_ended || is_over || is_wedged || self.state.active().any(is_closing) {
            self.state.balance.forget();
        } else {
            let way = way.as_ref().filter(|_| !step.is_kink);
            self.compare_energies(step, &growths, way.map_or(1.0, FactorCourse::square_beside_chord), cycles);
        }
        self.plate.update(&self.state);
        let work = if is_over { f64::NAN } else { self.work() };
        // What the last tip has met is known, whatever is left of the plate.
        if !step.parted.is_severed && self.state.active().next().is_none() {
            let last: Vec<TipState> = step.segments.iter().flatten().map(|segment| segment.state).collect();
            end = Some(gone(&last));
        }
        if end.is_none()
            && let Some((tip, ligament)) = self.unresolved_ligament()
        {
            self.warnings.push(format!(
                "stopped: tip {tip} is {:.3} mm from an edge, less than the spacing {:.3} mm; use model.spacing_mm = {:.4}",
                ligament / MM,
                self.scales.meeting.passing / MM,
                ligament / LIGAMENT_SPACINGS / MM
            ));
            end = Some(StopReason::LigamentUnresolved);
        }
        let (all, broken) = (self.last().cycles + cycles, self.last().broken_bonds + step.parted.bonds);
        let next = self.row(all, work, broken);
        if step.parted.bonds == 0 && cycles <= 0.0 {
            return end_of_life::row_after(self.case, self.last(), next, end).1;
        }
        let between = way.as_ref().map_or_else(Vec::new, |way| self.rows_between(step, &next, way, cycles / all));
        for row in between {
            let (row, reason) = end_of_life::row_after(self.case, self.last(), row, None);
            self.curve.push(row);
            if reason.is_some() {
                return reason;
            }
        }
        let (row, reason) = end_of_life::row_after(self.case, self.last(), next, end);
        self.curve.push(row);
        reason
    }

    /// Rows up to `next`, so that straight lines follow the curve by which cycles were counted; the lead goes `way`.
    fn rows_between(&self, step: &Increment, next: &CurvePoint, way: &FactorCourse, of_all: f64) -> Vec<CurvePoint> {
        let (course, last) = (&way.course, self.last());
        let (rate, factor) = (step.rate * course.gain.exp(), way.at(1.0));
        let row_at = |t: f64| {
            let mut row = next.clone().between(last, t);
            let of_lead = course.growth(t);
            // The same of all tips.
            let beside_chord = way.beside_chord(t);
            for (index, tip) in row.tips.iter_mut().enumerate() {
                let own = &self.state.tips[index];
                let share = if index == step.lead { of_lead } else { own.share_at(of_lead, (step.rate, rate)) };
                let [from, to] = [&last.tips[index], &next.tips[index]];
                // K was read before the line turned into the piece of this increment.
                let turn = if to.growth > from.growth { self.state.lines[own.end.line].last_turn(own.end.at_last) } else { 0.0 };
                let ends = from.factors.map(|factors| factors_across(factors, turn)).zip(to.factors);
                tip.factors = ends.map(|(a, b)| [0, 1].map(|i| beside_chord * (a[i] + t * (b[i] - a[i]))));
                if own.has_begun_kink() {
                    // K at a corner is that of the crack before it.
                    let of_end = (step.factor / factor).powf(1.0 - t);
                    tip.factors = to.factors.map(|factors| factors.map(|k| of_end * k));
                    tip.t_stress = to.t_stress;
                }
                let mix = |from: f64, to: f64| from + share * (to - from);
                (tip.growth, tip.state) = (mix(from.growth, to.growth), from.state);
                tip.position = [0, 1].map(|i| mix(from.position[i], to.position[i]));
            }
            let grown: Vec<f64> = row.tips.iter().map(|tip| tip.growth).collect();
            CurvePoint {
                cycles: last.cycles + course.cycles(t) * (next.cycles - last.cycles),
                crack_length: self.case.specimen.crack_length_after(&grown),
                delta_k: row.range_share(&self.case.loading) * way.at(t),
                growth_rate: step.rate * course.rise(t).exp(),
                ..row
            }
        };
        let parts = course.parts(of_all);
        (1..parts).map(|part| row_at(part as f64 / parts as f64)).collect()
    }

    /// The next crack length, m, at which a load that follows the crack turns a corner.
    fn corner_of_load(&self, from: f64) -> Option<f64> {
        self.case.loading.course()?.corner_after(from)
    }

    /// Whether the crack has just reached one.
    fn is_at_corner(&self) -> bool {
        let length = self.crack_length();
        self.corner_of_load(length * (1.0 - ON_CORNER)).is_some_and(|corner| corner <= length * (1.0 + ON_CORNER))
    }

    /// Compliance of an equilibrium by the work of its loads, J, over that at the start.
    fn compliance_rise(&self, work: f64, crack_length: f64) -> f64 {
        let compliance = |work: f64, length: f64| work / self.case.loading.doing(work, length).powi(2);
        compliance(work, crack_length) / compliance(self.curve[0].work, self.curve[0].crack_length)
    }

    /// Of every tip `K_eq²/E'`, J/m², and the length that its crack stands for beyond that of its line, m; work of the loads, J. All of a load that
    /// follows the crack as it was at the start: what a crack releases is the work that one load does more.
    fn energies(&self) -> (Vec<[f64; 2]>, f64) {
        let (modulus, loading) = (self.case.material.plane_modulus(), &self.case.loading);
        let load = loading.at(self.crack_length()) / loading.maximum;
        // What a tip has at the load that the work is of.
        let factor = |tip: &Tip| tip.driving_factor() * tip.response.at(1.0).max(0.0) / load;
        let of_tip = |tip: &Tip| [factor(tip).powi(2) / modulus, tip.length_offset];
        (self.state.tips.iter().map(of_tip).collect(), self.work() / (load * load))
    }

    /// Compares the energy released by K of new segments with that of the plate; `beside_chord`: K² on the way over the chord.
    fn compare_energies(&mut self, step: &Increment, growths: &[f64], beside_chord: f64, cycles: f64) {
        let ((now, work_now), (before, work)) = (self.energies(), &step.before);
        let grown: Vec<f64> = self.state.tips.iter().map(|tip| tip.growth).collect();
        let (block, length) = ReleasedEnergy::of_block(self.case, [before, &now], growths, &grown, [*work, work_now], cycles);
        let block = ReleasedEnergy { of_tips: beside_chord * block.of_tips, ..block };
        self.state.balance.take(block, length, self.scales.energy_interval);
    }
}
