//! Normal noise and whole numbers by chance that are the same on every machine.

const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// Bits of a state as the generator gives them out.
fn mixed(state: u64) -> u64 {
    let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Generator of standard normal numbers: splitmix64 (Steele, Lea and Flood 2014) and the Box-Muller transform.
pub struct Noise(u64);

impl Noise {
    /// The sequence of a seed. Mixed, since the generator steps by a constant: the sequences of seeds that are multiples of it
    /// would be one sequence, shifted by a number each.
    pub fn new(seed: u64) -> Self {
        Noise(mixed(seed.wrapping_add(STEP)))
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(STEP);
        (mixed(self.0) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Next number, mean 0 and standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}

/// Whole numbers that look random (Park and Miller 1988, Commun. ACM 31:1192).
pub struct Chance(u64);

impl Chance {
    pub fn new(seed: u64) -> Self {
        Chance(seed * 7919 + 1)
    }

    /// The next number below a bound.
    pub fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        (self.0 as usize / 7) % bound
    }

    /// One of these.
    pub fn of<T: Clone>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())].clone()
    }
}
