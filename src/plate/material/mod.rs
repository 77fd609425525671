//! What the plate is made of: elastic constants and strengths.
//!
//! `[material]` of an input file: a name, or constants written inline, or both (inline ones win).

pub mod growth_data;
pub mod library;

use toml::Value;

use library::{MaterialFile, Property};
use perilife_base::error::Result;
use perilife_base::input::{DENSITY, Folder};
use perilife_base::keys::{Given, Plain, Section, energy, intensity, key, modulus, number, section, stress};

perilife_base::kinds! {
    pub enum Plane for "material.plane" {
        Stress = "stress": "plane stress: thin plate",
        Strain = "strain": "plane strain: thick plate",
    }
}

/// Elastic constants and strengths, SI: moduli and strengths in Pa, fracture toughness in Pa√m, fracture energy G_c in J/m², density in
/// kg/m³.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name in `data/materials`, or "inline".
    pub name: String,
    pub youngs_modulus: f64,
    pub poisson_ratio: f64,
    pub plane: Plane,
    pub yield_strength: Option<f64>,
    pub toughness: Option<f64>,
    pub fracture_energy: Option<f64>,
    pub density: Option<f64>,
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
    pub fn shear_modulus(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// E' of `K = √(E' G)`: E in plane stress, E/(1-ν²) in plane strain, Pa.
    pub fn plane_modulus(&self) -> f64 {
        match self.plane {
            Plane::Stress => self.youngs_modulus,
            Plane::Strain => self.youngs_modulus / (1.0 - self.poisson_ratio * self.poisson_ratio),
        }
    }
}

perilife_base::keys! {
    pub struct Input {
        name: Option<String> = key("name", "Material: a name of `perilife list materials`, or the path of your own .toml file");
        youngs_modulus: Option<Plain> = modulus(E, "Young's modulus E");
        poisson_ratio: Option<Plain> = number(NU, "Poisson's ratio ν", "a Poisson's ratio", 0.0, 0.499);
        yield_strength: Option<Plain> = stress("yield_strength_mpa", "Yield strength σY");
        toughness: Option<Plain> = intensity("toughness_mpa_sqrt_m", "Fracture toughness K_c: at this thickness");
        fracture_energy: Option<Plain> = energy("fracture_energy_j_m2", "Fracture energy: of scenes");
        density: Option<Plain> = key("density_kg_m3", "Density: of scenes with inertia").of(DENSITY);
        tensile_strength: Option<Plain> = stress("tensile_strength_mpa", "Tensile strength: of scenes");
        plane: Plane = key("plane", "Plane state"), or "stress" Plane::Stress;
    }
}
const E: &str = "youngs_modulus_gpa";
const NU: &str = "poisson_ratio";

/// Reads `[material]`; own material files are looked for from `folder`. Pushes a line for every constant of the named
/// material that the case replaces.
pub fn from_value(value: &Value, folder: &Folder, warnings: &mut Vec<String>) -> Result<Material> {
    let given = Given::of(value, "material")?;
    let own: Input = section(value, "material")?;
    let file = own.name.as_deref().map(|name| library::find(name, folder)).transpose()?;
    let name = own.name.unwrap_or_else(|| "inline".to_owned());
    let mut pick = |key: &str, given: Option<Plain>, of: fn(&MaterialFile) -> Option<&Property>| -> Result<Option<f64>> {
        let listed = file.as_ref().and_then(of).map(|listed| listed.value);
        if let (Some(Plain(given)), Some(listed)) = (given, listed)
            && given != listed
        {
            warnings.push(format!("material: material.{key} = {given} overrides {listed} of {name}"));
        }
        let quantity = Input::KEYS.iter().find(|own| own.name == key).and_then(|own| own.quantity);
        let value = given.map(|given| given.0).or(listed);
        quantity.map_or(Ok(value), |quantity| quantity.read_optional(&format!("material.{key}"), value))
    };
    let youngs_modulus = pick(E, own.youngs_modulus, |of| Some(&of.youngs_modulus_gpa))?;
    // ν = 0.5 is an incompressible material: its moduli are infinite in plane strain.
    let poisson_ratio = pick(NU, own.poisson_ratio, |of| Some(&of.poisson_ratio))?;
    let yield_strength = pick("yield_strength_mpa", own.yield_strength, |of| of.yield_strength_mpa.as_ref())?;
    let toughness = pick("toughness_mpa_sqrt_m", own.toughness, |of| of.toughness_mpa_sqrt_m.as_ref())?;
    let fracture_energy = pick("fracture_energy_j_m2", own.fracture_energy, |of| of.fracture_energy_j_m2.as_ref())?;
    let density = pick("density_kg_m3", own.density, |of| of.density_kg_m3.as_ref())?;
    let tensile_strength = pick("tensile_strength_mpa", own.tensile_strength, |of| of.tensile_strength_mpa.as_ref())?;
    let missing = |key: &str| {
        given.refuse(key, "is missing", format!("give it, or the name of a material: {}", library::names().join(", ")))
    };
    Ok(Material {
        youngs_modulus: youngs_modulus.ok_or_else(|| missing(E))?,
        poisson_ratio: poisson_ratio.ok_or_else(|| missing(NU))?,
        plane: own.plane,
        yield_strength,
        toughness,
        fracture_energy,
        density,
        tensile_strength,
        name,
    })
}
