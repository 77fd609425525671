//! The specimen that rates were read on: ΔK of every rate, and the validity that depends on the specimen (ASTM E647).

use crate::calibration::rates::RatePoint;
use crate::case::Case;
use crate::specimen::{LoadMeasure, SpecimenKind, net_section};

/// What ΔK and the validity of a rate depend on; SI.
pub struct TestPiece<'a> {
    /// Shape.
    pub kind: SpecimenKind,
    /// Width W of its test standard.
    pub width: f64,
    /// Thickness B.
    pub thickness: f64,
    /// Largest force of a cycle.
    pub force_max: f64,
    /// K_max over ΔK.
    pub k_max_over_range: f64,
    /// Stress ratio of the case.
    pub ratio: f64,
    /// Yield strength, where known.
    pub yield_strength: Option<f64>,
    /// ΔK at a crack length.
    pub delta_k: &'a dyn Fn(f64) -> f64,
}

impl<'a> TestPiece<'a> {
    /// The specimen of a case, with ΔK from `delta_k`.
    pub fn of(case: &Case, delta_k: &'a dyn Fn(f64) -> f64) -> Self {
        let specimen = &case.specimen;
        let force_per_load = match specimen.load_measure {
            LoadMeasure::Stress => specimen.width * specimen.thickness,
            LoadMeasure::Force => 1.0,
        };
        TestPiece {
            kind: specimen.kind,
            width: specimen.width,
            thickness: specimen.thickness,
            force_max: case.loading.maximum * force_per_load,
            k_max_over_range: 1.0 / case.loading.range_share(),
            ratio: case.loading.ratio,
            yield_strength: case.material.yield_strength,
            delta_k,
        }
    }
}

/// Largest difference between the crack lengths on the sides of a specimen that E647 accepts, m: 0.025 W of a central crack or two
/// edge cracks, 0.25 B of one edge crack.
pub fn side_difference_max(kind: SpecimenKind, width: f64, thickness: f64) -> f64 {
    let limit = match kind {
        SpecimenKind::MiddleTension | SpecimenKind::DoubleEdgeTension => 0.025 * width,
        _ => 0.25 * thickness,
    };
    // Lengths of 12.8 and 11.2 mm differ by 1.6 mm and a rounding.
    limit * (1.0 + 1e-9)
}

/// Fills in ΔK and the flags that depend on the specimen.
pub fn add_delta_k(points: &mut [RatePoint], piece: &TestPiece<'_>) {
    for point in points {
        point.delta_k = (piece.delta_k)(point.crack_length) * point.load_factor;
        point.ratio = if point.ratio.is_nan() { piece.ratio } else { point.ratio };
        let k_max = point.delta_k * piece.k_max_over_range;
        point.flags.yielding = !piece.small_scale_yielding(point.crack_length, k_max, point.load_factor);
        point.flags.uneven_front = point.side_difference > side_difference_max(piece.kind, piece.width, piece.thickness);
    }
}

impl TestPiece<'_> {
    /// Whether the ligament is large enough, see [`net_section::small_scale_yielding`]. True where the yield strength is not
    /// known.
    pub fn small_scale_yielding(&self, crack_length: f64, k_max: f64, load_factor: f64) -> bool {
        let Some(yield_strength) = self.yield_strength else { return true };
        let force = self.force_max * load_factor / self.thickness;
        net_section::small_scale_yielding(self.kind, self.width, crack_length, force, k_max, yield_strength)
    }
}
