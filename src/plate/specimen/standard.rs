//! The standard specimens of ASTM E647.
//!
//! M(T), SE(T) and DE(T): a plate under tension along y with a central crack, one edge crack or two equal ones on y = 0.
//!
//! ```text
//!   ↑ ↑ ↑ ↑ ↑      width W, length L
//!  ┌─────────┐     M(T): crack from -a to a, crack length a = half of the length tip to tip
//!  │  ─────  │     SE(T), DE(T): crack length a from the edge x = -W/2 (and x = W/2)
//!  └─────────┘
//!   ↓ ↓ ↓ ↓ ↓
//! ```
//!
//! A single edge crack bends the plate, so its K depends on how the ends are held, and `ends` has to be given: at a/W = 0.5 clamped ends
//! give F = 2.2, 1.7, 1.3 at length/width 10, 4, 2, against 2.83 under uniform stress.
//!
//! C(T): compact specimen pulled open by two pins, proportions of ASTM E647.
//!
//! The origin lies on the load line in the crack plane; W reaches from there to the back face x = W. Total width 1.25 W,
//! height 1.2 W, holes of diameter 0.25 W at (0, ±0.275 W). The machined notch and the pre-crack together are one crack
//! from the front face x = -0.25 W to x = a.
//!
//! Where nothing is given of the pins ([`super::pin`]), they have a diameter of 0.24 W and roll on flats: they touch the far side of
//! their holes over a narrow arc and bring no friction. How wide the arc is matters for short cracks, whose tips lie close to the holes
//! (Newman 1974, ASTM STP 560, p. 105): a pressure over the whole half circle spreads the hole and raises K by 4.3, 2.4, 1.3, 0.2 % at
//! a/W = 0.2, 0.25, 0.3, 0.4 (own finite elements, quadratic, K by J), while arcs of 5 to 20° agree with each other and with the formula
//! of E647 within 0.2 %, of 45° within 1 %.

use toml::Value;

use super::keys::{CRACK_LENGTH, LENGTH, THICKNESS, WIDTH};
use super::net_section::check_crack;
use super::pin::PinKeys;
use super::{Bearing, Crack, Ends, Hole, Load, LoadMeasure, Specimen, SpecimenKind, Support, TipSeed};
use perilife_base::error::Result;
use perilife_base::keys::{Given, Section, key, part};

perilife_base::keys! {
    pub(super) struct Strip {
        width: f64 = WIDTH;
        length: f64 = LENGTH;
        thickness: f64 = THICKNESS;
        a: f64 = CRACK_LENGTH.said("Initial crack length a: half of a central crack, that of each edge crack");
    }
    pub(super) struct SingleEdge {
        strip: Strip = part();
        ends: Ends = key("ends", "Ends: clamped, pinned or under uniform stress");
    }
}

pub(super) fn from_value(kind: SpecimenKind, value: &Value) -> Result<Specimen> {
    let Strip { width, length, thickness, a } = Strip::read(&Given::of(value, "specimen")?)?;
    let strip = Specimen::strip(kind, width, length, thickness);
    check_crack(a, width / 2.0, "the half width")?;
    if kind == SpecimenKind::DoubleEdgeTension {
        let ((left, left_tip), (right, right_tip)) = (edge_crack(strip.width, a, -1.0), edge_crack(strip.width, a, 1.0));
        return Ok(Specimen { cracks: vec![left, right], tips: vec![left_tip, right_tip], crack_length: a, ..strip });
    }
    let tip = |sign: f64| TipSeed { position: [sign * a, 0.0], direction: [sign, 0.0], from_slot: false };
    let cracks = vec![Crack::straight([-a, 0.0], [a, 0.0])];
    Ok(Specimen { cracks, tips: vec![tip(-1.0), tip(1.0)], crack_length: a, ..strip })
}

pub(super) fn single_edge_from_value(value: &Value) -> Result<Specimen> {
    let SingleEdge { strip: Strip { width, length, thickness, a }, ends } = SingleEdge::read(&Given::of(value, "specimen")?)?;
    let strip = Specimen::strip(SpecimenKind::SingleEdgeTension, width, length, thickness);
    check_crack(a, width, "the width")?;
    let supports = match ends {
        Ends::UniformStress => vec![],
        Ends::Pinned => vec![Support::RigidEnds],
        Ends::Clamped => vec![Support::ClampedEnds],
    };
    let (crack, tip) = edge_crack(strip.width, a, -1.0);
    Ok(Specimen { cracks: vec![crack], tips: vec![tip], crack_length: a, supports, ..strip })
}

/// Crack of length `a` from the edge x = side W/2 inwards.
fn edge_crack(width: f64, a: f64, side: f64) -> (Crack, TipSeed) {
    let (mouth, end) = ([side * width / 2.0, 0.0], [side * (width / 2.0 - a), 0.0]);
    (Crack::straight(mouth, end), TipSeed { position: end, direction: [-side, 0.0], from_slot: false })
}

perilife_base::keys! {
    pub(super) struct Compact {
        w: f64 = WIDTH.said("Width W: from the load line to the back face");
        thickness: f64 = THICKNESS;
        a: f64 = CRACK_LENGTH.said("Initial crack length a: from the load line");
        pin: PinKeys = part();
    }
}

pub(super) fn compact_from_value(value: &Value) -> Result<Specimen> {
    let given = Given::of(value, "specimen")?;
    let Compact { w, thickness, a, pin: pin_keys } = Compact::read(&given)?;
    check_crack(a, w, "the width W from the load line")?;
    let hole = |sign: f64| Hole { centre: [0.0, sign * 0.275 * w], radius: 0.125 * w };
    let contact = Bearing::read(&given, ["pin_half_angle_deg", "pin_friction"], &pin_keys, 0.125 * w)?;
    let pin = |hole: usize, sign: f64| Load::Pin { hole, direction: [0.0, sign], force: 1.0, contact: contact.clone() };
    let (front, half_height) = (-0.25 * w, 0.6 * w);
    Ok(Specimen {
        outline: vec![[front, -half_height], [w, -half_height], [w, half_height], [front, half_height]],
        holes: vec![hole(1.0), hole(-1.0)],
        cracks: vec![Crack::straight([front, 0.0], [a, 0.0])],
        tips: vec![TipSeed { position: [a, 0.0], direction: [1.0, 0.0], from_slot: false }],
        gross_width: 1.25 * w,
        crack_length: a,
        loads: vec![pin(0, 1.0), pin(1, -1.0)],
        load_measure: LoadMeasure::Force,
        ..Specimen::strip(SpecimenKind::CompactTension, w, 1.2 * w, thickness)
    })
}
