//! Broken case files: each is refused with file, key and what would be right; nothing panics.

use std::path::Path;

use perilife_base::error::Error;
use perilife_growth::case::Case;
use proptest::prelude::*;

use crate::interface::cli::{self, perilife, texts};

const PANEL: &str = r#"[specimen]
kind = "middle_tension"
width_mm = 152.4
length_mm = 300.0
thickness_mm = 2.54
crack_length_mm = 9.0
[material]
name = "al2024-t3"
[loading]
stress_range_mpa = 48.28
stress_ratio = 0.2
[model]
spacing_mm = 1.0
[fatigue]
a = 6450.0
p = 2.86
horizon_mm = 3.015
[stop]
crack_length_mm = 49.8
"#;

const PLATE: &str = r#"[specimen]
kind = "plate"
width_mm = 100
length_mm = 200
thickness_mm = 2
holes = [{ x_mm = 20, y_mm = 0, diameter_mm = 10 }, { x_mm = -20, y_mm = 0, diameter_mm = 10 }]
cracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]
notches = [{ from_mm = [-50, 40], to_mm = [-40, 40], width_mm = 2 }]
[material]
youngs_modulus_gpa = 72
poisson_ratio = 0.3
[loading]
stress_max_mpa = 70
stress_ratio = 0.1
[fatigue]
a = 6450
p = 2.86
horizon_mm = 3.015
"#;

/// One line of a good file replaced (or a whole section left out), and what the message must contain.
struct Bad {
    good: &'static str,
    old: &'static str,
    new: &'static str,
    /// Key, line where it can be known, and words of problem and remedy.
    words: &'static [&'static str],
}

const fn panel(old: &'static str, new: &'static str, words: &'static [&'static str]) -> Bad {
    Bad { good: PANEL, old, new, words }
}

const fn plate(old: &'static str, new: &'static str, words: &'static [&'static str]) -> Bad {
    Bad { good: PLATE, old, new, words }
}

