//! Who comes when, how many may wait, and what a repeated request finds.

use serde_json::{Value, json};
use tempfile::tempdir;

use super::crashes::undisturbed;
use super::jobs::{with_each_store, with_store};
use super::named::names;
use super::{QUICK, SLOW, of, test_of_quick, tiny};
use crate::interface::cli::{assert_refused, perilife};
use crate::support::desk::done;
use crate::support::server::{Answer, Server, wait};

/// A token of this name and role in the store at `place`.
pub fn token(place: &[impl AsRef<str>], name: &str, role: &str) -> String {
    let place: Vec<&str> = place.iter().map(AsRef::as_ref).collect();
    let (stdout, _) = done(std::path::Path::new("."), &[&["token", "add", name, "--role", role][..], &place].concat());
    stdout.trim().to_owned()
}

/// Somebody with many jobs does not keep the others waiting: owners take turns, each with his own jobs in his order.
#[test]
fn owners_take_turns() {
    with_each_store("turns", |place| {
        let tokens = ["ann", "bob", "cy"].map(|name| (name, token(place, name, "run")));
        let mut service = Server::start(place, &["--jobs", "0", "--require-token"]);
        let mut jobs: Vec<(String, String)> = Vec::new();
        for (owner, number) in [(0, 5), (1, 2), (2, 1)] {
            let (name, secret) = &tokens[owner];
            service = service.with_token(secret);
            jobs.extend((0..number).map(|i| (format!("{name} {i}"), service.submit("predictions", &of(name, &tiny())))));
        }
        let place_of = |(name, job): &(String, String)| (service.get(job).json()["position"].as_i64().unwrap(), name.clone());
        let mut queue: Vec<(i64, String)> = jobs.iter().map(place_of).collect();
        queue.sort();
        let names: Vec<&str> = queue.iter().map(|(_, name)| name.as_str()).collect();
        assert_eq!(names, ["ann 0", "bob 0", "cy 0", "ann 1", "bob 1", "ann 2", "ann 3", "ann 4"]);
        assert!(queue.iter().enumerate().all(|(place, (position, _))| *position == place as i64), "{queue:?}");

        let worker = Server::worker(place, &["--jobs", "1"]);
        let mut started: Vec<(Value, String)> =
            jobs.iter().map(|(name, job)| (service.succeeded(job)["started"].clone(), name.clone())).collect();
        started.sort_by_key(|(time, _)| time.as_str().map(str::to_owned));
        let order: Vec<&str> = started.iter().map(|(_, name)| name.as_str()).collect();
        assert_eq!(order, names, "run in the order of the queue");

        // Who asks for the next as soon as he has the last comes no oftener than the others, and who had nothing to do for a while
        // has no claim to catch up: his first job comes behind those of the turn at hand, his second behind the next turn's.
        drop(worker);
        let mut next: Vec<String> = Vec::new();
        for (name, secret) in &tokens {
            service = service.with_token(secret);
            next.extend((0..2).map(|_| service.submit("predictions", &of(name, QUICK))));
        }
        let places: Vec<i64> = next.iter().map(|job| service.get(job).json()["position"].as_i64().unwrap()).collect();
        // Ann has had five turns: the others begin with her fifth, she with her sixth.
        assert_eq!(places, [2, 5, 0, 3, 1, 4]);
    });
}

/// Fails unless the sum kept for each owner is that of what his jobs have.
fn sums_are_right(place: &[&str]) {
    let wrong =
        "SELECT COUNT(*) FROM stored WHERE bytes <> (SELECT COALESCE(SUM(bytes), 0) FROM jobs WHERE owner = stored.owner)";
    // Where one is wrong a token without a name, which the table refuses.
    on_store(place, &format!("INSERT INTO tokens (hash, name, role, created_ms) SELECT '', NULL, 'read', 0 WHERE ({wrong}) > 0"));
}

