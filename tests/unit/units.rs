//! US customary units: keys of input files, names of columns and keys, quantities in words.

use std::path::Path;

use perilife_base::columns::Table;
use perilife_base::input::{Document, Folder};
use perilife_base::units::shown::crack_length;
use perilife_base::units::us::{System, renamed};
use perilife_base::units::words::{in_units, with_keys};
use perilife_growth::case::Case;
use perilife_growth::predict::{Silent, predict};
use perilife_results::format::of_result;
use serde_json::json;
use toml::Value;

use crate::support::rows::{assert_refusal, rows};

/// Pound of force and inch by their definitions (NIST SP 811, appendix B.8); all others follow.
const LBF: f64 = 4.448_221_615_260_5;
const KSI: f64 = LBF * 1e3 / (25.4 * 25.4);

const REST: &str = "[model]\nmethod = \"handbook\"\n";
/// The same cases in both systems; C of every law for ΔK in the units of the file.
fn pairs() -> Vec<[String; 2]> {
    let k = KSI * 0.0254_f64.sqrt();
    let panel = |size: &str, load: &str, law: &str| format!("[specimen]\n{size}[material]\n{load}{REST}[fatigue]\n{law}");
    let si = "kind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 304.8\nthickness_mm = 2.54\ncrack_length_mm = 9.144\n";
    let us = "kind = \"middle_tension\"\nwidth_in = 6\nlength_in = 12.0\nthickness_in = 0.1\ncrack_length_in = 0.36\n";
    let [load_si, load_us] = [("gpa", "mpa", 1.0), ("msi", "ksi", 1.0 / KSI)].map(|(e, s, x)| {
        let modulus = if s == "ksi" { 72.394_949_578_265_78 / KSI } else { 72.394_949_578_265_78 };
        format!(
            "youngs_modulus_{e} = {modulus:?}\npoisson_ratio = 0.33\n[loading]\nstress_range_{s} = {:?}\nstress_ratio = 0.2\n",
            48.0 * x
        )
    });
    let laws = [
        ("paris_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874\n".to_owned(), format!("paris_c_in_per_cycle = {:?}\nparis_m = 2.874\n", 8.95422e-8 * k.powf(2.874) / 25.4)),
        (
            "growth_law = \"forman\"\nforman_c_mm_per_cycle = 5e-6\nforman_m = 2.6\nk_c_mpa_sqrt_m = 80.0\n".to_owned(),
            format!("growth_law = \"forman\"\nforman_c_in_per_cycle = {:?}\nforman_m = 2.6\nk_c_ksi_sqrt_in = {:?}\n", 5e-6 * k.powf(1.6) / 25.4, 80.0 / k),
        ),
        (
            "growth_law = \"nasgro\"\nnasgro_c_mm_per_cycle = 7e-8\nnasgro_n = 2.8\nnasgro_p = 0.5\nnasgro_q = 1.0\nnasgro_alpha = 1.5\n\
             nasgro_smax_over_flow = 0.3\nnasgro_delta_k_0_mpa_sqrt_m = 2.9\nk_c_mpa_sqrt_m = 80.0\n".to_owned(),
            format!(
                "growth_law = \"nasgro\"\nnasgro_c_in_per_cycle = {:?}\nnasgro_n = 2.8\nnasgro_p = 0.5\nnasgro_q = 1.0\nnasgro_alpha = 1.5\n\
                 nasgro_smax_over_flow = 0.3\nnasgro_delta_k_0_ksi_sqrt_in = {:?}\nk_c_ksi_sqrt_in = {:?}\n",
                7e-8 * k.powf(2.8) / 25.4, 2.9 / k, 80.0 / k
            ),
        ),
    ];
    let mut pairs: Vec<[String; 2]> = laws
        .iter()
        .map(|(own_si, own_us)| [panel(si, &load_si, own_si), panel(us, &load_us, own_us)].map(|text| text + "[stop]\n"))
        .map(|[metric, us]| [metric + "crack_length_mm = 38.1\n", us + "crack_length_in = 1.5\n"])
        .collect();
    let (ct_si, ct_us) = (
        "kind = \"compact_tension\"\nwidth_mm = 50.8\nthickness_mm = 12.7\ncrack_length_mm = 12.7\n",
        "kind = \"compact_tension\"\nwidth_in = 2\nthickness_in = 0.5\ncrack_length_in = 0.5\n",
    );
    for (metric, us, value) in [("force_max_kn", "force_max_kip", 1e-3 * LBF), ("force_max_n", "force_max_lbf", LBF)] {
        let [size, unit] = [if us.ends_with("kip") { 2.0 } else { 2000.0 }, if us.ends_with("kip") { 1e3 } else { 1.0 }];
        let load = |key: &str, force: f64| format!("name = \"al2024-t3\"\n[loading]\n{key} = {force:?}\nstress_ratio = 0.1\n");
        pairs.push([panel(ct_si, &load(metric, size * unit * value), &laws[0].0), panel(ct_us, &load(us, size), &laws[0].1)]);
    }
    pairs
}

