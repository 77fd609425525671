//! What the direction of a crack against the lattice does to its growth.
//!
//! A crack between two rows of points opens like a zip: every spacing severs the same bonds. In any other direction it has to
//! step from row to row, and the bonds that hold it are strained less at equal K, the less the stiffer the tangential springs
//! are. Measured were lives of a centre crack (W 120 mm, a 20 to 40 mm, spacing 1 mm, p = 2.87) on turned lattices over that on
//! the upright one, for springs of stiffness ratio χ = k_t/k_n:
//!
//! | χ | ν | 15° | 30° | 45° |
//! |---|---|---|---|---|
//! | 0.0075 | 0.33 | 1.095 | 1.094 | 1.074 |
//! | 0.077 | 0.3 | 1.244 | 1.171 | 1.131 |
//! | 0.333 | 0.2 | 1.459 | 1.407 | 1.258 |
//!
//! With central springs alone (W 120 mm, L 200 mm) the ratios at 15, 30 and 45° were 1.078, 1.085, 1.050 at ν = 1/3, and those of
//! the state-based law 1.080, 1.105, 1.057 (ν 0.2), 1.093, 1.113, 1.049 (0.34), 1.090, 1.070, 1.117 (0.4), 1.084, 1.070, 1.127
//! (0.3 in plane strain): 1.085, 1.089, 1.080 in the mean, whatever the dilatation.
//!
//! As strain, (life ratio)^(-1/p), this is one minus a deficit that grows with √χ. On a smaller panel at ν = 0.3 the deficit did
//! not depend on p (2, 2.86, 4), was the same from 10° to 35°, and 81 % of that at 5°.
//!
//! It is the crack along the rows that stands apart: between them the life at equal K hardly depends on ν (12 575, 13 656 and
//! 13 511 cycles at 15° for ν 0.33, 0.3, 0.2), along them it does (11 489, 10 982, 9 263). So a crack between the rows is the
//! reference, and the strain of any other is brought to it; at horizons of three spacings, where this was measured.
//!
//! What is left over ν then (same plate, a 20 to 28 or 32 mm, upright and at 15°) is brought to that at ν = 0.3, so that A
//! belongs to a growth rate whatever Poisson's ratio. Lives over that at ν = 0.33, as strain:
//!
//! | ν | √χ | p 2.87 | p 2.87, 15° | p 4 | p 2 |
//! |---|---|---|---|---|---|
//! | 1/3 | 0 | 0.999 | | | |
//! | 0.32 | 0.174 | 1.011 | | | |
//! | 0.3 | 0.277 | 1.020 | 1.028 | 1.027 | 1.017 |
//! | 0.25 | 0.447 | 1.023 | 1.028 | | |
//! | 0.2 | 0.577 | 1.019 | 1.024 | 1.022 | 1.030 |
//! | 0.1 | 0.797 | 1.004 | 1.002 | 1.016 | 1.006 |
//!
//! At four and five spacings a horizon lives along the rows depend on ν by 2 % (0.3) and 11 % (0.2) of that at 0.33 as they are.
//! With the factor of ν = 0.33 at three, lives at four and five over that at three were 0.997 and 0.969 (W 110 mm, a 20 to 27 mm,
//! spacing 1 mm), 0.993 and 0.976 (0.5 mm); their mean, 0.984, is taken up.

use crate::body::Body;
use crate::specimen::Point;

crate::kinds! {
    /// Treatment of the crack's direction against the lattice.
    pub enum LatticeDirection for "fatigue.lattice_direction" {
        Corrected = "corrected": "strain of ageing bonds brought to that around a crack between the rows of points",
        Ignored = "ignored": "strain as computed",
    }
}

/// Strain deficit c₀ + c₁ √χ between the rows, and along the diagonal.
const BETWEEN: [f64; 2] = [0.0157, 0.1755];
const DIAGONAL: [f64; 2] = [0.0158, 0.106];
/// The same of central springs.
const CENTRAL: [f64; 2] = [0.0285, 0.0265];
/// Share of the deficit between the rows at some angles, degrees; from the last one on it goes over to the diagonal's.
const SHARE: [(f64, f64); 4] = [(0.0, 0.0), (5.0, 0.81), (10.0, 1.0), (35.0, 1.0)];
/// Factor that brings the strain between the rows to that at ν = 0.3, by √χ.
const OVER_POISSON: [(f64, f64); 5] = [(0.0, 0.979), (0.087, 0.979), (0.277, 1.0), (0.577, 1.003), (0.797, 0.988)];
/// The whole factor at other horizons: one A for them and for three spacings.
const OTHER_HORIZONS: f64 = 0.944;
/// A crack between the rows, degrees.
const REFERENCE_ANGLE: f64 = 20.0;
/// Horizons over spacing for which the deficit holds.
const HORIZON_RATIO: std::ops::Range<f64> = 3.0..3.16;

impl LatticeDirection {
    /// Factor on the strain of bonds around a tip that grows in `direction` (plate axes).
    #[must_use]
    pub fn strain_factor(self, body: &Body, direction: Point) -> f64 {
        if self == LatticeDirection::Ignored {
            return 1.0;
        }
        let stiffness_ratio = body.stencil.bonds.first().map_or(0.0, |bond| (bond.k_t / bond.k_n).max(0.0));
        let [along, across] = body.lattice.to_axes(direction).map(f64::abs);
        if !HORIZON_RATIO.contains(&(body.horizon() / body.lattice.spacing)) {
            return OTHER_HORIZONS;
        }
        let degrees = along.min(across).atan2(along.max(across)).to_degrees();
        between(&OVER_POISSON, stiffness_ratio.sqrt()) * (1.0 - deficit(REFERENCE_ANGLE, stiffness_ratio))
            / (1.0 - deficit(degrees, stiffness_ratio))
    }
}

/// Strain deficit at an angle of 0 to 45° against the rows, linear between the measured angles.
fn deficit(degrees: f64, stiffness_ratio: f64) -> f64 {
    let at = |[constant, slope]: [f64; 2]| constant + slope * stiffness_ratio.sqrt();
    // Between central springs and the softest tangential ones measured the deficit does not fall.
    let [rows, diagonal] = [0, 1].map(|i| at([BETWEEN, DIAGONAL][i]).max(CENTRAL[i]));
    let points: Vec<(f64, f64)> = SHARE.iter().map(|&(angle, share)| (angle, share * rows)).chain([(45.0, diagonal)]).collect();
    between(&points, degrees.min(45.0))
}

/// Linear between points of rising x, and on beyond the last two.
fn between(points: &[(f64, f64)], x: f64) -> f64 {
    let at = points.partition_point(|point| point.0 < x).clamp(1, points.len() - 1);
    let (low, high) = (points[at - 1], points[at]);
    low.1 + (high.1 - low.1) * (x - low.0) / (high.0 - low.0)
}
