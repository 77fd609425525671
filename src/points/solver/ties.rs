//! Sums of displacements that are held at given values, such as the edge of a grip: `Σ w_i·u_i = v`.
//!
//! Every one is solved for one of its unknowns, the slave, whose weight is the largest that is left (Gauss-Jordan elimination):
//! `u = T m + g` with the masters m, and `Tᵀ K T m = -Tᵀ K g`. The weights are the shares of a force on the rim
//! ([`crate::body::sharing`]), so that the forces of the grip are what tractions on it would be: uniform strain stays in equilibrium. A
//! preconditioner sees the slaves as held at rest, which differs from T in the rows next to the edge alone.

use std::collections::{BTreeMap, HashMap};

use super::field::Layout;
use crate::body::Body;

/// Weight over the largest of a sum below which it is round-off.
const ROUND_OFF: f64 = 1e-9;
/// The same of what is left of a sum below which the others hold it already.
const LEAST: f64 = 0.02;

/// `u_slave = value + Σ factor u_master`.
#[derive(Debug, Clone)]
struct TieRow {
    slave: usize,
    value: f64,
    masters: Vec<(usize, f64)>,
}

/// Held sums of a body.
#[derive(Debug, Clone, Default)]
pub struct Ties {
    rows: Vec<TieRow>,
}

impl Ties {
    /// Those of a body whose `fixed` unknowns, ascending, are held at rest, at a displacement of the load of one spacing.
    pub(super) fn of(body: &Body, layout: &Layout, fixed: &[usize]) -> Self {
        let mut rows: Vec<(usize, f64, BTreeMap<usize, f64>)> = Vec::new();
        let mut row_of: HashMap<usize, usize> = HashMap::new();
        for tie in &body.boundary.ties {
            let of_place = |&(place, weights): &(u32, [f64; 2])| {
                let at = layout.index(place as usize);
                [(at, weights[0]), (at + layout.stride, weights[1])]
            };
            let is_free = |(index, weight): &(usize, f64)| *weight != 0.0 && fixed.binary_search(index).is_err();
            let mut left: BTreeMap<usize, f64> = tie.weights.iter().flat_map(of_place).filter(is_free).collect();
            let mut value = tie.way * body.lattice.spacing;
            let largest = left.values().fold(0.0_f64, |most, weight| most.max(weight.abs()));
            let known: Vec<usize> = left.keys().filter_map(|index| row_of.get(index).copied()).collect();
            for row in known {
                let (slave, its_value, weights) = &rows[row];
                let Some(factor) = left.remove(slave) else { continue };
                value -= factor * its_value;
                subtract(&mut left, factor, weights);
            }
            let pivot = left.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()).then(b.0.cmp(a.0)));
            let Some((&slave, &weight)) = pivot.filter(|(_, weight)| weight.abs() > LEAST * largest) else { continue };
            left.remove(&slave);
            value /= weight;
            left.values_mut().for_each(|other| *other /= weight);
            for (_, its_value, weights) in &mut rows {
                if let Some(factor) = weights.remove(&slave) {
                    *its_value -= factor * value;
                    subtract(weights, factor, &left);
                }
            }
            row_of.insert(slave, rows.len());
            rows.push((slave, value, left));
        }
        let solved = |(slave, value, weights): (usize, f64, BTreeMap<usize, f64>)| {
            let masters = weights.into_iter().map(|(index, weight)| (index, -weight)).collect();
            TieRow { slave, value, masters }
        };
        Ties { rows: rows.into_iter().map(solved).collect() }
    }

    /// Unknowns that the others determine.
    pub(super) fn slaves(&self) -> impl Iterator<Item = usize> + '_ {
        self.rows.iter().map(|row| row.slave)
    }

    /// The held values at the slaves, zero elsewhere: g.
    pub(super) fn held(&self, layout: &Layout) -> Vec<f64> {
        let mut field = layout.zeros();
        self.rows.iter().for_each(|row| field[row.slave] = row.value);
        field
    }

    /// x = T m.
    pub(super) fn spread(&self, x: &mut [f64]) {
        for row in &self.rows {
            x[row.slave] = row.masters.iter().map(|&(master, factor)| factor * x[master]).sum();
        }
    }

    /// Tᵀ y at the masters.
    pub(super) fn fold(&self, y: &mut [f64]) {
        for row in &self.rows {
            let force = y[row.slave];
            row.masters.iter().for_each(|&(master, factor)| y[master] += factor * force);
        }
    }
}

/// Subtracts a multiple of weights and leaves out what is round-off beside a pivot of 1.
fn subtract(from: &mut BTreeMap<usize, f64>, factor: f64, weights: &BTreeMap<usize, f64>) {
    for (&index, weight) in weights {
        let sum = from.entry(index).or_insert(0.0);
        *sum -= factor * weight;
        if sum.abs() < ROUND_OFF {
            from.remove(&index);
        }
    }
}
