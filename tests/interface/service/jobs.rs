//! Jobs: watched, cancelled, deleted, listed, submitted twice and by many at once.

use std::collections::HashSet;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::tempdir;

use super::named::names;
use super::{FOR_PARAVIEW, QUICK, SLOW, of, tiny};
use crate::support::postgres::Postgres;
use crate::support::server::{Server, in_folder, wait, within};

/// Does a test with each store that this machine has: claims, fences, clocks, tables and waiting are SQL and messages of each.
pub fn with_each_store(name: &str, test: impl Fn(&[&str])) {
    in_folder_of_its_own(&test);
    if let Some(postgres) = Postgres::start() {
        test(&["--database", &postgres.database(name)]);
    }
}

/// Does a test of what stands above the store, with the quicker one; `PERILIFE_TESTS_EVERY_STORE=1` (`.ci/run long`) asks for each.
pub fn with_store(name: &str, test: impl Fn(&[&str])) {
    if std::env::var_os("PERILIFE_TESTS_EVERY_STORE").is_some() {
        with_each_store(name, test);
    } else {
        in_folder_of_its_own(&test);
    }
}

fn in_folder_of_its_own(test: &impl Fn(&[&str])) {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    test(&[&place[0], &place[1]]);
}

#[test]
fn a_job_is_watched_to_its_end() {
    with_store("watched", |place| {
        let service = Server::start(place, &["--jobs", "1"]);
        // Finer points: a quick machine, too, tells more than three times how far it is.
        let job = service.submit("predictions", &of("slow", &SLOW.replace("spacing_mm = 0.8", "spacing_mm = 0.6")));
        let events = service.events(&job, &[]);
        let (name, last) = events.last().unwrap();
        assert!(name == "job" && last["state"] == "succeeded", "{last:#}");
        let shares: Vec<f64> =
            events.iter().filter(|(name, _)| name == "job").filter_map(|(_, job)| job["progress"]["share"].as_f64()).collect();
        assert!(shares.len() > 3 && shares.is_sorted(), "{shares:?}");

        // Pieces of the curve join, rise, and lie on the curve of the result.
        let mut grown = 0;
        let mut live: Vec<(f64, f64)> = Vec::new();
        for (_, piece) in events.iter().filter(|(name, _)| name == "growth") {
            assert_eq!(piece["from"].as_u64().unwrap(), grown);
            let column = |name: &str| -> Vec<f64> { serde_json::from_value(piece[name].clone()).unwrap() };
            let tips: Vec<Vec<[f64; 2]>> = serde_json::from_value(piece["tips"].clone()).unwrap();
            assert!(tips.iter().all(|tips| tips.len() == 2) && tips.len() == column("cycles").len());
            live.extend(column("cycles").into_iter().zip(column("crack_length_mm")));
            grown = live.len() as u64;
        }
        assert!(live.len() > 20 && live.is_sorted_by(|a, b| a.0 <= b.0 && a.1 <= b.1));
        let life = last["summary"]["life_cycles"].as_f64().unwrap();
        assert!(live.last().unwrap().0 <= life * 1.001);
        let is_picture =
            |(name, data): &(String, Value)| name == "picture" && data["href"].as_str().unwrap().ends_with("damage.svg");
        assert!(events.iter().any(is_picture));
        // Whoever comes late, or back with the last id, is told the end.
        let id = format!("{}.1.9.1", last["revision"]);
        for id in [None, Some(&*id), Some("3.1.9.1"), Some("what?")] {
            let headers: Vec<(&str, &str)> = id.into_iter().map(|id| ("last-event-id", id)).collect();
            let late = service.events(&job, &headers);
            assert_eq!(late.last().unwrap().1["state"], "succeeded");
        }
    });
}

#[test]
fn a_job_can_be_cancelled_and_deleted() {
    with_store("cancelled", |place| {
        let service = Server::start(place, &["--jobs", "1"]);
        let [running, waiting] = [(); 2].map(|()| service.submit("predictions", &of("slow", SLOW)));
        wait("it does not begin", || service.get(&running).json()["state"] != "queued");
        service.send("DELETE", &running, &[], b"").expect(409);
        assert_eq!(service.get(&waiting).json()["position"], 0);
        for job in [&waiting, &running] {
            service.post(&format!("{job}/cancel"), &json!({})).expect(202);
        }
        assert_eq!(service.ended(&waiting)["state"], "cancelled");
        assert_eq!(service.ended(&running)["state"], "cancelled");
        service.post(&format!("{running}/cancel"), &json!({})).expect(409);
        service.post(&format!("{running}/cancel?keep=yes"), &json!({})).expect(400);
        service.post(&format!("{running}/cancel?keep=true"), &json!({})).expect(409);
        service.get(&format!("{running}/files/a_n.csv")).expect(409);
        for job in [&waiting, &running] {
            service.send("DELETE", job, &[], b"").expect(204);
            service.get(job).expect(404);
        }
    });
}

