//! How a pin bears on the rim of its hole: over an arc that is given, or where an elastic pin touches it.

use std::sync::Arc;

use perilife_base::error::{Result, fail_if};
use perilife_base::keys::{Given, length, modulus, number};
use perilife_base::units::GPA;

/// Half angle of contact of a pin that fills its hole, rad: a pin without friction pushes over half the circle.
pub const SNUG_PIN: f64 = std::f64::consts::FRAC_PI_2;
/// Half angle of contact of pins of which nothing is known and which pull against each other, as those of a clevis, rad: Hertz contact of a steel pin with the clearance of ASTM E647 in aluminium
/// gives `b = √(4 P' R / π E*)` = 1.4 mm at W = 50 mm and P' = 640 N/mm, or 13° of the hole (1/E* = (1-ν²)/E of both, R = 150 mm).
pub const LOOSE_PIN: f64 = std::f64::consts::PI / 12.0;
/// Young's modulus of a pin of which only the diameter is given, Pa: steel.
pub const YOUNGS_MODULUS: f64 = 210e9;
/// Poisson's ratio of the same.
pub const POISSON_RATIO: f64 = 0.3;
/// Diameter of the pin over that of the hole up to which it still goes in: round-off of the input.
const FITS: f64 = 1.0 + 1e-9;

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

/// A round pin in a hole at least as large; SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Pin {
    pub radius: f64,
    pub youngs_modulus: f64,
    pub poisson_ratio: f64,
    /// Forces of contact at maximum load on the plate with its initial cracks, once they are found.
    pub found: Option<Arc<Contact>>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Where contact ends on both sides of the direction of the force, rad.
    pub ends: [f64; 2],
    /// Largest pressure, Pa.
    pub pressure: f64,
    /// Share of the force of the pin that bears elsewhere once contact is sought with the displacement of the solved plate.
    pub residual: f64,
    pub pieces: Vec<RimForce>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimForce {
    /// Middle of the piece, rad, from the direction of the force of the pin, counter-clockwise.
    pub angle: f64,
    /// Its length over the radius of the hole, rad.
    pub width: f64,
    /// Force on the plate along the radius, outwards, over that of the pin.
    pub share: f64,
}

perilife_base::keys! {
    #[derive(Debug)]
    pub struct PinKeys {
        half_angle: Option<f64> = number("pin_half_angle_deg", "Half angle of the contact arc, °: 90 for a close-fitting pin", ARC, 1.0, 90.0);
        diameter: Option<f64> = length("pin_diameter_mm", "Pin diameter: its clearance sets the contact arc");
        friction: Option<f64> = number("pin_friction", "Friction of the pin: 0 only", "a coefficient of friction", 0.0, 10.0);
        youngs_modulus: f64 = modulus("pin_youngs_modulus_gpa", "Young's modulus of the pin"), or "210 (steel)" YOUNGS_MODULUS;
        poisson_ratio: f64 = number("pin_poisson_ratio", "Poisson's ratio of the pin", POISSON, 0.0, 0.499), or "0.3 (steel)" POISSON_RATIO;
    }
}

pub const ARC: &str = "an angle in degrees, 90 for a close-fitting pin";
pub const POISSON: &str = "a Poisson's ratio";

impl Bearing {
    /// What the keys of a section say of the pin in a hole of radius `hole`, m; half angle and friction have other names in some.
    /// Errors: [`perilife_base::error::Error::Input`]: an arc beside a pin, friction, a pin without diameter or one larger than its hole.
    pub fn read(given: &Given<'_>, [half_angle, friction]: [&str; 2], keys: &PinKeys, hole: f64) -> Result<Self> {
        const OF_ELASTIC: [&str; 3] = ["pin_diameter_mm", "pin_youngs_modulus_gpa", "pin_poisson_ratio"];
        if keys.friction.is_some_and(|given| given != 0.0) {
            return Err(given.refuse(friction, "is not supported: pins are frictionless", "remove it, or set 0"));
        }
        let of_elastic = given.first(&OF_ELASTIC);
        if let (Some(angle), other) = (keys.half_angle, of_elastic) {
            let twice =
                |other: &str| given.refuse(half_angle, format!("conflicts with {other}"), "give the contact arc or the pin");
            return other.map_or(Ok(Bearing::Cosine(angle.to_radians())), |other| Err(twice(other)));
        }
        let Some(diameter) = keys.diameter else {
            let missing = |other: &str| {
                let problem = format!("is required with {other}: the contact arc depends on the clearance");
                Err(given.refuse(OF_ELASTIC[0], problem, "give the diameter of the pin"))
            };
            return of_elastic.map_or(Ok(Bearing::Unknown(LOOSE_PIN)), missing);
        };
        let radius = diameter / 2.0;
        let problem = || format!("is larger than the hole ({} mm); interference fits are not supported", 2e3 * hole);
        fail_if!(radius > hole * FITS, given.refuse(OF_ELASTIC[0], problem(), "use a pin smaller than its hole"));
        let PinKeys { youngs_modulus, poisson_ratio, .. } = *keys;
        Ok(Bearing::Elastic(Pin { radius: radius.min(hole), youngs_modulus, poisson_ratio, found: None }))
    }

    /// Half angle of the cosine, rad; `None` of an elastic pin.
    pub fn half_angle(&self) -> Option<f64> {
        match self {
            Bearing::Unknown(half_angle) | Bearing::Cosine(half_angle) => Some(*half_angle),
            Bearing::Elastic(_) => None,
        }
    }

    pub fn words(&self) -> String {
        match self {
            Bearing::Unknown(half_angle) => format!("contact ±{:.0}° assumed", half_angle.to_degrees()),
            Bearing::Cosine(half_angle) => format!("contact ±{:.1}° (given)", half_angle.to_degrees()),
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
        let peak = contact.pressure / perilife_base::units::MPA;
        format!("{pin}: contact {from:.1}° to {to:+.1}° at N = 0, peak pressure {peak:.0} MPa")
    }
}
