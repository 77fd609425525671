//! Growth laws over K: da/dN of a cycle between R K_max and K_max.

pub mod bonds;
pub mod description;
pub mod forman;
pub mod nasgro;
pub mod paris;
pub mod table;
pub mod walker;

use serde_json::Value;

use crate::response::Response;
use description::{GrowthLawSpec, Role};
use perilife_base::units::{MM_PER_CYCLE, MPA_SQRT_M};
use table::Table;
pub use walker::Walker;

/// Every law, in the order of `perilife list`; those that rates are fitted by stand in the order of their number of constants. A new one is
/// a line here and its file.
const LAWS: &[&GrowthLawSpec] = &[&bonds::LAW, &paris::LAW, &walker::LAW, &forman::LAW, &nasgro::LAW, &table::LAW];

perilife_base::kinds! {
    pub struct GrowthLawKind of GrowthLawSpec in LAWS for "fatigue.growth_law"
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
        let k = delta_k / MPA_SQRT_M;
        format!(
            "the rate at ΔK = {k:.0} MPa√m is {rate:.2e} mm/cycle, outside {low:.0e} to {high:.0e} mm/cycle, the range of metals: \
             check the units of rate, crack length, cycles, load and stress intensity (m/cycle is 1000 mm/cycle; C for ksi√in \
             and in/cycle must be multiplied by 25.4 / 1.0988^m)"
        )
    })
}

/// Cycles that act on a crack, all of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Acting {
    /// ΔK of ASTM E647, Pa√m.
    pub delta_k: f64,
    pub ratio: f64,
    /// Share of the growth that is by them.
    pub share: f64,
}

impl Acting {
    /// Cycles of this K_max, Pa√m, and stress ratio with their share of the growth.
    pub fn new(k_max: f64, ratio: f64, share: f64) -> Self {
        Acting { delta_k: k_max * (1.0 - ratio.max(0.0)), ratio, share }
    }
}

/// How fast a crack grows at the stress intensity of its tip.
pub trait GrowthLaw: std::fmt::Debug + Send + Sync {
    /// da/dN, m/cycle, at K_max, Pa√m, and stress ratio R; 0 where the crack does not grow.
    fn rate(&self, k_max: f64, ratio: f64) -> f64;

    /// Least stress ratio that it knows; where compression counts as nothing there is none.
    fn least_ratio(&self) -> f64 {
        f64::NEG_INFINITY
    }

    /// Mean of da/dN over the cycles of a load, m/cycle, of a tip whose K follows that load by `response`: K_max is that of the largest load,
    /// Pa√m, and R the ratio of that one. Ratios below the least count as that.
    fn mean_rate(&self, k_max: f64, ratio: f64, response: &Response) -> f64 {
        match response.ratio(ratio) {
            _ if response.is_proportional() => self.rate(k_max, ratio),
            ratio if ratio < 1.0 => self.rate(k_max, ratio.max(self.least_ratio())),
            // The load closes the crack.
            _ => 0.0,
        }
    }

    /// In words, why the law says nothing about this K; its rate is then that at the end of what it knows.
    fn beyond(&self, _k_max: f64, _ratio: f64) -> Option<String> {
        None
    }

    /// In words, that its rates are of other stress ratios than this one, and which are taken.
    fn beyond_ratio(&self, _ratio: f64) -> Option<String> {
        None
    }

    /// Whether a run ends in an error where K lies beyond.
    fn is_refused_beyond(&self) -> bool {
        false
    }

    /// The cycles that act, asked as [`GrowthLaw::mean_rate`]: of a spectrum all its sizes.
    fn acting(&self, k_max: f64, ratio: f64, response: &Response) -> Vec<Acting> {
        vec![Acting::new(k_max, response.ratio(ratio), 1.0)]
    }

    /// Share of the growth that is by cycles of which the law says nothing, asked as [`GrowthLaw::mean_rate`].
    fn share_beyond(&self, k_max: f64, ratio: f64, response: &Response) -> f64 {
        if self.beyond(k_max, response.ratio(ratio)).is_some() { 1.0 } else { 0.0 }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct FactorLaw {
    pub kind: GrowthLawKind,
    /// Its constants, SI, in the order of their description.
    pub constants: Vec<f64>,
    pub table: Option<Table>,
    /// ΔK below which nothing grows whatever the law says, Pa√m.
    pub threshold: f64,
}

impl FactorLaw {
    /// The law of these constants, SI.
    pub fn new(of: &'static GrowthLawSpec, constants: Vec<f64>) -> Self {
        FactorLaw { kind: GrowthLawKind(of), constants, table: None, threshold: 0.0 }
    }

    /// K_max at which it lets a crack grow without limit, Pa√m.
    pub fn toughness(&self) -> Option<f64> {
        self.kind.0.place(Role::Toughness).map(|place| self.constants[place]).filter(|k_c| k_c.is_finite())
    }

    /// ΔK at which its own rate is 0 at a stress ratio, Pa√m, where it has such a constant.
    pub fn own_threshold(&self, ratio: f64) -> Option<f64> {
        let threshold = self.kind.0.place(Role::Threshold).map(|_| (self.kind.0.threshold)(&self.constants, ratio));
        // One that a fit without the factor of the threshold has is none.
        threshold.filter(|delta_k| *delta_k > 1e-3 * MPA_SQRT_M)
    }

    pub fn in_words(&self) -> String {
        let k_c = self.toughness().map(|k_c| format!(", K_c = {:.4} MPa√m", k_c / MPA_SQRT_M)).unwrap_or_default();
        let of_formula = || format!("{} = {}{k_c}", self.kind.0.constants[1].name, self.constants[1]);
        self.table.as_ref().map_or_else(of_formula, Table::in_words)
    }

    /// `growth_law` and the constants as a result has them, SI.
    pub fn constants_si(&self) -> Value {
        let mut all = serde_json::json!({ "growth_law": self.kind });
        for (constant, &value) in self.kind.0.constants.iter().zip(&self.constants) {
            let before = all[constant.name].take();
            all[constant.name] = if before.is_null() { value.into() } else { serde_json::json!([value, before]) };
        }
        if let (Some(all), Ok(Value::Object(table))) = (all.as_object_mut(), serde_json::to_value(&self.table)) {
            all.extend(table);
        }
        all
    }
}

impl GrowthLaw for FactorLaw {
    fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        match &self.table {
            _ if k_max * (1.0 - ratio.max(0.0)) <= self.threshold => 0.0,
            Some(table) => table.rate(k_max, ratio),
            None => (self.kind.0.rate)(&self.constants, k_max, ratio),
        }
    }

    fn least_ratio(&self) -> f64 {
        let of_table = self.table.as_ref().map(|table| table.curves[0].ratio).filter(|ratio| *ratio < 0.0);
        of_table.or(self.kind.0.compression.map(|(_, least)| least)).unwrap_or(f64::NEG_INFINITY)
    }

    fn beyond(&self, k_max: f64, ratio: f64) -> Option<String> {
        let grows = k_max * (1.0 - ratio.max(0.0)) > self.threshold;
        self.table.as_ref().filter(|_| grows).and_then(|table| table.beyond(k_max, ratio))
    }

    fn beyond_ratio(&self, ratio: f64) -> Option<String> {
        self.table.as_ref().and_then(|table| table.beyond_ratio(ratio))
    }

    fn is_refused_beyond(&self) -> bool {
        self.table.as_ref().is_some_and(|table| !table.holds_ends)
    }
}
