//! Symmetric matrices: dense ones of the unknowns in reach of a cell, and their sum.

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// A symmetric matrix of some unknowns.
#[derive(Debug, Clone, Default)]
pub struct Element {
    /// Unknowns, ascending.
    pub unknowns: Vec<u32>,
    /// Columns; what is above the diagonal does not count.
    pub columns: Vec<f64>,
}

impl Element {
    /// `factor v vᵀ` of these unknowns in ascending order.
    #[must_use]
    pub fn square(unknowns: Vec<u32>, v: &[f64], factor: f64) -> Self {
        let columns = v.iter().flat_map(|a| v.iter().map(move |b| factor * a * b)).collect();
        Element { unknowns, columns }
    }

    /// Becomes `Aᵀ B`, of rows of strains and stresses that follow one another.
    pub(super) fn take_product(&mut self, strains: &[f64], stresses: &[f64]) {
        let n = self.unknowns.len();
        self.columns.resize(n * n, 0.0);
        if n == 0 {
            return;
        }
        let rows = strains.len() / n;
        let strains = MatRef::from_row_major_slice(strains, rows, n);
        let stresses = MatRef::from_row_major_slice(stresses, rows, n);
        triangular::matmul(
            MatMut::from_column_major_slice_mut(&mut self.columns, n, n),
            BlockStructure::TriangularLower,
            Accum::Replace,
            strains.transpose(),
            BlockStructure::Rectangular,
            stresses,
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
    }
}

/// A symmetric matrix by the lower triangle of its columns.
#[derive(Debug, Clone, Default)]
pub struct Lower {
    /// Where columns begin.
    pub starts: Vec<usize>,
    /// Rows, ascending in each.
    pub rows: Vec<usize>,
    /// Values.
    pub values: Vec<f64>,
}

/// The sum of elements as one matrix of `unknowns` columns.
#[must_use]
pub fn gathered(elements: &[&Element], unknowns: usize) -> Lower {
    let mut counts = vec![0_u32; unknowns + 1];
    elements.iter().flat_map(|element| &element.unknowns).for_each(|&unknown| counts[unknown as usize + 1] += 1);
    for k in 0..unknowns {
        counts[k + 1] += counts[k];
    }
    let mut places = vec![(0_u32, 0_u32); counts[unknowns] as usize];
    let mut next = counts.clone();
    for (index, element) in elements.iter().enumerate() {
        for (column, &unknown) in element.unknowns.iter().enumerate() {
            let place = &mut next[unknown as usize];
            places[*place as usize] = (index as u32, column as u32);
            *place += 1;
        }
    }
    let column = |(sums, seen): &mut (Vec<f64>, Vec<u32>), unknown: usize| {
        for &(index, column) in &places[counts[unknown] as usize..counts[unknown + 1] as usize] {
            let element = &elements[index as usize];
            let (column, n) = (column as usize, element.unknowns.len());
            let values = &element.columns[column * n + column..(column + 1) * n];
            for (&row, &value) in element.unknowns[column..].iter().zip(values) {
                if sums[row as usize].is_nan() {
                    sums[row as usize] = 0.0;
                    seen.push(row);
                }
                sums[row as usize] += value;
            }
        }
        seen.sort_unstable();
        let of_column: Vec<(usize, f64)> = seen.iter().map(|&row| (row as usize, sums[row as usize])).collect();
        seen.drain(..).for_each(|row| sums[row as usize] = f64::NAN);
        of_column
    };
    let columns: Vec<Vec<(usize, f64)>> =
        (0..unknowns).into_par_iter().map_init(|| (vec![f64::NAN; unknowns], Vec::new()), column).collect();
    let mut lower = Lower { starts: vec![0], ..Lower::default() };
    for column in columns {
        lower.rows.extend(column.iter().map(|entry| entry.0));
        lower.values.extend(column.iter().map(|entry| entry.1));
        lower.starts.push(lower.rows.len());
    }
    lower
}
