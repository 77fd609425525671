//! The band of the lives of a run, what readings of the plate itself say, the inspection interval; numerical error, and the life by another method.

use serde::{Deserialize, Serialize};

use super::checks::NONE_PERCENT;
use super::curve::{Row, curve};
use super::format::{PLAIN, digits, short, two_digits, within};
use perilife_base::error::{Result, input};
use perilife_base::monotone::Monotone;
use perilife_base::units::MM;
use perilife_calibration::inspection::{InspectFrom, Inspection, TipLengths};
use perilife_calibration::population::intervals::Specimen;
use perilife_calibration::population::plate::{Left, NoBand, Plate, PlateBand, Quantiles};
use perilife_growth::case::{Case, Lot, Method, Model, coarse_points, usual_nodes};
use perilife_growth::predict::error_estimate::{ErrorEstimate, estimate};
use perilife_growth::predict::fit_use::life_share_extrapolated;
use perilife_growth::predict::moment::StressField;
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_measured::MeasuredCurve;

/// `band` of a result: cycles that 5, 50 and 95 % of specimens do not reach, and what they rest on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BandRecord {
    pub cycles_p05: f64,
    pub cycles_p50: f64,
    pub cycles_p95: f64,
    pub specimens: usize,
    pub assumed_scatter: bool,
    /// Share of the life outside their ΔK.
    pub share_outside: f64,
    pub lot: Lot,
}

impl BandRecord {
    pub fn cycles(&self) -> Quantiles {
        [self.cycles_p05, self.cycles_p50, self.cycles_p95]
    }
}

/// Figures of a fleet have four digits.
pub const OF_FLEET: Quantiles = [1.0; 3];

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Remaining {
    pub remaining_cycles_p05: f64,
    pub remaining_cycles_p50: f64,
    pub remaining_cycles_p95: f64,
}

/// `measured` of a result: what readings of the plate itself say.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OwnRecord {
    #[serde(flatten)]
    pub left: Remaining,
    pub specimen: String,
    pub intervals: usize,
    pub crack_length_mm: f64,
    pub cycles: f64,
    pub of_lot: Remaining,
}

/// Lives of a lot on a plate that was run, and what was asked about them.
#[derive(Debug, Clone)]
pub struct Lives {
    pub band: std::result::Result<(Plate, PlateBand), NoBand>,
    /// Whether the case says which lot its plate is of.
    is_lot_given: bool,
    is_lower_bound: bool,
    /// Share of the life outside the tested ΔK.
    share_outside: Option<f64>,
    tips: Option<TipLengths>,
    per_pass: Option<f64>,
    rows: Vec<Row>,
    own: Option<Own>,
    inspection: Option<Inspection>,
}

#[derive(Debug, Clone)]
struct Own {
    specimen: Specimen,
    cycles: f64,
    left: Left,
    of_lot: Left,
}

