//! The report of a fit: law, readings, criteria of ASTM E647, specimen and test, and every reading with its rate.

use serde_json::Value;

use super::{CHART, PRINT, Signed, figure, hashes, letter, mark, prose, quoted, recorded, signatures, terms};
use crate::chart::Size;
use crate::curve::RunTables;
use crate::pictures::fit::{FitTables, RateFitted, Reading, law_svg};
use crate::pictures::plate::{Plate, plate_svg};
use crate::units::shown_result;
use perilife_base::units::shown::per;
use perilife_growth::case::record::CurveRecord;

/// Files whose hashes are printed, at the most.
const HASHES_MOST: usize = 12;
/// Size of the specimen, px.
const SPECIMEN: Size = Size { width: 330.0, height: 280.0, text: 10.5 };
/// What a test report asks for and no file of a fit holds.
const UNRECORDED: [&str; 9] = [
    "Orientation",
    "Notch",
    "Precracking",
    "Machine, load cell",
    "Wave, frequency",
    "Environment",
    "Crack measured by",
    "Resolution of a",
    "Interruptions",
];

/// Title, page and version of the program that fitted readings.
pub fn of_lives(fit: &Value, tables: &FitTables, signed: &Signed) -> (String, String, String) {
    let fitted_to = fit["fitted_to"].as_str().unwrap_or("readings");
    let material = fit["test"]["material"].as_str().unwrap_or("");
    let version = fit["version"].as_str().unwrap_or("").to_owned();
    let fitted_to = match fit["test"]["specimens"].as_u64() {
        Some(count) if count > 1 => format!("{fitted_to} of {count} specimens"),
        _ => fitted_to.to_owned(),
    };
    let name = if material.is_empty() { fitted_to } else { format!("{material}, {fitted_to}") };
    let mut page = letter(signed, &name, fit["finished"].as_str());
    page += &format!("<h1>Fatigue crack growth rate: {}</h1>\n", quoted(&name));
    let (kind, load) = (fit["test"]["specimen_kind"].as_str().unwrap_or(""), fit["test"]["load"].as_str().unwrap_or(""));
    page += &format!("<p class=\"lead\">{} specimen, {}.</p>\n", quoted(&kind.replace('_', " ")), quoted(load));
    page += &answer(fit);
    page += "<div class=\"figs\">\n";
    page += &figure(
        &tables.lives_svg(CHART),
        "Figure 1. Crack length over cycles: readings (circles), fitted law (line) with the 95 % band of its constants; other specimens as thin lines.",
        "",
    );
    page += &figure(
        &tables.rates_svg(CHART),
        "Figure 2. Growth rate over ΔK: readings that count (circles), fitted law over its range (line), pivot (ring).",
        "",
    );
    page += "</div>\n";
    page += &criteria(fit);
    page += &signatures(signed, "Tested by");
    page += &details(fit);
    page += &curve(fit);
    page += &specimens(fit);
    page += &readings(&tables.readings);
    (format!("Fatigue crack growth rate, {name}"), page, version)
}

fn answer(fit: &Value) -> String {
    let number = |key: &str| fit[key].as_f64().unwrap_or(f64::NAN);
    let ratio = fit["test"]["stress_ratio"].as_f64().map_or_else(|| recorded(None), |value| PRINT.short(value));
    format!(
        "<div class=\"answer fit\"><div><h2>Growth rate at ΔK = {} MPa√m</h2><p class=\"big\">{} <small>mm/cycle</small></p>\
         <p>± {} % (one standard error)</p></div><div><h2>Exponent m</h2><p class=\"big\">{}</p><p>± {}; C = {}</p></div>\
         <div><h2>Valid for ΔK</h2><p class=\"big\">{} to {}</p><p>MPa√m, R = {ratio}</p></div></div>\n",
        PRINT.fixed(number("pivot_delta_k_mpa_sqrt_m"), 2),
        PRINT.rate(number("rate_at_pivot_mm_per_cycle"), 4),
        PRINT.fixed(100.0 * number("rate_at_pivot_relative_error"), 1),
        PRINT.fixed(number("paris_m"), 3),
        PRINT.fixed(number("paris_m_error"), 3),
        PRINT.level(number("paris_c_mm_per_cycle"), fit["paris_m"].as_f64(), 4),
        PRINT.fixed(number("delta_k_min_mpa_sqrt_m") * per("MPa√m"), 2),
        PRINT.fixed(number("delta_k_max_mpa_sqrt_m") * per("MPa√m"), 2),
    )
}

