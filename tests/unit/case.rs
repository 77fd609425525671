//! A case as a whole: defaults, overrides, the law and where it comes from, shipped files.

use std::path::{Path, PathBuf};

use perilife_base::error::Error;
use perilife_base::input::Folder;
use perilife_base::sealed::Kept;
use perilife_growth::case::record::FittedRecord;
use perilife_growth::case::{Case, LawSource};
use perilife_growth::predict::checkpoint::KeptRun;
use perilife_plate::material::library;
use perilife_points::bond_law::{BondLawKind, Kernel, Rotation, SurfaceCorrection};

use crate::support::rows::{assert_refusal, rows};

const TEXT: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 300\nthickness_mm = 2.54\ncrack_length_mm = 9\n\
                    [material]\nyoungs_modulus_gpa = 73.1\npoisson_ratio = 0.33\n[loading]\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n";
const INLINE: &str = "[fatigue]\na = 6450\np = 2.86\nhorizon_mm = 3\ndriver = \"bond_strain\"\n";

fn read(extra: &str, overrides: &[&str]) -> Result<Case, Error> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    Case::from_toml(&format!("{TEXT}{extra}"), "panel", Path::new(""), &overrides)
}

fn record() -> FittedRecord {
    rows("records", "case")
}

#[test]
fn defaults_are_those_of_the_contract() {
    let case = read(INLINE, &[]).unwrap();
    assert!((case.points().spacing - 9e-3 / 9.0).abs() < 1e-12, "a0/9 is below W/100 here");
    let long = read(INLINE, &["specimen.crack_length_mm=30"]).unwrap();
    assert!((long.points().spacing - 1.524e-3).abs() < 1e-12, "W/100 is below a0/9 here");
    let law = case.points().bond_law;
    assert_eq!((law.kind, law.kernel, law.rotation), (BondLawKind::TwoParameter, Kernel::Conical, Rotation::Free));
    assert_eq!((case.points().horizon_ratio, case.fatigue.zone_radius_horizons, case.stop.cycles_max), (3.015, 0.5, 1e9));
    assert_eq!(case.fatigue.ageing.name(), "crack_tip");
    assert_eq!(case.fatigue.step_error_percent, 0.2);
    assert!(case.stop.crack_length.is_infinite() && !case.allow_extrapolation);
    assert_eq!(case.fatigue.critical_stretch, perilife_laws::OVERLOAD_STRETCH);
    let [warning] = &case.warnings[..] else { panic!("{:?}", case.warnings) };
    assert!(warning.starts_with("tested range: bond_strain by its own strain"), "{warning}");
}

#[test]
fn overrides_replace_add_and_are_echoed() {
    let case = read(
        INLINE,
        &["specimen.crack_length_mm=12", "model.kernel=constant", "stop.crack_length_mm = 40.5", "material.plane=\"stress\""],
    )
    .unwrap();
    assert_eq!(case.specimen.crack_length, 0.012);
    assert_eq!(case.points().bond_law.kernel, Kernel::Constant);
    assert_eq!(case.stop.crack_length, 0.0405);
    assert_eq!(case.echo["stop"]["crack_length_mm"], 40.5);
    assert_eq!(case.echo["specimen"]["crack_length_mm"], 12);
}

#[test]
fn inline_law_moves_over_the_horizon() {
    let law = read(INLINE, &[]).unwrap().fatigue_law(1.5e-3).unwrap();
    // A2 = A1 (d2/d1)^((p-2)/2)
    assert!((law.a / (6450.0 * 0.5_f64.powf(0.43)) - 1.0).abs() < 1e-12);
    assert_eq!(law.horizon, 1.5e-3);
}

#[test]
fn a_silent_case_takes_the_models_of_the_record() {
    let case = read(INLINE, &["model.method=peridynamics"]).unwrap().with_law(record()).unwrap();
    assert_eq!(case.points().bond_law.kernel, Kernel::Constant);
    assert_eq!(case.fatigue.zone_radius_horizons, 0.6);
    assert!(case.echo["fatigue"].get("a").is_none() && case.echo["fatigue"]["fitted"]["p"] == 3.0);
    let law = case.fatigue_law(3e-3).unwrap();
    assert!((law.a / 5000.0 - 1.0).abs() < 1e-12 && law.p == 3.0);
    let tips = read(INLINE, &["model.method=peridynamics", "fatigue.driver=tip_field"]).unwrap().with_law(record()).unwrap();
    assert_eq!(tips.points().bond_law.kernel, Kernel::Constant);
    assert_eq!(tips.points().bond_law.surface_correction, SurfaceCorrection::None);
}

