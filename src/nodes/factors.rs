//! K_I, K_II and T of a tip: interaction integral over a ring of its own points.
//!
//! As `stress_intensity::ring` of `points`, with gradients straight from the shape functions: eight radii by four times eight angles, counted
//! from face to face, so that a crack that bends divides no point from its side. Faces that leave the line straight behind the tip, and those
//! that tractions act on, give the second integral.

use super::cells::EIGHT;
use super::crack::TipAxes;
use super::dilatation::split;
use super::field::{Discretisation, Local};
use perilife_base::error::{Error, Result};
use perilife_base::units::place_mm;
use perilife_plate::loading::residual::{Components, across};
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::{along, circle_shares, direction, distance};
use perilife_plate::williams::{Eigenfunction, Elasticity, Symmetry, coefficient_of_unit_factor, force_gradient};

/// Outer radius at the most, in spacings of the tip.
const RADIUS_SPACINGS: f64 = 5.0;
/// Radii between which the weight q falls from 1 to 0, over the outer radius.
const RING: [f64; 2] = [0.4, 0.9];
/// Panels of radii and of angles; where dilatation is that of cells, whose edges make stress jump, those of the second pair: with the first K of a
/// lug scatters by 0.4 % at ν = 0.499.
const PANELS: [[usize; 2]; 2] = [[1, 4], [2, 12]];
/// Distance from a crack at which its face is read, in spacings.
const BESIDE: f64 = 1e-5;
/// Distance from a face at which the auxiliary fields are taken, over that from the tip.
const ON_FACE: f64 = 1e-7;
/// Angle from the line behind a tip below which a face is straight, as sine.
const STRAIGHT: f64 = 1e-9;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipFactors {
    /// K_I and K_II, Pa√m.
    pub factors: [f64; 2],
    /// Stress along the crack T, Pa.
    pub t_stress: f64,
    /// Outer radius of the ring, m.
    pub radius: f64,
    /// What the faces of the crack add to K_I, Pa√m.
    pub of_faces: f64,
}

/// Gradient of a displacement in the axes of the tip.
type Gradient = [[f64; 2]; 2];

/// Reads a tip of a plate with the unknowns `u` in a ring within `room`, m; on the faces acts the traction `-σ m` of a `stress` σ at a place
/// of the crack, Pa: p·I of a pressure p.
/// Errors: [`Error::Mechanics`] where nodes in reach do not span the basis.
pub fn read(
    plate: &Discretisation,
    u: &[f64],
    tip: usize,
    room: f64,
    stress: &dyn Fn(Point) -> Components,
) -> Result<TipFactors> {
    let axes = &plate.axes[tip];
    let mut local = Local::default();
    let field = |at: Point| {
        plate
            .displacement(u, at, &mut local)
            .map(|(_, gradient)| axes.gradient_to_axes(gradient))
            .ok_or_else(|| Error::Mechanics(format!("no displacement at {}: too few nodes within reach", place_mm(at))))
    };
    let radius = room.min(RADIUS_SPACINGS * axes.spacing);
    integral(axes, plate.elasticity(), radius, stress, field)
}

/// The integral over a ring of this outer radius, m, around a tip, of a displacement with the gradient `field` at a point.
pub fn integral(
    axes: &TipAxes,
    elasticity: Elasticity,
    radius: f64,
    stress: &dyn Fn(Point) -> Components,
    mut field: impl FnMut(Point) -> Result<Gradient>,
) -> Result<TipFactors> {
    let [inner, outer] = RING.map(|share| share * radius);
    let mut sums = [0.0; 3];
    let [radial, angular] = PANELS[usize::from(split(elasticity).1[1] > 0.0)];
    for (share, of_radius) in
        (0..radial).flat_map(|k| EIGHT.map(|(share, of)| ((k as f64 + share) / radial as f64, of / radial as f64)))
    {
        let r = inner + share * (outer - inner);
        let slope = -6.0 * share * (1.0 - share) / (outer - inner);
        let face = face_angle(axes, r);
        let panel = std::f64::consts::TAU / angular as f64;
        for k in 0..angular {
            for (share, of_angle) in EIGHT {
                let theta = face - std::f64::consts::TAU + (k as f64 + share) * panel;
                let (sin, cos) = theta.sin_cos();
                let [x, y] = axes.from_axes([r * cos, r * sin]);
                let gradient = field([axes.at[0] + x, axes.at[1] + y])?;
                let area = of_radius * (outer - inner) * of_angle * panel * r;
                for (sum, auxiliary) in sums.iter_mut().zip(auxiliaries(elasticity, r, theta)) {
                    *sum += area * elasticity.interaction(&gradient, &auxiliary, [slope * cos, slope * sin]);
                }
            }
        }
    }
    let of_faces = faces(axes, elasticity, [inner, outer], stress, &mut field)?;
    sums.iter_mut().zip(of_faces).for_each(|(sum, of_faces)| *sum += of_faces);
    let half = 0.5 * elasticity.plane_modulus;
    let normal = axes.from_axes([0.0, 1.0]);
    let [tx, ty] = across(stress(axes.at), normal);
    Ok(TipFactors {
        factors: [half * sums[0], half * sums[1]],
        t_stress: elasticity.plane_modulus * sums[2] - (tx * normal[0] + ty * normal[1]),
        radius,
        of_faces: half * of_faces[0],
    })
}

