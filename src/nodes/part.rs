//! The part of a plate that stands for it: all of it, or a half or a quarter of one that is its own image.
//!
//! A plate that a mirror about a line through its middle, both such lines or half a turn leave as it is, with its cracks, nodes, supports and
//! loads, moves symmetrically: an unknown equals, but for its sign, that of every image of its node, and one whose image is its own opposite
//! vanishes. With `u = T v` the energy `½ uᵀ K u` is that of the cells of one part, times the number of parts: `Tᵀ K T` is summed over these
//! cells alone, whose rows of strain go to the unknowns v.
//!
//! Modes I and II of a tip are even and odd in a mirror, and both turn with the plate.

use super::boundary::{Boundary, Square, UNKNOWNS_OF_GRIP, summed};
use super::field::Discretisation;
use super::grid::Grid;
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
    /// First unknown of each, and their number.
    first: Vec<u32>,
}

/// An image of a plate: which node, tip, cell and segment of its cracks is that of each.
struct Image<'a> {
    of: &'a Unknowns<'a>,
    flip: Flip,
    nodes: Vec<u32>,
    tips: Vec<u32>,
    leaves: Vec<usize>,
    segments: Vec<u32>,
}

/// Which cells are solved for, and which unknowns stand for all.
#[derive(Debug)]
pub struct Part {
    /// Images of the plate but for itself; none of one that is solved whole.
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
    /// The share that belongs to it of every segment of cracks, none of one for which another stands.
    pub segments: Vec<Option<f64>>,
    /// Supports, what holds rigid motions that are symmetric, and unknowns that vanish.
    pub held: Vec<Square>,
}

impl Part {
    /// Of a plate with these `segments` of cracks under these `forces`; all of it if it is no image of itself, or `is_whole`.
    pub fn of(
        (specimen, plate): (&Specimen, &Discretisation),
        boundary: &Boundary,
        forces: [&[f64]; 2],
        segments: &[[Point; 2]],
        is_whole: bool,
    ) -> Part {
        let [low, high] = bounding_box(&specimen.outline);
        let (size, middle) = (distance(low, high), along(low, high, 0.5));
        let of = Unknowns::new(plate, &boundary.grips, size);
        let keeps =
            |image: &Image| forces.iter().all(|forces| image.is_image(forces, forces)) && image.keeps_supports(&boundary.held);
        let image = |signs| Image::new(&of, Flip { middle, signs }, segments).filter(keeps);
        let mut images: Vec<Image> = Vec::new();
        if !is_whole {
            images.extend([[-1.0, 1.0], [1.0, -1.0]].into_iter().filter_map(image));
            if images.len() != 1 {
                images.extend(image([-1.0, -1.0]));
            }
            // Of both mirrors and half a turn each is the other two.
            if images.len() == 2 {
                images.clear();
            }
        }
        let nodes = standing(&of, &images, EQUAL * size);
        let mut part = Part {
            flips: images.iter().map(|image| image.flip).collect(),
            plain: vec![true; nodes.len()],
            nodes,
            unknowns: vec![(u32::MAX, 0.0); of.first[of.at.len()] as usize],
            first: vec![0],
            cells: Vec::new(),
            segments: Vec::new(),
            held: Vec::new(),
        };
        let share_of_cell =
            |(k, leaf): (usize, usize)| Some((leaf, part.share(leaf, images.iter().map(|image| image.leaves[k]).collect())?));
        let cells = plate.grid.leaves().enumerate().filter_map(share_of_cell).collect();
        let share_of_segment = |k: usize| part.share(k, images.iter().map(|image| image.segments[k] as usize).collect());
        let segments = (0..segments.len()).map(share_of_segment).collect();
        (part.cells, part.segments) = (cells, segments);
        part.number(&of, &images);
        part.hold(boundary);
        part
    }

    /// Share in the part of the first of an orbit; of others stand the first.
    fn share(&self, own: usize, mut orbit: Vec<usize>) -> Option<f64> {
        orbit.push(own);
        orbit.sort_unstable();
        orbit.dedup();
        (orbit[0] == own).then_some(orbit.len() as f64 / self.parts() as f64)
    }

    fn number(&mut self, of: &Unknowns, images: &[Image]) {
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
    }

