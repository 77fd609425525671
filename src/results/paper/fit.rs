//! The report of a fit: law, criteria of ASTM E647, specimen and test, every reading with its rate.

use serde_json::{Value, json};

use super::{
    CHART, PRINT, Signed, cards, figure, hashes, known, letter, mark, number, prose, quoted, recorded, signatures, software,
    table, terms, text,
};
use crate::chart::Size;
use crate::curve::RunTables;
use crate::format::shown_result;
use crate::pictures::fit::{FitTables, RateFitted, law_svg};
use crate::pictures::plate::{Plate, plate_svg};
use perilife_base::units::shown::per;
use perilife_calibration::lack_of_fit::Misfit;
use perilife_calibration::readings::{OUTSIDE, Reading};
use perilife_calibration::record::{CandidateRecord, LivesRecord, RatesRecord, SpecimenRecord};
use perilife_growth::case::record::{FittedLaw, SourceFile};

/// Largest number of files with printed hashes.
const HASHES_MOST: usize = 12;
const SPECIMEN: Size = Size { width: 330.0, height: 280.0, text: 10.5 };

/// Title, page and version of the program that fitted readings.
pub fn of_lives(fit: &LivesRecord, plate: Option<&Plate>, tables: &FitTables, signed: &Signed) -> (String, String, String) {
    let test = &fit.beside["test"];
    let material = test["material"].as_str().unwrap_or("");
    let fitted_to = match test["specimens"].as_u64() {
        Some(count) if count > 1 => format!("{} of {count} specimens", fit.fitted_to),
        _ => fit.fitted_to.clone(),
    };
    let name = if material.is_empty() { fitted_to } else { format!("{material}, {fitted_to}") };
    let mut page = letter(signed, fit.beside["finished"].as_str());
    page += &format!("<h1>Fatigue crack growth rate: {}</h1>\n", quoted(&name));
    let (kind, load) = (test["specimen_kind"].as_str().unwrap_or(""), test["load"].as_str().unwrap_or(""));
    page += &format!("<p class=\"lead\">{} specimen, {}.</p>\n", quoted(&kind.replace('_', " ")), quoted(load));
    page += &answer(fit);
    page += "<div class=\"figs\">\n";
    page += &figure(
        &tables.lives_svg(CHART),
        "Crack length against cycles: readings (circles), fitted law (line), 95 % confidence of its constants (band), other specimens (thin lines).",
        "",
    );
    page += &figure(
        &tables.rates_svg(CHART),
        "da/dN against ΔK: readings used (circles), fitted law over the tested range (line), reference ΔK (ring).",
        "",
    );
    page += "</div>\n";
    page += &criteria(&fit.beside["criteria"]);
    page += &signatures(signed, "Tested by");
    page += &details(fit, plate, signed);
    page += &curve(fit);
    page += &specimens(fit);
    page += &readings(&tables.readings);
    (format!("Fatigue crack growth rate, {name}"), page, fit.version.clone())
}

fn answer(fit: &LivesRecord) -> String {
    let ratio = fit.beside["test"]["stress_ratio"].as_f64().map_or_else(|| recorded(None), |value| PRINT.short(value));
    let rate = format!("{} <small>mm/cycle</small>", PRINT.rate(fit.rate_at_pivot_mm_per_cycle, 4));
    let error = known(fit.rate_at_pivot_relative_error, |error| PRINT.fixed(100.0 * error, 1));
    let c = PRINT.level(fit.paris_c_mm_per_cycle, Some(fit.paris_m), 4);
    let at = format!("Crack growth rate at ΔK = {} MPa√m", PRINT.fixed(fit.pivot_delta_k_mpa_sqrt_m, 2));
    let of_rate = (&*at, rate, format!("± {error} % (one standard error)"));
    let m = PRINT.with_error(fit.paris_m, Some(fit.paris_m_error));
    let (m, error) = m.split_once(" ± ").unwrap_or((&m, "0"));
    let of_m = ("Exponent m", m.to_owned(), format!("± {error}; C = {c}"));
    cards("fit", [of_rate, of_m, valid([fit.delta_k_min_mpa_sqrt_m, fit.delta_k_max_mpa_sqrt_m], &ratio)])
}

