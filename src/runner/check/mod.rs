//! Is an input file right, and what would be run? What was understood of it, in words and as a drawing, without running it.

mod understood;

use std::path::Path;

use serde::{Serialize, Serializer};
use serde_json::map::Entry;
use serde_json::{Map, Value};

pub use super::check::understood::Line;
use super::check::understood::{
    as_input, built as built_words, case_lines, curves_line, detail, is_quick, line, plate_lines, points_words, preview,
    rates_line, sweep_lines,
};
use super::{Kind, Task, scene_results};
use perilife_base::error::Result;
use perilife_base::input::{Document, Provenance};
use perilife_base::units::{MM, MPA};
use perilife_calibration::calibrate::Calibration;
use perilife_calibration::laws::case::LawCase;
use perilife_calibration::sweep::design::{self, CASES_MAX};
use perilife_calibration::sweep::{DrawnCase, Sweep};
use perilife_calibration::template::refuse_table;
use perilife_growth::case::{Case, needs};
use perilife_growth::predict::judgement::refuse_beforehand;
use perilife_plate::specimen::{Edge, Point, Specimen};
use perilife_results::chart::Size;
use perilife_results::checks::{self, Check};
use perilife_results::curve::RunTables;
use perilife_results::model_words::{self, mm, short};
use perilife_results::pictures::plate::{Plate, plate_svg};
use perilife_results::specimen_picture::sketch::{HELD, LOAD, Sketch};
use perilife_results::specimen_picture::{drawing, specimen_svg};
use perilife_results::spectrum::{SpectrumCurves, curves};
use perilife_scenes::Scene;
use perilife_scenes::assembly::preview as preview_scene;
use perilife_scenes::read::around;
use perilife_scenes::scene::{Action, DamageLaw, Procedure, Region, SceneLoad, SceneSupport};

#[derive(Debug, Default, Serialize)]
pub struct Checked {
    ok: bool,
    /// `case`, `calibration`, `fracture` or `sweep`.
    pub kind: &'static str,
    pub name: String,
    #[serde(rename = "understood", serialize_with = "understood")]
    pub lines: Vec<Line>,
    pub checks: Vec<Check>,
    pub warnings: Vec<String>,
    #[serde(skip)]
    pub drawn: Drawn,
    /// Exceedances and ranges of a pass of a spectrum, for others to draw; none of other loads.
    pub spectrum: Option<SpectrumCurves>,
    #[serde(rename = "case")]
    pub echo: Value,
    #[serde(skip)]
    pub provenance: Provenance,
}

/// What can be drawn of an input: specimen, cracks, loads and supports.
#[derive(Debug, Default)]
pub enum Drawn {
    /// Tables of rates have no plate.
    #[default]
    Nothing,
    Plate(Box<Case>),
    /// SVG.
    Scene(String),
}

impl Drawn {
    /// As SVG, with sizes.
    pub fn svg(self) -> Option<String> {
        match self {
            Drawn::Nothing => None,
            Drawn::Plate(case) => Some(specimen_svg(&case)),
            Drawn::Scene(svg) => Some(svg),
        }
    }

    /// As SVG; the plate without sizes, as that of a result is.
    pub fn beside_form(self, size: Size) -> Option<String> {
        match self {
            Drawn::Plate(case) => Some(plate_svg(&Plate::of(&case), &RunTables::default(), size)),
            other => other.svg(),
        }
    }
}

impl Checked {
    pub fn json(&self) -> Value {
        serde_json::json!(self)
    }
}

fn understood<S: Serializer>(lines: &[Line], serializer: S) -> std::result::Result<S::Ok, S::Error> {
    let mut understood: Map<String, Value> = Map::new();
    for line in lines {
        // A scene has several loads and supports.
        match understood.entry(line.what.replace(' ', "_")) {
            Entry::Vacant(place) => drop(place.insert(line.value.clone().into())),
            Entry::Occupied(mut place) => {
                let both = format!("{}; {}", place.get().as_str().unwrap_or_default(), line.value);
                place.insert(both.into());
            }
        }
    }
    understood.serialize(serializer)
}

