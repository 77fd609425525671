//! A walk through the whole page in a real browser: upload, calibrate, predict, watch it grow, download, compare.
//!
//! Pictures of it stand in `target/tmp/page/` afterwards, to be looked at.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde_json::json;
use tempfile::tempdir;

use super::page_figures::one_figure_has_one_rounding;
use super::{SLOW, of};
use crate::interface::cli::perilife;
use crate::support::browser::Browser;
use crate::support::rows::assert_says;
use crate::support::server::{Server, in_folder};
use crate::support::workbook::workbook;

const DELETE: char = '\u{e017}';
const RIGHT: char = '\u{e014}';
const ENTER: char = '\u{e007}';
const END: char = '\u{e010}';

const BROKEN: &str = "specimen,cycles,crack_length_mm\nA1,0,9\nA1,12000,9.6\nA1,21000,10.2\nA1,many,10.9\nA1,39000,11.7\n\
    A1,4100,12.4\nA1,47000,13.3\nA1,60000,14.4\nA1,66000,15\n<img src=x onerror=alert(1)>,-1,9\nA1,99000,20\n";

/// Readings with the loads of each.
const LOADED: &str =
    "cycles,a_mm,Pmax_kN,Pmin_kN\n0,11.0,2.80,0.28\n7000,11.42,2.80,0.28\n13600,11.84,2.80,0.28\n19640,12.3,2.80,0.28\n";

/// Every visible field has a name, every picture words, every table a caption; nothing is wider than the window, and on a phone
/// everything is large enough for a finger.
const FLAWS: &str = r#"
const flaws = [], seen = (e) => e.getClientRects().length > 0;
for (const e of document.querySelectorAll("input,select,textarea"))
    if (seen(e) && !e.labels?.length && !e.getAttribute("aria-label")) flaws.push("no label: " + e.outerHTML.slice(0, 90));
for (const e of document.querySelectorAll("button,a"))
    if (seen(e) && !(e.textContent.trim() || e.getAttribute("aria-label"))) flaws.push("no name: " + e.outerHTML.slice(0, 90));
for (const e of document.querySelectorAll("img")) if (!e.hasAttribute("alt")) flaws.push("no words: " + e.src);
for (const e of document.querySelectorAll("table")) if (!e.caption) flaws.push("no caption: " + e.outerHTML.slice(0, 60));
const ids = [...document.querySelectorAll("[id]")].map((e) => e.id);
for (const id of new Set(ids)) if (ids.filter((other) => other === id).length > 1) flaws.push("twice: #" + id);
if (document.documentElement.scrollWidth > innerWidth + 1) flaws.push("wider than the window");
if (innerWidth < 600) for (const e of document.querySelectorAll("main button, main select, main input"))
    if (seen(e) && e.type !== "checkbox" && e.getBoundingClientRect().height < 43 && !e.closest("td, p")) flaws.push("small: " + e.outerHTML.slice(0, 90));
return flaws;
"#;

/// Readings of another specimen beside the example, as a workbook.
fn more() -> Vec<u8> {
    let row = |i: i32| [9.0 + f64::from(i), 300_000.0 * (1.0 - 0.9_f64.powi(i))].map(|number| number.to_string()).to_vec();
    let header = ["crack_length_mm", "cycles"].map(str::to_owned).to_vec();
    workbook(&[("readings", std::iter::once(header).chain((0..30).map(row)).collect())])
}

/// A browser, and the folder for pictures of what it sees.
pub struct Walk {
    pub browser: Browser,
    pub pictures: PathBuf,
}

impl Walk {
    /// Looks at the page: keeps a picture, finds no flaw.
    pub fn look(&self, name: &str) {
        fs::write(self.pictures.join(format!("{name}.png")), self.browser.picture()).unwrap();
        let flaws = self.browser.run(FLAWS);
        assert_eq!(flaws, json!([]), "{name}");
        // What a browser says of every answer that is an error is meant where input is wrong on purpose.
        let complaints: Vec<String> =
            self.browser.complaints().into_iter().filter(|line| !line.contains("status of 4")).collect();
        assert!(complaints.is_empty(), "{name}: {complaints:?}");
    }

    /// Clicks, and waits for a job to end well.
    pub fn start(&self, button: &str) -> String {
        // No user presses a button in the millisecond in which the page opens; if this one did, the press was lost.
        for _ in 0..3 {
            self.browser.see(&format!("{button}:not([disabled])"));
            self.browser.click(button);
            if self.browser.comes("#job", Duration::from_secs(15)) {
                break;
            }
        }
        self.browser.see("#job");
        self.browser.run("return document.querySelector('#job').dataset.jobId").as_str().unwrap().to_owned()
    }
}

