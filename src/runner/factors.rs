//! Stress intensity factors of every crack tip by several methods, and on nodes the stress of the plate, with or without cracks.

use std::fmt::Write as _;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{Done, Summary, Watcher};
use perilife_base::error::{Error, Result, input};
use perilife_base::units::shown::{column, per, told};
use perilife_base::units::{MM, MPA, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_growth::predict::pin_arcs;
use perilife_growth::predict::tip_factors::{MethodResult, StressIntensityMethod, TipResult, stress_intensity};
use perilife_growth::stress_concentration::stressed;
use perilife_plate::specimen::handbook::handbook_beside;
use perilife_points::crack_tip::TipState;
use perilife_results::model_words;
use perilife_results::stresses::{self, StressesRecord};

/// What `sif --json` prints, and `result.json` of a plate on nodes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SifRecord {
    /// Contact of the pins with their holes, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pins: Vec<String>,
    /// The formula beside the methods, and its range.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub handbook: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tips: Option<Vec<TipRecord>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stresses: Option<StressesRecord>,
}

/// K of a tip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TipRecord {
    pub x_mm: f64,
    pub y_mm: f64,
    pub direction: [f64; 2],
    /// A [`MethodRecord`] by the name of each method, in the order asked for.
    pub methods: Map<String, Value>,
    pub handbook_k_i_mpa_sqrt_m: Option<f64>,
    /// Of the front of a part-through crack.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<String>,
}

/// K by one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodRecord {
    pub k_i_mpa_sqrt_m: Option<f64>,
    pub k_ii_mpa_sqrt_m: Option<f64>,
    pub wall_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<TipState>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub t_stress_mpa: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

impl TipRecord {
    fn of(tip: &TipResult) -> Self {
        let method = |result: &MethodResult| MethodRecord {
            k_i_mpa_sqrt_m: in_mpa(result.intensity.k_i),
            k_ii_mpa_sqrt_m: in_mpa(result.intensity.k_ii),
            wall_s: result.wall_s,
            state: result.is_closed.then_some(TipState::Closed),
            t_stress_mpa: result.t_stress.map(|t_stress| t_stress / MPA),
            note: result.note.clone(),
        };
        let named =
            |result: &MethodResult| (result.method.name().to_owned(), serde_json::to_value(method(result)).unwrap_or_default());
        let [x, y] = tip.tip.position;
        TipRecord {
            x_mm: x / MM,
            y_mm: y / MM,
            direction: tip.tip.direction,
            methods: tip.methods.iter().map(named).collect(),
            handbook_k_i_mpa_sqrt_m: in_mpa(tip.handbook_k_i),
            end: tip.end.map(|end| end.name().to_owned()),
        }
    }
}

/// Factors of the tips, and stresses where a folder for them is given or there is no crack.
pub(super) fn of(
    case: &Case,
    methods: &[StressIntensityMethod],
    on_nodes: bool,
    folder: Option<&Path>,
    watcher: &dyn Watcher,
) -> Result<Summary> {
    if let (Some(folder), false) = (folder, case.specimen.is_through()) {
        let problem = "requires nodes, which do not support part-through cracks";
        return Err(input("--out", folder.display(), problem, "remove it"));
    }
    let has_cracks = case.specimen.tips.iter().any(|tip| !tip.from_slot);
    let (mut found, mut tables, mut lines, mut done) = (SifRecord::default(), String::new(), Vec::new(), Done::Nothing);
    if has_cracks || !on_nodes {
        let tips = stress_intensity(case, methods)?;
        for warning in notes(case, &tips)?.into_iter().chain(pin_arcs::line(case)) {
            watcher.warn(&warning);
        }
        found.pins = model_words::pins(case);
        tables.push_str(&table(&tips));
        let is_beside = tips.iter().any(|tip| tip.handbook_k_i.is_some());
        if let Some(formula) = handbook_beside(&case.specimen).filter(|_| is_beside) {
            let words = format!("{}: {}", formula.name, formula.range);
            tables.push_str(&format!("handbook K_I by {words}\n"));
            found.handbook = Some(words);
        }
        found.tips = Some(tips.iter().map(TipRecord::of).collect());
    }
    if folder.is_some() || !has_cracks {
        let stressed = stressed(case)?;
        stresses::warnings(&stressed).iter().for_each(|warning| watcher.warn(warning));
        tables.push_str(&stresses::table(&stressed));
        lines.push(stresses::words(case, &stressed));
        found.stresses = Some(StressesRecord::of(&stressed));
        done = Done::Stresses(Box::new(stressed));
    }
    // Figures and text have a form in JSON.
    let result = serde_json::to_value(found).unwrap_or_default();
    let mut figures = result.clone();
    figures["name"] = case.name.clone().into();
    Ok(Summary { result, figures, printed: tables, lines, refusal: None, done })
}

/// What the methods say of their results, each once.
fn notes(case: &Case, tips: &[TipResult]) -> Result<Vec<String>> {
    let results = || tips.iter().flat_map(|tip| &tip.methods);
    if tips.iter().all(|tip| tip.methods.is_empty()) {
        return Ok(Vec::new());
    }
    if results().all(|result| result.intensity.k_i.is_none()) {
        let why = results().find_map(|result| result.note.as_deref()).unwrap_or("no method gives K");
        return Err(Error::Mechanics(format!("{}: {why}", case.name)));
    }
    let mut said: Vec<String> = Vec::new();
    for words in results().filter_map(|result| Some(format!("{}: {}", result.method, result.note.as_ref()?))) {
        if !said.contains(&words) {
            said.push(words);
        }
    }
    Ok(said)
}

fn in_mpa(factor: Option<f64>) -> Option<f64> {
    factor.map(|k| k / MPA_SQRT_M)
}

/// One line a tip and method, in the units that are shown.
fn table(tips: &[TipResult]) -> String {
    let [x, y] = ["x_mm", "y_mm"].map(column);
    let [k_i, k_ii, t] = ["K_I MPa√m", "K_II MPa√m", "T MPa"].map(told);
    let mut text =
        format!("{x:>10} {y:>10}  {:<14} {k_i:>12} {k_ii:>12} {t:>9} {:>12} {:>8}\n", "method", "handbook K_I", "time s");
    let words = |factor: Option<f64>| in_mpa(factor).map_or_else(|| "-".to_owned(), |k| format!("{:.4}", k * per("MPa√m")));
    for tip in tips {
        let [x, y] = tip.tip.position.map(|metres| metres / MM * per("mm"));
        if let Some(end) = tip.end {
            // Writing to a String cannot fail.
            let k_i = words(tip.handbook_k_i);
            let _ =
                writeln!(text, "{x:>10.4} {y:>10.4}  {:<14} {k_i:>12} {:>12} {:>9} {k_i:>12} {:>8.2}", end.name(), "-", "-", 0.0);
        }
        for result in &tip.methods {
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{x:>10.4} {y:>10.4}  {:<14} {:>12} {:>12} {:>9} {:>12} {:>8.2}",
                result.method,
                words(result.intensity.k_i),
                words(result.intensity.k_ii),
                result.t_stress.map_or_else(|| "-".to_owned(), |t| format!("{:.2}", t / MPA * per("MPa"))),
                words(tip.handbook_k_i),
                result.wall_s
            );
        }
    }
    text
}
