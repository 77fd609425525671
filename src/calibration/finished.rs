//! Runs of a calibration that have ended: with them a calibration that was broken off goes on to the same fit, since its search
//! asks for the same runs again.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::case::CalibrationCase;
use super::model::UnitCurve;
use super::recording::Recording;
use super::surrogate::apart;
use crate::error::Result;
use crate::predict::checkpoint;
use crate::sealed::{Seal, refused};

const SEAL: Seal = Seal { magic: b"perilife calibration checkpoint\n", form: 1 };

/// Runs of a calibration that have ended.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct FinishedRuns {
    /// Hash of what the calibration says; `None` before the first run.
    calibration: Option<[u8; 32]>,
    runs: Vec<FinishedRun>,
}

/// A run of the engine with A = 1.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct FinishedRun {
    pub p: f64,
    pub curve: UnitCurve,
    /// Crack length at its end, m.
    pub end: f64,
    /// Horizon, m.
    pub horizon: f64,
    /// Actual lattice spacing, m.
    pub spacing: f64,
    pub warnings: Vec<String>,
    /// What it did, for replays; empty where nothing is replayed any more.
    #[serde(with = "shared")]
    pub recording: Arc<Recording>,
}

impl FinishedRuns {
    /// How many they are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Whether they are those of this calibration, by all that decides how its search goes.
    #[must_use]
    pub fn belong_to(&self, calibration: &CalibrationCase) -> bool {
        self.calibration.is_none_or(|known| known == hash(calibration))
    }

    /// These runs, if they are those of this calibration.
    ///
    /// # Errors
    /// [`crate::Error::Input`].
    pub fn checked(mut self, calibration: &CalibrationCase) -> Result<Self> {
        let own = hash(calibration);
        if *self.calibration.get_or_insert(own) != own {
            return Err(refused("belongs to another calibration, or to this one before it was changed"));
        }
        Ok(self)
    }

    /// As bytes, with a checksum.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        SEAL.to_bytes(self)
    }

    /// From what [`FinishedRuns::to_bytes`] gave.
    ///
    /// # Errors
    /// As [`Seal::read`].
    pub fn from_bytes(bytes: &[u8]) -> Result<FinishedRuns> {
        SEAL.read(bytes)
    }

    /// The run at exactly this exponent.
    pub(super) fn at(&self, p: f64) -> Option<&FinishedRun> {
        self.runs.iter().find(|run| run.p.to_bits() == p.to_bits())
    }

    /// Adds a run of a search that has asked for these exponents so far. Once two of them tell how cycles depend on p nothing is
    /// replayed any more (see [`super::surrogate`]), so what the run did is forgotten.
    pub(super) fn add(&mut self, mut run: FinishedRun, asked: &[f64]) {
        if apart(asked) > 1 {
            run.recording = Arc::default();
        }
        self.runs.push(run);
    }
}

/// Hash of all that decides how a search goes.
fn hash(calibration: &CalibrationCase) -> [u8; 32] {
    let CalibrationCase { case, curves, criterion, exponent, .. } = calibration;
    // Debug output of floats says them to the last bit.
    let search = format!("{:?}", (curves, criterion, exponent.fixed));
    Sha256::new().chain_update(checkpoint::hash(case)).chain_update(search).finalize().into()
}

/// What several hold, written as if one did.
mod shared {
    use std::sync::Arc;

    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<T: Serialize, S: Serializer>(value: &Arc<T>, serializer: S) -> Result<S::Ok, S::Error> {
        value.as_ref().serialize(serializer)
    }

    pub fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Arc<T>, D::Error> {
        T::deserialize(deserializer).map(Arc::new)
    }
}