    /// Holds what the supports of the plate do, rigid motions that they leave and that are symmetric, and unknowns that vanish.
    fn hold(&mut self, boundary: &Boundary) {
        let of_support = |square: &Square| {
            let (unknowns, v) = self.row(square.unknowns.iter().copied().zip(square.v.iter().copied())).into_iter().unzip();
            Square { unknowns, v, factor: square.factor / self.parts() as f64, way: square.way }
        };
        let mut held: Vec<Square> = boundary.held.iter().map(of_support).filter(|square| !square.unknowns.is_empty()).collect();
        let pinned = match self.flips[..] {
            [] => boundary.pins,
            // A mirror leaves a displacement along its line, half a turn a turn.
            [Flip { signs, .. }] => {
                let free = signs.iter().position(|sign| *sign > 0.0).unwrap_or(2);
                [0, 1, 2].map(|pin| boundary.pins[pin].filter(|_| pin == free))
            }
            _ => [None; 3],
        };
        let mut stands = vec![false; self.first[self.first.len() - 1] as usize];
        self.unknowns.iter().filter(|unknown| unknown.1 != 0.0).for_each(|unknown| stands[unknown.0 as usize] = true);
        let vanishing = (0..).zip(stands).filter(|(_, stands)| !stands).map(|(unknown, _)| unknown);
        let pinned = pinned.iter().flatten().map(|unknown| self.unknowns[*unknown as usize].0);
        held.extend(pinned.chain(vanishing).map(|unknown| Square::spring(unknown, boundary.spring)));
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
        summed(weights.map(of_standing).filter(|term| term.1 != 0.0).collect())
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

/// Of every node that which stands for it: the lowest of its images, of those as low within `level`, m, the leftmost, as of cells.
fn standing(of: &Unknowns, images: &[Image], level: f64) -> Vec<u32> {
    let row = |node: u32| (of.at[node as usize][1] / level).round();
    let mut order: Vec<u32> = (0..of.at.len() as u32).collect();
    let left = |node: u32| of.at[node as usize][0];
    order.sort_by(|&a, &b| row(a).total_cmp(&row(b)).then(left(a).total_cmp(&left(b))));
    let mut standing = vec![u32::MAX; order.len()];
    for node in order {
        if standing[node as usize] == u32::MAX {
            standing[node as usize] = node;
            images.iter().for_each(|image| standing[image.nodes[node as usize] as usize] = node);
        }
    }
    standing
}

impl<'a> Unknowns<'a> {
    fn new(plate: &'a Discretisation, grips: &[Point], size: f64) -> Self {
        let mut equal: Vec<f64> = plate.nodes.spacing.iter().map(|spacing| EQUAL * spacing).collect();
        equal.extend(grips.iter().map(|_| EQUAL * size));
        let of_grips = (1..=grips.len()).map(|grip| (plate.unknowns() + grip * UNKNOWNS_OF_GRIP) as u32);
        let first = plate.first.iter().copied().chain(of_grips).collect();
        Unknowns { plate, at: plate.nodes.at.iter().chain(grips).copied().collect(), equal, first }
    }
}

impl<'a> Image<'a> {
    /// `None` where a node, a tip, a cell, a side or a crack has no image.
    fn new(of: &'a Unknowns<'a>, flip: Flip, segments: &[[Point; 2]]) -> Option<Self> {
        let plate = of.plate;
        let tips: Vec<Point> = plate.axes.iter().map(|axes| axes.at).collect();
        let tips = partners(&tips, flip, |tip| EQUAL * plate.axes[tip].spacing)?;
        let cuts: Vec<[Point; 2]> =
            plate.obstacles.cuts.iter().flat_map(|cut| cut.points.windows(2)).map(|piece| [piece[0], piece[1]]).collect();
        partners_of_lines(&cuts, flip)?;
        partners_of_lines(&plate.sides, flip)?;
        let segments = partners_of_lines(segments, flip)?;
        let leaves = plate.grid.leaves().map(|leaf| image_of_leaf(&plate.grid, flip, leaf)).collect::<Option<_>>()?;
        // Grips are nodes of their own.
        let (inner, grips) = of.at.split_at(plate.nodes.at.len());
        let mut nodes = partners(inner, flip, |node| of.equal[node])?;
        let of_grips = partners(grips, flip, |grip| of.equal[inner.len() + grip])?;
        let own = |node: usize| &plate.enriched[node];
        let is_alike = |node: usize| {
            let other = nodes[node] as usize;
            let [a, b] = [node, other].map(|node| plate.nodes.spacing[node]);
            let carries = |tip: &u32| own(other).contains(&tips[*tip as usize]);
            let is_returned = nodes[other] as usize == node && (a - b).abs() <= EQUAL * a;
            is_returned && own(node).len() == own(other).len() && own(node).iter().all(carries)
        };
        if !(0..inner.len()).all(is_alike) {
            return None;
        }
        nodes.extend(of_grips.iter().map(|grip| grip + inner.len() as u32));
        Some(Image { of, flip, nodes, tips, leaves, segments })
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

/// The cell that is the image of a cell.
fn image_of_leaf(grid: &Grid, flip: Flip, leaf: usize) -> Option<usize> {
    let (at, size) = (flip.image(grid.middle(leaf)), grid.spacing(leaf));
    let other = grid.leaf(at);
    (grid.spacing(other) == size && distance(grid.middle(other), at) <= EQUAL * size).then_some(other)
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
