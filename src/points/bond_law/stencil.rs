//! The bonds of one lattice point and the stiffness of their springs.
//!
//! On a square lattice every point has the same bonds, so a law is a short list: one entry per bond vector ξ
//! of the half plane (the other half belongs to the neighbours). A spring stiffness is the force per relative
//! displacement of the two points, N/m: `k_n = c_n(r) b V²`, `k_t = c_t(r) b V²` with micromodulus c, partial-volume
//! weight b and point volume V = Δ² h.
//!
//! A state-based law has normal springs that give the shear modulus G, and beside them the energy `½ κ θ²` of the dilatation
//! of each point: `W = ½ Σ k_n (n·η)² / 2V + ½ κ θ²`. Springs alone have `C₁₁ = 3 G`, `C₁₂ = G`, so `κ = C₁₂ - G`: zero at
//! the Poisson's ratio of a bond-based law, negative below. This is the linear peridynamic solid (Silling, Epton, Weckner,
//! Xu and Askari 2007, J. Elasticity 88:151, section 15) in the plane, its deviatoric part written out: there
//! `W = ½ k' θ² + ½ α Σ ω (e - θ r/2)²`, which is the same with `ω = k_n`.

use super::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_base::error::{Error, input};
use perilife_plate::material::{Material, Plane};

/// Allowed distance of ν from the one value a bond-based law has.
pub const BOND_BASED_POISSON_TOLERANCE: f64 = 0.01;

/// Excess over the limit of Poisson's ratio that is round-off.
const POISSON_ROUND_OFF: f64 = 1e-9;
/// Modulus of dilatation over shear modulus below which it is round-off.
const LEAST_DILATATION: f64 = 1e-9;

/// One bond of the half stencil.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StencilBond {
    /// Lattice steps along the row.
    pub dx: i32,
    /// Lattice rows, never negative; dx > 0 where it is zero.
    pub dy: i32,
    /// Bond length |ξ|, m.
    pub length: f64,
    /// Unit vector along the bond, in lattice axes.
    pub normal: [f64; 2],
    /// Normal spring, N/m.
    pub k_n: f64,
    /// Tangential spring, N/m.
    pub k_t: f64,
    /// Half length over spacing |ξ|/(2Δ): lever of a point's rotation θ = φ Δ on the bond's shear.
    pub lever: f64,
}

impl StencilBond {
    /// Unit vector across the bond (normal turned by +90°).
    pub fn tangent(&self) -> [f64; 2] {
        [-self.normal[1], self.normal[0]]
    }
}

/// All bonds that a point owns, with the constants of the law behind them.
#[derive(Debug, Clone, PartialEq)]
pub struct Stencil {
    /// Half stencil, sorted by row and column.
    pub bonds: Vec<StencilBond>,
    /// Lattice spacing Δ, m.
    pub spacing: f64,
    /// Horizon δ, m.
    pub horizon: f64,
    /// Farthest lattice step.
    pub reach: usize,
    /// Unknowns of a point: 2 displacements, and its rotation where the law leaves that free.
    pub unknowns: usize,
    /// Modulus of dilatation times point volume, κ V, J; zero for laws of springs alone.
    pub dilatation: f64,
    /// What the springs of other bond vectors follow from.
    field: SpringField,
}

/// Springs as a function of the bond vector: `k = c q(ξ)`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SpringField {
    law: BondLaw,
    /// (c_n, c_t) over weight.
    moduli: [f64; 2],
    /// Relative change of a weight over [`excess`] that makes the lattice isotropic.
    tilt: f64,
}

/// Elastic constants C11 and C12 of the plane state, Pa.
pub fn plane_stiffness(material: &Material) -> [f64; 2] {
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    match material.plane {
        Plane::Stress => [e / (1.0 - nu * nu), nu * e / (1.0 - nu * nu)],
        Plane::Strain => {
            let scale = e / ((1.0 + nu) * (1.0 - 2.0 * nu));
            [(1.0 - nu) * scale, nu * scale]
        }
    }
}

/// Largest Poisson's ratio of the two-parameter law: c_t ≥ 0 needs ν ≤ 1/3 (plane stress) or 1/4 (plane strain).
pub fn poisson_limit(plane: Plane) -> f64 {
    match plane {
        Plane::Stress => 1.0 / 3.0,
        Plane::Strain => 0.25,
    }
}

