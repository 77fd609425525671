//! Cracks driven by the stress intensity of their own tips, on any plate that can be parted, solved and read ([`CrackedPlate`]).
//!
//! Per cycle block one equilibrium; K_I and K_II of every tip by an interaction integral on a ring around it; direction by the largest
//! circumferential stress ([`steering`]); growth of every tip by its own rate `da/dN` over the same cycles (`step.rs`); the plate is
//! parted along every new piece of crack. A tip is a point of a continuous line, so that neither path nor rate know where points or
//! nodes are.
//!
//! A tip that meets another crack joins both: it is no tip any more, nor is the tip that it meets head-on, and the tips that are left
//! begin anew with the K that the joined crack gives them (`meeting.rs`).

pub mod ahead;
mod increment;
pub mod kink;
mod meeting;
mod run;
pub mod scales;
pub mod steering;
mod step;
pub mod tip;

pub use increment::Increment;
pub use run::CracksRun;

use std::sync::Arc;

use super::cross_check::EnergyBalance;
use super::end_of_life::{End, first_end};
use super::record::{CurvePoint, TipRecord};
use super::{CrackGrowth, Fields, SolverStatistics};
use crate::case::Case;
pub use meeting::Segment;
use perilife_base::error::{Result, input, input_missing};
use perilife_base::raster::PointGrid;
use perilife_laws::growth_law::{GrowthLaw, Walker};
use perilife_laws::paris::ParisLaw;
use perilife_plate::specimen::{CrackLine, LineEnd, Point};
use perilife_points::body::Body;
use scales::Scales;
use tip::{CracksState, Reading, Tip};

/// A plate with cracks as one engine sees it: what is left of physics once the cracks are lines.
pub trait CrackedPlate: Sized {
    /// What a run carries of it from increment to increment.
    type Saved;

    /// The whole plate of a case, with nothing of its cracks in it yet.
    /// Errors: spacing against plate or memory, cracks that cut the plate in two.
    fn build(case: &Case, cracks: &CracksState) -> Result<Self>;

    /// In what it drives its tips differently from other engines.
    fn scales(&self, case: &Case) -> Scales;

    /// Brings the plate with its initial cracks into equilibrium.
    /// Errors: no equilibrium, or nothing can be read at a tip.
    fn open(&mut self, case: &Case, cracks: &CracksState) -> Result<()>;

    /// Parts the plate along new segments of cracks, of which some have joined others or left the plate if `has_met`.
    fn part(&mut self, case: &Case, cracks: &CracksState, segments: &[Option<Segment>], has_met: bool) -> Parted;

    /// Finds the displacement in equilibrium with the maximum load.
    /// Errors: [`perilife_base::error::Error::LossOfStiffness`] where a part of the plate moves freely.
    fn solve(&mut self, case: &Case, cracks: &CracksState) -> Result<()>;

    /// Reads every active tip; `None` of the others.
    /// Errors: [`perilife_base::error::Error::Mechanics`] where nothing is known around a tip.
    fn read(&mut self, case: &Case, cracks: &CracksState) -> Result<Vec<Option<Reading>>>;

    /// K_I and K_II, Pa√m, of a tip from its reading, after it has turned; `gap` is that to a tip which it faces, m.
    fn factors_at_line(
        &mut self,
        _case: &Case,
        _cracks: &CracksState,
        _tip: usize,
        reading: &Reading,
        _gap: Option<f64>,
    ) -> [f64; 2] {
        reading.factors
    }

    /// Lets all tips forget how K has changed: cracks have met.
    fn forget_history(&mut self) {}

    /// Takes in that an increment is over.
    fn update(&mut self, _cracks: &CracksState) {}

    /// Unit vector in which a crack points at one of its ends.
    fn heading(&self, lines: &[CrackLine], end: LineEnd) -> Point {
        lines[end.line].direction(end.at_last)
    }

    /// Work of the loads that the last equilibrium was solved for, J.
    fn work(&self) -> f64;

    /// Whether flanks are in contact anywhere.
    fn is_in_contact(&self) -> bool;

    /// Share of the load of a pin by which its contact is off, at the most.
    fn contact_residual(&self) -> f64 {
        0.0
    }

    /// What the next increments depend on.
    fn save(&self) -> Self::Saved;

    /// Goes on from what was saved, in place of [`CrackedPlate::open`]; whether it is of this plate.
    fn restore(&mut self, saved: Self::Saved) -> bool;

    /// Builds the solver anew.
    fn rebuild(&mut self, _case: &Case, _cracks: &CracksState) -> Result<()> {
        Ok(())
    }

    /// The plate as points and bonds, where it is that.
    fn body(&self) -> Option<Arc<Body>> {
        None
    }

    /// The points of the files for ParaView; `None` of nodes where nobody wants these.
    fn grid(&self, case: &Case) -> Option<PointGrid>;

    /// Displacement and damage of these points.
    fn fields(&mut self, case: &Case, cracks: &CracksState) -> Result<Option<Fields>>;

