//! Cracks of a specimen: the lines that they are, which ends of them grow, and how long they are.

use super::{Crack, CrackLine, LineEnd, Specimen, TipSeed};
use perilife_base::units::place_mm;

/// How crack length is read, see [`Specimen::crack_length`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthConvention {
    /// Initial length plus the mean growth of all tips (half length of a central crack, each of two edge cracks, C(T)).
    MeanOfTips,
    /// Initial length of all cracks plus the growth of all tips.
    SumOfTips,
}

impl Specimen {
    pub fn tips_of(&self, line: &CrackLine) -> usize {
        let ends = |tip: &&TipSeed| !tip.from_slot && [true, false].iter().any(|&at_last| line.end(at_last) == tip.position);
        self.tips.iter().filter(ends).count()
    }

    /// Least distance of the tip of a crack from a rim or from a crack that it does not end, m; infinite without such a tip.
    pub fn least_gap(&self) -> f64 {
        let lines = self.crack_lines();
        let gap = |tip: usize| {
            let end = self.line_end(tip)?;
            let at = self.tips[tip].position;
            let others = lines.iter().enumerate().filter(|(line, _)| *line != end.line).map(|(_, line)| line.distance(at));
            Some(others.fold(self.rim_distance(at), f64::min))
        };
        (0..self.tips.len()).filter_map(gap).fold(f64::INFINITY, f64::min)
    }

    /// Least way from the tip of a crack over which that is straight, m ([`CrackLine::straight_way`]).
    pub fn shortest_path(&self) -> f64 {
        let lines = self.crack_lines();
        let ends = (0..self.tips.len()).filter_map(|tip| self.line_end(tip));
        ends.map(|end| lines[end.line].straight_way(end.at_last, f64::INFINITY)).fold(f64::INFINITY, f64::min)
    }

    /// Crack length in the convention of the specimen for given growths of its tips, m.
    pub fn crack_length_after(&self, growth_of_tips: &[f64]) -> f64 {
        let sum: f64 = growth_of_tips.iter().sum();
        match self.convention {
            LengthConvention::MeanOfTips => self.crack_length + sum / growth_of_tips.len().max(1) as f64,
            LengthConvention::SumOfTips => self.crack_length + sum,
        }
    }

    /// Length of the longest of several cracks, m, after these growths of their tips, of those that were shorter than `end` before; 0 where all
    /// were longer.
    pub fn length_towards(&self, end: f64, growth_of_tips: impl Iterator<Item = f64>) -> f64 {
        let lines = self.crack_lines();
        let mut lengths: Vec<f64> = lines.iter().map(CrackLine::length).collect();
        let is_ahead: Vec<bool> = lengths.iter().map(|length| *length < end).collect();
        for (tip, growth) in growth_of_tips.enumerate() {
            self.line_end(tip).into_iter().for_each(|end| lengths[end.line] += growth);
        }
        lengths.into_iter().zip(is_ahead).filter(|(_, ahead)| *ahead).fold(0.0, |most, (length, _)| most.max(length))
    }

    /// Crack length from which growth can start, m: of several cracks that of the shortest, else the crack length.
    pub fn shortest_crack(&self) -> f64 {
        let lines = self.crack_lines();
        let shortest = lines.iter().map(CrackLine::length).reduce(f64::min);
        shortest.filter(|_| self.has_several_cracks()).unwrap_or(self.crack_length)
    }

    /// Whether several cracks of a plate have a length each; ends of slots have none of their own.
    pub fn has_several_cracks(&self) -> bool {
        self.convention == LengthConvention::SumOfTips && self.crack_lines().len() > 1 && self.has_sharp_tips()
    }

    pub fn crack_key(&self) -> &'static str {
        self.kind.crack_key(self.convention)
    }

    pub fn crack_lines(&self) -> Vec<CrackLine> {
        let mut lines: Vec<CrackLine> = Vec::with_capacity(self.cracks.len());
        for crack in &self.cracks {
            match lines.last_mut().filter(|_| crack.continues) {
                Some(line) => line.grow(true, crack.to),
                None => lines.push(CrackLine::straight(crack.from, crack.to)),
            }
        }
        lines
    }

    pub fn set_crack_lines(&mut self, lines: &[CrackLine]) {
        let pieces = |line: &CrackLine| {
            line.pieces().enumerate().map(|(piece, [from, to])| Crack { from, to, continues: piece > 0 }).collect::<Vec<_>>()
        };
        self.cracks = lines.iter().flat_map(pieces).collect();
    }

    /// Which end of which of the [`Specimen::crack_lines`] a tip is; `None` for the end face of a slot.
    pub fn line_end(&self, tip: usize) -> Option<LineEnd> {
        let seed = self.tips.get(tip).filter(|seed| !seed.from_slot)?;
        let mut lines = self.crack_lines().into_iter().enumerate();
        lines.find_map(|(line, crack)| {
            [true, false]
                .into_iter()
                .find(|&at_last| crack.end(at_last) == seed.position)
                .map(|at_last| LineEnd { line, at_last })
        })
    }

    /// Whether it has tips, and all of them are those of sharp cracks.
    pub fn has_sharp_tips(&self) -> bool {
        !self.tips.is_empty() && (0..self.tips.len()).all(|tip| self.line_end(tip).is_some())
    }

    /// Where there are sharp cracks, those alone grow by K: notch ends without a crack are no longer tips. Says of each that it stays.
    pub fn leave_notch_ends(&mut self) -> Vec<String> {
        if self.tips.iter().all(|tip| tip.from_slot) {
            return Vec::new();
        }
        let ends = self.tips.extract_if(.., |tip| tip.from_slot);
        let remedy = "draw one there, or let bonds start it with fatigue.driver = \"bond_strain\"";
        let said = ends.map(|end| format!("cracks: none starts at the notch root {}; {remedy}", place_mm(end.position)));
        said.collect()
    }

    /// Moves every tip, and the end of its crack with it, by its growth, m; negative growth makes a crack shorter. The
    /// crack length stays the one that was read.
    pub fn move_tips(&mut self, growth_of_tips: &[f64]) {
        for (tip, &growth) in self.tips.iter_mut().zip(growth_of_tips).filter(|(_, growth)| **growth != 0.0) {
            let moved = [0, 1].map(|i| tip.position[i] + growth * tip.direction[i]);
            for end in self.cracks.iter_mut().flat_map(|crack| [&mut crack.from, &mut crack.to]) {
                if *end == tip.position {
                    *end = moved;
                }
            }
            tip.position = moved;
        }
    }
}
