//! The report of a run: life with its band, failure mode, validity, numerical error, inspection interval, pictures, case, law, hashes.

use serde_json::Value;

use super::{
    Drawings, PRINT, Signed, answers, cards, figure, hashes, known, letter, mark, prose, quoted, recorded, signatures, software,
    table, terms, text,
};
use crate::band::{OF_FLEET, every_words, interval_words};
use crate::chart::Size;
use crate::checks::{Check, Side, Validity, Verdict};
use crate::curve::RunTables;
use crate::fleet::{FleetInspections, words_of};
use crate::pictures::curves::{a_n_svg, end_words, k_svg, length_name};
use crate::pictures::plate::{Plate, plate_svg};
use crate::record::RunRecord;
use perilife_base::units::MM;
use perilife_growth::predict::StopReason;

/// Largest number of files with printed hashes.
const HASHES_MOST: usize = 5;
/// Largest number of printed constants of a law.
const CONSTANTS_MOST: usize = 8;
const PLATE: Size = Size { width: 365.0, height: 236.0, text: 10.5 };
/// Size of the charts beside it, px.
const CHART: Size = Size { width: 315.0, height: 118.0, text: 10.0 };

/// Title, page, and version of the program that ran.
pub fn body(run: &RunRecord, tables: &RunTables, drawings: &Drawings, signed: &Signed) -> (String, String, String) {
    let (name, plate) = (&run.name, run.plate.as_ref());
    let mut page = letter(signed, run.made_by.finished.as_deref());
    page += &format!("<h1>Crack growth life: {}</h1>\n", quoted(name));
    page += &format!("<p class=\"lead\">{}</p>\n", lead(plate));
    page += &answer(run, tables);
    page += &interval(run);
    page += &figures(run, tables, plate);
    let law = terms(&law(run));
    page += &format!(
        "<div class=\"cols\"><div><h2>Input</h2>{}</div><div><h2>Growth law</h2>{law}</div></div>\n",
        terms(&understood(run, plate))
    );
    page += &checks(run);
    page += &messages(&run.warnings);
    page += &signatures(signed, "Prepared by");
    page += &software(&run.version, run.made_by.commit.as_deref());
    page += &hashes(run.made_by.inputs.iter().map(|file| (&*file.file, &*file.sha256)), HASHES_MOST);
    page += &answers::of_spectrum(run, drawings);
    page += &answers::of_part_through(run, tables, drawings);
    page += &answers::sections(run, drawings);
    (format!("Crack growth life, {name}"), page, run.version.clone())
}

fn lead(plate: Option<&Plate>) -> String {
    match plate {
        Some(plate) if !plate.specimen.is_empty() => {
            format!("{}; {}.", quoted(&plate.specimen), quoted(&plate.load))
        }
        _ => "Plate and load: not recorded.".to_owned(),
    }
}

/// The answer: life, end of analysis, validity with the numerical error.
fn answer(run: &RunRecord, tables: &RunTables) -> String {
    let [_, sentence] = end_words(run.stop_reason);
    let holds = match run.verdict_kind {
        Validity::NotValid => Some(false),
        Validity::Reservations => None,
        Validity::Valid => Some(true),
    };
    let error = match (run.error_estimate_percent, &run.no_error_estimate) {
        (Some(percent), _) => {
            let path = run.path_error_estimate_mm.filter(|path| *path > 0.0);
            let path = path.map_or_else(String::new, |path| format!(", {} mm of path", PRINT.short(path)));
            format!("Numerical error ≤ {} % of life{path} (estimate)", PRINT.short(percent))
        }
        (None, Some(why)) => format!("Numerical error not estimated: {}", quoted(why)),
        (None, None) => "Numerical error not estimated".to_owned(),
    };
    format!(
        "<div class=\"answer\"><div>{}</div><div><h2>End of analysis</h2><p class=\"why\">{}</p><p>{}</p></div>\
         <div><h2>Validity</h2><p>{} {}</p><p>{error}</p></div></div>\n",
        life(run),
        prose(sentence),
        end_length(run, tables),
        mark(holds),
        recorded(Some(&run.verdict)),
    )
}

