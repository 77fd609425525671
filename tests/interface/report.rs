//! `perilife report`: one page of a run or a fit with all that it shows, and what cannot be reported.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use perilife_results::band::OF_FLEET;
use perilife_results::format::{PLAIN, PRINT};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::daily::panel_without_law;
use crate::support::desk::{desk, done, json};
use crate::support::rows::{assert_holds, assert_says, rows};

const LAW: &str = "[fatigue]\nparis_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874\n";
const MEASURED: &str = "[measured]\nfiles = [\"n.csv\"]\nfrom_crack_length_mm = 9.0\n\
    leave_out = [{ specimen = \"P1\", from_cycles = 0, to_cycles = 9000, reason = \"load of the <precrack>\" }]\n";

/// Readings of two panels that a law of Paris made, every 0.8 mm but one step of 0.1 mm.
fn readings() -> String {
    let mut text = "specimen,cycles,crack_length_mm\n".to_owned();
    for (name, share) in [("P1", 1.0), ("P2", 1.1)] {
        let mut cycles = 0.0;
        for step in 0..40 {
            let length = 8.2 + 0.8 * f64::from(step) - if step == 20 { 0.7 } else { 0.0 };
            text += &format!("{name},{:.0},{length:.2}\n", share * cycles);
            let k = 48.28 * (std::f64::consts::PI * length / 1e3 / (std::f64::consts::PI * length / 152.4).cos()).sqrt();
            let to_next = if step == 19 {
                0.1
            } else if step == 20 {
                1.5
            } else {
                0.8
            };
            cycles += to_next / (8.95422e-8 * k.powf(2.874));
        }
    }
    text
}

/// `run` and `fit` beside the inputs that they were made from.
fn folders() -> TempDir {
    let dir = desk(&[
        ("panel.toml", &format!("{}{LAW}[stop]\ncrack_length_mm = 40.0\n", panel_without_law())),
        ("n.csv", &readings()),
        ("fit.toml", &format!("{MEASURED}{}", panel_without_law())),
    ]);
    for call in [["predict", "panel.toml", "--out", "run"], ["calibrate", "fit.toml", "--out", "fit"]] {
        done(dir.path(), &call);
    }
    dir
}

fn report(folder: &Path, of: &str, more: &[&str]) -> String {
    done(folder, &[&["report", of, "--out", "r.html"], more].concat());
    fs::read_to_string(folder.join("r.html")).unwrap()
}

/// Nothing outside the file is asked for: no address, no source, no script, no import.
fn assert_alone(page: &str) {
    for outside in ["http:", "https:", "src=", "href=", "url(", "@import", "<script", "<link", "file:"] {
        assert!(!page.contains(outside), "{outside} in the page");
    }
    assert!(page.starts_with("<!doctype html>") && page.ends_with("</html>\n") && !page.contains("NaN"), "whole, without NaN");
    assert_says(page, &["@page", "counter(page) \" of \" counter(pages)", "@media print", "role=\"img\""]);
    let (open, close) = (page.matches("<svg").count(), page.matches("</svg>").count());
    assert!(open == close && open > 3, "{open} drawings, {close} ends");
}

#[test]
fn a_run_has_a_page_with_life_validity_and_hashes() {
    let dir = folders();
    let page = report(
        dir.path(),
        "run",
        &["--laboratory", "Lab <1> & \"Co\"", "--operator", "A. Tester", "--date", "26 Nov 2026", "--set", "report.number=R-12"],
    );
    assert_alone(&page);
    let result = json(dir.path().join("run/result.json"));
    let hash = result["inputs"][0]["sha256"].as_str().unwrap();
    let version = result["version"].as_str().unwrap();
    assert_holds(
        &page,
        "Lab &lt;1&gt; &amp; &quot;Co&quot; | A. Tester | 26 Nov 2026 | Cycles to the crack length limit | \
        crack length limit reached | scatter band not available | valid with reservations | \
        Fracture: not checked (no toughness given) | Numerical error ≤ 0.86 % of life (estimate) | \
        stress 12.07 to 60.35 MPa, R = 0.2 | al2024-t3 | \
        Report No.</dt><dd>R-12</dd><dt>Customer</dt><dd><span class=\"blank\">not recorded</span> | \
        Reviewed by, date: </div> | tests/VALIDATION.md of this version | \
        content: \"R-12, Crack growth life, panel, perilife ",
    );
    assert_says(&page, &[hash, version]);
    assert!(!page.contains("<1>"), "names are no markup");
    // The drawings are those of the folder, at another size: the same points along the curve.
    let k = fs::read_to_string(dir.path().join("run/k.svg")).unwrap();
    for (drawing, name) in [(&page, "the page"), (&k, "k.svg")] {
        assert!(drawing.contains("K at maximum load") && drawing.contains(">II</tspan>"), "{name}");
    }
    for file in ["plate.svg", "a_n.svg"] {
        let svg = fs::read_to_string(dir.path().join("run").join(file)).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("aria-label") && !svg.contains("NaN"), "{file}");
    }
    // Another report takes its place; `--json` says where it is.
    let output = perilife(dir.path(), "report run --out r.html --json");
    let object: Value = serde_json::from_str(&texts(&output).0).unwrap();
    assert_eq!(object["file"], "r.html");
}

