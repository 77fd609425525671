//! What a benchmark ran on.

use pulp::{Simd, WithSimd};

/// Program, threads and vector units of a benchmark.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    /// Version of the program.
    pub version: &'static str,
    /// Threads of the solvers.
    pub threads: usize,
    /// Bits of the widest vectors that the kernels may use, chosen when they run.
    pub simd_bits: usize,
    /// Instruction set of these vectors.
    pub instruction_set: String,
}

impl Machine {
    /// The machine at hand.
    pub fn here() -> Self {
        let arch = pulp::Arch::new();
        // The name of the variant, without what it holds.
        let name = format!("{arch:?}");
        let instruction_set = name.split(['(', ' ']).next().unwrap_or_default().to_owned();
        Machine {
            version: env!("CARGO_PKG_VERSION"),
            threads: rayon::current_num_threads(),
            simd_bits: 64 * arch.dispatch(Lanes),
            instruction_set: format!("{} {instruction_set}", std::env::consts::ARCH),
        }
    }
}

impl std::fmt::Display for Machine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Machine { version, threads, simd_bits, instruction_set } = self;
        write!(f, "perilife {version}, {threads} threads, vectors of {simd_bits} bits ({instruction_set})")
    }
}

/// Doubles in a vector.
struct Lanes;

impl WithSimd for Lanes {
    type Output = usize;

    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F64_LANES
    }
}
