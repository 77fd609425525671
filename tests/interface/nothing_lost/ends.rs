//! Work that was paid for is kept: places tried before the run, asked again at the end; signals fold up; two never write one place.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use tempfile::TempDir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::daily::{self, KINDS, PANEL, content, names};
use crate::support::desk::done;
use crate::support::rows::assert_says;
use crate::support::server::wait;

/// A run of some seconds.
const SLOW: [&str; 2] = ["predict", "slow.toml"];

fn inputs() -> TempDir {
    let dir = daily::inputs();
    let (plate, _) = PANEL.split_once("[model]").unwrap();
    let law = "[model]\nspacing_mm = 0.8\n[fatigue]\ndriver = \"bond_strain\"\na = 6450.0\np = 2.86\nhorizon_mm = 3.015\n";
    fs::write(dir.path().join("slow.toml"), format!("{plate}{law}[stop]\ncrack_length_mm = 49.8\n")).unwrap();
    fs::write(dir.path().join("slow_sweep.toml"), daily::SWEEP.replace("panel.toml", "slow.toml")).unwrap();
    let scene = daily::SCENE.replace("spacing_mm = 1.0", "spacing_mm = 0.1");
    let motion = scene.replace("traction", "velocity").replace("stress_mpa = 10.0", "velocity_mm_s = 1000.0\nduration_s = 1e-3");
    let motion = motion.replace("[model]", "density_kg_m3 = 8000.0\n[model]");
    fs::write(dir.path().join("slow_scene.toml"), motion).unwrap();
    dir
}

/// Starts the program and waits until it has begun to make `out`.
fn started(folder: &Path, arguments: &[&str]) -> Child {
    let process = Command::new(cargo_bin("perilife"))
        .current_dir(folder)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A sweep is at work when one of its cases is: its own folder comes before it says what it leaves.
    let is_sweep = arguments[0] == "sweep";
    let is_begun = || {
        let sweeps = folder.join("out/cases");
        !is_sweep && names(folder).iter().any(|name| name.starts_with(".out.partial"))
            || sweeps.is_dir() && names(&sweeps).iter().any(|name| name.contains(".partial"))
    };
    wait("nothing is begun", is_begun);
    process
}

fn ended(process: Child) -> (Option<i32>, String) {
    let output = process.wait_with_output().unwrap();
    (output.status.code(), texts(&output).1)
}

fn send(process: &Child, signal: &str) {
    assert!(Command::new("kill").args([&format!("-{signal}"), &process.id().to_string()]).status().unwrap().success());
}

/// What appears in the folder while a run goes on stays, and its results have a name that is said: in a new folder, in that of an
/// earlier run, and where a run of another kind has come.
#[test]
fn what_appears_meanwhile_stays() {
    let dir = inputs();
    let here = dir.path();
    type Appear = fn(&Path);
    let cases: [(bool, Appear); 3] = [
        (false, |out| {
            fs::create_dir(out).unwrap();
            fs::write(out.join("notes.txt"), "meanwhile").unwrap();
        }),
        (true, |out| fs::write(out.join("notes.txt"), "meanwhile").unwrap()),
        (true, |out| fs::write(out.join(".perilife"), "kind = \"sweep\"\nfiles = []\n").unwrap()),
    ];
    for (number, (is_earlier, appear)) in cases.into_iter().enumerate() {
        if is_earlier {
            done(here, "predict panel.toml --out out -q");
        }
        let process = started(here, &["predict", "small.toml", "--out", "out", "-q", "--force", "--set", "model.spacing_mm=0.5"]);
        appear(&here.join("out"));
        let before = content(&here.join("out"));
        let (code, stderr) = ended(process);
        assert_eq!(code, Some(4), "{stderr}");
        assert_says(&stderr, &["out: cannot put the results in place: it contains", "and that stays"]);
        let result = if number == 0 { "out.result".to_owned() } else { format!("out.result-{}", number + 1) };
        assert!(stderr.trim_end().ends_with(&format!("; results are in {result}")), "{stderr}");
        assert!(here.join(&result).join("a_n.csv").is_file() && content(&here.join("out")) == before);
        fs::remove_dir_all(here.join("out")).unwrap();
    }
}

