//! `perilife calibrate` of laws over K: from readings at several stress ratios to rates, to the law, to a life; and fits that end without.

use std::fmt::Write as _;
use std::fs;

use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::interface::cli::{assert_refused, perilife};
use crate::support::desk::{done, json};
use crate::support::rows::assert_says;

const SHEET: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 6\n\
                     [material]\nyoungs_modulus_gpa = 71\npoisson_ratio = 0.33\n[model]\nmethod = \"handbook\"\n";
const WALKER: &str = "[fatigue]\ngrowth_law = \"walker\"\nparis_c_mm_per_cycle = 2e-8\nparis_m = 3.2\nwalker_gamma = 0.6\n";

fn loading(ratio: f64) -> String {
    format!("[loading]\nstress_max_mpa = 90\nstress_ratio = {ratio}\n")
}

/// Readings of sheets of a known law of Walker at two stress ratios, `r1.csv` and `r5.csv`, with the cases they were tested by.
fn readings() -> TempDir {
    let dir = tempdir().unwrap();
    for (name, ratio) in [("r1", 0.1), ("r5", 0.5)] {
        let case = format!("{SHEET}{}{WALKER}[stop]\ncrack_length_mm = 38\n", loading(ratio));
        fs::write(dir.path().join(format!("{name}.toml")), case).unwrap();
        done(dir.path(), &["predict", &format!("{name}.toml"), "--out", name]);
        let text = fs::read_to_string(dir.path().join(name).join("a_n.csv")).unwrap();
        let mut csv = "cycles,crack_length_mm\n".to_owned();
        let mut last = 0.0;
        for row in text.lines().skip(1) {
            let mut cells = row.split(',');
            let (cycles, length) = (cells.next().unwrap(), cells.next().unwrap().parse::<f64>().unwrap());
            if length >= last + 0.4 {
                writeln!(csv, "{cycles},{length}").unwrap();
                last = length;
            }
        }
        fs::write(dir.path().join(format!("{name}.csv")), csv).unwrap();
    }
    dir
}

#[test]
fn readings_at_two_ratios_become_rates_a_law_and_a_life() {
    let dir = readings();
    let here = dir.path();
    for name in ["r1", "r5"] {
        let [csv, toml, out] = ["csv", "toml", "rates.csv"].map(|end| format!("{name}.{end}"));
        done(here, &format!("rates {csv} --specimen {toml} --out {out}"));
    }
    fs::write(here.join("laws.toml"), "[measured]\nrates = [\"r1.rates.csv\", \"r5.rates.csv\"]\n[fit]\nlaw = \"best\"\n")
        .unwrap();
    // Another stress ratio between them.
    fs::write(here.join("panel.toml"), format!("{SHEET}{}[stop]\ncrack_length_mm = 30\n", loading(0.3))).unwrap();
    let (stdout, _) = done(here, "calibrate laws.toml --out fit --predict panel.toml");
    let words = ["walker law at R = 0.1, 0.5", "lowest AICc; ", "paris_c_mm_per_cycle", "  Rejected       ", "panel: life"];
    assert_says(&stdout, &words);
    for file in ["fitted.toml", "fit.json", "fit_rates.csv", "da_dn.svg", "panel/a_n.csv"] {
        assert!(fs::metadata(here.join("fit").join(file)).unwrap().len() > 0, "{file}");
    }
    let report = json(here.join("fit/fit.json"));
    assert_eq!(report["law"], "walker");
    for (key, truth, bound) in [("paris_m", 3.2, 0.01), ("walker_gamma", 0.6, 0.02), ("paris_c_mm_per_cycle", 2e-8, 0.02)] {
        let value = report["constants"][key].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < bound, "{key}: {value}");
    }
    assert!(report["aicc_margin"].as_f64().unwrap() > 10.0, "{report}");
    // The life is that of the law that made the readings.
    fs::write(here.join("truth.toml"), format!("{SHEET}{}{WALKER}[stop]\ncrack_length_mm = 30\n", loading(0.3))).unwrap();
    done(here, "predict truth.toml --out truth");
    let [fitted, truth] = ["fit/panel", "truth"].map(|run| json(here.join(run).join("result.json")));
    let life = |result: &Value| result["life_cycles"].as_f64().unwrap();
    assert!((life(&fitted) / life(&truth) - 1.0).abs() < 0.01, "{} for {}", life(&fitted), life(&truth));
    assert!(fitted["life_share_extrapolated"].as_f64().unwrap() < 0.05);
    let (understood, _) = done(here, "check laws.toml -v");
    assert!(understood.contains("at R = 0.1, 0.5") && understood.contains("law best"), "{understood}");
    // The same law from the readings themselves, every third of them, each with its own load.
    let table = |name: &str, smallest: f64| {
        let text = fs::read_to_string(here.join(name)).unwrap();
        let rows = text.lines().skip(1).step_by(3).map(|line| line.split(',').take(2).collect::<Vec<_>>().join(","));
        rows.map(|row| format!("{name},{row},90,{smallest}\n")).collect::<String>()
    };
    let all = format!(
        "specimen,cycles,crack_length_mm,stress_max_mpa,stress_min_mpa\n{}{}",
        table("r1.csv", 9.0),
        table("r5.csv", 45.0)
    );
    fs::write(here.join("all.csv"), all).unwrap();
    let case = format!("[measured]\nfiles = [\"all.csv\"]\n[fit]\nlaw = \"walker\"\n{SHEET}{}", loading(0.1));
    fs::write(here.join("direct.toml"), case).unwrap();
    done(here, "calibrate direct.toml --out direct");
    let gamma = json(here.join("direct/fit.json"))["constants"]["walker_gamma"].as_f64().unwrap();
    assert!((gamma - 0.6).abs() < 0.02, "{gamma}");
    done(here, "check direct.toml");
    // A table of rates is read as readings too, as before.
    done(here, "rates r1.rates.csv --specimen r1.toml");
}

