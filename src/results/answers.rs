//! What is asked of a run beside its life: inspections that may miss the crack, a fleet, what the life makes of somewhat other input.

use std::borrow::Cow;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::axis::Axis;
use super::band::{Lives, at};
use super::chart::{COMPUTED, INK, SECOND};
use super::checks::is_bound_below;
pub use super::fleet::Asked;
use super::fleet::FleetReport;
use super::format::{PLAIN, chance, clean, mm};
use super::output::write_file;
use super::specimen_picture::sketch::Sketch;
use perilife_base::columns::Table;
use perilife_base::error::Result;
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_calibration::population::plate::Quantiles;
use perilife_calibration::sweep::detection::Schedule;
use perilife_growth::case::{Case, Engine, LawSource, Stop};
use perilife_growth::predict::laws::growth_law;
use perilife_growth::predict::recorded::{Change, Recorded, RecordedLife};
use perilife_growth::predict::{CurvePoint, Prediction, Silent, StopReason, predict};

/// A run as the source of K(a) for other plates, continued beyond `stop.cycles_max` where that is quick.
fn whole<'p>(case: &Case, prediction: &'p Prediction, is_asked: bool) -> Cow<'p, Prediction> {
    let stop = Stop { cycles_max: f64::INFINITY, ..case.stop };
    let on = || predict(&Case { stop, ..case.clone() }, &Silent).ok();
    // On points and bonds it would take as long as the run again, and more.
    let is_quick = matches!(case.engine(), Engine::Handbook | Engine::PartThrough | Engine::Nodes);
    let on = (is_asked && is_quick && prediction.stop == StopReason::RunOut).then(on).flatten();
    on.map_or(Cow::Borrowed(prediction), Cow::Owned)
}

#[derive(Debug, Clone, Default)]
pub struct Answers {
    pub inspections: Option<InspectionsRecord>,
    pub fleet: Option<FleetReport>,
    pub sensitivities: Option<Sensitivities>,
}

impl Answers {
    /// Of a run; `lives` say when its plate is looked at and how its law scatters.
    /// Errors: a fleet in which nothing scatters, a run without K.
    pub fn of(case: &Case, prediction: &Prediction, lives: &Lives, asked: Asked) -> Result<Self> {
        let inspections = InspectionsRecord::of(case, prediction, lives, asked);
        let run = whole(case, prediction, case.fleet.is_some() || asked.sensitivities);
        let of_whole = if matches!(run, Cow::Owned(_)) { &Lives::of(case, &run, is_bound_below(case, &run))? } else { lives };
        let of_fleet = |fleet| FleetReport::of(case, fleet, (prediction, lives.inspection()), (&run, of_whole), asked);
        let fleet = case.fleet.as_ref().map(of_fleet).transpose()?;
        let sensitivities = asked.sensitivities.then(|| Sensitivities::of(case, &run)).transpose()?;
        Ok(Answers { inspections, fleet, sensitivities })
    }

    pub fn tables(&self) -> impl Iterator<Item = Table> {
        let fleet = self.fleet.iter().map(FleetReport::table);
        fleet.chain(self.sensitivities.iter().map(Sensitivities::table))
    }

    pub fn write(&self, folder: &Path, case: &Case) -> Result<()> {
        self.fleet.as_ref().map_or(Ok(()), |fleet| fleet.write(folder, case))?;
        self.sensitivities.as_ref().map_or(Ok(()), |sensitivities| sensitivities.write(folder, case))
    }

    /// 5 % and median life of a fleet, in words; `None` without one.
    pub fn headline(&self) -> Option<String> {
        self.fleet.as_ref().map(FleetReport::headline)
    }

    /// In lines of a summary; `known` says how well the interval of the inspections is known.
    pub fn words(&self, known: Option<Quantiles>) -> Vec<String> {
        let inspections = self.inspections.iter().zip(known).map(|(all, known)| all.words(&known));
        let sensitivities = self.sensitivities.iter().map(Sensitivities::words);
        inspections.chain(self.fleet.iter().flat_map(FleetReport::words)).chain(sensitivities).collect()
    }
}

