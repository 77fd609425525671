//! Stiffness matrix and loads.
//!
//! `K_ab = h ∫ e_aᵀ D e_b dA` with e the strain of an unknown, `f_a = Σ F · u_a` over the loads. The matrix of a cell is one of all
//! unknowns in reach; columns of the whole are gathered from those of the cells, each by itself, so that sums do not depend on the
//! number of threads.

use std::collections::HashMap;

use rayon::prelude::*;

use super::cells::{Dividers, QuadraturePoint, divided, whole};
use super::field::{Discretisation, Local, TipFields, singular};
use super::matrix::Element;
use super::nodes::by_leaf;
use super::rims::Side;
use super::shape::Value;
use crate::error::Result;
use crate::specimen::{Point, Specimen};

/// Area of points that may be left out where nodes in reach do not span the basis, over that of a cell: in the wedge between a slant
/// crack and the edge that it starts from, which carries nothing.
const LEFT_OUT: f64 = 0.25;

/// Distance of a tip from a cell, in its spacings, within which the cell is integrated as one with a tip, at the point nearest to it: 1/r
/// a thousandth of a spacing beyond a side leaves K 2 % wrong by 3 × 3 points.
const BESIDE_TIP: f64 = 0.3;

/// Points of integration of every cell with material.
#[must_use]
pub fn quadrature(specimen: &Specimen, plate: &Discretisation) -> Vec<(usize, Vec<QuadraturePoint>)> {
    let grid = &plate.grid;
    let near_sides = by_leaf(grid, plate.sides.iter().map(|side| side.ends), 0.0);
    let pieces: Vec<[Point; 2]> =
        plate.obstacles.cuts.iter().flat_map(|cut| cut.points.windows(2)).map(|piece| [piece[0], piece[1]]).collect();
    let near_pieces = by_leaf(grid, pieces.iter().copied(), 0.0);
    let mut tips: HashMap<usize, Vec<(Point, Point)>> = HashMap::new();
    for axes in &plate.axes {
        let reach = BESIDE_TIP * axes.spacing;
        grid.visit(axes.at.map(|x| x - reach), axes.at.map(|x| x + reach), &mut |leaf| {
            let [low, high] = grid.bounds(leaf);
            let nearest = [0, 1].map(|i| axes.at[i].clamp(low[i], high[i]));
            tips.entry(leaf).or_default().push((nearest, axes.ahead));
        });
    }
    let leaves: Vec<usize> = grid.leaves().collect();
    let of_leaf = |&leaf: &usize| {
        let sides: Vec<Side> = near_sides.get(&leaf).into_iter().flatten().map(|&side| plate.sides[side as usize]).collect();
        let cracks: Vec<[Point; 2]> = near_pieces.get(&leaf).into_iter().flatten().map(|&piece| pieces[piece as usize]).collect();
        let at_tips = tips.get(&leaf).cloned().unwrap_or_default();
        let points = if sides.is_empty() && cracks.is_empty() && at_tips.is_empty() {
            if specimen.contains(grid.middle(leaf)) { whole(grid, leaf) } else { Vec::new() }
        } else {
            divided(specimen, grid, leaf, Dividers { sides: &sides, cracks: &cracks, tips: &at_tips })
        };
        (!points.is_empty()).then_some((leaf, points))
    };
    leaves.par_iter().filter_map(of_leaf).collect()
}

/// What is reused from cell to cell.
#[derive(Debug, Default)]
pub struct Scratch {
    local: Local,
    /// Values at all points of a cell, and where those of each end, with its area.
    values: Vec<Value>,
    ends: Vec<(usize, f64)>,
    /// Near-tip fields at the points, all tips of a point together.
    fields: Vec<Option<TipFields>>,
    /// First unknown of the cell of every node of the plate that it holds.
    place: Vec<u32>,
    nodes: Vec<u32>,
    strains: Vec<f64>,
    stresses: Vec<f64>,
}

