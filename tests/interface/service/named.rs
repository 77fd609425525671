//! What people say of their runs: name, note, put away; and the list in which all kinds are found by it. A
//! preview of measured files with what is taken of them.

use serde_json::json;

use super::jobs::with_each_store;
use super::{QUICK, of};
use crate::support::server::Server;

/// Names of a list, newest first.
pub fn names(service: &Server, path: &str) -> Vec<String> {
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

        let renamed = service.change(&life, &json!({ "name": "Wing 50%_a", "note": "after\nthe visit" })).expect(200).json();
        assert_eq!((&renamed["name"], &renamed["note"]), (&json!("Wing 50%_a"), &json!("after\nthe visit")));
        assert!(renamed["revision"].as_i64() > before["revision"].as_i64(), "who watches is told");
        assert_eq!(service.get(&life).json()["input"], before["input"], "what was asked for stays");
        service.change(&life, &json!({ "note": "" })).expect(200);
        service.change(&factors, &json!({ "note": "Visit of MARCH" })).expect(200);

        // One list of all kinds, by any part of name or note; signs of patterns are signs.
        assert_eq!(names(&service, "/v1/jobs"), ["second", "Wing 50%_a"]);
        for (text, found) in [("march", vec!["second"]), ("50%25_", vec!["Wing 50%_a"]), ("5_%25", vec![]), ("%21", vec![])] {
            assert_eq!(names(&service, &format!("/v1/jobs?text={text}")), found, "{text}");
        }
        assert_eq!(names(&service, "/v1/jobs?limit=1"), ["second"]);
        let next = service.get("/v1/jobs?limit=1").json()["next"].as_str().unwrap().to_owned();
        assert_eq!(names(&service, &format!("/v1/jobs?after={next}")), ["Wing 50%_a"]);

        assert_eq!(service.change(&life, &json!({ "archived": true })).expect(200).json()["archived"], true);
        assert_eq!(names(&service, "/v1/jobs"), ["second"]);
        assert!(names(&service, "/v1/predictions").is_empty());
        assert_eq!(names(&service, "/v1/predictions?archived=true"), ["Wing 50%_a"]);
        service.get(&life).expect(200);
        service.change(&life, &json!({ "archived": false })).expect(200);
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
            let refused = service.change(&life, &body).expect(status);
            assert!(refused.text().contains(words), "{body}: {}", refused.text());
        }
        service.send("PATCH", &life, &[("content-type", "application/toml")], b"name = \"x\"").expect(415);
        service.change(&life.replace("predictions", "sweeps"), &json!({ "name": "x" })).expect(404);
    });
}

/// A table as a laboratory exports it: what one column is has to be said, all else is told back as it is taken.
#[test]
fn a_preview_says_what_is_taken() {
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    let rows: String = (0..8).map(|step| format!("0,{};{},5;23,36\n", 400 + 50 * step, 10 * step)).collect();
    let table = format!("Lab North; panel 3\nexported 2026-11-20\nLäng [in];Cycles x1000;Pmax kN\n{rows}");
    let seen = |said: &[(&str, Option<&str>, &str)]| {
        let parts = [&[("file", Some("lab.csv"), &*table)], said].concat();
        service.send_form("/v1/measured", &parts).expect(200).json()["files"][0].clone()
    };
    let open = seen(&[]);
    assert!(open["columns"].is_null() && open["taken"] == json!([]), "{open:#}");
    let read = seen(&[("columns", None, "{\"length\":[\"Läng [in]\"]}")]);
    // 0.45 inches are 11.43 mm; 10.5 thousands are 10 500 cycles.
    let row = &read["taken"][1];
    assert!((row[0].as_f64().unwrap() - 11.43).abs() < 1e-9 && row[1] == json!(10_500.0) && row[2].is_null(), "{row}");
    assert_eq!(read["loading"], json!({ "force_max_kn": 23.36 }));
}
