//! Shape functions by moving least squares (Lancaster and Salkauskas 1981; Belytschko, Lu and Gu 1994, IJNME 37:229).
//!
//! ```text
//! Φ_i(x) = γ · p(x_i) w_i(x),   A γ = p(x),   A = Σ_i w_i p(x_i) p(x_i)ᵀ
//! Φ_i,k  = γ_k · p(x_i) w_i + γ · p(x_i) w_i,k,   A γ_k = p,k(x) - A,k γ
//! ```
//! with the cubic spline `w = 2/3 - 4s² + 4s³` for `s ≤ ½`, `4/3 - 4s + 4s² - 4/3 s³` up to 1, s the way from node to point over the
//! support of the node. Coordinates are those from the point, over the spacing, so that A is as well conditioned anywhere.
//!
//! The basis is that of a case, around a tip with functions of the tip where it is enriched by them.

use super::crack::TipAxes;
use super::cuts::Near;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::distance;

perilife_base::kinds! {
    /// Polynomials that the shape functions reproduce.
    pub enum BasisKind for "model.basis" {
        Linear = "linear": "1, x, y",
        Quadratic = "quadratic": "1, x, y, x², xy, y²",
    }
}

perilife_base::kinds! {
    /// How near-tip fields come into the displacement.
    pub enum Enrichment for "model.enrichment" {
        Tip = "tip": "both near-tip fields as extra unknowns at nodes around a tip",
        Intrinsic = "intrinsic": "√r cos θ/2, √r sin θ/2, and both times sin θ in the basis around a tip",
        None = "none": "polynomials only: error of K 4 to 8 %",
    }
}

/// Distances from a tip, in its spacings, between which the enriched basis gives way to the polynomials.
const RAMP_SPACINGS: [f64; 2] = [2.0, 4.0];

/// Least pivot of A over its diagonal: below it nodes in reach do not span the basis.
pub(super) const PIVOT_LEAST: f64 = 1e-10;

/// A node as a point sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// Its place in the list that was given.
    pub node: u32,
    pub value: f64,
    /// Gradient of Φ_i, 1/m.
    pub gradient: Point,
}

/// Value and derivatives of the cubic spline.
fn spline(s: f64) -> (f64, f64) {
    if s <= 0.5 {
        (2.0 / 3.0 + s * s * (4.0 * s - 4.0), s * (12.0 * s - 8.0))
    } else if s < 1.0 {
        let left = 1.0 - s;
        (4.0 / 3.0 * left * left * left, -4.0 * left * left)
    } else {
        (0.0, 0.0)
    }
}

#[derive(Clone, Copy)]
struct Weighted<const M: usize> {
    node: u32,
    p: [f64; M],
    weight: f64,
    slope: Point,
}

/// A polynomial or enriched basis of M functions.
trait Basis<const M: usize> {
    /// p at `of` with coordinates from `origin` in units of `scale`, m.
    fn at(&self, of: Point, origin: Point, scale: f64) -> [f64; M];
    /// p and its derivatives over x and y at `origin`.
    fn at_origin(&self, origin: Point, scale: f64) -> [[f64; M]; 3];
}

#[derive(Debug, Clone, Copy)]
struct Linear;

impl Basis<3> for Linear {
    fn at(&self, of: Point, origin: Point, scale: f64) -> [f64; 3] {
        [1.0, (of[0] - origin[0]) / scale, (of[1] - origin[1]) / scale]
    }

    fn at_origin(&self, _: Point, scale: f64) -> [[f64; 3]; 3] {
        [[1.0, 0.0, 0.0], [0.0, 1.0 / scale, 0.0], [0.0, 0.0, 1.0 / scale]]
    }
}

#[derive(Debug, Clone, Copy)]
struct Quadratic;

impl Basis<6> for Quadratic {
    fn at(&self, of: Point, origin: Point, scale: f64) -> [f64; 6] {
        let [x, y] = [0, 1].map(|i| (of[i] - origin[i]) / scale);
        [1.0, x, y, x * x, x * y, y * y]
    }

    fn at_origin(&self, _: Point, scale: f64) -> [[f64; 6]; 3] {
        let mut p = [[0.0; 6]; 3];
        (p[0][0], p[1][1], p[2][2]) = (1.0, 1.0 / scale, 1.0 / scale);
        p
    }
}