    fn statistics(&self) -> SolverStatistics;

    /// What the user should know of it.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}

/// What parting a plate did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Parted {
    /// Whether it is in two loaded pieces.
    pub is_severed: bool,
    pub bonds: usize,
}

/// Growth of the cracks of a case by the K of their tips.
pub struct Cracks<'a, P: CrackedPlate> {
    case: &'a Case,
    law: Box<dyn GrowthLaw>,
    /// A known end of the run.
    end: Option<End>,
    scales: Scales,
    pub plate: P,
    pub state: CracksState,
    curve: Vec<CurvePoint>,
    /// Rows where the solver was last built.
    rows_at_rebuild: usize,
    warnings: Vec<String>,
}

impl<'a, P: CrackedPlate> Cracks<'a, P> {
    /// The plate with its initial cracks, before its first equilibrium ([`CrackGrowth::open`]).
    /// Errors: a specimen without sharp crack; as [`CrackedPlate::build`].
    pub fn start(case: &'a Case, law: Box<dyn GrowthLaw>) -> Result<Self> {
        let specimen = &case.specimen;
        let tip = |tip: usize| {
            let end = specimen.line_end(tip).ok_or_else(|| {
                let problem = "of this case need sharp cracks: the end of a slot has no stress intensity factor";
                input(
                    "specimen.cracks",
                    "the tips",
                    problem,
                    "start a crack in the slot, or use model.method = \"peridynamics\" with fatigue.driver = \"bond_strain\"",
                )
            })?;
            Ok(Tip::new(specimen, end))
        };
        let tips = (0..specimen.tips.len()).map(tip).collect::<Result<Vec<_>>>()?;
        if tips.is_empty() {
            let remedy = "give a crack with an end in the material";
            return Err(input_missing(specimen.crack_key(), "contains no crack that can grow", remedy));
        }
        let state =
            CracksState { lines: specimen.crack_lines(), tips, step: 0.0, balance: EnergyBalance::default(), step_error: 0.0 };
        let plate = P::build(case, &state)?;
        let scales = plate.scales(case);
        let (curve, warnings) = (Vec::new(), Vec::new());
        Ok(Cracks { case, law, end: first_end(case), scales, plate, state, curve, rows_at_rebuild: 0, warnings })
    }

    /// The fastest of the tips that grow.
    fn fastest(&self) -> Option<usize> {
        let growing = self.state.tips.iter().enumerate().filter(|(_, tip)| tip.is_growing());
        growing.max_by(|a, b| a.1.rate.total_cmp(&b.1.rate).then(b.0.cmp(&a.0))).map(|(index, _)| index)
    }

    /// Crack length in the convention of the specimen, m.
    fn crack_length(&self) -> f64 {
        self.state.crack_length(&self.case.specimen)
    }

    /// Work of the load of the cycle, J.
    fn work(&self) -> f64 {
        self.case.loading.share(self.plate.work(), self.crack_length()).powi(2) * self.plate.work()
    }

    /// Unit vector in which a tip grows `step` on, m.
    fn direction(&self, tip: &Tip, step: f64) -> Point {
        let heading = self.plate.heading(&self.state.lines, tip.end);
        tip.steering.direction([tip.growth, step], heading, &self.scales.steering, tip.smooth_in(self.scales.by_root))
    }

    /// da/dN of K_eq of a tip at maximum load, m/cycle.
    fn rate(&self, tip: &Tip) -> f64 {
        self.law.mean_rate(tip.equivalent(), self.case.loading.ratio, &tip.response)
    }
}

/// The tips of the initial cracks at maximum load.
#[derive(Debug, Clone)]
pub struct InitialTips {
    /// K and T, in the order of `Specimen::tips`.
    pub tips: Vec<TipRecord>,
    /// Whether the load presses flanks together anywhere.
    pub in_contact: bool,
    /// Share of the load of a pin by which its contact is off, at the most.
    pub contact_residual: f64,
    /// What the user should know of them.
    pub warnings: Vec<String>,
}

/// Reads the initial tips of a case: those of the first row of its prediction by K.
pub fn initial_tips<P: CrackedPlate>(case: &Case) -> Result<InitialTips> {
    Ok(initial_tips_on::<P>(case)?.0)
}

/// The same with the plate in equilibrium.
pub fn initial_tips_on<P: CrackedPlate>(case: &Case) -> Result<(InitialTips, P)> {
    let law = Walker { paris: ParisLaw { c: 1.0, m: 1.0 }, gamma: 1.0, threshold: 0.0 };
    let mut cracks = Cracks::<P>::start(case, Box::new(law))?;
    cracks.open()?;
    let (in_contact, contact_residual) = (cracks.plate.is_in_contact(), cracks.plate.contact_residual());
    let (tips, warnings) = (cracks.now().tips.to_vec(), cracks.warnings());
    Ok((InitialTips { tips, in_contact, contact_residual, warnings }, cracks.plate))
}
