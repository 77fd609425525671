//! `perilife predict`: a case to its a-N curve, tables, pictures and ParaView files.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::checkpoint;
use super::console::Console;
use crate::case::{Case, LawSource, Method};
use crate::error::{Error, Result, input};
use crate::predict::plastic_zone::PlasticZone;
use crate::predict::residual_strength::{check_strength, residual_strength};
use crate::predict::{Prediction, StopReason};
use crate::report;
use crate::report::chart::{self, Mark, Series};
use crate::report::csv::{self, Row};
use crate::report::damage::{DamagePicture, cycles_and_length};
use crate::report::output::{OutputFolder, write_file};
use crate::report::{fit_use, json, vtk};
use crate::specimen::Point;
use crate::specimen::handbook::handbook;
use crate::units::MM;

/// Arguments of `perilife predict`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Case file
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Folder for the results; replaced if an earlier run made it
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: PathBuf,
    /// Override a key of the case (repeatable), e.g. --set model.spacing_mm=0.5
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// Also write the load that would end the plate at once over crack length (residual_strength.csv and .svg)
    #[arg(long, help_heading = "Output")]
    pub residual_strength: bool,
    /// Keeping the run for later.
    #[command(flatten)]
    pub keeping: checkpoint::Args,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife predict`.
///
/// # Errors
/// Wrong input, a run without a result, or files that cannot be read or written.
pub fn run(args: &Args) -> Result<()> {
    let case = Case::from_file(&args.case, &args.set)?;
    let extras = Extras { residual_strength: args.residual_strength, keeping: args.keeping.clone() };
    let done = run_case(&case, &args.out, &extras, &args.console)?;
    args.keeping.done()?;
    args.console.object(&done.result)
}

/// What a run writes on request.
#[derive(Debug, Clone, Default)]
pub struct Extras {
    /// The residual-strength curve.
    pub residual_strength: bool,
    /// The state of the run while it goes on.
    pub keeping: checkpoint::Args,
}

/// A finished and written run.
#[derive(Debug, Clone, PartialEq)]
pub struct FinishedRun {
    /// The run.
    pub prediction: Prediction,
    /// Content of `result.json`.
    pub result: Value,
}

/// Runs a case and writes its results into `out`: warnings and progress go to stderr, the summary to stdout, unless
/// `--json` asked for one object there (which the caller prints).
///
/// # Errors
/// As the engine and [`keep`] report; nothing is written then.
pub fn run_case(case: &Case, out: &Path, extras: &Extras, console: &Console) -> Result<FinishedRun> {
    // Claimed first: a folder that cannot be written should not cost a run.
    let folder = OutputFolder::create(out)?;
    for warning in &case.warnings {
        console.warn(warning);
    }
    if extras.residual_strength {
        // A plate without known strength should not cost a run; K of its curve comes later.
        check_strength(case)?;
    }
    let prediction = extras.keeping.run(case, console)?;
    if extras.residual_strength {
        let strengths = residual_strength(case, &prediction.curve)?;
        report::residual_strength::write(folder.path(), case, &strengths)?;
    }
    keep(case, prediction, folder, console)
}

/// Judges a run, writes its files and puts the folder in place.
///
/// # Errors
/// [`Error::Mechanics`] if the solver failed before the crack grew; [`Error::Input`] if more than a quarter of the life
/// lies outside the fitted ΔK range and the case does not allow that; [`Error::File`] if a file cannot be written.
pub fn keep(case: &Case, prediction: Prediction, folder: OutputFolder, console: &Console) -> Result<FinishedRun> {
    for warning in &prediction.warnings {
        console.warn(warning);
    }
    judge(case, &prediction, console)?;
    for label in fit_use::labels(case, &prediction) {
        console.warn(&label);
    }
    let result = json::result(case, &prediction);
    write_run(folder.path(), case, &prediction, &result)?;
    let lines = summary(case, &prediction, folder.name());
    folder.finish()?;
    for line in lines {
        console.say(&line);
    }
    Ok(FinishedRun { prediction, result })
}

/// Share of life outside the fitted ΔK range above which the user is warned.
const EXTRAPOLATION_WARNED: f64 = 0.05;
/// Share of life outside the fitted ΔK range above which a run is refused unless the case allows it.
const EXTRAPOLATION_REFUSED: f64 = 0.25;

/// Whether a run counts as a result.
fn judge(case: &Case, prediction: &Prediction, console: &Console) -> Result<()> {
    let start = prediction.curve.first().map_or(f64::INFINITY, |point| point.crack_length);
    // An empty curve compares as not grown.
    let grown = prediction.crack_length_final().max(0.0) > start;
    let no_curve = |why: &str, remedy: &str| {
        Err(Error::Mechanics(format!("{}: {why} before the crack grew, so there is no curve; {remedy}", case.name)))
    };
    match prediction.stop {
        StopReason::NoConvergence if grown => {
            console.warn("the equilibrium solver did not converge; the curve ends where it last did")
        }
        StopReason::NoConvergence => {
            return no_curve(
                "the equilibrium solver did not converge",
                "try model.solver = \"direct\" or another model.spacing_mm",
            );
        }
        // Under the threshold nothing ages either, which is an answer.
        StopReason::NothingAges if !grown && case.fatigue.threshold > 0.0 => {
            console.warn("no bond ages: the crack stays below fatigue.delta_k_threshold_mpa_sqrt_m and does not grow");
        }
        StopReason::LeftRefinement if !grown => {
            return no_curve("the crack tip came to the rim of the finest level", "give refinement.regions around its whole way");
        }
        StopReason::NothingAges | StopReason::LeftPlate | StopReason::EnteredHole if !grown => {
            let why = format!("no bond that can fail is strained at a crack tip (stopped: {})", prediction.stop);
            return no_curve(
                &why,
                "move crack and hole or support apart, or give a smaller model.spacing_mm; `perilife check` names the tips",
            );
        }
        _ => {}
    }
    let share = json::life_share_extrapolated(case, prediction).unwrap_or(0.0);
    let LawSource::Fitted(record) = &case.law else { return Ok(()) };
    let (low, high) = (record.delta_k_min_mpa_sqrt_m, record.delta_k_max_mpa_sqrt_m);
    let text = format!("{:.1} % of the life lies outside the fitted range of ΔK, {low:.2} to {high:.2} MPa√m", 100.0 * share);
    if share > EXTRAPOLATION_REFUSED && !case.allow_extrapolation {
        let remedy = "calibrate on curves that cover it, or set fatigue.allow_extrapolation = true";
        return Err(input("fatigue.allow_extrapolation", false, format!("{}: {text}", case.name), remedy));
    }
    if share > EXTRAPOLATION_WARNED {
        console.warn(&text);
    }
    Ok(())
}

/// Writes all files of a run into `folder`.
fn write_run(folder: &Path, case: &Case, prediction: &Prediction, result: &Value) -> Result<()> {
    write_file(&folder.join(csv::A_N_FILE), csv::a_n(prediction).as_bytes())?;
    write_file(&folder.join("crack_path.csv"), csv::crack_path(prediction, &case.specimen.cracks).as_bytes())?;
    write_file(&folder.join(json::RESULT_FILE), format!("{result:#}\n").as_bytes())?;
    draw_curves(folder, case, prediction)?;
    let paths: Vec<Vec<Point>> = csv::paths(prediction, &case.specimen.cracks)
        .into_iter()
        .map(|path| path.into_iter().map(|(_, position)| position).collect())
        .collect();
    if let Some(snapshot) = prediction.snapshots.last() {
        let (cracks, caption) = (&case.specimen.cracks, cycles_and_length(snapshot));
        DamagePicture { grid: &prediction.grid, snapshot, cracks, paths: &paths, caption: &caption }
            .write(&folder.join("damage.png"))?;
    }
    if prediction.snapshots.is_empty() {
        return Ok(());
    }
    let paraview = folder.join("paraview");
    std::fs::create_dir(&paraview).map_err(|e| Error::file(&paraview, "cannot create the folder", e))?;
    vtk::write_series(&paraview, &prediction.grid, &prediction.snapshots)
}

/// `a_n.svg`, and `da_dn.svg` where ΔK and da/dN are known.
fn draw_curves(folder: &Path, case: &Case, prediction: &Prediction) -> Result<()> {
    let rows: Vec<Row> = prediction.curve.iter().map(Row::of).collect();
    let series = |name: &str, mark, pick: fn(&Row) -> (f64, f64)| Series {
        name: name.to_owned(),
        mark,
        points: rows.iter().map(pick).collect(),
    };
    let curve = series("predicted", Mark::Line, |row| (row.cycles, row.crack_length_mm));
    let rates =
        series("predicted, one point per cycle block", Mark::Dots, |row| (row.delta_k_mpa_sqrt_m, row.da_dn_mm_per_cycle));
    chart::crack_length(&folder.join("a_n.svg"), &format!("{}: crack length over life", case.name), &[curve])?;
    if rates.points.iter().any(|(x, y)| *x > 0.0 && *y > 0.0) {
        chart::growth_rate(&folder.join("da_dn.svg"), &format!("{}: growth rate", case.name), &[rates])?;
    }
    Ok(())
}

fn summary(case: &Case, prediction: &Prediction, out: &Path) -> Vec<String> {
    let (from, to) = (case.specimen.crack_length / MM, prediction.crack_length_final() / MM);
    let mut lines = vec![
        format!("{}: life {:.1} cycles", case.name, prediction.life_cycles()),
        format!("  crack length   {from:.3} mm to {to:.3} mm"),
        format!("  stopped        {}: {}", prediction.stop, prediction.stop.meaning()),
    ];
    lines.extend(fit_use::law_line(case).map(|law| format!("  law            {law}")));
    lines.extend(zone_words(case, prediction).map(|zone| format!("  plastic zone   {zone}")));
    lines.push(format!("  computed       {}", computed(case, prediction)));
    lines.push(format!("  results        {}", out.display()));
    lines
}

/// Plastic zone at start and end against ligament, thickness and horizon; `None` without yield strength.
fn zone_words(case: &Case, prediction: &Prediction) -> Option<String> {
    let PlasticZone { first, last, .. } = PlasticZone::of(case, prediction)?;
    let (horizon, thickness) = (prediction.figures.horizon, case.specimen.thickness);
    let of_horizon = if horizon > 0.0 { format!(", {:.2} of the horizon", last.size / horizon) } else { String::new() };
    Some(format!(
        "{:.3} mm to {:.3} mm ({:.3} of the ligament, {:.2} of the thickness{of_horizon})",
        first.size / MM,
        last.size / MM,
        last.size / last.ligament,
        last.size / thickness
    ))
}

fn computed(case: &Case, prediction: &Prediction) -> String {
    let figures = &prediction.figures;
    match case.model.method {
        Method::Peridynamics => format!(
            "{} points, {} cycle blocks, {} solves, {:.1} s",
            figures.points, figures.blocks, figures.solves, figures.wall_s
        ),
        Method::Handbook => {
            let formula = handbook(&case.specimen).map_or("", |formula| formula.name);
            format!("by hand calculation: {formula}, {} rows, {:.2} ms", figures.blocks + 1, 1e3 * figures.wall_s)
        }
    }
}
