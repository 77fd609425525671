//! Contact of elastic pins with the rims of their holes, with Coulomb friction.
//!
//! Forces p (outwards, pressure) and q (along the rim, on the plate) on pieces of rim, F = p + i q, move plate against pin by
//! W = u_r + i u_θ. With z = e^(i(θ-φ)), Muskhelishvili's potentials of the plane with a hole and of the disc that is loaded at its middle
//! (Persson 1964, thesis, Chalmers; Ciavarella and Decuzzi 2001, Int. J. Solids Struct. 38:4507) give in sum
//! ```text
//! W = R { -(1/2π) ∫ e^-ix [A L + B L*] F dφ - (κ₂+1)/(4 G₂) Re F₀ - F₋₁* e^iθ / 2G₂ },   x = θ - φ,   L = ln|2 sin(x/2)| + i (x-π)/2
//! A = 1/2G₁ + κ₂/2G₂,   B = κ₁/2G₁ + 1/2G₂,   F_n = (1/2π) ∫ F e^-inφ dφ        (1 plate, 2 pin)
//! ```
//! to which what the plate is not, a plane with one hole, adds smooth terms ([`super::pins`]). Sought are p ≥ 0 with the gap g ≥ 0, p g = 0,
//! and |q| ≤ μ p, which is reached against the slip. Rigid motions of every pin, and its turn where there is friction, are unknowns beside
//! the condition that it bears the force of its load, none across it and no moment. Friction is that of one step from no load to the largest.

use nalgebra::{Complex, DMatrix, DVector};

use crate::error::{Error, Result};
use crate::specimen::pin::{Contact, Pin, RimForce};
use crate::williams::Elasticity;

/// Widths of a piece of rim, rad.
const WIDTHS: [f64; 2] = [1e-3, 0.035];
/// Pieces in half the arc of Hertz.
const IN_HALF_ARC: f64 = 20.0;
/// Where contact is sought, in half arcs of Hertz, and in rad at the most.
const SOUGHT: [f64; 2] = [2.5, 2.8];
/// Half arc, rad, in which it begins at the most.
const FIRST: f64 = 1.0;
/// Overlap, slip or excess of friction that is none, over the scale of each.
const ROUND_OFF: f64 = 1e-9;
/// Turns of the active set at the most.
const TURNS: usize = 200;
/// Gauss points and weights on 0..1.
const GAUSS: [(f64, f64); 3] = [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
/// Share of the contact whose friction may be left undecided.
const FLICKER: f64 = 0.05;
/// Turns without fewer wrong pieces before they are exchanged one by one.
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
    friction: f64,
    /// Force of the pin, N.
    force: f64,
    thickness: f64,
    pin: Elasticity,
    /// Half arc of contact of Hertz, rad.
    half_arc: f64,
}

impl PinRim {
    /// A pin under its force, N, in a hole of this radius, m; `pin_constants` in the plane state of the plate.
    pub fn new(pin: &Pin, pin_constants: Elasticity, plate: Elasticity, [radius, thickness, force]: [f64; 3]) -> Self {
        let clearance = radius - pin.radius;
        let compliance = 1.0 / plate.plane_modulus + 1.0 / pin_constants.plane_modulus;
        let curvature = clearance / (radius * pin.radius);
        // b = √(4 P' R / π E*), R of both (Johnson 1985, Contact mechanics, equation (4.43)).
        let half_arc = (4.0 * force / thickness * compliance / (std::f64::consts::PI * curvature)).sqrt() / radius;
        let width = (half_arc / IN_HALF_ARC).clamp(WIDTHS[0], WIDTHS[1]);
        let count = ((SOUGHT[0] * half_arc).clamp(4.0 * width, SOUGHT[1]) / width) as i32;
        let angles: Vec<f64> = (-count..=count).map(|k| f64::from(k) * width).collect();
        let gap = |angle: &f64| {
            let aside = clearance * angle.sin();
            let depth = (pin.radius * pin.radius - aside * aside).max(0.0).sqrt();
            clearance * (1.0 - angle.cos()) + aside * aside / (pin.radius + depth)
        };
        let gaps = angles.iter().map(gap).collect();
        PinRim { radius, width, angles, gaps, friction: pin.friction, force, thickness, pin: pin_constants, half_arc }
    }

    /// Whether it bears forces along the rim.
    pub fn has_friction(&self) -> bool {
        self.friction > 0.0
    }

    /// Area of a piece, m².
    fn area(&self) -> f64 {
        self.radius * self.width * self.thickness
    }

