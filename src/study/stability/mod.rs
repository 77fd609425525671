//! Where methods fail: each method is taken across the range of one parameter until its error passes a bound or it gives no result.
//!
//! A [`Sweep`] has a truth that does not come from the method (a handbook's quadrature, a closed form, uniform strain, or a method that
//! shares neither points nor bonds with it). Sweeps are questions with the parameter as a value (`data/studies/stability.toml`). Their cases run at rising values; the ends of the safe range, the run of stable values around
//! the usual one, are found by bisection. Every run has a [`Budget`] of cycle blocks and seconds, and a panic is a failure with a
//! name, so that nothing hangs and nothing is left out.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use serde::Deserialize;
use toml::Table;

use super::questions::{Asker, SHARED, each, file, read};
use super::subject::Watcher;
use super::tasks::{Outcome, chosen, side_by_side};
use perilife_base::error::Result;
use perilife_base::watch::{self, Watch};
use perilife_growth::predict::{Observer, Progress};
use perilife_scenes::{SceneObserver, SceneProgress};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Method {
    pub name: String,
    #[serde(default)]
    set: Table,
    /// What it asks otherwise than the others.
    #[serde(default)]
    ask: Table,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Name, as `perilife stability NAME` takes it.
    pub name: String,
    /// What is varied and what the error is measured against.
    pub about: String,
    /// The parameter, as the axis of the picture names it.
    pub parameter: String,
    #[serde(default)]
    pub unit: String,
    pub values: Vec<f64>,
    /// Value that is usual, from which the safe range is sought in both directions; one of the values.
    #[serde(default)]
    pub usual: f64,
    #[serde(default)]
    pub only_values: bool,
    /// Error up to which a result counts as right, percent.
    pub bound_percent: f64,
    /// What is asked, with the parameter as the value `it`; its largest error counts.
    ask: Table,
    pub methods: Vec<Method>,
    #[serde(skip)]
    shared: Table,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Swept {
    sweep: Vec<Sweep>,
}

/// All sweeps, in the order in which a life is computed, from their file; `tests/unit/studies.rs` reads it with its errors.
pub fn read_sweeps() -> Result<Vec<Sweep>> {
    let Swept { mut sweep } = read(file("stability.toml", include_str!("../../../data/studies/stability.toml"))?)?;
    let shared = file("shared.toml", SHARED)?;
    sweep.iter_mut().for_each(|sweep| sweep.shared = shared.clone());
    Ok(sweep)
}

pub static SWEEPS: LazyLock<Vec<Sweep>> = LazyLock::new(|| read_sweeps().unwrap_or_default());

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Error within the bound of the sweep.
    Stable,
    /// A result beyond it.
    Degraded,
    Failed,
}

impl Status {
    pub fn name(self) -> &'static str {
        match self {
            Status::Stable => "stable",
            Status::Degraded => "degraded",
            Status::Failed => "failed",
        }
    }
}

impl Sweep {
    pub fn status(&self, outcome: &Outcome<f64>) -> Status {
        match outcome.done() {
            Some(error) if error.abs() <= self.bound_percent => Status::Stable,
            Some(_) => Status::Degraded,
            None => Status::Failed,
        }
    }

    /// The error of a method at a value, percent: the largest of all questions. No number stays none.
    fn error(&self, method: &Method, value: f64, observer: &dyn Watcher) -> Result<f64> {
        let own = [("it".to_owned(), value.into())];
        let values = self.shared.clone().into_iter().chain(method.set.clone()).chain(own).collect();
        let (asker, mut worst) = (Asker::new(observer), 0.0_f64);
        each(&self.ask.clone().into_iter().chain(method.ask.clone()).collect(), &values, &mut |question, values| {
            let error = asker.ask(question, values).number(&question.read)?;
            worst = if error.abs() <= worst.abs() { worst } else { error };
            Ok(())
        })?;
        Ok(worst)
    }

    pub fn range(&self) -> [f64; 2] {
        [self.values[0], self.values[self.values.len() - 1]]
    }
}

#[derive(Clone)]
pub struct StabilityRecord {
    pub sweep: &'static Sweep,
    pub method: &'static str,
    /// Values, rising, those of the bisection among them, with what came of them.
    pub points: Vec<(f64, Outcome<f64>)>,
    /// Ends of the safe range: the last stable values, `None` where the range has no end within the sweep or the budget.
    pub ends: [Option<f64>; 2],
    /// Whether the usual value is stable; without it there is no safe range. `None` where the budget was spent on it.
    pub is_safe: Option<bool>,
    pub wall_s: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Every so many-th value is run.
    pub stride: usize,
    /// Relative width to which an end of the safe range is narrowed.
    pub resolution: f64,
    pub budget: Budget,
    /// Whether methods that take most of the time are among them.
    pub with_slow: bool,
}

