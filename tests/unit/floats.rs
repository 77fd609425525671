//! Numbers survive whatever they are kept in, to the last bit.

use std::path::Path;

use perilife_base::columns::Table;
use perilife_base::input::{Document, Folder};
use perilife_base::sealed::Seal;
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::results::record;
use perilife_growth::case::Case;
use perilife_growth::case::record::FittedRecord;
use perilife_growth::predict::Silent;
use perilife_results::curve::{Row, table};
use perilife_results::provenance::table_of;
use serde_json::Value;

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