impl Lives {
    /// Of a run.
    /// Errors: a record whose `[population]` is damaged.
    pub fn of(case: &Case, prediction: &Prediction, is_lower_bound: bool) -> Result<Self> {
        let plate = Plate::of(case, prediction)?;
        Ok(Lives {
            band: plate.and_then(|plate| plate.band().map(|band| (plate, band))),
            is_lot_given: !case.echo["fatigue"]["lot"].is_null(),
            is_lower_bound,
            share_outside: life_share_extrapolated(case, prediction),
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
        let mut inspection = Inspection::of(&curve(&self.rows), self.tips.as_ref(), left, from, self.is_lower_bound)?;
        if let (Ok((plate, _)), Some(own)) = (&self.band, &self.own) {
            let left = plate.left(inspection.crack_length_governing_mm * MM, Some(&own.specimen))?;
            inspection = inspection.with(Some(left.quantiles));
        }
        self.inspection = Some(inspection);
        Ok(())
    }

    pub fn inspection(&self) -> Option<&Inspection> {
        self.inspection.as_ref()
    }

    /// Cycles of the run and those of the plate that is inspected, straight between them: at the start, the last reading of the plate itself, the
    /// length that it is inspected from, and the end. That plate is the 5 % plate where there is a band.
    pub fn inspected(&self) -> Option<Vec<[f64; 2]>> {
        let inspection = self.inspection.as_ref()?;
        let (run, life) = (inspection.cycles_at, inspection.life_cycles);
        let mut knots = vec![[0.0; 2]];
        let reached = match (&self.band, &self.own) {
            (Ok(_), Some(own)) => {
                let read = [life - own.left.cycles, own.cycles];
                knots.push(read);
                read[1] + own.left.quantiles[0] / own.left.cycles * (run - read[0])
            }
            (Ok((_, band)), None) => {
                Monotone::new(self.rows.iter().zip(&band.reached).map(|(row, reached)| [row.cycles, reached[0]])).at(run)
            }
            (Err(_), _) => run,
        };
        knots.extend([[run, reached], [life, reached + inspection.remaining_cycles_p05.unwrap_or(life - run)]]);
        Some(knots)
    }

    pub fn life(&self) -> Option<Quantiles> {
        self.band.as_ref().ok().and_then(|(_, band)| band.reached.last().copied())
    }

    /// What `a_n.csv` has beside its rows.
    pub fn columns(&self) -> Option<&PlateBand> {
        self.band.as_ref().ok().map(|(_, band)| band)
    }

    pub(super) fn band_record(&self) -> Option<BandRecord> {
        let (plate, _) = self.band.as_ref().ok()?;
        let [cycles_p05, cycles_p50, cycles_p95] = self.life()?;
        let (specimens, assumed_scatter) = (plate.lot.specimens.len(), plate.lot.assumed_scatter);
        let share_outside = self.share_outside.unwrap_or(0.0);
        Some(BandRecord { cycles_p05, cycles_p50, cycles_p95, specimens, assumed_scatter, share_outside, lot: plate.of })
    }

    /// `measured` of the result.
    pub(super) fn own_record(&self) -> Option<OwnRecord> {
        let own = self.own.as_ref()?;
        let remaining = |[remaining_cycles_p05, remaining_cycles_p50, remaining_cycles_p95]: Quantiles| Remaining {
            remaining_cycles_p05,
            remaining_cycles_p50,
            remaining_cycles_p95,
        };
        Some(OwnRecord {
            left: remaining(own.left.quantiles),
            specimen: own.specimen.name.clone(),
            intervals: own.specimen.intervals.len(),
            crack_length_mm: own.left.crack_length / MM,
            cycles: own.cycles,
            of_lot: remaining(own.of_lot.quantiles),
        })
    }

    /// What the band rests on, and what was asked, in lines of a summary; a fleet has an interval of its own, cycles. `error` is that of the life.
    pub fn words(&self, of_fleet: Option<f64>, error: Option<f64>) -> Vec<String> {
        let mut lines = Vec::new();
        match &self.band {
            Ok((plate, _)) => {
                let assumed = if plate.lot.assumed_scatter { "; scatter assumed" } else { "" };
                let lot = if plate.of == Lot::Same { "same lot" } else { "other lot" };
                let other = if self.is_lot_given { "" } else { " (for another lot: fatigue.lot = \"other\")" };
                let count = plate.lot.specimens.len();
                let specimens = if count == 1 { "1 specimen".to_owned() } else { format!("{count} specimens") };
                let share = self.share_outside.map(|share| 100.0 * share).filter(|percent| *percent >= NONE_PERCENT);
                let outside = share.map_or_else(String::new, |share| format!("; {share:.1} % of the life outside the tested ΔK"));
                lines.push(format!("  Scatter band   from {specimens}, {lot}{other}{assumed}{outside}"));
            }
            Err(why) => lines.push(format!("  Scatter band   not available: {why}")),
        }
        if let Some(own) = &self.own {
            lines.push(format!(
                "  This plate     last reading {:.1} mm at {} cycles; remaining {} (without readings {})",
                own.left.crack_length / MM,
                PLAIN.whole(own.cycles),
                band_words(&own.left.quantiles),
                band_words(&own.of_lot.quantiles)
            ));
        }
        lines.extend(self.inspection.iter().flat_map(|inspection| inspection_words(inspection, self.per_pass, of_fleet, error)));
        lines
    }
}

/// Of knots `[x, y]` with straight lines between them.
pub fn at(knots: &[[f64; 2]], x: f64) -> f64 {
    let after = knots.partition_point(|knot| knot[0] < x).min(knots.len() - 1);
    let ([from, low], [to, high]) = (knots[after.saturating_sub(1)], knots[after]);
    if to > from { low + (x - from) / (to - from) * (high - low) } else { high }
}

fn inspection_words(inspection: &Inspection, per_pass: Option<f64>, of_fleet: Option<f64>, error: Option<f64>) -> Vec<String> {
    let (length, factor, quantiles) = (short(inspection.crack_length_mm), inspection.factor, inspection.quantiles());
    let left = || format!("{} cycles", PLAIN.by_error(inspection.remaining_cycles, error));
    let left = quantiles.map_or_else(left, |all| band_words(&all));
    let every = match (of_fleet, quantiles) {
        (Some(every), _) => format!("{} (5 % remaining life of the fleet / {factor})", every_words(every, &OF_FLEET, per_pass)),
        (None, Some(_)) => format!("{} (5 % remaining life / {factor})", interval_words(inspection, per_pass, error)),
        (None, None) => format!("{} (remaining life / {factor}; no scatter band)", interval_words(inspection, per_pass, error)),
    };
    let least = if inspection.life_is_lower_bound { "≥ " } else { "" };
    let of_tip = inspection.tip.map_or_else(String::new, |tip| format!(" (crack of tip {tip})"));
    vec![format!("  Remaining      {least}{left} from a = {length} mm{of_tip}"), format!("  Inspect every  {every}")]
}

pub fn no_band_to_narrow(curve: &MeasuredCurve, why: &str) -> perilife_base::error::Error {
    let remedy = "set fatigue.fitted to a law fitted to several specimens of this material at this R";
    input("--measured", curve.source.file.display(), format!("cannot update the life: no scatter band ({why})"), remedy)
}

/// An interval rounded down, since it is a promise, to the digits that a band deserves, and its passes under a spectrum.
pub fn every_words(cycles: f64, band: &Quantiles, per_pass: Option<f64>) -> String {
    let passes =
        per_pass.map_or_else(String::new, |each| format!(" ({} passes)", short((100.0 * cycles / each).floor() / 100.0)));
    format!("{} cycles{passes}", PLAIN.promised(cycles, cycles, band))
}

pub fn interval_words(inspection: &Inspection, per_pass: Option<f64>, error: Option<f64>) -> String {
    every_words(inspection.inspection_interval_cycles, &known_within(inspection, error), per_pass)
}

/// How well an interval is known: as its band, else as the life is in percent.
pub fn known_within(inspection: &Inspection, error: Option<f64>) -> Quantiles {
    inspection.quantiles().unwrap_or_else(|| within(error))
}

/// `254 000 cycles (median; 90 % band 228 000 to 283 000)`, in the digits that the band supports.
pub fn band_words(quantiles: &Quantiles) -> String {
    let digits = digits(quantiles);
    let [low, middle, high] = quantiles.map(|cycles| PLAIN.significant(cycles, digits, f64::round));
    format!("{middle} cycles (median; 90 % band {low} to {high})")
}

/// Estimated error of a life, and its cross-check.
#[derive(Debug, Clone, Default)]
pub struct Quality {
    /// `None` where not asked for; else the estimate, or why there is none.
    estimate: Option<std::result::Result<ErrorEstimate, String>>,
    pub(super) second: Option<SecondOpinion>,
    /// Stress late in life, where the estimate has solved for it.
    pub(super) stress: Option<StressField>,
}

/// `cross_check` of a result: the life by the other engine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SecondOpinion {
    pub method: String,
    /// Its cycles to the crack length that both reach, and those of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles_of_run: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference_percent: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

impl Quality {
    pub fn of(case: &Case, prediction: &Prediction, [is_estimated, cross_check]: [bool; 2]) -> Quality {
        let mut stress = None;
        let estimate = (is_estimated && prediction.life().is_some()).then(|| {
            let (estimate, moment) = estimate(case, prediction)?;
            stress = moment.filter(|_| !case.output.tables_only).map(|moment| moment.stress());
            Ok(estimate)
        });
        let second = cross_check.then(|| second_opinion(case, prediction));
        Quality { estimate, second, stress }
    }

    pub(super) fn basis(&self) -> Option<&str> {
        self.estimate.as_ref()?.as_ref().ok().map(|estimate| &*estimate.basis)
    }

    /// Estimated error of life, percent, and path, mm; why there is none.
    pub(super) fn stated(&self) -> ([Option<f64>; 2], Option<&String>) {
        let stated = self.estimate.as_ref().and_then(|estimate| estimate.as_ref().ok());
        let bounds = stated.map(|estimate| [estimate.life_percent, estimate.path / MM].map(two_digits));
        ([0, 1].map(|place| bounds.map(|both| both[place])), self.estimate.as_ref().and_then(|estimate| estimate.as_ref().err()))
    }

    pub fn words(&self) -> Vec<String> {
        let of_estimate = |estimate: &std::result::Result<ErrorEstimate, String>| match estimate {
            Ok(ErrorEstimate { life_percent, path, .. }) => {
                let path =
                    if *path > 0.0 { format!(", ≤ {} mm in the path", short(two_digits(path / MM))) } else { String::new() };
                format!("  Accuracy       numerical error ≤ {life_percent:.1} % of life{path} (estimate)")
            }
            Err(why) => format!("  Accuracy       numerical error not estimated: {why}"),
        };
        let mut lines: Vec<String> = self.estimate.iter().map(of_estimate).collect();
        lines.extend(self.second.as_ref().map(|second| match (second.cycles, second.cycles_of_run, second.difference_percent) {
            (Some(other), Some(own), Some(percent)) => {
                let [other, own] = [other, own].map(|cycles| PLAIN.whole(cycles));
                format!("  Cross-check    {} (coarse): {other} cycles, this run {own} ({percent:+.1} %)", second.method)
            }
            _ => format!("  Cross-check    {}: none, {}", second.method, second.failed.as_deref().unwrap_or_default()),
        }));
        lines
    }
}

/// The life with K by another method: nodes for points and handbook, points for nodes.
fn second_opinion(case: &Case, prediction: &Prediction) -> SecondOpinion {
    let of = |method: Method, found: std::result::Result<[f64; 2], String>| {
        let (cycles, failed) = (found.as_ref().ok().copied(), found.err());
        let difference_percent = cycles.map(|[other, own]| 100.0 * (other / own - 1.0));
        let [cycles, cycles_of_run] = [0, 1].map(|place| cycles.map(|both| both[place]));
        SecondOpinion { method: method.name().to_owned(), cycles, cycles_of_run, difference_percent, failed }
    };
    if !case.specimen.is_through() {
        return of(Method::ElementFreeGalerkin, Err("no other method supports part-through cracks".to_owned()));
    }
    let model = match case.model {
        Model::Nodes(_) => Model::Points(coarse_points(case)),
        Model::Handbook(_) | Model::Points(_) => Model::Nodes(usual_nodes(&case.specimen)),
    };
    let other = Case { model, chosen: None, ..case.driven_by_tips(case.specimen.clone()) };
    let cycles = predict(&other, &Silent).map_err(|error| error.to_string()).and_then(|second| {
        let common = prediction.crack_length_final().min(second.crack_length_final());
        let at = |run: &Prediction| run.cycles_at(common).filter(|cycles| *cycles > 0.0);
        at(&second).zip(at(prediction)).map(|(other, own)| [other, own]).ok_or_else(|| "its crack did not grow".to_owned())
    });
    of(model.method(), cycles)
}
