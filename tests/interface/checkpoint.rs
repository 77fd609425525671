//! A run that is killed goes on when it is called again, and gives the results of one that nobody killed.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use tempfile::tempdir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::desk::desk;

/// A slant crack that takes seconds, its window moving several times.
const CASE: &str = r#"
[specimen]
kind = "plate"
width_mm = 70.0
length_mm = 100.0
thickness_mm = 2.0
cracks = [{ from_mm = [-9.0, -5.0], to_mm = [9.0, 5.0] }]
[material]
youngs_modulus_gpa = 72.0
poisson_ratio = 0.3
plane = "stress"
[loading]
stress_max_mpa = 70.0
stress_ratio = 0.1
[model]
spacing_mm = 0.6
[fatigue]
a = 6450.0
p = 2.86
horizon_mm = 3.015
driver = "bond_strain"
"#;

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
    let begun = Instant::now();
    while state() == before {
        assert!(run.try_wait().unwrap().is_none(), "the run ended before it was killed");
        assert!(begun.elapsed() < Duration::from_secs(120), "no checkpoint");
        std::thread::sleep(Duration::from_millis(1));
    }
    run.kill().unwrap();
    assert!(!run.wait().unwrap().success(), "the run ended before it was killed");
}

#[test]
fn a_killed_run_goes_on_to_the_same_curve() {
    let dir = tempdir().unwrap();
    let folder = dir.path();
    fs::write(folder.join("case.toml"), CASE).unwrap();
    let whole = perilife(folder, &["predict", "case.toml", "--out", "whole"]);
    assert!(whole.status.success(), "{}", texts(&whole).1);

    let call = [&["predict", "case.toml", "--out", "run"], &KEEP[..]].concat();
    kill_midway(folder, &call);
    kill_midway(folder, &call);
    assert!(!folder.join("run").exists(), "no results of a run that was killed");
    let kept = fs::read(folder.join("run.ckpt")).unwrap();

    // Not for this case, or not whole: refused, and left as it is.
    let other = [&call[..], &["--set", "loading.stress_max_mpa=71"]].concat();
    assert_refused(&perilife(folder, &other), 2, &["run.ckpt: is for a different case", "remove it"]);
    assert_eq!(fs::read(folder.join("run.ckpt")).unwrap(), kept);
    let mut damaged = kept.clone();
    damaged[kept.len() / 2] ^= 1;
    let broken: [(&[u8], &str); 4] = [
        (&damaged, "run.ckpt: is damaged"),
        (&kept[..kept.len() - 1], "run.ckpt: is damaged"),
        (b"", "run.ckpt: is not a checkpoint of this program"),
        (b"cycles,crack_length_mm\n", "run.ckpt: is not a checkpoint of this program"),
    ];
    for (bytes, words) in broken {
        fs::write(folder.join("run.ckpt"), bytes).unwrap();
        assert_refused(&perilife(folder, &call), 2, &[words, "remove it"]);
        assert_eq!(fs::read(folder.join("run.ckpt")).unwrap(), bytes, "what is refused is left");
    }

    fs::write(folder.join("run.ckpt"), &kept).unwrap();
    let rest = perilife(folder, &call);
    let (_, stderr) = texts(&rest);
    assert!(rest.status.success(), "{stderr}");
    assert!(stderr.contains("case: resuming from run.ckpt: N = "), "{stderr}");
    for file in ["a_n.csv", "crack_path.csv", "plate.svg"] {
        let [run, whole] = ["run", "whole"].map(|out| fs::read(folder.join(out).join(file)).unwrap());
        assert!(run == whole, "{file} differs");
    }
    assert!(!folder.join("run.ckpt").exists(), "it goes when the run is done");
}

/// The plate torn in time on finer points and for longer: some hundred steps, taken down in every one.
fn torn() -> String {
    let finer =
        [("spacing_mm = 1", "spacing_mm = 0.5"), ("[-10, 0], to_mm = [0, 0]", "[-10, 0.3], to_mm = [0, 0.3]"), ("2e-5", "3e-5")];
    finer.into_iter().fold(crate::interface::fracture::SCENE.to_owned(), |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replacen(old, new, 1)
    })
}

#[test]
fn a_killed_scene_goes_on_to_the_same_files() {
    let dir = tempdir().unwrap();
    let folder = dir.path();
    fs::write(folder.join("torn.toml"), torn()).unwrap();
    let whole = perilife(folder, &["fracture", "torn.toml", "--out", "whole"]);
    assert!(whole.status.success(), "{}", texts(&whole).1);

    let call = [&["fracture", "torn.toml", "--out", "run"], &KEEP[..]].concat();
    kill_midway(folder, &call);
    kill_midway(folder, &call);
    assert!(!folder.join("run").exists(), "no results of a run that was killed");
    let kept = fs::read(folder.join("run.ckpt")).unwrap();
    let mut damaged = kept.clone();
    damaged[kept.len() / 2] ^= 1;
    let mut older = kept.clone();
    let at = older.windows(5).position(|window| window == env!("CARGO_PKG_VERSION").as_bytes()).unwrap();
    older[at] = b'9';
    let refused: [(&[u8], &str, &str); 5] = [
        (&kept, "loading.velocity_mm_s=5001", "run.ckpt: is of another scene"),
        (&damaged, "loading.velocity_mm_s=5000", "run.ckpt: is damaged"),
        (&kept[..kept.len() - 1], "loading.velocity_mm_s=5000", "run.ckpt: is damaged"),
        (&older, "loading.velocity_mm_s=5000", "; this is "),
        (b"perilife checkpoint\n", "loading.velocity_mm_s=5000", "run.ckpt: is not a checkpoint of a scene of this program"),
    ];
    for (bytes, set, words) in refused {
        fs::write(folder.join("run.ckpt"), bytes).unwrap();
        assert_refused(&perilife(folder, &[&call[..], &["--set", set]].concat()), 2, &[words, "remove it"]);
        assert_eq!(fs::read(folder.join("run.ckpt")).unwrap(), bytes, "what is refused is left");
    }

    fs::write(folder.join("run.ckpt"), &kept).unwrap();
    let rest = perilife(folder, &[&["fracture", "torn.toml", "--out", "run"], &KEEP[..2]].concat());
    let (_, stderr) = texts(&rest);
    assert!(rest.status.success(), "{stderr}");
    assert!(stderr.contains("torn: resuming from run.ckpt: step "), "{stderr}");
    for file in ["history.csv", "crack_path.csv", "damage.svg"] {
        let [run, whole] = ["run", "whole"].map(|out| fs::read(folder.join(out).join(file)).unwrap());
        assert!(run == whole, "{file} differs");
    }
    assert!(!folder.join("run.ckpt").exists(), "it goes when the run is done");
}

#[test]
fn places_and_times_for_a_checkpoint_are_checked_first() {
    for (command, input) in [("predict", CASE), ("fracture", crate::interface::fracture::SCENE)] {
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
