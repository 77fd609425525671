//! Scenes with an answer that no method of this program gave, and how far a run is from it: what `verify` bounds, `chart` sets beside
//! its time, and `stability` follows over a parameter. Nothing is fitted to a scene: C and m of the growth law are given.

use super::cases::{self, NODES, case_of, overrides, plate_alone, pulled_plate};
use super::references::{Reference, SHARES, compare, largest};
use super::standard::Standard;
use super::uniform_tension::{strip, uniform_tension_with};
use perilife_base::error::{Error, Result};
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_growth::case::{Case, Model, PointSettings};
use perilife_growth::cracks::initial_tips;
use perilife_growth::nodes::NodePlate;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::{Observer, Prediction, predict};
use perilife_growth::record::TipRecord;
use perilife_growth::stress_concentration::stressed;
use perilife_nodes::rim_stress::Rim;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::distance;
use perilife_plate::specimen::handbook::handbook_tada;
use perilife_points::solver::Equilibrium;
use perilife_points::solver::field::Layout;
use perilife_points::state::Bonds;
use perilife_points::stress_intensity::{TipFrame, derivatives_at};

/// A question with its truth. Cases are texts as the user writes them.
#[derive(Debug, Clone)]
pub enum Scene {
    /// Life of a standard specimen.
    Life(Standard),
    /// Its cycles at [`SHARES`] of the growth, so that two errors which cancel at its end are seen.
    Growth(Standard),
    /// Cycles and path of a plate that finite elements have grown, by its name.
    Plate(&'static str),
    /// K_I and K_II of the initial cracks of that plate.
    Factors(&'static str),
    /// K_I of the first tip of a case, which a handbook knows.
    Handbook(String),
    /// K_I of a tip of a case against that on fine nodes, which share nothing with points and bonds.
    AgainstNodes(String, usize),
    /// K_I of a tip in some unit, Pa√m, known to be so much of it.
    Tip {
        /// Case.
        text: String,
        /// Which of its tips.
        tip: usize,
        /// K_I over the unit.
        known: f64,
        /// Unit, Pa√m.
        unit: f64,
        /// Where that is known from.
        truth: &'static str,
    },
    /// Displacement of a plate in uniform tension, the largest error of a point over its own.
    Tension,
    /// Stress at a hole over that far away.
    Hole,
}

/// What a run of a scene found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// What was computed.
    pub computed: f64,
    /// What it should be.
    pub truth: f64,
    /// Distance of the path from that of the truth, rms, mm.
    pub path_rms_mm: Option<f64>,
    /// Points or nodes; 0 of a hand calculation.
    pub points: usize,
    /// Equilibrium solves.
    pub solves: usize,
}

impl Found {
    /// Error in percent of the truth.
    pub fn error_percent(&self) -> f64 {
        percent(self.computed, self.truth)
    }

    /// A figure of one solve.
    fn of(case: &Case, computed: f64, truth: f64) -> Found {
        let spacing = match case.model {
            Model::Nodes(nodes) => nodes.resolution.far,
            Model::Points(points) | Model::Handbook(points) => points.spacing,
        };
        // By the area, near enough for a table.
        let points = (case.specimen.area() / spacing.powi(2)).round() as usize;
        Found { computed, truth, path_rms_mm: None, points, solves: 1 }
    }

    /// Of a run whose life is this part of the true one.
    fn of_run(run: &Prediction, over_truth: f64, path_rms_mm: Option<f64>) -> Found {
        let figures = &run.figures;
        Found { computed: over_truth, truth: 1.0, path_rms_mm, points: figures.points, solves: figures.solves }
    }
}

/// Error in percent of the truth.
pub fn percent(computed: f64, truth: f64) -> f64 {
    100.0 * (computed / truth - 1.0)
}

/// Width and length of the plates of [`Scene::Tension`] and [`Scene::Hole`], and diameter of the hole, mm.
const SIZE_MM: [f64; 2] = [100.0, 200.0];
const DIAMETER_MM: f64 = 20.0;
/// Part of the path that may be missing: a run may stop short of an edge, an end elsewhere is another answer.
const PATH_MISSING_MOST: f64 = 0.05;

impl Scene {
    /// What its error is of, where its truth comes from, and how far that may be off, percent.
    fn facts(&self) -> (&'static str, &'static str, f64) {
        match self {
            // The uncertainty is three times that of K, since m is 3.
            Scene::Life(_) => ("life", "quadrature, K of finite elements (tests/reference), 0.05 %", 0.15),
            Scene::Growth(_) => ("life", "quadrature, K of finite elements (tests/reference)", 0.15),
            // Halved elements and steps move lives by 0.04 % at most.
            Scene::Plate(_) => ("life", "finite elements (tests/reference)", 0.05),
            Scene::Factors(_) => ("K, the larger error of K_I and K_II over |K|", "finite elements (tests/reference)", 0.02),
            Scene::Handbook(_) => ("K_I", "handbook (Tada)", 0.1),
            Scene::AgainstNodes(..) => ("K_I", "the plate on nodes", 0.3),
            Scene::Tip { truth, .. } => ("K_I", truth, 0.1),
            Scene::Tension => ("displacement along the load, largest error of a point over its own", "u = σ y / E, exact", 0.0),
            Scene::Hole => {
                ("stress at the side of the hole over that far away", "Howland 1930 (fit of Pilkey and Pilkey 2008)", 0.5)
            }
        }
    }

