//! `perilife sweep` and `perilife collect`, by every engine.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use serde_json::Value;
use tempfile::TempDir;

use crate::interface::cli::{SMALL_CASE, assert_refused, perilife, texts};
use crate::interface::service::jobs::with_store;
use crate::support::daily::PANEL;
use crate::support::desk::{desk, done, json};
use crate::support::rows::assert_says;
use crate::support::server::{PATIENCE, Server, in_folder, wait};
use crate::support::slurm::Slurm;

/// Six cases, the last key fastest.
pub const GRID: &str = "case = \"panel.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"specimen.crack_length_mm\"\n\
    values = [8.0, 9.5]\n[[vary]]\nkey = \"loading.stress_range_mpa\"\nfrom = 40\nto = 60\ncount = 3\n";

pub fn folder_with(sweep: &str) -> TempDir {
    desk(&[("panel.toml", &PANEL), ("small.toml", &SMALL_CASE), ("sweep.toml", &sweep)])
}

/// Rows of a table without `wall_s`, which differs from run to run.
fn rows(folder: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(folder.join("sweep.csv")).unwrap();
    let mut rows: Vec<Vec<String>> = text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
    let wall = rows[0].iter().position(|name| name == "wall_s").unwrap();
    rows.iter_mut().for_each(|row| drop(row.remove(wall)));
    rows
}

#[test]
fn a_grid_gives_the_lives_of_single_predictions() {
    let dir = folder_with(GRID);
    let here = dir.path();
    let (stdout, _) = done(here, "sweep sweep.toml --out out --threads 3");
    assert!(stdout.contains("6 cases, 6 succeeded, 0 failed") && stdout.contains("median"), "{stdout}");
    let rows = rows(&here.join("out"));
    let head = "case,specimen.crack_length_mm,loading.stress_range_mpa,life_cycles,stop_reason,crack_length_final_mm,problem,life_is_lower_bound";
    assert_eq!(rows[0].join(","), head);
    assert_eq!(rows.len(), 7);
    let mut lives = Vec::new();
    for (i, row) in rows[1..].iter().enumerate() {
        let set = [format!("specimen.crack_length_mm={}", row[1]), format!("loading.stress_range_mpa={}", row[2])];
        let single = format!("single/{i}");
        done(here, &["predict", "panel.toml", "--out", &single, "--set", &set[0], "--set", &set[1]]);
        let table = fs::read_to_string(here.join(&single).join("a_n.csv")).unwrap();
        assert_eq!(row[3], table.lines().last().unwrap().split(',').next().unwrap(), "{row:?}");
        assert_eq!((row[0].as_str(), row[4].as_str()), (format!("{:04}", i + 1).as_str(), "crack_length_reached"));
        // All files of the run, the same as its own.
        let case = here.join(format!("out/cases/{}", row[0]));
        for file in ["a_n.csv", "crack_path.csv"] {
            assert!(fs::read(case.join(file)).unwrap() == fs::read(here.join(&single).join(file)).unwrap(), "{file}");
        }
        assert!(case.join("result.json").is_file() && case.join("a_n.svg").is_file());
        lives.push(row[3].parse::<f64>().unwrap());
    }
    lives.sort_by(f64::total_cmp);
    let figures = json(here.join("out/sweep.json"));
    let quantile = |key: &str| figures["life_cycles"][key].as_f64().unwrap();
    assert!((quantile("p50") - 0.5 * (lives[2] + lives[3])).abs() < 1e-6);
    assert!((quantile("p05") - (lives[0] + 0.25 * (lives[1] - lives[0]))).abs() < 1e-6, "definition 7");
    assert_eq!((&figures["cases"], &figures["failed"], &figures["missing"]), (&6.into(), &0.into(), &0.into()));
    assert_eq!(figures["design"]["design"]["kind"], "grid");
    assert!(fs::read_to_string(here.join("out/life.svg")).unwrap().contains("specimen.crack_length_mm"));
    assert_eq!(fs::read_dir(here).unwrap().count(), 5, "no temporary folder stays");

    // Summaries alone, and the figures on stdout.
    let (stdout, _) = done(here, "sweep sweep.toml --out brief --summary-only --json");
    assert_eq!(serde_json::from_str::<Value>(&stdout).unwrap(), json(here.join("brief/sweep.json")));
    assert_eq!(self::rows(&here.join("brief")), rows);
    assert!(!here.join("brief/cases/0001/a_n.csv").exists());
    // Files that are wanted later are made then.
    done(here, "sweep sweep.toml --out brief");
    assert!(here.join("brief/cases/0001/a_n.csv").exists());
}

