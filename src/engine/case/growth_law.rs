//! Laws over K that are no power of it, from `[fatigue]`.

use super::fatigue_keys::{FatigueKeys, TableEnds};
use crate::error::{Error, InputError, Result, input, input_missing};
use crate::fatigue::growth_law::nasgro::{Nasgro, RATIO_MIN};
use crate::fatigue::growth_law::table::{Curve, Table};
use crate::fatigue::growth_law::{FactorLaw, Forman, GrowthLawKind};
use crate::input::{Folder, INTENSITY, number};
use crate::material::Material;
use crate::measured::{RateFile, RateRow, RateTable, round_off};
use crate::units::{MM_PER_CYCLE, MPA_SQRT_M};

/// What these laws need to know about the rest of the case.
pub(super) struct Setting<'a> {
    pub material: &'a Material,
    pub ratio: f64,
    pub folder: &'a Folder,
}

const RATE: &str = "a rate in mm/cycle";

impl FatigueKeys {
    /// The law of this kind.
    pub fn factor_law(&self, kind: GrowthLawKind, setting: &Setting<'_>) -> Result<FactorLaw> {
        if self.walker_gamma.is_some() && kind != GrowthLawKind::Table {
            let remedy = "leave it out, or use growth_law = \"walker\"";
            return Err(input_missing("fatigue.walker_gamma", format!("does not go with growth_law \"{kind}\""), remedy));
        }
        if self.delta_k_threshold_mpa_sqrt_m.is_some() && kind == GrowthLawKind::Nasgro {
            let problem = "does not go with growth_law \"nasgro\", which has its own threshold";
            let remedy = "leave it out, and give nasgro_delta_k_0_mpa_sqrt_m";
            return Err(input_missing("fatigue.delta_k_threshold_mpa_sqrt_m", problem, remedy));
        }
        if self.k_c_mpa_sqrt_m.is_some() && kind == GrowthLawKind::Table {
            let remedy = "leave it out, or give material.toughness_mpa_sqrt_m";
            return Err(input_missing("fatigue.k_c_mpa_sqrt_m", "is no constant of growth_law \"table\"", remedy));
        }
        Ok(match kind {
            GrowthLawKind::Forman => FactorLaw::Forman(self.forman(setting)?),
            GrowthLawKind::Nasgro => FactorLaw::Nasgro(self.nasgro(setting)?),
            _ => FactorLaw::Table(self.table(setting)?),
        })
    }

    fn forman(&self, setting: &Setting<'_>) -> Result<Forman> {
        let c = needed("forman_c_mm_per_cycle", self.forman_c_mm_per_cycle)?;
        Ok(Forman {
            c: number(RATE, 1e-60, 1e3).read("fatigue.forman_c_mm_per_cycle", c)? * MM_PER_CYCLE,
            m: number("an exponent", 0.5, 20.0).read("fatigue.forman_m", needed("forman_m", self.forman_m)?)?,
            k_c: self.k_c(setting)?,
        })
    }

    fn nasgro(&self, setting: &Setting<'_>) -> Result<Nasgro> {
        if setting.ratio < RATIO_MIN {
            let problem = format!("lies below {RATIO_MIN}, to which the crack opening of growth_law \"nasgro\" is known");
            return Err(input("loading.stress_ratio", setting.ratio, problem, "use another growth_law"));
        }
        let exponent = |key: &str, value: Option<f64>, least: f64| {
            number("an exponent", least, 20.0).read(&format!("fatigue.{key}"), needed(key, value)?)
        };
        let slope = |key: &str, value: Option<f64>| {
            number("a slope of the threshold over R", -10.0, 10.0).read(key, value.unwrap_or(0.0))
        };
        let (alpha, stress) = ("fatigue.nasgro_alpha", "fatigue.nasgro_smax_over_flow");
        let threshold = needed("nasgro_delta_k_0_mpa_sqrt_m", self.nasgro_delta_k_0_mpa_sqrt_m)?;
        let c = needed("nasgro_c_mm_per_cycle", self.nasgro_c_mm_per_cycle)?;
        Ok(Nasgro {
            c: number(RATE, 1e-60, 1e3).read("fatigue.nasgro_c_mm_per_cycle", c)? * MM_PER_CYCLE,
            n: exponent("nasgro_n", self.nasgro_n, 0.5)?,
            p: exponent("nasgro_p", self.nasgro_p, 0.0)?,
            q: exponent("nasgro_q", self.nasgro_q, 0.0)?,
            alpha: number("a constraint factor, 1 to 3", 1.0, 3.0).read(alpha, needed("nasgro_alpha", self.nasgro_alpha)?)?,
            stress_over_flow: number("a share of the flow stress", 0.0, 0.99)
                .read(stress, needed("nasgro_smax_over_flow", self.nasgro_smax_over_flow)?)?,
            threshold: INTENSITY.read("fatigue.nasgro_delta_k_0_mpa_sqrt_m", threshold)?,
            threshold_slopes: [
                slope("fatigue.nasgro_c_th_negative", self.nasgro_c_th_negative)?,
                slope("fatigue.nasgro_c_th", self.nasgro_c_th)?,
            ],
            k_c: self.k_c(setting)?,
        })
    }

