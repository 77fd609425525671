//! What was asked beside the life: inspections, a fleet, sensitivities.

use serde_json::Value;

use super::numbers::{fixed, short, whole};
use super::{Sheets, quoted, terms};
use crate::band::{every_words, interval_of};
use crate::model_words::chance;

/// Inspections that are printed, at the most.
const INSPECTIONS_MOST: usize = 20;

/// The sections of what was asked; nothing where nobody asked.
pub fn sections(result: &Value, sheets: &mut Sheets<'_>) -> String {
    inspections(result, sheets) + &fleet(result, sheets) + &sensitivities(&result["sensitivities"], sheets)
}

/// A probability: as it is, or that it is small.
fn probability(value: f64) -> String {
    if value >= 1e-3 { fixed(value, 3) } else { chance(value) }
}

/// A table of text; cells are markup.
fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let cells = |tag: &str, cells: &[String]| cells.iter().map(|cell| format!("<{tag}>{cell}</{tag}>")).collect::<String>();
    let head = cells("th", &head.iter().map(|&name| name.to_owned()).collect::<Vec<_>>());
    let rows: String = rows.map(|row| format!("<tr>{}</tr>\n", cells("td", &row))).collect();
    format!("<div class=\"scroll\"><table><thead><tr>{head}</tr></thead><tbody>\n{rows}</tbody></table></div>\n")
}

fn inspections(result: &Value, sheets: &mut Sheets<'_>) -> String {
    let (found, window) = (&result["inspections"], &result["inspection"]);
    let Some(rows) = found["rows"].as_array() else { return String::new() };
    let number = |of: &Value, key: &str| of[key].as_f64().unwrap_or(f64::NAN);
    let length = |of: &Value, key: &str| short(number(of, key));
    let mut lines = vec![
        ("Finds", format!("a crack of {} mm with 50 %, of {} mm with 90 %", length(found, "a50_mm"), length(found, "a90_mm"))),
        ("Interval", interval_of(result).unwrap_or_default()),
        ("All miss", format!("with a probability of {}, inspections taken as independent", probability(number(found, "missed")))),
    ];
    if let Some(left) = window["remaining_cycles"].as_f64() {
        let [from, factor] = ["crack_length_mm", "factor"].map(|key| length(window, key));
        let words = format!("{} cycles from {from} mm to the end, over {factor}", whole(left));
        lines.insert(1, ("Detectable to critical", words));
    }
    let row = |row: &Value| {
        let of = |key: &str| number(row, key);
        vec![whole(of("cycles")), fixed(of("crack_length_mm"), 2), probability(of("pod")), probability(of("missed"))]
    };
    let head = ["Cycles", "Crack length, mm", "Found then", "Missed by all so far"];
    let more = if rows.len() > INSPECTIONS_MOST {
        format!("<p class=\"small\">and {} more in result.json</p>\n", rows.len() - INSPECTIONS_MOST)
    } else {
        String::new()
    };
    let table = table(&head, rows.iter().take(INSPECTIONS_MOST).map(row));
    format!("{}{}{table}{more}", sheets.title("Inspections"), terms(&lines))
}

/// A quantile in words.
pub(super) fn quantile_words(of: &Value, name: &str) -> String {
    let words = of["words"][name].as_str().unwrap_or("not known");
    words.parse::<f64>().map_or_else(|_| quoted(words), whole)
}

/// Quantiles in words: 5 %, half, 95 %.
fn quantiles(of: &Value) -> String {
    let [low, middle, high] = ["p05", "p50", "p95"].map(|name| quantile_words(of, name));
    format!("5 % {low}, half {middle}, 95 % {high} cycles")
}

