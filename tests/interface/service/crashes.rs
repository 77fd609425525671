//! Processes and databases that die in the middle of everything: every accepted job ends with the curve of an undisturbed run, once.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

use tempfile::tempdir;

use super::jobs::{with_each_store, with_store};
use super::{QUICK, SLOW, of, test_of_quick};
use crate::interface::cli::perilife;
use crate::support::noise::Noise;
use crate::support::postgres::Postgres;
use crate::support::server::{Server, in_folder, wait};

/// The a-N curve of an undisturbed run by the command line.
pub fn undisturbed(folder: &Path, text: &str) -> Vec<u8> {
    fs::write(folder.join("case.toml"), text).unwrap();
    assert!(perilife(folder, "predict case.toml --out run").status.success());
    fs::read(folder.join("run/a_n.csv")).unwrap()
}

/// That of [`SLOW`], made once.
fn undisturbed_slow() -> Vec<u8> {
    static CURVE: OnceLock<Vec<u8>> = OnceLock::new();
    CURVE.get_or_init(|| undisturbed(tempdir().unwrap().path(), SLOW)).clone()
}

const EAGER: [&str; 8] = ["--jobs", "2", "--checkpoint-every", "0", "--lease", "2", "--attempts", "100"];

/// Jobs of two kinds in turn, and their undisturbed curves.
fn mixed(folder: &Path, count: usize) -> Vec<(&'static str, Vec<u8>)> {
    let (quick, slow) = ((QUICK, undisturbed(folder, QUICK)), (SLOW, undisturbed_slow()));
    (0..count).map(|i| if i % 3 == 0 { slow.clone() } else { quick.clone() }).collect()
}

fn submit(service: &Server, jobs: &[(&str, Vec<u8>)]) -> Vec<String> {
    jobs.iter().map(|(text, _)| service.submit("predictions", &of("case", text))).collect()
}

fn check(service: &Server, addresses: &[String], jobs: &[(&str, Vec<u8>)]) {
    for (address, (_, curve)) in addresses.iter().zip(jobs) {
        service.succeeded(address);
        assert!(service.file(address, "a_n.csv") == *curve, "{address}: another curve");
    }
    assert_eq!(service.get("/v1/predictions?limit=200").json()["items"].as_array().unwrap().len(), addresses.len(), "none twice");
}

#[test]
fn a_killed_server_loses_nothing() {
    with_store("killed", |place| {
        let dir = tempdir().unwrap();
        let jobs = mixed(dir.path(), 3);
        let mut service = Server::start(place, &EAGER);
        let addresses = submit(&service, &jobs);
        let mut noise = Noise::new(7);
        for _ in 0..4 {
            std::thread::sleep(Duration::from_millis(300 + (500.0 * noise.normal().abs()) as u64));
            service.kill();
            service = Server::start(place, &EAGER);
        }
        check(&service, &addresses, &jobs);
    });
}

/// A small disk of its own, which can be filled.
pub struct SmallDisk(tempfile::TempDir);

impl SmallDisk {
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn mounted(size: &str) -> Option<SmallDisk> {
        let folder = tempdir().unwrap();
        let mount = std::process::Command::new("mount")
            .args(["-t", "tmpfs", "-o", &format!("size={size}"), "tmpfs"])
            .arg(folder.path())
            .output();
        if mount.is_ok_and(|mount| mount.status.success()) {
            return Some(SmallDisk(folder));
        }
        println!("skipped: no disk can be mounted here");
        None
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = std::process::Command::new("umount").arg("-l").arg(self.0.path()).status();
    }
}

