//! Stress intensity factors of every crack tip by several methods, and on nodes the stress of the plate, with or without cracks.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Map, Value, json};

use super::{Done, Message, Summary};
use perilife_base::error::{Error, Result, input};
use perilife_base::units::shown::{per, told};
use perilife_base::units::{MM, MPA, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_growth::predict::pin_arcs;
use perilife_growth::predict::tip_factors::{MethodResult, StressIntensityMethod, TipResult, stress_intensity};
use perilife_growth::stress_concentration::stressed;
use perilife_plate::specimen::handbook::handbook_beside;
use perilife_points::crack_tip::TipState;
use perilife_results::{model_words, stresses};

/// Factors of the tips, and stresses where a folder for them is given or there is no crack.
pub(super) fn of(case: &Case, methods: &[StressIntensityMethod], on_nodes: bool, folder: Option<&Path>) -> Result<Summary> {
    if let (Some(folder), false) = (folder, case.specimen.is_through()) {
        let problem = "takes the stress of the plate on nodes, which do not support part-through cracks";
        return Err(input("--out", folder.display(), problem, "remove the option"));
    }
    let has_cracks = case.specimen.tips.iter().any(|tip| !tip.from_slot);
    let (mut found, mut tables, mut lines, mut done) = (Map::new(), String::new(), Vec::new(), Done::Nothing);
    let mut messages = case.warnings.clone();
    if has_cracks || !on_nodes {
        let tips = stress_intensity(case, methods)?;
        messages.extend(notes(case, &tips)?.into_iter().chain(pin_arcs::line(case)));
        let pins = model_words::pins(case);
        if !pins.is_empty() {
            found.insert("pins".to_owned(), json!(pins));
        }
        tables.push_str(&table(case, &tips));
        let is_beside = tips.iter().any(|tip| tip.handbook_k_i.is_some());
        if let Some(formula) = handbook_beside(&case.specimen).filter(|_| is_beside) {
            let words = format!("{}: {}", formula.name, formula.range);
            tables.push_str(&format!("Handbook: {words}\n"));
            found.insert("handbook".to_owned(), words.into());
        }
        found.insert("tips".to_owned(), tips.iter().map(object).collect());
    }
    if folder.is_some() || !has_cracks {
        let stressed = stressed(case)?;
        messages.extend(stresses::warnings(&stressed));
        tables.push_str(&stresses::table(&stressed));
        lines.push(stresses::words(case, &stressed));
        found.insert("stresses".to_owned(), stresses::object(&stressed));
        done = Done::Stresses(Box::new(stressed));
    }
    let mut figures = Value::Object(found.clone());
    figures["name"] = json!(case.name);
    let messages = messages.iter().map(|line| Message::warning(line)).collect();
    Ok(Summary { result: Value::Object(found), figures, printed: tables, lines, messages, done, ..Summary::default() })
}

/// What the methods say of their results, each once.
fn notes(case: &Case, tips: &[TipResult]) -> Result<Vec<String>> {
    let results = || tips.iter().flat_map(|tip| &tip.methods);
    if tips.iter().all(|tip| tip.methods.is_empty()) {
        return Ok(Vec::new());
    }
    if results().all(|result| result.intensity.k_i.is_none()) {
        let why = results().find_map(|result| result.note.as_deref()).unwrap_or("no method gives a factor");
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

fn object(tip: &TipResult) -> Value {
    let mut methods = Map::new();
    for MethodResult { method, intensity, t_stress, is_closed, note, wall_s } in &tip.methods {
        let mut entry = json!({
            "k_i_mpa_sqrt_m": in_mpa(intensity.k_i), "k_ii_mpa_sqrt_m": in_mpa(intensity.k_ii), "wall_s": wall_s
        });
        if *is_closed {
            entry["state"] = json!(TipState::Closed.name());
        }
        if let Some(t_stress) = t_stress {
            entry["t_stress_mpa"] = json!(t_stress / MPA);
        }
        if let Some(note) = note {
            entry["note"] = json!(note);
        }
        methods.insert(method.name().to_owned(), entry);
    }
    let [x, y] = tip.tip.position;
    let mut object = json!({
        "x_mm": x / MM, "y_mm": y / MM, "direction": tip.tip.direction,
        "methods": methods, "handbook_k_i_mpa_sqrt_m": in_mpa(tip.handbook_k_i)
    });
    if let Some(end) = tip.end {
        object["end"] = json!(end.name());
    }
    object
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
