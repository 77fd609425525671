//! Response of the plate near its crack tips to breaks, while the plate beyond a rim keeps still.
//!
//! A break moves points as a force dipole does: the displacement falls with the distance r like 1/r, and what the rim at r = R
//! would add near the tip is a share of the order of the growth over R. So a part of the plate around the tips, held at its rim,
//! shows within a millisecond how strains change there while a few bonds break; a solve of the whole plate then brings the rim
//! where it belongs. The part is condensed as the window is, with everything beyond the rim as ground.

use super::condense::condense;
use super::{UNKNOWNS_MAX, Window, hold, points_around, width};
use crate::body::pre_crack::places_near;
use crate::body::{Body, Bond};
use crate::solver::assembly::{MIXED, Mixed, Springs, Within};
use crate::solver::{Focus, System};
use crate::specimen::geometry::distance;

/// Distance of the rim from the way of a tip, in horizons.
const RIM_HORIZONS: f64 = 6.0;
/// Way ahead of a tip that a new part covers, in horizons.
const AHEAD_HORIZONS: f64 = 3.0;
/// Way ahead of a tip that has to be covered when breaks begin, in horizons.
const LEAST_HORIZONS: f64 = 1.5;

/// The part of the plate around the tips, and what broke in it since the last solve.
#[derive(Default)]
pub(in crate::solver) struct HeldRim {
    window: Option<Window>,
    broken: Vec<Bond>,
    /// Work of the loads at the last solve.
    work: f64,
}

impl HeldRim {
    /// Gets ready for breaks around the tips of a plate in equilibrium.
    pub(in crate::solver) fn follow<const N: usize>(
        &mut self,
        system: System<'_, N>,
        u: &[f64],
        watched: &[Bond],
        tips: &[Focus],
    ) {
        let System { body, bonds, product, .. } = system;
        let watched = &near_tips(body, watched, tips);
        let least = points_around(body, bonds, tips, watched, LEAST_HORIZONS);
        let covers = |window: &Window| least.iter().all(|place| window.condensed.places.binary_search(place).is_ok());
        if self.window.as_ref().is_some_and(covers) {
            return;
        }
        self.window = None;
        let places = points_around(body, bonds, tips, watched, AHEAD_HORIZONS);
        if places.is_empty() || width(product) * places.len() > UNKNOWNS_MAX {
            return;
        }
        let beyond = beyond_rim(body, tips);
        if places.iter().any(|&place| beyond[place as usize]) {
            return;
        }
        let condensed = match product.dilatation() {
            None => condense::<N, _>(body, bonds, &Within { plate: Springs::new(product), beyond }, &places, &[]),
            Some(dilatation) => {
                let plate = Mixed::new(product, dilatation, bonds);
                condense::<MIXED, _>(body, bonds, &Within { plate, beyond }, &places, &[])
            }
        };
        self.window = condensed.map(|condensed| Window::new(condensed, system, u, self.work));
    }

    /// Told which bonds broke.
    pub(in crate::solver) fn broke(&mut self, broken: &[Bond]) {
        self.broken.extend(broken);
    }

    /// Moves the points around the tips to where the breaks since the last solve let them go; the work of the loads then.
    /// `None`, and nothing moved, where the part does not hold them, or is about to lose a piece.
    pub(in crate::solver) fn foresee<const N: usize>(&mut self, system: System<'_, N>, u: &mut [f64]) -> Option<f64> {
        self.take_in(system);
        self.window.as_ref().map(|window| window.move_points(system.product, u))
    }

    /// Starts anew from a plate in equilibrium, its loads having done `work`.
    pub(in crate::solver) fn renew<const N: usize>(&mut self, system: System<'_, N>, u: &[f64], work: f64) {
        self.take_in(system);
        self.work = work;
        if let Some(window) = &mut self.window {
            window.renew(system, u, work);
        }
    }

    /// Whether both ends of these bonds are followed, where they lie near a tip.
    pub(in crate::solver) fn holds(&self, body: &Body, watched: &[Bond], tips: &[Focus]) -> bool {
        self.places().is_some_and(|places| hold(body, places, &near_tips(body, watched, tips)))
    }

    /// Points that are followed, ascending.
    pub(in crate::solver) fn places(&self) -> Option<&[u32]> {
        self.window.as_ref().map(|window| &*window.condensed.places)
    }

    fn take_in<const N: usize>(&mut self, system: System<'_, N>) {
        let broken = std::mem::take(&mut self.broken);
        if self.window.as_mut().is_some_and(|window| !window.take_in(system.body, system.product, &broken)) {
            self.window = None;
        }
    }
}

/// The bonds that lie well within the rim. Bridges of the crack farther behind feel a break at the tip so little that their
/// strain at the last solve will do.
fn near_tips(body: &Body, watched: &[Bond], tips: &[Focus]) -> Vec<Bond> {
    let reach = (RIM_HORIZONS - 1.0) * body.horizon();
    let is_near = |bond: Bond| tips.iter().any(|tip| distance(tip.position, body.middle(bond)) < reach);
    watched.iter().copied().filter(|&bond| is_near(bond)).collect()
}

/// Whether a place lies beyond the rim.
fn beyond_rim(body: &Body, tips: &[Focus]) -> Vec<bool> {
    let mut beyond = vec![true; body.places()];
    for tip in tips {
        for (from, to) in tip.way(AHEAD_HORIZONS * body.horizon()) {
            places_near(body, from, to, RIM_HORIZONS * body.horizon()).for_each(|place| beyond[place] = false);
        }
    }
    beyond
}
