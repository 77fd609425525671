//! What axe-core (Deque) says of every page in both themes, on a desk and on a phone: no violation of any of its rules. Left out is
//! `/docs`, which is Swagger UI as it is delivered.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::json;

use super::of;
use crate::support::browser::Browser;
use crate::support::server::Server;

/// From npm's registry, once for all runs; not among the files of this project.
const AXE: &str = "axe-core@4.14.1";
/// Rules that are broken, and where.
const FOUND: &str = "return axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) => violations
    .map((rule) => `${rule.id}: ${rule.nodes.map((node) => node.html.slice(0, 120)).join(' | ')}`))";
const READINGS: &str = "specimen,cycles,crack_length_mm\nA,0,9\nA,30000,10.5\nA,55000,12.4\nA,72000,14.5\nA,86000,17\nA,96000,19.8\n\
    A,104000,23\nB,0,9\nB,31000,10.5\nB,57000,12.4\nB,75000,14.5\nB,89000,17\nB,99000,19.8\nB,107000,23\n";
const TEST: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\ncrack_length_mm = 9\n\
    [material]\nname = \"al2024-t3\"\n[loading]\nstress_max_mpa = 80\nstress_ratio = 0.1\n";

/// The text of axe; `None`, with the reason printed, where the registry cannot be reached.
fn axe() -> Option<String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("axe");
    let file = folder.join("package/axe.min.js");
    if !file.is_file() {
        fs::create_dir_all(&folder).unwrap();
        let quiet = |program: &str, arguments: &[&str]| {
            let mut command = Command::new(program);
            let ended = command.args(arguments).current_dir(&folder).stdout(Stdio::null()).stderr(Stdio::null()).status();
            ended.is_ok_and(|status| status.success())
        };
        let archive = format!("{}.tgz", AXE.replace('@', "-"));
        if !quiet("npm", &["pack", "--silent", AXE]) || !quiet("tar", &["xzf", &archive]) {
            let needed = std::env::var("PERILIFE_TESTS_NEED").is_ok_and(|needs| needs.contains("axe"));
            assert!(!needed, "axe-core is needed here: npm pack {AXE} fails");
            println!("skipped: npm pack {AXE} fails");
            return None;
        }
    }
    Some(fs::read_to_string(file).unwrap())
}

/// Parts that stand out of a window which scrolls sideways.
const WIDE: &str = "return document.documentElement.scrollWidth <= innerWidth + 1 ? [] : [...document.querySelectorAll('body *')] \
    .filter((part) => part.getBoundingClientRect().right > innerWidth + 1).slice(0, 6) \
    .map((part) => part.cloneNode().outerHTML + part.textContent.slice(0, 60));";

/// Colors that are on their way to those of another theme have no contrast of their own.
const STILL: &str = "const still = new CSSStyleSheet(); \
    still.replaceSync('*, *::before, *::after { transition: none !important; animation: none !important }'); \
    document.adoptedStyleSheets = [still];";

/// A page: address, what to wait for, what to click first.
type Page = (String, &'static str, &'static str);

fn pages(service: &Server, folder: &Path) -> Vec<Page> {
    let run = |collection: &str, body| service.submit(collection, &body);
    let law = run(
        "calibrations",
        json!({ "name": "law", "input": format!("{TEST}[measured]\nfiles = [\"readings.csv\"]\n"),
        "files": { "readings.csv": READINGS } }),
    );
    service.succeeded(&law);
    let case = |name: &str| fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cases").join(name)).unwrap();
    let fitted = json!({ "name": "fitted", "input": TEST, "calibration": law.rsplit('/').next().unwrap(),
        "options": { "inspect_from_mm": 12, "sensitivities": true, "residual_strength": true, "pod": "12,20" } });
    let jobs = [
        run("predictions", fitted),
        run("predictions", of("fleet", &case("fleet_of_panels.toml"))),
        run("predictions", of("corner", &case("corner_crack_at_hole.toml"))),
        run("predictions", of("plate", &case("slant_crack_nodes.toml"))),
        run(
            "predictions",
            of("refused", &case("crack_beside_hole.toml").replace("stress_max_mpa = 45.0", "stress_max_mpa = 900.0")),
        ),
        run("sif", of("K", &case("hand_calculation.toml"))),
    ];
    jobs.iter().for_each(|job| drop(service.succeeded(job)));
    let of_run = |job: &String| (job.replace("/v1/", "/#/"), "#job[data-job-state=succeeded] ~ .job-body", "");
    let ids: Vec<&str> = jobs[..3].iter().filter_map(|job| job.rsplit('/').next()).collect();
    let mut pages: Vec<Page> = [
        ("/#/new", "#new-kinds .card", ""),
        ("/#/measure?example", "#calibrate:not([disabled])", ""),
        ("/#/predict", "#predict", "#plate-example"),
        ("/#/new?way=sweep", "#new-sweep fieldset", ""),
        ("/#/new?way=file", "#file-text", ""),
        ("/#/runs", "tr[data-job]", ""),
        ("/#/predictions/00000000-0000-7000-8000-000000000000", "[data-problem]", ""),
        ("/guide", "main", ""),
    ]
    .map(|(address, seen, click)| (address.to_owned(), seen, click))
    .to_vec();
    pages.extend(jobs.iter().chain([&law]).map(of_run));
    pages.push((jobs[0].replace("/v1/", "/#/"), "#report-dialog[open]", "[data-action=report]"));
    pages.push((format!("/#/compare/{}", ids.join(",")), "[data-table=compare]", ""));
    // A report allows no scripts, so it is looked at as a file.
    for (job, name) in [(&jobs[0], "life.html"), (&law, "law.html")] {
        let file = folder.join(name);
        fs::write(&file, service.get(&format!("{job}/report")).expect(200).body).unwrap();
        pages.push((format!("file://{}", file.display()), "main", ""));
    }
    pages
}

#[test]
fn axe_finds_no_violation_on_any_page() {
    let (Some(browser), Some(axe)) = (Browser::start(), axe()) else { return };
    let (folder, service) = Server::alone(&["--jobs", "2"]);
    let mut flaws = Vec::new();
    for (address, seen, click) in pages(&service, folder.path()) {
        browser.open("about:blank");
        browser.open(&if address.starts_with('/') { format!("{}{address}", service.url) } else { address.clone() });
        if !click.is_empty() {
            browser.click(click);
        }
        browser.see(seen);
        browser.run(&axe);
        browser.run(STILL);
        for (width, theme) in [(1400, "light"), (1400, "dark"), (390, "dark"), (390, "light")] {
            browser.look(width, 900, theme);
            let found = browser.run(FOUND);
            flaws.extend(found.as_array().unwrap().iter().map(|flaw| format!("{address} {width} {theme}: {flaw}")));
            let wide = browser.run(WIDE);
            flaws.extend(wide.as_array().unwrap().iter().map(|part| format!("{address} {width}: wider than the window: {part}")));
        }
    }
    assert!(flaws.is_empty(), "{flaws:#?}");
}
