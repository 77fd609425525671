//! What the commands do around the engine: which runs are kept, and how errors are told.

use std::fs;
use std::path::{Path, PathBuf};

use perilife::commands::check;
use perilife::commands::console::{Console, with_source_line};
use perilife_base::error::InputError;
use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, StopReason};
use perilife_results::output::{OutputFolder, RunKind};
use perilife_runner::catalogue;
use perilife_runner::{Task, Wanted, of_prediction};
use tempfile::tempdir;

use crate::support::desk::json;
use crate::support::rows::assert_says;
use crate::support::{made_up_case, made_up_run};
use crate::unit::house;

const QUIET: Console = Console { json: false, quiet: true, verbose: 0 };

fn keep(case: &Case, run: Prediction, out: &Path) -> Result<(), perilife_base::error::Error> {
    let folder = OutputFolder::create(out, RunKind::Predict)?;
    let task = Task::Prediction { case: Box::new(case.clone()), wanted: Box::default() };
    let files = |path: &Path| {
        let summary = of_prediction(case, run, &Wanted::default(), &QUIET)?;
        summary.write(&task, path)?;
        Ok(summary)
    };
    QUIET.keep(folder, &[], files)?.counted().map(drop)
}

#[test]
fn a_run_leaves_all_its_files() {
    let dir = tempdir().unwrap();
    let out = dir.path().join("run");
    let mut case = made_up_case::case();
    case.output.paraview = true;
    keep(&case, made_up_run::prediction(0.0), &out).unwrap();
    let files =
        ["a_n.csv", "crack_path.csv", "result.json", "a_n.svg", "da_dn.svg", "plate.svg", "damage.svg", "paraview/run.pvd"];
    for file in files.into_iter().chain(["paraview/plate_0002.vti", ".perilife"]) {
        assert!(fs::metadata(out.join(file)).unwrap().len() > 0, "{file}");
    }
    let result = json(out.join("result.json"));
    assert_eq!(result["points"], made_up_run::prediction(0.0).figures.points);
    case.output.tables_only = true;
    keep(&case, made_up_run::prediction(0.0), &out).unwrap();
    let files = fs::read_dir(&out).unwrap().map(|file| file.unwrap().path());
    assert_eq!(files.filter(|file| file.extension().is_some_and(|end| end == "svg")).count(), 0);
}

#[test]
fn no_convergence_is_refused_only_where_there_is_no_curve() {
    let dir = tempdir().unwrap();
    let case = made_up_case::case();
    let mut run = made_up_run::prediction(0.0);
    run.stop = StopReason::NoConvergence;
    keep(&case, run.clone(), &dir.path().join("grown")).unwrap();
    run.curve.truncate(1);
    let error = keep(&case, run, &dir.path().join("not_grown")).unwrap_err();
    assert_eq!(error.exit_code(), 3, "{error}");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1, "nothing of the refused run stays");
}

#[test]
fn far_extrapolation_is_refused_unless_allowed_but_kept() {
    let dir = tempdir().unwrap();
    let mut case = made_up_case::case();
    // Below the lowest fitted ΔK lives come out short: that is told, and counts.
    case.law = made_up_case::fitted(12.0, 30.0);
    keep(&case, made_up_run::prediction(0.0), &dir.path().join("run")).unwrap();
    // All of the life is spent above 1 MPa√m.
    case.law = made_up_case::fitted(0.5, 1.0);
    let error = keep(&case, made_up_run::prediction(0.0), &dir.path().join("run")).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert_says(&error.to_string(), &["0.50 to 1.00 MPa√m", "allow_extrapolation = true"]);
    // What it cost is kept, and marked.
    let refused = || json(dir.path().join("run/result.json"))["refused"].as_str().map(str::to_owned);
    assert!(refused().unwrap().contains("above the tested ΔK"));
    case.allow_extrapolation = true;
    keep(&case, made_up_run::prediction(0.0), &dir.path().join("run")).unwrap();
    assert_eq!(refused(), None);
}

#[test]
fn an_error_shows_its_line_where_there_is_one() {
    let dir = tempdir().unwrap();
    let file = dir.path().join("case.toml");
    fs::write(&file, "[specimen]\nwidth_mm = -1\n").unwrap();
    let error = |line: usize| InputError {
        file: Some(file.clone()),
        line: Some(line),
        key: Some("specimen.width_mm".to_owned()),
        value: Some("-1".to_owned()),
        problem: "must be above zero".to_owned(),
        remedy: "give a width".to_owned(),
        more: Vec::new(),
    };
    let shown = with_source_line(&error(2)).unwrap();
    assert_says(&shown, &["case.toml", "width_mm = -1", "specimen.width_mm = -1: must be above zero", "give a width"]);
    // A line the file does not have (it was changed meanwhile) and a file that has gone give the plain words instead.
    assert!(with_source_line(&error(0)).is_none() && with_source_line(&error(99)).is_none());
    assert!(with_source_line(&InputError { file: Some("gone.toml".into()), ..error(2) }).is_none());
}

