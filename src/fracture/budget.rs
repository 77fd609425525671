//! What a scene will take up: [`crate::case::budget`] for scenes.

use super::scene::{Procedure, Scene, SceneLaw, SceneSolver};
use crate::bond_law::SurfaceCorrection;
use crate::case::budget::effort::Effort;
use crate::case::budget::{Budget, PointPlate};

/// Bytes of a bond of a net, with its places in the lists of both ends. `perilife fracture` on a square of 100 mm with one slant crack under
/// traction with `duration_s`: 108 MB at 4e4 points, m = 3.015, and 259 MB at m = 6, of which lattice and rim take 61 and 77 MB.
const NET_BOND: f64 = 90.0;
/// The same under `correspondence`: 125 MB at 4e4 points, m = 3.015.
const CORRESPONDENCE_BOND: f64 = 120.0;

/// Own time step over m Δ √(ρ/E): 0.1636 and 0.3077 µs at 1 mm, m = 3.015 and 6.015, E = 190 GPa and ρ = 8000 kg/m³; 0.038 µs at 0.25 mm,
/// 65 GPa, 2235 kg/m³.
const STEP_SHARE: f64 = 0.265;
/// States of equilibrium in a load step: 199 in 100 steps of `q345_coarse`, 25 s at 2760 points.
const STATES: f64 = 2.0;

impl Scene {
    /// What it takes up, before anything is laid out.
    pub fn budget(&self) -> Budget {
        let model = &self.model;
        let plate = PointPlate {
            specimen: &self.specimen,
            spacing: model.spacing,
            horizon_ratio: model.horizon_ratio,
            lattice_angle: model.lattice_angle,
            refinement: self.refinement.as_ref(),
        };
        let (correction, of_bond) = match model.law {
            SceneLaw::Bonds(law) => (law.surface_correction, NET_BOND),
            SceneLaw::Correspondence { .. } => (SurfaceCorrection::None, CORRESPONDENCE_BOND),
        };
        // Static scenes: 241 MB at 1e4 points, m = 3.015; 145 MB at 2500 and m = 6.
        let mut budget = plate.budget(correction, of_bond, model.solver == SceneSolver::Secant);
        budget.effort = self.effort(&plate);
        budget
    }

    fn effort(&self, plate: &PointPlate<'_>) -> Effort {
        let (points, bonds) = (plate.points(), plate.bonds_of_point());
        let (equilibria, each) = match self.procedure {
            Procedure::Dynamic { duration, time_step } => {
                let own = self.material.density.map(|density| {
                    STEP_SHARE * self.model.horizon_ratio * plate.finest() * (density / self.material.youngs_modulus).sqrt()
                });
                let power = if time_step.is_some() { 0.0 } else { 1.0 };
                // Without mass there is no motion, which is said before it begins.
                let steps = time_step.or(own).map_or(0.0, |step| duration / step);
                return Effort {
                    other_keys: ", or a shorter loading.duration_s",
                    ..Effort::of_steps(steps, power, points, bonds)
                };
            }
            Procedure::Static => (1.0, None),
            Procedure::QuasiStatic { steps, iterations } => (steps as f64, iterations),
        };
        let effort = match (self.model.solver, each) {
            (_, Some(each)) => Effort::of_steps(equilibria * each as f64, 0.0, points, bonds),
            (SceneSolver::Secant, None) => Effort::of_factors(STATES * equilibria, points, bonds),
            (_, None) => Effort::of_relaxation(equilibria, points, bonds),
        };
        Effort { other_keys: ", or fewer loading.steps", ..effort }
    }
}
