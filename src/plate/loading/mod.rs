//! Load history: constant amplitude, of a load or of a displacement, or a spectrum of loads.

mod boundary;
mod course;
mod forces;
pub mod formula;
mod grips;
mod read;
pub mod pieces;
pub mod residual;
pub mod spectrum;

pub use boundary::{Imbalance, imbalance};
pub use course::LoadCourse;
pub use read::from_values;

use std::sync::Arc;

use serde::Deserialize;
use toml::Value;

use crate::specimen::Edge;
use course::Size;
use residual::ResidualStress;
use spectrum::{Class, Spectrum, SpectrumFormat};

/// Stress ratios that differ by less are one: tests are run, and rates stated, to two digits.
pub const SAME_RATIO: f64 = 0.02;

perilife_base::kinds! {
    /// Load histories.
    pub enum LoadingKind for "loading.kind" {
        ConstantAmplitude = "constant_amplitude": "sinusoidal or triangular cycles of one range and one stress ratio",
        Spectrum = "spectrum": "cycles of unlike size from a file, in their order, again and again",
        Displacement = "displacement": "cycles of one displacement of the loaded places: the load falls as the cracks make the plate compliant",
    }
}

perilife_base::kinds! {
    /// What cycles of a displacement do with the edges that they move.
    pub enum Grip for "loading.grip" {
        Straight = "straight": "every moved edge stays straight and does not turn, as in a stiff grip; what it bears is not uniform",
        Mean = "mean": "the edges bear a uniform stress, bend and turn: the displacement is the mean of the edge",
    }
}

perilife_base::kinds! {
    /// What is moved does across the direction of its motion.
    pub enum Transverse for "loading.transverse" {
        Free = "free": "driven points and straight edges move freely across the direction of a displacement or velocity",
        Held = "held": "they do not move across the direction of a displacement or velocity",
    }
}

/// Keys of `[loading]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    kind: Option<LoadingKind>,
    stress_max_mpa: Option<Size>,
    stress_range_mpa: Option<Size>,
    force_max_n: Option<Size>,
    force_range_n: Option<Size>,
    force_max_kn: Option<Size>,
    force_range_kn: Option<Size>,
    displacement_max_mm: Option<f64>,
    displacement_range_mm: Option<f64>,
    grip: Option<Grip>,
    transverse: Option<Transverse>,
    crack_pressure_mpa: Option<f64>,
    stress_ratio: Option<f64>,
    spectrum_scale_mpa: Option<f64>,
    spectrum_scale_n: Option<f64>,
    spectrum_file: Option<String>,
    spectrum_format: Option<SpectrumFormat>,
    omission_percent: Option<f64>,
    truncation_percent: Option<f64>,
    repeats: Option<f64>,
    residual_stress: Option<Value>,
    residual_stress_mpa: Option<Value>,
    residual_stress_ksi: Option<Value>,
    residual_stress_file: Option<String>,
    stress_parallel_ratio: Option<f64>,
    bending_ratio: Option<f64>,
    edge_bending_ratio: Option<Value>,
    edges: Option<Vec<Edge>>,
    direction: Option<Value>,
    pins: Option<Vec<Value>>,
    rollers: Option<Vec<Value>>,
}

impl Input {
    /// Keys that say where the load acts, and whether they are given.
    fn places(&self) -> [(&'static str, bool); 4] {
        let Input { edges, direction, pins, rollers, .. } = self;
        [("edges", edges.is_some()), ("direction", direction.is_some()), ("pins", pins.is_some()), ("rollers", rollers.is_some())]
    }
}

/// What every cycle repeats.
#[derive(Debug, Clone, PartialEq)]
pub enum LoadControl {
    /// The load.
    Load,
    /// A load by the crack length at which it acts.
    Follows(Arc<LoadCourse>),
    /// The displacement `δ` that the load does work on: `P δ = Σ f·u` over the loaded places, P being the force of the load. Of two
    /// loaded ends it is what they move apart (its mean where they do not stay straight), of a pin that of the places it presses on.
    Displacement {
        /// Largest displacement of a cycle, m.
        maximum: f64,
        /// Force over nominal load, m² where that is a stress and 1 where it is a force.
        section: f64,
    },
}

/// Constant amplitude cycles between `ratio x maximum` and `maximum`; of a spectrum, its largest cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Loading {
    /// Largest nominal load of a cycle, of a spectrum that of all cycles: gross stress in Pa, or force in N (see `Specimen::load_measure`). Cycles of a displacement are
    /// solved under [`UNIT_STRESS`] or [`UNIT_FORCE`] and scaled ([`Loading::share`]), as is a load that follows the crack, of which this is the one at the initial crack
    /// length.
    pub maximum: f64,
    /// What every cycle repeats.
    pub control: LoadControl,
    /// Stress ratio R = minimum / maximum, below 1; of a spectrum that of its largest cycle.
    pub ratio: f64,
    /// The cycles of a spectrum, as shares of `maximum`.
    pub spectrum: Option<Arc<Spectrum>>,
    /// Stress along the crack over stress across it, applied to the side edges. `Specimen::loads` holds these loads
    /// already; the number stands here for the reports.
    pub parallel_ratio: f64,
    /// What the plate bears before the crack and without the load.
    pub residual: Option<Arc<ResidualStress>>,
}

