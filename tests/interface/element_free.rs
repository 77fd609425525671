//! The element-free Galerkin method as users meet it: files of a run, keys that do not go together, `sif`, `check`.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use crate::cli::{perilife, texts};

const CASE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 100\nthickness_mm = 2\n\
                    cracks = [{ from_mm = [-7, -5], to_mm = [7, 5] }]\n\
                    [material]\nyoungs_modulus_gpa = 71\npoisson_ratio = 0.33\nplane = \"stress\"\n\
                    [loading]\nstress_max_mpa = 60\nstress_ratio = 0.1\n\
                    [model]\nmethod = \"element_free_galerkin\"\n\
                    [fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3\n[stop]\ncrack_length_mm = 30\n";

#[test]
fn a_run_on_nodes_has_its_files() {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("case.toml"), CASE).unwrap();
    let output = perilife(dir.path(), &["predict", "case.toml", "--out", "run"]);
    let (stdout, stderr) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{stdout}{stderr}");
    assert!(stdout.contains("nodes"), "{stdout}");
    for file in ["a_n.csv", "crack_path.csv", "a_n.svg", "nodes.svg", "von_mises.png", "paraview/run.pvd"] {
        assert!(dir.path().join("run").join(file).is_file(), "{file}");
    }
    let result: Value = serde_json::from_str(&fs::read_to_string(dir.path().join("run/result.json")).unwrap()).unwrap();
    assert_eq!(result["model"]["method"], "element_free_galerkin", "{result}");
    assert_eq!(result["stop_reason"], "crack_length_reached");
    let checked = perilife(dir.path(), &["check", "case.toml"]);
    let (stdout, stderr) = texts(&checked);
    assert!(stdout.contains("unknowns") && stderr.is_empty(), "{stdout}{stderr}");
    let sif = perilife(dir.path(), &["sif", "case.toml", "--method", "element_free_galerkin"]);
    assert!(texts(&sif).0.contains("element_free_galerkin"), "{:?}", texts(&sif));
}

#[test]
fn keys_that_do_not_go_together_are_refused_by_name() {
    for (key, words) in [
        ("model.bond_law=two_parameter", "model.bond_law"),
        ("model.horizon_ratio=4", "model.horizon_ratio"),
        ("model.solver=direct", "model.solver"),
        ("fatigue.driver=bond_strain", "fatigue.driver"),
        ("fatigue.ageing=everywhere", "fatigue.ageing"),
        ("model.influence_radius=1.2", "model.influence_radius"),
        ("model.influence_radius=7", "model.influence_radius"),
        ("model.nodes=10", "model.nodes"),
        ("model.spacing_mm=40", "model.spacing_mm"),
        ("model.tolerance_percent=0.01", "model.tolerance_percent"),
        ("model.enrichment=strong", "model.enrichment"),
        ("model.basis=cubic", "model.basis"),
    ] {
        let dir = tempdir().unwrap();
        fs::write(dir.path().join("case.toml"), CASE).unwrap();
        let output = perilife(dir.path(), &["predict", "case.toml", "--set", key, "--out", "run"]);
        let (_, stderr) = texts(&output);
        assert_eq!(output.status.code(), Some(2), "{key}: {stderr}");
        assert!(stderr.contains(words), "{key}: {stderr}");
        assert!(!dir.path().join("run").exists(), "{key}");
    }
    // Keys of nodes with another method.
    for key in ["model.nodes=500", "model.enrichment=tip", "model.influence_radius=2.5"] {
        let dir = tempdir().unwrap();
        fs::write(dir.path().join("case.toml"), CASE).unwrap();
        let output =
            perilife(dir.path(), &["predict", "case.toml", "--set", "model.method=peridynamics", "--set", key, "--out", "run"]);
        let (_, stderr) = texts(&output);
        assert_eq!(output.status.code(), Some(2), "{key}: {stderr}");
        assert!(stderr.contains("element_free_galerkin"), "{key}: {stderr}");
    }
}

#[test]
fn too_few_nodes_for_a_basis_are_named() {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("case.toml"), CASE).unwrap();
    let set = ["model.basis=quadratic", "model.enrichment=none", "model.influence_radius=1.5"];
    let output =
        perilife(dir.path(), &["predict", "case.toml", "--set", set[0], "--set", set[1], "--set", set[2], "--out", "run"]);
    let (_, stderr) = texts(&output);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("too few nodes") && stderr.contains("model.influence_radius"), "{stderr}");
}
