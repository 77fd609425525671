//! What is loaded and read round the rim of a hole in a plate of nodes: waves, and jumps where cracks begin.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use perilife_plate::williams::Elasticity;

/// Waves around a rim that are loaded and read: without cracks from it, and with, where nodes are finer ([`super::resolution`]). Where contact ends
/// near the mouth of a crack, 12, 24 and 36 leave K 0.5, 0.14 and 0.12 % off finite elements.
const HARMONICS: [i32; 2] = [4, 24];
/// Places around a rim where displacement is read and harmonics are loaded.
pub const PLACES: usize = 180;
/// Share of an orthogonal jump in a whole one below which there is no other: cracks that begin at one place jump as one.
const ANOTHER: f64 = 1e-3;

/// The course of a load round a rim; all those of a rim are orthogonal.
#[derive(Debug, Clone)]
pub enum Shape {
    /// e^(inθ), its real part or its imaginary one.
    Wave { waves: i32, is_sine: bool },
    /// Sum of jumps ([`jump`]) at angles, each by its weight, without waves up to a number.
    Jumps { jumps: Vec<[f64; 2]>, without: i32 },
}

/// What waves up to a number leave of a jump by 1 at x = 0 that is drawn out linearly round the rim: Σ sin nx / πn of all shorter waves.
fn jump(x: f64, without: i32) -> f64 {
    let waves: f64 = (1..=without).map(f64::from).map(|n| (n * x).sin() / n).sum();
    0.5 - x.rem_euclid(TAU) / TAU - waves / PI
}

/// ∫ of the product of two such jumps that are x apart: Σ cos nx / πn², all waves of which make a parabola.
fn jumps_product(x: f64, without: i32) -> f64 {
    let x = x.rem_euclid(TAU);
    let waves: f64 = (1..=without).map(f64::from).map(|n| (n * x).cos() / (n * n)).sum();
    (PI * PI / 6.0 - 0.5 * PI * x + 0.25 * x * x - waves) / PI
}

impl Shape {
    /// Its size at an angle.
    pub fn at(&self, angle: f64) -> f64 {
        match self {
            Shape::Wave { waves, is_sine: false } => (f64::from(*waves) * angle).cos(),
            Shape::Wave { waves, .. } => (f64::from(*waves) * angle).sin(),
            Shape::Jumps { jumps, without } => jumps.iter().map(|[weight, place]| weight * jump(angle - place, *without)).sum(),
        }
    }

    /// ∫ of its square.
    pub fn norm(&self) -> f64 {
        match self {
            Shape::Wave { waves: 0, .. } => TAU,
            Shape::Wave { .. } => 0.5 * TAU,
            Shape::Jumps { jumps, without } => product(jumps, jumps, *without),
        }
    }

    /// u_r and u_θ, m, of a plane with a hole of this radius: F_n e^(inθ) moves it by R/2G F_n/(n+1) and R/2G κ F₋ₙ/(n-1). Of what jumps
    /// there are shorter waves only, which are not kept.
    pub fn plane(&self, angle: f64, is_tangential: bool, radius: f64, plate: Elasticity) -> [f64; 2] {
        let Shape::Wave { waves, is_sine } = *self else { return [0.0; 2] };
        let n = f64::from(waves);
        let half = if is_sine { Complex::new(0.0, -0.5) } else { Complex::new(0.5, 0.0) };
        let turned = if is_tangential { Complex::i() } else { Complex::new(1.0, 0.0) };
        let (forth, back) = (half * turned * Complex::cis(n * angle), half.conj() * turned * Complex::cis(-n * angle));
        let moved = match waves {
            0 => turned,
            1 => 0.5 * forth,
            _ => forth / (n + 1.0) + back * (plate.kappa / (n - 1.0)),
        };
        let u = moved * (0.5 * radius / plate.shear_modulus);
        [u.re, u.im]
    }
}

/// ∫ of the product of two sums of jumps.
fn product(a: &[[f64; 2]], b: &[[f64; 2]], without: i32) -> f64 {
    a.iter().flat_map(|[w, x]| b.iter().map(move |[v, y]| w * v * jumps_product(x - y, without))).sum()
}

/// Places around a rim, evenly spaced, the first mouth of a crack between the last and the first of them.
#[derive(Debug, Clone)]
pub struct Places {
    mouths: Vec<f64>,
    /// Number of the place after every mouth.
    after: Vec<usize>,
}

