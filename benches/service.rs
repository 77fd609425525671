//! How fast does the service answer while a job runs, and how much more do two workers do than one?
//!
//! `cargo bench --profile dev --bench service`

#[expect(dead_code, reason = "tests use the rest of it")]
#[path = "../tests/support"]
mod support {
    pub mod installed;
    pub mod postgres;
    pub mod server;
}

use std::time::{Duration, Instant};

use serde_json::json;
use support::postgres::Postgres;
use support::server::{Server, in_folder};

/// Requests of mixed reads, and connections that send them.
const REQUESTS: usize = 10_000;
const CONNECTIONS: usize = 8;
/// Jobs by which throughputs are compared.
const JOBS: usize = 40;

const PANEL: &str = include_str!("../data/cases/virkler_panel.toml");

fn main() {
    reads();
    workers();
}

/// Mixed reads while a job runs, which is submitted again and again.
fn reads() {
    let folder = tempfile::tempdir().unwrap();
    let place = in_folder(folder.path());
    let service = Server::start(&[&place[0], &place[1]], &["--jobs", "1"]);
    let body = json!({ "name": "panel", "input": PANEL });
    let done = service.submit("predictions", &body);
    service.succeeded(&done);
    let running: Vec<String> = (0..100).map(|_| service.submit("predictions", &body)).collect();
    let paths = [
        "/v1/predictions?limit=20".to_owned(),
        done.clone(),
        running[0].clone(),
        format!("{done}/files/a_n.csv?points=200"),
        format!("{done}/files/result.json"),
        format!("{done}/remaining?crack_length_mm=20"),
        "/v1/service".to_owned(),
        "/v1/materials".to_owned(),
        "/".to_owned(),
        "/healthz".to_owned(),
    ];
    let begun = Instant::now();
    let mut times: Vec<Duration> = std::thread::scope(|scope| {
        let client = |number: usize| {
            let (service, paths) = (&service, &paths);
            move || -> Vec<Duration> {
                let ask = |i: usize| {
                    let begun = Instant::now();
                    service.get(&paths[(i + number) % paths.len()]).expect(200);
                    begun.elapsed()
                };
                (0..REQUESTS / CONNECTIONS).map(ask).collect()
            }
        };
        let clients: Vec<_> = (0..CONNECTIONS).map(|number| scope.spawn(client(number))).collect();
        clients.into_iter().flat_map(|client| client.join().unwrap()).collect()
    });
    let seconds = begun.elapsed().as_secs_f64();
    times.sort_unstable();
    let at = |share: f64| 1e3 * times[((times.len() - 1) as f64 * share) as usize].as_secs_f64();
    let finished = running.iter().filter(|job| service.get(job).json()["state"] == "succeeded").count();
    println!(
        "mixed reads    {REQUESTS} over {CONNECTIONS} connections while jobs run: {:.0}/s; p50 {:.2}, p99 {:.2}, longest {:.1} ms; \
         {finished} jobs done meanwhile",
        REQUESTS as f64 / seconds,
        at(0.5),
        at(0.99),
        at(1.0)
    );
}

/// Jobs a second of one and of two one-thread workers on one PostgreSQL.
fn workers() {
    let Some(postgres) = Postgres::start() else { return };
    let rate = |count: usize| {
        let url = postgres.database(&format!("workers_{count}"));
        let place = ["--database", url.as_str()];
        let service = Server::start(&place, &["--jobs", "0"]);
        let body = json!({ "name": "panel", "input": PANEL });
        let jobs: Vec<String> = (0..JOBS).map(|_| service.submit("predictions", &body)).collect();
        let begun = Instant::now();
        let _workers: Vec<Server> = (0..count).map(|_| Server::worker(&place, &["--jobs", "1", "--threads", "1"])).collect();
        jobs.iter().for_each(|job| drop(service.succeeded(job)));
        JOBS as f64 / begun.elapsed().as_secs_f64()
    };
    // In turn, so that what else the machine does falls on both.
    let rates = [rate(1), rate(2)];
    println!(
        "workers        {JOBS} jobs on PostgreSQL: one {:.3}/s, two {:.3}/s, ratio {:.2}",
        rates[0],
        rates[1],
        rates[1] / rates[0]
    );
}
