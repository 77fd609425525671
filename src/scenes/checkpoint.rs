//! The course of a run: what is taken down of it, who hears how far it is, and what it takes to go on with a run that was broken off.
//!
//! A scene can be taken up where a step of it is done and taken down. Explicit motion, relaxation and marching carry all they
//! depend on from step to step; it stands here whole. Along a path of equilibrium the solver remembers more than that (its factor is
//! that of an earlier state): it is built anew after every so many states, checkpoint or not, and the path can be taken up there.
//! So a scene taken up gives the same histories as one that nobody interrupted, bit for bit, on the same kind of processor.

use std::time::Instant;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::bonds::{BondState, KeptBonds};
use super::log::{Log, Records};
use super::scene::Scene;
use super::{SceneObserver, SceneProgress};
use perilife_base::error::{Error, Result};
use perilife_base::sealed::{Checkpoint, Kept, Seal, hash_of, refused};

/// First bytes of a checkpoint.
pub const SIGN: &[u8] = b"perilife scene checkpoint\n";

/// State of a scene after one of its steps.
pub type SceneCheckpoint = Checkpoint<KeptScene>;

/// All that a scene goes on from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeptScene {
    /// Largest share of the run so far, 0 to 1.
    pub share: f64,
    records: Records,
    bonds: KeptBonds,
    /// Where its procedure stands, with what its interaction or its solver keeps, as bytes: the scene says which procedure it is.
    place: Vec<u8>,
}

impl KeptScene {
    /// The step after which it was taken down, as `history.csv` counts them.
    pub fn step(&self) -> usize {
        self.records.last_step()
    }
}

impl Kept for KeptScene {
    type Input = Scene;
    const SEAL: Seal = Seal { of: "a scene of this program", magic: SIGN, form: 3 };
    const OF_ANOTHER: &'static str = "is of another scene, or of this one before a change";

    fn hash(scene: &Scene) -> [u8; 32] {
        let Scene { specimen, material, model, drives, holds, damage, procedure, refinement, .. } = scene;
        hash_of(&(specimen, material, model, drives, holds, damage, procedure, refinement))
    }
}

/// A checkpoint whose sizes or procedure are not those of the run.
pub(super) fn of_another() -> Error {
    refused("is of another plate or procedure")
}

/// Time spent on a run.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    begun: Instant,
    /// Time spent before it was taken up, s.
    earlier_s: f64,
}

impl Clock {
    /// Starts to count for a run that begins, or goes on from a checkpoint.
    pub fn start(from: Option<&SceneCheckpoint>) -> Self {
        Clock { begun: Instant::now(), earlier_s: from.map_or(0.0, |from| from.wall_s) }
    }

    /// Time spent so far, s.
    pub fn seconds(self) -> f64 {
        self.earlier_s + self.begun.elapsed().as_secs_f64()
    }
}

pub struct Course<'a> {
    pub log: Log<'a>,
    observer: &'a dyn SceneObserver,
    clock: Clock,
    scene: [u8; 32],
    /// Largest share of the run so far.
    share: f64,
    /// Where the run goes on, until its procedure stands there.
    from: Option<KeptScene>,
}

impl<'a> Course<'a> {
    /// The course of a run of a scene, from a checkpoint of it if there is one.
    pub fn new(
        scene: &Scene,
        log: Log<'a>,
        observer: &'a dyn SceneObserver,
        clock: Clock,
        from: Option<SceneCheckpoint>,
    ) -> Self {
        Course { log, observer, clock, scene: KeptScene::hash(scene), share: 0.0, from: from.map(|from| from.kept) }
    }

    /// Puts log and bonds where the run stood, and tells where its procedure did; `None`, and nothing is touched, at the beginning of
    /// a run.
    /// Errors: a checkpoint of another plate.
    pub fn take_up<T: DeserializeOwned>(&mut self, bonds: &mut BondState) -> Result<Option<T>> {
        let Some(KeptScene { share, records, bonds: kept, place }) = self.from.take() else { return Ok(None) };
        self.share = share;
        let fits = self.log.restore(records) && bonds.restore(kept);
        postcard::from_bytes(&place).ok().filter(|_| fits).map(Some).ok_or_else(of_another)
    }

    /// Tells how far the run is.
    pub fn step_done(&mut self, share: f64) -> Result<()> {
        self.share = self.share.max(share);
        if let Some(row) = self.log.last() {
            self.observer.row(row);
        }
        if self.observer.step_done(&SceneProgress { share: self.share }) {
            return Ok(());
        }
        Err(Error::Mechanics("the run was canceled".to_owned()))
    }

    /// Offers what it takes to go on from here, the procedure standing at this place.
    pub fn may_keep<T: Serialize>(&self, bonds: &BondState, place: impl Fn() -> T) {
        self.observer.may_keep(&|| {
            let (share, records, bonds) = (self.share, self.log.records(), bonds.kept());
            // Numbers, lists and options of known length can always be written to memory.
            let place = postcard::to_stdvec(&place()).unwrap_or_default();
            Checkpoint::new(self.scene, self.clock.seconds(), KeptScene { share, records, bonds, place })
        });
    }
}
