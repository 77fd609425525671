//! Stiffness matrices of cells.
//!
//! `K_ab = h ∫ e_aᵀ D e_b dA` with e the strain of an unknown. The matrix of a cell is one of all unknowns in reach, and goes straight
//! to the dense matrix of the part of the plate that the cell lies in ([`super::dissection`]).

use rayon::prelude::*;

use super::basis::Value;
use super::cells::{Dividers, QuadraturePoint};
use super::dilatation::{Dilatation, Patch, side, split};
use super::field::{Discretisation, Local, TipFields, singular};
use super::front::{FrontalMatrix, lower_product, whole_product};
use super::part::Part;
use perilife_base::error::Result;

/// Area of points that may be left out where nodes in reach do not span the basis, over that of a cell: in the wedge between a slant
/// crack and the edge that it starts from, which carries nothing.
const LEFT_OUT: f64 = 0.25;

/// What is reused from cell to cell.
#[derive(Debug, Default)]
pub struct Scratch {
    local: Local,
    /// Values at all points of a cell, and where those of each end, with its area.
    values: Vec<Value>,
    ends: Vec<(usize, f64)>,
    /// Near-tip fields at the points, all tips of a point together.
    fields: Vec<Option<TipFields>>,
    /// Number in the cell of every node of the plate, none of those that it does not hold.
    numbers: Vec<u32>,
    /// Nodes of the cell in the order of their unknowns in the front, with the number of the first enriched unknown of each.
    nodes: Vec<(u32, u32)>,
    /// Places in the front of the enriched unknowns; where nodes are images, of all.
    enriched: Vec<u32>,
    has_images: bool,
    /// Gradients of shape functions, a row a point, and the same times the area.
    gradients: [Vec<f64>; 2],
    /// Strains of the unknowns without and with fields, three rows a point, and stresses of the latter times the area.
    strains: [Vec<f64>; 2],
    stresses: Vec<f64>,
    product: Vec<f64>,
    /// First unknown in the front of every node of the cell.
    in_front: Vec<usize>,
}

impl Scratch {
    pub fn of(nodes: usize) -> Self {
        Scratch { numbers: vec![u32::MAX; nodes], ..Scratch::default() }
    }

