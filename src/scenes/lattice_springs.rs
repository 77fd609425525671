//! Forces of springs on a lattice: the same as [`super::springs`], many times faster.
//!
//! On a lattice the bond k of a point is the same vector everywhere, so rows are worked through in blocks of neighbouring
//! points and every pair once. A task takes a band of rows and adds the pulls of its bonds into rows of its own, those above
//! the band included; overlapping rows are added afterwards in the order of the bands, so that the sums do not depend on the
//! number of threads. For laws without history and two unknowns a point; all else goes by the list of bonds.

use rayon::prelude::*;

use super::bonds::BondState;
use super::failure::Failure;
use super::interaction::{Damaging, Interaction, Memory, Reaction};
use super::springs::stiffness_bound;
use perilife_points::body::Body;
use perilife_points::body::lattice::{LANES, Lattice};
use perilife_points::bond_law::stencil::StencilBond;
use perilife_points::net::Net;

const BAND: usize = 16;

/// A value for each of [`LANES`] neighbouring places.
type Lanes = [f64; LANES];

/// Normal and tangential strain of the bond of a place whose other end is `step` farther in memory, one at a time.
fn strain_of<const FINITE: bool>(bond: &StencilBond, step: usize, u: &[Vec<f64>; 2], place: usize) -> (f64, f64) {
    let eta = [0, 1].map(|c| u[c][place + step] - u[c][place]);
    let n = bond.normal;
    if FINITE {
        let y = [0, 1].map(|c| n[c] * bond.length + eta[c]);
        (y[0].hypot(y[1]) - bond.length, 0.0)
    } else {
        (eta[0] * n[0] + eta[1] * n[1], eta[1] * n[0] - eta[0] * n[1])
    }
}

/// When a bond breaks: from this stretch on, or from its energy on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Limit {
    stretch: f64,
    by_energy: bool,
}

/// What a kernel works on and does not change.
struct Fixed {
    lattice: Lattice,
    /// Bonds of a point with the distance in memory to the other end.
    springs: Vec<(usize, StencilBond)>,
    limit: Option<Limit>,
    finite: bool,
    /// Number of the bond in the net, row by row, in a row bond by bond.
    numbers: Vec<u32>,
    may_fail: Vec<bool>,
}

pub struct LatticeSprings<'n> {
    net: &'n Net,
    fixed: Fixed,
    /// Memory index of every point, and the first point of every row.
    places: Vec<u32>,
    row_starts: Vec<usize>,
    /// Stiffness multiplier of the bonds, ordered as their numbers; 0 absent or broken.
    carry: Vec<f32>,
    /// Displacement over the places, lattice axes, and that of the last evaluation.
    u: [Vec<f64>; 2],
    last: [Vec<f64>; 2],
    bands: Vec<Band>,
}

/// Pulls on the rows of a band and those above it that its bonds reach.
struct Band {
    pull: [Vec<f64>; 2],
    reaction: Reaction,
    broken: Vec<u32>,
}

