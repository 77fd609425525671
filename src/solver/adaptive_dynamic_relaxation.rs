//! Adaptive dynamic relaxation: the plate swings to rest (Underwood 1983, in Belytschko and Hughes, Computational Methods for
//! Transient Analysis, 245; Kilic and Madenci 2010, Theor. Appl. Fract. Mech. 53:194), the usual way of peridynamic programs.
//!
//! ```text
//! Λ ü + c Λ u̇ = F,  F = f - K u,  time step 1
//! u̇(n+½) = [(2 - c) u̇(n-½) + 2 F(n) / Λ] / (2 + c),  u̇(½) = F(0) / 2 Λ
//! u(n+1) = u(n) + u̇(n+½)
//! ```
//!
//! with a fictitious density Λ for which that is stable (`density`) and the damping that is critical for the slowest mode in
//! motion, c = 2 ω. Kilic and Madenci estimate ω² by `uᵀ k u / uᵀ u` with a diagonal stiffness `k = ΔF / Λ u̇` from the change of F
//! over a step. That change is K u̇ itself, so `ω² = u̇ᵀ Λ⁻¹ K u̇ / u̇ᵀ u̇` needs no more and lets the motion, not the shape, say
//! which modes are left. Such a quotient lies above the lowest eigenvalue; the damping is taken lower by a fixed factor.
//!
//! Iterations per broken group of bonds on the panel of 152.4 x 300 mm at 1 mm spacing, warm start (and of the first solve),
//! means of 24 solves:
//!
//! | density | damping | iterations |
//! |---|---|---|
//! | row sums | Kilic and Madenci | 459 (1194) |
//! | row sums | velocity | 485 (1202) |
//! | point blocks | Kilic and Madenci | 397 (1076) |
//! | point blocks | Kilic and Madenci, 0.85 of it | 367 (1064) |
//! | point blocks | velocity | 433 (1082) |
//! | point blocks | velocity, 0.85 of it | 356 (870) |
//!
//! Damping kept between solves (or bounded by the last one's) takes 520 to 810: breaks at a tip set high modes in motion first.
//! A tenth less density than the bound diverges.
//!
//! Every step is one sweep over the rows: product, residual, sums for the damping and the norm, velocity and displacement. The
//! damping therefore is that of the step before. Loads that balance stay balanced: by Λ-weighted momentum, a floating plate
//! neither moves nor turns.

mod density;
mod load;
mod step;

use super::field::dot;
use super::product::{Product, ROWS_PER_TASK};
use super::{LinearSolver, Solved, SolverUsed, System};
use crate::body::{Body, Bond};
use crate::error::{Error, Result};
use crate::state::Bonds;
use load::GripSprings;
use step::{Factors, Motion, Sums};

/// Residual over load at which a solve ends at the latest, as usual for the method: 1e-9 takes half as many iterations more.
pub const TOLERANCE: f64 = 1e-6;
/// Iterations after which a solve has failed: some tens of those that a whole plate needs, enough for a last ligament.
const ITERATIONS_MAX: usize = 40_000;
/// Damping over what is critical for the estimated frequency.
const DAMPING_SHARE: f64 = 0.85;
/// Largest damping: above 2 velocities would change sign at every step.
const DAMPING_MAX: f64 = 1.9;

/// Dynamic relaxation from the last solution.
pub struct DynamicRelaxation<const N: usize> {
    /// 1/Λ of every component, m/N; 0 where nothing moves.
    mobility: Vec<f64>,
    motion: Motion,
    grips: GripSprings<N>,
    /// Displacement after a step.
    next: Vec<f64>,
    /// Residual over load at which a solve ends.
    tolerance: f64,
}

impl<const N: usize> DynamicRelaxation<N> {
    /// At rest, with the density of the present bonds.
    pub fn new(body: &Body, bonds: &Bonds, product: &Product<N>) -> Self {
        let layout = product.layout();
        let mut solver = DynamicRelaxation {
            mobility: layout.zeros(),
            motion: Motion::at_rest(layout, body.lattice.rows.div_ceil(ROWS_PER_TASK), product.dilatation().is_some()),
            grips: GripSprings::of(body, product),
            next: layout.zeros(),
            tolerance: TOLERANCE,
        };
        let places: Vec<usize> = body.points.iter().map(|&place| place as usize).collect();
        solver.weigh(body, bonds, product, &places);
        solver
    }

    /// Takes the density of some points from their present bonds.
    fn weigh(&mut self, body: &Body, bonds: &Bonds, product: &Product<N>, places: &[usize]) {
        let layout = product.layout();
        let densities = density::densities(body, bonds, product, places);
        for (&place, densities) in places.iter().zip(densities) {
            let first = layout.index(place);
            for (c, density) in densities.into_iter().enumerate() {
                self.mobility[first + c * layout.stride] = if density > 0.0 { 1.0 / density } else { 0.0 };
            }
        }
        product.fixed().iter().for_each(|&index| self.mobility[index] = 0.0);
    }

    /// Moves `u` until its residual is small against the load; the iterations, or `None` if it never is.
    fn relax(&mut self, system: System<'_, N>, u: &mut [f64]) -> Option<usize> {
        let mut factors = Factors::FIRST;
        let (mut here, mut there) = (u, &mut self.next[..]);
        for iteration in 0..=ITERATIONS_MAX {
            let sums = self.motion.step(system, &self.mobility, factors, here, there);
            let residual = sums.square.sqrt();
            if residual <= self.tolerance * self.grips.load(system, here) {
                if iteration % 2 == 1 {
                    // `here` is the solver's own vector, `there` the one to give back.
                    there.copy_from_slice(here);
                }
                return Some(iteration);
            }
            if !residual.is_finite() {
                return None;
            }
            // Before the first step nothing moves: no frequency to damp.
            factors = Factors::of_damping(if iteration == 0 { 0.0 } else { damping(sums) });
            std::mem::swap(&mut here, &mut there);
        }
        None
    }
}

/// Damping for the frequency in motion.
fn damping(Sums { stiffness, mass, .. }: Sums) -> f64 {
    let square = if mass > 0.0 { stiffness / mass } else { 0.0 };
    (DAMPING_SHARE * 2.0 * square.max(0.0).sqrt()).min(DAMPING_MAX)
}

impl<const N: usize> LinearSolver<N> for DynamicRelaxation<N> {
    fn used(&self) -> SolverUsed {
        SolverUsed::AdaptiveDynamicRelaxation
    }

    fn solve(&mut self, system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
        let System { product, f, .. } = system;
        let iterations = self.relax(system, u).ok_or_else(|| {
            Error::Mechanics(format!(
                "adaptive dynamic relaxation did not come to rest (residual {:e} of the load) within {ITERATIONS_MAX} \
                 iterations: use model.solver = \"window\", \"multigrid\" or \"direct\"",
                self.tolerance
            ))
        })?;
        tracing::debug!(iterations, "relaxed");
        Ok(Solved { iterations, work: dot(product.layout(), f, u) })
    }

    fn knows_contact(&self) -> bool {
        false
    }

    fn set_tolerance(&mut self, tolerance: f64) {
        self.tolerance = tolerance.min(TOLERANCE);
    }

    fn broke(&mut self, body: &Body, bonds: &Bonds, product: &Product<N>, broken: &[Bond]) {
        let mut ends: Vec<usize> =
            broken.iter().flat_map(|&bond| [body.ends(bond).1, body.ends(bond).2]).map(|place| body.behind(place).0).collect();
        ends.sort_unstable();
        ends.dedup();
        self.weigh(body, bonds, product, &ends);
    }
}
