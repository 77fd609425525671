//! What the page makes of a file whose columns it does not know, and of a fit of laws; pictures stand in `target/tmp/page/` afterwards.

use std::fs;
use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use super::QUICK;
use crate::support::browser::Browser;
use crate::support::server::Server;

const UNKNOWN: &str = "Rig 7, sheet B12\nzeit,riss,kraft,temperatur\n0,9.0,6.1,21.2\n20000,10.2,6.1,21.3\n35000,11.9,6.1,21.4\n\
                       47000,13.8,6.1,21.3\n56000,16.1,6.1,21.2\n62000,18.4,6.1,21.1\n";

fn picture(page: &Browser, name: &str) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("page");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(format!("{name}.png")), page.picture()).unwrap();
}

#[test]
fn columns_that_nobody_knows_are_chosen_on_the_page() {
    let Some(page) = Browser::start() else { return };
    let (dir, service) = Server::alone(&["--jobs", "1"]);
    page.look(1280, 900, "light");
    page.open(&format!("{}/#/measure", service.url));
    page.see("#test-fields fieldset");
    let file = dir.path().join("unknown.csv");
    fs::write(&file, UNKNOWN).unwrap();
    page.fill("#measured-input", file.to_str().unwrap());
    page.see("[data-problems] table");
    picture(&page, "unknown_columns");
    // What to do is said in the terms of the page; the first rows stand in the table of columns once.
    let told = page.text("[data-problems]");
    assert!(told.contains("Assign columns above") && told.contains("unknown column"), "{told}");
    assert!(!told.contains("read so far") && !told.contains("20000"), "{told}");
    let rows = page.text("[data-file='unknown.csv'] [data-table=columns]");
    assert!(["zeit", "riss", "20000", "21.4"].iter().all(|words| rows.contains(words)), "{rows}");
    let choose = |column: &str, key: &str| {
        page.run(&format!(
            "const one = document.querySelector(\"[data-column='{column}']\"); one.value = '{key}'; one.dispatchEvent(new Event('change'))"
        ));
        page.until(&format!("document.querySelector(\"[data-column='{column}']\").value === '{key}'"));
    };
    choose("zeit", "cycles");
    choose("riss", "length");
    page.until("document.querySelector('[data-problems]')?.innerText.includes('has no unit')");
    page.run("const unit = document.querySelector('#units [data-key=\"measured.length_unit\"]'); unit.value = 'mm'; unit.dispatchEvent(new Event('input', { bubbles: true }))");
    page.until("document.querySelector('#measured').dataset.measured === 'ok'");
    let read = page.text("[data-file='unknown.csv']");
    assert!(read.contains("6 readings: 9 to 18.4 mm"), "{read}");
    // Whoever has said what the columns are knows which are not read.
    assert_eq!(page.count("#measured-result .warn"), 0);
    // The test is checked together with them.
    page.until("!document.querySelector('.side').innerText.includes('Load measured data first')");
    picture(&page, "unknown_columns_chosen");
}

/// From the file of a laboratory to a report in print: 14 actions at most, of some four seconds of a practised hand each, beside what the program takes.
#[test]
fn a_file_becomes_a_report_in_few_actions() {
    let Some(page) = Browser::start() else { return };
    let (dir, service) = Server::alone(&["--jobs", "1"]);
    let file = dir.path().join("panel_7.csv");
    let rows =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/al2024-t3/measured/virkler_median.csv"));
    fs::write(&file, format!("W,152.4,mm\nB,2.54,mm\nR,0.2\n{}", rows.unwrap())).unwrap();
    page.look(1280, 900, "light");
    page.open(&service.url);
    let begun = Instant::now();
    page.click("#new-kinds a[href='#/measure']");
    page.fill("#measured-input", file.to_str().unwrap());
    page.see("[data-file='panel_7.csv']");
    page.fill("#view-measure [data-key='specimen.length_mm']", "300");
    page.fill("#view-measure [data-key='loading.stress_max_mpa']", "60.35");
    page.see("#calibrate:not([disabled])");
    page.click("#calibrate");
    page.see("#job[data-job-state=succeeded]");
    page.click("[data-action=report]");
    for (key, value) in [("laboratory", "Lab North"), ("number", "R-7"), ("operator", "N. N."), ("reviewer", "M. M.")] {
        page.fill(&format!("#report-dialog [data-key='report.{key}']"), value);
    }
    let opened = page.window_of("[data-action=open-report]");
    page.open(&format!("{}{opened}", service.url));
    let (actions, waited) = (page.actions.get() + 1, begun.elapsed().as_secs_f64());
    println!("{actions} actions with that of printing, {waited:.1} s of the program and the driver");
    assert!(actions <= 14, "{actions}");
    let report = page.text("main");
    assert!(["Lab North", "R-7", "N. N.", "M. M.", "152.4", "60.35"].iter().all(|words| report.contains(words)), "{report}");
}

#[test]
fn a_fit_of_laws_has_a_page() {
    let (_dir, service) = Server::alone(&["--jobs", "1"]);
    let row = |k: u32, ratio: f64| {
        let k = f64::from(k);
        format!("{k},{:e},{ratio}\n", 1e-8 * (k / (1.0_f64 - ratio).powf(0.5)).powi(3))
    };
    let rows: String = [0.1, 0.5].iter().flat_map(|ratio| (6..30).map(|k| row(k, *ratio))).collect();
    let table = format!("delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,stress_ratio\n{rows}");
    let input = "[measured]\nrates = [\"rates.csv\"]\n[fit]\nlaw = \"best\"\n";
    let body = json!({ "name": "laws", "input": input, "files": { "rates.csv": table } });
    let job = service.submit("calibrations", &body);
    let done = service.succeeded(&job);
    let summary: &Value = &done["summary"];
    assert_eq!(summary["law"], "walker", "{summary}");
    assert!((summary["constants"]["walker_gamma"].as_f64().unwrap() - 0.5).abs() < 1e-6, "{summary}");
    // A prediction takes the law of the job.
    let case = QUICK.replace("stress_ratio = 0.1", "stress_ratio = 0.3").replace("spacing_mm = 1.5", "method = \"handbook\"");
    let id = job.rsplit('/').next().unwrap();
    let life = service.submit("predictions", &json!({ "name": "life", "input": case, "calibration": id }));
    let life = service.succeeded(&life);
    assert!(life["summary"]["life_cycles"].as_f64().unwrap() > 1e3, "{life}");
    let Some(page) = Browser::start() else { return };
    page.look(1280, 900, "light");
    page.open(&format!("{}/#/{}", service.url, job.trim_start_matches("/v1/")));
    page.see("[data-table=candidates]");
    let laws = page.text("[data-table=candidates]");
    assert!(["paris", "walker", "nasgro_alpha cannot be determined"].iter().all(|words| laws.contains(words)), "{laws}");
    assert!(page.text("[data-table=constants]").contains("walker_gamma"));
    picture(&page, "laws");
    let complaints = page.complaints();
    assert!(complaints.is_empty(), "{complaints:?}");
}
