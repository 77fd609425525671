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

pub use boundary::{DEPTH, Imbalance, SupportEntry, imbalance};
pub use course::LoadCourse;
pub use read::{from_values, mistakes};

use std::sync::Arc;

use toml::Value;

use crate::specimen::Edge;
use course::Size;
use forces::{PinEntry, RollerEntry};
use perilife_base::input::{Quantity, number as plain};
use perilife_base::keys::{Key, Plain, force, force_kn, key, number, stress};
use perilife_base::units::MM;
use residual::ResidualStress;
use spectrum::{Class, Spectrum, SpectrumFormat};

/// Stress ratios that differ by less are one: tests are run, and rates stated, to two digits.
pub const SAME_RATIO: f64 = 0.02;

perilife_base::kinds! {
    pub enum LoadingKind for "loading.kind" {
        ConstantAmplitude = "constant_amplitude": "sinusoidal or triangular cycles of one range and one stress ratio",
        Spectrum = "spectrum": "variable-amplitude cycles from a file, in sequence, repeated",
        Displacement = "displacement": "constant displacement range; the load drops as the crack grows",
    }

    /// What cycles of a displacement do with the edges that they move.
    pub enum Grip for "loading.grip" {
        Straight = "straight": "rigid grip: the edge stays straight and does not rotate; its stress is not uniform",
        Mean = "mean": "uniform edge stress; the edge may bend and rotate; displacement = edge mean",
    }

    /// What is moved does across the direction of its motion.
    pub enum Transverse for "loading.transverse" {
        Free = "free": "driven points and straight edges move freely normal to the displacement or velocity",
        Held = "held": "no motion normal to the displacement or velocity",
    }
}

const LOAD: &str = "one load";
const OF_SPECTRUM: (&str, &[&str]) = ("kind", &["spectrum"]);
const OF_DISPLACEMENT: (&str, &[&str]) = ("kind", &["displacement"]);
const RESIDUAL: &str = "the residual stress";
const FORMULA: &str = "give a formula in quotes, of numbers, x, y, pi, + - * / ^, brackets and functions";
const DISPLACEMENT: Quantity = Quantity { what: "a displacement", unit: "mm", low: 1e-9, high: 1e4, si: MM };
/// One below zero gets the remedy of compression, not that of a wrong number.
const SIGNED: Quantity = Quantity { low: -1e4, ..DISPLACEMENT };

