//! Scenes with an answer that no method of this program gave, and how far a run is from it.
//!
//! Lives are compared at several places of the growth, so that two errors which cancel at its end are seen. Nothing is fitted to a
//! scene: C and m of the growth law are given.

use crate::case::{Case, Method};
use crate::chart::static_scenes;
use crate::error::{Error, Result};
use crate::growth::element_free;
use crate::growth::tip_field;
use crate::predict::{Prediction, Silent, StopReason, predict};
use crate::units::{MM, MPA_SQRT_M};
use crate::verify::references::{REFERENCES, Reference, SHARES, compare};
use crate::verify::standard::{Standard, standard_specimens};

/// Where references of finite elements come from.
const ELEMENTS: &str = "finite elements (tests/reference)";

/// A scene.
#[derive(Debug)]
pub struct Scene {
    /// Name, as `perilife chart NAME` takes it.
    pub name: &'static str,
    /// What it is, in words.
    pub about: &'static str,
    /// What its error is of.
    pub quantity: &'static str,
    /// Where its truth comes from.
    pub truth: &'static str,
    /// How far that may be off, percent.
    pub truth_uncertainty_percent: f64,
    /// Box around the way of its cracks, mm, which points of several levels resolve: lower left, upper right corner.
    pub way_mm: Option<[[f64; 2]; 2]>,
    question: Question,
}

/// What is asked.
#[derive(Debug)]
enum Question {
    /// The life of a standard specimen, by its place in [`standard_specimens`].
    Specimen(usize),
    /// The life and path of a plate, by its name in [`REFERENCES`].
    Plate(&'static str),
    /// K_I and K_II of the initial cracks of that plate.
    Factors(&'static str),
    /// Displacement of a plate in uniform tension.
    Tension,
    /// Stress at a hole over that far away.
    Hole,
}

/// What a run of a scene found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Points or nodes; 0 of a hand calculation.
    pub points: usize,
    /// Equilibrium solves.
    pub solves: usize,
    /// Size of the error, percent.
    pub error_percent: f64,
    /// Distance of the path from that of the truth, rms, mm.
    pub path_rms_mm: Option<f64>,
}

const fn specimen(name: &'static str, about: &'static str, place: usize, way_mm: [[f64; 2]; 2]) -> Scene {
    Scene {
        name,
        about,
        quantity: "life",
        truth: "quadrature, K of finite elements (tests/reference)",
        // Three times that of K, since m is 3.
        truth_uncertainty_percent: 0.15,
        way_mm: Some(way_mm),
        question: Question::Specimen(place),
    }
}

const fn plate(name: &'static str, about: &'static str, of: &'static str, way_mm: Option<[[f64; 2]; 2]>) -> Scene {
    Scene {
        name,
        about,
        quantity: "life",
        truth: ELEMENTS,
        // Halved elements and steps move lives by 0.04 % at most.
        truth_uncertainty_percent: 0.05,
        way_mm,
        question: Question::Plate(of),
    }
}

/// All scenes, in the order of the panels.
pub const SCENES: &[Scene] = &[
    specimen("middle_tension", "middle-tension panel, W 100 mm, a 10 to 38 mm", 0, [[-50.0, -13.0], [50.0, 13.0]]),
    specimen("compact_tension", "compact specimen, W 50 mm, a 15 to 35 mm", 1, [[7.0, -7.0], [50.0, 7.0]]),
    specimen("single_edge", "single-edge panel, W 50 mm, a 8 to 28 mm", 2, [[-25.0, -6.0], [25.0, 6.0]]),
    Scene {
        name: "slant_factors",
        about: "slant crack, 30° to the side: K_I and K_II",
        quantity: "K, the larger error of K_I and K_II over |K|",
        truth: ELEMENTS,
        truth_uncertainty_percent: 0.02,
        way_mm: Some([[-19.0, -15.0], [19.0, 15.0]]),
        question: Question::Factors("slant_severance"),
    },
    plate("slant_severance", "slant crack until the plate is in two", "slant_severance", Some([[-40.0, -14.0], [40.0, 14.0]])),
    plate("hole_entered", "edge crack that enters a hole", "hole_attracts", Some([[-50.0, -13.0], [-2.0, 24.0]])),
    plate("hole_passed", "edge crack that passes a hole", "hole_missed", None),
    plate("offset_cracks", "two edge cracks that pass each other", "offset_edge_cracks", None),
    plate("three_cracks", "three collinear cracks that join", "three_cracks", None),
    plate("bending_with_holes", "bent beam with three holes, one entered", "three_point_bending", None),
    Scene {
        name: "tension_plate",
        about: "plate in uniform tension, 100 x 200 mm",
        quantity: "displacement along the load, largest error of a point over its own",
        truth: "u = σ y / E, exact",
        truth_uncertainty_percent: 0.0,
        way_mm: None,
        question: Question::Tension,
    },
    Scene {
        name: "hole_in_tension",
        about: "hole of 20 mm in a plate of 100 x 200 mm in tension",
        quantity: "stress at the side of the hole over that far away",
        truth: static_scenes::HOLE_SOURCE,
        truth_uncertainty_percent: static_scenes::HOLE_UNCERTAINTY_PERCENT,
        way_mm: None,
        question: Question::Hole,
    },
];

impl Scene {
    /// Whether cracks grow in it.
    pub fn grows(&self) -> bool {
        matches!(self.question, Question::Specimen(_) | Question::Plate(_))
    }

