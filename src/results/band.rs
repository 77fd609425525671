//! The band of the lives of a run as it is written: columns of `a_n.csv`, keys of `result.json`, words, and the inspection interval.

use serde::Serialize;
use serde_json::{Value, json};

use super::checks;
use super::csv::{self, Row};
use super::resample::cycles_over_length;
use perilife_base::error::{Result, input};
use perilife_base::units::MM;
use perilife_calibration::population::intervals::Specimen;
use perilife_calibration::population::plate::{Left, NoBand, Plate, PlateBand, Quantiles};
use perilife_growth::case::{Case, Lot};
use perilife_growth::predict::Prediction;
use perilife_measured::MeasuredCurve;

/// Columns of a table of rows that have a band: cycles at which 5, 50 and 95 % of specimens have reached the length, and cycles that so
/// many do not live on from there to the end of the run.
pub const COLUMNS: [&str; 6] =
    ["cycles_p05", "cycles_p50", "cycles_p95", "remaining_cycles_p05", "remaining_cycles_p50", "remaining_cycles_p95"];
/// Whose the band is, in words: of any specimen of the lot, of the plate that was read.
const OF_SPECIMENS: &str = "90 % of specimens";
/// See [`OF_SPECIMENS`].
const OF_PLATE: &str = "90 % band";
/// Factor of the inspection interval: three looks before the end.
pub const FACTOR: f64 = 3.0;
/// Half widths of a band above which a life has so many significant digits, and those below.
const DIGITS: [(f64, usize); 2] = [(0.1, 2), (0.01, 3)];
/// Digits of a life that is known better.
const DIGITS_MOST: usize = 4;

/// Lives of a lot on a plate that was run, and what was asked about them.
#[derive(Debug, Clone)]
pub struct Lives {
    /// The plate with its band, or why there is none.
    pub band: std::result::Result<(Plate, PlateBand), NoBand>,
    is_lower_bound: bool,
    tips: Option<TipLengths>,
    rows: Vec<Row>,
    own: Option<Own>,
    inspection: Option<Inspection>,
}

/// What readings of the plate itself say.
#[derive(Debug, Clone)]
struct Own {
    specimen: Specimen,
    cycles: f64,
    left: Left,
    of_lot: Left,
}

/// What is left of a life from a crack length on, and an inspection interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Remaining))]
pub struct Inspection {
    /// Crack length today: of a plate that of the crack of `tip`.
    pub crack_length_mm: f64,
    /// The tip of a plate whose crack that is.
    pub tip: Option<usize>,
    /// Crack length of the curve then: in a plate of all cracks together.
    pub crack_length_of_all_mm: f64,
    /// Cycles at which the curve reaches that length.
    pub cycles_at: f64,
    /// Cycles at its end.
    pub life_cycles: f64,
    /// From there to the end.
    pub remaining_cycles: f64,
    /// Cycles that 5 % of specimens do not live on; null without a band.
    pub remaining_cycles_p05: Option<f64>,
    /// Median of the specimens.
    pub remaining_cycles_p50: Option<f64>,
    /// Cycles that 95 % do not live on.
    pub remaining_cycles_p95: Option<f64>,
    /// What the remaining life is divided by.
    pub factor: f64,
    /// The 5 % remaining life over the factor; without a band remaining cycles over the factor.
    pub inspection_interval_cycles: f64,
    /// Whether there is a band, from which the interval comes.
    pub has_band: bool,
    /// Whether the plate lives on where its curve ends: at a hole, where cracks have joined, or at stop.cycles_max.
    pub life_is_lower_bound: bool,
}

/// From which crack length on a plate is inspected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InspectFrom {
    /// Crack length, mm: in the convention of a standard specimen, in a plate the length of the crack of a tip.
    pub crack_length_mm: f64,
    /// The tip of a plate; the one that ends its life where it is left out.
    pub tip: Option<usize>,
    /// What the remaining life is divided by.
    pub factor: f64,
    /// What the user calls length, factor and tip.
    pub names: [&'static str; 3],
}

impl InspectFrom {
    /// Refuses a factor below 1.
    pub fn check(&self) -> Result<()> {
        if self.factor.is_finite() && self.factor >= 1.0 {
            return Ok(());
        }
        Err(input(self.names[1], self.factor, "is not 1 or more", format!("give for example {FACTOR}")))
    }
}

