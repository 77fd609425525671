//! K_I, K_II and T of a tip off a ring around it, for every driver.
//!
//! Around the place to which the cut bonds reach, the field shows where it has its tip; around that place its factors are read. About
//! another place by x the term r^{3/2} of the field counts, too: K of a short central crack is read low by 3x/8a.

use perilife_plate::specimen::{CrackLine, LineEnd};
use perilife_points::body::Body;
use perilife_points::state::Bonds;
use perilife_points::stress_intensity::ring::{Balanced, FlankPressure, RingFactors, RingGeometry};

/// Outer radius of the ring, in horizons, where there is room. On three horizons K is read 0.1 % lower, and first kinks of one crack on
/// lattices of all directions spread over 0.7° instead of 0.4°.
pub(crate) const RING_HORIZONS: f64 = 4.0;
/// Outer radius below which a ring says nothing, in horizons.
pub(super) const RING_HORIZONS_MIN: f64 = 1.2;
/// Turn of a corner, rad, beyond which it is a bend by itself and no part of an arc.
const BEND: f64 = 0.45;
/// Distance from a rim ahead, in horizons, within which the core of the tip is not that of a crack in a plate.
pub(crate) const CORE_HORIZONS: f64 = 0.6;

/// Length of crack, in spacings, below which its last piece shows no direction: of a tip that hardly grows it is round-off.
pub(super) const DIRECTION_SPACINGS: f64 = 0.1;

/// A plate in equilibrium with what rings of its tips need.
#[derive(Clone, Copy)]
pub(crate) struct TipRings<'a> {
    pub body: &'a Body,
    pub bonds: &'a Bonds,
    pub displacement: &'a [f64],
    /// Maximum load, Pa or N.
    pub load: f64,
    pub geometry: &'a RingGeometry,
    pub lines: &'a [CrackLine],
    /// Tips that have not ended: rings do not reach them.
    pub active: &'a [LineEnd],
    /// Whether the cracks are as they were drawn.
    pub is_new: bool,
    pub pressures: &'a [FlankPressure],
}

impl TipRings<'_> {
    /// The field around the same place; where there is no room for a ring, off the least one.
    pub(crate) fn read(&self, end: LineEnd, offset: f64) -> RingFactors {
        let TipRings { body, bonds, displacement, load, geometry, pressures, .. } = *self;
        let mut lines = self.lines.to_vec();
        lines[end.line] = lines[end.line].blunted(end.at_last, DIRECTION_SPACINGS * body.lattice.spacing);
        lines[end.line].stretch(end.at_last, offset);
        let radius = self.radius(&lines, end).max(RING_HORIZONS_MIN * body.horizon());
        geometry.factors(Balanced { body, bonds, displacement, load, lines: &lines, pressures }, end, radius)
    }

    /// Outer radius that the surroundings leave, m.
    fn radius(&self, lines: &[CrackLine], end: LineEnd) -> f64 {
        // Faces behind one bend are taken in; along an arc they leave nothing straight.
        let straight = if self.is_new { lines[end.line].straight_way(end.at_last, BEND) } else { f64::INFINITY };
        let wanted = (RING_HORIZONS * self.body.horizon()).min(straight.max(RING_HORIZONS_MIN * self.body.horizon()));
        self.geometry.radius(self.body, lines, end, self.active, wanted)
    }
}
