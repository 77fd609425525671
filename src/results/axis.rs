//! An axis of a chart: range, ticks and how numbers are written along it. Linear or logarithmic.

use super::format::{AXIS, clean, trimmed};
use perilife_base::units::shown::per;

/// Linear or logarithmic axis. Whole decades alone would leave ΔK from 8 to 40 MPa√m with one tick.
#[derive(Debug, Clone)]
pub struct Axis {
    low: f64,
    high: f64,
    logarithmic: bool,
    labelled: Vec<f64>,
    faint: Vec<f64>,
    /// What a linear one was asked to hold, and in how many steps.
    asked: [f64; 2],
    parts: f64,
    /// What numbers along it are multiplied by.
    written: f64,
}

impl Axis {
    /// Linear axis that holds all `values`, from zero where that wastes little.
    pub fn linear(values: impl Iterator<Item = f64>) -> Axis {
        let (mut low, high) = bounds(values.filter(|v| v.is_finite())).unwrap_or((0.0, 1.0));
        if low > 0.0 && low < 0.5 * high {
            low = 0.0;
        }
        Self::linear_in([low, high].into_iter(), 6.0)
    }

    /// Linear axis that holds all `values` and no more, in about so many steps.
    pub fn linear_in(values: impl Iterator<Item = f64>, parts: f64) -> Axis {
        let (mut low, mut high) = bounds(values.filter(|v| v.is_finite())).unwrap_or((0.0, 1.0));
        if high - low <= 1e-9 * high.abs().max(1e-300) {
            (low, high) = (low - 0.05 * low.abs().max(1.0), high + 0.05 * high.abs().max(1.0));
        }
        let asked = [low, high];
        let step = nice_step((high - low) / parts);
        (low, high) = ((low / step + 1e-9).floor() * step, (high / step - 1e-9).ceil() * step);
        let count = ((high - low) / step).round() as usize;
        let labelled: Vec<f64> = (0..=count).map(|i| low + i as f64 * step).collect();
        Axis { low, high, logarithmic: false, labelled, faint: Vec::new(), asked, parts, written: 1.0 }
    }

    /// Logarithmic axis that holds all positive `values`.
    pub fn logarithmic(values: impl Iterator<Item = f64>) -> Axis {
        let (low, high) = bounds(values.filter(|v| v.is_finite() && *v > 0.0)).unwrap_or((1.0, 10.0));
        Self::logarithmic_between(low / 1.12, high * 1.12) // keeps marks off the frame
    }

    /// The same with room for names around the values: a twelfth of the axis at each end.
    pub fn logarithmic_wide(values: impl Iterator<Item = f64>) -> Axis {
        let (low, high) = bounds(values.filter(|v| v.is_finite() && *v > 0.0)).unwrap_or((1.0, 10.0));
        let room = (high / low).powf(0.1).max(1.3);
        Self::logarithmic_between(low / room, high * room)
    }

    /// Logarithmic axis from one value to another.
    pub fn logarithmic_between(low: f64, high: f64) -> Axis {
        let decades = (high / low).log10();
        let multiples: &[f64] = match decades {
            d if d > 3.0 => &[1.0],
            d if d > 1.5 => &[1.0, 2.0, 5.0],
            d if d > 0.7 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
            _ => &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0, 9.0],
        };
        let ticks = |multiples: &[f64]| {
            let exponents = (low.log10().floor() as i32)..=(high.log10().ceil() as i32);
            let all = exponents.flat_map(|e| multiples.iter().map(move |m| m * 10f64.powi(e)).collect::<Vec<_>>());
            all.filter(|v| (low..=high).contains(v)).collect::<Vec<f64>>()
        };
        let faint = ticks(if decades > 2.0 { &[1.0] } else { multiples });
        let (asked, labelled) = ([low, high], ticks(multiples));
        Axis { low, high, logarithmic: true, labelled, faint, asked, parts: 1.0, written: 1.0 }
    }

    /// The axis of quantities of this name, with round numbers in the units that are shown; values stay metric.
    pub fn named(self, name: &str) -> Axis {
        let word = name.rsplit_once(", ").map_or("", |(_, unit)| unit);
        let factor = per(word);
        if factor == 1.0 {
            return self;
        }
        let [low, high] = self.asked.map(|end| end * factor);
        let own = if self.logarithmic {
            Self::logarithmic_between(low, high)
        } else {
            Self::linear_in([low, high].into_iter(), self.parts)
        };
        let back = |values: Vec<f64>| values.into_iter().map(|value| value / factor).collect();
        Axis {
            low: own.low / factor,
            high: own.high / factor,
            labelled: back(own.labelled),
            faint: back(own.faint),
            written: factor,
            ..own
        }
    }

    /// Where a logarithmic axis has lines across: whole decades, or every labelled tick of one that is shorter than two.
    pub fn faint(&self) -> &[f64] {
        &self.faint
    }

    /// Labelled ticks with their words.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        self.labelled.iter().map(|value| (*value, self.format(*value))).collect()
    }

    pub fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Part of the way from the low end at which a value stands.
    pub fn share(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value.max(1e-300) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }
}

impl Axis {
    fn format(&self, value: f64) -> String {
        let value = clean(value * self.written);
        if self.logarithmic {
            return tick_text(value, 0.0, 0);
        }
        // All labels of a linear axis carry as many decimals as the one that needs most: 10.00, 10.01.
        let decimals_of = |v: &f64| trimmed(&format!("{v:.6}")).split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let decimals = self.labelled.iter().map(|tick| decimals_of(&(tick * self.written))).max().unwrap_or(0);
        tick_text(value, self.written * self.high.abs().max(self.low.abs()), decimals)
    }
}

fn bounds(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range: Option<(f64, f64)>, v| Some(range.map_or((v, v), |(low, high)| (low.min(v), high.max(v)))))
}

/// 1, 2, 2.5 or 5 times a power of ten, not below `rough`.
pub(super) fn nice_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= rough * (1.0 - 1e-9)).unwrap_or(rough)
}

/// A number as people write it beside an axis: `0.5`, `20`, `50 000`, `2·10⁷`, `10⁻⁴`. On an axis that reaches `largest`
/// all numbers keep one style, with at least so many `decimals`.
fn tick_text(value: f64, largest: f64, decimals: usize) -> String {
    let value = if value.abs() < 1e-9 * largest { 0.0 } else { value };
    let size = largest.max(value.abs());
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(9e-3..0.999e7).contains(&size) {
        let text = format!("{value:.6e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let mantissa = trimmed(mantissa);
        let power = format!("10{}", superscript(exponent));
        return if mantissa == "1" { power } else { format!("{mantissa}·{power}") };
    }
    let text = if decimals > 0 { format!("{value:.decimals$}") } else { trimmed(&format!("{value:.6}")).to_owned() };
    AXIS.digits(&text)
}

fn superscript(exponent: &str) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        _ => '⁹',
    };
    exponent.chars().map(raised).collect()
}
