//! Loads and supports of a scene at full load, unknown by unknown. All of them grow in proportion.

use super::super::boundary::{Boundary, Motion};
use super::relaxation::Loads;
use crate::error::{Result, input};
use crate::levels::Net;
pub use crate::levels::equilibrium::FullLoad;

impl FullLoad {
    /// Loads and supports of a boundary.
    /// Errors: a prescribed velocity: there is no time.
    pub fn of(net: &Net, boundary: &Boundary) -> Result<Self> {
        let mut full = FullLoad::none(net);
        for held in &boundary.held {
            let Motion::Displacement(value) = held.motion else {
                let remedy = "give loading.duration_s, or kind = \"displacement\" with displacement_mm";
                return Err(input("loading.kind", "\"velocity\"", "needs time, and the scene has none", remedy));
            };
            let at = held.point as usize * net.unknowns + held.component;
            (full.held[at], full.motion[at]) = (true, value);
        }
        for &(point, force) in &boundary.forces {
            for (component, force) in force.into_iter().enumerate() {
                let at = point as usize * net.unknowns + component;
                full.external[at] += if full.held[at] { 0.0 } else { force };
            }
        }
        full.pin(net);
        Ok(full)
    }

    /// Lets the plate float after all: something that is not among these loads holds it.
    pub fn release(&mut self) {
        std::mem::take(&mut self.pins).into_iter().for_each(|at| self.held[at] = false);
    }

    /// The loads as dynamic relaxation takes them.
    pub fn loads(&self) -> Loads<'_> {
        Loads { held: &self.held, external: &self.external }
    }

    /// Work that the held unknowns would do on the way to full load against these forces of the bonds, and work of the given
    /// forces over this displacement, J.
    pub fn works(&self, u: &[f64], force: &[f64]) -> [f64; 2] {
        let driven: f64 = self.motion.iter().zip(force).map(|(motion, force)| -motion * force).sum();
        let pushed: f64 = self.external.iter().zip(u).map(|(force, u)| force * u).sum();
        [driven, pushed]
    }
}