impl<'n> LatticeSprings<'n> {
    /// Springs of a body, if its law can be worked through this way: two unknowns a point, one limit without history.
    pub fn new(net: &'n Net, body: &Body, bonds: &BondState, failure: &Failure, finite: bool) -> Option<Self> {
        let uniform = |limits: &[f64]| limits.first().copied().filter(|first| limits.iter().all(|limit| limit == first));
        let limit = match failure {
            Failure::Never => None,
            Failure::Stretch(limits) => Some(Limit { stretch: uniform(limits)?, by_energy: false }),
            Failure::Energy(limits) => Some(Limit { stretch: uniform(limits)?, by_energy: true }),
            Failure::Softening(_) => return None,
        };
        if net.unknowns != 2 || body.stencil.dilatation != 0.0 {
            return None;
        }
        let lattice = body.lattice.clone();
        // Steps are never negative: a bond is owned by its lower end, or along a row by the left one.
        let spring = |bond: &StencilBond| (lattice.step(bond.dx, bond.dy) as usize, *bond);
        let springs: Vec<(usize, StencilBond)> = body.stencil.bonds.iter().map(spring).collect();
        let (kinds, stride) = (springs.len(), lattice.stride);
        let mut carry = vec![0.0_f32; lattice.rows * kinds * stride];
        let mut numbers = vec![u32::MAX; carry.len()];
        let mut number = 0;
        let mut row_starts = vec![0; lattice.rows + 1];
        for &place in &body.points {
            let (column, row) = lattice.column_row(place as usize);
            row_starts[row + 1] += 1;
            // The order in which the net numbers its bonds.
            for k in 0..kinds {
                let multiplier = body.multiplier[k * body.places() + place as usize];
                if multiplier > 0.0 {
                    let at = (row * kinds + k) * stride + column + lattice.padding;
                    carry[at] = if bonds.share[number as usize] > 0.0 { multiplier } else { 0.0 };
                    numbers[at] = number;
                    number += 1;
                }
            }
        }
        for row in 0..lattice.rows {
            row_starts[row + 1] += row_starts[row];
        }
        let rows = BAND + body.stencil.reach;
        let band = || Band {
            // One block more than the rows, so that whole blocks can be read and written at their end.
            pull: [0, 1].map(|_| vec![0.0; rows * stride + LANES]),
            reaction: Reaction::default(),
            broken: Vec::new(),
        };
        let bands = (0..lattice.rows.div_ceil(BAND)).map(|_| band()).collect();
        let u = [0, 1].map(|_| vec![0.0; lattice.places()]);
        let last = u.clone();
        let places = body.points.clone();
        let fixed = Fixed { lattice, springs, limit, finite, numbers, may_fail: bonds.may_fail.clone() };
        Some(LatticeSprings { net, fixed, places, row_starts, carry, u, last, bands })
    }

    /// Puts the displacement of the points on the places, in lattice axes.
    fn spread(&mut self, u: &[f64]) {
        let (lattice, starts, places) = (&self.fixed.lattice, &self.row_starts, &self.places);
        let first = lattice.padding * lattice.stride;
        let [x, y] = &mut self.u;
        let rows = x[first..].par_chunks_mut(lattice.stride).zip(y[first..].par_chunks_mut(lattice.stride));
        rows.take(lattice.rows).with_min_len(BAND).enumerate().for_each(|(row, (x, y))| {
            let start = first + row * lattice.stride;
            for point in starts[row]..starts[row + 1] {
                let along = lattice.to_axes([u[2 * point], u[2 * point + 1]]);
                let place = places[point] as usize - start;
                (x[place], y[place]) = (along[0], along[1]);
            }
        });
    }

    /// Adds the pulls of all bands into the forces of the points, in plate axes.
    fn collect(&self, force: &mut [f64]) {
        let lattice = &self.fixed.lattice;
        let mut rows: Vec<&mut [f64]> = Vec::with_capacity(lattice.rows);
        let mut rest = force;
        for row in 0..lattice.rows {
            let (own, others) = rest.split_at_mut(2 * (self.row_starts[row + 1] - self.row_starts[row]));
            rows.push(own);
            rest = others;
        }
        rows.into_par_iter().with_min_len(BAND).enumerate().for_each(|(row, out)| {
            let (band, inside) = (row / BAND, row % BAND);
            let reach = self.bands[0].pull[0].len() / lattice.stride - BAND;
            let start = (row + lattice.padding) * lattice.stride;
            for (point, out) in (self.row_starts[row]..).zip(out.chunks_exact_mut(2)) {
                let column = self.places[point] as usize - start;
                let at = inside * lattice.stride + column;
                let mut sum = [0, 1].map(|c| self.bands[band].pull[c][at]);
                if inside < reach && band > 0 {
                    let above = (BAND + inside) * lattice.stride + column;
                    sum = [0, 1].map(|c| sum[c] + self.bands[band - 1].pull[c][above]);
                }
                out.copy_from_slice(&lattice.from_axes(sum));
            }
        });
    }
}

/// Work of one band, compiled for every vector width and run with the widest the processor has.
struct BandWork<'a> {
    fixed: &'a Fixed,
    /// `None` where bonds keep their state.
    limit: Option<Limit>,
    u: &'a [Vec<f64>; 2],
    last: &'a [Vec<f64>; 2],
    first: usize,
    carry: &'a mut [f32],
    band: &'a mut Band,
}

