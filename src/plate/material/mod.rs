//! What the plate is made of: elastic constants and strengths.
//!
//! `[material]` of an input file: a name, or constants written inline, or both (inline ones win).

pub mod growth_data;
pub mod library;

use serde::Deserialize;
use toml::Value;

use library::{MaterialFile, Property};
use perilife_base::error::{Result, input_missing};
use perilife_base::input::{DENSITY, FRACTURE_ENERGY, Folder, INTENSITY, MODULUS, Quantity, STRESS, number, slice};

perilife_base::kinds! {
    /// Plane state of the plate.
    pub enum Plane for "material.plane" {
        Stress = "stress": "thin plate, no stress across the thickness",
        Strain = "strain": "thick plate, no strain across the thickness",
    }
}

/// Elastic constants and strengths, SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name in `data/materials`, or "inline".
    pub name: String,
    /// Young's modulus E, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
    /// Plane stress or plane strain.
    pub plane: Plane,
    /// Yield strength, Pa.
    pub yield_strength: Option<f64>,
    /// Fracture toughness, Pa√m.
    pub toughness: Option<f64>,
    /// Fracture energy G_c, J/m².
    pub fracture_energy: Option<f64>,
    /// Density ρ, kg/m³.
    pub density: Option<f64>,
    /// Tensile strength f_t, Pa.
    pub tensile_strength: Option<f64>,
}

impl Material {
    /// A material of which nothing is known but its elastic constants: E in Pa, ν.
    pub fn elastic(youngs_modulus: f64, poisson_ratio: f64, plane: Plane) -> Material {
        Material {
            name: "inline".to_owned(),
            youngs_modulus,
            poisson_ratio,
            plane,
            yield_strength: None,
            toughness: None,
            fracture_energy: None,
            density: None,
            tensile_strength: None,
        }
    }

    /// Shear modulus G = E / (2 (1+ν)), Pa.
    #[inline]
    pub fn shear_modulus(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// E' of `K = √(E' G)`: E in plane stress, E/(1-ν²) in plane strain, Pa.
    #[inline]
    pub fn plane_modulus(&self) -> f64 {
        match self.plane {
            Plane::Stress => self.youngs_modulus,
            Plane::Strain => self.youngs_modulus / (1.0 - self.poisson_ratio * self.poisson_ratio),
        }
    }
}

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
    let name = input.name.unwrap_or_else(|| "inline".to_owned());
    let mut pick = |key: &str, given: Option<f64>, quantity: Quantity, of: fn(&MaterialFile) -> Option<&Property>| {
        let listed = file.as_ref().and_then(of).map(|listed| listed.value);
        if let (Some(given), Some(listed)) = (given, listed)
            && given != listed
        {
            warnings.push(format!("material.{key} = {given} is used instead of {listed} of {name}"));
        }
        quantity.read_optional(&format!("material.{key}"), given.or(listed))
    };
    // ν = 0.5 is an incompressible material: its moduli are infinite in plane strain.
    let ratio = number("a Poisson's ratio", 0.0, 0.499);
    let youngs_modulus = pick("youngs_modulus_gpa", input.youngs_modulus_gpa, MODULUS, |of| Some(&of.youngs_modulus_gpa))?;
    let poisson_ratio = pick("poisson_ratio", input.poisson_ratio, ratio, |of| Some(&of.poisson_ratio))?;
    let yield_strength = pick("yield_strength_mpa", input.yield_strength_mpa, STRESS, |of| of.yield_strength_mpa.as_ref())?;
    let toughness = pick("toughness_mpa_sqrt_m", input.toughness_mpa_sqrt_m, INTENSITY, |of| of.toughness_mpa_sqrt_m.as_ref())?;
    let fracture_energy =
        pick("fracture_energy_j_m2", input.fracture_energy_j_m2, FRACTURE_ENERGY, |of| of.fracture_energy_j_m2.as_ref())?;
    let density = pick("density_kg_m3", input.density_kg_m3, DENSITY, |of| of.density_kg_m3.as_ref())?;
    let tensile_strength =
        pick("tensile_strength_mpa", input.tensile_strength_mpa, STRESS, |of| of.tensile_strength_mpa.as_ref())?;
    let missing = |key: &str| {
        let remedy = format!("give it, or the name of a material: {}", library::names().join(", "));
        input_missing(&format!("material.{key}"), "is missing", remedy)
    };
    Ok(Material {
        youngs_modulus: youngs_modulus.ok_or_else(|| missing("youngs_modulus_gpa"))?,
        poisson_ratio: poisson_ratio.ok_or_else(|| missing("poisson_ratio"))?,
        plane: input.plane.unwrap_or(Plane::Stress),
        yield_strength,
        toughness,
        fracture_energy,
        density,
        tensile_strength,
        name,
    })
}