#[test]
fn a_finished_case_is_not_run_again() {
    let dir = folder_with(GRID);
    let here = dir.path();
    done(here, "sweep sweep.toml --out out");
    let (whole, outcome) = (rows(&here.join("out")), |case: &str| fs::read(here.join(format!("out/cases/{case}/outcome.toml"))));
    let before = outcome("0002").unwrap();
    // As after a crash: cases that are missing, one that was being written, no tables.
    fs::remove_dir_all(here.join("out/cases/0004")).unwrap();
    fs::create_dir(here.join("out/cases/.0005.partial-1-0")).unwrap();
    for file in ["sweep.csv", "sweep.json", "life.svg"] {
        fs::remove_file(here.join("out").join(file)).unwrap();
    }
    let output = perilife(here, "sweep sweep.toml --out out");
    assert!(texts(&output).1.contains("5 of 6 cases already finished"), "{}", texts(&output).1);
    assert_eq!((rows(&here.join("out")), outcome("0002").unwrap()), (whole.clone(), before));
    assert_eq!(fs::read_dir(here.join("out/cases")).unwrap().count(), 6);
    // Another law is another input; fewer cases leave no others behind.
    let set = ["--set", "fatigue.paris_m=3.0", "--set", "vary[1].count=2"];
    done(here, &[&["sweep", "sweep.toml", "--out", "out"][..], &set].concat());
    let other = rows(&here.join("out"));
    assert_eq!((other.len(), fs::read_dir(here.join("out/cases")).unwrap().count()), (5, 4));
    assert_ne!(other[1][3], whole[1][3]);
}

/// Above the fitted range of ΔK a run does not count.
#[test]
fn a_failing_case_is_a_row() {
    let panel = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/sweeps/panel.toml");
    let design = "[design]\nkind = \"grid\"\n[[vary]]\nkey = \"loading.stress_range_mpa\"\nvalues = [48.28, 130.0]\n";
    let dir = folder_with(&format!("case = {:?}\n{design}", panel.display().to_string()));
    let here = dir.path();
    let (stdout, _) = done(here, "sweep sweep.toml --out out");
    assert_says(&stdout, &["1 succeeded, 1 failed", "failed         0002: fatigue.allow_extrapolation"]);
    let table = fs::read_to_string(here.join("out/sweep.csv")).unwrap();
    let row = table.lines().nth(2).unwrap();
    assert!(row.starts_with("0002,130.0000000,,,,") && row.contains("above the tested ΔK"), "{row}");
    assert_eq!(json(here.join("out/sweep.json"))["failures"][0]["case"], "0002");
    // It is not tried again, and where no case has a result the sweep has none.
    assert!(texts(&perilife(here, "sweep sweep.toml --out out")).1.contains("2 of 2 cases already finished"));
    let output = perilife(here, "sweep sweep.toml --out none --set vary[0].values=[130.0]");
    assert_eq!(output.status.code(), Some(3));
    assert!(
        texts(&output).1.contains("error: sweep: no case has a result; the first says: fatigue.allow"),
        "{}",
        texts(&output).1
    );
    assert!(here.join("none/sweep.csv").is_file());
}

#[test]
fn shards_and_collect_give_the_same_table() {
    let dir = folder_with(GRID);
    let here = dir.path();
    done(here, "sweep sweep.toml --out whole");
    let part = |i: &str| done(here, &format!("sweep sweep.toml --out parts --shard {i}"));
    assert!(part("1/4").0.contains("sweep 1/4: 2 cases, 2 run, 0 failed"));
    part("3/4");
    let output = perilife(here, "collect parts");
    assert_eq!(output.status.code(), Some(3));
    assert!(texts(&output).1.contains("3 of 6 cases are missing: 0002, 0004, 0006;"), "{}", texts(&output).1);
    assert_eq!(json(here.join("parts/sweep.json"))["missing_cases"], serde_json::json!(["0002", "0004", "0006"]));
    assert!(fs::read_to_string(here.join("parts/sweep.csv")).unwrap().contains("0002,8.000000000,50.00000000,,,,,not run yet"));
    for i in ["2/4", "4/4"] {
        part(i);
    }
    done(here, "collect parts");
    assert_eq!(rows(&here.join("parts")), rows(&here.join("whole")));
    // A part of another sweep has no place there.
    let other = perilife(here, "sweep sweep.toml --out parts --shard 1/4 --set loading.stress_ratio=0.3");
    assert_refused(&other, 2, &["--out = parts", "the sweep has changed"]);
    assert_refused(&perilife(here, "collect ."), 2, &["DIR = .", "is not the folder of a sweep"]);
}

