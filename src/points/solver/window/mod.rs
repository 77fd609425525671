//! Equilibrium through a condensed window around the crack tips.
//!
//! Between two blocks only some bonds near the tips change. The plate is condensed onto the points around the tips
//! ([`mod@condense`]), and broken bonds are low-rank changes of the small dense inverse ([`update`]): exact, at a cost that does
//! not grow with the plate. Now and then, after a fixed number of breaks, the whole plate is solved, which refreshes the
//! displacement outside the window and keeps round-off from adding up. The window moves when a tip nears its end.

pub mod condense;
pub mod update;

use super::assembly::{MIXED, Mixed, Springs};
use super::conjugate_gradient::{MultigridSolver, is_mechanism};
use super::direct::{factorised, pinned_components};
use super::product::Product;
use super::spring::{End, Term};
use super::system::{Focus, Solved, SolverKind, SolverUsed, Sought, System};
use crate::body::mirror::signs;
use crate::body::pre_crack::places_near;
use crate::body::{Body, Bond};
use crate::state::Bonds;
use condense::{Condensed, condense};
use perilife_base::error::{Error, Result};
use perilife_base::watch::{self, Stage};
use update::Update;

/// Least length of the window ahead of a tip, in horizons.
const AHEAD_HORIZONS: f64 = 8.0;
/// Unknowns below which a window reaches twice as far: it then has to move half as often, at hardly any cost for a break.
const UNKNOWNS_SMALL: usize = 600;
/// Largest window, unknowns: its inverse then takes 72 MB.
const UNKNOWNS_MAX: usize = 3000;
/// Relative error of the work of the loads, found at a whole solve, from which a window is not used any more.
const DRIFT_MAX: f64 = 1e-7;
/// Springs after which the whole plate is solved.
const RANK_MAX: usize = 512;
/// Springs after which they are put into the inverse.
const RANK_FOLD: usize = 128;
/// Solves of the whole plate after which a solver begins anew. That takes three to four of them: a solve from rest, and where
/// there is one a new hierarchy.
const SOLVES_MOST: usize = 128;
/// Solves within the window before which its next move is no new beginning: bonds that come near the critical stretch may move it
/// after every break.
const UPDATES_LEAST: usize = 64;
/// Solves within the window after which all begins anew, though the window could stay: so many take seconds, a new beginning some
/// tenths of one on a plate of 50 000 points.
const UPDATES_MOST: usize = 4096;
/// Residual over load of a displacement for a picture.
const PICTURE_TOLERANCE: f64 = 1e-4;

/// Solves of the whole plate, where breaks are asked to come one by one a condensed window between them.
pub(in crate::solver) struct Solver<const N: usize> {
    /// Solves the whole plate; without it every solve is a factorisation.
    multigrid: Option<MultigridSolver<N>>,
    window: Option<Window>,
    had_window: bool,
    broken: Vec<Bond>,
    /// Whether the displacement is right everywhere, not in the window only.
    is_whole: bool,
    /// Whether no window is condensed: none is asked for, or condensing failed.
    is_off: bool,
    /// Work f·u at the last solve.
    work: f64,
    /// The last displacement for a picture since the last whole solve.
    picture: Option<Vec<f64>>,
}

/// A window with what broke since it was condensed.
struct Window {
    condensed: Condensed,
    /// Unknowns of its points at the last whole solve.
    base: Vec<f64>,
    /// Work f·u then.
    base_work: f64,
    update: Update,
    /// Springs taken in since the last whole solve.
    springs: usize,
}

impl<const N: usize> Solver<N> {
    /// Starts without a window.
    pub fn new(kind: Option<SolverKind>, body: &Body, bonds: &Bonds, product: &Product<N>) -> Self {
        Solver {
            multigrid: kind.map(|_| MultigridSolver::new(body, bonds, product)),
            window: None,
            had_window: false,
            broken: Vec::new(),
            is_whole: false,
            is_off: kind != Some(SolverKind::Window),
            work: 0.0,
            picture: None,
        }
    }

