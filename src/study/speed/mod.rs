//! The speed-accuracy chart as files: table, picture, summary.

mod picture;
mod summary;

use std::path::Path;

use crate::chart::run::Model;
use crate::chart::{Chart, Point};
use perilife_base::cells::defused;
use perilife_base::columns::exact_text as exact;
use perilife_base::error::Result;
use perilife_results::output::write_file;
use perilife_results::time;

pub use picture::svg;
pub use summary::{beaten, fastest_within, markdown, never_on_front};

pub const FILES: [&str; 3] = ["chart.csv", "chart.svg", "summary.md"];

/// Where a chart comes from.
#[derive(Debug, Clone)]
pub struct Origin {
    pub command: String,
    pub date: String,
}

impl Origin {
    pub fn now(command: String) -> Origin {
        Origin { command, date: time::now() }
    }

    /// The line under chart and tables: command, machine, threads, version, date.
    pub fn footer(&self, chart: &Chart) -> String {
        let reference = seconds(chart.reference_s);
        format!("`{}` · {} · reference run {reference} · {}", self.command, chart.machine, self.date)
    }
}

pub fn write(folder: &Path, chart: &Chart, origin: &Origin) -> Result<()> {
    let texts = [csv(chart), svg(chart, origin), markdown(chart, origin)];
    FILES.iter().zip(texts).try_for_each(|(file, text)| write_file(&folder.join(file), text.as_bytes()))
}

/// Columns of `chart.csv`.
pub const COLUMNS: &str = "scene,method,driver,bond_law,solver,discretisation,spacing_mm,horizon_ratio,step,points,solves,error_percent,\
                           path_rms_mm,truth,truth_uncertainty_percent,wall_s,time_ratio,runs,spread_percent,memory_mb,threads,version,\
                           extrapolated,status,command,choice,on_front,reason";

/// `chart.csv`: one row a point, in the order of scenes and choices.
pub fn csv(chart: &Chart) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing into memory cannot fail.
    let _ = writer.write_record(COLUMNS.split(','));
    for point in &chart.points {
        let _ = writer.write_record(fields(point, chart).iter().map(|text| defused(text).into_owned()));
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

fn fields(point: &Point, chart: &Chart) -> Vec<String> {
    let (scene, run) = (point.panel, point.outcome.done());
    let model = |of: fn(&Model) -> &str| run.map_or_else(String::new, |run| of(&run.model).to_owned());
    let number = |value: Option<f64>| value.map_or_else(String::new, exact);
    let count = |value: Option<usize>| value.map_or_else(String::new, |count| count.to_string());
    vec![
        point.panel.name.clone(),
        point.choice.family.name().to_owned(),
        model(|model| &model.driver),
        model(|model| &model.bond_law),
        model(|model| &model.solver),
        model(|model| &model.discretisation),
        number(run.and_then(|run| run.model.spacing_mm)),
        number(run.and_then(|run| run.model.horizon_ratio)),
        number(run.and_then(|run| run.model.step)),
        count(run.map(|run| run.points)),
        count(run.map(|run| run.solves)),
        number(run.map(|run| run.error_percent)),
        number(run.and_then(|run| run.path_rms_mm)),
        scene.truth.clone(),
        exact(scene.uncertainty_percent),
        number(point.wall_s()),
        number(point.time_ratio()),
        point.walls.len().to_string(),
        number(point.spread_percent()),
        number(run.map(|run| run.memory_mb)),
        chart.machine.threads.to_string(),
        chart.machine.version.to_owned(),
        // The column is older than the rule that every time is measured.
        false.to_string(),
        point.status().name().to_owned(),
        point.command(),
        point.choice.name(),
        point.is_on_front.to_string(),
        point.outcome.reason().unwrap_or_default().to_owned(),
    ]
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
