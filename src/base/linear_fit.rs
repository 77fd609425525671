//! Straight line by least squares.

/// `y = intercept + slope x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// y at x = 0.
    pub intercept: f64,
    pub slope: f64,
    /// Standard deviation of y about the line, n - 2 degrees of freedom.
    pub scatter: f64,
}

impl Line {
    pub fn at(&self, x: f64) -> f64 {
        self.intercept + self.slope * x
    }
}

/// Least squares line through points; `None` for fewer than two different x.
pub fn line(x: &[f64], y: &[f64]) -> Option<Line> {
    let count = x.len().min(y.len()) as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / count, y.iter().sum::<f64>() / count);
    let square: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    let cross: f64 = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    if count < 2.0 || square.is_nan() || square <= 0.0 {
        return None;
    }
    let slope = cross / square;
    let intercept = mean_y - slope * mean_x;
    let residual: f64 = x.iter().zip(y).map(|(x, y)| (y - intercept - slope * x).powi(2)).sum();
    Some(Line { intercept, slope, scatter: (residual / (count - 2.0).max(1.0)).sqrt() })
}
