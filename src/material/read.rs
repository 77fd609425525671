//! `[material]` of an input file: a name, or constants written inline, or both (inline ones win).

use serde::Deserialize;
use toml::Value;

use super::library::{self, Property};
use super::{Material, Plane};
use crate::error::{Result, input_missing};
use crate::input::{DENSITY, FRACTURE_ENERGY, Folder, INTENSITY, MODULUS, Quantity, STRESS, number, slice};

/// Keys of `[material]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    name: Option<String>,
    youngs_modulus_gpa: Option<f64>,
    poisson_ratio: Option<f64>,
    yield_strength_mpa: Option<f64>,
    toughness_mpa_sqrt_m: Option<f64>,
    fracture_energy_j_m2: Option<f64>,
    density_kg_m3: Option<f64>,
    tensile_strength_mpa: Option<f64>,
    plane: Option<Plane>,
}

/// Reads `[material]`; own material files are looked for from `folder`. Pushes a line for every constant of the named
/// material that the case replaces.
pub fn from_value(value: &Value, folder: &Folder, warnings: &mut Vec<String>) -> Result<Material> {
    let input: Input = slice(value, "material")?;
    let file = input.name.as_deref().map(|name| library::find(name, folder)).transpose()?;
    let name = input.name.clone().unwrap_or_else(|| "inline".to_owned());
    let file = file.as_ref();
    let mut pick = |key: &str, given: Option<f64>, listed: Option<&Property>, quantity: Quantity| {
        if let (Some(given), Some(listed)) = (given, listed)
            && given != listed.value
        {
            warnings.push(format!("material.{key} = {given} is used instead of {} of {name}", listed.value));
        }
        quantity.read_optional(&format!("material.{key}"), given.or(listed.map(|listed| listed.value)))
    };
    let modulus = pick("youngs_modulus_gpa", input.youngs_modulus_gpa, file.map(|file| &file.youngs_modulus_gpa), MODULUS)?;
    // ν = 0.5 is an incompressible material: its moduli are infinite in plane strain.
    let poisson = pick(
        "poisson_ratio",
        input.poisson_ratio,
        file.map(|file| &file.poisson_ratio),
        number("a Poisson's ratio", 0.0, 0.499),
    )?;
    let yield_strength =
        pick("yield_strength_mpa", input.yield_strength_mpa, file.and_then(|file| file.yield_strength_mpa.as_ref()), STRESS)?;
    let toughness = pick(
        "toughness_mpa_sqrt_m",
        input.toughness_mpa_sqrt_m,
        file.and_then(|file| file.toughness_mpa_sqrt_m.as_ref()),
        INTENSITY,
    )?;
    let fracture_energy = pick(
        "fracture_energy_j_m2",
        input.fracture_energy_j_m2,
        file.and_then(|file| file.fracture_energy_j_m2.as_ref()),
        FRACTURE_ENERGY,
    )?;
    let density = pick("density_kg_m3", input.density_kg_m3, file.and_then(|file| file.density_kg_m3.as_ref()), DENSITY)?;
    let tensile_strength = pick(
        "tensile_strength_mpa",
        input.tensile_strength_mpa,
        file.and_then(|file| file.tensile_strength_mpa.as_ref()),
        STRESS,
    )?;

    let missing = |key: &str| {
        let remedy = format!("give it, or the name of a material: {}", library::names().join(", "));
        input_missing(&format!("material.{key}"), "is missing", remedy)
    };
    Ok(Material {
        youngs_modulus: modulus.ok_or_else(|| missing("youngs_modulus_gpa"))?,
        poisson_ratio: poisson.ok_or_else(|| missing("poisson_ratio"))?,
        plane: input.plane.unwrap_or(Plane::Stress),
        yield_strength,
        toughness,
        fracture_energy,
        density,
        tensile_strength,
        name,
    })
}
