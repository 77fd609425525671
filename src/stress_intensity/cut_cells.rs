//! Cells of the lattice that a rim or a crack cuts, in parts.
//!
//! A point stands for the cell around it. Where a rim or a crack runs through the cell, part of it is void, or belongs to points on
//! the other side, and the fields there are those of that side. Such cells are divided, and every part in the material is given to the nearest point that
//! sees it.

use std::collections::HashSet;

use crate::body::Body;
use crate::specimen::geometry::{along, distance, distance_to_segment, segments_touch};
use crate::specimen::{Point, Specimen};

/// Parts of a cell along either axis.
const PARTS: usize = 4;
/// Places per spacing at which a line is asked which cells it cuts.
const PER_SPACING: f64 = 8.0;

/// Distance in spacings within which a position lies on the line between two cells: more than cracks are drawn aside.
const BESIDE: f64 = 0.01;

/// Difference of distances, in spacings, that is none: points that are equally near share a part.
const EQUAL: f64 = 1e-6;

/// A part of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Its middle, m.
    pub at: Point,
    /// The point whose field it has.
    pub place: usize,
    /// Its area over that of a cell.
    pub share: f64,
}

/// Cells that hold a position; both where it lies on the line between two, so that mirror images stay mirror images.
pub fn cells_at(body: &Body, at: Point) -> impl Iterator<Item = usize> + '_ {
    let lattice = &body.lattice;
    let (columns, rows) = (lattice.columns as f64, lattice.rows as f64);
    let [column, row] = lattice.locate(at);
    [[-BESIDE, -BESIDE], [BESIDE, -BESIDE], [-BESIDE, BESIDE], [BESIDE, BESIDE]].into_iter().filter_map(move |[dx, dy]| {
        let (column, row) = ((column + dx).round(), (row + dy).round());
        let is_inside = (0.0..columns).contains(&column) && (0.0..rows).contains(&row);
        is_inside.then(|| lattice.place(column as usize, row as usize))
    })
}

/// Cells that straight pieces cut.
pub fn cells_along<'a>(body: &'a Body, pieces: &'a [[Point; 2]]) -> impl Iterator<Item = usize> + 'a {
    pieces.iter().flat_map(move |&[a, b]| {
        let count = (PER_SPACING * distance(a, b) / body.lattice.spacing).ceil().max(1.0);
        (0..=count as usize).flat_map(move |i| cells_at(body, along(a, b, i as f64 / count)))
    })
}

/// Parts of these cells that are material, each with the nearest point that sees it, of those that are `known`.
pub fn parts(
    body: &Body,
    specimen: &Specimen,
    cracks: &[[Point; 2]],
    cells: &HashSet<usize>,
    known: impl Fn(usize) -> bool,
) -> Vec<Part> {
    let lattice = &body.lattice;
    let neighbours: Vec<isize> = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| lattice.step(dx, dy))).collect();
    let mut cells: Vec<usize> = cells.iter().copied().collect();
    // The same sum on every run.
    cells.sort_unstable();
    let mut parts = Vec::with_capacity(cells.len() * PARTS * PARTS);
    for cell in cells {
        let (column, row) = lattice.column_row(cell);
        let near: Vec<(usize, Point)> = neighbours
            .iter()
            .filter_map(|&step| cell.checked_add_signed(step))
            .filter(|&place| body.is_point.get(place).is_some_and(|&is_point| is_point) && known(place))
            .map(|place| (place, lattice.position(place)))
            .collect();
        let centre = lattice.position(cell);
        let reach = 2.2 * lattice.spacing;
        let cracks: Vec<&[Point; 2]> = cracks.iter().filter(|[a, b]| distance_to_segment(centre, *a, *b) < reach).collect();
        for i in 0..PARTS * PARTS {
            let offset = |i: usize| (i as f64 + 0.5) / PARTS as f64 - 0.5;
            let at = lattice.position_of(column as f64 + offset(i % PARTS), row as f64 + offset(i / PARTS));
            if !specimen.contains(at) {
                continue;
            }
            let sees = |from: Point| !cracks.iter().any(|[a, b]| segments_touch(at, from, *a, *b));
            let seen: Vec<(usize, f64)> =
                near.iter().filter(|(_, from)| sees(*from)).map(|&(place, from)| (place, distance(from, at))).collect();
            let least = seen.iter().map(|(_, away)| *away).fold(f64::INFINITY, f64::min) + EQUAL * lattice.spacing;
            let nearest: Vec<usize> = seen.into_iter().filter(|(_, away)| *away <= least).map(|(place, _)| place).collect();
            let share = 1.0 / (PARTS * PARTS * nearest.len()) as f64;
            parts.extend(nearest.into_iter().map(|place| Part { at, place, share }));
        }
    }
    parts
}