#[test]
fn an_explicit_choice_must_agree_with_the_record() {
    // (override, value of the record)
    let rows = [
        ("model.bond_law=bond_based", "two_parameter"),
        ("model.kernel=conical", "constant"),
        ("model.rotation=resisted", "free"),
        ("model.surface_correction=volume_and_surface", "none"),
        ("fatigue.ageing=everywhere", "crack_tip"),
        ("fatigue.zone_radius_horizons=0.5", "0.6"),
    ];
    for (choice, recorded) in rows {
        let (key, value) = choice.split_once('=').unwrap();
        let error = read(INLINE, &[choice]).unwrap().with_law(record()).unwrap_err().to_string();
        assert!(error.contains(key) && error.contains(value) && error.contains(recorded), "{choice}: {error}");
        // K of a tip is read off the same bonds.
        if key.starts_with("model") {
            let tips = read(INLINE, &[choice, "fatigue.driver=tip_field"]).unwrap().with_law(record()).unwrap_err().to_string();
            assert_eq!(tips, error);
        }
    }
    read(INLINE, &["model.kernel=constant", "fatigue.zone_radius_horizons=0.6"]).unwrap().with_law(record()).unwrap();
}

#[test]
fn elastic_constants_keep_the_growth_rate() {
    let case =
        read(INLINE, &["material.youngs_modulus_gpa=146.2", "material.poisson_ratio=0.3"]).unwrap().with_law(record()).unwrap();
    // (E'2/E'1)^p = 2^3 in plane stress, whatever Poisson's ratio.
    assert!((case.fatigue_law(3e-3).unwrap().a / 40_000.0 - 1.0).abs() < 1e-12);
    assert_eq!(case.warnings.iter().filter(|line| line.contains("E'2/E'1")).count(), 1);
    let strain = read(INLINE, &["material.poisson_ratio=0.25", "material.plane=strain"]).unwrap().with_law(record()).unwrap();
    let factor = (1.0_f64 / (1.0 - 0.0625)).powi(3);
    assert!((strain.fatigue_law(3e-3).unwrap().a / (5000.0 * factor) - 1.0).abs() < 1e-12);
}

#[test]
fn another_stress_ratio_needs_the_walker_exponent() {
    let refused = read(INLINE, &["loading.stress_ratio=0.5"]).unwrap().with_law(record());
    assert_refusal(refused, &["loading.stress_ratio = 0.5", "0.2", "walker_gamma"]);
    for gamma in [1.0, 0.6] {
        let case = read(INLINE, &["loading.stress_ratio=0.2", &format!("fatigue.walker_gamma={gamma}")])
            .unwrap()
            .with_law(record())
            .unwrap();
        // At the calibrated ratio the rate stays: A s^p (1-R)^(gamma p) must not depend on gamma.
        let rate = case.fatigue_law(3e-3).unwrap().a * 0.8_f64.powf(3.0 * case.fatigue.walker_gamma);
        assert!((rate / (5000.0 * 0.8_f64.powi(3)) - 1.0).abs() < 1e-12, "{gamma}");
        read(INLINE, &["loading.stress_ratio=0.5", &format!("fatigue.walker_gamma={gamma}")])
            .unwrap()
            .with_law(record())
            .unwrap();
    }
}

#[test]
fn a_record_is_read_from_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("panel.toml");
    std::fs::write(&path, format!("{TEXT}[fatigue]\nfitted = \"fitted.toml\"\n")).unwrap();
    let missing = Case::from_file(&path, &[]).unwrap();
    assert!(matches!(&missing.law, LawSource::Missing(_)) && missing.warnings.iter().any(|line| line.contains("fitted.toml")));
    assert_eq!(missing.fatigue_law(1e-3).unwrap_err().exit_code(), 4);

    std::fs::write(folder.path().join("fitted.toml"), toml::to_string(&record()).unwrap()).unwrap();
    let case = Case::from_file(&path, &[]).unwrap();
    assert_eq!((case.name.as_str(), &case.law), ("panel", &LawSource::Fitted(Box::new(record()))));

    // One of before names its estimate, and no law.
    let before = toml::to_string(&record()).unwrap().replace("\nlaw = \"paris\"", "\nestimate = \"least_squares\"");
    assert!(before.contains("estimate"));
    std::fs::write(folder.path().join("fitted.toml"), before).unwrap();
    assert_eq!(Case::from_file(&path, &[]).unwrap().law, LawSource::Fitted(Box::new(record())));

    std::fs::write(folder.path().join("fitted.toml"), toml::to_string(&record()).unwrap().replace("5000", "-5000")).unwrap();
    assert_refusal(Case::from_file(&path, &[]), &["fitted.toml:1", "a = -5000", "above zero"]);
}

