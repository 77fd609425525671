//! One run of a scene: time from its text to its answer, memory, error.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::{Found, Panel};
use perilife_base::error::Result;
use perilife_base::machine;
use perilife_base::units::MM;
use perilife_calibration::median::median;
use perilife_growth::case::{self, Case, Method};
use perilife_growth::predict::Silent;
use perilife_laws::Driver;

/// Seconds that a run shorter than them is repeated for.
const SHORT_S: f64 = 0.05;

/// What a run took and found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchmarkRun {
    /// Seconds of wall time, set-up included; the median where a short run was repeated.
    pub wall_s: f64,
    /// Peak memory of the process, MB.
    pub memory_mb: f64,
    pub error_percent: f64,
    /// Distance of the path from that of the truth, rms, mm.
    pub path_rms_mm: Option<f64>,
    pub points: usize,
    pub solves: usize,
    pub model: Model,
}

/// The model of a run, by the names of an input file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// What drives the cracks; empty where none grows.
    pub driver: String,
    /// Bond law; empty without bonds.
    pub bond_law: String,
    pub solver: String,
    /// `lattice`, `nodes`, or empty.
    pub discretisation: String,
    /// Spacing of points, or of nodes far from cracks, mm.
    pub spacing_mm: Option<f64>,
    /// Horizon over spacing.
    pub horizon_ratio: Option<f64>,
    /// Error of a step asked for, percent; largest step of a tip over its room on nodes.
    pub step: Option<f64>,
}

/// Runs a scene with these keys in this process; its peak of memory is that of the process.
pub fn once(panel: &Panel, set: &[String]) -> Result<BenchmarkRun> {
    let timed = || -> Result<(Found, f64)> {
        let started = Instant::now();
        Ok((panel.found(set, &Silent)?, started.elapsed().as_secs_f64()))
    };
    let (found, first) = timed()?;
    let mut walls = vec![first];
    while walls.iter().sum::<f64>() < SHORT_S {
        walls.push(timed()?.1);
    }
    Ok(BenchmarkRun {
        wall_s: median(&walls),
        memory_mb: machine::peak_mb(),
        error_percent: found.error_percent.abs(),
        path_rms_mm: found.path_rms_mm,
        points: found.points,
        solves: found.solves,
        model: Model::of(&found.case, panel.grows()),
    })
}

impl Model {
    fn of(case: &Case, grows: bool) -> Model {
        let mm = |metres: f64| Some((1e6 * metres / MM).round() / 1e6);
        let driver = |name: &str| if grows { name.to_owned() } else { String::new() };
        match case.model {
            case::Model::Points(points) => Model {
                driver: driver(case.fatigue.driver.name()),
                bond_law: points.bond_law.kind.name().to_owned(),
                solver: points.solver.name().to_owned(),
                discretisation: "lattice".to_owned(),
                spacing_mm: mm(points.spacing),
                horizon_ratio: Some(points.horizon_ratio),
                step: grows.then_some(case.fatigue.step_error_percent),
            },
            case::Model::Nodes(nodes) => Model {
                driver: driver(Driver::TipField.name()),
                solver: "direct".to_owned(),
                discretisation: "nodes".to_owned(),
                spacing_mm: mm(nodes.resolution.far),
                step: grows.then_some(nodes.step_share),
                ..Model::default()
            },
            case::Model::Handbook(_) => {
                Model { driver: driver(Method::Handbook.name()), solver: "quadrature".to_owned(), ..Model::default() }
            }
        }
    }
}
