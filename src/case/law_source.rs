//! The law of `[fatigue]`: inline constants, or a record that `perilife calibrate` wrote.
//!
//! A case has one law: a second one, however it is given, is refused. A driver that needs a law of the other kind, of bonds (A, p) or over
//! K (C, m), takes what the given one stands for.

use toml::{Table, Value};

use super::choices::Method;
use super::growth_law::{FactorKeys, Setting};
use super::{LawSource, law};
use crate::case::record::{FittedRecord, LawRecord};
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

/// A law that the file gives.
pub(super) struct GivenLaw {
    /// Kinds of `fatigue.growth_law` that it can be.
    kinds: &'static [GrowthLawKind],
    /// The first of its keys that is given, with its value.
    key: &'static str,
    value: String,
}

impl GivenLaw {
    /// `None` where none of its keys has a value.
    pub fn of(kinds: &'static [GrowthLawKind], keys: &[(&'static str, Option<String>)]) -> Option<Self> {
        keys.iter().find_map(|(key, value)| Some(GivenLaw { kinds, key, value: value.clone()? }))
    }

    fn refused(&self, problem: String, remedy: &str) -> Error {
        input(&format!("fatigue.{}", self.key), &self.value, problem, remedy)
    }
}

/// A value as the messages show it.
pub(super) fn shown<T: ToString>(value: &Option<T>) -> Option<String> {
    value.as_ref().map(T::to_string)
}

impl LawKeys {
    /// The law of the case, of the kind that is asked for or else whose constants are given; `None` where the file gives none at all,
    /// as in a calibration.
    ///
    /// # Errors
    /// Two laws, constants of another kind than `growth_law` or than the driver can have.
    pub(super) fn read(
        &self,
        kind: Option<GrowthLawKind>,
        (method, settings): (Method, FatigueSettings),
        (factor, setting): (&FactorKeys, &Setting<'_>),
    ) -> Result<Option<LawSource>> {
        const KEY: &str = "fatigue.growth_law";
        let by_bonds = method == Method::Peridynamics && settings.driver == Driver::BondStrain;
        let by_strain = by_bonds && settings.growth_rate == GrowthRate::BondStrain;
        let given = self.only_law(kind, factor)?;
        let kind = kind.or(given.as_ref().and_then(|law| if let [only] = law.kinds { Some(*only) } else { None }));
        if let Some(kind @ (GrowthLawKind::Forman | GrowthLawKind::Nasgro | GrowthLawKind::Table)) = kind {
            if by_bonds {
                let problem = "is no law of bonds, whose rate is a power of their strain";
                let remedy = "use fatigue.driver = \"tip_field\", or model.method = \"handbook\"";
                return Err(input(KEY, format!("\"{kind}\""), problem, remedy));
            }
            return factor.read(kind, setting).map(Some);
        }
        if factor.k_c_mpa_sqrt_m.is_some() {
            let remedy = "leave it out, or choose its law by fatigue.growth_law";
            return Err(input_missing("fatigue.k_c_mpa_sqrt_m", "is no constant of this growth law", remedy));
        }
        let lacks = match kind {
            Some(GrowthLawKind::Paris | GrowthLawKind::Walker) if given.is_none() => Some("paris_c_mm_per_cycle"),
            Some(GrowthLawKind::Walker) if !setting.has_walker => Some("walker_gamma"),
            Some(GrowthLawKind::BondLaw) if given.is_none() => Some("a"),
            _ => None,
        };
        if let (Some(key), Some(kind)) = (lacks, kind) {
            let problem = format!("is missing, and growth_law is \"{kind}\"");
            return Err(input_missing(&format!("fatigue.{key}"), problem, "give all constants of the law"));
        }
        if let Some(fitted) = &self.fitted {
            return read_record(fitted, setting.folder).map(Some);
        }
        let law = self.bond_law()?.map(LawSource::Inline).or(self.paris_law()?.map(LawSource::Paris));
        // What a driver cannot use as it is has to be translated.
        match &law {
            Some(LawSource::Inline(law)) if !by_strain && !STEADY_EXPONENTS.contains(&law.p) => Err(unsteady("fatigue.p", law.p)),
            Some(LawSource::Paris(law)) if by_bonds && !STEADY_EXPONENTS.contains(&law.m) => {
                Err(unsteady("fatigue.paris_m", law.m))
            }
            _ => Ok(law),
        }
    }

    /// The law that is given, if any: one, and of the kind asked for.
    fn only_law(&self, kind: Option<GrowthLawKind>, factor: &FactorKeys) -> Result<Option<GivenLaw>> {
        use GrowthLawKind::{BondLaw, Paris, Walker};
        let values = |keys: Vec<(&'static str, Option<f64>)>| {
            keys.into_iter().map(|(key, value)| (key, shown(&value))).collect::<Vec<_>>()
        };
        let laws = [
            GivenLaw::of(&[BondLaw, Paris, Walker], &[("fitted", self.fitted.clone())]),
            GivenLaw::of(&[BondLaw], &values(self.bond())),
            GivenLaw::of(&[Paris, Walker], &values(self.paris())),
        ];
        let mut laws = laws.into_iter().flatten().chain(factor.given());
        let Some(law) = laws.next() else { return Ok(None) };
        if let Some(second) = laws.next() {
            let problem = format!("stands beside fatigue.{}: the law is given twice", law.key);
            return Err(second.refused(problem, "give one law: fitted, or the constants of one kind"));
        }
        if let Some(kind) = kind.filter(|kind| !law.kinds.contains(kind)) {
            let problem = format!("is no constant of fatigue.growth_law = \"{kind}\"");
            return Err(law.refused(problem, "give the constants of that law, or leave growth_law out"));
        }
        Ok(Some(law))
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

/// Takes the law out of the sections of a case that is to get another one, or needs none.
pub fn remove_law(sections: &mut Table) {
    if let Some(fatigue) = sections.get_mut("fatigue").and_then(Value::as_table_mut) {
        for key in LAW_KEYS {
            fatigue.remove(key);
        }
    }
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
    if LawRecord::is_of(&document.table) {
        let problem = "holds a law over K that was fitted to rates, not A and p";
        return Err(input("fitted", format!("\"{name}\""), problem, "give a record of a fit to a-N readings"));
    }
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
