//! The page of a run: life with its band, why it ends, whether it is valid, how wrong it may be as a solution, pictures, case, law, hashes.

use serde_json::Value;

use super::answers::quantile_words;
use super::numbers::{self, by_band, fixed, level, short, sized, whole};
use super::{
    Drawings, Sheets, Signed, answers, figure, hashes, letter, mark, part_through, prose, quoted, recorded, signatures, spectrum,
    terms,
};
use crate::band::interval_of;
use crate::chart::Size;
use crate::pictures::curves::{a_n_svg, end_words, k_svg};
use crate::pictures::plate::{Plate, plate_svg};
use crate::pictures::tables::RunTables;

/// Conditions that do not hold and are printed, at the most.
const CHECKS_MOST: usize = 5;
/// Files whose hashes are printed, at the most.
const HASHES_MOST: usize = 5;
/// Constants of a law that are printed, at the most.
const CONSTANTS_MOST: usize = 8;
/// Size of the plate, px.
const PLATE: Size = Size { width: 365.0, height: 262.0, text: 10.5 };
/// Size of the charts beside it, px.
const CHART: Size = Size { width: 315.0, height: 130.0, text: 10.0 };
/// Reasons to end at which a run was cut off by its model, not by the plate or by what was asked for.
const CUT_OFF: [&str; 4] = ["ligament_unresolved", "left_refinement", "no_growth", "no_convergence"];

/// Figures of the first sheet.
const FIGURES: usize = 3;

/// Title, page and version of the program that ran.
pub fn body(result: &Value, tables: &RunTables, drawings: &Drawings, signed: &Signed) -> (String, String, String) {
    let name = result["name"].as_str().unwrap_or("run");
    let version = result["version"].as_str().unwrap_or("").to_owned();
    let plate: Option<Plate> = result.get("plate").and_then(|plate| serde_json::from_value(plate.clone()).ok());
    let mut page = letter(signed, name, result["finished"].as_str());
    page += &format!("<h1>Crack growth life: {}</h1>\n", quoted(name));
    page += &format!("<p class=\"lead\">{}</p>\n", lead(plate.as_ref()));
    page += &answer(result, tables);
    page += &figures(result, tables, plate.as_ref());
    let law = terms(&law(result));
    page += &format!(
        "<div class=\"cols\"><div><h2>As understood</h2>{}</div><div><h2>Law</h2>{law}</div></div>\n",
        terms(&understood(result, plate.as_ref()))
    );
    page += &checks(result);
    page += &messages(&result["warnings"]);
    page += &signatures(signed, "Computed by");
    let commit = result["commit"]
        .as_str()
        .map_or_else(String::new, |commit| format!(", commit {}", quoted(&commit.chars().take(12).collect::<String>())));
    page += &format!(
        "<p class=\"small quiet\">perilife {}{commit}. Units: mm, MPa, MPa√m, mm/cycle. Input and law as they were read:</p>\n",
        quoted(&version)
    );
    page += &hashes(&result["inputs"], HASHES_MOST);
    let mut sheets = Sheets::begin(drawings, FIGURES);
    page += &spectrum::section(result, &mut sheets);
    page += &part_through::section(result, tables, &mut sheets);
    page += &answers::sections(result, &mut sheets);
    (format!("Crack growth life, {name}"), page, version)
}

