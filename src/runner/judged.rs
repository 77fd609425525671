//! A run of cycles with all that was found about it.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::{Summary, Wanted, Watcher};
use perilife_base::error::{Error, Result};
use perilife_growth::case::Case;
use perilife_growth::predict::residual_strength::{Strength, residual_strength};
use perilife_growth::predict::{Prediction, judgement};
use perilife_results::answers::Answers;
use perilife_results::band::Lives;
use perilife_results::checks;
use perilife_results::quality::Quality;
use perilife_results::run::{self, Kept};
use perilife_results::units::show_folder;

/// What was found about a run.
#[derive(Debug)]
pub struct Judged {
    /// Its figures and tables.
    pub kept: Kept,
    /// Its life and band, and what was asked of them.
    pub lives: Lives,
    quality: Quality,
    answers: Answers,
    strengths: Option<Vec<Strength>>,
    warnings: Vec<String>,
    refusal: Option<Error>,
}

impl Judged {
    /// Of a run, of which the watcher is told what the user should know.
    /// Errors: as [`judgement::judge`]; a damaged record.
    pub fn of(case: &Case, prediction: &Prediction, wanted: &Wanted, watcher: &dyn Watcher) -> Result<Self> {
        // What a check says in a line stands in the file at length.
        let told = run::told_by_checks(case, prediction);
        let warn = |warnings: &[String]| warnings.iter().filter(|line| !told.contains(line)).for_each(|line| watcher.warn(line));
        warn(&prediction.warnings);
        let judged = judgement::judge(case, prediction)?;
        warn(&judged);
        checks::lines(&checks::of_run(case, prediction)).iter().for_each(|line| watcher.warn(line));
        // If that fails, the run itself is written all the same.
        let strengths = wanted.strength.then(|| residual_strength(case, &prediction.curve)).transpose();
        let mut lives = Lives::of(case, prediction)?;
        let quality = Quality::of(case, prediction, [!wanted.no_estimate, wanted.cross_check]);
        let asked = wanted.readings.as_ref().map_or(Ok(()), |curve| lives.narrow(curve));
        // A length that the crack never has is wrong input, and no result is written for it.
        if asked.is_ok() {
            wanted.inspection.map_or(Ok(()), |from| lives.inspect(from))?;
        }
        let answered = asked.and_then(|()| Answers::of(case, prediction, &lives, wanted.asked));
        let (answers, asked) = match answered {
            Ok(answers) => (answers, Ok(())),
            Err(error) => (Answers::default(), Err(error)),
        };
        let kept = Kept::of(case, prediction, (&lives, &quality, &answers));
        let refusal = judgement::refusal(case, prediction);
        let mut warnings: Vec<String> = refusal.iter().map(Error::to_string).collect();
        let listed = kept.result["warnings"].as_array().into_iter().flatten();
        warnings.extend(listed.filter_map(|warning| Some(warning.as_str()?.to_owned())));
        let (strengths, missed) = match strengths {
            Ok(strengths) => (strengths, None),
            Err(error) => (None, Some(error)),
        };
        let refusal = refusal.or(missed).or(asked.err());
        Ok(Judged { kept, lives, quality, answers, strengths, warnings, refusal })
    }

    /// Writes its files into an empty folder.
    /// Errors: files that cannot be written.
    pub fn write(&self, folder: &Path, case: &Case, prediction: &Prediction) -> Result<()> {
        run::write(folder, case, prediction, &self.answers, &self.kept)?;
        self.strengths.as_ref().map_or(Ok(()), |strengths| run::write_strength(folder, case, strengths))
    }

    /// Brings its files and itself into the units that are shown.
    /// Errors: files that cannot be read or written.
    pub(super) fn show(&mut self, folder: &Path) -> Result<()> {
        show_folder(folder, &mut self.kept.result)
    }

    /// The residual strength over crack length as a table, where it was asked for.
    pub fn strength_table(&self, case: &Case) -> Option<String> {
        self.strengths.as_ref().map(|strengths| run::strength_table(case, strengths))
    }

    /// Takes out why the run does not count, if it does not.
    pub fn take_refusal(&mut self) -> Option<Error> {
        self.refusal.take()
    }

    /// The result in words.
    pub fn words(&self, case: &Case, prediction: &Prediction) -> Vec<String> {
        let mut lines = run::words(case, prediction, &self.lives, &self.quality);
        if let Some(fleet) = self.answers.headline().filter(|_| self.refusal.is_none()) {
            // The run is one plate, and may live longer than all of a fleet.
            let (name, run) = lines[0].split_at(case.name.len() + 2);
            lines.splice(..1, [format!("{name}fleet, {fleet}"), format!("  this run       {run}: the plate of the case alone")]);
        }
        lines.extend(self.answers.words());
        lines
    }

    /// What is told of it where it ran.
    pub(super) fn summary(mut self, case: &Case, prediction: &Prediction) -> Summary {
        let (lines, refusal, result) = (self.words(case, prediction), self.take_refusal(), self.kept.result);
        let figures = run::FIGURES.iter().filter_map(|key| Some(((*key).to_owned(), result.get(*key)?.clone())));
        let mut figures: Map<String, Value> = figures.collect();
        figures.insert("warnings".to_owned(), json!(self.warnings));
        Summary { result, figures: figures.into(), lines, refusal, ..Summary::default() }
    }
}
