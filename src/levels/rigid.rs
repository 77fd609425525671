//! Least supports of a plate that floats: components which, held, take its rigid motions and no load.

use super::Net;
use crate::specimen::geometry::distance;

/// A component that holds a rigid motion: its row `[u_x, u_y, ω]`, lengths over the size of the plate.
type Row = [f64; 3];

/// Unknowns to be held besides those that are, at two distant points. A law whose tangential springs resist rotation does
/// not turn freely.
#[must_use]
pub fn minimal_constraints(net: &Net, held: &[bool]) -> Vec<usize> {
    let carrying: Vec<usize> = (0..net.len()).filter(|&i| net.bonds_of(i).next().is_some()).collect();
    let Some(&first) = carrying.first() else { return Vec::new() };
    let away = |i: usize| distance(net.positions[i], net.positions[first]);
    let far = carrying.iter().copied().max_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(first);
    let row = |unknown: usize| -> Row {
        let (point, component) = (unknown / net.unknowns, unknown % net.unknowns);
        let arm = [0, 1].map(|c| (net.positions[point][c] - net.positions[first][c]) / away(far).max(f64::MIN_POSITIVE));
        [[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]]][component]
    };
    let mut basis: Vec<Row> = Vec::new();
    if net.unknowns == 2 && net.bonds.iter().any(|bond| bond.k_t != 0.0) {
        basis.push([0.0, 0.0, 1.0]);
    }
    for i in (0..held.len()).filter(|&i| held[i] && i % net.unknowns < 2) {
        add(&mut basis, row(i));
        if basis.len() == 3 {
            return Vec::new();
        }
    }
    let candidates = [first, far].into_iter().flat_map(|point| [0, 1].map(|c| point * net.unknowns + c));
    candidates.filter(|&unknown| add(&mut basis, row(unknown))).collect()
}

/// Adds what is new in a row to an orthonormal basis; whether there was something.
fn add(basis: &mut Vec<Row>, mut row: Row) -> bool {
    for known in basis.iter() {
        let along: f64 = row.iter().zip(known).map(|(a, b)| a * b).sum();
        row.iter_mut().zip(known).for_each(|(a, b)| *a -= along * b);
    }
    let size = row.iter().map(|a| a * a).sum::<f64>().sqrt();
    let is_new = size > 1e-6;
    if is_new {
        basis.push(row.map(|a| a / size));
    }
    is_new
}
