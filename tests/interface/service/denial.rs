//! Nobody keeps others waiting: bodies, streams, connections and long looks of one leave room for the rest.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use tempfile::tempdir;

use super::queue::token;
use super::{QUICK, of};
use crate::interface::cli::perilife;
use crate::support::server::{PATIENCE, Server, in_folder};

/// Tokens of these names and roles, and a service that asks for them.
fn with_tokens<const N: usize>(place: &[&str], more: &[&str], names: [(&str, &str); N]) -> (Server, [String; N]) {
    let tokens = names.map(|(name, role)| token(place, name, role));
    (Server::start(place, &[&["--require-token"], more].concat()), tokens)
}

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
    let (_dir, service) = Server::alone(&["--jobs", "0", "--connections", "10"]);
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
