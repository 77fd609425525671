//! What jobs and callers may take: memory, time, disk, places; and what becomes of those who take more.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::tempdir;

use super::crashes::SmallDisk;
use super::jobs::{with_each_store, with_store};
use super::queue::{on_store, token};
use super::{FOR_PARAVIEW, QUICK, SLOW, of, tiny};
use crate::interface::cli::perilife;
use crate::support::server::{PATIENCE, Server, in_folder};

/// The quick plate with points of another spacing.
pub fn spaced(spacing_mm: f64) -> String {
    QUICK.replace("spacing_mm = 1.5", &format!("spacing_mm = {spacing_mm}\nsymmetry = \"off\""))
}

/// Waits until a look at a job shows what is looked for.
fn wait_for(service: &Server, job: &str, what: &str, is_so: impl Fn(&Value) -> bool) -> Duration {
    let begun = Instant::now();
    while !is_so(&service.get(job).json()) {
        assert!(begun.elapsed() < PATIENCE, "{job}: {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
    begun.elapsed()
}

/// A job that wants more memory or time than it may have ends alone, and says so; the others go on.
#[test]
fn a_job_ends_alone_at_its_limits() {
    with_store("limits", |place| {
        for (limit, text, title, words) in [
            (["--job-memory", "256"], spaced(0.12), "Too large", "more than the 268 MB of memory"),
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
        for line in
            ["perilife_job_seconds_count", "perilife_queue_age_seconds 0", "perilife_disk_free_bytes{place=\"temporary\"}"]
        {
            assert!(counted.contains(line), "{line} in {counted}");
        }
    });
}

/// A large plate tells how far it is, and ends within 5 s when it or its service is asked to, while it is still being built.
#[test]
fn a_large_plate_ends_when_it_is_asked_to() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let mut service = Server::start(&[&place[0], &place[1]], &["--jobs", "1"]);
    // Half a million points.
    let large = of("large", &spaced(0.12));
    let job = service.submit("predictions", &large);
    let told = wait_for(&service, &job, "progress", |job| job["progress"]["elapsed_s"].as_f64().is_some_and(|s| s > 0.0));
    assert!(told < Duration::from_secs(5), "{told:?}");
    service.post(&format!("{job}/cancel"), &json!({})).expect(202);
    let ended = wait_for(&service, &job, "cancelled", |job| job["state"] == "cancelled");
    assert!(ended < Duration::from_secs(5), "{ended:?}");
    let job = service.submit("predictions", &large);
    wait_for(&service, &job, "progress", |job| job["progress"]["elapsed_s"].as_f64().is_some_and(|s| s > 0.0));
    let begun = Instant::now();
    service.stop();
    assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
}

/// Results that find no room are a counted failure that says what they need; the queue goes on meanwhile.
#[test]
fn a_full_temporary_disk_is_counted() {
    let Some(disk) = SmallDisk::mounted() else { return };
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let full = disk.path().join("temporary");
    fs::create_dir(&full).unwrap();
    fs::write(full.join("ballast"), vec![1; 28 << 20]).unwrap();
    let missing = dir.path().join("missing");
    for (folder, words) in [(&full, "needs "), (&missing, "a worker cannot write its temporary folder")] {
        let start = |attempts: &str| {
            let folder = folder.to_str().unwrap();
            Server::start_with(&[&place[0], &place[1]], &["--jobs", "1", "--attempts", attempts], &[("TMPDIR", folder)])
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
            wait_for(&service, &job, "taken", |job| job["state"] == "running");
            worker.kill();
            job
        });
        // As if the clock had been set back by a day since the leases were granted.
        on_store(place, "UPDATE jobs SET lease_until_ms = lease_until_ms + 86400000");
        let cancelled = service.post(&format!("{}/cancel", jobs[0]), &json!({})).expect(202).json();
        assert_eq!(cancelled["state"], "cancelled");
        service.send("DELETE", &jobs[1], &[], b"").expect(204);
        let mut worker = Server::worker(place, &lease);
        wait_for(&service, &jobs[2], "taken up", |job| job["attempts"] == 2);
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
    let place = [place[0].as_str(), place[1].as_str()];
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
    let begun = Instant::now();
    while size() > full / 2 {
        assert!(begun.elapsed() < PATIENCE, "{full} bytes have become {}", size());
        std::thread::sleep(Duration::from_millis(200));
    }
}

/// Tokens of these names and roles, and a service that asks for them.
fn with_tokens<const N: usize>(place: &[&str], more: &[&str], names: [(&str, &str); N]) -> (Server, [String; N]) {
    let tokens = names.map(|(name, role)| token(place, name, role));
    (Server::start(place, &[&["--require-token"], more].concat()), tokens)
}

/// Bodies that trickle in keep nobody else waiting.
#[test]
fn slow_bodies_of_one_keep_nobody_waiting() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let names = [("reader", "read"), ("runner", "run")];
    let (service, [reader, runner]) = with_tokens(&[&place[0], &place[1]], &["--jobs", "0"], names);
    let address = service.url.trim_start_matches("http://").to_owned();
    let _trickling: Vec<TcpStream> = (0..24)
        .map(|_| {
            let mut stream = TcpStream::connect(&address).unwrap();
            write!(
                stream,
                "POST /v1/check HTTP/1.1\r\nHost: {address}\r\nAuthorization: bearer {reader}\r\nContent-Type: application/toml\r\n\
                 Content-Length: 1000000\r\n\r\na"
            )
            .unwrap();
            stream
        })
        .collect();
    std::thread::sleep(Duration::from_millis(500));
    let service = service.with_token(&runner);
    let begun = Instant::now();
    service.post("/v1/check", &of("quick", QUICK)).expect(200);
    assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
}

/// Streams of events of one take no places of others, and end with his token.
#[test]
fn streams_of_one_shut_nobody_out() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let place = [place[0].as_str(), place[1].as_str()];
    let names = [("reader", "read"), ("runner", "run")];
    let (service, [reader, runner]) = with_tokens(&place, &["--jobs", "0", "--connections", "100"], names);
    let service = service.with_token(&runner);
    let job = service.submit("predictions", &of("waits", QUICK));
    let address = service.url.trim_start_matches("http://").to_owned();
    let open = || {
        let mut stream = TcpStream::connect(&address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let head = format!("GET {job}/events HTTP/1.1\r\nHost: {address}\r\nAuthorization: BEARER {reader}\r\n\r\n");
        stream.write_all(head.as_bytes()).unwrap();
        let mut lines = BufReader::new(stream);
        let mut head = String::new();
        while !head.ends_with("\r\n\r\n") && lines.read_line(&mut head).unwrap() > 0 {}
        (lines, head)
    };
    let mut streams: Vec<_> = (0..90).map(|_| open()).collect();
    let admitted = streams.iter().filter(|(_, head)| head.starts_with("HTTP/1.1 200")).count();
    let refused = streams.iter().filter(|(_, head)| head.starts_with("HTTP/1.1 429")).count();
    assert_eq!((admitted, refused), (50, 40), "half of the connections");
    assert!(streams[0].1.to_lowercase().contains("x-accel-buffering: no"), "{}", streams[0].1);
    service.get("/healthz").expect(200);
    service.get(&job).expect(200);
    let removed = perilife(dir.path(), &[&["token", "remove", "reader"], &place[..]].concat());
    assert!(removed.status.success(), "{}", crate::interface::cli::texts(&removed).1);
    let begun = Instant::now();
    // The last piece of an answer in pieces is empty (RFC 9112, 7.1); the connection stays for the next request.
    let mut pieces = streams.swap_remove(0).0.lines();
    assert!(pieces.any(|line| line.unwrap() == "0"), "cut off");
    assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
}

/// Bodies that never come and connections that ask nothing keep nobody waiting, whether tokens are asked for or not.
#[test]
fn bodies_that_never_come_keep_nobody_waiting() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let secret = token(&[&place[0], &place[1]], "ann", "admin");
    for more in [&["--require-token"][..], &[]] {
        let service = Server::start(&[&place[0], &place[1]], &[&["--jobs", "0", "--connections", "100"], more].concat());
        let service = service.with_token(&secret);
        let address = service.url.trim_start_matches("http://").to_owned();
        let head =
            "POST /v1/check HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 60000\r\n\r\n{";
        for text in [head, "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 60000\r\n\r\n{", "GET"] {
            let mut waiting: Vec<TcpStream> = Vec::new();
            for _ in 0..300 {
                let mut stream = TcpStream::connect(&address).unwrap();
                let _ = stream.write_all(text.as_bytes());
                waiting.push(stream);
            }
            let begun = Instant::now();
            service.get("/healthz").expect(200);
            assert!(begun.elapsed() < Duration::from_secs(3), "{more:?} {text}: {:?}", begun.elapsed());
            // A body that somebody may send has seconds.
            while !service.try_send("GET", "/v1/jobs", &[], b"").is_ok_and(|answer| answer.status == 200) {
                assert!(begun.elapsed() < Duration::from_secs(8), "{more:?} {text}: {:?}", begun.elapsed());
                std::thread::sleep(Duration::from_millis(50));
            }
        }
    }
}

