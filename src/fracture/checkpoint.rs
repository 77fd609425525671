//! What it takes to go on with a scene that was broken off.
//!
//! A scene can be taken up where a step of it is done and taken down. Explicit motion, relaxation and marching carry all they
//! depend on from step to step; it stands here whole. Along a path of equilibrium the solver remembers more than that (its factor is
//! that of an earlier state): it is built anew after every so many states, checkpoint or not, and the path can be taken up there.
//! So a scene taken up gives the same histories as one that nobody interrupted, bit for bit, on the same kind of processor.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::SceneProgress;
use super::bonds::KeptBonds;
use super::log::Records;
use super::scene::Scene;
use crate::error::{Error, Result};
use crate::sealed::{Seal, refused};

/// First bytes of a checkpoint.
pub const SIGN: &[u8] = b"perilife scene checkpoint\n";
const SEAL: Seal = Seal { of: "a scene of this program", magic: SIGN, form: 2 };

/// State of a scene after one of its steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneCheckpoint {
    /// Hash of what the scene says.
    pub(super) scene: [u8; 32],
    /// Largest share of the run so far, 0 to 1.
    pub(super) share: f64,
    /// Time spent on the run so far, s.
    pub(super) wall_s: f64,
    pub(super) records: Records,
    pub(super) bonds: KeptBonds,
    /// Where its procedure stands, with what its interaction or its solver keeps, as bytes: the scene says which procedure it is.
    pub(super) place: Vec<u8>,
}

impl SceneCheckpoint {
    /// How far the run had come.
    pub fn progress(&self) -> SceneProgress {
        SceneProgress { share: self.share }
    }

    /// The step after which it was taken down, as `history.csv` counts them.
    pub fn step(&self) -> usize {
        self.records.last_step()
    }

    /// Whether it is that of a run of this scene, by all that decides how the run goes; its name and where the file lies do not.
    pub fn belongs_to(&self, scene: &Scene) -> bool {
        self.scene == hash(scene)
    }

    /// Refuses the checkpoint of another scene.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        if self.belongs_to(scene) {
            Ok(())
        } else {
            Err(refused("belongs to another scene, or to this one before it was changed"))
        }
    }

    /// As bytes, with a checksum.
    pub fn to_bytes(&self) -> Vec<u8> {
        SEAL.to_bytes(self)
    }

    /// From what [`SceneCheckpoint::to_bytes`] gave.
    pub fn from_bytes(bytes: &[u8]) -> Result<SceneCheckpoint> {
        SEAL.read(bytes)
    }
}

/// A checkpoint whose sizes or procedure are not those of the run.
pub(super) fn of_another() -> Error {
    refused("is that of another plate or procedure")
}

/// Hash of all that decides how the run of a scene goes.
pub(super) fn hash(scene: &Scene) -> [u8; 32] {
    let Scene { specimen, material, model, drives, holds, damage, procedure, refinement, .. } = scene;
    // Debug output of floats says them to the last bit.
    let all = format!("{:?}", (specimen, material, model, drives, holds, damage, procedure, refinement));
    Sha256::digest(all).into()
}
