//! `source.toml`: where a set of tests comes from, and what was measured.

use std::collections::BTreeMap;

use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{Document, Folder, shorten, slice};
use perilife_base::kinds;
use perilife_base::units::MM;
use perilife_plate::specimen::Point;
use serde::Deserialize;
use toml::Value;

kinds! {
    /// What a prediction rests on.
    pub enum Kind for "test.kind" {
        SameLot = "same_lot": "law from other specimens of the same lot, same condition",
        OtherCondition = "other_condition": "law from specimens of another condition or lot",
        LaterLife = "later_life": "law from earlier readings of the same specimen",
        Spectrum = "spectrum": "spectrum loading, law from constant amplitude",
        Library = "library": "law from growth data of a library alone",
        Path = "path": "crack path in a plate",
    }
}

/// Section `[source]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct About {
    pub(super) title: String,
    /// Authors, year, journal, table or file.
    pub(super) reference: String,
    pub(super) obtained: String,
    pub(super) assumed: String,
    pub(super) uncertainty: String,
    pub(super) licence: String,
    pub(super) remark: Option<String>,
    /// Calibration whose law cases with `fatigue.fitted` take.
    pub(super) calibration: Option<String>,
}

/// An entry of `[[test]]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Test {
    pub(super) kind: Kind,
    pub(super) case: String,
    /// Which of several predictions of one test.
    pub(super) variant: Option<String>,
    /// Measured lives, cycles, one per specimen.
    #[serde(default)]
    pub(super) life_cycles: Vec<f64>,
    /// Measured lives, passes of a spectrum.
    #[serde(default)]
    pub(super) life_passes: Vec<f64>,
    /// Table of the measured path, `x_mm,y_mm`.
    pub(super) path: Option<String>,
    /// So many times a random half of the specimens of the calibration predicts the other half.
    pub(super) halves: Option<usize>,
    #[serde(default)]
    pub(super) others: Vec<Other>,
}

/// A prediction of others.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Other {
    pub(super) by: String,
    pub(super) life: Option<f64>,
    pub(super) path_mean_mm: Option<f64>,
    pub(super) path_largest_mm: Option<f64>,
}

impl Other {
    pub(super) fn words(&self) -> String {
        let figure =
            |what: &str, value: Option<f64>, unit| value.map(|value| format!(" {what}{value}{unit}")).unwrap_or_default();
        let path = [figure("mean ", self.path_mean_mm, " mm"), figure("largest ", self.path_largest_mm, " mm")].concat();
        format!("{}{}{path}", self.by, figure("", self.life, ""))
    }
}

impl Test {
    pub(super) fn lives(&self) -> &[f64] {
        if self.life_passes.is_empty() { &self.life_cycles } else { &self.life_passes }
    }

    fn check(&self, at: &str, has_calibration: bool) -> Result<()> {
        let given = [!self.life_cycles.is_empty(), !self.life_passes.is_empty(), self.halves.is_some()];
        let lives = self.lives().iter().copied().chain(self.others.iter().filter_map(|other| other.life));
        let wrong = lives.into_iter().find(|life| !(life.is_finite() && *life > 0.0));
        let (problem, remedy) = match (given.iter().filter(|is_given| **is_given).count(), wrong, self.halves) {
            (0, ..) if self.path.is_none() => ("has nothing measured", "give life_cycles, life_passes, path or halves"),
            (2.., ..) => ("has its measured life twice", "keep one of life_cycles, life_passes and halves"),
            (_, Some(_), _) => ("has a life that is not above zero", "give measured and predicted lives above zero"),
            (.., Some(count)) if count == 0 || !has_calibration => {
                ("has no specimens to draw halves from", "give source.calibration, and halves above zero")
            }
            _ => return Ok(()),
        };
        Err(input_missing(at, problem, remedy))
    }
}

/// A set of tests.
#[derive(Debug)]
pub struct Set {
    pub(super) name: String,
    pub(super) about: About,
    pub(super) tests: Vec<Test>,
    /// Measured paths by their files, m.
    pub(super) points: BTreeMap<String, Vec<Point>>,
    pub(super) folder: Folder,
}

impl Set {
    /// Reads `source.toml` of a folder, and the paths that it names.
    /// Errors: a file that is not there, keys that are not known, tests without anything measured, a path that is none.
    pub(super) fn read(name: &str, folder: Folder) -> Result<Set> {
        let document = Document::in_folder(&folder, "source.toml", &[])?;
        let read = || -> Result<(About, Vec<Test>)> {
            if let Some((key, value)) = document.table.iter().find(|(key, _)| !["source", "test"].contains(&key.as_str())) {
                return Err(input(key, shorten(value), "is not a known section", "write [source] and [[test]]"));
            }
            let missing =
                |key: &str| input_missing(key, "is missing", "write a section [source] and an entry [[test]] per prediction");
            let about: About = slice(document.table.get("source").ok_or_else(|| missing("source"))?, "source")?;
            let tests = document.table.get("test").and_then(Value::as_array).ok_or_else(|| missing("test"))?;
            let test = |(place, value): (usize, &Value)| {
                let at = format!("test[{place}]");
                let test: Test = slice(value, &at)?;
                test.check(&at, about.calibration.is_some()).map(|()| test)
            };
            let tests = tests.iter().enumerate().map(test).collect::<Result<_>>()?;
            Ok((about, tests))
        };
        let (about, tests) = read().map_err(|error| document.locate(error))?;
        let files = tests.iter().filter_map(|test| test.path.as_ref());
        let points = files.map(|file| Ok((file.clone(), path(&folder, file)?))).collect::<Result<_>>()?;
        Ok(Set { name: name.to_owned(), about, tests, points, folder })
    }
}

/// A measured path, m.
fn path(folder: &Folder, name: &str) -> Result<Vec<Point>> {
    let content = folder.read(name)?;
    let mut reader = csv::Reader::from_reader(&*content);
    let is_path = reader.headers().is_ok_and(|head| head == ["x_mm", "y_mm"].as_slice());
    let points: csv::Result<Vec<Point>> = reader.deserialize().collect();
    match points {
        Ok(points) if is_path && !points.is_empty() && points.iter().flatten().all(|x| x.is_finite()) => {
            Ok(points.into_iter().map(|at| at.map(|x| x * MM)).collect())
        }
        read => {
            let why = read.err().map(|error| format!(" ({error})")).unwrap_or_default();
            let remedy = "give a header x_mm,y_mm and two numbers per line";
            Err(input_missing("test.path", format!("is not a table of a measured path{why}"), remedy).in_file(&folder.path(name)))
        }
    }
}
