//! Restricted maximum likelihood of the variances (Patterson and Thompson 1971), and the generalised least squares in it.
//!
//! S_i = Z T Zᵀ + cov(e) of a specimen: sought are T and the noise of the smallest
//! `½ Σ (ln|S_i| + r_iᵀ S_i⁻¹ r_i) + ½ ln|Σ Xᵀ S_i⁻¹ X + P| + priors`. Z is the first two columns of X, so that after one Cholesky
//! factor of cov(e), shared by specimens read alike, all else is products of six columns.

use std::sync::Mutex;

use argmin::core::{CostFunction, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use nalgebra::{DMatrix, Matrix2, SMatrix, SVector, Vector2};
use rayon::prelude::*;

use super::intervals::IntervalRow;
use super::noise::Noise;
use super::{Between, Priors};
use perilife_laws::curve::EFFECTS;

/// Numbers that are sought: ln sd of level and slope, artanh of their correlation, ln s, ln ℓ, ln w/s, ln r/s.
pub(super) const PARAMETERS: usize = 7;
/// The first of those that change the Cholesky factor; s is a factor of all the noise.
const FIRST_OF_FACTOR: usize = 4;
const STEP: f64 = 1e-4;
/// Where the search ends, in units of roughly a standard error.
const GRADIENT_MIN: f64 = 1e-4;
const STEPS_MAX: u64 = 100;
/// Standard deviation that levels have in the estimate of the law.
const LEVEL_FREE: f64 = 1.0;
/// Likelihood where a covariance is not positive definite.
const IMPOSSIBLE: f64 = 1e12;
pub(super) type Effects = SVector<f64, EFFECTS>;
pub(super) type EffectsMatrix = SMatrix<f64, EFFECTS, EFFECTS>;
pub(super) type Parameters = [f64; PARAMETERS];

/// Specimens that were read at the same lengths under the same loads.
pub(super) struct Group {
    pub rows: Vec<IntervalRow>,
    /// ln of cycles by the law over measured ones, of every specimen.
    pub residuals: Vec<Vec<f64>>,
    pub members: Vec<usize>,
}

/// The likelihood of all specimens at given variances.
pub(super) fn likelihood(groups: &[Group], at: &Parameters, penalty: &Penalty) -> Option<f64> {
    Some(estimate_of(&products(groups, at)?, at, penalty, 0.0)?.value)
}

/// Products `[X r]ᵀ cov(e)⁻¹ [X r]` of a group, noise in units of s.
pub(super) struct Products {
    intervals: f64,
    log_determinant: f64,
    xx: EffectsMatrix,
    xr: Vec<Effects>,
    rr: Vec<f64>,
}

/// Quadratic penalty of the fixed effects: curvature and place, on the change of the current ones.
#[derive(Clone, Copy)]
pub(super) struct Penalty {
    pub curvature: EffectsMatrix,
    pub from_place: Effects,
}

/// Fixed effects at given variances.
pub(super) struct Estimate {
    pub change: Effects,
    /// V: covariance of the fixed effects.
    pub covariance: EffectsMatrix,
    /// Restricted likelihood, negative, logarithm, without priors of the variances.
    pub value: f64,
}

/// T and the noise of a set of parameters.
pub(super) fn variances(at: &Parameters) -> (Between, Noise) {
    let scatter = at[3].exp();
    let between = Between { level: at[0].exp(), slope: at[1].exp(), correlation: at[2].tanh() };
    (between, Noise { scatter, length: at[4].exp(), white: scatter * at[5].exp(), reading: scatter * at[6].exp() })
}

/// The products of all groups, or `None` where the noise is not positive definite.
fn products(groups: &[Group], at: &Parameters) -> Option<Vec<Products>> {
    let (_, noise) = variances(at);
    let unit =
        Noise { scatter: 1.0, length: noise.length, white: noise.white / noise.scatter, reading: noise.reading / noise.scatter };
    groups.par_iter().map(|group| of_group(group, &unit)).collect()
}

fn of_group(group: &Group, unit: &Noise) -> Option<Products> {
    let (n, specimens) = (group.rows.len(), group.residuals.len());
    let factor = unit.covariance(&group.rows).cholesky()?;
    let entry = |j: usize, k: usize| if k < EFFECTS { group.rows[j].design[k] } else { group.residuals[k - EFFECTS][j] };
    let mut white = DMatrix::from_fn(n, EFFECTS + specimens, entry);
    factor.l_dirty().solve_lower_triangular_mut(&mut white);
    let (x, residuals) = (white.fixed_columns::<EFFECTS>(0), white.columns(EFFECTS, specimens));
    Some(Products {
        intervals: n as f64,
        log_determinant: factor.l_dirty().diagonal().iter().map(|l| 2.0 * l.ln()).sum(),
        xx: x.tr_mul(&x),
        xr: residuals.column_iter().map(|residual| x.tr_mul(&residual)).collect(),
        rr: residuals.column_iter().map(|residual| residual.norm_squared()).collect(),
    })
}

fn top(matrix: &EffectsMatrix) -> Matrix2<f64> {
    matrix.fixed_view::<2, 2>(0, 0).into_owned()
}

fn first_two(vector: &Effects) -> Vector2<f64> {
    Vector2::new(vector[0], vector[1])
}

/// Generalised least squares from products, by weights as if levels had a variance that is larger by `free`.
fn estimate_of(products: &[Products], at: &Parameters, penalty: &Penalty, free: f64) -> Option<Estimate> {
    let (between, noise) = variances(at);
    let t = between.matrix() + Matrix2::new(free, 0.0, 0.0, 0.0);
    let (variance, log_variance) = (noise.scatter * noise.scatter, 2.0 * noise.scatter.ln());
    let mut curvature = penalty.curvature;
    let mut of_free = EffectsMatrix::zeros();
    let mut right = -penalty.curvature * penalty.from_place;
    let mut twice = -right.dot(&penalty.from_place);
    for group in products {
        let specimens = group.rr.len() as f64;
        let xx = group.xx / variance;
        let zx = xx.fixed_rows::<2>(0).into_owned();
        let mixed = Matrix2::identity() + top(&xx) * t;
        let inverse = mixed.try_inverse()?;
        // M = (T⁻¹ + Zᵀ cov(e)⁻¹ Z)⁻¹, written so that T may be singular.
        let m = t * inverse;
        // Xᵀ S⁻¹ X = Xᵀ cov(e)⁻¹ X - (Xᵀ cov(e)⁻¹ Z) M (Zᵀ cov(e)⁻¹ X). Of Z itself hardly anything is left of the difference, where
        // noise is small; there it is (I + A T)⁻¹ Zᵀ cov(e)⁻¹ X.
        let of_z = inverse * zx;
        let mut one = xx - zx.transpose() * m * zx;
        one.fixed_rows_mut::<2>(0).copy_from(&of_z);
        one.fixed_columns_mut::<2>(0).copy_from(&of_z.transpose());
        curvature += one * specimens;
        // Z is the start of X: what the variance of the levels adds to Xᵀ S⁻¹ r.
        of_free += one.column(0) * one.column(0).transpose() * (specimens * free);
        twice += specimens * (group.log_determinant + group.intervals * log_variance + mixed.determinant().ln());
        for (xr, rr) in group.xr.iter().zip(&group.rr) {
            let (xr, zr) = (xr / variance, first_two(xr) / variance);
            let of_z = inverse * zr;
            let mut of_specimen = xr - zx.transpose() * (m * zr);
            of_specimen.fixed_rows_mut::<2>(0).copy_from(&of_z);
            right += of_specimen;
            twice += rr / variance - zr.dot(&(t * of_z));
        }
    }
    let factor = curvature.cholesky()?;
    let change = factor.solve(&right);
    twice += 2.0 * factor.l_dirty().diagonal().iter().map(|l| l.ln()).sum::<f64>() - right.dot(&change);
    let inverse = factor.inverse();
    let covariance = inverse - inverse * of_free * inverse;
    twice.is_finite().then_some(Estimate { change, covariance, value: 0.5 * twice })
}

/// Generalised least squares of the law at given variances. Levels are all but free ([`LEVEL_FREE`]), so that m is that of the growth within
/// specimens: a lot of which each is exact has their m, whatever their levels. The covariance is that of this estimate under the variances.
pub(super) fn estimate(groups: &[Group], at: &Parameters, penalty: &Penalty) -> Option<Estimate> {
    estimate_of(&products(groups, at)?, at, penalty, LEVEL_FREE * LEVEL_FREE)
}

/// Departures of the specimens of a group from the law, b_i and m_i, and the mean square of what is left in units of its deviation.
pub(super) fn departures(group: &Group, at: &Parameters, change: &Effects) -> Option<Vec<([f64; 2], f64)>> {
    let of_group = products(std::slice::from_ref(group), at)?.pop()?;
    let (between, noise) = variances(at);
    let (t, variance) = (between.matrix(), noise.scatter * noise.scatter);
    let m = t * (Matrix2::identity() + top(&of_group.xx) / variance * t).try_inverse()?;
    let one = |(xr, rr): (&Effects, &f64)| {
        let xr_left = xr - of_group.xx * change;
        let rr_left = rr - 2.0 * xr.dot(change) + change.dot(&(of_group.xx * change));
        let z = first_two(&xr_left) / variance;
        let own = m * z;
        ([own[0], own[1]], (rr_left / variance - z.dot(&own)) / of_group.intervals)
    };
    Some(of_group.xr.iter().zip(&of_group.rr).map(one).collect())
}

/// The likelihood as it is minimised: parameters in units of roughly their standard error.
struct Search<'a> {
    groups: &'a [Group],
    penalty: &'a Penalty,
    priors: &'a Priors,
    unit: Parameters,
    /// Smallest value so far and where: a line search that fails has not lost it.
    best: Mutex<(f64, Parameters)>,
}

