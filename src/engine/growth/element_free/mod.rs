//! Cracks driven by the stress intensity of their tips on a plate of nodes ([`crate::element_free`]).
//!
//! As [`super::tip_field`], with what a plate without lattice allows: nodes are placed anew for every equilibrium, as fine as the room of
//! every tip asks for, so that a tip is read where it stands, kinks are resolved whatever their length, and nothing is extrapolated.

mod front;
mod increment;
mod run;
mod step;

pub use front::Front;
pub use run::FrontsState;

use super::CrackGrowth;
use super::cross_check::EnergyBalance;
use super::end_of_life::{End, first_end};
use super::record::{CurvePoint, TipRecord};
use crate::case::Case;
use crate::element_free::crack::Tip;
use crate::element_free::field::Discretisation;
use crate::element_free::resolution::ElementFreeSettings;
use crate::element_free::solve::Solution;
use crate::error::{Result, input};
use crate::fatigue::growth_law::{GrowthLaw, Walker};
use crate::fatigue::paris::ParisLaw;
use crate::specimen::{CrackLine, Point, Specimen};
use crate::williams::Elasticity;
use run::Fronts;

/// Growth on a plate of nodes.
pub struct ElementFree<'a> {
    case: &'a Case,
    law: Box<dyn GrowthLaw>,
    settings: ElementFreeSettings,
    elasticity: Elasticity,
    end: Option<End>,
    state: Fronts,
    /// Rate of the lead before the last increment, and its growth in that, where ln of the rate is smooth over both.
    past: Option<[f64; 2]>,
    plate: Option<(Discretisation, Solution)>,
    /// Work of the loads of the last equilibrium at the nominal load, J.
    work: f64,
    curve: Vec<CurvePoint>,
    solves: usize,
    nodes: usize,
    /// Rows at the last place where the run could be taken up.
    rows_at_checkpoint: usize,
    warnings: Vec<String>,
}

impl<'a> ElementFree<'a> {
    /// The plate with its initial cracks, before its first equilibrium.
    /// Errors: a specimen without sharp crack.
    pub fn start(case: &'a Case, law: Box<dyn GrowthLaw>) -> Result<Self> {
        let specimen = &case.specimen;
        let lines = specimen.crack_lines();
        let front = |tip: usize| {
            let end = specimen.line_end(tip).ok_or_else(|| {
                let problem = "needs sharp cracks: the end of a slot has no stress intensity factor";
                let remedy = "start a crack in the slot, or use model.method = \"peridynamics\"";
                input("model.method", "\"element_free_galerkin\"", problem, remedy)
            })?;
            let line = &lines[end.line];
            Ok(Front::new(end, line.length() / specimen.tips_of(line).max(1) as f64))
        };
        let fronts = (0..specimen.tips.len()).map(front).collect::<Result<Vec<_>>>()?;
        if fronts.is_empty() {
            return Err(input(
                "specimen.cracks",
                "[]",
                "holds no crack that could grow",
                "give a crack with an end in the material",
            ));
        }
        Ok(ElementFree {
            case,
            law,
            settings: case.model.element_free,
            elasticity: Elasticity::of(&case.material),
            end: first_end(case),
            state: Fronts { lines, fronts, step: 0.0, balance: EnergyBalance::default(), fineness: 1.0 },
            past: None,
            plate: None,
            work: 0.0,
            curve: Vec::new(),
            solves: 0,
            nodes: 0,
            rows_at_checkpoint: 0,
            warnings: Vec::new(),
        })
    }

    /// The fastest of the tips that grow.
    fn fastest(&self) -> Option<usize> {
        let growing = self.state.fronts.iter().enumerate().filter(|(_, front)| front.is_growing());
        growing.max_by(|a, b| a.1.rate.total_cmp(&b.1.rate).then(b.0.cmp(&a.0))).map(|(index, _)| index)
    }

    fn position(&self, front: &Front) -> Point {
        self.state.lines[front.end.line].end(front.end.at_last)
    }

    /// Work of the load of the cycle, J.
    fn load_work(&self) -> f64 {
        self.case.loading.share(self.work).powi(2) * self.work
    }

    /// Rate with which a tip has ended its last step: before it turns a corner.
    fn rate_behind(&self, front: &Front) -> f64 {
        self.law.rate(front.equivalent(), self.case.loading.ratio)
    }
}

/// The initial cracks of a specimen, and their tips as nodes see them; ends of slots are none.
pub fn initial_cracks(specimen: &Specimen) -> (Vec<CrackLine>, Vec<Tip>) {
    let lines = specimen.crack_lines();
    let ends = (0..specimen.tips.len()).filter_map(|tip| specimen.line_end(tip));
    let length = |line: &CrackLine| line.length() / specimen.tips_of(line).max(1) as f64;
    let tips = ends.map(|end| Tip { end, length: length(&lines[end.line]) }).collect();
    (lines, tips)
}

/// The nodes of a case with its initial cracks.
/// Errors: as [`ElementFree::start`]; too many cells.
pub fn initial_plate(case: &Case) -> Result<Discretisation> {
    let (lines, tips) = initial_cracks(&case.specimen);
    Discretisation::new(&case.specimen, Elasticity::of(&case.material), &lines, &tips, &case.model.element_free.resolution)
}

/// K and T of the initial tips of a case at maximum load, in the order of `Specimen::tips`, and what the user should know of them.
/// Errors: as [`ElementFree::start`]; flanks that are pressed together.
pub fn initial_tips(case: &Case) -> Result<(Vec<TipRecord>, Vec<String>)> {
    let law = Walker { paris: ParisLaw { c: 1.0, m: 1.0 }, gamma: 1.0, threshold: 0.0 };
    let mut growth = ElementFree::start(case, Box::new(law))?;
    growth.open()?;
    Ok((growth.now().tips.to_vec(), growth.warnings))
}
