//! Equilibrium of a symmetric plate through the part of it that says everything ([`crate::body::mirror`]).
//!
//! Bonds break in mirror images of each other as long as the plate is symmetric. When they do not, the whole plate takes over.

use super::sides;
use super::spring::GapSpring;
use super::system::{EquilibriumBackend, Focus, SolverKind, SolverUsed};
use crate::body::mirror::{Mirror, MirrorPart, signs};
use crate::body::{Body, Bond};
use crate::solver::field::Layout;
use crate::state::Bonds;
use perilife_base::error::Result;

perilife_base::kinds! {
    /// Use of mirror symmetry.
    pub enum Symmetry for "model.symmetry" {
        Auto = "auto": "a symmetric plate (cracks and loads too) is solved on its half or quarter",
        Off = "off": "the whole plate is solved",
    }
}

/// The part of a plate and what it is solved by.
pub(super) struct Mirrored {
    part: MirrorPart,
    bonds: Bonds,
    inner: Box<dyn EquilibriumBackend>,
    displacement: Vec<f64>,
    /// The plate's points on which the displacement is always right.
    window: Option<Vec<u32>>,
    /// What the window is made of: the part's points.
    window_of_part: Vec<u32>,
    /// The unknowns of the window's points and what they are in the part.
    copies: Vec<Copied>,
    /// Whether bonds broke on one side only: then `inner` works on the whole plate.
    is_lost: bool,
    kind: Option<SolverKind>,
    load: f64,
    tolerance: Option<f64>,
}

/// An unknown of the plate that is, but for its sign, one of the part.
#[derive(Clone, Copy)]
struct Copied {
    from: u32,
    to: u32,
    sign: f64,
}

impl Mirrored {
    /// The part of a plate under `load` times its unit load; `None` where the plate is not symmetric.
    pub(super) fn new(kind: Option<SolverKind>, body: &Body, bonds: &Bonds, load: f64) -> Option<Self> {
        if !body.boundary.ties.is_empty() {
            // A held sum may reach across a line of symmetry.
            return None;
        }
        let part = MirrorPart::of(body, Mirror::of(body, &bonds.multiplier))?;
        let mut multiplier = part.multiplier(body, &bonds.multiplier);
        let scaled: Vec<Bond> = bonds.scaled(body).into_iter().map(|(bond, _)| bond).collect();
        for (name, of_part) in part.multipliers_of(body, &scaled, &bonds.multiplier) {
            multiplier[name as usize] = of_part;
        }
        let bonds = Bonds::with_multipliers(&part.body, multiplier);
        let inner = sides::balance(kind, &part.body, &bonds, load);
        let (displacement, window_of_part, copies) = (Vec::new(), Vec::new(), Vec::new());
        Some(Mirrored {
            part,
            bonds,
            inner,
            displacement,
            window: None,
            window_of_part,
            copies,
            is_lost: false,
            kind,
            load,
            tolerance: None,
        })
    }

    /// Gives the plate the displacement of its part: everywhere where that is right everywhere, else in the window.
    fn unfold(&mut self, whole: &Body, displacement: &mut Vec<f64>) {
        let part = &self.part;
        match self.inner.window() {
            None => (self.window, self.window_of_part) = (None, Vec::new()),
            Some(places) if self.window.is_some() && self.window_of_part == places => {}
            Some(places) => {
                let all = places.iter().flat_map(|&place| part.images(whole, place as usize));
                let mut window: Vec<u32> = all.map(|(place, _)| place as u32).collect();
                window.sort_unstable();
                window.dedup();
                self.window = Some(window);
                self.window_of_part = places.to_vec();
                self.copies.clear();
                for_copies(part, whole, places, |copied| self.copies.push(copied));
            }
        }
        displacement.resize(Layout::of(&whole.lattice, whole.stencil.unknowns).len(), 0.0);
        let source = &self.displacement;
        let mut copy = |Copied { from, to, sign }: Copied| displacement[to as usize] = sign * source[from as usize];
        if self.window.is_some() && !self.inner.is_whole() {
            self.copies.iter().for_each(|&copied| copy(copied));
        } else {
            for_copies(part, whole, &part.body.points, copy);
        }
    }
}

/// Calls `take` for every unknown of the plate that stands for one of these points of its part.
fn for_copies(part: &MirrorPart, whole: &Body, places: &[u32], mut take: impl FnMut(Copied)) {
    let unknowns = whole.stencil.unknowns;
    let (from, to) = (Layout::of(&part.body.lattice, unknowns), Layout::of(&whole.lattice, unknowns));
    for &place in places {
        let source = from.index(place as usize);
        for (image, flips) in part.images(whole, place as usize) {
            let target = to.index(image);
            for (c, sign) in signs(flips).into_iter().take(unknowns).enumerate() {
                let [from, to] = [source + c * from.stride, target + c * to.stride].map(|index| index as u32);
                take(Copied { from, to, sign });
            }
        }
    }
}

