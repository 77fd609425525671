//! A fit: all its files, and the data of its test for a report, with the criteria of ASTM E647.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::chart::LARGE;
use super::checks;
use super::model_words::{clean, loading};
use super::output::{Room, write_file, write_json};
use super::pictures::fit::{BAND_FILE, FIT_FILE, FitTables, law_svg};
use super::pictures::plate::Plate;
use super::provenance::{self, MadeBy};
use perilife_base::columns::Table;
use perilife_base::error::{Error, Result};
use perilife_base::units::{GPA, KN, MM, MPA, MPA_SQRT_M};
use perilife_calibration::calibrate::Fitted;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::fit::Fit;
use perilife_calibration::rates::STEP_MIN;
use perilife_calibration::readings::{OUTSIDE, Reading, readings};
use perilife_calibration::record::FitRecord;
use perilife_calibration::results::{fit_curves, fitted_rates, left_out, rates_beside_law, rates_taken};
use perilife_growth::case::{Case, RECORD};
use perilife_measured::{LeaveOut, MeasuredCurve, side_difference_max};
use perilife_plate::specimen::handbook::{HandbookFormula, handbook};
use perilife_plate::specimen::{LoadMeasure, SpecimenKind};

pub const LAW_FILE: &str = RECORD;
pub const ROOM: Room = Room { tables: 64_000, all: 1_000_000 };
/// Growth rate over ΔK with the law.
const DA_DN_FILE: &str = "da_dn.svg";

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OfTest {
    pub test: TestRecord,
    pub criteria: Vec<Criterion>,
    pub plate: Plate,
    #[serde(flatten)]
    pub made_by: MadeBy,
}

#[derive(Debug, Clone)]
pub struct Kept {
    pub record: FitRecord,
    law: String,
    tables: Vec<(Table, String)>,
}

impl Kept {
    /// Of a fit and its record.
    /// Errors: a law that has no form in TOML.
    pub fn of(fitted: &Fitted<'_>, mut record: FitRecord) -> Result<Self> {
        let unwritable =
            |error: toml::ser::Error| Error::file(Path::new(LAW_FILE), "cannot write", std::io::Error::other(error.to_string()));
        let law = fitted.record_text().map_err(unwritable)?;
        let tables = match fitted {
            Fitted::Lives(calibration, fit) => {
                let (delta_k, left_out) = (|length: f64| fit.delta_k(calibration, length), left_out(calibration, fit));
                let readings = readings(calibration, &left_out, &delta_k);
                let outside = readings.records()?.iter().filter(|row: &&Reading| row.left_out == OUTSIDE).count();
                let tables = [fit_curves(fit), band(calibration, fit), fitted_rates(calibration, fit), readings]
                    .map(Table::with_text)
                    .to_vec();
                let texts = tables.iter().map(|(table, text)| (&*table.file, &**text));
                let texts = std::iter::once((Path::new(LAW_FILE), &*law)).chain(texts);
                let beside = OfTest {
                    test: test(calibration),
                    criteria: criteria(calibration, (&left_out, outside), &delta_k),
                    plate: Plate::of(&calibration.case),
                    made_by: MadeBy::of(&calibration.case.provenance, texts),
                };
                if let FitRecord::Lives(lives) = &mut record {
                    lives.beside = json!(beside);
                }
                tables
            }
            Fitted::Rates(case, fits) => [rates_beside_law(case, fits), rates_taken(case)].map(Table::with_text).to_vec(),
        };
        Ok(Kept { record, law, tables })
    }

    pub fn json(&self) -> Value {
        json!(self.record)
    }

    /// Texts of the law and all tables by the names of their files.
    pub fn texts(&self) -> impl Iterator<Item = (&Path, &str)> {
        let law = (Path::new(LAW_FILE), &*self.law);
        std::iter::once(law).chain(self.tables.iter().map(|(table, text)| (&*table.file, &**text)))
    }
}