/// `inspections` of a result: those of a run from a crack length on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InspectionsRecord {
    /// Crack lengths that are found with 50 and with 90 %.
    pub a50_mm: f64,
    pub a90_mm: f64,
    pub interval_cycles: f64,
    /// End of the life that they are of: that of the 5 % plate where there is a band.
    #[serde(default)]
    pub end_cycles: f64,
    #[serde(default)]
    pub first_inspection_cycles: f64,
    /// Probability that all of them miss the crack.
    pub missed: f64,
    pub rows: Vec<InspectionRow>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct InspectionRow {
    pub cycles: f64,
    /// Of the tip whose crack is inspected.
    pub crack_length_mm: f64,
    /// Probability that it is found now.
    pub pod: f64,
    /// Probability that it has been missed so far.
    pub missed: f64,
}

impl InspectionsRecord {
    /// Of a run: the first at the length that the plate is inspected from or after the cycles that are asked, the others by the interval; `None`
    /// where nobody asked. Cycles are those of the 5 % plate where there is a band: its crack takes the path of the run ([`Lives::inspected`]).
    pub fn of(case: &Case, prediction: &Prediction, lives: &Lives, asked: Asked) -> Option<Self> {
        let (detection, inspection, knots) = (asked.detection?, lives.inspection()?, lives.inspected()?);
        let cycles = |run: f64| at(&knots, run);
        let first = asked.first_inspection.unwrap_or_else(|| cycles(inspection.cycles_at));
        let schedule = Schedule { detection, cycles: [first, inspection.inspection_interval_cycles] };
        let of_tip = |row: &CurvePoint| inspection.tip.and_then(|tip| row.crack_length_of(&case.specimen, tip));
        let length = |row: &CurvePoint| of_tip(row).unwrap_or(row.crack_length);
        let (mut inspected, mut rows) = (schedule.begin(), Vec::new());
        for pair in prediction.curve.windows(2) {
            let mut told = |cycles, crack_length: f64, pod, missed| {
                rows.push(InspectionRow { cycles, crack_length_mm: clean(crack_length / MM), pod, missed });
            };
            let ([from, to], [start, end]) = ([pair[0].cycles, pair[1].cycles], [length(&pair[0]), length(&pair[1])]);
            let inner = knots.iter().map(|[run, _]| *run).filter(|run| from < *run && *run < to);
            let inner = inner.map(|run| (run, start + (run - from) / (to - from) * (end - start)));
            let places: Vec<(f64, f64)> = std::iter::once((from, start)).chain(inner).chain([(to, end)]).collect();
            for part in places.windows(2) {
                inspected.grow([cycles(part[0].0), cycles(part[1].0)], [part[0].1, part[1].1], &mut told);
            }
        }
        let [a50_mm, a90_mm] = [detection.a50, detection.a90].map(|length| clean(length / MM));
        let ([first_inspection_cycles, interval_cycles], end_cycles) = (schedule.cycles, knots.last()?[1]);
        let missed = rows.last().map_or(1.0, |row| row.missed);
        Some(InspectionsRecord { a50_mm, a90_mm, interval_cycles, end_cycles, first_inspection_cycles, missed, rows })
    }

    pub fn words(&self, known: &Quantiles) -> String {
        let first = PLAIN.promised(self.first_inspection_cycles, self.interval_cycles, known);
        let found = match (self.rows.len(), self.too_late()) {
            (_, Some(why)) => why,
            (count, None) => format!("{count} inspections, first at {first} cycles; all miss the crack: {}", chance(self.missed)),
        };
        let [half, most] = [self.a50_mm, self.a90_mm].map(|length| mm(length * MM));
        format!("  POD            {found} (independence assumed; a50 {half} mm, a90 {most} mm)")
    }

