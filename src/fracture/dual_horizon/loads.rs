//! Tractions on the rim as forces on points of several levels.

use std::collections::BTreeMap;

use super::levels::Levels;
use crate::body::boundary::{LoadPiece, balance, load_pieces};
use crate::body::facets::behind;
use crate::error::{Error, Result};
use crate::specimen::{Point, Specimen};

/// Places of the finest level within which the point nearest to a load is searched, if it lies in no point's cell.
const SEARCH: i64 = 12;

/// Forces at full load, plate axes, N. The rim is cut into pieces much shorter than the finest spacing; a piece goes to the point
/// whose cell it bounds, so that the end points of a stretch of uniform traction carry as much rim as they have. What that leaves
/// of resultant and moment is removed where nothing holds the plate.
///
/// # Errors
/// A load without points, loads out of balance on a plate that nothing holds.
pub fn forces(specimen: &Specimen, levels: &Levels, positions: &[Point], floating: bool) -> Result<Vec<(u32, Point)>> {
    // A lattice has a level at least.
    let spacing = levels.lattices[levels.lattices.len() - 1].spacing;
    let mut sums = BTreeMap::<u32, Point>::new();
    for piece in load_pieces(specimen, spacing) {
        let sum = sums.entry(seat(&piece, levels, positions, spacing)?).or_default();
        *sum = [sum[0] + piece.force[0], sum[1] + piece.force[1]];
    }
    let mut forces: Vec<(u32, Point)> = sums.into_iter().collect();
    if floating {
        let mut seated: Vec<(Point, Point)> = forces.iter().map(|&(p, f)| (positions[p as usize], f)).collect();
        balance(&mut seated, 0.0)?;
        forces.iter_mut().zip(seated).for_each(|(force, (_, balanced))| force.1 = balanced);
    }
    Ok(forces)
}

/// The point that takes a piece.
fn seat(piece: &LoadPiece, levels: &Levels, positions: &[Point], spacing: f64) -> Result<u32> {
    let at = behind(&piece.facet, spacing);
    let finest = &levels.lattices[levels.lattices.len() - 1];
    let [column, row] = finest.locate(at).map(|i| i.round() as i64);
    if let Some(point) = levels.point_over(column, row) {
        return Ok(point as u32);
    }
    // Rounded rims pass through cells whose middle lies outside.
    let around = (-SEARCH..=SEARCH).flat_map(|dy| (-SEARCH..=SEARCH).map(move |dx| (column + dx, row + dy)));
    let away = |point: &usize| (positions[*point][0] - at[0]).hypot(positions[*point][1] - at[1]);
    let near = around.filter_map(|(column, row)| levels.point_over(column, row));
    let nearest = near.min_by(|a, b| away(a).total_cmp(&away(b)).then(a.cmp(b)));
    nearest.map(|point| point as u32).ok_or_else(|| {
        let [x, y] = at.map(|x| 1e3 * x);
        Error::Mechanics(format!("no point of the plate lies near the load at x = {x:.3} mm, y = {y:.3} mm; give a smaller spacing"))
    })
}