const BAD: &[Bad] = &[
    // Keys, sections, types
    panel("width_mm = 152.4", "widht_mm = 152.4", &[":3:", "specimen.widht_mm", "unknown key", "did you mean width_mm?"]),
    panel("[material]\nname = \"al2024-t3\"\n", "", &["material", "missing", "[material]"]),
    panel("[loading]\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n", "", &["loading", "missing"]),
    panel("[specimen]", "[speciman]", &[":1:", "speciman", "unknown section", "specimen"]),
    panel("[specimen]", "colour = 3\n[specimen]", &[":1:", "colour", "outside any section"]),
    panel("[specimen]", "stop = 3\n[specimen]", &["invalid TOML", "duplicate"]),
    panel("[stop]", "[measured]\nfiles = [\"a.csv\"]\n[stop]", &[":18:", "measured", "calibrate"]),
    panel("[stop]", "[micro_cracks]\nseed = 2\n[stop]", &["micro_cracks", "fracture scene", "perilife fracture"]),
    panel("width_mm = 152.4", "width_mm = 152.4 mm", &[":3:", "invalid TOML"]),
    panel("width_mm = 152.4", "width_mm = 152.4\nwidth_mm = 3", &[":4:", "invalid TOML", "each key once"]),
    panel("[material]", "[material", &[":7:", "invalid TOML"]),
    // Specimens
    panel(
        "kind = \"middle_tension\"",
        "kind = \"middle_tention\"",
        &[":2:", "specimen.kind", "middle_tention", "did you mean \"middle_tension\"?"],
    ),
    panel("kind = \"middle_tension\"", "kind = 7", &[":2:", "specimen.kind", "text in quotes"]),
    panel("kind = \"middle_tension\"\n", "", &["specimen.kind", "missing", "compact_tension"]),
    panel(
        "kind = \"middle_tension\"",
        "kind = \"corner_crack\"",
        &["specimen.crack_length_mm", "applies only to middle_tension", "specimen.crack_depth_mm: is missing"],
    ),
    panel("kind = \"middle_tension\"", "kind = \"thumbnail_crack\"", &[":2:", "thumbnail_crack", "surface_crack, corner_crack"]),
    panel(
        "crack_length_mm = 9.0",
        "crack_length_mm = 9.0\ndepth_mm = 2",
        &["specimen.depth_mm", "applies only to part-through cracks", "surface_crack"],
    ),
    panel(
        "crack_length_mm = 9.0",
        "crack_length_mm = 76.2",
        &[":6:", "specimen.crack_length_mm", "76.2", "half width", "shorter crack"],
    ),
    plate(
        "from_mm = [-5, 0], to_mm = [5, 0]",
        "from_mm = [75, 0], to_mm = [55, 30]",
        &[":7:", "specimen.cracks[0]", "outside the plate at (75, 0) mm", "inside"],
    ),
    plate("to_mm = [5, 0]", "to_mm = [35, 0]", &["specimen.cracks[0]", "runs through", "holes[0]"]),
    plate("to_mm = [5, 0]", "to_mm = [-5, 0]", &["specimen.cracks[0]", "zero length"]),
    plate("to_mm = [5, 0]", "to_mm = [5]", &["specimen.cracks[0].to_mm", "pair of numbers"]),
    plate(
        "cracks = [",
        "cracks = [{ from_mm = [-3, 0], to_mm = [3, 0] }, ",
        &["specimen.cracks[1]", "overlaps cracks[0]", "one crack"],
    ),
    plate(
        "to_mm = [5, 0]",
        "to_mm = [5, 0], path_mm = [[0, 0], [5, 0]]",
        &["specimen.cracks[0].path_mm", "conflicts with from_mm"],
    ),
    plate("to_mm = [5, 0]", "path_mm = [[5, 0]]", &["specimen.cracks[0].path_mm", "conflicts with from_mm"]),
    plate("from_mm = [-5, 0], to_mm = [5, 0]", "path_mm = [[0, 0]]", &["specimen.cracks[0].path_mm", "1 points", "2 to 500"]),
    plate(
        "from_mm = [-5, 0], to_mm = [5, 0]",
        "path_mm = [[0, 0], [5, 0], [5, 0]]",
        &["specimen.cracks[0].path_mm[2]", "coincides"],
    ),
    plate(
        "from_mm = [-5, 0], to_mm = [5, 0]",
        "path_mm = [[0, 0], [5, 0], [5, 5], [2, -3]]",
        &["specimen.cracks[0].path_mm", "folds back on itself after point 2", "share a point"],
    ),
    plate(
        "cracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]",
        "cracks = [{ from_mm = [-50, 70], to_mm = [50, 70] }]",
        &["cracks[0]", "no tip inside"],
    ),
    plate(
        "from_mm = [-5, 0], to_mm = [5, 0]",
        "path_mm = [[-5, 20], [5, 20], [-3, 22]]",
        &["specimen.cracks[0]", "turns by 166° at (5, 20) mm", "end the crack at that corner"],
    ),
    // They share an end, which then is no tip of either.
    plate(
        "cracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]",
        "cracks = [{ from_mm = [-5, 20], to_mm = [5, 20] }, { from_mm = [1, 20], to_mm = [5, 20] }]",
        &["specimen.cracks[0]", "shares its end", "folds back on itself", "once"],
    ),
    // Both meet; the first parts the plate, whatever ends on it.
    plate(
        "cracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]",
        "cracks = [{ from_mm = [-50, 70], to_mm = [50, 70] }, { from_mm = [0, 50], to_mm = [0, 70] }]",
        &["cracks[0]", "meets another crack", "no tip inside", "inside the plate"],
    ),
    plate(
        "cracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]\nnotches = [{ from_mm = [-50, 40], to_mm = [-40, 40], width_mm = 2 }]",
        "cracks = [{ from_mm = [-20, 0], to_mm = [20, 0] }, { from_mm = [0, 100], to_mm = [0, 0] }]",
        &["cracks[0]", "meets another crack", "no tip inside", "inside the plate"],
    ),
    plate("x_mm = 20,", "x_mm = -14,", &[":6:", "specimen.holes[1]", "overlaps holes[0]", "apart"]),
    plate("x_mm = 20,", "x_mm = 48,", &["specimen.holes[0]", "past the outline"]),
    plate("to_mm = [-40, 40], width_mm = 2", "to_mm = [60, 40], width_mm = 2", &["specimen.notches[0]", "cuts it in two"]),
    plate("to_mm = [-40, 40], width_mm = 2", "to_mm = [-15, 0], width_mm = 2", &["specimen.notches[0]", "overlaps holes[1]"]),
    plate(
        "width_mm = 100\nlength_mm = 200",
        "outline_mm = [[0, 0], [10, 10], [10, 0], [0, 10]]",
        &["specimen.outline_mm", "crosses", "in order"],
    ),
    plate("width_mm = 100\nlength_mm = 200", "outline_mm = [[0, 0], [10, 10]]", &["specimen.outline_mm", "not an outline"]),
    plate(
        "width_mm = 100\nlength_mm = 200",
        "outline_mm = [[0, 0], [10, 10], \"x\"]",
        &["specimen.outline_mm[2]", "is not a pair of numbers"],
    ),
    plate("width_mm = 100\n", "", &["specimen.width_mm", "missing", "outline_mm"]),
    // Material
    panel("name = \"al2024-t3\"", "name = \"unobtainium\"", &[":8:", "material.name", "unobtainium", "al2024-t3"]),
    panel("name = \"al2024-t3\"", "name = \"7075-T6\"", &[":8:", "material.name", "did you mean \"al7075-t6\"?"]),
    panel("name = \"al2024-t3\"", "youngs_modulus_gpa = 70", &["material.poisson_ratio", "missing"]),
    plate(
        "poisson_ratio = 0.3",
        "poisson_ratio = 0.4\n[model]\nbond_law = \"two_parameter\"",
        &[":11:", "material.poisson_ratio", "0.4", "1/3 in plane stress", "0.3333", "state_based"],
    ),
    plate(
        "poisson_ratio = 0.3",
        "poisson_ratio = 0.3\nplane = \"strain\"\n[model]\nbond_law = \"two_parameter\"",
        &["material.poisson_ratio", "1/4 in plane strain"],
    ),
    // Loading
    panel("stress_ratio = 0.2", "stress_ratio = 1.0", &[":11:", "loading.stress_ratio", "below 1"]),
    panel("stress_ratio = 0.2", "stress_ratio = 0.2\nstress_max_mpa = 60", &["loading.stress_", "conflicts with", "exactly one"]),
    panel("stress_range_mpa = 48.28", "stress_range_mpa = 1e308", &[":10:", "loading.stress_range_mpa", "out of range"]),
    panel("a = 6450.0", "a = 1e308", &["fatigue.a", "out of range"]),
    panel("stress_range_mpa = 48.28\n", "", &["loading.stress_max_mpa", "no load given", "force_range_n"]),
    panel(
        "stress_range_mpa = 48.28",
        "stress = 48.28",
        &[":10:", "loading.stress", "maximum or range", "stress_max_mpa, stress_range_mpa"],
    ),
    panel("stress_ratio = 0.2", "stress_min_mpa = 12", &[":11:", "loading.stress_min_mpa", "stress_ratio = minimum / maximum"]),
    panel("stress_ratio = 0.2", "R = 0.2", &[":11:", "loading.R = 0.2", "did you mean stress_ratio?"]),
    panel(
        "stress_ratio = 0.2",
        "stress_ratio = 0.2\nsequence = [1, 2]",
        &[":12:", "loading.sequence", "load sequence", "constant amplitude"],
    ),
    panel("stress_ratio = 0.2", "stress_ratio = 0.2\nedges = [\"top\"]", &["loading.edges", "middle_tension", "plate"]),
    plate("[fatigue]", "[supports]\nfloor = { fix = [\"x\"] }\n[fatigue]", &["supports.floor", "known sides", "bottom"]),
    plate(
        "stress_max_mpa = 70",
        "force_max_n = 70\npins = [{ hole = 7, direction = [0, 1] }]",
        &["loading.pins[0].hole", "7", "which has 2"],
    ),
    plate(
        "stress_max_mpa = 70",
        "stress_max_mpa = 70\npins = [{ hole = 0, direction = [1, 0] }, { hole = 1, direction = [-1, 0] }]",
        &["needs a force", "force_max_n"],
    ),
    // Model
    panel("spacing_mm = 1.0", "spacing_mm = 9.5", &[":13:", "model.spacing_mm", "larger than the crack (9 mm)", "1 mm"]),
    panel("spacing_mm = 1.0", "spacing_mm = 0.001", &["model.spacing_mm", "points", "or more"]),
    panel("spacing_mm = 1.0", "bond_law = \"correspondence\"", &["model.bond_law", "fracture scenes", "perilife fracture"]),
    // Points of several levels, and relaxation, belong to scenes
    panel(
        "[stop]",
        "[refinement]\nregions = [{ around_flaws_mm = 9, levels = 1 }]\n[stop]",
        &["refinement", "fracture scene", "perilife fracture", "element_free_galerkin", "refine themselves"],
    ),
    panel(
        "spacing_mm = 1.0",
        "discretisation = \"dual_horizon\"",
        &[
            ":13:",
            "model.discretisation",
            "not a key of fatigue cases",
            "perilife fracture",
            "element_free_galerkin",
            "refine themselves",
        ],
    ),
    panel(
        "spacing_mm = 1.0",
        "solver = \"adaptive_dynamic_relaxation\"",
        &[":13:", "model.solver", "fracture scenes", "perilife fracture", "window, multigrid"],
    ),
    plate(
        "[fatigue]",
        "[model]\nbond_law = \"bond_based\"\n[fatigue]",
        &["material.poisson_ratio", "bond_based", "two_parameter"],
    ),
    // Fatigue and stop
    panel("horizon_mm = 3.015\n", "", &["fatigue.horizon_mm", "missing", "A depends on the horizon"]),
    panel("a = 6450.0", "fitted = \"fitted.toml\"", &["fatigue.p", "conflicts with fatigue.fitted"]),
    panel("a = 6450.0\np = 2.86\nhorizon_mm = 3.015", "", &["fatigue.fitted", "no fatigue law", "calibrate"]),
    panel("crack_length_mm = 49.8", "crack_length_mm = 8", &[":19:", "stop.crack_length_mm", "must be above the initial"]),
    panel("crack_length_mm = 49.8", "crack_length_mm = 80", &[":19:", "stop.crack_length_mm", "ends at 76.2 mm"]),
];

