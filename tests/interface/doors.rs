//! One case, one answer: every example of `data/cases` through every door, and what a result says of how it came about.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use assert_cmd::cargo::{cargo_bin, cargo_bin_cmd};
use perilife::input::sha256;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};
use toml::Table;

use crate::cli::{perilife, texts};
use crate::daily::{PANEL, READINGS};
use crate::server::{Server, in_folder};
use crate::slurm::Slurm;

/// Spacing over that of the example: the doors are tried, not the model.
const COARSER: f64 = 2.0;

/// An example as this test runs it: its name, its text, the files that it names by their names there.
struct Example {
    name: String,
    text: String,
    files: Vec<(String, Vec<u8>)>,
}

/// All of `data/cases`, coarser, and one of every key that names a file.
fn examples() -> Vec<Example> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cases");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    let mut all: Vec<Example> = paths
        .iter()
        .map(|path| {
            let mut table: Table = fs::read_to_string(path).unwrap().parse().unwrap();
            let model = table["model"].as_table_mut().unwrap();
            if let Some(spacing) = model.get("spacing_mm").and_then(toml::Value::as_float).filter(|spacing| *spacing < 4.0) {
                model.insert("spacing_mm".to_owned(), (COARSER * spacing).into());
            }
            // A number without a short decimal: a door that loses its last digits gives another life.
            table["loading"].as_table_mut().unwrap().insert("stress_ratio".to_owned(), (0.1_f64 + 0.2).into());
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            Example { name, text: toml::to_string(&table).unwrap(), files: Vec::new() }
        })
        .collect();
    assert!(all.len() >= 11, "{}", all.len());
    let (plate, _) = PANEL.split_once("[fatigue]").unwrap();
    let own = "youngs_modulus_gpa = { value = 71.1, source = \"a\" }\npoisson_ratio = { value = 0.331, source = \"b\" }\n";
    let own = format!("title = \"own\"\n{own}yield_strength_mpa = {{ value = 345.0, source = \"c\" }}\n");
    let rates = "delta_k_mpa_sqrt_m,da_dn_mm_per_cycle\n1,1e-9\n10,1.0000000000000002e-5\n100,1e-2\n";
    all.push(Example {
        name: "named_files".to_owned(),
        text: plate.replace("al2024-t3", "data/own.toml")
            + "[fatigue]\ngrowth_law = \"table\"\ngrowth_table = \"data/rates.csv\"\n[stop]\ncrack_length_mm = 49.8\n",
        files: vec![("data/own.toml".to_owned(), own.into_bytes()), ("data/rates.csv".to_owned(), rates.as_bytes().to_vec())],
    });
    all
}

fn written(examples: &[Example]) -> TempDir {
    let dir = tempdir().unwrap();
    fs::create_dir(dir.path().join("data")).unwrap();
    for example in examples {
        fs::write(dir.path().join(format!("{}.toml", example.name)), &example.text).unwrap();
        example.files.iter().for_each(|(name, content)| fs::write(dir.path().join(name), content).unwrap());
    }
    dir
}