fn criteria(fit: &Value) -> String {
    let row = |criterion: &Value| {
        let text = |key: &str| prose(criterion[key].as_str().unwrap_or(""));
        let holds = match criterion["holds"].as_bool() {
            Some(true) => Some(true),
            // What does not hold of a test is a remark: the reader judges what it does to the law.
            Some(false) | None => None,
        };
        format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{} {}</td></tr>\n",
            text("name"),
            text("asked"),
            text("found"),
            mark(holds),
            text("remark")
        )
    };
    let rows: String = fit["criteria"].as_array().into_iter().flatten().map(row).collect();
    let rows = if rows.is_empty() { format!("<tr><td colspan=\"4\">{}</td></tr>", recorded(None)) } else { rows };
    format!(
        "<h2>Criteria of ASTM E647</h2>\n<div class=\"scroll\"><table><thead><tr><th>Criterion</th><th>Asked</th><th>Found</th><th></th></tr></thead>\
         <tbody>\n{rows}</tbody></table></div>\n"
    )
}

/// Specimen, test, how the law came about, deviations, hashes.
fn details(fit: &Value) -> String {
    let test = &fit["test"];
    let text = |key: &str| recorded(test[key].as_str());
    let number = |key: &str, unit: &str| {
        test[key].as_f64().map_or_else(|| recorded(None), |value| format!("{} {unit}", PRINT.short(value)))
    };
    let specimen = [
        ("Type", text("specimen_kind").replace('_', " ")),
        ("Material", text("material")),
        ("Width W", number("width_mm", "mm")),
        ("Thickness B", number("thickness_mm", "mm")),
        ("Yield strength", number("yield_strength_mpa", "MPa (of the material file)")),
        ("First reading a", number("first_reading_mm", "mm")),
        ("Last reading a", number("last_reading_mm", "mm")),
        ("Specimens", test["specimens"].as_f64().map_or_else(|| recorded(None), |value| PRINT.whole(value))),
        ("Readings", test["readings"].as_f64().map_or_else(|| recorded(None), |value| PRINT.whole(value))),
    ];
    let mut of_test =
        vec![("Load", text("load")), ("Largest load", text("load_max")), ("Stress ratio R", number("stress_ratio", ""))];
    of_test.extend(UNRECORDED.iter().map(|what| (*what, recorded(None))));
    let mut page = format!(
        "<div class=\"cols paged\"><div><h2>Specimen</h2>{}</div><div><h2>Test</h2>{}</div></div>\n",
        terms(&specimen),
        terms(&of_test)
    );
    let plate: Option<Plate> = fit.get("plate").and_then(|plate| serde_json::from_value(plate.clone()).ok());
    let drawing = plate.map_or_else(String::new, |plate| {
        figure(
            &plate_svg(&plate, &RunTables::default(), SPECIMEN),
            "Figure 3. The specimen to scale with its first crack, as it was computed.",
            "",
        )
    });
    page += &format!("<div class=\"figs\"><div>{drawing}</div><div>{}</div></div>\n", how(fit));
    let warnings: Vec<String> =
        fit["warnings"].as_array().into_iter().flatten().filter_map(|one| Some(quoted(one.as_str()?))).collect();
    if !warnings.is_empty() {
        page += &format!("<h2>Remarks of the fit</h2>\n<ul class=\"small\"><li>{}</li></ul>\n", warnings.join("</li><li>"));
    }
    page += "<h2>Readings and input as they were read</h2>\n";
    page += &hashes(files(if fit["inputs"].is_array() { &fit["inputs"] } else { &fit["sources"] }), HASHES_MOST);
    let commit = fit["commit"]
        .as_str()
        .map_or_else(String::new, |commit| format!(", commit {}", quoted(&commit.chars().take(12).collect::<String>())));
    let version = recorded(fit["version"].as_str());
    page += &format!("<p class=\"small quiet\">perilife {version}{commit}. Units: mm, MPa√m, mm/cycle.</p>\n");
    page
}

