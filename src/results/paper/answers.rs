//! Inspections, fleet and sensitivities of a run.

use super::{Drawings, PRINT, known, number, picture, quoted, table, terms, text, title};
use crate::band::every_words;
use crate::fleet::FleetRecord;
use crate::format::chance;
use crate::inspections::{InspectionRow, InspectionsRecord};
use crate::record::RunRecord;
use crate::sensitivities::SensitivityRecord;
use crate::sweep::LifeQuantiles;

/// Largest number of printed inspections.
const INSPECTIONS_MOST: usize = 20;

/// Their sections; empty for a run without them.
pub fn sections(run: &RunRecord, drawings: &Drawings) -> String {
    let per_pass = run.spectrum.as_ref().map(|spectrum| spectrum.cycles_per_pass);
    let mut page = run.inspections.as_ref().map_or_else(String::new, inspections);
    page += &run.fleet.as_ref().map_or_else(String::new, |found| fleet(found, per_pass, drawings));
    page + &run.sensitivities.as_ref().map_or_else(String::new, |all| sensitivities(all, drawings))
}

/// A probability; below 1e-3 its bound alone, since no POD curve supports more.
fn probability(value: f64) -> String {
    if value >= 1e-3 { PRINT.fixed(value, 3) } else { chance(value) }
}

fn inspections(found: &InspectionsRecord) -> String {
    let row = |row: &InspectionRow| {
        vec![PRINT.whole(row.cycles), PRINT.fixed(row.crack_length_mm, 2), probability(row.pod), probability(row.missed)]
    };
    let more = match found.rows.len() {
        count if count > INSPECTIONS_MOST => {
            format!("<p class=\"small\">{} more inspections in result.json</p>\n", count - INSPECTIONS_MOST)
        }
        _ => String::new(),
    };
    let head = ["Cycles", "Crack length, mm", "POD", "Cumulative miss probability"].map(text);
    let table = table("", &head, found.rows.iter().take(INSPECTIONS_MOST).map(row));
    format!(
        "{}<p>Probability that all inspections miss: {} (independence of inspections assumed).</p>\n{table}{more}",
        title("Inspections"),
        probability(found.missed)
    )
}

/// Quantiles in words: 5 %, median, 95 %.
pub(super) fn quantile_words(of: &LifeQuantiles) -> [String; 3] {
    let words = |words: &Option<String>| {
        let words = words.as_deref().unwrap_or("unknown");
        words.parse::<f64>().map_or_else(|_| quoted(words), |value| PRINT.whole(value))
    };
    [words(&of.words.p05), words(&of.words.p50), words(&of.words.p95)]
}

fn quantiles(of: &LifeQuantiles) -> String {
    let [low, middle, high] = quantile_words(of);
    format!("5 % {low}, median {middle}, 95 % {high} cycles")
}

fn fleet(fleet: &FleetRecord, per_pass: Option<f64>, drawings: &Drawings) -> String {
    let laws = match &fleet.one_law_because {
        Some(why) => format!("same for all: {}", quoted(why)),
        None => "sampled from the scatter of the lot".to_owned(),
    };
    let count = |count: usize| PRINT.whole(count as f64);
    let ends = fleet.ended_by.iter().map(|(name, number)| format!("{} {}", quoted(&name.replace('_', " ")), count(*number)));
    let mut rows = vec![
        ("Plates", format!("{}, seed {}", count(fleet.plates), PRINT.whole(fleet.seed as f64))),
        ("Growth law", laws),
        ("Life", quantiles(&fleet.life_cycles)),
        ("No failure", format!("{} unlimited, {} lower bounds", count(fleet.unlimited), count(fleet.lower_bounds))),
        ("Ends by", ends.collect::<Vec<_>>().join(", ")),
    ];
    let mut missed = String::new();
    if let Some(looks) = &fleet.inspections {
        let (left, from) = (quantiles(&looks.detectable_to_critical_cycles), PRINT.short(looks.detectable_mm));
        let words = format!("{left} from a = {from} mm (law, load and critical length of each plate)");
        rows.push(("Detectable to critical", words));
        if looks.break_before_detectable > 0 {
            rows.push(("Fail before a detectable crack", format!("{} plates", count(looks.break_before_detectable))));
        }
        if let (Some(first), Some(before), Some(every)) =
            (looks.first_inspection_cycles, looks.break_before_first_inspection, looks.interval_cycles)
        {
            let (first, every) = (PRINT.whole(first), every_words(every, None, per_pass));
            rows.push(("First inspection", format!("after {first} cycles for all plates; {} plates fail before", count(before))));
            rows.push(("Inspection interval", format!("{every} (5 % remaining life / {})", PRINT.short(looks.factor))));
        }
        if !looks.missed_after.is_empty() {
            let row = |(place, missed): (usize, &f64)| vec![(place + 1).to_string(), probability(*missed)];
            let head = ["Inspection No. (same cycles for all plates)", "Probability of missing the crack (fleet mean)"];
            missed = table("", &head.map(text), looks.missed_after.iter().enumerate().map(row));
        }
    }
    let title = title("Fleet");
    let picture = picture(drawings, "fleet.svg", "Failed share of the fleet against cycles.");
    format!("{title}{picture}{}{missed}", terms(&rows))
}

fn sensitivities(all: &[SensitivityRecord], drawings: &Drawings) -> String {
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
    let head = [text("Input"), text("Change"), number("Life, cycles"), number("Change in life"), text("Ends by")];
    let table = table("", &head, all.iter().map(row));
    let title = title("Sensitivity of the life");
    let picture = picture(drawings, "sensitivities.svg", "Change in life by each input, largest first.");
    format!("{title}{picture}{table}")
}
