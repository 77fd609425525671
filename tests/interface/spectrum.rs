//! Cases with a spectrum as a user gives them: what is refused, what `check` says, what `predict` writes.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::desk::{desk, json};
use crate::support::rows::{assert_says, rows};

const CASE: &str = include_str!("../reference/cases/spectrum.toml");
const FLIGHTS: &str = "max,min,cycles\n0.6,0.1,20\n1.0,0.05,1\n0.5,0.2,40\n";
const WHEELER: &str = "spectrum_scale_mpa = 100.0\nretardation = \"wheeler\"\nwheeler_exponent = 1.3\n";

/// Runs a command on the case, changed, with this spectrum.
fn run(case: &str, file: &str, content: &str, arguments: &[&str]) -> (tempfile::TempDir, std::process::Output) {
    let dir = desk(&[("case.toml", &case)]);
    fs::write(dir.path().join(file), content).unwrap();
    let output = perilife(dir.path(), arguments);
    (dir, output)
}

#[test]
fn spectra_that_are_none_are_refused_by_file_line_and_value() {
    for (content, words) in rows::<Vec<(String, Vec<String>)>>("spectrum", "no_spectra") {
        let (dir, output) = run(CASE, "flights.csv", &content, &["predict", "case.toml", "--out", "run"]);
        assert_refused(&output, 2, &words);
        assert!(!dir.path().join("run").exists(), "{content}");
    }
}

#[test]
fn keys_that_do_not_make_a_spectrum_are_refused() {
    let wheeler = CASE.replace("spectrum_scale_mpa = 100.0\n", WHEELER);
    for (old, new, words) in rows::<Vec<(String, String, Vec<String>)>>("spectrum", "wrong_keys") {
        assert!(wheeler.contains(&old), "{old}");
        let (_, output) = run(&wheeler.replace(&old, &new), "flights.csv", FLIGHTS, &["check", "case.toml"]);
        if words.is_empty() {
            assert_eq!(output.status.code(), Some(0), "{}", texts(&output).1);
            continue;
        }
        assert_refused(&output, 2, &words);
    }
    // Bonds that lose life by their own strain have no rate over K.
    let bonds = CASE.replace("method = \"handbook\"", "method = \"peridynamics\"");
    let a_p = "driver = \"bond_strain\"\nparis_c_mm_per_cycle = 1e-7\nparis_m = 3.0\nwalker_gamma = 0.6\n";
    let law = bonds.find("growth_law").unwrap()..bonds.find("[stop]").unwrap();
    let bonds = [&bonds[..law.start], a_p, &bonds[law.end..]].concat();
    assert_refused(&run(&bonds, "flights.csv", FLIGHTS, &["check", "case.toml"]).1, 2, &["loading.kind", "tip_field"]);
}

#[test]
fn check_and_predict_say_what_the_spectrum_is() {
    let wheeler = CASE.replace("spectrum_scale_mpa = 100.0\n", WHEELER);
    let (_, output) = run(&wheeler, "flights.csv", FLIGHTS, &["check", "case.toml", "-v"]);
    let (stdout, _) = texts(&output);
    let words = ["5 to 100 MPa", "flights.csv (cycles): 61 cycles a pass", "3 kinds", "repeated until failure", "wheeler"];
    assert_says(&stdout, &words);
    let mut lives = Vec::new();
    for case in [CASE, &wheeler] {
        let (dir, output) = run(case, "flights.csv", FLIGHTS, &["predict", "case.toml", "--out", "run"]);
        let (stdout, stderr) = texts(&output);
        assert_eq!(output.status.code(), Some(0), "{stdout}{stderr}");
        let folder = dir.path().join("run");
        let result = json(folder.join("result.json"));
        let life = result["life_cycles"].as_f64().unwrap();
        assert!((result["passes"].as_f64().unwrap() * 61.0 / life - 1.0).abs() < 1e-9);
        assert_eq!(result["spectrum"]["cycles_per_pass"], 61.0);
        assert_eq!(result["spectrum"]["kinds_of_cycles"], 3);
        assert!(stdout.contains(" passes)\n") && stdout.contains("Load history   61 cycles per pass; "), "{stdout}");
        assert!(fs::read_to_string(folder.join("spectrum.svg")).unwrap().contains("</svg>"));
        lives.push((life, result["spectrum"]["retardation"]["model"].as_str().unwrap().to_owned()));
    }
    assert_eq!((lives[0].1.as_str(), lives[1].1.as_str()), ("none", "wheeler"));
    assert!(lives[1].0 > 1.1 * lives[0].0, "{lives:?}");
}

#[test]
fn a_spectrum_of_equal_cycles_is_constant_amplitude() {
    let constant = CASE.replace(
        "kind = \"spectrum\"\nspectrum_file = \"flights.csv\"\nspectrum_scale_mpa = 100.0\n",
        "stress_max_mpa = 80\nstress_ratio = 0.25\n",
    );
    for method in ["handbook", "element_free_galerkin"] {
        let life = |case: &str| {
            let set = format!("model.method={method}");
            let arguments = ["predict", "case.toml", "--out", "run", "--no-estimate", "--set", &set];
            let (dir, output) = run(case, "flights.csv", "max,min,cycles\n0.8,0.2,3\n", &arguments);
            assert_eq!(output.status.code(), Some(0), "{}", texts(&output).1);
            let text = fs::read_to_string(Path::new(dir.path()).join("run/result.json")).unwrap();
            serde_json::from_str::<Value>(&text).unwrap()["life_cycles"].as_f64().unwrap()
        };
        let (one, other) = (life(CASE), life(&constant));
        assert!((one / other - 1.0).abs() < 1e-9, "{method}: {one} against {other}");
    }
}

/// Ratios from 0 to 0.3 and less: no word; a wider span is warned of unless a model of load interaction is chosen, also where it needs a yield strength.
#[test]
fn a_life_without_load_interaction_is_warned_of_where_stress_ratios_span_much() {
    let narrow = "max,min,cycles\n0.6,0.1,20\n1.0,0.05,1\n0.5,0.1,40\n";
    let newman = CASE.replace("[model]", "retardation = \"newman\"\n[model]");
    let soft = CASE.replace("yield_strength_mpa = 340.0\n", "");
    let remedy = "compare with loading.retardation = \"newman\"";
    let rows = [
        (CASE, narrow, None),
        (CASE, FLIGHTS, Some("")),
        (&newman, FLIGHTS, None),
        (&soft, FLIGHTS, Some(" and material.yield_strength_mpa")),
    ];
    for (case, flights, wanted) in rows {
        let (_dir, output) = run(case, "flights.csv", flights, &["predict", "case.toml", "--out", "out", "-v"]);
        let (out, err) = texts(&output);
        let said = format!("{out}{err}");
        assert_eq!(said.contains("load interaction: none"), wanted.is_some(), "{said}");
        assert!(wanted.is_none_or(|more| said.contains(&format!("{remedy}{more}\n"))), "{said}");
    }
}
