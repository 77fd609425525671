//! Lives by the model of a lot: of a new specimen, of one with readings of its own, on the plate of the tests or any other.
//!
//! A path is divided into cells of `n_j` cycles, ln rates of which have the covariance `S = Z T Zᵀ + X V Xᵀ + cov(e)`. A life is the sum of
//! correlated lognormals, taken as lognormal itself with their mean and variance: `u_j = n_j e^(S_jj/2)`, `M = Σ u_j`,
//! `s² = ln(1 + uᵀ(e^S - 1)u / M²)`, median `M e^(-s²/2)`, quantiles `median · exp(t_ν s)`.

use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::Population;
use super::intervals::{Interval, IntervalRow, Specimen, rows};
use super::lots::BETWEEN_LOTS;
use super::student::{noncentral_t_quantile, t_quantile};
use perilife_base::error::{Error, Result, input};
use perilife_base::units::MPA_SQRT_M;
pub use perilife_growth::case::Lot;
use perilife_laws::curve::EFFECTS;

/// Cells of a path: from 12 on lives change by less than 0.2 %.
pub const CELLS: usize = 24;
/// Smallest standard deviation of the slope outside the calibrated range.
const SLOPE_DEVIATION_MIN: f64 = 0.5;
/// Factor of ΔK beyond the calibrated range up to which the chord is continued.
pub(super) const BEYOND_MAX: f64 = 2.0;
const BASIS_CONFIDENCE: f64 = 0.95;
const BASIS_SPECIMENS_MIN: usize = 3;

/// Lower bound of lives with a confidence of 95 %.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    A,
    B,
}

/// ln cycles of the cells of a path and their covariance.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    cycles: Vec<f64>,
    /// Covariance of their logarithms.
    covariance: DMatrix<f64>,
    /// ν of Student's t.
    freedom: f64,
    specimens: usize,
    /// Whether it is of a specimen with readings of its own, or of another lot.
    is_special: bool,
    /// Share of the life outside the calibrated range of ΔK.
    pub share_outside: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Life {
    pub median: f64,
    /// Standard deviation of ln life where ν is large.
    pub deviation: f64,
    /// ν of Student's t.
    pub freedom: f64,
}

impl Life {
    /// Cycles that a specimen does not reach with a probability.
    pub fn quantile(&self, probability: f64) -> f64 {
        self.median * (t_quantile(probability, self.freedom) * self.deviation).exp()
    }

    /// Ends of the band that holds a share of specimens.
    pub fn band(&self, share: f64) -> [f64; 2] {
        [0.5 * (1.0 - share), 0.5 * (1.0 + share)].map(|probability| self.quantile(probability))
    }
}

impl Population {
    /// Lives along a path of cells ([`super::intervals::cells`]), `own` being the specimen's readings up to its start.
    /// Errors: ΔK further outside the calibrated range than the law is continued.
    pub fn forecast(&self, path: &[Interval], own: Option<&Specimen>, lot: Lot) -> Result<Forecast> {
        self.check_range(path)?;
        let own: &[Interval] = own.map_or(&[], |own| &own.intervals);
        let mut all = rows(&self.law, own);
        let observed = all.len();
        let reached = all.last().map_or(0.0, |row| row.zone[1]);
        let of_path = rows(&self.law, path);
        // No error of a reading is left in a life.
        let reached_by = |row: &IntervalRow| row.zone.map(|zone| zone + reached);
        all.extend(of_path.iter().map(|row| IntervalRow { density: [0.0; 2], zone: reached_by(row), ..*row }));
        let n = all.len();
        let covariance = self.of_rows(&all, lot);

        // cov(future) - C_fo C_oo⁻¹ C_of and the mean with it, by the factor of the observed part.
        let cells = n - observed;
        let factor = covariance.view((0, 0), (observed, observed)).into_owned().cholesky();
        let not_definite = || Error::Mechanics("the covariance of the readings is not positive definite".to_owned());
        let factor = factor.ok_or_else(not_definite)?.unpack();
        let mut white = covariance.view((0, observed), (observed, cells)).into_owned();
        let mut residuals = DVector::from_fn(observed, |i, _| all[i].log_cycles - own[i].cycles.ln());
        factor.solve_lower_triangular_mut(&mut white);
        factor.solve_lower_triangular_mut(&mut residuals);
        let conditional = covariance.view((observed, observed), (cells, cells)) - white.tr_mul(&white);
        let known = white.tr_mul(&residuals);
        let cycles: Vec<f64> = (0..cells)
            .map(|j| {
                let row = &all[observed + j];
                // On the mean over the noise a specimen takes the cycles of the law of lives.
                (row.log_cycles - self.level_of_lives - 0.5 * self.noise.variance(row) - known[j]).exp()
            })
            .collect();
        let outside: f64 = cycles.iter().zip(&of_path).map(|(n, row)| n * row.outside).sum();
        Ok(Forecast {
            share_outside: outside / cycles.iter().sum::<f64>(),
            cycles,
            covariance: conditional,
            freedom: self.freedom,
            specimens: self.specimens.len(),
            is_special: observed > 0 || lot == Lot::Other,
        })
    }

