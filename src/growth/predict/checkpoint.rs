//! What it takes to go on with a run that was broken off.
//!
//! Now and then a run builds its solver anew from the bonds, at the same places however it is interrupted: where it has to work on
//! the whole plate anyway ([`perilife_points::solver::Equilibrium::should_rebuild`]), or every so many blocks. There everything numeric that follows
//! depends only on what stands here, so that a run taken up there gives the same curve as one that nobody interrupted, bit for bit,
//! on the same kind of processor.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::chain::{Chain, ChainState};
use super::outcome::Progress;
use super::snapshot::Snapshots;
use crate::case::Case;
use perilife_base::error::Result;
use perilife_base::raster::Snapshot;
use perilife_base::sealed::{Seal, dense, refused, sparse};

/// First bytes of a checkpoint.
pub const SIGN: &[u8] = b"perilife checkpoint\n";
const SEAL: Seal = Seal { of: "this program", magic: SIGN, form: 9 };

/// State of a run at one of the places where its solver is built anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Hash of what the case says.
    case: [u8; 32],
    cycles: f64,
    crack_length: f64,
    share: f64,
    snapshots: Pictures,
    /// Time spent on the run so far, s.
    wall_s: f64,
    chain: ChainState,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Pictures {
    step: f64,
    next: f64,
    all: Vec<Picture>,
}

/// A snapshot with the damage and the remaining life of the few points that have lost some.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Picture {
    cycles: f64,
    crack_length: f64,
    displacement: Vec<[f64; 2]>,
    damage: Vec<(u32, f64)>,
    remaining_life: Vec<(u32, f64)>,
    stress: Vec<f64>,
}

impl Checkpoint {
    /// Where a run of a case with this [`hash`] stands.
    pub(super) fn new(case: [u8; 32], chain: ChainState, snapshots: &Snapshots, progress: &Progress, wall_s: f64) -> Self {
        let Progress { cycles, crack_length, share } = *progress;
        Checkpoint { case, cycles, crack_length, share, snapshots: Pictures::of(snapshots), wall_s, chain }
    }

    /// Puts a run at its start where this one stood; returns its pictures, and the time spent on it so far, s.
    /// Errors: it is that of another law or plate.
    pub(super) fn restore(self, chain: &mut Chain<'_>) -> Result<(Snapshots, f64)> {
        let picture_fits = |picture: &Picture| {
            let mut points = picture.damage.iter().chain(&picture.remaining_life);
            points.all(|(point, _)| (*point as usize) < picture.displacement.len())
        };
        if self.snapshots.all.iter().all(picture_fits) && chain.restore(self.chain)? {
            return Ok((self.snapshots.into_snapshots(), self.wall_s));
        }
        Err(refused("is that of another plate or law"))
    }

    /// How far the run had come.
    pub fn progress(&self) -> Progress {
        Progress { cycles: self.cycles, crack_length: self.crack_length, share: self.share }
    }

    /// Whether it is that of a run of this case, by all that decides how the run goes; its name and where the file lies do not.
    pub fn belongs_to(&self, case: &Case) -> bool {
        self.case == hash(case)
    }

    /// Refuses the checkpoint of another case.
    pub fn check(&self, case: &Case) -> Result<()> {
        if self.belongs_to(case) { Ok(()) } else { Err(refused("is for a different case (or the case was edited)")) }
    }

    /// As bytes, with a checksum.
    pub fn to_bytes(&self) -> Vec<u8> {
        SEAL.to_bytes(self)
    }

    /// From what [`Checkpoint::to_bytes`] gave.
    pub fn from_bytes(bytes: &[u8]) -> Result<Checkpoint> {
        SEAL.read(bytes)
    }
}

impl Pictures {
    fn of(snapshots: &Snapshots) -> Self {
        let picture = |snapshot: &Snapshot| Picture {
            cycles: snapshot.cycles,
            crack_length: snapshot.crack_length,
            displacement: snapshot.displacement.clone(),
            damage: sparse(&snapshot.damage, 0.0),
            remaining_life: sparse(&snapshot.remaining_life, 1.0),
            stress: snapshot.stress.clone(),
        };
        Pictures { step: snapshots.step, next: snapshots.next, all: snapshots.taken.iter().map(picture).collect() }
    }

    fn into_snapshots(self) -> Snapshots {
        let snapshot = |picture: Picture| {
            let points = picture.displacement.len();
            Snapshot {
                cycles: picture.cycles,
                crack_length: picture.crack_length,
                damage: dense(&picture.damage, 0.0, points),
                remaining_life: dense(&picture.remaining_life, 1.0, points),
                stress: picture.stress,
                displacement: picture.displacement,
            }
        };
        Snapshots { taken: self.all.into_iter().map(snapshot).collect(), step: self.step, next: self.next }
    }
}

/// Hash of all that decides how the run of a case goes.
pub fn hash(case: &Case) -> [u8; 32] {
    let Case { specimen, material, loading, model, fatigue, retardation, law, stop, .. } = case;
    // Debug output of floats says them to the last bit.
    let all = format!("{:?}", (specimen, material, loading, model, fatigue, retardation, law, stop));
    Sha256::digest(all).into()
}