    /// What its error is of.
    pub fn quantity(&self) -> &'static str {
        self.facts().0
    }

    /// Where the truth comes from.
    pub fn truth(&self) -> &'static str {
        self.facts().1
    }

    /// How far that may be off, percent.
    pub fn truth_uncertainty_percent(&self) -> f64 {
        self.facts().2
    }

    /// Whether cracks grow in it.
    pub fn grows(&self) -> bool {
        matches!(self, Scene::Life(_) | Scene::Growth(_) | Scene::Plate(_))
    }

    /// Whether a handbook has its K(a).
    pub fn has_formula(&self) -> bool {
        matches!(self, Scene::Life(_) | Scene::Growth(_))
    }

    /// Whether it has a crack.
    pub fn has_crack(&self) -> bool {
        !matches!(self, Scene::Tension | Scene::Hole)
    }

    /// Its case with keys set by `section.key=value`.
    pub fn case(&self, set: &[String]) -> Result<Case> {
        let plate =
            |more: &str| plate_alone(&pulled_plate(&format!("width_mm = {}\nlength_mm = {}{more}", SIZE_MM[0], SIZE_MM[1])), set);
        match self {
            Scene::Life(specimen) | Scene::Growth(specimen) => specimen.case(set),
            Scene::Plate(name) | Scene::Factors(name) => Reference::named(name)?.case(set),
            Scene::Handbook(text) | Scene::AgainstNodes(text, _) | Scene::Tip { text, .. } => case_of(text, set),
            Scene::Tension => plate(""),
            Scene::Hole => plate(&format!("\nholes = [{{ x_mm = 0, y_mm = 0, diameter_mm = {DIAMETER_MM} }}]")),
        }
    }

    /// How far the case with these keys is from the truth, percent.
    pub fn error(&self, keys: &str, observer: &dyn Observer) -> Result<f64> {
        let set = overrides(keys);
        Ok(self.found(&self.case(&set)?, &set, observer)?.error_percent())
    }

    /// What a case of the scene finds; `set` are the keys that it has been given, which a life by quadrature takes as well.
    /// Errors: those of the run; a run that ends otherwise than the truth.
    pub fn found(&self, case: &Case, set: &[String], observer: &dyn Observer) -> Result<Found> {
        match self {
            Scene::Life(specimen) => {
                let run = predict(case, observer)?;
                Ok(Found::of_run(&run, specimen.over_quadrature(&run, set)?, None))
            }
            Scene::Growth(specimen) => {
                let run = predict(case, observer)?;
                Ok(Found::of_run(&run, 1.0 + 0.01 * specimen.largest_error(&run, &SHARES)?, None))
            }
            Scene::Plate(name) => plate(&predict(case, observer)?, Reference::named(name)?),
            Scene::Factors(name) => initial_factors(case, Reference::named(name)?),
            Scene::Handbook(_) => {
                let formula = handbook_tada(&case.specimen).ok_or_else(|| Error::Mechanics("no handbook formula".to_owned()))?;
                let known = formula.k_i(case.specimen.crack_length, case.loading.maximum);
                Ok(Found::of(case, factors(case, 0)?[0], known))
            }
            Scene::AgainstNodes(text, tip) => {
                let nodes = cases::case(text, &format!("{NODES} model.tolerance_percent=0.5"))?;
                let known = factors(&nodes, *tip)?[0];
                Ok(Found::of(case, factors(case, *tip)?[0], known))
            }
            Scene::Tip { tip, known, unit, .. } => Ok(Found::of(case, factors(case, *tip)?[0] / unit, *known)),
            Scene::Tension => tension(case),
            Scene::Hole => hole(case),
        }
    }
}

/// K and T of the initial tips by the method of a case, as a prediction reads them.
pub fn tips(case: &Case) -> Result<Vec<TipRecord>> {
    let tips = match case.model {
        Model::Nodes(_) => initial_tips::<NodePlate>(case),
        Model::Points(_) | Model::Handbook(_) => initial_tips::<PointPlate>(case),
    };
    Ok(tips?.tips)
}

/// K_I and K_II of one of the initial tips, Pa√m.
pub fn factors(case: &Case, tip: usize) -> Result<[f64; 2]> {
    let found = tips(case)?.get(tip).and_then(|tip| tip.factors);
    found.ok_or_else(|| Error::Mechanics(format!("tip {tip} has no K")))
}