/// Whether springs with tangential stiffness c_t ≥ 0 reach the material's Poisson's ratio.
pub fn is_within_springs(material: &Material) -> bool {
    material.poisson_ratio <= poisson_limit(material.plane) + POISSON_ROUND_OFF
}

/// Refuses choices that do not go together, and a Poisson's ratio that the law cannot represent, naming the law to use.
///
/// Two-parameter: tangential modulus proportional to 1-3ν (plane stress) or 1-4ν (plane strain) must not be negative.
/// Bond-based: ν is 1/3 or 1/4 (Silling 2000; Gerstle, Sau and Silling 2005 for the plane). State-based: any.
/// Errors: `Error::Input` on `material.poisson_ratio`.
pub fn check(law: &BondLaw, material: &Material) -> Result<(), Error> {
    const KEY: &str = "material.poisson_ratio";
    let (kind, nu, limit) = (law.kind, material.poisson_ratio, poisson_limit(material.plane));
    let words = match material.plane {
        Plane::Stress => "1/3 in plane stress",
        Plane::Strain => "1/4 in plane strain",
    };
    let tolerance = if kind == BondLawKind::BondBased { BOND_BASED_POISSON_TOLERANCE } else { POISSON_ROUND_OFF };
    if kind == BondLawKind::StateBased {
        return Ok(());
    }
    if nu > limit + tolerance {
        let problem = format!("is out of range for {kind}: {words}");
        let remedy = format!(
            "use model.bond_law = \"state_based\", which supports any value; \"two_parameter\" supports up to {}",
            (limit * 1e4).floor() / 1e4
        );
        return Err(input(KEY, nu, problem, remedy));
    }
    if kind == BondLawKind::BondBased && nu < limit - tolerance {
        let problem = format!("is not the fixed value of bond_based, {words}");
        return Err(input(KEY, nu, problem, "use model.bond_law = \"two_parameter\", which supports any smaller value"));
    }
    Ok(())
}

/// Weight over the largest one of the stencil that is round-off.
const NO_STIFFNESS: f64 = 1e-9;

/// Partial-volume weight b(r): 1 inside δ - Δ/2, falling to 1/2 at δ, 0 beyond
/// (Madenci and Oterkus 2014, Peridynamic Theory and Its Applications, ch. 7).
pub fn partial_volume(length: f64, horizon: f64, spacing: f64) -> f64 {
    if length <= horizon - 0.5 * spacing {
        1.0
    } else if length <= horizon {
        (horizon + 0.5 * spacing - length) / spacing
    } else {
        0.0
    }
}

impl Stencil {
    /// Bonds and springs of a law at a spacing.
    ///
    /// Micromodulus profile over bond length r: `two_parameter` 1 or 1 - r/δ on the relative displacement η (Prakash and
    /// Seidel 2015); `bond_based` and `one_bond_two_parameter` the same divided by r (Silling 2000, Zhu and Ni 2017: force
    /// proportional to stretch and shear angle).
    ///
    /// With `surface_correction = none` or better than the classical one, c_n and c_t follow from the lattice sums
    /// `S₄ = Σ q r² n_x⁴`, `S₂₂ = Σ q r² n_x² n_y²`, so that uniform strain has exactly the energy of the continuum:
    /// `c_n (S₄ + S₂₂) = V (C₁₁ + C₁₂)`, `(c_n - c_t) S₂₂ = V C₁₂`. The weights q are first moved as little as possible
    /// (weighted least squares) to make the lattice isotropic, S₄ = 3 S₂₂, without which the stiffness would depend on
    /// the direction of the rows by some percent.
    pub fn new(law: &BondLaw, material: &Material, spacing: f64, horizon_ratio: f64, thickness: f64) -> Result<Self, Error> {
        check(law, material)?;
        let horizon = horizon_ratio * spacing;
        let mut shape = half_plane(horizon_ratio, spacing);
        let mut weight: Vec<f64> =
            shape.iter().map(|bond| profile(law, bond.length, horizon) * partial_volume(bond.length, horizon, spacing)).collect();
        // A bond exactly at the horizon has no conical micromodulus but for round-off. It would carry nothing, and yet age and
        // break, on one side of a symmetric crack before the other.
        let least = NO_STIFFNESS * weight.iter().fold(0.0, |a: f64, &b| a.max(b));
        let keep: Vec<bool> = weight.iter().map(|&w| w > least).collect();
        let mut kept = keep.iter();
        shape.retain(|_| *kept.next().unwrap_or(&false));
        weight.retain(|&w| w > least);
        let volume = spacing * spacing * thickness;
        let mut tilt = 0.0;
        let (c_n, c_t) = match law.surface_correction {
            SurfaceCorrection::VolumeAndSurface => integral_moduli(law, material, horizon, volume, thickness),
            SurfaceCorrection::None | SurfaceCorrection::Balanced => {
                tilt = make_isotropic(&shape, &mut weight);
                lattice_moduli(law, material, &shape, &weight, volume)
            }
        };
        let reach = shape.iter().map(|bond| bond.dx.unsigned_abs().max(bond.dy.unsigned_abs()) as usize).max().unwrap_or(1);
        let unknowns = if law.kind.is_two_parameter() && law.rotation == Rotation::Free { 3 } else { 2 };
        let dilatation = volume * dilatation_modulus(law, material);
        for (bond, q) in shape.iter_mut().zip(&weight) {
            bond.k_n = c_n * q;
            bond.k_t = c_t * q;
        }
        let field = SpringField { law: *law, moduli: [c_n, c_t], tilt };
        Ok(Stencil { bonds: shape, spacing, horizon, reach, unknowns, dilatation, field })
    }
}