fn fleet(result: &Value, sheets: &mut Sheets<'_>) -> String {
    let (fleet, per_pass) = (&result["fleet"], result["spectrum"]["cycles_per_pass"].as_f64());
    let Some(plates) = fleet["plates"].as_f64() else { return String::new() };
    let laws = match fleet["one_law_because"].as_str() {
        Some(why) => format!("that of the case for all: {}", quoted(why)),
        None => "drawn as specimens of the lot scatter".to_owned(),
    };
    let count = |key: &str| fleet[key].as_f64().map_or_else(|| "–".to_owned(), whole);
    let ends = fleet["ended_by"].as_object().into_iter().flatten();
    let ends: Vec<String> = ends
        .map(|(name, count)| format!("{} {}", quoted(&name.replace('_', " ")), count.as_f64().map_or_else(String::new, whole)))
        .collect();
    let mut rows = vec![
        ("Plates", format!("{}, seed {}", whole(plates), count("seed"))),
        ("Laws", laws),
        ("Ended by", quantiles(&fleet["life_cycles"])),
        ("Not ended", format!("{} unlimited, {} cut off", count("unlimited"), count("lower_bounds"))),
        ("Ends", ends.join(", ")),
    ];
    let looks = &fleet["inspections"];
    if let (Some(length), Some(factor)) = (looks["detectable_mm"].as_f64(), looks["factor"].as_f64()) {
        let (left, from) = (quantiles(&looks["detectable_to_critical_cycles"]), short(length));
        let words = format!("{left}, each plate by its own law, load and critical length, from {from} mm");
        rows.push(("Detectable to critical", words));
        let never = looks["break_before_detectable"].as_f64().filter(|never| *never > 0.0);
        rows.extend(never.map(|never| ("Break before", format!("{} plates", whole(never)))));
        let at = |key: &str| looks[key].as_f64();
        if let Some(first) = at("first_inspection_cycles") {
            let [before, every] = ["break_before_first_inspection", "interval_cycles"].map(|key| at(key).unwrap_or(f64::NAN));
            rows.push(("First inspection", format!("of all after {} cycles; {} break before", whole(first), whole(before))));
            let every = every_words(every, None, per_pass);
            rows.push(("Inspect every", format!("{every}: the 5 % of plates over {}", short(factor))));
        }
    }
    let missed = looks["missed_after"].as_array().filter(|missed| !missed.is_empty());
    let missed = missed.map_or_else(String::new, |missed| {
        let row = |(place, missed): (usize, &Value)| {
            vec![(place + 1).to_string(), missed.as_f64().map_or_else(String::new, probability)]
        };
        table(
            &["Inspections, after the same cycles for all plates", "The crack of a plate is missed by all, mean of the fleet"],
            missed.iter().enumerate().map(row),
        )
    });
    let title = sheets.title("Fleet");
    let picture = sheets.picture("fleet.svg", "Share of the plates of the fleet that have ended");
    format!("{title}{picture}{}{missed}", terms(&rows))
}

fn sensitivities(all: &Value, sheets: &mut Sheets<'_>) -> String {
    let Some(all) = all.as_array().filter(|all| !all.is_empty()) else { return String::new() };
    let row = |row: &Value| {
        let text = |key: &str| quoted(row[key].as_str().unwrap_or(""));
        let life = row["life_cycles"].as_f64().map_or_else(|| "unlimited".to_owned(), whole);
        let bound = if row["life_is_lower_bound"] == true { "≥ " } else { "" };
        let change = row["change_of_life_percent"].as_f64();
        let sign = if change.is_some_and(|change| change > 0.0) { "+" } else { "" };
        let change = change.map_or_else(|| "–".to_owned(), |change| format!("{sign}{} %", fixed(change, 1)));
        vec![text("input"), text("change"), format!("{bound}{life}"), change, text("ended_by").replace('_', " ")]
    };
    let table = table(&["Input", "Change", "Life, cycles", "Of the life", "Ends by"], all.iter().map(row));
    let title = sheets.title("What moves the life most");
    let picture = sheets.picture("sensitivities.svg", "Change of the life by each input, the widest on top");
    format!("{title}{picture}{table}")
}
