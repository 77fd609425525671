//! Killed runs that go on, and runs whose time is over.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use tempfile::tempdir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::interface::fracture;
use crate::support::daily::{PANEL, SCENE, names, write_inputs};
use crate::support::desk::{desk, done};
use crate::support::server::wait;

// A run that is killed goes on when it is called again, and gives the results of one that nobody killed.

/// A slant crack that takes seconds, its window moving several times.
const CASE: &str = include_str!("../reference/cases/checkpoint.toml");

const KEEP: [&str; 4] = ["--checkpoint", "run.ckpt", "--checkpoint-every", "0"];

/// Starts a run that keeps its state in `run.ckpt` and kills it as soon as that is another than before.
fn kill_midway(folder: &Path, call: &[&str]) {
    let file = folder.join("run.ckpt");
    let state = || fs::read(&file).ok();
    let before = state();
    let mut run = Command::new(cargo_bin("perilife"))
        .current_dir(folder)
        .args(call)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    wait("no checkpoint", || state() != before || run.try_wait().unwrap().is_some());
    run.kill().unwrap();
    assert!(!run.wait().unwrap().success(), "the run ended before it was killed");
}

/// A killed run of this command goes on to the same files; a checkpoint that is not whole, or not of this input, is refused and left.
fn a_killed_run_goes_on(command: &str, text: &str, other: &str, files: [&str; 3], words: [&str; 3]) {
    let dir = desk(&[("case.toml", &text)]);
    let folder = dir.path();
    done(folder, &format!("{command} case.toml --out whole"));
    let call = [&[command, "case.toml", "--out", "run"], &KEEP[..]].concat();
    kill_midway(folder, &call);
    kill_midway(folder, &call);
    assert!(!folder.join("run").exists(), "no results of a run that was killed");
    let checkpoint = folder.join("run.ckpt");
    let kept = fs::read(&checkpoint).unwrap();
    let (mut damaged, mut older) = (kept.clone(), kept.clone());
    damaged[kept.len() / 2] ^= 1;
    let version = env!("CARGO_PKG_VERSION").as_bytes();
    let at = older.windows(version.len()).position(|window| window == version).unwrap();
    older[at] = b'9';
    let [of_another, no_checkpoint, resuming] = words;
    // A scene takes no checkpoint of a run.
    let strange: &[u8] = if command == "predict" { b"cycles,crack_length_mm\n" } else { b"perilife checkpoint\n" };
    let refused: [(&[u8], &[&str], &str); 6] = [
        (&kept, &["--set", other], of_another),
        (&damaged, &[], "is damaged"),
        (&kept[..kept.len() - 1], &[], "is damaged"),
        (&older, &[], "; this is "),
        (b"", &[], no_checkpoint),
        (strange, &[], no_checkpoint),
    ];
    for (bytes, set, words) in refused {
        fs::write(&checkpoint, bytes).unwrap();
        assert_refused(&perilife(folder, &[&call[..], set].concat()), 2, &["run.ckpt: ", words, "remove it"]);
        assert_eq!(fs::read(&checkpoint).unwrap(), bytes, "what is refused is left");
    }
    fs::write(&checkpoint, &kept).unwrap();
    let (_, stderr) = done(folder, &call);
    assert!(stderr.contains(&format!("case: resuming from run.ckpt: {resuming} ")), "{stderr}");
    for file in files {
        let [run, whole] = ["run", "whole"].map(|out| fs::read(folder.join(out).join(file)).unwrap());
        assert!(run == whole, "{file} differs");
    }
    assert!(!checkpoint.exists(), "it goes when the run is done");
}

#[test]
fn a_killed_run_goes_on_to_the_same_curve() {
    let words = ["is for a different case", "is not a checkpoint of this program", "N ="];
    a_killed_run_goes_on("predict", CASE, "loading.stress_max_mpa=71", ["a_n.csv", "crack_path.csv", "plate.svg"], words);
}

/// The plate torn in time on finer points and for longer: some hundred steps, taken down in every one.
#[test]
fn a_killed_scene_goes_on_to_the_same_files() {
    let finer =
        [("spacing_mm = 1", "spacing_mm = 0.5"), ("[-10, 0], to_mm = [0, 0]", "[-10, 0.3], to_mm = [0, 0.3]"), ("2e-5", "3e-5")];
    let torn = finer.into_iter().fold(fracture::SCENE.to_owned(), |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replacen(old, new, 1)
    });
    let words = ["is of another scene", "is not a checkpoint of a scene of this program", "step"];
    a_killed_run_goes_on("fracture", &torn, "loading.velocity_mm_s=5001", ["history.csv", "crack_path.csv", "damage.svg"], words);
}

#[test]
fn places_and_times_for_a_checkpoint_are_checked_first() {
    for (command, input) in [("predict", CASE), ("fracture", fracture::SCENE)] {
        let dir = desk(&[("case.toml", &input)]);
        fs::create_dir(dir.path().join("folder")).unwrap();
        let call = |more: &[&str]| perilife(dir.path(), &[&[command, "case.toml", "--out", "run"], more].concat());
        assert_refused(&call(&["--checkpoint", "folder"]), 4, &["folder: cannot read"]);
        assert_refused(&call(&["--checkpoint", "no/run.ckpt"]), 4, &["no/run.ckpt: cannot write"]);
        for time in ["-1", "nan", "soon"] {
            let output = call(&["--checkpoint", "run.ckpt", &format!("--checkpoint-every={time}")]);
            assert_eq!(output.status.code(), Some(2), "{command}, {time}");
            assert!(texts(&output).1.contains("is not a time in seconds"), "{}", texts(&output).1);
        }
        assert_eq!(call(&["--checkpoint-every", "1"]).status.code(), Some(2), "{command}");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2, "{command}: nothing new stands there");
    }
}

// `--time-limit` counts from the first point of the plate on.

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
        let output = perilife(here, &format!("{command} {input} --out out -q --time-limit {limit}"));
        let words = format!("stopped at the time limit of {limit} s; increase --time-limit, or use --checkpoint FILE");
        assert_refused(&output, 3, &[&words]);
        assert!(begun.elapsed() < Duration::from_secs(30), "{command}: {:?}", begun.elapsed());
        assert_eq!(names(here), before);
    }
    // With a checkpoint the same command goes on, as often as it takes, to the same histories.
    let keep = ["--checkpoint", "run.ckpt", "--checkpoint-every", "0"];
    let shorter = ["--set", "loading.duration_s=1e-4"];
    done(here, &[&["fracture", "long.toml", "--out", "whole", "-q"], &shorter[..]].concat());
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
