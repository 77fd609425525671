//! Speed against accuracy: what a result costs with every method, and how far it is from a truth that none of them gave.
//!
//! A [`Panel`] is a question with a name (`data/studies/chart.toml`). Its [`Choice`]s are methods, resolutions, laws, solvers and steps. [`schedule::once`] makes one run of a
//! choice; [`schedule`] makes all of them in random order, each in a process of its own, beside reference runs. What is refused or
//! fails is a point of the [`Chart`] as well, with its reason.

pub mod schedule;

use std::sync::LazyLock;

use serde::Deserialize;
use toml::Table;

use super::cases::overrides;
use super::questions::{Asker, Question, SHARED, file, read};
use super::subject::{Subject, Watcher};
use super::tasks::{Outcome, chosen};
use super::values::{Values, percent};
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_calibration::median::median;
use perilife_growth::case::Case;
pub use schedule::BenchmarkRun;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Panel {
    /// Name, as `perilife chart NAME` takes it.
    pub name: String,
    pub about: String,
    pub tags: Vec<String>,
    pub quantity: String,
    pub truth: String,
    /// How far that may be off, percent.
    pub uncertainty_percent: f64,
    /// Formula of the distance of the path from that of the truth, rms, mm.
    path_mm: Option<String>,
    ask: Question,
    #[serde(default)]
    set: Table,
}

#[derive(Debug)]
pub struct Found {
    pub case: Case,
    pub error_percent: f64,
    pub path_rms_mm: Option<f64>,
    /// Points or nodes; 0 of a hand calculation.
    pub points: usize,
    pub solves: usize,
}

impl Panel {
    pub fn is(&self, tag: &str) -> bool {
        self.tags.iter().any(|own| own == tag)
    }

    pub fn grows(&self) -> bool {
        self.is("grows")
    }

    /// Its case with keys set by `section.key=value`.
    pub fn case(&self, set: &[String]) -> Result<Case> {
        let asker = Asker::new(&perilife_base::watch::Silent);
        Ok(asker.ask(&self.ask, &self.set).subject(set)?.case)
    }

    /// What it finds with keys set.
    /// Errors: those of the run; a run that ends otherwise than the truth.
    pub fn found(&self, set: &[String], observer: &dyn Watcher) -> Result<Found> {
        let asker = Asker::new(observer);
        let asking = asker.ask(&self.ask, &self.set);
        let subject: Subject<'_> = asking.subject(set)?;
        let case = subject.case.clone();
        let asking = asking.of_subject(subject);
        let truth = self.ask.truth.as_ref().map_or(Ok(1.0), |truth| asking.figure(truth))?;
        let error_percent = percent(asking.number(&self.ask.read)?, truth);
        let path_rms_mm = self.path_mm.as_ref().map(|path| asking.number(path)).transpose()?;
        let (points, solves) = asking.size();
        Ok(Found { case, error_percent, path_rms_mm, points, solves })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Measured {
    scene: Vec<Panel>,
    choice: Vec<Offer>,
}

/// Scenes in the order of the panels, and what is offered for them, from their file; `tests/unit/studies.rs` reads it with its errors.
pub fn read_scenes() -> Result<(Vec<Panel>, Vec<Offer>)> {
    let Measured { mut scene, choice } = read(file("chart.toml", include_str!("../../../data/studies/chart.toml"))?)?;
    let shared = file("shared.toml", SHARED)?;
    for panel in &mut scene {
        panel.set = shared.clone().into_iter().chain(std::mem::take(&mut panel.set)).collect();
    }
    Ok((scene, choice))
}

static READ: LazyLock<(Vec<Panel>, Vec<Offer>)> = LazyLock::new(|| read_scenes().unwrap_or_default());

pub static SCENES: LazyLock<&'static [Panel]> = LazyLock::new(|| &READ.0);

pub fn scenes(names: &[String]) -> Result<Vec<&'static Panel>> {
    if SCENES.is_empty() {
        read_scenes()?;
    }
    chosen(&SCENES, |panel| &panel.name, names, "SCENE", "is not a scene of the chart")
}

perilife_base::kinds! {
    pub enum Status for "status of the chart" {
        Measured = "measured": "completed; time is the median of its runs",
        Refused = "refused": "case refused",
        Failed = "failed": "failed, or cracks end elsewhere than in the reference",
        Stopped = "stopped": "time limit exceeded",
    }
}

/// A point of the chart: a choice in a scene.
#[derive(Debug, Clone)]
pub struct Point {
    pub panel: &'static Panel,
    pub choice: Choice,
    pub outcome: Outcome<BenchmarkRun>,
    pub walls: Vec<f64>,
    /// The same over those of the reference run beside it.
    pub ratios: Vec<f64>,
    /// Whether no other point of its scene is both faster and nearer to the truth.
    pub is_on_front: bool,
}

impl Point {
    pub fn status(&self) -> Status {
        match self.outcome {
            Outcome::Done(_) => Status::Measured,
            Outcome::Refused(_) => Status::Refused,
            Outcome::Failed(_) => Status::Failed,
            Outcome::Stopped(_) => Status::Stopped,
        }
    }

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
        Some((self.wall_s()?, self.outcome.done()?.error_percent)).filter(|(_, error)| error.is_finite())
    }

