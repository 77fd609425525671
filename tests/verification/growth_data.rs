//! Growth data of the library against values computed from the published constants by themselves.

use perilife_base::input::Folder;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::{Case, library_law};
use perilife_growth::predict::{Silent, predict};
use perilife_laws::growth_law::nasgro::keys_of;
use perilife_plate::material::growth_data::{record, records};

/// Thickness of the check values, 0.1 in.
const THICKNESS: f64 = 2.54 * MM;

/// da/dN, mm/cycle, at ΔK = 10 MPa√m and R = 0 and 0.5, by the constants in ksi and inch as NASGRO 4 lists them.
#[test]
fn rates_of_the_library_are_those_of_its_source() {
    for (name, rates) in [
        ("al2024-t3-clad-lt", [6.985e-5, 2.159e-4]),
        ("al7075-t6-sheet-lt", [1.207e-4, 3.428e-4]),
        ("al7050-t7451-plate-lt", [7.513e-5, 2.269e-4]),
    ] {
        for (ratio, expected) in [0.0, 0.5].into_iter().zip(rates) {
            let law = library_law(name, THICKNESS, ratio, &Folder::none()).unwrap().0;
            let rate = law.rate(10.0 * MPA_SQRT_M / (1.0 - ratio), ratio) / MM_PER_CYCLE;
            assert!((rate / expected - 1.0).abs() < 5e-4, "{name}, R = {ratio}: {rate}");
        }
    }
    // Thresholds of 2024-T3: 3.20 and 2.00 MPa√m.
    for (ratio, threshold) in [(0.0, 3.20), (0.5, 2.00)] {
        let law = library_law("al2024-t3-clad-lt", THICKNESS, ratio, &Folder::none()).unwrap().0;
        let grows = |delta_k: f64| law.rate(delta_k * MPA_SQRT_M / (1.0 - ratio), ratio) > 0.0;
        assert!(!grows(threshold - 0.005) && grows(threshold + 0.005), "R = {ratio}");
    }
}

#[test]
fn every_record_gives_a_law_of_metals() {
    let records = records();
    assert!(records.len() >= 20);
    for record in &records {
        for ratio in [-1.0, 0.0, 0.1, 0.7] {
            let law = library_law(&record.name, THICKNESS, ratio, &Folder::none()).unwrap().0;
            let rate = |k_max: f64| law.rate(k_max * MPA_SQRT_M, ratio) / MM_PER_CYCLE;
            let (name, [low, high]) = (&record.name, [15.0, 18.0].map(rate));
            assert!(low > 1e-8 && high < 1e-2, "{name}, R {ratio}: {low} and {high}");
            assert!(high > low, "{name}, R {ratio}: rates rise");
        }
    }
}

const PANEL: &str = r#"
[specimen]
kind = "middle_tension"
width_mm = 100.0
length_mm = 300.0
thickness_mm = 2.54
crack_length_mm = 10.0
[material]
name = "al2024-t3-clad-lt"
[loading]
stress_max_mpa = 80.0
stress_ratio = 0.1
[fatigue]
"#;

fn case(fatigue: &str) -> perilife_base::error::Result<Case> {
    Case::from_toml(&format!("{PANEL}{fatigue}"), "panel", Folder::none(), &[])
}

#[test]
fn a_case_takes_the_law_of_its_material() {
    let of_library = case("growth_law = \"library\"").unwrap();
    assert!(of_library.growth_data.as_ref().unwrap().contains("2024-T3"));
    let run = predict(&of_library, &Silent).unwrap();
    // The same constants given in the case.
    let keys = keys_of(&record("al2024-t3-clad-lt").unwrap(), 2.54);
    let given = case(&toml::to_string(&keys).unwrap()).unwrap();
    let same = predict(&given, &Silent).unwrap();
    assert_eq!(run.life_cycles(), same.life_cycles());
    assert!(given.growth_data.is_none());
    for (fatigue, problem) in [
        ("growth_law = \"library\"\nparis_m = 3.0", "conflicts with growth_law"),
        ("growth_law = \"library\"\nfitted = \"fitted.toml\"", "conflicts with"),
    ] {
        let error = case(fatigue).unwrap_err().to_string();
        assert!(error.contains(problem), "{error}");
    }
    let of = |name: &str| {
        let text = format!("{PANEL}growth_law = \"library\"").replace("\"al2024-t3-clad-lt\"", name);
        Case::from_toml(&text, "panel", Folder::none(), &[]).unwrap_err().to_string()
    };
    assert!(of("\"al2024-t3\"").contains("has no growth law"), "elastic constants alone");
    assert!(of("\"al2024-t4-lt\"").contains("perilife list materials"));
}
