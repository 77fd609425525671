//! The square lattice a body stands on: places in rows and columns, some of them holding a point.
//!
//! Arrays over places are padded on every side by the reach of the bonds, so that the neighbour of a place is always
//! at a fixed distance in memory and an absent neighbour is a place without material.

use perilife_base::error::{Result, input};
use perilife_base::raster::PointGrid;
use perilife_plate::specimen::geometry::bounding_box;
use perilife_plate::specimen::{Point, Specimen};

/// Lattice places processed together; rows are padded to a multiple of it.
pub const LANES: usize = 8;

/// Distance in spacings within which a point lies on a rim: far above round-off, far below what shows in a result.
pub const ON_RIM: f64 = 1e-6;

/// Geometry of the lattice and of the arrays over its places.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    /// Columns that can hold points.
    pub columns: usize,
    /// Rows that can hold points.
    pub rows: usize,
    /// Spacing Δ, m.
    pub spacing: f64,
    /// Position of column 0, row 0, m.
    pub origin: Point,
    /// Unit vector along the rows.
    pub axis: Point,
    /// Places of padding on each side.
    pub padding: usize,
    /// Distance in memory from one row to the next.
    pub stride: usize,
}

/// The spacing nearest to the requested one that divides the gross width, an even number of times where a crack lies on its middle
/// line; the requested one itself on a turned lattice, m.
#[inline]
pub fn fitting_spacing(specimen: &Specimen, spacing: f64, angle: f64) -> f64 {
    if angle == 0.0 { specimen.gross_width / across(specimen, spacing) } else { spacing }
}

/// Rows on a length of so many spacings; halves up, whatever round-off makes of them.
fn rounded(spacings: f64) -> f64 {
    (spacings + 0.5 + ON_RIM).floor()
}

/// Columns on the gross width.
fn across(specimen: &Specimen, spacing: f64) -> f64 {
    let [low, high] = bounding_box(&specimen.outline);
    let middle = 0.5 * (low[0] + high[0]);
    let is_middle = specimen.crack_plane_x.is_some_and(|plane| (plane - middle).abs() < ON_RIM * spacing);
    let fold = if is_middle { 2.0 } else { 1.0 };
    fold * (specimen.gross_width / (fold * spacing)).round().max(1.0)
}

impl Lattice {
    /// Its raster, with the points on its places, row by row.
    pub fn grid(&self, point_at: Vec<Option<u32>>) -> PointGrid {
        PointGrid {
            spacing: self.spacing,
            columns: self.columns,
            rows: self.rows,
            origin: self.origin,
            angle: self.axis[1].atan2(self.axis[0]),
            point_at,
        }
    }

    /// Lattice over a specimen: the requested spacing is moved to the nearest one that divides the gross width, and rows
    /// and columns are laid so that a crack along them falls between two of them.
    ///
    /// With an angle the lattice covers the bounding circle and keeps the requested spacing.
    /// Errors: more places than memory can sensibly hold, or a spacing wider than the plate.
    pub fn over(specimen: &Specimen, spacing: f64, angle: f64, padding: usize) -> Result<Self> {
        let [low, high] = bounding_box(&specimen.outline);
        let upright = angle == 0.0;
        let across = across(specimen, spacing);
        let spacing = fitting_spacing(specimen, spacing, angle);
        if across < 4.0 {
            let remedy = "reduce the spacing";
            return Err(input("model.spacing_mm", spacing * 1e3, "leaves fewer than 4 points across the plate", remedy));
        }
        let (columns, rows, origin) = if upright {
            // Half a spacing to either side of a crack plane, as many as have their middle inside the plate or on its edge.
            let laid = |axis: usize, plane: Option<f64>| match plane {
                Some(plane) => {
                    let [below, above] = [plane - low[axis], high[axis] - plane].map(|extent| rounded(extent / spacing));
                    (below + above, plane - (below - 0.5) * spacing)
                }
                None => {
                    let count = ((high[axis] - low[axis]) / spacing).round().max(1.0);
                    (count, 0.5 * (low[axis] + high[axis]) - 0.5 * (count - 1.0) * spacing)
                }
            };
            let ((columns, x0), (rows, y0)) = (laid(0, specimen.crack_plane_x), laid(1, specimen.crack_plane_y));
            (columns, rows, [x0, y0])
        } else {
            let centre = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
            let (sin, cos) = angle.sin_cos();
            let half = |a: f64, b: f64| 0.5 * ((high[0] - low[0]) * a.abs() + (high[1] - low[1]) * b.abs());
            // Even counts: a crack through the centre runs between two rows of the turned lattice.
            let count = |extent: f64| 2.0 * (extent / spacing).ceil();
            let (columns, rows) = (count(half(cos, sin)), count(half(sin, cos)));
            let (s, t) = (-0.5 * (columns - 1.0) * spacing, -0.5 * (rows - 1.0) * spacing);
            (columns, rows, [centre[0] + s * cos - t * sin, centre[1] + s * sin + t * cos])
        };
        if columns * rows > 2e8 {
            let problem = format!("needs {:.0} million lattice positions", columns * rows / 1e6);
            let remedy = "increase the spacing (at most 200 million)";
            return Err(input("model.spacing_mm", spacing * 1e3, problem, remedy));
        }
        let (columns, rows) = (columns as usize, rows as usize);
        let stride = columns.next_multiple_of(LANES) + 2 * padding;
        Ok(Lattice { columns, rows, spacing, origin, axis: [angle.cos(), angle.sin()], padding, stride })
    }