/// Two that write one folder: the second is refused at once, whatever it is.
#[test]
fn the_second_writer_is_refused() {
    let dir = inputs();
    let here = dir.path();
    let first: [&[&str]; 3] = [&SLOW, &["sweep", "slow_sweep.toml"], &["fracture", "slow_scene.toml"]];
    for call in first {
        let process = started(here, &[call, &["--out", "out", "-q"]].concat());
        let holder = format!("process {} on ", process.id());
        for (second, _) in KINDS.iter().filter(|(second, _)| second[0] == call[0] || call[0] != "sweep") {
            let output = perilife(here, &[second, &["--out", "out", "-q"][..]].concat());
            assert_refused(&output, 2, &["--out = out", "is in use by another run", &holder, "wait for its end"]);
        }
        send(&process, "TERM");
        assert_eq!(ended(process).0, Some(143));
        let _ = fs::remove_dir_all(here.join("out"));
        assert!(names(here).iter().all(|name| !name.starts_with('.')), "{:?}", names(here));
    }
}

/// Every signal, every command that takes long: one line, the code of the signal, and nothing that was not there before.
#[test]
fn signals_fold_up() {
    let dir = inputs();
    let here = dir.path();
    let before = names(here);
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        for call in [&SLOW[..], &["fracture", "slow_scene.toml"]] {
            let process = started(here, &[call, &["--out", "out"][..]].concat());
            send(&process, signal);
            let (ended, stderr) = ended(process);
            assert_eq!(ended, Some(code), "{call:?} {signal}: {stderr}");
            let line = format!("interrupted by SIG{signal}; nothing was written; use --checkpoint FILE to resume");
            assert_eq!(stderr.lines().filter(|text| !text.starts_with("warning: ")).collect::<Vec<_>>(), [line], "{call:?}");
            assert_eq!(names(here), before);
        }
        // A sweep keeps what is finished, and says so.
        let process = started(here, &["sweep", "slow_sweep.toml", "--out", "out", "-q"]);
        send(&process, signal);
        let (ended, stderr) = ended(process);
        assert_eq!(ended, Some(code), "{stderr}");
        assert!(stderr.contains("finished cases are in out; run the same command to resume"), "{stderr}");
        assert!(names(&here.join("out/cases")).is_empty(), "{:?}", names(&here.join("out/cases")));
        fs::remove_dir_all(here.join("out")).unwrap();
    }
}

/// With a checkpoint the line says how to go on, and the same command does.
#[test]
fn a_signal_says_how_to_go_on() {
    let dir = inputs();
    let here = dir.path();
    let call = [&SLOW[..], &["--out", "out", "-q", "--checkpoint", "run.ckpt", "--checkpoint-every", "0"]].concat();
    let process = started(here, &call);
    wait("no checkpoint", || here.join("run.ckpt").is_file());
    send(&process, "INT");
    let (code, stderr) = ended(process);
    assert_eq!(code, Some(130), "{stderr}");
    assert!(stderr.trim_end().ends_with("interrupted by SIGINT; run the same command to resume from run.ckpt"), "{stderr}");
    assert!(names(here).iter().all(|name| !name.starts_with('.')), "{:?}", names(here));
    // A process that was started to ignore a signal (nohup) goes on to its end.
    let script = format!("trap '' HUP; exec {:?} {}", cargo_bin("perilife"), call.join(" "));
    let process = Command::new("sh").current_dir(here).args(["-c", &script]).stderr(Stdio::piped()).spawn().unwrap();
    wait("nothing is begun", || names(here).iter().any(|name| name.starts_with(".out.partial")));
    send(&process, "HUP");
    let (code, stderr) = ended(process);
    assert_eq!(code, Some(0), "{stderr}");
    assert!(here.join("out/a_n.csv").is_file() && !here.join("run.ckpt").exists());
}

