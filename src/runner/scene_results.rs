//! Results of a fracture scene: `history.csv`, `crack_path.csv`, `cracking.csv`, `result.json`, charts and the damaged plate.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use perilife_base::columns::Table;
use perilife_base::error::Result;
use perilife_base::raster::Snapshot;
use perilife_base::units::{KN, MM};
use perilife_plate::specimen::Point;
use perilife_results::chart::{self, Mark, Series};
use perilife_results::model_words::{self, ANGLE, Choice, RATIO, SPACING, TWO_SPRINGS, clean, given};
use perilife_results::output::{Room, write_file, write_json};
use perilife_results::provenance::{self, MadeBy};
use perilife_results::record::RESULT_FILE;
use perilife_results::snapshots;
use perilife_results::snapshots::DamagePicture;
use perilife_scenes::outcome::{HistoryRow, PathPoint};
use perilife_scenes::scene::{Action, Procedure, SceneLaw, SceneLoad};
use perilife_scenes::{Fracture, Scene, SceneEnd};

/// Rows of the history that are numbers: the last ones of a motion that blew up may not be.
fn rows(fracture: &Fracture) -> impl Iterator<Item = &HistoryRow> {
    let finite = |row: &&HistoryRow| {
        [row.time, row.displacement, row.load, row.kinetic, row.strain, row.fracture, row.work].iter().all(|x| x.is_finite())
    };
    fracture.history.iter().filter(finite)
}

fn history(fracture: &Fracture) -> Table {
    let column = |of: fn(&HistoryRow) -> f64| rows(fracture).map(of);
    Table::new("history.csv")
        .counts("step", rows(fracture).map(|row| row.step))
        .exact("time_s", column(|row| row.time))
        .numbers("displacement_mm", column(|row| row.displacement / MM))
        .numbers("load_n", column(|row| row.load))
        .counts("broken_bonds", rows(fracture).map(|row| row.broken_bonds))
        .numbers("kinetic_j", column(|row| row.kinetic))
        .numbers("strain_j", column(|row| row.strain))
        .numbers("fracture_j", column(|row| row.fracture))
        .numbers("work_j", column(|row| row.work))
}

/// `crack_path.csv` of [`Fracture::path`] and `cracking.csv` of [`Fracture::cracking`]: where every crack front stood and how
/// fast it came there, in the order of time.
fn crack_path(file: &'static str, path: &[PathPoint]) -> Table {
    let column = |of: fn(&PathPoint) -> f64| path.iter().map(of);
    Table::new(file)
        .counts("tip", path.iter().map(|point| point.tip))
        .counts("step", path.iter().map(|point| point.step))
        .exact("time_s", column(|point| point.time))
        .numbers("x_mm", column(|point| point.position[0] / MM))
        .numbers("y_mm", column(|point| point.position[1] / MM))
        .numbers("damage", column(|point| point.damage))
        .numbers("speed_m_s", column(|point| point.speed))
}

pub fn tables(fracture: &Fracture) -> [(Table, String); 3] {
    [history(fracture), crack_path("crack_path.csv", &fracture.path), crack_path("cracking.csv", &fracture.cracking)]
        .map(Table::with_text)
}

pub fn room(scene: &Scene) -> Room {
    Room { tables: 64_000, all: scene.budget().disk_bytes as u64 }
}

pub fn write(folder: &Path, scene: &Scene, (fracture, tables): (&Fracture, &[(Table, String)]), result: &Value) -> Result<()> {
    // Tables and figures first: what a full disk cuts off are pictures.
    tables.iter().try_for_each(|(table, text)| write_file(&folder.join(&table.file), text.as_bytes()))?;
    write_json(folder, RESULT_FILE, result)?;
    provenance::write(folder, "fracture", provenance::table_of(&scene.echo), &scene.provenance)?;
    // The last state of a motion that blew up is no number.
    let finite = |snapshot: &&Snapshot| snapshot.displacement.iter().flatten().all(|u| u.is_finite());
    let snapshots: Vec<Snapshot> = fracture.snapshots.iter().filter(finite).cloned().collect();
    if !scene.output.tables_only {
        draw_charts(folder, scene, fracture)?;
        draw_plate(folder, scene, fracture, &snapshots)?;
    }
    snapshots::write_wanted(folder, scene.output, &fracture.grid, &snapshots)
}

