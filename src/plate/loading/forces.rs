//! Forces on a `plate`: `pins` press in its holes, `rollers` on its outline.

use toml::Table;

use crate::specimen::geometry::{along, distance, distance_to_segment, unit};
use crate::specimen::pin::{ARC, POISSON, POISSON_RATIO, PinKeys, YOUNGS_MODULUS};
use crate::specimen::{Bearing, Load, Point, Specimen};
use perilife_base::error::{Result, fail_if, input};
use perilife_base::input::{Quantity, number as plain};
use perilife_base::keys::{Given, coordinate, key, length, modulus, number};
use perilife_base::units::round_mm;

pub(super) const KEYS: [&str; 2] = ["loading.pins", "loading.rollers"];
/// Distance from the outline below which a place lies on it, m.
const ON_OUTLINE: f64 = 1e-6;

perilife_base::keys! {
    #[derive(Debug)]
    pub struct PinEntry {
        hole: usize = key("hole", "Hole: counted from 0 in specimen.holes");
        direction: Point = key("direction", "Direction: [x, y] of the force on the plate");
        share: Option<f64> = key("share", "Share of the force: default 1").of(SHARE);
        bearing_ratio: Option<f64> = number("bearing_ratio", "Bearing stress P/(d h) over the remote stress: with loaded edges", "a ratio of stresses", 1e-6, 1e4);
        half_angle: Option<f64> = number("contact_half_angle_deg", "Half angle of the contact arc, °: 90 for a close-fitting pin", ARC, 1.0, 90.0);
        diameter: Option<f64> = length("pin_diameter_mm", "Pin diameter: its clearance sets the contact arc");
        friction: Option<f64> = number("friction", "Friction of the pin: 0 only", "a coefficient of friction", 0.0, 10.0);
        youngs_modulus: f64 = modulus("pin_youngs_modulus_gpa", "Young's modulus of the pin"), or "210 (steel)" YOUNGS_MODULUS;
        poisson_ratio: f64 = number("pin_poisson_ratio", "Poisson's ratio of the pin", POISSON, 0.0, 0.499), or "0.3 (steel)" POISSON_RATIO;
    }
    #[derive(Debug)]
    pub struct RollerEntry {
        at: Point = coordinate("at_mm", "Contact center: [x, y] on the outline");
        width: f64 = length("contact_width_mm", "Width of the contact");
        direction: Option<Point> = key("direction", "Direction: [x, y] of the force; default normal to the outline");
        share: f64 = key("share", "Share of the force").of(SHARE), or "1" 1.0;
    }
}
const SHARE: Quantity = plain("a share of the force", 1e-6, 1e6);

/// Pins, which press on the rim of a hole; those `beside_edges` that are loaded say their force by their bearing stress.
pub(super) fn read_pins(given: &Given<'_>, pins: &[PinEntry], beside_edges: bool, specimen: &mut Specimen) -> Result<()> {
    check_count(KEYS[0], pins.len(), "pins { hole = 0, direction = [0, 1] }")?;
    for (i, pin) in pins.iter().enumerate() {
        let path = format!("{}[{i}]", KEYS[0]);
        let empty = Table::new();
        let entry = given.table.get("pins").and_then(|pins| pins.get(i)?.as_table());
        let entry = Given { table: entry.unwrap_or(&empty), path: &path };
        let problem = || format!("is not a hole of this plate, which has {}", specimen.holes.len());
        let remedy = "count specimen.holes from 0";
        fail_if!(pin.hole >= specimen.holes.len(), input(&format!("{path}.hole"), pin.hole, problem(), remedy));
        let force = force_of(&path, pin, beside_edges, specimen)?;
        let direction = direction_of(&path, pin.direction)?;
        let &PinEntry { half_angle, diameter, friction, youngs_modulus, poisson_ratio, .. } = pin;
        let keys = PinKeys { half_angle, diameter, friction, youngs_modulus, poisson_ratio };
        let contact = Bearing::read(&entry, ["contact_half_angle_deg", "friction"], &keys, specimen.holes[pin.hole].radius)?;
        specimen.loads.push(Load::Pin { hole: pin.hole, direction, force, contact });
    }
    Ok(())
}

