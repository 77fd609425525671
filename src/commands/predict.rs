//! `perilife predict`: a case to its a-N curve, tables, pictures and ParaView files.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::checkpoint;
use super::console::Console;
use crate::case::budget::Budget;
use crate::case::{Case, Method};
use crate::error::Result;
use crate::input::Document;
use crate::predict::plastic_zone::PlasticZone;
use crate::predict::residual_strength::{check_strength, residual_strength};
use crate::predict::{Prediction, StopReason};
use crate::report::output::{OutputFolder, Replaced, RunKind};
use crate::report::{self, fit_use, run};
use crate::specimen::handbook::handbook;
use crate::units::MM;

/// Arguments of `perilife predict`.
#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "DIR holds the curve (a_n.csv), the path of every tip (crack_path.csv), result.json, charts, pictures and paraview/run.pvd.\n\
                       A run that was killed goes on from its checkpoint to the same curve, bit for bit on the same kind of processor."
)]
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
    let document = Document::read(&args.case, &args.set)?;
    let case = Case::from_document(&document)?;
    // Before anything is laid out or written.
    Budget::of(&case).within_machine().map_err(|error| document.locate(error))?;
    let extras = Extras { residual_strength: args.residual_strength, keeping: args.keeping.clone() };
    let done = run_case(&case, &args.out, &extras, &args.console)?;
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
    let provenance = &case.provenance;
    extras.keeping.check_outside(out)?;
    let folder = OutputFolder::claim(out, RunKind::Predict, provenance, run::room(case))?;
    for warning in case.warnings.iter().map(String::as_str).chain(folder.warning()) {
        console.warn(warning);
    }
    if extras.residual_strength {
        // A plate without known strength should not cost a run; K of its curve comes later.
        check_strength(case)?;
    }
    let (prediction, checkpoint) = extras.keeping.run(case, console)?;
    // If that fails, the run itself is written all the same.
    let strengths = extras.residual_strength.then(|| residual_strength(case, &prediction.curve)).transpose();
    let more = |folder: &Path| match &strengths {
        Ok(Some(strengths)) => report::residual_strength::write(folder, case, strengths),
        _ => Ok(()),
    };
    let done = keep(case, prediction, folder, &more, console)?;
    checkpoint.map(Replaced::remove).transpose()?;
    strengths.map(|_| done)
}

/// Judges a run, writes its files and puts the folder in place.
///
/// `more` writes what goes beside them.
///
/// # Errors
/// As [`run::judge`] and [`run::write`], what there is then stays under a visible name; with the files in place, as [`run::refusal`].
pub fn keep(
    case: &Case,
    prediction: Prediction,
    mut folder: OutputFolder,
    more: &dyn Fn(&Path) -> Result<()>,
    console: &Console,
) -> Result<FinishedRun> {
    for warning in &prediction.warnings {
        console.warn(warning);
    }
    for warning in run::judge(case, &prediction)? {
        console.warn(&warning);
    }
    let result = folder.fill(|path| {
        let result = run::write(path, case, &prediction)?;
        more(path).map(|()| result)
    })?;
    let lines = summary(case, &prediction, folder.name());
    drop(folder.finish()?);
    for line in lines {
        console.say(&line);
    }
    match run::refusal(case, &prediction) {
        Some(refusal) => Err(refusal),
        None => Ok(FinishedRun { prediction, result }),
    }
}

fn summary(case: &Case, prediction: &Prediction, out: &Path) -> Vec<String> {
    let (from, to) = (case.specimen.crack_length / MM, prediction.crack_length_final() / MM);
    let mut lines = vec![
        match prediction.life() {
            Some(life) if prediction.stop == StopReason::EnteredHole => format!("{}: {life:.1} cycles to the hole", case.name),
            Some(life) if prediction.stop.is_lower_bound() => format!("{}: life at least {life:.1} cycles", case.name),
            Some(life) => format!("{}: life {life:.1} cycles", case.name),
            None => format!("{}: life unlimited", case.name),
        },
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
        Method::ElementFreeGalerkin => format!(
            "up to {} nodes, {} increments, {} solves, {:.2} s",
            figures.points, figures.blocks, figures.solves, figures.wall_s
        ),
        Method::Handbook => {
            let formula = handbook(&case.specimen).map_or("", |formula| formula.name);
            format!("by hand calculation: {formula}, {} rows, {:.2} ms", figures.blocks + 1, 1e3 * figures.wall_s)
        }
    }
}
