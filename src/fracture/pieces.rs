//! Whether the plate still hangs together between its loads and supports.

use super::bonds::BondState;
use super::boundary::Boundary;
use crate::levels::Net;

/// Whether no way of intact bonds leads from the first load to some other load or support.
pub fn is_separated(net: &Net, boundary: &Boundary, bonds: &BondState) -> bool {
    let Some(&start) = boundary.groups.first().and_then(|group| group.points.first()) else { return false };
    let mut reached = vec![false; net.len()];
    let mut open = vec![start as usize];
    reached[start as usize] = true;
    while let Some(point) = open.pop() {
        for (b, other, _) in net.bonds_of(point) {
            if bonds.share[b] > 0.0 && !reached[other] {
                reached[other] = true;
                open.push(other);
            }
        }
    }
    let others = boundary.groups.iter().flat_map(|group| &group.points).chain(boundary.held.iter().map(|held| &held.point));
    others.into_iter().any(|&point| !reached[point as usize])
}