/// Lengths of a curve that grows by a law of its own, `dN = f(a) da`.
fn curve(lengths: &[f64], slowness: impl Fn(f64) -> f64) -> String {
    let mut text = "cycles,crack_length_mm\n".to_owned();
    let mut cycles = 0.0;
    for (i, a) in lengths.iter().enumerate() {
        cycles += if i > 0 { slowness(*a) * (a - lengths[i - 1]) } else { 0.0 };
        writeln!(text, "{cycles:.6},{a}").unwrap();
    }
    text
}

#[test]
fn a_fit_without_an_optimum_writes_no_law() {
    let dir = tempdir().unwrap();
    let here = dir.path();
    let wide: Vec<f64> = (0..25).map(|i| 6.0 + 1.2 * f64::from(i)).collect();
    let narrow: Vec<f64> = (0..8).map(|i| 20.0 + 0.01 * f64::from(i)).collect();
    // The optimum beyond the upper and the lower end of the exponents, and none where ΔK hardly varies.
    let rates = |ratios: &[f64]| {
        let mut text = "delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,stress_ratio\n".to_owned();
        for ratio in ratios {
            (8..30).for_each(|k| writeln!(text, "{k},{:e},{ratio}", 1e-8 * f64::from(k).powi(3)).unwrap());
        }
        text
    };
    let readings = format!("[measured]\nfiles = [\"data.csv\"]\n{SHEET}{}", loading(0.1));
    let law = |law: &str| format!("[measured]\nrates = [\"data.csv\"]\n[fit]\nlaw = \"{law}\"\n");
    let cases = [
        (readings.clone(), curve(&wide, |a| 1e6 * (a / 6.0).powf(-12.0)), "at the limit of the search range 1 to 8"),
        (readings.clone(), curve(&wide, |a| 1e4 * (a / 6.0).powf(0.5)), "at the limit of the search range 1 to 8"),
        (readings, curve(&narrow, |a| 1e5 * (a / 20.0).powi(-2)), "p cannot be determined"),
        (law("walker"), rates(&[0.1]), "walker_gamma cannot be determined: all rates are at one stress ratio"),
        (law("forman"), rates(&[0.1, 0.5]), "k_c_mpa_sqrt_m cannot be determined: best fit at the limit of its range"),
        (law("nasgro"), rates(&[0.1, 0.5]), "cannot be determined"),
    ];
    for (case, data, words) in cases {
        fs::write(here.join("case.toml"), &case).unwrap();
        fs::write(here.join("data.csv"), data).unwrap();
        assert_refused(&perilife(here, "calibrate case.toml --out out"), 3, &[words]);
        assert!(!here.join("out/fitted.toml").exists(), "{words}");
        assert_eq!(fs::read_dir(here).unwrap().count(), 2, "{words}: nothing half-written stays");
    }
}

#[test]
fn rates_and_sweeps_tell_where_the_formula_does_not_hold() {
    let dir = tempdir().unwrap();
    let here = dir.path();
    let case = "[specimen]\nkind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 12.5\ncrack_length_mm = 4\n[material]\n\
                youngs_modulus_gpa = 71\npoisson_ratio = 0.33\n[loading]\nforce_max_kn = 6\nstress_ratio = 0.1\n[model]\n\
                method = \"handbook\"\n[fatigue]\nparis_c_mm_per_cycle = 5e-8\nparis_m = 3\n[stop]\ncrack_length_mm = 15\n";
    fs::write(here.join("ct.toml"), case).unwrap();
    let lengths: Vec<f64> = (0..12).map(|i| 4.0 + f64::from(i)).collect();
    fs::write(here.join("ct.csv"), curve(&lengths, |_| 1e5)).unwrap();
    // a/W 0.2 is 10 mm: secants at 4.5 to 9.5 mm lie below.
    let (_, stderr) = done(here, "rates ct.csv --specimen ct.toml --method secant --out rates.csv");
    let words = "6 of 11 rates (54.5 %), at crack lengths from 4.500 to 9.500 mm, are outside the range of ASTM E647 compact";
    assert!(stderr.contains(words), "{stderr}");
    let sweep = "case = \"ct.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"specimen.crack_length_mm\"\nvalues = [9.5, 4.0, 11.0]\n";
    fs::write(here.join("sweep.toml"), sweep).unwrap();
    let (_, stderr) = done(here, "sweep sweep.toml --out out");
    let line = stderr.lines().find(|line| line.contains("of life outside the range of ASTM E647 compact"));
    let line = line.unwrap_or_else(|| panic!("{stderr}"));
    assert!(line.contains("and 1 more"), "{line}");
    let figures = json(here.join("out/sweep.json"));
    let is_told = |told: &&Value| told["warning"].as_str().unwrap().contains("ASTM E647 compact");
    let told = figures["warnings"].as_array().unwrap().iter().find(is_told).unwrap();
    // The second case starts at a/W 0.08 and spends nearly all of its life below 0.2.
    assert!(told["largest_percent"].as_f64().unwrap() > 60.0, "{told}");
    assert_ne!(told["largest_in"], told["first"], "{told}");
    let share = told["largest_percent"].to_string();
    assert!(line.contains(&share), "{share} in {line}");
    // A case inside the range says nothing.
    let inside = done(here, "rates ct.csv --specimen ct.toml --set specimen.width_mm=20 --method secant --out r.csv");
    assert!(!inside.1.contains("outside the range"), "{}", inside.1);
}
