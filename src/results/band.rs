//! The band of the lives of a run as it is written: columns of `a_n.csv`, keys of `result.json`, words, and the inspection interval.

use serde_json::{Value, json};

use super::checks;
use super::csv::{self, Row};
use super::model_words::short;
use perilife_base::error::{Result, input};
use perilife_base::units::MM;
use perilife_calibration::inspection::{InspectFrom, Inspection, TipLengths};
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
/// Half widths of a band above which a life has so many significant digits, and those below.
const DIGITS: [(f64, usize); 2] = [(0.1, 2), (0.01, 3)];
/// Digits of a life that is known better.
const DIGITS_MOST: usize = 4;

/// Lives of a lot on a plate that was run, and what was asked about them.
#[derive(Debug, Clone)]
pub struct Lives {
    /// The plate with its band, or why there is none.
    pub band: std::result::Result<(Plate, PlateBand), NoBand>,
    /// Whether the case says which lot its plate is of.
    is_lot_given: bool,
    is_lower_bound: bool,
    tips: Option<TipLengths>,
    /// Cycles in a pass of a spectrum.
    per_pass: Option<f64>,
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
            is_lot_given: !case.echo["fatigue"]["lot"].is_null(),
            is_lower_bound: checks::is_bound_below(case, prediction),
            tips: TipLengths::of_run(case, prediction),
            per_pass: case.loading.spectrum.as_ref().map(|spectrum| spectrum.per_pass),
            rows: Row::of_run(case, prediction),
            own: None,
            inspection: None,
        })
    }

    /// Takes readings of this very plate, set against its case.
    /// Errors: no band that they could narrow, readings that are not on the curve.
    pub fn narrow(&mut self, curve: &MeasuredCurve) -> Result<()> {
        let (plate, _) = self.band.as_ref().map_err(|why| no_band_to_narrow(curve, why))?;
        let specimen = plate.own(curve)?;
        let length = plate.read_to(&specimen, curve);
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
        let mut inspection = Inspection::of(&csv::curve(&self.rows), self.tips.as_ref(), left, from, self.is_lower_bound)?;
        if let (Ok((plate, _)), Some(own)) = (&self.band, &self.own) {
            let left = plate.left(inspection.crack_length_governing_mm * MM, Some(&own.specimen))?;
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
                let other = if self.is_lot_given { "" } else { "; plate of another lot: fatigue.lot = \"other\"" };
                let count = plate.lot.specimens.len();
                let specimens = if count == 1 { "1 specimen".to_owned() } else { format!("{count} specimens") };
                let outside = match band.share_outside {
                    share if share > 0.0 => format!(", {:.1} % of it outside their ΔK", 100.0 * share),
                    _ => String::new(),
                };
                lines.push(format!("  band           of {specimens}, {lot}{assumed}{outside}{other}"));
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
        lines.extend(self.inspection.iter().flat_map(|inspection| inspection_words(inspection, whose, self.per_pass)));
        lines
    }
}

/// Lengths of the cracks of the tips, of the table of a run and `tips` of its `result.json`.
pub fn tip_lengths_of_table(text: &str, tips: &Value) -> Option<TipLengths> {
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
        let grown = |row: &Vec<&str>, column: usize| row.get(column).and_then(|field| field.parse::<f64>().ok()).unwrap_or(0.0);
        rows.iter().map(|row| start + columns.iter().map(|&column| grown(row, column)).sum::<f64>()).collect()
    };
    Some(TipLengths { lengths: tips.iter().map(of_tip).collect(), leads })
}

/// What an inspection says, in lines of a summary.
fn inspection_words(inspection: &Inspection, whose: &str, per_pass: Option<f64>) -> Vec<String> {
    let (length, factor, quantiles) = (short(inspection.crack_length_mm), inspection.factor, inspection.quantiles());
    let every = every_words(inspection.inspection_interval_cycles, quantiles.as_ref(), per_pass);
    let [left, every] = match quantiles {
        Some(quantiles) => [words_of(&quantiles, whose), format!("{every}: the 5 % remaining life over {factor}")],
        None => [
            format!("{} cycles", grouped(inspection.remaining_cycles.round())),
            format!("{every}: the remaining life over {factor}, no band"),
        ],
    };
    let least = if inspection.life_is_lower_bound { "at least " } else { "" };
    let of_tip = inspection.tip.map_or_else(String::new, |tip| format!(" of the crack of tip {tip}"));
    vec![format!("  remaining      {least}{left} from {length} mm{of_tip}"), format!("  inspection     every {every}")]
}

/// Why readings narrow nothing.
pub fn no_band_to_narrow(curve: &MeasuredCurve, why: &str) -> perilife_base::error::Error {
    let remedy = "give a fitted record of several specimens of this material and stress ratio as fatigue.fitted";
    input("--measured", curve.source.file.display(), format!("cannot narrow the band of the life, which has none: {why}"), remedy)
}

/// Significant digits that a band deserves.
pub fn digits([low, middle, high]: &Quantiles) -> usize {
    let half = 0.5 * (high - low) / middle;
    DIGITS.iter().find(|(width, _)| half > *width).map_or(DIGITS_MOST, |(_, digits)| *digits)
}

/// An interval rounded down, since it is a promise, to the digits that a band deserves, and its passes under a spectrum.
pub fn every_words(cycles: f64, band: Option<&Quantiles>, per_pass: Option<f64>) -> String {
    let whole = band.map_or_else(|| grouped(cycles.floor()), |band| written(cycles, digits(band), f64::floor));
    let passes =
        per_pass.map_or_else(String::new, |each| format!(" ({} passes)", short((100.0 * cycles / each).floor() / 100.0)));
    format!("{whole} cycles{passes}")
}

/// The interval of the object `inspection` of a result, as the console says it.
pub fn interval_of(result: &Value) -> Option<String> {
    let inspection = &result["inspection"];
    let [low, middle, high] = [3, 4, 5].map(|place| inspection[COLUMNS[place]].as_f64());
    let band = low.zip(middle).zip(high).map(|((low, middle), high)| [low, middle, high]);
    let cycles = inspection["inspection_interval_cycles"].as_f64()?;
    Some(every_words(cycles, band.as_ref(), result["spectrum"]["cycles_per_pass"].as_f64()))
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
    let [low, middle, high] = quantiles.map(|cycles| written(cycles, digits, f64::round));
    format!("{middle} cycles (median; {whose} {low} to {high})")
}