pub fn write(folder: &Path, fitted: &Fitted<'_>, kept: &Kept) -> Result<()> {
    let put = |name: &Path, text: &str| write_file(&folder.join(name), text.as_bytes());
    kept.texts().try_for_each(|(name, text)| put(name, text))?;
    let draw = |name: &str, svg: String| put(Path::new(name), &svg);
    match (fitted, &kept.record, &*kept.tables) {
        (Fitted::Lives(calibration, fit), FitRecord::Lives(record), [(curves, _), (band, _), _, (readings, _)]) => {
            provenance::write(folder, "calibrate", calibration.input.clone(), &calibration.case.provenance)?;
            write_tables(folder, calibration, fit)?;
            let tables = FitTables::of(record, [curves, band, readings])?;
            draw("fit.svg", tables.lives_svg(LARGE))?;
            draw(DA_DN_FILE, tables.rates_svg(LARGE))?;
        }
        (_, _, tables) => draw(DA_DN_FILE, law_svg(&tables[0].0.records()?, LARGE))?,
    }
    write_json(folder, FIT_FILE, &kept.record)
}

/// Standard errors from the middle of a 95 % band to its ends.
const BAND: f64 = 1.96;

/// `fit_band.csv`: the fitted curve of the record with the 95 % band that the standard errors of its constants leave it; not the
/// scatter of specimens.
///
/// The rate at the pivot and the exponent m have errors of their own, without correlation, which is what makes it the pivot. With
/// N(a) = ∫ da / rate, the relative error of N is s_N² = s_rate² + (s_m w)², w the mean of ln(ΔK/ΔK_pivot) over the cycles so far.
fn band(calibration: &CalibrationCase, fit: &Fit) -> Table {
    let (lengths, cycles) = (&fit.record.crack_length, &fit.record.cycles_fitted);
    let m_error = fit.paris.m_error.max(calibration.exponent.error);
    let mut weighted = 0.0;
    let mut factor = |i: usize| {
        if i > 0 {
            let delta_k = fit.delta_k(calibration, 0.5 * (lengths[i] + lengths[i - 1])) * fit.record.load_factor[i] / MPA_SQRT_M;
            weighted += (cycles[i] - cycles[i - 1]) * (delta_k / fit.paris.pivot).ln();
        }
        let w = if cycles[i] > 0.0 { weighted / cycles[i] } else { 0.0 };
        (BAND * fit.paris.rate_at_pivot_error.hypot(m_error * w)).exp()
    };
    let factors: Vec<f64> = (0..lengths.len()).map(&mut factor).collect();
    Table::new(BAND_FILE)
        .numbers("crack_length_mm", lengths.iter().map(|length| length / MM))
        .numbers("cycles_fitted", cycles.iter().copied())
        .numbers("cycles_low", cycles.iter().zip(&factors).map(|(n, factor)| n / factor))
        .numbers("cycles_high", cycles.iter().zip(&factors).map(|(n, factor)| n * factor))
}

/// The same curves as Parquet beside their constants, and for several specimens quantiles of their cycles.
#[cfg(feature = "tables")]
fn write_tables(folder: &Path, calibration: &CalibrationCase, fit: &Fit) -> Result<()> {
    use crate::frames::{SHARES, cycle_quantiles, fit_curves, specimens};
    use perilife_calibration::results::curves_written;
    use perilife_calibration::search::FittedCurve;
    use perilife_tables::{csv, join_by_specimen, parquet};

    let curves: Vec<FittedCurve> = curves_written(fit).cloned().collect();
    let constants = specimens(&curves)?;
    let joined = join_by_specimen(&fit_curves(&curves)?, &constants)?;
    write_file(&folder.join("fit_curves.parquet"), &parquet(&joined)?)?;
    write_file(&folder.join("specimens.csv"), &csv(&constants)?)?;
    if calibration.curves.len() > 1 {
        let quantiles = cycle_quantiles(&calibration.curves, &fit.record.crack_length, &SHARES)?;
        write_file(&folder.join("quantiles.csv"), &csv(&quantiles)?)?;
    }
    Ok(())
}

#[cfg(not(feature = "tables"))]
fn write_tables(_folder: &Path, _calibration: &CalibrationCase, _fit: &Fit) -> Result<()> {
    Ok(())
}

