//! Speed against accuracy: what a result costs with every method, and how far it is from a truth that none of them gave.
//!
//! A [`scene`] has an answer from a handbook or from finite elements. Its [`choice`]s are methods, resolutions, laws, solvers and
//! steps. [`run`] makes one run of a choice; [`schedule`] makes all of them in random order, each in a process of its own, beside
//! reference runs. What is refused or fails is a point of the [`Chart`] as well, with its reason.

pub mod choice;
pub mod machine;
pub mod pareto;
pub mod run;
pub mod scene;
pub mod schedule;
pub mod static_scenes;
pub mod summary;

pub use choice::{Choice, Family};
pub use machine::Machine;
pub use run::Run;
pub use scene::{SCENES, Scene};

use crate::calibration::median::median;
use crate::error::{Result, input};

crate::kinds! {
    /// What came of a point of the chart.
    pub enum Status for "status of the chart" {
        Measured = "measured": "ran, and its time is the median of its runs",
        Extrapolated = "extrapolated": "its time is extrapolated from measured blocks along the run",
        Refused = "refused": "the program refuses the case",
        Failed = "failed": "the run failed, or its cracks end elsewhere than those of the truth",
        Stopped = "stopped": "took longer than a run may",
    }
}

/// A point of the chart: a choice in a scene.
#[derive(Debug, Clone)]
pub struct Point {
    /// Scene.
    pub scene: &'static Scene,
    /// Choice.
    pub choice: Choice,
    /// What came of it.
    pub status: Status,
    /// Why there is no result, where there is none.
    pub reason: String,
    /// Its last run.
    pub run: Option<Run>,
    /// Seconds of every run.
    pub walls: Vec<f64>,
    /// The same over those of the reference run beside it.
    pub ratios: Vec<f64>,
    /// Whether no other point of its scene is both faster and nearer to the truth.
    pub is_on_front: bool,
}

/// A finished chart.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Points, scene by scene.
    pub points: Vec<Point>,
    /// Median of all reference runs, s.
    pub reference_s: f64,
    /// What it was measured on.
    pub machine: Machine,
}

impl Point {
    /// Median of the wall times, s.
    pub fn wall_s(&self) -> Option<f64> {
        (!self.walls.is_empty()).then(|| median(&self.walls))
    }

    /// Median of the wall times over those of the reference run.
    pub fn time_ratio(&self) -> Option<f64> {
        (!self.ratios.is_empty()).then(|| median(&self.ratios))
    }

    /// Largest less least wall time over the median, percent.
    pub fn spread_percent(&self) -> Option<f64> {
        let [least, most] = self.range_s()?;
        Some(100.0 * (most - least) / self.wall_s()?)
    }

    /// Least and largest wall time, s.
    pub fn range_s(&self) -> Option<[f64; 2]> {
        let least = self.walls.iter().copied().fold(f64::INFINITY, f64::min);
        (!self.walls.is_empty()).then(|| [least, self.walls.iter().copied().fold(0.0, f64::max)])
    }

    /// Place in the chart: seconds, error in percent.
    pub fn place(&self) -> Option<(f64, f64)> {
        Some((self.wall_s()?, self.run.as_ref()?.error_percent)).filter(|(_, error)| error.is_finite())
    }

    /// The command that repeats a run of it.
    pub fn command(&self) -> String {
        let sets = self.choice.set.iter().map(|key| {
            let plain = key.chars().all(|c| c.is_ascii_alphanumeric() || "._=-".contains(c));
            if plain { format!(" --set {key}") } else { format!(" --set '{key}'") }
        });
        format!("perilife chart {} --once{}", self.scene.name, sets.collect::<String>())
    }
}

impl Chart {
    /// The chart of these points, fronts marked; `references` are the seconds of reference runs.
    pub fn new(mut points: Vec<Point>, references: &[f64]) -> Chart {
        for scene in SCENES {
            let of_scene: Vec<usize> = (0..points.len()).filter(|&i| points[i].scene.name == scene.name).collect();
            let place = |&i: &usize| {
                points[i].place().map_or((f64::NAN, f64::NAN), |(time, error)| {
                    // Below its own uncertainty the truth cannot tell errors apart.
                    (time, error.max(scene.truth_uncertainty_percent))
                })
            };
            let places: Vec<(f64, f64)> = of_scene.iter().map(place).collect();
            pareto::front(&places).into_iter().for_each(|at| points[of_scene[at]].is_on_front = true);
        }
        let known: Vec<f64> = references.iter().copied().filter(|seconds| seconds.is_finite()).collect();
        let reference_s = if known.is_empty() { f64::NAN } else { median(&known) };
        Chart { points, reference_s, machine: Machine::here() }
    }

    /// Scenes that have points, in their order.
    pub fn scenes(&self) -> Vec<&'static Scene> {
        SCENES.iter().filter(|scene| self.of(scene).next().is_some()).collect()
    }

    /// Points of a scene.
    pub fn of<'c>(&'c self, scene: &'c Scene) -> impl Iterator<Item = &'c Point> {
        self.points.iter().filter(|point| point.scene.name == scene.name)
    }
}

/// The scenes of these names, all where no name is given.
///
/// # Errors
/// A name that no scene bears.
pub fn scenes(names: &[String]) -> Result<Vec<&'static Scene>> {
    if names.is_empty() {
        return Ok(SCENES.iter().collect());
    }
    let known = || SCENES.iter().map(|scene| scene.name).collect::<Vec<_>>().join(", ");
    let find = |name: &String| {
        let found = SCENES.iter().find(|scene| scene.name == name);
        found.ok_or_else(|| input("SCENE", name, "is not a scene of the chart", format!("known are {}", known())))
    };
    names.iter().map(find).collect()
}
