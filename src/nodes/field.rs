//! The discretised plate: cells, nodes, what parts them, and the unknowns.
//!
//! `u(x) = Σ_i Φ_i(x) (u_i + Σ_t [a_it Q_I(x - x_t) + b_it Q_II(x - x_t)])`: the near-tip fields of every tip are unknowns of the nodes
//! around it (partition of unity: Melenk and Babuška 1996, CMAME 139:289; Belytschko and Black 1999, IJNME 45:601). Without them K is
//! 4 % wrong with 900 nodes, with them 0.1 %.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::basis::{AnyBasis, Enrichment, Value};
use super::crack::{Tip, TipAxes, cracks};
use super::cuts::{Near, Obstacles};
use super::dilatation::{Dilatation, influence_radius};
use super::grid::Grid;
use super::linear;
use super::nodes::Nodes;
use super::resolution::Resolution;
use super::rims::sides;
use perilife_base::error::{Error, Result};
use perilife_base::units::{MM, place_mm};
use perilife_plate::loading::residual::ResidualStress;
use perilife_plate::specimen::geometry::{bounding_box, distance};
use perilife_plate::specimen::{CrackLine, LineEnd, Point, Specimen};
use perilife_plate::williams::Elasticity;

/// Distance from a tip, in its spacings, within which nodes carry its fields.
pub const ENRICHED_SPACINGS: f64 = 3.0;

#[derive(Debug, Clone, Default)]
struct Neighbourhood {
    nodes: Vec<u32>,
    near: Near,
    /// Of every node whether nothing lies between it and any point of the leaf; none where that is so of all.
    clear: Vec<bool>,
}

impl Neighbourhood {
    /// Largest of these radii of influence of its nodes, m; 0 of none.
    fn reach(&self, supports: &[f64]) -> f64 {
        self.nodes.iter().map(|&node| supports[node as usize]).fold(0.0, f64::max)
    }
}

#[derive(Debug, Clone)]
pub struct Discretisation {
    pub grid: Grid,
    pub nodes: Nodes,
    /// Radius of influence of every node, m.
    pub supports: Vec<f64>,
    pub sides: Vec<[Point; 2]>,
    /// What parts nodes from points.
    pub obstacles: Obstacles,
    /// How many of the cuts are cracks; they come first.
    pub cracks: usize,
    pub axes: Vec<TipAxes>,
    /// First unknown of every node, and the number of all.
    pub first: Vec<u32>,
    /// Tips whose fields a node carries.
    pub enriched: Vec<Vec<u32>>,
    /// Means of dilatation over cells, once they are known.
    dilatation: OnceLock<Option<Dilatation>>,
    elasticity: Elasticity,
    basis: AnyBasis,
    leaves: Vec<Neighbourhood>,
}

/// Q_I and Q_II of a tip with their gradients ∂u_i/∂x_j.
pub type TipFields = [(Point, [[f64; 2]; 2]); 2];

/// Shape functions at a point, and near-tip fields there.
#[derive(Debug, Clone, Default)]
pub struct Local {
    /// Φ_i of the nodes in reach.
    pub values: Vec<Value>,
    /// Q_I and Q_II of every tip that a node in reach carries, with gradients; by tip.
    pub fields: Vec<Option<TipFields>>,
    room: linear::Workspace,
}