impl Search<'_> {
    fn parameters(&self, scaled: &[f64]) -> Parameters {
        std::array::from_fn(|i| scaled[i] * self.unit[i])
    }

    fn value_of(&self, products: Option<&[Products]>, at: &Parameters) -> f64 {
        let found = products.and_then(|products| estimate_of(products, at, self.penalty, 0.0));
        found.map_or(IMPOSSIBLE, |found| found.value + self.priors.penalty(at))
    }

    fn value(&self, at: &Parameters) -> f64 {
        self.value_of(products(self.groups, at).as_deref(), at)
    }

    /// Derivatives by central differences; those of T and s need no other factor.
    fn slope(&self, at: &Parameters) -> Parameters {
        let here = products(self.groups, at);
        std::array::from_fn(|i| {
            let beside = |side: f64| {
                let mut beside = *at;
                beside[i] += side * STEP;
                if i < FIRST_OF_FACTOR { self.value_of(here.as_deref(), &beside) } else { self.value(&beside) }
            };
            (beside(1.0) - beside(-1.0)) / (2.0 * STEP)
        })
    }
}

impl CostFunction for &Search<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, scaled: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        let at = self.parameters(scaled);
        let value = self.value(&at);
        if let Ok(mut best) = self.best.lock()
            && value < best.0
        {
            *best = (value, at);
        }
        Ok(value)
    }
}