fn how(fit: &Value) -> String {
    let test = &fit["test"];
    let formula = match (test["formula"].as_str(), test["formula_source"].as_str()) {
        (Some(formula), Some(source)) => {
            let range = test["formula_range"].as_str().map_or_else(String::new, |range| format!(" ({})", quoted(range)));
            format!("{}: {}{range}.", quoted(formula), quoted(source))
        }
        _ => "Of a computed plate of this shape; no formula is known for it.".to_owned(),
    };
    let number = |key: &str| fit[key].as_f64();
    let life = match (number("life_measured"), number("life_fitted"), number("rms_life_error")) {
        (Some(measured), Some(fitted), Some(rms)) => format!(
            " Life over the window: measured {}, fitted {} cycles; rms over the readings {} %.",
            PRINT.whole(measured),
            PRINT.whole(fitted),
            PRINT.fixed(100.0 * rms, 2)
        ),
        _ => String::new(),
    };
    let window = match (number("from_crack_length_mm"), number("to_crack_length_mm")) {
        (Some(from), Some(to)) => format!(" Window: a from {} to {} mm.", PRINT.short(from), PRINT.short(to)),
        _ => String::new(),
    };
    let criterion = fit["criterion"].as_str().unwrap_or("").replace('_', " ");
    let method = match fit["law"].as_str() {
        Some("curve") => {
            "Natural spline of the rates over ln ΔK by restricted maximum likelihood, at the level of the lives; C and m by least \
                          squares on cycles at equal crack length"
        }
        _ => "Least squares on cycles at equal crack length",
    };
    let misfit = |end: &str| {
        let of = &fit["misfit_at_ends"][end];
        Some(format!(
            "{} % at ΔK {} to {}",
            PRINT.fixed(of["rate_over_law_percent"].as_f64()?, 1),
            PRINT.fixed(of["delta_k_from_mpa_sqrt_m"].as_f64()?, 1),
            PRINT.fixed(of["delta_k_to_mpa_sqrt_m"].as_f64()?, 1)
        ))
    };
    let ends: Vec<String> = ["low", "high"].into_iter().filter_map(misfit).collect();
    let ends = if ends.is_empty() { String::new() } else { format!(" Rate over law at the ends: {} MPa√m.", ends.join("; ")) };
    format!(
        "<h2>Stress intensity</h2><p>{formula}</p><h2>Growth rates</h2><p>Seven-point incremental polynomial (Appendix X1); secants where \
         a record has fewer than seven readings or the load changes. The first and last three readings carry no rate.</p>\
         <h2>Fitted law</h2><p>da/dN = C ΔK<sup>m</sup>. {method}, criterion {}.{window}{life}{ends} C and m are correlated: quote the rate at \
         the pivot together with m.</p><h2>Use beyond this test</h2><p>Outside the range of ΔK the law is not known; another R needs tests at that R.</p>",
        quoted(&criterion)
    )
}

/// The curve of the rates by its knots.
fn curve(fit: &Value) -> String {
    let Ok(curve) = serde_json::from_value::<CurveRecord>(fit["curve"].clone()) else { return String::new() };
    let row = |i: usize| {
        format!(
            "<tr><td class=\"n\">{}</td><td class=\"n\">{} ± {} %</td><td class=\"n\">{} ± {}</td></tr>\n",
            PRINT.fixed(curve.delta_k_mpa_sqrt_m[i] * per("MPa√m"), 3),
            PRINT.rate(curve.da_dn_mm_per_cycle[i], 4),
            PRINT.fixed(100.0 * curve.da_dn_relative_error[i], 1),
            PRINT.fixed(curve.m[i], 2),
            PRINT.fixed(curve.m_error[i], 2)
        )
    };
    format!(
        "<h2>Curve of the rates</h2>\n<p class=\"key\">The law of all lives: a natural spline of ln da/dN over ln ΔK through these knots. C and m are the \
         best power law.</p>\n<table class=\"readings\"><thead><tr><th class=\"n\">ΔK, MPa√m</th><th class=\"n\">da/dN, mm/cycle</th>\
         <th class=\"n\">local m</th></tr></thead><tbody>\n{}</tbody></table>\n",
        (0..curve.m.len()).map(row).collect::<String>()
    )
}

