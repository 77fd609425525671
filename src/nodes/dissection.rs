//! Cholesky factor of the sum of the matrices of cells and supports, part by part of the plate.
//!
//! The plate is bisected again and again (nested dissection: George 1973, SIAM J. Numer. Anal. 10:345). A node is eliminated in the
//! smallest part that has all matrices that it occurs in; what the elimination leaves to the other nodes of the part goes to the part that
//! holds it (multifrontal method: Duff and Reid 1983, ACM Trans. Math. Softw. 9:302). So nothing sparse is stored, ordered or
//! searched. A part that eliminates few unknowns is dissolved in the one that holds it. Parts are worked on at the same time, and the order of sums does not depend on the number of threads.

use std::cmp::Ordering;
use std::ops::Range;

use rayon::prelude::*;

use super::front::FrontalMatrix;
use perilife_base::error::{Error, Result};
use perilife_plate::specimen::Point;

/// Matrices of a part that is not divided, at the most.
const UNDIVIDED: usize = 40;
/// Unknowns eliminated in a part below which it is dissolved.
const OWN_LEAST: u32 = 40;
/// Distance of a cut from the middle at the most, in shares of the members: around a tip the middle would pass right through fine nodes.
const OFF_MIDDLE: f64 = 0.4;

/// A matrix to be summed: where it acts, and the nodes whose unknowns it may couple, ascending.
#[derive(Debug, Clone)]
pub struct Member {
    /// Where it lies, m.
    pub at: Point,
    pub nodes: Vec<u32>,
}

/// Adds members, by their index, to a front, in which the unknowns of a node of theirs begin at `places[node]`.
pub trait Matrices: Sync {
    /// Adds the members.
    /// Errors: a matrix cannot be computed.
    fn add(&self, members: &[u32], places: &[u32], front: &mut FrontalMatrix) -> Result<()>;
}

/// A part of the plate before anything is computed.
#[derive(Debug)]
struct Plan {
    /// Where its members stand in the order of all.
    members: Range<usize>,
    /// Nodes that are eliminated in it.
    own: Vec<u32>,
    /// Its parts, one after the other; none of a part that is not divided.
    parts: Vec<Plan>,
}

#[derive(Debug)]
struct Subdomain {
    front: FrontalMatrix,
    /// Unknowns of the front, those that are eliminated first.
    unknowns: Vec<u32>,
    parts: Vec<Subdomain>,
}

/// Factor L of a positive definite matrix `A = L Lᵀ`.
#[derive(Debug)]
pub struct Factor(Subdomain);

struct Dissection<'a, M> {
    members: &'a [Member],
    /// Members part by part.
    order: Vec<u32>,
    first: &'a [u32],
    /// When nodes are eliminated.
    ranks: Vec<u32>,
    matrices: &'a M,
}

impl Factor {
    /// Of the sum of all members; the unknowns of node i are those from `first[i]` to `first[i + 1]`, of some there may be none.
    /// Errors: [`Error::LossOfStiffness`] where the sum is not positive definite; those of the matrices.
    pub fn of(members: &[Member], first: &[u32], matrices: &impl Matrices) -> Result<Self> {
        let nodes = first.len() - 1;
        let bisection = Bisection { members, first };
        let (mut order, [along_x, along_y]) = (vec![0; members.len()], [0, 1].map(|axis| bisection.along(axis)));
        let mut plan = bisection.plan([along_x, along_y], 0, (&mut order, 0));
        // Where the members of a node stand, from the first to the last; an end of 0 has none.
        let mut spans = vec![0..0; nodes];
        for (place, &member) in order.iter().enumerate() {
            for &node in &members[member as usize].nodes {
                let span = &mut spans[node as usize];
                let start = if span.end == 0 { place } else { span.start };
                *span = start..place + 1;
            }
        }
        for (node, span) in (0..).zip(spans) {
            if span.end == 0 && first[node as usize] == first[node as usize + 1] {
                continue;
            }
            if span.end == 0 {
                return Err(Error::LossOfStiffness);
            }
            plan.give(node, &span);
        }
        plan.merge(first);
        let mut ranks = vec![0; nodes];
        plan.rank(&mut ranks, &mut 0);
        Dissection { members, order, first, ranks, matrices }.part(&plan).map(|(part, _)| Factor(part))
    }

