//! The program beside published tests: what was measured, what the program predicts of it, what others predicted.
//!
//! A set is a folder with `source.toml`, the cases of its tests as a user writes them, a calibration if they need one, and tables. Those of
//! `data/validation` are built in. A case that fails gives a row with the reason; what is wrong with a set is found before any run.

pub mod page;

use std::ops::Range;
use std::path::Path;

use include_dir::{Dir, File, include_dir};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};
use toml::Value;

use super::tasks::{Outcome, side_by_side};
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::input::{Document, Folder, Sections, slice};
use perilife_base::kinds;
use perilife_base::units::MM;
use perilife_calibration::calibrate::Calibration;
use perilife_calibration::median::{cycles_at, median};
use perilife_calibration::population::forecast::Life;
use perilife_calibration::population::student::t_quantile;
use perilife_calibration::sweep::distribution::shuffle;
use perilife_growth::case::{Case, RECORD, needs};
use perilife_growth::predict::{Prediction, Silent, StopReason, predict};
use perilife_measured::MeasuredCurve;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::distance_to_segment;
use perilife_results::curve::paths;
use perilife_runner::{Judged, Wanted};

/// Specimens below which no half says how they scatter.
const SPECIMENS_MIN: usize = 4;
const TOO_FEW: &str = "needs readings of at least four specimens";
const LEVELS: Range<usize> = 0..100;

/// A test beside its prediction. Lives are in `unit`; a measured one is the median of several, a predicted one that of the band where there
/// is one. Over halves of specimens they are geometric means.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Row {
    set: String,
    kind: &'static str,
    case: String,
    variant: Option<String>,
    unit: &'static str,
    measured: Option<f64>,
    predicted: Option<f64>,
    ratio: Option<f64>,
    predicted_p05: Option<f64>,
    predicted_p95: Option<f64>,
    lives_inside: Option<usize>,
    lives_measured: usize,
    /// Mean continuous ranked probability score of the measured lives, percent of the life.
    crps_percent: Option<f64>,
    /// Distance of the measured points from the predicted path.
    path_mean_mm: Option<f64>,
    path_largest_mm: Option<f64>,
    model: Option<String>,
    error_estimate_percent: Option<f64>,
    others: Option<String>,
    /// Life that others predicted over the measured one.
    others_ratio: Option<f64>,
    /// Why there is no prediction, with the place of the test.
    pub failure: Option<String>,
}

/// A life that was predicted beside measured ones, in the unit of the test.
struct Trial {
    predicted: f64,
    /// Ends of the band, and quantiles for the score, where the case has a band.
    scatter: Option<([f64; 2], Vec<f64>)>,
    measured: Vec<f64>,
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

impl Set {
    fn rows(&self) -> Vec<Row> {
        // One fit serves all cases; where it fails, so do they.
        let law = self.calibration.as_ref().map(record).transpose().map_err(|error| error.to_string());
        let row = |test: &Test| {
            let mut row = Row::of(self, test);
            let law = law.as_ref().map_err(|why| Error::Mechanics(why.clone()));
            let filled = law.and_then(|law| match test.halves {
                Some(count) => self.halves(&mut row, test, count),
                None => self.trial(&mut row, test, law.as_deref(), &[]).map(|trial| vec![trial]),
            });
            let filled = Outcome::of(filled.map(|trials| row.judge(&trials)));
            row.failure = filled.reason().map(|why| format!("{}: {}: {why}", self.name, test.case));
            row
        };
        self.tests.iter().map(row).collect()
    }

    /// Random halves of the specimens, each of which predicts the lives of the other half.
    fn halves(&self, row: &mut Row, test: &Test, count: usize) -> Result<Vec<Trial>> {
        let whole = match &self.calibration {
            Some(Calibration::Lives(whole)) if whole.curves.len() >= SPECIMENS_MIN => whole,
            _ => return Err(input_missing("test.halves", TOO_FEW, "give source.calibration of such specimens, or life_cycles")),
        };
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let half = |_| {
            let mut part = whole.clone();
            shuffle(&mut part.curves, &mut random);
            let held_out = part.curves.split_off(part.curves.len() / 2);
            part.read.retain(|curve| part.curves.iter().any(|own| own.specimen == curve.specimen));
            self.trial(row, test, Some(&record(&Calibration::Lives(part))?), &held_out)
        };
        (0..count).map(half).collect()
    }