/// A submission costs the same however many jobs its owner has, and what he has is counted whoever wrote it.
#[test]
fn a_submission_costs_the_same_whatever_is_stored() {
    with_each_store("stored", |place| {
        let service = Server::start(place, &["--jobs", "1"]);
        let job = service.submit("predictions", &of("tiny", &tiny()));
        let id = service.succeeded(&job)["id"].as_str().unwrap().to_owned();
        let median_s = || {
            let submit = |_| {
                let begun = std::time::Instant::now();
                service.submit("predictions", &of("next", &tiny()));
                begun.elapsed().as_secs_f64()
            };
            let mut times: Vec<f64> = (0..9).map(submit).collect();
            times.sort_by(f64::total_cmp);
            times[4]
        };
        let before = median_s();
        let columns = "kind, name, owner, state, created_ms, started_ms, finished_ms, finished_count_ms, summary, bytes";
        let numbers = "WITH RECURSIVE numbers(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM numbers WHERE i < 20000)";
        on_store(
            place,
            &format!(
                "INSERT INTO jobs (id, {columns}) {numbers} SELECT '0' || CAST(i AS TEXT), {columns} FROM jobs, numbers WHERE id = '{id}'"
            ),
        );
        on_store(
            place,
            &format!(
                "INSERT INTO job_files (job, origin, name, media_type, size) SELECT other.id, f.origin, f.name, f.media_type, f.size
                 FROM job_files f, jobs other WHERE f.job = '{id}' AND other.id NOT LIKE '%-%'"
            ),
        );
        sums_are_right(place);
        let after = median_s();
        // A sum over all files took 100 ms more.
        assert!(after < 3.0 * before + 0.02, "{before} s, {after} s");
        sums_are_right(place);
    });
}

/// While another owner waits nobody has all workers: a run gives way at its checkpoint, and goes on to the same curve.
#[test]
fn a_run_gives_way_to_another_owner() {
    with_each_store("gives_way", |place| {
        let [ann, bob] = ["ann", "bob"].map(|name| token(place, name, "run"));
        let options = ["--jobs", "2", "--require-token", "--checkpoint-every", "0"];
        let service = Server::start(place, &options).with_token(&ann);
        let long: Vec<String> = (0..3).map(|_| service.submit("predictions", &of("long", SLOW))).collect();
        wait("two run", || names(&service, "/v1/predictions?state=running").len() == 2);
        let service = service.with_token(&bob);
        let short = service.submit("predictions", &of("short", &tiny()));
        service.succeeded(&short);
        let ended = long.iter().filter(|job| service.get(job).json()["state"] == "succeeded").count();
        assert_eq!(ended, 0, "the short job waited for a long one");
        let dir = tempdir().unwrap();
        let curve = undisturbed(dir.path(), SLOW);
        let claims: Vec<i64> = long.iter().map(|job| service.succeeded(job)["attempts"].as_i64().unwrap()).collect();
        assert!(claims.iter().sum::<i64>() > 3, "none has given way: {claims:?}");
        assert!(long.iter().all(|job| service.file(job, "a_n.csv") == curve), "another curve");
    });
}

/// However many ask in the same moment, no more jobs wait than may.
#[test]
fn the_queue_has_an_end_for_everybody_together() {
    with_store("bounded", |place| {
        let service = Server::start(place, &["--jobs", "0", "--queued", "6"]);
        let answers: Vec<Answer> = std::thread::scope(|scope| {
            let ask = || service.post("/v1/predictions", &of("case", QUICK));
            let clients: Vec<_> = (0..40).map(|_| scope.spawn(ask)).collect();
            clients.into_iter().map(|client| client.join().unwrap()).collect()
        });
        let count = |status: u16| answers.iter().filter(|answer| answer.status == status).count();
        assert_eq!((count(202), count(429)), (6, 34));
        assert_eq!(names(&service, "/v1/predictions?state=queued").len(), 6);
    });
}

/// A request that was accepted is answered with its job however often it comes, even if what it refers to has gone since.
#[test]
fn a_repeated_request_finds_its_job() {
    with_store("repeated", |place| {
        let service = Server::start(place, &["--jobs", "1"]);
        let curve = "cycles,crack_length_mm\n0,9\n20000,10\n37000,11\n51000,12\n63000,13\n";
        let fit = service
            .submit("calibrations", &json!({ "input": test_of_quick("method = \"handbook\""), "files": { "curve.csv": curve } }));
        let law = service.succeeded(&fit)["id"].clone();
        let case = QUICK.replace("[model]\nspacing_mm = 1.5\n", "[model]\nmethod = \"handbook\"\n");
        let body = json!({ "name": "case", "input": case, "calibration": law }).to_string();
        let ask = |key: &str| {
            let headers = [("content-type", "application/json"), ("idempotency-key", key)];
            service.send("POST", "/v1/predictions", &headers, body.as_bytes())
        };
        let job = ask("first").expect(202).json()["id"].clone();
        service.send("DELETE", &fit, &[], b"").expect(204);
        assert_eq!(ask("first").expect(200).json()["id"], job);
        ask("second").expect(422);
    });
}