/// The disk fills up while jobs run: new ones are refused with 503, what is there can be read, and all goes on once there is room.
#[test]
fn a_full_disk_loses_nothing() {
    let Some(disk) = SmallDisk::mounted("120m") else { return };
    let dir = tempdir().unwrap();
    let jobs = mixed(dir.path(), 3);
    let service = Server::start(&in_folder(disk.path()), &EAGER);
    let large = serde_json::json!({ "input": QUICK, "files": { "large.csv": "7".repeat(3_000_000) } });
    let superfluous = [(); 4].map(|()| service.submit("predictions", &large));
    superfluous.iter().for_each(|job| drop(service.succeeded(job)));
    let addresses = submit(&service, &jobs);
    let ballast = disk.path().join("ballast");
    let mut file = fs::File::create(&ballast).unwrap();
    while std::io::Write::write_all(&mut file, &[0; 4096]).is_ok() {}
    // Or it would take its room until the end.
    drop(file);
    let refused = service.post("/v1/predictions", &of("case", QUICK)).expect(503);
    let words = "disk has 0 MB free, and 64 are needed";
    assert!(refused.header("retry-after").is_some() && refused.text().contains(words), "{}", refused.text());
    // All is read, and room can be made, which the next results take.
    for (path, status) in [(&*addresses[0], 200), ("/v1/jobs", 200), ("/readyz", 503)] {
        service.get(path).expect(status);
    }
    superfluous.iter().for_each(|job| drop(service.send("DELETE", job, &[], b"").expect(204)));
    // Long enough for claims to run out.
    std::thread::sleep(Duration::from_millis(3500));
    fs::remove_file(&ballast).unwrap();
    check(&service, &addresses, &jobs);
}

/// A worker of two is killed; the other goes on with its job from the checkpoint.
#[test]
fn another_worker_takes_over() {
    let Some(postgres) = Postgres::start() else { return };
    let curve = undisturbed_slow();
    let url = postgres.database("taken_over");
    let place = ["--database", url.as_str()];
    let service = Server::start(&place, &["--jobs", "0"]);
    let mut first = Server::worker(&place, &EAGER);
    let job = service.submit("predictions", &of("case", SLOW));
    // Far enough for a checkpoint, and not at the end.
    wait("on its way", || service.get(&job).json()["progress"]["share"].as_f64().unwrap_or(0.0) > 0.15);
    first.kill();
    let _second = Server::worker(&place, &EAGER);
    let events = service.events(&job, &[]);
    let done = service.succeeded(&job);
    assert!(service.file(&job, "a_n.csv") == curve, "another curve");
    assert_eq!(done["attempts"], 2, "{done:#}");
    // It began where the first had come to, not anew.
    let taken_up = events.iter().filter(|(name, _)| name == "job").filter_map(|(_, job)| job["progress"]["share"].as_f64());
    let taken_up: Vec<f64> = taken_up.collect();
    assert!(!taken_up.is_empty() && taken_up.iter().all(|share| *share > 0.05), "{taken_up:?}");
}

const READINGS: &str =
    "cycles,crack_length_mm\n0,9\n20000,10\n37000,11\n51000,12\n63000,13\n73000,14\n82000,15.2\n89000,16.4\n95000,18\n";

/// A server is killed within a calibration: the next one begins it anew, to the same fit.
#[test]
fn a_killed_calibration_is_made_again() {
    with_store("fit_killed", |place| {
        let dir = tempdir().unwrap();
        let folder = dir.path();
        let text = test_of_quick("spacing_mm = 0.25\nsymmetry = \"off\"");
        fs::write(folder.join("fit.toml"), &text).unwrap();
        fs::write(folder.join("curve.csv"), READINGS).unwrap();
        assert!(perilife(folder, "calibrate fit.toml --out fit").status.success());
        let mut service = Server::start(place, &EAGER);
        let body = serde_json::json!({ "name": "fit", "input": text, "files": { "curve.csv": READINGS } });
        let job = service.submit("calibrations", &body);
        wait("on its way", || service.get(&job).json()["progress"]["share"].as_f64().unwrap_or(0.0) > 0.02);
        service.kill();
        service = Server::start(place, &EAGER);
        let done = service.succeeded(&job);
        assert_eq!(done["attempts"], 2, "{done:#}");
        assert!(service.file(&job, "fitted.toml") == fs::read(folder.join("fit/fitted.toml")).unwrap(), "another fit");
    });
}

