//! What is loaded and read round the rim of a hole in a plate of nodes: waves, and beside the mouths of cracks what lives on one flank.
//!
//! A plate answers to waves of a rim smoothly, but for the mouth of a crack: there each flank is a corner of its own, whose answer has no
//! length but the way s to the mouth. Decays `(1 - s/ℓ)^m` of one flank, m doubled again and again, have all lengths.

use std::f64::consts::{PI, TAU};

use nalgebra::{Complex, DMatrix, DVector};

use perilife_plate::williams::Elasticity;

/// Waves around a rim: at a distance d a load e^(inθ) is felt as (R/d)^n.
const WAVES: i32 = 5;
/// Waves more of finer functions.
const MORE: i32 = 2;
/// Places around a rim at which pressure is put on nodes and displacement is read.
const PLACES: usize = 720;
/// Waves of which the answer of a plane is summed.
const SUMMED: usize = 180;
/// Reach ℓ of what lives on one flank, rad, no further than to the next mouth.
const REACH: f64 = 1.0;
/// Powers m, the last of finer functions alone.
const POWERS: [i32; 6] = [2, 4, 8, 16, 32, 64];
/// Mouths that are one, rad.
const SAME: f64 = 1e-3;
/// Share of a function that is left by others below which there is no other.
const ANOTHER: f64 = 1e-8;

/// What is on one side of the mouth of a crack.
#[derive(Debug, Clone, Copy)]
struct Flank {
    mouth: f64,
    /// 1 of what lies counter-clockwise of the mouth, else -1.
    side: f64,
    reach: f64,
}

/// Orthonormal functions of the angle.
#[derive(Debug, Clone)]
pub struct Shapes {
    /// Where cracks begin, rad.
    pub mouths: Vec<f64>,
    waves: i32,
    powers: usize,
    flanks: Vec<Flank>,
    /// Of waves and decays.
    weights: DMatrix<f64>,
    pub at_places: DMatrix<f64>,
    /// ∫ e^(-inθ) of each of them.
    pub spectrum: DMatrix<Complex<f64>>,
}

impl Shapes {
    /// Those of a rim with mouths of cracks at angles, rad, or finer ones.
    pub fn new(mut mouths: Vec<f64>, is_finer: bool) -> Self {
        mouths.iter_mut().for_each(|mouth| *mouth = (*mouth + PI).rem_euclid(TAU) - PI);
        mouths.sort_by(f64::total_cmp);
        mouths.dedup_by(|b, a| *b - *a < SAME);
        let on_way = |from: f64, side: f64| {
            let ways = mouths.iter().map(|to| (side * (to - from)).rem_euclid(TAU)).filter(|way| *way > SAME);
            ways.fold(REACH, f64::min)
        };
        let flank = |&mouth: &f64| [1.0, -1.0].map(|side| Flank { mouth, side, reach: on_way(mouth, side) });
        let flanks: Vec<Flank> = mouths.iter().flat_map(flank).collect();
        let waves = WAVES + if is_finer { MORE } else { 0 };
        let powers = if is_finer { POWERS.len() } else { POWERS.len() - 1 };
        let (empty, spectrum) = (DMatrix::zeros(0, 0), DMatrix::zeros(0, 0));
        let mut shapes = Shapes { mouths, waves, powers, flanks, weights: empty.clone(), at_places: empty, spectrum };
        let angles: Vec<f64> = shapes.angles().collect();
        let raw = shapes.raw(&angles);
        let step = TAU / PLACES as f64;
        let found = (raw.tr_mul(&raw) * step).symmetric_eigen();
        let kept: Vec<usize> = (0..found.eigenvalues.len()).filter(|&k| found.eigenvalues[k] > ANOTHER).collect();
        let column = |&k: &usize| found.eigenvectors.column(k) / found.eigenvalues[k].sqrt();
        shapes.weights = DMatrix::from_columns(&kept.iter().map(column).collect::<Vec<_>>());
        shapes.at_places = raw * &shapes.weights;
        let wave = DMatrix::from_fn(SUMMED, PLACES, |n, place| Complex::cis(-(n as f64) * angles[place]) * step);
        shapes.spectrum = wave * shapes.at_places.map(Complex::from);
        shapes
    }

    /// All places, rad; a mouth lies between the last and the first of them.
    pub fn angles(&self) -> impl Iterator<Item = f64> {
        let first = self.mouths.first().copied().unwrap_or(0.0);
        (0..PLACES).map(move |place| first + TAU * (place as f64 + 0.5) / PLACES as f64)
    }

    /// Waves and decays at angles, each of norm 1.
    fn raw(&self, angles: &[f64]) -> DMatrix<f64> {
        let mut columns = vec![DVector::from_element(angles.len(), TAU.sqrt().recip())];
        let mut add = |of: &dyn Fn(f64) -> f64| columns.push(DVector::from_iterator(angles.len(), angles.iter().map(|x| of(*x))));
        for n in (1..=self.waves).map(f64::from) {
            add(&|x| (n * x).cos() / PI.sqrt());
            add(&|x| (n * x).sin() / PI.sqrt());
        }
        for Flank { mouth, side, reach } in &self.flanks {
            let left = |x: f64| (1.0 - (side * (x - mouth)).rem_euclid(TAU) / reach).max(0.0);
            for &power in &POWERS[..self.powers] {
                add(&|x| (f64::from(2 * power + 1) / reach).sqrt() * left(x).powi(power));
            }
        }
        DMatrix::from_columns(&columns)
    }

    pub fn at(&self, angles: &[f64]) -> DMatrix<f64> {
        self.raw(angles) * &self.weights
    }

    /// ∫ of each of them and of the way u_r, m, at all places.
    pub fn parts(&self, moved: &DVector<f64>) -> DVector<f64> {
        self.at_places.tr_mul(moved) * (TAU / PLACES as f64)
    }

    /// ∫ of each of them and of u_r, m/Pa, of a plane with a hole of this radius under a pressure with these ∫ p e^(-inθ): cos nθ moves it by
    /// R/4G (1/(n+1) + κ/(n-1)).
    pub fn of_plane(&self, pressure: &DMatrix<Complex<f64>>, radius: f64, plate: Elasticity) -> DMatrix<f64> {
        let size = |n: usize| match n {
            0 => 1.0 / TAU,
            1 => 0.25 / PI,
            _ => 0.5 / PI * (1.0 / (n as f64 + 1.0) + plate.kappa / (n as f64 - 1.0)),
        };
        let moved = DMatrix::from_fn(SUMMED, pressure.ncols(), |n, k| pressure[(n, k)] * size(n));
        self.spectrum.ad_mul(&moved).map(|part| 0.5 * radius / plate.shear_modulus * part.re)
    }

    /// The same under ∫ p dθ at angles.
    pub fn plane_under(&self, pressed: &[(f64, f64)], radius: f64, plate: Elasticity) -> DVector<f64> {
        let wave = |n: usize| pressed.iter().map(|(angle, size)| Complex::cis(-(n as f64) * angle) * *size).sum();
        self.of_plane(&DMatrix::from_fn(SUMMED, 1, |n, _| wave(n)), radius, plate).column(0).into_owned()
    }
}

/// Matrices one after the other on the diagonal of one.
pub fn on_diagonal(blocks: impl Iterator<Item = DMatrix<f64>>) -> DMatrix<f64> {
    blocks.fold(DMatrix::zeros(0, 0), |before, block| {
        let (rows, columns) = before.shape();
        let mut all = before.resize(rows + block.nrows(), columns + block.ncols(), 0.0);
        all.view_mut((rows, columns), block.shape()).copy_from(&block);
        all
    })
}
