//! `[damage]` of a scene: when bonds fail.

use toml::Value;

use crate::scene::{Calibration, Damage, DamageEntry, DamageLaw, Softening};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::keys::{Given, Key, key, number, section};
use perilife_plate::material::Material;

/// Final stretch over that of the tensile strength where a scene says nothing. A bond then breaks with 1.2 % of its stiffness
/// and 9 % of its largest force left, so that hardly any load is shed at once; at 3 it would be 41 %, at 2 73 % (strength
/// 572 MPa, yield strength 345 MPa).
const FINAL_RATIO: f64 = 5.0;

const FINAL: &str = "the final stretch";

const fn stretch(name: &'static str, text: &'static str) -> Key {
    number(name, text, "a stretch", 1e-9, 1.0)
}

perilife_base::keys! {
    pub struct DamageKeys {
        law: DamageLaw = key("law", "Damage law"), or "none" DamageLaw::None;
        enters: Option<DamageEntry> = key("enters", "Where damage acts in point laws: default influence");
        calibration: Option<Calibration> = key("calibration", "Calibration: of the critical stretch; default growth");
        critical_stretch: Option<f64> = stretch("critical_stretch", "Critical stretch");
        elastic_stretch: Option<f64> = stretch("elastic_stretch", "Elastic stretch: of the nonlinear law");
        peak_stretch: Option<f64> = stretch("peak_stretch", "Stretch at the largest force: of the nonlinear law");
        final_stretch: Option<f64> = stretch("final_stretch", "Final stretch: of the nonlinear law").group(FINAL);
        final_ratio: f64 = number("final_ratio", "Final stretch over that at the largest force", "a ratio", 1e-6, 1e6).group(FINAL), or "5" FINAL_RATIO;
        printed_law: bool = key("printed_law", "The law as published"), or "false" false;
    }
}

/// Reads `[damage]`; bonds stay whole where it is left out.
pub fn from_value(value: &Value, material: &Material) -> Result<Damage> {
    let given: DamageKeys = section(value, "damage")?;
    let law = given.law;
    check_keys(&Given::of(value, "damage")?, law)?;
    let stretch = given.critical_stretch;
    let critical = matches!(law, DamageLaw::CriticalStretch | DamageLaw::CriticalEnergy);
    if let (Some(calibration), Some(_)) = (given.calibration, stretch) {
        let problem = "conflicts with damage.critical_stretch";
        return Err(input("damage.calibration", format!("\"{calibration}\""), problem, "remove one of them"));
    }
    if critical && stretch.is_none() && material.fracture_energy.is_none() {
        let problem = format!("is missing (required for the critical stretch of damage.law = \"{law}\")");
        return Err(input_missing("material.fracture_energy_j_m2", problem, "give it, or damage.critical_stretch"));
    }
    if law == DamageLaw::PrincipalStress && material.tensile_strength.is_none() {
        let problem = "is missing (required by damage.law = \"principal_stress\")";
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
    let problem = "applies only to bond_law = \"correspondence\"";
    Given::of(value, "damage")?.refuse_any(&["enters"], problem, "remove it")
}

fn check_keys(given: &Given<'_>, law: DamageLaw) -> Result<()> {
    const SOFTENING: &[&str] = &["elastic_stretch", "peak_stretch", "final_stretch", "final_ratio", "printed_law"];
    const CRITICAL: &[&str] = &["critical_stretch", "calibration"];
    let is_critical = matches!(law, DamageLaw::CriticalStretch | DamageLaw::CriticalEnergy);
    let unused = [
        (CRITICAL, "critical_stretch or critical_energy", !is_critical),
        (SOFTENING, "nonlinear_two_parameter", law != DamageLaw::NonlinearTwoParameter),
    ];
    unused.into_iter().filter(|(.., is_unused)| *is_unused).try_for_each(|(keys, belongs, _)| {
        let problem = format!("applies only to damage.law = {belongs}; the law is \"{law}\"");
        given.refuse_any(keys, &problem, "remove it, or use that law")
    })
}

/// Stretches of the nonlinear law, which rise: those left out follow from yield and tensile strength over Young's modulus.
fn softening(given: &DamageKeys, material: &Material) -> Result<Softening> {
    let modulus = material.youngs_modulus;
    let or_from = |key: &str, value: Option<f64>, strength: Option<f64>, named: &str| {
        let key = format!("damage.{key}");
        let problem = format!("is missing, and so is material.{named}");
        value
            .or(strength.map(|strength| strength / modulus))
            .ok_or_else(|| input_missing(&key, problem, format!("give it, or material.{named}")))
    };
    let elastic = or_from("elastic_stretch", given.elastic_stretch, material.yield_strength, "yield_strength_mpa")?;
    let peak = or_from("peak_stretch", given.peak_stretch, material.tensile_strength, "tensile_strength_mpa")?;
    if elastic > peak {
        let problem = format!("is above the stretch at the largest force, {peak:.6}");
        return Err(input("damage.elastic_stretch", elastic, problem, "use a smaller one, or a larger peak_stretch"));
    }
    let ratio = given.final_ratio;
    if ratio <= 1.0 {
        let problem = "gives no softening: bonds would break at their largest force";
        return Err(input("damage.final_ratio", ratio, problem, "give more than 1"));
    }
    let last = given.final_stretch.unwrap_or(ratio * peak);
    if last <= peak {
        let problem = format!("must be above the stretch at the largest force, {peak:.6}");
        return Err(input("damage.final_stretch", last, problem, "give a larger one"));
    }
    Ok(Softening { elastic, peak, last, printed: given.printed_law })
}
