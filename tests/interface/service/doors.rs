//! The doors of the service as they are used from a shell: media types, ranges, addresses, databases, rights.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::json;
use tempfile::tempdir;

use super::queue::token;
use super::{FOR_PARAVIEW, QUICK, SLOW, of, tiny};
use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::desk::done;
use crate::support::server::{Server, in_folder, wait};

/// The case of a media type does not count; another type is refused with those that are taken.
#[test]
fn a_body_is_taken_by_its_media_type() {
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    let json = of("case", QUICK).to_string();
    let cases: [(&str, &str, u16); 12] = [
        ("application/toml", QUICK, 200),
        ("APPLICATION/TOML", QUICK, 200),
        ("Application/Toml; charset=utf-8", QUICK, 200),
        ("text/x-toml", QUICK, 200),
        ("text/toml", QUICK, 200),
        ("application/json", &json, 200),
        ("Application/JSON ; charset=UTF-8", &json, 200),
        ("text/plain", QUICK, 415),
        ("application/x-www-form-urlencoded", QUICK, 415),
        ("application/octet-stream", QUICK, 415),
        ("application/tomlx", QUICK, 415),
        ("application/json", QUICK, 400),
    ];
    for (kind, body, status) in cases {
        let answer = service.send("POST", "/v1/check", &[("content-type", kind)], body.as_bytes());
        assert_eq!(answer.status, status, "{kind}: {}", answer.text());
        if status == 415 {
            let detail = answer.json()["detail"].as_str().unwrap().to_owned();
            ["application/toml", "application/json", "multipart/form-data"]
                .iter()
                .for_each(|taken| assert!(detail.contains(taken), "{detail}"));
        }
    }
    let packed = [("content-type", "application/toml"), ("content-encoding", "gzip")];
    let answer = service.send("POST", "/v1/check", &packed, &[0x1f, 0x8b, 8, 0]).expect(415);
    assert!(answer.text().contains("gzip") && answer.text().contains("send it as it is"), "{}", answer.text());
    for (input, key) in [
        (json!({ "specimen": { "kind": "plate", "width_mm": null } }), "specimen.width_mm"),
        (json!({ "specimen": { "holes": [{ "x_mm": 1.0 }, { "x_mm": null }] } }), "specimen.holes[1].x_mm"),
    ] {
        let answer = service.post("/v1/check", &json!({ "input": input })).expect(400);
        assert!(answer.text().contains(key) && answer.text().contains("null"), "{}", answer.text());
    }
}

/// Drawings and tables of β come as other files of a case do.
#[test]
fn a_drawing_is_sent_along() {
    let (_dir, service) = Server::alone(&["--jobs", "1"]);
    let [case, drawing] =
        ["bracket.toml", "bracket.dxf"].map(|name| std::fs::read_to_string(format!("data/cases/{name}")).unwrap());
    let sent = |files: serde_json::Value| service.post("/v1/check", &json!({ "input": case, "files": files }));
    let plate = sent(json!({ "bracket.dxf": drawing })).expect(200);
    let drawn = plate.json()["drawing"].as_str().unwrap().to_owned();
    assert!(drawn.contains("class=\"plate-hole\"") && drawn.contains("<circle"), "{drawn}");
    let missing = sent(json!({})).expect(422);
    assert!(missing.text().contains("bracket.dxf") && missing.text().contains("was not uploaded"), "{}", missing.text());
    let broken = sent(json!({ "bracket.dxf": drawing.replace("\nholes\n", "\nbores\n") })).expect(422);
    assert!(broken.text().contains("specimen.outline_file") && broken.text().contains("bores"), "{}", broken.text());
}

