//! A sweep: its cases on the cores of this machine, what came of them, and its folder, which stays between calls, so that a sweep goes on.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use super::{Summary, Task, Watcher};
use perilife_base::error::{Error, Result, input};
use perilife_base::input::Provenance;
use perilife_calibration::sweep::DrawnCase;
use perilife_calibration::sweep::draw::label;
use perilife_growth::predict::Silent;
use perilife_results::output::{LockedFolder, Marker, OutputFolder, RunKind, Share, is_temporary, write_file};
use perilife_results::sweep::{
    CHART_FILE, FIGURES_FILE, Failure, LifeQuantiles, OUTCOME_FILE, Outcome, PLAN_FILE, Plan, QuantileWords, SweepRecord,
    TABLE_FILE, read_outcome, read_plan, write,
};

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
        watcher.warn(&format!("sweep: case {}{others}: {}{}", warning.first, warning.warning, most.unwrap_or_default()));
    }
    let result = serde_json::json!(record);
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

const CASES: &str = "cases";
pub const SCRIPT_FILE: &str = "job.sh";
pub const LOGS: &str = "logs";
pub(super) const NAMED: usize = 5;

#[derive(Debug)]
pub struct SweepFolder {
    pub path: PathBuf,
    pub plan: Plan,
    /// What goes because the plan has changed, in words.
    pub changed: Option<String>,
    _standing: LockedFolder,
}

impl SweepFolder {
    /// Opens or makes the folder for a whole sweep. Finished cases of an earlier call stay where their input is the same; tables of
    /// another plan, and cases that it had more, go; what killed processes left behind goes too, unless others may be at work on
    /// the same folder ([`Share::Parts`]).
    pub fn open(path: &Path, plan: Plan, read: &Provenance, share: Share) -> Result<Self> {
        let standing = enter(path, &plan, read, share)?;
        let earlier = read_plan(path);
        let mut folder = SweepFolder { path: path.to_path_buf(), plan, changed: None, _standing: standing };
        // A plan that cannot be read is one of another version, and replaced as such.
        let earlier = earlier.ok().flatten();
        if let Some(other) = earlier.as_ref().filter(|earlier| earlier.name != folder.plan.name) {
            let done = (1..=other.cases.len()).filter(|number| folder.outcome_in(other, *number).is_some()).count();
            let problem = format!("contains another sweep, {}, with {done} of {} cases done", other.name, other.cases.len());
            return Err(input("--out", path.display(), problem, "use a new folder, or delete this one"));
        }
        if earlier.as_ref() != Some(&folder.plan.as_read()) {
            folder.changed = earlier.and_then(|earlier| folder.lost(&earlier));
            for file in [TABLE_FILE, FIGURES_FILE, CHART_FILE] {
                remove(&path.join(file))?;
            }
            write_file(&path.join(PLAN_FILE), &text_of(&folder.plan))?;
        }
        folder.tidy(share)?;
        Ok(folder)
    }

    /// Opens or makes the folder for one part of a sweep, beside which other processes may work on theirs.
    pub fn open_part(path: &Path, plan: Plan, read: &Provenance) -> Result<Self> {
        let standing = enter(path, &plan, read, Share::Parts)?;
        let folder = SweepFolder { path: path.to_path_buf(), plan, changed: None, _standing: standing };
        if read_plan(path)?.as_ref() != Some(&folder.plan.as_read()) {
            let problem = "contains other files, or the sweep has changed since it began";
            return Err(input("--out", path.display(), problem, "use a new folder, or start again without --shard"));
        }
        Ok(folder)
    }

    /// Opens the folder of a sweep that was begun.
    pub fn existing(path: &Path) -> Result<Self> {
        let is_sweep = Marker::read(path).is_some_and(|marker| marker.kind == RunKind::Sweep);
        let plan = if is_sweep { read_plan(path)? } else { None };
        let Some(plan) = plan else {
            let remedy = "give the --out folder of `perilife sweep`";
            return Err(input("DIR", path.display(), "is not the folder of a sweep", remedy));
        };
        Ok(SweepFolder { path: path.to_path_buf(), plan, changed: None, _standing: LockedFolder::join(path)? })
    }

    /// What came of a case, if it has been run: its number counts from 1.
    pub fn outcome(&self, number: usize) -> Option<Outcome> {
        self.outcome_in(&self.plan, number)
    }

