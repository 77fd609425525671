//! What a crack leaves of the section: its ligament, when that yields throughout, and when it is too small for K to mean
//! anything.

use std::f64::consts::PI;

use super::{Load, LoadMeasure, Specimen, SpecimenKind};
use perilife_base::error::{Result, input};
use perilife_base::units::round_mm;

impl SpecimenKind {
    /// How many cracks, or halves of one, share the width of a standard kind, and the name of what each of them has; `None` for a `plate`
    /// and for cracks that do not go through.
    pub fn sharing(self) -> Option<(f64, &'static str)> {
        match self {
            SpecimenKind::MiddleTension | SpecimenKind::DoubleEdgeTension => Some((2.0, "half width")),
            SpecimenKind::SingleEdgeTension => Some((1.0, "width")),
            SpecimenKind::CompactTension => Some((1.0, "width from the load line")),
            _ => None,
        }
    }
}

impl Specimen {
    /// Largest crack length the specimen has room for, m, and its name.
    pub fn length_limit(&self) -> (f64, &'static str) {
        if let Some(flaw) = &self.part_through {
            return (flaw.room(), "ligament");
        }
        if let Some(formula) = &self.own_formula {
            return (formula.length_limit(), "width");
        }
        let size = (self.gross_width.max(self.length()), "size");
        self.kind.sharing().map_or(size, |(cracks, name)| (self.width / cracks, name))
    }

    /// Width of the remaining section at crack length `crack_length` (m, the specimen's convention), all ligaments together;
    /// `None` for a `plate`.
    pub fn ligament(&self, crack_length: f64) -> Option<f64> {
        self.kind.sharing().map(|(cracks, _)| self.width - cracks * crack_length)
    }

    /// Stress on the remaining section, Pa, when it yields throughout under `load` (gross stress, Pa, or pin force, N): the
    /// run is over once it reaches the yield strength. Infinite once nothing remains, `None` for a `plate`.
    ///
    /// `σ = P / (B b η)` with ligament b. η is the share of `σ_Y B b` that a rigid-plastic section bears in plane stress with
    /// +σ_Y beside the crack and -σ_Y at the far side, in equilibrium with the line of the load: 1 where the load passes
    /// through the middle of the ligaments (M(T), DE(T)) or where clamped ends take the bending;
    /// SE(T) `√(1+x²) - x` with x = a/b; C(T) `√(s²+1) - s` with s = 1 + 2a/b. Limit loads of Kumar, German and Shih 1981
    /// (EPRI NP-1931, sections 3.1 to 3.5) without their factor 1.07 of the von Mises criterion.
    pub fn net_section_stress(&self, crack_length: f64, load: f64) -> Option<f64> {
        let ligament = self.ligament(crack_length)?;
        if ligament <= 0.0 {
            return Some(f64::INFINITY);
        }
        // 1/η, written without the difference of two large numbers.
        let weakened_by = |arm: f64| (arm * arm + 1.0).sqrt() + arm;
        let factor = match self.kind {
            SpecimenKind::SingleEdgeTension if !self.has_straight_grips() => weakened_by(crack_length / ligament),
            SpecimenKind::CompactTension => weakened_by(1.0 + 2.0 * crack_length / ligament),
            // Pulled in line, or held so that they cannot turn.
            _ => 1.0,
        };
        Some(factor * self.force_per_thickness(load) / ligament)
    }

    /// Largest stress that a `plate` carries whatever its cracks: that on its edges, Pa; `None` under forces on points.
    pub fn gross_stress(&self, load: f64) -> Option<f64> {
        let pulled = self.loads.iter().any(|load| load.on_edge().is_some());
        let bent = self.loads.iter().filter_map(|load| match load {
            Load::Bent { tractions, .. } => Some(tractions.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max)),
            _ => None,
        });
        let most = bent.reduce(f64::max).unwrap_or(1.0);
        (pulled && self.load_measure == LoadMeasure::Stress).then_some(most * load)
    }

    /// Whether the ligament of a standard kind is large enough for K to describe the crack ([`Specimen::ligament_asked`]).
    pub fn small_scale_yielding(&self, crack_length: f64, load_max: f64, k_max: f64, yield_strength: f64) -> bool {
        self.ligament(crack_length).unwrap_or(self.width - crack_length) >= self.ligament_asked(load_max, k_max, yield_strength)
    }

    /// Ligament that is large enough for its plastic zone (ASTM E647, 7.2), m: of M(T) `W - 2a ≥ 1.25 P_max / (B σ_Y)`, that is 80 % of
    /// net-section yield; of C(T) and, by the same reasoning, edge cracks `b ≥ (4/π) (K_max/σ_Y)²`.
    pub fn ligament_asked(&self, load_max: f64, k_max: f64, yield_strength: f64) -> f64 {
        match self.kind {
            SpecimenKind::MiddleTension => 1.25 * self.force_per_thickness(load_max) / yield_strength,
            _ => ligament_needed(k_max, yield_strength),
        }
    }

    /// Force over thickness, N/m, of a nominal load.
    fn force_per_thickness(&self, load: f64) -> f64 {
        match self.load_measure {
            LoadMeasure::Stress => load * self.width,
            LoadMeasure::Force => load / self.thickness,
        }
    }
}

/// `(4/π) (K_max/σ_Y)²`, the ligament ASTM E647 asks for, m: four times the plastic zone of plane stress.
pub fn ligament_needed(k_max: f64, yield_strength: f64) -> f64 {
    4.0 / PI * (k_max / yield_strength).powi(2)
}

/// Refuses a crack that would leave no ligament: `crack_length` against the length at which the plate is in two, m.
pub(super) fn check_crack(crack_length: f64, limit: f64, limit_name: &str) -> Result<()> {
    if crack_length < limit * (1.0 - 1e-9) {
        return Ok(());
    }
    let problem = format!("must be below {limit_name} {} mm", round_mm(limit));
    Err(input("specimen.crack_length_mm", round_mm(crack_length), problem, "give a shorter crack or a wider plate"))
}
