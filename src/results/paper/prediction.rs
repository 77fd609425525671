//! The page of a run: life with its band, why it ends, whether it is valid, how wrong it may be as a solution, pictures, case, law, hashes.

use serde_json::Value;

use super::answers::quantile_words;
use super::{
    Drawings, PRINT, Sheets, Signed, answers, commit_words, figure, hashes, known, letter, mark, part_through, prose, quoted,
    recorded, signatures, spectrum, terms,
};
use crate::band::interval_words;
use crate::chart::Size;
use crate::checks::{Check, Side, Validity, Verdict};
use crate::curve::RunTables;
use crate::pictures::curves::{a_n_svg, end_words, k_svg};
use crate::pictures::plate::{Plate, plate_svg};
use crate::record::RunRecord;
use perilife_growth::predict::StopReason;

/// Conditions that do not hold and are printed, at the most.
const CHECKS_MOST: usize = 5;
/// Files whose hashes are printed, at the most.
const HASHES_MOST: usize = 5;
/// Constants of a law that are printed, at the most.
const CONSTANTS_MOST: usize = 8;
const PLATE: Size = Size { width: 365.0, height: 262.0, text: 10.5 };
/// Size of the charts beside it, px.
const CHART: Size = Size { width: 315.0, height: 130.0, text: 10.0 };
/// Figures of the first sheet.
const FIGURES: usize = 3;

/// Title, page and version of the program that ran.
pub fn body(run: &RunRecord, tables: &RunTables, drawings: &Drawings, signed: &Signed) -> (String, String, String) {
    let (name, plate) = (&run.name, run.plate.as_ref());
    let mut page = letter(signed, name, run.made_by.finished.as_deref());
    page += &format!("<h1>Crack growth life: {}</h1>\n", quoted(name));
    page += &format!("<p class=\"lead\">{}</p>\n", lead(plate));
    page += &answer(run, tables);
    page += &figures(run, tables, plate);
    let law = terms(&law(run));
    page += &format!(
        "<div class=\"cols\"><div><h2>As understood</h2>{}</div><div><h2>Law</h2>{law}</div></div>\n",
        terms(&understood(run, plate))
    );
    page += &checks(run);
    page += &messages(&run.warnings);
    page += &signatures(signed, "Computed by");
    page += &format!(
        "<p class=\"small quiet\">perilife {}{}. Units: mm, MPa, MPa√m, mm/cycle. Input and law as they were read:</p>\n",
        quoted(&run.version),
        commit_words(run.made_by.commit.as_deref())
    );
    page += &hashes(run.made_by.inputs.iter().map(|file| (&*file.file, &*file.sha256)), HASHES_MOST);
    let mut sheets = Sheets::begin(drawings, FIGURES);
    page += &spectrum::section(run, &mut sheets);
    page += &part_through::section(run, tables, &mut sheets);
    page += &answers::sections(run, &mut sheets);
    (format!("Crack growth life, {name}"), page, run.version.clone())
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
            let path = path.map_or_else(String::new, |path| format!(", {} mm of the path", PRINT.short(path)));
            format!("Numerical error at most {} % of life{path}", PRINT.short(percent))
        }
        (None, Some(why)) => format!("Numerical error not stated: {}", quoted(why)),
        (None, None) => "Numerical error not estimated".to_owned(),
    };
    format!(
        "<div class=\"answer\"><div>{}</div><div><h2>It ends because</h2><p class=\"why\">{sentence}</p><p>{}</p></div>\
         <div><h2>Is it valid?</h2><p>{} {}</p><p>{error}</p></div></div>\n",
        life(run),
        end_length(run, tables),
        mark(holds),
        recorded(Some(&run.verdict)),
    )
}

fn end_length(run: &RunRecord, tables: &RunTables) -> String {
    match (run.leading_crack(), tables.rows.last()) {
        (Some((tip, [_, last])), _) => format!("crack of tip {tip}: {} mm long", PRINT.fixed(last, 1)),
        (None, Some(row)) => format!("crack length {} mm", PRINT.fixed(row.crack_length_mm, 1)),
        (None, None) => String::new(),
    }
}