/// Loads of [`Loading::lower_loads`] at the most.
pub const LOWER_LOADS_MOST: usize = 5;
/// Nominal stress under which cycles of a displacement are solved, Pa.
pub const UNIT_STRESS: f64 = perilife_base::units::MPA;
/// Force under which they are solved, N.
pub const UNIT_FORCE: f64 = perilife_base::units::KN;

impl Loading {
    /// Load of the cycle over [`Loading::maximum`], on a plate with this crack length, m, on which the latter does this work `Σ f·u`, J: `δ_max / δ` where
    /// a displacement is repeated.
    #[inline]
    pub fn share(&self, work: f64, crack_length: f64) -> f64 {
        match &self.control {
            LoadControl::Load => 1.0,
            LoadControl::Follows(course) => course.at(crack_length),
            LoadControl::Displacement { maximum, section } => maximum * self.maximum * section / work,
        }
    }

    /// Largest nominal load of the cycle, Pa or N, at a crack length, m, of cycles of a load.
    pub fn at(&self, crack_length: f64) -> f64 {
        self.maximum * self.course().map_or(1.0, |course| course.at(crack_length))
    }

    /// The same where it does this work `Σ f·u`, J, of cycles of a displacement too.
    pub fn doing(&self, work: f64, crack_length: f64) -> f64 {
        match self.control {
            LoadControl::Displacement { maximum, section } => work / (maximum * section),
            _ => self.at(crack_length),
        }
    }

    /// The load over crack length, where it follows that.
    pub fn course(&self) -> Option<&LoadCourse> {
        if let LoadControl::Follows(course) = &self.control { Some(course) } else { None }
    }

    /// Smallest and largest stress ratio of the cycles that open the crack.
    #[inline]
    pub fn ratios(&self) -> [f64; 2] {
        self.spectrum.as_ref().map_or([self.ratio; 2], |spectrum| spectrum.ratios)
    }

    /// Loads over the largest, ascending and below it, at which K is asked for where it does not follow the load in proportion, and whether these
    /// are the ends of all cycles; where those are many, the least one and those between which the ends have equal parts of `Σ n ΔK³` in proportion.
    pub fn lower_loads(&self) -> (Vec<f64>, bool) {
        let Some(spectrum) = &self.spectrum else { return (vec![self.ratio], true) };
        let weighed = |class: &Class| [class.max, class.min].map(|load| (load, class.share * (class.max - class.min).powi(3)));
        let mut ends: Vec<(f64, f64)> = spectrum.classes.iter().flat_map(weighed).filter(|(load, _)| *load < 1.0).collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut loads: Vec<f64> = ends.iter().map(|(load, _)| *load).collect();
        loads.dedup();
        let are_all = loads.len() <= LOWER_LOADS_MOST;
        if !are_all {
            let sums: Vec<f64> = ends.iter().scan(0.0, |sum, (_, weight)| Some(std::mem::replace(sum, *sum + weight))).collect();
            let parts = (LOWER_LOADS_MOST - 1) as f64;
            let whole = sums[sums.len() - 1] + ends[ends.len() - 1].1;
            let part = |k: usize| ends[sums.partition_point(|sum| *sum <= (k as f64 - 0.5) / parts * whole) - 1].0;
            loads = std::iter::once(loads[0]).chain((1..LOWER_LOADS_MOST).map(part)).collect();
            loads.dedup();
        }
        (loads, are_all)
    }

    /// Largest displacement of a cycle, m, where that is what is repeated.
    #[inline]
    pub fn displacement(&self) -> Option<f64> {
        match self.control {
            LoadControl::Displacement { maximum, .. } => Some(maximum),
            _ => None,
        }
    }

    /// Share of the maximum that counts as range, `1 - max(R, 0)`: a closed crack does not open under compression
    /// (theory: closure assumption for negative R).
    #[inline]
    pub fn range_share(&self) -> f64 {
        1.0 - self.ratio.max(0.0)
    }
}
