//! Life of a bond under cycles: dλ/dN = -A ε^p (Silling and Askari 2014, SAND2014-18590).
//!
//! Knows: what each law says of itself (constants, ranges, how it is read and fitted), the direction of growth in mixed mode, retardation cycle by
//! cycle, S-N lines, the mean rate of a spectrum.
//! Must not know: how K is found, files of laboratories (a table of rates is handed to it), cases.
//!
//! Imports `base` and `plate`.

pub mod curve;
pub mod growth_law;
pub mod growth_rate;
pub mod initiation;
pub mod paris;
pub mod response;
pub mod retardation;
pub mod spectrum_law;

use perilife_base::error::{Error, input};
use perilife_plate::specimen::Specimen;

/// Critical stretch s_t where a case gives none: 5 %, which no plate bears within linear elasticity. It lets the last
/// ligament of a plate break by overload instead of hanging on bonds that no tip spends.
pub const OVERLOAD_STRETCH: f64 = 0.05;
/// Radius of the zone around a tip in which bonds lose remaining life, in horizons, where a case gives none: in a narrower zone fewer
/// bonds break beside the crack, see the growth law.
pub const ZONE_RADIUS_HORIZONS: f64 = 0.5;
/// `fatigue.step_error_percent` where a case gives none.
pub const STEP_ERROR_PERCENT: f64 = 0.2;

perilife_base::kinds! {
    /// What drives a crack of method `peridynamics`.
    pub enum Driver for "fatigue.driver" {
        TipField = "tip_field": "direction and rate of each tip from its K_I and K_II; bonds across the path are cut",
        BondStrain = "bond_strain": "each bond loses life by its own strain and the crack follows broken bonds; from a slot, until K of the tip takes over",
    }

    pub enum Ageing for "fatigue.ageing" {
        CrackTip = "crack_tip": "bonds within zone_radius_horizons × horizon of a crack tip",
        Everywhere = "everywhere": "all bonds",
    }
}

/// Exponents p of bonds for which a crack was seen to grow steadily, so that its rate is known (`rate_constant` of `growth`).
pub const STEADY_EXPONENTS: std::ops::RangeInclusive<f64> = 1.0..=8.0;

/// The error of an exponent outside [`STEADY_EXPONENTS`].
pub fn unsteady(key: &str, p: f64) -> Error {
    let (low, high) = (STEADY_EXPONENTS.start(), STEADY_EXPONENTS.end());
    let problem = format!("is outside {low} to {high}, the range in which the growth rate of bonds is calibrated");
    input(
        key,
        p,
        problem,
        "give paris_c_mm_per_cycle and paris_m, or driver = \"bond_strain\" (from slots with ageing = \"everywhere\")",
    )
}

/// Constants of the law and the horizon they belong to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FatigueLaw {
    /// A, 1/cycle (ε is dimensionless).
    pub a: f64,
    pub p: f64,
    /// Horizon δ that A belongs to, m.
    pub horizon: f64,
}

impl FatigueLaw {
    /// The same material's law at another horizon: `A₂ = A₁ (δ₂/δ₁)^((p-2)/2)`, so that the Paris constant stays
    /// (steady growth: `C = β A δ^(1-p/2) / E^p`).
    pub fn at_horizon(&self, horizon: f64) -> FatigueLaw {
        FatigueLaw { a: self.a * (horizon / self.horizon).powf((self.p - 2.0) / 2.0), p: self.p, horizon }
    }
}

/// What a case says about fatigue, except the constants of the law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FatigueSettings {
    pub driver: Driver,
    pub ageing: Ageing,
    /// Radius of the `crack_tip` zone in horizons.
    pub zone_radius_horizons: f64,
    /// Error of the cycles of a block that growth by K of the tips keeps to, percent.
    pub step_error_percent: f64,
    /// Bond stretch s_t above which a bond breaks at once.
    pub critical_stretch: f64,
    /// Walker exponent γ: ε = s_max (1-R)^γ; 1 = no mean-stress effect.
    pub walker_gamma: f64,
    /// Threshold of ΔK, Pa√m; 0 = none.
    pub threshold: f64,
    /// When the cracks of the case form; `None` where they are there at N = 0.
    pub initiation: Option<initiation::SnLaw>,
}

impl FatigueSettings {
    /// Whether bonds that age hand the cracks of a specimen over to the K of their tips: some begin at a slot, and tips are followed.
    pub fn hands_over(&self, specimen: &Specimen) -> bool {
        self.driver == Driver::BondStrain && self.ageing == Ageing::CrackTip && specimen.tips.iter().any(|tip| tip.from_slot)
    }
}
