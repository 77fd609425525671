//! A fleet as it is written: `fleet.csv`, `fleet.svg`, `fleet` of `result.json`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::axis::Axis;
use super::band::{Lives as Band, OF_FLEET, every_words};
use super::chart::{COMPUTED, Frame, LARGE, Mark, SECOND};
use super::format::{Format, PLAIN, chance, clean};
use super::output::write_file;
use super::sweep::{ABOVE, LifeQuantiles, Lives};
use perilife_base::columns::Table;
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_calibration::inspection::Inspection;
use perilife_calibration::sweep::detection::Detection;
use perilife_calibration::sweep::fleet::{self, FleetLives, FleetPlate, Looked, Looks};
use perilife_growth::case::{Case, Fleet};
use perilife_growth::predict::Prediction;
use perilife_plate::specimen::Point;

/// What is asked for; a fleet is by the section of the case.
#[derive(Debug, Clone, Copy, Default)]
pub struct Asked {
    pub detection: Option<Detection>,
    pub first_inspection: Option<f64>,
    /// Life at somewhat other input.
    pub sensitivities: bool,
}

pub const FLEET_FILE: &str = "fleet.csv";
pub const FLEET_CHART_FILE: &str = "fleet.svg";

/// `fleet` of a result: quantiles as those of a sweep, unlimited and cut-off lives ranked behind the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetRecord {
    pub plates: usize,
    pub seed: u64,
    pub life_cycles: LifeQuantiles,
    pub unlimited: usize,
    pub lower_bounds: usize,
    pub shorter_than_known: usize,
    pub ended_by: BTreeMap<String, usize>,
    pub laws_drawn: bool,
    pub one_law_because: Option<String>,
    pub inspections: Option<FleetInspections>,
    /// Probability that all inspections miss the crack of a plate.
    pub missed: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetInspections {
    pub detectable_mm: f64,
    pub factor: f64,
    pub detectable_to_critical_cycles: LifeQuantiles,
    pub break_before_detectable: usize,
    pub first_inspection_cycles: Option<f64>,
    pub break_before_first_inspection: Option<usize>,
    pub interval_cycles: Option<f64>,
    pub missed_after: Vec<f64>,
}

impl FleetInspections {
    /// Interval, cycles: as planned with a POD, else that of the plate at 5 %.
    pub fn interval(&self) -> Option<f64> {
        self.interval_cycles.or_else(|| self.detectable_to_critical_cycles.p05.map(|left| left / self.factor))
    }
}

#[derive(Debug, Clone)]
pub struct FleetReport {
    pub record: FleetRecord,
    lives: FleetLives,
    /// Lives in their order.
    ranked: Lives,
    /// Life of the run, cycles.
    run: Option<f64>,
    per_pass: Option<f64>,
}

impl FleetReport {
    /// Of a run with its lives, and of the same run as K(a) is recorded from.
    /// Errors: as [`fleet::lives`].
    pub fn of(
        case: &Case,
        fleet: &Fleet,
        (own, inspection): (&Prediction, Option<&Inspection>),
        (whole, band): (&Prediction, &Band),
        asked: Asked,
    ) -> Result<Self> {
        let looks = inspection.map(|inspection| Looks {
            detectable: inspection.crack_length_governing_mm * MM,
            factor: inspection.factor,
            detection: asked.detection,
            first: asked.first_inspection,
        });
        let lives = fleet::lives(case, whole, fleet, band.band.as_ref().map(|(plate, _)| plate), looks)?;
        let (plates, looked) = (&lives.plates, lives.looked.as_ref());
        let ranked = Lives::ranked(plates.iter().map(|plate| (plate.life.cycles, plate.life.is_bound)));
        // Cycles from detectable to the end of every plate, ranked as their lives.
        let windows = Lives::ranked(plates.iter().filter_map(|plate| Some((plate.window?[1], plate.life.is_bound))));
        let count = |is: fn(&FleetPlate) -> bool| plates.iter().filter(|plate| is(plate)).count();
        let inspections = looks.map(|looks| FleetInspections {
            detectable_mm: clean(looks.detectable / MM),
            factor: looks.factor,
            detectable_to_critical_cycles: windows.figures(),
            break_before_detectable: count(|plate| plate.window.is_some_and(|[_, left]| left == 0.0)),
            first_inspection_cycles: looked.map(|looked| looked.first),
            break_before_first_inspection: looked.map(|looked| looked.before_first),
            interval_cycles: looked.map(|looked| looked.every),
            missed_after: looked.map_or_else(Vec::new, |looked| looked.missed_after.clone()),
        });
        let mut ended_by: BTreeMap<String, usize> = BTreeMap::new();
        plates.iter().for_each(|plate| *ended_by.entry(plate.life.stop.name().to_owned()).or_default() += 1);
        let record = FleetRecord {
            plates: plates.len(),
            seed: fleet.seed,
            life_cycles: ranked.figures(),
            unlimited: ranked.unlimited,
            lower_bounds: ranked.bounds,
            shorter_than_known: count(|plate| plate.life.is_clipped),
            ended_by,
            laws_drawn: lives.one_law.is_none(),
            one_law_because: lives.one_law.clone(),
            inspections,
            missed: looked.map(|looked| looked.missed),
        };
        let per_pass = case.loading.spectrum.as_ref().map(|spectrum| spectrum.per_pass);
        Ok(FleetReport { record, lives, ranked, run: own.life(), per_pass })
    }

