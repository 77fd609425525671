//! `perilife rates` on files that the user has to say something of, and on tests that no law holds.

use std::fs;

use tempfile::tempdir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::daily::panel_without_law;
use crate::support::desk::{done, json};
use crate::support::fatigue_test::{calibration, lengths, readings};
use crate::support::rows::assert_says;

/// Writes a test by `row` of cycles and length in mm, read every `step` mm, and its specimen.
fn folder(step: f64, header: &str, force: impl Fn(f64) -> f64, row: impl Fn(f64, f64) -> String) -> tempfile::TempDir {
    let dir = tempdir().unwrap();
    let made = readings(1e-8, 3.0, &lengths(12.0, 30.0, step), force, |_| 1.0);
    let rows: String = made.iter().map(|&(n, a)| row(n, a) + "\n").collect();
    fs::write(dir.path().join("lab.txt"), format!("{header}\n{rows}")).unwrap();
    fs::write(dir.path().join("ct.toml"), calibration("lab.txt", "")).unwrap();
    dir
}

fn law(output: &std::process::Output) -> (f64, f64) {
    assert_eq!(output.status.code(), Some(0), "{}", texts(output).1);
    let object: serde_json::Value = serde_json::from_str(&texts(output).0).unwrap();
    let of = |key: &str| object["specimens"][0][key].as_f64().unwrap();
    (of("paris_c_mm_per_cycle"), of("paris_m"))
}

#[test]
fn columns_decimal_sign_and_units_are_options() {
    // Whole thousands alone, in names that nobody knows.
    let dir = folder(
        1.0,
        "A;B;C",
        |_| 5.4,
        |n, a| {
            let n = format!("{:.0}", n + 1000.0);
            format!("x;{}.{};{}", &n[..n.len() - 3], &n[n.len() - 3..], a)
        },
    );
    let run = |options: &[&str]| {
        perilife(dir.path(), &[&["rates", "lab.txt", "--specimen", "ct.toml", "--method", "secant", "--json"], options].concat())
    };
    assert_refused(&run(&[]), 2, &["lab.txt:1", "header = A", "line 2: x | 1.000 | 12", "--column cycles="]);
    let columns = ["--column", "cycles=B", "--column", "length=C"];
    assert_refused(&run(&columns), 2, &["header = C", "has no unit", "--length-unit"]);
    let with_unit = [&columns[..], &["--length-unit", "mm"]].concat();
    assert_refused(&run(&with_unit), 2, &["lab.txt:2", "B = 1.000", "is ambiguous: 1 or 1000", "--decimal"]);
    let (c, m) = law(&run(&[&with_unit[..], &["--decimal", ","]].concat()));
    assert!((m - 3.0).abs() < 0.01 && (c / 1e-8 - 1.0).abs() < 0.03, "{c:e} {m}");
    // The same words in a calibration file.
    let keys = "length_unit = \"mm\"\ndecimal = \",\"\ncolumns = { cycles = \"B\", length = \"C\" }";
    fs::write(dir.path().join("fit.toml"), calibration("lab.txt", keys)).unwrap();
    let (stdout, _) = done(dir.path(), "calibrate fit.toml --out out --json");
    let object: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert!((object["paris_m"].as_f64().unwrap() - 3.0).abs() < 0.01, "{object}");
    for key in ["law", "misfit_at_ends", "left_out"] {
        assert!(object.get(key).is_some(), "{key} in {object}");
    }
    let wrong = [
        ("columns = { cycels = \"B\" }", "measured.columns.cycels = \"B\": unknown key; did you mean cycles?"),
        ("columns = { cycles = 1.5 }", "measured.columns.cycles = 1.5: is not the name of a column or its number"),
        (
            "columns = { length = [] , cycles = \"Q\" }",
            "measured.columns.cycles = Q: is not a column of this file; its columns are A | B | C",
        ),
        ("decimal = \";\"", "measured.decimal = \";\": unknown kind; use one of: ., ,"),
        ("sheet = true", "measured.sheet = true: is not the name of a sheet or its number"),
        ("load_unit = \"t\"", "use one of: N, kN, lbf, kip, kgf, MPa, ksi"),
        ("leave_out = [{ from_cycles = 0 }]", "measured.leave_out"),
    ];
    for (keys, words) in wrong {
        fs::write(dir.path().join("wrong.toml"), calibration("lab.txt", keys)).unwrap();
        assert_refused(&perilife(dir.path(), "calibrate wrong.toml --out no"), 2, &[words]);
    }
}

