//! A plate of points and bonds with cracks: bonds that a crack crosses are cut, K is read off rings around its tips.

mod contact;
mod factors;
mod readings;
pub(crate) mod ring;
mod settle;

use std::collections::HashSet;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::cracks::scales::Scales;
use super::cracks::steering::equivalent_factor;
use super::cracks::tip::{CracksState, Reading, Tip};
use super::cracks::{CrackedPlate, Cracks, Parted, Segment, initial_tips};
use super::{Fields, SolverStatistics, plate};
use crate::case::Case;
use contact::{ClosedPlace, Contact};
use perilife_base::error::{Error, Result};
use perilife_base::raster::PointGrid;
use perilife_laws::ZONE_RADIUS_HORIZONS;
use perilife_plate::specimen::geometry::{along, direction, distance, meeting_share};
use perilife_plate::specimen::{CrackLine, LineEnd, Load, Point};
use perilife_points::body::balanced::flanks::{self, FlankRange};
use perilife_points::body::pre_crack::bonds_across;
use perilife_points::body::{Body, Bond};
use perilife_points::bond_law::SurfaceCorrection;
use perilife_points::crack_tip::TipState;
use perilife_points::pieces::{Connectivity, remove_fragments};
use perilife_points::solver::field::Layout;
use perilife_points::solver::{Equilibrium, Symmetry};
use perilife_points::state::Bonds;
use perilife_points::stress_intensity::ring::RingGeometry;
use readings::Memory;
use ring::DIRECTION_SPACINGS;
use settle::LowerLoad;

/// Length, in horizons, by which cracks are shorter at first, to see how K changes with it; a quarter of a crack at the most.
const PROBE_HORIZONS: f64 = 0.5;
/// Turn of a crack from which strains at its corner are not uniform, rad.
const CORNER: f64 = 0.35;
/// Distance between cracks that meet, m: round-off of their points.
const JOINED: f64 = 1e-9;
pub struct PointPlate {
    body: Arc<Body>,
    surroundings: RingGeometry,
    /// Bonds that the initial cracks cut over their last [`PROBE_HORIZONS`].
    at_tips: Vec<Bond>,
    /// Corners and joints of the initial cracks, where strains are as little uniform as at a tip.
    corners: Vec<Point>,
    /// About the rings of the initial tips.
    warnings: Vec<String>,
    pub bonds: Bonds,
    /// Those that changed since the last equilibrium.
    changed: Vec<Bond>,
    equilibrium: Equilibrium,
    contact: Contact,
    /// In the layout of the equilibrium, m.
    displacement: Vec<f64>,
    /// Loads over the largest, below it, that are asked for where K does not follow the load in proportion, and the plate under them.
    lower_loads: Vec<f64>,
    lower: Vec<LowerLoad>,
    /// Work of the loads of the last equilibrium, J.
    work: f64,
    memory: Vec<Memory>,
    /// Remaining life λ of bonds that have spent some of it, ascending.
    remaining_life: Vec<(Bond, f64)>,
    solves: usize,
    iterations: usize,
}

/// What is said of pins with clearance.
const PINS: &str =
    "pins: contact is that of the largest load, ΔK is too large (conservative); use model.method = \"element_free_galerkin\"";
/// Growth by the field of every tip on points.
pub type TipField<'a> = Cracks<'a, PointPlate>;

/// What a run carries of its plate of points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointState {
    broken: Vec<Bond>,
    /// Bonds beside flanks, and their multipliers.
    scaled: Vec<(Bond, f32)>,
    /// Places of the cracks whose flanks are in contact.
    closed: Vec<ClosedPlace>,
    displacement: Vec<f64>,
    memory: Vec<Memory>,
    remaining_life: Vec<(Bond, f64)>,
    statistics: SolverStatistics,
}

impl PointPlate {
    /// Bonds beside the flanks of the cracks that are cut; gives those that changed.
    fn correct_flanks(&mut self, case: &Case, cracks: &CracksState, lines: &[CrackLine], range: FlankRange) -> Vec<Bond> {
        if case.points().bond_law.surface_correction != SurfaceCorrection::Balanced {
            return Vec::new();
        }
        let end = |tip: &Tip| lines[tip.end.line].end(tip.end.at_last);
        let ends: Vec<Point> = cracks.tips.iter().map(end).collect();
        let tips: Vec<Point> = cracks.active().map(|(_, tip)| end(tip)).chain(self.corners.iter().copied()).collect();
        let body = &self.body;
        let changed = flanks::multipliers(body, &self.bonds.multiplier, lines, &tips, &ends, range);
        changed.iter().for_each(|&(bond, multiplier)| self.bonds.set(body, bond, multiplier));
        changed.into_iter().map(|(bond, _)| bond).collect()
    }

