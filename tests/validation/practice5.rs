//! Cases of users (`field/practice5` of the shared data): the right value within what its page states, or the cause by name.

use crate::interface::cli::{perilife, texts};
use crate::support::field;
use crate::support::field::{command, is_near, kind, predicted};
use crate::support::rows::rows;

// Laws, tables of rates and readings as users brought them: the right value within what its page states, or the cause by name (shared data).

#[test]
fn laws_and_tables_of_practice_give_the_right_value_or_the_cause() {
    field::hold_rows("practice5_laws", "practice5");
}

/// One reading says where the crack is and nothing of its rate.
#[test]
fn every_quantile_of_one_reading_is_that_of_the_lot() {
    let Some(dir) = kind("few_readings_of_a_plate") else { return };
    assert_eq!(command(dir.path(), "calibrate lot.toml --out out_fit").0, 0);
    let (_, result) = predicted(dir.path(), "plate.toml --measured read1.csv");
    let [own, lot] = ["/measured", "/measured/of_lot"].map(|place| result.pointer(place).unwrap());
    for quantile in ["remaining_cycles_p05", "remaining_cycles_p50", "remaining_cycles_p95"] {
        assert!(own[quantile].is_f64() && own[quantile] == lot[quantile], "{quantile}: {own}");
    }
}

// Spectra of other people: their files read as they are meant, counted as they repeat, or refused by name. Right values: own counting, growth cycle by cycle and quadrature (shared data, `field/practice5`).

#[test]
fn spectra_of_other_people_are_read_and_counted_as_they_mean_them() {
    type Right = (String, String, String, f64, f64, String);
    for (name, case, place, right, share, words) in rows::<Vec<Right>>("practice5_spectra", "right") {
        let Some(dir) = kind(&name) else { return };
        let (said, result) = predicted(dir.path(), &format!("{case}.toml"));
        is_near(&result[place], right, share, &case);
        assert!(said.contains(&words), "{name}, {case}: {said}");
    }
}

#[test]
fn what_may_be_two_spectra_is_asked_about() {
    let rows: [(&str, &str, &[&str]); 3] = [
        ("counted_tables", "no_header", &["no_header.csv:1", "3 columns without a known name", "spectrum_format = \"cycles\""]),
        ("counted_tables", "range_count", &["range_count.csv:1", "2 columns without a known name"]),
        ("decimal_comma", "column", &["column.csv:1", "decimal commas", "spectrum_format"]),
    ];
    for (name, case, words) in rows {
        let Some(dir) = kind(name) else { return };
        let (code, said) = command(dir.path(), &format!("predict {case}.toml --out out"));
        assert!(code == 2 && words.iter().all(|word| said.contains(word)), "{name}, {case}: {said}");
    }
    // The key settles it.
    let Some(dir) = kind("decimal_comma") else { return };
    let (_, result) = predicted(dir.path(), "column.toml --set loading.spectrum_format=turning_points");
    is_near(&result["passes"], 20_546.1, 1e-5, "decimal commas");
}

/// 99 % of the growth is by cycles of ΔK 3 to 5 and the law was fitted to 10 to 35; the other way round the run is refused.
#[test]
fn a_life_by_cycles_outside_the_law_is_told() {
    let Some(dir) = kind("spectrum_beyond_the_law") else { return };
    assert_eq!(command(dir.path(), "calibrate calibrate.toml --out out_fit").0, 0);
    let (said, result) = predicted(dir.path(), "plate.toml");
    is_near(&result["life_share_extrapolated"], 0.99, 1e-3, "share");
    assert!(said.contains("99.0 % of life at ΔK below 10.00"), "{said}");
    // Small cycles below the range and large ones above it: the check of what is above says the share that is above. By the law that was fitted,
    // m 2.884 and γ 0.601, one large cycle grows the crack as (75 (14/15)^γ / 30 0.6^γ)^m = 30.2 small ones: 25 · 30.2 of 3755.
    std::fs::write(dir.path().join("spectrum.csv"), "max,min,cycles\n75,5,25\n30,12,3000\n").unwrap();
    let (_, said) = command(dir.path(), "check plate.toml --set loading.spectrum_scale_mpa=3.2");
    assert!(said.contains("20 % of the first growth is above"), "{said}");
    std::fs::write(dir.path().join("spectrum.csv"), "max,min,cycles\n75,5,1\n30,12,3000\n").unwrap();
    let (code, said) = command(dir.path(), "predict plate.toml --out above --set loading.spectrum_scale_mpa=9.0");
    assert!(code == 2 && said.contains("37.9 % of the life is above the tested ΔK"), "{said}");
}

// Fleets, inspections and retardation as users brought them, with the figures that their own growth and quadrature gave (shared data).