    /// Solves `A x = b` in place of b.
    pub fn solve(&self, b: &mut [f64]) {
        self.forward(b);
        self.backward(b);
    }

    /// `L⁻¹ b` in place of b.
    pub fn forward(&self, b: &mut [f64]) {
        self.0.solve_forward(b);
    }

    /// The same of several right sides that each load few unknowns.
    pub fn forward_together(&self, sides: &mut [Vec<f64>]) {
        self.0.solve_forward_together(sides);
    }

    /// `L⁻ᵀ b` in place of b.
    pub fn backward(&self, b: &mut [f64]) {
        self.0.solve_backward(b);
    }
}

impl Plan {
    /// Gives a node to the smallest part that holds its members.
    fn give(&mut self, node: u32, span: &Range<usize>) {
        let holds = |part: &&mut Plan| part.members.start <= span.start && span.end <= part.members.end;
        match self.parts.iter_mut().find(holds) {
            Some(part) => part.give(node, span),
            None => self.own.push(node),
        }
    }

    /// Dissolves parts in which few unknowns are eliminated: their matrix costs more to fill and to take up than it saves.
    fn merge(&mut self, first: &[u32]) {
        let unknowns = |own: &[u32]| own.iter().map(|&node| first[node as usize + 1] - first[node as usize]).sum::<u32>();
        self.parts.iter_mut().for_each(|part| part.merge(first));
        let of_parts: u32 = self.parts.iter().map(|part| unknowns(&part.own)).sum();
        let are_whole = self.parts.iter().all(|part| part.parts.is_empty());
        if !self.parts.is_empty() && are_whole && of_parts < OWN_LEAST {
            self.parts.drain(..).for_each(|part| self.own.extend(part.own));
            return;
        }
        for part in std::mem::take(&mut self.parts) {
            if !part.parts.is_empty() && unknowns(&part.own) < OWN_LEAST {
                self.own.extend(part.own);
                self.parts.extend(part.parts);
            } else {
                self.parts.push(part);
            }
        }
    }

    /// Numbers the nodes in the order of their elimination: those of all parts before those of the whole.
    fn rank(&self, ranks: &mut [u32], next: &mut u32) {
        self.parts.iter().for_each(|part| part.rank(ranks, next));
        for &node in &self.own {
            ranks[node as usize] = *next;
            *next += 1;
        }
    }
}

/// How a plate is divided.
struct Bisection<'a> {
    members: &'a [Member],
    first: &'a [u32],
}

impl Bisection<'_> {
    /// All members along x or y.
    fn along(&self, axis: usize) -> Vec<u32> {
        let mut order: Vec<u32> = (0..self.members.len() as u32).collect();
        order.sort_unstable_by(|a, b| self.is_before(axis, *a, *b));
        order
    }

    fn is_before(&self, axis: usize, a: u32, b: u32) -> Ordering {
        let place = |member: u32| self.members[member as usize].at[axis];
        place(a).total_cmp(&place(b)).then(a.cmp(&b))
    }

    /// Orders members, given along x and along y, part by part into `order`, of which the first is number `start` of all; a part that is
    /// not divided keeps their order along `axis`.
    fn plan(&self, along: [Vec<u32>; 2], axis: usize, (order, start): (&mut [u32], usize)) -> Plan {
        let range = start..start + order.len();
        if order.len() <= UNDIVIDED {
            order.copy_from_slice(&along[axis]);
            return Plan { members: range, own: Vec::new(), parts: Vec::new() };
        }
        let (x, y) = rayon::join(|| self.cut(&along[0]), || self.cut(&along[1]));
        let (axis, place) = if y.0 < x.0 { (1, y.1) } else { (0, x.1) };
        let first_right = along[axis][place];
        let is_left = |member: &u32| self.is_before(axis, *member, first_right).is_lt();
        let [x, y] = along.map(|members| members.into_iter().partition::<Vec<u32>, _>(is_left));
        let (of_left, of_right) = order.split_at_mut(place);
        let left = || self.plan([x.0, y.0], axis, (of_left, start));
        let (left, right) = rayon::join(left, || self.plan([x.1, y.1], axis, (of_right, start + place)));
        Plan { members: range, own: Vec::new(), parts: vec![left, right] }
    }

    /// Where to divide members that stand in this order: where the two parts have the fewest unknowns in common, times 1 and how far that is
    /// from the middle; with that number.
    fn cut(&self, order: &[u32]) -> (f64, usize) {
        let (mut spans, mut met) = (vec![[u32::MAX, 0]; self.first.len() - 1], Vec::new());
        for (k, &member) in (0..).zip(order) {
            for &node in &self.members[member as usize].nodes {
                let span = &mut spans[node as usize];
                if span[0] == u32::MAX {
                    span[0] = k;
                    met.push(node as usize);
                }
                span[1] = k;
            }
        }
        // Unknowns that a cut before a place divides: of nodes that begin before it and end there or later.
        let mut change = vec![0_i64; order.len() + 1];
        for node in met {
            let (unknowns, [from, to]) = (i64::from(self.first[node + 1] - self.first[node]), spans[node]);
            if from < to {
                change[from as usize + 1] += unknowns;
                change[to as usize + 1] -= unknowns;
            }
        }
        let (mut common, mut best) = (0, (f64::INFINITY, order.len() / 2));
        for (place, change) in change.iter().enumerate() {
            common += change;
            let off = (place as f64 / order.len() as f64 - 0.5).abs();
            let cost = common as f64 * (1.0 + off);
            if off <= OFF_MIDDLE && cost < best.0 {
                best = (cost, place);
            }
        }
        best
    }
}

