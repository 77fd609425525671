//! `perilife calibrate` of a law over K: rates at several stress ratios to the law that they are for.

use std::time::Instant;

use toml::Value;

use super::calibrate::{Args, case_of, cases_to_predict, predict_each};
use crate::calibration::laws::case::LawCase;
use crate::calibration::laws::results::{report, summary};
use crate::case::Case;
use crate::error::{Error, Result, input_missing};
use crate::input::Document;
use crate::report::law_fit;
use crate::report::output::{OutputFolder, Room, RunKind};

/// Fits the laws of a calibration file.
///
/// # Errors
/// Wrong input, rates that tell no law, or files that cannot be read or written.
pub(super) fn run(args: &Args, document: &Document) -> Result<()> {
    let console = &args.console;
    let case = LawCase::from_document(document)?;
    // Read before the fit: a slip in the last case should not cost a calibration.
    let cases = cases_to_predict(&args.predict)?;
    for document in &cases {
        check_no_gamma(document)?;
    }
    let mut read = document.folder.opened().so_far();
    read.files.extend(cases.iter().flat_map(|document| document.folder.opened().so_far().files));
    let mut folder = OutputFolder::claim(&args.out, RunKind::Calibrate, &read, Room { tables: 64_000, all: 200_000 })?;
    for warning in case.warnings.iter().map(String::as_str).chain(folder.warning()) {
        console.warn(warning);
    }
    let started = Instant::now();
    let fits = case.fit()?;
    for warning in &fits.warnings {
        console.warn(warning);
    }
    let report = report(&case, &fits, started.elapsed().as_secs_f64());
    folder.fill(|path| law_fit::write(path, &case, &fits, &report))?;
    // Nobody else writes there until the predictions stand in it.
    let place = folder.finish()?;
    for line in summary(&case, &fits) {
        console.say(&line);
    }
    console.say(&format!("  results        {}", args.out.display()));
    predict_each(with_record(cases, args)?, report, args, &place)
}

/// A law over K has its own influence of R.
fn check_no_gamma(document: &Document) -> Result<()> {
    match document.table.get("fatigue").and_then(|fatigue| fatigue.get("walker_gamma")) {
        None => Ok(()),
        Some(_) => Err(document.locate(input_missing(
            "fatigue.walker_gamma",
            "does not go with a fit of a law over K, which has its own influence of R",
            "remove it from the case",
        ))),
    }
}

/// The cases with the record that has just been written.
fn with_record(documents: Vec<Document>, args: &Args) -> Result<Vec<Case>> {
    let file = args.out.join("fitted.toml");
    let file = std::path::absolute(&file).map_err(|error| Error::file(&file, "cannot find", error))?;
    let with_law = |mut document: Document| {
        let name = Value::String(file.to_string_lossy().into_owned());
        let fatigue = document.table.entry("fatigue").or_insert_with(|| Value::Table(toml::Table::new()));
        if let Some(fatigue) = fatigue.as_table_mut() {
            fatigue.insert("fitted".to_owned(), name);
        }
        case_of(&document)
    };
    documents.into_iter().map(with_law).collect()
}
