//! Rates as a table.

use serde::Serialize;

use super::FactorLaw;
use super::description::{Description, GAMMA, Given, RatedRow, Rates, UNSAID};
use perilife_base::error::{Error, InputError, Result, input, input_missing};
use perilife_base::units::{MM_PER_CYCLE, MPA_SQRT_M, round_off};

/// What it says of itself.
pub static LAW: Description = Description {
    name: "table",
    meaning: "da/dN over ΔK, and over R, as rows of a CSV file",
    constants: &[GAMMA],
    others: &["growth_table", "growth_table_ends"],
    read: Some(|given, law| Ok(FactorLaw { table: Some(read(given)?), ..FactorLaw::new(law, Vec::new()) })),
    ..UNSAID
};

perilife_base::kinds! {
    /// What K beyond the rows of a table of rates does.
    pub enum TableEnds for "fatigue.growth_table_ends" {
        Refused = "refused": "the run ends in an error",
        Held = "held": "the crack grows at the rate of the last row; how much of the life that is stands in a warning",
    }
}

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

    /// da/dN, m/cycle, at K_max, Pa√m; beyond the ends that of the end.
    pub fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        let delta_k = self.delta_k(k_max, ratio);
        if delta_k <= 0.0 {
            return 0.0;
        }
        let (from, to, share) = self.around(ratio);
        let [from, to] = [from, to].map(|curve| curve.log_rate(delta_k));
        (from + share * (to - from)).exp()
    }

    /// In words, that K lies beyond the rows.
    pub fn beyond(&self, k_max: f64, ratio: f64) -> Option<String> {
        let delta_k = self.delta_k(k_max, ratio);
        let [low, high] = self.range(ratio);
        let [at, low_mpa, high_mpa] = [delta_k, low, high].map(|k| k / MPA_SQRT_M);
        // Rows that are hit but for round-off.
        let is_beyond = delta_k > 0.0 && !(low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(&delta_k);
        is_beyond.then(|| format!("ΔK = {at:.4} MPa√m lies beyond the table of rates, {low_mpa:.4} to {high_mpa:.4} MPa√m"))
    }

    /// In words.
    pub fn in_words(&self) -> String {
        let rows: usize = self.curves.iter().map(|curve| curve.rows.len()).sum();
        format!("{rows} rows at {} stress ratios", self.curves.len())
    }

    /// What is to be said of one that names no stress ratio.
    pub fn line(&self, ratio: f64) -> Option<String> {
        (!self.says_ratio).then(|| {
            format!(
                "the table of rates names no stress ratio: its rates are used at R = {ratio} as they are; name it in a column stress_ratio or \
                 by growth_table = {{ file = \"...\", stress_ratio = ... }}"
            )
        })
    }
}

/// The table of a case.
fn read(given: &Given<'_>) -> Result<Table> {
    const KEY: &str = "fatigue.growth_table";
    let Some(rates) = (given.rates)(given, KEY)? else {
        let remedy =
            "name a CSV file with the columns delta_k_mpa_sqrt_m, da_dn_mm_per_cycle and, for several ratios, stress_ratio";
        return Err(input_missing(KEY, "is missing", remedy));
    };
    let table = Table {
        curves: curves(&rates).map_err(|error| error.in_file(&given.folder.path(&rates.file)))?,
        holds_ends: given.get("growth_table_ends")? == Some(TableEnds::Held),
        walker_gamma: GAMMA.quantity.read_optional("fatigue.walker_gamma", given.get(GAMMA.key)?)?,
        says_ratio: rates.says_ratio,
    };
    let [first, last] = [&table.curves[0], &table.curves[table.curves.len() - 1]].map(|curve| curve.ratio);
    if let Some(gamma) = table.walker_gamma.filter(|_| !table.says_ratio || table.curves.len() > 1) {
        let problem = match table.says_ratio {
            true => format!("does not go with a table of several stress ratios, {first} to {last}"),
            false => "does not go with a table that names no stress ratio".to_owned(),
        };
        let remedy = "leave it out, or give a table of one stress ratio that it names, or { file = \"...\", stress_ratio = ... }";
        return Err(input("fatigue.walker_gamma", gamma, problem, remedy));
    }
    if let Some(ratio) = given.ratios.into_iter().find(|ratio| !table.knows(*ratio)) {
        let (name, add) = (&rates.file, "add rates at this ratio to the table");
        let by_gamma = format!("give fatigue.walker_gamma (ΔK at R = K_max (1-R)^gamma), or {add}");
        let (problem, remedy) = match table.curves.len() {
            1 => (format!("is another stress ratio than that of {name}, {first}"), &*by_gamma),
            _ => (format!("lies beyond the ratios of {name}, {first} to {last}"), add),
        };
        return Err(input("loading.stress_ratio", ratio, problem, remedy));
    }
    Ok(table)
}

/// The curves of a table by rising ratio, each with at least two rows, ΔK and rate rising.
fn curves(rates: &Rates) -> Result<Vec<Curve>> {
    let wrong = |row: Option<&RatedRow>, key: &str, value: f64, problem: String| {
        Error::Input(Box::new(InputError {
            line: row.map(|row| row.line),
            key: Some(key.to_owned()),
            value: Some(round_off(value).to_string()),
            problem,
            remedy: "give rows of rising ΔK with rising rates, both above zero, one stress ratio after the other".to_owned(),
            ..InputError::default()
        }))
    };
    let mut curves: Vec<Curve> = Vec::new();
    for row in &rates.rows {
        let pair = row.pair;
        match curves.last_mut() {
            Some(curve) if curve.ratio == row.ratio => {
                let last = curve.rows[curve.rows.len() - 1];
                if let Some(i) = (0..2).find(|&i| pair[i] <= last[i]) {
                    let si = [MPA_SQRT_M, MM_PER_CYCLE][i];
                    let problem = format!("does not rise against {}, that of the row before", round_off(last[i] / si));
                    return Err(wrong(Some(row), &rates.columns[i], pair[i] / si, problem));
                }
                curve.rows.push(pair);
            }
            Some(last) if last.ratio > row.ratio => {
                let problem = format!("falls below {}, that of the rows before", last.ratio);
                return Err(wrong(Some(row), "stress_ratio", row.ratio, problem));
            }
            _ => curves.push(Curve { ratio: row.ratio, rows: vec![pair] }),
        }
    }
    match curves.iter().find(|curve| curve.rows.len() < 2) {
        None if curves.is_empty() => Err(wrong(None, "rows", 0.0, "are too few".to_owned())),
        None => Ok(curves),
        Some(curve) => {
            Err(wrong(None, "stress_ratio", curve.ratio, "has a single row: a rate between rows needs two".to_owned()))
        }
    }
}
