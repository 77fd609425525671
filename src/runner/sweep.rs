//! A sweep: its cases on the cores of this machine, and what came of them.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use serde_json::Value;

use super::sweep_folder::{NAMED, SweepFolder};
use super::{Summary, Task, Watcher};
use perilife_base::error::{Error, Result};
use perilife_calibration::sweep::DrawnCase;
use perilife_growth::predict::Silent;
use perilife_results::sweep::{Outcome, Plan, write};

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
    let figures = write(&folder.path, &folder.plan, &outcomes, begun.elapsed().as_secs_f64())?;
    for warning in first(&figures, "warnings") {
        let [case, text] = ["first", "warning"].map(|key| warning[key].as_str().unwrap_or_default());
        let more = warning["cases"].as_u64().unwrap_or(1).saturating_sub(1);
        let others = if more > 0 { format!(" and {more} more") } else { String::new() };
        let largest = warning["largest_percent"].as_f64().filter(|_| more > 0 && warning["largest_in"] != warning["first"]);
        let most = largest.map_or_else(String::new, |share| {
            format!(" (case {}: {share} %)", warning["largest_in"].as_str().unwrap_or_default())
        });
        watcher.warn(&format!("case {case}{others}: {text}{most}"));
    }
    let (lines, refusal) = (words(&folder.path, &folder.plan, &figures), verdict(&folder.plan.name, &figures));
    Ok(Summary { result: figures.clone(), figures, lines, refusal, ..Summary::default() })
}

fn words(path: &Path, plan: &Plan, figures: &Value) -> Vec<String> {
    let life = |key: &str| figures["life_cycles"]["words"][key].as_str();
    let percent = |count: u64| 100.0 * count as f64 / figures["succeeded"].as_f64().unwrap_or(f64::NAN);
    let counts = ["succeeded", "failed", "missing"].map(|key| figures[key].as_u64().unwrap_or(0));
    let mut lines = vec![format!(
        "{}: {} cases, {} succeeded, {} failed, {} missing",
        plan.name,
        plan.cases.len(),
        counts[0],
        counts[1],
        counts[2]
    )];
    if let (Some(low), Some(middle), Some(high)) = (life("p05"), life("p50"), life("p95")) {
        lines.push(format!("  life           5 % {low}, median {middle}, 95 % {high} cycles"));
    }
    if let Some(count) = figures["run_outs"].as_u64().filter(|count| *count > 0) {
        lines.push(format!("  run-outs       {count} ({:.0} %): lives above stop.cycles_max", percent(count)));
    }
    if let Some(count) = figures["unlimited"].as_u64().filter(|count| *count > 0) {
        lines.push(format!("  unlimited      {count} ({:.0} %): no growth", percent(count)));
    }
    lines.extend(first(figures, "failures").iter().map(|failure| {
        format!(
            "  failed         {}: {}",
            failure["case"].as_str().unwrap_or_default(),
            failure["problem"].as_str().unwrap_or_default()
        )
    }));
    lines.push(format!("  computed       {:.1} s of one core", figures["computing_s"].as_f64().unwrap_or(0.0)));
    lines.push(format!("  results        {}", path.display()));
    lines
}

fn first<'f>(figures: &'f Value, key: &str) -> &'f [Value] {
    let all = figures[key].as_array().map_or(&[][..], Vec::as_slice);
    &all[..all.len().min(NAMED)]
}

/// Why a sweep does not count.
fn verdict(name: &str, figures: &Value) -> Option<Error> {
    let missing = figures["missing"].as_u64().unwrap_or(0);
    if missing > 0 {
        let named: Vec<&str> = first(figures, "missing_cases").iter().filter_map(Value::as_str).collect();
        let more = if missing > NAMED as u64 { ", ..." } else { "" };
        let text = format!(
            "{name}: {missing} of {} cases are missing: {}{more}; run `perilife sweep` again with the same --out",
            figures["cases"],
            named.join(", ")
        );
        return Some(Error::Mechanics(text));
    }
    if figures["succeeded"] == 0 {
        let why = first(figures, "failures").first().and_then(|failure| failure["problem"].as_str()).unwrap_or_default();
        return Some(Error::Mechanics(format!("{name}: no case has a result; the first says: {why}")));
    }
    None
}