/// The largest error of cycles of any tip.
fn plate(run: &Prediction, reference: &Reference) -> Result<Found> {
    let tips = compare(run, reference.tips()?, f64::INFINITY);
    let length = tips.iter().map(|tip| tip.length).fold(f64::INFINITY, f64::min);
    if length < 1.0 - PATH_MISSING_MOST || !reference.ended_alike(run) {
        let percent = 100.0 * length;
        return Err(Error::Mechanics(format!("another end: {} after {percent:.0} % of the way", run.stop)));
    }
    let error = largest(tips.iter().flat_map(|tip| tip.cycles));
    let rms = tips.iter().map(|tip| tip.rms).fold(0.0, f64::max);
    Ok(Found::of_run(run, 1.0 + 0.01 * error, Some(rms / MM)))
}

/// The larger error of K_I and K_II of any tip over |K|.
fn initial_factors(case: &Case, reference: &Reference) -> Result<Found> {
    let wanted = reference.initial_factors()?;
    let size = wanted[0].hypot(wanted[1]);
    let error = |tip: &TipRecord| {
        let [k_i, k_ii] = tip.factors.unwrap_or([f64::NAN; 2]).map(|k| k / MPA_SQRT_M);
        // The sense of K_II is that of the tip's frame.
        (k_i - wanted[0]).abs().max((k_ii.abs() - wanted[1].abs()).abs()) / size
    };
    Ok(Found::of(case, 1.0 + tips(case)?.iter().map(error).fold(0.0, f64::max), 1.0))
}

/// The plate in uniform tension, on points: nodes reproduce linear fields and are not asked.
fn tension(case: &Case) -> Result<Found> {
    let (specimen, points) = (&case.specimen, on_points(case)?);
    let plate = strip(specimen.width, specimen.length());
    let resolution = (points.spacing, points.horizon_ratio, points.lattice_angle);
    let by = (points.solver, points.symmetry);
    let errors = uniform_tension_with(by, &plate, &points.bond_law, case.material.poisson_ratio, resolution)?;
    Ok(Found::of(case, 1.0 + 0.01 * errors.along, 1.0))
}

/// σ_y at both sides of the hole over the stress far away.
///
/// The rim is free, so that σ_y = E ε_y there; on points ε_y comes from the quadratic through the displacements around the point nearest
/// to the place, taken on to the rim.
fn hole(case: &Case) -> Result<Found> {
    let known = concentration_of(DIAMETER_MM / SIZE_MM[0]);
    if matches!(case.model, Model::Nodes(_)) {
        let stressed = stressed(case)?;
        let largest = stressed.rims.iter().find(|rim| rim.rim == Rim::Hole(0)).map(|rim| rim.largest.stress);
        let computed = largest.and_then(|stress| stressed.concentration(stress)).unwrap_or(f64::NAN);
        return Ok(Found { computed, truth: known, path_rms_mm: None, points: stressed.nodes, solves: stressed.solves });
    }
    let points = on_points(case)?;
    let body = points.body(&case.specimen, &case.material)?;
    let bonds = Bonds::new(&body);
    let mut displacement = Vec::new();
    let mut equilibrium = Equilibrium::new(points.solver, points.symmetry, &body, &bonds, case.loading.maximum);
    equilibrium.solve(&body, &bonds, &mut displacement)?;
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let frame = TipFrame { origin: [0.0; 2], ahead: [1.0, 0.0] };
    let radius = 0.5 * DIAMETER_MM * MM;
    let strain = |side: Point| -> Result<f64> {
        let gap = |place: &u32| distance(body.lattice.position(*place as usize), side);
        let nearest = body.points.iter().copied().min_by(|a, b| gap(a).total_cmp(&gap(b)));
        let place = nearest.ok_or_else(|| Error::Mechanics("a plate without points".to_owned()))? as usize;
        let [x, y] = body.lattice.position(place);
        let found = derivatives_at(&body, &bonds, &layout, &displacement, &frame, place);
        let found = found.ok_or_else(|| Error::Mechanics("too few bonds beside the hole for a strain".to_owned()))?;
        Ok(found.at([side[0] - x, side[1] - y])[1][1])
    };
    let mean = 0.5 * (strain([radius, 0.0])? + strain([-radius, 0.0])?);
    let computed = case.material.youngs_modulus * mean / case.loading.maximum;
    Ok(Found { points: body.points.len(), ..Found::of(case, computed, known) })
}

/// Largest stress over that far away of a hole of d/W = x in a strip in tension: (3 - 3.14 x + 3.667 x² - 1.527 x³)/(1 - x), a fit to
/// Howland 1930 within 0.5 % (Pilkey and Pilkey 2008).
#[allow(clippy::approx_constant, reason = "a coefficient of the fit, not π")]
pub fn concentration_of(x: f64) -> f64 {
    (3.0 - x * (3.14 - x * (3.667 - 1.527 * x))) / (1.0 - x)
}

fn on_points(case: &Case) -> Result<PointSettings> {
    match case.model {
        Model::Points(points) => Ok(points),
        model => Err(Error::Mechanics(format!("{} is not asked for a plate without a crack", model.method()))),
    }
}
