//! Contact of crack flanks, without friction.
//!
//! Every crack is divided into segments of about a local spacing. On each the mean opening `g = ∫ n·(u⁺ - u⁻) ds / l`, n the unit normal
//! of the crack, is a row G of the unknowns by the shape functions of both sides, near-tip fields included, and a pressure on both flanks
//! with the resultant λ is the force `Gᵀ λ`. Where the load presses no flanks together (`G u ≥ 0`) nothing follows. Otherwise λ ≥ 0 with
//! `g = G u + C λ ≥ 0`, `λ g = 0` is sought, `C = G K⁻¹ Gᵀ + D`: with the factor `K = L Lᵀ` at hand, C is the product of the columns
//! `Y = L⁻¹ Gᵀ` of the segments that come into contact, and the displacement becomes `L⁻ᵀ (L⁻¹ f + Y λ)`. D, a thousandth of the
//! compliance of a spacing of material, keeps C regular where segments are closer than nodes.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::boundary::{motions, summed};
use super::dissection::Factor;
use super::field::Discretisation;
use super::front::columns_product;
use super::part::Part;
use perilife_base::error::{Error, Result};
use perilife_plate::specimen::geometry::{along, direction, distance, distance_to_segment, meeting_share, segments_touch};
use perilife_plate::specimen::{Point, Specimen};

/// Overlap over the largest opening or overlap that is none: round-off.
const ROUND_OFF: f64 = 1e-3;
/// The same where contact is sought.
const ROUND_OFF_IN_CONTACT: f64 = 1e-9;
/// Turns of the active set at the most, over the number of segments: exchanged one by one nearly all of them have been wrong once.
const TURNS: usize = 10;
/// Columns that are solved for together.
const TOGETHER: usize = 16;
/// Turns without fewer wrong segments before they are exchanged one by one.
const CHANCES: usize = 5;
/// Longest segment, in local spacings.
const LENGTH_MOST: f64 = 1.5;
/// Length over the local spacing below which a piece of crack is none.
const LENGTH_LEAST: f64 = 1e-3;
/// Gauss points of a segment.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
/// Stiffness that D stands for, over that of a spacing of material: K of 100 and of 10⁸ differ by less than 0.1 %.
const STIFFNESS: f64 = 1000.0;
/// Step off the crack at which a flank is read, in local spacings.
const BESIDE: f64 = 1e-6;
/// Distance between places that are the same, in lengths of a segment.
const SAME: f64 = 1e-6;

/// A segment of crack whose flanks are in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressed {
    /// Its ends, m.
    pub ends: [Point; 2],
    /// Pressure between the flanks, Pa.
    pub pressure: f64,
}

impl Pressed {
    /// Whether a place of a crack is on the segment.
    pub fn is_on(&self, at: Point) -> bool {
        let [a, b] = self.ends;
        distance_to_segment(at, a, b) < SAME * distance(a, b)
    }

    pub fn ends_at(&self, tip: Point) -> bool {
        self.ends.iter().any(|end| distance(*end, tip) < SAME * distance(self.ends[0], self.ends[1]))
    }
}

struct Segment {
    ends: [Point; 2],
    /// Area of a flank, m².
    area: f64,
    /// Mean opening as a row of the unknowns.
    row: Vec<(u32, f64)>,
    /// Compliance that is added, m/N.
    soft: f64,
}

impl Segment {
    /// The segment between two points of a crack; `None` where a flank has no material, as beyond a mouth.
    fn new(specimen: &Specimen, plate: &Discretisation, ends: [Point; 2]) -> Option<Self> {
        let spacing = plate.grid.finest(along(ends[0], ends[1], 0.5));
        let [x, y] = direction(ends[0], ends[1]);
        let mut terms: Vec<(u32, f64)> = Vec::new();
        for share in GAUSS {
            let at = along(ends[0], ends[1], share);
            for sign in [1.0, -1.0] {
                let step = sign * BESIDE * spacing;
                let beside = [at[0] - step * y, at[1] + step * x];
                if !specimen.contains(beside) {
                    return None;
                }
                let of_point = motions(plate, beside).ok()?;
                terms.extend(of_point.iter().map(|(unknown, [u, v])| (*unknown, sign * 0.5 * (x * v - y * u))));
            }
        }
        let area = distance(ends[0], ends[1]) * specimen.thickness;
        Some(Segment { ends, area, row: summed(terms), soft: spacing / (STIFFNESS * plate.elasticity().plane_modulus * area) })
    }

