//! How fine the nodes are, and where.
//!
//! The spacing is `far` but for halvings: at a tip down to the `hold`-th part of its room, the least of its distance from rims and other
//! cracks, the length of its crack (half of it with two tips) and its growth since a kink; around holes to R/2.4; across every ligament to
//! a third of it.

use super::basis::{BasisKind, Enrichment};
use super::field::Tip;
use super::grid::{Grid, Source};
use super::rims::stretches;
use crate::error::{Error, Result};
use crate::specimen::geometry::{bounding_box, distance, distance_to_segment, edges, meeting_share, segments_touch};
use crate::specimen::{CrackLine, Point, Specimen};

/// Reach of a tip, in spacings of the coarser level.
const TIP_REACH: f64 = 4.0;
/// Reach of rims and ligaments, in spacings of the coarser level.
const RIM_REACH: f64 = 1.5;
/// Spacings in the radius of a hole.
const IN_RADIUS: f64 = 2.4;
/// Spacings across a ligament.
const ACROSS_LIGAMENT: f64 = 3.0;
/// Gap over the way along a crack to its mouth below which it is the wedge between the crack and the rim that it starts from: no load
/// goes there.
const WEDGE: f64 = 0.7;
/// Cells of the first level at the most.
const CELLS_MOST: f64 = 2e5;

/// How fine nodes are, and what they carry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Spacing far from everything, m.
    pub far: f64,
    /// Spacings in the room of a tip.
    pub hold: f64,
    /// Radius of influence of a node, in its spacings.
    pub support: f64,
    /// Polynomials.
    pub basis: BasisKind,
    /// Near-tip fields.
    pub enrichment: Enrichment,
}

impl Resolution {
    /// Cells of a plate with these cracks, and the spacing asked for at every tip, m.
    ///
    /// # Errors
    /// [`Error::Mechanics`] where the plate would have too many cells.
    pub fn grid(&self, specimen: &Specimen, lines: &[CrackLine], tips: &[Tip]) -> Result<(Grid, Vec<f64>)> {
        let bounds = bounding_box(&specimen.outline);
        let [width, height] = [0, 1].map(|i| bounds[1][i] - bounds[0][i]);
        let cells = width * height / (self.far * self.far);
        if cells > CELLS_MOST {
            return Err(Error::Mechanics(format!("{cells:.1e} cells of integration would be needed; give fewer model.nodes")));
        }
        let mut sources = Vec::new();
        for tip in tips {
            let spacing = room(specimen, lines, tip) / self.hold;
            let at = lines[tip.end.line].end(tip.end.at_last);
            sources.push(Source { at, radius: 0.0, spacing, reach: TIP_REACH });
        }
        sources.extend(self.of_rims(specimen));
        sources.extend(self.of_cracks(specimen, lines, tips));
        let grid = Grid::new(bounds, self.far, &sources);
        let at_tip = |tip: &Tip| grid.spacing(grid.leaf(lines[tip.end.line].end(tip.end.at_last)));
        let spacings = tips.iter().map(at_tip).collect();
        Ok((grid, spacings))
    }

    /// Holes by their radius, and ligaments between rims by the way straight into the material.
    fn of_rims(&self, specimen: &Specimen) -> Vec<Source> {
        let holes = specimen.holes.iter().map(|hole| Source {
            at: hole.centre,
            radius: hole.radius,
            spacing: hole.radius / IN_RADIUS,
            reach: RIM_REACH,
        });
        let mut sources: Vec<Source> = holes.collect();
        let rims = stretches(specimen);
        let reach = ACROSS_LIGAMENT * self.far;
        let walls: Vec<[Point; 2]> = edges(&specimen.outline)
            .chain(specimen.slots.iter().flat_map(|slot| edges(&slot.corners()).collect::<Vec<_>>()))
            .map(|(a, b)| [a, b])
            .collect();
        for (_, stretch) in &rims {
            let count = (2.0 * stretch.length() / self.far).ceil().clamp(2.0, 400.0) as usize;
            for k in 0..count {
                let share = (k as f64 + 0.5) / count as f64;
                let (from, [x, y]) = (stretch.at(share), stretch.inward(share));
                let start = [from[0] + 1e-6 * reach * x, from[1] + 1e-6 * reach * y];
                let to = [from[0] + reach * x, from[1] + reach * y];
                if !specimen.contains(start) {
                    continue;
                }
                let straight = walls.iter().filter(|[a, b]| segments_touch(start, to, *a, *b));
                let straight = straight.filter_map(|[a, b]| meeting_share(start, to, *a, *b));
                let round = specimen.holes.iter().filter_map(|hole| first_in_hole(start, to, hole.centre, hole.radius));
                let nearest = straight.chain(round).filter(|share| *share > 0.0).fold(2.0, f64::min);
                if nearest <= 1.0 {
                    let width = nearest * reach;
                    let at = [from[0] + 0.5 * width * x, from[1] + 0.5 * width * y];
                    sources.push(Source { at, radius: 0.0, spacing: width / ACROSS_LIGAMENT, reach: RIM_REACH });
                }
            }
        }
        sources
    }

