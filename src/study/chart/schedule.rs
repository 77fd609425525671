//! In which order what is run how often: every run in a process of its own, in random order, with reference runs in between.

use std::time::Instant;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};

use super::{Chart, Choice, Found, Panel, Point, SCENES, choices};
use crate::tasks::Outcome;
use perilife_base::error::Result;
use perilife_base::machine;
use perilife_base::units::MM;
use perilife_calibration::median::median;
use perilife_calibration::sweep::distribution::shuffle;
use perilife_growth::case::{self, Case, Method};
use perilife_growth::predict::Silent;
use perilife_laws::Driver;

/// Seed of the order: the same runs in the same order every time.
const SEED: u64 = 1;
/// Seconds after which a reference run no longer counts as beside a run.
const REFERENCE_FRESH_S: f64 = 20.0;
/// Runs of a point by the seconds of its first one: up to these seconds, so many.
const RUNS: [(f64, usize); 3] = [(2.0, 5), (20.0, 3), (f64::INFINITY, 1)];

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Quick choices only, a run each.
    pub is_quick: bool,
    /// Seconds a run may take.
    pub limit_s: f64,
}

impl Effort {
    /// Under an hour on two cores.
    pub const FULL: Effort = Effort { is_quick: false, limit_s: 120.0 };
    /// Under three minutes.
    pub const QUICK: Effort = Effort { is_quick: true, limit_s: 20.0 };

    /// Runs of a point whose first one took so many seconds.
    fn runs(self, first_s: f64) -> usize {
        if self.is_quick { 1 } else { RUNS.iter().find(|(seconds, _)| first_s <= *seconds).map_or(1, |(_, runs)| *runs) }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Request {
    pub scene: String,
    pub set: Vec<String>,
}

/// A run, and the reference run beside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchmarkRecord {
    pub request: Request,
    pub outcome: Outcome<BenchmarkRun>,
    pub reference_s: f64,
}

/// Runs a request in a process of its own, no longer than so many seconds.
pub type Isolated<'a> = &'a dyn Fn(&Request, f64) -> Result<Outcome<BenchmarkRun>>;

pub type Keep<'a> = &'a mut dyn FnMut(&BenchmarkRecord) -> Result<()>;

struct Measuring<'a> {
    isolated: Isolated<'a>,
    keep: Keep<'a>,
    limit_s: f64,
    /// Seconds of the last reference run, and when it ended.
    reference: Option<(f64, Instant)>,
    references: Vec<f64>,
    records: Vec<BenchmarkRecord>,
}

impl Measuring<'_> {
    fn reference(&mut self) -> Result<f64> {
        if let Some((wall, _)) = self.reference.filter(|(_, at)| at.elapsed().as_secs_f64() < REFERENCE_FRESH_S) {
            return Ok(wall);
        }
        // The default run of the first scene.
        let request = Request { scene: SCENES[0].name.clone(), set: Vec::new() };
        let wall = (self.isolated)(&request, f64::INFINITY)?.done().map_or(f64::NAN, |run| run.wall_s);
        self.reference = Some((wall, Instant::now()));
        self.references.push(wall);
        Ok(wall)
    }

    fn measure(&mut self, request: Request) -> Result<()> {
        let reference_s = self.reference()?;
        let outcome = (self.isolated)(&request, self.limit_s)?;
        let record = BenchmarkRecord { request, outcome, reference_s };
        (self.keep)(&record)?;
        self.records.push(record);
        Ok(())
    }

    fn of<'r>(&'r self, request: &'r Request) -> impl Iterator<Item = &'r BenchmarkRecord> {
        self.records.iter().filter(move |record| record.request == *request)
    }
}

/// Measures the choices of these scenes; runs that are `known` from an earlier call are not made again.
pub fn measure(
    scenes: &[&'static Panel],
    effort: Effort,
    known: Vec<BenchmarkRecord>,
    isolated: Isolated<'_>,
    keep: Keep<'_>,
) -> Result<Chart> {
    let references = known.iter().map(|record| record.reference_s).collect();
    let mut measuring = Measuring { isolated, keep, limit_s: effort.limit_s, reference: None, references, records: known };
    let mut planned: Vec<(&'static Panel, Choice, Request)> = Vec::new();
    for panel in scenes {
        for choice in choices(panel)?.into_iter().filter(|choice| choice.is_quick || !effort.is_quick) {
            let request = Request { scene: panel.name.clone(), set: choice.set.clone() };
            planned.push((panel, choice, request));
        }
    }
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut firsts: Vec<Request> = planned.iter().map(|(_, _, request)| request.clone()).collect();
    shuffle(&mut firsts, &mut random);
    for request in firsts {
        if measuring.of(&request).next().is_none() {
            measuring.measure(request)?;
        }
    }
    let repeats = planned.iter().flat_map(|(_, _, request)| {
        let walls: Vec<f64> = measuring.of(request).filter_map(|record| Some(record.outcome.done()?.wall_s)).collect();
        let wanted = walls.first().map_or(0, |first| effort.runs(*first)).saturating_sub(walls.len());
        vec![request.clone(); wanted]
    });
    let mut repeats: Vec<Request> = repeats.collect();
    shuffle(&mut repeats, &mut random);
    for request in repeats {
        measuring.measure(request)?;
    }
    let points = planned.into_iter().map(|(panel, choice, request)| point(panel, choice, measuring.of(&request))).collect();
    Ok(Chart::new(points, &measuring.references))
}

fn point<'r>(panel: &'static Panel, choice: Choice, records: impl Iterator<Item = &'r BenchmarkRecord>) -> Point {
    let outcome = Outcome::Failed("was not run".to_owned());
    let mut point = Point { panel, choice, outcome, walls: Vec::new(), ratios: Vec::new(), is_on_front: false };
    for record in records {
        if let Some(run) = record.outcome.done() {
            point.walls.push(run.wall_s);
            point.ratios.push(run.wall_s / record.reference_s);
        }
        point.outcome = record.outcome.clone();
    }
    point
}

/// Seconds that a run shorter than them is repeated for.
const SHORT_S: f64 = 0.05;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchmarkRun {
    /// Seconds of wall time, set-up included; the median where a short run was repeated.
    pub wall_s: f64,
    pub memory_mb: f64,
    pub error_percent: f64,
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
