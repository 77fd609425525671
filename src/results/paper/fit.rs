//! The report of a fit: law, readings, criteria of ASTM E647, specimen and test, and every reading with its rate.

use serde_json::{Value, json};

use super::{
    CHART, PRINT, Signed, commit_words, figure, hashes, known, letter, mark, prose, quoted, recorded, signatures, terms,
};
use crate::chart::Size;
use crate::curve::RunTables;
use crate::pictures::fit::{FitTables, RateFitted, law_svg};
use crate::pictures::plate::{Plate, plate_svg};
use crate::units::shown_result;
use perilife_base::units::shown::per;
use perilife_calibration::lack_of_fit::Misfit;
use perilife_calibration::readings::Reading;
use perilife_calibration::record::{CandidateRecord, LivesRecord, RatesRecord, SpecimenRecord};
use perilife_growth::case::record::{FittedLaw, SourceFile};

/// Files whose hashes are printed, at the most.
const HASHES_MOST: usize = 12;
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
pub fn of_lives(fit: &LivesRecord, plate: Option<&Plate>, tables: &FitTables, signed: &Signed) -> (String, String, String) {
    let test = &fit.beside["test"];
    let material = test["material"].as_str().unwrap_or("");
    let fitted_to = match test["specimens"].as_u64() {
        Some(count) if count > 1 => format!("{} of {count} specimens", fit.fitted_to),
        _ => fit.fitted_to.clone(),
    };
    let name = if material.is_empty() { fitted_to } else { format!("{material}, {fitted_to}") };
    let mut page = letter(signed, &name, fit.beside["finished"].as_str());
    page += &format!("<h1>Fatigue crack growth rate: {}</h1>\n", quoted(&name));
    let (kind, load) = (test["specimen_kind"].as_str().unwrap_or(""), test["load"].as_str().unwrap_or(""));
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
    page += &criteria(&fit.beside["criteria"]);
    page += &signatures(signed, "Tested by");
    page += &details(fit, plate);
    page += &curve(fit);
    page += &specimens(fit);
    page += &readings(&tables.readings);
    (format!("Fatigue crack growth rate, {name}"), page, fit.version.clone())
}

fn answer(fit: &LivesRecord) -> String {
    let ratio = fit.beside["test"]["stress_ratio"].as_f64().map_or_else(|| recorded(None), |value| PRINT.short(value));
    format!(
        "<div class=\"answer fit\"><div><h2>Growth rate at ΔK = {} MPa√m</h2><p class=\"big\">{} <small>mm/cycle</small></p>\
         <p>± {} % (one standard error)</p></div><div><h2>Exponent m</h2><p class=\"big\">{}</p><p>± {}; C = {}</p></div>\
         <div><h2>Valid for ΔK</h2><p class=\"big\">{} to {}</p><p>MPa√m, R = {ratio}</p></div></div>\n",
        PRINT.fixed(fit.pivot_delta_k_mpa_sqrt_m, 2),
        PRINT.rate(fit.rate_at_pivot_mm_per_cycle, 4),
        known(fit.rate_at_pivot_relative_error, |error| PRINT.fixed(100.0 * error, 1)),
        PRINT.fixed(fit.paris_m, 3),
        PRINT.fixed(fit.paris_m_error, 3),
        PRINT.level(fit.paris_c_mm_per_cycle, Some(fit.paris_m), 4),
        PRINT.fixed(fit.delta_k_min_mpa_sqrt_m * per("MPa√m"), 2),
        PRINT.fixed(fit.delta_k_max_mpa_sqrt_m * per("MPa√m"), 2),
    )
}

fn criteria(criteria: &Value) -> String {
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
    let rows: String = criteria.as_array().into_iter().flatten().map(row).collect();
    let rows = if rows.is_empty() { format!("<tr><td colspan=\"4\">{}</td></tr>", recorded(None)) } else { rows };
    format!(
        "<h2>Criteria of ASTM E647</h2>\n<div class=\"scroll\"><table><thead><tr><th>Criterion</th><th>Asked</th><th>Found</th><th></th></tr></thead>\
         <tbody>\n{rows}</tbody></table></div>\n"
    )
}