impl Stencil {
    /// Normal and tangential spring of a bond to a cell of another width, N/m, as if both ends had the volume of this lattice's
    /// points; `normal` in lattice axes. Continues the stencil: its own bonds have these springs at `width = spacing`.
    pub fn spring(&self, length: f64, normal: [f64; 2], width: f64) -> [f64; 2] {
        let SpringField { law, moduli, tilt } = &self.field;
        let weight = profile(law, length, self.horizon).max(0.0) * partial_volume(length, self.horizon, width);
        moduli.map(|c| c * weight * (1.0 - tilt * excess(length, normal)).max(0.0))
    }

    /// Whether a rigid rotation costs energy: tangential springs between points that do not turn.
    pub fn resists_rotation(&self) -> bool {
        self.unknowns == 2 && self.bonds.iter().any(|bond| bond.k_t > 1e-9 * bond.k_n)
    }
}

/// Bond vectors of the half plane within the horizon, springs still zero.
fn half_plane(horizon_ratio: f64, spacing: f64) -> Vec<StencilBond> {
    let reach = horizon_ratio.floor() as i32;
    let mut bonds = Vec::new();
    for dy in 0..=reach {
        for dx in -reach..=reach {
            let steps = f64::from(dx * dx + dy * dy).sqrt();
            let owned = dy > 0 || dx > 0;
            if owned && steps <= horizon_ratio {
                bonds.push(StencilBond {
                    dx,
                    dy,
                    length: steps * spacing,
                    normal: [f64::from(dx) / steps, f64::from(dy) / steps],
                    k_n: 0.0,
                    k_t: 0.0,
                    lever: 0.5 * steps,
                });
            }
        }
    }
    bonds
}

fn profile(law: &BondLaw, length: f64, horizon: f64) -> f64 {
    let kernel = match law.kernel {
        Kernel::Constant => 1.0,
        Kernel::Conical => 1.0 - length / horizon,
    };
    if law.kind.is_stretch_form() { kernel / length } else { kernel }
}

/// Lattice sums S₄ and S₂₂ over the half stencil (each bond belongs to two points: the halves cancel).
fn moments(shape: &[StencilBond], weight: &[f64]) -> [f64; 2] {
    shape.iter().zip(weight).fold([0.0; 2], |[s4, s22], (bond, q)| {
        let [nx, ny] = bond.normal;
        let base = q * bond.length * bond.length;
        [s4 + base * nx.powi(4), s22 + base * nx * nx * ny * ny]
    })
}

/// Share of a bond in S₄ - 3 S₂₂ over its weight, averaged over x and y so that moved weights keep the symmetry of the square.
fn excess(length: f64, [nx, ny]: [f64; 2]) -> f64 {
    length * length * (0.5 * (nx.powi(4) + ny.powi(4)) - 3.0 * nx * nx * ny * ny)
}

