//! SE(B): a beam along y with a crack from its left edge on y = 0, on rollers.
//!
//! Three: two `span_mm` apart (4 W where it is left out) at the cracked edge, one behind the crack. Four, where `inner_span_mm` is given:
//! two that far apart on the other edge. The force is that on the beam, both inner rollers together; each contact is W/20 wide.

use std::f64::consts::PI;

use super::shapes::{below, roller};
use super::{Layout, SpecimenSpec};
use crate::specimen::handbook::HandbookFormula;
use crate::specimen::keys::{CRACK_LENGTH, LENGTH, THICKNESS, WIDTH};
use crate::specimen::plate::Drawing;
use crate::specimen::{Load, SpecimenKind};
use perilife_base::error::{Result, fail_if, input as error};
use perilife_base::keys::{Given, Section, length};
use perilife_base::units::round_mm;

pub(super) const KIND: SpecimenSpec = SpecimenSpec { kind: SpecimenKind::SingleEdgeBend, keys: Keys::KEYS, layout };
/// Width of a contact over W.
const CONTACT: f64 = 0.05;
/// Span over W of the standards.
const SPAN: f64 = 4.0;
/// What the beam is longer than its span, over W.
const OVERHANG: f64 = 0.5;

perilife_base::keys! {
    struct Keys {
        w: f64 = WIDTH;
        thickness: f64 = THICKNESS;
        a: f64 = CRACK_LENGTH;
        span: f64 = length("span_mm", "Span: of the outer rollers"), or "4 W" SPAN * w;
        inner: Option<f64> = length("inner_span_mm", "Inner span: between two rollers; default one roller at midspan");
        length: f64 = LENGTH.said("Length L: of the beam"), or "span + W/2" span + OVERHANG * w;
    }
}

fn layout(given: &Given<'_>) -> Result<Layout> {
    let Keys { w, thickness, a, span, inner, length } = Keys::read(given)?;
    below("crack_length_mm", a, w, "the width")?;
    let contact = CONTACT * w;
    if given.first(&["span_mm"]).is_some() {
        below("span_mm", span, length - contact, "the length less a contact")?;
    } else if length <= span + contact {
        let problem = format!("is too short for the span of {} mm and a contact", round_mm(span));
        return Err(error("specimen.length_mm", round_mm(length), problem, "give a longer beam, or span_mm"));
    }
    let problem = || format!("must be above two contacts, {} mm", round_mm(2.0 * contact));
    fail_if!(span <= 2.0 * contact, error("specimen.span_mm", round_mm(span), problem(), "give a longer one"));
    inner.map_or(Ok(()), |inner| below("inner_span_mm", inner, span - 2.0 * contact, "the span less two contacts"))?;
    let at = |x: f64, y: f64, share: f64| {
        // As the outline runs: up behind the crack, down at the edge where it starts.
        let side = if x > 0.0 { 1.0 } else { -1.0 };
        roller([-0.5, 0.5].map(|end| [x, y + side * end * CONTACT * w]), [-side, 0.0], share, thickness)
    };
    let mut loads: Vec<Load> = vec![at(0.0, -span / 2.0, 0.5), at(0.0, span / 2.0, 0.5)];
    match inner {
        None => loads.push(at(w, 0.0, 1.0)),
        Some(inner) => loads.extend([at(w, -inner / 2.0, 0.5), at(w, inner / 2.0, 0.5)]),
    }
    let y = length / 2.0;
    let drawing = Drawing {
        outline: vec![[0.0, -y], [w, -y], [w, y], [0.0, y]],
        cracks: vec![vec![[0.0, 0.0], [a, 0.0]]],
        thickness,
        ..Drawing::default()
    };
    Ok(Layout { drawing, loads, crack_length: Some(a), formula: formula([w, span], inner, thickness), supports: Vec::new() })
}

/// K under three rollers with the span of the standards, or between two that lie W or more from the crack.
fn formula([w, span]: [f64; 2], inner: Option<f64>, thickness: f64) -> Option<HandbookFormula> {
    let is_standard = (span / w - SPAN).abs() < 1e-6;
    let three = HandbookFormula {
        name: "ASTM E399 SE(B)",
        source: "ASTM E399 annex A3 and E1820 annex A1 (Srawley 1976)",
        // The stress opposite the middle roller is 4 to 5 % below 6 M/(B W²) (Timoshenko and Goodier, article 24), and the formula, which tends
        // to that stress, above K on nodes and of finite elements: by 4.4, 2.8, 1.1, 0.7 % at a/W = 0.02, 0.1, 0.2, 0.25.
        range: "0.5 % for a/W ≥ 0.25, up to 4 % high for shorter cracks; span 4 W",
        bounds: [0.25, 1.0],
        of: |x, span| {
            let f = 1.99 - x * (1.0 - x) * (2.15 - 3.93 * x + 2.7 * x * x);
            1.5 * span * x.sqrt() * f / ((1.0 + 2.0 * x) * (1.0 - x).powf(1.5))
        },
        error: |_| 0.005,
        is_of_pins: true,
        shape: span / w,
        ..HandbookFormula::unstated(w, thickness)
    };
    let Some(inner) = inner else { return is_standard.then_some(three) };
    (inner >= 2.0 * w).then_some(HandbookFormula {
        name: "Brown and Srawley pure bending",
        source: "Brown and Srawley 1966, ASTM STP 410",
        range: "0.2 % for a/W ≤ 0.6; inner span ≥ 2 W",
        bounds: [0.0, 0.6],
        // σ = 6 M/(B W²) with M = P (S - S_i)/4.
        of: |x, arm| {
            let factor = 1.122 + x * (-1.4 + x * (7.33 + x * (-13.08 + 14.0 * x)));
            1.5 * arm * (PI * x).sqrt() * factor
        },
        error: |_| 0.002,
        shape: (span - inner) / w,
        ..three
    })
}