/// Refused as wrong input with these words, the file named.
fn assert_refused(result: Result<Case, Error>, file: &Path, words: &[&str], what: &str) {
    let error = result.err().unwrap_or_else(|| panic!("accepted: {what}"));
    assert!(matches!(error, Error::Input(_)), "{what}: {error}");
    assert_eq!(error.exit_code(), 2);
    let message = error.to_string();
    let name = file.display().to_string();
    assert!(message.starts_with(&name) || message.contains(" mistakes\n1. "), "{what}: names the file first: {message}");
    assert!(message.contains(&name), "{what}: names the file: {message}");
    assert!(message.contains("; "), "{what}: has a remedy: {message}");
    for word in words {
        assert!(message.contains(word), "{what}\nlacks \"{word}\": {message}");
    }
}

#[test]
fn the_good_files_are_good() {
    for text in [PANEL, PLATE] {
        Case::from_toml(text, "good", Path::new(""), &[]).unwrap();
    }
}

#[test]
fn every_broken_file_is_refused_with_words() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("case.toml");
    for bad in BAD {
        let text = bad.good.replacen(bad.old, bad.new, 1);
        assert_ne!(text, bad.good, "nothing was broken: {}", bad.old);
        std::fs::write(&file, &text).unwrap();
        assert_refused(Case::from_file(&file, &[]), &file, bad.words, bad.new);
        // The program says the same once, and leaves nothing.
        let output = perilife(folder.path(), &["predict", "case.toml", "--out", "run"]);
        cli::assert_refused(&output, 2, &["case.toml"]);
        assert_eq!(texts(&output).1.matches("error: ").count(), 1, "{}: one message", bad.new);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{}: nothing but the case stands there", bad.new);
    }
    assert!(BAD.len() >= 40);
}