#[test]
fn the_page_leads_from_readings_to_remaining_life() {
    let Some(browser) = Browser::start() else { return };
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let service = Server::start(&place, &["--jobs", "1"]);
    let pictures = Path::new(env!("CARGO_TARGET_TMPDIR")).join("page");
    fs::create_dir_all(&pictures).unwrap();
    let walk = Walk { browser, pictures };
    let page = &walk.browser;
    page.look(1280, 900, "light");
    page.open(&service.url);
    page.see("#new-kinds a[href*=example]");
    walk.look("01_start");
    page.click("#new-kinds a[href='#/measure']");

    // Readings with mistakes are shown where they are wrong.
    let broken = dir.path().join("broken.csv");
    fs::write(&broken, BROKEN).unwrap();
    page.fill("#measured-input", broken.to_str().unwrap());
    page.see("[data-problems]");
    page.until("document.querySelector('#measured').dataset.measured === 'problem'");
    let found = page.text("[data-problems]");
    assert_says(&found, &["many", "is not a number", "is below the previous reading", "is negative"]);
    walk.look("02_problems");
    // A row is left out by its line and value with a reason; the file stays as it was dropped.
    let count = page.count("[data-action=take-out]");
    page.click("[data-action=take-out]");
    page.see(".edit-in-place:focus");
    page.press(&"typing error".chars().chain([ENTER]).collect::<Vec<char>>());
    page.until(&format!("document.querySelectorAll('[data-action=take-out]').length === {}", count - 1));
    let left_out = page.text("[data-part=left-out]");
    assert!(left_out.contains("broken.csv, line ") && left_out.contains("(many): typing error"), "{left_out}");
    page.click("[aria-label='Remove broken.csv']");
    page.run(
        "const data = new DataTransfer();
        data.items.add(new File(['cycles;crack_length_mm\\n0;9,0\\n20000;10,5\\n35000;12,5\\n'], 'dropped.csv'));
        document.querySelector('#measured-drop').dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true }));",
    );
    page.see("[data-file='dropped.csv']");
    assert!(page.text("[data-file='dropped.csv']").contains("decimal commas"));
    page.click("[aria-label='Remove dropped.csv']");
    // What a laboratory notes above its table: a material that the library has not leaves none, loads of the readings have their own R.
    for (noted, material, said) in [
        ("Material,Inconel 718", "", "Material in the file: Inconel 718; choose one"),
        ("Werkstoff: EN AW-2024 T3\nRissebene: T-L", "al2024-t3-clad-tl", "read from noted_17.csv"),
        ("Material: AA 7075-T651\nOrientation: T-L", "al7075-t651-sheet-lt", "no record of orientation T-L"),
    ] {
        let name = format!("noted_{}.csv", material.len());
        let file = dir.path().join(&name);
        fs::write(&file, format!("R,0.5\n{noted}\nW,50,mm\n{LOADED}")).unwrap();
        page.fill("#measured-input", file.to_str().unwrap());
        page.until(&format!("document.querySelector('#test-fields').innerText.includes('{said}')"));
        let value = |key: &str| page.run(&format!("return document.querySelector(\"#test-fields [data-key='{key}']\").value"));
        assert_eq!((value("material.name"), value("loading.stress_ratio")), (material.into(), "0.1".into()), "{noted}");
        assert_eq!(
            page.text("#test-fields").matches(&format!("read from {name}")).count(),
            if material.is_empty() { 3 } else { 4 }
        );
        page.click(&format!("[aria-label='Remove {name}']"));
        page.until("document.querySelector('#measured').dataset.measured === 'empty'");
    }

    // A good file, the test it is of, a fit.
    page.click("#example");
    page.see("#calibrate:not([disabled])");
    // Tables that are no text go up as they are.
    let table = dir.path().join("more.xlsx");
    fs::write(&table, more()).unwrap();
    page.fill("#measured-input", table.to_str().unwrap());
    page.see("[data-file='more.xlsx']");
    page.until("document.querySelector('#test-check').textContent.includes('2 specimens')");
    page.see("#calibrate:not([disabled])");
    page.click("[aria-label='Remove more.xlsx']");
    page.until("!document.querySelector('#test-check').textContent.includes('2 specimens')");
    page.see("#calibrate:not([disabled])");
    page.fill("#view-measure [data-key='specimen.width_mm']", "15");
    page.until("document.querySelectorAll('#view-measure [aria-invalid=true]').length === 1");
    page.fill("#view-measure [data-key='specimen.width_mm']", "152.4");
    page.run("document.querySelector('[data-chart=measured] svg[tabindex]').focus()");
    page.press(&[RIGHT, RIGHT, END]);
    assert!(page.text("[data-chart=measured] .chart-readout").contains("Crack length"));
    page.see("#calibrate:not([disabled])");
    walk.look("03_example");
    let fit = walk.start("#calibrate");
    page.see("#job[data-job-state=succeeded]");
    page.see("[data-chart=fit] path[data-series].band, [data-chart=fit] path.band");
    walk.look("04_fit");
    let summary = service.get(&format!("/v1/calibrations/{fit}")).json()["summary"].clone();
    let exponent = format!("{:.4}", summary["paris_m"].as_f64().unwrap());
    // Ticks are those of the picture of the run.
    let ticks = page.run(
        "return [...document.querySelectorAll('[data-chart=rates] svg text')].map((one) => one.textContent).filter((text) => /^[\\d.]+$/.test(text))",
    );
    let svg = String::from_utf8(service.file(&format!("/v1/calibrations/{fit}"), "da_dn.svg")).unwrap();
    let texts = svg.split("</text>").filter_map(|part| part.rsplit('>').next());
    let drawn: Vec<&str> = texts.filter(|text| text.parse::<f64>().is_ok()).collect();
    assert!(drawn.len() > 3 && ticks == json!(drawn), "{ticks} {drawn:?}");
    // A misfit is judged as a life with the law judges it.
    let marks = page.run("return [...document.querySelectorAll('[data-mark]')].map((one) => one.dataset.mark)");
    assert!(page.text("[data-table=constants]").contains(&exponent), "{exponent} in {}", page.text("[data-table=constants]"));

    // Renamed where it stands.
    page.click("#job [data-action=rename]");
    page.see("#job .edit-in-place:focus");
    page.press(&"Example law".chars().chain([ENTER]).collect::<Vec<char>>());
    page.until("document.querySelector('#job h1').textContent === 'Example law'");
    assert_eq!(service.get(&format!("/v1/calibrations/{fit}")).json()["name"], "Example law");

    // A plate with this law, drawn with a second crack that goes again; on points, which take long enough to look on.
    page.click("[data-action=use-law]");
    page.until("document.querySelector('#plate-check').textContent.includes('Required: ')");
    page.until("document.querySelector(\"#view-predict [data-key='loading.stress_ratio']\").value === '0.2'");
    walk.look("04b_use_law");
    page.click("#plate-example");
    page.fill("#view-predict [data-key='model.spacing_mm']", "0.5");
    page.see("#predict:not([disabled])");
    let cracks = page.count("[data-rows=cracks] tbody tr");
    page.click("[data-tool=crack]");
    let drag = "const svg = document.querySelector('.sketch svg.plate'); svg.scrollIntoView({ block: 'center' });
        const box = svg.getBoundingClientRect(); return [box.x, box.y, box.width, box.height]";
    let numbers: Vec<f64> = serde_json::from_value(page.run(drag)).unwrap();
    drag_pointer(page, &numbers, [0.40, 0.30], [0.50, 0.34]);
    page.until(&format!("document.querySelectorAll('[data-rows=cracks] tbody tr').length === {}", cracks + 1));
    page.run(&format!("document.querySelector(\"[data-handle='Crack {} end']\").focus()", cracks + 1));
    page.press(&[RIGHT, DELETE]);
    page.until(&format!("document.querySelectorAll('[data-rows=cracks] tbody tr').length === {cracks}"));
    page.see("#plate-check [data-check=ok], #plate-check.check-state[data-check=ok], [data-check=ok]");
    walk.look("05_plate");

    // It grows while one looks on.
    let first = walk.start("#predict");
    page.see("#job[data-job-state=running]");
    page.see("[data-chart=life] path[data-series]");
    let early = page
        .run("return document.querySelector('[data-chart=life] path[data-series]').getAttribute('d').length")
        .as_u64()
        .unwrap();
    page.until(&format!(
        "document.querySelector('#job[data-job-state=succeeded]') || \
         document.querySelector('[data-chart=life] path[data-series]').getAttribute('d').length > {early}"
    ));
    page.see("#view-run [data-plate=whole] .growing");
    walk.look("06_running");
    page.see("#job[data-job-state=succeeded]");
    page.see("[data-value=remaining_cycles]");
    let done = service.get(&format!("/v1/predictions/{first}")).json();
    // With a band its median, with as many digits as that deserves.
    let summary = &done["summary"];
    let expected = match summary["band"]["cycles_p50"].as_f64() {
        Some(median) => format!("{median:.0}")[..1].to_owned(),
        None => format!("{:.0}", summary["life_cycles"].as_f64().unwrap()),
    };
    assert!(digits(&page.text("[data-value=life_cycles]")).starts_with(&expected), "{expected}");
    let fit_check = summary["checks"].as_array().unwrap().iter().find(|check| check["name"] == "lack_of_fit").unwrap();
    let is_passed = fit_check["verdict"] == "passed";
    assert_eq!(is_passed, marks.as_array().unwrap().iter().all(|mark| mark == "ok"), "{fit_check} {marks}");
    assert!(marks.as_array().is_some_and(|marks| !marks.is_empty()));
    assert_eq!(done["calibration"], fit.as_str());
    walk.look("07_predicted");

    // One place along the life for plate, curve and K; a report to take away.
    page.run(
        "const place = document.querySelector('#place'); place.value = 500; place.dispatchEvent(new Event('input', { bubbles: true }));",
    );
    page.until("document.querySelector('[data-part=place]').textContent.includes('50 % of life')");
    page.see("#view-run [data-plate=whole] .way .to-come");
    page.see("#view-run [data-plate=whole] .way path:not(.to-come)");
    page.see("[data-chart=factors] path[data-series=k1]");
    page.see("[data-action=report]");

    // What is left from a length on, and when to look again.
    let [from, to] = ["crack_length_initial_mm", "crack_length_final_mm"].map(|key| done["summary"][key].as_f64().unwrap());
    let today = format!("{:.1}", 0.5 * (from + to));
    page.fill("#today-length", &today);
    page.fill("#inspection-factor", "3");
    let left = service.get(&format!("/v1/predictions/{first}/remaining?crack_length_mm={today}&factor=3")).json();
    let whole = format!("{:.0}", left["inspection_interval_cycles"].as_f64().unwrap().floor());
    assert_eq!(left["has_band"], true);
    let interval = &whole[..2];
    page.until(&format!(
        "document.querySelector('[data-value=inspection_interval_cycles]')?.innerText.replace(/\\D/g, '').startsWith('{interval}')"
    ));

    // Files come down as they are.
    let downloads = tempdir().unwrap();
    page.download_into(downloads.path());
    for name in ["a_n.csv", "result.json", "plate.svg"] {
        page.click(&format!("[data-file='{name}'] button"));
        let (file, begun) = (downloads.path().join(name), Instant::now());
        while fs::read(&file).is_ok_and(|bytes| bytes.is_empty()) || !file.exists() {
            assert!(begun.elapsed() < crate::support::server::PATIENCE, "{name} does not come");
            std::thread::sleep(Duration::from_millis(50));
        }
        assert!(fs::read(&file).unwrap() == service.file(&format!("/v1/predictions/{first}"), name), "{name} differs");
    }

    // The report data are kept with the run, those of the laboratory proposed for the next; further analyses are runs of their own.
    page.click("[data-action=report]");
    page.see("#report-dialog[open] #report-interval:checked");
    page.fill("#report-dialog [data-key='report.laboratory']", "Lab North");
    page.fill("#report-dialog [data-key='report.number']", "R-7");
    walk.look("15_report_dialog");
    let opened = page.window_of("[data-action=open-report]");
    page.until("!document.querySelector('#report-dialog')");
    assert_eq!(service.get(&format!("/v1/predictions/{first}")).json()["report"]["laboratory"], "Lab North");
    page.click("[data-part=further] [data-action=sensitivities]");
    page.see("[data-part=sensitivities] img:not([hidden])");
    // The form knows what else its run found.
    let found = page.run("return document.querySelector('#job').dataset.jobId").as_str().unwrap().to_owned();
    page.open(&format!("{}/#/predict?from=predictions/{found}", service.url));
    page.until("document.querySelector('#view-predict').textContent.includes('Further analysis: sensitivities')");
    page.open(&format!("{}/#/predictions/{found}", service.url));
    page.click("[data-action=report]");
    let proposed =
        |key: &str| page.run(&format!("return document.querySelector(\"#report-dialog [data-key='report.{key}']\").value"));
    assert_eq!((proposed("laboratory"), proposed("number")), ("Lab North".into(), "".into()));
    page.open(&format!("{}{opened}", service.url));
    fs::write(walk.pictures.join("15_report.png"), page.picture()).unwrap();
    assert!(["Validity", "Lab North", "R-7", "Inspection interval"].iter().all(|words| page.text("main").contains(words)));
    page.open(&format!("{}/#/predictions/{first}", service.url));

    // A second run, and both side by side.
    page.click("[data-action=again]");
    page.see("#predict:not([disabled])");
    walk.start("#predict");
    page.see("#job[data-job-state=succeeded]");
    page.open(&format!("{}/#/runs", service.url));
    page.see("tr[data-job][data-job-state=succeeded]");
    page.see(&format!("tr[data-job='{fit}'] .mark.is-{}", if is_passed { "ok" } else { "note" }));
    assert_says(&page.text(&format!("tr[data-job='{first}'] th")), &["Plate, ", "al2024-t3: E ", "R = "]);
    walk.look("08_runs");
    // Put away, one is found again only by asking.
    page.click(&format!("tr[data-job='{fit}'] [data-action=more]"));
    page.see(".menu:popover-open");
    page.click(&format!("tr[data-job='{fit}'] [data-action=archive]"));
    page.until(&format!("!document.querySelector(\"tr[data-job='{fit}']\")"));
    page.click("#runs-archived");
    page.see(&format!("tr[data-job='{fit}'].archived"));
    for place in [1, 2] {
        page.click(&format!("tr[data-job]:nth-of-type({place}) .tick input"));
    }
    page.click("#compare");
    page.see("[data-chart=compare] path[data-series]");
    page.see("[data-table=compare]");
    walk.look("09_compare");

    // A sweep over the plate of the form.
    page.open(&format!("{}/#/new?way=sweep", service.url));
    page.see("#sweep-start:not([disabled])");
    page.fill("[data-key='vary[0].count']", "2");
    page.see("#sweep-start:not([disabled])");
    walk.look("10_sweep");
    walk.start("#sweep-start");
    page.see("#job[data-job-state=succeeded]");
    page.see("[data-value=life_cycles]");

    one_figure_has_one_rounding(&walk, &service, &fit);

    // Stopped where it is, a run keeps its curve.
    let running = service.submit("predictions", &of("stopped", &SLOW.replace("spacing_mm = 0.8", "spacing_mm = 0.5")));
    page.open(&format!("{}{}", service.url, running.replace("/v1/", "/#/")));
    page.click("[data-action=stop]");
    page.see("#job[data-job-state=succeeded]");
    page.until("document.querySelector('[data-part=result]')?.textContent.includes('Stopped early at')");
    walk.look("16_stopped");

    // Cancel and delete.
    page.open(&format!("{}/#/predict?from={first}", service.url));
    page.see("#predict:not([disabled])");
    walk.start("#predict");
    page.click("[data-action=cancel]");
    page.see("#job[data-job-state=cancelled]");
    page.click("[data-action=delete]");
    page.click("#delete-dialog [value=delete]");
    page.until("!location.hash.includes('/predictions/')");

    // On a phone, in the dark, and after a reload.
    page.look(360, 740, "dark");
    for (name, hash) in [
        ("10_phone_start", "#/measure".to_owned()),
        ("11_phone_plate", "#/predict".to_owned()),
        ("12_phone_predicted", format!("#/predictions/{first}")),
        ("13_phone_fit", format!("#/calibrations/{fit}")),
        ("14_phone_runs", "#/runs".to_owned()),
    ] {
        page.open(&format!("{}/{hash}", service.url));
        page.run("location.reload()");
        page.until("document.readyState === 'complete'");
        let expected = if name.contains("predicted") { "[data-value=remaining_cycles]" } else { "main h1, main h2" };
        page.see(expected);
        std::thread::sleep(Duration::from_millis(400));
        walk.look(name);
    }
}