/// A download that broke off goes on where it was, of files of one part and of many.
#[test]
fn files_have_tags_and_ranges() {
    let (_dir, service) = Server::alone(&["--jobs", "1"]);
    let job =
        service.submit("predictions", &of("large", &(QUICK.replace("spacing_mm = 1.5", "spacing_mm = 0.5") + FOR_PARAVIEW)));
    service.succeeded(&job);
    for file in ["a_n.csv", "paraview.zip"] {
        let path = format!("{job}/files/{file}");
        let whole = service.get(&path).expect(200);
        let (tag, bytes) = (whole.header("etag").unwrap().to_owned(), whole.body.len());
        assert!(tag.starts_with('"') && (file == "a_n.csv" || bytes > 600_000), "{tag}: {bytes} bytes of {file}");
        let asked = |headers: &[(&str, &str)]| service.send("GET", &path, headers, b"");
        let part = 256 << 10;
        let spans = [(0, 0), (100, 199), (bytes / 2, bytes - 1), (part - 1, part), (part, 2 * part), (bytes - 1, bytes - 1)];
        for (from, to) in spans.into_iter().filter(|(_, to)| *to < bytes) {
            let answer = asked(&[("range", &format!("bytes={from}-{to}"))]).expect(206);
            assert!(answer.body == whole.body[from..=to], "{file} {from}-{to}");
            assert_eq!(answer.header("content-range"), Some(&*format!("bytes {from}-{to}/{bytes}")));
        }
        assert!(asked(&[("range", "bytes=-10")]).expect(206).body == whole.body[bytes - 10..]);
        let rest = [("range", format!("bytes={}-", bytes - 7)), ("if-range", tag.clone())];
        assert!(asked(&rest.each_ref().map(|(k, v)| (*k, v.as_str()))).expect(206).body == whole.body[bytes - 7..]);
        assert!(asked(&[("range", "bytes=5-9"), ("if-range", "\"another\"")]).expect(200).body == whole.body);
        assert_eq!(asked(&[("range", "bytes=0-1,4-5")]).expect(200).body.len(), bytes);
        assert_eq!(asked(&[("range", "lines=0-1")]).expect(200).body.len(), bytes);
        let beyond = asked(&[("range", &format!("bytes={bytes}-"))]).expect(416);
        assert_eq!(beyond.header("content-range"), Some(&*format!("bytes */{bytes}")));
        assert!(asked(&[("if-none-match", &tag)]).expect(304).body.is_empty());
        assert_eq!(service.get(&path).header("etag"), Some(&*tag), "the same tag each time");
    }
}

/// Keys of a query that are not known are refused: a misspelt factor would give the interval of another.
#[test]
fn unknown_keys_of_a_query_are_refused() {
    let (_dir, service) = Server::alone(&["--jobs", "1"]);
    let job = service.submit("predictions", &of("tiny", &tiny()));
    service.succeeded(&job);
    service.get(&format!("{job}/remaining?crack_length_mm=12&factor=5")).expect(200);
    for (path, key) in [
        (format!("{job}/remaining?crack_length_mm=12&facter=5"), "facter"),
        (format!("{job}/remaining?crack_length_mm=12&Factor=5"), "Factor"),
        (format!("{job}/files/a_n.csv?point=5"), "point"),
        (format!("{job}?waite=5"), "waite"),
        ("/v1/jobs?stat=failed".to_owned(), "stat"),
        ("/v1/predictions?lim=5".to_owned(), "lim"),
    ] {
        let refused = service.get(&path).expect(400);
        assert!(refused.text().contains(key), "{path}: {}", refused.text());
    }
}

/// Names that show nothing or something else, and those that addresses lose, are refused.
#[test]
fn names_show_what_they_are() {
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    for name in [" ", "\u{a0}", "\u{200b}", "a\u{202e}b", "a\u{2028}b", "\u{feff}a", "a\u{2066}b", ".", ".."] {
        service.post("/v1/predictions", &of(name, QUICK)).expect(422);
        service.post("/v1/predictions", &json!({ "input": QUICK, "files": { name: "7" } })).expect(422);
    }
    let job = service.submit("predictions", &of("Prüfling 1 …", QUICK));
    service.change(&job, &json!({ "name": "\u{200b}" })).expect(422);
    // Whatever is wrong, its message is short.
    let long = QUICK.replace("al2024-t3", &"x".repeat(900_000));
    let refused = service.post("/v1/predictions", &of("long", &long)).expect(422);
    assert!(refused.body.len() < 10_000, "{} bytes", refused.body.len());
    let files = json!({ "spectrum.csv": format!("max,min,cycles\n{}", "y".repeat(3_000_000)) });
    let spectrum = QUICK.replace(
        "stress_range_mpa = 60\nstress_ratio = 0.1",
        "kind = \"spectrum\"\nspectrum_file = \"spectrum.csv\"\nspectrum_scale_mpa = 60",
    );
    let refused = service.post("/v1/predictions", &json!({ "input": spectrum, "files": files })).expect(422);
    assert!(refused.body.len() < 10_000 && refused.text().contains("yyy"), "{} bytes", refused.body.len());
}