    /// Gaps between cracks and rims, and between cracks.
    fn of_cracks(&self, specimen: &Specimen, lines: &[CrackLine], tips: &[Tip]) -> Vec<Source> {
        let mut sources = Vec::new();
        let rims = stretches(specimen);
        let reach = ACROSS_LIGAMENT * self.far;
        for (own, line) in lines.iter().enumerate() {
            let is_tip = |at_last: bool| tips.iter().any(|tip| tip.end.line == own && tip.end.at_last == at_last);
            let mouths: Vec<(bool, Point)> =
                [false, true].into_iter().filter(|end| !is_tip(*end)).map(|end| (end, line.end(end))).collect();
            let (total, mut way) = (line.length(), 0.0);
            for [a, b] in line.pieces() {
                let length = distance(a, b);
                let count = (2.0 * length / self.far).ceil().max(1.0) as usize;
                for k in 0..count {
                    let share = (k as f64 + 0.5) / count as f64;
                    let at = [0, 1].map(|i| a[i] + share * (b[i] - a[i]));
                    let along = way + share * length;
                    // Whether something at this distance from the crack forms a wedge with it.
                    let is_wedge = |gap: f64, from: &dyn Fn(Point) -> f64| {
                        let way = |at_last: bool| if at_last { total - along } else { along };
                        mouths.iter().any(|&(end, mouth)| from(mouth) < 1e-6 * total && gap < WEDGE * way(end))
                    };
                    let mut gap = f64::INFINITY;
                    for (_, rim) in &rims {
                        let from = |at: Point| rim.distance(at);
                        if !is_wedge(from(at), &from) {
                            gap = gap.min(from(at));
                        }
                    }
                    for (_, other) in lines.iter().enumerate().filter(|(other, _)| *other != own) {
                        let from = |at: Point| other.distance(at);
                        if !is_wedge(from(at), &from) {
                            gap = gap.min(from(at));
                        }
                    }
                    if gap < reach {
                        sources.push(Source { at, radius: 0.0, spacing: gap / ACROSS_LIGAMENT, reach: RIM_REACH });
                    }
                }
                way += length;
            }
        }
        sources
    }
}

/// Room of a tip, m.
#[must_use]
pub fn room(specimen: &Specimen, lines: &[CrackLine], tip: &Tip) -> f64 {
    let at = lines[tip.end.line].end(tip.end.at_last);
    let others = lines.iter().enumerate().filter(|(other, _)| *other != tip.end.line).map(|(_, line)| line.distance(at));
    others.fold(specimen.rim_distance(at), f64::min).min(tip.length)
}

/// Share of a segment at which it first comes into a hole.
fn first_in_hole(from: Point, to: Point, centre: Point, radius: f64) -> Option<f64> {
    if distance_to_segment(centre, from, to) >= radius {
        return None;
    }
    let (d, f) = ([to[0] - from[0], to[1] - from[1]], [from[0] - centre[0], from[1] - centre[1]]);
    let (dd, df, ff) = (d[0] * d[0] + d[1] * d[1], d[0] * f[0] + d[1] * f[1], f[0] * f[0] + f[1] * f[1]);
    let share = (-df - (df * df - dd * (ff - radius * radius)).sqrt()) / dd;
    (share > 0.0).then_some(share)
}

/// How fine nodes are and how long steps of cracks are, of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementFreeSettings {
    /// Nodes.
    pub resolution: Resolution,
    /// Growth of a tip in an increment at the most, over the length of its crack and the room ahead of it.
    pub step_share: f64,
}
