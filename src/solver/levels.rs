//! A plate of several levels whose bonds break on the finest only: conjugate gradients on its net preconditioned by a sparse
//! Cholesky factor for whole solves, and the net condensed onto the points around the tips between them
//! ([`super::window`]).

use std::sync::Arc;

use rayon::prelude::*;

use super::assembly::{Joint, Spring};
use super::field::Layout;
use super::product::Product;
use super::window::Whole;
use super::window::condense::{Condensed, FORK, LEAF, Plate, condense_plate};
use super::{Solved, SolverUsed, System};
use crate::body::{Body, Bond};
use crate::error::Result;
use crate::levels::Net;
use crate::levels::equilibrium::{Equilibrium, FullLoad, InternalForce, Shape};
use crate::levels::multi_level_body::MultiLevelBody;
use crate::specimen::geometry::bounding_box;
use crate::state::Bonds;

/// Residual over load at which a whole solve ends: bonds of mirror twins break together.
const TOLERANCE: f64 = 1e-11;
/// Bonds that one task works through.
const TASK: usize = 4096;

/// The whole plate.
pub(super) struct Levels<const N: usize> {
    plate: Arc<MultiLevelBody>,
    full: FullLoad,
    springs: NetSprings<N>,
    equilibrium: Option<Equilibrium>,
    shape: Shape,
}

/// Springs of a net with the bonds that are left.
struct NetSprings<const N: usize> {
    plate: Arc<MultiLevelBody>,
    /// 1 where a bond carries, 0 where it is broken.
    share: Vec<f64>,
    pulls: Vec<[f64; 3]>,
}

impl<const N: usize> InternalForce for NetSprings<N> {
    fn share(&self) -> &[f64] {
        &self.share
    }

    fn internal_force(&mut self, u: &[f64], force: &mut [f64]) -> f64 {
        let net = &self.plate.net;
        let tasks = self.pulls.par_chunks_mut(TASK).zip(self.share.par_chunks(TASK)).zip(net.bonds.par_chunks(TASK));
        let energies: Vec<f64> = tasks
            .map(|((pulls, shares), bonds)| {
                let mut energy = 0.0;
                for ((pull, share), bond) in pulls.iter_mut().zip(shares).zip(bonds) {
                    let [e_n, e_t] = bond.deformation::<N>(u);
                    let (normal, tangential) = (share * bond.k_n * e_n, share * bond.k_t * e_t);
                    energy += 0.5 * (normal * e_n + tangential * e_t);
                    *pull = bond.force::<N>(bond.normal, normal, tangential);
                }
                energy
            })
            .collect();
        net.gather::<N>(&self.pulls, force);
        energies.iter().sum()
    }
}

impl<const N: usize> Levels<N> {
    /// A plate with its present bonds under `load` times its unit load.
    pub fn new(plate: Arc<MultiLevelBody>, body: &Body, bonds: &Bonds, load: f64) -> Self {
        debug_assert_eq!(plate.net.unknowns, body.stencil.unknowns);
        let mut full = plate.full.clone();
        full.external.iter_mut().for_each(|force| *force *= load);
        let mut share = vec![1.0; plate.net.bonds.len()];
        plate.net.pre_cut.iter().for_each(|&bond| share[bond as usize] = 0.0);
        plate.bonds().iter().filter(|(bond, _)| !bonds.is_intact(*bond)).for_each(|(_, b)| share[*b as usize] = 0.0);
        let pulls = vec![[0.0; 3]; share.len()];
        let shape = Shape::at_rest(full.held.len());
        Levels { springs: NetSprings { plate: plate.clone(), share, pulls }, plate, full, equilibrium: None, shape }
    }

    /// Where the first unknown of a number stands in the layout of the body with what follows behind it, and the distance to the next.
    fn place(&self, layout: &Layout, places: usize, id: usize) -> (usize, usize) {
        if id < places { (layout.index(id), layout.stride) } else { (layout.len() + N * (id - places), 1) }
    }

    fn take(&mut self, system: System<'_, N>, u: &[f64]) {
        let layout = system.product.layout();
        for (point, &id) in self.plate.ids.iter().enumerate() {
            let (first, stride) = self.place(layout, system.body.places(), id as usize);
            let mut own = [0.0; 3];
            (0..N).for_each(|c| own[c] = u[first + c * stride]);
            self.shape.u[N * point..N * (point + 1)].copy_from_slice(&self.plate.to_net(own)[..N]);
        }
    }

    fn give(&self, system: System<'_, N>, u: &mut [f64]) {
        let layout = system.product.layout();
        for (point, &id) in self.plate.ids.iter().enumerate() {
            let (first, stride) = self.place(layout, system.body.places(), id as usize);
            let mut own = [0.0; 3];
            own[..N].copy_from_slice(&self.shape.u[N * point..N * (point + 1)]);
            let own = self.plate.to_body(own);
            (0..N).for_each(|c| u[first + c * stride] = own[c]);
        }
    }
}

