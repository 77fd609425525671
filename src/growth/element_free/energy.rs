//! K of the tips against the energy that the plate releases.

use super::ElementFree;
use super::front::{Front, kinked};
use super::increment::Increment;
use crate::growth::cross_check::ReleasedEnergy;

impl ElementFree<'_> {
    /// K_eq²/E' of every tip, J/m², and work of the loads, J.
    pub(super) fn energies(&self) -> (Vec<f64>, f64) {
        let modulus = self.case.material.plane_modulus();
        let of_front = |front: &Front| {
            let factor = if front.begins_kink() { kinked(front) } else { front.equivalent() };
            factor.powi(2) / modulus
        };
        (self.state.fronts.iter().map(of_front).collect(), self.load_work())
    }

    /// Compares the energy that the new segments released by their K with what the plate did.
    pub(super) fn compare_energies(&mut self, step: &Increment, cycles: f64) {
        let ((now, work_now), (before, work)) = (self.energies(), &step.before);
        let growths: Vec<f64> = step.moves.iter().map(|step| step.0).collect();
        let released: f64 = growths.iter().zip(before).zip(now).map(|((growth, then), now)| 0.5 * (then + now) * growth).sum();
        let grown: Vec<f64> = self.state.fronts.iter().map(|front| front.growth).collect();
        let (block, length) = ReleasedEnergy::of_block(self.case, released, &growths, &grown, [*work, work_now], cycles);
        self.state.balance.take(block, length, 0.2 * self.settings.resolution.far);
    }
}
