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
        let length_less = |growths: &[f64]| {
            let growths: Vec<f64> = self.state.fronts.iter().zip(growths).map(|(front, growth)| front.growth - growth).collect();
            self.case.specimen.crack_length_after(&growths)
        };
        let length = length_less(&vec![0.0; growths.len()]);
        let sign = if self.case.loading.displacement().is_some() { -1.0 } else { 1.0 };
        let block = ReleasedEnergy {
            of_tips: self.case.specimen.thickness * released,
            of_plate: sign * 0.5 * (work_now - work),
            growth: growths.iter().sum(),
            lengthening: length - length_less(&growths),
            cycles,
        };
        self.state.balance.take(block, length, 0.2 * self.settings.resolution.far);
    }
}