    fn too_late(&self) -> Option<String> {
        let [first, end] = [self.first_inspection_cycles, self.end_cycles].map(|cycles| PLAIN.whole(cycles));
        self.rows.is_empty().then(|| format!("first at {first} cycles, after the end of the inspected life at {end} cycles"))
    }

    /// Why the crack is never inspected.
    pub fn warning(&self) -> Option<String> {
        let remedy = "set an earlier --first-inspection, or remove it";
        self.too_late().map(|why| format!("inspections: {why}: the crack is never inspected (non-conservative); {remedy}"))
    }
}

pub const SENSITIVITIES_FILE: &str = "sensitivities.csv";
const LOAD: f64 = 0.05;
const LENGTH: f64 = 0.1;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SensitivityRecord {
    pub input: String,
    pub change: String,
    /// `None` of a life without end.
    pub life_cycles: Option<f64>,
    pub change_of_life_percent: Option<f64>,
    pub ended_by: StopReason,
    pub life_is_lower_bound: bool,
}

/// Lives at other inputs, that with the widest change first, downwards and upwards by turns.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivities(pub Vec<SensitivityRecord>);

impl Sensitivities {
    /// Of a run: load ±5 %, initial length ±10 %, and one standard error of rate and exponent of a fitted record.
    /// Errors: as [`Recorded::of`].
    pub fn of(case: &Case, prediction: &Prediction) -> Result<Self> {
        let (recorded, law, ratio) = (Recorded::of(case, prediction)?, growth_law(case)?, case.loading.ratio);
        let own = recorded.unchanged();
        let run = recorded.life(&*law, own).cycles;
        let finite = |value: f64| value.is_finite().then_some(value);
        let entry = |input: &str, change, life: RecordedLife| {
            let change_percent = 100.0 * (life.cycles / run - 1.0);
            let record = SensitivityRecord {
                input: input.to_owned(),
                change,
                life_cycles: finite(life.cycles),
                change_of_life_percent: finite(change_percent),
                ended_by: life.stop,
                life_is_lower_bound: life.is_bound,
            };
            (change_percent.abs(), record)
        };
        let mut all = Vec::new();
        for sign in [-1.0, 1.0] {
            let percent = |share: f64| format!("{:+.0} %", 100.0 * sign * share);
            let load = Change { load: 1.0 + sign * LOAD, ..own };
            all.push(entry("load", percent(LOAD), recorded.life(&*law, load)));
            let length = Change { crack_length: own.crack_length * (1.0 + sign * LENGTH), ..own };
            all.push(entry("initial crack length", percent(LENGTH), recorded.life(&*law, length)));
            let LawSource::Fitted(record) = &case.law else { continue };
            let pivot = record.pivot_delta_k_mpa_sqrt_m * MPA_SQRT_M / case.loading.range_share();
            let errors = [("growth rate", record.rate_at_pivot_relative_error, 0.0), ("exponent", 0.0, record.paris_m_error)];
            for (input, level, exponent) in errors.into_iter().filter(|(_, level, exponent)| level + exponent > 0.0) {
                let rate = |k: f64, _| law.rate(k, ratio) * (sign * level).exp() * (k / pivot).powf(sign * exponent);
                let change = format!("{}1 standard error ({:.3})", if sign < 0.0 { "-" } else { "+" }, level + exponent);
                all.push(entry(input, change, recorded.life_by(own, rate, |_, _| ())));
            }
        }
        all.sort_by(|a, b| a.1.input.cmp(&b.1.input));
        let mut pairs: Vec<&[(f64, SensitivityRecord)]> = all.chunk_by(|a, b| a.1.input == b.1.input).collect();
        let width = |pair: &[(f64, SensitivityRecord)]| pair.iter().map(|(size, _)| *size).fold(0.0, f64::max);
        pairs.sort_by(|a, b| width(b).total_cmp(&width(a)));
        Ok(Sensitivities(pairs.into_iter().flatten().map(|(_, record)| record.clone()).collect()))
    }

    fn pairs(&self) -> Vec<&[SensitivityRecord]> {
        self.0.chunk_by(|a, b| a.input == b.input).collect()
    }

