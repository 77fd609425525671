//! Output folders and files are whole or absent, nobody else's files are touched, and numbers survive to the last bit.

use std::fs;
use std::path::Path;

use perilife_base::columns::Table;
use perilife_base::input::{Document, Folder, OpenedFile, Provenance};
use perilife_base::sealed::Seal;
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::results::record;
use perilife_growth::case::Case;
use perilife_growth::case::record::FittedRecord;
use perilife_growth::predict::Silent;
use perilife_results::curve::{Row, table};
use perilife_results::output::{LockedFolder, MARKER, OutputFolder, RunKind, write_file};
use perilife_results::provenance;
use perilife_results::provenance::table_of;
use serde_json::Value;
use tempfile::tempdir;

// Output folders and files are whole or absent, and nobody else's files are touched.

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_folder_appears_when_it_is_finished_and_replaces_only_its_own() {
    let dir = tempdir().unwrap();
    let out = dir.path().join("new/parent/run");
    for content in ["first", "second"] {
        let folder = OutputFolder::create(&out, RunKind::Predict).unwrap();
        fs::write(folder.path().join(content), content).unwrap();
        assert!(!out.join(content).exists(), "nothing is seen before the end");
        folder.finish().unwrap();
        assert_eq!(names(&out), [MARKER, content], "the earlier result has gone");
    }
    assert_eq!(names(out.parent().unwrap()), ["run"], "no temporary folder stays");
}

/// Files that a run keeps have names that every system takes, each its own whatever the case.
/// Parts of a sweep come and go: one that leaves has the lock alone while it removes its file, and nobody is refused for that.
#[test]
fn parts_that_leave_refuse_nobody() {
    let dir = tempdir().unwrap();
    let part = || (0..500).for_each(|_| drop(LockedFolder::join(dir.path()).unwrap()));
    std::thread::scope(|scope| (0..2).for_each(|_| drop(scope.spawn(part))));
}

#[test]
fn kept_files_can_be_unpacked_everywhere() {
    let file = |name: &str| OpenedFile { name: name.to_owned(), path: None, id: None, content: [][..].into() };
    for (given, kept) in [
        ("a\\..\\..\\b.csv", "b.csv"),
        ("con.csv", "_con.csv"),
        ("COM1", "_COM1"),
        ("Lpt9.txt", "_Lpt9.txt"),
        ("company.csv", "company.csv"),
        ("com12.csv", "com12.csv"),
        ("a<b>:\"|?*.csv", "a_b______.csv"),
        ("a. ", "a"),
        ("\\", "_"),
        ("Maße 1.csv", "Maße 1.csv"),
    ] {
        let mut object = serde_json::json!({});
        let files = ["case.toml", given, "case.TOML"].map(file).to_vec();
        provenance::add(&mut object, &Provenance { files, ..Provenance::default() }, []);
        let names: Vec<&str> = object["inputs"].as_array().unwrap().iter().map(|one| one["kept_as"].as_str().unwrap()).collect();
        assert_eq!(names, ["inputs/case.toml", &format!("inputs/{kept}"), "inputs/2_case.TOML"], "{given}");
    }
}

#[test]
fn an_unfinished_folder_leaves_nothing() {
    let dir = tempdir().unwrap();
    let out = dir.path().join("deep/run");
    drop(OutputFolder::create(&out, RunKind::Predict).unwrap());
    assert!(names(dir.path()).is_empty(), "new parents go as well");
    let panicked = std::panic::catch_unwind(|| {
        let folder = OutputFolder::create(&out, RunKind::Predict).unwrap();
        fs::write(folder.path().join("half"), "").unwrap();
        std::panic::resume_unwind(Box::new("in the middle of a run"));
    });
    assert!(panicked.is_err() && names(dir.path()).is_empty());
}

#[test]
fn a_file_is_whole_or_absent() {
    let dir = tempdir().unwrap();
    let file = dir.path().join("a.csv");
    for content in ["first", "second"] {
        write_file(&file, content.as_bytes()).unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), content);
    }
    assert_eq!(names(dir.path()), ["a.csv"]);
    assert_eq!(write_file(dir.path(), b"x").unwrap_err().exit_code(), 2, "a folder is no file");
    assert_eq!(write_file(&dir.path().join("missing/a.csv"), b"x").unwrap_err().exit_code(), 4);
    assert_eq!(write_file(&file.join("below"), b"x").unwrap_err().exit_code(), 4);
    assert_eq!(names(dir.path()), ["a.csv"]);
}

// Numbers survive whatever they are kept in, to the last bit.

/// Doubles of every size, and those that decimal readers are known to round wrongly.
fn doubles() -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        f64::from_bits(state)
    };
    let known =
        [0.1 + 0.2, f64::MIN_POSITIVE.next_down(), 5e-324, f64::MAX, 8.41e21, 9007199254740994.0, 1.0 / 3.0, 6929495644600919.0];
    let random = std::iter::repeat_with(&mut next).filter(|x| x.is_finite()).take(1000);
    random.chain(known).collect()
}