    fn k_c(&self, setting: &Setting<'_>) -> Result<f64> {
        let given = INTENSITY.read_optional("fatigue.k_c_mpa_sqrt_m", self.k_c_mpa_sqrt_m)?;
        given.or(setting.material.toughness).ok_or_else(|| {
            let problem = "is missing, and the material has no toughness";
            input_missing("fatigue.k_c_mpa_sqrt_m", problem, "give the K at which growth becomes unstable")
        })
    }

    fn table(&self, setting: &Setting<'_>) -> Result<Table> {
        const KEY: &str = "fatigue.growth_table";
        let Some(file) = self.growth_table.as_ref().map(RateFile::keys) else {
            let remedy =
                "name a CSV file with the columns delta_k_mpa_sqrt_m, da_dn_mm_per_cycle and, for several ratios, stress_ratio";
            return Err(input_missing(KEY, "is missing", remedy));
        };
        let (rates, _) = file.read(setting.folder, KEY)?;
        let table = Table {
            curves: curves(&rates).map_err(|error| error.in_file(&setting.folder.path(&file.file)))?,
            holds_ends: self.growth_table_ends == Some(TableEnds::Held),
            walker_gamma: number("a Walker exponent", 0.0, 2.0).read_optional("fatigue.walker_gamma", self.walker_gamma)?,
            says_ratio: rates.says_ratio,
        };
        let [first, last] = [&table.curves[0], &table.curves[table.curves.len() - 1]].map(|curve| curve.ratio);
        if let Some(gamma) = self.walker_gamma.filter(|_| !table.says_ratio || table.curves.len() > 1) {
            let problem = match table.says_ratio {
                true => format!("does not go with a table of several stress ratios, {first} to {last}"),
                false => "does not go with a table that names no stress ratio".to_owned(),
            };
            let remedy =
                "leave it out, or give a table of one stress ratio that it names, or { file = \"...\", stress_ratio = ... }";
            return Err(input("fatigue.walker_gamma", gamma, problem, remedy));
        }
        if !table.knows(setting.ratio) {
            let name = &file.file;
            let (problem, remedy) = match table.curves.len() {
                1 => (
                    format!("is another stress ratio than that of {name}, {first}"),
                    "give fatigue.walker_gamma (ΔK at R = K_max (1-R)^gamma), or add rates at this ratio to the table",
                ),
                _ => (format!("lies beyond the ratios of {name}, {first} to {last}"), "add rates at this ratio to the table"),
            };
            return Err(input("loading.stress_ratio", setting.ratio, problem, remedy));
        }
        Ok(table)
    }
}

fn needed<T>(key: &str, value: Option<T>) -> Result<T> {
    value.ok_or_else(|| input_missing(&format!("fatigue.{key}"), "is missing", "give all constants of the law"))
}

/// The curves of a table by rising ratio, each with at least two rows, ΔK and rate rising.
fn curves(rates: &RateTable) -> Result<Vec<Curve>> {
    let wrong = |row: Option<&RateRow>, key: &str, value: f64, problem: String| {
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
        let pair = [row.delta_k, row.rate];
        match curves.last_mut().filter(|curve| curve.ratio == row.ratio) {
            Some(curve) => {
                let last = curve.rows[curve.rows.len() - 1];
                if let Some(i) = (0..2).find(|&i| pair[i] <= last[i]) {
                    let si = [MPA_SQRT_M, MM_PER_CYCLE][i];
                    let before = round_off(last[i] / si);
                    return Err(wrong(
                        Some(row),
                        &rates.columns[i],
                        pair[i] / si,
                        format!("does not rise against {before}, that of the row before"),
                    ));
                }
                curve.rows.push(pair);
            }
            None => {
                if let Some(last) = curves.last().filter(|last| last.ratio > row.ratio) {
                    let problem = format!("falls below {}, that of the rows before", last.ratio);
                    return Err(wrong(Some(row), "stress_ratio", row.ratio, problem));
                }
                curves.push(Curve { ratio: row.ratio, rows: vec![pair] });
            }
        }
    }
    match curves.iter().find(|curve| curve.rows.len() < 2) {
        None if curves.is_empty() => Err(wrong(None, "rows", 0.0, "are too few".to_owned())),
        None => Ok(curves),
        Some(curve) => {
            let problem = "has a single row: a rate between rows needs two".to_owned();
            Err(wrong(None, "stress_ratio", curve.ratio, problem))
        }
    }
}
