//! Cholesky factor of the sum of the matrices of cells and supports, part by part of the plate.
//!
//! The plate is bisected again and again (nested dissection: George 1973, SIAM J. Numer. Anal. 10:345). A node is eliminated in the
//! smallest part that has all matrices that it occurs in; what the elimination leaves to the other nodes of the part goes to the part that
//! holds both halves (multifrontal method: Duff and Reid 1983, ACM Trans. Math. Softw. 9:302). So nothing sparse is stored, ordered or
//! searched. Halves are worked on at the same time, and the order of sums does not depend on the number of threads.

use std::iter::repeat;

use super::front::Front;
use crate::error::{Error, Result};
use crate::specimen::Point;

/// Matrices of a part that is not divided, at the most.
const UNDIVIDED: usize = 40;

/// A matrix to be summed: where it acts, and the nodes whose unknowns it may couple, ascending.
#[derive(Debug, Clone)]
pub struct Member {
    /// Where it lies, m.
    pub at: Point,
    /// Nodes.
    pub nodes: Vec<u32>,
}

/// Adds members, by their index, to a front, in which the unknowns of a node of theirs begin at `places[node]`.
pub trait Matrices: Sync {
    /// Adds the members.
    ///
    /// # Errors
    /// A matrix cannot be computed.
    fn add(&self, members: &[u32], places: &[u32], front: &mut Front) -> Result<()>;
}

/// A part of the plate with its factor.
#[derive(Debug)]
struct Part {
    front: Front,
    /// Unknowns of the front, those that are eliminated first.
    unknowns: Vec<u32>,
    halves: Option<Box<[Part; 2]>>,
}

/// Nodes of a part that are not eliminated in it, ascending, with the number of its matrices in which they occur.
type Open = Vec<(u32, u32)>;

/// Factor L of a positive definite matrix `A = L Lᵀ`.
#[derive(Debug)]
pub struct Factor(Part);

struct Dissection<'a, M> {
    members: &'a [Member],
    first: &'a [u32],
    /// Number of members in which every node occurs.
    uses: Vec<u32>,
    matrices: &'a M,
}

impl Factor {
    /// Of the sum of all members; the unknowns of node i are those from `first[i]` to `first[i + 1]`.
    ///
    /// # Errors
    /// [`Error::LossOfStiffness`] where the sum is not positive definite; those of the matrices.
    pub fn of(members: &[Member], first: &[u32], matrices: &impl Matrices) -> Result<Self> {
        let mut uses = vec![0; first.len() - 1];
        members.iter().flat_map(|member| &member.nodes).for_each(|&node| uses[node as usize] += 1);
        if uses.contains(&0) {
            return Err(Error::LossOfStiffness);
        }
        let dissection = Dissection { members, first, uses, matrices };
        let mut all: Vec<u32> = (0..members.len() as u32).collect();
        dissection.part(&mut all).map(|(part, _)| Factor(part))
    }

    /// Solves `A x = b` in place of b.
    pub fn solve(&self, b: &mut [f64]) {
        self.0.solve_forward(b);
        self.0.solve_backward(b);
    }
}

impl Part {
    fn solve_forward(&self, b: &mut [f64]) {
        self.halves.iter().flat_map(|halves| halves.iter()).for_each(|half| half.solve_forward(b));
        self.front.solve_forward(&self.unknowns, b);
    }

    fn solve_backward(&self, b: &mut [f64]) {
        self.front.solve_backward(&self.unknowns, b);
        self.halves.iter().flat_map(|halves| halves.iter()).for_each(|half| half.solve_backward(b));
    }
}

