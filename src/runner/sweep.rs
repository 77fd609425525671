//! A sweep: its cases on the cores of this machine, and what came of them.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use super::sweep_folder::{NAMED, SweepFolder};
use super::{Summary, Task, Watcher};
use perilife_base::error::{Error, Result};
use perilife_calibration::sweep::DrawnCase;
use perilife_growth::predict::Silent;
use perilife_results::sweep::{Failure, LifeQuantiles, Outcome, QuantileWords, SweepRecord, write};

/// Runs cases, `threads` at a time, each of them on one thread: cases share nothing, so that is the fastest. `done` is called after
/// each.
/// Errors: [`Error::File`] if results cannot be written; what is finished by then stays. A case that fails is none.
pub fn run(cases: &[&DrawnCase], folder: &SweepFolder, threads: usize, with_files: bool, done: &(dyn Fn() + Sync)) -> Result<()> {
    let next = AtomicUsize::new(0);
    let is_over = AtomicBool::new(false);
    let trouble = Mutex::new(None);
    let stop = |error: Error| {
        is_over.store(true, Ordering::Relaxed);
        // An error is whole at any moment, even that of a thread that died.
        trouble.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    };
    let work = || {
        while !is_over.load(Ordering::Relaxed) {
            let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
            if let Err(error) = folder.keep(case, |path| outcome(case, with_files.then_some(path))) {
                stop(error);
            }
            done();
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads.min(cases.len()) {
            scope.spawn(|| match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
                Ok(pool) => pool.install(work),
                Err(error) => stop(Error::file(Path::new("threads"), "cannot be started", std::io::Error::other(error))),
            });
        }
    });
    trouble.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
}

/// Runs a case and writes its files, as `perilife predict` does.
fn outcome(case: &DrawnCase, files: Option<&Path>) -> Result<Outcome> {
    let begun = Instant::now();
    let run = || -> Result<Outcome> {
        let task = Task::Prediction { case: Box::new(case.read()?), wanted: Box::default() };
        let summary = super::run(&task, None, files, &Silent)?.counted()?;
        Ok(Outcome::of(case, &summary.figures, files.is_some()))
    };
    let failed = |problem: &str| Ok(Outcome::failed(case, problem, begun.elapsed().as_secs_f64()));
    match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Err(error @ Error::File { .. })) => Err(error),
        Ok(Err(error)) => failed(&error.to_string()),
        Ok(done) => done,
        Err(_) => failed("the run panicked"),
    }
}

/// Writes table, figures and picture of what is there. It counts if no case is missing and one has a result.
pub fn collect(folder: &SweepFolder, begun: Instant, watcher: &dyn Watcher) -> Result<Summary> {
    let outcomes: Vec<Option<Outcome>> = (1..=folder.plan.cases.len()).map(|number| folder.outcome(number)).collect();
    let record = write(&folder.path, &folder.plan, &outcomes, begun.elapsed().as_secs_f64())?;
    for warning in record.warnings.iter().take(NAMED) {
        let others = if warning.cases > 1 { format!(" and {} more", warning.cases - 1) } else { String::new() };
        let elsewhere = warning.largest_in.as_ref().filter(|case| warning.cases > 1 && **case != warning.first);
        let most = warning.largest_percent.zip(elsewhere).map(|(share, case)| format!(" (case {case}: {share:?} %)"));
        watcher.warn(&format!("case {}{others}: {}{}", warning.first, warning.warning, most.unwrap_or_default()));
    }
    // Figures and text have a form in JSON.
    let result = serde_json::to_value(&record).unwrap_or_default();
    let (lines, refusal) = (words(&folder.path, &record), verdict(&record));
    Ok(Summary { figures: result.clone(), result, lines, refusal, ..Summary::default() })
}

fn words(path: &Path, record: &SweepRecord) -> Vec<String> {
    let SweepRecord { name, cases, succeeded, failed, missing, life_cycles: LifeQuantiles { words: life, .. }, .. } = record;
    let percent = |count: usize| 100.0 * count as f64 / *succeeded as f64;
    let mut lines = vec![format!("{name}: {cases} cases, {succeeded} succeeded, {failed} failed, {missing} missing")];
    if let QuantileWords { p05: Some(low), p50: Some(middle), p95: Some(high) } = life {
        lines.push(format!("  life           5 % {low}, median {middle}, 95 % {high} cycles"));
    }
    for (what, count, meaning) in
        [("run-outs ", record.run_outs, "lives above stop.cycles_max"), ("unlimited", record.unlimited, "no growth")]
    {
        lines.extend((count > 0).then(|| format!("  {what}      {count} ({:.0} %): {meaning}", percent(count))));
    }
    let failure = |failure: &Failure| format!("  failed         {}: {}", failure.case, failure.problem);
    lines.extend(record.failures.iter().take(NAMED).map(failure));
    lines.push(format!("  computed       {:.1} s of one core", record.computing_s));
    lines.push(format!("  results        {}", path.display()));
    lines
}

/// Why a sweep does not count.
fn verdict(record: &SweepRecord) -> Option<Error> {
    let SweepRecord { name, cases, missing, missing_cases, .. } = record;
    if *missing > 0 {
        let named = missing_cases[..missing_cases.len().min(NAMED)].join(", ");
        let more = if *missing > NAMED { ", ..." } else { "" };
        let text = format!(
            "{name}: {missing} of {cases} cases are missing: {named}{more}; run `perilife sweep` again with the same --out"
        );
        return Some(Error::Mechanics(text));
    }
    let why = record.failures.first().map_or("", |failure| &*failure.problem);
    (record.succeeded == 0).then(|| Error::Mechanics(format!("{name}: no case has a result; the first says: {why}")))
}
