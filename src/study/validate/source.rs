//! Sets of tests: `source.toml` says where a set comes from, and what was measured.

use std::path::Path;

use include_dir::{Dir, File, include_dir};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{Document, Folder, Sections, slice};
use perilife_base::kinds;
use perilife_calibration::calibrate::Calibration;
use perilife_plate::specimen::Point;
use serde::Deserialize;
use toml::Value;

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

/// Section `[source]`.
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

/// An entry of `[[test]]`.
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
    /// Points of the measured path, mm.
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

/// Names and titles of the built-in sets.
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