/// A database that is removed under a running service is told of, and nothing is accepted that nobody would find again.
#[test]
fn a_database_that_was_removed_takes_no_jobs() {
    let (dir, service) = Server::alone(&["--jobs", "1"]);
    service.succeeded(&service.submit("predictions", &of("tiny", &tiny())));
    for file in fs::read_dir(dir.path()).unwrap().flatten() {
        fs::remove_file(file.path()).unwrap();
    }
    service.get("/readyz").expect(503);
    service.post("/v1/predictions", &of("tiny", &tiny())).expect(503);
    service.get("/healthz").expect(200);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0, "a new empty file");
}

/// Where tokens are asked for no browser keeps results; packed answers have weak tags; names of hosts have no case, and there is one.
#[test]
fn headers_say_what_may_be_kept() {
    let dir = tempdir().unwrap();
    let place = in_folder(dir.path());
    let service = Server::start(&place, &["--jobs", "1"]);
    let job = service.submit("predictions", &of("tiny", &tiny()));
    service.succeeded(&job);
    let file = format!("{job}/files/a_n.csv");
    assert!(service.get(&file).header("cache-control").unwrap().contains("immutable"));
    let port = service.url.rsplit(':').next().unwrap();
    service.send("GET", "/v1/jobs", &[("host", &format!("LOCALHOST:{port}"))], b"").expect(200);
    let raw = |head: &str| {
        let mut answer = Vec::new();
        let mut stream = service.connect(format!("{head}Connection: close\r\n\r\n").as_bytes());
        std::io::Read::read_to_end(&mut stream, &mut answer).unwrap();
        String::from_utf8_lossy(&answer).to_lowercase()
    };
    assert!(raw("GET /v1/jobs HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n").starts_with("http/1.1 400"));
    let tag = |answer: &str| answer.lines().find_map(|line| line.strip_prefix("etag: ")).unwrap().to_owned();
    let plain = tag(&raw(&format!("GET {file} HTTP/1.1\r\nHost: localhost\r\n")));
    let packed = raw(&format!("GET {file} HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n"));
    assert!(packed.contains("content-encoding: gzip") && tag(&packed) == format!("w/{plain}"), "{plain}, {}", tag(&packed));
    let secret = token(&place, "ann", "read");
    let service = Server::start(&place, &["--jobs", "0", "--require-token"]).with_token(&secret);
    assert_eq!(service.get(&file).expect(200).header("cache-control"), Some("no-store"));
}

/// What a worker and the process of its job left when both were killed is removed at the next start.
#[test]
fn leftovers_of_the_killed_are_removed() {
    let dir = tempdir().unwrap();
    let place = in_folder(&dir.path().join("data"));
    let temporary = dir.path().join("temporary");
    fs::create_dir(&temporary).unwrap();
    let start = || Server::start_with(&place, &["--jobs", "1"], &[("TMPDIR", temporary.to_str().unwrap())]);
    let mut service = start();
    service.submit("predictions", &of("slow", SLOW));
    wait("no process of a job", || service.children().len() == 1);
    let child = service.children()[0];
    // A stopped service does not see its process die. A stopped process would go on: the system wakes an orphaned group.
    service.signal("-STOP");
    assert!(Command::new("kill").args(["-KILL", &child.to_string()]).status().unwrap().success());
    service.kill();
    let left = || fs::read_dir(&temporary).unwrap().count();
    assert_eq!(left(), 1);
    // Of another service that still runs, and of nobody who is known.
    let others = temporary.join("perilife-job-other");
    fs::create_dir(&others).unwrap();
    let held = fs::File::open(&others).unwrap();
    held.lock().unwrap();
    let service = start();
    service.succeeded(&format!("/v1/predictions/{}", service.get("/v1/predictions").json()["items"][0]["id"].as_str().unwrap()));
    wait("what was left is still there", || left() == 1);
    assert!(others.exists());
}

