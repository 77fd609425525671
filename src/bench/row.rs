//! Rows of a benchmark and figures drawn from them.

use super::clock::Timing;

/// One run with its time, and its error where it has one.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Group it belongs to.
    pub group: &'static str,
    /// The scene, in words.
    pub scene: String,
    /// What differs from the default: `solver`, `spacing`, ...; `default` where nothing does.
    pub varied: &'static str,
    /// What it is here: `multigrid`, `2 mm`.
    pub choice: String,
    /// Points of the body; 0 in hand calculation.
    pub points: usize,
    /// Times.
    pub timing: Timing,
    /// Error, where there is one.
    pub error: Option<Deviation>,
    /// Bonds that broke.
    pub broken_bonds: Option<usize>,
    /// Peak of memory beyond that of the empty process, bytes a point.
    pub bytes_per_point: Option<f64>,
    /// What the reader has to know.
    pub note: String,
    /// Whether no other row of its group is both faster and nearer to the reference.
    pub on_front: bool,
}

/// How far a result lies from its reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Deviation {
    /// Of what, in words.
    pub of: &'static str,
    /// Size in percent; never negative.
    pub percent: f64,
    /// What it is compared with.
    pub against: &'static str,
    /// Signed error of the life at its end, percent.
    pub at_end_percent: Option<f64>,
}

impl Row {
    /// A row without error, bonds or memory.
    #[must_use]
    pub fn new(group: &'static str, scene: impl Into<String>, varied: &'static str, choice: &str, timing: Timing) -> Self {
        Row {
            group,
            scene: scene.into(),
            varied,
            choice: choice.to_owned(),
            points: 0,
            timing,
            error: None,
            broken_bonds: None,
            bytes_per_point: None,
            note: String::new(),
            on_front: false,
        }
    }

    /// Milliseconds for every bond that broke, set-up included.
    #[must_use]
    pub fn ms_per_broken_bond(&self) -> Option<f64> {
        self.broken_bonds.filter(|bonds| *bonds > 0).map(|bonds| 1e3 * self.timing.wall_s / bonds as f64)
    }

    /// Place in the chart: time over the reference run, error in percent.
    #[must_use]
    pub fn place(&self) -> Option<(f64, f64)> {
        let error = self.error.as_ref()?.percent;
        (self.timing.ratio > 0.0 && error.is_finite()).then_some((self.timing.ratio, error))
    }
}

/// A figure drawn from rows, beside what is asked of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Group it belongs to.
    pub group: &'static str,
    /// What it is.
    pub quantity: String,
    /// Its value.
    pub value: f64,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// What is asked of it.
    pub asked: Option<Asked>,
}

/// A demand on a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Asked {
    /// No more than this.
    AtMost(f64),
    /// No less than this.
    AtLeast(f64),
}

impl Asked {
    /// Whether a value keeps it; a value that is not a number does not.
    #[must_use]
    pub fn is_met(self, value: f64) -> bool {
        match self {
            Asked::AtMost(most) => value <= most,
            Asked::AtLeast(least) => value >= least,
        }
    }
}

impl std::fmt::Display for Asked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Asked::AtMost(most) => write!(f, "≤ {most}"),
            Asked::AtLeast(least) => write!(f, "≥ {least}"),
        }
    }
}
