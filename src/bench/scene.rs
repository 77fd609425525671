//! Scenes with a known answer, and how far a run is from it.
//!
//! Lives are compared with quadrature of the Paris law with handbook K. A and p of the bonds and C and m of the Paris law are
//! those of one fitted record, so that nothing is fitted to the scene. Poisson's ratio is 0.3, where a law that resists rotation
//! shows it: at 0.33 its errors happen to cancel. K, lives and the displacement along the load do not depend on it.

use std::path::Path;

use super::row::Deviation;
use crate::calibration::model::cycles_since_first;
use crate::calibration::record::FittedRecord;
use crate::case::Case;
use crate::error::{Error, Result};
use crate::predict::{Prediction, Silent, predict};
use crate::stress_intensity::{StressIntensityMethod, stress_intensity};
use crate::verify::scene::points;
use crate::verify::uniform_tension::{strip, uniform_tension_with};

/// Names of the scenes.
pub const MIDDLE: &str = "middle_tension";
/// Single-edge panel.
pub const SINGLE: &str = "single_edge";
/// K of a cracked plate.
pub const CRACKED: &str = "cracked_plate";
/// Uniform tension.
pub const TENSION: &str = "tension_plate";

const RECORD: &str = include_str!("../../calibration/al2024-t3/fitted.toml");
/// Lengths at which two a-N curves are compared.
const LENGTHS: usize = 20;

/// What a measured run gives beside its time.
#[derive(Debug, Clone)]
pub struct Found {
    /// Points of the body.
    pub points: usize,
    /// Error, where there is a reference.
    pub error: Option<Deviation>,
    /// Bonds that broke.
    pub broken_bonds: Option<usize>,
}

/// A scene.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Its name, and that of its group.
    pub name: &'static str,
    /// What it is, in words.
    pub about: String,
    /// Default spacing, mm.
    pub spacing_mm: f64,
    /// Whether a crack grows.
    pub grows: bool,
    text: String,
}

impl Scene {
    /// The scene by peridynamics, with these keys.
    ///
    /// # Errors
    /// As [`Case::from_toml`].
    pub fn case(&self, set: &[String]) -> Result<Case> {
        let record = record()?;
        let law = format!(
            "driver = \"bond_strain\"\ngrowth_rate = \"bond_strain\"\na = {:?}\np = {:?}\nhorizon_mm = {:?}",
            record.a, record.p, record.horizon_mm
        );
        self.read(&format!("[model]\nspacing_mm = {:?}\n[fatigue]\n{law}\n", self.spacing_mm), set)
    }

    /// The scene by hand calculation.
    ///
    /// # Errors
    /// As [`Case::from_toml`].
    pub fn by_hand(&self) -> Result<Case> {
        let record = record()?;
        let law = format!("paris_c_mm_per_cycle = {:?}\nparis_m = {:?}", record.paris_c_mm_per_cycle, record.paris_m);
        self.read(&format!("[model]\nmethod = \"handbook\"\n[fatigue]\n{law}\n"), &[])
    }

    fn read(&self, rest: &str, set: &[String]) -> Result<Case> {
        Case::from_toml(&format!("{}{rest}", self.text), self.name, Path::new("."), set)
    }
}

/// The fitted law of the scenes.
///
/// # Errors
/// A record that cannot be read.
pub fn record() -> Result<FittedRecord> {
    toml::from_str(RECORD).map_err(|error| Error::Mechanics(format!("calibration/al2024-t3/fitted.toml: {error}")))
}

/// Middle tension; its default is the reference run.
#[must_use]
pub fn middle_tension(quick: bool) -> Scene {
    let spacing_mm = if quick { 2.0 } else { 1.0 };
    let specimen = "kind = \"middle_tension\"\nwidth_mm = 80.0\nlength_mm = 160.0\ncrack_length_mm = 15.0\n";
    Scene {
        name: MIDDLE,
        about: format!("middle-tension panel, W 80 mm, a 15 to 25 mm, spacing {spacing_mm} mm"),
        spacing_mm,
        grows: true,
        text: text(specimen, 48.28, 25.0),
    }
}

/// Single edge under uniform stress.
#[must_use]
pub fn single_edge(quick: bool) -> Scene {
    let spacing_mm = if quick { 2.0 } else { 1.0 };
    let specimen = "kind = \"single_edge_tension\"\nends = \"uniform_stress\"\nwidth_mm = 60.0\nlength_mm = 180.0\n\
                    crack_length_mm = 15.0\n";
    Scene {
        name: SINGLE,
        about: format!("single-edge panel, W 60 mm, a 15 to 24 mm, spacing {spacing_mm} mm"),
        spacing_mm,
        grows: true,
        text: text(specimen, 33.0, 24.0),
    }
}