    /// Runs a case as `perilife predict` does, and sets what was measured beside it.
    /// Errors: a case without a result, or whose result does not count; lives that it cannot be compared with.
    fn trial(&self, row: &mut Row, test: &Test, law: Option<&str>, held_out: &[MeasuredCurve]) -> Result<Trial> {
        let folder = self.folder.anew_with(law.map(|text| (RECORD.to_owned(), text.as_bytes().to_vec())));
        let document = Document::in_folder(&folder, &test.case, &[])?;
        let case = Case::from_document(&document)?;
        needs::of_case(&case).within_machine().map_err(|error| document.locate(error))?;
        let prediction = predict(&case, &Silent)?;
        let mut judged = Judged::of(&case, &prediction, &Wanted::default())?;
        judged.take_refusal().map_or(Ok(()), Err)?;
        row.model = judged.record.model.get("method").and_then(|method| method.as_str()).map(str::to_owned);
        row.error_estimate_percent = judged.record.error_estimate_percent;
        row.judge_path(&test.path_mm, &prediction, &case);
        let held_out = held_out.iter().map(|curve| life(curve, &case)).collect::<Result<Vec<f64>>>()?;
        let measured = [test.lives(), &held_out].concat();
        let has_end = prediction.stop != StopReason::RunOut || measured.is_empty();
        let no_life = || Error::Mechanics(format!("has no life to compare: {}", prediction.stop.meaning()));
        let life = prediction.life().filter(|_| has_end).ok_or_else(no_life)?;
        let per_pass = case.loading.spectrum.as_ref().map(|spectrum| spectrum.per_pass);
        let no_passes = || input_missing("test.life_passes", "needs a case with a spectrum", "give life_cycles");
        let unit = if test.life_passes.is_empty() { 1.0 } else { per_pass.ok_or_else(no_passes)? };
        let band = judged.lives.life().zip(judged.lives.band.ok());
        let predicted = band.as_ref().map_or(life, |([_, median, _], _)| *median) / unit;
        let scatter = band.map(|([low, median, high], (plate, _))| {
            let freedom = plate.lot.freedom;
            let life = Life { median, deviation: (high / low).ln() / (2.0 * t_quantile(0.95, freedom)), freedom };
            ([low, high], LEVELS.map(|level| life.quantile((level as f64 + 0.5) / LEVELS.len() as f64)).collect())
        });
        Ok(Trial { predicted, scatter, measured })
    }
}

fn record(calibration: &Calibration) -> Result<String> {
    let no_form = |error| Error::Mechanics(format!("{RECORD} cannot be written as TOML: {error}"));
    calibration.fit(&Silent)?.record_text().map_err(no_form)
}

/// Cycles of a specimen from the initial crack length of a case to its stop.
fn life(curve: &MeasuredCurve, case: &Case) -> Result<f64> {
    let [from, to] = [case.specimen.crack_length, case.stop.crack_length].map(|length| cycles_at(curve, length));
    to.zip(from).map(|(to, from)| to - from).ok_or_else(|| {
        let problem =
            format!("of specimen {} do not reach from the initial crack length of the case to its stop", curve.specimen);
        input_missing("measured.files", problem, "set stop.crack_length_mm of the case to a length that all specimens reach")
    })
}

/// Continuous ranked probability score of a measured life as twice the mean pinball loss over quantiles (Gneiting and Raftery 2007), over
/// that life.
fn score(quantiles: &[f64], measured: f64) -> f64 {
    let loss = |(level, quantile): (usize, &f64)| {
        let (level, above) = ((level as f64 + 0.5) / quantiles.len() as f64, quantile - measured);
        if above > 0.0 { (1.0 - level) * above } else { -level * above }
    };
    2.0 * quantiles.iter().enumerate().map(loss).sum::<f64>() / (quantiles.len() as f64 * measured)
}

fn mean(values: &[f64]) -> f64 {
    (values.iter().map(|value| value.ln()).sum::<f64>() / values.len() as f64).exp()
}

impl Row {
    fn of(set: &Set, test: &Test) -> Row {
        let measured = (!test.lives().is_empty()).then(|| median(test.lives()));
        Row {
            set: set.name.clone(),
            kind: test.kind.name(),
            case: test.case.clone(),
            variant: test.variant.clone(),
            unit: if test.life_passes.is_empty() { "cycles" } else { "passes" },
            measured,
            lives_measured: test.lives().len(),
            others: test.others.clone(),
            others_ratio: test.others_life.zip(measured).map(|(life, measured)| life / measured),
            ..Row::default()
        }
    }