    /// The lattice of half the spacing whose places are the four parts of every place, at ± a quarter of the spacing.
    #[inline]
    pub fn halved(&self) -> Lattice {
        let (columns, rows) = (2 * self.columns, 2 * self.rows);
        let stride = columns.next_multiple_of(LANES) + 2 * self.padding;
        Lattice { columns, rows, spacing: 0.5 * self.spacing, origin: self.position_of(-0.25, -0.25), stride, ..self.clone() }
    }

    /// Length of an array over all places, padding included.
    #[inline]
    pub fn places(&self) -> usize {
        // One chunk more than the last padded row, so that whole chunks can be read at its end.
        self.stride * (self.rows + 2 * self.padding) + LANES
    }

    /// Memory index of a column and row.
    #[inline]
    pub fn place(&self, column: usize, row: usize) -> usize {
        (row + self.padding) * self.stride + column + self.padding
    }

    /// Column and row of a memory index that lies on the lattice.
    #[inline]
    pub fn column_row(&self, place: usize) -> (usize, usize) {
        (place % self.stride - self.padding, place / self.stride - self.padding)
    }

    /// Position of a place, m; `column` and `row` may be fractional or outside.
    #[inline]
    pub fn position_of(&self, column: f64, row: f64) -> Point {
        let [c, s] = self.axis;
        let (x, y) = (column * self.spacing, row * self.spacing);
        [self.origin[0] + x * c - y * s, self.origin[1] + x * s + y * c]
    }

    /// Position of a memory index, m.
    #[inline]
    pub fn position(&self, place: usize) -> Point {
        let (column, row) = self.column_row(place);
        self.position_of(column as f64, row as f64)
    }

    /// Fractional (column, row) of a position.
    #[inline]
    pub fn locate(&self, point: Point) -> [f64; 2] {
        let [c, s] = self.axis;
        let (x, y) = (point[0] - self.origin[0], point[1] - self.origin[1]);
        [(x * c + y * s) / self.spacing, (y * c - x * s) / self.spacing]
    }

    /// A vector in lattice axes, from plate axes.
    #[inline]
    pub fn to_axes(&self, vector: Point) -> Point {
        let [c, s] = self.axis;
        [vector[0] * c + vector[1] * s, vector[1] * c - vector[0] * s]
    }

    /// A vector in plate axes, from lattice axes.
    #[inline]
    pub fn from_axes(&self, vector: Point) -> Point {
        let [c, s] = self.axis;
        [vector[0] * c - vector[1] * s, vector[0] * s + vector[1] * c]
    }

    /// Memory distance to the neighbour `dx` columns and `dy` rows away.
    #[inline]
    pub fn step(&self, dx: i32, dy: i32) -> isize {
        dy as isize * self.stride as isize + dx as isize
    }
}