/// Lengths of the crack of every tip of a plate over the rows of its curve, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct TipLengths {
    /// By tip; empty of the end of a slot.
    lengths: Vec<Vec<f64>>,
    /// The tip that ends the life.
    leads: usize,
}

impl TipLengths {
    /// Of a run; `None` of a standard specimen, whose crack length is that of its convention.
    pub fn of_run(case: &Case, prediction: &Prediction) -> Option<Self> {
        let (leads, _) = prediction.leading_tip(&case.specimen)?;
        let of_tip = |tip: usize| {
            let lengths = prediction.curve.iter().map(|row| row.crack_length_of(&case.specimen, tip).map(|length| length / MM));
            lengths.collect::<Option<Vec<f64>>>().unwrap_or_default()
        };
        Some(TipLengths { lengths: (0..case.specimen.tips.len()).map(of_tip).collect(), leads })
    }

    /// Of the table of a run and `tips` of its `result.json`.
    pub fn of_table(text: &str, tips: &Value) -> Option<Self> {
        let tips = tips.as_array()?;
        let leads = tips.iter().position(|tip| tip["leads"] == true && !tip["crack"].is_null())?;
        let mut lines = text.lines();
        let head: Vec<&str> = lines.next()?.split(',').collect();
        let growth = |tip: usize| head.iter().position(|column| *column == format!("tip{tip}_growth_mm"));
        let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
        let of_tip = |tip: &Value| {
            let same = (0..tips.len()).filter(|other| tips[*other]["crack"] == tip["crack"]);
            let columns: Option<Vec<usize>> = same.map(growth).collect();
            let (Some(start), Some(columns)) = (tip["crack_length_initial_mm"].as_f64(), columns) else { return Vec::new() };
            let grown =
                |row: &Vec<&str>, column: usize| row.get(column).and_then(|field| field.parse::<f64>().ok()).unwrap_or(0.0);
            rows.iter().map(|row| start + columns.iter().map(|&column| grown(row, column)).sum::<f64>()).collect()
        };
        Some(TipLengths { lengths: tips.iter().map(of_tip).collect(), leads })
    }

    /// The tip that is meant, and the length of all cracks when its crack has the length that was asked for, linear between rows.
    /// Errors: no such tip, a length that its crack does not come to.
    fn of_all(&self, rows: &[Row], from: InspectFrom) -> Result<(usize, f64)> {
        let tip = from.tip.unwrap_or(self.leads);
        let Some(lengths) = self.lengths.get(tip).filter(|lengths| !lengths.is_empty()) else {
            let problem = format!("is no crack tip of this plate, which has {}", self.lengths.len());
            return Err(input(from.names[2], tip, problem, "count tips from 0, as in a_n.csv"));
        };
        let (shortest, longest) = (lengths[0], lengths[lengths.len() - 1]);
        let length = from.crack_length_mm;
        if !(shortest..=longest).contains(&length) {
            let problem = format!("is not on the curve: the crack of tip {tip} goes from {shortest:.4} to {longest:.4} mm");
            return Err(input(from.names[0], length, problem, "give a length between them, or another tip"));
        }
        let after = lengths.partition_point(|known| *known < length).clamp(1, lengths.len() - 1);
        let (a, b) = (lengths[after - 1], lengths[after]);
        let share = if b > a { (length - a) / (b - a) } else { 1.0 };
        let all = rows[after - 1].crack_length_mm + share * (rows[after].crack_length_mm - rows[after - 1].crack_length_mm);
        Ok((tip, all))
    }
}

