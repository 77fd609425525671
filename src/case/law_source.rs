//! The law of `[fatigue]`: inline constants, or a record that `perilife calibrate` wrote.
//!
//! A law of bonds (A, p) and one over K (C, m) may stand side by side: a driver takes its own kind, and where only the other is
//! given, what that stands for.

use toml::Value;

use super::choices::Method;
use super::growth_law::{FactorKeys, Setting};
use super::{LawSource, law};
use crate::calibration::record::FittedRecord;
use crate::error::{Error, Result, input, input_missing};
use crate::fatigue::growth_law::GrowthLawKind;
use crate::fatigue::paris::ParisLaw;
use crate::fatigue::{Driver, FatigueLaw, FatigueSettings, GrowthRate, STEADY_EXPONENTS, unsteady};
use crate::input::{Folder, LENGTH, number, slice};
use crate::units::MM_PER_CYCLE;

/// Keys of `[fatigue]` that give a law.
#[derive(Debug, Clone, Default)]
pub(super) struct LawKeys {
    pub fitted: Option<String>,
    pub a: Option<f64>,
    pub p: Option<f64>,
    pub horizon_mm: Option<f64>,
    pub paris_c_mm_per_cycle: Option<f64>,
    pub paris_m: Option<f64>,
}

/// All keys that give a law, for those who take it out of a file.
pub const LAW_KEYS: [&str; 21] = [
    "fitted",
    "a",
    "p",
    "horizon_mm",
    "paris_c_mm_per_cycle",
    "paris_m",
    "growth_law",
    "forman_c_mm_per_cycle",
    "forman_m",
    "nasgro_c_mm_per_cycle",
    "nasgro_n",
    "nasgro_p",
    "nasgro_q",
    "nasgro_alpha",
    "nasgro_smax_over_flow",
    "nasgro_delta_k_0_mpa_sqrt_m",
    "nasgro_c_th",
    "nasgro_c_th_negative",
    "k_c_mpa_sqrt_m",
    "growth_table",
    "growth_table_ends",
];

