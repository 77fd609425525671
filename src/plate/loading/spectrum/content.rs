//! What a file of a spectrum holds, as it stands there.

/// Cycles or turning points as a file has them.
pub(super) enum Content {
    Cycles(Vec<RawCycle>),
    Points(Vec<f64>),
}

/// A cycle of a file, in its line.
#[derive(Debug, Clone, Copy)]
pub(super) struct RawCycle {
    pub line: usize,
    pub max: f64,
    pub min: f64,
    pub count: f64,
}
