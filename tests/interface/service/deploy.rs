//! What is delivered in `data/deploy`: options that the program knows, units and a proxy configuration that their programs accept, and
//! a job that goes through the proxy.

use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use assert_cmd::cargo::cargo_bin;
use tempfile::tempdir;

use super::queue::token;
use super::{QUICK, SLOW, of};
use crate::interface::cli::{perilife, texts};
use crate::support::nginx::{DELIVERED, Nginx};
use crate::support::server::{Server, in_folder};

const SERVICE: &str = include_str!("../../../data/deploy/perilife.service");
const WORKER: &str = include_str!("../../../data/deploy/perilife-worker@.service");
const CONTAINER: &str = include_str!("../../../data/deploy/Containerfile");

/// The words of a statement that begins so, with those of the lines it goes on over.
fn statement(text: &str, beginning: &str) -> Vec<String> {
    let text = text.replace("\\\n", " ");
    let line = text.lines().find_map(|line| line.strip_prefix(beginning)).unwrap_or_else(|| panic!("{beginning}"));
    line.split(|c: char| c.is_whitespace() || "[],\"".contains(c)).filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

/// The options of a command are those that it knows.
#[test]
fn options_are_known() {
    let dir = tempdir().unwrap();
    for (file, words) in [
        ("perilife.service", &statement(SERVICE, "ExecStart=")[1..]),
        ("perilife-worker@.service", &statement(WORKER, "ExecStart=")[1..]),
        ("Containerfile", &statement(CONTAINER, "CMD ")[..]),
    ] {
        let help = texts(&perilife(dir.path(), &[&words[0], "--help"])).0;
        let known: BTreeSet<&str> = help.split(|c: char| c.is_whitespace() || c == ',' || c == '`').collect();
        let options: Vec<&String> = words.iter().filter(|word| word.starts_with("--")).collect();
        assert!(options.len() > 3, "{file}: {words:?}");
        for option in options {
            assert!(known.contains(option.as_str()), "{file}: perilife {} knows no {option}", words[0]);
        }
    }
}

/// Where the programs have a limit of their own it is that of the service.
#[test]
fn limits_agree() {
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    let bytes = service.get("/v1/service").json()["limits"]["body_bytes"].as_u64().unwrap();
    assert!(DELIVERED.contains(&format!("client_max_body_size {}m;", bytes >> 20)));
    let kept = "User=perilife StateDirectoryMode=0700 NoNewPrivileges=yes ProtectSystem=strict PrivateTmp=yes Restart=on-failure";
    for unit in [SERVICE, WORKER] {
        for line in kept.split(' ') {
            assert!(unit.lines().any(|known| known == line), "{line}");
        }
    }
}

/// The health check of the container says yes of a service that runs, and no of one that does not.
#[test]
fn the_health_check_of_the_container_asks() {
    let (_dir, mut service) = Server::alone(&["--jobs", "0"]);
    let joined = CONTAINER.replace("\\\n", " ");
    let check = joined.lines().find(|line| line.starts_with("HEALTHCHECK")).unwrap();
    let words: Vec<String> = serde_json::from_str(&check[check.find('[').unwrap()..]).unwrap();
    let port = service.url.rsplit(':').next().unwrap();
    let script = words[2].replace("/8080", &format!("/{port}"));
    let asked = || Command::new(&words[0]).args([&words[1], &script]).stderr(Stdio::null()).status().unwrap().success();
    assert!(asked());
    service.stop();
    assert!(!asked());
}

/// Only that the program is not installed is made good: the units are checked as they are.
#[test]
fn units_are_accepted() {
    let analyze = "/usr/bin/systemd-analyze";
    if !Path::new(analyze).is_file() {
        println!("skipped: {analyze} is not installed (Debian: apt-get install systemd)");
        return;
    }
    let dir = tempdir().unwrap();
    let program = cargo_bin("perilife").display().to_string();
    for (name, unit) in [("perilife.service", SERVICE), ("perilife-worker@1.service", WORKER)] {
        let file = dir.path().join(name);
        fs::write(&file, unit.replace("/usr/local/bin/perilife", &program)).unwrap();
        let output = Command::new(analyze).args(["verify", "--man=no"]).arg(&file).output().unwrap();
        let said = texts(&output).1;
        let about: Vec<&str> = said.lines().filter(|line| line.contains("perilife")).collect();
        assert!(output.status.success() && about.is_empty(), "{said}");
    }
}

/// nginx accepts the configuration, and adds the TLS that it is there for.
#[test]
fn the_proxy_configuration_is_accepted() {
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    let Some(nginx) = Nginx::configured(&service.url) else { return };
    let checked = nginx.checked();
    assert!(checked.status.success(), "{}", texts(&checked).1);
    let Some(nginx) = Nginx::before(&service.url) else { return };
    let mut client = Command::new("openssl")
        .args(["s_client", "-quiet", "-connect", &format!("127.0.0.1:{}", nginx.tls_port)])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let request = b"GET /v1/service HTTP/1.1\r\nHost: perilife.example.org\r\nConnection: close\r\n\r\n";
    client.stdin.take().unwrap().write_all(request).unwrap();
    let answer = texts(&client.wait_with_output().unwrap()).0;
    // Whatever the service says to a stranger, it came from there.
    assert!(answer.contains("strict-transport-security:") || answer.contains("Strict-Transport-Security:"), "{answer}");
    assert!(answer.to_lowercase().contains("x-content-type-options: nosniff"), "{answer}");
}

/// A job with its events and files goes through the proxy for whoever has a token; a body of the largest size gets to the service.
fn served_through_nginx(options: &[&str]) {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let secret = token(&place, "ann", "run");
    let mut through = Server::start(&place, &[&["--jobs", "1"], options].concat());
    let Some(nginx) = Nginx::before(&through.url) else { return };
    through.url.clone_from(&nginx.url);
    through.get("/healthz").expect(200);
    let refused = through.get("/v1/predictions").expect(401);
    assert_eq!(refused.header("www-authenticate"), Some("Bearer"));
    through.post("/v1/predictions", &of("case", QUICK)).expect(401);

    let through = through.with_token(&secret);
    let job = through.submit("predictions", &of("slow", SLOW));
    let begun = Instant::now();
    let (mut first, mut names) = (None, Vec::new());
    through.each_event(&job, &[], |name, data| {
        first.get_or_insert_with(|| begun.elapsed());
        names.push((name.to_owned(), data["state"].as_str().unwrap_or_default().to_owned()));
    });
    let took = begun.elapsed();
    assert_eq!(names.last(), Some(&("job".to_owned(), "succeeded".to_owned())), "{names:?}");
    assert!(names.iter().any(|(name, _)| name == "growth"), "{names:?}");
    // Sent as they come, not all at the end.
    assert!(first.unwrap() < took / 2, "first of {} after {first:?} of {took:?}", names.len());
    assert!(through.file(&job, "a_n.csv").starts_with(b"cycles,"));

    let json = [("content-type", "application/json")];
    let largest = vec![b' '; 32 << 20];
    through.send("POST", "/v1/check", &json, &largest).expect(400);
    let page = [json[0], ("origin", "https://example.org")];
    through.send("POST", "/v1/predictions", &page, of("case", QUICK).to_string().as_bytes()).expect(403);
    let page = [json[0], ("origin", &nginx.url)];
    through.send("POST", "/v1/predictions", &page, of("case", QUICK).to_string().as_bytes()).expect(202);
}

#[test]
fn a_service_with_tokens_is_served_through_nginx() {
    served_through_nginx(&["--require-token"]);
}

#[test]
fn a_service_that_trusts_its_proxy_is_served_through_nginx() {
    served_through_nginx(&["--require-token", "--trust-proxy"]);
}

/// Without tokens it is for this machine alone, and who comes through a proxy need not be on it.
#[test]
fn a_service_without_tokens_refuses_what_comes_through_nginx() {
    let (_dir, mut service) = Server::alone(&["--jobs", "0"]);
    let Some(nginx) = Nginx::before(&service.url) else { return };
    service.get("/v1/predictions").expect(200);
    service.url.clone_from(&nginx.url);
    service.get("/v1/predictions").expect(401);
    service.post("/v1/predictions", &of("case", QUICK)).expect(401);
}
