//! The secant stiffness of springs on a net, `K(D) = Σ (1-D) (k_n g_n g_nᵀ + k_t g_t g_tᵀ)`, and its sparse Cholesky factor. Pattern
//! and symbolic factorisation are those of the plate with all its bonds and are kept.

use std::sync::Once;

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};

use perilife_base::error::{Error, Result};
use perilife_plate::specimen::Point;
use perilife_points::net::{Net, NetBond};

/// Parts into which factorisations are split, on any machine: how sums are grouped must not depend on its cores.
const PARTS: usize = 4;
/// Shares of the largest diagonal entry that are added to all, so that points and fragments without hold leave the factor
/// definite: the smaller the better it stands for the plate; the larger where round-off leaves no factor with the smaller.
const SHIFTS: [f64; 2] = [1e-13, 1e-10];

/// A spring along one direction between two points that need not have a bond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearSpring {
    pub from: u32,
    pub to: u32,
    /// Unit vector along which it acts.
    pub normal: Point,
    /// Spring, N/m.
    pub stiffness: f64,
}

/// Stiffness between the free unknowns.
pub struct Stiffness {
    /// Row of every unknown; `usize::MAX` where it is held.
    number: Vec<usize>,
    matrix: SparseColMat<usize, f64>,
    /// Places of the entries of every bond in the values of the matrix, in the order of [`Stiffness::entries`].
    slots: Vec<u32>,
    diagonal: Vec<u32>,
    symbolic: SymbolicLlt<usize>,
    factor: Option<Llt<usize, f64>>,
}

impl Stiffness {
    /// Pattern and symbolic factorisation.
    pub fn new(net: &Net, held: &[bool]) -> Result<Self> {
        let mut number = vec![usize::MAX; held.len()];
        let free: Vec<usize> = (0..held.len()).filter(|&i| !held[i]).collect();
        free.iter().enumerate().for_each(|(row, &i)| number[i] = row);
        let mut entries: Vec<Triplet<usize, usize, f64>> = (0..free.len()).map(|i| Triplet::new(i, i, 0.0)).collect();
        for bond in &net.bonds {
            entries.extend(Self::entries(net, &number, bond).map(|(row, column, _)| Triplet::new(row, column, 0.0)));
        }
        let failure = |e: String| Error::Mechanics(format!("the stiffness matrix could not be built: {e}"));
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(free.len(), free.len(), &entries)
            .map_err(|e| failure(format!("{e:?}")))?;
        fix_parts();
        let symbolic = SymbolicLlt::try_new(matrix.symbolic(), faer::Side::Lower).map_err(|e| failure(format!("{e:?}")))?;
        let (columns, rows) = (matrix.symbolic().col_ptr(), matrix.symbolic().row_idx());
        let slot = |row: usize, column: usize| -> u32 {
            let span = columns[column]..columns[column + 1];
            // Every entry asked for stood among the triplets.
            (span.start + rows[span].binary_search(&row).unwrap_or_default()) as u32
        };
        let slots = net.bonds.iter().flat_map(|bond| Self::entries(net, &number, bond)).map(|(row, column, _)| slot(row, column));
        let slots = slots.collect();
        let diagonal = (0..free.len()).map(|i| slot(i, i)).collect();
        Ok(Stiffness { slots, diagonal, number, matrix, symbolic, factor: None })
    }

