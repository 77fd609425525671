//! A job gives what the command gives, file by file.

use std::fs;
use std::path::Path;

use perilife_base::monotone::Monotone;
use serde_json::{Value, json};
use tempfile::tempdir;

use super::{FOR_PARAVIEW, QUICK, SLOW, of, test_of_quick};
use crate::support::desk::done;
use crate::support::rows::assert_says;
use crate::support::server::{Server, in_folder};

fn server(folder: &Path) -> Server {
    let place = in_folder(&folder.join("service"));
    Server::start(&place, &["--jobs", "2"])
}

/// Without what differs from run to run.
fn timeless(mut result: Value) -> Value {
    for key in ["wall_s", "memory_mb", "finished", "commit"] {
        result[key] = Value::Null;
    }
    result
}

#[test]
fn a_prediction_has_the_files_of_the_command() {
    let dir = tempdir().unwrap();
    let folder = dir.path();
    let service = server(folder);
    for (name, text) in [("quick", &*(QUICK.to_owned() + FOR_PARAVIEW)), ("slow", SLOW)] {
        let job = service.submit("predictions", &of(name, text));
        fs::write(folder.join(format!("{name}.toml")), text).unwrap();
        done(folder, &["predict", &format!("{name}.toml"), "--out", name]);
        let ended = service.succeeded(&job);
        for file in fs::read_dir(folder.join(name)).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()) {
            match file.as_str() {
                ".perilife" => {}
                "paraview" | "inputs" => assert!(service.file(&job, &format!("{file}.zip")).starts_with(b"PK")),
                "result.json" => {
                    let [ours, theirs] = [service.file(&job, &file), fs::read(folder.join(name).join(&file)).unwrap()];
                    let [ours, theirs] = [ours, theirs].map(|bytes| timeless(serde_json::from_slice(&bytes).unwrap()));
                    assert_eq!(ours, theirs, "{name}");
                    assert_eq!(ended["summary"]["life_cycles"], theirs["life_cycles"]);
                }
                file => {
                    assert!(
                        service.file(&job, file) == fs::read(folder.join(name).join(file)).unwrap(),
                        "{name}: {file} differs"
                    );
                }
            }
        }
        let listed: Vec<&str> = ended["files"].as_array().unwrap().iter().map(|file| file["name"].as_str().unwrap()).collect();
        // The mark of the command is no file of the service, which adds the report.
        assert_eq!(listed.len(), fs::read_dir(folder.join(name)).unwrap().count(), "{listed:?}");
        done(folder, &format!("report {name} --out report.html"));
        let plain =
            |text: Vec<u8>| String::from_utf8(text).unwrap().lines().filter(|line| !is_of_this_run(line)).collect::<String>();
        let [ours, theirs] = [service.file(&job, "report.html"), fs::read(folder.join("report.html")).unwrap()].map(plain);
        assert!(ours.len() > 1000 && ours == theirs, "{name}: the report differs");
        fs::remove_file(folder.join("report.html")).unwrap();
        for file in ended["files"].as_array().unwrap() {
            let answer = service.get(file["href"].as_str().unwrap()).expect(200);
            assert_eq!(answer.body.len() as i64, file["bytes"].as_i64().unwrap());
            assert!(answer.header("content-type").unwrap().starts_with(file["media_type"].as_str().unwrap()));
            assert!(answer.header("content-security-policy").unwrap().contains("sandbox"), "results are never run");
        }
        resampled_as_exported(folder, &service, name, &job);
        remaining_life(&service, &job, &ended);
    }
}

/// Whether a line of a report has a moment or a hash in it.
fn is_of_this_run(line: &str) -> bool {
    ["Analyzed</dt>", "SHA-256"].iter().any(|words| line.contains(words))
}

