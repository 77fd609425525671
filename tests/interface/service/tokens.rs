//! Who may do what where tokens are asked for.

use std::fs;

use serde_json::{Value, json};
use tempfile::tempdir;

use super::queue::token;
use super::{QUICK, of};
use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::server::{Server, in_folder};

#[test]
fn roles_are_kept() {
    let dir = tempdir().unwrap();
    let folder = dir.path();
    let data = folder.join("service");
    let place = in_folder(&data);
    let of_tokens = |call: &[&str]| perilife(folder, &[&["token", &place[0], &place[1]], call].concat());
    let [reader, runner, other, admin] =
        [("ann", "read"), ("bob", "run"), ("cy", "run"), ("dee", "admin")].map(|(name, role)| token(&place, name, role));
    assert!(reader.starts_with("perilife_") && reader.len() == 73 && reader != runner);
    assert_refused(&of_tokens(&["add", "ann", "--role", "run"]), 2, &["ann", "has a token already"]);

    let mut service = Server::start(&place, &["--jobs", "0", "--require-token"]);
    let unknown = service.get("/v1/predictions").expect(401);
    let found = (unknown.header("www-authenticate"), unknown.header("content-type"));
    assert_eq!(found, (Some("Bearer"), Some("application/problem+json")));
    service.get("/metrics").expect(401);
    for open in ["/", "/healthz", "/openapi.json", "/v1/service"] {
        service.get(open).expect(200);
    }
    assert!(service.get("/v1/service").json()["role"].is_null());
    service = service.with_token("perilife_0000");
    service.get("/v1/predictions").expect(401);

    service = service.with_token(&reader);
    assert_eq!(service.get("/v1/service").json()["role"], "read");
    service.get("/v1/predictions").expect(200);
    service.post("/v1/predictions", &of("case", QUICK)).expect(403);
    service = service.with_token(&runner);
    let jobs = [(); 2].map(|()| service.submit("predictions", &of("case", QUICK)));
    service.post(&format!("{}/cancel", jobs[0]), &json!({})).expect(202);
    service = service.with_token(&other);
    assert_eq!(service.get(&jobs[1]).expect(200).json()["owner"], "bob");
    for (method, path) in [("POST", format!("{}/cancel", jobs[1])), ("DELETE", jobs[0].clone())] {
        service.send(method, &path, &[], b"").expect(403);
    }
    for (secret, status) in [(&other, 403), (&runner, 200), (&admin, 200)] {
        service = service.with_token(secret);
        service.change(&jobs[1], &json!({ "name": "mine" })).expect(status);
    }
    service.send("DELETE", &jobs[0], &[], b"").expect(204);
    service.post(&format!("{}/cancel", jobs[1]), &json!({})).expect(202);
    // Two with the same key are two jobs if they are of two people.
    let key = [("content-type", "application/json"), ("idempotency-key", "mine")];
    let body = of("case", QUICK).to_string();
    let mut ids = Vec::new();
    for secret in [&runner, &other] {
        service = service.with_token(secret);
        ids.push(service.send("POST", "/v1/predictions", &key, body.as_bytes()).expect(202).json()["id"].clone());
    }
    assert_ne!(ids[0], ids[1]);

    // Only hashes are kept, and no log has them.
    service.kill();
    let kept = std::fs::read(data.join("perilife.sqlite")).unwrap();
    for secret in [&reader, &runner] {
        assert!(!kept.windows(secret.len()).any(|bytes| bytes == secret.as_bytes()));
    }
    let listed = texts(&of_tokens(&["list"])).0;
    assert!(listed.contains("ann") && listed.lines().count() == 4 && !listed.contains("perilife_"));
    assert!(of_tokens(&["remove", "ann"]).status.success());
    assert_refused(&of_tokens(&["remove", "ann"]), 2, &["has no token"]);
    let service = Server::start(&place, &["--jobs", "0", "--require-token"]).with_token(&reader);
    service.get("/v1/predictions").expect(401);
}

#[test]
fn nobody_is_let_in_from_elsewhere_without_tokens() {
    let dir = tempdir().unwrap();
    let data = dir.path().join("service");
    let call = ["serve", "--data", data.to_str().unwrap(), "--listen", "0.0.0.0:0"];
    assert_refused(&perilife(dir.path(), &call), 2, &["--listen = 0.0.0.0:0", "perilife token add NAME --role admin"]);
    let nowhere = ["serve", "--database", "postgres://me:secret@127.0.0.1:1/none?password=hidden", "--listen", "127.0.0.1:0"];
    let output = perilife(dir.path(), &nowhere);
    assert_refused(&output, 4, &["postgres://me@127.0.0.1:1/none: cannot use the database"]);
    let stderr = texts(&output).1;
    assert!(!stderr.contains("secret") && !stderr.contains("hidden"), "{stderr}");
    let output = perilife(dir.path(), "worker --database mysql://x/y");
    assert_refused(&output, 4, &["must begin with sqlite:// or postgres://"]);
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    assert_refused(&perilife(dir.path(), &[&call[..4], &[&address]].concat()), 4, &["cannot listen"]);
}

/// Without tokens nobody is let in who came through a proxy, unless the operator says that the proxy is to be believed.
#[test]
fn a_proxy_makes_nobody_an_admin() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
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
