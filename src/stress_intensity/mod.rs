//! Stress intensity factors K_I and K_II of every crack tip, from equilibrium at maximum load.
//!
//! Both methods are independent of each other but for the equilibrium itself: one takes the energy that crack growth
//! releases, which tells K_I of cracks that open only, one an integral over a ring around the tip. A crack cut into bonds reaches up
//! to half a spacing farther or less far than asked ([`crate::body::severed`]); both methods therefore look at crack
//! lengths on both sides of the one asked for and interpolate: K belongs to the requested length.
//!
//! Signs, in the frame of a tip (x₁ ahead of the tip, x₂ a quarter turn counter-clockwise from it): K_I > 0 opens the
//! crack, K_II > 0 slides the face on the side of x₂ > 0 towards x₁ > 0.

mod cracked_plate;
mod cut_cells;
mod domain_integral;
mod energy_release;
mod gradient;
pub mod ring;
mod tip_frame;
pub mod williams;

use std::time::Instant;

use crate::case::Case;
use crate::error::{Error, Result, input_missing};
use crate::specimen::handbook::handbook;
use crate::specimen::{Point, TipSeed};
pub use cracked_plate::{CrackedPlate, Field};
pub use tip_frame::TipFrame;

crate::kinds! {
    /// Ways to the stress intensity factors.
    pub enum StressIntensityMethod for "sif --method" {
        EnergyRelease = "energy_release": "energy released between slightly different crack lengths: K_I where the plate is symmetric about the crack, an independent check",
        DomainIntegral = "domain_integral": "interaction integral over a ring around the tip, gradients by least squares on displacements",
    }
}

/// K_I and K_II, Pa√m; `None` where a method cannot tell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Intensity {
    /// Opening mode.
    pub k_i: Option<f64>,
    /// In-plane sliding mode.
    pub k_ii: Option<f64>,
}

impl Intensity {
    /// Both modes known.
    #[must_use]
    pub fn both([k_i, k_ii]: [f64; 2]) -> Self {
        Intensity { k_i: Some(k_i), k_ii: Some(k_ii) }
    }
}

/// What one method says about one tip.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodResult {
    /// The method.
    pub method: StressIntensityMethod,
    /// Its factors.
    pub intensity: Intensity,
    /// Why a factor is missing.
    pub note: Option<String>,
    /// Seconds for this tip, with the solutions it rests on.
    pub wall_s: f64,
}

/// A crack tip with its factors.
#[derive(Debug, Clone, PartialEq)]
pub struct TipResult {
    /// Tip of the requested crack.
    pub tip: TipSeed,
    /// One entry a method, in the order asked for.
    pub methods: Vec<MethodResult>,
    /// K_I by the handbook, Pa√m, where there is a formula and it holds.
    pub handbook_k_i: Option<f64>,
}

/// Stress intensity factors of every crack tip of a case at its maximum load.
///
/// End faces of slots are no crack tips and left out.
///
/// # Errors
/// A case without crack tips, mechanics without equilibrium.
pub fn stress_intensity(case: &Case, methods: &[StressIntensityMethod]) -> Result<Vec<TipResult>> {
    let tips: Vec<usize> = (0..case.specimen.tips.len()).filter(|&tip| !case.specimen.tips[tip].from_slot).collect();
    if tips.is_empty() {
        return Err(input_missing(
            "specimen.cracks",
            "is missing: only the tip of a sharp crack has stress intensity factors, a notch has none",
            "give a crack that starts in the notch",
        ));
    }
    let mut plate = CrackedPlate::new(case)?;
    let handbook_k_i = handbook(&case.specimen)
        .filter(|formula| formula.holds_at(case.specimen.crack_length))
        .map(|formula| formula.k_i(case.specimen.crack_length, case.loading.maximum));
    let mut results: Vec<TipResult> = tips
        .iter()
        .map(|&tip| TipResult { tip: case.specimen.tips[tip], methods: Vec::with_capacity(methods.len()), handbook_k_i })
        .collect();
    for &method in methods {
        let columns = match method {
            StressIntensityMethod::EnergyRelease => energy_release::all_tips(&mut plate, &tips)?,
            StressIntensityMethod::DomainIntegral => {
                let fields = Straddling::solve(&mut plate)?;
                tips.iter().map(|&tip| fields.interpolate(&plate, tip)).collect()
            }
        };
        results.iter_mut().zip(columns).for_each(|(tip, result)| tip.methods.push(result));
    }
    Ok(results)
}

/// Two solutions with cracks half a spacing shorter and longer than asked.
struct Straddling {
    fields: [Field; 2],
    wall_s: f64,
}

impl Straddling {
    fn solve(plate: &mut CrackedPlate) -> Result<Self> {
        let started = Instant::now();
        let half = 0.5 * plate.body.lattice.spacing;
        let mut at = |growth: f64| plate.solve(&plate.growth_of_all(growth));
        Ok(Straddling { fields: [at(-half)?, at(half)?], wall_s: started.elapsed().as_secs_f64() })
    }

    /// Factors of both solutions, on the straight line through them at the length asked for.
    fn interpolate(&self, plate: &CrackedPlate, tip: usize) -> MethodResult {
        let started = Instant::now();
        let asked = plate.case.specimen.tips[tip].position;
        let of_field = |field: &Field| -> Result<(f64, [f64; 2])> {
            let excess = plate.frame(&field.specimen, tip).local(asked)[0];
            Ok((-excess, domain_integral::factors(plate, field, tip)?))
        };
        let both = of_field(&self.fields[0]).and_then(|a| Ok((a, of_field(&self.fields[1])?)));
        let (intensity, note) = match both {
            Ok(((from, a), (to, b))) => (Intensity::both([0, 1].map(|i| (a[i] * to - b[i] * from) / (to - from))), None),
            Err(error) => (Intensity::default(), Some(error.to_string())),
        };
        let wall_s = self.wall_s + started.elapsed().as_secs_f64();
        MethodResult { method: StressIntensityMethod::DomainIntegral, intensity, note, wall_s }
    }
}

/// A tip that stands too close to something for a method, in words.
fn too_close(what: &str, tip: Point) -> Error {
    let [x, y] = tip.map(|metres| metres / crate::units::MM);
    Error::Mechanics(format!("{what} around the crack tip at ({x:.6}, {y:.6}) mm; give a smaller model.spacing_mm"))
}
