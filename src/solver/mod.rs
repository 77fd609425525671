//! Equilibrium of the body at maximum load.

pub mod adaptive_dynamic_relaxation;
pub mod assembly;
pub mod conjugate_gradient;
pub mod contact;
pub mod dilatation;
pub mod direct;
pub mod field;
pub mod kernel;
mod levels;
pub mod multigrid;
pub mod product;
mod ghosts;
pub mod mirrored;
mod rigid_motion;
mod sides;
pub mod window;

use std::sync::Arc;

use crate::body::{Body, Bond};
use crate::error::{Error, Result};
use crate::levels::multi_level_body::MultiLevelBody;
use crate::specimen::Point;
use crate::state::Bonds;
use contact::GapSpring;
use mirrored::Mirrored;
pub use mirrored::Symmetry;
use product::Product;

crate::kinds! {
    /// Equilibrium solvers.
    pub enum SolverKind for "model.solver" {
        Window = "window": "exact updates of the plate condensed onto the points around the crack tips; multigrid for whole solves",
        Multigrid = "multigrid": "conjugate gradients on a matrix-free stencil, preconditioned by crack-aware lattice multigrid",
        Direct = "direct": "sparse Cholesky factorisation, the reference",
        AdaptiveDynamicRelaxation = "adaptive_dynamic_relaxation": "damped motion to rest by a matrix-free stencil, the usual way of peridynamic programs; residual 1e-6",
    }
}

crate::kinds! {
    /// What solved a run, whatever `model.solver` asked for.
    pub enum SolverUsed for "solver of a run" {
        Window = "window": "updates of the plate condensed onto the points around the crack tips, multigrid for whole solves",
        Multigrid = "multigrid": "multigrid solves of the whole plate: no window was condensed",
        ConjugateGradients = "conjugate_gradients": "conjugate gradients with a sparse factor on the whole plate of several levels: no window was condensed",
        Direct = "direct": "sparse Cholesky factorisations of the whole plate",
        AdaptiveDynamicRelaxation = "adaptive_dynamic_relaxation": "damped motion of the whole plate to rest",
    }
}

/// A crack tip around which bonds may break next.
#[derive(Debug, Clone, PartialEq)]
pub struct Focus {
    /// Position, m.
    pub position: Point,
    /// Unit vector of growth.
    pub direction: Point,
    /// Way behind it on which bonds may still break, oldest place first.
    pub wake: Vec<Point>,
    /// Distance from that way and its continuation within which the ends of fatigue bonds lie, m.
    pub reach: f64,
}

impl Focus {
    /// The way of the tip and its continuation straight ahead, as segments.
    fn way(&self, ahead: f64) -> impl Iterator<Item = (Point, Point)> + '_ {
        let end = [0, 1].map(|i| self.position[i] + ahead * self.direction[i]);
        self.wake.windows(2).map(|step| (step[0], step[1])).chain(std::iter::once((self.position, end)))
    }
}

/// What a solve took and gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// Iterations; 0 for a direct solver.
    pub iterations: usize,
    /// Work of the load f·u, J.
    pub work: f64,
}

/// System of a linear solve: the plate with its bonds and the load on free components (zero on held ones).
#[derive(Clone, Copy)]
struct System<'a, const N: usize> {
    body: &'a Body,
    bonds: &'a Bonds,
    product: &'a Product<N>,
    f: &'a [f64],
}