#[test]
fn shorter_cracks_than_that_of_a_retarded_run_are_retarded() {
    let Some(dir) = kind("short_cracks_retarded") else { return };
    let (_, result) = predicted(dir.path(), "run.toml --sensitivities");
    is_near(&result["life_cycles"], 2_537_482.0, 1e-3, "life");
    let all = result["sensitivities"].as_array().unwrap();
    let shorter = all.iter().find(|row| row["input"] == "initial crack length" && row["change"] == "-10 %").unwrap();
    assert!((shorter["change_of_life_percent"].as_f64().unwrap() - 11.01).abs() < 0.2, "{shorter}");
    let retardation = result["checks"].as_array().unwrap().iter().find(|check| check["name"] == "retardation").unwrap();
    assert!(retardation["verdict"] == "caution", "{retardation}");
    assert!(retardation["words"].as_str().unwrap().contains("4.05 × the life without it"), "{retardation}");
    let (_, result) = predicted(dir.path(), "fleet.toml");
    for (quantile, wanted) in [("p05", 3_936_729.0), ("p50", 5_086_135.0), ("p95", 6_417_585.0)] {
        is_near(&result["fleet"]["life_cycles"][quantile], wanted, 0.03, quantile);
    }
}

#[test]
fn a_fleet_lives_on_where_its_run_is_cut_off() {
    let Some(dir) = kind("fleet_cut_off") else { return };
    let (said, result) = predicted(dir.path(), "fleet.toml");
    let lives = &result["fleet"]["life_cycles"];
    is_near(&lives["p05"], 135_356.0, 0.01, "5 %");
    is_near(&lives["p50"], 210_979.0, 0.01, "50 %");
    assert_eq!((&lives["words"]["p95"], &result["life_cycles"]), (&"above 250000".into(), &250_000.0.into()));
    assert!(said.starts_with("fleet: life 5 % 135 500, median 211 000 cycles (2000 plates)\n  Nominal run    life ≥ "), "{said}");
}

/// By quadrature over the load 2.495e-3 are missed, 0.170 % of plates by breaking before the first inspection; the draws of the table, 40 000 of
/// them, have a standard error of 2.5e-4 about that.
#[test]
fn all_plates_of_a_fleet_are_inspected_after_the_same_cycles() {
    let Some(dir) = kind("fleet_looked_at") else { return };
    let asked = "fleet.toml --inspect-from 6.0 --factor 3 --pod 5.0,12.0";
    let (said, result) = predicted(dir.path(), &format!("{asked} --first-inspection 115191"));
    let (missed, looks) = (result["fleet"]["missed"].as_f64().unwrap(), &result["fleet"]["inspections"]);
    assert!((missed - 2.495e-3).abs() < 2e-4, "{missed}");
    assert_eq!((&looks["break_before_first_inspection"], &looks["first_inspection_cycles"]), (&7.into(), &115_191.0.into()));
    is_near(&looks["interval_cycles"], 22_451.0, 5e-3, "interval");
    assert!(said.contains("inspected after 115 191 cycles, then every 22 "), "{said}");
    let (said, result) = predicted(dir.path(), asked);
    is_near(
        &result["fleet"]["inspections"]["first_inspection_cycles"],
        115_191.0 * (1.0 + 0.08 * 1.645_f64).powf(-2.874),
        5e-3,
        "first",
    );
    assert!(said.contains("all miss the crack of a plate: below 1e-3"), "{said}");
}

#[test]
fn lengths_of_inspections_have_the_unit_of_the_run_or_their_own() {
    let Some(dir) = kind("us_inspections") else { return };
    for lengths in ["--inspect-from 0.25 --pod 0.2,0.5", "--inspect-from 6.35mm --pod 5.08mm,0.5in"] {
        let (said, result) = predicted(dir.path(), &format!("case.toml --units us --factor 3 {lengths}"));
        is_near(&result["inspections"]["interval_cycles"], 30_416.0, 1e-3, lengths);
        is_near(&result["inspections"]["missed"], 3.322e-3, 0.01, lengths);
        assert!(said.contains("from a = 0.2500 inch") && said.contains("a50 0.2000 inch, a90 0.5000 inch"), "{said}");
    }
    let off = ["predict", "case.toml", "--out", "off", "--units", "us", "--inspect-from", "6.35"];
    let output = perilife(dir.path(), &off);
    assert!(output.status.code() == Some(2) && texts(&output).1.contains("--inspect-from = 6.350 inch"), "{}", texts(&output).1);
    assert!(!dir.path().join("off").exists(), "nothing is written");
}

#[test]
fn a_thick_plate_is_told_its_life_by_zones_of_plane_strain() {
    let Some(dir) = kind("thick_plate_retarded") else { return };
    for (case, wanted) in [("wheeler.toml", 273_712.0), ("newman.toml", 195_772.0)] {
        let (said, result) = predicted(dir.path(), case);
        let words = "than plane strain at the tip needs, 7.31 mm at the start and 29.40 mm at the end";
        assert!(said.contains(words) && said.contains("(non-conservative); set material.plane = \"strain\""), "{said}");
        let life: f64 =
            said.split("zones of plane strain the life is ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        is_near(&life.into(), wanted, 1e-3, case);
        assert!(result["warnings"].as_array().unwrap().iter().any(|line| line.as_str().unwrap().contains(words)));
        let (said, result) = predicted(dir.path(), &format!("{case} --set material.plane=strain"));
        is_near(&result["life_cycles"], wanted, 1e-3, case);
        assert!(!said.contains("plastic zones of plane"), "{said}");
    }
}
