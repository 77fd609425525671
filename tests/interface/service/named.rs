//! What people say of their runs: name, note, put away; and the list in which all kinds are found by it. A
//! preview of measured files with what is taken of them.

use std::fs;

use serde_json::json;

use super::jobs::with_each_store;
use super::{QUICK, of};
use crate::interface::cli::{assert_refused, perilife};
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

/// The page proposes what `calibrate` writes into its template: one reading of one file.
#[test]
fn lines_above_a_table_are_read_alike_by_service_and_command() {
    let (dir, service) = Server::alone(&["--jobs", "0"]);
    let none = json!({ "kind": null, "width_mm": null, "thickness_mm": null, "stress_ratio": null, "material": null });
    for (above, said, lines) in [
        (
            "Werkstoff;EN AW-2024 T3\nRissebene;T-L\nProbenform;C(T)\nW (mm);50,8\nB;2;in\nR;0,1\n",
            json!({ "kind": "compact_tension", "width_mm": 50.8, "thickness_mm": 50.8, "stress_ratio": 0.1,
                "material": { "stated": "EN AW-2024 T3", "name": "al2024-t3-clad-tl", "orientation": null } }),
            [
                "kind = \"compact_tension\"", "width_mm = 50.8", "thickness_mm = 50.8", "name = \"al2024-t3-clad-tl\"\n",
                "stress_ratio = 0.1",
            ],
        ),
        (
            "# M(T), W = 100 mm B = 1,250 mm\n# Material: AA 7075-T651, orientation: T-L\n# R = 0.1\n# R = 0.5\n",
            json!({ "kind": "middle_tension", "width_mm": 100.0, "thickness_mm": null, "stress_ratio": null,
                "material": { "stated": "AA 7075-T651", "name": "al7075-t651-sheet-lt", "orientation": "T-L" } }),
            [
                "kind = \"middle_tension\"",
                "width_mm = 100",
                "thickness_mm = <...>",
                "name = \"al7075-t651-sheet-lt\" # no record of orientation T-L",
                "stress_ratio = <...>",
            ],
        ),
        (
            "Material;Inconel 718\nW;50\n",
            json!({ "kind": null, "width_mm": null, "thickness_mm": null, "stress_ratio": null,
                "material": { "stated": "Inconel 718", "name": null, "orientation": null } }),
            [
                "kind = <...>",
                "width_mm = <...>",
                "thickness_mm = <...>",
                "name = <...> # Material in the file: Inconel 718; ",
                "stress_ratio = <...>",
            ],
        ),
        (
            "",
            none,
            ["kind = <...>", "width_mm = <...>", "thickness_mm = <...>", "name = <...> # perilife", "stress_ratio = <...>"],
        ),
    ] {
        let rows: String = (0..6).map(|i| format!("{};{},5\n", 1000 * i, 12 + i)).collect();
        let table = format!("{above}cycles;a (mm)\n{rows}");
        let read = service.send_form("/v1/measured", &[("file", Some("lab.csv"), &table)]).expect(200).json();
        assert_eq!(read["files"][0]["preamble"], said, "{above}");
        fs::write(dir.path().join("lab.csv"), &table).unwrap();
        assert_refused(&perilife(dir.path(), "calibrate lab.csv --out fit"), 2, &lines);
    }
    let schemas = service.get("/openapi.json").json()["components"]["schemas"].clone();
    let properties = |name: &str| schemas[name]["properties"].as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(properties("Preamble"), ["kind", "material", "stress_ratio", "thickness_mm", "width_mm"]);
    assert_eq!(schemas["FoundFile"]["properties"]["preamble"]["$ref"], "#/components/schemas/Preamble");
}
