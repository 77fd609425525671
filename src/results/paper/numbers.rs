//! Numbers as a report writes them: thousands apart, a true minus, powers of ten raised, no more digits than a band deserves.

use crate::axis::grouped;
use crate::band::digits;
use perilife_base::units::shown::{name_of, per, shown};
use perilife_base::units::us::{System, renamed};
use perilife_calibration::population::plate::Quantiles;

/// A narrow space at which no line breaks.
const THIN: &str = "\u{202f}";

/// A whole number, thousands apart.
pub fn whole(value: f64) -> String {
    minus(&grouped(&format!("{value:.0}"), THIN))
}

/// A number with so many decimals.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { minus(&text) }
}

/// A number with at most four significant decimals behind the point, without zeros at its end.
pub fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    minus(text.trim_end_matches('0').trim_end_matches('.'))
}

/// With the digits that a band deserves, as the console and the page say it.
pub fn by_band(value: f64, band: &Quantiles) -> String {
    let unit = 10f64.powf(value.max(1.0).log10().floor() + 1.0 - digits(band) as f64);
    whole((value / unit).round() * unit)
}

/// With so many significant digits, as markup: plain where that is short, else by a power of ten.
pub fn sized(value: f64, digits: usize) -> String {
    let size = value.abs();
    if value == 0.0 || !(1e-2..1e4).contains(&size) {
        return if value == 0.0 { "0".to_owned() } else { power(value, digits) };
    }
    let before = size.log10().floor() as i32 + 1;
    fixed(value, usize::try_from(digits as i32 - before).unwrap_or(0))
}

/// With so many significant digits, as markup: 2.15 × 10⁻⁴.
pub fn power(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}{THIN}×{THIN}10<sup>{}</sup>", minus(mantissa), minus(exponent))
}

/// A growth rate, mm/cycle, in the unit that is shown.
pub fn rate(value: f64, digits: usize) -> String {
    power(value * per("mm/cycle"), digits)
}

/// C of a law C ΔK^m, mm/cycle at 1 MPa√m, with both units, in those that are shown; metric where m is not known.
pub fn level(c: f64, m: Option<f64>, digits: usize) -> String {
    let us = renamed("paris_c_mm_per_cycle", System::Us).filter(|_| shown() == System::Us);
    let factor = us.and_then(|us| us.factor(|_| m).ok()).unwrap_or(1.0);
    format!("{} {} at 1 {}", power(c * factor, digits), name_of("mm/cycle"), name_of("MPa√m"))
}

fn minus(text: &str) -> String {
    text.replace('-', "−")
}
