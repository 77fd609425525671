//! `perilife calibrate`: measured a-N curves to A and p, and on to the cases that use them.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rayon::prelude::*;
use serde_json::{Value, json};

use super::calibrate_laws;
use super::console::Console;
use crate::calibration::calibrate::calibrate;
use crate::calibration::case::{CalibrationCase, remove_law};
use crate::calibration::estimate::Estimate;
use crate::calibration::laws::case::is_law_fit;
use crate::calibration::results::{FitReport, record};
use crate::case::Case;
use crate::case::budget::Budget;
use crate::error::{Result, input};
use crate::input::Document;
use crate::predict::Prediction;
use crate::report::output::{Finished, OutputFolder, Room, RunKind};
use crate::report::{fit, run};
use crate::runner::of_prediction;

/// Arguments of `perilife calibrate`.
#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "DIR holds the law (fitted.toml, for fatigue.fitted), fit.json, tables of curve, band and specimens, and charts.\n\
                       How to fit your own material: calibration/README.md of the source."
)]
pub struct Args {
    /// Calibration file
    #[arg(value_name = "CALIBRATION.toml")]
    pub calibration: PathBuf,
    /// Folder for the results; replaced if an earlier run made it
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: PathBuf,
    /// Case to run with the fit, into DIR/CASE/ (repeatable)
    #[arg(long, value_name = "CASE.toml", num_args = 1.., help_heading = "Input")]
    pub predict: Vec<PathBuf>,
    /// Override a key of the calibration file (repeatable), e.g. --set model.spacing_mm=2
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife calibrate`.
///
/// # Errors
/// Wrong input, mechanics without a result, or files that cannot be read or written.
pub fn run(args: &Args) -> Result<()> {
    let console = &args.console;
    let document = Document::read(&args.calibration, &args.set)?;
    if is_law_fit(&document.table) {
        return calibrate_laws::run(args, &document);
    }
    let calibration = CalibrationCase::from_document(document)?;
    Budget::of(&calibration.case).within_machine().map_err(|error| error.in_file(&args.calibration))?;
    // Read before the fit: a slip in the last case should not cost a calibration.
    let cases = cases_to_predict(&args.predict)?;
    let mut read = calibration.case.provenance.clone();
    read.files.extend(cases.iter().flat_map(|document| document.folder.opened().so_far().files));
    let mut folder = OutputFolder::claim(&args.out, RunKind::Calibrate, &read, Room { tables: 64_000, all: 1_000_000 })?;
    for warning in calibration.warnings.iter().map(String::as_str).chain(folder.warning()) {
        console.warn(warning);
    }
    let started = Instant::now();
    let fitted = calibrate(&calibration, &console.progress(&calibration.case.name))?;
    let report = FitReport::new(&calibration, &fitted, started.elapsed().as_secs_f64());
    for warning in &fitted.warnings {
        console.warn(warning);
    }
    let law = record(&calibration, &fitted);
    folder.fill(|path| fit::write(path, &calibration, &fitted, &report, &law))?;
    // Nobody else writes there until the predictions stand in it.
    let place = folder.finish()?;
    for line in summary(&report, &args.out) {
        console.say(&line);
    }

    let with_law = |document: &Document| -> Result<Case> {
        case_of(document)?.with_law(law.clone()).map_err(|error| document.locate(error))
    };
    let cases = cases.iter().map(with_law).collect::<Result<_>>()?;
    predict_each(cases, json!(report), args, &place)
}

/// Prints the report, with the predictions: each case with the fit, as the command `predict` does it, into its own folder. They run side by
/// side; what they say comes in their order.
pub(super) fn predict_each(cases: Vec<Case>, mut report: Value, args: &Args, place: &Finished) -> Result<()> {
    let console = &args.console;
    // Claimed first: a folder that cannot be written should not cost a run.
    let claim =
        |case: &Case| OutputFolder::claim(&args.out.join(&case.name), RunKind::Predict, &case.provenance, run::room(case));
    let folders: Vec<OutputFolder> = cases.iter().map(claim).collect::<Result<_>>()?;
    let bars = console.progress_of_each(cases.iter().map(|case| &*case.name));
    let runs: Vec<Result<Prediction>> =
        cases.par_iter().zip(bars).map(|(case, bar)| crate::predict::predict(case, &bar)).collect();
    let mut predictions = serde_json::Map::new();
    for ((case, folder), run) in cases.iter().zip(folders).zip(runs) {
        for warning in &case.warnings {
            console.warn(warning);
        }
        place.adopt(&case.name)?;
        let prediction = run?;
        let files = |path: &Path| of_prediction(case, &prediction, false, Some(path), console);
        let kept = console.keep(folder, &[], files)?.counted()?;
        predictions.insert(case.name.clone(), kept.result);
    }
    if let Some(fields) = report.as_object_mut()
        && !predictions.is_empty()
    {
        fields.insert("predictions".to_owned(), Value::Object(predictions));
    }
    console.object(&report)
}

/// Cases for `--predict`, read and checked but for their fatigue law, which the fit will be.
pub(super) fn cases_to_predict(paths: &[PathBuf]) -> Result<Vec<Document>> {
    let mut documents: Vec<Document> = Vec::with_capacity(paths.len());
    for path in paths {
        let mut document = Document::read(path, &[])?;
        remove_law(&mut document.table);
        if documents.iter().any(|earlier| earlier.name == document.name) {
            let problem = format!("has the same case name as another one, {}", document.name);
            return Err(input("--predict", path.display(), problem, "give the files different names"));
        }
        case_of(&document)?;
        documents.push(document);
    }
    Ok(documents)
}

pub(super) fn case_of(document: &Document) -> Result<Case> {
    Case::from_table(document.table.clone(), &document.name, &document.folder).map_err(|error| document.locate(error))
}

/// The fit in words: rate at the pivot and exponent with their errors, never A alone.
fn summary(report: &FitReport, out: &Path) -> Vec<String> {
    let life = 100.0 * (report.life_fitted / report.life_measured - 1.0);
    let source = match report.p_source.as_str() {
        "fitted" => String::new(),
        "not_identified" => " (not identified)".to_owned(),
        "given" => " (given)".to_owned(),
        file => format!(" (from {file})"),
    };
    let error = |error: f64| if error > 0.0 { format!(" ± {error:.4}") } else { String::new() };
    let mut lines =
        vec![format!("fit to {}, {} to {} mm", report.fitted_to, report.from_crack_length_mm, report.to_crack_length_mm)];
    // Hand calculation has no bonds: its p is m.
    if report.a.is_finite() {
        lines.push(format!("  A              {:.6e} at horizon {} mm", report.a, report.horizon_mm));
        lines.push(format!("  p              {:.4}{}{source}", report.p, error(report.p_error)));
    }
    lines.extend([
        format!(
            "  rate           {:.4e} mm/cycle ± {:.2} % at the pivot ΔK = {:.3} MPa√m",
            report.rate_at_pivot_mm_per_cycle,
            100.0 * report.rate_at_pivot_relative_error,
            report.pivot_delta_k_mpa_sqrt_m
        ),
        format!("  Paris          da/dN = {:.4e} ΔK^{:.4} (mm/cycle, MPa√m)", report.paris_c_mm_per_cycle, report.paris_m),
        format!("  m              {:.4}{}{source}", report.paris_m, error(report.paris_m_error)),
        "  ±              one standard error".to_owned(),
        format!("  calibrated ΔK  {:.3} to {:.3} MPa√m", report.delta_k_min_mpa_sqrt_m, report.delta_k_max_mpa_sqrt_m),
        format!(
            "  life           measured {:.0}, fitted {:.0} cycles ({life:+.2} %), rms life error {:.2} %",
            report.life_measured,
            report.life_fitted,
            100.0 * report.rms_life_error
        ),
    ]);
    if report.estimate == Estimate::Robust.name() {
        lines.push("  estimate       robust: repeated median of the rates".to_owned());
    }
    lines.extend(report.lack_of_fit.map(|lack| format!("  lack of fit    {}", lack.words())));
    lines.extend(report.left_out.iter().map(|window| {
        let specimen = window.specimen.as_ref().map_or_else(String::new, |name| format!("specimen {name}, "));
        format!("  left out       {specimen}{} to {} cycles: {}", window.from_cycles, window.to_cycles, window.reason)
    }));
    lines.extend([
        format!("  specimens      {}, in {:.1} s", report.specimens.len(), report.wall_s),
        format!("  results        {}", out.display()),
    ]);
    lines
}
