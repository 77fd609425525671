//! Numbers of tables: at least ten significant digits.

/// A number so that it reads back bit for bit, with at least ten significant digits; empty for NaN.
pub fn exact(value: f64) -> String {
    if value.is_nan() {
        return String::new();
    }
    let digits_wanted = 10;
    if value == 0.0 || !value.is_finite() || (1e-4..1e15).contains(&value.abs()) {
        pad(format!("{value}"), digits_wanted)
    } else {
        let text = format!("{value:e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{exponent}", pad(mantissa.to_owned(), digits_wanted))
    }
}

/// A measured or computed quantity with 10 to 15 significant digits: unit conversion may disturb the last of the 17 that
/// a double carries, and 15 hide that (9 mm stays 9.000000000).
pub fn number(value: f64) -> String {
    // A 15-digit decimal always parses; the fallback only spares a panic path.
    exact(format!("{value:.14e}").parse().unwrap_or(value))
}

/// Appends zeros behind the decimal point until there are `wanted` significant digits.
fn pad(mut text: String, wanted: usize) -> String {
    let significant = text.trim_start_matches(['-', '0', '.']).bytes().filter(u8::is_ascii_digit).count();
    if significant == 0 || significant >= wanted || !text.bytes().all(|b| b.is_ascii_digit() || b == b'.' || b == b'-') {
        return text;
    }
    if !text.contains('.') {
        text.push('.');
    }
    text.push_str(&"0".repeat(wanted - significant));
    text
}
