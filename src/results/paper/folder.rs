//! What a report is made of, read from the folder of a run or a fit.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::Drawings;
use crate::csv::{A_N_FILE, check_listed, listed};
use crate::json::RESULT_FILE;
use crate::pictures::fit::{
    BAND_FILE, CURVES_FILE, FIT_FILE, FitTables, RATES_FITTED_FILE, READINGS_FILE, RateFitted, rates_fitted,
};
use crate::pictures::plate::Plate;
use crate::pictures::tables::RunTables;
use crate::run::CRACK_PATH_FILE;
use crate::units::metric_result;
use perilife_base::error::{Error, InputError, Result, input};
use perilife_base::input::Opened;
use perilife_calibration::record::{FitRecord, LivesRecord, RatesRecord};

/// A run or a fit with its tables.
pub enum Source {
    /// Of `perilife predict`.
    Run {
        /// `result.json`.
        result: Value,
        /// Its tables.
        tables: RunTables,
        /// Its pictures that the tables do not say.
        drawings: Drawings,
    },
    /// Of `perilife calibrate`, to readings.
    Lives {
        /// `fit.json`.
        fit: Box<LivesRecord>,
        /// Its tables.
        tables: FitTables,
    },
    /// Of `perilife calibrate`, to rates.
    Laws {
        /// `fit.json`.
        fit: Box<RatesRecord>,
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
        let wanted: [Key; 6] = [
            ("name", Value::is_string, "text"),
            ("stop_reason", Value::is_string, "text"),
            ("life_cycles", |value| value.is_null() || value.as_f64().is_some_and(|life| life >= 0.0), "cycles"),
            ("crack_length_final_mm", |value| value.is_null() || value.is_number(), "a length"),
            ("checks", Value::is_array, "an array"),
            ("version", Value::is_string, "text"),
        ];
        self.check_keys(&result, RESULT_FILE, &wanted)?;
        if let Some(plate) = result.get("plate")
            && let Err(error) = serde_json::from_value::<Plate>(plate.clone())
        {
            return Err(self.bad(RESULT_FILE, "plate", plate, &format!("is not as it was written: {error}")));
        }
        let curve = self.table(A_N_FILE, &result, RESULT_FILE)?;
        let path = self.table(CRACK_PATH_FILE, &result, RESULT_FILE)?;
        let [curve_name, path_name] = [A_N_FILE, CRACK_PATH_FILE].map(|name| self.folder.join(name).display().to_string());
        let tables = RunTables::read([&curve, &curve_name], [&path, &path_name])?;
        Ok(Source::Run { result, tables, drawings: Drawings::read(self.folder, self.opened)? })
    }

    fn fit(&self) -> Result<Source> {
        let fit = self.object(FIT_FILE, "perilife calibrate")?;
        let is_positive: fn(&Value) -> bool = |value| value.as_f64().is_some_and(|number| number > 0.0);
        let figures = [
            "paris_m",
            "paris_c_mm_per_cycle",
            "pivot_delta_k_mpa_sqrt_m",
            "rate_at_pivot_mm_per_cycle",
            "delta_k_min_mpa_sqrt_m",
            "delta_k_max_mpa_sqrt_m",
        ];
        if fit.get("candidates").is_none() {
            self.check_keys(&fit, FIT_FILE, &figures.map(|key| (key, is_positive, "a number above 0")))?;
        }
        let table = |name: &str| self.table(name, &fit, FIT_FILE);
        let record = serde_json::from_value::<FitRecord>(fit.clone());
        match record.map_err(|error| self.damaged(FIT_FILE, format!("is not as `perilife calibrate` wrote it: {error}")))? {
            FitRecord::Rates(fit) => {
                let rates = rates_fitted(&table(RATES_FITTED_FILE)?).map_err(|error| self.within(error))?;
                Ok(Source::Laws { fit, rates })
            }
            FitRecord::Lives(fit) => {
                let tables = [&*table(CURVES_FILE)?, &*table(BAND_FILE)?, &*table(READINGS_FILE)?];
                let tables = FitTables::read(&fit, tables).map_err(|error| self.within(error))?;
                Ok(Source::Lives { fit, tables })
            }
        }
    }

    /// A table of the folder, as it was written by what the result beside it says.
    fn table(&self, name: &str, result: &Value, by: &str) -> Result<String> {
        let path = self.folder.join(name);
        if !path.is_file() {
            return Err(self.damaged(name, format!("is missing beside {by}")));
        }
        let bytes = self.opened.read(&path, name)?;
        if let Some(entry) = listed(result, name) {
            check_listed(&path, &bytes, entry, by)?;
        }
        String::from_utf8(bytes).map_err(|_| self.damaged(name, "is not text".to_owned()))
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

    /// The error with the folder before the name of its file.
    fn within(&self, error: Error) -> Error {
        match error {
            Error::Input(mut trouble) => {
                trouble.file = trouble.file.map(|file: PathBuf| self.folder.join(file));
                Error::Input(trouble)
            }
            other => other,
        }
    }
}

const AGAIN: &str = "copy the folder again, or run the command again that wrote it";