#[test]
fn a_job_can_be_stopped_with_its_curve() {
    with_store("stopped", |place| {
        let service = Server::start(place, &["--jobs", "1"]);
        let whole = service.submit("predictions", &of("whole", SLOW));
        let whole = service.succeeded(&whole)["summary"].clone();
        let running = service.submit("predictions", &of("slow", SLOW));
        // A run has a curve of two rows when it has told of growth.
        wait("it grows", || service.get(&running).json()["progress"]["cycles"].as_f64().is_some_and(|cycles| cycles > 0.0));
        service.post(&format!("{running}/cancel?keep=true"), &json!({})).expect(202);
        let summary = service.succeeded(&running)["summary"].clone();
        assert!(summary["stop_reason"] == "stopped" && whole["stop_reason"] != "stopped", "{summary}");
        let curve = String::from_utf8(service.file(&running, "a_n.csv")).unwrap();
        let last: f64 = curve.lines().last().unwrap().split(',').next().unwrap().parse().unwrap();
        let [life, of_whole] = [&summary, &whole].map(|summary| summary["life_cycles"].as_f64().unwrap());
        assert!(0.0 < life && life < of_whole && (last / life - 1.0).abs() < 1e-6, "{last}, {life} of {of_whole}");
    });
}

#[test]
fn lists_come_in_parts() {
    with_store("listed", |place| {
        let service = Server::start(place, &["--jobs", "0"]);
        let jobs: Vec<String> = (0..7).map(|i| service.submit("predictions", &of(&format!("case {i}"), QUICK))).collect();
        let (mut seen, mut after) = (Vec::new(), String::new());
        loop {
            let page = service.get(&format!("/v1/predictions?limit=3{after}")).expect(200).json();
            seen.extend(page["items"].as_array().unwrap().iter().map(|job| job["name"].as_str().unwrap().to_owned()));
            let Some(next) = page["next"].as_str() else { break };
            after = format!("&after={next}");
        }
        assert_eq!(seen, (0..7).rev().map(|i| format!("case {i}")).collect::<Vec<_>>());
        service.post(&format!("{}/cancel", jobs[4]), &json!({})).expect(202);
        let names = |query: &str| names(&service, &format!("/v1/predictions?{query}"));
        assert_eq!((names("state=cancelled"), names("state=queued").len()), (vec!["case 4".to_owned()], 6));
        assert_eq!(service.get("/v1/calibrations").json()["items"], json!([]));
        for query in ["limit=0", "limit=1000", "limit=x", "state=asleep"] {
            service.get(&format!("/v1/predictions?{query}")).expect(400);
        }
    });
}

/// 100 clients at once, each sending everything twice as a bad network would: none lost, none run twice.
#[test]
fn many_clients_at_once_lose_nothing() {
    with_each_store("crowd", |place| {
        let service = Server::start(place, &["--jobs", "2"]);
        let hand = tiny();
        let accepted: Vec<String> = std::thread::scope(|scope| {
            let client = |number: usize| {
                let (service, hand) = (&service, &hand);
                move || {
                    let body = of(&format!("client {number}"), hand).to_string();
                    let key = format!("key {number}");
                    let headers = [("content-type", "application/json"), ("idempotency-key", key.as_str())];
                    let send = || {
                        let answer = service.send("POST", "/v1/predictions", &headers, body.as_bytes());
                        assert!([200, 202].contains(&answer.status), "{}", answer.text());
                        answer.json()["id"].as_str().unwrap().to_owned()
                    };
                    let (first, second) = (send(), send());
                    assert_eq!(first, second);
                    first
                }
            };
            let clients: Vec<_> = (0..100).map(|number| scope.spawn(client(number))).collect();
            clients.into_iter().map(|client| client.join().unwrap()).collect()
        });
        assert_eq!(accepted.iter().collect::<HashSet<_>>().len(), 100);
        for id in &accepted {
            let job = service.succeeded(&format!("/v1/predictions/{id}"));
            assert_eq!(job["attempts"], 1, "run once");
        }
        let other = [("content-type", "application/json"), ("idempotency-key", "key 7")];
        service.send("POST", "/v1/predictions", &other, of("another", &hand).to_string().as_bytes()).expect(409);
    });
}