    /// Takes the lives of all trials, of which there are several over halves.
    fn judge(&mut self, trials: &[Trial]) {
        self.lives_measured = trials.iter().map(|trial| trial.measured.len()).sum();
        if self.lives_measured == 0 {
            return;
        }
        let over = |figure: &dyn Fn(&Trial) -> Option<f64>| Some(mean(&trials.iter().map(figure).collect::<Option<Vec<f64>>>()?));
        self.predicted = over(&|trial| Some(trial.predicted));
        self.measured = over(&|trial| Some(median(&trial.measured)));
        self.ratio = over(&|trial| Some(trial.predicted / median(&trial.measured)));
        self.predicted_p05 = over(&|trial| Some(trial.scatter.as_ref()?.0[0]));
        self.predicted_p95 = over(&|trial| Some(trial.scatter.as_ref()?.0[1]));
        let beside = |trial: &Trial| {
            let ([low, high], quantiles) = trial.scatter.as_ref()?;
            let inside = trial.measured.iter().filter(|life| (low..=high).contains(life)).count();
            Some((inside, trial.measured.iter().map(|life| score(quantiles, *life)).sum::<f64>()))
        };
        if let Some((inside, scores)) = trials.iter().map(beside).collect::<Option<(Vec<usize>, Vec<f64>)>>() {
            self.lives_inside = Some(inside.iter().sum());
            self.crps_percent = Some(100.0 * scores.iter().sum::<f64>() / self.lives_measured as f64);
        }
    }

    fn judge_path(&mut self, measured_mm: &[Point], prediction: &Prediction, case: &Case) {
        let paths = paths(prediction, &case.specimen.cracks);
        let pieces = || paths.iter().flat_map(|path| path.windows(2));
        let away =
            |at: &Point| pieces().map(|piece| distance_to_segment(*at, piece[0].1, piece[1].1)).fold(f64::INFINITY, f64::min);
        let away: Vec<f64> = measured_mm.iter().map(|at| away(&at.map(|x| x * MM)) / MM).collect();
        self.path_largest_mm = away.iter().copied().reduce(f64::max);
        self.path_mean_mm = self.path_largest_mm.map(|_| away.iter().sum::<f64>() / away.len() as f64);
    }
}

static SETS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../data/validation");

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

#[derive(Debug, Deserialize)]
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
    /// File of the calibration that writes the record of the cases.
    calibration: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Test {
    pub(super) kind: Kind,
    pub(super) case: String,
    /// Which of several predictions of one test.
    pub(super) variant: Option<String>,
    /// Measured lives, cycles, one per specimen.
    #[serde(default)]
    life_cycles: Vec<f64>,
    /// Measured lives, passes of a spectrum, one per specimen.
    #[serde(default)]
    pub(super) life_passes: Vec<f64>,
    /// So many times a random half of the specimens of the calibration predicts the other half.
    pub(super) halves: Option<usize>,
    #[serde(default)]
    pub(super) path_mm: Vec<Point>,
    /// What others predicted, in words, and a life of theirs in the unit of the measured one.
    pub(super) others: Option<String>,
    pub(super) others_life: Option<f64>,
}

impl Test {
    pub(super) fn lives(&self) -> &[f64] {
        if self.life_passes.is_empty() { &self.life_cycles } else { &self.life_passes }
    }