fn same(kept: &[f64], given: &[f64], how: &str) {
    assert_eq!(kept.len(), given.len(), "{how}");
    let wrong: Vec<_> = kept.iter().zip(given).filter(|(kept, given)| kept.to_bits() != given.to_bits()).take(3).collect();
    assert!(wrong.is_empty(), "{how}: {wrong:?}");
}

#[test]
fn a_thousand_doubles_survive_every_document() {
    let given = doubles();
    let numbers = |value: &Value| -> Vec<f64> { value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect() };
    let json = serde_json::to_string(&given).unwrap();
    same(&numbers(&serde_json::from_str(&json).unwrap()), &given, "JSON");
    same(&serde_json::from_slice::<Vec<f64>>(json.as_bytes()).unwrap(), &given, "JSON as numbers");
    let pretty = format!("{:#}", serde_json::json!(given));
    same(&numbers(&serde_json::from_str(&pretty).unwrap()), &given, "JSON as results are written");

    // TOML, as text and by the way of JSON that an object sent to the service and an echo take.
    let text = format!("[a]\nx = {given:?}\n");
    let of_table =
        |table: &toml::Table| -> Vec<f64> { table["a"]["x"].as_array().unwrap().iter().map(|x| x.as_float().unwrap()).collect() };
    let document = Document::parse(&text, "numbers", Folder::none(), &[]).unwrap();
    same(&of_table(&document.table), &given, "TOML");
    let written = toml::to_string(&document.table).unwrap();
    same(&of_table(&written.parse().unwrap()), &given, "TOML written");
    let echo: Value = serde_json::from_str(&serde_json::to_string(&document.table).unwrap()).unwrap();
    same(&of_table(&toml::to_string(&table_of(&echo)).unwrap().parse().unwrap()), &given, "JSON to TOML");
    for number in &given {
        let set = Document::parse("[a]\nx = [0.0]\n", "numbers", Folder::none(), &[format!("a.x={number:?}")]).unwrap();
        same(&[set.table["a"]["x"].as_float().unwrap()], &[*number], "--set");
    }

    let seal = Seal { of: "this test", magic: b"test\n", form: 1 };
    same(&seal.read::<Vec<f64>>(&seal.to_bytes(&given)).unwrap(), &given, "checkpoint");

    // Cycles rise in a table.
    let mut cycles: Vec<f64> = given.iter().map(|x| x.abs()).collect();
    cycles.sort_by(f64::total_cmp);
    let row = |&cycles: &f64| Row { cycles, crack_length_mm: 9.0, delta_k_mpa_sqrt_m: 1.0, da_dn_mm_per_cycle: 1.0 };
    let rows =
        Row::of_table(&Table::read(&table(&cycles.iter().map(row).collect::<Vec<_>>()).csv(), Path::new("a_n.csv")).unwrap())
            .unwrap();
    same(&rows.iter().map(|row| row.cycles).collect::<Vec<_>>(), &cycles, "a_n.csv");
}

/// A record by its file is the record; a case by its echo is the case.
#[test]
fn a_record_and_a_case_read_back() {
    let plate = "specimen = { kind = \"middle_tension\", width_mm = 152.4, length_mm = 300.3, thickness_mm = 2.54, crack_length_mm = 9.1 }\n\
        material = { name = \"al2024-t3\" }\nloading = { stress_range_mpa = 48.28, stress_ratio = 0.30000000000000004 }\n\
        model = { method = \"handbook\" }\n";
    let csv = "cycles,crack_length_mm\n0,9.1\n20000,9.6\n40000,10.3\n60000,11.2\n80000,12.3\n100000,13.6\n120000,15.3\n";
    let readings = Folder::at_hand([("m.csv".to_owned(), csv.as_bytes().to_vec())]);
    let test = CalibrationCase::from_text(&format!("measured.files = [\"m.csv\"]\n{plate}"), "fit", readings).unwrap();
    let law = record(&test, &calibrate(&test, &Silent).unwrap());
    let read: FittedRecord = toml::from_str(&toml::to_string(&law).unwrap()).unwrap();
    assert_eq!(format!("{read:?}"), format!("{law:?}"));
    let case = Case::from_toml_with_law(plate, "case", Folder::none(), law.clone()).unwrap();
    let text = toml::to_string(&law).unwrap();
    let folder = Folder::at_hand([("fitted.toml".to_owned(), text.into_bytes())]);
    let echoed = Case::from_toml(&format!("{plate}fatigue.fitted = \"fitted.toml\"\n"), "case", folder, &[]).unwrap();
    let all =
        |case: &Case| format!("{:?}", (&case.specimen, &case.material, &case.loading, &case.fatigue, &case.law, &case.stop));
    assert_eq!(all(&case), all(&echoed));
    // What a case was read from is known by name and content.
    let names: Vec<&str> = echoed.provenance.files.iter().map(|file| &*file.name).collect();
    assert_eq!(names, ["case.toml", "fitted.toml"]);
}