    /// Cracks whose ends are as long as they have to be to show a direction.
    fn blunted(&self, cracks: &CracksState, lines: &[CrackLine]) -> Vec<CrackLine> {
        let mut blunted = lines.to_vec();
        for Tip { end, .. } in &cracks.tips {
            let line = &mut blunted[end.line];
            *line = line.blunted(end.at_last, DIRECTION_SPACINGS * self.body.lattice.spacing);
        }
        blunted
    }

    fn layout(&self) -> Layout {
        Layout::of(&self.body.lattice, self.body.stencil.unknowns)
    }
}

impl CrackedPlate for PointPlate {
    type Saved = PointState;

    fn build(case: &Case, cracks: &CracksState) -> Result<Self> {
        let body = Arc::new(case.points().body(&case.specimen, &case.material)?);
        if remove_fragments(&body, &mut Bonds::new(&body), &body.pre_cut) == Connectivity::Severed {
            return Err(Error::Mechanics(format!("{}: the initial cracks cut the plate in two", case.name)));
        }
        let at_tips = bonds_at_tips(&body, cracks);
        let mut bonds = Bonds::with_multipliers(&body, body.multiplier.clone());
        let cut: Vec<Bond> = body.pre_cut.iter().copied().filter(|bond| at_tips.binary_search(bond).is_err()).collect();
        cut.iter().for_each(|&bond| bonds.cut(&body, bond));
        remove_fragments(&body, &mut bonds, &cut);
        let mut plate = PointPlate {
            surroundings: RingGeometry::new(&body, &case.specimen, &case.material),
            at_tips,
            corners: corners(&cracks.lines),
            warnings: Vec::new(),
            changed: Vec::new(),
            equilibrium: solver(case, &body, &bonds),
            bonds,
            contact: Contact::default(),
            displacement: Vec::new(),
            lower_loads: case.loading.lower_loads().0,
            lower: Vec::new(),
            work: 0.0,
            memory: vec![Memory::default(); cracks.tips.len()],
            remaining_life: Vec::new(),
            solves: 0,
            iterations: 0,
            body,
        };
        plate.warnings = plate.ring_warnings(case, cracks);
        if case.loading.ratios()[1] > 0.0 && case.specimen.loads.iter().any(Load::is_elastic_pin) {
            plate.warnings.push(PINS.to_owned());
        }
        Ok(plate)
    }

    fn scales(&self, case: &Case) -> Scales {
        Scales::of_points(case, self.body.horizon(), self.body.lattice.spacing)
    }

    fn open(&mut self, case: &Case, cracks: &CracksState) -> Result<()> {
        // What is read belongs to a length that differs from the one asked for by part of a spacing: that takes the slope of K.
        let back = drawn_back(cracks, PROBE_HORIZONS * self.body.horizon());
        self.changed = self.correct_flanks(case, cracks, &back, FlankRange::All);
        self.settle(case, cracks, &back)?;
        self.read_slopes(case, cracks, &back);
        let mut cut = std::mem::take(&mut self.at_tips);
        cut.iter().for_each(|&bond| self.bonds.cut(&self.body, bond));
        remove_fragments(&self.body, &mut self.bonds, &cut);
        cut.extend(self.correct_flanks(case, cracks, &cracks.lines, FlankRange::All));
        self.changed = cut;
        self.solve(case, cracks)
    }

    fn part(&mut self, case: &Case, cracks: &CracksState, segments: &[Option<Segment>], has_met: bool) -> Parted {
        let body = &self.body.clone();
        let of_tip = |(tip, segment): (&Tip, &Option<Segment>)| Some(across(body, segment.as_ref()?, tip.end.at_last));
        let tips = cracks.tips.iter().zip(segments);
        let mut cut: Vec<Bond> = tips.filter_map(of_tip).flatten().filter(|&bond| self.bonds.is_intact(bond)).collect();
        cut.sort_unstable();
        cut.dedup();
        cut.iter().for_each(|&bond| self.bonds.cut(body, bond));
        let is_severed = match remove_fragments(body, &mut self.bonds, &cut) {
            Connectivity::Severed => true,
            Connectivity::Connected(fragments) => {
                cut.extend(fragments);
                false
            }
        };
        let parted = Parted { is_severed, bonds: cut.len() };
        if !is_severed {
            let range = if has_met { FlankRange::All } else { FlankRange::Tips };
            cut.extend(self.correct_flanks(case, cracks, &cracks.lines, range));
        }
        self.changed = cut;
        parted
    }

    fn solve(&mut self, case: &Case, cracks: &CracksState) -> Result<()> {
        self.settle(case, cracks, &cracks.lines)
    }

