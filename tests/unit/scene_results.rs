//! Results of a scene that ended badly: what was found so far is kept, nothing is written as NaN.

use std::fs;
use std::path::Path;

use perilife::commands::console::Console;
use perilife_growth::predict::Silent;
use perilife_results::output::{OutputFolder, RunKind};
use perilife_runner::{Task, of_scene};
use perilife_scenes::outcome::HistoryRow;
use perilife_scenes::{Scene, SceneEnd, run};

use crate::support::desk::json;

const TEXT: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 20\nlength_mm = 20\nthickness_mm = 1\n[material]\nyoungs_modulus_gpa = 65\n\
    poisson_ratio = 0.2\ndensity_kg_m3 = 2235\n[model]\nspacing_mm = 2\n[loading]\nkind = \"velocity\"\nvelocity_mm_s = 1\nedges = [\"top\", \"bottom\"]\n\
    duration_s = 5e-6\n[output]\nparaview = true\n";

#[test]
fn histories_of_a_bad_end_are_kept() {
    let scene = Scene::from_toml(TEXT, "bad", Path::new(""), &[]).unwrap();
    let good = run(&scene, &Silent).unwrap();
    let rows = good.history.len();
    for end in [SceneEnd::NoConvergence, SceneEnd::Unstable] {
        let mut fracture = good.clone();
        fracture.end = end;
        // What a blown-up motion leaves: a last row and a last state without numbers.
        fracture.history.push(HistoryRow { step: 999, kinetic: f64::NAN, load: f64::INFINITY, ..HistoryRow::default() });
        fracture.snapshots.last_mut().unwrap().displacement[0] = [f64::NAN, f64::INFINITY];
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().join("run");
        let folder = OutputFolder::create(&out, RunKind::Fracture).unwrap();
        let quiet = Console { quiet: true, ..Console::default() };
        let task = Task::Scene(Box::new(scene.clone()));
        let files = |path: &Path| {
            let summary = of_scene(&scene, fracture, &quiet);
            summary.write(&task, path)?;
            Ok(summary)
        };
        let summary = quiet.keep(folder, &[], files).unwrap();
        let error = summary.counted().unwrap_err();
        assert_eq!(error.exit_code(), 3);
        assert!(error.to_string().contains(end.name()) && error.to_string().contains("so far are written"), "{error}");
        let history = fs::read_to_string(out.join("history.csv")).unwrap();
        assert_eq!(history.lines().count(), rows + 1, "the row without numbers is left out");
        let result = json(out.join("result.json"));
        assert_eq!((&result["stop_reason"], &result["converged"]), (&end.name().into(), &false.into()));
        assert!(result["peak_load_n"].is_number());
        let files = fs::read_dir(out.join("paraview")).unwrap().count();
        assert_eq!(files, good.snapshots.len(), "one file less, and run.pvd");
        for file in ["history.csv", "crack_path.csv", "result.json", "energies.svg"] {
            let text = fs::read_to_string(out.join(file)).unwrap();
            assert!(!text.contains("NaN") && !text.contains("inf,") && !text.contains("null,null"), "{file}");
        }
    }
}
