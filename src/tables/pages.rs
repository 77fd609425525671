//! What the pages of a Parquet file unpack to, read from their headers alone: a footer that says less does not count.
//!
//! The reader behind takes room for as many things as a list says it has, and a list of some bytes can say two thousand millions. So the
//! footer is gone through once before. A page is a header in the compact protocol of Thrift and so many bytes behind it as the header says. Of the header are read the
//! unpacked and packed bytes (fields 2 and 3) and the values of a data page (field 1 of the fields 5 and 8); everything else is passed over.

use perilife_base::cells::{CELLS_MAX, UNPACKED_MAX};

/// Levels of structures and lists in each other; footers have eight.
const DEPTH_MAX: usize = 16;

/// Sums over the pages of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Sums {
    /// Bytes that all pages unpack to.
    pub(super) unpacked: u64,
    /// Values of all data pages, and one for every other page.
    pub(super) values: usize,
}

/// Whether lists and texts of the footer are as long as they say; a file without the marks of Parquet is left to its reader.
pub(super) fn has_whole_footer(file: &[u8]) -> bool {
    let footer = || {
        let (rest, end) = file.split_at_checked(file.len().checked_sub(8)?)?;
        let length = u32::from_le_bytes(*end.first_chunk()?);
        (end[4..] == *b"PAR1").then_some(())?;
        rest.get(rest.len().checked_sub(usize::try_from(length).ok()?)?..)
    };
    footer().is_none_or(|left| Reader { left }.fields(0, 0, &mut |_, _, _, _| {}).is_some())
}

/// Sums over the pages in some stretches of a file, each by its start and length, as far as they are not too large; `None` where a header cannot be read.
pub(super) fn sums(file: &[u8], chunks: impl Iterator<Item = [i64; 2]>) -> Option<Sums> {
    let mut sums = Sums::default();
    for [start, length] in chunks {
        let (start, length) = (usize::try_from(start).ok()?, usize::try_from(length).ok()?);
        let mut left = file.get(start..start.checked_add(length)?)?;
        while !left.is_empty() {
            let mut reader = Reader { left };
            let mut page = Page::default();
            reader.fields(0, 0, &mut |field, depth, above, number| match (depth, above, field) {
                (0, _, 2) => page.unpacked = number,
                (0, _, 3) => page.packed = number,
                (1, 5 | 8, 1) => page.values = number,
                _ => {}
            })?;
            sums.unpacked = sums.unpacked.saturating_add(u64::try_from(page.unpacked).ok()?);
            // One at the least, so that empty pages named again and again come to an end.
            sums.values = sums.values.saturating_add(usize::try_from(page.values).ok()?.max(1));
            if sums.values > CELLS_MAX || sums.unpacked > UNPACKED_MAX {
                return Some(sums);
            }
            left = reader.left.get(usize::try_from(page.packed).ok()?..)?;
        }
    }
    Some(sums)
}

/// A page as its header says.
#[derive(Default)]
struct Page {
    unpacked: i64,
    packed: i64,
    values: i64,
}

/// Is told of every whole number: its field, how deep it stands, the field of the structure around it, and its value.
type Seen<'a> = &'a mut dyn FnMut(i64, usize, i64, i64);

/// Bytes in the compact protocol of Thrift.
struct Reader<'a> {
    left: &'a [u8],
}

impl Reader<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (&first, rest) = self.left.split_first()?;
        self.left = rest;
        Some(first)
    }

    fn pass(&mut self, count: u64) -> Option<()> {
        self.left = self.left.get(usize::try_from(count).ok()?..)?;
        Some(())
    }

    /// Seven bits a byte, the lowest first.
    fn varint(&mut self) -> Option<u64> {
        let mut value = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    /// Signs stand in the lowest bit.
    fn zigzag(&mut self) -> Option<i64> {
        let value = self.varint()?;
        Some((value >> 1) as i64 ^ -((value & 1) as i64))
    }

    /// A structure in the field `above` of another.
    fn fields(&mut self, depth: usize, above: i64, seen: Seen<'_>) -> Option<()> {
        if depth > DEPTH_MAX {
            return None;
        }
        let mut field = 0_i64;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(());
            }
            field = if head >> 4 == 0 { self.zigzag()? } else { field.wrapping_add(i64::from(head >> 4)) };
            match head & 15 {
                // True and false are types of their own.
                1 | 2 => {}
                4..=6 => seen(field, depth, above, self.zigzag()?),
                12 => self.fields(depth + 1, field, seen)?,
                kind => self.value(kind, depth, seen)?,
            }
        }
    }

    /// Passes over a value.
    fn value(&mut self, kind: u8, depth: usize, seen: Seen<'_>) -> Option<()> {
        match kind {
            1..=3 => self.pass(1),
            4..=6 => self.varint().map(drop),
            7 => self.pass(8),
            8 => {
                let length = self.varint()?;
                self.pass(length)
            }
            9 | 10 => {
                let head = self.byte()?;
                let count = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
                // Every value takes a byte at least, so that a false count ends at the end of the bytes.
                (0..count).try_for_each(|_| self.value(head & 15, depth + 1, seen))
            }
            11 => {
                let count = self.varint()?;
                let kinds = if count > 0 { self.byte()? } else { 0 };
                (0..count).try_for_each(|_| {
                    self.value(kinds >> 4, depth + 1, seen)?;
                    self.value(kinds & 15, depth + 1, seen)
                })
            }
            // No field of a page is looked for in here.
            12 => self.fields(depth + 1, -1, seen),
            _ => None,
        }
    }
}