/// `points` and `every_cycles` are those of `perilife export`.
fn resampled_as_exported(folder: &Path, service: &Server, name: &str, job: &str) {
    for (query, option) in [("points=40", ["--points", "40"]), ("every_cycles=777.5", ["--every-cycles", "777.5"])] {
        done(folder, &["export", name, "--out", "export.csv", option[0], option[1]]);
        assert_eq!(service.file(job, &format!("a_n.csv?{query}")), fs::read(folder.join("export.csv")).unwrap(), "{query}");
    }
    for (query, status) in [
        ("points=1", 422),
        ("every_cycles=-1", 422),
        ("every_cycles=1e-9", 422),
        ("points=x", 400),
        ("points=9&every_cycles=9", 400),
    ] {
        service.get(&format!("{job}/files/a_n.csv?{query}")).expect(status);
    }
    service.get(&format!("{job}/files/result.json?points=9")).expect(400);
}

/// Remaining life is what the curve says between its rows.
fn remaining_life(service: &Server, job: &str, ended: &Value) {
    let number = |value: &Value| value.as_f64().unwrap();
    let (from, to) = (number(&ended["summary"]["crack_length_initial_mm"]), number(&ended["summary"]["crack_length_final_mm"]));
    let life = number(&ended["summary"]["life_cycles"]);
    let middle = 0.5 * (from + to);
    let answer = service.get(&format!("{job}/remaining?crack_length_mm={middle}&factor=3")).expect(200).json();
    let table = String::from_utf8(service.file(job, "a_n.csv")).unwrap();
    let rows: Vec<[f64; 2]> = table
        .lines()
        .skip(1)
        .map(|line| {
            let mut fields = line.split(',').map(|field| field.parse().unwrap());
            [fields.next().unwrap(), fields.next().unwrap()]
        })
        .collect();
    let pair = rows.windows(2).find(|pair| pair[0][1] <= middle && middle < pair[1][1]).unwrap();
    let at = Monotone::new(rows.iter().map(|&[cycles, length]| [length, cycles])).at(middle);
    assert!(pair[0][0] < at && at < pair[1][0], "{pair:?} {at}");
    assert!((number(&answer["cycles_at"]) / at - 1.0).abs() < 1e-12, "{answer} {at}");
    assert!((number(&answer["remaining_cycles"]) - (life - at)).abs() < 1e-9 * life);
    assert!((number(&answer["inspection_interval_cycles"]) * 3.0 - (life - at)).abs() < 1e-9 * life);
    for (query, status) in
        [("crack_length_mm=1", 422), ("crack_length_mm=1e9", 422), ("crack_length_mm=NaN", 422), ("factor=2", 400)]
    {
        service.get(&format!("{job}/remaining?{query}")).expect(status);
    }
    let less = service.get(&format!("{job}/remaining?crack_length_mm={middle}&factor=0.5")).expect(422);
    assert!(less.text().contains("is not 1 or more"));
    // The report has the data of the job, and an interval if asked for.
    service.change(job, &json!({ "report": { "laboratory": "Lab <North>", "number": "R-7" } })).expect(200);
    let report = |query: &str| service.get(&format!("{job}/report{query}")).expect(200).text();
    assert!(report("").contains("Lab &lt;North&gt;") && !report("").contains("Inspection interval"), "{}", report(""));
    assert!(report(&format!("?crack_length_mm={middle}")).contains("Inspection interval"));
    service.get(&format!("{job}/report?factor=3")).expect(400);
    // In the units of who asks, whatever others ask for.
    for (query, own, other) in [("?units=us", " ksi", " MPa"), ("?units=si", " MPa", " ksi"), ("", " MPa", " ksi")] {
        let text = report(query);
        assert!(text.contains(own) && !text.contains(other), "{query}: {text}");
    }
    service.get(&format!("{job}/report?units=imperial")).expect(400);
}