/// Card of the inspection interval, that of the fleet where there is one; empty without inspections.
fn interval(run: &RunRecord) -> String {
    let Some(inspection) = &run.inspection else { return String::new() };
    let per_pass = run.spectrum.as_ref().map(|spectrum| spectrum.cycles_per_pass);
    let looks = run.fleet.as_ref().and_then(|fleet| fleet.inspections.as_ref());
    let of_fleet = looks.and_then(FleetInspections::interval);
    let of_run = || interval_words(inspection, per_pass, run.error_estimate_percent);
    let every = of_fleet.map_or_else(of_run, |every| every_words(every, &OF_FLEET, per_pass));
    let rule = if inspection.has_band || of_fleet.is_some() { "5 % remaining life" } else { "remaining life" };
    let [from, factor] = [inspection.crack_length_mm, inspection.factor].map(|value| PRINT.short(value));
    let pod = run.inspections.as_ref().map_or_else(String::new, |found| {
        format!("POD: a50 = {} mm, a90 = {} mm", PRINT.short(found.a50_mm), PRINT.short(found.a90_mm))
    });
    let (left, band) = match (looks, inspection.quantiles()) {
        (Some(looks), _) => {
            let [low, middle, high] = words_of(&looks.detectable_to_critical_cycles, PRINT);
            (middle, format!("median; 5 % to 95 % of plates: {low} to {high} cycles"))
        }
        (None, Some(all)) => {
            let [low, middle, high] = all.map(|cycles| PRINT.by_band(cycles, &all));
            (middle, format!("median; 90 % band: {low} to {high} cycles"))
        }
        (None, None) => {
            (PRINT.by_error(inspection.remaining_cycles, run.error_estimate_percent), "scatter band not available".to_owned())
        }
    };
    let least = if inspection.life_is_lower_bound && looks.is_none() { "≥ " } else { "" };
    cards(
        "interval",
        [
            ("Inspection interval", every, format!("{rule} / {factor}")),
            ("Detectable crack length", format!("{from} mm"), pod),
            ("Remaining life from there", format!("{least}{left} <small>cycles</small>"), band),
        ],
    )
}

/// A crack length, mm, with its unit.
fn length(millimetres: f64) -> String {
    PRINT.length(millimetres * MM, 2)
}

fn end_length(run: &RunRecord, tables: &RunTables) -> String {
    match (run.leading_crack(), tables.rows.last()) {
        (Some((tip, [_, last])), _) => format!("governing crack (tip {tip}): {}", length(last)),
        (None, Some(row)) => format!("crack length {}", length(row.crack_length_mm)),
        (None, None) => String::new(),
    }
}

fn life(run: &RunRecord) -> String {
    let card = |title: &str, value: &str, below: &str| format!("<h2>{title}</h2><p class=\"big\">{value}</p><p>{below}</p>");
    if let Some(refused) = &run.refused {
        return card("Life", "no valid life", &quoted(refused));
    }
    let Some(life) = run.life_cycles else { return card("Life", "unlimited", "no crack grows under this load") };
    let title = match run.stop_reason {
        StopReason::EnteredHole => "Cycles until the crack enters the hole",
        StopReason::CrackLengthReached => "Cycles to the crack length limit",
        StopReason::CrackDepthReached => "Cycles to the crack depth limit",
        StopReason::RunOut => "Cycles to the cycle limit (run-out)",
        // The model stopped, not the plate.
        StopReason::LigamentUnresolved | StopReason::NoGrowth | StopReason::NoConvergence | StopReason::Stopped => {
            "Cycles computed (analysis stopped early)"
        }
        _ if run.life_is_lower_bound => "Life (lower bound)",
        _ => "Life",
    };
    let cycles = |value: &str| format!("{value} <small>cycles</small>");
    if let Some(fleet) = &run.fleet {
        let [low, middle, high] = words_of(&fleet.life_cycles, PRINT);
        let (plates, run) = (PRINT.whole(fleet.plates as f64), PRINT.by_error(life, run.error_estimate_percent));
        let below = format!("median {middle}, 95 % {high} cycles, {plates} plates; nominal inputs: {run}");
        return card("Fleet life, 5 % of plates", &cycles(&low), &below);
    }
    if let Some(band) = &run.band {
        let [low, middle, high] = band.cycles().map(|value| PRINT.by_band(value, &band.cycles()));
        let below = format!("90 % band: {low} to {high} cycles; fitted law alone: {}", PRINT.by_band(life, &band.cycles()));
        return card(&format!("{title}, median"), &cycles(&middle), &below);
    }
    let below = match &run.no_band {
        Some(why) => format!("scatter band not available: {}", quoted(why)),
        None => "scatter band not available".to_owned(),
    };
    card(title, &cycles(&PRINT.by_error(life, run.error_estimate_percent)), &below)
}

