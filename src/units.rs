//! Units of input and output against the SI units used inside. The only place that converts:
//! multiply by a constant to come in, divide by it to go out.

/// Metres in a millimetre.
pub const MM: f64 = 1e-3;
/// Metres in an inch.
pub const INCH: f64 = 25.4e-3;
/// Pascals in a megapascal.
pub const MPA: f64 = 1e6;
/// Pascals in a gigapascal.
pub const GPA: f64 = 1e9;
/// Newtons in a kilonewton.
pub const KN: f64 = 1e3;
/// Pa√m in a MPa√m.
pub const MPA_SQRT_M: f64 = 1e6;
/// m/cycle in a mm/cycle.
pub const MM_PER_CYCLE: f64 = 1e-3;
