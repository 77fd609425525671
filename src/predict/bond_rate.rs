//! How fast a crack grows whose bonds follow dλ/dN = -A ε^p.
//!
//! A bond enters the ageing zone of a steadily growing crack with λ = 1 and leaves it with 0. Its strain is that of the tip's
//! field, so ([`FatigueLaw`])
//!
//! `da/dN = β A δ^(1-p/2) (K_eq/E')^p`
//!
//! with a number β that depends on p and on the kernel alone: neither on the plate, its size and its load nor on E'. β is not typed
//! in but computed when it is needed: a long straight crack between the rows of a plate grows by two horizons, once as its bonds are
//! spent by their own strains (`growth_rate = "bond_strain"`, A = 1) and once by the K of its tips, and the ratio of the cycles gives
//! β. So both drivers give one life, and A and p follow from C and m and the other way round. A belongs to lattices of three spacings
//! a horizon (`model.horizon_ratio` 3.015) and to cracks that do not run along their rows, and stands for the same rate on all
//! others, on which bonds left to themselves would make another one of it.
//!
//! Up to p = 3 β is the same within 1 % for 10 to 26 horizons of crack in plates of 40 to 100 horizons (at p = 6 within 5 %).

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use super::factor_curve::FactorCurve;
use super::record::Record;
use super::{Prediction, Silent, StopReason};
use crate::bond_law::Kernel;
use crate::case::{Case, HORIZON_RATIO, Model};
use crate::error::{Error, Result};
use crate::fatigue::{FatigueLaw, STEADY_EXPONENTS, unsteady};
use crate::growth::bond_strain::{BondRates, BondStrain};
use crate::quadrature::integrate;

/// Size of the reference plate, crack length (half) before and after, in horizons.
const WIDTH: f64 = 60.0;
const CRACK: [f64; 2] = [14.0, 16.0];
/// Relative error of its cycles by K.
const TOLERANCE: f64 = 1e-6;

/// Strain of the bonds around a crack in any direction over that around one along the rows, at equal K: what A belongs to. Along the
/// rows a crack opens like a zip, and faster; off them rates hardly depend on Poisson's ratio. Measured at ν = 0.3 by lives on lattices
/// turned by 10 to 35°, the same at p = 2, 2.86 and 4. It fixes the unit of A and cancels wherever A was fitted.
const OFF_THE_ROWS: f64 = 0.9343;

/// What β depends on beside p.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ReferenceModel {
    kernel: Kernel,
}

impl ReferenceModel {
    /// That of a model.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        ReferenceModel { kernel: model.bond_law.kernel }
    }

    /// β at an exponent, computed once in the life of the program.
    ///
    /// # Errors
    /// p outside [`STEADY_EXPONENTS`].
    pub fn rate_constant(self, p: f64) -> Result<f64> {
        if !STEADY_EXPONENTS.contains(&p) {
            return Err(unsteady("fatigue.p", p));
        }
        let key = (self, p.to_bits());
        // Not held while it is computed: whoever computes works with others on all cores, and may meet one who waits here.
        if let Some(known) = known().get(&key) {
            return Ok(*known);
        }
        let found = self.compute(p)?;
        known().insert(key, found);
        Ok(found)
    }

    fn compute(self, p: f64) -> Result<f64> {
        let case = self.reference()?;
        let (factor, grown) = rayon::join(|| self.factors(&case), || grow(&case, p));
        let (factor, grown) = (factor?, grown?);
        if grown.stop != StopReason::CrackLengthReached {
            return Err(Error::Mechanics(format!(
                "the crack of the reference plate for p = {p} ended as {}: give paris_c_mm_per_cycle and paris_m instead of a and p",
                grown.stop
            )));
        }
        let (modulus, horizon) = (case.material.plane_modulus(), factor.figures.horizon);
        let [from, to] = [case.specimen.crack_length, case.stop.crack_length];
        let slowness = integrate(|a| (factor.at(a) / modulus).powf(-p), from, to, TOLERANCE).value;
        Ok(OFF_THE_ROWS.powf(p) * slowness / (grown.life_cycles() * horizon.powf(1.0 - 0.5 * p)))
    }

    /// K(a) of the reference plate, the same for every p.
    fn factors(self, case: &Case) -> Result<Arc<FactorCurve>> {
        static KNOWN: Mutex<Option<HashMap<ReferenceModel, Arc<FactorCurve>>>> = Mutex::new(None);
        let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(curve) = known().get_or_insert_default().get(&self) {
            return Ok(curve.clone());
        }
        let curve = Arc::new(FactorCurve::of(case, &Silent)?);
        known().get_or_insert_default().insert(self, curve.clone());
        Ok(curve)
    }

    /// A middle-tension plate of spacing 1 mm in plane stress, ν = 0.3.
    fn reference(self) -> Result<Case> {
        let horizon = HORIZON_RATIO;
        let [width, from, to] = [WIDTH, CRACK[0], CRACK[1]].map(|horizons| horizons * horizon);
        let text = format!(
            "[specimen]\nkind = \"middle_tension\"\nwidth_mm = {width}\nlength_mm = {width}\nthickness_mm = 1\n\
             crack_length_mm = {from}\n[material]\nyoungs_modulus_gpa = 100\npoisson_ratio = 0.3\nplane = \"stress\"\n\
             [loading]\nkind = \"constant_amplitude\"\nstress_max_mpa = 100\nstress_ratio = 0\n\
             [model]\nspacing_mm = 1\nhorizon_ratio = {horizon}\nkernel = \"{}\"\n\
             [fatigue]\ndriver = \"bond_strain\"\ngrowth_rate = \"bond_strain\"\na = 1\np = 3\nhorizon_mm = {horizon}\n[stop]\ncrack_length_mm = {to}\n",
            self.kernel
        );
        let mut case = Case::from_toml(&text, "reference plate", Path::new(""), &[])?;
        case.stop.cycles_max = f64::INFINITY;
        Ok(case)
    }
}

/// Grows the crack of the reference plate by its bonds, A = 1 at the horizon that the plate has.
fn grow(case: &Case, p: f64) -> Result<Prediction> {
    let record = Record::new(case, &Silent).unchecked();
    let case = &record.case().clone();
    let law = |horizon| Ok(BondRates { bonds: FatigueLaw { a: 1.0, p, horizon }, over_k: None });
    record.follow(&mut BondStrain::start(case, law)?, |bonds| bonds.next_break())
}

/// What was computed so far. Values are put in whole.
fn known() -> std::sync::MutexGuard<'static, HashMap<(ReferenceModel, u64), f64>> {
    static KNOWN: std::sync::LazyLock<Mutex<HashMap<(ReferenceModel, u64), f64>>> = std::sync::LazyLock::new(Mutex::default);
    KNOWN.lock().unwrap_or_else(PoisonError::into_inner)
}
