//! A run on the screen: what it does before it has rows, then its cycles; and its time limit.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::ProgressBar;

use super::console::STEPS;
use crate::fracture::{SceneObserver, SceneProgress};
use crate::predict::{Observer, Progress};
use crate::units::MM;
use crate::watch::Watch;

/// Time between two looks at what a run does.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Shows a run's cycles, crack length, share and time left; the bar goes when the value is dropped.
#[derive(Debug)]
pub struct RunProgress {
    bar: ProgressBar,
    shared: Arc<Shared>,
    /// Looks at the run from beside it; none where nobody would see it and nothing limits it.
    looker: Option<JoinHandle<()>>,
}

/// What both threads know.
#[derive(Debug, Default)]
struct Shared {
    watch: Arc<Watch>,
    has_rows: AtomicBool,
    is_over: AtomicBool,
    ran_out: AtomicBool,
}

impl RunProgress {
    /// On this bar, with an end after so long.
    pub fn new(bar: ProgressBar, limit: Option<Duration>) -> Self {
        let shared = Arc::new(Shared::default());
        let is_looked_at = !bar.is_hidden() || limit.is_some();
        let (shown, known) = (bar.clone(), shared.clone());
        let looker = is_looked_at.then(|| std::thread::spawn(move || look(&shown, &known, limit)));
        RunProgress { bar, shared, looker }
    }

    /// The bar.
    pub fn bar(&self) -> &ProgressBar {
        &self.bar
    }

    /// Whether the time was over before the run was.
    pub fn ran_out(&self) -> bool {
        self.shared.ran_out.load(Ordering::Relaxed)
    }

    fn advance(&self, share: f64, message: Option<String>) -> bool {
        self.shared.has_rows.store(true, Ordering::Relaxed);
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        self.bar.set_message(message.unwrap_or_default());
        self.bar.set_position((share * STEPS as f64) as u64);
        !self.shared.watch.is_cancelled()
    }
}

/// Shows what a run does before it has rows, and asks it to end when its time is over.
fn look(bar: &ProgressBar, shared: &Shared, limit: Option<Duration>) {
    let begun = Instant::now();
    while !shared.is_over.load(Ordering::Relaxed) {
        if limit.is_some_and(|limit| begun.elapsed() >= limit) && !shared.ran_out.swap(true, Ordering::Relaxed) {
            shared.watch.cancel();
        }
        if !shared.has_rows.load(Ordering::Relaxed)
            && let Some((stage, share)) = shared.watch.now()
        {
            bar.set_message(format!("{} {:.0} %", stage.words(), 100.0 * share));
            bar.tick();
        }
        let left =
            limit.map_or(LOOK_EVERY, |limit| limit.saturating_sub(begun.elapsed()).clamp(Duration::from_millis(1), LOOK_EVERY));
        std::thread::park_timeout(left);
    }
}

impl Observer for RunProgress {
    fn block_done(&self, progress: &Progress) -> bool {
        self.advance(progress.share, Some(format!("N = {:.4e}, a = {:.2} mm", progress.cycles, progress.crack_length / MM)))
    }

    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.shared.watch.clone())
    }
}

impl SceneObserver for RunProgress {
    fn step_done(&self, progress: &SceneProgress) -> bool {
        self.advance(progress.share, None)
    }

    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.shared.watch.clone())
    }
}

impl Drop for RunProgress {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::Relaxed);
        if let Some(looker) = self.looker.take() {
            looker.thread().unpark();
            // It ends at once, and has nothing to say.
            let _ = looker.join();
        }
        self.bar.finish_and_clear();
    }
}