impl LawKeys {
    /// The law that the method and driver need, of the kind that is asked for or else whose constants are given; `None` where the
    /// file gives none at all, as in a calibration.
    pub(super) fn read(
        &self,
        kind: Option<GrowthLawKind>,
        (method, settings): (Method, FatigueSettings),
        (factor, setting): (&FactorKeys, &Setting<'_>),
    ) -> Result<Option<LawSource>> {
        const KEY: &str = "fatigue.growth_law";
        let by_bonds = method == Method::Peridynamics && settings.driver == Driver::BondStrain;
        let by_strain = by_bonds && settings.growth_rate == GrowthRate::BondStrain;
        let powers = self.bond().into_iter().chain(self.paris());
        let of_power = powers.filter_map(|(key, value)| Some((key, value?))).next();
        let given = factor.given()?;
        let kind = kind.or(given.map(|(kind, _)| kind));
        if let Some(kind @ (GrowthLawKind::Forman | GrowthLawKind::Nasgro | GrowthLawKind::Table)) = kind {
            let twice = of_power.map(|(key, _)| key).or(self.fitted.as_ref().map(|_| "fitted"));
            let other = given.filter(|(other, _)| *other != kind).map(|(_, key)| key);
            if let Some(key) = twice.or(other) {
                let problem = format!("is no constant of growth_law \"{kind}\": the law is given twice");
                return Err(input_missing(&format!("fatigue.{key}"), problem, "give the constants of one law"));
            }
            if by_bonds {
                let problem = "is no law of bonds, whose rate is a power of their strain";
                let remedy = "use fatigue.driver = \"tip_field\", or model.method = \"handbook\"";
                return Err(input(KEY, format!("\"{kind}\""), problem, remedy));
            }
            return factor.read(kind, setting).map(Some);
        }
        if let Some(key) = given.map(|(_, key)| key).or(factor.k_c_mpa_sqrt_m.map(|_| "k_c_mpa_sqrt_m")) {
            let problem = "is no constant of this growth law";
            return Err(input_missing(
                &format!("fatigue.{key}"),
                problem,
                "leave it out, or choose its law by fatigue.growth_law",
            ));
        }
        let lacks = match kind {
            Some(GrowthLawKind::Paris | GrowthLawKind::Walker) if self.fitted.is_none() && self.paris_m.is_none() => {
                Some("paris_c_mm_per_cycle")
            }
            Some(GrowthLawKind::Walker) if !setting.has_walker => Some("walker_gamma"),
            Some(GrowthLawKind::BondLaw) if self.fitted.is_none() && self.a.is_none() => Some("a"),
            _ => None,
        };
        if let (Some(key), Some(kind)) = (lacks, kind) {
            let problem = format!("is missing, and growth_law is \"{kind}\"");
            return Err(input_missing(&format!("fatigue.{key}"), problem, "give all constants of the law"));
        }
        let folder = setting.folder;
        if let Some(fitted) = &self.fitted {
            if let Some((key, value)) = of_power {
                let remedy = "give fitted, or constants, not both";
                return Err(input(&format!("fatigue.{key}"), value, "stands beside fitted: the law is given twice", remedy));
            }
            return read_record(fitted, folder).map(Some);
        }
        let bond = self.bond_law()?.map(LawSource::Inline);
        let paris = self.paris_law()?.map(LawSource::Paris);
        let wants_bonds = kind.map_or(by_bonds, |kind| kind == GrowthLawKind::BondLaw);
        let law = if wants_bonds { bond.or(paris) } else { paris.or(bond) };
        // What a driver cannot use as it is has to be translated.
        match &law {
            Some(LawSource::Inline(law)) if !by_strain && !STEADY_EXPONENTS.contains(&law.p) => Err(unsteady("fatigue.p", law.p)),
            Some(LawSource::Paris(law)) if by_bonds && !STEADY_EXPONENTS.contains(&law.m) => {
                Err(unsteady("fatigue.paris_m", law.m))
            }
            _ => Ok(law),
        }
    }

    fn bond(&self) -> Vec<(&'static str, Option<f64>)> {
        vec![("a", self.a), ("p", self.p), ("horizon_mm", self.horizon_mm)]
    }

    fn paris(&self) -> Vec<(&'static str, Option<f64>)> {
        vec![("paris_c_mm_per_cycle", self.paris_c_mm_per_cycle), ("paris_m", self.paris_m)]
    }

    fn bond_law(&self) -> Result<Option<FatigueLaw>> {
        let Some([a, p, horizon]) = together(self.bond(), "give a, p and horizon_mm together, or fitted")? else {
            return Ok(None);
        };
        Ok(Some(FatigueLaw {
            a: number("a constant in 1/cycle", 1e-60, 1e100).read("fatigue.a", a)?,
            p: number("an exponent", 0.5, 20.0).read("fatigue.p", p)?,
            horizon: LENGTH.read("fatigue.horizon_mm", horizon)?,
        }))
    }

    fn paris_law(&self) -> Result<Option<ParisLaw>> {
        let Some([c, m]) = together(self.paris(), "give paris_c_mm_per_cycle and paris_m together, or fitted")? else {
            return Ok(None);
        };
        let c = number("a rate in mm/cycle at ΔK = 1 MPa√m", 1e-60, 1e3).read("fatigue.paris_c_mm_per_cycle", c)?;
        Ok(Some(ParisLaw { c: c * MM_PER_CYCLE, m: number("an exponent", 0.5, 20.0).read("fatigue.paris_m", m)? }))
    }
}

/// All of the keys or none of them.
fn together<const N: usize>(keys: Vec<(&str, Option<f64>)>, remedy: &str) -> Result<Option<[f64; N]>> {
    if keys.iter().all(|(_, value)| value.is_none()) {
        return Ok(None);
    }
    let mut values = [f64::NAN; N];
    for (slot, (key, value)) in values.iter_mut().zip(&keys) {
        let why = if *key == "horizon_mm" { ": A is meaningless without the horizon it belongs to" } else { "" };
        *slot = value.ok_or_else(|| input_missing(&format!("fatigue.{key}"), format!("is missing{why}"), remedy))?;
    }
    Ok(Some(values))
}

/// Reads a `fitted.toml`; one that does not exist (yet) is [`LawSource::Missing`].
fn read_record(name: &str, folder: &Folder) -> Result<LawSource> {
    match fitted_record(name, folder) {
        Ok(record) => Ok(LawSource::Fitted(Box::new(record))),
        Err(Error::File { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
            Ok(LawSource::Missing(folder.path(name)))
        }
        Err(other) => Err(other),
    }
}

/// Reads and checks a `fitted.toml`.
///
/// # Errors
/// A file that cannot be read, or is no such record.
pub fn fitted_record(name: &str, folder: &Folder) -> Result<FittedRecord> {
    let document = folder.document(name)?;
    let record = slice::<FittedRecord>(&Value::Table(document.table.clone()), "record").and_then(|record| {
        law::check_record(&record)?;
        Ok(record)
    });
    let at_top = |error| match error {
        Error::Input(mut trouble) => {
            trouble.key = trouble.key.map(|key| key.trim_start_matches("record.").to_owned());
            trouble.remedy.push_str("; this file is written by `perilife calibrate`");
            Error::Input(trouble)
        }
        other => other,
    };
    record.map_err(|error| document.locate(at_top(error)))
}
