//! Stress intensity factors of every crack tip by several methods, or over crack length, and on nodes the stress of the plate.

use std::fmt::Write as _;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::{Done, Message, Summary};
use perilife_base::error::{Error, Result, fail_if, input};
use perilife_base::input::{Document, LENGTH};
use perilife_base::units::shown::{length_given, per, told};
use perilife_base::units::{MM, MPA, MPA_SQRT_M, round_off};
use perilife_growth::case::{Case, needs};
use perilife_growth::predict::pin_arcs;
use perilife_growth::predict::tip_factors::{MethodResult, StressIntensityMethod, TipResult, stress_intensity};
use perilife_growth::stress_concentration::stressed;
use perilife_plate::specimen::SpecimenKind;
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
    #[serde(skip_serializing_if = "Option::is_none")]
    pub handbook: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tips: Option<Vec<TipRecord>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stresses: Option<StressesRecord>,
}

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
        let named = |result: &MethodResult| (result.method.name().to_owned(), json!(method(result)));
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
pub(super) fn of(case: &Case, methods: &[StressIntensityMethod], on_nodes: bool, folder: Option<&Path>) -> Result<Summary> {
    if let (Some(folder), false) = (folder, case.specimen.is_through()) {
        let problem = "takes the stress of the plate on nodes, which do not support part-through cracks";
        return Err(input("--out", folder.display(), problem, "remove the option"));
    }
    let has_cracks = case.specimen.tips.iter().any(|tip| !tip.from_slot);
    let (mut found, mut tables, mut lines, mut done) = (SifRecord::default(), String::new(), Vec::new(), Done::Nothing);
    let mut messages = case.warnings.clone();
    if has_cracks || !on_nodes {
        let tips = stress_intensity(case, methods)?;
        messages.extend(notes(case, &tips)?.into_iter().chain(pin_arcs::line(case)));
        found.pins = model_words::pins(case);
        tables.push_str(&table(case, &tips));
        let is_beside = tips.iter().any(|tip| tip.handbook_k_i.is_some());
        if let Some(formula) = handbook_beside(&case.specimen).filter(|_| is_beside) {
            let words = format!("{}: {}", formula.name, formula.range);
            tables.push_str(&format!("Handbook: {words}\n"));
            found.handbook = Some(words);
        }
        found.tips = Some(tips.iter().map(TipRecord::of).collect());
    }
    if folder.is_some() || !has_cracks {
        let stressed = stressed(case)?;
        messages.extend(stresses::warnings(&stressed));
        tables.push_str(&stresses::table(&stressed));
        lines.push(stresses::words(case, &stressed));
        found.stresses = Some(StressesRecord::of(&stressed));
        done = Done::Stresses(Box::new(stressed));
    }
    let result = json!(found);
    let mut figures = result.clone();
    figures["name"] = case.name.clone().into();
    let messages = messages.iter().map(|line| Message::warning(line)).collect();
    Ok(Summary { result, figures, printed: tables, lines, messages, done, ..Summary::default() })
}

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
    for words in results().filter_map(|result| Some(format!("methods: {}: {}", result.method, result.note.as_ref()?))) {
        if !said.contains(&words) {
            said.push(words);
        }
    }
    Ok(said)
}

fn in_mpa(factor: Option<f64>) -> Option<f64> {
    factor.map(|k| k / MPA_SQRT_M)
}

/// By how much the methods differ in K_I, as a share of the largest, over all tips; `None` of a single method.
fn spread(tips: &[TipResult]) -> Option<f64> {
    let of_tip = |tip: &TipResult| {
        let factors = || tip.methods.iter().filter_map(|result| result.intensity.k_i);
        let [low, high] = [factors().reduce(f64::min)?, factors().reduce(f64::max)?];
        (factors().count() > 1 && high > 0.0).then(|| (high - low) / high)
    };
    tips.iter().filter_map(of_tip).reduce(f64::max)
}