/// Specimen, material, load and formula for K; `null` if not in the calibration file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestRecord {
    pub specimen_kind: String,
    pub width_mm: f64,
    pub thickness_mm: f64,
    pub material: String,
    pub youngs_modulus_gpa: f64,
    pub yield_strength_mpa: Option<f64>,
    pub load: String,
    pub load_max: String,
    pub stress_ratio: f64,
    pub specimens: usize,
    pub readings: usize,
    pub first_reading_mm: f64,
    pub last_reading_mm: f64,
    pub formula: Option<String>,
    pub formula_source: Option<String>,
    pub formula_range: Option<String>,
    /// As noted above the tables of readings; proposed for the report.
    pub orientation: Option<String>,
    pub environment: Option<String>,
    pub waveform: Option<String>,
}

/// A criterion: requirement, result, whether it is met (`null`: not checked), remark.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Criterion {
    pub name: String,
    pub asked: String,
    pub found: String,
    pub holds: Option<bool>,
    pub remark: String,
}

pub fn test(calibration: &CalibrationCase) -> TestRecord {
    let case = &calibration.case;
    let (specimen, material) = (&case.specimen, &case.material);
    let formula = handbook(specimen);
    let (unit, load) = match specimen.load_measure {
        LoadMeasure::Stress => ("MPa gross stress", case.loading.maximum / MPA),
        LoadMeasure::Force => ("kN", case.loading.maximum / KN),
    };
    let lengths = || calibration.read.iter().flat_map(|curve| curve.crack_length.iter().copied());
    let [orientation, environment, waveform] =
        [0, 1, 2].map(|i| calibration.read.iter().find_map(|curve| curve.source.noted[i].clone()));
    let of_formula = |of: fn(&HandbookFormula) -> &'static str| formula.as_ref().map(|formula| of(formula).to_owned());
    TestRecord {
        specimen_kind: specimen.kind.name().to_owned(),
        width_mm: clean(specimen.width / MM),
        thickness_mm: clean(specimen.thickness / MM),
        material: material.name.clone(),
        youngs_modulus_gpa: clean(material.youngs_modulus / GPA),
        yield_strength_mpa: calibration.yield_strength.map(|strength| clean(strength / MPA)),
        load: loading(case),
        load_max: format!("{} {unit}", clean(load)),
        stress_ratio: case.loading.ratio,
        specimens: calibration.read.len(),
        readings: lengths().count(),
        first_reading_mm: clean(lengths().fold(f64::INFINITY, f64::min) / MM),
        last_reading_mm: clean(lengths().fold(0.0, f64::max) / MM),
        formula: of_formula(|formula| formula.name),
        formula_source: of_formula(|formula| formula.source),
        formula_range: of_formula(|formula| formula.range),
        orientation,
        environment,
        waveform,
    }
}

fn criterion(
    name: &str,
    asked: impl Into<String>,
    found: impl Into<String>,
    holds: Option<bool>,
    remark: impl Into<String>,
) -> Criterion {
    Criterion { name: name.to_owned(), asked: asked.into(), found: found.into(), holds, remark: remark.into() }
}

/// The criteria of ASTM E647 that readings and specimen can be checked against.
pub fn criteria(calibration: &CalibrationCase, left_out: (&[LeaveOut], usize), delta_k: &dyn Fn(f64) -> f64) -> Vec<Criterion> {
    let mut case = calibration.case.clone();
    case.material.yield_strength = calibration.yield_strength;
    let size = checks::of_case(&case).into_iter().find(|check| check.name == "e647_size");
    let size = size.map(|check| {
        let holds = check.verdict == checks::Verdict::Passed;
        let asked = match case.specimen.kind {
            SpecimenKind::CompactTension => "W/20 ≤ B ≤ W/4, a ≥ 0.2 W",
            _ => "B ≤ W/8",
        };
        let remark = if holds { "met".to_owned() } else { check.words };
        let found = format!("B {} mm, W {} mm", clean(case.specimen.thickness / MM), clean(case.specimen.width / MM));
        criterion("Specimen size (7.1, A1.3)", asked, found, Some(holds), remark)
    });
    let mut all: Vec<Criterion> = size.into_iter().collect();
    all.push(ligament(calibration, &case, delta_k));
    all.push(steps(&calibration.read));
    all.push(symmetry(&calibration.read, &case));
    all.push(readings_left_out(left_out, calibration.left_out.len()));
    all
}

