//! Mirror symmetry: the part of a plate that stands for the whole.
//!
//! A plate that is symmetric about a line, with its cracks and loads, moves symmetrically. Its half then says everything: a bond
//! across the line has as its other end the mirror image of a point of the half. Images stand in the padding of the half's
//! lattice, before its first column or row, so that every bond keeps its place in memory; only what they carry is taken from
//! the points they are images of. The stiffness of the half is that of the plate over symmetric displacements, exactly: half
//! of the energy, or a quarter with two lines.
//!
//! Where the line runs through a row of points, each bond along it belongs half to either side, a point of it keeps the bonds to
//! its own side alone, and its motion across the line and its rotation are held at zero.

use std::collections::HashMap;

use rayon::prelude::*;

use super::boundary::Boundary;
use super::lattice::{LANES, Lattice};
use super::{Body, Bond};

/// Where a line of symmetry lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// Half a spacing before the first column or row.
    Between,
    /// Through the first column or row.
    Through,
}

/// Lines of symmetry before the first column and before the first row of a lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Mirror {
    /// Across the rows (images to the left) and across the columns (images below).
    pub lines: [Option<Line>; 2],
}

/// Whether something is mirrored along the rows and along the columns.
pub type Flips = [bool; 2];

/// Signs of a mirrored point's displacements and rotation.
pub fn signs(flips: Flips) -> [f64; 3] {
    let sign = |flip: bool| if flip { -1.0 } else { 1.0 };
    [sign(flips[0]), sign(flips[1]), sign(flips[0] != flips[1])]
}

impl Line {
    /// Column or row whose image is `steps` >= 1 before the first.
    pub fn source(self, steps: usize) -> usize {
        match self {
            Line::Between => steps - 1,
            Line::Through => steps,
        }
    }
}

impl Mirror {
    /// Parts of this size that make up the plate.
    pub fn copies(self) -> usize {
        1 << self.lines.iter().flatten().count()
    }

    /// The point that stands behind a place of the lattice: the place itself, or what it is the image of.
    pub fn behind(self, lattice: &Lattice, place: usize) -> (usize, Flips) {
        if self.lines == [None; 2] {
            return (place, [false; 2]);
        }
        let seat = [place % lattice.stride, place / lattice.stride];
        let mut flips = [false; 2];
        let [column, row] = [0, 1].map(|axis| match self.lines[axis] {
            Some(line) if seat[axis] < lattice.padding => {
                flips[axis] = true;
                line.source(lattice.padding - seat[axis]) + lattice.padding
            }
            _ => seat[axis],
        });
        (row * lattice.stride + column, flips)
    }

    /// The lines about which a plate is symmetric: its points, bonds, loads and supports, to round-off, and which of its bonds
    /// are left, by their multipliers.
    pub fn of(body: &Body, multiplier: &[f32]) -> Mirror {
        let lines = [0, 1].map(|axis| {
            let count = if axis == 0 { body.lattice.columns } else { body.lattice.rows };
            let is_wide = count >= 2 * (body.lattice.padding + 1);
            // The stress of a state-based point is stored whole or not at all.
            let has_middle = count % 2 == 0 || body.stencil.dilatation == 0.0;
            let line = if count % 2 == 0 { Line::Between } else { Line::Through };
            let intact = |bond: usize| multiplier[bond] > 0.0;
            let alike = |bond: usize, image: usize| {
                let [here, there] = [bond, image].map(|bond| f64::from(body.multiplier[bond]));
                close(here, there, here) && intact(bond) == intact(image)
            };
            let keeps = |reflection: Reflection| reflection.keeps(body) && reflection.keeps_bonds(body, alike);
            (is_wide && has_middle && keeps(Reflection::new(body, axis))).then_some(line)
        });
        Mirror { lines }
    }
}

/// Relative difference of two stiffnesses, or two forces, that are equal but for the order of sums.
const EQUAL: f64 = 1e-6;

/// A plate turned over about the middle of its lattice.
#[derive(Debug)]
pub struct Reflection {
    axis: usize,
    /// Last column (axis 0) or row, added to the first.
    ends: usize,
    stride: usize,
    places: usize,
    /// For each stencil bond, that of its image, and whether the image belongs to the image of the other end.
    bonds: Vec<(usize, bool)>,
}

