//! A case that is asked about, and what can be read of it by name. Nothing is computed before it is asked for, and nothing twice.
//! Readings are in SI units, errors in percent.

use std::cell::OnceCell;
use std::path::Path;

use super::cases::{
    Compared, Curve, Reference, SHARES, by_name, by_quadrature, compare, growth_error, k_of_elements, largest, plate_alone,
};
use super::uniform_tension::{strip, uniform_tension_with};
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;
use perilife_calibration::median::cycles_of_run;
use perilife_growth::case::{Case, Model, PointSettings};
use perilife_growth::cracks::initial_tips;
use perilife_growth::cracks::steering::kink_angle;
use perilife_growth::nodes::NodePlate;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::error_estimate::error_estimate;
use perilife_growth::predict::tip_factors::{StressIntensityMethod, TipResult, stress_intensity};
use perilife_growth::predict::{CurvePoint, Observer, Prediction, predict};
use perilife_growth::record::TipRecord;
use perilife_growth::stress_concentration::{Stressed, stressed};
use perilife_nodes::basis::Enrichment;
use perilife_nodes::rim_stress::{Rim, RimStress};
use perilife_plate::specimen::geometry::distance;
use perilife_plate::specimen::handbook::{HandbookFormula, handbook_beside, handbook_tada};
use perilife_plate::specimen::pin::Contact;
use perilife_plate::specimen::{Bearing, Load, Point, Specimen};
use perilife_points::crack_tip::TipState;
use perilife_points::solver::Equilibrium;
use perilife_points::solver::field::Layout;
use perilife_points::state::Bonds;
use perilife_points::stress_intensity::{TipFrame, derivatives_at};
use perilife_scenes::SceneObserver;

pub trait Watcher: Observer + SceneObserver {}
impl<W: Observer + SceneObserver> Watcher for W {}

/// Part of the path that may be missing: a run may stop short of an edge, an end elsewhere is another answer.
const PATH_MISSING_MOST: f64 = 0.05;
/// Share of life over which paths are compared: in the last percent tips pass each other closer than points resolve.
const COMPARED: f64 = 0.99;
/// Shares of the way of a tip that was hardly begun when a joint ended it: it has no cycles to compare.
const BEGUN: f64 = 0.05;

#[derive(Debug, Clone)]
pub enum Source {
    Text(String),
    /// A plate alone: it need not have a crack, and its law is not read.
    Alone(String),
    /// A plate that finite elements have grown.
    Grown(&'static Reference),
}

pub struct Subject<'o> {
    source: Source,
    set: Vec<String>,
    observer: &'o dyn Watcher,
    pub case: Case,
    run: OnceCell<Prediction>,
    compared: OnceCell<Vec<Compared>>,
    tips: OnceCell<Vec<TipRecord>>,
    methods: [OnceCell<Vec<TipResult>>; 2],
    stressed: OnceCell<Stressed>,
    points: OnceCell<usize>,
}

/// What a cell holds, made where it is empty.
pub fn once<T>(cell: &OnceCell<T>, make: impl FnOnce() -> Result<T>) -> Result<&T> {
    if let Some(made) = cell.get() {
        return Ok(made);
    }
    let made = make()?;
    Ok(cell.get_or_init(|| made))
}

fn fault<T>(problem: impl Into<String>) -> Result<T> {
    Err(Error::Mechanics(problem.into()))
}

impl<'o> Subject<'o> {
    /// A case with keys set. Keys of `study.` change what no key of an input file can: the resolution of nodes, the place of the crack.
    pub fn new(source: Source, set: &[String], observer: &'o dyn Watcher) -> Result<Self> {
        let (own, keys): (Vec<String>, Vec<String>) = set.iter().cloned().partition(|key| key.starts_with("study."));
        let mut case = match &source {
            Source::Text(text) => Case::from_toml(text, "verification", Path::new("."), &by_name(text, &keys))?,
            Source::Alone(text) => plate_alone(text, &keys)?,
            Source::Grown(reference) => reference.case(&keys)?,
        };
        own.iter().try_for_each(|key| change(&mut case, key))?;
        let (run, compared, tips, methods) = Default::default();
        let (stressed, points) = Default::default();
        Ok(Subject { source, set: keys, observer, case, run, compared, tips, methods, stressed, points })
    }

