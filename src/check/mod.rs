//! Is an input file right, and what would be run? What was understood of it, in words and as a drawing, without running it.

mod preview;
mod scene;
mod understood;

use std::path::Path;

use serde_json::map::Entry;
use serde_json::{Map, Value, json};

use self::preview::preview;
use self::scene::{scene_drawing, scene_lines};
use self::understood::{case_lines, curves_line, line, rates_line, sweep_lines};
use crate::calibration::case::CalibrationCase;
use crate::calibration::laws::case::{LawCase, is_law_fit};
use crate::case::Case;
use crate::case::budget::Budget;
use crate::error::Result;
use crate::fracture::Scene;
use crate::fracture::read::is_scene;
use crate::input::{Document, Provenance};
use crate::report::specimen_picture::specimen_svg;
use crate::sweep::Sweep;
use crate::sweep::design::{self, CASES_MAX, is_sweep};

pub use self::understood::Line;

/// What a file asks for, checked.
#[derive(Debug)]
pub struct Checked {
    /// `case`, `calibration`, `fracture` or `sweep`.
    pub kind: &'static str,
    /// Its name.
    pub name: String,
    /// What was understood.
    pub lines: Vec<Line>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Specimen, cracks, loads and supports as SVG.
    pub drawing: String,
    /// The input as it was given.
    pub echo: Value,
    /// Files that were read for it.
    pub provenance: Provenance,
}

impl Checked {
    /// As one object.
    pub fn json(&self) -> Value {
        let mut understood: Map<String, Value> = Map::new();
        for line in &self.lines {
            // A scene has several loads and supports.
            match understood.entry(line.what.replace(' ', "_")) {
                Entry::Vacant(place) => drop(place.insert(line.value.clone().into())),
                Entry::Occupied(mut place) => {
                    let both = format!("{}; {}", place.get().as_str().unwrap_or_default(), line.value);
                    place.insert(both.into());
                }
            }
        }
        json!({
            "ok": true, "kind": self.kind, "name": self.name, "understood": understood, "warnings": self.warnings,
            "case": self.echo,
        })
    }
}

/// Reads the file as what it is: a calibration with the curves it names, a fracture scene, a sweep with all its cases, or a case. The body
/// is built as well where that is quick, since only then some troubles show.
///
/// # Errors
/// Wrong input, or files it names that cannot be read.
pub fn check(document: Document) -> Result<Checked> {
    if is_sweep(&document.table) {
        return checked_sweep(document, &[]);
    }
    if is_scene(&document.table) {
        return checked_scene(&document);
    }
    if is_law_fit(&document.table) {
        return checked_laws(&document);
    }
    if is_calibration(&document.table) {
        let calibration = CalibrationCase::from_document(document.clone())?;
        let mut checked = checked_case(&document, "calibration", &calibration.case, calibration.warnings)?;
        checked.lines.insert(0, curves_line(&calibration.curves));
        return Ok(checked);
    }
    let case = Case::from_document(&document)?;
    checked_case(&document, "case", &case, case.warnings.clone())
}

/// [`check`] of a file. Overrides are those of the command that runs it.
pub fn check_file(path: &Path, overrides: &[String]) -> Result<Checked> {
    // Read once: a pipe is empty the second time.
    let mut document = Document::read(path, &[])?;
    if is_sweep(&document.table) {
        return checked_sweep(document, overrides);
    }
    document.set_all(overrides)?;
    check(document)
}

fn checked_sweep(document: Document, overrides: &[String]) -> Result<Checked> {
    let sweep = Sweep::with_overrides(document, overrides, CASES_MAX)?;
    let cases = sweep.cases()?;
    let lines = sweep_lines(&sweep, &cases);
    // A sweep has one case at least; what they have in common shows in any of them.
    let first = cases[0].read()?;
    let mut checked = checked_case(&sweep.base, "sweep", &first, first.warnings.clone())?;
    checked.name.clone_from(&sweep.name);
    checked.echo = design::echo(&sweep.document.table);
    checked.provenance = sweep.document.folder.opened().so_far();
    checked.lines.splice(0..0, lines);
    Ok(checked)
}

/// Whether these are the sections of a calibration.
pub fn is_calibration(table: &toml::Table) -> bool {
    table.contains_key("measured") || table.contains_key("fit")
}

/// The case of a document, with its warnings so far.
///
/// # Errors
/// A body that cannot be built.
pub fn checked_case(document: &Document, kind: &'static str, case: &Case, mut warnings: Vec<String>) -> Result<Checked> {
    let budget = Budget::of(case);
    let preview = budget.within_machine().and_then(|()| preview(case)).map_err(|error| document.locate(error))?;
    warnings.extend(preview.warnings);
    let mut lines = case_lines(case, preview.points);
    lines.push(line("computing", budget.words()));
    let (drawing, provenance) = (specimen_svg(case), document.folder.opened().so_far());
    Ok(Checked { kind, name: case.name.clone(), lines, warnings, drawing, echo: case.echo.clone(), provenance })
}

/// A fit of laws has a plate only where its rates come from readings.
fn checked_laws(document: &Document) -> Result<Checked> {
    let case = LawCase::from_document(document)?;
    let mut lines = vec![rates_line(&case)];
    let mut drawing = String::new();
    if let Some(test) = &case.test {
        lines.extend(case_lines(&test.case, "none: rates over handbook K".to_owned()));
        drawing = specimen_svg(&test.case);
    }
    let provenance = document.folder.opened().so_far();
    Ok(Checked { kind: "calibration", name: case.name, lines, warnings: case.warnings, drawing, echo: case.echo, provenance })
}

fn checked_scene(document: &Document) -> Result<Checked> {
    let scene = Scene::from_document(document)?;
    let (lines, of_points) = scene_lines(&scene).map_err(|error| document.locate(error))?;
    let drawing = scene_drawing(&scene);
    let warnings = scene.warnings.into_iter().chain(of_points).collect();
    let (name, echo, provenance) = (scene.name, scene.echo, scene.provenance);
    Ok(Checked { kind: "fracture", name, lines, warnings, drawing, echo, provenance })
}