#[test]
fn loads_of_readings_are_used_and_missed_ones_told() {
    let force = |a: f64| if a > 21.0 { 6.48 } else { 5.4 };
    let with =
        folder(0.75, "N;a (mm);Pmax (kN);Pmin (kN)", force, |n, a| format!("{n};{a};{};{}", force(a) / 0.9, force(a) / 9.0));
    let rates = ["rates", "lab.txt", "--specimen", "ct.toml", "--json"];
    let (c, m) = law(&perilife(with.path(), &rates));
    assert!((m - 3.0).abs() < 0.05 && (c * 1e3_f64 / 1e-5 - 1.0).abs() < 0.2, "{c:e} {m}");
    let without = folder(0.75, "N;a (mm)", force, |n, a| format!("{n};{a}"));
    let output = perilife(without.path(), &rates);
    let (_, stderr) = texts(&output);
    assert!(stderr.contains("lab.txt: lines 14 to 15: rate changes"), "{stderr}");
    assert!((law(&output).1 - 3.0).abs() > 0.3);
}

/// Load and crack length that the specimen does not give are those of the readings.
#[test]
fn rates_take_load_and_length_from_the_readings() {
    let force = |_: f64| 5.4;
    let with =
        folder(0.75, "N;a (mm);Pmax (kN);Pmin (kN)", force, |n, a| format!("{n};{a};{};{}", force(a) / 0.9, force(a) / 9.0));
    let rates = |file: &str| perilife(with.path(), &["rates", "lab.txt", "--specimen", file, "--json"]);
    let whole = law(&rates("ct.toml"));
    let text = fs::read_to_string(with.path().join("ct.toml")).unwrap();
    let (before, loading) = text.split_once("[loading]").unwrap();
    let rest = loading.split_once("\n[").map_or(String::new(), |(_, rest)| format!("[{rest}"));
    let kept = format!("{before}{rest}").replace("crack_length_mm", "# crack_length_mm");
    let bare = kept.lines().filter(|line| !line.starts_with("# crack")).map(|line| format!("{line}\n")).collect::<String>();
    assert!(!bare.contains("crack_length_mm =") && !bare.contains("force_"), "{bare}");
    fs::write(with.path().join("bare.toml"), bare).unwrap();
    let output = rates("bare.toml");
    assert_says(&texts(&output).1, &["loading: force_max_kn = 6", "initial crack length: "]);
    let (c, m) = law(&output);
    assert!((m / whole.1 - 1.0).abs() < 1e-9 && (c / whole.0 - 1.0).abs() < 1e-6, "{c:e} {m} {whole:?}");
}

#[test]
fn a_law_that_no_metal_has_is_marked() {
    let dir = folder(0.75, "megacycles;a (mm)", |_| 5.4, |n, a| format!("{n};{a}"));
    let (stdout, stderr) = done(dir.path(), "rates lab.txt --specimen ct.toml --json");
    assert!(stderr.contains("specimen lab: the rate at ΔK = 10 MPa√m is"), "{stderr}");
    let object: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert!(object["specimens"][0]["warnings"].to_string().contains("the range of metals"), "{object}");
    assert_refused(&perilife(dir.path(), "calibrate ct.toml --out out"), 2, &["measured.files: implausible growth law"]);
    assert!(!dir.path().join("out").exists());
}

#[test]
fn sides_that_differ_too_much_are_flagged() {
    // 0.25 B is 3 mm.
    for (apart, uneven) in [(2.9, false), (3.1, true)] {
        let dir = folder(0.75, "N;front (mm);back (mm)", |_| 5.4, |n, a| format!("{n};{};{}", a + apart / 2.0, a - apart / 2.0));
        let (stdout, stderr) = done(dir.path(), "rates lab.txt --specimen ct.toml");
        assert_eq!(stdout.contains("uneven_front"), uneven, "{apart}: {stdout}");
        assert_eq!(stderr.contains("exceed 3.00 mm (ASTM E647)"), uneven, "{apart}: {stderr}");
    }
}

