//! Symmetry: the unknowns that stand for all of a plate that is its own image.
//!
//! A plate that a mirror about a line through its middle, both such lines or half a turn leave as it is, with its cracks, nodes, supports and
//! loads, moves symmetrically: an unknown equals, but for its sign, that of every image of its node, and one whose image is its own opposite
//! vanishes. With `u = T v` the energy `½ uᵀ K u` is that of the cells of one part, times the number of parts: `Tᵀ K T` is summed over these
//! cells alone, whose rows of strain go to the unknowns v. The displacement is that of the whole plate but for round-off.
//!
//! Modes I and II of a tip are even and odd in a mirror, and both turn with the plate.

use super::boundary::{Boundary, Square};
use super::field::Discretisation;
use perilife_plate::specimen::geometry::{along, bounding_box, distance};
use perilife_plate::specimen::{Point, Specimen};

/// Distance of a node, over its spacing, and of the ends of a side, over its length, from their images.
const EQUAL: f64 = 1e-6;
/// Difference of two forces, over the largest, that are equal: those on flanks are read a millionth of a spacing off the crack.
const EQUAL_FORCE: f64 = 1e-5;

/// A map of a plate on itself: signs of the distances from its middle.
#[derive(Debug, Clone, Copy)]
struct Flip {
    middle: Point,
    signs: [f64; 2],
}

impl Flip {
    fn image(self, at: Point) -> Point {
        [0, 1].map(|i| self.middle[i] + self.signs[i] * (at[i] - self.middle[i]))
    }
}

/// The unknowns of a plate: those of its nodes, then those of grips as of further nodes.
struct Unknowns<'a> {
    plate: &'a Discretisation,
    at: Vec<Point>,
    /// Distance of two nodes that are the same, m.
    equal: Vec<f64>,
    /// First unknown of each.
    first: &'a [u32],
}

/// An image of a plate, and which node and which tip is that of each.
struct Image<'a> {
    of: &'a Unknowns<'a>,
    flip: Flip,
    nodes: Vec<u32>,
    tips: Vec<u32>,
}

/// Which unknowns stand for all.
#[derive(Debug)]
pub struct Fold {
    /// Images of the plate but for itself.
    flips: Vec<Flip>,
    /// The node that stands for each.
    nodes: Vec<u32>,
    /// Nodes all of whose unknowns stand for themselves.
    plain: Vec<bool>,
    /// The unknown that stands for each, in a numbering of its own, and its sign; 0 of one that vanishes.
    unknowns: Vec<(u32, f64)>,
    /// First of the unknowns that stand for others by node, none of a node for which another stands, and their number.
    pub first: Vec<u32>,
    /// Cells of the part, with the share of each that belongs to it.
    pub cells: Vec<(usize, f64)>,
    /// Supports, what holds rigid motions that are symmetric, and unknowns that vanish.
    pub held: Vec<Square>,
}

impl Fold {
    /// Of a plate whose nodes' unknowns, and those of its grips after them, begin at `first`; `None` of one that is not its own image.
    pub fn of(
        specimen: &Specimen,
        plate: &Discretisation,
        boundary: &Boundary,
        forces: [&[f64]; 2],
        first: &[u32],
    ) -> Option<Fold> {
        let [low, high] = bounding_box(&specimen.outline);
        let mut of = Unknowns { plate, at: plate.nodes.at.clone(), equal: Vec::new(), first };
        of.equal.extend(plate.nodes.spacing.iter().map(|spacing| EQUAL * spacing));
        of.at.extend(&boundary.grips);
        of.equal.resize(of.at.len(), EQUAL * distance(low, high));
        let middle = along(low, high, 0.5);
        let keeps =
            |image: &Image| forces.iter().all(|forces| image.is_image(forces, forces)) && image.keeps_supports(&boundary.held);
        let image = |signs| Image::new(&of, Flip { middle, signs }).filter(keeps);
        let mut images: Vec<Image> = [[-1.0, 1.0], [1.0, -1.0]].into_iter().filter_map(image).collect();
        if images.len() != 1 {
            images.extend(image([-1.0, -1.0]));
        }
        // Of both mirrors and half a turn each is the other two.
        if images.len().is_multiple_of(2) {
            return None;
        }
        let mut fold = Fold {
            flips: images.iter().map(|image| image.flip).collect(),
            nodes: (0..of.at.len() as u32).map(|node| standing(&of, &images, node)).collect(),
            plain: vec![true; of.at.len()],
            unknowns: vec![(u32::MAX, 0.0); first[of.at.len()] as usize],
            first: vec![0],
            cells: Vec::new(),
            held: Vec::new(),
        };
        for leaf in plate.grid.leaves() {
            let orbit: Vec<usize> = images.iter().map(|image| image.leaf(leaf)).collect::<Option<_>>()?;
            fold.cells.extend(fold.share(leaf, orbit).map(|share| (leaf, share)));
        }
        fold.number(&of, &images)?;
        fold.hold(boundary);
        Some(fold)
    }