    fn opening(&self, u: &[f64]) -> f64 {
        self.row.iter().map(|&(unknown, weight)| weight * u[unknown as usize]).sum()
    }
}

pub struct Contact {
    pub pressed: Vec<Pressed>,
    /// Their forces on the unknowns, N.
    pub forces: Vec<f64>,
    /// Displacement with them, m.
    pub u: Vec<f64>,
}

/// The segments of the cracks of a plate.
pub struct Flanks(Vec<Segment>);

impl Flanks {
    pub fn of(specimen: &Specimen, plate: &Discretisation) -> Flanks {
        Flanks(segments(specimen, plate))
    }

    /// Ends of the segments, m.
    pub fn ends(&self) -> Vec<[Point; 2]> {
        self.0.iter().map(|segment| segment.ends).collect()
    }

    /// Those that stand for all, as rows of the unknowns that do.
    pub fn of_part(self, part: &Part) -> Flanks {
        let of_share = |(segment, share): (Segment, Option<f64>)| {
            let (Segment { ends, area, row, soft }, share) = (segment, share?);
            Some(Segment { ends, area: share * area, row: part.row(row.into_iter()), soft: soft / share })
        };
        Flanks(self.0.into_iter().zip(part.segments.iter().copied()).filter_map(of_share).collect())
    }
}

/// Brings flanks that overlap into contact, u being the displacement of `K u = f` and y `L⁻¹ f`; `None` where none do.
/// Errors: [`Error::Mechanics`] where no set of segments is found.
pub fn press(Flanks(segments): &Flanks, factor: &Factor, y: &[f64], u: &[f64]) -> Result<Option<Contact>> {
    let free: Vec<f64> = segments.iter().map(|segment| segment.opening(u)).collect();
    let largest = free.iter().fold(0.0_f64, |largest, opening| largest.max(opening.abs()));
    if free.iter().all(|opening| *opening >= -ROUND_OFF * largest) {
        return Ok(None);
    }
    let mut compliance = Compliance::new(segments, factor, y.len());
    let mut active: Vec<usize> = (0..segments.len()).filter(|&k| free[k] < 0.0).collect();
    let (mut fewest, mut chances) = (usize::MAX, CHANCES);
    let turns = TURNS * segments.len().max(20);
    for _ in 0..turns {
        let forces = compliance.forces(&active, &free)?;
        let mut sum = y.to_vec();
        for (&k, force) in active.iter().zip(&forces) {
            sum.iter_mut().zip(compliance.column(k)).for_each(|(sum, value)| *sum += force * value);
        }
        factor.backward(&mut sum);
        let is_wrong = |k: &usize| match active.binary_search(k) {
            Ok(place) => forces[place] < 0.0,
            Err(_) => segments[*k].opening(&sum) < -ROUND_OFF_IN_CONTACT * largest,
        };
        let mut wrong: Vec<usize> = (0..segments.len()).filter(is_wrong).collect();
        if wrong.is_empty() {
            let pressed = |(&k, force): (&usize, &f64)| Pressed { ends: segments[k].ends, pressure: force / segments[k].area };
            let mut on_unknowns = vec![0.0; y.len()];
            for (&k, force) in active.iter().zip(&forces) {
                segments[k].row.iter().for_each(|&(unknown, weight)| on_unknowns[unknown as usize] += force * weight);
            }
            let pressed = active.iter().zip(&forces).map(pressed).collect();
            return Ok(Some(Contact { pressed, forces: on_unknowns, u: sum }));
        }
        // Block principal pivoting (Júdice and Pires 1994, Comput. Oper. Res. 21:587): all at once while fewer are wrong, else the last one.
        if wrong.len() < fewest {
            (fewest, chances) = (wrong.len(), CHANCES);
        } else if chances > 0 {
            chances -= 1;
        } else {
            wrong.drain(..wrong.len() - 1);
        }
        for k in wrong {
            match active.binary_search(&k) {
                Ok(place) => drop(active.remove(place)),
                Err(place) => active.insert(place, k),
            }
        }
    }
    Err(Error::Mechanics(format!(
        "crack-face contact did not converge in {turns} iterations; change model.tolerance_percent to move the nodes"
    )))
}

/// `C = G K⁻¹ Gᵀ + D` of the segments that have come into contact.
struct Compliance<'a> {
    segments: &'a [Segment],
    factor: &'a Factor,
    unknowns: usize,
    /// `L⁻¹ Gᵀ` of the segments that have been in contact so far, one after the other, and which column is that of a segment.
    columns: Vec<f64>,
    place: Vec<Option<usize>>,
    products: DMatrix<f64>,
    known: Vec<usize>,
}