#[test]
fn workers_of_a_service_give_the_same_table() {
    with_store("swept", |place| {
        let dir = folder_with(GRID);
        let here = dir.path();
        done(here, "sweep sweep.toml --out local");
        let arguments = [&["sweep", "sweep.toml", "--out", "served", "--engine", "service"], place].concat();
        let start =
            || Command::new(cargo_bin("perilife")).current_dir(here).args(&arguments).stderr(Stdio::null()).spawn().unwrap();

        // Killed before there is any worker: the jobs stay.
        let service = Server::start(place, &["--jobs", "0"]);
        let jobs = || service.get("/v1/predictions?limit=200").json()["items"].as_array().unwrap().clone();
        let wait_for = |count: usize| {
            wait("too few jobs", || jobs().len() >= count);
        };
        let mut process = start();
        wait_for(6);
        let _ = process.kill();
        process.wait().unwrap();
        // The next call waits for the same jobs, and ends when somebody cancels one. One that is cancelled before is submitted anew.
        let mut process = start();
        let begun = Instant::now();
        let ended = loop {
            if let Some(ended) = process.try_wait().unwrap() {
                break ended;
            }
            assert!(begun.elapsed() < PATIENCE, "it does not end");
            let id = jobs()[0]["id"].as_str().unwrap().to_owned();
            service.post(&format!("/v1/predictions/{id}/cancel"), &Value::Null);
            std::thread::sleep(Duration::from_millis(300));
        };
        assert_eq!(ended.code(), Some(3));

        // With workers the next one gets them all.
        let _worker = Server::worker(place, &["--jobs", "2"]);
        done(here, &arguments);
        let with = |state: &str| jobs().iter().filter(|job| job["state"] == state).count();
        assert_eq!((with("succeeded"), jobs().len()), (6, 6 + with("cancelled")));
        assert_eq!(rows(&here.join("served")), rows(&here.join("local")));
        for case in ["0001", "0006"] {
            let [served, local] = ["served", "local"].map(|folder| here.join(folder).join("cases").join(case));
            for entry in fs::read_dir(&local).unwrap().map(Result::unwrap) {
                assert!(served.join(entry.file_name()).exists(), "{:?}", entry.file_name());
            }
            assert!(fs::read(served.join("a_n.csv")).unwrap() == fs::read(local.join("a_n.csv")).unwrap());
        }
        // Everything is there: no worker is asked again.
        assert!(texts(&perilife(here, &arguments)).1.contains("6 of 6 cases already finished"));
    });
}

/// Cases of bonds have pictures, which come as an archive; a case that fails is a row here too.
#[test]
fn a_service_hands_over_all_files() {
    let design = |case: &str, key: &str, values: &str| {
        format!("case = {case:?}\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"{key}\"\nvalues = {values}\n")
    };
    let panel = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/sweeps/panel.toml");
    let dir = folder_with(&design("small.toml", "specimen.crack_length_mm", "[12.0]"));
    let here = dir.path();
    let failing = design(&panel.display().to_string(), "loading.stress_range_mpa", "[48.28, 130.0]");
    fs::write(here.join("failing.toml"), failing).unwrap();
    fs::write(here.join("small.toml"), format!("{SMALL_CASE}[output]\nparaview = true\n")).unwrap();
    let place = in_folder(&here.join("service"));
    // The database is made by a service.
    drop(Server::start(&place, &["--jobs", "0"]));
    let _worker = Server::worker(&place, &["--jobs", "1"]);
    for sweep in ["sweep", "failing"] {
        let file = format!("{sweep}.toml");
        let [served, local] = ["served", "local"].map(|engine| format!("{sweep}/{engine}"));
        done(here, &["sweep", &file, "--out", &served, "--engine", "service", &place[0], &place[1]]);
        done(here, &format!("sweep {file} --out {local} --threads 1"));
        assert_eq!(rows(&here.join(served)), rows(&here.join(local)));
    }
    assert!(fs::read_to_string(here.join("failing/served/sweep.csv")).unwrap().contains("above the tested ΔK"));
    let [served, local] = ["served", "local"].map(|engine| here.join("sweep").join(engine).join("cases/0001/paraview"));
    let names = |folder: &Path| {
        let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    assert!(names(&local).len() > 2 && names(&served) == names(&local));
    assert!(names(&local).iter().all(|name| fs::read(local.join(name)).unwrap() == fs::read(served.join(name)).unwrap()));
}

#[test]
fn an_array_job_of_slurm_gives_the_same_table() {
    let Some(cluster) = Slurm::start() else { return };
    let dir = folder_with(GRID);
    let here = dir.path();
    done(here, "sweep sweep.toml --out local");
    let conf = cluster.conf();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(cargo_bin("perilife"));
        let output = command.current_dir(here).env("SLURM_CONF", &conf).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{:?}", texts(&output));
        texts(&output).0
    };
    let base = ["sweep", "sweep.toml", "--out", "a job's", "--engine", "slurm", "--cases-per-task", "2"];
    let stdout = run(&[&base[..], &["--sbatch-option=--time=5", "--wait"]].concat());
    assert!(stdout.starts_with("job ") && stdout.contains(": 3 tasks") && stdout.contains("6 succeeded"), "{stdout}");
    assert_eq!(rows(&here.join("a job's")), rows(&here.join("local")));
    assert_eq!(fs::read_dir(here.join("a job's/logs")).unwrap().count(), 3);

    // Without waiting: only tasks with something to do, collected later.
    fs::remove_dir_all(here.join("a job's/cases/0005")).unwrap();
    let stdout = run(&base);
    assert!(stdout.contains("perilife collect a job's"), "{stdout}");
    assert!(fs::read_to_string(here.join("a job's/job.sh")).unwrap().contains("#SBATCH --array=2\n"));
    wait("the array job ends", || perilife(here, &["collect", "a job's"]).status.code() == Some(0));
    assert_eq!(rows(&here.join("a job's")), rows(&here.join("local")));
}

