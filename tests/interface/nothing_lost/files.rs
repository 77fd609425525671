//! Single files: a command replaces its own, never what it reads, and nothing that something else wrote.

use std::fs;
use std::os::unix::fs::symlink;

use tempfile::TempDir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::daily::{self, content, names};
use crate::support::desk::done;

/// Every option that names one file: the call before it, a file that the call reads, and whether `-` is standard output there.
const OUTPUTS: [(&[&str], &str, &str); 4] = [
    (&["export", "run", "--out"], "run/a_n.csv", "cycles,crack_length_mm,"),
    (&["rates", "readings.csv", "--specimen", "panel.toml", "--out"], "readings.csv", "specimen,cycles,"),
    (&["check", "panel.toml", "--picture"], "panel.toml", "<svg "),
    (&["verify", "golden", "--markdown"], "panel.toml", "# Accuracy"),
];

fn inputs() -> TempDir {
    let dir = daily::inputs();
    done(dir.path(), "predict panel.toml --out run -q");
    dir
}

#[test]
fn a_file_replaces_its_own_and_nothing_else() {
    let dir = inputs();
    let here = dir.path();
    fs::create_dir(here.join("folder")).unwrap();
    for (call, read, sign) in OUTPUTS {
        let (option, to) = (call[call.len() - 1], |name: &str| perilife(here, &[call, &[name, "-q"]].concat()));
        let refused = |name: &str, words: &[&str]| {
            let before = content(here);
            assert_refused(&to(name), 2, &[&[&*format!("{option} = {name}")], words].concat());
            assert!(content(here) == before, "{call:?} {name}");
        };
        for _ in 0..2 {
            let output = to("own");
            assert_eq!(output.status.code(), Some(0), "{call:?}: {}", texts(&output).1);
            assert!(fs::read_to_string(here.join("own")).unwrap().starts_with(sign), "{call:?}");
        }
        // A link is followed, to a file of its own and to nothing yet.
        symlink("own", here.join("link")).unwrap();
        assert_eq!(to("link").status.code(), Some(0));
        assert!(fs::symlink_metadata(here.join("link")).unwrap().is_symlink());
        fs::write(here.join("notes"), "cycles, my own notes\n").unwrap();
        refused("notes", &["is a file that this command did not write", "give a new name"]);
        refused("folder", &["is a folder", "give the name of a file"]);
        refused(read, &["is a file that this command"]);
        symlink(read, here.join("to_input")).unwrap();
        fs::hard_link(here.join(read), here.join("hard")).unwrap();
        let reads = if call[0] == "verify" { "did not write" } else { "is a file that this command reads" };
        refused("to_input", &[reads]);
        refused("hard", &[reads]);
        let (stdout, stderr) = texts(&to("-"));
        assert!(stdout.starts_with(sign), "{call:?}: {stdout} {stderr}");
        assert!(!here.join("-").exists());
        for file in ["own", "link", "notes", "to_input", "hard"] {
            fs::remove_file(here.join(file)).unwrap();
        }
        assert!(names(here).iter().all(|name| !name.starts_with('.')), "{:?}", names(here));
    }
}

/// A checkpoint likewise; and it lies beside the results, not in them.
#[test]
fn a_checkpoint_is_nothing_that_is_read() {
    let dir = inputs();
    let here = dir.path();
    for (command, input) in [("predict", "panel.toml"), ("fracture", "scene.toml")] {
        symlink(input, here.join("link")).unwrap();
        fs::write(here.join("notes"), "my notes").unwrap();
        for (file, words) in [
            (input, "is not a checkpoint"),
            ("link", "is not a checkpoint"),
            ("notes", "is not a checkpoint"),
            ("run", "cannot"),
            ("out/run.ckpt", "is inside --out = out"),
        ] {
            let before = content(here);
            let output = perilife(here, &format!("{command} {input} --out out -q --checkpoint {file}"));
            assert!([Some(2), Some(4)].contains(&output.status.code()), "{}", texts(&output).1);
            assert!(texts(&output).1.contains(words), "{}", texts(&output).1);
            assert!(content(here) == before, "{command} --checkpoint {file}");
        }
        fs::remove_file(here.join("link")).unwrap();
        done(here, &format!("{command} {input} --out out -q --checkpoint run.ckpt"));
        fs::remove_dir_all(here.join("out")).unwrap();
    }
    assert!(names(here).iter().all(|name| !name.starts_with('.')), "{:?}", names(here));
}