#[test]
fn a_fit_has_a_page_with_every_reading() {
    let dir = folders();
    fs::write(dir.path().join("data.toml"), "[report]\nrevision = \"2\"\nnumber = \"F-3\"\norientation = \"T-L\"\n").unwrap();
    let page = report(dir.path(), "fit", &["--data", "data.toml", "--set", "report.orientation=L-T"]);
    assert_alone(&page);
    let table = page.split("Readings and growth rates").nth(1).unwrap();
    assert_eq!(table.matches("<tr").count(), 1 + 2 * 40, "a row a reading");
    assert!(table.contains("excluded: load of the &lt;precrack&gt;"), "with its reason");
    let outside = table.matches(">outside the fit window<").count();
    assert!(outside > 0 && !table.contains("excluded: outside"), "P2 starts below the window");
    assert!(page.contains(&format!("<td>1; {outside} outside the fit window</td>")), "the criterion counts as the table does");
    assert_eq!(table.matches("step under 0.25 mm").count(), 4, "both readings of the short step of both panels");
    let fit = json(dir.path().join("fit/fit.json"));
    assert!((fit["paris_m"].as_f64().unwrap() - 2.874).abs() < 0.05, "{fit}");
    assert_holds(
        &page,
        "Criteria of ASTM E647 | 2 of 78 increments are shorter; used and flagged | \
        not checked (one crack size per reading) | Test machine, load cell</dt><dd><span class=\"blank\">not recorded | \
        Crack plane orientation</dt><dd>L-T</dd> | Report No.</dt><dd>F-3, revision 2</dd>",
    );
    assert_says(&page, &[fit["inputs"][1]["sha256"].as_str().unwrap()]);
    // The rates are those of `perilife rates` by the same polynomial.
    let rates = texts(&perilife(dir.path(), "rates n.csv --specimen panel.toml")).0;
    let of_panel = rates.lines().find(|line| line.starts_with("P2,") && line.contains("e-")).unwrap();
    let delta_k = of_panel.split(',').nth(3).unwrap();
    let readings = fs::read_to_string(dir.path().join("fit/readings.csv")).unwrap();
    assert!(readings.contains(delta_k), "{delta_k} in {readings}");
}

#[test]
fn what_cannot_be_reported_is_refused_with_words() {
    let dir = folders();
    let here = dir.path();
    fs::create_dir(here.join("empty")).unwrap();
    fs::write(here.join("notes.html"), "my notes").unwrap();
    let result = "run/result.json";
    let kept: BTreeMap<&str, String> = [result, "fit/fit.json", "run/a_n.csv", "fit/readings.csv"]
        .into_iter()
        .map(|file| (file, fs::read_to_string(here.join(file)).unwrap()))
        .collect();
    let with = |file: &str, key: &str, value: Value| {
        let mut object: Value = serde_json::from_str(&kept[file]).unwrap();
        object[key] = value;
        object.to_string()
    };
    type Bad = (String, Vec<String>, String, i32, Vec<String>);
    for (file, change, of, code, words) in rows::<Vec<Bad>>("report", "bad") {
        let change: Vec<&str> = change.iter().map(String::as_str).collect();
        let text = kept.get(file.as_str());
        let changed = match change[..] {
            ["cut"] => text.map(|text| text[..text.len() / 2].to_owned()),
            ["write", content] => Some(content.to_owned()),
            ["replace", old, new] => text.map(|text| text.replace(old, new)),
            ["set", key, value] => Some(with(&file, key, serde_json::from_str(value).unwrap())),
            _ => None,
        };
        match changed {
            Some(changed) => fs::write(here.join(&file), changed).unwrap(),
            None if file.is_empty() => {}
            None => fs::remove_file(here.join(&file)).unwrap(),
        }
        let output = perilife(here, &format!("report {of} --out bad.html"));
        assert_refused(&output, code, &words);
        assert!(!here.join("bad.html").exists(), "{of}: nothing half-written");
        if let Some(text) = text {
            fs::write(here.join(&file), text).unwrap();
        }
    }

    let in_the_way: [(&str, i32, &[&str]); 4] = [
        ("notes.html", 2, &["notes.html", "did not write"]),
        ("empty", 2, &["empty", "is a folder"]),
        ("missing/r.html", 4, &["missing/r.html", "cannot write"]),
        ("run/result.json", 2, &["run/result.json"]),
    ];
    for (out, code, words) in in_the_way {
        assert_refused(&perilife(here, &format!("report run --out {out}")), code, words);
    }
    assert_eq!(fs::read_to_string(here.join("notes.html")).unwrap(), "my notes");
    assert_eq!(fs::read_to_string(here.join(result)).unwrap(), kept[result]);
}

