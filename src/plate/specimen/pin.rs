//! How a pin bears on the rim of its hole: over an arc that is given, or where an elastic pin touches it.

use std::sync::Arc;

use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{LENGTH, MODULUS, number};
use perilife_base::units::GPA;

/// Half angle of contact of a pin that fills its hole, rad: a pin without friction pushes over half the circle.
pub const SNUG_PIN: f64 = std::f64::consts::FRAC_PI_2;
/// Half angle of contact of pins of which nothing is known and which pull against each other, as those of a clevis, rad: Hertz contact of a steel pin with the clearance of ASTM E647 in aluminium
/// gives `b = √(4 P' R / π E*)` = 1.4 mm at W = 50 mm and P' = 640 N/mm, or 13° of the hole (1/E* = (1-ν²)/E of both, R = 150 mm).
pub const LOOSE_PIN: f64 = std::f64::consts::PI / 12.0;
/// Young's modulus of a pin of which only the diameter is given, GPa: steel.
const YOUNGS_MODULUS: f64 = 210.0;
/// Poisson's ratio of the same.
const POISSON_RATIO: f64 = 0.3;
/// Diameter of the pin over that of the hole up to which it still goes in: round-off of the input.
const FITS: f64 = 1.0 + 1e-9;

/// Where a pin bears on its hole.
#[derive(Debug, Clone, PartialEq)]
pub enum Bearing {
    /// Nothing is known of the pin: a cosine over this half angle, rad. It is [`LOOSE_PIN`] of pins that pull against each other, as in test
    /// specimens, and [`SNUG_PIN`] of those that something else holds against, as in lugs and joints, whose pins fit.
    Unknown(f64),
    /// Pressure `p cos(π θ / 2θ_c)`, |θ| up to θ_c, rad, about the direction of the force; up to [`SNUG_PIN`].
    Cosine(f64),
    /// An elastic pin: what it presses on follows from the load.
    Elastic(Pin),
}

/// A round pin in a hole at least as large.
#[derive(Debug, Clone, PartialEq)]
pub struct Pin {
    /// Radius, m.
    pub radius: f64,
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Forces of contact at maximum load on the plate with its initial cracks, once they are found.
    pub found: Option<Arc<Contact>>,
}

/// A pin in contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Where contact ends on both sides of the direction of the force, rad.
    pub ends: [f64; 2],
    /// Largest pressure, Pa.
    pub pressure: f64,
    /// Share of the force of the pin that bears elsewhere once contact is sought with the displacement of the solved plate.
    pub residual: f64,
    /// Pieces of rim of equal size with their forces.
    pub pieces: Vec<RimForce>,
}

/// Force of a pin on a piece of rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimForce {
    /// Middle of the piece, rad, from the direction of the force of the pin, counter-clockwise.
    pub angle: f64,
    /// Its length over the radius of the hole, rad.
    pub width: f64,
    /// Force on the plate along the radius, outwards, over that of the pin.
    pub share: f64,
}

/// Keys of a pin with their values: half angle, diameter, friction, Young's modulus, Poisson's ratio.
pub type PinKeys<'a> = [(&'a str, Option<f64>); 5];

impl Bearing {
    /// What keys at `path` say of the pin in a hole of radius `hole`, m.
    /// Errors: [`perilife_base::error::Error::Input`]: an arc beside a pin, friction, a pin without diameter or one larger than its hole.
    pub fn read(path: &str, keys: &PinKeys<'_>, hole: f64) -> Result<Self> {
        let [half_angle, diameter, friction, modulus, ratio] = *keys;
        let full = |key: &str| format!("{path}.{key}");
        let of_pin = [diameter, modulus, ratio];
        if let Some(given) = friction.1.filter(|given| *given != 0.0) {
            let problem = "is not computed: pins press without friction";
            return Err(input(&full(friction.0), given, problem, "leave it out, or give 0"));
        }
        if let (Some(angle), Some((key, _))) = (half_angle.1, of_pin.iter().find(|(_, given)| given.is_some())) {
            let problem = format!("stands beside {key}, from which it follows");
            return Err(input(&full(half_angle.0), angle, problem, "give the arc or the pin"));
        }
        let arc = number("an angle in degrees, 90 for a pin that fills its hole", 1.0, 90.0);
        if let Some(angle) = arc.read_optional(&full(half_angle.0), half_angle.1)? {
            return Ok(Bearing::Cosine(angle.to_radians()));
        }
        let Some(given) = diameter.1 else {
            return match of_pin[1..].iter().find(|(_, given)| given.is_some()) {
                Some((key, _)) => {
                    let problem = format!("is missing beside {key}: where a pin touches depends on its clearance");
                    Err(input_missing(&full(diameter.0), problem, "give the diameter of the pin"))
                }
                None => Ok(Bearing::Unknown(LOOSE_PIN)),
            };
        };
        let radius = LENGTH.read(&full(diameter.0), given)? / 2.0;
        if radius > hole * FITS {
            let problem = format!("is more than the hole ({} mm): a pin that is pressed in is not known", 2e3 * hole);
            return Err(input(&full(diameter.0), given, problem, "give a pin that goes into its hole"));
        }
        Ok(Bearing::Elastic(Pin {
            radius: radius.min(hole),
            youngs_modulus: MODULUS.read(&full(modulus.0), modulus.1.unwrap_or(YOUNGS_MODULUS))?,
            poisson_ratio: number("a Poisson's ratio", 0.0, 0.499).read(&full(ratio.0), ratio.1.unwrap_or(POISSON_RATIO))?,
            found: None,
        }))
    }

    /// Half angle of the cosine, rad; `None` of an elastic pin.
    pub fn half_angle(&self) -> Option<f64> {
        match self {
            Bearing::Unknown(half_angle) | Bearing::Cosine(half_angle) => Some(*half_angle),
            Bearing::Elastic(_) => None,
        }
    }

    /// In words, for answers.
    pub fn words(&self) -> String {
        match self {
            Bearing::Unknown(half_angle) => format!("nothing known of it, ±{:.0}° taken", half_angle.to_degrees()),
            Bearing::Cosine(half_angle) => format!("bears over ±{:.1}°, given", half_angle.to_degrees()),
            Bearing::Elastic(pin) => pin.words(),
        }
    }
}

impl Pin {
    fn words(&self) -> String {
        let Pin { radius, youngs_modulus, found, .. } = self;
        let pin = format!("{:.4} mm, E {:.0} GPa", 2e3 * radius, youngs_modulus / GPA);
        let Some(contact) = found else { return pin };
        let [from, to] = contact.ends.map(f64::to_degrees);
        format!(
            "{pin}: touches from {from:.1}° to {to:+.1}° at N = 0, at most {:.0} MPa",
            contact.pressure / perilife_base::units::MPA
        )
    }
}
