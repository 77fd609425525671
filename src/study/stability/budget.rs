//! What a run of a sweep may take, and what becomes of one that takes more, fails or panics.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use crate::tasks::Outcome;
use perilife_base::error::Result;
use perilife_base::watch::{self, Watch};
use perilife_growth::predict::{Observer, Progress};
use perilife_scenes::{SceneObserver, SceneProgress};

/// What a run may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    pub seconds: f64,
    /// Cycle blocks or recorded steps.
    pub blocks: usize,
}

/// A run under its budget: the observer of all that is predicted in it.
pub struct BudgetedRun {
    budget: Budget,
    watch: Arc<Watch>,
    blocks: AtomicUsize,
}

impl BudgetedRun {
    /// Whether one more block may be done.
    fn may_go_on(&self) -> bool {
        let done = self.blocks.fetch_add(1, Ordering::Relaxed) + 1;
        if done >= self.budget.blocks {
            // What has begun is asked to end at once.
            self.watch.cancel();
        }
        !self.watch.is_cancelled()
    }
}

impl Observer for BudgetedRun {
    fn block_done(&self, _progress: &Progress) -> bool {
        self.may_go_on()
    }

    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.watch.clone())
    }
}

impl SceneObserver for BudgetedRun {
    fn step_done(&self, _progress: &SceneProgress) -> bool {
        self.may_go_on()
    }

    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.watch.clone())
    }
}

/// What comes of some work within a budget: an error in percent, or why there is none.
pub fn within(budget: Budget, work: impl FnOnce(&BudgetedRun) -> Result<f64>) -> Outcome<f64> {
    let run = BudgetedRun { budget, watch: Arc::default(), blocks: AtomicUsize::new(0) };
    let ran_out = AtomicBool::new(false);
    let (over, is_over) = mpsc::channel::<()>();
    let done = thread::scope(|scope| {
        let (watch, ran_out) = (run.watch.clone(), &ran_out);
        scope.spawn(move || {
            if is_over.recv_timeout(Duration::from_secs_f64(budget.seconds)) == Err(mpsc::RecvTimeoutError::Timeout) {
                ran_out.store(true, Ordering::Relaxed);
                watch.cancel();
            }
        });
        let watch = run.watch.clone();
        let done = catch_unwind(AssertUnwindSafe(|| watch::with(Some(watch), || work(&run))));
        drop(over);
        done
    });
    match done {
        Err(panic) => {
            let owned = panic.downcast_ref::<String>().map(String::as_str);
            let words = owned.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a message");
            Outcome::Failed(format!("panic: {words}"))
        }
        Ok(_) if ran_out.load(Ordering::Relaxed) => Outcome::Stopped(format!("not done within {} s", budget.seconds)),
        Ok(_) if run.watch.is_cancelled() => Outcome::Stopped(format!("not done within {} blocks", budget.blocks)),
        Ok(Ok(error)) if !error.is_finite() => Outcome::Failed(format!("the result is {error}")),
        Ok(result) => Outcome::of(result),
    }
}
