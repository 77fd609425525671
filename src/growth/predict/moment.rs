//! A plate as it stood at a row of its run: its cracks as they had grown, and its stress there.

use super::Prediction;
use crate::case::{Case, Engine, initial_plate};
use crate::record::{CurvePoint, TipRecord};
use perilife_base::error::Result;
use perilife_nodes::field::Discretisation;
use perilife_nodes::solve::solve;
use perilife_nodes::stress_field::{Corner, stress_pieces};
use perilife_plate::specimen::{CrackLine, Specimen, TipSeed};
use perilife_points::crack_tip::TipState;

/// Share of the cycles at which the stress of a plate is shown: cracks are long then, and the plate is not yet about to part.
const SHOWN_AT: f64 = 0.9;

/// Stress and displacement of a plate at maximum load.
#[derive(Debug, Clone, PartialEq)]
pub struct StressField {
    /// Cycles; 0 of a plate before its first.
    pub cycles: f64,
    pub cracks: Vec<CrackLine>,
    /// Convex pieces of the plate that rims and cracks bound.
    pub pieces: Vec<Vec<Corner>>,
}

/// The stress of the plate late in its life, by nodes at the cracks that the run has made; `None` of a run without tips on a plate, and
/// where the plate did not stand still long enough to be looked at.
/// Errors: as [`solve`].
pub fn stress_field(case: &Case, prediction: &Prediction) -> Result<Option<StressField>> {
    if !matches!(case.engine(), Engine::Nodes | Engine::Points) {
        return Ok(None);
    }
    let (rows, life) = (rows_before_meeting(&prediction.curve), prediction.life_cycles());
    let Some(at) = rows.iter().rposition(|row| row.is_solved && row.cycles <= SHOWN_AT * life) else { return Ok(None) };
    let case = Case { specimen: grown(&case.specimen, &rows[..=at]), ..case.clone() };
    let pieces = pieces(&case, &initial_plate(&case)?)?;
    Ok(Some(StressField { cycles: rows[at].cycles, cracks: case.specimen.crack_lines(), pieces }))
}

fn pieces(case: &Case, plate: &Discretisation) -> Result<Vec<Vec<Corner>>> {
    let solution = solve(&case.specimen, plate, case.nodes().resolution.far, case.loading.maximum)?;
    let share = case.loading.share(solution.work, case.specimen.crack_length);
    Ok(stress_pieces(&case.specimen, plate, &solution.u, case.material.plane, share))
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
