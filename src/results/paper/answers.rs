//! What was asked beside the life: inspections, a fleet, sensitivities.

use super::{PRINT, Sheets, known, quoted, terms};
use crate::band::{every_words, interval_words};
use crate::fleet::FleetRecord;
use crate::format::chance;
use crate::inspections::{InspectionRow, InspectionsRecord};
use crate::record::RunRecord;
use crate::sensitivities::SensitivityRecord;
use crate::sweep::LifeQuantiles;
use perilife_calibration::inspection::Inspection;

/// Inspections that are printed, at the most.
const INSPECTIONS_MOST: usize = 20;

/// The sections of what was asked; nothing where nobody asked.
pub fn sections(run: &RunRecord, sheets: &mut Sheets<'_>) -> String {
    let per_pass = run.spectrum.as_ref().map(|spectrum| spectrum.cycles_per_pass);
    let looked = run.inspections.as_ref().zip(run.inspection.as_ref());
    let mut page = looked.map_or_else(String::new, |(found, window)| inspections(found, window, per_pass, sheets));
    page += &run.fleet.as_ref().map_or_else(String::new, |found| fleet(found, per_pass, sheets));
    page + &run.sensitivities.as_ref().map_or_else(String::new, |all| sensitivities(all, sheets))
}

/// A probability: as it is, or that it is small.
fn probability(value: f64) -> String {
    if value >= 1e-3 { PRINT.fixed(value, 3) } else { chance(value) }
}

/// A table of text; cells are markup.
fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let cells = |tag: &str, cells: &[String]| cells.iter().map(|cell| format!("<{tag}>{cell}</{tag}>")).collect::<String>();
    let head = cells("th", &head.iter().map(|&name| name.to_owned()).collect::<Vec<_>>());
    let rows: String = rows.map(|row| format!("<tr>{}</tr>\n", cells("td", &row))).collect();
    format!("<div class=\"scroll\"><table><thead><tr>{head}</tr></thead><tbody>\n{rows}</tbody></table></div>\n")
}

fn inspections(found: &InspectionsRecord, window: &Inspection, per_pass: Option<f64>, sheets: &mut Sheets<'_>) -> String {
    let [half, most, from, factor] =
        [found.a50_mm, found.a90_mm, window.crack_length_mm, window.factor].map(|value| PRINT.short(value));
    let left = PRINT.whole(window.remaining_cycles);
    let lines = [
        ("Finds", format!("a crack of {half} mm with 50 %, of {most} mm with 90 %")),
        ("Detectable to critical", format!("{left} cycles from {from} mm to the end, over {factor}")),
        ("Interval", interval_words(window, per_pass)),
        ("All miss", format!("with a probability of {}, inspections taken as independent", probability(found.missed))),
    ];
    let row = |row: &InspectionRow| {
        vec![PRINT.whole(row.cycles), PRINT.fixed(row.crack_length_mm, 2), probability(row.pod), probability(row.missed)]
    };
    let more = match found.rows.len() {
        count if count > INSPECTIONS_MOST => {
            format!("<p class=\"small\">and {} more in result.json</p>\n", count - INSPECTIONS_MOST)
        }
        _ => String::new(),
    };
    let head = ["Cycles", "Crack length, mm", "Found then", "Missed by all so far"];
    let table = table(&head, found.rows.iter().take(INSPECTIONS_MOST).map(row));
    format!("{}{}{table}{more}", sheets.title("Inspections"), terms(&lines))
}

/// Quantiles in words: 5 %, median, 95 %.
pub(super) fn quantile_words(of: &LifeQuantiles) -> [String; 3] {
    let words = |words: &Option<String>| {
        let words = words.as_deref().unwrap_or("not known");
        words.parse::<f64>().map_or_else(|_| quoted(words), |value| PRINT.whole(value))
    };
    [words(&of.words.p05), words(&of.words.p50), words(&of.words.p95)]
}

fn quantiles(of: &LifeQuantiles) -> String {
    let [low, middle, high] = quantile_words(of);
    format!("5 % {low}, half {middle}, 95 % {high} cycles")
}

fn fleet(fleet: &FleetRecord, per_pass: Option<f64>, sheets: &mut Sheets<'_>) -> String {
    let laws = match &fleet.one_law_because {
        Some(why) => format!("that of the case for all: {}", quoted(why)),
        None => "drawn as specimens of the lot scatter".to_owned(),
    };
    let count = |count: usize| PRINT.whole(count as f64);
    let ends = fleet.ended_by.iter().map(|(name, number)| format!("{} {}", quoted(&name.replace('_', " ")), count(*number)));
    let mut rows = vec![
        ("Plates", format!("{}, seed {}", count(fleet.plates), PRINT.whole(fleet.seed as f64))),
        ("Laws", laws),
        ("Ended by", quantiles(&fleet.life_cycles)),
        ("Not ended", format!("{} unlimited, {} cut off", count(fleet.unlimited), count(fleet.lower_bounds))),
        ("Ends", ends.collect::<Vec<_>>().join(", ")),
    ];
    let mut missed = String::new();
    if let Some(looks) = &fleet.inspections {
        let (left, from) = (quantiles(&looks.detectable_to_critical_cycles), PRINT.short(looks.detectable_mm));
        let words = format!("{left}, each plate by its own law, load and critical length, from {from} mm");
        rows.push(("Detectable to critical", words));
        if looks.break_before_detectable > 0 {
            rows.push(("Break before", format!("{} plates", count(looks.break_before_detectable))));
        }
        if let (Some(first), Some(before), Some(every)) =
            (looks.first_inspection_cycles, looks.break_before_first_inspection, looks.interval_cycles)
        {
            let (first, every) = (PRINT.whole(first), every_words(every, None, per_pass));
            rows.push(("First inspection", format!("of all after {first} cycles; {} break before", count(before))));
            rows.push(("Inspect every", format!("{every}: the 5 % of plates over {}", PRINT.short(looks.factor))));
        }
        if !looks.missed_after.is_empty() {
            let row = |(place, missed): (usize, &f64)| vec![(place + 1).to_string(), probability(*missed)];
            let head =
                ["Inspections, after the same cycles for all plates", "The crack of a plate is missed by all, mean of the fleet"];
            missed = table(&head, looks.missed_after.iter().enumerate().map(row));
        }
    }
    let title = sheets.title("Fleet");
    let picture = sheets.picture("fleet.svg", "Share of the plates of the fleet that have ended");
    format!("{title}{picture}{}{missed}", terms(&rows))
}

fn sensitivities(all: &[SensitivityRecord], sheets: &mut Sheets<'_>) -> String {
    let row = |row: &SensitivityRecord| {
        let life = row.life_cycles.map_or_else(|| "unlimited".to_owned(), |life| PRINT.whole(life));
        let bound = if row.life_is_lower_bound { "≥ " } else { "" };
        let change = known(row.change_of_life_percent, |change| {
            format!("{}{} %", if change > 0.0 { "+" } else { "" }, PRINT.fixed(change, 1))
        });
        let [input, by] = [&row.input, &row.change].map(|text| quoted(text));
        vec![input, by, format!("{bound}{life}"), change, row.ended_by.name().replace('_', " ")]
    };
    if all.is_empty() {
        return String::new();
    }
    let table = table(&["Input", "Change", "Life, cycles", "Of the life", "Ends by"], all.iter().map(row));
    let title = sheets.title("What moves the life most");
    let picture = sheets.picture("sensitivities.svg", "Change of the life by each input, the widest on top");
    format!("{title}{picture}{table}")
}