impl Discretisation {
    /// Nodes for these cracks; `tips` are the ends of lines that lie in the material.
    /// Errors: [`Error::Mechanics`] where more nodes would be needed than are allowed.
    pub fn new(
        specimen: &Specimen,
        elasticity: Elasticity,
        lines: &[CrackLine],
        tips: &[Tip],
        resolution: &Resolution,
        residual: Option<&ResidualStress>,
    ) -> Result<Self> {
        let (grid, spacings) = resolution.grid(specimen, lines, tips, residual)?;
        let ends: Vec<(LineEnd, f64)> = tips.iter().map(|tip| tip.end).zip(spacings).collect();
        let (cuts, axes) = cracks(specimen, lines, &ends, resolution.far);
        let sides = sides(specimen, &grid);
        let nodes = Nodes::place(specimen, &grid, &sides, &cuts, &axes);
        let support = influence_radius(elasticity, resolution.support);
        let supports: Vec<f64> = nodes.spacing.iter().map(|spacing| support * spacing).collect();
        let obstacles = Obstacles::new(specimen, cuts);
        let enriched: Vec<Vec<u32>> = nodes
            .at
            .iter()
            .map(|&at| {
                // On the limit none does, on both sides of a tip alike.
                let carries = |axes: &TipAxes| distance(at, axes.at) < (1.0 - 1e-9) * ENRICHED_SPACINGS * axes.spacing;
                let has_fields = resolution.enrichment == Enrichment::Tip;
                axes.iter().enumerate().filter(|(_, axes)| has_fields && carries(axes)).map(|(tip, _)| tip as u32).collect()
            })
            .collect();
        let mut first = vec![0];
        enriched.iter().for_each(|tips| first.push(first[first.len() - 1] + 2 + 2 * tips.len() as u32));
        let mut plate = Discretisation {
            leaves: vec![Neighbourhood::default(); grid.len()],
            basis: AnyBasis::new(resolution.basis, resolution.enrichment, &axes),
            grid,
            nodes,
            supports,
            sides,
            obstacles,
            cracks: lines.len(),
            axes,
            first,
            enriched,
            dilatation: OnceLock::new(),
            elasticity,
        };
        plate.find_neighbours();
        Ok(plate)
    }

    fn find_neighbours(&mut self) {
        let of_node = |(&at, &support): (&Point, &f64)| {
            let (low, high, mut reached) = (at.map(|x| x - support), at.map(|x| x + support), Vec::new());
            self.grid.visit(low, high, &mut |leaf| {
                let [from, to] = self.grid.bounds(leaf);
                let outside = [0, 1].map(|i| (from[i] - at[i]).max(at[i] - to[i]).max(0.0));
                if outside[0] * outside[0] + outside[1] * outside[1] < support * support {
                    reached.push(leaf);
                }
            });
            reached
        };
        let reached: Vec<Vec<usize>> = self.nodes.at.par_iter().zip(&self.supports).map(of_node).collect();
        for (node, leaves) in (0..).zip(reached) {
            leaves.into_iter().for_each(|leaf| self.leaves[leaf].nodes.push(node));
        }
        let (grid, obstacles, at, supports) = (&self.grid, &self.obstacles, &self.nodes.at, &self.supports);
        self.leaves.par_iter_mut().enumerate().for_each(|(index, leaf)| {
            let reach = leaf.reach(supports);
            if reach == 0.0 {
                return;
            }
            let [low, high] = grid.bounds(index);
            let near = obstacles.near(grid.middle(index), reach + distance(low, high));
            if near.is_empty() {
                return;
            }
            leaf.clear = leaf.nodes.iter().map(|&node| near.is_clear(at[node as usize], [low, high])).collect();
            if leaf.clear.iter().all(|clear| *clear) {
                leaf.clear.clear();
            } else {
                leaf.near = near;
            }
        });
    }

    pub fn unknowns(&self) -> usize {
        self.first[self.first.len() - 1] as usize
    }

    /// Largest radius of influence of the nodes that reach a leaf, m; 0 where none does.
    pub fn reach(&self, leaf: usize) -> f64 {
        self.leaves[leaf].reach(&self.supports)
    }

    /// Means of dilatation over cells, where they take part.
    pub fn dilatation(&self) -> Option<&Dilatation> {
        self.dilatation.get()?.as_ref()
    }

    /// Takes up the means, once.
    pub fn with_dilatation(&self, means: impl FnOnce() -> Option<Dilatation>) {
        self.dilatation.get_or_init(means);
    }

    pub fn elasticity(&self) -> Elasticity {
        self.elasticity
    }

    /// Nodes that a leaf sees and whose supports reach into a box, m, within it.
    pub fn in_reach(&self, leaf: usize, [low, high]: [Point; 2]) -> Vec<u32> {
        let reaches = |node: &u32| {
            let (at, support) = (self.nodes.at[*node as usize], self.supports[*node as usize]);
            let outside = [0, 1].map(|i| (low[i] - at[i]).max(at[i] - high[i]).max(0.0));
            outside[0] * outside[0] + outside[1] * outside[1] < support * support
        };
        self.leaves[leaf].nodes.iter().copied().filter(reaches).collect()
    }

    /// Takes up the nodes of a leaf, for [`Discretisation::at_loaded`].
    pub fn load(&self, leaf: usize, local: &mut Local) {
        if self.basis.is_linear() {
            local.room.load(&self.leaves[leaf].nodes, &self.nodes.at, &self.supports);
        }
    }

