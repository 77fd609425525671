//! Cracks that do not go through: what is refused, and what a run, `check`, `sif` and `list` say of them.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::tempdir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::desk::done;
use crate::support::rows::rows;

const EXAMPLE: &str = include_str!("../../data/cases/corner_crack_at_hole.toml");

fn write(folder: &Path, change: [&str; 2]) {
    assert!(EXAMPLE.contains(change[0]), "{}", change[0]);
    fs::write(folder.join("hole.toml"), EXAMPLE.replace(change[0], change[1])).unwrap();
}

#[test]
fn bad_input_is_refused_by_name() {
    let dir = tempdir().unwrap();
    for ([old, new], words) in rows::<Vec<([String; 2], Vec<String>)>>("part_through", "refused") {
        write(dir.path(), [&old, &new]);
        for command in [&["predict", "hole.toml", "--out", "run"][..], &["check", "hole.toml"]] {
            assert_refused(&perilife(dir.path(), command), 2, &words);
        }
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1, "nothing half-written");
    // Keys of such cracks do not go with others; nodes do not know them.
    let panel = include_str!("../../data/cases/hand_calculation.toml");
    for (key, words) in [
        ("loading.bending_ratio=1", &["loading.bending_ratio", "through crack"][..]),
        ("stop.crack_depth_mm=1", &["stop.crack_depth_mm", "middle_tension"]),
        ("specimen.crack_depth_mm=1", &["specimen.crack_depth_mm", "surface_crack"]),
    ] {
        fs::write(dir.path().join("panel.toml"), panel).unwrap();
        assert_refused(&perilife(dir.path(), &format!("check panel.toml --set {key}")), 2, words);
    }
    // Bending beside further holes is not known.
    write(dir.path(), ["cracks = 1 ", "holes = [{ x_mm = 25, y_mm = 0, diameter_mm = 6 }]\ncracks = 1 "]);
    let bent = ["check", "hole.toml", "--set", "loading.bending_ratio=1"];
    assert_refused(&perilife(dir.path(), &bent), 2, &["loading.bending_ratio", "specimen.holes"]);
    // Overloads leave a zone at each end of a front.
    let example = include_str!("../../data/cases/corner_crack_at_hole.toml");
    let unlike = |line: &&str| !line.starts_with("stress_") && !line.starts_with("kind = \"constant_amplitude\"");
    let rest = example.lines().filter(unlike).collect::<Vec<_>>().join("\n");
    let spectrum = "[loading]\nkind = \"spectrum\"\nspectrum_file = \"flights.csv\"\nspectrum_scale_mpa = 100\n";
    fs::write(dir.path().join("flights.csv"), "max,min,cycles\n1,0.1,1\n0.5,0.1,100\n").unwrap();
    fs::write(dir.path().join("flights.toml"), rest.replace("[loading]", spectrum)).unwrap();
    let check = perilife(dir.path(), "check flights.toml");
    assert_eq!(check.status.code(), Some(0), "{:?}", texts(&check));
    let retarded = ["check", "flights.toml", "--set", "loading.retardation=\"wheeler\"", "--set", "loading.wheeler_exponent=1.5"];
    done(dir.path(), &retarded);
    write(dir.path(), ["", ""]);
    for more in [&["--method", "ring"][..], &["--method", "element_free_galerkin"], &["--out", "sif"]] {
        assert_refused(&perilife(dir.path(), &[&["sif", "hole.toml"], more].concat()), 2, &["part-through"]);
    }
}