fn ligament(calibration: &CalibrationCase, case: &Case, delta_k: &dyn Fn(f64) -> f64) -> Criterion {
    const NAME: &str = "Ligament at the longest crack used (7.2)";
    let (specimen, loading) = (&case.specimen, &case.loading);
    let longest = case.stop.crack_length;
    let rule = match specimen.kind {
        SpecimenKind::MiddleTension => "W − 2a ≥ 1.25 P_max/(B σ_YS)",
        _ => "W − a ≥ (4/π) (K_max/σ_YS)²",
    };
    let Some(ligament) = specimen.ligament(longest) else {
        return criterion(NAME, rule, "unknown", None, "not applicable (no standard specimen)");
    };
    let found = format!("{:.2} mm", ligament / MM);
    let Some(strength) = calibration.yield_strength else {
        return criterion(NAME, rule, found, None, "not checked (no yield strength)");
    };
    let most = calibration.curves.iter().flat_map(|curve| curve.load_factor.iter().copied()).fold(1.0, f64::max);
    let asked = specimen.ligament_asked(most * loading.maximum, most * delta_k(longest) / loading.range_share(), strength);
    let holds = ligament >= asked;
    let remark = if holds { "met" } else { "readings with a smaller ligament are flagged ligament_yields" };
    criterion(NAME, format!("{rule} = {:.2} mm", asked / MM), found, Some(holds), remark)
}

fn steps(curves: &[MeasuredCurve]) -> Criterion {
    let of_curve =
        |curve: &MeasuredCurve| curve.crack_length.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect::<Vec<f64>>();
    let steps: Vec<f64> = curves.iter().flat_map(of_curve).collect();
    let least = steps.iter().copied().fold(f64::INFINITY, f64::min);
    let short = steps.iter().filter(|step| **step < STEP_MIN * (1.0 - 1e-6)).count();
    let remark = if short == 0 {
        "met".to_owned()
    } else {
        format!("{short} of {} increments are shorter; used and flagged", steps.len())
    };
    let found = format!("{:.2} mm", least / MM);
    criterion("Minimum Δa between readings (8.6.2)", "Δa ≥ 0.25 mm", found, Some(short == 0), remark)
}

fn symmetry(curves: &[MeasuredCurve], case: &Case) -> Criterion {
    const NAME: &str = "Front/back crack size difference";
    let specimen = &case.specimen;
    let most = side_difference_max(specimen.kind, specimen.width, specimen.thickness);
    let asked = format!("≤ {:.2} mm", most / MM);
    let found = curves.iter().flat_map(|curve| curve.side_difference.iter().copied()).fold(f64::NAN, f64::max);
    if found.is_nan() {
        return criterion(NAME, asked, "not recorded", None, "not checked (one crack size per reading)");
    }
    let holds = found <= most;
    let remark = if holds { "met" } else { "readings with more are flagged uneven_front" };
    criterion(NAME, asked, format!("{:.2} mm", found / MM), Some(holds), remark)
}

/// Those that the user excluded, and how many others are outside the fit window.
fn readings_left_out((left_out, outside): (&[LeaveOut], usize), by_user: usize) -> Criterion {
    let excluded = if left_out.is_empty() { "none".to_owned() } else { left_out.len().to_string() };
    let found = if outside > 0 { format!("{excluded}; {outside} {OUTSIDE}") } else { excluded };
    let reasons: Vec<String> = left_out.iter().map(|one| format!("{} ({})", one.place(), one.reason)).collect();
    criterion("Excluded readings", "with reason", found, (left_out.len() == by_user).then_some(true), reasons.join("; "))
}