#[test]
fn a_table_without_law_is_a_calibration() {
    let table = TEXT.parse().unwrap();
    let case = Case::from_table(table, "fit", &Folder::none()).unwrap();
    assert_eq!(case.law, LawSource::Missing(PathBuf::new()));
    assert_eq!(case.fatigue_law(1e-3).unwrap_err().exit_code(), 2);
    assert_refusal(read("", &[]), &["fatigue.fitted", "calibrate"]);
}

#[test]
fn the_bond_law_left_open_is_one_that_the_material_can_have() {
    for (set, law) in [
        (vec!["material.poisson_ratio=0.3333"], BondLawKind::TwoParameter),
        (vec!["material.poisson_ratio=0.34"], BondLawKind::StateBased),
        (vec!["material.plane=strain", "material.poisson_ratio=0.25"], BondLawKind::TwoParameter),
        (vec!["material.plane=strain"], BondLawKind::StateBased),
    ] {
        let case = read(INLINE, &set).unwrap();
        assert_eq!(case.points().bond_law.kind, law, "{set:?}");
        // A of an inline law belongs to the two-parameter law.
        assert_eq!(case.warnings.iter().any(|line| line.contains("bond_law state_based")), law == BondLawKind::StateBased);
    }
}

#[test]
fn what_is_planned_is_said_to_be_planned() {
    for (key, value) in [("fatigue.failure", "energy"), ("fatigue.failure", "stress")] {
        assert_refusal(read(INLINE, &[&format!("{key}={value}")]), &[key, value, "is not supported yet"]);
    }
}

#[test]
fn what_belongs_to_scenes_is_sent_there() {
    for (key, names) in perilife_base::input::OF_SCENES {
        for value in *names {
            assert_refusal(read(INLINE, &[&format!("{key}={value}")]), &[*key, *value, "perilife fracture"]);
        }
    }
}

#[test]
fn overloads_and_other_kernels_are_said() {
    let words = |overrides: &[&str]| read(INLINE, overrides).unwrap().warnings.join("\n");
    let overload = words(&["loading.stress_range_mpa=400", "material.yield_strength_mpa=345"]);
    assert!(overload.contains("exceeds the plastic collapse load"));
    assert!(words(&["model.kernel=constant"]).contains("apply to the default bond law"));
}

#[test]
fn every_shipped_case_is_that_of_its_echo() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cases");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let case = Case::from_file(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
            assert!(!case.specimen.tips.is_empty());
            // What a run leaves as its input is the same case to the last bit.
            let run = tempfile::tempdir().unwrap();
            perilife_results::run::write_input(run.path(), &case).unwrap();
            let again = Case::from_file(&run.path().join("case.toml"), &[]).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(KeptRun::hash(&again), KeptRun::hash(&case), "{}", path.display());
            count += 1;
        }
    }
    assert!(count >= 8, "{count}");
}

#[test]
fn every_material_has_sources_and_fits_the_default_law() {
    for name in library::names() {
        let file = library::find(&name, &Folder::none()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let properties = [
            Some(&file.youngs_modulus_gpa),
            Some(&file.poisson_ratio),
            file.yield_strength_mpa.as_ref(),
            file.toughness_mpa_sqrt_m.as_ref(),
        ];
        assert!(properties.iter().flatten().all(|property| property.source.len() > 10 && property.value > 0.0), "{name}");
        assert!(file.poisson_ratio.value <= 1.0 / 3.0, "{name}: the default law reaches 1/3");
    }
    let al = library::find("al2024-t3", &Folder::none()).unwrap();
    assert_eq!((al.youngs_modulus_gpa.value, al.poisson_ratio.value), (73.1, 0.33));
}

#[test]
fn an_own_material_file_is_found_beside_the_case() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("own.toml"),
        "title = \"own\"\nyoungs_modulus_gpa = { value = 50, source = \"test\" }\npoisson_ratio = { value = 0.2, source = \"test\" }\n",
    )
    .unwrap();
    let text = TEXT.replace("youngs_modulus_gpa = 73.1\npoisson_ratio = 0.33", "name = \"own.toml\"") + INLINE;
    let case = Case::from_toml(&text, "panel", folder.path(), &[]).unwrap();
    assert_eq!((case.material.youngs_modulus, case.material.poisson_ratio), (50e9, 0.2));
}