    /// Displacement of the plane with a hole against the disc, u_r and u_θ of every piece from p and q of every piece, m/Pa.
    fn plane(&self, plate: Elasticity) -> DMatrix<f64> {
        let [one, two] = [plate, self.pin].map(|body| 0.5 / body.shear_modulus);
        let (a, b) = (one + self.pin.kappa * two, plate.kappa * one + two);
        let (turn, n) = (std::f64::consts::TAU, self.angles.len());
        let cells: Vec<Complex<f64>> = (0..n).map(|k| cell(k as f64 * self.width, self.width, a, b)).collect();
        let mean = self.width / turn;
        let mut matrix = DMatrix::zeros(2 * n, 2 * n);
        for i in 0..n {
            for j in 0..n {
                let cell = if i >= j { cells[i - j] } else { cells[j - i].conj() };
                for (of, force) in [Complex::new(1.0, 0.0), Complex::i()].into_iter().enumerate() {
                    let middle = (force * Complex::cis(self.angles[j])).conj() * Complex::cis(self.angles[i]);
                    let even = 0.5 * (self.pin.kappa + 1.0) * two * mean * force.re;
                    let moved = -self.radius * (cell * force / turn + even + middle * two * mean);
                    (matrix[(2 * i, 2 * j + of)], matrix[(2 * i + 1, 2 * j + of)]) = (moved.re, moved.im);
                }
            }
        }
        matrix
    }
}

/// `∫ e^-iy [A L(y) + B L*(y)] dy` over a piece of rim of this width whose middle is x away.
fn cell(x: f64, width: f64, a: f64, b: f64) -> Complex<f64> {
    let half = 0.5 * width;
    // The logarithm of the piece itself is taken out: ∫ ln|y| dy = 2 α (ln α - 1), α half of the width.
    let own = x == 0.0;
    let value = |y: f64| {
        let log = (2.0 * (0.5 * y).sin()).abs().ln();
        let l = Complex::new(log, 0.5 * (y.rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI));
        Complex::cis(-y) * (a * l + b * l.conj()) - if own { (a + b) * y.abs().ln() } else { 0.0 }
    };
    let over = |from: f64, to: f64| -> Complex<f64> {
        GAUSS.iter().map(|&(at, weight)| value(from + (to - from) * at) * (weight * (to - from))).sum()
    };
    let smooth = over(x - half, x) + over(x, x + half);
    if own { smooth + 2.0 * half * (half.ln() - 1.0) * (a + b) } else { smooth }
}

/// A piece of rim in contact: what it does along the rim.
#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    Open,
    Sticks,
    /// q = ± μ p.
    Slips(f64),
}

/// Forces of pins.
pub struct Borne {
    /// Of every pin.
    pub contacts: Vec<Contact>,
    /// What they do, with the energy of the pins, as part of twice the complementary energy `Σ P δ + ∫ p g₀`, J: its change with a crack at
    /// constant load is the energy that growth releases, though contact changes.
    pub work: f64,
}

/// Brings pins into contact. `moved`: u_r and u_θ, m, of every piece of every rim without their forces; `finite`: what p and q of every
/// piece, Pa, add to them in the plate beyond a plane with a hole.
/// Errors: [`Error::Mechanics`] where no contact is found.
pub fn bear(rims: &[PinRim], plate: Elasticity, moved: &[f64], mut finite: DMatrix<f64>) -> Result<Borne> {
    let starts: Vec<usize> = rims.iter().scan(0, |next, rim| Some(std::mem::replace(next, *next + rim.angles.len()))).collect();
    for (rim, &start) in rims.iter().zip(&starts) {
        let size = 2 * rim.angles.len();
        let mut own = finite.view_mut((2 * start, 2 * start), (size, size));
        own += rim.plane(plate);
    }
    let mut search = Search { rims, starts, moved, compliance: finite, states: Vec::new(), scale: [0.0; 2] };
    let largest = rims.iter().map(|rim| rim.force / (rim.radius * rim.thickness)).fold(f64::MIN_POSITIVE, f64::max);
    search.scale = [largest, largest * rims[0].radius / plate.plane_modulus];
    let begins = |rim: &PinRim| rim.half_arc.min(FIRST).max(0.5 * rim.width);
    let first = |rim: &PinRim, angle: f64| if angle.abs() <= begins(rim) { State::Sticks } else { State::Open };
    search.states = rims.iter().flat_map(|rim| rim.angles.iter().map(|&angle| first(rim, angle)).collect::<Vec<_>>()).collect();
    let (mut fewest, mut chances) = (usize::MAX, CHANCES);
    for turn in 0..TURNS {
        let solved = search.solve()?;
        let mut wrong = search.wrong(&solved);
        let is_settled = turn + 1 == TURNS && search.flickers(&wrong);
        if wrong.is_empty() || is_settled {
            return Ok(search.borne(&solved));
        }
        // As contact of flanks does (Júdice and Pires 1994): all at once while fewer are wrong, else one, with friction not always the same.
        if wrong.len() < fewest {
            (fewest, chances) = (wrong.len(), CHANCES);
        } else if chances > 0 {
            chances -= 1;
        } else {
            wrong = vec![wrong[turn % wrong.len()]];
        }
        wrong.into_iter().for_each(|(piece, state)| search.states[piece] = state);
    }
    Err(no_contact())
}

