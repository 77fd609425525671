//! One increment of all cracks, call by call ([`crate::predict::increment`]).

use super::step;
use super::{Tip, TipField, ahead};
use crate::body::balanced::flanks::{self, FlankRange};
use crate::body::pre_crack::bonds_across;
use crate::body::{Body, Bond};
use crate::bond_law::SurfaceCorrection;
use crate::error::{Error, Result};
use crate::fatigue::crack_tip::TipState;
use crate::fatigue::pieces::{Connectivity, remove_fragments};
use crate::growth::TipGrowth;
use crate::growth::cross_check::ReleasedEnergy;
use crate::growth::end_of_life::{self, gone};
use crate::growth::record::StopReason;
use crate::growth::tip_ring::DIRECTION_SPACINGS;
use crate::solver::field::Layout;
use crate::specimen::geometry::{along, distance};
use crate::specimen::{CrackLine, Point};
use crate::units::MM;

/// Distance from an edge, in spacings, from which points cannot resolve what is left.
const THROUGH_SPACINGS: f64 = 0.75;
/// Distance of a rim beside a tip, in spacings, from which nothing is left between them that carries.
const BESIDE_SPACINGS: f64 = 0.5;
/// Distance between a tip and the place where another meets its crack, in horizons, within which both are joined if they face each
/// other.
const JOINED_HORIZONS: f64 = 1.0;

/// Spacings on a ligament that resolve it.
const LIGAMENT_SPACINGS: f64 = 4.0;
/// Solves of an increment in which flanks come into contact or part; the last set of places is taken then. Where little is left of a
/// plate a few places flicker.
const CONTACT_SOLVES_MOST: usize = 20;
/// Compliance over that at the start from which a plate without equilibrium is as good as severed: what one side of it has let go turns
/// about the last points of the other.
const MECHANISM: f64 = 20.0;
/// Overlap of flanks, in spacings times the mean strain of the plate, that is round-off.
const CONTACT_LEAST: f64 = 1e-3;

/// A new straight segment of crack, and what becomes of the tip at its end.
struct Segment {
    from: Point,
    to: Point,
    state: TipState,
    /// The crack that it meets.
    meets: Option<usize>,
}

impl Segment {
    fn length(&self) -> f64 {
        distance(self.from, self.to)
    }
}

/// An increment in the making.
pub struct Increment {
    /// The tip whose cycles count: the fastest.
    lead: usize,
    /// Growth that every tip is to make, m.
    lengths: Vec<f64>,
    segments: Vec<Option<Segment>>,
    /// Rate of the lead at the start, m/cycle; that at the start of the increment before, and its length, m.
    rate: f64,
    past: Option<[f64; 2]>,
    /// Of every tip `K_eq²/E'`, J/m², and the length that its cut bonds stand for beyond that of its line, m; work of the loads, J.
    before: (Vec<[f64; 2]>, f64),
    /// Bonds that were cut or got another multiplier, those cut first.
    changed: Vec<Bond>,
    /// How many of them were cut.
    cut: usize,
    /// Whether the cut left two loaded pieces.
    is_severed: bool,
    /// Whether the displacement is that of the new cracks.
    is_settled: bool,
    /// Why there is no next increment.
    end: Option<StopReason>,
}

impl Increment {
    /// Whether a tip has met a rim or another crack.
    fn has_ended_tips(&self) -> bool {
        self.segments.iter().flatten().any(|segment| segment.state != TipState::Active)
    }

    /// Growth of the lead, m.
    fn growth(&self) -> f64 {
        self.segments[self.lead].as_ref().map_or(0.0, Segment::length)
    }

    /// Growth of every tip, m.
    fn growths(&self) -> Vec<f64> {
        self.segments.iter().map(|segment| segment.as_ref().map_or(0.0, Segment::length)).collect()
    }
}

