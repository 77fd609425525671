//! Stress on the section a crack leaves, to be compared with the yield strength.

use std::f64::consts::PI;

use super::{Specimen, SpecimenKind, handbook};

impl Specimen {
    /// Stress on the remaining section at crack length `crack_length` (m, the specimen's convention) under `load` (gross
    /// stress, Pa, or pin force, N), in Pa; infinite once nothing remains, `None` for a `plate`.
    ///
    /// Tension kinds: mean stress `σ W / ligament` (bending of a single edge crack left out). C(T): the stress for which
    /// ASTM E647's size requirement `W - a ≥ (4/π) (K_max/σ_Y)²` becomes an equality, `K_max √(4 / (π (W - a)))`.
    #[must_use]
    pub fn net_section_stress(&self, crack_length: f64, load: f64) -> Option<f64> {
        let cracks = match self.kind {
            SpecimenKind::MiddleTension | SpecimenKind::DoubleEdgeTension => 2.0,
            SpecimenKind::SingleEdgeTension | SpecimenKind::CompactTension => 1.0,
            SpecimenKind::Plate => return None,
        };
        let ligament = self.width - cracks * crack_length;
        if ligament <= 0.0 {
            return Some(f64::INFINITY);
        }
        if self.kind == SpecimenKind::CompactTension {
            let k_max = handbook::handbook(self)?.k_i(crack_length, load);
            return Some(k_max * (4.0 / (PI * ligament)).sqrt());
        }
        Some(load * self.width / ligament)
    }
}
