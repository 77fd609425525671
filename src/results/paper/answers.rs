//! Sections of a report that not every run has: inspections, fleet, sensitivities, spectrum, part-through crack.

use super::{CHART, Drawings, PRINT, figure, known, number, picture, quoted, recorded, table, terms, text, title};
use crate::answers::{InspectionRow, InspectionsRecord, SensitivityRecord};
use crate::axis::Axis;
use crate::band::{OF_FLEET, every_words, known_within};
use crate::chart::{COMPUTED, Frame, SECOND, Size};
use crate::curve::RunTables;
use crate::fleet::{FleetRecord, words_of};
use crate::format::{chance, within};
use crate::record::{OutsideRange, PartThroughEnds, RunRecord};
use crate::spectrum::SpectrumRecord;
use crate::sweep::LifeQuantiles;
use perilife_base::units::MM;
use perilife_growth::predict::StopReason;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::part_through::SOURCE;

const INSPECTIONS_MOST: usize = 20;

/// Their sections; empty for a run without them.
pub fn sections(run: &RunRecord, drawings: &Drawings) -> String {
    let per_pass = run.spectrum.as_ref().map(|spectrum| spectrum.cycles_per_pass);
    let caption = "Load that the cracked plate can carry against crack length, by fracture and by net-section yield.";
    let strength = picture(drawings, "residual_strength.svg", caption);
    let mut page = if strength.is_empty() { strength } else { title("Residual strength") + &strength };
    page += &run.inspections.as_ref().map_or_else(String::new, |found| inspections(run, found));
    page += &run.fleet.as_ref().map_or_else(String::new, |found| fleet(found, per_pass, drawings));
    page + &run.sensitivities.as_ref().map_or_else(String::new, |all| sensitivities(run, all, drawings))
}

/// A probability; below 1e-3 its bound alone, since no POD curve supports more.
fn probability(value: f64) -> String {
    if value >= 1e-3 { PRINT.fixed(value, 3) } else { chance(value) }
}

fn inspections(run: &RunRecord, found: &InspectionsRecord) -> String {
    let error = run.error_estimate_percent;
    let known = run.inspection.as_ref().map_or_else(|| within(error), |inspection| known_within(inspection, error));
    let row = |row: &InspectionRow| {
        let cycles = PRINT.promised(row.cycles, found.interval_cycles, &known);
        let length = PRINT.length(row.crack_length_mm * MM, 2);
        vec![cycles, length, probability(row.pod), probability(row.missed)]
    };
    let more = match found.rows.len() {
        count if count > INSPECTIONS_MOST => {
            format!("<p class=\"small\">{} more inspections in result.json</p>\n", count - INSPECTIONS_MOST)
        }
        _ => String::new(),
    };
    let has_band = run.inspection.as_ref().is_some_and(|inspection| inspection.has_band);
    let cycles = if has_band { "Cycles (5 % plate)" } else { "Cycles" };
    let head = [cycles, "Crack length", "POD", "Cumulative miss probability"].map(text);
    let table = table("", &head, found.rows.iter().take(INSPECTIONS_MOST).map(row));
    format!(
        "{}<p>Probability that all inspections miss: {} (independence of inspections assumed).</p>\n{table}{more}",
        title("Inspections"),
        probability(found.missed)
    )
}