    /// Improves `u` until it is right for what is sought; what that took and gave if it took a solve.
    pub fn seek(&mut self, sought: Sought<'_>, system: System<'_, N>, u: &mut [f64]) -> Result<Option<Solved>> {
        match sought {
            Sought::Equilibrium => self.solve(system, u).map(Some),
            Sought::Everywhere if self.is_whole => Ok(None),
            Sought::Everywhere => self.solve_whole(system, u).map(Some),
            Sought::Ahead(watched, _)
                if self.window.as_ref().is_some_and(|window| hold(system.body, &window.condensed.places, watched)) =>
            {
                Ok(None)
            }
            Sought::Ahead(watched, tips) => {
                let solved = self.seek(Sought::Everywhere, system, u)?;
                self.window = self.condense(system, u, watched, tips);
                self.had_window |= self.window.is_some();
                Ok(solved)
            }
        }
    }

    /// By iteration or, where that does not manage or is not asked for, by factorisation: of a part that hangs on a few bonds and is nearly
    /// a mechanism iteration breaks down. A plate that loses its stiffness is beyond both, and held sums beyond factorisation.
    fn solve_to_tolerance(&mut self, system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
        let Some(multigrid) = &mut self.multigrid else { return factorised(system, u) };
        let (is_tied, before) = (system.product.ties.slaves().next().is_some(), self.work);
        match multigrid.solve(system, u) {
            Err(Error::Mechanics(_)) if !is_tied => {
                let solved = factorised(system, u)?;
                if is_mechanism(solved.work, before) { Err(Error::LossOfStiffness) } else { Ok(solved) }
            }
            solved => solved,
        }
    }

    /// Solves the whole plate; a window that is up to date takes its new base from it.
    fn solve_whole(&mut self, system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
        let solved = self.solve_to_tolerance(system, u)?;
        self.picture = None;
        // The work of the loads by the window's account against that by the whole system: the error of the window in energy.
        let drift = (self.work / solved.work - 1.0).abs();
        tracing::debug!(drift, "whole plate solved");
        if self.window.is_some() && drift > DRIFT_MAX {
            tracing::warn!(drift, "window no longer accurate: whole solves from here");
            (self.window, self.is_off) = (None, true);
        }
        self.is_whole = true;
        self.work = solved.work;
        if let Some(window) = &mut self.window {
            // It starts anew from a plate in equilibrium, all breaks taken in.
            window.update.fold(&mut window.condensed.inverse);
            window.base = unknowns(system, u, &window.condensed.places);
            window.base_work = solved.work;
            window.springs = 0;
        }
        Ok(solved)
    }

    /// Condenses the plate onto the points around the tips, if these are few enough and hold all watched bonds.
    fn condense(&mut self, system: System<'_, N>, u: &[f64], watched: &[Bond], tips: &[Focus]) -> Option<Window> {
        let System { body, bonds, product, .. } = system;
        let width = width(product);
        if self.is_off || watched.len() * width > UNKNOWNS_MAX {
            return None;
        }
        let mut ahead = AHEAD_HORIZONS;
        let mut places = points_around(body, bonds, tips, watched, ahead);
        if places.is_empty() || width * places.len() > UNKNOWNS_MAX {
            return None;
        }
        while width * places.len() < UNKNOWNS_SMALL {
            ahead *= 2.0;
            let farther = points_around(body, bonds, tips, watched, ahead);
            // Nothing is left ahead, or more than pays.
            if farther.len() == places.len() || width * farther.len() > 2 * UNKNOWNS_SMALL {
                break;
            }
            places = farther;
        }
        let pins = pins(body, bonds, &places, width);
        let condensed = match product.dilatation.as_ref() {
            None => condense::<N, _>(body, bonds, &Springs(product), &places, &pins),
            Some(dilatation) => condense::<MIXED, _>(body, bonds, &Mixed { product, dilatation, body, bonds }, &places, &pins),
        };
        let Some(condensed) = condensed else {
            self.is_off = true;
            return None;
        };
        tracing::debug!(points = places.len(), "window condensed");
        Some(Window::new(condensed, system, u, self.work))
    }

