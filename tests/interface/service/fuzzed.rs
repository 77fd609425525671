//! Bodies and files that nobody meant: whatever comes in, the answer is one of the service's own, never a fault of the program.

use std::net::SocketAddr;
use std::num::NonZeroU32;
use std::sync::{Arc, LazyLock};

use assert_cmd::cargo::cargo_bin;
use axum::Router;
use axum::body::Body;
use axum::extract::ConnectInfo;
use axum::http::Request;
use perilife_base::machine::peak_mb;
use perilife_service::api::{App, Limits, Security, router};
use perilife_service::store::{Store, Upgrade, url_of_file};
use perilife_service::worker::Settings;
use serde_json::json;
use tempfile::tempdir;
use tower::ServiceExt;

use super::QUICK;
use crate::support::noise::Noise;
use crate::support::rows::rows;
use crate::support::server::multipart;

/// Memory that no flood of bodies may exceed, MB. A process of the tests has some 300 of its own.
const MEMORY_MB: f64 = 1500.0;

const CSV: &str = "specimen,cycles,crack_length_mm\nA,0,9.0\nA,1000,9.5\nA,2000,10.1\nA,3000,10.8\nA,4000,11.6\nA,5000,12.5\n\
                   B,0,9.0\nB,1100,9.5\nB,2100,10.1\nB,3300,10.8\nB,4100,11.6\nB,5600,12.5\n";
const WIDE: &str =
    "crack_length_mm;A;B\n9,0;0;0\n9,5;1000;1100\n10,1;2000;2100\n10,8;3000;3300\n11,6;4000;4100\n12,5;5000;5600\n";
const TEST: &str = "[measured]\nfiles = [\"curve.csv\"]\nfrom_crack_length_mm = 9\n[specimen]\nkind = \"middle_tension\"\nwidth_mm = 60\n\
    length_mm = 120\nthickness_mm = 2\ncrack_length_mm = 9\n[material]\nname = \"al2024-t3\"\n[loading]\nstress_range_mpa = 60\n\
    stress_ratio = 0.1\n[model]\nspacing_mm = 6\n[fit]\nparameters = [\"a\", \"p\"]\n";
const SCENE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 60\nthickness_mm = 2\n[material]\nname = \"al2024-t3\"\n\
    [loading]\nkind = \"displacement\"\ndisplacement_mm = 0.1\nedges = [\"top\", \"bottom\"]\nsteps = 10\n[model]\nspacing_mm = 6\n\
    [damage]\nlaw = \"critical_stretch\"\n";

/// Pieces that inputs trip over.
static TRAPS: LazyLock<Vec<String>> = LazyLock::new(|| rows("fuzzed", "traps"));

/// Random changes of a text that keep most of it.
struct Mutator(Noise);

impl Mutator {
    fn below(&mut self, most: usize) -> usize {
        ((1e9 * self.0.normal().abs()) as usize) % most.max(1)
    }

    fn mutated(&mut self, seed: &[u8]) -> Vec<u8> {
        let mut bytes = seed.to_vec();
        for _ in 0..=self.below(4) {
            let at = self.below(bytes.len() + 1);
            match self.below(8) {
                0 => drop(bytes.splice(at..at, TRAPS[self.below(TRAPS.len())].bytes())),
                1 => {
                    let until = (at + self.below(12)).min(bytes.len());
                    drop(bytes.splice(at..until, TRAPS[self.below(TRAPS.len())].bytes()));
                }
                2 => bytes.truncate(at),
                3 => {
                    let until = (at + self.below(40)).min(bytes.len());
                    drop(bytes.drain(at..until));
                }
                4 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
                5 if at < bytes.len() => bytes[at] = self.below(256) as u8,
                6 => {
                    let until = (at + self.below(60)).min(bytes.len());
                    let piece = bytes[at..until].to_vec();
                    let to = self.below(bytes.len() + 1);
                    drop(bytes.splice(to..to, piece));
                }
                _ => self.change_number(&mut bytes),
            }
        }
        bytes
    }

    /// Replaces a number by one of another size.
    fn change_number(&mut self, bytes: &mut Vec<u8>) {
        let digits: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i].is_ascii_digit()).collect();
        if digits.is_empty() {
            return;
        }
        let from = digits[self.below(digits.len())];
        let until = (from..bytes.len()).find(|&i| !bytes[i].is_ascii_digit()).unwrap_or(bytes.len());
        let power = self.below(40) as i32 - 20;
        drop(bytes.splice(from..until, format!("{:e}", self.0.normal() * 10f64.powi(power)).into_bytes()));
    }
}

/// Something to send: its inner text, which is changed for itself half of the time, and what is around it.
struct Seed {
    path: &'static str,
    kind: &'static str,
    inner: String,
    around: Around,
}

type Around = fn(&str) -> String;