fn lead(plate: Option<&Plate>) -> String {
    match plate {
        Some(plate) if !plate.specimen.is_empty() => {
            format!("{}; {}.", quoted(&capital(&plate.specimen)), quoted(&plate.load))
        }
        _ => "Plate and load are not recorded in this result.".to_owned(),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Life, end, validity.
fn answer(result: &Value, tables: &RunTables) -> String {
    let reason = result["stop_reason"].as_str().unwrap_or("");
    let [_, sentence] = end_words(reason);
    let verdict = result["verdict"].as_str();
    let holds = verdict.map(|verdict| verdict.starts_with("stands: ")).filter(|holds| *holds);
    let fails = verdict.is_some_and(|verdict| verdict.starts_with("not to be used")) || result["refused"].is_string();
    let error = match (result["error_estimate_percent"].as_f64(), result["no_error_estimate"].as_str()) {
        (Some(percent), _) => {
            let path = result["path_error_estimate_mm"].as_f64().filter(|path| *path > 0.0);
            let path = path.map_or_else(String::new, |path| format!(", {} mm of the path", short(path)));
            format!("Numerical error at most {} % of life{path}", short(percent))
        }
        (None, Some(why)) => format!("Numerical error not stated: {}", quoted(why)),
        (None, None) => "Numerical error not estimated".to_owned(),
    };
    format!(
        "<div class=\"answer\"><div>{}</div><div><h2>It ends because</h2><p class=\"why\">{sentence}</p><p>{}</p></div>\
         <div><h2>Is it valid?</h2><p>{} {}</p><p>{error}</p></div></div>\n",
        life(result, reason),
        end_length(result, tables),
        mark(if fails { Some(false) } else { holds }),
        recorded(verdict),
    )
}

/// The crack that ends the life, in a plate with several tips; their sum is nobody's crack.
fn leading_crack(result: &Value) -> Option<(usize, [f64; 2])> {
    let tips = result["tips"].as_array().filter(|tips| tips.len() > 1)?;
    let leads = tips.iter().position(|tip| tip["leads"] == true && !tip["crack"].is_null())?;
    let length = |key: &str| tips[leads][key].as_f64();
    Some((leads, [length("crack_length_initial_mm")?, length("crack_length_final_mm")?]))
}

fn end_length(result: &Value, tables: &RunTables) -> String {
    match (leading_crack(result), tables.rows.last()) {
        (Some((tip, [_, last])), _) => format!("crack of tip {tip}: {} mm long", fixed(last, 1)),
        (None, Some(row)) => format!("crack length {} mm", fixed(row.crack_length_mm, 1)),
        (None, None) => String::new(),
    }
}

fn life(result: &Value, reason: &str) -> String {
    let card = |title: &str, value: &str, below: &str| format!("<h2>{title}</h2><p class=\"big\">{value}</p><p>{below}</p>");
    if let Some(refused) = result["refused"].as_str() {
        return card("Life", "none that counts", &quoted(refused));
    }
    let Some(life) = result["life_cycles"].as_f64() else {
        return card("Life", "unlimited", "no crack grows under this load");
    };
    let title = match reason {
        "entered_hole" => "Cycles to the hole",
        "crack_length_reached" | "run_out" => "Cycles to what was asked for",
        _ if CUT_OFF.contains(&reason) => "Cycles to where the computation ends",
        _ if result["life_is_lower_bound"] == true => "Life, at least",
        _ => "Life",
    };
    let cycles = |value: String| format!("{value} <small>cycles</small>");
    if let Some(plates) = result["fleet"]["plates"].as_f64() {
        let [low, middle, high] = ["p05", "p50", "p95"].map(|name| quantile_words(&result["fleet"]["life_cycles"], name));
        let (plates, run) = (whole(plates), whole(life));
        let below = format!("median {middle}, 95 % {high} cycles, {plates} plates; this run, one plate: {run}");
        return card("Life of the fleet, 5 % of plates", &cycles(low), &below);
    }
    let [low, middle, high] = ["cycles_p05", "cycles_p50", "cycles_p95"].map(|key| result["band"][key].as_f64());
    if let (Some(low), Some(middle), Some(high)) = (low, middle, high) {
        let of = |value: f64| by_band(value, &[low, middle, high]);
        let below = format!("9 of 10 plates: {} to {}; the fitted constants alone give {}", of(low), of(high), whole(life));
        return card(&format!("{title}, median"), &cycles(of(middle)), &below);
    }
    let error = result["error_estimate_percent"].as_f64().unwrap_or(1.0) / 100.0;
    let below = match result["no_band"].as_str() {
        Some(why) => format!("no band of plates: {}", quoted(why)),
        None => "no band of plates".to_owned(),
    };
    card(title, &cycles(by_band(life, &[1.0 - error, 1.0, 1.0 + error])), &below)
}

fn figures(result: &Value, tables: &RunTables, plate: Option<&Plate>) -> String {
    let band = if tables.band.is_some() { "; band: 9 of 10 plates" } else { "" };
    let mut figures = String::new();
    figures += &match plate {
        Some(plate) => figure(
            &plate_svg(plate, tables, PLATE),
            "Figure 1. Plate to scale, load, first crack (black) and its way, coloured by cycles; marks at 25, 50, 75 and 90 % of the life.",
            "tall",
        ),
        None => format!("<p class=\"tall\">Figure 1, the plate: {}</p>", recorded(None)),
    };
    figures += &figure(&a_n_svg(result, tables, CHART), &format!("Figure 2. Crack length over cycles{band}."), "");
    figures += &match k_svg(result, tables, CHART) {
        Some(svg) => {
            let hatched = if svg.contains("of the law") { "; hatched: outside the ΔK of the law" } else { "" };
            figure(&svg, &format!("Figure 3. K at maximum load over crack length{hatched}."), "")
        }
        None => format!("<p>Figure 3, K over crack length: {}; bonds drive the crack by their own strain.</p>", recorded(None)),
    };
    format!("<div class=\"figs run\">\n{figures}</div>\n")
}

/// The case as it was understood.
fn understood(result: &Value, plate: Option<&Plate>) -> Vec<(&'static str, String)> {
    let text = |value: Option<&str>| recorded(value);
    let two_decimals = |length: f64| short((100.0 * length).round() / 100.0);
    let lengths = match leading_crack(result) {
        Some((tip, [first, last])) => format!("of tip {tip}: {} mm to {} mm", two_decimals(first), two_decimals(last)),
        None => {
            let [first, last] = ["crack_length_initial_mm", "crack_length_final_mm"]
                .map(|key| result[key].as_f64().map_or("–".to_owned(), two_decimals));
            format!("{first} mm to {last} mm")
        }
    };
    let mut rows = vec![
        ("Specimen", text(plate.map(|plate| &*plate.specimen))),
        ("Material", plate.map_or_else(|| recorded(None), |plate| prose(&plate.material))),
        ("Load", text(plate.map(|plate| &*plate.load))),
        ("Crack length", lengths),
        ("Computed on", model(result)),
    ];
    if let Some(overrides) = result["overrides"].as_array().filter(|overrides| !overrides.is_empty()) {
        let given: Vec<String> = overrides.iter().filter_map(|one| Some(quoted(one.as_str()?))).collect();
        rows.push(("Overrides", given.join(", ")));
    }
    rows
}

fn model(result: &Value) -> String {
    let model = &result["model"];
    let points = result["points"].as_f64().map_or("–".to_owned(), whole);
    let spacing = model["spacing_mm"].as_f64().map_or("–".to_owned(), short);
    match model["method"].as_str() {
        Some("handbook") => format!("formula: {}", recorded(model["formula"].as_str())),
        Some("element_free_galerkin") => format!("{points} nodes at the end (element-free Galerkin)"),
        Some(method) => format!("{points} points, {spacing} mm apart ({})", quoted(method)),
        None => recorded(None),
    }
}

fn law(result: &Value) -> Vec<(&'static str, String)> {
    let law = &result["law"];
    let number = |key: &str| law[key].as_f64().or_else(|| law["record"][key].as_f64());
    let mut rows = Vec::new();
    if let (Some(rate), Some(pivot)) = (number("rate_at_pivot_mm_per_cycle"), number("pivot_delta_k_mpa_sqrt_m")) {
        let error =
            number("rate_at_pivot_relative_error").map_or_else(String::new, |error| format!(" ± {} %", fixed(100.0 * error, 1)));
        rows.push(("Growth rate", format!("{} mm/cycle{error} at ΔK {} MPa√m", numbers::rate(rate, 3), fixed(pivot, 1))));
    }
    if let Some(c) = number("paris_c_used_mm_per_cycle").or(number("paris_c_mm_per_cycle")) {
        rows.push(("C as used", level(c, number("paris_m").or(number("p")), 4)));
    }
    if let Some(m) = number("paris_m").or(number("p")) {
        let error = number("paris_m_error")
            .filter(|error| *error > 0.0)
            .map_or_else(String::new, |error| format!(" ± {}", fixed(error, 2)));
        rows.push(("Exponent m", format!("{}{error}", fixed(m, 3))));
    }
    let constants = law["constants_si"].as_object().or_else(|| law["record"]["fatigue"].as_object());
    for (key, value) in constants.into_iter().flatten().take(CONSTANTS_MOST) {
        let value = match value {
            Value::Number(number) => sized(number.as_f64().unwrap_or(f64::NAN), 4),
            Value::String(text) => quoted(text),
            Value::Array(rows) => format!("{} tables", rows.len()),
            _ => continue,
        };
        rows.push(("Constant", format!("{} {value}", quoted(key))));
    }
    let range = (number("delta_k_min_mpa_sqrt_m"), number("delta_k_max_mpa_sqrt_m"));
    rows.push((
        "Calibrated",
        match range {
            (Some(low), Some(high)) => format!("ΔK {} to {} MPa√m", fixed(low, 1), fixed(high, 1)),
            _ => recorded(None),
        },
    ));
    let band = &result["band"];
    let specimens = band["specimens"].as_u64().map(|count| {
        let assumed = if band["assumed_scatter"] == true { ", scatter assumed" } else { "" };
        format!("{count} specimen{}{assumed}", if count == 1 { "" } else { "s" })
    });
    rows.push((
        "From",
        match law["source"].as_str() {
            Some("fitted") => specimens.unwrap_or_else(|| "a fit; number of specimens not recorded".to_owned()),
            Some("inline") => "constants given in the case".to_owned(),
            other => recorded(other),
        },
    ));
    if let (Some(interval), Some(length)) = (interval_of(result), result["inspection"]["crack_length_mm"].as_f64()) {
        rows.push(("Inspect every", format!("{interval}, from a crack of {} mm", short(length))));
    }
    rows
}

/// Conditions that do not hold, at most five, and the names of those that do.
fn checks(result: &Value) -> String {
    let none = Vec::new();
    let all = result["checks"].as_array().unwrap_or(&none);
    let is_open = |check: &&Value| check["verdict"] != "holds";
    let open: Vec<&Value> = all.iter().filter(is_open).collect();
    let row = |check: &&Value| {
        let holds = if check["verdict"] == "fails" { Some(false) } else { None };
        format!(
            "<tr><td>{} {}</td><td>{}</td><td>{}</td></tr>\n",
            mark(holds),
            prose(check["words"].as_str().unwrap_or("")),
            effect(check),
            quoted(check["remedy"].as_str().unwrap_or(""))
        )
    };
    let mut rows: String = open.iter().take(CHECKS_MOST).map(row).collect();
    if open.len() > CHECKS_MOST {
        rows += &format!("<tr><td colspan=\"3\">and {} more in result.json</td></tr>\n", open.len() - CHECKS_MOST);
    }
    let names: Vec<String> = all
        .iter()
        .filter(|check| !is_open(check))
        .filter_map(|check| check["name"].as_str())
        .map(|name| quoted(&name.replace('_', " ")))
        .collect();
    if !names.is_empty() {
        rows += &format!("<tr><td colspan=\"3\">{} holds: {}</td></tr>\n", mark(Some(true)), names.join(", "));
    }
    format!(
        "<h2>Is it valid?</h2>\n<div class=\"scroll\"><table class=\"checks\"><thead><tr><th>What the life rests on</th><th>Computed life</th><th>What to do</th></tr></thead><tbody>\n\
         {rows}</tbody></table></div>\n"
    )
}

/// Every message of the run, as the console has them.
fn messages(warnings: &Value) -> String {
    let line = |line: &Value| Some(format!("<li>{}</li>\n", prose(line.as_str()?)));
    let lines: String = warnings.as_array().into_iter().flatten().filter_map(line).collect();
    if lines.is_empty() { lines } else { format!("<h2>Messages</h2>\n<ul class=\"small\">\n{lines}</ul>\n") }
}

fn effect(check: &Value) -> String {
    let side = match check["side"].as_str() {
        Some("safe") => "too short",
        Some("unsafe") => "too long",
        Some(_) => "too long or too short",
        None => "",
    };
    match check["effect_percent"].as_f64() {
        Some(percent) => format!("{} %, {side}", short((10.0 * percent.abs()).round() / 10.0)),
        None => format!("not known, {side}"),
    }
}