fn figures(run: &RunRecord, tables: &RunTables, plate: Option<&Plate>) -> String {
    let band = if tables.band.is_some() { " (90 % band shaded)" } else { "" };
    let mut figures = match plate {
        Some(plate) => figure(
            &plate_svg(plate, tables, PLATE),
            "Plate, load, initial crack (black) and crack path, colored by cycles; circles at 25, 50, 75 and 90 % of life.",
            "tall",
        ),
        None => format!("<p class=\"tall\">Plate: {}</p>", recorded(None)),
    };
    if tables.rows.len() < 2 {
        return format!("<div class=\"figs run\">\n{figures}<p>No crack grew.</p></div>\n");
    }
    let over = length_name(run, tables);
    figures += &figure(&a_n_svg(run, tables, CHART), &format!("{over} against cycles{band}."), "");
    figures += &match k_svg(run, tables, CHART) {
        Some(svg) => {
            let hatched = if run.law.range().is_some() { " (hatched where outside the tested ΔK)" } else { "" };
            figure(&svg, &format!("K at maximum load against {}{hatched}.", over.to_lowercase()), "")
        }
        None => format!("<p>K against crack length: {} (growth driven by bond failure).</p>", recorded(None)),
    };
    format!("<div class=\"figs run\">\n{figures}</div>\n")
}

fn understood(run: &RunRecord, plate: Option<&Plate>) -> Vec<(&'static str, String)> {
    let lengths = match run.leading_crack() {
        Some((tip, [first, last])) => format!("{} to {} (governing crack, tip {tip})", length(first), length(last)),
        None => {
            let [first, last] = [run.crack_length_initial_mm, run.crack_length_final_mm].map(|one| known(one, length));
            format!("{first} to {last}")
        }
    };
    let mut rows = vec![
        ("Specimen", recorded(plate.map(|plate| &*plate.specimen))),
        ("Material", plate.map_or_else(|| recorded(None), |plate| prose(&plate.material))),
        ("Load", recorded(plate.map(|plate| &*plate.load))),
        ("Crack length", lengths),
        ("Method", model(run)),
    ];
    let given: Vec<String> = run.made_by.overrides.iter().map(|one| quoted(one)).collect();
    if !given.is_empty() {
        rows.push(("Overrides", given.join(", ")));
    }
    rows
}

/// Method of K; of a part-through crack with breakthrough both methods, with their shares of the life.
fn model(run: &RunRecord) -> String {
    let text = |key: &str| run.model.get(key).and_then(Value::as_str);
    let points = PRINT.whole(run.points as f64);
    match text("method") {
        Some("handbook") => {
            let formula = format!("handbook K: {}", recorded(text("formula")));
            let through = run.part_through.as_ref().and_then(|found| found.cycles_at_break_through).zip(run.life_cycles);
            match through.filter(|(through, life)| through < life && run.points > 0) {
                Some((through, life)) => {
                    let share = |cycles: f64| PRINT.fixed(100.0 * cycles / life, 0);
                    let (before, behind) = (share(through), share(life - through));
                    format!("{formula} ({before} % of life), then {points} nodes, element-free Galerkin ({behind} %)")
                }
                None => formula,
            }
        }
        Some("element_free_galerkin") => format!("element-free Galerkin, {points} nodes at the end of the analysis"),
        Some(method) => {
            let spacing = run.model.get("spacing_mm").and_then(Value::as_f64);
            let spacing = known(spacing, |spacing| PRINT.short(spacing));
            format!("{}, {points} points, spacing {spacing} mm", quoted(method))
        }
        None => recorded(None),
    }
}