fn valid(range: [f64; 2], ratios: &str) -> (&'static str, String, String) {
    let [low, high] = range.map(|k| PRINT.fixed(k * per("MPa√m"), 2));
    ("Valid for ΔK", format!("{low} to {high}"), format!("MPa√m, R = {ratios}"))
}

fn criteria(criteria: &Value) -> String {
    let row = |criterion: &Value| {
        let text = |key: &str| prose(criterion[key].as_str().unwrap_or(""));
        // A criterion that is not met is a caution: the reader judges its effect on the law.
        let met = mark(criterion["holds"].as_bool().filter(|holds| *holds));
        vec![text("name"), text("asked"), text("found"), format!("{met} {}", text("remark"))]
    };
    let Some(rows) = criteria.as_array().filter(|rows| !rows.is_empty()) else {
        return format!("<h2>Criteria of ASTM E647</h2>\n<p>{}</p>\n", recorded(None));
    };
    let head = ["Criterion", "Requirement", "Result", "Assessment"].map(text);
    format!("<h2>Criteria of ASTM E647</h2>\n{}", table("", &head, rows.iter().map(row)))
}

/// Specimen, test, method of the fit, messages, hashes.
fn details(fit: &LivesRecord, plate: Option<&Plate>, signed: &Signed) -> String {
    let beside = &fit.beside;
    let test = &beside["test"];
    let text = |key: &str| recorded(test[key].as_str());
    let number = |key: &str, unit: &str| {
        test[key].as_f64().map_or_else(|| recorded(None), |value| format!("{} {unit}", PRINT.short(value)))
    };
    let yields = known(test["yield_strength_mpa"].as_f64(), |strength| format!("{} MPa (material file)", PRINT.four(strength)));
    let specimen = [
        ("Type", text("specimen_kind").replace('_', " ")),
        ("Material", text("material")),
        ("Width W", number("width_mm", "mm")),
        ("Thickness B", number("thickness_mm", "mm")),
        ("Yield strength", yields),
        ("Initial crack size", number("first_reading_mm", "mm")),
        ("Final crack size", number("last_reading_mm", "mm")),
        ("Specimens", test["specimens"].as_f64().map_or_else(|| recorded(None), |value| PRINT.whole(value))),
        ("Readings", test["readings"].as_f64().map_or_else(|| recorded(None), |value| PRINT.whole(value))),
    ];
    let mut of_test =
        vec![("Load", text("load")), ("Maximum force", text("load_max")), ("Stress ratio R", number("stress_ratio", ""))];
    of_test.extend(signed.conditions(test));
    let mut page = format!(
        "<div class=\"cols paged\"><div><h2>Specimen</h2>{}</div><div><h2>Test</h2>{}</div></div>\n",
        terms(&specimen),
        terms(&of_test)
    );
    let drawing = plate.map_or_else(String::new, |plate| {
        figure(&plate_svg(plate, &RunTables::default(), SPECIMEN), "Specimen as analyzed.", "")
    });
    page += &format!("<div class=\"figs\"><div>{drawing}</div><div>{}</div></div>\n", how(fit));
    let warnings: Vec<String> = fit.warnings.iter().map(|one| quoted(one)).collect();
    if !warnings.is_empty() {
        page += &format!("<h2>Messages</h2>\n<ul class=\"small\"><li>{}</li></ul>\n", warnings.join("</li><li>"));
    }
    page += &software(&fit.version, beside["commit"].as_str());
    let inputs = beside["inputs"].as_array().into_iter().flatten();
    let inputs: Vec<(&str, &str)> = inputs.filter_map(|file| Some((file["file"].as_str()?, file["sha256"].as_str()?))).collect();
    page + &hashes(if inputs.is_empty() { sources(&fit.sources) } else { inputs }.into_iter(), HASHES_MOST)
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
        _ => "Computed for this plate (no handbook formula).".to_owned(),
    };
    let life = match (fit.life_measured, fit.life_fitted, fit.rms_life_error) {
        (Some(measured), Some(fitted), Some(rms)) => format!(
            " Life over the fit window: measured {}, fitted {} cycles; rms fit error {} %.",
            PRINT.whole(measured),
            PRINT.whole(fitted),
            PRINT.fixed(100.0 * rms, 2)
        ),
        _ => String::new(),
    };
    let window =
        format!(" Fit window: a = {} to {} mm.", PRINT.short(fit.from_crack_length_mm), PRINT.short(fit.to_crack_length_mm));
    let criterion = fit.criterion.name().replace('_', " ");
    let method = match fit.law {
        FittedLaw::Curve => {
            "Natural spline of ln da/dN against ln ΔK by restricted maximum likelihood, scaled to the lives; C and m by least \
                          squares on cycles at equal crack length"
        }
        FittedLaw::Paris => "Least squares on cycles at equal crack length",
    };
    let misfit = |of: Misfit| {
        let [from, to] = [of.delta_k_from_mpa_sqrt_m, of.delta_k_to_mpa_sqrt_m].map(|k| PRINT.fixed(k, 2));
        format!("{} % at ΔK {from} to {to} MPa√m", PRINT.fixed(of.rate_over_law_percent, 1))
    };
    let ends: Vec<String> = [fit.misfit_at_ends.low, fit.misfit_at_ends.high].into_iter().flatten().map(misfit).collect();
    let ends = if ends.is_empty() {
        String::new()
    } else {
        format!(" Measured rate against law at the ends of the range: {}.", ends.join("; "))
    };
    format!(
        "<h2>Stress intensity</h2><p>{formula}</p><h2>Growth rates</h2><p>Seven-point incremental polynomial (Appendix X1); secant where \
         a test has fewer than seven readings or the load changes. The first and last three readings have no rate.</p>\
         <h2>Fitted law</h2><p>da/dN = C ΔK<sup>m</sup>. {method}, criterion {}.{window}{life}{ends} C and m are correlated: quote the rate at \
         the reference ΔK together with m.</p><h2>Use beyond this test</h2><p>Not valid outside the tested ΔK or at another R.</p>",
        quoted(&criterion)
    )
}

