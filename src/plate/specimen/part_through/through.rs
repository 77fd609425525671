//! A crack seen from the front, and the through crack of the same plate that it becomes.

use std::f64::consts::{FRAC_PI_2, PI};

use super::PartThrough;
use crate::specimen::placement::place_cracks;
use crate::specimen::{Crack, Point, Specimen, SpecimenKind, TipSeed};
use perilife_base::error::Result;

const PARTS: usize = 72;

impl PartThrough {
    /// Both ends of every crack of length c, m, as it is seen from the front, and whether each is a tip.
    fn lines(&self, c: f64) -> Vec<[(Point, bool); 2]> {
        let from_rim = |rim: f64, side: f64| [([rim, 0.0], false), ([rim + side * c, 0.0], true)];
        match (self.description.has_hole, self.description.letters.of_width < 1.0) {
            (true, _) => [1.0, -1.0].map(|side| from_rim(side * self.radius, side)).into_iter().take(self.cracks).collect(),
            (false, true) => vec![[([-c, 0.0], true), ([c, 0.0], true)]],
            (false, false) => vec![from_rim(-self.width / 2.0, 1.0)],
        }
    }

    /// Cracks and tips as they are seen from the front.
    pub(super) fn seen_from_front(&self, c: f64) -> (Vec<Crack>, Vec<TipSeed>) {
        let lines = self.lines(c);
        let cracks = lines.iter().map(|[(from, _), (to, _)]| Crack::straight(*from, *to)).collect();
        let tip = |end: Point, other: Point| {
            let side = (end[0] - other[0]).signum();
            TipSeed { position: end, direction: [side, 0.0], from_slot: false }
        };
        let tips = lines.iter().flat_map(|[(from, starts), (to, ends)]| {
            [starts.then(|| tip(*from, *to)), ends.then(|| tip(*to, *from))].into_iter().flatten()
        });
        (cracks, tips.collect())
    }

    /// The fronts with semi-axes [a, c], m, as they are seen in the section: x along the width, y = 0 the face at which a crack begins.
    pub fn seen_in_section(&self, [a, c]: [f64; 2]) -> Vec<Vec<Point>> {
        let full = self.description.share_of_ellipse >= 1.0;
        let below = if full { -0.5 * self.thickness } else { 0.0 };
        let front = |line: [(Point, bool); 2]| {
            let [(from, starts), (to, _)] = line;
            let side = (to[0] - from[0]).signum();
            let (middle, turn) = match (starts, full) {
                (true, true) => (0.0, 2.0 * PI),
                (true, false) => (0.0, PI),
                (false, _) => (from[0], FRAC_PI_2),
            };
            let at = |part: usize| {
                let (sin, cos) = (turn * part as f64 / PARTS as f64).sin_cos();
                [middle + side * c * cos, below - a * sin]
            };
            (0..=PARTS).map(at).collect()
        };
        self.lines(c).into_iter().map(front).collect()
    }

    /// The plate of a specimen of this kind with a through crack of length c, m, in the place of its own: where a/t = 1 the crack has its length
    /// on the face at which it began through the whole thickness. Its length stays c, the mean over its tips.
    /// Errors: a crack that has no room in the plate.
    pub fn through(&self, specimen: &Specimen, c: f64) -> Result<Specimen> {
        let mut plate = Specimen {
            kind: SpecimenKind::Plate,
            part_through: None,
            cracks: Vec::new(),
            tips: Vec::new(),
            crack_length: 0.0,
            ..specimen.clone()
        };
        let paths = self.lines(c).into_iter().map(|line| line.map(|(end, _)| end).to_vec()).collect();
        place_cracks(&mut plate, paths, Vec::new(), &mut Vec::new())?;
        plate.crack_length = c;
        Ok(plate)
    }
}
