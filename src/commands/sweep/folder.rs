//! The folder of a sweep: a plan, and a folder for each case that is whole or absent. It stays between calls, which is how a
//! sweep that was broken off goes on.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result, input};
use crate::report::output::{MARKER, OutputFolder, write_file};
use crate::report::sweep::{
    CHART_FILE, FIGURES_FILE, OUTCOME_FILE, Outcome, PLAN_FILE, Plan, TABLE_FILE, read_outcome, read_plan,
};
use crate::sweep::DrawnCase;
use crate::sweep::draw::label;

/// Folder of the cases.
const CASES: &str = "cases";

/// The folder of a sweep.
#[derive(Debug)]
pub struct SweepFolder {
    /// As the user named it.
    pub path: PathBuf,
    /// What it is to hold.
    pub plan: Plan,
}

impl SweepFolder {
    /// Opens or makes the folder for a whole sweep. Finished cases of an earlier call stay where their input is the same; tables of
    /// another plan, and cases that it had more, go; what killed processes left behind goes too, unless others may be at work on
    /// the same folder (`is_shared`).
    ///
    /// # Errors
    /// As [`OutputFolder::create`]; files that cannot be read or written.
    pub fn open(path: &Path, plan: Plan, is_shared: bool) -> Result<Self> {
        let folder = SweepFolder { path: path.to_path_buf(), plan };
        if !is_sweep(path) {
            let new = OutputFolder::create(path)?;
            folder.write_plan(new.path())?;
            new.finish()?;
            return Ok(folder);
        }
        // A plan that cannot be read is one of another version, and replaced as such.
        if read_plan(path).ok().flatten().as_ref() != Some(&folder.plan.as_read()) {
            for file in [TABLE_FILE, FIGURES_FILE, CHART_FILE] {
                remove(&path.join(file))?;
            }
            folder.write_plan(path)?;
        }
        folder.tidy(is_shared)?;
        Ok(folder)
    }

    /// Opens or makes the folder for one part of a sweep, beside which other processes may work on theirs.
    ///
    /// # Errors
    /// As [`SweepFolder::open`]; [`Error::Input`] if it holds anything but this sweep.
    pub fn open_part(path: &Path, plan: Plan) -> Result<Self> {
        let folder = SweepFolder { path: path.to_path_buf(), plan };
        if !is_sweep(path) {
            let new = OutputFolder::create(path)?;
            folder.write_plan(new.path())?;
            // Another part may have been first.
            new.finish_new()?;
        }
        if read_plan(path)?.as_ref() != Some(&folder.plan.as_read()) {
            let problem = "holds something else than this sweep, or the sweep has changed since it began";
            return Err(input("--out", path.display(), problem, "give another folder, or begin anew without --shard"));
        }
        Ok(folder)
    }

    /// Opens the folder of a sweep that was begun.
    ///
    /// # Errors
    /// [`Error::Input`] if it is none.
    pub fn existing(path: &Path) -> Result<Self> {
        let plan = if is_sweep(path) { read_plan(path)? } else { None };
        let Some(plan) = plan else {
            let remedy = "give the folder that `perilife sweep --out` was given";
            return Err(input("DIR", path.display(), "is not the folder of a sweep", remedy));
        };
        Ok(SweepFolder { path: path.to_path_buf(), plan })
    }

    /// What came of a case, if it has been run: its number counts from 1.
    #[must_use]
    pub fn outcome(&self, number: usize) -> Option<Outcome> {
        let planned = self.plan.cases.get(number.checked_sub(1)?)?;
        read_outcome(&self.of_case(number), &planned.input)
    }

    /// Whether nothing is left to do for a case; one without the files that are wanted is run again, unless it failed.
    #[must_use]
    pub fn is_done(&self, number: usize, with_files: bool) -> bool {
        self.outcome(number).is_some_and(|outcome| match outcome.problem {
            Some(_) => !outcome.try_again,
            None => outcome.has_files || !with_files,
        })
    }

    /// Puts a case into its place: `make` writes its files and says what came of it.
    ///
    /// # Errors
    /// Files that cannot be written; what `make` fails with.
    pub fn keep(&self, case: &DrawnCase, make: impl FnOnce(&Path) -> Result<Outcome>) -> Result<()> {
        let cases = self.path.join(CASES);
        fs::create_dir_all(&cases).map_err(|error| Error::file(&cases, "cannot create the folder", error))?;
        let folder = OutputFolder::create(&self.of_case(case.number))?;
        let outcome = make(folder.path())?;
        let path = folder.path().join(OUTCOME_FILE);
        let failed = |error| Error::file(&path, "cannot write", std::io::Error::other(error));
        let text = toml::to_string(&outcome).map_err(|error| failed(error.to_string()))?;
        write_file(&path, text.as_bytes())?;
        folder.finish()
    }

    fn of_case(&self, number: usize) -> PathBuf {
        self.path.join(CASES).join(label(number))
    }

    fn write_plan(&self, folder: &Path) -> Result<()> {
        // Text, numbers and lists always have a JSON form.
        let text = serde_json::to_string_pretty(&self.plan).unwrap_or_default();
        write_file(&folder.join(PLAN_FILE), text.as_bytes())
    }

    /// Removes cases beyond the plan, and what processes left behind that were killed while they wrote.
    fn tidy(&self, is_shared: bool) -> Result<()> {
        let cases = self.path.join(CASES);
        let Ok(entries) = fs::read_dir(&cases) else { return Ok(()) };
        for entry in entries.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let is_planned = name.parse::<usize>().is_ok_and(|number| (1..=self.plan.cases.len()).contains(&number));
            // A temporary name: of a process that was killed, or of one that runs.
            let may_be_used = is_shared && name.starts_with('.');
            if !is_planned && !may_be_used {
                let path = entry.path();
                let removed = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
                removed.map_err(|error| Error::file(&path, "cannot remove", error))?;
            }
        }
        Ok(())
    }
}

/// Whether this program made a sweep there.
fn is_sweep(path: &Path) -> bool {
    path.join(MARKER).is_file() && path.join(PLAN_FILE).is_file()
}

fn remove(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::file(path, "cannot remove", error)),
        _ => Ok(()),
    }
}