    fn read(value: &Value, at: &str) -> Result<Test> {
        let test: Test = slice(value, at)?;
        let given = [!test.life_cycles.is_empty(), !test.life_passes.is_empty(), test.halves.is_some()];
        let given = given.into_iter().filter(|is_given| *is_given).count();
        if given > 1 || given == 0 && test.path_mm.is_empty() {
            let remedy = "give one of life_cycles, life_passes and halves, or path_mm";
            return Err(input_missing(at, format!("has {given} measured lives"), remedy));
        }
        let is_above_zero = |number: &f64| number.is_finite() && *number > 0.0;
        let are_lives = test.lives().iter().chain(&test.others_life).all(is_above_zero) && test.halves != Some(0);
        if !are_lives || !test.path_mm.iter().flatten().all(|x| x.is_finite()) {
            let problem = "has an invalid life, count of halves or position";
            return Err(input_missing(at, problem, "give lives and counts above zero, and finite positions"));
        }
        Ok(test)
    }
}

#[derive(Debug)]
pub struct Set {
    pub(super) name: String,
    pub(super) about: About,
    pub(super) tests: Vec<Test>,
    pub(super) calibration: Option<Calibration>,
    pub(super) folder: Folder,
}

impl Set {
    /// Reads `source.toml` of a folder, and the calibration that it names.
    /// Errors: a file that is not there, keys that are not known, tests without anything measured.
    fn read(name: &str, folder: Folder) -> Result<Set> {
        let document = Document::in_folder(&folder, "source.toml", &[])?;
        let read = || -> Result<(About, Vec<Test>)> {
            let mut table = document.table.clone();
            let tests = table.remove("test");
            let sections = Sections::of(&table, &["source", "test"], &[])?;
            let about: About = slice(sections.required("source")?, "source")?;
            let no_tests = || input_missing("test", "is missing", "write an entry [[test]] per prediction");
            let tests = tests.as_ref().and_then(Value::as_array).ok_or_else(no_tests)?.iter().enumerate();
            let test = |(i, value)| Test::read(value, &format!("test[{i}]"));
            let tests = tests.map(test).collect::<Result<_>>()?;
            Ok((about, tests))
        };
        let (about, tests) = read().map_err(|error| document.locate(error))?;
        let calibration = |file: &String| Calibration::from_document(&Document::in_folder(&folder, file, &[])?);
        let calibration = about.calibration.as_ref().map(calibration).transpose()?;
        Ok(Set { name: name.to_owned(), about, tests, calibration, folder })
    }

    /// A built-in set; what it shares with another one lies beside its folder, as on disk.
    fn built_in(folder: &Dir) -> Result<Set> {
        let name = |file: &File| match file.path().strip_prefix(folder.path()) {
            Ok(own) => own.display().to_string(),
            Err(_) => format!("../{}", file.path().display()),
        };
        let at_hand = files(&SETS).into_iter().map(|file| (name(file), file.contents().to_vec()));
        Set::read(&folder.path().display().to_string(), Folder::at_hand(at_hand))
    }
}

fn files(folder: &'static Dir<'static>) -> Vec<&'static File<'static>> {
    folder.files().chain(folder.dirs().flat_map(files)).collect()
}

pub fn built_in() -> Vec<(String, String)> {
    sets(&[]).unwrap_or_default().into_iter().map(|set| (set.name, set.about.title)).collect()
}

/// The sets of these names or folders, all built-in ones where none is given.
/// Errors: what is neither; a set that cannot be read.
pub fn sets(wanted: &[String]) -> Result<Vec<Set>> {
    if wanted.is_empty() {
        return SETS.dirs().map(Set::built_in).collect();
    }
    let set = |name: &String| match SETS.dirs().find(|folder| folder.path() == Path::new(name)) {
        Some(folder) => Set::built_in(folder),
        None if Path::new(name).is_dir() => Set::read(name, Path::new(name).into()),
        None => Err(input(
            "NAME",
            name,
            "is neither a set of tests nor a folder",
            "give a folder with source.toml, or a name of `perilife list`",
        )),
    };
    wanted.iter().map(set).collect()
}