impl pulp::WithSimd for BandWork<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        if self.fixed.finite { self.rows::<true>() } else { self.rows::<false>() }
    }
}

impl BandWork<'_> {
    #[inline(always)]
    fn rows<const FINITE: bool>(self) {
        let Fixed { lattice, springs, numbers, may_fail, .. } = self.fixed;
        let Lattice { stride, padding, columns, .. } = *lattice;
        let kinds = springs.len();
        let Band { pull: [pull_x, pull_y], reaction, broken } = self.band;
        pull_x.fill(0.0);
        pull_y.fill(0.0);
        broken.clear();
        let mut strain: Lanes = [0.0; LANES];
        let mut released = 0.0;
        for (row, carry) in self.carry.chunks_exact_mut(kinds * stride).enumerate() {
            let place = (self.first + row + padding) * stride + padding;
            for column in (0..columns).step_by(LANES) {
                let (at, out) = (place + column, row * stride + padding + column);
                let (here_x, here_y) = (load(&self.u[0], at), load(&self.u[1], at));
                let (mut sum_x, mut sum_y): (Lanes, Lanes) = ([0.0; LANES], [0.0; LANES]);
                for (k, (step, spring)) in springs.iter().enumerate() {
                    let shares = k * stride + padding + column;
                    let there_x = load(&self.u[0], at + step);
                    let there_y = load(&self.u[1], at + step);
                    let (mut share, mut e_n, mut e_t): (Lanes, Lanes, Lanes) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
                    let (mut n_x, mut n_y) = ([spring.normal[0]; LANES], [spring.normal[1]; LANES]);
                    for lane in 0..LANES {
                        share[lane] = f64::from(carry[shares + lane]);
                        let (eta_x, eta_y) = (there_x[lane] - here_x[lane], there_y[lane] - here_y[lane]);
                        if FINITE {
                            let xi = spring.normal.map(|n| n * spring.length);
                            let (y_x, y_y) = (xi[0] + eta_x, xi[1] + eta_y);
                            let length = (y_x * y_x + y_y * y_y).sqrt();
                            let inverse = 1.0 / length;
                            e_n[lane] = length - spring.length;
                            (n_x[lane], n_y[lane]) = (y_x * inverse, y_y * inverse);
                        } else {
                            e_n[lane] = eta_x * spring.normal[0] + eta_y * spring.normal[1];
                            e_t[lane] = eta_y * spring.normal[0] - eta_x * spring.normal[1];
                        }
                    }
                    if let Some(Limit { stretch, by_energy }) = self.limit {
                        let (limit, ratio) = (stretch * spring.length, spring.k_t / spring.k_n);
                        let longest = stretch * (2.0 + stretch) * spring.length * spring.length;
                        let mut beyond: Lanes = [0.0; LANES];
                        for lane in 0..LANES {
                            let (e_n, e_t) = (e_n[lane], e_t[lane]);
                            // True length squared, less that at rest.
                            let longer = e_n * (2.0 * spring.length + e_n) + e_t * e_t;
                            let measure = if by_energy {
                                let square = e_n * e_n + ratio * e_t * e_t - limit * limit;
                                let energy = if longer > 0.0 { square } else { -1.0 };
                                if longer >= longest { 1.0 } else { energy }
                            } else {
                                longer - longest
                            };
                            beyond[lane] = if share[lane] > 0.0 { measure } else { -1.0 };
                        }
                        if largest(&beyond) >= 0.0 {
                            for lane in 0..LANES {
                                let (e_n, e_t) = (e_n[lane], e_t[lane]);
                                let number = numbers[((self.first + row) * kinds * stride) + shares + lane];
                                if beyond[lane] >= 0.0 && may_fail[number as usize] {
                                    let (l_n, l_t) = strain_of::<FINITE>(spring, *step, self.last, at + lane);
                                    released += 0.5 * share[lane] * (spring.k_n * e_n * l_n + spring.k_t * e_t * l_t);
                                    broken.push(number);
                                    carry[shares + lane] = 0.0;
                                    share[lane] = 0.0;
                                }
                            }
                        }
                    }
                    let (mut f_x, mut f_y): (Lanes, Lanes) = ([0.0; LANES], [0.0; LANES]);
                    for lane in 0..LANES {
                        let normal = share[lane] * spring.k_n * e_n[lane];
                        let mut energy = normal * e_n[lane];
                        (f_x[lane], f_y[lane]) = (normal * n_x[lane], normal * n_y[lane]);
                        if !FINITE {
                            let tangential = share[lane] * spring.k_t * e_t[lane];
                            energy += tangential * e_t[lane];
                            f_x[lane] -= tangential * spring.normal[1];
                            f_y[lane] += tangential * spring.normal[0];
                        }
                        strain[lane] += energy;
                        sum_x[lane] += f_x[lane];
                        sum_y[lane] += f_y[lane];
                    }
                    subtract(pull_x, out + step, &f_x);
                    subtract(pull_y, out + step, &f_y);
                }
                for (pull, sum) in [(&mut *pull_x, &sum_x), (&mut *pull_y, &sum_y)] {
                    let target = &mut pull[out..out + LANES];
                    for lane in 0..LANES {
                        target[lane] += sum[lane];
                    }
                }
            }
        }
        *reaction = Reaction {
            strain: 0.5 * strain.iter().sum::<f64>(),
            released,
            broken: broken.len(),
            damaged: if broken.is_empty() { 0.0 } else { 1.0 },
        };
    }
}

