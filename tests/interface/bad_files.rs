//! Broken case and scene files: each is refused with file, key and what would be right; nothing panics.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use perilife_base::error::{Error, Result};
use perilife_base::keys::all;
use perilife_growth::case::Case;
use perilife_runner::catalogue;
use perilife_scenes::Scene;
use proptest::prelude::*;

use crate::interface::cli::{perilife, texts};
use crate::support::desk::desk;
use crate::support::rows::rows;

/// Good files of both sorts by name.
static GOOD: LazyLock<[BTreeMap<String, String>; 2]> =
    LazyLock::new(|| ["bad_cases", "bad_scenes"].map(|file| rows(file, "good")));

fn read(is_scene: bool, file: &Path, set: &[String]) -> Result<()> {
    if is_scene { Scene::from_file(file, set).map(drop) } else { Case::from_file(file, set).map(drop) }
}

fn read_text(is_scene: bool, text: &str, set: &[String]) -> Result<()> {
    let folder = Path::new("/nowhere");
    if is_scene {
        Scene::from_toml(text, "any", folder, set).map(drop)
    } else {
        Case::from_toml(text, "any", folder, set).map(drop)
    }
}

/// What is amiss in a refusal of `file`: it names the file, gives a remedy and says these words.
fn amiss(result: Result<()>, file: &Path, words: &[impl AsRef<str>]) -> Option<String> {
    let Err(error) = result else { return Some("was taken".to_owned()) };
    let (message, name) = (error.to_string(), file.display().to_string());
    let is_first = message.starts_with(&name) || message.contains(" mistakes\n1. ");
    let is_input = matches!(error, Error::Input(_)) && error.exit_code() == 2;
    let says = words.iter().all(|words| message.contains(words.as_ref()));
    (!(is_input && is_first && message.contains(&name) && message.contains("; ") && says)).then_some(message)
}

#[test]
fn every_broken_file_is_refused_with_words() {
    let folder = tempfile::tempdir().unwrap();
    // All of them are looked at before the verdict.
    let mut wrong = Vec::new();
    for (is_scene, table, name) in [(false, "bad_cases", "case.toml"), (true, "bad_scenes", "scene.toml")] {
        let file = folder.path().join(name);
        GOOD[usize::from(is_scene)].values().for_each(|text| read_text(is_scene, text, &[]).unwrap());
        for (i, (good, old, new, words)) in rows::<Vec<(String, String, String, Vec<String>)>>(table, "rows").iter().enumerate() {
            let good = &GOOD[usize::from(is_scene)][good];
            let text = good.replacen(old, new, 1);
            assert_ne!(text, *good, "nothing was broken: {old}");
            std::fs::write(&file, &text).unwrap();
            let result = read(is_scene, &file, &[]);
            let told = if words.is_empty() { result.err().map(|error| error.to_string()) } else { amiss(result, &file, words) };
            wrong.extend(told.map(|told| format!("{new}: wants {words:?}, but {told}")));
            // The program says the same once, and leaves nothing.
            let commands = [&["fracture", name, "--out", "run"][..], &["predict", name, "--out", "run"], &["check", name]];
            for command in commands.into_iter().skip(usize::from(!is_scene)).filter(|_| i % 4 == 0 && !words.is_empty()) {
                let output = perilife(folder.path(), command);
                let said = texts(&output).1;
                // A section of a calibration makes `check` read it as one; a scene is no case.
                if command[0] == "check" && said.contains("calibrat") || command[0] == "predict" && is_scene {
                    continue;
                }
                cli::assert_refused(&output, 2, &[name]);
                assert_eq!(said.matches("error: ").count(), 1, "{new}: one message");
            }
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{new}: nothing but the file stands there");
        }
        std::fs::remove_file(file).unwrap();
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn broken_overrides_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("case.toml");
    std::fs::write(&file, &GOOD[0]["panel"]).unwrap();
    let rows: [(&str, &[&str]); 7] = [
        ("model.spacing_mm", &["--set", "model.spacing_mm", "has no =", "section.key=value"]),
        ("spacing=1", &["--set", "SECTION.KEY=VALUE"]),
        ("model..x=1", &["--set", "SECTION.KEY=VALUE"]),
        ("model.spacing_mm=", &["--set", "has no value"]),
        ("model.spacing_mm.fine=1", &["--set", "not a table"]),
        ("model.spacing_mm=fine", &["model.spacing_mm", "fine", "a number", "--set"]),
        ("model.spacing=1", &["model.spacing", "unknown key", "spacing_mm"]),
    ];
    for (set, words) in rows {
        let result = read(false, &file, &[set.to_owned()]);
        // A call is refused without the name of a file.
        let place = if words[0] == "--set" { Path::new("--set") } else { &file };
        assert_eq!(amiss(result, place, words), None, "{set}");
    }
}

#[test]
fn missing_and_unreadable_files_are_file_errors() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("nowhere.toml"), folder.path().to_path_buf()] {
        let error = Case::from_file(&path, &[]).unwrap_err();
        assert!(matches!(error, Error::File { .. }), "{error}");
        assert_eq!(error.exit_code(), 4);
        assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
    }
    // An own material file that does not exist.
    let text = GOOD[0]["panel"].replace("name = \"al2024-t3\"", "name = \"own.toml\"");
    let error = Case::from_toml(&text, "case", folder.path(), &[]).unwrap_err();
    assert!(error.exit_code() == 4 && error.to_string().contains("own.toml"), "{error}");
    // Bytes that are not text, and nothing at all, are wrong input.
    let file = folder.path().join("binary.toml");
    for (bytes, words) in [(&[0x66, 0x6f, 0xff, 0xfe][..], &["UTF-8"][..]), (&[], &["specimen", "missing"])] {
        std::fs::write(&file, bytes).unwrap();
        assert_eq!(amiss(read(false, &file, &[]), &file, words), None);
    }
}

