//! Equilibrium of the body at maximum load.

pub mod assembly;
pub mod conjugate_gradient;
pub mod dilatation;
pub mod direct;
pub mod field;
pub mod multigrid;
pub mod product;
mod rigid_motion;
pub mod window;

use crate::body::{Body, Bond};
use crate::error::Result;
use crate::specimen::Point;
use crate::state::Bonds;
use conjugate_gradient::{MultigridSolver, TOLERANCE};
use direct::DirectSolver;
use field::Layout;
use product::{Into, Product};
use window::WindowSolver;
use window::held_rim::HeldRim;

crate::kinds! {
    /// Equilibrium solvers.
    pub enum SolverKind for "model.solver" {
        Window = "window": "exact updates of the plate condensed onto the points around the crack tips; multigrid for whole solves",
        Multigrid = "multigrid": "conjugate gradients on a matrix-free stencil, preconditioned by crack-aware lattice multigrid",
        Direct = "direct": "sparse Cholesky factorisation, the reference",
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
    /// Distance from that way and its continuation within which the ends of ageing bonds lie, m.
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
    /// Makes `u` right at the ends of `watched` bonds, and gets ready for breaks around the tips; returns the iterations.
    fn reach(&mut self, _: System<'_, N>, _u: &mut [f64], _watched: &[Bond], _tips: &[Focus]) -> Result<usize> {
        Ok(0)
    }
    /// Makes `u` right everywhere; returns the iterations.
    fn complete(&mut self, _: System<'_, N>, _u: &mut [f64]) -> Result<usize> {
        Ok(0)
    }
    /// Whether `u` is right everywhere.
    fn is_whole(&self) -> bool {
        true
    }
    /// Points, ascending, on which `u` is always right; `None` if that is all of them.
    fn window(&self) -> Option<&[u32]> {
        None
    }
}

/// Keeps a body in equilibrium with its load while bonds break.
pub struct Equilibrium {
    inner: Box<dyn Balance>,
}

/// [`Sides`] with the number of unknowns hidden.
trait Balance: Send {
    fn solve(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize>;
    fn broke(&mut self, body: &Body, bonds: &Bonds, broken: &[Bond]);
    fn work(&self) -> f64;
    fn reach(
        &mut self,
        body: &Body,
        bonds: &Bonds,
        watched: &[Bond],
        tips: &[Focus],
        displacement: &mut Vec<f64>,
    ) -> Result<usize>;
    fn complete(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize>;
    fn get_ready_to_foresee(&mut self);
    fn foresee(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> bool;
    fn is_foreseen(&self) -> bool;
    fn is_whole(&self) -> bool;
    fn window(&self) -> Option<&[u32]>;
}

impl Equilibrium {
    /// Equilibrium of a body under `load` times its unit load (Pa or N, as the specimen measures load).
    #[must_use]
    pub fn new(kind: SolverKind, body: &Body, bonds: &Bonds, load: f64) -> Self {
        let inner: Box<dyn Balance> = match body.stencil.unknowns {
            3 => Box::new(Sides::<3>::new(kind, body, bonds, load)),
            _ => Box::new(Sides::<2>::new(kind, body, bonds, load)),
        };
        Equilibrium { inner }
    }

    /// Solves for the present bonds, starting from the last solution; returns the iterations.
    /// `displacement` receives the field in the layout of [`Layout::of`], right on the [`Equilibrium::window`].
    ///
    /// # Errors
    /// `Error::Mechanics` if the iteration does not converge.
    pub fn solve(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        self.inner.solve(body, bonds, displacement)
    }

    /// Tells the solver which bonds were cut since the last solve.
    pub fn broke(&mut self, body: &Body, bonds: &Bonds, broken: &[Bond]) {
        self.inner.broke(body, bonds, broken);
    }

    /// Makes the displacement right at the ends of `watched` bonds, and gets ready for breaks around the tips; returns the
    /// iterations.
    ///
    /// # Errors
    /// As [`Equilibrium::solve`].
    pub fn reach(
        &mut self,
        body: &Body,
        bonds: &Bonds,
        watched: &[Bond],
        tips: &[Focus],
        displacement: &mut Vec<f64>,
    ) -> Result<usize> {
        self.inner.reach(body, bonds, watched, tips, displacement)
    }

    /// Makes the displacement right everywhere; returns the iterations.
    ///
    /// # Errors
    /// As [`Equilibrium::solve`].
    pub fn complete(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        self.inner.complete(body, bonds, displacement)
    }

    /// Lets [`Equilibrium::foresee`] stand in for solves from now on, where a solve takes long: the window's solver needs no
    /// such help, its solves are as fast and exact.
    #[must_use]
    pub fn foreseeing(mut self) -> Self {
        self.inner.get_ready_to_foresee();
        self
    }

    /// Estimates the displacement around the tips after the breaks told since the last solve, on the points that
    /// [`Equilibrium::window`] then gives, with the plate farther away kept still; `false`, and nothing changed, where only a
    /// solve can tell.
    pub fn foresee(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> bool {
        self.inner.foresee(body, bonds, displacement)
    }

    /// Whether the displacement is such an estimate, not yet solved for.
    #[must_use]
    pub fn is_foreseen(&self) -> bool {
        self.inner.is_foreseen()
    }

    /// Whether the displacement is right everywhere.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.inner.is_whole()
    }

    /// Points, ascending, on which the displacement is right after every solve; `None` if that is all of them.
    #[must_use]
    pub fn window(&self) -> Option<&[u32]> {
        self.inner.window()
    }

    /// Work of the loads over the last displacement, f·u, J: twice the strain energy.
    #[must_use]
    pub fn work(&self) -> f64 {
        self.inner.work()
    }
}

/// Load, held components and the linear solver of a body with N unknowns a point.
struct Sides<const N: usize> {
    product: Product<N>,
    solver: Box<dyn LinearSolver<N>>,
    f: Vec<f64>,
    /// Prescribed field of clamped grips, per unit of half their relative displacement.
    grips: Option<Grips>,
    u: Vec<f64>,
    work: f64,
    /// Stands in for solves that take long.
    rim: Option<HeldRim>,
    /// Whether u is what it foresees.
    is_foreseen: bool,
    has_fast_solves: bool,
}

struct Grips {
    /// Relative motion of the grips, held components only.
    field: Vec<f64>,
    /// Force that the grips must transmit, N.
    force: f64,
    /// Force on the free components that this motion brings, -K g.
    drag: Vec<f64>,
    /// Energy of the field with its free components, plus the work of the drag, J x 2: no break away from the grips changes it.
    constant: f64,
}

impl<const N: usize> Sides<N> {
    fn new(kind: SolverKind, body: &Body, bonds: &Bonds, load: f64) -> Self {
        let layout = Layout::of(&body.lattice, N);
        let mut fixed: Vec<usize> = Vec::new();
        for &(place, held) in &body.boundary.fixed {
            let at = layout.index(place as usize);
            fixed.extend((0..2).filter(|&c| held[c]).map(|c| at + c * layout.stride));
        }
        for &(place, _) in &body.boundary.clamped {
            let at = layout.index(place as usize);
            fixed.extend((0..N).map(|c| at + c * layout.stride));
        }
        fixed.sort_unstable();
        fixed.dedup();
        let mut f = layout.zeros();
        let grips = (!body.boundary.clamped.is_empty()).then(|| {
            let mut field = layout.zeros();
            let up = body.lattice.to_axes([0.0, 1.0]);
            for &(place, side) in &body.boundary.clamped {
                let at = layout.index(place as usize);
                field[at] = side * up[0] * body.lattice.spacing;
                field[at + layout.stride] = side * up[1] * body.lattice.spacing;
            }
            Grips { field, force: load * body.boundary.force_through(), drag: Vec::new(), constant: f64::NAN }
        });
        if grips.is_none() {
            for &(place, force) in &body.boundary.forces {
                let at = layout.index(place as usize);
                f[at] = load * force[0];
                f[at + layout.stride] = load * force[1];
            }
            if N == 3 {
                for &(place, couple) in &body.boundary.couples {
                    f[layout.index(place as usize) + 2 * layout.stride] = load * couple;
                }
            }
            for &index in &fixed {
                f[index] = 0.0;
            }
        }
        let product = Product::<N>::new(body, fixed);
        let solver: Box<dyn LinearSolver<N>> = match kind {
            SolverKind::Window => Box::new(WindowSolver::new(body, bonds, &product)),
            SolverKind::Multigrid => Box::new(MultigridSolver::new(body, bonds, &product, TOLERANCE)),
            SolverKind::Direct => Box::new(DirectSolver::default()),
        };
        let has_fast_solves = kind == SolverKind::Window;
        Sides { product, solver, f, grips, u: layout.zeros(), work: 0.0, rim: None, is_foreseen: false, has_fast_solves }
    }
}

impl<const N: usize> Sides<N> {
    /// The solver and the system it works on, with its unknown, and what stands in for it.
    fn parts<'a>(
        &'a mut self,
        body: &'a Body,
        bonds: &'a Bonds,
    ) -> (&'a mut Box<dyn LinearSolver<N>>, System<'a, N>, &'a mut [f64], Option<&'a mut HeldRim>) {
        let f = self.grips.as_ref().map_or(&self.f, |grips| &grips.drag);
        (&mut self.solver, System { body, bonds, product: &self.product, f }, &mut self.u, self.rim.as_mut())
    }

    /// Free components follow the grips: K u = -K g. The stiffness at the grips never changes, so -K g does not either.
    fn drag_grips(&mut self, bonds: &Bonds) {
        let Some(grips) = self.grips.as_mut().filter(|grips| grips.drag.is_empty()) else { return };
        grips.drag = self.product.layout().zeros();
        self.product.apply(bonds, &grips.field, &mut grips.drag, Into::Subtract);
    }

    /// The displacement under the load, from the solver's.
    fn give(&mut self, body: &Body, bonds: &Bonds, work: f64, displacement: &mut Vec<f64>) {
        let Some(grips) = &mut self.grips else {
            displacement.clone_from(&self.u);
            self.work = work;
            return;
        };
        displacement.clone_from(&grips.field);
        displacement.iter_mut().zip(&self.u).for_each(|(d, u)| *d += u);
        // (g + u)ᵀK(g + u) = gᵀKg - f·u with f = -Kg.
        if grips.constant.is_nan() {
            let free = Product::<N>::new(body, Vec::new());
            let mut forces = self.product.layout().zeros();
            free.apply(bonds, displacement, &mut forces, Into::Set);
            grips.constant = field::dot(self.product.layout(), displacement, &forces) + work;
        }
        let energy = grips.constant - work;
        // Energy = force x relative displacement of the grips (2 spacings in this scaling); the field is scaled to the load.
        let reaction = energy / (2.0 * body.lattice.spacing);
        let scale = if reaction > 0.0 { grips.force / reaction } else { 0.0 };
        displacement.iter_mut().for_each(|d| *d *= scale);
        self.work = energy * scale * scale;
    }
}

impl<const N: usize> Balance for Sides<N> {
    fn solve(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        self.drag_grips(bonds);
        let (solver, system, u, rim) = self.parts(body, bonds);
        let solved = solver.solve(system, u)?;
        if let Some(rim) = rim {
            rim.renew(system, u, solved.work);
        }
        self.is_foreseen = false;
        self.give(body, bonds, solved.work, displacement);
        Ok(solved.iterations)
    }

    fn broke(&mut self, body: &Body, bonds: &Bonds, broken: &[Bond]) {
        self.solver.broke(body, bonds, &self.product, broken);
        if let Some(rim) = &mut self.rim {
            rim.broke(broken);
        }
    }

    fn get_ready_to_foresee(&mut self) {
        self.rim = (!self.has_fast_solves).then(HeldRim::default);
    }

    fn foresee(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> bool {
        let (_, system, u, rim) = self.parts(body, bonds);
        let Some(work) = rim.and_then(|rim| rim.foresee(system, u)) else { return false };
        self.is_foreseen = true;
        self.give(body, bonds, work, displacement);
        true
    }

    fn is_foreseen(&self) -> bool {
        self.is_foreseen
    }

    fn work(&self) -> f64 {
        self.work
    }

    fn reach(
        &mut self,
        body: &Body,
        bonds: &Bonds,
        watched: &[Bond],
        tips: &[Focus],
        displacement: &mut Vec<f64>,
    ) -> Result<usize> {
        let mut iterations = 0;
        if self.is_foreseen && !self.rim.as_ref().is_some_and(|rim| rim.holds(body, watched, tips)) {
            iterations += self.solve(body, bonds, displacement)?;
        }
        let is_foreseen = self.is_foreseen;
        let (solver, system, u, rim) = self.parts(body, bonds);
        if let Some(rim) = rim.filter(|_| !is_foreseen) {
            rim.follow(system, u, watched, tips);
        }
        let was_whole = solver.is_whole();
        iterations += solver.reach(system, u, watched, tips)?;
        if solver.is_whole() && !was_whole {
            let work = field::dot(system.product.layout(), system.f, u);
            self.give(body, bonds, work, displacement);
        }
        Ok(iterations)
    }

    fn complete(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        if self.is_foreseen {
            return self.solve(body, bonds, displacement);
        }
        let (solver, system, u, _) = self.parts(body, bonds);
        if solver.is_whole() {
            return Ok(0);
        }
        let iterations = solver.complete(system, u)?;
        let work = field::dot(system.product.layout(), system.f, u);
        self.give(body, bonds, work, displacement);
        Ok(iterations)
    }

    fn is_whole(&self) -> bool {
        !self.is_foreseen && self.solver.is_whole()
    }

    fn window(&self) -> Option<&[u32]> {
        self.rim.as_ref().and_then(HeldRim::places).or_else(|| self.solver.window())
    }
}
