//! `/openapi.json`: whole, true of what the service answers, and of use to the programs of others.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use perilife::guide::{PAGES, page};
use serde_json::Value;
use tempfile::tempdir;

use super::{QUICK, of};
use crate::support::server::{Answer, Server, in_folder};

const PROBLEM: &str = "application/problem+json";

/// A service without tokens in a folder, and its description.
fn described(folder: &std::path::Path, options: &[&str]) -> (Server, Value) {
    let place = in_folder(folder);
    let service = Server::start(&place, options);
    let api = service.get("/openapi.json").expect(200).json();
    (service, api)
}

/// Method, path and description of every operation.
fn operations(api: &Value) -> Vec<(&str, &str, &Value)> {
    let mut all = Vec::new();
    for (path, item) in api["paths"].as_object().unwrap() {
        all.extend(item.as_object().unwrap().iter().map(|(method, operation)| (method.as_str(), path.as_str(), operation)));
    }
    all
}

/// Every reference within a value.
fn references<'a>(value: &'a Value, found: &mut BTreeSet<&'a str>) {
    match value {
        Value::Object(fields) => {
            found.extend(fields.get("$ref").and_then(Value::as_str));
            fields.values().for_each(|value| references(value, found));
        }
        Value::Array(items) => items.iter().for_each(|value| references(value, found)),
        _ => {}
    }
}

