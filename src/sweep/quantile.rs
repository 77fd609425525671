//! Quantiles of a sample.

/// Quantile of a sample sorted upwards, by definition 7 of Hyndman and Fan (1996, Am. Stat. 50:361): with `h = (n-1) q` the value
/// between the two at `⌊h⌋` and `⌊h⌋ + 1`, counted from 0, by the fraction of h. NaN for an empty sample.
///
/// ```
/// # use perilife::sweep::quantile::quantile;
/// assert_eq!(quantile(&[1.0, 2.0, 4.0, 8.0], 0.5), 3.0);
/// ```
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let h = last as f64 * q.clamp(0.0, 1.0);
    let low = h.floor() as usize;
    let high = (low + 1).min(last);
    sorted[low] + (h - low as f64) * (sorted[high] - sorted[low])
}
