//! Cracks driven by the stress intensity of their own tips.
//!
//! Per cycle block one equilibrium; K_I and K_II of every tip by the interaction integral on a ring around it
//! ([`crate::stress_intensity::ring`]); direction by the largest circumferential stress ([`steering`]); growth of every
//! tip by its own rate `da/dN` over the same cycles; every bond that a new piece of crack crosses is cut. A tip is a
//! point of a continuous line, so that neither path nor rate know the rows of points.
//!
//! A tip that meets another crack joins both: it is no tip any more, nor is the tip that it meets head-on, and the tips that are left
//! begin anew with the K that the joined crack gives them.

pub(in crate::growth) mod ahead;
mod contact;
mod factors;
mod increment;
pub mod kink;
mod readings;
mod run;
mod state;
pub mod steering;
pub(in crate::growth) mod step;

pub use state::{Tip, TipFieldState, TipsState};

use std::collections::HashSet;
use std::sync::Arc;

use super::CrackGrowth;
use super::cross_check::EnergyBalance;
use super::end_of_life::{End, first_end};
use super::record::{CurvePoint, TipRecord};
use super::tip_ring::DIRECTION_SPACINGS;
use crate::body::pre_crack::bonds_across;
use crate::body::{Body, Bond};
use crate::case::Case;
use crate::error::{Error, Result, input};
use crate::fatigue::growth_law::{GrowthLaw, Walker};
use crate::fatigue::paris::ParisLaw;
use crate::fatigue::pieces::{Connectivity, remove_fragments};
use crate::solver::Equilibrium;
use crate::specimen::geometry::direction;
use crate::specimen::{CrackLine, LineEnd, Point};
use crate::state::Bonds;
use crate::stress_intensity::ring::RingGeometry;
use contact::Contact;
use step::StepControl;

/// Length, in horizons, by which cracks are shorter at first, to see how K changes with it; a quarter of a crack at the most.
const PROBE_HORIZONS: f64 = 0.5;
/// Turn of a crack from which strains at its corner are not uniform, rad.
const CORNER: f64 = 0.35;
/// Distance between cracks that meet, m: round-off of their points.
const JOINED: f64 = 1e-9;

/// Growth by the field of every tip.
pub struct TipField<'a> {
    case: &'a Case,
    body: Arc<Body>,
    law: Box<dyn GrowthLaw>,
    surroundings: RingGeometry,
    steps: StepControl,
    /// A known end of the run.
    end: Option<End>,
    /// Bonds that the initial cracks cut over their last [`PROBE_HORIZONS`].
    at_tips: Vec<Bond>,
    /// Which bonds carry.
    pub bonds: Bonds,
    /// Cracks and tips.
    pub state: TipFieldState,
    equilibrium: Equilibrium,
    /// Where flanks are in contact.
    contact: Contact,
    /// In the layout of the equilibrium, m.
    displacement: Vec<f64>,
    solves: usize,
    iterations: usize,
    curve: Vec<CurvePoint>,
    /// Rows at the last time that the solver was built.
    rows_at_rebuild: usize,
    /// Corners and joints of the initial cracks, where strains are as little uniform as at a tip.
    corners: Vec<Point>,
    /// About the rings of the initial tips.
    warnings: Vec<String>,
}

impl<'a> TipField<'a> {
    /// The plate with its initial cracks, before its first equilibrium ([`CrackGrowth::open`]).
    /// Errors: as [`Body::build`]; a specimen without sharp crack, cracks that cut the plate in two.
    pub fn start(case: &'a Case, law: Box<dyn GrowthLaw>) -> Result<Self> {
        TipField::start_on(case, Arc::new(case.model.body(&case.specimen, &case.material)?), law)
    }

    /// The same on a plate that stands.
    /// Errors: a specimen without sharp crack, cracks that cut the plate in two.
    pub fn start_on(case: &'a Case, body: Arc<Body>, law: Box<dyn GrowthLaw>) -> Result<Self> {
        let specimen = &case.specimen;
        let tip = |tip: usize| {
            let end = specimen.line_end(tip).ok_or_else(|| {
                let problem = "needs sharp cracks: the end of a slot has no stress intensity factor";
                input("fatigue.driver", "\"tip_field\"", problem, "start a crack in the slot, or use driver = \"bond_strain\"")
            })?;
            Ok(Tip::new(specimen, end))
        };
        let tips = (0..specimen.tips.len()).map(tip).collect::<Result<Vec<_>>>()?;
        let steps = StepControl::new(case, body.horizon());
        let state = TipFieldState {
            lines: specimen.crack_lines(),
            tips,
            step: steps.first(),
            balance: EnergyBalance::default(),
            remaining_life: Vec::new(),
        };
        if remove_fragments(&body, &mut Bonds::new(&body), &body.pre_cut) == Connectivity::Severed {
            return Err(Error::Mechanics(format!("{}: the initial cracks cut the plate in two", case.name)));
        }
        let at_tips = bonds_at_tips(&body, &state);
        let mut bonds = Bonds::with_multipliers(&body, body.multiplier.clone());
        let cut: Vec<Bond> = body.pre_cut.iter().copied().filter(|bond| at_tips.binary_search(bond).is_err()).collect();
        cut.iter().for_each(|&bond| bonds.cut(&body, bond));
        remove_fragments(&body, &mut bonds, &cut);
        let surroundings = RingGeometry::new(&body, specimen, &case.material);
        let equilibrium = solver(case, &body, &bonds);
        let mut growth = TipField {
            case,
            law,
            surroundings,
            steps,
            end: first_end(case),
            at_tips,
            bonds,
            state,
            equilibrium,
            contact: Contact::default(),
            displacement: Vec::new(),
            solves: 0,
            iterations: 0,
            curve: Vec::new(),
            rows_at_rebuild: 0,
            corners: corners(&specimen.crack_lines()),
            warnings: Vec::new(),
            body,
        };
        growth.warnings = growth.ring_warnings();
        Ok(growth)
    }

