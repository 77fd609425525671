//! A plate of several levels whose cracks stay on the finest: the body of the finest points, and everything beside it.
//!
//! Bonds break between finest points only. These make up a [`Body`] on their lattice, which knows of the rest as what it is
//! tied to ([`CoarseNeighbours`]); loads, supports and stiffness of the whole plate are those of its [`Net`]. Points of the body are named by
//! their place there, all others by the numbers that follow behind the last place.

use super::dual_horizon::{self, MultiLevelMesh, MultiLevelSpec};
use super::equilibrium::FullLoad;
use super::{Net, NetBond};
use crate::body::beyond::CoarseNeighbours;
use crate::body::boundary::{Boundary, GRIP_STIFFNESS};
use crate::body::lattice::Lattice;
use crate::body::surface_correction::{interior_gain, settled};
use crate::body::{Body, Bond, pre_crack};
use crate::bond_law::SurfaceCorrection;
use crate::bond_law::stencil::{plane_stiffness, spring_material};
use crate::error::{Error, Result, input_missing};
use crate::specimen::geometry::{bounding_box, distance_to_segment};
use crate::specimen::{Point, Specimen, Support};

/// Distance of a tip from the ends of its fatigue bonds to the rim of the finest level, in horizons, from which its growth is that
/// on fine points everywhere. On a panel refined around its crack (1 to 2 mm, horizon 3 mm, region 15 mm wide) the cycles of every
/// millimetre were 0.7 to 0.8 % too many up to 1.5 horizons from the rim, and 7 % too many in the next one.
const CLEAR_HORIZONS: f64 = 1.0;

/// Least distance of a tip from the rim of the finest level, m, in a body of this horizon (m) where bonds age within so many
/// horizons of a tip.
pub fn clear_way(horizon: f64, zone_radius_horizons: f64) -> f64 {
    (CLEAR_HORIZONS + 0.5 + zone_radius_horizons) * horizon
}

/// What has no number.
const NONE: u32 = u32::MAX;

/// The whole plate beside the body of its finest points.
#[derive(Debug, Clone)]
pub struct MultiLevelBody {
    /// Points and bonds of all levels.
    pub net: Net,
    /// Loads at unit nominal load, and supports. Clamped grips move one finest spacing, up or down.
    pub full: FullLoad,
    /// Force that clamped grips transmit at unit nominal load, N; `None` without them.
    pub grip_force: Option<f64>,
    /// Number of every point of the net: its place in the body, or one behind the last place.
    pub ids: Vec<u32>,
    /// Point of the net for every such number.
    points: Vec<u32>,
    /// Bonds of the body, ascending, with the bond of the net.
    bonds: Vec<(Bond, u32)>,
    lattice: Lattice,
    /// Finest spacing over the length that scales rotations in the net.
    turn: f64,
}