#[test]
fn the_list_misses_no_kind() {
    let lines = [catalogue::lines(), perilife_study::catalogue()].concat();
    let mut keys = 0;
    for file in house::rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")) {
        for line in fs::read_to_string(&file).unwrap().lines() {
            let declared = line.trim().strip_prefix("pub enum ").and_then(|rest| rest.split_once(" for \""));
            if let Some((_, rest)) = declared {
                let key = rest.split('"').next().unwrap();
                // Of jobs and tokens: the description of the service lists them.
                if ["kind", "state", "role"].contains(&key) {
                    continue;
                }
                assert!(lines.iter().any(|(listed, ..)| listed == key), "{key} of {} is not listed", file.display());
                keys += 1;
            }
        }
    }
    assert!(keys > 20, "the test reads the sources: {keys} keys");
}

/// Every shipped case passes, with a picture, and opens with its question; a picture that cannot be written leaves nothing behind.
#[test]
fn shipped_cases_pass() {
    let folder = tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let of = |below: &str| fs::read_dir(root.join(below)).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let files = ["data/cases", "data/cases/fracture", "data/sweeps"].map(of).concat().into_iter();
    let files: Vec<PathBuf> = files.filter(|file| file.extension().is_some_and(|extension| extension == "toml")).collect();
    assert!(files.len() > 20);
    for (number, file) in files.into_iter().enumerate() {
        assert!(fs::read_to_string(&file).unwrap().starts_with("# "), "{}", file.display());
        let picture = folder.path().join("picture.svg");
        let args = check::Args { file, picture: Some(picture.clone()), set: vec![], console: QUIET };
        check::run(&args).unwrap();
        assert!(fs::read_to_string(&picture).unwrap().ends_with("</svg>\n"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        if number % 10 == 0 {
            let nowhere = check::Args { picture: Some(folder.path().join("no/such/folder.svg")), ..args };
            assert_eq!(check::run(&nowhere).unwrap_err().exit_code(), 4);
        }
    }
}

/// The measured files of a calibration are read and checked, and the case of it is; a page says where its curves come from.
#[test]
fn shipped_calibrations_pass() {
    for entry in fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/calibration")).unwrap() {
        let folder = entry.unwrap().path();
        if folder.is_dir() {
            let args = check::Args { file: folder.join("case.toml"), picture: None, set: vec![], console: QUIET };
            check::run(&args).unwrap();
            assert!(folder.join("README.md").is_file(), "{}", folder.display());
            let set = vec!["measured.files=[\"nowhere.csv\"]".to_owned()];
            assert_eq!(check::run(&check::Args { set, ..args }).unwrap_err().exit_code(), 4);
        }
    }
}

#[test]
fn every_line_says_something_once() {
    let lines = [catalogue::lines(), perilife_study::catalogue()].concat();
    // A kind of load that cases and scenes both have stands there for either.
    let mut names: Vec<_> = lines.iter().collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), lines.len());
    assert!(lines.iter().all(|(key, _, meaning)| !key.is_empty() && meaning.len() > 5));
    for kind in ["surface_crack", "corner_crack", "embedded_crack", "corner_crack_at_hole"] {
        assert!(lines.iter().any(|(key, name, _)| key == "specimen.kind" && name == kind), "{kind}");
    }
}

/// Numbers of file systems over a network (statfs(2)) are known, those of disks of a machine are not among them.
#[test]
#[cfg(feature = "service")]
fn network_drives_are_known() {
    use perilife::commands::worker::network_drive;
    for (number, kind) in [(0x6969, "NFS"), (0xff53_4d42, "SMB"), (0xffff_ffff_ff53_4d42, "SMB"), (0x0102_1997, "9P")] {
        assert_eq!(network_drive(number), Some(kind));
    }
    // ext4, XFS, Btrfs, tmpfs, overlay, ZFS.
    for number in [0xef53, 0x5846_5342, 0x9123_683e, 0x0102_1994, 0x794c_7630, 0x2fc1_2fc1] {
        assert_eq!(network_drive(number), None, "{number:x}");
    }
}
