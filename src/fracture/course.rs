//! The course of a run: what is taken down of it, who hears how far it is, and where it was taken up.

use std::time::Instant;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::bonds::BondState;
use super::checkpoint::{SceneCheckpoint, hash, of_another};
use super::log::Log;
use super::scene::Scene;
use super::{SceneObserver, SceneProgress};
use crate::error::{Error, Result};

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

/// Course of a run.
pub struct Course<'a> {
    /// What is taken down.
    pub log: Log<'a>,
    observer: &'a dyn SceneObserver,
    clock: Clock,
    scene: [u8; 32],
    /// Largest share of the run so far.
    share: f64,
    /// Where the run goes on, until its procedure stands there.
    from: Option<SceneCheckpoint>,
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
        Course { log, observer, clock, scene: hash(scene), share: 0.0, from }
    }

    /// Puts log and bonds where the run stood, and tells where its procedure did; `None`, and nothing is touched, at the beginning of
    /// a run.
    /// Errors: a checkpoint of another plate.
    pub fn take_up<T: DeserializeOwned>(&mut self, bonds: &mut BondState) -> Result<Option<T>> {
        let Some(SceneCheckpoint { share, records, bonds: kept, place, .. }) = self.from.take() else { return Ok(None) };
        self.share = share;
        let fits = self.log.restore(records) && bonds.restore(&kept);
        postcard::from_bytes(&place).ok().filter(|_| fits).map(Some).ok_or_else(of_another)
    }

    /// Tells how far the run is.
    pub fn step_done(&mut self, share: f64) -> Result<()> {
        self.share = self.share.max(share);
        if self.observer.step_done(&SceneProgress { share: self.share }) {
            return Ok(());
        }
        Err(Error::Mechanics("the run was cancelled".to_owned()))
    }

    /// Offers what it takes to go on from here, the procedure standing at this place.
    pub fn may_keep<T: Serialize>(&self, bonds: &BondState, place: impl Fn() -> T) {
        self.observer.may_keep(&|| SceneCheckpoint {
            scene: self.scene,
            share: self.share,
            wall_s: self.clock.seconds(),
            records: self.log.records(),
            bonds: bonds.kept(),
            // Numbers, lists and options of known length can always be written to memory.
            place: postcard::to_stdvec(&place()).unwrap_or_default(),
        });
    }
}
