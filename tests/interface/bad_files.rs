//! Broken cases, scenes, sweeps and measured curves: each is refused with place, key or value and what would be right; nothing panics.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use perilife_base::error::{Error, Result};
use perilife_base::keys::all;
use perilife_growth::case::Case;
use perilife_runner::catalogue;
use perilife_scenes::Scene;
use proptest::prelude::*;
use tempfile::tempdir;

use crate::interface::cli::{SMALL_CASE, assert_refused, perilife, texts};
use crate::interface::sweep::{GRID, folder_with};
use crate::support::desk::{desk, done};
use crate::support::rows::{assert_refusal, rows};

// Broken case and scene files: each is refused with file, key and what would be right; nothing panics.

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
            let first = if is_scene { "fracture" } else { "predict" };
            let commands = [&[first, name, "--out", "run"][..], &["check", name]];
            for command in commands.into_iter().filter(|_| (!is_scene || i % 10 == 0) && !words.is_empty()) {
                let output = perilife(folder.path(), command);
                let said = texts(&output).1;
                // A section of a calibration makes `check` read it as one.
                if command[0] == "check" && said.contains("calibrat") {
                    continue;
                }
                assert_refused(&output, 2, &[name]);
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
        if words[0] == "--set" {
            // A call is refused without the name of a file.
            assert_refusal(result, words);
        } else {
            assert_eq!(amiss(result, &file, words), None, "{set}");
        }
    }
}

