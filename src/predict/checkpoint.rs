//! What it takes to go on with a run that was broken off.
//!
//! Now and then a run builds its solver anew from the bonds, at the same places however it is interrupted: where it has to work on
//! the whole plate anyway ([`crate::solver::Equilibrium::is_due`]), or every so many blocks. There everything numeric that follows
//! depends only on what stands here, so that a run taken up there gives the same curve as one that nobody interrupted, bit for bit,
//! on the same kind of processor.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::course::Course;
use super::curve::Past;
use super::snapshot::Album;
use super::{CurvePoint, Progress, Snapshot};
use crate::body::{Body, Bond};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::fatigue::FatigueLaw;
use crate::fatigue::block_control::BlockControl;
use crate::fatigue::crack_tip::CrackTip;
use crate::growth::tip_field::{TipField, TipFieldState};
use crate::sealed::{Seal, refused};
use crate::state::Bonds;

const SEAL: Seal = Seal { magic: b"perilife checkpoint\n", form: 2 };

/// State of a run at one of the places where its solver is built anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Hash of what the case says.
    case: [u8; 32],
    cycles: f64,
    crack_length: f64,
    share: f64,
    /// Bonds that are cut, by the initial cracks or since.
    broken: Vec<Bond>,
    album: Pictures,
    solves: usize,
    iterations: usize,
    /// Time spent on the run so far, s.
    wall_s: f64,
    driver: OfDriver,
}

/// What only one driver has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum OfDriver {
    /// `bond_strain`.
    Bonds {
        /// A, p and horizon of the fatigue law that it was run with.
        law: [f64; 3],
        /// Lives that are not whole any more.
        life: Vec<(Bond, f64)>,
        tips: Vec<CrackTip>,
        near_limit: Vec<Bond>,
        control: BlockControl,
        past: Past,
        broken_bonds: usize,
    },
    /// `tip_field`.
    Tips { state: TipFieldState, displacement: Vec<f64>, curve: Vec<CurvePoint> },
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
    pub(super) fn of(case: [u8; 32], law: &FatigueLaw, body: &Body, run: &Course, progress: &Progress, wall_s: f64) -> Self {
        let driver = OfDriver::Bonds {
            law: constants(law),
            life: run.life.begun(),
            tips: run.tips.clone(),
            near_limit: run.near_limit.clone(),
            control: run.control.clone(),
            past: run.track.past().clone(),
            broken_bonds: run.broken_bonds,
        };
        let (broken, work) = (broken(body, &run.bonds), (run.solves, run.iterations));
        Self::at(case, progress, broken, &run.album, work, wall_s, driver)
    }

    /// The same of a run whose cracks are driven by the K of their tips.
    pub(super) fn of_tips(
        case: [u8; 32],
        growth: &TipField<'_>,
        (curve, album): (&[CurvePoint], &Album),
        progress: &Progress,
        wall_s: f64,
    ) -> Self {
        let driver =
            OfDriver::Tips { state: growth.state.clone(), displacement: growth.displacement.clone(), curve: curve.to_vec() };
        let (broken, work) = (broken(growth.body(), &growth.bonds), (growth.solves, growth.iterations));
        Self::at(case, progress, broken, album, work, wall_s, driver)
    }

    fn at(
        case: [u8; 32],
        progress: &Progress,
        broken: Vec<Bond>,
        album: &Album,
        (solves, iterations): (usize, usize),
        wall_s: f64,
        driver: OfDriver,
    ) -> Self {
        let Progress { cycles, crack_length, share } = *progress;
        Checkpoint { case, cycles, crack_length, share, broken, album: Pictures::of(album), solves, iterations, wall_s, driver }
    }

    /// Puts a run at its start where this one stood; returns the time spent on it so far, s.
    ///
    /// # Errors
    /// It is that of another law or plate.
    pub(super) fn restore(self, law: &FatigueLaw, body: &Body, run: &mut Course) -> Result<f64> {
        let places = body.multiplier.len();
        let fits = self.fits(places);
        let OfDriver::Bonds { law: recorded, life, tips, near_limit, control, past, broken_bonds } = self.driver else {
            return Err(of_another_plate());
        };
        if recorded != constants(law) {
            return Err(refused("is that of a run with another fatigue law"));
        }
        let known = near_limit.iter().chain(life.iter().map(|(bond, _)| bond)).all(|&bond| (bond as usize) < places);
        if !(fits && known && tips.len() == run.tips.len() && past.fits(run.tips.len())) {
            return Err(of_another_plate());
        }
        self.broken.iter().for_each(|&bond| run.bonds.cut(body, bond));
        life.iter().for_each(|&(bond, life)| run.life.set(bond, life));
        (run.tips, run.near_limit, run.control) = (tips, near_limit, control);
        run.track.go_on_from(past);
        run.album = self.album.into_album();
        (run.broken_bonds, run.solves, run.iterations) = (broken_bonds, self.solves, self.iterations);
        Ok(self.wall_s)
    }

    /// The same for a run whose cracks are driven by the K of their tips, before its first equilibrium; returns its curve and
    /// pictures, and the time spent on it so far, s.
    ///
    /// # Errors
    /// It is that of another plate.
    pub(super) fn restore_tips(self, growth: &mut TipField<'_>) -> Result<(Vec<CurvePoint>, Album, f64)> {
        let fits = self.fits(growth.body().multiplier.len());
        let OfDriver::Tips { state, displacement, curve } = self.driver else { return Err(of_another_plate()) };
        let same_plate = fits && state.fits(&growth.state) && !curve.is_empty();
        if !same_plate || !growth.go_on_from(state, &self.broken, displacement, (self.solves, self.iterations)) {
            return Err(of_another_plate());
        }
        Ok((curve, self.album.into_album(), self.wall_s))
    }

    /// Whether its bonds and pictures may be those of a plate with so many places for bonds.
    fn fits(&self, places: usize) -> bool {
        let picture_fits =
            |picture: &Picture| picture.damage.iter().all(|(point, _)| (*point as usize) < picture.displacement.len());
        self.broken.iter().all(|&bond| (bond as usize) < places) && self.album.all.iter().all(picture_fits)
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

fn of_another_plate() -> Error {
    refused("is that of another plate")
}

/// Bonds of the body that are cut.
fn broken(body: &Body, bonds: &Bonds) -> Vec<Bond> {
    let is_broken = |bond: Bond| body.multiplier[bond as usize] > 0.0 && !bonds.is_intact(bond);
    (0..body.multiplier.len()).map(|bond| bond as Bond).filter(|&bond| is_broken(bond)).collect()
}

fn constants(law: &FatigueLaw) -> [f64; 3] {
    [law.a, law.p, law.horizon]
}

/// Hash of all that decides how the run of a case goes.
pub(crate) fn hash(case: &Case) -> [u8; 32] {
    let Case { specimen, material, loading, model, fatigue, law, stop, .. } = case;
    // Debug output of floats says them to the last bit.
    let all = format!("{:?}", (specimen, material, loading, model, fatigue, law, stop));
    Sha256::digest(all).into()
}
