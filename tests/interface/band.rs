//! A life with its band: `predict` with a record of one specimen, readings of the plate itself, inspections.

use std::fs;
use std::path::Path;

use tempfile::{TempDir, tempdir};

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::daily::panel_without_law;
use crate::support::desk::{done, json};
use crate::support::rows::assert_says;

const REST: &str = "[fatigue]\nfitted = \"fit/fitted.toml\"\n[stop]\ncrack_length_mm = 45.0\n";

/// A folder with the committed readings, a record of them by hand calculation, and a case.
fn folder() -> TempDir {
    let dir = tempdir().unwrap();
    let readings = Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/al2024-t3/measured/virkler_median.csv");
    fs::copy(readings, dir.path().join("median.csv")).unwrap();
    fs::write(dir.path().join("fit.toml"), format!("[measured]\nfiles = [\"median.csv\"]\n{}", panel_without_law())).unwrap();
    fs::write(dir.path().join("case.toml"), format!("{}{REST}", panel_without_law())).unwrap();
    done(dir.path(), "calibrate fit.toml --out fit");
    dir
}

/// The first readings of the median, as a table of their own.
fn write_readings(folder: &Path, name: &str, to_mm: f64, factor: f64) {
    let table = fs::read_to_string(folder.join("median.csv")).unwrap();
    let rows = table.lines().skip(1).filter_map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        let (cycles, length): (f64, f64) = (fields[1].parse().ok()?, fields[2].parse().ok()?);
        (length <= to_mm).then(|| format!("{},{length}\n", cycles * factor))
    });
    fs::write(folder.join(name), "cycles,crack_length_mm\n".to_owned() + &rows.collect::<String>()).unwrap();
}

#[test]
fn a_record_of_one_specimen_gives_a_band_by_assumed_scatter() {
    let dir = folder();
    let (stdout, _) = done(dir.path(), "predict case.toml --out run --inspect-from 20 --pod 20,30");
    assert_says(
        &stdout,
        &[
            "cycles (median; 90 % band ",
            "from 1 specimen, same lot (for another lot: fatigue.lot = \"other\"); scatter assumed",
            "  Remaining  ",
            "(5 % remaining life / 3)",
        ],
    );
    let (said, _) = done(dir.path(), "predict case.toml --out given --set fatigue.lot=same");
    assert!(said.contains("same lot") && !said.contains("fatigue.lot"), "{said}");
    let result = json(dir.path().join("run/result.json"));
    let band = &result["band"];
    assert_eq!((&band["specimens"], &band["assumed_scatter"], &band["lot"]), (&1.into(), &true.into(), &"same".into()));
    let [low, middle, high] = ["cycles_p05", "cycles_p50", "cycles_p95"].map(|key| band[key].as_f64().unwrap());
    assert!(low < 0.85 * middle && high > 1.15 * middle, "{band}");
    assert!(result["no_band"].is_null() && band["share_outside"] == result["life_share_extrapolated"], "one share: {band}");
    let inspection = &result["inspection"];
    let [left, every] = ["remaining_cycles_p05", "inspection_interval_cycles"].map(|key| inspection[key].as_f64().unwrap());
    assert!((left / every - 3.0).abs() < 1e-9 && inspection["has_band"] == true, "{inspection}");

    // The 5 % plate is inspected before it fails: at the length that the interval is of, and by its own cycles.
    let rows = result["inspections"]["rows"].as_array().unwrap();
    let [first, last] = [&rows[0], &rows[2]].map(|row| row["cycles"].as_f64().unwrap());
    assert!(rows.len() == 3 && first < inspection["cycles_at"].as_f64().unwrap() && last < low, "{rows:?} {band}");
    assert!((rows[0]["crack_length_mm"].as_f64().unwrap() - 20.0).abs() < 0.01, "{rows:?}");
    let late = format!("predict case.toml --out late --inspect-from 20 --pod 20,30 --first-inspection {middle:.0}");
    let (said, _) = done(dir.path(), &late);
    assert!(said.contains("POD            first at ") && said.contains("after the end of the inspected life"), "{said}");
    assert!(json(dir.path().join("late/result.json"))["warnings"].to_string().contains("inspections: first at "));

    let table = fs::read_to_string(dir.path().join("run/a_n.csv")).unwrap();
    let head: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    assert_eq!(head[..4], ["cycles", "crack_length_mm", "delta_k_mpa_sqrt_m", "da_dn_mm_per_cycle"]);
    let place = head.iter().position(|name| *name == "cycles_p05").unwrap();
    assert_eq!(head[place..place + 3], ["cycles_p05", "cycles_p50", "cycles_p95"]);
    let last: Vec<f64> = table.lines().last().unwrap().split(',').map(|field| field.parse().unwrap_or(f64::NAN)).collect();
    assert!((last[place] / low - 1.0).abs() < 1e-12 && (last[place + 2] / high - 1.0).abs() < 1e-12);
    // The table is read again as it was.
    done(dir.path(), "export run --points 20 --out export.csv");

    let without = "fatigue.fitted=\"bare.toml\"";
    let record = fs::read_to_string(dir.path().join("fit/fitted.toml")).unwrap();
    fs::write(dir.path().join("bare.toml"), record.split("[population]").next().unwrap()).unwrap();
    let (stdout, _) = done(dir.path(), &format!("predict case.toml --out bare --set {without} --inspect-from 20 --factor 2"));
    assert!(stdout.contains("Scatter band   not available: fitted law without [population]"), "{stdout}");
    assert!(stdout.contains("(remaining life / 2; no scatter band)"), "{stdout}");
    let result = json(dir.path().join("bare/result.json"));
    assert!(result["band"].is_null() && result["inspection"]["has_band"] == false);
    assert!(!fs::read_to_string(dir.path().join("bare/a_n.csv")).unwrap().contains("cycles_p05"));
    fs::write(dir.path().join("bare.toml"), record.replacen("pivot = ", "pivot = -", 1)).unwrap();
    let output = perilife(dir.path(), &format!("predict case.toml --out no --set {without}"));
    assert_refused(&output, 2, &["case.toml", "fatigue.fitted", "law.pivot = -", "calibrate again"]);
}