    /// Whether a handbook has its K(a).
    pub fn has_formula(&self) -> bool {
        matches!(self.question, Question::Specimen(_))
    }

    /// Whether it has a crack.
    pub fn has_crack(&self) -> bool {
        !matches!(self.question, Question::Tension | Question::Hole)
    }

    /// The scene with keys set by `section.key=value`.
    pub fn case(&self, set: &[String]) -> Result<Case> {
        let keys: Vec<&str> = set.iter().map(String::as_str).collect();
        match self.question {
            Question::Specimen(place) => specimen_at(place).case(&keys),
            Question::Plate(name) | Question::Factors(name) => reference(name)?.case(&keys),
            Question::Tension => static_scenes::tension_case(set),
            Question::Hole => static_scenes::hole_case(set),
        }
    }

    /// Runs a case of the scene and compares what comes of it with the truth.
    ///
    /// # Errors
    /// Those of the run; a run that ends otherwise than the truth.
    pub fn run(&self, case: &Case) -> Result<Found> {
        match self.question {
            Question::Specimen(_) | Question::Plate(_) => self.judge(&predict(case, &Silent)?),
            Question::Factors(name) => factors(case, reference(name)?),
            Question::Tension => static_scenes::tension(case),
            Question::Hole => static_scenes::hole(case),
        }
    }

    /// Compares a prediction of the scene with the truth.
    ///
    /// # Errors
    /// As [`Scene::run`]; a scene without growth.
    pub fn judge(&self, run: &Prediction) -> Result<Found> {
        match self.question {
            Question::Specimen(place) => Ok(of_run(run, specimen_at(place).error_percent(run, &SHARES)?, None)),
            Question::Plate(name) => of_plate(run, reference(name)?),
            _ => Err(Error::Mechanics(format!("no crack grows in {}", self.name))),
        }
    }
}

fn of_run(run: &Prediction, error_percent: f64, path_rms_mm: Option<f64>) -> Found {
    Found { points: run.figures.points, solves: run.figures.solves, error_percent: error_percent.abs(), path_rms_mm }
}

fn specimen_at(place: usize) -> Standard {
    let [a, b, c, d] = standard_specimens();
    [a, b, c, d][place].clone()
}

fn reference(name: &str) -> Result<&'static Reference> {
    let found = REFERENCES.iter().find(|reference| reference.name == name);
    found.ok_or_else(|| Error::Mechanics(format!("no reference {name}")))
}

/// Share of the way that may be missing: a run may stop short of an edge, an end elsewhere is another answer.
const WAY_MISSING_MOST: f64 = 0.05;

fn of_plate(run: &Prediction, reference: &Reference) -> Result<Found> {
    let tips = compare(run, reference.tips()?, f64::INFINITY);
    let way = tips.iter().map(|tip| tip.way).fold(f64::INFINITY, f64::min);
    if way < 1.0 - WAY_MISSING_MOST || reference.ends_in_hole && run.stop != StopReason::EnteredHole {
        let percent = 100.0 * way;
        return Err(Error::Mechanics(format!("another end: {} after {percent:.0} % of the way", run.stop)));
    }
    let larger = |most: f64, error: f64| if error.abs() > most.abs() { error } else { most };
    let error = tips.iter().flat_map(|tip| tip.cycles).fold(0.0, larger);
    let rms = tips.iter().map(|tip| tip.rms).fold(0.0, f64::max);
    Ok(of_run(run, error, Some(rms / MM)))
}

/// K of the initial cracks as a prediction reads it.
fn factors(case: &Case, reference: &Reference) -> Result<Found> {
    let tips = match case.model.method {
        Method::ElementFreeGalerkin => element_free::initial_tips(case)?,
        _ => tip_field::initial_tips(case)?.tips,
    };
    let wanted = reference.initial_factors()?;
    let size = wanted[0].hypot(wanted[1]);
    let error = |tip: &crate::predict::TipRecord| {
        let [k_i, k_ii] = tip.factors.unwrap_or([f64::NAN; 2]).map(|k| k / MPA_SQRT_M);
        // The sense of K_II is that of the tip's frame.
        (k_i - wanted[0]).abs().max((k_ii.abs() - wanted[1].abs()).abs()) / size
    };
    let worst = tips.iter().map(error).fold(0.0, f64::max);
    let points = crate::chart::run::points_of(case);
    Ok(Found { points, solves: 1, error_percent: 100.0 * worst, path_rms_mm: None })
}