#[test]
fn broken_overrides_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("case.toml");
    std::fs::write(&file, PANEL).unwrap();
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
        let result = Case::from_file(&file, &[set.to_owned()]);
        if words[0] == "--set" {
            let message = result.unwrap_err().to_string();
            assert!(words.iter().all(|word| message.contains(word)), "{set}: {message}");
        } else {
            assert_refused(result, &file, words, set);
        }
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
    let text = PANEL.replace("name = \"al2024-t3\"", "name = \"own.toml\"");
    let error = Case::from_toml(&text, "case", folder.path(), &[]).unwrap_err();
    assert!(error.exit_code() == 4 && error.to_string().contains("own.toml"), "{error}");
    // Bytes that are not text are wrong input.
    let file = folder.path().join("binary.toml");
    std::fs::write(&file, [0x66, 0x6f, 0xff, 0xfe]).unwrap();
    assert_refused(Case::from_file(&file, &[]), &file, &["UTF-8"], "binary");
    // Nothing at all.
    std::fs::write(&file, "").unwrap();
    assert_refused(Case::from_file(&file, &[]), &file, &["specimen", "missing"], "empty");
}

/// Values a user could write, or not.
pub fn any_value() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        prop::num::f64::ANY.prop_map(|x| if x.is_nan() {
            "nan".to_owned()
        } else if x.is_infinite() {
            "-inf".to_owned()
        } else {
            format!("{x:e}")
        }),
        (-1000.0..1000.0f64).prop_map(|x| format!("{x:.3}")),
        any::<i64>().prop_map(|i| i.to_string()),
        Just("true".to_owned()),
        Just("1979-05-27".to_owned()),
        "[a-z_]{0,12}".prop_map(|text| format!("\"{text}\"")),
        Just("\"\\u00e9[].\"".to_owned()),
    ];
    leaf.prop_recursive(3, 12, 4, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(|items| format!("[{}]", items.join(", "))),
            prop::collection::vec((prop::sample::select(KEYS), inner), 0..3).prop_map(|pairs| {
                let items: Vec<String> = pairs.iter().map(|(key, value)| format!("{key} = {value}")).collect();
                format!("{{ {} }}", items.join(", "))
            }),
        ]
    })
}