/// One line a tip and method, in the units that are shown.
fn table(case: &Case, tips: &[TipResult]) -> String {
    let agree = spread(tips).map_or_else(String::new, |share| format!("; methods agree within {:.1} % in K_I", 100.0 * share));
    let [x, y, k, t] = ["x, mm", "y, mm", "MPa√m", "MPa"].map(told);
    let name = |method: StressIntensityMethod| match method {
        StressIntensityMethod::ElementFreeGalerkin => "nodes",
        other => other.name(),
    };
    let mut text = format!(
        "{}: K at maximum load{agree}\ntip {x:>8} {y:>8}  {:<8} {:>10} {:>10} {:>9} {:>14}\n{:>42} {k:>10} {t:>9} {k:>14}\n",
        case.name, "method", "K_I", "K_II", "T", "handbook K_I", k
    );
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
    let words = |factor: Option<f64>| number(in_mpa(factor).map(|k| k * per("MPa√m")));
    for (index, tip) in tips.iter().enumerate() {
        let [x, y] = tip.tip.position.map(|metres| metres / MM * per("mm"));
        let handbook = words(tip.handbook_k_i);
        let mut line = |method: &str, k_i: &str, k_ii: &str, t: &str| {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{index:>3} {x:>8.2} {y:>8.2}  {method:<8} {k_i:>10} {k_ii:>10} {t:>9} {handbook:>14}");
        };
        if let Some(end) = tip.end {
            line(end.name(), &handbook, "–", "–");
        }
        for result in tip.methods.iter().filter(|result| result.intensity.k_i.is_some()) {
            let t_stress = result.t_stress.map_or_else(|| "–".to_owned(), |t| format!("{:.2}", t / MPA * per("MPa")));
            line(name(result.method), &words(result.intensity.k_i), &words(result.intensity.k_ii), &t_stress);
        }
    }
    text
}

const KEY: &str = "--sweep";
const LENGTHS_MOST: f64 = 10_000.0;
/// Share of a step by which the last one may fall short.
const SLACK: f64 = 1e-6;

/// The lengths, m, of `first:last:step`, each as [`length_given`]; the last one is always among them.
/// Errors: [`perilife_base::error::Error::Input`] on the option.
pub fn lengths(asked: &str) -> Result<Vec<f64>> {
    let refuse = |problem: &str| input(KEY, asked, problem, "give first:last:step, such as 10:40:1 or 0.4in:1.6in:0.05in");
    let numbers = asked.split(':').map(|part| Some(round_off(length_given(part)? / MM))).collect::<Option<Vec<f64>>>();
    let Some([first, last, step]) = numbers.as_deref() else { return Err(refuse("is not three lengths")) };
    for number in [first, last, step] {
        LENGTH.read(KEY, *number)?;
    }
    fail_if!(first >= last, refuse("must increase"));
    let steps = ((last - first) / step - SLACK).ceil();
    fail_if!(steps > LENGTHS_MOST, refuse("has more than 10000 lengths"));
    let length = |i: usize| if i as f64 >= steps { *last } else { first + i as f64 * step };
    Ok((0..=steps as usize).map(|i| length(i) * MM).collect())
}

/// The case of a document whose crack is to be followed from the first of these lengths, m; where it stops is not looked at.
/// Errors: wrong input; a plate that this machine has no memory for.
pub fn case(document: &Document, lengths: &[f64]) -> Result<Case> {
    let mut start = document.clone();
    start.table.remove("stop");
    let kind = start.table.get("specimen").and_then(|specimen| specimen.get("kind")).and_then(toml::Value::as_str);
    if kind.and_then(|kind| kind.parse().ok()).is_some_and(|kind: SpecimenKind| kind.sharing().is_some())
        && let Some(specimen) = start.table.get_mut("specimen").and_then(toml::Value::as_table_mut)
    {
        specimen.insert("crack_length_mm".to_owned(), toml::Value::Float(lengths[0] / MM));
    }
    let case = Case::plate_of(&start)?;
    needs::of_case(&case).within_machine().map_err(|error| document.locate(error))?;
    Ok(case)
}
