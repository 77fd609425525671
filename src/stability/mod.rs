//! Where methods fail: each method is taken across the range of one parameter until its error passes a bound or it gives no result.
//!
//! A [`Sweep`] has a truth that does not come from the method (a handbook's quadrature, a closed form, uniform strain, or a method that
//! shares neither points nor bonds with it). Its cases run at rising values; the ends of the safe range, the run of stable values around
//! the usual one, are found by bisection. Every run has a [`Budget`] of cycle blocks and seconds, and a panic is a failure with a
//! name, so that nothing hangs and nothing is left out.

mod budget;
mod exact;
pub mod sweeps;
mod walk;

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

pub use budget::{Budget, Run, within};
pub use sweeps::SWEEPS;

use crate::error::{Result, input};

/// A parameter that is taken across its range.
pub struct Sweep {
    /// Name, as `perilife stability NAME` takes it.
    pub name: &'static str,
    /// What is varied and what the error is measured against.
    pub about: &'static str,
    /// The parameter, as the axis of the picture names it.
    pub parameter: &'static str,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
    /// Values, rising.
    pub values: &'static [f64],
    /// Value that is usual, from which the safe range is sought in both directions; one of the values.
    pub usual: f64,
    /// Values between which there are others.
    pub is_continuous: bool,
    /// Error up to which a result counts as right, percent.
    pub bound_percent: f64,
    /// Methods, each with a line of its own.
    pub methods: &'static [Method],
}

/// A method in a sweep.
pub struct Method {
    /// As the table names it.
    pub name: &'static str,
    /// Error at a value of the parameter, percent.
    pub measure: fn(f64, &Run) -> Result<f64>,
}

/// What came of a method at one value.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Error, percent.
    Error(f64),
    /// No result, and why.
    Failed(String),
    /// The budget was spent before there was one, which says nothing about the method.
    Unfinished(String),
}

/// How that is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Error within the bound of the sweep.
    Stable,
    /// A result beyond it.
    Degraded,
    /// No result.
    Failed,
}

impl Status {
    /// As the table names it.
    pub fn name(self) -> &'static str {
        match self {
            Status::Stable => "stable",
            Status::Degraded => "degraded",
            Status::Failed => "failed",
        }
    }
}

impl Outcome {
    /// Judgement by a bound, percent.
    pub fn status(&self, bound_percent: f64) -> Status {
        match self {
            Outcome::Error(error) if error.abs() <= bound_percent => Status::Stable,
            Outcome::Error(_) => Status::Degraded,
            Outcome::Failed(_) | Outcome::Unfinished(_) => Status::Failed,
        }
    }

    /// Error, percent, where there is a result.
    pub fn error(&self) -> Option<f64> {
        match self {
            Outcome::Error(error) => Some(*error),
            Outcome::Failed(_) | Outcome::Unfinished(_) => None,
        }
    }

    /// Why there is no result.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Outcome::Error(_) => None,
            Outcome::Failed(reason) | Outcome::Unfinished(reason) => Some(reason),
        }
    }
}

/// A method across a parameter.
#[derive(Clone)]
pub struct Record {
    /// Which sweep.
    pub sweep: &'static Sweep,
    /// Which method.
    pub method: &'static str,
    /// Values, rising, those of the bisection among them, with what came of them.
    pub points: Vec<(f64, Outcome)>,
    /// Ends of the safe range: the last stable values, `None` where the range has no end within the sweep or the budget.
    pub ends: [Option<f64>; 2],
    /// Whether the usual value is stable; without it there is no safe range. `None` where the budget was spent on it.
    pub is_safe: Option<bool>,
    /// Seconds it took.
    pub wall_s: f64,
}

impl Record {
    /// End of the safe range on the side of a value.
    pub fn end_beside(&self, value: f64) -> Option<f64> {
        let [low, high] = self.ends;
        if value < self.sweep.usual { low } else { high }
    }
}

/// How thorough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Every so many-th value is run.
    pub stride: usize,
    /// Relative width to which an end of the safe range is narrowed.
    pub resolution: f64,
    /// Of every run.
    pub budget: Budget,
    /// Whether methods that take most of the time are among them.
    pub with_slow: bool,
}

/// Sweeps and their methods that take more than half of the time of all: a quick look at all sweeps goes without them.
pub const SLOW: [(&str, &str); 4] = [
    ("level_jump", "dual_horizon balanced"),
    ("horizon_ratio", "bond_strain at the rate of K"),
    ("horizon_ratio", "bond_strain by its own strain"),
    ("ageing", "bond_strain, ageing everywhere"),
];

impl Effort {
    /// All values, ends to 2 %.
    pub const FULL: Effort =
        Effort { stride: 1, resolution: 0.02, budget: Budget { seconds: 60.0, blocks: 4000 }, with_slow: true };
    /// Every third value, ends to 20 %.
    pub const QUICK: Effort =
        Effort { stride: 3, resolution: 0.2, budget: Budget { seconds: 20.0, blocks: 1000 }, with_slow: false };
}

/// The sweeps of these names, all where no name is given.
///
/// # Errors
/// A name that no sweep bears.
pub fn sweeps(names: &[String]) -> Result<Vec<&'static Sweep>> {
    if names.is_empty() {
        return Ok(SWEEPS.to_vec());
    }
    let known = || SWEEPS.iter().map(|sweep| sweep.name).collect::<Vec<_>>().join(", ");
    let find = |name: &String| {
        SWEEPS
            .iter()
            .copied()
            .find(|sweep| sweep.name == name)
            .ok_or_else(|| input("NAME", name, "is not a stability sweep", format!("known are {}", known())))
    };
    names.iter().map(find).collect()
}

/// Records of some sweeps in their order, run side by side on the processors there are. `done` hears of every one as it ends.
pub fn run(sweeps: &[&'static Sweep], effort: Effort, done: &(dyn Fn(&Record) + Sync)) -> Vec<Record> {
    let is_slow = |sweep: &Sweep, method: &Method| SLOW.contains(&(sweep.name, method.name));
    let tasks: Vec<(&'static Sweep, &'static Method)> = sweeps
        .iter()
        .flat_map(|sweep| sweep.methods.iter().map(|method| (*sweep, method)))
        .filter(|(sweep, method)| effort.with_slow || !is_slow(sweep, method))
        .collect();
    let next = AtomicUsize::new(0);
    let records = Mutex::new(Vec::new());
    let work = || {
        while let Some((at, (sweep, method))) =
            Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|at| Some((at, *tasks.get(at)?)))
        {
            let record = walk::walk(sweep, method, effort);
            done(&record);
            records.lock().unwrap_or_else(PoisonError::into_inner).push((at, record));
        }
    };
    let workers = thread::available_parallelism().map_or(1, NonZero::get).min(tasks.len());
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(work);
        }
    });
    let mut records = records.into_inner().unwrap_or_else(PoisonError::into_inner);
    records.sort_by_key(|(at, _)| *at);
    records.into_iter().map(|(_, record)| record).collect()
}
