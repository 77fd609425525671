//! What jobs and callers may take: memory, time, disk, places; and what becomes of those who take more.

use std::fs;
use std::time::Duration;

use serde_json::{Value, json};
use tempfile::tempdir;

use super::crashes::SmallDisk;
use super::jobs::{with_each_store, with_store};
use super::queue::on_store;
use super::{FOR_PARAVIEW, QUICK, SLOW, of, tiny};
use crate::support::rows::assert_says;
use crate::support::server::{Server, in_folder, wait, within};

/// The quick plate with points of another spacing.
pub fn spaced(spacing_mm: f64) -> String {
    QUICK.replace("spacing_mm = 1.5", &format!("spacing_mm = {spacing_mm}\nsymmetry = \"off\""))
}

/// Waits until a look at a job shows what is looked for.
fn wait_for(service: &Server, job: &str, is_so: impl Fn(&Value) -> bool) {
    wait(job, || is_so(&service.get(job).json()));
}

/// A job that wants more memory or time than it may have ends alone, and says so; the others go on.
#[test]
fn a_job_ends_alone_at_its_limits() {
    with_store("limits", |place| {
        for (limit, text, title, words) in [
            (["--job-memory", "256"], spaced(0.12), "Too large", "memory limit exceeded (268 MB"),
            (["--job-hours", "0.001"], spaced(0.12), "Too slow", "--job-hours"),
        ] {
            // What is accepted may be more than a worker of a smaller machine has.
            let service = Server::start(place, &["--jobs", "0"]);
            let _worker = Server::worker(place, &[&["--jobs", "1"][..], &limit].concat());
            let large = service.submit("predictions", &of("large", &text));
            let next = service.submit("predictions", &of("next", QUICK));
            let ended = service.ended(&large);
            assert_eq!((&ended["state"], &ended["problem"]["title"]), (&"failed".into(), &title.into()), "{ended:#}");
            assert!(ended["problem"]["detail"].as_str().unwrap().contains(words), "{ended:#}");
            assert_eq!(ended["attempts"], 1);
            service.succeeded(&next);
        }
        let service = Server::start(place, &["--jobs", "1"]);
        service.succeeded(&service.submit("predictions", &of("counted", QUICK)));
        let counted = service.get("/metrics").text();
        assert_says(
            &counted,
            &["perilife_job_seconds_count", "perilife_queue_age_seconds 0", "perilife_disk_free_bytes{place=\"temporary\"}"],
        );
    });
}

/// A large plate tells how far it is and what is being done, and ends within 5 s when it or its service is asked to, while it is still
/// being built.
#[test]
fn a_large_plate_ends_when_it_is_asked_to() {
    let (_dir, mut service) = Server::alone(&["--jobs", "1"]);
    // Half a million points.
    let large = of("large", &spaced(0.12));
    let told = |job: &Value| job["progress"]["stage"].as_str().is_some_and(|stage| stage.ends_with('%'));
    let job = service.submit("predictions", &large);
    within(5, || wait_for(&service, &job, told));
    service.post(&format!("{job}/cancel"), &json!({})).expect(202);
    within(5, || wait_for(&service, &job, |job| job["state"] == "cancelled"));
    let job = service.submit("predictions", &large);
    wait_for(&service, &job, told);
    within(5, || service.stop());
}

/// Results that find no room are a counted failure that says what they need; the queue goes on meanwhile.
#[test]
fn a_full_temporary_disk_is_counted() {
    let Some(disk) = SmallDisk::mounted("40m") else { return };
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let full = disk.path().join("temporary");
    fs::create_dir(&full).unwrap();
    fs::write(full.join("ballast"), vec![1; 28 << 20]).unwrap();
    let missing = dir.path().join("missing");
    for (folder, words) in [(&full, "needs "), (&missing, "a worker cannot write its temporary folder")] {
        let start = |attempts: &str| {
            let folder = folder.to_str().unwrap();
            Server::start_with(&place, &["--jobs", "1", "--attempts", attempts], &[("TMPDIR", folder)])
        };
        let service = start("3");
        let large = service.submit("predictions", &of("large", &(spaced(0.7) + FOR_PARAVIEW)));
        let small = service.submit("predictions", &of("small", QUICK));
        if folder == &full {
            service.succeeded(&small);
        }
        let ended = service.ended(&large);
        assert_eq!((&ended["problem"]["title"], &ended["problem"]["status"]), (&"Given up".into(), &507.into()), "{ended:#}");
        let detail = ended["problem"]["detail"].as_str().unwrap();
        assert!(detail.contains(words) && detail.contains("after 3 tries"), "{detail}");
        assert!(!ended.to_string().contains(folder.to_str().unwrap()), "a folder of the server in {ended}");
        assert!(ended["failures"] == 2 && ended["last_failure"].as_str().unwrap().contains(words), "{ended:#}");
        assert_eq!(ended["attempts"], 3);
    }
}

