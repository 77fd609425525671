//! Nobody keeps others waiting: bodies, streams, connections and long looks of one leave room for the rest.

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use tempfile::tempdir;

use super::queue::token;
use super::{QUICK, of};
use crate::support::desk::done;
use crate::support::server::{Server, in_folder, multipart, wait, within};

/// A service that asks for tokens, asked by one who may run jobs, and a token that may read.
fn with_tokens(place: &[impl AsRef<str>], more: &[&str]) -> (Server, String) {
    let [reader, runner] = [("reader", "read"), ("runner", "run")].map(|(name, role)| token(place, name, role));
    let service = Server::start(place, &[&["--jobs", "0", "--require-token"], more].concat()).with_token(&runner);
    (service, reader)
}

#[test]
fn slow_bodies_of_one_keep_nobody_waiting() {
    let dir = tempdir().unwrap();
    let (service, reader) = with_tokens(&in_folder(dir.path()), &[]);
    let head = format!(
        "POST /v1/check HTTP/1.1\r\nHost: localhost\r\nAuthorization: bearer {reader}\r\nContent-Type: application/toml\r\n\
         Content-Length: 1000000\r\n\r\na"
    );
    let _trickling: Vec<TcpStream> = (0..24).map(|_| service.connect(head.as_bytes())).collect();
    std::thread::sleep(Duration::from_millis(500));
    within(5, || service.post("/v1/check", &of("quick", QUICK)).expect(200));
}

/// Streams of events of one take no places of others, and end with his token.
#[test]
fn streams_of_one_shut_nobody_out() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let (service, reader) = with_tokens(&place, &["--connections", "100"]);
    let job = service.submit("predictions", &of("waits", QUICK));
    let open = || {
        let head = format!("GET {job}/events HTTP/1.1\r\nHost: localhost\r\nAuthorization: BEARER {reader}\r\n\r\n");
        let mut lines = BufReader::new(service.connect(head.as_bytes()));
        let mut head = String::new();
        while !head.ends_with("\r\n\r\n") && lines.read_line(&mut head).unwrap() > 0 {}
        (lines, head)
    };
    let mut streams: Vec<_> = (0..90).map(|_| open()).collect();
    let [admitted, refused] =
        ["200", "429"].map(|status| streams.iter().filter(|(_, head)| head.starts_with(&format!("HTTP/1.1 {status}"))).count());
    assert_eq!((admitted, refused), (50, 40), "half of the connections");
    assert!(streams[0].1.to_lowercase().contains("x-accel-buffering: no"), "{}", streams[0].1);
    service.get("/healthz").expect(200);
    service.get(&job).expect(200);
    done(dir.path(), &["token", "remove", "reader", &place[0], &place[1]]);
    // The last piece of an answer in pieces is empty (RFC 9112, 7.1); the connection stays for the next request.
    let mut pieces = streams.swap_remove(0).0.lines();
    within(10, || assert!(pieces.any(|line| line.unwrap() == "0"), "cut off"));
}

/// Bodies that never come and connections that ask nothing keep nobody waiting, whether tokens are asked for or not, and those who watch over
/// the service least of all.
#[test]
fn bodies_that_never_come_keep_nobody_waiting() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let secret = token(&place, "ann", "admin");
    for more in [&["--require-token"][..], &[]] {
        let service = Server::start(&place, &[&["--jobs", "0", "--connections", "100"], more].concat()).with_token(&secret);
        let head =
            "POST /v1/check HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 60000\r\n\r\n{";
        for text in [head, "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 60000\r\n\r\n{", "GET"] {
            let _waiting: Vec<TcpStream> = (0..300).map(|_| service.connect(text.as_bytes())).collect();
            within(3, || ["/healthz", "/readyz"].map(|path| service.get(path).expect(200)));
            // A body that somebody may send has seconds.
            let is_let_in = || {
                let answer = service.try_send("GET", "/v1/jobs", &[], b"").ok();
                let crowded = answer.as_ref().filter(|answer| answer.status == 503);
                assert!(crowded.is_none_or(|answer| answer.header("retry-after").is_some()), "when to come again");
                answer.is_some_and(|answer| answer.status == 200)
            };
            within(8, || wait(text, is_let_in));
        }
    }
}

/// Long lines and wide tables cost little, and what is looked at ends with its request and with the service.
#[test]
fn a_look_ends_with_its_request() {
    let (_dir, mut service) = Server::alone(&["--jobs", "0"]);
    let asked = |content: &str| {
        let found = within(4, || service.send_form("/v1/measured", &[("file", Some("a.csv"), content)]).expect(200).json());
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
    let heavy = format!("cycles,crack_length_mm\n{}", (0..1_500_000).map(|i| format!("{i},9\n")).collect::<String>());
    let heavy = multipart(&[("file", Some("a.csv"), &heavy)]);
    let head =
        "POST /v1/measured HTTP/1.1\r\nHost: localhost\r\nContent-Type: multipart/form-data; boundary=XX\r\nContent-Length";
    let request = format!("{head}: {}\r\n\r\n{heavy}", heavy.len());
    let sent = service.connect(request.as_bytes());
    wait("no process looks", || !service.children().is_empty());
    drop(sent);
    within(2, || wait("a process looks for nobody", || service.children().is_empty()));
    let _sent = service.connect(request.as_bytes());
    std::thread::sleep(Duration::from_millis(300));
    let begun = Instant::now();
    service.stop();
    assert!(begun.elapsed() < Duration::from_secs(13), "{:?}", begun.elapsed());
}