#[test]
fn unreadable_content_is_wrong_input_and_a_missing_material_a_file_error() {
    let folder = tempfile::tempdir().unwrap();
    let text = GOOD[0]["panel"].replace("name = \"al2024-t3\"", "name = \"own.toml\"");
    let error = Case::from_toml(&text, "case", folder.path(), &[]).unwrap_err();
    assert!(error.exit_code() == 4 && error.to_string().contains("own.toml"), "{error}");
    // Bytes that are not text, and nothing at all.
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
    let folder = desk(&[("case.toml", &SMALL_CASE)]);
    let output = perilife(folder.path(), "fracture case.toml --out run");
    assert_refused(&output, 2, &["case.toml", "perilife predict"]);
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
            prop::collection::vec((prop::sample::select(names.to_vec()), inner), 0..3).prop_map(|pairs| {
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

// Sweep files that are wrong: refused before anything is run, with words.

#[test]
fn bad_designs_are_refused_before_anything_runs() {
    let heads: BTreeMap<String, String> = rows("bad_sweeps", "heads");
    for (head, rest, code, words) in rows::<Vec<(String, String, i32, Vec<String>)>>("bad_sweeps", "broken") {
        let dir = folder_with(&format!("{}{rest}", heads.get(&head).map_or("", String::as_str)));
        println!("{head} {rest}");
        let output = perilife(dir.path(), "sweep sweep.toml --out out");
        assert_refused(&output, code, &words);
        assert!(!dir.path().join("out").exists());
    }
    let dir = folder_with(GRID);
    for shard in ["0/3", "4/3", "1", "a/b"] {
        let output = perilife(dir.path(), &format!("sweep sweep.toml --out out --shard {shard}"));
        assert_eq!(output.status.code(), Some(2), "{shard}");
    }
}

// Broken measured curves: every one ends with words that name file, line, column, value and what would be right.

/// A panel of half width 76.2 mm.
const PANEL: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 300\nthickness_mm = 2.54\ncrack_length_mm = 9\n\
                     [material]\nname = \"al2024-t3\"\n[loading]\nkind = \"constant_amplitude\"\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n";

const HEADER: &str = "specimen,cycles,crack_length_mm\n";

/// Four good rows, so that a fifth decides.
const ROWS: &str = "S1,0,9.0\nS1,1000,9.2\nS1,2000,9.4\nS1,3000,9.6\n";

#[test]
fn every_broken_curve_is_refused_with_place_value_and_remedy() {
    let folder = desk(&[("panel.toml", &PANEL)]);
    let text = rows::<Vec<(String, String, [String; 4])>>("bad_csv", "broken").into_iter();
    let picture = b"cycles,crack_length_mm\n\x89PNG\xff\xd8\0,1\n".to_vec();
    let picture = ("a picture".to_owned(), picture, [":2: ", "", "is not text", "CSV in UTF-8"].map(str::to_owned));
    for (name, bytes, words) in text.map(|(name, text, words)| (name, text.into_bytes(), words)).chain([picture]) {
        let file = format!("{name}.csv");
        fs::write(folder.path().join(&file), bytes).unwrap();
        let output = perilife(folder.path(), &["rates", &*file, "--specimen", "panel.toml", "--out", "rates.csv"]);
        assert_refused(&output, 2, &[&file]);
        assert_refused(&output, 2, &words);
        let (_, stderr) = texts(&output);
        // A table of unknown shape shows its first rows.
        let lines = stderr.trim_end().lines().filter(|line| !line.starts_with("  line "));
        assert_eq!(lines.count(), 1, "{name}: one message: {stderr}");
        assert!(!folder.path().join("rates.csv").exists(), "{name}: nothing half-written");
    }
}

#[test]
fn files_that_cannot_be_read_end_with_four() {
    let folder = tempdir().unwrap();
    fs::create_dir(folder.path().join("folder.csv")).unwrap();
    for file in ["missing.csv", "folder.csv", "no/such/folder/x.csv", "missing.parquet"] {
        let output = perilife(folder.path(), &["rates", file]);
        assert_refused(&output, 4, &[file, "cannot read"]);
    }
}

#[test]
fn unusual_but_right_files_are_read() {
    let folder = desk(&[("panel.toml", &PANEL)]);
    let plain = format!("{HEADER}{ROWS}S1,4000,9.9\n");
    let crlf = plain.replace('\n', "\r\n");
    let decimal_comma = plain.replace(',', ";").replace('.', ",");
    let bom = format!("\u{feff}{plain}");
    let together = format!("\u{feff}{}", decimal_comma.replace('\n', "\r\n"));
    let rates = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).unwrap();
        let (stdout, _) = done(folder.path(), &format!("rates {name} --specimen panel.toml --method secant"));
        stdout
    };
    let expected = rates("plain.csv", &plain);
    assert!(
        expected.starts_with(
            "specimen,cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,flags,stress_ratio\nS1,500.0000000,9.1"
        ),
        "{expected}"
    );
    // 0.2 mm steps are too short by E647, the last one of 0.3 mm is not.
    assert_eq!(expected.matches("step_under_0.25_mm").count(), 3, "{expected}");
    for (name, text) in [("crlf.csv", crlf), ("comma.csv", decimal_comma), ("bom.csv", bom), ("together.csv", together)] {
        assert_eq!(rates(name, &text), expected, "{name}");
    }
}

#[test]
fn json_is_one_object_and_the_same_specimen_twice_is_refused() {
    let folder = tempdir().unwrap();
    let text = format!("{HEADER}{ROWS}S1,4000,9.9\nS1,5000,10.3\nS1,6000,10.9\n");
    ["a.csv", "b.csv"].iter().for_each(|name| fs::write(folder.path().join(name), &text).unwrap());
    let output = perilife(folder.path(), "rates a.csv --json");
    let object: serde_json::Value = serde_json::from_str(&texts(&output).0).unwrap();
    assert_eq!(object["method"], "polynomial7");
    assert_eq!(object["specimens"][0]["points"].as_array().unwrap().len(), 1);
    assert!(object["specimens"][0]["points"][0]["delta_k_mpa_sqrt_m"].is_null(), "no specimen, no ΔK");
    assert_refused(&perilife(folder.path(), "rates a.csv b.csv"), 2, &["b.csv:2", "specimen = S1", "a.csv", "own name"]);
}