/// A job whose worker is dead is cancelled and deleted at once, whatever the clock did meanwhile, and is taken up when it was set back.
#[test]
fn orphans_of_dead_workers_are_nobodys() {
    with_store("orphans", |place| {
        let service = Server::start(place, &["--jobs", "0"]);
        let lease = ["--jobs", "1", "--lease", "2", "--checkpoint-every", "0"];
        let jobs = [(); 3].map(|()| {
            let job = service.submit("predictions", &of("slow", SLOW));
            let mut worker = Server::worker(place, &lease);
            wait_for(&service, &job, |job| job["state"] == "running");
            worker.kill();
            job
        });
        // As if the clock had been set back by a day since the leases were granted.
        on_store(place, "UPDATE jobs SET lease_until_ms = lease_until_ms + 86400000");
        let cancelled = service.post(&format!("{}/cancel", jobs[0]), &json!({})).expect(202).json();
        assert_eq!(cancelled["state"], "cancelled");
        service.send("DELETE", &jobs[1], &[], b"").expect(204);
        let mut worker = Server::worker(place, &lease);
        wait_for(&service, &jobs[2], |job| job["attempts"] == 2);
        // As a checkpoint leaves it, just before the worker gives the job back.
        on_store(place, "UPDATE jobs SET attempts = 0 WHERE state = 'running'");
        worker.stop();
        let given_back = service.get(&jobs[2]).json();
        assert_eq!(given_back["state"], "queued", "{given_back:#}");
        on_store(place, "UPDATE jobs SET name = 'below zero' WHERE attempts < 0");
        assert_eq!(service.get(&jobs[2]).json()["name"], "slow");
    });
}

/// A clock that jumps by a year deletes nothing: only time during which a service ran counts.
#[test]
fn a_jump_of_the_clock_deletes_nothing() {
    with_each_store("jump", |place| {
        let mut service = Server::start(place, &["--jobs", "1"]);
        let job = service.submit("predictions", &of("quick", QUICK));
        service.succeeded(&job);
        service.stop();
        for year_ms in ["- 31536000000", "+ 31536000000"] {
            on_store(place, &format!("UPDATE clock SET seen_ms = seen_ms {year_ms}"));
            on_store(place, &format!("UPDATE jobs SET finished_ms = finished_ms {year_ms}"));
            // Kept for six minutes, which are longer than the longest step that is counted.
            let mut service = Server::start(place, &["--jobs", "1", "--keep-days", "0.0042"]);
            std::thread::sleep(Duration::from_secs(1));
            service.get(&job).expect(200);
            service.stop();
            on_store(place, "UPDATE clock SET counted_ms = 0");
            on_store(place, "UPDATE jobs SET finished_count_ms = 0");
        }
    });
}

/// What owners keep is bounded, and what they delete is given back to the disk.
#[test]
fn owners_have_so_much_space() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let start = |jobs: &str| Server::start(&place, &["--jobs", jobs, "--quota-mib", "8", "--keep-days", "1e-4"]);
    // What waits counts with what it may write, a text of 1 MB as well; what was cancelled, with what it keeps.
    let mut service = start("0");
    let long = format!("# {}\n{}", "x".repeat(1_000_000), tiny());
    let waiting: Vec<u16> = (0..20).map(|_| service.post("/v1/predictions", &of("long", &long)).status).collect();
    let accepted = waiting.iter().filter(|status| **status == 202).count();
    assert!((3..8).contains(&accepted) && waiting[accepted..].iter().all(|status| *status == 507), "{waiting:?}");
    let jobs = |service: &Server| -> Vec<String> {
        let list = service.get("/v1/predictions").json();
        let address = |job: &Value| format!("/v1/predictions/{}", job["id"].as_str().unwrap());
        list["items"].as_array().unwrap().iter().map(address).collect()
    };
    jobs(&service).iter().for_each(|job| drop(service.post(&format!("{job}/cancel"), &json!({})).expect(202)));
    let more = (0..20).filter(|_| service.post("/v1/predictions", &of("long", &long)).status == 202).count();
    assert!((1..accepted).contains(&more), "{accepted} and {more}");
    jobs(&service).iter().for_each(|job| drop(service.send("DELETE", job, &[], b"").expect(204)));
    // Asked again at the end: others may have been given less room meanwhile.
    let late = service.submit("predictions", &of("late", &tiny()));
    on_store(&place, "UPDATE stored SET most = 1");
    service.stop();
    let service = start("1");
    let ended = service.ended(&late);
    assert_eq!((&ended["state"], &ended["problem"]["status"]), (&"failed".into(), &507.into()), "{ended:#}");
    assert!(ended["problem"]["detail"].as_str().unwrap().contains("delete jobs"), "{ended:#}");
    let job = service.submit("predictions", &json!({ "input": QUICK, "files": { "large.csv": "7".repeat(6_000_000) } }));
    service.succeeded(&job);
    let refused = service.post("/v1/predictions", &json!({ "input": tiny(), "files": { "more.csv": "7".repeat(2_500_000) } }));
    assert!(refused.text().contains("delete jobs"), "{}", refused.text());
    refused.expect(507);
    // What was written last may stand in the log beside the file.
    let size_of = |name: &str| fs::metadata(dir.path().join(name)).map_or(0, |about| about.len());
    let size = || size_of("perilife.sqlite") + size_of("perilife.sqlite-wal");
    let full = size();
    service.send("DELETE", &job, &[], b"").expect(204);
    service.submit("predictions", &of("quick", QUICK));
    wait("it stays large", || size() <= full / 2);
}
