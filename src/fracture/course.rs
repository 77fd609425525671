//! The course of a run: who hears how far it is, and where it was taken up.

use std::time::Instant;

use super::bonds::BondState;
use super::checkpoint::{Place, SceneCheckpoint, hash, of_another};
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
    pub fn new(scene: &Scene, observer: &'a dyn SceneObserver, clock: Clock, from: Option<SceneCheckpoint>) -> Self {
        Course { observer, clock, scene: hash(scene), share: 0.0, from }
    }

    /// Puts log and bonds where the run stood, and tells where its procedure did; `None`, and nothing is touched, at the beginning of
    /// a run.
    ///
    /// # Errors
    /// A checkpoint of another plate.
    pub fn take_up(&mut self, log: &mut Log<'_>, bonds: &mut BondState) -> Result<Option<Place>> {
        let Some(SceneCheckpoint { share, records, bonds: kept, place, .. }) = self.from.take() else { return Ok(None) };
        self.share = share;
        if log.restore(records) && bonds.restore(&kept) { Ok(Some(place)) } else { Err(of_another()) }
    }

    /// Tells how far the run is.
    pub fn step_done(&mut self, share: f64) -> Result<()> {
        self.share = self.share.max(share);
        if self.observer.step_done(&SceneProgress { share: self.share }) {
            return Ok(());
        }
        Err(Error::Mechanics("the run was cancelled".to_owned()))
    }

    /// Offers what it takes to go on from here.
    pub fn may_keep(&self, log: &Log<'_>, bonds: &BondState, place: &dyn Fn() -> Place) {
        self.observer.may_keep(&|| SceneCheckpoint {
            scene: self.scene,
            share: self.share,
            wall_s: self.clock.seconds(),
            records: log.records(),
            bonds: bonds.kept(),
            place: place(),
        });
    }
}
