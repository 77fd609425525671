//! Source of a report, read from the folder of a run or a fit: its tables, as the result beside them says they were written, and pictures.

use std::collections::BTreeMap;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::curve::{A_N_FILE, CRACK_PATH_FILE, Row, RunTables};
use crate::format::metric_result;
use crate::pictures::fit::{BAND_FILE, CURVES_FILE, FIT_FILE, FitTables, RATES_FITTED_FILE, READINGS_FILE, RateFitted};
use crate::pictures::plate::Plate;
use crate::record::{RESULT_FILE, RunRecord};
use perilife_base::columns::{AGAIN, Table};
use perilife_base::error::{Error, InputError, Result, fail_if, input};
use perilife_base::input::{Opened, sha256};
use perilife_base::units::us::System;
use perilife_calibration::record::{LivesRecord, RatesRecord};

const GIVE: &str = "give the results folder of `perilife predict` or `perilife calibrate`";

pub enum Source {
    Run {
        run: Box<RunRecord>,
        tables: RunTables,
        /// Its pictures that the tables cannot give.
        drawings: Drawings,
    },
    /// Of `perilife calibrate`, to readings.
    Lives { fit: Box<LivesRecord>, plate: Option<Box<Plate>>, tables: FitTables },
    /// Of `perilife calibrate`, to rates.
    Laws { fit: Box<RatesRecord>, rates: Vec<RateFitted> },
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
        fail_if!(!path.is_file(), self.damaged(name, format!("is missing; {by} lists it")));
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

const NAMES: [&str; 5] = ["spectrum.svg", "section.svg", "residual_strength.svg", "fleet.svg", "sensitivities.svg"];
const ELEMENTS: [&str; 10] = ["svg", "g", "rect", "path", "line", "circle", "polygon", "polyline", "text", "tspan"];

#[derive(Debug, Default)]
pub struct Drawings(BTreeMap<&'static str, String>);

impl Drawings {
    /// Those of a folder; all that is read is added to `opened`. Files that this program did not draw are not shown.
    /// Errors: a file that cannot be read.
    pub(super) fn read(folder: &Path, opened: &Opened) -> Result<Self> {
        let mut found = BTreeMap::new();
        for name in NAMES {
            let path = folder.join(name);
            if !path.is_file() {
                continue;
            }
            let text = String::from_utf8_lossy(&opened.read(&path, name)?).trim_end().to_owned();
            if is_drawing(&text) {
                found.insert(name, text);
            }
        }
        Ok(Drawings(found))
    }

    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }
}

/// Whether a text draws and does nothing else: it becomes part of a page.
fn is_drawing(text: &str) -> bool {
    let tags = || text.split('<').skip(1).map(|rest| rest.split_once('>').map_or(rest, |(tag, _)| tag));
    let is_known = |tag: &str| {
        let name = tag.trim_start_matches('/').split(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or_default();
        ELEMENTS.contains(&name)
    };
    let acts = |tag: &str| {
        let handles = |part: &str| part.starts_with("on") && part.contains('=');
        tag.contains("href") || tag.contains("url(") || tag.split_whitespace().any(handles)
    };
    text.starts_with("<svg ") && text.ends_with("</svg>") && tags().all(|tag| is_known(tag) && !acts(tag))
}

pub(crate) fn refuse(path: &Path, problem: String) -> Error {
    Error::Input(Box::new(InputError {
        file: Some(path.to_path_buf()),
        problem,
        remedy: AGAIN.to_owned(),
        ..InputError::default()
    }))
}

/// What a result says of one of its tables; `None` of an earlier version.
pub fn listed<'r>(result: &'r Value, name: &str) -> Option<&'r Value> {
    result["tables"].as_array().into_iter().flatten().find(|entry| entry["file"] == name)
}

/// Compares a table with the entry of a result about it.
/// Errors: one that is cut off, or not the one that was written; `by` names the file that says so.
pub fn check_listed(path: &Path, table: &[u8], entry: &Value, by: &str) -> Result<()> {
    let bytes = entry["bytes"].as_u64().unwrap_or(0);
    match table.len() as u64 {
        length if length < bytes => Err(refuse(path, format!("is cut off: {length} of the {bytes} bytes that the run wrote"))),
        _ if entry["sha256"] != sha256(table) => Err(refuse(path, format!("is not the table that the run wrote, by {by}"))),
        _ => Ok(()),
    }
}

/// The rows of the curve of a folder, as its run wrote it by the `result.json` beside it (without that file there is nothing to compare
/// with), and the units of its text.
/// Errors: a table that is not as it was written.
pub fn curve(folder: &Path, name: &str, opened: &Opened) -> Result<(Vec<Row>, System)> {
    let (path, beside) = (folder.join(name), folder.join(RESULT_FILE));
    let bytes = opened.read(&path, name)?;
    let rows = || {
        let table = Table::read(&String::from_utf8_lossy(&bytes), &path)?;
        Ok((Row::of_table(&table)?, table.units))
    };
    if !beside.is_file() {
        return rows();
    }
    let Ok(result) = serde_json::from_slice::<Value>(&opened.read(&beside, RESULT_FILE)?) else {
        return Err(refuse(&path, format!("cannot be checked: {RESULT_FILE} is truncated or damaged")));
    };
    if let Some(entry) = listed(&result, name) {
        check_listed(&path, &bytes, entry, RESULT_FILE)?;
        return rows();
    }
    // A run of an earlier version says its life alone.
    let (rows, units) = rows()?;
    match (result["life_cycles"].as_f64(), rows.last().map(|row| row.cycles)) {
        (Some(life), Some(last)) if last < life => Err(refuse(&path, format!("ends at {last} cycles, and the run at {life}"))),
        _ => Ok((rows, units)),
    }
}
