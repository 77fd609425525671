//! Bounded damped least squares on sparse equations, by Newton's method on the dual.
//!
//! `min ½ |x|² + Σ_i (G x - r)_i² / (2 ε_i)` with `lo ≤ x ≤ hi`. Its dual in one multiplier λ per equation is concave and
//! piecewise quadratic; `x = clip(Gᵀλ)`. A Newton step solves `(G_f G_fᵀ + ε) d = r - G x - ε λ` over the columns f that are
//! not at a bound (semi-smooth Newton: Hintermüller, Ito and Kunisch 2002, SIAM J. Optim. 13:865); an exact
//! line search makes it converge from anywhere. Without active bounds it ends after one step. The matrix couples the two ends
//! of bonds near the rim only, so cost grows with the length of the rim.

use std::collections::BTreeMap;

use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use rayon::prelude::*;

use crate::body::block_cholesky::{Factor, Structure};
use perilife_base::error::{Error, Result};

/// Equations of a point: four of force, two of rotation.
pub(super) const EQUATIONS: usize = 6;
/// Least and largest multiplier of a bond.
pub const BOUNDS: [f64; 2] = [0.2, 5.0];
/// ε of the equations of force: the least at which the factor is sound, and larger ones for rims that no multipliers
/// within the bounds can serve.
const SOFTNESS: [f64; 3] = [1e-7, 1e-5, 1e-3];
/// ε of the equations of rotation: as dear as a multiplier's distance from 1.
const SOFTNESS_TURN: f64 = 1.0;
/// Newton steps at one softness.
const STEPS: usize = 25;
/// Rounds of one step of all equations and steps of parts.
const ROUNDS: usize = 8;
/// Links from an equation whose bonds are at a bound to the border of its part.
const HOPS: usize = 8;
/// Gradient over the largest residual at which a step is the last.
const TOLERANCE: f64 = 1e-8;

/// One value per equation of a point.
pub type Gain = [f64; EQUATIONS];

/// What a bond of multiplier 1 adds to the equations of its ends.
#[derive(Debug, Clone, Copy)]
pub struct BondGain {
    pub at_owner: Gain,
    pub at_other: Gain,
}

impl BondGain {
    /// At the end that a sign of [`crate::body::Body::around`] names.
    pub(super) fn at(&self, sign: f64) -> &Gain {
        if sign > 0.0 { &self.at_owner } else { &self.at_other }
    }
}

/// An unknown: a bond between two points.
#[derive(Debug, Clone, Copy)]
pub struct Link {
    /// Number of the owner.
    pub from: u32,
    /// Number of the other end, larger than the owner's.
    pub to: u32,
    /// Entry of the stencil.
    pub k: usize,
}

/// Equations over the changes of multipliers.
pub struct Problem<'a> {
    gains: &'a [BondGain],
    /// Sorted by owner, then by other end.
    links: Vec<Link>,
    missing: Vec<Gain>,
}

/// Multipliers of the equations, and what they make of the unknowns before these are clipped: `y = Gᵀλ`.
struct Dual {
    lambda: Vec<Gain>,
    y: Vec<f64>,
}

impl<'a> Problem<'a> {
    /// Equations `Σ gain x = missing` of all points.
    pub fn new(gains: &'a [BondGain], links: Vec<Link>, missing: Vec<Gain>) -> Self {
        Problem { gains, links, missing }
    }

    /// The changes of multipliers within [`BOUNDS`], with the smallest softness that Newton's method manages.
    /// Errors: it manages none for the points of `these`.
    pub fn solve(&self, these: &str) -> Result<Vec<f64>> {
        self.solve_to(&SOFTNESS, BOUNDS.map(|bound| bound - 1.0)).ok_or_else(|| {
            Error::Mechanics(format!(
                "the balanced surface correction found no bond multipliers for {these}; reduce the spacing, or use \
                 model.surface_correction = \"volume_and_surface\""
            ))
        })
    }

    /// The same with other values of ε of the equations of force, the first of them that Newton's method manages.
    pub fn solve_to(&self, softness: &[f64], bounds: [f64; 2]) -> Option<Vec<f64>> {
        let solve = |(points, links): (Vec<u32>, Vec<u32>)| {
            let part = EquationBlock::new(self, points, links)?;
            let solved = softness.iter().find_map(|&softness| part.solve(Bounded { softness, bounds }))?;
            Some((part.links, solved))
        };
        let mut changes = vec![0.0; self.links.len()];
        for (links, solved) in
            self.parts(vec![true; self.missing.len()]).into_par_iter().map(solve).collect::<Option<Vec<_>>>()?
        {
            links.iter().zip(solved).for_each(|(&link, change)| changes[link as usize] = change);
        }
        Some(changes)
    }