/// What a spreadsheet would run as a formula is text in the table, and the same name again where the table is read.
#[test]
fn names_like_formulas_are_text_in_tables() {
    let dir = tempdir().unwrap();
    let names = ["=1+1", "+A1", "-S", "@sum"];
    let row = |name: &str, i: usize| format!("{name},{},{}\n", 1000 * i, 10 + i);
    let rows: String = names.iter().flat_map(|name| (0..8).map(move |i| row(name, i))).collect();
    fs::write(dir.path().join("lab.csv"), format!("specimen,cycles,crack_length_mm\n{rows}")).unwrap();
    let read = |file: &str, out: &[&str]| {
        let (stdout, _) = done(dir.path(), &[&["rates", file, "--method", "secant"], out].concat());
        stdout
    };
    read("lab.csv", &["--out", "rates.csv", "--quiet"]);
    let table = fs::read_to_string(dir.path().join("rates.csv")).unwrap();
    for line in table.lines().skip(1) {
        assert!(line.starts_with('\''), "{line}");
    }
    // The table is one of readings too.
    let object: serde_json::Value = serde_json::from_str(&read("rates.csv", &["--json"])).unwrap();
    let found: Vec<&str> = object["specimens"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(found, names);
}

/// da/dN, mm/cycle, whose exponent rises from 2 in the middle of the range towards both ends; ΔK in MPa√m.
fn curved_rate(delta_k: f64) -> f64 {
    let x = (delta_k / 14.0).ln();
    (1.8e-4_f64.ln() + 2.0 * x + 1.5 * x.powi(3)).exp()
}

/// Cycles from half crack 9 mm to every half millimetre, K by Feddersen (1966).
fn curved_readings(names: &[(&str, f64)]) -> String {
    let delta_k = |a: f64| 48.28 * (std::f64::consts::PI * a * 1e-3 / (std::f64::consts::PI * a / 152.4).cos()).sqrt();
    let mut text = "specimen,cycles,crack_length_mm\n".to_owned();
    for (name, factor) in names {
        let mut cycles = 0.0;
        for step in 0..=80 {
            let a = 9.0 + 0.5 * f64::from(step);
            text += &format!("{name},{cycles:.0},{a}\n");
            cycles += (0..50).map(|k| 0.01 / curved_rate(delta_k(a + 0.01 * (f64::from(k) + 0.5))) * factor).sum::<f64>();
        }
    }
    text
}

#[test]
fn a_curve_that_was_fitted_is_drawn_and_gives_the_life() {
    let dir = tempdir().unwrap();
    let panel = panel_without_law();
    let write = |name: &str, text: &str| fs::write(dir.path().join(name), text).unwrap();
    write("lot.csv", &curved_readings(&[("one", 1.02), ("two", 1.0), ("three", 0.98)]));
    write("fit.toml", &format!("[measured]\nfiles = [\"lot.csv\"]\n{panel}"));
    write("case.toml", &format!("{panel}[fatigue]\nfitted = \"fit/fitted.toml\"\n[stop]\ncrack_length_mm = 45\n"));
    let done = |arguments: &str| {
        let (stdout, _) = done(dir.path(), &arguments.split(' ').collect::<Vec<_>>());
        stdout
    };
    done("calibrate fit.toml --out fit");
    assert!(fs::read_to_string(dir.path().join("fit/fitted.toml")).unwrap().contains("law = \"curve\""));

    let table = done("rates --materials fit/fitted.toml --stress-ratio 0.2 --picture law.svg");
    let row: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    for (column, delta_k) in [(3, 10.0), (4, 20.0)] {
        let rate: f64 = row[column].parse().unwrap();
        assert!((rate / curved_rate(delta_k) - 1.0).abs() < 0.01, "{delta_k}: {rate}");
    }
    // Beyond the readings there is no rate, and at another stress ratio no law.
    assert_eq!([row[2], row[5]], [""; 2]);
    assert!(fs::read_to_string(dir.path().join("law.svg")).unwrap().contains("fit/fitted.toml"));
    let other = perilife(dir.path(), "rates --materials fit/fitted.toml --stress-ratio 0.1");
    assert_refused(&other, 2, &["stress_ratio = 0.1", "0.2"]);

    done("predict case.toml --out run");
    let result = json(dir.path().join("run/result.json"));
    let readings = curved_readings(&[("two", 1.0)]);
    let row = readings.lines().find(|line| line.ends_with(",45")).unwrap();
    let measured: f64 = row.split(',').nth(1).unwrap().parse().unwrap();
    assert!((result["life_cycles"].as_f64().unwrap() / measured - 1.0).abs() < 0.002, "{} for {measured}", result["life_cycles"]);
}