/// A fatigue case is no scene, and a scene no case; each is sent to the other command.
#[test]
fn cases_and_scenes_are_sent_to_their_command() {
    let thrown = &GOOD[1]["thrown"];
    let bare = thrown.replace("[damage]\nlaw = \"critical_energy\"\n", "");
    for text in GOOD[1].values().chain([&bare]) {
        let error = read_text(false, text, &[]).unwrap_err().to_string();
        assert!(error.contains("perilife fracture") && (text != &bare || error.contains("loading.kind")), "{error}");
    }
    let folder = desk(&[("case.toml", &cli::SMALL_CASE)]);
    let output = perilife(folder.path(), &["fracture", "case.toml", "--out", "run"]);
    cli::assert_refused(&output, 2, &["case.toml", "perilife predict"]);
}

/// Every key that is declared, as an override names it.
static KEYS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let sections =
        [catalogue::told(), catalogue::beside()].concat().into_iter().filter(|told| !told.section.starts_with("sweep"));
    let keys = sections.flat_map(|told| {
        let section = told.section.trim_start_matches("scene.").to_owned();
        let section = if section.starts_with("specimen.") { "specimen".to_owned() } else { section };
        all(&told.keys).into_iter().map(move |key| format!("{section}.{}", key.name)).collect::<Vec<_>>()
    });
    keys.collect()
});