/// Shape functions of the `candidates` (index into positions and supports, m) at a point, left in `values`; whether the nodes in
/// reach span the basis.
fn shape_functions<const M: usize>(
    basis: &impl Basis<M>,
    at: Point,
    (candidates, positions, supports): (&[u32], &[Point], &[f64]),
    near: &Near,
    scale: f64,
    values: &mut Vec<Value>,
) -> bool {
    values.clear();
    let mut weighted: Vec<Weighted<M>> = Vec::with_capacity(candidates.len());
    let is_free = near.is_empty();
    for &node in candidates {
        let (position, support) = (positions[node as usize], supports[node as usize]);
        let [x, y] = [at[0] - position[0], at[1] - position[1]];
        let squared = x * x + y * y;
        if squared >= support * support {
            continue;
        }
        let way = if is_free {
            let length = squared.sqrt();
            Some((length, if length > 0.0 { [x / length, y / length] } else { [0.0; 2] }))
        } else {
            near.way(position, at, support)
        };
        let Some((length, gradient)) = way.filter(|way| way.0 < support) else { continue };
        let (weight, slope) = spline(length / support);
        let p = basis.at(position, at, scale);
        weighted.push(Weighted { node, p, weight, slope: gradient.map(|g| g * slope / support) });
    }
    let mut moments = [[[0.0; M]; M]; 3];
    for node in &weighted {
        let factors = [node.weight, node.slope[0], node.slope[1]];
        for (moment, factor) in moments.iter_mut().zip(factors) {
            for (i, (row, p)) in moment.iter_mut().zip(node.p).enumerate() {
                let left = factor * p;
                row[..=i].iter_mut().zip(node.p).for_each(|(sum, p)| *sum += left * p);
            }
        }
    }
    let [mut a, a_x, a_y] = moments;
    if !factorise(&mut a) {
        return false;
    }
    let [p, p_x, p_y] = basis.at_origin(at, scale);
    let gamma = solve(&a, p);
    let [gamma_x, gamma_y] = [(p_x, a_x), (p_y, a_y)].map(|(p, moment)| {
        let product = times(&moment, &gamma);
        let mut right = p;
        right.iter_mut().zip(product).for_each(|(right, product)| *right -= product);
        solve(&a, right)
    });
    let dot = |a: &[f64; M], b: &[f64; M]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    values.extend(weighted.iter().map(|node| {
        let along = dot(&gamma, &node.p);
        Value {
            node: node.node,
            value: along * node.weight,
            gradient: [
                dot(&gamma_x, &node.p) * node.weight + along * node.slope[0],
                dot(&gamma_y, &node.p) * node.weight + along * node.slope[1],
            ],
        }
    }));
    true
}

/// Cholesky factor in place of the lower triangle; whether the matrix is positive definite.
fn factorise<const M: usize>(a: &mut [[f64; M]; M]) -> bool {
    for i in 0..M {
        let diagonal = a[i][i];
        for j in 0..=i {
            let sum = a[i][j] - (0..j).map(|k| a[i][k] * a[j][k]).sum::<f64>();
            if i == j {
                if sum.partial_cmp(&(PIVOT_LEAST * diagonal)) != Some(std::cmp::Ordering::Greater) {
                    return false;
                }
                a[i][i] = sum.sqrt();
            } else {
                a[i][j] = sum / a[j][j];
            }
        }
    }
    true
}

fn solve<const M: usize>(factor: &[[f64; M]; M], mut b: [f64; M]) -> [f64; M] {
    for i in 0..M {
        let sum: f64 = (0..i).map(|k| factor[i][k] * b[k]).sum();
        b[i] = (b[i] - sum) / factor[i][i];
    }
    for i in (0..M).rev() {
        let sum: f64 = (i + 1..M).map(|k| factor[k][i] * b[k]).sum();
        b[i] = (b[i] - sum) / factor[i][i];
    }
    b
}

/// Product of a symmetric matrix by its lower triangle.
fn times<const M: usize>(a: &[[f64; M]; M], x: &[f64; M]) -> [f64; M] {
    let mut product = [0.0; M];
    for i in 0..M {
        for j in 0..M {
            product[i] += a[i.max(j)][i.min(j)] * x[j];
        }
    }
    product
}

#[derive(Debug, Clone)]
pub struct AnyBasis {
    kind: BasisKind,
    /// Tips whose functions the basis has around them.
    tips: Vec<TipAxes>,
}

/// Polynomials and the four functions of a tip.
struct Intrinsic<'a>(&'a TipAxes);

