//! A spectrum in words and figures: what a case was understood to load its plate with, how often its passes came; `spectrum.svg`.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::axis::Axis;
use super::chart::{COMPUTED, Frame, Size};
use super::format::{clean, short};
use super::specimen_picture::sketch::Sketch;
use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, StopReason};
use perilife_plate::loading::spectrum::Spectrum;
use perilife_plate::specimen::Point;

/// Shares of the largest load whose exceedances are told.
const LEVELS: [f64; 4] = [0.9, 0.75, 0.5, 0.25];

pub const BARS: usize = 20;
/// Levels of the maxima that are written, at the most.
const MAXIMA_MOST: usize = 200;

/// How often a pass has a maximum as large or larger, by falling maximum over the largest load, and how many of its cycles have a range in each of
/// equal parts of the largest range, all over the largest load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpectrumCurves {
    pub maxima: Vec<[f64; 2]>,
    pub largest_range: f64,
    pub cycles_by_range: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpectrumRecord {
    pub file: String,
    pub format: String,
    pub cycles_per_pass: f64,
    pub cycles_omitted_per_pass: f64,
    pub kinds_of_cycles: usize,
    pub classes_of_mean_rate: usize,
    pub largest: f64,
    pub smallest_over_largest: f64,
    pub stress_ratio_min: f64,
    pub stress_ratio_max: f64,
    pub repeats: Option<f64>,
    /// Share of the largest load, and maxima of a pass above it.
    pub exceedances: Vec<[f64; 2]>,
    pub curves: SpectrumCurves,
    pub truncated_at: Option<f64>,
    pub life_cycles_without_retardation: Option<f64>,
    pub retardation: Map<String, Value>,
}

/// Exceedances of a pass, at about so many levels, the last among them.
pub fn thinned(spectrum: &Spectrum, most: usize) -> Vec<(f64, f64)> {
    let levels = spectrum.exceedances();
    let each = levels.len().div_ceil(most);
    let kept = |place: &usize| place.is_multiple_of(each) || place + 1 == levels.len();
    (0..levels.len()).filter(kept).map(|place| levels[place]).collect()
}

pub fn curves(spectrum: &Spectrum) -> SpectrumCurves {
    let maxima = thinned(spectrum, MAXIMA_MOST).into_iter().map(|(level, count)| [clean(level), clean(count)]).collect();
    let (cycles, largest) = spectrum.ranges(BARS);
    SpectrumCurves { maxima, largest_range: clean(largest), cycles_by_range: cycles }
}

/// How many maxima of a pass are larger than each of the levels.
fn exceedances(spectrum: &Spectrum) -> [f64; 4] {
    LEVELS.map(|level| spectrum.cycles.iter().filter(|cycle| cycle.max > level).map(|cycle| cycle.count).sum())
}

pub fn more_words(case: &Case, spectrum: &Spectrum) -> String {
    let left_out = if spectrum.omitted > 0.0 { format!(" ({} more omitted)", short(spectrum.omitted)) } else { String::new() };
    let passes =
        spectrum.repeats.map_or_else(|| "repeated until failure".to_owned(), |passes| format!("{} passes", short(passes)));
    let levels = LEVELS.map(|level| short(100.0 * level)).join(", ");
    let above = exceedances(spectrum).map(short).join(", ");
    let retardation = case.retardation.as_ref().map_or_else(
        || "no load interaction (mean rate per pass)".to_owned(),
        |model| format!("retardation {}, underloads: {}", model.kind, model.kind.0.underload),
    );
    format!(
        "{} ({}): {} cycles a pass{left_out}, {} kinds, {passes}; above {levels} % of the largest: {above} a pass; {retardation}",
        spectrum.file,
        spectrum.format,
        short(spectrum.per_pass),
        spectrum.kinds
    )
}

/// Life over that without load interaction, infinite if nothing grows, with `≥ ` before a bound; `None` where it is not known: both runs may
/// have ended at the same limit of cycles, or in the first.
pub fn retarded(prediction: &Prediction) -> Option<(f64, &'static str)> {
    let is_cut_off = prediction.stop == StopReason::RunOut;
    let factor = prediction.life().unwrap_or(f64::INFINITY) / prediction.unretarded_cycles?;
    let is_known = !factor.is_nan() && (!is_cut_off || factor > 1.0);
    is_known.then_some((factor, if is_cut_off { "≥ " } else { "" }))
}

/// A pass, and the effect of load interaction on the life.
pub fn words(case: &Case, prediction: &Prediction) -> Option<String> {
    let spectrum = case.loading.spectrum.as_ref()?;
    let ratio = retarded(prediction).filter(|(ratio, _)| ratio.is_finite());
    let ratio = ratio.map_or_else(String::new, |(ratio, least)| format!(": {least}{ratio:.1} × the life without retardation"));
    let model = |kind| format!("{kind}{ratio}");
    let model = case.retardation.as_ref().map_or_else(|| "no load interaction".to_owned(), |found| model(found.kind));
    Some(format!("{} cycles per pass; {model}", short(spectrum.per_pass)))
}

