//! Equilibrium of the body at maximum load.

pub mod assembly;
pub mod conjugate_gradient;
pub mod dilatation;
pub mod direct;
pub mod field;
pub mod kernel;
pub mod multigrid;
pub mod product;
pub mod mirrored;
mod rigid_motion;
mod sides;
pub mod spring;
mod system;
mod ties;
pub mod window;

use crate::body::{Body, Bond};
use crate::state::Bonds;
use mirrored::Mirrored;
pub use mirrored::Symmetry;
use perilife_base::error::Result;
use spring::GapSpring;
use system::EquilibriumBackend;
pub use system::{Focus, Solved, SolverKind, SolverUsed};

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

impl Equilibrium {
    /// Equilibrium of a body under `load` times its unit load (Pa or N, as the specimen measures load).
    /// Without a kind every solve factorizes the whole plate (without held sums): the reference of tests.
    pub fn new(kind: impl Into<Option<SolverKind>>, symmetry: Symmetry, body: &Body, bonds: &Bonds, load: f64) -> Self {
        let kind = kind.into();
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
    /// Errors: `Error::Mechanics` if the iteration does not converge.
    pub fn solve(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        self.solves += 1;
        in_pool(|| self.inner.solve(body, bonds, displacement))
    }

    /// Tells the solver which bonds were cut, or got another multiplier, since the last solve.
    pub fn bonds_changed(&mut self, body: &Body, bonds: &Bonds, changed: &[Bond]) {
        self.inner.broke(body, bonds, changed);
    }

    /// Puts these springs between flanks in contact, and forces between flanks under pressure, in place of those that were there, beside a
    /// share of the load; places are those of the body. Not to be asked of a solver that [`Equilibrium::reach`]ed: a condensed window knows no contact.
    pub fn set_contact(&mut self, body: &Body, share: f64, contact: &[GapSpring]) {
        self.inner.set_contact(body, share, contact);
    }

    /// Makes the displacement right at the ends of watched bonds and gets ready for breaks around tips, both of `ahead`; returns iterations.
    pub fn reach(
        &mut self,
        body: &Body,
        bonds: &Bonds,
        ahead: (&[Bond], &[Focus]),
        displacement: &mut Vec<f64>,
    ) -> Result<usize> {
        in_pool(|| self.inner.reach(body, bonds, ahead, displacement))
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
