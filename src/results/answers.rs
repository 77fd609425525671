//! What is asked of a run beside its life: inspections that may miss the crack, a fleet, sensitivities.

use std::borrow::Cow;
use std::path::Path;

use super::band::Lives;
use super::checks::is_bound_below;
use super::fleet::FleetReport;
pub use super::inspections::Asked;
use super::inspections::InspectionsRecord;
use super::record::RunRecord;
use super::sensitivities::Sensitivities;
use perilife_base::columns::Table;
use perilife_base::error::Result;
use perilife_growth::case::{Case, Engine, Stop};
use perilife_growth::predict::{Prediction, Silent, StopReason, predict};

/// A run as the source of K(a) for other plates, continued beyond `stop.cycles_max` where that is quick.
fn whole<'p>(case: &Case, prediction: &'p Prediction, is_asked: bool) -> Cow<'p, Prediction> {
    let stop = Stop { cycles_max: f64::INFINITY, ..case.stop };
    let on = || predict(&Case { stop, ..case.clone() }, &Silent).ok();
    // On points and bonds it would take as long as the run again, and more.
    let is_quick = matches!(case.engine(), Engine::Handbook | Engine::PartThrough | Engine::Nodes);
    let on = (is_asked && is_quick && prediction.stop == StopReason::RunOut).then(on).flatten();
    on.map_or(Cow::Borrowed(prediction), Cow::Owned)
}

/// The answers, as far as they were asked for.
#[derive(Debug, Clone, Default)]
pub struct Answers {
    inspections: Option<InspectionsRecord>,
    fleet: Option<FleetReport>,
    sensitivities: Option<Sensitivities>,
}

impl Answers {
    /// Of a run; `lives` say when its plate is looked at and how its law scatters.
    /// Errors: a fleet in which nothing scatters, a run without K.
    pub fn of(case: &Case, prediction: &Prediction, lives: &Lives, asked: Asked) -> Result<Self> {
        let inspections = lives.inspection().and_then(|inspection| InspectionsRecord::of(case, prediction, inspection, asked));
        let run = whole(case, prediction, case.fleet.is_some() || asked.sensitivities);
        let of_whole = if matches!(run, Cow::Owned(_)) { &Lives::of(case, &run, is_bound_below(case, &run))? } else { lives };
        let of_fleet = |fleet| FleetReport::of(case, fleet, (prediction, lives.inspection()), (&run, of_whole), asked);
        let fleet = case.fleet.as_ref().map(of_fleet).transpose()?;
        let sensitivities = asked.sensitivities.then(|| Sensitivities::of(case, &run)).transpose()?;
        Ok(Answers { inspections, fleet, sensitivities })
    }

    /// Adds them to the record of the run.
    pub fn add_to(&self, record: &mut RunRecord) {
        record.inspections.clone_from(&self.inspections);
        record.fleet = self.fleet.as_ref().map(FleetReport::record);
        record.sensitivities = self.sensitivities.as_ref().map(Sensitivities::record);
    }

    pub fn tables(&self) -> impl Iterator<Item = Table> {
        let fleet = self.fleet.iter().map(FleetReport::table);
        fleet.chain(self.sensitivities.iter().map(Sensitivities::table))
    }

    /// Writes pictures into the folder of a run.
    pub fn write(&self, folder: &Path, case: &Case) -> Result<()> {
        self.fleet.as_ref().map_or(Ok(()), |fleet| fleet.write(folder, case))?;
        self.sensitivities.as_ref().map_or(Ok(()), |sensitivities| sensitivities.write(folder, case))
    }

    /// 5 % and median life of a fleet, in words; `None` without one.
    pub fn headline(&self) -> Option<String> {
        self.fleet.as_ref().map(FleetReport::headline)
    }

    /// Lines of a summary.
    pub fn words(&self) -> Vec<String> {
        let inspections = self.inspections.iter().map(InspectionsRecord::words);
        let sensitivities = self.sensitivities.iter().map(Sensitivities::words);
        inspections.chain(self.fleet.iter().flat_map(FleetReport::words)).chain(sensitivities).collect()
    }
}