/// Further analyses are runs with options, refused before they are run.
#[test]
fn further_analyses_are_options() {
    let dir = tempdir().unwrap();
    let service = server(dir.path());
    let body = |options: Value| json!({ "input": QUICK, "options": options });
    let asked = json!({ "sensitivities": true, "residual_strength": true, "inspect_from_mm": 10, "pod": "9.5,10" });
    let job = service.submit("predictions", &body(asked));
    service.succeeded(&job);
    let result: Value = serde_json::from_slice(&service.file(&job, "result.json")).unwrap();
    assert!(result["sensitivities"].is_array() && result["inspections"]["a90_mm"] == json!(10.0), "{result:#}");
    service.file(&job, "residual_strength.svg");
    for (options, words) in [
        (json!({ "pod": "9,8" }), "two increasing crack lengths"),
        (json!({ "pod": "8,9" }), "options.inspect_from_mm: is missing"),
        (json!({ "factor": "x" }), "options.factor = x"),
        (json!({ "measured": "plate.csv" }), "was not uploaded"),
        (json!({ "fleet": 9 }), "is no option of this job"),
    ] {
        let refused = service.post("/v1/predictions", &body(options)).expect(422);
        assert!(refused.text().contains(words), "{}", refused.text());
    }
}

/// Readings as the quick plate would give them.
fn readings(folder: &Path) -> String {
    fs::write(folder.join("measured.toml"), QUICK).unwrap();
    done(folder, "predict measured.toml --out measured");
    done(folder, "export measured --out measured.csv --points 30");
    let table = fs::read_to_string(folder.join("measured.csv")).unwrap();
    let rows = table.lines().skip(1).map(|line| line.split(',').take(2).collect::<Vec<_>>().join(",") + "\n");
    "cycles,crack_length_mm\n".to_owned() + &rows.collect::<String>()
}

#[test]
fn a_calibration_has_the_files_of_the_command_and_serves_predictions() {
    let dir = tempdir().unwrap();
    let folder = dir.path();
    let service = server(folder);
    let curve = readings(folder);
    fs::write(folder.join("curve.csv"), &curve).unwrap();
    for (name, method) in [("bonds", "spacing_mm = 1.5"), ("hand", "method = \"handbook\"")] {
        let text = test_of_quick(method);
        fs::write(folder.join(format!("{name}.toml")), &text).unwrap();
        done(folder, &["calibrate", &format!("{name}.toml"), "--out", name]);
        // As JSON with the files in it, and as a form that names no files.
        let job = service.submit("calibrations", &json!({ "name": name, "input": text, "files": { "curve.csv": curve } }));
        let ended = service.succeeded(&job);
        let tables: &[&str] = if cfg!(feature = "tables") { &["fit_curves.parquet"] } else { &[] };
        for file in ["fitted.toml", "fit_curves.csv", "fit_band.csv", "fit.svg", "da_dn.svg"].iter().chain(tables) {
            assert!(service.file(&job, file) == fs::read(folder.join(name).join(file)).unwrap(), "{name}: {file} differs");
        }
        // `curl -F input=@case.toml` names the file that the text is from.
        let input = ("input", (name == "hand").then_some("case.toml"), &*text.replace("files = [\"curve.csv\"]", ""));
        let again = service.send_form("/v1/calibrations", &[("name", None, name), input, ("file", Some("curve.csv"), &curve)]);
        let again = format!("/v1/calibrations/{}", again.expect(202).json()["id"].as_str().unwrap());
        service.succeeded(&again);
        assert_eq!(service.file(&again, "fitted.toml"), service.file(&job, "fitted.toml"), "{name}: as a form");

        let came = &service.get(&again).json()["inputs"][0];
        assert_eq!((&came["name"], &came["media_type"]), (&"curve.csv".into(), &"text/csv".into()));
        assert_eq!(service.get(came["href"].as_str().unwrap()).expect(200).text(), curve);

        // A case with this law, whatever its own.
        let case = if name == "hand" {
            QUICK.replace("[model]\nspacing_mm = 1.5\n", "[model]\nmethod = \"handbook\"\n")
        } else {
            QUICK.to_owned()
        };
        let body = json!({ "name": "case", "input": case, "calibration": ended["id"] });
        let prediction = service.submit("predictions", &body);
        fs::write(
            folder.join("case.toml"),
            case.replace("a = 6450.0\np = 2.86\nhorizon_mm = 3.015\n", &format!("fitted = \"{name}/fitted.toml\"\n")),
        )
        .unwrap();
        done(folder, "predict case.toml --out case");
        assert_eq!(service.succeeded(&prediction)["calibration"], ended["id"]);
        assert!(service.file(&prediction, "a_n.csv") == fs::read(folder.join("case/a_n.csv")).unwrap(), "{name}: with the fit");

        // What is left has the band of the table, and the interval comes from its low end, as on the command line.
        let (words, _) = done(folder, "predict case.toml --out case --inspect-from 14 --json");
        let asked = serde_json::from_str::<Value>(&words).unwrap()["inspection"].clone();
        let left = service.get(&format!("{prediction}/remaining?crack_length_mm=14")).expect(200).json();
        assert_eq!(left["has_band"], true, "{left}");
        for key in ["remaining_cycles_p05", "remaining_cycles_p95", "inspection_interval_cycles", "factor"] {
            let [ours, theirs] = [&left, &asked].map(|answer| answer[key].as_f64().unwrap());
            assert!((ours / theirs - 1.0).abs() < 1e-12, "{key}: {left} {asked}");
        }
    }
}

