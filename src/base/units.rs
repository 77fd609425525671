//! Units of input and output against the SI units used inside. The only place that converts:
//! multiply by a constant to come in, divide by it to go out.

pub mod shown;
pub mod us;
pub mod words;

/// Metres in a millimetre.
pub const MM: f64 = 1e-3;
pub const INCH: f64 = 25.4e-3;
/// Pascals in a megapascal.
pub const MPA: f64 = 1e6;
/// Pascals in a gigapascal.
pub const GPA: f64 = 1e9;
/// Newtons in a kilonewton.
pub const KN: f64 = 1e3;
/// Newtons in a pound-force.
pub const LBF: f64 = 4.448_221_615_260_5;
/// Newtons in a kilogram-force.
pub const KGF: f64 = 9.806_65;
/// Pascals in a thousand pounds-force per square inch.
pub const KSI: f64 = 1e3 * LBF / (INCH * INCH);
/// Pa√m in a MPa√m.
pub const MPA_SQRT_M: f64 = 1e6;
/// √m in √inch.
pub const SQRT_INCH: f64 = 0.159_373_774_505_092_3;
/// m/cycle in a mm/cycle.
pub const MM_PER_CYCLE: f64 = 1e-3;

/// A place, m, in words: its coordinates in mm.
pub fn place_mm(place: [f64; 2]) -> String {
    let [x, y] = place.map(|metres| metres / MM);
    format!("({x:.4}, {y:.4}) mm")
}

/// A place, m, as a file gives it: its coordinates in mm, rounded to six digits.
pub fn given_mm(place: [f64; 2]) -> String {
    let [x, y] = place.map(round_mm);
    format!("({x}, {y}) mm")
}

/// A number in writing that nobody takes its decimal point for a separator of thousands in: 12.345 becomes 12.3450.
pub fn unmistakable(number: &str) -> String {
    match number.split_once('.') {
        Some((_, digits)) if digits.len() == 3 => format!("{number}0"),
        _ => number.to_owned(),
    }
}

/// Metres as mm, rounded to six digits for messages.
pub fn round_mm(metres: f64) -> f64 {
    (metres / MM * 1e6).round() / 1e6
}

/// Nine significant digits for messages: hides the last bits that unit conversion leaves.
pub fn round_off(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}
