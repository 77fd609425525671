//! The same digits whatever the number of threads.

use std::sync::Once;

/// Parts into which sparse factorisations are split, on any machine: how sums are grouped must not depend on its cores.
const PARTS: usize = 4;

/// Makes sparse factorisations split their work into a fixed number of parts; called before every one.
pub fn fix_parts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| faer::set_global_parallelism(faer::Par::rayon(PARTS)));
}
