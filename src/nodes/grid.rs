//! Background cells: a lattice of squares over the plate, halved again and again where something asks for finer nodes.
//!
//! A cell of size s is halved where a source that asks for less lies within `reach` s of its middle. Each level then has a ring of
//! its own around the source, and neighbours differ by one level wherever `reach` is two or more.

use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::distance;

/// Levels at the most: kinks of a thousandth of the far spacing.
pub const LEVELS_MAX: u32 = 14;

/// Distance from a border of cells that is none, in sizes of the largest.
const ON_BORDER: f64 = 1e-9;

/// A place that asks for a spacing: a point, or a circle of `radius` around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Point or centre, m.
    pub at: Point,
    /// Radius of the circle, m; 0 of a point.
    pub radius: f64,
    /// Spacing asked for, m.
    pub spacing: f64,
    /// Distance in sizes of a cell within which it is halved.
    pub reach: f64,
}

impl Source {
    pub fn point(at: Point, spacing: f64, reach: f64) -> Self {
        Source { at, radius: 0.0, spacing, reach }
    }

    fn divides(&self, middle: Point, size: f64) -> bool {
        // Cells on the limit are within, on both sides of a source alike.
        let away = (distance(middle, self.at) - self.radius).abs();
        self.spacing < size * (1.0 - ON_BORDER) && away < self.reach * size * (1.0 + ON_BORDER)
    }
}

/// A cell, whole or halved.
#[derive(Debug, Clone, Copy)]
struct Cell {
    level: u32,
    /// Column and row among cells of its level.
    place: [i64; 2],
    /// The first of its four children, which follow one another; none of a leaf.
    children: Option<u32>,
}

/// Cells of all levels.
#[derive(Debug, Clone)]
pub struct Grid {
    low: Point,
    size: [f64; 2],
    count: [i64; 2],
    cells: Vec<Cell>,
}

impl Grid {
    /// Cells over the box from `low` to `high`, m, of about the size `far`, halved as the sources ask and until neighbors differ by one level; no
    /// more than `most` are halved again.
    pub fn new([low, high]: [Point; 2], far: f64, sources: &[Source], most: usize) -> Self {
        let count = [0, 1].map(|i| ((high[i] - low[i]) / far).round().max(2.0) as i64);
        let size = [0, 1].map(|i| (high[i] - low[i]) / count[i] as f64);
        let roots = (0..count[1]).flat_map(|row| (0..count[0]).map(move |column| [column, row]));
        let cells = roots.map(|place| Cell { level: 0, place, children: None }).collect();
        let mut grid = Grid { low, size, count, cells };
        let mut next = 0;
        // What halves a cell has halved the one that it is of, since no reach is less than one: of every halved cell its sources, all first.
        let mut sources_of: Vec<Vec<u32>> = vec![(0..sources.len() as u32).collect()];
        let mut parents = vec![0; grid.cells.len()];
        while next < grid.cells.len() && grid.cells.len() <= most {
            let level = grid.cells[next].level;
            let (middle, spacing) = (grid.middle(next), grid.spacing(next));
            let divides = |source: &&u32| level < LEVELS_MAX && sources[**source as usize].divides(middle, spacing);
            let dividing: Vec<u32> = sources_of[parents[next]].iter().filter(divides).copied().collect();
            if !dividing.is_empty() {
                parents.extend([sources_of.len(); 4]);
                sources_of.push(dividing);
                grid.halve(next);
            }
            next += 1;
        }
        grid.balance(most);
        grid
    }