    /// Standard deviation of the slope of the law outside the calibrated range.
    pub fn slope_deviation_outside(&self) -> f64 {
        self.law.slope_deviation().max(SLOPE_DEVIATION_MIN)
    }

    /// `Z T Zᵀ + X V Xᵀ + cov(e)`, whole.
    fn of_rows(&self, rows: &[IntervalRow], lot: Lot) -> DMatrix<f64> {
        let n = rows.len();
        let mut whole = self.noise.covariance(rows);
        let t = self.between.matrix();
        let between_lots = if lot == Lot::Other { BETWEEN_LOTS * BETWEEN_LOTS } else { 0.0 };
        let outside = self.slope_deviation_outside().powi(2);
        for j in 0..n {
            let x = &rows[j].design;
            // Rows of X V + Z T, so that the product with the other row is all.
            let mut left: [f64; EFFECTS] =
                std::array::from_fn(|k| x.iter().zip(&self.covariance).map(|(x, of_row)| x * of_row[k]).sum());
            left[0] += t[(0, 0)] * x[0] + t[(1, 0)] * x[1] + between_lots;
            left[1] += t[(0, 1)] * x[0] + t[(1, 1)] * x[1];
            for l in 0..=j {
                let shared: f64 = left.iter().zip(&rows[l].design).map(|(a, b)| a * b).sum();
                let (near, far) = (rows[j].beyond, rows[l].beyond);
                let value = whole[(j, l)] + shared + outside * (near[0] * far[0] + near[1] * far[1]);
                (whole[(j, l)], whole[(l, j)]) = (value, value);
            }
        }
        whole
    }

    fn check_range(&self, path: &[Interval]) -> Result<()> {
        let [low, high] = self.law.range;
        let ends = || path.iter().flat_map(|cell| &cell.ends).map(|tips| tips[0].exp());
        let (least, most) = ends().fold((f64::INFINITY, 0.0_f64), |(least, most), k| (least.min(k), most.max(k)));
        if least * BEYOND_MAX >= low && most <= high * BEYOND_MAX {
            return Ok(());
        }
        let in_mpa = |k: f64| k / MPA_SQRT_M;
        Err(input(
            "loading",
            format!("ΔK {:.2} to {:.2} MPa√m", in_mpa(least), in_mpa(most)),
            format!("is more than a factor {BEYOND_MAX} outside the tested ΔK {:.2} to {:.2} MPa√m", in_mpa(low), in_mpa(high)),
            "test at such ΔK, or use a shorter crack growth range",
        ))
    }
}

impl Forecast {
    /// Median and scatter in closed form: within 0.5 % of draws.
    pub fn life(&self) -> Life {
        let u = DVector::from_fn(self.cycles.len(), |j, _| self.cycles[j] * (0.5 * self.covariance[(j, j)]).exp());
        let (mean, square) = (u.sum(), u.dot(&(self.covariance.map(f64::exp_m1) * &u)));
        let variance = (square / (mean * mean)).ln_1p();
        Life { median: mean * (-0.5 * variance).exp(), deviation: variance.sqrt(), freedom: self.freedom }
    }

