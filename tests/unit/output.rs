//! Output folders and files are whole or absent, and nobody else's files are touched.

use std::fs;
use std::path::Path;

use perilife_base::input::{OpenedFile, Provenance};
use perilife_results::output::{MARKER, OutputFolder, RunKind, write_file};
use perilife_results::provenance;
use tempfile::tempdir;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_folder_appears_when_it_is_finished_and_replaces_only_its_own() {
    let dir = tempdir().unwrap();
    let out = dir.path().join("new/parent/run");
    for content in ["first", "second"] {
        let folder = OutputFolder::create(&out, RunKind::Predict).unwrap();
        fs::write(folder.path().join(content), content).unwrap();
        assert!(!out.join(content).exists(), "nothing is seen before the end");
        folder.finish().unwrap();
        assert_eq!(names(&out), [MARKER, content], "the earlier result has gone");
    }
    assert_eq!(names(out.parent().unwrap()), ["run"], "no temporary folder stays");
}

/// Files that a run keeps have names that every system takes, each its own whatever the case.
#[test]
fn kept_files_can_be_unpacked_everywhere() {
    let file = |name: &str| OpenedFile { name: name.to_owned(), path: None, id: None, content: [][..].into() };
    for (given, kept) in [
        ("a\\..\\..\\b.csv", "b.csv"),
        ("con.csv", "_con.csv"),
        ("COM1", "_COM1"),
        ("Lpt9.txt", "_Lpt9.txt"),
        ("company.csv", "company.csv"),
        ("com12.csv", "com12.csv"),
        ("a<b>:\"|?*.csv", "a_b______.csv"),
        ("a. ", "a"),
        ("\\", "_"),
        ("Maße 1.csv", "Maße 1.csv"),
    ] {
        let mut object = serde_json::json!({});
        let files = ["case.toml", given, "case.TOML"].map(file).to_vec();
        provenance::add(&mut object, &Provenance { files, ..Provenance::default() }, []);
        let names: Vec<&str> = object["inputs"].as_array().unwrap().iter().map(|one| one["kept_as"].as_str().unwrap()).collect();
        assert_eq!(names, ["inputs/case.toml", &format!("inputs/{kept}"), "inputs/2_case.TOML"], "{given}");
    }
}

#[test]
fn an_unfinished_folder_leaves_nothing() {
    let dir = tempdir().unwrap();
    let out = dir.path().join("deep/run");
    drop(OutputFolder::create(&out, RunKind::Predict).unwrap());
    assert!(names(dir.path()).is_empty(), "new parents go as well");
    let panicked = std::panic::catch_unwind(|| {
        let folder = OutputFolder::create(&out, RunKind::Predict).unwrap();
        fs::write(folder.path().join("half"), "").unwrap();
        std::panic::resume_unwind(Box::new("in the middle of a run"));
    });
    assert!(panicked.is_err() && names(dir.path()).is_empty());
}

#[test]
fn an_unfinished_folder_leaves_the_earlier_result() {
    let dir = tempdir().unwrap();
    let out = dir.path().join("run");
    OutputFolder::create(&out, RunKind::Predict).unwrap().finish().unwrap();
    drop(OutputFolder::create(&out, RunKind::Predict).unwrap());
    assert_eq!(names(&out), [MARKER]);
}

#[test]
fn an_empty_folder_may_be_used() {
    let dir = tempdir().unwrap();
    let out = dir.path().join("run");
    fs::create_dir(&out).unwrap();
    OutputFolder::create(&out, RunKind::Predict).unwrap().finish().unwrap();
    assert_eq!(names(&out), [MARKER]);
}

#[test]
fn what_is_not_ours_is_refused() {
    let dir = tempdir().unwrap();
    let (folder, file) = (dir.path().join("thesis"), dir.path().join("file"));
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("chapter"), "years of work").unwrap();
    fs::write(&file, "text").unwrap();
    // The last two: a folder below a file, and the folder the test itself runs in.
    for (path, code) in [(folder.as_path(), 2), (&file, 2), (Path::new(""), 2), (&file.join("run"), 4), (Path::new("."), 2)] {
        let error = OutputFolder::create(path, RunKind::Predict).unwrap_err();
        assert_eq!(error.exit_code(), code, "{error}");
        assert!(error.to_string().contains(&path.display().to_string()), "{error}");
    }
    assert_eq!(names(dir.path()), ["file", "thesis"]);
    assert_eq!(names(&folder), ["chapter"]);
}

#[test]
fn a_file_is_whole_or_absent() {
    let dir = tempdir().unwrap();
    let file = dir.path().join("a.csv");
    for content in ["first", "second"] {
        write_file(&file, content.as_bytes()).unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), content);
    }
    assert_eq!(names(dir.path()), ["a.csv"]);
    assert_eq!(write_file(dir.path(), b"x").unwrap_err().exit_code(), 2, "a folder is no file");
    assert_eq!(write_file(&dir.path().join("missing/a.csv"), b"x").unwrap_err().exit_code(), 4);
    assert_eq!(write_file(&file.join("below"), b"x").unwrap_err().exit_code(), 4);
    assert_eq!(names(dir.path()), ["a.csv"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_target_is_file_trouble_and_the_device_stays() {
    use std::os::unix::fs::FileTypeExt;
    let full = Path::new("/dev/full");
    if !full.exists() {
        println!("skipped: this system has no /dev/full");
        return;
    }
    assert_eq!(write_file(full, b"x").unwrap_err().exit_code(), 4);
    assert!(fs::metadata(full).unwrap().file_type().is_char_device());
}
