//! The bonds of every point as it sees them: a compact copy of the net's lists for sums over neighbourhoods.

use nalgebra::Vector2;

use crate::levels::Net;

/// A bond seen from one of its ends.
#[derive(Debug, Clone, Copy)]
pub struct Neighbour {
    /// Other end.
    pub other: u32,
    /// Bond of the net.
    pub bond: u32,
    /// ξ from this end to the other, m.
    pub xi: Vector2<f64>,
}

/// Bonds by points.
#[derive(Debug, Clone)]
pub struct Neighbours {
    list: Vec<Neighbour>,
    starts: Vec<u32>,
}

impl Neighbours {
    /// Lists of a net.
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

    /// Bonds of a point.
    #[inline(always)]
    pub fn of_point(&self, point: usize) -> &[Neighbour] {
        &self.list[self.starts[point] as usize..self.starts[point + 1] as usize]
    }
}
