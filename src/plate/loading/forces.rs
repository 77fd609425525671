//! Forces on a `plate`: `pins` press in its holes, `rollers` on its outline.

use serde::Deserialize;
use toml::Value;

use crate::specimen::geometry::{along, distance, distance_to_segment, unit};
use crate::specimen::{Bearing, Load, Point, Specimen};
use perilife_base::error::{Result, input};
use perilife_base::input::{number, slice};
use perilife_base::units::MM;

/// Their keys.
pub(super) const KEYS: [&str; 2] = ["loading.pins", "loading.rollers"];

/// Distance from the outline below which a place lies on it, m.
const ON_OUTLINE: f64 = 1e-6;

/// One entry of `pins`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PinInput {
    hole: usize,
    direction: [f64; 2],
    share: Option<f64>,
    /// Beside loaded edges: bearing stress `P/(d h)` over the nominal stress.
    bearing_ratio: Option<f64>,
    contact_half_angle_deg: Option<f64>,
    pin_diameter_mm: Option<f64>,
    friction: Option<f64>,
    pin_youngs_modulus_gpa: Option<f64>,
    pin_poisson_ratio: Option<f64>,
}

/// One entry of `rollers`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RollerInput {
    at_mm: [f64; 2],
    contact_width_mm: f64,
    /// Straight into the plate where it is left out.
    direction: Option<[f64; 2]>,
    #[serde(default = "one")]
    share: f64,
}

fn one() -> f64 {
    1.0
}

/// Pins, which press on the rim of a hole; those `beside_edges` that are loaded say their force by their bearing stress.
pub(super) fn read_pins(pins: &[Value], beside_edges: bool, specimen: &mut Specimen) -> Result<()> {
    check_count(KEYS[0], pins, "pins { hole = 0, direction = [0, 1] }")?;
    for (i, value) in pins.iter().enumerate() {
        let path = format!("{}[{i}]", KEYS[0]);
        let pin: PinInput = slice(value, &path)?;
        if pin.hole >= specimen.holes.len() {
            let problem = format!("is not a hole of this plate, which has {}", specimen.holes.len());
            return Err(input(&format!("{path}.hole"), pin.hole, problem, "count specimen.holes from 0"));
        }
        let force = force_of(&path, &pin, beside_edges, specimen)?;
        let direction = direction_of(&path, pin.direction)?;
        let keys = perilife_base::keyed!(
            pin: contact_half_angle_deg, pin_diameter_mm, friction, pin_youngs_modulus_gpa, pin_poisson_ratio);
        let contact = Bearing::read(&path, &keys, specimen.holes[pin.hole].radius)?;
        specimen.loads.push(Load::Pin { hole: pin.hole, direction, force, contact });
    }
    Ok(())
}

/// Force of a pin per unit of nominal load: its share of a force, N per N, or beside loaded edges `bearing_ratio d h`, N per Pa.
fn force_of(path: &str, pin: &PinInput, beside_edges: bool, specimen: &Specimen) -> Result<f64> {
    let key = format!("{path}.bearing_ratio");
    match (beside_edges, pin.bearing_ratio, pin.share) {
        (false, None, share) => read_share(path, share.unwrap_or(1.0)),
        (false, Some(given), _) => {
            let problem = "is bearing stress over the stress of a loaded edge, and no edge is loaded";
            Err(input(&key, given, problem, "name the loaded edges in loading.edges, or give share"))
        }
        (true, _, Some(share)) => {
            let problem = "is a share of a force, and beside loaded edges the nominal load is their stress";
            Err(input(
                &format!("{path}.share"),
                share,
                problem,
                "give bearing_ratio = P / (d h) over the stress of the first edge",
            ))
        }
        (true, None, None) => {
            let remedy = "give P / (d h) of the pin over the stress of the first edge of loading.edges";
            Err(perilife_base::error::input_missing(&key, "is missing: the pin stands beside loaded edges", remedy))
        }
        (true, Some(ratio), None) => {
            let ratio = number("a ratio of stresses", 1e-6, 1e4).read(&key, ratio)?;
            Ok(ratio * 2.0 * specimen.holes[pin.hole].radius * specimen.thickness)
        }
    }
}

/// Rollers: uniform pressure `share / (contact width x thickness)` per unit of force on a straight stretch of the outline.
pub(super) fn read_rollers(rollers: &[Value], specimen: &mut Specimen) -> Result<()> {
    check_count(KEYS[1], rollers, "rollers { at_mm = [0, 40], contact_width_mm = 6 }")?;
    for (i, value) in rollers.iter().enumerate() {
        let path = format!("{}[{i}]", KEYS[1]);
        let roller: RollerInput = slice(value, &path)?;
        let given = format!("[{}, {}]", roller.at_mm[0], roller.at_mm[1]);
        let at = roller.at_mm.map(|x| x * MM);
        let width_key = format!("{path}.contact_width_mm");
        let width = number("a length in mm", 1e-3, 1e5).read(&width_key, roller.contact_width_mm)? * MM;
        let share = read_share(&path, roller.share)?;
        let sides = (0..specimen.outline.len()).map(|i| [i, (i + 1) % specimen.outline.len()].map(|i| specimen.outline[i]));
        let Some([from, to]) = sides.into_iter().find(|[from, to]| distance_to_segment(at, *from, *to) < ON_OUTLINE) else {
            let remedy = "give [x, y] of the middle of the contact";
            return Err(input(&format!("{path}.at_mm"), given, "does not lie on the outline", remedy));
        };
        let (side, place) = (distance(from, to), distance(from, at));
        if place < width / 2.0 - ON_OUTLINE || side - place < width / 2.0 - ON_OUTLINE {
            let problem = "reaches beyond the end of the straight side it lies on";
            let remedy = "give a narrower contact, or place it farther from the corner";
            return Err(input(&width_key, roller.contact_width_mm, problem, remedy));
        }
        // The outline runs counter-clockwise: the plate lies to its left.
        let inward = [-(to[1] - from[1]) / side, (to[0] - from[0]) / side];
        let direction = roller.direction.map_or(Ok(inward), |direction| direction_of(&path, direction))?;
        if direction[0] * inward[0] + direction[1] * inward[1] <= 0.0 {
            let given = roller.direction.map_or(String::new(), |[x, y]| format!("[{x}, {y}]"));
            return Err(input(&format!("{path}.direction"), given, "pulls at the plate", "a roller pushes: turn it round"));
        }
        let stretch = [-0.5, 0.5].map(|half| along(from, to, (place + half * width) / side));
        let pressure = share / (width * specimen.thickness);
        specimen.loads.push(Load::Edge { from: stretch[0], to: stretch[1], traction: direction.map(|d| pressure * d) });
    }
    Ok(())
}

fn check_count(key: &str, given: &[Value], example: &str) -> Result<()> {
    if given.len() > 100 {
        return Err(input(key, format!("{} entries", given.len()), "are too many", format!("give up to 100 {example}")));
    }
    Ok(())
}

fn read_share(path: &str, share: f64) -> Result<f64> {
    if share < 0.0 {
        return Err(input(&format!("{path}.share"), share, "is negative", "give its size, and turn the direction round"));
    }
    number("a share of the force", 1e-6, 1e6).read(&format!("{path}.share"), share)
}

/// Direction of a force, of length 1.
fn direction_of(path: &str, given: [f64; 2]) -> Result<Point> {
    unit(given).ok_or_else(|| {
        let remedy = "give [x, y] of the force on the plate, for example [0, 1]";
        input(&format!("{path}.direction"), format!("[{}, {}]", given[0], given[1]), "has no direction", remedy)
    })
}
