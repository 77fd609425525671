//! Nonlinear least squares between bounds: Levenberg (1944, Q. Appl. Math. 2:164) and Marquardt (1963, J. SIAM 11:431).
//!
//! The level of the model is free and linear, so it is not searched: it is the mean of what the shape leaves (variable projection, Golub
//! and Pereyra 1973, SIAM J. Numer. Anal. 10:413). A variable at a bound that the gradient pushes outwards stands still in that step.

use nalgebra::{DMatrix, DVector};

const STEPS_MAX: usize = 2000;
/// Share by which a sum of squares has to fall for a step to count.
const PROGRESS: f64 = 1e-13;
/// Steps without progress after which a search has come to its end.
const STEPS_WITHOUT: usize = 4;
/// Root mean square of residuals that is round-off.
const ROUND_OFF: f64 = 1e-12;
/// Damping above which no step of any size leads down.
const DAMPING_MAX: f64 = 1e14;
/// Difference of a variable by which slopes are taken.
const DIFFERENCE: f64 = 1e-6;
/// ln of the rates of a law at all rows but for their level; `None` where the law has no rate at one of them.
pub(super) type Shape<'a> = &'a (dyn Fn(&[f64]) -> Option<Vec<f64>> + Sync);

#[derive(Debug, Clone)]
pub(super) struct Minimum {
    pub at: Vec<f64>,
    pub level: f64,
    pub residuals: Vec<f64>,
    /// Derivatives of the shape over the variables, a column each.
    pub slopes: DMatrix<f64>,
}

impl Minimum {
    pub fn sum(&self) -> f64 {
        self.residuals.iter().map(|residual| residual * residual).sum()
    }
}

/// The least sum of squares of `measured` less the shape, from one start; `None` where the start has no rates or the search does not end.
pub(super) fn minimise(shape: Shape<'_>, measured: &[f64], start: &[f64], bounds: &[[f64; 2]]) -> Option<Minimum> {
    let at_start = clamped(DVector::from_column_slice(start), bounds);
    let mut now = Point::new(shape, measured, at_start)?;
    let (mut damping, mut idle) = (1e-3, 0);
    for _ in 0..STEPS_MAX {
        let slopes = slopes(shape, now.at.as_slice(), bounds)?;
        if now.sum <= measured.len() as f64 * ROUND_OFF * ROUND_OFF || idle >= STEPS_WITHOUT || bounds.is_empty() {
            return Some(now.minimum(slopes));
        }
        let projected = without_level(&slopes);
        let gradient = projected.transpose() * &now.residuals;
        let moves: Vec<bool> = (0..bounds.len()).map(|i| can_move(now.at[i], gradient[i], bounds[i])).collect();
        let normal = projected.transpose() * &projected;
        let before = now.sum;
        while damping < DAMPING_MAX {
            let step = damped_step(&normal, &gradient, &moves, damping)?;
            match Point::new(shape, measured, clamped(&now.at + step, bounds)).filter(|next| next.sum < before) {
                Some(next) => {
                    now = next;
                    damping = (damping / 5.0).max(1e-12);
                    break;
                }
                None => damping *= 4.0,
            }
        }
        if damping >= DAMPING_MAX {
            return Some(now.minimum(slopes));
        }
        idle = if before - now.sum < PROGRESS * before { idle + 1 } else { 0 };
    }
    None
}

struct Point {
    at: DVector<f64>,
    level: f64,
    residuals: DVector<f64>,
    sum: f64,
}

impl Point {
    fn new(shape: Shape<'_>, measured: &[f64], at: DVector<f64>) -> Option<Self> {
        let left = DVector::from_column_slice(measured) - DVector::from_vec(shape(at.as_slice())?);
        let level = left.mean();
        let residuals = left.add_scalar(-level);
        let sum = residuals.norm_squared();
        sum.is_finite().then_some(Point { at, level, residuals, sum })
    }

    fn minimum(self, slopes: DMatrix<f64>) -> Minimum {
        Minimum { at: self.at.as_slice().to_vec(), level: self.level, residuals: self.residuals.as_slice().to_vec(), slopes }
    }
}

fn clamped(mut at: DVector<f64>, bounds: &[[f64; 2]]) -> DVector<f64> {
    at.iter_mut().zip(bounds).for_each(|(value, [low, high])| *value = value.clamp(*low, *high));
    at
}

fn can_move(value: f64, gradient: f64, [low, high]: [f64; 2]) -> bool {
    !(value <= low && gradient < 0.0 || value >= high && gradient > 0.0)
}

/// Columns less their means: what the level does not take up.
pub(super) fn without_level(slopes: &DMatrix<f64>) -> DMatrix<f64> {
    let mut projected = slopes.clone();
    projected.column_iter_mut().for_each(|mut column| {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    });
    projected
}

fn damped_step(normal: &DMatrix<f64>, gradient: &DVector<f64>, moves: &[bool], damping: f64) -> Option<DVector<f64>> {
    let mut matrix = normal.clone();
    let mut right = gradient.clone();
    for i in 0..moves.len() {
        let own = normal[(i, i)];
        if moves[i] && own > 0.0 {
            matrix[(i, i)] = own * (1.0 + damping);
        } else {
            matrix.row_mut(i).fill(0.0);
            matrix.column_mut(i).fill(0.0);
            (matrix[(i, i)], right[i]) = (1.0, 0.0);
        }
    }
    matrix.lu().solve(&right)
}

/// Central differences, to one side where the other has no rates or lies beyond a bound.
fn slopes(shape: Shape<'_>, at: &[f64], bounds: &[[f64; 2]]) -> Option<DMatrix<f64>> {
    let own = shape(at)?;
    let mut columns = DMatrix::zeros(own.len(), at.len());
    for (i, [low, high]) in bounds.iter().enumerate() {
        let size = DIFFERENCE * at[i].abs().max(1.0);
        let moved = |value: f64| {
            let mut there = at.to_vec();
            there[i] = value;
            Some((shape(&there)?, value))
        };
        let from = moved((at[i] - size).max(*low)).unwrap_or_else(|| (own.clone(), at[i]));
        let to = moved((at[i] + size).min(*high)).unwrap_or_else(|| (own.clone(), at[i]));
        let width = to.1 - from.1;
        (0..own.len()).for_each(|row| columns[(row, i)] = (to.0[row] - from.0[row]) / width);
    }
    columns.iter().all(|slope| slope.is_finite()).then_some(columns)
}
