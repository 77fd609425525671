//! How far a long piece of work is before it has anything to show, and whether it may go on: building a plate and its solver, and
//! every equilibrium.
//!
//! Whoever watches a run makes a [`Watch`] and looks at it from a thread of his own; the work marks its places in it ([`at`]), which costs
//! a look at a thread's own variable and one store. A run that nobody watches pays the look alone.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering};

use crate::error::{Error, Result};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Stage {
    Points = 1,
    Bonds,
    Rim,
    Loads,
    Solver,
    Equilibrium,
}

impl Stage {
    pub const ALL: [Stage; 6] = [Stage::Points, Stage::Bonds, Stage::Rim, Stage::Loads, Stage::Solver, Stage::Equilibrium];

    pub fn words(self) -> &'static str {
        match self {
            Stage::Points => "creating points",
            Stage::Bonds => "creating bonds",
            Stage::Rim => "correcting boundary bonds",
            Stage::Loads => "applying loads",
            Stage::Solver => "building the solver",
            Stage::Equilibrium => "solving for equilibrium",
        }
    }
}

/// Shares are kept in parts of so many.
const PARTS: f64 = 1e6;

#[derive(Debug, Default)]
pub struct Watch {
    stage: AtomicU8,
    share: AtomicU32,
    is_cancelled: AtomicBool,
}

impl Watch {
    /// What is being done now, and how much of it is done, 0 to 1; `None` before anything is.
    pub fn now(&self) -> Option<(Stage, f64)> {
        let number = self.stage.load(Ordering::Relaxed);
        let stage = Stage::ALL.into_iter().find(|stage| *stage as u8 == number)?;
        Some((stage, f64::from(self.share.load(Ordering::Relaxed)) / PARTS))
    }

    /// Asks the work to end at its next place.
    pub fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }

    pub fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    fn set(&self, stage: Stage, share: f64) {
        self.stage.store(stage as u8, Ordering::Relaxed);
        self.share.store((PARTS * share.clamp(0.0, 1.0)) as u32, Ordering::Relaxed);
    }
}

thread_local! {
    /// Who watches the work of this thread.
    static WATCHED_BY: RefCell<Option<Arc<Watch>>> = const { RefCell::new(None) };
}

/// Puts back who watched before, also after a panic.
struct Before(Option<Arc<Watch>>);

impl Drop for Before {
    fn drop(&mut self) {
        WATCHED_BY.replace(self.0.take());
    }
}

/// Does work under the eyes of `watch`; whoever watched before does so again after it.
pub fn with<R>(watch: Option<Arc<Watch>>, work: impl FnOnce() -> R) -> R {
    let _before = Before(WATCHED_BY.replace(watch));
    work()
}

/// Marks a place.
/// Errors: [`Error::Mechanics`] if the work is to end.
pub fn at(stage: Stage, share: f64) -> Result<()> {
    WATCHED_BY.with_borrow(|watch| match watch {
        None => Ok(()),
        Some(watch) if watch.is_cancelled() => Err(Error::Mechanics(CANCELLED.to_owned())),
        Some(watch) => {
            watch.set(stage, share);
            Ok(())
        }
    })
}

const CANCELLED: &str = "the run was canceled";

/// Who watches the work of this thread, for threads that do a part of it.
pub fn watching() -> Option<Arc<Watch>> {
    WATCHED_BY.with_borrow(Clone::clone)
}

/// Whether the work of this thread was asked to end.
pub fn is_cancelled() -> bool {
    watching().is_some_and(|watch| watch.is_cancelled())
}

/// What came of work that may have been asked to end: then that is said, whatever it ended with.
pub fn unless_cancelled<T>(name: &str, done: Result<T>) -> Result<T> {
    if is_cancelled() { Err(Error::Mechanics(format!("{name}: {CANCELLED}"))) } else { done }
}

/// An observer that watches nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;