#[test]
fn the_page_asks_for_a_token() {
    let Some(page) = Browser::start() else { return };
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let made = perilife(dir.path(), &["token", &place[0], &place[1], "add", "ann", "--role", "run"]);
    let token = String::from_utf8(made.stdout).unwrap();
    let service = Server::start(&place, &["--jobs", "0", "--require-token"]);
    page.look(1280, 900, "dark");
    page.open(&format!("{}/#/runs", service.url));
    page.see("#token-dialog[open] #token");
    page.fill("#token", token.trim());
    page.run("document.querySelector('#token-dialog form').requestSubmit()");
    page.until("!document.querySelector('#token-dialog').open");
    assert_eq!(page.run("return JSON.stringify(localStorage).includes('perilife_')"), false, "not kept beyond the window");
}

fn digits(text: &str) -> String {
    text.chars().filter(|c| c.is_ascii_digit() || *c == '.').collect()
}

/// Drags the pointer between two places of a box, given in shares of its size.
fn drag_pointer(page: &Browser, frame: &[f64], from: [f64; 2], to: [f64; 2]) {
    let at = |share: [f64; 2]| [frame[0] + share[0] * frame[2], frame[1] + share[1] * frame[3]].map(f64::round);
    let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
    page.drag(&[at(from), at(middle), at(to)]);
}