#[test]
fn a_fracture_scene_has_no_life_to_report() {
    let dir = tempdir().unwrap();
    fs::create_dir(dir.path().join("scene")).unwrap();
    fs::write(dir.path().join("scene/result.json"), "{\"peak_load_n\": 3.0, \"stop_reason\": \"steps_done\"}").unwrap();
    assert_refused(&perilife(dir.path(), "report scene --out r.html"), 2, &["scene", "fracture scene", "perilife predict"]);
}

/// A spectrum, a crack that is not through, and what was asked beside the life stand on sheets of their own, with the pictures of the folder.
#[test]
fn spectra_part_through_cracks_and_fleets_have_their_sheets() {
    let dir = tempdir().unwrap();
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cases");
    let run = |case: &str, more: &str| {
        done(dir.path(), &format!("predict {} --out run --force {more}", cases.join(case).display()));
        let page = report(dir.path(), "run", &[]);
        assert_alone(&page);
        (page, json(dir.path().join("run/result.json")))
    };
    // Cycles as the report writes them, by the stated error of the life.
    let by_error =
        |cycles: f64, result: &Value| format!("{} cycles", PRINT.by_error(cycles, result["error_estimate_percent"].as_f64()));

    let (page, result) = run("spectrum_panel.toml", "--set loading.omission_percent=20 --set loading.truncation_percent=95");
    let (life, mean) = (&result["life_cycles"], &result["spectrum"]["life_cycles_without_retardation"]);
    let (life, mean) = (life.as_f64().unwrap(), mean.as_f64().unwrap());
    assert!(life > 1.05 * mean, "an overload slows the crack down: {life} {mean}");
    // Without the model the run itself gives that life.
    let (_, plain) = run(
        "spectrum_panel.toml",
        "--set loading.omission_percent=20 --set loading.truncation_percent=95 --set loading.retardation=\"none\"",
    );
    assert!((plain["life_cycles"].as_f64().unwrap() / mean - 1.0).abs() < 1e-9);
    assert_holds(
        &page,
        "Exceedances and ranges of the | spectrum_ten_flights.csv | \
        none (all above 20 % of the largest range) | peaks above 95 % of the largest in the file | wheeler | \
        wheeler_exponent | 104.5 MPa, gross",
    );
    assert_says(&page, &[life, mean].map(|life| by_error(life, &result)));

    let (page, result) = run("corner_crack_at_hole.toml", "--set stop.at_break_through=true");
    let found = &result["part_through"];
    assert_holds(
        &page,
        "Section through the crack: depth | Surface length c and depth a of the crack in mm against cycles | \
        NASA TM-85793 | a/t = 1.000 | breakthrough at a/t = 1",
    );
    assert_says(
        &page,
        &[
            by_error(found["cycles_at_break_through"].as_f64().unwrap(), &result),
            by_error(found["life_cycles_if_k_is_larger"].as_f64().unwrap(), &result),
            by_error(found["life_cycles_if_k_is_smaller"].as_f64().unwrap(), &result),
        ],
    );

    let (page, result) = run("fleet_of_panels.toml", "--inspect-from 10 --pod 12,25 --sensitivities");
    let looks = &result["fleet"]["inspections"];
    assert_holds(
        &page,
        "lives of a fleet | change in life | 1000, seed 1 | \
        from a = 10 mm (law, load and critical length of each plate) | initial crack length | a50 = 12 mm, a90 = 25 mm",
    );
    assert_says(
        &page,
        &[
            PRINT.by_band(looks["detectable_to_critical_cycles"]["p95"].as_f64().unwrap(), &OF_FLEET),
            PLAIN.promised(looks["interval_cycles"].as_f64().unwrap(), looks["interval_cycles"].as_f64().unwrap(), &OF_FLEET),
        ],
    );
    let (page, _) = run("two_cracks_plate.toml", "--residual-strength");
    assert_says(
        &page,
        &[
            "Crack extension of each tip against cycles",
            "<h1 class=\"sheet\">Residual strength</h1>",
            "Load that the cracked plate can carry",
        ],
    );
    assert!(page.contains("circles at 25, 50, 75 and 90 % of life") && !page.contains(">25 %<"), "words at one crack alone");
    run("fleet_of_panels.toml", "--inspect-from 10 --pod 12,25");
    // A picture that does more than draw is not taken over.
    let picture = dir.path().join("run/fleet.svg");
    let text = fs::read_to_string(&picture).unwrap();
    for bad in ["<script>alert(1)</script></svg>", "<rect onload=\"alert(1)\"/></svg>", "<image href=\"x.png\"/></svg>"] {
        fs::write(&picture, text.replace("</svg>", bad)).unwrap();
        let page = report(dir.path(), "run", &[]);
        assert_alone(&page);
        assert!(!page.contains("onload") && !page.contains("lives of a fleet"), "{bad}");
    }
}