/// K of a middle crack.
#[must_use]
pub fn cracked_plate(quick: bool) -> Scene {
    let spacing_mm = if quick { 2.0 } else { 1.0 };
    let specimen = "kind = \"middle_tension\"\nwidth_mm = 100.0\nlength_mm = 200.0\ncrack_length_mm = 20.0\n";
    Scene {
        name: CRACKED,
        about: format!("K_I of a plate with a middle crack, W 100 mm, a 20 mm, spacing {spacing_mm} mm"),
        spacing_mm,
        grows: false,
        text: text(specimen, 48.28, 25.0),
    }
}

/// Uniform tension; the crack of the text is not cut.
#[must_use]
pub fn tension_plate(quick: bool) -> Scene {
    let spacing_mm = if quick { 4.0 } else { 2.0 };
    let specimen = "kind = \"middle_tension\"\nwidth_mm = 100.0\nlength_mm = 200.0\ncrack_length_mm = 20.0\n";
    Scene {
        name: TENSION,
        about: format!("plate in uniform tension, 100 x 200 mm, spacing {spacing_mm} mm"),
        spacing_mm,
        grows: false,
        text: text(specimen, 48.28, 25.0),
    }
}

fn text(specimen: &str, range_mpa: f64, end_mm: f64) -> String {
    format!(
        "[specimen]\n{specimen}thickness_mm = 2.54\n[material]\nyoungs_modulus_gpa = 73.1\npoisson_ratio = 0.3\n\
         plane = \"stress\"\n[loading]\nstress_range_mpa = {range_mpa:?}\nstress_ratio = 0.2\n[stop]\n\
         crack_length_mm = {end_mm:?}\n"
    )
}

/// A whole run, compared with the hand calculation of the same scene.
///
/// # Errors
/// As [`predict`]; a run that ends before its length.
pub fn life(case: &Case, by_hand: &Prediction) -> Result<Found> {
    let run = predict(case, &Silent)?;
    let last = run.curve.last().map(|point| point.broken_bonds);
    Ok(Found { points: run.figures.points, error: Some(life_error(&run, by_hand)?), broken_bonds: last })
}

/// Largest difference of cycles at equal crack length, in percent of the life by hand. Beside the difference at the end this one
/// cannot vanish by luck where two errors cancel.
///
/// # Errors
/// A curve that ends before the other one.
pub fn life_error(run: &Prediction, by_hand: &Prediction) -> Result<Deviation> {
    let (from, to) = (by_hand.curve[0].crack_length, by_hand.crack_length_final());
    let lengths: Vec<f64> = (0..=LENGTHS).map(|i| from + (to - from) * i as f64 / LENGTHS as f64).collect();
    let cycles = cycles_since_first(&points(run), &lengths)?;
    let reference = cycles_since_first(&points(by_hand), &lengths)?;
    let life = reference[LENGTHS];
    let largest = cycles.iter().zip(&reference).map(|(n, r)| (n - r).abs() / life).fold(0.0, f64::max);
    Ok(Deviation {
        of: "cycles, largest along the a-N curve",
        percent: 100.0 * largest,
        against: "quadrature with handbook K",
        at_end_percent: Some(100.0 * (cycles[LENGTHS] / life - 1.0)),
    })
}

/// K_I by energy release.
///
/// # Errors
/// As [`stress_intensity`].
pub fn k_i(case: &Case) -> Result<Found> {
    let tips = stress_intensity(case, &[StressIntensityMethod::EnergyRelease])?;
    let computed = tips[0].methods[0].intensity.k_i.unwrap_or(f64::NAN);
    let error = Deviation {
        of: "K_I",
        percent: 100.0 * (computed / tips[0].handbook_k_i.unwrap_or(f64::NAN) - 1.0).abs(),
        against: "Feddersen 1966",
        at_end_percent: None,
    };
    Ok(Found { points: points_of(case), error: Some(error), broken_bonds: None })
}

/// Displacement of the plate without its crack.
///
/// # Errors
/// As [`uniform_tension_with`].
pub fn displacement(case: &Case) -> Result<Found> {
    let (specimen, model) = (&case.specimen, &case.model);
    let plate = strip(specimen.width, specimen.length());
    let resolution = (model.spacing, model.horizon_ratio, model.lattice_angle);
    let errors =
        uniform_tension_with((model.solver, model.symmetry), &plate, &model.bond_law, case.material.poisson_ratio, resolution)?;
    let error = Deviation {
        of: "displacement along the load, largest of all points",
        percent: errors.along,
        against: "u = σ y / E",
        at_end_percent: None,
    };
    Ok(Found { points: points_of(case), error: Some(error), broken_bonds: None })
}

/// Points of a plate without holes, near enough for a table.
fn points_of(case: &Case) -> usize {
    (case.specimen.area() / case.model.spacing.powi(2)).round() as usize
}