/// Keys of all sections.
const KEYS: &[&str] = &[
    "kind",
    "width_mm",
    "length_mm",
    "thickness_mm",
    "crack_length_mm",
    "ends",
    "outline_mm",
    "holes",
    "cracks",
    "notches",
    "x_mm",
    "y_mm",
    "diameter_mm",
    "from_mm",
    "to_mm",
    "name",
    "plane",
    "youngs_modulus_gpa",
    "poisson_ratio",
    "stress_max_mpa",
    "force_max_n",
    "stress_ratio",
    "edges",
    "pins",
    "hole",
    "direction",
    "bottom",
    "fix",
    "rows_mm",
    "spacing_mm",
    "horizon_ratio",
    "bond_law",
    "a",
    "p",
    "horizon_mm",
    "fitted",
    "block",
    "cycles_max",
    "\"\"",
    "\"a.b\"",
];

proptest! {
    /// One key of a good file set to anything: a case or words, never a panic.
    #[test]
    fn any_value_gives_a_case_or_words(section in prop::sample::select(&["specimen", "material", "loading", "supports", "model", "fatigue", "stop"][..]),
                                       key in prop::sample::select(KEYS), value in any_value(), panel in any::<bool>()) {
        let text = if panel { PANEL } else { PLATE };
        let overrides = [format!("{section}.{}={value}", key.replace('"', ""))];
        if let Err(error) = Case::from_toml(text, "any", Path::new("/nowhere"), &overrides) {
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

    /// Any text at all.
    #[test]
    fn any_text_gives_a_case_or_words(text in "\\PC{0,200}") {
        let _ = Case::from_toml(&text, "any", Path::new(""), &[]);
    }
}