    /// Points that are inside and have links, and all of these, by parts that no link joins.
    fn parts(&self, inside: Vec<bool>) -> Vec<(Vec<u32>, Vec<u32>)> {
        // Each point's part by the smallest number that its links lead to.
        let mut part: Vec<u32> = (0..inside.len() as u32).collect();
        let root = |part: &mut [u32], mut point: u32| {
            while part[point as usize] != point {
                part[point as usize] = part[part[point as usize] as usize];
                point = part[point as usize];
            }
            point
        };
        for link in self.links.iter().filter(|link| inside[link.from as usize] && inside[link.to as usize]) {
            let [a, b] = [link.from, link.to].map(|end| root(&mut part, end));
            part[a.max(b) as usize] = a.min(b);
        }
        let mut parts: BTreeMap<u32, (Vec<u32>, Vec<u32>)> = BTreeMap::new();
        for point in (0..inside.len() as u32).filter(|&point| inside[point as usize]) {
            parts.entry(root(&mut part, point)).or_default().0.push(point);
        }
        for (index, link) in self.links.iter().enumerate() {
            if let Some(end) = [link.from, link.to].into_iter().find(|&end| inside[end as usize]) {
                parts.entry(root(&mut part, end)).or_default().1.push(index as u32);
            }
        }
        parts.into_values().filter(|(_, links)| !links.is_empty()).collect()
    }
}

/// ε of the equations of force, and bounds of the unknowns.
#[derive(Clone, Copy)]
struct Bounded {
    softness: f64,
    bounds: [f64; 2],
}

impl Bounded {
    fn clip(self, y: f64) -> f64 {
        y.clamp(self.bounds[0], self.bounds[1])
    }

    fn is_free(self, y: f64) -> bool {
        y > self.bounds[0] && y < self.bounds[1]
    }

    fn epsilon(self, equation: usize) -> f64 {
        if equation % EQUATIONS < 4 { self.softness } else { SOFTNESS_TURN }
    }
}

fn is_small(gradient: &[f64], tolerance: f64) -> bool {
    gradient.iter().all(|g| g.abs() <= tolerance)
}

/// Equations of some points, with all links that these have; multipliers of other points stay.
struct EquationBlock<'a> {
    problem: &'a Problem<'a>,
    points: Vec<u32>,
    links: Vec<u32>,
    /// Ends of every link among the points: of the owner, of the other.
    ends: Vec<[Option<u32>; 2]>,
    symbolic: SymbolicSparseColMat<usize>,
    structure: Structure,
}

impl<'a> EquationBlock<'a> {
    /// `None` where there are too many.
    fn new(problem: &'a Problem<'a>, points: Vec<u32>, links: Vec<u32>) -> Option<Self> {
        let mut number = vec![None; problem.missing.len()];
        points.iter().enumerate().for_each(|(i, &point)| number[point as usize] = Some(i as u32));
        let ends: Vec<[Option<u32>; 2]> = links
            .iter()
            .map(|&link| {
                let Link { from, to, .. } = problem.links[link as usize];
                [number[from as usize], number[to as usize]]
            })
            .collect();
        let mut others: Vec<Vec<u32>> = vec![Vec::new(); points.len()];
        for [from, to] in &ends {
            if let (Some(from), Some(to)) = (from, to) {
                others[*from as usize].push(*to);
            }
        }
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for (point, others) in others.iter().enumerate() {
            for c in 0..EQUATIONS {
                rows.extend((c..EQUATIONS).map(|d| point * EQUATIONS + d));
                for other in others {
                    rows.extend((0..EQUATIONS).map(|d| *other as usize * EQUATIONS + d));
                }
                starts.push(rows.len());
            }
        }
        let n = points.len() * EQUATIONS;
        let symbolic = SymbolicSparseColMat::new_checked(n, n, starts, None, rows);
        let structure = Structure::of(symbolic.as_ref(), EQUATIONS)?;
        Some(EquationBlock { problem, points, links, ends, symbolic, structure })
    }