    /// Share in the part of the first of an orbit; of others stand the first.
    fn share(&self, own: usize, mut orbit: Vec<usize>) -> Option<f64> {
        orbit.push(own);
        orbit.sort_unstable();
        orbit.dedup();
        (orbit[0] == own).then_some(orbit.len() as f64 / self.parts() as f64)
    }

    fn number(&mut self, of: &Unknowns, images: &[Image]) -> Option<()> {
        for node in 0..self.nodes.len() {
            let next = self.first[node];
            if self.nodes[node] as usize != node {
                self.first.push(next);
                continue;
            }
            let own = of.first[node]..of.first[node + 1];
            self.first.push(next + own.len() as u32);
            for (place, unknown) in (next..).zip(own) {
                if self.unknowns[unknown as usize].0 != u32::MAX {
                    continue;
                }
                let orbit: Vec<(u32, f64)> = images.iter().map(|image| image.unknown(node, unknown)).collect();
                let stands = !orbit.contains(&(unknown, -1.0));
                for &(of, sign) in orbit.iter().chain(&[(unknown, 1.0)]) {
                    self.unknowns[of as usize] = (place, if stands { sign } else { 0.0 });
                }
            }
        }
        for node in 0..self.nodes.len() {
            let mut own = (of.first[node]..of.first[node + 1]).zip(self.first[node]..);
            let is_own = |(unknown, place): (u32, u32)| self.unknowns[unknown as usize] == (place, 1.0);
            self.plain[node] = self.nodes[node] as usize == node && own.all(is_own);
        }
        self.unknowns.iter().all(|unknown| unknown.0 != u32::MAX).then_some(())
    }

    /// Holds what the supports of the plate do, rigid motions that they leave and that are symmetric, and unknowns that vanish.
    fn hold(&mut self, boundary: &Boundary) {
        let of_support = |square: &Square| {
            let (unknowns, v) = self.row(square.unknowns.iter().copied().zip(square.v.iter().copied())).into_iter().unzip();
            Square { unknowns, v, factor: square.factor / self.parts() as f64, way: square.way }
        };
        let mut held: Vec<Square> = boundary.held.iter().map(of_support).filter(|square| !square.unknowns.is_empty()).collect();
        let pinned = match self.flips[..] {
            // A mirror leaves a displacement along its line, half a turn a turn.
            [Flip { signs, .. }] => boundary.pins[signs.iter().position(|sign| *sign > 0.0).unwrap_or(2)],
            _ => None,
        };
        let mut stands = vec![false; self.first[self.first.len() - 1] as usize];
        self.unknowns.iter().filter(|unknown| unknown.1 != 0.0).for_each(|unknown| stands[unknown.0 as usize] = true);
        let vanishing = (0..).zip(stands).filter(|(_, stands)| !stands).map(|(unknown, _)| unknown);
        let pinned = pinned.map(|unknown| self.unknowns[unknown as usize].0);
        held.extend(pinned.into_iter().chain(vanishing).map(|unknown| Square::spring(unknown, boundary.spring)));
        self.held = held;
    }

    /// Parts of the plate.
    pub fn parts(&self) -> usize {
        self.flips.len() + 1
    }

    /// The node that stands for a node.
    pub fn node(&self, node: u32) -> u32 {
        self.nodes[node as usize]
    }

    /// Whether all unknowns of a node stand for themselves.
    pub fn is_plain(&self, node: u32) -> bool {
        self.plain[node as usize]
    }

    /// The unknown that stands for one of the plate, counted from the first of its node, and its sign.
    pub fn unknown(&self, node: u32, unknown: u32) -> (u32, f64) {
        let (of, sign) = self.unknowns[unknown as usize];
        (of - self.first[self.node(node) as usize], sign)
    }