/// The band of a fit holds its curve, and is wider where less is known.
#[test]
fn the_band_of_a_fit_is_about_its_curve() {
    let dir = tempdir().unwrap();
    let folder = dir.path();
    fs::write(folder.join("curve.csv"), readings(folder)).unwrap();
    fs::write(folder.join("hand.toml"), test_of_quick("method = \"handbook\"")).unwrap();
    done(folder, "calibrate hand.toml --out fit");
    let table = fs::read_to_string(folder.join("fit/fit_band.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("crack_length_mm,cycles_fitted,cycles_low,cycles_high"));
    let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect();
    let report: Value = serde_json::from_slice(&fs::read(folder.join("fit/fit.json")).unwrap()).unwrap();
    let rate_error = report["rate_at_pivot_relative_error"].as_f64().unwrap();
    for row in &rows[1..] {
        let [_, fitted, low, high] = row[..] else { panic!("{row:?}") };
        assert!(low < fitted && fitted < high);
        // Never narrower than the rate alone leaves it, and the same factor both ways.
        assert!((high / fitted).ln() >= 1.96 * rate_error * (1.0 - 1e-9));
        assert!(((high / fitted) / (fitted / low) - 1.0).abs() < 1e-9);
    }
    assert_eq!(rows.len(), 30);
}

/// What a check says is what the command says; measured files are read to their end whatever is wrong in them.
#[test]
fn inputs_are_looked_at_as_by_the_command() {
    let dir = tempdir().unwrap();
    let folder = dir.path();
    let service = server(folder);
    fs::write(folder.join("case.toml"), QUICK).unwrap();
    let theirs: Value = serde_json::from_str(&done(folder, "check case.toml --json").0).unwrap();
    let mut ours = service.post("/v1/check", &json!({ "name": "case", "input": QUICK })).expect(200).json();
    // Beside its form the plate is drawn as that of a result is, without a path.
    let drawn = ours.as_object_mut().unwrap().remove("drawing").unwrap();
    let drawn = drawn.as_str().unwrap();
    assert!(["plate-body", "plate-load", "flaw"].iter().all(|part| drawn.contains(&format!("class=\"{part}\""))), "{drawn}");
    assert_eq!(ours, theirs);
    // The same input as an object.
    let table: toml::Table = QUICK.parse().unwrap();
    let object = service.post("/v1/check", &json!({ "name": "case", "input": table })).expect(200).json();
    assert_eq!(object["understood"], theirs["understood"]);

    let csv = "N; a_mm\n0; 9,0\n1000; 9,5\nx; 10\n3000; 11\n2500; 12\n4000; 12,5\n5000; 13\n";
    let csv = csv.replace('N', "cycles");
    let looked_at = |parts: &[(&str, Option<&str>, &str)]| service.send_form("/v1/measured", parts);
    let found = looked_at(&[("file", Some("a.csv"), &csv), ("file", Some("b.csv"), "what,is\n1,2\n")]).expect(200).json();
    let [a, b] = [&found["files"][0], &found["files"][1]];
    assert_eq!(
        a["columns"],
        json!({ "layout": "long", "length_unit": "mm", "cycle_unit": "cycles", "decimal_comma": true, "separator": "semicolons",
        "keys": ["cycles", "length"] })
    );
    assert_eq!((&a["header"], &a["first_rows"][1]), (&json!(["cycles", "a_mm"]), &json!(["1000", "9,5"])));
    assert_eq!(a["curves"][0]["lines"], json!([2, 3, 5, 7, 8]));
    let problems: Vec<(i64, &str)> =
        a["problems"].as_array().unwrap().iter().map(|p| (p["line"].as_i64().unwrap(), p["problem"].as_str().unwrap())).collect();
    assert_eq!(problems, [(4, "is not a number"), (6, "is below the previous reading (3000)")]);
    assert!(b["columns"].is_null() && b["curves"] == json!([]) && b["problems"][0]["problem"] == "unknown column");
    assert_eq!((&b["header"], &b["first_rows"]), (&json!(["what", "is"]), &json!([["1", "2"]])));

    // What the user says: as in [measured].
    let odd = "what;is;P\n1.000;9;6\n2.000;10;6\n3.000;11;6\n4.000;12;7\n5.000;13;7\n";
    let said = [
        ("columns", "{\"cycles\":\"what\",\"length\":[\"2\"],\"force_max\":\"P\"}"),
        ("length_unit", "mm"),
        ("load_unit", "kN"),
        ("decimal", ","),
    ];
    let send = |said: &[(&str, &str)]| {
        let fields = said.iter().map(|(name, value)| (*name, None, *value));
        looked_at(&fields.chain([("file", Some("odd.csv"), odd)]).collect::<Vec<_>>())
    };
    let found = send(&said).expect(200).json();
    let file = &found["files"][0];
    assert_eq!(file["columns"]["keys"], json!(["cycles", "length", "force_max"]), "{file}");
    assert_eq!(file["curves"][0]["cycles"], json!([1000.0, 2000.0, 3000.0, 4000.0, 5000.0]));
    // Rows that are left out by line and value are wrong no more; the others are read around them.
    let rows = r#"[{ "file": "a.csv", "line": 4, "value": "x", "reason": "typing error" }, { "file": "a.csv", "line": 6, "value": "2500", "reason": "counter" }]"#;
    let left = looked_at(&[("leave_out", None, rows), ("file", Some("a.csv"), &csv)]).expect(200).json()["files"][0].clone();
    assert_eq!((&left["problems"], &left["curves"][0]["lines"]), (&json!([]), &json!([2, 3, 5, 7, 8])), "{left}");
    let open = send(&said[..3]).expect(200).json();
    assert!(open["files"][0]["problems"][0]["problem"].as_str().unwrap().contains("is ambiguous: "), "{open}");
    for (field, value, words) in [
        ("columns", "[1]", "is not a table of columns, such as { cycles = \\\"N\\\""),
        ("decimal", ";", "is not a known unit"),
        ("leave_out", "{}", "give a JSON list of { file, line, value, reason }"),
        ("colums", "x", "known are file, length_unit"),
    ] {
        let answer = send(&[(field, value)]);
        assert!(answer.text().contains(words), "{field}: {}", answer.text());
    }
}

/// A sweep is checked as one; it was taken for a case without sections.
#[test]
fn sweeps_are_checked_as_such() {
    let (_dir, service) = Server::alone(&["--jobs", "0"]);
    let grid = "case = \"base.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"loading.stress_range_mpa\"\nfrom = 40\nto = 60\ncount = 5\n";
    let sweep = json!({ "name": "few", "input": grid, "files": { "base.toml": QUICK } });
    assert_says(&service.post("/v1/check", &sweep).expect(200).text(), &["\"computing\"", "5 cases of base, grid"]);
}