/// Angle of the crack at a distance from its tip, rad, from 0 to 2π.
fn face_angle(axes: &TipAxes, r: f64) -> f64 {
    for piece in axes.back.windows(2) {
        let (near, far) = (distance(axes.at, piece[0]), distance(axes.at, piece[1]));
        if let Some([_, leaves]) = circle_shares(piece[0], piece[1], axes.at, r).filter(|_| near <= r && far >= r) {
            let at = along(piece[0], piece[1], leaves);
            let [x, y] = axes.to_axes([at[0] - axes.at[0], at[1] - axes.at[1]]);
            return y.atan2(x).rem_euclid(std::f64::consts::TAU);
        }
    }
    std::f64::consts::PI
}

/// Auxiliary gradients: of unit K_I, of unit K_II, of a unit force at the tip.
fn auxiliaries(elasticity: Elasticity, r: f64, theta: f64) -> [Gradient; 3] {
    let [opening, sliding] = [Symmetry::Opening, Symmetry::Sliding].map(|symmetry| {
        let scale = coefficient_of_unit_factor(symmetry) / (2.0 * elasticity.shear_modulus);
        Eigenfunction { order: 1, symmetry }.gradient(elasticity.kappa, r, theta).map(|row| row.map(|g| scale * g))
    });
    [opening, sliding, force_gradient(elasticity, r, theta)]
}

/// `-∫ P_j m_j q ds` over both faces of the crack within the ring.
fn faces(
    axes: &TipAxes,
    elasticity: Elasticity,
    [inner, outer]: [f64; 2],
    stress: &dyn Fn(Point) -> Components,
    field: &mut impl FnMut(Point) -> Result<Gradient>,
) -> Result<[f64; 3]> {
    let mut sums = [0.0; 3];
    for (index, piece) in axes.back.windows(2).enumerate() {
        let [x, y] = axes.to_axes(direction(piece[0], piece[1]));
        let is_straight = index == 0
            || (y.abs() < STRAIGHT
                && axes.to_axes([piece[0][0] - axes.at[0], piece[0][1] - axes.at[1]])[1].abs() < STRAIGHT * axes.spacing);
        if distance(axes.at, piece[0]) >= outer {
            continue;
        }
        let length = distance(piece[0], piece[1]).min(2.0 * outer);
        let count = (length / axes.spacing).ceil().max(1.0) as usize;
        for k in 0..count {
            for (share, weight) in EIGHT {
                // Towards the tip points lie by the square, for 1/√r.
                let share = (k as f64 + share) / count as f64;
                let (way, stretch) =
                    if index == 0 { (length * share * share, 2.0 * length * share) } else { (length * share, length) };
                let ds = weight * stretch / count as f64;
                let at = along(piece[0], piece[1], way / distance(piece[0], piece[1]));
                let stress = stress(at);
                if is_straight && stress == [0.0; 3] {
                    continue;
                }
                for normal in [[y, -x], [-y, x]] {
                    // The material lies against the outward normal.
                    let inward = axes.from_axes([-normal[0], -normal[1]]);
                    let step = BESIDE * axes.spacing;
                    let beside = [at[0] + step * inward[0], at[1] + step * inward[1]];
                    // By far nearer to the face than to the tip: the field of a force goes with 1/r.
                    let close = ON_FACE * distance(axes.at, at);
                    let (r, theta) = axes.polar([at[0] + close * inward[0], at[1] + close * inward[1]]);
                    let t = ((r - inner) / (outer - inner)).clamp(0.0, 1.0);
                    let q = 1.0 - t * t * (3.0 - 2.0 * t);
                    if q == 0.0 {
                        continue;
                    }
                    let traction = axes.to_axes(across(stress, inward));
                    let gradient = if is_straight { None } else { Some(field(beside)?) };
                    for (sum, auxiliary) in sums.iter_mut().zip(auxiliaries(elasticity, r, theta)) {
                        let mut flow = traction[0] * auxiliary[0][0] + traction[1] * auxiliary[1][0];
                        if let Some(gradient) = &gradient {
                            flow += elasticity.interaction_on_face(gradient, &auxiliary, normal);
                        }
                        *sum -= flow * q * ds;
                    }
                }
            }
        }
    }
    Ok(sums)
}
