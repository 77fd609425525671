//! A calibration file whose fit is a law over K: rates of tables, or of readings, and which law.

use toml::{Table, Value};

use super::{FitLaw, Given, LawFits, fit_laws};
use crate::case::{CalibrationCase, source};
use crate::outliers::{StepRate, step_rates};
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::{Document, value_at};
use perilife_base::keys::{Key, Section, intensity, key, section};
use perilife_base::table::units::{IntensityUnit, RateUnit};
use perilife_base::units::MPA_SQRT_M;
use perilife_growth::case::record::SourceFile;
use perilife_laws::growth_law::{GrowthLawKind, paris};
use perilife_measured::rates::lacks_ratio;
use perilife_measured::{MeasuredCurve, RangeKind, RateFile, RateFileKeys, RateRow};

#[derive(Debug, Clone, PartialEq)]
pub struct LawCase {
    pub name: String,
    pub rows: Vec<RateRow>,
    pub law: FitLaw,
    pub given: Given,
    /// Rates of the tables that are left out since they are flagged.
    pub flagged: usize,
    pub material: String,
    pub sources: Vec<SourceFile>,
    /// The test, where rates are taken from readings.
    pub test: Option<Box<CalibrationCase>>,
    pub warnings: Vec<String>,
    /// Units that the tables were read in, one line a table.
    pub units: Vec<String>,
    /// What ΔK was in the tables at negative R, where a row has one.
    pub range: Option<RangeKind>,
    pub echo: serde_json::Value,
}

perilife_base::keys! {
    /// Keys of `[measured]` that only tables of rates have.
    pub struct RatesKeys {
        rates: Vec<RateFile> = key("rates", "Tables of rates: da/dN over ΔK"), or "none" Vec::new();
        intensity_unit: Option<IntensityUnit> = key("intensity_unit", "Unit of ΔK: of all tables");
        rate_unit: Option<RateUnit> = key("rate_unit", "Unit of da/dN: of all tables");
        delta_k: Option<RangeKind> = key("delta_k", "ΔK at negative R: of all tables");
        from: Option<f64> = intensity("from_delta_k_mpa_sqrt_m", "Fit window: from this ΔK");
        to: Option<f64> = intensity("to_delta_k_mpa_sqrt_m", "Fit window: to this ΔK");
    }
    /// Keys of `[fit]` that only laws have.
    pub struct LawKeys {
        law: Option<FitLaw> = key("law", "Growth law to fit: default paris");
        given: Given = key("given", "Given constants: by their keys of [fatigue]"), or "none" Given::new();
    }
}

fn names(keys: &'static [Key]) -> Vec<&'static str> {
    keys.iter().map(|key| key.name).collect()
}

/// Whether a calibration file asks for a law over K: it names tables of rates, or another law than that of Paris.
pub fn is_law_fit(table: &Table) -> bool {
    let value = |section: &str, key: &str| table.get(section).and_then(|section| value_at(section, key));
    let law = value("fit", "law").and_then(Value::as_str);
    value("measured", "rates").is_some() || value("fit", "given").is_some() || law.is_some_and(|law| law != paris::LAW.name)
}

impl LawCase {
    pub fn from_document(document: &Document) -> Result<Self> {
        Self::build(document).map_err(|error| document.locate(error))
    }

    fn build(document: &Document) -> Result<Self> {
        let mut rest = document.clone();
        let rates: RatesKeys = section(&taken(&mut rest.table, "measured", &names(RatesKeys::KEYS))?, "measured")?;
        let laws: LawKeys = section(&taken(&mut rest.table, "fit", &names(LawKeys::KEYS))?, "fit")?;
        super::fit::check_given(&laws.given)?;
        let mut case = LawCase {
            name: document.name.clone(),
            rows: Vec::new(),
            law: laws.law.unwrap_or(FitLaw(Some(GrowthLawKind(&paris::LAW)))),
            given: laws.given,
            flagged: 0,
            material: String::new(),
            sources: Vec::new(),
            test: None,
            warnings: Vec::new(),
            units: Vec::new(),
            range: None,
            echo: serde_json::to_value(&document.table).unwrap_or_default(),
        };
        for table in &rates.rates {
            let keys = table.keys();
            let keys = RateFileKeys {
                intensity_unit: keys.intensity_unit.or(rates.intensity_unit),
                rate_unit: keys.rate_unit.or(rates.rate_unit),
                delta_k: keys.delta_k.or(rates.delta_k),
                ..keys
            };
            case.add_table(&keys, document)?;
        }
        if rest.table.get("measured").is_some_and(|measured| value_at(measured, "files").is_some()) {
            case.add_readings(rest)?;
        } else {
            case.material = alone(&rest.table)?;
        }
        let remedy = "name tables of da/dN over ΔK: rates = [\"...csv\"], or a-N readings: files = [\"...csv\"]";
        fail_if!(case.sources.is_empty(), input_missing("measured.rates", "is missing", remedy));
        case.window(&rates)?;
        Ok(case)
    }

    fn add_table(&mut self, keys: &RateFileKeys, document: &Document) -> Result<()> {
        let (found, bytes) = keys.read(&document.folder, "measured.rates")?;
        let path = document.folder.path(&keys.file);
        fail_if!(!found.says_ratio, lacks_ratio(&keys.file, "measured.rates").in_file(&path));
        self.warnings.extend(found.warnings);
        self.flagged += found.flagged;
        if let Some(range) = found.range {
            self.range = Some(range);
        }
        self.units.push(format!("{}: ΔK in {}, da/dN in {}", keys.file, found.units[0], found.units[1]));
        self.rows.extend(found.rows);
        self.sources.push(source(&keys.file, &bytes));
        Ok(())
    }

    /// Rates of a-N readings, each reading with its own load and stress ratio where its file has them.
    fn add_readings(&mut self, rest: Document) -> Result<()> {
        let test = CalibrationCase::from_document(rest)?;
        if test.delta_k(test.case.specimen.crack_length).is_none() {
            let problem = "has no handbook K(a), which rates from readings need";
            let remedy = "fit the law paris (K along the crack path), or give tables of rates: measured.rates";
            return Err(input("specimen.kind", format!("\"{}\"", test.case.specimen.kind), problem, remedy));
        }
        self.rows.extend(of_readings(&test, &|length| test.delta_k(length).unwrap_or(f64::NAN)));
        self.warnings.extend(test.warnings.iter().cloned());
        self.sources.extend(test.sources.iter().cloned());
        self.material.clone_from(&test.case.material.name);
        self.test = Some(Box::new(test));
        Ok(())
    }

    fn window(&mut self, keys: &RatesKeys) -> Result<()> {
        let (from, to) = (keys.from.unwrap_or(0.0), keys.to.unwrap_or(f64::INFINITY));
        let problem = || format!("is not above from_delta_k_mpa_sqrt_m = {}", from / MPA_SQRT_M);
        fail_if!(from >= to, input("measured.to_delta_k_mpa_sqrt_m", to / MPA_SQRT_M, problem(), "give a window with rates"));
        self.rows.retain(|row| (from * (1.0 - 1e-9)..=to * (1.0 + 1e-9)).contains(&row.delta_k));
        let count = self.rows.len();
        if count < 3 {
            let problem = format!("rates remain, and {} are flagged", self.flagged);
            let remedy = match self.flagged {
                0 => "give at least three rates; widen the window in ΔK",
                _ => {
                    "write the table by `perilife rates --precision-mm` if steps near the threshold are short; to use a \
                     flagged rate, clear its cell in the column flags"
                }
            };
            return Err(input("measured.rates", count, problem, remedy));
        }
        Ok(())
    }

    pub fn fit(&self) -> Result<LawFits> {
        fit_laws(&self.rows, self.law, &self.given)
    }

    /// Stress ratios of the rates, rising, those that agree to 0.005 as one.
    pub fn ratios(&self) -> Vec<f64> {
        let mut ratios: Vec<f64> = self.rows.iter().map(|row| (row.ratio * 100.0).round() / 100.0).collect();
        ratios.sort_by(f64::total_cmp);
        ratios.dedup();
        ratios
    }

    /// Smallest and largest ΔK, MPa√m.
    pub fn delta_k_range(&self) -> [f64; 2] {
        let all = || self.rows.iter().map(|row| row.delta_k / MPA_SQRT_M);
        [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)]
    }
}

