//! A crack front in its plate in the letters of Newman and Raju, and what their formulas share.

use std::f64::consts::{FRAC_PI_2, PI};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrontTip {
    /// The end of the semi-axis a, φ = 90°: deepest point of a surface crack, on the edge or in the hole of a corner crack.
    Depth,
    /// The end of the semi-axis c, φ = 0: on the face of the plate, and in its middle plane of an embedded crack.
    Surface,
}

impl FrontTip {
    pub const ALL: [FrontTip; 2] = [FrontTip::Depth, FrontTip::Surface];

    /// Parametric angle φ of the ellipse, rad.
    pub fn angle(self) -> f64 {
        match self {
            FrontTip::Depth => FRAC_PI_2,
            FrontTip::Surface => 0.0,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            FrontTip::Depth => "depth",
            FrontTip::Surface => "surface",
        }
    }
}

/// A part of an ellipse as crack front, m, with the semi-axes a through the thickness and c along the width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrackFront {
    pub a: f64,
    pub c: f64,
    /// Thickness; half of it of an embedded crack.
    pub t: f64,
    /// Half width; the whole one of a plate with a corner crack at an edge.
    pub b: f64,
    /// Radius of the hole; 0 without one.
    pub r: f64,
    /// Cracks at the hole, 1 or 2.
    pub n: f64,
}

impl CrackFront {
    pub fn aspect(&self) -> f64 {
        self.a / self.c
    }

    pub fn depth(&self) -> f64 {
        self.a / self.t
    }

    /// `M1 + M2 (a/t)² + M3 (a/t)⁴`.
    pub(super) fn series(&self, [m1, m2, m3]: [f64; 3]) -> f64 {
        let s = self.depth().powi(2);
        m1 + s * (m2 + s * m3)
    }

    /// The smaller of a/c and c/a.
    pub(super) fn flatness(&self) -> f64 {
        self.aspect().min(1.0 / self.aspect())
    }

    /// `Q = 1 + 1.464 x^1.65`, x the smaller of a/c and c/a: the square of the complete elliptic integral of the second kind within 0.13 %.
    pub fn shape_factor(&self) -> f64 {
        1.0 + 1.464 * self.flatness().powf(1.65)
    }

    /// `f_φ`, K of the ellipse in an infinite body over that at the end of its shorter axis:
    /// `[(a/c)² cos²φ + sin²φ]^¼` up to a/c = 1, `[cos²φ + (c/a)² sin²φ]^¼` above.
    pub(super) fn around(&self, angle: f64) -> f64 {
        let (sin, cos) = angle.sin_cos();
        let x = self.flatness();
        let [along, through] = if self.aspect() <= 1.0 { [x * cos, sin] } else { [cos, x * sin] };
        (along * along + through * through).sqrt().sqrt()
    }

    /// `f_w = [sec(π c/(2b) √(a/t))]^½`, for the width of a plate with a crack in its middle. Infinite where that is through.
    pub(super) fn width_of_central(&self) -> f64 {
        secant(PI * self.c / (2.0 * self.b) * self.depth().sqrt()).sqrt()
    }

    /// `H = H1 + (H2 - H1) sin^p φ`: K of bending over K of a tension as large as the stress of the bending at the face.
    pub(super) fn bent([h1, h2]: [f64; 2], p: f64, angle: f64) -> f64 {
        h1 + (h2 - h1) * angle.sin().powf(p)
    }

    /// `p`, `H1` and `H2` of surface and corner cracks, which differ in one constant of H2 only.
    pub(super) fn bending_of_faces(&self, constant: f64, angle: f64) -> f64 {
        let (x, s) = (self.flatness(), self.depth());
        let root = x.powf(0.75);
        let h = if self.aspect() <= 1.0 {
            let second = [-1.22 - 0.12 * x, constant - 1.05 * root + 0.47 * root * root];
            [1.0 - 0.34 * s - 0.11 * x * s, 1.0 + s * (second[0] + s * second[1])]
        } else {
            let first = [-0.04 - 0.41 * x, 0.55 - 1.93 * root + 1.38 * root * root];
            let second = [-2.11 + 0.77 * x, constant - 0.72 * root + 0.14 * root * root];
            [first, second].map(|[linear, square]| 1.0 + s * (linear + s * square))
        };
        CrackFront::bent(h, 0.2 + x + 0.6 * s, angle)
    }
}

/// 1/cos, infinite from a right angle on.
pub(super) fn secant(angle: f64) -> f64 {
    if angle < FRAC_PI_2 { 1.0 / angle.cos() } else { f64::INFINITY }
}
