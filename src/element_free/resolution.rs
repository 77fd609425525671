//! How fine the nodes are, and where.
//!
//! The spacing is `far` but for halvings: at a tip down to the `hold`-th part of its room, the least of its distance from rims and other
//! cracks, the length of its crack (half of it with two tips) and its growth since a kink; around holes and concave arcs of the
//! outline to R/2.4; across every ligament to a third of it.

use super::basis::{BasisKind, Enrichment};
use super::field::Tip;
use super::grid::{Grid, Source};
use super::sources::ACROSS_LIGAMENT;
use crate::error::{Error, Result};
use crate::specimen::geometry::bounding_box;
use crate::specimen::{CrackLine, Specimen};
use crate::units::{MM, place_mm};

/// Reach of a tip, in spacings of the coarser level.
const TIP_REACH: f64 = 4.0;
/// Cells at the most.
const CELLS_MOST: usize = 200_000;

/// How fine nodes are, and what they carry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Spacing far from everything, m.
    pub far: f64,
    /// Spacings in the room of a tip.
    pub hold: f64,
    /// Spacings in the radius of a hole or fillet.
    pub in_radius: f64,
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
        if cells > CELLS_MOST as f64 {
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
        let grid = Grid::new(bounds, self.far, &sources, CELLS_MOST);
        let finest = sources.iter().min_by(|a, b| a.spacing.total_cmp(&b.spacing));
        if let Some(finest) = finest.filter(|_| grid.len() > CELLS_MOST) {
            return Err(too_narrow(finest));
        }
        let at_tip = |tip: &Tip| grid.spacing(grid.leaf(lines[tip.end.line].end(tip.end.at_last)));
        let spacings = tips.iter().map(at_tip).collect();
        Ok((grid, spacings))
    }
}

/// What is said where a gap asks for more cells than there may be.
fn too_narrow(finest: &Source) -> Error {
    Error::Mechanics(format!(
        "cracks or rims near {} ask for nodes {:.2e} mm apart, and for more than {CELLS_MOST} cells of integration in all: \
         move apart, or join, what lies {:.2e} mm from each other there",
        place_mm(finest.at),
        finest.spacing / MM,
        ACROSS_LIGAMENT * finest.spacing / MM
    ))
}

/// Room of a tip, m.
pub fn room(specimen: &Specimen, lines: &[CrackLine], tip: &Tip) -> f64 {
    let at = lines[tip.end.line].end(tip.end.at_last);
    let others = lines.iter().enumerate().filter(|(other, _)| *other != tip.end.line).map(|(_, line)| line.distance(at));
    others.fold(specimen.rim_distance(at), f64::min).min(tip.length)
}

/// How fine nodes are and how long steps of cracks are, of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementFreeSettings {
    /// Nodes.
    pub resolution: Resolution,
    /// Growth of a tip in an increment at the most, over the length of its crack and the room ahead of it.
    pub step_share: f64,
}