impl<const N: usize> Whole<N> for Levels<N> {
    const USED: SolverUsed = SolverUsed::ConjugateGradients;

    fn solve(&mut self, system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
        self.solve_to(TOLERANCE, system, u)
    }

    fn solve_to(&mut self, tolerance: f64, system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
        self.take(system, u);
        let plate = self.plate.clone();
        let is_first = self.equilibrium.is_none();
        let mut equilibrium = match self.equilibrium.take() {
            Some(equilibrium) => equilibrium,
            None => Equilibrium::new(&plate.net, &self.full)?,
        };
        let solved = equilibrium.solve(&plate.net, &self.full, &mut self.springs, &mut self.shape, tolerance);
        tracing::debug!(spent = ?equilibrium.spent, "net solved");
        self.equilibrium = Some(equilibrium);
        let iterations = solved?;
        if is_first {
            self.full.check_balance(&plate.net, &self.shape.force)?;
        }
        self.give(system, u);
        let work = match plate.grip_force {
            None => self.full.external.iter().zip(&self.shape.u).map(|(force, u)| force * u).sum(),
            Some(_) => -2.0 * self.shape.strain,
        };
        Ok(Solved { iterations, work })
    }

    fn broke(&mut self, _: &Body, _: &Bonds, _: &Product<N>, broken: &[Bond]) {
        for b in broken.iter().filter_map(|&bond| self.plate.bond(bond)) {
            self.springs.share[b] = 0.0;
        }
    }

    fn condense(&self, _: System<'_, N>, places: &[u32]) -> Option<Condensed> {
        let parts = Parts::of(&self.plate, &self.springs.share, places);
        let net = GraphPlate::<N> { plate: &self.plate, full: &self.full, share: &self.springs.share, parts };
        let mut condensed = condense_plate(&net, places, &[])?;
        let held = |index: usize| net.is_held(places[index / N] as usize, index % N);
        let order = N * places.len();
        // Held unknowns do not give way.
        for i in (0..order).filter(|&i| held(i)) {
            (0..order).for_each(|j| (condensed.inverse[(i, j)], condensed.inverse[(j, i)]) = (0.0, 0.0));
        }
        // To the unknowns of the body: columns, then rows.
        let turned = |values: [f64; 3]| self.plate.to_body(values);
        for first in (0..order).step_by(N) {
            for other in 0..order {
                let mut column = [0.0; 3];
                (0..N).for_each(|c| column[c] = condensed.inverse[(first + c, other)]);
                let column = turned(column);
                (0..N).for_each(|c| condensed.inverse[(first + c, other)] = column[c]);
            }
        }
        for first in (0..order).step_by(N) {
            for other in 0..order {
                let mut row = [0.0; 3];
                (0..N).for_each(|c| row[c] = condensed.inverse[(other, first + c)]);
                let row = turned(row);
                (0..N).for_each(|c| condensed.inverse[(other, first + c)] = row[c]);
            }
        }
        Some(condensed)
    }
}

/// A net in parts, its points named as [`MultiLevelBody::ids`] does.
struct GraphPlate<'a, const N: usize> {
    plate: &'a MultiLevelBody,
    full: &'a FullLoad,
    share: &'a [f64],
    parts: Parts,
}

/// Bisection of a net: points of separators and of the smallest parts, children before their parents.
struct Parts {
    /// Points of every node that are not in its children, ascending by number.
    nodes: Vec<Node>,
    /// Node of every number.
    node_of: Vec<u32>,
}

struct Node {
    own: Vec<u32>,
    /// The first node below it, or itself.
    first: usize,
    /// Points of it and all below.
    size: usize,
    children: Option<[usize; 2]>,
}

/// Nodes from `first` to `last`, which is the parent of all others or stands alone.
#[derive(Clone, Copy)]
struct Part {
    first: usize,
    last: usize,
}

impl Parts {
    /// Parts of all points with a bond but those of a window.
    fn of(plate: &MultiLevelBody, share: &[f64], window: &[u32]) -> Parts {
        let net = &plate.net;
        let carries = |point: &usize| net.bonds_of(*point).any(|(bond, ..)| share[bond] > 0.0);
        let is_kept = |point: &usize| window.binary_search(&plate.ids[*point]).is_ok();
        let points: Vec<usize> = (0..net.len()).filter(|point| carries(point) && !is_kept(point)).collect();
        let mut parts = Parts { nodes: Vec::new(), node_of: vec![u32::MAX; plate.numbers()] };
        let mut side = vec![0; net.len()];
        parts.divide(net, share, points, &mut side, &plate.ids);
        parts
    }