/// A file that takes many parts comes back as it went in, and readers who never read cost no more than a part each.
#[test]
fn large_files_go_in_parts() {
    with_store("parts", |place| {
        let service = Server::start(place, &["--jobs", "0"]);
        // No two parts alike, no part's end at the end, and an empty file beside it.
        let numbers = (0_u32..2_500_000).map(|i| i.wrapping_mul(2_654_435_761));
        let large: String = numbers.map(|number| format!("{number:08x}")).collect();
        assert_eq!(large.len(), 20_000_000);
        let files = json!({ "large.csv": large, "empty.csv": "" });
        let job = service.submit("predictions", &json!({ "input": QUICK, "files": files }));
        let inputs = service.get(&job).json()["inputs"].clone();
        let sizes: Vec<_> = inputs.as_array().unwrap().iter().map(|file| (&file["name"], &file["bytes"])).collect();
        assert_eq!(sizes, [(&json!("empty.csv"), &json!(0)), (&json!("large.csv"), &json!(20_000_000))]);
        let came = |index: usize| service.get(inputs[index]["href"].as_str().unwrap()).expect(200);
        assert!(came(0).body.is_empty());
        let large_again = came(1);
        assert!(large_again.body == large.as_bytes(), "another file");
        assert_eq!(large_again.header("content-length"), Some("20000000"));

        let before = service.memory_mb();
        let idle: Vec<_> = (0..100).map(|_| service.ask_and_do_not_read(inputs[1]["href"].as_str().unwrap())).collect();
        // All of them are being served.
        std::thread::sleep(std::time::Duration::from_millis(500));
        let after = service.memory_mb();
        drop(idle);
        // Whole files would take 2000 MB.
        assert!(after - before < 300.0, "{before} MB before, {after} MB with 100 readers of 20 MB who do not read");
        // Who is cut off, because the file goes away under him, can tell.
        let mut reader = service.ask_and_do_not_read(inputs[1]["href"].as_str().unwrap());
        std::thread::sleep(std::time::Duration::from_millis(300));
        service.send("DELETE", &job, &[], b"").expect(204);
        let mut got = Vec::new();
        let _ = std::io::Read::read_to_end(&mut reader, &mut got);
        let head = String::from_utf8_lossy(&got[..400]).into_owned();
        assert!(head.contains("content-length: 20000000") && got.len() < 20_000_000, "{} bytes of {head}", got.len());
    });
}

/// What who has tables of an earlier version is told.
const LED_ON: &str = "start `perilife serve` once to migrate the schema";

/// Tables of another version are not touched, and who comes upon them is told what to do.
#[test]
fn a_store_of_another_version_is_refused() {
    with_each_store("other", |place| {
        let dir = tempdir().unwrap();
        Server::start(place, &["--jobs", "0"]).stop();
        for (version, remedy) in
            [(1, "or a new database"), (2, LED_ON), (3, LED_ON), (4, LED_ON), (5, LED_ON), (7, "or a new database")]
        {
            on_store(place, &format!("UPDATE perilife_schema SET version = {version}"));
            let refused = perilife(dir.path(), &[&["token"], place, &["list"]].concat());
            assert_refused(&refused, 4, &[&format!("are of version {version}"), remedy]);
        }
        on_store(place, "UPDATE perilife_schema SET version = 6");
        assert!(perilife(dir.path(), &[&["token"], place, &["list"]].concat()).status.success());
    });
}

/// What keeps the sums of owners, in SQLite and in PostgreSQL.
const SUMS: [&[&str]; 2] = [
    &["DROP TRIGGER jobs_in", "DROP TRIGGER jobs_of", "DROP TRIGGER jobs_out"],
    &["DROP TRIGGER jobs_stored ON jobs", "DROP FUNCTION count_stored"],
];