impl Reflection {
    /// Turns columns (axis 0) or rows (axis 1) over.
    pub fn new(body: &Body, axis: usize) -> Self {
        let lattice = &body.lattice;
        let count = if axis == 0 { lattice.columns } else { lattice.rows };
        let bonds = body.stencil.bonds.iter().map(|bond| {
            let mut step = [bond.dx, bond.dy];
            step[axis] = -step[axis];
            let find = |step: [i32; 2]| body.stencil.bonds.iter().position(|other| [other.dx, other.dy] == step);
            // The stencil holds one of every two opposite bonds, and is itself symmetric.
            find(step).map_or_else(|| (find(step.map(|s| -s)).unwrap_or(0), true), |k| (k, false))
        });
        let (bonds, ends) = (bonds.collect(), 2 * lattice.padding + count - 1);
        Reflection { axis, ends, stride: lattice.stride, places: body.places(), bonds }
    }

    pub fn place(&self, place: usize) -> usize {
        self.seat([place % self.stride, place / self.stride])
    }

    /// Image of the place with this padded column and row.
    fn seat(&self, [column, row]: [usize; 2]) -> usize {
        if self.axis == 0 { row * self.stride + self.ends - column } else { (self.ends - row) * self.stride + column }
    }

    pub fn bond(&self, body: &Body, bond: Bond) -> Bond {
        let (k, from, to) = body.ends(bond);
        let (image, swaps) = self.bonds[k];
        (image * self.places + self.place(if swaps { to } else { from })) as Bond
    }

    /// Whether the points, loads and supports of a plate are their own image.
    fn keeps(&self, body: &Body) -> bool {
        let boundary = &body.boundary;
        // Couples change their sign in any mirror.
        let couples: Vec<(u32, [f64; 2])> = boundary
            .couples
            .iter()
            .map(|&(place, couple)| (place, [0, 1].map(|c| if c == self.axis { couple } else { 0.0 })))
            .collect();
        let points = body.points.iter().all(|&place| body.is_point[self.place(place as usize)]);
        points && self.keeps_vectors(&boundary.forces) && self.keeps_vectors(&couples) && self.keeps_supports(body)
    }

    /// Whether `same(bond, image)` for every bond of the plate.
    fn keeps_bonds(&self, body: &Body, same: impl Fn(usize, usize) -> bool + Sync) -> bool {
        let lattice = &body.lattice;
        (0..body.steps.len()).into_par_iter().all(|k| {
            let (image, swaps) = self.bonds[k];
            let step = if swaps { [body.stencil.bonds[k].dx, body.stencil.bonds[k].dy] } else { [0; 2] };
            // Bonds reach no farther than the padding is wide.
            let seat = |at: usize, step: i32| (at + lattice.padding).wrapping_add_signed(step as isize);
            (0..lattice.rows).all(|row| {
                let first = k * self.places + lattice.place(0, row);
                (0..lattice.columns).filter(|column| body.multiplier[first + column] > 0.0).all(|column| {
                    let end = [seat(column, step[0]), seat(row, step[1])];
                    same(first + column, image * self.places + self.seat(end))
                })
            })
        })
    }

    /// Whether every vector has its image, the component across the mirror turned over.
    fn keeps_vectors(&self, vectors: &[(u32, [f64; 2])]) -> bool {
        let largest = vectors.iter().map(|(_, v)| v[0].hypot(v[1])).fold(0.0, f64::max);
        let at: HashMap<u32, [f64; 2]> = vectors.iter().copied().collect();
        vectors.iter().all(|&(place, mut vector)| {
            vector[self.axis] = -vector[self.axis];
            let image = at.get(&(self.place(place as usize) as u32)).copied().unwrap_or([0.0; 2]);
            (0..2).all(|c| close(vector[c], image[c], largest))
        })
    }

    fn keeps_supports(&self, body: &Body) -> bool {
        let up = body.lattice.to_axes([0.0, 1.0]);
        let grips: Vec<(u32, [f64; 2])> =
            body.boundary.clamped.iter().map(|&(place, side)| (place, up.map(|u| side * u))).collect();
        let held: HashMap<u32, [bool; 3]> = body.boundary.fixed.iter().copied().collect();
        let supports = held.iter().all(|(&place, held_here)| held.get(&(self.place(place as usize) as u32)) == Some(held_here));
        supports && self.keeps_vectors(&grips)
    }
}

fn close(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= EQUAL * scale
}

/// The part of a symmetric plate that stands for all of it.
#[derive(Debug)]
pub struct MirrorPart {
    /// The part, its lattice beginning at the lines of symmetry.
    pub body: Body,
    /// First column and row of the part in the lattice of the plate.
    first: [usize; 2],
    reflections: Vec<Reflection>,
}

