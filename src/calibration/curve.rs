//! What a measured curve tells: parts of it, and the cycles that count.

use crate::calibration::measured::{MeasuredCurve, Source};

impl MeasuredCurve {
    /// Readings without loads or other remarks.
    pub fn new(specimen: impl Into<String>, cycles: Vec<f64>, crack_length: Vec<f64>) -> Self {
        MeasuredCurve { specimen: specimen.into(), cycles, crack_length, ..MeasuredCurve::default() }
    }

    pub(super) fn window(&self, from: f64, to: f64) -> MeasuredCurve {
        let inside = |&reading: &usize| self.crack_length[reading] >= from && self.crack_length[reading] <= to;
        let first = (0..self.cycles.len()).find(inside);
        let start = first.map_or(from, |first| self.crack_length[first]);
        let readings: Vec<usize> =
            (0..self.cycles.len()).filter(inside).filter(|&reading| self.crack_length[reading] >= start).collect();
        self.of_readings(&readings)
    }

    /// The curve of some of its readings, in their order, cycles counted from the first. The growth between two of them is left out
    /// where that of any step between them was.
    pub fn of_readings(&self, readings: &[usize]) -> MeasuredCurve {
        fn some<T: Copy>(of: &[T], readings: &[usize]) -> Vec<T> {
            readings.iter().filter_map(|&reading| of.get(reading).copied()).collect()
        }
        let start = readings.first().map_or(0.0, |&first| self.cycles[first]);
        let steps = readings.iter().enumerate().map(|(i, &to)| (if i == 0 { to } else { readings[i - 1] }, to));
        let left_out = steps.map(|(from, to)| (from + 1..=to).any(|step| self.left_out.get(step) == Some(&true)));
        MeasuredCurve {
            specimen: self.specimen.clone(),
            cycles: readings.iter().map(|&reading| self.cycles[reading] - start).collect(),
            crack_length: some(&self.crack_length, readings),
            side_difference: some(&self.side_difference, readings),
            loads: self.loads.as_ref().map(|loads| loads.of_readings(readings)),
            load_factor: some(&self.load_factor, readings),
            left_out: if self.left_out.is_empty() { Vec::new() } else { left_out.collect() },
            source: Source {
                lines: some(&self.source.lines, readings),
                cycles_before: self.source.cycles_before + start,
                ..self.source.clone()
            },
        }
    }

    /// Whether every reading has the load of the case and counts.
    pub fn is_plain(&self) -> bool {
        self.load_factor.is_empty() && !self.left_out.contains(&true)
    }

    /// Whether the growth up to a reading counts.
    pub fn counts(&self, reading: usize) -> bool {
        self.left_out.get(reading) != Some(&true)
    }

    /// Cycles since the first reading, those of steps left out taken off.
    pub fn cycles_counted(&self) -> Vec<f64> {
        let Some(&first) = self.cycles.first() else { return Vec::new() };
        if !self.left_out.contains(&true) {
            return self.cycles.iter().map(|n| n - first).collect();
        }
        let mut sum = 0.0;
        let step = |i: usize| if i > 0 && self.counts(i) { self.cycles[i] - self.cycles[i - 1] } else { 0.0 };
        (0..self.cycles.len())
            .map(|i| {
                sum += step(i);
                sum
            })
            .collect()
    }

    /// Where a reading stands, for messages: its line, or its number where there is no file.
    pub fn line(&self, reading: usize) -> usize {
        self.source.lines.get(reading).copied().unwrap_or(reading + 1)
    }

    /// Cycles from the first reading to the last.
    pub fn life(&self) -> f64 {
        self.cycles.last().unwrap_or(&0.0) - self.cycles.first().unwrap_or(&0.0)
    }
}
