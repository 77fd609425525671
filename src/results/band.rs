//! The band of the lives of a run: its figures, words, what readings of the plate itself say, and the inspection interval.

use serde::{Deserialize, Serialize};

use super::curve::{Row, curve};
use super::format::{PLAIN, digits, short};
use perilife_base::error::{Result, input};
use perilife_base::units::MM;
use perilife_calibration::inspection::{InspectFrom, Inspection, TipLengths};
use perilife_calibration::population::intervals::Specimen;
use perilife_calibration::population::plate::{Left, NoBand, Plate, PlateBand, Quantiles};
use perilife_growth::case::{Case, Lot};
use perilife_growth::predict::Prediction;
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

/// Cycles that 5, 50 and 95 % of specimens do not live on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Remaining {
    pub remaining_cycles_p05: f64,
    pub remaining_cycles_p50: f64,
    pub remaining_cycles_p95: f64,
}

/// `measured` of a result: what readings of the plate itself say.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OwnRecord {
    pub remaining_cycles_p05: f64,
    pub remaining_cycles_p50: f64,
    pub remaining_cycles_p95: f64,
    pub specimen: String,
    pub intervals: usize,
    pub crack_length_mm: f64,
    pub cycles: f64,
    /// The same by the lot alone.
    pub of_lot: Remaining,
}

/// Lives of a lot on a plate that was run, and what was asked about them.
#[derive(Debug, Clone)]
pub struct Lives {
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

impl Lives {
    /// Of a run.
    /// Errors: a record whose `[population]` is damaged.
    pub fn of(case: &Case, prediction: &Prediction, is_lower_bound: bool) -> Result<Self> {
        let plate = Plate::of(case, prediction)?;
        Ok(Lives {
            band: plate.and_then(|plate| plate.band().map(|band| (plate, band))),
            is_lot_given: !case.echo["fatigue"]["lot"].is_null(),
            is_lower_bound,
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

    /// What is left from the length that was asked for.
    pub fn inspection(&self) -> Option<&Inspection> {
        self.inspection.as_ref()
    }

    pub fn life(&self) -> Option<Quantiles> {
        self.band.as_ref().ok().and_then(|(_, band)| band.reached.last().copied())
    }

    /// What `a_n.csv` has beside its rows.
    pub fn columns(&self) -> Option<&PlateBand> {
        self.band.as_ref().ok().map(|(_, band)| band)
    }

    /// `band` of the result.
    pub(super) fn band_record(&self) -> Option<BandRecord> {
        let (plate, band) = self.band.as_ref().ok()?;
        let [cycles_p05, cycles_p50, cycles_p95] = self.life()?;
        let (specimens, assumed_scatter) = (plate.lot.specimens.len(), plate.lot.assumed_scatter);
        let share_outside = band.share_outside;
        Some(BandRecord { cycles_p05, cycles_p50, cycles_p95, specimens, assumed_scatter, share_outside, lot: plate.of })
    }

    /// `measured` of the result.
    pub(super) fn own_record(&self) -> Option<OwnRecord> {
        let own = self.own.as_ref()?;
        let [remaining_cycles_p05, remaining_cycles_p50, remaining_cycles_p95] = own.left.quantiles;
        let [low, middle, high] = own.of_lot.quantiles;
        Some(OwnRecord {
            remaining_cycles_p05,
            remaining_cycles_p50,
            remaining_cycles_p95,
            specimen: own.specimen.name.clone(),
            intervals: own.specimen.intervals.len(),
            crack_length_mm: own.left.crack_length / MM,
            cycles: own.cycles,
            of_lot: Remaining { remaining_cycles_p05: low, remaining_cycles_p50: middle, remaining_cycles_p95: high },
        })
    }

    /// The life in words, with the digits that its band deserves; `None` without a band.
    pub fn life_words(&self) -> Option<String> {
        self.life().map(|quantiles| band_words(&quantiles))
    }

    /// What the band rests on, and what was asked, in lines of a summary; a fleet has an interval of its own, cycles.
    pub fn words(&self, of_fleet: Option<f64>) -> Vec<String> {
        let mut lines = Vec::new();
        match &self.band {
            Ok((plate, band)) => {
                let assumed = if plate.lot.assumed_scatter { "; scatter assumed" } else { "" };
                let lot = if plate.of == Lot::Same { "same lot" } else { "other lot" };
                let other = if self.is_lot_given { "" } else { " (for another lot: fatigue.lot = \"other\")" };
                let count = plate.lot.specimens.len();
                let specimens = if count == 1 { "1 specimen".to_owned() } else { format!("{count} specimens") };
                let outside = match band.share_outside {
                    share if share > 0.0 => format!("; {:.1} % of the life outside the tested ΔK", 100.0 * share),
                    _ => String::new(),
                };
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
        lines.extend(self.inspection.iter().flat_map(|inspection| inspection_words(inspection, self.per_pass, of_fleet)));
        lines
    }
}

/// What an inspection says, in lines of a summary.
fn inspection_words(inspection: &Inspection, per_pass: Option<f64>, of_fleet: Option<f64>) -> Vec<String> {
    let (length, factor, quantiles) = (short(inspection.crack_length_mm), inspection.factor, inspection.quantiles());
    let left = quantiles.map_or_else(|| format!("{} cycles", PLAIN.whole(inspection.remaining_cycles)), |all| band_words(&all));
    let every = match (of_fleet, quantiles) {
        (Some(every), _) => format!("{} (5 % remaining life of the fleet / {factor})", every_words(every, None, per_pass)),
        (None, Some(_)) => format!("{} (5 % remaining life / {factor})", interval_words(inspection, per_pass)),
        (None, None) => format!("{} (remaining life / {factor}; no scatter band)", interval_words(inspection, per_pass)),
    };
    let least = if inspection.life_is_lower_bound { "≥ " } else { "" };
    let of_tip = inspection.tip.map_or_else(String::new, |tip| format!(" (crack of tip {tip})"));
    vec![format!("  Remaining      {least}{left} from a = {length} mm{of_tip}"), format!("  Inspect every  {every}")]
}

/// Why readings narrow nothing.
pub fn no_band_to_narrow(curve: &MeasuredCurve, why: &str) -> perilife_base::error::Error {
    let remedy = "set fatigue.fitted to a law fitted to several specimens of this material at this R";
    input("--measured", curve.source.file.display(), format!("cannot update the life: no scatter band ({why})"), remedy)
}

/// An interval rounded down, since it is a promise, to the digits that a band deserves, and its passes under a spectrum.
pub fn every_words(cycles: f64, band: Option<&Quantiles>, per_pass: Option<f64>) -> String {
    let passes =
        per_pass.map_or_else(String::new, |each| format!(" ({} passes)", short((100.0 * cycles / each).floor() / 100.0)));
    format!("{} cycles{passes}", PLAIN.promised(cycles, band))
}

/// The interval of an inspection, as the console says it.
pub fn interval_words(inspection: &Inspection, per_pass: Option<f64>) -> String {
    every_words(inspection.inspection_interval_cycles, inspection.quantiles().as_ref(), per_pass)
}

/// `254 000 cycles (median; 90 % band 228 000 to 283 000)`, in the digits that the band supports.
pub fn band_words(quantiles: &Quantiles) -> String {
    let digits = digits(quantiles);
    let [low, middle, high] = quantiles.map(|cycles| PLAIN.significant(cycles, digits, f64::round));
    format!("{middle} cycles (median; 90 % band {low} to {high})")
}