fn quantiles(of: &LifeQuantiles) -> String {
    let [low, middle, high] = words_of(of, PRINT);
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
            let (first, every) = (PRINT.promised(first, first, &OF_FLEET), every_words(every, &OF_FLEET, per_pass));
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

fn sensitivities(run: &RunRecord, all: &[SensitivityRecord], drawings: &Drawings) -> String {
    let row = |row: &SensitivityRecord| {
        let by_error = |life: f64| PRINT.by_error(life, run.error_estimate_percent);
        let life = row.life_cycles.map_or_else(|| "unlimited".to_owned(), by_error);
        let bound = if row.life_is_lower_bound { "≥ " } else { "" };
        let change = known(row.change_of_life_percent, |change| format!("{} %", PRINT.signed(change, 1)));
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

/// The section; empty for other loads.
pub fn of_spectrum(run: &RunRecord, drawings: &Drawings) -> String {
    let Some(spectrum) = &run.spectrum else { return String::new() };
    let title = title("Spectrum");
    let picture = picture(drawings, "spectrum.svg", "Spectrum (one pass): peak exceedances and range histogram.");
    let (understood, counted) = (terms(&understood(run, spectrum)), terms(&counted(run, spectrum)));
    format!(
        "{title}{picture}<div class=\"cols\"><div><h2>Input</h2>{understood}</div>\
         <div><h2>Load interaction</h2>{counted}</div></div>\n"
    )
}

fn understood(run: &RunRecord, spectrum: &SpectrumRecord) -> Vec<(&'static str, String)> {
    let (short, loading) = (|value: f64| PRINT.short(value), &run.case["loading"]);
    let percent = loading["omission_percent"].as_f64().map(short);
    let (per_pass, omitted) = (spectrum.cycles_per_pass, spectrum.cycles_omitted_per_pass);
    let scale = |(key, unit): (&str, &'static str)| Some((loading[key].as_f64()?, unit));
    let scale = [("spectrum_scale_mpa", "MPa"), ("spectrum_scale_n", "N")].into_iter().find_map(scale);
    let left_out = match percent {
        share if omitted > 0.0 => format!(
            "{} of {} cycles per pass (range below {} % of the largest)",
            short(omitted),
            short(per_pass + omitted),
            share.unwrap_or_else(|| "a share".to_owned())
        ),
        Some(share) => format!("none (all above {share} % of the largest range)"),
        None => "none".to_owned(),
    };
    let cut_off = spectrum
        .truncated_at
        .map_or_else(|| "none".to_owned(), |share| format!("peaks above {} % of the largest in the file", short(100.0 * share)));
    let level = |[level, count]: &[f64; 2]| format!("{} above {} %", short(*count), short(100.0 * level));
    let levels: Vec<String> = spectrum.exceedances.iter().map(level).collect();
    let kinds = PRINT.whole(spectrum.kinds_of_cycles as f64);
    let mut rows = vec![
        ("File", format!("{} ({})", recorded(Some(&spectrum.file)), recorded(Some(&spectrum.format)))),
        ("Pass", format!("{} cycles, {kinds} different", short(per_pass))),
        ("Omitted", left_out),
        ("Clipped", cut_off),
    ];
    rows.extend(scale.map(|(scale, unit)| ("Maximum load", format!("{} {unit}, gross", short(scale * spectrum.largest)))));
    rows.extend([
        ("Minimum load", format!("{} of the maximum", short(spectrum.smallest_over_largest))),
        ("Stress ratios", format!("{} to {}", short(spectrum.stress_ratio_min), short(spectrum.stress_ratio_max))),
        ("Peaks per pass", format!("{} of the maximum", levels.join(", "))),
        ("Passes", spectrum.repeats.map_or_else(|| "repeated to the end".to_owned(), |most| format!("at most {}", short(most)))),
    ]);
    rows
}

/// Retardation model with its constants; life in cycles and passes, and without retardation.
fn counted(run: &RunRecord, spectrum: &SpectrumRecord) -> Vec<(&'static str, String)> {
    let cycles = |cycles: f64| {
        let passes = PRINT.significant(cycles / spectrum.cycles_per_pass, 4, f64::round);
        format!("{} cycles, {passes} passes", PRINT.by_error(cycles, run.error_estimate_percent))
    };
    let mut rows = vec![(
        "Retardation",
        match spectrum.retardation.get("model").and_then(|model| model.as_str()) {
            Some("none") => "none (mean growth rate per pass)".to_owned(),
            other => recorded(other),
        },
    )];
    for (key, value) in spectrum.retardation.iter().filter(|(key, _)| *key != "model") {
        let value = value.as_f64().map_or_else(|| "per cycle".to_owned(), |value| PRINT.sized(value, 4));
        rows.push(("Constant", format!("{} {value}", quoted(key))));
    }
    rows.push(("Life", run.life_cycles.map_or_else(|| "unlimited".to_owned(), cycles)));
    if let Some(mean) =
        spectrum.life_cycles_without_retardation.filter(|mean| *mean > 0.0 && run.stop_reason != StopReason::RunOut)
    {
        let ratio = run
            .life_cycles
            .map_or_else(String::new, |life| format!("; life with retardation = {} × this", PRINT.fixed(life / mean, 2)));
        rows.push(("Without retardation", format!("{}{ratio}", cycles(mean))));
    }
    rows
}

const LENGTHS: Size = Size { width: 2.0 * CHART.width, ..CHART };

/// The section; empty for a through crack.
pub fn of_part_through(run: &RunRecord, tables: &RunTables, drawings: &Drawings) -> String {
    let Some(found) = &run.part_through else { return String::new() };
    let mut page = title("Part-through crack");
    page += &picture(drawings, "section.svg", "Crack front at 0, 25, 50, 75 and 100 % of the cycles (initial front gray).");
    if let Some(svg) = lengths_svg(tables, found.cycles_at_break_through) {
        page += &figure(&svg, "Surface length c and depth a against cycles; a ends at breakthrough.", "wide");
    }
    page + "<h2>Breakthrough and accuracy of K</h2>" + &terms(&rows(run, found))
}

fn rows(run: &RunRecord, found: &PartThroughEnds) -> Vec<(&'static str, String)> {
    let mm = |length: Option<f64>| known(length, |length| format!("{} mm", PRINT.fixed(length, 3)));
    let cycles = |value: f64| format!("{} cycles", PRINT.by_error(value, run.error_estimate_percent));
    let start = format!("a {}, c {}", mm(Some(found.crack_depth_initial_mm)), mm(run.crack_length_initial_mm));
    let (last, share) = (mm(Some(found.crack_depth_final_mm)), PRINT.fixed(found.depth_over_thickness, 3));
    let last = format!("a {last}, a/t = {share}");
    let mut rows = vec![("Kind", quoted(&found.kind.replace('_', " "))), ("Initial crack", start)];
    match found.cycles_at_break_through {
        Some(through) => {
            let length = mm(found.crack_length_at_break_through_mm);
            let left = |life: f64| format!("{} as a through crack", cycles(life - through));
            rows.push(("Breakthrough", format!("after {}: {last}, c {length}", cycles(through))));
            rows.push(("Then", run.life_cycles.map_or_else(String::new, left)));
        }
        None => rows.push(("Breakthrough", format!("not reached; at the end {last}"))),
    }
    rows.push(("Growth rule", quoted(&found.rule)));
    rows.push(("Source of K", quoted(SOURCE)));
    if let Some(shorter) = found.life_cycles_if_k_is_larger.map(cycles) {
        let percent = PRINT.short(found.k_error_percent);
        let longer = found.life_cycles_if_k_is_smaller.map_or_else(|| "unlimited".to_owned(), cycles);
        rows.push(("Stated error of K", format!("K +{percent} %: life {shorter}; K −{percent} %: {longer}")));
    }
    let outside: Vec<String> = found.outside_range.iter().filter_map(outside).collect();
    let outside = if outside.is_empty() { "all".to_owned() } else { format!("all except {}", outside.join(", ")) };
    rows.push(("Life within its range", outside));
    rows
}

fn outside(limit: &OutsideRange) -> Option<String> {
    let [low, high] = limit.range.map(|end| known(end, |end| PRINT.short(end)));
    let share = PRINT.fixed(100.0 * limit.life_share?, 1);
    Some(format!("{share} % ({} outside {low} to {high})", quoted(&limit.of)))
}

/// Both lengths against cycles, labeled at their ends; `None` for tables without depth.
fn lengths_svg(tables: &RunTables, through: Option<f64>) -> Option<String> {
    let depths = tables.depths_mm.as_ref()?;
    let cycles = || tables.rows.iter().map(|row| row.cycles);
    let along: Vec<Point> = tables.rows.iter().map(|row| [row.cycles, row.crack_length_mm]).collect();
    let deep: Vec<Point> = cycles()
        .zip(depths)
        .filter(|(cycles, depth)| depth.is_finite() && through.is_none_or(|end| *cycles <= end))
        .map(|(cycles, depth)| [cycles, *depth])
        .collect();
    let all = along.iter().chain(&deep).map(|point| point[1]).chain([0.0]);
    let axes = [Axis::linear_in(cycles().chain([0.0]), 6.0), Axis::linear_in(all, 5.0)];
    let mut frame = Frame::with_names(LENGTHS, axes, ["Cycles N", "Surface length c and depth a, mm"], 3);
    let lines = [(along, COMPUTED, "", "c"), (deep, SECOND, "6 3", "a")];
    lines.iter().for_each(|(points, colour, dash, _)| frame.line(points, colour, 2.0, dash));
    let end =
        |(points, colour, _, name): &(Vec<Point>, &'static str, _, &str)| Some(((*name).to_owned(), *points.last()?, *colour));
    let names: Vec<(String, Point, &str)> = lines.iter().filter_map(end).collect();
    frame.names(&names, &lines.map(|(points, ..)| points));
    Some(frame.finish("Surface length c and depth a of the crack in mm against cycles"))
}