    fn read(&mut self, case: &Case, cracks: &CracksState) -> Result<Vec<Option<Reading>>> {
        let (readings, sliding) = self.read_rings(case, cracks, &cracks.lines);
        self.memory.iter_mut().zip(sliding).for_each(|(memory, sliding)| memory.sliding = sliding);
        Ok(readings)
    }

    fn factors_at_line(
        &mut self,
        case: &Case,
        cracks: &CracksState,
        tip: usize,
        reading: &Reading,
        gap: Option<f64>,
    ) -> [f64; 2] {
        self.at_line(case, cracks, tip, reading, gap)
    }

    fn forget_history(&mut self) {
        self.memory.fill(Memory::default());
    }

    fn update(&mut self, cracks: &CracksState) {
        self.update_remaining_life(cracks);
    }

    fn heading(&self, lines: &[CrackLine], end: LineEnd) -> Point {
        heading(&self.body, lines, end)
    }

    fn work(&self) -> f64 {
        self.work
    }

    fn is_in_contact(&self) -> bool {
        self.contact.closed_places().next().is_some()
    }

    fn save(&self) -> PointState {
        PointState {
            broken: self.bonds.broken(&self.body),
            scaled: self.bonds.scaled(&self.body),
            closed: self.contact.closed_places().collect(),
            displacement: self.displacement.clone(),
            memory: self.memory.clone(),
            remaining_life: self.remaining_life.clone(),
            statistics: self.statistics(),
        }
    }

    fn restore(&mut self, saved: PointState) -> bool {
        let PointState { broken, scaled, closed, displacement, memory, remaining_life, statistics } = saved;
        let beside_flanks = scaled.iter().map(|(bond, _)| bond);
        let mut all = broken.iter().chain(beside_flanks).chain(remaining_life.iter().map(|(bond, _)| bond)).copied();
        if memory.len() != self.memory.len() || !all.all(|bond| (bond as usize) < self.body.multiplier.len()) {
            return false;
        }
        broken.iter().chain(&self.at_tips).for_each(|&bond| self.bonds.cut(&self.body, bond));
        scaled.iter().for_each(|&(bond, multiplier)| self.bonds.set(&self.body, bond, multiplier));
        self.contact = Contact::resumed(closed);
        (self.displacement, self.memory, self.remaining_life) = (displacement, memory, remaining_life);
        (self.solves, self.iterations) = (statistics.solves, statistics.iterations);
        true
    }

    fn rebuild(&mut self, case: &Case, cracks: &CracksState) -> Result<()> {
        self.equilibrium = solver(case, &self.body, &self.bonds);
        self.solve(case, cracks)
    }

    fn body(&self) -> Option<Arc<Body>> {
        Some(self.body.clone())
    }

    fn grid(&self, _case: &Case) -> Option<PointGrid> {
        Some(self.body.grid())
    }

    fn fields(&mut self, case: &Case, cracks: &CracksState) -> Result<Option<Fields>> {
        let share = case.loading.share(self.work(), cracks.crack_length(&case.specimen));
        let displacement: Vec<f64> = self.displacement.iter().map(|u| share * u).collect();
        Ok(Some(plate::fields(&self.body, &self.bonds, &displacement, &self.remaining_life)))
    }

