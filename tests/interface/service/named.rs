//! What people say of their runs: name, note, put away; and the list in which all kinds are found by it. A sweep by the files a form
//! brings, a preview of measured files with what is taken of them.

use serde_json::{Value, json};

use super::jobs::with_each_store;
use super::{QUICK, of, tiny};
use crate::support::server::{Answer, Server};

const JSON: [(&str, &str); 1] = [("content-type", "application/json")];

fn change(service: &Server, job: &str, body: &Value) -> Answer {
    service.send("PATCH", job, &JSON, body.to_string().as_bytes())
}

/// Names of a list, newest first.
fn names(service: &Server, path: &str) -> Vec<String> {
    let items = service.get(path).expect(200).json()["items"].clone();
    items.as_array().unwrap().iter().map(|job| job["name"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn a_run_is_renamed_noted_and_put_away() {
    with_each_store("named", |place| {
        let service = Server::start(place, &["--jobs", "0"]);
        let life = service.submit("predictions", &of("first", QUICK));
        let factors = service.submit("sif", &of("second", QUICK));
        let before = service.get(&life).json();
        assert_eq!((&before["note"], &before["archived"]), (&json!(""), &json!(false)));

        let renamed = change(&service, &life, &json!({ "name": "Wing 50%_a", "note": "after\nthe visit" })).expect(200).json();
        assert_eq!((&renamed["name"], &renamed["note"]), (&json!("Wing 50%_a"), &json!("after\nthe visit")));
        assert!(renamed["revision"].as_i64() > before["revision"].as_i64(), "who watches is told");
        assert_eq!(service.get(&life).json()["input"], before["input"], "what was asked for stays");
        change(&service, &life, &json!({ "note": "" })).expect(200);
        change(&service, &factors, &json!({ "note": "Visit of MARCH" })).expect(200);

        // One list of all kinds, by any part of name or note; signs of patterns are signs.
        assert_eq!(names(&service, "/v1/jobs"), ["second", "Wing 50%_a"]);
        for (text, found) in [("march", vec!["second"]), ("50%25_", vec!["Wing 50%_a"]), ("5_%25", vec![]), ("%21", vec![])] {
            assert_eq!(names(&service, &format!("/v1/jobs?text={text}")), found, "{text}");
        }
        assert_eq!(names(&service, "/v1/jobs?limit=1"), ["second"]);
        let next = service.get("/v1/jobs?limit=1").json()["next"].as_str().unwrap().to_owned();
        assert_eq!(names(&service, &format!("/v1/jobs?after={next}")), ["Wing 50%_a"]);

        assert_eq!(change(&service, &life, &json!({ "archived": true })).expect(200).json()["archived"], true);
        assert_eq!(names(&service, "/v1/jobs"), ["second"]);
        assert!(names(&service, "/v1/predictions").is_empty());
        assert_eq!(names(&service, "/v1/predictions?archived=true"), ["Wing 50%_a"]);
        service.get(&life).expect(200);
        change(&service, &life, &json!({ "archived": false })).expect(200);
        assert_eq!(names(&service, "/v1/predictions"), ["Wing 50%_a"]);

        let long = "x".repeat(2001);
        for (body, status, words) in [
            (json!({}), 400, "nothing to change"),
            (json!({ "state": "succeeded" }), 400, "known are name, note, report, archived"),
            (json!({ "name": "" }), 422, "is no name"),
            (json!({ "note": long }), 422, "up to 2000 bytes"),
            (json!({ "note": "bell \u{7}" }), 422, "is no note"),
            (json!({ "report": { "laborator": "x" } }), 422, "did you mean laboratory"),
        ] {
            let refused = change(&service, &life, &body).expect(status);
            assert!(refused.text().contains(words), "{body}: {}", refused.text());
        }
        service.send("PATCH", &life, &[("content-type", "application/toml")], b"name = \"x\"").expect(415);
        change(&service, &life.replace("predictions", "sweeps"), &json!({ "name": "x" })).expect(404);
    });
}

/// The base case of a sweep and what that names come as files under their own names, whatever folders the input names.
#[test]
fn a_sweep_needs_no_folders() {
    let (_dir, service) = Server::alone(&["--jobs", "1"]);
    let design = "case = \"../cases/panel.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"loading.stress_range_mpa\"\nvalues = [50, 60]\n";
    let case = tiny();
    let body = json!({ "name": "two", "input": design, "files": { "panel.toml": case } });
    let done = service.succeeded(&service.submit("sweeps", &body));
    assert_eq!((&done["summary"]["cases"], &done["summary"]["failed"]), (&json!(2), &json!(0)));
    // Nobody asked for fields of all moments.
    let files: Vec<&str> = done["files"].as_array().unwrap().iter().map(|file| file["name"].as_str().unwrap()).collect();
    assert!(files.iter().all(|name| !name.contains("paraview")), "{files:?}");
}

/// A table as a laboratory exports it: what one column is has to be said, all else is told back as it is taken.
#[test]
fn a_preview_says_what_is_taken() {
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    let mut table = "Lab North; panel 3\nexported 2026-11-20\nLäng [in];Cycles x1000;Pmax kN\n".to_owned();
    for step in 0..8 {
        table.push_str(&format!("0,{};{},5;23,36\n", 400 + 50 * step, 10 * step));
    }
    let form = |fields: &str| {
        let body = format!(
            "--b\r\ncontent-disposition: form-data; name=\"file\"; filename=\"lab.csv\"\r\n\r\n{table}\r\n{fields}--b--\r\n"
        );
        service.send("POST", "/v1/measured", &[("content-type", "multipart/form-data; boundary=b")], body.as_bytes()).expect(200)
    };
    let open = form("").json()["files"][0].clone();
    assert!(open["columns"].is_null() && open["taken"] == json!([]), "{open:#}");
    let said = "--b\r\ncontent-disposition: form-data; name=\"columns\"\r\n\r\n{\"length\":[\"Läng [in]\"]}\r\n";
    let read = form(said).json()["files"][0].clone();
    // 0.45 inches are 11.43 mm; 10.5 thousands are 10 500 cycles.
    let row = &read["taken"][1];
    assert!((row[0].as_f64().unwrap() - 11.43).abs() < 1e-9 && row[1] == json!(10_500.0) && row[2].is_null(), "{row}");
    assert_eq!(read["loading"], json!({ "force_max_kn": 23.36 }));
}
