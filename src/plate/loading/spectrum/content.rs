//! What a file of a spectrum holds, as it stands there.

perilife_base::kinds! {
    /// How a spectrum is written.
    pub enum SpectrumFormat for "loading.spectrum_format" {
        Cycles = "cycles": "table with the columns max, min, cycles (or range, mean, cycles), in order, each maximum before its minimum",
        TurningPoints = "turning_points": "one column of peaks and valleys, rainflow counted as repeating (ASTM E1049, 5.4.5); each cycle is applied at its peak",
        Spx = "spx": "AFGROW .spx: XML with elements B (Mx, Mn, C) in every SubSpectrum",
        Sub = "sub": "AFGROW .sub: a title with the number of rows, then rows max min cycles",
        Fastran = "fastran": "FASTRAN: a title, points Smax Smin INVERT ICLIP, then peaks and valleys as whole numbers",
    }
}

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
