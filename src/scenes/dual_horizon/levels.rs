//! Points of several levels: places of nested lattices, every level with half the spacing of the one before.

use super::regions::Area;
use perilife_base::error::{Result, fail_if, input};
use perilife_plate::specimen::{Point, Specimen};
use perilife_points::body::lattice::{Lattice, ON_RIM};

/// Places of the finest lattice at the most.
const PLACES_MAX: usize = 100_000_000;
/// Round-off of a distance against a horizon.
const ROUND_OFF: f64 = 1e-9;

/// A point: level, column and row on the lattice of that level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Leaf {
    /// Level, 0 the coarsest.
    pub level: usize,
    pub column: usize,
    pub row: usize,
}

/// Lattices of all levels and the points on them.
#[derive(Debug, Clone)]
pub struct Levels {
    /// Lattices, coarsest first.
    pub lattices: Vec<Lattice>,
    /// Points: coarse places row by row, the parts of a place together.
    pub leaves: Vec<Leaf>,
    /// Points split in regions: for every level, how many of its points were split because a region asks for it, and how many
    /// more so that levels within a horizon differ by one at the most.
    pub splits: Vec<[usize; 2]>,
    /// Number of the point at every place of every level.
    number: Vec<Vec<u32>>,
}

/// What no point has as number.
const NONE: u32 = u32::MAX;

impl Levels {
    /// Splits the places of a lattice in four where areas ask for it, as often as they ask for it, and around that so often that
    /// no horizon (`ratio` × own spacing) reaches over more than one level: rings as wide as the horizon of the coarser level.
    /// Errors: an area without points, more places than memory can sensibly hold.
    pub fn over(specimen: &Specimen, lattice: Lattice, areas: &[Area<'_>], ratio: f64) -> Result<Levels> {
        let deepest = areas.iter().map(|area| area.levels).max().unwrap_or(0);
        let mut lattices = vec![lattice];
        for level in 0..deepest {
            let next = lattices[level].halved();
            if next.columns * next.rows > PLACES_MAX {
                let problem = format!("needs {:.0} million points", (next.columns * next.rows) as f64 / 1e6);
                return Err(input("refinement.regions", format!("levels = {deepest}"), problem, "give fewer levels"));
            }
            lattices.push(next);
        }
        let mut split = asked(&lattices, areas, deepest);
        let before = split.clone();
        grade(&lattices, &mut split, ratio);
        let mut levels = Levels {
            number: lattices.iter().map(|lattice| vec![NONE; lattice.columns * lattice.rows]).collect(),
            lattices,
            leaves: Vec::new(),
            splits: vec![[0; 2]; deepest],
        };
        for row in 0..levels.lattices[0].rows {
            for column in 0..levels.lattices[0].columns {
                levels.grow(specimen, &split, Leaf { level: 0, column, row });
            }
        }
        for (level, (split, before)) in split.iter().zip(&before).enumerate() {
            let lattice = &levels.lattices[level];
            let inside = |place: usize| {
                let at = position(lattice, place % lattice.columns, place / lattice.columns);
                specimen.has_point_at(at, ON_RIM * lattice.spacing)
            };
            for place in (0..split.len()).filter(|&place| split[place] && inside(place)) {
                levels.splits[level][usize::from(!before[place])] += 1;
            }
        }
        for area in areas {
            let asked = levels.leaves.iter().any(|&leaf| leaf.level >= area.levels && area.holds(levels.position(leaf)));
            fail_if!(!asked, area.refusal("contains no point of the plate", "move it onto the plate, or make it wider"));
        }
        Ok(levels)
    }

    /// Adds the points of a place: itself, or those of its four parts.
    fn grow(&mut self, specimen: &Specimen, split: &[Vec<bool>], leaf: Leaf) {
        let Leaf { level, column, row } = leaf;
        let columns = self.lattices[level].columns;
        if split.get(level).is_some_and(|split| split[row * columns + column]) {
            for (y, x) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                self.grow(specimen, split, Leaf { level: level + 1, column: 2 * column + x, row: 2 * row + y });
            }
        } else if specimen.has_point_at(self.position(leaf), ON_RIM * self.lattices[level].spacing) {
            self.number[level][row * columns + column] = self.leaves.len() as u32;
            self.leaves.push(leaf);
        }
    }

    pub fn finest(&self) -> &Lattice {
        &self.lattices[self.lattices.len() - 1]
    }

    /// Place of a point, m.
    pub fn position(&self, leaf: Leaf) -> Point {
        position(&self.lattices[leaf.level], leaf.column, leaf.row)
    }

    /// The point at a place of a level; columns and rows may lie outside.
    pub fn point_at(&self, level: usize, column: i64, row: i64) -> Option<usize> {
        let lattice = &self.lattices[level];
        let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
        if column >= lattice.columns || row >= lattice.rows {
            return None;
        }
        let number = self.number[level][row * lattice.columns + column];
        (number != NONE).then_some(number as usize)
    }

    /// The point whose cell a place of the finest level lies in.
    pub fn point_over(&self, column: i64, row: i64) -> Option<usize> {
        let finest = self.lattices.len() - 1;
        (0..=finest).find_map(|up| self.point_at(finest - up, column >> up, row >> up))
    }

    /// Middle of a point's cell in halves of the finest spacing, which are whole numbers.
    pub fn halves(&self, leaf: Leaf) -> [i64; 2] {
        let up = self.lattices.len() - 1 - leaf.level;
        [leaf.column, leaf.row].map(|i| (2 * i as i64 + 1) << up)
    }
}

fn position(lattice: &Lattice, column: usize, row: usize) -> Point {
    lattice.position_of(column as f64, row as f64)
}

/// Places of every level but the last that an area wants split.
fn asked(lattices: &[Lattice], areas: &[Area<'_>], deepest: usize) -> Vec<Vec<bool>> {
    let of_level = |level: usize| {
        let lattice = &lattices[level];
        let wanted = |place: usize| {
            let at = position(lattice, place % lattice.columns, place / lattice.columns);
            areas.iter().any(|area| area.levels > level && area.holds(at))
        };
        (0..lattice.columns * lattice.rows).map(wanted).collect()
    };
    (0..deepest).map(of_level).collect()
}

/// Splits more places, from the finest level up: those of level l - 1 whose horizon reaches a point of level l + 1.
fn grade(lattices: &[Lattice], split: &mut [Vec<bool>], ratio: f64) {
    for level in (1..split.len()).rev() {
        let (columns, rows) = (lattices[level].columns as i64, lattices[level].rows as i64);
        let reach = ratio.ceil() as i64 + 1;
        for place in (0..split[level].len()).filter(|&place| split[level][place]).collect::<Vec<_>>() {
            let (column, row) = (place as i64 % columns, place as i64 / columns);
            // In spacings of level l - 1, counted from the corner of the lattice: middle of the place, distance to it from a
            // middle, less the half width at which the parts of the place have their middles.
            let at = [column, row].map(|i| 0.5 * (i as f64 + 0.5));
            let away = |i: i64, at: f64| ((i as f64 + 0.5 - at).abs() - 0.125).max(0.0);
            for r in (row / 2 - reach).max(0)..(row / 2 + reach + 1).min(rows / 2) {
                for c in (column / 2 - reach).max(0)..(column / 2 + reach + 1).min(columns / 2) {
                    if away(c, at[0]).hypot(away(r, at[1])) <= ratio * (1.0 + ROUND_OFF) {
                        split[level - 1][(r * (columns / 2) + c) as usize] = true;
                    }
                }
            }
        }
    }
}