/// Lives of several specimens, measured and fitted.
fn specimens(fit: &Value) -> String {
    let all = fit["specimens"].as_array().map_or(&[][..], Vec::as_slice);
    if all.len() < 2 {
        return String::new();
    }
    let row = |one: &Value| {
        let [measured, fitted, rms] =
            ["life_measured", "life_fitted", "rms_life_error"].map(|key| one[key].as_f64().unwrap_or(f64::NAN));
        let name = quoted(one["name"].as_str().unwrap_or(""));
        format!(
            "<tr><td>{name}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
            PRINT.whole(measured),
            PRINT.whole(fitted),
            PRINT.fixed(100.0 * rms, 2)
        )
    };
    format!(
        "<h2>Specimens</h2>\n<table class=\"readings\"><thead><tr><th>Specimen</th><th class=\"n\">Life measured, cycles</th>\
         <th class=\"n\">Life fitted, cycles</th><th class=\"n\">rms error of life, %</th></tr></thead><tbody>\n{}</tbody></table>\n",
        all.iter().map(row).collect::<String>()
    )
}

/// Every reading.
fn readings(readings: &[Reading]) -> String {
    let known = |value: f64, words: String| if value.is_finite() { words } else { "–".to_owned() };
    let row = |(place, reading): (usize, &Reading)| {
        let out = if reading.left_out.is_empty() { "" } else { " class=\"out\"" };
        let delta_k = reading.delta_k_mpa_sqrt_m.map_or("–".to_owned(), |delta_k| PRINT.fixed(delta_k * per("MPa√m"), 2));
        let growth = reading.da_dn_mm_per_cycle.map_or("–".to_owned(), |growth| PRINT.rate(growth, 3));
        let by = if reading.method == "secant" { " secant" } else { "" };
        let marks = quoted(&reading.marks.replace('_', " "));
        let left_out =
            if reading.left_out.is_empty() { String::new() } else { format!("left out: {}", quoted(&reading.left_out)) };
        let remarks: Vec<String> =
            [marks, by.trim().to_owned(), left_out].into_iter().filter(|words| !words.is_empty()).collect();
        format!(
            "<tr{out}><td class=\"n\">{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{delta_k}</td><td class=\"n\">{growth}</td><td>{}</td></tr>\n",
            place + 1,
            quoted(&reading.specimen),
            known(reading.cycles, PRINT.whole(reading.cycles)),
            known(reading.crack_length_mm, PRINT.fixed(reading.crack_length_mm * per("mm"), 3)),
            remarks.join("; ")
        )
    };
    format!(
        "<h2 class=\"paged\">Readings and growth rates</h2>\n<p class=\"key\">N and a as read. ΔK and da/dN in the middle of the readings that the rate \
         was taken from; –: no rate there. Marked readings are kept; those left out say why.</p>\n\
         <div class=\"scroll\"><table class=\"readings\"><thead><tr><th class=\"n\">No.</th><th>Specimen</th><th class=\"n\">N, cycles</th><th class=\"n\">a, mm</th>\
         <th class=\"n\">ΔK, MPa√m</th><th class=\"n\">da/dN, mm/cycle</th><th>Marks</th></tr></thead><tbody>\n{}</tbody></table></div>\n",
        readings.iter().enumerate().map(row).collect::<String>()
    )
}