fn law(run: &RunRecord) -> Vec<(&'static str, String)> {
    let law = &run.law;
    let mut rows = Vec::new();
    if let (Some(rate), Some(pivot)) = (law.rate_at_pivot_mm_per_cycle, law.pivot_delta_k_mpa_sqrt_m) {
        let error = law
            .rate_at_pivot_relative_error
            .map_or_else(String::new, |error| format!(" ± {} %", PRINT.significant(100.0 * error, 2, f64::round)));
        rows.push((
            "Crack growth rate",
            format!("{} mm/cycle{error} at ΔK {} MPa√m", PRINT.rate(rate, 4), PRINT.fixed(pivot, 2)),
        ));
    }
    let exponent = law.paris_m.or(law.p);
    if let Some(c) = law.paris_c_used_mm_per_cycle.or(law.paris_c_mm_per_cycle) {
        rows.push(("Paris constant C", PRINT.level(c, exponent, 4)));
    }
    rows.extend(exponent.map(|m| ("Paris exponent m", PRINT.with_error(m, law.paris_m_error))));
    let of_record = law.record.as_ref().and_then(|record| serde_json::to_value(&record.fatigue).ok());
    let constants = law.constants_si.as_ref().or(of_record.as_ref()).and_then(Value::as_object);
    for (key, value) in constants.into_iter().flatten().take(CONSTANTS_MOST) {
        let value = match value {
            Value::Number(number) => PRINT.sized(number.as_f64().unwrap_or(f64::NAN), 4),
            Value::String(text) => quoted(text),
            Value::Array(rows) => format!("{} tables", rows.len()),
            _ => continue,
        };
        rows.push(("Constant", format!("{} {value}", quoted(key))));
    }
    let range = |[low, high]: [f64; 2]| format!("ΔK {} to {} MPa√m", PRINT.fixed(low, 2), PRINT.fixed(high, 2));
    rows.push(("Tested ΔK range", law.range().map_or_else(|| recorded(None), range)));
    let specimens = run.band.as_ref().map(|band| {
        let assumed = if band.assumed_scatter { ", scatter assumed" } else { "" };
        format!("{} specimen{}{assumed}", band.specimens, if band.specimens == 1 { "" } else { "s" })
    });
    rows.push((
        "Source",
        match &*law.source {
            "fitted" => specimens.unwrap_or_else(|| "fitted law; number of specimens not recorded".to_owned()),
            "inline" => "constants entered by the user".to_owned(),
            other => recorded(Some(other)),
        },
    ));
    rows
}

/// All checks: those that did not pass with effect and action, then the names of those that passed.
fn checks(run: &RunRecord) -> String {
    let is_open = |check: &&Check| check.verdict != Verdict::Passed;
    let open: Vec<&Check> = run.checks.iter().filter(is_open).collect();
    let row = |check: &&Check| {
        let holds = if check.verdict == Verdict::Failed { Some(false) } else { None };
        let (words, remedy) = (prose(&check.words), quoted(check.remedy.as_deref().unwrap_or("")));
        vec![format!("{} {words}", mark(holds)), effect(check), remedy]
    };
    let open = match open.as_slice() {
        [] => String::new(),
        rows => table("checks", &["Check", "Effect on the life", "Action"].map(text), rows.iter().map(row)),
    };
    let passed = run.checks.iter().filter(|check| !is_open(check));
    let names: Vec<String> = passed.map(title_of).collect();
    let passed = match names.as_slice() {
        [] => String::new(),
        names => format!("<p class=\"small\">{} Passed: {}</p>\n", mark(Some(true)), names.join(", ")),
    };
    format!("<h2>Validity</h2>\n{open}{passed}")
}

fn title_of(check: &Check) -> String {
    match &*check.name {
        "lack_of_fit" => "fit quality".to_owned(),
        "extrapolation_below" => "ΔK range (low)".to_owned(),
        "extrapolation_above" => "ΔK range (high)".to_owned(),
        "part_through_factors" => "accuracy of K".to_owned(),
        "part_through_range" => "range of K".to_owned(),
        "e647_size" => "specimen size (E647)".to_owned(),
        other => quoted(&other.replace('_', " ")),
    }
}

fn messages(warnings: &[String]) -> String {
    let lines: String = warnings.iter().map(|line| format!("<li>{}</li>\n", prose(line))).collect();
    if lines.is_empty() { lines } else { format!("<h2>Messages</h2>\n<ul class=\"small\">\n{lines}</ul>\n") }
}

fn effect(check: &Check) -> String {
    let side = check.side.map_or("", Side::words);
    match check.effect_percent {
        Some(percent) => format!("{} %, {side}", PRINT.short((10.0 * percent.abs()).round() / 10.0)),
        None if side.is_empty() => "unknown".to_owned(),
        None => format!("{side} (size unknown)"),
    }
}