#[test]
fn every_operation_is_described_whole() {
    let dir = tempdir().unwrap();
    let (service, api) = described(dir.path(), &["--jobs", "0"]);
    assert_eq!(api["info"]["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!((&api["openapi"], &api["components"]["securitySchemes"]["bearer"]["scheme"]), (&"3.1.0".into(), &"bearer".into()));
    let mut found = BTreeSet::new();
    references(&api, &mut found);
    assert!(found.len() > 10, "{found:?}");
    for reference in found {
        assert!(api.pointer(reference.trim_start_matches('#')).is_some(), "{reference} leads nowhere");
    }

    let (mut ids, mut linked, mut jobs) = (BTreeSet::new(), BTreeSet::new(), 0);
    for (method, path, operation) in operations(&api) {
        let about = format!("{method} {path}");
        assert!(ids.insert(operation["operationId"].as_str().unwrap()), "{about}: its operationId is taken");
        assert!(operation["summary"].as_str().is_some_and(|summary| !summary.is_empty()), "{about}");
        assert_eq!(operation["security"], serde_json::json!([{}, { "bearer": [] }]), "{about}");
        let responses = operation["responses"].as_object().unwrap();
        for status in ["401", "403", "429", "503"] {
            assert!(responses.contains_key(status), "{about} {status}");
        }
        assert!(responses.keys().any(|status| status.starts_with('2')), "{about}");
        for (status, response) in responses {
            assert!(response["description"].as_str().is_some_and(|words| !words.is_empty()), "{about} {status}");
            let links = response["links"].as_object().into_iter().flatten();
            linked.extend(links.map(|(_, link)| link["operationId"].as_str().unwrap()));
            // Of a range that is not there only the size of the file is told.
            if status.as_str() >= "400" && status != "416" {
                let problem = &response["content"][PROBLEM]["schema"]["$ref"];
                assert_eq!(problem, "#/components/schemas/Problem", "{about} {status}");
                assert_eq!(response["content"].as_object().unwrap().len(), 1, "{about} {status}");
            }
        }
        for parameter in operation["parameters"].as_array().into_iter().flatten() {
            if parameter["name"] == "collection" {
                assert_eq!(parameter["schema"]["$ref"], "#/components/schemas/Collection", "{about}");
            }
        }
        let taken = &operation["requestBody"]["content"];
        if taken["application/json"]["schema"]["$ref"] == "#/components/schemas/JobRequest" {
            jobs += 1;
            assert_eq!(taken["application/toml"]["schema"]["type"], "string", "{about}");
            assert_eq!(taken["multipart/form-data"]["schema"]["$ref"], "#/components/schemas/JobForm", "{about}");
        }
        assert!(taken.is_null() || operation["requestBody"]["required"] == true, "{about}");
    }
    assert!(jobs >= 2, "{jobs} operations take jobs");
    assert!(!linked.is_empty() && linked.is_subset(&ids), "{linked:?}");
    let form = &api["components"]["schemas"]["JobForm"];
    for field in ["name", "input", "calibration"] {
        assert_eq!(form["properties"][field]["type"], "string", "{field}");
    }
    assert_eq!(form["properties"]["file"]["items"]["format"], "binary");
    for collection in api["components"]["schemas"]["Collection"]["enum"].as_array().unwrap() {
        service.get(&format!("/v1/{}", collection.as_str().unwrap())).expect(200);
    }
    // The names of functions in clients that others have made: new ones may come, these stay.
    let known = "cancel check delete events file health input_file kinds list materials measured metrics picture ready remaining \
                 service show submit";
    for known in known.split(' ') {
        assert!(ids.contains(known), "{known} in {ids:?}");
    }
}

/// Whether an operation is described with this answer: its status, and its media type where it has one.
fn assert_described(operation: &Value, path: &str, answer: &Answer) {
    let response = &operation["responses"][answer.status.to_string()];
    assert!(!response.is_null() && answer.status < 500, "GET {path} is not described with {}: {}", answer.status, answer.text());
    let kind = answer.header("content-type").unwrap_or_default().split(';').next().unwrap_or_default();
    let described = response["content"].as_object();
    let is_described = described.is_some_and(|content| content.contains_key(kind) || content.contains_key("*/*"));
    assert!(is_described || (kind.is_empty() && described.is_none()), "GET {path} {} of type {kind:?}", answer.status);
}

/// Whatever is looked at, there or not there, the answer is one of those described.
#[test]
fn answers_are_those_described() {
    let dir = tempdir().unwrap();
    let (service, api) = described(dir.path(), &["--jobs", "1"]);
    let job = service.submit("predictions", &of("case", QUICK));
    service.succeeded(&job);
    let id = job.rsplit('/').next().unwrap();
    let mut statuses = BTreeSet::new();
    for (_, path, operation) in operations(&api).into_iter().filter(|(method, ..)| *method == "get") {
        let filled = |collection: &str, id: &str, name: &str| {
            path.replace("{collection}", collection).replace("{id}", id).replace("{name}", name)
        };
        let required = |parameter: &&Value| parameter["in"] == "query" && parameter["required"] == true;
        let parameters = operation["parameters"].as_array().into_iter().flatten().filter(required);
        let query: Vec<String> = parameters.map(|parameter| format!("{}=15", parameter["name"].as_str().unwrap())).collect();
        let query = query.join("&");
        for place in [
            filled("predictions", id, "a_n.csv"),
            filled("predictions", id, "result.json"),
            filled("calibrations", id, "a_n.csv"),
            filled("predictions", "01a202b2-bf2d-75fe-996b-265c5720d3fc", "no"),
            filled("nothing", "no", "no"),
            filled("%ff", "%ff", "%ff"),
        ] {
            for query in [&*query, "limit=0", "points=1", "crack_length_mm=x"] {
                let address = format!("{place}?{query}");
                let answer = service.get(&address);
                assert_described(operation, &address, &answer);
                statuses.insert(answer.status);
            }
        }
    }
    assert!([200, 400, 404, 422].iter().all(|status| statuses.contains(status)), "{statuses:?}");
}

/// The Python with `tests/reference/requirements-api.txt` that `PERILIFE_PYTHON` names; `None`, with the reason printed, without.
fn python() -> Option<Command> {
    let python = std::env::var_os("PERILIFE_PYTHON");
    if python.is_none() {
        println!("skipped: PERILIFE_PYTHON does not name a Python with tests/reference/requirements-api.txt");
    }
    python.map(Command::new)
}

/// Runs a program to its good end and shows what it says.
fn run(command: &mut Command) {
    let output = command.output().unwrap();
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    println!("{said}");
    assert!(output.status.success(), "{command:?}: {}", output.status);
}

#[test]
#[ignore = "long: needs Python with tests/reference/requirements-api.txt: PERILIFE_PYTHON=python cargo test a_validator -- --ignored --nocapture"]
fn a_validator_finds_nothing() {
    let Some(mut python) = python() else { return };
    let dir = tempdir().unwrap();
    let (_service, api) = described(dir.path(), &["--jobs", "0"]);
    let file = dir.path().join("openapi.json");
    fs::write(&file, api.to_string()).unwrap();
    run(python.args(["-m", "openapi_spec_validator", "--validation-errors", "all"]).arg(file));
}

#[test]
#[ignore = "long: needs Python with tests/reference/requirements-api.txt: PERILIFE_PYTHON=python cargo test a_generated_client -- --ignored --nocapture"]
fn a_generated_client_runs_a_job() {
    let Some(mut python) = python() else { return };
    let dir = tempdir().unwrap();
    let (service, _) = described(dir.path(), &["--jobs", "1"]);
    let (script, case) = ("/tests/reference/api_client.py", "/data/cases/hand_calculation.toml");
    let [script, case] = [script, case].map(|file| format!("{}{file}", env!("CARGO_MANIFEST_DIR")));
    run(python.args([&script, &service.url, &case]).arg(dir.path()));
    let job = service.get("/v1/predictions").json()["items"][0]["id"].as_str().unwrap().to_owned();
    assert_eq!(fs::read(dir.path().join("a_n.csv")).unwrap(), service.file(&format!("/v1/predictions/{job}"), "a_n.csv"));
}

/// Requests made from the description, whole chains of them: no fault of the program, no answer that is not described.
#[test]
#[ignore = "long: PERILIFE_FUZZ_MINUTES (10), needs Python with tests/reference/requirements-api.txt: PERILIFE_PYTHON=python cargo test requests_made -- --ignored --nocapture"]
fn requests_made_from_the_description_find_no_fault() {
    let Some(mut python) = python() else { return };
    let minutes = std::env::var("PERILIFE_FUZZ_MINUTES").map_or(10.0, |minutes| minutes.parse::<f64>().unwrap());
    let dir = tempdir().unwrap();
    let (service, _) = described(&dir.path().join("service"), &["--jobs", "1", "--points", "2000"]);
    let checks = "not_a_server_error,status_code_conformance,content_type_conformance,response_schema_conformance";
    python.args(["-m", "schemathesis.cli", "--no-color", "run", "--continue-on-failure", "--generation-database", "none"]);
    // A request may ask to wait for the end of a job up to 50 s.
    python.args(["--checks", checks, "--request-timeout", "60", "--max-time", &format!("{:.0}", 60.0 * minutes)]);
    python.arg(format!("{}/openapi.json", service.url)).current_dir(dir.path());
    run(python.env("SCHEMATHESIS_HOOKS", concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/api_hooks.py")));
    service.get("/healthz").expect(200);
}

#[test]
fn the_guide_is_served_and_lists_every_address() {
    let dir = tempdir().unwrap();
    let (service, api) = described(dir.path(), &["--jobs", "0"]);
    for (_, path, _) in operations(&api) {
        assert!(page("http").unwrap().contains(path), "{path} is not in the guide");
    }
    let shown = |address: &str| service.get(address).expect(200).text();
    assert!(shown("/guide").contains("href=\"guide/laboratory\"") && shown("/guide").contains("href=\"style.css\""));
    for (name, _) in PAGES {
        let html = shown(&format!("/guide/{name}"));
        assert!(html.contains("<h1>") && html.contains("href=\"../guide.css\"") && !html.contains("href=\"index.md"), "{name}");
        for link in
            html.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()).filter(|link| !link.contains(['/', '.', ':']))
        {
            assert!(page(link).is_some(), "{name} links to {link}");
        }
    }
    assert_eq!(service.get("/guide/nothing").status, 404);
}
