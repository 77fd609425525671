//! Equilibrium of the body at maximum load.

pub mod assembly;
pub mod conjugate_gradient;
pub mod dilatation;
mod direct;
pub mod field;
pub mod kernel;
pub mod multigrid;
pub mod product;
mod mirrored;
mod rigid_motion;
mod sides;
pub mod spring;
mod system;
mod ties;
pub mod window;

use crate::body::{Body, Bond};
use crate::state::Bonds;
use conjugate_gradient::TOLERANCE;
use mirrored::SymmetricPart;
pub use mirrored::Symmetry;
use perilife_base::error::Result;
use perilife_base::parallel::in_pool;
use sides::{Sides, balance};
use spring::GapSpring;
pub use system::{Focus, SolverKind, SolverUsed};
use system::{Sought, Standing};

/// Keeps a body in equilibrium with its load while bonds break.
pub struct Equilibrium {
    kind: Option<SolverKind>,
    load: f64,
    /// Residual over load at which an iteration ends.
    tolerance: f64,
    /// What of a symmetric plate is solved, until bonds break on one side only.
    part: Option<SymmetricPart>,
    /// Of the part, if there is one.
    sides: Box<dyn Sides>,
    /// Solves since it was built.
    solves: usize,
}

impl Equilibrium {
    /// Equilibrium of a body under `load` times its unit load (Pa or N, as the specimen measures load).
    /// Without a kind every solve factorizes the whole plate (without held sums): the reference of tests.
    pub fn new(kind: impl Into<Option<SolverKind>>, symmetry: Symmetry, body: &Body, bonds: &Bonds, load: f64) -> Self {
        let kind = kind.into();
        in_pool(|| {
            let part = if symmetry == Symmetry::Auto { SymmetricPart::of(body, bonds) } else { None };
            let sides = match &part {
                Some(part) => balance(kind, part.body(), &part.bonds, load),
                None => balance(kind, body, bonds, load),
            };
            Equilibrium { kind, load, tolerance: TOLERANCE, part, sides, solves: 0 }
        })
    }

    /// Solves iteratively to this residual over load instead of what bonds that break one by one need.
    pub fn to_tolerance(self, tolerance: f64) -> Self {
        Equilibrium { tolerance, ..self }
    }

    /// Points that are solved for: those of the body, or of the part of it that stands for all by symmetry.
    pub fn points(&self, body: &Body) -> usize {
        self.part.as_ref().map_or(body, SymmetricPart::body).points.len()
    }

    /// What has solved since it was built: the window only if one was condensed.
    pub fn used(&self) -> SolverUsed {
        self.sides.used()
    }

    /// Solves for the present bonds, starting from the last solution; returns the iterations.
    /// `displacement` receives the field in the layout of [`field::Layout::of`], right on the [`Equilibrium::window`].
    /// Errors: `Error::Mechanics` if the iteration does not converge.
    pub fn solve(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        self.solves += 1;
        self.seek(Sought::Equilibrium, body, bonds, displacement)
    }

    /// Makes the displacement right at the ends of watched bonds and gets ready for breaks around tips, both of `ahead`; returns iterations.
    pub fn reach(
        &mut self,
        body: &Body,
        bonds: &Bonds,
        ahead: (&[Bond], &[Focus]),
        displacement: &mut Vec<f64>,
    ) -> Result<usize> {
        let watched = self.part.as_ref().map(|part| part.part.bonds(body, ahead.0));
        self.seek(Sought::Ahead(watched.as_deref().unwrap_or(ahead.0), ahead.1), body, bonds, displacement)
    }

    /// Makes the displacement right everywhere; returns the iterations.
    pub fn complete(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        self.seek(Sought::Everywhere, body, bonds, displacement)
    }

    fn seek(&mut self, sought: Sought<'_>, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        let Equilibrium { part, sides, tolerance, .. } = self;
        in_pool(|| {
            let Some(part) = part else {
                return sides.seek(sought, Standing { body, bonds, tolerance: *tolerance }, displacement);
            };
            let plate = Standing { body: &part.part.body, bonds: &part.bonds, tolerance: *tolerance };
            let iterations = sides.seek(sought, plate, &mut part.displacement)?;
            part.unfold(body, sides.window().filter(|_| !sides.is_whole()), &part.displacement, displacement);
            part.follow_window(body, sides.window());
            Ok(iterations)
        })
    }

    /// The displacement everywhere for a picture, solved for to a residual of 1e-4 of the load where it is not known, and the
    /// iterations. What the run goes on with stays as it is, so that a run does not depend on its pictures.
    pub fn picture(&mut self, body: &Body, bonds: &Bonds) -> Result<(Vec<f64>, usize)> {
        let Equilibrium { part, sides, tolerance, .. } = self;
        in_pool(|| {
            let Some(part) = part else { return sides.picture(Standing { body, bonds, tolerance: *tolerance }) };
            let plate = Standing { body: &part.part.body, bonds: &part.bonds, tolerance: *tolerance };
            let ((of_part, iterations), mut picture) = (sides.picture(plate)?, Vec::new());
            part.unfold(body, None, &of_part, &mut picture);
            Ok((picture, iterations))
        })
    }

    /// Tells the solver which bonds were cut, or got another multiplier, since the last solve.
    pub fn bonds_changed(&mut self, body: &Body, bonds: &Bonds, changed: &[Bond]) {
        let Some(part) = &mut self.part else { return self.sides.broke(body, bonds, changed) };
        if let Some(of_part) = part.take_in(body, bonds, changed) {
            return self.sides.broke(part.body(), &part.bonds, &of_part);
        }
        tracing::info!("the crack is no longer symmetric: the whole plate is solved from here");
        (self.part, self.sides) = (None, balance(self.kind, body, bonds, self.load));
    }

    /// Puts these springs between flanks in contact, and forces between flanks under pressure, in place of those that were there, beside a
    /// share of the load; places are those of the body. Not to be asked of a solver that [`Equilibrium::reach`]ed: a condensed window knows no contact.
    pub fn set_contact(&mut self, body: &Body, share: f64, contact: &[GapSpring]) {
        let of_part = self.part.as_ref().map(|part| part.springs(body, contact));
        self.sides.set_contact(share, of_part.as_deref().unwrap_or(contact));
    }

    /// Whether this is a good moment to put a new one in its place, which knows nothing but the bonds: the window would have to be
    /// moved for the `watched` bonds anyway, or that many solves have passed that a new beginning hardly counts. It depends on what
    /// was solved since it was built, never on time.
    pub fn should_rebuild(&self, body: &Body, watched: &[Bond]) -> bool {
        match &self.part {
            Some(part) => self.sides.is_due(part.body(), &part.part.bonds(body, watched), self.solves),
            None => self.sides.is_due(body, watched, self.solves),
        }
    }

    /// Whether the displacement is right everywhere.
    pub fn is_whole(&self) -> bool {
        self.sides.is_whole()
    }

    /// Points, ascending, on which the displacement is right after every solve; `None` if that is all of them.
    pub fn window(&self) -> Option<&[u32]> {
        let window = self.sides.window();
        self.part.as_ref().map_or(window, |part| window.map(|_| &*part.window))
    }

    /// Work of the loads over the last displacement, f·u, J: twice the strain energy.
    pub fn work(&self) -> f64 {
        self.sides.work()
    }
}
