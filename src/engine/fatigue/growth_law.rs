//! Growth laws over K: da/dN of a cycle between R K_max and K_max.

pub mod nasgro;
pub mod table;

use serde::Serialize;

use super::paris::ParisLaw;
use crate::units::{MM_PER_CYCLE, MPA_SQRT_M};
use nasgro::Nasgro;
use table::Table;

crate::kinds! {
    /// Which law of growth a case has.
    pub enum GrowthLawKind for "fatigue.growth_law" {
        BondLaw = "bond_law": "A and p of bonds, dλ/dN = -A ε^p: inline, or fitted",
        Paris = "paris": "da/dN = C ΔK^m (Paris and Erdogan 1963)",
        Walker = "walker": "da/dN = C (K_max (1-R)^γ)^m (Walker 1970)",
        Forman = "forman": "da/dN = C ΔK^m / ((1-R) K_c - ΔK) (Forman, Kearney and Engle 1967)",
        Nasgro = "nasgro": "crack closure, threshold and instability in one equation (Forman and Mettu 1992)",
        Table = "table": "da/dN over ΔK, and over R, as rows of a CSV file",
    }
}

crate::kinds! {
    /// What of a cycle from R K_max to K_max is ΔK in a table of rates where R is negative; at R >= 0 both are (1-R) K_max. Laws take its
    /// tensile part.
    pub enum RangeKind for "measured.delta_k" {
        Tensile = "tensile": "K_max: compression does not count (ASTM E647)",
        Full = "full": "(1-R) K_max, as many laboratories and NASGRO have it",
    }
}

/// ΔK at which metals are compared, Pa√m, and the rates that they have there, mm/cycle, with room on both sides.
const METALS: (f64, [f64; 2]) = (10.0 * MPA_SQRT_M, [1e-6, 1e-2]);
/// Exponent by which these rates are taken to another ΔK.
const METALS_EXPONENT: f64 = 3.0;
/// ΔK over that of [`METALS`] that are tried where a law has no rate there: below its threshold, above its K_c, beyond its table.
const ELSEWHERE: [f64; 7] = [1.0, 2.0, 0.5, 4.0, 0.25, 8.0, 0.125];

/// What is wrong with the rates of a law for a metal: a unit that slipped shows here. Asked at ΔK = 10 MPa√m and the stress ratio, or where
/// the law has rates nearest to it.
pub fn doubt(law: &dyn GrowthLaw, ratio: f64) -> Option<String> {
    let k_max = |delta_k: f64| delta_k / (1.0 - ratio.max(0.0));
    let rate_at = |delta_k: f64| {
        let rate = law.rate(k_max(delta_k), ratio) / MM_PER_CYCLE;
        (rate > 0.0 && rate.is_finite() && law.beyond(k_max(delta_k), ratio).is_none()).then_some((delta_k, rate))
    };
    let (delta_k, rate) = ELSEWHERE.iter().find_map(|factor| rate_at(factor * METALS.0))?;
    let [low, high] = METALS.1.map(|rate| rate * (delta_k / METALS.0).powf(METALS_EXPONENT));
    (!(low..=high).contains(&rate)).then(|| {
        format!(
            "the rate at ΔK = {:.0} MPa√m is {rate:.2e} mm/cycle, outside {low:.0e} to {high:.0e}, where metals lie: check the units of rate, \
             crack length, cycles, load and stress intensity (m/cycle is 1000 mm/cycle; C for ksi√in and in/cycle is to be multiplied by \
             25.4 / 1.0988^m)",
            delta_k / MPA_SQRT_M
        )
    })
}

/// How fast a crack grows at the stress intensity of its tip.
pub trait GrowthLaw: std::fmt::Debug + Send + Sync {
    /// da/dN, m/cycle, at K_max, Pa√m, and stress ratio R; 0 where the crack does not grow.
    fn rate(&self, k_max: f64, ratio: f64) -> f64;

    /// In words, why the law says nothing about this K; its rate is then that at the end of what it knows.
    fn beyond(&self, _k_max: f64, _ratio: f64) -> Option<String> {
        None
    }

    /// Whether a run ends in an error there.
    fn is_refused_beyond(&self) -> bool {
        false
    }
}

