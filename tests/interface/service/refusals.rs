//! What the service refuses, in the words of the command line, and how it guards its door.

use std::fs;

use serde_json::{Value, json};
use tempfile::tempdir;

use super::{QUICK, of};
use crate::interface::cli::{perilife, texts};
use crate::support::rows::assert_says;
use crate::support::server::{Server, in_folder};

#[test]
fn wrong_input_is_refused_in_the_words_of_the_command() {
    let dir = tempdir().unwrap();
    let folder = dir.path();
    let place = in_folder(&folder.join("service"));
    let service = Server::start(&place, &["--jobs", "0"]);
    let wrong = [
        QUICK.replace("crack_length_mm = 9", "crack_length_mm = 90"),
        QUICK.replace("width_mm", "widths_mm"),
        QUICK.replace("\"al2024-t3\"", "\"adamantium\""),
        QUICK.replace("[loading]", "[loading"),
        QUICK.replace("stress_ratio = 0.1", "stress_ratio = 2"),
        QUICK.replace("a = 6450.0\n", ""),
        QUICK.replace("[stop]", "[halt]"),
    ];
    for text in wrong {
        fs::write(folder.join("case.toml"), &text).unwrap();
        let output = perilife(folder, "predict case.toml --out out");
        assert_eq!(output.status.code(), Some(2));
        let stderr = texts(&output).1;
        let said = stderr.trim_start_matches("error: ").trim();
        let said = said.split_once(": ").unwrap();
        for path in ["/v1/predictions", "/v1/check"] {
            let answer = service.post(path, &of("case", &text)).expect(422);
            assert_eq!(answer.header("content-type"), Some("application/problem+json"));
            let problem = answer.json();
            assert_eq!(problem["detail"], said.1, "{path}");
            let line =
                problem["input"]["line"].as_u64().map_or_else(|| "case.toml".to_owned(), |line| format!("case.toml:{line}"));
            assert_eq!(line, said.0);
        }
    }
    let two = QUICK.replace("width_mm", "breadth_mm");
    let detail = service.post("/v1/check", &of("case", &two)).expect(422).json()["detail"].clone();
    assert!(detail.as_str().unwrap().starts_with("2 mistakes\n1. "), "{detail}");
    assert_eq!(service.get("/v1/predictions").json()["items"], json!([]), "nothing of it is kept");
}

