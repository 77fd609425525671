//! The bonds of every point as it sees them, its shape tensor, and which bonds count in that.

use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;

use crate::bonds::BondState;
use crate::scene::DamageEntry;
use perilife_points::net::Net;

/// A bond seen from one of its ends.
#[derive(Debug, Clone, Copy)]
pub struct Neighbour {
    pub other: u32,
    pub bond: u32,
    /// ξ from this end to the other, m.
    pub xi: Vector2<f64>,
}

/// `det K / (tr K)²` below which the bonds of a point lie along one line (1/4 in a whole neighbourhood).
const SINGULAR: f64 = 1e-6;

/// Bonds by points: a compact copy of the lists of a net, for sums over neighbourhoods.
#[derive(Debug, Clone)]
pub struct Neighbours {
    list: Vec<Neighbour>,
    starts: Vec<u32>,
}

impl Neighbours {
    pub fn of(net: &Net) -> Self {
        let seen = |i: usize| {
            net.bonds_of(i).map(|(b, other, owned)| {
                let bond = &net.bonds[b];
                let length = if owned { bond.length } else { -bond.length };
                Neighbour { other: other as u32, bond: b as u32, xi: Vector2::from(bond.normal) * length }
            })
        };
        Neighbours { list: (0..net.len()).flat_map(seen).collect(), starts: net.starts.clone() }
    }

    #[inline(always)]
    pub fn of_point(&self, point: usize) -> &[Neighbour] {
        &self.list[self.starts[point] as usize..self.starts[point + 1] as usize]
    }
}

/// K⁻¹ of all points for the present bonds.
#[derive(Debug, Clone)]
pub struct Shape {
    enters: DamageEntry,
    /// Bonds that count in K and F.
    counts: Vec<bool>,
    bears: Vec<bool>,
    /// K⁻¹, m⁻⁵; `None` where there is none.
    inverse: Vec<Option<Matrix2<f64>>>,
}

impl Shape {
    /// Of the net with its initial cracks.
    pub fn new(net: &Net, neighbours: &Neighbours, enters: DamageEntry) -> Self {
        let mut bears = vec![true; net.bonds.len()];
        net.pre_cut.iter().for_each(|&bond| bears[bond as usize] = false);
        let mut shape = Shape { enters, counts: bears.clone(), bears, inverse: vec![None; net.len()] };
        let all: Vec<u32> = (0..net.len() as u32).collect();
        shape.invert(net, neighbours, &all);
        shape
    }

    /// Takes over which bonds are broken, and works out K⁻¹ anew where that changes it.
    pub fn follow(&mut self, net: &Net, neighbours: &Neighbours, bonds: &BondState) {
        let mut touched = Vec::new();
        for (b, (bears, &share)) in self.bears.iter_mut().zip(&bonds.share).enumerate() {
            let intact = share > 0.0;
            if intact != *bears {
                *bears = intact;
                if self.enters == DamageEntry::Influence {
                    self.counts[b] = intact;
                    touched.extend([net.bonds[b].from, net.bonds[b].to]);
                }
            }
        }
        touched.sort_unstable();
        touched.dedup();
        self.invert(net, neighbours, &touched);
    }

    /// Breaks the last bonds of points without K⁻¹. How many.
    pub fn drop_idle(&self, net: &Net, bonds: &mut BondState) -> usize {
        let idle = |a: u32, b: u32| self.inverse[a as usize].is_none() || self.inverse[b as usize].is_none();
        let mut dropped = 0;
        for ((bond, share), may_fail) in net.bonds.iter().zip(&mut bonds.share).zip(&bonds.may_fail) {
            if *share > 0.0 && *may_fail && idle(bond.from, bond.to) {
                *share = 0.0;
                dropped += 1;
            }
        }
        dropped
    }

    fn invert(&mut self, net: &Net, neighbours: &Neighbours, points: &[u32]) {
        let counts = &self.counts;
        let of_point = |&point: &u32| {
            let own = neighbours.of_point(point as usize).iter().filter(|n| counts[n.bond as usize]);
            let shape: Matrix2<f64> = own.map(|n| net.volumes[n.other as usize] * n.xi * n.xi.transpose()).sum();
            let (det, trace) = (shape.determinant(), shape.trace());
            // Both zero without bonds: not greater.
            if det > SINGULAR * trace * trace { shape.try_inverse() } else { None }
        };
        let inverses: Vec<_> = points.par_iter().with_min_len(256).map(of_point).collect();
        for (&point, inverse) in points.iter().zip(inverses) {
            self.inverse[point as usize] = inverse;
        }
    }

    /// K⁻¹ of a point, m⁻⁵.
    #[inline(always)]
    pub fn inverse(&self, point: usize) -> Option<&Matrix2<f64>> {
        self.inverse[point].as_ref()
    }

    /// Whether a bond counts in K and F.
    #[inline(always)]
    pub fn counts(&self, bond: u32) -> bool {
        self.counts[bond as usize]
    }

    /// Whether a bond bears force.
    #[inline(always)]
    pub fn bears(&self, bond: u32) -> bool {
        self.bears[bond as usize]
    }
}