    fn outcome_in(&self, plan: &Plan, number: usize) -> Option<Outcome> {
        let planned = plan.cases.get(number.checked_sub(1)?)?;
        read_outcome(&self.of_case(number), &planned.input)
    }

    /// Finished cases of an earlier plan that have no place in this one, in words.
    fn lost(&self, earlier: &Plan) -> Option<String> {
        let stays = |number: usize| {
            let [old, new] = [earlier, &self.plan].map(|plan| plan.cases.get(number - 1).map(|case| &case.input));
            old == new
        };
        let goes = |number: &usize| !stays(*number) && self.outcome_in(earlier, *number).is_some();
        let lost: Vec<String> = (1..=earlier.cases.len()).filter(goes).map(label).collect();
        let named = lost[..lost.len().min(NAMED)].join(", ");
        let more = if lost.len() > NAMED { ", ..." } else { "" };
        let all = earlier.cases.len();
        (!lost.is_empty())
            .then(|| format!("the plan has changed: {} of {all} finished cases are deleted: {named}{more}", lost.len()))
    }

    /// Whether nothing is left to do for a case; one without the files that are wanted is run again, unless it failed.
    pub fn is_done(&self, number: usize, with_files: bool) -> bool {
        self.outcome(number).is_some_and(|outcome| match outcome.problem {
            Some(_) => !outcome.try_again,
            None => outcome.has_files || !with_files,
        })
    }

    /// Puts a case into its place: `make` writes its files and says what came of it.
    pub fn keep(&self, case: &DrawnCase, make: impl FnOnce(&Path) -> Result<Outcome>) -> Result<()> {
        let cases = self.path.join(CASES);
        fs::create_dir_all(&cases).map_err(|error| Error::file(&cases, "cannot create the folder", error))?;
        let folder = OutputFolder::create(&self.of_case(case.number), RunKind::SweepCase)?;
        let outcome = make(folder.path())?;
        let path = folder.path().join(OUTCOME_FILE);
        let failed = |error| Error::file(&path, "cannot write", std::io::Error::other(error));
        let text = toml::to_string(&outcome).map_err(|error| failed(error.to_string()))?;
        write_file(&path, text.as_bytes())?;
        folder.finish().map(drop)
    }

    fn of_case(&self, number: usize) -> PathBuf {
        self.path.join(CASES).join(label(number))
    }

    /// Removes cases beyond the plan, and what processes left behind that were killed while they wrote.
    fn tidy(&self, share: Share) -> Result<()> {
        let cases = self.path.join(CASES);
        let Ok(entries) = fs::read_dir(&cases) else { return Ok(()) };
        for entry in entries.flatten() {
            let (name, path) = (entry.file_name().to_string_lossy().into_owned(), entry.path());
            let failed = |error| Error::file(&path, "cannot remove", error);
            let is_beyond = name.parse::<usize>().is_ok_and(|number| number > self.plan.cases.len());
            if let Some(marker) = Marker::read(&path).filter(|marker| is_beyond && marker.kind == RunKind::SweepCase) {
                marker.remove_from(&path).map_err(failed)?;
                let _ = fs::remove_dir(&path);
            } else if is_temporary(&name) && share == Share::Alone {
                // Of a process that was killed: nobody else is at work.
                let removed = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
                removed.map_err(failed)?;
            }
        }
        Ok(())
    }
}

/// Locks the folder of a sweep, which is made with its plan where there is none.
fn enter(path: &Path, plan: &Plan, read: &Provenance, share: Share) -> Result<LockedFolder> {
    let runs = [CASES, LOGS].map(|name| format!("{name}/"));
    let files = [PLAN_FILE, TABLE_FILE, FIGURES_FILE, CHART_FILE, SCRIPT_FILE, &runs[0], &runs[1]];
    let marker = Marker::listing(RunKind::Sweep, &files);
    LockedFolder::open(path, &marker, read, share, &[(PLAN_FILE, text_of(plan))])
}

fn text_of(plan: &Plan) -> Vec<u8> {
    // Text, numbers and lists always have a JSON form.
    serde_json::to_vec_pretty(plan).unwrap_or_default()
}

fn remove(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::file(path, "cannot remove", error)),
        _ => Ok(()),
    }
}
