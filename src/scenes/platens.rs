//! Rigid plates without friction that press the body, driven by their displacement.
//!
//! A platen is a plane across its direction of motion that first touches the outline where that reaches farthest towards it.
//! It meets the outermost point of every row of points along its motion, once the rim in front of that point has come to the
//! plane: the gap is taken from the outline, not from the steps of the lattice, so that a disc is met little by little. A
//! point may leave the platen, never pass it but for the penetration of a stiff one-sided spring, which is reported.

use super::bonds::BondState;
use super::interaction::{Damaging, Driven, Interaction, Memory, Reaction};
use super::scene::{Action, LoadRamp, Region, Scene, SceneLoad};
use perilife_plate::specimen::geometry::edges;
use perilife_plate::specimen::{Edge, Point};
use perilife_points::net::Net;

/// Stiffness of a contact over the bound of the point's own: penetrations stay at some thousandths of the body's flattening.
const STIFFER: f64 = 5.0;

/// A point that a platen can meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlatenContact {
    pub point: u32,
    /// Way of the platen until it meets the undeformed rim there, m.
    pub gap: f64,
    /// Spring, N/m.
    pub stiffness: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Platen {
    /// Unit vector of its motion, into the body.
    pub direction: Point,
    /// Way at full load, m.
    pub travel: f64,
    /// How it moves in time.
    pub rise: LoadRamp,
    /// Points it can meet, in their order.
    pub contacts: Vec<PlatenContact>,
}

impl Platen {
    pub fn all(scene: &Scene, net: &Net) -> Vec<Platen> {
        scene.drives.iter().filter_map(|drive| Platen::of(drive, scene, net)).collect()
    }

    fn of(drive: &SceneLoad, scene: &Scene, net: &Net) -> Option<Platen> {
        let Action::Platen(motion) = drive.action else { return None };
        let travel = motion[0].hypot(motion[1]);
        let direction = motion.map(|m| m / travel);
        let outline = &scene.specimen.outline;
        let facing = facing(direction, net).into_iter().filter(|&i| covers(&drive.region, net.positions[i as usize]));
        let met: Vec<(u32, f64)> = facing.map(|i| (i, rim(direction, outline, net.positions[i as usize]))).collect();
        let corners = outline.iter().filter(|&&corner| covers(&drive.region, corner)).map(|&corner| dot(corner, direction));
        let start = met.iter().map(|m| m.1).chain(corners).fold(f64::INFINITY, f64::min);
        let contacts = met.into_iter().map(|(point, rim)| PlatenContact { point, gap: rim - start, stiffness: 0.0 }).collect();
        Some(Platen { direction, travel, rise: drive.rise, contacts })
    }
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Points with no other in front of them, ascending.
fn facing(direction: Point, net: &Net) -> Vec<u32> {
    let across = [-direction[1], direction[0]];
    let mut order: Vec<(f64, f64, u32)> =
        net.positions.iter().zip(0..).map(|(&x, i)| (dot(x, across), dot(x, direction), i)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Less than a whole spacing, so that a turned lattice has no gaps between rows.
    let beside = |i: u32| 0.5 * net.spacings[i as usize];
    let hidden = |at: usize| {
        let (seat, height, i) = order[at];
        let near = |other: &&(f64, f64, u32)| (other.0 - seat).abs() < beside(i);
        let before = order[..at].iter().rev().take_while(near);
        before.chain(order[at + 1..].iter().take_while(near)).any(|other| other.1 < height)
    };
    let mut facing: Vec<u32> = (0..order.len()).filter(|&at| !hidden(at)).map(|at| order[at].2).collect();
    facing.sort_unstable();
    facing
}

/// Coordinate along the motion of the rim in front of a point; of the point itself where the outline lies behind.
fn rim(direction: Point, outline: &[Point], point: Point) -> f64 {
    let across = [-direction[1], direction[0]];
    let (seat, height) = (dot(point, across), dot(point, direction));
    let meets = |(a, b): (Point, Point)| {
        let (from, to) = (dot(a, across), dot(b, across));
        let share = (seat - from) / (to - from);
        ((from <= seat) != (to <= seat)).then(|| dot(a, direction) + share * (dot(b, direction) - dot(a, direction)))
    };
    let front = edges(outline).filter_map(meets).filter(|rim| *rim <= height).fold(f64::NEG_INFINITY, f64::max);
    if front.is_finite() { front } else { height }
}

/// Whether a platen of this region is wide enough for a place.
fn covers(region: &Region, place: Point) -> bool {
    match *region {
        Region::Edge { edge, range, .. } => {
            let along = place[usize::from(!matches!(edge, Edge::Top | Edge::Bottom))];
            along >= range[0] && along <= range[1]
        }
        Region::Box { low, high } => (0..2).all(|i| place[i] >= low[i] && place[i] <= high[i]),
    }
}

/// An interaction on a body between platens.
pub struct Pressed<'n> {
    inner: Box<dyn Interaction + 'n>,
    net: &'n Net,
    platens: Vec<Platen>,
    /// Ways that the platens have gone, m.
    ways: Vec<f64>,
    /// Ways and forces at the last evaluation, m and N.
    last: Vec<(f64, f64)>,
    driven: Driven,
}

impl<'n> Pressed<'n> {
    /// Puts a body between platens, none of which has moved yet.
    pub fn new(inner: Box<dyn Interaction + 'n>, net: &'n Net, mut platens: Vec<Platen>) -> Self {
        let whole = BondState::new(net, &vec![false; net.len()]);
        let bound = inner.stiffness_bound(&whole);
        for contact in platens.iter_mut().flat_map(|platen| &mut platen.contacts) {
            contact.stiffness = STIFFER * bound[contact.point as usize][0];
        }
        let count = platens.len();
        Pressed { inner, net, platens, ways: vec![0.0; count], last: vec![(0.0, 0.0); count], driven: Driven::default() }
    }
}

impl Interaction for Pressed<'_> {
    fn unknowns(&self) -> usize {
        self.inner.unknowns()
    }