/// Moves the weights by the smallest relative amounts that make S₄ = 3 S₂₂; returns the amount over [`excess`].
fn make_isotropic(shape: &[StencilBond], weight: &mut [f64]) -> f64 {
    let total: f64 = shape.iter().zip(weight.iter()).map(|(bond, q)| q * excess(bond.length, bond.normal)).sum();
    let square: f64 = shape.iter().zip(weight.iter()).map(|(bond, q)| q * excess(bond.length, bond.normal).powi(2)).sum();
    let tilt = if square > 0.0 { total / square } else { 0.0 };
    for (bond, q) in shape.iter().zip(weight.iter_mut()) {
        *q *= (1.0 - tilt * excess(bond.length, bond.normal)).max(0.0);
    }
    tilt
}

/// The material that the springs of a law stand for: all of it for a two-parameter law; with E and the law's own ν for a
/// bond-based one; with G and that ν for a state-based one, whose dilatation does the rest.
pub fn spring_material(law: &BondLaw, material: &Material) -> Material {
    let poisson_ratio = poisson_limit(material.plane);
    match law.kind {
        BondLawKind::TwoParameter | BondLawKind::OneBondTwoParameter => material.clone(),
        BondLawKind::BondBased => Material { poisson_ratio, ..material.clone() },
        BondLawKind::StateBased => {
            let youngs_modulus = 2.0 * material.shear_modulus() * (1.0 + poisson_ratio);
            Material { poisson_ratio, youngs_modulus, ..material.clone() }
        }
    }
}

/// Modulus of dilatation κ = C₁₂ - G of a state-based law, Pa; 0 for others, and where springs alone serve.
fn dilatation_modulus(law: &BondLaw, material: &Material) -> f64 {
    if law.kind != BondLawKind::StateBased {
        return 0.0;
    }
    let (shear, modulus) = (material.shear_modulus(), plane_stiffness(material)[1] - material.shear_modulus());
    if modulus.abs() < LEAST_DILATATION * shear { 0.0 } else { modulus }
}

/// (c_n, c_t) that give the lattice the elastic constants of the material; springs are c times weight.
fn lattice_moduli(law: &BondLaw, material: &Material, shape: &[StencilBond], weight: &[f64], volume: f64) -> (f64, f64) {
    let [s4, s22] = moments(shape, weight);
    let [c11, c12] = plane_stiffness(&spring_material(law, material));
    let c_n = volume * (c11 + c12) / (s4 + s22);
    let c_t = if law.kind.is_two_parameter() { (c_n - volume * c12 / s22).max(0.0) } else { 0.0 };
    (c_n, c_t)
}

/// (c_n, c_t) of the continuous kernel, times V² : the published moduli (Prakash and Seidel 2015 for the constant kernel,
/// their conical counterpart, Silling and Askari 2005 for bond-based, Zhu and Ni 2017 for one-bond two-parameter).
fn integral_moduli(law: &BondLaw, material: &Material, horizon: f64, volume: f64, thickness: f64) -> (f64, f64) {
    let [c11, c12] = plane_stiffness(&spring_material(law, material));
    // ∫ c(r) r² (1, n_x⁴, n_x² n_y²) over the disc: angular means 3/8 and 1/8 of 2π; radial moments of the profiles.
    let radial = match (law.kind.is_stretch_form(), law.kernel) {
        (false, Kernel::Constant) => horizon.powi(4) / 4.0,
        (false, Kernel::Conical) => horizon.powi(4) / 20.0,
        (true, Kernel::Constant) => horizon.powi(3) / 3.0,
        (true, Kernel::Conical) => horizon.powi(3) / 12.0,
    };
    // C11 = h/2 ∫ (c_n n_x⁴ + c_t n_x² n_y²) r² dA = h π/8 (3 c_n + c_t) radial, C12 = h π/8 (c_n - c_t) radial.
    let scale = thickness * std::f64::consts::PI / 8.0 * radial;
    let c_n = (c11 + c12) / (4.0 * scale);
    let c_t = if law.kind.is_two_parameter() { (c_n - c12 / scale).max(0.0) } else { 0.0 };
    (c_n * volume * volume, c_t * volume * volume)
}
