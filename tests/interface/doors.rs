//! One case, one answer: through every door.

use std::fs;
use std::path::Path;
use std::process::Command;

use assert_cmd::cargo::{cargo_bin, cargo_bin_cmd};
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};
use toml::Table;

use crate::interface::cli::{perilife, texts};
use crate::interface::service::QUICK;
use crate::support::daily::{PANEL, READINGS};
use crate::support::desk::done;
use crate::support::server::{Server, in_folder, multipart};
use crate::support::slurm::Slurm;

/// A case as this test runs it: its name, its text, the files that it names by their names there.
pub struct Example {
    name: &'static str,
    text: String,
    files: Vec<(String, Vec<u8>)>,
}

/// A hand calculation whose case names a file by every key that can, and a plate of some thousand points. What a door can lose are
/// digits, files and forms, not physics; every example of `data/cases` runs in `validation/examples.rs`.
pub fn examples() -> Vec<Example> {
    let (plate, _) = PANEL.split_once("[fatigue]").unwrap();
    let own = "youngs_modulus_gpa = { value = 71.1, source = \"a\" }\npoisson_ratio = { value = 0.331, source = \"b\" }\n";
    let own = format!("title = \"own\"\n{own}yield_strength_mpa = {{ value = 345.0, source = \"c\" }}\n");
    let rates = "delta_k_mpa_sqrt_m,da_dn_mm_per_cycle\n1,1e-9\n10,1.0000000000000002e-5\n100,1e-2\n";
    // A number without a short decimal: a door that loses its last digits gives another life.
    let ratio = format!("stress_ratio = {:?}", 0.1_f64 + 0.2);
    vec![
        Example {
            name: "named_files",
            text: plate.replace("al2024-t3", "data/own.toml").replace("stress_ratio = 0.2", &ratio)
                + "[fatigue]\ngrowth_law = \"table\"\ngrowth_table = \"data/rates.csv\"\n[stop]\ncrack_length_mm = 49.8\n",
            files: vec![("data/own.toml".to_owned(), own.into_bytes()), ("data/rates.csv".to_owned(), rates.as_bytes().to_vec())],
        },
        Example {
            name: "points",
            text: QUICK.replace("stress_ratio = 0.1", &ratio).replace("thickness_mm = 2\n", "thickness_mm = 2.0\n"),
            files: Vec::new(),
        },
    ]
}

pub fn written(examples: &[Example]) -> TempDir {
    let dir = tempdir().unwrap();
    fs::create_dir(dir.path().join("data")).unwrap();
    for example in examples {
        fs::write(dir.path().join(format!("{}.toml", example.name)), &example.text).unwrap();
        example.files.iter().for_each(|(name, content)| fs::write(dir.path().join(name), content).unwrap());
    }
    dir
}

/// What has to be the same: the tables, and all figures but those of time, place and memory.
pub fn answer(folder: &Path) -> (Vec<Vec<u8>>, Value) {
    let tables =
        ["a_n.csv", "crack_path.csv"].map(|file| fs::read(folder.join(file)).unwrap_or_else(|e| panic!("{folder:?}: {e}")));
    (tables.to_vec(), figures(&fs::read(folder.join("result.json")).unwrap()))
}

fn figures(result: &[u8]) -> Value {
    let mut result: Value = serde_json::from_slice(result).unwrap();
    // The law says where it was read; an echo names its files as they lie beside it.
    for key in ["wall_s", "memory_mb", "finished", "commit", "inputs", "name", "case", "warnings", "overrides"] {
        result.as_object_mut().unwrap().remove(key);
    }
    result
}

/// The command by file, pipe and `-`, the echo of each, and a sweep on this machine, by a service and by Slurm.
#[test]
fn a_case_through_every_door_of_the_command_line() {
    let examples = examples();
    let dir = written(&examples);
    let here = dir.path();
    let place = in_folder(&here.join("service"));
    let _service = Server::start(&place, &["--jobs", "2"]);
    let cluster = Slurm::start();
    for Example { name, text, .. } in &examples {
        let (file, run) = (format!("{name}.toml"), format!("{name}/predict"));
        done(here, &format!("predict {file} --out {run} -q"));
        let right = answer(&here.join(&run));
        assert!(right.0[0].len() > 200, "{name}: a curve");
        // By its device: `pipes_are_files`.
        let out = format!("{name}/pipe");
        let mut command = cargo_bin_cmd!("perilife");
        command.current_dir(here).args(["predict", "-", "--out", &out, "-q"]).write_stdin(text.as_str());
        assert!(command.output().unwrap().status.success());
        assert_eq!(answer(&here.join(&out)), right, "{name} by a pipe");
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
        }
    }
}

/// TOML, an object in JSON, text in JSON, and a form of either.
#[test]
fn a_case_through_every_door_of_the_service() {
    let examples = examples();
    let dir = written(&examples);
    let here = dir.path();
    let place = in_folder(&here.join("service"));
    let service = Server::start(&place, &["--jobs", "2"]);
    for Example { name, text, files } in &examples {
        done(here, &["predict", &format!("{name}.toml"), "--out", name, "-q"]);
        let (tables, right) = answer(&here.join(name));
        let table: Table = text.parse().unwrap();
        let object = serde_json::to_value(&table).unwrap();
        let texts_of: serde_json::Map<String, Value> =
            files.iter().map(|(name, content)| (name.clone(), String::from_utf8(content.clone()).unwrap().into())).collect();
        let form = |input: &str| {
            let parts = files.iter().map(|(name, content)| ("file", Some(&**name), str::from_utf8(content).unwrap()));
            multipart(&[("input", None, input)].into_iter().chain(parts).collect::<Vec<_>>()).into_bytes()
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
    done(here, "calibrate fit.toml --out fit -q");
    let mut same = 0;
    for (Example { name, text, .. }, extrapolates) in examples.iter().flat_map(|example| [(example, true), (example, false)]) {
        let name = format!("{name}_{extrapolates}");
        let mut table: Table = text.parse().unwrap();
        let fatigue = table["fatigue"].as_table_mut().unwrap();
        ["a", "p", "horizon_mm", "paris_c_mm_per_cycle", "paris_m", "growth_law", "growth_table"]
            .iter()
            .for_each(|key| drop(fatigue.remove(*key)));
        fatigue.insert("allow_extrapolation".to_owned(), extrapolates.into());
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
    assert_eq!(same, examples.len(), "both run where they may leave what was measured, and neither where they may not");
}
