//! Laws over K that are no power of it, from `[fatigue]`.

use super::fatigue_keys::{FatigueKeys, TableEnds};
use crate::error::{Error, InputError, Result, input, input_missing};
use crate::fatigue::growth_law::nasgro::{Nasgro, RATIO_MIN};
use crate::fatigue::growth_law::table::{Curve, Table};
use crate::fatigue::growth_law::{FactorLaw, Forman, GrowthLawKind};
use crate::input::{Folder, INTENSITY, number};
use crate::material::Material;
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
        if self.walker_gamma.is_some() {
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
        let Some(name) = &self.growth_table else {
            let remedy =
                "name a CSV file with the columns delta_k_mpa_sqrt_m, da_dn_mm_per_cycle and, for several ratios, stress_ratio";
            return Err(input_missing("fatigue.growth_table", "is missing", remedy));
        };
        let bytes = setting.folder.read(name)?;
        let curves = rows(&bytes).map_err(|error| error.in_file(&setting.folder.path(name)))?;
        let table = Table { curves, holds_ends: self.growth_table_ends == Some(TableEnds::Held) };
        if !table.knows(setting.ratio) {
            let [first, last] = [&table.curves[0], &table.curves[table.curves.len() - 1]].map(|curve| curve.ratio);
            let problem = format!("lies beyond the ratios of {name}, {first} to {last}");
            return Err(input("loading.stress_ratio", setting.ratio, problem, "add rates at this ratio to the table"));
        }
        Ok(table)
    }
}

fn needed<T>(key: &str, value: Option<T>) -> Result<T> {
    value.ok_or_else(|| input_missing(&format!("fatigue.{key}"), "is missing", "give all constants of the law"))
}

const DELTA_K: &str = "delta_k_mpa_sqrt_m";
const GROWTH_RATE: &str = "da_dn_mm_per_cycle";
const RATIO: &str = "stress_ratio";

/// Rates of a CSV file by rising ratio, each curve with at least two rows, ΔK and rate rising.
fn rows(bytes: &[u8]) -> Result<Vec<Curve>> {
    let wrong = |line: u64, key: &str, value: &str, problem: String| {
        Error::Input(Box::new(InputError {
            line: Some(line as usize),
            key: Some(key.to_owned()),
            value: Some(value.to_owned()),
            problem,
            remedy: "give rows of rising ΔK with rising rates, both above zero, one stress ratio after the other".to_owned(),
            ..InputError::default()
        }))
    };
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(bytes);
    let broken = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        wrong(line, "growth_table", "", format!("cannot be read as CSV: {error}"))
    };
    let header = reader.headers().map_err(broken)?.clone();
    let column = |name: &str| header.iter().position(|column| column == name);
    let [Some(delta_k), Some(rate)] = [DELTA_K, GROWTH_RATE].map(column) else {
        let found: Vec<&str> = header.iter().collect();
        return Err(wrong(1, "header", &found.join(","), format!("lacks the columns {DELTA_K} and {GROWTH_RATE}")));
    };
    let ratio = column(RATIO);
    let mut curves: Vec<Curve> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(broken)?;
        let line = record.position().map_or(0, csv::Position::line);
        let value = |at: usize, key: &str| -> Result<f64> {
            let text = record.get(at).unwrap_or("");
            let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
            number.ok_or_else(|| wrong(line, key, text, "is not a number".to_owned()))
        };
        let row = [value(delta_k, DELTA_K)? * MPA_SQRT_M, value(rate, GROWTH_RATE)? * MM_PER_CYCLE];
        for (at, key, size) in [(delta_k, DELTA_K, row[0]), (rate, GROWTH_RATE, row[1])] {
            if size <= 0.0 {
                return Err(wrong(line, key, &record[at], "is not above zero".to_owned()));
            }
        }
        let ratio_here = ratio.map_or(Ok(0.0), |at| value(at, RATIO))?;
        if ratio_here >= 1.0 {
            return Err(wrong(line, RATIO, &ratio_here.to_string(), "is no stress ratio below 1".to_owned()));
        }
        match curves.last_mut().filter(|curve| curve.ratio == ratio_here) {
            Some(curve) => {
                let last = curve.rows[curve.rows.len() - 1];
                for (at, key, i) in [(delta_k, DELTA_K, 0), (rate, GROWTH_RATE, 1)] {
                    if row[i] <= last[i] {
                        return Err(wrong(line, key, &record[at], "does not rise against the row before".to_owned()));
                    }
                }
                curve.rows.push(row);
            }
            None => {
                if let Some(last) = curves.last().filter(|last| last.ratio > ratio_here) {
                    let problem = format!("falls below {}, that of the rows before", last.ratio);
                    return Err(wrong(line, RATIO, &ratio_here.to_string(), problem));
                }
                curves.push(Curve { ratio: ratio_here, rows: vec![row] });
            }
        }
    }
    match curves.iter().find(|curve| curve.rows.len() < 2) {
        None if curves.is_empty() => Err(wrong(1, "rows", "0", "are too few".to_owned())),
        None => Ok(curves),
        Some(curve) => {
            let problem = "has a single row: a rate between rows needs two".to_owned();
            Err(wrong(1, RATIO, &curve.ratio.to_string(), problem))
        }
    }
}