impl MultiLevelBody {
    /// Builds a plate of several levels, and the body of its finest points.
    ///
    /// # Errors
    /// Wrong input, choices that do not go together.
    pub fn build(ask: &MultiLevelSpec<'_>) -> Result<(Body, MultiLevelBody)> {
        let MultiLevelMesh { mut net, levels, mut stencils, loaded } = dual_horizon::build(ask)?;
        let level = levels.lattices.len() - 1;
        let padding = ask.horizon_ratio.floor() as usize;
        let lattice = levels.finest().padded(padding);
        let mut stencil = stencils.swap_remove(level);
        let places = lattice.places();
        if places.saturating_mul(stencil.bonds.len()) > u32::MAX as usize {
            return Err(Error::Mechanics(format!(
                "{places} places of the finest level with {} bonds each are more than the program can number; give fewer levels",
                stencil.bonds.len()
            )));
        }
        if ask.law.surface_correction == SurfaceCorrection::VolumeAndSurface {
            let c11 = plane_stiffness(&spring_material(ask.law, ask.material))[0];
            let volume = lattice.spacing * lattice.spacing * ask.specimen.thickness;
            let gain = interior_gain(&stencil, c11, volume);
            stencil.bonds.iter_mut().for_each(|bond| (bond.k_n, bond.k_t) = (gain * bond.k_n, gain * bond.k_t));
        }
        let (ids, points) = numbered(&levels, level, &lattice);
        let is_finest = |point: u32| (ids[point as usize] as usize) < places;
        let held = Holds::of(ask.specimen, &net, &lattice, &loaded);
        held.stiffen_grips(&mut net);
        let mut body = Body {
            steps: stencil.bonds.iter().map(|bond| lattice.step(bond.dx, bond.dy)).collect(),
            points: points[..places].iter().enumerate().filter(|(_, point)| **point != NONE).map(|(p, _)| p as u32).collect(),
            is_point: points[..places].iter().map(|&point| point != NONE).collect(),
            multiplier: vec![0.0; places * stencil.bonds.len()],
            pre_cut: Vec::new(),
            no_fail: Vec::new(),
            boundary: held.of_body(&net, &ids, places, &lattice),
            bond_count: 0,
            thickness: ask.specimen.thickness,
            mirror: crate::body::mirror::Mirror::default(),
            beyond: CoarseNeighbours::default(),
            lattice,
            stencil,
        };
        let mut bonds = Vec::new();
        for (b, bond) in net.bonds[..net.mutual].iter_mut().enumerate() {
            if !is_finest(bond.from) || !is_finest(bond.to) {
                continue;
            }
            let [from, to] = [bond.from, bond.to].map(|end| ids[end as usize] as isize);
            // Bonds within a level are those of its stencil.
            let Some(k) = body.steps.iter().position(|&step| step == to - from) else { continue };
            let named = k * places + from as usize;
            let spring = &body.stencil.bonds[k];
            let multiplier = settled(bond.k_n / spring.k_n);
            // The window takes springs out of the body, the whole plate out of the net: they must be the same ones.
            (bond.k_n, bond.k_t) = (f64::from(multiplier) * spring.k_n, f64::from(multiplier) * spring.k_t);
            body.multiplier[named] = multiplier;
            bonds.push((named as Bond, b as u32));
        }
        bonds.sort_unstable();
        body.bond_count = bonds.len();
        body.beyond = beyond(&net, &ids, places, &held.full);
        body.no_fail = body.boundary.no_fail(&body.lattice, body.horizon());
        for place in 0..places {
            body.no_fail[place] |= body.beyond.is_rim(place);
        }
        body.pre_cut = pre_crack::bonds_cut_by(&body, ask.specimen);
        let turn = body.lattice.spacing / net.rotation_length;
        let levelled = MultiLevelBody {
            full: held.full,
            grip_force: held.grip_force,
            lattice: body.lattice.clone(),
            net,
            ids,
            points,
            bonds,
            turn,
        };
        levelled.check_tips(&body, ask.specimen)?;
        Ok((body, levelled))
    }

    /// Point of the net behind a number, if it is one.
    pub fn point(&self, id: usize) -> Option<usize> {
        self.points.get(id).filter(|&&point| point != NONE).map(|&point| point as usize)
    }

    /// Numbers of points lie below this.
    pub fn numbers(&self) -> usize {
        self.points.len()
    }

    /// Bonds of the body, ascending, with the bond of the net each is.
    pub fn bonds(&self) -> &[(Bond, u32)] {
        &self.bonds
    }

    /// The bond of the net that a bond of the body is.
    pub fn bond(&self, bond: Bond) -> Option<usize> {
        self.bonds.binary_search_by_key(&bond, |known| known.0).ok().map(|at| self.bonds[at].1 as usize)
    }

    /// Unknowns of a point as the body has them (axes of the lattice, rotation times finest spacing) from those of the net.
    pub fn to_body(&self, u: [f64; 3]) -> [f64; 3] {
        let [x, y] = self.lattice.to_axes([u[0], u[1]]);
        [x, y, self.turn * u[2]]
    }

    /// The inverse of [`MultiLevelBody::to_body`].
    pub fn to_net(&self, u: [f64; 3]) -> [f64; 3] {
        let [x, y] = self.lattice.from_axes([u[0], u[1]]);
        [x, y, u[2] / self.turn]
    }

