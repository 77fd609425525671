//! What a scene will take up: [`crate::case::budget`] for scenes.

use super::scene::{Scene, SceneLaw, SceneSolver};
use crate::case::budget::{Budget, Curve, PointPlate};

/// Bytes of a point by horizon ratio.
const SPRINGS: &Curve = &[(3.015, 1.0), (6.0, 2.0)];

impl Scene {
    /// What it takes up, before anything is laid out.
    #[must_use]
    pub fn budget(&self) -> Budget {
        let model = &self.model;
        let plate = PointPlate {
            specimen: &self.specimen,
            spacing: model.spacing,
            horizon_ratio: model.horizon_ratio,
            lattice_angle: model.lattice_angle,
            refinement: self.refinement.as_ref(),
        };
        let of_point = match (model.solver, model.law) {
            (SceneSolver::Secant, _) => SPRINGS,
            (_, SceneLaw::Correspondence { .. }) => SPRINGS,
            _ => SPRINGS,
        };
        plate.budget(of_point)
    }
}
