//! Time and error of the remeshing finite elements of `tests/reference` beside this program, on the same machine in the same call.

use std::process::Command;
use std::time::Instant;

use perilife_growth::predict::Silent;
use perilife_study::chart::scenes;
use serde_json::Value;

/// Plates of the reference, and their scenes in the chart.
const PLATES: [(&str, &str); 2] = [("slant_severance", "slant_severance"), ("hole_attracts", "hole_entered")];

#[test]
#[ignore = "long: five minutes, needs Python with tests/reference/requirements.txt: PERILIFE_PYTHON=python cargo test rivals -- --ignored --nocapture"]
fn finite_elements_take_longer_for_the_same_error() {
    let python = std::env::var("PERILIFE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/rival.py");
    println!("{:<18} {:<28} {:>10} {:>12} {:>9} {:>9}", "plate", "method", "increments", "ms each", "wall s", "error %");
    for (plate, name) in PLATES {
        let output = Command::new(&python).args([script, plate]).output().expect("Python starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let runs: Vec<Value> =
            String::from_utf8_lossy(&output.stdout).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(runs.len(), 3, "a run a coarseness");
        let line = |method: &str, increments: f64, wall: f64, error: f64| {
            println!("{plate:<18} {method:<28} {increments:>10} {:>12.1} {wall:>9.2} {error:>9.2}", 1e3 * wall / increments);
        };
        for run in &runs {
            let [coarse, increments, wall, error] =
                ["coarseness", "increments", "wall_s", "error_percent"].map(|key| run[key].as_f64().unwrap());
            line(&format!("finite elements, × {coarse}"), increments, wall, error);
        }
        // The finest repeats the table of the reference.
        assert!(runs[0]["error_percent"].as_f64().unwrap().abs() < 0.01, "{}", runs[0]);
        let scene = scenes(&[name.to_owned()]).unwrap()[0];
        for (method, set) in [("points", vec![]), ("nodes", vec!["model.method=element_free_galerkin".to_owned()])] {
            let started = Instant::now();
            let found = scene.found(&set, &Silent).unwrap();
            let error = found.error_percent.abs();
            line(method, found.solves as f64, started.elapsed().as_secs_f64(), error);
            // The coarsest mesh errs by some percent.
            assert!(error < runs[2]["error_percent"].as_f64().unwrap().abs(), "{plate}, {method}");
        }
    }
}