/// Sweeps and their methods that take more than half of the time of all: a quick look at all sweeps goes without them.
pub const SLOW: [(&str, &str); 2] =
    [("horizon_ratio", "bond_strain by its own strain"), ("ageing", "bond_strain, ageing everywhere")];

impl Effort {
    pub const FULL: Effort =
        Effort { stride: 1, resolution: 0.02, budget: Budget { seconds: 60.0, blocks: 4000 }, with_slow: true };
    pub const QUICK: Effort =
        Effort { stride: 3, resolution: 0.2, budget: Budget { seconds: 20.0, blocks: 1000 }, with_slow: false };
}

pub fn sweeps(names: &[String]) -> Result<Vec<&'static Sweep>> {
    if SWEEPS.is_empty() {
        read_sweeps()?;
    }
    chosen(&SWEEPS, |sweep| &sweep.name, names, "NAME", "is not a stability sweep")
}

/// Records of some sweeps in their order. `done` hears of every one as it ends.
pub fn run(sweeps: &[&'static Sweep], effort: Effort, done: &(dyn Fn(&StabilityRecord) + Sync)) -> Vec<StabilityRecord> {
    let all = sweeps.iter().flat_map(|sweep| sweep.methods.iter().map(|method| (*sweep, method)));
    let tasks: Vec<_> =
        all.filter(|(sweep, method)| effort.with_slow || !SLOW.contains(&(sweep.name.as_str(), method.name.as_str()))).collect();
    side_by_side(&tasks, |(sweep, method)| {
        let record = walk(sweep, method, effort);
        done(&record);
        record
    })
}

/// Bisections of an end at the most: enough for 2 % of a range of one decade.
const BISECTIONS_MAX: usize = 8;

/// Runs a method at every value and narrows the ends of its safe range.
fn walk(sweep: &'static Sweep, method: &'static Method, effort: Effort) -> StabilityRecord {
    let begun = Instant::now();
    let measure = |value: f64| (value, within(effort.budget, |run| sweep.error(method, value, run)));
    let mut points: Vec<(f64, Outcome<f64>)> = values(sweep, effort.stride).into_iter().map(measure).collect();
    let is_stable = |point: &(f64, Outcome<f64>)| sweep.status(&point.1) == Status::Stable;
    let is_judged = |point: &(f64, Outcome<f64>)| !matches!(point.1, Outcome::Stopped(_));
    let at_usual = points.iter().position(|point| point.0 == sweep.usual);
    let is_safe = at_usual.map(|at| &points[at]).filter(|point| is_judged(point)).map(is_stable);
    let mut ends = [None, None];
    if let Some(usual) = at_usual.filter(|_| is_safe == Some(true)) {
        let below = points[..usual].iter().rposition(|point| !is_stable(point)).map(|at| [at + 1, at]);
        let above = points[usual..].iter().position(|point| !is_stable(point)).map(|more| [usual + more - 1, usual + more]);
        // The last stable value and the first beyond it.
        let pairs =
            [below, above].map(|pair| pair.filter(|pair| is_judged(&points[pair[1]])).map(|pair| pair.map(|at| points[at].0)));
        for (end, pair) in ends.iter_mut().zip(pairs) {
            let Some([mut inside, mut beyond]) = pair else { continue };
            for _ in 0..BISECTIONS_MAX {
                if sweep.only_values || (beyond - inside).abs() <= effort.resolution * beyond.abs().max(inside.abs()) {
                    break;
                }
                let point =
                    measure(if inside > 0.0 && beyond > 0.0 { (inside * beyond).sqrt() } else { 0.5 * (inside + beyond) });
                if is_stable(&point) {
                    inside = point.0;
                } else {
                    beyond = point.0;
                }
                let goes_on = is_judged(&point);
                points.push(point);
                if !goes_on {
                    break;
                }
            }
            *end = Some(inside);
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    StabilityRecord { sweep, method: &method.name, points, ends, is_safe, wall_s: begun.elapsed().as_secs_f64() }
}

/// Every so many-th value, the first, the last and the usual one among them.
fn values(sweep: &Sweep, stride: usize) -> Vec<f64> {
    let last = sweep.values.len() - 1;
    let is_chosen = |(at, value): &(usize, &f64)| at % stride == 0 || *at == last || **value == sweep.usual;
    sweep.values.iter().enumerate().filter(is_chosen).map(|(_, value)| *value).collect()
}

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
