//! Long use: an hour of everything at once, thousands of jobs over dying workers, many readers.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::tempdir;

use super::crashes::{SmallDisk, undisturbed};
use super::limits::spaced;
use super::queue::on_store;
use super::{QUICK, SLOW, of, tiny};
use crate::support::noise::Noise;
use crate::support::postgres::Postgres;
use crate::support::server::{Server, in_folder};

/// One job of the soak: its body, and the curve that it must have.
struct Load {
    body: Value,
    curve: Vec<u8>,
}

fn loads(folder: &Path) -> Vec<Load> {
    let of_text = |text: &str| Load { body: of("load", text), curve: undisturbed(folder, text) };
    vec![of_text(QUICK), of_text(&tiny()), of_text(QUICK), of_text(SLOW)]
}

/// Submits under a key until it is accepted, whatever happens to the service meanwhile; the job's address.
fn accepted(service: &Server, body: &Value, key: &str) -> String {
    let headers = [("content-type", "application/json"), ("idempotency-key", key)];
    let begun = Instant::now();
    loop {
        let sent = service.try_send("POST", "/v1/predictions", &headers, body.to_string().as_bytes());
        match sent {
            Ok(answer) if [200, 202].contains(&answer.status) => {
                return format!("/v1/predictions/{}", answer.json()["id"].as_str().unwrap());
            }
            Ok(answer) => assert!([429, 503].contains(&answer.status), "{}: {}", answer.status, answer.text()),
            Err(_) => {}
        }
        assert!(begun.elapsed() < Duration::from_secs(300), "{key} is not accepted");
        std::thread::sleep(Duration::from_millis(200));
    }
}

/// Mixed load for an hour (or PERILIFE_SOAK_MINUTES) on a small disk, while workers are killed and stopped, the disk fills up and the
/// clock jumps: nothing is lost, nothing is there twice, and the process that answers takes no more memory at the end.
#[test]
#[ignore = "long: an hour; cargo test soak -- --ignored --nocapture"]
fn soak() {
    let minutes = std::env::var("PERILIFE_SOAK_MINUTES").ok().and_then(|text| text.parse().ok()).unwrap_or(60.0);
    let Some(disk) = SmallDisk::mounted("400m") else { return };
    let dir = tempdir().unwrap();
    let loads = loads(dir.path());
    let place = in_folder(disk.path());
    // What answers is never killed, so that its memory can be looked at.
    let service = Server::start(&place, &["--jobs", "0"]);
    let work = ["--jobs", "2", "--checkpoint-every", "0", "--lease", "2", "--attempts", "1000", "--keep-days", "1"];
    let mut worker = Server::worker(&place, &work);
    let (begun, until) = (Instant::now(), Duration::from_secs_f64(60.0 * minutes));
    let mut noise = Noise::new(41);
    let mut pick = |count: usize| (noise.normal().abs() * 1e4) as usize % count;
    let mut running: BTreeMap<String, usize> = BTreeMap::new();
    let (mut submitted, mut done, mut troubles) = (0, 0, [0; 4]);
    let mut memory: Vec<f64> = Vec::new();
    let mut next_trouble = Duration::from_secs(5);
    while begun.elapsed() < until || !running.is_empty() {
        while running.len() < 12 && begun.elapsed() < until {
            let load = pick(loads.len());
            running.insert(accepted(&service, &loads[load].body, &format!("soak {submitted}")), load);
            submitted += 1;
            // A request that is repeated finds the same job.
            if pick(5) == 0 {
                let again = accepted(&service, &loads[load].body, &format!("soak {}", submitted - 1));
                assert!(running.contains_key(&again), "twice");
            }
        }
        let ended: Vec<String> = running
            .keys()
            .filter(|job| {
                let answer = service.try_send("GET", job, &[], b"");
                answer.is_ok_and(|answer| {
                    answer.status == 200 && !["queued", "running"].contains(&answer.json()["state"].as_str().unwrap())
                })
            })
            .cloned()
            .collect();
        for job in ended {
            let load = running.remove(&job).unwrap();
            service.succeeded(&job);
            assert!(service.file(&job, "a_n.csv") == loads[load].curve, "{job}: another curve");
            done += 1;
            service.send("DELETE", &job, &[], b"");
        }
        if begun.elapsed() > next_trouble && begun.elapsed() < until {
            next_trouble = begun.elapsed() + Duration::from_secs(4 + pick(8) as u64);
            let trouble = pick(4);
            troubles[trouble] += 1;
            match trouble {
                0 => {
                    worker.kill();
                    worker = Server::worker(&place, &work);
                }
                1 => {
                    worker.stop();
                    worker = Server::worker(&place, &work);
                }
                2 => {
                    let ballast = disk.path().join("ballast");
                    let mut file = fs::File::create(&ballast).unwrap();
                    while std::io::Write::write_all(&mut file, &[0; 65_536]).is_ok() {}
                    drop(file);
                    std::thread::sleep(Duration::from_secs(3));
                    fs::remove_file(&ballast).unwrap();
                }
                // What was stored looks as it does after the clock was set by a day.
                _ => {
                    let by = if pick(2) == 0 { "+ 86400000" } else { "- 86400000" };
                    for statement in [
                        format!("UPDATE jobs SET lease_until_ms = lease_until_ms {by}, not_before_ms = not_before_ms {by}"),
                        format!("UPDATE clock SET seen_ms = seen_ms {by}"),
                    ] {
                        on_store(&place, &statement);
                    }
                }
            }
        }
        memory.push(service.memory_mb());
        std::thread::sleep(Duration::from_millis(100));
        assert!(begun.elapsed() < until + Duration::from_secs(600), "{} jobs do not end", running.len());
    }
    let quarter = memory.len() / 4;
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let (early, late) = (mean(&memory[quarter..2 * quarter]), mean(&memory[3 * quarter..]));
    println!(
        "{minutes} min: {submitted} jobs, {done} done; {} kills, {} stops, {} full disks, {} clock jumps; memory {early:.1} MB in the \
         second quarter, {late:.1} MB in the last",
        troubles[0], troubles[1], troubles[2], troubles[3]
    );
    assert_eq!(done, submitted, "lost");
    assert!(service.get("/v1/predictions").json()["items"].as_array().unwrap().is_empty(), "twice");
    assert!(late < 1.1 * early, "memory grows from {early} to {late} MB");
}

