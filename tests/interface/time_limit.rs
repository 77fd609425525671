//! `--time-limit` counts from the first point of the plate on.

use std::fs;
use std::time::{Duration, Instant};

use tempfile::tempdir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::daily::{PANEL, SCENE, names, write_inputs};

#[test]
fn a_run_ends_when_its_time_is_over() {
    let dir = tempdir().unwrap();
    let here = dir.path();
    write_inputs(here);
    let (plate, _) = PANEL.split_once("[model]").unwrap();
    let law = "[fatigue]\nparis_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874\n[stop]\ncrack_length_mm = 49.8\n";
    fs::write(here.join("large.toml"), format!("{plate}[model]\nspacing_mm = 0.11\n{law}")).unwrap();
    let motion = SCENE.replace("traction", "velocity").replace("stress_mpa = 10.0", "velocity_mm_s = 1000.0\nduration_s = 1e-2");
    fs::write(here.join("long.toml"), motion.replace("[model]", "density_kg_m3 = 8000.0\n[model]")).unwrap();
    let before = names(here);
    // Nearly four million points: it ends while the plate is being built. A motion ends between two steps.
    for (command, input, limit) in [("predict", "large.toml", "0.5"), ("fracture", "long.toml", "1")] {
        let begun = Instant::now();
        let output = perilife(here, &[command, input, "--out", "out", "-q", "--time-limit", limit]);
        let words = format!("stopped at the time limit of {limit} s; increase --time-limit, or use --checkpoint FILE");
        assert_refused(&output, 3, &[&words]);
        assert!(begun.elapsed() < Duration::from_secs(30), "{command}: {:?}", begun.elapsed());
        assert_eq!(names(here), before);
    }
    // With a checkpoint the same command goes on, as often as it takes, to the same histories.
    let keep = ["--checkpoint", "run.ckpt", "--checkpoint-every", "0"];
    let shorter = ["--set", "loading.duration_s=1e-4"];
    let whole = perilife(here, &[&["fracture", "long.toml", "--out", "whole", "-q"], &shorter[..]].concat());
    assert!(whole.status.success(), "{}", texts(&whole).1);
    let mut calls = 0;
    loop {
        let output = perilife(
            here,
            &[&["fracture", "long.toml", "--out", "out", "-q", "--time-limit", "0.4"], &keep[..], &shorter].concat(),
        );
        calls += 1;
        if output.status.success() {
            break;
        }
        let stderr = texts(&output).1;
        assert!(output.status.code() == Some(3) && stderr.contains("the same command "), "{stderr}");
        assert!(calls < 200, "it does not get on");
    }
    println!("{calls} calls");
    let [whole, out] = ["whole", "out"].map(|out| fs::read(here.join(out).join("history.csv")).unwrap());
    assert!(whole == out && !here.join("run.ckpt").exists());
}