    fn read(&mut self, plate: &Discretisation, leaf: usize, points: &[QuadraturePoint]) -> Result<()> {
        let (mut left_out, size) = (0.0, plate.grid.spacing(leaf));
        self.values.clear();
        self.ends.clear();
        self.fields.clear();
        plate.load(leaf, &mut self.local);
        for point in points {
            if !plate.at_loaded(leaf, point.at, &mut self.local) {
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

    /// Numbers the nodes in reach of any point, or those that stand for them, and their enriched unknowns.
    fn number(&mut self, plate: &Discretisation, part: &Part, places: &[u32]) {
        self.nodes.clear();
        self.has_images = self.values.iter().any(|value| !part.is_plain(value.node));
        for value in &self.values {
            let node = part.node(value.node);
            let number = &mut self.numbers[node as usize];
            if *number == u32::MAX {
                *number = 0;
                self.nodes.push((node, 0));
            }
        }
        self.nodes.sort_unstable_by_key(|node| places[node.0 as usize]);
        self.enriched.clear();
        for (number, (node, first)) in (0..).zip(&mut self.nodes) {
            self.numbers[*node as usize] = number;
            *first = self.enriched.len() as u32;
            let (place, plain) = (places[*node as usize], if self.has_images { 0 } else { 2 });
            self.enriched.extend(place + plain..place + 2 + 2 * plate.enriched[*node as usize].len() as u32);
        }
    }

    fn fill(&mut self, plate: &Discretisation, part: &Part, thickness: f64) {
        let Scratch { values, ends, fields, numbers, nodes, enriched, has_images, gradients, strains, stresses, .. } = self;
        let (n, m, points, tips) = (if *has_images { 0 } else { 2 * nodes.len() }, enriched.len(), ends.len(), plate.axes.len());
        let is_enriched = usize::from(m > 0);
        let [of_points, weighted] = gradients;
        let [of_nodes, of_fields] = strains;
        let sizes = [points * n, points * n, 3 * points * n * is_enriched, 3 * points * m, 3 * points * m];
        for (rows, size) in
            [&mut *of_points, &mut *weighted, &mut *of_nodes, &mut *of_fields, &mut *stresses].into_iter().zip(sizes)
        {
            rows.clear();
            rows.resize(size, 0.0);
        }
        let (elasticity, _) = split(plate.elasticity());
        let mut first_value = 0;
        for (index, &(end, area)) in ends.iter().enumerate() {
            let factor = thickness * area;
            let values = &values[std::mem::replace(&mut first_value, end)..end];
            if *has_images {
                plate.each_unknown(values, &fields[index * tips..(index + 1) * tips], |node, unknown, (_, gradient)| {
                    let (place, sign) = part.unknown(node, unknown);
                    let number = numbers[part.node(node) as usize] as usize;
                    let column = 3 * index * m + (nodes[number].1 + place) as usize;
                    let strain = [gradient[0][0], gradient[1][1], gradient[0][1] + gradient[1][0]];
                    for (row, (strain, stress)) in strain.into_iter().zip(elasticity.stress(&gradient)).enumerate() {
                        of_fields[column + row * m] += sign * strain;
                        stresses[column + row * m] += sign * factor * stress;
                    }
                });
                continue;
            }
            for value in values {
                let number = numbers[value.node as usize] as usize;
                let ([x, y], column) = (value.gradient, 2 * number);
                let place = index * n + column;
                (of_points[place], of_points[place + 1]) = (x, y);
                (weighted[place], weighted[place + 1]) = (factor * x, factor * y);
                if m == 0 {
                    continue;
                }
                let row = 3 * index * n + column;
                (of_nodes[row], of_nodes[row + 2 * n]) = (x, y);
                (of_nodes[row + n + 1], of_nodes[row + 2 * n + 1]) = (y, x);
                let first = nodes[number].1 as usize;
                for (k, &tip) in plate.enriched[value.node as usize].iter().enumerate() {
                    let Some(fields) = &fields[index * tips + tip as usize] else { continue };
                    for (mode, (field, slope)) in fields.iter().enumerate() {
                        let part = |i: usize, j: usize| field[i] * value.gradient[j] + value.value * slope[i][j];
                        let gradient = [[part(0, 0), part(0, 1)], [part(1, 0), part(1, 1)]];
                        let strain = [gradient[0][0], gradient[1][1], gradient[0][1] + gradient[1][0]];
                        let column = 3 * index * m + first + 2 * k + mode;
                        for (row, (strain, stress)) in strain.into_iter().zip(elasticity.stress(&gradient)).enumerate() {
                            of_fields[column + row * m] = strain;
                            stresses[column + row * m] = factor * stress;
                        }
                    }
                }
            }
        }
    }
}

/// Means of dilatation over the cells of a plate; none where all of λ counts point by point.
pub fn dilatation(plate: &Discretisation, cells: &[(usize, Vec<QuadraturePoint>)]) -> Option<Dilatation> {
    if split(plate.elasticity()).1[1] == 0.0 {
        return None;
    }
    let dividers = Dividers::of(plate);
    let of_cell = |(local, sums): &mut (Local, Vec<f64>), (leaf, points): &(usize, Vec<QuadraturePoint>)| {
        let (cracks, mut points) = (dividers.of_cell(*leaf).cracks, points.clone());
        let of_point = |point: &QuadraturePoint| side(&cracks, point.at);
        plate.load(*leaf, local);
        points.sort_by_key(of_point);
        let of_side = |points: &[QuadraturePoint]| {
            let (mut area, mut means) = (0.0, Vec::new());
            for point in points {
                // Where nodes do not span the basis, `add_cell` decides.
                if plate.at_loaded(*leaf, point.at, local) {
                    area += point.area;
                    plate.each_unknown(&local.values, &local.fields, |node, unknown, (_, [[xx, _], [_, yy]])| {
                        let sum = &mut sums[unknown as usize];
                        if *sum == 0.0 {
                            means.push((node, unknown, 0.0));
                        }
                        *sum += point.area * (xx + yy);
                    });
                }
            }
            means.iter_mut().for_each(|mean| mean.2 = std::mem::take(&mut sums[mean.1 as usize]) / area);
            Patch { side: of_point(&points[0]), area, means }
        };
        let patches: Vec<Patch> = points.chunk_by(|a, b| of_point(a) == of_point(b)).map(of_side).collect();
        (*leaf, (cracks, patches))
    };
    let room = || (Local::default(), vec![0.0; plate.unknowns()]);
    Some(Dilatation::new(plate.elasticity(), cells.par_iter().map_init(room, of_cell).collect()))
}

/// Adds the matrix of a cell to a front in which the unknowns of a node begin at `places[node]`; of the unknowns that stand for others, of the
/// nodes that do.
///
/// With `P = Σ ∇Φ ∇Φᵀ dA` of all pairs of gradients that of unknowns without fields is made of its entries; those with fields take all
/// of `∫ e_aᵀ D e_b dA`.
/// Errors: nodes in reach of a point do not span the basis.
pub fn add_cell(
    plate: &Discretisation,
    (part, thickness): (&Part, f64),
    (leaf, points): (usize, &[QuadraturePoint]),
    scratch: &mut Scratch,
    places: &[u32],
    front: &mut FrontalMatrix,
) -> Result<()> {
    scratch.read(plate, leaf, points)?;
    scratch.number(plate, part, places);
    scratch.fill(plate, part, thickness);
    let Scratch {
        ends,
        numbers,
        nodes,
        enriched,
        has_images,
        gradients: [of_points, weighted],
        strains: [of_nodes, of_fields],
        stresses,
        product,
        in_front,
        ..
    } = scratch;
    let (n, m, points) = (if *has_images { 0 } else { 2 * nodes.len() }, enriched.len(), ends.len());
    if points == 0 {
        return Ok(());
    }
    in_front.clear();
    in_front.extend(nodes.iter().map(|&(node, _)| places[node as usize] as usize));
    if n > 0 {
        lower_product(of_points, weighted, [points, n], product);
        add_nodes(plate, in_front, product, front);
    }
    if m > 0 && n > 0 {
        let place = |number: usize| in_front[number / 2] + number % 2;
        whole_product(stresses, of_nodes, [3 * points, m, n], product);
        for column in 0..n {
            let from = enriched.partition_point(|&row| (row as usize) < place(column));
            let (sums, first) = front.column(place(column));
            let values = &product[column * m + from..(column + 1) * m];
            enriched[from..].iter().zip(values).for_each(|(&row, value)| sums[row as usize - first] += value);
        }
        for (index, &column) in enriched.iter().enumerate() {
            let from = 2 * in_front.partition_point(|&row| row < column as usize);
            let (sums, first) = front.column(column as usize);
            (from..n).for_each(|row| sums[place(row) - first] += product[row * m + index]);
        }
    }
    if m > 0 {
        lower_product(of_fields, stresses, [3 * points, m], product);
        for (index, &column) in enriched.iter().enumerate() {
            let (sums, first) = front.column(column as usize);
            let values = &product[index * m + index..(index + 1) * m];
            enriched[index..].iter().zip(values).for_each(|(&row, value)| sums[row as usize - first] += value);
        }
    }
    nodes.iter().for_each(|&(node, _)| numbers[node as usize] = u32::MAX);
    if let Some(dilatation) = plate.dilatation() {
        dilatation.add(leaf, thickness, [&plate.first, places], front);
    }
    Ok(())
}

/// Adds the matrix of the unknowns without fields, of which those of each node begin at one of the ascending `places`.
fn add_nodes(plate: &Discretisation, places: &[usize], product: &[f64], front: &mut FrontalMatrix) {
    let (elasticity, _) = split(plate.elasticity());
    // Stress of unit strains.
    let [direct, lateral, _] = elasticity.stress(&[[1.0, 0.0], [0.0, 0.0]]);
    let shear = elasticity.shear_modulus;
    let n = places.len();
    let columns = product.as_chunks::<2>().0;
    for (j, &column) in places.iter().enumerate() {
        let (of_x, of_y) = (&columns[2 * j * n..(2 * j + 1) * n], &columns[(2 * j + 1) * n..(2 * j + 2) * n]);
        let ([in_x, in_y], first) = front.columns(column);
        let ([xx, xy], yy, diagonal) = (of_x[j], of_y[j][1], column - first);
        in_x[diagonal] += direct * xx + shear * yy;
        in_x[diagonal + 1] += (lateral + shear) * xy;
        in_y[diagonal + 1] += direct * yy + shear * xx;
        // Two sums at a time, each of what stands beside and across.
        for ((x, y), &row) in of_x.iter().zip(of_y).zip(places).skip(j + 1) {
            let rows = row - first..row - first + 2;
            let of_rows = |column: &mut [f64], beside: [f64; 2], across: [f64; 2]| {
                column.iter_mut().zip(beside).zip(across).for_each(|((sum, beside), across)| *sum += beside + shear * across);
            };
            of_rows(&mut in_x[rows.clone()], [direct * x[0], lateral * x[1]], [y[1], y[0]]);
            of_rows(&mut in_y[rows], [lateral * y[0], direct * y[1]], [x[1], x[0]]);
        }
    }
}
