//! All that a run carries from block to block. The displacement is not among it: the solver makes it of the bonds.

use super::history::GrowthHistory;
use crate::body::{Body, Bond};
use crate::case::Case;
use crate::fatigue::ageing::BondLife;
use crate::fatigue::crack_tip::CrackTip;
use crate::state::Bonds;

/// Where a run stands.
pub(super) struct RunState {
    /// Which bonds carry.
    pub bonds: Bonds,
    /// What life is left to them.
    pub life: BondLife,
    /// Tips of the cracks.
    pub tips: Vec<CrackTip>,
    /// Bonds that come near the critical stretch, also away from the tips.
    pub near_limit: Vec<Bond>,
    /// The curve so far.
    pub track: GrowthHistory,
    /// Bonds broken since the start, those set aside not counted.
    pub broken_bonds: usize,
    /// Equilibrium solves.
    pub solves: usize,
    /// Solver iterations.
    pub iterations: usize,
    /// Whether a window was condensed; a solver that is built anew has none at first.
    pub had_window: bool,
}

impl RunState {
    /// The start of a run with these tips, all bonds but those of the initial cracks whole.
    pub(super) fn start(case: &Case, body: &Body, tips: Vec<CrackTip>) -> Self {
        let bonds = Bonds::new(body);
        RunState {
            life: BondLife::whole(bonds.multiplier.len()),
            track: GrowthHistory::new(case),
            near_limit: Vec::new(),
            broken_bonds: 0,
            solves: 0,
            iterations: 0,
            had_window: false,
            bonds,
            tips,
        }
    }
}