/// Force of a pin per unit of nominal load: its share of a force, N per N, or beside loaded edges `bearing_ratio d h`, N per Pa.
fn force_of(path: &str, pin: &PinEntry, beside_edges: bool, specimen: &Specimen) -> Result<f64> {
    let key = format!("{path}.bearing_ratio");
    match (beside_edges, pin.bearing_ratio, pin.share) {
        (false, None, share) => Ok(share.unwrap_or(1.0)),
        (false, Some(given), _) => {
            let problem = "requires a loaded edge (bearing stress / edge stress)";
            Err(input(&key, given, problem, "name the loaded edges in loading.edges, or give share"))
        }
        (true, _, Some(share)) => {
            let problem = "is a share of a force; with loaded edges the nominal load is a stress";
            let remedy = "give bearing_ratio = P / (d h) over the stress of the first edge";
            Err(input(&format!("{path}.share"), share, problem, remedy))
        }
        (true, None, None) => {
            let remedy = "give P / (d h) of the pin over the stress of the first edge of loading.edges";
            Err(perilife_base::error::input_missing(&key, "is required for a pin with loaded edges", remedy))
        }
        (true, Some(ratio), None) => Ok(ratio * 2.0 * specimen.holes[pin.hole].radius * specimen.thickness),
    }
}

/// Rollers: uniform pressure `share / (contact width x thickness)` per unit of force on a straight stretch of the outline.
pub(super) fn read_rollers(rollers: &[RollerEntry], specimen: &mut Specimen) -> Result<()> {
    check_count(KEYS[1], rollers.len(), "rollers { at_mm = [0, 40], contact_width_mm = 6 }")?;
    for (i, &RollerEntry { at, width, direction, share }) in rollers.iter().enumerate() {
        let path = format!("{}[{i}]", KEYS[1]);
        let sides = (0..specimen.outline.len()).map(|i| [i, (i + 1) % specimen.outline.len()].map(|i| specimen.outline[i]));
        let Some([from, to]) = sides.into_iter().find(|[from, to]| distance_to_segment(at, *from, *to) < ON_OUTLINE) else {
            let remedy = "give [x, y] of the middle of the contact";
            let given = format!("[{}, {}]", round_mm(at[0]), round_mm(at[1]));
            return Err(input(&format!("{path}.at_mm"), given, "is not on the outline", remedy));
        };
        let (side, place) = (distance(from, to), distance(from, at));
        if place < width / 2.0 - ON_OUTLINE || side - place < width / 2.0 - ON_OUTLINE {
            let problem = "extends past the end of its side";
            let remedy = "give a narrower contact, or place it farther from the corner";
            return Err(input(&format!("{path}.contact_width_mm"), round_mm(width), problem, remedy));
        }
        // The outline runs counter-clockwise: the plate lies to its left.
        let inward = [-(to[1] - from[1]) / side, (to[0] - from[0]) / side];
        let (asked, direction) = (direction, direction.map_or(Ok(inward), |direction| direction_of(&path, direction))?);
        if direction[0] * inward[0] + direction[1] * inward[1] <= 0.0 {
            let given = asked.map_or(String::new(), |[x, y]| format!("[{x}, {y}]"));
            return Err(input(&format!("{path}.direction"), given, "is a pull; a roller can only push", "reverse its direction"));
        }
        let stretch = [-0.5, 0.5].map(|half| along(from, to, (place + half * width) / side));
        let pressure = share / (width * specimen.thickness);
        specimen.loads.push(Load::Edge { from: stretch[0], to: stretch[1], traction: direction.map(|d| pressure * d) });
    }
    Ok(())
}

fn check_count(key: &str, given: usize, example: &str) -> Result<()> {
    fail_if!(given > 100, input(key, format!("{given} entries"), "are too many", format!("give up to 100 {example}")));
    Ok(())
}

fn direction_of(path: &str, given: [f64; 2]) -> Result<Point> {
    unit(given).ok_or_else(|| {
        let remedy = "give [x, y] of the force on the plate, for example [0, 1]";
        input(&format!("{path}.direction"), format!("[{}, {}]", given[0], given[1]), "has no direction", remedy)
    })
}
