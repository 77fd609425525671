//! Both sides of K u = f for a body: load, held components, grips, and the solver that keeps them equal.

use super::field::{self, Layout};
use super::product::{Into, Product};
use super::spring::GapSpring;
use super::system::{SolverKind, SolverUsed, Sought, Standing, System};
use super::ties::Ties;
use super::window::Solver;
use crate::body::{Body, Bond};
use crate::state::Bonds;
use perilife_base::error::Result;

/// Load, supports and solver of a body, the number of its unknowns hidden.
pub(super) trait Sides: Send {
    fn seek(&mut self, sought: Sought<'_>, plate: Standing<'_>, displacement: &mut Vec<f64>) -> Result<usize>;
    fn broke(&mut self, body: &Body, bonds: &Bonds, broken: &[Bond]);
    fn set_contact(&mut self, share: f64, contact: &[GapSpring]);
    fn picture(&mut self, plate: Standing<'_>) -> Result<(Vec<f64>, usize)>;
    fn work(&self) -> f64;
    fn is_due(&self, body: &Body, watched: &[Bond], solves: usize) -> bool;
    fn is_whole(&self) -> bool;
    fn window(&self) -> Option<&[u32]>;
    fn used(&self) -> SolverUsed;
}

/// Load, held components and solver of a body with N unknowns a point.
struct ConstrainedSystem<const N: usize> {
    product: Product<N>,
    solver: Solver<N>,
    f: Vec<f64>,
    /// The load without pressure on flanks, where there is some.
    without_pressure: Option<Vec<f64>>,
    grips: Option<Grips>,
    u: Vec<f64>,
    work: f64,
}

/// Prescribed field of clamped grips.
struct Grips {
    /// Relative motion of the grips, held components only: clamped ends by two spacings, or sides that are moved straight by one.
    field: Vec<f64>,
    /// That motion, m.
    way: f64,
    /// Force that the grips must transmit, N.
    force: f64,
    /// Force on the free components that this motion brings, -K g.
    drag: Vec<f64>,
    /// Energy of the field with its free components, plus the work of the drag, J x 2: only a break near the grips changes it.
    constant: f64,
    /// What the field is multiplied with for the load.
    scale: f64,
}

/// Load, supports and linear solver of a body under `load` times its unit load; without a kind by factorisation.
pub(super) fn balance(kind: Option<SolverKind>, body: &Body, bonds: &Bonds, load: f64) -> Box<dyn Sides> {
    match body.stencil.unknowns {
        3 => Box::new(ConstrainedSystem::<3>::new(kind, body, bonds, load)),
        _ => Box::new(ConstrainedSystem::<2>::new(kind, body, bonds, load)),
    }
}

impl<const N: usize> ConstrainedSystem<N> {
    fn new(kind: Option<SolverKind>, body: &Body, bonds: &Bonds, load: f64) -> Self {
        let layout = Layout::of(&body.lattice, N);
        let mut fixed: Vec<usize> = Vec::new();
        for &(place, held) in &body.boundary.fixed {
            let at = layout.index(place as usize);
            fixed.extend((0..N).filter(|&c| held[c]).map(|c| at + c * layout.stride));
        }
        for &(place, _) in &body.boundary.clamped {
            let at = layout.index(place as usize);
            fixed.extend((0..N).map(|c| at + c * layout.stride));
        }
        fixed.sort_unstable();
        fixed.dedup();
        let ties = Ties::of(body, &layout, &fixed);
        fixed.extend(ties.slaves());
        fixed.sort_unstable();
        let mut f = layout.zeros();
        let is_tied = !body.boundary.ties.is_empty();
        let grips = (is_tied || !body.boundary.clamped.is_empty()).then(|| {
            let mut field = ties.held(&layout);
            let up = body.lattice.to_axes([0.0, 1.0]);
            for &(place, side) in &body.boundary.clamped {
                let at = layout.index(place as usize);
                field[at] = side * up[0] * body.lattice.spacing;
                field[at + layout.stride] = side * up[1] * body.lattice.spacing;
            }
            let way = if is_tied { body.lattice.spacing } else { 2.0 * body.lattice.spacing };
            Grips { field, way, force: load * body.boundary.through, drag: Vec::new(), constant: f64::NAN, scale: 1.0 }
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
        let mut product = Product::<N>::new(body, fixed);
        product.ties = ties;
        // Neither a window, which is condensed bond by bond, nor a factorization has held sums.
        let kind = if is_tied { Some(SolverKind::Multigrid) } else { kind };
        let solver = Solver::new(kind, body, bonds, &product);
        ConstrainedSystem { product, solver, f, without_pressure: None, grips, u: layout.zeros(), work: 0.0 }
    }

    /// The solver and the system it works on, with its unknown.
    fn parts<'a>(&'a mut self, plate: Standing<'a>) -> (&'a mut Solver<N>, System<'a, N>, &'a mut [f64]) {
        let f = self.grips.as_ref().map_or(&self.f, |grips| &grips.drag);
        let Standing { body, bonds, tolerance } = plate;
        (&mut self.solver, System { body, bonds, tolerance, product: &self.product, f }, &mut self.u)
    }

    /// Free components follow the grips: K u = -K g. The stiffness at clamped ends never changes, so -K g does not either.
    fn drag_grips(&mut self, bonds: &Bonds) {
        let Some(grips) = self.grips.as_mut().filter(|grips| grips.drag.is_empty()) else { return };
        grips.drag = self.product.layout().zeros();
        self.product.apply_to_field(bonds, &mut grips.field, &mut grips.drag, Into::Subtract);
    }

    /// The displacement under the load, from the solver's; the work is that of the whole plate.
    fn give(&mut self, body: &Body, bonds: &Bonds, work: f64, displacement: &mut Vec<f64>) {
        let copies = body.mirror.copies() as f64;
        let Some(grips) = &mut self.grips else {
            self.work = copies * work;
            // Between whole solves nothing moves outside the window.
            let places = self.window().filter(|_| !self.is_whole() && displacement.len() == self.u.len());
            let Some(places) = places else {
                displacement.clone_from(&self.u);
                return;
            };
            let layout = self.product.layout();
            for first in places.iter().map(|&place| layout.index(place as usize)) {
                (0..N).map(|c| first + c * layout.stride).for_each(|index| displacement[index] = self.u[index]);
            }
            return;
        };
        self.product.ties.spread(&mut self.u);
        displacement.clone_from(&grips.field);
        displacement.iter_mut().zip(&self.u).for_each(|(d, u)| *d += u);
        // (g + u)ᵀK(g + u) = gᵀKg - f·u with f = -Kg.
        if grips.constant.is_nan() {
            let mut free = Product::<N>::new(body, Vec::new());
            free.contact = self.product.contact.clone();
            let mut forces = self.product.layout().zeros();
            free.apply(bonds, displacement, &mut forces, Into::Set);
            grips.constant = field::dot(self.product.layout(), displacement, &forces) + work;
        }
        let energy = copies * (grips.constant - work);
        // Energy = force x relative displacement of the grips; the field is scaled to the load.
        let reaction = energy / grips.way;
        let scale = if reaction > 0.0 { grips.force / reaction } else { 0.0 };
        displacement.iter_mut().for_each(|d| *d *= scale);
        grips.scale = scale;
        self.work = energy * scale * scale;
    }
}

impl<const N: usize> Sides for ConstrainedSystem<N> {
    fn seek(&mut self, sought: Sought<'_>, plate: Standing<'_>, displacement: &mut Vec<f64>) -> Result<usize> {
        self.drag_grips(plate.bonds);
        let (solver, system, u) = self.parts(plate);
        let Some(solved) = solver.seek(sought, system, u)? else { return Ok(0) };
        self.give(plate.body, plate.bonds, solved.work, displacement);
        Ok(solved.iterations)
    }