/// Title, page and version of the program that fitted rates.
pub fn of_laws(fit: &Value, rates: &[RateFitted], signed: &Signed) -> (String, String, String) {
    let law = fit["law"].as_str().unwrap_or("law");
    let material = fit["material"].as_str().filter(|material| !material.is_empty());
    let version = fit["version"].as_str().unwrap_or("").to_owned();
    let name = material.map_or_else(|| law.to_owned(), |material| format!("{material}, {law}"));
    let mut page = letter(signed, &name, fit["finished"].as_str());
    page += &format!("<h1>Law of fatigue crack growth: {}</h1>\n", quoted(&name));
    let number = |key: &str| fit[key].as_f64().unwrap_or(f64::NAN);
    let ratios: Vec<String> =
        fit["stress_ratios"].as_array().into_iter().flatten().filter_map(Value::as_f64).map(|value| PRINT.short(value)).collect();
    page += &format!(
        "<div class=\"answer\"><div><h2>Law</h2><p class=\"big\">{}</p><p>fitted to {} rates</p></div><div><h2>Scatter of ln(da/dN)</h2>\
         <p class=\"big\">{}</p><p>root mean square</p></div><div><h2>Valid for ΔK</h2><p class=\"big\">{} to {}</p>\
         <p>MPa√m, R = {}</p></div></div>\n",
        quoted(law),
        PRINT.whole(number("rates")),
        PRINT.fixed(number("rms_log_rate"), 3),
        PRINT.fixed(number("delta_k_min_mpa_sqrt_m") * per("MPa√m"), 2),
        PRINT.fixed(number("delta_k_max_mpa_sqrt_m") * per("MPa√m"), 2),
        ratios.join(", ")
    );
    let caption = "Figure 1. Growth rate over ΔK: rates (circles), the law over its range (lines), by stress ratio.";
    page +=
        &format!("<div class=\"figs\">\n{}<div>{}</div></div>\n", figure(&law_svg(rates, CHART), caption, ""), constants(fit));
    page += &candidates(fit);
    page += &signatures(signed, "Tested by");
    page += "<h2>Rates as they were read</h2>\n";
    page += &hashes(files(&fit["sources"]), HASHES_MOST);
    let row = |(place, row): (usize, &RateFitted)| {
        format!(
            "<tr><td class=\"n\">{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
            place + 1,
            quoted(&row.series),
            PRINT.short(row.stress_ratio),
            PRINT.fixed(row.delta_k_mpa_sqrt_m * per("MPa√m"), 3),
            PRINT.rate(row.da_dn_mm_per_cycle, 3),
            PRINT.rate(row.da_dn_fitted_mm_per_cycle, 3)
        )
    };
    page += &format!(
        "<h2 class=\"paged\">Rates</h2>\n<div class=\"scroll\"><table class=\"readings\"><thead><tr><th class=\"n\">No.</th><th>Test</th><th class=\"n\">R</th>\
         <th class=\"n\">ΔK, MPa√m</th><th class=\"n\">da/dN, mm/cycle</th><th class=\"n\">by the law</th></tr></thead><tbody>\n{}</tbody></table></div>\n",
        rates.iter().enumerate().map(row).collect::<String>()
    );
    (format!("Law of fatigue crack growth, {name}"), page, version)
}

/// Names and hashes of files.
fn files(all: &Value) -> impl Iterator<Item = (&str, &str)> {
    let of = |file| -> (&str, &str) {
        let file: &Value = file;
        (file["file"].as_str().unwrap_or(""), file["sha256"].as_str().unwrap_or("not recorded"))
    };
    all.as_array().into_iter().flatten().map(of)
}

fn constants(fit: &Value) -> String {
    let fit = &*shown_result(fit);
    let rows = fit["constants"].as_object().into_iter().flatten().map(|(key, value)| {
        let error =
            fit["standard_errors"][key].as_f64().map_or_else(String::new, |error| format!(" ± {}", PRINT.sized(error, 2)));
        let value = value.as_f64().map_or_else(|| quoted(&value.to_string()), |value| PRINT.sized(value, 5));
        format!("<tr><td>{}</td><td>{value}{error}</td></tr>\n", quoted(key))
    });
    format!("<h2>Constants (± one standard error)</h2>\n<table><tbody>\n{}</tbody></table>\n", rows.collect::<String>())
}

fn candidates(fit: &Value) -> String {
    let number = |value: &Value, decimals: usize| value.as_f64().map_or("–".to_owned(), |value| PRINT.fixed(value, decimals));
    let row = |one: &Value| {
        let name = quoted(one["law"].as_str().unwrap_or(""));
        let left_out = quoted(one["left_out"].as_str().unwrap_or(""));
        format!(
            "<tr><td>{name}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{left_out}</td></tr>\n",
            number(&one["rms_log_rate"], 3),
            number(&one["delta_aicc"], 1)
        )
    };
    format!(
        "<h2>Laws compared</h2>\n<div class=\"scroll\"><table><thead><tr><th>Law</th><th class=\"n\">scatter of ln(da/dN)</th><th class=\"n\">AICc over the least</th>\
         <th>Left out because</th></tr></thead><tbody>\n{}</tbody></table></div>\n",
        fit["candidates"].as_array().into_iter().flatten().map(row).collect::<String>()
    )
}