impl Inspection {
    /// Of a curve with at least one row; `left` are the columns of [`COLUMNS`] that say what is left.
    /// Errors: a length that is not on the curve, a factor below 1, a tip that is none.
    pub fn of(
        rows: &[Row],
        tips: Option<&TipLengths>,
        left: Option<&[Quantiles]>,
        from: InspectFrom,
        is_lower_bound: bool,
    ) -> Result<Self> {
        from.check()?;
        let of_tip = tips.map(|tips| tips.of_all(rows, from)).transpose()?;
        if let (None, Some(tip)) = (of_tip, from.tip) {
            let problem = "belongs to plates with cracks of their own: this specimen has the crack length of its standard";
            return Err(input(from.names[2], tip, problem, "leave it out"));
        }
        let (length, end) = (of_tip.map_or(from.crack_length_mm, |(_, all)| all), rows[rows.len() - 1]);
        let (shortest, longest) = (rows[0].crack_length_mm, end.crack_length_mm);
        if !(shortest..=longest).contains(&length) {
            let problem = format!("is not on the curve, which goes from {shortest} to {longest} mm");
            return Err(input(from.names[0], length, problem, "give a length between them"));
        }
        let cycles_at = cycles_over_length(rows).at(length);
        let remaining = end.cycles - cycles_at;
        Ok(Inspection {
            crack_length_mm: from.crack_length_mm,
            tip: of_tip.map(|(tip, _)| tip),
            crack_length_of_all_mm: length,
            cycles_at,
            life_cycles: end.cycles,
            remaining_cycles: remaining,
            remaining_cycles_p05: None,
            remaining_cycles_p50: None,
            remaining_cycles_p95: None,
            factor: from.factor,
            inspection_interval_cycles: remaining / from.factor,
            has_band: false,
            life_is_lower_bound: is_lower_bound,
        }
        .with(left.and_then(|left| between(rows, left, length, remaining))))
    }

    /// The same with quantiles of the remaining life.
    fn with(self, quantiles: Option<Quantiles>) -> Self {
        let Some([low, middle, high]) = quantiles else { return self };
        Inspection {
            remaining_cycles_p05: Some(low),
            remaining_cycles_p50: Some(middle),
            remaining_cycles_p95: Some(high),
            inspection_interval_cycles: low / self.factor,
            has_band: true,
            ..self
        }
    }

    fn quantiles(&self) -> Option<Quantiles> {
        Some([self.remaining_cycles_p05?, self.remaining_cycles_p50?, self.remaining_cycles_p95?])
    }

    fn words(&self, whose: &str) -> Vec<String> {
        let (length, factor) = (self.crack_length_mm, self.factor);
        let [left, every] = match self.quantiles() {
            Some(quantiles) => {
                let digits = digits(&quantiles);
                [
                    words_of(&quantiles, whose),
                    format!(
                        "{} cycles: the 5 % remaining life over {factor}",
                        rounded_down(self.inspection_interval_cycles, digits)
                    ),
                ]
            }
            None => [
                format!("{} cycles", grouped(self.remaining_cycles.round())),
                format!("{} cycles: the remaining life over {factor}, no band", grouped(self.inspection_interval_cycles.floor())),
            ],
        };
        let least = if self.life_is_lower_bound { "at least " } else { "" };
        let of_tip = self.tip.map_or_else(String::new, |tip| format!(" of the crack of tip {tip}"));
        vec![format!("  remaining      {least}{left} from {length} mm{of_tip}"), format!("  inspection     every {every}")]
    }
}

