//! A fleet as it is written: `fleet.csv`, `fleet.svg`, `fleet` of `result.json`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use super::axis::Axis;
use super::band::{Lives as Band, every_words};
use super::chart::{COMPUTED, Frame, LARGE, Mark, SECOND};
use super::csv;
use super::inspections::Asked;
use super::model_words::{chance, clean};
use super::output::write_file;
use super::sweep::Lives;
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_calibration::inspection::Inspection;
use perilife_calibration::sweep::fleet::{self, FleetLives, FleetPlate, Looked, Looks};
use perilife_growth::case::{Case, Fleet};
use perilife_growth::predict::{CurvePoint, Prediction};
use perilife_plate::specimen::Point;

/// The table.
pub const FLEET_FILE: &str = "fleet.csv";
/// The picture.
pub const FLEET_CHART_FILE: &str = "fleet.svg";

/// Lives of a fleet with what they were drawn by.
#[derive(Debug, Clone)]
pub struct FleetReport {
    fleet: Fleet,
    lives: FleetLives,
    /// How it is looked at.
    looks: Option<Looks>,
    /// Life of the run, cycles.
    run: Option<f64>,
    /// Cycles in a pass of a spectrum.
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
            detectable: detectable(case, own, inspection),
            factor: inspection.factor,
            detection: asked.detection,
            first: asked.first_inspection,
        });
        let lives = fleet::lives(case, whole, fleet, band.band.as_ref().map(|(plate, _)| plate), looks)?;
        let per_pass = case.loading.spectrum.as_ref().map(|spectrum| spectrum.per_pass);
        Ok(FleetReport { fleet: *fleet, lives, looks, run: own.life(), per_pass })
    }

    fn ranked(&self) -> Lives {
        Lives::ranked(self.lives.plates.iter().map(|plate| (plate.life.cycles, plate.life.is_bound)))
    }

    fn clipped(&self) -> usize {
        self.lives.plates.iter().filter(|plate| plate.life.is_clipped).count()
    }

    /// Cycles from detectable to the end of every plate, ranked as their lives.
    fn windows(&self) -> Lives {
        Lives::ranked(self.lives.plates.iter().filter_map(|plate| Some((plate.window?[1], plate.life.is_bound))))
    }

    /// Plates that break before their crack is as long as can be found.
    fn never_found(&self) -> usize {
        self.lives.plates.iter().filter(|plate| plate.window.is_some_and(|[_, left]| left == 0.0)).count()
    }

    /// What inspections make of the fleet.
    fn looked_json(&self) -> Value {
        let Some(looks) = self.looks else { return Value::Null };
        let looked = self.lives.looked.as_ref();
        json!({
            "detectable_mm": clean(looks.detectable / MM),
            "factor": looks.factor,
            "detectable_to_critical_cycles": self.windows().figures(),
            "break_before_detectable": self.never_found(),
            "first_inspection_cycles": looked.map(|looked| looked.first),
            "break_before_first_inspection": looked.map(|looked| looked.before_first),
            "interval_cycles": looked.map(|looked| looked.every),
            "missed_after": looked.map_or(&[][..], |looked| &looked.missed_after),
        })
    }

    /// The object of `result.json`: quantiles as those of a sweep, unlimited and cut-off lives ranked behind the others.
    pub fn json(&self) -> Value {
        let ranked = self.ranked();
        let mut ends: BTreeMap<&str, usize> = BTreeMap::new();
        self.lives.plates.iter().for_each(|plate| *ends.entry(plate.life.stop.name()).or_default() += 1);
        json!({
            "plates": self.lives.plates.len(),
            "seed": self.fleet.seed,
            "life_cycles": ranked.figures(),
            "unlimited": ranked.unlimited,
            "lower_bounds": ranked.bounds,
            "shorter_than_known": self.clipped(),
            "ended_by": ends,
            "laws_drawn": self.lives.one_law.is_none(),
            "one_law_because": self.lives.one_law,
            "inspections": self.looked_json(),
            "missed": self.lives.looked.as_ref().map(|looked| looked.missed),
        })
    }

    /// `fleet.csv`: a row for each plate in the order in which they are drawn; no life where it is unlimited.
    pub fn table(&self) -> String {
        let mut text =
            "plate,initial_length_mm,load_factor,rate_factor,life_cycles,ended_by,life_is_lower_bound,critical_length_mm,\
                        detectable_to_critical_cycles,missed\n"
                .to_owned();
        for (i, plate) in self.lives.plates.iter().enumerate() {
            let FleetPlate { initial_length, load, rate_factor, life, critical_length, window, missed } = plate;
            let field = |value: Option<f64>| value.filter(|value| value.is_finite()).map_or_else(String::new, csv::exact);
            let (cycles, missed, window) = (field(Some(life.cycles)), field(*missed), field(window.map(|[_, left]| left)));
            let critical = field(critical_length.map(|length| length / MM));
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{cycles},{},{},{critical},{window},{missed}",
                i + 1,
                csv::exact(initial_length / MM),
                csv::exact(*load),
                csv::exact(*rate_factor),
                life.stop.name(),
                life.is_bound
            );
        }
        text
    }

    /// Writes table and picture into the folder of a run.
    pub fn write(&self, folder: &Path, case: &Case) -> Result<()> {
        write_file(&folder.join(FLEET_FILE), self.table().as_bytes())?;
        write_file(&folder.join(FLEET_CHART_FILE), self.picture(&case.name).as_bytes())
    }

    /// The share of plates that have ended by a life, and the life of the run.
    fn picture(&self, name: &str) -> String {
        let lives = self.ranked().sorted;
        let share = |i: usize| 100.0 * (i as f64 + 0.5) / lives.len() as f64;
        // One that goes on has not ended.
        let ended = lives.iter().enumerate().filter(|(_, (life, is_bound))| life.is_finite() && *life > 0.0 && !is_bound);
        let points: Vec<Point> = ended.map(|(i, (life, _))| [*life, share(i)]).collect();
        let axes =
            [Axis::logarithmic(points.iter().map(|point| point[0]).chain(self.run)), Axis::linear([0.0, 100.0].into_iter())];
        let plates = format!("{} of {} plates", points.len(), lives.len());
        let legend = [(Mark::Line, COMPUTED, &*plates), (Mark::Dashes, SECOND, "life of the run")];
        let names = ["Life N, cycles", "Share of plates that have ended, %"];
        let title = format!("{name}: lives of a fleet");
        let mut frame = Frame::new(LARGE, &title, axes, names, &legend[..if self.run.is_some() { 2 } else { 1 }]);
        frame.line(&points, COMPUTED, 2.0, "");
        self.run.iter().for_each(|&run| frame.line(&[[run, 0.0], [run, 100.0]], SECOND, 2.0, "8 5"));
        frame.finish(&format!("{title}: share of plates that have ended over cycles"))
    }

    /// 5 % and median life, which stand for the fleet.
    pub fn headline(&self) -> String {
        let [low, middle, _] = words_of(&self.ranked());
        format!("5 % life {low} cycles, median {middle} cycles ({} plates)", self.lives.plates.len())
    }

    /// Lines of a summary.
    pub fn words(&self) -> Vec<String> {
        let (ranked, count) = (self.ranked(), self.lives.plates.len());
        let [low, middle, high] = words_of(&ranked);
        let laws = if self.lives.one_law.is_some() { ", all of the law of the case" } else { "" };
        let mut lines = vec![format!(
            "  fleet          of {count} plates{laws}: 5 % end by {low}, half by {middle}, 95 % by {high} cycles; {} unlimited, {} cut off",
            ranked.unlimited, ranked.bounds
        )];
        if self.clipped() > 0 {
            lines.push(format!(
                "  fleet          {} plates begin with a crack shorter than K is known for: their lives are lower bounds; give the case a \
                 shorter crack",
                self.clipped()
            ));
        }
        lines.extend(self.looks.map(|looks| self.looked_words(looks)));
        lines
    }

    /// How long cracks can be found, and how likely they are not.
    fn looked_words(&self, looks: Looks) -> String {
        let [low, middle, high] = words_of(&self.windows());
        let length = looks.detectable / MM;
        let missed = match &self.lives.looked {
            Some(Looked { first, every, before_first, missed, .. }) => format!(
                "; all plates inspected after {first:.0} cycles, then every {}: all inspections miss the crack of a plate: {} ({before_first} \
                 plates break before the first)",
                every_words(*every, None, self.per_pass),
                chance(*missed)
            ),
            None if self.never_found() > 0 => format!("; {} plates break before", self.never_found()),
            None => String::new(),
        };
        format!("  fleet          from {length:.3} mm to the end 5 % take {low}, half {middle}, 95 % {high} cycles{missed}")
    }
}

/// 5 %, median and 95 % in words.
fn words_of(lives: &Lives) -> [String; 3] {
    let figures = lives.figures();
    ["p05", "p50", "p95"].map(|quantile| figures["words"][quantile].as_str().unwrap_or("unknown").to_owned())
}

/// Length of the crack that ends the life when the one that is inspected has its length, m: the way is that of the run.
fn detectable(case: &Case, prediction: &Prediction, inspection: &Inspection) -> f64 {
    let own = inspection.crack_length_mm * MM;
    let Some((leads, _)) =
        prediction.leading_tip(&case.specimen).filter(|(leads, _)| inspection.tip.is_some_and(|tip| tip != *leads))
    else {
        return own;
    };
    let rows = &prediction.curve;
    let after = rows.partition_point(|row| row.cycles < inspection.cycles_at).clamp(1, rows.len() - 1);
    let [from, to] = [&rows[after - 1], &rows[after]];
    let share = (inspection.cycles_at - from.cycles) / (to.cycles - from.cycles).max(f64::MIN_POSITIVE);
    let length = |row: &CurvePoint| row.crack_length_of(&case.specimen, leads).unwrap_or(own);
    length(from) + share.clamp(0.0, 1.0) * (length(to) - length(from))
}