#[test]
fn requests_that_cannot_be_read_are_refused() {
    let (_dir, service) = Server::alone(&["--jobs", "0", "--body-mib", "1", "--points", "100000"]);
    let json = "application/json";
    let form = "multipart/form-data; boundary=XX";
    let fine = QUICK.replace("spacing_mm = 1.5", "spacing_mm = 0.1");
    let cases: Vec<(&str, &str, Vec<u8>, u16, &str)> = vec![
        ("/v1/predictions", json, b"{".to_vec(), 400, "not JSON"),
        ("/v1/predictions", json, b"{\"input\": 3}".to_vec(), 400, "neither text nor an object"),
        ("/v1/predictions", json, b"{\"input\": {\"a\": null}}".to_vec(), 400, "no form in TOML"),
        ("/v1/predictions", json, b"{}".to_vec(), 400, "no `input`"),
        ("/v1/predictions", json, b"{\"inputs\": \"\"}".to_vec(), 400, "unknown field `inputs`"),
        ("/v1/predictions", json, vec![b'['; 100_000], 400, "not JSON"),
        ("/v1/check", json, format!("{{\"input\":{{\"a\":[{}0]}}}}", "0,".repeat(250_000)).into_bytes(), 413, "more than 200000 parts"),
        ("/v1/predictions", json, vec![b' '; 2 << 20], 413, "larger than the 1048576 bytes this server takes"),
        ("/v1/predictions", json, of("case\n", QUICK).to_string().into_bytes(), 422, "is no name"),
        ("/v1/predictions", json, of("case", &fine).to_string().into_bytes(), 422, "model.spacing_mm = 0.1: gives "),
        ("/v1/check", json, of("case", &fine).to_string().into_bytes(), 422, "limit 1.000e5"),
        ("/v1/predictions", json, json!({ "input": QUICK, "calibration": "no" }).to_string().into_bytes(), 422, "is no calibration here"),
        ("/v1/predictions", json, of("case", &QUICK.replace("al2024-t3", "../../etc/passwd")).to_string().into_bytes(), 422, "was not uploaded"),
        ("/v1/predictions", json, of("case", &QUICK.replace("a = 6450.0\np = 2.86\nhorizon_mm = 3.015", "fitted = \"/etc/passwd\"")).to_string().into_bytes(), 422, "was not uploaded"),
        ("/v1/predictions", "application/toml", b"\xff\xfe".to_vec(), 400, "not UTF-8"),
        ("/v1/measured", form, b"--XX\r\n".to_vec(), 400, "cannot be read"),
        ("/v1/measured", form, b"--XX--\r\n".to_vec(), 400, "no `file`"),
        ("/v1/measured", json, b"{}".to_vec(), 400, "no multipart form"),
        ("/v1/measured", form, b"--XX\r\nContent-Disposition: form-data; name=\"length_unit\"\r\n\r\nfoot\r\n--XX\r\nContent-Disposition: form-data; name=\"file\"; filename=\"a\"\r\n\r\nx\r\n--XX--\r\n".to_vec(), 422, "is not a known unit"),
        ("/v1/nothing", json, b"{}".to_vec(), 404, "no such address"),
        ("/nothing", json, b"{}".to_vec(), 404, "no such address"),
        ("/v1/kinds", json, b"{}".to_vec(), 405, "does not take that method"),
    ];
    for (path, kind, body, status, words) in cases {
        let answer = service.send("POST", path, &[("content-type", kind)], &body);
        assert_eq!(answer.status, status, "{path}: {}", answer.text());
        assert_eq!(answer.header("content-type"), Some("application/problem+json"), "{path} {status}");
        let problem = answer.json();
        assert!(problem["detail"].as_str().unwrap().contains(words), "{words} in {problem}");
        assert!(problem["status"] == status && !problem["title"].as_str().unwrap().is_empty());
    }
    service.get("/v1/predictions?after=%00").expect(400);
    let nul = "/v1/predictions/01a202b2-bf2d-75fe-996b-265c5720d3fc/files/%00";
    for path in [
        nul,
        "/v1/predictions/%00",
        "/v1/predictions/%00/live/damage.svg",
        "/v1/predictions/no",
        "/v1/predictions/no/events",
        "/v1/predictions/no/files/a_n.csv",
        "/v1/predictions/no/live/damage.svg",
        "/v1/predictions/no/files/..%2f..%2fetc%2fpasswd",
        "/v1/predictions/no/remaining?crack_length_mm=1",
        "/../Cargo.toml",
        "/%2e%2e/Cargo.toml",
    ] {
        service.get(path).expect(404);
    }
    service.get("/healthz").expect(200);
}

/// What a browser is told, and what it is not allowed to do for pages of others.
#[test]
fn other_origins_are_kept_out() {
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    let body = of("case", QUICK).to_string();
    let sent = |headers: &[(&str, &str)]| {
        service
            .send("POST", "/v1/predictions", &[&[("content-type", "application/json")], headers].concat(), body.as_bytes())
            .status
    };
    let own = service.url.clone();
    assert_eq!(sent(&[("origin", &own)]), 202);
    for origin in ["https://example.org", "null", "http://127.0.0.1:1"] {
        assert_eq!(sent(&[("origin", origin)]), 403, "{origin}");
    }
    for host in ["example.org", "127.0.0.1.example.org", "10.0.0.1:8080"] {
        assert_eq!(service.send("GET", "/v1/predictions", &[("host", host)], b"").status, 403, "{host}");
    }
    for host in ["localhost:8080", "127.0.0.1", "[::1]:99"] {
        assert_eq!(service.send("GET", "/v1/predictions", &[("host", host)], b"").status, 200, "{host}");
    }
    for path in ["/", "/v1/service", "/docs/", "/openapi.json", "/no"] {
        let answer = service.get(path);
        let policy = answer.header("content-security-policy").unwrap();
        assert!(policy.starts_with("default-src 'none'") && policy.contains("frame-ancestors 'none'"), "{policy}");
        assert!(!policy.contains("unsafe-eval"), "{policy}");
        assert_eq!(answer.header("x-content-type-options"), Some("nosniff"));
    }
}

