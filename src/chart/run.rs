//! One run of a scene: time from its text to its answer, memory, error.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::scene::{Found, Scene};
use crate::calibration::median::median;
use crate::case::budget::machine;
use crate::case::{Case, Method};
use crate::error::Result;
use crate::fatigue::Driver;
use crate::units::MM;

/// Seconds that a run shorter than them is repeated for.
const SHORT_S: f64 = 0.05;

/// What a run took and found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Seconds of wall time, set-up included; the median where a short run was repeated.
    pub wall_s: f64,
    /// Peak memory of the process, MB.
    pub memory_mb: f64,
    /// Size of the error, percent.
    pub error_percent: f64,
    /// Distance of the path from that of the truth, rms, mm.
    pub path_rms_mm: Option<f64>,
    /// Points or nodes.
    pub points: usize,
    /// Equilibrium solves.
    pub solves: usize,
    /// What ran.
    pub model: Model,
    /// Measured blocks from which the time is extrapolated, where it is.
    pub extrapolated_from_blocks: Option<usize>,
}

/// The model of a run, by the names of an input file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// What drives the cracks; empty where none grows.
    pub driver: String,
    /// Bond law; empty without bonds.
    pub bond_law: String,
    /// Solver.
    pub solver: String,
    /// `lattice`, `dual_horizon`, `nodes`, or empty.
    pub discretisation: String,
    /// Spacing of points, or of nodes far from cracks, mm.
    pub spacing_mm: Option<f64>,
    /// Horizon over spacing.
    pub horizon_ratio: Option<f64>,
    /// Error of a step asked for, percent; largest step of a tip over its room on nodes.
    pub step: Option<f64>,
}

/// Runs a scene with these keys in this process; its peak of memory is that of the process.
pub fn once(scene: &Scene, set: &[String]) -> Result<Run> {
    let timed = || -> Result<(Case, Found, f64)> {
        let started = Instant::now();
        let case = scene.case(set)?;
        let found = scene.run(&case)?;
        Ok((case, found, started.elapsed().as_secs_f64()))
    };
    let (case, found, first) = timed()?;
    let mut walls = vec![first];
    while walls.iter().sum::<f64>() < SHORT_S {
        walls.push(timed()?.2);
    }
    Ok(Run {
        wall_s: median(&walls),
        memory_mb: machine::peak_mb(),
        error_percent: found.error_percent,
        path_rms_mm: found.path_rms_mm,
        points: found.points,
        solves: found.solves,
        model: Model::of(&case, scene.grows()),
        extrapolated_from_blocks: None,
    })
}

impl Model {
    /// That of a case.
    pub fn of(case: &Case, grows: bool) -> Model {
        let model = &case.model;
        let points = model.method == Method::Peridynamics;
        let driver = match (grows, model.method, case.fatigue.driver) {
            (false, ..) => "",
            (true, Method::Handbook, _) => Method::Handbook.name(),
            (true, Method::ElementFreeGalerkin, _) => Driver::TipField.name(),
            (true, Method::Peridynamics, driver) => driver.name(),
        };
        let nodes = model.method == Method::ElementFreeGalerkin;
        let resolution = &model.element_free;
        let step = match (grows, points, nodes) {
            (true, true, _) => Some(case.fatigue.step_error_percent),
            (true, _, true) => Some(resolution.step_share),
            _ => None,
        };
        let solver = if points {
            model.solver.name()
        } else if nodes {
            "direct"
        } else {
            "quadrature"
        };
        let discretisation = match (points, nodes) {
            (true, _) => "lattice",
            (false, true) => "nodes",
            _ => "",
        };
        let millimetres = |metres: f64| (1e6 * metres / MM).round() / 1e6;
        Model {
            driver: driver.to_owned(),
            bond_law: if points { model.bond_law.kind.name().to_owned() } else { String::new() },
            solver: solver.to_owned(),
            discretisation: discretisation.to_owned(),
            spacing_mm: match (points, nodes) {
                (true, _) => Some(millimetres(model.spacing)),
                (false, true) => Some(millimetres(resolution.resolution.far)),
                _ => None,
            },
            horizon_ratio: points.then_some(model.horizon_ratio),
            step,
        }
    }
}

/// Points of a plate of one spacing by its area, near enough for a table.
pub(super) fn points_of(case: &Case) -> usize {
    let spacing = match case.model.method {
        Method::ElementFreeGalerkin => case.model.element_free.resolution.far,
        _ => case.model.spacing,
    };
    (case.specimen.area() / spacing.powi(2)).round() as usize
}