fn curve(fit: &LivesRecord) -> String {
    let Some(curve) = &fit.curve else { return String::new() };
    let row = |i: usize| {
        vec![
            PRINT.fixed(curve.delta_k_mpa_sqrt_m[i] * per("MPa√m"), 3),
            format!(
                "{} ± {} %",
                PRINT.rate(curve.da_dn_mm_per_cycle[i], 4),
                PRINT.fixed(100.0 * curve.da_dn_relative_error[i], 1)
            ),
            format!("{} ± {}", PRINT.fixed(curve.m[i], 2), PRINT.fixed(curve.m_error[i], 2)),
        ]
    };
    let head = [number("ΔK, MPa√m"), number("da/dN, mm/cycle"), number("local m")];
    format!(
        "<h2>Fitted curve</h2>\n<p class=\"key\">Law used for lives: natural spline of ln da/dN against ln ΔK through these knots. C and m are the \
         best power law.</p>\n{}",
        table("readings", &head, (0..curve.m.len()).map(row))
    )
}

fn specimens(fit: &LivesRecord) -> String {
    if fit.specimens.len() < 2 {
        return String::new();
    }
    let row = |one: &SpecimenRecord| {
        let [measured, fitted] = [one.life_measured, one.life_fitted].map(|life| known(life, |life| PRINT.whole(life)));
        vec![quoted(&one.name), measured, fitted, known(one.rms_life_error, |error| PRINT.fixed(100.0 * error, 2))]
    };
    let head =
        [text("Specimen"), number("Life measured, cycles"), number("Life fitted, cycles"), number("rms fit error of life, %")];
    format!("<h2>Specimens</h2>\n{}", table("readings", &head, fit.specimens.iter().map(row)))
}

