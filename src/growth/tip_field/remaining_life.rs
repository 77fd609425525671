//! Remaining life λ of the bonds ahead of tips that grow by their K.
//!
//! The law of a bond, `dλ/dN = -A ε^p`, makes a tip grow steadily at `da/dN = β A δ^(1-p/2) (K_eq/E')^p`
//! ([`crate::fatigue::rate_constant`]): on the length ℓ of the fatigue zone ahead of the tip a bond that the line crosses loses its whole
//! remaining life. Here the rate is known from K, so that these bonds lose it at `dλ/dN = -(da/dN)/ℓ`: λ is 1 where the line crosses
//! them ℓ ahead of the tip and falls linearly to 0 at the tip. Remaining life never rises: bonds beside a crack that has turned away
//! keep what they have left.

use super::{Tip, TipField};
use crate::body::Bond;
use crate::body::pre_crack::bonds_across;
use crate::fatigue::ZONE_RADIUS_HORIZONS;
use crate::fatigue::crack_tip::TipState;
use crate::specimen::geometry::meeting_share;

impl TipField<'_> {
    /// Lets the bonds ahead of all active tips lose remaining life up to where the tips are now; broken bonds are left out.
    pub(super) fn update_remaining_life(&mut self) {
        let body = &self.plate.body;
        let length = ZONE_RADIUS_HORIZONS * body.horizon();
        let ahead = |tip: &Tip| {
            let (from, [x, y]) = (self.position(tip), self.heading(tip.end));
            let to = [from[0] + length * x, from[1] + length * y];
            let life = move |bond: Bond| {
                let (_, a, b) = body.ends(bond);
                let fraction = meeting_share(from, to, body.lattice.position(a), body.lattice.position(b))?;
                Some((bond, fraction.clamp(0.0, 1.0)))
            };
            bonds_across(body, from, to).into_iter().filter_map(life).collect::<Vec<_>>()
        };
        let new = self.state.tips.iter().filter(|tip| tip.state == TipState::Active).flat_map(ahead);
        let mut lives: Vec<(Bond, f64)> = self.state.remaining_life.iter().copied().chain(new).collect();
        lives.retain(|&(bond, _)| self.bonds.is_intact(bond));
        // Of equal bonds the least life comes first and stays.
        lives.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        lives.dedup_by_key(|(bond, _)| *bond);
        self.state.remaining_life = lives;
    }
}