/// What a killed process left is removed by the next start; what only looks like it stays.
#[test]
fn leftovers_of_the_dead_go() {
    let dir = inputs();
    let here = dir.path();
    for _ in 0..2 {
        let mut process = started(here, &[&SLOW[..], &["--out", "out", "-q"]].concat());
        process.kill().unwrap();
        process.wait().unwrap();
    }
    // The second start removed what the first had left; it was killed as well.
    let partial = |name: &&String| name.starts_with(".out.partial");
    assert_eq!(names(here).iter().filter(partial).count(), 1, "{:?}", names(here));
    fs::create_dir(here.join(".out.partial-of-a-user")).unwrap();
    fs::create_dir(here.join(".out.partial-1-1")).unwrap();
    fs::write(here.join(".out.partial-1-1/notes.txt"), "mine").unwrap();
    // An earlier result that was moved aside when the process died goes back.
    done(here, "predict panel.toml --out kept -q");
    fs::rename(here.join("kept"), here.join(".kept.old-1-0")).unwrap();
    fs::create_dir(here.join("kept.d")).unwrap();
    done(here, "predict panel.toml --out out -q");
    fs::write(here.join(".kept.old-1-0/notes.txt"), "mine").unwrap();
    let output = perilife(here, "predict panel.toml --out kept -q");
    assert!(output.status.success() || texts(&output).1.contains("notes.txt"), "{}", texts(&output).1);
    assert_eq!(fs::read_to_string(here.join("kept/notes.txt")).unwrap(), "mine");
    let hidden: Vec<String> = names(here).into_iter().filter(|name| name.starts_with('.')).collect();
    assert_eq!(hidden, [".out.partial-1-1", ".out.partial-of-a-user"]);
}

/// A mounted folder cannot be replaced, which is said before the run, and a folder below it can; a full one keeps what there is. Where
/// nothing may be mounted there is nothing to try.
#[test]
fn mounted_and_full_places() {
    let dir = inputs();
    let here = dir.path();
    let mounted = here.join("out");
    fs::create_dir(&mounted).unwrap();
    let mount = |options: &str| {
        let status =
            Command::new("mount").args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(&mounted).stderr(Stdio::null()).status();
        status.is_ok_and(|status| status.success())
    };
    let unmount = || assert!(Command::new("umount").arg(&mounted).status().unwrap().success());
    if !mount("size=64m") {
        println!("skipped: this user may mount nothing");
        return;
    }
    let begun = Instant::now();
    let refused = perilife(here, &[&SLOW[..], &["--out", "out", "-q"]].concat());
    assert_refused(&refused, 2, &["--out = out", "is a mount point", "give a folder below it"]);
    assert!(begun.elapsed() < Duration::from_secs(2), "it is said before the run");
    for _ in 0..2 {
        done(here, "predict panel.toml --out out/run -q");
    }
    assert_eq!(names(&mounted), ["run"]);
    assert!(mounted.join("run/a_n.csv").is_file());
    unmount();
    // Too small for the pictures: said before, and the tables stay. Too small for the tables: nothing is computed.
    assert!(mount("size=200k"));
    let output = perilife(here, "predict small.toml --out out/x -q --paraview --set model.spacing_mm=0.5");
    let (code, stderr) = (output.status.code(), texts(&output).1);
    assert_eq!(code, Some(4), "{stderr}");
    assert!(stderr.contains("warning: disk: out/x: ") && stderr.contains("its tables come first"), "{stderr}");
    assert!(stderr.trim_end().ends_with("partial results are in out/x.result"), "{stderr}");
    for file in ["a_n.csv", "crack_path.csv", "result.json", "case.toml"] {
        assert!(fs::metadata(mounted.join("x.result").join(file)).unwrap().len() > 0, "{file}");
    }
    unmount();
    assert!(mount("size=16k"));
    let begun = Instant::now();
    let output = perilife(here, &[&SLOW[..], &["--out", "out/x", "-q"]].concat());
    unmount();
    assert_refused(&output, 4, &["out/x: not enough disk space", "the tables of the run take about"]);
    assert!(begun.elapsed() < Duration::from_secs(2), "it is said before the run");
}
