//! The program beside published tests: what was measured, what the program predicts of it, what others predicted.
//!
//! A set is a folder with `source.toml`, the cases of its tests as a user writes them, a calibration if they need one, and tables. Those of
//! `data/validation` are built in. A case that fails gives a row with the reason; what is wrong with a set is found before any run.

mod halves;
pub mod page;
pub mod picture;
mod source;

use std::path::Path;
use std::time::Instant;

use include_dir::{Dir, File, include_dir};
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::input::{Document, Folder, Provenance};
use perilife_base::units::MM;
use perilife_calibration::calibrate::Calibration;
use perilife_growth::case::{Case, RECORD, needs};
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::distance_to_segment;
use perilife_results::csv::paths;
use perilife_runner::{Judged, Wanted};
use serde::Serialize;
use serde_json::Value;

use crate::tasks::side_by_side;
pub use source::{Kind, Set};
use source::{Other, Test};

static SETS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../data/validation");

/// A test beside its prediction. Lives are in `unit`; a measured one is the geometric mean of several, a predicted one the median of the
/// band where there is one.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Row {
    set: String,
    kind: &'static str,
    case: String,
    variant: Option<String>,
    unit: &'static str,
    measured: Option<f64>,
    predicted: Option<f64>,
    /// Predicted over measured life.
    ratio: Option<f64>,
    predicted_p05: Option<f64>,
    predicted_p95: Option<f64>,
    /// Measured lives within the band.
    lives_inside: Option<usize>,
    lives_measured: usize,
    /// Of the ratio less 1, over halves of the specimens.
    ratio_rms_percent: Option<f64>,
    /// Mean continuous ranked probability score of held-out lives, percent of the life.
    crps_percent: Option<f64>,
    /// Distance of the measured points from the predicted path.
    path_mean_mm: Option<f64>,
    path_largest_mm: Option<f64>,
    model: Option<String>,
    error_estimate_percent: Option<f64>,
    others: String,
    /// Life that the first of them predicted over the measured one.
    others_ratio: Option<f64>,
    failure: Option<String>,
    wall_s: f64,
}

/// Names and titles of the sets that are built in.
pub fn built_in() -> Vec<(String, String)> {
    let title = |name: &str| of_name(name).and_then(Result::ok).map(|set| set.about.title).unwrap_or_default();
    names().map(|name| (name.clone(), title(&name))).collect()
}

fn names() -> impl Iterator<Item = String> {
    SETS.dirs().map(|set| set.path().display().to_string())
}

fn files(folder: &'static Dir<'static>) -> Vec<&'static File<'static>> {
    folder.files().chain(folder.dirs().flat_map(files)).collect()
}

/// A built-in set. What it shares with another one lies beside its folder, as on disk.
fn of_name(name: &str) -> Option<Result<Set>> {
    SETS.get_dir(name).filter(|_| names().any(|known| known == name))?;
    let from_set = |path: &Path| match path.strip_prefix(name) {
        Ok(own) => own.display().to_string(),
        Err(_) => format!("../{}", path.display()),
    };
    let at_hand = files(&SETS).into_iter().map(|file| (from_set(file.path()), file.contents().to_vec()));
    Some(Set::read(name, Folder::at_hand(at_hand)))
}

/// The sets of these names or folders, all built-in ones where none is given.
/// Errors: what is neither; a set that cannot be read.
pub fn sets(wanted: &[String]) -> Result<Vec<Set>> {
    let all: Vec<String> = if wanted.is_empty() { names().collect() } else { wanted.to_vec() };
    let set = |name: &String| {
        let path = Path::new(name);
        let stranger = || {
            let remedy = format!("give a folder with source.toml, or one of {}", names().collect::<Vec<_>>().join(", "));
            input("NAME", name, "is neither a set of tests nor a folder", remedy)
        };
        of_name(name).unwrap_or_else(|| if path.is_dir() { Set::read(name, path.into()) } else { Err(stranger()) })
    };
    all.iter().map(set).collect()
}

/// What the sets were read from.
pub fn read(sets: &[Set]) -> Provenance {
    let mut all = Provenance::default();
    sets.iter().for_each(|set| all.files.extend(set.folder.opened().so_far().files));
    all
}

/// Rows of the sets in their order, computed side by side. `done` hears of every set as it ends.
pub fn rows(sets: &[Set], done: &(dyn Fn(&Set, &[Row]) + Sync)) -> Vec<Row> {
    let rows = side_by_side(sets, |set| {
        let rows = set.rows();
        done(set, &rows);
        rows
    });
    rows.concat()
}

/// A life that was predicted, with the ends of its band, and what was said of it.
struct Predicted {
    life: f64,
    band: Option<[f64; 2]>,
    result: Value,
}

impl Set {
    fn rows(&self) -> Vec<Row> {
        // One fit serves all cases; where it fails, so do they.
        let law = self.law().map_err(|error| error.to_string());
        let row = |test: &Test| {
            let (started, mut row) = (Instant::now(), Row::of(self, test));
            let filled = law
                .as_ref()
                .map_err(Clone::clone)
                .and_then(|law| self.fill(&mut row, test, law.as_deref()).map_err(|error| error.to_string()));
            let one_line = |why: String| why.split_whitespace().collect::<Vec<_>>().join(" ");
            row.failure = filled.err().map(one_line);
            row.wall_s = started.elapsed().as_secs_f64();
            row
        };
        self.tests.iter().map(row).collect()
    }

    /// The record that the calibration gives.
    fn law(&self) -> Result<Option<String>> {
        self.calibration()?.map(|calibration| record(&calibration)).transpose()
    }

