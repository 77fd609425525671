//! Broken scene files: each is refused with file, key and what would be right; nothing panics.

use std::path::Path;

use perilife_base::error::Error;
use perilife_growth::case::Case;
use perilife_scenes::Scene;
use proptest::prelude::*;

use crate::interface::bad_toml::any_value;
use crate::interface::cli::{self, perilife, texts};
use files::{Bad, PRESSED, PULLED, REFINED, THROWN};

mod files;
mod keys;
mod laws;
mod loads;
mod points;

/// All broken files.
fn bad() -> impl Iterator<Item = &'static Bad> {
    [keys::KEYS, loads::PLACES, loads::TIMES, laws::SOLVERS, laws::DAMAGE, points::POINTS].into_iter().flatten()
}

#[test]
fn the_good_files_are_good() {
    for text in [THROWN, PULLED, PRESSED, REFINED] {
        Scene::from_toml(text, "good", Path::new(""), &[]).unwrap();
    }
}

#[test]
fn every_broken_scene_is_refused_with_words() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.toml");
    // All of them are looked at before the verdict.
    let mut wrong = Vec::new();
    for (good, old, new, words) in bad() {
        let text = good.replacen(old, new, 1);
        assert_ne!(text, *good, "nothing was broken: {old}");
        std::fs::write(&file, &text).unwrap();
        let result = Scene::from_file(&file, &[]);
        let message = result.as_ref().err().map(Error::to_string).unwrap_or_default();
        let name = file.display().to_string();
        let is_first = message.starts_with(&name) || message.contains(" mistakes\n1. ");
        let refused = matches!(&result, Err(Error::Input(_))) && is_first && message.contains(&name);
        let told = message.contains("; ") && words.iter().all(|word| message.contains(word));
        if words.is_empty() != result.is_ok() || !(words.is_empty() || refused && told) {
            wrong.push(format!("{new}: wants {words:?}, says {message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // The program says the same once, and leaves nothing.
    for (good, old, new, words) in bad().step_by(10).filter(|bad| !bad.3.is_empty()) {
        std::fs::write(&file, good.replacen(old, new, 1)).unwrap();
        for command in [&["fracture", "scene.toml", "--out", "run"][..], &["check", "scene.toml"]] {
            let output = perilife(folder.path(), command);
            if command[0] == "check" && texts(&output).1.contains("calibrat") {
                // A section of a calibration makes `check` read it as one.
                continue;
            }
            assert_eq!(output.status.code(), Some(2), "{new}");
            assert_eq!(texts(&output).1.matches("error: ").count(), 1, "{new}: one message");
            assert!(texts(&output).1.contains("scene.toml:"), "{new}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{new}: nothing but the scene stands there {words:?}");
    }
}

/// A fatigue case is no scene, and a scene no case; each is sent to the other command.
#[test]
fn cases_and_scenes_are_sent_to_their_command() {
    for text in [THROWN, PULLED, PRESSED, REFINED] {
        let error = Case::from_toml(text, "scene", Path::new(""), &[]).unwrap_err().to_string();
        assert!(error.contains("perilife fracture"), "{error}");
    }
    let bare = THROWN.replace("[damage]\nlaw = \"critical_energy\"\n", "");
    let error = Case::from_toml(&bare, "scene", Path::new(""), &[]).unwrap_err().to_string();
    assert!(error.contains("loading.kind") && error.contains("perilife fracture"), "{error}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("case.toml"), cli::SMALL_CASE).unwrap();
    let output = perilife(folder.path(), &["fracture", "case.toml", "--out", "run"]);
    cli::assert_refused(&output, 2, &["case.toml", "perilife predict"]);
}

/// Keys of all sections of a scene.
const KEYS: &[&str] = &[
    "kind",
    "width_mm",
    "diameter_mm",
    "outline_mm",
    "cracks",
    "notches",
    "poisson_ratio",
    "density_kg_m3",
    "fracture_energy_j_m2",
    "bond_law",
    "kernel",
    "spacing_mm",
    "horizon_ratio",
    "lattice_angle_deg",
    "discretisation",
    "solver",
    "zero_energy_control",
    "zero_energy_factor",
    "kinematics",
    "parts",
    "edges",
    "regions",
    "grip_mm",
    "range_mm",
    "direction",
    "transverse",
    "stress_mpa",
    "displacement_mm",
    "velocity_mm_s",
    "steps",
    "duration_s",
    "time_step_s",
    "ramp_s",
    "from_s",
    "top",
    "pin",
    "law",
    "enters",
    "calibration",
    "critical_stretch",
    "elastic_stretch",
    "final_ratio",
    "seed",
    "count",
    "length_min_mm",
    "length_max_mm",
    "angle_min_deg",
    "from_mm",
    "to_mm",
    "fix",
    "levels",
    "box_mm",
    "band_mm",
];

proptest! {
    /// One key of a good scene set to anything: a scene or words, never a panic.
    #[test]
    fn any_value_gives_a_scene_or_words(section in prop::sample::select(&["specimen", "material", "loading", "supports", "model", "damage", "refinement", "micro_cracks"][..]),
                                        key in prop::sample::select(KEYS), value in any_value(), which in 0..4_usize) {
        let text = [THROWN, PULLED, PRESSED, REFINED][which];
        let overrides = [format!("{section}.{key}={value}")];
        if let Err(error) = Scene::from_toml(text, "any", Path::new("/nowhere"), &overrides) {
            prop_assert!(!error.to_string().is_empty());
        }
    }

    /// Any box of a load, any micro cracks and any refinement.
    #[test]
    fn any_numbers_give_a_scene_or_words(x in prop::collection::vec(-30.0..30.0f64, 12), count in 0..40_u64, levels in 0..6_u64) {
        let loading = format!("parts = [{{ kind = \"displacement\", displacement_mm = {}, direction = [{}, {}], regions = [{{ from_mm = [{}, {}], to_mm = [{}, {}] }}] }}]\nsteps = {levels}", x[0], x[1], x[2], x[3], x[4], x[5], x[6]);
        let text = REFINED.replace("kind = \"traction\"\nstress_mpa = 5\nedges = [\"top\", \"bottom\"]", &loading)
            .replace("levels = 1", &format!("levels = {levels}"))
            .replace("[[-5, -5], [5, 5]]", &format!("[[{}, {}], [{}, {}]]", x[7], x[8], x[9], x[10]));
        let text = format!("{text}[micro_cracks]\nseed = {count}\ncount = {count}\nlength_max_mm = {}\n", x[11]);
        if let Ok(scene) = Scene::from_toml(&text, "any", Path::new(""), &[]) {
            prop_assert!(scene.specimen.cracks.len() as u64 == count && scene.drives.len() == 1);
        }
    }

    /// Any text at all.
    #[test]
    fn any_text_gives_a_scene_or_words(text in "\\PC{0,200}") {
        let _ = Scene::from_toml(&text, "any", Path::new(""), &[]);
    }
}