/// A name is looked up; what is no address is answered with what would be.
#[test]
fn addresses_are_looked_up() {
    let dir = tempdir().unwrap();
    let data = dir.path().join("d").display().to_string();
    for address in [":0", "127.0.0.1", "127.0.0.1:99999", "no such name:80", "localhost:http"] {
        let output = perilife(dir.path(), &["serve", "--listen", address, "--data", &data]);
        let (code, stderr) = (output.status.code(), texts(&output).1);
        assert!(code == Some(2) && stderr.contains("127.0.0.1:8080") && stderr.contains("localhost:8080"), "{address}: {stderr}");
    }
    assert!(!Path::new(&data).exists());
    let service = Server::start(&["--data", &data], &["--jobs", "0", "--listen", "localhost:0"]);
    assert!(["http://127.0.0.1:", "http://[::1]:"].iter().any(|start| service.url.starts_with(start)), "{}", service.url);
}

/// The first error is said, and no library's log; only a service makes a database, and the first token of one.
#[test]
fn a_database_is_named_and_not_made_by_a_slip() {
    let dir = tempdir().unwrap();
    let here = dir.path();
    let token = ["token", "list"];
    fs::create_dir(here.join("junk")).unwrap();
    fs::write(here.join("junk/perilife.sqlite"), b"no database at all, but long enough to be taken for one ".repeat(100))
        .unwrap();
    let output = perilife(here, "token --data junk list");
    assert_refused(&output, 4, &["junk/perilife.sqlite", "not a database"]);
    assert_eq!(texts(&output).1.lines().count(), 1);
    let with = |database: &str| {
        let mut command = cargo_bin_cmd!("perilife");
        command.current_dir(here).env("PERILIFE_DATABASE", database).args(token).output().unwrap()
    };
    let output = with("postgres://u:secret@127.0.0.1:1/db");
    let stderr = texts(&output).1;
    assert!(output.status.code() == Some(4) && stderr.to_lowercase().contains("refused"), "{stderr}");
    assert!(!stderr.contains("secret"), "{stderr}");
    assert_refused(&with(""), 2, &["--database", "PERILIFE_DATABASE", "unset the variable"]);

    fs::create_dir(here.join("empty")).unwrap();
    let sweep = "case = \"case.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"specimen.crack_length_mm\"\nvalues = [9.0]\n";
    fs::write(here.join("case.toml"), QUICK).unwrap();
    fs::write(here.join("sweep.toml"), sweep).unwrap();
    for data in ["typo", "empty"] {
        for call in [
            vec!["token", "--data", data, "list"],
            vec!["token", "--data", data, "remove", "ann"],
            vec!["worker", "--data", data],
            vec!["sweep", "sweep.toml", "--out", "out", "-q", "--engine", "service", "--data", data],
        ] {
            let output = perilife(here, &call);
            let words = [&format!("--data = {data}"), "contains no database of a service", "of `perilife serve`"];
            assert_refused(&output, 2, &words);
        }
        assert!(!here.join("typo").exists() && fs::read_dir(here.join("empty")).unwrap().count() == 0);
    }
    done(here, "token --data right add ana --role read");
}

/// Files of the store are nobody else's, in a folder that others may read as well.
#[test]
fn nobody_else_reads_the_store() {
    let dir = tempdir().unwrap();
    let rights = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    for (name, call) in [("by_token", vec!["token", "add", "ana", "--role", "admin"]), ("by_serve", vec![])] {
        let data = dir.path().join(name);
        fs::create_dir(&data).unwrap();
        fs::set_permissions(&data, fs::Permissions::from_mode(0o755)).unwrap();
        let place = in_folder(&data);
        if !call.is_empty() {
            done(dir.path(), &[&call[..1], &[&place[0], &place[1]], &call[1..]].concat());
        }
        let service = Server::start(&place, &["--jobs", "0"]);
        service.submit("predictions", &of("case", QUICK));
        let mut seen = 0;
        for entry in fs::read_dir(&data).unwrap().map(Result::unwrap) {
            assert_eq!(rights(&entry.path()), 0o600, "{:?}", entry.path());
            seen += 1;
        }
        assert!(seen >= 2, "the database and what SQLite lays beside it");
    }
}