    /// Weights on unknowns as weights on those that stand for them, by their number.
    pub fn row(&self, weights: impl Iterator<Item = (u32, f64)>) -> Vec<(u32, f64)> {
        let of_standing = |(unknown, weight): (u32, f64)| {
            let (of, sign) = self.unknowns[unknown as usize];
            (of, sign * weight)
        };
        let mut terms: Vec<(u32, f64)> = weights.map(of_standing).filter(|term| term.1 != 0.0).collect();
        terms.sort_by_key(|term| term.0);
        terms.chunk_by(|a, b| a.0 == b.0).map(|same| (same[0].0, same.iter().map(|term| term.1).sum())).collect()
    }

    /// Forces on the unknowns that stand for all, `Tᵀ f` of one part.
    pub fn forces(&self, forces: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.first[self.first.len() - 1] as usize];
        for (&(of, sign), force) in self.unknowns.iter().zip(forces) {
            sums[of as usize] += sign * force / self.parts() as f64;
        }
        sums
    }

    /// All unknowns, `u = T v`.
    pub fn whole(&self, v: &[f64]) -> Vec<f64> {
        self.unknowns.iter().map(|&(of, sign)| sign * v[of as usize]).collect()
    }

    /// Of every segment its share in the part, none of one for which another stands; `None` where one has no image.
    pub fn shares(&self, segments: &[[Point; 2]]) -> Option<Vec<Option<f64>>> {
        let images: Vec<Vec<u32>> = self.flips.iter().map(|flip| partners_of_lines(segments, *flip)).collect::<Option<_>>()?;
        let share = |own: usize| self.share(own, images.iter().map(|image| image[own] as usize).collect());
        Some((0..segments.len()).map(share).collect())
    }

    /// A segment and its images.
    pub fn orbit(&self, [a, b]: [Point; 2]) -> Vec<[Point; 2]> {
        let mut orbit = vec![[a, b]];
        for flip in &self.flips {
            let (image, equal) = ([flip.image(a), flip.image(b)], EQUAL * distance(a, b));
            let is_new = |known: &[Point; 2]| distance(along(known[0], known[1], 0.5), along(image[0], image[1], 0.5)) > equal;
            if orbit.iter().all(is_new) {
                orbit.push(image);
            }
        }
        orbit
    }
}

/// The node of an orbit that stands for it: the lowest, of those the leftmost, as of cells.
fn standing(of: &Unknowns, images: &[Image], node: u32) -> u32 {
    images.iter().map(|image| image.nodes[node as usize]).fold(node, |a, b| {
        let ([xa, ya], [xb, yb]) = (of.at[a as usize], of.at[b as usize]);
        let is_level = (ya - yb).abs() <= 2.0 * of.equal[node as usize];
        if if is_level { xb < xa } else { yb < ya } { b } else { a }
    })
}

impl<'a> Image<'a> {
    /// `None` where a node, a side, a crack or a tip has no image.
    fn new(of: &'a Unknowns<'a>, flip: Flip) -> Option<Self> {
        let plate = of.plate;
        let tips: Vec<Point> = plate.axes.iter().map(|axes| axes.at).collect();
        let tips = partners(&tips, flip, |tip| EQUAL * plate.axes[tip].spacing)?;
        let cuts: Vec<[Point; 2]> =
            plate.obstacles.cuts.iter().flat_map(|cut| cut.points.windows(2)).map(|piece| [piece[0], piece[1]]).collect();
        partners_of_lines(&cuts, flip)?;
        partners_of_lines(&plate.sides, flip)?;
        // Grips are nodes of their own.
        let (inner, grips) = of.at.split_at(plate.nodes.at.len());
        let mut nodes = partners(inner, flip, |node| of.equal[node])?;
        let of_grips = partners(grips, flip, |_| of.equal[of.equal.len() - 1])?;
        let own = |node: usize| &plate.enriched[node];
        let is_alike = |node: usize| {
            let other = nodes[node] as usize;
            let [a, b] = [node, other].map(|node| plate.nodes.spacing[node]);
            let carries = |tip: &u32| own(other).contains(&tips[*tip as usize]);
            (a - b).abs() <= EQUAL * a && own(node).len() == own(other).len() && own(node).iter().all(carries)
        };
        if !(0..inner.len()).all(is_alike) {
            return None;
        }
        nodes.extend(of_grips.iter().map(|grip| grip + inner.len() as u32));
        Some(Image { of, flip, nodes, tips })
    }