fn life(run: &RunRecord) -> String {
    let card = |title: &str, value: &str, below: &str| format!("<h2>{title}</h2><p class=\"big\">{value}</p><p>{below}</p>");
    if let Some(refused) = &run.refused {
        return card("Life", "none that counts", &quoted(refused));
    }
    let Some(life) = run.life_cycles else { return card("Life", "unlimited", "no crack grows under this load") };
    let title = match run.stop_reason {
        StopReason::EnteredHole => "Cycles to the hole",
        StopReason::CrackLengthReached | StopReason::CrackDepthReached | StopReason::RunOut => "Cycles to what was asked for",
        // Cut off by the model, not by the plate.
        StopReason::LigamentUnresolved | StopReason::NoGrowth | StopReason::NoConvergence => {
            "Cycles to where the computation ends"
        }
        _ if run.life_is_lower_bound => "Life, at least",
        _ => "Life",
    };
    let cycles = |value: &str| format!("{value} <small>cycles</small>");
    if let Some(fleet) = &run.fleet {
        let [low, middle, high] = quantile_words(&fleet.life_cycles);
        let (plates, run) = (PRINT.whole(fleet.plates as f64), PRINT.whole(life));
        let below = format!("median {middle}, 95 % {high} cycles, {plates} plates; this run, one plate: {run}");
        return card("Life of the fleet, 5 % of plates", &cycles(&low), &below);
    }
    if let Some(band) = &run.band {
        let [low, middle, high] = band.cycles().map(|value| PRINT.by_band(value, &band.cycles()));
        let below = format!("9 of 10 plates: {low} to {high}; the fitted constants alone give {}", PRINT.whole(life));
        return card(&format!("{title}, median"), &cycles(&middle), &below);
    }
    let below = match &run.no_band {
        Some(why) => format!("no band of plates: {}", quoted(why)),
        None => "no band of plates".to_owned(),
    };
    card(title, &cycles(&PRINT.by_error(life, run.error_estimate_percent)), &below)
}

fn figures(run: &RunRecord, tables: &RunTables, plate: Option<&Plate>) -> String {
    let band = if tables.band.is_some() { "; band: 9 of 10 plates" } else { "" };
    let mut figures = match plate {
        Some(plate) => figure(
            &plate_svg(plate, tables, PLATE),
            "Figure 1. Plate to scale, load, first crack (black) and its way, coloured by cycles; marks at 25, 50, 75 and 90 % of the life.",
            "tall",
        ),
        None => format!("<p class=\"tall\">Figure 1, the plate: {}</p>", recorded(None)),
    };
    if tables.rows.len() < 2 {
        return format!("<div class=\"figs run\">\n{figures}<p>Figures 2 and 3: no crack grew.</p></div>\n");
    }
    figures += &figure(&a_n_svg(run, tables, CHART), &format!("Figure 2. Crack length over cycles{band}."), "");
    figures += &match k_svg(run, tables, CHART) {
        Some(svg) => {
            let hatched = if svg.contains("of the law") { "; hatched: outside the ΔK of the law" } else { "" };
            let over = if run.leading_crack().is_some() { "growth of the tips" } else { "crack length" };
            figure(&svg, &format!("Figure 3. K at maximum load over {over}{hatched}."), "")
        }
        None => format!("<p>Figure 3, K over crack length: {}; bonds drive the crack by their own strain.</p>", recorded(None)),
    };
    format!("<div class=\"figs run\">\n{figures}</div>\n")
}

fn understood(run: &RunRecord, plate: Option<&Plate>) -> Vec<(&'static str, String)> {
    let two_decimals = |length: f64| PRINT.short((100.0 * length).round() / 100.0);
    let lengths = match run.leading_crack() {
        Some((tip, [first, last])) => format!("of tip {tip}: {} mm to {} mm", two_decimals(first), two_decimals(last)),
        None => {
            let [first, last] =
                [run.crack_length_initial_mm, run.crack_length_final_mm].map(|length| known(length, two_decimals));
            format!("{first} mm to {last} mm")
        }
    };
    let mut rows = vec![
        ("Specimen", recorded(plate.map(|plate| &*plate.specimen))),
        ("Material", plate.map_or_else(|| recorded(None), |plate| prose(&plate.material))),
        ("Load", recorded(plate.map(|plate| &*plate.load))),
        ("Crack length", lengths),
        ("Computed on", model(run)),
    ];
    let given: Vec<String> = run.made_by.overrides.iter().map(|one| quoted(one)).collect();
    if !given.is_empty() {
        rows.push(("Overrides", given.join(", ")));
    }
    rows
}

