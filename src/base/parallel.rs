//! The pool of threads.

/// Runs `work` on a thread of the pool. A loop that a thread outside shares out is handed over and waited for, and an iteration of a
/// solver has dozens of them, most of them short.
pub fn in_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    rayon::scope(|_| work())
}