#[test]
fn readings_of_the_plate_narrow_what_it_has_left() {
    let dir = folder();
    write_readings(dir.path(), "own.csv", 25.0, 0.9);
    let (stdout, _) = done(dir.path(), "predict case.toml --out run --measured own.csv --inspect-from 30 --pod 20,30");
    assert!(stdout.contains("  This plate     last reading 25.0 mm at "), "{stdout}");
    let result = json(dir.path().join("run/result.json"));
    let (own, lot) = (&result["measured"], &result["measured"]["of_lot"]);
    let [read, left] = ["cycles", "remaining_cycles_p05"].map(|key| own[key].as_f64().unwrap());
    let looks = &result["inspections"];
    let [first, end] = [&looks["rows"][0]["cycles"], &looks["end_cycles"]].map(|cycles| cycles.as_f64().unwrap());
    assert!(read < first && (end / (read + left) - 1.0).abs() < 0.03, "from the last reading: {looks} {own}");
    let keys = ["remaining_cycles_p05", "remaining_cycles_p50", "remaining_cycles_p95"];
    let [own, lot] = [own, lot].map(|object| keys.map(|key| object[key].as_f64().unwrap()));
    assert!(own[2] / own[0] < 0.8 * lot[2] / lot[0], "{own:?} {lot:?}");
    // It went faster than the specimen, and what is left is shorter.
    assert!(own[1] < 0.97 * lot[1], "{own:?} {lot:?}");
    assert!(result["inspection"]["remaining_cycles_p50"].as_f64().unwrap() < own[1]);
    let named: Vec<&str> = result["inputs"].as_array().unwrap().iter().map(|file| file["file"].as_str().unwrap()).collect();
    assert!(named.contains(&"own.csv") && dir.path().join("run/inputs/own.csv").is_file(), "{named:?}");

    // Every mistake names what is wrong.
    let predict = |more: &[&str]| perilife(dir.path(), &[&["predict", "case.toml", "--out", "no"][..], more].concat());
    let no_law = "fatigue.fitted=\"bare.toml\"";
    let record = fs::read_to_string(dir.path().join("fit/fitted.toml")).unwrap();
    fs::write(dir.path().join("bare.toml"), record.split("[population]").next().unwrap()).unwrap();
    assert_refused(&predict(&["--measured", "own.csv", "--set", no_law]), 2, &["--measured", "own.csv", "without [population]"]);
    assert_refused(&predict(&["--measured", "gone.csv"]), 4, &["gone.csv"]);
    let two = "specimen,cycles,crack_length_mm\n".to_owned()
        + &["a", "b"].map(|name| (0..6).map(|i| format!("{name},{},{}\n", 9000 * i, 9 + i)).collect::<String>()).concat();
    fs::write(dir.path().join("two.csv"), two).unwrap();
    assert_refused(&predict(&["--measured", "two.csv"]), 2, &["two.csv", "contains 2 specimens (a, b)"]);
    assert_refused(&predict(&["--inspect-from", "20", "--factor", "0.5"]), 2, &["--factor", "0.5", "is not 1 or more"]);
    // What shows after the run spares its files.
    write_readings(dir.path(), "long.csv", 47.0, 1.0);
    let from = ["--inspect-from = 60 mm", "is not on the curve, 9 to 45"];
    assert_refused(&predict(&["--inspect-from", "60"]), 2, &from);
    assert!(!dir.path().join("no").exists(), "a length off the curve is wrong input");
    let words = ["long.csv:", "crack_length_mm", "is not on the predicted curve"];
    let output = predict(&["--measured", "long.csv"]);
    assert!(output.status.code() == Some(2) && words.iter().all(|word| texts(&output).1.contains(word)), "{}", texts(&output).1);
    assert!(dir.path().join("no/a_n.csv").is_file());
}
