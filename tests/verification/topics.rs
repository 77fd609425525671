//! The topics of `perilife verify`, and the table of accuracy of the README.

use perilife_study::verification::{line, markdown};
use perilife_study::{Topic, VerificationRow, faults, rows, topics};

use crate::support::plates::PANEL;
use crate::verification::stress_intensity::{SINGLE, k_over_handbook};

// The topics of `perilife verify`: cheap ones with every run of the tests, all of them where that is asked for.

/// Topics of a few seconds each.
const CHEAP: [&str; 7] = ["golden", "static_scenes", "dual_horizon", "golden_peridynamics", "same_plate", "named_plates", "pins"];

/// The rows of the topics with these names, of which none fails and as many miss as are pinned.
fn sound(names: &[&str]) -> (Vec<&'static Topic>, Vec<VerificationRow>) {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let topics = topics(&names).unwrap();
    let rows = rows(&topics, &|_, rows| rows.iter().for_each(|row| println!("{}", line(row)))).unwrap();
    let faults = faults(&topics, &rows);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    (topics, rows)
}

#[test]
fn cheap_topics_keep_their_bounds() {
    let (topics, rows) = sound(&CHEAP);
    for topic in topics {
        let of_topic = rows.iter().filter(|row| row.name == topic.name).count();
        assert!(of_topic >= 4, "{}: {of_topic} rows", topic.name);
    }
}

#[test]
#[ignore = "long: the whole verification, three minutes"]
fn the_table_of_all_topics_is_what_the_program_computes() {
    let (topics, rows) = sound(&[]);
    let written = std::fs::read_to_string("tests/ACCURACY.md").unwrap();
    assert!(
        written == markdown(&topics, &rows),
        "tests/ACCURACY.md is out of date; `perilife verify --markdown tests/ACCURACY.md` writes it"
    );
}

// The accuracy table of the README is recomputed here, so that it cannot age.

/// What every line of the table begins with.
const MARKER: &str = "| K_I, ";

/// One line of the table: what, where, spacing, relative error in percent, reference.
fn rows_of_readme_accuracy() -> Vec<(f64, String)> {
    let uniform: String = format!("{SINGLE}ends=\"uniform_stress\"\n");
    let double = "kind=\"double_edge_tension\"\nwidth_mm=150\nlength_mm=300\nthickness_mm=2\ncrack_length_mm=30\n";
    let compact = "kind=\"compact_tension\"\nwidth_mm=100\nthickness_mm=5\ncrack_length_mm=40\n";
    let panel = |nu: f64| vec![format!("material.poisson_ratio={nu}")];
    let scenes = [
        ("middle tension, W 152.4 mm, ν 0.1", PANEL, panel(0.1), 1.5, 30.0, "Feddersen secant"),
        ("middle tension, W 152.4 mm, ν 0.2", PANEL, panel(0.2), 1.5, 30.0, "Feddersen secant"),
        ("middle tension, W 152.4 mm, ν 0.3", PANEL, panel(0.3), 1.5, 30.0, "Feddersen secant"),
        ("middle tension, W 152.4 mm, ν 0.3", PANEL, panel(0.3), 1.5, 45.0, "Feddersen secant"),
        ("single edge, uniform stress, W 100 mm", uniform.as_str(), Vec::new(), 1.25, 40.0, "Tada"),
        ("double edge, W 150 mm", double, Vec::new(), 1.5, 40.0, "Tada"),
        ("compact tension, W 100 mm", compact, Vec::new(), 1.25, 40.0, "ASTM E647"),
        ("compact tension, W 100 mm", compact, Vec::new(), 1.25, 60.0, "ASTM E647"),
    ];
    let mut rows: Vec<(f64, String)> = scenes
        .into_iter()
        .map(|(what, specimen, set, spacing, length, source)| {
            let error = 100.0 * (k_over_handbook(specimen, &set, length, spacing) - 1.0);
            (error, format!("{MARKER}{what}, a {length} mm | {spacing} mm | {error:+.1} % | {source} |"))
        })
        .collect();
    rows.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    rows
}

#[test]
fn the_accuracy_table_of_the_readme_is_what_the_program_computes() {
    let rows = rows_of_readme_accuracy();
    let table: Vec<&str> = rows.iter().map(|(_, row)| row.as_str()).collect();
    println!("{}", table.join("\n"));
    let readme = std::fs::read_to_string("README.md").unwrap();
    let written: Vec<&str> = readme.lines().filter(|line| line.starts_with(MARKER)).collect();
    // All others stand in `tests/ACCURACY.md`.
    assert!(written.len() <= 12, "{} lines", written.len());
    assert_eq!(written, table, "the table of README.md is out of date; it should read as printed above");
}