    /// `sensitivities.csv`; no life where it is unlimited.
    pub fn table(&self) -> Table {
        let rows = &self.0;
        Table::new(SENSITIVITIES_FILE)
            .words("input", rows.iter().map(|row| &row.input))
            .words("change", rows.iter().map(|row| &row.change))
            .exact("life_cycles", rows.iter().map(|row| row.life_cycles))
            .exact("change_of_life_percent", rows.iter().map(|row| row.change_of_life_percent))
            .words("ended_by", rows.iter().map(|row| row.ended_by))
            .words("life_is_lower_bound", rows.iter().map(|row| row.life_is_lower_bound))
    }

    pub fn write(&self, folder: &Path, case: &Case) -> Result<()> {
        write_file(&folder.join("sensitivities.svg"), self.picture(&case.name).as_bytes())
    }

    /// A bar for each change from the life of the run on, the widest on top.
    fn picture(&self, name: &str) -> String {
        let [width, text, left, right, top, row] = [900.0, 14.0, 230.0, 70.0, 60.0, 46.0];
        let pairs = self.pairs();
        let known = self.0.iter().filter_map(|entry| entry.change_of_life_percent);
        let axis = Axis::linear_in(known.chain([0.0]), 8.0);
        let at = |value: f64| left + axis.share(value) * (width - left - right);
        let bottom = top + row * pairs.len() as f64;
        let mut sketch = Sketch::new(1.0, [0.0; 2]);
        let title = format!("{name}: change in life");
        sketch.name([8.0, 26.0], &title, "start", 1.15 * text, INK);
        for (place, pair) in pairs.iter().enumerate() {
            let middle = top + (place as f64 + 0.5) * row;
            sketch.name([left - 60.0, middle + 5.0], &pair[0].input, "end", text, INK);
            for (entry, colour) in pair.iter().zip([COMPUTED, SECOND]) {
                let Some(percent) = entry.change_of_life_percent else { continue };
                let (from, to, half) = (at(0.0), at(percent), 0.3 * row);
                let corners = [[from, middle - half], [to, middle - half], [to, middle + half], [from, middle + half]];
                sketch.area(&corners, colour, 0.8);
                let short = entry.change.split(' ').take(2).collect::<Vec<_>>().join(" ");
                let short = if entry.change.contains("error") { format!("{} s.e.", &entry.change[..2]) } else { short };
                let side = if to < from { ("end", -6.0) } else { ("start", 6.0) };
                // Words of bars without a length would stand on each other.
                if (to - from).abs() > 3.0 {
                    sketch.name([to + side.1, middle + 5.0], &short, side.0, 13.0, INK);
                }
            }
        }
        sketch.path(&[[at(0.0), top], [at(0.0), bottom]], INK, 1.0, "");
        sketch.path(&[[left, bottom], [width - right, bottom]], INK, 1.0, "");
        for (value, words) in axis.ticks() {
            sketch.path(&[[at(value), bottom], [at(value), bottom + 4.0]], INK, 1.0, "");
            sketch.name([at(value), bottom + 20.0], &words, "middle", text, INK);
        }
        sketch.name([width - right, bottom + 42.0], "Change in life, %", "end", text, INK);
        sketch.picture([width, bottom + 54.0], &format!("{title} by load, initial crack length and law, in percent"))
    }

    pub fn words(&self) -> String {
        let told = |entry: &SensitivityRecord| {
            let change = entry.change_of_life_percent.map(|change| format!("{} %", PLAIN.signed(change, 1)));
            format!("{} {}", entry.change, change.unwrap_or_else(|| "not available (unlimited life)".to_owned()))
        };
        let of_pair = |pair: &&[SensitivityRecord]| {
            format!("{} {}", pair[0].input, pair.iter().map(told).collect::<Vec<String>>().join(", "))
        };
        format!("  Sensitivities  {}", self.pairs().iter().map(of_pair).collect::<Vec<_>>().join("; "))
    }
}
