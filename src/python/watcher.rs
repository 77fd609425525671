//! A run under the eyes of Python: its progress told, Ctrl-C heard, the interpreter free meanwhile.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use perilife_base::units::MM;
use perilife_base::watch::{self, Watch};
use perilife_growth::predict::{Observer, Progress};
use perilife_runner::Watcher;
use perilife_runner::scenes::{SceneObserver, SceneProgress};
use pyo3::prelude::*;

use crate::errors::raised;

/// Time between two looks at what a run does.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// What a run tells.
#[derive(Default)]
pub struct Told {
    watch: Arc<Watch>,
    /// Share, cycles and crack length in mm of the newest row that was not handed on yet.
    newest: Mutex<Option<Look>>,
    warnings: Mutex<Vec<String>>,
}

/// Share, cycles and crack length, mm; a scene has a share alone.
type Look = (f64, Option<f64>, Option<f64>);

impl Told {
    /// What the user should know, so far.
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn look(&self, look: Look) -> bool {
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = Some(look);
        !self.watch.is_cancelled()
    }

    /// Hands the newest progress on; a callback that answers `False` ends the run.
    fn hand_on(&self, py: Python<'_>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
        let Some(progress) = progress else { return Ok(()) };
        let newest = self.newest.lock().unwrap_or_else(PoisonError::into_inner).take();
        let before_rows = || self.watch.now().map(|(stage, share)| (Some(stage.words()), (share, None, None)));
        let Some((stage, (share, cycles, crack_length_mm))) = newest.map(|look| (None, look)).or_else(before_rows) else {
            return Ok(());
        };
        let answer = progress.bind(py).call1((share, cycles, crack_length_mm, stage))?;
        if answer.extract::<bool>().is_ok_and(|goes_on| !goes_on) {
            self.watch.cancel();
        }
        Ok(())
    }
}

impl Observer for Told {
    fn block_done(&self, progress: &Progress) -> bool {
        self.look((progress.share.clamp(0.0, 1.0), Some(progress.cycles), Some(progress.crack_length / MM)))
    }

    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.watch.clone())
    }
}

impl SceneObserver for Told {
    fn step_done(&self, progress: &SceneProgress) -> bool {
        self.look((progress.share.clamp(0.0, 1.0), None, None))
    }

    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.watch.clone())
    }
}

impl Watcher for Told {
    fn warn(&self, warning: &str) {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).push(warning.to_owned());
    }
}

/// Does work on a thread of its own while this one hands its progress on and looks for signals, without holding the interpreter.
/// Errors: those of the work as exceptions of the package; what a signal or the callback raises, once the work has ended for it.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Told) -> perilife_base::error::Result<T> + Send,
) -> PyResult<T> {
    let told = Told::default();
    let look = || {
        Python::attach(|py| {
            py.check_signals()?;
            told.hand_on(py, progress.as_ref())
        })
    };
    let follow = || {
        thread::scope(|scope| {
            let (alive, is_over) = mpsc::channel::<()>();
            let told = &told;
            let worker = scope.spawn(move || {
                // Goes when the work ends, however it does.
                let _alive = alive;
                watch::with(Some(told.watch.clone()), || work(told))
            });
            let mut interrupted = None;
            while is_over.recv_timeout(LOOK_EVERY) == Err(RecvTimeoutError::Timeout) {
                if interrupted.is_none() {
                    interrupted = look().err();
                }
                if interrupted.is_some() {
                    told.watch.cancel();
                }
            }
            let done = worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            match interrupted {
                Some(error) => Err(error),
                None => done.map_err(raised).and_then(|done| look().map(|()| done)),
            }
        })
    };
    py.detach(follow)
}