/// Load and broken bonds over displacement; in time also load, broken bonds and energies over time.
fn draw_charts(folder: &Path, scene: &Scene, fracture: &Fracture) -> Result<()> {
    const MOVED: &str = "Displacement of the loads, mm";
    const TIME: &str = "Time, µs";
    let line = |name: &str, x: fn(&HistoryRow) -> f64, y: fn(&HistoryRow) -> f64| Series {
        name: name.to_owned(),
        mark: Mark::Line,
        points: rows(fracture).map(|row| (x(row), y(row))).collect(),
    };
    let moved = |row: &HistoryRow| row.displacement / MM;
    let time = |row: &HistoryRow| row.time * 1e6;
    let load = |row: &HistoryRow| row.load / KN;
    let broken = |row: &HistoryRow| row.broken_bonds as f64;
    let chart = |file: &str, what: &str, names: [&str; 2], series: &[Series]| {
        chart::linear(&folder.join(file), &format!("{}: {what}", scene.name), names, series)
    };
    chart("load_displacement.svg", "load over displacement", [MOVED, "Load, kN"], &[line("load", moved, load)])?;
    if !matches!(scene.procedure, Procedure::Dynamic { .. }) {
        let names = [MOVED, "Broken bonds"];
        return chart("broken_bonds.svg", "broken bonds over displacement", names, &[line("broken bonds", moved, broken)]);
    }
    chart("broken_bonds.svg", "broken bonds over time", [TIME, "Broken bonds"], &[line("broken bonds", time, broken)])?;
    chart("load_time.svg", "load over time", [TIME, "Load, kN"], &[line("load", time, load)])?;
    let energies = [
        line("kinetic", time, |row| row.kinetic),
        line("strain", time, |row| row.strain),
        line("fracture", time, |row| row.fracture),
        Series { mark: Mark::Dashes, ..line("external work", time, |row| row.work) },
    ];
    chart("energies.svg", "energies over time", [TIME, "Energy, J"], &energies)
}

/// `damage_first.svg` and `damage.svg`: the plate at the start and at the end.
fn draw_plate(folder: &Path, scene: &Scene, fracture: &Fracture, snapshots: &[Snapshot]) -> Result<()> {
    let paths = paths(fracture);
    let none = Vec::new();
    let first = snapshots.first().map(|snapshot| ("damage_first.svg", snapshot, &none));
    let last = snapshots.last().map(|snapshot| ("damage.svg", snapshot, &paths));
    for (file, snapshot, paths) in first.into_iter().chain(last) {
        let caption = caption(scene, fracture, snapshot);
        let picture = DamagePicture { grid: &fracture.grid, snapshot, cracks: &scene.specimen.cracks, paths, caption: &caption };
        picture.write(&folder.join(file))?;
    }
    Ok(())
}

fn caption(scene: &Scene, fracture: &Fracture, snapshot: &Snapshot) -> Vec<String> {
    match scene.procedure {
        Procedure::Static => vec!["static".to_owned()],
        Procedure::QuasiStatic { steps, iterations: Some(_) } => vec![format!("load step {:.0} of {steps}", snapshot.cycles)],
        // States of equilibrium stand closer than the steps of the load where bonds are damaged: they are no share of these.
        Procedure::QuasiStatic { .. } => {
            let state = snapshot.cycles as usize;
            let row = fracture.history.iter().find(|row| row.step == state);
            let moved = row.map(|row| format!("displacement {:.4e} mm", row.displacement / MM));
            let last = fracture.history.last().map_or(state, |row| row.step);
            std::iter::once(format!("state {state} of {last}")).chain(moved).collect()
        }
        Procedure::Dynamic { .. } => vec![format!("time {:.3} µs", snapshot.cycles * 1e6)],
    }
}

fn paths(fracture: &Fracture) -> Vec<Vec<Point>> {
    let count = fracture.path.iter().map(|point| point.tip + 1).max().unwrap_or(0);
    let mut paths = vec![Vec::new(); count];
    fracture.path.iter().for_each(|point| paths[point.tip].push(point.position));
    paths
}

pub fn words(scene: &Scene, fracture: &Fracture) -> Vec<String> {
    let last = fracture.history.last().copied().unwrap_or_default();
    let figures = &fracture.figures;
    let when = |step: Option<usize>| match step {
        None => "never".to_owned(),
        Some(step) if figures.time_step > 0.0 => format!("step {step}, {:.3} µs", step as f64 * figures.time_step * 1e6),
        Some(step) => format!("step {step}"),
    };
    let way = match scene.procedure {
        Procedure::Static => "one static solve".to_owned(),
        Procedure::QuasiStatic { iterations: Some(_), .. } => format!("{} load steps", last.step),
        Procedure::QuasiStatic { steps, .. } => format!("{steps} load steps, {} states of equilibrium", last.step),
        Procedure::Dynamic { .. } => format!("{} time steps of {:.4} µs", last.step, figures.time_step * 1e6),
    };
    let mut lines = vec![
        format!("{}: peak load {:.4} kN", scene.name, fracture.peak_load() / KN),
        format!("  stopped        {}: {}", fracture.end, fracture.end.meaning()),
        format!("  displacement   {:.6} mm at the end, load {:.4} kN", last.displacement / MM, last.load / KN),
        format!("  First damage   {}", when(fracture.onset_step)),
        format!("  separated      {}", when(fracture.separated_step)),
        format!("  broken         {} of {} bonds", last.broken_bonds, figures.bonds),
    ];
    lines.extend(
        figures.touching.filter(|flanks| flanks.pressed > 0).map(|flanks| {
            format!("  Contact        crack faces closed over {:.0} % of the crack length", 100.0 * flanks.share())
        }),
    );
    lines.push(format!("  computed       {} points, {way}, {:.1} s", figures.points, figures.wall_s));
    lines
}

