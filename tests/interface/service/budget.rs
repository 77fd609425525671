//! What a case would take up is counted before anything of it is laid out.

use std::time::Instant;

use super::{QUICK, of};
use crate::support::server::Server;

#[test]
fn cases_that_are_too_large_are_refused_at_once() {
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    let plate = |specimen: &str, model: &str| {
        let [start, end] = [QUICK.find("[material]").unwrap(), QUICK.find("[model]").unwrap()];
        let loading = QUICK[start..end].replace("stress_range_mpa = 60", "stress_max_mpa = 60");
        let fatigue = QUICK[QUICK.find("[fatigue]").unwrap()..].split("[stop]").next().unwrap();
        format!("[specimen]\nkind = \"plate\"\nthickness_mm = 2\n{specimen}\n{loading}{model}\n{fatigue}")
    };
    let arms = "outline_mm = [[0,0],[7000,0],[7000,4],[3502,4],[3502,6996],[7000,6996],[7000,7000],[0,7000],[0,6996],[3498,6996],[3498,4],[0,4]]\n\
                cracks = [{ from_mm = [3498, 3500], to_mm = [3499, 3500] }]";
    let wide = "width_mm = 1000\nlength_mm = 1000\ncracks = [{ from_mm = [-40, 0], to_mm = [40, 0] }]";
    let small = "width_mm = 60\nlength_mm = 60\ncracks = [{ from_mm = [-9, -2], to_mm = [9, 2] }]";
    let cases = [
        (plate(arms, "[model]\nspacing_mm = 0.5"), "lattice positions"),
        (plate(wide, "[model]\nspacing_mm = 0.6"), "points; limit 1.000e6"),
        (plate(small, "[model]\nspacing_mm = 0.1\nhorizon_ratio = 12.0"), "GB of memory; limit 4.29 GB"),
    ];
    for (text, words) in &cases {
        for path in ["/v1/check", "/v1/predictions"] {
            let started = Instant::now();
            let problem = service.post(path, &of("large", text)).expect(422).json();
            let detail = problem["detail"].as_str().unwrap();
            println!("{path}: {:.2} s: {detail}", started.elapsed().as_secs_f64());
            assert!(detail.contains(words) && detail.contains("model.spacing_mm = "), "{words} in {detail}");
            assert!(started.elapsed().as_secs_f64() < 3.0);
        }
    }
}

/// A sweep is checked as one; it was taken for a case without sections.
#[test]
fn sweeps_are_checked_as_such() {
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    let grid = "case = \"base.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"loading.stress_range_mpa\"\nfrom = 40\nto = 60\ncount = 5\n";
    let mut sweep = of("few", grid);
    sweep["files"] = serde_json::json!({ "base.toml": QUICK });
    let answer = service.post("/v1/check", &sweep).expect(200).text();
    assert!(answer.contains("\"computing\"") && answer.contains("5 cases of base, grid"), "{answer}");
}