    fn solve(&mut self, system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
        // A block may have thousands of breaks, each a solve within the window.
        watch::at(Stage::Equilibrium, 1.0)?;
        let broken = std::mem::take(&mut self.broken);
        if let Some(window) = &mut self.window {
            if !window.take_in(system.body, system.product, &broken) {
                // A bond outside, or a part of the window on the point of coming loose.
                self.window = None;
            } else {
                self.is_whole = false;
                let (displacement, gain) = window.update.displacement(&window.condensed.inverse, &window.base);
                give(system.product, &window.condensed.places, &displacement, u);
                self.work = window.base_work + gain;
                if window.springs <= RANK_MAX {
                    if window.update.rank() > RANK_FOLD {
                        window.fold();
                    }
                    return Ok(Solved { iterations: 0, work: self.work });
                }
            }
        }
        self.solve_whole(system, u)
    }

    /// Told which bonds changed since the last solve.
    pub fn broke(&mut self, body: &Body, broken: &[Bond]) {
        if let Some(multigrid) = &mut self.multigrid {
            multigrid.broke(body, broken);
        }
        self.broken.extend(broken);
    }

    /// What has solved since it was built.
    pub fn used(&self) -> SolverUsed {
        match &self.multigrid {
            None => SolverUsed::Direct,
            Some(_) if self.had_window => SolverUsed::Window,
            Some(_) => SolverUsed::Multigrid,
        }
    }

    /// Whether to begin anew costs little now, `solves` solves after the last beginning.
    pub fn is_due(&self, body: &Body, watched: &[Bond], solves: usize) -> bool {
        let least = match &self.window {
            None => SOLVES_MOST,
            Some(window) if hold(body, &window.condensed.places, watched) => UPDATES_MOST,
            Some(_) => UPDATES_LEAST,
        };
        solves >= least
    }

    /// `u` everywhere, as right as pictures need it, and the iterations. Nothing else changes.
    pub fn picture(&mut self, system: System<'_, N>, u: &[f64]) -> Result<(Vec<f64>, usize)> {
        if self.is_whole {
            return Ok((u.to_vec(), 0));
        }
        let mut picture = self.picture.take().unwrap_or_else(|| u.to_vec());
        if let Some(window) = &self.window {
            let layout = system.product.layout();
            for first in window.condensed.places.iter().map(|&place| layout.index(place as usize)) {
                (0..N).map(|c| first + c * layout.stride).for_each(|index| picture[index] = u[index]);
            }
        }
        let solved = self.solve_to_tolerance(System { tolerance: PICTURE_TOLERANCE, ..system }, &mut picture)?;
        self.picture = Some(picture.clone());
        Ok((picture, solved.iterations))
    }

    /// Whether the displacement is right everywhere.
    pub fn is_whole(&self) -> bool {
        self.is_whole
    }

    /// Points, ascending, on which the displacement is always right; `None` if that is all of them.
    pub fn window(&self) -> Option<&[u32]> {
        self.window.as_ref().map(|window| &*window.condensed.places)
    }
}

impl Window {
    /// A window on a plate in equilibrium.
    fn new<const N: usize>(condensed: Condensed, system: System<'_, N>, u: &[f64], work: f64) -> Self {
        let base = unknowns(system, u, &condensed.places);
        Window { condensed, base, base_work: work, update: Update::default(), springs: 0 }
    }

    /// Puts all breaks into the inverse and starts from the displacement after them.
    fn fold(&mut self) {
        let (displacement, gain) = self.update.displacement(&self.condensed.inverse, &self.base);
        self.update.fold(&mut self.condensed.inverse);
        self.base = displacement;
        self.base_work += gain;
    }

    /// Takes in broken bonds; `false` if that cannot be done.
    fn take_in<const N: usize>(&mut self, body: &Body, product: &Product<N>, broken: &[Bond]) -> bool {
        let width = width(product);
        broken.iter().all(|&bond| {
            let (k, from, to) = body.ends(bond);
            let ends = [from, to].map(|end| self.end(body, end, width));
            let [Some(a), Some(b)] = ends else { return false };
            let share = f64::from(body.multiplier[bond as usize]);
            let mut terms: Vec<Term> = match product.dilatation.as_ref() {
                None => product.springs_of(k, share, [a, b]).into(),
                Some(dilatation) => dilatation.terms_of(k, share, [a, b]),
            };
            if a.place == b.place {
                // Half of a bond between a point and its own image belongs to the part.
                terms.iter_mut().flat_map(|term| &mut term.vector).for_each(|(_, value)| *value *= 0.5_f64.sqrt());
            }
            terms.retain(|term| !term.vector.is_empty());
            self.springs += terms.len();
            terms.into_iter().all(|term| self.update.add(&self.condensed.inverse, &self.base, term))
        })
    }

