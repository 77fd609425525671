//! Which bonds of a correspondence law break.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::bonds::BondState;
use crate::scene::{DamageLaw, Scene};
use perilife_base::error::{Result, input, input_missing};
use perilife_plate::material::{Material, Plane};
use perilife_points::net::Net;

/// Without time, bonds loaded as much as this share of the most loaded one break together with it; the others wait for the
/// next equilibrium, in which a crack beside them may have relieved them. Else all bonds of a broad field of nearly even stress,
/// like that of a disc, would break at once, the more the longer the load step.
const TOGETHER: f64 = 0.9995;

#[derive(Debug, Clone, PartialEq)]
enum Limit {
    Never,
    /// Mean first principal stress of both ends, Pa (Zhou, Wang and Qian 2016, Eur. J. Mech.
    /// A/Solids 60:277).
    Stress(f64),
    /// Stretch `(|ξ + η| - |ξ|)/|ξ|` (Silling and Askari 2005).
    Stretch(f64),
}

/// Limit, and how many bonds may pass it at once.
#[derive(Debug, Clone, PartialEq)]
pub struct Criterion {
    limit: Limit,
    /// Share of the largest load from which on bonds break together.
    together: f64,
}

impl Criterion {
    /// Criterion of a scene.
    /// Errors: a law that correspondence does not have; a missing strength or fracture energy.
    pub fn of(scene: &Scene, net: &Net, all_at_once: bool) -> Result<Criterion> {
        let limit = match scene.damage.law {
            DamageLaw::None => Limit::Never,
            DamageLaw::PrincipalStress => {
                let strength = scene.damage.tensile_strength.or(scene.material.tensile_strength);
                Limit::Stress(strength.ok_or_else(|| {
                    let problem = "is missing (required by damage.law = \"principal_stress\")";
                    input_missing("material.tensile_strength_mpa", problem, "give it, or damage.tensile_strength_mpa")
                })?)
            }
            DamageLaw::CriticalStretch => {
                let horizon = net.horizons.first().copied().unwrap_or(f64::INFINITY);
                let of_energy = |energy| critical_stretch(&scene.material, energy / scene.trapping(), horizon);
                let from_energy = || scene.material.fracture_energy.map(of_energy);
                Limit::Stretch(scene.damage.stretch.or_else(from_energy).ok_or_else(|| {
                    let problem = "is missing (required for the critical stretch)";
                    input_missing("material.fracture_energy_j_m2", problem, "give it, or damage.critical_stretch")
                })?)
            }
            law @ (DamageLaw::NonlinearTwoParameter | DamageLaw::CriticalEnergy) => {
                let problem = "requires a bond law with springs, not \"correspondence\"";
                let remedy = "use \"critical_stretch\", which uses the fracture energy too, \"principal_stress\" or \"none\"";
                return Err(input("damage.law", format!("\"{law}\""), problem, remedy));
            }
        };
        Ok(Criterion { limit, together: if all_at_once { 0.0 } else { TOGETHER } })
    }

    /// Breaks bonds beyond the limit; how many. `principal` is the first principal stress of a point, Pa.
    pub fn break_bonds(
        &self,
        net: &Net,
        u: &[f64],
        principal: impl Fn(usize) -> f64 + Send + Sync,
        bonds: &mut BondState,
    ) -> usize {
        let loads: Vec<f64> = match self.limit {
            Limit::Never => return 0,
            Limit::Stress(strength) => {
                let stresses: Vec<f64> = (0..net.len()).into_par_iter().with_min_len(256).map(principal).collect();
                let mean = |a: u32, b: u32| 0.5 * (stresses[a as usize] + stresses[b as usize]) / strength;
                net.bonds.par_iter().with_min_len(4096).map(|bond| mean(bond.from, bond.to)).collect()
            }
            Limit::Stretch(critical) => {
                let stretch = |bond: &perilife_points::net::NetBond| {
                    let (a, b) = (2 * bond.from as usize, 2 * bond.to as usize);
                    let y = [0, 1].map(|i| bond.length * bond.normal[i] + u[b + i] - u[a + i]);
                    (y[0].hypot(y[1]) / bond.length - 1.0) / critical
                };
                net.bonds.par_iter().with_min_len(4096).map(stretch).collect()
            }
        };
        let can = |b: usize| bonds.share[b] > 0.0 && bonds.may_fail[b];
        let largest = (0..loads.len()).filter(|&b| can(b)).map(|b| loads[b]).fold(0.0, f64::max);
        let least = (self.together * largest).max(1.0);
        let broken: Vec<usize> = (0..loads.len()).filter(|&b| can(b) && loads[b] >= least).collect();
        broken.iter().for_each(|&b| bonds.share[b] = 0.0);
        broken.len()
    }
}

/// Critical stretch of a fracture energy in the plane, `s_c = √(G_c / ([6 G/π + 16 (K - 2G)/(9 π²)] δ))` with the bulk modulus
/// of the plane state, `E/(2 (1-ν))` in plane stress and `E/(2 (1+ν)(1-2ν))` in plane strain (Madenci
/// and Oterkus 2014).
pub fn critical_stretch(material: &Material, fracture_energy: f64, horizon: f64) -> f64 {
    let (e, nu, shear) = (material.youngs_modulus, material.poisson_ratio, material.shear_modulus());
    let bulk = match material.plane {
        Plane::Stress => e / (2.0 * (1.0 - nu)),
        Plane::Strain => e / (2.0 * (1.0 + nu) * (1.0 - 2.0 * nu)),
    };
    (fracture_energy / ((6.0 * shear / PI + 16.0 * (bulk - 2.0 * shear) / (9.0 * PI * PI)) * horizon)).sqrt()
}
