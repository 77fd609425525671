//! Contact of elastic pins with the rims of their holes, without friction.
//!
//! A pressure p on pieces of rim moves plate against pin outwards by u. Muskhelishvili's potentials of the plane with a hole and of the disc
//! that is loaded at its middle (Persson 1964, thesis, Chalmers; Ciavarella and Decuzzi 2001, Int. J. Solids Struct. 38:4507) give in sum
//! ```text
//! u = Re R { -(1/2π) ∫ e^-ix [A L + B L*] p dφ - (κ₂+1)/(4 G₂) p₀ - p₋₁* e^iθ / 2G₂ },   x = θ - φ,   L = ln|2 sin(x/2)| + i (x-π)/2
//! A = 1/2G₁ + κ₂/2G₂,   B = κ₁/2G₁ + 1/2G₂,   p_n = (1/2π) ∫ p e^-inφ dφ        (1 plate, 2 pin)
//! ```
//! to which what the plate is not, a plane with one hole, adds smooth terms ([`super::pins`]). Sought are p ≥ 0 with the gap g ≥ 0, p g = 0.
//! Rigid motions of every pin are unknowns beside the condition that it bears the force of its load, and none across it. All this is a
//! quadratic program.

use std::f64::consts::{PI, TAU};

use nalgebra::{Complex, DMatrix, DVector};

use super::rim_waves::on_diagonal;
use perilife_base::error::{Error, Result};
use perilife_plate::specimen::pin::{Contact, Pin, RimForce};
use perilife_plate::williams::Elasticity;