fn life(text: &str) -> f64 {
    let case = Document::parse(text, "panel", Folder::none(), &[]).and_then(|document| Case::from_document(&document));
    predict(&case.unwrap_or_else(|error| panic!("{error}\n{text}")), &Silent).unwrap().life_cycles()
}

#[test]
fn a_case_has_the_same_life_in_both_units() {
    for [metric, us] in pairs() {
        let [metric, of_us] = [life(&metric), life(&us)];
        assert!(metric > 100.0 && (of_us / metric - 1.0).abs() < 1e-12, "{metric} and {of_us}:\n{us}");
    }
}

/// Every number of a table, by its place.
fn numbers(value: &Value, path: &str, all: &mut Vec<(String, f64)>) {
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| numbers(value, &format!("{path}.{key}"), all)),
        Value::Array(items) => items.iter().enumerate().for_each(|(i, value)| numbers(value, &format!("{path}[{i}]"), all)),
        Value::Float(number) => all.push((path.to_owned(), *number)),
        Value::Integer(number) => all.push((path.to_owned(), *number as f64)),
        _ => {}
    }
}

#[test]
fn lists_tables_and_overrides_have_us_keys_too() {
    let text = "[specimen]\noutline_in = [[0, 0], [2, 0], [2, 4.5]]\nholes = [{ x_in = 1, y_in = 2, diameter_in = 0.25 }]\n\
                cracks = [{ from_in = [0, 1], to_in = [0.5, 1] }, { path_mm = [[1, 2]] }]\n[growth]\nk_c_ksi_sqrt_in = 3.0\n\
                [yield_strength_ksi]\nvalue = 50\nyear = 1970\n[fatigue]\nparis_c_in_per_cycle = 1e-9\nparis_m = 3\n[stop]\ncrack_length_mm = 5\n";
    let set = ["fatigue.paris_m=4", "stop.crack_length_in=0.5", "specimen.holes[0].diameter_mm=6"].map(str::to_owned);
    let document = Document::parse(text, "plate", Folder::none(), &set).unwrap();
    let mut found = Vec::new();
    numbers(&Value::Table(document.table.clone()), "", &mut found);
    let k = KSI * 0.0254_f64.sqrt();
    let wanted = [
        (".specimen.outline_mm[2][1]", 114.3),
        (".specimen.holes[0].x_mm", 25.4),
        (".specimen.holes[0].diameter_mm", 6.0),
        (".specimen.cracks[0].to_mm[0]", 12.7),
        (".specimen.cracks[1].path_mm[0][1]", 2.0),
        (".growth.k_c_mpa_sqrt_m", 3.0 * k),
        (".yield_strength_mpa.value", 50.0 * KSI),
        (".yield_strength_mpa.year", 1970.0),
        (".fatigue.paris_c_mm_per_cycle", 25.4e-9 / k.powi(4)),
        (".stop.crack_length_mm", 12.7),
    ];
    for (path, value) in wanted {
        let own = found.iter().find(|(own, _)| own == path).unwrap_or_else(|| panic!("{path} in {found:?}")).1;
        assert!((own / value - 1.0).abs() < 1e-14, "{path}: {own} and {value}");
    }
    assert!(found.iter().all(|(path, _)| !path.ends_with("_in")), "{found:?}");
}

#[test]
fn what_is_wrong_is_said_in_the_words_of_the_file() {
    let [_, us] = pairs().swap_remove(0);
    let set = ["specimen.width_in=5", "specimen.width_mm=120"].map(str::to_owned);
    let refused = Document::parse(&us, "panel", Folder::none(), &set);
    assert_refusal(refused, &["specimen.width_mm=120", "conflicts with specimen.width_in"]);
    let cases: [(&str, &str, &[&str]); 7] = [
        ("width_in = 6", "width_in = 6\nwidth_mm = 152.4", &["specimen.width_in = 6", "specimen.width_mm", "conflicts with"]),
        ("width_in = 6", "width_in = -6", &["specimen.width_in = -6", "must be above zero", "inch"]),
        ("width_in = 6", "width_in = \"6\"", &["specimen.width_in = \"6\"", "is not a number"]),
        ("width_in = 6", "widht_in = 6", &["specimen.widht_in = 6", "unknown key", "width_mm"]),
        ("width_in = 6", "width_ft = 0.5", &["specimen.width_ft = 0.5", "did you mean width_mm or width_in?"]),
        ("crack_length_in = 1.5", "crack_length_in = 0.1", &["stop.crack_length_in = 0.1", "0.36"]),
        ("paris_m = 2.874\n", "", &["fatigue.paris_m", "fatigue.paris_c_in_per_cycle"]),
    ];
    for (old, new, words) in cases {
        let text = us.replacen(old, new, 1);
        let document = Document::parse(&text, "panel", Folder::none(), &[]);
        let error = document.and_then(|document| Case::from_document(&document)).unwrap_err().to_string();
        words.iter().for_each(|word| assert!(error.contains(word), "{word} in {error}"));
        assert!(!error.contains(" mm"), "{error}");
    }
}