fn seeds() -> Vec<Seed> {
    let quick = QUICK.replace("spacing_mm = 1.5", "spacing_mm = 6");
    let object = quick.parse::<toml::Table>().map(|table| json!({ "name": "x", "input": table }).to_string()).unwrap();
    let (json, toml, form) = ("application/json", "application/toml", "multipart/form-data; boundary=XX");
    let plain: Around = str::to_owned;
    let text: Around = |inner| json!({ "input": inner }).to_string();
    let seeds: [(&str, &str, &str, Around); 11] = [
        ("/v1/measured", form, CSV, |inner| multipart(&[("file", Some("curve.csv"), inner)])),
        ("/v1/measured", form, WIDE, |inner| multipart(&[("file", Some("curve.csv"), inner)])),
        ("/v1/measured", form, "PAR1 nothing PAR1", |inner| multipart(&[("file", Some("curve.parquet"), inner)])),
        ("/v1/check", json, &quick, text),
        ("/v1/check", json, &object, plain),
        ("/v1/check", toml, SCENE, plain),
        ("/v1/check", json, TEST, |inner| json!({ "input": inner, "files": { "curve.csv": CSV } }).to_string()),
        ("/v1/predictions", toml, &quick, plain),
        ("/v1/predictions", json, &object, |inner| {
            inner.replacen('{', "{\"calibration\":\"01a202b2-bf2d-75fe-996b-265c5720d3fc\",", 1)
        }),
        ("/v1/calibrations", json, CSV, |inner| json!({ "input": TEST, "files": { "curve.csv": inner } }).to_string()),
        ("/v1/calibrations", json, WIDE, |inner| json!({ "input": TEST, "files": { "curve.csv": inner } }).to_string()),
    ];
    seeds.into_iter().map(|(path, kind, inner, around)| Seed { path, kind, inner: inner.to_owned(), around }).collect()
}

/// Sends `count` changed bodies to a service without workers; returns how often each status came back.
async fn flood(service: Router, count: u64, first: u64) -> std::collections::BTreeMap<u16, u64> {
    let seeds = seeds();
    let address = SocketAddr::from(([127, 0, 0, 1], 9));
    let mut statuses = std::collections::BTreeMap::new();
    for number in first..first + count {
        let mut mutator = Mutator(Noise::new(number));
        let Seed { path, kind, inner, around } = &seeds[mutator.below(seeds.len())];
        let body = match mutator.below(4) {
            0 => mutator.mutated(around(inner).as_bytes()),
            _ => around(&String::from_utf8_lossy(&mutator.mutated(inner.as_bytes()))).into_bytes(),
        };
        let request =
            Request::post(*path).header("host", "localhost").header("content-type", *kind).extension(ConnectInfo(address));
        let answer = service.clone().oneshot(request.body(Body::from(body.clone())).unwrap()).await.unwrap();
        let status = answer.status().as_u16();
        *statuses.entry(status).or_default() += 1;
        let known = [200, 202, 400, 413, 422];
        assert!(known.contains(&status), "{status} for number {number}, {path}: {}", String::from_utf8_lossy(&body));
        if status >= 400 {
            let kind = answer.headers().get("content-type").unwrap();
            assert_eq!(kind, "application/problem+json", "number {number}");
        }
    }
    statuses
}

fn flooded(count: u64) {
    const PLENTY: NonZeroU32 = NonZeroU32::new(u32::MAX).unwrap();
    let folder = tempdir().unwrap();
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
    let statuses = runtime.block_on(async {
        let store = Store::open(&url_of_file(&folder.path().join("fuzz.sqlite")), 4, Upgrade::Allowed).await.unwrap();
        let limits = Limits {
            body_bytes: 1 << 20,
            points: 2000.0,
            queued: i64::MAX,
            requests_per_second: PLENTY,
            writes_per_second: PLENTY,
            ..Limits::default()
        };
        let workers = Settings { jobs: 0, program: cargo_bin("perilife"), ..Settings::default() };
        let service = router(App::new(store, limits, Security::default(), workers, Arc::default()));
        let halves = [0, 1].map(|half| tokio::spawn(flood(service.clone(), count / 2, half * (count / 2))));
        let mut all = std::collections::BTreeMap::new();
        for half in halves {
            for (status, times) in half.await.unwrap() {
                *all.entry(status).or_insert(0) += times;
            }
        }
        all
    });
    assert!(peak_mb() < MEMORY_MB, "{} MB", peak_mb());
    // The changes are such that much is still understood, and much is not.
    assert!(statuses[&200] > count / 50 && statuses[&422] > count / 50 && statuses[&400] > count / 50, "{statuses:?}");
}

#[test]
fn a_thousand_broken_bodies_break_nothing() {
    flooded(1000);
}

#[test]
#[ignore = "long: a hundred thousand bodies, each looked at by a process of its own, ten minutes"]
fn a_hundred_thousand_broken_bodies_break_nothing() {
    flooded(100_000);
}