/// Specimen, test, how the law came about, deviations, hashes.
fn details(fit: &LivesRecord, plate: Option<&Plate>) -> String {
    let beside = &fit.beside;
    let test = &beside["test"];
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
    let drawing = plate.map_or_else(String::new, |plate| {
        figure(
            &plate_svg(plate, &RunTables::default(), SPECIMEN),
            "Figure 3. The specimen to scale with its first crack, as it was computed.",
            "",
        )
    });
    page += &format!("<div class=\"figs\"><div>{drawing}</div><div>{}</div></div>\n", how(fit));
    let warnings: Vec<String> = fit.warnings.iter().map(|one| quoted(one)).collect();
    if !warnings.is_empty() {
        page += &format!("<h2>Remarks of the fit</h2>\n<ul class=\"small\"><li>{}</li></ul>\n", warnings.join("</li><li>"));
    }
    page += "<h2>Readings and input as they were read</h2>\n";
    let inputs = beside["inputs"].as_array().into_iter().flatten();
    let inputs: Vec<(&str, &str)> = inputs.filter_map(|file| Some((file["file"].as_str()?, file["sha256"].as_str()?))).collect();
    page += &hashes(if inputs.is_empty() { sources(&fit.sources) } else { inputs }.into_iter(), HASHES_MOST);
    let commit = commit_words(beside["commit"].as_str());
    let version = recorded(Some(&fit.version));
    page += &format!("<p class=\"small quiet\">perilife {version}{commit}. Units: mm, MPa√m, mm/cycle.</p>\n");
    page
}

/// Names and hashes of files.
fn sources(all: &[SourceFile]) -> Vec<(&str, &str)> {
    all.iter().map(|file| (&*file.file, &*file.sha256)).collect()
}