/// By what its K was found; of a crack that is through after a part of its life both methods, with their shares of it.
fn model(run: &RunRecord) -> String {
    let text = |key: &str| run.model.get(key).and_then(Value::as_str);
    let points = PRINT.whole(run.points as f64);
    match text("method") {
        Some("handbook") => {
            let formula = format!("formula: {}", recorded(text("formula")));
            let through = run.part_through.as_ref().and_then(|found| found.cycles_at_break_through).zip(run.life_cycles);
            match through.filter(|(through, life)| through < life && run.points > 0) {
                Some((through, life)) => {
                    let share = |cycles: f64| PRINT.fixed(100.0 * cycles / life, 0);
                    let (before, behind) = (share(through), share(life - through));
                    format!("{formula} ({before} % of the life), then {points} nodes, element-free Galerkin ({behind} %)")
                }
                None => formula,
            }
        }
        Some("element_free_galerkin") => format!("{points} nodes at the end (element-free Galerkin)"),
        Some(method) => {
            let spacing = run.model.get("spacing_mm").and_then(Value::as_f64);
            let spacing = known(spacing, |spacing| PRINT.short(spacing));
            format!("{points} points, {spacing} mm apart ({})", quoted(method))
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
        rows.push(("Growth rate", format!("{} mm/cycle{error} at ΔK {} MPa√m", PRINT.rate(rate, 3), PRINT.fixed(pivot, 1))));
    }
    let exponent = law.paris_m.or(law.p);
    if let Some(c) = law.paris_c_used_mm_per_cycle.or(law.paris_c_mm_per_cycle) {
        rows.push(("C as used", PRINT.level(c, exponent, 4)));
    }
    rows.extend(exponent.map(|m| ("Exponent m", PRINT.with_error(m, law.paris_m_error))));
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
    let range = |[low, high]: [f64; 2]| format!("ΔK {} to {} MPa√m", PRINT.fixed(low, 1), PRINT.fixed(high, 1));
    rows.push(("Calibrated", law.range().map_or_else(|| recorded(None), range)));
    let specimens = run.band.as_ref().map(|band| {
        let assumed = if band.assumed_scatter { ", scatter assumed" } else { "" };
        format!("{} specimen{}{assumed}", band.specimens, if band.specimens == 1 { "" } else { "s" })
    });
    rows.push((
        "From",
        match &*law.source {
            "fitted" => specimens.unwrap_or_else(|| "a fit; number of specimens not recorded".to_owned()),
            "inline" => "constants given in the case".to_owned(),
            other => recorded(Some(other)),
        },
    ));
    if let Some(inspection) = &run.inspection {
        let interval = interval_words(inspection, run.spectrum.as_ref().map(|spectrum| spectrum.cycles_per_pass));
        let from = PRINT.short(inspection.crack_length_mm);
        rows.push(("Inspect every", format!("{interval}, from a crack of {from} mm")));
    }
    rows
}

/// Conditions that do not hold, at most five, and the names of those that do.
fn checks(run: &RunRecord) -> String {
    let is_open = |check: &&Check| check.verdict != Verdict::Passed;
    let open: Vec<&Check> = run.checks.iter().filter(is_open).collect();
    let row = |check: &&Check| {
        let holds = if check.verdict == Verdict::Failed { Some(false) } else { None };
        let (words, remedy) = (prose(&check.words), quoted(check.remedy.as_deref().unwrap_or("")));
        format!("<tr><td>{} {words}</td><td>{}</td><td>{remedy}</td></tr>\n", mark(holds), effect(check))
    };
    let mut rows: String = open.iter().take(CHECKS_MOST).map(row).collect();
    if open.len() > CHECKS_MOST {
        rows += &format!("<tr><td colspan=\"3\">and {} more in result.json</td></tr>\n", open.len() - CHECKS_MOST);
    }
    let held = run.checks.iter().filter(|check| !is_open(check));
    let names: Vec<String> = held.map(|check| quoted(&check.name.replace('_', " "))).collect();
    if !names.is_empty() {
        rows += &format!("<tr><td colspan=\"3\">{} holds: {}</td></tr>\n", mark(Some(true)), names.join(", "));
    }
    format!(
        "<h2>Is it valid?</h2>\n<div class=\"scroll\"><table class=\"checks\"><thead><tr><th>What the life rests on</th><th>Computed life</th><th>What to do</th></tr></thead><tbody>\n\
         {rows}</tbody></table></div>\n"
    )
}

/// Every message of the run, as the console has them.
fn messages(warnings: &[String]) -> String {
    let lines: String = warnings.iter().map(|line| format!("<li>{}</li>\n", prose(line))).collect();
    if lines.is_empty() { lines } else { format!("<h2>Messages</h2>\n<ul class=\"small\">\n{lines}</ul>\n") }
}

fn effect(check: &Check) -> String {
    let side = match check.side {
        Some(Side::Conservative) => "too short",
        Some(Side::NonConservative) => "too long",
        Some(Side::Either) => "too long or too short",
        None => "",
    };
    match check.effect_percent {
        Some(percent) => format!("{} %, {side}", PRINT.short((10.0 * percent.abs()).round() / 10.0)),
        None if side.is_empty() => "not known".to_owned(),
        None => format!("not known, {side}"),
    }
}
