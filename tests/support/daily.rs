//! Small inputs of every command that writes a folder, and what a folder holds.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::interface::cli::SMALL_CASE;

/// A hand calculation of a millisecond.
pub const PANEL: &str = r#"
[specimen]
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
method = "handbook"
[fatigue]
paris_c_mm_per_cycle = 8.95422e-8
paris_m = 2.874
allow_extrapolation = true
[stop]
crack_length_mm = 49.8
"#;

/// Its plate, load and method, without law and end.
pub fn panel_without_law() -> &'static str {
    PANEL.split_once("[fatigue]").unwrap().0
}

/// A plate that is pulled once.
pub const SCENE: &str = r#"
[specimen]
kind = "plate"
width_mm = 20.0
length_mm = 20.0
thickness_mm = 1.0
cracks = [{ from_mm = [-3.0, 0.0], to_mm = [3.0, 0.0] }]
[material]
youngs_modulus_gpa = 192.0
poisson_ratio = 0.3
[model]
spacing_mm = 1.0
[loading]
kind = "traction"
stress_mpa = 10.0
edges = ["top", "bottom"]
"#;

/// A curve of the panel above.
pub const READINGS: &str = "specimen,cycles,crack_length_mm\nA,0,9\nA,20000,9.6\nA,40000,10.3\nA,60000,11.2\nA,80000,12.3\nA,100000,13.6\n\
                            A,120000,15.3\nA,140000,17.6\n";

pub const SWEEP: &str =
    "case = \"panel.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"specimen.crack_length_mm\"\nvalues = [9.0, 10.0]\n";

/// Every kind of folder: the call that makes it, without `--out`, and a table of it.
pub const KINDS: [(&[&str], &str); 5] = [
    (&["predict", "panel.toml"], "a_n.csv"),
    (&["fracture", "scene.toml"], "history.csv"),
    (&["calibrate", "fit.toml", "--predict", "panel.toml"], "fitted.toml"),
    (&["sweep", "sweep.toml"], "sweep.csv"),
    (&["verify", "golden"], "verify.csv"),
];

/// Writes the inputs of all kinds.
pub fn write_inputs(folder: &Path) {
    let files = [
        ("panel.toml", PANEL.to_owned()),
        ("small.toml", SMALL_CASE.to_owned()),
        ("scene.toml", SCENE.to_owned()),
        ("readings.csv", READINGS.to_owned()),
        ("fit.toml", format!("[measured]\nfiles = [\"readings.csv\"]\n{}", panel_without_law())),
        ("sweep.toml", SWEEP.to_owned()),
    ];
    files.iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
}

/// Every file below a folder with its content, links as what they point to in words.
pub fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(&next).unwrap().map(Result::unwrap) {
            let (path, name) = (entry.path(), entry.path().strip_prefix(folder).unwrap().display().to_string());
            let kind = entry.file_type().unwrap();
            if kind.is_dir() {
                all.insert(name + "/", Vec::new());
                open.push(path);
            } else if kind.is_symlink() {
                all.insert(name, fs::read_link(&path).unwrap().display().to_string().into_bytes());
            } else {
                all.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    all
}

/// Names in a folder, hidden ones too, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