/// Values a user could write, or not.
fn any_value() -> impl Strategy<Value = String> {
    let number = prop::num::f64::ANY.prop_map(|x| if x.is_nan() { "nan".to_owned() } else { format!("{x:e}") });
    let leaf = prop_oneof![
        number,
        Just("-inf".to_owned()),
        (-1000.0..1000.0f64).prop_map(|x| format!("{x:.3}")),
        any::<i64>().prop_map(|i| i.to_string()),
        Just("true".to_owned()),
        Just("1979-05-27".to_owned()),
        "[a-z_]{0,12}".prop_map(|text| format!("\"{text}\"")),
        Just("\"\\u00e9[].\"".to_owned()),
    ];
    let names =
        ["x_mm", "y_mm", "diameter_mm", "from_mm", "to_mm", "hole", "direction", "fix", "kind", "levels", "\"\"", "\"a.b\""];
    leaf.prop_recursive(3, 12, 4, move |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(|items| format!("[{}]", items.join(", "))),
            prop::collection::vec((prop::sample::select(&names[..]), inner), 0..3).prop_map(|pairs| {
                let items: Vec<String> = pairs.iter().map(|(key, value)| format!("{key} = {value}")).collect();
                format!("{{ {} }}", items.join(", "))
            }),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    /// One key of a good file set to anything: a case, a scene or words, never a panic.
    #[test]
    fn any_value_gives_a_file_or_words(key in prop::sample::select(&KEYS[..]), value in any_value(), which in any::<prop::sample::Index>()) {
        let goods: Vec<(bool, &String)> = [false, true].into_iter().flat_map(|of| GOOD[usize::from(of)].values().map(move |text| (of, text))).collect();
        let (is_scene, text) = goods[which.index(goods.len())];
        if let Err(error) = read_text(is_scene, text, &[format!("{key}={value}")]) {
            prop_assert!(!error.to_string().is_empty());
        }
    }

    /// A plate with any hole, crack and notch.
    #[test]
    fn any_flaws_give_a_case_or_words(x in prop::collection::vec(-60.0..60.0f64, 12), width in 0.0..60.0f64) {
        let flaws = format!(
            "holes = [{{ x_mm = {}, y_mm = {}, diameter_mm = {width} }}]\ncracks = [{{ from_mm = [{}, {}], to_mm = [{}, {}] }}, {{ from_mm = [{}, {}], to_mm = [{}, {}] }}]\n\
             notches = [{{ from_mm = [{}, {}], to_mm = [{}, {}], width_mm = {width} }}]\n[material]\nname = \"q345\"\n[loading]\nstress_max_mpa = 1\nstress_ratio = 0\n[fatigue]\na = 1\np = 2\nhorizon_mm = 3",
            x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8], x[9], x[10], x[11], x[0], x[2]
        );
        let text = format!("[specimen]\nkind = \"plate\"\nwidth_mm = 100\nlength_mm = 100\nthickness_mm = 1\n{flaws}");
        if let Ok(case) = Case::from_toml(&text, "any", Path::new(""), &[]) {
            prop_assert!(case.specimen.crack_length > 0.0 && !case.specimen.tips.is_empty());
            prop_assert!(case.specimen.tips.iter().all(|tip| tip.position[0].abs() <= 0.05 && tip.position[1].abs() <= 0.05));
        }
    }

    /// Any box of a load, any micro cracks and any refinement.
    #[test]
    fn any_numbers_give_a_scene_or_words(x in prop::collection::vec(-30.0..30.0f64, 12), count in 0..40_u64, levels in 0..6_u64) {
        let loading = format!("parts = [{{ kind = \"displacement\", displacement_mm = {}, direction = [{}, {}], regions = [{{ from_mm = [{}, {}], to_mm = [{}, {}] }}] }}]\nsteps = {levels}", x[0], x[1], x[2], x[3], x[4], x[5], x[6]);
        let text = GOOD[1]["refined"].replace("kind = \"traction\"\nstress_mpa = 5\nedges = [\"top\", \"bottom\"]", &loading)
            .replace("levels = 1", &format!("levels = {levels}"))
            .replace("[[-5, -5], [5, 5]]", &format!("[[{}, {}], [{}, {}]]", x[7], x[8], x[9], x[10]));
        let text = format!("{text}[micro_cracks]\nseed = {count}\ncount = {count}\nlength_max_mm = {}\n", x[11]);
        if let Ok(scene) = Scene::from_toml(&text, "any", Path::new(""), &[]) {
            prop_assert!(scene.specimen.cracks.len() as u64 == count && scene.drives.len() == 1);
        }
    }

    #[test]
    fn any_text_gives_a_file_or_words(text in "\\PC{0,200}", is_scene in any::<bool>()) {
        let _ = read_text(is_scene, &text, &[]);
    }
}
