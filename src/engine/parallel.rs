//! Threads, and the same digits whatever their number.

use std::sync::Once;

/// Parts into which sparse factorisations are split, on any machine: how sums are grouped must not depend on its cores.
const PARTS: usize = 4;

/// Makes sparse factorisations split their work into a fixed number of parts; called before every one.
pub fn fix_parts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| faer::set_global_parallelism(faer::Par::rayon(PARTS)));
}

/// Runs `work` on a thread of the pool. A loop that a thread outside shares out is handed over and waited for, and an iteration of a
/// solver has dozens of them, most of them short.
pub fn in_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    rayon::scope(|_| work())
}