impl Subdomain {
    fn solve_forward(&self, b: &mut [f64]) {
        self.parts.iter().for_each(|part| part.solve_forward(b));
        self.front.solve_forward(&self.unknowns, b);
    }

    fn solve_forward_together(&self, sides: &mut [Vec<f64>]) {
        self.parts.iter().for_each(|part| part.solve_forward_together(sides));
        self.front.solve_forward_together(&self.unknowns, sides);
    }

    fn solve_backward(&self, b: &mut [f64]) {
        self.front.solve_backward(&self.unknowns, b);
        self.parts.iter().for_each(|part| part.solve_backward(b));
    }
}

impl<M: Matrices> Dissection<'_, M> {
    /// Sums the matrices of a part and eliminates its nodes; gives the nodes that are left as well, by rank.
    fn part(&self, plan: &Plan) -> Result<(Subdomain, Vec<u32>)> {
        let members = &self.order[plan.members.clone()];
        let parts = plan.parts.par_iter().with_max_len(1).map(|part| self.part(part)).collect::<Result<Vec<_>>>()?;
        let mut places = vec![u32::MAX; self.ranks.len()];
        let of_members = members.iter().filter(|_| parts.is_empty()).flat_map(|&member| &self.members[member as usize].nodes);
        let all = parts.iter().flat_map(|(_, open)| open).chain(of_members).copied();
        // Those that were met are marked; the marks become places.
        let mut nodes: Vec<u32> = all.filter(|&node| std::mem::replace(&mut places[node as usize], 0) == u32::MAX).collect();
        nodes.sort_unstable_by_key(|&node| self.ranks[node as usize]);
        let mut unknowns = Vec::new();
        for &node in &nodes {
            places[node as usize] = unknowns.len() as u32;
            unknowns.extend(self.unknowns(node));
        }
        // Nodes of the part have lower ranks than those that are left.
        let open = nodes.split_off(plan.own.len());
        let own = open.first().map_or(unknowns.len(), |&node| places[node as usize] as usize);
        let mut front = FrontalMatrix::new(own, unknowns.len() - own);
        if parts.is_empty() {
            self.matrices.add(members, &places, &mut front)?;
        }
        let take = |(mut part, open): (Subdomain, Vec<u32>)| {
            let of_node = |&node: &u32| {
                let place = places[node as usize];
                place..place + self.unknowns(node).len() as u32
            };
            front.take(&mut part.front, &open.iter().flat_map(of_node).collect::<Vec<u32>>());
            part
        };
        let parts = parts.into_iter().map(take).collect();
        if front.eliminate() { Ok((Subdomain { front, unknowns, parts }, open)) } else { Err(Error::LossOfStiffness) }
    }

    fn unknowns(&self, node: u32) -> Range<u32> {
        self.first[node as usize]..self.first[node as usize + 1]
    }
}