    pub fn run(&self) -> Result<&Prediction> {
        once(&self.run, || predict(&self.case, self.observer))
    }

    fn last(&self) -> Result<&CurvePoint> {
        let run = self.run()?;
        Ok(&run.curve[run.curve.len() - 1])
    }

    /// K and T of the initial tips by the method of the case, as a prediction reads them.
    fn tip(&self, tip: f64) -> Result<&TipRecord> {
        let tips = once(&self.tips, || {
            let opened = match self.case.model {
                Model::Nodes(_) => initial_tips::<NodePlate>(&self.case),
                Model::Points(_) | Model::Handbook(_) => initial_tips::<PointPlate>(&self.case),
            };
            Ok(opened?.tips)
        })?;
        tips.get(tip as usize).map_or_else(|| fault(format!("{}: no tip {tip}", self.case.name)), Ok)
    }

    fn factors(&self, tip: f64) -> Result<[f64; 2]> {
        self.tip(tip)?.factors.map_or_else(|| fault(format!("tip {tip} has no K")), Ok)
    }

    fn by(&self, method: StressIntensityMethod, tip: f64) -> Result<[f64; 2]> {
        let found =
            once(&self.methods[usize::from(method != StressIntensityMethod::Ring)], || stress_intensity(&self.case, &[method]))?;
        let intensity = found[tip as usize].methods[0].intensity;
        Ok([intensity.k_i, intensity.k_ii].map(|k| k.unwrap_or(f64::NAN)))
    }

    /// What a handbook says at the crack length of the case.
    fn formula(&self, of: fn(&Specimen) -> Option<HandbookFormula>, says: impl Fn(&HandbookFormula, f64) -> f64) -> Result<f64> {
        let length = self.case.specimen.crack_length;
        let formula = of(&self.case.specimen).filter(|formula| formula.holds_at(length));
        formula.map_or_else(|| fault("no handbook formula"), |formula| Ok(says(&formula, length)))
    }

    fn rim(&self, rim: Rim, is_largest: bool) -> Result<f64> {
        let stressed = once(&self.stressed, || stressed(&self.case))?;
        let Some(found) = stressed.rims.iter().find(|found: &&RimStress| found.rim == rim) else {
            return fault(format!("{}: no such boundary", self.case.name));
        };
        let stress = if is_largest { found.largest.stress } else { found.least.stress };
        Ok(stressed.concentration(stress).unwrap_or(f64::NAN))
    }

    /// The contact of the pin that a load is, once it was sought.
    fn contact(&self, load: usize) -> Result<&Contact> {
        let found = match &self.case.specimen.loads[load] {
            Load::Pin { contact: Bearing::Elastic(pin), .. } => pin.found.as_deref(),
            _ => None,
        };
        found.map_or_else(|| fault(format!("{}: no pin in contact", self.case.name)), Ok)
    }

