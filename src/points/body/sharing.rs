//! How a force on the rim is shared out to points of the lattice.
//!
//! `Nearest` gives it to the nearest point, as published: the load then acts half a spacing inside the plate. `Consistent`
//! gives shares w_i with `Σ w_i = 1` and `Σ w_i x_i = x`, the place of the force on the rim: resultant, moment and the work
//! on any uniform strain are those of the true load. The weights are those of moving least squares of first order
//! (Lancaster and Salkauskas 1981, Math. Comp. 37:141) over points behind the rim, as deep as the longest bond and one
//! spacing to either side; the last row of a straight edge takes about 1.15, the third about -0.35.

use super::lattice::Lattice;
use crate::body::obstacles::Obstacles;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::facets::{Facet, behind};

/// Factor by which the region is widened while its points do not determine a linear field.
const WIDEN: f64 = 1.15;
/// Widenings after which the nearest point has to do: the material there is a single row or point.
const WIDENINGS: usize = 8;
/// Least determinant of the moment matrix over the product of its diagonal: below, the points lie almost on a line.
const LEAST_DETERMINANT: f64 = 1e-3;
/// Spacings within which a nearest point is searched.
const SEARCH: f64 = 3.0;

/// Rule by which forces on the rim reach the points.
pub struct Sharing<'a> {
    lattice: &'a Lattice,
    is_point: &'a [bool],
    /// Obstacles and rows of the consistent rule; `None` for the nearest point.
    consistent: Option<(Obstacles<'a>, usize)>,
}

impl<'a> Sharing<'a> {
    pub fn nearest(lattice: &'a Lattice, is_point: &'a [bool]) -> Self {
        Sharing { lattice, is_point, consistent: None }
    }

    /// Shares over `rows` rows of points that see the place of the force past the obstacles.
    pub fn consistent(lattice: &'a Lattice, is_point: &'a [bool], obstacles: Obstacles<'a>, rows: usize) -> Self {
        Sharing { lattice, is_point, consistent: Some((obstacles, rows)) }
    }

    /// Shares of a force on a piece of the rim; empty where no point lies near.
    pub fn of(&self, facet: &Facet) -> Vec<(u32, f64)> {
        let linear = self.consistent.as_ref().and_then(|(obstacles, rows)| self.linear(facet, obstacles, *rows as f64));
        linear.unwrap_or_else(|| self.nearest_point(facet.at).map(|place| (place, 1.0)).into_iter().collect())
    }

    /// Point nearest to a position, searched within three spacings.
    pub fn nearest_point(&self, position: Point) -> Option<u32> {
        let [column, row] = self.lattice.locate(position);
        let mut best: Option<(f64, u32)> = None;
        for (c, r, place) in self.points_within(position, SEARCH) {
            let away = (c as f64 - column).hypot(r as f64 - row);
            if best.is_none_or(|(least, _)| away < least - 1e-9) {
                best = Some((away, place as u32));
            }
        }
        best.map(|(_, place)| place)
    }

    /// Points within a square of `reach` spacings around a position: column, row, place.
    fn points_within(&self, position: Point, reach: f64) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        let lattice = self.lattice;
        let [column, row] = lattice.locate(position);
        let range = move |at: f64, count: usize| {
            let high = (at + reach).floor().clamp(-1.0, count as f64 - 1.0);
            (at - reach).ceil().max(0.0) as usize..(high + 1.0) as usize
        };
        let columns = range(column, lattice.columns);
        range(row, lattice.rows)
            .flat_map(move |r| columns.clone().map(move |c| (c, r, lattice.place(c, r))))
            .filter(|&(.., place)| self.is_point[place])
    }

    /// Moving least squares; `None` where no points determine a linear field.
    fn linear(&self, facet: &Facet, obstacles: &Obstacles, rows: f64) -> Option<Vec<(u32, f64)>> {
        let lattice = self.lattice;
        let [column, row] = lattice.locate(facet.at);
        let from = behind(facet, lattice.spacing);
        let near = obstacles.near(from);
        let candidates = |reach: f64| {
            let seated = move |(c, r, place): (usize, usize, usize)| (place as u32, [c as f64 - column, r as f64 - row], 1.0);
            self.points_within(facet.at, reach).map(seated)
        };
        let sees = |place: u32| !(near && obstacles.block(from, lattice.position(place as usize)));
        linear_shares(lattice.to_axes(facet.normal), [rows + 0.5, 1.0], candidates, sees)
    }
}

/// Shares of a force by moving least squares of first order over candidates within a reach (point, way to it from the force, weight): those
/// that the force sees within a box behind the rim, so deep against the normal and so wide to either side, lengths in any one unit. The box is
/// widened until they determine a linear field; `None` where they never do.
pub fn linear_shares<C: Iterator<Item = (u32, Point, f64)>>(
    normal: Point,
    sides: [f64; 2],
    candidates: impl Fn(f64) -> C,
    sees: impl Fn(u32) -> bool,
) -> Option<Vec<(u32, f64)>> {
    (0..WIDENINGS).find_map(|i| {
        let [deep, wide] = sides.map(|side| WIDEN.powi(i as i32) * side);
        shares_of(normal, deep, wide, candidates(deep.hypot(wide)), &sees)
    })
}

fn shares_of(
    normal: Point,
    deep: f64,
    wide: f64,
    candidates: impl Iterator<Item = (u32, Point, f64)>,
    sees: impl Fn(u32) -> bool,
) -> Option<Vec<(u32, f64)>> {
    let n = normal;
    let mut found = Vec::new();
    for (point, [dx, dy], scale) in candidates {
        let (x, y) = ((dx * n[0] + dy * n[1]) / deep, (dy * n[0] - dx * n[1]) / wide);
        let weight = scale * (1.0 - x * x).max(0.0) * (1.0 - y * y).max(0.0);
        if weight > 0.0 && sees(point) {
            found.push((point, weight, x, y));
        }
    }
    let mut g = [0.0; 6];
    for &(_, w, x, y) in &found {
        for (sum, term) in g.iter_mut().zip([1.0, x, y, x * x, x * y, y * y]) {
            *sum += w * term;
        }
    }
    // Share = w (1, x, y) G⁻¹ (1, 0, 0)ᵀ: the first row of cofactors.
    let [g00, g01, g02, g11, g12, g22] = g;
    let cofactors = [g11 * g22 - g12 * g12, g12 * g02 - g01 * g22, g01 * g12 - g11 * g02];
    let determinant = g00 * cofactors[0] + g01 * cofactors[1] + g02 * cofactors[2];
    if determinant.is_nan() || determinant <= LEAST_DETERMINANT * g00 * g11 * g22 {
        return None;
    }
    let share = |&(point, w, x, y): &(u32, f64, f64, f64)| {
        (point, w * (cofactors[0] + cofactors[1] * x + cofactors[2] * y) / determinant)
    };
    Some(found.iter().map(share).collect())
}
