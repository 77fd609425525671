//! The accuracy table of the README is recomputed here, so that it cannot age.

use crate::support::plates::PANEL;
use crate::verification::stress_intensity::{SINGLE, k_over_handbook};

/// What every line of the table begins with.
const MARKER: &str = "| K_I, ";

/// One line of the table: what, where, spacing, relative error in percent, reference.
fn rows() -> Vec<(f64, String)> {
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
    let rows = rows();
    let table: Vec<&str> = rows.iter().map(|(_, row)| row.as_str()).collect();
    println!("{}", table.join("\n"));
    let readme = std::fs::read_to_string("README.md").unwrap();
    let written: Vec<&str> = readme.lines().filter(|line| line.starts_with(MARKER)).collect();
    // All others stand in `tests/ACCURACY.md`.
    assert!(written.len() <= 12, "{} lines", written.len());
    assert_eq!(written, table, "the table of README.md is out of date; it should read as printed above");
}
