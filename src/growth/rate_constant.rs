//! How fast a crack grows whose bonds follow dλ/dN = -A ε^p.
//!
//! A bond enters the fatigue zone of a steadily growing crack with λ = 1 and leaves it with 0. Its strain is that of the tip's
//! field, so ([`perilife_laws::FatigueLaw`])
//!
//! `da/dN = β A δ^(1-p/2) (K_eq/E')^p`
//!
//! with a number β that depends on p and on the kernel alone: neither on the plate, its size and its load nor on E'. ln β is stored as a
//! Chebyshev series in p for every kernel (`data/rate_constants.toml`). It was computed on a long straight crack between the rows of a
//! plate, grown by two horizons once by the strains of its bonds (`driver = "bond_strain"`, A = 1) and once by the K of its tips; the
//! ratio of the cycles gives β. `tests/verification/rate_constant.rs` computes it again. So both drivers give one life, and A and p follow
//! from C and m and the other way round. A belongs to lattices of three spacings a horizon (`model.horizon_ratio` 3.015) and to cracks
//! that do not run along their rows, and stands for the same rate on all others, on which bonds left to themselves would make another
//! one of it.

use std::collections::HashMap;
use std::sync::LazyLock;

use perilife_base::error::{Error, Result, fail_if};
use perilife_laws::{STEADY_EXPONENTS, unsteady};
use perilife_points::bond_law::Kernel;

/// Strain of the bonds around a crack in any direction over that around one along the rows, at equal K: what A belongs to. Along the
/// rows a crack opens like a zip, and faster; off them rates hardly depend on Poisson's ratio. Measured at ν = 0.3 by lives on lattices
/// turned by 10 to 35°, the same at p = 2, 2.86 and 4. It fixes the unit of A and cancels wherever A was fitted.
pub const OFF_THE_ROWS: f64 = 0.9343;

/// Chebyshev coefficients of ln β along the rows, by kernel.
static SERIES: LazyLock<HashMap<String, Vec<f64>>> =
    LazyLock::new(|| toml::from_str(include_str!("../../data/rate_constants.toml")).unwrap_or_default());
/// Difference of exponents over which the slope is taken.
const STEP: f64 = 1e-3;

/// β at an exponent.
/// Errors: p outside [`STEADY_EXPONENTS`].
pub fn rate_constant(kernel: Kernel, p: f64) -> Result<f64> {
    fail_if!(!STEADY_EXPONENTS.contains(&p), unsteady("fatigue.p", p));
    Ok(logarithm(kernel, p)?.exp())
}

/// ∂ ln β / ∂p at an exponent within [`STEADY_EXPONENTS`], at its nearer end for others.
pub fn rate_constant_slope(kernel: Kernel, p: f64) -> Result<f64> {
    let p = p.clamp(STEADY_EXPONENTS.start() + STEP, STEADY_EXPONENTS.end() - STEP);
    Ok((logarithm(kernel, p + STEP)? - logarithm(kernel, p - STEP)?) / (2.0 * STEP))
}

/// ln β by the recurrence of Clenshaw (1955).
fn logarithm(kernel: Kernel, p: f64) -> Result<f64> {
    let (low, high) = (STEADY_EXPONENTS.start(), STEADY_EXPONENTS.end());
    let x = (2.0 * p - low - high) / (high - low);
    let coefficients = SERIES
        .get(&kernel.to_string())
        .ok_or_else(|| Error::Mechanics(format!("data/rate_constants.toml has no row for kernel \"{kernel}\"")))?;
    let (first, second) = coefficients.iter().rev().fold((0.0, 0.0), |(b1, b2), c| (c + 2.0 * x * b1 - b2, b1));
    Ok(first - x * second + p * OFF_THE_ROWS.ln())
}