    /// Newton's method from rest on the equations of points that no link joins with others; the changes of the links. Its first step,
    /// before any bound is active, is one of all equations. What active bounds change stays near them, so that further steps are those
    /// of few points, in turn with corrections of all by the factor of the first.
    fn solve(&self, limits: Bounded) -> Option<Vec<f64>> {
        let problem = self.problem;
        let mut dual = Dual { lambda: vec![[0.0; EQUATIONS]; problem.missing.len()], y: vec![0.0; problem.links.len()] };
        let missing = self.points.iter().flat_map(|&point| &problem.missing[point as usize]);
        let tolerance = TOLERANCE * missing.fold(0.0_f64, |m, r| m.max(r.abs()));
        let all_free = self.factor(&dual, limits)?;
        for _ in 0..ROUNDS {
            let gradient = self.gradient(&dual, limits);
            if is_small(&gradient, tolerance) {
                break;
            }
            self.step(&all_free, gradient, &mut dual, limits)?;
            let near = self.near(&self.gradient(&dual, limits), tolerance);
            if 2 * near.iter().filter(|near| **near).count() > self.points.len() {
                break;
            }
            self.solve_near(near, &mut dual, limits, tolerance);
        }
        // Where these rounds did not do, steps of all equations.
        self.newton(&mut dual, limits, tolerance)?;
        Some(self.links.iter().map(|&link| limits.clip(dual.y[link as usize])).collect())
    }

    /// Newton's method on the equations of some points, by parts that no link joins; where one of them fails, nothing changes.
    fn solve_near(&self, near: Vec<bool>, dual: &mut Dual, limits: Bounded, tolerance: f64) {
        let solve = |(points, links): (Vec<u32>, Vec<u32>)| {
            let part = EquationBlock::new(self.problem, points, links)?;
            let mut own = Dual { lambda: dual.lambda.clone(), y: dual.y.clone() };
            part.newton(&mut own, limits, tolerance)?;
            Some((part.points, part.links, own))
        };
        let solved: Vec<_> = self.problem.parts(near).into_par_iter().map(solve).collect::<Option<_>>().unwrap_or_default();
        for (points, links, own) in solved {
            points.iter().for_each(|&point| dual.lambda[point as usize] = own.lambda[point as usize]);
            links.iter().for_each(|&link| dual.y[link as usize] = own.y[link as usize]);
        }
    }

    /// Which points of the problem are near equations of these whose gradient is not small yet.
    fn near(&self, gradient: &[f64], tolerance: f64) -> Vec<bool> {
        let mut near = vec![false; self.problem.missing.len()];
        for (own, &point) in gradient.chunks(EQUATIONS).zip(&self.points) {
            near[point as usize] = !is_small(own, tolerance);
        }
        for _ in 0..HOPS {
            let before = near.clone();
            for &link in &self.links {
                let Link { from, to, .. } = self.problem.links[link as usize];
                if before[from as usize] || before[to as usize] {
                    (near[from as usize], near[to as usize]) = (true, true);
                }
            }
        }
        near
    }

    /// Newton's method on these equations.
    fn newton(&self, dual: &mut Dual, limits: Bounded, tolerance: f64) -> Option<()> {
        for _ in 0..STEPS {
            let gradient = self.gradient(dual, limits);
            if is_small(&gradient, tolerance) {
                return Some(());
            }
            self.step(&self.factor(dual, limits)?, gradient, dual, limits)?;
        }
        None
    }