    fn internal_force(&mut self, u: &[f64], bonds: &mut BondState, damaging: Damaging, force: &mut [f64]) -> Reaction {
        let mut reaction = self.inner.internal_force(u, bonds, damaging, force);
        let unknowns = self.inner.unknowns();
        let (mut load, mut rate, mut work, mut penetration) = (0.0, 0.0, self.driven.work, 0.0_f64);
        for ((platen, &way), last) in self.platens.iter().zip(&self.ways).zip(&mut self.last) {
            let (d, mut own) = (platen.direction, 0.0);
            for contact in &platen.contacts {
                let at = contact.point as usize * unknowns;
                let depth = way - contact.gap - d[0] * u[at] - d[1] * u[at + 1];
                if depth > 0.0 {
                    let push = contact.stiffness * depth;
                    (force[at], force[at + 1]) = (force[at] + push * d[0], force[at + 1] + push * d[1]);
                    reaction.strain += 0.5 * push * depth;
                    own += push;
                    penetration = penetration.max(depth);
                }
            }
            load += own;
            rate += own * platen.travel;
            work += 0.5 * (last.1 + own) * (way - last.0);
            *last = (way, own);
        }
        let load = load / self.platens.len().max(1) as f64;
        self.driven = Driven { displacement: self.ways.iter().sum(), load, rate, work, penetration };
        reaction
    }

    fn stiffness_bound(&self, bonds: &BondState) -> Vec<[f64; 2]> {
        let mut bound = self.inner.stiffness_bound(bonds);
        for (platen, way) in self.platens.iter().zip(&self.ways) {
            // Points about to be met count too: they may bulge towards the platen.
            let near = |contact: &&PlatenContact| contact.gap <= way + self.net.spacings[contact.point as usize];
            for contact in platen.contacts.iter().filter(near) {
                bound[contact.point as usize][0] += contact.stiffness;
            }
        }
        bound
    }

    fn load_to(&mut self, level: f64) {
        self.ways = self.platens.iter().map(|platen| level * platen.travel).collect();
    }

    fn load_at(&mut self, time: f64) {
        self.ways = self.platens.iter().map(|platen| platen.rise.share(time) * platen.travel).collect();
    }

    fn memory(&self) -> Memory {
        Memory { platens: self.last.clone(), driven: self.driven, ..self.inner.memory() }
    }

    fn restore(&mut self, memory: &Memory, bonds: &BondState) -> bool {
        let Memory { displacement, platens, driven } = memory;
        if platens.len() != self.platens.len() {
            return false;
        }
        self.last.clone_from(platens);
        self.ways = platens.iter().map(|(way, _)| *way).collect();
        self.driven = *driven;
        self.inner.restore(&Memory { displacement: displacement.clone(), ..Memory::default() }, bonds)
    }

    fn driven(&self) -> Option<Driven> {
        Some(self.driven)
    }
}
