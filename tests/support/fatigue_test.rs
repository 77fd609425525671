//! A made test of a compact specimen whose law and loads are known.

/// W, mm.
pub const WIDTH: f64 = 50.0;
/// B, mm.
pub const THICKNESS: f64 = 12.0;

/// ΔK in MPa√m by ASTM E647, annex A1, under a range of force in kN at a length in mm.
pub fn delta_k(force_range: f64, length: f64) -> f64 {
    let x = length / WIDTH;
    let f = (2.0 + x) / (1.0 - x).powf(1.5) * (0.886 + x * (4.64 + x * (-13.32 + x * (14.72 - 5.6 * x))));
    1e3 * force_range / (THICKNESS * WIDTH.sqrt()) * f * 1e-3_f64.sqrt()
}

/// Readings of a test: cycles and lengths in mm, growth by `c delta_k^m` (mm/cycle) slowed by `slow(length)`, under a range of force (kN)
/// that may depend on the length.
pub fn readings(c: f64, m: f64, lengths: &[f64], force_range: impl Fn(f64) -> f64, slow: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    const PARTS: usize = 200;
    let mut cycles = 0.0;
    let mut made = vec![(0.0, lengths[0])];
    for pair in lengths.windows(2) {
        let part = (pair[1] - pair[0]) / PARTS as f64;
        let taken = |i: usize| {
            let a = pair[0] + part * (i as f64 + 0.5);
            part * slow(a) / (c * delta_k(force_range(a), a).powf(m))
        };
        cycles += (0..PARTS).map(taken).sum::<f64>();
        made.push((cycles, pair[1]));
    }
    made
}

/// Lengths from one to another by equal steps, mm.
pub fn lengths(from: f64, to: f64, step: f64) -> Vec<f64> {
    (0..=((to - from) / step).round() as usize).map(|i| from + step * i as f64).collect()
}

/// A calibration of such a test by hand calculation, ratio 0.1, nominal force range 5.4 kN.
pub fn calibration(file: &str, more: &str) -> String {
    format!(
        "[measured]\nfiles = [\"{file}\"]\n{more}\n[specimen]\nkind = \"compact_tension\"\nwidth_mm = {WIDTH}\nthickness_mm = {THICKNESS}\n\
         crack_length_mm = 12.0\n[material]\nyoungs_modulus_gpa = 200.0\npoisson_ratio = 0.3\nplane = \"stress\"\n[loading]\n\
         force_range_kn = 5.4\nstress_ratio = 0.1\n[model]\nmethod = \"handbook\"\n"
    )
}

/// Squared Mahalanobis distance of (ln A, p) from a fit; below 5.991 inside the 95 % ellipse (χ², 2 degrees of freedom).
pub fn distance_squared([[a, b], [c, d]]: [[f64; 2]; 2], [x, y]: [f64; 2]) -> f64 {
    (x * (d * x - b * y) + y * (a * y - c * x)) / (a * d - b * c)
}
