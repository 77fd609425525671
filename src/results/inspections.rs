//! Inspections of the plate of a run, and the probability that all of them miss its crack.

use serde::{Deserialize, Serialize};

use super::format::{chance, clean, mm};
use perilife_base::units::MM;
use perilife_calibration::inspection::Inspection;
use perilife_calibration::sweep::detection::{Detection, Schedule};
use perilife_growth::case::Case;
use perilife_growth::predict::{CurvePoint, Prediction};

/// What is asked for; a fleet is by the section of the case.
#[derive(Debug, Clone, Copy, Default)]
pub struct Asked {
    /// How inspections find cracks.
    pub detection: Option<Detection>,
    pub first_inspection: Option<f64>,
    /// Life at somewhat other input.
    pub sensitivities: bool,
}

/// `inspections` of a result: those of a run from a crack length on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InspectionsRecord {
    /// Crack lengths that are found with 50 and with 90 %.
    pub a50_mm: f64,
    pub a90_mm: f64,
    pub interval_cycles: f64,
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
    /// where nobody asked. From that length on the crack grows by the quantile of the interval: the cycles of the run, stretched to its end.
    pub fn of(case: &Case, prediction: &Prediction, inspection: &Inspection, asked: Asked) -> Option<Self> {
        let (detection, at) = (asked.detection?, inspection.cycles_at);
        let schedule =
            Schedule { detection, cycles: [asked.first_inspection.unwrap_or(at), inspection.inspection_interval_cycles] };
        let pace = inspection.remaining_cycles_p05.map_or(1.0, |low| low / inspection.remaining_cycles);
        let cycles = |own: f64| if own > at { at + pace * (own - at) } else { own };
        let of_tip = |row: &CurvePoint| inspection.tip.and_then(|tip| row.crack_length_of(&case.specimen, tip));
        let length = |row: &CurvePoint| of_tip(row).unwrap_or(row.crack_length);
        let (mut inspected, mut rows) = (schedule.begin(), Vec::new());
        for pair in prediction.curve.windows(2) {
            let told = |cycles, crack_length: f64, pod, missed| {
                rows.push(InspectionRow { cycles, crack_length_mm: clean(crack_length / MM), pod, missed });
            };
            let ([from, to], [start, end]) = ([pair[0].cycles, pair[1].cycles], [length(&pair[0]), length(&pair[1])]);
            let places = if from < at && at < to {
                // What lies before the length is not stretched.
                vec![(from, start), (at, start + (at - from) / (to - from) * (end - start)), (to, end)]
            } else {
                vec![(from, start), (to, end)]
            };
            let mut told = told;
            for part in places.windows(2) {
                inspected.grow([cycles(part[0].0), cycles(part[1].0)], [part[0].1, part[1].1], &mut told);
            }
        }
        let [a50_mm, a90_mm] = [detection.a50, detection.a90].map(|length| clean(length / MM));
        let missed = rows.last().map_or(1.0, |row| row.missed);
        Some(InspectionsRecord { a50_mm, a90_mm, interval_cycles: schedule.cycles[1], missed, rows })
    }

    /// A line of a summary.
    pub fn words(&self) -> String {
        let (count, missed) = (self.rows.len(), chance(self.missed));
        let [half, most] = [self.a50_mm, self.a90_mm].map(|length| mm(length * MM));
        format!(
            "  POD            {count} inspections; all miss the crack: {missed} (independence assumed; a50 {half} mm, a90 {most} mm)"
        )
    }
}