    /// The fastest of the tips that grow.
    fn fastest(&self) -> Option<usize> {
        let growing = self.state.tips.iter().enumerate().filter(|(_, tip)| tip.is_growing());
        growing.max_by(|a, b| a.1.rate.total_cmp(&b.1.rate).then(b.0.cmp(&a.0))).map(|(index, _)| index)
    }

    /// Load of the cycle over that which the equilibrium is solved for.
    fn load_share(&self) -> f64 {
        self.case.loading.share(self.equilibrium.work())
    }

    /// Work of the load of the cycle, J.
    fn work(&self) -> f64 {
        self.load_share().powi(2) * self.equilibrium.work()
    }

    /// Pressure on the flanks at the maximum load, Pa.
    fn crack_pressure(&self) -> f64 {
        self.case.specimen.crack_pressure * self.case.loading.maximum
    }

    fn position(&self, tip: &Tip) -> Point {
        self.state.lines[tip.end.line].end(tip.end.at_last)
    }

    /// Unit vector in which the crack of a tip points.
    fn heading(&self, end: LineEnd) -> Point {
        heading(&self.body, &self.state.lines, end)
    }
}

/// Unit vector in which a crack points at one of its ends; pieces shorter than [`DIRECTION_SPACINGS`] do not show it.
fn heading(body: &Body, lines: &[CrackLine], end: LineEnd) -> Point {
    lines[end.line].blunted(end.at_last, DIRECTION_SPACINGS * body.lattice.spacing).direction(end.at_last)
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

/// The tips of the initial cracks at maximum load.
#[derive(Debug, Clone)]
pub struct InitialTips {
    /// K and T, in the order of `Specimen::tips`.
    pub tips: Vec<TipRecord>,
    /// Whether the load presses flanks together anywhere.
    pub in_contact: bool,
    /// What the user should know of them.
    pub warnings: Vec<String>,
}

/// Reads the initial tips of a case: those of the first row of its prediction by K.
pub fn initial_tips(case: &Case) -> Result<InitialTips> {
    let law = Walker { paris: ParisLaw { c: 1.0, m: 1.0 }, gamma: 1.0, threshold: 0.0 };
    let mut growth = TipField::start(case, Box::new(law))?;
    growth.open()?;
    let in_contact = growth.contact.closed_places().next().is_some();
    Ok(InitialTips { tips: growth.last().tips.clone(), in_contact, warnings: growth.warnings() })
}

/// Largest K_eq of the tips at maximum load, Pa√m, of the plate with its initial cracks cleanly cut; `None` where it cannot be read.
pub fn initial_factor(case: &Case) -> Option<f64> {
    let InitialTips { tips, .. } = initial_tips(case).ok()?;
    tips.iter().filter_map(|tip| tip.factors).map(steering::equivalent_factor).max_by(f64::total_cmp)
}

/// Bonds that the last [`PROBE_HORIZONS`] of the initial cracks cut, and nothing else of them, in ascending order.
fn bonds_at_tips(body: &Body, state: &TipFieldState) -> Vec<Bond> {
    let drawn_back = state.drawn_back(PROBE_HORIZONS * body.horizon());
    let across = |[a, b]: [Point; 2]| bonds_across(body, a, b);
    let kept: HashSet<Bond> = drawn_back.iter().flat_map(|line| line.pieces()).flat_map(across).collect();
    let last = state.tips.iter().map(|tip| {
        let [from, to] = [&drawn_back[tip.end.line], &state.lines[tip.end.line]].map(|line| line.end(tip.end.at_last));
        if tip.end.at_last { [from, to] } else { [to, from] }
    });
    let mut bonds: Vec<Bond> = last.flat_map(across).filter(|bond| !kept.contains(bond)).collect();
    bonds.sort_unstable();
    bonds.dedup();
    bonds
}

/// Solver of a run.
fn solver(case: &Case, body: &Body, bonds: &Bonds) -> Equilibrium {
    let model = &case.model;
    Equilibrium::new(model.solver, model.symmetry, body, bonds, case.loading.maximum).to_tolerance(model.residual)
}
