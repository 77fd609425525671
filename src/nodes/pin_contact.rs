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
//! With the limits of q given, all this is a quadratic program; the limits follow the pressure in rounds (Panagiotopoulos 1975, Ing.-Arch. 44:421).

use nalgebra::{Complex, DMatrix, DVector};

use perilife_base::error::{Error, Result};
use perilife_plate::specimen::pin::{Contact, Pin, RimForce};
use perilife_plate::williams::Elasticity;

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
/// Steps to the least energy at the most.
const TURNS: usize = 2000;
/// Rounds in which limits of friction follow the pressure at the most, and their change that is none.
const ROUNDS: usize = 60;
const SETTLED: f64 = 1e-6;
/// Gauss points and weights on 0..1.
const GAUSS: [(f64, f64); 3] = [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
/// Moment of friction that is none, over its forces.
const BALANCED: f64 = 1e-12;
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
    friction: f64,
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
        let half_arc = (4.0 * force / thickness * compliance / (std::f64::consts::PI * curvature)).sqrt() / radius;
        let width = (half_arc / IN_HALF_ARC).clamp(WIDTHS[0], WIDTHS[1]);
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
        PinRim { radius, width, angles, gaps, friction: pin.friction, force, thickness, pin: pin_constants, half_arc }
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

/// Width of pieces of about this width, rad, and the middle of one of them, such that the first two mouths lie between pieces: what presses
/// on a piece presses on one flank of a crack.
fn beside_mouths(width: f64, mouths: &[f64]) -> (f64, f64) {
    let Some(&mouth) = mouths.first() else { return (width, 0.0) };
    let apart = mouths.get(1).map_or(0.0, |other| (other - mouth).abs());
    let width = if apart > width { apart / (apart / width).ceil() } else { width };
    (width, mouth + 0.5 * width)
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

/// Where a component of the force on a piece stands.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Lower,
    Free,
    Upper,
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
    let largest = rims.iter().map(|rim| rim.force / (rim.radius * rim.thickness)).fold(f64::MIN_POSITIVE, f64::max);
    let scale = [largest, largest * rims[0].radius / plate.plane_modulus];
    let pieces = || rims.iter().flat_map(|rim| rim.angles.iter().map(move |angle| (rim, *angle)));
    let begins = |(rim, angle): (&PinRim, f64)| angle.abs() <= rim.half_arc.min(FIRST).max(1.5 * rim.width);
    let places = pieces().flat_map(|piece| [if begins(piece) { Place::Free } else { Place::Lower }, Place::Lower]).collect();
    let bounds = pieces().flat_map(|_| [[0.0, f64::INFINITY], [0.0; 2]]).collect();
    let friction: Vec<f64> = pieces().map(|(rim, _)| rim.friction).collect();
    let mut search = Search { rims, starts, moved, compliance: finite, places, bounds, scale };
    // All of the force of a pin on the two pieces at its middle is no contact, but bears it.
    let mut force = DVector::zeros(moved.len());
    for (rim, &start) in rims.iter().zip(&search.starts) {
        let right = rim.angles.partition_point(|angle| *angle <= 0.0).clamp(1, rim.angles.len() - 1);
        let [a, b] = [rim.angles[right - 1], rim.angles[right]];
        let unit = rim.force / (rim.area() * largest * (b - a).sin());
        (force[2 * (start + right - 1)], force[2 * (start + right)]) = (unit * b.sin(), -unit * a.sin());
    }
    let mut solved = search.settle(force)?;
    if friction.iter().all(|friction| *friction == 0.0) {
        return Ok(search.borne(&solved));
    }
    for _ in 0..ROUNDS {
        let limits = friction.iter().enumerate().map(|(piece, friction)| friction * solved.force[2 * piece].max(0.0));
        let limits: Vec<f64> = limits.collect();
        let change = limits.iter().enumerate().map(|(piece, limit)| (limit - search.bounds[2 * piece + 1][1]).abs());
        if change.fold(0.0, f64::max) < SETTLED * limits.iter().fold(0.0, |largest: f64, limit| largest.max(*limit)) {
            return Ok(search.borne(&solved));
        }
        search.limit(&limits);
        solved = search.settle(solved.force)?;
    }
    Err(no_contact())
}

fn no_contact() -> Error {
    Error::Mechanics(
        "the contact of a pin with its hole is not found; give the half angle over which it bears instead of its diameter".into(),
    )
}

/// Seeks the forces F on pieces that make `½ F·C F + F·(g₀ + u)` least within their bounds and bear those of the pins: then gaps and slips, its
/// gradient, are 0 where F is within its bounds, and push it against them elsewhere.
struct Search<'a> {
    rims: &'a [PinRim],
    /// First piece of every rim.
    starts: Vec<usize>,
    moved: &'a [f64],
    compliance: DMatrix<f64>,
    /// Of every component of every piece.
    places: Vec<Place>,
    /// Least and largest, scaled.
    bounds: Vec<[f64; 2]>,
    /// Pressure, Pa, and displacement, m, that count as 1.
    scale: [f64; 2],
}

