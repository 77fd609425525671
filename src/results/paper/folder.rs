//! What a report is made of, read from the folder of a run or a fit.

use std::path::Path;

use serde_json::Value;

use super::Drawings;
use crate::curve::{A_N_FILE, CRACK_PATH_FILE, RunTables};
use crate::kept::{check_listed, listed};
use crate::pictures::fit::{
    BAND_FILE, CURVES_FILE, FIT_FILE, FitTables, RATES_FITTED_FILE, READINGS_FILE, RateFitted, rates_fitted,
};
use crate::record::{RESULT_FILE, RunRecord};
use crate::units::metric_result;
use perilife_base::columns::Table;
use perilife_base::error::{Error, InputError, Result, input};
use perilife_base::input::Opened;

/// A run or a fit with its tables.
pub enum Source {
    /// Of `perilife predict`.
    Run {
        /// `result.json`.
        run: Box<RunRecord>,
        /// Its tables.
        tables: RunTables,
        /// Its pictures that the tables do not say.
        drawings: Drawings,
    },
    /// Of `perilife calibrate`, to readings.
    Lives {
        /// `fit.json`.
        fit: Value,
        /// Its tables.
        tables: FitTables,
    },
    /// Of `perilife calibrate`, to rates.
    Laws {
        /// `fit.json`.
        fit: Value,
        /// Its rates.
        rates: Vec<RateFitted>,
    },
}

/// Reads the folder; all that is read is added to `opened`.
/// Errors: no folder; one that holds neither a run of cycles nor a fit; a file that is missing, cut off or not as it was written, by name, key and
/// value.
pub fn read(folder: &Path, opened: &Opened) -> Result<Source> {
    std::fs::read_dir(folder).map_err(|error| Error::file(folder, "cannot read the folder of a run", error))?;
    let files = Files { folder, opened };
    if folder.join(RESULT_FILE).is_file() {
        return files.run();
    }
    if folder.join(FIT_FILE).is_file() {
        return files.fit();
    }
    let problem = format!("holds no finished run and no fit ({RESULT_FILE} and {FIT_FILE} are missing)");
    Err(input("DIR", folder.display(), problem, "give the --out folder of `perilife predict` or `perilife calibrate`"))
}

/// A key that has to be there: its name, whether a value is right, and what it should be.
type Key = (&'static str, fn(&Value) -> bool, &'static str);

struct Files<'f> {
    folder: &'f Path,
    opened: &'f Opened,
}

impl Files<'_> {
    fn run(&self) -> Result<Source> {
        let result = self.object(RESULT_FILE, "perilife predict")?;
        if result["life_cycles"].is_null() && result.get("peak_load_n").is_some() {
            let problem = "holds a fracture scene, which has no life to report";
            return Err(input(
                "DIR",
                self.folder.display(),
                problem,
                "give the --out folder of `perilife predict` or `perilife calibrate`",
            ));
        }
        let run: RunRecord = serde_path_to_error::deserialize(&result).map_err(|error| {
            let path = error.path().to_string();
            match result.pointer(&format!("/{}", path.replace('.', "/"))) {
                Some(value) => self.bad(RESULT_FILE, &path, value, &format!("is not as it was written: {}", error.inner())),
                None => self.damaged(RESULT_FILE, format!("is not as it was written: {}", error.inner())),
            }
        })?;
        if let Some(life) = run.life_cycles.filter(|life| *life < 0.0) {
            return Err(self.bad(RESULT_FILE, "life_cycles", &life.into(), "is below zero"));
        }
        let (curve, path) = (self.table(A_N_FILE, &result, RESULT_FILE)?, self.table(CRACK_PATH_FILE, &result, RESULT_FILE)?);
        let (tables, drawings) = (RunTables::of(&curve, &path)?, Drawings::read(self.folder, self.opened)?);
        Ok(Source::Run { run: Box::new(run), tables, drawings })
    }

    fn fit(&self) -> Result<Source> {
        let fit = self.object(FIT_FILE, "perilife calibrate")?;
        if fit.get("candidates").is_some() {
            let wanted: [Key; 3] = [
                ("law", Value::is_string, "text"),
                ("constants", Value::is_object, "a table"),
                ("version", Value::is_string, "text"),
            ];
            self.check_keys(&fit, FIT_FILE, &wanted)?;
            let rates = rates_fitted(&self.table(RATES_FITTED_FILE, &fit, FIT_FILE)?)?;
            return Ok(Source::Laws { fit, rates });
        }
        let is_positive: fn(&Value) -> bool = |value| value.as_f64().is_some_and(|number| number > 0.0);
        let number = "a number above 0";
        let wanted = [
            ("paris_m", is_positive, number),
            ("paris_c_mm_per_cycle", is_positive, number),
            ("pivot_delta_k_mpa_sqrt_m", is_positive, number),
            ("rate_at_pivot_mm_per_cycle", is_positive, number),
            ("delta_k_min_mpa_sqrt_m", is_positive, number),
            ("delta_k_max_mpa_sqrt_m", is_positive, number),
            ("version", Value::is_string, "text"),
        ];
        self.check_keys(&fit, FIT_FILE, &wanted)?;
        let [curves, band, readings] = [CURVES_FILE, BAND_FILE, READINGS_FILE].map(|name| self.table(name, &fit, FIT_FILE));
        let tables = FitTables::read(&fit, [&curves?, &band?, &readings?])?;
        Ok(Source::Lives { fit, tables })
    }

    /// A table of the folder, as it was written by what the result beside it says.
    fn table(&self, name: &str, result: &Value, by: &str) -> Result<Table> {
        let path = self.folder.join(name);
        if !path.is_file() {
            return Err(self.damaged(name, format!("is missing beside {by}")));
        }
        let bytes = self.opened.read(&path, name)?;
        if let Some(entry) = listed(result, name) {
            check_listed(&path, &bytes, entry, by)?;
        }
        let text = String::from_utf8(bytes).map_err(|_| self.damaged(name, "is not text".to_owned()))?;
        Table::read(&text, &path)
    }

    fn object(&self, name: &str, command: &str) -> Result<Value> {
        let bytes = self.opened.read(&self.folder.join(name), name)?;
        let value: Value =
            serde_json::from_slice(&bytes).map_err(|error| self.damaged(name, format!("is cut off or damaged: {error}")))?;
        let is_object = value.is_object();
        let refuse = || self.damaged(name, format!("is no object that `{command}` wrote"));
        is_object.then(|| metric_result(value)).ok_or_else(refuse)
    }

    fn check_keys(&self, object: &Value, name: &str, wanted: &[Key]) -> Result<()> {
        match wanted.iter().find(|(key, is_right, _)| object.get(key).is_none_or(|value| !is_right(value))) {
            Some((key, _, what)) => Err(self.bad(name, key, &object[*key], &format!("is not {what}"))),
            None => Ok(()),
        }
    }

    fn bad(&self, name: &str, key: &str, value: &Value, problem: &str) -> Error {
        let value: String = value.to_string().chars().take(80).collect();
        Error::Input(Box::new(InputError {
            file: Some(self.folder.join(name)),
            key: Some(key.to_owned()),
            value: Some(value),
            problem: problem.to_owned(),
            remedy: AGAIN.to_owned(),
            ..InputError::default()
        }))
    }

    fn damaged(&self, name: &str, problem: String) -> Error {
        let (file, remedy) = (Some(self.folder.join(name)), AGAIN.to_owned());
        Error::Input(Box::new(InputError { file, problem, remedy, ..InputError::default() }))
    }
}

const AGAIN: &str = "copy the folder again, or run the command again that wrote it";
