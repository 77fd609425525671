//! What a fracture scene gives.

use serde::{Deserialize, Serialize};

use super::contact::Touching;
use perilife_base::raster::{PointGrid, Snapshot};
use perilife_plate::specimen::Point;

perilife_base::kinds! {
    /// Why a scene ended.
    pub enum SceneEnd for "stop_reason (fracture)" {
        Done = "done": "all load steps or the whole duration completed",
        Separated = "separated": "complete separation of the plate",
        LoadFallen = "load_fallen": "platen load fell 10 % below its peak",
        NoConvergence = "no_convergence": "a load step did not converge; histories so far are written",
        Unstable = "unstable": "time integration became unstable; histories so far are written",
    }
}

/// One row of `history.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct HistoryRow {
    /// Load or time step.
    pub step: usize,
    /// Time, s; 0 in scenes without time.
    pub time: f64,
    /// Displacement of the loads along their direction, summed over them, m.
    pub displacement: f64,
    /// Mean force of the loads along their direction, N.
    pub load: f64,
    /// Bonds broken since the start.
    pub broken_bonds: usize,
    /// Kinetic energy, J.
    pub kinetic: f64,
    /// Strain energy, J.
    pub strain: f64,
    /// Energy taken by damage, J.
    pub fracture: f64,
    /// Work of loads and driven points, J.
    pub work: f64,
}

/// A point of a crack path: where a crack front stood after a step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PathPoint {
    /// Front: initial tips first, in the order of `Specimen::tips`, then new fronts as they appear.
    pub tip: usize,
    pub step: usize,
    /// Time, s.
    pub time: f64,
    /// Place, m.
    pub position: Point,
    pub damage: f64,
    /// Speed of the front on its way there, m/s: from where and when it was taken down last; 0 without time.
    pub speed: f64,
}

/// Figures of a scene's run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SceneFigures {
    pub points: usize,
    pub bonds: usize,
    pub evaluations: usize,
    /// Time step, s; 0 without time.
    pub time_step: f64,
    /// How flanks stand at the end, where they are kept apart.
    pub touching: Option<Touching>,
    pub wall_s: f64,
    /// Peak memory of the process, MB.
    pub memory_mb: f64,
}

/// What a scene gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Fracture {
    /// History, one row a load step; in time at even distances.
    pub history: Vec<HistoryRow>,
    /// Crack fronts in the order of time.
    pub path: Vec<PathPoint>,
    /// The same of the points whose damage has reached 0.5.
    pub cracking: Vec<PathPoint>,
    /// States for pictures: first, some between, last. `cycles` holds the time in s, or the step.
    pub snapshots: Vec<Snapshot>,
    pub grid: PointGrid,
    pub end: SceneEnd,
    /// First step in which a bond broke.
    pub onset_step: Option<usize>,
    /// Step after which loads and supports were no longer joined by bonds.
    pub separated_step: Option<usize>,
    pub figures: SceneFigures,
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl Fracture {
    /// Largest load, N.
    pub fn peak_load(&self) -> f64 {
        self.history.iter().fold(0.0, |peak, row| f64::max(peak, row.load))
    }
}
