//! When a bond is damaged: the limits that follow from strength and fracture energy, and what they do to a bond.

use super::scene::{DamageLaw, Scene, SceneLaw, Softening};
use perilife_base::error::{Result, input_missing};
use perilife_points::bond_law::BondLaw;
use perilife_points::bond_law::stencil::{Stencil, plane_stiffness, spring_material};
use perilife_points::net::Net;

/// A bond's measures at which laws look: stretch s and shear angle γ, and the ratio k_t / k_n of its springs.
///
/// Whether a bond is longer than it was is asked of its true length: in linear measures debris that has crossed to the other
/// side of a crack counts as compressed, and would hang on to it for ever.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    pub stretch: f64,
    /// True length over that at rest, squared, less 1: `|ξ + η|²/|ξ|² - 1`.
    pub elongation: f64,
    pub shear: f64,
    /// Tangential over normal spring.
    pub ratio: f64,
}

impl Measures {
    /// `s² + (k_t/k_n) γ²`: the energy of the whole bond over that of unit stretch.
    #[inline(always)]
    pub fn square(&self) -> f64 {
        self.stretch * self.stretch + self.ratio * self.shear * self.shear
    }
}

/// Law of damage with its limits.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// Bonds stay whole.
    Never,
    /// Broken at the critical stretch s_c of the owner, true length.
    Stretch(Vec<f64>),
    /// Broken at `s² + (k_t/k_n) γ² ≥ s_c²`, longer than at rest, with the critical stretch of the owner: on the stretch form with a constant
    /// kernel this is `(c_n s² + c_t γ²)/2 ≥ w_c0` (Huang, Li, Jin, He and Wang, equation 24, after Zhu and Ni 2017), in tension only;
    /// also where the true length is beyond s_c.
    Energy(Vec<f64>),
    Softening(Softening),
}

impl Failure {
    /// The law of a scene on the springs of its net; bonds of correspondence have one of their own.
    /// Errors: a missing fracture energy or missing constants.
    pub fn of(scene: &Scene, net: &Net) -> Result<Failure> {
        let SceneLaw::Bonds(law) = scene.model.law else { return Ok(Failure::Never) };
        let limits = || match (scene.damage.stretch, scene.material.fracture_energy) {
            (Some(stretch), _) => Ok(vec![stretch; net.len()]),
            (None, Some(energy)) => critical_stretches(scene, &law, net, energy / scene.trapping()),
            (None, None) => {
                let problem = "is missing (required for the critical stretch)";
                Err(input_missing("material.fracture_energy_j_m2", problem, "give it, or damage.critical_stretch"))
            }
        };
        match scene.damage.law {
            DamageLaw::None | DamageLaw::PrincipalStress => Ok(Failure::Never),
            DamageLaw::CriticalStretch => Ok(Failure::Stretch(limits()?)),
            DamageLaw::CriticalEnergy => Ok(Failure::Energy(limits()?)),
            DamageLaw::NonlinearTwoParameter => scene.damage.nonlinear.map(Failure::Softening).ok_or_else(|| {
                let remedy =
                    "give elastic_stretch, peak_stretch and final_stretch, or material.yield_strength_mpa and tensile_strength_mpa";
                input_missing("damage.elastic_stretch", "is missing: the nonlinear law has no limits", remedy)
            }),
        }
    }

    /// Share of its stiffness that a bond of an owner has at these measures, and its history; never more than before.
    #[inline(always)]
    pub fn share(&self, owner: u32, at: Measures, share: f64, peak: &mut f64) -> f64 {
        // Debris that moves past stores little energy in linear measures; a bond so long is none.
        if self.is_overlong(owner, at.elongation) {
            return 0.0;
        }
        match self {
            Failure::Never | Failure::Stretch(_) => share,
            Failure::Energy(limits) => {
                let is_beyond = at.elongation > 0.0 && at.square() >= limits[owner as usize].powi(2);
                if is_beyond { 0.0 } else { share }
            }
            Failure::Softening(law) => {
                if at.stretch <= *peak {
                    return share;
                }
                *peak = at.stretch;
                let next = law.share(at.stretch);
                // As printed the share rises again on its way to s_nt.
                if law.printed { next } else { next.min(share) }
            }
        }
    }

    /// Energy that gradual damage takes when the stretch grows from the largest before to the present one, over the energy of the
    /// whole bond at present: `∫ s² dD / s²` along the curve, whatever the size of the step, all strains of the bond having grown in
    /// proportion. `None` for laws without a curve, and off it.
    #[inline(always)]
    pub fn taken_along_curve(&self, at: Measures, after: f64, peak_before: f64) -> Option<f64> {
        match self {
            // What is torn by its true length alone has not followed the curve.
            Failure::Softening(law) if !law.printed && (after > 0.0 || at.stretch >= law.last) => {
                Some(law.square_sum([law.share(peak_before), after]) / (at.stretch * at.stretch))
            }
            _ => None,
        }
    }

    /// The measure that damage depends on, homogeneous in the displacement (linear in it, where [`Failure::share`] asks for the true
    /// length); 0 in compression.
    #[inline(always)]
    pub fn measure(&self, at: Measures) -> f64 {
        match self {
            Failure::Never => 0.0,
            Failure::Stretch(_) | Failure::Softening(_) => at.stretch.max(0.0),
            Failure::Energy(_) if at.stretch > 0.0 => at.square().sqrt(),
            Failure::Energy(_) => 0.0,
        }
    }

