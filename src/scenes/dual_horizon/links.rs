//! Bonds between points of several levels, as each point's own lattice of every level finds them.

use super::levels::{Leaf, Levels};
use perilife_plate::specimen::{Point, Specimen};
use perilife_points::body::obstacles::Obstacles;
use perilife_points::bond_law::stencil::Stencil;
use perilife_points::net::NetBond;

/// Relative round-off of a distance against a horizon.
const ROUND_OFF: f64 = 1e-12;
/// Stiffness over that of the strongest bond of the level that is none.
const NO_STIFFNESS: f64 = 1e-9;
/// Share of the micromodulus at its owner's horizon that a bond to a point of another level has; the dual bond has the other half.
const DUAL_SHARE: f64 = 0.5;

/// What bonds follow from.
pub struct Linking<'a> {
    pub levels: &'a Levels,
    /// Bonds and springs of the lattice of every level.
    pub stencils: &'a [Stencil],
    /// Positions of the points, m.
    pub positions: &'a [Point],
    /// Voids as every level sees them.
    obstacles: Vec<Obstacles<'a>>,
    /// Strongest spring of a level, N/m.
    strongest: Vec<f64>,
    /// Length by which rotations are scaled, m.
    rotation_length: f64,
}

impl<'a> Linking<'a> {
    /// Bonds of a specimen's points.
    pub fn new(specimen: &'a Specimen, levels: &'a Levels, stencils: &'a [Stencil], positions: &'a [Point]) -> Self {
        let obstacles = stencils.iter().map(|s| Obstacles::of(specimen, s.spacing, s.horizon)).collect();
        let strongest = stencils.iter().map(|s| s.bonds.iter().fold(0.0, |k: f64, bond| k.max(bond.k_n))).collect();
        Linking { levels, stencils, positions, obstacles, strongest, rotation_length: stencils[0].spacing }
    }

    /// Bonds between points of one level, each pair once.
    pub fn within_levels(&self) -> Vec<NetBond> {
        let mut bonds = Vec::new();
        for (i, leaf) in self.levels.leaves.iter().enumerate() {
            let (lattice, stencil) = (&self.levels.lattices[leaf.level], &self.stencils[leaf.level]);
            let near = self.obstacles[leaf.level].near(self.positions[i]);
            for bond in &stencil.bonds {
                let at = [leaf.column as i64 + i64::from(bond.dx), leaf.row as i64 + i64::from(bond.dy)];
                let Some(other) = self.levels.point_at(leaf.level, at[0], at[1]) else { continue };
                if near && self.obstacles[leaf.level].block(self.positions[i], self.positions[other]) {
                    continue;
                }
                bonds.push(NetBond {
                    from: i as u32,
                    to: other as u32,
                    length: bond.length,
                    normal: lattice.from_axes(bond.normal),
                    k_n: bond.k_n,
                    k_t: bond.k_t,
                    lever: 0.5 * bond.length / self.rotation_length,
                });
            }
        }
        bonds
    }

    /// Bonds from every point to those of the next coarser and the next finer level in its own horizon.
    pub fn across_levels(&self) -> Vec<NetBond> {
        let mut bonds = Vec::new();
        for (i, &leaf) in self.levels.leaves.iter().enumerate() {
            for level in [leaf.level.wrapping_sub(1), leaf.level + 1] {
                if level < self.levels.lattices.len() {
                    self.reach(i, leaf, level, &mut bonds);
                }
            }
        }
        bonds
    }

    /// Bonds of one point to those of another level.
    fn reach(&self, i: usize, leaf: Leaf, level: usize, bonds: &mut Vec<NetBond>) {
        let (lattice, stencil) = (&self.levels.lattices[level], &self.stencils[leaf.level]);
        let finest = self.levels.lattices.len() - 1;
        // Whole numbers of half the finest spacing, so that the pair and its mirror image have the same length to the last digit.
        let half = 0.5 * self.levels.lattices[finest].spacing;
        let width = 2_i64 << (finest - level);
        let here = self.levels.halves(leaf);
        let away = (stencil.horizon * (1.0 + ROUND_OFF) / half).floor() as i64;
        let range = |at: i64| (at - away).div_euclid(width) - 1..=(at + away).div_euclid(width) + 1;
        let near = self.obstacles[leaf.level].near(self.positions[i]);
        let walls = &self.obstacles[leaf.level.max(level)];
        // Springs are those to a volume like the own one.
        let volume = (lattice.spacing / stencil.spacing).powi(2);
        for row in range(here[1]) {
            for column in range(here[0]) {
                let Some(other) = self.levels.point_at(level, column, row) else { continue };
                let there = [column, row].map(|i| i * width + width / 2);
                let step = [0, 1].map(|axis| (there[axis] - here[axis]) as f64);
                let steps = step[0].hypot(step[1]);
                let (length, normal) = (steps * half, step.map(|s| s / steps));
                if length > stencil.horizon * (1.0 + ROUND_OFF) || (near && walls.block(self.positions[i], self.positions[other]))
                {
                    continue;
                }
                let [k_n, k_t] = stencil.spring(length, normal, lattice.spacing).map(|k| DUAL_SHARE * volume * k);
                if k_n > NO_STIFFNESS * self.strongest[leaf.level] {
                    bonds.push(NetBond {
                        from: i as u32,
                        to: other as u32,
                        length,
                        normal: lattice.from_axes(normal),
                        k_n,
                        k_t,
                        lever: 0.5 * length / self.rotation_length,
                    });
                }
            }
        }
    }
}