/// The description names every route that the service has, and Prometheus can read what it counts.
#[test]
fn the_service_describes_itself() {
    let (dir, service) = Server::alone(&["--jobs", "0"]);
    let description = service.get("/openapi.json").expect(200).json();
    let paths: Vec<&String> = description["paths"].as_object().unwrap().keys().collect();
    for path in ["/v1/check", "/v1/measured", "/v1/materials", "/v1/kinds", "/v1/{collection}", "/v1/{collection}/{id}/events"] {
        assert!(paths.iter().any(|known| *known == path), "{path} in {paths:?}");
    }
    assert!(service.get("/docs/").text().contains("swagger"));
    let materials = service.get("/v1/materials").json();
    let aluminium =
        materials["materials"].as_array().unwrap().iter().find(|material| material["name"] == "al2024-t3").unwrap().clone();
    assert_eq!(aluminium["youngs_modulus_gpa"]["value"], 73.1);
    let listed: Value = serde_json::from_str(&texts(&perilife(dir.path(), "list --json")).0).unwrap();
    let kinds = service.get("/v1/kinds").json();
    assert_eq!((&kinds["laws"], &kinds["retardations"]), (&listed["laws"], &listed["retardations"]));
    // All but what the service does not run.
    let of_studies =
        "verify NAME, validate NAME, test.kind, chart SCENE, method of the chart, status of the chart, stability NAME";
    let is_its_own = |line: &&Value| of_studies.split(", ").all(|study| line["key"] != *study);
    let listed: Vec<&Value> = listed["kinds"].as_array().unwrap().iter().filter(is_its_own).collect();
    assert_eq!(kinds["kinds"].as_array().unwrap().iter().collect::<Vec<_>>(), listed);
    service.submit("predictions", &of("case", QUICK));
    let counted = service.get("/metrics").text();
    assert_says(
        &counted,
        &[
            "perilife_http_requests_total{route=\"/v1/{collection}\",method=\"POST\",status=\"202\"} 1",
            "perilife_jobs{state=\"queued\"} 1",
        ],
    );
}

/// Who opens connections and says nothing is shown out; others are served meanwhile.
#[test]
fn idle_talkers_do_not_block_the_door() {
    use std::io::Read;
    let (_dir, service) = Server::alone(&["--jobs", "0", "--connections", "40"]);
    let begun = std::time::Instant::now();
    let mut idle: Vec<_> = (0..39).map(|_| service.connect(b"GET /healthz HTTP/1.1\r\nHost: local")).collect();
    service.get("/healthz").expect(200);
    for stream in &mut idle {
        // An answer that says so, or nothing; then the end.
        let mut rest = Vec::new();
        stream.read_to_end(&mut rest).unwrap();
        assert!(rest.is_empty() || rest.starts_with(b"HTTP/1.1 4"), "{}", String::from_utf8_lossy(&rest));
    }
    let seconds = begun.elapsed().as_secs_f64();
    assert!((9.0..60.0).contains(&seconds), "{seconds} s");
}

/// A refusal that does not look at the body leaves the connection to the next request, however late the body comes; where it does
/// not, the answer says so.
#[test]
fn a_refused_body_does_not_cut_off_the_next_request() {
    use std::io::{BufRead, BufReader, Read, Write};
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    let mut stream = service.connect(b"");
    let mut lines = BufReader::new(stream.try_clone().unwrap());
    let mut head = || {
        let head: Vec<String> = lines.by_ref().lines().map(Result::unwrap).take_while(|line| !line.is_empty()).collect();
        let length =
            head.iter().find_map(|line| line.strip_prefix("content-length: ")).map_or(0, |length| length.parse().unwrap());
        lines.read_exact(&mut vec![0; length]).unwrap();
        head
    };
    for path in ["/v1/nothing", "/v1/kinds"] {
        write!(stream, "POST {path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\n").unwrap();
        std::thread::sleep(std::time::Duration::from_millis(300));
        write!(stream, "{{}}").unwrap();
        assert!(head()[0].starts_with("HTTP/1.1 40"), "{path}");
        write!(stream, "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
        assert_eq!(head()[0], "HTTP/1.1 200 OK", "{path}");
    }
    write!(stream, "POST /v1/nothing HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n\r\n").unwrap();
    let refused = head();
    assert!(refused[0].contains("404") && refused.contains(&"connection: close".to_owned()), "{refused:?}");
}

/// More than a caller may ask for is refused with the time after which he may ask again.
#[test]
fn callers_are_held_to_their_limits() {
    let (_dir, service) = Server::alone(&["--jobs", "0", "--queued", "3", "--requests-per-second", "50"]);
    let statuses: Vec<u16> = (0..5).map(|_| service.post("/v1/predictions", &of("case", QUICK)).status).collect();
    assert_eq!(statuses, [202, 202, 202, 429, 429]);
    let full = service.post("/v1/predictions", &of("case", QUICK));
    assert!(full.header("retry-after").is_some() && full.text().contains("3 of your jobs are waiting (limit)"));
    let fast: Vec<u16> = (0..200).map(|_| service.get("/v1/service").status).collect();
    assert!(fast.contains(&429) && fast[..20].iter().all(|status| *status == 200), "{fast:?}");
}