/// Finished jobs go when their time is over; what waits or runs stays.
#[test]
fn results_are_kept_for_their_time() {
    with_store("expired", |place| {
        let service = Server::start(place, &["--jobs", "1", "--keep-days", "2e-5"]);
        let job = service.submit("predictions", &of("quick", QUICK));
        let begun = Instant::now();
        wait("it is kept for ever", || service.get(&job).status == 404);
        assert!(begun.elapsed() > Duration::from_secs_f64(2e-5 * 86_400.0), "it went too early");
    });
}

/// A process that is asked to stop gives its jobs back; the next one goes on with them.
#[test]
fn a_stop_loses_nothing() {
    with_store("stopped", |place| {
        let mut service = Server::start(place, &["--jobs", "1", "--checkpoint-every", "0"]);
        let job = service.submit("predictions", &of("slow", SLOW));
        wait("it does not begin", || service.get(&job).json()["progress"]["share"].as_f64().unwrap_or(0.0) >= 0.02);
        service.stop();
        let service = Server::start(place, &["--jobs", "1"]);
        let done = service.succeeded(&job);
        assert_eq!(done["attempts"], 2, "{done:#}");
    });
}

/// A look that waits comes back when the job has ended.
#[test]
fn a_look_waits_for_the_end() {
    with_each_store("waits", |place| {
        let service = Server::start(place, &["--jobs", "1"]);
        let job = service.submit("predictions", &of("quick", QUICK));
        assert_eq!(service.get(&format!("{job}?wait=50")).expect(200).json()["state"], "succeeded");
        service.get(&format!("{job}?wait=51")).expect(400);
        let idle = Server::start(place, &["--jobs", "0"]);
        within(5, || idle.get(&format!("{job}?wait=50")).expect(200));
    });
}

const SCENE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 20\nlength_mm = 20\nthickness_mm = 1\n\
    cracks = [{ from_mm = [-3, 0], to_mm = [3, 0] }]\n[material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.3\n\
    [model]\nbond_law = \"two_parameter\"\nspacing_mm = 1.0\n[loading]\nkind = \"traction\"\nstress_mpa = 10\n\
    edges = [\"top\", \"bottom\"]\n[damage]\nlaw = \"none\"\n";

/// Every kind of job runs, has the files of its command, and is refused with wrong options; a sweep needs no folders: what it names comes
/// as files under their own names.
#[test]
fn every_kind_of_job_runs() {
    let (_dir, service) = Server::alone(&["--jobs", "2"]);
    let sweep = "case = \"../cases/case.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"loading.stress_range_mpa\"\nvalues = [50, 60]\n";
    for (collection, body, files) in [
        ("scenes", of("scene", &(SCENE.to_owned() + FOR_PARAVIEW)), vec!["result.json", "history.csv", "paraview.zip"]),
        (
            "sweeps",
            json!({ "name": "sweep", "input": sweep, "files": { "case.toml": QUICK } }),
            vec!["sweep.csv", "sweep.json", "life.svg", "cases.zip"],
        ),
        ("sif", json!({ "name": "sif", "input": QUICK, "options": { "method": ["ring"] } }), vec!["result.json"]),
    ] {
        let job = service.submit(collection, &body);
        let done = service.succeeded(&job);
        let found: Vec<&str> = done["files"].as_array().unwrap().iter().map(|file| file["name"].as_str().unwrap()).collect();
        assert!(files.iter().all(|file| found.contains(file)), "{collection}: {found:?}");
        for file in files {
            assert!(!service.file(&job, file).is_empty(), "{collection}: {file}");
        }
        let summary = done["summary"].to_string();
        assert!(match collection {
            "sif" => summary.contains("\"ring\"") && !summary.contains("element_free"),
            // Nobody asked for fields of all moments.
            "sweeps" => summary.contains("\"cases\":2") && !found.iter().any(|name| name.contains("paraview")),
            _ => done["summary"].is_object(),
        });
        let refused = json!({ "name": "x", "input": QUICK, "options": { "out": "/tmp/x" } });
        service.post(&format!("/v1/{collection}"), &refused).expect(422);
    }
    let bad = json!({ "name": "sif", "input": QUICK, "options": { "method": ["magic"] } });
    assert!(service.post("/v1/sif", &bad).expect(422).text().contains("magic"));
    // Nothing on the disk of the server is read, whatever an input names.
    for name in ["/etc/passwd", "../../etc/passwd", "case.toml"] {
        let body = json!({ "name": "sweep", "input": sweep.replace("../cases/case.toml", name) });
        let refused = service.post("/v1/sweeps", &body).expect(422);
        assert!(refused.text().contains("was not uploaded"), "{}", refused.text());
    }
}
