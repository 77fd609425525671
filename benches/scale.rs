//! Set-up and first solve of a cracked plate against its number of points: `cargo bench --profile dev --bench scale`.
//!
//! For both numbers of unknowns: CPU seconds of the body, of the solver's set-up, of the solve; iterations; peak memory per
//! point; and the exponent of CPU time over points. The whole plate is solved, without use of its symmetry. Further arguments choose other numbers of points.

use std::fs;

use perilife_growth::case::Case;
use perilife_points::solver::{Equilibrium, SolverKind, Symmetry};
use perilife_points::state::Bonds;

const POINTS: [f64; 4] = [30e3, 120e3, 480e3, 1e6];

fn main() {
    let given: Vec<f64> = std::env::args().filter_map(|text| text.parse().ok()).collect();
    let sizes = if given.is_empty() { POINTS.to_vec() } else { given };
    println!(
        "{:>14} {:>8} {:>8} {:>8} {:>8} {:>8} {:>6} {:>9} {:>9}",
        "law", "points", "body_s", "set_up_s", "solve_s", "all_s", "iter", "bytes/pt", "exponent"
    );
    for law in ["bond_based", "two_parameter"] {
        let mut last: Option<(f64, f64)> = None;
        for &points in &sizes {
            let case = case(law, points);
            let start = Reading::now();
            let body = case.points().body(&case.specimen, &case.material).expect("a plain plate");
            let bonds = Bonds::new(&body);
            let built = Reading::now();
            let mut equilibrium = Equilibrium::new(SolverKind::Multigrid, Symmetry::Off, &body, &bonds, case.loading.maximum);
            let ready = Reading::now();
            let mut displacement = Vec::new();
            let iterations = equilibrium.solve(&body, &bonds, &mut displacement).expect("a solve that converges");
            let end = Reading::now();
            let (count, all) = (body.points.len() as f64, end.cpu_s - start.cpu_s);
            let exponent = last.map(|(n, t)| (all / t).ln() / (count / n).ln());
            println!(
                "{law:>14} {count:>8} {:>8.3} {:>8.3} {:>8.3} {all:>8.3} {iterations:>6} {:>9.0} {:>9}",
                built.cpu_s - start.cpu_s,
                ready.cpu_s - built.cpu_s,
                end.cpu_s - ready.cpu_s,
                (end.peak_bytes - start.now_bytes) / count,
                exponent.map_or(String::new(), |e| format!("{e:.2}"))
            );
            last = Some((count, all));
            // The next size counts its own peak.
            let _ = fs::write("/proc/self/clear_refs", "5");
        }
    }
}

/// A middle-tension plate twice as long as wide, with about this many points.
fn case(law: &str, points: f64) -> Case {
    let width = (points / 2.0).sqrt().round();
    let nu = if law == "bond_based" { 1.0 / 3.0 } else { 0.3 };
    let text = format!(
        "[specimen]\nkind=\"middle_tension\"\nwidth_mm={width}\nlength_mm={}\nthickness_mm=2\ncrack_length_mm={}\n\
         [material]\nyoungs_modulus_gpa=72\npoisson_ratio={nu}\nplane=\"stress\"\n[loading]\nstress_max_mpa=70\nstress_ratio=0.1\n\
         [model]\nbond_law=\"{law}\"\nspacing_mm=1\n[fatigue]\na=1e4\np=3\nhorizon_mm=3.015\n",
        2.0 * width,
        width / 5.0
    );
    Case::from_toml(&text, "bench", std::path::Path::new("."), &[]).expect("a case as its documentation says")
}

/// CPU time of all threads and memory, as Linux tells them; zeros elsewhere.
struct Reading {
    cpu_s: f64,
    now_bytes: f64,
    peak_bytes: f64,
}

impl Reading {
    fn now() -> Self {
        let threads = fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
        let spent = |path: std::path::PathBuf| -> Option<f64> {
            fs::read_to_string(path.join("schedstat")).ok()?.split(' ').next()?.parse().ok()
        };
        let cpu_s = threads.filter_map(|thread| spent(thread.path())).sum::<f64>() * 1e-9;
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let kib = |key: &str| -> f64 {
            let line = status.lines().find_map(|line| line.strip_prefix(key));
            line.and_then(|rest| rest.trim_matches([':', '\t', ' ', 'k', 'B']).parse().ok()).unwrap_or(0.0)
        };
        Reading { cpu_s, now_bytes: 1024.0 * kib("VmRSS"), peak_bytes: 1024.0 * kib("VmHWM") }
    }
}
