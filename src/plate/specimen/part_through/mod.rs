//! Cracks that do not go through the thickness: K of parts of an ellipse under tension and bending.
//!
//! `K = (S_t F + S_b H F_b) √(π a/Q)` with gross tension S_t and the stress S_b of a bending at the face that the crack starts from (Newman and
//! Raju 1984, NASA TM-85793: "Stress-intensity factor equations for cracks in three-dimensional finite bodies subjected to tension and bending
//! loads"). Fitted to finite elements, they are within 5 % of them where a/t ≤ 0.8, 0.2 ≤ a/c ≤ 2 and the crack takes less than half of the
//! width, but for a thin layer at a free surface; corrections for width are estimates. K is read at the ends of both axes, φ = 90° and 0.
//!
//! A kind is all that a `PartThroughSpec` says of it, in `plain` or a file of its own. A new one has its place in `KINDS` and its name in
//! [`SpecimenKind`].

mod corner_crack_at_hole;
mod front;
mod plain;
mod read;
mod through;

pub use front::{CrackFront, FrontTip};
pub(super) use read::{from_value, keys};

use std::f64::consts::PI;

use super::{Specimen, SpecimenKind};

const KINDS: &[&PartThroughSpec] = &[&plain::SURFACE, &plain::CORNER, &plain::EMBEDDED, &corner_crack_at_hole::KIND];

/// Relative error of K that its source states.
pub const STATED_ERROR: f64 = 0.05;
pub const SOURCE: &str = "Newman and Raju 1984, NASA TM-85793";
/// When a crack is through and what it is then, in words.
pub const BREAK_THROUGH: &str = "breakthrough at a/t = 1; then a straight through crack of length c";
pub const RANGE: &str = "5 % for a/t ≤ 0.8, a/c = 0.2 to 2, crack < half of the width";

pub struct PartThroughSpec {
    /// Its name in `specimen.kind`.
    pub kind: SpecimenKind,
    letters: PlateLetters,
    share_of_ellipse: f64,
    has_hole: bool,
    /// F over φ.
    tension: Factor,
    /// H F over φ, where the source has it.
    pub(super) bending: Option<Factor>,
    limits: &'static [Limit],
}

impl PartialEq for PartThroughSpec {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind
    }
}

impl std::fmt::Debug for PartThroughSpec {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.kind.name())
    }
}

/// A factor of K over the parametric angle φ, rad.
type Factor = fn(&CrackFront, f64) -> f64;

/// The letters t and b of the formulas over thickness and width of the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PlateLetters {
    of_thickness: f64,
    of_width: f64,
}

#[derive(Debug, Clone, Copy)]
pub struct Limit {
    pub name: &'static str,
    pub of: fn(&CrackFront) -> f64,
    pub low: f64,
    pub high: f64,
}

impl Limit {
    pub fn in_words(&self) -> String {
        let Limit { name, low, high, .. } = self;
        if *low > 0.0 { format!("{name} {low} to {high}") } else { format!("{name} up to {high}") }
    }
}

const SHAPE: [Limit; 2] = [
    Limit { name: "a/t", of: CrackFront::depth, low: 0.0, high: 0.8 },
    Limit { name: "a/c", of: CrackFront::aspect, low: 0.2, high: 2.0 },
];
const CENTRAL: &[Limit] =
    &[SHAPE[0], SHAPE[1], Limit { name: "c/half width", of: |front| front.c / front.b, low: 0.0, high: 0.5 }];
/// Slack of a range: 0.8 of 6.35 mm is 0.8 less a rounding.
const RANGE_SLACK: f64 = 1e-9;

/// A crack that does not go through, in its plate. Lengths in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartThrough {
    description: &'static PartThroughSpec,
    /// Semi-axis a at the start, through the thickness.
    pub depth: f64,
    /// Semi-axis c at the start, along the width.
    pub half_length: f64,
    pub thickness: f64,
    pub width: f64,
    pub radius: f64,
    /// Cracks in the section: at a hole 1 or 2, else 1.
    pub cracks: usize,
    /// Way along the face to the rim of the next further hole on the line of the crack, m, as a length c; infinite without one.
    pub to_hole: f64,
    /// What further holes take of the length of the section, m.
    pub other_holes: f64,
    /// S_b/S_t: stress of the bending at the face of the crack over the tension.
    pub bending_ratio: f64,
}

