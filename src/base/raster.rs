//! Pictures of a plate: the raster on which its points lie, and what they were at one moment.

use serde::{Deserialize, Serialize};

/// Picture of the damaged plate at one moment, SI: what every point has at maximum load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    pub cycles: f64,
    pub crack_length: f64,
    pub displacement: Vec<[f64; 2]>,
    /// Damage φ: fraction of its bonds that are broken, 0 to 1.
    #[serde(with = "crate::sealed::mostly_zero")]
    pub damage: Vec<f64>,
    /// Least remaining life λ of its intact bonds, 0 to 1; empty where no bonds have one.
    #[serde(with = "crate::sealed::mostly_one")]
    pub remaining_life: Vec<f64>,
    /// Von Mises stress; empty where it is not known.
    pub stress: Vec<f64>,
}

/// Lattice rows and columns that hold the body; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct PointGrid {
    /// The finest one where there are several.
    pub spacing: f64,
    pub columns: usize,
    pub rows: usize,
    /// Position of lattice place (0, 0).
    pub origin: [f64; 2],
    /// Angle of the lattice rows against x, radians.
    pub angle: f64,
    /// For every lattice place (row by row), the index of its point or `None` outside the material. A point of a coarser level
    /// covers all places of its cell.
    pub point_at: Vec<Option<u32>>,
}

impl PointGrid {
    pub fn none() -> PointGrid {
        PointGrid { spacing: f64::NAN, columns: 0, rows: 0, origin: [0.0; 2], angle: 0.0, point_at: Vec::new() }
    }
}
