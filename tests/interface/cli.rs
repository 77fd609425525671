//! The program as a user calls it: help, exit codes, what goes to stdout and stderr.

use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use clap::CommandFactory;
use perilife::commands::CommandLine;
use tempfile::tempdir;

use crate::support::desk::{desk, done, json};
use crate::support::rows::assert_says;
use crate::unit::warnings::assert_named;

/// Arguments of a call: one by one, or as the words of a line.
pub trait Call {
    fn words(&self) -> Vec<&str>;
}

impl Call for str {
    fn words(&self) -> Vec<&str> {
        self.split_whitespace().collect()
    }
}

impl<S: AsRef<str>> Call for [S] {
    fn words(&self) -> Vec<&str> {
        self.iter().map(AsRef::as_ref).collect()
    }
}

impl<S: AsRef<str>, const N: usize> Call for [S; N] {
    fn words(&self) -> Vec<&str> {
        self.as_slice().words()
    }
}

impl<S: AsRef<str>> Call for Vec<S> {
    fn words(&self) -> Vec<&str> {
        self.as_slice().words()
    }
}

impl Call for String {
    fn words(&self) -> Vec<&str> {
        self.as_str().words()
    }
}

/// Runs the program in `folder`; stdout and stderr are no terminals.
pub fn perilife(folder: &Path, call: &(impl Call + ?Sized)) -> Output {
    cargo_bin_cmd!("perilife").current_dir(folder).env_remove("RUST_LOG").args(call.words()).output().unwrap()
}

/// Standard output and standard error as text. Every warning has a name that the guide lists.
#[track_caller]
pub fn texts(output: &Output) -> (String, String) {
    let [stdout, stderr] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8(bytes.clone()).unwrap());
    stderr
        .lines()
        .filter_map(|line| line.strip_prefix("warning"))
        .for_each(|line| assert_named(line.trim_start_matches([':', ' '])));
    (stdout, stderr)
}

/// The process ended with `code` and, warnings apart, one message on stderr that holds all `words`, without a trace of a panic.
pub fn assert_refused(output: &Output, code: i32, words: &[impl AsRef<str>]) {
    let (stdout, stderr) = texts(output);
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    // With --json the error is an object.
    let object = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap()["error"]["code"] == code;
    assert!(stdout.is_empty() || object(&stdout), "{stdout}");
    let first = stderr.lines().find(|line| !line.starts_with("warning: "));
    assert!(first.is_some_and(|line| line.starts_with("error: ")) && !stderr.contains("panicked"), "{stderr}");
    assert_says(&stderr, words);
}

fn subcommands() -> Vec<String> {
    // One is what a worker starts, and no user.
    let shown = |command: &&clap::Command| !command.is_hide_set();
    CommandLine::command().get_subcommands().filter(shown).map(|command| command.get_name().to_owned()).collect()
}

#[test]
fn every_command_explains_itself() {
    let here = Path::new(".");
    let (help, _) = texts(&perilife(here, "--help"));
    assert!(help.contains("Exit codes: 0 success, 2 invalid input, 3 no valid result, 4 I/O error"), "{help}");
    assert!(help.contains("surface, corner and embedded cracks") && help.contains("\nAnalyze:\n  predict "), "{help}");
    assert!(!subcommands().is_empty());
    for command in CommandLine::command().get_subcommands() {
        let of_arguments = command.get_arguments().filter_map(|argument| argument.get_help());
        let long = command.get_about().into_iter().chain(of_arguments).map(|help| help.to_string());
        long.for_each(|help| assert!(help.chars().count() <= 70, "{help}"));
    }
    for name in subcommands() {
        assert!(help.contains(&format!("\n  {name} ")), "{name} in {help}");
        let (stdout, _) = done(here, &[&name, "--help"]);
        assert!(stdout.contains(&format!("Usage: perilife {name}")));
    }
}

#[test]
fn clap_finds_no_clash_of_arguments() {
    CommandLine::command().debug_assert();
}