impl Scratch {
    /// For a plate of so many nodes.
    #[must_use]
    pub fn of(nodes: usize) -> Self {
        Scratch { place: vec![u32::MAX; nodes], ..Scratch::default() }
    }

    /// Takes the shape functions at all points.
    fn read(&mut self, plate: &Discretisation, leaf: usize, points: &[QuadraturePoint]) -> Result<()> {
        let (mut left_out, size) = (0.0, plate.grid.spacing(leaf));
        self.values.clear();
        self.ends.clear();
        self.fields.clear();
        for point in points {
            if !plate.at(leaf, point.at, &mut self.local) {
                left_out += point.area;
                if left_out > LEFT_OUT * size * size {
                    return Err(singular(point.at, plate.reach(leaf)));
                }
                continue;
            }
            self.values.extend_from_slice(&self.local.values);
            self.ends.push((self.values.len(), point.area));
            self.fields.extend_from_slice(&self.local.fields);
        }
        Ok(())
    }

    /// Numbers the nodes in reach of any point; gives their unknowns.
    fn number(&mut self, plate: &Discretisation, unknowns: &mut Vec<u32>) {
        self.nodes.clear();
        for value in &self.values {
            let place = &mut self.place[value.node as usize];
            if *place == u32::MAX {
                *place = 0;
                self.nodes.push(value.node);
            }
        }
        self.nodes.sort_unstable();
        unknowns.clear();
        for &node in &self.nodes {
            self.place[node as usize] = unknowns.len() as u32;
            unknowns.extend(plate.first[node as usize]..plate.first[node as usize + 1]);
        }
    }
}

/// Matrix of a cell.
///
/// # Errors
/// Nodes in reach of a point do not span the basis.
pub fn of_cell(
    plate: &Discretisation,
    thickness: f64,
    (leaf, points): (usize, &[QuadraturePoint]),
    scratch: &mut Scratch,
    element: &mut Element,
) -> Result<()> {
    scratch.read(plate, leaf, points)?;
    scratch.number(plate, &mut element.unknowns);
    let (n, tips) = (element.unknowns.len(), plate.axes.len());
    let Scratch { values, ends, fields, place, nodes, strains, stresses, .. } = scratch;
    for rows in [&mut *strains, &mut *stresses] {
        rows.clear();
        rows.resize(3 * n * ends.len(), 0.0);
    }
    // Stress of unit strains.
    let elasticity = plate.elasticity();
    let [direct, lateral, _] = elasticity.stress(&[[1.0, 0.0], [0.0, 0.0]]);
    let shear = elasticity.shear_modulus;
    let mut first_value = 0;
    for (index, &(end, area)) in ends.iter().enumerate() {
        let row = 3 * index * n;
        let factor = thickness * area;
        let [direct, lateral, shear] = [direct, lateral, shear].map(|modulus| factor * modulus);
        let mut set = |unknown: usize, [xx, yy, xy]: [f64; 3]| {
            let [a, b, c] = [row + unknown, row + n + unknown, row + 2 * n + unknown];
            (strains[a], strains[b], strains[c]) = (xx, yy, xy);
            (stresses[a], stresses[b], stresses[c]) = (direct * xx + lateral * yy, lateral * xx + direct * yy, shear * xy);
        };
        for value in &values[first_value..end] {
            let first = place[value.node as usize] as usize;
            let [x, y] = value.gradient;
            set(first, [x, 0.0, y]);
            set(first + 1, [0.0, y, x]);
            for (k, &tip) in plate.enriched[value.node as usize].iter().enumerate() {
                let Some(fields) = &fields[index * tips + tip as usize] else { continue };
                for (mode, (field, slope)) in fields.iter().enumerate() {
                    let product = |i: usize, j: usize| field[i] * value.gradient[j] + value.value * slope[i][j];
                    set(first + 2 + 2 * k + mode, [product(0, 0), product(1, 1), product(0, 1) + product(1, 0)]);
                }
            }
        }
        first_value = end;
    }
    nodes.iter().for_each(|&node| place[node as usize] = u32::MAX);
    element.take_product(strains, stresses);
    Ok(())
}
