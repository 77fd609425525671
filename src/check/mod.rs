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
use crate::calibration::laws::case::LawCase;
use crate::case::Case;
use crate::case::budget::Budget;
use crate::error::Result;
use crate::fracture::Scene;
use crate::input::{Document, Provenance};
use crate::report::specimen_picture::specimen_svg;
use crate::runner::{Kind, Task};
use crate::sweep::design::{self, CASES_MAX};
use crate::sweep::{DrawnCase, Sweep};

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

/// What a document that was read as a task asks for. The body is built as well where that is quick, since only then some troubles
/// show.
pub fn check(document: &Document, task: &Task) -> Result<Checked> {
    match task {
        Task::Sweep { sweep, cases } => checked_sweep(sweep, cases),
        Task::Scene(scene) => checked_scene(document, scene),
        Task::LawFit(case) => Ok(checked_laws(document, case)),
        Task::Fit(calibration) => {
            let mut checked = checked_case(document, "calibration", &calibration.case, &calibration.warnings)?;
            checked.lines.insert(0, curves_line(&calibration.curves));
            Ok(checked)
        }
        Task::Prediction { case, .. } | Task::Factors { case, .. } => checked_case(document, "case", case, &case.warnings),
    }
}

/// [`check`] of a file. Overrides are those of the command that runs it.
pub fn check_file(path: &Path, overrides: &[String]) -> Result<Checked> {
    // Read once: a pipe is empty the second time.
    let mut document = Document::read(path, &[])?;
    let kind = Kind::of(&document.table);
    if kind == Kind::Sweep {
        return check(&document, &Task::sweep(document.clone(), overrides, CASES_MAX)?);
    }
    document.set_all(overrides)?;
    // An override may make it something else.
    check(&document, &Task::read(Kind::of(&document.table), &document, &[])?)
}

fn checked_sweep(sweep: &Sweep, cases: &[DrawnCase]) -> Result<Checked> {
    let lines = sweep_lines(sweep, cases);
    // A sweep has one case at least; what they have in common shows in any of them.
    let first = cases[0].read()?;
    let mut checked = checked_case(&sweep.base, "sweep", &first, &first.warnings)?;
    checked.name.clone_from(&sweep.name);
    checked.echo = design::echo(&sweep.document.table);
    checked.provenance = sweep.document.folder.opened().so_far();
    checked.lines.splice(0..0, lines);
    Ok(checked)
}

/// A case, with its warnings so far.
fn checked_case(document: &Document, kind: &'static str, case: &Case, warnings: &[String]) -> Result<Checked> {
    let budget = Budget::of(case);
    let preview = budget.within_machine().and_then(|()| preview(case)).map_err(|error| document.locate(error))?;
    let warnings = [warnings, &preview.warnings].concat();
    let mut lines = case_lines(case, preview.points);
    lines.push(line("computing", budget.words()));
    let (drawing, provenance) = (specimen_svg(case), document.folder.opened().so_far());
    Ok(Checked { kind, name: case.name.clone(), lines, warnings, drawing, echo: case.echo.clone(), provenance })
}

/// A fit of laws has a plate only where its rates come from readings.
fn checked_laws(document: &Document, case: &LawCase) -> Checked {
    let mut lines = vec![rates_line(case)];
    let mut drawing = String::new();
    if let Some(test) = &case.test {
        lines.extend(case_lines(&test.case, "none: rates over handbook K".to_owned()));
        drawing = specimen_svg(&test.case);
    }
    let provenance = document.folder.opened().so_far();
    let (name, warnings, echo) = (case.name.clone(), case.warnings.clone(), case.echo.clone());
    Checked { kind: "calibration", name, lines, warnings, drawing, echo, provenance }
}

fn checked_scene(document: &Document, scene: &Scene) -> Result<Checked> {
    let (lines, of_points) = scene_lines(scene).map_err(|error| document.locate(error))?;
    let (name, echo, provenance) = (scene.name.clone(), scene.echo.clone(), scene.provenance.clone());
    let warnings = [&scene.warnings[..], &of_points].concat();
    Ok(Checked { kind: "fracture", name, lines, warnings, drawing: scene_drawing(scene), echo, provenance })
}