/// A worker that stood still for longer than its time is not dead: what it does afterwards must not touch its successor's result.
#[test]
fn a_worker_that_was_only_slow_is_fenced_off() {
    with_each_store("fenced", |place| {
        let curve = undisturbed_slow();
        let service = Server::start(place, &["--jobs", "0"]);
        let slow = Server::worker(place, &["--jobs", "1", "--lease", "2"]);
        let job = service.submit("predictions", &of("case", SLOW));
        wait("on its way", || service.get(&job).json()["progress"]["share"].as_f64().unwrap_or(0.0) > 0.02);
        stop_between_writings(&service, &slow);
        let mut other = Server::worker(place, &["--jobs", "1", "--lease", "2"]);
        let done = service.succeeded(&job);
        assert_eq!(done["attempts"], 2, "{done:#}");
        other.stop();
        slow.signal("-CONT");
        // It comes to the end of what it had, sees that it was not its own any more, and is of use again.
        let next = service.submit("predictions", &of("case", QUICK));
        service.succeeded(&next);
        assert_eq!(service.get(&job).json(), done, "touched");
        assert!(service.file(&job, "a_n.csv") == curve, "another curve");
    });
}

/// Stops a process where it does not hold the only right to write that a database file has: nobody could go on then.
fn stop_between_writings(service: &Server, process: &Server) {
    wait("stopped between two writings", || {
        process.signal("-STOP");
        let probe = service.post("/v1/predictions", &of("probe", QUICK));
        if probe.status != 202 {
            process.signal("-CONT");
            return false;
        }
        let job = format!("/v1/predictions/{}", probe.json()["id"].as_str().unwrap());
        service.send("DELETE", &job, &[], b"").expect(204);
        true
    });
}

/// The database goes away while jobs run: requests are told so, workers hold on, nothing is lost.
#[test]
fn a_database_that_is_gone_for_a_while_loses_nothing() {
    let Some(postgres) = Postgres::start() else { return };
    let dir = tempdir().unwrap();
    let jobs = mixed(dir.path(), 3);
    let url = postgres.database("gone");
    let service = Server::start(&["--database", &url], &EAGER);
    let addresses = submit(&service, &jobs);
    std::thread::sleep(Duration::from_millis(700));
    postgres.down();
    let answer = service.post("/v1/predictions", &of("case", QUICK)).expect(503);
    assert!(answer.header("retry-after").is_some() && answer.text().contains("cannot be used just now"), "{}", answer.text());
    for (path, status) in [("/healthz", 200), ("/readyz", 503), (&*addresses[0], 503)] {
        service.get(path).expect(status);
    }
    postgres.up().unwrap();
    wait("it is well again", || service.get("/readyz").status == 200);
    // Connections cut one by one while it stays up.
    let cut = "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = 'gone' AND pid <> pg_backend_pid()";
    for _ in 0..5 {
        std::thread::sleep(Duration::from_millis(150));
        postgres.sql(&url, cut).unwrap();
    }
    check(&service, &addresses, &jobs);
}

/// A job that kills its workers is given up in the end, and the others go on.
#[test]
fn a_job_that_nobody_survives_is_given_up() {
    with_store("given_up", |place| {
        let eager = ["--jobs", "1", "--lease", "2", "--attempts", "2", "--checkpoint-every", "1000"];
        let service = Server::start(place, &["--jobs", "0"]);
        let job = service.submit("predictions", &of("case", SLOW));
        for attempt in 1..=2 {
            let mut worker = Server::worker(place, &eager);
            wait("taken", || service.get(&job).json()["attempts"] == attempt);
            worker.kill();
        }
        let next = service.submit("predictions", &of("case", QUICK));
        let _worker = Server::worker(place, &eager);
        let ended = service.ended(&job);
        assert_eq!((&ended["state"], &ended["problem"]["title"]), (&"failed".into(), &"Given up".into()), "{ended:#}");
        service.succeeded(&next);
    });
}