#[inline(always)]
fn load(x: &[f64], at: usize) -> Lanes {
    let mut lanes = [0.0; LANES];
    lanes.copy_from_slice(&x[at..at + LANES]);
    lanes
}

/// Largest of the lanes, halved again and again so that it stays in vectors.
#[inline(always)]
fn largest(lanes: &Lanes) -> f64 {
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    let four: [f64; 4] = std::array::from_fn(|i| larger(lanes[i], lanes[i + 4]));
    let two: [f64; 2] = std::array::from_fn(|i| larger(four[i], four[i + 2]));
    larger(two[0], two[1])
}

#[inline(always)]
fn subtract(pull: &mut [f64], at: usize, f: &Lanes) {
    let target = &mut pull[at..at + LANES];
    for lane in 0..LANES {
        target[lane] -= f[lane];
    }
}

impl Interaction for LatticeSprings<'_> {
    fn unknowns(&self) -> usize {
        2
    }

    fn internal_force(&mut self, u: &[f64], bonds: &mut BondState, damaging: Damaging, force: &mut [f64]) -> Reaction {
        std::mem::swap(&mut self.u, &mut self.last);
        self.spread(u);
        let (fixed, u, last) = (&self.fixed, &self.u, &self.last);
        let limit = fixed.limit.filter(|_| damaging == Damaging::Allowed);
        let arch = pulp::Arch::new();
        let carries = self.carry.par_chunks_mut(BAND * fixed.springs.len() * fixed.lattice.stride);
        carries.zip(&mut self.bands).enumerate().for_each(|(i, (carry, band))| {
            arch.dispatch(BandWork { fixed, limit, u, last, first: i * BAND, carry, band });
        });
        self.collect(force);
        for band in &self.bands {
            band.broken.iter().for_each(|&bond| bonds.share[bond as usize] = 0.0);
        }
        self.bands.iter().map(|band| band.reaction).fold(Reaction::default(), Reaction::and)
    }

    fn stiffness_bound(&self, bonds: &BondState) -> Vec<[f64; 2]> {
        stiffness_bound(self.net, bonds)
    }

    fn memory(&self) -> Memory {
        let [x, y] = &self.u;
        let displacement = self.places.iter().flat_map(|&place| [x[place as usize], y[place as usize]]).collect();
        Memory { displacement, ..Memory::default() }
    }

    fn restore(&mut self, memory: &Memory, bonds: &BondState) -> bool {
        if memory.displacement.len() != 2 * self.places.len() {
            return false;
        }
        let [x, y] = &mut self.u;
        for (&place, at) in self.places.iter().zip(memory.displacement.chunks_exact(2)) {
            (x[place as usize], y[place as usize]) = (at[0], at[1]);
        }
        // Springs without a bond have no number.
        for (carry, &number) in self.carry.iter_mut().zip(&self.fixed.numbers) {
            if bonds.share.get(number as usize).is_some_and(|share| *share == 0.0) {
                *carry = 0.0;
            }
        }
        true
    }
}
