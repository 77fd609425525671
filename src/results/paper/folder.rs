//! Source of a report, read from the folder of a run or a fit.

use std::path::Path;

use serde::de::DeserializeOwned;
use serde_json::Value;

use super::Drawings;
use crate::curve::{A_N_FILE, CRACK_PATH_FILE, RunTables};
use crate::kept::{check_listed, listed, refuse};
use crate::pictures::fit::{BAND_FILE, CURVES_FILE, FIT_FILE, FitTables, RATES_FITTED_FILE, READINGS_FILE, RateFitted};
use crate::pictures::plate::Plate;
use crate::record::{RESULT_FILE, RunRecord};
use crate::units::metric_result;
use perilife_base::columns::{AGAIN, Table};
use perilife_base::error::{Error, InputError, Result, input};
use perilife_base::input::Opened;
use perilife_calibration::record::{LivesRecord, RatesRecord};

const GIVE: &str = "give the results folder of `perilife predict` or `perilife calibrate`";

/// A run or a fit with its tables.
pub enum Source {
    /// Of `perilife predict`.
    Run {
        /// `result.json`.
        run: Box<RunRecord>,
        tables: RunTables,
        /// Its pictures that the tables cannot give.
        drawings: Drawings,
    },
    /// Of `perilife calibrate`, to readings.
    Lives {
        /// `fit.json`.
        fit: Box<LivesRecord>,
        plate: Option<Box<Plate>>,
        tables: FitTables,
    },
    /// Of `perilife calibrate`, to rates.
    Laws {
        /// `fit.json`.
        fit: Box<RatesRecord>,
        rates: Vec<RateFitted>,
    },
}

/// Reads the folder; all that is read is added to `opened`.
/// Errors: no folder; one without a run of cycles or a fit; a file that is missing, cut off or modified, by name, key and value.
pub fn read(folder: &Path, opened: &Opened) -> Result<Source> {
    std::fs::read_dir(folder).map_err(|error| Error::file(folder, "cannot read the folder of a run", error))?;
    let files = Files { folder, opened };
    if folder.join(RESULT_FILE).is_file() {
        return files.run();
    }
    if folder.join(FIT_FILE).is_file() {
        return files.fit();
    }
    let problem = format!("contains no finished run and no fit ({RESULT_FILE} and {FIT_FILE} are missing)");
    Err(input("DIR", folder.display(), problem, GIVE))
}

struct Files<'f> {
    folder: &'f Path,
    opened: &'f Opened,
}

impl Files<'_> {
    fn run(&self) -> Result<Source> {
        let result = self.object(RESULT_FILE, "perilife predict")?;
        if result["life_cycles"].is_null() && result.get("peak_load_n").is_some() {
            let problem = "contains a fracture scene, which has no life to report";
            return Err(input("DIR", self.folder.display(), problem, GIVE));
        }
        let run: RunRecord = self.typed(&result, RESULT_FILE)?;
        if let Some(life) = run.life_cycles.filter(|life| *life < 0.0) {
            return Err(self.bad(RESULT_FILE, "life_cycles", &life.into(), "is below zero"));
        }
        let (curve, path) = (self.table(A_N_FILE, &result, RESULT_FILE)?, self.table(CRACK_PATH_FILE, &result, RESULT_FILE)?);
        let (tables, drawings) = (RunTables::of(&curve, &path)?, Drawings::read(self.folder, self.opened)?);
        Ok(Source::Run { run: Box::new(run), tables, drawings })
    }

    fn fit(&self) -> Result<Source> {
        let fit = self.object(FIT_FILE, "perilife calibrate")?;
        let table = |name: &str| self.table(name, &fit, FIT_FILE);
        if fit.get("candidates").is_some() {
            return Ok(Source::Laws { fit: self.typed(&fit, FIT_FILE)?, rates: table(RATES_FITTED_FILE)?.records()? });
        }
        let record: Box<LivesRecord> = self.typed(&fit, FIT_FILE)?;
        let figures = [
            ("paris_m", record.paris_m),
            ("paris_c_mm_per_cycle", record.paris_c_mm_per_cycle),
            ("pivot_delta_k_mpa_sqrt_m", record.pivot_delta_k_mpa_sqrt_m),
            ("rate_at_pivot_mm_per_cycle", record.rate_at_pivot_mm_per_cycle),
            ("delta_k_min_mpa_sqrt_m", record.delta_k_min_mpa_sqrt_m),
            ("delta_k_max_mpa_sqrt_m", record.delta_k_max_mpa_sqrt_m),
        ];
        if let Some((key, value)) = figures.into_iter().find(|(_, value)| *value <= 0.0) {
            return Err(self.bad(FIT_FILE, key, &value.into(), "is not a number above 0"));
        }
        let tables = FitTables::of(&record, [&table(CURVES_FILE)?, &table(BAND_FILE)?, &table(READINGS_FILE)?])?;
        let plate = fit.get("plate").map(|plate| self.typed(plate, FIT_FILE).map(Box::new)).transpose()?;
        Ok(Source::Lives { fit: record, plate, tables })
    }

    /// A record as its command wrote it.
    fn typed<R: DeserializeOwned>(&self, object: &Value, name: &str) -> Result<R> {
        serde_path_to_error::deserialize(object).map_err(|error| {
            let path = error.path().to_string();
            let problem = format!("was modified after the run: {}", error.inner());
            match object.pointer(&format!("/{}", path.replace('.', "/"))) {
                Some(value) => self.bad(name, &path, value, &problem),
                None => self.damaged(name, problem),
            }
        })
    }

    /// A table of the folder, as it was written by what the result beside it says.
    fn table(&self, name: &str, result: &Value, by: &str) -> Result<Table> {
        let path = self.folder.join(name);
        if !path.is_file() {
            return Err(self.damaged(name, format!("is missing; {by} lists it")));
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
        let refuse = || self.damaged(name, format!("is not a result of `{command}`"));
        is_object.then(|| metric_result(value)).ok_or_else(refuse)
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
        refuse(&self.folder.join(name), problem)
    }
}
