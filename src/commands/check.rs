//! `perilife check`: is this input file right, and what would be run?

mod preview;
mod scene;
mod understood;

use std::path::PathBuf;

use serde_json::map::Entry;
use serde_json::{Map, Value, json};

use self::preview::preview;
use self::scene::{scene_drawing, scene_lines};
use self::understood::{Line, case_lines, curves_line};
use super::console::Console;
use crate::calibration::case::CalibrationCase;
use crate::case::Case;
use crate::error::Result;
use crate::fracture::Scene;
use crate::fracture::read::is_scene;
use crate::input::Document;
use crate::report::output::write_file;
use crate::report::specimen_picture::specimen_svg;

/// Arguments of `perilife check`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Case, calibration file or fracture scene
    #[arg(value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Draw specimen, crack, loads and supports into this SVG file
    #[arg(long, value_name = "OUT.svg", help_heading = "Output")]
    pub picture: Option<PathBuf>,
    /// Override a key of the file (repeatable), e.g. --set model.spacing_mm=2
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// What a file asks for, checked.
struct Checked {
    kind: &'static str,
    name: String,
    lines: Vec<Line>,
    warnings: Vec<String>,
    drawing: String,
    echo: Value,
}

/// Checks the file, prints what was understood and draws the picture.
///
/// # Errors
/// Wrong input, or files that cannot be read or written.
pub fn run(args: &Args) -> Result<()> {
    let Checked { kind, name, lines, warnings, drawing, echo } = checked(args)?;
    if let Some(path) = &args.picture {
        write_file(path, drawing.as_bytes())?;
    }
    for warning in &warnings {
        args.console.warn(warning);
    }
    for line in &lines {
        args.console.say(&format!("{:<12} {}", line.what, line.value));
    }
    args.console.say(&format!("{:<12} no errors", "check"));
    let mut understood: Map<String, Value> = Map::new();
    for line in lines {
        // A scene has several loads and supports.
        match understood.entry(line.what.replace(' ', "_")) {
            Entry::Vacant(place) => drop(place.insert(line.value.into())),
            Entry::Occupied(mut place) => {
                let both = format!("{}; {}", place.get().as_str().unwrap_or_default(), line.value);
                place.insert(both.into());
            }
        }
    }
    args.console.object(&json!({
        "ok": true, "kind": kind, "name": name, "understood": understood, "warnings": warnings, "case": echo
    }))
}

/// Reads the file as what it is: a calibration with the curves it names, a fracture scene, or a case. The body is built as well where that
/// is quick, since only then some troubles show.
fn checked(args: &Args) -> Result<Checked> {
    let document = Document::read(&args.file, &args.set)?;
    if is_scene(&document.table) {
        return checked_scene(&document);
    }
    let is_calibration = document.table.contains_key("measured") || document.table.contains_key("fit");
    let (kind, case, mut warnings, curves) = if is_calibration {
        let CalibrationCase { case, curves, warnings, .. } = CalibrationCase::from_file(&args.file, &args.set)?;
        ("calibration", case, warnings, curves)
    } else {
        let case = Case::from_document(&document)?;
        let warnings = case.warnings.clone();
        ("case", case, warnings, Vec::new())
    };
    let preview = preview(&case).map_err(|error| document.locate(error))?;
    warnings.extend(preview.warnings);
    let mut lines = case_lines(&case, preview.points);
    if !curves.is_empty() {
        lines.insert(0, curves_line(&curves));
    }
    Ok(Checked { kind, name: case.name.clone(), lines, warnings, drawing: specimen_svg(&case), echo: case.echo })
}

fn checked_scene(document: &Document) -> Result<Checked> {
    let scene = Scene::from_document(document)?;
    let lines = scene_lines(&scene).map_err(|error| document.locate(error))?;
    let drawing = scene_drawing(&scene);
    Ok(Checked { kind: "fracture", name: scene.name, lines, warnings: scene.warnings, drawing, echo: scene.echo })
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUIET: Console = Console { json: false, quiet: true };

    /// Every shipped case passes, with a picture; a picture that cannot be written leaves nothing behind.
    #[test]
    fn shipped_cases_pass() {
        let folder = tempfile::tempdir().unwrap();
        let files = ["/data/cases", "/data/cases/fracture"].into_iter().filter_map(|below| {
            Some(std::fs::read_dir(format!("{}{below}", env!("CARGO_MANIFEST_DIR"))).ok()?.map(|entry| entry.unwrap().path()))
        });
        let is_toml = |file: &PathBuf| file.extension().is_some_and(|extension| extension == "toml");
        let files: Vec<PathBuf> = files.flatten().filter(is_toml).collect();
        assert!(files.len() > 2);
        for file in files {
            let picture = folder.path().join("picture.svg");
            let args = Args { file, picture: Some(picture.clone()), set: vec![], console: QUIET };
            run(&args).unwrap();
            assert!(std::fs::read_to_string(&picture).unwrap().ends_with("</svg>\n"));
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
            let nowhere = Args { picture: Some(folder.path().join("no/such/folder.svg")), ..args };
            assert_eq!(run(&nowhere).unwrap_err().exit_code(), 4);
        }
    }

    /// The measured files of a calibration are read and checked, and the case of it is.
    #[test]
    fn shipped_calibrations_pass() {
        for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/calibration")).unwrap() {
            let file = entry.unwrap().path().join("case.toml");
            if file.is_file() {
                let args = Args { file, picture: None, set: vec![], console: QUIET };
                run(&args).unwrap();
                let set = vec!["measured.files=[\"nowhere.csv\"]".to_owned()];
                assert_eq!(run(&Args { set, ..args }).unwrap_err().exit_code(), 4);
            }
        }
    }
}