/// Panels of known scatter, measured, fitted and drawn again: lives scatter as theirs did.
#[test]
fn drawn_laws_scatter_as_the_specimens_did() {
    let design = "case = \"panel.toml\"\n[design]\nkind = \"latin_hypercube\"\nsamples = 40\nseed = 3\n\
        [[vary]]\nkey = \"fatigue.paris_c_mm_per_cycle\"\ndistribution = \"log_normal\"\nmedian = 8.95e-8\nfactor = 1.08\n\
        [[vary]]\nkey = \"fatigue.paris_m\"\ndistribution = \"normal\"\nmean = 2.874\nstandard_deviation = 0.02\n";
    let dir = folder_with(design);
    let here = dir.path();
    done(here, "sweep sweep.toml --out tests");
    let mut measured = "specimen,cycles,crack_length_mm\n".to_owned();
    for case in 1..=40 {
        let text = fs::read_to_string(here.join(format!("tests/cases/{case:04}/a_n.csv"))).unwrap();
        let rows: Vec<&str> = text.lines().skip(1).collect();
        for row in rows.iter().step_by((rows.len() / 40).max(1)).chain(rows.last().filter(|_| rows.len() % 40 != 1)) {
            let fields: Vec<&str> = row.split(',').collect();
            measured += &format!("V{case},{},{}\n", fields[0], fields[1]);
        }
    }
    fs::write(here.join("measured.csv"), measured).unwrap();
    let (sections, _) = PANEL.split_once("[fatigue]").unwrap();
    let calibration = format!("[measured]\nfiles = [\"measured.csv\"]\n{sections}[fit]\nparameters = [\"a\", \"p\"]\n");
    fs::write(here.join("calibration.toml"), calibration).unwrap();
    done(here, "calibrate calibration.toml --out fit");
    let panel = format!("{sections}[fatigue]\nfitted = \"fit/fitted.toml\"\n[stop]\ncrack_length_mm = 49.8\n");
    fs::write(here.join("panel.toml"), panel).unwrap();
    fs::write(here.join("scatter.toml"), "case = \"panel.toml\"\n[design]\nkind = \"fitted_scatter\"\nsamples = 400\n").unwrap();
    done(here, "sweep scatter.toml --out drawn --summary-only");
    let life = |folder: &str, key: &str| json(here.join(folder).join("sweep.json"))["life_cycles"][key].as_f64().unwrap();
    for key in ["p05", "p50", "p95"] {
        let [tests, drawn] = ["tests", "drawn"].map(|folder| life(folder, key));
        assert!((drawn / tests - 1.0).abs() < 0.04, "{key}: {tests} {drawn}");
    }
    // Without the fits of the specimens there is nothing to draw from.
    fs::remove_file(here.join("fit/fit.json")).unwrap();
    let output = perilife(here, "sweep scatter.toml --out drawn");
    assert_refused(&output, 4, &["fit.json", "cannot read the fits of the specimens"]);
}