    /// Factorises the stiffness of the net with these shares of the bonds, and struts between points that the pattern joins.
    /// Errors: a stiffness that is not positive definite.
    pub fn factorise(&mut self, net: &Net, share: &[f64], struts: &[LinearSpring]) -> Result<()> {
        let added: Vec<(usize, f64)> = struts.iter().flat_map(|strut| self.strut_entries(net, strut)).collect();
        let values = self.matrix.val_mut();
        values.fill(0.0);
        let mut slots = self.slots.iter();
        for (bond, &share) in net.bonds.iter().zip(share) {
            for (_, _, value) in Self::entries(net, &self.number, bond) {
                if let Some(&slot) = slots.next() {
                    values[slot as usize] += share * value;
                }
            }
        }
        added.into_iter().for_each(|(slot, value)| values[slot] += value);
        let largest = self.diagonal.iter().map(|&slot| values[slot as usize]).fold(0.0, f64::max);
        let mut added = 0.0;
        let mut failure = None;
        for shift in SHIFTS {
            let values = self.matrix.val_mut();
            self.diagonal.iter().for_each(|&slot| values[slot as usize] += (shift - added) * largest);
            added = shift;
            match Llt::try_new_with_symbolic(self.symbolic.clone(), self.matrix.as_ref(), faer::Side::Lower) {
                Ok(factor) => {
                    self.factor = Some(factor);
                    return Ok(());
                }
                Err(e) => failure = Some(e),
            }
        }
        Err(Error::Mechanics(format!("the stiffness matrix is not positive definite: {failure:?}")))
    }

    /// Places and values of a strut; none where its ends are not joined.
    fn strut_entries(&self, net: &Net, strut: &LinearSpring) -> Vec<(usize, f64)> {
        let (columns, rows) = (self.matrix.symbolic().col_ptr(), self.matrix.symbolic().row_idx());
        let unknown = |i: usize| self.number[[strut.from, strut.to][i / 2] as usize * net.unknowns + i % 2];
        let gradient = |i: usize| [-1.0, 1.0][i / 2] * strut.normal[i % 2];
        let mut entries = Vec::with_capacity(10);
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            let (row, column) = (unknown(i), unknown(j));
            if row == usize::MAX || column == usize::MAX || column > row {
                continue;
            }
            let span = columns[column]..columns[column + 1];
            let Ok(place) = rows[span.clone()].binary_search(&row) else { return Vec::new() };
            entries.push((span.start + place, strut.stiffness * gradient(i) * gradient(j)));
        }
        entries
    }

    /// Applies the inverse of the last factorised stiffness to a vector of all unknowns; 0 where they are held.
    pub fn solve(&self, vector: &[f64], into: &mut [f64]) {
        let Some(factor) = &self.factor else { return };
        let mut column = faer::Mat::<f64>::zeros(self.diagonal.len(), 1);
        for (&row, &value) in self.number.iter().zip(vector).filter(|(row, _)| **row != usize::MAX) {
            column[(row, 0)] = value;
        }
        factor.solve_in_place(column.as_mut());
        for (&row, into) in self.number.iter().zip(into) {
            *into = if row == usize::MAX { 0.0 } else { column[(row, 0)] };
        }
    }

    /// Lower entries of a bond with full share: row, column, value.
    fn entries<'a>(net: &'a Net, number: &'a [usize], bond: &'a NetBond) -> impl Iterator<Item = (usize, usize, f64)> + 'a {
        let unknowns = net.unknowns;
        let (n, t) = (bond.normal, bond.tangent());
        // Gradients of e_n and e_t by the unknowns of owner and partner.
        let normal = [-n[0], -n[1], 0.0, n[0], n[1], 0.0];
        let tangential = [-t[0], -t[1], -bond.lever, t[0], t[1], -bond.lever];
        let ends = [bond.from, bond.to];
        let of = move |i: usize| {
            let (end, component) = (i / unknowns, i % unknowns);
            (number[ends[end] as usize * unknowns + component], 3 * end + component)
        };
        (0..2 * unknowns).flat_map(move |i| (0..2 * unknowns).map(move |j| (of(i), of(j)))).filter_map(
            move |((row, i), (column, j))| {
                let inside = column <= row && row != usize::MAX;
                inside.then(|| (row, column, bond.k_n * normal[i] * normal[j] + bond.k_t * tangential[i] * tangential[j]))
            },
        )
    }
}

/// Makes sparse factorisations split their work into a fixed number of parts; called before every one.
fn fix_parts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| faer::set_global_parallelism(faer::Par::rayon(PARTS)));
}