impl Places {
    /// Those of a rim with mouths of cracks at angles, rad.
    pub fn new(mouths: Vec<f64>) -> Self {
        let mut places = Places { mouths, after: Vec::new() };
        places.after =
            places.mouths.iter().map(|mouth| (places.at(*mouth) + 0.5).rem_euclid(PLACES as f64) as usize % PLACES).collect();
        places
    }

    /// Where cracks begin, rad.
    pub fn mouths(&self) -> &[f64] {
        &self.mouths
    }

    /// Boundary before the first place, rad.
    fn first(&self) -> f64 {
        self.mouths.first().copied().unwrap_or(0.0)
    }

    /// An angle counted in places from that boundary.
    fn at(&self, angle: f64) -> f64 {
        (angle - self.first()) / TAU * PLACES as f64
    }

    fn angle(&self, place: usize) -> f64 {
        self.first() + TAU * (place as f64 + 0.5) / PLACES as f64
    }

    /// Of all places, rad.
    pub fn angles(&self) -> impl Iterator<Item = f64> {
        (0..PLACES).map(|place| self.angle(place))
    }

    fn waves(&self) -> i32 {
        HARMONICS[usize::from(!self.mouths.is_empty())]
    }

    /// Between the places, in a straight line; on from the last one before a mouth.
    pub fn between(&self, values: &[[f64; 2]], angle: f64) -> [f64; 2] {
        let at = (self.at(angle) - 0.5).rem_euclid(PLACES as f64);
        let (low, share) = (at as usize % PLACES, at.fract());
        let next = |place: usize, by: usize| (place + by) % PLACES;
        let (a, b, share) = match self.after.contains(&next(low, 1)) {
            false => (low, next(low, 1), share),
            true if share < 0.5 => (next(low, PLACES - 1), low, 1.0 + share),
            true => (next(low, 1), next(low, 2), share - 1.0),
        };
        [0, 1].map(|part| (1.0 - share) * values[a][part] + share * values[b][part])
    }

    /// What is read at the places, without shorter waves than are kept, but for jumps where cracks begin.
    pub fn smooth(&self, mut read: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        let mut jumps = vec![[0.0; 2]; PLACES];
        for &after in &self.after {
            let before = (after + PLACES - 1) % PLACES;
            let jump = [0, 1].map(|part| read[after][part] - read[before][part]);
            for (k, sum) in jumps.iter_mut().enumerate() {
                let way = ((k + PLACES - after) % PLACES) as f64 + 0.5;
                (0..2).for_each(|part| sum[part] += jump[part] * (0.5 - way / PLACES as f64));
            }
        }
        read.iter_mut().zip(&jumps).for_each(|(u, jump)| *u = [u[0] - jump[0], u[1] - jump[1]]);
        let mut kept = jumps;
        for waves in 0..=self.waves() {
            let size = if waves == 0 { 1.0 } else { 2.0 } / PLACES as f64;
            for shape in [f64::cos, f64::sin] {
                let wave: Vec<f64> = self.angles().map(|angle| shape(f64::from(waves) * angle)).collect();
                let sums = [0, 1].map(|part| read.iter().zip(&wave).map(|(u, wave)| wave * u[part]).sum::<f64>());
                kept.iter_mut().zip(&wave).for_each(|(u, wave)| (0..2).for_each(|part| u[part] += size * wave * sums[part]));
            }
        }
        kept
    }

    /// Waves, and jumps between the places where cracks begin.
    pub fn shapes(&self) -> Vec<Shape> {
        let without = self.waves();
        let waves = (0..=without).flat_map(|waves| {
            [false, true]
                .into_iter()
                .filter(move |is_sine| !is_sine || waves > 0)
                .map(move |is_sine| Shape::Wave { waves, is_sine })
        });
        let mut jumps: Vec<Vec<[f64; 2]>> = Vec::new();
        for &after in &self.after {
            let mut next = vec![[1.0, self.angle(after) - 0.5 * TAU / PLACES as f64]];
            for other in &jumps {
                let share = product(&next, other, without) / product(other, other, without);
                next.extend(other.iter().map(|[weight, place]| [-share * weight, *place]));
            }
            if product(&next, &next, without) > ANOTHER * jumps_product(0.0, without) {
                jumps.push(next);
            }
        }
        waves.chain(jumps.into_iter().map(|jumps| Shape::Jumps { jumps, without })).collect()
    }
}