impl Gradient for &Search<'_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, scaled: &Vec<f64>) -> Result<Vec<f64>, argmin::core::Error> {
        let slope = self.slope(&self.parameters(scaled));
        Ok(slope.iter().zip(self.unit).map(|(slope, unit)| slope * unit).collect())
    }
}

fn search<'a>(groups: &'a [Group], penalty: &'a Penalty, priors: &'a Priors, start: &Parameters) -> Search<'a> {
    let specimens: f64 = groups.iter().map(|group| group.members.len() as f64).sum();
    let intervals: f64 = groups.iter().map(|group| (group.members.len() * group.rows.len()) as f64).sum();
    let unit = std::array::from_fn(|i| if i < 3 { 1.0 / specimens.sqrt() } else { 2.0 / intervals.sqrt() });
    Search { groups, penalty, priors, unit, best: Mutex::new((f64::INFINITY, *start)) }
}

pub(super) fn minimise(groups: &[Group], penalty: &Penalty, priors: &Priors, start: &Parameters) -> Parameters {
    let problem = search(groups, penalty, priors, start);
    let scaled: Vec<f64> = start.iter().zip(problem.unit).map(|(value, unit)| value / unit).collect();
    let line_search = MoreThuenteLineSearch::new();
    if let Ok(solver) = LBFGS::new(line_search, PARAMETERS).with_tolerance_grad(GRADIENT_MIN) {
        // A line search that ends at the round-off of the differences has found what there is: `best` has it.
        let _ = Executor::new(&problem, solver).configure(|state| state.param(scaled).max_iters(STEPS_MAX)).run();
    }
    problem.best.into_inner().map_or(*start, |(_, at)| at)
}