    /// Every crack starts inside the finest level.
    fn check_tips(&self, body: &Body, specimen: &Specimen) -> Result<()> {
        // Bonds age half a horizon around a tip at the least.
        let clear = clear_way(body.horizon(), 0.5);
        let near = |at: Point| body.is_near_rim(at, clear);
        let Some(tip) = specimen.tips.iter().find(|tip| near(tip.position)) else { return Ok(()) };
        let problem = format!(
            "do not hold the crack tip at {} with two horizons and the rim of the finest level ({:.4} mm in all) around it: cracks \
             grow on the finest level only",
            words(tip.position),
            1e3 * (clear + 2.0 * body.horizon())
        );
        Err(input_missing("refinement.regions", problem, "give a region around the tip and its way, as fine as the finest one"))
    }
}

/// A place in words.
pub fn words(at: Point) -> String {
    format!("({:.3}, {:.3}) mm", 1e3 * at[0], 1e3 * at[1])
}

/// Numbers of all points, and the point of every number.
fn numbered(levels: &dual_horizon::levels::Levels, finest: usize, lattice: &Lattice) -> (Vec<u32>, Vec<u32>) {
    let mut points = vec![NONE; lattice.places()];
    let mut ids = Vec::with_capacity(levels.leaves.len());
    for (i, leaf) in levels.leaves.iter().enumerate() {
        if leaf.level == finest {
            let place = lattice.place(leaf.column, leaf.row);
            points[place] = i as u32;
            ids.push(place as u32);
        } else {
            ids.push(points.len() as u32);
            points.push(i as u32);
        }
    }
    (ids, points)
}

/// What holds and pushes the plate.
struct Holds {
    full: FullLoad,
    grip_force: Option<f64>,
    /// Points of rigid grips that may turn, and which of the two.
    rigid: Vec<(u32, i8)>,
    /// Points at whose rim loads act.
    loaded: Vec<u32>,
    floating: bool,
}

impl Holds {
    /// Loads and supports of a specimen at unit nominal load.
    fn of(specimen: &Specimen, net: &Net, lattice: &Lattice, loaded: &[u32]) -> Holds {
        let mut full = FullLoad::none(net);
        let (mut grip_force, mut rigid, mut floating) = (None, Vec::new(), true);
        for &(point, force) in &net.forces {
            for (component, force) in force.into_iter().enumerate() {
                full.external[point as usize * net.unknowns + component] += force;
            }
        }
        for support in &specimen.supports {
            match *support {
                Support::Fixed { from, to, depth, x, y } => {
                    floating = false;
                    // As on a lattice: one along both axes where these are not those of the plate.
                    let components = if lattice.axis[1] == 0.0 { [x, y] } else { [x || y; 2] };
                    for point in net.within(depth, |&at| distance_to_segment(at, from, to)) {
                        let held = &mut full.held[point * net.unknowns..][..2];
                        held.iter_mut().zip(components).for_each(|(held, component)| *held |= component);
                    }
                }
                Support::ClampedEnds => {
                    floating = false;
                    grip_force = Some(force_through(net));
                    for (point, side) in end_blocks(specimen, net) {
                        let at = point as usize * net.unknowns;
                        full.held[at..at + net.unknowns].fill(true);
                        full.motion[at + 1] = f64::from(side) * lattice.spacing;
                    }
                }
                Support::Elsewhere => floating = false,
                Support::RigidEnds => rigid = end_blocks(specimen, net).collect(),
            }
        }
        if grip_force.is_some() {
            full.external.fill(0.0);
        }
        full.external.iter_mut().zip(&full.held).filter(|(_, held)| **held).for_each(|(force, _)| *force = 0.0);
        full.pin(net);
        Holds { full, grip_force, rigid, loaded: loaded.to_vec(), floating }
    }

    /// Makes the bonds inside rigid grips much stiffer than the plate.
    fn stiffen_grips(&self, net: &mut Net) {
        let mut grip = vec![0_i8; net.len()];
        self.rigid.iter().for_each(|&(point, side)| grip[point as usize] = side);
        for bond in &mut net.bonds {
            let [a, b] = [bond.from, bond.to].map(|end| grip[end as usize]);
            if a != 0 && a == b {
                let stiff = f64::from(GRIP_STIFFNESS);
                (bond.k_n, bond.k_t) = (stiff * bond.k_n, stiff * bond.k_t);
            }
        }
    }