    /// The cell that is the image of a cell.
    fn leaf(&self, leaf: usize) -> Option<usize> {
        let grid = &self.of.plate.grid;
        let (at, size) = (self.flip.image(grid.middle(leaf)), grid.spacing(leaf));
        let other = grid.leaf(at);
        (grid.spacing(other) == size && distance(grid.middle(other), at) <= EQUAL * size).then_some(other)
    }

    /// The image of an unknown of a node, and the sign that it has there.
    fn unknown(&self, node: usize, unknown: u32) -> (u32, f64) {
        let (other, [x, y]) = (self.nodes[node] as usize, self.flip.signs);
        let (number, first) = ((unknown - self.of.first[node]) as usize, self.of.first[other]);
        let Some(enriched) = self.of.plate.enriched.get(other).filter(|_| number >= 2) else {
            // Two displacements, and the turn of a grip.
            return (first + number as u32, [x, y, x * y][number]);
        };
        let (tip, mode) = (self.tips[self.of.plate.enriched[node][number / 2 - 1] as usize], number % 2);
        let place = enriched.iter().position(|own| *own == tip).unwrap_or_default();
        (first + (2 + 2 * place + mode) as u32, if mode == 0 { 1.0 } else { x * y })
    }

    /// Whether some forces on unknowns are the image of others.
    fn is_image(&self, forces: &[f64], image: &[f64]) -> bool {
        let largest = forces.iter().fold(0.0_f64, |largest, force| largest.max(force.abs()));
        self.each().all(|(unknown, other, sign)| (image[other] - sign * forces[unknown]).abs() <= EQUAL_FORCE * largest)
    }

    /// Every unknown, its image and the sign there.
    fn each(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        (0..self.nodes.len()).flat_map(move |node| {
            (self.of.first[node]..self.of.first[node + 1]).map(move |unknown| {
                let (other, sign) = self.unknown(node, unknown);
                (unknown as usize, other as usize, sign)
            })
        })
    }

    /// Whether supports are their own image: what they do to some displacement that nothing is symmetric of is.
    fn keeps_supports(&self, held: &[Square]) -> bool {
        let some: Vec<f64> = (0..self.of.first[self.nodes.len()]).map(|unknown| (1.618 * f64::from(unknown)).sin()).collect();
        let mut image = vec![0.0; some.len()];
        self.each().for_each(|(unknown, other, sign)| image[other] = sign * some[unknown]);
        let forces = |u: &[f64]| {
            let mut forces = vec![0.0; u.len()];
            for square in held {
                let moved = square.moved(u);
                let terms = square.unknowns.iter().zip(&square.v);
                terms.for_each(|(&unknown, v)| forces[unknown as usize] += square.factor * moved * v);
            }
            forces
        };
        self.is_image(&forces(&some), &forces(&image))
    }
}

/// Of every point the one at its image; `None` where one has none.
fn partners(points: &[Point], flip: Flip, equal: impl Fn(usize) -> f64) -> Option<Vec<u32>> {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by(|a, b| points[*a as usize][0].total_cmp(&points[*b as usize][0]));
    let partner = |(index, &point): (usize, &Point)| {
        let (at, reach) = (flip.image(point), equal(index));
        let from = order.partition_point(|&other| points[other as usize][0] < at[0] - reach);
        let near = order[from..].iter().take_while(|&&other| points[other as usize][0] <= at[0] + reach);
        near.copied().find(|&other| distance(points[other as usize], at) <= reach)
    };
    points.iter().enumerate().map(partner).collect()
}

/// Of every straight piece the one that is its image, either way; `None` where one has none.
fn partners_of_lines(lines: &[[Point; 2]], flip: Flip) -> Option<Vec<u32>> {
    let equal = |line: usize| EQUAL * distance(lines[line][0], lines[line][1]);
    let middles: Vec<Point> = lines.iter().map(|&[a, b]| along(a, b, 0.5)).collect();
    let others = partners(&middles, flip, equal)?;
    let is_image = |line: usize| {
        let ends = lines[others[line] as usize];
        lines[line].iter().all(|&at| ends.iter().any(|end| distance(*end, flip.image(at)) <= equal(line)))
    };
    (0..lines.len()).all(is_image).then_some(others)
}