    fn reference(&self) -> Result<&'static Reference> {
        if let Source::Grown(reference) = self.source { Ok(reference) } else { fault("not a plate of data/reference") }
    }

    fn compared(&self) -> Result<&Vec<Compared>> {
        once(&self.compared, || Ok(compare(self.run()?, self.reference()?.tips()?, f64::INFINITY)))
    }

    /// Those that have grown, so that they have cycles to compare.
    fn begun(&self) -> Result<impl Iterator<Item = &Compared>> {
        Ok(self.compared()?.iter().filter(|tip| tip.length > BEGUN))
    }

    fn way(&self) -> Result<f64> {
        Ok(self.begun()?.map(|tip| tip.length).fold(f64::INFINITY, f64::min))
    }

    /// The row where bonds have handed all cracks over to the K of their tips.
    fn handed(&self) -> Result<&CurvePoint> {
        let row = self.run()?.curve.iter().find(|row| row.tips.iter().all(|tip| tip.factors.is_some()));
        row.map_or_else(|| fault("no crack initiated"), Ok)
    }

    pub fn read(&self, name: &str, values: &[f64]) -> Result<f64> {
        let number = |at: usize| values.get(at).copied().unwrap_or(0.0);
        match name {
            "life" => Ok(self.run()?.life_cycles()),
            "blocks" => Ok(self.run()?.figures.blocks as f64),
            "final_length" => Ok(self.run()?.crack_length_final()),
            "run_spacing" => Ok(self.run()?.figures.spacing),
            "spacing" => Ok(self.case.points().spacing),
            "cycles_to" => Ok(cycles_to(self.run()?, number(0) as usize, number(1))),
            "cycles_grown" => {
                let mean = |row: &CurvePoint| 0.5 * (row.tips[number(0) as usize].growth + row.tips[number(1) as usize].growth);
                let growth: Vec<(f64, f64)> = self.run()?.curve.iter().map(|row| (row.cycles, mean(row))).collect();
                Ok(cycles_of_run(&growth, &[0.0, number(2)])?[1])
            }
            "joined" => {
                let joined = self.run()?.curve.iter().find(|row| row.tips[number(0) as usize].state != TipState::Active);
                Ok(joined.map_or(f64::NAN, |row| row.cycles))
            }
            "growth" => Ok(self.last()?.tips[number(0) as usize].growth),
            "first_kink" => Ok(first_kink(&self.case, self.run()?, number(0) as usize)),
            "first_t" => Ok(self.run()?.curve[0].tips[number(0) as usize].t_stress.unwrap_or(f64::NAN)),
            "handed_cycles" => Ok(self.handed()?.cycles),
            "handed_growth" => Ok(self.handed()?.tips[0].growth),
            "stress" => Ok(self.case.loading.maximum),
            "stress_range" => Ok(self.case.loading.maximum * self.case.loading.range_share()),
            "paris_c" => Ok(self.case.paris_law()?.c),
            "k_i" => Ok(self.factors(number(0))?[0]),
            "k_ii" => Ok(self.factors(number(0))?[1]),
            "kink_of_tip" => {
                let [k_i, k_ii] = self.factors(number(0))?;
                let is_driven = k_i.hypot(k_ii) >= 1e-3 * number(1);
                if is_driven { Ok(kink_angle([k_i, k_ii])) } else { fault("the load does not open or shear the crack") }
            }
            "t_stress" => Ok(self.tip(number(0))?.t_stress.unwrap_or(f64::NAN)),
            "k_i_by_ring" => Ok(self.by(StressIntensityMethod::Ring, number(0))?[0]),
            "k_ii_by_ring" => Ok(self.by(StressIntensityMethod::Ring, number(0))?[1]),
            "k_i_on_nodes" => Ok(self.by(StressIntensityMethod::ElementFreeGalerkin, number(0))?[0]),
            "k_ii_on_nodes" => Ok(self.by(StressIntensityMethod::ElementFreeGalerkin, number(0))?[1]),
            "handbook" => self.formula(handbook_beside, |formula, a| formula.k_i(a, self.case.loading.maximum)),
            "handbook_error" => self.formula(handbook_beside, |formula, a| formula.error_at(a)),
            "tada" => self.formula(handbook_tada, |formula, a| formula.k_i(a, self.case.loading.maximum)),
            "k_of_elements" => k_of_elements(&self.case, number(0)),
            "quadrature" => by_quadrature(self.text()?, &self.set, None),
            "growth_error" => growth_error(self.text()?, &self.set, self.run()?, &SHARES),
            "largest" => self.rim(Rim::Hole(number(0) as usize), true),
            "least" => self.rim(Rim::Hole(number(0) as usize), false),
            "largest_of_outline" => self.rim(Rim::Outline, true),
            "stress_beside_hole" => match self.case.model {
                Model::Nodes(_) => self.rim(Rim::Hole(0), true),
                _ => self.beside_hole(number(0)),
            },
            "tension_error" => self.tension_error(),
            "contact_end" => Ok(self.contact(number(0) as usize)?.ends[number(1) as usize]),
            "path_rms" => Ok(self.begun()?.map(|tip| tip.rms).fold(0.0, f64::max)),
            "cycles_error" => Ok(largest(self.begun()?.map(|tip| tip.cycles[number(0) as usize]))),
            "cycles_worst" => Ok(largest(self.compared()?.iter().flat_map(|tip| tip.cycles))),
            "way_missing" => {
                // A run goes on where the reference stops short of an edge or of the other crack.
                let ended_alike = self.reference()?.ended_alike(self.run()?);
                Ok(if ended_alike { 100.0 * (1.0 - self.way()?).max(0.0) } else { 100.0 })
            }
            "cycles_to_same_end" => {
                let (run, tips) = (self.run()?, self.compared()?);
                let way = tips.iter().map(|tip| tip.length).fold(f64::INFINITY, f64::min);
                if way < 1.0 - PATH_MISSING_MOST || !self.reference()?.ended_alike(run) {
                    return fault(format!("another end: {} after {:.0} % of the path", run.stop, 100.0 * way));
                }
                Ok(largest(tips.iter().flat_map(|tip| tip.cycles)))
            }
            "path_of_all" => Ok(self.compared()?.iter().map(|tip| tip.rms).fold(0.0, f64::max)),
            "factors_error" => self.factors_error(),
            "stated" => Ok(error_estimate(&self.case, self.run()?).map_err(Error::Mechanics)?.life_percent),
            other => fault(format!("no reading {other}")),
        }
    }

    pub fn beside(&self, other: &Subject<'_>, name: &str) -> Option<Result<f64>> {
        let curves = |subject: &Subject<'_>| -> Result<Vec<Curve>> {
            let run = subject.run()?;
            Ok((0..run.curve[0].tips.len()).map(|tip| Curve::of_tip(run, tip)).collect())
        };
        let most = |off: &dyn Fn(&Curve, &Curve) -> f64| {
            Ok(curves(self)?.iter().zip(&curves(other)?).map(|(own, others)| off(own, others)).fold(0.0, f64::max))
        };
        match name {
            // Runs that end otherwise, or in as few blocks, are no comparison.
            "life_ratio" => Some(self.run().and_then(|run| {
                let fine = other.run()?;
                let compares = run.stop == fine.stop && fine.figures.blocks > 4 * run.figures.blocks;
                Ok(if compares { run.life_cycles() / fine.life_cycles() } else { f64::NAN })
            })),
            "path_rms_off" => Some(most(&|own, others| own.rms_off(others))),
            // The whole of the other path: where a tip stands at one share of life may differ by a step along it.
            "path_off" => Some(self.run().and_then(|run| {
                let until = COMPARED * run.life_cycles();
                most(&|own, others| own.until(until).off(others).fold(0.0, f64::max))
            })),
            _ => None,
        }
    }

    /// Points or nodes and solves of what was computed; by the area, near enough for a table, where one solve does not say.
    pub fn size(&self) -> (usize, usize) {
        match (self.run.get(), self.stressed.get()) {
            (Some(run), _) => (run.figures.points, run.figures.solves),
            (None, Some(stressed)) => (stressed.nodes, stressed.solves),
            (None, None) => {
                let spacing = match self.case.model {
                    Model::Nodes(nodes) => nodes.resolution.far,
                    Model::Points(points) | Model::Handbook(points) => points.spacing,
                };
                (self.points.get().copied().unwrap_or((self.case.specimen.area() / spacing.powi(2)).round() as usize), 1)
            }
        }
    }

    fn text(&self) -> Result<&str> {
        if let Source::Text(text) = &self.source { Ok(text) } else { fault("no standard specimen") }
    }

    fn on_points(&self) -> Result<PointSettings> {
        match self.case.model {
            Model::Points(points) => Ok(points),
            model => fault(format!("{} needs a crack", model.method())),
        }
    }

    /// The larger error of K_I and K_II of any tip over |K|.
    fn factors_error(&self) -> Result<f64> {
        let wanted = self.reference()?.initial_factors()?;
        let size = wanted[0].hypot(wanted[1]);
        self.tip(0.0)?;
        let error = |tip: &TipRecord| {
            let [k_i, k_ii] = tip.factors.unwrap_or([f64::NAN; 2]).map(|k| k / 1e6);
            // The sense of K_II is that of the tip's frame.
            (k_i - wanted[0]).abs().max((k_ii.abs() - wanted[1].abs()).abs()) / size
        };
        Ok(self.tips.get().into_iter().flatten().map(error).fold(0.0, f64::max))
    }

    /// The largest error of a displacement in uniform tension over its own, on points: nodes reproduce linear fields and are not asked.
    fn tension_error(&self) -> Result<f64> {
        let (specimen, points) = (&self.case.specimen, self.on_points()?);
        let plate = strip(specimen.width, specimen.length());
        let resolution = (points.spacing, points.horizon_ratio, points.lattice_angle);
        let by = (Some(points.solver), points.symmetry);
        Ok(uniform_tension_with(by, &plate, &points.bond_law, self.case.material.poisson_ratio, resolution)?.along)
    }

    /// σ_y at both sides of a hole of this radius in the middle over the stress far away.
    ///
    /// The rim is free, so that σ_y = E ε_y there; on points ε_y comes from the quadratic through the displacements around the point nearest
    /// to the place, taken on to the rim.
    fn beside_hole(&self, radius: f64) -> Result<f64> {
        let (case, points) = (&self.case, self.on_points()?);
        let body = points.body(&case.specimen, &case.material)?;
        let bonds = Bonds::new(&body);
        let mut displacement = Vec::new();
        let mut equilibrium = Equilibrium::new(points.solver, points.symmetry, &body, &bonds, case.loading.maximum);
        equilibrium.solve(&body, &bonds, &mut displacement)?;
        let layout = Layout::of(&body.lattice, body.stencil.unknowns);
        let frame = TipFrame { origin: [0.0; 2], ahead: [1.0, 0.0] };
        let strain = |side: Point| -> Result<f64> {
            let gap = |place: &u32| distance(body.lattice.position(*place as usize), side);
            let nearest = body.points.iter().copied().min_by(|a, b| gap(a).total_cmp(&gap(b)));
            let place = nearest.map_or_else(|| fault("a plate without points"), Ok)? as usize;
            let [x, y] = body.lattice.position(place);
            match derivatives_at(&body, &bonds, &layout, &displacement, &frame, place) {
                Some(found) => Ok(found.at([side[0] - x, side[1] - y])[1][1]),
                None => fault("too few bonds near the hole for a strain"),
            }
        };
        let mean = 0.5 * (strain([radius, 0.0])? + strain([-radius, 0.0])?);
        let _ = self.points.set(body.points.len());
        Ok(case.material.youngs_modulus * mean / case.loading.maximum)
    }
}