    fn statistics(&self) -> SolverStatistics {
        SolverStatistics {
            points_solved: self.equilibrium.points(&self.body),
            solves: self.solves,
            iterations: self.iterations,
            refined: [0; 2],
            step_error: 0.0,
            solver: Some(self.equilibrium.used()),
        }
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}

impl PointPlate {
    /// Lets the bonds ahead of all active tips lose remaining life λ up to where the tips are now; broken bonds are left out.
    ///
    /// The law of a bond, `dλ/dN = -A ε^p`, makes a tip grow steadily at `da/dN = β A δ^(1-p/2) (K_eq/E')^p`
    /// ([`crate::rate_constant`]): on the length ℓ of the fatigue zone ahead of the tip a bond that the line crosses loses its whole
    /// remaining life. Here the rate is known from K, so that these bonds lose it at `dλ/dN = -(da/dN)/ℓ`: λ is 1 where the line crosses
    /// them ℓ ahead of the tip and falls linearly to 0 at the tip. Remaining life never rises: bonds beside a crack that has turned away
    /// keep what they have left.
    fn update_remaining_life(&mut self, cracks: &CracksState) {
        let body = &self.body;
        let length = ZONE_RADIUS_HORIZONS * body.horizon();
        let ahead = |(_, tip): (usize, &Tip)| {
            let (from, [x, y]) = (cracks.position(tip), heading(body, &cracks.lines, tip.end));
            let to = [from[0] + length * x, from[1] + length * y];
            let life = move |bond: Bond| {
                let (_, a, b) = body.ends(bond);
                let fraction = meeting_share(from, to, body.lattice.position(a), body.lattice.position(b))?;
                Some((bond, fraction.clamp(0.0, 1.0)))
            };
            bonds_across(body, from, to).into_iter().filter_map(life).collect::<Vec<_>>()
        };
        let mut lives: Vec<(Bond, f64)> = self.remaining_life.iter().copied().chain(cracks.active().flat_map(ahead)).collect();
        lives.retain(|&(bond, _)| self.bonds.is_intact(bond));
        // Of equal bonds the least life comes first and stays.
        lives.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        lives.dedup_by_key(|(bond, _)| *bond);
        self.remaining_life = lives;
    }
}

/// Unit vector in which a crack points at one of its ends; pieces shorter than [`DIRECTION_SPACINGS`] do not show it.
fn heading(body: &Body, lines: &[CrackLine], end: LineEnd) -> Point {
    lines[end.line].blunted(end.at_last, DIRECTION_SPACINGS * body.lattice.spacing).direction(end.at_last)
}

/// The cracks, shorter by `back`, m, at every tip, by a quarter at the most.
fn drawn_back(cracks: &CracksState, back: f64) -> Vec<CrackLine> {
    let mut lines = cracks.lines.clone();
    cracks.tips.iter().for_each(|tip| {
        let line = &cracks.lines[tip.end.line];
        lines[tip.end.line].stretch(tip.end.at_last, -back.min(0.25 * line.length()));
    });
    lines
}

/// Places where cracks turn by more than [`CORNER`] or meet.
fn corners(lines: &[CrackLine]) -> Vec<Point> {
    let turns = |corner: &&[Point]| {
        let [[x, y], [to_x, to_y]] = [direction(corner[0], corner[1]), direction(corner[1], corner[2])];
        x * to_x + y * to_y < CORNER.cos()
    };
    let bends = lines.iter().flat_map(|line| line.points.windows(3).filter(turns).map(|corner| corner[1]));
    let ends = lines.iter().enumerate().flat_map(|(index, line)| [true, false].map(|at_last| (index, line.end(at_last))));
    let is_met = |&(index, at): &(usize, Point)| {
        lines.iter().enumerate().any(|(other, line)| other != index && line.distance(at) < JOINED)
    };
    bends.chain(ends.filter(is_met).map(|(_, at)| at)).collect()
}

/// Bonds that the last [`PROBE_HORIZONS`] of the initial cracks cut, and nothing else of them, in ascending order.
fn bonds_at_tips(body: &Body, cracks: &CracksState) -> Vec<Bond> {
    let drawn_back = drawn_back(cracks, PROBE_HORIZONS * body.horizon());
    let across = |[a, b]: [Point; 2]| bonds_across(body, a, b);
    let kept: HashSet<Bond> = drawn_back.iter().flat_map(|line| line.pieces()).flat_map(across).collect();
    let last = cracks.tips.iter().map(|tip| {
        let [from, to] = [&drawn_back[tip.end.line], &cracks.lines[tip.end.line]].map(|line| line.end(tip.end.at_last));
        if tip.end.at_last { [from, to] } else { [to, from] }
    });
    let mut bonds: Vec<Bond> = last.flat_map(across).filter(|bond| !kept.contains(bond)).collect();
    bonds.sort_unstable();
    bonds.dedup();
    bonds
}

/// Bonds that a new segment crosses, in the sense of its line; beyond an edge, all that is left of it.
fn across(body: &Body, segment: &Segment, at_last: bool) -> Vec<Bond> {
    let Segment { from, to, state, .. } = *segment;
    let beyond = if state == TipState::Active { 0.0 } else { body.lattice.spacing };
    let length = distance(from, to).max(f64::MIN_POSITIVE);
    let end = along(from, to, 1.0 + beyond / length);
    if at_last { bonds_across(body, from, end) } else { bonds_across(body, end, from) }
}

fn solver(case: &Case, body: &Body, bonds: &Bonds) -> Equilibrium {
    let points = case.points();
    // A residual stress need not be its own mirror image.
    let symmetry = if case.loading.residual.is_some() { Symmetry::Off } else { points.symmetry };
    Equilibrium::new(points.solver, symmetry, body, bonds, case.loading.maximum).to_tolerance(points.residual)
}

/// Largest K_eq of the tips at maximum load, Pa√m, of the plate with its initial cracks cleanly cut; `None` where it cannot be read.
pub fn initial_factor(case: &Case) -> Option<f64> {
    let tips = initial_tips::<PointPlate>(case).ok()?.tips;
    tips.iter().filter_map(|tip| tip.factors).map(equivalent_factor).max_by(f64::total_cmp)
}
