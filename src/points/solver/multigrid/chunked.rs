//! What stands at the chunks of a level: mostly what all have in common, something of their own at rims and cracks, nothing outside.

use rayon::prelude::*;

/// What a chunk has.
pub enum Slot<T> {
    Common,
    Empty,
    Own(T),
}

impl<T> Slot<T> {
    /// What it has of its own, or one of these.
    pub fn or(self, common: T, empty: T) -> T {
        match self {
            Slot::Common => common,
            Slot::Empty => empty,
            Slot::Own(own) => own,
        }
    }

    pub fn map<U>(self, of: impl FnOnce(T) -> U) -> Slot<U> {
        match self {
            Slot::Common => Slot::Common,
            Slot::Empty => Slot::Empty,
            Slot::Own(own) => Slot::Own(of(own)),
        }
    }
}

const COMMON: u32 = u32::MAX;
const EMPTY: u32 = u32::MAX - 1;

#[derive(Debug, Clone)]
pub struct Chunked<T> {
    /// Chunks of a row.
    pub chunks: usize,
    slots: Vec<u32>,
    own: Vec<T>,
}

impl<T: Send> Chunked<T> {
    /// `find(row, chunk)` is asked of the chunks of all rows that are not common.
    pub fn new(
        [chunks, rows]: [usize; 2],
        is_common: impl Fn(usize, usize) -> bool,
        find: impl Fn(usize, usize) -> Slot<T> + Sync,
    ) -> Self {
        let asked: Vec<usize> = (0..rows * chunks).filter(|index| !is_common(index / chunks, index % chunks)).collect();
        let found: Vec<Slot<T>> = asked.par_iter().map(|index| find(index / chunks, index % chunks)).collect();
        let (mut slots, mut own) = (vec![COMMON; rows * chunks], Vec::new());
        for (index, found) in asked.into_iter().zip(found) {
            slots[index] = match found {
                Slot::Common => COMMON,
                Slot::Empty => EMPTY,
                Slot::Own(found) => {
                    own.push(found);
                    own.len() as u32 - 1
                }
            };
        }
        Chunked { chunks, slots, own }
    }

    #[inline(always)]
    pub fn at(&self, row: usize, chunk: usize) -> Slot<&T> {
        match self.slots[row * self.chunks + chunk] {
            COMMON => Slot::Common,
            EMPTY => Slot::Empty,
            slot => Slot::Own(&self.own[slot as usize]),
        }
    }

    pub fn is_common(&self, row: usize, chunk: usize) -> bool {
        matches!(self.at(row, chunk), Slot::Common)
    }

    /// What a chunk has of its own from now on at the latest, at first `begin(whether it is common)`.
    pub fn own_mut(&mut self, row: usize, chunk: usize, begin: impl FnOnce(bool) -> T) -> &mut T {
        let slot = &mut self.slots[row * self.chunks + chunk];
        if *slot == COMMON || *slot == EMPTY {
            self.own.push(begin(*slot == COMMON));
            *slot = self.own.len() as u32 - 1;
        }
        &mut self.own[*slot as usize]
    }
}
