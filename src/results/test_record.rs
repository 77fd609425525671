//! Test data of a fit for its report: specimen, load, number of readings, criteria of ASTM E647. Keys `test` and `criteria` of `fit.json`.

use serde::{Deserialize, Serialize};

use super::checks;
use super::model_words::{clean, loading};
use perilife_base::units::{GPA, KN, MM, MPA};
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::rates::STEP_MIN;
use perilife_growth::case::Case;
use perilife_measured::{LeaveOut, MeasuredCurve, side_difference_max};
use perilife_plate::specimen::handbook::{HandbookFormula, handbook};
use perilife_plate::specimen::{LoadMeasure, SpecimenKind};

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
    }
}

fn criterion(name: &str, asked: String, found: String, holds: Option<bool>, remark: String) -> Criterion {
    Criterion { name: name.to_owned(), asked, found, holds, remark }
}

/// The criteria of ASTM E647 that readings and specimen can be checked against.
pub fn criteria(calibration: &CalibrationCase, left_out: &[LeaveOut], delta_k: &dyn Fn(f64) -> f64) -> Vec<Criterion> {
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
        criterion("Specimen size (7.1, A1.3)", asked.to_owned(), found, Some(holds), remark)
    });
    let mut all: Vec<Criterion> = size.into_iter().collect();
    all.push(ligament(calibration, &case, delta_k));
    all.push(steps(&calibration.read));
    all.push(symmetry(&calibration.read, &case));
    all.push(readings_left_out(left_out, calibration.left_out.len()));
    all
}

/// Ligament at the longest crack used.
fn ligament(calibration: &CalibrationCase, case: &Case, delta_k: &dyn Fn(f64) -> f64) -> Criterion {
    const NAME: &str = "Ligament at the longest crack used (7.2)";
    let (specimen, loading) = (&case.specimen, &case.loading);
    let longest = case.stop.crack_length;
    let rule = match specimen.kind {
        SpecimenKind::MiddleTension => "W − 2a ≥ 1.25 P_max/(B σ_YS)",
        _ => "W − a ≥ (4/π) (K_max/σ_YS)²",
    };
    let Some(ligament) = specimen.ligament(longest) else {
        return criterion(NAME, rule.to_owned(), "unknown".to_owned(), None, "not applicable (no standard specimen)".to_owned());
    };
    let found = format!("{:.2} mm", ligament / MM);
    let Some(strength) = calibration.yield_strength else {
        return criterion(NAME, rule.to_owned(), found, None, "not checked (no yield strength)".to_owned());
    };
    let most = calibration.curves.iter().flat_map(|curve| curve.load_factor.iter().copied()).fold(1.0, f64::max);
    let asked = specimen.ligament_asked(most * loading.maximum, most * delta_k(longest) / loading.range_share(), strength);
    let holds = ligament >= asked;
    let remark = if holds { "met" } else { "readings with a smaller ligament are flagged ligament_yields" };
    criterion(NAME, format!("{rule} = {:.2} mm", asked / MM), found, Some(holds), remark.to_owned())
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
    criterion(
        "Minimum Δa between readings (8.6.2)",
        "Δa ≥ 0.25 mm".to_owned(),
        format!("{:.2} mm", least / MM),
        Some(short == 0),
        remark,
    )
}

fn symmetry(curves: &[MeasuredCurve], case: &Case) -> Criterion {
    const NAME: &str = "Front/back crack size difference";
    let specimen = &case.specimen;
    let most = side_difference_max(specimen.kind, specimen.width, specimen.thickness);
    let asked = format!("≤ {:.2} mm", most / MM);
    let found = curves.iter().flat_map(|curve| curve.side_difference.iter().copied()).fold(f64::NAN, f64::max);
    if found.is_nan() {
        return criterion(NAME, asked, "not recorded".to_owned(), None, "not checked (one crack size per reading)".to_owned());
    }
    let holds = found <= most;
    let remark = if holds { "met" } else { "readings with more are flagged uneven_front" };
    criterion(NAME, asked, format!("{:.2} mm", found / MM), Some(holds), remark.to_owned())
}

/// `by_user`: number of those that the user excluded.
fn readings_left_out(left_out: &[LeaveOut], by_user: usize) -> Criterion {
    let found = if left_out.is_empty() { "none".to_owned() } else { left_out.len().to_string() };
    let reasons: Vec<String> = left_out.iter().map(|one| format!("{} ({})", one.place(), one.reason)).collect();
    criterion(
        "Excluded readings",
        "with reason".to_owned(),
        found,
        (left_out.len() == by_user).then_some(true),
        reasons.join("; "),
    )
}