/// Changes a case as no key of an input file can.
fn change(case: &mut Case, key: &str) -> Result<()> {
    let (name, value) = key.split_once('=').unwrap_or((key, ""));
    let value: f64 = value.parse().map_err(|_| Error::Mechanics(format!("{key}: no number")))?;
    let mut nodes = case.nodes();
    let resolution = &mut nodes.resolution;
    match name {
        // The key of the radius of influence begins at 1.5.
        "study.support" => resolution.support = value,
        "study.finer" => {
            (resolution.far, resolution.hold, resolution.in_radius) = (resolution.far / value, 6.0, resolution.in_radius * value);
            (resolution.enrichment, resolution.support) = (Enrichment::Intrinsic, 3.0);
        }
        "study.crack_up" => {
            let by = value * resolution.far;
            for crack in &mut case.specimen.cracks {
                crack.from[1] += by;
                crack.to[1] += by;
            }
            case.specimen.tips.iter_mut().for_each(|tip| tip.position[1] += by);
            case.specimen.crack_plane_y = None;
        }
        _ => return fault(format!("{key}: not a change of a study")),
    }
    case.model = Model::Nodes(nodes);
    Ok(())
}

/// Cycles at which a tip has come to x = `at`, m, linear between rows.
fn cycles_to(run: &Prediction, tip: usize, at: f64) -> f64 {
    let place = |row: usize| run.curve[row].tips[tip].position[0] / MM;
    let passed = (1..run.curve.len()).find(|&row| (place(row - 1) - at) * (place(row) - at) <= 0.0);
    passed.map_or(f64::NAN, |row| {
        let share = (at - place(row - 1)) / (place(row) - place(row - 1));
        run.curve[row - 1].cycles + share * (run.curve[row].cycles - run.curve[row - 1].cycles)
    })
}

fn first_kink(case: &Case, run: &Prediction, tip: usize) -> f64 {
    let [a, b] = case.specimen.tips[tip].direction;
    let [from, to] = [0, 1].map(|row: usize| run.curve[row].tips[tip].position);
    let [u, v] = [0, 1].map(|i| to[i] - from[i]);
    (a * v - b * u).atan2(a * u + b * v)
}