impl TipGrowth for TipField<'_> {
    type Increment = Increment;

    fn reason_to_stop(&self) -> Option<StopReason> {
        let states: Vec<TipState> = self.state.tips.iter().map(|tip| tip.state).collect();
        end_of_life::reason_to_stop(self.case, self.end, self.last(), &states, self.fastest().is_some())
    }

    fn increments(&self) -> Increment {
        let lead = self.fastest().unwrap_or(0);
        let until = self.end.map_or(f64::INFINITY, |end| end.crack_length);
        let Tip { rate, past, .. } = self.state.tips[lead];
        Increment {
            lead,
            lengths: self.next_lengths(lead, self.last().cycles, until),
            segments: Vec::new(),
            rate,
            past,
            before: self.energies(),
            changed: Vec::new(),
            cut: 0,
            is_severed: false,
            is_settled: false,
            end: None,
        }
    }

    fn extend_lines(&mut self, step: &mut Increment) {
        let segment = |(tip, length): (&Tip, &f64)| (*length > 0.0).then(|| self.segment(tip, *length));
        step.segments = self.state.tips.iter().zip(&step.lengths).map(segment).collect();
        let growth = step.growth();
        for (tip, segment) in self.state.tips.iter_mut().zip(&step.segments) {
            let Some(Segment { from, to, state, .. }) = segment else {
                tip.stood_still(growth);
                continue;
            };
            self.state.lines[tip.end.line].grow(tip.end.at_last, *to);
            tip.has_grown(distance(*from, *to), growth, *state);
        }
        if step.has_ended_tips() {
            self.join(&step.segments);
        }
    }

    fn part_plate(&mut self, step: &mut Increment) {
        let body = &self.body.clone();
        let tips = self.state.tips.iter().zip(&step.segments);
        let across =
            |(tip, segment): (&Tip, &Option<Segment>)| segment.as_ref().map(|segment| across(body, segment, tip.end.at_last));
        let mut cut: Vec<Bond> = tips.filter_map(across).flatten().filter(|&bond| self.bonds.is_intact(bond)).collect();
        cut.sort_unstable();
        cut.dedup();
        cut.iter().for_each(|&bond| self.bonds.cut(body, bond));
        match remove_fragments(body, &mut self.bonds, &cut) {
            Connectivity::Severed => (step.is_severed, step.end) = (true, Some(StopReason::Severed)),
            Connectivity::Connected(fragments) => cut.extend(fragments),
        }
        step.cut = cut.len();
        step.changed = cut;
        if step.end.is_none() {
            let range = if step.has_ended_tips() { FlankRange::All } else { FlankRange::Tips };
            let lines = self.state.lines.clone();
            step.changed.extend(self.correct_flanks(&lines, range));
        }
    }

    fn solve_equilibrium(&mut self, step: &mut Increment) {
        if step.end.is_some() {
            return;
        }
        let lines = self.state.lines.clone();
        match self.settle(&step.changed, &lines) {
            Ok(()) => step.is_settled = true,
            Err(Error::LossOfStiffness) => step.end = Some(StopReason::Severed),
            Err(error) if self.compliance_rise() > MECHANISM => {
                self.warnings.push(format!(
                    "the run ends here: the plate is {:.0} times as compliant as at the start, and what is left of it moves almost freely \
                     ({error})",
                    self.compliance_rise()
                ));
                step.end = Some(StopReason::Severed);
            }
            Err(error) => {
                self.warnings.push(format!("the run ends here: {error}"));
                step.end = Some(StopReason::NoConvergence);
            }
        }
    }

    fn read_factors(&mut self, step: &Increment) {
        if step.is_settled {
            self.read_fields();
        }
    }

    fn turn(&mut self, step: &Increment) {
        if step.is_settled {
            self.choose_directions();
        }
    }

    fn set_rates(&mut self, step: &Increment) {
        if step.is_settled {
            self.choose_rates();
        }
    }

    fn add_row(&mut self, mut step: Increment) -> Option<StopReason> {
        if step.is_settled && self.state.tips.iter().any(|tip| !tip.equivalent().is_finite()) {
            return Some(StopReason::NoConvergence);
        }
        let (growth, has_ended) = (step.growth(), step.has_ended_tips());
        let is_over = step.end.is_some();
        // Where a tip is gone, K of the others is that of another crack at the end of the step, not of this one grown longer.
        let lead = &self.state.tips[step.lead];
        let rate_then = if lead.is_growing() && !is_over && !has_ended { lead.rate } else { step.rate };
        let (cycles, curvature_share) = step::cycles(step.past, step.rate, rate_then, growth);
        if has_ended {
            self.state.step = self.steps.first();
        } else if growth > 0.0 && !is_over {
            self.state.step = self.steps.next(growth, curvature_share);
        }
        let closing = self.state.tips.iter().any(|tip| tip.state == TipState::Active && self.is_closing(tip));
        if has_ended || closing || is_over {
            self.state.balance.forget();
        } else {
            self.compare_energies(&step, cycles);
        }
        self.update_remaining_life();
        let work = if is_over { f64::NAN } else { self.work() };
        let is_left = self.state.tips.iter().any(|tip| tip.state == TipState::Active);
        // What the last tip has met is known, whatever is left of the plate.
        if !is_left && !step.is_severed {
            let last: Vec<TipState> = step.segments.iter().flatten().map(|segment| segment.state).collect();
            step.end = Some(gone(&last));
        }
        if step.end.is_none()
            && let Some((tip, ligament)) = self.unresolved_ligament()
        {
            let spacing = self.body.lattice.spacing;
            self.warnings.push(format!(
                "tip {tip} passes a rim at {:.3} mm, less than the spacing of {:.3} mm: the run ends there; model.spacing_mm = {:.4} would \
                 resolve what is between them",
                ligament / MM,
                spacing / MM,
                ligament / LIGAMENT_SPACINGS / MM
            ));
            step.end = Some(StopReason::LigamentUnresolved);
        }
        let last = self.last();
        let next = self.row(last.cycles + cycles, work, last.broken_bonds + step.cut);
        let (row, reason) = end_of_life::row_after(self.case, last, next, step.end);
        if step.cut > 0 || cycles > 0.0 {
            self.curve.push(row);
        }
        reason
    }
}

