//! Numbers as people read them: thousands apart, no more digits than a band or a stated error deserves, quantities in the units that are shown.
//!
//! What is rounded is the number in the unit that is shown; a rounded number is never converted.
//!
//! Results in US units, and back: numbers by the units that their keys end in; words of a file are metric and converted where they are shown. What the program reads back as input
//! stays metric: `fitted.toml`, `case.toml` and `inputs/`, checkpoints; so do `case` in results, files for ParaView and Parquet.

use serde_json::{Map, Value};

use perilife_base::units::MM;
use perilife_base::units::shown::{name_of, per, shown, told};
pub use perilife_base::units::us::clean;
use perilife_base::units::us::{System, renamed};

/// Half widths of a band above which a life has so many significant digits, and those below.
const DIGITS: [(f64, usize); 2] = [(0.1, 2), (0.01, 3)];
/// Digits of a life that is known better.
const DIGITS_MOST: usize = 4;
/// Half width of a life of which no error is stated.
const UNSTATED: f64 = 0.01;

#[derive(Debug, Clone, Copy)]
pub struct Format {
    /// Between thousands, from 10 000 on.
    thousands: &'static str,
    minus: &'static str,
}

pub const PLAIN: Format = Format { thousands: " ", minus: "-" };
/// In a document: narrow spaces at which no line breaks, a true minus.
pub const PRINT: Format = Format { thousands: "\u{202f}", minus: "−" };
pub const AXIS: Format = Format { thousands: "\u{2009}", minus: "-" };

impl Format {
    /// Digits with thousands apart and the minus of this form.
    pub fn digits(self, text: &str) -> String {
        let (sign, text) = text.strip_prefix('-').map_or(("", text), |rest| (self.minus, rest));
        let (whole, rest) = text.find('.').map_or((text, ""), |point| text.split_at(point));
        let mut out = sign.to_owned();
        for (i, digit) in whole.chars().enumerate() {
            if i > 0 && whole.len() > 4 && (whole.len() - i) % 3 == 0 {
                out.push_str(self.thousands);
            }
            out.push(digit);
        }
        out + rest
    }

    pub fn whole(self, value: f64) -> String {
        self.digits(&format!("{value:.0}"))
    }

    pub fn fixed(self, value: f64, decimals: usize) -> String {
        let text = format!("{value:.decimals$}");
        let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
        self.digits(if is_zero { text.trim_start_matches('-') } else { &text })
    }

    /// The same with its sign, none of what is zero in these decimals.
    pub fn signed(self, value: f64, decimals: usize) -> String {
        let text = self.fixed(value, decimals);
        if value > 0.0 && text.contains(|c| matches!(c, '1'..='9')) { format!("+{text}") } else { text }
    }

    /// With at most four decimals, without zeros at its end.
    pub fn short(self, value: f64) -> String {
        self.digits(trimmed(&format!("{value:.4}")))
    }

    /// With so many significant digits, rounded to them by `to_whole`.
    pub fn significant(self, value: f64, digits: usize, to_whole: fn(f64) -> f64) -> String {
        if !(value.is_finite() && value > 0.0) {
            return self.digits(&format!("{value}"));
        }
        let place = place(value, digits);
        let unit = 10f64.powi(place);
        self.digits(&format!("{:.*}", usize::try_from(-place).unwrap_or(0), to_whole(value / unit) * unit))
    }

    /// With four significant digits, without zeros at its end.
    pub fn four(self, value: f64) -> String {
        trimmed(&self.significant(value, 4, f64::round)).to_owned()
    }

    pub fn by_band(self, cycles: f64, band: &[f64; 3]) -> String {
        self.significant(cycles, digits(band), f64::round)
    }

    /// Cycles with the digits that their stated error deserves, in percent.
    pub fn by_error(self, cycles: f64, percent: Option<f64>) -> String {
        self.by_band(cycles, &within(percent))
    }

    /// A promise, rounded down to the digits that an interval deserves by a band; whole cycles are those that a user gave.
    pub fn promised(self, cycles: f64, interval: f64, band: &[f64; 3]) -> String {
        let unit = if cycles.fract() == 0.0 { 1.0 } else { 10f64.powi(place(interval, digits(band)).max(0)) };
        self.whole((cycles / unit).floor() * unit)
    }

    /// A length, m, with its unit, to a share of a millimetre: `decimals` of it, two more of an inch.
    pub fn length(self, metres: f64, decimals: usize) -> String {
        let more = if shown() == System::Us { 2 } else { 0 };
        format!("{} {}", self.fixed(metres / MM * per("mm"), decimals + more), name_of("mm"))
    }

    /// With so many significant digits, as markup: plain where that is short, else by a power of ten.
    pub fn sized(self, value: f64, digits: usize) -> String {
        let size = value.abs();
        if value == 0.0 || !(1e-2..1e4).contains(&size) {
            return if value == 0.0 { "0".to_owned() } else { self.power(value, digits) };
        }
        let before = size.log10().floor() as i32 + 1;
        self.fixed(value, usize::try_from(digits as i32 - before).unwrap_or(0))
    }

    /// With so many significant digits, as markup: 2.15 × 10⁻⁴.
    pub fn power(self, value: f64, digits: usize) -> String {
        let text = format!("{value:.*e}", digits.saturating_sub(1));
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let space = self.thousands;
        format!("{}{space}×{space}10<sup>{}</sup>", self.digits(mantissa), self.digits(exponent))
    }

    /// A growth rate, mm/cycle, in the unit that is shown, as markup.
    pub fn rate(self, value: f64, digits: usize) -> String {
        self.power(value * per("mm/cycle"), digits)
    }

