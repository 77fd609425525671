//! Equilibrium of the body at maximum load.

pub mod conjugate_gradient;
pub mod direct;
pub mod field;
pub mod multigrid;
pub mod product;

use crate::body::{Body, Bond};
use crate::error::Result;
use crate::state::Bonds;
use conjugate_gradient::MultigridSolver;
use direct::DirectSolver;
use field::Layout;
use product::{Into, Product};

crate::kinds! {
    /// Equilibrium solvers.
    pub enum SolverKind for "model.solver" {
        Multigrid = "multigrid": "conjugate gradients on a matrix-free stencil, preconditioned by crack-aware lattice multigrid",
        Direct = "direct": "sparse Cholesky factorisation, the reference",
    }
}

/// Solves `K u = f` on the free components of a body; what a new solver has to supply.
trait LinearSolver<const N: usize>: Send {
    /// Improves `u` until K u = f; returns the iterations spent (0 for a direct solver). Held components of f and u are zero.
    fn solve(&mut self, body: &Body, bonds: &Bonds, product: &Product<N>, f: &[f64], u: &mut [f64]) -> Result<usize>;
    /// Told which bonds broke since the last solve.
    fn broke(&mut self, body: &Body, bonds: &Bonds, product: &Product<N>, broken: &[Bond]);
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
    /// `displacement` receives the whole field in the layout of [`Layout::of`].
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
}

struct Grips {
    field: Vec<f64>,
    /// Force that the grips must transmit, N.
    force: f64,
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
            Grips { field, force: load * body.boundary.force_through() }
        });
        if grips.is_none() {
            for &(place, force) in &body.boundary.forces {
                let at = layout.index(place as usize);
                f[at] = load * force[0];
                f[at + layout.stride] = load * force[1];
            }
            for &index in &fixed {
                f[index] = 0.0;
            }
        }
        let product = Product::<N>::new(body, fixed);
        let solver: Box<dyn LinearSolver<N>> = match kind {
            SolverKind::Multigrid => Box::new(MultigridSolver::new(body, bonds, &product)),
            SolverKind::Direct => Box::new(DirectSolver::default()),
        };
        Sides { product, solver, f, grips, u: layout.zeros(), work: 0.0 }
    }
}

impl<const N: usize> Balance for Sides<N> {
    fn solve(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        let Some(grips) = &self.grips else {
            let iterations = self.solver.solve(body, bonds, &self.product, &self.f, &mut self.u)?;
            displacement.clone_from(&self.u);
            self.work = field::dot(self.product.layout(), &self.f, &self.u);
            return Ok(iterations);
        };
        // Free components follow the grips: K u = -K g; then the whole field is scaled to the force asked for.
        let mut f = self.product.layout().zeros();
        self.product.apply(bonds, &grips.field, &mut f, Into::Subtract);
        let iterations = self.solver.solve(body, bonds, &self.product, &f, &mut self.u)?;
        displacement.clone_from(&grips.field);
        displacement.iter_mut().zip(&self.u).for_each(|(d, u)| *d += u);
        // Energy of the field = ½ force x relative displacement of the grips (2 spacings in this scaling).
        let free = Product::<N>::new(body, Vec::new());
        let mut forces = self.product.layout().zeros();
        free.apply(bonds, displacement, &mut forces, Into::Set);
        let energy = field::dot(self.product.layout(), displacement, &forces);
        let opening = 2.0 * body.lattice.spacing;
        let reaction = energy / opening;
        let scale = if reaction > 0.0 { grips.force / reaction } else { 0.0 };
        displacement.iter_mut().for_each(|d| *d *= scale);
        self.work = energy * scale * scale;
        Ok(iterations)
    }

    fn broke(&mut self, body: &Body, bonds: &Bonds, broken: &[Bond]) {
        self.solver.broke(body, bonds, &self.product, broken);
    }

    fn work(&self) -> f64 {
        self.work
    }
}