/// Least width of a piece of rim, rad, and the largest without mouths of cracks and beside them, where pressure may rise to a corner.
const WIDTH_LEAST: f64 = 1e-3;
const WIDTHS_MOST: [f64; 2] = [0.035, 0.0175];
/// Pieces in half the arc of Hertz.
const IN_HALF_ARC: f64 = 20.0;
/// Where contact is sought, in half arcs of Hertz, and in rad at the most.
const SOUGHT: [f64; 2] = [2.5, 2.8];
/// Half arc, rad, in which it begins at the most.
const FIRST: f64 = 1.0;
/// Overlap or pull that is none, over the scale of each.
const ROUND_OFF: f64 = 1e-9;
/// Steps to the least energy at the most.
const TURNS: usize = 2000;
/// Gauss points and weights on 0..1.
const GAUSS: [(f64, f64); 3] = [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
/// Turns without fewer wrong pieces before they are not exchanged at once any more.
const CHANCES: usize = 5;

/// A pin and the pieces of rim that it may touch.
pub struct PinRim {
    /// Radius of the hole, m.
    pub radius: f64,
    /// Width of a piece over the radius.
    pub width: f64,
    /// Middles of the pieces from the direction of the force, rad.
    pub angles: Vec<f64>,
    /// Gaps before load, m, the pin touching at the angle 0.
    gaps: Vec<f64>,
    /// Force of the pin, N.
    force: f64,
    thickness: f64,
    pin: Elasticity,
    /// Half arc of contact of Hertz, rad.
    half_arc: f64,
}

impl PinRim {
    /// A pin under its force, N, in a hole of this radius, m, with mouths of cracks at angles from the direction of the force, rad;
    /// `pin_constants` in the plane state of the plate.
    pub fn new(
        pin: &Pin,
        pin_constants: Elasticity,
        plate: Elasticity,
        [radius, thickness, force]: [f64; 3],
        mouths: &[f64],
    ) -> Self {
        let clearance = radius - pin.radius;
        let compliance = 1.0 / plate.plane_modulus + 1.0 / pin_constants.plane_modulus;
        let curvature = clearance / (radius * pin.radius);
        // b = √(4 P' R / π E*), R of both (Johnson 1985, Contact mechanics, equation (4.43)).
        let half_arc = (4.0 * force / thickness * compliance / (PI * curvature)).sqrt() / radius;
        let width = (half_arc / IN_HALF_ARC).clamp(WIDTH_LEAST, WIDTHS_MOST[usize::from(!mouths.is_empty())]);
        let (width, first) = beside_mouths(width, mouths);
        let reach = (SOUGHT[0] * half_arc).clamp(4.0 * width, SOUGHT[1]);
        let [from, to] = [((-reach - first) / width).ceil() as i32, ((reach - first) / width).floor() as i32];
        let angles: Vec<f64> = (from..=to).map(|k| first + f64::from(k) * width).collect();
        let gap = |angle: &f64| {
            let aside = clearance * angle.sin();
            let depth = (pin.radius * pin.radius - aside * aside).max(0.0).sqrt();
            clearance * (1.0 - angle.cos()) + aside * aside / (pin.radius + depth)
        };
        let gaps = angles.iter().map(gap).collect();
        PinRim { radius, width, angles, gaps, force, thickness, pin: pin_constants, half_arc }
    }

    /// Area of a piece, m².
    pub fn area(&self) -> f64 {
        self.radius * self.width * self.thickness
    }

    /// Displacement of the plane with a hole against the disc, outwards, of every piece under the force of every piece, m/N.
    fn plane(&self, plate: Elasticity) -> DMatrix<f64> {
        let [one, two] = [plate, self.pin].map(|body| 0.5 / body.shear_modulus);
        let (a, b) = (one + self.pin.kappa * two, plate.kappa * one + two);
        let n = self.angles.len();
        let of_pin = |x: f64| (0.5 * (self.pin.kappa + 1.0) + x.cos()) * two * self.width;
        let moved = |x: f64| -(cell(x, self.width, a, b) + of_pin(x)) / (TAU * self.width * self.thickness);
        let by_steps: Vec<f64> = (0..n).map(|k| moved(k as f64 * self.width)).collect();
        DMatrix::from_fn(n, n, |i, j| by_steps[i.abs_diff(j)])
    }
}

/// Width of pieces of about this width, rad, and the middle of one of them, such that the first two mouths lie between pieces: what presses
/// on a piece presses on one flank of a crack.
fn beside_mouths(width: f64, mouths: &[f64]) -> (f64, f64) {
    let Some(&mouth) = mouths.first() else { return (width, 0.0) };
    let apart = mouths.get(1).map_or(0.0, |other| (other - mouth).abs());
    let width = if apart > width { apart / (apart / width).ceil() } else { width };
    (width, mouth + 0.5 * width)
}

/// Re `∫ e^-iy [A L(y) + B L*(y)] dy` over a piece of rim of this width whose middle is x away.
fn cell(x: f64, width: f64, a: f64, b: f64) -> f64 {
    let half = 0.5 * width;
    // The logarithm of the piece itself is taken out: ∫ ln|y| dy = 2 α (ln α - 1), α half of the width.
    let own = x == 0.0;
    let value = |y: f64| {
        let log = (2.0 * (0.5 * y).sin()).abs().ln();
        let l = Complex::new(log, 0.5 * (y.rem_euclid(TAU) - PI));
        (Complex::cis(-y) * (a * l + b * l.conj())).re - if own { (a + b) * y.abs().ln() } else { 0.0 }
    };
    let over = |from: f64, to: f64| -> f64 {
        GAUSS.iter().map(|&(at, weight)| value(from + (to - from) * at) * (weight * (to - from))).sum()
    };
    let smooth = over(x - half, x) + over(x, x + half);
    if own { smooth + 2.0 * half * (half.ln() - 1.0) * (a + b) } else { smooth }
}

/// Seeks the forces F ≥ 0 on pieces that make `½ F·C F + F·(g₀ + u)` least and bear those of the pins: then gaps, its gradient, are 0 where
/// F is above 0, and push it there elsewhere. Forces are over the largest of the pins, lengths over what it squeezes.
pub struct Search {
    pub rims: Vec<PinRim>,
    /// Rim of every piece, and its number there.
    places: Vec<(usize, usize)>,
    compliance: DMatrix<f64>,
    /// What unit motions of every pin along and across its force take off the gaps.
    motions: DMatrix<f64>,
    asked: DVector<f64>,
    /// Force, N, and length, m, that count as 1.
    pub scale: [f64; 2],
}

/// Forces and gaps of every piece, and motions of every pin.
pub struct Solved {
    /// Over that of the scale.
    pub force: DVector<f64>,
    gap: DVector<f64>,
    rigid: DVector<f64>,
}

impl Search {
    /// Pins whose forces move pieces by `compliance`, m/N, beyond what a plane with their holes does.
    pub fn new(rims: Vec<PinRim>, mut compliance: DMatrix<f64>, plate: Elasticity) -> Self {
        let places: Vec<(usize, usize)> =
            rims.iter().enumerate().flat_map(|(rim, of)| (0..of.angles.len()).map(move |own| (rim, own))).collect();
        let largest = rims.iter().map(|rim| rim.force).fold(f64::MIN_POSITIVE, f64::max);
        let scale = [largest, largest / (rims[0].thickness * plate.plane_modulus)];
        compliance += on_diagonal(rims.iter().map(|rim| rim.plane(plate)));
        let motions = DMatrix::from_fn(places.len(), 2 * rims.len(), |piece, motion| {
            let (rim, own) = places[piece];
            let (sin, cos) = rims[rim].angles[own].sin_cos();
            if motion / 2 == rim { [cos, sin][motion % 2] } else { 0.0 }
        });
        let asked = DVector::from_fn(2 * rims.len(), |motion, _| [rims[motion / 2].force / largest, 0.0][motion % 2]);
        Search { rims, places, compliance: compliance * (scale[0] / scale[1]), motions, asked, scale }
    }

    /// Solves with gaps g₀ + u and the pieces that are assumed to be closed; `None` where they hold no pin.
    fn solve(&self, before: &DVector<f64>, closed: &[bool]) -> Option<Solved> {
        let pressed: Vec<usize> = (0..closed.len()).filter(|piece| closed[*piece]).collect();
        let (n, all) = (pressed.len(), pressed.len() + self.asked.len());
        let matrix = DMatrix::from_fn(all, all, |row, column| match (pressed.get(row), pressed.get(column)) {
            (Some(&i), Some(&j)) => self.compliance[(i, j)],
            (Some(&i), None) => -self.motions[(i, column - n)],
            (None, Some(&j)) => self.motions[(j, row - n)],
            (None, None) => 0.0,
        });
        let right = DVector::from_fn(all, |row, _| pressed.get(row).map_or_else(|| self.asked[row - n], |&i| -before[i]));
        let x = matrix.lu().solve(&right).filter(|x| x.iter().all(|x| x.is_finite()))?;
        let mut force = DVector::zeros(closed.len());
        pressed.iter().zip(x.iter()).for_each(|(&piece, x)| force[piece] = *x);
        let rigid = x.rows(n, all - n).into_owned();
        let gap = before + &self.compliance * &force - &self.motions * &rigid;
        Some(Solved { force, gap, rigid })
    }

    /// Contact where the rims have moved by `moved`, m, without forces of the pins.
    /// Errors: [`Error::Mechanics`] where none is found.
    pub fn settle(&self, moved: &DVector<f64>) -> Result<Solved> {
        let before = DVector::from_fn(moved.len(), |piece, _| {
            let (rim, own) = self.places[piece];
            (self.rims[rim].gaps[own] + moved[piece]) / self.scale[1]
        });
        let begins = |&(rim, own): &(usize, usize)| {
            let rim = &self.rims[rim];
            rim.angles[own].abs() <= rim.half_arc.min(FIRST).max(1.5 * rim.width)
        };
        let mut closed: Vec<bool> = self.places.iter().map(begins).collect();
        let (mut fewest, mut chances) = (usize::MAX, CHANCES);
        while let Some(solved) = self.solve(&before, &closed).filter(|_| chances > 0) {
            let is_wrong = |&piece: &usize| if closed[piece] { solved.force[piece] } else { solved.gap[piece] } < -ROUND_OFF;
            let wrong: Vec<usize> = (0..closed.len()).filter(is_wrong).collect();
            if wrong.is_empty() {
                return Ok(solved);
            }
            // All at once while that makes fewer wrong, as with contact of flanks (Júdice and Pires 1994).
            (fewest, chances) = if wrong.len() < fewest { (wrong.len(), CHANCES) } else { (fewest, chances - 1) };
            wrong.into_iter().for_each(|piece| closed[piece] = !closed[piece]);
        }
        let problem = "pin contact did not converge; give the contact half angle instead of the diameter";
        self.descend(&before).ok_or_else(|| Error::Mechanics(problem.to_owned()))
    }

    /// The same from all of the force of a pin on the two pieces at its middle, which is no contact, but bears it: goes towards what solves
    /// with the pieces that are closed up to the first that opens, or all the way, and closes the one that overlaps most. The energy
    /// falls with every step.
    fn descend(&self, before: &DVector<f64>) -> Option<Solved> {
        let (mut force, mut closed) = (DVector::zeros(self.places.len()), vec![false; self.places.len()]);
        let mut start = 0;
        for (rim, asked) in self.rims.iter().zip(self.asked.iter().step_by(2)) {
            let right = rim.angles.partition_point(|angle| *angle <= 0.0).clamp(1, rim.angles.len() - 1);
            let [a, b] = [rim.angles[right - 1], rim.angles[right]];
            for (piece, share) in [(right - 1, b.sin()), (right, -a.sin())] {
                (force[start + piece], closed[start + piece]) = (asked * share / (b - a).sin(), true);
            }
            start += rim.angles.len();
        }
        for _ in 0..TURNS {
            let solved = self.solve(before, &closed)?;
            let way = &solved.force - &force;
            let opens = (0..closed.len()).filter(|&piece| closed[piece] && solved.force[piece] < -ROUND_OFF);
            let shares = opens.map(|piece| (piece, (-force[piece] / way[piece]).max(0.0)));
            if let Some((piece, share)) = shares.min_by(|a, b| a.1.total_cmp(&b.1)) {
                force.axpy(share, &way, 1.0);
                (force[piece], closed[piece]) = (0.0, false);
                continue;
            }
            force.copy_from(&solved.force);
            let piece = solved.gap.imin();
            if solved.gap[piece] >= -ROUND_OFF || closed[piece] {
                return Some(solved);
            }
            closed[piece] = true;
        }
        None
    }

    /// Pressure on pieces of every pin, Pa, by their numbers.
    pub fn pressed(&self, solved: &Solved) -> Vec<Vec<(usize, f64)>> {
        let mut pressed = vec![Vec::new(); self.rims.len()];
        for (&(rim, own), force) in self.places.iter().zip(solved.force.iter()).filter(|(_, force)| **force > 0.0) {
            pressed[rim].push((own, force * self.scale[0] / self.rims[rim].area()));
        }
        pressed
    }

    /// What pins do, with their energy, as part of twice the complementary energy `Σ P δ + ∫ p g₀`, J: its change with a crack at constant load
    /// is the energy that growth releases, though contact changes.
    pub fn work(&self, solved: &Solved) -> f64 {
        let gap = |&(rim, own): &(usize, usize)| self.rims[rim].gaps[own] / self.scale[1];
        let of_gaps: f64 = self.places.iter().zip(solved.force.iter()).map(|(place, force)| force * gap(place)).sum();
        (self.asked.dot(&solved.rigid) + of_gaps) * self.scale[0] * self.scale[1]
    }

    /// Share of the force of every pin that another contact bears elsewhere.
    pub fn shifted(&self, solved: &Solved, other: &Solved) -> Vec<f64> {
        let mut shares = vec![0.0; self.rims.len()];
        for (piece, (rim, _)) in self.places.iter().enumerate() {
            shares[*rim] += 0.5 * (other.force[piece] - solved.force[piece]).abs() / self.asked[2 * rim];
        }
        shares
    }

    /// Contact of a pin with pressure on its pieces.
    pub fn contact(&self, rim: usize, pressed: &[(usize, f64)]) -> Contact {
        let rim = &self.rims[rim];
        let share = |pressure: f64| pressure * rim.area() / rim.force;
        let piece = |&(own, p): &(usize, f64)| RimForce { angle: rim.angles[own], width: rim.width, share: share(p) };
        // p² falls to nothing in a straight line, as in the contact of Hertz.
        let end = |last: Option<&(usize, f64)>, before: Option<&(usize, f64)>, sign: f64| {
            let [p, q] = [last, before].map(|piece| piece.map_or(0.0, |piece| piece.1.powi(2)));
            let share = (p / (q - p).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            last.map_or(0.0, |last| rim.angles[last.0]) + sign * share * rim.width
        };
        Contact {
            ends: [end(pressed.first(), pressed.get(1), -1.0), end(pressed.last(), pressed.iter().rev().nth(1), 1.0)],
            pressure: pressed.iter().map(|piece| piece.1).fold(0.0, f64::max),
            residual: 0.0,
            pieces: pressed.iter().map(piece).collect(),
        }
    }
}
