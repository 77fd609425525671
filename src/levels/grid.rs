//! Points as pictures need them: the lattice they stand on and which point covers each of its places.

use crate::body::Body;
use crate::body::lattice::Lattice;
use crate::specimen::Point;

/// Lattice of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct PointGrid {
    /// Lattice spacing, m; the finest one where there are several.
    pub spacing: f64,
    /// Columns and rows of the lattice that holds the body.
    pub columns: usize,
    /// Rows of the lattice.
    pub rows: usize,
    /// Position of lattice place (0, 0), m.
    pub origin: Point,
    /// Angle of the lattice rows against x, radians.
    pub angle: f64,
    /// For every lattice place (row by row), the index of its point or `None` outside the material. A point of a coarser level
    /// covers all places of its cell.
    pub point_at: Vec<Option<u32>>,
}

impl PointGrid {
    /// That of a run without points.
    pub fn none() -> PointGrid {
        PointGrid { spacing: f64::NAN, columns: 0, rows: 0, origin: [0.0; 2], angle: 0.0, point_at: Vec::new() }
    }

    /// Lattice of a body.
    pub fn of_body(body: &Body) -> PointGrid {
        let lattice = &body.lattice;
        let mut point_at = vec![None; lattice.columns * lattice.rows];
        for (i, &place) in body.points.iter().enumerate() {
            let (column, row) = lattice.column_row(place as usize);
            point_at[row * lattice.columns + column] = Some(i as u32);
        }
        PointGrid::of_lattice(lattice, point_at)
    }

    /// A lattice with the points on its places, row by row.
    pub(super) fn of_lattice(lattice: &Lattice, point_at: Vec<Option<u32>>) -> PointGrid {
        PointGrid {
            spacing: lattice.spacing,
            columns: lattice.columns,
            rows: lattice.rows,
            origin: lattice.origin,
            angle: lattice.axis[1].atan2(lattice.axis[0]),
            point_at,
        }
    }
}