    pub fn cells(&self) -> &[f64] {
        &self.cycles
    }

    /// Lives drawn at random, the same for the same seed.
    /// Errors: as [`Forecast::draw`].
    pub fn draws(&self, count: usize, seed: u64) -> Result<Vec<f64>> {
        self.draw(count, seed, |factors| self.cycles.iter().zip(factors).map(|(cycles, factor)| cycles * factor).sum())
    }

    /// Specimens drawn at random, the same for the same seed: `each` has the cycles of the cells over their medians.
    /// Errors: a covariance that is not positive definite.
    pub fn draw<T>(&self, count: usize, seed: u64, mut each: impl FnMut(&[f64]) -> T) -> Result<Vec<T>> {
        let not_definite = || Error::Mechanics("the covariance of the cells is not positive definite".to_owned());
        let factor = self.covariance.clone().cholesky().ok_or_else(not_definite)?.l();
        let mut normal = Normal::new(seed);
        let specimen = |_| {
            let z = DVector::from_fn(self.cycles.len(), |_, _| normal.next());
            let chi_square: f64 = (0..self.freedom.round() as usize).map(|_| normal.next().powi(2)).sum();
            let scale = (self.freedom.round() / chi_square).sqrt();
            each((&factor * z).map(|log| (scale * log).exp()).as_slice())
        };
        Ok((0..count).map(specimen).collect())
    }

    /// Lower bound of lives with a confidence of 95 %, by the noncentral t distribution. Handbooks ask for about 100 values of ten lots for A
    /// and 30 of five for B: from one lot it is no material basis value.
    /// Errors: fewer than three specimens; a path outside the calibrated range; a specimen with readings of its own.
    pub fn basis(&self, basis: Basis) -> Result<f64> {
        let refuse = |value: String, problem: &str, remedy: &str| Err(input("basis", value, problem, remedy));
        if self.specimens < BASIS_SPECIMENS_MIN {
            return refuse(format!("{} specimens", self.specimens), "too few specimens for a basis value", "test at least three");
        }
        if self.share_outside > 0.0 {
            let share = format!("{:.1} % of the life", 100.0 * self.share_outside);
            return refuse(share, "is outside the tested ΔK range", "test at such ΔK");
        }
        if self.is_special {
            return refuse("one specimen or another lot".to_owned(), "has no basis value", "use the lot of the specimens");
        }
        let life = self.life();
        Ok(life.median * (-tolerance_factor(basis, self.specimens) * life.deviation).exp())
    }
}

/// k of the one-sided tolerance bound `mean - k s` of n normal values.
pub fn tolerance_factor(basis: Basis, specimens: usize) -> f64 {
    // Quantiles of the normal distribution at 0.99 and 0.90.
    let z = match basis {
        Basis::A => 2.326_347_874_040_841,
        Basis::B => 1.281_551_565_544_600_4,
    };
    let root = (specimens as f64).sqrt();
    noncentral_t_quantile(BASIS_CONFIDENCE, specimens as f64 - 1.0, z * root) / root
}

/// Standard normal numbers (Box and Muller 1958).
struct Normal {
    random: ChaCha8Rng,
    second: Option<f64>,
}

impl Normal {
    fn new(seed: u64) -> Normal {
        Normal { random: ChaCha8Rng::seed_from_u64(seed), second: None }
    }

    fn next(&mut self) -> f64 {
        if let Some(second) = self.second.take() {
            return second;
        }
        // Above 0, so that it has a logarithm.
        let uniform = |word: u64| ((word >> 11) as f64 + 0.5) * (-53.0_f64).exp2();
        let radius = (-2.0 * uniform(self.random.next_u64()).ln()).sqrt();
        let (sine, cosine) = (2.0 * std::f64::consts::PI * uniform(self.random.next_u64())).sin_cos();
        self.second = Some(radius * sine);
        radius * cosine
    }
}
