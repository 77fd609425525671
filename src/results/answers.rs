//! What is asked of a run beside its life: inspections that may miss the crack, a fleet, sensitivities.

use std::path::Path;

use serde_json::{Value, json};

use super::band::Lives;
use super::fleet::FleetReport;
use super::inspections::Inspections;
use super::sensitivities::Sensitivities;
use perilife_base::error::Result;
use perilife_calibration::sweep::detection::Detection;
use perilife_growth::case::Case;
use perilife_growth::predict::Prediction;

/// What is asked for; a fleet is by the section of the case.
#[derive(Debug, Clone, Copy, Default)]
pub struct Asked {
    /// How inspections find cracks.
    pub detection: Option<Detection>,
    /// Life at somewhat other input.
    pub sensitivities: bool,
}

/// The answers, as far as they were asked for.
#[derive(Debug, Clone, Default)]
pub struct Answers {
    inspections: Option<Inspections>,
    fleet: Option<FleetReport>,
    sensitivities: Option<Sensitivities>,
}

impl Answers {
    /// Of a run; `lives` say when its plate is looked at and how its law scatters.
    /// Errors: a fleet in which nothing scatters, a run without K.
    pub fn of(case: &Case, prediction: &Prediction, lives: &Lives, asked: Asked) -> Result<Self> {
        let inspections = lives.inspection().zip(asked.detection);
        let inspections = inspections.map(|(inspection, detection)| Inspections::of(case, prediction, inspection, detection));
        let fleet =
            case.fleet.as_ref().map(|fleet| FleetReport::of(case, prediction, fleet, lives, asked.detection)).transpose()?;
        let sensitivities = asked.sensitivities.then(|| Sensitivities::of(case, prediction)).transpose()?;
        Ok(Answers { inspections, fleet, sensitivities })
    }

    /// Adds `inspections`, `fleet` and `sensitivities` to the object of `result.json`.
    pub fn add_to(&self, result: &mut Value) {
        let objects = [
            ("inspections", self.inspections.as_ref().map(Inspections::json)),
            ("fleet", self.fleet.as_ref().map(FleetReport::json)),
            ("sensitivities", self.sensitivities.as_ref().map(Sensitivities::json)),
        ];
        objects
            .into_iter()
            .filter_map(|(key, object)| Some((key, object?)))
            .for_each(|(key, object)| result[key] = json!(object));
    }

    /// Writes tables and pictures into the folder of a run.
    pub fn write(&self, folder: &Path, case: &Case) -> Result<()> {
        self.fleet.as_ref().map_or(Ok(()), |fleet| fleet.write(folder, case))?;
        self.sensitivities.as_ref().map_or(Ok(()), |sensitivities| sensitivities.write(folder, case))
    }

    /// Lines of a summary.
    pub fn words(&self) -> Vec<String> {
        let inspections = self.inspections.iter().map(Inspections::words);
        let sensitivities = self.sensitivities.iter().map(Sensitivities::words);
        inspections.chain(self.fleet.iter().flat_map(FleetReport::words)).chain(sensitivities).collect()
    }
}
