//! Stress of a point from its displacement gradient: the St. Venant-Kirchhoff law in the plane.

use nalgebra::Matrix2;

use crate::bond_law::stencil::plane_stiffness;
use crate::material::Material;

/// Elastic constants of the plane state, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elasticity {
    c11: f64,
    c12: f64,
    shear: f64,
}

impl Elasticity {
    /// Constants of a material: plane stress `C₁₁ = E/(1-ν²)`, `C₁₂ = ν C₁₁`, or plane strain; `G = E/(2 (1+ν))`.
    pub fn of(material: &Material) -> Self {
        let [c11, c12] = plane_stiffness(material);
        Elasticity { c11, c12, shear: material.shear_modulus() }
    }

    /// Green strain `e = (H + Hᵀ + Hᵀ H)/2`, which a rotation leaves at zero.
    #[inline(always)]
    pub fn green_strain(gradient: &Matrix2<f64>) -> Matrix2<f64> {
        0.5 * (gradient + gradient.transpose() + gradient.transpose() * gradient)
    }

    /// Second Piola-Kirchhoff stress `S = C : e`, Pa.
    #[inline(always)]
    fn second(&self, e: &Matrix2<f64>) -> Matrix2<f64> {
        let shear = 2.0 * self.shear * e[(0, 1)];
        let along = self.c11 * e[(0, 0)] + self.c12 * e[(1, 1)];
        let across = self.c12 * e[(0, 0)] + self.c11 * e[(1, 1)];
        Matrix2::new(along, shear, shear, across)
    }

    /// First Piola-Kirchhoff stress `P = F S`, Pa, and energy density `S:e/2`, J/m³.
    #[inline(always)]
    pub fn first_piola_kirchhoff(&self, gradient: &Matrix2<f64>) -> (Matrix2<f64>, f64) {
        let e = Self::green_strain(gradient);
        let second = self.second(&e);
        ((Matrix2::identity() + gradient) * second, 0.5 * second.dot(&e))
    }

    /// Cauchy stress `F S Fᵀ / det F`, Pa.
    pub fn cauchy(&self, gradient: &Matrix2<f64>) -> Matrix2<f64> {
        let f = Matrix2::identity() + gradient;
        self.first_piola_kirchhoff(gradient).0 * f.transpose() / f.determinant()
    }

    /// Largest eigenvalue of C, Pa: `C₁₁ + C₁₂` in equal stretch, 2 G in shear.
    pub fn largest(&self) -> f64 {
        (self.c11 + self.c12).max(2.0 * self.shear)
    }
}

/// First principal stress, Pa.
#[inline(always)]
pub fn first_principal(stress: &Matrix2<f64>) -> f64 {
    let (mean, half) = (0.5 * (stress[(0, 0)] + stress[(1, 1)]), 0.5 * (stress[(0, 0)] - stress[(1, 1)]));
    let shear = 0.5 * (stress[(0, 1)] + stress[(1, 0)]);
    mean + half.hypot(shear)
}
