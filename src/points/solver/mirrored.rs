//! Equilibrium of a symmetric plate through the part of it that says everything ([`crate::body::mirror`]).
//!
//! Bonds break in mirror images of each other as long as the plate is symmetric. When they do not, the whole plate takes over.

use super::spring::GapSpring;
use crate::body::mirror::{Mirror, MirrorPart, signs};
use crate::body::{Body, Bond};
use crate::solver::field::Layout;
use crate::state::Bonds;

perilife_base::kinds! {
    /// Use of mirror symmetry.
    pub enum Symmetry for "model.symmetry" {
        Auto = "auto": "a symmetric plate (cracks and loads too) is solved on its half or quarter",
        Off = "off": "the whole plate is solved",
    }
}

/// The part of a plate with its bonds and displacement.
pub(super) struct SymmetricPart {
    pub part: MirrorPart,
    pub bonds: Bonds,
    pub displacement: Vec<f64>,
    /// The plate's points, ascending, that stand for those of the part's window, and these.
    pub window: Vec<u32>,
    window_of_part: Vec<u32>,
}

impl SymmetricPart {
    /// The part of a plate; `None` where that is not symmetric.
    pub fn of(body: &Body, bonds: &Bonds) -> Option<Self> {
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
        Some(SymmetricPart { part, bonds, displacement: Vec::new(), window: Vec::new(), window_of_part: Vec::new() })
    }

    pub fn body(&self) -> &Body {
        &self.part.body
    }

    /// Gives bonds of the plate that changed to the part, and their names there; `None` where they are not symmetric.
    pub fn take_in(&mut self, body: &Body, bonds: &Bonds, changed: &[Bond]) -> Option<Vec<Bond>> {
        let cut: Vec<Bond> = changed.iter().copied().filter(|&bond| !bonds.is_intact(bond)).collect();
        if !self.part.keeps(body, &cut) {
            return None;
        }
        for (name, multiplier) in self.part.multipliers_of(body, changed, &bonds.multiplier) {
            self.bonds.set(&self.part.body, name, multiplier);
        }
        Some(self.part.bonds(body, changed))
    }

    /// All springs of the plate on the displacements of its part, each with the share of the energy that the part has.
    pub fn springs(&self, body: &Body, contact: &[GapSpring]) -> Vec<GapSpring> {
        let share = 1.0 / self.part.body.mirror.copies() as f64;
        let of_part = |spring: &GapSpring| GapSpring {
            weights: spring.weights.iter().map(|&(place, weights)| self.part.weights_of(body, place as usize, weights)).collect(),
            stiffness: share * spring.stiffness,
            force: share * spring.force,
        };
        contact.iter().map(of_part).collect()
    }

    /// Gives the plate a field of its part: at some places of that, or at all that it stands for.
    pub fn unfold(&self, whole: &Body, places: Option<&[u32]>, source: &[f64], target: &mut Vec<f64>) {
        let unknowns = whole.stencil.unknowns;
        let (from, to) = (Layout::of(&self.part.body.lattice, unknowns), Layout::of(&whole.lattice, unknowns));
        target.resize(to.len(), 0.0);
        let mut copy = |place: usize, columns: usize| {
            let here = from.index(place);
            for (image, flips) in self.part.images(whole, place) {
                let there = to.index(image);
                for (c, sign) in signs(flips).into_iter().take(unknowns).enumerate() {
                    let (source, there) = (source[here + c * from.stride..][..columns].iter(), there + c * to.stride);
                    if flips[0] {
                        target[there + 1 - columns..=there].iter_mut().rev().zip(source).for_each(|(t, s)| *t = sign * s);
                    } else {
                        target[there..there + columns].iter_mut().zip(source).for_each(|(t, s)| *t = sign * s);
                    }
                }
            }
        };
        let lattice = &self.part.body.lattice;
        match places {
            Some(places) => places.iter().for_each(|&place| copy(place as usize, 1)),
            None => (0..lattice.rows).for_each(|row| copy(lattice.place(0, row), lattice.columns)),
        }
    }

    /// Takes over a window of the part.
    pub fn follow_window(&mut self, whole: &Body, window: Option<&[u32]>) {
        let Some(places) = window.filter(|places| *places != self.window_of_part) else { return };
        let images = |&place: &u32| self.part.images(whole, place as usize).map(|(image, _)| image as u32);
        self.window = places.iter().flat_map(images).collect();
        self.window.sort_unstable();
        self.window.dedup();
        self.window_of_part = places.to_vec();
    }
}