fn how(fit: &LivesRecord) -> String {
    let test = &fit.beside["test"];
    let formula = match (test["formula"].as_str(), test["formula_source"].as_str()) {
        (Some(formula), Some(source)) => {
            let range = test["formula_range"].as_str().map_or_else(String::new, |range| format!(" ({})", quoted(range)));
            format!("{}: {}{range}.", quoted(formula), quoted(source))
        }
        _ => "Of a computed plate of this shape; no formula is known for it.".to_owned(),
    };
    let life = match (fit.life_measured, fit.life_fitted, fit.rms_life_error) {
        (Some(measured), Some(fitted), Some(rms)) => format!(
            " Life over the window: measured {}, fitted {} cycles; rms over the readings {} %.",
            PRINT.whole(measured),
            PRINT.whole(fitted),
            PRINT.fixed(100.0 * rms, 2)
        ),
        _ => String::new(),
    };
    let window =
        format!(" Window: a from {} to {} mm.", PRINT.short(fit.from_crack_length_mm), PRINT.short(fit.to_crack_length_mm));
    let criterion = fit.criterion.name().replace('_', " ");
    let method = match fit.law {
        FittedLaw::Curve => {
            "Natural spline of the rates over ln ΔK by restricted maximum likelihood, at the level of the lives; C and m by least \
                          squares on cycles at equal crack length"
        }
        FittedLaw::Paris => "Least squares on cycles at equal crack length",
    };
    let misfit = |of: Misfit| {
        let [from, to] = [of.delta_k_from_mpa_sqrt_m, of.delta_k_to_mpa_sqrt_m].map(|k| PRINT.fixed(k, 1));
        format!("{} % at ΔK {from} to {to}", PRINT.fixed(of.rate_over_law_percent, 1))
    };
    let ends: Vec<String> = [fit.misfit_at_ends.low, fit.misfit_at_ends.high].into_iter().flatten().map(misfit).collect();
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
fn curve(fit: &LivesRecord) -> String {
    let Some(curve) = &fit.curve else { return String::new() };
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
fn specimens(fit: &LivesRecord) -> String {
    if fit.specimens.len() < 2 {
        return String::new();
    }
    let row = |one: &SpecimenRecord| {
        let [measured, fitted] = [one.life_measured, one.life_fitted].map(|life| known(life, |life| PRINT.whole(life)));
        format!(
            "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
            quoted(&one.name),
            measured,
            fitted,
            known(one.rms_life_error, |error| PRINT.fixed(100.0 * error, 2))
        )
    };
    format!(
        "<h2>Specimens</h2>\n<table class=\"readings\"><thead><tr><th>Specimen</th><th class=\"n\">Life measured, cycles</th>\
         <th class=\"n\">Life fitted, cycles</th><th class=\"n\">rms error of life, %</th></tr></thead><tbody>\n{}</tbody></table>\n",
        fit.specimens.iter().map(row).collect::<String>()
    )
}

fn readings(readings: &[Reading]) -> String {
    let row = |(place, reading): (usize, &Reading)| {
        let out = if reading.left_out.is_empty() { "" } else { " class=\"out\"" };
        let delta_k = known(reading.delta_k_mpa_sqrt_m, |delta_k| PRINT.fixed(delta_k * per("MPa√m"), 2));
        let growth = known(reading.da_dn_mm_per_cycle, |growth| PRINT.rate(growth, 3));
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
            known(reading.cycles, |cycles| PRINT.whole(cycles)),
            known(reading.crack_length_mm, |length| PRINT.fixed(length * per("mm"), 3)),
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
pub fn of_laws(fit: &RatesRecord, rates: &[RateFitted], signed: &Signed) -> (String, String, String) {
    let law = fit.law.name();
    let name = if fit.material.is_empty() { law.to_owned() } else { format!("{}, {law}", fit.material) };
    let mut page = letter(signed, &name, None);
    page += &format!("<h1>Law of fatigue crack growth: {}</h1>\n", quoted(&name));
    let ratios: Vec<String> = fit.stress_ratios.iter().copied().map(|value| PRINT.short(value)).collect();
    page += &format!(
        "<div class=\"answer\"><div><h2>Law</h2><p class=\"big\">{}</p><p>fitted to {} rates</p></div><div><h2>Scatter of ln(da/dN)</h2>\
         <p class=\"big\">{}</p><p>root mean square</p></div><div><h2>Valid for ΔK</h2><p class=\"big\">{} to {}</p>\
         <p>MPa√m, R = {}</p></div></div>\n",
        quoted(law),
        PRINT.whole(fit.rates as f64),
        known(fit.rms_log_rate, |rms| PRINT.fixed(rms, 3)),
        PRINT.fixed(fit.delta_k_min_mpa_sqrt_m * per("MPa√m"), 2),
        PRINT.fixed(fit.delta_k_max_mpa_sqrt_m * per("MPa√m"), 2),
        ratios.join(", ")
    );
    let caption = "Figure 1. Growth rate over ΔK: rates (circles), the law over its range (lines), by stress ratio.";
    page +=
        &format!("<div class=\"figs\">\n{}<div>{}</div></div>\n", figure(&law_svg(rates, CHART), caption, ""), constants(fit));
    page += &candidates(fit);
    page += &signatures(signed, "Tested by");
    page += "<h2>Rates as they were read</h2>\n";
    page += &hashes(sources(&fit.sources).into_iter(), HASHES_MOST);
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
    (format!("Law of fatigue crack growth, {name}"), page, fit.version.clone())
}

fn constants(fit: &RatesRecord) -> String {
    let both = json!({ "constants": fit.constants, "standard_errors": fit.standard_errors });
    let fit = &*shown_result(&both);
    let rows = fit["constants"].as_object().into_iter().flatten().map(|(key, value)| {
        let error =
            fit["standard_errors"][key].as_f64().map_or_else(String::new, |error| format!(" ± {}", PRINT.sized(error, 2)));
        let value = value.as_f64().map_or_else(|| quoted(&value.to_string()), |value| PRINT.sized(value, 5));
        format!("<tr><td>{}</td><td>{value}{error}</td></tr>\n", quoted(key))
    });
    format!("<h2>Constants (± one standard error)</h2>\n<table><tbody>\n{}</tbody></table>\n", rows.collect::<String>())
}

fn candidates(fit: &RatesRecord) -> String {
    let row = |one: &CandidateRecord| {
        let (name, left_out) = (one.law.name(), quoted(one.left_out.as_deref().unwrap_or("")));
        format!(
            "<tr><td>{name}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{left_out}</td></tr>\n",
            known(one.rms_log_rate, |rms| PRINT.fixed(rms, 3)),
            known(one.delta_aicc, |delta| PRINT.fixed(delta, 1))
        )
    };
    format!(
        "<h2>Laws compared</h2>\n<div class=\"scroll\"><table><thead><tr><th>Law</th><th class=\"n\">scatter of ln(da/dN)</th><th class=\"n\">AICc over the least</th>\
         <th>Left out because</th></tr></thead><tbody>\n{}</tbody></table></div>\n",
        fit.candidates.iter().map(row).collect::<String>()
    )
}
