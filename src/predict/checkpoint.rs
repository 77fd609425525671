//! What it takes to go on with a run that was broken off.
//!
//! Now and then a run builds its solver anew from the bonds, at the same places however it is interrupted: where it has to work on
//! the whole plate anyway ([`crate::solver::Equilibrium::is_due`]), or every so many blocks. There everything numeric that follows
//! depends only on what stands here, so that a run taken up there gives the same curve as one that nobody interrupted, bit for bit,
//! on the same kind of processor.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::snapshot::Album;
use super::{Progress, Snapshot};
use crate::case::Case;
use crate::error::Result;
use crate::growth::{CrackGrowth, State};
use crate::sealed::{Seal, refused};

const SEAL: Seal = Seal { magic: b"perilife checkpoint\n", form: 3 };

/// State of a run at one of the places where its solver is built anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Hash of what the case says.
    case: [u8; 32],
    cycles: f64,
    crack_length: f64,
    share: f64,
    album: Pictures,
    /// Time spent on the run so far, s.
    wall_s: f64,
    growth: State,
}

/// Pictures so far.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Pictures {
    step: f64,
    next: f64,
    all: Vec<Picture>,
}

/// A snapshot with the damage of the few points that have any.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Picture {
    cycles: f64,
    crack_length: f64,
    displacement: Vec<[f64; 2]>,
    damage: Vec<(u32, f64)>,
}

impl Checkpoint {
    /// Where a run of a case with this [`hash`] stands.
    pub(super) fn new(case: [u8; 32], growth: State, album: &Album, progress: &Progress, wall_s: f64) -> Self {
        let Progress { cycles, crack_length, share } = *progress;
        Checkpoint { case, cycles, crack_length, share, album: Pictures::of(album), wall_s, growth }
    }

    /// Puts a run at its start where this one stood; returns its pictures, and the time spent on it so far, s.
    ///
    /// # Errors
    /// It is that of another law or plate.
    pub(super) fn restore(self, growth: &mut dyn CrackGrowth) -> Result<(Album, f64)> {
        let picture_fits =
            |picture: &Picture| picture.damage.iter().all(|(point, _)| (*point as usize) < picture.displacement.len());
        if self.album.all.iter().all(picture_fits) && growth.restore(self.growth)? {
            return Ok((self.album.into_album(), self.wall_s));
        }
        Err(refused("is that of another plate or law"))
    }

    /// How far the run had come.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress { cycles: self.cycles, crack_length: self.crack_length, share: self.share }
    }

    /// Whether it is that of a run of this case, by all that decides how the run goes; its name and where the file lies do not.
    #[must_use]
    pub fn belongs_to(&self, case: &Case) -> bool {
        self.case == hash(case)
    }

    /// Refuses the checkpoint of another case.
    ///
    /// # Errors
    /// [`crate::Error::Input`].
    pub fn check(&self, case: &Case) -> Result<()> {
        if self.belongs_to(case) { Ok(()) } else { Err(refused("belongs to another case, or to this one before it was changed")) }
    }

    /// As bytes, with a checksum.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        SEAL.to_bytes(self)
    }

    /// From what [`Checkpoint::to_bytes`] gave.
    ///
    /// # Errors
    /// As [`Seal::read`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Checkpoint> {
        SEAL.read(bytes)
    }
}

impl Pictures {
    fn of(album: &Album) -> Self {
        let damaged = |(point, &damage): (usize, &f64)| (damage != 0.0).then_some((point as u32, damage));
        let picture = |snapshot: &Snapshot| Picture {
            cycles: snapshot.cycles,
            crack_length: snapshot.crack_length,
            displacement: snapshot.displacement.clone(),
            damage: snapshot.damage.iter().enumerate().filter_map(damaged).collect(),
        };
        Pictures { step: album.step, next: album.next, all: album.snapshots.iter().map(picture).collect() }
    }

    fn into_album(self) -> Album {
        let snapshot = |picture: Picture| {
            let mut damage = vec![0.0; picture.displacement.len()];
            picture.damage.iter().for_each(|&(point, share)| damage[point as usize] = share);
            let Picture { cycles, crack_length, displacement, .. } = picture;
            Snapshot { cycles, crack_length, displacement, damage }
        };
        Album { snapshots: self.all.into_iter().map(snapshot).collect(), step: self.step, next: self.next }
    }
}

/// Hash of all that decides how the run of a case goes.
pub(super) fn hash(case: &Case) -> [u8; 32] {
    let Case { specimen, material, loading, model, fatigue, law, stop, .. } = case;
    // Debug output of floats says them to the last bit.
    let all = format!("{:?}", (specimen, material, loading, model, fatigue, law, stop));
    Sha256::digest(all).into()
}
