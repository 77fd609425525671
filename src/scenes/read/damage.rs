//! `[damage]` of a scene: when bonds fail.

use serde::Deserialize;
use toml::Value;

use crate::scene::{Calibration, Damage, DamageEntry, DamageLaw, Softening};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{number, slice};
use perilife_plate::material::Material;

/// Final stretch over that of the tensile strength where a scene says nothing. A bond then breaks with 1.2 % of its stiffness
/// and 9 % of its largest force left, so that hardly any load is shed at once; at 3 it would be 41 %, at 2 73 % (strength
/// 572 MPa, yield strength 345 MPa).
const FINAL_RATIO: f64 = 5.0;

/// Keys of `[damage]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    law: Option<DamageLaw>,
    enters: Option<DamageEntry>,
    calibration: Option<Calibration>,
    critical_stretch: Option<f64>,
    elastic_stretch: Option<f64>,
    peak_stretch: Option<f64>,
    final_stretch: Option<f64>,
    final_ratio: Option<f64>,
    printed_law: Option<bool>,
}

/// Reads `[damage]`; bonds stay whole where it is left out.
pub fn from_value(value: &Value, material: &Material) -> Result<Damage> {
    let given: Input = slice(value, "damage")?;
    let law = given.law.unwrap_or(DamageLaw::None);
    check_keys(&given, law)?;
    let stretch = stretch_of("damage.critical_stretch", given.critical_stretch)?;
    let critical = matches!(law, DamageLaw::CriticalStretch | DamageLaw::CriticalEnergy);
    if let (Some(calibration), Some(_)) = (given.calibration, stretch) {
        let problem = "says how the critical stretch follows from the fracture energy, and damage.critical_stretch gives it";
        return Err(input("damage.calibration", format!("\"{calibration}\""), problem, "leave one of them out"));
    }
    if critical && stretch.is_none() && material.fracture_energy.is_none() {
        let problem = format!("is missing: damage.law = \"{law}\" takes the critical stretch from it");
        return Err(input_missing("material.fracture_energy_j_m2", problem, "give it, or damage.critical_stretch"));
    }
    if law == DamageLaw::PrincipalStress && material.tensile_strength.is_none() {
        let problem = "is missing: damage.law = \"principal_stress\" compares with it";
        return Err(input_missing("material.tensile_strength_mpa", problem, "give it"));
    }
    let nonlinear = (law == DamageLaw::NonlinearTwoParameter).then(|| softening(&given, material)).transpose()?;
    Ok(Damage {
        law,
        enters: given.enters.unwrap_or(DamageEntry::Influence),
        stretch,
        calibration: given.calibration.unwrap_or(Calibration::Growth),
        nonlinear,
        tensile_strength: material.tensile_strength,
    })
}

/// `enters` says nothing where damage is only in the bonds.
pub fn refuse_entry(value: &Value) -> Result<()> {
    let input: Input = slice(value, "damage")?;
    let Some(enters) = input.enters else { return Ok(()) };
    let problem = "goes with bond_law = \"correspondence\": a spring that breaks is gone from force and stiffness alike";
    Err(perilife_base::error::input("damage.enters", format!("\"{enters}\""), problem, "leave it out"))
}

/// Keys that the law has no use for.
fn check_keys(given: &Input, law: DamageLaw) -> Result<()> {
    let softening = [
        ("elastic_stretch", given.elastic_stretch),
        ("peak_stretch", given.peak_stretch),
        ("final_stretch", given.final_stretch),
        ("final_ratio", given.final_ratio),
        ("printed_law", given.printed_law.map(|printed| f64::from(u8::from(printed)))),
    ];
    let critical = [("critical_stretch", given.critical_stretch), ("calibration", given.calibration.map(|_| 0.0))];
    let (unused, belongs): (&[_], &str) = match law {
        DamageLaw::NonlinearTwoParameter => (&critical, "critical_stretch or critical_energy"),
        DamageLaw::CriticalStretch | DamageLaw::CriticalEnergy => (&softening, "nonlinear_two_parameter"),
        DamageLaw::None | DamageLaw::PrincipalStress => {
            if critical.iter().any(|(_, value)| value.is_some()) {
                (&critical, "critical_stretch or critical_energy")
            } else {
                (&softening, "nonlinear_two_parameter")
            }
        }
    };
    match unused.iter().find(|(_, value)| value.is_some()) {
        None => Ok(()),
        Some((key, _)) => {
            let problem = format!("goes with damage.law = {belongs}, and the law is \"{law}\"");
            Err(input_missing(&format!("damage.{key}"), problem, "leave it out, or give that law"))
        }
    }
}

fn stretch_of(key: &str, value: Option<f64>) -> Result<Option<f64>> {
    number("a stretch", 1e-9, 1.0).read_optional(key, value)
}

/// Stretches of the nonlinear law, which rise: those left out follow from yield and tensile strength over Young's modulus.
fn softening(given: &Input, material: &Material) -> Result<Softening> {
    let modulus = material.youngs_modulus;
    let or_from = |key: &str, value: Option<f64>, strength: Option<f64>, named: &str| {
        let key = format!("damage.{key}");
        let problem = format!("is missing, and without material.{named} it cannot follow from it");
        stretch_of(&key, value)?
            .or(strength.map(|strength| strength / modulus))
            .ok_or_else(|| input_missing(&key, problem, format!("give it, or material.{named}")))
    };
    let elastic = or_from("elastic_stretch", given.elastic_stretch, material.yield_strength, "yield_strength_mpa")?;
    let peak = or_from("peak_stretch", given.peak_stretch, material.tensile_strength, "tensile_strength_mpa")?;
    if elastic > peak {
        let problem = format!("is beyond the stretch at the largest force, {peak:.6}");
        return Err(input("damage.elastic_stretch", elastic, problem, "give a smaller one, or a larger peak_stretch"));
    }
    if let (Some(_), Some(ratio)) = (given.final_stretch, given.final_ratio) {
        let problem = "stands beside final_stretch: one limit is given twice";
        return Err(input("damage.final_ratio", ratio, problem, "give one of them"));
    }
    let ratio = number("a ratio", 1e-6, 1e6).read("damage.final_ratio", given.final_ratio.unwrap_or(FINAL_RATIO))?;
    if ratio <= 1.0 {
        let problem = "leaves no softening: bonds would break at their largest force";
        return Err(input("damage.final_ratio", ratio, problem, "give more than 1"));
    }
    let last = stretch_of("damage.final_stretch", given.final_stretch)?.unwrap_or(ratio * peak);
    if last <= peak {
        let problem = format!("is not beyond the stretch at the largest force, {peak:.6}");
        return Err(input("damage.final_stretch", last, problem, "give a larger one"));
    }
    Ok(Softening { elastic, peak, last, printed: given.printed_law.unwrap_or(false) })
}