    /// Adds the nodes of some points; the last one added is their root. `side` is room for work, 0 everywhere.
    fn divide(&mut self, net: &Net, share: &[f64], points: Vec<usize>, side: &mut [u8], ids: &[u32]) {
        let (first, size) = (self.nodes.len(), points.len());
        let mut children = None;
        let mut own = points;
        if size > LEAF
            && let Some([a, b, between]) = halves(net, share, &own, side)
        {
            self.divide(net, share, a, side, ids);
            let left = self.nodes.len() - 1;
            self.divide(net, share, b, side, ids);
            (children, own) = (Some([left, self.nodes.len() - 1]), between);
        }
        let mut own: Vec<u32> = own.into_iter().map(|point| ids[point]).collect();
        own.sort_unstable();
        own.iter().for_each(|&id| self.node_of[id as usize] = self.nodes.len() as u32);
        self.nodes.push(Node { own, first, size, children });
    }
}

/// Two halves of some points without a bond between them, and the separator; `None` where nothing would be left of one.
fn halves(net: &Net, share: &[f64], points: &[usize], side: &mut [u8]) -> Option<[Vec<usize>; 3]> {
    let positions: Vec<_> = points.iter().map(|&point| net.positions[point]).collect();
    let [low, high] = bounding_box(&positions);
    let axis = usize::from(high[1] - low[1] > high[0] - low[0]);
    let mut along: Vec<f64> = positions.iter().map(|at| at[axis]).collect();
    let middle = along.len() / 2;
    let (_, &mut cut, _) = along.select_nth_unstable_by(middle, f64::total_cmp);
    for &point in points {
        side[point] = if net.positions[point][axis] < cut { 1 } else { 2 };
    }
    let touches = |point: usize, other: u8| net.bonds_of(point).any(|(b, end, _)| share[b] > 0.0 && side[end] == other);
    let rim = |own: u8| points.iter().copied().filter(|&point| side[point] == own && touches(point, 3 - own)).collect::<Vec<_>>();
    let (left, right) = (rim(1), rim(2));
    let between = if left.len() <= right.len() { left } else { right };
    between.iter().for_each(|&point| side[point] = 0);
    let of = |own: u8| points.iter().copied().filter(|&point| side[point] == own).collect::<Vec<_>>();
    let (a, b) = (of(1), of(2));
    points.iter().for_each(|&point| side[point] = 0);
    (!a.is_empty() && !b.is_empty()).then_some([a, b, between])
}

impl<const N: usize> GraphPlate<'_, N> {
    fn net_point(&self, place: usize) -> usize {
        // Only numbers of points are asked for.
        self.plate.point(place).unwrap_or_default()
    }
}

impl<const N: usize> Plate<N> for GraphPlate<'_, N> {
    type Region = Part;

    fn places(&self) -> usize {
        self.plate.numbers()
    }

    fn is_held(&self, place: usize, component: usize) -> bool {
        self.full.held[self.net_point(place) * N + component]
    }

    fn pivot_sign(&self, _: usize) -> f64 {
        1.0
    }

    fn point(&self, _: usize) -> f64 {
        0.0
    }

    fn ground(&self) -> Vec<u32> {
        let is_held = |id: &u32| (0..N).all(|c| self.is_held(*id as usize, c));
        self.plate.ids.iter().copied().filter(is_held).collect()
    }

    fn for_joints(&self, place: usize, mut take: impl FnMut(Joint<N>, bool)) {
        let net = &self.plate.net;
        for (b, other, owned) in net.bonds_of(self.net_point(place)).filter(|&(b, ..)| self.share[b] > 0.0) {
            let bond = &net.bonds[b];
            let spring = Spring { k_n: bond.k_n, k_t: bond.k_t, n: bond.normal, t: bond.tangent(), lever: bond.lever };
            let sign = if owned { 1.0 } else { -1.0 };
            let joint = Joint {
                other: self.plate.ids[other] as usize,
                is_image: false,
                here: spring.blocks::<N>(sign, self.share[b]),
                there: spring.blocks::<N>(-sign, self.share[b]),
            };
            take(joint, owned);
        }
    }

    fn for_neighbours(&self, place: usize, mut take: impl FnMut(usize)) {
        let bonds = self.plate.net.bonds_of(self.net_point(place)).filter(|&(b, ..)| self.share[b] > 0.0);
        bonds.for_each(|(_, other, _)| take(self.plate.ids[other] as usize));
    }

    fn whole(&self, _: &[bool]) -> Part {
        Part { first: 0, last: self.parts.nodes.len() - 1 }
    }

    fn split(&self, region: Part) -> Option<[Part; 3]> {
        let node = &self.parts.nodes[region.last];
        let of = |last: usize| Part { first: self.parts.nodes[last].first, last };
        node.children.filter(|_| region.first < region.last).map(|[a, b]| [of(a), of(b), Part { first: region.last, ..region }])
    }

    fn is_large(&self, region: Part) -> bool {
        self.parts.nodes[region.last].size >= FORK
    }

    fn has(&self, region: Part, place: usize) -> bool {
        (region.first..=region.last).contains(&(self.parts.node_of[place] as usize))
    }

    fn carrying(&self, region: Part) -> Vec<u32> {
        // A region of several nodes is always split first.
        self.parts.nodes[region.last].own.clone()
    }
}
