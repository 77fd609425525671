//! Displacement and stress of a plate of nodes on an even raster, for pictures.

use rayon::prelude::*;

use super::field::{Discretisation, Local};
use crate::levels::PointGrid;
use crate::material::Plane;
use crate::specimen::geometry::bounding_box;
use crate::specimen::{Point, Specimen};

/// Points of the raster in a far spacing: a dozen rasters of a run then have fewer places than its solves have points of integration.
const IN_SPACING: f64 = 6.0;

/// The raster of a plate whose nodes have the spacing `far`, m, away from everything.
pub fn grid(specimen: &Specimen, far: f64) -> PointGrid {
    let [low, high] = bounding_box(&specimen.outline);
    let spacing = far / IN_SPACING;
    let [columns, rows] = [0, 1].map(|i| ((high[i] - low[i]) / spacing).round().max(1.0) as usize);
    let spacing = ((high[0] - low[0]) / columns as f64).max((high[1] - low[1]) / rows as f64);
    let origin = [low[0] + 0.5 * spacing, low[1] + 0.5 * spacing];
    let mut next = 0;
    let mut point_at = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            let at = [origin[0] + column as f64 * spacing, origin[1] + row as f64 * spacing];
            let is_inside = specimen.contains(at);
            point_at.push(is_inside.then_some(next));
            next += u32::from(is_inside);
        }
    }
    PointGrid { spacing, columns, rows, origin, angle: 0.0, point_at }
}

/// Displacement, m, and von Mises stress, Pa, of the points of the raster, times `share`.
pub fn fields(
    specimen: &Specimen,
    plate: &Discretisation,
    u: &[f64],
    far: f64,
    plane: Plane,
    share: f64,
) -> (Vec<Point>, Vec<f64>) {
    let PointGrid { spacing, columns, origin, point_at, .. } = grid(specimen, far);
    let at = |place: usize| [origin[0] + (place % columns) as f64 * spacing, origin[1] + (place / columns) as f64 * spacing];
    let places: Vec<usize> = (0..point_at.len()).filter(|&place| point_at[place].is_some()).collect();
    let elasticity = plate.elasticity();
    let of_place = |local: &mut Local, &place: &usize| {
        let Some((u, gradient)) = plate.displacement(u, at(place), local) else { return ([0.0; 2], 0.0) };
        let [x, y, xy] = elasticity.stress(&gradient);
        // κ = 3 - 4ν in plane strain.
        let across = if plane == Plane::Strain { 0.25 * (3.0 - elasticity.kappa) * (x + y) } else { 0.0 };
        let squares = (x - y).powi(2) + (y - across).powi(2) + (across - x).powi(2) + 6.0 * xy * xy;
        (u.map(|u| share * u), share * (0.5 * squares).sqrt())
    };
    places.par_iter().map_init(Local::default, of_place).unzip()
}