impl MirrorPart {
    /// The smallest part of a plate about whose lines `mirror` it is symmetric; `None` without any.
    pub fn of(whole: &Body, mirror: Mirror) -> Option<MirrorPart> {
        if mirror == Mirror::default() {
            return None;
        }
        let first = [(0, whole.lattice.columns), (1, whole.lattice.rows)].map(|(axis, count)| match mirror.lines[axis] {
            Some(Line::Between) => count / 2,
            Some(Line::Through) => (count - 1) / 2,
            None => 0,
        });
        let (columns, rows) = (whole.lattice.columns - first[0], whole.lattice.rows - first[1]);
        let padding = whole.lattice.padding;
        let lattice = Lattice {
            columns,
            rows,
            origin: whole.lattice.position_of(first[0] as f64, first[1] as f64),
            stride: columns.next_multiple_of(LANES) + 2 * padding,
            ..whole.lattice.clone()
        };
        let steps = whole.stencil.bonds.iter().map(|bond| lattice.step(bond.dx, bond.dy)).collect();
        let places = lattice.places();
        let mut body = Body {
            stencil: whole.stencil.clone(),
            steps,
            points: Vec::new(),
            is_point: vec![false; places],
            multiplier: Vec::new(),
            pre_cut: Vec::new(),
            no_fail: vec![false; places],
            boundary: Boundary::default(),
            bond_count: 0,
            thickness: whole.thickness,
            mirror,
            lattice,
        };
        for row in 0..rows {
            for column in 0..columns {
                let (here, there) = (body.lattice.place(column, row), whole.lattice.place(column + first[0], row + first[1]));
                body.is_point[here] = whole.is_point[there];
                body.no_fail[here] = whole.no_fail[there];
                if whole.is_point[there] {
                    body.points.push(here as u32);
                }
            }
        }
        let reflections = (0..2).filter(|&axis| mirror.lines[axis].is_some()).map(|axis| Reflection::new(whole, axis)).collect();
        let mut part = MirrorPart { body, first, reflections };
        part.body.multiplier = part.multiplier(whole, &whole.multiplier);
        part.body.bond_count = part.body.multiplier.iter().filter(|&&m| m > 0.0).count();
        let seat = |place: u32| <[usize; 2]>::from(part.body.lattice.column_row(place as usize));
        let through = (0..2).filter(|&axis| part.body.mirror.lines[axis] == Some(Line::Through));
        let on = |axis: usize| part.body.points.iter().filter(move |&&p| seat(p)[axis] == 0).map(move |&p| (p, axis));
        let on_axes: Vec<(u32, usize)> = through.flat_map(on).collect();
        part.body.boundary = whole.boundary.of_part(&on_axes, |place| part.place(whole, place));
        part.body.pre_cut = whole.pre_cut.iter().filter_map(|&bond| part.bond(whole, bond)).collect();
        Some(part)
    }

    /// The part's place that a place of the plate is, if it is one of its points.
    pub fn place(&self, whole: &Body, place: usize) -> Option<usize> {
        let (column, row) = whole.lattice.column_row(place);
        let (column, row) = (column.checked_sub(self.first[0])?, row.checked_sub(self.first[1])?);
        Some(self.body.lattice.place(column, row))
    }

    /// The place of the part that a place of the plate is or is the image of, and what weights on the displacements of the latter are on
    /// those of the former.
    pub fn weights_of(&self, whole: &Body, place: usize, weights: [f64; 2]) -> (u32, [f64; 2]) {
        let seat = <[usize; 2]>::from(whole.lattice.column_row(place));
        let count = [whole.lattice.columns, whole.lattice.rows];
        let flips = [0, 1].map(|axis| seat[axis] < self.first[axis]);
        let [column, row] = [0, 1].map(|axis| {
            let own = if flips[axis] { count[axis] - 1 - seat[axis] } else { seat[axis] };
            own - self.first[axis]
        });
        let signs = signs(flips);
        (self.body.lattice.place(column, row) as u32, [0, 1].map(|axis| signs[axis] * weights[axis]))
    }

    /// Places of the plate that a point of the part stands for, itself among them, with how each is mirrored.
    pub fn images(&self, whole: &Body, place: usize) -> impl Iterator<Item = (usize, Flips)> + use<> {
        let (column, row) = self.body.lattice.column_row(place);
        let own = whole.lattice.place(column + self.first[0], row + self.first[1]);
        self.orbit((own, [false; 2]), |reflection, (place, mut flips)| {
            flips[reflection.axis] = true;
            (reflection.place(place), flips)
        })
    }

    /// Something of the plate and its mirror images.
    fn orbit<T: Copy>(&self, one: T, reflect: impl Fn(&Reflection, T) -> T) -> std::iter::Take<std::array::IntoIter<T, 4>> {
        let (mut images, mut count) = ([one; 4], 1);
        for reflection in &self.reflections {
            for i in 0..count {
                images[count + i] = reflect(reflection, images[i]);
            }
            count *= 2;
        }
        images.into_iter().take(count)
    }