/// Solves `K u = f` on the free components of a body; what a new solver has to supply. A solver may leave u right on some
/// points only, if it says so.
trait LinearSolver<const N: usize>: Send {
    /// Improves `u` until K u = f, at least on the window's points.
    fn solve(&mut self, system: System<'_, N>, u: &mut [f64]) -> Result<Solved>;
    /// Told which bonds broke since the last solve.
    fn broke(&mut self, body: &Body, bonds: &Bonds, product: &Product<N>, broken: &[Bond]);
    /// What has solved since it was built.
    fn used(&self) -> SolverUsed;
    /// Told to what residual over load to solve; the direct solver has one of its own, dynamic relaxation one that it does not pass.
    fn set_tolerance(&mut self, _: f64) {}
    /// Makes `u` right at the ends of `watched` bonds, and gets ready for breaks around the tips; what a solve of the whole plate
    /// took and gave if that needed one.
    fn reach(&mut self, _: System<'_, N>, _u: &mut [f64], _watched: &[Bond], _tips: &[Focus]) -> Result<Option<Solved>> {
        Ok(None)
    }
    /// Makes `u` right everywhere; what a solve took and gave if that needed one.
    fn complete(&mut self, _: System<'_, N>, _u: &mut [f64]) -> Result<Option<Solved>> {
        Ok(None)
    }
    /// `u` everywhere, as right as pictures need it, and the iterations; `None` where `u` itself is. Nothing else changes.
    fn picture(&mut self, _: System<'_, N>, _u: &[f64]) -> Result<Option<(Vec<f64>, usize)>> {
        Ok(None)
    }
    /// Whether to begin anew costs little now, `solves` solves after the last beginning.
    fn is_due(&self, _body: &Body, _watched: &[Bond], solves: usize) -> bool {
        solves >= SOLVES_MOST
    }
    /// Whether `u` is right everywhere.
    fn is_whole(&self) -> bool {
        true
    }
    /// Whether it knows springs between flanks in contact.
    fn knows_contact(&self) -> bool {
        true
    }
    /// Points, ascending, on which `u` is always right; `None` if that is all of them.
    fn window(&self) -> Option<&[u32]> {
        None
    }
}

/// What is said where a solver knows no contact.
fn no_contact(solver: SolverUsed) -> Error {
    let problem = format!("the load presses flanks of cracks together, and {solver} knows no contact");
    Error::Mechanics(format!("{problem}: use model.solver = \"window\", \"multigrid\" or \"direct\" on a lattice of one spacing"))
}

/// Solves of the whole plate after which a solver begins anew. That takes three to four of them: a solve from rest, and where
/// there is one a new hierarchy.
const SOLVES_MOST: usize = 128;

/// Does work on a thread of the pool: a parallel loop started from outside would wait for threads to be woken every time.
fn in_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    rayon::scope(|_| work())
}

/// Keeps a body in equilibrium with its load while bonds break.
pub struct Equilibrium {
    inner: Box<dyn EquilibriumBackend>,
    /// Solves since it was built.
    solves: usize,
}