    /// Measure at which the damage of a bond with this share grows.
    #[inline(always)]
    pub fn onset(&self, owner: u32, share: f64) -> f64 {
        match self {
            Failure::Never => f64::INFINITY,
            Failure::Stretch(limits) | Failure::Energy(limits) => limits[owner as usize],
            Failure::Softening(law) => law.stretch_at(share),
        }
    }

    /// Whether a bond is torn by its true length alone: what slides along a bond of the other side stretches it in truth, but not
    /// in linear measures.
    #[inline(always)]
    pub fn is_overlong(&self, owner: u32, elongation: f64) -> bool {
        let last = match self {
            Failure::Never => return false,
            Failure::Stretch(limits) | Failure::Energy(limits) => limits[owner as usize],
            Failure::Softening(law) => law.last,
        };
        elongation >= last * (2.0 + last)
    }

    /// Share down to which bonds are damaged gradually; at this share they break.
    pub fn last_share(&self) -> f64 {
        match self {
            Failure::Softening(law) => law.share(law.last),
            _ => 1.0,
        }
    }
}

impl Softening {
    /// Share of the stiffness 1 - D at a stretch never reached before: `D = 0` up to s_et, `1 - exp(-(s - s_et)/s_nt)` up to s_t,
    /// 1 beyond (Li, Lü, Huang and Yang 2024, equation 19). With the continuous form the force is largest at s_nt. As printed, equations (20)
    /// and (21) multiply by D itself between s_et and s_nt, so that the force drops to zero just above s_et.
    pub fn share(&self, stretch: f64) -> f64 {
        if stretch <= self.elastic {
            1.0
        } else if stretch > self.last {
            0.0
        } else {
            let left = (-(stretch - self.elastic) / self.peak).exp();
            if self.printed && stretch <= self.peak { 1.0 - left } else { left }
        }
    }

    /// Stretch at which the continuous form has this share: `s = s_et - s_nt ln(1 - D)`, at the most s_t.
    #[inline(always)]
    pub fn stretch_at(&self, share: f64) -> f64 {
        (self.elastic - self.peak * share.ln()).min(self.last)
    }

    /// `∫ s² dD` along the continuous form between two shares: up to s_t it is the difference of
    /// `-(s² + 2 s s_nt + 2 s_nt²) exp(-(s - s_et)/s_nt)`, and the rest breaks at s_t.
    pub fn square_sum(&self, [before, after]: [f64; 2]) -> f64 {
        let last = self.share(self.last);
        let curve = |share: f64| {
            let (s, n) = (self.stretch_at(share), self.peak);
            -(s * s + 2.0 * s * n + 2.0 * n * n) * share
        };
        let gradual = curve(after.max(last)) - curve(before.max(last));
        gradual + (before.min(last) - after.min(last)) * self.last * self.last
    }
}

fn critical_stretches(scene: &Scene, law: &BondLaw, net: &Net, energy: f64) -> Result<Vec<f64>> {
    let (material, thickness) = (spring_material(law, &scene.material), scene.specimen.thickness);
    // Few levels, many points.
    let mut known: Vec<(f64, f64)> = Vec::new();
    let of_point = |&spacing: &f64| {
        if let Some((_, stretch)) = known.iter().find(|(of, _)| *of == spacing) {
            return Ok(*stretch);
        }
        let stencil = Stencil::new(law, &material, spacing, scene.model.horizon_ratio, thickness)?;
        let stretch = critical_stretch(&stencil, plane_stiffness(&material)[0], energy, thickness);
        known.push((spacing, stretch));
        Ok(stretch)
    };
    net.spacings.iter().map(of_point).collect()
}

/// Critical stretch of a fracture energy on a lattice, from the bonds that a crack between two rows cuts:
/// `G_c h Δ = ½ s_c² Σ |dy| k_n |ξ|²` over the half stencil. In the limit of many points it is `√(4 π G_c / (9 E δ))` for
/// the bond-based law in plane stress (Silling and Askari 2005 in the plane).
///
/// Springs with the classical corrections are those of the stencil times a factor of the body that makes uniaxial strain cost
/// what it should, `½ C₁₁ ε²`; the springs taken here are so too (`stiffness` = C₁₁ of the plane state, Pa). Without it a crack
/// would release a fifth too much.
pub fn critical_stretch(stencil: &Stencil, stiffness: f64, fracture_energy: f64, thickness: f64) -> f64 {
    let volume = stencil.spacing * stencil.spacing * thickness;
    let (mut cut, mut uniaxial) = (0.0, 0.0);
    for bond in &stencil.bonds {
        let ([n_x, n_y], square) = (bond.normal, bond.length * bond.length);
        cut += f64::from(bond.dy.abs()) * bond.k_n * square;
        // Mean of strain along the rows and across them.
        uniaxial += square * (0.5 * bond.k_n * (n_x.powi(4) + n_y.powi(4)) + bond.k_t * n_x * n_x * n_y * n_y) / volume;
    }
    (2.0 * fracture_energy * thickness * stencil.spacing * uniaxial / (cut * stiffness)).sqrt()
}