/// Four processes work for one PostgreSQL while one of them is killed now and then: of two thousand jobs none is lost, none runs twice.
#[test]
#[ignore = "long: some minutes; cargo test two_thousand_jobs -- --ignored --nocapture"]
fn two_thousand_jobs_over_dying_workers() {
    let Some(postgres) = Postgres::start() else { return };
    let url = postgres.database("many");
    let place = ["--database", url.as_str()];
    let service = Server::start(&place, &["--jobs", "0", "--queued", "3000"]);
    let work = ["--jobs", "1", "--lease", "2", "--attempts", "1000"];
    let mut workers: Vec<Server> = (0..4).map(|_| Server::worker(&place, &work)).collect();
    let (begun, count) = (Instant::now(), 2000);
    let body = of("tiny", &tiny());
    let jobs: Vec<String> = (0..count).map(|i| accepted(&service, &body, &format!("many {i}"))).collect();
    let mut noise = Noise::new(2000);
    let mut kills = 0;
    loop {
        let waiting = ["queued", "running"].map(|state| {
            let listed = service.get(&format!("/v1/predictions?limit=1&state={state}")).json();
            listed["items"].as_array().unwrap().len()
        });
        if waiting == [0, 0] {
            break;
        }
        std::thread::sleep(Duration::from_millis(500 + (1500.0 * noise.normal().abs()) as u64));
        let of = kills % workers.len();
        workers[of].kill();
        workers[of] = Server::worker(&place, &work);
        kills += 1;
        assert!(begun.elapsed() < Duration::from_secs(3000), "it does not end");
    }
    let all: std::collections::BTreeSet<&String> = jobs.iter().collect();
    assert_eq!(all.len(), count, "twice");
    for job in &jobs {
        assert_eq!(service.get(job).json()["state"], "succeeded", "{job}");
    }
    println!("{count} jobs over {kills} kills in {:.0} s", begun.elapsed().as_secs_f64());
}

const BATCH: usize = 12;

