//! The speed-accuracy chart as files: table, picture, page, summary.

mod html;
mod summary;
mod svg;
mod table;

use std::path::Path;

use super::output::write_file;
use super::time;
use crate::chart::Chart;
use crate::error::Result;

pub use summary::markdown;
pub use svg::svg;
pub use table::{COLUMNS, csv};

/// Names of the files of a chart.
pub const FILES: [&str; 4] = ["chart.csv", "chart.svg", "chart.html", "summary.md"];

/// Where a chart comes from.
#[derive(Debug, Clone)]
pub struct Origin {
    /// The command that made it.
    pub command: String,
    /// When.
    pub date: String,
}

impl Origin {
    /// Of a command that ends now.
    pub fn now(command: String) -> Origin {
        Origin { command, date: time::now() }
    }

    /// The line under chart and tables: command, machine, threads, version, date.
    pub fn footer(&self, chart: &Chart) -> String {
        let reference = seconds(chart.reference_s);
        format!("`{}` · {} · reference run {reference} · {}", self.command, chart.machine, self.date)
    }
}

/// Writes all files.
pub fn write(folder: &Path, chart: &Chart, origin: &Origin) -> Result<()> {
    let picture = svg(chart, origin);
    let texts = [csv(chart), picture.clone(), html::page(chart, origin, &picture), markdown(chart, origin)];
    FILES.iter().zip(texts).try_for_each(|(file, text)| write_file(&folder.join(file), text.as_bytes()))
}

/// A time in the unit that suits it.
pub fn seconds(value: f64) -> String {
    match value {
        v if v.is_nan() => "-".to_owned(),
        v if v < 1e-3 => format!("{} µs", digits(1e6 * v)),
        v if v < 1.0 => format!("{} ms", digits(1e3 * v)),
        v => format!("{} s", digits(v)),
    }
}

/// Two significant digits, more of whole numbers.
pub fn digits(value: f64) -> String {
    let size = value.abs();
    match size {
        s if s.is_nan() => "-".to_owned(),
        0.0 => "0".to_owned(),
        s if s < 1e-3 => format!("{value:.1e}"),
        s => {
            let decimals = (1 - s.log10().floor() as i32).clamp(0, 5) as usize;
            format!("{value:.decimals$}")
        }
    }
}

/// Text in XML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
