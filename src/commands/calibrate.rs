//! `perilife calibrate`: measured a-N curves to A and p, and on to the cases that use them.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rayon::prelude::*;
use serde_json::{Value, json};

use super::console::Console;
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::input::Document;
use perilife_calibration::calibrate::{Calibration, Fitted};
use perilife_calibration::results::record;
use perilife_calibration::template::refuse_table;
use perilife_growth::case::needs;
use perilife_growth::case::{Case, RECORD, remove_law};
use perilife_growth::predict::Prediction;
use perilife_results::output::{LockedFolder, OutputFolder, RunKind};
use perilife_results::{fit, run};
use perilife_runner::{Message, Summary, Task, Wanted, of_prediction};

#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "DIR contains the law (fitted.toml, for fatigue.fitted), fit.json, tables of curve, band and specimens, and charts.\n\
                       How to fit your own material: calibration/README.md of the source."
)]
pub struct Args {
    /// Calibration file
    #[arg(value_name = "CALIBRATION.toml")]
    pub calibration: PathBuf,
    /// Folder for the results [default: name of the calibration]
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Replace the results of another input in DIR
    #[arg(long, help_heading = "Output")]
    pub force: bool,
    /// Predict this case with the fitted law, into DIR/CASE/ (repeatable)
    #[arg(long, value_name = "CASE.toml", num_args = 1.., help_heading = "Input")]
    pub predict: Vec<PathBuf>,
    /// Set a key (repeatable), e.g. --set model.spacing_mm=2
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife calibrate`.
/// Errors: wrong input, mechanics without a result, or files that cannot be read or written.
pub fn run(args: &Args) -> Result<()> {
    let console = &args.console;
    refuse_table(&args.calibration)?;
    let document = Document::read(&args.calibration, &args.set)?;
    let calibration = Calibration::from_document(&document)?;
    if let Calibration::Lives(of_lives) = &calibration {
        needs::of_case(&of_lives.case).within_machine().map_err(|error| error.in_file(&args.calibration))?;
    }
    // Read before the fit: a slip in the last case should not cost a calibration.
    let cases = cases_to_predict(&args.predict)?;
    if let Calibration::Rates(_) = &calibration {
        cases.iter().try_for_each(check_no_gamma)?;
    }
    let mut read = document.folder.opened().so_far();
    read.files.extend(cases.iter().flat_map(|document| document.folder.opened().so_far().files));
    let out = args.out.as_deref().unwrap_or(Path::new(&document.name));
    let mut folder = OutputFolder::claim(out, RunKind::Calibrate, &read, fit::ROOM, args.force)?;
    folder.warning().into_iter().for_each(|warning| console.warn(warning));
    let started = Instant::now();
    let fitted =
        calibration.fit(&console.progress(calibration.name())).inspect_err(|_| console.warn_all(calibration.warnings()))?;
    let wall_s = started.elapsed().as_secs_f64();
    let record = fitted.record(wall_s);
    folder.fill(|path| fit::write(path, &fitted, &fit::Kept::of(&fitted, record.clone())?))?;
    // Nobody else writes there until the predictions stand in it.
    let place = folder.finish()?;
    let [mut lines, details] = record.words();
    lines.push(format!("  Results        {} (use it: fatigue.fitted = \"{}\")", out.display(), out.join(RECORD).display()));
    let warnings = calibration.warnings().iter().chain(fitted.warnings());
    let messages = warnings.map(|line| Message::warning(line)).collect();
    console.print(Summary::of_words(lines, details, messages))?;
    let cases = cases.into_iter().map(|document| with_law(document, &fitted, out)).collect::<Result<_>>()?;
    predict_each(cases, json!(record), (args, out), &place)
}

fn with_law(mut document: Document, fitted: &Fitted<'_>, out: &Path) -> Result<Case> {
    if let Fitted::Lives(calibration, fit) = fitted {
        return case_of(&document)?.with_law(record(calibration, fit)).map_err(|error| document.locate(error));
    }
    let file = out.join(RECORD);
    let file = std::path::absolute(&file).map_err(|error| Error::file(&file, "cannot find", error))?;
    let fatigue = document.table.entry("fatigue").or_insert_with(|| toml::Table::new().into());
    if let Some(fatigue) = fatigue.as_table_mut() {
        fatigue.insert("fitted".to_owned(), file.to_string_lossy().into_owned().into());
    }
    case_of(&document)
}

/// A law over K has its own influence of R.
fn check_no_gamma(document: &Document) -> Result<()> {
    let gamma = document.table.get("fatigue").and_then(|fatigue| fatigue.get("walker_gamma"));
    let problem = "cannot be combined with this law, which includes R";
    let refuse = |_| Err(document.locate(input_missing("fatigue.walker_gamma", problem, "remove it from the case")));
    gamma.map_or(Ok(()), refuse)
}

/// Prints the report with the predictions: each case with the fit, in parallel, into its own folder, printed in their order.
fn predict_each(cases: Vec<Case>, mut report: Value, (args, out): (&Args, &Path), place: &LockedFolder) -> Result<()> {
    let console = &args.console;
    // Claimed first: a folder that cannot be written should not cost a run.
    let claim =
        |case: &Case| OutputFolder::claim(&out.join(&case.name), RunKind::Predict, &case.provenance, run::room(case), args.force);
    let folders: Vec<OutputFolder> = cases.iter().map(claim).collect::<Result<_>>()?;
    let bars = console.progress_of_each(cases.iter().map(|case| &*case.name));
    let runs: Vec<Result<Prediction>> =
        cases.par_iter().zip(bars).map(|(case, bar)| perilife_growth::predict::predict(case, &bar)).collect();
    let mut predictions = serde_json::Map::new();
    for ((case, folder), run) in cases.iter().zip(folders).zip(runs) {
        place.adopt(&case.name)?;
        let prediction = run.inspect_err(|_| console.warn_all(&case.warnings))?;
        let task = Task::Prediction { case: Box::new(case.clone()), wanted: Box::default() };
        let files = |path: &Path| {
            let summary = of_prediction(case, prediction, &Wanted::default(), console)?;
            summary.write(&task, path)?;
            Ok(summary)
        };
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
fn cases_to_predict(paths: &[PathBuf]) -> Result<Vec<Document>> {
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

fn case_of(document: &Document) -> Result<Case> {
    Case::from_table(document.table.clone(), &document.name, &document.folder).map_err(|error| document.locate(error))
}