#[test]
fn quantities_in_words_change_and_nothing_else() {
    for [metric, us] in rows::<Vec<[String; 2]>>("units", "quantities") {
        assert_eq!(in_units(&metric, System::Us), us);
        assert_eq!(in_units(&us, System::Us), us, "told twice");
    }
    let found = in_units("crack 0.39370 inch, 13.872 ksi√in, 12 in the plate", System::Si);
    assert_eq!(found, "crack 10.00 mm, 15.243 MPa√m, 12 in the plate");
}

/// A short crack keeps its digits, and one of almost 10 mm has those of 10 mm.
#[test]
fn crack_lengths_have_the_digits_that_matter() {
    let told =
        [(5e-3, "5.00"), (1.27e-3, "1.27"), (0.127e-3, "0.127"), (9.99999e-3, "10.0"), (48.546e-3, "48.5"), (0.1016, "101.6")];
    told.iter().for_each(|(metres, text)| assert_eq!(crack_length(*metres), *text));
}

#[test]
fn keys_in_words_are_those_of_the_units() {
    let told: Vec<[String; 2]> = rows("units", "keys");
    for [metric, us] in &told {
        assert_eq!(with_keys(metric, System::Us), *us);
        assert_eq!(with_keys(us, System::Us), *us, "told twice");
    }
    let result = json!({ "checks": [{ "remedy": told[0][0] }] });
    let us = of_result(&result, System::Us, |words| with_keys(words, System::Us));
    assert_eq!(us["checks"][0]["remedy"], json!(told[0][1]));
    assert_eq!(of_result(&result, System::Us, str::to_owned), result, "words of a file are metric");
}

#[test]
fn tables_and_results_go_there_and_back() {
    let table = "tip,cycles,crack_length_mm,k_i_mpa_sqrt_m,da_dn_mm_per_cycle,load_work_j,paris_c_mm_per_cycle,paris_m,left_out\n\
                 0,100.5,25.40000000,10.98843,,1.5,1e-8,3,\"at 5.08 mm, late\"\n";
    let read = |text: &str| Table::read(text, Path::new("table.csv")).unwrap();
    let us = read(table).csv_in(System::Us);
    assert!(us.starts_with("tip,cycles,crack_length_in,k_i_ksi_sqrt_in,da_dn_in_per_cycle,load_work_in_lbf,paris_c_in_per_cycle,paris_m,left_out\n"), "{us}");
    assert!(us.contains("\n0,100.5,1.000000000,") && us.contains(",,13.2761") && us.contains("\"at 0.2000 inch, late\""), "{us}");
    assert_eq!(read(&us).csv_in(System::Us), us);
    assert!(read(&us).csv_in(System::Si).contains("\"at 5.080 mm, late\""), "{}", read(&us).csv_in(System::Si));
    let result = json!({
        "life_cycles": 5.0, "plate": { "outline_mm": [[25.4, 0.0]] }, "largest_displacement": { "mm": 2.54 }, "case": { "width_mm": 1.0 },
        "constants": { "nasgro_n": 3.0, "nasgro_c_mm_per_cycle": 1e-8 }, "standard_errors": { "nasgro_n": 0.1, "nasgro_c_mm_per_cycle": 1e-9 },
        "path_error_estimate_mm": null, "checks": [{ "words": "thickness 2.54 mm" }],
    });
    let us = of_result(&result, System::Us, |words| with_keys(words, System::Us));
    assert_eq!((&us["plate"]["outline_in"][0][0], &us["largest_displacement"]["in"]), (&json!(1.0), &json!(0.1)));
    assert_eq!((&us["case"], &us["checks"][0]["words"]), (&result["case"], &json!("thickness 0.1000 inch")));
    let [c, error] = ["constants", "standard_errors"].map(|of| us[of]["nasgro_c_in_per_cycle"].as_f64().unwrap());
    assert!((error / c - 0.1).abs() < 1e-12 && us["path_error_estimate_in"].is_null());
    for unit in ["mm", "mpa", "gpa", "kn", "n", "j", "mm_s", "j_m2", "kg_m3", "mpa_sqrt_m", "mm_per_cycle"] {
        let there = renamed(&format!("x_{unit}"), System::Us).unwrap();
        let back = renamed(&there.name, System::Si).unwrap();
        let [to, from] = [&there, &back].map(|new| new.factor(|_| None).unwrap());
        assert!(back.name == format!("x_{unit}") && (to * from - 1.0).abs() < 1e-15, "{unit}");
    }
}
