//! From a result back to what made it.

use std::fs;

use perilife_base::input::sha256;
use serde_json::json as value;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::interface::doors::{answer, examples, written};
use crate::support::desk::{done, json};

/// Hashes of all that was read, the texts, overrides, time with zone, commit; a fracture scene and a calibration are repeated by their
/// echoes as well.
#[test]
fn a_result_says_what_made_it() {
    let dir = written(&examples());
    let here = dir.path();
    let sets = "--set loading.stress_ratio=0.25 --set stop.crack_length_mm=40";
    done(here, &format!("predict named_files.toml --out run -q {sets}"));
    let result = json(here.join("run/result.json"));
    for (place, file) in ["named_files.toml", "data/own.toml", "data/rates.csv"].into_iter().enumerate() {
        let content = fs::read(here.join(file)).unwrap();
        let said = &result["inputs"][place];
        let found = (&said["file"], &said["sha256"], &said["bytes"]);
        assert_eq!(found, (&value!(file), &value!(sha256(&content)), &value!(content.len())));
        assert_eq!(fs::read(here.join("run").join(said["kept_as"].as_str().unwrap())).unwrap(), content);
    }
    assert_eq!(result["overrides"], value!(["loading.stress_ratio=0.25", "stop.crack_length_mm=40"]));
    let finished = result["finished"].as_str().unwrap();
    assert!(finished.len() == 20 && finished.ends_with('Z') && finished.starts_with("20"), "{finished}");
    assert!(result["commit"].is_null() || result["commit"].as_str().unwrap().len() >= 40);
    // Overrides are in the echo, which repeats the run.
    done(here, "predict run/case.toml --out again -q");
    assert_eq!(answer(&here.join("again")), answer(&here.join("run")));
    done(here, "check run/case.toml");

    crate::support::daily::write_inputs(here);
    for (command, input, table) in [("fracture", "scene.toml", "history.csv"), ("calibrate", "fit.toml", "fitted.toml")] {
        done(here, &format!("{command} {input} --out {command} -q"));
        let echo = format!("{command}/case.toml");
        done(here, &format!("{command} {echo} --out echoed -q"));
        let [first, second] = [command, "echoed"].map(|out| fs::read_to_string(here.join(out).join(table)).unwrap());
        // A record names its readings as the file did.
        assert_eq!(first.replace("\"readings.csv\"", "\"inputs/readings.csv\""), second, "{command}");
        let name = if command == "fracture" { "result.json" } else { "fit.json" };
        let said = json(here.join(command).join(name));
        assert_eq!(said["inputs"][0]["sha256"], value!(sha256(&fs::read(here.join(input)).unwrap())));
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
    done(here, "check sweep.toml");
    done(here, "sweep sweep.toml --out out -q");
    done(here, "predict named_files.toml --out run -q");
    let result = json(here.join("run/result.json"));
    assert_eq!(life().parse::<f64>().ok(), result["life_cycles"].as_f64());
    for file in ["data/rates.csv", "data/own.toml"] {
        let (before, text) = (life(), fs::read_to_string(here.join(file)).unwrap());
        fs::write(here.join(file), text.replace("1e-2", "2e-2").replace("345.0", "145.0")).unwrap();
        let output = perilife(here, "sweep sweep.toml --out out -q");
        assert!(output.status.success(), "{}", texts(&output).1);
        assert!(texts(&output).1.contains("2 of 2 finished cases are deleted: 0001, 0002"), "{}", texts(&output).1);
        assert_ne!(life(), before, "{file}");
    }
    fs::remove_file(here.join("data/rates.csv")).unwrap();
    let output = perilife(here, "sweep sweep.toml --out out -q");
    assert_refused(&output, 4, &["data/rates.csv", "cannot read"]);
    // Another sweep than the one that stands there is refused, and names what would go.
    fs::write(here.join("data/rates.csv"), "delta_k_mpa_sqrt_m,da_dn_mm_per_cycle\n1,1e-9\n100,1e-2\n").unwrap();
    fs::rename(here.join("sweep.toml"), here.join("other.toml")).unwrap();
    let output = perilife(here, "sweep other.toml --out out -q");
    let words = ["contains another sweep, sweep, with 2 of 2 cases done", "use a new folder"];
    assert_refused(&output, 2, &words);
}