impl TipField<'_> {
    /// Of every tip `K_eq²/E'`, J/m², and the length that its cut bonds stand for beyond that of its line, m; work of the loads, J.
    fn energies(&self) -> (Vec<[f64; 2]>, f64) {
        let modulus = self.case.material.plane_modulus();
        let of_tip = |tip: &Tip| [tip.equivalent().powi(2) / modulus, tip.length_offset];
        (self.state.tips.iter().map(of_tip).collect(), self.work())
    }

    /// Compares the energy that the new segments released by their K with what the plate did.
    fn compare_energies(&mut self, step: &Increment, cycles: f64) {
        let ((now, work_now), (before, work), growths) = (self.energies(), &step.before, step.growths());
        let grown: Vec<f64> = self.state.tips.iter().map(|tip| tip.growth).collect();
        let (block, length) = ReleasedEnergy::of_block(self.case, [before, &now], &growths, &grown, [*work, work_now], cycles);
        self.state.balance.take(block, length, self.body.horizon());
    }

    /// Joins cracks that have met, and lets the tips that are left forget what they were: the crack that they end is another one.
    fn join(&mut self, segments: &[Option<Segment>]) {
        let reach = JOINED_HORIZONS * self.body.horizon();
        for (tip, segment) in segments.iter().enumerate() {
            let Some(Segment { from, to, meets: Some(met), .. }) = segment else { continue };
            let heading = [to[0] - from[0], to[1] - from[1]];
            let (own, lines) = (self.state.tips[tip].end.line, &self.state.lines);
            for other in self.state.tips.iter_mut().filter(|other| other.end.line == *met && other.end.line != own) {
                let line = &lines[other.end.line];
                let [x, y] = line.direction(other.end.at_last);
                let faces = heading[0] * x + heading[1] * y < 0.0;
                if other.state == TipState::Active && faces && distance(line.end(other.end.at_last), *to) < reach {
                    other.state = TipState::LinkedUp;
                }
            }
        }
        self.state.tips.iter_mut().for_each(Tip::forget_history);
    }

    /// The next segment of crack at a tip: straight on, up to a rim or another crack if one lies on the way or right beside its end.
    fn segment(&self, tip: &Tip, length: f64) -> Segment {
        let (specimen, lines, body) = (&self.case.specimen, &self.state.lines, &self.body);
        let spacing = body.lattice.spacing;
        let (from, ahead) = (self.position(tip), self.heading(tip.end));
        let direction = tip.steering.direction(tip.growth, length, ahead, body.horizon());
        let at = |length: f64| [0, 1].map(|i| from[i] + length * direction[i]);
        let (reach, next) = (at(length + THROUGH_SPACINGS * spacing), at(length));
        let near = ahead::first_rim(specimen, lines, tip.end.line, from, reach)
            .map(|(share, what)| (along(from, reach, share), what))
            .or_else(|| ahead::beside(specimen, lines, tip.end.line, next, BESIDE_SPACINGS * spacing));
        near.map_or(Segment { from, to: next, state: TipState::Active, meets: None }, |(to, what)| Segment {
            from,
            to,
            state: what.state,
            meets: what.crack,
        })
    }

    /// Bonds beside the flanks of the cracks that are cut; gives those that changed.
    pub(super) fn correct_flanks(&mut self, lines: &[CrackLine], range: FlankRange) -> Vec<Bond> {
        let is_balanced = self.case.model.bond_law.surface_correction == SurfaceCorrection::Balanced;
        if !is_balanced {
            return Vec::new();
        }
        let end = |tip: &Tip| lines[tip.end.line].end(tip.end.at_last);
        let ends: Vec<Point> = self.state.tips.iter().map(end).collect();
        let active = self.state.tips.iter().filter(|tip| tip.state == TipState::Active).map(end);
        let tips: Vec<Point> = active.chain(self.corners.iter().copied()).collect();
        let body = &self.body;
        let changed = flanks::multipliers(body, &self.bonds.multiplier, lines, &tips, &ends, range);
        changed.iter().for_each(|&(bond, multiplier)| self.bonds.set(body, bond, multiplier));
        changed.into_iter().map(|(bond, _)| bond).collect()
    }

    /// Equilibrium after bonds were cut or corrected, with flanks that do not overlap; the displacement stays as it was where there is
    /// none.
    pub(super) fn settle(&mut self, changed: &[Bond], lines: &[CrackLine]) -> Result<()> {
        let body = &self.body.clone();
        self.equilibrium.bonds_changed(body, &self.bonds, changed);
        let blunted = self.blunted(lines);
        self.contact.follow(body, &blunted, self.case.material.plane_modulus());
        let before = self.displacement.clone();
        for solve in 1..=CONTACT_SOLVES_MOST {
            self.equilibrium.set_contact(body, &self.contact.springs(self.crack_pressure(), body.thickness));
            match self.equilibrium.solve(body, &self.bonds, &mut self.displacement) {
                Ok(iterations) => self.iterations += iterations,
                Err(error) => {
                    self.displacement = before;
                    return Err(error);
                }
            }
            self.solves += 1;
            let least = CONTACT_LEAST * self.mean_strain() * body.lattice.spacing;
            if solve == CONTACT_SOLVES_MOST || !self.contact.update(&self.layout(), &self.displacement, least) {
                break;
            }
        }
        Ok(())
    }

    /// Compliance of the last equilibrium over that at the start.
    fn compliance_rise(&self) -> f64 {
        let rise = self.last().work / self.curve[0].work;
        // Of a kept displacement the work falls as the compliance rises.
        if self.case.loading.displacement().is_some() { 1.0 / rise } else { rise }
    }

    /// Cracks whose ends are as long as they have to be to show a direction.
    fn blunted(&self, lines: &[CrackLine]) -> Vec<CrackLine> {
        let mut blunted = lines.to_vec();
        for Tip { end, .. } in &self.state.tips {
            let line = &mut blunted[end.line];
            *line = line.blunted(end.at_last, DIRECTION_SPACINGS * self.body.lattice.spacing);
        }
        blunted
    }

    /// Root mean square of the strain, of which the energy of the plate tells.
    fn mean_strain(&self) -> f64 {
        let volume = self.case.specimen.area() * self.case.specimen.thickness;
        (self.equilibrium.work() / (volume * self.case.material.youngs_modulus)).max(0.0).sqrt()
    }

    pub(super) fn layout(&self) -> Layout {
        Layout::of(&self.body.lattice, self.body.stencil.unknowns)
    }
}

/// Bonds that a new segment crosses, in the sense of its line, so that points on it stay on one side; beyond a rim, all
/// that is left of it.
fn across(body: &Body, segment: &Segment, at_last: bool) -> Vec<Bond> {
    let Segment { from, to, state, .. } = *segment;
    let beyond = if state == TipState::Active { 0.0 } else { body.lattice.spacing };
    let length = distance(from, to).max(f64::MIN_POSITIVE);
    let end = along(from, to, 1.0 + beyond / length);
    if at_last { bonds_across(body, from, end) } else { bonds_across(body, end, from) }
}
