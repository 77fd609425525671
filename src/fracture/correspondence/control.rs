//! Control of zero-energy modes. F is blind to displacements that alternate from point to point, so that they cost nothing
//! unless something is added to the force state.
//!
//! * `spring` (Breitenfeld, Geubelle, Weckner and Silling 2014, CMAME 272:233):
//!   `T += c_I η/2`. The springs see uniform strain too and raise the modulus by `π c_I h δ⁴/8`, and they resist rotation.
//! * `silling` (after Silling 2017, CMAME 322:42): `T += c_z z/2` with the part of the relative displacement that F does not
//!   explain, `z = η - H ξ`. As `Σ w z ⊗ ξ V' = 0` by the choice of H, the force is the exact gradient of `Σ Σ c_z z² V V'/4`,
//!   uniform strain and rotation cost nothing, and angular momentum stays. `c_z = 18 H E/(π h δ⁴)`, N/m⁷, H the factor.

use std::f64::consts::PI;

use crate::error::{Result, input};
use crate::fracture::scene::ZeroEnergyControl;
use crate::levels::Net;
use crate::material::Material;

/// Factor H of `silling` where none is given. At 1 a double cantilever of ten points a arm is 14 % too stiff in bending, at 0.3 7 %.
pub const SILLING_FACTOR: f64 = 0.3;

/// Control with its constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Control {
    /// Nothing.
    None,
    /// c_I on η, N/m⁷.
    Relative(f64),
    /// c_z on η - H ξ, N/m⁷.
    Uneven(f64),
}

impl Control {
    /// Control of a body; the horizon is that of the net's first point (lattices have one).
    ///
    /// # Errors
    /// A factor below zero or not finite.
    pub fn new(kind: ZeroEnergyControl, factor: f64, material: &Material, thickness: f64, net: &Net) -> Result<Control> {
        if !(factor >= 0.0 && factor.is_finite()) {
            let remedy = "give a factor H of 0 or more for \"silling\", c_I in N/m^7 of 0 or more for \"spring\"";
            return Err(input("model.zero_energy_factor", factor, "would feed the zero-energy modes", remedy));
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