    pub fn command(&self) -> String {
        let sets = self.choice.set.iter().map(|key| {
            let plain = key.chars().all(|c| c.is_ascii_alphanumeric() || "._=-".contains(c));
            if plain { format!(" --set {key}") } else { format!(" --set '{key}'") }
        });
        format!("perilife chart {} --once{}", self.panel.name, sets.collect::<String>())
    }
}

#[derive(Debug, Clone)]
pub struct Chart {
    pub points: Vec<Point>,
    /// Median of all reference runs, s.
    pub reference_s: f64,
    pub machine: Machine,
}

impl Chart {
    /// The chart of these points, fronts marked; `references` are the seconds of reference runs.
    pub fn new(mut points: Vec<Point>, references: &[f64]) -> Chart {
        for panel in SCENES.iter() {
            let of_scene: Vec<usize> = (0..points.len()).filter(|&i| points[i].panel.name == panel.name).collect();
            let place = |&i: &usize| {
                points[i].place().map_or((f64::NAN, f64::NAN), |(time, error)| {
                    // Below its own uncertainty the truth cannot tell errors apart.
                    (time, error.max(panel.uncertainty_percent))
                })
            };
            let places: Vec<(f64, f64)> = of_scene.iter().map(place).collect();
            front(&places).into_iter().for_each(|at| points[of_scene[at]].is_on_front = true);
        }
        let known: Vec<f64> = references.iter().copied().filter(|seconds| seconds.is_finite()).collect();
        Chart { points, reference_s: median(&known), machine: Machine::here() }
    }

    pub fn scenes(&self) -> Vec<&'static Panel> {
        SCENES.iter().filter(|panel| self.of(panel).next().is_some()).collect()
    }

    pub fn of<'c>(&'c self, panel: &'c Panel) -> impl Iterator<Item = &'c Point> {
        self.points.iter().filter(|point| point.panel.name == panel.name)
    }
}

/// Relative gain of error that earns a slower run its place on a front: less is round-off between solvers that are equally exact.
const GAIN: f64 = 1e-3;

/// Pareto front of time and error: indices, fastest first, of points (time, error) that are nearer to the reference than every faster
/// one by more than `GAIN`. Points that are not finite have no place on it.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).filter(|&i| points[i].0.is_finite() && points[i].1.is_finite()).collect();
    order.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0).then(points[a].1.total_cmp(&points[b].1)));
    let mut best = f64::INFINITY;
    order.retain(|&i| {
        let nearer = points[i].1 < best * (1.0 - GAIN);
        if nearer {
            best = points[i].1;
        }
        nearer
    });
    order
}

/// Program, threads and vector units that a chart was measured with.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Machine {
    pub version: &'static str,
    pub threads: usize,
    /// Instruction set of the vectors that the kernels use, chosen when they run.
    pub instruction_set: String,
}

impl Machine {
    pub fn here() -> Self {
        // The name of the variant, without what it holds.
        let name = format!("{:?}", pulp::Arch::new());
        let instruction_set = name.split(['(', ' ']).next().unwrap_or_default().to_owned();
        Machine {
            version: env!("CARGO_PKG_VERSION"),
            threads: rayon::current_num_threads(),
            instruction_set: format!("{} {instruction_set}", std::env::consts::ARCH),
        }
    }
}

impl std::fmt::Display for Machine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Machine { version, threads, instruction_set } = self;
        write!(f, "perilife {version}, {threads} threads, {instruction_set}")
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    pub family: Family,
    /// What tells it from the default of its family, in words; empty for that default.
    pub words: String,
    pub set: Vec<String>,
    pub is_quick: bool,
}

perilife_base::kinds! {
    /// Families of methods: a colour of the chart each.
    pub enum Family for "method of the chart" {
        Auto = "auto": "default (automatic choice)",
        TipField = "tip_field": "points and bonds, growth driven by K",
        ElementFree = "element_free_galerkin": "element-free Galerkin nodes, growth driven by K",
        Handbook = "handbook": "handbook K, life by quadrature",
        BondStrain = "bond_strain": "bond_strain (published bond law)",
        BondLaw = "bond_law": "another bond law, kernel or correction than the default",
        Solver = "solver": "another solver than the default",
    }
}

/// A choice that the file offers to scenes with a tag, or to all.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Offer {
    family: Family,
    #[serde(default)]
    words: String,
    /// Keys, with formulas of the default `spacing_mm` of the scene.
    #[serde(default)]
    keys: String,
    #[serde(default)]
    quick: bool,
    tag: Option<String>,
}

/// The choices of a scene, the default first.
pub fn choices(panel: &Panel) -> Result<Vec<Choice>> {
    let spacing_mm = panel.case(&[])?.points().spacing / MM;
    let values = Table::from_iter([("spacing_mm".to_owned(), spacing_mm.into())]);
    let offered = READ.1.iter().filter(|offer| offer.tag.as_ref().is_none_or(|tag| panel.is(tag)));
    let choice = |offer: &Offer| {
        let set = overrides(&Values::alone(&values).text(&offer.keys)?);
        Ok(Choice { family: offer.family, words: offer.words.clone(), set, is_quick: offer.quick })
    };
    offered.map(choice).collect()
}

impl Choice {
    pub fn name(&self) -> String {
        if self.words.is_empty() { self.family.name().to_owned() } else { format!("{}, {}", self.family, self.words) }
    }

    /// Whether it is what runs when nothing is asked for.
    pub fn is_default(&self) -> bool {
        self.words.is_empty() && (self.family == Family::Auto || self.set.is_empty())
    }
}
