//! Stress of a point from its displacement gradient: the St. Venant-Kirchhoff law in the plane.
//!
//! Control of zero-energy modes: F is blind to displacements that alternate from point to point, so that they cost nothing
//! unless something is added to the force state.
//!
//! * `spring` (Breitenfeld, Geubelle, Weckner and Silling 2014, CMAME 272:233):
//!   `T += c_I η/2`. The springs see uniform strain too and raise the modulus by `π c_I h δ⁴/8`, and they resist rotation.
//! * `silling` (after Silling 2017, CMAME 322:42): `T += c_z z/2` with the part of the relative displacement that F does not
//!   explain, `z = η - H ξ`. As `Σ w z ⊗ ξ V' = 0` by the choice of H, the force is the exact gradient of `Σ Σ c_z z² V V'/4`,
//!   uniform strain and rotation cost nothing, and angular momentum stays. `c_z = 18 H E/(π h δ⁴)`, N/m⁷, H the factor.

use std::f64::consts::PI;

use nalgebra::Matrix2;

use crate::scene::ZeroEnergyControl;
use perilife_base::error::{Result, input};
use perilife_plate::material::Material;
use perilife_points::bond_law::stencil::plane_stiffness;
use perilife_points::net::Net;

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

/// Factor H of `silling` where none is given. At 1 a double cantilever of ten points a arm is 14 % too stiff in bending, at 0.3 7 %.
pub const SILLING_FACTOR: f64 = 0.3;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Control {
    None,
    /// c_I on η, N/m⁷.
    Relative(f64),
    /// c_z on η - H ξ, N/m⁷.
    Uneven(f64),
}

impl Control {
    /// Control of a body; the horizon is that of the net's first point (lattices have one).
    /// Errors: a factor below zero or not finite.
    pub fn new(kind: ZeroEnergyControl, factor: f64, material: &Material, thickness: f64, net: &Net) -> Result<Control> {
        if !(factor >= 0.0 && factor.is_finite()) {
            let remedy = "give a factor H of 0 or more for \"silling\", c_I in N/m^7 of 0 or more for \"spring\"";
            return Err(input("model.zero_energy_factor", factor, "would amplify zero-energy modes", remedy));
        }
        let horizon = net.horizons.first().copied().unwrap_or(f64::INFINITY);
        Ok(match kind {
            ZeroEnergyControl::None => Control::None,
            ZeroEnergyControl::Spring => Control::Relative(factor),
            ZeroEnergyControl::Silling => {
                Control::Uneven(18.0 * factor * material.youngs_modulus / (PI * thickness * horizon.powi(4)))
            }
        })
    }

    /// Constant on η, N/m⁷.
    pub fn on_relative(&self) -> f64 {
        if let Control::Relative(c) = self { *c } else { 0.0 }
    }

    /// Constant on η - H ξ, N/m⁷.
    pub fn on_uneven(&self) -> f64 {
        if let Control::Uneven(c) = self { *c } else { 0.0 }
    }
}
