//! Forces on the rim shared out to points of several levels.

use std::collections::BTreeMap;

use super::levels::Levels;
use perilife_base::error::{Error, Result};
use perilife_plate::loading::pieces::load_pieces;
use perilife_plate::specimen::facets::{Facet, behind};
use perilife_plate::specimen::{Point, Specimen};
use perilife_points::body::boundary::balance;
use perilife_points::body::obstacles::Obstacles;
use perilife_points::body::sharing::linear_shares;

/// Places of the finest level within which the point nearest to a force is searched, if it lies in no point's cell.
const SEARCH: i64 = 12;

/// Rule by which forces on the rim reach the points.
pub struct Sharing<'a> {
    levels: &'a Levels,
    positions: &'a [Point],
    /// Voids as the finest level sees them, and rows of points behind the rim that a force reaches: the consistent rule of
    /// [`perilife_points::body::sharing`], by the spacing of the point whose cell the force bounds. `None` gives all to that point, so that
    /// the end points of a stretch of uniform traction carry as much rim as they have.
    consistent: Option<(Obstacles<'a>, usize)>,
}

impl<'a> Sharing<'a> {
    pub fn new(levels: &'a Levels, positions: &'a [Point], consistent: Option<(Obstacles<'a>, usize)>) -> Self {
        Sharing { levels, positions, consistent }
    }

    /// Shares of a force on a piece of the rim; empty where no point lies near.
    pub fn of(&self, facet: &Facet) -> Vec<(u32, f64)> {
        let Some(seat) = self.seat(facet) else { return Vec::new() };
        let linear = self.consistent.as_ref().and_then(|(obstacles, rows)| self.linear(facet, seat, obstacles, *rows as f64));
        linear.unwrap_or_else(|| vec![(seat as u32, 1.0)])
    }

    /// The point whose cell a piece bounds, or the nearest one.
    fn seat(&self, facet: &Facet) -> Option<usize> {
        let finest = self.levels.finest();
        let at = behind(facet, finest.spacing);
        let [column, row] = finest.locate(at).map(|i| i.round() as i64);
        self.levels.point_over(column, row).or_else(|| {
            // Rounded rims pass through cells whose middle lies outside.
            let around = (-SEARCH..=SEARCH).flat_map(|dy| (-SEARCH..=SEARCH).map(move |dx| (column + dx, row + dy)));
            let away = |point: &usize| (self.positions[*point][0] - at[0]).hypot(self.positions[*point][1] - at[1]);
            let near = around.filter_map(|(column, row)| self.levels.point_over(column, row));
            near.min_by(|a, b| away(a).total_cmp(&away(b)).then(a.cmp(b)))
        })
    }

    /// Moving least squares, in spacings of the seat.
    fn linear(&self, facet: &Facet, seat: usize, obstacles: &Obstacles<'_>, rows: f64) -> Option<Vec<(u32, f64)>> {
        let own = &self.levels.lattices[self.levels.leaves[seat].level];
        let from = behind(facet, own.spacing);
        let near = obstacles.near(from);
        let of_level = |level: usize, reach: f64| {
            let lattice = &self.levels.lattices[level];
            let at = lattice.locate(facet.at);
            let scale = lattice.spacing / own.spacing;
            let [columns, rows] = at.map(|i| (i - reach / scale).ceil() as i64..=(i + reach / scale).floor() as i64);
            rows.flat_map(move |row| columns.clone().map(move |column| (column, row))).filter_map(move |(column, row)| {
                let point = self.levels.point_at(level, column, row)?;
                Some((point as u32, [column as f64 - at[0], row as f64 - at[1]].map(|i| i * scale), scale * scale))
            })
        };
        let candidates = |reach: f64| (0..self.levels.lattices.len()).flat_map(move |level| of_level(level, reach));
        let sees = |point: u32| !(near && obstacles.block(from, self.positions[point as usize]));
        linear_shares(own.to_axes(facet.normal), [rows + 0.5, 1.0], candidates, sees)
    }
}

/// Forces at full load, plate axes, N. What sharing leaves of resultant and moment is removed where nothing holds the plate.
/// Errors: a load without points, loads out of balance on a plate that nothing holds.
pub fn forces(specimen: &Specimen, sharing: &Sharing<'_>, floating: bool) -> Result<Vec<(u32, Point)>> {
    let finest = sharing.levels.finest().spacing;
    let mut sums = BTreeMap::<u32, Point>::new();
    for piece in load_pieces(specimen, finest) {
        let shares = sharing.of(&piece.facet);
        if shares.is_empty() {
            let [x, y] = piece.facet.at.map(|x| 1e3 * x);
            let problem = format!("no point of the plate near the load at x = {x:.3} mm, y = {y:.3} mm; reduce the spacing");
            return Err(Error::Mechanics(problem));
        }
        for (point, share) in shares {
            let sum = sums.entry(point).or_default();
            *sum = [sum[0] + share * piece.force[0], sum[1] + share * piece.force[1]];
        }
    }
    let mut forces: Vec<(u32, Point)> = sums.into_iter().collect();
    if floating {
        let mut seated: Vec<(Point, Point)> = forces.iter().map(|&(p, f)| (sharing.positions[p as usize], f)).collect();
        balance(&mut seated, 0.0)?;
        forces.iter_mut().zip(seated).for_each(|(force, (_, balanced))| force.1 = balanced);
    }
    Ok(forces)
}