/// A form of one file of readings.
fn form(content: &str) -> String {
    format!("--XX\r\nContent-Disposition: form-data; name=\"file\"; filename=\"a.csv\"\r\n\r\n{content}\r\n--XX--\r\n")
}

/// Long lines and wide tables cost little, and what is looked at ends with its request and with the service.
#[test]
fn a_look_ends_with_its_request() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let mut service = Server::start(&[&place[0], &place[1]], &["--jobs", "0"]);
    let asked = |content: &str| {
        let begun = Instant::now();
        let kind = [("content-type", "multipart/form-data; boundary=XX")];
        let found = service.send("POST", "/v1/measured", &kind, form(content).as_bytes()).expect(200).json();
        assert!(begun.elapsed() < Duration::from_secs(4), "{:?} for {}", begun.elapsed(), &content[..60]);
        found["files"][0].clone()
    };
    for long in ["\"".repeat(1_000_000), "0,".repeat(1_000_000), "in ".repeat(300_000)] {
        let found = asked(&format!("cycles,crack_length_mm\n{long}"));
        assert!(!found["problems"].as_array().unwrap().is_empty(), "{found}");
    }
    asked(&(0..100_000).map(|i| format!("a{i},")).collect::<String>());
    let row = |start: String, cell: &dyn Fn(usize) -> String| (0..2000).fold(start, |row, i| row + "," + &cell(i)) + "\n";
    let rows = (0..300).map(|n| row((1000 * n).to_string(), &|_| format!("{}", 9.0 + 0.01 * f64::from(n)))).collect::<String>();
    let found = asked(&(row("cycles".to_owned(), &|i| format!("P{i} (mm)")) + &rows));
    assert_eq!((found["columns"]["layout"].as_str(), found["curves"].as_array().unwrap().len()), (Some("wide"), 2000));

    // Seconds of work that nobody waits for any more.
    let heavy = form(&format!("cycles,crack_length_mm\n{}", (0..1_500_000).map(|i| format!("{i},9\n")).collect::<String>()));
    let address = service.url.trim_start_matches("http://").to_owned();
    let send = || {
        let mut stream = TcpStream::connect(&address).unwrap();
        write!(stream, "POST /v1/measured HTTP/1.1\r\nHost: localhost\r\nContent-Type: multipart/form-data; boundary=XX\r\n")
            .unwrap();
        write!(stream, "Content-Length: {}\r\n\r\n{heavy}", heavy.len()).unwrap();
        stream
    };
    let looking = || service.children().len();
    let sent = send();
    let begun = Instant::now();
    while looking() == 0 {
        assert!(begun.elapsed() < PATIENCE, "no process looks");
    }
    drop(sent);
    let gone = Instant::now();
    while looking() > 0 {
        assert!(gone.elapsed() < Duration::from_secs(2), "a process looks for nobody");
    }
    let _sent = send();
    std::thread::sleep(Duration::from_millis(300));
    let begun = Instant::now();
    service.stop();
    assert!(begun.elapsed() < Duration::from_secs(13), "{:?}", begun.elapsed());
}

