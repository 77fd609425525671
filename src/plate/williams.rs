//! Eigenfunctions of a straight traction-free crack in an isotropic plane.
//!
//! Williams 1957 (J. Appl. Mech. 24:109): displacements `u = Σ_n r^(n/2) (a_n F_n(θ) + b_n G_n(θ)) / 2G`, n = 1 being the
//! singular term: `K_I = √(2π) a_1`, `K_II = -√(2π) b_1`. n = 0 and the second function of n = 2 are rigid motions, the first
//! of n = 2 is the T-stress; negative n describe what a disturbed core leaves outside it, n = -1 a shift of the tip.

use crate::material::{Material, Plane};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    Opening,
    Sliding,
}

/// Elastic constants as the near-tip fields take them, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elasticity {
    /// Kolosov's constant κ: (3-ν)/(1+ν) in plane stress, 3-4ν in plane strain.
    pub kappa: f64,
    pub shear_modulus: f64,
    /// E' of `G = K²/E'`.
    pub plane_modulus: f64,
    plane: Plane,
}

impl Elasticity {
    pub fn of(material: &Material) -> Self {
        let nu = material.poisson_ratio;
        let kappa = match material.plane {
            Plane::Stress => (3.0 - nu) / (1.0 + nu),
            Plane::Strain => 3.0 - 4.0 * nu,
        };
        let shear_modulus = material.shear_modulus();
        Elasticity { kappa, shear_modulus, plane_modulus: material.plane_modulus(), plane: material.plane }
    }

    /// Those of another material, E in Pa, in the same plane state.
    pub fn another(&self, youngs_modulus: f64, poisson_ratio: f64) -> Self {
        Elasticity::of(&Material::elastic(youngs_modulus, poisson_ratio, self.plane))
    }

    /// Stress of a displacement gradient `∂u_i/∂x_j`, as [xx, yy, xy], Pa: `σ = 2G (ε + (3-κ)/(2(κ-1)) tr ε)`.
    #[inline]
    pub fn stress(&self, gradient: &[[f64; 2]; 2]) -> [f64; 3] {
        let [[xx, xy], [yx, yy]] = *gradient;
        let two_g = 2.0 * self.shear_modulus;
        let pressure = (3.0 - self.kappa) / (2.0 * (self.kappa - 1.0)) * (xx + yy);
        [two_g * (xx + pressure), two_g * (yy + pressure), 0.5 * two_g * (xy + yx)]
    }

    /// `P_j q_,j` of the interaction integral, with `P_j = σ_ij u^aux_i,1 + σ^aux_ij u_i,1 - σ_ik ε^aux_ik δ_1j`, of two displacement
    /// gradients in the axes of a tip.
    #[inline]
    pub fn interaction(&self, field: &[[f64; 2]; 2], auxiliary: &[[f64; 2]; 2], q: [f64; 2]) -> f64 {
        let (stress, stress_aux) = (self.stress(field), self.stress(auxiliary));
        let flow = |s: [f64; 3], h: &[[f64; 2]; 2]| [s[0] * h[0][0] + s[2] * h[1][0], s[2] * h[0][0] + s[1] * h[1][0]];
        let (a, b) = (flow(stress, auxiliary), flow(stress_aux, field));
        (a[0] + b[0] - mutual_energy(&stress, auxiliary)) * q[0] + (a[1] + b[1]) * q[1]
    }

    /// `P_j m_j` on a face without traction, or with that of `field`: `σ^aux_ij m_j u_i,1 - σ_ik ε^aux_ik m_1`.
    #[inline]
    pub fn interaction_on_face(&self, field: &[[f64; 2]; 2], auxiliary: &[[f64; 2]; 2], [m1, m2]: [f64; 2]) -> f64 {
        let [xx, yy, xy] = self.stress(auxiliary);
        let traction = [xx * m1 + xy * m2, xy * m1 + yy * m2];
        traction[0] * field[0][0] + traction[1] * field[1][0] - mutual_energy(&self.stress(field), auxiliary) * m1
    }
}