    fn broke(&mut self, body: &Body, bonds: &Bonds, broken: &[Bond]) {
        self.solver.broke(body, broken);
        // A crack may run up to an edge that is moved straight.
        if let Some(grips) = self.grips.as_mut().filter(|grips| !body.boundary.ties.is_empty() && !grips.drag.is_empty()) {
            (grips.drag, grips.constant) = (Vec::new(), f64::NAN);
            self.drag_grips(bonds);
        }
    }

    fn set_contact(&mut self, share: f64, contact: &[GapSpring]) {
        debug_assert!(contact.is_empty() || self.solver.window().is_none(), "a condensed window does not support contact");
        if self.without_pressure.is_some() || share != 1.0 || contact.iter().any(|spring| spring.force != 0.0) {
            let without = self.without_pressure.get_or_insert_with(|| self.f.clone());
            self.f.iter_mut().zip(without).for_each(|(f, without)| *f = share * *without);
            let layout = self.product.layout();
            contact.iter().filter(|spring| spring.force != 0.0).for_each(|spring| spring.add(layout, spring.force, &mut self.f));
            self.product.fixed().iter().for_each(|&index| self.f[index] = 0.0);
        }
        self.product.contact = contact.iter().filter(|spring| spring.stiffness > 0.0).cloned().collect();
    }

    fn picture(&mut self, plate: Standing<'_>) -> Result<(Vec<f64>, usize)> {
        let (solver, system, u) = self.parts(plate);
        let (mut picture, iterations) = solver.picture(system, u)?;
        self.product.ties.spread(&mut picture);
        if let Some(Grips { field, scale, .. }) = &self.grips {
            picture.iter_mut().zip(field).for_each(|(u, g)| *u = scale * (g + *u));
        }
        Ok((picture, iterations))
    }

    fn work(&self) -> f64 {
        self.work
    }

    fn is_due(&self, body: &Body, watched: &[Bond], solves: usize) -> bool {
        self.solver.is_due(body, watched, solves)
    }

    fn is_whole(&self) -> bool {
        self.solver.is_whole()
    }

    fn window(&self) -> Option<&[u32]> {
        self.solver.window()
    }

    fn used(&self) -> SolverUsed {
        self.solver.used()
    }
}