    /// `fleet.csv`: a row for each plate in the order in which they are drawn; no life where it is unlimited.
    pub fn table(&self) -> Table {
        let plates = &self.lives.plates;
        let numbers = |of: &dyn Fn(&FleetPlate) -> f64| {
            let finite = |value: f64| if value.is_finite() { value } else { f64::NAN };
            plates.iter().map(|plate| finite(of(plate))).collect::<Vec<_>>()
        };
        Table::new(FLEET_FILE)
            .counts("plate", 1..=plates.len())
            .exact("initial_length_mm", numbers(&|plate| plate.initial_length / MM))
            .exact("load_factor", numbers(&|plate| plate.load))
            .exact("rate_factor", numbers(&|plate| plate.rate_factor))
            .exact("life_cycles", numbers(&|plate| plate.life.cycles))
            .words("ended_by", plates.iter().map(|plate| plate.life.stop))
            .words("life_is_lower_bound", plates.iter().map(|plate| plate.life.is_bound))
            .exact("critical_length_mm", numbers(&|plate| plate.critical_length.map_or(f64::NAN, |length| length / MM)))
            .exact("detectable_to_critical_cycles", numbers(&|plate| plate.window.map_or(f64::NAN, |[_, left]| left)))
            .exact("missed", numbers(&|plate| plate.missed.unwrap_or(f64::NAN)))
    }

    pub fn write(&self, folder: &Path, case: &Case) -> Result<()> {
        write_file(&folder.join(FLEET_CHART_FILE), self.picture(&case.name).as_bytes())
    }

    /// The share of plates that have ended by a life, and the life of the run.
    fn picture(&self, name: &str) -> String {
        let lives = &self.ranked.sorted;
        let share = |i: usize| 100.0 * (i as f64 + 0.5) / lives.len() as f64;
        // One that goes on has not ended.
        let ended = lives.iter().enumerate().filter(|(_, (life, is_bound))| life.is_finite() && *life > 0.0 && !is_bound);
        let points: Vec<Point> = ended.map(|(i, (life, _))| [*life, share(i)]).collect();
        let axes =
            [Axis::logarithmic(points.iter().map(|point| point[0]).chain(self.run)), Axis::linear([0.0, 100.0].into_iter())];
        let plates = format!("{} of {} plates", points.len(), lives.len());
        let legend = [(Mark::Line, COMPUTED, &*plates), (Mark::Dashes, SECOND, "life with nominal inputs")];
        let names = ["Life N, cycles", "Failed plates, %"];
        let title = format!("{name}: lives of a fleet");
        let mut frame = Frame::new(LARGE, &title, axes, names, &legend[..if self.run.is_some() { 2 } else { 1 }]);
        frame.line(&points, COMPUTED, 2.0, "");
        self.run.iter().for_each(|&run| frame.line(&[[run, 0.0], [run, 100.0]], SECOND, 1.2, "8 5"));
        let marks = [(self.record.life_cycles.p05, "5 %"), (self.record.life_cycles.p50, "median")];
        marks.into_iter().filter_map(|(life, name)| Some((life?, name))).for_each(|(life, name)| frame.mark(life, name));
        frame.finish(&format!("{title}: failed plates against cycles"))
    }

    /// 5 % and median life.
    pub fn headline(&self) -> String {
        let [low, middle, _] = words_of(&self.record.life_cycles, PLAIN);
        format!("life 5 % {low}, median {middle} cycles ({} plates)", self.record.plates)
    }

    pub fn words(&self) -> Vec<String> {
        let FleetRecord { unlimited, lower_bounds, shorter_than_known: clipped, .. } = self.record;
        let [_, _, high] = words_of(&self.record.life_cycles, PLAIN);
        let laws = if self.record.laws_drawn { "" } else { "; one growth law for all" };
        let mut lines =
            vec![format!("  Fleet          95 % {high} cycles; {unlimited} unlimited, {lower_bounds} lower bounds{laws}")];
        if clipped > 0 {
            lines.push(format!(
                "  Fleet          {clipped} plates start below the shortest computed crack: their lives are lower bounds; start the case \
                 with a shorter crack"
            ));
        }
        lines.extend(self.record.inspections.as_ref().map(|looks| self.looked_words(looks)));
        lines
    }

    /// How long cracks can be found, and how likely they are not.
    fn looked_words(&self, looks: &FleetInspections) -> String {
        let [low, middle, high] = words_of(&looks.detectable_to_critical_cycles, PLAIN);
        let (length, never_found) = (PLAIN.length(looks.detectable_mm * MM, 3), looks.break_before_detectable);
        let missed = match &self.lives.looked {
            Some(Looked { first, every, before_first, missed, .. }) => format!(
                "; inspected after {} cycles, then every {}: all miss the crack of a plate: {} ({before_first} plates fail before the \
                 first)",
                PLAIN.promised(*first, *first, &OF_FLEET),
                every_words(*every, &OF_FLEET, self.per_pass),
                chance(*missed)
            ),
            None if never_found > 0 => format!("; {never_found} plates fail before a detectable crack"),
            None => String::new(),
        };
        format!("  Fleet          from a = {length} to the end: 5 % {low}, median {middle}, 95 % {high} cycles{missed}")
    }
}

/// 5 %, median and 95 % in words.
pub fn words_of(lives: &LifeQuantiles, format: Format) -> [String; 3] {
    [&lives.words.p05, &lives.words.p50, &lives.words.p95].map(|words| {
        let words = words.as_deref().unwrap_or("unknown");
        let (above, figure) = words.split_at(if words.starts_with(ABOVE) { ABOVE.len() } else { 0 });
        figure.parse::<f64>().map_or_else(|_| words.to_owned(), |life| format!("{above}{}", format.by_band(life, &OF_FLEET)))
    })
}
