//! What it takes to go on with a run that was broken off.
//!
//! Now and then a run builds its solver anew from the bonds, at the same places however it is interrupted: where it has to work on
//! the whole plate anyway ([`perilife_points::solver::Equilibrium::should_rebuild`]), or every so many blocks. There everything numeric that follows
//! depends only on what stands here, so that a run taken up there gives the same curve as one that nobody interrupted, bit for bit,
//! on the same kind of processor.

use serde::{Deserialize, Serialize};

use super::chain::{Chain, ChainState};
use super::outcome::Progress;
use super::snapshot::Snapshots;
use crate::case::Case;
use perilife_base::error::Result;
use perilife_base::sealed::{self, Kept, Seal, hash_of, refused};

/// First bytes of a checkpoint.
pub const SIGN: &[u8] = b"perilife checkpoint\n";

/// State of a run at one of the places where its solver is built anew.
pub type Checkpoint = sealed::Checkpoint<KeptRun>;

/// All that a run goes on from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeptRun {
    /// How far the run had come.
    pub progress: Progress,
    snapshots: Snapshots,
    chain: ChainState,
}

impl Kept for KeptRun {
    type Input = Case;
    const SEAL: Seal = Seal { of: "this program", magic: SIGN, form: 10 };
    const OF_ANOTHER: &'static str = "is for a different case (or the case was edited)";

    fn hash(case: &Case) -> [u8; 32] {
        let Case { specimen, material, loading, model, fatigue, retardation, law, stop, .. } = case;
        hash_of(&(specimen, material, loading, model, fatigue, retardation, law, stop))
    }
}

impl KeptRun {
    /// Where a run is.
    pub(super) fn of(chain: &Chain<'_>, snapshots: &Snapshots, progress: &Progress) -> Self {
        KeptRun { progress: *progress, snapshots: snapshots.clone(), chain: chain.state() }
    }

    /// Puts a run at its start where this one was; returns its pictures.
    /// Errors: it is that of another law or plate.
    pub(super) fn restore(self, chain: &mut Chain<'_>) -> Result<Snapshots> {
        if chain.restore(self.chain)? { Ok(self.snapshots) } else { Err(refused("is that of another plate or law")) }
    }
}
