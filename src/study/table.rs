//! Rows of a verification and the judgement over them.

use std::time::Instant;

use super::closed::percent;

/// One figure beside its reference.
#[derive(Debug, Clone, PartialEq)]
pub struct VerificationRow {
    /// Topic it belongs to.
    pub name: &'static str,
    /// What is compared, with unit and conditions.
    pub quantity: String,
    pub computed: f64,
    /// What it should be; 0 where the figure is itself an error in percent.
    pub reference: f64,
    /// Error in percent of the reference, or the figure itself where the reference is 0.
    pub error_percent: f64,
    /// Largest size of the error that is accepted.
    pub bound_percent: f64,
    /// Why the bound is not met and how far the error may go all the same, where that is known.
    pub known_miss: Option<KnownMiss>,
    pub source: String,
    /// Seconds spent since the row before.
    pub wall_s: f64,
}

/// A bound that is known not to be met.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownMiss {
    /// Why it is not met.
    pub reason: String,
    /// Second bound on the size of the error, percent: what is known and a tenth of it, so that a miss cannot grow unseen.
    pub bound_percent: f64,
}

impl VerificationRow {
    /// Whether the error keeps its bound; an error that is not a number does not.
    pub fn ok(&self) -> bool {
        self.error_percent.abs() <= self.bound_percent
    }

    /// Whether the row fails the verification: bound missed for no known reason, or by more than is known.
    pub fn fails(&self) -> bool {
        !self.ok() && !self.known_miss.as_ref().is_some_and(|miss| self.error_percent.abs() <= miss.bound_percent)
    }
}

/// Rows of one topic in the making.
#[derive(Debug)]
pub struct Table {
    name: &'static str,
    rows: Vec<VerificationRow>,
    last: Instant,
}

impl Table {
    /// An empty table of a topic.
    pub fn new(name: &'static str) -> Self {
        Table { name, rows: Vec::new(), last: Instant::now() }
    }

    /// A figure against its reference (not 0); the bound is on `100 |computed / reference - 1|`.
    pub fn compare(&mut self, quantity: impl Into<String>, computed: f64, reference: f64, bound_percent: f64, source: &str) {
        self.push(quantity.into(), computed, reference, percent(computed, reference), bound_percent, source);
    }

    /// A figure that is itself an error in percent.
    pub fn error(&mut self, quantity: impl Into<String>, error_percent: f64, bound_percent: f64, source: &str) {
        self.push(quantity.into(), error_percent, 0.0, error_percent, bound_percent, source);
    }

    /// Gives the last row the reason of a miss and the error that is known, percent; a row that keeps its bound has none.
    pub fn known_miss(&mut self, reason: &str, known_percent: f64) {
        if let Some(row) = self.rows.last_mut().filter(|row| !row.ok()) {
            row.known_miss = Some(KnownMiss { reason: reason.to_owned(), bound_percent: 1.1 * known_percent.abs() });
        }
    }

    /// The rows, in the order in which they were computed.
    pub fn into_rows(self) -> Vec<VerificationRow> {
        self.rows
    }

    fn push(&mut self, quantity: String, computed: f64, reference: f64, error_percent: f64, bound_percent: f64, source: &str) {
        let wall_s = self.last.elapsed().as_secs_f64();
        self.last = Instant::now();
        let row = VerificationRow {
            name: self.name,
            quantity,
            computed,
            reference,
            error_percent,
            bound_percent,
            known_miss: None,
            source: source.to_owned(),
            wall_s,
        };
        self.rows.push(row);
    }
}
