//! All that changes in a run. Each part has one writer: displacement the solver, bonds and their life `fatigue`,
//! cycles `predict`.

use std::ops::Range;

use crate::body::lattice::LANES;
use crate::body::{Body, Bond};

/// Which bonds still carry, in the form the stiffness product needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Bonds {
    /// Current stiffness multiplier of every bond; 0 = absent or broken.
    pub multiplier: Vec<f32>,
    /// Whether all bonds of all points of a chunk of [`LANES`] places are interior and intact (row by row).
    pub regular: Vec<bool>,
    pub(crate) chunks: usize,
    /// For every row the chunks that hold points: of a plate that lies turned on its lattice half of them hold none.
    inhabited: Vec<Range<usize>>,
}

impl Bonds {
    /// Bonds of the plate with its initial cracks cut.
    #[inline]
    pub fn new(body: &Body) -> Self {
        let mut bonds = Bonds::with_multipliers(body, body.multiplier.clone());
        for &bond in &body.pre_cut {
            bonds.cut(body, bond);
        }
        bonds
    }

    /// Bonds with these multipliers.
    pub fn with_multipliers(body: &Body, multiplier: Vec<f32>) -> Self {
        let chunks = body.lattice.columns.div_ceil(LANES);
        let regular = vec![false; chunks * body.lattice.rows];
        let mut bonds = Bonds { multiplier, regular, chunks, inhabited: vec![0..0; body.lattice.rows] };
        for &place in &body.points {
            let (column, row) = body.lattice.column_row(place as usize);
            let (chunk, range) = (column / LANES, &mut bonds.inhabited[row]);
            *range = if range.start == range.end { chunk..chunk + 1 } else { range.start.min(chunk)..range.end.max(chunk + 1) };
        }
        for row in 0..body.lattice.rows {
            for chunk in 0..chunks {
                bonds.regular[row * chunks + chunk] = bonds.is_regular(body, body.lattice.place(chunk * LANES, row));
            }
        }
        bonds
    }

    /// Bonds of the body that are cut, ascending.
    #[inline]
    pub fn broken(&self, body: &Body) -> Vec<Bond> {
        let is_broken = |bond: Bond| body.multiplier[bond as usize] > 0.0 && !self.is_intact(bond);
        (0..body.multiplier.len()).map(|bond| bond as Bond).filter(|&bond| is_broken(bond)).collect()
    }

    /// Bonds of the body that carry by another multiplier than its own, ascending, with theirs.
    #[inline]
    pub fn scaled(&self, body: &Body) -> Vec<(Bond, f32)> {
        let both = self.multiplier.iter().zip(&body.multiplier).enumerate();
        both.filter(|(_, (now, whole))| **now > 0.0 && now != whole).map(|(bond, (now, _))| (bond as Bond, *now)).collect()
    }

    fn is_regular(&self, body: &Body, first: usize) -> bool {
        (first..first + LANES).all(|place| body.around(place).all(|(.., bond, _)| self.multiplier[bond] == 1.0))
    }

    /// Whether the chunk that starts at column `chunk x LANES` of a row is regular.
    #[inline]
    pub fn chunk_is_regular(&self, row: usize, chunk: usize) -> bool {
        self.regular[row * self.chunks + chunk]
    }

    /// Chunks of a row from the first to the last one that holds points.
    #[inline]
    pub fn inhabited(&self, row: usize) -> Range<usize> {
        self.inhabited[row].clone()
    }

    /// Whether a bond carries.
    #[inline]
    pub fn is_intact(&self, bond: Bond) -> bool {
        self.multiplier[bond as usize] > 0.0
    }

    /// Breaks a bond for good.
    #[inline]
    pub fn cut(&mut self, body: &Body, bond: Bond) {
        self.set(body, bond, 0.0);
    }

    /// Gives a bond another multiplier.
    #[inline]
    pub fn set(&mut self, body: &Body, bond: Bond, multiplier: f32) {
        self.multiplier[bond as usize] = multiplier;
        let (_, from, to) = body.ends(bond);
        // A mirror image's row of the stiffness is nowhere.
        for place in [from, to].into_iter().filter(|&place| body.is_point[place]) {
            let (column, row) = body.lattice.column_row(place);
            self.regular[row * self.chunks + column / LANES] = false;
        }
    }

    /// Intact bonds of a point, as [`Body::around`] has them.
    #[inline]
    pub fn at<'a>(&'a self, body: &'a Body, place: usize) -> impl Iterator<Item = (usize, f64, usize, usize)> + 'a {
        body.around(place).filter(move |(.., bond, _)| self.multiplier[*bond] > 0.0)
    }

    /// Number of intact bonds of a point.
    pub fn intact_at(&self, body: &Body, place: usize) -> usize {
        self.at(body, place).count()
    }
}