/// A table that was cut off in copying, in a row, between rows, or changed: `export` says so.
#[test]
fn a_table_that_was_cut_off_is_noticed() {
    let dir = inputs();
    let here = dir.path();
    let table = fs::read(here.join("run/a_n.csv")).unwrap();
    let row_end = table.iter().take(3000).rposition(|byte| *byte == b'\n').unwrap() + 1;
    let changed = String::from_utf8(table.clone()).unwrap().replacen("9.000000000", "8.000000000", 1).into_bytes();
    let export = || perilife(here, "export run --points 3 --out e.csv -q");
    for (bytes, words) in
        [(&table[..3000], "is cut off: 3000 of the"), (&table[..row_end], "is cut off"), (&changed[..], "is not the table")]
    {
        fs::write(here.join("run/a_n.csv"), bytes).unwrap();
        assert_refused(&export(), 2, &["run/a_n.csv", words, "copy it again"]);
        assert!(!here.join("e.csv").exists());
    }
    fs::write(here.join("run/a_n.csv"), &table).unwrap();
    assert!(export().status.success());
    // What an earlier version wrote has no hash, and a result that is cut off says nothing.
    let result = fs::read_to_string(here.join("run/result.json")).unwrap();
    fs::write(here.join("run/result.json"), result.replacen("\"tables\"", "\"other\"", 1)).unwrap();
    fs::write(here.join("run/a_n.csv"), &table[..row_end]).unwrap();
    assert_refused(&export(), 2, &["run/a_n.csv", "ends at ", "and the run at "]);
    fs::write(here.join("run/result.json"), &result[..200]).unwrap();
    assert_refused(&export(), 2, &["result.json is truncated or damaged"]);
}

/// Standard input and standard output by `-` and by their devices; a pipe is read once.
#[test]
fn pipes_are_files() {
    let dir = inputs();
    let here = dir.path();
    let piped = |input: &str, arguments: &[&str]| {
        let mut command = assert_cmd::cargo::cargo_bin_cmd!("perilife");
        let output = command.current_dir(here).args(arguments).pipe_stdin(here.join(input)).unwrap().output().unwrap();
        (output.status.code(), texts(&output))
    };
    for stdin in ["-", "/dev/stdin"] {
        for (input, arguments) in [
            ("panel.toml", vec!["check", stdin]),
            ("scene.toml", vec!["check", stdin]),
            ("fit.toml", vec!["check", stdin]),
            ("sweep.toml", vec!["check", stdin, "--set", "vary[0].values=[9.0, 11.0]"]),
            ("small.toml", vec!["sif", stdin]),
            ("panel.toml", vec!["predict", stdin, "--out", "p"]),
            ("scene.toml", vec!["fracture", stdin, "--out", "f"]),
            ("fit.toml", vec!["calibrate", stdin, "--out", "c"]),
            ("sweep.toml", vec!["sweep", stdin, "--out", "s"]),
            ("readings.csv", vec!["rates", stdin, "--specimen", "panel.toml"]),
        ] {
            // Names in a piped file start from the current folder.
            let (code, (_, stderr)) = piped(input, &arguments);
            assert_eq!(code, Some(0), "{arguments:?}: {stderr}");
            ["p", "f", "c", "s"].iter().for_each(|out| drop(fs::remove_dir_all(here.join(out))));
        }
    }
    let (code, (_, stderr)) = piped("panel.toml", &["rates", "-", "--specimen", "-"]);
    assert!(code == Some(2) && stderr.contains("error: "), "{stderr}");
    let (code, (_, stderr)) = piped("readings.csv", &["rates", "-", "-"]);
    assert!(code == Some(2) && stderr.contains("standard input was already read"), "{stderr}");
}