fn readings(readings: &[Reading]) -> String {
    let row = |(place, reading): (usize, &Reading)| {
        let flags =
            [quoted(&reading.marks.replace('_', " ")), if reading.method == "secant" { "secant".into() } else { "".into() }];
        let excluded = Some(quoted(&reading.left_out))
            .filter(|why| !why.is_empty())
            .map(|why| if why == OUTSIDE { why } else { format!("excluded: {why}") });
        let flags: Vec<String> = flags.into_iter().filter(|words| !words.is_empty()).chain(excluded.clone()).collect();
        let cells = vec![
            (place + 1).to_string(),
            quoted(&reading.specimen),
            known(reading.cycles, |cycles| PRINT.whole(cycles)),
            known(reading.crack_length_mm, |length| PRINT.fixed(length * per("mm"), 3)),
            known(reading.delta_k_mpa_sqrt_m, |delta_k| PRINT.fixed(delta_k * per("MPa√m"), 2)),
            known(reading.da_dn_mm_per_cycle, |growth| PRINT.rate(growth, 3)),
            flags.join("; "),
        ];
        let gray = |cell: String| if excluded.is_some() { format!("<span class=\"quiet\">{cell}</span>") } else { cell };
        cells.into_iter().map(gray).collect::<Vec<String>>()
    };
    let head =
        [number("No."), text("Specimen"), number("N, cycles"), number("a, mm"), number("ΔK, MPa√m"), number("da/dN, mm/cycle")];
    format!(
        "<h2>Readings and growth rates</h2>\n<p class=\"key\">N and a as read. ΔK and da/dN at the middle of the readings of the rate; \
         –: no rate. Flagged readings are used; gray ones are not: excluded with the reason, or outside the fit window.</p>\n{}",
        table("readings", &[&head[..], &[text("Flags")]].concat(), readings.iter().enumerate().map(row))
    )
}

/// Title, page and version of the program that fitted rates.
pub fn of_laws(fit: &RatesRecord, rates: &[RateFitted], signed: &Signed) -> (String, String, String) {
    let law = fit.law.name();
    let name = if fit.material.is_empty() { law.to_owned() } else { format!("{}, {law}", fit.material) };
    let mut page = letter(signed, None);
    page += &format!("<h1>Fatigue crack growth law: {}</h1>\n", quoted(&name));
    let ratios: Vec<String> = fit.stress_ratios.iter().copied().map(|value| PRINT.short(value)).collect();
    let of_law = ("Law", quoted(law), format!("fitted to {} rates", PRINT.whole(fit.rates as f64)));
    let scatter = known(fit.rms_log_rate, |rms| PRINT.fixed(rms, 3));
    let scatter = ("Scatter of ln(da/dN)", scatter, "root mean square".to_owned());
    let range = [fit.delta_k_min_mpa_sqrt_m, fit.delta_k_max_mpa_sqrt_m];
    page += &cards("", [of_law, scatter, valid(range, &ratios.join(", "))]);
    let caption = "da/dN against ΔK: measured rates (circles), fitted law at each stress ratio (lines).";
    page +=
        &format!("<div class=\"figs\">\n{}<div>{}</div></div>\n", figure(&law_svg(rates, CHART), caption, ""), constants(fit));
    page += &candidates(fit);
    page += &signatures(signed, "Tested by");
    page += &software(&fit.version, None);
    page += &hashes(sources(&fit.sources).into_iter(), HASHES_MOST);
    let row = |(place, row): (usize, &RateFitted)| {
        vec![
            (place + 1).to_string(),
            quoted(&row.series),
            PRINT.short(row.stress_ratio),
            PRINT.fixed(row.delta_k_mpa_sqrt_m * per("MPa√m"), 3),
            PRINT.rate(row.da_dn_mm_per_cycle, 3),
            PRINT.rate(row.da_dn_fitted_mm_per_cycle, 3),
        ]
    };
    let head = ["R", "ΔK, MPa√m", "da/dN, mm/cycle", "fitted law, mm/cycle"].map(number);
    let head = [&[number("No."), text("Test")][..], &head[..]].concat();
    page += &format!("<h2>Rates</h2>\n{}", table("readings", &head, rates.iter().enumerate().map(row)));
    (format!("Fatigue crack growth law, {name}"), page, fit.version.clone())
}

fn constants(fit: &RatesRecord) -> String {
    let both = json!({ "constants": fit.constants, "standard_errors": fit.standard_errors });
    let fit = shown_result(&both);
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
        vec![
            one.law.name().to_owned(),
            known(one.rms_log_rate, |rms| PRINT.fixed(rms, 3)),
            known(one.delta_aicc, |delta| PRINT.fixed(delta, 1)),
            quoted(one.left_out.as_deref().unwrap_or("")),
        ]
    };
    let head = [text("Law"), number("Scatter of ln(da/dN)"), number("ΔAICc"), text("Rejected because")];
    format!("<h2>Laws compared</h2>\n{}", table("", &head, fit.candidates.iter().map(row)))
}