fn done(folder: &Path, arguments: &[&str]) {
    let output = perilife(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", texts(&output).1);
}

/// What has to be the same: the tables, and all figures but those of time, place and memory.
fn answer(folder: &Path) -> (Vec<Vec<u8>>, Value) {
    let tables =
        ["a_n.csv", "crack_path.csv"].map(|file| fs::read(folder.join(file)).unwrap_or_else(|e| panic!("{folder:?}: {e}")));
    (tables.to_vec(), figures(&fs::read(folder.join("result.json")).unwrap()))
}

fn figures(result: &[u8]) -> Value {
    let mut result: Value = serde_json::from_slice(result).unwrap();
    // The law says where it was read; an echo names its files as they lie beside it.
    for key in ["wall_s", "memory_mb", "finished", "inputs", "name", "case", "warnings", "overrides"] {
        result.as_object_mut().unwrap().remove(key);
    }
    result
}

/// The command by file, pipe and `-`, the echo of each, and a sweep on this machine, by a service and by Slurm.
#[test]
fn every_example_through_every_door_of_the_command_line() {
    let examples = examples();
    let dir = written(&examples);
    let here = dir.path();
    let place = in_folder(&here.join("service"));
    let _service = Server::start(&[&place[0], &place[1]], &["--jobs", "2"]);
    let cluster = Slurm::start();
    for Example { name, text, .. } in &examples {
        let (file, run) = (format!("{name}.toml"), format!("{name}/predict"));
        done(here, &["predict", &file, "--out", &run, "-q"]);
        let right = answer(&here.join(&run));
        assert!(right.0[0].len() > 200, "{name}: a curve");
        for stdin in ["-", "/dev/stdin"] {
            let out = format!("{name}/pipe{}", stdin.len());
            let mut command = cargo_bin_cmd!("perilife");
            command.current_dir(here).args(["predict", stdin, "--out", &out, "-q"]).write_stdin(text.as_str());
            assert!(command.output().unwrap().status.success());
            assert_eq!(answer(&here.join(&out)), right, "{name} by {stdin}");
        }
        // The echo, from another folder, of a run that has been moved there.
        fs::create_dir(here.join("elsewhere")).unwrap();
        fs::rename(here.join(&run), here.join("elsewhere/moved")).unwrap();
        done(&here.join("elsewhere"), &["predict", "moved/case.toml", "--out", "again", "-q"]);
        assert_eq!(answer(&here.join("elsewhere/again")), right, "{name} by its echo");
        fs::remove_dir_all(here.join("elsewhere")).unwrap();

        let table: Table = text.parse().unwrap();
        let thickness = table["specimen"]["thickness_mm"].as_float().unwrap();
        let sweep = "[design]\nkind = \"grid\"\n[[vary]]\nkey = \"specimen.thickness_mm\"\nvalues = ";
        fs::write(here.join("sweep.toml"), format!("case = \"{file}\"\n{sweep}[{thickness:?}]\n")).unwrap();
        for engine in ["local", "service", "slurm"] {
            let out = format!("{name}/{engine}");
            let mut command = Command::new(cargo_bin("perilife"));
            command.current_dir(here).args(["sweep", "sweep.toml", "--out", &out, "-q", "--engine", engine]);
            match (engine, &cluster) {
                ("service", _) => drop(command.args(&place)),
                ("slurm", Some(cluster)) => drop(command.arg("--wait").env("SLURM_CONF", cluster.conf())),
                ("slurm", None) => continue,
                _ => {}
            }
            let output = command.output().unwrap();
            assert!(output.status.success(), "{name} by {engine}: {}", texts(&output).1);
            let case = here.join(&out).join("cases/0001");
            assert_eq!(answer(&case), right, "{name} by {engine}");
            done(here, &["predict", case.join("case.toml").to_str().unwrap(), "--out", &format!("{name}/echo_{engine}"), "-q"]);
            assert_eq!(answer(&here.join(format!("{name}/echo_{engine}"))), right, "{name} by the echo of {engine}");
        }
    }
}

/// TOML, an object in JSON, text in JSON, and a form of either.
#[test]
fn every_example_through_every_door_of_the_service() {
    let examples = examples();
    let dir = written(&examples);
    let here = dir.path();
    let place = in_folder(&here.join("service"));
    let service = Server::start(&[&place[0], &place[1]], &["--jobs", "2"]);
    for Example { name, text, files } in &examples {
        done(here, &["predict", &format!("{name}.toml"), "--out", name, "-q"]);
        let (tables, right) = answer(&here.join(name));
        let table: Table = text.parse().unwrap();
        let object = serde_json::to_value(&table).unwrap();
        let texts_of: serde_json::Map<String, Value> =
            files.iter().map(|(name, content)| (name.clone(), String::from_utf8(content.clone()).unwrap().into())).collect();
        let form = |input: &str| {
            let parts = files.iter().map(|(name, content)| {
                let content = String::from_utf8_lossy(content);
                format!("--XX\r\ncontent-disposition: form-data; name=\"file\"; filename=\"{name}\"\r\n\r\n{content}\r\n")
            });
            let input = format!("--XX\r\ncontent-disposition: form-data; name=\"input\"\r\n\r\n{input}\r\n");
            (input + &parts.collect::<String>() + "--XX--\r\n").into_bytes()
        };
        let multipart = "Multipart/Form-Data; boundary=XX";
        let json_of = |input: Value| json!({ "input": input, "files": texts_of }).to_string().into_bytes();
        let mut doors: Vec<(&str, &str, Vec<u8>)> = vec![
            ("object in JSON", "application/json", json_of(object.clone())),
            ("text in JSON", "Application/JSON; charset=utf-8", json_of(text.clone().into())),
            ("TOML in a form", multipart, form(text)),
            ("JSON in a form", multipart, form(&object.to_string())),
        ];
        if files.is_empty() {
            doors.push(("TOML", "APPLICATION/TOML", text.clone().into_bytes()));
        }
        for (door, kind, body) in doors {
            let job = service.send("POST", "/v1/predictions", &[("content-type", kind)], &body).expect(202).json();
            let job = format!("/v1/predictions/{}", job["id"].as_str().unwrap());
            service.succeeded(&job);
            let found = ["a_n.csv", "crack_path.csv"].map(|file| service.file(&job, file)).to_vec();
            assert!(found == tables, "{name} as {door}: another curve");
            assert_eq!(figures(&service.file(&job, "result.json")), right, "{name} as {door}");
        }
    }
}

/// `calibrate --predict` gives what `predict` gives with the record, and refuses what that refuses.
#[test]
fn a_calibration_predicts_as_predict_does() {
    let examples = examples();
    let dir = written(&examples);
    let here = dir.path();
    let (plate, _) = PANEL.split_once("[fatigue]").unwrap();
    fs::write(here.join("readings.csv"), READINGS).unwrap();
    let plate = plate.replace("stress_ratio = 0.2", &format!("stress_ratio = {}", 0.1 + 0.2));
    fs::write(here.join("fit.toml"), format!("[measured]\nfiles = [\"readings.csv\"]\n{plate}")).unwrap();
    done(here, &["calibrate", "fit.toml", "--out", "fit", "-q"]);
    let mut same = 0;
    for Example { name, text, .. } in &examples {
        let mut table: Table = text.parse().unwrap();
        let fatigue = table["fatigue"].as_table_mut().unwrap();
        ["a", "p", "horizon_mm", "paris_c_mm_per_cycle", "paris_m", "growth_law", "growth_table"]
            .iter()
            .for_each(|key| drop(fatigue.remove(*key)));
        fatigue.insert("allow_extrapolation".to_owned(), true.into());
        fs::write(here.join("plain.toml"), toml::to_string(&table).unwrap()).unwrap();
        table["fatigue"].as_table_mut().unwrap().insert("fitted".to_owned(), "fit/fitted.toml".into());
        fs::write(here.join("with_fit.toml"), toml::to_string(&table).unwrap()).unwrap();
        let by_predict = perilife(here, &["predict", "with_fit.toml", "--out", &format!("{name}_p"), "-q"]);
        let by_fit = perilife(here, &["calibrate", "fit.toml", "--predict", "plain.toml", "--out", &format!("{name}_c"), "-q"]);
        assert_eq!(by_predict.status.code(), by_fit.status.code(), "{name}: {} {}", texts(&by_predict).1, texts(&by_fit).1);
        if by_predict.status.success() {
            let (tables, _) = answer(&here.join(format!("{name}_p")));
            let run = here.join(format!("{name}_c/plain"));
            assert_eq!(answer(&run).0, tables, "{name}");
            done(here, &["predict", run.join("case.toml").to_str().unwrap(), "--out", &format!("{name}_e"), "-q"]);
            assert_eq!(answer(&here.join(format!("{name}_e"))).0, tables, "{name} by the echo");
            same += 1;
        }
    }
    assert!(same >= 8, "{same} of {} examples run with the record", examples.len());
}

/// Hashes of all that was read, the texts, overrides, time with zone, commit; a fracture scene and a calibration are repeated by their
/// echoes as well.
#[test]
fn a_result_says_what_made_it() {
    let dir = written(&examples());
    let here = dir.path();
    let call = [
        "predict",
        "named_files.toml",
        "--out",
        "run",
        "-q",
        "--set",
        "loading.stress_ratio=0.25",
        "--set",
        "stop.crack_length_mm=40",
    ];
    done(here, &call);
    let result: Value = serde_json::from_slice(&fs::read(here.join("run/result.json")).unwrap()).unwrap();
    for (place, file) in ["named_files.toml", "data/own.toml", "data/rates.csv"].into_iter().enumerate() {
        let content = fs::read(here.join(file)).unwrap();
        let said = &result["inputs"][place];
        assert_eq!(
            (&said["file"], &said["sha256"], &said["bytes"]),
            (&json!(file), &json!(sha256(&content)), &json!(content.len()))
        );
        assert_eq!(fs::read(here.join("run").join(said["kept_as"].as_str().unwrap())).unwrap(), content);
    }
    assert_eq!(result["overrides"], json!(["loading.stress_ratio=0.25", "stop.crack_length_mm=40"]));
    let finished = result["finished"].as_str().unwrap();
    assert!(finished.len() == 20 && finished.ends_with('Z') && finished.starts_with("20"), "{finished}");
    assert!(result["commit"].is_null() || result["commit"].as_str().unwrap().len() >= 40);
    // Overrides are in the echo, which repeats the run.
    done(here, &["predict", "run/case.toml", "--out", "again", "-q"]);
    assert_eq!(answer(&here.join("again")), answer(&here.join("run")));
    done(here, &["check", "run/case.toml"]);

    crate::daily::write_inputs(here);
    for (command, input, table) in [("fracture", "scene.toml", "history.csv"), ("calibrate", "fit.toml", "fitted.toml")] {
        done(here, &[command, input, "--out", command, "-q"]);
        let echo = format!("{command}/case.toml");
        done(here, &[command, &echo, "--out", "echoed", "-q"]);
        let [first, second] = [command, "echoed"].map(|out| fs::read_to_string(here.join(out).join(table)).unwrap());
        // A record names its readings as the file did.
        assert_eq!(first.replace("\"readings.csv\"", "\"inputs/readings.csv\""), second, "{command}");
        let name = if command == "fracture" { "result.json" } else { "fit.json" };
        let said: Value = serde_json::from_slice(&fs::read(here.join(command).join(name)).unwrap()).unwrap();
        assert_eq!(said["inputs"][0]["sha256"], json!(sha256(&fs::read(here.join(input)).unwrap())));
        fs::remove_dir_all(here.join("echoed")).unwrap();
    }
}

/// A file that a case names, whatever the key, goes along with a sweep; when it changes, the sweep is run again.
#[test]
fn a_sweep_takes_along_what_its_cases_read() {
    let dir = written(&examples());
    let here = dir.path();
    let design = "[design]\nkind = \"grid\"\n[[vary]]\nkey = \"specimen.crack_length_mm\"\nvalues = [9.0, 10.0]\n";
    fs::write(here.join("sweep.toml"), format!("case = \"named_files.toml\"\n{design}")).unwrap();
    let life =
        || fs::read_to_string(here.join("out/sweep.csv")).unwrap().lines().nth(1).unwrap().split(',').nth(2).unwrap().to_owned();
    done(here, &["check", "sweep.toml"]);
    done(here, &["sweep", "sweep.toml", "--out", "out", "-q"]);
    done(here, &["predict", "named_files.toml", "--out", "run", "-q"]);
    let result: Value = serde_json::from_slice(&fs::read(here.join("run/result.json")).unwrap()).unwrap();
    assert_eq!(life().parse::<f64>().ok(), result["life_cycles"].as_f64());
    for file in ["data/rates.csv", "data/own.toml"] {
        let (before, text) = (life(), fs::read_to_string(here.join(file)).unwrap());
        fs::write(here.join(file), text.replace("1e-2", "2e-2").replace("345.0", "145.0")).unwrap();
        let output = perilife(here, &["sweep", "sweep.toml", "--out", "out", "-q"]);
        assert!(
            output.status.success() && texts(&output).1.contains("2 of 2 finished cases go: 0001, 0002"),
            "{}",
            texts(&output).1
        );
        assert_ne!(life(), before, "{file}");
    }
    fs::remove_file(here.join("data/rates.csv")).unwrap();
    let output = perilife(here, &["sweep", "sweep.toml", "--out", "out", "-q"]);
    crate::cli::assert_refused(&output, 4, &["data/rates.csv", "cannot read"]);
    // Another sweep than the one that stands there is refused, and names what would go.
    fs::write(here.join("data/rates.csv"), "delta_k_mpa_sqrt_m,da_dn_mm_per_cycle\n1,1e-9\n100,1e-2\n").unwrap();
    fs::rename(here.join("sweep.toml"), here.join("other.toml")).unwrap();
    let output = perilife(here, &["sweep", "other.toml", "--out", "out", "-q"]);
    crate::cli::assert_refused(&output, 2, &["holds another sweep, sweep, with 2 of 2 cases done", "give another folder"]);
}