impl<M: Matrices> Dissection<'_, M> {
    /// Sums the matrices of a part and eliminates what it can.
    fn part(&self, members: &mut [u32]) -> Result<(Part, Open)> {
        if members.len() <= UNDIVIDED {
            return self.undivided(members);
        }
        let (left, right) = self.halves(members);
        let (left, right) = rayon::join(|| self.part(left), || self.part(right));
        let ((left, of_left), (right, of_right)) = (left?, right?);
        let mut empty = self.empty(&united(&of_left, &of_right));
        let mut halves = Box::new([left, right]);
        for (half, open) in halves.iter_mut().zip([of_left, of_right]) {
            let places: Vec<u32> = open.iter().flat_map(|&(node, _)| self.numbers(node, empty.places[node as usize])).collect();
            empty.front.take(&mut half.front, &places);
        }
        empty.eliminated(Some(halves))
    }

    fn undivided(&self, members: &[u32]) -> Result<(Part, Open)> {
        let mut all: Vec<u32> = members.iter().flat_map(|&member| &self.members[member as usize].nodes).copied().collect();
        all.sort_unstable();
        let nodes: Open = all.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() as u32)).collect();
        let mut empty = self.empty(&nodes);
        self.matrices.add(members, &empty.places, &mut empty.front)?;
        empty.eliminated(None)
    }

    /// As many numbers from `from` on as a node has unknowns.
    fn numbers(&self, node: u32, from: u32) -> std::ops::Range<u32> {
        from..from + self.first[node as usize + 1] - self.first[node as usize]
    }

    /// The front of these nodes, of which those that occur nowhere else are eliminated.
    fn empty(&self, nodes: &[(u32, u32)]) -> Empty {
        let is_own = |&&(node, count): &&(u32, u32)| count == self.uses[node as usize];
        let open: Open = nodes.iter().filter(|node| !is_own(node)).copied().collect();
        let mut places = vec![u32::MAX; self.uses.len()];
        let mut unknowns = Vec::new();
        let mut own = 0;
        for (&(node, _), is_own) in nodes.iter().filter(is_own).zip(repeat(true)).chain(open.iter().zip(repeat(false))) {
            places[node as usize] = unknowns.len() as u32;
            unknowns.extend(self.numbers(node, self.first[node as usize]));
            own = if is_own { unknowns.len() } else { own };
        }
        Empty { front: Front::new(own, unknowns.len() - own), unknowns, places, open }
    }

    /// Divides a part across x or y into halves of as many members, so that they have the fewest unknowns in common.
    fn halves<'a>(&self, members: &'a mut [u32]) -> (&'a mut [u32], &'a mut [u32]) {
        let middle = members.len() / 2;
        let sort = |members: &mut [u32], axis: usize| {
            let place = |member: u32| self.members[member as usize].at[axis];
            members.sort_unstable_by(|a, b| place(*a).total_cmp(&place(*b)).then(a.cmp(b)));
        };
        let mut common = [0; 2];
        for (axis, common) in common.iter_mut().enumerate() {
            sort(members, axis);
            let mut sides = vec![0_u8; self.uses.len()];
            for (k, &member) in members.iter().enumerate() {
                let side = if k < middle { 1 } else { 2 };
                self.members[member as usize].nodes.iter().for_each(|&node| sides[node as usize] |= side);
            }
            *common = (0..).zip(sides).filter(|(_, sides)| *sides == 3).map(|(node, _)| self.numbers(node, 0).len()).sum();
        }
        if common[0] <= common[1] {
            sort(members, 0);
        }
        members.split_at_mut(middle)
    }
}

/// A front before its elimination.
struct Empty {
    front: Front,
    unknowns: Vec<u32>,
    /// First unknown of every node in it.
    places: Vec<u32>,
    open: Open,
}

impl Empty {
    fn eliminated(mut self, halves: Option<Box<[Part; 2]>>) -> Result<(Part, Open)> {
        if !self.front.eliminate() {
            return Err(Error::LossOfStiffness);
        }
        Ok((Part { front: self.front, unknowns: self.unknowns, halves }, self.open))
    }
}

/// Both lists as one, with the sum of their counts.
fn united(a: &[(u32, u32)], b: &[(u32, u32)]) -> Open {
    let (mut a, mut b) = (a.iter().peekable(), b.iter().peekable());
    let mut all = Vec::new();
    loop {
        let next = match (a.peek(), b.peek()) {
            (None, None) => return all,
            (Some(x), Some(y)) => x.0.min(y.0),
            (Some(x), None) | (None, Some(x)) => x.0,
        };
        let count = [&mut a, &mut b].into_iter().filter_map(|list| list.next_if(|entry| entry.0 == next)).map(|entry| entry.1).sum();
        all.push((next, count));
    }
}