    /// Shape functions and near-tip fields at a point of a leaf; whether the nodes in reach span the basis.
    pub fn at(&self, leaf: usize, at: Point, local: &mut Local) -> bool {
        self.load(leaf, local);
        self.at_loaded(leaf, at, local)
    }

    /// The same at a point of the leaf that was loaded last.
    pub fn at_loaded(&self, leaf: usize, at: Point, local: &mut Local) -> bool {
        let Neighbourhood { nodes, near, clear } = &self.leaves[leaf];
        let scale = self.grid.spacing(leaf);
        local.fields.clear();
        local.fields.resize(self.axes.len(), None);
        let spans = if self.basis.is_linear() {
            linear::shape_functions(at, nodes, (near, clear), scale, &mut local.room, &mut local.values)
        } else {
            self.basis.shape_functions(at, (nodes, &self.nodes.at, &self.supports), near, scale, &mut local.values)
        };
        if !spans {
            return false;
        }
        for value in &local.values {
            for &tip in &self.enriched[value.node as usize] {
                let field = &mut local.fields[tip as usize];
                if field.is_none() {
                    *field = Some(self.axes[tip as usize].near_tip(self.elasticity, at));
                }
            }
        }
        true
    }

    /// Displacement, m, and its gradient ∂u_i/∂x_j at a point, of the unknowns `u`; `None` where nodes in reach do not span the basis.
    pub fn displacement(&self, u: &[f64], at: Point, local: &mut Local) -> Option<(Point, [[f64; 2]; 2])> {
        self.displacement_in(self.grid.leaf(at), u, at, local)
    }

    /// The same of a point of a leaf.
    pub fn displacement_in(&self, leaf: usize, u: &[f64], at: Point, local: &mut Local) -> Option<(Point, [[f64; 2]; 2])> {
        if !self.at(leaf, at, local) {
            return None;
        }
        let (mut sum, mut slope) = ([0.0; 2], [[0.0; 2]; 2]);
        self.each_unknown(&local.values, &local.fields, |_, unknown, (field, gradient)| {
            let size = u[unknown as usize];
            add(&mut sum, size, &field);
            slope.iter_mut().zip(&gradient).for_each(|(row, gradient)| add(row, size, gradient));
        });
        if let Some(dilatation) = self.dilatation() {
            dilatation.project(leaf, u, at, &mut slope);
        }
        Some((sum, slope))
    }

    /// Calls with node, unknown, and its displacement and gradient ∂u_i/∂x_j, for all unknowns at a point, of the shape functions and near-tip
    /// fields there.
    pub fn each_unknown(
        &self,
        values: &[Value],
        fields: &[Option<TipFields>],
        mut call: impl FnMut(u32, u32, (Point, [[f64; 2]; 2])),
    ) {
        for &Value { node, value, gradient } in values {
            let first = self.first[node as usize];
            call(node, first, ([value, 0.0], [gradient, [0.0; 2]]));
            call(node, first + 1, ([0.0, value], [[0.0; 2], gradient]));
            for (k, &tip) in (0..).zip(&self.enriched[node as usize]) {
                let Some(fields) = &fields[tip as usize] else { continue };
                for (mode, (field, slope)) in (0..).zip(fields) {
                    let slope = [0, 1].map(|i| [0, 1].map(|j| field[i] * gradient[j] + value * slope[i][j]));
                    call(node, first + 2 + 2 * k + mode, (field.map(|u| value * u), slope));
                }
            }
        }
    }

    /// Larger side of the box around a plate, m.
    pub fn size(specimen: &Specimen) -> f64 {
        let [low, high] = bounding_box(&specimen.outline);
        (high[0] - low[0]).max(high[1] - low[1])
    }
}

fn add(sum: &mut Point, factor: f64, vector: &Point) {
    sum.iter_mut().zip(vector).for_each(|(sum, component)| *sum += factor * component);
}

/// What is said where nodes in reach of a point, with radii of influence up to `radius`, m, do not span the basis.
pub fn singular(at: Point, radius: f64) -> Error {
    Error::Mechanics(format!(
        "too few nodes near {} for the basis (radii of influence up to {:.4} mm); increase model.influence_radius or \
         model.nodes, or give one crack where two meet at a small angle",
        place_mm(at),
        radius / MM
    ))
}
