//! A plate as it stood at a row of its run: its cracks as they had grown, and its stress there.

use super::Prediction;
use crate::case::{Case, Engine, Model};
use crate::cracks::initial_tips_on;
use crate::nodes::NodePlate;
use crate::record::{CurvePoint, TipRecord};
use perilife_base::error::Result;
use perilife_nodes::resolution::ElementFreeSettings;
use perilife_nodes::stress_field::Corner;
use perilife_plate::specimen::{CrackLine, Specimen, TipSeed};
use perilife_points::crack_tip::TipState;

/// Share of the cycles at which the stress of a plate is shown: cracks are long then, and the plate is not yet about to part.
pub(super) const SHOWN_AT: f64 = 0.9;

/// Stress and displacement of a plate at maximum load.
#[derive(Debug, Clone, PartialEq)]
pub struct StressField {
    /// Cycles; 0 of a plate before its first.
    pub cycles: f64,
    pub cracks: Vec<CrackLine>,
    /// Convex pieces of the plate that rims and cracks bound.
    pub pieces: Vec<Vec<Corner>>,
}

/// A plate in equilibrium at a row of a run.
pub struct Moment {
    pub(super) cycles: f64,
    /// The case with the cracks of the row.
    pub(super) case: Case,
    pub(super) plate: NodePlate,
}

impl Moment {
    pub fn stress(&self) -> StressField {
        StressField { cycles: self.cycles, cracks: self.case.specimen.crack_lines(), pieces: self.plate.stress(&self.case) }
    }
}

/// The stress of the plate late in its life, by nodes at the cracks that the run has made; `None` of a run without tips on a plate, and
/// where the plate did not stand still long enough to be looked at.
/// Errors: no equilibrium.
pub fn stress_field(case: &Case, prediction: &Prediction) -> Result<Option<StressField>> {
    if !matches!(case.engine(), Engine::Nodes | Engine::Points) {
        return Ok(None);
    }
    let (rows, life) = (rows_before_meeting(&prediction.curve), prediction.life_cycles());
    let Some(at) = rows.iter().rposition(|row| row.is_solved && row.cycles <= SHOWN_AT * life) else { return Ok(None) };
    let nodes = ElementFreeSettings { is_final: true, ..case.nodes() };
    let mut case = Case { specimen: grown(&case.specimen, &rows[..=at]), model: Model::Nodes(nodes), ..case.clone() };
    case.loading.residual = None;
    let (_, plate) = initial_tips_on::<NodePlate>(&case)?;
    Ok(Some(Moment { cycles: rows[at].cycles, case, plate }.stress()))
}

/// The last row before which no tip has met anything.
pub(super) fn rows_before_meeting(curve: &[CurvePoint]) -> &[CurvePoint] {
    let has_met = |tip: &TipRecord| !matches!(tip.state, TipState::Active | TipState::Closed);
    let is_read = |row: &CurvePoint| row.tips.iter().all(|tip| !has_met(tip) && tip.factors.is_some());
    &curve[..curve.iter().position(|row| !is_read(row)).unwrap_or(curve.len())]
}

/// The specimen with its cracks as the rows have left them, the last one's tips as initial ones.
pub(super) fn grown(specimen: &Specimen, rows: &[CurvePoint]) -> Specimen {
    let mut lines = specimen.crack_lines();
    let mut after = specimen.clone();
    let Some(last) = rows.last() else { return after };
    for tip in 0..last.tips.len() {
        let Some(end) = specimen.line_end(tip) else { continue };
        let line = &mut lines[end.line];
        let mut grown = 0.0;
        for row in rows.iter().filter(|row| row.is_solved) {
            let TipRecord { growth, position, .. } = row.tips[tip];
            if growth > grown {
                line.grow(end.at_last, position);
                grown = growth;
            }
        }
        after.tips[tip] = TipSeed { position: line.end(end.at_last), direction: line.direction(end.at_last), from_slot: false };
    }
    after.crack_length = specimen.crack_length_after(&last.tips.iter().map(|tip| tip.growth).collect::<Vec<_>>());
    after.set_crack_lines(&lines);
    after
}
