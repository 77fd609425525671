//! Student's t distribution and the noncentral one, by quadrature over the scatter that is estimated.

use perilife_base::monotone::bisected;
use perilife_base::quadrature::integrate;

const HALVINGS: usize = 80;

/// Standard normal distribution to the last digit (that of `statrs` is right to eleven).
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// Probability that `(z + shift) / √(χ²_ν / ν)` stays below t.
pub fn noncentral_t_cdf(t: f64, nu: f64, shift: f64) -> f64 {
    let mode = ((nu - 1.0).max(0.0) / nu).sqrt();
    let log_density = |w: f64| (nu - 1.0) * w.ln() - 0.5 * nu * w * w;
    let top = if mode > 0.0 { log_density(mode) } else { 0.0 };
    let density = |w: f64| (log_density(w) - top).exp();
    let reach = 12.0 / (2.0 * nu).sqrt();
    let (from, to) = ((mode - reach).max(0.0), mode + reach);
    let below = |w: f64| density(w) * normal_cdf(t * w - shift);
    integrate(below, from, to, 1e-13).value / integrate(density, from, to, 1e-13).value
}

pub fn noncentral_t_quantile(probability: f64, nu: f64, shift: f64) -> f64 {
    let (mut low, mut high) = (shift - 1.0, shift + 1.0);
    while noncentral_t_cdf(low, nu, shift) > probability {
        low = shift + 2.0 * (low - shift);
    }
    while noncentral_t_cdf(high, nu, shift) < probability {
        high = shift + 2.0 * (high - shift);
    }
    let [low, high] = bisected([low, high], HALVINGS, |t| noncentral_t_cdf(t, nu, shift) < probability);
    0.5 * (low + high)
}

pub fn t_quantile(probability: f64, nu: f64) -> f64 {
    noncentral_t_quantile(probability, nu, 0.0)
}