    fn calibration(&self) -> Result<Option<Calibration>> {
        let Some(file) = &self.about.calibration else { return Ok(None) };
        Calibration::from_document(&Document::in_folder(&self.folder, file, &[])?).map(Some)
    }

    /// A case by the law of a calibration, in the place of the record that it names.
    fn case(&self, file: &str, law: Option<&str>) -> Result<Case> {
        let folder = self.folder.anew_with(law.map(|text| (RECORD.to_owned(), text.as_bytes().to_vec())));
        let mut document = Document::in_folder(&folder, file, &[])?;
        let names_record = document.table.get("fatigue").is_some_and(|fatigue| fatigue.get("fitted").is_some());
        if law.is_some() && names_record {
            document.put("fatigue.fitted", RECORD.into()).map_err(Error::Mechanics)?;
        }
        let case = Case::from_document(&document)?;
        needs::of_case(&case).within_machine().map_err(|error| document.locate(error))?;
        Ok(case)
    }

    fn fill(&self, row: &mut Row, test: &Test, law: Option<&str>) -> Result<()> {
        if let Some(count) = test.halves {
            return halves::fill(self, row, test, count);
        }
        let case = self.case(&test.case, law)?;
        let (prediction, predicted) = run(&case)?;
        row.judge(&predicted, test)?;
        if let Some(path) = &test.path {
            let paths: Vec<Vec<Point>> = paths(&prediction, &case.specimen.cracks)
                .into_iter()
                .map(|path| path.into_iter().map(|(_, at)| at).collect())
                .collect();
            let pieces = || paths.iter().flat_map(|path| path.windows(2));
            let way =
                |at: &Point| pieces().map(|piece| distance_to_segment(*at, piece[0], piece[1])).fold(f64::INFINITY, f64::min);
            let distances: Vec<f64> = self.points[path].iter().map(|at| way(at) / MM).collect();
            row.path_mean_mm = Some(distances.iter().sum::<f64>() / distances.len() as f64);
            row.path_largest_mm = distances.iter().copied().reduce(f64::max);
        }
        Ok(())
    }
}

/// The record of a fit as text.
fn record(calibration: &Calibration) -> Result<String> {
    let no_form = |error| Error::Mechanics(format!("{RECORD} has no form in TOML: {error}"));
    calibration.fit(&Silent)?.record_text().map_err(no_form)
}

/// Runs a case as `perilife predict` does.
/// Errors: a case without a result, or whose result does not count.
fn run(case: &Case) -> Result<(Prediction, Predicted)> {
    let prediction = predict(case, &Silent)?;
    let mut judged = Judged::of(case, &prediction, &Wanted::default(), &Silent)?;
    judged.take_refusal().map_or(Ok(()), Err)?;
    let result = judged.kept.result;
    let band = ["cycles_p05", "cycles_p50", "cycles_p95"].map(|key| result["band"][key].as_f64());
    let life = band[1].unwrap_or(prediction.life_cycles());
    Ok((prediction, Predicted { life, band: band[0].zip(band[2]).map(<[f64; 2]>::from), result }))
}

/// Geometric mean.
fn mean(values: &[f64]) -> f64 {
    (values.iter().map(|value| value.ln()).sum::<f64>() / values.len() as f64).exp()
}

impl Row {
    fn of(set: &Set, test: &Test) -> Row {
        let measured = (!test.lives().is_empty()).then(|| mean(test.lives()));
        let first = test.others.iter().find_map(|other| other.life);
        Row {
            set: set.name.clone(),
            kind: test.kind.name(),
            case: test.case.clone(),
            variant: test.variant.clone(),
            unit: if test.life_passes.is_empty() { "cycles" } else { "passes" },
            measured,
            lives_measured: test.lives().len(),
            others: test.others.iter().map(Other::words).collect::<Vec<_>>().join("; "),
            others_ratio: first.zip(measured).map(|(life, measured)| life / measured),
            ..Row::default()
        }
    }

    /// Why there is no prediction, with the place of the test.
    pub fn failure(&self) -> Option<String> {
        Some(format!("{}: {}: {}", self.set, self.case, self.failure.as_ref()?))
    }

    /// Takes what a run gave.
    /// Errors: passes of a case that has no spectrum.
    fn judge(&mut self, predicted: &Predicted, test: &Test) -> Result<()> {
        let result = &predicted.result;
        self.model = result["model"]["method"].as_str().map(str::to_owned);
        self.error_estimate_percent = result["error_estimate_percent"].as_f64();
        let Some(measured) = self.measured else { return Ok(()) };
        let passes = result["passes"].as_f64().zip(result["life_cycles"].as_f64()).map(|(passes, life)| passes / life);
        let no_passes = || input_missing("test.life_passes", "needs a case with a spectrum", "give life_cycles");
        let share = if test.life_passes.is_empty() { 1.0 } else { passes.ok_or_else(no_passes)? };
        let band = predicted.band.map(|band| band.map(|end| end * share));
        self.put(predicted.life * share, measured, band);
        self.lives_inside = band.map(|[low, high]| test.lives().iter().filter(|life| (low..=high).contains(*life)).count());
        Ok(())
    }

    /// Puts a life, its measured one and its band.
    fn put(&mut self, life: f64, measured: f64, band: Option<[f64; 2]>) {
        (self.predicted, self.measured, self.ratio) = (Some(life), Some(measured), Some(life / measured));
        (self.predicted_p05, self.predicted_p95) = (band.map(|band| band[0]), band.map(|band| band[1]));
    }
}