/// Quantiles of what is left at a length between rows: their ratio to the cycles of the run is linear between them.
fn between(rows: &[Row], left: &[Quantiles], length: f64, remaining: f64) -> Option<Quantiles> {
    let end = rows[rows.len() - 1].cycles;
    let ratio = |i: usize| left[i].map(|cycles| cycles / (end - rows[i].cycles));
    let last = rows.iter().rposition(|row| row.cycles < end)?;
    let before = rows.partition_point(|row| row.crack_length_mm <= length).saturating_sub(1).min(last);
    let after = (before + 1).min(last);
    let (a, b) = (rows[before].crack_length_mm, rows[after].crack_length_mm);
    let share = if b > a { ((length - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
    let (from, to) = (ratio(before), ratio(after));
    let found = [0, 1, 2].map(|k| remaining * (from[k] + share * (to[k] - from[k])));
    found.iter().all(|cycles| cycles.is_finite()).then_some(found)
}

/// What is left at every row of a table that a run with a band wrote; `None` of one without.
pub fn left_of_table(text: &str) -> Option<Vec<Quantiles>> {
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next()?.split(',').collect();
    let place = |name: &str| head.iter().position(|column| *column == name);
    let places = [place(COLUMNS[3])?, place(COLUMNS[4])?, place(COLUMNS[5])?];
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        places.map(|place| fields.get(place).and_then(|field| field.parse().ok()).unwrap_or(f64::NAN))
    };
    Some(lines.map(row).collect())
}

impl Lives {
    /// Of a run.
    /// Errors: a record whose `[population]` is damaged.
    pub fn of(case: &Case, prediction: &Prediction) -> Result<Self> {
        let plate = Plate::of(case, prediction)?;
        Ok(Lives {
            band: plate.and_then(|plate| plate.band().map(|band| (plate, band))),
            is_lower_bound: checks::is_bound_below(case, prediction),
            tips: TipLengths::of_run(case, prediction),
            rows: prediction.curve.iter().map(Row::of).collect(),
            own: None,
            inspection: None,
        })
    }

    /// Takes readings of this very plate, set against its case.
    /// Errors: no band that they could narrow, readings that are not on the curve.
    pub fn narrow(&mut self, curve: &MeasuredCurve) -> Result<()> {
        let (plate, _) = self.band.as_ref().map_err(|why| no_band_to_narrow(curve, why))?;
        let specimen = plate.own(curve)?;
        let length = plate.read_to(&specimen);
        let (left, of_lot) = (plate.left(length, Some(&specimen))?, plate.left(length, None)?);
        let read = curve.crack_length.iter().zip(&curve.cycles).filter(|(a, _)| **a <= length * (1.0 + 1e-9));
        let cycles = read.map(|(_, n)| *n).fold(0.0, f64::max);
        self.own = Some(Own { specimen, cycles, left, of_lot });
        Ok(())
    }

    /// Looks at what is left from a length on.
    /// Errors: as [`Inspection::of`]; a length shorter than the last reading of the plate.
    pub fn inspect(&mut self, from: InspectFrom) -> Result<()> {
        let left = self.band.as_ref().ok().map(|(_, band)| &*band.left);
        let mut inspection = Inspection::of(&self.rows, self.tips.as_ref(), left, from, self.is_lower_bound)?;
        if let (Ok((plate, _)), Some(own)) = (&self.band, &self.own) {
            let left = plate.left(inspection.crack_length_of_all_mm * MM, Some(&own.specimen))?;
            inspection = inspection.with(Some(left.quantiles));
        }
        self.inspection = Some(inspection);
        Ok(())
    }

    /// What is left from the length that was asked for.
    pub fn inspection(&self) -> Option<&Inspection> {
        self.inspection.as_ref()
    }

    /// Band of the life.
    pub fn life(&self) -> Option<Quantiles> {
        self.band.as_ref().ok().and_then(|(_, band)| band.reached.last().copied())
    }

    /// Adds `band` and what was asked to the object of `result.json`.
    pub fn add_to(&self, result: &mut Value) {
        let Some(fields) = result.as_object_mut() else { return };
        let band = self.life().zip(self.band.as_ref().ok()).map(|([low, middle, high], (plate, band))| {
            json!({
                "cycles_p05": low,
                "cycles_p50": middle,
                "cycles_p95": high,
                "specimens": plate.lot.specimens.len(),
                "assumed_scatter": plate.lot.assumed_scatter,
                "share_outside": band.share_outside,
                "lot": plate.of.name(),
            })
        });
        fields.insert("band".to_owned(), json!(band));
        fields.insert("no_band".to_owned(), json!(self.band.as_ref().err()));
        if let Some(own) = &self.own {
            let quantiles = |left: &Left| json!({ COLUMNS[3]: left.quantiles[0], COLUMNS[4]: left.quantiles[1], COLUMNS[5]: left.quantiles[2] });
            let mut object = quantiles(&own.left);
            object["specimen"] = json!(own.specimen.name);
            object["intervals"] = json!(own.specimen.intervals.len());
            object["crack_length_mm"] = json!(own.left.crack_length / MM);
            object["cycles"] = json!(own.cycles);
            object["of_lot"] = quantiles(&own.of_lot);
            fields.insert("measured".to_owned(), object);
        }
        if let Some(inspection) = &self.inspection {
            fields.insert("inspection".to_owned(), json!(inspection));
        }
    }

    /// `a_n.csv` with the columns of the band at its end.
    pub fn beside(&self, table: String) -> String {
        let Ok((_, band)) = &self.band else { return table };
        let mut lines = table.lines();
        let mut text = format!("{},{}\n", lines.next().unwrap_or_default(), COLUMNS.join(","));
        for (line, (reached, left)) in lines.zip(band.reached.iter().zip(&band.left)) {
            let fields: Vec<String> = reached.iter().chain(left).map(|cycles| csv::exact(*cycles)).collect();
            text.push_str(&format!("{line},{}\n", fields.join(",")));
        }
        text
    }

    /// The life in words, with the digits that its band deserves; `None` without a band.
    pub fn life_words(&self) -> Option<String> {
        self.life().map(|quantiles| band_words(&quantiles))
    }

    /// What the band rests on, and what was asked, in lines of a summary.
    pub fn words(&self) -> Vec<String> {
        let mut lines = Vec::new();
        match &self.band {
            Ok((plate, band)) => {
                let assumed = if plate.lot.assumed_scatter { ", assumed scatter" } else { "" };
                let lot = if plate.of == Lot::Same { "their lot" } else { "another lot" };
                let count = plate.lot.specimens.len();
                let specimens = if count == 1 { "1 specimen".to_owned() } else { format!("{count} specimens") };
                let outside = match band.share_outside {
                    share if share > 0.0 => format!(", {:.1} % of it outside their ΔK", 100.0 * share),
                    _ => String::new(),
                };
                let run = self.rows.last().map_or(0.0, |row| row.cycles);
                lines.push(format!(
                    "  band           of {specimens}, {lot}{assumed}{outside}; the fitted constants alone give {run:.1}"
                ));
            }
            Err(why) => lines.push(format!("  band           none: {why}")),
        }
        if let Some(own) = &self.own {
            lines.push(format!(
                "  this plate     read to {:.3} mm at {:.0} cycles, left {}; by the lot alone {}",
                own.left.crack_length / MM,
                own.cycles,
                words_of(&own.left.quantiles, OF_PLATE),
                words_of(&own.of_lot.quantiles, OF_SPECIMENS)
            ));
        }
        let whose = if self.own.is_some() { OF_PLATE } else { OF_SPECIMENS };
        lines.extend(self.inspection.iter().flat_map(|inspection| inspection.words(whose)));
        lines
    }
}

/// Why readings narrow nothing.
pub fn no_band_to_narrow(curve: &MeasuredCurve, why: &str) -> perilife_base::error::Error {
    let remedy = "give a fitted record of several specimens of this material and stress ratio as fatigue.fitted";
    input("--measured", curve.source.file.display(), format!("cannot narrow the band of the life, which has none: {why}"), remedy)
}

/// Significant digits that a band deserves.
fn digits([low, middle, high]: &Quantiles) -> usize {
    let half = 0.5 * (high - low) / middle;
    DIGITS.iter().find(|(width, _)| half > *width).map_or(DIGITS_MOST, |(_, digits)| *digits)
}

/// A number of cycles rounded to some significant digits, thousands grouped.
fn rounded(cycles: f64, digits: usize) -> String {
    written(cycles, digits, f64::round)
}

/// The same rounded down: an interval is a promise.
fn rounded_down(cycles: f64, digits: usize) -> String {
    written(cycles, digits, f64::floor)
}

fn written(cycles: f64, digits: usize, to_whole: fn(f64) -> f64) -> String {
    if !(cycles.is_finite() && cycles > 0.0) {
        return format!("{cycles}");
    }
    let place = cycles.log10().floor() as i32 + 1 - digits as i32;
    let unit = 10f64.powi(place);
    if place < 0 {
        format!("{:.*}", place.unsigned_abs() as usize, to_whole(cycles / unit) * unit)
    } else {
        grouped(to_whole(cycles / unit) * unit)
    }
}

/// A whole number with its thousands apart.
fn grouped(whole: f64) -> String {
    let digits = format!("{whole:.0}");
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && digits.len() > 4 && (digits.len() - i) % 3 == 0 {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// `254 000 cycles (median; 90 % of specimens 228 000 to 283 000)`, with the digits that the band deserves.
pub fn band_words(quantiles: &Quantiles) -> String {
    words_of(quantiles, OF_SPECIMENS)
}

fn words_of(quantiles: &Quantiles, whose: &str) -> String {
    let digits = digits(quantiles);
    let [low, middle, high] = quantiles.map(|cycles| rounded(cycles, digits));
    format!("{middle} cycles (median; {whose} {low} to {high})")
}