/// `σ_ik ε^aux_ik`.
fn mutual_energy(stress: &[f64; 3], auxiliary: &[[f64; 2]; 2]) -> f64 {
    stress[0] * auxiliary[0][0] + stress[1] * auxiliary[1][1] + stress[2] * (auxiliary[0][1] + auxiliary[1][0])
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eigenfunction {
    /// Order n; displacement goes with r^(n/2).
    pub order: i32,
    pub symmetry: Symmetry,
}

impl Eigenfunction {
    /// 2G u at (r, θ) for coefficient 1, in the axes of the tip.
    #[inline]
    pub fn displacement(&self, kappa: f64, r: f64, theta: f64) -> [f64; 2] {
        PolarPoint::new(self.order, r, theta).displacement(self.symmetry, kappa)
    }

    /// 2G ∂u_i/∂x_j at (r, θ) for coefficient 1.
    #[inline]
    pub fn gradient(&self, kappa: f64, r: f64, theta: f64) -> [[f64; 2]; 2] {
        PolarPoint::new(self.order, r, theta).gradient(self.symmetry, kappa)
    }

    /// 2G u and 2G ∂u_i/∂x_j of both functions of an order, opening first, for which angles and powers are computed once.
    #[inline]
    pub fn both(order: i32, kappa: f64, r: f64, theta: f64) -> [([f64; 2], [[f64; 2]; 2]); 2] {
        let place = PolarPoint::new(order, r, theta);
        [Symmetry::Opening, Symmetry::Sliding]
            .map(|symmetry| (place.displacement(symmetry, kappa), place.gradient(symmetry, kappa)))
    }
}

/// A point as the functions of order n see it: powers of r, n/2, sine and cosine of θ, of n θ/2 and of (n/2 - 2) θ.
struct PolarPoint {
    /// r^(n/2) and r^(n/2 - 1).
    powers: [f64; 2],
    half: f64,
    /// (-1)^n.
    sign: f64,
    whole: (f64, f64),
    high: (f64, f64),
    low: (f64, f64),
}

impl PolarPoint {
    #[inline]
    fn new(order: i32, r: f64, theta: f64) -> Self {
        let half = 0.5 * f64::from(order);
        let sign = if order % 2 == 0 { 1.0 } else { -1.0 };
        PolarPoint {
            powers: [r.powf(half), r.powf(half - 1.0)],
            half,
            sign,
            whole: theta.sin_cos(),
            high: (half * theta).sin_cos(),
            low: ((half - 2.0) * theta).sin_cos(),
        }
    }

    #[inline]
    fn displacement(&self, symmetry: Symmetry, kappa: f64) -> [f64; 2] {
        let [u, v, ..] = self.angular(symmetry, kappa);
        let power = self.powers[0];
        [power * u, power * v]
    }

    #[inline]
    fn gradient(&self, symmetry: Symmetry, kappa: f64) -> [[f64; 2]; 2] {
        let half = self.half;
        let [u, v, du, dv] = self.angular(symmetry, kappa);
        let (sin, cos) = self.whole;
        let power = self.powers[1];
        // ∂/∂x₁ = cos θ ∂/∂r - sin θ/r ∂/∂θ, ∂/∂x₂ = sin θ ∂/∂r + cos θ/r ∂/∂θ.
        [(u, du), (v, dv)].map(|(f, df)| [power * (cos * half * f - sin * df), power * (sin * half * f + cos * df)])
    }

    /// Angular functions of both components and their derivatives over θ.
    #[inline]
    fn angular(&self, symmetry: Symmetry, kappa: f64) -> [f64; 4] {
        let PolarPoint { half: h, sign, high: (sin_h, cos_h), low: (sin_l, cos_l), .. } = *self;
        let (h_l, l) = (h * (h - 2.0), h);
        match symmetry {
            Symmetry::Opening => {
                let (a, b) = (kappa + h + sign, kappa - h - sign);
                [a * cos_h - l * cos_l, b * sin_h + l * sin_l, -a * h * sin_h + h_l * sin_l, b * h * cos_h + h_l * cos_l]
            }
            Symmetry::Sliding => {
                let (a, b) = (kappa + h - sign, kappa - h + sign);
                [-a * sin_h + l * sin_l, b * cos_h + l * cos_l, -a * h * cos_h + h_l * cos_l, -b * h * sin_h - h_l * sin_l]
            }
        }
    }
}

/// Coefficient of the n = 1 function over the factor it stands for: K_I = a₁ √(2π), K_II = -b₁ √(2π).
pub fn coefficient_of_unit_factor(symmetry: Symmetry) -> f64 {
    let size = 1.0 / (2.0 * std::f64::consts::PI).sqrt();
    match symmetry {
        Symmetry::Opening => size,
        Symmetry::Sliding => -size,
    }
}

/// `∂u_i/∂x_j` at (r, θ) of a force of 1 N/m along x₁ at the tip, whose stress is `σ_rr = -cos θ / (π r)` and nothing else.
///
/// In Kolosov's potentials `φ' = -1/(4π z)`, `ψ' = -φ'`: `2G (u_,1 + i v_,1) = κ φ' - conj(φ' + ψ' + conj(z) φ'')` and
/// `2G (u_,2 + i v_,2) = i [κ φ' - conj(φ' - ψ' - conj(z) φ'')]`.
#[inline]
pub fn force_gradient(elasticity: Elasticity, r: f64, theta: f64) -> [[f64; 2]; 2] {
    let Elasticity { kappa, shear_modulus, .. } = elasticity;
    let size = -1.0 / (8.0 * std::f64::consts::PI * shear_modulus * r);
    // φ' = e^(-iθ), conj(conj(z) φ'') = -e^(3iθ), in this size.
    let ([sin, cos], [sin_3, cos_3]) = ([theta.sin(), theta.cos()], [(3.0 * theta).sin(), (3.0 * theta).cos()]);
    let along = [kappa * cos + cos_3, -kappa * sin + sin_3];
    // The bracket of the derivative over x₂; i times it.
    let across = [kappa * cos - 2.0 * cos - cos_3, -kappa * sin - 2.0 * sin - sin_3];
    [[size * along[0], -size * across[1]], [size * along[1], size * across[0]]]
}