perilife_base::keys! {
    /// Keys of `[loading]` but those of retardation.
    pub struct Input {
        kind: LoadingKind = key("kind", "Kind of cycles"), or "constant_amplitude" LoadingKind::ConstantAmplitude;
        stress_max_mpa: Option<Size> = stress("stress_max_mpa", "Maximum stress σmax: gross section").group(LOAD);
        stress_range_mpa: Option<Size> = stress("stress_range_mpa", "Stress range Δσ: gross section, maximum − minimum").group(LOAD);
        force_max_n: Option<Size> = force("force_max_n", "Maximum force Pmax").group(LOAD);
        force_range_n: Option<Size> = force("force_range_n", "Force range ΔP: maximum − minimum").group(LOAD);
        force_max_kn: Option<Size> = force_kn("force_max_kn", "Maximum force Pmax").group(LOAD);
        force_range_kn: Option<Size> = force_kn("force_range_kn", "Force range ΔP: maximum − minimum").group(LOAD);
        displacement_max_mm: Option<Plain> = of_kind(key("displacement_max_mm", "Maximum displacement δ_max: relative, of the loaded sides").of(SIGNED).group(LOAD), OF_DISPLACEMENT);
        displacement_range_mm: Option<Plain> = of_kind(key("displacement_range_mm", "Displacement range Δδ: relative, of the loaded sides").of(SIGNED).group(LOAD), OF_DISPLACEMENT);
        spectrum_scale_mpa: Option<Plain> = of_kind(stress("spectrum_scale_mpa", "Scale of the spectrum: gross stress of the value 1").group(LOAD), OF_SPECTRUM);
        spectrum_scale_n: Option<Plain> = of_kind(force("spectrum_scale_n", "Scale of the spectrum: force of the value 1").group(LOAD), OF_SPECTRUM);
        stress_ratio: Option<f64> = key("stress_ratio", "Stress ratio R: minimum / maximum, below 1").of(RATIO);
        grip: Grip = of_kind(key("grip", "Grip: of moved edges"), OF_DISPLACEMENT), or "straight" Grip::Straight;
        transverse: Transverse = of_kind(key("transverse", "Motion across the displacement"), OF_DISPLACEMENT), or "free" Transverse::Free;
        crack_pressure: Option<f64> = stress("crack_pressure_mpa", "Crack-face pressure: at maximum load");
        spectrum_file: Option<String> = of_kind(key("spectrum_file", "File of the spectrum: CSV, workbook, .spx, .sub or FASTRAN"), OF_SPECTRUM);
        spectrum_format: Option<SpectrumFormat> = of_kind(key("spectrum_format", "Format of the spectrum: default by name and content"), OF_SPECTRUM);
        omission_percent: f64 = of_kind(number("omission_percent", "Omission level, % of the largest range", "a percentage", 0.0, 99.0), OF_SPECTRUM), or "0" 0.0;
        truncation_percent: f64 = of_kind(number("truncation_percent", "High-load truncation, % of the largest peak", "a percentage", 1.0, 100.0), OF_SPECTRUM), or "100" 100.0;
        repeats: Option<f64> = of_kind(number("repeats", "Number of passes", "a number of passes", 1e-6, 1e12), OF_SPECTRUM);
        residual_stress: Option<Value> = key("residual_stress", "Residual stress: formula of x and y, mm, in MPa").group(RESIDUAL).missing(FORMULA);
        residual_stress_mpa: Option<Value> = key("residual_stress_mpa", "Residual stress: formula of x and y, mm, in MPa").group(RESIDUAL).missing(FORMULA);
        residual_stress_ksi: Option<Value> = key("residual_stress_ksi", "Residual stress: formula of x and y, inch, in ksi").group(RESIDUAL).missing(FORMULA);
        residual_stress_file: Option<String> = key("residual_stress_file", "File of residual stress: columns x_mm, y_mm, stress_mpa").group(RESIDUAL);
        parallel_ratio: f64 = number("stress_parallel_ratio", "Biaxiality: stress along the crack over stress across it", "a ratio", -10.0, 10.0), or "0" 0.0;
        bending_ratio: Option<f64> = number("bending_ratio", "Out-of-plane bending: bending stress over tension, of part-through cracks", "a ratio of stresses", 0.0, 1000.0);
        edge_bending_ratio: Option<Value> = key("edge_bending_ratio", "In-plane bending of loaded edges: bending stress over mean stress, or \"pure\"")
            .missing("give bending stress at the end of the edge over its mean stress, or \"pure\"");
        edges: Option<Vec<Edge>> = key("edges", "Loaded sides");
        direction: Option<Value> = key("direction", "Direction of the stress on edges: [x, y], or one for each of them").missing("give [x, y]");
        pins: Option<Vec<PinEntry>> = key("pins", "Pins: in holes of the plate");
        rollers: Option<Vec<RollerEntry>> = key("rollers", "Rollers: on the outline of the plate");
    }
}

/// At R = 1 nothing changes in a cycle; above it all of it is compression, which is not computed.
const RATIO: Quantity = plain("R = minimum / maximum, below 1,", -100.0, 0.999);

const fn of_kind(key: Key, (of, with): (&'static str, &'static [&'static str])) -> Key {
    key.only(of, with)
}

const PLACES: [&str; 4] = ["edges", "direction", "pins", "rollers"];

#[derive(Debug, Clone, PartialEq)]
pub enum LoadControl {
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
    pub fn displacement(&self) -> Option<f64> {
        match self.control {
            LoadControl::Displacement { maximum, .. } => Some(maximum),
            _ => None,
        }
    }

    /// Share of the maximum that counts as range, `1 - max(R, 0)`: a closed crack does not open under compression
    /// (theory: closure assumption for negative R).
    pub fn range_share(&self) -> f64 {
        1.0 - self.ratio.max(0.0)
    }
}