/// Time of a batch of jobs by so many workers of one thread each, in processes of their own.
fn batch_s(postgres: &Postgres, name: &str, workers: usize) -> f64 {
    let url = postgres.database(name);
    let place = ["--database", url.as_str()];
    let service = Server::start(&place, &["--jobs", "0"]);
    // Of about two seconds: long beside starting a process, short beside the patience of who waits.
    let body = of("batch", &spaced(0.5));
    let jobs: Vec<String> = (0..BATCH).map(|_| service.submit("predictions", &body)).collect();
    let begun = Instant::now();
    let _workers: Vec<Server> = (0..workers).map(|_| Server::worker(&place, &["--jobs", "1"])).collect();
    // Waiting shall cost nothing: whoever asks again and again takes a part of a core that two workers need, and one does not.
    jobs.iter().for_each(|job| while service.get(&format!("{job}?wait=20")).json()["finished"].is_null() {});
    let took = begun.elapsed().as_secs_f64();
    jobs.iter().for_each(|job| drop(service.succeeded(job)));
    took
}

/// Time of as many runs of the program alone, so many at a time, of one thread each.
fn bare_s(folder: &Path, at_once: usize) -> f64 {
    let file = folder.join("batch.toml");
    fs::write(&file, spaced(0.5)).unwrap();
    let next = AtomicUsize::new(0);
    let begun = Instant::now();
    std::thread::scope(|scope| {
        let run = || {
            while next.fetch_add(1, Ordering::Relaxed) < BATCH {
                let out = tempdir().unwrap();
                let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_perilife"));
                program.env("RAYON_NUM_THREADS", "1").arg("predict").arg(&file).arg("--out").arg(out.path().join("out"));
                assert!(program.output().unwrap().status.success());
            }
        };
        (0..at_once).for_each(|_| drop(scope.spawn(run)));
    });
    begun.elapsed().as_secs_f64()
}

/// How much faster two workers of one thread are than one, five times in turn; beside it how much faster two processes of the program
/// are without a service, which is what the machine gives.
#[test]
#[ignore = "long: some minutes on an idle machine; cargo test two_workers -- --ignored --nocapture"]
fn two_workers_are_faster_than_one() {
    let Some(postgres) = Postgres::start() else { return };
    let dir = tempdir().unwrap();
    let round = |i: usize| {
        let service = batch_s(&postgres, &format!("one_{i}"), 1) / batch_s(&postgres, &format!("two_{i}"), 2);
        let machine = bare_s(dir.path(), 1) / bare_s(dir.path(), 2);
        println!("two workers over one: {service:.2}; two processes without a service: {machine:.2}");
        service
    };
    let ratios: Vec<f64> = (0..5).map(round).collect();
    assert!(ratios.iter().all(|ratio| *ratio >= 1.7), "{ratios:?}");
}

/// Reads a second and the 99th percentile of their time while two jobs run.
#[test]
#[ignore = "long: needs an idle machine; cargo test reads_go_on -- --ignored --nocapture"]
fn reads_go_on_while_jobs_run() {
    let (_dir, service) = Server::alone(&["--jobs", "2"]);
    let jobs: Vec<String> = (0..20).map(|_| service.submit("predictions", &of("slow", SLOW))).collect();
    let stop = AtomicBool::new(false);
    let (begun, readers) = (Instant::now(), 4);
    let mut times: Vec<f64> = std::thread::scope(|scope| {
        let read = |job: &String| {
            let mut times = Vec::new();
            while !stop.load(Ordering::Relaxed) {
                let asked = Instant::now();
                service.get(job).expect(200);
                times.push(asked.elapsed().as_secs_f64());
            }
            times
        };
        let running: Vec<_> = jobs.iter().take(readers).map(|job| scope.spawn(move || read(job))).collect();
        std::thread::sleep(Duration::from_secs(10));
        stop.store(true, Ordering::Relaxed);
        running.into_iter().flat_map(|reader| reader.join().unwrap()).collect()
    });
    let per_second = times.len() as f64 / begun.elapsed().as_secs_f64();
    times.sort_by(f64::total_cmp);
    let p99_ms = 1e3 * times[times.len() * 99 / 100];
    println!("{per_second:.0} reads a second, 99 % within {p99_ms:.1} ms");
    jobs.iter().for_each(|job| drop(service.post(&format!("{job}/cancel"), &json!({}))));
    assert!(per_second >= 1000.0 && p99_ms < 50.0, "{per_second} reads a second, p99 {p99_ms} ms");
}