    fn halve(&mut self, cell: usize) {
        let Cell { level, place, .. } = self.cells[cell];
        self.cells[cell].children = Some(self.cells.len() as u32);
        for [x, y] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            self.cells.push(Cell { level: level + 1, place: [2 * place[0] + x, 2 * place[1] + y], children: None });
        }
    }

    /// Halves leaves beside one of less than half their size: a patch of fine cells in coarse ones is too soft, and flanks that press on it get a
    /// fifth less.
    fn balance(&mut self, most: usize) {
        let mut pending: Vec<usize> = self.leaves().collect();
        while let Some(cell) = pending.pop().filter(|_| self.cells.len() <= most) {
            let ([x, y], level) = (self.middle(cell), self.cells[cell].level);
            let size = self.size.map(|size| size / f64::from(1_u32 << level));
            for [i, j] in [[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]] {
                loop {
                    // Beyond the box it is the cell itself.
                    let other = self.leaf([x + i * size[0], y + j * size[1]]);
                    if self.cells[other].level + 1 >= level {
                        break;
                    }
                    let children = self.cells.len();
                    self.halve(other);
                    pending.extend(children..children + 4);
                }
            }
        }
    }

    /// All cells that are not halved.
    pub fn leaves(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.cells.len()).filter(|&cell| self.cells[cell].children.is_none())
    }

    /// Number of cells, halved ones included.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Larger side of a cell, m.
    pub fn spacing(&self, cell: usize) -> f64 {
        self.size[0].max(self.size[1]) / f64::from(1_u32 << self.cells[cell].level)
    }

    /// Lower left and upper right corner of a cell, m.
    pub fn bounds(&self, cell: usize) -> [Point; 2] {
        let Cell { level, place, .. } = self.cells[cell];
        let corner =
            |more: i64| [0, 1].map(|i| self.low[i] + self.size[i] * (place[i] + more) as f64 / f64::from(1_u32 << level));
        [corner(0), corner(1)]
    }

    /// Middle of a cell, m.
    pub fn middle(&self, cell: usize) -> Point {
        let [low, high] = self.bounds(cell);
        [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])]
    }

    /// Corners of a cell as columns and rows of the finest lattice that there can be, counter-clockwise.
    pub fn corners(&self, cell: usize) -> [[i64; 2]; 4] {
        let Cell { level, place, .. } = self.cells[cell];
        [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[x, y]| [place[0] + x, place[1] + y].map(|at| at << (LEVELS_MAX - level)))
    }

    /// Position of a place of that lattice, m.
    pub fn position(&self, corner: [i64; 2]) -> Point {
        [0, 1].map(|i| self.low[i] + self.size[i] * corner[i] as f64 / f64::from(1_u32 << LEVELS_MAX))
    }

    /// The leaf that a point lies in, or the nearest one of a point beyond.
    pub fn leaf(&self, at: Point) -> usize {
        let share = [0, 1].map(|i| ((at[i] - self.low[i]) / self.size[i]).clamp(0.0, self.count[i] as f64 * (1.0 - 1e-12)));
        let place = share.map(|share| share.floor() as i64);
        let mut cell = (place[1] * self.count[0] + place[0]) as usize;
        while let Some(children) = self.cells[cell].children {
            let middle = self.middle(cell);
            cell = children as usize + usize::from(at[0] >= middle[0]) + 2 * usize::from(at[1] >= middle[1]);
        }
        cell
    }

    /// Spacing at a point, on a border that of the finest leaf there: the same at its image in a plate that is its own.
    pub fn finest(&self, at: Point) -> f64 {
        self.around(at).into_iter().fold(f64::INFINITY, f64::min)
    }

    /// The same of the coarsest leaf.
    pub fn coarsest(&self, at: Point) -> f64 {
        self.around(at).into_iter().fold(0.0, f64::max)
    }

    /// Spacings of the leaves that meet at a point.
    fn around(&self, at: Point) -> [f64; 4] {
        let beside = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
        let at = |signs: [f64; 2]| [0, 1].map(|i| at[i] + signs[i] * ON_BORDER * self.size[i]);
        beside.map(|signs| self.spacing(self.leaf(at(signs))))
    }

    /// Calls `visit` with every leaf that meets the box from `low` to `high`, m.
    pub fn visit(&self, low: Point, high: Point, visit: &mut impl FnMut(usize)) {
        let first = [0, 1].map(|i| (((low[i] - self.low[i]) / self.size[i]).floor() as i64).clamp(0, self.count[i] - 1));
        let last = [0, 1].map(|i| (((high[i] - self.low[i]) / self.size[i]).floor() as i64).clamp(0, self.count[i] - 1));
        for row in first[1]..=last[1] {
            for column in first[0]..=last[0] {
                self.descend((row * self.count[0] + column) as usize, low, high, visit);
            }
        }
    }

    fn descend(&self, cell: usize, low: Point, high: Point, visit: &mut impl FnMut(usize)) {
        let [from, to] = self.bounds(cell);
        if (0..2).any(|i| from[i] > high[i] || to[i] < low[i]) {
            return;
        }
        match self.cells[cell].children {
            None => visit(cell),
            Some(children) => (0..4).for_each(|child| self.descend(children as usize + child, low, high, visit)),
        }
    }
}