/// `result.json` of a scene; a figure that does not exist is `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneRecord {
    pub name: String,
    pub stop_reason: SceneEnd,
    pub stop_meaning: String,
    pub converged: bool,
    pub peak_load_n: Option<f64>,
    pub peak_step: Option<usize>,
    pub peak_displacement_mm: Option<f64>,
    pub onset_step: Option<usize>,
    pub onset_time_s: Option<f64>,
    pub separated_step: Option<usize>,
    pub separated_time_s: Option<f64>,
    pub broken_bonds: Option<usize>,
    pub energy_balance_error: Option<f64>,
    pub flanks_pressed_share: Option<f64>,
    pub fronts: Vec<FrontEnd>,
    pub points: usize,
    pub bonds: usize,
    pub steps: Option<usize>,
    pub evaluations: usize,
    pub time_step_s: Option<f64>,
    pub wall_s: f64,
    pub memory_mb: f64,
    pub loading: LoadingRecord,
    pub model: Map<String, Value>,
    pub damage: DamageRecord,
    pub warnings: Vec<String>,
    pub version: String,
    pub case: Value,
    #[serde(flatten)]
    pub made_by: MadeBy,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrontEnd {
    pub tip: usize,
    pub step: usize,
    pub time_s: f64,
    pub x_mm: f64,
    pub y_mm: f64,
    pub damage: f64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadingRecord {
    pub procedure: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub iterations_per_step: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    pub kinds: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DamageRecord {
    pub law: String,
    pub enters: Option<String>,
    pub critical_stretch: Option<f64>,
    pub calibration: Option<String>,
    pub trapping: Option<f64>,
    pub elastic_stretch: Option<f64>,
    pub peak_stretch: Option<f64>,
    pub final_stretch: Option<f64>,
    pub printed_law: Option<bool>,
}

pub fn record(scene: &Scene, fracture: &Fracture, tables: &[(Table, String)]) -> SceneRecord {
    let figures = &fracture.figures;
    let peak = rows(fracture).max_by(|a, b| a.load.total_cmp(&b.load));
    let last = rows(fracture).last();
    SceneRecord {
        name: scene.name.clone(),
        stop_reason: fracture.end,
        stop_meaning: fracture.end.meaning().to_owned(),
        converged: !matches!(fracture.end, SceneEnd::NoConvergence | SceneEnd::Unstable),
        peak_load_n: peak.map(|row| clean(row.load.max(0.0))),
        peak_step: peak.map(|row| row.step),
        peak_displacement_mm: peak.map(|row| clean(row.displacement / MM)),
        onset_step: fracture.onset_step,
        onset_time_s: fracture.onset_step.and_then(|step| time_of(step, fracture)),
        separated_step: fracture.separated_step,
        separated_time_s: fracture.separated_step.and_then(|step| time_of(step, fracture)),
        broken_bonds: last.map(|row| row.broken_bonds),
        energy_balance_error: energy_error(fracture),
        flanks_pressed_share: figures.touching.map(|flanks| clean(flanks.share())),
        fronts: fronts(fracture),
        points: figures.points,
        bonds: figures.bonds,
        steps: last.map(|row| row.step),
        evaluations: figures.evaluations,
        time_step_s: (figures.time_step > 0.0).then_some(figures.time_step),
        wall_s: figures.wall_s,
        memory_mb: figures.memory_mb,
        loading: loading(scene),
        model: model_words::object(&of_scene(scene, Some(fracture.grid.spacing))),
        damage: damage(scene),
        warnings: scene.warnings.iter().chain(&fracture.warnings).cloned().collect(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        case: scene.echo.clone(),
        made_by: MadeBy::of(&scene.provenance, tables.iter().map(|(table, text)| (&*table.file, &**text))),
    }
}

fn time_of(step: usize, fracture: &Fracture) -> Option<f64> {
    (fracture.figures.time_step > 0.0).then(|| clean(step as f64 * fracture.figures.time_step))
}

/// Largest of |kinetic + strain + fracture - work| over the largest energy of the history.
fn energy_error(fracture: &Fracture) -> Option<f64> {
    let largest = rows(fracture).map(|row| row.kinetic.max(row.strain).max(row.work.abs())).fold(0.0, f64::max);
    let left = rows(fracture).map(|row| (row.kinetic + row.strain + row.fracture - row.work).abs()).fold(0.0, f64::max);
    (largest > 0.0).then(|| left / largest).filter(|error| error.is_finite())
}

fn fronts(fracture: &Fracture) -> Vec<FrontEnd> {
    let count = fracture.path.iter().map(|point| point.tip + 1).max().unwrap_or(0);
    let last = |tip: usize| fracture.path.iter().rev().find(|point| point.tip == tip);
    let of = |point: &PathPoint| FrontEnd {
        tip: point.tip,
        step: point.step,
        time_s: point.time,
        x_mm: clean(point.position[0] / MM),
        y_mm: clean(point.position[1] / MM),
        damage: clean(point.damage),
    };
    (0..count).filter_map(last).map(of).collect()
}

fn loading(scene: &Scene) -> LoadingRecord {
    let kind = |load: &SceneLoad| match load.action {
        Action::Traction(_) => "traction",
        Action::Displacement(_) => "displacement",
        Action::Velocity(_) => "velocity",
        Action::Platen(_) => "platens",
    };
    let kinds = scene.drives.iter().map(|load| kind(load).to_owned()).collect();
    let of = |procedure: &str| LoadingRecord { procedure: procedure.to_owned(), kinds, ..LoadingRecord::default() };
    match scene.procedure {
        Procedure::Static => of("static"),
        Procedure::QuasiStatic { steps, iterations } => {
            LoadingRecord { steps: Some(steps), iterations_per_step: iterations, ..of("quasi_static") }
        }
        Procedure::Dynamic { duration, .. } => LoadingRecord { duration_s: Some(duration), ..of("dynamic") },
    }
}

fn damage(scene: &Scene) -> DamageRecord {
    let damage = &scene.damage;
    let by_points = matches!(scene.model.law, SceneLaw::Correspondence { .. });
    DamageRecord {
        law: damage.law.name().to_owned(),
        enters: by_points.then(|| damage.enters.name().to_owned()),
        critical_stretch: damage.stretch,
        calibration: scene.takes_fracture_energy().then(|| damage.calibration.name().to_owned()),
        trapping: scene.takes_fracture_energy().then(|| scene.trapping()),
        elastic_stretch: damage.nonlinear.map(|law| law.elastic),
        peak_stretch: damage.nonlinear.map(|law| law.peak),
        final_stretch: damage.nonlinear.map(|law| law.last),
        printed_law: damage.nonlinear.map(|law| law.printed),
    }
}

/// The model of a scene; `finest` is the least spacing of its points, m, once they are laid.
pub fn of_scene(scene: &Scene, finest: Option<f64>) -> Vec<Choice> {
    let model = &scene.model;
    let chosen = |key, value: Value, default: &str| {
        let why = if given(&scene.echo, key) { "set in the file" } else { default };
        Choice { key, value, why: Some(why.to_owned()) }
    };
    let mut choices = match model.law {
        SceneLaw::Bonds(law) => vec![
            chosen("bond_law", law.kind.name().into(), TWO_SPRINGS),
            chosen("kernel", law.kernel.name().into(), "default: as published"),
            chosen("rotation", law.rotation.name().into(), "default: no energy of rigid rotation"),
            chosen("surface_correction", law.surface_correction.name().into(), "default: as published"),
            chosen("kinematics", if model.finite { "finite" } else { "small" }.into(), "default: small strains"),
        ],
        SceneLaw::Correspondence { control, factor } => vec![
            chosen("bond_law", "correspondence".into(), TWO_SPRINGS),
            chosen("zero_energy_control", control.name().into(), "default: does not affect uniform strain"),
            chosen("zero_energy_factor", factor.into(), "default: bending, shear and a pressed disc together"),
        ],
    };
    choices.push(chosen("discretisation", model.arrangement.name().into(), "default: one spacing"));
    choices.push(chosen("spacing_mm", clean(model.spacing / MM).into(), SPACING));
    choices.extend(finest.map(|finest| Choice { key: "finest_spacing_mm", value: clean(finest / MM).into(), why: None }));
    choices.push(chosen("horizon_ratio", model.horizon_ratio.into(), RATIO));
    choices.push(chosen("lattice_angle_deg", clean(model.lattice_angle.to_degrees()).into(), ANGLE));
    choices.push(chosen("solver", model.solver.name().into(), "default: that of the procedure"));
    choices
}
