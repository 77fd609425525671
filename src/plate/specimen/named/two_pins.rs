//! Specimens whose crack two pins in loose holes pull open.
//!
//! ESE(T) of ASTM E647 is a long plate with an edge crack, pulled on a line 0.3 W towards the crack from its middle, x from the cracked edge.
//! The line of the pins follows from the formula: K of a short crack is that of an edge crack under the stress of the edge,
//! `1.4 × 3.97 = 1.1215 √π (1 + 6 e/W)` for e = 0.3 W.
//!
//! The modified wedge-opening-loaded specimen (WOL) of Novak and Rolfe is a compact specimen with half height 0.486 W, whose crack has more
//! room. x from the load line, W from there to the back face, 0.255 W from there to the front face. Its pins stand for bolt and clevis; a
//! wedge that holds the opening is `loading.kind = "displacement"`.

use super::shapes::{below, pin};
use super::{Layout, SpecimenSpec};
use crate::specimen::handbook::HandbookFormula;
use crate::specimen::keys::{CRACK_LENGTH, THICKNESS, WIDTH};
use crate::specimen::pin::LOOSE_PIN;
use crate::specimen::plate::Drawing;
use crate::specimen::{Bearing, Hole, Point, SpecimenKind};
use perilife_base::error::Result;
use perilife_base::keys::{Given, Section};

pub(super) const ECCENTRIC: SpecimenSpec =
    SpecimenSpec { kind: SpecimenKind::EccentricSingleEdgeTension, keys: Keys::KEYS, layout: |given| layout(given, &ESE) };
pub(super) const WEDGE: SpecimenSpec =
    SpecimenSpec { kind: SpecimenKind::WedgeOpening, keys: Keys::KEYS, layout: |given| layout(given, &WOL) };

struct Kind {
    /// What W is, in words.
    width: &'static str,
    half_height: f64,
    /// x of the edge where the crack starts, over W.
    front: f64,
    /// The upper pin of a width.
    pin: fn(f64) -> Point,
    formula: fn(HandbookFormula) -> HandbookFormula,
}

const ESE: Kind = Kind {
    width: "the width",
    half_height: 1.85,
    front: 0.0,
    pin: |w| [0.2 * w, 1.85 * w - 0.35 * w],
    formula: |rest| HandbookFormula {
        name: "ASTM E647 ESE(T)",
        source: "ASTM E647 annex A3 (Piascik, Newman and Underwood 1997)",
        range: "0.5 % for any a/W",
        of: |x, _| {
            let polynomial = 3.97 + x * (-10.88 + x * (26.25 + x * (-38.9 + x * (30.15 - 9.27 * x))));
            x.sqrt() * (1.4 + x) * (1.0 - x).powf(-1.5) * polynomial
        },
        error: |_| 0.005,
        ..rest
    },
};

const WOL: Kind = Kind {
    width: "the width W from the load line",
    half_height: 0.486,
    front: -0.255,
    pin: |w| [0.0, 0.25 * w],
    formula: |rest| HandbookFormula {
        name: "Novak and Rolfe WOL",
        source: "Novak and Rolfe 1969, J. Materials 4:701, K = P C3/(B √a)",
        range: "2 % for a/W = 0.25 to 0.75",
        bounds: [0.25, 0.75],
        of: |x, _| x.sqrt() * (30.96 + x * (-195.8 + x * (730.6 + x * (-1186.3 + 754.6 * x)))),
        error: |_| 0.02,
        ..rest
    },
};

/// Diameter of the holes of the pins over W.
const DIAMETER: f64 = 0.2;

perilife_base::keys! {
    struct Keys {
        w: f64 = WIDTH.said("Width W: from the edge (ESE(T)) or the load line (WOL)");
        thickness: f64 = THICKNESS;
        a: f64 = CRACK_LENGTH.said("Initial crack length a: from the same line as W");
    }
}

fn layout(given: &Given<'_>, kind: &Kind) -> Result<Layout> {
    let Keys { w, thickness, a } = Keys::read(given)?;
    below("crack_length_mm", a, w, kind.width)?;
    let (front, y, [pin_x, pin_y]) = (kind.front * w, kind.half_height * w, (kind.pin)(w));
    let drawing = Drawing {
        outline: vec![[front, -y], [w, -y], [w, y], [front, y]],
        holes: [1.0, -1.0].map(|side| Hole { centre: [pin_x, side * pin_y], radius: 0.5 * DIAMETER * w }).to_vec(),
        cracks: vec![vec![[front, 0.0], [a, 0.0]]],
        thickness,
        ..Drawing::default()
    };
    let formula = (kind.formula)(HandbookFormula { is_of_pins: true, ..HandbookFormula::unstated(w, thickness) });
    let loads = [1.0, -1.0].into_iter().enumerate().map(|(i, side)| pin(i, [0.0, side], Bearing::Unknown(LOOSE_PIN))).collect();
    Ok(Layout { drawing, loads, crack_length: Some(a), formula: Some(formula), ..Layout::default() })
}
