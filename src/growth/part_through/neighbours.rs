//! What further holes of a plate do to K of a crack that does not go through: compounding with the through crack of the same length.
//!
//! `K = K_alone Q(c)`, `Q(c) = K_2D(c, all holes)/K_2D(c, own hole alone)`, both K on nodes, of through cracks of length c in the plate at hand
//! (compounding of Cartwright and Rooke 1974, Engng Fract. Mech. 6:563, with one factor for everything that is near). It takes the neighbours to act
//! alike on all of the front. Q is computed at a few lengths and straight between them; of several tips the largest counts.

use crate::case::Case;
use crate::cracks::initial_tips;
use crate::nodes::NodePlate;
use perilife_base::error::{Error, Result};
use perilife_plate::specimen::PartThrough;

/// Lengths at which Q is computed.
const LENGTHS: usize = 4;
/// How far they go: to where the crack may be through, growing along the face this much faster than down the thickness.
const AHEAD: f64 = 1.5;
/// Share of the way to the next rim up to which they go.
const ROOM: f64 = 0.8;

/// Q of further holes over the length of a crack on the face.
#[derive(Debug, Clone)]
pub struct Neighbours {
    /// Lengths c, m, rising, and Q there.
    rows: Vec<(f64, f64)>,
}

impl Neighbours {
    /// Of a case; `None` of a plate without further holes.
    /// Errors: no K of the through crack.
    pub fn of(case: &Case, flaw: &PartThrough) -> Result<Option<Neighbours>> {
        if case.specimen.holes.len() <= flaw.own_holes() {
            return Ok(None);
        }
        let [depth, start] = flaw.start();
        let far = start + (AHEAD * (flaw.through_depth() - depth)).max(0.5 * start);
        let end = far.min(start + ROOM * (flaw.room().min(flaw.to_hole) - start));
        let length = |i: usize| start * (end / start).powf(i as f64 / (LENGTHS - 1) as f64);
        let rows = (0..LENGTHS).map(|i| Ok((length(i), factor(case, flaw, length(i))?))).collect::<Result<_>>()?;
        Ok(Some(Neighbours { rows }))
    }

    /// Q at a length c, m; beyond the lengths that of the end.
    pub fn factor(&self, c: f64) -> f64 {
        let after = self.rows.partition_point(|(length, _)| *length < c).clamp(1, self.rows.len() - 1);
        let [(from, low), (to, high)] = [self.rows[after - 1], self.rows[after]];
        low + (high - low) * ((c - from) / (to - from)).clamp(0.0, 1.0)
    }

    /// Least and largest Q.
    pub fn range(&self) -> [f64; 2] {
        self.rows.iter().fold([f64::INFINITY, 0.0], |[low, high], (_, q)| [low.min(*q), high.max(*q)])
    }
}

/// Q at a length.
fn factor(case: &Case, flaw: &PartThrough, c: f64) -> Result<f64> {
    let all = flaw.through(&case.specimen, c)?;
    let mut alone = all.clone();
    alone.holes.drain(..all.holes.len() - flaw.own_holes());
    let [with, without] = [all, alone].map(|plate| initial_tips::<NodePlate>(&case.with_through_crack(plate)));
    let [with, without] = [with?.tips, without?.tips];
    let over = with.iter().zip(&without).filter_map(|(with, without)| Some(with.factors?[0] / without.factors?[0]));
    let most = over.fold(0.0, f64::max);
    let unknown = || Error::Mechanics(format!("{}: K of the through crack near the other holes cannot be computed", case.name));
    if most > 0.0 && most.is_finite() { Ok(most) } else { Err(unknown()) }
}