impl<'a> Compliance<'a> {
    fn new(segments: &'a [Segment], factor: &'a Factor, unknowns: usize) -> Self {
        let n = segments.len();
        let (place, products) = (vec![None; n], DMatrix::zeros(n, n));
        Compliance { segments, factor, unknowns, columns: Vec::new(), place, products, known: Vec::new() }
    }

    /// `L⁻¹ Gᵀ` of a segment; nothing of one that has not been in contact yet.
    fn column(&self, segment: usize) -> &[f64] {
        self.place[segment].map_or(&[], |place| &self.columns[place * self.unknowns..(place + 1) * self.unknowns])
    }

    /// Resultants with which the active segments neither open nor overlap, N, from their openings without contact, m.
    fn forces(&mut self, active: &[usize], free: &[f64]) -> Result<Vec<f64>> {
        let new: Vec<usize> = active.iter().copied().filter(|&k| self.place[k].is_none()).collect();
        let load = |&k: &usize| {
            let mut column = vec![0.0; self.unknowns];
            self.segments[k].row.iter().for_each(|&(unknown, weight)| column[unknown as usize] = weight);
            column
        };
        let mut found: Vec<Vec<f64>> = new.iter().map(load).collect();
        found.par_chunks_mut(TOGETHER).for_each(|columns| self.factor.forward_together(columns));
        let before = self.known.len();
        for (&k, column) in new.iter().zip(&found) {
            self.place[k] = Some(self.known.len());
            self.known.push(k);
            self.columns.extend_from_slice(column);
        }
        let products = columns_product(&self.columns[before * self.unknowns..], &self.columns, self.unknowns);
        for (&k, of_k) in new.iter().zip(products.chunks_exact(self.known.len().max(1))) {
            for (&j, &value) in self.known.iter().zip(of_k) {
                (self.products[(k, j)], self.products[(j, k)]) = (value, value);
            }
        }
        let n = active.len();
        let soft = |i: usize, j: usize| if i == j { self.segments[active[i]].soft } else { 0.0 };
        let matrix = DMatrix::from_fn(n, n, |i, j| self.products[(active[i], active[j])] + soft(i, j));
        let cholesky = matrix.cholesky().ok_or_else(|| Error::Mechanics("crack-face contact cannot be solved".to_owned()))?;
        Ok(cholesky.solve(&DVector::from_fn(n, |i, _| -free[active[i]])).iter().copied().collect())
    }
}

/// Segments of the cracks that have material on both sides.
fn segments(specimen: &Specimen, plate: &Discretisation) -> Vec<Segment> {
    let cuts = &plate.obstacles.cuts[..plate.cracks];
    let mut ends: Vec<[Point; 2]> = Vec::new();
    for (own, cut) in cuts.iter().enumerate() {
        for piece in cut.points.windows(2) {
            let (a, b) = (piece[0], piece[1]);
            // Parted where another crack meets it.
            let others =
                cuts.iter().enumerate().filter(|(other, _)| *other != own).flat_map(|(_, other)| other.points.windows(2));
            let meets = others.filter(|other| segments_touch(a, b, other[0], other[1]));
            let mut shares: Vec<f64> = meets.filter_map(|other| meeting_share(a, b, other[0], other[1])).collect();
            shares.retain(|share| (0.0..1.0).contains(share));
            shares.extend([0.0, 1.0]);
            shares.sort_by(f64::total_cmp);
            for pair in shares.windows(2) {
                let [a, b] = [0, 1].map(|i| along(a, b, pair[i]));
                if distance(a, b) >= LENGTH_LEAST * plate.grid.finest(along(a, b, 0.5)) {
                    divide(plate, [a, b], &mut ends);
                }
            }
        }
    }
    ends.par_iter().filter_map(|&ends| Segment::new(specimen, plate, ends)).collect()
}

/// Halves a stretch of crack until no part is longer than it may be by the finest spacing at its ends and middle.
fn divide(plate: &Discretisation, [a, b]: [Point; 2], ends: &mut Vec<[Point; 2]>) {
    let spacing = |at: f64| plate.grid.finest(along(a, b, at));
    if distance(a, b) > LENGTH_MOST * [0.1, 0.5, 0.9].into_iter().map(spacing).fold(f64::INFINITY, f64::min) {
        let middle = along(a, b, 0.5);
        divide(plate, [a, middle], ends);
        divide(plate, [middle, b], ends);
    } else {
        ends.push([a, b]);
    }
}