/// With all connections taken, those who watch over the service are answered all the same.
#[test]
fn health_is_always_answered() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let service = Server::start(&[&place[0], &place[1]], &["--jobs", "0", "--connections", "10"]);
    let address = service.url.trim_start_matches("http://").to_owned();
    let _idle: Vec<TcpStream> = (0..20)
        .map(|_| {
            let mut stream = TcpStream::connect(&address).unwrap();
            stream.write_all(b"GET / HTTP/1.1\r\nHost: local").unwrap();
            stream
        })
        .collect();
    std::thread::sleep(Duration::from_millis(200));
    let begun = Instant::now();
    for path in ["/healthz", "/readyz"] {
        service.get(path).expect(200);
    }
    assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
    let crowded = service.get("/v1/kinds");
    assert!(crowded.status == 200 || (crowded.status == 503 && crowded.header("retry-after").is_some()), "{}", crowded.status);
}

/// Without tokens nobody is let in who came through a proxy, unless the operator says that the proxy is to be believed.
#[test]
fn a_proxy_makes_nobody_an_admin() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let place = [place[0].as_str(), place[1].as_str()];
    let service = Server::start(&place, &["--jobs", "0"]);
    let secret = token(&place, "ann", "read");
    let bearer = format!("bEaReR {secret}");
    for header in ["forwarded", "via", "x-forwarded-for", "x-forwarded-host", "x-forwarded-proto", "x-real-ip"] {
        for value in ["10.0.0.7", "127.0.0.1"] {
            service.send("GET", "/v1/predictions", &[(header, value)], b"").expect(401);
        }
        service.send("GET", "/v1/predictions", &[(header, "1.2.3.4"), ("authorization", &bearer)], b"").expect(200);
    }
    service.get("/v1/predictions").expect(200);
    drop(service);
    let audit = dir.path().join("audit.jsonl");
    let more =
        ["--jobs", "0", "--trust-proxy", "--public-url", "https://life.example.org", "--audit-log", audit.to_str().unwrap()];
    let service = Server::start(&place, &more);
    let from = [("x-forwarded-for", "10.0.0.7, 192.0.2.4"), ("host", "life.example.org"), ("content-type", "application/json")];
    let body = of("quick", QUICK).to_string();
    let accepted = service.send("POST", "/v1/predictions", &from, body.as_bytes()).expect(202);
    assert!(accepted.header("location").unwrap().starts_with("https://life.example.org/v1/predictions/"));
    service.send("GET", "/v1/predictions", &[("host", "evil.example.org")], b"").expect(403);
    let lines: Vec<Value> = fs::read_to_string(&audit).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((&lines[0]["address"], &lines[0]["status"]), (&"192.0.2.4".into(), &202.into()), "{lines:?}");
    assert!(lines[0]["path"].as_str().unwrap().contains("/v1/predictions/0"), "{lines:?}");
    assert_eq!((lines.len(), &lines[1]["status"]), (2, &403.into()), "{lines:?}");
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
        let begun = Instant::now();
        idle.get(&format!("{job}?wait=50")).expect(200);
        assert!(begun.elapsed() < Duration::from_secs(5));
    });
}