impl SpecimenKind {
    /// What a kind is whose crack does not go through; `None` of through cracks.
    pub fn part_through(self) -> Option<&'static PartThroughSpec> {
        KINDS.iter().copied().find(|description| description.kind == self)
    }
}

impl PartThrough {
    pub fn kind(&self) -> SpecimenKind {
        self.description.kind
    }

    /// The crack with these semi-axes [a, c], m, in the letters of the formulas.
    pub fn front(&self, [a, c]: [f64; 2]) -> CrackFront {
        let letters = self.description.letters;
        let (t, b) = (letters.of_thickness * self.thickness, letters.of_width * self.width);
        CrackFront { a, c, t, b, r: self.radius, n: self.cracks as f64 }
    }

    /// Semi-axes at the start, [a, c], m.
    pub fn start(&self) -> [f64; 2] {
        [self.depth, self.half_length]
    }

    /// The depth a at which the crack is through, m: a/t = 1.
    pub fn through_depth(&self) -> f64 {
        self.description.letters.of_thickness * self.thickness
    }

    /// How many holes of its plate are its own; they stand last.
    pub fn own_holes(&self) -> usize {
        usize::from(self.description.has_hole)
    }

    /// Whether the ends of a and c lie inside the material, where strain across the plane of the crack is held, or at a face of it.
    pub fn ends_inside(&self) -> [bool; 2] {
        [0.5, 1.0].map(|share| self.description.share_of_ellipse >= share)
    }

    /// The length c for which the section has room, m.
    pub fn room(&self) -> f64 {
        self.description.letters.of_width * self.width - self.radius
    }

    /// K_I, Pa√m, of the crack with semi-axes [a, c], m, at an end of its front under a gross tension S_t, Pa, and the bending that goes with
    /// it. None where the bending closes it.
    pub fn k_i(&self, axes: [f64; 2], tension: f64, tip: FrontTip) -> f64 {
        let front = self.front(axes);
        let factors = self.factors(&front, tip.angle());
        ((factors[0] + self.bending_ratio * factors[1]) * tension * (PI * front.a / front.shape_factor()).sqrt()).max(0.0)
    }

    /// F and H F_b at an angle φ, rad; no bending where the source has none.
    pub fn factors(&self, front: &CrackFront, angle: f64) -> [f64; 2] {
        let PartThroughSpec { tension, bending, .. } = self.description;
        [tension(front, angle), bending.map_or(0.0, |bending| bending(front, angle))]
    }

    /// The ranges of the formulas that a crack with these semi-axes, m, has left.
    pub fn limits_left(&self, axes: [f64; 2]) -> Vec<&'static Limit> {
        let front = self.front(axes);
        let holds = |limit: &&Limit| (limit.low - RANGE_SLACK..=limit.high + RANGE_SLACK).contains(&(limit.of)(&front));
        self.description.limits.iter().filter(|limit| !holds(limit)).collect()
    }

    /// Nominal tension, Pa, under which what is left of the section yields throughout: without bending `σ_n = σ_Y A/(W B)`, with the area A of
    /// the section less hole and cracks; the line of the force is taken to go through its middle. With a bending stress ρ σ at the face it is
    /// the σ at which a rectangle is fully plastic under force and moment, `(σ/σ_n)² + ρ σ/(1.5 σ_n) = 1`.
    pub fn limit_stress(&self, [a, c]: [f64; 2], yield_strength: f64) -> f64 {
        let gross = self.width * self.thickness;
        let cracked = self.cracks as f64 * self.description.share_of_ellipse * PI * a * c;
        let in_tension =
            yield_strength * ((gross - (2.0 * self.radius + self.other_holes) * self.thickness - cracked) / gross).max(0.0);
        let half = self.bending_ratio / 3.0;
        in_tension * ((1.0 + half * half).sqrt() - half)
    }
}

impl Specimen {
    /// Whether its crack goes through the thickness.
    pub fn is_through(&self) -> bool {
        self.part_through.is_none()
    }
}
