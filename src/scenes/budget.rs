//! What a scene will take up: [`perilife_growth::case::budget`] for scenes.

use super::scene::{Scene, SceneLaw, SceneSolver};
use perilife_points::bond_law::SurfaceCorrection;
use perilife_points::budget::{Budget, PointPlate};

/// Bytes of a bond of a net, with its places in the lists of both ends. `perilife fracture` on a square of 100 mm with one slant crack under
/// traction with `duration_s`: 108 MB at 4e4 points, m = 3.015, and 259 MB at m = 6, of which lattice and rim take 61 and 77 MB.
const NET_BOND: f64 = 90.0;
/// The same under `correspondence`: 125 MB at 4e4 points, m = 3.015.
const CORRESPONDENCE_BOND: f64 = 120.0;

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
        plate.budget(correction, of_bond, model.solver == SceneSolver::Secant).with_files(self.output)
    }
}