/// What the tables have beyond version 2.
const BEYOND_2: [&str; 15] = [
    "DROP TABLE stored",
    "ALTER TABLE jobs DROP COLUMN bytes",
    "ALTER TABLE jobs DROP COLUMN room",
    "ALTER TABLE jobs DROP COLUMN reason",
    "ALTER TABLE jobs DROP COLUMN note",
    "ALTER TABLE jobs DROP COLUMN archived",
    "DROP INDEX jobs_finished_count",
    "ALTER TABLE jobs DROP COLUMN failures",
    "ALTER TABLE jobs DROP COLUMN not_before_ms",
    "ALTER TABLE jobs DROP COLUMN lease_ms",
    "ALTER TABLE jobs DROP COLUMN spent_ms",
    "ALTER TABLE jobs DROP COLUMN finished_count_ms",
    "ALTER TABLE jobs DROP COLUMN report",
    "ALTER TABLE submissions DROP COLUMN options",
    "DROP TABLE clock",
];

/// The service leads tables of an earlier version on, with what is in them.
#[test]
fn an_earlier_store_is_led_on() {
    with_each_store("earlier", |place| {
        let mut service = Server::start(place, &["--jobs", "1"]);
        let job = service.submit("predictions", &of("quick", QUICK));
        let before = service.succeeded(&job);
        service.stop();
        for statement in SUMS[usize::from(place[0] == "--database")].iter().chain(&BEYOND_2) {
            on_store(place, statement);
        }
        on_store(place, "CREATE INDEX jobs_finished ON jobs (finished_ms)");
        on_store(place, "UPDATE perilife_schema SET version = 2");
        let service = Server::start(place, &["--jobs", "1"]);
        assert_eq!(service.get(&job).json(), before);
        // What was there before counts.
        on_store(place, "UPDATE stored SET bytes = bytes / (SELECT 1 FROM jobs WHERE bytes > 100000 AND bytes = stored.bytes)");
        service.succeeded(&service.submit("predictions", &of("quick", QUICK)));
    });
}

/// A job of a kind that is not run any more is ended in words and keeps nobody waiting; its place in the interface says the same.
#[test]
fn a_job_of_a_former_kind_is_refused() {
    with_each_store("former", |place| {
        let mut idle = Server::start(place, &["--jobs", "0"]);
        idle.submit("predictions", &of("old", QUICK));
        idle.stop();
        on_store(place, "UPDATE jobs SET kind = 'chart'");
        let service = Server::start(place, &["--jobs", "1"]);
        let job = service.submit("predictions", &of("quick", QUICK));
        service.succeeded(&job);
        assert!(service.get("/metrics").text().contains("perilife_jobs{state=\"failed\"} 1"));
        for answer in [service.get("/v1/charts"), service.post("/v1/charts", &of("new", QUICK))] {
            assert!(answer.expect(410).text().contains("run `perilife chart` on a command line"));
        }
        // Led back to a kind that is shown, it says why it ended.
        on_store(place, "UPDATE jobs SET kind = 'scene' WHERE kind = 'chart'");
        let ended = service.get("/v1/scenes").json()["items"][0].clone();
        assert_eq!(ended["state"], "failed", "{ended:#}");
        assert!(ended["problem"]["detail"].as_str().unwrap().contains("jobs of kind chart are not run any more"), "{ended:#}");
    });
}

/// A worker whose program is older than the tables takes no jobs, and goes on when they are its own again.
#[test]
fn a_worker_older_than_the_tables_takes_no_jobs() {
    with_each_store("older", |place| {
        let service = Server::start(place, &["--jobs", "1"]);
        on_store(place, "UPDATE perilife_schema SET version = 7");
        let job = service.submit("predictions", &of("quick", QUICK));
        std::thread::sleep(std::time::Duration::from_secs(2));
        assert_eq!(service.get(&job).json()["state"], "queued");
        service.get("/readyz").expect(503);
        service.get("/healthz").expect(200);
        on_store(place, "UPDATE perilife_schema SET version = 6");
        service.succeeded(&job);
        service.get("/readyz").expect(200);
    });
}

/// Runs a statement on the database of a store.
pub fn on_store(place: &[impl AsRef<str>], statement: &str) {
    use sqlx::Connection;
    let (kind, place) = (place[0].as_ref(), place[1].as_ref());
    let url = if kind == "--database" { place.to_owned() } else { format!("sqlite://{place}/perilife.sqlite") };
    sqlx::any::install_default_drivers();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        let mut connection = sqlx::AnyConnection::connect(&url).await.unwrap();
        sqlx::query(sqlx::AssertSqlSafe(statement.to_owned())).execute(&mut connection).await.unwrap();
        connection.close().await.unwrap();
    });
}