    /// A value with its error as markup: as many decimals as two digits of the error need.
    pub fn with_error(self, value: f64, error: Option<f64>) -> String {
        let Some(error) = error.filter(|error| *error > 0.0) else { return self.fixed(value, 3) };
        let decimals = usize::try_from(1 - error.log10().floor() as i32).unwrap_or(0);
        format!("{} ± {}", self.fixed(value, decimals), self.fixed(error, decimals))
    }

    /// C of a law C ΔK^m, mm/cycle at 1 MPa√m, with both units, in those that are shown; metric where m is not known.
    pub fn level(self, c: f64, m: Option<f64>, digits: usize) -> String {
        let us = renamed("paris_c_mm_per_cycle", System::Us).filter(|_| shown() == System::Us);
        let factor = us.and_then(|us| us.factor(|_| m).ok()).unwrap_or(1.0);
        format!("{} {} at 1 {}", self.power(c * factor, digits), name_of("mm/cycle"), name_of("MPa√m"))
    }
}

/// A band of a median of 1 to both sides of which an error lies, in percent.
pub fn within(percent: Option<f64>) -> [f64; 3] {
    let half = percent.map_or(UNSTATED, |percent| percent / 100.0);
    [1.0 - half, 1.0, 1.0 + half]
}

/// Power of ten of the last of so many digits.
fn place(value: f64, digits: usize) -> i32 {
    (value.log10().floor() as i32).saturating_add(1 - digits as i32)
}

/// Significant digits that a band deserves: two of one that is wider than a tenth to each side, three, four of one within a hundredth.
pub fn digits([low, middle, high]: &[f64; 3]) -> usize {
    let half = 0.5 * (high - low) / middle;
    DIGITS.iter().find(|(width, _)| half > *width).map_or(DIGITS_MOST, |(_, digits)| *digits)
}

pub fn short(value: f64) -> String {
    trimmed(&format!("{value:.4}")).to_owned()
}

/// A length in millimetres, without its unit.
pub fn mm(metres: f64) -> String {
    short(metres / MM)
}

/// A probability that a crack is missed; below 1e-3 none is claimed, since inspections are hardly independent of each other.
pub fn chance(probability: f64) -> String {
    if probability < 1e-3 { "below 1e-3".to_owned() } else { format!("{probability:.2e}") }
}

pub fn two_digits(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// Digits without zeros behind their decimal point.
pub fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// Keys of results that stay as they are: what was given, names, hashes, lists of keys, and constants whose name says SI.
const KEPT: [&str; 15] = [
    "case", "constants_si", "commit", "design", "file", "finished", "fatigue", "inputs", "key", "kinds", "laws", "name",
    "overrides", "sources", "version",
];
/// Keys whose fields belong to the constants that stand beside them.
const ERRORS: &str = "standard_errors";
const CONSTANTS: &str = "constants";

/// A result in the units of `to`: numbers by their keys, and words by `told`.
pub fn of_result(value: &Value, to: System, told: fn(&str) -> String) -> Value {
    match value {
        Value::Object(fields) => of_fields(fields, fields, to, told),
        Value::Array(items) => items.iter().map(|item| of_result(item, to, told)).collect(),
        Value::String(words) => told(words).into(),
        other => other.clone(),
    }
}

/// A result that was written in either units, in metric ones; its words are metric.
pub fn metric_result(value: Value) -> Value {
    let is_us = value.as_object().is_some_and(|fields| fields.keys().any(|key| renamed(key, System::Si).is_some()));
    if is_us { of_result(&value, System::Si, str::to_owned) } else { value }
}

fn of_fields(fields: &Map<String, Value>, beside: &Map<String, Value>, to: System, told: fn(&str) -> String) -> Value {
    let field = |(key, value): (&String, &Value)| {
        if KEPT.contains(&key.as_str()) {
            return (key.clone(), value.clone());
        }
        if let (ERRORS, Some(errors), Some(constants)) =
            (key.as_str(), value.as_object(), fields.get(CONSTANTS).and_then(Value::as_object))
        {
            return (key.clone(), of_fields(errors, constants, to, told));
        }
        let Some(new) = renamed(key, to) else { return (key.clone(), of_result(value, to, told)) };
        match new.factor(|name| beside.get(name).and_then(Value::as_f64)) {
            Ok(factor) => (new.name, scaled(value, factor)),
            // Not known, or of an exponent that is not: as it is.
            Err(_) if value.is_null() => (new.name, Value::Null),
            Err(_) => (key.clone(), value.clone()),
        }
    };
    Value::Object(fields.iter().map(field).collect())
}

fn scaled(value: &Value, factor: f64) -> Value {
    match value {
        Value::Number(number) => number.as_f64().map_or(Value::Null, |number| clean(number * factor).into()),
        Value::Array(items) => items.iter().map(|item| scaled(item, factor)).collect(),
        other => other.clone(),
    }
}

/// A result as it is printed, in the units that are shown.
pub fn shown_result(value: &Value) -> Value {
    in_shown(value, told)
}

/// A result as it is written: numbers in the units that are shown, words metric, so that a report in either units rounds once.
pub fn written_result(value: &Value) -> Value {
    in_shown(value, str::to_owned)
}

fn in_shown(value: &Value, told: fn(&str) -> String) -> Value {
    if shown() == System::Si { value.clone() } else { of_result(value, shown(), told) }
}

/// Now, RFC 3339 in UTC to the second: `2026-11-25T19:01:55Z`.
pub fn now() -> String {
    humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string()
}