fn taken(table: &mut Table, section: &str, keys: &[&str]) -> Result<Value> {
    let mut taken = Table::new();
    if let Some(value) = table.get_mut(section) {
        let of = value.as_table_mut().ok_or_else(|| input(section, "", "is not a table of keys", "write a section"))?;
        taken.extend(keys.iter().filter_map(|key| Some(((*key).to_owned(), of.remove(*key)?))));
    }
    Ok(Value::Table(taken))
}

/// The name of the material of a file of tables alone, whose other sections have nothing to say.
fn alone(table: &Table) -> Result<String> {
    for (section, value) in table {
        let keys = value.as_table().into_iter().flat_map(|table| table.keys()).next();
        match (section.as_str(), keys) {
            ("material", _) | ("measured" | "fit", None) => {}
            ("measured" | "fit", Some(key)) => {
                let known = names(if section == "measured" { RatesKeys::KEYS } else { LawKeys::KEYS }).join(", ");
                let problem = "is not a key of a fit to tables of rates";
                return Err(input_missing(&format!("{section}.{key}"), problem, format!("use one of: {known}")));
            }
            _ => {
                let remedy = "remove the section, or give a-N readings: measured.files = [\"...csv\"]";
                return Err(input_missing(section, "does not apply to tables of rates, which have ΔK and R", remedy));
            }
        }
    }
    Ok(table
        .get("material")
        .and_then(|material| value_at(material, "name"))
        .and_then(Value::as_str)
        .unwrap_or_default()
        .to_owned())
}

/// Rates of the readings of a calibration, over steps of at least 0.25 mm (ASTM E647, 8.6.2), each at its own ΔK and R.
fn of_readings(calibration: &CalibrationCase, delta_k: &dyn Fn(f64) -> f64) -> Vec<RateRow> {
    let of_curve = |curve: &MeasuredCurve| -> Vec<RateRow> {
        let ratio_at = |reading: usize| {
            let own = curve.loads.as_ref().and_then(|loads| loads.ratio.get(reading).copied());
            own.filter(|ratio| !ratio.is_nan()).unwrap_or(calibration.case.loading.ratio)
        };
        let row = |step: StepRate| RateRow {
            series: curve.specimen.clone(),
            place: format!("{}: lines {} to {}", curve.source.file.display(), curve.line(step.from), curve.line(step.to)),
            delta_k: step.log_k.exp() * MPA_SQRT_M,
            line: curve.line(step.to),
            rate: step.log_rate.exp(),
            ratio: (step.from + 1..=step.to).map(ratio_at).sum::<f64>() / (step.to - step.from) as f64,
        };
        step_rates(curve, delta_k).into_iter().map(row).filter(|row| row.rate > 0.0 && row.rate.is_finite()).collect()
    };
    calibration.curves.iter().flat_map(of_curve).collect()
}
