//! Loads beside the faces of a crack near one tip that open it or slide it, and nothing else.
//!
//! Opposite forces on both sides a short way behind the tip: across the crack they open it (K_II = 0), along it they slide
//! it (K_I = 0), as symmetry about the crack plane demands as long as nothing else is nearer to the tip. The points of a
//! lattice do not lie symmetric about a slanted crack; a load that is spread smoothly, with its centre at exactly the same
//! place on both sides, does not notice. Resultant and moment vanish, so that a floating plate stays in equilibrium.

use nalgebra::{Matrix3, Vector3};

use super::{CrackedPlate, TipFrame};
use crate::specimen::Point;

/// A point under load.
struct Loaded {
    place: usize,
    /// Frame coordinates in units of the reach, x₁ from the centre of the load.
    at: Point,
    /// +1 on the side x₂ > 0, -1 on the other.
    side: f64,
    /// Share of its side's force.
    share: f64,
}

/// Forces on points (lattice axes, sorted by place) that open the crack and that slide it, 1 N a side, centred `behind`
/// metres behind the tip and spread over `reach` metres along the crack to both sides and into the depth; `None` where a
/// side has too few points there.
#[must_use]
pub fn face_loads(plate: &CrackedPlate, frame: &TipFrame, behind: f64, reach: f64) -> Option<[Vec<(u32, Point)>; 2]> {
    let mut points: Vec<Loaded> = plate
        .points_around(frame, behind + 2.0 * reach)
        .filter_map(|place| {
            let position = plate.body.lattice.position(place);
            let [x, y] = frame.local(position);
            let at = [(x + behind) / reach, y / reach];
            let share = smooth(at[0]) * smooth(at[1]);
            (share > 0.0).then(|| Loaded { place, at, side: frame.side(position), share })
        })
        .collect();
    for side in [1.0, -1.0] {
        centre(&mut points, side)?;
    }
    let opening: Vec<Point> = points.iter().map(|p| [0.0, p.side * p.share]).collect();
    // The two sides pull past each other: a couple of forces across the crack, the same on both sides, takes that moment away.
    let moment: f64 = points.iter().map(|p| -p.at[1] * p.side * p.share).sum();
    let inertia: f64 = points.iter().map(|p| p.share * p.at[0].powi(2)).sum();
    let sliding: Vec<Point> = points.iter().map(|p| [p.side * p.share, -moment / inertia * p.share * p.at[0]]).collect();
    let to_axes = |forces: Vec<Point>| {
        let pairs = points.iter().zip(forces);
        let mut forces: Vec<(u32, Point)> =
            pairs.map(|(p, f)| (p.place as u32, plate.body.lattice.to_axes(frame.in_plate(f)))).collect();
        forces.sort_unstable_by_key(|force| force.0);
        forces
    };
    Some([to_axes(opening), to_axes(sliding)])
}

/// 1 at 0, 0 beyond ±1: `(1 - t²)²`.
fn smooth(t: f64) -> f64 {
    (1.0 - t * t).max(0.0).powi(2)
}

/// Depth of the centre of a spread load: `∫ t (1-t²)² / ∫ (1-t²)²` over 0..1.
const DEPTH: f64 = (1.0 / 6.0) / (8.0 / 15.0);

/// Multiplies the shares of one side by a linear function, so that their sum is 1 and their centre stands at x₁ = 0 and at
/// the depth of the smooth load.
fn centre(points: &mut [Loaded], side: f64) -> Option<()> {
    let mut moments = Matrix3::zeros();
    for p in points.iter().filter(|p| p.side == side) {
        let basis = Vector3::new(1.0, p.at[0], p.side * p.at[1]);
        moments += p.share * basis * basis.transpose();
    }
    let factors = moments.cholesky()?.solve(&Vector3::new(1.0, 0.0, DEPTH));
    for p in points.iter_mut().filter(|p| p.side == side) {
        p.share *= factors[0] + factors[1] * p.at[0] + factors[2] * p.side * p.at[1];
    }
    Some(())
}