/// Both sides of the system, with the number of unknowns and mirror images hidden.
trait EquilibriumBackend: Send {
    fn set_tolerance(&mut self, tolerance: f64);
    fn solve(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize>;
    fn broke(&mut self, body: &Body, bonds: &Bonds, broken: &[Bond]);
    fn work(&self) -> f64;
    fn set_contact(&mut self, body: &Body, contact: &[GapSpring]) -> Result<()>;
    fn reach(
        &mut self,
        body: &Body,
        bonds: &Bonds,
        watched: &[Bond],
        tips: &[Focus],
        displacement: &mut Vec<f64>,
    ) -> Result<usize>;
    fn is_due(&self, body: &Body, watched: &[Bond], solves: usize) -> bool;
    fn complete(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize>;
    fn picture(&mut self, body: &Body, bonds: &Bonds) -> Result<(Vec<f64>, usize)>;
    fn is_whole(&self) -> bool;
    fn window(&self) -> Option<&[u32]>;
    fn points(&self, body: &Body) -> usize;
    fn used(&self) -> SolverUsed;
}

impl Equilibrium {
    /// Equilibrium of a body under `load` times its unit load (Pa or N, as the specimen measures load).
    pub fn new(kind: SolverKind, symmetry: Symmetry, body: &Body, bonds: &Bonds, load: f64) -> Self {
        let inner = in_pool(|| -> Box<dyn EquilibriumBackend> {
            let mirrored = match symmetry {
                Symmetry::Auto => Mirrored::new(kind, body, bonds, load),
                Symmetry::Off => None,
            };
            match mirrored {
                Some(mirrored) => Box::new(mirrored),
                None => sides::balance(kind, body, bonds, load),
            }
        });
        Equilibrium { inner, solves: 0 }
    }

    /// Equilibrium of a plate of several levels, `body` being its finest points, under `load` times its unit load (Pa or N). Only
    /// [`SolverKind::Window`] and [`SolverKind::Direct`] know such plates, and the latter solves the whole plate after every break;
    /// every other kind is taken for the first.
    ///
    /// Displacements are those of the body in its layout, and behind them those of all other points, unknown by unknown, in the
    /// order of their numbers ([`MultiLevelBody::ids`]).
    pub fn of_levels(kind: SolverKind, plate: Arc<MultiLevelBody>, body: &Body, bonds: &Bonds, load: f64) -> Self {
        Equilibrium { inner: in_pool(|| sides::balance_levels(kind, plate, body, bonds, load)), solves: 0 }
    }

    /// Solves iteratively to this residual over load instead of what bonds that break one by one need.
    pub fn to_tolerance(mut self, tolerance: f64) -> Self {
        self.inner.set_tolerance(tolerance);
        self
    }

    /// Points that are solved for: those of the body, or of the part of it that stands for all by symmetry.
    pub fn points(&self, body: &Body) -> usize {
        self.inner.points(body)
    }

    /// What has solved since it was built: the window only if one was condensed.
    pub fn used(&self) -> SolverUsed {
        self.inner.used()
    }

    /// Solves for the present bonds, starting from the last solution; returns the iterations.
    /// `displacement` receives the field in the layout of [`field::Layout::of`], right on the [`Equilibrium::window`].
    ///
    /// # Errors
    /// `Error::Mechanics` if the iteration does not converge.
    pub fn solve(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        self.solves += 1;
        in_pool(|| self.inner.solve(body, bonds, displacement))
    }

    /// Tells the solver which bonds were cut, or got another multiplier, since the last solve.
    pub fn bonds_changed(&mut self, body: &Body, bonds: &Bonds, changed: &[Bond]) {
        self.inner.broke(body, bonds, changed);
    }

    /// Puts these springs between flanks in contact, and forces between flanks under pressure, in place of those that were there; places
    /// are those of the body.
    ///
    /// # Errors
    /// A solver that knows no such springs.
    pub fn set_contact(&mut self, body: &Body, contact: &[GapSpring]) -> Result<()> {
        self.inner.set_contact(body, contact)
    }

    /// Makes the displacement right at the ends of `watched` bonds, and gets ready for breaks around the tips; returns the
    /// iterations.
    pub fn reach(
        &mut self,
        body: &Body,
        bonds: &Bonds,
        watched: &[Bond],
        tips: &[Focus],
        displacement: &mut Vec<f64>,
    ) -> Result<usize> {
        in_pool(|| self.inner.reach(body, bonds, watched, tips, displacement))
    }

    /// Whether this is a good moment to put a new one in its place, which knows nothing but the bonds: the window would have to be
    /// moved for the `watched` bonds anyway, or that many solves have passed that a new beginning hardly counts. It depends on what
    /// was solved since it was built, never on time.
    pub fn should_rebuild(&self, body: &Body, watched: &[Bond]) -> bool {
        self.inner.is_due(body, watched, self.solves)
    }

    /// Makes the displacement right everywhere; returns the iterations.
    pub fn complete(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        in_pool(|| self.inner.complete(body, bonds, displacement))
    }

    /// The displacement everywhere for a picture, solved for to a residual of 1e-4 of the load where it is not known, and the
    /// iterations. What the run goes on with stays as it is, so that a run does not depend on its pictures.
    pub fn picture(&mut self, body: &Body, bonds: &Bonds) -> Result<(Vec<f64>, usize)> {
        in_pool(|| self.inner.picture(body, bonds))
    }

    /// Whether the displacement is right everywhere.
    pub fn is_whole(&self) -> bool {
        self.inner.is_whole()
    }

    /// Points, ascending, on which the displacement is right after every solve; `None` if that is all of them.
    pub fn window(&self) -> Option<&[u32]> {
        self.inner.window()
    }

    /// Work of the loads over the last displacement, f·u, J: twice the strain energy.
    pub fn work(&self) -> f64 {
        self.inner.work()
    }
}
