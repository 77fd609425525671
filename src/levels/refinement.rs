//! Where finer points lie, and how points of several levels reach each other.

use crate::specimen::Point;

crate::kinds! {
    /// How points lie and reach each other.
    pub enum Discretisation for "model.discretisation" {
        Lattice = "lattice": "square lattice of one spacing",
        DualHorizon = "dual_horizon": "points of several levels, each split in four where refinement.regions say, with horizon and dual horizon (Ren et al. 2016)",
        VariableHorizon = "variable_horizon": "the same points without the dual horizon: shows the ghost forces that the dual horizon removes; fracture scenes",
    }
}

/// Where finer points lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement {
    /// Regions with the number of times their points are split in four.
    pub regions: Vec<(RefinedRegion, usize)>,
}

/// A region of finer points.
#[derive(Debug, Clone, PartialEq)]
pub enum RefinedRegion {
    /// An upright box, m.
    Box {
        /// Lower left corner, m.
        low: Point,
        /// Upper right corner, m.
        high: Point,
    },
    /// Points within half a width of a line, m.
    Band {
        /// One end, m.
        from: Point,
        /// Other end, m.
        to: Point,
        /// Whole width, m.
        width: f64,
    },
    /// Points within so many metres of every crack and notch, levels graded outwards.
    AroundFlaws {
        /// Distance, m.
        distance: f64,
    },
}

impl Refinement {
    /// Times that the points of the finest level were split in four.
    pub fn deepest(&self) -> usize {
        self.regions.iter().map(|(_, levels)| *levels).max().unwrap_or(0)
    }

    /// The same in words.
    pub fn words(&self) -> String {
        format!("{} regions, up to {} levels", self.regions.len(), self.deepest())
    }
}
