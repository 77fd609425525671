//! What the life makes of somewhat other input: `sensitivities.csv` and a tornado, on the K(a) of the run ([`perilife_growth::predict::recorded`]).

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::axis::Axis;
use super::chart::{COMPUTED, INK, SECOND};
use super::output::write_file;
use super::specimen_picture::sketch::Sketch;
use perilife_base::columns::Table;
use perilife_base::error::Result;
use perilife_base::units::MPA_SQRT_M;
use perilife_growth::case::{Case, LawSource};
use perilife_growth::predict::laws::growth_law;
use perilife_growth::predict::recorded::{Change, Recorded, RecordedLife};
use perilife_growth::predict::{Prediction, StopReason};

pub const SENSITIVITIES_FILE: &str = "sensitivities.csv";
/// Share by which the load is changed.
const LOAD: f64 = 0.05;
/// Share by which the initial length is changed.
const LENGTH: f64 = 0.1;

/// The life at one other input.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    pub input: &'static str,
    /// By how much, in words.
    pub change: String,
    pub life: RecordedLife,
    /// By how much the life changes, share of that of the run; NaN where one is unlimited.
    pub change_of_life: f64,
}

/// An entry of `sensitivities` of a result.
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

/// Lives at other inputs, downwards and upwards by turns.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivities(pub Vec<Sensitivity>);

impl Sensitivities {
    /// Of a run: load ±5 %, initial length ±10 %, and one standard error of rate and exponent of a fitted record.
    /// Errors: as [`Recorded::of`].
    pub fn of(case: &Case, prediction: &Prediction) -> Result<Self> {
        let (recorded, law, ratio) = (Recorded::of(case, prediction)?, growth_law(case)?, case.loading.ratio);
        let own = recorded.unchanged();
        let run = recorded.life(&*law, own).cycles;
        let entry =
            |input, change, life: RecordedLife| Sensitivity { input, change, life, change_of_life: life.cycles / run - 1.0 };
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
        all.sort_by_key(|entry| entry.input);
        Ok(Sensitivities(all))
    }

    /// Inputs with their lowest and highest change of life, the widest first.
    fn widest(&self) -> Vec<&[Sensitivity]> {
        let mut pairs: Vec<&[Sensitivity]> = self.0.chunk_by(|a, b| a.input == b.input).collect();
        let width = |pair: &[Sensitivity]| pair.iter().map(|entry| entry.change_of_life.abs()).fold(0.0, f64::max);
        pairs.sort_by(|a, b| width(b).total_cmp(&width(a)));
        pairs
    }

    /// The list of the result, the widest first.
    pub fn record(&self) -> Vec<SensitivityRecord> {
        let finite = |value: f64| value.is_finite().then_some(value);
        let row = |entry: &Sensitivity| SensitivityRecord {
            input: entry.input.to_owned(),
            change: entry.change.clone(),
            life_cycles: finite(entry.life.cycles),
            change_of_life_percent: finite(100.0 * entry.change_of_life),
            ended_by: entry.life.stop,
            life_is_lower_bound: entry.life.is_bound,
        };
        self.widest().into_iter().flatten().map(row).collect()
    }

    /// `sensitivities.csv`; no life where it is unlimited.
    pub fn table(&self) -> Table {
        let rows = self.record();
        Table::new(SENSITIVITIES_FILE)
            .words("input", rows.iter().map(|row| &row.input))
            .words("change", rows.iter().map(|row| &row.change))
            .exact("life_cycles", rows.iter().map(|row| row.life_cycles))
            .exact("change_of_life_percent", rows.iter().map(|row| row.change_of_life_percent))
            .words("ended_by", rows.iter().map(|row| row.ended_by))
            .words("life_is_lower_bound", rows.iter().map(|row| row.life_is_lower_bound))
    }

    /// Writes its picture into the folder of a run.
    pub fn write(&self, folder: &Path, case: &Case) -> Result<()> {
        write_file(&folder.join("sensitivities.svg"), self.picture(&case.name).as_bytes())
    }

    /// A bar for each change from the life of the run on, the widest on top.
    fn picture(&self, name: &str) -> String {
        let [width, text, left, right, top, row] = [900.0, 14.0, 230.0, 70.0, 60.0, 46.0];
        let pairs = self.widest();
        let percent = |entry: &Sensitivity| 100.0 * entry.change_of_life;
        let known = self.0.iter().map(percent).filter(|value| value.is_finite());
        let axis = Axis::linear_in(known.chain([0.0]), 8.0);
        let at = |value: f64| left + axis.share(value) * (width - left - right);
        let bottom = top + row * pairs.len() as f64;
        let mut sketch = Sketch::new(1.0, [0.0; 2]);
        let title = format!("{name}: change in life");
        sketch.name([8.0, 26.0], &title, "start", 1.15 * text, INK);
        for (place, pair) in pairs.iter().enumerate() {
            let middle = top + (place as f64 + 0.5) * row;
            sketch.name([left - 60.0, middle + 5.0], pair[0].input, "end", text, INK);
            for (entry, colour) in pair.iter().zip([COMPUTED, SECOND]).filter(|(entry, _)| entry.change_of_life.is_finite()) {
                let (from, to, half) = (at(0.0), at(percent(entry)), 0.3 * row);
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

    /// A line of a summary.
    pub fn words(&self) -> String {
        let told = |change: f64| match change.is_finite() {
            true => format!("{:+.1} %", 100.0 * change),
            false => "not available (unlimited life)".to_owned(),
        };
        let of_pair = |pair: &&[Sensitivity]| {
            let changes: Vec<String> =
                pair.iter().map(|entry| format!("{} {}", entry.change, told(entry.change_of_life))).collect();
            format!("{} {}", pair[0].input, changes.join(", "))
        };
        format!("  Sensitivities  {}", self.widest().iter().map(of_pair).collect::<Vec<_>>().join("; "))
    }
}