    /// The part's bond that stands for a bond of the plate: of the same place where that has a point of the part at one end. A bond
    /// across a line has two names in the part, one from either end.
    pub fn bond(&self, whole: &Body, bond: Bond) -> Option<Bond> {
        let (k, from, to) = whole.ends(bond);
        if self.place(whole, from).is_none() && self.place(whole, to).is_none() {
            return None;
        }
        let (stride, here) = (whole.lattice.stride, &self.body.lattice);
        // Padded seats: images of the part's points stand in its padding.
        let (column, row) = ((from % stride).checked_sub(self.first[0])?, (from / stride).checked_sub(self.first[1])?);
        Some((k * self.body.places() + row * here.stride + column) as Bond)
    }

    /// The bonds of the part that stand for some bonds of the plate, each under one name, ascending.
    pub fn bonds(&self, whole: &Body, bonds: &[Bond]) -> Vec<Bond> {
        let mut found: Vec<Bond> = bonds
            .iter()
            .filter_map(|&bond| {
                // Every bond has an image with an end in the part.
                let images = self.orbit(bond, |reflection, bond| reflection.bond(whole, bond));
                images.filter_map(|image| self.bond(whole, image)).min()
            })
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Whether the mirror images of all these bonds are among them.
    pub fn keeps(&self, whole: &Body, bonds: &[Bond]) -> bool {
        let all: std::collections::HashSet<Bond> = bonds.iter().copied().collect();
        self.reflections.iter().all(|reflection| bonds.iter().all(|&bond| all.contains(&reflection.bond(whole, bond))))
    }

    /// Stiffness multipliers of the part's bonds, from those of the plate.
    pub fn multiplier(&self, whole: &Body, of_whole: &[f32]) -> Vec<f32> {
        let (here, there) = (&self.body.lattice, &whole.lattice);
        let padding = here.padding;
        let (width, height) = (here.columns + 2 * padding, here.rows + 2 * padding);
        let mut multiplier = vec![0.0; here.places() * self.body.steps.len()];
        for (k, bond) in self.body.stencil.bonds.iter().enumerate() {
            for row in 0..height {
                let from = k * there.places() + (row + self.first[1]) * there.stride + self.first[0];
                let to = k * here.places() + row * here.stride;
                let target = &mut multiplier[to..to + width];
                target.copy_from_slice(&of_whole[from..from + width]);
                // Only near the lines does a bond belong to the part by another share than whole.
                let near_line = if row < 2 * padding { width } else { (2 * padding).min(width) };
                for (column, value) in target[..near_line].iter_mut().enumerate().filter(|(_, value)| **value != 0.0) {
                    *value *= self.share([column, row], [bond.dx, bond.dy]);
                }
            }
        }
        multiplier
    }

    /// The names in the part of some bonds of the plate and of their images, and the multiplier that all of them have by the plate's:
    /// that of one image, since round-off may tell them apart, and the stiffness of the part has to be symmetric.
    pub fn multipliers_of(&self, whole: &Body, bonds: &[Bond], of_whole: &[f32]) -> Vec<(Bond, f32)> {
        let stride = self.body.lattice.stride;
        let mut found = Vec::new();
        for &bond in bonds {
            let images = self.orbit(bond, |reflection, bond| reflection.bond(whole, bond));
            let multiplier = images.clone().min().map_or(0.0, |first| of_whole[first as usize]);
            for name in images.filter_map(|image| self.bond(whole, image)) {
                let (k, seat) = (name as usize / self.body.places(), name as usize % self.body.places());
                let step = &self.body.stencil.bonds[k];
                found.push((name, multiplier * self.share([seat % stride, seat / stride], [step.dx, step.dy])));
            }
        }
        found
    }

    /// Share of the plate's bond between a padded seat of the part and the neighbour at `step` that the rows of the part's stiffness have.
    fn share(&self, seat: [usize; 2], step: [i32; 2]) -> f32 {
        let padding = self.body.lattice.padding as i32;
        let ends = [0, 1].map(|axis| (seat[axis] as i32 - padding, seat[axis] as i32 - padding + step[axis]));
        let (mut share, mut images) = (1.0, [false; 2]);
        for (axis, &(a, b)) in ends.iter().enumerate() {
            let Some(line) = self.body.mirror.lines[axis] else { continue };
            images = [images[0] || a < 0, images[1] || b < 0];
            if line == Line::Through {
                share *= match (a.min(b), a.max(b)) {
                    (0, 0) => 0.5,
                    (..0, 0) => 0.0,
                    _ => 1.0,
                };
            }
        }
        if images == [true; 2] { 0.0 } else { share }
    }
}