#[test]
fn wrong_calls_end_with_two() {
    let dir = tempdir().unwrap();
    let calls: [&[&str]; 6] =
        [&[], &["bogus"], &["predict"], &["export", "x"], &["--bogus"], &["export", "x", "--out", "y.csv", "--points", "1"]];
    for call in calls {
        assert_eq!(perilife(dir.path(), call).status.code(), Some(2), "{call:?}");
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn list_names_every_key() {
    let (stdout, _) = done(Path::new("."), &["list"]);
    for name in [
        "specimen.kind middle_tension", "model.bond_law two_parameter", "fatigue.ageing crack_tip", "loading.kind platens",
        "model.bond_law correspondence", "model.discretisation dual_horizon", "model.solver velocity_verlet",
        "model.zero_energy_control silling", "model.kinematics finite", "damage.law nonlinear_two_parameter",
        "damage.enters influence", "loading.transverse held",
    ] {
        assert_eq!(stdout.lines().filter(|line| line.split_whitespace().take(2).eq(name.split(' '))).count(), 1, "{name}");
    }
    let (listed, _) = done(Path::new("."), &["list", "materials"]);
    assert!(listed.lines().count() > 30 && listed.lines().all(|line| line.starts_with("material.")), "{listed}");
    assert_refused(&perilife(Path::new("."), &["list", "cheese"]), 2, &["cheese", "perilife list"]);
}

/// A case coarse and short enough to run in a second.
pub const SMALL_CASE: &str = include_str!("../reference/cases/small.toml");

#[test]
fn a_prediction_writes_what_it_promises() {
    let dir = desk(&[("small.toml", &SMALL_CASE)]);
    let (stdout, _) = done(dir.path(), "predict small.toml --out out/run --json");
    let printed: serde_json::Value = serde_json::from_str(&stdout).expect("one JSON object and nothing else");
    let run = dir.path().join("out/run");
    let written = json(run.join("result.json"));
    assert_eq!(printed, written);
    assert_eq!(written["stop_reason"], "crack_length_reached");
    for file in ["a_n.csv", "crack_path.csv", "a_n.svg", "da_dn.svg", "plate.svg", "k.svg", "factors.csv", "beta.txt"] {
        assert!(run.join(file).is_file(), "{file}");
    }
    assert!(!run.join("paraview").exists(), "nobody asked for it");
    let table = fs::read_to_string(run.join("a_n.csv")).unwrap();
    assert_eq!(table.lines().count() as u64, 2 + written["blocks"].as_u64().unwrap(), "header, N = 0, one row a block");
    // Its own folder is replaced; the words go to stdout this time.
    let (stdout, _) = texts(&perilife(dir.path(), "predict small.toml --out out/run"));
    assert_says(&stdout, &["life", "Ends by        crack length limit", "out/run"]);
    let (stdout, _) = texts(&perilife(dir.path(), "predict small.toml --out out/run --quiet --paraview"));
    assert!(stdout.starts_with("small: life ") && stdout.lines().count() == 1, "{stdout}");
    // Without --out the folder has the name of the case.
    done(dir.path(), "predict small.toml -q");
    assert!(dir.path().join("small/result.json").is_file());
    let again = fs::read_to_string(run.join("case.toml")).unwrap();
    assert!(run.join("paraview/run.pvd").is_file() && again.contains("[output]\nparaview = true"), "{again}");
    for (key, words) in [
        ("output.vtk=true", "output.vtk = true: unknown key; use one of: paraview"),
        ("output.paraview=1", "output.paraview = 1: is not true or false"),
    ] {
        assert_refused(&perilife(dir.path(), &format!("check small.toml --set {key}")), 2, &[words]);
    }
}

/// Files and folders that cannot be read or written are file trouble, said before anything is computed.
#[test]
#[cfg(target_os = "linux")]
fn unreadable_and_unwritable_places() {
    let dir = desk(&[("small.toml", &SMALL_CASE), ("m.csv", &"cycles,crack_length_mm\n0,9\n1,10\n2,11\n3,12\n4,13\n")]);
    let calls: [(&[&str], i32, &[&str]); 9] = [
        (&["predict", "no.toml", "--out", "a/b"], 4, &["no.toml: cannot read"]),
        (&["predict", ".", "--out", "a/b"], 4, &[".: cannot read"]),
        (&["export", "no", "--out", "a.csv"], 4, &["no: cannot read"]),
        (&["predict", "small.toml", "--out", "small.toml/run"], 4, &["small.toml/run"]),
        (&["predict", "small.toml", "--out", "/proc/run"], 4, &["/proc/run"]),
        (&["predict", "small.toml", "--out", "/dev/full"], 2, &["--out = /dev/full", "is a file", "name of a folder"]),
        (&["predict", "small.toml", "--out", "."], 2, &["--out = .", "current folder", "below it"]),
        (&["rates", "m.csv", "--method", "secant", "--out", "/dev/full"], 4, &["/dev/full", "cannot write"]),
        (&["check", "small.toml", "--picture", "/dev/full"], 4, &["/dev/full", "cannot write"]),
    ];
    for (arguments, code, words) in calls {
        assert_refused(&perilife(dir.path(), arguments), code, words);
    }

    use std::os::unix::fs::PermissionsExt;
    let locked = dir.path().join("locked");
    fs::create_dir(&locked).unwrap();
    fs::write(locked.join("small.toml"), SMALL_CASE).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o000)).unwrap();
    if fs::read_dir(&locked).is_ok() {
        println!("skipped: this user may read everything");
    } else {
        assert_refused(&perilife(dir.path(), "predict locked/small.toml --out run"), 4, &["locked/small.toml"]);
        assert_refused(&perilife(dir.path(), "predict small.toml --out locked/run"), 4, &["locked/run"]);
        assert_refused(&perilife(dir.path(), "export locked --out e.csv"), 4, &["locked", "cannot read"]);
    }
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o755)).unwrap();
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 3, "nothing new stands there");
}

#[test]
fn shells_and_the_manual_know_every_command() {
    for (form, words) in
        [("bash", ["complete", "predict"]), ("zsh", ["#compdef perilife", "calibrate"]), ("man", [".TH", "stability"])]
    {
        let (stdout, stderr) = texts(&perilife(Path::new("."), &["completions", form]));
        assert!(words.iter().all(|word| stdout.contains(word)) && stderr.is_empty(), "{form}: {stderr}");
    }
}

#[test]
fn rates_of_materials_stand_beside_measured_ones() {
    let dir = tempdir().unwrap();
    let drawn =
        ["rates", "--materials", "al2024-t3-clad-lt", "al7075-t6-sheet-lt", "--stress-ratio", "0.1", "--picture", "r.svg"];
    let (stdout, stderr) = texts(&perilife(dir.path(), &drawn));
    // 2024-T3 L-T at R = 0 and ΔK = 10 MPa√m: 6.985e-5 mm/cycle by NASGRO 4; at R = 0.1 more.
    assert!(stdout.contains("al2024-t3-clad-lt,0.1,") && stderr.is_empty(), "{stdout}{stderr}");
    let svg = fs::read_to_string(dir.path().join("r.svg")).unwrap();
    assert!(svg.contains("al7075-t6-sheet-lt") && svg.contains("MPa√m"));
    let refused = perilife(dir.path(), "rates --materials al2024-t3");
    assert_refused(&refused, 2, &["al2024-t3", "no growth law", "list materials"]);
}