impl EquilibriumBackend for Mirrored {
    fn set_tolerance(&mut self, tolerance: f64) {
        self.tolerance = Some(tolerance);
        self.inner.set_tolerance(tolerance);
    }

    fn solve(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        if self.is_lost {
            return self.inner.solve(body, bonds, displacement);
        }
        let iterations = self.inner.solve(&self.part.body, &self.bonds, &mut self.displacement)?;
        self.unfold(body, displacement);
        Ok(iterations)
    }

    fn broke(&mut self, body: &Body, bonds: &Bonds, broken: &[Bond]) {
        let cut: Vec<Bond> = broken.iter().copied().filter(|&bond| !bonds.is_intact(bond)).collect();
        if !self.is_lost && !self.part.keeps(body, &cut) {
            tracing::info!("the crack is no longer symmetric: the whole plate is solved from here");
            self.is_lost = true;
            self.inner = sides::balance(self.kind, body, bonds, self.load);
            if let Some(tolerance) = self.tolerance {
                self.inner.set_tolerance(tolerance);
            }
            return;
        }
        if self.is_lost {
            return self.inner.broke(body, bonds, broken);
        }
        for (name, multiplier) in self.part.multipliers_of(body, broken, &bonds.multiplier) {
            self.bonds.set(&self.part.body, name, multiplier);
        }
        self.inner.broke(&self.part.body, &self.bonds, &self.part.bonds(body, broken));
    }

    fn work(&self) -> f64 {
        self.inner.work()
    }

    fn set_contact(&mut self, body: &Body, share_of_load: f64, contact: &[GapSpring]) {
        if self.is_lost {
            return self.inner.set_contact(body, share_of_load, contact);
        }
        // All springs of the plate on the displacements of its part, each with the share of the energy that the part has.
        let share = 1.0 / self.part.body.mirror.copies() as f64;
        let of_part = |spring: &GapSpring| GapSpring {
            weights: spring.weights.iter().map(|&(place, weights)| self.part.weights_of(body, place as usize, weights)).collect(),
            stiffness: share * spring.stiffness,
            force: share * spring.force,
        };
        self.inner.set_contact(&self.part.body, share_of_load, &contact.iter().map(of_part).collect::<Vec<_>>());
    }

    fn reach(&mut self, body: &Body, bonds: &Bonds, ahead: (&[Bond], &[Focus]), displacement: &mut Vec<f64>) -> Result<usize> {
        if self.is_lost {
            return self.inner.reach(body, bonds, ahead, displacement);
        }
        let watched = self.part.bonds(body, ahead.0);
        let was_whole = self.inner.is_whole();
        let iterations = self.inner.reach(&self.part.body, &self.bonds, (&watched, ahead.1), &mut self.displacement)?;
        let is_solved = iterations > 0 || was_whole != self.inner.is_whole();
        let has_moved = self.inner.window().unwrap_or_default() != self.window_of_part;
        if is_solved || has_moved || displacement.is_empty() {
            self.unfold(body, displacement);
        }
        Ok(iterations)
    }

    fn is_due(&self, body: &Body, watched: &[Bond], solves: usize) -> bool {
        if self.is_lost {
            return self.inner.is_due(body, watched, solves);
        }
        self.inner.is_due(&self.part.body, &self.part.bonds(body, watched), solves)
    }

    fn complete(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize> {
        if self.is_lost {
            return self.inner.complete(body, bonds, displacement);
        }
        if self.is_whole() {
            return Ok(0);
        }
        let iterations = self.inner.complete(&self.part.body, &self.bonds, &mut self.displacement)?;
        self.unfold(body, displacement);
        Ok(iterations)
    }

    fn picture(&mut self, body: &Body, bonds: &Bonds) -> Result<(Vec<f64>, usize)> {
        if self.is_lost {
            return self.inner.picture(body, bonds);
        }
        let (source, iterations) = self.inner.picture(&self.part.body, &self.bonds)?;
        let mut picture = Layout::of(&body.lattice, body.stencil.unknowns).zeros();
        let copy = |Copied { from, to, sign }: Copied| picture[to as usize] = sign * source[from as usize];
        for_copies(&self.part, body, &self.part.body.points, copy);
        Ok((picture, iterations))
    }

    fn is_whole(&self) -> bool {
        self.inner.is_whole()
    }

    fn window(&self) -> Option<&[u32]> {
        if self.is_lost { self.inner.window() } else { self.window.as_deref() }
    }

    fn points(&self, body: &Body) -> usize {
        if self.is_lost { body.points.len() } else { self.part.body.points.len() }
    }

    fn used(&self) -> SolverUsed {
        self.inner.used()
    }
}