#[test]
fn the_example_runs_through_break_through_to_its_end() {
    let dir = tempdir().unwrap();
    write(dir.path(), ["", ""]);
    let (stdout, _) = done(dir.path(), "predict hole.toml --out run --json");
    let result: Value = serde_json::from_str(&stdout).unwrap();
    let part = &result["part_through"];
    let number = |key: &str| part[key].as_f64().unwrap();
    let life = result["life_cycles"].as_f64().unwrap();
    assert!(number("cycles_at_break_through") < life && number("crack_depth_final_mm") == 5.0, "{part}");
    assert!(number("life_cycles_if_k_is_larger") < life && life < number("life_cycles_if_k_is_smaller"), "{part}");
    assert!(part["outside_range"].as_array().unwrap().iter().any(|range| range["of"] == "a/t"), "{part}");
    assert_eq!(result["model"]["method"], "handbook");
    assert!(result["solves"].as_u64().unwrap() > 0);
    assert!(result["no_error_estimate"].as_str().unwrap().contains("after breakthrough"));
    let names: Vec<&str> = result["checks"].as_array().unwrap().iter().map(|check| check["name"].as_str().unwrap()).collect();
    assert!(names.contains(&"part_through_factors") && names.contains(&"part_through_range"), "{names:?}");
    let change = |key: &str| 100.0 * (number(key) / life - 1.0);
    let [less, more] = ["life_cycles_if_k_is_larger", "life_cycles_if_k_is_smaller"].map(change);
    let words = format!("±5 % (source), {less:+.1} % to {more:+.1} % in life");
    assert!(result["checks"].to_string().contains(&words), "{words}: {}", result["checks"]);
    let run = dir.path().join("run");
    let table = fs::read_to_string(run.join("a_n.csv")).unwrap();
    let head: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let place = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let depths: Vec<f64> =
        table.lines().skip(1).map(|row| row.split(',').nth(place("crack_depth_mm")).unwrap().parse().unwrap()).collect();
    assert!(depths[0] == 1.27 && depths.windows(2).all(|pair| pair[0] <= pair[1]) && depths.last() == Some(&5.0));
    assert!(table.lines().last().unwrap().split(',').nth(place("depth_k_i_mpa_sqrt_m")) == Some(""));
    assert!(fs::read_to_string(run.join("factors.csv")).unwrap().lines().any(|row| row.starts_with("depth,0")));
    for picture in ["section.svg", "plate.svg", "k.svg", "a_n.svg"] {
        assert!(fs::read_to_string(run.join(picture)).unwrap().contains("</svg>"), "{picture}");
    }
    // Up to breakthrough: the error that ±5 % of K make, and all of the cycles beyond a/t of 0.8.
    let output = perilife(dir.path(), "predict hole.toml --out part --json --set stop.at_break_through=true");
    let result: Value = serde_json::from_str(&texts(&output).0).unwrap();
    let (part, life) = (&result["part_through"], result["life_cycles"].as_f64().unwrap());
    let longer = part["life_cycles_if_k_is_smaller"].as_f64().unwrap() / life - 1.0;
    let beyond: Vec<&Value> = part["outside_range"].as_array().unwrap().iter().collect();
    assert!(beyond.len() == 1 && longer > 0.1, "{part}");
    let outside = beyond[0]["life_share"].as_f64().unwrap();
    let stated = result["error_estimate_percent"].as_f64().unwrap();
    assert!((stated - 100.0 * (longer + outside)).abs() < 0.6, "{stated}: {longer} and {outside}");
    // Page, export and words take it.
    for command in [&["report", "run", "--out", "page.html"][..], &["export", "run", "--points", "20", "--out", "e.csv"]] {
        done(dir.path(), command);
    }
    let (stdout, stderr) = texts(&perilife(dir.path(), "predict hole.toml --out run --cross-check --residual-strength -v"));
    assert!(stdout.contains("Breakthrough   after") && stdout.contains("depth 1.27 → 5.00 mm"), "{stdout}");
    assert!(stdout.contains("Cross-check") && stdout.contains("no other method"), "{stdout}");
    assert!(stderr.contains("Newman-Raju K: ±5 % (source)"), "{stderr}");
    let (stdout, _) = texts(&perilife(dir.path(), "check hole.toml -v"));
    assert!(stdout.contains("Newman and Raju 1984") && stdout.contains("depth 1.27 mm of 5 mm"), "{stdout}");
}

#[test]
fn sif_gives_k_of_both_ends() {
    let dir = tempdir().unwrap();
    write(dir.path(), ["", ""]);
    let object: Value = serde_json::from_str(&texts(&perilife(dir.path(), "sif hole.toml --json")).0).unwrap();
    let tips = object["tips"].as_array().unwrap();
    assert_eq!((tips.len(), &tips[0]["end"], &tips[1]["end"]), (2, &"depth".into(), &"surface".into()));
    for (tip, x) in [4.0, 5.27].into_iter().enumerate() {
        assert!((tips[tip]["x_mm"].as_f64().unwrap() - x).abs() < 1e-9, "{object}");
    }
    let k = |tip: usize| tips[tip]["handbook_k_i_mpa_sqrt_m"].as_f64().unwrap();
    assert!(k(0) > k(1) && k(1) > 5.0, "{object}");
    let (stdout, _) = texts(&perilife(dir.path(), "sif hole.toml"));
    assert!(stdout.contains("depth") && stdout.contains("surface"), "{stdout}");
}