impl Intrinsic<'_> {
    /// √r cos θ/2, √r sin θ/2, √r sin θ/2 sin θ, √r cos θ/2 sin θ, r in spacings.
    fn functions(&self, at: Point) -> [f64; 4] {
        let (r, theta) = self.0.polar(at);
        let (sin, cos) = (0.5 * theta).sin_cos();
        let root = (r / self.0.spacing).sqrt();
        [root * cos, root * sin, root * sin * theta.sin(), root * cos * theta.sin()]
    }

    /// Their derivatives over the axes of the plate.
    fn slopes(&self, at: Point) -> [Point; 4] {
        let (r, theta) = self.0.polar(at);
        let ((sin, cos), (sin_t, cos_t)) = ((0.5 * theta).sin_cos(), theta.sin_cos());
        let root = (r / self.0.spacing).max(1e-18).sqrt();
        let values = [cos, sin, sin * sin_t, cos * sin_t];
        let turns = [-0.5 * sin, 0.5 * cos, 0.5 * cos * sin_t + sin * cos_t, -0.5 * sin * sin_t + cos * cos_t];
        let over_r = 1.0 / (root * self.0.spacing);
        [0, 1, 2, 3].map(|k| {
            let (of_r, of_theta) = (0.5 * values[k] * over_r, turns[k] * over_r);
            self.0.from_axes([of_r * cos_t - of_theta * sin_t, of_r * sin_t + of_theta * cos_t])
        })
    }
}

impl Basis<7> for Intrinsic<'_> {
    fn at(&self, of: Point, origin: Point, scale: f64) -> [f64; 7] {
        let [a, b, c] = Linear.at(of, origin, scale);
        let [d, e, f, g] = self.functions(of);
        [a, b, c, d, e, f, g]
    }

    fn at_origin(&self, origin: Point, scale: f64) -> [[f64; 7]; 3] {
        let linear = Linear.at_origin(origin, scale);
        let (values, slopes) = (self.functions(origin), self.slopes(origin));
        [0, 1, 2].map(|row| {
            let mut p = [0.0; 7];
            p[..3].copy_from_slice(&linear[row]);
            for k in 0..4 {
                p[3 + k] = if row == 0 { values[k] } else { slopes[k][row - 1] };
            }
            p
        })
    }
}

impl AnyBasis {
    pub fn new(kind: BasisKind, enrichment: Enrichment, axes: &[TipAxes]) -> Self {
        AnyBasis { kind, tips: if enrichment == Enrichment::Intrinsic { axes.to_vec() } else { Vec::new() } }
    }

    pub fn is_linear(&self) -> bool {
        self.kind == BasisKind::Linear && self.tips.is_empty()
    }

    /// Shape functions at a point (`shape_functions`). Around a tip with an enriched basis they are `R Φ^e + (1 - R) Φ`, R falling
    /// from 1 to 0 between two and four spacings (Fleming, Chu, Moran and Belytschko 1997, IJNME 40:1483).
    pub fn shape_functions(
        &self,
        at: Point,
        known: (&[u32], &[Point], &[f64]),
        near: &Near,
        scale: f64,
        values: &mut Vec<Value>,
    ) -> bool {
        let polynomials = |values: &mut Vec<Value>| match self.kind {
            BasisKind::Linear => shape_functions(&Linear, at, known, near, scale, values),
            BasisKind::Quadratic => shape_functions(&Quadratic, at, known, near, scale, values),
        };
        let [inner, outer] = RAMP_SPACINGS;
        let away = |tip: &&TipAxes| distance(at, tip.at) / tip.spacing;
        let nearest = self.tips.iter().min_by(|a, b| away(a).total_cmp(&away(b))).filter(|tip| away(tip) < outer);
        let Some(tip) = nearest else { return polynomials(values) };
        let share = ((outer - away(&tip)) / (outer - inner)).min(1.0);
        let mut of_basis = Vec::new();
        if !shape_functions(&Intrinsic(tip), at, known, near, scale, &mut of_basis) {
            return polynomials(values);
        }
        if share == 1.0 {
            *values = of_basis;
            return true;
        }
        if !polynomials(values) {
            return false;
        }
        let length = distance(at, tip.at);
        let slope = [0, 1].map(|i| -(at[i] - tip.at[i]) / length / ((outer - inner) * tip.spacing));
        // Both see the same nodes in the same order.
        for (value, enriched) in values.iter_mut().zip(&of_basis) {
            let more = enriched.value - value.value;
            for ((gradient, enriched), slope) in value.gradient.iter_mut().zip(enriched.gradient).zip(slope) {
                *gradient += share * (enriched - *gradient) + slope * more;
            }
            value.value += share * more;
        }
        true
    }
}