const SCENE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 20\nlength_mm = 20\nthickness_mm = 1\n\
    cracks = [{ from_mm = [-3, 0], to_mm = [3, 0] }]\n[material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.3\n\
    [model]\nbond_law = \"two_parameter\"\nspacing_mm = 1.0\n[loading]\nkind = \"traction\"\nstress_mpa = 10\n\
    edges = [\"top\", \"bottom\"]\n[damage]\nlaw = \"none\"\n";

/// Every kind of job runs, has the files of its command, and is refused with wrong options.
#[test]
fn every_kind_of_job_runs() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let service = Server::start(&[&place[0], &place[1]], &["--jobs", "2"]);
    let sweep =
        "case = \"case.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"loading.stress_range_mpa\"\nvalues = [50, 60]\n";
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
        assert!(done["summary"].is_object(), "{done:#}");
        for file in files {
            assert!(!service.file(&job, file).is_empty(), "{collection}: {file}");
        }
        if collection == "sif" {
            let factors = done["summary"].to_string();
            assert!(factors.contains("\"ring\"") && !factors.contains("element_free"), "the method asked for alone: {factors}");
        }
        let refused = json!({ "name": "x", "input": QUICK, "options": { "out": "/tmp/x" } });
        service.post(&format!("/v1/{collection}"), &refused).expect(422);
    }
    let bad = json!({ "name": "sif", "input": QUICK, "options": { "method": ["magic"] } });
    assert!(service.post("/v1/sif", &bad).expect(422).text().contains("magic"));
    // Nothing on the disk of the server is read, whatever an input names.
    for name in ["/etc/passwd", "../../etc/passwd", "case.toml"] {
        let body = json!({ "name": "sweep", "input": sweep.replace("case.toml", name) });
        let refused = service.post("/v1/sweeps", &body).expect(422);
        assert!(refused.text().contains("was not sent along"), "{}", refused.text());
    }
}
