//! Equilibrium of a plate of nodes.

use super::assembly::{Scratch, add_cell};
use super::boundary::{Boundary, Square, UNKNOWNS_OF_GRIP};
use super::cells::{QuadraturePoint, quadrature};
use super::dissection::{Factor, Matrices, Member};
use super::field::Discretisation;
use super::front::Front;
use crate::error::Result;
use crate::specimen::Specimen;

/// Displacement of a plate under its loads.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Unknowns, m.
    pub u: Vec<f64>,
    /// Work of the loads `Σ f u`, J.
    pub work: f64,
    /// Points of integration.
    pub points: usize,
    /// Area of them, m².
    pub area: f64,
}

/// The matrices of a plate: those of cells, then those of supports.
struct Stiffness<'a> {
    plate: &'a Discretisation,
    thickness: f64,
    cells: &'a [(usize, Vec<QuadraturePoint>)],
    held: &'a [Square],
    /// First unknown of every node, and of every grip after them.
    first: &'a [u32],
}

impl Stiffness<'_> {
    fn members(&self) -> Vec<Member> {
        let of_cell = |(leaf, points): &(usize, Vec<QuadraturePoint>)| {
            let bounds = |of: fn(f64, f64) -> f64, from: f64| [0, 1].map(|i| points.iter().map(|p| p.at[i]).fold(from, of));
            let box_of_points = [bounds(f64::min, f64::INFINITY), bounds(f64::max, f64::NEG_INFINITY)];
            Member { at: self.plate.grid.middle(*leaf), nodes: self.plate.in_reach(*leaf, box_of_points) }
        };
        let of_support = |square: &Square| {
            let mut nodes: Vec<u32> = square.unknowns.iter().map(|unknown| self.node(*unknown)).collect();
            nodes.dedup();
            let at = &self.plate.nodes.at;
            Member { at: *at.get(nodes[0] as usize).unwrap_or(&at[0]), nodes }
        };
        self.cells.iter().map(of_cell).chain(self.held.iter().map(of_support)).collect()
    }

    /// Node, or grip, that an unknown belongs to.
    fn node(&self, unknown: u32) -> u32 {
        self.first.partition_point(|first| *first <= unknown) as u32 - 1
    }
}

impl Matrices for Stiffness<'_> {
    fn add(&self, members: &[u32], places: &[u32], front: &mut Front) -> Result<()> {
        let mut scratch = Scratch::of(self.plate.nodes.at.len());
        for &member in members {
            let member = member as usize;
            if let Some((leaf, points)) = self.cells.get(member) {
                add_cell(self.plate, self.thickness, (*leaf, points), &mut scratch, places, front)?;
                continue;
            }
            let Square { unknowns, v, factor } = &self.held[member - self.cells.len()];
            let place = |unknown: u32| {
                let node = self.node(unknown) as usize;
                (places[node] + unknown - self.first[node]) as usize
            };
            for (k, &a) in unknowns.iter().enumerate() {
                unknowns[..=k].iter().zip(v).for_each(|(&b, of_b)| front.add(place(a), place(b), factor * v[k] * of_b));
            }
        }
        Ok(())
    }
}

/// Solves `K u = f` at the nominal load `load`, Pa or N, by a Cholesky factor.
/// Errors: [`crate::error::Error::LossOfStiffness`] where some part moves freely; nodes in reach of a point that do not span the basis.
pub fn solve(specimen: &Specimen, plate: &Discretisation, far: f64, load: f64) -> Result<Solution> {
    let cells = quadrature(specimen, plate);
    let Boundary { mut forces, held, of_grips } = Boundary::new(specimen, plate, far)?;
    let grips = (plate.unknowns()..plate.unknowns() + of_grips).step_by(UNKNOWNS_OF_GRIP);
    let first: Vec<u32> = plate.first.iter().copied().chain(grips.map(|first| (first + UNKNOWNS_OF_GRIP) as u32)).collect();
    let stiffness = Stiffness { plate, thickness: specimen.thickness, cells: &cells, held: &held, first: &first };
    let factor = Factor::of(&stiffness.members(), &first, &stiffness)?;
    forces.iter_mut().for_each(|force| *force *= load);
    let mut u = forces.clone();
    factor.solve(&mut u);
    let work = forces.iter().zip(&u).map(|(f, u)| f * u).sum();
    let points = cells.iter().map(|(_, points)| points.len()).sum();
    let area = cells.iter().flat_map(|(_, points)| points).map(|point| point.area).sum();
    Ok(Solution { u, work, points, area })
}