fn no_contact() -> Error {
    Error::Mechanics(
        "the contact of a pin with its hole is not found; give its contact_half_angle_deg instead of its diameter".into(),
    )
}

struct Search<'a> {
    rims: &'a [PinRim],
    /// First piece of every rim.
    starts: Vec<usize>,
    moved: &'a [f64],
    compliance: DMatrix<f64>,
    states: Vec<State>,
    /// Pressure, Pa, and displacement, m, that count as 1.
    scale: [f64; 2],
}

/// Forces and displacements of every piece, scaled, and of every pin: its motion along and across its force, and its turn.
struct Solved {
    force: DVector<f64>,
    /// Gap and slip of the plate against the pin.
    between: DVector<f64>,
    rigid: Vec<[f64; 3]>,
}

impl Search<'_> {
    /// Rim of a piece, and its number there.
    fn place(&self, piece: usize) -> (usize, usize) {
        let rim = self.starts.partition_point(|start| *start <= piece) - 1;
        (rim, piece - self.starts[rim])
    }

    /// What a unit motion of its pin along and across its force, or a unit turn, takes off gap and slip of a piece.
    fn rigid(&self, piece: usize) -> [[f64; 3]; 2] {
        let (rim, own) = self.place(piece);
        let (sin, cos) = self.rims[rim].angles[own].sin_cos();
        [[cos, sin, 0.0], [-sin, cos, 1.0]]
    }

    /// Solves with the states that are assumed.
    fn solve(&self) -> Result<Solved> {
        let [pressure, length] = self.scale;
        let is_closed = |piece: &usize| self.states[*piece] != State::Open;
        let closed: Vec<usize> = (0..self.states.len()).filter(is_closed).collect();
        let has_friction = |piece: usize| self.rims[self.place(piece).0].has_friction();
        // Unknowns: components of forces by their row in the compliance, then the motions of the pins.
        let unknowns: Vec<usize> =
            closed.iter().map(|piece| 2 * piece).chain(closed.iter().filter(|p| has_friction(**p)).map(|p| 2 * p + 1)).collect();
        let motions: Vec<(usize, usize)> = self
            .rims
            .iter()
            .enumerate()
            .flat_map(|(rim, of)| (0..if of.has_friction() { 3 } else { 2 }).map(move |m| (rim, m)))
            .collect();
        let (n, all) = (unknowns.len(), unknowns.len() + motions.len());
        let (mut matrix, mut right) = (DMatrix::zeros(all, all), DVector::zeros(all));
        let normal_of = |piece: usize| closed.binary_search(&piece).unwrap_or(0);
        for (row, &unknown) in unknowns.iter().enumerate() {
            let (piece, part) = (unknown / 2, unknown % 2);
            let (rim, own) = self.place(piece);
            let rigid = self.rigid(piece)[part];
            for (column, &(of, motion)) in motions.iter().enumerate().filter(|(_, (of, _))| *of == rim) {
                // Forces along and across that of the pin, and its moment.
                matrix[(n + column, row)] = rigid[motion] * self.rims[of].area() / self.rims[of].radius.powi(2);
            }
            if let (State::Slips(sign), 1) = (self.states[piece], part) {
                matrix[(row, row)] = 1.0;
                matrix[(row, normal_of(piece))] = -sign * self.rims[rim].friction;
                continue;
            }
            unknowns
                .iter()
                .enumerate()
                .for_each(|(k, &of)| matrix[(row, k)] = self.compliance[(unknown, of)] * pressure / length);
            for (column, &(_, motion)) in motions.iter().enumerate().filter(|(_, (of, _))| *of == rim) {
                matrix[(row, n + column)] = -rigid[motion];
            }
            let gap = if part == 0 { self.rims[rim].gaps[own] } else { 0.0 };
            right[row] = -(gap + self.moved[unknown]) / length;
        }
        for (column, &(rim, motion)) in motions.iter().enumerate().filter(|(_, (_, motion))| *motion == 0) {
            right[n + column + motion] = self.rims[rim].force / pressure / self.rims[rim].radius.powi(2);
        }
        let x = matrix.lu().solve(&right).filter(|x| x.iter().all(|x| x.is_finite())).ok_or_else(no_contact)?;
        let mut force = DVector::zeros(2 * self.states.len());
        unknowns.iter().enumerate().for_each(|(k, &unknown)| force[unknown] = x[k]);
        let mut rigid = vec![[0.0; 3]; self.rims.len()];
        motions.iter().enumerate().for_each(|(k, &(rim, motion))| rigid[rim][motion] = x[n + k]);
        let mut between = &self.compliance * &force * (pressure / length);
        for piece in 0..self.states.len() {
            let (rim, own) = self.place(piece);
            for (part, of_rigid) in self.rigid(piece).iter().enumerate() {
                let gap = if part == 0 { self.rims[rim].gaps[own] } else { 0.0 };
                let taken: f64 = of_rigid.iter().zip(rigid[rim]).map(|(of, motion)| of * motion).sum();
                between[2 * piece + part] += (gap + self.moved[2 * piece + part]) / length - taken;
            }
        }
        Ok(Solved { force, between, rigid })
    }

    /// Pieces that cannot be as they are assumed, and how they are then.
    fn wrong(&self, solved: &Solved) -> Vec<(usize, State)> {
        let of_piece = |(piece, &state): (usize, &State)| {
            let [p, q] = [0, 1].map(|part| solved.force[2 * piece + part]);
            let [gap, slip] = [0, 1].map(|part| solved.between[2 * piece + part]);
            let friction = self.rims[self.place(piece).0].friction;
            let new = match state {
                State::Open if gap < -ROUND_OFF => State::Sticks,
                State::Open => State::Open,
                _ if p < 0.0 => State::Open,
                State::Sticks if friction > 0.0 && q.abs() > friction * p + ROUND_OFF => State::Slips(q.signum()),
                State::Slips(sign) if sign * slip > ROUND_OFF => State::Sticks,
                same => same,
            };
            (new != state).then_some((piece, new))
        };
        self.states.iter().enumerate().filter_map(of_piece).collect()
    }

    /// Whether what is wrong is no more than a few pieces that neither stick nor slip: with friction no states need be right.
    fn flickers(&self, wrong: &[(usize, State)]) -> bool {
        let closed = self.states.iter().filter(|state| **state != State::Open).count();
        let is_of_friction = |(piece, new): &(usize, State)| self.states[*piece] != State::Open && *new != State::Open;
        wrong.len() as f64 <= FLICKER * closed as f64 && wrong.iter().all(is_of_friction)
    }

    fn borne(&self, solved: &Solved) -> Borne {
        let [pressure, length] = self.scale;
        let mut work = 0.0;
        let mut contacts = Vec::with_capacity(self.rims.len());
        for (index, (rim, &start)) in self.rims.iter().zip(&self.starts).enumerate() {
            let of_piece = |own: usize| [0, 1].map(|part| solved.force[2 * (start + own) + part]);
            let closed: Vec<usize> = (0..rim.angles.len()).filter(|own| self.states[start + own] != State::Open).collect();
            let pieces = closed.iter().map(|&own| RimForce {
                angle: rim.angles[own],
                width: rim.width,
                share: of_piece(own).map(|traction| traction * pressure * rim.area() / rim.force),
            });
            work += rim.force * solved.rigid[index][0] * length;
            work += closed.iter().map(|&own| of_piece(own)[0] * pressure * rim.area() * rim.gaps[own]).sum::<f64>();
            // p² falls to nothing in a straight line, as in the contact of Hertz.
            let end = |last: Option<&usize>, before: Option<&usize>, sign: f64| {
                let [last, before] =
                    [last, before].map(|own| own.map_or([0.0; 2], |&own| [rim.angles[own], of_piece(own)[0].powi(2)]));
                let share = (last[1] / (before[1] - last[1]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                last[0] + sign * share * rim.width
            };
            let sticks = closed.iter().filter(|&&own| rim.has_friction() && self.states[start + own] == State::Sticks).count();
            contacts.push(Contact {
                ends: [end(closed.first(), closed.get(1), -1.0), end(closed.last(), closed.iter().rev().nth(1), 1.0)],
                pressure: closed.iter().map(|&own| of_piece(own)[0] * pressure).fold(0.0, f64::max),
                sticking: sticks as f64 / closed.len().max(1) as f64,
                pieces: pieces.collect(),
            });
        }
        Borne { contacts, work }
    }
}