/// Laws that are no power of ΔK.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "growth_law", rename_all = "snake_case")]
pub enum FactorLaw {
    /// [`Forman`].
    Forman(Forman),
    /// [`Nasgro`].
    Nasgro(Nasgro),
    /// [`Table`].
    Table(Table),
}

impl FactorLaw {
    /// Which one it is.
    pub fn kind(&self) -> GrowthLawKind {
        match self {
            FactorLaw::Forman(_) => GrowthLawKind::Forman,
            FactorLaw::Nasgro(_) => GrowthLawKind::Nasgro,
            FactorLaw::Table(_) => GrowthLawKind::Table,
        }
    }

    /// K_max at which the law lets a crack grow without limit, Pa√m.
    pub fn toughness(&self) -> Option<f64> {
        match self {
            FactorLaw::Forman(law) => Some(law.k_c),
            FactorLaw::Nasgro(law) => Some(law.k_c),
            FactorLaw::Table(_) => None,
        }
    }

    /// In words, with its constants.
    pub fn in_words(&self) -> String {
        match self {
            FactorLaw::Forman(law) => format!("m = {}, K_c = {:.4} MPa√m", law.m, law.k_c / MPA_SQRT_M),
            FactorLaw::Nasgro(law) => format!("n = {}, K_c = {:.4} MPa√m", law.n, law.k_c / MPA_SQRT_M),
            FactorLaw::Table(table) => {
                let rows: usize = table.curves.iter().map(|curve| curve.rows.len()).sum();
                format!("{rows} rows at {} stress ratios", table.curves.len())
            }
        }
    }

    /// What is to be said of a table that names no stress ratio.
    pub fn unnamed_ratio_line(&self, ratio: f64) -> Option<String> {
        matches!(self, FactorLaw::Table(table) if !table.says_ratio).then(|| {
            format!(
                "the table of rates names no stress ratio: its rates are used at R = {ratio} as they are; name it in a column stress_ratio or \
                 by growth_table = {{ file = \"...\", stress_ratio = ... }}"
            )
        })
    }

    fn law(&self) -> &dyn GrowthLaw {
        match self {
            FactorLaw::Forman(law) => law,
            FactorLaw::Nasgro(law) => law,
            FactorLaw::Table(law) => law,
        }
    }
}

/// A law that is no power of ΔK, above a threshold of ΔK.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounded {
    /// The law.
    pub law: FactorLaw,
    /// ΔK below which nothing grows, Pa√m.
    pub threshold: f64,
}

impl GrowthLaw for Bounded {
    fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        if k_max * (1.0 - ratio.max(0.0)) <= self.threshold { 0.0 } else { self.law.law().rate(k_max, ratio) }
    }

    fn beyond(&self, k_max: f64, ratio: f64) -> Option<String> {
        let grows = k_max * (1.0 - ratio.max(0.0)) > self.threshold;
        self.law.law().beyond(k_max, ratio).filter(|_| grows)
    }

    fn is_refused_beyond(&self) -> bool {
        self.law.law().is_refused_beyond()
    }
}

/// `da/dN = C (K_max (1-R)^γ)^m` above a threshold of ΔK (Walker 1970, ASTM STP 462; γ = 1: Paris and Erdogan 1963); compression
/// does not count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walker {
    /// C and m at R = 0.
    pub paris: ParisLaw,
    /// γ.
    pub gamma: f64,
    /// ΔK below which nothing grows, Pa√m.
    pub threshold: f64,
}

impl GrowthLaw for Walker {
    fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        let range = 1.0 - ratio.max(0.0);
        if k_max * range <= self.threshold { 0.0 } else { self.paris.rate(k_max * range.powf(self.gamma)) }
    }
}

/// `da/dN = C ΔK^m / ((1-R) K_c - ΔK)`: Paris growth that becomes unstable at K_max = K_c (Forman, Kearney and Engle 1967, J. Basic
/// Eng. 89:459). Compression does not count.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Forman {
    /// C, m/cycle (MPa√m)^(1-m).
    pub c: f64,
    /// Exponent m.
    pub m: f64,
    /// K_c, Pa√m.
    pub k_c: f64,
}

impl GrowthLaw for Forman {
    fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        let range = 1.0 - ratio.max(0.0);
        let left = range * (self.k_c - k_max) / MPA_SQRT_M;
        if left <= 0.0 { f64::INFINITY } else { self.c * (range * k_max / MPA_SQRT_M).powf(self.m) / left }
    }
}
