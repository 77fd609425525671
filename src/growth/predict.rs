//! THE MAIN PAGE: from a case to its a-N curve.
//!
//! A plate of points and bonds is in equilibrium under the maximum load. Every crack is a line whose tips grow by their own stress
//! intensity; [`increment`] is that theory, one equation a call. Other stages of a life come before it or in its place ([`chain::Stage`]): bonds
//! that fail by their own strain (`fatigue.driver = "bond_strain"`), which hand a crack from a slot over to the K of its tip, and K of a
//! handbook (`model.method = "handbook"`), which hands a crack that has grown through the thickness over to the K of its tips. Command, service
//! and calibration all come through here. The theory in the order of the rooms is in `src/README.md`.

pub mod chain;
pub mod checkpoint;
pub mod error_estimate;
pub mod factor_curve;
pub mod factor_sweep;
pub mod laws;
pub mod moment;
pub mod fit_use;
pub mod initiation;
pub mod judgement;
mod outcome;
pub mod part_through;
pub mod pin_arcs;
pub mod plastic_zone;
pub mod record;
pub mod recorded;
pub mod residual_strength;
mod retarded;
mod snapshot;
pub mod tip_factors;
mod way;

pub use outcome::{CrossCheck, CurvePoint, GoverningCrack, Prediction, Progress, RunFigures, StopReason, TipRecord};
pub use perilife_base::watch::Silent;
pub use record::Observer;

use std::cell::OnceCell;

use crate::case::{Case, needs};
use crate::cracks::{CrackedPlate, Cracks};
use chain::Chain;
use checkpoint::Checkpoint;
use perilife_base::error::Result;
use perilife_base::parallel::in_pool;
use perilife_base::watch;
use record::Record;

/// Predicts the a-N curve of a case.
/// Errors: wrong input that shows only now (spacing against plate or memory, no fatigue law), or mechanics that fail before there
/// is a curve.
pub fn predict(case: &Case, observer: &dyn Observer) -> Result<Prediction> {
    follow(case, None, observer)
}

/// Goes on with a run of a case from a checkpoint of it; gives what [`predict`] gives, bit for bit, its wall time counted from the
/// start of the first run.
/// Errors: as [`predict`]; [`perilife_base::error::Error::Input`] if the checkpoint is not one of this case.
pub fn resume(case: &Case, checkpoint: Checkpoint, observer: &dyn Observer) -> Result<Prediction> {
    checkpoint.check(case)?;
    follow(case, Some(checkpoint), observer)
}

/// The stages of a life under the eyes of its observer: cracks form, grow by what drives them, and are handed over.
fn follow(case: &Case, from: Option<Checkpoint>, observer: &dyn Observer) -> Result<Prediction> {
    needs::of_case(case).within_machine()?;
    let run = || {
        let record = Record::new(case, observer);
        let (first, later) = (OnceCell::new(), OnceCell::new());
        let chain = Chain::start(record.case(), &first, &later)?;
        record.follow(chain, from)
    };
    in_pool(|| watch::with(observer.watch(), || watch::unless_cancelled(&case.name, run())))
}

/// One increment of all cracks by the stress intensity of their tips, which makes one row; the reason why there is no next one.
///
/// Before the first increment the plate with its initial cracks is in equilibrium and K of its tips is known.
/// Mechanics that fail end the run with the rows that stand.
pub fn increment<P: CrackedPlate>(cracks: &mut Cracks<'_, P>) -> Option<StopReason> {
    if let Some(reason) = cracks.reason_to_stop() {
        return Some(reason);
    }
    // Δa_i = ∫ r_i dN over the same cycles for every tip, the fastest by one step.
    let mut step = cracks.increments();
    // x_i ← x_i + Δa_i (cos θ_i, sin θ_i), up to the first edge, hole or other crack; cracks that meet are one.
    cracks.extend_lines(&mut step);
    // μ = 0 for every bond that a new segment crosses, fragments without load go, bonds beside the flanks get those of an edge;
    // or Φ_i(x) = 0 behind a crack, with nodes placed anew where tips are now.
    cracks.part_plate(&mut step);
    // Σ_j μ f(u_j - u_i) V_j + b_i = 0 at maximum load; or ∫ ε(Φ_i)ᵀ D ε(u) dA = ∫ Φ_i t ds; flanks carry pressure, g ≥ 0, λ ≥ 0, λ g = 0.
    if let Err(reason) = cracks.solve_equilibrium(&step) {
        return cracks.add_row(&step, Some(reason));
    }
    // K_I, K_II = ½ E' M(u; Williams' field of unit K), T likewise, on a ring around every tip (interaction integral).
    if let Err(reason) = cracks.read_factors(&mut step) {
        return Some(reason);
    }
    // K_I sin θ + K_II (3 cos θ - 1) = 0: largest circumferential stress.
    cracks.turn(&step);
    // r = da/dN of K_eq = cos(θ/2) [K_I cos²(θ/2) - 3/2 K_II sin θ] and R; C ΔK^m = β A δ^(1-p/2) (ΔK/E')^p for a law of bonds.
    cracks.set_rates(&step);
    // N ← N + ∫ da/r; the bonds ahead of every tip lose remaining life, dλ/dN = -r/ℓ.
    cracks.add_row(&step, None)
}
