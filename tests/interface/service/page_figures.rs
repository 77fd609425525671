//! One figure has one rounding: the page says what console and report say, in either units.

use std::fs;
use std::path::Path;

use perilife_results::band::OF_FLEET;
use perilife_results::format::{PLAIN, within};
use serde_json::{Value, json};

use super::page::Walk;
use crate::support::rows::assert_says;
use crate::support::server::Server;

/// What a fleet, a run without a stated error, an inspection and the view in inches show is said once.
pub fn one_figure_has_one_rounding(walk: &Walk, service: &Server, fit: &str) {
    let page = &walk.browser;
    let run = |case: &str, options: Value| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cases");
        let input = fs::read_to_string(folder.join(format!("{case}.toml"))).unwrap();
        let job = service.submit("predictions", &json!({ "name": case, "input": input, "options": options }));
        let summary = service.succeeded(&job)["summary"].clone();
        page.open(&format!("{}{}", service.url, job.replace("/v1/", "/#/")));
        page.see("[data-part=remaining]");
        page.until("!document.querySelector('[data-part=remaining] dl:empty')");
        summary
    };
    let shown = |selector: &str| page.text(selector).replace('\u{202f}', "");

    // The interval of a fleet is that of its plates alone.
    let fleet = run("fleet_of_panels", json!({ "inspect_from_mm": 12, "pod": "12,20" }));
    let promised = |inspection: &Value, key: &str, band: &[f64; 3]| {
        let cycles = inspection[key].as_f64().unwrap();
        PLAIN.promised(cycles, cycles, band).replace(' ', "")
    };
    let every = format!("{} cycles", promised(&fleet["fleet"]["inspections"], "interval_cycles", &OF_FLEET));
    for card in ["[data-part=result]", "[data-part=remaining]", "[data-part=detection]"] {
        assert_says(&shown(card), &[&every]);
    }
    assert_eq!(page.count("#today-length"), 0);
    let of_one = promised(&fleet["inspection"], "inspection_interval_cycles", &OF_FLEET);
    assert!(!shown("main").contains(&of_one[..3]), "{of_one}");

    // Cycles have the digits of their error; an inspection starts where it was asked for.
    let beside = run("crack_beside_hole", json!({ "inspect_from_mm": 15, "pod": "12,20", "residual_strength": true }));
    let error = beside["error_estimate_percent"].as_f64();
    let digits = |key: &str, of: &Value| PLAIN.by_error(of[key].as_f64().unwrap(), error).replace(' ', "");
    let (life, left) = (digits("life_cycles", &beside), digits("remaining_cycles", &beside["inspection"]));
    page.see("[data-value=remaining_cycles]");
    assert_eq!(shown("[data-value=remaining_cycles]"), format!("{left} cycles"));
    assert_says(&shown("[data-terms=remaining]"), &[format!("of {life} cycles")]);
    let every = promised(&beside["inspection"], "inspection_interval_cycles", &within(error));
    assert_eq!(shown("[data-value=inspection_interval_cycles]"), format!("{every} cycles"));
    assert_says(&shown("[data-part=result]"), &[format!("{life} cycles")]);
    assert_eq!(page.run("return document.querySelector('#today-length').value"), "15.00");
    assert_says(&shown("[data-terms=detection]"), &["from 15.00 mm", ", every "]);

    // In inches a length is rounded once, keys have their names there, bars are round.
    page.run("localStorage.setItem('perilife.units', 'us'); location.reload()");
    page.until("document.readyState === 'complete'");
    page.see("[data-chart=life] .end-mark");
    page.see("[data-chart=strength] path[data-series=strength]");
    let inches = |mm: &Value, decimals: usize| format!("{:.decimals$} inch", mm.as_f64().unwrap() / 25.4);
    let end = &beside["crack_length_final_mm"];
    assert_says(&shown("[data-part=result]"), &[inches(end, 4), "stop.crack_length_in".to_owned()]);
    assert_says(&shown("[data-chart=life]"), &[inches(end, 3)]);
    let start = page.run("return document.querySelector('#today-length').value");
    assert_eq!(start, "0.5906");
    let bars = page.run("return [...document.querySelectorAll('.plate-rule text')].map((one) => one.textContent)");
    assert!(bars.as_array().unwrap().iter().all(|bar| matches!(bar.as_str(), Some("0.5 inch" | "0.2 inch"))), "{bars}");
    walk.look("17_inches");
    let law = service.get(&format!("/v1/calibrations/{fit}")).json()["summary"].clone();
    page.open(&format!("{}/#/calibrations/{fit}", service.url));
    page.see("[data-chart=rates] path[data-series=law]");
    let least = format!("For ΔK {:.3} to ", law["delta_k_min_mpa_sqrt_m"].as_f64().unwrap() / 1.098_843_4);
    let rate = format!("{:.2e}", law["rate_at_pivot_mm_per_cycle"].as_f64().unwrap() / 25.4).replace("e-", " × 10⁻");
    assert_says(&shown("[data-part=result] .life"), &[&rate[..rate.len() - 1], "in/cycle"]);
    assert_says(&shown("[data-part=result]"), &[least]);
    page.run("localStorage.setItem('perilife.units', 'si'); location.reload()");
    page.until("document.readyState === 'complete'");
}