    /// The end of a bond in the window's vector, `width` unknowns a point.
    fn end(&self, body: &Body, place: usize, width: usize) -> Option<End> {
        let (place, flips) = body.behind(place);
        let at = self.condensed.places.binary_search(&(place as u32)).ok()?;
        let [x, y, turn] = signs(flips);
        // The stress of a state-based law has no direction.
        let third = if body.stencil.unknowns == 3 { turn } else { 1.0 };
        Some(End { place, first: width * at, signs: [x, y, third] })
    }
}

/// Whether both ends of all these bonds are among some points (ascending).
fn hold(body: &Body, places: &[u32], bonds: &[Bond]) -> bool {
    let has = |place: usize| places.binary_search(&(body.behind(place).0 as u32)).is_ok();
    bonds.iter().all(|&bond| {
        let (_, from, to) = body.ends(bond);
        has(from) && has(to)
    })
}

/// Unknowns of a window point: those of the body, and the stress of a state-based law.
fn width<const N: usize>(product: &Product<N>) -> usize {
    if product.dilatation.as_ref().is_some() { MIXED } else { N }
}

/// Unknowns of some points in the order of the window's vector, from a displacement that is right everywhere.
fn unknowns<const N: usize>(system: System<'_, N>, u: &[f64], places: &[u32]) -> Vec<f64> {
    let System { bonds, product, .. } = system;
    let layout = product.layout();
    let stress = product.dilatation.as_ref().map(|dilatation| dilatation.stress(bonds, u));
    let of_place = |place: usize| {
        let first = layout.index(place);
        (0..N).map(move |c| u[first + c * layout.stride]).chain(stress.as_ref().map(|stress| stress[place]))
    };
    places.iter().flat_map(|&place| of_place(place as usize)).collect()
}

/// Puts the window's displacement into that of the body.
fn give<const N: usize>(product: &Product<N>, places: &[u32], unknowns: &[f64], u: &mut [f64]) {
    let layout = product.layout();
    for (&place, values) in places.iter().zip(unknowns.chunks(width(product))) {
        let first = layout.index(place as usize);
        values[..N].iter().enumerate().for_each(|(c, value)| u[first + c * layout.stride] = *value);
    }
}

/// Indices in the window's vector, `width` unknowns a point, of the components that hold a floating plate at two distant window
/// points.
fn pins(body: &Body, bonds: &Bonds, places: &[u32], width: usize) -> Vec<usize> {
    let carrying = || (0..places.len()).filter(|&i| bonds.intact_at(body, places[i] as usize) > 3);
    let (Some(first), Some(last)) = (carrying().next(), carrying().next_back()) else { return Vec::new() };
    let pinned = pinned_components(body, places[first] as usize, places[last] as usize);
    let at = |place: usize| if place == places[first] as usize { first } else { last };
    pinned.into_iter().map(|(place, component)| width * at(place) + component).collect()
}

/// Points within reach of the way of a tip, a little behind it and some horizons straight ahead, and the ends of the watched
/// bonds.
fn points_around(body: &Body, bonds: &Bonds, tips: &[Focus], watched: &[Bond], ahead_horizons: f64) -> Vec<u32> {
    let mut found: Vec<u32> = Vec::new();
    for tip in tips {
        for (from, to) in tip.way(ahead_horizons * body.horizon()) {
            let near = places_near(body, from, to, tip.reach);
            found.extend(near.filter(|&p| bonds.intact_at(body, p) > 0).map(|place| place as u32));
        }
    }
    if !found.is_empty() {
        let ends = |bond: Bond| [body.ends(bond).1, body.ends(bond).2].map(|place| body.behind(place).0 as u32);
        found.extend(watched.iter().flat_map(|&bond| ends(bond)));
    }
    found.sort_unstable();
    found.dedup();
    found
}
