//! What is run: tasks by name, side by side, and what comes of one.

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use serde::{Deserialize, Serialize};

use perilife_base::error::{Error, Result, input};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome<T> {
    Done(T),
    /// The program refuses the case, and why.
    Refused(String),
    /// It began and failed, and why.
    Failed(String),
    /// It was ended before it had a result, which says nothing about the method, and why.
    Stopped(String),
}

impl<T> Outcome<T> {
    /// Of a run that has ended by itself; reasons stand on one line.
    pub fn of(result: Result<T>) -> Outcome<T> {
        let reason = |error: &Error| error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        match result {
            Ok(result) => Outcome::Done(result),
            Err(error @ Error::Input(_)) => Outcome::Refused(reason(&error)),
            Err(error) => Outcome::Failed(reason(&error)),
        }
    }

    pub fn done(&self) -> Option<&T> {
        if let Outcome::Done(result) = self { Some(result) } else { None }
    }

    pub fn reason(&self) -> Option<&str> {
        match self {
            Outcome::Done(_) => None,
            Outcome::Refused(reason) | Outcome::Failed(reason) | Outcome::Stopped(reason) => Some(reason),
        }
    }
}

/// Those of these names among all, all where no name is given; `what` they are not, for a name that none has.
pub(super) fn chosen<T>(
    all: &'static [T],
    name: fn(&'static T) -> &'static str,
    names: &[String],
    key: &str,
    what: &str,
) -> Result<Vec<&'static T>> {
    if names.is_empty() {
        return Ok(all.iter().collect());
    }
    let known = || all.iter().map(name).collect::<Vec<_>>().join(", ");
    let find = |wanted: &String| {
        let found = all.iter().find(|one| name(one) == wanted);
        found.ok_or_else(|| input(key, wanted, what, format!("use one of: {}", known())))
    };
    names.iter().map(find).collect()
}

/// What comes of some tasks in their order, done side by side on the processors there are.
pub(super) fn side_by_side<T: Sync, R: Send>(tasks: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    let worker = || {
        while let Some((at, task)) = Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|at| Some((at, tasks.get(at)?))) {
            let result = work(task);
            done.lock().unwrap_or_else(PoisonError::into_inner).push((at, result));
        }
    };
    let workers = thread::available_parallelism().map_or(1, NonZero::get).min(tasks.len());
    thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(worker))));
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(at, _)| *at);
    done.into_iter().map(|(_, result)| result).collect()
}
