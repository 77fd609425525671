//! Cases of a sweep on the cores of this machine.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use super::folder::SweepFolder;
use crate::commands::console::Count;
use crate::error::{Error, Result};
use crate::predict::{Silent, predict};
use crate::report::run;
use crate::report::sweep::Outcome;
use crate::sweep::DrawnCase;
use crate::units::MM;

/// Runs cases, `threads` at a time, each of them on one thread: cases share nothing, so that is the fastest.
///
/// # Errors
/// [`Error::File`] if results cannot be written; what is finished by then stays. A case that fails is none.
pub fn run(cases: &[&DrawnCase], folder: &SweepFolder, threads: usize, with_files: bool, count: &Count) -> Result<()> {
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
            count.one();
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
        let read = case.read()?;
        let prediction = predict(&read, &Silent)?;
        let judged = run::judge(&read, &prediction)?;
        if let Some(folder) = files {
            run::write(folder, &read, &prediction)?;
        }
        if let Some(refusal) = run::refusal(&read, &prediction) {
            return Err(refusal);
        }
        let warnings = [&read.warnings, &prediction.warnings, &judged].into_iter().flatten().cloned().collect();
        Ok(Outcome {
            input: case.hash.clone(),
            life_cycles: prediction.life(),
            stop_reason: Some(prediction.stop.name().to_owned()),
            crack_length_final_mm: Some(prediction.crack_length_final() / MM),
            wall_s: prediction.figures.wall_s,
            problem: None,
            try_again: false,
            warnings,
            has_files: files.is_some(),
        })
    };
    let failed = |problem: &str| Ok(Outcome::failed(case, problem, begun.elapsed().as_secs_f64()));
    match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Err(error @ Error::File { .. })) => Err(error),
        Ok(Err(error)) => failed(&error.to_string()),
        Ok(done) => done,
        Err(_) => failed("the run panicked"),
    }
}
