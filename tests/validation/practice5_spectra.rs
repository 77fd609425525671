//! Spectra of other people: their files read as they are meant, counted as they repeat, or refused by name. Right values: own counting, growth cycle
//! by cycle and quadrature (shared data, `field/practice5`).

use crate::support::field::{command, is_near, kind, predicted};
use crate::support::rows::rows;

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