    /// `(G_f G_fᵀ + ε)⁻¹` over the columns f that are not at a bound.
    fn factor(&self, dual: &Dual, limits: Bounded) -> Option<Factor<'_>> {
        let values = self.normal_matrix(&dual.y, limits);
        self.structure.factor(SparseColMatRef::new(self.symbolic.as_ref(), &values))
    }

    /// Adds what a factor makes of the gradient, as far as the dual rises.
    fn step(&self, factor: &Factor<'_>, gradient: Vec<f64>, dual: &mut Dual, limits: Bounded) -> Option<()> {
        let mut step = gradient;
        factor.solve(&mut step);
        let z = self.apply_transposed(&step);
        let y: Vec<f64> = self.links.iter().map(|&link| dual.y[link as usize]).collect();
        // Slope of the dual along the step: falls as the way grows.
        let (mut fixed, mut curved) = (0.0, 0.0);
        for (i, step) in step.iter().enumerate() {
            let (point, c) = (self.points[i / EQUATIONS] as usize, i % EQUATIONS);
            fixed += step * (self.problem.missing[point][c] - limits.epsilon(i) * dual.lambda[point][c]);
            curved += step * step * limits.epsilon(i);
        }
        let slope = |way: f64| {
            let carried: f64 = y.iter().zip(&z).map(|(y, z)| z * limits.clip(y + way * z)).sum();
            fixed - way * curved - carried
        };
        let way = if slope(1.0) >= -1e-9 * slope(0.0) { 1.0 } else { root(slope) };
        for (step, &point) in step.chunks(EQUATIONS).zip(&self.points) {
            dual.lambda[point as usize].iter_mut().zip(step).for_each(|(l, d)| *l += way * d);
        }
        self.links.iter().zip(&z).for_each(|(&link, z)| dual.y[link as usize] += way * z);
        Some(())
    }

    fn gain(&self, link: u32) -> &BondGain {
        &self.problem.gains[self.problem.links[link as usize].k]
    }

    /// `r - G x - ε λ`.
    fn gradient(&self, dual: &Dual, limits: Bounded) -> Vec<f64> {
        let left = |&point: &u32| -> Gain {
            let (missing, lambda) = (&self.problem.missing[point as usize], &dual.lambda[point as usize]);
            std::array::from_fn(|c| missing[c] - limits.epsilon(c) * lambda[c])
        };
        let mut left: Vec<Gain> = self.points.iter().map(left).collect();
        for (&link, ends) in self.links.iter().zip(&self.ends) {
            let (gain, x) = (self.gain(link), limits.clip(dual.y[link as usize]));
            for (end, gain) in ends.iter().zip([&gain.at_owner, &gain.at_other]) {
                if let Some(end) = end {
                    left[*end as usize].iter_mut().zip(gain).for_each(|(left, g)| *left -= g * x);
                }
            }
        }
        left.into_flattened()
    }

    /// Gᵀ of multipliers of these equations alone.
    fn apply_transposed(&self, lambda: &[f64]) -> Vec<f64> {
        let dot = |end: &Option<u32>, gain: &Gain| -> f64 {
            let Some(end) = end else { return 0.0 };
            let at = *end as usize * EQUATIONS;
            lambda[at..at + EQUATIONS].iter().zip(gain).map(|(l, g)| l * g).sum()
        };
        let of_link = |(&link, [from, to]): (&u32, &[Option<u32>; 2])| {
            let gain = self.gain(link);
            dot(from, &gain.at_owner) + dot(to, &gain.at_other)
        };
        self.links.iter().zip(&self.ends).map(of_link).collect()
    }

    /// Values of the lower triangle of `G_f G_fᵀ + ε` in the order of the symbolic matrix.
    fn normal_matrix(&self, y: &[f64], limits: Bounded) -> Vec<f64> {
        let mut own = vec![[[0.0; EQUATIONS]; EQUATIONS]; self.points.len()];
        let mut joining: Vec<Vec<(&BondGain, bool)>> = vec![Vec::new(); self.points.len()];
        for (&link, ends) in self.links.iter().zip(&self.ends) {
            let (gain, is_free) = (self.gain(link), limits.is_free(y[link as usize]));
            if let [Some(from), Some(_)] = ends {
                joining[*from as usize].push((gain, is_free));
            }
            for (end, gain) in ends.iter().zip([&gain.at_owner, &gain.at_other]) {
                let Some(end) = end.filter(|_| is_free) else { continue };
                for (column, g) in own[end as usize].iter_mut().zip(gain) {
                    column.iter_mut().zip(gain).for_each(|(sum, h)| *sum += g * h);
                }
            }
        }
        let mut values = Vec::with_capacity(self.symbolic.row_idx().len());
        for (own, joining) in own.iter().zip(&joining) {
            for (c, column) in own.iter().enumerate() {
                values.extend((c..EQUATIONS).map(|d| column[d] + if c == d { limits.epsilon(c) } else { 0.0 }));
                for (gain, is_free) in joining {
                    let g = if *is_free { gain.at_owner[c] } else { 0.0 };
                    values.extend(gain.at_other.iter().map(|h| g * h));
                }
            }
        }
        values
    }
}

/// Zero of a falling function between 0 and 1, where it is positive and negative.
fn root(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
