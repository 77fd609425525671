//! Rates as a table.

use serde::Serialize;

use super::GrowthLaw;
use crate::units::MPA_SQRT_M;

/// Stress ratios that differ by less are one.
const SAME_RATIO: f64 = 0.02;

/// da/dN over ΔK at one or several stress ratios: straight lines between its rows over ln ΔK, and between two ratios over R, in
/// ln da/dN. One ratio R₀ alone holds at another by Walker's exponent (1970): its rate is that at `ΔK₀ = K_max (1-R)^γ (1-R₀)^(1-γ)`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// By rising ratio.
    pub curves: Vec<Curve>,
    /// Whether K beyond the ends takes the rate of the end; else it is refused.
    pub holds_ends: bool,
    /// Walker's exponent of a table of one ratio.
    pub walker_gamma: Option<f64>,
    /// Whether the file, or the user, says the ratio; one that nobody says is taken to hold for every R.
    pub says_ratio: bool,
}

/// Rates at one stress ratio.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Stress ratio R.
    pub ratio: f64,
    /// ΔK in Pa√m and da/dN in m/cycle, both rising.
    pub rows: Vec<[f64; 2]>,
}

impl Curve {
    /// ln da/dN at ΔK, Pa√m; beyond the ends that of the end.
    fn log_rate(&self, delta_k: f64) -> f64 {
        let next = self.rows.partition_point(|row| row[0] < delta_k);
        let [from, to] = [next.saturating_sub(1), next.min(self.rows.len() - 1)].map(|row| self.rows[row]);
        if from[0] == to[0] {
            return from[1].ln();
        }
        let share = (delta_k / from[0]).ln() / (to[0] / from[0]).ln();
        from[1].ln() + share * (to[1] / from[1]).ln()
    }

    fn ends(&self) -> [f64; 2] {
        [self.rows[0][0], self.rows[self.rows.len() - 1][0]]
    }
}

impl Table {
    /// The two curves around a ratio and how much of the second counts.
    fn around(&self, ratio: f64) -> (&Curve, &Curve, f64) {
        let next = self.curves.partition_point(|curve| curve.ratio < ratio);
        let [from, to] = [next.saturating_sub(1), next.min(self.curves.len() - 1)].map(|curve| &self.curves[curve]);
        let share = if from.ratio == to.ratio { 0.0 } else { (ratio - from.ratio) / (to.ratio - from.ratio) };
        (from, to, share)
    }

    /// Smallest and largest ΔK, Pa√m, that the table knows at a stress ratio.
    pub fn range(&self, ratio: f64) -> [f64; 2] {
        let (from, to, share) = self.around(ratio);
        let ends = if share == 0.0 { [from.ends(); 2] } else { [from.ends(), to.ends()] };
        [ends[0][0].max(ends[1][0]), ends[0][1].min(ends[1][1])]
    }

    /// Whether the table speaks about a stress ratio.
    pub fn knows(&self, ratio: f64) -> bool {
        let [first, last] = [&self.curves[0], &self.curves[self.curves.len() - 1]].map(|curve| curve.ratio);
        let takes_any = self.curves.len() == 1 && (self.walker_gamma.is_some() || !self.says_ratio);
        takes_any || (first - SAME_RATIO..=last + SAME_RATIO).contains(&ratio)
    }

    /// ΔK, Pa√m, at which the rows are read.
    fn delta_k(&self, k_max: f64, ratio: f64) -> f64 {
        let [own, of_table] = [ratio, self.curves[0].ratio].map(|ratio| 1.0 - ratio.max(0.0));
        match self.walker_gamma {
            Some(gamma) => k_max * own.powf(gamma) * of_table.powf(1.0 - gamma),
            None => k_max * own,
        }
    }
}

impl GrowthLaw for Table {
    fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        let delta_k = self.delta_k(k_max, ratio);
        if delta_k <= 0.0 {
            return 0.0;
        }
        let (from, to, share) = self.around(ratio);
        let [from, to] = [from, to].map(|curve| curve.log_rate(delta_k));
        (from + share * (to - from)).exp()
    }

    fn beyond(&self, k_max: f64, ratio: f64) -> Option<String> {
        let delta_k = self.delta_k(k_max, ratio);
        let [low, high] = self.range(ratio);
        let [at, low_mpa, high_mpa] = [delta_k, low, high].map(|k| k / MPA_SQRT_M);
        // Rows that are hit but for round-off.
        let is_beyond = delta_k > 0.0 && !(low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(&delta_k);
        is_beyond.then(|| format!("ΔK = {at:.4} MPa√m lies beyond the table of rates, {low_mpa:.4} to {high_mpa:.4} MPa√m"))
    }

    fn is_refused_beyond(&self) -> bool {
        !self.holds_ends
    }
}