/// Passes in a life; `None` without a spectrum, and of a life without end.
pub fn passes(case: &Case, prediction: &Prediction) -> Option<f64> {
    let spectrum = case.loading.spectrum.as_ref();
    spectrum.zip(prediction.life()).map(|(spectrum, life)| life / spectrum.per_pass)
}

impl SpectrumRecord {
    /// Of a run; `None` of one under other loads.
    pub fn of(case: &Case, prediction: &Prediction) -> Option<Self> {
        let spectrum = case.loading.spectrum.as_ref()?;
        let none = || Map::from_iter([("model".to_owned(), "none".into())]);
        Some(SpectrumRecord {
            file: spectrum.file.clone(),
            format: spectrum.format.to_string(),
            cycles_per_pass: clean(spectrum.per_pass),
            cycles_omitted_per_pass: clean(spectrum.omitted),
            kinds_of_cycles: spectrum.kinds,
            classes_of_mean_rate: spectrum.classes.iter().filter(|class| class.max > 0.0).count(),
            largest: clean(spectrum.largest[1]),
            smallest_over_largest: clean(spectrum.smallest()),
            stress_ratio_min: clean(spectrum.ratios[0]),
            stress_ratio_max: clean(spectrum.ratios[1]),
            repeats: spectrum.repeats,
            exceedances: LEVELS.iter().zip(exceedances(spectrum)).map(|(level, count)| [*level, clean(count)]).collect(),
            curves: curves(spectrum),
            truncated_at: (spectrum.largest[1] < spectrum.largest[0]).then(|| clean(spectrum.largest[1] / spectrum.largest[0])),
            life_cycles_without_retardation: prediction.unretarded_cycles.filter(|cycles| cycles.is_finite()),
            retardation: case.retardation.as_ref().map_or_else(none, |model| model.json()),
        })
    }
}

const BAR: f64 = 0.7;
const POINTS: usize = 400;

/// Exceedances of the maxima, left, and histogram of the ranges, right, of a pass.
pub fn spectrum_svg(spectrum: &Spectrum, size: Size) -> String {
    let half = Size { width: 0.5 * size.width, ..size };
    let mut picture = Sketch::new(1.0, [0.0; 2]);
    exceedances_frame(spectrum, half).beside(&mut picture, [0.0; 2]);
    ranges(spectrum, half).beside(&mut picture, [half.width, 0.0]);
    let sentence = format!("Exceedances and ranges of the {:.0} cycles of a pass", spectrum.per_pass);
    picture.picture([size.width, size.height], &sentence)
}

/// Maxima over how many of a pass are as large or larger, a stair.
fn exceedances_frame(spectrum: &Spectrum, size: Size) -> Frame {
    let mut stair: Vec<Point> = Vec::new();
    for (level, count) in thinned(spectrum, POINTS) {
        if let Some([before, _]) = stair.last().copied() {
            stair.push([before, level]);
        }
        stair.push([count, level]);
    }
    let counts = stair.iter().map(|point| point[0]);
    let axes = [Axis::logarithmic(counts), Axis::linear(stair.iter().map(|point| point[1]).chain([0.0]))];
    let mut frame = Frame::new(size, "", axes, ["Peak exceedances per pass", "Peak / maximum load"], &[]);
    frame.line(&stair, COMPUTED, 2.0, "");
    frame
}

/// Cycles of a pass by their range, over a logarithmic axis where they differ much.
fn ranges(spectrum: &Spectrum, size: Size) -> Frame {
    let (counts, largest) = spectrum.ranges(BARS);
    let some = || counts.iter().copied().filter(|count| *count > 0.0);
    let [low, high] = some().fold([f64::INFINITY, 0.0], |[low, high], count| [low.min(count), high.max(count)]);
    let floor = if high > 50.0 * low { 0.5 * low } else { 0.0 };
    let y = if floor > 0.0 { Axis::logarithmic_between(floor, 1.5 * high) } else { Axis::linear([0.0, high].into_iter()) };
    let axes = [Axis::linear_in([0.0, largest].into_iter(), 5.0), y];
    let mut frame = Frame::new(size, "", axes, ["Range / maximum load", "Cycles per pass"], &[]);
    let width = largest / BARS as f64;
    for (place, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0.0) {
        let [from, to] = [(place as f64 + 0.08) * width, (place as f64 + 0.92) * width];
        frame.band(&[[from, floor], [to, floor]], &[[from, *count], [to, *count]], BAR);
    }
    frame
}