/// What a document that was read as a task asks for. The body is built as well where that is quick, since only then some troubles
/// show.
pub fn check(document: &Document, task: &Task) -> Result<Checked> {
    match task {
        Task::Sweep { sweep, cases } => checked_sweep(sweep, cases),
        Task::Scene(scene) => checked_scene(document, scene),
        Task::Fit(Calibration::Rates(case)) => Ok(checked_laws(document, case)),
        Task::Fit(Calibration::Lives(calibration)) => {
            let mut checked = checked_case(document, "calibration", &calibration.case, &calibration.warnings)?;
            checked.lines.insert(0, curves_line(&calibration.curves));
            Ok(checked)
        }
        Task::Prediction { case, .. } => {
            refuse_beforehand(case).map_err(|error| document.locate(error))?;
            let mut checked = checked_case(document, "case", case, &case.warnings)?;
            checked.checks = checks::of_case(case);
            Ok(checked)
        }
        Task::Factors { case, .. } => checked_case(document, "case", case, &case.warnings),
    }
}

/// [`check`] of a file. Overrides are those of the command that runs it.
pub fn check_file(path: &Path, overrides: &[String]) -> Result<Checked> {
    refuse_table(path)?;
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

fn checked_case(document: &Document, kind: &'static str, case: &Case, warnings: &[String]) -> Result<Checked> {
    let budget = needs::of_case(case);
    let preview = budget.within_machine().and_then(|()| preview(case)).map_err(|error| document.locate(error))?;
    let warnings = [warnings, &preview.warnings].concat();
    let mut lines = case_lines(case, preview.points);
    lines.push(line("computing", budget.words()));
    let (drawn, provenance) = (Drawn::Plate(Box::new(case.clone())), document.folder.opened().so_far());
    let spectrum = case.loading.spectrum.as_deref().map(curves);
    let (name, echo) = (case.name.clone(), case.echo.clone());
    Ok(Checked { ok: true, kind, name, lines, warnings, drawn, spectrum, echo, provenance, ..Checked::default() })
}

/// A fit of laws has a plate only where its rates come from readings.
fn checked_laws(document: &Document, case: &LawCase) -> Checked {
    let mut lines = vec![rates_line(case)];
    let mut drawn = Drawn::Nothing;
    if let Some(test) = &case.test {
        lines.extend(case_lines(&test.case, "none: rates over handbook K".to_owned()));
        drawn = Drawn::Plate(Box::new(test.case.clone()));
    }
    let provenance = document.folder.opened().so_far();
    let (name, warnings, echo) = (case.name.clone(), case.warnings.clone(), case.echo.clone());
    Checked { ok: true, kind: "calibration", name, lines, warnings, drawn, echo, provenance, ..Checked::default() }
}

fn checked_scene(document: &Document, scene: &Scene) -> Result<Checked> {
    let (lines, of_points) = scene_lines(scene).map_err(|error| document.locate(error))?;
    let (name, echo, provenance) = (scene.name.clone(), scene.echo.clone(), scene.provenance.clone());
    let warnings = [&scene.warnings[..], &of_points].concat();
    let loads = scene.drives.iter().map(|drive| format!("blue: {}", drive_words(drive)));
    let holds = scene.holds.iter().map(|hold| format!("green: {}", hold_words(hold)));
    let mut told: Vec<String> = loads.chain(holds).collect();
    let more = told.len().saturating_sub(LINES_MAX);
    told.truncate(LINES_MAX);
    told.extend((more > 0).then(|| format!("and {more} more loads and supports")));
    let drawn = Drawn::Scene(scene_svg(scene, &procedure_words(scene), &told));
    Ok(Checked { ok: true, kind: "fracture", name, lines, warnings, drawn, echo, provenance, ..Checked::default() })
}

/// Lines about loads and supports that fit below the drawing of a scene.
const LINES_MAX: usize = 8;
/// Bonds up to which points and bonds of a scene are built, those of 1e5 points at the usual horizon; below a second.
const BONDS_BUILT: f64 = 1.5e6;

/// One line for each thing understood, and what the user should know; points and bonds are built where that is quick, since only
/// then some troubles show.
fn scene_lines(scene: &Scene) -> Result<(Vec<Line>, Vec<String>)> {
    let budget = scene.budget();
    budget.within_machine()?;
    let is_quick = budget.bonds <= BONDS_BUILT && is_quick(&budget, &scene.specimen);
    let built = is_quick.then(|| preview_scene(scene).map_err(as_input)).transpose()?;
    let specimen = &scene.specimen;
    let chosen = scene_results::of_scene(scene, None);
    let micro = scene.echo.get("micro_cracks").and_then(|section| section.get("count")).and_then(serde_json::Value::as_u64);
    let cracks = specimen.cracks.len() - micro.unwrap_or(0) as usize;
    let micro_words = micro.map_or_else(String::new, |count| format!(", {count} micro cracks"));
    let asked = scene.model.spacing;
    let (counts, [fine, coarse], horizon) = match &built {
        Some(laid) => (built_words([laid.points, laid.bonds, laid.cut]), laid.spacings, laid.horizons[0]),
        None => (format!("about {:.0}", budget.points), [asked; 2], asked * scene.model.horizon_ratio),
    };
    // Scenes ask for the spacing of the coarsest level.
    let points = points_words(&counts, [fine, coarse], [asked * fine / coarse, horizon], &chosen);
    let mut lines = plate_lines(specimen, &scene.material, ("flaws", cracks, micro_words));
    lines.extend([
        detail("law", model_words::words(&chosen, &model_words::OF_BONDS)),
        detail("points", points),
        line("procedure", procedure_words(scene)),
    ]);
    lines.extend(scene.drives.iter().map(|drive| line("load", drive_words(drive))));
    lines.extend(scene.holds.iter().map(|hold| line("support", hold_words(hold))));
    lines.extend(scene.refinement.as_ref().map(|refinement| line("refinement", refinement.words())));
    lines.extend([line("damage", damage_words(scene)), line("computing", budget.words())]);
    Ok((lines, built.map_or_else(Vec::new, |built| built.warnings)))
}

fn procedure_words(scene: &Scene) -> String {
    let solver = scene.model.solver;
    match scene.procedure {
        Procedure::Static => format!("one equilibrium at full load, solver {solver}"),
        Procedure::QuasiStatic { steps, iterations: None } => format!("{steps} load steps, solver {solver}"),
        Procedure::QuasiStatic { steps, iterations: Some(each) } => {
            format!("{steps} load steps of {each} iterations, not to rest, solver {solver}")
        }
        Procedure::Dynamic { duration, time_step } => {
            let step = time_step.map_or_else(|| "its own time step".to_owned(), |step| format!("time step {step:e} s"));
            format!("motion over {duration:e} s, {step}, solver {solver}")
        }
    }
}

fn drive_words(drive: &SceneLoad) -> String {
    let pair = |[x, y]: [f64; 2], unit: f64| format!("({}, {})", short(x / unit), short(y / unit));
    let components = |components: [Option<f64>; 2]| {
        let one = |value: Option<f64>| value.map_or_else(|| "free".to_owned(), mm);
        format!("({}, {})", one(components[0]), one(components[1]))
    };
    let what = match drive.action {
        Action::Traction(traction) => format!("traction {} MPa", pair(traction, MPA)),
        Action::Displacement(values) => format!("displacement {} mm", components(values)),
        Action::Velocity(values) => format!("velocity {} mm/s", components(values)),
        Action::Platen(motion) => format!("platen moving {} mm", pair(motion, MM)),
    };
    let ramp = if drive.rise.ramp > 0.0 { format!(", rising over {:e} s", drive.rise.ramp) } else { String::new() };
    let from = if drive.rise.from > 0.0 { format!(" from {:e} s on", drive.rise.from) } else { String::new() };
    format!("{what} on {}{ramp}{from}", drive.region)
}

fn hold_words(hold: &SceneSupport) -> String {
    let held = match hold.components {
        [true, true] => "x and y",
        [true, false] => "x",
        _ => "y",
    };
    format!("{held} held on {}", hold.region)
}

fn damage_words(scene: &Scene) -> String {
    let damage = &scene.damage;
    let limit = match (damage.law, damage.stretch, scene.material.fracture_energy) {
        (DamageLaw::CriticalStretch | DamageLaw::CriticalEnergy, Some(stretch), _) => format!(", critical stretch {stretch}"),
        (DamageLaw::CriticalStretch | DamageLaw::CriticalEnergy, None, Some(energy)) => {
            format!(", fracture energy {energy} J/m²")
        }
        (DamageLaw::PrincipalStress, ..) => {
            format!(", tensile strength {} MPa", short(damage.tensile_strength.unwrap_or(f64::NAN) / MPA))
        }
        (DamageLaw::NonlinearTwoParameter, ..) => damage.nonlinear.map_or_else(String::new, |law| {
            let printed = if law.printed { ", as printed" } else { "" };
            format!(", stretches {:.6}, {:.6}, {:.6}{printed}", law.elastic, law.peak, law.last)
        }),
        _ => String::new(),
    };
    format!("{}{limit}", damage.law)
}

const ARROW: f64 = 38.0;
/// Fill of driven and of held points.
const DRIVEN_FILL: &str = "#b9cfe8";
const HELD_FILL: &str = "#c9d19a";

/// SVG text of the plate of a scene; `procedure` says in words how it is worked through, `lines` what loads and holds it.
///
/// Red: cracks. Blue: loads, with the points that are driven in a tinted box. Green: points that are held.
pub fn scene_svg(scene: &Scene, procedure: &str, lines: &[String]) -> String {
    drawing(&scene.name, procedure, &scene.specimen, lines, |sketch| {
        for hold in &scene.holds {
            region(sketch, &hold.region, scene, HELD_FILL, HELD);
        }
        for drive in &scene.drives {
            let motion = match drive.action {
                // Drawn with the loads of the plate.
                Action::Traction(_) => continue,
                Action::Displacement(values) | Action::Velocity(values) => values.map(|value| value.unwrap_or(0.0)),
                Action::Platen(motion) => motion,
            };
            let middle = region(sketch, &drive.region, scene, DRIVEN_FILL, LOAD);
            arrow(sketch, middle, &drive.region, motion, &scene.specimen);
        }
    })
}

/// A box around a region; returns its middle.
fn region(sketch: &mut Sketch, region: &Region, scene: &Scene, fill: &str, stroke: &str) -> Point {
    let (low, high) = around(region, scene.model.spacing, &scene.specimen);
    sketch.polygon(&[low, [high[0], low[1]], high, [low[0], high[1]]], fill, stroke);
    [0, 1].map(|i| 0.5 * (low[i] + high[i]))
}

/// The arrow of a motion: out of the plate where it pulls, up to the plate where it presses on a side.
fn arrow(sketch: &mut Sketch, middle: Point, region: &Region, motion: Point, specimen: &Specimen) {
    let size = motion[0].hypot(motion[1]);
    if size == 0.0 {
        return;
    }
    let way = [ARROW * motion[0] / size, -ARROW * motion[1] / size];
    let mut start = sketch.place(middle);
    if let Region::Edge { edge, .. } = region {
        let normal = edge.normal();
        let [low, high] = perilife_plate::specimen::geometry::bounding_box(&specimen.outline);
        let mut foot = middle;
        match edge {
            Edge::Top | Edge::Bottom => foot[1] = if *edge == Edge::Top { high[1] } else { low[1] },
            Edge::Left | Edge::Right => foot[0] = if *edge == Edge::Right { high[0] } else { low[0] },
        }
        let presses = motion[0] * normal[0] + motion[1] * normal[1] < 0.0;
        let out = if presses { ARROW + 8.0 } else { 8.0 };
        let foot = sketch.place(foot);
        start = [foot[0] + out * normal[0], foot[1] - out * normal[1]];
    }
    sketch.arrow(start, [start[0] + way[0], start[1] + way[1]], LOAD, 2.4);
}