/// Forces and displacements of every piece, scaled, and of every pin: its motion along and across its force, and its turn.
struct Solved {
    force: DVector<f64>,
    /// Gap and slip of the plate against the pin.
    between: DVector<f64>,
    rigid: Vec<[f64; 3]>,
    /// Components at a bound that are to leave it whatever their gradient is: without them a pin bears a moment.
    freed: Vec<usize>,
}

impl Search<'_> {
    /// Rim of a piece, and its number there.
    fn place(&self, piece: usize) -> (usize, usize) {
        let rim = self.starts.partition_point(|start| *start <= piece) - 1;
        (rim, piece - self.starts[rim])
    }

    /// What a unit motion of its pin along and across its force, or a unit turn, takes off gap or slip of a piece.
    fn rigid(&self, component: usize) -> (usize, [f64; 3]) {
        let (rim, own) = self.place(component / 2);
        let (sin, cos) = self.rims[rim].angles[own].sin_cos();
        (rim, if component.is_multiple_of(2) { [cos, sin, 0.0] } else { [-sin, cos, 1.0] })
    }

    /// Gap or slip without forces on pieces, scaled.
    fn before(&self, component: usize) -> f64 {
        let (rim, own) = self.place(component / 2);
        let gap = if component.is_multiple_of(2) { self.rims[rim].gaps[own] } else { 0.0 };
        (gap + self.moved[component]) / self.scale[1]
    }

    /// Takes other limits of friction; what had none sticks.
    fn limit(&mut self, limits: &[f64]) {
        for (piece, &limit) in limits.iter().enumerate() {
            let component = 2 * piece + 1;
            let had_none = self.bounds[component][1] == 0.0;
            self.bounds[component] = [-limit, limit];
            self.places[component] = match self.places[component] {
                _ if limit == 0.0 => Place::Lower,
                _ if had_none => Place::Free,
                same => same,
            };
        }
    }

    /// Force of a component at a bound.
    fn at_bound(&self, component: usize) -> f64 {
        match self.places[component] {
            Place::Lower => self.bounds[component][0],
            Place::Free => 0.0,
            Place::Upper => self.bounds[component][1],
        }
    }

    /// Solves with the places that are assumed.
    fn solve(&self) -> Result<Solved> {
        let [pressure, length] = self.scale;
        let mut force = DVector::from_fn(self.places.len(), |component, _| self.at_bound(component));
        let free: Vec<usize> = (0..self.places.len()).filter(|component| self.places[*component] == Place::Free).collect();
        let unit = pressure / length;
        let mut between = &self.compliance * &force * unit;
        (0..self.places.len()).for_each(|component| between[component] += self.before(component));
        // A pin that nothing holds along its rim is not turned.
        let holds = |rim: usize| free.iter().any(|component| component % 2 == 1 && self.place(component / 2).0 == rim);
        let motions: Vec<(usize, usize)> =
            (0..self.rims.len()).flat_map(|rim| (0..if holds(rim) { 3 } else { 2 }).map(move |motion| (rim, motion))).collect();
        let (n, all) = (free.len(), free.len() + motions.len());
        let (mut matrix, mut right) = (DMatrix::zeros(all, all), DVector::zeros(all));
        for (row, &component) in free.iter().enumerate() {
            free.iter().enumerate().for_each(|(column, &of)| matrix[(row, column)] = self.compliance[(component, of)] * unit);
            right[row] = -between[component];
        }
        // Forces along and across those of the pins, and their moments.
        for (column, &(rim, motion)) in motions.iter().enumerate() {
            let area = self.rims[rim].area() / self.rims[rim].radius.powi(2);
            let of =
                |component: usize| Some(self.rigid(component)).filter(|(of, _)| *of == rim).map_or(0.0, |(_, by)| by[motion]);
            for (row, &component) in free.iter().enumerate() {
                (matrix[(row, n + column)], matrix[(n + column, row)]) = (-of(component), of(component) * area);
            }
            let asked = if motion == 0 { self.rims[rim].force / pressure / self.rims[rim].radius.powi(2) } else { 0.0 };
            let borne: f64 = force.iter().enumerate().filter(|(_, size)| **size != 0.0).map(|(c, size)| size * of(c)).sum();
            right[n + column] = asked - borne * area;
        }
        let x = matrix.lu().solve(&right).filter(|x| x.iter().all(|x| x.is_finite())).ok_or_else(no_contact)?;
        free.iter().enumerate().for_each(|(k, &component)| {
            force[component] = x[k];
            between.axpy(x[k] * unit, &self.compliance.column(component), 1.0);
        });
        let mut rigid = vec![[0.0; 3]; self.rims.len()];
        motions.iter().enumerate().for_each(|(k, &(rim, motion))| rigid[rim][motion] = x[n + k]);
        let mut freed = Vec::new();
        for rim in (0..self.rims.len()).filter(|rim| !holds(*rim)) {
            let (turn, component) = self.turned(rim, &force, &between);
            rigid[rim][2] = turn;
            freed.extend(component);
        }
        for component in 0..self.places.len() {
            let (rim, by) = self.rigid(component);
            between[component] -= by.iter().zip(rigid[rim]).map(|(by, motion)| by * motion).sum::<f64>();
        }
        Ok(Solved { force, between, rigid, freed })
    }

    /// The turn of a pin that slips at all of its rim, with `between` that of no turn: where limits of friction bear no moment it lies between
    /// the slips of both directions, or amid those that exclude each other. A moment goes with the slip of the component that, once it is
    /// free, bears it at the least energy.
    fn turned(&self, rim: usize, force: &DVector<f64>, between: &DVector<f64>) -> (f64, Option<usize>) {
        let slips = (self.starts[rim]..self.starts[rim] + self.rims[rim].angles.len()).map(|piece| 2 * piece + 1);
        let slips: Vec<usize> = slips.filter(|&component| self.bounds[component][1] > 0.0).collect();
        let [moment, size] = slips.iter().fold([0.0; 2], |[sum, size], &slip| [sum + force[slip], size + force[slip].abs()]);
        let at = |place: Place| slips.iter().copied().filter(move |&slip| self.places[slip] == place);
        let least = at(Place::Lower).min_by(|a, b| between[*a].total_cmp(&between[*b]));
        let largest = at(Place::Upper).max_by(|a, b| between[*a].total_cmp(&between[*b]));
        let freed = if moment < 0.0 { least } else { largest }.filter(|_| moment.abs() > BALANCED * size);
        let bounds: Vec<f64> = [least, largest].into_iter().flatten().map(|slip| between[slip]).collect();
        let middle = bounds.iter().sum::<f64>() / bounds.len().max(1) as f64;
        (freed.map_or(middle, |slip| between[slip]), freed)
    }

    /// Components that cannot be where they are assumed, with the place that they take then.
    fn wrong(&self, solved: &Solved) -> Vec<(usize, Place)> {
        let of_component = |(component, &place): (usize, &Place)| {
            let (force, gradient, [lower, upper]) = (solved.force[component], solved.between[component], self.bounds[component]);
            let new = match place {
                Place::Free if force < lower - ROUND_OFF => Place::Lower,
                Place::Free if force > upper + ROUND_OFF => Place::Upper,
                Place::Lower | Place::Upper if solved.freed.contains(&component) => Place::Free,
                Place::Lower if gradient < -ROUND_OFF && upper > lower => Place::Free,
                Place::Upper if gradient > ROUND_OFF => Place::Free,
                same => same,
            };
            (new != place).then_some((component, new))
        };
        self.places.iter().enumerate().filter_map(of_component).collect()
    }

    /// Finds the places; `force` bears those of the pins.
    fn settle(&mut self, force: DVector<f64>) -> Result<Solved> {
        let (mut fewest, mut chances) = (usize::MAX, CHANCES);
        while chances > 0 {
            let solved = self.solve()?;
            let wrong = self.wrong(&solved);
            if wrong.is_empty() {
                return Ok(solved);
            }
            // All at once while that makes fewer wrong, as with contact of flanks (Júdice and Pires 1994).
            (fewest, chances) = if wrong.len() < fewest { (wrong.len(), CHANCES) } else { (fewest, chances - 1) };
            wrong.into_iter().for_each(|(component, place)| self.places[component] = place);
        }
        self.descend(force)
    }

    /// The same from a force within its bounds: goes towards what solves with the places as they are up to the first bound, which is one
    /// place more at a bound, or all the way, and then lets go what its gradient pulls off. The energy falls with every step.
    fn descend(&mut self, mut force: DVector<f64>) -> Result<Solved> {
        for (component, place) in self.places.iter_mut().enumerate() {
            let [lower, upper] = self.bounds[component];
            force[component] = force[component].clamp(lower, upper);
            *place = match (lower < upper, *place) {
                (true, Place::Free) => Place::Free,
                (true, _) if force[component] > lower && force[component] < upper => Place::Free,
                (true, _) if force[component] >= upper => Place::Upper,
                _ => Place::Lower,
            };
        }
        let mut moved = f64::INFINITY;
        for _ in 0..TURNS {
            let solved = self.solve()?;
            let way = &solved.force - &force;
            if let Some((share, component, place)) = self.first_bound(&force, &way) {
                force.axpy(share, &way, 1.0);
                moved += share * way.amax();
                self.places[component] = place;
                continue;
            }
            moved += way.amax();
            force.copy_from(&solved.force);
            let mut wrong = self.wrong(&solved);
            if wrong.is_empty() {
                return Ok(solved);
            }
            if moved < ROUND_OFF {
                wrong = self.first_to_go(&solved, wrong);
            }
            moved = 0.0;
            wrong.into_iter().for_each(|(component, place)| self.places[component] = place);
        }
        Err(no_contact())
    }

    /// Of components that together are no way down: the one that bears a moment, or else pulls most. Where all of its pin slips, one slip alone
    /// would bear a moment: the one that pulls most the other way goes too.
    fn first_to_go(&self, solved: &Solved, mut wrong: Vec<(usize, Place)>) -> Vec<(usize, Place)> {
        let pull = |component: usize| (solved.freed.contains(&component), solved.between[component].abs());
        wrong.sort_by(|(a, _), (b, _)| pull(*b).partial_cmp(&pull(*a)).unwrap_or(std::cmp::Ordering::Equal));
        let (first, rim) = (wrong[0].0, self.place(wrong[0].0 / 2).0);
        let slips = |component: usize| !component.is_multiple_of(2) && self.place(component / 2).0 == rim;
        let all_slip = slips(first) && (0..self.places.len()).all(|other| !slips(other) || self.places[other] != Place::Free);
        let other = wrong.iter().copied().find(|&(other, _)| slips(other) && self.places[other] != self.places[first]);
        wrong.truncate(1);
        wrong.extend(other.filter(|_| all_slip && solved.freed.is_empty()));
        wrong
    }

    /// The bound that is met first on a way, after which share of it, and by which component.
    fn first_bound(&self, force: &DVector<f64>, way: &DVector<f64>) -> Option<(f64, usize, Place)> {
        let meets = |(component, place): (usize, &Place)| {
            let ([lower, upper], from, way) = (self.bounds[component], force[component], way[component]);
            let (bound, at) = if way < 0.0 { (lower, Place::Lower) } else { (upper, Place::Upper) };
            let share = (bound - from) / way;
            (*place == Place::Free && way != 0.0 && share < 1.0).then_some((share.max(0.0), component, at))
        };
        self.places.iter().enumerate().filter_map(meets).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    fn borne(&self, solved: &Solved) -> Borne {
        let [pressure, length] = self.scale;
        let mut work = 0.0;
        let mut contacts = Vec::with_capacity(self.rims.len());
        for (index, (rim, &start)) in self.rims.iter().zip(&self.starts).enumerate() {
            let of_piece = |own: usize| [0, 1].map(|part| solved.force[2 * (start + own) + part]);
            let closed: Vec<usize> = (0..rim.angles.len()).filter(|&own| of_piece(own)[0] > 0.0).collect();
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
            let sticks = closed.iter().filter(|&&own| self.places[2 * (start + own) + 1] == Place::Free).count();
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