    /// The part of it that acts on the points of the body.
    fn of_body(&self, net: &Net, ids: &[u32], places: usize, lattice: &Lattice) -> Boundary {
        let place = |point: u32| Some(ids[point as usize]).filter(|&id| (id as usize) < places);
        let mut forces: Vec<_> =
            net.forces.iter().filter_map(|&(point, force)| Some((place(point)?, lattice.to_axes(force)))).collect();
        forces.sort_unstable_by_key(|force| force.0);
        let is_pin = |at: &usize| self.full.pins.contains(at);
        let held = |point: usize| {
            let mut held = [false; 3];
            for (c, held) in held.iter_mut().enumerate().take(net.unknowns) {
                let at = point * net.unknowns + c;
                *held = self.full.held[at] && !is_pin(&at);
            }
            held
        };
        let all = (0..net.len()).filter_map(|point| Some((place(point as u32)?, held(point))));
        let mut fixed: Vec<_> = all.filter(|(_, held)| *held != [false; 3]).collect();
        fixed.sort_unstable_by_key(|fixed| fixed.0);
        let sorted = |points: &mut dyn Iterator<Item = u32>| {
            let mut places: Vec<u32> = points.filter_map(place).collect();
            places.sort_unstable();
            places
        };
        let loaded = sorted(&mut self.loaded.iter().copied());
        let rigid = sorted(&mut self.rigid.iter().map(|grip| grip.0));
        Boundary::of_finest(forces, loaded, fixed, rigid, self.floating)
    }
}

/// Force that the loads carry from end to end along y, N.
fn force_through(net: &Net) -> f64 {
    0.5 * net.forces.iter().map(|(_, force)| force[1].abs()).sum::<f64>()
}

/// Points within their own horizon of the lower (-1) and upper (+1) end of the specimen.
fn end_blocks<'a>(specimen: &Specimen, net: &'a Net) -> impl Iterator<Item = (u32, i8)> + 'a {
    let [low, high] = bounding_box(&specimen.outline);
    net.positions.iter().zip(&net.horizons).enumerate().filter_map(move |(point, (at, horizon))| {
        if at[1] < low[1] + horizon {
            Some((point as u32, -1))
        } else if at[1] > high[1] - horizon {
            Some((point as u32, 1))
        } else {
            None
        }
    })
}

/// The pieces of coarser points, and what of the body is tied to them.
fn beyond(net: &Net, ids: &[u32], places: usize, full: &FullLoad) -> CoarseNeighbours {
    let is_finest = |point: u32| (ids[point as usize] as usize) < places;
    let mut cut = vec![false; net.bonds.len()];
    net.pre_cut.iter().for_each(|&bond| cut[bond as usize] = true);
    let mut piece_of = vec![NONE; net.len()];
    let mut loaded = Vec::new();
    let is_pin = |at: &usize| full.pins.contains(at);
    for first in (0..net.len()).filter(|&point| !is_finest(point as u32)) {
        if piece_of[first] != NONE {
            continue;
        }
        let piece = loaded.len() as u32;
        loaded.push(false);
        piece_of[first] = piece;
        let mut front = vec![first];
        while let Some(point) = front.pop() {
            let unknowns = point * net.unknowns..(point + 1) * net.unknowns;
            loaded[piece as usize] |= unknowns.into_iter().any(|at| full.external[at] != 0.0 || full.held[at] && !is_pin(&at));
            for (bond, other, _) in net.bonds_of(point) {
                if !cut[bond] && !is_finest(other as u32) && piece_of[other] == NONE {
                    piece_of[other] = piece;
                    front.push(other);
                }
            }
        }
    }
    let across = net.bonds.iter().zip(&cut).filter(|(_, cut)| !**cut).filter_map(|(bond, _): (&NetBond, _)| {
        let (from, to) = (is_finest(bond.from), is_finest(bond.to));
        let (near, far) = if from { (bond.from, bond.to) } else { (bond.to, bond.from) };
        (from != to).then(|| (ids[near as usize], piece_of[far as usize]))
    });
    CoarseNeighbours::new(across.collect(), loaded)
}
